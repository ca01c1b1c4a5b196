import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from cityx.city.signals import STATE, Signals, crossing_ids, people_see, states_at, vehicles_see

NORTH, EAST = np.pi / 2, 0.0


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


def heads(*rows):
    """Make heads of (x, y, heading, crossing, state before 10 s, state from then), cycle 20 s."""
    count = len(rows)
    return Signals(
        head_id=np.arange(1, count + 1, dtype=np.uint64),
        lane=np.array([0 if row[3] else 7 for row in rows], np.uint64),
        onto=np.array([0 if row[3] else 8 for row in rows], np.uint64),
        crossing=np.array([row[3] for row in rows], np.uint64),
        position=np.array([(row[0], row[1], 0.0) for row in rows], float),
        heading=np.array([row[2] for row in rows], float),
        cycle=np.full(count, 20.0),
        change_start=np.arange(0, 2 * count + 1, 2),
        time=np.tile([0.0, 10.0], count),
        state=np.array([STATE[name] for row in rows for name in row[4:]], np.uint8),
    )


def test_a_pole_shows_what_the_lanes_before_it_are_let():
    signals = heads(
        (0.0, 0.0, NORTH, 0, "green", "red"), (20.0, 5.0, EAST + np.pi, 0, "red", "green")
    )
    south, east = (3.0, 1.0), (21.0, 8.0)  # at the lines, looking at who arrives
    xy, facing = np.array([south, east]), np.array([(0.0, -1.0), (1.0, 0.0)])
    assert vehicles_see(xy, facing, signals, 5.0).tolist() == [STATE["green"], STATE["red"]]
    assert vehicles_see(xy, facing, signals, 15.0).tolist() == [STATE["red"], STATE["green"]]
    assert vehicles_see(xy, facing, signals, 25.0).tolist() == [STATE["green"], STATE["red"]]


def test_a_second_pole_beyond_the_junction_shows_the_same():
    signals = heads((0.0, 0.0, NORTH, 0, "yellow", "red"))
    pole, facing = np.array([(3.0, 25.0)]), np.array([(0.0, -1.0)])
    assert vehicles_see(pole, facing, signals, 5.0).tolist() == [STATE["yellow"]]


def test_of_lanes_beside_each_other_the_one_that_is_let_most_counts():
    signals = heads(
        (0.0, 0.0, NORTH, 0, "red", "red"), (-3.0, 0.0, NORTH, 0, "green_yielding", "red")
    )
    pole, facing = np.array([(2.5, 0.5)]), np.array([(0.0, -1.0)])
    assert vehicles_see(pole, facing, signals, 5.0).tolist() == [STATE["green_yielding"]]


def test_a_pole_with_no_head_near_or_that_looks_away_shows_nothing_known():
    signals = heads((0.0, 0.0, NORTH, 0, "green", "red"))
    xy = np.array([(3.0, 90.0), (3.0, 1.0), (40.0, 1.0)])
    facing = np.array([(0.0, -1.0), (0.0, 1.0), (0.0, -1.0)])
    assert vehicles_see(xy, facing, signals, 5.0).tolist() == [-1, -1, -1]
    none = heads((0.0, 0.0, NORTH, 5, "green", "red"))
    assert vehicles_see(xy, facing, none, 5.0).tolist() == [-1, -1, -1]


def test_people_see_the_crossing_next_to_them():
    signals = heads(
        (0.0, 0.0, EAST, 5, "green", "red"), (9.0, 0.0, EAST, 6, "red", "green"),
        (1.0, 0.0, NORTH, 0, "red", "red"),
    )  # fmt: skip
    xy = np.array([(1.0, 1.0), (8.0, 1.0), (60.0, 0.0)])
    assert people_see(xy, signals, 5.0).tolist() == [1, 0, -1]
    assert people_see(xy, signals, 15.0).tolist() == [0, 1, -1]


@given(st.integers(0, 2**32 - 1))
def test_the_order_of_heads_and_poles_changes_nothing(seed):
    rng = np.random.default_rng(seed)
    names = list(STATE)
    rows = [(*rng.uniform(-40, 40, 2), rng.uniform(-4, 4), int(rng.integers(0, 2)),
             *rng.choice(names, 2)) for _ in range(6)]  # fmt: skip
    turn = rng.uniform(0, 6, 8)
    xy, facing = rng.uniform(-40, 40, (8, 2)), np.column_stack([np.cos(turn), np.sin(turn)])
    one, other = heads(*rows), heads(*rows[::-1])
    shown = vehicles_see(xy, facing, one, 3.0)
    assert (shown == vehicles_see(xy, facing, other, 3.0)).all()
    assert (shown[::-1] == vehicles_see(xy[::-1], facing[::-1], one, 3.0)).all()
    assert (people_see(xy, one, 3.0) == people_see(xy, other, 3.0)).all()
