"""Streets are kept as full as asked."""

from made_sumo import Car, Sumo

from cityx.traffic.drivers import AHEAD, Filling


def trips(start, count):
    return [{"id": f"{start}{n}", "type": "car", "route": [start, "d"], "rolling": True,
             "lane": "best"}
            for n in range(count)]  # fmt: skip


def sent(sumo, pending):
    """Who is sent into two streets that want twenty more, while others wait to come in."""
    sumo.cars |= {f"pending{n}": Car("", route, waited=0.0) for n, route in enumerate(pending)}
    sumo.simulation.getPendingVehicles = lambda: tuple(f"pending{n}" for n in range(len(pending)))
    sumo.vehicle.getIDCount = lambda: 0
    names = []
    sumo.route = type("Routes", (), {"add": staticmethod(lambda *_: None)})
    sumo.vehicle.add = lambda name, *_, **__: names.append(name)
    group = {"edges": ["a", "b"], "target": 20, "trips": trips("a", 9) + trips("b", 9)}
    filling = Filling(sumo, [group])
    filling.renew(0)
    return names


def test_who_cannot_come_in_by_one_way_does_not_keep_others_from_another():
    streets = Sumo({"a_0": ("d_0",), "b_0": ("d_0",)}, {})
    assert sent(streets, [("a", "d")] * AHEAD) == [f"b{n}" for n in range(AHEAD)]


def test_as_many_are_sent_by_each_way_as_may_wait_there():
    streets = Sumo({"a_0": ("d_0",), "b_0": ("d_0",)}, {})
    assert sent(streets, []) == [f"{way}{n}" for way in "ab" for n in range(AHEAD)]
