"""Drivers keep to their lanes, and find a way on from the end of each."""

from made_sumo import Car, Sumo

from cityx.traffic.drivers import Drivers


def test_who_is_told_to_drive_on_along_a_walk_takes_a_way_that_its_lane_leads():
    walks = [f"{edge}_0" for edge in "abcd"]
    sumo = Sumo({"a_1": ("b_1",), "b_1": ("c_1",), "c_1": ("d_1",)},
                {"car": Car("a_1", "abcdz")}, walks=walks)  # fmt: skip
    sumo.best["car"] = [("a_1", 100.0, 0.0, 0, True, ("a_1", "b_0"))]
    Drivers(sumo, []).step()
    assert "".join(sumo.cars["car"].route) == "abcd"
