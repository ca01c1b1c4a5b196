"""What sentences for new towns say of who is about: shares, clothes, speeds, ways and lights."""

import numpy as np
import pytest

from cityx.language.asked import slots_of_brief
from cityx.language.reading import read_brief
from cityx.motion.kinds_of_people import looks_of_kinds, parts_of
from cityx.protocol.serving import DO


def slots(text):
    brief = read_brief(text)
    assert not brief.unread, brief.words_unread
    return [f"{key}={value}" for key, value in brief.items()]


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("300 people, one in ten with a pram and a fifth of them are children",
         {"pedestrian.count=300", "pram.share=0.1", "child.share=0.2"}),
        ("half of the pedestrians should be elderly", {"elder.share=0.5"}),
        ("a third of the people are joggers", {"runner.share=0.3333"}),
        ("500 pedestrians walking at 1.3 m/s", {"pedestrian.speed=1.3"}),
        ("six joggers running at 3 m/s", {"runner.count=6", "runner.speed=3"}),
        ("a police car with its blue lights on", {"agent=police", "police.beacons=on"}),
        ("ten children in hi-vis", {"child.count=10", "child.wears=hi_vis"}),
        ("no street lights are on", {"lights=off"}),
        ("no illuminated windows", {"windows.lit=none"}),
        ("12 motorcycles driving along the road at 15 m/s",
         {"motorcycle.count=12", "motorcycle.speed=15"}),
    ],
)  # fmt: skip
def test_what_is_said_of_people_and_vehicles_is_read(text, told):
    assert told <= set(slots(text))


def test_lamps_of_a_power_cut_stand():
    brief = read_brief("3 am, a power cut, no street lights")
    assert "lights=off" in [f"{key}={value}" for key, value in brief.items()]
    assert not brief.negated
    assert read_brief("a town without street lights").negated


@pytest.mark.parametrize(
    ("text", "command", "goal"),
    [
        ("A town with a school. Thirty children in hi-vis walk to the school.",
         "put Thirty children in hi-vis walk to the school",
         'gained(pedestrian, age=child, to="building, tag=school", wears=hi_vis) == 30'),
        ("500 people leave the square.", "put 500 people leave the square",
         "gained(pedestrian, from=plaza) == 500"),
        ("A police car drives slowly down the main street.",
         "put A police car drives slowly down the main street",
         'stat(vehicle, type=police, on="road, class=main", speed, mean) in [3.6, 4.4]'),
        ("An ambulance outside the hospital at dusk.", "put An ambulance outside the hospital",
         'gained(vehicle, type=ambulance, at="building, tag=hospital") == 1'),
        ("Parked cars on the main street.", "put Parked cars on the main street",
         'gained(vehicle, type=car, at="road, class=main") >= 1'),
    ],
)  # fmt: skip
def test_where_people_and_vehicles_are_becomes_a_command(text, command, goal):
    brief = read_brief(text)
    assert [one.text for one in brief.then] == [command]
    assert goal in [one.predicate for one in read_brief(f"{command}.", base=True).goals]


@pytest.mark.parametrize(
    ("text", "left"),
    [
        ("Kids in hi-vis walking in pairs to the school.", "to the school"),
        ("100 people, one in twenty using a wheelchair at 0.8 m/s.", "0.8 m/s"),
        ("No cars on the course.", "cars"),
        ("No street lights on the main street.", "street lights"),
    ],
)
def test_what_cannot_be_done_is_named(text, left):
    assert left in [text[slice(*note.span)] for note in read_brief(text).notes]


def test_a_number_of_people_holds_besides_those_whom_commands_add():
    brief = read_brief("A town with a church and 100 people. Twenty people walk to the church.")
    assert "n(pedestrian) >= 100" in [goal.predicate for goal in brief.goals]
    alone = read_brief("A town with a church and 100 people.")
    assert "n(pedestrian) == 100" in [goal.predicate for goal in alone.goals]


def test_as_many_of_a_crowd_are_of_a_kind_as_asked_for_and_nobody_else_is():
    ids = np.arange(1, 201, dtype=np.uint64)
    shares = {"child": 0.25, "pram": 0.1}
    kinds = parts_of(ids, shares, 7)
    assert ((kinds == "child").sum(), (kinds == "pram").sum()) == (50, 20)
    assert (kinds == parts_of(ids, shares, 7)).all()
    looks = looks_of_kinds(ids.astype(np.int64), kinds, wears="hi_vis", apart=tuple(shares))
    from cityx.assets.vehicles.movers import WARNING_COLORS, person_of

    people = [person_of(look) for look in looks.tolist()]
    assert [who.age == "child" for who in people] == (kinds == "child").tolist()
    assert [who.gear == "pram" for who in people] == (kinds == "pram").tolist()
    assert all(who.top_color in WARNING_COLORS for who in people)


@pytest.mark.parametrize(
    ("text", "count"), [("A village. A man is walking his dog.", 1), ("A town with joggers.", 4)]
)
def test_one_person_of_a_kind_is_one(text, count):
    wishes = dict(slots_of_brief(read_brief(text))[DO])
    assert wishes["dynamic/gathering-v1"]["count"] == count


@pytest.mark.parametrize(
    ("text", "key", "share"),
    [
        ("A town, roughly one lorry to every ten cars.", "truck.share", 1 / 11),
        ("A city with one bus for every 20 cars.", "bus.share", 1 / 21),
        ("A town with two bikes to each car.", "bicycle.share", 2 / 3),
    ],
)
def test_so_many_to_every_so_many_is_a_share(text, key, share):
    brief = read_brief(text)
    assert brief.value(key) == pytest.approx(share, abs=1e-3)
    assert not brief.value("vehicle.count")
    assert not brief.unread
