import pytest

from cityx.agents.brief import read_brief


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
