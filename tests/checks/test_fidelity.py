"""What a map states is held against the city by a second reading of the file."""

import dataclasses
import shutil
from xml.etree import ElementTree

import numpy as np
import pandas as pd
import pytest

import cityx
from cityx.checks.fidelity import facts, fidelity
from cityx.checks.map_features import features
from cityx.checks.mapped_things import Finished
from cityx.checks.report_html import report_html
from cityx.checks.tag_measures import DEPARTED, KEPT, LOST, UNREADABLE
from cityx.city.section import BAND_KINDS
from cityx.motion.vehicles import halts_of
from cityx.sources.input_kinds import is_map
from cityx.traffic.laying import streets_of
from cityx.traffic.plain import write_plain

HEAD = '<osm version="0.6"><bounds minlat="51.4995" minlon="-0.1010" maxlat="51.5025" maxlon="-0.0960"/>'  # noqa: E501


def osm(tmp_path, *objects, name="map.osm"):
    """Write a map; an object is ("way", tags, [(east, north), ...]) in metres, or "node"."""
    nodes, ways = [], []
    for number, (kind, tags, places) in enumerate(objects, 1):
        told = "".join(f'<tag k="{key}" v="{value}"/>' for key, value in tags.items())
        refs = []
        for step, (east, north) in enumerate(places):
            ident = 1000 * number + step
            own = told if kind == "node" else ""
            place = f'lat="{51.5 + north / 111_250:.7f}" lon="{-0.1 + east / 69_440:.7f}"'
            nodes.append(f'<node id="{ident}" version="1" {place}>{own}</node>')
            refs.append(ident)
        closed = kind == "way" and "building" in tags
        if kind == "way":
            around = [*refs, refs[0]] if closed else refs
            members = "".join(f'<nd ref="{ref}"/>' for ref in around)
            ways.append(f'<way id="{number}" version="1">{members}{told}</way>')
    path = tmp_path / name
    path.write_text(HEAD + "".join(nodes) + "".join(ways) + "</osm>")
    return path


def house(east, north, size=10):
    return [(east, north), (east + size, north), (east + size, north + size), (east, north + size)]


MAP = (
    ("way", {"highway": "residential", "lanes": "2", "maxspeed": "20 mph", "name": "Long Lane",
             "surface": "asphalt"}, [(0, 0), (200, 0)]),
    ("way", {"highway": "residential", "oneway": "-1"}, [(100, 0), (100, 200)]),
    ("way", {"building": "yes", "height": "12 m", "building:levels": "4", "roof:shape": "flat",
             "building:colour": "#b03020", "name": "The Mill"}, house(20, 20)),
    ("way", {"building": "house", "height": "banana"}, house(50, 20)),
    ("way", {"building": "yes", "height": "40'"}, house(130, 40, 14)),
    ("way", {"barrier": "wall"}, [(20, 60), (60, 60)]),
    ("node", {"natural": "tree"}, [(40, 50)]),
    ("node", {"amenity": "bench"}, [(60, 7)]),
)  # fmt: skip


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    path = osm(tmp_path_factory.mktemp("map"), *MAP)
    return cityx.build(path, lod=2).city, path


def test_columns_of_parts_are_read_once_for_all_houses(built, monkeypatch):
    city, _ = built
    finished, read = Finished(city, np.zeros(0, object)), []
    column = pd.Series.to_numpy

    def counted(series, *args, **options):
        read.append(series.name)
        return column(series, *args, **options)

    monkeypatch.setattr(pd.Series, "to_numpy", counted)
    assert finished.heights_of("way/3").max() == pytest.approx(12.0, abs=0.2)
    assert "zone" in read
    once = len(read)
    assert [len(finished.heights_of(name)) for name in finished.buildings] == [1, 1, 1]
    assert len(read) == once


def test_all_that_a_map_states_is_told(built):
    city, path = built
    found = {(fact.tag, fact.name): fact.verdict for fact in facts(city, path)}
    assert found[("height", "way/4")] == UNREADABLE
    stated = {(tag, f"way/{number}") for number, (kind, tags, _) in enumerate(MAP, 1)
              if kind == "way" for tag in tags if tag not in ("barrier",)}  # fmt: skip
    assert stated <= found.keys()
    assert {tag for tag, name in found if name.startswith("node")} == {"natural=tree",
                                                                     "amenity=bench"}  # fmt: skip
    assert {verdict for key, verdict in found.items() if key != ("height", "way/4")} == {KEPT}


