"""What is put on walls besides openings: surrounds, bands, balconies, fittings.

Bands and cornices are one metre long (x from -0.5 to 0.5) and scaled to the wall; the others have
real size. Origins lie on the wall plane, -y outward; see `cityx.assets.openings.openings`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import lru_cache
from types import MappingProxyType

import numpy as np

from cityx.assets.kept_prototypes import kept
from cityx.assets.openings.openings import FINE, Shapes, arch, slab, surround
from cityx.assets.shapes import box, cylinder, disc, loft, prism, prototype
from cityx.city.mesh import MeshBatch
from cityx.city.scene import Prototype

CORNICE_DEPTH = 0.38  # metres a cornice stands out; its ends overlap round corners by as much
# Drawn for this opening; the plugin scales them to the real one.
SURROUND_WIDTH, SURROUND_HEIGHT = 1.1, 1.8


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


# --- surrounds: bottom centre of the opening at the origin ----------------------------------------

_W, _H = SURROUND_WIDTH / 2, SURROUND_HEIGHT


def sill() -> Shapes:
    """Window sill."""
    return [slab(-_W - 0.1, _W + 0.1, -0.10, 0.0, -0.14, "trim")]


def sill_metal() -> Shapes:
    """Thin sheet sill."""
    return [slab(-_W - 0.04, _W + 0.04, -0.035, 0.0, -0.10, "metal_grey")]


def _architrave(border: float = 0.15, front: float = -0.055) -> Shapes:
    return [
        slab(-_W - border, -_W, 0.0, _H, front, "trim"),
        slab(_W, _W + border, 0.0, _H, front, "trim"),
        slab(-_W - border, _W + border, _H, _H + border, front, "trim"),
    ]


def surround_flat() -> Shapes:
    """Flat architrave with a sill."""
    return [*_architrave(), *sill()]


def surround_cap() -> Shapes:
    """Architrave, sill and a straight cornice on top."""
    return [
        *surround_flat(),
        slab(-_W - 0.15, _W + 0.15, _H + 0.15, _H + 0.33, -0.05, "trim"),
        slab(-_W - 0.26, _W + 0.26, _H + 0.33, _H + 0.44, -0.21, "trim"),
    ]


def surround_pediment() -> Shapes:
    """Architrave, sill and a triangular pediment."""
    base = _H + 0.15
    outline = [(-_W - 0.28, base + 0.1), (_W + 0.28, base + 0.1), (0.0, base + 0.48)]
    inner = [(-_W - 0.10, base + 0.14), (_W + 0.10, base + 0.14), (0.0, base + 0.38)]
    return [
        *surround_flat(),
        slab(-_W - 0.26, _W + 0.26, base, base + 0.1, -0.19, "trim"),
        prism(outline, -0.20, 0.0, "trim"),
        prism(inner, -0.205, -0.20, "trim", (0.75, 0.75, 0.75)),
    ]


def surround_lintel() -> Shapes:
    """Stone sill and a flat arch of gauged brick with a keystone."""
    flare = [(-_W - 0.06, _H), (_W + 0.06, _H), (_W + 0.2, _H + 0.32), (-_W - 0.2, _H + 0.32)]
    key = [(-0.07, _H - 0.03), (0.07, _H - 0.03), (0.12, _H + 0.36), (-0.12, _H + 0.36)]
    return [*sill(), prism(flare, -0.03, 0.0, "trim"), prism(key, -0.06, 0.0, "trim")]


def surround_block() -> Shapes:
    """Stone lintel and sill, square cut."""
    return [
        *sill(),
        slab(-_W - 0.18, _W + 0.18, _H, _H + 0.24, -0.045, "trim"),
    ]


# --- surrounds of doors, by the name of the door --------------------------------------------------


def portal_panel() -> Shapes:
    """Pilasters and hood of a panelled door."""
    return [
        slab(-0.85, -0.60, -0.3, 2.75, -0.10, "trim"),
        slab(0.60, 0.85, -0.3, 2.75, -0.10, "trim"),
        slab(-0.95, 0.95, 2.75, 3.0, -0.22, "trim"),
    ]


def portal_double() -> Shapes:
    """Architrave of a double door."""
    return [*surround(2.0, 3.1, 0.16, -0.09, "trim", bottom=False)]


def portal_house() -> Shapes:
    """Small gabled hood on brackets."""
    return [
        slab(-0.95, 0.95, 2.30, 2.38, -0.85, "trim"),
        prism([(-0.98, 2.38), (0.98, 2.38), (0.0, 2.70)], -0.88, 0.0, "trim", (0.7, 0.68, 0.66)),
        slab(-0.9, -0.82, 1.95, 2.30, -0.35, "trim"),
        slab(0.82, 0.9, 1.95, 2.30, -0.35, "trim"),
    ]


def portal_church() -> Shapes:
    """Make stepped arches of a portal."""
    return [
        prism(arch(2.7, 4.0), -0.20, 0.0, "trim"),
        prism(arch(2.2, 3.7), -0.24, 0.0, "trim", (0.8, 0.79, 0.77)),
    ]


# --- balconies: floor level and middle at the origin ----------------------------------------------

BALCONY_WIDTH = 2.4  # metres, of every balcony
_B = BALCONY_WIDTH / 2


def _railing(depth: float, rods: int) -> Shapes:
    shapes: Shapes = []
    for z0, z1 in ((0.06, 0.09), (0.99, 1.04)):
        shapes.append(box((-_B, -depth, z0), (_B, -depth + 0.04, z1), "metal_dark"))
        for x in (-_B, _B - 0.04):
            shapes.append(box((x, -depth + 0.04, z0), (x + 0.04, 0.0, z1), "metal_dark"))
    for x in np.linspace(-_B, _B - 0.02, rods):
        shapes.append(box((x, -depth + 0.01, 0.09), (x + 0.02, -depth + 0.03, 0.99), "metal_dark",
                          bottom=False))  # fmt: skip
    side = max(3, round(depth / (2 * _B) * rods))
    for y in np.linspace(-depth, -0.1, side)[1:]:
        for x in (-_B + 0.01, _B - 0.03):
            shapes.append(box((x, y, 0.09), (x + 0.02, y + 0.02, 0.99), "metal_dark",
                              bottom=False))  # fmt: skip
    return shapes


def balcony_iron() -> Shapes:
    """Shallow stone balcony on consoles with an iron railing."""
    shapes: Shapes = [slab(-_B - 0.05, _B + 0.05, -0.14, 0.0, -0.95, "trim")]
    for x in (-_B + 0.3, _B - 0.3):
        outline = np.array([(0.0, -0.6), (-0.14, -0.5), (-0.2, -0.3), (-0.6, -0.14), (0.0, -0.14)])
        ends = [np.column_stack([np.full(5, x + dx), outline]) for dx in (-0.09, 0.09)]
        shapes.append(loft(np.stack(ends), "trim"))
    return shapes + _railing(0.9, 17)


def balcony_solid() -> Shapes:
    """Concrete balcony with a solid parapet and a rail."""
    return [
        slab(-_B, _B, -0.18, 0.0, -1.15, "trim"),
        box((-_B, -1.15, 0.0), (_B, -1.05, 0.85), "trim", (0.92, 0.92, 0.92)),
        box((-_B, -1.05, 0.0), (-_B + 0.1, 0.0, 0.85), "trim", (0.92, 0.92, 0.92)),
        box((_B - 0.1, -1.05, 0.0), (_B, 0.0, 0.85), "trim", (0.92, 0.92, 0.92)),
        box((-_B, -1.12, 0.98), (_B, -1.08, 1.02), "metal_grey"),
    ]


def balcony_bars() -> Shapes:
    """Concrete slab with a plain railing."""
    return [slab(-_B, _B, -0.2, 0.0, -1.2, "trim"), *_railing(1.18, 15)]


def balcony_glass() -> Shapes:
    """Slab with a glass balustrade."""
    return [
        slab(-_B, _B, -0.2, 0.0, -1.25, "trim"),
        box((-_B, -1.24, 0.04), (_B, -1.22, 1.0), "glass"),
        box((-_B, -1.22, 0.04), (-_B + 0.02, 0.0, 1.0), "glass"),
        box((_B - 0.02, -1.22, 0.04), (_B, 0.0, 1.0), "glass"),
        box((-_B, -1.26, 1.0), (_B, -1.21, 1.05), "metal_grey"),
    ]


def balcony_rail() -> Shapes:
    """Railing close before a French window, drawn for the balcony's width."""
    return _railing(0.22, 21)


# --- fittings -------------------------------------------------------------------------------------


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


TRIMS: Mapping[str, Callable[[], Shapes]] = MappingProxyType(
    {
        maker.__name__: maker
        for maker in (
            band_box, band_paint, band_frame, band_stone, cornice, coping, eaves_board,
            string_course, bracket, sill, sill_metal, surround_flat, surround_cap,
            surround_pediment, surround_lintel, surround_block, portal_panel, portal_double,
            portal_house, portal_church, balcony_iron, balcony_solid,
            balcony_bars,
            balcony_glass, balcony_rail, air_conditioner, downpipe, fire_escape,
        )
    }
)  # fmt: skip


@lru_cache(maxsize=128)
@kept("trim", least=FINE)
def trim(name: str, *, detail: int = 2) -> Prototype:
    """Make a trim prototype; `name` is a key of `TRIMS`, `detail` as of windows."""
    if detail >= FINE:
        from cityx.assets.trims.fine_trims import FINE_TRIMS

        if name in FINE_TRIMS:
            return prototype(f"{name}_fine", "trim", FINE_TRIMS[name]())
    return prototype(name, "trim", TRIMS[name]())
