"""Changes of life in turn lay the streets, and make their network, once."""

from dataclasses import replace

import numpy as np
import pytest
import shapely
from made_streets import CROSS, city_of

from cityx.city.tracks import no_tracks
from cityx.geometry.arrays import FloatArray
from cityx.motion.vehicles import driven_streets
from cityx.traffic import network, sweeps
from cityx.traffic.network import make_network


def test_streets_are_laid_once_for_changes_of_what_moves():
    city = city_of(CROSS)
    found = driven_streets(city)
    assert driven_streets(replace(city, tracks=no_tracks(), moment=3.0)) is found
    assert driven_streets(city_of(CROSS[:1])) is not found


@pytest.mark.sumo
def test_a_network_is_made_once_for_the_same_streets(tmp_path, monkeypatch):
    city = city_of(CROSS)
    found = driven_streets(city)
    folders = [tmp_path / name for name in ("one", "other")]
    for folder in folders:
        folder.mkdir()
    first = make_network(found, city.frame, folders[0])
    monkeypatch.setattr(network, "run_program", None)
    second = make_network(found, city.frame, folders[1])
    assert second.file.parent == folders[1]
    assert second.file.read_bytes() == first.file.read_bytes()
    assert replace(second, file=first.file) == first


def test_walls_are_looked_up_for_all_links_at_once():
    streets = driven_streets(city_of(CROSS, houses=[(6, 6, 20, 20)]))
    asked = []

    class Tree(shapely.STRtree):
        def query(self, *args, **options):
            asked.append(len(np.atleast_1d(args[0])))
            return super().query(*args, **options)

    sweeps.tight_links(streets, Tree([shapely.box(6, 6, 20, 20)]))
    assert len(asked) == 1
    assert asked[0] > len(streets.links)


def swept_by_union(path, length: float, half: float) -> FloatArray:
    return shapely.union_all(shapely.polygons(sweeps._swept_along(path, length, half)))


def test_what_a_body_sweeps_over_is_where_it_stands():
    bend = shapely.LineString([(0, 0), (20, 0), (20, 20)])
    walls = np.array([shapely.box(x, y, x + 1, y + 1) for x in range(24) for y in range(24)])
    whole = swept_by_union(bend, sweeps.LENGTH, sweeps.HALF)
    for wall in walls[::7]:
        hit = sweeps.swept_into(np.array([bend]), shapely.STRtree([wall]), 12.0, sweeps.HALF)[0]
        assert hit == wall.intersects(whole)