def changed(city, table, column, source, value):
    """Return a city in which one value of the layout is another."""
    rows = getattr(city.layout, table).copy()
    owner = city.layout.buildings.set_index("source")["id"]
    of = rows["source"] == source if "source" in rows else rows["building"] == owner[source]
    rows.loc[of, column] = value
    return dataclasses.replace(city, layout=dataclasses.replace(city.layout, **{table: rows}))


@pytest.mark.parametrize(
    ("table", "column", "source", "value", "tag"),
    [
        ("parts", "top", "osm/way/3", 9.0, "height"),
        ("parts", "roof_shape", "osm/way/3", "gabled", "roof:shape"),
        ("buildings", "levels", "osm/way/3", 2, "building:levels"),
        ("buildings", "name", "osm/way/3", "", "name"),
        ("roads", "surface", "osm/way/1", "gravel", "surface"),
        ("roads", "name", "osm/way/1", "Other", "name"),
    ],
)
def test_a_departure_is_found(built, table, column, source, value, tag):
    city, path = built
    spoilt = changed(city, table, column, source, value)
    found = {(fact.tag, fact.name): fact for fact in facts(spoilt, path)}
    assert found[(tag, source.removeprefix("osm/"))].verdict == DEPARTED


def test_lanes_and_directions_are_those_of_the_lane_graph(built):
    city, path = built
    flipped = dataclasses.replace(city.lanes, speed=np.full_like(city.lanes.speed, 90.0))
    one = cityx.build(osm(path.parent, ("way", {**MAP[1][1], "oneway": "yes"}, MAP[1][2]),
                          MAP[2], name="other.osm"), lod=0).city  # fmt: skip
    found = {fact.tag: fact.verdict for fact in facts(
        dataclasses.replace(city, lanes=flipped), path)}  # fmt: skip
    assert found["maxspeed"] == DEPARTED
    two = osm(path.parent, MAP[1], MAP[2], name="turned.osm")
    assert [fact.verdict for fact in facts(one, two) if fact.tag == "oneway"] == [DEPARTED]


def test_what_is_not_in_the_city_is_lost(built):
    city, path = built
    gone = dataclasses.replace(
        city.layout, buildings=city.layout.buildings.iloc[:0], lines=city.layout.lines.iloc[:0]
    )
    bare = dataclasses.replace(city, layout=gone, scene=dataclasses.replace(
        city.scene, instances={}))  # fmt: skip
    lost = {fact.tag for fact in facts(bare, path) if fact.verdict == LOST}
    assert {"building", "height", "natural=tree", "amenity=bench", "barrier=wall"} <= lost


def test_a_report_says_what_is_kept(built):
    city, path = built
    table = fidelity(city, path)
    assert table["share"] == 1.0
    assert table["tags"]["height"]["unreadable"] == 1
    assert ["way/4", "unreadable", "banana", "banana", ""] in table["tags"]["height"]["which"]
    page = report_html({"name": "x", "fidelity": [{"map": path.name, **table}]})
    assert "banana" in page
    assert "100.0 % kept" in page


def test_packed_maps_are_read_alike(built, tmp_path):
    import gzip

    _, path = built
    packed = tmp_path / "map.osm.gz"
    with path.open("rb") as plain, gzip.open(packed, "wb") as out:
        shutil.copyfileobj(plain, out)
    assert [one.name for one in features(packed)] == [one.name for one in features(path)]


def test_a_file_out_of_order_is_read_alike(built, tmp_path):
    _, path = built
    text = path.read_text()
    begin, end = text.index("<way"), text.index("</osm>")
    ways = text[begin:end].replace("</way>", "</way>\n").splitlines()
    other = tmp_path / "other.osm"
    other.write_text(text[:begin] + "".join(reversed(ways)) + text[end:])
    found = {one.name: dict(one.tags) for one in features(other)}
    assert found == {one.name: dict(one.tags) for one in features(path)}


def test_a_map_without_streets_or_houses_is_told(tmp_path):
    for objects in (MAP[2:5], MAP[:2]):
        path = osm(tmp_path, *objects)
        table = fidelity(cityx.build(path, lod=0).city, path)
        assert "error" not in table
        assert table["tags"]["building" if objects == MAP[2:5] else "highway"]["lost"] == 0


