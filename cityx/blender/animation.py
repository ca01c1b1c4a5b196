"""What moves, as animated objects: vehicles with turning wheels, people on skeletons.

A vehicle is an object with a keyframe per sample of its track; its wheels hang on it and turn by
the metres it has gone. A person is a mesh on an armature: the armature goes the track, and a strip
of the gait's cycle runs by the metres gone over the stride, so that feet never slide. Meshes,
armatures and cycles are shared by all that look alike.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import bpy
import numpy as np
from numpy.typing import NDArray

from cityx.assets.people.gaits import lift_at, pose_of, stride_of
from cityx.assets.people.people import Figure
from cityx.assets.people.poses import ride
from cityx.assets.people.skeleton import JOINTS, NUMBER, PARENTS, relative_turns
from cityx.assets.shapes import tinted
from cityx.assets.vehicles.movers import Seat, Vehicle, is_person, vehicle
from cityx.assets.vehicles.moving import (
    PEOPLE,
    TRAFFIC,
    Dressed,
    dressed,
    facing,
    gait_phase,
    rider_look,
    rider_numbers,
    wheel_turn,
)
from cityx.blender.operators import call
from cityx.blender.scene import MeshUploader, title
from cityx.city.tracks import FRAME_RATE, GAITS, MOVER_KINDS, Tracks, travelled
from cityx.geometry.arrays import FloatArray
from cityx.ids import id_text

if TYPE_CHECKING:
    from cityx.blender.materials import MaterialLibrary
    from cityx.city.mesh import MeshBatch
    from cityx.city.store import View

CYCLE = 24  # frames of a cycle of a gait as it is stored; its strip is run by the metres gone
BONE = 0.06  # metres, length of a bone; it points to the back, so that its axes are the figure's
CONSTANT, LINEAR = 0, 1  # Blender's numbers of interpolations
_SHOWN = ("hide_render", "hide_viewport")


def frame_of(seconds: float) -> float:
    """Return the frame of a moment of the tracks, not rounded."""
    return seconds * FRAME_RATE


def animate(scene: bpy.types.Scene, view: View, library: MaterialLibrary) -> int:
    """Add everything that moves to a scene, with keyframes; returns the number of movers.

    Parameters
    ----------
    scene
        The scene; its frame rate and range become those of the tracks.
    view
        The city.
    library
        Gives the materials.
    """
    tracks = view.tracks
    if tracks is None or not tracks.count:
        return 0
    scene.render.fps = FRAME_RATE
    scene.frame_start, scene.frame_end = 0, int(np.ceil(frame_of(tracks.duration)))
    collections = {}
    for layer in (TRAFFIC, PEOPLE):
        collections[layer] = bpy.data.collections.new(title(layer))
        scene.collection.children.link(collections[layer])
    stage = _Stage(tracks, library, max(view.lod, 2), collections)
    for row in range(tracks.count):
        stage.add(row)
    set_moment(scene, view.moment)
    return tracks.count


def set_moment(scene: bpy.types.Scene, moment: float) -> None:
    """Show the frame of a moment of the tracks, in seconds."""
    frame = frame_of(moment)
    scene.frame_set(int(frame), subframe=frame % 1.0)


@dataclass(frozen=True)
class _Way:
    """The track of one mover, s samples: frames, places, turns, metres gone, gaits."""

    frame: FloatArray
    position: FloatArray
    rotation: FloatArray
    gone: FloatArray
    gait: NDArray[np.uint8]


class _Stage:
    """Shares what movers have in common; a class because meshes and actions gather in it."""

    def __init__(
        self,
        tracks: Tracks,
        library: MaterialLibrary,
        detail: int,
        collections: dict[str, bpy.types.Collection],
    ) -> None:
        self.tracks, self.library, self.detail = tracks, library, detail
        self.collections = collections
        self.gone = travelled(tracks)
        self._meshes: dict[Any, bpy.types.Mesh] = {}
        self._rigs: dict[Any, bpy.types.Armature] = {}
        self._cycles: dict[Any, bpy.types.Action] = {}
        self._turns: dict[Any, FloatArray] = {}

    def add(self, row: int) -> None:
        """Add one mover."""
        tracks = self.tracks
        way = self._way(row)
        if not len(way.frame):
            return
        kind = MOVER_KINDS[tracks.kind[row]]
        name = f"{kind}_{id_text(tracks.object_id[row])}"
        if is_person(str(tracks.look[row])):
            item = self._person(name, dressed(tracks, row), row, way)
        else:
            item = self._vehicle(name, row, way)
        item["cityx_id"] = id_text(tracks.object_id[row])
        item["kind"] = kind

    def _way(self, row: int) -> _Way:
        tracks = self.tracks
        at = slice(*tracks.sample_start[row : row + 2].tolist())
        position = tracks.position[at]
        heading = np.unwrap(tracks.heading[at])
        step = np.diff(position, axis=0)
        climb = np.arctan2(step[:, 2], np.maximum(np.hypot(*step[:, :2].T), 1e-3))
        if is_person(str(tracks.look[row])) or not len(step):
            climb = np.zeros(len(step))
        climb = np.append(climb, climb[-1:]) if len(step) else np.zeros(len(position))
        return _Way(
            tracks.time[at] * FRAME_RATE,
            position,
            facing(heading, climb),
            self.gone[at],
            tracks.gait[at],
        )

    def _object(
        self, name: str, data: Any, layer: str, parent: bpy.types.Object | None = None
    ) -> bpy.types.Object:
        item = bpy.data.objects.new(name, data)
        item.parent = parent
        self.collections[layer].objects.link(item)
        return item

    def _mesh(self, key: Any, name: str, batch: MeshBatch) -> bpy.types.Mesh:
        if key not in self._meshes:
            upload = MeshUploader(batch, self.library)
            vertices, faces = slice(0, len(batch.vertices)), slice(0, len(batch.faces))
            self._meshes[key] = upload.mesh(name, vertices, faces)
        return self._meshes[key]

    # --- vehicles ---------------------------------------------------------------------------------

    def _vehicle(self, name: str, row: int, way: _Way) -> bpy.types.Object:
        tracks = self.tracks
        look = str(tracks.look[row])
        model: Vehicle = vehicle(look, detail=self.detail)
        paint = tuple(tracks.tint[row].tolist())
        shape = model.body
        body = self._mesh((shape.name, paint), shape.name, tinted(shape.mesh, paint))
        item = self._object(name, body, TRAFFIC)
        self._follow(item, way)
        for number, fixed in enumerate(model.parts):
            shape = fixed.prototype
            mesh = self._mesh(shape.name, shape.name, shape.mesh)
            part = self._object(f"{name}_part_{number}", mesh, TRAFFIC, item)
            part.location = fixed.place
            part.rotation_euler = (0.0, 0.0, np.pi * fixed.about)
        turning: list[tuple[bpy.types.Object, str, FloatArray]] = []
        for number, wheel in enumerate(model.wheels):
            mesh = self._mesh(wheel.prototype.name, wheel.prototype.name, wheel.prototype.mesh)
            part = self._object(f"{name}_wheel_{number}", mesh, TRAFFIC, item)
            part.location = wheel.place
            spin, about = wheel_turn(way.gone, wheel.radius, wheel.place[0])
            part.rotation_euler = (0.0, 0.0, about)
            turning.append((part, "rotation_euler", spin))
        for part, path, values in turning:
            _keys(_action_of(part), path, 0, way.frame, values)
        if model.seat is not None:
            self._rider(name, model.seat, row, way, item)
        for part in (item, *item.children_recursive):
            self._shown(part, way)
        return item

    def _rider(self, name: str, seat: Seat, row: int, way: _Way, parent: bpy.types.Object) -> None:
        ids = self.tracks.object_id[[row]]
        who = Dressed(rider_look(int(rider_numbers(ids)[0]), seat), (1.0, 1.0, 1.0))
        figure = who.figure(self.detail)
        rig = self._rigged(f"{name}_rider", who, figure, TRAFFIC, parent)
        y, z = seat.place
        pelvis = figure.joints[NUMBER["pelvis"]]
        rig.location = (0.0, y - pelvis[1], z - pelvis[2])
        pedals = bool(seat.development)
        cycle = self._cycle(
            ("ride", pedals), lambda phase: ride(phase, pedals=pedals), lambda _: 0.0
        )
        turns = way.gone / seat.development if seat.development else np.zeros(len(way.gone))
        _strip(rig, cycle, way.frame, turns)

    # --- people -----------------------------------------------------------------------------------

    def _person(self, name: str, who: Dressed, row: int, way: _Way) -> bpy.types.Object:
        figure = who.figure(self.detail)
        rig = self._rigged(name, who, figure, PEOPLE)
        self._follow(rig, way)
        ids = self.tracks.object_id[[row]]
        change = np.flatnonzero(np.diff(way.gait.astype(int))) + 1
        bounds = [0, *change.tolist(), len(way.frame) - 1]
        for first, last in pairwise(bounds):
            if last <= first:
                continue
            gait = int(way.gait[first])
            cycle = self._cycle((who, gait), partial(pose_of, gait), partial(lift_at, figure, gait))
            at = slice(first, last + 1)
            phase = gait_phase(stride_of(figure, gait), way.gone[at], ids)
            _strip(rig, cycle, way.frame[at], phase, name=GAITS[gait])
        for part in (rig, *rig.children):
            self._shown(part, way)
        return rig

    def _rigged(
        self, name: str, who: Dressed, figure: Figure, layer: str,
        parent: bpy.types.Object | None = None,
    ) -> bpy.types.Object:  # fmt: skip
        """Make an armature object with the mesh of a figure on it."""
        key = (who, self.detail)
        known = key in self._rigs
        if not known:
            self._rigs[key] = bpy.data.armatures.new(who.name)
        rig = self._object(name, self._rigs[key], layer, parent)
        if not known:
            _make_bones(rig, figure)
        skin = self._mesh(key, who.name, figure.mesh)
        body = self._object(f"{name}_body", skin, layer, rig)
        if not body.vertex_groups:
            _bind(body, figure)
        modifier = body.modifiers.new("Armature", "ARMATURE")
        modifier.object = rig
        return rig

    def _cycle(
        self,
        gait: Any,
        pose: Callable[[float], FloatArray],
        lift: Callable[[float], float],
        who: Dressed | None = None,
    ) -> bpy.types.Action:
        """Return the action of a cycle of a gait, made of its poses and somebody's lifts."""
        key = (gait, who)
        if key not in self._cycles:
            action = bpy.data.actions.new(f"cycle_{len(self._cycles)}")
            frames = np.arange(CYCLE + 1, dtype=float)
            phases = (frames / CYCLE).tolist()
            if gait not in self._turns:  # those of all people
                stack = np.stack([relative_turns(pose(phase)) for phase in phases])
                self._turns[gait] = _quaternions(stack)
            turns = self._turns[gait]
            for number, joint in enumerate(JOINTS):
                path = f'pose.bones["{joint}"].rotation_quaternion'
                for index in range(4):
                    _keys(action, path, index, frames, turns[:, number, index])
            lifts = np.array([lift(phase) for phase in phases])
            _keys(action, 'pose.bones["pelvis"].location', 2, frames, lifts)
            self._cycles[key] = action
        return self._cycles[key]

    # --- keyframes --------------------------------------------------------------------------------

    def _follow(self, item: bpy.types.Object, way: _Way) -> None:
        """Put a keyframe on every sample of a track."""
        action = _action_of(item)
        for index in range(3):
            _keys(action, "location", index, way.frame, way.position[:, index])
            _keys(action, "rotation_euler", index, way.frame, way.rotation[:, index])

    def _shown(self, item: bpy.types.Object, way: _Way) -> None:
        """Hide a mover before its first and after its last sample."""
        first, last = float(way.frame[0]), float(way.frame[-1])
        if first <= 0 and last >= frame_of(self.tracks.duration) - 1:
            return
        frames = np.array([min(first, 0.0) - 1, first, np.floor(last) + 1])
        for path in _SHOWN:
            _keys(_action_of(item), path, 0, frames, np.array([1.0, 0.0, 1.0]), CONSTANT)


