"""High and low places, middles and sides are read of the thing before them, or named."""

import pytest

from cityx.language import read_brief
from cityx.language.asked import slots_of_brief
from cityx.protocol.serving import DO

READ = [
    ("A village with a chapel on the hill above", {"church.side": "high", "terrain": "hill"}),
    ("A hill town with a bell tower at the very top", {"bell_tower.side": "high"}),
    ("A hill town with a castle at the highest point", {"castle.side": "high"}),
    ("A village on a slope with a hotel at the foot of the slope", {"hotel.side": "low"}),
    ("A town by a lake with an inn down by the water",
     {"hotel.near": "lake", "hotel.relation": "at"}),
    ("A town with an abbey as the highest building", {"monastery.height": "tallest"}),
    ("A mosque dead centre", {"mosque.side": "middle"}),
    ("A courthouse in the middle of a green",
     {"courthouse.near": "park", "courthouse.relation": "in", "element": "courthouse"}),
    ("A hotel with a helipad on top", {"helipad.near": "hotel", "helipad.relation": "on"}),
    ("A square with shops on all four sides", {"shop.by": "plaza"}),
    ("A town hall on a green, brick storefronts round all four sides", {"shop.by": "park"}),
]  # fmt: skip


@pytest.mark.parametrize(("text", "told"), READ)
def test_where_something_stands_is_read(text, told):
    brief = read_brief(text)
    assert set(told.items()) <= set(brief.items())
    assert "tower" not in [value for _, value in brief.items()]
    assert not any(key == "building.count" for key, _ in brief.items())


@pytest.mark.parametrize(
    "text",
    ["A town with a church at the top of the high street", "Hills with a monastery at the top",
     "A hotel overlooking the town"],
)  # fmt: skip
def test_what_is_high_on_no_known_land_is_left_open(text):
    brief = read_brief(text)
    assert not any(value == "high" for _, value in brief.items())
    assert brief.notes or brief.unread


@pytest.mark.parametrize(
    ("text", "side"),
    [("A hill village with a chapel at the very top", "middle"),
     ("A town in a valley with a castle on high ground", "edge"),
     ("A village on a slope that rises to the west with a school at the top", "west"),
     ("A village on a slope with a school at the foot of the slope", "south")],
)  # fmt: skip
def test_high_land_is_where_its_form_has_it(text, side):
    called = [args for name, args in slots_of_brief(read_brief(text))[DO]
              if name == "layout/elements-v1"]  # fmt: skip
    assert side in [args.get("side") for args in called]


@pytest.mark.parametrize(
    ("text", "walls"),
    [("20 semis", "semi"), ("A suburb of semi-detached houses", "semi"),
     ("Every house is detached", "detached"), ("60 detached bungalows", "detached"),
     ("120 semis and 30 detached", None), ("Shops, then flats, then semis", None),
     ("Semis, then terraced houses", None)],
)  # fmt: skip
def test_walls_of_houses_are_read_where_all_are_alike(text, walls):
    assert dict(read_brief(text).items()).get("house.walls") == walls


def test_terraces_in_rows_are_houses_and_rice_terraces_are_none():
    assert ("building.type", "terrace") in read_brief("Rows of red-brick terraces").items()
    assert not any(value == "terrace" for _, value in read_brief("Rice terraces").items())