def test_a_house_that_stands_under_another_name_is_not_lost(tmp_path):
    twice = house(20.3, 20, 15.7)
    path = osm(
        tmp_path,
        ("way", {"highway": "residential"}, [(0, 0), (200, 0)]),
        ("way", {"building": "yes", "height": "12", "name": "The Mill"}, house(20, 20, 16)),
        ("way", {"building": "yes", "height": "12"}, twice),
        ("way", {"building": "yes"}, house(60, 20)),
    )
    city = cityx.build(path, lod=0).city
    assert len(city.layout.buildings) == 2
    told = {(fact.tag, fact.name): fact for fact in facts(city, path)}
    assert {told["building", f"way/{number}"].verdict for number in (2, 3, 4)} == {KEPT}
    assert told["height", "way/3"].verdict == KEPT


def test_the_outer_way_of_a_house_with_a_court_is_not_lost(tmp_path):
    path = osm(
        tmp_path,
        ("way", {"highway": "residential"}, [(0, 0), (200, 0)]),
        ("way", {"building": "hospital"}, house(20, 20, 40)),
        ("way", {}, [*house(30, 30, 20), (30, 30)]),
    )
    relation = (
        '<relation id="9" version="1"><member type="way" ref="2" role="outer"/>'
        '<member type="way" ref="3" role="inner"/><tag k="type" v="multipolygon"/></relation></osm>'
    )
    path.write_text(path.read_text().replace("</osm>", relation))
    city = cityx.build(path, lod=0).city
    assert city.layout.buildings.geometry.area.iloc[0] == pytest.approx(1200, rel=0.02)
    assert {fact.verdict for fact in facts(city, path) if fact.tag == "building"} == {KEPT}


def test_what_is_lost_carries_what_the_report_says_of_it(tmp_path):
    below = {"building": "yes", "location": "underground"}
    path = osm(tmp_path, *MAP[:3], ("way", below, house(60, 20)))
    table = fidelity(cityx.build(path, lod=0).city, path)["tags"]["building"]
    assert (table["lost"], table["unexplained"]) == (1, 0)
    assert table["which"][0][0] == "way/4"
    assert "below the ground" in table["which"][0][-1]


def test_a_house_in_the_margin_of_the_site_is_named(tmp_path):
    street = ("way", {"highway": "residential"}, [(0, north) for north in range(0, 330, 30)])
    north = 278  # of the rectangle that the file declares
    houses = [("way", {"building": "yes"}, house(20, y, 12)) for y in (30, north - 6, north + 10)]
    path = osm(tmp_path, street, *houses)
    city = cityx.build(path, lod=0).city
    table = fidelity(city, path)["tags"]["building"]
    assert (table["stated"], table["lost"], table["unexplained"]) == (3, 1, 0)
    assert "at the border" in table["which"][0][-1]


def test_materials_are_held_against_what_the_walls_and_roofs_are_of(tmp_path):
    said = [("brick", "slate"), ("glass", "copper"), ("jelly", "grass"), ("wood;stone", "tin")]
    houses = [
        ("way", {"building": "house", "building:material": wall, "roof:material": roof,
                 "building:colour": "gold"}, house(20 + 30 * number, 20))
        for number, (wall, roof) in enumerate(said)
    ]  # fmt: skip
    path = osm(tmp_path, ("way", {"highway": "residential"}, [(0, 0), (200, 0)]), *houses)
    city = cityx.build(path, lod=1).city
    found = {(fact.tag, fact.stated): fact.verdict for fact in facts(city, path)}
    walls = [found["building:material", wall] for wall, _ in said]
    assert walls == [KEPT, KEPT, UNREADABLE, KEPT]
    assert {found["roof:material", roof] for _, roof in said} == {KEPT}
    assert found["building:colour", "gold"] == KEPT
    assert any("materials that are not known" in note and "way/4" in note for note in city.notes)
    layout = city.layout
    wooden = dataclasses.replace(
        city, layout=dataclasses.replace(layout, parts=layout.parts.assign(wall_material="wood"))
    )
    from cityx.building.shell import shell

    told = [fact for fact in facts(shell(wooden), path) if fact.stated == "brick"]
    assert [fact.verdict for fact in told] == [DEPARTED]


