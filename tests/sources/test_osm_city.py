import gzip
import random
import re

import numpy as np
import pytest
import shapely
from pandas.testing import assert_frame_equal

from cityx.city.content import content_hash
from cityx.city.layout import AREA_KINDS, POINT_KINDS, SCHEMA
from cityx.errors import InputError
from cityx.sources.features.clipping import inside_site
from cityx.sources.osm import ATTRIBUTION, read_osm

DIRTY = (
    "bristol_degenerate.osm", "saint_petersburg_clip.osm", "karachi.osm",
    "paris_bike_share_clip.osm.gz", "melbourne_fragment_clip.osm.gz", "singapore_bayfront.osm.gz",
    "berlin_siegessaeule.osm.gz", "london_soho.osm.gz", "london_borough.osm",
)  # fmt: skip
MAY_BE_UNKNOWN = {"direction", "roof_direction", "maxspeed_kmh"}


def assert_resolved(city):
    layout = city.layout
    for name, schema in SCHEMA.items():
        table = getattr(layout, name)
        shapes = table.geometry.to_numpy()
        assert table["id"].is_monotonic_increasing
        assert table["id"].is_unique
        for column, kind in schema.items():
            if kind == "float64" and column not in MAY_BE_UNKNOWN:
                assert np.isfinite(table[column]).all(), column
        if len(shapes):
            assert shapely.is_valid(shapes).all()
            assert not shapely.is_empty(shapes).any()
            xmin, ymin, xmax, ymax = shapely.total_bounds(shapes)
            assert xmin >= layout.extent[0] - 1e-6
            assert ymin >= layout.extent[1] - 1e-6
            assert xmax <= layout.extent[2] + 1e-6
            assert ymax <= layout.extent[3] + 1e-6
    assert set(layout.areas["kind"]) <= set(AREA_KINDS)
    assert set(layout.points["kind"]) <= set(POINT_KINDS)
    assert set(layout.parts["building"]) == set(layout.buildings["id"])
    assert (layout.parts["top"] > layout.parts["base"]).all()
    assert (layout.parts["roof_height"] < layout.parts["top"] - layout.parts["base"]).all()
    assert (layout.roads["lanes"] >= 1).all()
    assert (layout.roads["width"] > 0).all()


def overlap(polygons):
    i, j = shapely.STRtree(polygons).query(polygons, predicate="intersects")
    i, j = i[i < j], j[i < j]
    return shapely.area(shapely.intersection(polygons[i], polygons[j])), i, j


@pytest.mark.shared
@pytest.mark.parametrize("name", DIRTY)
def test_a_dirty_map_becomes_a_resolved_layout(name, shared_osm):
    city = read_osm(shared_osm(name))
    assert_resolved(city)
    assert city.attribution == (ATTRIBUTION,)
    assert city.stages_done == {"layout"}
    shared, _, _ = overlap(city.layout.buildings.geometry.to_numpy())
    assert shared.max(initial=0) < 1.0
    parts = city.layout.parts
    shared, i, j = overlap(parts.geometry.to_numpy())
    base, top = parts["base"].to_numpy(), parts["top"].to_numpy()
    apart = np.minimum(top[i], top[j]) - np.maximum(base[i], base[j]) <= 0.11
    assert shared[~apart].max(initial=0) < 1.0


@pytest.mark.shared
def test_a_map_of_crumbs_is_refused_with_the_cause(shared_osm):
    with pytest.raises(InputError, match="of the 15,990 nodes that ways refer to are not in"):
        read_osm(shared_osm("new_york_manhattan_every_nth.osm.gz"))


def shuffled(text, seed):
    """Put the elements of a file in another order; duplicates are not among them."""
    blocks = re.findall(
        r"<(?:node|way|relation) (?:[^<>]*/>|.*?</(?:node|way|relation)>)", text, re.S
    )
    random.Random(seed).shuffle(blocks)
    return f"<osm>{''.join(re.findall(r'<bounds[^>]*/>', text))}{''.join(blocks)}</osm>"


@pytest.mark.shared
@pytest.mark.parametrize("name", ["london_soho.osm.gz", "berlin_siegessaeule.osm.gz"])
def test_the_order_of_elements_changes_nothing(name, shared_osm, tmp_path):
    path = shared_osm(name)
    other = tmp_path / path.name
    other.write_text(shuffled(gzip.decompress(path.read_bytes()).decode(), 1), encoding="utf-8")
    first, second = read_osm(path), read_osm(other)
    assert first.layout.extent == second.layout.extent
    for table in SCHEMA:
        assert_frame_equal(getattr(first.layout, table), getattr(second.layout, table))
    assert content_hash(first).total == content_hash(second).total
    assert content_hash(first).total != content_hash(read_osm(path, seed=1)).total


