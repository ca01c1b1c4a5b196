"""Roofs made of shrunken outlines: domes, spires, onions, mansards, parapets."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.building.roofs.roof_meshes import RoofMesh, raised
from cityx.geometry.arrays import FloatArray
from cityx.geometry.extrude import Plan, plan_of, roofed
from cityx.geometry.polygons import Rings, offset_points, polygons_of, rings_of, select_rings
from cityx.geometry.solids import ROOF, TRIM, WALL, Solids, as_quads, no_solids

_QUARTER = np.linspace(0.0, np.pi / 2, 9)[1:-1]
# (radius, height) of the rings between the eave (1, 0) and the apex (0, 1).
LOFTS: Mapping[str, tuple[tuple[float, float], ...]] = MappingProxyType(
    {
        "pyramidal": (),
        "dome": tuple((float(np.cos(a)), float(np.sin(a))) for a in _QUARTER),
        "onion": ((0.92, 0.08), (1.02, 0.2), (1.06, 0.3), (1.0, 0.42), (0.82, 0.55),
                  (0.55, 0.68), (0.3, 0.8), (0.12, 0.9)),
    }
)  # fmt: skip
# The same curve over the distance from the eave: (share of the way to the ridge, height).
DOME = np.array([(0.0, 0.0), *((1 - float(np.cos(a)), float(np.sin(a))) for a in _QUARTER), (1, 1)])
MAX_STAR = 60  # points of an outline for which a centre that sees all edges is looked for
SEEN = 0.2  # metres such a centre keeps from the line of every edge
STAR_SHARE = 1e-3  # square metres; the least triangle between the centre and an edge


def loft_roofs(
    polygons: NDArray[Any],
    kind: str,
    low: FloatArray,
    eave: FloatArray,
    rise: FloatArray,
    zero: FloatArray,
) -> tuple[Solids, RoofMesh | None]:
    """Raise outlines under a roof that shrinks toward the centre; pyramids also as a mesh.

    An outline with a courtyard, or one whose centre does not see all of its edges, has no such
    roof and is left out.

    Parameters
    ----------
    polygons
        (n,) valid polygons; empty ones are passed over.
    kind
        Key of `LOFTS`.
    low, eave, rise, zero
        (n,) foot, eave, height of the roof above it, zero of the wall texture; metres.
    """
    polygons = np.asarray(polygons, dtype=object)
    count = len(polygons)
    rings = rings_of(polygons)
    centre = np.nan_to_num(shapely.get_coordinates(shapely.centroid(polygons)))
    full = np.zeros((count, 2))
    full[~shapely.is_empty(polygons)] = centre
    part = rings.polygon[rings.ring_of_point]
    spoke = rings.points - full[part]
    sees = np.cross(spoke, spoke[rings.following()]) / 2
    blind = np.bincount(part, sees < STAR_SHARE, minlength=count) > 0
    single = np.bincount(rings.polygon, minlength=count) == 1
    for row in np.flatnonzero(blind & single & (np.bincount(part, minlength=count) <= MAX_STAR)):
        seeing = _seeing_point(rings.points[part == row])
        if seeing is not None:
            full[row], blind[row] = seeing, False
    chosen = ~blind & single
    outlines = np.where(chosen, polygons, shapely.Polygon())
    plan = plan_of(outlines)
    rings = plan.rings
    if len(rings.polygon) == 0:
        return no_solids(), None
    part = plan.part_of_point
    spoke = rings.points - full[part]
    size = len(rings.points)
    levels = LOFTS[kind]
    steps = [
        np.column_stack([full[part] + spoke * radius, eave[part] + rise[part] * height])
        for radius, height in levels
    ]
    rows = rings.polygon
    apex = np.column_stack([full[rows], (eave + rise)[rows]])
    after = rings.following()
    index = np.arange(size)
    faces = [
        np.column_stack([index, after, after + size, index + size]) + level * size
        for level in range(len(levels))
    ]
    last = len(levels) * size
    tip = (len(levels) + 1) * size + rings.ring_of_point
    faces.append(as_quads(np.column_stack([index + last, after + last, tip])))
    if not levels:
        mesh = RoofMesh(
            rings,
            eave[part],
            np.ones(size, bool),
            apex,
            rows,
            faces[0][:, :3],
            part,
            np.full(size, ROOF, np.int8),
            count,
            (plan.triangles, plan.owner),
        )
        return raised(mesh, low, zero), mesh
    solids = roofed(
        plan,
        low,
        eave[part],
        zero,
        np.concatenate(faces),
        np.tile(part, len(faces)),
        extra=np.concatenate([*steps, apex]),
        extra_part=np.concatenate([*([part] * len(steps)), rows]),
    )
    return solids, None


def _seeing_point(ring: FloatArray) -> FloatArray | None:
    """Return a point that sees every edge of a counter-clockwise ring, or None."""
    kernel = shapely.Polygon(ring)
    reach = 4.0 * float(np.ptp(ring, axis=0).sum())
    for a, b in zip(ring, np.roll(ring, -1, axis=0), strict=True):
        length = float(np.hypot(*(b - a)))
        if length < 1e-9:
            continue
        along = (b - a) / length
        left = np.array([-along[1], along[0]])
        corner = a + left * SEEN
        sides = [corner - along * reach, corner + along * reach]
        half = shapely.Polygon([*sides, sides[1] + left * reach, sides[0] + left * reach])
        kernel = kernel.intersection(half)
        if kernel.is_empty or kernel.area < STAR_SHARE:
            return None
    return np.asarray(shapely.get_coordinates(kernel.centroid)[0])


def inset(polygons: NDArray[Any], distance: FloatArray) -> tuple[Plan, Plan]:
    """Draw outlines in by a distance, corner for corner.

    Parameters
    ----------
    polygons
        (n,) valid polygons.
    distance
        (n,) metres.

    Returns
    -------
    outer, inner
        The outlines whose inset is an outline of the same rings inside them, and those insets,
        point for point; the other outlines are empty in both.
    """
    polygons = np.asarray(polygons, dtype=object)
    count = len(polygons)
    rings = rings_of(polygons)
    part = rings.polygon[rings.ring_of_point]
    points, sound_ring = offset_points(rings, -distance[part])
    sound = ~shapely.is_empty(polygons)
    sound[rings.polygon[~sound_ring]] = False
    moved = Rings(points, rings.start, rings.polygon, rings.hole)
    moved, _ = select_rings(moved, sound)
    shapes = polygons_of(moved, count)
    sound &= shapely.is_valid(shapes) & (shapely.area(shapes) > 0)
    inside = np.flatnonzero(sound)
    sound[inside] = shapely.contains_properly(polygons[inside], shapes[inside])
    outer = plan_of(np.where(sound, polygons, shapely.Polygon()))
    inner = plan_of(np.where(sound, shapes, shapely.Polygon()))
    return outer, inner


def _deck(
    outer: Plan,
    inner: Plan,
    low: FloatArray,
    head: FloatArray,
    rim: FloatArray,
    deck: FloatArray | None,
    zero: FloatArray,
    rim_role: int,
) -> Solids:
    """Walls up to `head`, a rim to the inset at `rim`, and a deck in it at `deck` or at `rim`."""
    rings = outer.rings
    part = outer.part_of_point
    size = len(rings.points)
    after = rings.following()
    index = np.arange(size)
    upper = np.column_stack([inner.rings.points, rim[part]])
    band = np.column_stack([index, after, after + size, index + size])
    if deck is None:
        faces = np.concatenate([band, as_quads(inner.triangles + size)])
        roof_part = np.concatenate([part, inner.owner])
        role = np.repeat(np.array([rim_role, ROOF], np.int8), [size, len(inner.triangles)])
        extra, extra_part = upper, part
    else:
        lower = np.column_stack([inner.rings.points, deck[part]])
        back = np.column_stack([index + size, after + size, after + 2 * size, index + 2 * size])
        faces = np.concatenate([band, back, as_quads(inner.triangles + 2 * size)])
        roof_part = np.concatenate([part, part, inner.owner])
        role = np.repeat(
            np.array([rim_role, WALL, ROOF], np.int8), [size, size, len(inner.triangles)]
        )
        extra, extra_part = np.concatenate([upper, lower]), np.concatenate([part, part])
    return roofed(
        outer,
        low,
        head[part],
        zero,
        faces,
        roof_part,
        extra=extra,
        extra_part=extra_part,
        role=role,
    )


def parapet_roofs(
    polygons: NDArray[Any],
    thickness: FloatArray,
    height: FloatArray,
    low: FloatArray,
    top: FloatArray,
    zero: FloatArray,
) -> Solids:
    """Raise outlines to level roofs behind a parapet; those too narrow for one are left out.

    Parameters
    ----------
    polygons
        (n,) valid polygons; empty ones are passed over.
    thickness, height
        (n,) of the parapet, metres; the deck lies `height` below the top.
    low, top, zero
        (n,) foot, head of the parapet, zero of the wall texture.
    """
    outer, inner = inset(polygons, thickness)
    return _deck(outer, inner, low, top, top, top - height, zero, TRIM)


def rimmed_roofs(
    polygons: NDArray[Any],
    run: FloatArray,
    low: FloatArray,
    eave: FloatArray,
    rise: FloatArray,
    zero: FloatArray,
) -> Solids:
    """Raise outlines under a level roof with a sloping rim (mansard); narrow ones are left out.

    Parameters
    ----------
    polygons
        (n,) valid polygons; empty ones are passed over.
    run
        (n,) metres in plan over which the rim rises.
    low, eave, rise, zero
        (n,) metres, as of `loft_roofs`.
    """
    outer, inner = inset(polygons, run)
    return _deck(outer, inner, low, eave, eave + rise, None, zero, ROOF)
