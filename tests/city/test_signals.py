import numpy as np

from cityx.city.signals import STATE, Signals, crossing_ids, states_at


def two_heads():
    """One that is green for 40 s, yellow for 3 and red for 47; one that is always off."""
    return Signals(
        np.array([1, 2], np.uint64), np.array([7, 8], np.uint64), np.array([9, 9], np.uint64),
        np.zeros(2, np.uint64), np.zeros((2, 3)), np.zeros(2), np.array([90.0, 60.0]),
        np.array([0, 3, 4]), np.array([0.0, 40.0, 43.0, 0.0]),
        np.array([STATE["green"], STATE["yellow"], STATE["red"], STATE["off"]], np.uint8),
    )  # fmt: skip


def test_heads_begin_anew_after_their_cycle():
    shown = [int(states_at(two_heads(), moment)[0]) for moment in (0, 39.9, 40, 43, 89.9, 90, 131)]
    words = ["green", "green", "yellow", "red", "red", "green", "yellow"]
    assert shown == [STATE[word] for word in words]
    assert states_at(two_heads(), 1234.5)[1] == STATE["off"]


def test_crossings_of_one_street_have_two_ids():
    start, end = crossing_ids(np.array([5, 5], np.uint64), np.array([0, 1]))
    assert start != end
    assert start == crossing_ids(5, 0)
