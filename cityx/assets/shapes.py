"""Small solids for prototypes: boxes, tubes, lathes, lofts and leaf cards.

Every builder returns a `MeshBatch` of one object with id 0; `fuse` joins several into one object.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import replace
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cityx.city.mesh import NO_VERTEX, MeshBatch, concatenate, one_mesh
from cityx.city.scene import Prototype

Color = tuple[float, float, float]
WHITE: Color = (1.0, 1.0, 1.0)
BEVEL = 0.005  # metres, the chamfer that makes an edge catch the light
ROUND = 12  # sides of the thinnest tube that is looked at from near
RING, SECTION = 24, 6  # corners around a ring, and around its section
GRID = 1e-5  # metres; rounding to it removes the last bits in which maths libraries differ


_FINE: ContextVar[bool] = ContextVar("fine", default=False)


@contextmanager
def fine_shapes() -> Iterator[None]:
    """Within the block boxes have chamfered edges and round things more sides, for near views."""
    token = _FINE.set(True)
    try:
        yield
    finally:
        _FINE.reset(token)


def is_fine() -> bool:
    """Whether shapes are being made for near views."""
    return _FINE.get()


def _sides(asked: int) -> int:
    """Sides of something round; what is meant to be square stays square."""
    return max(ROUND, 2 * asked) if _FINE.get() and asked > 4 else asked


def fuse(shapes: Iterable[MeshBatch]) -> MeshBatch:
    """Join shapes into one object with id 0."""
    joined = concatenate(shapes)
    return replace(
        joined,
        object_id=np.zeros(1, np.uint64),
        vertex_start=np.array([0, len(joined.vertices)], np.int64),
        face_start=np.array([0, len(joined.faces)], np.int64),
    )


def prototype(name: str, kind: str, shapes: Iterable[MeshBatch]) -> Prototype:
    """Make a prototype of shapes; vertices are rounded so that machines agree to the bit."""
    mesh = fuse(shapes)
    vertices = mesh.vertices  # joined, so that they are no one else's
    vertices /= GRID
    np.round(vertices, out=vertices)
    vertices *= GRID
    vertices += 0.0  # no negative zeros
    return Prototype(name, kind, mesh)


def moved(
    shape: MeshBatch, offset: Sequence[float] = (0.0, 0.0, 0.0), *, yaw: float = 0.0
) -> MeshBatch:
    """Turn a shape about the z axis by `yaw` (counter-clockwise), then shift it."""
    c, s = np.cos(yaw), np.sin(yaw)
    turn = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    return replace(shape, vertices=shape.vertices @ turn + np.asarray(offset, float))


def tinted(shape: MeshBatch, tint: ArrayLike) -> MeshBatch:
    """Multiply the tint of every face."""
    return replace(shape, tint=(shape.tint * np.asarray(tint, np.float32)).astype(np.float32))


def box(low: Sequence[float], high: Sequence[float], material: str, tint: Color = WHITE,
        *, bottom: bool = True) -> MeshBatch:  # fmt: skip
    """Make a box between two corners; texture coordinates are metres on each side."""
    if _FINE.get():
        return bevelled(low, high, material, tint, hidden=() if bottom else ("-z",))
    vertices = np.where(_CUBE == 1, np.asarray(high, float), np.asarray(low, float))
    uv = vertices[_BOX_FACES[:, :, None], _BOX_AXES[:, None, :]]
    keep = slice(None) if bottom else slice(0, 5)
    return one_mesh(0, vertices, _BOX_FACES[keep], materials=(material,), uv=uv[keep], tint=tint)


_CUBE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0],
                  [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]])  # fmt: skip
# Sides of a box, counter-clockwise from outside, with the axis and direction each looks along.
_BOX_SIDES = {"+z": (4, 5, 6, 7), "-y": (0, 1, 5, 4), "+x": (1, 2, 6, 5), "+y": (2, 3, 7, 6),
              "-x": (3, 0, 4, 7), "-z": (3, 2, 1, 0)}  # fmt: skip
_BOX_FACES = np.array(list(_BOX_SIDES.values()), np.int32)
_BOX_AXES = np.array([[0, 1], [0, 2], [1, 2], [0, 2], [1, 2], [0, 1]])  # of a side's texture


def bevelled(low: Sequence[float], high: Sequence[float], material: str, tint: ArrayLike = WHITE,
             *, bevel: float = BEVEL, hidden: Sequence[str] = ()) -> MeshBatch:  # fmt: skip
    """Make a box with chamfered edges.

    Parameters
    ----------
    low, high
        Two corners.
    material, tint
        As of `box`.
    bevel
        Metres; at most a fifth of the shortest side.
    hidden
        Sides such as "+y" that lie against something: no face and no chamfer there.
    """
    lo, hi = np.asarray(low, float), np.asarray(high, float)
    cut = min(bevel, 0.2 * float(np.abs(hi - lo).min()))
    corner, inward, faces, plane = _bevel_pattern(tuple(hidden))
    vertices = np.where(_CUBE[corner] == 1, hi, lo) + cut * inward
    at = vertices[np.where(faces == NO_VERTEX, 0, faces)]  # (f, 4, 3)
    uv = np.take_along_axis(at, plane[:, None, :].repeat(4, axis=1), axis=2)
    return one_mesh(0, vertices, faces, materials=(material,), uv=uv, tint=tint)


@lru_cache(maxsize=32)
def _bevel_pattern(
    hidden: tuple[str, ...],
) -> tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.int64], NDArray[np.int64]]:
    """Corner and drawing in of every vertex of a bevelled box, its faces and their plane."""
    axes = {"x": 0, "y": 1, "z": 2}
    bare = np.zeros((3, 2), bool)
    for word in hidden:
        bare[axes[word[1]], int(word[0] == "+")] = True
    corners: list[int] = []
    inward: list[list[int]] = []
    faces: list[list[int]] = []
    plane: list[tuple[int, int]] = []
    number: dict[tuple[int, int], int] = {}
    for word, ring in _BOX_SIDES.items():
        axis = axes[word[1]]
        if bare[axis, int(word[0] == "+")]:
            continue
        first, second = (a for a in range(3) if a != axis)
        for corner in ring:
            # A corner of a side is drawn in along both axes, unless what lies there is hidden.
            shift = [0, 0, 0]
            for other in (first, second):
                end = int(_CUBE[corner, other])
                shift[other] = 0 if bare[other, end] else 1 - 2 * end
            number[corner, axis] = len(corners)
            corners.append(corner)
            inward.append(shift)
        faces.append([number[corner, axis] for corner in ring])
        plane.append((first, second))
    points = 10.0 * _CUBE[corners] + np.array(inward)

    def facing_out(face: list[int]) -> list[int]:
        a, b, c = points[face[:3]]
        return face if np.dot(np.cross(b - a, c - a), a - 5.0) > 0 else face[::-1]

    for first, second, third in ((0, 1, 2), (0, 2, 1), (1, 2, 0)):
        for i, j in ((0, 0), (0, 1), (1, 0), (1, 1)):
            if not (bare[first, i] or bare[second, j]):
                edge = (_CUBE[:, first] == i) & (_CUBE[:, second] == j)
                a, b = sorted(np.flatnonzero(edge).tolist(), key=lambda k: int(_CUBE[k, third]))
                faces.append(facing_out([number[a, first], number[b, first],
                                         number[b, second], number[a, second]]))  # fmt: skip
                plane.append((third, second))
    for corner in range(8):
        if not any(bare[axis, _CUBE[corner, axis]] for axis in range(3)):
            faces.append([*facing_out([number[corner, axis] for axis in range(3)]), NO_VERTEX])
            plane.append((0, 1))
    return np.array(corners), np.array(inward, float), np.array(faces), np.array(plane)


def loft(rings: ArrayLike, material: str, tint: ArrayLike = WHITE,
         *, caps: tuple[bool, bool] = (True, True)) -> MeshBatch:  # fmt: skip
    """Skin rings of equal size, as for hulls and pipes.

    Parameters
    ----------
    rings
        (m, k, 3) float; each ring counter-clockwise seen from the last ring's end. Equal
        neighbouring corners (a ring that shrinks to a point) are allowed.
    material
        Name of the material.
    tint
        Linear RGB, one for all faces.
    caps
        Whether the first and last ring are closed by a fan about their centre.
    """
    ring = np.asarray(rings, float)
    m, k, _ = ring.shape
    vertices = ring.reshape(-1, 3)
    faces, ends = _skin(m, k, caps)
    # A ring that has shrunk to a point is one vertex, so that the solid stays closed.
    point = (ring.max(axis=1) - ring.min(axis=1)).max(axis=1) < GRID
    if point.any():
        same = np.where(point[:, None], np.arange(m)[:, None] * k, np.arange(m * k).reshape(m, k))
        faces = np.concatenate([same.ravel()[faces[: (m - 1) * k]], faces[(m - 1) * k :]])
    edge = _lengths(np.concatenate([ring[:, 1:], ring[:, :1]], axis=1) - ring)  # (m, k)
    around = np.zeros((m, k + 1))
    np.cumsum(edge, axis=1, out=around[:, 1:])
    middle = ring.mean(axis=1)
    along = np.zeros(m)
    np.cumsum(_lengths(middle[1:] - middle[:-1]), out=along[1:])
    uv = np.empty((len(faces), 4, 2))
    wall = uv[: (m - 1) * k].reshape(m - 1, k, 4, 2)
    wall[:, :, (0, 3), 0] = around[:-1, :-1, None]
    wall[:, :, (1, 2), 0] = around[:-1, 1:, None]
    wall[:, :, :2, 1] = along[:-1, None, None]
    wall[:, :, 2:, 1] = along[1:, None, None]
    fans = faces[(m - 1) * k :]
    if len(fans):
        vertices = np.concatenate([vertices, middle[ends]])
        uv[(m - 1) * k :] = vertices[np.where(fans == NO_VERTEX, fans[:, 2:3], fans)][:, :, :2]
    mesh = one_mesh(0, vertices, faces, materials=(material,), uv=uv, tint=tint)
    still = np.abs(ring[1:] - ring[:-1]).max(axis=2).min(initial=1.0) < GRID
    thin = still or point.any() or edge.min() < 3 * GRID
    return _without_slivers(mesh) if thin or _flat_fans(vertices, fans) else mesh


@lru_cache(maxsize=512)
def _skin(m: int, k: int, caps: tuple[bool, bool]) -> tuple[NDArray[np.int64], list[int]]:
    """Faces of a loft of m rings of k corners, fans about the centres behind, and their rings."""
    row, column = np.meshgrid(np.arange(m - 1), np.arange(k), indexing="ij")
    a = (row * k + column).ravel()
    b = (row * k + (column + 1) % k).ravel()
    parts = [np.column_stack([a, b, b + k, a + k])]
    ends = [end for end, wanted in ((0, caps[0]), (m - 1, caps[1])) if wanted]
    for number, end in enumerate(ends):
        i, j = end * k + np.arange(k), end * k + (np.arange(k) + 1) % k
        first, second = (j, i) if end == 0 else (i, j)
        centre = np.full(k, m * k + number)
        parts.append(np.column_stack([first, second, centre, np.full(k, NO_VERTEX)]))
    faces = np.concatenate(parts)
    faces.setflags(write=False)
    return faces, ends


def _lengths(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(np.sqrt((vectors * vectors).sum(axis=-1)))


def crossed(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    """Cross product of (..., 3) vectors; `numpy.cross` takes ten times as long for a few."""
    out = np.empty(np.broadcast_shapes(a.shape, b.shape))
    out[..., 0] = a[..., 1] * b[..., 2] - a[..., 2] * b[..., 1]
    out[..., 1] = a[..., 2] * b[..., 0] - a[..., 0] * b[..., 2]
    out[..., 2] = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    return out


def _flat_fans(vertices: NDArray[np.float64], fans: NDArray[np.int64]) -> bool:
    """Whether some triangle of the caps has no area."""
    a, b, c = (vertices[fans[:, corner]] for corner in range(3))
    return bool((_lengths(crossed(b - a, c - a)) <= 2 * GRID * GRID).any())


def _without_slivers(mesh: MeshBatch) -> MeshBatch:
    """Turn quads with two equal neighbouring corners into triangles, drop faces without area."""
    faces, uv = mesh.faces.copy(), mesh.uv.copy()
    for corner in range(4):
        after = (corner + 1) % 4
        quad = np.flatnonzero(faces[:, 3] != NO_VERTEX)
        gap = np.abs(mesh.vertices[faces[quad, corner]] - mesh.vertices[faces[quad, after]]).max(
            axis=1
        )
        rows = quad[gap < GRID]
        rest = [c for c in range(4) if c != after]
        faces[rows, :3], faces[rows, 3] = faces[rows][:, rest], NO_VERTEX
        uv[rows, :3] = uv[rows][:, rest]
    p = mesh.vertices[faces[:, :3]]
    area = _lengths(crossed(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]))
    keep = (area > GRID * GRID) | (faces[:, 3] != NO_VERTEX)
    used = np.zeros(len(mesh.vertices), bool)
    used[faces[keep][faces[keep] != NO_VERTEX]] = True
    table = np.where(used, np.cumsum(used) - 1, NO_VERTEX)
    faces = np.where(faces == NO_VERTEX, NO_VERTEX, table[faces])[keep]
    return one_mesh(0, mesh.vertices[used], faces, materials=mesh.materials, uv=uv[keep],
                    tint=mesh.tint[keep])  # fmt: skip


def tube(path: ArrayLike, radii: ArrayLike, material: str, tint: ArrayLike = WHITE,
         *, sides: int = 8, caps: tuple[bool, bool] = (True, True)) -> MeshBatch:  # fmt: skip
    """Sweep a circle of changing radius along a polyline, (m, 3) float and (m,) float."""
    sides = _sides(sides)
    points = np.asarray(path, float)
    radius = np.broadcast_to(np.asarray(radii, float), (len(points),))
    ahead = np.gradient(points, axis=0)
    ahead /= np.maximum(np.linalg.norm(ahead, axis=1, keepdims=True), GRID)
    # A fixed reference keeps the rings from twisting on paths that turn little.
    mean = points[-1] - points[0]
    reference = np.eye(3)[int(np.argmin(np.abs(mean)))]
    side = crossed(reference, ahead)
    side /= np.maximum(np.linalg.norm(side, axis=1, keepdims=True), GRID)
    up = crossed(ahead, side)
    cosine, sine = _circle(sides)
    spokes = cosine[:, None] * side[:, None, :] + sine[:, None] * up[:, None, :]
    return loft(points[:, None, :] + radius[:, None, None] * spokes, material, tint, caps=caps)


@lru_cache(maxsize=64)
def _circle(sides: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    angle = np.arange(sides) * (2 * np.pi / sides)
    return np.cos(angle), np.sin(angle)


def cylinder(low: Sequence[float], high: Sequence[float], radius: float, material: str,
             tint: Color = WHITE, *, top: float | None = None, sides: int = 8,
             caps: tuple[bool, bool] = (True, True)) -> MeshBatch:  # fmt: skip
    """Make a cylinder, or a cone frustum when `top` gives another radius at its far end."""
    ends = [radius, radius if top is None else top]
    return tube([low, high], ends, material, tint, sides=sides, caps=caps)


def ring(radius: float, thickness: float, material: str) -> MeshBatch:
    """Make a ring about the x axis, such as a tyre; `thickness` is half that of its section."""
    turn = np.linspace(0.0, 2 * np.pi, RING, endpoint=False)
    round_ = np.linspace(0.0, 2 * np.pi, SECTION, endpoint=False)
    away = radius + thickness * np.cos(round_)  # (SECTION,)
    across = np.broadcast_to(thickness * np.sin(round_), (RING, SECTION))
    points = np.stack([across, np.cos(turn)[:, None] * away, np.sin(turn)[:, None] * away], axis=-1)
    number = np.arange(RING * SECTION).reshape(RING, SECTION)
    ahead, beside = np.roll(number, -1, axis=0), np.roll(number, -1, axis=1)
    both = np.roll(ahead, -1, axis=1)
    faces = np.stack([number, ahead, both, beside], axis=-1).reshape(-1, 4)
    uv = np.tile([[0.0, 0.0], [0.1, 0.0], [0.1, 0.1], [0.0, 0.1]], (len(faces), 1, 1))
    return one_mesh(0, points.reshape(-1, 3), faces, materials=(material,), uv=uv)


def lathe(profile: ArrayLike, material: str, tint: Color = WHITE, *, sides: int = 10,
          center: Sequence[float] = (0.0, 0.0)) -> MeshBatch:  # fmt: skip
    """Turn a profile, (m, 2) float of radius and z from below to above, about the z axis."""
    sides = _sides(sides)
    line = np.asarray(profile, float)
    cosine, sine = _circle(sides)
    x = center[0] + line[:, :1] * cosine
    y = center[1] + line[:, :1] * sine
    z = np.broadcast_to(line[:, 1:], x.shape)
    caps = (bool(line[0, 0] > GRID), bool(line[-1, 0] > GRID))
    return loft(np.stack([x, y, z], axis=-1), material, tint, caps=caps)


def prism(outline: ArrayLike, y_low: float, y_high: float, material: str,
          tint: Color = WHITE) -> MeshBatch:  # fmt: skip
    """Extrude a star-shaped outline, (k, 2) float of x and z counter-clockwise, along y.

    Counter-clockwise is as seen from the front, where x points right and z up.
    """
    ring = np.asarray(outline, float)[::-1]
    rings = [np.column_stack([ring[:, 0], np.full(len(ring), y), ring[:, 1]])
             for y in (y_low, y_high)]  # fmt: skip
    return loft(np.stack(rings), material, tint)


def disc(center: Sequence[float], radius: float, material: str, tint: Color = WHITE,
         *, sides: int = 12, thickness: float = 0.02) -> MeshBatch:  # fmt: skip
    """Make an upright round plate that faces -y; `thickness` reaches back from the centre."""
    sides = sides if sides == 8 else _sides(sides)  # an octagon is a sign
    angle = np.arange(sides) * (2 * np.pi / sides) + np.pi / sides
    outline = np.column_stack([center[0] + radius * np.cos(angle),
                               center[2] + radius * np.sin(angle)])  # fmt: skip
    return prism(outline, center[1], center[1] + thickness, material, tint)


def cards(centres: NDArray[np.float64], along: NDArray[np.float64], across: NDArray[np.float64],
          material: str, tint: ArrayLike, *, fold: float = 0.25) -> MeshBatch:  # fmt: skip
    """Make leaf cards: kites folded along their long axis, a quad of two triangles each.

    Parameters
    ----------
    centres
        (n, 3) float, middles of the cards.
    along, across
        (n, 3) float, half diagonals from the middle to the tip and to the side.
    material
        Name of the material.
    tint
        (n, 3) float, linear RGB per card.
    fold
        How far the sides bend away from the plane, as a share of ``across``.
    """
    sink = np.zeros(3)
    if fold:
        normal = crossed(along, across)
        normal /= np.maximum(lengths(normal), GRID)
        sink = normal * (fold * lengths(across))
    waist = centres - 0.15 * along  # widest nearer to the stalk
    count = len(centres)
    corners = np.empty((count, 4, 3))
    np.subtract(centres, along, out=corners[:, 0])
    np.subtract(waist + across, sink, out=corners[:, 1])
    np.add(centres, along, out=corners[:, 2])
    np.subtract(waist - across, sink, out=corners[:, 3])
    # The diagonal of a quad, which runs from its first corner to its third, is the fold.
    faces = np.arange(4 * count).reshape(-1, 4)
    return one_mesh(0, corners.reshape(-1, 3), faces, materials=(material,), tint=tint)


def lengths(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Lengths of (..., 3) vectors, (..., 1); for many, five times as fast as NumPy's norm."""
    x, y, z = vectors[..., 0], vectors[..., 1], vectors[..., 2]
    return np.asarray(np.sqrt(x * x + y * y + z * z)[..., None])


