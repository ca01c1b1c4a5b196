"""A window of a city in MuJoCo that goes with a robot."""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cityx.errors import InputError, MissingExtra, UsageError
from cityx.geometry.arrays import FloatArray
from cityx.ids import id_text
from cityx.sim.contact.ground import CELL, Patch, height_at, patch_of
from cityx.sim.engine import Engine
from cityx.sim.info import mover_name
from cityx.sim.kernels.tables import ALIVE, HEADING, HEIGHT, LENGTH, WIDTH, X, Y, Z
from cityx.sim.scenery import Scenery
from cityx.sim.state import DT
from cityx.sim.world import World

SUBSTEP = 0.005  # seconds
THICK = 0.05  # metres, half of a wall
EDGE = 10.0  # metres from the border of a window at which the next one is made
DEEP = 0.5  # metres of ground and of kerbs below their surface
MOVERS = 16  # that are near enough to be met
PARKED = -500.0  # metres, height of those that are not there
FRICTION = (0.8, 0.005, 0.0001)
OWN = "cityx_"  # begins the names of all that is not the robot's


class Root(NamedTuple):
    """Rows of a state: the first of the place of a free body, and the first of its speed."""

    place: int
    speed: int


class ContactWindow:
    """A robot of a user's own in a city, with contacts; a class for the simulation that it steps.

    The ground is a field of heights with boxes along kerbs, what is solid are boxes, loose things
    are free and asleep until they are touched. When the robot comes near the border the window is
    made anew about it; what was pushed stays where it was pushed to.

    Attributes
    ----------
    model, data
        MuJoCo's, in a frame whose origin is the middle of the window; z is the city's.
    patch
        What the window holds.
    loose
        Ids of what is there and can be pushed.

    Parameters
    ----------
    place
        A world and its scenery; or what `cityx.sim.places.world_of` takes.
    robot
        MJCF file. Its outermost body has a free joint; what else its file places in the world, as
        floors, is left out.
    at, heading
        Where it begins, (x, y) or (x, y, z) metres of the city's frame, and radians; the height of
        its origin above the ground is that in its file.
    size
        Metres of a side of the window.

    Raises
    ------
    MissingExtra
        If MuJoCo is absent.
    InputError, UsageError
        If the place, the file or where it begins is of no use.
    """

    def __init__(
        self, place: Any, robot: str | Path, *, at: ArrayLike, heading: float = 0.0,
        size: float = 60.0,
    ) -> None:  # fmt: skip
        self._mujoco = mujoco_of()
        self.world, self.scenery = _placed(place)
        self._robot, self._size = Path(robot), float(size)
        if not 2.5 * EDGE <= self._size <= 200.0:
            raise UsageError(f"size is {size!r}; it takes metres, {2.5 * EDGE:g} to 200.")
        spot = np.asarray(at, float).reshape(-1)
        if len(spot) not in (2, 3) or not np.isfinite([*spot, heading]).all():
            raise UsageError(f"at is {at!r}; it takes x and y, or x, y and z, in metres.")
        below = spot[2] + 1.0 if len(spot) == 3 else np.inf
        ground = height_at(self.scenery, float(spot[0]), float(spot[1]), below)
        self._moved: dict[int, tuple[FloatArray, FloatArray]] = {}
        self._make(np.array([spot[0], spot[1], ground]))
        root = self._free
        c, s = np.cos(heading / 2), np.sin(heading / 2)
        self.data.qpos[root : root + 2] = spot[:2] - self.patch.middle
        self.data.qpos[root + 2] += ground
        self.data.qpos[root + 3 : root + 7] = _times(
            np.array([c, 0.0, 0.0, s]), self.data.qpos[root + 3 : root + 7]
        )
        self._mujoco.mj_forward(self.model, self.data)

    @property
    def position(self) -> FloatArray:
        """(3,) metres, where the robot's outermost body is, in the frame of the city."""
        found = np.array(self.data.qpos[self._free : self._free + 3])
        found[:2] += self.patch.middle
        return found

    @property
    def heading(self) -> float:
        """Radians from east, counter-clockwise, of the robot's x axis."""
        w, x, y, z = self.data.qpos[self._free + 3 : self._free + 7]
        return float(np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)))

    @property
    def upright(self) -> float:
        """How far the robot's own up is up: 1 as it stands in its file, 0 on its side."""
        _, x, y, _ = self.data.qpos[self._free + 3 : self._free + 7]
        return float(1.0 - 2.0 * (x * x + y * y))

    @property
    def root(self) -> Root:
        """Rows of MuJoCo's state from which on the robot's outermost body has its own."""
        joint = int(np.flatnonzero(self.model.jnt_qposadr == self._free)[0])
        return Root(self._free, int(self.model.jnt_dofadr[joint]))

    def step(self, control: ArrayLike) -> None:
        """Go on for a tenth of a second.

        Parameters
        ----------
        control
            One number for each of the robot's actuators.

        Raises
        ------
        UsageError
            If there are more or fewer, or some are no numbers.
        """
        given = np.asarray(control, float).reshape(-1)
        if len(given) != self.model.nu or not np.isfinite(given).all():
            raise UsageError(
                f"control is {control!r}; it takes {self.model.nu} finite numbers, one for each "
                "actuator."
            )
        self.data.ctrl[:] = given
        self._mujoco.mj_step(self.model, self.data, nstep=round(DT / SUBSTEP))
        away = np.abs(self.data.qpos[self._free : self._free + 2]).max()
        if away > self._size / 2 - EDGE:
            self._follow()

    def touched(self) -> list[str]:
        """Return what the robot touches now: "ground", "kerb", ids of things, names of movers."""
        found = set()
        robot = self._of_robot
        for one, other in self.data.contact.geom[: self.data.ncon].tolist():
            if robot[one] != robot[other]:
                found.add(self._name_of[other if robot[one] else one])
        return sorted(found)

    def place_movers(self, boxes: ArrayLike, names: list[str] | None = None) -> None:
        """Put those who move by themselves where they are; they push and are not pushed.

        Parameters
        ----------
        boxes
            (k, 7): x, y, z of the ground under them, heading, length, width and height; the
            `MOVERS` nearest to the robot count.
        names
            Of each, for `touched`.
        """
        rows = np.asarray(boxes, float).reshape(-1, 7)
        names = names or [f"mover:{number}" for number in range(len(rows))]
        away = np.hypot(*(rows[:, :2] - self.position[:2]).T)
        near = np.argsort(away, kind="stable")[:MOVERS]
        data, model = self.data, self.model
        data.mocap_pos[:] = [0.0, 0.0, PARKED]
        for slot, row in enumerate(near.tolist()):
            x, y, z, heading, *size = rows[row].tolist()
            half = np.array(size) / 2
            data.mocap_pos[slot] = [x - self.patch.middle[0], y - self.patch.middle[1], z + half[2]]
            data.mocap_quat[slot] = [np.cos(heading / 2), 0.0, 0.0, np.sin(heading / 2)]
            geom = self._mover_geoms[slot]
            model.geom_size[geom], model.geom_rbound[geom] = half, np.linalg.norm(half)
            model.geom_aabb[geom, 3:] = half
            self._name_of[geom] = names[row]

    def place_movers_of(self, engine: Engine, world: int = 0) -> None:
        """Put the movers of a world of an engine of the same city there; agents too."""
        real, whole = engine.state.real[world], engine.state.whole[world]
        who = np.flatnonzero(whole[ALIVE] != 0)
        rows = real[[X, Y, Z, HEADING, LENGTH, WIDTH, HEIGHT]][:, who].T
        self.place_movers(rows, [mover_name(engine, int(n)) for n in who])

    # --- the model --------------------------------------------------------------------------------

    def _follow(self) -> None:
        """Make the window anew about the robot; all its joints go on as they were."""
        place, old, state = self.position, self.model, self.data
        middle = self.patch.middle
        for name, number in self._props.items():
            at = old.jnt_qposadr[old.body_jntadr[number]]
            spot = np.array(state.qpos[at : at + 7])
            spot[:2] += middle
            self._moved[name] = (spot[:3], spot[3:])
        self._make(place)
        new = self.model
        kept = int(self._joints)
        last_q = old.jnt_qposadr[kept] if kept < old.njnt else old.nq
        last_v = old.jnt_dofadr[kept] if kept < old.njnt else old.nv
        self.data.qpos[:last_q], self.data.qvel[:last_v] = state.qpos[:last_q], state.qvel[:last_v]
        self.data.qpos[self._free : self._free + 2] += middle - self.patch.middle
        self.data.ctrl[:], self.data.time = state.ctrl, state.time
        if new.na:
            self.data.act[:] = state.act
        self._mujoco.mj_forward(new, self.data)

    def _make(self, place: FloatArray) -> None:
        mujoco = self._mujoco
        try:
            spec = mujoco.MjSpec.from_file(str(self._robot))
        except (ValueError, OSError) as error:
            raise InputError(f"{self._robot} is no model of MuJoCo: {error}") from error
        root = spec.worldbody.first_body()
        free = [joint for joint in (root.joints if root is not None else [])
                if joint.type == mujoco.mjtJoint.mjJNT_FREE]  # fmt: skip
        if not free or len(spec.worldbody.bodies) != 1:
            raise InputError(
                f"{self._robot} holds no single robot that can go about: its one outermost body "
                "takes a <freejoint/>."
            )
        for geom in list(spec.worldbody.geoms):
            spec.delete(geom)
        self._joints = len(spec.joints)
        self.patch = patch_of(self.world, self.scenery, place, self._size)
        option = spec.option
        option.timestep, option.integrator = SUBSTEP, mujoco.mjtIntegrator.mjINT_IMPLICITFAST
        option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
        option.enableflags |= mujoco.mjtEnableBit.mjENBL_SLEEP
        names: dict[str, str] = {}
        _add_ground(mujoco, spec, self.patch, names)
        self._add_props(spec, names)
        for number in range(MOVERS):
            body = spec.worldbody.add_body(name=f"{OWN}mover_{number}", mocap=True,
                                           pos=[0.0, 0.0, PARKED])  # fmt: skip
            body.add_geom(name=f"{OWN}mover_{number}", type=mujoco.mjtGeom.mjGEOM_BOX,
                          size=[0.5, 0.5, 0.5], friction=FRICTION)  # fmt: skip
        try:
            self.model = spec.compile()
        except ValueError as error:
            raise InputError(f"{self._robot} is no model of MuJoCo: {error}") from error
        model = self.model
        self.data = mujoco.MjData(model)
        self._free = int(model.jnt_qposadr[np.flatnonzero(
            model.jnt_type == int(mujoco.mjtJoint.mjJNT_FREE))[0]])  # fmt: skip
        titles = [model.geom(number).name for number in range(model.ngeom)]
        self._of_robot = np.array([not title.startswith(OWN) for title in titles])
        self._name_of = [names.get(title, title) for title in titles]
        self._mover_geoms = [model.geom(f"{OWN}mover_{number}").id for number in range(MOVERS)]
        self._props = {int(title): model.body(f"{OWN}prop_{title}").id
                       for title in self._prop_rows}  # fmt: skip

    def _add_props(self, spec: Any, names: dict[str, str]) -> None:
        """Add what can be pushed, where it stands or where it was pushed to."""
        own, mujoco = self.scenery, self._mujoco
        middle = np.array([*self.patch.middle, 0.0])
        self._prop_rows = self.patch.prop.tolist()
        self.loose: set[str] = set()
        for row in self._prop_rows:
            thing = int(own.prop_thing[row])
            low, high = own.prop_bounds[row, :3], own.prop_bounds[row, 3:]
            way = own.thing_way[thing]
            scale = np.linalg.norm(way[:, :3], axis=0)
            spot = way[:, :3] @ ((low + high) / 2) + way[:, 3]
            turn = np.empty(4)
            mujoco.mju_mat2Quat(turn, np.ascontiguousarray(way[:, :3] / scale).ravel())
            spot, turn = self._moved.get(row, (spot, turn))
            body = spec.worldbody.add_body(name=f"{OWN}prop_{row}", pos=spot - middle, quat=turn)
            body.sleep = mujoco.mjtSleepPolicy.mjSLEEP_INIT
            body.add_freejoint(name=f"{OWN}prop_{row}")
            body.add_geom(
                name=f"{OWN}prop_{row}", type=mujoco.mjtGeom.mjGEOM_BOX,
                size=np.maximum((high - low) / 2 * scale, 0.005), friction=FRICTION,
                mass=float(own.prop_mass[row]),
            )  # fmt: skip
            names[f"{OWN}prop_{row}"] = id_text(int(own.object_id[own.thing_object[thing]]))
            self.loose.add(names[f"{OWN}prop_{row}"])


