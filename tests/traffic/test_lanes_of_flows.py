"""Vehicles that are under way at the beginning are on lanes that are open to them."""

from types import SimpleNamespace

import numpy as np
import pytest

from cityx.traffic.flows import _slots

LINE = np.array([[0.0, 0.0, 0.0], [100.0, 0.0, 0.0]])


def lane(kind, **more):
    told = {"kind": kind, "public": kind == "drive", "closed": False, "local": "", "length": 100.0,
            "shape": LINE, "width": 3.25}  # fmt: skip
    return SimpleNamespace(**(told | more))


@pytest.mark.parametrize(
    ("vehicle", "lanes"),
    [("car", {1}), ("truck", {1}), ("bus", {0, 1}), ("bicycle", {0, 1})],
)
def test_no_vehicle_begins_on_a_lane_that_is_closed_to_it(vehicle, lanes):
    way = SimpleNamespace(edge=7, lanes=[lane("bus"), lane("drive"), lane("bus", closed=True)])
    net = SimpleNamespace(streets=SimpleNamespace(ways=[way]), usable=[True])
    look = SimpleNamespace(kind=vehicle, size=(5.0, 2.0, 1.5))
    assert {slot.lane for slot in _slots(net, [7], look, [])} == lanes
