"""Bridges with their ramps, cuttings and tunnels: surfaces like the ground's, on solid bodies."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.ops import substring

from cityx.city.ground import KERB_WIDTH, LABEL, SURFACES, Ground
from cityx.city.heights import WayHeights
from cityx.city.layout import Layout
from cityx.city.mesh import NO_VERTEX, MeshBatch, concatenate
from cityx.city.roads import RoadNetwork
from cityx.city.terrain import Terrain
from cityx.geometry.arrangement import Regions, arrange, join_regions, regions
from cityx.geometry.clearance import in_triangles
from cityx.geometry.drape import drape
from cityx.geometry.identity import stable_id
from cityx.geometry.polylines import (
    Polylines,
    arc_lengths,
    bends,
    every,
    locate,
    miters,
    pack,
    to_linestrings,
    values_along,
)
from cityx.geometry.standing import EARTH
from cityx.geometry.structures import Bodies, beams, chains_of, rim_edges, slabs
from cityx.plugins.road.carriageway import (
    FINE,
    MITRE,
    STONE,
    plain_carriageways,
)
from cityx.plugins.road.embankments import Obstacles, embankments
from cityx.plugins.road.heights import WATER
from cityx.plugins.road.joints import courses
from cityx.plugins.road.kerbs import edge_lines
from cityx.plugins.road.landcover import AREA_SURFACE, TRACK_BED, rail_strips
from cityx.plugins.road.painting import Painting
from cityx.plugins.road.stations import (
    DECK,
    FOOT_DECK,
    ON_FOOT,
    RAILS,
    free_heights,
    way_levels,
)
from cityx.plugins.road.streets import USUAL, street_regions
from cityx.plugins.road.tiers import Spans, cut_network, spans_of

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]
Shapes = NDArray[Any]

LOW = 2.2  # metres; a deck lower above the ground stands on fill
FOOTING = 0.5  # metres that fill and piers reach into the ground
CEILING = 0.4  # metres of the slab over a tunnel; with its free height less than it lies deep
MOUTH = 60.0  # metres into a tunnel that anybody sees
TOP_GAP = 0.04  # metres from a surface down to the slab, so that they never flicker
SOFFIT = 0.06  # metres that a parapet's outside covers below the slab
PARAPET, PARAPET_WIDTH = 0.95, 0.25  # metres above the surface; metres
CUTTING_PARAPET, CUTTING_WALL = 1.0, 0.35  # metres above the ground; metres
GAP = 0.1  # metres between the wall of a cutting and a carriageway at its rim
PARAPET_FROM = 0.6  # metres of drop that want a parapet
WALL_FROM = 0.12  # metres of depth that want a retaining wall
PIER_EVERY = 26.0  # metres
PIER_FROM = 3.2  # metres of height
PIER_SHIFTS = (0.0, 3.0, -3.0, 6.0, -6.0, 9.0, -9.0)  # metres along, clear of what passes below
PIER_THICK = 1.0  # metres along the deck
PIER_WIDE = 0.45  # of the deck's width
WALKED = (*ON_FOOT, "steps")
AFLOAT = tuple(kind for kind in WATER if AREA_SURFACE[kind] == "water")  # a marsh is land
UNDER = 1.5  # metres beside a carriageway that a deck over it spans too
STORY = 3.5  # metres; a way lower by more passes under
ISLAND = 150.0  # square metres; a larger hole in a deck stays open
PAST = 0.6  # metres past the end of a deck that its kerbs could reach
SAME_PLACE = 0.06  # metres
PASSES_OVER = 1.0  # metres of difference in height from which ways side by side have no one surface
BLEND = 3.0  # metres beyond the edge of a way in which its height still counts
AXIS = (
    0.1  # of a metre beyond a way's edge, what a metre from its axis takes from its height's pull
)
# Metres by which a surface may miss its profile between two cuts: over the ten metres or more that
# lie between them nobody feels it; at detail level 0, what nobody sees beside a prism.
SLACK, PLAIN_SLACK = 0.04, 0.3


@dataclass(frozen=True)
class Structures:
    """All that lies off the ground.

    Attributes
    ----------
    spans
        The pieces of the network's edges.
    surfaces
        Meshes of the carriageways, walks and markings, an object per surface.
    bodies
        Closed solids: slabs, fill, parapets, retaining walls, piers, ceilings.
    opening
        Polygons where there is no ground.
    """

    spans: Spans
    surfaces: MeshBatch
    bodies: MeshBatch
    opening: Shapes


@dataclass(frozen=True)
class _Tier:
    """Ways off the ground that do not pass over each other: a network, paths and tracks, all lines.

    ``network`` and ``others`` come one after the other in what is given for each of the w lines.
    """

    network: RoadNetwork
    others: WayHeights
    lines: Polylines
    z: FloatArray  # (p,)
    road: IntArray  # (w,) row of the layout
    level: IntArray  # (w,)
    half: FloatArray  # (w,) half the width of what is travelled
    reach: FloatArray  # (w,) the same with kerbs and walks
    room: FloatArray  # (w,) metres free over it in a tunnel


def build_structures(
    layout: Layout,
    network: RoadNetwork,
    heights: WayHeights,
    terrain: Terrain,
    *,
    seed: int = 0,
    detail: bool = True,
    painting: Painting = USUAL,
) -> Structures:
    """Build everything that leaves the ground.

    Parameters
    ----------
    layout, network, heights, terrain
        The city's, with heights solved.
    seed
        Of the slight variation in brightness of surfaces.
    detail
        Whether to lay kerbs, walks and markings, paths and tracks, and to raise parapets and piers.
    painting
        What the country paints.
    """
    spans = spans_of(network, heights)
    streets = _strips(network)
    off = cut_network(network, spans, np.flatnonzero(spans.off))
    others = heights.take(np.flatnonzero((heights.edge < 0) & detail))
    off, others = _with_room(layout, off, others, streets)
    whole = _tier_of(layout, off, others)
    obstacles = Obstacles(layout, _areas(layout, WATER))
    beside = _strips(cut_network(network, spans, np.flatnonzero(~spans.off)), CUTTING_WALL + GAP)
    surfaces, bodies, opening = [], [], [np.zeros(0, object)]
    for number, rows in enumerate(_groups(whole)):
        cars = rows[rows < off.edge_count]
        part = _tier_of(layout, _edges(off, cars), others.take(rows[len(cars) :] - off.edge_count))
        made = _build_tier(
            layout, part, network, terrain, seed, number, detail, painting, obstacles, beside
        )
        surfaces.append(made[0])
        bodies.append(made[1])
        opening.append(made[2])
    return Structures(spans, concatenate(surfaces), concatenate(bodies), np.concatenate(opening))


def _edges(network: RoadNetwork, rows: IntArray) -> RoadNetwork:
    """Return some edges as a network of their own."""
    length = arc_lengths(edge_lines(network))[1]
    off = np.ones(len(rows), bool)
    return cut_network(network, Spans(rows, np.zeros(len(rows)), length[rows], off),
                       np.arange(len(rows)))  # fmt: skip


def _strips(network: RoadNetwork, more: float = 0.0) -> Shapes:
    """Carriageways of the edges that lie on the ground, roughly, and `more` metres beside them."""
    lines = edge_lines(network)
    level = np.abs(network.lift) < WALL_FROM
    whole = np.ones(network.edge_count, bool)
    np.logical_and.at(whole, lines.line_of_point(), level)
    shapes = to_linestrings(lines)[whole]
    return np.asarray(shapely.buffer(shapes, network.half_width[whole] + more, cap_style="flat"))


def _tier_of(layout: Layout, sub: RoadNetwork, other: WayHeights) -> _Tier:
    start = np.concatenate([sub.point_start, sub.point_start[-1] + other.point_start[1:]])
    table = layout.roads.iloc[sub.edge_road]
    walk = np.maximum(table["sidewalk_left"].to_numpy(), table["sidewalk_right"].to_numpy())
    kind = layout.roads["kind"].to_numpy().astype(str)[other.road]
    half = np.where(np.isin(kind, RAILS), TRACK_BED / 2, np.maximum(other.half_width, 0.75))
    return _Tier(
        sub, replace(other, half_width=half),
        Polylines(np.concatenate([sub.points, other.points]), start),
        np.concatenate([sub.z, other.z]),
        np.concatenate([sub.edge_road, other.road]).astype(np.int64),
        np.concatenate([way_levels(layout)[sub.edge_road], other.level.astype(np.int64)]),
        np.concatenate([sub.half_width, half]),
        np.concatenate([sub.half_width + KERB_WIDTH + walk, half]),
        np.concatenate([_rooms(layout, sub.edge_road), _rooms(layout, other.road)]),
    )  # fmt: skip


def _rooms(layout: Layout, road: NDArray[np.int32]) -> FloatArray:
    """(w,) metres free over ways in tunnels."""
    return free_heights(layout.roads["kind"].to_numpy().astype(str)[road])


def _groups(whole: _Tier) -> list[IntArray]:
    """Divide ways into as few groups as can be of which none has one way pass over another.

    Ways that meet stay together, so that they have one surface, unless that puts two into a group
    of which one passes over the other.
    """
    count = whole.lines.count
    if not count:
        return []
    joined, apart, near = _relations(whole)
    above: list[set[int]] = [set() for _ in range(count)]
    for a, b in apart.tolist():
        above[a].add(b)
        above[b].add(a)
    owner = np.arange(count)
    members = [{way} for way in range(count)]
    for a, b in joined.tolist():
        one, other = sorted((int(owner[a]), int(owner[b])))
        if one == other or above[one] & members[other]:
            continue
        owner[list(members[other])] = one
        members[one] |= members[other]
        above[one] |= above[other]
    beside: dict[int, set[int]] = {}
    for a, b in np.unique(owner[near], axis=0).tolist():
        if a != b:
            beside.setdefault(a, set()).add(b)
            beside.setdefault(b, set()).add(a)
    color: dict[int, int] = {}
    for group in np.unique(owner).tolist():
        taken = {color[other] for other in beside.get(group, ()) if other in color}
        color[group] = next(k for k in range(count) if k not in taken)
    shade = np.array([color[group] for group in owner.tolist()])
    return [np.flatnonzero(shade == k) for k in range(int(shade.max()) + 1)]


def _relations(whole: _Tier) -> tuple[IntArray, IntArray, IntArray]:
    """Pairs of ways that meet, that pass over each other, and that lie side by side."""
    lines, count = whole.lines, whole.lines.count
    cars = whole.network.edge_count
    ends = np.rint(
        np.concatenate([lines.points[lines.start[:-1]], lines.points[lines.start[1:] - 1]]) * 1000
    )
    place = np.unique(ends, axis=0, return_inverse=True)[1].ravel()
    # Nodes of the network tell ways apart that cross at one place on two levels.
    nodes = whole.network.edge_nodes.T.astype(np.int64)
    shift = int(place.max()) + 1
    for side in (0, 1):
        place[side * count : side * count + cars] = shift + nodes[side]
    order = np.argsort(place, kind="stable")
    same = np.flatnonzero(place[order][1:] == place[order][:-1])
    joined = np.unique(np.sort(np.column_stack([order[same], order[same + 1]]) % count), axis=0)
    joined = joined[joined[:, 0] != joined[:, 1]]
    shapes = to_linestrings(lines)
    strips = shapely.buffer(shapes, whole.reach + 2 * PARAPET_WIDTH, cap_style="flat")
    near = np.unique(np.sort(shapely.STRtree(strips).query(strips, "intersects").T), axis=0)
    near = near[near[:, 0] != near[:, 1]]
    a, b = near.T
    link = shapely.get_coordinates(shapely.shortest_line(shapes[a], shapes[b])).reshape(-1, 2, 2)
    heights = [
        values_along(lines, whole.z, way,
                     shapely.line_locate_point(shapes[way], shapely.points(link[:, k])))
        for k, way in enumerate((a, b))
    ]  # fmt: skip
    keys = joined[:, 0] * count + joined[:, 1]
    meets = np.isin(a * count + b, keys)
    crosses, apart = (
        shapely.crosses(shapes[a], shapes[b]),
        np.abs(heights[0] - heights[1]) > PASSES_OVER,
    )
    over = np.where(meets, crosses, apart)
    # What crosses at one height is one surface, as on the ground.
    level = crosses & ~meets & ~apart
    return np.concatenate([joined, near[level]]), near[over], near[~meets & ~level]


def _touching(lines: Polylines, marked: BoolArray, shapes: Shapes) -> BoolArray:
    """(w,) lines of which a marked point lies within one of the shapes."""
    found = np.zeros(lines.count, bool)
    spots = np.flatnonzero(marked)
    if len(shapes) and len(spots):
        hit = shapely.STRtree(shapes).query(
            shapely.points(lines.points[spots]), predicate="intersects"
        )[0]
        found[lines.line_of_point()[spots[hit]]] = True
    return found


def _with_room(
    layout: Layout, sub: RoadNetwork, other: WayHeights, streets: Shapes
) -> tuple[RoadNetwork, WayHeights]:
    """Keep what there is room for and, of paths and tracks below, what is seen from a mouth.

    Paths and tracks that are low above a carriageway or would open it up, and cuttings that would
    open up a house, are left out.
    """
    houses = layout.buildings.geometry.to_numpy()
    cars, ways = (Polylines(part.points, part.point_start) for part in (sub, other))
    below = [way_levels(layout)[sub.edge_road] < 0, other.level < 0]
    keep, mouths = [], []
    for lines, lift, road in ((cars, sub.lift, sub.edge_road), (ways, other.lift, other.road)):
        shallow = lift > -(_rooms(layout, road) + CEILING)[lines.line_of_point()]
        opened = shallow & (lift < -WALL_FROM)
        mouths.append(lines.points[opened])
        free = ~_touching(lines, opened, houses)
        # Streets join cuttings of streets; what is walked or rides on rails keeps off them.
        keep.append(
            free if lines is cars else free & ~_touching(lines, shallow & (lift < LOW), streets)
        )
    keep[0] |= ~below[0]
    tree = shapely.STRtree(shapely.points(np.concatenate(mouths)))
    seen = np.zeros(ways.count, bool)
    if ways.count and len(tree.geometries):
        seen[tree.query(to_linestrings(ways), "dwithin", distance=MOUTH)[0]] = True
    keep[1] &= seen | ~below[1]
    return _edges(sub, np.flatnonzero(keep[0])), other.take(np.flatnonzero(keep[1]))


def _build_tier(
    layout: Layout,
    part: _Tier,
    network: RoadNetwork,
    terrain: Terrain,
    seed: int,
    number: int,
    detail: bool,
    painting: Painting,
    obstacles: Obstacles,
    beside: Shapes,
) -> tuple[MeshBatch, MeshBatch, Shapes]:
    found = _open_wells(_regions(layout, part, detail, painting), part, network)
    found = join_regions([found, _streets_above(part, terrain, beside)])
    bounds = shapely.total_bounds(found.polygons)
    extent = (bounds[0] - 1.0, bounds[1] - 1.0, bounds[2] + 1.0, bounds[3] + 1.0)
    slack = SLACK if detail else PLAIN_SLACK
    bars = np.concatenate([_bars(part, terrain, slack), _passing_edges(part, network)])
    deck = arrange(found, extent, lines=bars, background=LABEL["void"])
    z = _surface_heights(part, deck.vertices)
    soil = terrain.height_at(deck.vertices)
    surfaces = drape(
        deck, terrain, seed, base=np.round(z, 4), layer=f"structures {number}",
        courses=courses(deck, part.network) if detail else None,
    )  # fmt: skip
    solid = deck.face_label != LABEL["void"]
    lift = _of_faces(deck, z - soil)
    middle = _of_faces(deck, deck.vertices)
    wet = _in_areas(layout, middle, WATER)
    nearest = shapely.STRtree(to_linestrings(part.lines)).nearest
    way = nearest(shapely.points(middle))
    height = _of_faces(deck, z)
    below = _traffic(network, middle, UNDER, lambda row, at: at < height[row] - STORY)
    spanning = solid & (part.level[way] > 0) & ((lift > LOW) | (wet & (lift > 0)))
    spanning |= solid & below
    covered = solid & (lift < -(part.room[way] + CEILING)) & (part.level[way] < 0)
    filled = solid & ~spanning
    walked = np.isin(layout.roads["kind"].to_numpy().astype(str)[part.road[way]], WALKED)
    group = np.select([spanning & walked, spanning, filled], [2, 1, 0], -1)
    low = np.stack([np.minimum(z, soil) - FOOTING, z - DECK, z - FOOT_DECK])
    made = [slabs(deck, group, low, z - TOP_GAP)]
    thick = np.where(walked, FOOT_DECK, DECK)
    ceiling = z + part.room[nearest(shapely.points(deck.vertices))]
    if detail:
        made += _rims(part, deck, network, np.where(solid, 0, -1), z, soil, ceiling, covered, thick)
        made.append(_piers(part, deck, spanning, terrain, layout))
    if covered.any():
        made.append(slabs(deck, np.where(covered, 0, -1), ceiling, ceiling + CEILING))
        made.append(_headwalls(deck, network, covered, solid, ceiling, soil))
    batches = [body_batch(bodies, f"structures {number} {k}") for k, bodies in enumerate(made)]
    edges, _, beyond = rim_edges(deck, np.where(filled, 0, -1))
    edges = edges[(beyond < 0) | ~solid[np.maximum(beyond, 0)]]
    earth = embankments(
        deck, edges[~_at_seams(part, deck, edges)], z, terrain, obstacles, part.road
    )
    batches.append(body_batch(earth, f"embankments {number}", EARTH))
    opened = filled & ~covered & ~_in_areas(layout, middle, AFLOAT)
    return surfaces, concatenate(batches), _outline(deck, opened)


def _regions(layout: Layout, part: _Tier, detail: bool, painting: Painting) -> Regions:
    """Return the surfaces of a tier, made as those of the ground are."""
    sub = part.network
    found = [_other_regions(layout, part)]
    if sub.edge_count:
        if detail:
            found += [street_regions(layout, sub, painting)[0], _shoulders(sub)]
        else:
            found.append(plain_carriageways(layout, sub, np.ones(sub.edge_count, bool)))
    return join_regions([*found, _islands(found), _ends(part)])


def _open_wells(found: Regions, part: _Tier, network: RoadNetwork) -> Regions:
    """Cut away lawns of large islands under which a carriageway passes."""
    lawn = np.flatnonzero((found.label == LABEL["grass"]) & (shapely.area(found.polygons) > ISLAND))
    if not len(lawn):
        return found
    polygons = found.polygons[lawn]
    shapes = to_linestrings(edge_lines(network))
    well, edge = shapely.STRtree(shapes).query(polygons, predicate="intersects")
    lowest = np.minimum.reduceat(network.z, network.point_start[:-1])
    height = _surface_heights(part, shapely.get_coordinates(shapely.point_on_surface(polygons)))
    rows = lawn[np.unique(well[lowest[edge] < height[well] - STORY])]
    label = found.label.copy()
    label[rows] = LABEL["void"]  # at a lawn's priority: carriageways that cross it stay
    return replace(found, label=label)


def _islands(found: list[Regions]) -> Regions:
    """Pave what surfaces leave open between them, up to the size of a traffic island."""
    shapes = np.concatenate([part.polygons for part in found])
    whole = shapely.unary_union(shapely.make_valid(shapes))
    rings = shapely.get_rings(shapely.get_parts(whole))
    inner = shapely.polygons(rings[~shapely.is_ccw(rings)])
    return regions(inner[shapely.area(inner) < ISLAND], LABEL["sidewalk"], 0)


def _ends(part: _Tier) -> Regions:
    """Return what lies past the ends of ways, where kerbs run across them: it is cut away."""
    lines = part.lines
    count, cars = lines.count, part.network.edge_count
    foot = np.concatenate([lines.start[:-1], lines.start[1:] - 1])
    inward = np.concatenate([lines.start[:-1] + 1, lines.start[1:] - 2])
    place = np.unique(np.rint(lines.points[foot] * 1000), axis=0, return_inverse=True)[1].ravel()
    for side in (0, 1):
        place[side * count : side * count + cars] = -1 - part.network.edge_nodes[:, side]
    _, which, often = np.unique(place, return_inverse=True, return_counts=True)
    alone = np.flatnonzero(often[which] == 1)
    at = lines.points[foot[alone]]
    out = at - lines.points[inward[alone]]
    out /= np.maximum(np.hypot(*out.T), 1e-9)[:, None]
    across = np.column_stack([-out[:, 1], out[:, 0]])
    across *= (part.reach[lines.line_of_point()[foot[alone]]] + 1.0)[:, None]
    past = at + PAST * out
    ring = np.stack([at - across, at + across, past + across, past - across], axis=1)
    return regions(shapely.polygons(ring), LABEL["void"], SURFACES[LABEL["void"]].priority)


def _shoulders(sub: RoadNetwork) -> Regions:
    """Lay a band of kerb stones along carriageways without walks, for the parapets to stand on."""
    lines = shapely.simplify(to_linestrings(edge_lines(sub)), FINE)
    reach = sub.half_width + 2 * KERB_WIDTH
    bands = shapely.buffer(lines, reach, cap_style="flat", join_style="mitre", mitre_limit=MITRE)
    return regions(shapely.unary_union(bands), LABEL["kerb"], 1)


def _other_regions(layout: Layout, part: _Tier) -> Regions:
    """Return paths and tracks."""
    other = part.others
    if not other.count:
        return Regions()
    kind = layout.roads["kind"].to_numpy().astype(str)[other.road]
    ids = layout.roads["id"].to_numpy()[other.road]
    surface = layout.roads["surface"].to_numpy().astype(str)[other.road]
    lines = shapely.simplify(to_linestrings(Polylines(other.points, other.point_start)), FINE)
    bands = shapely.buffer(lines, other.half_width, cap_style="flat", join_style="mitre",
                           mitre_limit=MITRE)  # fmt: skip
    rails = np.isin(kind, RAILS)
    stone = np.isin(surface, STONE) | (kind == "steps") | (kind == "pedestrian")
    label = np.select([rails, stone], [LABEL["railway"], LABEL["sidewalk"]], LABEL["path"])
    found = [regions(bands, label, SURFACES[LABEL["path"]].priority, ids)]
    if rails.any():
        found.append(regions(rail_strips(lines[rails]), LABEL["rail"], 60))
    return join_regions(found)


def _streets_above(part: _Tier, terrain: Terrain, beside: Shapes) -> Regions:
    """Return where streets at the rim of open cuttings keep their ground: no walk lies there."""
    lines, lift = part.lines, part.z - terrain.height_at(part.lines.points)
    owner = lines.line_of_point()
    roofed = (part.level[owner] < 0) & (lift < -(part.room + CEILING)[owner])
    deep = (lift < -PARAPET_FROM) & ~roofed
    first = np.flatnonzero((owner[1:] == owner[:-1]) & deep[1:] & deep[:-1])
    runs = shapely.linestrings(np.stack([lines.points[first], lines.points[first + 1]], axis=1))
    cut = shapely.buffer(runs, part.reach[owner[first]] + 2 * KERB_WIDTH, cap_style="flat")
    one, other = shapely.STRtree(beside).query(cut, predicate="intersects")
    shapes = shapely.get_parts(shapely.intersection(cut[one], beside[other]))
    shapes = shapes[shapely.get_dimensions(shapes) == 2]
    label = LABEL["void"]
    return regions(shapes, label, SURFACES[LABEL["carriageway"]].priority - 1)


def _bars(part: _Tier, terrain: Terrain, slack: float) -> Shapes:
    """Lines across where faces are cut to follow the profile, or what stands on them changes."""
    lines = part.lines
    owner = lines.line_of_point()
    across = miters(lines) * (part.reach[owner] + 1.0)[:, None]
    bent = _bent(part, terrain, slack)
    at = [np.stack([lines.points[bent] - across[bent], lines.points[bent] + across[bent]], axis=1)]
    lift = part.z - terrain.height_at(lines.points)
    first = np.flatnonzero(owner[1:] == owner[:-1])
    level = (LOW, PARAPET_FROM, -WALL_FROM)
    limits = [np.full(lines.count, height) for height in level]
    for limit in (*limits, -(part.room + CEILING)):
        over = lift - limit[owner]
        cut = first[over[first] * over[first + 1] < 0]
        share = ((limit[owner[cut]] - lift[cut]) / (lift[cut + 1] - lift[cut]))[:, None]
        spot = lines.points[cut] * (1 - share) + lines.points[cut + 1] * share
        way = across[cut] * (1 - share) + across[cut + 1] * share
        at.append(np.stack([spot - way, spot + way], axis=1))
    return np.asarray(shapely.linestrings(np.concatenate(at)))


def _bent(part: _Tier, terrain: Terrain, slack: float) -> BoolArray:
    """(p,) stations at which the surface or the ground below it bends, and the ends of ways."""
    lines = part.lines
    across = miters(lines) * part.reach[lines.line_of_point()][:, None]
    places = (lines.points, lines.points - across, lines.points + across)
    heights = [h for xy in places for h in (_surface_heights(part, xy), terrain.height_at(xy))]
    return bends(lines, np.column_stack(heights), slack)


def _passing_edges(part: _Tier, network: RoadNetwork) -> Shapes:
    """Lines along carriageways that pass under, between which a deck spans, and of those beside."""
    lines = edge_lines(network)
    shapes, own = to_linestrings(lines), to_linestrings(part.lines)
    way, edge = shapely.STRtree(shapes).query(own, predicate="dwithin", distance=part.reach + UNDER)
    highest = np.maximum.reduceat(part.z, part.lines.start[:-1])
    lowest = np.minimum.reduceat(network.z, network.point_start[:-1])
    passes = highest[way] - lowest[edge] > STORY
    below = np.unique(edge[passes])
    beside = np.unique(edge[~np.isin(network.edge_id[edge], part.network.edge_id)])
    chosen = np.concatenate([below, beside])
    reach = network.half_width[chosen] + np.repeat([UNDER, 0.0], [len(below), len(beside)])
    ways = shapely.simplify(shapes[chosen], FINE)
    return np.asarray(shapely.boundary(shapely.buffer(ways, reach, quad_segs=2)))


def _surface_heights(part: _Tier, points: FloatArray) -> FloatArray:
    """Heights at (n, 2) places: of the way they lie on, blended where several are near."""
    shapes = to_linestrings(part.lines)
    spots = shapely.points(points)
    tree = shapely.STRtree(spots)
    line, spot = tree.query(shapes, predicate="dwithin", distance=part.reach + BLEND)
    alone = np.setdiff1d(np.arange(len(points)), spot)
    if len(alone):
        extra, nearest = shapely.STRtree(shapes).query_nearest(spots[alone], all_matches=False)
        line, spot = np.concatenate([line, nearest]), np.concatenate([spot, alone[extra]])
    along = shapely.line_locate_point(shapes[line], spots[spot])
    far = shapely.distance(shapes[line], spots[spot])
    height = values_along(part.lines, part.z, line, along)
    beyond = np.maximum(far - part.half[line], 0.0)
    pull = 1.0 / (0.1 + beyond + AXIS * far) ** 4
    total = np.bincount(spot, pull, minlength=len(points))
    return np.asarray(np.bincount(spot, pull * height, minlength=len(points)) / total)


def _of_faces(deck: Ground, values: FloatArray) -> FloatArray:
    """(f, ...) values at one point in each face: the middle of one of its triangles."""
    face = deck.triangle_face
    first = np.searchsorted(face, np.arange(len(deck.face_label)))
    return np.asarray(values[deck.triangles[first]].mean(axis=1))


def _in_areas(layout: Layout, points: FloatArray, kinds: tuple[str, ...]) -> BoolArray:
    found = np.zeros(len(points), bool)
    tree = shapely.STRtree(_areas(layout, kinds))
    found[tree.query(shapely.points(points), predicate="intersects")[0]] = True
    return found


def _areas(layout: Layout, kinds: tuple[str, ...]) -> Shapes:
    rows = layout.areas["kind"].isin(kinds).to_numpy()
    return np.asarray(layout.areas.geometry.to_numpy()[rows])


def _outline(deck: Ground, chosen: BoolArray) -> Shapes:
    """Return the union of faces as polygons with the arrangement's own corners."""
    rows = np.flatnonzero(chosen[deck.triangle_face])
    if not len(rows):
        return np.zeros(0, object)
    triangles = shapely.polygons(deck.vertices[deck.triangles[rows]])
    return np.asarray(shapely.get_parts(shapely.coverage_union_all(triangles)))


