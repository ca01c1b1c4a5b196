"""Plans from files: cameras and trajectories of a user.

A file holds ``cameras`` or ``places`` as of `cityx.city.camera.read_cameras`, ``trajectories``, or
both. Beside what a camera has there it may have ``moment`` (0), seconds into the tracks,
``weather`` and ``time``. A trajectory is an object with

- ``name``: a word, unique in the file;
- ``keys``: two or more cameras, each with ``t``, seconds from the beginning, ascending;
- ``rate`` (10): frames per second, taken from the first key to the last;
- ``moment``, ``weather``, ``time``: as of a camera, ``moment`` is that of the first key;
- ``look_at`` (none): [x, y, z] in metres, looked at all the time instead of as the keys say.

Between keys the eye goes along a smooth curve and the view turns the shorter way; the field of view
is that of the first. The size of the pictures is that of the data set. Nothing is put in the place
of a view that may not be: all that are wrong are named at once.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from cityx.city.camera import Camera, Reader, named, read_camera, read_cameras, read_record
from cityx.city.city import City
from cityx.city.environment import Environment
from cityx.dataset.plans.takes import Take, still
from cityx.errors import InputError, UsageError
from cityx.geometry.arrays import FloatArray
from cityx.light.weather import lit_anew

LONGEST = 10_000  # frames of a trajectory
LATEST = 1e6  # seconds


@dataclass(frozen=True)
class Written:
    """A view or a trajectory of a file.

    Attributes
    ----------
    name
        As in the file, in letters of file names.
    take
        Its poses.
    light
        What it says about weather and time; None where it is silent.
    single
        Whether it is a camera, not a trajectory.
    """

    name: str
    take: Take
    light: Environment | None
    single: bool


def read_plan(path: Path, city: City) -> tuple[Written, ...]:
    """Read the cameras, then the trajectories of a file, each in its order.

    Raises
    ------
    InputError
        Listing every fault of the file.
    """
    reader, content = read_record(path, "a plan")
    parser = _Parser(reader, city)
    found: list[Written] = []
    if reader.faults == [] and not {"places", "cameras", "trajectories"} & set(content):
        reader.faults.append('none of "cameras", "places" and "trajectories" is given.')
    if "places" in content:
        cameras, light = read_cameras(path, city.frame, city.terrain, extent=city.layout.extent)
        lit = light.apply(city.environment)
        shown = None if lit == city.environment else lit
        found = [Written(_slug(camera.name), _one(camera, 0.0), shown, single=True)
                 for camera in cameras]  # fmt: skip
    else:
        for name, record in named(reader, content.get("cameras", []), "cameras"):
            found.append(parser.camera(name, record))
    for name, record in named(reader, content.get("trajectories", []), "trajectories"):
        found.append(parser.trajectory(name, record))
    if reader.faults:
        raise InputError(f"{path} cannot be used: " + " ".join(reader.faults))
    if not found:
        raise InputError(f"{path} has neither a camera nor a trajectory.")
    return tuple(found)


def _slug(name: str) -> str:
    kept = "".join(letter if letter.isalnum() else "-" for letter in name.lower())
    return kept.strip("-")[:40] or "view"


def _one(camera: Camera, moment: float) -> Take:
    return still(np.array(camera.position), camera.heading, camera.pitch, moment, camera.hfov)


@dataclass(frozen=True)
class _Parser:
    """Reads views; holds what all of them are read with."""

    reader: Reader
    city: City

    def camera(self, name: str, record: dict[str, Any]) -> Written:
        where = f"cameras.{name}"
        return Written(
            _slug(name), _one(self._camera(record, where), self._moment(record, where)),
            self._light(record, where), single=True,
        )  # fmt: skip

    def trajectory(self, name: str, record: dict[str, Any]) -> Written:
        where = f"trajectories.{record.get('name', name)}"
        keys = record.get("keys")
        rate = self.reader.number(record, "rate", where, 0.01, 1000, default=10.0)
        moment, light = self._moment(record, where), self._light(record, where)
        empty = Written(_slug(name), _one(Camera("", (0, 0, 0), 0, 0), 0.0), light, single=False)
        if not isinstance(keys, list) or len(keys) < 2:
            self.reader.faults.append(f"{where}: keys are {keys!r}, two or more are needed.")
            return empty
        before = len(self.reader.faults)
        records = [self.reader.record(key, f"{where}.keys[{k}]") for k, key in enumerate(keys)]
        time = np.array([self.reader.number(key, "t", f"{where}.keys[{k}]", 0, LATEST)
                         for k, key in enumerate(records)])  # fmt: skip
        # Along a trajectory that looks at something the keys need not say where they look.
        ahead = {"heading_deg": 0.0} if "look_at" in record else {}
        cameras = [self._camera(ahead | key, f"{where}.keys[{k}]") for k, key in enumerate(records)]
        target = self._place(record, where) if "look_at" in record else None
        if len(self.reader.faults) == before and (np.diff(time) <= 0).any():
            self.reader.faults.append(f"{where}: t of the keys is not ascending: {time.tolist()}.")
        if len(self.reader.faults) == before and (time[-1] - time[0]) * rate >= LONGEST:
            self.reader.faults.append(f"{where}: it has more than {LONGEST} frames.")
        if len(self.reader.faults) > before:
            return empty
        take = _between(cameras, time - time[0], rate, target)
        name = str(record.get("name", name))
        return Written(_slug(name), replace(take, moment=take.moment + moment), light, single=False)

    def _camera(self, record: dict[str, Any], where: str) -> Camera:
        frame, terrain = self.city.frame, self.city.terrain
        return read_camera(self.reader, record, "", where, frame, terrain, (1, 1))

    def _moment(self, record: dict[str, Any], where: str) -> float:
        return self.reader.number(record, "moment", where, 0, LATEST, default=0.0)

    def _place(self, record: dict[str, Any], where: str) -> FloatArray:
        spot = record["look_at"]
        if not isinstance(spot, list) or len(spot) != 3:
            self.reader.faults.append(f"{where}: look_at is {spot!r}, three numbers are needed.")
            return np.zeros(3)
        axes = dict(zip("xyz", spot, strict=True))
        return np.array([self.reader.number(axes, axis, f"{where}.look_at", -1e7, 1e7)
                         for axis in "xyz"])  # fmt: skip

    def _light(self, record: dict[str, Any], where: str) -> Environment | None:
        words = {key: record[key] for key in ("weather", "time") if key in record}
        if not words:
            return None
        wrong = [key for key, word in words.items() if not isinstance(word, str)]
        self.reader.faults += [f"{where}: {key} is {words[key]!r}, a word is needed."
                               for key in wrong]  # fmt: skip
        if wrong:
            return None
        try:
            frame = self.city.frame
            return lit_anew(self.city.environment, frame.latitude, frame.longitude, **words)
        except UsageError as error:
            self.reader.faults.append(f"{where}: {error}")
            return None


def _between(keys: list[Camera], time: FloatArray, rate: float, target: FloatArray | None) -> Take:
    """Return the poses at even steps of time between keys."""
    from scipy.interpolate import PchipInterpolator

    now = np.arange(int(np.floor(time[-1] * rate + 1e-9)) + 1) / rate
    place = np.array([key.position for key in keys])
    position = np.asarray(PchipInterpolator(time, place, axis=0)(now))
    # Angles go on from each key to the next by the shorter turn.
    heading = np.interp(now, time, np.unwrap([key.heading for key in keys]))
    pitch = np.interp(now, time, [key.pitch for key in keys])
    if target is not None:
        way = target - position
        heading = np.unwrap(np.arctan2(way[:, 0], way[:, 1]))
        pitch = np.arctan2(way[:, 2], np.hypot(way[:, 0], way[:, 1]))
    return Take(position, heading, pitch, now, keys[0].hfov)
