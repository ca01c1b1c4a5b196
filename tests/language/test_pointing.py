"""Which things and places edits point at, and what people say in place of a plain order."""

import pytest

from cityx.language.reading import read_brief

NAMES = ("Cooper Green", "Hay Road", "Wool Lane", "Fountain Bridge")


def brief_of(text):
    return read_brief(text, base=True, names=NAMES)


def edits(text):
    brief = brief_of(text)
    assert not brief.questions, brief.questions
    assert not brief.left, brief.left
    assert not brief.unread
    return brief.edits


@pytest.mark.parametrize(
    ("text", "key", "side", "kind"),
    [
        ("Put six benches on the south bank of the river.", "side", "south", "river"),
        ("Put benches along the river's north bank.", "along", "north", "river"),
        ("Plant poplars along the northern shore of the lake.", "along", "north", "lake"),
        ("Put a fence on the east side of the park.", "side", "east", "park"),
        ("Put lamps along the west side of Hay Road.", "along", "west", ""),
        ("Put three bins on the north bank.", "side", "north", "river"),
    ],
)
def test_a_side_of_a_place_is_ground_and_no_place_of_that_side(text, key, side, kind):
    (edit,) = edits(text)
    (ref,) = edit.refs
    assert (ref.key, ref.side, ref.spots[0].kind) == (key, side, kind)
    assert not ref.spots[0].side


@pytest.mark.parametrize(
    ("text", "rank"),
    [
        ("Paint the taller tower white.", "tallest"),
        ("Remove the smaller of the two parks.", "smallest"),
        ("Make the longer bridge red.", "longest"),
        ("Close the busier street to cars.", "busiest"),
    ],
)
def test_a_comparative_alone_is_the_first_by_its_measure(text, rank):
    (edit,) = edits(text)
    assert (edit.target.rank, edit.target.k) == (rank, 1)


def test_of_several_a_comparative_tells_no_number():
    assert brief_of("Paint the taller towers white.").questions


def test_what_is_in_the_way_is_asked_about():
    assert not edits_or_none("Remove all buildings in the way of the tram.")


def edits_or_none(text):
    brief = brief_of(text)
    return () if brief.questions else brief.edits


@pytest.mark.parametrize(
    ("text", "species"),
    [
        ("Remove the pine trees.", "pine"),
        ("Cut down all oaks in the park.", "oak"),
        ("Replace the limes with birches.", "lime"),
        ("Remove the elms.", "elm"),  # of which no city has any
    ],
)
def test_trees_of_a_kind_are_no_others(text, species):
    (edit,) = edits(text)
    assert edit.target.filters == (f"species={species}",)


def test_trees_without_a_kind_are_all_of_them():
    (edit,) = edits("Remove the trees in the park.")
    assert edit.target.filters == ()


@pytest.mark.parametrize(
    "text",
    [
        "Get rid of the bins and benches on Hay Road.",
        "Remove the bins, lamps and benches on Hay Road.",
        "Remove the trees and the parked cars on Hay Road.",
    ],
)
def test_things_that_are_listed_together_share_their_place(text):
    assert {edit.target.inside for edit in edits(text)} == {"Hay Road"}


def test_what_there_is_one_of_shares_no_place():
    church, trees = edits("Remove the church and the trees along Hay Road.")
    assert (church.target.along, trees.target.along) == ("", "Hay Road")


@pytest.mark.parametrize(
    "text",
    [
        "Put a kiosk where Hay Road meets Wool Lane.",
        "Put a kiosk where Hay Road and Wool Lane cross.",
        "Put a kiosk at the junction of Hay Road and Wool Lane.",
        "Put a kiosk at the corner of Hay Road and Wool Lane.",
    ],
)
def test_two_streets_tell_where_they_meet(text):
    (edit,) = edits(text)
    assert [spot.ids for spot in edit.refs[0].spots] == [("Hay Road",), ("Wool Lane",)]
    assert edit.refs[0].key == "corner"


def test_what_is_removed_at_a_corner_is_no_street():
    (edit,) = edits("Remove the benches at the corner of Hay Road and Wool Lane.")
    assert edit.target.kind == "bench"


