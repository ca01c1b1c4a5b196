"""Barriers that are drawn as areas are solids of their outline, one object under one id."""

from dataclasses import replace

import numpy as np
import pytest

from cityx.city import Terrain
from cityx.nature.land.barriers import barriers

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
    way = drawing.box(0, 0, 40, 2, barrier="city_wall", area="yes")
    area, _, _ = raised(drawing.city())[f"osm/way/{way}"]
    assert area == pytest.approx(80.0 - 2 * 6.8, abs=0.3)


@pytest.mark.parametrize(
    ("word", "height"), [("guard_rail", 0.75), ("handrail", 1.0), ("chain", 0.6), ("yes", 1.5)]
)
def test_rails_and_chains_stand_as_low_fences(drawing, word, height):
    streets(drawing)
    drawing.way([(0, 0), (40, 0)], barrier=word)
    lines = drawing.city().layout.lines
    assert lines["kind"].tolist() == ["fence"]
    assert lines["height"].tolist() == [height]
