"""Walls, fences, hedges and wires along the lines of the layout."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.assets.furniture.dressed import NO_COLOR, THINGS, stuff_of
from cityx.assets.furniture.large_pieces import HANGERS
from cityx.city import City, MeshBatch
from cityx.city.city import Failure
from cityx.city.ground import KERB_HEIGHT
from cityx.city.levels import ground_levels
from cityx.city.mesh import concatenate, empty_batch
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.extrude import extrude, plan_of
from cityx.geometry.polygons import clean_polygons
from cityx.geometry.polylines import Polylines, arc_lengths, every, locate, pack
from cityx.ground.standing import earth_over
from cityx.ids import uniform
from cityx.nature.land.frontages import frontage_edges
from cityx.protocol import Port, action
from cityx.protocol.solid_blocks import packed
from cityx.sources.features import measures
from cityx.system.tables import table

ACTION = "nature/barriers-v1"

STEP = 4.0  # metres; a barrier follows the terrain by pieces of this length at most
# Clipped, but not ruled: metres between the points of a hedge near by, how far its face swells and
# sinks there, and the shade of its leaves.
TWIG, SWELL, SHADE = 0.4, 0.045, (0.55, 1.35)
BURIED = 0.4  # metres below the ground, so that no light passes under it
SHORTEST = 0.3  # metres; what is left of a line between two gates and shorter is dropped
SMALLEST = 0.05  # square metres, likewise of an outline
GATE = 0.4  # metres beyond the carriageway that a drive through a barrier leaves open
PATHS = ("footway", "path", "cycleway", "pedestrian")
POSTS = 2.5  # metres between the posts of a fence
MITRE = 3.0  # a corner's offset grows to this many half widths at most


@dataclass(frozen=True)
class Kind:
    """How a barrier is built: a swept profile, and posts for a fence.

    Attributes
    ----------
    height
        Metres, when the map does not say.
    width
        Metres.
    material
        Name of the material.
    tints
        Linear RGB colours to draw from.
    """

    height: float
    width: float
    material: str
    tints: tuple[tuple[float, float, float], ...]


KINDS = table("nature/barriers", Kind)
MATERIALS = table("nature/barrier_materials", str)  # words of OpenStreetMap -> materials
# Rails of a fence as shares of its height, and metres between its posts.
RAILS = {
    "fence": (((0.12, 0.16), (0.52, 0.55), (0.93, 0.97)), POSTS),
    "rail_fence": (((0.10, 0.15), (0.31, 0.34), (0.52, 0.55), (0.73, 0.76), (0.94, 1.0)), 1.6),
    "railing": (((0.10, 0.14), (0.86, 0.90)), 0.16),
}
SLENDER = {"railing": 0.011}  # metres, half of a post
POST = "metal_dark"
MERLONS, MERLON, MERLON_HALF = 1.8, 0.8, 0.42  # metres apart, high, and half of one
AT_GATE = 1.0  # metres from a barrier to a gate in it
DEEPEST = 8.0  # metres to both sides of the rim that a gate leads through a thick wall
GATES = {"gate": 3.0, "lift_gate": 3.5, "swing_gate": 3.5, "sally_port": 3.0, "entrance": 1.5,
         "kissing_gate": 1.0, "stile": 0.8}  # fmt: skip  # metres wide
LOWEST, HIGHEST = 0.02, 20.0  # metres of a barrier's width, and of what is free below it
UNROOFED = "it lies within a house that has no flat roof; left out"
OVERRUN = "a street lies where the map has it; left out"
GATE_ROOM = 4.7  # metres of height that a gate of a city wall leaves free
WIDEST_GATE = 32.0  # metres; a wider gap has fallen
SAG = 0.03  # of a span, by which wires hang through in the middle
WIRE, SPAN_PIECES = 0.03, 10  # metres, half of a wire; straight pieces of a span
GREEN_TOP = (0.36, 0.85)  # metres between which plants fill a planted wall


def _cut(
    city: City, lines: NDArray[Any], *, beside_paths: bool = False
) -> tuple[NDArray[Any], NDArray[np.int64]]:
    """Cut lines and outlines at the site and passing roads; return what is left, the row of each.

    With `beside_paths`, paths that merely run along a line cut nothing out of it.
    """
    owner = np.arange(len(lines))
    thick = shapely.get_dimensions(lines) == 2
    lines = shapely.intersection(lines, shapely.box(*city.layout.extent))
    roads = city.layout.roads
    kind = roads["kind"].to_numpy().astype(str)
    passing = ~roads["tunnel"].to_numpy() & ~roads["bridge"].to_numpy() & (kind != "subway")
    ways = roads.geometry.to_numpy()[passing]
    half = np.fmax(np.nan_to_num(roads["width"].to_numpy()[passing] / 2, nan=1.0), 0.6) + GATE
    if len(ways) and len(lines):
        way, line = shapely.STRtree(lines).query(ways, predicate="dwithin", distance=half)
        if beside_paths:
            crossing = shapely.intersects(ways[way], lines[line])
            crossing |= ~np.isin(kind[passing][way], PATHS)
            way, line = way[crossing], line[crossing]
        if len(way):
            order = np.lexsort((way, line))
            way, line = way[order], line[order]
            strips = shapely.buffer(ways[way], half[way], cap_style="flat", quad_segs=2)
            hit, start = np.unique(line, return_index=True)
            for row, group in zip(hit, np.split(strips, start[1:]), strict=True):
                lines[row] = shapely.difference(lines[row], shapely.union_all(group))
    lines = _opened(city, lines)
    lines[_within_houses(city, lines)] = shapely.LineString()
    parts, index = shapely.get_parts(lines, return_index=True)
    size = np.where(thick[index], shapely.area(parts) / SMALLEST, shapely.length(parts) / SHORTEST)
    good = (shapely.get_type_id(parts) == np.where(thick[index], 3, 1)) & (size > 1.0)
    return parts[good], owner[index[good]]


def _opened(city: City, lines: NDArray[Any]) -> NDArray[Any]:
    """Leave lines and outlines open at the gates of the map that lie on them."""
    points = city.layout.points[(city.layout.points["kind"] == "gate").to_numpy()]
    spots = points.geometry.to_numpy()
    if not len(spots) or not len(lines):
        return lines
    found = lines.copy()
    line, gate = shapely.STRtree(spots).query(lines, predicate="dwithin", distance=AT_GATE)
    for row, spot in zip(line.tolist(), gate.tolist(), strict=True):
        rim = found[row].boundary if shapely.get_dimensions(lines[row]) == 2 else found[row]
        along = (
            float(shapely.line_locate_point(rim, spots[spot]))
            if rim.geom_type in ("LineString", "LinearRing")
            else 0.0
        )
        at = shapely.line_interpolate_point(rim, [along - 0.1, along + 0.1])
        step = np.diff(shapely.get_coordinates(at), axis=0)[0]
        across = np.array([-step[1], step[0]]) / max(float(np.hypot(*step)), 1e-9)
        middle = shapely.get_coordinates(spots[spot])[0]
        way = shapely.LineString([middle - DEEPEST * across, middle + DEEPEST * across])
        strip = shapely.buffer(way, _gate_width(points["tags"].iloc[spot]) / 2, cap_style="flat")
        parts = shapely.get_parts(shapely.intersection(found[row], strip))
        near = parts[shapely.distance(parts, spots[spot]) <= AT_GATE]
        thick = shapely.get_dimensions(lines[row]) == 2  # nothing of the rim is left between
        room = shapely.buffer(shapely.union_all(near), 0.01, join_style="mitre") if thick else strip
        found[row] = shapely.difference(found[row], room)
    return found


def _gate_width(text: str) -> float:
    tags = json.loads(text or "{}")
    told = measures.measure(tags.get("width") or tags.get("maxwidth"), 0.5, 12.0)
    return told or GATES.get(tags.get("barrier", ""), GATES["gate"])


def _within_houses(city: City, lines: NDArray[Any]) -> BoolArray:
    """(n,) whether lines and outlines lie within a house, walls included."""
    found = np.zeros(len(lines), bool)
    houses = city.layout.buildings.geometry.to_numpy()
    if len(houses):
        found[shapely.STRtree(houses).query(lines, predicate="within")[0]] = True
    return found


def _roofs(city: City, lines: NDArray[Any]) -> FloatArray:
    """(n,) height of the flat roof that each line lies on, NaN for none."""
    parts = city.layout.parts
    found = np.full(len(lines), np.nan)
    flat = np.flatnonzero((parts["roof_shape"].to_numpy(str) == "flat") & parts["walls"])
    if len(flat) and len(lines):
        top = ground_levels(city.layout, city.terrain)[flat] + parts["top"].to_numpy(float)[flat]
        shapes = parts.geometry.to_numpy()[flat]
        line, roof = shapely.STRtree(shapes).query(lines, predicate="within")
        order = np.lexsort((top[roof], line))
        found[line[order]] = top[roof][order]  # the highest comes last
    return found


def _ground(city: City, xy: FloatArray) -> FloatArray:
    """(n,) height of the ground, or of what is heaped on it, under points."""
    land = city.terrain.height_at(xy) + KERB_HEIGHT
    return np.asarray(np.fmax(land, earth_over(city.scene.meshes.get("structures"), xy)))


def _resampled(lines: NDArray[Any], step: float = STEP) -> Polylines:
    """Clean lines and add points, so that they can follow the terrain."""
    clean = shapely.remove_repeated_points(shapely.force_2d(lines), 0.02)
    return pack(shapely.segmentize(clean, step))


def _offsets(lines: Polylines) -> FloatArray:
    """(p, 2) mitre vectors to the left for a half width of one; closed rings meet at the seam."""
    points = lines.points
    first, last = lines.start[:-1], lines.start[1:] - 1
    closed = np.hypot(*(points[first] - points[last]).T) < 0.01
    before = np.arange(len(points)) - 1
    after = np.arange(len(points)) + 1
    before[first] = np.where(closed, last - 1, first)
    after[last] = np.where(closed, first + 1, last)

    def unit(v: FloatArray) -> FloatArray:
        size = np.hypot(*v.T)
        return np.asarray(v / np.where(size > 1e-9, size, 1.0)[:, None])

    back, ahead = unit(points - points[before]), unit(points[after] - points)
    back[before == np.arange(len(points))] = ahead[before == np.arange(len(points))]
    stop = after == np.arange(len(points))
    ahead[stop] = back[stop]
    left_back: FloatArray = np.column_stack([-back[:, 1], back[:, 0]])
    left_ahead: FloatArray = np.column_stack([-ahead[:, 1], ahead[:, 0]])
    mid = unit(left_back + left_ahead)
    flat = np.hypot(*mid.T) < 0.5  # the line turns back on itself
    mid[flat] = left_ahead[flat]
    cosine = np.maximum(np.sum(mid * left_ahead, axis=1), 1.0 / MITRE)
    return np.asarray(mid / cosine[:, None])


def sweep(
    lines: Polylines, ids: NDArray[np.uint64], ground: FloatArray, profile: FloatArray,
    size: FloatArray, material: str, tint: FloatArray,
) -> MeshBatch:  # fmt: skip
    """Sweep a closed profile along lines, one closed solid per line.

    Parameters
    ----------
    lines
        The lines, n of them with p points.
    ids
        (n,) object of each line.
    ground
        (p,) height of the ground at every point, metres.
    profile
        (k, 2) float, across (left positive) in half widths and up in heights; seen along the line
        it runs counter-clockwise when left is to the left, and is convex.
    size
        (n, 2) half width and height, metres. Heights below zero of the profile are metres.
    material
        Name of the material.
    tint
        (n, 3) linear RGB.
    """
    if not lines.count:
        return empty_batch()
    k, count = len(profile), lines.count
    owner = lines.line_of_point()
    side = _offsets(lines)
    across = profile[:, 0] * size[owner, :1]  # (p, k)
    up = np.where(profile[:, 1] < 0, profile[:, 1], profile[:, 1] * size[owner, 1:])
    xy = lines.points[:, None, :] + side[:, None, :] * across[:, :, None]
    vertices = np.concatenate([xy, (ground[:, None] + up)[:, :, None]], axis=2).reshape(-1, 3)
    along, _ = arc_lengths(lines)
    girth = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(profile[np.r_[0:k, 0]], axis=0).T))])

    here = np.flatnonzero(owner[1:] == owner[:-1])  # segments by their first point
    j = np.arange(k)
    a = (here[:, None] * k + j).ravel()
    b = (here[:, None] * k + (j + 1) % k).ravel()
    quads = np.column_stack([a, a + k, b + k, b])
    u0 = np.repeat(along[here], k)
    u1 = np.repeat(along[here + 1], k)
    v0, v1 = np.tile(girth[:-1], len(here)), np.tile(girth[1:], len(here))
    uv = np.stack([np.column_stack([u0, v0]), np.column_stack([u1, v0]),
                   np.column_stack([u1, v1]), np.column_stack([u0, v1])], axis=1)  # fmt: skip
    fan = np.arange(1, k - 1)
    none = np.full((count, k - 2), -1)
    head = lines.start[:-1, None] * k
    tail = (lines.start[1:, None] - 1) * k
    first = np.stack([head + 0 * fan, head + fan, head + fan + 1, none], axis=2).reshape(-1, 4)
    last = np.stack([tail + 0 * fan, tail + fan + 1, tail + fan, none], axis=2).reshape(-1, 4)
    faces = np.concatenate([quads, first, last])
    face_line = np.concatenate([np.repeat(owner[here], k), np.repeat(np.arange(count), k - 2),
                                np.repeat(np.arange(count), k - 2)])  # fmt: skip
    caps = np.zeros((2 * count * (k - 2), 4, 2))
    uv = np.concatenate([uv, caps])
    order = np.argsort(face_line, kind="stable")
    faces, face_line, uv = faces[order], face_line[order], uv[order]
    return MeshBatch(
        ids.astype(np.uint64),
        (lines.start * k).astype(np.int64),
        np.searchsorted(face_line, np.arange(count + 1)).astype(np.int64),
        vertices,
        faces.astype(np.int32),
        np.zeros(len(faces), np.int16),
        (material,),
        uv.astype(np.float32),
        tint[face_line].astype(np.float32),
    )


def _grown(city: City, hedges: MeshBatch) -> MeshBatch:
    """Let the faces of swept hedges near by swell and sink, and lie in more light or less."""
    if city.lod <= 2:
        return hedges
    rows = np.repeat(np.arange(hedges.count), np.diff(hedges.vertex_start))
    number = np.arange(len(rows)) - hedges.vertex_start[rows]
    drawn = [uniform(city.seed, f"{ACTION}/swell", hedges.object_id[rows], 3 * number + axis)
             for axis in range(3)]  # fmt: skip
    vertices = hedges.vertices + SWELL * (2.0 * np.column_stack(drawn) - 1.0)
    face = np.repeat(np.arange(hedges.count), np.diff(hedges.face_start))
    light = uniform(city.seed, f"{ACTION}/shade", hedges.object_id[face],
                    np.arange(len(face)) - hedges.face_start[face])  # fmt: skip
    shade = SHADE[0] + (SHADE[1] - SHADE[0]) * light
    tint = np.asarray(hedges.tint * shade[:, None], np.float32)
    return replace(hedges, vertices=vertices, tint=tint)


# Profiles: across in half widths, up in heights; -BURIED is in metres.
_BOX = np.array([[1.0, -BURIED], [1.0, 1.0], [-1.0, 1.0], [-1.0, -BURIED]])[::-1]
_HEDGE = np.array([[0.85, -BURIED], [0.95, 0.2], [1.0, 0.45], [0.97, 0.7], [0.88, 0.92],
                   [0.55, 1.0], [0.0, 1.02], [-0.55, 1.0], [-0.88, 0.92], [-0.97, 0.7],
                   [-1.0, 0.45], [-0.95, 0.2], [-0.85, -BURIED]])[::-1]  # fmt: skip


def _rail(low: float, high: float) -> FloatArray:
    return np.array([[1.0, low], [1.0, high], [-1.0, high], [-1.0, low]])[::-1]


def posts(
    city: City, lines: Polylines, ids: NDArray[np.uint64], height: FloatArray, *,
    spacing: float = POSTS, aside: float = 0.0, half: float = 0.03, material: str = "metal_dark",
    base: float | None = None,
) -> MeshBatch:  # fmt: skip
    """Make the posts of fences, or the merlons of walls, under the ids of what they belong to.

    Parameters
    ----------
    city
        Its terrain carries them.
    lines, ids, height
        The fences: (n,) ids and heights in metres.
    spacing
        Metres between posts.
    aside
        Metres to the left of the line.
    half
        Metres, half of a post.
    material
        Of the posts.
    base
        Height that they stand on, None for the ground.
    """
    line, along = every(arc_lengths(lines)[1], spacing)
    position, ahead = locate(lines, line, along)
    position = position + aside * np.column_stack([-ahead[:, 1], ahead[:, 0]])
    ends = np.stack([position - half * ahead, position + half * ahead], axis=1).reshape(-1, 2)
    short = Polylines(ends, np.arange(0, len(ends) + 1, 2))
    ground = np.repeat(_ground(city, position) if base is None else np.full(len(line), base), 2)
    size = np.column_stack([np.full(len(line), half), height[line] + 0.06])
    box = _BOX if base is None else np.maximum(_BOX, (-np.inf, 0.0))
    return sweep(short, ids[line], ground, box, size, material, np.ones((len(line), 3)))


@dataclass(frozen=True)
class _Told:
    """What the map tells of a barrier beside its height.

    Attributes
    ----------
    kind
        Its width and material.
    low
        Metres above what it stands on at which it begins.
    base
        Height of the roof that it stands on, None for the ground.
    """

    kind: Kind
    low: float = 0.0
    base: float | None = None


def _told(name: str, text: str, roof: float | None) -> _Told:
    """Read what the tags of a barrier tell of it."""
    kind, tags = KINDS[name], json.loads(text or "{}")
    width = measures.measure(tags.get("width"), LOWEST, HIGHEST)
    words = (tags.get(key, "") for key in ("material", "fence_type", "wall"))
    material = next((MATERIALS[word] for word in words if word in MATERIALS), kind.material)
    if width:
        kind = replace(kind, width=width)
    if material != kind.material and not name.endswith("hedge"):
        kind = replace(kind, material=material, tints=((1.0, 1.0, 1.0),))
    color = measures.color(str(tags.get("colour", tags.get("color", ""))))
    if color != NO_COLOR and not name.endswith("hedge"):
        stuff = stuff_of("", color, THINGS, kind.material)
        kind = replace(kind, material=stuff.material, tints=(stuff.tint,))
    low = measures.measure(tags.get("min_height"), LOWEST, HIGHEST)
    return _Told(kind, low or 0.0, roof)


def _raised(
    city: City, name: str, shapes: NDArray[Any], ids: NDArray[np.uint64], given: FloatArray,
    told: _Told | None = None,
) -> list[MeshBatch]:  # fmt: skip
    """Build barriers of one kind; ``given`` are (n,) heights in metres, NaN for the usual one."""
    if not len(shapes):
        return []
    told = told or _Told(KINDS[name])
    kind, base = told.kind, told.base
    hedge = name.endswith("hedge")
    leafy = hedge or name == "planted_wall"
    lines = _resampled(shapes, TWIG if leafy and city.lod > 2 else STEP)
    height = np.maximum(_height(kind, given) - told.low, LOWEST)
    size = np.column_stack([np.full(len(ids), kind.width / 2), height])
    pick = _pick(city, kind, ids)
    tint = np.array(kind.tints)[pick]
    ground = _ground(city, lines.points) if base is None else np.full(len(lines.points), base)
    ground = ground + told.low
    buried = told.low == 0.0 and base is None
    box, bush = (each if buried else np.maximum(each, (-np.inf, 0.0)) for each in (_BOX, _HEDGE))
    if name in RAILS:
        rails, spacing = RAILS[name]
        found = [sweep(lines, ids, ground, _rail(low, high), size, kind.material, tint)
                 for low, high in rails]  # fmt: skip
        half = SLENDER.get(name, 0.03)
        material = kind.material if kind.material != KINDS[name].material else POST
        reach = height + told.low  # posts begin on the ground
        return [*found, posts(city, lines, ids, reach, spacing=spacing, half=half,
                              material=material, base=base)]  # fmt: skip
    if hedge:
        return [_grown(city, sweep(lines, ids, ground, bush, size, kind.material, tint))]
    found = [sweep(lines, ids, ground, box, size, kind.material, tint)]
    if name == "city_wall":
        half = min(MERLON_HALF, 0.3 * kind.width)
        found.append(posts(city, lines, ids, height + told.low + MERLON, spacing=MERLONS,
                           half=half, material=kind.material, base=base))  # fmt: skip
    if name == "planted_wall":
        low, high = GREEN_TOP
        shown = 0.8 + 0.4 * uniform(city.seed, f"{ACTION}/green", ids)
        top = np.column_stack([np.full(len(ids), 0.9 * kind.width / 2), shown * (high - low)])
        green = np.array(KINDS["front_hedge"].tints)[pick]
        bushes = _HEDGE.copy()
        bushes[bushes[:, 1] < 0, 1] = 0.0
        plants = sweep(lines, ids, ground + low, bushes, top, "hedge", green)
        found.append(_grown(city, plants))
    return found


def _thick(
    city: City, shapes: NDArray[Any], ids: NDArray[np.uint64], given: FloatArray, told: _Told
) -> list[MeshBatch]:
    """Raise outlines of barriers to solids whose tops follow the ground; arguments as `_raised`."""
    if not len(shapes):
        return []
    kind = told.kind
    plan = plan_of(shapely.segmentize(clean_polygons(shapely.force_2d(shapes)), STEP))
    ground = _ground(city, plan.rings.points)
    if told.base is not None:
        ground = np.full(len(ground), told.base)
    part = plan.part_of_point
    low = np.full(plan.count, np.inf)
    np.minimum.at(low, part, ground)
    top = ground + _height(kind, given)[part]
    bottom = low + told.low if told.low or told.base is not None else low - BURIED
    solids = extrude(plan, bottom, top, low, per_point=True)
    found = packed(solids, ids.astype(np.uint64), (kind.material, kind.material))
    tint = np.array(kind.tints)[_pick(city, kind, ids)]
    return [replace(found, tint=tint[found.face_object()].astype(np.float32))]


def _height(kind: Kind, given: FloatArray) -> FloatArray:
    """(n,) metres, of the map or usual for the kind."""
    known = np.isfinite(given) & (given > 0.1)
    return np.asarray(np.where(known, np.clip(given, 0.3, 30.0), kind.height))


def _pick(city: City, kind: Kind, ids: NDArray[np.uint64]) -> IntArray:
    """(n,) which of its kind's tints each barrier has."""
    return np.asarray((uniform(city.seed, f"{ACTION}/tint", ids) * len(kind.tints)).astype(int))


