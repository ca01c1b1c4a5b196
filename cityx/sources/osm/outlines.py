"""Outlines: the polygons of closed ways and of multipolygon relations, with their tags."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.identity import stable_id
from cityx.sources.osm.elements import FloatArray, IntArray, OsmMap, Tags, way_lines, way_polygons
from cityx.sources.osm.multipolygons import (
    MIN_AREA,
    MIN_SOLID,
    assemble,
    close_along,
    close_straight,
    open_ends,
    polygons_of,
)
from cityx.sources.osm.site import Box, clip_polygons
from cityx.sources.osm.vocabulary import is_water

# Tags of a relation that say nothing about what it encloses.
_EMPTY_TAGS = frozenset({
    "type", "source", "created_by", "note", "fixme", "FIXME", "name", "comment", "attribution",
    "area", "source:date", "description",
})  # fmt: skip
NOTHING: NDArray[Any] = np.zeros(0, object)


@dataclass(frozen=True)
class Owner:
    """An element that owns outlines.

    Attributes
    ----------
    kind
        "way", "relation" or "node".
    more
        What tells a thing made of the element from the element itself, part of its id.
    """

    kind: str
    osm_id: int
    tags: Tags
    more: tuple[str, ...] = ()

    @property
    def source(self) -> str:
        """Provenance as the tables write it."""
        return f"osm/{self.kind}/{self.osm_id}"

    def id(self, *more: object) -> int:
        """Return the stable id of the element, or of a thing that belongs to it."""
        return stable_id("osm", self.kind, self.osm_id, *self.more, *more)

    def numbered(self, k: int, *more: object) -> int:
        """Return the id of its k-th piece; the first has the element's own id."""
        return self.id(*more, k) if k else self.id(*more)


@dataclass(frozen=True)
class Outlines:
    """Polygons and who owns them, n polygons.

    Attributes
    ----------
    polygons
        (n,) valid.
    owner
        (n,) index into ``owners``.
    k
        (n,) number of the polygon among those of its owner.
    """

    polygons: NDArray[Any]
    owner: IntArray
    k: IntArray
    owners: list[Owner]

    def take(self, rows: Any) -> Outlines:
        """Return some of the polygons."""
        return Outlines(self.polygons[rows], self.owner[rows], self.k[rows], self.owners)

    def tags(self) -> list[Tags]:
        """(n,) tags of each polygon's owner."""
        return [self.owners[index].tags for index in self.owner.tolist()]

    def ids(self, *more: object) -> NDArray[np.uint64]:
        """(n,) stable ids."""
        pairs = zip(self.owner.tolist(), self.k.tolist(), strict=True)
        found = [self.owners[owner].numbered(k, *more) for owner, k in pairs]
        return np.array(found, np.uint64)

    def sources(self) -> list[str]:
        """(n,) provenance."""
        return [self.owners[index].source for index in self.owner.tolist()]


@dataclass(frozen=True)
class Ring:
    """Ways that together enclose something.

    Attributes
    ----------
    ways
        Rows of the member ways.
    broken
        Whether the file lacks members.
    """

    owner: Owner
    ways: list[int]
    broken: bool


@dataclass
class Report:
    """What could not be used, counted and named while a map is read."""

    counts: dict[str, int] = field(default_factory=dict)
    failures: list[tuple[int, str]] = field(default_factory=list)

    def count(self, what: str, number: int = 1) -> None:
        """Count something."""
        if number:
            self.counts[what] = self.counts.get(what, 0) + number

    def fail(self, object_id: int, why: str) -> None:
        """Name an object that could not be read."""
        self.failures.append((object_id, why))


def number_pieces(owner: IntArray) -> IntArray:
    """Count the rows of each owner from zero in their order; `owner` is ascending."""
    first = np.ones(len(owner), bool)
    first[1:] = owner[1:] != owner[:-1]
    begin = np.flatnonzero(first)
    return np.arange(len(owner)) - np.repeat(begin, np.diff(np.append(begin, len(owner))))


def relation_rings(osm: OsmMap, meaning: Callable[[Tags], str]) -> tuple[list[Ring], set[int]]:
    """Return the multipolygon relations with a meaning, and the ways they speak for.

    A relation without tags of its own takes those of its outer way, as was the custom until 2017.

    Parameters
    ----------
    meaning
        Category of tags, or "".

    Returns
    -------
    rings
        One per relation.
    spoken
        Rows of the ways whose outline the relation gives better.
    """
    rings, spoken = [], set()
    for row, tags in enumerate(osm.relation_tags):
        if tags.get("type") != "multipolygon":
            continue
        members = [
            (osm.way_row(ref), role) for kind, ref, role in osm.members[row] if kind == "way"
        ]
        ways = sorted({way for way, _ in members if way >= 0})
        outer = sorted({way for way, role in members if way >= 0 and role != "inner"})
        found = meaning(tags)
        if not found and _EMPTY_TAGS.issuperset(tags):
            lender = next((way for way in outer if meaning(osm.way_tags[way])), None)
            if lender is not None:
                tags = osm.way_tags[lender] | tags | {"type": "multipolygon"}
                found = meaning(tags)
        if not found or not ways:
            continue
        spoken |= {way for way in outer if meaning(osm.way_tags[way]) == found}
        broken = any(way < 0 for way, _ in members)
        rings.append(Ring(Owner("relation", osm.relation_id[row], tags), ways, broken))
    return rings, spoken


