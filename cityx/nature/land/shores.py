"""Shores: quays with coping and railing in town, banks with reeds in open land, boats."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city import City, MeshBatch
from cityx.city.ground import KERB_HEIGHT, LABEL, WATER_LEVEL, Ground
from cityx.city.mesh import NO_VERTEX, one_mesh
from cityx.geometry.arrays import FloatArray
from cityx.geometry.clearance import near_any
from cityx.geometry.polylines import (
    Polylines,
    arc_lengths,
    every,
    locate,
    miters,
    nearest_on,
    pack,
    segments,
)
from cityx.geometry.scatter import PER_CELL, candidates, cell_ids, cells_of_boxes
from cityx.ground.arrangement import BEYOND, face_areas
from cityx.ground.pieces import (
    Pieces,
    heights,
    in_carriageways,
    inside_extent,
    join_pieces,
    may_stand,
    pieces,
    room_along,
    with_pieces,
)
from cityx.ground.standing import stand_on
from cityx.ids import hash_ids, mix, stable_id, uniform
from cityx.nature.land.barriers import joined_by_id, posts, sweep
from cityx.protocol import Port, action
from cityx.road.surface.kerbs import yaw_facing

ACTION = "nature/shores-v1"
LAYER = "shore_pieces"
HARD = ("sidewalk", "kerb", "plaza", "courtyard", "carriageway", "setts", "gutter",
        "parking_lane", "mouth_setts", "junction", "parking", "railway", "marking")  # fmt: skip
PEDESTRIAN = ("sidewalk", "kerb", "plaza", "courtyard", "path", "trail", "furnishing", "edging",
              "frontage")  # fmt: skip
INLAND = 3.0  # metres from the shore within which paving makes it a quay
BASIN = 160.0  # square metres; smaller water is a basin with a rim
LEAST = 2.0  # metres; shorter pieces of shore stay as they are
STEP = 2.0  # metres between the points of a bank
FINE = 3  # level of detail from which a bank has all of them; below it is drawn by every second
# Across a bank: share of its width, and of the drop to the bed; the last strip lies under water.
PROFILES = {True: ((0.0, 0.0), (0.35, 0.22), (0.75, 0.66), (1.25, 1.0)),
            False: ((0.0, 0.0), (0.75, 0.66), (1.25, 1.0))}  # fmt: skip
STRAIGHT = 0.08  # metres by which shores are simplified
COPING_IN, COPING_OUT, COPING_UP = 0.45, 0.06, 0.10  # metres over land, over water, above land
RAIL_IN, RAIL_HEIGHT, RAIL_POSTS = 0.25, 1.05, 2.0  # metres
RAILED = 0.6  # share of the quays for people that have a railing; the others have bollards
BRIDGE_GAP = 1.0  # metres beside a bridge that stay open
BANK_WIDTH = (1.0, 2.4)  # metres a bank reaches into the water
BANK_SHARE = 0.28  # of the water's width that a bank takes at most
SUNK = 0.3  # metres below the water at which a bank ends
REED_SPACING, BOULDER_SPACING = 1.1, 4.5  # metres
REED_PATCH = 14.0  # metres of shore that have reeds or none
BOLLARDS, LADDERS, RINGS, STAIRS = 14.0, 60.0, 90.0, 110.0  # metres along a quay
NAVIGABLE = 15.0  # metres of water across from which boats are moored
WIDE = 28.0  # metres from which barges are
BERTH = 9.0  # metres of quay per boat
BOATS = 0.38  # share of the berths that are taken


@dataclass(frozen=True)
class _Shore:
    """Lines with the water on the right hand, and whether each is a quay, a bank or a rim."""

    lines: NDArray[Any]
    kind: NDArray[Any]
    rims: NDArray[Any]  # all segments of the waterline


def _shore(city: City, ground: Ground) -> _Shore:
    """Find the waterline in the ground and join it to lines of one kind each."""
    wet = ground.face_label == LABEL["water"]
    left, right = ground.edge_faces.T.astype(np.int64)
    inner = np.flatnonzero(right != BEYOND)
    left, right = left[inner], right[inner]
    shore = wet[left] != wet[right]
    rows, left, right = inner[shore], left[shore], right[shore]
    flip = wet[left]
    ends = ground.edges[rows].astype(np.int64)
    ends = np.where(flip[:, None], ends[:, ::-1], ends)
    water, land = np.where(flip, left, right), np.where(flip, right, left)
    label = ground.face_label[land]
    a, b = ground.vertices[ends[:, 0]], ground.vertices[ends[:, 1]]
    step = b - a
    inland = np.column_stack([-step[:, 1], step[:, 0]])
    inland /= np.maximum(np.hypot(*step.T), 1e-9)[:, None]
    behind = stand_on(city.scene.meshes.get("ground"), (a + b) / 2 + INLAND * inland).label
    hard = [LABEL[name] for name in HARD]
    quay = np.isin(label, hard) | (np.isin(behind, hard) & (label != LABEL["building"]))
    bodies, body = np.unique(ground.face_object[water], return_inverse=True)
    areas = np.zeros(len(bodies))
    area = face_areas(ground)
    wet_rows = np.flatnonzero(wet & np.isin(ground.face_object, bodies))
    np.add.at(areas, np.searchsorted(bodies, ground.face_object[wet_rows]), area[wet_rows])
    table = city.layout.areas
    fountain = table["tags"].str.contains('"fountain"', regex=False).to_numpy().astype(bool)
    made = (table["kind"] == "pool").to_numpy() | fountain
    basin = (areas < BASIN) | np.isin(bodies, table["id"].to_numpy()[made])
    kind = np.where(label == LABEL["building"], "", np.where(quay, "quay", "bank")).astype(object)
    kind = np.where(basin[body] & (kind != ""), "rim", kind)
    segments = shapely.linestrings(np.stack([a, b], axis=1))
    lines, kinds = [np.zeros(0, object)], [np.zeros(0, object)]
    for name in ("quay", "bank", "rim"):
        chosen = segments[kind == name]
        if not len(chosen):
            continue
        joined = shapely.get_parts(
            shapely.line_merge(shapely.multilinestrings(chosen), directed=True)
        )
        joined = shapely.simplify(joined[shapely.length(joined) > LEAST], STRAIGHT)
        lines.append(joined)
        kinds.append(np.full(len(joined), name, object))
    found, names = np.concatenate(lines), np.concatenate(kinds)
    order = np.lexsort(np.round(shapely.bounds(found), 2).T) if len(found) else np.zeros(0, int)
    return _Shore(found[order], names[order], segments)


def _ids(lines: NDArray[Any]) -> NDArray[np.uint64]:
    """(n,) ids of lines by their first points, in centimetres."""
    first = shapely.get_coordinates(shapely.get_point(lines, 0))
    cm = np.round(first * 100).astype(np.int64)
    key = mix(cm[:, 0].view(np.uint64)) ^ np.ascontiguousarray(cm[:, 1]).view(np.uint64)
    return hash_ids(0, ACTION, mix(key))


def _levels(city: City, points: FloatArray, toward: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(n,) heights of the land and of the water at points of the waterline."""
    land = heights(city, points - 0.15 * toward)
    found = stand_on(city.scene.meshes.get("ground"), points + 0.2 * toward)
    wet = found.label == LABEL["water"]
    usual = land - KERB_HEIGHT + WATER_LEVEL
    water = np.where(wet & np.isfinite(found.z), found.z, usual)
    # A footing that fell into the water says nothing of the land.
    return np.maximum(land, water + 0.1), water