def _at_seams(part: _Tier, deck: Ground, edges: IntArray) -> BoolArray:
    """(k,) whether edges lie across the ends of ways, where no parapet stands."""
    lines = part.lines
    owner = lines.line_of_point()
    ends = np.concatenate([lines.start[:-1], lines.start[1:] - 1])
    across = miters(lines)[ends] * (part.reach[owner[ends]] + 0.6)[:, None]
    bars = np.stack([lines.points[ends] - across, lines.points[ends] + across], axis=1)
    seam = shapely.STRtree(shapely.linestrings(bars))
    found = np.ones(len(edges), bool)
    for side in (0, 1):
        spots = shapely.points(deck.vertices[edges[:, side]])
        near = np.zeros(len(edges), bool)
        near[seam.query(spots, "dwithin", distance=SAME_PLACE)[0]] = True
        found &= near
    return found


def _rims(
    part: _Tier, deck: Ground, network: RoadNetwork, group: IntArray, z: FloatArray,
    soil: FloatArray, ceiling: FloatArray, covered: BoolArray, thick: FloatArray,
) -> list[Bodies]:  # fmt: skip
    """Raise parapets along decks and walls along cuttings."""
    edges, inside, _ = rim_edges(deck, group)
    if not len(edges):
        return []
    at_seam = _at_seams(part, deck, edges)
    lift = (z - soil)[edges].mean(axis=1)
    kind = np.select(
        [at_seam, covered[inside], lift > PARAPET_FROM, lift < -WALL_FROM], [-1, 2, 0, 1], -1
    )
    made: list[Bodies] = []
    crown = np.maximum(z, soil) + PARAPET
    kind[_in_the_way(deck, network, edges, CUTTING_WALL, z - 2 * DECK, crown)] = -1
    shapes = (
        (z - SOFFIT, z + PARAPET, PARAPET_WIDTH),
        (z - FOOTING, soil + CUTTING_PARAPET, CUTTING_WALL),
        (z - FOOTING, ceiling + CEILING, CUTTING_WALL),
    )
    for number, (low, high, width) in enumerate(shapes):
        for depth in np.unique(thick[inside[kind == number]]) if number == 0 else (0.0,):
            chosen = edges[(kind == number) & ((thick[inside] == depth) | (number > 0))]
            vertex, start = chains_of(chosen, np.zeros(len(chosen), np.int64))
            lines = Polylines(deck.vertices[vertex], start)
            made.append(beams(lines, low[vertex] - depth, high[vertex], 0.0, width))
    return made


