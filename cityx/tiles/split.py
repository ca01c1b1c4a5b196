"""Splitting a map: each tile gets the elements that can decide anything in it.

A fragment holds whole ways and whole multipolygons, so that reading it within the box of a tile
and its margin gives what reading the whole map within that box does.
"""

from __future__ import annotations

import json
import zipfile
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cityx.city import Frame
from cityx.city.terrain import Terrain
from cityx.errors import InputError
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.sources.features.clipping import LARGEST, MARGIN
from cityx.sources.features.kinds import building_kind
from cityx.sources.features.tagged import Report
from cityx.sources.osm.areas import candidate_ways
from cityx.sources.osm.elements import OsmMap, ragged_index
from cityx.sources.osm.outlines import relation_rings
from cityx.system.packed import read_arrays, write_arrays
from cityx.tiles.grid import Box
from cityx.tiles.relief import packed as packed_relief
from cityx.tiles.relief import unpacked as unpacked_relief

WHOLE = ("multipolygon", "building")  # relations that are read with all of their ways
READ = (*WHOLE, "restriction")  # the reader knows no others
SPARE = 1.0  # metres; nothing is lost by rounding
NOWHERE = (np.inf, np.inf, -np.inf, -np.inf)
_ARRAYS = ("node_id", "lonlat", "tagged", "way_id", "way_start", "way_nodes", "way_closed")


@dataclass(frozen=True)
class Survey:
    """Where the elements of a map lie, in metres of a frame.

    Attributes
    ----------
    osm
        The map, n nodes, w ways, q relations.
    xy
        (n, 2) places of the nodes.
    ways, relations
        (w, 4) and (q, 4) bounds; those of nothing are infinite.
    solid
        (b, 4) bounds of what may be a building.
    """

    osm: OsmMap
    xy: FloatArray
    ways: FloatArray
    relations: FloatArray
    solid: FloatArray


def surveyed(osm: OsmMap, frame: Frame) -> Survey:
    """Find where the elements of a map lie."""
    xy = frame.to_local(osm.lonlat) if len(osm.lonlat) else np.zeros((0, 2))
    xy = np.where(np.isfinite(xy).all(axis=1, keepdims=True), xy, 1e8)
    ways = _bounds(xy, osm.way_nodes, osm.way_start)
    relations = np.array(
        [_around([*_of_members(osm, row, ways, xy)]) for row in range(len(osm.relation_id))]
    ).reshape(-1, 4)
    rings = relation_rings(osm, building_kind, Report())[0]
    found = [ways[np.concatenate(candidate_ways(osm))]]
    found += [_around(ways[ring.ways])[None] for ring in rings]
    solid = np.concatenate(found)
    wide = (solid[:, 2:] - solid[:, :2]).max(axis=1, initial=-np.inf)
    return Survey(osm, xy, ways, relations, solid[(wide >= 0) & (wide <= LARGEST)])


def _bounds(xy: FloatArray, nodes: IntArray, start: IntArray) -> FloatArray:
    """(w, 4) bounds of runs of nodes; a missing node, -1, has no place."""
    count = len(start) - 1
    bounds = np.tile(np.array(NOWHERE), (max(count, 0), 1))
    if not len(nodes):
        return bounds
    owner = np.repeat(np.arange(count), np.diff(start))
    there = nodes >= 0
    places, owner = xy[nodes[there]], owner[there]
    np.minimum.at(bounds[:, :2], owner, places)
    np.maximum.at(bounds[:, 2:], owner, places)
    return bounds


def _of_members(osm: OsmMap, row: int, ways: FloatArray, xy: FloatArray) -> list[FloatArray]:
    """Return the bounds of the members of a relation, of those kinds that are read."""
    if osm.relation_tags[row].get("type") not in READ:
        return []
    rows = [osm.way_row(ref) for kind, ref, _ in osm.members[row] if kind == "way"]
    found = [ways[way] for way in rows if way >= 0]
    for node in _nodes_in(osm, osm.members[row]):
        found.append(np.concatenate([xy[node], xy[node]]))
    return found


