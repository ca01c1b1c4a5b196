import numpy as np
import pytest

from cityx.checks.predicates import clean, measure
from cityx.city.content import content_hash
from cityx.city.section import Band, carriageway_width, read_section
from cityx.edit.land.cross_sections import directed, widened, with_lanes, with_strips
from cityx.edit.land.street_edits import streets
from cityx.errors import UsageError
from cityx.geometry.polygons import corners_of

TWO = read_section("drive 3 - | drive 3 +")
PARKED = read_section("parking 2.1 | drive 2.75 - | drive 2.75 + | parking 2.1")


def row(city, name):
    table = city.layout.roads
    return table[table["name"] == name].iloc[0]


# -- cross-sections ------------------------------------------------------------------------------


def test_a_wider_section_gives_its_room_to_the_lanes_alone():
    made = widened(PARKED, 11.7, left_hand=False)
    assert [band.width for band in made] == pytest.approx([2.1, 3.75, 3.75, 2.1])


def test_a_section_too_narrow_for_two_lanes_has_one_for_both_ways():
    assert widened(TWO, 4.0, left_hand=False) == (Band("drive", 4.0),)


def test_a_section_narrower_than_what_lies_beside_its_lanes_is_refused():
    with pytest.raises(UsageError, match=r"4\.2 m of them"):
        widened(PARKED, 5.0, left_hand=False)


@pytest.mark.parametrize(("left_hand", "signs"), [(False, [-1, -1, 1, 1]), (True, [1, 1, -1, -1])])
def test_lanes_along_the_road_lie_on_the_side_one_drives_on(left_hand, signs):
    made = with_lanes(TWO, 4, left_hand=left_hand)
    assert [band.direction for band in made] == signs
    assert carriageway_width(made) == pytest.approx(12.0)


def test_one_way_and_back_is_as_before():
    there = directed(TWO, oneway=True, left_hand=False)
    assert [band.direction for band in there] == [1, 1]
    assert directed(there, oneway=False, left_hand=False) == TWO


def test_strips_lie_in_order_and_kerbs_move_only_where_lanes_need_it():
    made = with_strips(PARKED, "cycle", "both", left_hand=False)
    assert [band.kind for band in made] == [
        "parking", "cycle", "drive", "drive", "cycle", "parking",
    ]  # fmt: skip
    assert carriageway_width(made) == pytest.approx(9.7 + 3.2)
    wide = read_section("drive 5 - | drive 5 +")
    assert carriageway_width(with_strips(wide, "cycle", "left", left_hand=False)) == 10.0
    bare = with_strips(PARKED, "parking", "none", left_hand=False)
    assert [band.width for band in bare] == pytest.approx([4.85, 4.85])


# -- the action ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("change", "predicate"),
    [
        ({"width": 5.0}, 'stat(road, name="north street", width, mean) in [4.9, 5.1]'),
        ({"direction": "along"}, 'n(road, name="north street", oneway=true) == 1'),
        ({"parking": "none"}, 'n(road, name="north street", parking=none) == 1'),
        ({"cycling": "left"}, 'n(road, name="north street", cycling=left) == 1'),
        ({"surface": "sett"}, 'n(road, name="north street", surface=cobbles) == 1'),
        ({"speed_kmh": 18.0}, 'stat(road, name="north street", speed, mean) in [4.9, 5.1]'),
        ({"traffic": "walkers"}, 'n(vehicle, on="north street") == 0'),
    ],
)
def test_a_change_is_measured_and_the_city_stays_clean(river, change, predicate):
    if "width" in change:
        change = {**change, "parking": "none"}
    changed = streets(river, streets=("north street",), **change)
    found = measure(predicate, changed, before=river)
    assert found.met, found.evidence
    assert [rule.evidence for rule in clean(changed) if rule.met is False] == []
    same = measure("same(building)", changed, before=river)
    assert same.met, same.evidence


def test_the_same_change_twice_gives_the_same_bytes(river):
    first, second = (streets(river, streets=("north street",), lanes=3) for _ in range(2))
    assert content_hash(first).total == content_hash(second).total


def test_a_street_that_was_closed_opens_as_it_was(river, objects):
    closed = streets(river, streets=("north street",), traffic="walkers")
    assert row(closed, "north street")["kind"] == "pedestrian"
    opened = streets(closed, streets=("north street",), traffic="cars")
    assert objects(opened) == objects(river)


def test_cars_of_other_streets_are_not_touched(river):
    changed = streets(river, streets=("north street",), traffic="walkers")
    south = river.scene.instances["vehicles"].position[:, 1] < 0
    ids = river.scene.instances["vehicles"].object_id[south]
    assert np.isin(ids, changed.scene.instances["vehicles"].object_id).all()


@pytest.mark.parametrize(
    ("name", "change", "text"),
    [
        ("x1", {"width": 50.0}, "houses beside it leave 21.4 m"),
        ("x1", {}, "nothing of this would change"),
        ("b01", {"width": 6.0}, "No street of the city: b01"),
    ],
)
def test_what_cannot_be_is_refused_with_what_could(grid, name, change, text):
    with pytest.raises(UsageError, match=text):
        streets(grid, streets=(name,), **change)


def test_a_path_has_a_surface_but_no_lanes(park):
    assert row(streets(park, streets=("loop1",), surface="gravel"), "loop1")["surface"] == "gravel"
    with pytest.raises(UsageError, match="loop1 is a footway: it carries no cars"):
        streets(park, streets=("loop1",), lanes=2)


def test_a_part_of_a_street_is_closed_between_two_junctions(grid):
    line = grid.layout.roads.loc[grid.layout.roads["name"] == "x1"].geometry.iloc[0]
    middle = line.interpolate(0.5, normalized=True).buffer(40.0)
    made = streets(grid, streets=("x1",), traffic="walkers", part=corners_of(middle))
    roads = made.layout.roads[made.layout.roads["name"] == "x1"]
    closed = roads["kind"] == "pedestrian"
    assert 0 < closed.sum() < len(roads)
    assert roads.geometry.length.sum() == pytest.approx(line.length)
    assert roads.geometry[closed].length.sum() < line.length / 2
    assert all(rule.met for rule in clean(made))


def test_what_is_so_already_is_told_and_stays(grid):
    made = streets(grid, streets=("x1",), traffic="cars")
    assert made.layout.roads.equals(grid.layout.roads)
    assert any("it is so already" in note for note in made.notes)


def test_a_way_that_carries_no_cars_is_closed_already(park):
    made = streets(park, streets=("loop1",), traffic="walkers")
    assert content_hash(made).total == content_hash(park).total
    assert any("it is so already" in note for note in made.notes)
