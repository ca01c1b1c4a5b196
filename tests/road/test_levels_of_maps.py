"""Small maps of tunnels and layers, from the file to checks of what stands."""

from dataclasses import replace

import numpy as np
import pytest

from cityx.checks.height_checks import check_heights
from cityx.checks.street_checks import bare_places
from cityx.city.ground import ON_ROADWAY, ROADWAY
from cityx.road.ground.ground_surface import ground
from cityx.road.heights.crossings import find_crossings
from cityx.road.heights.way_heights import _across, _overlapping, heights
from cityx.road.network.network import network, road_network
from cityx.road.network.stations import collect_ways
from cityx.sources.osm import read_osm

LAT, LON = 47.0, 8.0
METRE = 1 / 111_200.0  # degrees of latitude
STREET, MAIN = "highway=residential", "highway=primary;lanes=2"
TUNNEL, BRIDGE = "tunnel=yes;layer=-1", "bridge=yes;layer=1"

MAPS = {
    "interchange": [
        ([(-300, 0), (-40, 0)], MAIN), ([(-40, 0), (40, 0)], f"{MAIN};tunnel=yes;layer=-1"),
        ([(40, 0), (300, 0)], MAIN), ([(0, -300), (0, 300)], STREET),
        ([(-300, -80), (-30, -30)], STREET),
        ([(-30, -30), (30, 30)], f"{STREET};bridge=yes;layer=2"),
        ([(30, 30), (300, 80)], STREET),
    ],
    "foot underpass": [
        ([(-300, 0), (300, 0)], STREET), ([(0, -200), (0, -20)], "highway=footway"),
        ([(0, -20), (0, 20)], "highway=footway;layer=-1"), ([(0, 20), (0, 200)], "highway=footway"),
    ],
    "street cutting without a tunnel": [
        ([(-300, 0), (-50, 0)], STREET), ([(-50, 0), (50, 0)], f"{STREET};layer=-1"),
        ([(50, 0), (300, 0)], STREET), ([(0, -300), (0, 300)], STREET),
    ],
    "gallery": [
        ([(-300, 0), (-60, 0)], STREET), ([(-60, 0), (60, 0)], f"{STREET};covered=yes"),
        ([(60, 0), (300, 0)], STREET), ([(-300, 30), (300, 30)], STREET),
    ],
    "tunnel cut by the border": [
        ([(-300, 0), (0, 0)], STREET), ([(0, 0), (300, 0)], f"{STREET};{TUNNEL}"),
        ([(150, -300), (150, 300)], STREET),
    ],
    "two tunnels that cross": [
        ([(-300, 0), (-150, 0)], STREET), ([(-150, 0), (150, 0)], f"{STREET};{TUNNEL}"),
        ([(150, 0), (300, 0)], STREET), ([(0, -300), (0, -200)], STREET),
        ([(0, -200), (0, 200)], f"{STREET};tunnel=yes;layer=-2"), ([(0, 200), (0, 300)], STREET),
    ],
    # A street dives beside the foot of a viaduct, and passes under what that goes on as.
    "tunnel beside the foot of a viaduct": [
        ([(-600, 5), (-400, 5)], f"{MAIN};oneway=yes"),
        ([(-400, 5), (-130, 3)], f"{MAIN};{BRIDGE};oneway=yes"),
        ([(-130, 3), (300, 0)], f"{MAIN};oneway=yes"),
        ([(-160, -200), (-160, 14), (-160, 200)], STREET),
        ([(-400, 60), (-160, 14), (-110, 4)], f"{STREET};oneway=yes"),
        ([(-110, 4), (60, -45)], f"{STREET};{TUNNEL};oneway=yes"),
        ([(60, -45), (300, -60)], f"{STREET};oneway=yes"),
    ],
    "bridge over a tunnel mouth": [
        ([(-300, 0), (-5, 0)], STREET), ([(-5, 0), (120, 0)], f"{STREET};{TUNNEL}"),
        ([(120, 0), (300, 0)], STREET), ([(0, -300), (0, -40)], STREET),
        ([(0, -40), (0, 40)], f"{STREET};{BRIDGE}"), ([(0, 40), (0, 300)], STREET),
    ],
}  # fmt: skip


