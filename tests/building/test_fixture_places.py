from types import SimpleNamespace

import numpy as np
from geopandas import GeoDataFrame

from cityx.building.facade.fixtures import Site, _apart


def test_corners_of_one_part_that_are_near_each_other_bear_one_thing():
    start = np.array([[0.0, 0.0], [4.0, 0.0], [40.0, 0.0], [4.5, 0.0]])
    walls = SimpleNamespace(start=start, part=np.array([0, 0, 0, 1]))
    assert _apart(walls, np.arange(4), 18.0).tolist() == [0, 2, 3]
    assert _apart(walls, np.arange(0), 18.0).tolist() == []


def test_the_wall_before_a_corner_is_asked_whether_it_faces_a_street():
    ring = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 8.0], [0.0, 8.0]])
    walls = SimpleNamespace(start=ring, end=np.roll(ring, -1, axis=0), part=np.zeros(4), count=4)
    fronts = SimpleNamespace(street=np.array([True, False, False, True]))
    site = Site(SimpleNamespace(walls=walls, fronts=fronts), GeoDataFrame())
    assert site.before_streets.tolist() == [True, True, False, False]