@pytest.mark.shared
def test_the_area_of_buildings_equals_that_of_libosmium(shared_osm):
    import osmium

    from cityx.city import Frame
    from cityx.sources.features.kinds import building_kind
    from cityx.sources.features.tagged import Report
    from cityx.sources.osm.areas import candidate_ways
    from cityx.sources.osm.outlines import relation_rings, ring_outlines, way_outlines
    from cityx.sources.osm.reader import read_elements

    for name in ("tokyo_kanda.osm.gz", "saint_petersburg_clip.osm", "villeurbanne_6.osm.gz"):
        path = shared_osm(name)
        osm = read_elements(path)
        lon, lat = np.median(osm.lonlat, axis=0).round(6)
        frame = Frame(lat, lon)
        xy, box, report = frame.to_local(osm.lonlat), (-1e6, -1e6, 1e6, 1e6), Report()
        rings, spoken = relation_rings(osm, building_kind, report)
        ways = [
            way for way in np.concatenate(candidate_ways(osm)).tolist()
            if way not in spoken and "building" in osm.way_tags[way]
        ]  # fmt: skip
        rings = [ring for ring in rings if "building" in ring.owner.tags and not ring.broken]
        ours = [
            *way_outlines(osm, xy, np.array(ways), box, report, solid=True).shapes,
            *ring_outlines(osm, xy, rings, box, report, solid=True).shapes,
        ]
        factory, theirs = osmium.geom.WKBFactory(), 0.0
        for area in osmium.FileProcessor(str(path)).with_areas():
            if area.is_area() and area.tags.get("building", "no") != "no":
                shape = shapely.from_wkb(factory.create_multipolygon(area))
                theirs += shapely.area(shapely.transform(shape, frame.to_local))
        assert shapely.area(ours).sum() == pytest.approx(theirs, rel=1e-3)


def mutated(text, rng):
    """Damage a file in one of the ways that editors, tools and networks do."""
    lines = text.split("\n")
    kind = rng.randrange(6)
    if kind == 0:  # lines lost
        lines = [line for line in lines if rng.random() > 0.03]
    elif kind == 1:  # cut off
        lines = lines[: rng.randrange(len(lines))]
    elif kind == 2:  # lines repeated
        lines = [line for line in lines for _ in range(1 + (rng.random() < 0.02))]
    elif kind == 3:  # values replaced
        words = ["nan", "-1", "1e308", "", "yes", "99999999999999999999", "&lt;", "inf"]
        lines = [
            re.sub(r'(?<=(?:ref|lat|lon|. v|.id)=")[^"]*', rng.choice(words), line, count=1)
            if rng.random() < 0.02 else line
            for line in lines
        ]  # fmt: skip
    elif kind == 4:  # places moved
        lines = [
            re.sub(r'lat="[^"]*"', f'lat="{rng.uniform(-90, 90)}"', line)
            if rng.random() < 0.02 else line
            for line in lines
        ]  # fmt: skip
    else:  # bytes replaced
        text = list(text)
        for _ in range(3):
            text[rng.randrange(len(text))] = chr(rng.randrange(32, 127))
        return "".join(text)
    return "\n".join(lines)


def test_damaged_files_read_or_are_refused(drawing, tmp_path):
    for index in range(6):
        drawing.box(30 * index, 0, 12, 9, building="yes", height=9 + index)
        drawing.box(30 * index + 2, 2, 5, 5, building__part="yes", height=20)
    outer, inner = drawing.box(0, 50, 40, 40), drawing.box(10, 60, 10, 10)
    drawing.relation([(outer, "outer"), (inner, "inner")], type="multipolygon", building="yes")
    drawing.relation([(outer, "outer")], type="multipolygon", natural="water")
    drawing.way([(-50, -10), (300, -10)], highway="residential", oneway="-1")
    drawing.way([(-50, -40), (300, -40)], natural="coastline")
    drawing.way([(-50, 30), (100, 30)], waterway="stream")
    drawing.node(3, -5, natural="tree")
    text = drawing.text().replace("><", ">\n<")
    rng, path, read = random.Random(7), tmp_path / "damaged.osm", 0
    for _ in range(200):
        path.write_text(mutated(text, rng), encoding="utf-8")
        try:
            city = read_osm(path)
        except InputError:
            continue
        read += 1
        if read % 4 == 0:
            assert_resolved(city)
    assert 60 < read < 200


