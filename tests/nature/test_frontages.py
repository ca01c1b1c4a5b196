"""Edges between walks and the land before houses."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
import shapely

from cityx.city import Frame, Instances, Prototype, make_table
from cityx.city.mesh import empty_batch
from cityx.ground.pieces import ways_to_doors
from cityx.nature.land.barriers import barriers
from cityx.nature.land.frontages import GATE, _plots, frontage_edges
from cityx.places.profiles import profile_named
from cityx.road.ground.ground_surface import ground
from cityx.road.network.network import network

TOKYO = Frame(35.69, 139.78)


def one_door(at):
    count = len(at)
    return [Prototype("door_panel", "door", empty_batch())], Instances(
        np.zeros(count, np.int32), np.arange(1, count + 1, dtype=np.uint64),
        np.zeros(count, np.uint64), np.column_stack([at, np.full(count, 0.12)]),
        np.zeros((count, 3), np.float32), np.ones((count, 3), np.float32),
        np.ones((count, 3), np.float32),
    )  # fmt: skip


@pytest.fixture(scope="module")
def town(crossroads):
    """A street whose houses stand 9 m from the kerb, a door in each."""

    city = replace(crossroads, frame=TOKYO, network=None)
    layout = city.layout
    houses = [shapely.box(x, 14, x + 14, 30) for x in (-90, -72, -54, -36, 22, 40, 58, 76)]
    ids = np.arange(101, 101 + len(houses))
    shells = make_table("buildings", houses, id=ids, levels=[3] * len(ids), height=[9.0] * len(ids),
                        place=["urban"] * len(ids))  # fmt: skip
    parts = make_table("parts", houses, id=ids, building=ids, base=[0.0] * len(ids),
                       top=[9.0] * len(ids), walls=[True] * len(ids))  # fmt: skip
    layout = replace(layout, buildings=shells, parts=parts, areas=layout.areas.iloc[:0],
                     lines=layout.lines.iloc[:0], points=layout.points.iloc[:0])  # fmt: skip
    city = ground(network(replace(city, layout=layout)))
    doors = np.array([[house.centroid.x, 14.0] for house in houses])
    return replace(city, scene=city.scene.with_instances("doors", *one_door(doors)))


def test_plots_are_closed_off_plot_by_plot(town):
    edges = frontage_edges(town)
    assert len(edges.lines) >= 4
    assert set(edges.kind) <= set(profile_named("jp").land.soft_edges)
    assert len(set(edges.id.tolist())) >= 4
    assert shapely.length(edges.lines).max() < 20.0


def test_edges_stand_behind_the_walk_and_leave_doors_and_gaps(town):
    edges = frontage_edges(town)
    points = shapely.get_coordinates(shapely.segmentize(edges.lines, 0.5))
    assert not town.ground.on(points, "sidewalk", "carriageway").any()
    gap = shapely.distance(ways_to_doors(town)[:, None], edges.lines[None])
    assert gap.min() > 0.9
    other = shapely.distance(edges.lines[:, None], edges.lines[None])
    apart = edges.id[:, None] != edges.id[None]
    assert other[apart].min() > GATE


def test_they_are_the_same_every_time_and_are_built(town):
    one, again = frontage_edges(town), frontage_edges(town)
    assert shapely.equals_exact(one.lines, again.lines).all()
    assert one.id.tolist() == again.id.tolist()
    built = barriers(town).scene.meshes["barriers"]
    assert set(built.object_id.tolist()) <= set(one.id.tolist())
    assert built.count >= 4


def test_without_doors_there_are_none(town):
    bare = replace(town.scene, instances={})
    assert not len(frontage_edges(replace(town, scene=bare)).lines)


def test_a_side_that_moves_leaves_the_plots_of_the_other_sides_alone():
    def plots(width):
        ring = np.array([(0.0, 0.0), (width, 0.0), (width, 60.0), (0.0, 60.0), (0.0, 0.0)])
        sides = np.stack([ring[:-1], ring[1:]], axis=1)
        lines = _plots(sides, np.array([shapely.Polygon(ring)], object))
        return {lines.points[a:b].tobytes() for a, b in pairwise(lines.start)
                if lines.points[a:b, 0].max() < 70}  # fmt: skip

    before, after = plots(100.0), plots(99.75)
    assert len(before) >= 14
    assert before == after