def ring_outlines(
    osm: OsmMap,
    xy: FloatArray,
    rings: list[Ring],
    box: Box,
    report: Report,
    *,
    solid: bool,
    avoid: NDArray[Any] = NOTHING,
) -> Outlines:
    """Build the polygons of relations; what does not close is closed along the site's border.

    Parameters
    ----------
    box
        The site.
    solid
        Whether these are buildings, whose outlines may be closed straight and are never clipped.
    avoid
        Points of buildings, which do not stand in water; see `close_along`.
    """
    owners = [ring.owner for ring in rings]
    if not rings:
        none = np.zeros(0, np.int64)
        return Outlines(np.zeros(0, object), none, none, owners)
    flat = np.array([way for ring in rings for way in ring.ways], np.int64)
    ring_of = np.repeat(np.arange(len(rings)), [len(ring.ways) for ring in rings])
    lines, index = way_lines(osm, xy, flat)
    owner = ring_of[index]
    built = assemble(lines, owner, len(rings))
    missing = osm.missing_nodes()
    for row, ring in enumerate(rings):
        own = lines[owner == row]
        whole = not ring.broken and not any(missing[way] for way in ring.ways)
        if whole and not open_ends(own):
            continue
        points = avoid if is_water(ring.owner.tags) else NOTHING
        built[row] = _mended(built[row], own, box, points, solid=solid)
        empty = built[row] is None or shapely.area(built[row]) <= 1.0
        report.count("multipolygons with missing members")
        if empty and _near(own, box):
            report.fail(ring.owner.id(), "the outline is not closed; it was left out")
    polygons, row_of = polygons_of(built, least=MIN_SOLID if solid else MIN_AREA)
    return Outlines(polygons, row_of, number_pieces(row_of), owners)


def _near(lines: NDArray[Any], box: Box) -> bool:
    return bool(len(lines)) and bool(shapely.intersects(lines, shapely.box(*box)).any())


def _mended(built: Any, lines: NDArray[Any], box: Box, avoid: NDArray[Any], *, solid: bool) -> Any:
    """Add to what closes by itself what closes along the border or, for buildings, straight."""
    if len(lines) == 0:
        return built
    whole = None if shapely.is_empty(built) or built is None else shapely.make_valid(built)
    if solid:
        return close_straight(lines) if whole is None else whole
    if not _near(lines, box):
        return whole
    closed = close_along(lines, box, avoid)
    if closed is None or shapely.is_empty(closed):
        return whole
    return closed


def way_outlines(
    osm: OsmMap,
    xy: FloatArray,
    ways: IntArray,
    box: Box,
    report: Report,
    *,
    solid: bool,
    avoid: NDArray[Any] = NOTHING,
) -> Outlines:
    """Build the polygons of closed ways.

    A building is closed through the nodes that are there. Any other outline with missing nodes is
    closed along the site's border.
    """
    owners = [Owner("way", int(osm.way_id[way]), osm.way_tags[way]) for way in ways.tolist()]
    shapes = way_polygons(osm, xy, ways)
    missing = osm.missing_nodes()[ways] > 0
    report.count("outlines with missing nodes", int(missing.sum()))
    for row in np.flatnonzero(shapely.is_missing(shapes)).tolist() if solid else ():
        report.fail(owners[row].id(), "fewer than three of its nodes are in the file; left out")
    for row in np.flatnonzero(missing).tolist() if not solid else ():
        lines = way_lines(osm, xy, ways[row : row + 1])[0]
        if _near(lines, box):
            points = avoid if is_water(owners[row].tags) else NOTHING
            shapes[row] = close_along(lines, box, points)
        else:
            shapes[row] = None
    polygons, row_of = polygons_of(shapes, least=MIN_SOLID if solid else MIN_AREA)
    lost = np.setdiff1d(np.flatnonzero(~shapely.is_missing(shapes)), row_of)
    for row in lost.tolist() if solid else ():
        report.fail(owners[row].id(), "its outline encloses no area; left out")
    return Outlines(polygons, row_of, number_pieces(row_of), owners)


def join_outlines(*given: Outlines) -> Outlines:
    """Put outlines together."""
    shift = np.cumsum([0, *(len(item.owners) for item in given)])
    return Outlines(
        np.concatenate([item.polygons for item in given]),
        np.concatenate([item.owner + shift[i] for i, item in enumerate(given)]).astype(np.int64),
        np.concatenate([item.k for item in given]).astype(np.int64),
        [owner for item in given for owner in item.owners],
    )


def clipped(outlines: Outlines, box: Box) -> Outlines:
    """Cut outlines at the border of the site."""
    polygons, row = polygons_of(clip_polygons(outlines.polygons, box))
    owner = outlines.owner[row]
    order = np.lexsort((np.arange(len(owner)), outlines.k[row], owner))
    return Outlines(polygons[order], owner[order], number_pieces(owner[order]), outlines.owners)
