"""What a wish without numbers asks for can be read as a predicate."""

import pytest

from cityx.agents.brief.goals import SOURCES, WORDS
from cityx.checks.predicates import parse

ROWS = [
    (slot, value, text)
    for slot, values in {**WORDS, "source": SOURCES}.items()
    for value, texts in values.items()
    for text in texts
]
SAMPLES = {
    "style": "modern", "time": "dusk", "roads.pattern": "grid", "weather": "rain",
    "roads.main.axis": "north_south", "source": "town.osm",
}  # fmt: skip


@pytest.mark.parametrize(("slot", "value", "text"), ROWS)
def test_every_wish_is_a_predicate(slot, value, text):
    assert parse(text.format(v=SAMPLES.get(slot, value)))
