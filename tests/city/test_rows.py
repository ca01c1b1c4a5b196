"""Rows of instances: what is left out and put in is as if the table had been sorted anew."""

import numpy as np

from cityx.city.rows import join_rows, leave_rows, merge_rows, take_rows
from cityx.city.scene import Instances
from cityx.geometry.ranges import equal_rows


def table(ids):
    count = len(ids)
    places = np.arange(3.0 * count).reshape(count, 3)
    small = places.astype(np.float32)
    return Instances(
        np.arange(count, dtype=np.int32), np.array(ids, np.uint64), np.zeros(count, np.uint64),
        places, small, small, small,
    )  # fmt: skip


def same(one, other):
    return all(
        np.array_equal(getattr(one, name), getattr(other, name))
        for name in Instances.__dataclass_fields__
    )


def sorted_anew(one, other):
    joined = join_rows([one, other])
    return take_rows(joined, np.argsort(joined.object_id, kind="stable"))


def test_rows_are_put_in_their_place_among_those_there_are():
    held = table([3, 5, 5, 9, 12])
    for ids in ([4], [1, 2, 20, 21], [9, 5, 5, 3, 13, 0], [], [12, 12]):
        assert same(merge_rows(held, table(ids)), sorted_anew(held, table(ids)))
        assert same(merge_rows(table(ids), held), sorted_anew(table(ids), held))
    loose = table([9, 3, 5])
    assert same(merge_rows(loose, held), sorted_anew(loose, held))


def test_rows_that_go_leave_the_others_as_they_are():
    held = table([3, 5, 5, 9, 12])
    for gone in ([1, 0, 0, 1, 1], [0, 0, 0, 0, 0], [1, 1, 1, 1, 1], [0, 1, 0, 1, 0]):
        mask = np.array(gone, bool)
        assert same(leave_rows(held, mask), take_rows(held, ~mask))


def test_rows_are_equal_where_every_column_is():
    one = np.arange(24.0).reshape(4, 3, 2)
    other = one.copy()
    other[2, 1, 0] = -1.0
    assert equal_rows(one, other).tolist() == [True, True, False, True]
    assert equal_rows(one[:0], other[:0]).tolist() == []
