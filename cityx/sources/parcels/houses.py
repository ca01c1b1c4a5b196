"""Houses on plots: terraced rows, suburbs and farms."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.plots import Pads, Plots, pads_in
from cityx.geometry.polygons import FloatArray
from cityx.geometry.seams import unite
from cityx.sources.parcels.built import Built, building_tags, built, habitable, pad_box

FAR = 500.0  # metres; wider than any parcel
GARAGE = (3.2, 6.0)  # metres wide and deep
PATH = 1.3  # metres wide
FARM_DEPTH = 9.5  # metres of a farmhouse
SMALL_FARM = 80.0  # square metres; a smaller farmhouse has no barn
YARD = 8.0  # metres between farmhouse and barn
DEEPEST = 45.0  # metres from the street beyond which no house stands
TERRACE_DEPTH = (9.6, 11.0)  # metres
OUTRIGGER = 0.55  # of the house's width that its rear wing takes
SHORTEST_WING, LONGEST_WING = 1.5, 6.5  # metres


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
    """Unite houses with wings where that gives one outline."""
    whole = houses.copy()
    rows = np.flatnonzero(fits)
    whole[rows] = unite(houses[rows], wings[rows])
    return np.where(shapely.get_type_id(whole) == 3, whole, houses)


def suburban_houses(plots: Plots, target: float, *, seed: int) -> list[Built]:
    """Raise detached houses with a garage, a drive, a path and now and then a shed."""
    setback = plots.draw_alike("setback", 4.0, 7.0, seed=seed)
    setback = setback + plots.draw("setback", -0.6, 1.2, seed=seed)
    pads = pads_in(plots, plots.room(front=setback, side=1.6), deepest=DEEPEST)
    wanted = target * plots.area - GARAGE[0] * GARAGE[1]
    house_width = np.clip(pads.width - GARAGE[0] - 0.4, 0.0, 15.0)
    garage = (pads.width >= 7.0 + GARAGE[0]) & (pads.depth > GARAGE[1] + 2.5)
    house_width = np.where(garage, house_width, np.minimum(pads.width, 15.0))
    wanted = np.where(garage, wanted, target * plots.area)
    depth = np.clip(wanted / np.maximum(house_width, 1.0), 6.5, 14.0)
    house_width = np.minimum(house_width, np.maximum(wanted / depth, 6.5))
    depth = np.minimum(depth, pads.depth)
    mirrored = plots.draw("mirror", 0, 1, seed=seed) < 0.5
    block = house_width + np.where(garage, GARAGE[0], 0.0)
    start = pads.x0 + plots.draw("shift", 0.2, 0.8, seed=seed) * np.maximum(pads.width - block, 0)
    x0 = np.where(mirrored & garage, start + GARAGE[0], start)
    house = _angled(plots, x0, pads.y0, house_width, depth, mirrored, seed=seed)
    stands = habitable(house) & (house_width > 6.0)
    hipped = plots.draw("roof", 0, 1, seed=seed)
    levels = 1.0 + (plots.draw("levels", 0, 1, seed=seed) < 0.3 + 0.5 * plots.density)
    tags = building_tags(plots, "detached", levels)
    for own, u in zip(tags, hipped.tolist(), strict=True):
        own["roof:shape"] = "hipped" if u < 0.35 else "gabled"
    g0 = np.where(mirrored, x0 - GARAGE[0], x0 + house_width)
    back = pads.y0 + 1.5
    park = plots.boxes(g0, back, g0 + GARAGE[0], back + GARAGE[1])
    garage &= stands
    drive = plots.within(plots.boxes(g0 + 0.2, -1.0, g0 + GARAGE[0] - 0.2, back))
    door = x0 + house_width / 2
    path = plots.within(plots.boxes(door - PATH / 2, -1.0, door + PATH / 2, pads.y0))
    shed, has_shed = _sheds(plots, pads, pads.y0 + np.maximum(depth, GARAGE[1] + 1.5), seed=seed)
    return [
        built("house", house, tags, stands),
        built("garage", park, {"building": "garage", "building:levels": "1", "roof:shape": "flat"},
              garage),
        built("shed", shed, {"building": "shed", "building:levels": "1", "roof:shape": "gabled"},
              has_shed & stands),
        built("drive", drive, {"area:highway": "service"}, garage & _plain(drive)),
        built("path", path, {"area:highway": "footway"}, stands & _plain(path)),
    ]  # fmt: skip


def _plain(shapes: NDArray[Any]) -> NDArray[np.bool_]:
    return np.asarray(shapely.get_type_id(shapes) == 3)


def _angled(
    plots: Plots, x0: FloatArray, y0: FloatArray, width: FloatArray, depth: FloatArray,
    mirrored: NDArray[np.bool_], *, seed: int,
) -> NDArray[Any]:  # fmt: skip
    """Return house plans: plain, or with a front corner or a rear corner left out."""
    u = plots.draw("plan", 0, 1, seed=seed)
    cut_x = width * plots.draw("cut-x", 0.35, 0.5, seed=seed)
    cut_y = np.minimum(depth * 0.3, 2.6)
    angled = (u < 0.6) & (width > 9.5) & (depth > 8.0)
    front = u < 0.35
    zero = np.zeros(plots.count)
    # A ring of six corners; those of the notch fall together where there is none.
    notch_x, notch_y = np.where(angled, cut_x, 0.0), np.where(angled, cut_y, 0.0)
    ring = np.array([
        [zero, zero], [width - notch_x, zero], [width - notch_x, notch_y], [width, notch_y],
        [width, depth], [zero, depth],
    ])  # (6, 2, m)  # fmt: skip
    x, y = ring[:, 0].T.copy(), ring[:, 1].T.copy()
    flip_x, flip_y = mirrored & angled, ~front & angled
    x[flip_x] = width[flip_x, None] - x[flip_x]
    y[flip_y] = depth[flip_y, None] - y[flip_y]
    corners = np.stack([x + x0[:, None], y + y0[:, None]], axis=2)
    plans = plots.outlines(corners)
    plain = plots.boxes(x0, y0, x0 + width, y0 + depth)
    return np.where(angled, plans, plain)


def _sheds(
    plots: Plots, pads: Pads, behind: FloatArray, *, seed: int
) -> tuple[NDArray[Any], NDArray[np.bool_]]:
    """Return sheds in a rear corner of the pads, and which gardens have one."""
    width = plots.draw("shed", 2.2, 3.4, seed=seed)
    left = plots.draw("shed-side", 0, 1, seed=seed) < 0.5
    x0 = np.where(left, pads.x0, pads.x1 - width)
    has = (pads.y1 - behind > 6.0) & (pads.width > 5.0)
    has &= plots.draw("shed-or-not", 0, 1, seed=seed) < 0.4
    return plots.boxes(x0, pads.y1 - 2.6, x0 + width, pads.y1), has


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
