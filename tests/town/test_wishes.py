"""What is asked of a bounded site is kept exactly, and the report measures it."""

from dataclasses import replace

import numpy as np
import pytest
import shapely

from cityx.checks.predicates import measure
from cityx.checks.predicates.places import places_of
from cityx.city import City, Frame, Layout, Scene, one_mesh
from cityx.city.ground import KERB_HEIGHT
from cityx.city.mesh import concatenate
from cityx.city.store import read_city, write_city
from cityx.errors import ActionFailed, UsageError
from cityx.town.town import town
from cityx.town.wishes.highest import highest
from cityx.town.wishes.places import places
from cityx.town.wishes.towers import towers
from cityx.town.wishes.uses import use_share


def site(seed=5, size=700.0, **plan):
    city = City("Town", Frame(50.0, 10.0), Layout((0.0, 0.0, 1.0, 1.0)), seed=seed)
    return town(city, width=size, depth=size, **plan)


@pytest.fixture(scope="module")
def city():
    return site()


def as_built(city):
    """The city with an upright triangle for every building, as if its shells stood."""
    corner = np.array([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)])
    face = np.array([(0, 1, 2)])
    table = city.layout.buildings
    batch = concatenate(
        one_mesh(int(key), corner * [1.0, 1.0, height + KERB_HEIGHT], face)
        for key, height in zip(table["id"], table["height"], strict=True)
    )
    return replace(city, scene=Scene(meshes={"buildings": batch}))


def finding(city, number=-1):
    found = measure(city.goals[number].predicate, as_built(city))
    return found.met, found.evidence


def test_so_many_towers_stand_around_a_plaza(city):
    asked = {"count": 25, "lowest": 80.0, "highest": 150.0, "around": "plaza"}
    changed = towers(city, **asked)
    height = changed.layout.buildings["height"].to_numpy()
    assert ((height >= 80.0) & (height <= 150.0)).sum() == 25
    assert (height > 150.0).sum() == 0
    assert np.ptp(height[height >= 80.0]) > 30.0
    met, evidence = finding(changed, 0)
    assert met, evidence
    assert "there are 25 building, height in [80, 150]" in evidence
    met, evidence = finding(changed, 1)
    assert met, evidence
    assert "of a plaza" in evidence
    houses = changed.layout.buildings.geometry.to_numpy()
    first, second = shapely.STRtree(houses).query(houses, predicate="intersects")
    pairs = first < second
    shared = shapely.area(shapely.intersection(houses[first[pairs]], houses[second[pairs]]))
    assert shared.max(initial=0.0) < 0.05
    assert towers(city, **asked).layout.parts.equals(changed.layout.parts)


def test_a_goal_that_is_no_longer_met_is_said_so(city):
    changed = towers(city, count=10, lowest=90.0, highest=100.0)
    lost = changed.layout.buildings["height"].to_numpy().argmax()
    layout = replace(changed.layout, buildings=changed.layout.buildings.drop(index=lost))
    met, evidence = finding(replace(changed, layout=layout), 0)
    assert not met
    assert evidence.startswith("there are 9 building")


def test_too_many_towers_are_refused_with_the_number_that_fits(city):
    with pytest.raises(ActionFailed, match=r"there is room for \d+\. Ask for fewer"):
        towers(city, count=400)
    with pytest.raises(UsageError, match="lowest = 90 m is more than highest = 80 m"):
        towers(city, lowest=90.0, highest=80.0)


@pytest.mark.parametrize(("kind", "count"), [("plaza", 0), ("plaza", 3), ("park", 1), ("lake", 2)])
def test_places_are_as_many_as_asked(city, kind, count):
    changed = places(city, kind=kind, count=count)
    assert len(places_of(changed, kind)) == count
    met, evidence = finding(changed)
    assert met, evidence
    assert evidence.startswith(f"there are {count}")


def test_a_new_place_leaves_asked_towers_standing(city):
    changed = places(towers(city, count=12), kind="park", count=4)
    met, evidence = finding(changed, 0)
    assert met, evidence


def test_a_use_gets_its_share(city):
    for share in (0.0, 0.3, 0.7):
        changed = use_share(city, use="office", share=share)
        met, evidence = finding(changed)
        assert met, evidence
        parts = changed.layout.parts.merge(
            changed.layout.buildings[["id", "use"]], left_on="building", right_on="id"
        )
        assert (parts["use_x"] == parts["use_y"]).mean() > 0.95


@pytest.mark.parametrize("height", [9.0, 60.0])
def test_the_highest_building_is_as_high_as_asked(city, height):
    changed = highest(city, height=height)
    assert changed.layout.buildings["height"].max() == pytest.approx(height)
    assert changed.layout.parts["top"].max() == pytest.approx(height, abs=0.5)
    met, evidence = finding(changed)
    assert met, evidence


def test_a_river_is_crossed():
    changed = site(seed=2, river=True)
    met, evidence = finding(changed)
    assert met, evidence
    assert "bridge, over=water" in evidence


def test_goals_are_kept_with_the_city(city, tmp_path):
    changed = places(city, kind="plaza", count=2)
    write_city(changed, tmp_path / "city")
    assert read_city(tmp_path / "city").goals == changed.goals
