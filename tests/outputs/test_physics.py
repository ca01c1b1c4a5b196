"""The bodies of a city in a real physics engine: at rest they rest, pushed they obey F = m a."""

import numpy as np
import pytest
from copies import copy_of

from cityx.assets.colliders import bodies_of
from cityx.city.store import read_city, read_view
from cityx.ids import id_text
from cityx.outputs.body_files import read_bodies, write_bodies, write_mjcf
from cityx.projects.views import make_views

SETTLE = 2.0  # seconds
STILL = 0.05  # metres that a thing at rest may move meanwhile
OFF = 0.05  # share of a push by which the engine's soft contacts may miss
PUSH = 1.0  # metres per second squared that is left of a push after friction


@pytest.fixture(scope="module")
def built(scene_folder, tmp_path_factory):
    """Make the folder of a base scene with the bodies of its things."""

    def with_bodies(name):
        folder = copy_of(scene_folder(name), tmp_path_factory.mktemp("bodies") / name)
        make_views(read_city(folder / "city"), folder, ("bodies",), say=print)
        return folder

    return with_bodies


@pytest.fixture(scope="module")
def river(built):
    """Two banks with parked cars."""
    return built("river_s")


@pytest.fixture(scope="module")
def park(built):
    """A park and a plaza with benches, bins and planters."""
    return built("park_s")


def test_bodies_are_written_beside_the_city_and_read_back(river):
    found = read_bodies(river / "city_bodies.npz")
    wanted = bodies_of(read_city(river / "city").scene)
    assert found.kinds == wanted.kinds
    for name in ("object_id", "mass", "motion", "shape", "position", "friction"):
        assert getattr(found, name).tobytes() == getattr(wanted, name).tobytes()
    assert found.colliders.points.tobytes() == wanted.colliders.points.tobytes()


def test_the_same_city_gives_the_same_file(river, tmp_path):
    view = read_view(river / "city")
    for name in ("a", "b"):
        write_bodies(view, tmp_path / f"{name}.npz")
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()


class World:
    """A piece of a city in MuJoCo; a class because its state goes on."""

    def __init__(self, folder, kind, tmp_path, reach=25.0):
        self.mujoco = pytest.importorskip("mujoco", reason="mujoco is not installed")
        scene = read_city(folder / "city").scene
        bodies = bodies_of(scene)
        chosen = np.flatnonzero(bodies.of_kind(kind) & bodies.movable)
        count = np.hypot(*(bodies.position[chosen, None] - bodies.position[chosen])[..., :2].T)
        middle = bodies.position[chosen[int((count < reach).sum(axis=0).argmax())]]
        window = (*(middle[:2] - reach).tolist(), *(middle[:2] + reach).tolist())
        self.bodies = write_mjcf(scene, bodies, tmp_path / "city.xml", window=window)
        self.model = self.mujoco.MjModel.from_xml_path(str(tmp_path / "city.xml"))
        self.data = self.mujoco.MjData(self.model)
        self.mujoco.mj_forward(self.model, self.data)
        self.free = np.flatnonzero(self.bodies.movable)
        names = [f"body_{id_text(int(self.bodies.object_id[row]))}_{row}" for row in self.free]
        self.number = [self.model.body(name).id for name in names]

    def step(self, seconds):
        """Go on; return the largest way of each free body meanwhile."""
        before, most = self.data.xpos[self.number].copy(), np.zeros(len(self.number))
        for _ in range(round(seconds / self.model.opt.timestep)):
            self.mujoco.mj_step(self.model, self.data)
            way = np.linalg.norm(self.data.xpos[self.number] - before, axis=1)
            most = np.maximum(most, way)
        return most

    def friction(self, number):
        """Return what MuJoCo takes where a body touches another: the larger of the two."""
        contacts = [self.data.contact[i] for i in range(self.data.ncon)]
        mine = [c for c in contacts if number in self.model.geom_bodyid[c.geom]]
        assert len({float(c.friction[0]) for c in mine}) == 1
        return float(mine[0].friction[0])


@pytest.mark.parametrize(("place", "kind"), [("river", "car"), ("park", "bench")])
def test_what_stands_about_stays_where_it_is(place, kind, tmp_path, request):
    world = World(request.getfixturevalue(place), kind, tmp_path)
    assert len(world.free) >= 3
    moved = world.step(SETTLE)
    names = [world.bodies.kinds[world.bodies.kind[row]] for row in world.free]
    assert moved.max() < STILL, sorted(zip(moved, names, strict=True))[-3:]


@pytest.mark.parametrize(("place", "kind"), [("river", "car"), ("park", "bench")])
def test_a_push_moves_a_thing_as_its_mass_and_friction_say(place, kind, tmp_path, request):
    """a = F / m - mu g, with the friction of what touches."""
    world = World(request.getfixturevalue(place), kind, tmp_path)
    world.step(0.5)
    which = int(np.flatnonzero(world.bodies.of_kind(kind)[world.free])[0])
    row, number = world.free[which], world.number[which]
    dof = world.model.body_dofadr[number]
    assert world.model.body_mass[number] == pytest.approx(world.bodies.mass[row], rel=1e-3)
    slide = world.friction(number) * 9.81
    along = world.data.xmat[number].reshape(3, 3)[:, 1 if kind == "car" else 0]
    for left in (-0.5 * slide, PUSH):  # half of what holds it, then more than that
        force = world.bodies.mass[row] * (slide + left) * along
        begin = world.data.qvel[dof : dof + 3].copy()
        world.data.xfrc_applied[number, :3] = force
        world.step(0.2)
        gained = float((world.data.qvel[dof : dof + 3] - begin) @ along) / 0.2
        assert gained == pytest.approx(max(left, 0.0), abs=OFF * (slide + PUSH))
