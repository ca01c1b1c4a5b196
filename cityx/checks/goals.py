"""Whether a city has what was asked of it, measured on its layout and on what was built of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.checks.quantities import QUANTITIES
from cityx.city import City, Goal

Wanted = Mapping[str, Any]
Finding = tuple[bool, str]
FloatArray = NDArray[np.float64]

NEAR = 250.0  # metres from what towers stand around to each of them
AROUND = np.pi  # radians; a wider gap between two of them as seen from there is an open side
SMALLEST = 300.0  # square metres of a plaza, park or lake that counts
TOUCH = 0.5  # metres between pieces of one area
POINTS = 0.02  # of a share, by which it may be missed
NEARLY = 0.05  # metres of height
NEARLY_NONE = 1e-6  # of a number, that sums in another order may differ by
WATER = ("water", "sea", "river")
KINDS: Mapping[str, tuple[str, ...]] = {
    "plaza": ("pedestrian",), "park": ("park",), "lake": ("water", "sea"), "water": WATER,
}  # fmt: skip


def measured(city: City, goal: Goal) -> Finding:
    """Return whether a goal is met, and what was measured."""
    return _MEASURES[goal.measure](city, goal.wanted)


def places_of(city: City, word: str) -> NDArray[Any]:
    """Return the plazas, parks or lakes of a city: areas of the kind, those that touch as one."""
    table = city.layout.areas
    shapes = table.geometry.to_numpy()[table["kind"].isin(KINDS[word]).to_numpy()]
    if not len(shapes):
        return np.zeros(0, object)
    grown = shapely.union_all(shapely.buffer(shapes, TOUCH, join_style="mitre"))
    found = shapely.get_parts(shapely.buffer(grown, -TOUCH, join_style="mitre"))
    return np.asarray(found[shapely.area(found) >= SMALLEST])


def _towers(city: City, wanted: Wanted) -> Finding:
    table = city.layout.buildings
    height = table["height"].to_numpy()
    low, high = float(wanted["lowest"]), float(wanted["highest"])
    rows = np.flatnonzero((height >= low - NEARLY) & (height <= high + NEARLY))
    built = _is_built(city)[rows]
    evidence = f"{len(rows)} buildings of the layout are {low:g} to {high:g} m high"
    if len(rows):
        evidence += f" ({height[rows].min():.1f} to {height[rows].max():.1f} m)"
    met = len(rows) == int(wanted["count"]) and bool(built.all())
    evidence += f", {int(built.sum())} of them are built"
    if wanted.get("around", "nothing") != "nothing" and len(rows):
        middles = shapely.get_coordinates(shapely.centroid(table.geometry.to_numpy()[rows]))
        around, more = _stand_around(city, str(wanted["around"]), middles)
        met, evidence = met and around, f"{evidence}; {more}"
    return met, evidence


def _stand_around(city: City, word: str, middles: FloatArray) -> Finding:
    """Tell whether places lie round one area of a kind, near it and on all sides."""
    best: Finding = (False, f"there is no {word}")
    for place in places_of(city, word).tolist():
        away = shapely.distance(shapely.points(middles), place)
        x, y = shapely.get_coordinates(place.centroid)[0]
        turn = np.sort(np.arctan2(middles[:, 1] - y, middles[:, 0] - x))
        gap = float(np.diff(np.append(turn, turn[0] + 2 * np.pi)).max())
        found = bool(away.max() <= NEAR) and (gap <= AROUND or len(turn) < 3)
        evidence = (
            f"they stand within {away.max():.0f} m of a {word} of {place.area:.0f} m2, "
            f"the widest gap between them is {np.degrees(gap):.0f} degrees"
        )
        if found or not best[0]:
            best = (found, evidence) if found or away.max() <= NEAR else best
        if found:
            return best
    return best


def _is_built(city: City) -> NDArray[np.bool_]:
    """(n,) whether each building of the layout has a shape in the scene."""
    ids = [np.zeros(0, np.uint64)]
    if "buildings" in city.scene.meshes:
        ids.append(city.scene.meshes["buildings"].object_id)
    if "building_assets" in city.scene.instances:
        ids.append(city.scene.instances["building_assets"].owner)
    return np.isin(city.layout.buildings["id"].to_numpy(), np.concatenate(ids))


def _places(city: City, wanted: Wanted) -> Finding:
    found = places_of(city, str(wanted["kind"]))
    sizes = ", ".join(f"{area:.0f}" for area in sorted(shapely.area(found), reverse=True)[:8])
    return (
        len(found) == int(wanted["count"]),
        f"there are {len(found)} of at least {SMALLEST:g} m2" + (f": {sizes} m2" if sizes else ""),
    )


def _highest(city: City, wanted: Wanted) -> Finding:
    height = city.layout.buildings["height"].to_numpy()
    most = float(height.max(initial=0.0))
    return abs(most - float(wanted["height"])) <= NEARLY, f"the highest building is {most:.1f} m"


def share_slack(area: FloatArray) -> float:
    """Return by how much a share of the ground may be missed: half a usual building, if larger."""
    return max(POINTS, float(np.median(area) / area.sum()) / 2) if len(area) else POINTS


def _share(city: City, wanted: Wanted) -> Finding:
    table = city.layout.buildings
    area = shapely.area(table.geometry.to_numpy())
    uses = table["use"].to_numpy().astype(str) == str(wanted["use"])
    share = float(area[uses].sum() / max(area.sum(), 1e-9))
    return (
        abs(share - float(wanted["share"])) <= share_slack(area),
        f"{100 * share:.1f} % of the ground under buildings, {int(uses.sum())} of {len(uses)}",
    )


def _crossings(city: City, wanted: Wanted) -> Finding:
    roads, areas = city.layout.roads, city.layout.areas
    bridges = roads.geometry.to_numpy()[roads["bridge"].to_numpy(bool)]
    water = areas.geometry.to_numpy()[areas["kind"].isin(WATER).to_numpy()]
    over, _ = shapely.STRtree(water).query(bridges, predicate="intersects")
    names = sorted(set(roads["name"].to_numpy()[roads["bridge"].to_numpy(bool)][np.unique(over)]))
    count = len(np.unique(over))
    return (
        count >= int(wanted["count"]) and bool(len(water)),
        f"{count} bridges lead over water"
        + (f": {', '.join(filter(None, names))}" if names else ""),
    )


def _quantity(city: City, wanted: Wanted) -> Finding:
    """Compare a quantity with its bounds."""
    of = str(wanted["of"])
    value = float(QUANTITIES[of](city))
    low, high = float(wanted.get("least", -np.inf)), float(wanted.get("most", np.inf))
    return low - NEARLY_NONE <= value <= high + NEARLY_NONE, f"{of} is {value:.4g}"


_MEASURES: Mapping[str, Callable[[City, Wanted], Finding]] = {
    "towers": _towers, "places": _places, "highest": _highest, "share": _share,
    "crossings": _crossings, "quantity": _quantity,
}  # fmt: skip
