"""Parts of buildings that are asked for stand on their hosts, and only there."""

import numpy as np
import pytest
import shapely

from cityx.checks.predicates import measure
from cityx.checks.predicates.body_parts import body_parts
from cityx.city import City, Frame, Layout
from cityx.city.content import content_hash
from cityx.errors import ActionFailed
from cityx.town.host_parts import Look, with_parts
from cityx.town.town import town
from cityx.town.wishes.elements import elements
from cityx.town.wishes.host_parts import host_parts
from cityx.town.wishes.limits import building_limits


@pytest.fixture(scope="module")
def built():
    start = City("Town", Frame(50.0, 10.0), Layout((0.0, 0.0, 1.0, 1.0)), seed=3)
    city = town(start, width=420.0, depth=420.0)
    for kind in ("church", "mosque", "factory", "courthouse", "castle", "library"):
        city = elements(city, kind=kind)
    return city


def number(city, of, part):
    return measure(f"stat({of}, {part}s, max) >= 0", city).value


CASES = [
    ("courthouse", "clock_tower", {}, "building, tag=courthouse", 1),
    ("mosque", "minaret", {"least": 2, "most": 2, "height": 35.0}, "building, tag=mosque", 2),
    ("mosque", "minaret", {"least": 4, "most": 4}, "building, tag=mosque", 4),
    ("factory", "chimney", {"height": 40.0}, "building, type=factory", 1),
    ("castle", "tower", {"least": 2, "most": 2}, "building, tag=castle", 2),
    ("castle", "tower", {"least": 6, "most": 6}, "building, tag=castle", 6),
    ("library", "dome", {}, "building, tag=library", 1),
    ("church", "spire", {"height": 48.0, "color": "green"}, "building, tag=church", 1),
    ("church", "tower", {"least": 0, "most": 0}, "building, tag=church", 0),
]


@pytest.mark.parametrize(("kind", "part", "args", "of", "count"), CASES)
def test_a_host_has_the_parts_that_are_asked(built, kind, part, args, of, count):
    city = host_parts(built, kind=kind, part=part, **args)
    body = "tower" if part == "clock_tower" else part
    assert number(city, of, body) == count
    assert all(measure(goal.predicate, city).met for goal in city.goals)
    if "height" in args:
        assert measure(f"stat({of}, {body}_height, mean) >= 0", city).value == args["height"]
    made = built.layout.buildings["source"].str.startswith(f"made/{kind}/")
    own = built.layout.buildings["id"][made]
    same = ~built.layout.parts["building"].isin(own).to_numpy()
    kept = ~city.layout.parts["building"].isin(own).to_numpy()
    for column in ("id", "top", "roof_shape", "wall_color"):
        assert np.array_equal(built.layout.parts[column][same], city.layout.parts[column][kept])


def test_volumes_of_a_host_do_not_share_ground_that_both_stand_on(built):
    city = host_parts(built, kind="courthouse", part="clock_tower")
    own = city.layout.buildings["id"][city.layout.buildings["source"] == "made/courthouse/0"]
    parts = city.layout.parts[city.layout.parts["building"].isin(own)]
    shapes = parts.geometry.to_numpy()[parts["base"].to_numpy() <= 0.0]
    shared = [
        shapely.intersection(one, other).area
        for k, one in enumerate(shapes) for other in shapes[:k]
    ]  # fmt: skip
    assert max(shared) < 0.01


def test_a_part_keeps_a_bound_of_heights_or_says_that_it_cannot(built):
    low = building_limits(built, kind="church", highest=30.0)
    city = host_parts(low, kind="church", part="spire")
    assert measure("stat(building, tag=church, height, max) <= 30", city).met
    with pytest.raises(ActionFailed, match="church"):
        host_parts(low, kind="church", part="minaret", height=48.0)


def test_parts_are_the_same_for_the_same_seed(built):
    first, second = (host_parts(built, kind="mosque", part="minaret", least=3) for _ in range(2))
    assert content_hash(first).total == content_hash(second).total


@pytest.mark.parametrize("part", ["tower", "spire", "dome"])
def test_buildings_of_one_volume_whatever_their_outline_take_parts(built, part):
    plain = np.flatnonzero(built.layout.buildings["source"].str.startswith("parcel/"))
    houses = [row for row in plain.tolist() if built.layout.buildings["levels"].iloc[row] > 2][:8]
    assert houses
    for row in houses:
        layout = with_parts(built.layout, row, part, 1, 40, Look(), seed=5)
        own = layout.parts["building"] == layout.buildings["id"].iloc[row]
        shapes = layout.parts.geometry.to_numpy()[own]
        assert shapely.is_valid(shapes).all()
        assert not any(shape.interiors for shape in shapes)
        number = np.array([layout.buildings["id"].iloc[row]], np.uint64)
        assert len(list(body_parts(layout, part, number))) == 1
