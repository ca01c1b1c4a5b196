"""Contradictions: where tags of the map cannot all hold, and what is built there."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.ground import DROPPED, KERB_HEIGHT
from cityx.city.section import NARROWEST_LANE
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.polylines import to_linestrings
from cityx.ground.building_passages import FROM_GROUND
from cityx.ground.walking.mapped_crossings import MappedCrossings, kerb_heights, mapped_crossings
from cityx.ids import id_text
from cityx.road.heights.crossings import Crossings
from cityx.road.heights.tiers import spans_of
from cityx.road.markings.crossing_places import ends_near
from cityx.road.markings.marks import ZEBRA, street_of
from cityx.road.network.network import private_tunnels
from cityx.road.network.sections import TWO_LANES, bands_of
from cityx.road.network.stations import ON_FOOT, RAILS, Ways, way_levels
from cityx.sources.features.tagged import named_note

if TYPE_CHECKING:
    from cityx.city.heights import WayHeights
    from cityx.city.layout import Layout
    from cityx.city.roads import RoadNetwork


KERB_OFF = 0.03  # metres by which kerbs may be lower or higher than stated
MOVED = 2.0  # metres from a crossing of the map to that of the city; less is its own depth
INSIDE = 5.0  # metres of a street in a house; less is how a corner was drawn
MOST_OPEN = 0.5  # of the length of a covered way
NODE = 0.001  # metres within which a crossing lies at a point of a line


def notes_on(
    layout: Layout,
    network: RoadNetwork,
    ways: Ways | None = None,
    crossing: Crossings | None = None,
    gap: FloatArray | None = None,
    closed: BoolArray | None = None,
) -> tuple[str, ...]:
    """Return sentences that name where the map contradicts itself, and the ways.

    Parameters
    ----------
    layout, network
        The map and the graph of its streets.
    ways, crossing
        What was given heights, and where one way passes over another.
    gap
        (c,) metres of height missing at each crossing, negative; 0 where nothing is.
    closed
        (c,) crossings where the two ways meet at one height instead.
    """
    found = [*_tags(layout), _unroofed(layout), _through_houses(layout, network),
             _flat(layout, network, ways, crossing),
             _flat_paths(layout, ways, crossing)]  # fmt: skip
    if ways is not None and crossing is not None and gap is not None and closed is not None:
        found += [_one_level(layout, ways, crossing), _drawn_short(layout, ways, crossing),
                  _bridges_below(layout, ways, crossing), _closed(layout, ways, crossing, closed),
                  _low(layout, ways, crossing, np.where(closed, 0.0, gap))]  # fmt: skip
    return tuple(note for note in found if note)


def crossing_notes(layout: Layout, network: RoadNetwork, heights: WayHeights) -> tuple[str, ...]:
    """Return sentences that name crossings of the map that are not where it has them."""
    mapped, kerbs = mapped_crossings(layout, network.lines), _kerbs_between(layout)
    if not len(mapped.edge):
        return (kerbs,) if kerbs else ()
    street = street_of(layout, network, bands_of(layout, network))
    raised = _on_structures(network, heights, mapped)
    joint = network.node_degree[network.edge_nodes] >= 3
    back, near = ends_near(mapped, street.length, network.trim, joint)
    middle = network.trim + street.setback + street.depth[:, None] / 2
    off = np.where(near, np.abs(middle[mapped.edge] - back), 0.0).max(axis=1)
    built = (near & network.crossing[mapped.edge]).any(axis=1)
    begin, end = (side[mapped.edge] + sign * ZEBRA
                  for side, sign in zip(street.free, (1, -1), strict=True))  # fmt: skip
    between = ~near.any(axis=1) & (mapped.along > begin) & (mapped.along < end)
    told = (
        ("lie on bridges, ramps or in cuttings, where nobody walks across yet", raised),
        ("lie within junctions and are where their arms begin", ~raised & built & (off > MOVED)),
        ("have no room for marks on a street that short", ~raised & ~built & ~between),
    )
    notes = [
        named_note(f"crossings {what}", map_names(layout.points, np.unique(mapped.point[chosen])))
        for what, chosen in told
    ]
    return tuple(note for note in (*notes, kerbs) if note)


def _kerbs_between(layout: Layout) -> str:
    """Name the kerbs whose stated height is neither that of a lowered nor of a raised one."""
    height = kerb_heights(layout.points["tags"])
    off = np.abs(height[:, None] - [DROPPED, KERB_HEIGHT]).min(axis=1)
    return named_note(
        f"kerbs have another height than those built, of {DROPPED:g} or {KERB_HEIGHT:g} m",
        map_names(layout.points, np.flatnonzero(off > KERB_OFF)),
    )


def _on_structures(network: RoadNetwork, heights: WayHeights, mapped: MappedCrossings) -> BoolArray:
    """(m,) whether a crossing lies on a piece of its edge that is off the ground."""
    spans = spans_of(network, heights)
    rows = np.flatnonzero(spans.off)
    found = np.zeros(len(mapped.edge), bool)
    for row in rows[np.isin(spans.edge[rows], mapped.edge)].tolist():
        inside = (spans.begin[row] <= mapped.along) & (mapped.along <= spans.end[row])
        found |= inside & (mapped.edge == spans.edge[row])
    return found


def left_out_notes(layout: Layout, rows: IntArray) -> tuple[str, ...]:
    """Name paths and tracks off the ground, rows of the roads, that are left out for want of room.

    Nothing is said where there are none.
    """
    note = named_note(
        "paths and tracks would open up a carriageway or a house, or leave no room over one, and "
        "are left out there", _names(layout, rows),
    )  # fmt: skip
    return (note,) if note else ()


def _unroofed(layout: Layout) -> str:
    """Name ways that are covered, or lead through a house, where the map draws none."""
    rows = np.flatnonzero(layout.roads["passage"].to_numpy(bool))
    lines, parts = layout.roads.geometry.to_numpy()[rows], layout.parts.geometry.to_numpy()
    part, line = shapely.STRtree(lines).query(parts, predicate="intersects")
    over = np.full(len(lines), shapely.Point(), object)
    for each in np.unique(line).tolist():
        over[each] = shapely.union_all(parts[part[line == each]])
    length = shapely.length(lines)
    open_ = length - shapely.length(shapely.intersection(lines, over))
    bare = (open_ > MOST_OPEN * length) & (open_ > INSIDE)
    return named_note("covered ways and passages without a house over them have no roof",
                      _names(layout, rows[bare]))  # fmt: skip


def _tags(layout: Layout) -> list[str]:
    """Name bridges below the ground, tunnels above it, tunnels left out, and widths over lanes."""
    roads = layout.roads
    lanes, width = roads["lanes"].to_numpy(), roads["width"].to_numpy()
    stated = roads["tags"].astype(str).str.contains('"lanes": ', regex=False).to_numpy()
    narrow = (lanes > 1) & (roads["lane_width"].to_numpy() < NARROWEST_LANE)
    wide = (lanes == 1) & (width >= TWO_LANES) & ~roads["oneway"].to_numpy(bool)
    layer, passage = roads["layer"].to_numpy(), roads["passage"].to_numpy()
    bridges = np.flatnonzero(roads["bridge"].to_numpy() & (layer < 0) & ~passage)
    tunnels = np.flatnonzero(roads["tunnel"].to_numpy() & (layer > 0) & ~passage)
    return [
        named_note("bridges with a layer below the ground pass over it", _names(layout, bridges)),
        named_note("tunnels with a layer above the ground run below it", _names(layout, tunnels)),
        named_note("service roads and tracks in tunnels, as into garages, are left out",
                   _names(layout, np.flatnonzero(private_tunnels(roads)))),
        named_note("streets are too narrow or too wide for the lanes they state; widths decide",
                   _names(layout, np.flatnonzero(stated & (narrow | wide)))),
    ]  # fmt: skip


def _through_houses(layout: Layout, network: RoadNetwork) -> str:
    """Name streets on the ground that run through houses without a word of a passage there."""
    parts, lines = layout.parts, to_linestrings(network.lines)
    standing = (parts["base"].to_numpy(float) < FROM_GROUND) & parts["walls"].to_numpy(bool)
    houses = parts.geometry.to_numpy()[standing]
    flat = (way_levels(layout) == 0) & ~layout.roads["passage"].to_numpy(bool)
    edge = np.flatnonzero(flat[network.edge_road])
    line, house = shapely.STRtree(houses).query(lines[edge], predicate="intersects")
    inside = shapely.length(shapely.intersection(lines[edge[line]], houses[house]))
    walled = np.bincount(edge[line], inside, minlength=len(lines)) > INSIDE
    rows = np.unique(network.edge_road[walled])
    return named_note(
        "streets run through houses though no tag says that a passage does; the houses stand",
        _names(layout, rows),
    )


def _flat(
    layout: Layout, network: RoadNetwork, ways: Ways | None, crossing: Crossings | None
) -> str:
    """Name streets of one level that cross without a node."""
    if not network.edge_count:
        return ""
    shapes = to_linestrings(network.lines)
    one, other = shapely.STRtree(shapes).query(shapes, predicate="crosses")
    road = network.edge_road.astype(np.int64)
    level = way_levels(layout)[road]
    flat = (one < other) & (level[one] == level[other])
    pairs = np.sort(np.column_stack([road[one], road[other]])[flat], axis=1)
    return named_note(
        "pairs of streets of one level that cross without a node are one surface",
        _pairs(layout, _unpassed(pairs, layout, ways, crossing)),
    )


def _flat_paths(layout: Layout, ways: Ways | None, crossing: Crossings | None) -> str:
    """Name paths and tracks that cross streets of their level without a node."""
    shapes = layout.roads.geometry.to_numpy()
    light = layout.roads["kind"].isin((*ON_FOOT, *RAILS)).to_numpy()
    path, street = np.flatnonzero(light), np.flatnonzero(~light)
    one, other = shapely.STRtree(shapes[street]).query(shapes[path], predicate="crosses")
    pairs = np.column_stack([path[one], street[other]])
    level = way_levels(layout)
    pairs = pairs[level[pairs[:, 0]] == level[pairs[:, 1]]]
    spots, row = shapely.get_coordinates(shapely.intersection(*shapes[pairs].T), return_index=True)
    corner = [
        shapely.dwithin(shapely.extract_unique_points(line[row]), shapely.points(spots), NODE)
        for line in shapes[pairs].T
    ]
    pairs = np.sort(np.unique(pairs[row[~(corner[0] & corner[1])]], axis=0), axis=1)
    return named_note(
        "paths and tracks cross streets of their level without a node and lie level there",
        _pairs(layout, _unpassed(pairs, layout, ways, crossing)),
    )


def _unpassed(
    pairs: IntArray, layout: Layout, ways: Ways | None, crossing: Crossings | None
) -> IntArray:
    """Leave out pairs of roads, the lower row first, of which one passes over the other."""
    if ways is None or crossing is None:
        return pairs
    passed = np.column_stack([ways.road[crossing.upper], ways.road[crossing.lower]])
    size = len(layout.roads)
    return pairs[~np.isin(pairs @ [size, 1], np.sort(passed, axis=1) @ [size, 1])]


def _one_level(layout: Layout, ways: Ways, crossing: Crossings) -> str:
    """Name ways off the ground that pass over each other though their levels are the same."""
    upper, lower = crossing.upper, crossing.lower
    same = (ways.level[upper] == ways.level[lower]) & (ways.level[upper] != 0)
    return named_note(
        "pairs of ways have one layer and cross; the path passes farther from the ground",
        _pairs(layout, ways.road[np.column_stack([upper, lower])[same]]),
    )


def _drawn_short(layout: Layout, ways: Ways, crossing: Crossings) -> str:
    """Name ways whose bridge or tunnel ends before what they cross."""
    upper, lower = crossing.upper, crossing.lower
    short = (ways.level[upper] == 0) & (ways.level[lower] == 0) & (crossing.high != crossing.low)
    return named_note(
        "ways pass over others past the end of their bridge or tunnel",
        _pairs(layout, ways.road[np.column_stack([upper, lower])[short]]),
    )


def _bridges_below(layout: Layout, ways: Ways, crossing: Crossings) -> str:
    """Name bridges that lie lower than what they cross."""
    bridge = layout.roads["bridge"].to_numpy()[ways.road]
    wrong = bridge[crossing.lower] & ~bridge[crossing.upper]
    pairs = np.column_stack([crossing.upper, crossing.lower])[wrong]
    return named_note(
        "ways that are no bridges pass over bridges, as their layers say",
        _pairs(layout, ways.road[pairs]),
    )


def _closed(layout: Layout, ways: Ways, crossing: Crossings, closed: BoolArray) -> str:
    pairs = np.column_stack([crossing.upper, crossing.lower])[closed]
    return named_note(
        "pairs of ways without room for one to pass over the other meet at one height",
        _pairs(layout, ways.road[pairs]),
    )


def _low(layout: Layout, ways: Ways, crossing: Crossings, gap: FloatArray) -> str:
    """Name what passes over another way too low, with the free height that is left."""
    low = np.flatnonzero(gap < 0)
    low = low[np.argsort(gap[low], kind="stable")]
    free = ways.clear[crossing.lower[low]] + gap[low]
    pairs = ways.road[np.column_stack([crossing.upper[low], crossing.lower[low]])]
    _, first = np.unique(pairs, axis=0, return_index=True)
    named = [f"{name} ({free[row]:.1f} m)"
             for row in np.sort(first) for name in _pairs(layout, pairs[[row]])]  # fmt: skip
    return named_note(
        "ways pass over others with less free height than usual for want of room", named
    )


def _pairs(layout: Layout, pairs: IntArray) -> list[str]:
    found = np.unique(pairs, axis=0)
    return [" x ".join(pair) for pair in _names(layout, found.ravel()).reshape(-1, 2).tolist()]


def _names(layout: Layout, rows: IntArray) -> NDArray[np.str_]:
    """Return what the ways are called in the map, or else their ids."""
    return map_names(layout.roads, rows)


def map_names(things: Any, rows: IntArray) -> NDArray[np.str_]:
    """Return what rows of a table are called in the map, or else their ids."""
    table = things.iloc[rows]
    return np.array([source or id_text(number)
                     for source, number in zip(table["source"], table["id"], strict=True)],
                    dtype=str)  # fmt: skip
