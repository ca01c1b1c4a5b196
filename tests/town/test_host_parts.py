"""Parts of buildings that are asked for stand on their hosts, and only there."""

from dataclasses import replace

import numpy as np
import pytest
import shapely

from cityx.checks.predicates import measure
from cityx.checks.predicates.body_parts import body_parts
from cityx.city import City, Frame, Layout
from cityx.city.content import content_hash
from cityx.city.layout import make_table
from cityx.errors import ActionFailed
from cityx.town.host_parts import Look, NoRoomForPart, _with_courtyards, with_parts
from cityx.town.part_kinds import as_high
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


def block(*volumes):
    """Return a block with a courtyard, on which volumes stand: (shape, base, top, roof)."""
    outline = shapely.difference(shapely.box(0, 0, 60, 60), shapely.box(15, 15, 45, 45))
    volumes = [(outline, 0.0, 10.0, "flat"), *volumes]
    shape, base, top, roof = zip(*volumes, strict=True)
    tables = {
        "buildings": make_table("buildings", [outline], id=[7], height=[10.0], tags=["{}"]),
        "parts": make_table(
            "parts", list(shape), id=list(range(len(volumes))), building=[7] * len(volumes),
            base=list(base), top=list(top), roof_shape=list(roof), walls=[True] * len(volumes),
            roof_height=[4.0 if one == "dome" else 0.0 for one in roof],
        ),
    }  # fmt: skip
    return Layout((-100.0, -100.0, 200.0, 200.0), **tables)


@pytest.mark.parametrize("part", ["tower", "minaret"])
def test_a_courtyard_stays_open_when_a_part_is_built_and_taken_down(part):
    layout = block()
    whole = layout.buildings.geometry.iloc[0]
    made = with_parts(layout, 0, part, 2, 2, Look(), seed=1)
    assert number_of(made, part) == 2
    gone = with_parts(made, 0, part, 0, 0, Look(), seed=1)
    assert number_of(gone, part) == 0
    for one in (made, gone):
        low = one.parts["base"].to_numpy() <= 0.0
        built = shapely.union_all(one.parts.geometry.to_numpy()[low])
        court = shapely.box(16, 16, 44, 44)
        assert not shapely.intersects(built, court)
        assert not shapely.intersects(one.buildings.geometry.iloc[0], court)
        assert shapely.area(shapely.difference(whole, built)) < 0.1


def number_of(layout, part):
    return len(list(body_parts(layout, part, np.array([7], np.uint64))))


def test_a_tower_within_a_volume_leaves_no_hole_in_it():
    plan = shapely.box(20, 20, 26, 26)
    ring = shapely.difference(
        shapely.box(0, 0, 60, 60), shapely.union(plan, shapely.box(40, 40, 50, 50))
    )
    found = _with_courtyards(ring, plan)
    assert found.area == pytest.approx(3600.0 - 100.0)


def test_a_tower_on_a_roof_is_stretched_above_it():
    tower = (shapely.box(2, 2, 8, 8), 10.0, 30.0, "flat")
    cap = (shapely.box(3, 3, 7, 7), 30.0, 40.0, "flat")
    made = with_parts(block(tower, cap), 0, "tower", 1, 1, Look(height=55.0), seed=1)
    heights = sorted(zip(made.parts["base"], made.parts["top"], strict=True))
    assert heights == [(0.0, 10.0), (10.0, 40.0), (40.0, 55.0)]


def test_a_dome_is_no_lower_than_what_it_stands_on():
    layout = block((shapely.box(2, 2, 12, 12), 10.0, 16.0, "dome"))
    made = with_parts(layout, 0, "dome", 1, 1, Look(height=13.0), seed=1)
    assert made.parts["top"].tolist() == [10.0, 13.0]
    assert made.parts["roof_height"].tolist() == [0.0, 3.0]
    with pytest.raises(NoRoomForPart, match=r"at least 11\.0 m"):
        with_parts(layout, 0, "dome", 1, 1, Look(height=8.0), seed=1)


def test_a_building_without_volumes_takes_no_part():
    layout = block()
    bare = replace(layout, parts=layout.parts.iloc[:0])
    with pytest.raises(NoRoomForPart, match="it has no volumes"):
        with_parts(bare, 0, "tower", 1, 1, Look(), seed=1)
    assert with_parts(bare, 0, "tower", 0, 0, Look(), seed=1) is bare


@pytest.mark.parametrize(("heights", "met"), [((34.0, 36.0), True), ((20.0, 50.0), False)])
def test_a_height_is_asked_of_every_host(heights, met):
    plans = [shapely.box(40 * k, 0, 40 * k + 20, 40) for k in range(2)]
    towers = [shapely.box(40 * k, 0, 40 * k + 6, 6) for k in range(2)]
    layout = Layout(
        (-100.0, -100.0, 200.0, 200.0),
        buildings=make_table("buildings", plans, id=[7, 8], use=["church"] * 2, tags=["{}"] * 2),
        parts=make_table(
            "parts", [*plans, *towers], id=[1, 2, 3, 4], building=[7, 8, 7, 8],
            top=[10.0, 10.0, *heights], roof_shape=["flat"] * 4, walls=[True] * 4,
        ),
    )  # fmt: skip
    city = City("Site", Frame(50.0, 10.0), layout, seed=3)
    assert measure(as_high("church", "tower", 33.0, 37.0), city).met is met