def _nodes_in(osm: OsmMap, members: Sequence[tuple[str, int, str]]) -> list[int]:
    refs = np.array([ref for kind, ref, _ in members if kind == "node"], np.int64)
    if not len(refs) or not len(osm.node_id):
        return []
    rows = np.minimum(np.searchsorted(osm.node_id, refs), len(osm.node_id) - 1)
    return [int(row) for row in rows[osm.node_id[rows] == refs]]


def _around(boxes: Any) -> FloatArray:
    boxes = np.asarray(boxes, float).reshape(-1, 4)
    if not len(boxes):
        return np.array(NOWHERE)
    return np.concatenate([boxes[:, :2].min(axis=0), boxes[:, 2:].max(axis=0)])


def _touching(bounds: FloatArray, box: Box) -> NDArray[np.bool_]:
    return np.asarray(
        (bounds[:, 0] <= box[2]) & (bounds[:, 2] >= box[0])
        & (bounds[:, 1] <= box[3]) & (bounds[:, 3] >= box[1])
    )  # fmt: skip


def fragment_of(survey: Survey, box: Box) -> OsmMap:
    """Return the part of a map that decides what lies in a box, metres.

    The box grows by the buildings that cross its border, as a site does.
    """
    osm = survey.osm
    crossing = survey.solid[_touching(survey.solid, box)]
    around = _around([np.array(box), *crossing]) + (MARGIN + SPARE) * np.array([-1, -1, 1, 1])
    box = (float(around[0]), float(around[1]), float(around[2]), float(around[3]))
    kept = _touching(survey.ways, box)
    relations = np.flatnonzero(_touching(survey.relations, box)).tolist()
    nodes = np.zeros(len(osm.node_id), bool)
    for row in relations:
        if osm.relation_tags[row].get("type") in WHOLE:
            ways = [osm.way_row(ref) for kind, ref, _ in osm.members[row] if kind == "way"]
            kept[[way for way in ways if way >= 0]] = True
        nodes[_nodes_in(osm, osm.members[row])] = True
    spots = survey.xy[osm.tagged]
    nodes[osm.tagged[((spots >= box[:2]) & (spots <= box[2:])).all(axis=1)]] = True
    return _part(osm, nodes, np.flatnonzero(kept), relations)


def _part(osm: OsmMap, nodes: NDArray[np.bool_], ways: IntArray, relations: list[int]) -> OsmMap:
    """Return some elements of a map, with all nodes of the ways."""
    nodes = nodes.copy()
    nodes[osm.nodes_of(ways)] = True
    rows = np.flatnonzero(nodes)
    place = np.full(len(nodes) + 1, -1, np.int64)  # the last stands for a missing node
    place[rows] = np.arange(len(rows))
    flat, _ = ragged_index(osm.way_start, ways)
    counts = osm.way_start[ways + 1] - osm.way_start[ways]
    told = nodes[osm.tagged]
    return OsmMap(
        osm.node_id[rows],
        osm.lonlat[rows],
        place[osm.tagged[told]],
        [osm.node_tags[index] for index in np.flatnonzero(told).tolist()],
        osm.way_id[ways],
        np.concatenate([[0], np.cumsum(counts)]).astype(np.int64),
        place[osm.way_nodes[flat]],
        osm.way_closed[ways],
        [osm.way_tags[way] for way in ways.tolist()],
        [osm.relation_id[row] for row in relations],
        [osm.members[row] for row in relations],
        [osm.relation_tags[row] for row in relations],
        None,
        {},
    )


