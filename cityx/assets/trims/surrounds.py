"""Surrounds of windows and doors: bottom centre of the opening at the origin.

Those of windows are drawn for an opening of `SURROUND_WIDTH` by `SURROUND_HEIGHT`, to which the
plugin scales them; those of doors are named for the door. The forms for near views have the sizes
of the plain ones.
"""

from __future__ import annotations

import numpy as np

from cityx.assets.openings.frames import arch, slab, surround
from cityx.assets.shapes import bevelled, lathe, loft, moved, prism, tube
from cityx.assets.trims.mouldings import (
    Shapes,
    console,
    ledge,
    portal,
    raised_panel,
    ring_moulding,
    soft,
)
from cityx.city.mesh import MeshBatch, one_mesh
from cityx.geometry.arrays import FloatArray

# Drawn for this opening; the plugin scales them to the real one.
SURROUND_WIDTH, SURROUND_HEIGHT = 1.1, 1.8
_W, _H = SURROUND_WIDTH / 2, SURROUND_HEIGHT


def _architrave(border: float = 0.15, front: float = -0.055) -> Shapes:
    return [
        slab(-_W - border, -_W, 0.0, _H, front, "trim"),
        slab(_W, _W + border, 0.0, _H, front, "trim"),
        slab(-_W - border, _W + border, _H, _H + border, front, "trim"),
    ]


def sill() -> Shapes:
    """Window sill."""
    return [slab(-_W - 0.1, _W + 0.1, -0.10, 0.0, -0.14, "trim")]


def sill_metal() -> Shapes:
    """Thin sheet sill."""
    return [slab(-_W - 0.04, _W + 0.04, -0.035, 0.0, -0.10, "metal_grey")]


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
    return [*sill(), slab(-_W - 0.18, _W + 0.18, _H, _H + 0.24, -0.045, "trim")]


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


def fine_sill() -> Shapes:
    """Stone fine_sill: weathered top, drip groove beneath, ends that run into the wall."""
    line = soft([(0.06, -0.10), (0.06, 0.004), (0.0, 0.0), (-0.125, -0.018), (-0.14, -0.028),
                 (-0.14, -0.085), (-0.125, -0.098), (-0.11, -0.10), (-0.105, -0.09), (-0.09, -0.09),
                 (-0.085, -0.10), (0.0, -0.10)], 0.006, 3)  # fmt: skip
    line = line[line[:, 0] < 0.001]
    return [ledge(np.vstack([line, [(0.0, -0.10)]]), -_W - 0.1, _W + 0.1, "trim")]


def fine_sill_metal() -> Shapes:
    """Sheet fine_sill with a welted front edge and turned-up ends."""
    line = [(0.0, -0.035), (0.0, 0.0), (-0.095, -0.014), (-0.10, -0.02), (-0.10, -0.034),
            (-0.094, -0.036), (-0.092, -0.028)]  # fmt: skip
    shapes: Shapes = [ledge(np.array(line), -_W - 0.04, _W + 0.04, "metal_grey")]
    for x in (-_W - 0.04, _W + 0.034):
        shapes.append(
            bevelled((x, -0.09, -0.03), (x + 0.006, 0.0, 0.03), "metal_grey", bevel=0.001)
        )
    return shapes


_ARCHITRAVE = np.array([(0.0, 0.0), (0.0, -0.050), (0.010, -0.058), (0.026, -0.060), (0.036,
    -0.050),
                        (0.040, -0.042), (0.075, -0.042), (0.080, -0.034), (0.118, -0.034),
                        (0.122, -0.026), (0.140, -0.024), (0.150, -0.014), (0.150,
                            0.0)])  # fmt: skip


def _moulded_architrave(border: float = 0.15) -> Shapes:
    """Jambs and head of three fasciae with a moulded edge, on plinth blocks."""
    line = soft(_ARCHITRAVE * [border / 0.15, 1.0], 0.005, 3)
    shapes: Shapes = [portal(-_W - border, _W + border, 0.0, _H + border, line, "trim")]
    for x in (-_W - border, _W):
        shapes.append(bevelled((x - 0.008, -0.070, 0.0), (x + border + 0.004, 0.0, 0.18), "trim",
                               bevel=0.008, hidden=("+y",)))  # fmt: skip
    return shapes


def fine_surround_flat() -> Shapes:
    """Moulded architrave with a fine_sill on two blocks."""
    return [*_moulded_architrave(), *fine_sill(), *_sill_blocks()]