@pytest.mark.parametrize(
    ("text", "key"),
    [
        ("Put a statue in the park facing the church.", "in"),
        ("Put benches facing the river every 30 m along Hay Road.", "along"),
        ("Put a bench facing the river.", "near"),
    ],
)
def test_what_faces_something_is_turned_to_it(text, key):
    (edit,) = edits(text)
    assert "facing" in [ref.key for ref in edit.refs]
    assert key in [name for name, _ in edit.change] + [ref.key for ref in edit.refs]


@pytest.mark.parametrize(
    ("text", "verb"),
    [
        ("Clear half of the parked cars.", "remove"),
        ("Clear the parked cars from Hay Road.", "remove"),
        ("Clear the park of benches.", "remove"),
        ("Thin out the trees in the park by half.", "remove"),
        ("Halve the number of parked cars.", "remove"),
        ("Surround the park with a fence.", "add"),
        ("Give the park more benches.", "add"),
        ("More lamps on Hay Road, it's too dark there.", "add"),
        ("Fill the gap beside the church with a library.", "add_building"),
        ("Park two vans on Hay Road.", "add_agent"),
        ("Put a crowd in the park.", "add_agent"),
        ("Heavy traffic on Hay Road.", "add_agent"),
        ("Drop the height of the church to 20 m.", "set_height"),
        ("Make the church a storey taller.", "raise_floors"),
        ("Narrow Hay Road to a single lane.", "set_lanes"),
        ("Lower the speed limit to 20 on Hay Road.", "set_speed"),
        ("Set the speed limit on Hay Road to 30.", "set_speed"),
        ("Autumn colours on the trees, please.", "set_season"),
        ("Close Fountain Bridge for repairs.", "close"),
        ("Rename Hay Road to King Street.", "rename"),
        ("Is there a bench in the park?", "list"),
        ("How tall is the church?", "list"),
        ("How many trees stand within 20 m of a house?", "list"),
    ],
)
def test_an_everyday_order_is_the_plain_one(text, verb):
    assert {edit.verb for edit in edits(text)} == {verb}


@pytest.mark.parametrize(
    "text", ["Clear the sky.", "Make it clear and sunny.", "Light traffic on Hay Road."]
)
def test_what_clears_is_not_removed_and_light_traffic_is_not_of_the_whole_city(text):
    assert not {edit.verb for edit in brief_of(text).edits} & {"remove", "set_traffic"}


def test_a_street_is_closed_with_what_stands_at_its_ends():
    close, put = edits("Block off Hay Road with bollards.")
    assert (close.verb, put.verb, put.refs[0].key) == ("close", "add", "end")


def test_roofs_are_painted_apart_from_walls():
    told = edits("Paint the church yellow and its roof green.")
    assert [edit.verb for edit in told] == ["set_color", "set_roof"]


def test_what_it_is_for_changes_nothing():
    (edit,) = edits("For the flood study, remove the trees along the river.")
    assert edit.verb == "remove"
    assert brief_of("For the houses on Hay Road, remove the trees.").questions


def test_an_order_behind_a_reason_is_carried_out():
    (edit,) = edits("The council wants fewer cars, so take out every other parked car.")
    assert (edit.verb, edit.target.kind) == ("remove", "parked_vehicle")


def test_twice_as_many_are_asked_about():
    assert brief_of("Double the trees in the park.").questions


def test_a_new_building_takes_what_is_told_of_it_behind():
    (edit,) = edits("Add a hotel next to the church, make it six floors and paint it white.")
    assert dict(edit.change) | {"building.floors": 6, "color": "white"} == dict(edit.change)


def test_some_are_several_and_as_many_more_as_told():
    assert dict(edits("Add more benches in the park.")[0].change)["count"] > 1
    assert dict(edits("Add 10 more trees to the park.")[0].change)["count"] == 10


def test_into_cafes_is_one_for_each():
    assert ("each", "yes") in edits("Turn five of the shops into cafes.")[0].change
    assert ("each", "yes") not in edits("Turn five of the shops into a cafe.")[0].change


