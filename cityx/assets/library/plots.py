"""Plots: a made-up city of lots, each drawn by its number, to grow assets on."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.city import City
from cityx.geometry.arrays import FloatArray
from cityx.ids import choose, stable_id, uniform

BATCH = 64  # buildings grown together; fixed, so that the number asked for changes nothing
SPACING = 400.0  # metres between plots, further than anything looks about for neighbours
NEIGHBOUR = 5.0  # metres, width of the neighbours that make a side wall blind


@dataclass(frozen=True)
class Recipe:
    """A way to make buildings.

    Attributes
    ----------
    name
        Kept in the records.
    share
        How often it is used, relative to the others.
    actions
        Registered actions, run in order on a city of plots; (id, arguments).
    uses
        Uses it may be asked for, () for all.
    """

    name: str
    share: float
    actions: tuple[tuple[str, Mapping[str, Any]], ...]
    uses: tuple[str, ...] = ()


# Generators are added by a row each; the draw of a batch is by number, so older batches stay.
RECIPES: tuple[Recipe, ...] = (
    Recipe(
        "facade grammar",
        1.0,
        (("building/design-v1", {}), ("building/shell-v1", {}), ("building/facade-v1", {})),
    ),
)


@dataclass(frozen=True)
class Plot:
    """What plots of one use are like; medians and spreads are of log-normal draws.

    Attributes
    ----------
    share
        Share among grown buildings.
    front, depth
        (median, spread of the logarithm, least, most), metres.
    levels
        (least, most, power): the draw is raised to the power, so that few are tall.
    storey
        (least, most) metres.
    roofs
        Shapes and weights.
    terraced
        Share of those with neighbours at a side.
    osm
        Value of building=*.
    """

    share: float
    front: tuple[float, float, float, float]
    depth: tuple[float, float, float, float]
    levels: tuple[int, int, float]
    storey: tuple[float, float]
    roofs: Mapping[str, float]
    terraced: float
    osm: str


_PITCHED = {"gabled": 6, "hipped": 3, "half-hipped": 1, "mansard": 1, "gambrel": 0.5,
            "skillion": 0.5, "flat": 1.5}  # fmt: skip
# Sizes are after the outlines of the OSM extracts the program is tested on: quartiles by use.
PLOTS: Mapping[str, Plot] = MappingProxyType(
    {
        "house": Plot(0.34, (9.5, 0.38, 4.0, 26.0), (10.0, 0.34, 4.5, 26.0), (1, 3, 1.0),
                      (2.7, 3.1), _PITCHED, 0.35, "house"),
        "flats": Plot(0.29, (15.0, 0.55, 4.5, 90.0), (12.5, 0.36, 5.0, 45.0), (2, 12, 2.0),
                      (2.8, 3.5), {"flat": 5, "gabled": 3, "hipped": 2, "mansard": 2}, 0.5,
                      "apartments"),
        "office": Plot(0.11, (22.0, 0.55, 7.0, 110.0), (18.0, 0.45, 7.0, 70.0), (2, 32, 2.6),
                       (3.3, 4.0), {"flat": 9, "hipped": 0.5, "mansard": 0.5}, 0.3, "office"),
        "retail": Plot(0.09, (14.0, 0.6, 5.0, 90.0), (15.0, 0.5, 5.0, 70.0), (1, 3, 1.4),
                       (3.4, 4.6), {"flat": 7, "gabled": 2, "hipped": 1}, 0.4, "retail"),
        "industry": Plot(0.06, (26.0, 0.6, 7.0, 130.0), (22.0, 0.5, 7.0, 90.0), (1, 2, 1.0),
                         (4.2, 6.0), {"flat": 5, "gabled": 4, "skillion": 1, "round": 0.5}, 0.05,
                         "industrial"),
        "civic": Plot(0.04, (28.0, 0.5, 9.0, 110.0), (17.0, 0.4, 8.0, 60.0), (1, 5, 1.2),
                      (3.4, 4.2), {"flat": 5, "hipped": 3, "gabled": 3}, 0.05, "school"),
        "shed": Plot(0.06, (4.6, 0.45, 1.8, 16.0), (4.8, 0.4, 1.8, 14.0), (1, 1, 1.0),
                     (2.5, 2.9), {"flat": 4, "gabled": 4, "skillion": 3}, 0.1, "shed"),
        "worship": Plot(0.01, (13.0, 0.4, 6.0, 40.0), (25.0, 0.4, 10.0, 80.0), (1, 1, 1.0),
                        (5.5, 6.0), {"gabled": 6, "hipped": 1}, 0.0, "church"),
    }
)  # fmt: skip
STYLE_PLACES = {
    "american": (41.9, -87.6), "brick": (51.5, -0.1), "mediterranean": (41.9, 12.5),
    "asian": (35.7, 139.7),
}  # fmt: skip
EUROPE = (50.1, 8.7)


@dataclass(frozen=True)
class Plots:
    """n drawn plots; fields are (n,) and mean what the columns of a layout mean."""

    number: NDArray[np.int64]
    id: NDArray[np.uint64]
    use: NDArray[np.str_]
    front: FloatArray
    depth: FloatArray
    levels: NDArray[np.int64]
    storey: FloatArray
    roof: NDArray[np.str_]
    roof_height: FloatArray
    party: NDArray[np.int64]


def draw_plots(numbers: NDArray[np.int64], seed: int, uses: Sequence[str] = ()) -> Plots:
    """Draw plots by number: the same number and seed give the same plot."""
    ids = np.array([stable_id("grown", seed, int(n)) for n in numbers], np.uint64)
    names = np.array([use for use in PLOTS if not uses or use in uses])
    which = choose(seed, "grow/use", ids, [PLOTS[use].share for use in names.tolist()])
    rules = [PLOTS[use] for use in names[which].tolist()]

    def lognormal(what: str, side: str) -> FloatArray:
        median, spread, low, high = np.array([getattr(rule, side) for rule in rules]).T
        # Box and Muller: two uniform draws make a normal one.
        radius = np.sqrt(-2 * np.log(np.maximum(uniform(seed, what, ids), 1e-12)))
        normal = radius * np.cos(2 * np.pi * uniform(seed, what, ids, 1))
        return np.asarray(np.round(np.clip(median * np.exp(spread * normal), low, high), 2))

    front, depth = lognormal("grow/front", "front"), lognormal("grow/depth", "depth")
    least, most, power = np.array([rule.levels for rule in rules], float).T
    share = uniform(seed, "grow/levels", ids) ** power
    # Nobody builds needles: a tower is at most eight times as high as its front is wide.
    most = np.maximum(least, np.minimum(most, np.floor(8 * np.minimum(front, depth) / 3.4)))
    levels = (least + np.floor(share * (most - least + 1))).clip(least, most).astype(np.int64)
    low, high = np.array([rule.storey for rule in rules]).T
    storey = np.round(low + (high - low) * uniform(seed, "grow/storey", ids), 2)
    draw = uniform(seed, "grow/roof", ids)
    roof = np.array([_drawn(rule.roofs, value) for rule, value in zip(rules, draw, strict=True)])
    roof = np.where(levels > 6, "flat", roof)
    slope = 0.45 + 0.35 * uniform(seed, "grow/slope", ids)
    height = np.round(np.clip(slope * np.minimum(front, depth) / 2, 0.8, 7.0), 2)
    height = np.where(roof == "flat", 0.0, np.where(roof == "skillion", 0.4 * height, height))
    side = uniform(seed, "grow/party", ids)
    terraced = side < [rule.terraced for rule in rules]
    party = np.where(terraced, 1 + np.floor(3 * uniform(seed, "grow/side", ids)), 0)
    return Plots(np.asarray(numbers, np.int64), ids, names[which], front, depth, levels, storey,
                 roof, height, party.astype(np.int64))  # fmt: skip


def _drawn(weights: Mapping[str, float], value: float) -> str:
    edges = np.cumsum(list(weights.values()))
    return list(weights)[int(np.searchsorted(edges, value * edges[-1], side="right"))]


def plots_to_city(plots: Plots, seed: int, style: str) -> tuple[City, FloatArray]:
    """Lay plots out on a plane, each at a street to its south, with its neighbours.

    Returns
    -------
    city
        Neighbours have ids of their own.
    origin
        (n, 3) middle of each plot on the ground.
    """
    from cityx.city.frame import Frame
    from cityx.city.layout import Layout, make_table

    count = len(plots.id)
    # The place follows from the number: where a plot lies must not depend on the batch.
    cell = plots.number % BATCH
    columns = math.ceil(math.sqrt(BATCH))
    x, y = (cell % columns) * SPACING, (cell // columns) * SPACING
    half, deep = plots.front / 2, plots.depth / 2
    shapes = [shapely.box(x - half, y - deep, x + half, y + deep)]
    owner = [np.arange(count)]
    ids = [plots.id]
    for bit, sign in ((1, -1.0), (2, 1.0)):
        of = np.flatnonzero(plots.party & bit)
        near, far = x[of] + sign * half[of], x[of] + sign * (half[of] + NEIGHBOUR)
        shapes.append(shapely.box(np.minimum(near, far), y[of] - deep[of],
                                  np.maximum(near, far), y[of] + deep[of]))  # fmt: skip
        owner.append(of)
        ids.append(np.array([stable_id("neighbour", bit, int(i)) for i in plots.id[of]], np.uint64))
    of = np.concatenate(owner)
    every, outline = np.concatenate(ids), np.concatenate(shapes)
    osm = np.array([PLOTS[use].osm for use in plots.use.tolist()])[of]
    height = (plots.levels * plots.storey + plots.roof_height)[of]
    none = np.full(len(of), -1)
    buildings = make_table(
        "buildings", outline, id=every, use=osm, levels=plots.levels[of], height=height,
        place=np.where(plots.levels[of] > 3, "urban", "low"),
    )  # fmt: skip
    parts = make_table(
        "parts", outline, id=every, building=every, use=osm, base=np.zeros(len(of)), top=height,
        levels=plots.levels[of], roof_shape=plots.roof[of], roof_height=plots.roof_height[of],
        roof_direction=np.full(len(of), np.nan), walls=np.ones(len(of), bool), wall_color=none,
        roof_color=none,
    )  # fmt: skip
    street = np.stack(
        [np.column_stack([x + side * (half + 12.0), y - deep - 9.0]) for side in (-1.0, 1.0)],
        axis=1,
    )
    roads = make_table(
        "roads", shapely.linestrings(street), id=plots.id, kind=np.full(count, "residential"),
        width=np.full(count, 6.0), lanes=np.full(count, 2),
    )  # fmt: skip
    edge = columns * SPACING
    layout = Layout((-SPACING, -SPACING, edge, edge), buildings, parts, roads)
    city = City(
        "plots", Frame(*STYLE_PLACES.get(style, EUROPE)), layout, seed=seed, style=style,
        stages_done=frozenset({"layout", "terrain"}),
    )  # fmt: skip
    from cityx.city.ground import KERB_HEIGHT

    return city, np.column_stack([x, y, np.full(count, KERB_HEIGHT)])
