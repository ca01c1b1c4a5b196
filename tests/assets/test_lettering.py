import numpy as np
import pytest

from cityx.assets.shops.fonts import CAP, outline
from cityx.assets.shops.lettering import glyph, is_known, line_of, word
from cityx.building.shops.shop_names import shop_words, words_of
from cityx.geometry.solids import area_vectors


@pytest.mark.parametrize("tongue", [*shop_words().words, ""])
def test_every_word_can_be_written(tongue):
    for kind in shop_words().usual:
        assert words_of(tongue)[kind]
        for text in words_of(tongue)[kind]:
            assert is_known(text), text


def test_every_kind_of_shop_has_words():
    assert (
        set(shop_words().kinds.values())
        == set(shop_words().usual)
        == set(shop_words().words["world"])
    )
    assert all(set(words) == set(shop_words().usual) for words in shop_words().words.values())


def test_a_letter_reads_from_left_to_right():
    points = glyph("L").mesh.vertices  # seen from -y: x to the right, z up
    foot, stem = points[points[:, 2] < 0.1], points[points[:, 2] > 0.5]
    assert foot[:, 0].max() > stem[:, 0].max() + 0.15
    assert points[:, 2].max() == pytest.approx(CAP, abs=0.06)


def test_a_letter_looks_out_of_the_wall_and_keeps_its_holes():
    mesh = glyph("O").mesh
    faces = area_vectors(mesh.vertices, mesh.faces)
    assert (faces[:, 1] < 0).all()
    area = -faces[:, 1].sum()
    assert area == pytest.approx(outline("O").area, rel=1e-3)


def test_a_line_is_as_wide_as_its_letters_and_in_their_order():
    line = line_of("Wine Bar")
    assert "".join(line.letters) == "WineBar"
    assert (np.diff(line.middle) > 0.1).all()
    assert line.middle[0] > -line.width / 2
    assert line.middle[-1] < line.width / 2


def test_letters_of_east_asia_fill_squares():
    line = line_of("薬局")
    assert line.width == pytest.approx(2.0, abs=0.1)
    assert not is_known("薬\ue000")


def test_a_word_keeps_to_its_field():
    points = np.vstack([part.vertices for part in word("HOSPITAL", 1.2, 0.0, 0.5, -0.1)])
    assert np.abs(points[:, 0]).max() < 1.25
    assert points[:, 2].min() > -0.05
    assert points[:, 2].max() < 0.55
    assert points[:, 1].max() == pytest.approx(-0.1)


def test_every_letter_of_europe_and_of_everyday_japanese_has_an_outline():
    letters = "ÄÖÜäöüßÉèêçñÅøŁżőŞğΑΩαωЖяЁё’–" + "亜哀愛悪握圧扱安暗案あんアンー々"
    assert [letter for letter in letters if outline(letter).is_empty] == []


def test_rings_that_overlap_are_filled_and_holes_stay_open():
    assert len(outline("8").geoms[0].interiors) == 2
    assert len(outline("i").geoms) == 2
    # The bar of a t crosses its stem as a ring of its own in many fonts.
    assert not outline("t").geoms[0].interiors
    assert all(outline(letter).is_valid for letter in "AQR&@%国薬龍")
