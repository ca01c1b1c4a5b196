"""What a wish without numbers asks for can be read as a predicate."""

import pytest

from cityx.checks.predicates import parse
from cityx.language import Slot
from cityx.language.goals import SOURCES, WORDS, goals_of

ROWS = [
    (slot, value, text)
    for slot, values in {**WORDS, "source": SOURCES}.items()
    for value, texts in values.items()
    for text in texts
]
SAMPLES = {
    "style": "modern", "time": "dusk", "roads.pattern": "grid", "weather": "rain",
    "roads.main.axis": "north_south", "building.gradient": "center", "density.gradient": "edge",
    "nature.species": "palm", "nature.species.streets": "palm", "nature.species.parks": "oak",
    "source": "town.osm", "wind.from": "west", "sun.side": "southwest",
}  # fmt: skip


@pytest.mark.parametrize(("slot", "value", "text"), ROWS)
def test_every_wish_is_a_predicate(slot, value, text):
    assert parse(text.format(v=SAMPLES.get(slot, value)))


@pytest.mark.parametrize(
    ("size", "asked"),
    [((), "n(road, class=primary) >= 1"), ((300.0, 300.0), "n(road, class=main) >= 1")],
)
def test_heavy_traffic_wants_a_main_road_that_the_site_has_room_for(size, asked):
    sides = [Slot(key, value) for key, value in zip(("size.x", "size.y"), size, strict=False)]
    goals, _ = goals_of([Slot("traffic", "heavy"), *sides])
    assert asked in [goal.predicate for goal in goals]


def test_heavy_traffic_in_a_quarter_without_main_roads_fills_its_streets():
    goals, _ = goals_of([Slot("traffic", "heavy"), Slot("district", "old_town")])
    assert "density(vehicle, road) >= 8" in [goal.predicate for goal in goals]


def test_a_window_of_a_map_is_at_least_as_large_as_asked():
    slots = [Slot("source", "osm"), Slot("size.x", 200.0)]
    predicates = [goal.predicate for goal in goals_of(slots, (), (), ())[0]]
    assert "size.x >= 198" in predicates
