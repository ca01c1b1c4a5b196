"""Buses, lorries and trams at real size: bodies without wheels, and where their wheels stand.

Frame: the front looks to -y, x to the left, z up, metres, origin on the ground under the middle.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from cityx.assets.shapes import WHITE, Color, box, cylinder, loft, tube
from cityx.assets.vehicles.services import light_bar
from cityx.city.mesh import MeshBatch

Shapes = list[MeshBatch]
ARCH_GAP = 0.07  # metres between a tyre and the edge of the body over it
ARCH_STEPS = 9
CORNER = 0.16  # metres, radius of the upright corners of a body
PANE_OUT = 0.004  # metres by which panes stand before the body


@dataclass(frozen=True)
class Large:
    """What a large vehicle is made of.

    Attributes
    ----------
    size
        Length, width and height, metres.
    wheel
        Radius of a wheel, metres.
    axles
        Metres from the middle to each axle, the front ones negative.
    parts
        Makes the body.
    """

    size: tuple[float, float, float]
    wheel: float
    axles: tuple[float, ...]
    parts: Callable[[Large], Shapes]

    def wheel_places(self) -> list[tuple[float, float, float]]:
        """Return the middles of the outer faces of the wheels, metres; x > 0 is the left side."""
        half = self.size[1] / 2 - 0.03
        return [(side * half, y, self.wheel) for y in self.axles for side in (-1.0, 1.0)]


def hull(
    model: Large, front: float, rear: float, low: float, high: float, *, inset: float = 0.0,
    arches: bool = False, material: str = "car_paint", tint: Color = WHITE,
) -> MeshBatch:  # fmt: skip
    """Make a box with rounded upright corners, which leaves room for the wheels.

    Parameters
    ----------
    model
        The vehicle, for its width and wheels.
    front, rear
        y of its ends, metres.
    low, high
        z of its lower and upper edge, metres.
    inset
        Metres by which it is narrower than the vehicle on each side.
    arches
        Whether the lower edge rises over the wheels.
    material, tint
        Of all its faces.
    """
    half = model.size[1] / 2 - inset
    ends = CORNER * (1 - np.cos(np.linspace(0, np.pi / 2, 4)))
    places = [front + ends, rear - ends]
    gap = model.wheel + ARCH_GAP
    axles = [y for y in model.axles if arches and front < y < rear]
    turns = np.cos(np.linspace(np.pi, 0, ARCH_STEPS))
    places += [np.clip(y + gap * turns, front + CORNER, rear - CORNER) for y in axles]
    y = np.unique(np.round(np.concatenate(places), 4))
    near = np.minimum(y - front, rear - y).clip(0, CORNER)
    width = half - CORNER + np.sqrt(CORNER**2 - (CORNER - near) ** 2)
    foot = np.full(len(y), low)
    for axle in axles:
        over = np.sqrt(np.maximum(gap**2 - (y - axle) ** 2, 0.0))
        foot = np.maximum(foot, np.where(over > 0, model.wheel + over, low))
    foot = np.minimum(foot, high - 0.05)
    rings = np.stack(
        [np.column_stack([x * width, y, z]) for x, z in
         ((1, foot), (1, np.full(len(y), high)), (-1, np.full(len(y), high)), (-1, foot))],
        axis=1,
    )  # fmt: skip
    return loft(rings[:, ::-1], material, tint)


def panes(
    model: Large, spans: Sequence[tuple[float, float]], low: float, high: float,
    sides: Sequence[float] = (-1.0, 1.0), material: str = "car_glass",
) -> Shapes:  # fmt: skip
    """Set panes into the sides between pairs of y; x > 0 is the left."""
    face = model.size[1] / 2
    found = []
    for front, rear in spans:
        for side in sides:
            x = sorted((side * (face - 0.02), side * (face + PANE_OUT)))
            found.append(box((x[0], front, low), (x[1], rear, high), material))
    return found


def windscreen(model: Large, low: float, high: float, *, rear: bool = False) -> MeshBatch:
    """Set a pane before the front or behind the rear."""
    half, end = model.size[1] / 2 - CORNER, model.size[0] / 2
    y = (end - 0.02, end + PANE_OUT) if rear else (-end - PANE_OUT, -end + 0.02)
    return box((-half, y[0], low), (half, y[1], high), "car_glass")


def lamps(model: Large, height: float) -> Shapes:
    """Set headlights, rear lights and number plates."""
    half, end = model.size[1] / 2, model.size[0] / 2
    found = [
        box((-0.26, -end - 0.02, height - 0.22), (0.26, -end + 0.02, height - 0.11), "plate_white"),
        box((-0.26, end - 0.02, height - 0.05), (0.26, end + 0.02, height + 0.06), "plate_white"),
    ]
    for side in (-1.0, 1.0):
        x = sorted((side * (half - 0.5), side * (half - 0.18)))
        found.append(
            box((x[0], -end - 0.012, height), (x[1], -end + 0.03, height + 0.16), "lens_white")
        )
        x = sorted((side * (half - 0.34), side * (half - 0.18)))
        low, high = (x[0], end - 0.03, height), (x[1], end + 0.012, height + 0.34)
        found.append(box(low, high, "lens_red"))
    return found


def mirrors(model: Large, y: float, height: float) -> Shapes:
    """Hang a mirror on an arm beside each side of the windscreen."""
    found = []
    half = model.size[1] / 2
    for side in (-1.0, 1.0):
        tip = side * (half + 0.2)
        arm = [[side * (half - 0.1), y, height + 0.2], [tip, y - 0.12, height + 0.1]]
        found.append(tube(arm, 0.022, "plastic", (0.03, 0.03, 0.03), sides=6))
        x = sorted((tip - 0.09, tip + 0.09))
        low, high = (x[0], y - 0.16, height - 0.28), (x[1], y - 0.09, height + 0.12)
        found.append(box(low, high, "plastic", (0.03, 0.03, 0.03)))
    return found


def _spans(front: float, rear: float, count: int, gap: float) -> list[tuple[float, float]]:
    """Divide a length into equal spans with gaps between."""
    step = (rear - front + gap) / count
    return [(front + i * step, front + i * step + step - gap) for i in range(count)]


def _bus(model: Large) -> Shapes:
    length, _, height = model.size
    end = length / 2
    spans = _spans(-end + 0.35, end - 0.35, 7, 0.09)
    doors = [(-end + 0.35, -end + 1.55), (-0.55, 0.75)]
    dark = (0.025, 0.025, 0.028)
    return [
        hull(model, -end, end, 0.30, 0.98, arches=True),
        # The band of windows is a dark body, as glass glued on shows.
        hull(model, -end, end, 0.98, 2.50, inset=0.004, material="plastic", tint=dark),
        hull(model, -end, end, 2.50, height - 0.20),
        hull(model, -end + 0.1, end - 0.1, height - 0.20, height - 0.12, inset=0.10),
        box((-0.85, -2.4, height - 0.12), (0.85, 1.2, height), "car_paint"),
        *panes(model, spans, 1.04, 2.44),
        # Traffic keeps right: doors open to the right, -x, low enough to step in.
        *panes(model, doors, 0.42, 2.44, sides=(-1.0,)),
        windscreen(model, 0.95, 2.46),
        windscreen(model, 1.35, 2.40, rear=True),
        box((-0.85, -end - 0.012, 2.54), (0.85, -end + 0.02, 2.80), "plastic", dark),
        box((-0.55, -end - 0.016, 2.59), (0.55, -end + 0.02, 2.75), "lamp_glow"),
        *lamps(model, 0.58),
        *mirrors(model, -end + 0.06, 2.2),
    ]


def _lorry(model: Large) -> Shapes:
    length, width, height = model.size
    end, cab = length / 2, 1.9
    back = -end + cab
    white, dark = (0.88, 0.88, 0.86), (0.03, 0.03, 0.032)
    half = width / 2
    rails = [
        box((side * 0.42 - 0.05, back - 0.2, 0.72), (side * 0.42 + 0.05, end - 0.05, 0.95),
            "metal_dark") for side in (-1.0, 1.0)
    ]  # fmt: skip
    return [
        hull(model, -end, back, 0.38, 1.25, arches=True),
        hull(model, -end + 0.02, back, 1.25, 2.15, inset=0.05, material="plastic", tint=dark),
        hull(model, -end + 0.05, back, 2.15, 2.62, inset=0.06),
        *panes(model, [(-end + 0.3, -end + 1.25)], 1.32, 2.08),
        box((-half + 0.2, -end - 0.002, 1.32), (half - 0.2, -end + 0.05, 2.12), "car_glass"),
        box((-0.8, -end - 0.014, 0.72), (0.8, -end + 0.02, 1.14), "plastic", dark),
        # The box of the load is of its own, light colour whatever the cab's.
        hull(model, back + 0.12, end, 0.98, height, material="plastic", tint=white),
        box((-half + 0.12, end - 0.02, 1.02), (-0.01, end + 0.012, height - 0.06), "plastic",
            (0.80, 0.80, 0.78)),
        box((0.01, end - 0.02, 1.02), (half - 0.12, end + 0.012, height - 0.06), "plastic",
            (0.80, 0.80, 0.78)),
        *rails,
        box((-half + 0.1, end - 0.12, 0.42), (half - 0.1, end - 0.02, 0.58), "metal_dark"),
        *lamps(model, 0.60),
        *mirrors(model, -end + 0.25, 2.0),
    ]  # fmt: skip


def _tram(model: Large) -> Shapes:
    length, _, height = model.size
    end = length / 2
    dark = (0.025, 0.025, 0.028)
    doors = [(-end + 1.1, -end + 2.3), (-0.65, 0.65), (end - 2.3, end - 1.1)]
    arm = [[0.0, 0.4, height - 0.2], [0.0, -0.7, height + 0.65], [0.0, 0.3, height + 1.5]]
    return [
        hull(model, -end, end, 0.28, 1.05),
        hull(model, -end, end, 1.05, 2.45, inset=0.004, material="plastic", tint=dark),
        hull(model, -end, end, 2.45, height - 0.25),
        hull(model, -end + 0.3, end - 0.3, height - 0.25, height, inset=0.35),
        *panes(model, _spans(-end + 0.5, end - 0.5, 8, 0.12), 1.12, 2.38),
        *panes(model, doors, 0.40, 2.38, sides=(-1.0,)),
        windscreen(model, 1.15, 2.42),
        windscreen(model, 1.15, 2.42, rear=True),
        box((-0.5, -end - 0.014, 2.50), (0.5, -end + 0.02, 2.74), "lamp_glow"),
        tube(arm, 0.03, "metal_dark", sides=6),
        box((-0.8, 0.26, height + 1.48), (0.8, 0.34, height + 1.54), "metal_grey"),
        *lamps(model, 0.66),
    ]


def _fire_engine(model: Large) -> Shapes:
    length, width, height = model.size
    end, cab = length / 2, 2.9
    back, half = -end + cab, width / 2
    dark = (0.03, 0.03, 0.032)
    lockers = _spans(back + 0.20, end - 0.30, 3, 0.12)
    found = [
        hull(model, -end, back, 0.38, 1.25, arches=True),
        hull(model, -end + 0.02, back, 1.25, 2.20, inset=0.05, material="plastic", tint=dark),
        hull(model, -end + 0.05, back, 2.20, 2.62, inset=0.06),
        *panes(model, [(-end + 0.3, -end + 1.25), (-end + 1.55, -end + 2.70)], 1.32, 2.12),
        box((-half + 0.2, -end - 0.002, 1.32), (half - 0.2, -end + 0.05, 2.12), "car_glass"),
        box((-0.8, -end - 0.014, 0.72), (0.8, -end + 0.02, 1.14), "plastic", dark),
        hull(model, back + 0.04, end, 0.55, 2.85, arches=True),
        *light_bar(-end + 0.55, 2.62, 0.95),
        *_ladder(back + 0.10 - cab, end - 0.06, height - 0.12),
        box((-0.9, end - 0.02, 0.75), (0.9, end + 0.012, 2.55), "metal_grey"),
        *lamps(model, 0.60),
        *mirrors(model, -end + 0.25, 2.0),
    ]
    for side in (-1.0, 1.0):
        x = sorted((side * (half - 0.03), side * (half + PANE_OUT)))
        for front, rear in lockers:  # roller shutters, above and between the wheels
            found.append(box((x[0], front, 1.22), (x[1], rear, 2.62), "metal_grey"))
        for low, material in ((0.98, "plate_white"), (1.08, "plate_yellow")):
            found.append(box((x[0], -end + 0.35, low), (x[1], end - 0.25, low + 0.09), material))
    return found


def _snow_plough(model: Large) -> Shapes:
    length, width, height = model.size
    end, blade, cab = length / 2, 1.1, 2.0
    front, half = -end + blade, width / 2
    back = front + cab
    dark = (0.03, 0.03, 0.032)
    hopper = [
        [
            [x * (half - 0.12 - 0.55 * (1 - z)), y, 1.05 + z * (height - 1.20)]
            for x, z in ((-1, 0), (-1, 1), (1, 1), (1, 0))
        ]
        for y in (back + 0.3, end - 0.5)
    ]
    found = [
        hull(model, front, back, 0.38, 1.25, arches=True),
        hull(model, front + 0.02, back, 1.25, 2.40, inset=0.05, material="plastic", tint=dark),
        hull(model, front + 0.05, back, 2.40, 2.95, inset=0.06),
        *panes(model, [(front + 0.3, front + 1.35)], 1.32, 2.32),
        box((-half + 0.2, front - 0.002, 1.32), (half - 0.2, front + 0.05, 2.36), "car_glass"),
        # A hopper that narrows downwards, on rails, with a spreader behind it.
        loft(np.array(hopper), "plastic", (0.80, 0.80, 0.78)),
        cylinder((0.0, end - 0.34, 0.42), (0.0, end - 0.34, 0.50), 0.32, "metal_dark", sides=14),
        box((-0.12, end - 0.50, 0.50), (0.12, end - 0.10, 1.05), "metal_dark"),
        *light_bar(front + 0.50, 2.95, 0.85, beacon="beacon_amber"),
        *_blade(-end, front, half + 0.28),
        *mirrors(model, front + 0.25, 2.2),
        box((-half + 0.15, end - 0.14, 0.78), (half - 0.15, end - 0.06, 0.88), "metal_dark"),
    ]
    for side in (-1.0, 1.0):
        x = sorted((side * (half - 0.5), side * (half - 0.18)))
        found.append(box((side * 0.42 - 0.05, back - 0.2, 0.72),
                         (side * 0.42 + 0.05, end - 0.05, 0.95), "metal_dark"))  # fmt: skip
        # Headlights above the blade, and rear lights.
        found.append(box((x[0], front - 0.03, 1.12), (x[1], front + 0.03, 1.28), "lens_white"))
        found.append(box((x[0], end - 0.08, 0.75), (x[1], end + 0.012, 1.00), "lens_red"))
    return found


def _blade(front: float, rear: float, half: float) -> Shapes:
    """Hang a blade before the front, turned to push snow to the right of who drives."""
    turn = np.radians(18.0)
    rings = []
    for share in (-1.0, 1.0):
        x = share * half * np.cos(turn)
        y = (front + 0.52) - share * half * np.sin(turn)
        profile = [(0.02, 0.12), (0.10, 0.36), (0.06, 0.68), (-0.12, 0.98)]
        outer = [(x, y + dy, z) for dy, z in profile]
        inner = [(x, y + dy + 0.05, z) for dy, z in reversed(profile)]
        rings.append(outer + inner)
    found = [
        loft(np.array(rings)[:, ::-1], "plastic", (0.85, 0.30, 0.02)),
        tube([(0.0, rear, 0.62), (0.0, front + 0.60, 0.45)], 0.09, "metal_dark", sides=6),
    ]
    for side in (-1.0, 1.0):
        found.append(tube([(side * 0.45, rear, 0.55), (side * 0.30, front + 0.62, 0.35)], 0.05,
                          "metal_dark", sides=6))  # fmt: skip
    return found


def _ladder(front: float, rear: float, z: float) -> Shapes:
    """Lay a ladder along the roof, on two cross bars."""
    found = [tube([(side * 0.28, front, z), (side * 0.28, rear, z)], 0.035, "metal_grey", sides=6)
             for side in (-1.0, 1.0)]  # fmt: skip
    for y in np.arange(front + 0.15, rear, 0.32).tolist():
        found.append(tube([(-0.28, y, z), (0.28, y, z)], 0.018, "metal_grey", sides=6))
    for y in (front + 1.2, rear - 0.9):
        found.append(box((-0.40, y - 0.05, z - 0.30), (0.40, y + 0.05, z - 0.03), "metal_dark"))
    return found


LARGE: Mapping[str, Large] = MappingProxyType(
    {
        "bus": Large((12.0, 2.55, 3.10), 0.48, (-3.3, 2.6), _bus),
        "truck": Large((8.2, 2.50, 3.45), 0.46, (-2.85, 1.9), _lorry),
        "fire_engine": Large((8.3, 2.50, 3.25), 0.48, (-2.75, 1.85), _fire_engine),
        "snow_plough": Large((9.0, 2.50, 3.20), 0.48, (-2.35, 2.35), _snow_plough),
        "tram": Large((14.7, 2.48, 3.20), 0.33, (-4.2, -2.4, 2.4, 4.2), _tram),
    }
)
