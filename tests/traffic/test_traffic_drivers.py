"""Drivers keep to their lanes, and find a way on from the end of each."""

from made_sumo import Car, Sumo

from cityx.traffic.drivers import HOPELESS, STARVED, TIRED, Drivers

# One lane "a" that leads straight on to "b", or aside to "c"; from both one comes to "d".
FORK = {"a_0": ("b_0", "c_0"), "b_0": ("d_0",), "c_0": ("d_0",)}


def test_who_is_told_to_drive_on_along_a_walk_takes_a_way_that_its_lane_leads():
    walks = [f"{edge}_0" for edge in "abcd"]
    sumo = Sumo({"a_1": ("b_1",), "b_1": ("c_1",), "c_1": ("d_1",)},
                {"car": Car("a_1", "abcdz")}, walks=walks)  # fmt: skip
    sumo.best["car"] = [("a_1", 100.0, 0.0, 0, True, ("a_1", "b_0"))]
    Drivers(sumo, []).step({})
    assert "".join(sumo.cars["car"].route) == "abcd"


def led_on(*others, seconds=TIRED):
    """The way of one who is first at the end of "a", after it has stood there for seconds."""
    sumo = Sumo(FORK, {"first": Car("a_0", "abd")})
    drivers = Drivers(sumo, [])
    drivers.step({})
    sumo.cars |= dict(others)
    drivers.step({"first": seconds})
    return "".join(sumo.cars["first"].route)


def test_who_has_stood_before_a_full_exit_takes_another_one_of_its_lane():
    last, moved_up = ("last", Car("b_0", "bd", at=6.0)), ("last", Car("b_0", "bd", at=20.0))
    assert led_on(last) == "acd"
    assert led_on(last, seconds=TIRED - 1.0) == "abd"
    assert led_on(moved_up) == "abd"
    assert led_on(last, ("other", Car("c_0", "cd", at=6.0))) == "abd"  # both are full


def test_drivers_go_round_a_jam_ahead_unless_that_is_far():
    for length, way in ((100.0, "acd"), (1000.0, "abd")):
        sumo = Sumo(FORK, {"car": Car("a_0", "abd")}, length={"c_0": length})
        Drivers(sumo, []).step({}, {"b"})
        assert "".join(sumo.cars["car"].route) == way


def test_buses_go_round_a_jam_by_no_way_that_is_too_narrow_for_them():
    narrow = [":j_1_0"]  # from "a" to "c"
    for kind, way in (("passenger", "acd"), ("bus", "abd")):
        sumo = Sumo(FORK, {"car": Car("a_0", "abd", kind=kind)})
        Drivers(sumo, narrow).step({}, {"b"})
        assert "".join(sumo.cars["car"].route) == way


def test_who_stands_before_full_exits_alone_is_taken_out_before_the_tracks_begin():
    others = {way: Car(f"{way}_0", f"{way}d", at=6.0) for way in "bc"}
    for seconds, spare, left in ((HOPELESS, {"a"}, "bc"), (TIRED, {"a"}, "abc"),
                                    (HOPELESS, set(), "abc")):  # fmt: skip
        sumo = Sumo(FORK, others | {"a": Car("a_0", "abd")})
        drivers = Drivers(sumo, [])
        for waited in (0.0, seconds):
            drivers.step({"a": waited}, spare=spare)
        assert "".join(sorted(sumo.cars)) == left


def test_nobody_turns_into_a_lane_that_ends_where_there_is_another():
    ending = {"a_0": ("b_0", "c_0"), "b_1": ("d_0",), "c_0": ("d_0",)}
    for route, way in (("abd", "acd"), ("ab", "ab")):  # but to arrive there
        sumo = Sumo(ending, {"car": Car("a_0", route)}, changes={("b_0", 1)})
        Drivers(sumo, []).step({})
        assert "".join(sumo.cars["car"].route) == way


def test_who_was_put_into_a_lane_that_ends_is_taken_out_before_the_tracks_begin():
    for spare, left in (({"car"}, 0), (set(), 1)):
        sumo = Sumo({"a_0": (), "a_1": ("b_0",)}, {"car": Car("a_0", "ab")})
        Drivers(sumo, []).step({}, spare=spare)
        assert len(sumo.cars) == left


def test_who_comes_to_an_exit_on_whose_nearer_half_somebody_stands_takes_another():
    for at, speed, way in ((40.0, 0.0, "acd"), (60.0, 0.0, "abd"), (40.0, 9.0, "abd")):
        sumo = Sumo(FORK, {"car": Car("a_0", "abd"), "last": Car("b_0", "bd", at=at, speed=speed)})
        Drivers(sumo, []).step({})
        assert "".join(sumo.cars["car"].route) == way


def test_others_keep_off_an_exit_for_which_somebody_waits_who_has_no_other():
    links = FORK | {"e_0": ("b_0",)}
    sumo = Sumo(links, {"alone": Car("e_0", "ebd"), "last": Car("b_0", "bd", at=6.0)})
    drivers = Drivers(sumo, [])
    for waited in (0.0, TIRED):
        drivers.step({"alone": waited})
    del sumo.cars["last"]
    for sumo.now, way in ((STARVED - 1.0, "acd"), (STARVED + 1.0, "abd")):
        sumo.cars["car"] = Car("a_0", "abd")
        drivers.step({})
        assert "".join(sumo.cars.pop("car").route) == way
        drivers.seen.pop("car")


def test_buses_bound_for_a_place_take_a_tight_corner_rather_than_leave_the_site():
    for bound, way in (([], "ab"), (["bus"], "ac")):
        sumo = Sumo({"a_0": ("b_0", "c_0")}, {"bus": Car("a_0", "ac", kind="bus")})
        Drivers(sumo, [":j_1_0"], bound).step({})
        assert "".join(sumo.cars["bus"].route) == way
