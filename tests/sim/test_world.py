"""A world holds what its city does, and what it offers to vehicles is free for them."""

from dataclasses import fields, replace

import numpy as np
import pytest
import shapely

from cityx.assets.colliders import bodies_of
from cityx.city import Layout
from cityx.city.store import read_city
from cityx.errors import InputError, UsageError
from cityx.geometry.ranges import ranges
from cityx.sim.compile.rasters import BIT, frame_of
from cityx.sim.compile.worlds import compile_world
from cityx.sim.dynamics import VEHICLE, VEHICLES
from cityx.sim.places import world_of
from cityx.sim.world import VERSION, World, certificate, read_world, write_kept


@pytest.fixture(scope="module")
def city(town):
    return read_city(town / "city")


def bodies_on(world, piece, vehicle):
    """(k,) polygons of a vehicle along a piece, its two axles on the line."""
    points = world.point[slice(*world.point_start[piece : piece + 2])]
    line = shapely.LineString(points[:, :2])
    half, found = vehicle.wheelbase / 2, []
    for along in points[:, 4]:
        if half < along < line.length - half:
            ends = [line.interpolate(along + side * half) for side in (-1, 1)]
            (ax, ay), (bx, by) = ((end.x, end.y) for end in ends)
            way = np.array([bx - ax, by - ay]) / np.hypot(bx - ax, by - ay)
            middle, left = np.array([ax + bx, ay + by]) / 2, np.array([-way[1], way[0]])
            corners = [middle + u * way * vehicle.length / 2 + v * left * vehicle.width / 2
                       for u, v in ((1, 1), (-1, 1), (-1, -1), (1, -1))]  # fmt: skip
            found.append(shapely.Polygon(corners))
    return np.array(found, object)


def test_a_world_comes_back_from_its_file_to_the_bit(world, tmp_path):
    write_kept(world, tmp_path / "world.npz")
    again = read_world(tmp_path / "world.npz")
    for each in fields(World):
        assert np.array_equal(getattr(world, each.name), getattr(again, each.name)), each.name
    assert again.facts["version"] == VERSION


def test_compiling_twice_gives_the_same_world(city, world):
    again = compile_world(city, world.hash)
    for each in fields(World):
        assert np.array_equal(getattr(world, each.name), getattr(again, each.name)), each.name


def test_where_a_car_is_certified_it_touches_no_body_of_the_city(city, world):
    # Read from the bodies of the city, not from the segments that the world was compiled to.
    bodies = bodies_of(city.scene)
    solid = np.flatnonzero(~bodies.of_kind("ground", "terrain", "window", "roof_furniture"))
    found = []
    for row in solid.tolist():
        for part in range(*bodies.colliders.part_start[bodies.shape[row] :][:2]):
            if bodies.colliders.form[part] == 3 or bodies.scale[row].min() <= 0:
                continue
            corners = bodies.colliders.corners(part) * bodies.scale[row]
            c, s = np.cos(bodies.rotation[row, 2]), np.sin(bodies.rotation[row, 2])
            placed = corners @ [[c, s, 0], [-s, c, 0], [0, 0, 1]] + bodies.position[row]
            if placed[:, 2].min() < 1.4 and placed[:, 2].max() > 0.4:
                found.append(shapely.convex_hull(shapely.multipoints(placed[:, :2])))
    tree = shapely.STRtree(found)
    car = VEHICLES[VEHICLE["car"]]
    for piece in np.flatnonzero(world.fits(VEHICLE["car"])).tolist():
        boxes = bodies_on(world, piece, car)
        hit = tree.query(boxes, predicate="intersects") if len(boxes) else np.zeros((2, 0))
        depth = shapely.area(shapely.intersection(boxes[hit[0]], np.array(found)[hit[1]]))
        assert (depth < 0.05).all(), piece


def test_what_stops_a_vehicle_is_named(city, world):
    known = {int(i) for b in city.scene.meshes.values() for i in b.object_id}
    known |= {int(i) for rows in city.scene.instances.values() for i in rows.object_id}
    named = {int(each) for each in world.piece_block.ravel() if each > 2}
    assert named <= known
    stopped = world.piece_vehicle < len(VEHICLES)
    assert (world.piece_block[stopped].max(axis=1) > 0).all()


def test_larger_vehicles_fit_along_no_more_metres(world):
    metres = list(certificate(world).by_vehicle.values())
    assert metres == sorted(metres, reverse=True)
    assert metres[VEHICLE["car"]] > 0.9 * certificate(world).metres > 300


