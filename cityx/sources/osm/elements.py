"""Nodes, ways and relations as arrays: sorted by id, each id once, references resolved to rows."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from cityx.geometry.arrays import FloatArray, IntArray
from cityx.sources.features.tagged import Tags

Member = tuple[str, int, str]  # "way", id, role

ID_LIMIT = 1 << 62  # ids beyond are damage; OSM is near 2^34


@dataclass(frozen=True)
class OsmMap:
    """Everything in a map file that is alive, n nodes, w ways, q relations.

    Attributes
    ----------
    node_id
        (n,) int64, ascending.
    lonlat
        (n, 2) float64, degrees.
    tagged, node_tags
        (t,) rows of the nodes with tags, and their tags.
    way_id
        (w,) int64, ascending.
    way_start
        (w + 1,) offsets into ``way_nodes``.
    way_nodes
        Node rows, -1 where the file lacks the node.
    way_closed
        (w,) bool, whether first and last reference are the same node.
    way_tags
        Tags of each way.
    relation_id, members, relation_tags
        The relations, ascending by id; members are (type, id, role).
    bounds
        (west, south, east, north) that the file declares, or None.
    skipped
        How many elements could not be used, by reason.
    """

    node_id: IntArray
    lonlat: FloatArray
    tagged: IntArray
    node_tags: list[Tags]
    way_id: IntArray
    way_start: IntArray
    way_nodes: IntArray
    way_closed: NDArray[np.bool_]
    way_tags: list[Tags]
    relation_id: list[int]
    members: list[list[Member]]
    relation_tags: list[Tags]
    bounds: tuple[float, float, float, float] | None
    skipped: Mapping[str, int]

    def way_row(self, way_id: int) -> int:
        """Return the row of a way, or -1."""
        row = int(np.searchsorted(self.way_id, way_id))
        return row if row < len(self.way_id) and self.way_id[row] == way_id else -1

    def missing_nodes(self) -> IntArray:
        """Return (w,) how many nodes each way refers to that the file lacks."""
        total = np.concatenate([[0], np.cumsum(self.way_nodes < 0)])
        return np.asarray(total[self.way_start[1:]] - total[self.way_start[:-1]], np.int64)

    def nodes_of(self, ways: ArrayLike) -> IntArray:
        """Return the distinct rows of the nodes of some ways, ascending."""
        flat = self.way_nodes[ragged_index(self.way_start, ways)[0]]
        return np.asarray(np.unique(flat[flat >= 0]), np.int64)


def ragged_index(start: IntArray, rows: ArrayLike) -> tuple[IntArray, IntArray]:
    """Return flat indices of some rows of a ragged array, and the position in `rows` of each."""
    rows = np.asarray(rows, np.int64)
    count = start[rows + 1] - start[rows]
    owner = np.repeat(np.arange(len(rows)), count)
    begin = np.cumsum(count) - count
    return np.arange(len(owner)) - begin[owner] + start[rows][owner], owner


_ATTRIBUTES = rb'((?: \w+="[^"<&]*")*%s)'
_PLAIN = rb'<node id="(-?\d{1,18})"%s lat="(-?\d[\d.]{0,30})" lon="(-?\d[\d.]{0,30})"%s ?/>'
_DOUBLE = _PLAIN % (_ATTRIBUTES % b"?", _ATTRIBUTES % b"")
# A node that has no tags, as every program writes it but for the quotes.
_PLAIN_NODE = (re.compile(_DOUBLE), re.compile(_DOUBLE.replace(b'"', b"'")))
_UNUSUAL = (b"action=", b'visible="false"', b"visible='false'")
_VERSION = re.compile(rb"version=.(-?\d+)")


class Collector:
    """Gathers elements in the order of the file; a class because a stream feeds it."""

    def __init__(self) -> None:
        self.node_id: list[int] = []
        self.lat: list[float] = []
        self.lon: list[float] = []
        self.node_version: list[str | tuple[bytes, ...]] = []
        self.node_tags: dict[int, Tags] = {}
        self.way_id: list[int] = []
        self.way_end: list[int] = []
        self.refs: list[int] = []
        self.way_version: list[int] = []
        self.way_tags: list[Tags] = []
        self.relation_id: list[int] = []
        self.relation_version: list[int] = []
        self.members: list[list[Member]] = []
        self.relation_tags: list[Tags] = []
        self.dead: dict[str, set[int]] = {"node": set(), "way": set(), "relation": set()}
        self.bounds: list[tuple[float, ...]] = []
        self.skipped: Counter[str] = Counter()
        self.start: Callable[[str, dict[str, str]], None] = self._handler()

    def _handler(self) -> Callable[[str, dict[str, str]], None]:
        """Return the callback for start tags; local names make it twice as fast as methods."""
        node_id, lat, lon, node_tags = self.node_id, self.lat, self.lon, self.node_tags
        refs, version = self.refs, self.node_version
        skipped = self.skipped
        tags: Tags | None = None  # of the open element, None before a node's first tag
        members: list[Member] = []
        inside = ""
        row = -1  # of the open node

        def start(name: str, given: dict[str, str]) -> None:
            nonlocal tags, members, inside, row
            try:
                if name == "nd":
                    if inside == "way":
                        refs.append(int(given["ref"]))
                elif name == "node":
                    inside = ""
                    key, y, x = int(given["id"]), float(given["lat"]), float(given["lon"])
                    if not (-90 <= y <= 90 and -180 <= x <= 180):
                        raise ValueError(name)
                    inside, tags, row = name, None, len(node_id)
                    node_id.append(key)
                    lat.append(y)
                    lon.append(x)
                    version.append(given.get("version", "0"))
                    if "visible" in given or "action" in given:
                        self._bury(name, given, row)
                elif name == "tag":
                    if tags is None:
                        if inside != "node":
                            return
                        tags = node_tags[row] = {}
                    tags[given["k"]] = given["v"]
                elif name == "member":
                    if inside == "relation":
                        members.append((given["type"], _id(given["ref"]), given.get("role", "")))
                elif name in ("way", "relation"):
                    inside, tags = "", {}
                    members = []
                    self._open(name, _id(given["id"]), _version(given), tags, members)
                    inside = name
                    self._bury(name, given, len(getattr(self, f"{name}_id")) - 1)
                elif name == "bounds":
                    inside = ""
                    keys = ("minlon", "minlat", "maxlon", "maxlat")
                    self.bounds.append(tuple(float(given[key]) for key in keys))
                else:
                    inside = inside if name in ("center", "meta", "note") else ""
            except (KeyError, ValueError):
                skipped[f"damaged <{name}>"] += 1
                if name in ("node", "way", "relation"):
                    inside, tags = "", {}
                    if name == "node":
                        self._lost_node(given)

        return start

    def _lost_node(self, given: Mapping[str, str]) -> None:
        """Record the deletion of a node, which often comes without a position."""
        try:
            key = _id(given["id"])
        except (KeyError, ValueError):
            return
        self.add_node(key, np.nan, np.nan, version=_version(given))
        if given.get("action") == "delete" or given.get("visible") == "false":
            self.skipped["damaged <node>"] -= 1
            self.dead["node"].add(len(self.node_id) - 1)

    def _open(self, kind: str, key: int, version: int, tags: Tags, members: list[Member]) -> None:
        if kind == "way":
            if self.way_id:
                self.way_end.append(len(self.refs))
            self.way_id.append(key)
            self.way_version.append(version)
            self.way_tags.append(tags)
        else:
            self.relation_id.append(key)
            self.relation_version.append(version)
            self.relation_tags.append(tags)
            self.members.append(members)

    def _bury(self, kind: str, given: Mapping[str, str], index: int) -> None:
        if given.get("visible") == "false" or given.get("action") == "delete":
            self.dead[kind].add(index)

    def add_node(
        self, key: int, lon: float, lat: float, tags: Tags | None = None, version: int = 0
    ) -> None:
        """Add a node."""
        self.node_id.append(key)
        self.lon.append(lon)
        self.lat.append(lat)
        self.node_version.append(str(version))
        if tags:
            self.node_tags[len(self.node_id) - 1] = tags

    def take_plain_nodes(self, block: bytes) -> bytes:
        """Take the nodes without tags out of a block of XML and return the rest of it.

        They are nine tenths of a map, and this reads them three times as fast as a parser that
        calls back. Whatever is written in another way stays in the block.
        """
        if any(word in block for word in _UNUSUAL):
            return block
        for pattern in _PLAIN_NODE:
            pieces = pattern.split(block)
            if len(pieces) > 1:
                lat, lon = list(map(float, pieces[3::6])), list(map(float, pieces[4::6]))
                if not (-90 <= min(lat) <= max(lat) <= 90 and -180 <= min(lon) <= max(lon) <= 180):
                    return block
                self.node_id += map(int, pieces[1::6])
                self.lat += lat
                self.lon += lon
                self.node_version += zip(pieces[2::6], pieces[5::6], strict=True)
                block = b"".join(pieces[::6])
        return block

    def add_way(self, key: int, refs: list[int], tags: Tags, version: int = 0) -> None:
        """Add a way with the ids of its nodes."""
        self._open("way", key, version, tags, [])
        self.refs.extend(refs)

    def add_relation(self, key: int, members: list[Member], tags: Tags, version: int = 0) -> None:
        """Add a relation."""
        self._open("relation", key, version, tags, members)

    def finish(self) -> OsmMap:
        """Sort by id, let the highest and last version win, drop the deleted, find references."""
        node_id = _int_array(self.node_id)
        lonlat = np.column_stack([np.array(self.lon), np.array(self.lat)]).reshape(-1, 2)
        lonlat[:, 0], bounds = _unwrapped(lonlat[:, 0], self.bounds)
        keep = self._alive("node", node_id, self.node_version)
        keep = keep[np.isfinite(lonlat[keep]).all(axis=1)]
        new_row = np.full(len(node_id), -1, np.int64)
        new_row[keep] = np.arange(len(keep))
        tags = {int(new_row[i]): found for i, found in self.node_tags.items() if new_row[i] >= 0}
        tagged = sorted(tags)
        sorted_ids = node_id[keep]

        start = np.array([0, *self.way_end, len(self.refs)] if self.way_id else [0], np.int64)
        way_id = np.array(self.way_id, np.int64)
        ways = self._alive("way", way_id, self.way_version)
        flat, owner = ragged_index(start, ways)
        refs = _int_array(self.refs)[flat]
        way_start = np.concatenate([[0], np.cumsum(np.bincount(owner, minlength=len(ways)))])
        relations = self._alive(
            "relation", np.array(self.relation_id, np.int64), self.relation_version
        ).tolist()
        return OsmMap(
            sorted_ids,
            lonlat[keep],
            np.array(tagged, np.int64),
            [tags[row] for row in tagged],
            way_id[ways],
            way_start.astype(np.int64),
            _rows_of(refs, sorted_ids),
            _closed(refs, way_start),
            [self.way_tags[row] for row in ways.tolist()],
            [self.relation_id[row] for row in relations],
            [self.members[row] for row in relations],
            [self.relation_tags[row] for row in relations],
            _joined(bounds),
            {reason: count for reason, count in sorted(self.skipped.items()) if count > 0},
        )

    def _alive(
        self, kind: str, ids: IntArray, versions: Sequence[str | int | tuple[bytes, ...]]
    ) -> IntArray:
        """Return the positions to keep, ascending by id."""
        order = np.argsort(ids, kind="stable")
        if np.any(ids[order][1:] == ids[order][:-1]):
            version = np.array([_version_of(held) for held in versions], np.int64)
            order = np.lexsort((np.arange(len(ids)), version, ids))
            last = np.ones(len(ids), bool)
            last[:-1] = ids[order][1:] != ids[order][:-1]
            self.skipped[f"superseded <{kind}>"] += int((~last).sum())
            order = order[last]
        dead = self.dead[kind]
        if dead:
            order = order[~np.isin(order, np.fromiter(dead, np.int64, len(dead)))]
        return np.asarray(order, np.int64)


def _id(text: str) -> int:
    value = int(text)
    if not -ID_LIMIT < value < ID_LIMIT:
        raise ValueError(text)
    return value


def _int_array(values: list[int]) -> IntArray:
    """Return ids as an array; those no database can hold become one that is never referred to."""
    try:
        return np.array(values, np.int64)
    except OverflowError:
        return np.array([v if abs(v) < ID_LIMIT else -ID_LIMIT for v in values], np.int64)


def _version_of(held: str | int | tuple[bytes, ...]) -> int:
    """Return the version of an element from a number, its text or the attributes with it."""
    if isinstance(held, tuple):
        found = _VERSION.search(b" ".join(held))
        held = found[1].decode() if found else "0"
    return _version({"version": str(held)})


def _version(given: Mapping[str, str]) -> int:
    try:
        return _id(given["version"])
    except (KeyError, ValueError):
        return 0


def _rows_of(refs: IntArray, ids: IntArray) -> IntArray:
    if len(ids) == 0:
        return np.full(len(refs), -1, np.int64)
    row = np.minimum(np.searchsorted(ids, refs), len(ids) - 1)
    return np.where(ids[row] == refs, row, -1)


def _closed(refs: IntArray, start: IntArray) -> NDArray[np.bool_]:
    count = np.diff(start)
    closed = np.zeros(len(count), bool)
    rows = np.flatnonzero(count >= 4)
    closed[rows] = refs[start[rows]] == refs[start[rows + 1] - 1]
    return closed


def _unwrapped(
    longitude: FloatArray, bounds: list[tuple[float, ...]]
) -> tuple[FloatArray, list[tuple[float, ...]]]:
    """Turn longitudes, and those of bounds, to within half a turn of the map's middle node.

    A map on both sides of 180 degrees is one piece then, partly beyond 180 or -180. Bounds that
    were taken there as the least and the greatest longitude span the Earth; they are left out.
    """
    known = longitude[np.isfinite(longitude)]
    if not len(known):
        return longitude, bounds
    middle = float(np.partition(known, len(known) // 2)[len(known) // 2])
    turns = np.round((middle - longitude) / 360.0)
    split = bool((turns[np.isfinite(turns)] != 0).any())
    found = [
        (*_near(west, east, middle), south, north) if split or west > east else
        (west, east, south, north)
        for west, south, east, north in bounds
        if max(abs(west), abs(east)) <= 180.0
    ]  # fmt: skip
    ordered: list[tuple[float, ...]] = [
        (west, south, east, north) for west, east, south, north in found
    ]
    turned: FloatArray = longitude + 360.0 * turns if split else longitude
    return turned, ordered


def _near(west: float, east: float, middle: float) -> tuple[float, float]:
    """Return two longitudes, each within half a turn of a third."""
    west, east = (lon + 360.0 * round((middle - lon) / 360.0) for lon in (west, east))
    return west, east


def _joined(bounds: list[tuple[float, ...]]) -> tuple[float, float, float, float] | None:
    sane = [
        (west, south, east, north)
        for west, south, east, north in bounds
        if west < east and -90 <= south < north <= 90
    ]
    if not sane:
        return None
    west, south, east, north = zip(*sane, strict=True)
    return min(west), min(south), max(east), max(north)


def way_lines(osm: OsmMap, xy: FloatArray, ways: ArrayLike) -> tuple[NDArray[Any], IntArray]:
    """Return the lines of some ways, broken where nodes are missing, and their index in `ways`.

    Repeated points are dropped, and so is what has fewer than two points then.
    """
    flat, owner = ragged_index(osm.way_start, ways)
    node = osm.way_nodes[flat]
    present = node >= 0
    # A run ends where the way ends or a node is missing.
    gap = np.cumsum(~present)
    same = np.zeros(len(node), bool)
    same[1:] = (owner[1:] == owner[:-1]) & (gap[1:] == gap[:-1])
    run = np.cumsum(~same)[present]
    node, owner = node[present], owner[present]
    points = xy[node]
    repeated = np.zeros(len(node), bool)
    repeated[1:] = (run[1:] == run[:-1]) & (points[1:] == points[:-1]).all(axis=1)
    points, run, owner = points[~repeated], run[~repeated], owner[~repeated]
    long_enough = np.bincount(run, minlength=1)[run] >= 2
    points, run, owner = points[long_enough], run[long_enough], owner[long_enough]
    if len(points) == 0:
        return np.zeros(0, object), np.zeros(0, np.int64)
    first = np.ones(len(run), bool)
    first[1:] = run[1:] != run[:-1]
    lines = shapely.linestrings(points, indices=np.cumsum(first) - 1)
    return lines, owner[first]


def way_polygons(osm: OsmMap, xy: FloatArray, ways: ArrayLike) -> NDArray[Any]:
    """Return a polygon per way through the nodes that are there; None for fewer than three."""
    ways = np.asarray(ways, np.int64)
    found = np.full(len(ways), None, object)
    flat, owner = ragged_index(osm.way_start, ways)
    node = osm.way_nodes[flat]
    node, owner = node[node >= 0], owner[node >= 0]
    points = xy[node]
    repeated = np.zeros(len(node), bool)
    repeated[1:] = (owner[1:] == owner[:-1]) & (points[1:] == points[:-1]).all(axis=1)
    points, owner = points[~repeated], owner[~repeated]
    # The closing point is dropped here and set again below, so that open rings close too.
    edge = np.flatnonzero(np.diff(owner, prepend=-1, append=len(ways)))
    begin, end = edge[:-1], edge[1:] - 1
    closing = end[(points[begin] == points[end]).all(axis=1) & (end > begin)]
    kept = np.ones(len(points), bool)
    kept[closing] = False
    points, owner = points[kept], owner[kept]
    enough = np.bincount(owner, minlength=max(len(ways), 1))[owner] >= 3
    points, owner = points[enough], owner[enough]
    if len(points) == 0:
        return found
    first = np.ones(len(owner), bool)
    first[1:] = owner[1:] != owner[:-1]
    begin = np.flatnonzero(first)
    count = np.diff(np.append(begin, len(owner)))
    order = np.insert(np.arange(len(owner)), begin + count, begin)
    rings = shapely.linearrings(points[order], indices=np.repeat(np.arange(len(begin)), count + 1))
    found[owner[begin]] = shapely.polygons(rings)
    return found
