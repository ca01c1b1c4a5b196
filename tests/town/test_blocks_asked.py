"""Blocks of a number, a size and a direction, as sentences ask for them."""

from dataclasses import replace

import numpy as np
import pytest
import shapely

from cityx.checks.predicates import measure, parse
from cityx.city import City, Frame, Layout
from cityx.city.content import content_hash
from cityx.errors import UsageError
from cityx.language import read_brief
from cityx.town.town import town


def grid(seed=3, **plan):
    city = City("Town", Frame(50.0, 10.0), Layout((0.0, 0.0, 1.0, 1.0)), seed=seed)
    return town(city, pattern="grid", **plan)


@pytest.mark.parametrize(
    "text",
    [
        "A town of 4 by 3 blocks", "six blocks of 80 x 120 m",
        "a 3x2 grid of blocks, each 70 m wide",
        "exactly seven blocks", "at least 10 blocks of 60 m", "a grid of blocks of about 113 m",
        "113 m blocks", "blocks 100 m long and 60 m wide", "a village with six blocks",
        "a grid turned by 30 degrees", "A grid of streets rotated by 15\u00b0 clockwise",
        "2 by 2 blocks of 90 m, the streets turned by 40 degrees anticlockwise",
    ],
)  # fmt: skip
def test_blocks_are_as_many_and_as_large_as_a_sentence_says(text, check_sentence):
    check_sentence(text)


def test_blocks_are_exact_whatever_the_number():
    for count in (1, 2, 5, 12, 23):
        city = grid(blocks=count, fitted=True, zone="midrise")
        assert measure(f"n(block) == {count}", city).met
        assert measure("n(dead_end) == 0", city).met
    city = grid(columns=3, rows=2, block_width=113.0, block_depth=80.0, fitted=True)
    for side, metres in (("width", 80.0), ("length", 113.0)):
        values = [measure(f"stat(block, {side}, {end}) >= 0", city).value for end in ("min", "max")]
        assert np.allclose(values, metres, atol=0.3)


def test_blocks_that_do_not_fit_are_refused_with_the_room_they_take():
    with pytest.raises(UsageError, match=r"4 by 4 blocks of 113 m by 113 m .* take 526 m by 526 m"):
        grid(columns=4, rows=4, block_width=113.0, block_depth=113.0, width=300.0, depth=300.0)
    with pytest.raises(UsageError, match=r"7 blocks do not make 2 in a row|are 6, not 7"):
        grid(blocks=7, columns=2, rows=3)
    with pytest.raises(UsageError, match="laid in a grid; pattern is organic"):
        town(grid(), pattern="organic", blocks=4)


def test_the_same_blocks_come_of_the_same_seed():
    cities = [grid(blocks=7, turn_deg=20.0, fitted=True) for _ in range(2)]
    assert content_hash(cities[0]).total == content_hash(cities[1]).total


@pytest.mark.parametrize(
    "text",
    ["the hotel is three blocks from the station", "a block of flats", "A block of 100 by 100 m",
     "blocks of flats 20 m high", "an apartment block with six floors"],
)  # fmt: skip
def test_other_blocks_are_no_blocks_between_streets(text):
    assert not [slot for slot in read_brief(text).slots if slot.key.startswith("block.")]


def test_a_block_is_what_streets_enclose_and_no_type_of_building():
    city = grid(columns=2, rows=1, fitted=True)
    assert measure(parse("n(block) == 2"), city).met
    roads = city.layout.roads
    middle = shapely.Point(0.0, 0.0)
    cut = roads[roads.distance(middle) > 1.0].reset_index(drop=True)
    opened = replace(city, layout=replace(city.layout, roads=cut))
    assert measure("n(block) == 1", opened).met