def test_steep_roofs_and_posts_are_no_walls(tmp_path):
    told = {"building:colour": "yellow", "building:material": "concrete"}
    path = osm(
        tmp_path,
        ("way", {"highway": "residential"}, [(0, 0), (200, 0)]),
        ("way", {"building": "hotel", "roof:angle": "80", "roof:shape": "gabled", **told},
         house(20, 20)),
        ("way", {"building": "roof", "building:material": "concrete"}, house(60, 20)),
        ("way", {"building": "house", "roof:angle": "78", "roof:shape": "hipped", **told},
         house(100, 20)),
    )  # fmt: skip
    city = cityx.build(path, lod=1).city
    found = {fact.verdict for fact in facts(city, path) if fact.tag in told}
    assert found == {KEPT}


CROSSED = [(0, 0), (40, 0), (80, 0), (120, 0), (160, 0), (200, 0)]
STREETS = (
    ("way", {"highway": "tertiary", "sidewalk": "both", "lanes": "2"}, CROSSED),
    ("node", {"highway": "crossing", "crossing": "zebra"}, [(40, 0)]),
    ("node", {"highway": "crossing", "crossing": "unmarked"}, [(120, 0)]),
    ("node", {"highway": "crossing", "crossing": "no"}, [(160, 0)]),
    ("node", {"barrier": "kerb", "kerb": "lowered"}, [(40, 3.4)]),
    ("node", {"kerb": "raised"}, [(80, 3.4)]),
    ("node", {"kerb": "slanted"}, [(80, -3.4)]),
    ("way", {"building": "house", "height": "7", "building:material": "brick",
             "roof:material": "roof_tiles", "roof:shape": "gabled"}, house(20, 20)),
    ("node", {"entrance": "main"}, [(25, 20)]),
    ("way", {"barrier": "wall", "height": "2.5", "width": "0.6"}, [(60, 60), (100, 60)]),
    ("way", {"highway": "residential", "oneway": "yes", "oneway:bicycle": "no",
             "sidewalk": "left"}, [(0, 120), (200, 120)]),
    ("way", {"highway": "residential", "oneway": "yes", "cycleway": "opposite_lane",
             "sidewalk": "no"}, [(0, 160), (200, 160)]),
    ("way", {"highway": "secondary", "oneway": "yes", "lanes": "3",
             "bus:lanes": "yes|yes|designated"}, [(0, 200), (200, 200)]),
    ("way", {"building": "yes"}, house(150, -40)),
)  # fmt: skip


@pytest.fixture(scope="module")
def streets(tmp_path_factory):
    path = osm(tmp_path_factory.mktemp("streets"), *STREETS)
    return cityx.build(path, lod=2).city, path


def test_streets_with_all_that_is_told_of_them_are_kept(streets):
    city, path = streets
    found = {(fact.tag, fact.name): (fact.verdict, fact.found) for fact in facts(city, path)}
    tags = {tag for tag, _ in found}
    assert {
        "crossing",
        "kerb",
        "entrance",
        "building:material",
        "roof:material",
        "sidewalk",
        "barrier:height",
        "barrier:width",
        "oneway:bicycle",
        "cycleway",
        "bus:lanes",
    } <= tags
    wrong = {key: told for key, told in found.items() if told[0] != KEPT}
    assert [told[0] for told in wrong.values()] == [UNREADABLE]  # kerb=slanted
    assert sum(tag == "crossing" for tag, _ in found) == 3


def of_kind(city, kind, other):
    """Return a city whose lanes of one kind are of another."""
    own = city.lanes.kind == BAND_KINDS.index(kind)
    kinds = np.where(own, BAND_KINDS.index(other), city.lanes.kind).astype(np.uint8)
    return dataclasses.replace(city, lanes=dataclasses.replace(city.lanes, kind=kinds))


def without(city, **tables):
    """Return a city without some of its meshes, things or points."""
    scene = city.scene
    meshes = {name: mesh for name, mesh in scene.meshes.items() if name not in tables}
    things = {name: rows for name, rows in scene.instances.items() if name not in tables}
    return dataclasses.replace(city, scene=dataclasses.replace(scene, meshes=meshes,
                                                               instances=things))  # fmt: skip


@pytest.mark.parametrize(
    ("spoil", "tag", "verdict"),
    [
        (lambda city: without(city, barriers=0), "barrier=wall", LOST),
        (lambda city: without(city, doors=0), "entrance", LOST),
        (lambda city: of_kind(city, "cycle", "verge"), "bicycle", DEPARTED),
        (lambda city: of_kind(city, "bus", "drive"), "bus:lanes", DEPARTED),
    ],
)  # fmt: skip
def test_what_is_not_so_in_the_city_is_told(streets, spoil, tag, verdict):
    city, path = streets
    told = [
        fact
        for fact in facts(spoil(city), path)
        if fact.tag == tag or (tag == "bicycle" and fact.tag in ("oneway:bicycle", "cycleway"))
    ]
    assert told
    assert {fact.verdict for fact in told} == {verdict}