def _right(lines: Polylines) -> FloatArray:
    """(p, 2) vectors to the right at the points, towards the water."""
    return -miters(lines)


def _box(inner: float, outer: float, low: float, high: float) -> FloatArray:
    """Profile of a bar beside a line, metres: left and right of it, below and above the land."""
    return np.array([[inner, low], [inner, high], [outer, high], [outer, low]])[::-1]


def _copings(city: City, shore: _Shore) -> list[MeshBatch]:
    """Coping stones on quays and the rims of basins."""
    rows = np.flatnonzero(np.isin(shore.kind, ("quay", "rim")))
    if not len(rows):
        return []
    lines = pack(shapely.segmentize(shore.lines[rows], 8.0))
    land, _ = _levels(city, lines.points, _right(lines))
    profile = _box(COPING_IN, -COPING_OUT, -0.35, COPING_UP)
    size = np.ones((len(rows), 2))
    tint = np.full((len(rows), 3), 0.92)
    return [sweep(lines, _ids(shore.lines[rows]), land, profile, size, "step_stone", tint)]


def _railed(city: City, lines: NDArray[Any]) -> NDArray[np.bool_]:
    """(n,) whether quays have people behind them and a railing."""
    packed = pack(lines)
    middle, ahead = locate(packed, np.arange(len(lines)), arc_lengths(packed)[1] / 2)
    left = np.column_stack([-ahead[:, 1], ahead[:, 0]])
    label = stand_on(city.scene.meshes.get("ground"), middle + 1.5 * left).label
    people = np.isin(label, [LABEL[name] for name in PEDESTRIAN])
    return np.asarray(people & (uniform(city.seed, f"{ACTION}/rail", _ids(lines)) < RAILED))


