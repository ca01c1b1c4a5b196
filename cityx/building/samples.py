"""Samples: plots of typical size with a street before them, to show and measure generators on."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from cityx.assets.styles.generators import Generator
from cityx.building.catalogue import generators
from cityx.city.city import City
from cityx.city.frame import Frame
from cityx.city.layout import Layout, make_table
from cityx.ids import stable_id, uniform

FRAME = Frame(51.5, 8.0)
STREET_WIDTH = 8.0  # metres
SIDEWALK = 3.0
HOUSE_GARDEN = 4.5  # metres between the sidewalk and detached houses
LOW = ("detached", "house", "bungalow", "shed", "barn", "greenhouse")  # uses with a garden before
PAVED = 9.0  # metres of paving around buildings of the town
RISE = 0.5  # of the line of a sheet: metres to the north per metre to the east
LONG = 7.0  # metres of street beyond the plot on either side


@dataclass(frozen=True)
class Sample:
    """One building to make.

    Attributes
    ----------
    generator
        Name of its generator.
    seed
        Draws its measures; the id follows from both.
    x, y
        Metres: left front corner of its plot.
    length, width
        Metres along the street and away from it; 0 draws from the generator's plot.
    levels
        Storeys; 0 draws from the generator's floors.
    """

    generator: str
    seed: int
    x: float = 0.0
    y: float = 0.0
    length: float = 0.0
    width: float = 0.0
    levels: int = 0

    @property
    def id(self) -> int:
        """Id of the building."""
        return stable_id("sample", self.generator, self.seed)

    def measured(self) -> Sample:
        """Fill in the measures that are left open."""
        kind = generators()[self.generator]
        draw = uniform(0, "sample/plot", np.uint64(self.id), np.arange(3))
        low_l, high_l, low_w, high_w = kind.plot
        floors = kind.floors
        levels = floors[0] + int(draw[2] * (floors[1] - floors[0] + 1))
        return Sample(
            self.generator, self.seed, self.x, self.y,
            self.length or round(low_l + draw[0] * (high_l - low_l), 2),
            self.width or round(low_w + draw[1] * (high_w - low_w), 2),
            self.levels or min(levels, floors[1]),
        )  # fmt: skip

    @property
    def outline(self) -> shapely.Polygon:
        """Its footprint."""
        return shapely.box(self.x, self.y, self.x + self.length, self.y + self.width)

    @property
    def height(self) -> float:
        """Metres to the eave."""
        return generators()[self.generator].storey * self.levels


def setback_of(kind: Generator) -> float:
    """Metres between the middle of the street and the front of a building."""
    garden = HOUSE_GARDEN if kind.use in LOW else 0.0
    return STREET_WIDTH / 2 + SIDEWALK + garden


def sheet_of(names: Sequence[str], seeds: Sequence[int], spacing: float = 300.0) -> list[Sample]:
    """Return one sample for each name and seed, far from one another.

    They stand on a line to the east-north-east: who looks at one of them from the south and sees
    its front and its east side sees no other.
    """
    pairs = list(itertools.product(names, seeds))
    steps = np.arange(len(pairs)) - len(pairs) // 2
    return [
        Sample(name, seed, step * spacing, step * spacing * RISE).measured()
        for (name, seed), step in zip(pairs, steps.tolist(), strict=True)
    ]


def sample_city(
    samples: Sequence[Sample], *, seed: int = 0, lod: int = 2, streets: Sequence[float] = ()
) -> City:
    """Make a city of samples, each with a street of its own before it.

    Parameters
    ----------
    samples
        Measured samples.
    streets
        Levels y of streets that run through the whole site instead, metres.

    Returns
    -------
    city
        With a layout and nothing built; its buildings have their generators.
    """
    kinds = [generators()[each.generator] for each in samples]
    shapes = np.array([each.outline for each in samples], object)
    ids = np.array([each.id for each in samples], np.uint64)
    levels = [each.levels for each in samples]
    top = [each.height for each in samples]
    use = [kind.use for kind in kinds]
    shape, rise = zip(*[_usual_roof(kind, each) for kind, each in zip(kinds, samples, strict=True)],
                      strict=True)  # fmt: skip
    top = [height + up for height, up in zip(top, rise, strict=True)]
    count = len(samples)
    buildings = make_table(
        "buildings", shapes, id=ids, source=[f"sample/{s.generator}/{s.seed}" for s in samples],
        use=use, levels=levels, height=top, place=["urban"] * count, tags=["{}"] * count,
        generator=[each.generator for each in samples],
    )  # fmt: skip
    parts = make_table(
        "parts", shapes, id=ids, building=ids, use=use, base=[0.0] * count, top=top, levels=levels,
        roof_shape=shape, roof_height=rise, roof_direction=[math.nan] * count, walls=[True] * count,
        wall_color=[-1] * count, roof_color=[-1] * count,
    )  # fmt: skip
    west, south, east, north = shapely.total_bounds(shapes)
    lines = [
        [(each.x - LONG, each.y - setback_of(kind)),
         (each.x + each.length + LONG, each.y - setback_of(kind))]
        for each, kind in zip(samples, kinds, strict=True)
    ]  # fmt: skip
    if len(streets):
        lines = [[(west - 40.0, y), (east + 40.0, y)] for y in streets]
    number = len(lines)
    roads = make_table(
        "roads", [shapely.LineString(line) for line in lines],
        id=[stable_id("sample", "road", i) for i in range(number)],
        source=[f"sample/road/{i}" for i in range(number)], kind=["tertiary"] * number,
        lanes=[2] * number, lanes_forward=[1] * number, lane_width=[3.25] * number,
        width=[STREET_WIDTH] * number, sidewalk_left=[SIDEWALK] * number,
        sidewalk_right=[SIDEWALK] * number, surface=["asphalt"] * number, lit=[True] * number,
        maxspeed_kmh=[50.0] * number,
    )  # fmt: skip
    extent = (west - 60.0, south - 60.0, east + 60.0, north + 60.0)
    paved = [
        each.outline.buffer(PAVED, join_style="mitre")
        for each, kind in zip(samples, kinds, strict=True)
        if kind.use not in LOW
    ]
    areas = make_table(
        "areas", shapely.orient_polygons(np.array(paved, object)),
        id=[stable_id("sample", "area", i) for i in range(len(paved))],
        source=[f"sample/area/{i}" for i in range(len(paved))], kind=["pedestrian"] * len(paved),
    )  # fmt: skip
    layout = Layout(extent, buildings, parts, roads, areas)
    return City(
        "Samples", FRAME, layout, seed=seed, lod=lod, attribution=("made by CityX",),
        stages_done=frozenset({"layout", "terrain"}),
    )  # fmt: skip


def _usual_roof(kind: Generator, each: Sample) -> tuple[str, float]:
    """Roof of a sample whose generator leaves it to the region: gabled where it is low."""
    if kind.roofs or kind.mass or kind.floors[1] > 5:
        return "flat", 0.0
    return "gabled", round(0.5 * each.width * math.tan(math.radians(38.0)), 2)
