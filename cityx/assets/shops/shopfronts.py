"""Shopfronts, with their awnings and signs; see `cityx.assets.openings.frames`.

The forms for near views have the sizes of the plain ones.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import lru_cache
from itertools import pairwise
from types import MappingProxyType

import numpy as np

from cityx.assets.kept_prototypes import kept
from cityx.assets.openings.doors import letter_box
from cityx.assets.openings.frames import (
    BACKING,
    FINE,
    GLASS,
    PANE_MATERIAL,
    Shapes,
    pane,
    plate,
    slab,
    surround,
)
from cityx.assets.shapes import Color, bevelled, lathe, moved, prototype, tube
from cityx.assets.trims.mouldings import (
    bar,
    frame,
    hinge,
    knob,
    ledge,
    lever,
    portal,
    raised_panel,
    rectangle,
    scroll,
    sheet,
    soft,
)
from cityx.city.mesh import one_mesh
from cityx.city.scene import Prototype
from cityx.ids import rng_for

WIDTH, HEIGHT = 3.6, 3.0  # metres, of every shopfront
_W = WIDTH / 2
STALL = -0.11  # how far the stallriser stands out
DEEP = 0.070  # metres the panes lie behind the wall
_CARDS: tuple[Color, ...] = ((0.9, 0.9, 0.88), (0.9, 0.35, 0.2), (0.95, 0.8, 0.3), (0.3, 0.5, 0.7))


def _goods(purpose: str, x0: float, x1: float, floor: float, count: int) -> Shapes:
    """Put posters and goods low behind the glass, so that a shop window is not empty."""
    rng = rng_for(0, "assets/goods", len(purpose))
    shapes: Shapes = []
    for x in np.linspace(x0, x1, count + 1)[:-1]:
        step = (x1 - x0) / count
        width, height = step * rng.uniform(0.45, 0.8), rng.uniform(0.3, 0.9)
        left = x + rng.uniform(0.05, 0.2) * step
        color = _CARDS[int(rng.integers(len(_CARDS)))]
        shapes.append(pane(left, left + width, floor, floor + height, "marking_white", color,
                           y=-0.028))  # fmt: skip
    return shapes


def shop_classic(glass: str) -> Shapes:
    """Painted timber shopfront: pilasters, stallriser, three lights and a door in the middle."""
    shapes = [
        slab(-_W, -_W + 0.22, -0.3, HEIGHT, -0.14, "door_paint"),
        slab(_W - 0.22, _W, -0.3, HEIGHT, -0.14, "door_paint"),
        slab(-_W + 0.22, _W - 0.22, HEIGHT - 0.1, HEIGHT, -0.13, "door_paint"),
        pane(-_W + 0.2, _W - 0.2, 0.0, HEIGHT - 0.08, glass),
        slab(-_W + 0.22, _W - 0.22, 2.28, 2.36, -0.08, "door_paint", back=-0.02),
        slab(-0.5, -0.42, 0.0, HEIGHT - 0.1, -0.08, "door_paint", back=-0.02),
        slab(0.42, 0.5, 0.0, HEIGHT - 0.1, -0.08, "door_paint", back=-0.02),
        slab(-0.42, 0.42, 0.0, 0.75, -0.05, "door_paint", (0.85, 0.85, 0.85)),
        slab(-0.42, -0.32, 0.75, 2.28, -0.05, "door_paint", (0.85, 0.85, 0.85), back=-0.02),
        slab(0.32, 0.42, 0.75, 2.28, -0.05, "door_paint", (0.85, 0.85, 0.85), back=-0.02),
        slab(-0.6, 0.6, -0.3, 0.02, -0.2, "step_stone"),
    ]
    for x0, x1 in ((-_W + 0.22, -0.5), (0.5, _W - 0.22)):
        shapes.append(slab(x0, x1, -0.3, 0.55, STALL, "door_paint"))
        shapes.append(slab(x0 + 0.1, x1 - 0.1, 0.1, 0.45, STALL - 0.015, "door_paint",
                           (0.8, 0.8, 0.8), back=STALL))  # fmt: skip
        shapes.append(slab((x0 + x1) / 2 - 0.02, (x0 + x1) / 2 + 0.02, 0.55, 2.28, -0.07,
                           "door_paint", back=-0.02))  # fmt: skip
        shapes += _goods("classic" + str(x0 > 0), x0 + 0.05, x1 - 0.05, 0.58, 3)
    return shapes


def shop_modern(glass: str) -> Shapes:
    """Frameless front: large panes, a glass door at the right."""
    shapes = surround(WIDTH, HEIGHT, 0.06, -0.08, "frame_paint")
    shapes += [
        pane(-_W + 0.04, _W - 0.04, 0.0, HEIGHT - 0.04, glass),
        slab(-_W + 0.06, 0.62, 0.0, 0.18, -0.07, "frame_paint", back=-0.02),
        slab(0.62, 0.67, 0.0, HEIGHT - 0.06, -0.07, "frame_paint", back=-0.02),
        slab(0.67, _W - 0.06, 2.3, 2.35, -0.06, "frame_paint", back=-0.02),
        slab(-0.6, -0.56, 0.18, HEIGHT - 0.06, -0.055, "frame_paint", back=-0.02),
        slab(0.80, 0.83, 0.8, 1.5, -0.10, "metal_grey", back=-0.04),
        slab(-_W, _W, -0.3, 0.0, -0.08, "step_stone"),
    ]
    return shapes + _goods("modern", -_W + 0.1, 0.55, 0.2, 4)


def shop_window(glass: str) -> Shapes:
    """Display window without a door, over a low wall."""
    shapes = [
        *surround(WIDTH, HEIGHT, 0.09, -0.09, "frame_paint", bottom=False),
        slab(-_W, _W, -0.3, 0.42, -0.10, "trim"),
        pane(-_W + 0.06, _W - 0.06, 0.4, HEIGHT - 0.05, glass),
        slab(-0.62, -0.57, 0.42, HEIGHT - 0.09, -0.07, "frame_paint", back=-0.02),
        slab(0.57, 0.62, 0.42, HEIGHT - 0.09, -0.07, "frame_paint", back=-0.02),
        slab(-_W + 0.09, _W - 0.09, 2.35, 2.41, -0.07, "frame_paint", back=-0.02),
        slab(-_W, _W, 0.42, 0.47, -0.16, "trim"),
    ]
    return shapes + _goods("display window", -_W + 0.15, _W - 0.15, 0.48, 6)


def shop_cafe(glass: str) -> Shapes:
    """Folding doors of four leaves with solid feet."""
    shapes = surround(WIDTH, HEIGHT, 0.1, -0.10, "door_paint", bottom=False)
    shapes.append(pane(-_W + 0.05, _W - 0.05, 0.0, HEIGHT - 0.05, glass))
    edges = np.linspace(-_W + 0.1, _W - 0.1, 5)
    for x0, x1 in pairwise(edges):
        shapes.append(slab(x0 + 0.01, x0 + 0.07, 0.0, 2.4, -0.07, "door_paint", back=-0.02))
        shapes.append(slab(x1 - 0.07, x1 - 0.01, 0.0, 2.4, -0.07, "door_paint", back=-0.02))
        shapes.append(slab(x0 + 0.07, x1 - 0.07, 0.0, 0.45, -0.065, "door_paint", back=-0.02))
    shapes.append(slab(-_W + 0.1, _W - 0.1, 2.4, 2.5, -0.08, "door_paint", back=-0.02))
    shapes.append(slab(-_W, _W, -0.3, 0.0, -0.12, "step_stone"))
    return shapes


def shop_shutter(glass: str) -> Shapes:
    """Shop with its roller shutter down."""
    del glass
    shapes = surround(WIDTH, HEIGHT, 0.12, -0.10, "frame_paint", bottom=False)
    for row in range(14):
        z = 0.2 * row
        shapes.append(slab(-_W + 0.12, _W - 0.12, z + 0.012, z + 0.19, -0.045, "door_paint",
                           (0.9, 0.9, 0.9)))  # fmt: skip
    shapes.append(pane(-_W + 0.1, _W - 0.1, 0.0, HEIGHT - 0.1, "metal_dark", y=-0.012))
    return shapes


def _light(x0: float, x1: float, z0: float, z1: float, material: str, *, stile: float = 0.05,
           y: float = DEEP - 0.02) -> Shapes:  # fmt: skip
    """Make a framed pane."""
    line = soft([(0.0, BACKING), (0.0, y), (0.6 * stile, y), (0.72 * stile, y + 0.006),
                 (0.9 * stile, y + 0.012), (stile, y + 0.016), (stile, y + 0.03)], 0.004,
                     3)  # fmt: skip
    inside = rectangle(x0 + 0.8 * stile, x1 - 0.8 * stile, z0 + 0.8 * stile, z1 - 0.8 * stile)
    return [frame(x0, x1, z0, z1, line, material), plate(inside, y + 0.022, PANE_MATERIAL)]


def _pilaster(x0: float, x1: float, z0: float, z1: float) -> Shapes:
    """Make a timber pilaster: plinth, fluted shaft, necking, capital and console."""
    shapes: Shapes = []
    middle = (x0 + x1) / 2
    wide = x1 - x0
    shapes.append(bevelled((x0 - 0.015, -0.10, z0), (x1 + 0.015, 0.02, z0 + 0.55), "door_paint",
                           bevel=0.008, hidden=("+y",)))  # fmt: skip
    shapes += raised_panel(x0 + 0.02, x1 - 0.02, z0 + 0.1, z0 + 0.5, -0.10, "door_paint")
    shapes.append(bevelled((x0, -0.07, z0 + 0.55), (x1, 0.02, z1), "door_paint", hidden=("+y",)))
    flutes = 4
    for k in range(flutes):
        x = x0 + wide * (k + 0.5) / flutes
        reed = [[x, -0.068, z0 + 0.62], [x, -0.070, z0 + 0.66], [x, -0.070, z1 - 0.56],
                [x, -0.068, z1 - 0.52]]  # fmt: skip
        shapes.append(tube(reed, [0.004, 0.016, 0.016, 0.004], "door_paint", sides=10))
    for z, out in ((z1 - 0.46, 0.09), (z1 - 0.02, 0.12)):
        line = soft([(0.02, -0.03), (-0.07, -0.03), (-out, -0.012), (-out - 0.012, 0.008),
                     (-out - 0.012, 0.02), (0.02, 0.02)][::-1], 0.006, 3)  # fmt: skip
        shapes.append(
            ledge(np.asarray(line) + np.array([0.0, z]), x0 - 0.012, x1 + 0.012, "door_paint")
        )
    s = np.linspace(0.0, 1.0, 13)
    front = -0.085 - 0.10 * (s**2) - 0.02 * np.sin(2 * np.pi * s)
    low, high = z1 - 0.43, z1 - 0.05
    outline = np.vstack([np.column_stack([front, low + (high - low) * s])[::-1],
                         [(0.0, low), (0.0, high)]])  # fmt: skip
    shapes.append(ledge(outline, middle - 0.38 * wide, middle + 0.38 * wide, "door_paint"))
    return shapes


def fine_shop_classic() -> Shapes:
    """Painted timber front: fluted pilasters, panelled stallriser, lights with transoms, door."""
    shapes: Shapes = []
    for side in (-1.0, 1.0):
        ends = sorted((side * _W, side * (_W - 0.22)))
        shapes += _pilaster(ends[0], ends[1], -0.3, HEIGHT)
        ends = sorted((side * 0.5, side * (_W - 0.22)))
        x0, x1 = ends
        shapes.append(bevelled((x0, -0.05, -0.3), (x1, 0.10, 0.52), "door_paint", hidden=("+y",)))
        half = (x0 + x1) / 2
        for a, b in ((x0, half), (half, x1)):
            shapes += raised_panel(a + 0.04, b - 0.04, 0.06, 0.46, -0.05, "door_paint")
            shapes += _light(a, b, 0.58, 2.28, "door_paint")
            shapes += _light(a, b, 2.36, HEIGHT - 0.1, "door_paint")
            x = (a + b) / 2
            shapes.append(bar((x, 2.40), (x, HEIGHT - 0.14), 0.012, DEEP - 0.016, "door_paint"))
        sill = soft([(0.12, 0.0), (0.12, 0.06), (0.05, 0.06), (-0.07, 0.035), (-0.085, 0.02),
                     (-0.08, 0.0), (-0.05, -0.01)], 0.008, 3)  # fmt: skip
        shapes.append(ledge(np.asarray(sill) + np.array([0.0, 0.52]), x0, x1, "door_paint"))
    shapes += [bevelled((x - 0.04, DEEP - 0.05, 0.0), (x + 0.04, 0.12, HEIGHT - 0.1), "door_paint",
                        hidden=("+y",)) for x in (-0.46, 0.46)]  # fmt: skip
    shapes.append(bevelled((-0.42, DEEP, 0.02), (0.42, 0.12, 0.80), "door_paint", hidden=("+y",)))
    shapes += raised_panel(-0.34, -0.02, 0.16, 0.72, DEEP, "door_paint")
    shapes += raised_panel(0.02, 0.34, 0.16, 0.72, DEEP, "door_paint")
    shapes += _light(-0.42, 0.42, 0.80, 2.28, "door_paint", stile=0.09)
    shapes += _light(-0.42, 0.42, 2.36, HEIGHT - 0.1, "door_paint")
    head = soft([(0.12, -0.04), (0.02, -0.04), (-0.02, -0.025), (-0.02, 0.02), (-0.03, 0.04),
                 (0.12, 0.04)][::-1], 0.006, 3)  # fmt: skip
    for z in (2.32, HEIGHT - 0.05):
        shapes.append(
            ledge(np.asarray(head) + np.array([0.0, z]), -_W + 0.22, _W - 0.22, "door_paint")
        )
    shapes += [knob(0.34, 1.05, DEEP - 0.02, 0.03), *letter_box(0.0, 0.60, DEEP - 0.012)]
    shapes.append(plate(rectangle(-0.2, 0.2, 1.35, 1.62), DEEP - 0.004, "sign"))
    for z in (0.3, 1.1, 2.0):
        shapes += hinge(-0.42, z, DEEP - 0.006)
    step = soft([(0.12, -0.32), (0.12, 0.02), (-0.16, 0.02), (-0.2, 0.0), (-0.2, -0.32)], 0.015, 4)
    shapes.append(ledge(step, -0.6, 0.6, "step_stone"))
    return shapes


def fine_shop_modern() -> Shapes:
    """Metal sections and large panes with a glass door and a tiled foot."""
    section = soft([(0.0, 0.135), (0.0, 0.0), (0.05, 0.0), (0.056, 0.006), (0.056, 0.03), (0.062,
        0.034),
                    (0.062, 0.135)], 0.003, 3)  # fmt: skip
    shapes = [frame(-_W, _W, 0.0, HEIGHT, section, "frame_paint")]
    shapes += _light(-_W + 0.06, -0.58, 0.18, HEIGHT - 0.06, "frame_paint", stile=0.03)
    shapes += _light(-0.58, 0.62, 0.18, HEIGHT - 0.06, "frame_paint", stile=0.03)
    shapes += _light(0.66, _W - 0.06, 0.02, 2.3, "frame_paint", stile=0.045)
    shapes += _light(0.66, _W - 0.06, 2.35, HEIGHT - 0.06, "frame_paint", stile=0.03)
    shapes.append(bevelled((-_W + 0.06, 0.03, 0.0), (0.62, 0.12, 0.18), "metal_dark"))
    for k in range(9):
        x = -_W + 0.09 + 0.259 * k
        shapes.append(
            bevelled((x, 0.018, 0.012), (x + 0.24, 0.03, 0.172), "step_stone", bevel=0.003)
        )
    grip = [[0.80, DEEP, 0.72], [0.80, -0.01, 0.72], [0.80, -0.015, 0.75], [0.80, -0.015, 1.65],
            [0.80, -0.01, 1.68], [0.80, DEEP, 1.68]]  # fmt: skip
    shapes.append(tube(grip, 0.013, "metal_grey", sides=14))
    shapes += [part for z in (0.2, 1.1, 2.1) for part in hinge(_W - 0.07, z, DEEP - 0.028)]
    for z in (1.0, 1.5):
        for k in range(14):
            x = -_W + 0.2 + 0.16 * k
            if abs(x + 0.58) > 0.1:
                shapes.append(plate(rectangle(x, x + 0.05, z, z + 0.05), DEEP - 0.002, "sign"))
    for x in np.linspace(-_W + 0.3, _W - 0.3, 7):
        shapes.append(tube([[x, 0.10, HEIGHT - 0.16], [x, 0.085, HEIGHT - 0.24]], [0.022, 0.030],
                           "lamp_glow", sides=14))  # fmt: skip
    return [*shapes, bevelled((-_W, -0.08, -0.3), (_W, 0.1, 0.0), "step_stone", hidden=("+y",))]


def fine_shop_window() -> Shapes:
    """Display window over a low moulded wall."""
    section = soft([(0.0, 0.0), (0.0, -0.02), (0.03, -0.024), (0.06, -0.02), (0.07, 0.0), (0.09,
        0.02),
                    (0.095, 0.06), (0.095, 0.135)], 0.006, 3)  # fmt: skip
    shapes = [portal(-_W, _W, 0.42, HEIGHT, section, "frame_paint")]
    shapes.append(bevelled((-_W, -0.02, -0.3), (_W, 0.12, 0.40), "trim", hidden=("+y",)))
    for x0, x1 in pairwise(np.linspace(-_W + 0.04, _W - 0.04, 4)):
        shapes += raised_panel(x0 + 0.03, x1 - 0.03, -0.02, 0.36, -0.02, "trim")
    sill = soft([(0.12, 0.0), (0.12, 0.06), (0.05, 0.06), (-0.10, 0.03), (-0.12, 0.015), (-0.115,
        -0.01),
                 (-0.09, -0.01), (-0.02, 0.0)], 0.008, 3)  # fmt: skip
    shapes.append(ledge(np.asarray(sill) + np.array([0.0, 0.40]), -_W, _W, "trim"))
    for x0, x1 in ((-_W + 0.095, -0.6), (-0.6, 0.6), (0.6, _W - 0.095)):
        shapes += _light(x0, x1, 0.46, 2.36, "frame_paint", stile=0.035)
        shapes += _light(x0, x1, 2.40, HEIGHT - 0.095, "frame_paint", stile=0.035)
    return shapes


def fine_shop_cafe() -> Shapes:
    """Folding doors of four leaves with panels, bolts and hinges, a menu and lamps."""
    section = soft([(0.0, 0.0), (0.0, -0.02), (0.05, -0.026), (0.07, -0.01), (0.09, 0.0), (0.10,
        0.02),
                    (0.10, 0.135)], 0.006, 3)  # fmt: skip
    shapes = [portal(-_W, _W, 0.0, HEIGHT, section, "door_paint")]
    edges = np.linspace(-_W + 0.1, _W - 0.1, 5)
    for number, (x0, x1) in enumerate(pairwise(edges)):
        a, b = float(x0) + 0.006, float(x1) - 0.006
        shapes.append(bevelled((a, DEEP - 0.02, 0.01), (b, 0.12, 0.50), "door_paint",
                               hidden=("+y",)))  # fmt: skip
        shapes += raised_panel(a + 0.07, b - 0.07, 0.09, 0.44, DEEP - 0.02, "door_paint")
        shapes += _light(a, b, 0.50, 2.40, "door_paint", stile=0.075)
        for z in (1.12, 1.74):
            shapes.append(bar((a + 0.07, z), (b - 0.07, z), 0.013, DEEP - 0.016, "door_paint"))
        shapes += _light(a, b, 2.50, HEIGHT - 0.1, "door_paint", stile=0.05)
        for z in (0.25, 1.2, 2.15):
            shapes += hinge(a if number % 2 else b, z, DEEP - 0.028)
        if number in (1, 2):
            shapes += lever(b - 0.035 if number == 1 else a + 0.035, 1.05, DEEP - 0.02,
                            -1.0 if number == 1 else 1.0)  # fmt: skip
    head = soft([(0.12, -0.05), (0.03, -0.05), (0.0, -0.03), (0.0, 0.03), (-0.015, 0.05), (0.12,
        0.05)][
        ::-1], 0.006, 3)  # fmt: skip
    shapes.append(
        ledge(np.asarray(head) + np.array([0.0, 2.45]), -_W + 0.1, _W - 0.1, "door_paint")
    )
    for x in (-_W + 0.05, _W - 0.05):
        arm = [[x, 0.0, 2.2], [x, -0.08, 2.28], [x, -0.16, 2.26], [x, -0.18, 2.18]]
        shapes.append(tube(arm, 0.009, "metal_dark", sides=10))
        bowl = lathe([(0.03, 0.0), (0.075, -0.03), (0.10, -0.10)][::-1], "metal_dark", sides=18)
        shapes.append(moved(bowl, (x, -0.18, 2.19)))
        bulb = lathe([(0.0, -0.09), (0.035, -0.06), (0.03, -0.02)], "lamp_glow", sides=14)
        shapes.append(moved(bulb, (x, -0.18, 2.19)))
    board = soft([(0.0, 0.0), (0.0, -0.03), (0.02, -0.035), (0.025, -0.02)], 0.003, 2)
    shapes.append(frame(-_W + 0.02, -_W + 0.10, 1.2, 1.6, board, "bench_wood"))
    return [*shapes, bevelled((-_W, -0.12, -0.3), (_W, 0.1, 0.0), "step_stone", hidden=("+y",))]


def fine_shop_shutter() -> Shapes:
    """Shop with its roller shutter down: curved slats in channels, lock bar and box."""
    section = soft([(0.0, 0.0), (0.0, -0.04), (0.10, -0.04), (0.12, -0.03), (0.12, 0.03)], 0.005, 3)
    shapes: Shapes = [portal(-_W, _W, 0.0, HEIGHT, section, "frame_paint")]
    bow = np.array([(0.05, 0.0), (0.030, 0.004), (0.018, 0.018), (0.014, 0.036), (0.018, 0.056),
                    (0.030, 0.072), (0.05, 0.076)])[::-1]  # fmt: skip
    for row in range(int((HEIGHT - 0.28) / 0.076)):
        shapes.append(ledge(bow + np.array([0.0, 0.03 + 0.076 * row]), -_W + 0.11, _W - 0.11,
                            "door_paint",
                            (0.9, 0.9, 0.9)))  # fmt: skip
    shapes.append(bevelled((-_W + 0.11, 0.0, 0.0), (_W - 0.11, 0.05, 0.05), "metal_grey"))
    shapes.append(bevelled((-_W + 0.06, -0.14, HEIGHT - 0.3), (_W - 0.06, 0.05, HEIGHT - 0.02),
                           "frame_paint", bevel=0.015, hidden=("+y",)))  # fmt: skip
    for x in (-0.7, 0.7):
        shapes += lever(x, 0.35, 0.012, 1.0)
    shapes.append(bevelled((-0.08, -0.012, 0.05), (0.08, 0.02, 0.12), "metal_dark"))
    return shapes


SHOPFRONTS: Mapping[str, Callable[[str], Shapes]] = MappingProxyType(
    {
        maker.__name__: maker
        for maker in (shop_classic, shop_modern, shop_window, shop_cafe, shop_shutter)
    }
)
FINE_SHOPFRONTS: Mapping[str, Callable[[], Shapes]] = MappingProxyType(
    {
        maker.__name__.removeprefix("fine_"): maker
        for maker in (
            fine_shop_classic,
            fine_shop_modern,
            fine_shop_window,
            fine_shop_cafe,
            fine_shop_shutter,
        )
    }
)


@lru_cache(maxsize=32)
@kept("shopfront", least=FINE)
def shopfront(name: str, *, detail: int = 2) -> Prototype:
    """Make a shopfront prototype; `name` is a key of `SHOPFRONTS`, `detail` as of windows."""
    if detail >= FINE:
        shapes = FINE_SHOPFRONTS[name]()
        return prototype(f"{name}_fine", "shopfront", shapes)
    return prototype(name, "shopfront", SHOPFRONTS[name](GLASS))


# --- awnings and signs ----------------------------------------------------------------------------


def awning() -> Shapes:
    """Sloping awning of striped cloth, 3.4 m wide, its upper edge at z = 0."""
    shapes: Shapes = []
    edges = np.linspace(-1.7, 1.7, 13)
    for number, (x0, x1) in enumerate(pairwise(edges)):
        tint: Color = (1.0, 1.0, 1.0) if number % 2 else (0.62, 0.62, 0.62)
        corners = [[x0, -1.25, -0.62], [x1, -1.25, -0.62], [x1, 0.0, 0.0], [x0, 0.0, 0.0]]
        faces = [[0, 1, 2, 3], [3, 2, 1, 0]]
        shapes.append(one_mesh(0, corners, faces, materials=("cloth",), tint=tint))
        shapes.append(pane(x0, x1, -0.84, -0.62, "cloth", tint, y=-1.25))
    for side in (-1.7, 1.7):
        cheek = [[side, -1.25, -0.62], [side, 0.0, -0.62], [side, 0.0, 0.0]]
        shapes.append(one_mesh(0, cheek, [[0, 1, 2], [2, 1, 0]], materials=("cloth",)))
    return shapes


def box_awning() -> Shapes:
    """Flat canopy on brackets."""
    return [
        slab(-1.7, 1.7, -0.10, 0.04, -1.1, "door_paint"),
        slab(-1.5, -1.44, -0.35, -0.10, -0.6, "metal_dark"),
        slab(1.44, 1.5, -0.35, -0.10, -0.6, "metal_dark"),
    ]


def sign_fascia() -> Shapes:
    """Name board over a shop, 3.4 m wide, its lower edge at z = 0."""
    return [
        slab(-1.7, 1.7, 0.0, 0.5, -0.16, "door_paint"),
        slab(-1.75, 1.75, 0.5, 0.57, -0.24, "trim"),
    ]


def sign_box() -> Shapes:
    """Light box over a shop."""
    return [slab(-1.7, 1.7, 0.02, 0.58, -0.24, "sign")]


def sign_letters() -> Shapes:
    """Thin rails for letters."""
    return [slab(-1.1, 1.1, z, z + 0.03, -0.06, "metal_dark") for z in (0.16, 0.34)]


def sign_blade() -> Shapes:
    """Small sign that hangs out over the pavement."""
    return [
        slab(-0.02, 0.02, 0.62, 0.66, -0.95, "metal_dark"),
        slab(-0.03, 0.03, 0.0, 0.60, -0.90, "sign", back=-0.22),
    ]


def sign_tower() -> Shapes:
    """Upright stack of tenants' signs, 4.2 m high, standing out from the wall."""
    shapes: Shapes = [
        slab(-0.06, 0.06, 0.0, 4.2, -0.26, "metal_grey", back=-0.20),
        slab(-0.03, 0.03, 0.5, 0.55, -0.22, "metal_grey"),
        slab(-0.03, 0.03, 3.6, 3.65, -0.22, "metal_grey"),
    ]
    for row, tint in enumerate(
        ((1.0, 1.0, 1.0), (0.93, 0.93, 0.94), (1.0, 1.0, 1.0), (0.93, 0.93, 0.94))
    ):
        z = 0.04 + 1.04 * row
        shapes.append(slab(-0.09, 0.09, z, z + 1.0, -0.98, "sign", tint, back=-0.26))
    return shapes


