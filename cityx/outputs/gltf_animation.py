"""What moves, as one glTF animation: nodes of vehicles and wheels, people and riders on skins.

Every mover is a node that stands as at the city's moment and is moved by the animation. Wheels
turn by the metres gone, legs by the metres gone over the stride. glTF knows no cycles, so gaits are
written out; where that would be large, the animation covers a shorter span of the tracks.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cityx.assets.people.gaits import lift_at, pose_of, stride_of
from cityx.assets.people.people import Figure
from cityx.assets.people.poses import ride
from cityx.assets.people.skeleton import JOINTS, NUMBER, PARENT, relative_turns
from cityx.assets.vehicles.movers import Seat, is_person, vehicle
from cityx.assets.vehicles.moving import (
    PEOPLE,
    TRAFFIC,
    Dressed,
    dressed,
    facing,
    gait_phase,
    rider_look,
    rider_numbers,
)
from cityx.city.tracks import GAIT, MOVER_KINDS, Tracks, travelled
from cityx.geometry.arrays import FloatArray
from cityx.ids import id_text
from cityx.outputs.gltf_buffer import ARRAY_BUFFER, GltfBuffer
from cityx.outputs.gltf_instances import y_up_quaternions
from cityx.outputs.gltf_mesh import flat_mesh, y_up

if TYPE_CHECKING:
    from cityx.city.mesh import MeshBatch
    from cityx.city.scene import Prototype

LONGEST = 60.0  # seconds of the tracks that are animated at most
MOST_BYTES = 48e6  # of keys; a busier city is animated for a shorter span
KEYS = 8  # per cycle of a gait
WHEEL_STEP = 2 * np.pi / 3  # between two keys of a wheel, below half a turn
TABLE = 64  # phases of a gait that are worked out
SETTLE = 0.2  # seconds from one gait to another
_UNIT = 32767  # a normalised 16-bit integer of 1
Pose = Callable[[int, float], FloatArray]


@dataclass(frozen=True)
class Animated:
    """What a file needs of the writer of meshes.

    Attributes
    ----------
    buffer
        The file in the making.
    painted
        Writes a prototype in a colour and returns its mesh.
    primitives
        Writes a mesh and returns its primitives.
    detail
        Level of detail of the forms.
    """

    buffer: GltfBuffer
    painted: Callable[[Prototype, NDArray[np.float32]], int]
    primitives: Callable[[MeshBatch], list[dict[str, Any]]]
    detail: int


@dataclass(frozen=True)
class _Way:
    """The track of one mover within the span: s times, places, headings, metres gone, gaits."""

    time: FloatArray
    position: FloatArray
    rotation: FloatArray
    gone: FloatArray
    gait: NDArray[np.uint8]


class MoverWriter:
    """Writes movers; a class because skins, tables and channels gather in it."""

    def __init__(self, out: Animated, tracks: Tracks, moment: float) -> None:
        self.out, self.tracks, self.moment = out, tracks, moment
        self.gone = travelled(tracks)
        self.channels: list[dict[str, Any]] = []
        self.samplers: list[dict[str, Any]] = []
        self.bodies: list[int] = []  # skinned meshes stand at the root: no parent moves them
        self._skins: dict[Any, tuple[int, int]] = {}
        self.span = span_of(tracks, moment)

    def layers(self) -> list[int]:
        """Write all movers and return the nodes of their layers."""
        held: dict[str, list[int]] = {TRAFFIC: [], PEOPLE: []}
        for row in range(self.tracks.count):
            way = self._way(row)
            if way is None:
                continue
            if is_person(str(self.tracks.look[row])):
                held[PEOPLE].append(self._person(row, way))
            else:
                held[TRAFFIC].append(self._vehicle(row, way))
        if self.channels:
            moving = {"name": "moving", "channels": self.channels, "samplers": self.samplers}
            self.out.buffer.add("animations", moving)
        return [
            self.out.buffer.add("nodes", {"name": layer, "children": children})
            for layer, children in held.items() if children
        ]  # fmt: skip

    def _way(self, row: int) -> _Way | None:
        """Cut the track of a mover to the span; None where it is not there."""
        tracks = self.tracks
        at = slice(*tracks.sample_start[row : row + 2].tolist())
        time = tracks.time[at]
        begin, end = self.span
        if not len(time) or time[-1] < begin or time[0] > end:
            return None
        inner = time[(time > begin) & (time < end)]
        kept = np.concatenate([[max(begin, time[0])], inner, [min(end, time[-1])]])
        kept = kept[np.concatenate([[True], np.diff(kept) > 1e-4])]
        heading = np.interp(kept, time, np.unwrap(tracks.heading[at]))
        columns = [*tracks.position[at].T, self.gone[at]]
        x, y, z, gone = (np.interp(kept, time, column) for column in columns)
        low = np.searchsorted(time, kept, side="right") - 1
        climb = np.zeros(len(kept))
        if not is_person(str(tracks.look[row])) and len(kept) > 1:
            rise = np.gradient(z, kept) / np.maximum(np.gradient(gone, kept), 1e-3)
            climb = np.arctan(np.clip(rise, -0.5, 0.5))
        position = np.column_stack([x, y, z])
        gait = tracks.gait[at][np.clip(low, 0, len(time) - 1)]
        return _Way(kept - begin, position, facing(heading, climb), gone, gait)

    # --- vehicles ---------------------------------------------------------------------------------

    def _vehicle(self, row: int, way: _Way) -> int:
        tracks, add = self.tracks, self.out.buffer.add
        look = str(tracks.look[row])
        model = vehicle(look, detail=self.out.detail)
        children: list[int] = []
        spin: dict[float, int] = {}
        white = np.ones(3, np.float32)
        for part in model.parts:
            fixed: dict[str, Any] = {"name": part.prototype.name,
                                     "mesh": self.out.painted(part.prototype, white),
                                     "translation": _placed(part.place)}  # fmt: skip
            if part.about:
                fixed["rotation"] = [0, 1, 0, 0]
            children.append(add("nodes", fixed))
        for wheel in model.wheels:
            node: dict[str, Any] = {"name": "wheel", "translation": _placed(wheel.place)}
            mesh = self.out.painted(wheel.prototype, white)
            if wheel.place[0] < 0:  # turned about within what turns
                node["children"] = [add("nodes", {"mesh": mesh, "rotation": [0, 1, 0, 0]})]
            else:
                node["mesh"] = mesh
            number = add("nodes", node)
            children.append(number)
            if wheel.radius not in spin:
                spin[wheel.radius] = self._wheel_sampler(way, wheel.radius)
            self._channel(number, "rotation", spin[wheel.radius])
        if model.seat is not None:
            children.append(self._rider(model.seat, row, way))
        body = {"mesh": self.out.painted(model.body, tracks.tint[row]), "children": children}
        return self._mover(row, way, body)

    def _wheel_sampler(self, way: _Way, radius: float) -> int:
        turned = way.gone / radius
        time, angle = _crossings(way.time, turned, WHEEL_STEP)
        half = (angle - angle[0]) / 2
        turns = np.column_stack([np.sin(half), 0 * half, 0 * half, np.cos(half)])
        return self._sampler(self._times(time), _shorts(turns))

    def _rider(self, seat: Seat, row: int, way: _Way) -> int:
        """Write a rider and return the node that sits on the vehicle."""
        number = int(rider_numbers(self.tracks.object_id[[row]])[0])
        who = Dressed(rider_look(number, seat), (1.0, 1.0, 1.0))
        figure = who.figure(self.out.detail)
        pedals = bool(seat.development)
        turns = way.gone / seat.development if pedals else np.zeros(len(way.gone))
        y, z = seat.place
        pelvis = figure.joints[NUMBER["pelvis"]]
        place = y_up(np.array([[0.0, y - pelvis[1], z - pelvis[2]]]))[0]
        root, joints = self._bones(figure)
        holder = {"name": "rider", "translation": _rounded(place), "children": [root]}
        self._skin(f"rider_{id_text(self.tracks.object_id[row])}", who, figure, joints)
        time, phase = _crossings(way.time, turns, 1 / KEYS)
        table = _ride_table(pedals)
        self._bend(joints, time, table[np.round(phase * TABLE).astype(int) % TABLE])
        return self.out.buffer.add("nodes", holder)

    # --- people -----------------------------------------------------------------------------------

    def _person(self, row: int, way: _Way) -> int:
        who = dressed(self.tracks, row)
        figure = who.figure(self.out.detail)
        root, joints = self._bones(figure)
        self._skin(id_text(self.tracks.object_id[row]), who, figure, joints)
        stride = np.array([stride_of(figure, int(gait)) for gait in way.gait])
        ids = self.tracks.object_id[[row]]
        phase = gait_phase(stride, way.gone, ids)
        time, gait, cycle = _steps(way, phase)
        frame = np.round(cycle * TABLE).astype(int) % TABLE
        turns, lifts = np.zeros((len(time), len(JOINTS), 4)), np.zeros(len(time))
        for number in np.unique(gait).tolist():
            at = gait == number
            turns[at] = _gait_table(number)[frame[at]]
            lifts[at] = _lift_table(figure, number)[frame[at]]
        self._bend(joints, time, turns)
        rest = figure.joints[0]
        up = np.column_stack(
            [np.full(len(time), rest[0]), rest[2] + lifts, np.full(len(time), -rest[1])]
        ).astype(np.float32)
        place = self._sampler(self._times(time), up)
        self._channel(joints[0], "translation", place)
        return self._mover(row, way, {"children": [root]})

    def _bones(self, figure: Figure) -> tuple[int, list[int]]:
        """Write the joints of a figure; returns the root, and all in the order of `JOINTS`."""
        rest = y_up(figure.joints)
        base = np.where((PARENT >= 0)[:, None], rest[PARENT], 0.0)
        first = len(self.out.buffer.document.get("nodes", []))
        for number, name in enumerate(JOINTS):
            node: dict[str, Any] = {"name": name, "translation": _rounded((rest - base)[number])}
            below = np.flatnonzero(number == PARENT)
            if len(below):
                node["children"] = (first + below).tolist()
            self.out.buffer.add("nodes", node)
        return first, list(range(first, first + len(JOINTS)))

    def _skin(self, name: str, who: Dressed, figure: Figure, joints: list[int]) -> None:
        """Write the node of a skinned mesh; meshes and rest positions are shared."""
        buffer = self.out.buffer
        if who not in self._skins:
            mesh = buffer.add("meshes", {"name": who.name, "primitives": self._skin_parts(figure)})
            inverse = np.tile(np.eye(4, dtype=np.float32), (len(JOINTS), 1, 1))
            inverse[:, 3, :3] = -y_up(figure.joints)  # columns follow one another in memory
            flat = inverse.reshape(-1, 16)
            self._skins[who] = mesh, buffer.accessor(buffer.view(flat), flat)
        mesh, matrices = self._skins[who]
        skin = {"joints": joints, "inverseBindMatrices": matrices, "skeleton": joints[0]}
        number = buffer.add("skins", skin)
        body = {"name": f"body_{name}", "mesh": mesh, "skin": number}
        self.bodies.append(buffer.add("nodes", body))

    def _skin_parts(self, figure: Figure) -> list[dict[str, Any]]:
        buffer = self.out.buffer
        parts = self.out.primitives(figure.mesh)
        flat = flat_mesh(figure.mesh, np.zeros((1, 3)))
        joints = np.zeros((len(flat.vertex), 4), np.uint8)
        shares = np.zeros((len(flat.vertex), 4), np.uint8)
        shares[:, 0] = np.round(255 * figure.weights.shares[flat.vertex, 0])
        shares[:, 1] = 255 - shares[:, 0]  # together they are exactly one
        joints[:, :2] = figure.weights.joints[flat.vertex]
        joints[shares == 0] = 0  # a joint that carries nothing must not be named
        added = {
            "JOINTS_0": buffer.accessor(
                buffer.view(joints, target=ARRAY_BUFFER, shared=True), joints
            ),
            "WEIGHTS_0": buffer.accessor(
                buffer.view(shares, target=ARRAY_BUFFER, shared=True), shares, normalized=True
            ),
        }
        return [{**part, "attributes": {**part["attributes"], **added}} for part in parts]

    def _bend(self, joints: list[int], time: FloatArray, turns: FloatArray) -> None:
        """Add the channels of all joints that move; `turns` are (k, j, 4) x, y, z, w, y up."""
        moving = np.ptp(turns, axis=0).max(axis=1) > 1e-4
        times = self._times(time)
        for number, node in enumerate(joints):
            if not moving[number]:
                self.out.buffer.document["nodes"][node]["rotation"] = _unit(turns[0, number])
                continue
            sampler = self._sampler(times, _shorts(_continuous(turns[:, number])))
            self._channel(node, "rotation", sampler)

    # --- nodes and channels -----------------------------------------------------------------------

    def _mover(self, row: int, way: _Way, content: dict[str, Any]) -> int:
        """Write the node of a mover, which goes its track."""
        tracks = self.tracks
        kind, text = MOVER_KINDS[tracks.kind[row]], id_text(tracks.object_id[row])
        places = y_up(way.position).astype(np.float32)
        turns = _continuous(y_up_quaternions(way.rotation).astype(float))
        at = int(np.clip(np.searchsorted(way.time, self.moment - self.span[0]), 0, len(places) - 1))
        node = {
            "name": f"{kind}_{text}", "translation": _rounded(places[at]),
            "rotation": _unit(turns[at]), "extras": {"cityx_id": text, "kind": kind}, **content,
        }  # fmt: skip
        number = self.out.buffer.add("nodes", node)
        times = self._times(way.time)
        self._channel(number, "translation", self._sampler(times, places))
        self._channel(number, "rotation", self._sampler(times, _shorts(turns)))
        return number

    def _times(self, time: FloatArray) -> int:
        values = time.astype(np.float32)
        bounds = ([float(values.min())], [float(values.max())])
        buffer = self.out.buffer
        return buffer.accessor(buffer.view(values), values, bounds=bounds)

    def _sampler(self, times: int, values: NDArray[Any]) -> int:
        buffer = self.out.buffer
        normalized = values.dtype == np.int16
        output = buffer.accessor(buffer.view(values), values, normalized=normalized)
        self.samplers.append({"input": times, "output": output, "interpolation": "LINEAR"})
        return len(self.samplers) - 1

    def _channel(self, node: int, path: str, sampler: int) -> None:
        self.channels.append({"sampler": sampler, "target": {"node": node, "path": path}})


def span_of(tracks: Tracks, moment: float) -> tuple[float, float]:
    """Return the seconds of the tracks that are animated: from the moment on, as much as fits."""
    end = min(tracks.duration, moment + LONGEST)
    walking = np.array([is_person(look) for look in tracks.look.tolist()], bool)
    gone = travelled(tracks)[np.maximum(tracks.sample_start[1:] - 1, 0)]
    # Eight keys of some twenty joints of eight bytes every metre and a half; wheels by the third.
    size = float((gone * np.where(walking, KEYS * 20 * 8 / 1.5, 3 * 12 / 2.0)).sum())
    share = min(1.0, MOST_BYTES / max(size, 1.0))
    return moment, moment + max((end - moment) * share, 1.0)


def _crossings(time: FloatArray, value: FloatArray, step: float) -> tuple[FloatArray, FloatArray]:
    """Return when a value that never falls passes the multiples of a step, and its ends."""
    marks = np.arange(np.floor(value[0] / step) + 1, np.ceil(value[-1] / step)) * step
    rising = np.concatenate([[True], np.diff(value) > 1e-9])
    at = np.interp(marks, value[rising], time[rising])
    # Where it rests, the last moment of rest is a key as well: it must not drift.
    rest = time[1:][np.diff(value) <= 1e-9]
    keys = np.unique(np.round(np.concatenate([time[[0, -1]], at, rest]), 4))
    keys = keys[np.concatenate([[True], np.diff(keys) > 1e-3])]
    return keys, np.interp(keys, time, value)


def _steps(way: _Way, phase: FloatArray) -> tuple[FloatArray, NDArray[np.uint8], FloatArray]:
    """Return the keys of somebody on foot: times, gaits and phases."""
    change = np.flatnonzero(np.diff(way.gait.astype(int))) + 1
    begins = np.concatenate([[0], change])
    ends = np.concatenate([change, [len(way.time) - 1]])
    keys: list[tuple[FloatArray, NDArray[np.uint8], FloatArray]] = []
    for first, last in zip(begins.tolist(), ends.tolist(), strict=True):
        if last < first:
            continue
        at = slice(first, last + 1)
        gait = int(way.gait[first])
        run = phase[at] if gait != GAIT["still"] else np.full(last - first + 1, phase[first])
        time, cycle = _crossings(way.time[at], np.maximum.accumulate(run), 1 / KEYS)
        if keys:
            late = time >= keys[-1][0][-1] + SETTLE
            time, cycle = time[late], cycle[late]
        if len(time):
            keys.append((time, np.full(len(time), gait, np.uint8), cycle))
    times, gaits, cycles = (np.concatenate([key[i] for key in keys]) for i in range(3))
    return times, gaits, cycles


@lru_cache(maxsize=8)
def _gait_table(gait: int) -> FloatArray:
    """(TABLE, j, 4) turns of joints over a cycle of a gait, x, y, z, w, y up."""
    return _table(lambda phase: pose_of(gait, phase))


@lru_cache(maxsize=2)
def _ride_table(pedals: bool) -> FloatArray:
    return _table(lambda phase: ride(phase, pedals=pedals))


def _table(pose: Callable[[float], FloatArray]) -> FloatArray:
    from scipy.spatial.transform import Rotation

    turns = np.stack([relative_turns(pose(step / TABLE)) for step in range(TABLE)])
    x, y, z, w = Rotation.from_matrix(turns.reshape(-1, 3, 3)).as_quat().T
    return np.asarray(np.column_stack([x, z, -y, w]).reshape(TABLE, len(JOINTS), 4))


def _lift_table(figure: Figure, gait: int) -> FloatArray:
    """(TABLE,) metres by which a figure is raised over a cycle; two steps of it are alike."""
    key = figure.joints.tobytes(), gait
    if key not in _LIFTS:
        half = [lift_at(figure, gait, step / TABLE) for step in range(TABLE // 2)]
        _LIFTS[key] = np.array(half + half)
    return _LIFTS[key]


_LIFTS: dict[tuple[bytes, int], FloatArray] = {}


def _continuous(turns: FloatArray) -> FloatArray:
    """(k, 4) quaternions of which no two neighbours point apart."""
    away = np.concatenate([[False], (turns[1:] * turns[:-1]).sum(axis=1) < 0])
    # The sign of each is that of all flips before it.
    sign = np.where(np.cumsum(away) % 2, -1.0, 1.0)
    return np.asarray(turns * sign[:, None])


def _shorts(turns: FloatArray) -> NDArray[np.int16]:
    unit = turns / np.maximum(np.linalg.norm(turns, axis=1, keepdims=True), 1e-12)
    return np.asarray(np.round(unit * _UNIT).astype(np.int16))


def _unit(turn: FloatArray) -> list[float]:
    return [round(float(value), 7) + 0.0 for value in turn / np.linalg.norm(turn)]


def _placed(place: tuple[float, float, float]) -> list[float]:
    """Return a place in a vehicle as a node has it."""
    return _rounded(y_up(np.array(place)))


def _rounded(values: Any) -> list[float]:
    return [round(float(value), 4) + 0.0 for value in values]