def moved(path, text, other):
    """Return another map, for a city that was built from the first."""
    content = path.read_text()
    assert text in content
    changed = path.with_name("changed.osm")
    changed.write_text(content.replace(text, other))
    return changed


@pytest.mark.parametrize(
    ("text", "other", "tag"),
    [
        ('v="raised"', 'v="lowered"', "kerb"), ('v="lowered"', 'v="raised"', "kerb"),
        ('v="brick"', 'v="glass"', "building:material"),
        ('v="roof_tiles"', 'v="copper"', "roof:material"),
        ('k="width" v="0.6"', 'k="width" v="1.4"', "barrier:width"),
        ('v="2.5"', 'v="4"', "barrier:height"), ('v="zebra"', 'v="no"', "crossing"),
        ('k="crossing" v="no"', 'k="crossing" v="zebra"', "crossing"),
        ('v="left"', 'v="right"', "sidewalk"),
    ],
)  # fmt: skip
def test_another_word_of_the_map_is_a_departure(streets, text, other, tag):
    city, path = streets
    told = [fact.verdict for fact in facts(city, moved(path, text, other)) if fact.tag == tag]
    assert set(told) & {DEPARTED, LOST}


@pytest.mark.parametrize("upper", [{"bridge": "yes", "layer": "1"}, {"bridge": "yes"},
                                   {"layer": "1", "bridge": "viaduct"}])  # fmt: skip
def test_a_bridge_leads_above_what_it_crosses(tmp_path, upper):
    bridge = ("way", {"highway": "secondary", **upper}, [(100, 150), (100, 250)])
    ends = [("way", {"highway": "secondary"}, line)
            for line in ([(100, -100), (100, 150)], [(100, 250), (100, 330)])]  # fmt: skip
    path = osm(tmp_path, ("way", {"highway": "residential"}, [(0, 200), (200, 200)]), bridge, *ends)
    city = cityx.build(path, lod=1).city
    (fact,) = [fact for fact in facts(city, path) if fact.tag == "level"]
    assert fact.verdict == KEPT
    flat = dataclasses.replace(city, network=dataclasses.replace(
        city.network, z=np.zeros_like(city.network.z)))  # fmt: skip
    (fact,) = [fact for fact in facts(flat, path) if fact.tag == "level"]
    assert fact.verdict == DEPARTED


@pytest.mark.parametrize("name", ["map.xml", "map", "MAP.XML"])
def test_a_map_of_another_name_has_its_fidelity(built, tmp_path, name):
    city, path = built
    other = tmp_path / name
    shutil.copyfile(path, other)
    assert is_map(other)
    assert fidelity(city, other) == fidelity(city, path)
    picture = tmp_path / "picture.png"
    picture.write_bytes(b"<osm")
    assert not is_map(picture)


def test_what_has_no_room_is_lost_with_its_reason(tmp_path):
    block = house(20, 20, 30)
    path = osm(
        tmp_path,
        ("way", {"highway": "residential"}, [(0, 0), (200, 0)]),
        ("way", {"building": "yes"}, block),
        ("node", {"natural": "tree"}, [(35, 35)]),
    )
    city = cityx.build(path, lod=2).city
    (fact,) = [fact for fact in facts(city, path) if fact.tag == "natural=tree"]
    assert fact.verdict == LOST
    assert "free" in fact.why


@pytest.mark.parametrize(
    ("around", "inner", "verdict"),
    [
        ({"landuse": "grass"}, {"landuse": "grass"}, KEPT),
        ({"natural": "wood"}, {"landuse": "grass"}, LOST),
        ({"natural": "water"}, {"waterway": "stream"}, KEPT),  # through a pond
        ({"landuse": "grass"}, {"waterway": "stream"}, LOST),
    ],
)
def test_land_that_other_land_of_its_tag_covers_is_kept(tmp_path, around, inner, verdict):
    ring = [(0, 0), (80, 0), (80, 80), (0, 80), (0, 0)]
    line = "waterway" in inner
    course = [(10, 40), (70, 40)] if line else [(x / 2 + 9, y / 2 + 9) for x, y in ring]
    path = osm(tmp_path, ("way", around, ring), ("way", inner, course),
               ("way", {"building": "yes"}, house(120, 20)))  # fmt: skip
    city = cityx.build(path, lod=0).city
    areas = city.layout.areas
    alone = areas[areas["source"] != "osm/way/2"].reset_index(drop=True)
    city = dataclasses.replace(city, layout=dataclasses.replace(city.layout, areas=alone))
    (told,) = [fact for fact in facts(city, path) if fact.name == "way/2"]
    assert told.verdict == verdict


