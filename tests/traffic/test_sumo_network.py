"""The network as SUMO has it: our lanes to the millimetre, whatever the streets are like."""

from importlib.util import find_spec

import numpy as np
import pytest
from made_streets import CROSS, EAST, MIDDLE, NORTH, REACH, SOUTH, WEST, city_of

from cityx.errors import InputError, MissingExtra
from cityx.motion.vehicles import halts_of
from cityx.traffic import engine
from cityx.traffic.laying import PASSING, SHORTEST, streets_of
from cityx.traffic.network import make_network
from cityx.traffic.plain import CHANGED, CLOSED
from cityx.traffic.session import street_names

needs_sumo = pytest.mark.skipif(
    find_spec("libsumo") is None, reason='SUMO is not installed: pip install "cityx[traffic]"'
)
pytestmark = [pytest.mark.sumo]


def streets(layout, **options):
    city = city_of(layout, **options)
    return city, streets_of(city, halts_of(city))


def made(layout, folder, **options):
    city, found = streets(layout, **options)
    return found, make_network(found, city.frame, folder, said=street_names(city))


def test_the_kerb_is_at_the_first_lane_on_either_side_of_the_road():
    for left_hand in (False, True):
        _, found = streets(CROSS[:1], left_hand=left_hand)
        assert found.ways
        for way in found.ways:
            assert [lane.kind for lane in way.lanes] == ["walk", "drive"]
            walk, drive = (lane.shape[0, :2] for lane in way.lanes)
            ahead = way.lanes[1].shape[-1, :2] - drive
            to_the_left = np.cross(ahead, walk - drive) > 0
            assert to_the_left == left_hand


def test_short_lanes_belong_to_the_junction():
    jog = [([WEST, MIDDLE, EAST], {}), ([SOUTH, MIDDLE], {}), ([(4, 0), (4, REACH)], {})]
    jog[0] = ([WEST, MIDDLE, (4, 0), EAST], {})
    _, found = streets(jog)
    assert all(way.length >= SHORTEST for way in found.ways)
    junctions = {end for way in found.ways for end in (way.source, way.target)}
    assert len(junctions) == 5  # the four ends, and the two corners as one
    assert len(found.links) == 12  # from each of four arms to the three others


def test_two_cars_pass_each_other_on_a_wide_lane_for_both_ways():
    wide = {"lanes": 1, "lanes_forward": 0, "width": PASSING + 0.4}
    _, (found) = streets([([WEST, EAST], wide)])
    there, back = (way.lanes[-1] for way in found.ways)
    assert not there.narrow
    assert abs(there.shape[0, 1] - back.shape[-1, 1]) == pytest.approx((PASSING + 0.4) / 2)
    _, found = streets([([WEST, EAST], wide | {"width": 3.0})])
    assert all(way.lanes[-1].narrow for way in found.ways)


HOSTILE = {
    "a street that leads back to itself": [([MIDDLE, (90, 40), (90, -40), MIDDLE], {}),
                                           ([WEST, MIDDLE], {})],
    "a road of 64 lanes": [([WEST, MIDDLE, EAST], {"lanes": 64, "lanes_forward": 32, "width": 200}),
                           ([SOUTH, MIDDLE, NORTH], {})],
    "one-way streets that meet head on": [([WEST, MIDDLE], {"oneway": True, "lanes_forward": 2}),
                                          ([EAST, MIDDLE], {"oneway": True, "lanes_forward": 2})],
    "parts that do not hang together": [([WEST, (-60, 0)], {}), ([(60, 0), EAST], {})],
    "twelve arms": [([MIDDLE, (90 * np.cos(a), 90 * np.sin(a))], {})
                    for a in np.arange(12) * np.pi / 6],
    "arms at one degree": [([MIDDLE, (90 * np.cos(a), 90 * np.sin(a))], {})
                           for a in np.radians([0, 1, 2, 180])],
    "streets shorter than they are wide": [
        ([(2.0 * k, 0), (2.0 * k + 2.0, 0)], {"width": 12.0}) for k in range(12)
    ] + [([(2.0 * k, 0), (2.0 * k, 60)], {}) for k in range(0, 12, 3)],
    "left-hand signals": CROSS,
}  # fmt: skip