def _add_ground(mujoco: Any, spec: Any, patch: Patch, names: dict[str, str]) -> None:
    """Add the field of heights, kerbs and walls."""
    low = float(patch.height.min())
    rise = max(float(patch.height.max()) - low, 0.01)
    count = len(patch.height)
    half = (count - 1) * CELL / 2
    spec.add_hfield(
        name=f"{OWN}ground", size=[half, half, rise, DEEP], nrow=count, ncol=count,
        userdata=((patch.height - low) / rise).astype(np.float32).ravel(),
    )  # fmt: skip
    world = spec.worldbody
    world.add_geom(name=f"{OWN}ground", type=mujoco.mjtGeom.mjGEOM_HFIELD,
                   hfieldname=f"{OWN}ground", pos=[0.0, 0.0, low], friction=FRICTION)  # fmt: skip
    names[f"{OWN}ground"] = "ground"
    x0, y0 = patch.middle
    for number, (kerb, slope) in enumerate(zip(patch.kerb, patch.kerb_slope, strict=True)):
        x, y, z, long, heading, behind, drop = kerb.tolist()
        tall = (drop + DEEP) / 2
        turn = _times(_about("z", heading), _about("x", float(slope)))
        up = _turned(turn, np.array([behind / 2, 0.0, -tall]))
        world.add_geom(
            name=f"{OWN}kerb_{number}", type=mujoco.mjtGeom.mjGEOM_BOX,
            size=[behind / 2, long, tall], pos=np.array([x - x0, y - y0, z]) + up, quat=turn,
            friction=FRICTION,
        )  # fmt: skip
        names[f"{OWN}kerb_{number}"] = "kerb"
    for number, (side, owner) in enumerate(zip(patch.wall, patch.wall_object, strict=True)):
        ax, ay, bx, by, foot, head = side.tolist()
        heading = float(np.arctan2(by - ay, bx - ax))
        world.add_geom(
            name=f"{OWN}wall_{number}", type=mujoco.mjtGeom.mjGEOM_BOX,
            size=[np.hypot(bx - ax, by - ay) / 2, THICK, max((head - foot) / 2, 0.01)],
            pos=[(ax + bx) / 2 - x0, (ay + by) / 2 - y0, (foot + head) / 2],
            quat=_about("z", heading), friction=FRICTION,
        )  # fmt: skip
        names[f"{OWN}wall_{number}"] = id_text(int(owner))


