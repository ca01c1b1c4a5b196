from pathlib import Path

from cityx.language.lexicon.phrases import table_of_elements
from cityx.language.scene import table_of_scene

PAGE = Path(__file__).parents[2] / "docs" / "phrases.md"


def test_the_published_tables_are_those_of_the_code():
    published = PAGE.read_text(encoding="utf-8")
    assert table_of_elements() in published
    assert table_of_scene() in published
