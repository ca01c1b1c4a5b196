"""Sweeps: profiles run along walls and mitred round their corners, as closed bodies."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.polygons import Rings, triangulate
from cityx.geometry.ranges import row_codes
from cityx.geometry.solids import NO_VERTEX, TRIM, Solids, as_quads, no_solids

SHARPEST = np.radians(125.0)  # turn above which a mitre would be a spike; both pieces end square
LEAST_RUN = 0.02  # metres of every line of a profile that remain between two mitres
JOINT = 1e-3  # metres; ends this near meet
LEVEL = 0.02  # metres by which pieces that meet may differ in height


@dataclass(frozen=True)
class Profile:
    """A closed outline that is swept, k points.

    Attributes
    ----------
    points
        (k, 2) float, metres outward from the wall and up, counter-clockwise as seen by one who
        looks along the wall with its outside on the right.
    triangles
        (k - 2, 3) int64 that fill it.
    """

    points: FloatArray
    triangles: IntArray


def profile_of(points: ArrayLike) -> Profile:
    """Make a profile of (k, 2) points outward and up, in either direction."""
    outline = np.asarray(points, float)
    ahead = np.roll(outline, -1, axis=0)
    if (outline[:, 0] * ahead[:, 1] - outline[:, 1] * ahead[:, 0]).sum() < 0:
        outline = outline[::-1].copy()
    size = len(outline)
    rings = Rings(outline, np.array([0, size]), np.zeros(1, np.int64), np.zeros(1, bool))
    shape = np.array([shapely.Polygon(outline)], dtype=object)
    return Profile(outline, triangulate(shape, rings).triangles)


@dataclass(frozen=True)
class Joints:
    """Where s pieces meet the pieces that follow them.

    Attributes
    ----------
    following
        (s,) the piece that begins where each ends, or -1.
    mitre
        (s, 2) by how much a point one metre out moves at the end of a piece.
    """

    following: IntArray
    mitre: FloatArray


def joints_of(
    start: FloatArray, end: FloatArray, z: FloatArray, group: IntArray, reach: tuple[float, float]
) -> Joints:
    """Find the mitres between pieces of walls.

    Parameters
    ----------
    start, end
        (s, 2) ends of the pieces; the outside lies on the right hand.
    z
        (s,) height.
    group
        (s,) pieces of different groups do not meet.
    reach
        Least and greatest distance of the profile from the wall, metres.
    """
    count = len(start)
    vector = end - start
    length = np.maximum(np.hypot(*vector.T), 1e-9)
    normal = np.column_stack([vector[:, 1], -vector[:, 0]]) / length[:, None]
    following = following_pieces(start, end, z, group)
    other = np.maximum(following, 0)
    cosine = (normal * normal[other]).sum(axis=1)
    turn = np.arctan2(normal[:, 0] * normal[other, 1] - normal[:, 1] * normal[other, 0], cosine)
    joined = (following >= 0) & (np.abs(turn) <= SHARPEST)
    tangent = np.where(joined, np.tan(np.clip(turn, -SHARPEST, SHARPEST) / 2), 0.0)
    # An outer corner lengthens what lies outside the wall, an inner one shortens it.
    for _ in range(3):
        ends = np.where(joined, tangent, 0.0)
        begins = np.zeros(count)
        begins[following[joined]] = ends[joined]
        run = np.minimum.reduce([length + far * (ends + begins) for far in reach])
        crowded = run < LEAST_RUN
        if not crowded.any():
            break
        joined &= ~crowded & ~crowded[other]
    mitre = (normal + normal[other]) / np.maximum(1.0 + cosine, 1e-3)[:, None]
    return Joints(np.where(joined, following, -1), np.where(joined[:, None], mitre, normal))


def following_pieces(
    start: FloatArray, end: FloatArray, z: FloatArray, group: IntArray
) -> IntArray:
    """Find the one piece of the same group and height that begins where each ends, (s,) or -1."""
    count = len(start)
    if count == 0:
        return np.zeros(0, np.int64)
    place = np.rint(np.concatenate([start, end]) / JOINT).astype(np.int64)
    level = np.rint(np.tile(z, 2) / LEVEL).astype(np.int64)
    keys = np.column_stack([np.tile(group, 2), level, place])
    code = row_codes(keys)
    begin, finish = code[:count], code[count:]
    number = np.bincount(begin, minlength=code.max() + 1)
    arriving = np.bincount(finish, minlength=code.max() + 1)
    first = np.full(code.max() + 1, -1)
    first[begin] = np.arange(count)
    clear = (number[finish] == 1) & (arriving[finish] == 1)
    found = np.where(clear, first[finish], -1)
    return np.asarray(np.where(found == np.arange(count), -1, found))


def sweep(
    profile: Profile, start: ArrayLike, end: ArrayLike, z: ArrayLike, part: ArrayLike
) -> Solids:
    """Run a profile along pieces of walls.

    Pieces that meet share a mitre and one body; ends that meet nothing are capped square. So are
    corners sharper than `SHARPEST` and those between pieces too short for their mitres, where two
    bodies overlap.

    Parameters
    ----------
    profile
        k points.
    start, end
        (s, 2) pieces; the outside lies on the right hand.
    z
        (s,) height of the zero of the profile.
    part
        (s,) row of the part; pieces of different parts do not meet.
    """
    start, end = np.asarray(start, float).reshape(-1, 2), np.asarray(end, float).reshape(-1, 2)
    z, part = np.asarray(z, float), np.asarray(part, np.int64)
    count, k = len(start), len(profile.points)
    if count == 0:
        return no_solids()
    out = profile.points[:, 0]
    joints = joints_of(start, end, z, part, (float(out.min()), float(out.max())))
    vector = end - start
    normal = np.column_stack([vector[:, 1], -vector[:, 0]])
    normal /= np.maximum(np.hypot(*vector.T), 1e-9)[:, None]
    # One ring of points at the end of every piece, and one where a piece begins afresh.
    met = np.full(count, -1)
    on = np.flatnonzero(joints.following >= 0)
    met[joints.following[on]] = on
    fresh = np.flatnonzero(met < 0)
    ring_start = np.where(met >= 0, met, 0)
    ring_start[fresh] = count + np.arange(len(fresh))
    place = np.concatenate([end, start[fresh]])
    move = np.concatenate([joints.mitre, normal[fresh]])
    level = np.concatenate([z, z[fresh]])
    points = np.empty((len(place), k, 3))
    points[:, :, :2] = place[:, None] + move[:, None] * out[:, None]
    points[:, :, 2] = level[:, None] + profile.points[:, 1]
    first = ring_start[:, None] * k + np.arange(k)
    last = np.arange(count)[:, None] * k + np.arange(k)
    turned = np.roll(np.arange(k), -1)
    sides = np.stack([first, last, last[:, turned], first[:, turned]], axis=-1).reshape(-1, 4)
    open_end = np.flatnonzero(joints.following < 0)
    caps = profile.triangles
    begins = first[fresh][:, caps].reshape(-1, 3)
    ends = last[open_end][:, caps[:, ::-1]].reshape(-1, 3)
    faces = np.concatenate([sides, as_quads(begins), as_quads(ends)])
    piece = np.concatenate(
        [np.repeat(np.arange(count), k), np.repeat(np.append(fresh, open_end), len(caps))]
    )
    vertices = points.reshape(-1, 3)
    uv = _texture(vertices, faces, profile, vector, count, piece)
    return Solids(
        vertices,
        np.repeat(np.concatenate([part, part[fresh]]), k),
        faces,
        part[piece],
        np.full(len(faces), TRIM, np.int8),
        uv,
    )


def _texture(
    vertices: FloatArray, faces: IntArray, profile: Profile, vector: FloatArray, count: int,
    piece: IntArray,
) -> NDArray[np.float32]:  # fmt: skip
    """Run u along the wall and v round the profile; caps lie in the plane of the profile."""
    k = len(profile.points)
    corner = np.where(faces == NO_VERTEX, faces[:, :1], faces)
    unit = vector / np.maximum(np.hypot(*vector.T), 1e-9)[:, None]
    sides = count * k
    uv = np.zeros((*faces.shape, 2))
    uv[:sides, :, 0] = (vertices[corner[:sides], :2] * unit[piece[:sides], None]).sum(axis=2)
    step = np.hypot(*(np.roll(profile.points, -1, axis=0) - profile.points).T)
    run = np.concatenate([[0.0], np.cumsum(step)])
    v = np.stack([run[:-1], run[:-1], run[1:], run[1:]], axis=1)  # (k, 4)
    uv[:sides, :, 1] = np.tile(v, (count, 1))
    uv[sides:] = profile.points[corner[sides:] % k]
    uv[faces == NO_VERTEX] = 0.0
    # Kept small, so that single precision serves.
    uv[:sides, :, 0] -= np.floor(uv[:sides, :1, 0] / 60.0) * 60.0
    return uv.astype(np.float32)