def _sill_blocks() -> Shapes:
    t = np.linspace(0.0, 1.0, 9)
    out = 0.11 * (1 - t**2) + 0.012
    line = np.vstack([np.column_stack([-out, -0.10 - 0.16 * t]), [(0.0, -0.26), (0.0, -0.10)]])
    return [ledge(line, x - 0.055, x + 0.055, "trim") for x in (-_W, _W)]


def _hood(z: float) -> Shapes:
    """Cornice over a window, with returns, on dentils."""
    line = soft([(0.0, 0.0), (-0.05, 0.0), (-0.06, 0.018), (-0.12, 0.028), (-0.12, 0.05), (-0.17,
        0.06),
                 (-0.20, 0.085), (-0.21, 0.10), (-0.21, 0.112), (0.0, 0.13)][::-1], 0.008,
                     3)  # fmt: skip
    shapes: Shapes = [ledge(line + np.array([0.0, z]), -_W - 0.26, _W + 0.26, "trim")]
    for x in np.linspace(-_W - 0.14, _W + 0.14, 17):
        shapes.append(bevelled((x - 0.022, -0.10, z - 0.045), (x + 0.022, 0.0, z + 0.005), "trim",
                               bevel=0.004, hidden=("+y", "+z")))  # fmt: skip
    return shapes


def fine_surround_cap() -> Shapes:
    """Architrave, frieze panel, consoles and a cornice."""
    base = _H + 0.15
    shapes = [*fine_surround_flat(), *_hood(base + 0.20)]
    shapes.append(bevelled((-_W - 0.15, -0.03, base), (_W + 0.15, 0.0, base + 0.2), "trim",
                           hidden=("+y", "+z")))  # fmt: skip
    shapes += raised_panel(-_W + 0.05, _W - 0.05, base + 0.025, base + 0.145, -0.03, "trim")
    for x in (-_W - 0.12, _W + 0.12):
        shapes += [moved(part, (x, 0.0, base + 0.2)) for part in console(0.2, 0.32, 0.11)]
    return shapes


def fine_surround_pediment() -> Shapes:
    """Architrave, consoles and a triangular pediment with raking mouldings."""
    base = _H + 0.15
    shapes = [*fine_surround_flat(), *_hood(base + 0.02)]
    outer = [(-_W - 0.26, base + 0.13), (_W + 0.26, base + 0.13), (0.0, base + 0.50)]
    shapes.append(prism([(-_W - 0.1, base + 0.14), (_W + 0.1, base + 0.14), (0.0, base + 0.42)],
        -0.06,
                        0.0, "trim", (0.92, 0.92, 0.92)))  # fmt: skip
    rake = soft([(0.0, 0.0), (0.0, -0.20), (0.012, -0.21), (0.03, -0.19), (0.04, -0.16), (0.06,
        -0.14),
                 (0.07, -0.10), (0.085, -0.06)], 0.008, 3)  # fmt: skip
    path = [outer[1], outer[2], outer[0]]
    shapes.append(ring_moulding(path, rake, "trim", closed=False))
    shapes.append(moved(lathe([(0.10, 0.0), (0.10, 0.02), (0.07, 0.035), (0.05, 0.03), (0.0, 0.05)],
                              "trim", sides=20), (0.0, 0.0, 0.0)))  # fmt: skip
    boss = shapes.pop()
    turned = np.column_stack(
        [boss.vertices[:, 0], -0.06 - boss.vertices[:, 2], boss.vertices[:, 1]]
    )
    shapes.append(_same(boss, turned + np.array([0.0, 0.0, base + 0.25])))
    for x in (-_W - 0.12, _W + 0.12):
        shapes += [moved(part, (x, 0.0, base + 0.02)) for part in console(0.18, 0.3, 0.11)]
    return shapes


def _same(mesh: MeshBatch, vertices: FloatArray) -> MeshBatch:
    return one_mesh(0, vertices, mesh.faces, materials=mesh.materials, uv=mesh.uv, tint=mesh.tint)


