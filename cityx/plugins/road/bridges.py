"""Bridges: which ways are carried by a deck, how high it lies, and its solid."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.ground import KERB_HEIGHT
from cityx.city.layout import Layout
from cityx.city.mesh import MeshBatch, empty_batch
from cityx.city.terrain import Terrain
from cityx.geometry.chains import components, interpolate, walking_distance
from cityx.geometry.polylines import Polylines, arc_lengths, miters, pack, to_linestrings

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

RAILS = ("rail", "light_rail", "subway", "tram", "narrow_gauge", "monorail")
WATER = ("water", "sea", "river", "pool", "wetland")
ON_FOOT = ("footway", "path", "cycleway", "steps", "pedestrian", "bridleway", "corridor")
STOREY = 5.5  # metres from one level of traffic to the next
OVER_WATER = 0.6  # metres above the bank that a deck over water rises, if it can
ROAD_GRADE = 0.08  # the steepest a main road climbs
RAIL_GRADE = 0.025
FOOT_GRADE = 0.12
EASE = 1.0  # metres of climb over which a ramp bends up from the ground
STATION = 5.0  # metres between the cross-sections of a deck
LIFT = 0.02  # metres a deck lies above the ground it comes from, so that it never flickers
THICKNESS = 0.8  # metres of slab
PARAPET = 1.0  # metres above the deck
PARAPET_WIDTH = 0.25  # metres
LOW = 1.0  # metres; below it the ground under a deck is paved
MATERIALS = ("concrete", "asphalt", "rail_ballast", "paving")


@dataclass(frozen=True)
class Decks:
    """Ways on decks, n of them, as polylines with heights.

    Attributes
    ----------
    rows
        (n,) rows of ``Layout.roads``.
    lines
        Their centrelines, with a point every few metres.
    z
        (p,) height of the deck at each point, metres.
    climb
        (p,) the same above the terrain.
    half_width
        (n,) half the clear width, metres.
    """

    rows: IntArray
    lines: Polylines
    z: FloatArray
    climb: FloatArray
    half_width: FloatArray


def deck_rows(layout: Layout) -> NDArray[np.bool_]:
    """Tell for every road whether it runs on a deck.

    A chain of connected bridges gets decks if it passes over something: a way of a lower level or
    water. Otherwise there is nothing to span and it stays part of the ground.
    """
    roads = layout.roads
    lines = roads.geometry.to_numpy()
    level = _levels(layout)
    raised = np.flatnonzero((level > 0) & ~roads["tunnel"].to_numpy())
    found = np.zeros(len(roads), bool)
    if not len(raised):
        return found
    own, other = shapely.STRtree(lines).query(lines[raised], predicate="crosses")
    # What crosses in a tunnel runs below the ground and needs no bridge.
    over = (level[other] < level[raised[own]]) & ~roads["tunnel"].to_numpy()[other]
    spans = np.zeros(len(raised), bool)
    spans[own[over]] = True
    wet = layout.areas["kind"].isin(WATER).to_numpy()
    if wet.any():
        water = shapely.STRtree(layout.areas.geometry.to_numpy()[wet])
        spans[water.query(lines[raised], predicate="intersects")[0]] = True
    chain = _chains(lines[raised])
    whole = np.zeros(int(chain.max()) + 1, bool)
    whole[chain[spans]] = True
    found[raised[whole[chain]]] = True
    return found


def _levels(layout: Layout) -> IntArray:
    layer = layout.roads["layer"].to_numpy().astype(np.int64)
    return np.where(layout.roads["bridge"].to_numpy(), np.maximum(layer, 1), layer)


def _end_keys(lines: NDArray[Any]) -> IntArray:
    """(2n,) number of the place where each line starts, then where each ends."""
    packed = pack(lines)
    ends = np.concatenate([packed.points[packed.start[:-1]], packed.points[packed.start[1:] - 1]])
    return np.asarray(np.unique(np.rint(ends * 1000), axis=0, return_inverse=True)[1].ravel())


def _chains(lines: NDArray[Any]) -> IntArray:
    """(n,) connected component of lines that share an end."""
    ends = _end_keys(lines).reshape(2, -1).T
    return np.asarray(components(ends, int(ends.max()) + 1)[ends[:, 0]])


def plan_decks(layout: Layout, terrain: Terrain, rows: NDArray[np.bool_]) -> Decks | None:
    """Set the heights of all decks; None when there is none.

    A deck spans evenly from one place where it leaves the ground to the next. It rises towards
    what it crosses as far as the grade from the nearest such place allows, and no further.
    """
    chosen = np.flatnonzero(rows)
    geometry = shapely.intersection(layout.roads.geometry.to_numpy()[chosen],
                                    shapely.box(*layout.extent))  # fmt: skip
    geometry, part = shapely.get_parts(geometry, return_index=True)
    solid = (shapely.get_type_id(geometry) == 1) & (shapely.length(geometry) > 0.5)
    geometry, chosen = shapely.segmentize(geometry[solid], STATION), chosen[part[solid]]
    if not len(chosen):
        return None
    lines = pack(geometry)
    table = layout.roads.iloc[chosen]
    kind = table["kind"].to_numpy().astype(str)
    grade = np.select(
        [np.isin(kind, RAILS), np.isin(kind, ON_FOOT)], [RAIL_GRADE, FOOT_GRADE], ROAD_GRADE
    )
    walk = table["sidewalk_left"].to_numpy() + table["sidewalk_right"].to_numpy()
    half = (np.maximum(table["width"].to_numpy(), 2.0) + walk) / 2
    half = np.where(np.isin(kind, RAILS), 2.25, half)
    z = _profile(layout, terrain, rows, chosen, lines, grade)
    z += np.where(np.isin(kind, ON_FOOT), KERB_HEIGHT, 0.0)[lines.line_of_point()] + LIFT
    climb = z - terrain.height_at(lines.points)
    return Decks(chosen, lines, np.round(z, 4), np.round(climb, 4), half)


def _profile(
    layout: Layout,
    terrain: Terrain,
    rows: NDArray[np.bool_],
    chosen: IntArray,
    lines: Polylines,
    grade: FloatArray,
) -> FloatArray:
    keys = np.rint(lines.points * 1000).astype(np.int64)
    places, place = np.unique(keys, axis=0, return_inverse=True)
    place = place.ravel()
    owner = lines.line_of_point()
    first = np.flatnonzero(owner[1:] == owner[:-1])
    a, b = place[first], place[first + 1]
    rise = np.hypot(*(lines.points[first + 1] - lines.points[first]).T) * grade[owner[first]]
    size = len(places)
    pairs = np.column_stack([a, b])
    degree = np.bincount(np.concatenate([a, b]), minlength=size)
    grounded = _grounded(layout, rows, places / 1000, degree)
    soil = terrain.height_at(places / 1000)
    span = soil
    if not terrain.is_flat:
        chain = components(pairs, size)
        held = np.bincount(chain, grounded, minlength=size) > 0
        span = interpolate(pairs, np.maximum(rise, 1e-3), grounded | ~held[chain], soil)
    ramp = walking_distance(pairs, rise, np.flatnonzero(grounded), size)
    room = np.hypot(ramp, EASE) - EASE
    wanted = np.zeros(size)
    for height, spots in _obstacles(layout, chosen, lines):
        near = np.unique(place[spots])
        far = walking_distance(pairs, rise, near, size)
        wanted = np.maximum(wanted, height - np.maximum(far - 0.5, 0.0))
    z = span + np.clip(soil + wanted - span, 0.0, room)
    return np.asarray(np.maximum(z, soil)[place])


def _grounded(
    layout: Layout, rows: NDArray[np.bool_], places: FloatArray, degree: IntArray
) -> NDArray[np.bool_]:
    """Places where a deck meets a way on the ground, or ends."""
    inner = np.minimum(places - layout.extent[:2], layout.extent[2:] - places).min(axis=1) > 1.0
    grounded = (degree == 1) & inner
    others = layout.roads.geometry.to_numpy()[~rows & ~layout.roads["tunnel"].to_numpy()]
    if len(others):
        ends = pack(others)
        corners = np.concatenate([ends.points[ends.start[:-1]], ends.points[ends.start[1:] - 1]])
        near = shapely.STRtree(shapely.points(corners)).query(
            shapely.points(places), predicate="dwithin", distance=0.01
        )[0]
        grounded[near] = True
    return np.asarray(grounded)


def _obstacles(layout: Layout, chosen: IntArray, lines: Polylines) -> list[tuple[float, IntArray]]:
    """Heights a deck wants, and the points of decks that want them."""
    level = _levels(layout)
    shapes = to_linestrings(lines)
    roads = layout.roads.geometry.to_numpy()
    own, other = shapely.STRtree(roads).query(shapes, predicate="crosses")
    over = (level[other] < level[chosen[own]]) & ~layout.roads["tunnel"].to_numpy()[other]
    own, other = own[over], other[over]
    spots = shapely.intersection(shapes[own], roads[other])
    points, row = shapely.get_coordinates(spots, return_index=True)
    tree = shapely.STRtree(shapely.points(lines.points))
    height = np.maximum(level[chosen[own[row]]], 1) * STOREY
    nearest = tree.query_nearest(shapely.points(points), all_matches=False)
    found = [(float(value), nearest[1][height[nearest[0]] == value]) for value in np.unique(height)]
    wet = layout.areas["kind"].isin(WATER).to_numpy()
    if wet.any():
        water = layout.areas.geometry.to_numpy()[wet]
        found.append((OVER_WATER, np.unique(tree.query(water, predicate="intersects")[1])))
    return found


def deck_mesh(layout: Layout, decks: Decks | None) -> MeshBatch:
    """Sweep a slab with parapets along every deck: one closed solid each."""
    if decks is None:
        return empty_batch()
    lines, owner = decks.lines, decks.lines.line_of_point()
    z = decks.z
    w = decks.half_width[owner]
    outer = w + PARAPET_WIDTH
    low, top = np.full(len(w), -THICKNESS), np.full(len(w), PARAPET)
    zero = np.zeros(len(w))
    # Counter-clockwise seen against the direction of the way; right is negative.
    side = np.stack([outer, -outer, -outer, -w, -w, w, w, outer], axis=1)  # (p, 8)
    height = np.stack([low, low, top, top, zero, zero, top, top], axis=1)
    position = lines.points[:, None] + miters(lines)[:, None] * side[:, :, None]
    vertices = np.concatenate([position, (z[:, None] + height)[:, :, None]], axis=2)
    first = np.flatnonzero(owner[1:] == owner[:-1])
    k, after = np.arange(8), np.roll(np.arange(8), -1)
    a = first[:, None] * 8
    quads = np.stack([a + k, a + 8 + k, a + 8 + after, a + after], axis=2)  # (m, 8, 4)
    along = arc_lengths(lines)[0]
    girth = np.cumsum(np.hypot(np.diff(side, axis=1), np.diff(height, axis=1)), axis=1)
    girth = np.concatenate([np.zeros((len(w), 1)), girth], axis=1)
    kind = layout.roads["kind"].to_numpy().astype(str)[decks.rows]
    paved = np.select([np.isin(kind, RAILS), np.isin(kind, ON_FOOT)], [2, 3], 1)
    material = np.zeros((len(first), 8), np.int16)
    material[:, 4] = paved[owner[first]]
    u = np.stack([along[first], along[first + 1], along[first + 1], along[first]], axis=1)
    turn = np.roll(girth, -1, axis=1)
    turn[:, -1] = girth[:, -1] + 2 * outer
    v = np.stack([girth[first], girth[first + 1], turn[first + 1], turn[first]], axis=2)
    uv = np.stack([np.repeat(u[:, None], 8, axis=1), v], axis=3)  # (m, 8, 4, 2)
    cap = np.array([[0, 1, 4, 5], [1, 2, 3, 4], [0, 5, 6, 7]])
    head, tail = lines.start[:-1] * 8, (lines.start[1:] - 1) * 8
    caps = np.stack([head[:, None, None] + cap, tail[:, None, None] + cap[:, ::-1]], axis=1)
    caps = caps.reshape(-1, 4)
    flat = np.zeros((len(caps), 4, 2))
    line = np.concatenate([np.repeat(owner[first], 8), np.repeat(np.arange(lines.count), 6)])
    order = np.argsort(line, kind="stable")
    faces = np.concatenate([quads.reshape(-1, 4), caps])[order]
    ids = layout.roads["id"].to_numpy()[decks.rows]
    return MeshBatch(
        ids,
        lines.start * 8,
        np.searchsorted(line[order], np.arange(lines.count + 1)).astype(np.int64),
        vertices.reshape(-1, 3),
        faces.astype(np.int32),
        np.concatenate([material.ravel(), np.zeros(len(caps), np.int16)])[order],
        MATERIALS,
        np.concatenate([uv.reshape(-1, 4, 2), flat])[order].astype(np.float32),
        np.ones((len(faces), 3), np.float32),
    )
