"""Hostile and broken maps through the command line: a checked city, or one sentence and code 2."""

import bz2
import gzip
import json
import sys
import tracemalloc
from io import BytesIO

import numpy as np
import pytest
from PIL import Image
from town import Town

from cityx.cli.main import main
from cityx.sources.osm import reader

QUICK = ("--no-render", "--formats", "glb", "--lod", "2")
OSM = b'<osm version="0.6">'


def run(monkeypatch, capsys, path, out, *more):
    words = ["cityx", "build", path, "-o", out, *QUICK, *more]
    monkeypatch.setattr(sys, "argv", [str(word) for word in words])
    try:
        main()
        code = 0
    except SystemExit as stop:
        code = stop.code or 0
    return code, capsys.readouterr()


def plain():
    """One street with two houses: what every odd map here also holds."""
    town = Town()
    town.way([town.node(-40, 0), town.node(0, 1), town.node(40, 0)], highway="residential")
    town.box(-30, 8, 12, 10, building="house", building__levels="2")
    town.box(5, 8, 12, 10, building="apartments", roof__shape="hipped")
    return town


def xml(town):
    return (OSM + "".join(town.elements).encode() + b"</osm>").replace(b"\n", b" ")


def jpeg():
    target = BytesIO()
    Image.fromarray(np.zeros((32, 32, 3), np.uint8)).save(target, "JPEG")
    return target.getvalue()


BOMB = (
    b'<?xml version="1.0"?><!DOCTYPE osm [<!ENTITY a0 "ha">'
    + b"".join(b'<!ENTITY a%d "%s">' % (i, b"&a%d;" % (i - 1) * 10) for i in range(1, 10))
    + b'<!ENTITY x "">]><osm>&a9;</osm>'
)
EXTERNAL = (
    b'<!DOCTYPE osm [<!ENTITY secret SYSTEM "file:///etc/passwd">]>'
    b'<osm><node id="1" lat="1" lon="1"><tag k="name" v="a"/></node>&secret;</osm>'
)
NOISE = np.random.default_rng(3).integers(0, 256, 5000, np.uint8).tobytes()
FILES = {
    "bomb.osm": BOMB,
    "bomb.osm.gz": gzip.compress(BOMB),
    "external.osm": EXTERNAL,
    "doctype.osm": b'<!DOCTYPE osm SYSTEM "http://localhost/osm.dtd">' + xml(plain()),
    "parameter.osm": b'<!DOCTYPE osm [<!ENTITY % p SYSTEM "file:///etc/passwd"> %p;]><osm/>',
    "undefined.osm": OSM + b"&nbsp;</osm>",
    "cut.osm.gz": gzip.compress(xml(plain()))[:-40],
    "head.osm.gz": gzip.compress(xml(plain()))[:9],
    "cut.osm.bz2": bz2.compress(xml(plain()))[:-20],
    "damaged.osm.gz": gzip.compress(xml(plain()))[:60] + bytes(200),
    "cut.osm": xml(plain())[:-300],
    "empty.osm": b"",
    "empty.osm.pbf": b"",
    "space.osm": b" \n \t ",
    "byte.osm": b"<",
    "byte.osm.gz": b"\x1f",
    "noise.osm": NOISE,
    "noise.osm.gz": NOISE,
    "noise.osm.bz2": NOISE,
    "noise.osm.pbf": NOISE,
    "noise.pbf": NOISE,
    "headed.osm.pbf": b"\x00\x00\x00\x0d\x0a\x09OSMHeader\x18\x7c" + NOISE,
    "huge_block.osm.pbf": b"\x7f\xff\xff\xff\x0a\x09OSMHeader\x18\x7c" + NOISE,
    "magic.osm.gz": b"\x1f\x8b" + NOISE,
    "magic.osm.bz2": b"BZh9" + NOISE,
    "photo.osm": jpeg(),
    "photo.osm.gz": jpeg(),
    "nulls.osm": bytes(4096),
    "no_root.osm": b"hello world",
    "html.osm": b"<!DOCTYPE html><html><body>429 Too Many Requests</body></html>",
    "two_roots.osm": b"<osm/><osm/>",
    "no_elements.osm": OSM + b"</osm>",
    "encoding.osm": b'<?xml version="1.0" encoding="martian"?><osm/>',
    "latin.osm": b'<?xml version="1.0" encoding="utf-8"?><osm><note>\xff\xfe</note></osm>',
    "only_nodes.osm": OSM + b'<node id="1" lat="1" lon="1"/></osm>',
    "only_ghosts.osm": OSM + b'<way id="1"><nd ref="2"/><nd ref="3"/>'
    b'<tag k="building" v="yes"/></way></osm>',
    "itself.osm": OSM + b'<way id="7"><nd ref="7"/><nd ref="7"/><nd ref="7"/><nd ref="7"/>'
    b'<tag k="building" v="yes"/></way></osm>',
}  # fmt: skip