def _action_of(item: bpy.types.Object) -> bpy.types.Action:
    data = item.animation_data or item.animation_data_create()
    if data.action is None:
        data.action = bpy.data.actions.new(item.name)
        data.action_slot = data.action.slots.new(id_type="OBJECT", name=item.name)
    return data.action


def _keys(
    action: bpy.types.Action, path: str, index: int, frames: FloatArray, values: FloatArray,
    interpolation: int = LINEAR,
) -> None:  # fmt: skip
    """Add a curve with a keyframe at each frame."""
    curve = action.fcurves.new(path, index=index)
    _fill(curve, frames, values, interpolation)


def _fill(curve: Any, frames: FloatArray, values: FloatArray, interpolation: int = LINEAR) -> None:
    points = curve.keyframe_points
    points.add(len(frames) - len(points))
    points.foreach_set("co", np.column_stack([frames, values]).astype(np.float32).ravel())
    points.foreach_set("interpolation", np.full(len(frames), interpolation, np.int32))
    curve.update()


def _strip(
    rig: bpy.types.Object, cycle: bpy.types.Action, frames: FloatArray, turns: FloatArray,
    name: str = "ride",
) -> None:  # fmt: skip
    """Run a cycle on an armature: `turns`, (s,), are the cycles done at each frame."""
    data = rig.animation_data or rig.animation_data_create()
    track = data.nla_tracks.new()
    track.name = name
    strip = track.strips.new(name, int(np.floor(frames[0])), cycle)
    strip.action_frame_start, strip.action_frame_end = 0.0, float(CYCLE)
    strip.frame_end, strip.frame_start = float(frames[-1]) + 0.01, float(frames[0])
    strip.frame_end = float(frames[-1]) + 0.01
    strip.extrapolation = "NOTHING" if len(data.nla_tracks) > 1 else "HOLD"
    strip.use_animated_time = strip.use_animated_time_cyclic = True
    _fill(strip.fcurves.find("strip_time"), frames, turns * CYCLE)


