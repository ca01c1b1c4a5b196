"""Who drives where."""

from collections import Counter

import pytest

from cityx.motion.vehicles import halts_of, looks_of_kinds
from cityx.places.profiles import profile_named
from cityx.traffic.demand import demand_of, per_km_at
from cityx.traffic.laying import streets_of
from tests.traffic.made_streets import EAST, MIDDLE, NORTH, SOUTH, WEST, city_of

VEHICLES = profile_named("world").vehicles


@pytest.mark.parametrize(("kind", "fed"), [("secondary", True), ("residential", False)])
def test_a_main_road_that_ends_amid_the_map_brings_traffic(kind, fed):
    short = [(0, -70), MIDDLE, (0, 70)]
    streets = [([WEST, MIDDLE, EAST], {"kind": "unclassified"}), (short, {"kind": kind})]
    houses = [(x, y, x + 20, y + 20) for x in (-60, 30) for y in (-60, 30)]
    city = city_of(streets, houses=houses)
    demand = demand_of(
        city, streets_of(city, halts_of(city)), looks_of_kinds(VEHICLES), hour=12.0, seconds=60.0,
        per_km=per_km_at("heavy", 12.0), purpose="test",
    )  # fmt: skip
    trips = [trip for group in demand.groups for trip in group.trips]
    ways = Counter(trip.route[0] for trip in trips if trip.rolling)
    ends = {name for name in ways if ways[name] > 0.1 * len(trips)}
    assert len(ends) == (4 if fed else 2)


def test_streets_to_the_border_feed_traffic_by_all_their_ends():
    city = city_of([([WEST, MIDDLE, EAST], {}), ([SOUTH, MIDDLE, NORTH], {})])
    demand = demand_of(
        city, streets_of(city, halts_of(city)), looks_of_kinds(VEHICLES), hour=12.0, seconds=60.0,
        per_km=per_km_at("heavy", 12.0), purpose="test",
    )  # fmt: skip
    starts = {trip.route[0] for group in demand.groups for trip in group.trips if trip.rolling}
    assert len(starts) == 4


@pytest.mark.parametrize(("kind", "barred"), [("residential", False), ("service", True)])
def test_lorries_and_buses_turn_into_no_street_that_is_too_narrow_for_them(kind, barred):
    city = city_of([([WEST, MIDDLE, EAST], {}), ([SOUTH, MIDDLE, NORTH], {"kind": kind})])
    streets = streets_of(city, halts_of(city))
    demand = demand_of(
        city, streets, looks_of_kinds(VEHICLES), hour=12.0, seconds=60.0,
        per_km=per_km_at("heavy", 12.0), purpose="test",
    )  # fmt: skip
    ends = [link.shape[-1, :2] for link in streets.links]
    aside = {number for number, end in enumerate(ends) if abs(end[1]) > abs(end[0])}
    assert aside
    assert aside.issubset(demand.tight) == barred
