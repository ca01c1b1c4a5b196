"""Curves that are drawn into a city and taken out again."""

import pytest

from cityx.city.content import content_hash
from cityx.edit.curves import draw_curve, erase_curve
from cityx.errors import ActionFailed
from cityx.protocol.example_city import example_city

POINTS = ((-20.0, -20.0), (0.0, 0.0), (9.0, 5.0))


def test_a_curve_that_is_erased_leaves_the_city_as_it_was():
    city = example_city()
    drawn = draw_curve(city, name="path 1", points=POINTS)
    both = draw_curve(drawn, name="path 2", points=POINTS)
    assert content_hash(erase_curve(both, name="path 2")).total == content_hash(drawn).total
    assert len(erase_curve(drawn, name="path 1").layout.lines) == len(city.layout.lines)


def test_a_curve_that_is_not_there_is_told_with_the_nearest():
    city = draw_curve(example_city(), name="path 1", points=POINTS)
    with pytest.raises(ActionFailed, match=r'The city has no curve "path 2".*path 1'):
        erase_curve(city, name="path 2")