def test_the_site_holds_whole_buildings_with_a_margin():
    polygons = np.array([shapely.box(90, 0, 130, 10), shapely.box(200, 0, 210, 10)])
    kept, box = inside_site(polygons, (0.0, 0.0, 100.0, 100.0))
    assert kept.tolist() == [True, False]
    assert box == pytest.approx((0, -15, 145, 100), abs=0.11)


def test_far_outliers_do_not_stretch_a_site_without_bounds(drawing):
    for x in range(0, 300, 30):
        for y in range(0, 300, 30):
            drawing.box(x, y, 12, 9, building="house")
    drawing.way([(0, 20), (90_000, 20)], highway="primary")
    drawing.box(50_000, 50_000, 10, 10, building="house")
    city = drawing.city()
    assert city.layout.extent[2] - city.layout.extent[0] < 500
    assert len(city.layout.buildings) == 100
    assert city.layout.roads.geometry.length.sum() < 500


def test_a_map_with_only_roads_is_a_city(drawing):
    drawing.way([(0, 0), (100, 0)], highway="residential")
    city = drawing.city(name="Roadville")
    assert len(city.layout.roads) == 1
    assert city.name == "Roadville"
    assert abs(city.frame.latitude - 52.5) < 0.01


def test_a_finely_drawn_building_does_not_make_outliers_of_the_others(drawing):
    angles = np.linspace(0, 2 * np.pi, 2000)
    ring = np.round(np.column_stack([9 * np.cos(angles), 9 * np.sin(angles)]), 4).tolist()
    drawing.way([*map(tuple, ring[:-1]), tuple(ring[0])], building="yes")
    drawing.box(60, 40, 10, 10, building="yes")
    assert len(drawing.city().layout.buildings) == 2


def test_a_site_is_never_wider_than_a_plane_can_be(drawing):
    drawing.box(0, 0, 10, 10, building="yes")
    drawing.way([(0, -5), (3e6, 2e6)], highway="motorway")
    drawing.way([(0, -5), (40, -5)], highway="residential")
    layout = drawing.city().layout
    assert len(layout.buildings) == 1
    assert layout.extent[2] - layout.extent[0] < 200


@pytest.mark.parametrize("latitude", [-16.8, 0.0, 68.9])
@pytest.mark.parametrize("bounds", ["", "across", "least"])
def test_a_map_on_both_sides_of_180_degrees_is_whole(tmp_path, latitude, bounds):
    def written(middle, bounds):
        def at(x):
            lon = middle + x / 111_320 / np.cos(np.radians(latitude))
            return (lon + 180.0) % 360.0 - 180.0

        nodes, ways = [], []
        for house in range(9):
            ring = [(60 * house - 240 + x, y) for x, y in ((0, 0), (20, 0), (20, 12), (0, 12))]
            first = len(nodes)
            nodes += [(at(x), latitude + y / 111_320) for x, y in ring]
            ways.append(([*range(first, first + 4), first], "building"))
        first = len(nodes)
        nodes += [(at(x), latitude - 30 / 111_320) for x in (-300, -100, 100, 300)]
        ways.append((range(first, first + 4), "highway"))
        lon, lat = np.array(nodes).T
        west, east = {"across": (at(-300), at(300)), "least": (lon.min(), lon.max())}.get(
            bounds, (0, 0)
        )
        path = tmp_path / f"{middle:g}.osm"
        path.write_text(
            "<osm>" + (f'<bounds minlat="{lat.min()}" minlon="{west}" maxlat="{lat.max()}"'
                       f' maxlon="{east}"/>' if bounds else "")
            + "".join(f'<node id="{k}" lat="{y}" lon="{x}"/>' for k, (x, y) in enumerate(nodes))
            + "".join(f'<way id="{k}">' + "".join(f'<nd ref="{node}"/>' for node in refs)
                      + f'<tag k="{key}" v="residential"/></way>'
                      for k, (refs, key) in enumerate(ways))
            + "</osm>"
        )  # fmt: skip
        return read_osm(path)

    across, usual = written(180.0, bounds), written(20.0, bounds)
    assert -180 <= across.frame.longitude <= 180
    assert len(across.layout.buildings) == len(usual.layout.buildings) == 9
    for name in ("buildings", "roads"):
        mine, theirs = (getattr(city.layout, name).geometry for city in (across, usual))
        assert mine.area.sum() + mine.length.sum() == pytest.approx(
            theirs.area.sum() + theirs.length.sum(), rel=1e-3
        )
