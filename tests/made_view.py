"""Made scenes with known answers, for rays."""

import numpy as np

from cityx.city import City, Frame, Layout
from cityx.city.camera import Camera
from cityx.city.mesh import concatenate, one_mesh
from cityx.city.scene import Instances, Prototype, Scene
from cityx.city.store import view_of
from cityx.dataset.shots import Shot

GROUND, HOUSE, WINDOW, POST = 1, 2, 3, 4
BOX = [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]


def box(object_id, low, high, material="plaster"):
    """A closed box."""
    (a, b, c), (d, e, f) = low, high
    corners = [(x, y, z) for z in (c, f) for x, y in ((a, b), (d, b), (d, e), (a, e))]
    return one_mesh(object_id, corners, BOX, materials=(material,))


def plate(object_id, size, material="asphalt", height=0.0):
    """A level square about the origin."""
    s = size / 2
    corners = [(-s, -s, height), (s, -s, height), (s, s, height), (-s, s, height)]
    uv = [[(x, y) for x, y, _ in corners]]
    return one_mesh(object_id, corners, [[0, 1, 2, 3]], materials=(material,), uv=uv)


def pane(object_id, wide, high, material="glass"):
    """An upright rectangle that faces -y, its lower middle at the origin; uv in metres."""
    w = wide / 2
    corners = [(-w, 0, 0), (w, 0, 0), (w, 0, high), (-w, 0, high)]
    uv = [[(x, z) for x, _, z in corners]]
    return one_mesh(object_id, corners, [[0, 1, 2, 3]], materials=(material,), uv=uv)


def rows(*places, ids, owner=0, turn=0.0, scale=(1.0, 1.0, 1.0)):
    """Instances of the first prototype at places, turned about z."""
    n = len(places)
    rotation = np.zeros((n, 3), np.float32)
    rotation[:, 2] = turn
    return Instances(
        np.zeros(n, np.int32), np.array(ids, np.uint64), np.full(n, owner, np.uint64),
        np.array(places, float), rotation, np.tile(np.float32(scale), (n, 1)),
        np.ones((n, 3), np.float32),
    )  # fmt: skip


def view(scene, **more):
    """The view of a city that is a scene alone."""
    return view_of(City("Made", Frame(52.0, 13.0), Layout((-50, -50, 50, 50)), scene=scene, **more))


def street():
    """A house of 10 x 10 x 8 m with a window to the south, a post before it, and the ground."""
    window = Prototype("window_wide_0", "window", pane(0, 2.0, 1.5))
    post = Prototype("bollard", "furniture", box(0, (-0.1, -0.1, 0.0), (0.1, 0.1, 1.0)))
    scene = (
        Scene()
        .with_mesh("ground", plate(GROUND, 200.0))
        .with_mesh("buildings", box(HOUSE, (-5.0, 10.0, 0.0), (5.0, 20.0, 8.0)))
    )
    scene = scene.with_instances(
        "windows", [window], rows((0.0, 9.95, 2.0), ids=[WINDOW], owner=HOUSE)
    )
    return scene.with_instances("street_furniture", [post], rows((1.5, 4.0, 0.0), ids=[POST]))


def shot(position=(0.0, 0.0, 1.6), heading=0.0, pitch=0.0, *, width=64, height=48, hfov=1.2,
         moment=0.0):  # fmt: skip
    """A small picture, to the north."""
    camera = Camera("made", position, heading, pitch, hfov, width, height)
    return Shot("made", camera, "made", moment=moment)


__all__ = ["box", "concatenate", "pane", "plate", "rows", "shot", "street", "view"]
