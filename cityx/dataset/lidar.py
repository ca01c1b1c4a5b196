"""LiDAR: sweeps of spinning and of solid-state sensors through a city.

Beams are sent one after the other: a sensor that moves during its sweep sees each point from where
it is then, and all points are given in its frame at the beginning (motion-compensated). The city
stands still during a sweep. Ranges are exact; noise is left to who trains on them.

References
----------
Velodyne, VLP-16, HDL-32E and HDL-64E user manuals. Ouster, OS1 datasheet (128 channels).
R. Brazeal, B. Wilkinson, H. Hochmair, "A rigorous observation model for the Risley prism-based
Livox Mid-40 lidar sensor", Sensors 21, 2021.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from cityx.assets.styles.materials import material_named
from cityx.city.camera import Camera, axes
from cityx.dataset.record import Sweep
from cityx.dataset.shots import Shot
from cityx.dataset.stage import SKY_MATERIAL, Stage
from cityx.errors import UsageError, nearest
from cityx.geometry.arrays import FloatArray
from cityx.geometry.raycast import normals

LUMA = np.array([0.2126, 0.7152, 0.0722])


@dataclass(frozen=True)
class Beams:
    """The beams of one sweep, n of them, in the order in which they are sent.

    Attributes
    ----------
    azimuth, elevation
        (n,) radians: counter-clockwise from ahead, and up.
    beam
        (n,) uint16, ring or channel.
    time
        (n,) seconds since the sweep began.
    """

    azimuth: FloatArray
    elevation: FloatArray
    beam: NDArray[np.uint16]
    time: FloatArray


@dataclass(frozen=True)
class Spinning:
    """A sensor whose column of beams turns clockwise, seen from above.

    Attributes
    ----------
    elevations
        Of the beams from ring 0 on, degrees.
    columns
        Firings per turn.
    rate
        Turns per second.
    near, reach
        Metres between which it measures.
    """

    elevations: tuple[float, ...]
    columns: int
    rate: float = 10.0
    near: float = 0.5
    reach: float = 100.0

    def beams(self, moment: float) -> Beams:
        """Return the beams of a sweep; every one is the same."""
        del moment
        count = len(self.elevations)
        turn = np.repeat(np.arange(self.columns) / self.columns, count)
        # Rings fire one after the other within the time of a column.
        late = np.tile(np.arange(count) / count, self.columns) / self.columns
        return Beams(
            -2 * np.pi * turn,
            np.tile(np.radians(self.elevations), self.columns),
            np.tile(np.arange(count, dtype=np.uint16), self.columns),
            (turn + late) / self.rate,
        )


@dataclass(frozen=True)
class Raster:
    """A solid-state sensor that scans a field of view line by line, from the upper left.

    Attributes
    ----------
    width, height
        Field of view, degrees.
    columns, lines
        Beams across and down.
    rate
        Sweeps per second.
    near, reach
        Metres between which it measures.
    """

    width: float = 120.0
    height: float = 25.0
    columns: int = 600
    lines: int = 126
    rate: float = 10.0
    near: float = 0.5
    reach: float = 150.0

    def beams(self, moment: float) -> Beams:
        """Return the beams of a sweep; every one is the same."""
        del moment
        across = np.radians(self.width) * (0.5 - (np.arange(self.columns) + 0.5) / self.columns)
        down = np.radians(self.height) * (0.5 - (np.arange(self.lines) + 0.5) / self.lines)
        count = self.columns * self.lines
        return Beams(
            np.tile(across, self.lines),
            np.repeat(down, self.columns),
            np.repeat(np.arange(self.lines, dtype=np.uint16), self.columns),
            np.arange(count) / count / self.rate,
        )


@dataclass(frozen=True)
class Rosette:
    """A solid-state sensor with two turning prisms, whose pattern never comes again.

    Attributes
    ----------
    width
        Field of view, a cone, degrees.
    points
        Beams per second.
    turns
        Of the two prisms, per minute, as of a Livox Mid-40.
    rate
        Sweeps per second.
    near, reach
        Metres between which it measures.
    """

    width: float = 38.4
    points: int = 100_000
    turns: tuple[float, float] = (7294.0, -4664.0)
    rate: float = 10.0
    near: float = 0.5
    reach: float = 200.0

    def beams(self, moment: float) -> Beams:
        """Return the beams of the sweep that begins at a moment, seconds."""
        count = round(self.points / self.rate)
        time = np.arange(count) / self.points
        one, two = (2 * np.pi * (turns / 60) * (moment + time) for turns in self.turns)
        half = np.radians(self.width) / 4  # two equal prisms bend by half of the cone's each
        return Beams(
            half * (np.cos(one) + np.cos(two)),
            half * (np.sin(one) + np.sin(two)),
            np.zeros(count, np.uint16),
            time,
        )


Lidar = Spinning | Raster | Rosette


def _steps(first: float, last: float, count: int) -> tuple[float, ...]:
    return tuple(np.linspace(first, last, count).round(4).tolist())


LIDARS: Mapping[str, Lidar] = MappingProxyType({
    # VLP-16: 2 degrees apart, 300,000 points per second.
    "spinning_16": Spinning(_steps(-15.0, 15.0, 16), 1875),
    # HDL-32E: 4/3 degrees apart, 700,000 points per second.
    "spinning_32": Spinning(_steps(-30.6667, 10.6667, 32), 2187),
    # HDL-64E: a lower block 1/2 and an upper block 1/3 degree apart, 1.3 million per second.
    "spinning_64": Spinning(
        (*_steps(-24.3333, -8.8333, 32), *_steps(-8.3333, 2.0, 32)), 2031, reach=120.0
    ),
    # OS1-128: uniform over 45 degrees, 1.3 million points per second.
    "spinning_128": Spinning(_steps(-22.5, 22.5, 128), 1024, reach=120.0),
    "solid_raster": Raster(),
    "solid_rosette": Rosette(),
})  # fmt: skip


def lidar_named(name: str) -> Lidar:
    """Return a sensor of the table.

    Raises
    ------
    UsageError
        If there is none of that name.
    """
    if name not in LIDARS:
        hint = nearest(name, LIDARS) or f" Known are: {', '.join(LIDARS)}."
        raise UsageError(f'There is no LiDAR "{name}".{hint}')
    return LIDARS[name]


def sweep_of(
    stage: Stage,
    shot: Shot,
    lidar: Lidar,
    *,
    after: Shot | None = None,
    threads: int | None = None,
) -> Sweep:
    """Sweep a city from where the camera of a shot is, ahead along its view.

    Beams that meet nothing within reach leave no point.

    Parameters
    ----------
    stage
        The city at the moment of the shot.
    shot
        Its camera is the sensor's place and direction.
    lidar
        The sensor.
    after
        Next frame of the sequence, towards which the sensor moves during the sweep.
    threads
        That share the work; what is found is the same for any number.
    """
    beams = lidar.beams(shot.moment)
    flat = np.cos(beams.elevation)
    local = np.column_stack([
        flat * np.cos(beams.azimuth), flat * np.sin(beams.azimuth), np.sin(beams.elevation)
    ])  # fmt: skip
    eyes, ahead = _sent(shot, after, beams.time, local)
    hits = stage.cast(eyes + lidar.near * ahead, ahead, reach=lidar.reach - lidar.near,
                      threads=threads)  # fmt: skip
    met = np.flatnonzero(hits.instance >= 0)
    there = eyes[met] + (hits.distance[met] + lidar.near)[:, None] * ahead[met]
    cosine = np.abs((normals(stage.rays, hits, ahead)[met] * ahead[met]).sum(axis=1))
    rows = stage.rows(hits)[met]
    return Sweep(
        ((there - np.array(shot.camera.position)) @ sensor_axes(shot.camera).T).astype(np.float32),
        beams.beam[met],
        beams.time[met].astype(np.float32),
        stage.object_id[rows],
        stage.semantic[rows],
        (cosine * _reflectance(stage)[stage.materials_at(hits)[met]]).astype(np.float32),
    )


def sensor_axes(camera: Camera) -> FloatArray:
    """Return the (3, 3) rows ahead, left and up of a sensor, in the frame of the city."""
    right, down, ahead = axes(camera)
    return np.array([ahead, -right, -down])


def _sent(
    shot: Shot, after: Shot | None, time: FloatArray, local: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the (n, 3) places of the sensor and directions of beams, in the frame of the city."""
    camera = shot.camera
    place = np.broadcast_to(np.array(camera.position), local.shape)
    gap = 0.0 if after is None else after.moment - shot.moment
    if after is None or gap <= 0:
        return np.array(place), local @ sensor_axes(camera)
    share = time / gap
    step = np.array(after.camera.position) - np.array(camera.position)
    turn = np.remainder(after.camera.heading - camera.heading + np.pi, 2 * np.pi) - np.pi
    heading = camera.heading + share * turn
    pitch = camera.pitch + share * (after.camera.pitch - camera.pitch)
    sh, ch, sp, cp = np.sin(heading), np.cos(heading), np.sin(pitch), np.cos(pitch)
    ahead = np.column_stack([sh * cp, ch * cp, sp])
    left = np.column_stack([-ch, sh, np.zeros(len(sh))])
    up = np.column_stack([-sh * sp, -ch * sp, cp])
    sent = local[:, :1] * ahead + local[:, 1:2] * left + local[:, 2:] * up
    return place + share[:, None] * step, sent


def _reflectance(stage: Stage) -> FloatArray:
    """Return the share of light that each material of a stage sends back, by number."""
    colors = [
        np.zeros(3) if name == SKY_MATERIAL else np.array(material_named(name).color)
        for name in stage.materials
    ]
    return np.asarray(np.clip(np.array(colors) @ LUMA, 0.0, 1.0))