def _over_gates(
    city: City, whole: NDArray[Any], pieces: NDArray[Any], row: NDArray[np.int64],
    ids: NDArray[np.uint64], given: FloatArray, kind: Kind,
) -> list[MeshBatch]:  # fmt: skip
    """Carry walls on over their gates.

    Parameters
    ----------
    whole
        The walls before streets parted them.
    pieces, row, ids, given
        (n,) what is left of them, the wall of each, its id and its height, metres.
    kind
        Their width and material.
    """
    lines, numbers, heights = [], [], []
    for wall in np.unique(row).tolist():
        own = np.flatnonzero(row == wall)
        solid = shapely.union_all(pieces[own])
        gaps = shapely.get_parts(shapely.line_merge(shapely.difference(whole[wall], solid)))
        ends = shapely.get_point(gaps, 0), shapely.get_point(gaps, -1)
        spanned = np.logical_and(*(shapely.distance(end, solid) < 0.05 for end in ends))
        spanned &= shapely.length(gaps) <= WIDEST_GATE
        high = given[own[0]] if np.isfinite(given[own[0]]) else kind.height
        if high > GATE_ROOM + 0.5:
            lines += gaps[spanned].tolist()
            numbers += [int(ids[own[0]])] * int(spanned.sum())
            heights += [float(high)] * int(spanned.sum())
    if not lines:
        return []
    packed = _resampled(np.array(lines, object))
    top = np.array(heights)
    size = np.column_stack([np.full(len(top), kind.width / 2), top])
    low = GATE_ROOM / float(top.max())
    tint = np.tile(np.array(kind.tints[0]), (len(top), 1))
    ground = _ground(city, packed.points)
    return [sweep(packed, np.array(numbers, np.uint64), ground, _rail(low, 1.0), size,
                  kind.material, tint)]  # fmt: skip


