"""What a tile owns: everything once, whatever stands whole, whatever covers the ground cut."""

from dataclasses import replace

import numpy as np
import shapely

from cityx.city.store import read_city
from cityx.sources.osm import read_osm
from cityx.tiles.actions import built
from cityx.tiles.grid import Tile, holds, in_order, tile_at, tiles_of
from cityx.tiles.ownership import owned
from cityx.tiles.run import TILES, records


def cities(folder):
    return [read_city(folder / TILES / tile.name / "city") for tile in records(folder)]


def test_a_place_on_a_border_belongs_to_one_tile():
    xy = np.array([[0.0, 0.0], [-1e-9, 250.0], [500.0, 0.0], [499.9999, 499.9999]])
    boxes = [tile.box(500.0) for tile in tiles_of((-500, -500, 1000, 1000), 500.0)]
    assert np.sum([holds(box, xy) for box in boxes], axis=0).tolist() == [1, 1, 1, 1]
    assert tile_at(-1e-9, 0.0, 500.0) == Tile(0, 0)


def test_tiles_follow_each_other_closely():
    order = in_order(tiles_of((-1000, -1000, 1000, 1000), 500.0))
    assert len(set(order)) == 16
    quarters = [
        {(tile.column < 0, tile.row < 0) for tile in order[k : k + 4]} for k in (0, 4, 8, 12)
    ]
    assert all(len(quarter) == 1 for quarter in quarters)


def test_four_tiles_own_what_one_city_of_their_windows_does(order_and_map, built_tiles, town_map):
    order = order_and_map[0]
    whole = read_osm(town_map, frame=order.frame, box=(-500, -500, 500, 500))
    done = whole.stages_done | {"terrain"}
    whole = built(replace(whole, lod=1, stages_done=done), order.items)
    parts = cities(built_tiles)
    for layer, table in whole.scene.instances.items():
        own = [part.scene.instances[layer] for part in parts if layer in part.scene.instances]
        ids = np.concatenate([rows.object_id for rows in own])
        assert sorted(ids.tolist()) == sorted(table.object_id.tolist()), layer
    shells = whole.scene.meshes["buildings"]
    own = [part.scene.meshes["buildings"] for part in parts if "buildings" in part.scene.meshes]
    assert sum(batch.count for batch in own) == shells.count
    assert sum(len(batch.faces) for batch in own) == len(shells.faces)


def test_the_ground_of_tiles_fills_them_without_overlap(built_tiles):
    for city in cities(built_tiles):
        ground = city.ground
        area = np.abs(shapely.area(shapely.polygons(ground.vertices[ground.triangles]))).sum()
        west, south, east, north = city.layout.extent
        assert abs(area - (east - west) * (north - south)) < 0.01 * area
        assert (ground.vertices >= (west, south)).all()
        assert (ground.vertices <= (east, north)).all()
        assert (ground.edge_faces < len(ground.face_label)).all()


def test_what_a_tile_owns_alone_it_owns_again(built_tiles):
    city = cities(built_tiles)[0]
    again = owned(city, city.layout.extent)
    assert len(again.layout.buildings) == len(city.layout.buildings)
    assert {n: t.count for n, t in again.scene.instances.items()} == {
        n: t.count for n, t in city.scene.instances.items()
    }
