"""Bays: a house that is low for the slope it stands on steps down it in pieces.

Each piece counts its height from the lowest ground at its own walls (`cityx.city.levels`), as the
houses of a row on a hill do; what is high enough for its slope stands whole.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.building.catalogue import generator_named
from cityx.building.massing.massing import Axes, Mass, axes_of
from cityx.building.part_rows import plain_rows, with_masses
from cityx.city.layout import BAY
from cityx.city.levels import EVERY, SUNK, deepest, terrain_at_walls
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.polygons import clean_polygons
from cityx.ground.building_passages import open_ways

if TYPE_CHECKING:
    from cityx.city.city import City
    from cityx.city.layout import Layout
    from cityx.city.terrain import Terrain

OVER = 0.5  # metres by which a wall downhill may exceed its height before the house steps
STOREY = 3.0  # metres from one bay to the next, where the house is high enough; else half of it
LEAST_BAY = 4.5  # metres along the slope
LEAST_AREA = 12.0  # square metres; a smaller piece belongs to the bay beside it
GRID = 0.001  # metres
# Roofs about the middle of a plan, which no wall may cut.
CENTRED = ("pyramidal", "dome", "onion", "cone")
# Roofs with one ridge, which runs on through the bays.
RIDGED = ("gabled", "gambrel", "half-hipped", "round", "saltbox", "zollinger")


def stepped(layout: Layout, terrain: Terrain, plain: IntArray) -> tuple[Layout, NDArray[np.bool_]]:
    """Cut the houses that are too low for their slopes into bays.

    Parameters
    ----------
    plain
        (n,) row of the only part of each building that may be cut, -1 for the others.

    Returns
    -------
    layout, cut
        ``cut`` is (n,) bool, which buildings stand in bays now.
    """
    cut = np.zeros(len(plain), bool)
    if terrain.is_flat:
        return layout, cut
    parts = layout.parts
    lowest, highest = terrain_at_walls(layout, terrain)
    steep = highest - lowest > deepest(layout) + OVER
    steep &= ~np.isin(parts["roof_shape"].to_numpy(str), CENTRED)
    rows = np.flatnonzero((plain >= 0) & steep[plain])
    names = layout.buildings["generator"].to_numpy(str)[rows].tolist()
    # What stands open by its nature, as a stadium, has one floor.
    rows = rows[np.array([generator_named(name).covers for name in names], bool)]
    if not len(rows):
        return layout, cut
    rows = rows[shapely.is_empty(open_ways(layout)[plain[rows]])]
    gone: list[int] = []
    sources: list[int] = []
    masses: list[Mass] = []
    numbers: list[int] = []
    deep = deepest(layout)
    for row, part in zip(rows.tolist(), plain[rows].tolist(), strict=True):
        bays = bays_of(parts.geometry.iloc[part], terrain, float(deep[part]))
        if len(bays) < 2:
            continue
        cut[row] = True
        gone.append(part)
        sources += [part] * len(bays)
        masses += [_bay(parts.iloc[part], bay) for bay in bays]
        numbers += range(len(bays))
    if not gone:
        return layout, cut
    return with_masses(layout, gone, sources, masses, numbers), cut


def in_bays(city: City) -> City:
    """Cut the houses of a city that no design was made for where they are too low for slopes."""
    if city.terrain.is_flat:
        return city
    layout, _ = stepped(city.layout, city.terrain, plain_rows(city.layout))
    return replace(city, layout=layout)


def _bay(part: Any, plan: shapely.Polygon) -> Mass:
    """Return a bay of a part, as high and with the roof of the whole."""
    direction, across = float(part["roof_direction"]), bool(part["roof_across"])
    if part["roof_shape"] in RIDGED and math.isnan(direction):
        axes = axes_of(part["geometry"])
        down = axes.along if across else axes.across
        direction = math.atan2(down[0], down[1])
    return Mass(plan, float(part["base"]), float(part["top"]), BAY, str(part["roof_shape"]),
                float(part["roof_height"]), direction, across)  # fmt: skip


def bays_of(plan: shapely.Polygon, terrain: Terrain, deep: float) -> list[shapely.Polygon]:
    """Cut a plan across its slope, and the pieces the other way where they still need it.

    Parameters
    ----------
    deep
        Metres that a bay may stand in the slope behind it.
    """
    pieces = [plan]
    for _ in range(2):
        pieces = [bay for piece in pieces for bay in _cut(piece, terrain, deep)]
    return pieces


def _cut(plan: shapely.Polygon, terrain: Terrain, deep: float) -> list[shapely.Polygon]:
    points = shapely.get_coordinates(shapely.segmentize(plan, EVERY))
    height = terrain.height_at(points)
    if np.ptp(height) <= deep + OVER:
        return [plan]
    axes = axes_of(plan)
    # A plane through the ground at the walls says which way it falls.
    local = np.column_stack([(points - axes.middle) @ axes.along,
                             (points - axes.middle) @ axes.across])  # fmt: skip
    fitted, *_ = np.linalg.lstsq(np.column_stack([local, np.ones(len(local))]), height, rcond=None)
    falls = np.abs(fitted[:2]) * np.array([axes.length, axes.width])
    way = int(falls[1] > falls[0])
    size = (axes.length, axes.width)[way]
    beside = float(falls[1 - way])
    step = SUNK * max(1.0, math.floor(min(STOREY, deep - beside + OVER / 2) / SUNK))
    places = _places(size, float(falls[way]), step, rises=bool(fitted[way] > 0))
    return _sliced(plan, axes, way, places)


def _places(size: float, fall: float, step: float, *, rises: bool) -> FloatArray:
    """Return where a plan is cut, metres from its middle along the slope, (k,)."""
    number = max(math.ceil((fall - OVER / 2) / step), 1)
    length = size * step / fall
    if size - (number - 1) * length < LEAST_BAY:  # the last takes from the others what it lacks
        length = (size - LEAST_BAY) / max(number - 1, 1)
    if length < LEAST_BAY:
        number = max(int(size / LEAST_BAY), 1)
        length = size / number
    places = length * np.arange(1, number) - size / 2
    return places if rises else -places[::-1]


def _sliced(
    plan: shapely.Polygon, axes: Axes, way: int, places: FloatArray
) -> list[shapely.Polygon]:
    """Slice a plan at places along one of its axes; small pieces join those beside them."""
    far = axes.length + axes.width
    edges = [-far, *places.tolist(), far]
    boxes = [
        axes.box(low, -far, high, far) if way == 0 else axes.box(-far, low, far, high)
        for low, high in itertools.pairwise(edges)
    ]
    slices = shapely.intersection(plan, np.array(boxes, object), grid_size=GRID)
    clean = clean_polygons(shapely.get_parts(slices))
    pieces = sorted(clean[shapely.area(clean) > GRID].tolist(), key=lambda one: -one.area)
    kept = [one for one in pieces if one.area >= LEAST_AREA]
    for small in pieces[len(kept) :]:
        shared = [shapely.intersection(small, one).length for one in kept]
        if kept and max(shared) > 0:
            at = int(np.argmax(shared))
            joined = shapely.union(kept[at], small, grid_size=GRID)
            if isinstance(joined, shapely.Polygon):
                kept[at] = joined
    whole = sum(one.area for one in kept)
    return kept if abs(whole - plan.area) < LEAST_AREA * GRID * 10 else [plan]
