"""Whatever a town can be asked to hold can be added to a city that exists."""

import pytest

from cityx.assets.furniture.street_furniture import MAKERS, furniture
from cityx.checks.predicates.vocabulary import PIECES
from cityx.city.layout import ASKED_KINDS
from cityx.edit.land.add import LARGE, WORDS
from cityx.edit.land.add_element import KINDS, LYING
from cityx.language.lexicon.phrases import NOUNS
from cityx.nature.furniture.furnishing import PIECES as MAPPED
from cityx.sources.features.vocabulary import POINT_HEIGHT
from cityx.town.elements import ELEMENTS


@pytest.mark.parametrize("kind", [name for name, one in ELEMENTS.items() if not one.builder])
def test_every_element_is_added_by_an_edit(kind):
    as_building = kind in NOUNS["type"] and kind in KINDS
    assert as_building or kind in LYING or WORDS.get(kind) in MAKERS or kind in ("meadow",)


@pytest.mark.parametrize("kind", ASKED_KINDS)
def test_a_thing_that_is_asked_for_is_built_as_high_as_it_is_mapped(kind):
    assert MAPPED[kind] == kind
    assert any(kind.startswith(words) for words in PIECES.values())
    low, high = POINT_HEIGHT[kind]
    assert low <= high
    top = furniture(kind).mesh.vertices[:, 2].max()
    assert top == pytest.approx(high, abs=0.15 * high + 0.1)


def test_what_is_large_has_a_lot_of_its_own():
    assert set(LARGE) <= set(LYING)
    assert not set(LARGE) & set(WORDS)