def _traffic(
    network: RoadNetwork, points: FloatArray, margin: float,
    counts: Callable[[IntArray, FloatArray], BoolArray],
) -> BoolArray:  # fmt: skip
    """(n,) whether a carriageway passes at a place, at a height that counts.

    ``counts`` is asked with (k,) places and heights of carriageways there.
    """
    lines = edge_lines(network)
    shapes, spots = to_linestrings(lines), shapely.points(points)
    found = np.zeros(len(points), bool)
    if not len(shapes) or not len(points):
        return found
    line, spot = shapely.STRtree(spots).query(
        shapes, predicate="dwithin", distance=network.half_width + margin
    )
    along = shapely.line_locate_point(shapes[line], spots[spot])
    height = values_along(lines, network.z, line, along)
    found[spot[counts(spot, height)]] = True
    return found


def _headwalls(
    deck: Ground, network: RoadNetwork, covered: BoolArray, solid: BoolArray, low: FloatArray,
    soil: FloatArray,
) -> Bodies:  # fmt: skip
    """Close the space over the mouth of a tunnel up to a parapet above the ground."""
    edges, _, beyond = rim_edges(deck, np.where(covered, 0, -1))
    edges = edges[(beyond >= 0) & solid[np.maximum(beyond, 0)]]
    high = soil + CUTTING_PARAPET
    edges = edges[~_in_the_way(deck, network, edges, CUTTING_WALL, low, high)]
    vertex, start = chains_of(edges, np.zeros(len(edges), np.int64))
    return beams(Polylines(deck.vertices[vertex], start), low[vertex], high[vertex], 0.0,
                 CUTTING_WALL)  # fmt: skip


