import numpy as np
import shapely

from cityx.city import Frame
from cityx.geometry.raster.grid import Grid
from cityx.sources.class_map import ClassMap, city_of
from cityx.sources.map_classes import Role, class_of
from cityx.sources.satellite.plausible import plausible_features, with_streets_connected

WORDS = ("building", "road", "vegetation", "water", "bare")
HOUSE, ROAD, GREEN, WATER, BARE = range(5)
PIXEL = 0.6


def map_of(labels):
    grid = Grid.about_origin(*labels.shape, PIXEL)
    return ClassMap(labels.astype(np.uint8), tuple(map(class_of, WORDS)), grid)


def crossing(size=400):
    """Two streets that cross, on bare ground."""
    labels = np.full((size, size), BARE)
    labels[size // 2 - 6 : size // 2 + 6] = ROAD
    labels[:, size // 2 - 6 : size // 2 + 6] = ROAD
    return labels


def plausible(labels, seed=0):
    return city_of(
        map_of(labels), Frame(25.0, 55.0), source="satellite", name="town", seed=seed,
        draw=lambda found, source: plausible_features(found, source, seed=seed),
    )  # fmt: skip


def test_a_street_hidden_by_trees_goes_on():
    labels = crossing()
    labels[:, 90:130] = np.where(labels[:, 90:130] == ROAD, GREEN, labels[:, 90:130])
    joined = with_streets_connected(map_of(labels)).mask(Role.ROAD)
    assert joined[200, 90:130].all()
    width = joined[:, 110].sum()
    assert abs(width - 12) <= 2


def test_a_street_that_ends_in_the_open_stays_so():
    labels = np.full((400, 400), BARE)
    labels[194:206, :150] = ROAD
    joined = with_streets_connected(map_of(labels)).mask(Role.ROAD)
    assert not joined[:, 152:].any()


def test_parallel_streets_are_not_joined_sideways():
    labels = np.full((400, 400), BARE)
    labels[150:162, :250] = ROAD
    labels[190:202, :250] = ROAD
    joined = with_streets_connected(map_of(labels)).mask(Role.ROAD)
    assert not joined[164:188].any()


def test_a_blob_becomes_houses_on_parcels_of_its_own_block():
    labels = crossing()
    labels[12:180, 12:180] = HOUSE  # all of the north-west block
    city = plausible(labels)
    houses = city.layout.buildings.geometry
    assert len(houses) > 10
    assert houses.area.max() < 1200
    block = shapely.box(-120, 0, 0, 120)
    assert houses.within(block).all()
    assert shapely.union_all(houses.to_numpy()).area < 0.5 * (168 * PIXEL) ** 2


def test_houses_seen_one_by_one_stay_as_they_are():
    labels = crossing()
    for y in range(20, 160, 40):
        for x in range(20, 160, 40):
            labels[y : y + 20, x : x + 24] = HOUSE
    kept = plausible(labels).layout.buildings.geometry
    exact = city_of(map_of(labels), Frame(25.0, 55.0), source="satellite", name="t", seed=0)
    assert len(kept) == 16
    assert np.allclose(sorted(kept.area), sorted(exact.layout.buildings.geometry.area), rtol=0.02)


def test_nothing_is_built_on_water():
    labels = crossing()
    labels[12:180, 12:180] = HOUSE
    labels[40:120, 40:150] = WATER
    city = plausible(labels)
    lake = shapely.box(-120 + 42 * PIXEL, 120 - 118 * PIXEL, -120 + 148 * PIXEL, 120 - 42 * PIXEL)
    assert not city.layout.buildings.geometry.intersects(lake).any()
    assert len(city.layout.buildings) > 3
