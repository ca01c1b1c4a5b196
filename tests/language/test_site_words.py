"""What sentences say of the land and the waters of a site, and what is asked of actions for it."""

import pytest

from cityx.language import read_brief
from cityx.language.asked import slots_of_brief
from cityx.protocol.serving import DO

LAND = {
    "A hill village with a church": {"form": "hill"},
    "A town on a hill 20 m high": {"form": "hill", "metres": 20.0},
    "A market town around a hill": {"form": "hill"},
    "A town on hills of 40 m": {"form": "hills", "metres": 40.0},
    "Rolling hills up to 20 m high with a village": {"form": "hills", "metres": 18.0},
    "A village among gentle hills": {"form": "hills", "steepest": 0.08},
    "The ground rises 30 m to the north": {"form": "slope", "metres": 30.0, "side": "north"},
    "A town whose land falls 12 m to the east": {"form": "slope", "metres": 12.0, "side": "west"},
    "A slope of 8 percent, higher in the west": {"form": "slope", "grade": 0.08, "side": "west"},
    "A town in a valley 25 m deep": {"form": "valley", "metres": 25.0},
    "A valley running from north to south": {"form": "valley", "axis": "north_south"},
    "A village in the valley, at least 20 m deep": {"form": "valley"},
    "A terraced hillside with three terraces": {"form": "terraces", "steps": 3},
    "A town on a plateau 12 m high": {"form": "plateau", "metres": 12.0},
    "A ridge runs from north to south": {"form": "ridge", "axis": "north_south"},
    "A mountainous town": {"form": "mountains"},
    "The sea lies in the south and the town climbs 25 m up from it":
        {"form": "slope", "metres": 25.0, "side": "north"},
}  # fmt: skip

RIVERS = {
    "A town with a river": {},
    "Two rivers that meet in the middle": {"meet": True, "count": 2, "bridges": 4},
    "Three rivers meet in this town": {"meet": True, "count": 3, "bridges": 6},
    "A town where two rivers join": {"meet": True, "count": 2, "bridges": 4},
    "Three rivers, each 20 m wide": {"count": 3, "width": 20.0, "bridges": 6},
    "Two rivers with five bridges": {"count": 2, "bridges": 5},
    "A river along the east edge, 40 m wide": {"side": "east", "width": 40.0},
    "A river in the south": {"side": "south"},
    "A river through the middle of the town": {"side": "middle"},
    "A straight canal 12 m wide": {"kind": "canal", "width": 12.0},
    "A town with two canals": {"kind": "canal", "width": 12.0, "count": 2, "bridges": 4},
    "A canal on the west side": {"kind": "canal", "width": 12.0, "side": "west"},
}


def asked(text, action):
    """Return the brief of a sentence and the arguments that an action gets for it."""
    brief = read_brief(text)
    return brief, next((args for name, args in slots_of_brief(brief)[DO] if name == action), None)


@pytest.mark.parametrize("text", LAND)
def test_land_is_read_whole_and_asked_for(text):
    brief, args = asked(text, "terrain/relief-v1")
    assert args is not None
    assert LAND[text].items() <= args.items()
    assert not brief.words_unread
    assert not [note for note in brief.notes if note.code == "not_checkable"]
    assert any(goal.predicate.startswith("terrain.") for goal in brief.goals)


@pytest.mark.parametrize("text", RIVERS)
def test_rivers_are_read_whole_and_asked_for(text):
    brief, args = asked(text, "layout/river-v1")
    assert args == RIVERS[text]
    assert not brief.words_unread
    assert not [note for note in brief.notes if note.code in ("not_checkable", "left_open")]


@pytest.mark.parametrize("text", ["A flat town", "A town without hills", "No valley, please"])
def test_flat_land_needs_no_action(text):
    brief, args = asked(text, "terrain/relief-v1")
    assert args is None
    assert any("terrain.form" in goal.predicate for goal in brief.goals)


@pytest.mark.parametrize("word", ["river", "canal"])
def test_no_water_is_built_where_it_is_denied(word):
    brief, args = asked(f"A town with no {word}", "layout/river-v1")
    assert args is None
    assert f"n({word}) == 0" in [goal.predicate for goal in brief.goals]


@pytest.mark.parametrize(
    "text",
    [
        "Streets with a slope of at most 6 percent",
        "A maximum road gradient of 8 percent",
        "Houses 12 m high in the north",
        "The towers rise 60 m",
        "Sloping roofs",
    ],
)
def test_what_is_not_said_of_the_land_is_none(text):
    assert not any(slot.key.startswith("terrain") for slot in read_brief(text).slots)


def test_heights_of_a_file_go_before_words():
    slots = slots_of_brief(read_brief("A hilly town", inputs=[("dem.tif", "height")]))
    assert not [name for name, _ in slots[DO] if name == "terrain/relief-v1"]