def _make_bones(rig: bpy.types.Object, figure: Figure) -> None:
    """Give an armature a bone per joint, with the axes of the figure."""
    bpy.context.view_layer.objects.active = rig
    call("object.mode_set", mode="EDIT")
    bones = rig.data.edit_bones
    for number, (name, parent) in enumerate(PARENTS.items()):
        bone = bones.new(name)
        bone.head = figure.joints[number]
        bone.tail = figure.joints[number] + np.array([0.0, BONE, 0.0])
        bone.roll = 0.0
        if parent:
            bone.parent = bones[parent]
    call("object.mode_set", mode="OBJECT")
    rig.data.display_type = "STICK"


def _bind(body: bpy.types.Object, figure: Figure) -> None:
    """Bind the vertices of a mesh to the bones by their weights."""
    joints, shares = figure.weights
    steps = np.round(shares, 3)
    for number, name in enumerate(JOINTS):
        group = body.vertex_groups.new(name=name)
        for column in range(2):
            mine = np.flatnonzero((joints[:, column] == number) & (steps[:, column] > 0))
            for share in np.unique(steps[mine, column]).tolist():
                at = mine[steps[mine, column] == share]
                group.add(at.tolist(), share, "ADD")


def _quaternions(matrices: FloatArray) -> FloatArray:
    """(..., 3, 3) rotations to (..., 4) w, x, y, z, which do not jump along the first axis."""
    from scipy.spatial.transform import Rotation

    flat = Rotation.from_matrix(matrices.reshape(-1, 3, 3)).as_quat()
    turns = flat[:, [3, 0, 1, 2]].reshape(*matrices.shape[:-2], 4)
    for step in range(1, len(turns)):
        away = (turns[step] * turns[step - 1]).sum(axis=-1) < 0
        turns[step][away] *= -1
    return np.asarray(turns)
