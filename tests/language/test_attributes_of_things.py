"""Materials, colours and measures of things, and what things do not have."""

import pytest

from cityx.language import read_brief
from cityx.language.asked import slots_of_brief
from cityx.protocol.serving import DO


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("A town with a bronze statue 6 m high", {"statue.material": "bronze", "statue.height": 6}),
        ("A town with a wooden pier 40 m long", {"pier.material": "timber", "pier.length": 40}),
        ("A town. The benches should be blue.", {"bench.color": "blue"}),
        ("A town with a gravel car park", {"parking_lot.material": "gravel"}),
        ("A town where the car park is paved with gravel", {"parking_lot.material": "gravel"}),
        ("A town with blue market stalls", {"market.color": "blue"}),
        ("A town with a steel bridge", {"bridge.material": "metal"}),
        ("A town with a large statue", {"statue.size": "large"}),
        ("A village with a stone wall around it", {"city_wall.material": "stone"}),
        ("A town with a bakery 20 m long", {"bakery.length": 20}),
        ("A town with a statue at a corner", {"statue.near": "corner"}),
        ("A town with a kiosk and a school, both at a corner",
         {"kiosk.near": "corner", "school.near": "corner"}),
        ("A playground surrounded by a hedge", {"playground.enclosed": "hedge"}),
        ("A town with a church with a white wooden fence around it",
         {"church.enclosed": "fence", "fence.color": "white", "fence.material": "timber"}),
        ("A town with a school enclosed by a low stone wall",
         {"school.enclosed": "boundary_wall", "boundary_wall.material": "stone",
          "boundary_wall.height.max": 1.2}),
        ("A town with a kiosk surrounded by oaks", {"oak.by": "kiosk"}),
    ],
)  # fmt: skip
def test_attributes_are_of_their_thing(text, told):
    brief = read_brief(text)
    assert told.items() <= dict(brief.items()).items()
    assert not brief.unread
    assert not [note for note in brief.notes if note.code in ("left_open", "not_checkable")]


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("A town with a fountain with a red roof", "A fountain has no roof."),
        ("A town with a playground 3 m high", "A playground has no height of its own."),
        ("A town with wooden allotments", "Allotments have no material that can be chosen."),
        ("A town with a stone meadow", "A meadow has no material that can be chosen."),
        ("A town with a small railway", "A railway has no size that can be chosen."),
    ],
)
def test_what_a_thing_does_not_have_is_refused_by_name(text, sentence):
    brief = read_brief(text)
    assert any(sentence in note.text for note in brief.notes)


def test_what_is_said_of_things_is_planned():
    text = "A town with a red statue 6 m high, a wooden pier 30 m long and a fence around a school"
    calls = {(name, args.get("kind")): args for name, args in slots_of_brief(read_brief(text))[DO]}
    assert calls["edit/dress-v1", "statue"] == {"kind": "statue", "color": 0xD02018, "height": 6.0}
    assert calls["layout/elements-v1", "pier"]["length"] == 30.0
    assert calls["edit/dress-v1", "pier"] == {"kind": "pier", "material": "wood"}
    assert calls["edit/ring-v1", "school"] == {"kind": "school", "barrier": "fence"}
