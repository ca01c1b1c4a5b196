"""Colliders fit what they stand for, things weigh what they do, and each can be told apart."""

from dataclasses import replace

import numpy as np
import pytest

from cityx.assets.colliders import bodies_of, class_of, collider_of, motion_of, shapeless
from cityx.assets.furniture.street_furniture import MAKERS, furniture
from cityx.assets.styles.materials import LOOSE, MATERIALS, SUBSTANCES
from cityx.assets.trees.plants import tree
from cityx.assets.vehicles.car_bodies import BODIES
from cityx.assets.vehicles.vehicles import car
from cityx.city.bodies import FORM, MOTION, colliders_of, take_bodies
from cityx.city.mesh import one_mesh
from cityx.city.mesh_measures import volume
from cityx.city.scene import Scene
from cityx.city.store import read_city
from cityx.city.tracks import GAIT, MOVER, no_tracks
from cityx.geometry.convex import hull_of
from cityx.options import BuildOptions
from cityx.projects.build import build

STRAY = 0.02  # metres over a collider that a vertex may lie without counting as outside
OUTSIDE = 0.01  # share of vertices that may
BOATS = {"barge", "motor_boat", "rowing_boat"}


@pytest.fixture(scope="module")
def town(town_map, tmp_path_factory):
    out = tmp_path_factory.mktemp("bodies") / "town"
    settings = ("parked_cars.occupancy=1",)
    build([town_map], out, BuildOptions(formats=(), render=False, settings=settings))
    return read_city(out / "city")


@pytest.fixture(scope="module")
def bodies(town):
    return bodies_of(town.scene)


def hulls_of(shapes, shape):
    parts = shapes.parts(shape)
    return [hull_of(shapes.corners(part)) for part in range(parts.start, parts.stop)]


def share_outside(hulls, points):
    return float((np.min([hull.outside(points) for hull in hulls], axis=0) > STRAY).mean())


@pytest.mark.parametrize("name", sorted(MAKERS))
def test_colliders_of_furniture_hold_it_and_little_air(name):
    piece = furniture(name)
    solids = collider_of(piece)
    shapes = colliders_of([solids])
    above = piece.mesh.vertices[piece.mesh.vertices[:, 2] >= 0]
    assert share_outside(hulls_of(shapes, 0), above) <= OUTSIDE
    whole = hull_of(piece.mesh.vertices)
    assert len(solids) <= 6
    filled = sum(solid.volume for solid in solids)
    assert filled <= (2.0 if class_of(piece) == "litter_bin" else 1.25) * whole.volume


@pytest.mark.parametrize("body", BODIES)
def test_a_car_weighs_about_a_tonne_or_two_and_stands_on_tyres(body):
    piece = car(body, country="gb", number=1)
    solids = collider_of(piece)
    assert 850 < shapeless([piece])[0].mass < 2200
    assert motion_of(piece) == "free"
    hulls = hulls_of(colliders_of([solids]), 0)
    assert share_outside(hulls, piece.mesh.vertices) <= OUTSIDE
    assert min(hull.points[:, 2].min() for hull in hulls) == pytest.approx(0.0, abs=0.01)
    assert sum(hull.volume for hull in hulls) < 1.2 * hull_of(piece.mesh.vertices).volume


@pytest.mark.parametrize(
    ("name", "low", "high"),
    [("bench", 35, 80), ("waste_basket", 12, 40), ("wheelie_bins", 20, 50), ("bicycle", 8, 20),
     ("bollard", 5, 40), ("street_lamp_mast", 60, 250), ("picnic_table", 40, 120),
     ("planter", 200, 1200), ("bus", 9000, 15_000)],
)  # fmt: skip
def test_things_weigh_what_they_do(name, low, high):
    piece = furniture(name)
    assert low <= shapeless([piece])[0].mass <= high


def test_an_arm_of_a_lamp_leaves_the_air_below_it_free():
    hulls = hulls_of(colliders_of([collider_of(furniture("street_lamp_mast"))]), 0)
    vertices = furniture("street_lamp_mast").mesh.vertices
    head = vertices[np.argmax(np.abs(vertices[:, 1]))]
    below = np.array([[*head[:2], 2.0]])
    assert min(hull.outside(below)[0] for hull in hulls) > 0.5


def test_every_material_is_a_substance():
    assert {m.root for m in MATERIALS.values()} == set(SUBSTANCES)


def test_every_object_of_the_scene_is_a_body_with_its_id(town, bodies):
    scene = town.scene
    wanted = [b.object_id[np.diff(b.face_start) > 0] for b in scene.meshes.values()]
    wanted += [rows.object_id for rows in scene.instances.values()]
    assert sorted(bodies.object_id.tolist()) == sorted(np.concatenate(wanted).tolist())
    assert (bodies.mass >= 0).all()
    assert np.isfinite(bodies.mass).all()
    for values in (bodies.friction, bodies.restitution):
        assert ((values >= 0) & (values <= 1)).all()