@pytest.mark.parametrize("name", FILES)
def test_what_is_no_map_ends_with_one_sentence(monkeypatch, capsys, tmp_path, name):
    path = tmp_path / name
    path.write_bytes(FILES[name])
    code, said = run(monkeypatch, capsys, path, tmp_path / "out")
    refused(code, said, tmp_path, name)


def refused(code, said, folder, name):
    assert code == 2, said.err
    (line,) = [line for line in said.err.splitlines() if line.startswith("error: ")]
    assert said.err.endswith(line + "\n")
    assert name in line
    assert line.endswith(".")
    assert "root:" not in said.err + said.out  # of /etc/passwd
    assert [entry.name for entry in folder.iterdir()] == [name]


@pytest.mark.parametrize(("suffix", "pack"), [(".gz", gzip.compress), (".bz2", bz2.compress)])
def test_a_packed_bomb_is_refused_in_bounded_memory(monkeypatch, capsys, tmp_path, suffix, pack):
    monkeypatch.setattr(reader, "RATIO_FREE", 8 << 20)
    path = tmp_path / f"bomb.osm{suffix}"
    path.write_bytes(pack(OSM + b" " * (40 << 20)))
    assert path.stat().st_size < 100_000
    tracemalloc.start()
    code, said = run(monkeypatch, capsys, path, tmp_path / "out")
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    refused(code, said, tmp_path, path.name)
    assert peak < 16e6


def node(**given):
    return "<node " + " ".join(f'{key}="{value}"' for key, value in given.items()) + "/>"


def way(key, refs, **tags):
    inner = "".join(f'<nd ref="{ref}"/>' for ref in refs)
    inner += "".join(f'<tag k="{k.replace("__", ":")}" v="{v}"/>' for k, v in tags.items())
    return f'<way id="{key}">{inner}</way>'


def relation(key, members, **tags):
    inner = "".join(f'<member type="{t}" ref="{r}" role="{role}"/>' for t, r, role in members)
    inner += "".join(f'<tag k="{k}" v="{v}"/>' for k, v in tags.items())
    return f'<relation id="{key}">{inner}</relation>'


def with_elements(*elements):
    town = plain()
    town.elements += elements
    return town