def _placed(place: Any) -> tuple[World, Scenery]:
    if isinstance(place, tuple) and len(place) == 2 and isinstance(place[1], Scenery):
        return place
    from cityx.sim.places import scenery_of, world_of

    world = world_of(place)
    return world, scenery_of(place, world)


def mujoco_of() -> Any:
    """Return the module of MuJoCo.

    Raises
    ------
    MissingExtra
        If it is absent.
    """
    try:
        import mujoco
    except ImportError as error:
        raise MissingExtra(
            'Contacts need MuJoCo: install it with  pip install "cityx[sim]"'
        ) from error
    return mujoco


def _about(axis: str, angle: float) -> NDArray[np.float64]:
    found = np.array([np.cos(angle / 2), 0.0, 0.0, 0.0])
    found["xyz".index(axis) + 1] = np.sin(angle / 2)
    return found


def _times(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return the turn b and then a, (4,) quaternions, w first."""
    w, v = a[0] * b[0] - a[1:] @ b[1:], a[0] * b[1:] + b[0] * a[1:] + np.cross(a[1:], b[1:])
    return np.array([w, *v])


def _turned(turn: FloatArray, vector: FloatArray) -> FloatArray:
    back = turn * np.array([1.0, -1.0, -1.0, -1.0])
    return np.asarray(_times(_times(turn, np.array([0.0, *vector])), back)[1:])