def _over_thick(
    city: City, whole: NDArray[Any], pieces: NDArray[Any], row: NDArray[np.int64],
    ids: NDArray[np.uint64], given: FloatArray, told: _Told,
) -> list[MeshBatch]:  # fmt: skip
    """Carry walls that are drawn as areas on over their gates; arguments as `_over_gates`."""
    found = []
    site = shapely.box(*city.layout.extent)
    for wall in np.unique(row).tolist():
        own = np.flatnonzero(row == wall)
        high = given[own[:1]]
        if _height(told.kind, high)[0] <= GATE_ROOM + 0.5:
            continue
        left = shapely.union_all(pieces[own])
        gaps = shapely.get_parts(shapely.difference(shapely.intersection(whole[wall], site), left))
        gaps = gaps[shapely.area(gaps) > SMALLEST]
        reach = shapely.length(shapely.oriented_envelope(gaps)) / 2
        gaps = gaps[(reach <= 2 * WIDEST_GATE) & (shapely.get_type_id(gaps) == 3)]
        count = len(gaps)
        found += _thick(city, gaps, np.repeat(ids[own[:1]], count), np.repeat(high, count),
                        replace(told, low=GATE_ROOM))  # fmt: skip
    return found


@action(
    ACTION,
    limits=[
        "Fences are rails and posts; gates are left open.",
        "Plots need facades to have edges.",
    ],
    requires=("layout",),
    after=("road/ground-v1", "building/facade-v1"),
    takes=(Port("lines", "line", role="barrier"),),
    gives=(Port("barriers", "complex_geometry", "barriers"),),
    labels=("walls", "fences", "hedges"),
)
def barriers(city: City) -> City:
    """Raise walls, fences and hedges along the terrain, and those of plots along walks in town.

    Parameters
    ----------
    city
        City with a layout; the terrain is used when there.
    """
    done = city.stages_done | {"nature"}
    if city.lod < 1:
        return replace(city, stages_done=done)
    table = city.layout.lines
    kinds = table["kind"].to_numpy().astype(str)
    batches: list[MeshBatch] = []
    shapes = table.geometry.to_numpy()
    housed = np.isin(kinds, list(KINDS)) & _within_houses(city, shapes)
    roof = np.where(housed, _roofs(city, shapes), np.nan)
    for name in KINDS:
        groups: dict[_Told, list[int]] = {}
        for line in np.flatnonzero(kinds == name).tolist():
            high = float(roof[line])
            told = _told(name, table["tags"].iloc[line], None if np.isnan(high) else high)
            groups.setdefault(told, []).append(line)
        for told, lines in groups.items():
            batches += _as_told(city, name, told, np.array(lines, np.int64))
    numbers = table["id"].to_numpy()
    stands = np.isin(numbers, [own for batch in batches for own in batch.object_id.tolist()])
    inside = shapely.intersects(shapes, shapely.box(*city.layout.extent))
    lost = np.isin(kinds, list(KINDS)) & ~stands & inside
    failures = city.failures + tuple(
        Failure(int(numbers[row]), ACTION, UNROOFED if housed[row] else OVERRUN)
        for row in np.flatnonzero(lost).tolist()
    )
    if city.lod > 1:
        edges = frontage_edges(city)
        edges = edges.take(edges.kind != "")
        for name in np.unique(edges.kind.astype(str)).tolist():
            rows = np.flatnonzero(edges.kind == name)
            shapes, row = _cut(city, edges.lines[rows].copy(), beside_paths=True)
            batches += _raised(city, name, shapes, edges.id[rows][row], np.full(len(row), np.nan))
    scene, wires = city.scene, power_wires(city)
    if batches:
        scene = scene.with_mesh("barriers", joined_by_id(batches))
    if wires.count:
        scene = scene.with_mesh("power_lines", wires)
    return replace(city, scene=scene, stages_done=done, failures=failures)


