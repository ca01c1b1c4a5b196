"""Ways to say an edit: places first, sides of a town, limits, colours in turn, what is told."""

import numpy as np
import pytest
import shapely

from cityx.language import read_brief
from cityx.language.references.palette import PASTEL, TONE, in_turn
from cityx.language.references.ranking import streets_of
from cityx.language.references.resolved_changes import changes_here
from cityx.language.references.selecting import choose


def read(text):
    brief = read_brief(text, base=True)
    assert not brief.questions, brief.questions
    assert not brief.left, brief.left
    return brief.edits


def names(text, city):
    found = choose(read(text)[0].target, city)
    return {str(name) for name in found.layer.names["name"][found.rows].tolist()}


def south(city):
    """Return the names of the buildings whose middles lie in the southern half."""
    table = city.layout.buildings
    middle = (city.layout.extent[1] + city.layout.extent[3]) / 2
    return set(table["name"][shapely.get_y(shapely.centroid(table.geometry.to_numpy())) < middle])


@pytest.mark.parametrize(
    "text",
    [
        "Paint all buildings in the southern half of town red.",
        "Paint all buildings in the south of town red.",
        "Paint all buildings on the south half of the city red.",
        "In the south half of town paint all buildings red.",
    ],
)
def test_a_side_of_the_town_is_all_that_lies_there(scene, text):
    city = scene("grid_s")
    assert names(text, city) == south(city)


def test_a_half_that_stays_is_left_out_of_the_change(scene):
    city = scene("grid_s")
    text = "Paint all buildings red. The northern half stays as it is."
    assert names(text, city) == south(city)


def test_a_half_that_stays_leaves_open_where_new_things_go():
    brief = read_brief("Add ten benches; the north half stays as it is.", base=True)
    assert any("to stay as it is" in question.text for question in brief.questions)


def test_the_other_half_is_all_of_the_rest(scene):
    city = scene("grid_s")
    first, second = read("Paint half of the buildings red and the other half blue.")
    ids = [choose(edit.target, city).ids for edit in (first, second)]
    assert not np.intersect1d(*ids).size
    assert len(np.union1d(*ids)) == len(city.layout.buildings)
    assert [dict(edit.change)["color"] for edit in (first, second)] == ["red", "blue"]


@pytest.mark.parametrize(
    ("text", "colors", "tone"),
    [
        ("Paint all buildings pink, yellow or green.", ("pink", "yellow", "green"), ""),
        ("Paint all buildings in alternating red and white.", ("red", "white"), ""),
        ("Paint all buildings pastel: pink, yellow, blue.", ("pink", "yellow", "blue"), PASTEL),
    ],
)
def test_colours_are_taken_in_turn_among_neighbours(scene, text, colors, tone):
    city = scene("grid_s")
    (edit,) = read(text)
    made = in_turn(edit, city)
    assert [dict(one.change)["color"] for one in made] == list(colors)
    assert {dict(one.change).get(TONE, "") for one in made} == {tone}
    counts = [len(one.target.ids) for one in made]
    assert sum(counts) == len(city.layout.buildings)
    assert max(counts) - min(counts) <= len(counts)
    assert made == in_turn(edit, city)


def test_neighbours_differ_where_there_are_colours_enough(scene):
    city = scene("grid_s")
    (edit,) = read("Paint all buildings in pastel colours.")
    color = {one: at for at, each in enumerate(in_turn(edit, city)) for one in each.target.ids}
    table = city.layout.buildings
    ids = [f"{number:016x}" for number in table["id"]]
    pairs = shapely.STRtree(table.geometry).query(table.geometry, "dwithin", 25.0).T.tolist()
    beside = [(a, b) for a, b in pairs if a < b]
    assert beside
    alike = sum(color[ids[a]] == color[ids[b]] for a, b in beside)
    assert alike <= 0.1 * len(beside)  # the last of a row may have all colours beside it


def test_two_colours_of_one_building_are_still_asked_about(scene):
    brief = read_brief("Paint b07 pink and yellow.", base=True)
    _, asked, _ = changes_here(brief, scene("grid_s"))
    assert "cannot both be the color" in asked[0][0].text


def test_a_colour_before_roofs_is_that_of_the_roofs():
    (edit,) = read("Give all buildings red tile roofs.")
    assert (edit.verb, dict(edit.change)) == ("set_roof", {"roof.color": "red", "roof": "tile"})


