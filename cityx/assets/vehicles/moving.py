"""The movers of a city as rows of its scene, at its moment.

They are derived whenever a city is looked at and are never stored: tracks and moment are all there
is to know, a second table could only contradict them, another moment costs nothing, and what a
change leaves alone keeps its hash. `with_movers` is the only place that does it, so that pictures,
files, checks and predicates see the same things in the same places under the same ids.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING, TypeVar

import numpy as np
from numpy.typing import NDArray

from cityx.assets.people.gaits import PHASES, going, riding, stride_of
from cityx.assets.people.people import FINE, Figure, figure
from cityx.assets.shapes import prototype
from cityx.assets.vehicles.car_parts import fixed_to
from cityx.assets.vehicles.movers import (
    CYCLE,
    ENGINE,
    RIDERS,
    Seat,
    Vehicle,
    figure_of,
    is_person,
    person_look,
    person_of,
    vehicle,
)
from cityx.city.scene import Instances, Prototype, no_instances
from cityx.city.tracks import GAITS, Poses, Tracks, poses_at
from cityx.geometry.arrays import FloatArray
from cityx.ids import hash_ids, uniform

if TYPE_CHECKING:
    from cityx.city.city import City
    from cityx.city.store import View

TRAFFIC, PEOPLE = "traffic", "people"  # layers of instances
PERSON, RIDER = "person", "rider"  # kinds of prototypes
_WHITE = (1.0, 1.0, 1.0)
Held = TypeVar("Held", "City", "View")


def with_movers(held: Held, moment: float | None = None) -> Held:
    """Return a city or its view with what moves in its scene, as it is at a moment.

    Parameters
    ----------
    held
        A city or a view of one.
    moment
        Seconds into the tracks; the city's own when left out.
    """
    if held.tracks is None or not held.tracks.count:
        return held
    shown = held.moment if moment is None else moment
    poses = poses_at(held.tracks, shown)
    scene = held.scene
    for layer, rows in ((TRAFFIC, _traffic), (PEOPLE, _people)):
        table = rows(held.tracks, poses, max(held.lod, 2))
        scene = scene.with_instances(layer, table.prototypes, table.rows())
    return replace(held, scene=scene, moment=shown)


class _Table:
    """Rows in the making; a class because prototypes and rows gather together."""

    def __init__(self) -> None:
        self._number: dict[str, int] = {}
        self.prototypes: list[Prototype] = []
        self._parts: list[Instances] = []

    def add(
        self,
        shape: Prototype,
        object_id: NDArray[np.uint64],
        position: FloatArray,
        rotation: FloatArray,
        tint: NDArray[np.float32],
        owner: NDArray[np.uint64] | None = None,
    ) -> None:
        """Add rows of one prototype."""
        count = len(object_id)
        if shape.name not in self._number:
            self._number[shape.name] = len(self.prototypes)
            self.prototypes.append(shape)
        self._parts.append(
            Instances(
                np.full(count, self._number[shape.name], np.int32),
                object_id,
                np.zeros(count, np.uint64) if owner is None else owner,
                position,
                rotation.astype(np.float32),
                np.ones((count, 3), np.float32),
                tint,
            )
        )

    def rows(self) -> Instances:
        """Return all rows by id."""
        parts = [no_instances(), *self._parts]
        joined = {
            name: np.concatenate([getattr(part, name) for part in parts]) for name in vars(parts[0])
        }
        order = np.argsort(joined["object_id"], kind="stable")
        return Instances(**{name: values[order] for name, values in joined.items()})


def facing(heading: FloatArray, climb: FloatArray | float = 0.0) -> FloatArray:
    """(n, 3) Euler angles of things that look to -y by themselves, nose up by `climb`."""
    heading = np.asarray(heading, float)
    # Whatever looks to -y has its nose lowered by a turn about x.
    pitch = np.broadcast_to(-np.asarray(climb, float), heading.shape)
    return np.column_stack([pitch, np.zeros(len(heading)), heading + np.pi / 2])


def placed(place: FloatArray, position: FloatArray, rotation: FloatArray) -> FloatArray:
    """(n, 3) where a place of a thing lies when the thing stands and is turned, about x then z."""
    x, y, z = np.asarray(place, float)
    cp, sp = np.cos(rotation[:, 0]), np.sin(rotation[:, 0])
    cy, sy = np.cos(rotation[:, 2]), np.sin(rotation[:, 2])
    ahead, up = cp * y - sp * z, sp * y + cp * z
    turned = np.column_stack([cy * x - sy * ahead, sy * x + cy * ahead, up])
    return np.asarray(position + turned)


def wheel_turn(travelled: FloatArray, radius: float, place_x: float) -> tuple[FloatArray, float]:
    """Return (n,) radians about x that a wheel has rolled, and its own turn about z."""
    about = np.pi if place_x < 0 else 0.0
    sense = -1.0 if place_x < 0 else 1.0
    return sense * np.asarray(travelled) / radius, about


def _traffic(tracks: Tracks, poses: Poses, detail: int) -> _Table:
    table = _Table()
    looks = tracks.look[poses.row]
    for look in np.unique(looks).tolist():
        if is_person(look):
            continue
        at = np.flatnonzero(looks == look)
        model = vehicle(look, detail=detail)
        ids, tint = tracks.object_id[poses.row[at]], tracks.tint[poses.row[at]]
        position = poses.position[at]
        rotation = facing(poses.heading[at], poses.climb[at])
        table.add(model.body, ids, position, rotation, tint)
        for number, part in enumerate(model.parts):
            place, turn = fixed_to(part, position, rotation)
            own = part_ids(ids, FIRST_PART + number)
            table.add(part.prototype, own, place, turn, np.ones_like(tint), owner=ids)
        _add_wheels(table, model, ids, position, rotation, poses.travelled[at])
        if model.seat is not None:
            _add_riders(
                table, model.seat, look, ids, position, rotation, poses.travelled[at], detail
            )
    return table


def _add_wheels(
    table: _Table, model: Vehicle, ids: NDArray[np.uint64], position: FloatArray,
    rotation: FloatArray, travelled: FloatArray,
) -> None:  # fmt: skip
    white = np.ones((len(ids), 3), np.float32)
    for number, wheel in enumerate(model.wheels):
        spin, about = wheel_turn(travelled, wheel.radius, wheel.place[0])
        turn = rotation.copy()
        turn[:, 0] = np.remainder(turn[:, 0] * (-1 if about else 1) + spin, 2 * np.pi)
        turn[:, 2] += about
        place = placed(np.array(wheel.place), position, rotation)
        table.add(wheel.prototype, part_ids(ids, number), place, turn, white, owner=ids)


def part_ids(ids: NDArray[np.uint64], number: int) -> NDArray[np.uint64]:
    """Return (n,) ids of the n-th parts of movers."""
    return np.asarray(hash_ids(0, "mover/part", ids, number))


def _add_riders(
    table: _Table, seat: Seat, look: str, ids: NDArray[np.uint64], position: FloatArray,
    rotation: FloatArray, travelled: FloatArray, detail: int,
) -> None:  # fmt: skip
    phase = pedal_phase(seat, travelled)
    step = np.floor(phase * PHASES).astype(int) if seat.development else np.zeros(len(ids), int)
    who = rider_numbers(ids)
    white = np.ones((len(ids), 3), np.float32)
    for number, frame in sorted(set(zip(who.tolist(), step.tolist(), strict=True))):
        at = (who == number) & (step == frame)
        shape = _rider(look, seat, number, frame, detail)
        rows = part_ids(ids[at], RIDER_PART)
        table.add(shape, rows, position[at], rotation[at], white[at], owner=ids[at])


FIRST_PART, RIDER_PART = 50, 99  # beyond any number of wheels


def pedal_phase(seat: Seat, travelled: FloatArray) -> FloatArray:
    """Return (n,) turns of the pedals, 0 to 1."""
    return np.remainder(np.asarray(travelled) / max(seat.development, 1e-9), 1.0)


def rider_numbers(ids: NDArray[np.uint64]) -> NDArray[np.int64]:
    """Return (n,) number of the person who rides each."""
    return (uniform(0, "mover/rider", ids) * RIDERS).astype(np.int64)


def rider_look(number: int, seat: Seat) -> str:
    """Return the look of a rider: who has an engine wears a helmet, of cyclists every other."""
    bare = seat.development and number % 2
    helmet = "" if bare else CYCLE if seat.development else ENGINE
    return person_look(number, age="adult", style="casual", helmet=helmet)


@lru_cache(maxsize=512)
def _rider(look: str, seat: Seat, number: int, frame: int, detail: int) -> Prototype:
    fine = "_fine" if detail >= FINE else ""
    made = figure_of(rider_look(number, seat), detail)
    mesh = riding(made, seat.place, frame / PHASES, pedals=bool(seat.development))
    return prototype(f"rider_{number}_{look}_{frame}{fine}", RIDER, [mesh])


@dataclass(frozen=True)
class Dressed:
    """A person as tracks have one: a look, and a colour for the clothes or white for its own."""

    look: str
    tint: tuple[float, float, float]

    def figure(self, detail: int) -> Figure:
        """Return the figure."""
        if self.tint == _WHITE:
            return figure_of(self.look, detail)
        who = replace(person_of(self.look), top_color=self.tint)
        fine = detail >= FINE or self.look.endswith("_fine")
        return figure(who, detail=FINE if fine else 2)

    @property
    def name(self) -> str:
        """Word for prototypes."""
        if self.tint == _WHITE:
            return self.look
        return self.look + "_" + "".join(f"{round(255 * min(c, 1.0)):02x}" for c in self.tint)


def dressed(tracks: Tracks, row: int) -> Dressed:
    """Return the person of a row of tracks."""
    red, green, blue = tracks.tint[row].round(4).tolist()
    return Dressed(str(tracks.look[row]), (red, green, blue))


def gait_phase(
    stride: float | FloatArray, travelled: FloatArray, ids: NDArray[np.uint64]
) -> FloatArray:
    """Return (n,) how far people are in their cycle, not wrapped; no two begin together."""
    return np.asarray(travelled / stride + uniform(0, "mover/phase", ids))


def _people(tracks: Tracks, poses: Poses, detail: int) -> _Table:
    table = _Table()
    for at, row in enumerate(poses.row.tolist()):
        if not is_person(str(tracks.look[row])):
            continue
        who = dressed(tracks, row)
        gait = int(poses.gait[at])
        ids = tracks.object_id[[row]]
        stride = stride_of(who.figure(detail), gait)
        phase = gait_phase(stride, poses.travelled[[at]], ids)[0] % 1.0
        shape = _posed(who, gait, int(phase * PHASES), detail)
        turn = facing(poses.heading[[at]])
        table.add(shape, ids, poses.position[[at]], turn, np.ones((1, 3), np.float32))
    return table


@lru_cache(maxsize=2048)
def _posed(who: Dressed, gait: int, frame: int, detail: int) -> Prototype:
    fine = "_fine" if detail >= FINE and not who.look.endswith("_fine") else ""
    mesh = going(who.figure(detail), gait, frame / PHASES)
    return prototype(f"{who.name}{fine}_{GAITS[gait]}_{frame}", PERSON, [mesh])


def mover_counts(tracks: Tracks | None, moment: float) -> dict[str, int]:
    """Count vehicles and pedestrians that are in the city at a moment."""
    if tracks is None:
        return {"vehicles": 0, "pedestrians": 0}
    looks = tracks.look[poses_at(tracks, moment).row]
    walking = sum(map(is_person, looks.tolist()))
    return {"vehicles": len(looks) - walking, "pedestrians": walking}
