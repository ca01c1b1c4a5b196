"""A small made city: what plugins are tried on."""

from __future__ import annotations

import numpy as np
import shapely

from cityx.city.city import City
from cityx.city.frame import Frame
from cityx.city.layout import Layout, make_table
from cityx.city.mesh import concatenate, one_mesh
from cityx.city.scene import Instances, Prototype, Scene
from cityx.city.terrain import Terrain
from cityx.ids import stable_id

_HOUSES = (  # x, y, width, depth, height, use
    (-45.0, 12.0, 20.0, 14.0, 9.0, "house"),
    (-15.0, 12.0, 24.0, 16.0, 18.0, "apartments"),
    (18.0, 14.0, 30.0, 20.0, 30.0, "office"),
    (20.0, -40.0, 26.0, 24.0, 12.0, "retail"),
)
_ROADS = (
    ("residential", [(-80.0, 0.0), (0.0, 0.0), (80.0, 2.0)], 6.5),
    ("secondary", [(0.0, -80.0), (0.0, 0.0), (-2.0, 80.0)], 10.0),
    ("footway", [(-60.0, -60.0), (-30.0, -30.0), (0.0, 0.0)], 2.5),
)
_TREES = ((-60.0, -20.0), (-50.0, -20.0), (-40.0, -22.0), (60.0, 30.0))


def example_city(*, seed: int = 7, built: bool = False) -> City:
    """Make a city of four buildings, three roads, a pond in a park, trees and a fence.

    Parameters
    ----------
    seed
        Its seed.
    built
        Whether its scene already holds a block per building and an instance per tree, so that
        edits have something to change.
    """
    city = City(
        "Example",
        Frame(60.17, 24.94),
        _layout(),
        seed=seed,
        terrain=_terrain(),
        attribution=("made for examples",),
        stages_done=frozenset({"layout", "terrain"}),
    )
    if not built:
        return city
    return City(**{**vars(city), "scene": _scene(city)})


def _layout() -> Layout:
    shapes = [shapely.box(x, y, x + w, y + d) for x, y, w, d, _, _ in _HOUSES]
    # One outline with a courtyard, since many generators stumble over holes.
    yard = shapely.box(28.0, -32.0, 38.0, -24.0).exterior
    shapes[3] = shapely.Polygon(shapes[3].exterior, [yard])
    shapes = list(shapely.orient_polygons(np.array(shapes)))
    ids = [stable_id("example", "building", i) for i in range(4)]
    source = [f"example/building/{i}" for i in range(4)]
    height = [house[4] for house in _HOUSES]
    levels = [round(h / 3) for h in height]
    use = [house[5] for house in _HOUSES]
    buildings = make_table(
        "buildings", shapes, id=ids, source=source, use=use, levels=levels, height=height,
        name=["", "", "The Tower", ""], place=["urban"] * 4,
    )  # fmt: skip
    parts = make_table(
        "parts", shapes, id=[stable_id("example", "part", i) for i in range(4)], building=ids,
        use=use, base=[0.0] * 4, top=height, levels=levels,
        roof_shape=["gabled", "hipped", "flat", "flat"], roof_height=[3.0, 4.0, 0.0, 0.0],
        roof_direction=[np.nan] * 4, walls=[True] * 4, wall_color=[-1] * 4, roof_color=[-1] * 4,
    )  # fmt: skip
    width = [road[2] for road in _ROADS]
    roads = make_table(
        "roads", [shapely.LineString(road[1]) for road in _ROADS],
        id=[stable_id("example", "road", i) for i in range(3)],
        source=[f"example/road/{i}" for i in range(3)], kind=[road[0] for road in _ROADS],
        name=["Long Street", "High Street", ""], lanes=[2, 2, 0], lanes_forward=[1, 1, 0],
        lane_width=[3.25, 3.5, 0.0], width=width, sidewalk_left=[2.0, 2.5, 0.0],
        sidewalk_right=[2.0, 2.5, 0.0], surface=["asphalt", "asphalt", "gravel"],
        lit=[True, True, False], maxspeed_kmh=[30.0, 50.0, 5.0],
    )  # fmt: skip
    areas = make_table(
        "areas", [shapely.box(-75, -70, -20, -12), shapely.Point(-45, -45).buffer(8)],
        id=[stable_id("example", "area", i) for i in range(2)],
        source=["example/area/0", "example/area/1"], kind=["park", "water"],
        name=["The Park", "The Pond"],
    )  # fmt: skip
    lines = make_table(
        "lines", [shapely.LineString([(-76, -71), (-19, -71)])], height=[1.5],
        id=[stable_id("example", "line", 0)], source=["example/line/0"], kind=["fence"],
    )  # fmt: skip
    kinds = ["tree"] * len(_TREES) + ["bench", "street_lamp"]
    places = [*_TREES, (-30.0, -40.0), (5.0, 8.0)]
    count = len(kinds)
    points = make_table(
        "points", shapely.points(np.array(places)),
        id=[stable_id("example", "point", i) for i in range(count)],
        source=[f"example/point/{i}" for i in range(count)], kind=kinds,
        height=[np.nan] * count, direction=[np.nan] * count,
    )  # fmt: skip
    return Layout((-80.0, -80.0, 80.0, 80.0), buildings, parts, roads, areas, lines, points)


def _terrain() -> Terrain:
    x, y = np.meshgrid(np.linspace(-90, 90, 19), np.linspace(-90, 90, 19))
    return Terrain((-90.0, -90.0), 10.0, 2.0 * np.sin(x / 60) + y / 45)


def _scene(city: City) -> Scene:
    rows = city.layout.buildings
    blocks = []
    corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
    for shape, object_id, height in zip(rows.geometry, rows["id"], rows["height"], strict=True):
        box = np.array(shape.bounds)
        ring = box[:2] + corners * (box[2:] - box[:2])
        base = float(city.terrain.height_at(ring).min())
        low = np.column_stack([ring, np.full(4, base)])
        high = np.column_stack([ring, np.full(4, base + height)])
        faces = [[3, 2, 1, 0], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
        blocks.append(one_mesh(int(object_id), np.concatenate([low, high]), faces))
    scene = Scene().with_mesh("buildings", concatenate(blocks))
    cone = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0], [0, 0, 6.0]])
    sides = [[0, 1, 4, -1], [1, 2, 4, -1], [2, 3, 4, -1], [3, 0, 4, -1], [3, 2, 1, 0]]
    tree = Prototype("tree_cone", "tree", one_mesh(1, cone, sides, materials=("leaf",)))
    points = city.layout.points
    points = points[points["kind"] == "tree"]
    xy = shapely.get_coordinates(points.geometry.to_numpy())
    count = len(xy)
    trees = Instances(
        np.zeros(count, np.int32),
        points["id"].to_numpy(np.uint64),
        np.zeros(count, np.uint64),
        np.column_stack([xy, city.terrain.height_at(xy)]),
        np.zeros((count, 3), np.float32),
        np.ones((count, 3), np.float32),
        np.ones((count, 3), np.float32),
    )
    return scene.with_instances("trees", [tree], trees)