def fine_surround_lintel() -> Shapes:
    """Stone fine_sill and a flat arch of gauged bricks, each drawn, with a keystone."""
    shapes: Shapes = [*fine_sill()]
    count, low, high = 13, _H, _H + 0.32
    foot, top = _W + 0.06, _W + 0.2
    for k in range(count):
        a, b = -1 + 2 * (k + 0.04) / count, -1 + 2 * (k + 0.96) / count
        if abs(a + b) < 0.1:
            continue
        corners = [(a * foot, low), (b * foot, low), (b * top, high), (a * top, high)]
        line = soft([(0.0, 0.0), (0.0, -0.026), (0.004, -0.030)], 0.002, 2)
        shapes.append(ring_moulding(corners, line, "trim"))
        inner = np.array(corners)
        middle = inner.mean(axis=0)
        inner = middle + (inner - middle) * (1 - 0.004 / np.abs(inner - middle).max(axis=0))
        shapes.append(_face(inner, -0.030))
    for half0, half1, front in ((0.07, 0.12, -0.05), (0.05, 0.095, -0.075)):
        key = [(-half0, _H - 0.03), (half0, _H - 0.03), (half1, _H + 0.36), (-half1, _H + 0.36)]
        line = soft([(0.0, 0.0), (0.0, front + 0.012), (0.012, front)], 0.006, 3)
        shapes.append(ring_moulding(key, line, "trim"))
        inner = np.array(key) * [0.86, 1.0]
        inner[:, 1] += (0.012, 0.012, -0.012, -0.012)
        shapes.append(_face(inner, front))
    return shapes


def _face(outline: FloatArray, y: float, material: str = "trim") -> MeshBatch:
    corners = np.column_stack([outline[:, 0], np.full(len(outline), y), outline[:, 1]])
    return one_mesh(0, corners, [[0, 1, 2, 3]], materials=(material,), uv=outline[None])


def fine_surround_block() -> Shapes:
    """Stone lintel with chamfered edges and a fine_sill."""
    return [
        *fine_sill(),
        bevelled((-_W - 0.18, -0.045, _H), (_W + 0.18, 0.0, _H + 0.24), "trim", bevel=0.015,
                 hidden=("+y",)),
        *raised_panel(-_W + 0.02, _W - 0.02, _H + 0.05, _H + 0.19, -0.045, "trim"),
    ]  # fmt: skip


def _pilaster(x0: float, x1: float, z0: float, z1: float, out: float) -> Shapes:
    middle, half = (x0 + x1) / 2, (x1 - x0) / 2
    shapes: Shapes = [bevelled((x0, -out, z0), (x1, 0.0, z1), "trim", hidden=("+y",))]
    shapes += raised_panel(x0 + 0.035, x1 - 0.035, z0 + 0.5, z1 - 0.28, -out, "trim")
    for z, tall, more in ((z0, 0.34, 0.03), (z0 + 0.34, 0.06, 0.018), (z1 - 0.20, 0.035, 0.014),
                          (z1 - 0.10, 0.05, 0.02), (z1 - 0.05, 0.05, 0.035)):  # fmt: skip
        line = soft([(0.0, 0.0), (-out - more, 0.0), (-out - more, tall), (0.0, tall)][::-1],
                    min(0.016, 0.4 * tall), 4)  # fmt: skip
        shapes.append(
            ledge(line + np.array([0.0, z]), middle - half - more, middle + half + more, "trim")
        )
    return shapes


def fine_portal_panel() -> Shapes:
    """Pilasters with bases and capitals, an entablature with dentils and a hood."""
    shapes = _pilaster(-0.85, -0.60, -0.3, 2.62, 0.08) + _pilaster(0.60, 0.85, -0.3, 2.62, 0.08)
    line = soft([(0.0, 0.0), (-0.10, 0.0), (-0.10, 0.07), (-0.11, 0.08), (-0.11, 0.20), (-0.15,
        0.215),
                 (-0.15, 0.25), (-0.24, 0.275), (-0.25, 0.33), (-0.28, 0.36), (-0.28, 0.38), (0.0,
                     0.42)][
        ::-1], 0.01, 3)  # fmt: skip
    shapes.append(ledge(line + np.array([0.0, 2.75]), -0.92, 0.92, "trim"))
    for x in np.linspace(-0.86, 0.86, 30):
        shapes.append(bevelled((x - 0.018, -0.155, 2.965), (x + 0.018, -0.10, 3.01), "trim",
                               bevel=0.004, hidden=("+y", "+z")))  # fmt: skip
    for x in (-0.72, 0.72):
        shapes += [moved(part, (x, -0.02, 2.76)) for part in console(0.2, 0.3, 0.14)]
    return shapes


def fine_portal_double() -> Shapes:
    """Moulded architrave of a double door with plinth blocks and a keystone."""
    line = soft(_ARCHITRAVE * [0.16 / 0.15, 1.7], 0.008, 3)
    shapes: Shapes = [portal(-1.0, 1.0, 0.0, 3.1, line, "trim")]
    for x in (-1.0, 0.84):
        shapes.append(bevelled((x - 0.012, -0.12, -0.2), (x + 0.172, 0.0, 0.34), "trim", bevel=0.01,
                               hidden=("+y",)))  # fmt: skip
    shapes += [moved(part, (0.0, 0.0, 3.16)) for part in console(0.22, 0.30, 0.2)]
    return shapes