def fine_awning() -> Shapes:
    """Sagging striped cloth on folding arms with a scalloped valance and a cassette."""
    shapes: Shapes = []
    t = np.linspace(0.0, 1.0, 10)
    sag = -0.035 * np.sin(np.pi * t)
    edges = np.linspace(-1.7, 1.7, 25)
    for number, (x0, x1) in enumerate(pairwise(edges)):
        tint: Color = (1.0, 1.0, 1.0) if number % 2 else (0.62, 0.62, 0.62)
        columns = np.linspace(x0, x1, 5)
        cloth = np.stack(
            [np.broadcast_to(columns, (10, 5)),
             np.broadcast_to((-1.25 * (1 - t))[:, None], (10, 5)),
             np.broadcast_to((-0.62 * (1 - t) + sag)[:, None], (10, 5))], -1
        )  # fmt: skip
        shapes += [
            sheet(cloth, "cloth", tint),
            sheet(cloth[:, ::-1] - [0, 0, 0.002], "cloth", tint),
        ]
        drop = 0.16 + 0.05 * np.sin(np.pi * np.linspace(0.0, 1.0, 5))
        flap = np.stack([np.column_stack([columns, np.full(5, -1.252), -0.62 - drop]),
                         np.column_stack([columns, np.full(5, -1.252), np.full(5,
                             -0.62)])])  # fmt: skip
        shapes += [
            sheet(flap, "cloth", tint),
            sheet(flap[:, ::-1] + np.array([0, 0.002, 0]), "cloth", tint),
        ]
    shapes.append(
        tube([[-1.7, -1.24, -0.635], [1.7, -1.24, -0.635]], 0.022, "metal_grey", sides=14)
    )
    shapes.append(tube([[-1.7, 0.03, 0.0], [1.7, 0.03, 0.0]], 0.06, "metal_grey", sides=18))
    for side in (-1.0, 1.0):
        elbow = [[side * 1.4, 0.02, -0.12], [side * 1.0, -0.62, -0.42], [side * 1.5, -1.22, -0.63]]
        shapes.append(tube(elbow[:2], 0.016, "metal_grey", sides=12))
        shapes.append(tube(elbow[1:], 0.014, "metal_grey", sides=12))
        shapes.append(knob(side * 1.0, -0.42, -0.60, 0.024))
    return shapes


