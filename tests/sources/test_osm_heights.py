import json

import numpy as np
import pytest
import shapely

from cityx.sources.features.building_heights import (
    TYPE,
    TYPES,
    building_types,
    fill_levels,
    prior_levels,
)
from cityx.sources.features.parts import known_levels
from cityx.sources.features.vertical import read_vertical
from cityx.sources.osm import read_osm


def boxes(count, side=12.0, step=40.0):
    x = np.arange(count) * step
    return shapely.box(x, 0.0, x + side, side)


def test_the_drawn_levels_have_the_usual_quantiles():
    ids = np.arange(1, 20001, dtype=np.uint64)
    for kind in (TYPE["apartments"], TYPE["office"]):
        types, place = np.full(len(ids), kind), np.ones(len(ids), int)
        drawn = prior_levels(types, place, ids, seed=1)
        expected = TYPES[kind].levels[1]
        assert np.abs(np.quantile(drawn, [0.1, 0.5, 0.9]) - expected).max() <= 1


def test_unknown_buildings_resemble_known_neighbours_of_their_type():
    polygons = boxes(40, step=14.0)
    levels = np.full(40, np.nan)
    levels[::2] = 9.0
    kinds = np.full(40, TYPE["apartments"])
    ids = np.arange(1, 41, dtype=np.uint64)
    filled = fill_levels(levels, polygons, kinds, np.zeros(40, int), ids, seed=0)
    assert np.median(filled[1::2]) == 9
    assert (filled[::2] == 9).all()


def test_a_shared_wall_lends_its_levels():
    polygons = shapely.box([0.0, 10.1], 0.0, [10.0, 20.0], 10.0)
    kinds = np.full(2, TYPE["apartments"])
    levels = np.array([15.0, np.nan])
    filled = fill_levels(levels, polygons, kinds, np.zeros(2, int), np.array([1, 2]), seed=0)
    assert filled[1] in (14, 15, 16)


def test_small_and_slender_buildings_without_tags_stay_low():
    polygons = np.array([shapely.box(0, 0, 4, 4), shapely.box(50, 0, 55, 6)])
    kinds = np.full(2, TYPE["office"])
    unknown = np.full(2, np.nan)
    filled = fill_levels(unknown, polygons, kinds, np.full(2, 2), np.array([1, 2]), seed=0)
    assert filled[0] == 1
    assert 4.5 + 3.7 * (filled[1] - 1) <= 8 * np.sqrt(30)


@pytest.mark.shared
@pytest.mark.parametrize("name", ["villeurbanne_5.osm.gz", "cuenca.osm", "london_soho.osm.gz"])
def test_levels_of_hidden_buildings_follow_the_distribution_of_the_tagged(name, shared_osm):
    buildings = read_osm(shared_osm(name)).layout.buildings
    tags = [json.loads(text) for text in buildings["tags"]]
    polygons = buildings.geometry.to_numpy()
    place = np.searchsorted(["core", "low", "urban"], buildings["place"])
    place = np.array([2, 0, 1])[place]
    types = building_types(list(buildings["use"]), shapely.area(polygons), place, place > 9)
    known = known_levels(read_vertical(tags), types)
    ids = buildings["id"].to_numpy(np.uint64)
    hidden = ~np.isnan(known) & (np.arange(len(known)) % 2 == 0)
    given = np.where(hidden, np.nan, known)
    filled = fill_levels(given, polygons, types, place, ids, seed=0)[hidden]
    steps = np.arange(0, 40)
    distance = np.abs(
        (filled[:, None] <= steps).mean(axis=0) - (known[hidden][:, None] <= steps).mean(axis=0)
    )
    assert distance.max() < 0.17  # of two samples of about 120, by chance 0.176 in one of twenty
