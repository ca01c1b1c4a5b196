import pytest

from cityx.language import read_brief


def read(text, *names):
    brief = read_brief(text, base=True, names=names)
    assert not brief.questions, brief.questions
    return [
        (edit.verb, dict(edit.target.items()) if edit.target else {}, dict(edit.change))
        for edit in brief.edits
    ]


@pytest.mark.parametrize(
    ("text", "verb", "target", "change"),
    [
        ("Pave x1 with cobblestones.", "set_surface", {"target": "x1"},
         {"surface": "cobblestone"}),
        ("Put gravel on all side streets.", "set_surface", {"target": "side_street"},
         {"surface": "gravel"}),
        ("Make the main street one-way.", "set_direction", {"target": "main_street"},
         {"direction": "along"}),
        ("Turn x2 into a two-way street.", "set_direction", {"target": "x2"},
         {"direction": "both"}),
        ("Narrow x1 to 5 m.", "set_width", {"target": "x1"}, {"width": 5}),
        ("Add a bike lane along x1.", "set_cycling", {"target": "x1"}, {"cycling": "both"}),
        ("Remove the parking on x1.", "set_parking", {"target": "x1"}, {"parking": "none"}),
        ("No parking on x1.", "set_parking", {"target": "x1"}, {"parking": "none"}),
        ("Pedestrianise x1.", "close", {"target": "x1"}, {}),
        ("Make x1 car-free.", "close", {"target": "x1"}, {}),
        ("Lower the speed limit on x1 to 30 km/h.", "set_speed", {"target": "x1"},
         {"speed_kmh": 30}),
        ("Take the bench out of the park.", "remove", {"target": "bench", "in": "park"}, {}),
        ("No trees along the main street.", "remove",
         {"target": "tree", "along": "main_street"}, {}),
        ("Plant three cherry trees in the park.", "plant", {},
         {"nature": "tree", "species": "cherry", "count": 3, "in": "park"}),
        ("Dig a large pond in the park.", "add", {},
         {"element": "pond", "size": "large", "in": "park"}),
        ("Thicker fog.", "more_weather", {}, {"air": "fog"}),
        ("Less rain, please.", "less_weather", {}, {"air": "rain"}),
        ("Two hours later.", "shift_time", {}, {"hours": 2.0}),
        ("Turn the clock back by 30 minutes, earlier.", "shift_time", {}, {"hours": -0.5}),
        ("Set the time to 6:30 in the morning.", "set_time", {}, {"time": "06:30"}),
        ("Give every building a red roof.", "set_roof", {"target": "building"},
         {"roof.color": "red"}),
        ("Put a copy of b03 beside it.", "copy", {"target": "b03"}, {}),
        ("Make three duplicates of b03.", "copy", {"target": "b03"}, {"count": 3}),
        ("Copy b03 to the west of b05.", "copy", {"target": "b03"},
         {"side": "west", "of": "b05"}),
        ("Plant a hedge around the plaza.", "add", {}, {"element": "hedge", "around": "plaza"}),
        ("Lay some turf around b03.", "add", {},
         {"element": "lawn", "amount": "few", "around": "b03"}),
        ("Make the traffic heavy.", "set_traffic", {}, {"traffic": "heavy"}),
        ("Fewer cars.", "set_traffic", {}, {"traffic": "light"}),
        ("Give the western half of the town a modern look.", "set_style", {"side": "west"},
         {"style": "modern"}),
        ("Make the old town brick.", "set_material", {"target": "building", "in": "old_town"},
         {"material": "brick"}),
        ("Paint all houses in the industrial area white.", "set_color",
         {"target": "house", "in": "industrial"}, {"color": "white"}),
        ("Empty the square of benches.", "remove", {"target": "bench", "in": "plaza"}, {}),
        ("x1 is far too narrow, give it another 3 m.", "raise_width", {"target": "x1"},
         {"by": 3}),
        ("b03 is too tall. Lower it by 4 m.", "raise_height", {"target": "b03"}, {"by": -4}),
        ("b03 could do with an extra storey.", "raise_floors", {"target": "b03"}, {"by": 1}),
        ("Shorten b04 by one storey.", "raise_floors", {"target": "b04"}, {"by": -1}),
        ("Exchange the plaster for brick on the two tallest.", "set_material",
         {"target": "building", "rank": "tallest", "k": 2}, {"material": "brick"}),
        ("Swap asphalt for gravel.", "set_surface",
         {"target": "road", "filter": "surface=asphalt"}, {"surface": "gravel"}),
        ("Clad b14 in wood.", "set_material", {"target": "b14"}, {"material": "timber"}),
    ],
)  # fmt: skip
def test_a_change_is_read(text, verb, target, change):
    assert read(text) == [(verb, target, change)]


def test_names_of_the_city_go_before_words():
    said = "Make North Street 2 metres wider."
    assert read(said, "North Street") == [("raise_width", {"target": "North Street"}, {"by": 2})]
    assert read(said)[0][1] == {"target": "road", "side": "north"}


def test_a_name_that_is_a_word_of_the_book_is_that_word():
    assert read("Remove the trees in the park.", "Park")[0][1] == {"target": "tree", "in": "park"}


def test_two_looks_in_one_sentence_are_two_changes():
    assert [edit[1:] for edit in read("b20 in blue, b21 in green.")] == [
        ({"target": "b20"}, {"color": "blue"}), ({"target": "b21"}, {"color": "green"}),
    ]  # fmt: skip


def test_a_cut_down_to_a_height_removes_nothing():
    assert [verb for verb, *_ in read("Cut b05 down to ten floors.")] == ["set_floors"]


@pytest.mark.parametrize("text", ["x1 is too narrow.", "The main street is far too wide."])
def test_a_complaint_without_an_amount_is_asked_about(text):
    (question,) = read_brief(text, base=True, names=("x1",)).questions
    assert question.text == f'By how much? "{text.rstrip(".")}" does not say it.'


def test_a_colour_of_the_day_paints_no_building():
    edits = read("A grey, wet and gloomy November afternoon.")
    assert {verb for verb, *_ in edits} == {"set_weather"}