def test_what_stands_far_from_its_place_is_a_departure(built):
    city, path = built
    things = dict(city.scene.instances)
    moved = things["street_furniture"].position + np.array([40.0, 0.0, 0.0], np.float32)
    things["street_furniture"] = dataclasses.replace(things["street_furniture"], position=moved)
    far = dataclasses.replace(city, scene=dataclasses.replace(city.scene, instances=things))
    (bench,) = [fact for fact in facts(far, path) if fact.tag == "amenity=bench"]
    assert bench.verdict == DEPARTED
    assert abs(float(bench.found.split()[0]) - 40) < 5


ZEBRA = {"highway": "crossing", "crossing": "zebra"}
WALKED = {"highway": "residential", "sidewalk": "both", "surface": "asphalt"}
ROADS = {
    "over a bridge": (
        ("way", WALKED, [(-60, 100), (-40, 100), (40, 100), (70, 100)]),
        ("way", {**WALKED, "bridge": "yes", "layer": "1"}, [(70, 100), (100, 100), (130, 100)]),
        ("way", WALKED, [(130, 100), (160, 100), (240, 100), (270, 100)]),
        ("way", {**WALKED, "highway": "secondary"}, [(105, 10), (105, 190)]),
        ("node", ZEBRA, [(-40, 100)]),
        ("node", ZEBRA, [(240, 100)]),
        ("node", ZEBRA, [(100, 100)]),
    ),
    "out of a cutting": (
        ("way", {**WALKED, "tunnel": "yes", "layer": "-1"}, [(-20, 0), (20, 0)]),
        ("way", {**WALKED, "highway": "tertiary"}, [(20, 0), (40, 0), (190, 0), (220, 0)]),
        ("way", WALKED, [(-20, 0), (-220, 0)]),
        ("way", {**WALKED, "highway": "primary"}, [(0, -90), (0, 90)]),
        ("node", {"highway": "crossing", "crossing": "unmarked"}, [(190, 0)]),
        ("node", ZEBRA, [(40, 0)]),
    ),
    "up to a viaduct": (
        ("way", {**WALKED, "highway": "primary"}, [(100, 260), (100, 230), (100, 120)]),
        ("way", {**WALKED, "highway": "primary", "bridge": "viaduct", "layer": "2"},
         [(100, 120), (100, 80), (100, 40)]),
        ("way", WALKED, [(20, 80), (180, 85)]),
        ("node", ZEBRA, [(100, 230)]),
    ),
}  # fmt: skip


def crossing_facts(path):
    city = cityx.build(path, lod=1).city
    assert not [fact for fact in facts(city, path) if fact.verdict == LOST and not fact.why]
    return {
        fact.name: fact
        for fact in facts(city, path) if fact.tag == "crossing"
    }  # fmt: skip


@pytest.mark.parametrize("name", ROADS)
def test_streets_that_leave_the_ground_are_crossed_where_they_lie_on_it(tmp_path, name):
    found = crossing_facts(osm(tmp_path, *ROADS[name]))
    assert found
    on_ground = [fact for fact in found.values() if fact.verdict == KEPT]
    raised = [fact for fact in found.values() if fact.verdict != KEPT]
    assert len(on_ground) == {"over a bridge": 2, "out of a cutting": 1, "up to a viaduct": 1}[name]
    assert all(fact.verdict == LOST and "bridges, ramps or in cuttings" in fact.why
               for fact in raised)  # fmt: skip


@pytest.mark.parametrize("out", [14.0, 18.0, 21.0])
@pytest.mark.parametrize("kind", ["residential", "tertiary"])
def test_a_crossing_beyond_a_junction_stands_where_the_map_has_it(tmp_path, out, kind):
    road = {**WALKED, "highway": kind}
    found = crossing_facts(osm(
        tmp_path, ("way", road, [(-90, 0), (0, 0), (out, 0), (90, 0)]),
        ("way", WALKED, [(0, -90), (0, 0), (0, 90)]), ("node", ZEBRA, [(out, 0)]),
    ))  # fmt: skip
    (fact,) = found.values()
    assert (fact.verdict, float(fact.found.split()[0]) < 1.0) == (KEPT, True)