# Streets that part at one node, turn away, and come near again: the lower passes below the upper.
PARTED = {
    "bend": ([(0, 0), (30, 8), (60, 3), (70, 2)], [(0, 0), (30, -8), (60, 0), (74, -6)]),
    "bow": ([(0, 0), (25, 0), (50, 0), (72, 0)], [(0, 0), (20, 8), (40, 20), (60, 8), (70, 3)]),
    "turned": ([(0, 0), (-8, 28), (3, 55), (3, 72)], [(0, 0), (7, 30), (0, 56), (-3, 70)]),
}
# A junction on the ground, of which one arm dives at once, and a tunnel deep below it.
OVER = {
    "straight": [(-60, 25), (0, -3), (60, -25)],
    "square": [(4, 60), (4, 0), (4, -60)],
    "along": [(-60, 4), (20, 4), (80, 40)],
}


def written(path, ways):
    """Write ways, points in metres and tags, as a map; points at one place are one node."""
    wide = METRE / np.cos(np.radians(LAT))
    number: dict[tuple[float, float], int] = {}
    for line, _ in ways:
        for point in line:
            number.setdefault(point, len(number) + 1)
    nodes = [f'<node id="{k}" version="1" lat="{LAT + y * METRE:.8f}" lon="{LON + x * wide:.8f}"/>'
             for (x, y), k in number.items()]  # fmt: skip
    rows = []
    for k, (line, tags) in enumerate(ways, 1):
        refs = "".join(f'<nd ref="{number[point]}"/>' for point in line)
        pairs = (tag.split("=") for tag in tags.split(";"))
        marks = "".join(f'<tag k="{key}" v="{value}"/>' for key, value in pairs)
        rows.append(f'<way id="{k}" version="1">{refs}{marks}</way>')
    path.write_text(f'<osm version="0.6">{"".join(nodes + rows)}</osm>')
    return path


@pytest.mark.parametrize("name", MAPS)
def test_a_map_of_levels_keeps_every_check_of_heights(tmp_path, name):
    city = read_osm(written(tmp_path / "map.osm", MAPS[name]))
    city = ground(heights(network(city)))
    checks = check_heights(city)
    assert [check.name for check in checks if not check.ok] == []
    assert not len(bare_places(city))
    off = np.abs(city.network.lift).max()
    assert off < 0.1 if name in ("gallery", "foot underpass") else off > 4.0


def test_a_street_on_its_way_below_another_does_not_share_its_surface(tmp_path):
    name = "tunnel beside the foot of a viaduct"
    layout = read_osm(written(tmp_path / "map.osm", MAPS[name])).layout
    ways = collect_ways(layout, road_network(layout, left_hand=False), everywhere=False)
    source = layout.roads["source"].to_numpy()[ways.road]
    crossing = find_crossings(ways)
    foot, dive, below = (np.flatnonzero(source == f"osm/way/{k}") for k in (3, 5, 6))
    assert np.isin(crossing.upper, foot)[np.isin(crossing.lower, below)].any()
    pairs = ways.owner[_overlapping(ways, crossing)[0]]
    assert not (np.isin(pairs, foot).any(axis=1) & np.isin(pairs, dive).any(axis=1)).any()
    alone = crossing.take(np.zeros(len(crossing.upper), bool))
    pairs = ways.owner[_overlapping(ways, alone)[0]]
    assert (np.isin(pairs, foot).any(axis=1) & np.isin(pairs, dive).any(axis=1)).any()


