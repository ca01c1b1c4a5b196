"""Road markings as thin regions of the ground, so that they drape and never flicker."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely

from cityx.city.ground import LABEL, SURFACES
from cityx.city.layout import Layout
from cityx.city.roads import RoadNetwork
from cityx.city.section import KIND
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.polylines import line_strips, pieces, to_linestrings
from cityx.ground.arrangement import Regions, join_regions, regions
from cityx.places.painting import Painting
from cityx.road.markings.arrows import lane_symbols, speed_figures
from cityx.road.markings.box_junctions import box_junctions
from cityx.road.markings.centre_marks import centre_marks
from cityx.road.markings.feathers import feathers
from cityx.road.markings.guides import guide_lines
from cityx.road.markings.halts import halt_lines
from cityx.road.markings.lane_lines import (
    LONG_DASH,
    corner_lines,
    kerb_lines,
    lane_lines,
    partings_of,
)
from cityx.road.markings.marks import (
    LINE,
    PLAIN,
    Marks,
    Shapes,
    Street,
    lane_count,
    rimmed,
    together,
)
from cityx.road.markings.turn_guides import crossing_boxes, turn_guides
from cityx.road.markings.unused_ground import unused_ground
from cityx.road.markings.zebras import Zebras, crossing_rows, zebra_bars
from cityx.road.network.junction_ways import junction_ways
from cityx.road.network.lane_graph import lane_graph
from cityx.road.network.through_roads import through_roads
from cityx.road.parking.kerb_bays import bay_marks, runs_of
from cityx.road.surface.carriageway import Carriageway, joined_by
from cityx.road.surface.carriageway_regions import kerbed_edges
from cityx.road.surface.roundabouts import mini_discs

WIDE = 7.0  # metres; a narrower residential street has lines only if the map tells its lanes
# Streets of one way narrower than that have none, which would look like a line between directions.
ONE_WAY = ("tertiary", "unclassified", "residential", "tertiary_link")
EDGE_INSET = 0.35  # metres from the carriageway's edge to its edge line
TOWN_INSET = 0.5  # metres, the same between kerbs, beside the gutter
LANE = 3.4  # metres between the edge lines of a single lane
WHOLE = 0.7  # share of a zebra's bars that must have room; otherwise none is painted
BEFORE_LINES, LEAST_CUT = 0.08, 0.3  # metres from a line to a mark it cuts, and share that is left
HATCH = (0.4, 1.1, 0.3)  # metres: width, spacing and distance from the sides of a gore's bars
GORED = (*LONG_DASH, "primary", "primary_link", "secondary_link")
UNMARKED = ("service", "track", "living_street", "busway", "road", "raceway")


def marking_regions(
    street: Street,
    zebras: Zebras,
    painted: BoolArray,
    road: Carriageway,
    painting: Painting,
    setts: FloatArray | None = None,
) -> Regions:
    """Paint lane lines, stop lines, zebra crossings, parking bays, and what leads over junctions.

    Parameters
    ----------
    street
        The network and what its marks share.
    zebras
        The crossings with bars.
    painted
        (e,) bool, edges that are painted at all.
    road
        Their surfaces.
    painting
        What the country paints.
    setts
        (e, 2, 2) metres from the nodes of streets to both ends of setts across their mouths, NaN
        where none lie; nowhere when None.
    """
    layout, network, kind = street.layout, street.network, street.kind
    table = layout.roads.iloc[network.edge_road]
    urban = painted & ~np.isin(kind, UNMARKED)
    tags = table["tags"].str
    known = tags.contains('"lanes', regex=False).to_numpy().astype(bool)
    known |= table["section"].to_numpy() != ""
    quiet = (kind == "residential") & ~known & (network.half_width * 2 < WIDE)
    single = table["oneway"].to_numpy(bool) & np.isin(kind, ONE_WAY)
    quiet |= single & (network.half_width * 2 < WIDE) & (not painting.edge_lines)
    bays = tags.contains('"parking', regex=False).to_numpy().astype(bool) | (kind != "residential")
    kerbed = kerbed_edges(layout, network)
    through = through_roads(street)
    found = partings_of(street, urban & ~quiet, kerbed, painting.dashes)
    lines, centre = lane_lines(street, found, closing=painting.closing)
    guides, middle, furten = guide_lines(
        street, found, through, urban & ~quiet, road, stems=painting.stems
    )
    bars, crossing = zebra_bars(street, zebras, road)
    halts = halt_lines(street, urban, painting, through, road, setts)
    insets = _town_insets(street)
    white = [
        _edge_lines(
            street,
            np.repeat((urban & np.isin(kind, LONG_DASH))[:, None], 2, axis=1),
            np.full(len(kind), EDGE_INSET),
            LINE,
        ),
        _edge_lines(
            street, _lined(street, urban & kerbed & painting.edge_lines), insets, painting.edge_line
        ),
        lane_symbols(street, urban, one_way=painting.one_way_arrows, diamonds=painting.diamonds),
        _parking_lanes(street, painted & bays, painting.parking),
    ]
    kerbs = kerb_lines(street, urban & kerbed & painting.yellow_kerbs)
    limits = speed_figures(street, urban & painting.limits)
    marks, edge = together([lines, bars, halts, *white, limits, kerbs])
    yellow = np.zeros(len(marks), bool)
    yellow[: len(centre)] = centre & painting.yellow_centre
    yellow[len(marks) - len(kerbs[0]) - len(limits[0]) :] = True
    amid = np.zeros(len(marks), bool)  # crossings and halts lie before kerbs have straightened
    amid[len(centre) : len(centre) + len(crossing) + len(halts[0])] = True
    clear = _clear(marks, edge, layout, network, road, amid)
    _keep_whole(clear, slice(len(centre), len(centre) + len(crossing)), crossing)
    graph = lane_graph(layout, network)
    ways = junction_ways(street, graph)
    centres = centre_marks(street, ways, road) if painting.centre_marks else np.zeros(0, object)
    taken = np.concatenate([furten, guides[0], centres])
    turns, _ = turn_guides(street, ways, zebras, road, taken, painting.turn_guides)
    corners, _ = corner_lines(street, urban & kerbed & painting.yellow_kerbs, road)
    crossed = crossing_boxes(street, zebras)
    corners = corners[~_in_any(corners, crossed[zebras.kind != PLAIN])]
    halting = slice(len(centre) + len(crossing), len(centre) + len(crossing) + len(halts[0]))
    marks[halting] = _cut_by(marks[halting], corners)
    clear[: len(marks) - len(kerbs[0])] &= ~_in_any(marks[: len(marks) - len(kerbs[0])], corners)
    across = np.concatenate([guides[0], centres, turns, corners])
    ochre = np.zeros(len(across), bool)
    ochre[: len(middle)] = middle & painting.yellow_centre
    ochre[len(across) - len(corners) :] = True
    dry = ~_in_houses(across, layout)
    shapes = np.concatenate([marks[clear], across[dry]])
    yellow = np.concatenate([yellow[clear], ochre[dry]])
    label, other = LABEL["marking"], LABEL["marking_yellow"]
    parts = [
        regions(shapes, np.where(yellow, other, label), SURFACES[label].priority),
        regions(mini_discs(layout, network), label, SURFACES[label].priority),
        _gores(painted & np.isin(kind, GORED), road),
    ]
    if painting.signal_crossing != "bars":
        rows, _ = crossing_rows(street, zebras, road, painting.signal_crossing)
        shown = _clear(*rows, layout, network, road, np.ones(len(rows[0]), bool))
        row = LABEL["crossing_row"]
        parts.append(regions(rows[0][shown], row, SURFACES[row].priority))
        shapes = np.concatenate([shapes, rows[0][shown]])
    if painting.feathers:
        blue, signs = feathers(street, urban & kerbed, ways, insets, road, shapes)
        for shapes, color in ((blue, LABEL["feather"]), (signs, label)):
            seen = shapes[~_in_houses(shapes, layout)]
            parts.append(regions(seen, color, SURFACES[color].priority))
    if painting.boxes:
        parts.append(box_junctions(street, ways, road))
    else:
        taken = np.concatenate([taken, turns, crossed])
        cycled = junction_ways(street, graph, bicycles=True)
        parts.append(unused_ground(street, (ways, cycled), road, taken))
    if painting.red_cycleways:
        parts.append(_red_lanes(street, painted))
    if painting.red_furten:
        red = LABEL["cycle_lane"]
        parts.append(regions(furten, red, SURFACES[red].priority))
    return join_regions(parts)


def _keep_whole(clear: BoolArray, rows: slice, crossing: IntArray) -> None:
    """Leave out the bars of crossings that have no room for most of theirs; changes `clear`."""
    count = np.bincount(crossing)
    whole = np.bincount(crossing[clear[rows]], minlength=len(count)) >= WHOLE * count
    clear[rows] &= whole[crossing]


def _lined(street: Street, chosen: BoolArray) -> BoolArray:
    """(e, 2) which sides of the chosen edges, left first, have a line along their kerb.

    Those without parked cars, cycle lanes and shoulders.
    """
    bands = street.bands
    taken = np.isin(bands.kind, [KIND[name] for name in ("parking", "cycle", "shoulder")])
    found = np.repeat((chosen & ~np.isin(street.kind, LONG_DASH))[:, None], 2, axis=1)
    found[bands.edge[taken], (bands.middle[taken] < 0).astype(np.int64)] = False
    return found


def _town_insets(street: Street) -> FloatArray:
    """(e,) metres from kerbs to edge lines, which leave a single one-way lane `LANE` at most."""
    single = street.layout.roads["oneway"].to_numpy(bool)[street.network.edge_road]
    single &= lane_count(street.bands, len(single), 1) == 1
    single[street.bands.edge[street.bands.kind == KIND["parking"]]] = False
    return np.where(
        single, np.maximum(street.network.half_width - LANE / 2, TOWN_INSET), TOWN_INSET
    )


def _edge_lines(street: Street, chosen: BoolArray, inset: FloatArray, width: float) -> Marks:
    """Paint lines along the chosen sides, (e, 2); a shoulder has its line where it meets a lane."""
    network, lines, bands = street.network, street.lines, street.bands
    begin, end = street.free
    usual = chosen & ((end - begin > 3.0) & (network.half_width > 2.0))[:, None]
    shouldered = bands.kind == KIND["shoulder"]
    shapes, edges = [], []
    for side, sign in enumerate((1, -1)):
        with_shoulder = np.zeros(len(chosen), bool)
        with_shoulder[bands.edge[shouldered & (sign * bands.middle > 0)]] = True
        edge = np.flatnonzero(usual[:, side] & ~with_shoulder)
        solid = pieces(lines, edge, begin[edge], end[edge])
        lateral = sign * (network.half_width - inset)[edge]
        shapes.append(line_strips(solid, lateral, width))
        edges.append(edge)
    return np.concatenate(shapes), np.concatenate(edges)


def _parking_lanes(street: Street, chosen: BoolArray, style: str) -> Marks:
    """Paint the lanes of parked cars on the chosen edges."""
    bands = street.bands
    runs = runs_of(street.network, bands.take(chosen[bands.edge]))
    return bay_marks(street.lines, runs, style)


def _red_lanes(street: Street, chosen: BoolArray) -> Regions:
    """Colour cycle lanes from junction to junction."""
    bands = street.bands
    begin, end = street.free
    rows = np.flatnonzero((bands.kind == KIND["cycle"]) & chosen[bands.edge])
    rows = rows[(end - begin)[bands.edge[rows]] > 3.0]
    edge = bands.edge[rows]
    cut = pieces(street.lines, edge, begin[edge], end[edge])
    strips = []
    for row, line in enumerate(to_linestrings(cut)):
        strips.append(_band(line, bands.left[rows[row]], bands.right[rows[row]]))
    return regions(np.array(strips, object), LABEL["cycle_lane"],
                   SURFACES[LABEL["cycle_lane"]].priority)  # fmt: skip


def _gores(chosen: BoolArray, road: Carriageway) -> Regions:
    """Hatch the wedges between a road and the ramp that leaves or joins it."""
    wedge = np.flatnonzero(chosen[road.gore_edge])
    if not len(wedge):
        return Regions()
    width, spacing, inset = HATCH
    shapes = shapely.buffer(road.gores[wedge], -inset, join_style="mitre")
    slope = np.sqrt(0.5) * np.array([1.0, -1.0])
    label = LABEL["marking"]
    painted = shapely.union_all(
        [rimmed(shape, [slope], spacing, width, rim=2 * LINE) for shape in shapes]
    )
    return regions(painted, label, SURFACES[label].priority)


def _band(line: Any, left: float, right: float) -> Any:
    """Strip of a line between two distances to its left."""
    width = left - right
    return shapely.buffer(
        shapely.offset_curve(line, (left + right) / 2, join_style="mitre"),
        width / 2, cap_style="flat", join_style="mitre",
    )  # fmt: skip


def _clear(
    marks: Shapes, edge: IntArray, layout: Layout, network: RoadNetwork, road: Carriageway,
    amid: BoolArray,
) -> BoolArray:  # fmt: skip
    """Mark what lies in no junction, unless it may, on no other road and in no building."""
    clear = ~_in_houses(marks, layout)
    inside = shapely.STRtree(road.stars).query(marks, predicate="intersects")[0]
    clear[inside[~amid[inside]]] = False
    mark, strip = shapely.STRtree(road.strips).query(marks, predicate="intersects")
    own, other = network.edge_nodes[edge[mark]], network.edge_nodes[road.edge[strip]]
    # Neighbours along the road touch; anything else that overlaps takes the mark's meaning away.
    joined = (own[:, :, None] == other[:, None, :]).any(axis=(1, 2))
    clear[mark[~joined]] = False
    return clear


def _cut_by(marks: Shapes, lines: Shapes) -> Shapes:
    """End marks before lines round corners; those of which little is left reach over them."""
    mark, line = shapely.STRtree(lines).query(marks, predicate="intersects")
    cut, own = joined_by(shapely.buffer(lines[line], BEFORE_LINES, join_style="mitre"), mark)
    left = shapely.difference(marks[own], cut)
    whole = (shapely.get_type_id(left) == 3) & (
        shapely.area(left) > LEAST_CUT * shapely.area(marks[own])
    )
    found = marks.copy()
    found[own[whole]] = left[whole]
    return found


def _in_any(marks: Shapes, things: Shapes) -> BoolArray:
    """Mark what meets one of some shapes."""
    found = np.zeros(len(marks), bool)
    found[shapely.STRtree(things).query(marks, predicate="intersects")[0]] = True
    return found


def _in_houses(marks: Shapes, layout: Layout) -> BoolArray:
    """Mark what a house stands on."""
    parts = layout.parts
    low = (parts["base"].to_numpy() < 0.5) & parts["walls"].to_numpy()
    return _in_any(marks, parts.geometry.to_numpy()[low])
