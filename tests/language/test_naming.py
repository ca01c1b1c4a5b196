"""Names that things of a city have, as a sentence may use them."""

from dataclasses import replace

import pytest
from crossing_town import crossing_town

from cityx.language.references.naming import names_of


@pytest.fixture(scope="module")
def town():
    city = crossing_town()
    roads = city.layout.roads.assign(name=["St Mary's Lane", "main street"])
    return replace(city, layout=replace(city.layout, roads=roads))


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("Widen st mary’s lane by 2 m.", ("St Mary's Lane",)),
        ("Close the LANE", ("St Mary's Lane",)),
        ("Widen the main street", ()),  # a phrase, whatever is called so
        ("Make it rain", ()),
    ],
)
def test_only_names_that_share_a_word_with_a_text_are_looked_for(town, text, found):
    assert names_of(town, text) == found