@pytest.mark.parametrize("place", [(3, 0), (0, 4), (0, 0)])
def test_a_crossing_amid_a_junction_is_moved_to_its_arm_and_that_is_said(tmp_path, place):
    wide = {**WALKED, "highway": "primary", "lanes": "4", "sidewalk": "both"}
    found = crossing_facts(osm(
        tmp_path, ("way", wide, [(-90, 0), (0, 0), (3, 0), (90, 0)]),
        ("way", wide, [(0, -90), (0, 0), (0, 4), (0, 90)]), ("node", ZEBRA, [place]),
    ))  # fmt: skip
    (fact,) = found.values()
    assert fact.verdict == DEPARTED
    assert "within junctions" in fact.why


# Of each street: its tags, who of SUMO's classes gets on it, and which ways cars drive on it.
CLOSED = (
    ({"motor_vehicle": "no", "lanes": "2"}, {"bicycle"}, set()),
    ({"vehicle": "no"}, set(), set()),
    ({"access": "no", "bicycle": "yes", "oneway": "yes"}, {"bicycle"}, set()),
    ({"vehicle:backward": "no", "bicycle:backward": "yes"}, {"bicycle", "passenger"}, {1}),
    ({"access": "no", "bus": "designated", "lanes": "2"}, {"bus", "bicycle"}, set()),
    ({"motor_vehicle": "private"}, {"bicycle", "private"}, {1, -1}),
    ({"access": "private", "motor_vehicle": "destination"}, {"bicycle", "passenger"}, {1, -1}),
)  # fmt: skip


@pytest.fixture(scope="module")
def closed(tmp_path_factory):
    usual = {"highway": "residential", "sidewalk": "both", "surface": "asphalt"}
    ways = [("way", {**usual, **tags}, [(0, 40 * row), (120, 40 * row)])
            for row, (tags, _, _) in enumerate(CLOSED)]  # fmt: skip
    ends = [("way", {"highway": "tertiary"}, [(x, 40 * row) for row in range(len(CLOSED))])
            for x in (0, 120)]  # fmt: skip
    path = osm(tmp_path_factory.mktemp("closed"), *ways, *ends, *[
        ("node", {"natural": "tree"}, [(60, 20 + 40 * row)]) for row in range(6)])  # fmt: skip
    return cityx.build(path, lod=1).city, path


def test_streets_that_the_map_closes_to_cars_are_closed_in_the_lane_graph(closed):
    city, path = closed
    found = [fact for fact in facts(city, path) if fact.tag.split(":")[0] in
             ("motor_vehicle", "vehicle", "access", "lanes", "oneway")]  # fmt: skip
    assert len(found) == 11
    assert {fact.verdict for fact in found} == {KEPT}
    graph, drive = city.lanes, BAND_KINDS.index("drive")
    source = city.layout.roads["source"].to_numpy(str)[city.network.edge_road[graph.edge]]
    for row, (_, _, ways) in enumerate(CLOSED, 1):
        own = (source == f"osm/way/{row}") & (graph.kind == drive)
        assert set(graph.direction[own].tolist()) == ways


def test_the_second_reading_sees_streets_that_are_open_though_the_map_closes_them(closed):
    city, path = closed
    opened = of_kind(of_kind(city, "cycle", "drive"), "bus", "drive")
    wrong = {fact.tag for fact in facts(opened, path) if fact.verdict == DEPARTED}
    assert wrong == {"motor_vehicle", "access", "vehicle:backward"}


def test_classes_that_may_use_a_lane_go_into_the_files_of_the_traffic(closed, tmp_path):
    city, _ = closed
    streets = streets_of(city, halts_of(city))
    write_plain(streets, city.frame, tmp_path)
    edges = ElementTree.parse(tmp_path / "city.edg.xml").getroot()
    road = city.layout.roads["source"].to_numpy(str)[city.network.edge_road]
    allowed = {}
    for way, edge in zip(streets.ways, edges, strict=True):
        words = {word for lane in edge for word in lane.get("allow").split()}
        allowed.setdefault(road[way.edge], set()).update(words)
    for row, (_, who, _) in enumerate(CLOSED, 1):
        telling = ["bicycle", "passenger" if "passenger" in who else "private", "bus"]
        found = allowed.get(f"osm/way/{row}", set()).intersection(telling)
        assert found - ({"bus"} if "passenger" in who else set()) == who
    local = {road[way.edge] for way in streets.ways if any(lane.local for lane in way.lanes)}
    assert local == {"osm/way/6", "osm/way/7"}


