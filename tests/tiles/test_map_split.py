"""A fragment says of its window all that the whole map does."""

import numpy as np
import pytest
from town import Town

from cityx.city.content import hash_table
from cityx.city.layout import SCHEMA
from cityx.errors import InputError
from cityx.sources.osm import city_of, coverage_of, site_of
from cityx.sources.osm.reader import read_elements
from cityx.tiles.split import fragment_of, read_fragment, surveyed, write_fragment


@pytest.fixture
def town(town_map):
    osm = read_elements(town_map)
    return osm, site_of(osm, "town")[0]


def tables(city):
    return {name: hash_table(getattr(city.layout, name), name)[1].tolist() for name in SCHEMA}


@pytest.mark.parametrize("box", [(-60, -60, 0, 0), (0, -10, 75, 30), (-20, -70, 20, 70)])
def test_a_fragment_reads_as_the_whole_map_does(town, tmp_path, box):
    osm, frame = town
    part = fragment_of(surveyed(osm, frame), box)
    assert len(part.node_id) < len(osm.node_id)
    write_fragment(part, {}, tmp_path / "f.npz")
    own, _, _ = read_fragment(tmp_path / "f.npz")
    cities = [city_of(one, "town", frame=frame, box=box) for one in (own, osm)]
    assert tables(cities[0]) == tables(cities[1])
    assert cities[0].layout.extent == cities[1].layout.extent


def test_the_same_fragment_has_the_same_bytes(town, tmp_path):
    osm, frame = town
    for name in "ab":
        write_fragment(fragment_of(surveyed(osm, frame), (-60, -60, 0, 0)), {}, tmp_path / name)
    assert (tmp_path / "a").read_bytes() == (tmp_path / "b").read_bytes()


def test_a_damaged_fragment_is_named(tmp_path):
    (tmp_path / "f.npz").write_bytes(b"PK nothing")
    with pytest.raises(InputError, match=r"f\.npz is damaged .* build the tiles anew"):
        read_fragment(tmp_path / "f.npz")


def test_a_long_road_has_one_cross_section_in_all_windows(tmp_path):
    town = Town()
    town.way([town.node(0, 0), town.node(1200, 0)], highway="residential")
    for row in range(40):  # dense at one end alone
        town.box(25 * (row % 10), 12 + 30 * (row // 10), 22, 24, building="apartments")
    osm = read_elements(town.write(tmp_path / "road.osm"))
    frame = site_of(osm, "road")[0]
    coverage = coverage_of(osm, frame, (-700, -300, 700, 300))
    boxes = [(-620, -200, -200, 200), (-220, -200, 400, 200)]
    parts = [fragment_of(surveyed(osm, frame), box) for box in boxes]

    def widths(**known):
        cities = [city_of(part, "road", frame=frame, box=box, **known)
                  for part, box in zip(parts, boxes, strict=True)]  # fmt: skip
        return {tuple(city.layout.roads[["width", "sidewalk_left"]].iloc[0]) for city in cities}

    assert len(widths()) == 2
    assert len(widths(coverage=coverage)) == 1
    assert np.isfinite(list(coverage.values())).all()
