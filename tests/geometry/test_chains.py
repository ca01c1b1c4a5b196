import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from cityx.geometry.chains import components, interpolate, join_segments


def test_segments_join_through_a_node_where_nothing_branches():
    head, rank = join_segments([[1, 2], [0, 1], [2, 3], [2, 4]], [0, 0, 0, 0])
    assert head.tolist() == [1, 1, 2, 3]
    assert rank.tolist() == [1, 0, 0, 0]


def test_a_change_of_section_ends_a_chain():
    head, _ = join_segments([[0, 1], [1, 2]], [0, 1])
    assert head.tolist() == [0, 1]


def test_a_closed_chain_starts_at_its_lowest_node():
    head, rank = join_segments([[2, 3], [3, 1], [1, 2]], [0, 0, 0])
    assert head.tolist() == [2, 2, 2]
    assert rank.tolist() == [1, 2, 0]


def test_components_are_named_by_their_lowest_node():
    assert components([[4, 2], [3, 4]], 6).tolist() == [0, 1, 2, 2, 2, 5]
    assert components(np.zeros((0, 2)), 2).tolist() == [0, 1]


@settings(max_examples=40, deadline=None, derandomize=True)
@given(st.lists(st.tuples(st.integers(0, 30), st.integers(0, 30)), max_size=40))
def test_components_do_not_depend_on_the_order_of_edges(pairs):
    found = components(np.array(pairs).reshape(-1, 2), 31)
    assert found.tolist() == components(np.array(pairs[::-1]).reshape(-1, 2), 31).tolist()
    assert all(found[a] == found[b] for a, b in pairs)


def test_values_spread_evenly_between_known_nodes():
    pairs, length = [[0, 1], [1, 2], [2, 3]], [1.0, 2.0, 1.0]
    found = interpolate(pairs, length, [True, False, False, True], [0.0, 9.0, 9.0, 8.0])
    assert np.allclose(found, [0, 2, 6, 8], atol=1e-4)