def test_a_name_keeps_its_letters():
    (edit,) = edits('Call the park "Miller\'s Green".')
    assert edit.change == (("name", "Miller's Green"),)


def test_lamps_on_a_street_are_not_switched_on():
    (edit,) = edits("Add four lamps on Hay Road.")
    assert (edit.verb, dict(edit.change)["element"]) == ("add", "streetlight")


@pytest.mark.parametrize(
    ("text", "command"),
    [
        ("A town with a park called Miller's Green", "call the park Miller's Green"),
        ("A village with a church named St Mary and a pub", "call the church St Mary"),
        ("A town by a river called the Seine", "call the river Seine"),
    ],
)
def test_a_thing_of_a_new_town_gets_its_name_when_it_stands(text, command):
    assert [one.text for one in read_brief(text).then] == [command]


def test_names_of_several_and_of_the_town_are_named_and_tell_nothing_else():
    brief = read_brief("Two bridges called North Bridge and South Bridge in a town named Paris")
    assert not brief.then
    assert not [slot for slot in brief.slots if slot.key.endswith("side")]
    assert {"North", "South", "Paris"} <= set(brief.words_unread)
    assert brief_of("Call the town Paris.").questions


@pytest.mark.parametrize(
    ("text", "verb"),
    [
        ("Fountain Bridge is closed for works.", "close"),
        ("Hay Road is widened by 3 m.", "raise_width"),
        ("In Cooper Green two fountains.", "add"),
        ("In Cooper Green add two fountains.", "add"),
        ("Along Hay Road plane trees every 10 m.", "plant"),
        ("On Hay Road a bench every 25 m facing the water.", "add"),
        ("Near the church put two benches.", "add"),
    ],
)
def test_a_place_or_a_state_in_front_leads_an_order(text, verb):
    assert {edit.verb for edit in edits(text)} == {verb}


def test_neighbours_of_pastel_colours_differ_in_any_case():
    (edit,) = edits("Paint the houses on Hay Road in candy colours, no two neighbours alike.")
    assert edit.change == (("color", "pastel"),)


def keys(text):
    return {slot.key: slot.value for slot in read_brief(text).slots}


@pytest.mark.parametrize(
    "text", ["A village on a slope facing south", "A village on a south-facing slope"]
)
def test_what_faces_south_is_high_in_the_north(text):
    assert keys(text)["terrain.side"] == "north"


def test_metres_above_the_sea_are_no_relief_and_a_keep_keeps_nothing():
    assert not {"terrain.relief", "building.height"} & keys("A village at 1,500 m on a hill").keys()
    assert not read_brief("A castle with a round keep in the centre").kept
    assert keys("An estate of twelve nine-storey blocks")["building.count"] == 12
    assert "size.area.min" not in keys("Make the big ones (over 250 m2) a school")
    assert not read_brief("12 drones over a town with a garden, none above the yard").negated


def test_the_plot_of_what_goes_becomes_what_comes():
    gone, put = edits("The church gets torn down and its plot becomes a playground.")
    assert (gone.verb, put.verb, dict(put.change)["element"]) == ("remove", "add", "playground")


def test_a_participle_behind_a_thing_makes_no_new_thing():
    assert brief_of("Car parking on Hay Road halved.").questions
    assert edits("The houses on Hay Road repainted in white.")[0].verb == "set_color"


@pytest.mark.parametrize(
    "text",
    [
        "Clear the way for the ambulance.",
        "Should we remove the trees?",
        "May I paint the church red?",
        "Fewer lamps on the main street.",
        "More benches in the park and fewer lamps on the main street.",
        "Put the benches in the same way as the lamps.",
        "Paint the north side of the church red.",
        "Make the east wall of the church two floors taller.",
    ],
)
def test_what_orders_nothing_or_a_part_that_nothing_tells_apart_is_asked(text):
    assert not edits_or_none(text)


def test_what_lies_on_a_side_of_the_city_is_still_meant():
    (edit,) = edits("Remove the trees on the north side of the city.")
    assert edit.target.side == "north"


