"""What is put on walls besides openings: bands, cornices, fittings, surrounds and balconies.

Bands and cornices are one metre long (x from -0.5 to 0.5) and scaled to the wall; the others have
real size. Origins lie on the wall plane, -y outward; see `cityx.assets.openings.frames`. The forms
for near views have the origins and sizes of the plain ones.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import lru_cache
from itertools import pairwise
from types import MappingProxyType

import numpy as np

from cityx.assets.kept_prototypes import kept
from cityx.assets.openings.frames import FINE, slab
from cityx.assets.shapes import bevelled, box, cylinder, disc, loft, moved, prism, prototype, tube
from cityx.assets.trims import balconies, surrounds
from cityx.assets.trims.mouldings import Shapes, ledge, scroll, sheet, soft
from cityx.city.mesh import MeshBatch
from cityx.city.scene import Prototype


def _profile(points: list[tuple[float, float]], material: str = "trim") -> MeshBatch:
    """Sweep a profile of (outward, up) along one metre of wall."""
    ring = np.array([(-out, up) for out, up in points])  # y, z; counter-clockwise from +x
    ends = [np.column_stack([np.full(len(ring), x), ring]) for x in (-0.5, 0.5)]
    return loft(np.stack(ends), material)


def band_box() -> Shapes:
    """Make a unit box: a metre long, a metre deep, a metre high, to be scaled."""
    return [slab(-0.5, 0.5, 0.0, 1.0, -1.0, "trim")]


def band_paint() -> Shapes:
    """Make a unit box of smooth paint."""
    return [slab(-0.5, 0.5, 0.0, 1.0, -1.0, "door_paint")]


def band_frame() -> Shapes:
    """Make a unit box in the colour of window frames: mullions, spandrels."""
    return [slab(-0.5, 0.5, 0.0, 1.0, -1.0, "frame_paint")]


def band_stone() -> Shapes:
    """Make a bay of dressed stone, 3.6 m by 3.6 m, as thick as a skin."""
    return [slab(-1.8, 1.8, 0.0, 3.6, -0.012, "stone")]


def cornice() -> Shapes:
    """Make a main cornice with a cyma, 0.6 m high, its upper edge at z = 0."""
    line = [(0.0, -0.60), (0.06, -0.60), (0.06, -0.42), (0.12, -0.38), (0.12, -0.30),
            (0.30, -0.22), (0.30, -0.12), (0.38, -0.04), (0.38, 0.0), (0.0, 0.0)]  # fmt: skip
    return [_profile(line)]


def coping() -> Shapes:
    """Plain coping of a flat roof, 0.22 m high, its upper edge at z = 0.04."""
    return [_profile([(0.0, -0.18), (0.07, -0.18), (0.07, 0.04), (0.0, 0.04)])]


def eaves_board() -> Shapes:
    """Fascia with a gutter, its upper edge at z = 0."""
    return [
        _profile([(0.0, -0.22), (0.03, -0.22), (0.03, 0.0), (0.0, 0.0)]),
        _profile([(0.03, -0.13), (0.13, -0.13), (0.15, -0.02), (0.03, -0.02)], "metal_grey"),
    ]


def string_course() -> Shapes:
    """Moulded band between storeys, 0.22 m high, its middle at z = 0."""
    line = [(0.0, -0.11), (0.05, -0.11), (0.06, -0.02), (0.13, 0.03), (0.13, 0.09), (0.0, 0.13)]
    return [_profile(line)]


def bracket() -> Shapes:
    """Console under a cornice."""
    outline = [(0.0, -0.45), (0.09, -0.38), (0.11, -0.2), (0.27, -0.12), (0.27, 0.0), (0.0, 0.0)]
    ring = np.array([(-out, up) for out, up in outline])
    ends = [np.column_stack([np.full(len(ring), x), ring]) for x in (-0.08, 0.08)]
    return [loft(np.stack(ends), "trim")]


def air_conditioner() -> Shapes:
    """Outdoor unit on brackets."""
    return [
        slab(-0.4, 0.4, 0.0, 0.58, -0.42, "plastic", (0.95, 0.94, 0.90), back=-0.10),
        disc((-0.1, -0.43, 0.29), 0.22, "metal_dark", sides=10, thickness=0.012),
        slab(-0.34, -0.30, -0.05, 0.0, -0.40, "metal_grey"),
        slab(0.30, 0.34, -0.05, 0.0, -0.40, "metal_grey"),
    ]


def downpipe() -> Shapes:
    """Rain pipe, one metre high, to be scaled."""
    return [cylinder((0.0, -0.09, 0.0), (0.0, -0.09, 1.0), 0.05, "metal_grey", sides=6)]


def fire_escape() -> Shapes:
    """One storey (3 m) of an iron fire escape: a landing and a flight."""
    shapes: Shapes = [box((-1.6, -1.1, -0.06), (1.6, 0.0, 0.0), "metal_dark")]
    for z in (0.5, 1.0):
        shapes.append(box((-1.6, -1.1, z - 0.02), (1.6, -1.07, z + 0.02), "metal_dark"))
        for x in (-1.6, 1.57):
            shapes.append(box((x, -1.07, z - 0.02), (x + 0.03, 0.0, z + 0.02), "metal_dark"))
    for x in np.linspace(-1.6, 1.57, 12):
        shapes.append(box((x, -1.1, 0.0), (x + 0.025, -1.075, 1.0), "metal_dark", bottom=False))
    for y in (-0.95, -0.4):
        rings = [[[x - 0.1, y, z], [x + 0.1, y, z], [x + 0.1, y + 0.04, z], [x - 0.1, y + 0.04, z]]
                 for x, z in ((-1.2, 0.0), (1.2, 2.94))]  # fmt: skip
        shapes.append(loft(np.array(rings), "metal_dark"))
    for step in range(1, 11):
        x, z = -1.2 + 2.4 * step / 11, 2.94 * step / 11
        shapes.append(box((x - 0.1, -0.95, z - 0.02), (x + 0.1, -0.36, z + 0.01), "metal_dark"))
    return shapes


def _course(points: list[tuple[float, float]], material: str = "trim", *, radius: float = 0.012,
            steps: int = 4) -> MeshBatch:  # fmt: skip
    """Sweep a softened profile of (outward, up) along one metre of wall."""
    line = np.array([(-out, up) for out, up in points])
    closed = np.vstack([line[-1:], soft(line, radius, steps)])[1:]
    return ledge(closed, -0.5, 0.5, material)


def _cyma(
    out0: float, z0: float, out1: float, z1: float, steps: int = 7
) -> list[tuple[float, float]]:
    """Points of an S-shaped moulding between two corners."""
    t = np.linspace(0.0, 1.0, steps)
    bend = t + 0.16 * np.sin(2 * np.pi * t)
    return [(float(out0 + (out1 - out0) * b), float(z0 + (z1 - z0) * s))
            for b, s in zip(bend, t, strict=True)]  # fmt: skip


def fine_cornice() -> Shapes:
    """Draw a main fine_cornice, 0.6 m high, its upper edge at z = 0.

    From below: bed mouldings, a corona with a drip, a cyma.
    """
    line = [(0.0, -0.60), (0.05, -0.60), (0.06, -0.585), (0.05, -0.57), (0.05, -0.44),
            *_cyma(0.06, -0.42, 0.13, -0.33), (0.13, -0.30), (0.15, -0.285), (0.15, -0.26),
            (0.27, -0.24), (0.27, -0.255), (0.29, -0.255), (0.30, -0.24), (0.30, -0.13),
            *_cyma(0.31, -0.11, 0.38, -0.025), (0.38, 0.0), (0.0, 0.0)]  # fmt: skip
    return [_course(line, radius=0.006, steps=3)]


def fine_coping() -> Shapes:
    """Coping stone with a drip, 0.22 m high, its upper edge at z = 0.04."""
    line = [(0.0, -0.18), (0.02, -0.18), (0.02, -0.04), (0.05, -0.04), (0.05, -0.05), (0.07, -0.05),
            (0.07, 0.015), (0.05, 0.025), (0.0, 0.04)]  # fmt: skip
    return [_course(line, radius=0.006, steps=3)]


def fine_eaves_board() -> Shapes:
    """Fascia with a half-round gutter and its beads, upper edge at z = 0."""
    angle = np.linspace(np.pi, 2 * np.pi, 17)
    outer = [(0.09 - 0.06 * np.cos(a), -0.02 + 0.075 * np.sin(a)) for a in angle[::-1]]
    inner = [(0.09 - 0.055 * np.cos(a), -0.02 + 0.068 * np.sin(a)) for a in angle]
    gutter = np.array([(-out, up) for out, up in [*outer[::-1], *inner[::-1]]])
    ends = [np.column_stack([np.full(len(gutter), x), gutter]) for x in (-0.5, 0.5)]
    board = _course([(0.0, -0.22), (0.022, -0.22), (0.028, -0.20), (0.028, 0.0), (0.0, 0.0)],
                    radius=0.004)  # fmt: skip
    channel = loft(np.stack(ends)[:, ::-1], "metal_grey", caps=(False, False))
    bead = tube([[-0.5, -0.152, -0.018], [0.5, -0.152, -0.018]], 0.009, "metal_grey", sides=10)
    return [board, channel, bead]


def fine_string_course() -> Shapes:
    """Moulded band between storeys, 0.22 m high, its middle at z = 0."""
    line = [(0.0, -0.11), (0.035, -0.11), (0.045, -0.095), (0.035, -0.08), (0.04, -0.05),
            *_cyma(0.045, -0.04, 0.10, 0.015), (0.13, 0.03), (0.13, 0.09), (0.115, 0.10), (0.0,
                0.13)]  # fmt: skip
    return [_course(line, radius=0.006, steps=3)]


def fine_bracket() -> Shapes:
    """Scrolled console under a fine_cornice."""
    t = np.linspace(0.0, 1.0, 15)
    out = 0.09 + 0.18 * t**2 + 0.025 * np.sin(2 * np.pi * t)
    line = np.vstack([np.column_stack([-out, -0.45 + 0.42 * t])[::-1], [(0.0, -0.45), (0.0, 0.0)]])
    line = np.vstack([[(-0.27, 0.0)], line])
    shapes: Shapes = [ledge(line, -0.07, 0.07, "trim")]
    for x in (-0.075, 0.075):
        shapes.append(moved(scroll(0.0, 0.0, 0.0, 0.07, 1.0, material="trim", radius=0.014),
                            (x, -0.17, -0.12), yaw=np.pi / 2))  # fmt: skip
    return shapes


def fine_air_conditioner() -> Shapes:
    """Outdoor unit: casing, fan with blades behind a wire guard, louvres, pipes, brackets."""
    shapes: Shapes = [bevelled((-0.4, -0.42, 0.0), (0.4, -0.10, 0.58), "plastic", (0.95, 0.94,
        0.90),
                               bevel=0.015)]  # fmt: skip
    cx, cz, y = -0.1, 0.29, -0.425
    angle = np.linspace(0.0, 2 * np.pi, 41)
    for radius in (0.235, 0.20, 0.165, 0.13, 0.095, 0.06):
        ring = np.column_stack([cx + radius * np.cos(angle), np.full(41, y - 0.012),
                                cz + radius * np.sin(angle)])  # fmt: skip
        shapes.append(tube(ring, 0.004, "plastic", (0.9, 0.9, 0.88), sides=5, caps=(False, False)))
    for a in np.linspace(0.0, 2 * np.pi, 13)[:-1]:
        way = np.array([np.cos(a), 0.0, np.sin(a)])
        hub = np.array([cx, y - 0.009, cz])
        shapes.append(tube([hub + 0.05 * way, hub + 0.235 * way], 0.004, "plastic", (0.9, 0.9,
            0.88),
                           sides=5))  # fmt: skip
    disc = np.column_stack([cx + 0.235 * np.cos(angle[:-1]), cz + 0.235 * np.sin(angle[:-1])])
    shapes.append(prism(disc, y - 0.001, y + 0.004, "metal_dark"))
    for a in np.linspace(0.0, 2 * np.pi, 4)[:-1]:
        s, t = np.meshgrid(np.linspace(0.05, 0.22, 7), np.linspace(0.0, 1.0, 7))
        turn = a + 0.9 * t + 0.4 * s
        blade = np.stack([cx + s * np.cos(turn), y - 0.003 - 0.004 * t, cz + s * np.sin(turn)], -1)
        shapes += [sheet(blade, "metal_grey"), sheet(blade[:, ::-1], "metal_grey")]
    for z in np.linspace(0.06, 0.52, 16):
        shapes.append(
            bevelled((0.19, -0.428, z), (0.36, -0.415, z + 0.012), "metal_dark", bevel=0.002)
        )
    for x in (-0.32, 0.32):
        shapes.append(bevelled((x - 0.02, -0.40, -0.045), (x + 0.02, 0.0, -0.01), "metal_grey"))
        shapes.append(tube([[x, -0.38, -0.03], [x, -0.02, -0.32]], 0.012, "metal_grey", sides=10))
    for k in range(2):
        pipe = [[0.40, -0.2 - 0.04 * k, 0.1], [0.46, -0.2 - 0.04 * k, 0.1], [0.48, -0.06, 0.14],
                [0.48, 0.0, 0.3]]  # fmt: skip
        shapes.append(tube(pipe, 0.012, "cloth", sides=10))
    return shapes


def fine_downpipe() -> Shapes:
    """Rain pipe, one metre high, to be scaled."""
    return [tube([[0.0, -0.09, 0.0], [0.0, -0.09, 1.0]], 0.05, "metal_grey", sides=18)]


def fine_fire_escape() -> Shapes:
    """One storey (3 m) of an iron fire escape: grating, railings, stringers, open treads."""
    shapes: Shapes = []
    for y in np.arange(-1.06, 0.0, 0.055):
        shapes.append(bevelled((-1.6, y, -0.03), (1.6, y + 0.008, 0.0), "metal_dark", bevel=0.001))
    for x in np.linspace(-1.58, 1.58, 9):
        shapes.append(bevelled((x - 0.012, -1.1, -0.06), (x + 0.012, 0.0, -0.03), "metal_dark"))
    for z in (0.12, 0.55, 1.0):
        rail = [[-1.6, 0.0, z], [-1.6, -1.09, z], [1.6, -1.09, z], [1.6, 0.0, z]]
        for a, b in pairwise(rail):
            shapes.append(tube([a, b], 0.018 if z == 1.0 else 0.010, "metal_dark", sides=10))
    for x in np.linspace(-1.6, 1.6, 27):
        shapes.append(tube([[x, -1.09, 0.0], [x, -1.09, 1.0]], 0.008, "metal_dark", sides=8))
    for y in (-0.95, -0.4):
        rings = [[[x - 0.1, y, z], [x + 0.1, y, z], [x + 0.1, y + 0.03, z], [x - 0.1, y + 0.03, z]]
                 for x, z in ((-1.2, 0.0), (1.2, 2.94))]  # fmt: skip
        shapes.append(loft(np.array(rings), "metal_dark"))
        shapes.append(tube([[-1.2, y, 0.9], [1.2, y, 3.84]], 0.016, "metal_dark", sides=10))
        for t in np.linspace(0.05, 0.95, 7):
            x, z = -1.2 + 2.4 * t, 2.94 * t
            shapes.append(tube([[x, y, z], [x, y, z + 0.9]], 0.008, "metal_dark", sides=8))
    for step in range(1, 14):
        x, z = -1.2 + 2.4 * step / 14, 2.94 * step / 14
        for k in range(5):
            shapes.append(bevelled((x - 0.1 + 0.04 * k, -0.95, z - 0.02), (x - 0.075 + 0.04 * k,
                -0.37, z),
                                   "metal_dark", bevel=0.002))  # fmt: skip
    return shapes


TRIMS: Mapping[str, Callable[[], Shapes]] = MappingProxyType(
    {
        maker.__name__: maker
        for maker in (
            band_box, band_paint, band_frame, band_stone, cornice, coping, eaves_board,
            string_course, bracket, surrounds.sill, surrounds.sill_metal,
            surrounds.surround_flat, surrounds.surround_cap, surrounds.surround_pediment,
            surrounds.surround_lintel, surrounds.surround_block, surrounds.portal_panel,
            surrounds.portal_double, surrounds.portal_house, surrounds.portal_church,
            balconies.balcony_iron, balconies.balcony_solid, balconies.balcony_bars,
            balconies.balcony_glass, balconies.balcony_rail, air_conditioner, downpipe,
            fire_escape,
        )
    }
)  # fmt: skip


FINE_TRIMS: Mapping[str, Callable[[], Shapes]] = MappingProxyType(
    {
        maker.__name__.removeprefix("fine_"): maker
        for maker in (
            fine_cornice, fine_coping, fine_eaves_board, fine_string_course, fine_bracket,
            surrounds.fine_sill, surrounds.fine_sill_metal, surrounds.fine_surround_flat,
            surrounds.fine_surround_cap, surrounds.fine_surround_pediment,
            surrounds.fine_surround_lintel, surrounds.fine_surround_block,
            surrounds.fine_portal_panel, surrounds.fine_portal_double,
            surrounds.fine_portal_house, surrounds.fine_portal_church,
            balconies.fine_balcony_iron, balconies.fine_balcony_solid,
            balconies.fine_balcony_bars, balconies.fine_balcony_glass,
            balconies.fine_balcony_rail, fine_air_conditioner, fine_downpipe, fine_fire_escape,
        )
    }
)  # fmt: skip


@lru_cache(maxsize=128)
@kept("trim", least=FINE)
def trim(name: str, *, detail: int = 2) -> Prototype:
    """Make a trim prototype; `name` is a key of `TRIMS`, `detail` as of windows."""
    if detail >= FINE and name in FINE_TRIMS:
        return prototype(f"{name}_fine", "trim", FINE_TRIMS[name]())
    return prototype(name, "trim", TRIMS[name]())