def merged(one: OsmMap, other: OsmMap) -> OsmMap:
    """Return what two fragments of one map hold, each element once."""
    parts = (one, other)
    node_id, first = np.unique(np.concatenate([p.node_id for p in parts]), return_index=True)
    lonlat = np.concatenate([p.lonlat for p in parts])[first]
    tags: dict[int, Any] = {}
    for part in parts:
        tags |= dict(zip(part.node_id[part.tagged].tolist(), part.node_tags, strict=True))
    told = sorted(tags)
    way_id, way = np.unique(np.concatenate([p.way_id for p in parts]), return_index=True)
    refs = np.concatenate(
        [np.where(p.way_nodes < 0, -1, p.node_id[p.way_nodes]) if len(p.node_id)
         else p.way_nodes for p in parts]
    )  # fmt: skip
    start = np.concatenate([one.way_start, one.way_start[-1] + other.way_start[1:]])
    flat, _ = ragged_index(start, way)
    counts = np.diff(start)[way]
    rows = np.searchsorted(node_id, refs[flat])
    way_tags = [*one.way_tags, *other.way_tags]
    relations: dict[int, tuple[Any, Any]] = {}
    for part in parts:
        held = zip(part.relation_id, part.members, part.relation_tags, strict=True)
        relations |= {key: (members, own) for key, members, own in held}
    known = sorted(relations)
    return OsmMap(
        node_id, lonlat, np.searchsorted(node_id, np.array(told, np.int64)),
        [tags[key] for key in told], way_id,
        np.concatenate([[0], np.cumsum(counts)]).astype(np.int64),
        np.where(refs[flat] < 0, -1, rows).astype(np.int64),
        np.concatenate([p.way_closed for p in parts])[way],
        [way_tags[row] for row in way.tolist()], known, [relations[key][0] for key in known],
        [relations[key][1] for key in known], None, {},
    )  # fmt: skip


def is_empty(osm: OsmMap) -> bool:
    """Return whether a fragment holds nothing that could be built."""
    return not (any(osm.way_tags) or osm.relation_id or len(osm.tagged))


def write_fragment(
    osm: OsmMap, coverage: Mapping[str, float], path: Path, terrain: Terrain | None = None
) -> None:
    """Write a fragment; the same elements give the same bytes.

    Parameters
    ----------
    coverage
        Of the roads of the whole map (`cityx.sources.osm.coverage_of`).
    terrain
        Under the window, if the run has heights.
    """
    names = [f"osm/way/{key}" for key in osm.way_id.tolist()]
    own = {name: coverage[name] for name in names if name in coverage}
    texts = [own, osm.node_tags, osm.way_tags, osm.relation_id, osm.members, osm.relation_tags]
    packed = zlib.compress(json.dumps(texts, ensure_ascii=False).encode(), 6)
    arrays = {name: getattr(osm, name) for name in _ARRAYS}
    relief = {} if terrain is None else packed_relief(terrain)
    write_arrays(path, {**arrays, "texts": np.frombuffer(packed, np.uint8), **relief})


def read_fragment(path: Path) -> tuple[OsmMap, dict[str, float], Terrain | None]:
    """Read a fragment: its elements, the coverage of its roads, the terrain of a run with heights.

    Raises
    ------
    InputError
        If it is missing or damaged.
    """
    try:
        held = read_arrays(path, checked=True)
        packed = np.asarray(held["texts"]).tobytes()
        coverage, node_tags, way_tags, ids, members, tags = json.loads(zlib.decompress(packed))
        arrays = {name: np.asarray(held[name]) for name in _ARRAYS}
        terrain = unpacked_relief(held)
    except (InputError, OSError, ValueError, KeyError, zlib.error, zipfile.BadZipFile) as error:
        raise InputError(f"{path} is damaged ({error}); build the tiles anew.") from error
    told = [[(str(kind), int(ref), str(role)) for kind, ref, role in own] for own in members]
    osm = OsmMap(
        arrays["node_id"], arrays["lonlat"], arrays["tagged"], node_tags, arrays["way_id"],
        arrays["way_start"], arrays["way_nodes"], arrays["way_closed"], way_tags, ids, told, tags,
        None, {},
    )  # fmt: skip
    return osm, coverage, terrain