@pytest.mark.parametrize(
    "text", ["Clear the snow from the roofs.", "Clear the fog.", "Clear up the weather."]
)
def test_weather_that_is_cleared_ends(text):
    (edit,) = edits(text)
    assert (edit.verb, edit.change) == ("set_weather", (("weather", "clear"),))


def test_a_stop_for_buses_is_no_order_to_stop():
    (edit,) = edits("Put a stop for buses in front of the church.")
    assert dict(edit.change)["element"] == "bus_stop"


def test_a_couple_of_things_are_two():
    (edit,) = edits("Put a couple of benches in the park.")
    assert (edit.verb, dict(edit.change)["count"]) == ("add", 2)


def test_of_several_places_each_is_that_of_what_stands_before_it():
    found = edits("Remove the trees, the benches in the park and the lamps on Hay Road.")
    assert [edit.target.inside for edit in found] == ["park", "park", "Hay Road"]


def test_a_name_is_changed_in_words_as_well():
    (edit,) = edits("Change the name of the park to Miller's Green.")
    assert (edit.verb, edit.change) == ("rename", (("name", "Miller's Green"),))


@pytest.mark.parametrize(
    "text",
    [
        "Replace every oak with two birches.",
        "Replace the church with two towers.",
        "Put lamps on one side of Hay Road.",
        "Line one side of Hay Road with trees.",
    ],
)
def test_a_number_that_nothing_takes_is_asked(text):
    assert not edits_or_none(text)


def test_as_many_come_as_go():
    (edit,) = edits("Replace two benches with two lamps.")
    assert (edit.verb, edit.target.k) == ("replace", 2)


@pytest.mark.parametrize(
    "text",
    [
        "Remove most of the benches.",
        "Paint most houses white.",
        "Put a house facing south.",
        "Plant trees in the park facing the river.",
    ],
)
def test_what_nothing_measures_is_asked(text):
    assert not edits_or_none(text)


def test_sides_of_the_city_are_no_ground_beside_it():
    (edit,) = edits("Remove the trees on the north side of town.")
    assert (edit.target.side, edit.target.where) == ("north", ())


def test_each_kind_of_tree_that_is_listed_is_planted():
    oaks, limes = edits("Plant ten oak trees and five limes in the park.")
    assert [dict(one.change)["species"] for one in (oaks, limes)] == ["oak", "lime"]
    assert [dict(one.change)["count"] for one in (oaks, limes)] == [10, 5]
    assert dict(oaks.change)["in"] == dict(limes.change)["in"] == "park"


def test_street_trees_are_those_along_streets():
    (edit,) = edits("Remove the street trees.")
    assert (edit.target.kind, edit.target.along) == ("tree", "road")


@pytest.mark.parametrize(
    "text",
    ["Rename Hay Road to King Street for the coronation.", "Rename Hay Road to St. Mary's Way."],
)
def test_what_follows_a_name_or_cuts_it_is_no_name(text):
    assert not edits_or_none(text)


@pytest.mark.parametrize("name", ["Route 66", "Bread & Butter Lane", "Street of the Three Kings"])
def test_a_name_is_taken_as_it_is_written(name):
    (edit,) = edits(f"Rename Hay Road to {name}.")
    assert dict(edit.change)["name"] == name


def test_all_over_town_is_everywhere():
    (edit,) = edits("Remove half of the parked cars across the town.")
    assert (edit.target.share, edit.target.near) == (0.5, "")


@pytest.mark.parametrize("text", ["A town with 20 moving cars", "A village, 20 cars driving"])
def test_cars_that_drive_are_added_to_those_that_park(text):
    brief = read_brief(text)
    assert [one.text for one in brief.then] == ["add 20 cars"]
    assert "vehicle.count" not in keys(text)


def test_the_limit_of_one_street_is_not_that_of_all_and_ridges_of_roofs_are_no_land():
    assert "roads.speed" not in keys("A town with an arterial with a speed limit of 60 km/h")
    assert keys("A town with a speed limit of 30 km/h")["roads.speed"] == pytest.approx(
        30 / 3.6, 1e-3
    )
    assert "terrain" not in keys("Ridges of the gabled roofs run east-west")
