"""Plots along streets, courts behind houses, and what becomes of leftovers beside walks."""

import numpy as np
import pytest
import shapely

from cityx.city.ground import LABEL, SURFACES
from cityx.ground.arrangement import check_arrangement, face_areas
from cityx.places.profiles import profile_named
from cityx.road.ground.ground_surface import ground_of
from cityx.road.ground.yards import FINE, FROM_PATH, court_zones, yard_patches
from cityx.road.network.network import road_network

LAND = profile_named("world").land

RING = [([(-80, -80), (80, -80), (80, 80), (-80, 80), (-80, -80)], {})]
ROWS = [(-70, -70, 70, -58), (-70, 58, 70, 70), (-70, -20, -58, 50), (20, -30, 40, 0)]


@pytest.fixture
def yard(layout_of):
    path = ([(-78, 30), (78, 30)], {"kind": "footway", "width": 2.0})
    return layout_of([*RING, path], houses=ROWS)


def areas(found):
    total = np.bincount(found.face_label, face_areas(found), minlength=len(SURFACES))
    return {surface.name: total[label] for label, surface in enumerate(SURFACES)}


def shapes_of(layout):
    return yard_patches(layout, road_network(layout), LAND).shapes


def test_plots_keep_clear_of_walls_streets_and_paths(yard):
    patches = yard_patches(yard, road_network(yard), LAND)
    shapes = patches.shapes
    assert len(shapes) > 8
    assert len(np.unique(patches.label)) >= 2
    houses, roads = yard.buildings.geometry.to_numpy(), yard.roads.geometry.to_numpy()
    for things, gap in ((houses, LAND.wall_gap), (roads[1:], 1.0 + FROM_PATH), (roads[:1], 3.0)):
        for thing in things:
            assert shapely.distance(shapes, thing).min() > gap - 0.1


def test_plots_lie_side_by_side_along_their_street_when_all_is_turned(layout_of):
    turn = np.radians(30.0)
    spin = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    ring = [(np.array(points) @ spin, tags) for points, tags in RING]
    layout = layout_of(ring, houses=ROWS)
    houses = layout.buildings.geometry.to_numpy()
    layout.buildings["geometry"] = [shapely.transform(h, lambda p: p @ spin) for h in houses]
    patches = yard_patches(layout, road_network(layout), LAND)
    assert len(patches.id) > 8
    quarter = np.mod(np.arctan2(patches.along[:, 1], patches.along[:, 0]), np.pi / 2)
    assert quarter == pytest.approx(np.full(len(quarter), turn), abs=1e-6)
    street = layout.roads.geometry.to_numpy()[0]
    front = shapely.distance(patches.shapes, street)
    assert len(np.unique(np.round(front, 1))) == 2  # each side's begin behind its walk
    one, other = shapely.STRtree(patches.shapes).query(patches.shapes, predicate="intersects")
    assert (one == other).all()


def test_plots_and_courts_do_not_depend_on_the_order_of_houses(layout_of):
    layouts = [layout_of(RING, houses=houses) for houses in (ROWS, ROWS[::-1])]
    plots = [shapes_of(layout) for layout in layouts]
    courts = [court_zones(layout, road_network(layout), LAND)[0] for layout in layouts]
    assert len(courts[0])
    for first, second in (plots, courts):
        assert shapely.equals_exact(
            shapely.normalize(shapely.multipolygons(first)),
            shapely.normalize(shapely.multipolygons(second)), 1e-9,
        )  # fmt: skip


def test_courts_leave_paving_along_walls_and_before_plots(yard):
    network = road_network(yard)
    zones, kind = court_zones(yard, network, LAND)
    assert len(zones) == len(kind)
    assert shapely.area(zones).sum() > 500.0
    for house in yard.buildings.geometry:
        assert shapely.distance(zones, house).min() > LAND.wall_gap - FINE - 0.01
    plots = shapely.union_all(yard_patches(yard, network, LAND).shapes)
    assert shapely.distance(zones, plots).min() > 1.2 - FINE - 0.01


def test_bays_and_bare_patches_lie_in_paved_yards_only(yard, layout_of):
    found = ground_of(yard)
    assert check_arrangement(found) == (0, 0, 0.0)
    area = areas(found)
    assert min(area["parking"], area["grass"]) > 5.0
    lonely = areas(ground_of(layout_of(RING, houses=ROWS[3:])))  # a house on a lawn
    assert lonely["parking"] == lonely["bare"] == 0.0


def test_a_strip_between_a_walk_and_facades_is_paved_to_the_facade(layout_of):
    # The walks are 2 m wide and the houses stand 5.15 m from the kerb.
    streets = [([(-90, y), (90, y)], {}) for y in (-60, 60)]
    streets += [([(x, -90), (x, 90)], {}) for x in (-60, 60)]
    houses = [(-51.7, -51.7, 51.7, -30), (-51.7, 30, 51.7, 51.7), (-51.7, -30, -30, 30),
              (30, -30, 51.7, 30)]  # fmt: skip
    found = ground_of(layout_of(streets, houses=houses))
    middle = found.vertices[found.triangles].mean(axis=1)
    strip = (np.abs(middle[:, 1] + 53.0) < 0.9) & (np.abs(middle[:, 0]) < 40)
    assert strip.any()
    paved = {LABEL["sidewalk"], LABEL["frontage"], LABEL["edging"], LABEL["bed"]}
    assert set(found.face_label[found.triangle_face[strip]].tolist()) <= paved
    yard = (np.abs(middle) < 20).all(axis=1)
    assert LABEL["sidewalk"] not in found.face_label[found.triangle_face[yard]]