def fine_box_awning() -> Shapes:
    """Flat canopy with a moulded edge on scrolled brackets."""
    line = soft([(0.0, -0.10), (0.0, 0.04), (-1.06, 0.04), (-1.10, 0.02), (-1.10, -0.06), (-1.07,
        -0.10)],
                0.012, 3)  # fmt: skip
    shapes: Shapes = [ledge(line, -1.7, 1.7, "door_paint")]
    for x in (-1.47, 1.47):
        shapes.append(tube([[x, 0.0, -0.55], [x, -0.35, -0.42], [x, -0.7, -0.12]], 0.016,
            "metal_dark",
                           sides=12))  # fmt: skip
        volute = scroll(0.0, 0.0, 0.0, 0.14, 1.0)
        shapes.append(moved(volute, (x, -0.2, -0.26), yaw=np.pi / 2))
    return shapes


def fine_sign_fascia() -> Shapes:
    """Moulded fascia board with a cornice on dentils."""
    line = soft([(0.0, 0.0), (0.0, 0.5), (-0.14, 0.5), (-0.16, 0.47), (-0.14, 0.44), (-0.14, 0.08),
                 (-0.16, 0.05), (-0.16, 0.0)], 0.008, 3)  # fmt: skip
    top = soft([(0.0, 0.5), (0.0, 0.58), (-0.24, 0.57), (-0.25, 0.55), (-0.22, 0.53), (-0.20,
        0.5)], 0.01,
               4)  # fmt: skip
    shapes: Shapes = [ledge(line, -1.7, 1.7, "door_paint"), ledge(top, -1.75, 1.75, "trim")]
    for x in np.linspace(-1.66, 1.66, 42):
        shapes.append(bevelled((x - 0.022, -0.19, 0.455), (x + 0.022, -0.13, 0.5), "door_paint",
                               bevel=0.003, hidden=("+z",)))  # fmt: skip
    return shapes


