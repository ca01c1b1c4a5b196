"""Rigs: cameras that are fixed to each other and take their pictures at the same moment.

References
----------
Caesar et al., "nuScenes: a multimodal dataset for autonomous driving", CVPR 2020: five cameras of
70 degrees set 55 degrees apart, one of 110 degrees to the back.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import isfinite, pi, radians
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from cityx.city.camera import Camera
from cityx.errors import InputError, UsageError, nearest

STEREO_BASELINE = 0.12  # metres
FARTHEST = 20.0  # metres of a camera from the point that carries the rig


@dataclass(frozen=True)
class Mount:
    """One camera of a rig.

    Attributes
    ----------
    sensor
        Its name: "left", "front_right", ...
    offset
        Metres ahead, to the left and up from the point that carries the rig. Rigs turn about the
        vertical and stay level, whatever the pitch.
    yaw
        Radians to the left of the rig's heading.
    pitch
        Radians up from the rig's pitch.
    hfov
        Horizontal field of view, radians; None is that of the plan.
    """

    sensor: str
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)
    yaw: float = 0.0
    pitch: float = 0.0
    hfov: float | None = None


Rig = tuple[Mount, ...]

# Where nuScenes' cameras sit on the roof of a car, (ahead, left) about their common middle, and the
# yaw and field of view of each, degrees.
_SURROUND = (
    ("back", (-1.12, 0.0), 180.0, 110.0), ("back_left", (-0.12, 0.48), 110.0, 70.0),
    ("back_right", (-0.14, -0.48), -110.0, 70.0), ("front", (0.55, 0.0), 0.0, 70.0),
    ("front_left", (0.42, 0.50), 55.0, 70.0), ("front_right", (0.40, -0.49), -55.0, 70.0),
)  # fmt: skip
RIGS: Mapping[str, Rig] = MappingProxyType({
    "mono": (Mount("mono"),),
    "stereo": (
        Mount("left", (0.0, STEREO_BASELINE / 2, 0.0)),
        Mount("right", (0.0, -STEREO_BASELINE / 2, 0.0)),
    ),
    "surround": tuple(
        Mount(sensor, (ahead, left, 0.0), radians(yaw), 0.0, radians(hfov))
        for sensor, (ahead, left), yaw, hfov in _SURROUND
    ),
})  # fmt: skip


def rig_named(word: str) -> Rig:
    """Return the rig of a name, or that of a JSON file.

    A file holds ``{"sensors": [{"sensor": "roof", "offset": [0.5, 0, 0.2], "yaw_deg": 90,
    "pitch_deg": -10, "hfov_deg": 90}, ...]}``; all but the name may be left out.

    Returns
    -------
    rig
        Its cameras by name, which is the order of the pictures.

    Raises
    ------
    UsageError
        If there is neither a rig nor a file of that name.
    InputError
        With every fault of the file.
    """
    if word in RIGS:
        return RIGS[word]
    path = Path(word)
    if not path.is_file():
        raise UsageError(
            f'there is no rig "{word}": it is neither a file nor one of {", ".join(RIGS)}.'
            f"{nearest(word, RIGS)}"
        )
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise InputError(f"{path} cannot be read as a rig: {error}.") from error
    return _read(path, content)


def _read(path: Path, content: Any) -> Rig:
    records = content.get("sensors") if isinstance(content, dict) else None
    if not isinstance(records, list) or not records:
        raise InputError(f'{path} cannot be used: "sensors", a list of cameras, is missing.')
    faults: list[str] = []
    mounts = [_mount(record, f"sensors[{row}]", faults) for row, record in enumerate(records)]
    names = [mount.sensor for mount in mounts]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        faults.append(f"{', '.join(twice)} is there more than once.")
    if faults:
        raise InputError(f"{path} cannot be used: " + " ".join(faults))
    return tuple(sorted(mounts, key=lambda mount: mount.sensor))


def _mount(record: Any, where: str, faults: list[str]) -> Mount:
    if not isinstance(record, dict):
        faults.append(f"{where} is {type(record).__name__}, an object is needed.")
        return Mount(where)
    name = record.get("sensor")
    if not isinstance(name, str) or not name.replace("_", "").isalnum() or name != name.lower():
        faults.append(f"{where}: sensor is {name!r}, a word of a-z, 0-9 and _ is needed.")
        name = where

    def number(value: Any, what: str, low: float, high: float) -> float:
        if isinstance(value, bool) or not isinstance(value, int | float) or not isfinite(value):
            faults.append(f"{where}: {what} is {value!r}, a number is needed.")
            return 0.0
        if not low <= value <= high:
            faults.append(f"{where}: {what} is {value:g}, allowed is {low:g} to {high:g}.")
        return float(value)

    offset = record.get("offset", [0.0, 0.0, 0.0])
    if not isinstance(offset, list) or len(offset) != 3:
        faults.append(f"{where}: offset is {offset!r}, metres ahead, left and up are needed.")
        offset = [0.0, 0.0, 0.0]
    ahead, left, up = (number(value, "offset", -FARTHEST, FARTHEST) for value in offset)
    hfov = record.get("hfov_deg")
    return Mount(
        name,
        (ahead, left, up),
        radians(number(record.get("yaw_deg", 0.0), "yaw_deg", -360, 360)),
        radians(number(record.get("pitch_deg", 0.0), "pitch_deg", -90, 90)),
        None if hfov is None else radians(number(hfov, "hfov_deg", 1, 175)),
    )


def mounted(camera: Camera, rig: Sequence[Mount]) -> tuple[Camera, ...]:
    """Return the cameras of a rig that is carried where a camera stands and looks as it looks.

    Their names are those of the sensors.
    """
    sine, cosine = np.sin(camera.heading), np.cos(camera.heading)
    found = []
    for mount in rig:
        ahead, left, up = mount.offset
        x, y, z = camera.position
        eye = (
            float(x + ahead * sine - left * cosine),
            float(y + ahead * cosine + left * sine),
            float(z + up),
        )
        pitch = min(max(camera.pitch + mount.pitch, -pi / 2), pi / 2)
        hfov = camera.hfov if mount.hfov is None else mount.hfov
        found.append(
            replace(camera, name=mount.sensor, position=eye, pitch=pitch, hfov=hfov,
                    heading=(camera.heading - mount.yaw) % (2 * pi))
        )  # fmt: skip
    return tuple(found)