@pytest.mark.sweep(4)
@needs_sumo
@pytest.mark.parametrize("name", list(HOSTILE))
def test_its_lanes_are_ours(name, tmp_path):
    import sumolib

    options = {"signals": [MIDDLE], "left_hand": True} if name == "left-hand signals" else {}
    found, network = made(HOSTILE[name], tmp_path, **options)
    net = sumolib.net.readNet(str(network.file), withInternal=True)
    assert len(network.lanes) == sum(len(way.lanes) for way in found.ways)
    for lane, (way, index) in network.lanes.items():
        own = found.ways[way].lanes[index]
        assert np.allclose(net.getLane(lane).getShape3D(), own.shape, atol=1e-3)
        assert net.getLane(lane).getWidth() == pytest.approx(own.width, abs=1e-2)
        assert net.getLane(lane).getSpeed() == pytest.approx(
            2.0 if own.kind == "walk" else own.speed, abs=1e-2
        )
    for number, link in enumerate(found.links):
        parts = [net.getLane(lane).getShape3D() for lane, own in network.links.items()
                 if own == number]  # fmt: skip
        assert np.allclose(parts[0][0], link.shape[0], atol=1e-3)
        assert np.allclose(parts[-1][-1], link.shape[-1], atol=1e-3)


@needs_sumo
@pytest.mark.parametrize("left_hand", [False, True])
def test_nobody_changes_lanes_on_a_short_way(left_hand, tmp_path):
    from lxml import etree

    wide = {"lanes": 6, "lanes_forward": 3, "width": 19.5}
    streets = [([WEST, MIDDLE, (50, 0), EAST], wide), ([SOUTH, MIDDLE], {}),
               ([(50, 0), (50, REACH)], {})]  # fmt: skip
    found, network = made(streets, tmp_path, left_hand=left_hand)
    root = etree.parse(network.file).getroot()
    lanes = {lane.get("id"): lane for lane in root.iter("lane")}
    # SUMO tells left from right by the side of the road: towards the middle is to higher numbers.
    inward, outward = ("changeRight", "changeLeft") if left_hand else ("changeLeft", "changeRight")
    short = [way for way in found.ways if way.length < CHANGED and len(way.lanes) == 4]
    assert short
    for way in short:
        bars = [(lanes[f"{way.name}_{k}"].get(inward), lanes[f"{way.name}_{k}"].get(outward))
                for k in range(4)]  # fmt: skip
        assert bars == [(CLOSED, None), (CLOSED, CLOSED), (CLOSED, CLOSED), (None, CLOSED)]


@needs_sumo
def test_the_network_knows_where_on_earth_it_lies(tmp_path):
    import sumolib

    city, found = streets(CROSS)
    network = make_network(found, city.frame, tmp_path)
    longitude, latitude = sumolib.net.readNet(str(network.file)).convertXY2LonLat(100.0, 50.0)
    assert np.allclose(city.frame.to_geographic([[100.0, 50.0]]), [longitude, latitude], atol=1e-7)


@needs_sumo
def test_the_same_streets_give_the_same_bytes(tmp_path):
    files = []
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
        files.append(made(CROSS, tmp_path / name, signals=[MIDDLE])[1].file.read_bytes())
    assert files[0] == files[1]
    assert b"generated on" not in files[0]


@needs_sumo
def test_a_city_without_streets_has_no_traffic(tmp_path):
    city = city_of([([WEST, EAST], {"kind": "footway"})])
    with pytest.raises(InputError, match="no street that anything drives on"):
        make_network(streets_of(city, halts_of(city)), city.frame, tmp_path)


def test_without_sumo_the_extra_is_named(monkeypatch):
    monkeypatch.setattr(engine, "find_spec", lambda _: None)
    with pytest.raises(MissingExtra, match=r'pip install "cityx\[traffic\]"'):
        engine.require_sumo()