@pytest.mark.parametrize("form", PARTED)
def test_streets_that_come_near_again_once_apart_have_heights_of_their_own(tmp_path, form):
    upper, lower = PARTED[form]
    streets = [([(-90, -9), (0, 0)], STREET), (upper, f"{STREET};tunnel=yes;layer=-1"),
               (lower, f"{STREET};tunnel=yes;layer=-2")]  # fmt: skip
    layout = read_osm(written(tmp_path / "map.osm", streets)).layout
    ways = collect_ways(layout, road_network(layout, left_hand=False), everywhere=False)
    pairs = _across(ways)[0]
    two = np.isin(layout.roads["source"].to_numpy()[ways.road], ["osm/way/2", "osm/way/3"])
    pairs = pairs[two[ways.owner[pairs]].all(axis=1), 0]
    start = ways.lines.points[ways.lines.start[np.flatnonzero(two)[0]]]
    far = np.hypot(*(ways.lines.points[pairs] - start).T)
    assert len(far)
    assert far.max() < 30.0


@pytest.mark.parametrize("form", OVER)
def test_a_junction_over_a_tunnel_opens_the_ground_for_its_surface(tmp_path, form):
    streets = [
        ([(-150, 0), (0, 0)], MAIN), ([(0, 0), (20, 12)], STREET), ([(0, 0), (22, -8)], STREET),
        ([(22, -8), (150, -30)], STREET), ([(20, 12), (35, 21), (60, 40)], f"{STREET};layer=-1"),
        ([(60, 40), (120, 80)], f"{STREET};{TUNNEL}"),
        (OVER[form], f"{STREET};tunnel=yes;layer=-3"),
    ]  # fmt: skip
    city = ground(heights(network(read_osm(written(tmp_path / "map.osm", streets)))))
    steps = np.arange(1.0, 14.0, 2.0)[:, None]
    node = city.network.node_position[np.argmax(city.network.node_degree >= 3)]
    arms = [node + steps * way for way in ((-1.0, 0.0), (0.857, 0.514), (0.94, -0.342))]
    assert city.ground.on(np.concatenate(arms), *ROADWAY, *ON_ROADWAY, "void").all()


@pytest.mark.parametrize(
    ("kind", "line"),
    [("highway=footway", [(0, -60), (0, 60)]), ("highway=cycleway", [(-20, -60), (20, 60)]),
     ("highway=path", [(9, -50), (4, 0), (9, 50)])],
)  # fmt: skip
def test_a_path_too_low_over_a_carriageway_is_named(tmp_path, kind, line):
    streets = [([(-200, 0), (200, 0)], MAIN), (line, f"{kind};{BRIDGE}"),
               ([(0, -200), line[0]], kind), ([line[-1], (0, 200)], kind)]  # fmt: skip
    city = heights(network(read_osm(written(tmp_path / "map.osm", streets))))
    assert not [note for note in ground(city).notes if "left out" in note]
    low = replace(city.heights, z=city.heights.z - 3.5)
    (note,) = [note for note in ground(replace(city, heights=low)).notes if "left out" in note]
    assert "osm/way/2" in note


@pytest.mark.parametrize("banks", [(8, 16, 0), (6, 22, 0), (9, 13, 5)])
def test_a_low_bridge_over_a_stream_opens_both_banks_for_its_surface(tmp_path, banks):
    low, high, skew = banks
    stream = [(low, -60), (high, -60), (high + skew, 60), (low + skew, 60), (low, -60)]
    streets = [
        ([(-120, 0), (0, 0)], STREET), ([(0, 0), (0, 90)], STREET),
        ([(0, 0), (27, 0)], f"{STREET};{BRIDGE}"), ([(27, 0), (120, 0)], STREET),
        (stream, "natural=water"),
    ]  # fmt: skip
    city = read_osm(written(tmp_path / "map.osm", streets))
    city = ground(heights(network(replace(city, lod=0))))
    node = city.network.node_position[np.argmax(city.network.node_degree >= 3)]
    along = node + np.arange(-6.0, 33.0, 1.0)[:, None] * np.array([1.0, 0.0])
    assert city.ground.on(along, *ROADWAY, "void", "water").all()
    assert not len(bare_places(city))