def _in_the_way(
    deck: Ground, network: RoadNetwork, edges: IntArray, width: float, low: FloatArray,
    high: FloatArray,
) -> BoolArray:  # fmt: skip
    """(k,) whether a wall to the right of edges would stand in a carriageway at its height.

    ``low`` and ``high`` are (n,) heights of its foot and its crown at all vertices.
    """
    ends = deck.vertices[edges]
    run = np.diff(ends, axis=1)[:, 0]
    right = np.column_stack([run[:, 1], -run[:, 0]]) / np.maximum(np.hypot(*run.T), 1e-9)[:, None]
    middle = ends.mean(axis=1) + right * width / 2
    foot, crown = low[edges].mean(axis=1), high[edges].mean(axis=1)
    return _traffic(network, middle, 0.0, lambda row, at: (at > foot[row]) & (at < crown[row]))


def _piers(
    part: _Tier, deck: Ground, spanning: BoolArray, terrain: Terrain, layout: Layout
) -> Bodies:
    """Stand piers under decks, clear of the ways below."""
    lines = part.lines
    length = arc_lengths(lines)[1]
    line, along = every(length, PIER_EVERY, np.minimum(PIER_EVERY / 2, length / 3))
    below = layout.roads
    kind = below["kind"].to_numpy().astype(str)
    level = way_levels(layout)
    under = np.flatnonzero((level < part.level.max(initial=0)) & (level >= 0))
    walked = np.isin(kind[under], WALKED)
    half = np.maximum(below["width"].to_numpy(float)[under], 2.0) / 2 + 0.8
    half = np.where(np.isin(kind[under], RAILS), 3.2, np.where(walked, 1.6, half))
    ways = shapely.buffer(below.geometry.to_numpy()[under], half, quad_segs=2)
    tree = shapely.STRtree(ways)
    stands = np.full(len(line), np.nan)  # metres along its line
    wide = np.minimum(PIER_WIDE * 2 * part.reach, 2 * part.reach - 1.0)[line]
    rows = deck.triangles[spanning[deck.triangle_face]]
    for shift in PIER_SHIFTS:
        open_ = np.flatnonzero(np.isnan(stands))
        if not len(open_):
            break
        tried = along[open_] + shift
        at, ahead = locate(lines, line[open_], tried)
        drop = values_along(lines, part.z, line[open_], tried) - terrain.height_at(at)
        side = np.column_stack([-ahead[:, 1], ahead[:, 0]]) * wide[open_, None] / 2
        legs = shapely.linestrings(np.stack([at - side, at + side], axis=1))
        free = np.ones(len(open_), bool)
        free[tree.query(legs, predicate="intersects")[0]] = False
        free &= (drop > PIER_FROM) & in_triangles(at, deck.vertices, rows)
        stands[open_[free]] = tried[free]
    found = np.flatnonzero(np.isfinite(stands))
    at, ahead = locate(lines, line[found], stands[found])
    # A beam as wide as the pier along a line as long as it is thick.
    half = ahead * PIER_THICK / 2
    legs = np.stack([at - half, at + half], axis=1).reshape(-1, 2)
    top = values_along(lines, part.z, line[found], stands[found]) - DECK + SOFFIT
    foot = terrain.height_at(at) - FOOTING
    width = wide[found] / 2
    return beams(Polylines(legs, 2 * np.arange(len(found) + 1)), np.repeat(foot, 2),
                 np.repeat(top, 2), -width, width)  # fmt: skip


