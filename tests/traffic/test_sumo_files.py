"""What people get who run SUMO themselves."""

from dataclasses import replace
from importlib.util import find_spec
from itertools import pairwise

import pytest
from lxml import etree
from made_streets import CROSS, EAST, MIDDLE, WEST, city_of

from cityx.city.tracks import poses_at
from cityx.errors import MissingExtra
from cityx.motion.traffic import traffic
from cityx.motion.vehicles import halts_of
from cityx.options import BuildOptions
from cityx.projects import build as building
from cityx.traffic import engine
from cityx.traffic.engine import run_program
from cityx.traffic.files import CONFIG, FILES, write_sumo

pytestmark = [pytest.mark.sumo]
needs_sumo = pytest.mark.skipif(
    find_spec("libsumo") is None, reason='SUMO is not installed: pip install "cityx[traffic]"'
)


@needs_sumo
def test_sumo_runs_the_files_with_the_vehicles_of_the_tracks(tmp_path):
    city = traffic(city_of(CROSS, signals=[MIDDLE]), density="medium", duration=20.0)
    write_sumo(city, halts_of(city), tmp_path / "a")
    write_sumo(city, halts_of(city), tmp_path / "b")
    for name in FILES:
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()
    args = ["-c", CONFIG, "--tripinfo-output", "trips.xml", "--tripinfo-output.write-unfinished",
            "--no-step-log"]  # fmt: skip
    said = run_program("sumo", args, tmp_path / "a", timeout_s=60.0)
    assert not [line for line in said if line.startswith("Error")]
    there = len(poses_at(city.tracks, 0.0).row)
    assert (tmp_path / "a" / "trips.xml").read_text().count("<tripinfo ") >= there


@needs_sumo
def test_a_city_without_tracks_gives_a_network_without_vehicles(tmp_path):
    city = city_of(CROSS)
    write_sumo(city, halts_of(city), tmp_path)
    assert "<vehicle" not in (tmp_path / "city.rou.xml").read_text()
    run_program("sumo", ["-c", CONFIG, "--no-step-log"], tmp_path, timeout_s=60.0)


ALONG = [([WEST, EAST], {})]
BARE_STREET = {"sidewalk_left": 0.0, "sidewalk_right": 0.0}
PATH = {"kind": "footway", "width": 2.0, "lanes": 1, **BARE_STREET}


def crossed(city, folder):
    """Send a person over each crossing of SUMO; return all crossings, and those walked over."""
    write_sumo(city, halts_of(city), folder)
    root = etree.parse(folder / "city.net.xml").getroot()
    edges = {edge.get("id"): edge for edge in root.iter("edge")}
    beside = {}
    for one in root.iter("connection"):
        for a, b in (("from", "to"), ("to", "from")):
            beside.setdefault(one.get(a), set()).add(one.get(b))

    def walks(area):
        return sorted(
            name
            for name in beside.get(area, ())
            if not name.startswith(":")
            and any("pedestrian" in lane.get("allow") for lane in edges[name])
        )

    crossings = [name for name, edge in edges.items() if edge.get("function") == "crossing"]
    people = []
    for name in crossings:
        junction = name[1:].rpartition("_c")[0]
        ends = [walks(area)[0] for area in sorted(beside[name])]
        near = ["-2" if edges[end].get("to") == junction else "2" for end in ends]
        people.append(
            f'<person id="{name}" depart="0" departPos="{near[0]}">'
            f'<walk from="{ends[0]}" to="{ends[1]}" arrivalPos="{near[1]}"/></person>'
        )
    (folder / "people.rou.xml").write_text(f"<routes>{''.join(people)}</routes>")
    args = ["-n", "city.net.xml", "-r", "people.rou.xml", "--fcd-output", "seen.xml", "-e", "400",
            "--no-step-log"]  # fmt: skip
    run_program("sumo", args, folder, timeout_s=60.0)
    seen = {one.get("edge") for one in etree.parse(folder / "seen.xml").iter("person")}
    return crossings, sorted(seen.intersection(crossings)), root


@needs_sumo
@pytest.mark.parametrize(
    ("tags", "kind", "first"),
    [({"crossing": "zebra"}, "priority", "M"), ({"crossing": "unmarked"}, "priority", "m"),
     ({"crossing": "traffic_signals"}, "traffic_light", None),
     ({"crossing": "marked", "crossing:island": "yes"}, "priority", "M")],
)  # fmt: skip
def test_people_cross_between_junctions(tmp_path, tags, kind, first):
    city = city_of(ALONG, crossings=[((20, 0), tags)])
    found, walked, root = crossed(city, tmp_path)
    assert len(found) == 1
    assert walked == found
    junction = found[0][1:].rpartition("_c")[0]
    node = next(one for one in root.iter("junction") if one.get("id") == junction)
    assert node.get("type") == kind
    x, y = map(float, (node.get("x"), node.get("y")))
    assert abs(x - 20) < 1.0
    assert abs(y) < 1.0
    if first:  # who goes first, in the letters of SUMO
        state = next(
            one.get("state") for one in root.iter("connection") if one.get("to") == found[0]
        )
        assert state == first


@needs_sumo
def test_nobody_crosses_where_the_map_says_no(tmp_path):
    paths = [([(-40, -30), (-40, 0), (-40, 30)], PATH)]
    city = city_of(ALONG + paths, crossings=[((-40, 0), {"crossing": "no"})])
    assert crossed(city, tmp_path)[0] == []


@needs_sumo
@pytest.mark.parametrize("tags", [None, {"crossing": "unmarked"}, {"crossing": "zebra"}])
def test_footways_lead_over_streets_without_walks(tmp_path, tags):
    streets = [([WEST, EAST], BARE_STREET), ([(30, -40), (30, 0), (30, 40)], PATH)]
    city = city_of(streets, crossings=[((30, 0), tags)] if tags else [])
    found, walked, _ = crossed(city, tmp_path)
    assert len(found) == 1
    assert walked == found


@needs_sumo
def test_a_one_way_street_with_walks_on_both_sides_is_crossed(tmp_path):
    oneway = {"oneway": True, "lanes": 1, "lanes_forward": 1}
    found, walked, _ = crossed(
        city_of([([WEST, EAST], oneway)], crossings=[((20, 0), {"crossing": "zebra"})]), tmp_path
    )
    assert len(found) == 1
    assert walked == found


@needs_sumo
def test_several_crossings_of_one_street_keep_the_vehicles_on_their_way(tmp_path):
    plain = traffic(city_of(CROSS), density="medium", duration=20.0)
    tags = {"crossing": "zebra"}
    points = city_of(CROSS, crossings=[((x, 0), tags) for x in (-90, -50, 50)]).layout.points
    city = replace(plain, layout=replace(plain.layout, points=points))
    found, walked, root = crossed(city, tmp_path)
    assert len(found) == 3
    assert walked == found
    names = {edge.get("id") for edge in root.iter("edge")}
    routes = [
        one.get("edges").split() for one in etree.parse(tmp_path / "city.rou.xml").iter("route")
    ]
    assert routes
    assert {name for route in routes for name in route} <= names
    linked = {(one.get("from"), one.get("to")) for one in root.iter("connection")}
    assert all(pair in linked for route in routes for pair in pairwise(route))


def test_a_build_that_needs_sumo_names_the_extra_before_it_begins(monkeypatch, tmp_path):
    monkeypatch.setattr(engine, "find_spec", lambda _: None)
    with pytest.raises(MissingExtra, match=r"cityx\[traffic\]"):
        building.build([], tmp_path / "out", BuildOptions(formats=("sumo",), text="a town"))
    assert not (tmp_path / "out").exists()
