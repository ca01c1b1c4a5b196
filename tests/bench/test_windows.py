"""What windows of one place show the same is counted by kind, id and content."""

from dataclasses import replace

import numpy as np
import shapely
from cityx_bench.windows import box_about, compared, table

from cityx.city import Layout, make_table

INNER = box_about(0.0, 0.0, 50.0)


def town(crossroads, ids=(1, 2, 3), east=0.0):
    houses = [shapely.box(x + east, 0, x + east + 8, 8) for x in (-30, 0, 200)]
    table = make_table("buildings", houses, id=np.array(ids), levels=[2] * 3)
    return replace(crossroads, layout=Layout((-300.0, -300.0, 300.0, 300.0), buildings=table))


def test_a_city_agrees_with_itself(crossroads):
    shares = compared(crossroads, crossroads, box_about(0.0, 0.0, 100.0))
    assert {equal == total for equal, total in shares.values()} == {True}
    assert shares["layout/buildings"] == (4, 4)


def test_another_id_or_another_place_is_another_object(crossroads):
    one = town(crossroads)
    assert compared(one, town(crossroads, ids=(1, 9, 3)), INNER)["layout/buildings"] == (1, 3)
    assert compared(one, town(crossroads, east=0.001), INNER)["layout/buildings"] == (0, 4)


def test_what_lies_outside_the_inner_part_does_not_count(crossroads):
    shares = compared(town(crossroads), town(crossroads, ids=(1, 2, 9)), INNER)
    assert shares["layout/buildings"] == (2, 2)


def test_a_share_that_is_not_all_is_not_rounded_to_it():
    text = table({"0 m": {"things": (99_999, 100_000), "whole": (3, 3)}})
    assert "99.99" in text
    assert text.endswith("| whole (3) | 100 |")
