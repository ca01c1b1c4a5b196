"""Barriers that are drawn as areas are solids of their outline, one object under one id."""

from dataclasses import replace

import numpy as np
import pytest

from cityx.city import Terrain
from cityx.nature.land.barriers import OVERRUN, barriers

SLOPE = Terrain((-500.0, -500.0), 1000.0, np.array([[0.0, 100.0], [0.0, 100.0]]))


def raised(city, terrain=None):
    """Return footprint, lowest and highest point of each barrier by its source."""
    city = replace(city, lod=1, terrain=terrain or city.terrain)
    batch = barriers(city).scene.meshes["barriers"]
    assert len(np.unique(batch.object_id)) == batch.count
    source = dict(zip(city.layout.lines["id"], city.layout.lines["source"], strict=True))
    found = {}
    for row, key in enumerate(batch.object_id):
        mesh = batch.one(row)
        corners = mesh.vertices[mesh.triangles()[0]]
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        top = normal[:, 2] > 1e-9
        z = mesh.vertices[:, 2]
        found[source[key]] = normal[top, 2].sum() / 2, z.min(), z.max()
        assert normal.sum(axis=0) == pytest.approx(np.zeros(3), abs=1e-6)  # closed
    return found


def streets(drawing):
    drawing.way([(-20, -20), (120, -20), (120, 120), (-20, 120)], highway="residential")


@pytest.mark.parametrize(
    ("tags", "height"),
    [
        ({"barrier": "city_wall", "height": "8"}, 8.0),
        ({"barrier": "wall", "height": "2.5"}, 2.5),
        ({"barrier": "hedge"}, 1.5),
        ({"historic": "citywalls"}, 6.0),
    ],
)
def test_a_barrier_drawn_as_an_area_is_a_solid_of_that_area(drawing, tags, height):
    streets(drawing)
    way = drawing.box(0, 0, 40, 3, area="yes", **tags)
    area, low, high = raised(drawing.city())[f"osm/way/{way}"]
    assert area == pytest.approx(120.0, rel=3e-3)
    assert high - low == pytest.approx(height + 0.4, abs=0.01)


@pytest.mark.parametrize("member", [{}, {"barrier": "city_wall"}])
def test_a_wall_around_a_court_is_one_solid_with_a_hole(drawing, member):
    streets(drawing)
    outer = drawing.box(0, 0, 50, 40, **member)
    inner = drawing.box(3, 3, 44, 34)
    members = [(outer, "outer"), (inner, "inner")]
    ring = drawing.relation(members, type="multipolygon", barrier="city_wall", height="6")
    found = raised(drawing.city())
    assert list(found) == [f"osm/relation/{ring}"]
    assert found[f"osm/relation/{ring}"][0] == pytest.approx(504.0, rel=3e-3)


def test_a_wall_that_is_a_building_is_one_building(drawing):
    streets(drawing)
    way = drawing.box(0, 0, 40, 4, building="yes", barrier="city_wall", height="7")
    layout = drawing.city().layout
    assert layout.buildings["source"].tolist() == [f"osm/way/{way}"]
    assert layout.buildings["height"].tolist() == [7.0]
    assert not len(layout.lines)


def test_a_fence_of_a_pitch_goes_round_it_however_the_pitch_is_drawn(drawing):
    streets(drawing)
    way = drawing.box(0, 0, 20, 10, leisure="pitch", barrier="fence", area="yes")
    outer, inner = drawing.box(40, 0, 20, 20), drawing.box(45, 5, 5, 5)
    members = [(outer, "outer"), (inner, "inner")]
    ring = drawing.relation(members, type="multipolygon", leisure="park", barrier="fence")
    layout = drawing.city().layout
    length = layout.lines.geometry.length.groupby(layout.lines["source"]).sum()
    assert length[f"osm/way/{way}"] == pytest.approx(60.0, rel=3e-3)
    assert length[f"osm/relation/{ring}"] == pytest.approx(100.0, rel=3e-3)
    assert sorted(layout.areas["kind"]) == ["park", "pitch"]
    assert not set(layout.lines["id"]) & set(layout.areas["id"])


