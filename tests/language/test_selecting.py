from dataclasses import replace

import numpy as np
import pytest

from cityx.language import Edit, Selector, read_brief
from cityx.language.brief import Clarify
from cityx.language.references.contradictions import contradictions
from cityx.language.references.resolved_changes import slots_of_edits
from cityx.language.references.selecting import Open, choose, chosen_by, place_selector


def chosen(text, city):
    """Return the names of what the first command of a text is about."""
    edit = read_brief(text, base=True).edits[0]
    found = choose(edit.target, city)
    return {str(name) for name in found.layer.names["name"][found.rows].tolist()}


def test_a_rank_takes_the_greatest_by_what_predicates_measure(scene):
    assert chosen("Make the three tallest buildings glass", scene("grid_s")) == {
        "b05", "b22", "b40",
    }  # fmt: skip
    assert chosen("Remove the second tallest building", scene("grid_s")) == {"b22"}


def test_a_share_is_that_part_and_always_the_same(scene):
    city = scene("grid_s")
    half = chosen("Paint half of the buildings red", city)
    assert len(half) == 24
    assert chosen("Paint half of the buildings red", city) == half
    other = replace(city, seed=city.seed + 1)
    assert chosen("Paint half of the buildings red", other) != half


def test_ids_names_and_hexadecimal_ids_lead_to_the_same_object(scene):
    city = scene("grid_s")
    by_name = choose(Selector(ids=("b07",)), city)
    (number,) = by_name.ids.tolist()
    assert choose(Selector(ids=(f"{number:016x}",)), city).ids.tolist() == [number]
    source = city.layout.buildings.set_index("name").loc["b07", "source"]
    assert choose(Selector(ids=(source,)), city).ids.tolist() == [number]


def test_along_a_street_is_where_no_house_stands_between(scene):
    city = scene("grid_s")
    found = choose(Selector("building", along="main_street"), city)
    roads = city.layout.roads
    main = roads[roads["kind"].isin(["primary", "secondary"])].geometry.union_all()
    table = city.layout.buildings
    lines = table.geometry.shortest_line(main)
    between = [sum(table.geometry.intersects(line)) > 1 for line in lines]
    chosen_rows = table["id"].isin(found.ids)
    assert not np.any(np.array(between)[chosen_rows])
    assert 0 < found.count < 48
    assert table.geometry.distance(main)[chosen_rows].max() < 45.0


def test_things_in_a_park_lie_in_it_and_those_near_it_may_not(scene):
    city = scene("park_s")
    inside = choose(Selector("tree", inside="park"), city)
    park = city.layout.areas.set_index("name").loc["park1", "geometry"]
    assert inside.count == sum(park.covers(point) for point in inside.layer.shapes)
    houses = choose(Selector("building", near="park"), city)
    assert 0 < houses.count < 20
    assert not any(park.intersects(shape) for shape in houses.shapes)


def test_a_side_is_a_half_of_the_site_or_a_quarter_seen_from_something(scene):
    city = scene("grid_s")
    north = choose(Selector("building", side="north"), city)
    assert all(shape.centroid.y > 0 for shape in north.shapes)
    (own,) = choose(Selector(ids=("b20",)), city).shapes
    south = choose(Selector("building", side="south", of="b20"), city)
    assert all(shape.centroid.y < own.bounds[1] for shape in south.shapes)


@pytest.mark.parametrize(
    ("text", "question"),
    [
        ("Remove the tree", "Which tree? There are 60."),
        ("Remove the church", "There is no church in the city."),
        ("Remove b99", 'Nothing is called "b99". Did you mean "b39" or "b29" or "b19"?'),
        ("Remove 90 trees", "90 tree are asked for, the city has 60."),
        ("Remove the oldest building", "Nothing measures which building is the oldest."),
        ("Remove the buildings near the river", "There is no river in the city."),
    ],
)
def test_nothing_or_several_is_asked_back(scene, text, question):
    (edit,) = read_brief(text, base=True).edits
    with pytest.raises(Open) as caught:
        choose(edit.target, scene("grid_s"))
    assert caught.value.question.text == question


