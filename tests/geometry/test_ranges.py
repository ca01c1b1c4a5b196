"""Rows of tables in runs."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cityx.geometry.ranges import counted, numbered, ranges


@pytest.mark.parametrize("kind", [np.int64, np.uint8])
@given(st.lists(st.integers(0, 9), max_size=20))
def test_rows_are_numbered_within_their_things(kind, count):
    row, number = counted(np.array(count, kind))
    assert row.tolist() == [thing for thing, n in enumerate(count) for _ in range(n)]
    assert number.tolist() == [k for n in count for k in range(n)]
    assert numbered(np.array(count, kind)).tolist() == number.tolist()


@given(st.lists(st.integers(0, 5), min_size=1, max_size=9), st.data())
def test_ranges_are_the_rows_of_things_in_any_order(size, data):
    start = np.concatenate([[0], np.cumsum(size)])
    things = data.draw(st.lists(st.integers(0, len(size) - 1), max_size=9))
    rows, new_start = ranges(start, np.array(things, np.int64))
    assert rows.tolist() == [row for t in things for row in range(start[t], start[t + 1])]
    assert np.diff(new_start).tolist() == [size[t] for t in things]
