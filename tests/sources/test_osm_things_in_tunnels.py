"""Things that are nodes of a way in a tunnel stand at its level, beside it."""

import pytest

import cityx


def tunnels(drawing):
    """Draw three tunnels with a thing in each, one that is not built, and a bench in the open."""
    drawing.box(-120, 60, 10, 10, building="house")
    for y, kind, tags in [
        (0, "primary", {"highway": "traffic_signals"}),
        (40, "secondary", {"highway": "bus_stop"}),
        (80, "footway", {"amenity": "bench"}),
    ]:
        drawing.node(0, y, **tags)
        drawing.way([(-180, y), (-90, y)], highway=kind)
        drawing.way([(-90, y), (0, y), (90, y)], highway=kind, tunnel="yes", layer="-1")
        drawing.way([(90, y), (180, y)], highway=kind)
    drawing.node(-140, 50, amenity="bench")
    drawing.node(0, -40, highway="give_way")
    drawing.way([(-60, -40), (0, -40), (60, -40)], highway="service", tunnel="yes", layer="-1")
    drawing.way([(-60, -40), (-180, 0)], highway="service")
    return drawing.file()


def test_things_stand_at_the_level_of_their_tunnel(drawing):
    city = cityx.build(tunnels(drawing), lod=2).city
    rows = city.scene.instances["street_furniture"]
    names = [city.scene.prototypes[index].name for index in rows.prototype.tolist()]
    for word in ("traffic_signal", "bus", "bench"):
        own = [place for name, place in zip(names, rows.position, strict=True)
               if name.startswith(word)]  # fmt: skip
        low = min(own, key=lambda place: place[2])
        floor = city.heights.z_at(low[None, :2])[0]
        assert floor < -2.5
        assert low[2] == pytest.approx(floor, abs=0.3)
    assert max(place[2] for place in own) > -0.5  # the bench in the open
    named = [failure.error for failure in city.failures]
    assert sum("of a tunnel that is not built" in text for text in named) == 1


@pytest.mark.parametrize("place", ["GB", "US", "DE"])
@pytest.mark.parametrize("off", [0, 4, 9])
def test_signals_of_a_junction_over_a_tunnel_stand_on_the_ground(drawing, place, off):
    drawing.node(0, 0, highway="traffic_signals")
    drawing.box(-60, 60, 10, 10, building="house")
    drawing.way([(-90, 0), (0, 0), (90, 0)], highway="secondary")
    drawing.way([(0, -90), (0, 0), (0, 90)], highway="secondary")
    drawing.way([(-200, off), (-140, off)], highway="primary")
    drawing.way([(-140, off), (140, off)], highway="primary", tunnel="yes", layer="-1")
    drawing.way([(140, off), (200, off)], highway="primary")
    city = cityx.build(drawing.file(), lod=2, place_profile=place).city
    rows = city.scene.instances["street_furniture"]
    names = [city.scene.prototypes[index].name for index in rows.prototype.tolist()]
    signals = [place for name, place in zip(names, rows.position, strict=True)
               if name.startswith("traffic_signal")]  # fmt: skip
    assert len(signals) >= 4
    assert min(place[2] for place in signals) > -0.5
    assert not city.failures


@pytest.mark.parametrize("kind", ["tram_stop", "traffic_signals", "bus_stop"])
def test_a_thing_in_a_tunnel_hinders_no_street_above_it(drawing, kind):
    rails = kind == "tram_stop"
    way = {"railway": "tram"} if rails else {"highway": "primary"}
    drawing.node(0, 0, **({"railway": kind} if rails else {"highway": kind}))
    drawing.box(-60, 60, 10, 10, building="house")
    drawing.way([(-200, 0), (-140, 0)], **way)
    drawing.way([(-140, 0), (0, 0), (140, 0)], tunnel="yes", layer="-1", **way)
    drawing.way([(140, 0), (200, 0)], **way)
    drawing.way([(-2, -90), (-2, 90)], highway="residential")
    drawing.way([(3, -90), (3, 90)], highway="residential")
    built = cityx.build(drawing.file(), lod=2)
    assert built.report["checks"]["furniture_in_lanes"]["ok"]