def test_candidates_are_told_by_name_id_height_and_place(scene):
    (edit,) = read_brief("Remove the building", base=True).edits
    with pytest.raises(Open) as caught:
        choose(edit.target, scene("park_s"))
    assert caught.value.question.candidates[0] == "b01 (0dba11b3fc125c13), 17 m high, at -120, -118"
    assert caught.value.question.candidates[-1] == "and 14 more"


def test_a_file_may_not_take_away_a_large_part(scene):
    ids = tuple(f"b{number:02d}" for number in range(1, 11))
    with pytest.raises(Open, match="A file wants 10 of 48 buildings gone"):
        chosen_by(Edit("remove", Selector(ids=ids), wished=True), scene("grid_s"))
    assert chosen_by(Edit("remove", Selector(ids=ids)), scene("grid_s")).count == 10


@pytest.mark.parametrize(
    ("text", "question"),
    [
        ("Double the height of b07 and delete b07",
         "scale height 2 and remove are both asked of b07; which of the two?"),
        ("Make b07 red and blue", "red and blue cannot both be the color; which?"),
        ("Make b07 20 m high. Make b07 3 floors",
         "set height 20 and set floors 3 are both asked of b07; which of the two?"),
    ],
)  # fmt: skip
def test_changes_that_contradict_each_other_are_asked_back(scene, text, question):
    with pytest.raises(Clarify) as caught:
        slots_of_edits(read_brief(text, base=True), scene("grid_s"))
    assert str(caught.value).partition(" (")[0] == question


def test_changes_of_different_things_go_together(scene):
    city = scene("grid_s")
    brief = read_brief("Make b07 red and glass. Delete b08", base=True)
    assert not contradictions([(edit, chosen_by(edit, city)) for edit in brief.edits])


def test_the_ids_reach_actions_as_slots(scene):
    city = scene("grid_s")
    ((_, slots),) = slots_of_edits(read_brief("Delete b08", base=True), city)
    (names,) = slots["objects"]
    assert slots["family"] == ("building",)
    table = city.layout.buildings.set_index("name")
    assert int(names[0], 16) == table.loc["b08", "id"]


def test_a_place_of_a_rank_is_one_thing(scene):
    city = scene("grid_s")
    assert place_selector("tallest building") == Selector("building", rank="tallest", k=1)
    assert place_selector("park") == Selector("park")
    assert place_selector("Mill Lane") == Selector(ids=("Mill Lane",))
    near = choose(Selector("tree", near="tallest building", reach=40.0), city)
    assert near.ids.tolist() == choose(Selector("tree", near="b05", reach=40.0), city).ids.tolist()
    brief = read_brief("Put a bench next to the tallest building.", base=True)
    ((_, slots),) = slots_of_edits(brief, city)
    assert slots["within"] == ((f"{choose(Selector(ids=('b05',)), city).ids[0]:016x}",),)


def test_what_is_within_some_metres_is_no_farther(scene):
    city = scene("grid_s")
    found = choose(Selector("building", near="b05", reach=20.0), city)
    table = city.layout.buildings.set_index("id")
    middle = table.geometry[choose(Selector(ids=("b05",)), city).ids[0]]
    assert set(found.ids.tolist()) == set(table.index[table.geometry.distance(middle) <= 20.0])


def test_things_on_a_street_told_by_its_name_line_it(scene):
    city = scene("grid_s")
    on = choose(Selector("building", inside="x2"), city)
    along = choose(Selector("building", along="x2"), city)
    assert on.ids.tolist() == along.ids.tolist()
    assert on.count


def test_a_number_without_a_rank_is_asked_about(scene):
    with pytest.raises(Open, match="in which order"):
        choose(Selector("tree", nth=2), scene("grid_s"))


def test_a_share_of_few_is_at_least_one(scene):
    assert choose(Selector("building", share=0.1, near="b05", reach=1.0), scene("grid_s")).count
