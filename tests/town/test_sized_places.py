"""Squares and parks as large as is said, and courtyards inside blocks."""

import pytest


@pytest.mark.parametrize(
    "text",
    [
        "Two squares of 40 m by 40 m in a small town",
        "A small town with three parks of 3000 m2 each",
        "A village with a plaza of 2500 square metres in the middle",
        "Perimeter blocks with courtyards, five storeys",
        "A mid-rise quarter of 400 x 400 m, courtyards inside the blocks",
    ],
)
def test_a_sentence_about_the_size_of_places_is_built(check_sentence, text):
    check_sentence(text)
