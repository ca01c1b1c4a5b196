"""Words about people, vehicles, the air and parts of buildings."""

import pytest

from cityx.language.reading import read_brief


def said(text, *, base=False):
    brief = read_brief(text, base=base)
    assert not brief.unread, brief.words_unread
    return [f"{key}={value}" for key, value in brief.items()], [
        one.predicate for one in brief.goals
    ]


@pytest.mark.parametrize(
    ("text", "slots"),
    [
        ("a third of the traffic should be trucks", ["truck.share=0.3333"]),
        ("mostly cyclists", ["bicycle.share.min=0.5"]),
        ("two wheelchair users and three children", ["wheelchair.count=2", "child.count=3"]),
        ("no parked cars", ["not=parked_vehicle"]),
        ("fog with a visibility of 80 m", ["weather=fog", "visibility=80"]),
        ("half the sky covered with clouds", ["cloud.share=0.5", "weather=cloudy"]),
        ("a low sun in the west", ["sun.height=low", "sun.side=west"]),
        ("on 21 December at 4 pm", ["date=12-21", "season=winter", "time=16:00"]),
        ("the 3rd of March", ["date=03-03", "season=spring"]),
        ("a clear night without a moon", ["weather=clear", "time=night", "moon=none"]),
        ("full moon", ["moon=full", "weather=clear", "time=night"]),
        ("a quarter of the windows are lit", ["windows.lit=0.25"]),
        ("a strong wind from the north", ["wind=strong", "wind.from=north"]),
        ("sunny, with snow on the roofs", ["weather=clear", "snow.cover=high"]),
        ("A winter day, snow on the roofs", ["season=winter", "snow.cover=high"]),
        ("the blue hour", ["time=blue_hour"]),
        ("buses make up 20 % of the traffic", ["bus.share=0.2"]),
        ("one window in ten is lit", ["windows.lit=0.1"]),
        ("light from the south-west in the afternoon", ["time=afternoon", "sun.side=southwest"]),
    ],
)
def test_words_of_a_new_town_are_read_whole(text, slots):
    found, goals = said(text)
    assert sorted(found) == sorted(slots)
    assert goals


@pytest.mark.parametrize(
    ("text", "goal"),
    [
        ("Put ten people on the square", "gained(pedestrian, at=plaza) == 10"),
        ("Add six people talking on the square", "gained(pedestrian, mode=talk, at=plaza) == 6"),
        ("Add four elderly people sitting on the benches",
         "gained(pedestrian, age=elder, mode=sit, at=bench) == 4"),
        ("Add five people waiting at the bus stop",
         "gained(pedestrian, mode=stand, at=bus_stop) == 5"),
        ("Put three taxis parked along the main street",
         'gained(vehicle, type=taxi, at="road, class=main") == 3'),
        ("Put an ambulance in front of the church",
         'gained(vehicle, type=ambulance, at="building, tag=church") == 1'),
        ("Put a bus at every bus stop", "gained(bus, at=bus_stop) == 1 * n(bus_stop)"),
        ("Put two people on each bench",
         "gained(pedestrian, mode=sit, at=bench) == 2 * n(bench)"),
        ("Remove all parked cars", "n(parked_vehicle) == 0"),
        ("Turn the visibility down to 60 m", "env.visibility in [54, 66]"),
        ("Let the sun shine from the east", "env.sun_side == east"),
        ("Half of the windows are lit", "env.windows in [0.46, 0.54]"),
        ("Add balconies to the apartment blocks", "share(building, use=flats, has=balcony) >= 0.5"),
        ("Put solar panels on half of the roofs", "share(building, has=solar) >= 0.25"),
        ("Put flower boxes under the windows", "share(building, has=flower_box) >= 0.5"),
        ("Paint the doors of the houses blue",
         "share(building, type=house, door_color=blue) >= 0.5"),
        ("Remove the chimneys from the houses", "n(building, type=house, has=chimney) == 0"),
    ],
)  # fmt: skip
def test_commands_are_read_whole_and_measured(text, goal):
    assert goal in said(text, base=True)[1]


@pytest.mark.parametrize(
    ("text", "asked"),
    [
        ("Paint the shutters of the houses green", 'What is meant by "shutters"?'),
        ("Put a gaggle at the tram stop", 'What is meant by "gaggle"?'),
        ("Add dormers to the houses", "A dormer cannot be added to a building that stands; solar"),
    ],
)
def test_a_part_that_is_not_known_is_asked_about_and_no_building_is_changed(text, asked):
    brief = read_brief(text, base=True)
    assert [edit.verb for edit in brief.edits] == ["unspecified"]
    assert any(question.text.startswith(asked) for question in brief.questions)


def test_a_month_alone_is_its_middle_and_a_count_beside_it_no_day():
    assert read_brief("in december, 40 houses").value("date") == "12-15"
    assert read_brief("a town of 12 houses, may").value("building.count") == 12
