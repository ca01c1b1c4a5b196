from pathlib import Path

from cityx.language.lexicon.phrases import phrase_book, table_of_elements


def test_the_published_phrase_book_is_that_of_the_code():
    published = Path(__file__).parents[2] / "docs" / "phrases.md"
    assert published.read_text(encoding="utf-8") == phrase_book()


def test_the_published_table_of_elements_is_that_of_the_code():
    published = Path(__file__).parents[2] / "docs" / "elements.md"
    assert table_of_elements() in published.read_text(encoding="utf-8")
