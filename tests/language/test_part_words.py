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
