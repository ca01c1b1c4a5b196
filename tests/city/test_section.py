import pytest
from hypothesis import given
from hypothesis import strategies as st

from cityx.city.section import (
    BAND_KINDS,
    TURN,
    Band,
    carriageway_width,
    read_section,
    section_text,
)
from cityx.errors import UsageError

bands = st.builds(
    Band,
    st.sampled_from(BAND_KINDS),
    st.integers(5, 900).map(lambda value: value / 100),
    st.sampled_from((-1, 0, 1)),
    st.integers(0, 15),
)


@given(st.lists(bands, min_size=1, max_size=9))
def test_what_is_written_is_read_back(drawn):
    drawn = [*drawn, Band("drive", 3.25, 1, TURN["left"] | TURN["through"])]
    assert read_section(section_text(drawn)) == tuple(drawn)


def test_a_section_reads_as_one_sees_it_along_the_road():
    text = "walk 1.8 | parking 2.1 | drive 3.25 - | drive 3.25 + left;through | cycle 1.6 +"
    found = read_section(text)
    assert [band.kind for band in found] == ["walk", "parking", "drive", "drive", "cycle"]
    assert [band.direction for band in found] == [0, 0, -1, 1, 1]
    assert found[3].turns == TURN["left"] | TURN["through"]
    assert carriageway_width(found) == pytest.approx(10.2)


def test_every_fault_of_a_section_is_named_at_once():
    with pytest.raises(UsageError) as caught:
        read_section("flive 3 | drive | drive wide | drive 99 | drive 3 + lef")
    text = str(caught.value)
    for part in ("band 1", 'Did you mean "drive"?', "band 2", "band 3, 'drive wide'", "99",
                 "band 5", 'Did you mean "left"?'):  # fmt: skip
        assert part in text


def test_a_section_on_which_nothing_moves_is_refused():
    with pytest.raises(UsageError, match="nothing moves"):
        read_section("walk 2 | parking 2.1")
