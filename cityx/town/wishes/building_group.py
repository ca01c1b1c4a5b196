"""Groups: so many buildings of a kind in one place, or added to a map, and their storeys."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Annotated, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.checks.predicates.measuring import rows_of
from cityx.checks.predicates.whereabouts import is_in_part, is_near
from cityx.checks.predicates.words import BESIDE, LEAST_BUILDING, SITE_PARTS
from cityx.city import City
from cityx.city.asked_goals import asked
from cityx.city.bounds import is_stated
from cityx.errors import ActionFailed, UsageError
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.ids import stable_id, uniform
from cityx.protocol import Choice, Port, Range, action
from cityx.town.building_groups import FARTHEST, GROUP_KINDS, BuildingGroup
from cityx.town.elements import Element, Volume
from cityx.town.lots import Lot, body_of, lot_of, lots_along_streets, plans_of
from cityx.town.quarter_kinds import ANY_FLOORS, Kind
from cityx.town.rebuilding import cleared, without_buildings
from cityx.town.wishes.counting import asked_for, divided
from cityx.town.wishes.elements import WHERE, drawn
from cityx.town.wishes.kind_counts import named
from cityx.town.wishes.limits import MOST, TALLEST, check_floors, within_limits
from cityx.town.wishes.quarters import rebuilt_as
from cityx.town.wishes.standing import ANYTHING, shapes_of
from cityx.town.wishes.street_design import with_main_street
from cityx.town.wishes.uses import with_uses

MANY = 100_000  # buildings; there may be any number
YARD, FRONT = 2.0, 1.0  # metres beside a house and behind it, and before it, up to its lot's border
SMALLEST = 0.7  # scale down to which a plan may shrink where land is short
# Square metres that one has at least, so that it still is of its kind.
LEAST_PLAN: Mapping[str, float] = MappingProxyType({"warehouse": 260.0, "factory": 620.0})
LEAST_HOUSE = 50.0
FEW = 3  # buildings that are built one by one, and no blocks for them
PAIRED = ("house", "cottage", "terrace")  # kinds of which one may become two, wall to wall
STOREY, HALL = 3.2, 7.5  # metres of a storey of a house and of one of a hall
HALLS = ("warehouse", "factory")
# Metres along the street and away from it, and storeys, of a building that is added.
PLANS: Mapping[str, tuple[float, float, int]] = MappingProxyType({
    "house": (10.0, 10.0, 2), "villa": (12.0, 12.0, 2), "cottage": (9.0, 9.0, 1),
    "bungalow": (12.0, 9.0, 1), "terrace": (7.0, 11.0, 2), "apartment": (18.0, 15.0, 5),
    "office": (26.0, 16.0, 5), "shop": (11.0, 12.0, 2), "warehouse": (32.0, 20.0, 1),
    "factory": (40.0, 28.0, 1), "building": (12.0, 11.0, 3),
})  # fmt: skip
USES: Mapping[str, str] = MappingProxyType({"building": "yes", "terrace": "terrace"})


@action(
    "layout/building_group-v1",
    limits=[
        "Buildings there become of the kind, or are taken down where they are too many.",
        "Where these do not suffice, blocks there are built on anew, and then free lots.",
        "On a map what stands is kept, and buildings are added on free lots alone.",
    ],
    requires=("layout",),
    after=("layout/quarter-v1",),
    takes=(Port("layout", "scene_layout"),),
    gives=(Port("layout", "scene_layout"),),
    labels=("number", "group", "some of the buildings", "near", "added"),
)
def building_group(
    city: City,
    *,
    kind: Annotated[str, Choice(*GROUP_KINDS)] = "house",
    part: Annotated[str, Choice("any", *SITE_PARTS)] = "any",
    near: Annotated[str, Choice(*WHERE)] = ANYTHING,
    within: Annotated[int, Range(1, FARTHEST)] = int(BESIDE),
    added: bool = False,
    least: Annotated[int, Range(0, MANY)] = 0,
    most: Annotated[int, Range(0, MANY)] = MANY,
    least_floors: Annotated[int, Range(1, MOST)] = 1,
    most_floors: Annotated[int, Range(1, MOST)] = MOST,
    lowest: Annotated[float, Range(0.0, TALLEST)] = 0.0,
    highest: Annotated[float, Range(2.5, TALLEST)] = TALLEST,
) -> City:
    """Let so many buildings of a kind stand in one place, within limits of their storeys.

    Parameters
    ----------
    city
        City with buildings.
    kind
        What they are.
    part
        Of the site: its middle, its edge, a side or a half; a side is less than its half.
    near
        What they stand near.
    within
        Metres from that within which they are near it.
    added
        Whether those alone are meant that no map has; they are built on free lots.
    least, most
        How many of them there are in that place.
    least_floors, most_floors
        Storeys above ground of each of them.
    lowest, highest
        Metres of each of them, roof included.

    Raises
    ------
    UsageError
        If bounds are out of order, or nothing is said of which buildings are meant.
    ActionFailed
        If there is no such place, or no room there.
    """
    _check(least, most, least_floors, most_floors, lowest, highest)
    place, beside = ("" if word in ("any", ANYTHING) else word for word in (part, near))
    group = BuildingGroup(kind, place, beside, within, added)
    if not group.is_known:
        raise UsageError('Say which of them are meant, by "part", by "near" or by "added".')
    there = There(city, group)
    city, own = there.city, GROUP_KINDS[kind]
    if not added:
        city = _fewer(city, group, most)
        city = _more(city, own, group, there, least)
    city = _built(city, group, there, least)
    if not added:
        city = _built(city, group, there, least, over=True)
        city = _halved(city, group, least)
    city = _fewer(city, group, most)
    rows = rows_of(group.chosen, city)
    if not least <= len(rows) <= most:
        raise ActionFailed(
            f"There are {len(rows)} of {group.text}, but {_said(least, most)} are asked for, and "
            "there is no room for more, or no more that could go."
        )
    if least:
        city = replace(city, layout=named(city.layout, kind, rows))
    rows = rows[~is_stated(city.layout.buildings)[rows]]
    floors, height = (least_floors, most_floors), (lowest, highest)
    city = replace(city, layout=within_limits(city, rows, floors, height))
    return _with_goals(city, group, (least, most), floors, height)


class There:
    """Where the buildings of a group stand."""

    def __init__(self, city: City, group: BuildingGroup) -> None:
        self.city = with_main_street(city) if group.near == "main_street" else city
        self.group = group
        self.places = shapes_of(self.city, group.beside) if group.near else np.zeros(0, object)
        if group.near and not len(self.places):
            word, near = (one.replace("_", " ") for one in (group.kind, group.near))
            raise ActionFailed(f"There is no {near} for a {word} to be within {group.within} m of.")

    def holds(self, shapes: NDArray[Any]) -> BoolArray:
        """(n,) whether shapes lie there."""
        found = np.ones(len(shapes), bool)
        if self.group.part:
            found &= is_in_part(shapes, self.group.part, self.city.layout.extent)
        if len(self.places):
            found &= is_near(shapes, self.places, self.group.within)
        return found

    def away(self, shapes: NDArray[Any]) -> FloatArray:
        """(n,) metres from what the group stands near, 0 where it stands near nothing."""
        if not len(self.places):
            return np.zeros(len(shapes))
        return np.asarray(np.round(shapely.distance(shapes, shapely.union_all(self.places)), 1))


def _check(
    least: int, most: int, least_floors: int, most_floors: int, lowest: float, highest: float
) -> None:
    """Check that bounds are in order."""
    if least > most:
        raise UsageError(f"least = {least} is more than most = {most}.")
    check_floors(least_floors, most_floors)
    if lowest > highest:
        raise UsageError(f"lowest = {lowest:g} m is more than highest = {highest:g} m.")


def _said(least: int, most: int) -> str:
    if least == most:
        return f"{least}"
    if most == MANY:
        return f"at least {least}"
    return f"{least} to {most}" if least else f"at most {most}"


def _fewer(city: City, group: BuildingGroup, most: int) -> City:
    """Take down those that are too many, drawn; those that were asked for before stay."""
    rows = rows_of(group.chosen, city)
    surplus = len(rows) - most
    if surplus <= 0:
        return city
    free = rows[~asked_for(city.layout)[rows]]
    ids = city.layout.buildings["id"].to_numpy(np.uint64)[free]
    gone = free[np.argsort(uniform(city.seed, "layout/building_group", ids), kind="stable")]
    return replace(city, layout=without_buildings(city.layout, np.sort(gone[:surplus])))


def _more(city: City, own: Kind, group: BuildingGroup, there: There, least: int) -> City:
    """Let buildings there become of the kind, or build blocks there anew, as far as that goes."""
    lacking = least - len(rows_of(group.chosen, city))
    if lacking <= 0:
        return city
    stand = city.layout.buildings.geometry.to_numpy()
    free = there.holds(stand) & ~asked_for(city.layout)
    has = np.zeros(len(stand), bool)
    has[rows_of(own.chosen, city)] = True
    area = shapely.area(stand)
    suits = np.flatnonzero(
        free & ~has & (area >= max(own.area[0], LEAST_BUILDING)) & (area <= own.area[1])
    )
    if own.zone and lacking - len(suits) > FEW and free.any():
        try:
            laid = rebuilt_as(city, own, group.kind, stand[free])
        except ActionFailed:
            return _converted(city, own, group.kind, suits)
        city = replace(city, layout=laid)
        short = least - len(rows_of(group.chosen, city))
        if group.kind == "house" and short > FEW and own.zone != "row":  # in rows there are more
            return _more(city, replace(own, zone="row"), group, there, least)
        return city
    levels = city.layout.buildings["levels"].to_numpy(float)[suits]
    beyond = np.maximum(levels - own.floors[1], 0) + np.maximum(own.floors[0] - levels, 0)
    order = np.lexsort((there.away(stand[suits]), beyond, area[suits] < own.roomy))
    return _converted(city, own, group.kind, np.sort(suits[order[:lacking]]))


def _converted(city: City, own: Kind, kind: str, rows: IntArray) -> City:
    """Let some buildings be of a kind."""
    uses = city.layout.buildings["use"].to_numpy().astype(object)
    uses[rows] = own.use or USES.get(kind, kind)
    city = with_uses(city, uses)
    if own.floors == ANY_FLOORS:
        return city
    return replace(city, layout=within_limits(city, rows, own.floors))


def _built(
    city: City, group: BuildingGroup, there: There, least: int, *, over: bool = False
) -> City:
    """Build what lacks on free lots, nearest to what the group stands near first.

    Parameters
    ----------
    over
        Whether other buildings may be taken down for it, that nobody asked for.
    """
    element = _element(group.kind)
    while (lacking := least - len(rows_of(group.chosen, city))) > 0:
        table = city.layout.buildings
        kept = np.full(len(table), not over)
        kept[rows_of(group.chosen, city)] = True
        stand = table.geometry.to_numpy()[kept | asked_for(city.layout)]
        lots = _lots(city, element, there, stand)[:lacking]
        if not lots:
            return city
        layout = city.layout
        for lot in lots:
            layout = cleared(layout, lot.placed(lot_of(element)))
            layout = drawn(city, layout, element, lot)
        city = replace(city, layout=layout)
        if group.kind != "building" and len(rows_of(group.chosen, city)) <= least - lacking:
            return city  # what is built is not of the kind; more of it would not help
    return city


def _halved(city: City, group: BuildingGroup, least: int) -> City:
    """Let the largest houses of a group be two, where a few lack."""
    rows = rows_of(group.chosen, city)
    lacking = least - len(rows)
    if group.kind not in PAIRED or not 0 < lacking <= len(rows):
        return city
    try:
        return replace(city, layout=divided(city, city.layout, rows, lacking))
    except ActionFailed:  # said by how many there are
        return city


def _lots(city: City, element: Element, there: There, stand: NDArray[Any]) -> list[Lot]:
    """Return lots there that neither overlap nor take what stands, the best first."""
    layout = city.layout
    houses = shapely.STRtree(stand)

    def fits(lots: list[Lot]) -> list[Lot]:
        if not lots:
            return lots
        held = there.holds(plans_of(lots, body_of(element)))
        plans = plans_of(lots, lot_of(element))
        held[houses.query(plans, predicate="intersects")[0]] = False
        return [lots[at] for at in np.flatnonzero(held).tolist()]

    lots = lots_along_streets(layout, element, fits)
    if not lots:
        return []
    plans = plans_of(lots, lot_of(element))
    middles = shapely.get_coordinates(shapely.centroid(plans))
    ids = np.array(
        [stable_id("group", x, y) for x, y in np.round(middles * 10).astype(np.int64).tolist()],
        np.uint64,
    )
    lot = uniform(city.seed, "layout/building_group", ids)
    chosen: list[int] = []
    taken = np.zeros(len(lots), bool)
    tree = shapely.STRtree(plans)
    for at in np.lexsort((lot, there.away(plans))).tolist():
        if not taken[at]:
            chosen.append(at)
            taken[tree.query(plans[at], predicate="intersects")] = True
    return [lots[at] for at in chosen]


def _element(kind: str) -> Element:
    """Return a building of usual size on its lot."""
    width, depth, floors = PLANS[kind]
    storey = HALL if kind in HALLS else STOREY
    body = Volume(
        box=(-width / 2, FRONT, width / 2, FRONT + depth), height=floors * storey, floors=floors
    )
    own = GROUP_KINDS[kind]
    shrunk = math.sqrt(LEAST_PLAN.get(kind, LEAST_HOUSE) / (width * depth))
    return Element(
        kind, own.chosen, least=max(SMALLEST, shrunk), lot=(width + 2 * YARD, depth + FRONT + YARD),
        building={"building": own.use or USES.get(kind, kind)}, parts=(body,),
    )  # fmt: skip


def _with_goals(
    city: City, group: BuildingGroup, number: tuple[int, int], floors: tuple[int, int],
    height: tuple[float, float],
) -> City:  # fmt: skip
    """Add what the group is asked to keep, measured on the group alone."""
    least, most = number
    if least or most < MANY:
        ends = {
            "least": least if least or not most else None,
            "most": most if most < MANY else None,
        }
        city = asked(city, f"{_said(least, most)} of {group.text}", f"n({group.chosen})", **ends)
    for name, (low, high), (none, any_number) in (
        ("floors", floors, (1, MOST)), ("height", height, (0.0, TALLEST)),
    ):  # fmt: skip
        if low > none:
            of = f"stat({group.chosen}, {name}, min)"
            city = asked(city, f"{name} of {group.text}", of, least=low)
        if high < any_number:
            of = f"stat({group.chosen}, {name}, max)"
            city = asked(city, f"{name} of {group.text}", of, most=high)
    return city