def test_the_top_of_a_thick_wall_follows_the_slope(drawing):
    streets(drawing)
    way = drawing.box(0, 0, 60, 2, barrier="wall", height="3", area="yes")
    area, low, high = raised(drawing.city(), SLOPE)[f"osm/way/{way}"]
    assert area == pytest.approx(120.0, rel=3e-3)
    assert high - low == pytest.approx(6.0 + 3.0 + 0.4, abs=0.1)  # 10 % over 60 m


def test_streets_part_thick_walls(drawing):
    streets(drawing)
    drawing.way([(20, -20), (20, 120)], highway="residential", width="6")
    way = drawing.box(0, 0, 40, 2, barrier="city_wall", area="yes", height="4")
    area, _, _ = raised(drawing.city())[f"osm/way/{way}"]
    assert area == pytest.approx(80.0 - 2 * 6.8, abs=0.3)


def meshes(city, lod=1):
    """Return the mesh and its materials of each barrier by its source."""
    done = barriers(replace(city, lod=lod))
    batch = done.scene.meshes["barriers"]
    source = dict(zip(city.layout.lines["id"], city.layout.lines["source"], strict=True))
    found = {}
    for row, key in enumerate(batch.object_id):
        mesh = batch.one(row)
        names = {batch.materials[k] for k in np.unique(batch.material[
            batch.face_start[row] : batch.face_start[row + 1]])}  # fmt: skip
        found[source[key]] = mesh.vertices, names
    return found


@pytest.mark.parametrize(("height", "over"), [("8", True), ("6", True), ("4", False)])
def test_a_thick_wall_goes_on_over_its_gate_where_it_is_high_enough(drawing, height, over):
    streets(drawing)
    drawing.way([(20, -20), (20, 120)], highway="residential", width="6")
    way = drawing.box(0, 0, 40, 2, barrier="city_wall", area="yes", height=height)
    corners, _ = meshes(drawing.city())[f"osm/way/{way}"]
    gate = corners[np.abs(corners[:, 0] + 30) < 3.3]  # 20 m east; the middle of the map is at 50
    assert bool(len(gate)) == over
    if over:  # free below, and as high as the wall
        assert gate[:, 2].min() == pytest.approx(0.12 + 4.7, abs=0.05)
        assert gate[:, 2].max() == pytest.approx(0.12 + float(height), abs=0.05)


@pytest.mark.parametrize(
    ("kind", "area", "tags", "wide"),
    [("wall", False, {}, 3.0), ("wall", True, {"width": "2"}, 2.0),
     ("hedge", False, {"barrier": "kissing_gate"}, 1.0), ("city_wall", True, {}, 3.0)],
)  # fmt: skip
def test_a_gate_that_is_drawn_in_a_barrier_is_an_opening(drawing, kind, area, tags, wide):
    streets(drawing)
    if area:
        way = drawing.box(0, 0, 40, 1.5, barrier=kind, area="yes", height="3")
    else:
        way = drawing.way([(0, 0), (40, 0)], barrier=kind, height="3")
    drawing.node(20, 0, **({"barrier": "gate"} | tags))
    corners, _ = meshes(drawing.city())[f"osm/way/{way}"]
    x = corners[:, 0] + 50
    assert x[x < 20].max() == pytest.approx(20 - wide / 2, abs=0.1)
    assert x[x > 20].min() == pytest.approx(20 + wide / 2, abs=0.1)
    assert x.min() == pytest.approx(0.0, abs=0.5)
    assert x.max() == pytest.approx(40.0, abs=0.5)


