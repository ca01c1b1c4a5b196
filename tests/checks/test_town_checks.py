"""Towns laid out by rule have blocks, junctions and parcels like real ones; defects are found."""

from dataclasses import replace

import numpy as np
import pytest
import shapely

from cityx.checks.town_checks import check_towns
from cityx.city import Frame
from cityx.town.bounded_town import layout_of_site
from cityx.town.plane import PATTERNS, Plan
from cityx.town.window import layout_of_window

FRAME = Frame(50.0, 10.0)
BOX = (-230.0, -230.0, 230.0, 230.0)
NAMES = {
    "town_streets_at_junctions", "town_dead_ends", "town_blocks_not_small",
    "town_blocks_not_large", "town_parcels_off_street", "town_parcels_overlapping",
}  # fmt: skip


@pytest.fixture(scope="module")
def town():
    return layout_of_site((-300.0, -300.0, 300.0, 300.0), Plan(), 4, frame=FRAME)


def failing(layout):
    return {check.name for check in check_towns(layout) if not check.ok}


def with_roads(layout, lines, like=0):
    """Give a town other streets, all with the columns of one of its own."""
    rows = layout.roads.iloc[[like] * len(lines)].reset_index(drop=True).set_geometry(list(lines))
    return replace(layout, roads=rows)


@pytest.mark.parametrize("pattern", PATTERNS)
@pytest.mark.parametrize("k", range(5))
def test_towns_of_every_pattern_pass(pattern, k):
    plan = [Plan(pattern), Plan(pattern, 0.3), Plan(pattern, river=True), Plan(pattern, zone="row"),
            Plan(pattern, 0.95)][k]  # fmt: skip
    lay_out = layout_of_window if k % 2 else layout_of_site
    assert failing(lay_out(BOX, plan, 10 + k, frame=FRAME)) == set()


def test_every_property_of_a_town_is_measured(town):
    assert {check.name for check in check_towns(town)} == NAMES
    assert failing(town) == set()


def test_a_mapped_town_is_as_it_is(town):
    roads = town.roads.copy()
    roads.loc[0, "source"] = "osm/way/1"
    assert check_towns(replace(town, roads=roads)) == []


def test_blocks_without_their_streets_are_too_large(town):
    sides = np.arange(-900.0, 1000.0, 300.0)
    lines = [shapely.LineString([(x, y), (x, y + 300)]) for x in sides for y in sides]
    lines += [shapely.LineString([(x, y), (x + 300, y)]) for x in sides for y in sides]
    assert "town_blocks_not_large" in failing(with_roads(town, lines))


def test_streets_side_by_side_make_blocks_too_small(town):
    sides = np.arange(-300.0, 300.0, 30.0)
    lines = [shapely.LineString([(x, y), (x, y + 30)]) for x in sides for y in sides]
    lines += [shapely.LineString([(x, y), (x + 30, y)]) for x in sides for y in sides]
    assert "town_blocks_not_small" in failing(with_roads(town, lines))


def test_streets_that_lost_their_ends_are_blind(town):
    def shortened(line):
        return shapely.ops.substring(line, 4.0, line.length - 4.0)

    roads = town.roads.copy()
    short = roads.geometry.length.to_numpy() > 12.0
    roads.loc[short, "geometry"] = [shortened(line) for line in roads.geometry[short]]
    assert "town_dead_ends" in failing(replace(town, roads=roads))


def test_stars_of_streets_are_no_town(town):
    turn = np.arange(0.0, 2 * np.pi, np.pi / 4)
    spokes = 80.0 * np.column_stack([np.cos(turn), np.sin(turn)])
    hubs = [np.array([x, y]) for x in range(-240, 241, 120) for y in range(-240, 241, 120)]
    lines = [shapely.LineString([hub, hub + spoke]) for hub in hubs for spoke in spokes]
    assert "town_streets_at_junctions" in failing(with_roads(town, lines))


def test_a_parcel_that_lost_its_streets_is_named(town):
    house = town.buildings.geometry.distance(shapely.Point(0, 0)).argmin()
    place = town.buildings.geometry.iloc[house]
    near = town.roads.geometry.distance(place).to_numpy() < 60.0
    checks = {c.name: c for c in check_towns(replace(town, roads=town.roads[~near]))}
    assert town.buildings["source"].iloc[house] in checks["town_parcels_off_street"].ids


def test_a_parcel_upon_its_neighbour_is_named(town):
    areas = town.areas.copy()
    houses = set(town.buildings["source"])
    rows = np.flatnonzero(areas["source"].isin(houses) & (areas.geometry.area > 60.0))
    a, b = rows[:2]
    areas.loc[a, "geometry"] = areas.geometry.iloc[b]
    found = {c.name: c for c in check_towns(replace(town, areas=areas))}
    check = found["town_parcels_overlapping"]
    assert not check.ok
    assert areas["source"].iloc[a] in check.ids[0]
    assert areas["source"].iloc[b] in check.ids[0]