def body_batch(bodies: Bodies, name: str, material: str = "concrete") -> MeshBatch:
    """Make an object of each body, named by where it stands."""
    count, size = len(bodies.key), len(bodies.vertices)
    vertex, face = (np.argsort(of, kind="stable") for of in (bodies.vertex_body, bodies.face_body))
    vertex_start = np.searchsorted(bodies.vertex_body[vertex], np.arange(count + 1))
    face_start = np.searchsorted(bodies.face_body[face], np.arange(count + 1))
    moved = np.empty(size, np.int64)
    moved[vertex] = np.arange(size)
    faces, vertices = bodies.faces[face], bodies.vertices[vertex]
    corner = np.zeros((0, 3), int)
    if count:
        lowest = np.minimum.reduceat(vertices, vertex_start[:-1])
        corner = np.rint(lowest * 100).astype(int)
    return MeshBatch(
        np.array([stable_id(name, *place) for place in corner.tolist()], np.uint64),
        vertex_start.astype(np.int64),
        face_start.astype(np.int64),
        vertices,
        np.where(faces < 0, NO_VERTEX, moved[faces]).astype(np.int32),
        np.zeros(len(faces), np.int16),
        (material,),
        bodies.uv[face].astype(np.float32),
        np.ones((len(faces), 3), np.float32),
    )


