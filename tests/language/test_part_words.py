"""Parts of buildings are read with what is said of them, and put on nothing else."""

import pytest

from cityx.language import read_brief
from cityx.language.asked import slots_of_brief
from cityx.protocol.serving import DO

READ = [
    ("A courthouse with a clock tower", {"courthouse.clock_tower.count.min": 1}),
    ("A town with a mosque with two minarets", {"mosque.minaret.count": 2}),
    ("A church with a copper-green spire", {"church.spire.color": "green"}),
    ("A mosque with a minaret of about 30 m", {"mosque.minaret.height": 30}),
    ("A village with a domed mosque", {"mosque.dome.count.min": 1}),
    ("A blue dome on the church", {"church.dome.color": "blue"}),
    ("A twin-towered cathedral", {"cathedral.tower.count": 2}),
    ("Each factory has a brick chimney 50 m high",
     {"factory.chimney.material": "brick", "factory.chimney.height": 50}),
    ("A church. Its spire is green and 45 m high",
     {"church.spire.color": "green", "church.spire.height": 45}),
    ("A village with a church without a tower", {"church.tower.count": 0}),
    ("Shops with red awnings", {"shop.awning.color": "red", "shop.awning.count.min": 1}),
    ("A town hall with a clock", {"town_hall.clock.count.min": 1}),
]  # fmt: skip


@pytest.mark.parametrize(("text", "told"), READ)
def test_what_is_said_of_a_part_is_of_it_alone(text, told):
    brief = read_brief(text)
    slots = dict(brief.items())
    assert told.items() <= slots.items()
    of_all = ("height", "color", "material", "feature", "roof")
    assert not any(key.startswith(f"building.{look}") for key in slots for look in of_all)
    assert "tower" not in slots.values()
    for slot in brief.slots:
        assert any(goal.span == slot.span for goal in brief.goals)


# Sentence, slots that it says, and keys or values that it does not say.
OF_ANOTHER = [
    ("A castle with a tower 40 m from the river", {"castle.tower.count.min": 1}, {"tower.height"}),
    ("A castle with a tower 50 m north of the square", {}, {"tower.height"}),
    ("A castle with a tower, 60 m from a school", {}, {"tower.height"}),
    ("A castle with a tower 60 m away from a school", {}, {"tower.height"}),
    ("A castle with a tower 40 m high", {"castle.tower.height": 40}, set()),
    ("A school with a garden of 200 m2 and houses with gardens of 100 m2",
     {"house.garden.area": 100}, {"school.garden"}),
    ("A church and a fountain with a dome", {}, {"church.dome"}),
    ("A church with no spire and a white tower",
     {"church.spire.count": 0, "church.tower.color": "white"}, {"spire.count.min"}),
    ("A fountain of bronze and white benches", {"bench.color": "white"}, {"bench.material"}),
    ("A statue of marble and wooden kiosks",
     {"statue.material": "stone", "kiosk.material": "timber"}, set()),
    ("A street of brick and timber houses", {"building.type": "house"}, {"street.material"}),
    ("A house with a garden of roses", {}, {"pink"}),
    ("A detached church and twenty houses", {"building.count": 20}, {"detached"}),
    ("Houses with a detached garage", {}, {"detached"}),
    ("Houses with a detached belfry", {}, {"detached"}),
    ("Twenty houses, all detached", {"house.walls": "detached"}, set()),
    ("Detached brick houses", {"house.walls": "detached"}, set()),
    ("All houses have red roofs except the church, which has a copper roof",
     {"roof.color": "red"}, {"building.roof"}),
    ("All houses are red except the church, which is white", {"building.color": "red"}, {"white"}),
    ("Except for the church, all houses have slate roofs", {"building.roof": "slate"}, set()),
    ("A row of shops 50 m off the main road", {"building.type": "shop"}, {"height"}),
    ("Two cars for every bicycle", {"bicycle.share": 0.3333}, {"vehicle.count"}),
    ("Two benches for every tree", {"element": "bench"}, {"count"}),
    ("A lorry to every ten cars", {}, {"count"}),
    ("A town with all houses two storeys higher", {}, {"floors"}),
    ("A library, two storeys taller than the houses", {"element": "library"}, {"floors"}),
    ("A town with blocks ten storeys or higher", {"building.floors.min": 10}, set()),
]  # fmt: skip


@pytest.mark.parametrize(("text", "told", "untold"), OF_ANOTHER)
def test_what_is_said_of_one_thing_is_not_taken_for_another(text, told, untold):
    slots = [(slot.key, slot.value) for slot in read_brief(text).slots]
    assert set(told.items()) <= set(slots)
    for word in untold:
        assert not any(word in key or word == value for key, value in slots)
    areas = [value for key, value in slots if key == "house.garden.area"]
    assert len(areas) < 2


def test_a_second_look_that_a_command_gives_to_a_part_is_asked():
    brief = read_brief("Paint the houses red, with white windows.", base=True)
    assert not any(("color", "white") in edit.change for edit in brief.edits)
    assert any("white windows" in question.text for question in brief.questions)


@pytest.mark.parametrize("text", ["Some of the churches have spires", "Houses with chimneys"])
def test_what_is_said_of_some_or_of_most_buildings_is_no_part_of_a_host(text):
    assert not any(key.count(".") > 1 and "spire" in key for key, _ in read_brief(text).items())


def test_parts_call_for_what_builds_them():
    brief = read_brief("A courthouse with a clock tower 40 m high and shops with red awnings")
    called = dict(slots_of_brief(brief)[DO])
    assert called["layout/host_parts-v1"] == {
        "kind": "courthouse", "part": "clock_tower", "least": 1, "height": 40.0
    }  # fmt: skip
    added = [args for name, args in slots_of_brief(brief)[DO] if name == "edit/add_parts-v1"]
    assert [(args["part"], args["kind"]) for args in added] == [
        ("clock", "courthouse"), ("awning", "shop")
    ]  # fmt: skip
