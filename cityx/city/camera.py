"""Cameras: where a picture is taken from."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from math import isfinite, pi, radians
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cityx.city.environment import Environment
from cityx.city.frame import Frame
from cityx.city.terrain import Terrain
from cityx.errors import InputError, nearest

DEFAULT_SIZE = (960, 540)
DEFAULT_FOV = radians(65)


@dataclass(frozen=True)
class Camera:
    """A pinhole camera without roll.

    Attributes
    ----------
    name
        Name of the picture.
    position
        Eye point, scene frame, metres.
    heading
        Radians clockwise from north.
    pitch
        Radians, positive up.
    hfov
        Horizontal field of view, radians.
    width, height
        Of the picture in pixels.
    """

    name: str
    position: tuple[float, float, float]
    heading: float
    pitch: float
    hfov: float = DEFAULT_FOV
    width: int = DEFAULT_SIZE[0]
    height: int = DEFAULT_SIZE[1]


@dataclass(frozen=True)
class Light:
    """What a camera file says about light and quality; None where it is silent.

    Attributes
    ----------
    sun_elevation, sun_azimuth
        Radians; azimuth clockwise from north.
    sky_strength, exposure
        As in `Environment`.
    samples
        Samples per pixel.
    """

    sun_elevation: float | None = None
    sun_azimuth: float | None = None
    sky_strength: float | None = None
    exposure: float | None = None
    samples: int | None = None

    def apply(self, environment: Environment) -> Environment:
        """Return the environment with the values that the file gives."""
        names = ("sun_elevation", "sun_azimuth", "sky_strength", "exposure")
        given = {name: getattr(self, name) for name in names}
        return replace(environment, **{k: v for k, v in given.items() if v is not None})


class Reader:
    """Reads numbers out of JSON and gathers every fault; a class because the list grows."""

    def __init__(self) -> None:
        self.faults: list[str] = []

    def number(
        self, record: dict[str, Any], key: str, where: str, low: float, high: float,
        default: float | None = None,
    ) -> float:  # fmt: skip
        """Return a number of a record, `low` where it is none; what is wrong is gathered."""
        value = record.get(key, default)
        if value is None:
            near = nearest(key, record)
            self.faults.append(f"{where}: {key} is missing.{near}")
            return low
        if isinstance(value, bool) or not isinstance(value, int | float) or not isfinite(value):
            self.faults.append(f"{where}: {key} is {value!r}, a number is needed.")
            return low
        if not low <= value <= high:
            self.faults.append(f"{where}: {key} is {value}, allowed is {low:g} to {high:g}.")
        return float(value)

    def record(self, value: Any, where: str) -> dict[str, Any]:
        """Return a value that must be an object, an empty one where it is none."""
        if isinstance(value, dict):
            return value
        self.faults.append(f"{where} is {type(value).__name__}, an object is needed.")
        return {}


def read_record(path: Path, what: str) -> tuple[Reader, dict[str, Any]]:
    """Return the object that a JSON file holds, and the reader that gathers its faults.

    Parameters
    ----------
    path
        The file.
    what
        What is read from it: "cameras".

    Raises
    ------
    InputError
        If the file cannot be read or is not JSON.
    """
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(f"cannot read {what} from {path}: {error.strerror}.") from error
    except ValueError as error:
        raise InputError(f"{path} is not JSON: {error}.") from error
    reader = Reader()
    return reader, reader.record(content, "the file")


def read_cameras(
    path: Path,
    frame: Frame,
    terrain: Terrain,
    *,
    extent: tuple[float, float, float, float] | None = None,
) -> tuple[tuple[Camera, ...], Light]:
    """Read cameras from a JSON file.

    Two forms are read. ``{"places": {place: {"cameras": {name: camera}}}}`` holds the views of
    several sites, of which those inside `extent` are taken; ``{"cameras": [camera, ...]}`` (or an
    object by name) holds the views of one. A camera has ``lat``, ``lon``, ``height_m`` above the
    ground, or ``position`` [x, y, z] in metres; ``heading_deg``, ``pitch_deg`` (0), ``hfov_deg``
    (65), ``width`` and ``height`` in pixels. An optional ``render`` object holds ``width``,
    ``height``, ``samples``, ``exposure``, ``sun_elevation_deg``, ``sun_azimuth_deg`` and
    ``sky_strength``; other keys in it are notes and change nothing.

    Parameters
    ----------
    path
        The file.
    frame, terrain
        Of the city: where its origin lies and how high its ground is.
    extent
        (xmin, ymin, xmax, ymax) of the city; None takes every place.

    Returns
    -------
    cameras, light

    Raises
    ------
    InputError
        Listing every fault of the file.
    """
    reader, content = read_record(path, "cameras")
    size, light = _read_render(reader, content.get("render", {}))
    if reader.faults == [] and not {"places", "cameras"} & set(content):
        reader.faults.append('neither "places" nor "cameras" is given.')
    cameras = [
        read_camera(reader, record, name, f"cameras.{name}", frame, terrain, size)
        for name, record in named(reader, content.get("cameras", []), "cameras")
    ]
    inside = _Places(reader, frame, terrain, size, extent)
    cameras += inside.read(content.get("places", {}))
    if reader.faults:
        raise InputError(f"{path} cannot be used: " + " ".join(reader.faults))
    if not cameras:
        known = ", ".join(sorted(content.get("places", {}))) or "none"
        raise InputError(f"{path} has no camera inside the site. Its places: {known}.")
    return tuple(cameras), light


@dataclass(frozen=True)
class _Places:
    """The form that holds the views of several sites."""

    reader: Reader
    frame: Frame
    terrain: Terrain
    size: tuple[int, int]
    extent: tuple[float, float, float, float] | None

    def read(self, places: Any) -> list[Camera]:
        found: dict[str, list[Camera]] = {}
        for place, record in self.reader.record(places, "places").items():
            where = f"places.{place}"
            views = self.reader.record(record, where).get("cameras", {})
            cameras = [
                read_camera(
                    self.reader, view, name, f"{where}.{name}", self.frame, self.terrain, self.size
                )
                for name, view in named(self.reader, views, f"{where}.cameras")
            ]
            found[place] = [camera for camera in cameras if self._inside(camera)]
        found = {place: cameras for place, cameras in found.items() if cameras}
        # One place is the usual case: then its name need not be in the name of the picture.
        return [
            replace(camera, name=camera.name if len(found) == 1 else f"{place}_{camera.name}")
            for place, cameras in found.items()
            for camera in cameras
        ]

    def _inside(self, camera: Camera) -> bool:
        if self.extent is None:
            return True
        xmin, ymin, xmax, ymax = self.extent
        x, y, _ = camera.position
        return xmin <= x <= xmax and ymin <= y <= ymax


def named(reader: Reader, value: Any, where: str) -> list[tuple[str, dict[str, Any]]]:
    """Return cameras with their names, from a list or from an object by name."""
    if isinstance(value, dict):
        return [(name, reader.record(view, f"{where}.{name}")) for name, view in value.items()]
    if not isinstance(value, list):
        reader.faults.append(f"{where} is {type(value).__name__}, a list or an object is needed.")
        return []
    records = [reader.record(view, f"{where}[{index}]") for index, view in enumerate(value)]
    return [(str(view.get("name", f"camera{i}")), view) for i, view in enumerate(records)]


def _read_render(reader: Reader, value: Any) -> tuple[tuple[int, int], Light]:
    record = reader.record(value, "render")

    def read(key: str, low: float, high: float) -> float | None:
        return reader.number(record, key, "render", low, high) if key in record else None

    width, height = read("width", 1, 16384), read("height", 1, 16384)
    elevation, azimuth = read("sun_elevation_deg", -90, 90), read("sun_azimuth_deg", -360, 360)
    samples = read("samples", 1, 65536)
    light = Light(
        None if elevation is None else radians(elevation),
        None if azimuth is None else radians(azimuth) % (2 * pi),
        read("sky_strength", 0, 100),
        read("exposure", -32, 32),
        None if samples is None else int(samples),
    )
    return (int(width or DEFAULT_SIZE[0]), int(height or DEFAULT_SIZE[1])), light


def read_camera(
    reader: Reader,
    record: dict[str, Any],
    name: str,
    where: str,
    frame: Frame,
    terrain: Terrain,
    size: tuple[int, int],
) -> Camera:
    """Read one camera; see `read_cameras` for what it holds.

    Parameters
    ----------
    reader
        Gathers what is wrong.
    record, name, where
        The camera, its name, and where in the file it is.
    frame, terrain
        Of the city.
    size
        Of its picture where it gives none.
    """
    before = len(reader.faults)
    x = y = z = 0.0
    if "position" in record:
        spot = record["position"]
        if not isinstance(spot, list) or len(spot) != 3:
            reader.faults.append(f"{where}: position is {spot!r}, three numbers are needed.")
        else:
            axes = dict(zip("xyz", spot, strict=True))
            x, y, z = (reader.number(axes, axis, f"{where}.position", -1e7, 1e7) for axis in "xyz")
    else:
        latitude = reader.number(record, "lat", where, -90, 90)
        longitude = reader.number(record, "lon", where, -180, 180)
        height = reader.number(record, "height_m", where, -1000, 1e6, default=1.7)
        if len(reader.faults) == before:
            point = frame.to_local([[longitude, latitude]])
            x, y = point[0].tolist()
            # A place on the far side of the Earth has no local coordinates.
            if not (isfinite(x) and isfinite(y)):
                x = y = 1e9
            z = float(terrain.height_at([[x, y]])[0]) + height
    return Camera(
        name,
        (x, y, z),
        radians(reader.number(record, "heading_deg", where, -360, 360)) % (2 * pi),
        radians(reader.number(record, "pitch_deg", where, -90, 90, default=0.0)),
        radians(reader.number(record, "hfov_deg", where, 1, 175, default=65.0)),
        int(reader.number(record, "width", where, 1, 16384, default=size[0])),
        int(reader.number(record, "height", where, 1, 16384, default=size[1])),
    )


def intrinsics(camera: Camera) -> NDArray[np.float64]:
    """Return the (3, 3) matrix K of a camera: square pixels, principal point in the middle.

    Pixel (0.5, 0.5) is the middle of the pixel at the upper left; x to the right, y down.
    """
    focal = camera.width / 2 / np.tan(camera.hfov / 2)
    return np.array(
        [[focal, 0.0, camera.width / 2], [0.0, focal, camera.height / 2], [0.0, 0.0, 1.0]]
    )


def axes(camera: Camera) -> NDArray[np.float64]:
    """Return the (3, 3) rows right, down and ahead of a camera, in the frame of the city."""
    sh, ch = np.sin(camera.heading), np.cos(camera.heading)
    sp, cp = np.sin(camera.pitch), np.cos(camera.pitch)
    right = (ch, -sh, 0.0)
    down = (sh * sp, ch * sp, -cp)
    ahead = (sh * cp, ch * cp, sp)
    return np.array([right, down, ahead])


def rays(camera: Camera) -> NDArray[np.float64]:
    """Return (h, w, 3) directions through the middles of the pixels, of depth 1 along the view."""
    focal = camera.width / 2 / np.tan(camera.hfov / 2)
    x = (np.arange(camera.width) + 0.5 - camera.width / 2) / focal
    y = (np.arange(camera.height) + 0.5 - camera.height / 2) / focal
    right, down, ahead = axes(camera)
    found: NDArray[np.float64] = ahead + x[None, :, None] * right + y[:, None, None] * down
    return found


def project(
    camera: Camera, points: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return where (n, 3) points are seen, (n, 2) pixels, and their depth, (n,) metres.

    Points behind the eye have a depth of at most 0 and no meaningful pixel.
    """
    local = (points - np.array(camera.position)) @ axes(camera).T
    focal = camera.width / 2 / np.tan(camera.hfov / 2)
    depth = local[:, 2]
    with np.errstate(divide="ignore", invalid="ignore"):
        seen = local[:, :2] / depth[:, None] * focal
    middle = np.array([camera.width / 2, camera.height / 2])
    return seen + middle, depth
