"""A way that carries two things is two things, each with an id of its own."""

import json

import numpy as np
import pytest
import shapely

import cityx


def two(layout):
    """Return kinds of roads, areas and lines by their sources, sorted."""
    found = {}
    for table in (layout.roads, layout.areas, layout.lines):
        for source, kind in zip(table["source"], table["kind"], strict=True):
            found.setdefault(source, []).append(kind)
    return {source: sorted(kinds) for source, kinds in found.items()}


def ids_differ(layout):
    tables = (layout.buildings, layout.roads, layout.areas, layout.lines)
    ids = np.concatenate([table["id"].to_numpy() for table in tables])
    return len(np.unique(ids)) == len(ids)


@pytest.mark.parametrize(
    ("tags", "kinds"),
    [
        ({"highway": "secondary", "railway": "tram"}, ["secondary", "tram"]),
        ({"highway": "busway", "railway": "light_rail", "oneway": "yes"}, ["busway", "light_rail"]),
        ({"highway": "cycleway", "railway": "rail", "gauge": "760"}, ["cycleway", "rail"]),
        ({"highway": "pedestrian", "railway": "tram", "width": "9"}, ["pedestrian", "tram"]),
        ({"highway": "proposed", "railway": "tram"}, ["tram"]),
        ({"highway": "footway", "railway": "abandoned"}, ["footway"]),
        ({"highway": "tram", "railway": "disused"}, []),
        ({"highway": "footway", "barrier": "hedge"}, ["footway", "hedge"]),
        ({"highway": "residential", "barrier": "wall", "height": "2"}, ["residential", "wall"]),
    ],
)
def test_a_way_that_carries_two_things_is_two_things(drawing, tags, kinds):
    drawing.box(20, 20, 10, 10, building="house")
    way = drawing.way([(0, 0), (80, 0)], **tags)
    layout = drawing.city().layout
    assert two(layout).get(f"osm/way/{way}", []) == kinds
    assert ids_differ(layout)


@pytest.mark.parametrize(
    ("tags", "kinds"),
    [
        ({"highway": "footway", "leisure": "park"}, ["footway", "park"]),
        ({"highway": "residential", "landuse": "grass"}, ["grass", "residential"]),
        ({"highway": "pedestrian", "place": "square"}, ["pedestrian", "pedestrian"]),
        ({"highway": "pedestrian", "area": "yes", "place": "square"}, ["pedestrian"]),
        ({"highway": "footway", "leisure": "track"}, ["footway"]),
        ({"barrier": "fence", "leisure": "pitch"}, ["fence", "pitch"]),
        ({"railway": "rail", "landuse": "railway"}, ["rail"]),
    ],
)
def test_a_ring_may_be_a_way_and_the_land_within(drawing, tags, kinds):
    drawing.box(60, 20, 10, 10, building="house")
    drawing.way([(-10, -10), (80, -10), (80, 60)], highway="service")
    way = drawing.box(0, 0, 40, 40, **tags)
    layout = drawing.city().layout
    assert two(layout)[f"osm/way/{way}"] == kinds
    assert ids_differ(layout)


def test_rails_take_their_own_tags_and_none_of_the_street(drawing):
    drawing.box(20, 20, 10, 10, building="house")
    street = {"lanes": "4", "width": "14", "oneway": "yes", "name": "High Street", "layer": "1"}
    drawing.way([(0, 0), (80, 0)], highway="primary", railway="tram", gauge="1000", **street)
    roads = drawing.city().layout.roads.set_index("kind")
    assert roads.loc["primary", "width"] == 14.0
    assert roads.loc["tram", "width"] < 4.0
    assert not roads.loc["tram", "oneway"]
    assert roads.loc["tram", "layer"] == roads.loc["primary", "layer"] == 1
    assert json.loads(roads.loc["tram", "tags"])["gauge"] == "1000"


def test_a_barrier_of_a_street_stands_at_its_edge_and_is_named(drawing):
    drawing.box(20, 30, 10, 10, building="house")
    drawing.way([(0, 0), (80, 0)], highway="residential", barrier="wall", width="6")
    city = drawing.city()
    street, wall = city.layout.roads.geometry.iloc[0], city.layout.lines.geometry.iloc[0]
    assert shapely.distance(street, wall) == pytest.approx(3.6)
    assert wall.centroid.y < street.centroid.y  # to the right of its direction
    assert any("the barrier stands at its right edge" in failure.error
               for failure in city.failures)  # fmt: skip


def test_rails_lie_on_every_arm_of_a_junction(drawing):
    drawing.box(30, 30, 10, 10, building="house")
    ends = [(-90, 0), (0, 90), (90, 0), (0, -90)]
    kinds = ["secondary", "busway", "residential", "living_street"]
    for end, kind in zip(ends, kinds, strict=True):
        drawing.way([(0, 0), end], highway=kind, railway="tram")
    city = cityx.build(drawing.file(), lod=1).city
    ground = city.ground
    rails = ground.triangles_of("tramway")
    middles = ground.vertices[rails].mean(axis=1)[:, :2]
    crossing = city.network.node_position[np.argmax(city.network.node_degree)]
    for end in ends:
        middle = crossing + np.array(end) / 2
        assert (np.abs(middles - middle).max(axis=1) < 35).any(), end