def test_parked_cars_benches_and_doors_are_objects_of_their_own(town, bodies):
    cars, doors = bodies.of_kind("car"), bodies.of_kind("door")
    loose = bodies.of_kind(*LOOSE) | cars
    assert cars.sum() > 3
    assert bodies.of_kind("bench").any()
    assert len(np.unique(bodies.object_id[loose | doors])) == (loose | doors).sum()
    assert (bodies.motion[loose] == MOTION["free"]).all()
    assert (bodies.motion[doors] == MOTION["hinge"]).all()
    assert not bodies.owner[loose].any()
    assert np.isin(bodies.owner[doors], town.layout.buildings["id"].to_numpy()).all()
    assert (bodies.movable == loose).all()


def test_shells_are_convex_parts_of_their_volume(town, bodies):
    batch = town.scene.meshes["buildings"]
    own = take_bodies(bodies, bodies.of_kind("building"))
    parts = np.add.reduceat(own.colliders.volume, own.colliders.part_start[:-1])
    assert (own.object_id == batch.object_id).all()
    assert (parts > 0.99 * volume(batch)).all()
    assert (parts < 1.3 * volume(batch)).all()
    for row in range(own.count):
        assert share_outside(hulls_of(own.colliders, row), batch.one(row).vertices) <= OUTSIDE


def test_the_ground_collides_by_its_faces(town, bodies):
    own = np.isin(bodies.object_id, town.scene.meshes["ground"].object_id)
    ground = take_bodies(bodies, own)
    assert (ground.colliders.form == FORM["mesh"]).all()
    assert not ground.mass.any()


def test_a_thing_twice_as_large_weighs_eight_times_as_much(town):
    rows = town.scene.instances["trees"]
    grown = replace(rows, scale=rows.scale * np.float32(2))
    bare = Scene(prototypes=town.scene.prototypes)
    small, large = (
        bodies_of(bare.with_instances("trees", bare.prototypes, r)) for r in (rows, grown)
    )
    np.testing.assert_allclose(large.mass, 8 * small.mass, rtol=1e-6)


def test_a_tunnel_is_not_filled():
    """A tube along x: its hull would close it."""
    ring = np.array([(-2, 0), (2, 0), (2, 3), (-2, 3)], float)
    outer = ring * 1.2 - (0, 0.3)
    points = [(x, *p) for x in (0.0, 20.0) for p in (*ring, *outer)]
    inner = [(i, 8 + i, 8 + (i + 1) % 4, (i + 1) % 4) for i in range(4)]
    skin = [(4 + i, 4 + (i + 1) % 4, 12 + (i + 1) % 4, 12 + i) for i in range(4)]
    ends = [(i, (i + 1) % 4, 4 + (i + 1) % 4, 4 + i) for i in range(4)]
    ends += [(8 + i, 12 + i, 12 + (i + 1) % 4, 8 + (i + 1) % 4) for i in range(4)]
    tube = one_mesh(5, points, inner + skin + ends, materials=("concrete",))
    found = bodies_of(Scene().with_mesh("structures", tube))
    assert (found.colliders.form == FORM["mesh"]).all()


def test_what_moves_is_driven_where_it_is_at_the_moment():
    tracks = replace(
        no_tracks(), object_id=np.array([7, 9], np.uint64),
        kind=np.array([MOVER["car"], MOVER["pedestrian"]], np.uint8),
        look=np.array(["car_sedan", "person"]), origin=np.array(["a", "a"]),
        tint=np.ones((2, 3), np.float32),
        size=np.array([(4.6, 1.8, 1.5), (0.5, 0.6, 1.7)], np.float32),
        sample_start=np.array([0, 2, 4]), time=np.array([0.0, 10, 0, 10]),
        position=np.array([(0, 0, 0), (10, 0, 0), (5, 5, 0), (5, 15, 0)], float),
        heading=np.zeros(4), speed=np.ones(4, np.float32),
        gait=np.full(4, GAIT["walk"], np.uint8), place=np.zeros(4, np.uint64),
    )  # fmt: skip
    found = bodies_of(Scene(), tracks, 5.0)
    assert found.object_id.tolist() == [7, 9]
    assert found.mass.tolist() == [1400.0, 75.0]
    np.testing.assert_allclose(found.position, [(5, 0, 0), (5, 10, 0)])
    assert (found.motion == MOTION["driven"]).all()
    assert found.colliders.form[found.colliders.part_start[found.shape]].tolist() == [
        FORM["box"], FORM["cylinder"],
    ]  # fmt: skip


def test_the_same_scene_gives_the_same_bodies(town, bodies):
    again = bodies_of(town.scene)
    for name in ("points", "center", "half"):
        one, other = getattr(bodies.colliders, name), getattr(again.colliders, name)
        assert one.tobytes() == other.tobytes()
    assert again.mass.tobytes() == bodies.mass.tobytes()


@pytest.mark.parametrize("form", ["near", "light"])
def test_a_tree_is_a_stem_under_a_crown_in_every_form(form):
    stem, crown = collider_of(tree("lime", 0, form))
    assert 0.1 < stem.radius < 0.6
    assert crown.points[:, 2].min() > 2 * stem.half_height - 0.1 > 1.5