@pytest.mark.parametrize(
    "text",
    [
        "Every building near the park loses its top floor, but nothing goes below two floors.",
        "Take a floor off the buildings near the park, but leave at least two floors.",
    ],
)
def test_a_least_number_of_floors_bounds_what_is_lowered(text):
    (edit,) = read(text)
    assert edit.verb == "raise_floors"
    assert dict(edit.change) == {"by": -1, "floors.min": 2}
    assert "floors>2" in edit.target.filters  # what has two or fewer stays as it is


@pytest.mark.parametrize(
    ("text", "change"),
    [
        ("The houses facing the park must not be taller than 9 m.", {"height.max": 9}),
        ("The largest building should have no more than two floors.", {"floors.max": 2}),
    ],
)
def test_what_things_must_not_be_is_a_bound(text, change):
    assert dict(read(text)[0].change) == change


def test_a_look_behind_what_is_left_out_is_of_the_others():
    brief = read_brief("Paint every building except the church yellow.", base=True)
    (edit,) = brief.edits
    assert dict(edit.change) == {"color": "yellow"}
    assert [slot.value for slot in brief.kept] == ["church"]


def test_other_roofs_and_what_they_carry_are_two_changes_of_the_same_buildings():
    roof, panels = read(
        "On the south half of town replace flat roofs by gabled ones carrying solar panels."
    )
    assert (roof.verb, panels.verb) == ("set_roof", "add_parts")
    assert dict(roof.change) == {"roof": "gabled"}
    assert roof.target.side == panels.target.side == "south"
    assert roof.target.filters == ("roof=flat",)


def test_what_is_left_is_all_that_was_not_removed():
    _, raised = read("Remove the five lowest buildings, then raise whatever's left by one floor.")
    assert raised.target.kind == "building"
    assert [one.rank for one in raised.target.but] == ["lowest"]


@pytest.mark.parametrize(
    "text",
    [
        "Remove the three lowest buildings and tell me which ones you removed.",
        "Remove the three lowest buildings. Say how many you removed.",
        "Remove the three lowest buildings; if it doesn't fit anywhere, tell me where.",
    ],
)
def test_what_an_edit_tells_anyway_is_no_change_of_its_own(text):
    assert [edit.verb for edit in read(text)] == ["remove"]


def test_what_an_edit_does_not_tell_is_asked():
    brief = read_brief("Remove b07 and tell me which buildings get wet.", base=True)
    assert [one.text for one in brief.left] == ["tell me which buildings get wet"]


def test_what_comes_in_the_place_of_what_goes_replaces_it(scene):
    city = scene("grid_s")
    brief = read_brief("Remove the five lowest buildings and put a market hall on the biggest gap.",
                       base=True)  # fmt: skip
    found, asked, _ = changes_here(brief, city)
    assert not asked
    (gone, _), (new, slots) = found
    assert (gone.verb, new.verb) == ("remove", "replace")
    assert len(gone.target.ids) == 4
    lowest = choose(brief.edits[0].target, city)
    areas = dict(zip(lowest.ids.tolist(), shapely.area(lowest.shapes), strict=True))
    assert int(slots["objects"][0][0], 16) == max(areas, key=lambda one: areas[one])


def test_the_entrances_of_a_place_are_where_ways_lead_into_it(scene):
    city = scene("park_s")
    (edit,) = read("Put a bench at each entrance of the park.")
    assert [one.key for one in edit.refs] == ["entrance"]
    found, asked, _ = changes_here(read_brief("Put a bench at the park entrance.", base=True), city)
    assert not asked
    spots = shapely.points(np.array(found[0][1]["ground"][0])[:, :2])
    park = city.layout.areas[city.layout.areas["kind"] == "park"].geometry.iloc[0]
    assert shapely.distance(spots, park.boundary).max() <= 10.1


def test_the_longest_street_is_all_that_has_its_name(scene):
    city = scene("grid_s")
    (edit,) = read("Widen the longest street by 1 m.")
    found = choose(edit.target, city)
    assert len(np.unique(streets_of(found))) == 1
    (busy,) = read("Close the busiest street to cars.")
    assert len(np.unique(streets_of(choose(busy.target, city)))) == 1


def test_what_follows_a_colon_is_left_out_with_what_it_is_about():
    text = "Make the street along the river car free: bollards at both ends, cobbles."
    brief = read_brief(text, base=True)
    first, *others = brief.wishes
    assert others
    assert all(brief.wishes.index(first) in one.needs for one in others)


def test_a_cycle_lane_can_be_given_to_a_street():
    (edit,) = read("Give the main street a cycle lane on each side.")
    assert (edit.verb, dict(edit.change)) == ("set_cycling", {"cycling": "both"})
    assert read_brief("Give b07 a cycle lane.", base=True).edits[0].target.ids == ("b07",)