def _railings(city: City, lines: NDArray[Any]) -> list[MeshBatch]:
    """Railings along quays, open where bridges begin."""
    roads = city.layout.roads
    bridges = roads["bridge"].to_numpy()
    ways, width = roads.geometry.to_numpy()[bridges], roads["width"].to_numpy()[bridges]
    gaps = shapely.buffer(ways, np.nan_to_num(width / 2, nan=1.5) + BRIDGE_GAP, cap_style="square")
    lines = shapely.difference(lines, shapely.unary_union(gaps)) if len(gaps) else lines
    parts = shapely.get_parts(lines)
    parts = parts[(shapely.get_type_id(parts) == 1) & (shapely.length(parts) > LEAST)]
    if not len(parts):
        return []
    packed, ids = pack(shapely.segmentize(parts, 8.0)), _ids(parts)
    land, _ = _levels(city, packed.points, _right(packed))
    base, size, tint = land + COPING_UP, np.ones((len(parts), 2)), np.ones((len(parts), 3))
    bars = ((0.12, 0.15), (0.42, 0.44), (0.72, 0.74), (RAIL_HEIGHT - 0.05, RAIL_HEIGHT))
    found = [
        sweep(packed, ids, base, _box(RAIL_IN + 0.02, RAIL_IN - 0.02, low, high), size,
              "metal_dark", tint)
        for low, high in bars
    ]  # fmt: skip
    height = np.full(len(parts), RAIL_HEIGHT)
    return [*found, posts(city, packed, ids, height, spacing=RAIL_POSTS, aside=RAIL_IN)]


def _banks(city: City, shore: _Shore) -> tuple[list[MeshBatch], Pieces, FloatArray]:
    """Slopes into the water with reeds and stones; returns them with the heights they stand at."""
    rows = np.flatnonzero(shore.kind == "bank")
    none = join_pieces([]), np.zeros(0)
    if not len(rows):
        return [], *none
    lines = pack(shapely.segmentize(shore.lines[rows], STEP))
    out = _right(lines)
    unit = out / np.maximum(np.hypot(*out.T), 1e-9)[:, None]
    land, water = _levels(city, lines.points, unit)
    cm = np.round(lines.points * 100).astype(np.int64)
    key = mix(mix(cm[:, 0].view(np.uint64)) ^ np.ascontiguousarray(cm[:, 1]).view(np.uint64))
    low, high = BANK_WIDTH
    width = low + (high - low) * uniform(city.seed, f"{ACTION}/bank", key)
    across = room_along(lines.points + 0.3 * unit, unit, shore.rims, 12.0) + 0.3
    width = np.minimum(width, BANK_SHARE * across)
    toe = np.column_stack([width[:, None] * out, water - SUNK - land])
    mesh = _slopes(lines, np.column_stack([lines.points, land]), toe, fine=city.lod >= FINE)
    return [mesh], *_growth(city, lines, width, water)


def _slopes(lines: Polylines, top: FloatArray, toe: FloatArray, *, fine: bool) -> MeshBatch:
    """Draw banks from the (p, 3) points of their tops down by the (p, 3) ways to their toes."""
    owner = lines.line_of_point()
    if not fine:
        last = np.r_[owner[1:] != owner[:-1], True]
        kept = ((np.arange(len(owner)) - lines.start[owner]) % 2 == 0) | last
        owner, top, toe = owner[kept], top[kept], toe[kept]
    places = PROFILES[fine]
    lift = np.array([0.0, 0.0, 0.004])  # so that land and bank never flicker
    vertices = np.stack(
        [top + toe * [share, share, fall] + lift for share, fall in places], axis=1
    ).reshape(-1, 3)
    here = np.flatnonzero(owner[1:] == owner[:-1])
    k = len(places)
    faces, material = [], []
    for ring in range(k - 1):
        a = here * k + ring
        quads = np.column_stack([a, a + 1, a + k + 1, a + k])
        # A bent quad is two triangles.
        faces += [quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]
        material += [np.full(2 * len(here), 0 if ring < k - 2 else 1)]
    corner = np.concatenate(faces)
    table = np.column_stack([corner, np.full(len(corner), NO_VERTEX)])
    uv = np.zeros((len(corner), 4, 2))
    uv[:, :3] = vertices[corner][:, :, :2]
    return one_mesh(
        stable_id("shores", "banks"), vertices, table, material=np.concatenate(material),
        materials=("meadow", "soil"), uv=uv, tint=(0.7, 0.72, 0.62),
    )  # fmt: skip