def leaf_blades(centres: NDArray[np.float64], along: NDArray[np.float64],
                across: NDArray[np.float64], material: str, tint: ArrayLike, *,
                lobed: bool = False, fold: float = 0.25) -> MeshBatch:  # fmt: skip
    """Make leaves of two quads that meet in the midrib, the tip bent down.

    Arguments are those of `cards`; ``lobed`` leaves have a lobe on each side, as of maples.
    """
    normal = crossed(along, across)
    normal /= np.maximum(lengths(normal), GRID)
    broad = lengths(across)
    # Share along, share across, share of the breadth by which it sinks: of the base and the tip,
    # then of the two corners of a side.
    ends = ((-1.0, 0.0, 0.0), (1.0, 0.0, 0.35))
    side = (
        ((0.12, 1.12, 1.2), (0.28, 0.42, 0.6)) if lobed else ((-0.5, 0.82, 0.7), (0.25, 0.88, 1.0))
    )
    places = (*ends, *side, *((a, -b, c) for a, b, c in side))
    count = len(centres)
    corners = np.empty((count, len(places), 3))
    for k, (a, b, c) in enumerate(places):
        place = a * along
        place += centres
        place += b * across
        np.subtract(place, (c * fold) * broad * normal, out=corners[:, k])
    base = 6 * np.arange(count)[:, None]
    # The diagonal of a quad runs from its first corner to its third.
    faces = np.vstack([base + np.array([0, 2, 3, 1]), base + np.array([5, 4, 0, 1])])
    colors = np.broadcast_to(np.asarray(tint, float), (count, 3))
    return one_mesh(
        0, corners.reshape(-1, 3), faces, materials=(material,), tint=np.tile(colors, (2, 1))
    )
