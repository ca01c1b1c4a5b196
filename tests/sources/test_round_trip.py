"""A made map, painted at half a metre and drawn again; benchmarks/raster.py measures real ones."""

import numpy as np
import pytest
import shapely
from rasterio.features import rasterize
from rasterio.transform import Affine
from shapely import affinity

from cityx.city import Frame
from cityx.geometry.raster.grid import Grid
from cityx.sources.class_map import ClassMap, layout_of
from cityx.sources.map_classes import class_of

PIXEL, SIDE = 0.5, 300.0
GRID = Grid.about_origin(600, 600, PIXEL)
WORDS = ("grass", "water", "road", "building")
PARTS = (
    shapely.box(-9, -6, 9, 6),
    shapely.union(shapely.box(-12, -5, 12, 5), shapely.box(-12, -5, -4, 14)),
    shapely.difference(shapely.box(-14, -12, 14, 12), shapely.box(-6, -5, 6, 5)),
)
STREETS = [
    shapely.LineString([(-150, -40), (150, 20)]), shapely.LineString([(-60, -150), (-40, 150)]),
    shapely.LineString([(60, 150), (55, 1)]), shapely.LineString([(90, -150), (100, 10)]),
]  # fmt: skip
LAKE = affinity.scale(shapely.Point(20, -100).buffer(1, 64), 30, 22)


def made_houses():
    """Houses of three plans at many angles, clear of streets and water."""
    houses = []
    for number, (x, y) in enumerate(
        (x, y) for x in range(-120, 130, 40) for y in range(-120, 130, 40)
    ):
        plan = affinity.rotate(PARTS[number % 3], 11 * number, origin=(0, 0))
        house = affinity.translate(plan, x + 0.17 * number, y - 0.11 * number)
        clear = shapely.distance(house, [*STREETS, LAKE]).min() > 6
        if clear:
            houses.append(house)
    return shapely.simplify(np.array(houses, object), 0.001)


@pytest.fixture(scope="module")
def trip():
    houses = made_houses()
    layers = [(LAKE, 1)]
    layers += [(shape, 2) for shape in shapely.buffer(STREETS, 3.5, cap_style="flat")]
    layers += [(shape, 3) for shape in houses]
    place = Affine(PIXEL, 0, GRID.west, 0, -PIXEL, GRID.north)
    labels = rasterize(layers, (GRID.rows, GRID.columns), transform=place, dtype=np.uint8)
    found = ClassMap(labels, tuple(class_of(word) for word in WORDS), GRID)
    return houses, layout_of(found, Frame(48.0, 11.0), source="made", seed=0)[0]


def test_every_house_comes_back_once(trip):
    houses, layout = trip
    found = layout.buildings.geometry.to_numpy()
    assert len(found) == len(houses)
    row, other = shapely.STRtree(found).query(houses, predicate="intersects")
    shared = shapely.area(shapely.intersection(houses[row], found[other]))
    iou = shared / (shapely.area(houses[row]) + shapely.area(found[other]) - shared)
    assert iou.mean() > 0.96
    assert iou.min() > 0.9


def test_walls_meet_at_right_angles_and_courts_stay_open(trip):
    houses, layout = trip
    found = layout.buildings.geometry.to_numpy()
    corners = [shapely.get_num_coordinates(shapes).sum() for shapes in (houses, found)]
    assert corners[0] == corners[1]
    assert sum(len(h.interiors) for h in found) == sum(len(h.interiors) for h in houses)


def test_streets_come_back_with_their_crossings_and_width(trip):
    _, layout = trip
    truth, found = shapely.union_all(STREETS), layout.roads.geometry.union_all()
    assert found.intersection(truth.buffer(1.5)).length > 0.98 * found.length
    assert truth.intersection(found.buffer(1.5)).length > 0.98 * truth.length
    assert np.allclose(layout.roads["width"], 7.0, atol=0.6)
    lines = layout.roads.geometry.to_numpy()
    ends = np.concatenate([shapely.get_coordinates(shapely.get_point(lines, i)) for i in (0, -1)])
    places, count = np.unique(ends, axis=0, return_counts=True)
    assert (count >= 3).sum() == 3
    true = [
        shapely.intersection(STREETS[0], STREETS[1]),
        shapely.Point(55, 1),
        shapely.Point(100, 10),
    ]
    gap = shapely.distance(shapely.points(places[count >= 3])[:, None], true)
    assert gap.min(axis=1).max() < 2.0


def test_land_keeps_its_area(trip):
    _, layout = trip
    water = layout.areas[layout.areas["kind"] == "water"]
    assert water.geometry.area.sum() == pytest.approx(LAKE.area, rel=0.02)
    assert layout.areas.geometry.area.sum() == pytest.approx(SIDE**2, rel=1e-6)