def fine_portal_house() -> Shapes:
    """Gabled hood with rafters, tiles laid in courses, bargeboards and braces."""
    shapes: Shapes = []
    slope = np.array([0.98, 0.32])
    for side in (-1.0, 1.0):
        for k in range(6):
            y = -0.86 + 0.165 * k
            shapes.append(_rafter(side, y))
        for row in range(6):
            a, b = row / 6, (row + 1.25) / 6
            for k in range(8):
                y0, y1 = -0.90 + 0.112 * k, -0.90 + 0.112 * (k + 0.94)
                ends = [(side * slope[0] * (1 - t), 2.40 + slope[1] * t + 0.012 * (1 - u))
                        for t, u in ((a, 0.0), (min(b, 1.0), 1.0))]  # fmt: skip
                shapes.append(_tile(ends, y0, y1, side))
        board = [(side * 1.0, 2.30), (side * 1.0, 2.40), (0.0, 2.73), (0.0, 2.62)]
        board = board if side > 0 else board[::-1]
        shapes.append(prism(board, -0.92, -0.885, "trim"))
        brace = [[side * 0.86, -0.02, 1.78], [side * 0.86, -0.28, 1.92], [side * 0.86, -0.55, 2.30]]
        shapes.append(tube(brace, [0.032, 0.03, 0.032], "trim", sides=12))
        shapes.append(bevelled((side * 0.86 - 0.045, -0.05, 1.60), (side * 0.86 + 0.045, 0.0, 2.34),
                               "trim", hidden=("+y",)))  # fmt: skip
        shapes.append(bevelled((side * 0.86 - 0.045, -0.84, 2.28), (side * 0.86 + 0.045, 0.0, 2.37),
                               "trim", hidden=("+y",)))  # fmt: skip
    ridge = [[0.0, -0.93, 2.74], [0.0, 0.0, 2.74]]
    shapes.append(tube(ridge, 0.05, "roof_tiles", (0.55, 0.28, 0.2), sides=14))
    return shapes


def _rafter(side: float, y: float) -> MeshBatch:
    outline = [(side * 0.96, 2.32), (side * 0.96, 2.38), (0.0, 2.69), (0.0, 2.62)]
    return prism(outline if side > 0 else outline[::-1], y, y + 0.045, "trim")


def _tile(ends: list[tuple[float, float]], y0: float, y1: float, side: float) -> MeshBatch:
    """Flat tile with a rounded foot lying up the slope."""
    (xa, za), (xb, zb) = ends
    thick = 0.012
    rings = [
        [[x, y0, z], [x, y1, z], [x, y1, z + thick], [x, y0, z + thick]]
        for x, z in ((xa, za + 0.012), (xb, zb + 0.004))
    ]
    ring = np.array(rings)
    return loft(ring if side < 0 else ring[:, ::-1], "roof_tiles", (0.5, 0.25, 0.18))


def fine_portal_church() -> Shapes:
    """Make stepped and moulded arches of a portal on slender shafts."""
    shapes: Shapes = []
    for wide, tall, out in ((2.7, 4.0, -0.16), (2.36, 3.79, -0.10), (2.06, 3.61, -0.05)):
        outline = arch(wide, tall, 24)
        path = np.vstack([outline[1:], outline[:1]])
        line = soft([(0.0, 0.0), (0.0, out), (0.03, out - 0.02), (0.06, out - 0.02), (0.09,
            out + 0.01),
                     (0.11, out + 0.03), (0.14, out + 0.03), (0.17, out + 0.06), (0.17, 0.0)],
                         0.012, 4)  # fmt: skip
        shapes.append(ring_moulding(path, line, "trim", closed=False))
        spring = tall - wide / 2
        for side in (-1.0, 1.0):
            x = side * (wide / 2 - 0.10)
            shaft = [(1.5, 0.0), (1.5, 0.12), (1.2, 0.16), (1.35, 0.2), (1.0, 0.24), (1.0, 2.2),
                     (1.15, 2.22), (1.0, 2.25), (1.3, 2.42), (1.7, 2.5), (1.7, 2.56)]  # fmt: skip
            factor = spring / 2.56
            column = lathe(np.array(shaft) * [0.05, factor], "trim", sides=16)
            shapes.append(moved(column, (x, out - 0.02, 0.0)))
    return shapes
