"""Outlines: the polygons of closed ways and of multipolygon relations, with their tags."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.arrays import FloatArray, IntArray
from cityx.sources.features.clipping import Box
from cityx.sources.features.tagged import (
    MIN_AREA,
    MIN_SOLID,
    Owner,
    Report,
    Tagged,
    Tags,
    number_pieces,
    polygons_of,
)
from cityx.sources.features.vocabulary import is_water
from cityx.sources.osm.elements import OsmMap, way_lines, way_polygons

# Tags of a relation that say nothing about what it encloses.
_EMPTY_TAGS = frozenset({
    "type", "source", "created_by", "note", "fixme", "FIXME", "name", "comment", "attribution",
    "area", "source:date", "description",
})  # fmt: skip
NOTHING: NDArray[Any] = np.zeros(0, object)
MAX_AVOIDED = 2  # a jetty or a boathouse may stand in water
MAX_GAP_SHARE = 0.5  # of its length, how far the ends of a building's outline may lie apart


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


def way_owner(osm: OsmMap, way: int) -> Owner:
    """Return the owner of what a way stands for."""
    return Owner(("osm", "way", int(osm.way_id[way])), osm.way_tags[way])


def tagged_owners(osm: OsmMap) -> Iterator[Owner]:
    """Yield the owner of every way and relation with tags."""
    yield from (way_owner(osm, way) for way, tags in enumerate(osm.way_tags) if tags)
    for ident, tags in zip(osm.relation_id, osm.relation_tags, strict=True):
        if tags:
            yield Owner(("osm", "relation", int(ident)), tags)


def tagged_lines(osm: OsmMap, xy: FloatArray, ways: IntArray) -> Tagged:
    """Return ways as lines, broken where the file lacks nodes."""
    lines, index = way_lines(osm, xy, ways)
    return Tagged(
        lines, index, number_pieces(index), [way_owner(osm, way) for way in ways.tolist()]
    )


def relation_rings(
    osm: OsmMap, meaning: Callable[[Tags], str], report: Report
) -> tuple[list[Ring], set[int]]:
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
        if not found:
            continue
        owner = Owner(("osm", "relation", osm.relation_id[row]), tags)
        if not ways:
            report.name("multipolygons have no member in the file and were left out", owner)
            continue
        spoken |= {
            way for way in outer
            if meaning(osm.way_tags[way]) == found and not _says_more(osm, way, tags)
        }  # fmt: skip
        broken = any(way < 0 for way, _ in members)
        rings.append(Ring(owner, ways, broken))
    return rings, spoken


def _says_more(osm: OsmMap, way: int, tags: Tags) -> bool:
    """Return whether a closed way is called otherwise than the relation whose outline it is in."""
    own = osm.way_tags[way]
    return bool(osm.way_closed[way]) and "name" in own and own["name"] != tags.get("name")


def ring_outlines(
    osm: OsmMap,
    xy: FloatArray,
    rings: list[Ring],
    box: Box,
    report: Report,
    *,
    solid: bool,
    avoid: NDArray[Any] = NOTHING,
) -> Tagged:
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
        return Tagged(np.zeros(0, object), none, none, owners)
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
            if built[row] is None or shapely.is_empty(built[row]):
                # Ways of one ring that run over each other enclose what their pieces enclose.
                faces = shapely.polygonize(shapely.get_parts(shapely.union_all(own)))
                built[row] = shapely.union_all(shapely.get_parts(faces))
                report.name("outlines cross or touch themselves and were mended", ring.owner)
            continue
        points = avoid if is_water(ring.owner.tags) else NOTHING
        built[row] = _mended(built[row], own, box, points, solid=solid)
        empty = built[row] is None or shapely.area(built[row]) <= 1.0
        report.name("multipolygons with missing members", ring.owner)
        if empty and _near(own, box):
            report.fail(ring.owner.id(), "the outline is not closed; it was left out")
    polygons, row_of = polygons_of(built, least=MIN_SOLID if solid else MIN_AREA)
    return Tagged(polygons, row_of, number_pieces(row_of), owners)


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
) -> Tagged:
    """Build the polygons of closed ways.

    A building is closed through the nodes that are there. Any other outline that is open or has
    missing nodes is closed along the site's border.
    """
    owners = [way_owner(osm, way) for way in ways.tolist()]
    shapes = way_polygons(osm, xy, ways)
    missing = osm.missing_nodes()[ways] > 0
    for row in np.flatnonzero(missing).tolist():
        report.name("outlines with missing nodes", owners[row])
    if not solid:
        for row in np.flatnonzero(~osm.way_closed[ways] & ~missing).tolist():
            report.name("outlines of land are open and count as far as the border closes them",
                        owners[row])  # fmt: skip
        missing |= ~osm.way_closed[ways]
    for row in np.flatnonzero(shapely.is_missing(shapes)).tolist() if solid else ():
        report.fail(owners[row].id(), "fewer than three of its nodes are in the file; left out")
    for row in np.flatnonzero(missing).tolist() if not solid else ():
        lines = way_lines(osm, xy, ways[row : row + 1])[0]
        if _near(lines, box):
            points = avoid if is_water(owners[row].tags) else NOTHING
            shapes[row] = close_along(lines, box, points)
        else:
            shapes[row] = None
    if solid:
        crossed = ~shapely.is_missing(shapes) & ~shapely.is_valid(shapes)
        for row in np.flatnonzero(crossed).tolist():
            report.name("outlines cross or touch themselves and were mended", owners[row])
        for row in np.flatnonzero(~osm.way_closed[ways] & ~missing).tolist():
            report.name("outlines are not closed and were closed straight", owners[row])
    polygons, row_of = polygons_of(shapes, least=MIN_SOLID if solid else MIN_AREA)
    lost = np.setdiff1d(np.flatnonzero(~shapely.is_missing(shapes)), row_of)
    for row in lost.tolist() if solid else ():
        report.fail(owners[row].id(), "its outline encloses no area; left out")
    return Tagged(polygons, row_of, number_pieces(row_of), owners)


def assemble(lines: NDArray[Any], owner: IntArray, count: int) -> NDArray[Any]:
    """Build the area that the lines of each of `count` owners enclose, even-odd, in bulk."""
    built = np.full(count, None, object)
    if len(lines) == 0:
        return built
    order = np.argsort(owner, kind="stable")
    rows, index = np.unique(owner[order], return_inverse=True)
    collections = shapely.geometrycollections(lines[order], indices=index)
    built[rows] = shapely.build_area(collections)
    return built


def open_ends(lines: NDArray[Any]) -> list[tuple[float, float]]:
    """Return the points where an odd number of lines end, sorted."""
    ends: Counter[tuple[float, float]] = Counter()
    for line in lines:
        points = shapely.get_coordinates(line)
        ends[tuple(points[0].tolist())] += 1
        ends[tuple(points[-1].tolist())] += 1
    return sorted(point for point, number in ends.items() if number % 2)


def close_along(
    lines: NDArray[Any], box: tuple[float, float, float, float], avoid: NDArray[Any]
) -> Any:
    """Close lines that leave the site along its border, and build the area they enclose.

    The border is cut where the lines meet it; its pieces are alternately inside and outside. Of
    the two possibilities the one with fewer points to avoid is taken, then the one with the
    shorter border. Lines that end within the site enclose nothing.

    Parameters
    ----------
    lines
        (n,) pieces of the outline.
    box
        The site.
    avoid
        (m,) points that cannot lie in the area: buildings, when it is water. When both
        possibilities hold more than `MAX_AVOIDED` of them, a shore is missing and nothing is built.

    Returns
    -------
    area
        Clipped to the site; None when nothing closes.
    """
    frame = shapely.box(*box)
    inside = shapely.intersection(shapely.union_all(lines), frame)
    chains = shapely.get_parts(shapely.line_merge(inside))
    chains = chains[shapely.get_type_id(chains) == 1]
    border = frame.exterior
    closed, open_chains, cuts = [], [], []
    for chain in chains:
        points = shapely.get_coordinates(chain)
        ends = shapely.points(points[[0, -1]])
        if (points[0] == points[-1]).all():
            closed.append(chain)
        elif (shapely.distance(ends, border) < 1e-6).all():
            open_chains.append(chain)
            cuts += shapely.line_locate_point(border, ends).tolist()
    if not open_chains:
        return _enclosed(closed) if closed else None
    cuts.sort()
    spans = [*zip(cuts, [*cuts[1:], cuts[0] + border.length], strict=True)]
    halves = [spans[0::2], spans[1::2]]
    areas = [_enclosed([*closed, *open_chains, *_border_pieces(border, half)]) for half in halves]
    length = [sum(end - begin for begin, end in half) for half in halves]
    built = [int(shapely.intersects(area, avoid).sum()) for area in areas]
    best = 0 if (built[0], length[0]) <= (built[1], length[1]) else 1
    return areas[best] if built[best] <= MAX_AVOIDED else None


def _enclosed(pieces: list[Any]) -> Any:
    noded = shapely.node(shapely.geometrycollections(_snapped(pieces)))
    return shapely.build_area(shapely.geometrycollections(shapely.get_parts(noded)))


def _border_pieces(border: Any, spans: list[tuple[float, float]]) -> list[Any]:
    from shapely.ops import substring

    length = border.length
    found = []
    for begin, end in spans:
        if end - begin < 1e-9:
            continue
        if end <= length:
            found.append(substring(border, begin, end))
        else:
            found += [substring(border, begin, length), substring(border, 0.0, end - length)]
    return [piece for piece in found if piece.length > 0]


def _snapped(pieces: list[Any]) -> NDArray[Any]:
    """Put the ends of lines on the border exactly where the border's pieces end."""
    return np.asarray(shapely.set_precision(np.array(pieces, object), 1e-4), object)


def close_straight(lines: NDArray[Any]) -> Any:
    """Close an outline with a straight line when its ends are near compared with its length."""
    merged = shapely.get_parts(shapely.line_merge(shapely.union_all(lines)))
    found = []
    for chain in merged:
        points = shapely.get_coordinates(chain)
        gap = float(np.hypot(*(points[0] - points[-1])))
        if len(points) >= 3 and gap <= MAX_GAP_SHARE * chain.length:
            found.append(shapely.make_valid(shapely.Polygon(points), method="structure"))
    return shapely.union_all(found) if found else None