@pytest.mark.parametrize(
    ("kind", "tags", "width", "material"),
    [("wall", {"width": "0.8", "material": "stone"}, 0.8, "stone"),
     ("wall", {"width": "2 ft"}, 0.61, "brick"), ("fence", {"material": "wood"}, 0.05, "wood"),
     ("fence", {"fence_type": "chain_link"}, 0.05, "metal_grey"),
     ("hedge", {"width": "2"}, 2.0, "hedge"),
     ("retaining_wall", {"material": "cheese"}, 0.4, "stone")],
)  # fmt: skip
def test_a_barrier_has_the_width_and_the_material_that_are_told(
    drawing, kind, tags, width, material
):
    streets(drawing)
    way = drawing.way([(0, 0), (40, 0)], barrier=kind, height="1.6", **tags)
    corners, names = meshes(drawing.city())[f"osm/way/{way}"]
    rails = corners[np.abs(corners[:, 2] - 0.12 - 0.8) < 0.2] if kind == "fence" else corners
    assert np.ptp(rails[:, 1]) == pytest.approx(width, abs=0.12 if kind == "hedge" else 0.03)
    assert material in names


@pytest.mark.parametrize("area", [False, True])
def test_a_barrier_begins_at_its_least_height(drawing, area):
    streets(drawing)
    tags = {"barrier": "wall", "height": "5", "min_height": "3"}
    if area:
        way = drawing.box(0, 0, 40, 1, area="yes", **tags)
    else:
        way = drawing.way([(0, 0), (40, 0)], **tags)
    z = meshes(drawing.city())[f"osm/way/{way}"][0][:, 2]
    assert z.min() == pytest.approx(0.12 + 3, abs=0.05)
    assert z.max() == pytest.approx(0.12 + 5, abs=0.05)


@pytest.mark.parametrize("tags", [{}, {"layer": "1"}, {"level": "4"}])
def test_a_fence_on_a_flat_roof_stands_on_the_roof(drawing, tags):
    streets(drawing)
    drawing.box(0, 0, 30, 30, building="apartments", height="12", roof__shape="flat")
    way = drawing.way([(2, 2), (28, 2), (28, 28)], barrier="fence", height="1.2", **tags)
    z = meshes(drawing.city())[f"osm/way/{way}"][0][:, 2]
    assert z.min() > 12.0
    assert z.max() == pytest.approx(0.12 + 12 + 1.2, abs=0.1)


def test_a_fence_within_a_house_with_a_pitched_roof_is_named(drawing):
    streets(drawing)
    drawing.box(0, 0, 30, 30, building="house", height="9", roof__shape="gabled")
    drawing.way([(2, 2), (28, 2)], barrier="fence")
    city = barriers(replace(drawing.city(), lod=1))
    assert [failure.object_id for failure in city.failures] == city.layout.lines["id"].tolist()


@pytest.mark.parametrize(
    ("word", "height"), [("guard_rail", 0.75), ("handrail", 1.0), ("chain", 0.6), ("yes", 1.5)]
)
def test_rails_and_chains_stand_as_low_fences(drawing, word, height):
    streets(drawing)
    drawing.way([(0, 0), (40, 0)], barrier=word)
    lines = drawing.city().layout.lines
    assert lines["kind"].tolist() == ["fence"]
    assert lines["height"].tolist() == [height]


@pytest.mark.parametrize(
    ("way", "stands"),
    [({"highway": "footway"}, True), ({"highway": "path", "width": "1.5"}, True),
     ({"highway": "residential"}, False), ({"highway": "service"}, False)],
)  # fmt: skip
def test_a_barrier_along_a_path_stands_and_one_in_a_street_is_named(drawing, way, stands):
    streets(drawing)
    drawing.way([(0, 0), (60, 0)], **way)
    drawing.way([(10, 0.8), (50, 0.8)], barrier="wall")
    drawing.way([(0, 40), (40, 40)], barrier="hedge")
    city = barriers(replace(drawing.city(), lod=1))
    assert len(city.scene.meshes["barriers"].object_id) == 1 + stands
    assert [failure.error for failure in city.failures] == [OVERRUN] * (not stands)