def _as_told(city: City, name: str, told: _Told, rows: IntArray) -> list[MeshBatch]:
    """Build the barriers of some rows of the layout's lines, which are of one kind and told alike.

    Nothing passes those on roofs.
    """
    table = city.layout.lines
    whole = table.geometry.to_numpy()[rows]
    if told.base is None:
        shapes, row = _cut(city, whole.copy())
        gone = np.setdiff1d(np.arange(len(rows)), row)  # one along a path may stand beside it
        more, which = _cut(city, whole[gone], beside_paths=True)
        order = np.argsort(np.r_[row, gone[which]], kind="stable")
        shapes, row = np.r_[shapes, more][order], np.r_[row, gone[which]][order]
    else:
        shapes, row = whole, np.arange(len(rows))
    ids, given = table["id"].to_numpy()[rows][row], table["height"].to_numpy()[rows][row]
    thick = shapely.get_dimensions(shapes) == 2
    solid = shapes[thick], ids[thick], given[thick]
    found = _thick(city, *solid, told)
    if name == "city_wall" and thick.any():
        found += _over_thick(city, whole, shapes[thick], row[thick], *solid[1:], told)
    shapes, row, ids, given = shapes[~thick], row[~thick], ids[~thick], given[~thick]
    found += _raised(city, name, shapes, ids, given, told)
    if name == "city_wall" and len(row):
        found += _over_gates(city, whole, shapes, row, ids, given, told.kind)
    return found


