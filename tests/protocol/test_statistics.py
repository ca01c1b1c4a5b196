import pytest

from cityx.protocol import Format, registry
from cityx.protocol.formats import FORMATS
from cityx.protocol.statistics import PAPER, format_shares


def test_shares_sum_to_one_hundred_for_ours_and_the_papers():
    actions = registry(outside=False)
    rows = format_shares(actions[i] for i in actions.of_stage("convert"))
    assert sum(r.pidf for r in rows) == pytest.approx(100, abs=0.1)
    assert sum(r.podf for r in rows) == pytest.approx(100, abs=0.1)
    assert sum(r.paper_pidf for r in rows) == pytest.approx(100, abs=0.1)
    assert sum(r.paper_podf for r in rows) == pytest.approx(100, abs=0.1)


def test_the_papers_percentages_are_counts_over_222_and_126():
    for fmt, (pidf, podf) in PAPER.items():
        for percent, total in ((pidf, 222), (podf, 126)):
            count = round(percent * total / 100)
            assert percent == pytest.approx(100 * count / total, abs=0.0051), fmt


def test_there_are_exactly_fourteen_formats_and_each_has_a_type():
    assert len(Format) == 14
    for fmt in Format:
        assert isinstance(FORMATS[fmt].python_type(), type)