def test_pieces_lead_on_where_the_one_before_ends(world):
    rows, start = ranges(world.next_start.astype(np.int64), np.arange(world.count))
    before = np.repeat(np.arange(world.count), np.diff(start))
    end = world.point[world.point_start[1:][before] - 1]
    begin = world.point[world.point_start[:-1][world.next[rows]]]
    assert np.abs(end[:, :3] - begin[:, :3]).max() < 0.25
    assert world.across[before].sum() == world.across.sum()


def test_ways_across_on_which_vans_would_touch_are_not_used_at_once(world):
    pieces, van = np.flatnonzero(world.across), VEHICLES[VEHICLE["van"]]
    bodies = {int(n): bodies_on(world, n, van) for n in pieces}
    swept = {n: shapely.union_all(each) for n, each in bodies.items() if len(each)}
    tried = 0
    for one in swept:
        known = set(world.conflict[slice(*world.conflict_start[one : one + 2])].tolist())
        for other in swept:
            apart = world.piece_junction[one] != world.piece_junction[other]
            if one == other or apart or world.piece_lane[one] == world.piece_lane[other]:
                continue
            if shapely.intersection(swept[one], swept[other]).area > 0.5:
                tried += 1
                assert other in known, (one, other)
    assert tried > 10


def test_cars_share_no_ground_in_the_middle_of_a_lane(world):
    car = VEHICLES[VEHICLE["car"]]
    used = world.piece_public & ~world.piece_narrow & world.fits(VEHICLE["car"])
    lanes = [int(n) for n in np.flatnonzero(used & ~world.across)]
    bodies = {n: bodies_on(world, n, car) for n in lanes}
    swept = {n: shapely.union_all(each) for n, each in bodies.items() if len(each)}
    for one, ground in swept.items():
        for other, its in swept.items():
            if one < other:
                assert shapely.intersection(ground, its).area < 1.0, (one, other)


def test_a_site_that_is_too_large_is_refused_before_its_rasters_are_made(city):
    wide = replace(city, layout=replace(city.layout, extent=(-3e4, -3e4, 3e4, 3e4)))
    with pytest.raises(InputError, match=r"its site has 3600 km2, 2500 are not. Build a part"):
        frame_of(wide)


def test_clearance_is_never_more_than_what_is_free(world):
    rng = np.random.default_rng(1)
    columns, rows = world.raster_frame[3:].astype(int)
    i, j = rng.integers(columns, size=400), rng.integers(rows, size=400)
    frame = world.raster_frame
    place = np.column_stack([frame[0] + (i + rng.random(400)) * frame[2],
                             frame[1] + (j + rng.random(400)) * frame[2]])  # fmt: skip
    lines = shapely.linestrings(np.asarray(world.segment[:, :4], float).reshape(-1, 2, 2))
    away = shapely.distance(shapely.points(place), shapely.multilinestrings(lines))
    assert (world.clear.at(j, i) / 10.0 <= away + 1e-3).all()


def test_lanes_lie_on_the_roadway_of_the_raster(world):
    lanes = np.repeat(~world.across & world.fits(1), np.diff(world.point_start))
    frame = world.raster_frame
    column = ((world.point[:, 0] - frame[0]) // frame[2]).astype(int)
    row = ((world.point[:, 1] - frame[1]) // frame[2]).astype(int)
    inside = lanes & (column >= 0) & (row >= 0) & (column < frame[3]) & (row < frame[4])
    on = world.flags.at(row[inside], column[inside]) & (BIT["roadway"] | BIT["deck"])
    assert (on != 0).mean() > 0.99


def test_a_place_that_is_none_is_refused_in_a_sentence(tmp_path, town):
    with pytest.raises(InputError, match=r"There is no place .*nowhere"):
        world_of(tmp_path / "nowhere")
    with pytest.raises(InputError, match="holds no built city"):
        world_of(tmp_path)
    with pytest.raises(UsageError, match="place is int"):
        world_of(7)
    with pytest.raises(UsageError, match="is built"):
        world_of(town, text="a market")


def test_a_city_without_streets_has_no_lane(city):
    bare = replace(city, layout=Layout(city.layout.extent), network=None, lanes=None)
    with pytest.raises(InputError, match="has no lane for cars"):
        compile_world(bare, "0")