def road_pieces(heights: WayHeights, layout: Layout) -> dict[int, list[tuple[float, float]]]:
    """Return, for each path or track that leaves the ground, the intervals in which it does."""
    found: dict[int, list[tuple[float, float]]] = {}
    for row in np.flatnonzero(heights.edge < 0).tolist():
        line = shapely.linestrings(
            heights.points[heights.point_start[row] : heights.point_start[row + 1]]
        )
        way = layout.roads.geometry.iloc[int(heights.road[row])]
        ends = shapely.line_locate_point(way, shapely.points(shapely.get_coordinates(line)))
        found.setdefault(int(heights.road[row]), []).append((float(ends.min()), float(ends.max())))
    return found


def grounded_lines(layout: Layout, heights: WayHeights) -> Shapes:
    """Return the lines of all ways without the pieces of paths and tracks off the ground."""
    lines = layout.roads.geometry.to_numpy().copy()
    for row, parts in road_pieces(heights, layout).items():
        packed = pack([lines[row]])
        length = float(arc_lengths(packed)[1][0])
        at, rest = 0.0, []
        for begin, end in sorted(parts):
            if begin - at > SAME_PLACE:
                rest.append((at, begin))
            at = max(at, end)
        if length - at > SAME_PLACE:
            rest.append((at, length))
        pieces = [substring(lines[row], begin, end) for begin, end in rest]
        lines[row] = shapely.union_all(pieces)
    return np.asarray(lines)