def _growth(
    city: City, lines: Polylines, width: FloatArray, water: FloatArray
) -> tuple[Pieces, FloatArray]:
    """Reeds in patches and scattered stones at the foot of banks."""
    ground = city.ground
    assert ground is not None
    found, level = [], []
    for name, spacing, share in (("reeds", REED_SPACING, 0.85), ("boulder", BOULDER_SPACING, 0.5)):
        line, along, own = _strewn(city, lines, spacing, name)
        patch = cell_ids(np.floor(locate(lines, line, along)[0] / REED_PATCH).astype(np.int64))
        keep = uniform(city.seed, f"{ACTION}/{name}", own) < share
        if name == "reeds":
            keep &= uniform(city.seed, f"{ACTION}/reedy", patch) < 0.5
        line, along, own = line[keep], along[keep], own[keep]
        position, ahead = locate(lines, line, along)
        right = np.column_stack([ahead[:, 1], -ahead[:, 0]])
        nearest = _point_before(lines, line, along)
        draw = uniform(city.seed, f"{ACTION}/{name}/out", own)
        reach = width[nearest] * (0.6 + 0.45 * draw if name == "reeds" else 0.3 + 0.7 * draw)
        xy = position + right * reach[:, None]
        group = pieces(name, xy, own, 2 * np.pi * uniform(city.seed, f"{ACTION}/turn", own))
        scale = 0.7 + 0.6 * uniform(city.seed, f"{ACTION}/size", own)
        # Where the bank turns, its foot may lie on the land of the other side, or on a road there.
        wet = ground.on(xy, "water")
        found.append(replace(group, scale=scale * (1.0 if name == "reeds" else 0.85)).take(wet))
        level.append((water[nearest] + (0.0 if name == "reeds" else 0.05))[wet])
    return join_pieces(found), np.concatenate(level)


def _strewn(
    city: City, lines: Polylines, spacing: float, name: str
) -> tuple[NDArray[np.int64], FloatArray, NDArray[np.uint64]]:
    """Strew places along lines, one in every `spacing` metres or so: line, metres along it, id.

    They come from cells of the plane, so that where a line begins does not matter.
    """
    first, _ = segments(lines)
    ends = lines.points[np.stack([first, first + 1])]  # (2, s, 2)
    reach = spacing / 2
    about = np.concatenate([ends.min(axis=0) - reach, ends.max(axis=0) + reach], axis=1)
    spots = candidates(cells_of_boxes(about, spacing), spacing, seed=city.seed,
                       purpose=f"{ACTION}/{name}")  # fmt: skip
    one = spots.id % np.uint64(PER_CELL) == 0  # about one of a cell
    spot, line, along = nearest_on(lines, shapely.points(spots.xy[one]), reach)
    return line, along, hash_ids(0, f"{ACTION}/{name}", spots.id[one][spot])


def _point_before(lines: Polylines, line: NDArray[np.int64], along: FloatArray) -> Any:
    """(k,) the point of its line at or before each position."""
    s, length = arc_lengths(lines)
    shift = np.concatenate([[0.0], np.cumsum(length + 1.0)])[:-1]
    keys = s + np.repeat(shift, np.diff(lines.start))
    at = np.searchsorted(keys, along + shift[line], side="right") - 1
    return np.clip(at, lines.start[line], lines.start[line + 1] - 1)


