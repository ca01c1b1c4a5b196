"""Patches in yards, and what becomes of leftovers beside walks."""

import numpy as np
import pytest
import shapely

from cityx.city.ground import LABEL, SURFACES
from cityx.geometry.arrangement import check_arrangement, face_areas
from cityx.plugins.road.ground import ground_of
from cityx.plugins.road.network import road_network
from cityx.plugins.road.yards import USUAL_GAPS, yard_patches

FROM_WALL, FROM_STREET, FROM_PATH = USUAL_GAPS

RING = [([(-80, -80), (80, -80), (80, 80), (-80, 80), (-80, -80)], {})]
ROWS = [(-70, -70, 70, -58), (-70, 58, 70, 70), (-70, -20, -58, 50), (20, -30, 40, 0)]


@pytest.fixture
def yard(layout_of):
    path = ([(-78, 30), (78, 30)], {"kind": "footway", "width": 2.0})
    return layout_of([*RING, path], houses=ROWS)


def areas(found):
    total = np.bincount(found.face_label, face_areas(found), minlength=len(SURFACES))
    return {surface.name: total[label] for label, surface in enumerate(SURFACES)}


def test_patches_keep_clear_of_walls_streets_and_paths(yard):
    patches = yard_patches(yard, road_network(yard))
    shapes = patches.shapes
    assert len(shapes) > 8
    assert len(np.unique(patches.label)) >= 2
    houses, roads = yard.buildings.geometry.to_numpy(), yard.roads.geometry.to_numpy()
    for things, gap in ((houses, FROM_WALL), (roads[1:], FROM_PATH), (roads[:1], FROM_STREET + 3)):
        for thing in things:
            assert shapely.distance(shapes, thing).min() > gap - 0.1


def test_patches_lie_along_the_nearest_house_when_all_is_turned(layout_of):
    turn = np.radians(30.0)
    c, s = np.cos(turn), np.sin(turn)
    layout = layout_of(RING, houses=ROWS)
    houses = layout.buildings.geometry.to_numpy()
    spun = [shapely.transform(h, lambda p: p @ np.array([[c, s], [-s, c]])) for h in houses]
    layout.buildings["geometry"] = spun
    along = yard_patches(layout, road_network(layout)).along
    quarter = np.mod(np.arctan2(along[:, 1], along[:, 0]), np.pi / 2)
    assert quarter == pytest.approx(np.full(len(along), turn), abs=1e-6)


def test_patches_do_not_depend_on_the_order_of_houses(layout_of):
    first, second = (
        yard_patches(layout, road_network(layout))
        for layout in (layout_of(RING, houses=ROWS), layout_of(RING, houses=ROWS[::-1]))
    )
    assert shapely.equals_exact(
        shapely.normalize(shapely.multipolygons(first.shapes)),
        shapely.normalize(shapely.multipolygons(second.shapes)), 1e-9,
    )  # fmt: skip


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
