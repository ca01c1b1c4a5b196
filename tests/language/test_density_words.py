"""People, plot ratios, built shares and means, as sentences say them."""

import pytest

from cityx.language import read_brief
from cityx.language.asked import slots_of_brief
from cityx.protocol.serving import DO


def read(text):
    brief = read_brief(text)
    return {slot.key: slot.value for slot in brief.slots}, {g.predicate for g in brief.goals}


@pytest.mark.parametrize(
    ("text", "key", "value", "predicate"),
    [
        ("A plot ratio of about 1.5", "plot.ratio", 1.5, "plot.ratio in [1.35, 1.65]"),
        ("A city with a floor area ratio of 2", "plot.ratio", 2, "plot.ratio in [1.8, 2.2]"),
        ("A town with a FAR of 3", "plot.ratio", 3, "plot.ratio in [2.7, 3.3]"),
        ("A town with a mean height of four floors", "floors.mean", 4,
         "stat(building, floors, mean) in [3.6, 4.4]"),
        ("Buildings that are 18 m high on average", "height.mean", 18,
         "stat(building, height, mean) in [16.2, 19.8]"),
        ("An average building height of 15 m", "height.mean", 15,
         "stat(building, height, mean) in [13.5, 16.5]"),
        ("A quarter for 2,000 residents", "population", 2000, "population in [1800, 2200]"),
        ("A town for 5000 people", "population", 5000, "population in [4500, 5500]"),
        ("A site that is 45 % built", "building.share", 0.45,
         "cover(building) in [0.405, 0.495]"),
        ("A town with 40 % of the land built on", "building.share", 0.4,
         "cover(building) in [0.36, 0.44]"),
    ],
)  # fmt: skip
def test_a_number_of_density_is_read_and_measured(text, key, value, predicate):
    slots, goals = read(text)
    assert slots[key] == value
    assert predicate in goals
    assert not {"building.count", "building.height", "size.x"} & slots.keys()


def test_a_town_for_people_is_as_large_as_they_take():
    def side(text):
        return slots_of_brief(read_brief(text))["town.width"][0]

    assert side("A suburb for 800 people") > side("A quarter for 800 people")
    assert side("A quarter for 4000 people") > 1.8 * side("A quarter for 1000 people")
    slots = slots_of_brief(read_brief("A town of 500 m by 500 m for 3000 people"))
    assert slots["town.width"] == (500.0,)
    assert ("layout/floor_area-v1", {"people": 3000.0}) in slots[DO]


@pytest.mark.parametrize(
    ("text", "keys"),
    [
        ("Crop to 200 m around the centre, in snow", {"size.x": 400, "size.y": 400}),
        ("Cut the map to 300 m", {"size.x": 300, "size.y": 300}),
        ("Clip the extract to 500 m, at dusk", {"size.x": 500, "size.y": 500}),
        ("The map, and nothing above six floors please", {"building.floors.max": 6}),
        ("The extract with soot-dark brick, nothing above 4 storeys", {"building.floors.max": 4}),
        ("Use the map, at night, none above three floors", {"building.floors.max": 3}),
    ],
)
def test_what_is_said_of_a_map(text, keys):
    brief = read_brief(text, inputs=[("a.osm", "osm")])
    found = {slot.key: slot.value for slot in brief.slots}
    assert keys.items() <= found.items()