def power_wires(city: City) -> MeshBatch:
    """Hang the wires of power lines from the pylon at each point of a line to that at the next."""
    table = city.layout.lines
    rows = np.flatnonzero((table["kind"] == "power_line").to_numpy())
    lines = shapely.force_2d(table.geometry.to_numpy()[rows])
    spans = [(xy, int(number), high)
             for line, number, high in zip(lines.tolist(), table["id"].to_numpy()[rows].tolist(),
                                           table["height"].to_numpy()[rows].tolist(), strict=True)
             for xy in np.stack([shapely.get_coordinates(line)[:-1],
                                 shapely.get_coordinates(line)[1:]], axis=1)]  # fmt: skip
    if not spans:
        return empty_batch()
    ends = np.array([xy for xy, _, _ in spans])  # (s, 2, 2)
    ids = np.array([number for _, number, _ in spans], np.uint64)
    size = np.array([high for _, _, high in spans]) / HANGERS[-1][1]
    way = ends[:, 1] - ends[:, 0]
    length = np.hypot(*way.T)
    left = np.column_stack([-way[:, 1], way[:, 0]]) / np.maximum(length, 1e-9)[:, None]
    foot = _ground(city, ends.reshape(-1, 2)).reshape(-1, 2)
    share = np.linspace(0.0, 1.0, SPAN_PIECES + 1)
    start = np.arange(len(spans) + 1) * (SPAN_PIECES + 1)
    profile = np.array([[WIRE, 0.0], [0.0, 2 * WIRE], [-WIRE, 0.0]])[::-1]
    found = []
    for across, above in HANGERS:
        at = ends[:, :1] + share[:, None] * way[:, None] + (across * size[:, None] * left)[:, None]
        sag = SAG * length[:, None] * 4 * share * (1 - share)
        z = foot[:, :1] + share * np.diff(foot, axis=1) + above * size[:, None] - sag
        packed = Polylines(at.reshape(-1, 2), start)
        ones = np.ones((len(spans), 2)), np.ones((len(spans), 3))
        found.append(sweep(packed, ids, z.ravel(), profile, ones[0], "metal_dark", ones[1]))
    return joined_by_id(found)


def joined_by_id(batches: list[MeshBatch]) -> MeshBatch:
    """Join batches so that all solids of one id are one object, sorted by id."""
    joined = concatenate(batches)
    sorted_ = joined.take(np.argsort(joined.object_id, kind="stable"))
    ids, first = np.unique(sorted_.object_id, return_index=True)
    return replace(
        sorted_,
        object_id=ids,
        vertex_start=np.append(sorted_.vertex_start[first], sorted_.vertex_start[-1]),
        face_start=np.append(sorted_.face_start[first], sorted_.face_start[-1]),
    )