def _quayside(
    city: City, shore: _Shore, lines: NDArray[Any], railed: NDArray[np.bool_]
) -> tuple[Pieces, FloatArray]:
    """Bollards, ladders, life rings and steps on quays, boats before them, and their heights."""
    packed, ids = pack(lines), _ids(lines)
    length = arc_lengths(packed)[1]
    roads = city.layout.roads
    over = roads.geometry.to_numpy()[roads["bridge"].to_numpy()]
    found: list[Pieces] = []
    level: list[FloatArray] = []
    # Name, spacing, metres inland, whether on railed and on open quays, and where it stands.
    things = (
        ("mooring_bollard", BOLLARDS, 0.75, False, True, "land"),
        ("quay_ladder", LADDERS, 0.0, False, True, "land"),
        ("life_ring", RINGS, 0.9, True, True, "land"),
        ("quay_steps", STAIRS, 0.0, False, True, "land"),
        ("boat", BERTH, 0.0, True, True, "water"),
    )
    for name, spacing, inland, on_railed, on_open, where in things:
        line, along = every(length, spacing, spacing / 3)
        keep = np.where(railed[line], on_railed, on_open)
        line, along = line[keep], along[keep]
        if not len(line):
            continue
        number = np.arange(len(line)) - np.searchsorted(line, line)
        own = hash_ids(0, f"{ACTION}/{name}", ids[line], number)
        position, ahead = locate(packed, line, along)
        right = np.column_stack([ahead[:, 1], -ahead[:, 0]])
        xy, yaw = position - inland * right, yaw_facing(right)
        names = np.full(len(line), name, object)
        land, water = _levels(city, position, right)
        free = ~near_any(xy, over, 14.0) & inside_extent(city, xy, 1.0)
        scale = np.ones(len(line))
        if where == "water":
            wide = room_along(position + 0.3 * right, right, shore.rims, 40.0)
            draw = uniform(city.seed, f"{ACTION}/boat", own)
            names = np.where(draw < 0.45, "rowing_boat", "motor_boat").astype(object)
            barge = (wide >= WIDE) & (draw > 0.8) & (number % 2 == 0)
            names[barge] = "barge"
            free &= (wide >= NAVIGABLE) & (uniform(city.seed, f"{ACTION}/moor", own) < BOATS)
            # A barge takes the berths beside it.
            beside = np.zeros(len(line), bool)
            taken = np.flatnonzero(barge & free)
            for shift in (-1, 1):
                other = np.clip(taken + shift, 0, len(line) - 1)
                beside[other[line[other] == line[taken]]] = True
            free &= ~(beside & ~barge)
            beam = np.where(barge, 1.8, np.where(names == "motor_boat", 1.05, 0.75))
            xy = position + (beam + 0.35 + 0.4 * draw)[:, None] * right
            turned = (uniform(city.seed, f"{ACTION}/bow", own) < 0.5) * np.pi
            yaw = np.arctan2(ahead[:, 1], ahead[:, 0]) + np.pi / 2 + turned + 0.06 * (draw - 0.5)
        if where == "land":
            free &= ~in_carriageways(city, xy, np.full(len(xy), 0.45))
        group = replace(pieces(names, xy, own, yaw), scale=scale)
        found.append(group.take(free))
        level.append((water if where == "water" else land + (0.0 if inland else COPING_UP))[free])
    return join_pieces(found), np.concatenate([np.zeros(0), *level])


@action(
    ACTION,
    limits=[
        "Banks reach into the water and leave the shoreline of the map where it is.",
        "Boats are moored along quays only.",
    ],
    requires=("layout",),
    takes=(Port("ground", "surface", role="ground", optional=True),),
    gives=(Port("shores", "complex_geometry", "shores"),),
    labels=("quay", "shore", "river bank", "boats", "reeds", "waterfront"),
)
def shores(city: City) -> City:
    """Give water quays with coping and railing in town, banks with reeds elsewhere, and boats.

    Parameters
    ----------
    city
        City with its ground laid out and draped.
    """
    done = city.stages_done | {"nature"}
    city = replace(city, stages_done=done)
    ground = city.ground
    if city.lod < 2 or ground is None or "ground" not in city.scene.meshes:
        return city
    if not (ground.face_label == LABEL["water"]).any():
        return city
    shore = _shore(city, ground)
    batches = _copings(city, shore)
    slopes, growth, growth_level = _banks(city, shore)
    batches += slopes
    quays = shore.lines[shore.kind == "quay"]
    things, level = join_pieces([]), np.zeros(0)
    if len(quays):
        railed = _railed(city, quays)
        if railed.any():
            batches += _railings(city, quays[railed])
        things, level = _quayside(city, shore, quays, railed)
    if batches:
        city = replace(city, scene=city.scene.with_mesh("shores", joined_by_id(batches)))
    found, z = join_pieces([growth, things]), np.concatenate([growth_level, level])
    free = np.flatnonzero(may_stand(city, found))
    found, z = found.take(free), z[free]
    if not len(found):
        return city
    return with_pieces(city, LAYER, found, z)