def fine_sign_box() -> Shapes:
    """Light box with a rounded rim and its cable."""
    rim = soft([(0.0, 0.0), (0.0, -0.22), (0.012, -0.24), (0.03, -0.24), (0.035, -0.232)], 0.004, 3)
    face = rectangle(-1.668, 1.668, 0.052, 0.548)
    return [
        frame(-1.7, 1.7, 0.02, 0.58, rim, "metal_grey"),
        plate(face, -0.232, "sign"),
        tube(
            [[1.6, -0.1, 0.58], [1.6, -0.1, 0.66], [1.6, 0.0, 0.7]], 0.012, "metal_dark", sides=10
        ),
    ]


def fine_sign_letters() -> Shapes:
    """Rails with stand-offs, for letters."""
    shapes: Shapes = [
        bevelled((-1.1, -0.058, z), (1.1, -0.035, z + 0.03), "metal_dark") for z in (0.16, 0.34)
    ]
    for x in (-1.0, -0.35, 0.35, 1.0):
        for z in (0.175, 0.355):
            shapes.append(tube([[x, 0.0, z], [x, -0.05, z]], 0.010, "metal_dark", sides=10))
    return shapes


def fine_sign_blade() -> Shapes:
    """Hanging sign with a moulded rim on a wrought-iron bracket."""
    shapes: Shapes = [
        tube([[0.0, 0.0, 0.66], [0.0, -0.95, 0.66], [0.0, -1.0, 0.68]], [0.013, 0.013, 0.004],
             "metal_dark", sides=12),
        bevelled((-0.05, -0.012, 0.45), (0.05, 0.0, 0.85), "metal_dark"),
        bevelled((-0.03, -0.90, 0.0), (0.03, -0.22, 0.58), "sign", bevel=0.01),
    ]  # fmt: skip
    for y, z, size in ((-0.17, 0.54, 0.085), (-0.36, 0.74, 0.06)):
        shapes.append(moved(scroll(0.0, 0.0, 0.0, size, 1.0), (0.0, y, z), yaw=np.pi / 2))
    for y in (-0.32, -0.80):
        shapes.append(tube([[0.0, y, 0.57], [0.0, y, 0.66]], 0.005, "metal_dark", sides=8))
    for side in (-1.0, 1.0):
        rim = soft([(0.0, -0.028), (0.0, -0.040), (0.02, -0.042), (0.03, -0.032)], 0.003, 2)
        face = [
            moved(part, (0.0, 0.0, 0.0), yaw=side * np.pi / 2)
            for part in (frame(-0.34, 0.34, 0.01, 0.57, rim, "metal_dark"),)
        ]
        shapes += [moved(part, (0.0, -0.56, 0.0)) for part in face]
    return shapes


