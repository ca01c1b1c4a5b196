"""Houses on plots, terraced, in suburbs and on farms; and what every building on a plot is."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.parcels.plots import Pads, Plots, pads_in
from cityx.geometry.seams import moved, unite
from cityx.ids import UInt64Array, id_text
from cityx.sources.features.building_heights import TYPE_OF_USE, height_of_levels, levels_of_height
from cityx.sources.features.tagged import Owner, Tagged, Tags

FAR = 500.0  # metres; wider than any parcel
GARAGE = (3.2, 6.0)  # metres wide and deep
GARAGE_BACK = 1.5  # metres that a garage stands behind the front of its house
JAMB = 0.2  # metres beside a garage door
BEHIND = 2.5  # metres of room that a garage needs besides its own depth
PATH = 1.3  # metres wide
FRONT_GARDEN = (4.0, 7.0)  # metres, alike along a block
STEP_BACK = (-0.6, 1.2)  # metres by which a house leaves the line of its block
SIDE_YARD = 1.6  # metres between a house and its neighbour's ground
SMALLEST_SIDE, LARGEST_SIDE = 6.5, 14.5  # metres of a detached house
ANGLED = 0.6  # of the houses that have a notch, where they are large enough
NOTCHED = (9.5, 8.0)  # metres wide and deep
TWO_STOREYS = 0.3  # of the houses where density is least
HIPPED = 0.35  # of the roofs
SHED, SHEDS = 2.6, 0.4  # metres deep; share of gardens that have one
FARM_DEPTH = 9.5  # metres of a farmhouse
SMALL_FARM = 80.0  # square metres; a smaller farmhouse has no barn
YARD = 8.0  # metres between farmhouse and barn
DEEPEST = 45.0  # metres from the street beyond which no house stands
TERRACE_DEPTH = (9.6, 11.0)  # metres
OUTRIGGER = 0.55  # of the house's width that its rear wing takes
SHORTEST_WING, LONGEST_WING = 1.5, 6.5  # metres
# Metres of the halves of pairs of houses: deep, wide at least and at most; beside them; and the
# share of blocks whose pairs have one storey.
SEMI_DEPTH, LEAST_HALF, WIDEST_HALF, DRIVE, ONE_STOREY = (8.6, 10.2), 5.2, 7.6, 2.8, 0.12
BY_FENCE = 0.3  # metres of a drive from the neighbour's ground
LEAST_ROOM = 4.2  # metres; no building is narrower
LOST = 0.25  # of a building, how much may be corners too narrow for a room
LEAST_AREA = 30.0  # square metres; nor smaller


def row_houses(plots: Plots, target: float, *, seed: int) -> list[Built]:
    """Raise terraces: houses wall to wall, of one depth along a block, with wings behind."""
    depth = plots.draw_alike("terrace-depth", *TERRACE_DEPTH, seed=seed)
    setback = plots.draw_alike("terrace-setback", 0.0, 4.0, seed=seed) * (1 - plots.density)
    house = plots.within(plots.boxes(-FAR, setback, FAR, setback + depth))
    stands = habitable(house)
    missing = target * plots.area - shapely.area(house)
    wing = OUTRIGGER * plots.width
    left = plots.draw("wing-side", 0, 1, seed=seed) < 0.5
    reach = np.clip(missing / np.maximum(wing, 1.0), 0.0, LONGEST_WING)
    x0 = np.where(left, plots.low[:, 0], plots.high[:, 0] - wing)
    back = setback + depth
    behind = plots.within(plots.boxes(x0, back, x0 + wing, back + reach))
    fits = stands & (reach > SHORTEST_WING) & (shapely.area(behind) > 0.9 * wing * reach)
    house = _with_wings(house, behind, fits)
    levels = 2.0 + np.rint(plots.draw_alike("terrace-levels", 0.0, 1.0, seed=seed) * plots.density)
    tags = building_tags(plots, "terrace", levels, **{"roof:shape": "gabled"})
    return [built("house", house, tags, stands)]


def _with_wings(houses: NDArray[Any], wings: NDArray[Any], fits: NDArray[np.bool_]) -> NDArray[Any]:
    """Merge houses with wings where that gives one outline."""
    whole = houses.copy()
    rows = np.flatnonzero(fits)
    whole[rows] = unite(houses[rows], wings[rows])
    return np.where(shapely.get_type_id(whole) == 3, whole, houses)


@dataclass(frozen=True)
class _Homes:
    """Boxes of detached houses in the frames of their plots, (m,) metres each.

    Attributes
    ----------
    x0, y0, width, depth
        Of the house; y0 is its front.
    garage
        (m,) whether a garage stands beside it.
    mirrored
        (m,) whether that is on its left.
    """

    x0: FloatArray
    y0: FloatArray
    width: FloatArray
    depth: FloatArray
    garage: NDArray[np.bool_]
    mirrored: NDArray[np.bool_]


def suburban_houses(plots: Plots, target: float, *, seed: int) -> list[Built]:
    """Raise detached houses with a garage, a drive, a path and now and then a shed."""
    setback = plots.draw_alike("setback-of-block", *FRONT_GARDEN, seed=seed)
    setback = setback + plots.draw("setback", *STEP_BACK, seed=seed)
    pads = pads_in(plots, plots.room(front=setback, side=SIDE_YARD), deepest=DEEPEST)
    homes = _homes(plots, pads, target, seed=seed)
    house = _angled(plots, homes, seed=seed)
    stands = habitable(house)
    two_storeys = plots.draw("levels", 0, 1, seed=seed) < TWO_STOREYS + plots.density / 2
    tags = building_tags(plots, "detached", 1.0 + two_storeys)
    for own, drawn in zip(tags, plots.draw("roof", 0, 1, seed=seed).tolist(), strict=True):
        own["roof:shape"] = "hipped" if drawn < HIPPED else "gabled"
    return [
        built("house", house, tags, stands),
        *_garages(plots, homes, stands),
        *_backyards(plots, pads, homes, stands, seed=seed),
    ]


def semi_houses(plots: Plots, target: float, *, seed: int) -> list[Built]:
    """Raise pairs of houses that share a wall, with a drive beside each of the two."""
    setback = plots.draw_alike("setback-of-block", *FRONT_GARDEN, seed=seed)
    pads = pads_in(plots, plots.room(front=setback, side=BY_FENCE), deepest=DEEPEST)
    drive = np.where(pads.width >= 2 * (LEAST_HALF + DRIVE), DRIVE, SIDE_YARD)
    room = pads.width - 2 * drive
    depth = np.minimum(plots.draw_alike("semi-depth", *SEMI_DEPTH, seed=seed), pads.depth)
    half = np.clip(target * plots.area / np.maximum(2 * depth, 1.0), LEAST_HALF, WIDEST_HALF)
    half = np.minimum(half, room / 2)
    middle = (pads.x0 + pads.x1) / 2
    levels = np.where(plots.draw_alike("semi-levels", 0, 1, seed=seed) < ONE_STOREY, 1.0, 2.0)
    tags = building_tags(plots, "semidetached_house", levels, **{"roof:shape": "hipped"})
    homes = [plots.boxes(x0, pads.y0, x0 + half, pads.y0 + depth) for x0 in (middle - half, middle)]
    stands = habitable(homes[0]) & habitable(homes[1])
    found = [
        built("house-left", homes[0], tags, stands), built("house-right", homes[1], tags, stands),
    ]  # fmt: skip
    for name, x0 in (("left", middle - half - DRIVE), ("right", middle + half)):
        lane = plots.within(plots.boxes(
            x0 + JAMB, -1.0, x0 + DRIVE - JAMB, pads.y0 + GARAGE[1] / 2
        ))  # fmt: skip
        there = stands & (drive == DRIVE) & _plain(lane)
        found.append(built(f"drive-{name}", lane, {"area:highway": "service"}, there))
    return found


def _homes(plots: Plots, pads: Pads, target: float, *, seed: int) -> _Homes:
    """Size houses so that they and their garages take the wanted share of the plot."""
    wide, deep = GARAGE
    garage = (pads.width >= SMALLEST_SIDE + wide) & (pads.depth > deep + BEHIND)
    room = np.minimum(np.where(garage, pads.width - wide, pads.width), LARGEST_SIDE)
    wanted = target * plots.area - np.where(garage, wide * deep, 0.0)
    depth = np.clip(wanted / np.maximum(room, 1.0), SMALLEST_SIDE, LARGEST_SIDE)
    width = np.minimum(room, np.maximum(wanted / depth, SMALLEST_SIDE))
    depth = np.minimum(depth, pads.depth)
    mirrored = plots.draw("mirror", 0, 1, seed=seed) < 0.5
    spare = np.maximum(pads.width - width - np.where(garage, wide, 0.0), 0.0)
    x0 = pads.x0 + plots.draw("shift", 0.2, 0.8, seed=seed) * spare
    x0 = np.where(mirrored & garage, x0 + wide, x0)
    return _Homes(x0, pads.y0, width, depth, garage, mirrored)


def _garages(plots: Plots, homes: _Homes, stands: NDArray[np.bool_]) -> list[Built]:
    """Put garages beside houses, a little behind their fronts, with drives to the street."""
    wide, deep = GARAGE
    x0 = np.where(homes.mirrored, homes.x0 - wide, homes.x0 + homes.width)
    y0 = homes.y0 + GARAGE_BACK
    garage = plots.boxes(x0, y0, x0 + wide, y0 + deep)
    drive = plots.within(plots.boxes(x0 + JAMB, -1.0, x0 + wide - JAMB, y0))
    there = homes.garage & stands
    tags = {"building": "garage", "building:levels": "1", "roof:shape": "flat"}
    return [
        built("garage", garage, tags, there),
        built("drive", drive, {"area:highway": "service"}, there & _plain(drive)),
    ]


def _backyards(
    plots: Plots, pads: Pads, homes: _Homes, stands: NDArray[np.bool_], *, seed: int
) -> list[Built]:
    """Lay paths to the doors and put sheds into rear corners of the pads."""
    door = homes.x0 + homes.width / 2
    path = plots.within(plots.boxes(door - PATH / 2, -1.0, door + PATH / 2, homes.y0))
    width = plots.draw("shed", 2.2, 3.4, seed=seed)
    left = plots.draw("shed-side", 0, 1, seed=seed) < 0.5
    x0 = np.where(left, pads.x0, pads.x1 - width)
    shed = plots.boxes(x0, pads.y1 - SHED, x0 + width, pads.y1)
    behind = homes.y0 + np.maximum(homes.depth, GARAGE[1] + GARAGE_BACK)
    there = stands & (pads.y1 - behind > 2 * SHED) & (pads.width > width)
    there &= plots.draw("shed-or-not", 0, 1, seed=seed) < SHEDS
    tags = {"building": "shed", "building:levels": "1", "roof:shape": "gabled"}
    return [
        built("shed", shed, tags, there),
        built("path", path, {"area:highway": "footway"}, stands & _plain(path)),
    ]


def _plain(shapes: NDArray[Any]) -> NDArray[np.bool_]:
    return np.asarray(shapely.get_type_id(shapes) == 3)


def _angled(plots: Plots, homes: _Homes, *, seed: int) -> NDArray[Any]:
    """Return house plans: plain, or with a front corner or a rear corner left out."""
    width, depth = homes.width, homes.depth
    u = plots.draw("plan", 0, 1, seed=seed)
    cut_x = width * plots.draw("cut-x", 0.35, 0.5, seed=seed)
    cut_y = np.minimum(depth * 0.3, 2.6)
    angled = (u < ANGLED) & (width > NOTCHED[0]) & (depth > NOTCHED[1])
    front = u < ANGLED / 2
    zero = np.zeros(plots.count)
    # A ring of six corners; those of the notch fall together where there is none.
    notch_x, notch_y = np.where(angled, cut_x, 0.0), np.where(angled, cut_y, 0.0)
    ring = np.array([
        [zero, zero], [width - notch_x, zero], [width - notch_x, notch_y], [width, notch_y],
        [width, depth], [zero, depth],
    ])  # (6, 2, m)  # fmt: skip
    x, y = ring[:, 0].T.copy(), ring[:, 1].T.copy()
    flip_x, flip_y = homes.mirrored & angled, ~front & angled
    x[flip_x] = width[flip_x, None] - x[flip_x]
    y[flip_y] = depth[flip_y, None] - y[flip_y]
    corners = np.stack([x + homes.x0[:, None], y + homes.y0[:, None]], axis=2)
    plans = plots.outlines(corners)
    plain = plots.boxes(homes.x0, homes.y0, homes.x0 + width, homes.y0 + depth)
    return np.where(angled, plans, plain)


def farms(plots: Plots, target: float, *, seed: int) -> list[Built]:
    """Raise a farmhouse near the street and a barn behind, with a yard between."""
    setback = plots.draw("setback", 5.0, 10.0, seed=seed)
    pads = pads_in(plots, plots.room(front=setback, side=3.0), deepest=80.0)
    wanted = np.clip(target * plots.area, 90.0, 1200.0)
    barn_width = np.clip(np.sqrt(0.55 * wanted * 1.8), 0.0, pads.width)
    barn_depth = 0.55 * wanted / np.maximum(barn_width, 1.0)
    gap = pads.y0 + FARM_DEPTH + YARD
    works = (gap + barn_depth <= pads.y1) & (barn_depth > 5.0) & (0.45 * wanted > SMALL_FARM)
    house_area = np.where(works, 0.45, 1.0) * wanted
    house_width = np.minimum(np.clip(house_area / FARM_DEPTH, 9.0, 18.0), pads.width)
    at = plots.draw("shift", 0.0, 1.0, seed=seed)
    house = pad_box(plots, pads, house_width, FARM_DEPTH, at=at)
    stands = habitable(house)
    barn = plots.boxes(pads.x0, gap, pads.x0 + barn_width, gap + barn_depth)
    yard = plots.boxes(pads.x0, pads.y0 + FARM_DEPTH + 1.0, pads.x1, gap - 1.0)
    works &= stands & habitable(barn)
    levels = 1.0 + (plots.draw("levels", 0, 1, seed=seed) < 0.6)
    tags = building_tags(plots, "farm", levels, **{"roof:shape": "gabled"})
    barn_tags = {"building": "barn", "building:levels": "1", "roof:shape": "gabled"}
    return [
        built("house", house, tags, stands),
        built("barn", barn, barn_tags, works),
        built("yard", yard, {"landuse": "farmyard"}, works),
    ]


@dataclass(frozen=True)
class Built:
    """k shapes of one sort on plots, at most one for each plot.

    Attributes
    ----------
    name
        What tells them from other shapes of the same plots: "house".
    row
        (k,) plot.
    shapes
        (k,) where they lie in the frames of the plots, before ``Plots.shift``.
    tags
        (k,) their tags.
    """

    name: str
    row: IntArray
    shapes: NDArray[Any]
    tags: list[Tags]

    def of(self, rows: IntArray) -> Built:
        """Return the same on plots of which these are some: `rows` are their numbers."""
        return Built(self.name, rows[self.row], self.shapes, self.tags)


def built(
    name: str, shapes: NDArray[Any], tags: Tags | Sequence[Tags], where: NDArray[np.bool_]
) -> Built:
    """Put a shape on each of the plots marked, with its own tags or with the same for all."""
    row = np.flatnonzero(where & ~shapely.is_empty(shapes))
    own = [dict(tags) if isinstance(tags, dict) else tags[i] for i in row.tolist()]
    return Built(name, row, shapes[row], own)


def habitable(shapes: NDArray[Any]) -> NDArray[np.bool_]:
    """Return which shapes are single polygons wide and large enough to live in."""
    good = (shapely.get_type_id(shapes) == 3) & (shapely.area(shapes) >= LEAST_AREA)
    rows = np.flatnonzero(good)
    inner = shapely.buffer(shapes[rows], -LEAST_ROOM / 2 + 0.01, join_style="mitre")
    # Nothing that a room's width does not reach into may be more than a corner of the shape.
    opened = shapely.buffer(inner, LEAST_ROOM / 2, join_style="mitre")
    lost = shapely.area(shapely.difference(shapes[rows], opened))
    good[rows] = ~shapely.is_empty(inner) & (lost < LOST * shapely.area(shapes[rows]))
    return np.asarray(good, bool)


def building_tags(plots: Plots, use: str, levels: FloatArray, **more: str) -> list[Tags]:
    """Return tags of buildings: levels as drawn, or those of the height that is wanted."""
    types = np.full(plots.count, TYPE_OF_USE.get(use, 0))
    wanted = ~np.isnan(plots.height)
    fitting = levels_of_height(np.where(wanted, plots.height, 3.0), types)
    storeys = np.where(wanted, fitting, np.maximum(np.rint(levels), 1)).astype(int)
    found = []
    for count, height in zip(storeys.tolist(), plots.height.tolist(), strict=True):
        tags = {"building": use, "building:levels": str(count), **more}
        if height == height:
            tags["height"] = f"{height:.1f}"
        found.append(tags)
    return found


def heights_of(plots: Plots, use: str, levels: FloatArray) -> FloatArray:
    """Return metres of buildings: as wanted, or as high as their levels."""
    types = np.full(plots.count, TYPE_OF_USE.get(use, 0))
    usual = height_of_levels(np.maximum(np.rint(levels), 1), types)
    return np.where(np.isnan(plots.height), usual, plots.height)


def pad_box(plots: Plots, pads: Pads, width: Any, depth: Any, *, at: Any = 0.5) -> NDArray[Any]:
    """Return rectangles at the front of pads; `at` 0 is their left end, 1 their right one."""
    x0 = pads.x0 + at * np.maximum(pads.width - width, 0.0)
    return plots.boxes(x0, pads.y0, x0 + np.minimum(width, pads.width),
                       pads.y0 + np.minimum(depth, pads.depth))  # fmt: skip


def tagged_of(found: Iterable[Built], ids: UInt64Array, shift: FloatArray) -> Tagged:
    """Give shapes their owners and move them to where the plots lie, plot by plot."""
    owners: list[Owner] = []
    shapes: list[NDArray[Any]] = []
    rows: list[IntArray] = []
    for some in found:
        names = [id_text(one) for one in ids[some.row].tolist()]
        owners += [
            Owner(("parcel", name), tags, (some.name,))
            for name, tags in zip(names, some.tags, strict=True)
        ]
        shapes.append(some.shapes)
        rows.append(some.row)
    if not owners:
        return Tagged(np.zeros(0, object), np.zeros(0, np.int64), np.zeros(0, np.int64), [])
    row = np.concatenate(rows)
    order = np.argsort(row, kind="stable")
    placed = moved(np.concatenate(shapes)[order], shift[row[order]])
    return Tagged(
        placed,
        np.arange(len(owners)),
        np.zeros(len(owners), np.int64),
        [owners[index] for index in order.tolist()],
    )