def test_kerbs_are_as_high_as_stated_or_it_is_said_of_which_they_are_not(tmp_path):
    street = {"highway": "tertiary", "sidewalk": "both", "width": "7"}
    told = ("0.02", "3 cm", "12 cm", "0.15 m", "30mm", "0.07", "16 cm", "high")
    spots = [(30 + 30 * (row // 2), 3.6 * (-1) ** row) for row in range(len(told))]
    path = osm(
        tmp_path, ("way", street, [(0, 0), (30, 0), (60, 0), (90, 0), (120, 0), (180, 0)]),
        *[("node", ZEBRA, [(30 + 30 * row, 0)]) for row in range(4)],
        *[("node", {"barrier": "kerb", "kerb:height": value}, [spot])
          for value, spot in zip(told, spots, strict=True)],
    )  # fmt: skip
    city = cityx.build(path, lod=1).city
    found = {fact.stated: fact for fact in facts(city, path) if fact.tag == "kerb:height"}
    kept = {value for value, fact in found.items() if fact.verdict == KEPT}
    assert kept == {"0.02", "3 cm", "12 cm", "0.15 m", "30mm"}
    assert found["high"].verdict == UNREADABLE
    assert all("another height" in found[value].why for value in ("0.07", "16 cm"))


OUTLINES = (
    (house(20, 20, 20), house(20, 20, 20), 1),
    (house(20, 20, 20), [(20, 20), (40, 20), (40, 39.6), (20, 39.6)], 1),
    (house(20, 20, 20), [(20, 20), (40, 20), (40, 34), (20, 34)], 2),
)


@pytest.mark.parametrize(("one", "other", "standing"), OUTLINES)
def test_of_two_outlines_in_one_place_each_keeps_its_name_or_it_is_said_why_not(
    tmp_path, one, other, standing
):
    path = osm(
        tmp_path, ("way", {"building": "yes", "name": "Corn Exchange"}, one),
        ("way", {"building": "retail", "name": "Market Hall"}, other),
        ("way", {"highway": "residential"}, [(0, 0), (90, 0)]),
    )  # fmt: skip
    city = cityx.build(path, lod=0).city
    names = {fact.name: fact for fact in facts(city, path) if fact.tag == "name"}
    stands = dict(zip(city.layout.buildings["source"], city.layout.buildings["name"], strict=True))
    assert len(stands) == standing
    for name, fact in names.items():
        if f"osm/{name}" in stands:
            assert (fact.verdict, stands[f"osm/{name}"]) == (KEPT, fact.stated)
        else:
            assert (fact.verdict, "drawn twice" in fact.why) == (DEPARTED, True)


@pytest.mark.parametrize(
    ("tags", "crossed"),
    [
        ({"highway": "traffic_signals", "crossing": "traffic_signals"}, True),
        ({"highway": "give_way", "crossing": "uncontrolled"}, True),
        ({"highway": "stop", "crossing": "marked"}, True),
        ({"highway": "traffic_signals", "crossing": "no"}, False),
    ],
)
def test_a_node_that_is_a_signal_or_a_sign_and_a_crossing_is_both(tmp_path, tags, crossed):
    road = {**WALKED, "highway": "tertiary"}
    path = osm(
        tmp_path, ("way", road, [(-60, 0), (30, 0), (120, 0)]),
        ("way", WALKED, [(52, -40), (52, 0), (52, 60)]), ("node", tags, [(30, 0)]),
    )  # fmt: skip
    found = crossing_facts(path)
    (fact,) = found.values()
    assert (fact.verdict, fact.found == "nobody crosses") == (KEPT, not crossed)


def test_a_crossing_over_two_carriageways_leads_to_the_walk_beyond_both(tmp_path):
    half = {**WALKED, "highway": "primary", "oneway": "yes", "lanes": "2", "sidewalk": "right"}
    path = osm(
        tmp_path, ("way", half, [(-60, 0), (60, 0), (200, 0)]),
        ("way", half, [(200, 7), (60, 7), (-60, 7)]), ("node", ZEBRA, [(60, 0)]),
    )  # fmt: skip
    (fact,) = crossing_facts(path).values()
    assert fact.verdict == KEPT