def with_boxes(houses):
    town = plain()
    for index, tags in enumerate(houses):
        town.box(
            -80 + 20 * (index % 6), -24 - 20 * (index // 6), 12, 9, **{"building": "yes", **tags}
        )
    return town


def with_rings(*rings):
    """Add houses, 20 m apart, through points that may repeat or cross."""
    town = plain()
    for index, ring in enumerate(rings):
        nodes = [town.node(x - 60 + 20 * index, y - 30) for x, y in ring]
        town.way([*nodes, nodes[0]], building="yes")
    return town


def many_cornered():
    angle = np.arange(5000) * 2 * np.pi / 5000
    radius = 12 + 0.5 * np.sin(40 * angle)
    return zip(radius * np.cos(angle), radius * np.sin(angle) - 24, strict=True)


def twice(**tags):
    town = plain()
    for _ in range(2):
        town.box(-8, -22, 12, 9, building="yes", **tags)
    return town


def with_streets(streets, *lines):
    """Add a street per set of tags, 20 m apart, along a line of its own or a straight one."""
    town = plain()
    for index, tags in enumerate(streets):
        line = lines[index] if lines else ((0, 0), (80, 0))
        nodes = [town.node(x - 40, y - 30 - 20 * index) for x, y in line]
        town.way(nodes, **{"highway": "residential", **tags})
    return town


def far_town():
    """Make as many houses again, 30 degrees away."""
    for i in range(3):
        low, high = 30 + i * 1e-3, 30 + i * 1e-3 + 1e-4
        keys = [3000 + 4 * i + k for k in range(4)]
        corners = ((low, 5), (low, 5.0001), (high, 5.0001), (high, 5))
        yield from (node(id=k, lat=a, lon=b) for k, (a, b) in zip(keys, corners, strict=True))
        yield way(3100 + i, [*keys, keys[0]], building="yes")


PLACES = [("nan", "1"), ("inf", "1"), ("91", "1"), ("1", "181"), ("-1e308", "1e308"), ("", "")]
BAD_NODES = [node(id=900 + i, lat=lat, lon=lon) for i, (lat, lon) in enumerate(PLACES)]
HOUSES = [
    {"building__levels": "1e9"},
    {"height": "nan"},
    {"height": "1e999", "min_height": "-inf"},
    {"height": "-5", "building__levels": "-3"},
    {"height": "6", "min_height": "40"},
    {"height": "6", "min_height": "-20"},
    {"building__levels": "2", "building__min_level": "90"},
    {"height": "5", "roof__height": "500", "roof__shape": "dome", "roof__levels": "-7"},
    {
        "building__levels": "0",
        "roof__angle": "1e5",
        "roof__direction": "NaN",
        "name": "' OR 1=1; --",
    },
    {"building": "\U0001f3e0" * 200, "height": "12 parsecs", "roof__shape": "\x7f"},
    {"building__colour": "#", "roof__colour": "#gggggg", "building__material": "../../etc/passwd"},
    {"name": "x" * 1_000_000, "building__levels": "\u0663"},
    {"height": "9" * 1_000_000, "building__levels": "1" * 400},
]
ROADS = [
    {"lanes": "1000000"},
    {"width": "1e8", "layer": "1e99"},
    {"lanes": "nan", "maxspeed": "-inf", "oneway": "?"},
    {"lanes": "-4", "width": "nan", "bridge": "yes", "layer": "-99999999999999999999"},
    {"lanes__forward": "1e300", "sidewalk": "\x7f", "tunnel": "inf", "lanes": "0"},
]
BAD_IDS = [2**63, -(2**63) - 1, 2**64, 10**40, "x", "", "1.5"]
TOWNS = {
    "positions_that_are_none": lambda: with_elements(
        *BAD_NODES, way(950, range(900, 906), highway="residential"),
        way(951, [900, 901, 902, 900], building="yes"),
    ),
    "ids_beyond_64_bit": lambda: with_elements(
        *(node(id=key, lat="60.17", lon="24.94") for key in BAD_IDS),
        *(way(key, [1, 2, 3], highway="residential") for key in BAD_IDS),
        *(relation(key, [("way", key, "outer")], type="multipolygon") for key in BAD_IDS),
        way(960, BAD_IDS, highway="residential"), way(961, [2**63, 1, 2**63], building="yes"),
    ),
    "ways_of_themselves_and_of_nothing": lambda: with_elements(
        way(970, [970, 970, 970, 970], building="yes"), way(971, [], highway="residential"),
        way(972, [1], highway="residential"), way(973, [1, 1, 1], highway="residential"),
        way(974, [1, 99999, 2, 99998, 3], highway="residential"), way(975, [1, 2], building="yes"),
    ),
    "relations_in_a_circle": lambda: with_elements(
        relation(980, [("relation", 981, "outer")], type="multipolygon", building="yes"),
        relation(981, [("relation", 980, "outer"), ("relation", 981, "")], type="building"),
        relation(982, [("relation", 982, "outline"), ("way", 982, "outer")], type="multipolygon"),
        relation(983, [], type="multipolygon", building="yes"),
        relation(984, [("way", 4, "inner")] * 50, type="multipolygon", building="yes"),
        relation(985, [("moon", 4, "outer"), ("node", 1, "outer")], type="multipolygon"),
    ),
    "tags_of_houses_that_make_no_sense": lambda: with_boxes(HOUSES),
    "tags_of_roads_that_make_no_sense": lambda: with_streets(ROADS),
    "roads_that_lead_nowhere": lambda: with_streets(
        [{}] * 4, ((0, 0), (40, 0), (40, 0), (80, 0)), ((0, 0), (0, 0)),
        ((0, 0), (80, 0), (0, 0)), ((0, 0), (80, 9), (80, 0), (0, 9)),
    ),
    "a_road_to_the_other_side_of_the_earth": lambda: with_elements(
        node(id=990, lat="-60.17", lon="-155.06"), node(id=991, lat="89.9999", lon="24"),
        way(992, [1, 990, 991, 2], highway="motorway"),
    ),
    "a_house_of_5000_corners": lambda: with_rings(many_cornered()),
    "rings_that_are_no_outlines": lambda: with_rings(
        ((0, 0), (14, 14), (14, 0), (0, 14)),  # a bow tie
        ((0, 0), (5, 0), (14, 0), (5, 0)),  # no area
        ((0, 0), (0, 0), (0, 0), (0, 0)),  # one point
        ((0, 0), (14, 0), (14, 0.001), (0, 0.001)),  # a hair
        ((0, 0), (7, 0), (7, -16), (7, 0), (14, 0), (14, 14)),  # a spike
        ((0, 0), (9, 9), (0, 9), (9, 0), (4, 14), (4, -5)),  # a tangle
    ),
    "two_equal_houses": twice,
    "two_equal_houses_of_other_height": lambda: twice(height="30"),
    "a_house_around_the_street": lambda: with_rings(((0, 0), (120, 0), (120, 60), (0, 60))),
    "a_house_of_the_size_of_a_country": lambda: with_elements(
        node(id=1, lat="50", lon="10"), node(id=2001, lat="61", lon="10"),
        node(id=2002, lat="61", lon="30"), way(2003, [1, 2001, 2002, 1], building="yes"),
    ),
    "a_town_on_either_side_of_the_earth": lambda: with_elements(*far_town()),
    "a_forest_of_the_size_of_a_country": lambda: with_elements(
        *(node(id=2010 + i, lat=60 + i // 2, lon=24 + (i in (1, 2))) for i in range(4)),
        way(2015, [2010, 2011, 2012, 2013, 2010], natural="wood"),
    ),
    "tags_nested_a_thousand_deep": lambda: with_elements("<a>" * 1000 + "</a>" * 1000),
    "an_element_of_another_kind": lambda: with_elements(
        '<node id="1"><way id="2"><nd/></way></node>', '<osm><tag k="a" v="b"/></osm>'
    ),
}  # fmt: skip


@pytest.mark.sweep(6)
@pytest.mark.parametrize("name", TOWNS)
def test_odd_things_in_a_map_keep_every_check(monkeypatch, capsys, tmp_path, name):
    report = built(monkeypatch, capsys, tmp_path, TOWNS[name]())
    assert report["counts"]["buildings"] >= 2
    assert report["area_km2"] < 0.1


def built(monkeypatch, capsys, folder, town):
    path = town.write(folder / "odd.osm")
    code, said = run(monkeypatch, capsys, path, folder / "out")
    assert code == 0, said.out + said.err
    assert "Traceback" not in said.err
    assert sorted(entry.name for entry in folder.iterdir()) == ["odd.osm", "out"]
    report = json.loads((folder / "out" / "report.json").read_text())
    assert all(check["ok"] for check in report["checks"].values())
    return report


@pytest.mark.parametrize("kind", ["building", "highway"])
def test_houses_without_streets_and_streets_without_houses_are_cities(
    monkeypatch, capsys, tmp_path, kind
):
    town = plain()
    town.elements = [e for e in town.elements if e.startswith("<node") or f'k="{kind}"' in e]
    counts = built(monkeypatch, capsys, tmp_path, town)["counts"]
    found = {"building": counts["buildings"] == 2, "highway": counts["road_km"] > 0}
    assert found == {"building": kind == "building", "highway": kind == "highway"}


@pytest.mark.parametrize(
    ("name", "out", "more", "words"),
    [
        ("x" * 300 + ".osm", "out", (), ".osm: File name too long."),
        ("map.osm", "map.osm", (), "map.osm is a file; give a folder for the results."),
        ("map.osm", "map.osm/out", (), "map.osm/out cannot be made: Not a directory."),
        ("map.osm", "x" * 300, (), "x cannot be a folder: File name too long."),
        ("map.osm", "out", ("--size", "nanx5"), '--size "nanx5" is not of the form 800x600.'),
        ("map.osm", "out", ("--picture", "infx9"), '"infx9" is not of the form 960x540.'),
        ("map.osm", "out", ("--time", "99:99"), '"99:99" is no time of day; write HH:MM or one of'),
        ("map.osm", "out", ("--weather", "hail"), '"hail" is no weather; one of clear, cloudy,'),
        ("map.osm", "out", ("--style", "zzz"), 'There is no style "zzz". Known: european, brick,'),
    ],
)  # fmt: skip
def test_what_cannot_be_done_is_said_in_one_sentence(
    monkeypatch, capsys, tmp_path, name, out, more, words
):
    plain().write(tmp_path / "map.osm")
    code, said = run(monkeypatch, capsys, tmp_path / name, tmp_path / out, *more)
    assert code == 2, said.err
    (line,) = [line for line in said.err.splitlines() if line.startswith("error: ")]
    assert words in line
    assert said.err.endswith(line + "\n")
    assert [entry.name for entry in tmp_path.iterdir()] == ["map.osm"]
