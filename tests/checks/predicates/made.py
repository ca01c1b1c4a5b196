"""A small made city that every predicate can be tried on, and ways to change it."""

from dataclasses import replace

import numpy as np
import shapely

from cityx.city import City, Environment, Frame, Instances, Layout, Prototype, Scene, one_mesh
from cityx.city.ground import KERB_HEIGHT
from cityx.city.layout import make_table
from cityx.city.mesh import concatenate
from cityx.ids import stable_id

SITE = (0.0, 0.0, 400.0, 400.0)
SIDES = [[3, 2, 1, 0], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
# x, y, width, depth, height, levels, use, generator, wall
HOUSES = (
    (20.0, 20.0, 14.0, 12.0, 9.0, 3, "house", "suburban_house", "plaster"),
    (60.0, 20.0, 14.0, 12.0, 6.0, 2, "house", "cottage", "brick"),
    (100.0, 20.0, 14.0, 12.0, 6.0, 2, "house", "suburban_house", "plaster"),
    (20.0, 260.0, 25.0, 25.0, 90.0, 25, "office", "glass_tower", "glass_wall"),
    (100.0, 260.0, 25.0, 25.0, 120.0, 33, "office", "glass_tower", "glass_wall"),
    (20.0, 340.0, 25.0, 25.0, 60.0, 16, "office", "glass_tower", "glass_wall"),
    (300.0, 20.0, 50.0, 40.0, 8.0, 1, "warehouse", "warehouse", "metal_panel"),
)


def ids_of(word, count):
    return np.array([stable_id("made", word, k) for k in range(count)], np.uint64)


def table(name, what, shapes, /, **columns):
    ids = ids_of(what, len(shapes))
    source = [f"made/{what[0]}{k + 1:02d}" for k in range(len(shapes))]
    return make_table(name, shapes, id=ids, source=source, **columns)


def houses(rows=HOUSES):
    shapes = [shapely.box(x, y, x + w, y + d) for x, y, w, d, *_ in rows]
    height, levels, use, generator = (
        [row[at] for row in rows] for at in (4, 5, 6, 7)
    )  # fmt: skip
    buildings = table(
        "buildings", "building", shapes, use=use, levels=levels, height=height,
        generator=generator,
    )  # fmt: skip
    parts = make_table(
        "parts", shapes, id=ids_of("part", len(rows)), building=ids_of("building", len(rows)),
        use=use, base=np.zeros(len(rows)), top=height, levels=levels,
        roof_shape=["flat"] * len(rows), walls=[True] * len(rows),
    )  # fmt: skip
    return buildings, parts


def shell(number, row, *, wall="", tint=(1.0, 1.0, 1.0), top=None):
    x, y, w, d, height, *_ = row
    ring = np.array([(x, y), (x + w, y), (x + w, y + d), (x, y + d)])
    high = (height if top is None else top) + KERB_HEIGHT
    vertices = [np.column_stack([ring, np.full(4, z)]) for z in (0.0, high)]
    return one_mesh(
        stable_id("made", "building", number), np.concatenate(vertices), SIDES,
        material=[1, 1, 0, 0, 0, 0], materials=(wall or row[8], "bitumen"), tint=tint,
    )  # fmt: skip


def streets():
    lines = [
        [(200.0, 0.0), (200.0, 400.0)], [(0.0, 100.0), (400.0, 100.0)],
        [(0.0, 240.0), (400.0, 240.0)], [(60.0, 100.0), (60.0, 240.0)],
        [(200.0, 320.0), (400.0, 320.0)],
    ]  # fmt: skip
    kinds = ["primary", "residential", "residential", "residential", "residential"]
    return table(
        "roads", "road", [shapely.LineString(line) for line in lines], kind=kinds,
        lanes=[8, 2, 2, 2, 2], width=[28.0, 6.0, 6.0, 6.0, 6.0],
        bridge=[False] * 5, name=["Main Street", "", "", "", ""],
    )  # fmt: skip


def crossing():
    """A road whose middle is a bridge over the river."""
    lines = [[(300.0, 100.0), (300.0, 150.0)], [(300.0, 150.0), (300.0, 190.0)],
             [(300.0, 190.0), (300.0, 240.0)]]  # fmt: skip
    return make_table(
        "roads", [shapely.LineString(line) for line in lines], id=ids_of("crossing", 3),
        source=["made/c01", "made/c02", "made/c03"], kind=["residential"] * 3, lanes=[2] * 3,
        width=[6.0] * 3, bridge=[False, True, False],
    )  # fmt: skip


def lands():
    shapes = [
        shapely.box(0.0, 155.0, 400.0, 185.0),  # a river of 30 m
        shapely.box(180.0, 190.0, 220.0, 230.0),  # a plaza in the middle
        shapely.box(220.0, 250.0, 390.0, 310.0).difference(shapely.box(280, 260, 320, 300)),
        shapely.box(280.0, 260.0, 320.0, 300.0),  # a lake in the park
        shapely.box(0.0, 0.0, 400.0, 10.0), shapely.box(20.0, 34.0, 60.0, 60.0),
    ]  # fmt: skip
    kinds = ["river", "pedestrian", "park", "water", "sand", "garden"]
    sea = shapely.box(0.0, -20.0, 400.0, 0.0)
    return table("areas", "area", [*shapes, sea], kind=[*kinds, "sea"])


def thing(name, kind, size, *, materials=("plaster",)):
    w, d, h = (side / 2 for side in size)
    corners = np.array([(x, y, z) for z in (0.0, 2 * h) for x, y in
                        ((-w, -d), (w, -d), (w, d), (-w, d))])  # fmt: skip
    return Prototype(name, kind, one_mesh(1, corners, SIDES, materials=materials))


TREE = thing("tree_lime_1_near", "tree", (4.0, 4.0, 8.0), materials=("bark", "foliage"))
SHRUB = thing("shrub_0", "tree", (1.0, 1.0, 1.0))
LAMP = thing("street_lamp_post", "furniture", (0.2, 0.2, 4.5), materials=("lamp_glow",))
CAR = thing("car_sedan", "vehicle", (1.8, 4.5, 1.5))
BUS = thing("bus", "vehicle", (2.5, 12.0, 3.0))
PERSON = thing("person_1", "person", (0.5, 0.4, 1.8))
NEON = thing("neon_board", "furniture", (2.0, 0.2, 1.0), materials=("signal_red",))


def rows_at(purpose, places, *, owner=0):
    count = len(places)
    xy = np.array(places, float).reshape(-1, 2)
    return Instances(
        np.zeros(count, np.int32),
        ids_of(purpose, count),
        np.full(count, owner, np.uint64),
        np.column_stack([xy, np.zeros(count)]),
        np.zeros((count, 3), np.float32),
        np.ones((count, 3), np.float32),
        np.ones((count, 3), np.float32),
    )


def with_things(city, layer, prototype, places, *, owner=0):
    rows = rows_at(layer, places, owner=owner)
    return replace(city, scene=city.scene.with_instances(layer, [prototype], rows))


def with_layout(city, **tables):
    return replace(city, layout=replace(city.layout, **tables))


def with_air(city, **values):
    return replace(city, environment=replace(city.environment, **values))


def with_shells(city, shells):
    return replace(city, scene=city.scene.with_mesh("buildings", concatenate(shells)))


def made_city():
    """Seven buildings, six streets with a bridge, a river, a park with a lake, trees and lamps."""
    from cityx.city.layout import joined_tables

    buildings, parts = houses()
    layout = Layout(SITE, buildings, parts, joined_tables(streets(), crossing()), lands())
    sun = Environment(
        sun_elevation=float(np.radians(40.0)), sun_azimuth=float(np.radians(200.0)), hour=15.0
    )
    city = City("Made", Frame(50.0, 10.0), layout, seed=3, scene=Scene(), environment=sun)
    city = with_shells(city, [shell(k, row) for k, row in enumerate(HOUSES)])
    along = [(185.0, float(y)) for y in range(5, 150, 10)]
    city = with_things(city, "trees", TREE, along)
    city = with_things(city, "lamps", LAMP, [(210.0, float(y)) for y in range(5, 155, 30)])
    return with_things(city, "vehicles", CAR, [(150.0, 96.0), (160.0, 96.0)])


def without(city, name, rows):
    """The city without some rows of a table of its layout, and without their shells."""
    old = getattr(city.layout, name)
    kept = np.ones(len(old), bool)
    kept[rows] = False
    changed = with_layout(city, **{name: old[kept].reset_index(drop=True)})
    batch = city.scene.meshes.get("buildings")
    if name != "buildings" or batch is None:
        return changed
    lost = np.isin(batch.object_id, old["id"].to_numpy()[~kept])
    return replace(
        changed, scene=changed.scene.with_mesh("buildings", batch.take(np.flatnonzero(~lost)))
    )


def edited(city, name, column, rows, value):
    """The city with other values in a column of a table of its layout."""
    old = getattr(city.layout, name).copy()
    values = old[column].to_numpy().astype(object)
    values[rows] = value
    old[column] = values
    old[column] = old[column].astype(getattr(city.layout, name)[column].dtype)
    return with_layout(city, **{name: old})


def row_of(city, name, source):
    """The row of a table with a source."""
    return int(np.flatnonzero((getattr(city.layout, name)["source"] == source).to_numpy())[0])


def moved(city, name, source, x, y):
    """The city with one shape of a table moved; what stands in the scene stays."""
    old = getattr(city.layout, name)
    shapes = old.geometry.to_numpy().copy()
    at = row_of(city, name, source)
    shapes[at] = shapely.transform(shapes[at], lambda p: p + np.array([x, y]))
    return with_layout(city, **{name: old.set_geometry(shapes)})
