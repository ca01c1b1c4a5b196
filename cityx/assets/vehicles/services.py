"""What tells police cars, ambulances and fire engines from others: light bars and stripes.

Frame: the front looks to -y, x to the left, z up, metres, origin on the ground under the middle.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from cityx.assets.shapes import Color, box
from cityx.assets.vehicles.car_bodies import Body
from cityx.city.mesh import MeshBatch

BLUE, YELLOW, RED = (0.010, 0.045, 0.30), (0.62, 0.42, 0.02), (0.50, 0.018, 0.016)
WHITE_BAND: Color = (0.85, 0.85, 0.84)
# Service -> the two colours of the checks along its sides.
CHECKS: Mapping[str, tuple[Color, Color]] = MappingProxyType(
    {"police": (BLUE, YELLOW), "ambulance": (RED, YELLOW)}
)
CHECK = 0.42  # metres of one check
PROUD = 0.006  # metres by which stripes stand before the body
DARK: Color = (0.03, 0.03, 0.032)


def service_parts(body: Body) -> list[MeshBatch]:
    """Make the light bar and the checks of a body of a service; nothing of others."""
    if body.service not in CHECKS:
        return []
    line = np.array(body.roof)
    at = 1 if body.cargo else 2  # over the cab of a van
    share, z, wide = line[at]
    y = (share + (0.06 if body.cargo else -0.04)) * body.length - body.length / 2
    z = float(np.interp(share + (0.06 if body.cargo else -0.04), line[:, 0], line[:, 1]))
    return [*light_bar(y, z, 0.78 * wide * body.width / 2), *_checks(body)]


def light_bar(y: float, z: float, half: float, *, beacon: str = "beacon_blue") -> list[MeshBatch]:
    """Set a bar with two lights of a material across a roof."""
    parts = [box((-half, y - 0.11, z - 0.02), (half, y + 0.11, z + 0.03), "plastic", DARK)]
    for side in (-1.0, 1.0):
        x = sorted((side * 0.10, side * half))
        low, high = (x[0], y - 0.12, z + 0.03), (x[1], y + 0.12, z + 0.14)
        parts.append(box(low, high, beacon))
    parts.append(box((-0.10, y - 0.10, z + 0.03), (0.10, y + 0.10, z + 0.11), "lens_white"))
    return parts


def _checks(body: Body) -> list[MeshBatch]:
    """Lay two rows of checks along the sides, between the wheels and on the doors."""
    half, length = body.width / 2, body.length
    front, rear = (share * length - length / 2 for share in body.axles)
    low, high = (0.62, 0.98) if body.cargo else (0.50, 0.74)
    begin, end = front + body.wheel + 0.10, rear - body.wheel - 0.10
    if body.cargo:
        begin, end = front + body.wheel + 0.10, length / 2 - 0.30
    count = max(int((end - begin) / CHECK), 2)
    step, rise = (end - begin) / count, (high - low) / 2
    parts = []
    for side in (-1.0, 1.0):
        x = sorted((side * (half - 0.04), side * (half + PROUD)))
        first, second = CHECKS[body.service]
        parts.append(box((x[0], begin, low), (x[1], end, high), "plastic", first))
        over = sorted((x[0], x[1] + 0.003) if side > 0 else (x[0] - 0.003, x[1]))
        for number in range(count):
            y, z = begin + number * step, low + (number % 2) * rise
            parts.append(box((over[0], y, z), (over[1], y + step, z + rise), "plastic", second))
    return parts