def fine_sign_tower() -> Shapes:
    """Upright stack of tenants' light boxes, 4.2 m high, on a steel mast with brackets."""
    shapes: Shapes = [tube([[0.0, -0.23, 0.0], [0.0, -0.23, 4.2]], 0.035, "metal_grey", sides=16)]
    for z in (0.5, 2.1, 3.65):
        shapes.append(bevelled((-0.03, -0.22, z), (0.03, 0.0, z + 0.05), "metal_grey"))
        shapes.append(bevelled((-0.09, -0.012, z - 0.07), (0.09, 0.0, z + 0.12), "metal_grey"))
    tints: tuple[Color, ...] = (
        (1.0, 1.0, 1.0),
        (0.93, 0.93, 0.94),
        (1.0, 1.0, 1.0),
        (0.93, 0.93, 0.94),
    )
    for row, tint in enumerate(tints):
        z = 0.04 + 1.04 * row
        shapes.append(bevelled((-0.09, -0.98, z), (0.09, -0.26, z + 1.0), "sign", tint, bevel=0.02))
    return shapes


FITTINGS: Mapping[str, Callable[[], Shapes]] = MappingProxyType(
    {
        maker.__name__: maker
        for maker in (
            awning, box_awning, sign_fascia, sign_box, sign_letters, sign_blade, sign_tower,
        )
    }
)  # fmt: skip
FINE_FITTINGS: Mapping[str, Callable[[], Shapes]] = MappingProxyType(
    {
        maker.__name__.removeprefix("fine_"): maker
        for maker in (
            fine_awning, fine_box_awning, fine_sign_fascia, fine_sign_box,
            fine_sign_letters, fine_sign_blade, fine_sign_tower,
        )
    }
)  # fmt: skip


@lru_cache(maxsize=32)
@kept("fitting", least=FINE)
def fitting(name: str, *, detail: int = 2) -> Prototype:
    """Make an awning or a sign; `name` is a key of `FITTINGS`, `detail` as of windows."""
    if detail >= FINE:
        return prototype(f"{name}_fine", "trim", FINE_FITTINGS[name]())
    return prototype(name, "trim", FITTINGS[name]())
