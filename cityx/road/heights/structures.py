"""Bridges with their ramps, cuttings and tunnels: surfaces like the ground's, on solid bodies."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.ops import substring

from cityx.city.ground import LABEL, Ground
from cityx.city.heights import WayHeights
from cityx.city.layout import Layout
from cityx.city.mesh import NO_VERTEX, MeshBatch, concatenate
from cityx.city.roads import RoadNetwork
from cityx.city.terrain import Terrain
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
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
from cityx.geometry.triangle_cells import in_triangles
from cityx.ground.arrangement import arrange, join_regions
from cityx.ground.drape import drape
from cityx.ground.standing import EARTH
from cityx.ground.structures import Bodies, beams, rim_edges, slabs
from cityx.ids import stable_id
from cityx.places.painting import Painting
from cityx.road.ground.joints import courses
from cityx.road.ground.landcover import AREA_SURFACE
from cityx.road.heights.embankments import (
    CUTTING_WALL,
    SOFFIT,
    Obstacles,
    at_seams,
    carriageway_passes,
    embankments,
    free_below,
    headwalls,
    rim_walls,
)
from cityx.road.heights.side_by_side import yielded
from cityx.road.heights.structure_surfaces import open_wells, streets_above, tier_regions
from cityx.road.heights.structure_tiers import (
    CEILING,
    FOOTING,
    PARAPET_FROM,
    SAME_PLACE,
    STORY,
    WALL_FROM,
    Tier,
    free_over,
    groups_of,
    heights_on,
    highest_on,
    tier_of,
)
from cityx.road.heights.tiers import Spans, cut_network, parted_network
from cityx.road.heights.way_heights import WATER
from cityx.road.markings.marks import USUAL
from cityx.road.network.stations import DECK, FOOT_DECK, ON_FOOT, RAILS, way_levels
from cityx.road.surface.carriageway import FINE

Shapes = NDArray[Any]

LOW = 2.2  # metres; a deck lower above the ground stands on fill
MOUTH = 60.0  # metres into a tunnel that anybody sees
TOP_GAP = 0.04  # metres from a surface down to the slab, so that they never flicker
THINNEST = 0.25  # metres of a slab
GAP = 0.1  # metres between the wall of a cutting and a carriageway at its rim
PIER_EVERY = 26.0  # metres
PIER_FROM = 3.2  # metres of height
PIER_SHIFTS = (0.0, 3.0, -3.0, 6.0, -6.0, 9.0, -9.0)  # metres along, clear of what passes below
PIER_THICK = 1.0  # metres along the deck
BESIDE_PIER = 0.8  # metres from a carriageway
DEEP = 6.0  # metres below the ground from which a way passes under a pier's foot
PIER_WIDE = 0.45  # of the deck's width
WALKED = (*ON_FOOT, "steps")
AFLOAT = tuple(kind for kind in WATER if AREA_SURFACE[kind] == "water")  # a marsh is land
EVERY = 1.0  # metres between places of paths that are looked at
STEP = 0.5  # metres; what lies less above a carriageway lies in it
UNDER = 1.5  # metres beside a carriageway that a deck over it spans too
# Metres by which a surface may miss its profile between two cuts: over the ten metres or more that
# lie between them nobody feels it; at detail level 0, what nobody sees beside a prism.
SLACK, PLAIN_SLACK = 0.04, 0.3


@dataclass(frozen=True)
class Structures:
    """All that lies off the ground.

    Attributes
    ----------
    surfaces
        Meshes of the carriageways, walks and markings, an object per surface.
    bodies
        Closed solids: slabs, fill, parapets, retaining walls, piers, ceilings.
    opening
        Polygons where there is no ground.
    left_out
        Rows of the layout's roads: paths and tracks of which a piece has no room.
    """

    surfaces: MeshBatch
    bodies: MeshBatch
    opening: Shapes
    left_out: IntArray


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
    streets = _strips(network)
    level, off = parted_network(network, heights)
    others = heights.take(np.flatnonzero((heights.edge < 0) & detail))
    roomy, seen = _with_room(layout, off, others, streets)
    roomy[roomy] = ~_low_over(network, others.take(np.flatnonzero(roomy)))
    left_out = np.unique(others.road[~roomy]).astype(np.int64)
    others = others.take(np.flatnonzero(roomy & seen))
    whole = tier_of(layout, off, others)
    obstacles = Obstacles(layout, _areas(layout, WATER))
    beside = _strips(level, CUTTING_WALL + GAP)
    surfaces, bodies, opening = [], [], [np.zeros(0, object)]
    for number, rows in enumerate(groups_of(whole)):
        cars = rows[rows < off.edge_count]
        part = tier_of(layout, _edges(off, cars), others.take(rows[len(cars) :] - off.edge_count))
        made = _build_tier(
            layout, part, network, terrain, seed, number, detail, painting, obstacles, beside
        )
        surfaces.append(made[0])
        bodies.append(made[1])
        opening.append(made[2])
    return Structures(concatenate(surfaces), concatenate(bodies), np.concatenate(opening), left_out)


def _edges(network: RoadNetwork, rows: IntArray) -> RoadNetwork:
    """Return some edges as a network of their own."""
    length = arc_lengths(network.lines)[1]
    off = np.ones(len(rows), bool)
    return cut_network(network, Spans(rows, np.zeros(len(rows)), length[rows], off),
                       np.arange(len(rows)))  # fmt: skip


def _strips(network: RoadNetwork, more: float = 0.0) -> Shapes:
    """Carriageways of the edges that lie on the ground, roughly, and `more` metres beside them."""
    lines = network.lines
    level = np.abs(network.lift) < WALL_FROM
    whole = np.ones(network.edge_count, bool)
    np.logical_and.at(whole, lines.line_of_point(), level)
    shapes = to_linestrings(lines)[whole]
    return np.asarray(shapely.buffer(shapes, network.half_width[whole] + more, cap_style="flat"))


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
) -> tuple[BoolArray, BoolArray]:
    """(w,) whether paths and tracks have room, and whether they are seen, those below from a mouth.

    Those that are low above a carriageway or would open it up, and cuttings that would open up a
    house, have none. Carriageways stay: they are roofed under houses.
    """
    houses = layout.buildings.geometry.to_numpy()
    cars, ways = (part.lines for part in (sub, other))
    mouths = []
    for lines, lift, road in ((cars, sub.lift, sub.edge_road), (ways, other.lift, other.road)):
        shallow = lift > -(free_over(layout, road) + CEILING)[lines.line_of_point()]
        opened = shallow & (lift < -WALL_FROM)
        mouths.append(lines.points[opened])
    # Streets join cuttings of streets; what is walked or rides on rails keeps off them.
    keep = ~_touching(ways, opened, houses) & ~_touching(ways, shallow & (lift < LOW), streets)
    tree = shapely.STRtree(shapely.points(np.concatenate(mouths)))
    seen = np.zeros(ways.count, bool)
    if ways.count and len(tree.geometries):
        seen[tree.query(to_linestrings(ways), "dwithin", distance=MOUTH)[0]] = True
    return keep, seen | (other.level >= 0)


def _low_over(network: RoadNetwork, ways: WayHeights) -> BoolArray:
    """(w,) whether paths and tracks pass over a carriageway too low for anything to move there."""
    lines = pack(shapely.segmentize(to_linestrings(ways.lines), EVERY))
    owner = lines.line_of_point()
    along = shapely.line_locate_point(to_linestrings(ways.lines)[owner],
                                      shapely.points(lines.points))  # fmt: skip
    z = values_along(ways.lines, ways.z, owner, along)
    low = carriageway_passes(
        network, lines.points, 0.0, lambda row, at: (at < z[row] - STEP) & (at > z[row] - LOW)
    )
    return np.bincount(owner, low, minlength=ways.count) > 0


def _build_tier(
    layout: Layout,
    part: Tier,
    network: RoadNetwork,
    terrain: Terrain,
    seed: int,
    number: int,
    detail: bool,
    painting: Painting,
    obstacles: Obstacles,
    beside: Shapes,
) -> tuple[MeshBatch, MeshBatch, Shapes]:
    found = open_wells(tier_regions(layout, part, detail, painting), part, network)
    left = yielded(layout, part, network)
    found = join_regions([found, streets_above(part, terrain, beside), left])
    bounds = shapely.total_bounds(found.polygons)
    extent = (bounds[0] - 1.0, bounds[1] - 1.0, bounds[2] + 1.0, bounds[3] + 1.0)
    slack = SLACK if detail else PLAIN_SLACK
    houses = _houses_over(layout, part, terrain)
    bars = np.concatenate([
        _bars(part, terrain, slack), _passing_edges(part, network), shapely.boundary(houses)
    ])  # fmt: skip
    deck = arrange(found, extent, lines=bars, background=LABEL["void"])
    z = heights_on(part, deck.vertices)
    soil = terrain.height_at(deck.vertices)
    surfaces = drape(
        deck, terrain, seed, base=np.round(z, 4), layer=f"structures {number}",
        paving=courses(deck, part.network) if detail else None,
    )  # fmt: skip
    solid = deck.face_label != LABEL["void"]
    lift = _of_faces(deck, z - soil)
    middle = _of_faces(deck, deck.vertices)
    wet = _in_areas(layout, middle, WATER)
    nearest = shapely.STRtree(to_linestrings(part.lines)).nearest
    way = nearest(shapely.points(middle))
    height = _of_faces(deck, z)
    below = carriageway_passes(network, middle, UNDER, lambda row, at: at < height[row] - STORY)
    spanning = solid & (part.level[way] > 0) & ((lift > LOW) | (wet & (lift > 0)))
    spanning |= solid & below
    covered = solid & (lift < -(part.room[way] + CEILING)) & (part.level[way] < 0)
    covered |= solid & (lift < -WALL_FROM) & (part.level[way] < 0) & _in(houses, middle)
    filled = solid & ~spanning
    walked = np.isin(layout.roads["kind"].to_numpy().astype(str)[part.road[way]], WALKED)
    group = np.select([spanning & walked, spanning, filled], [2, 1, 0], -1)
    low = np.stack([np.minimum(z, soil) - FOOTING, z - DECK, z - FOOT_DECK])
    # Over a carriageway with little room a slab is thinner.
    least = free_below(network, deck.vertices, UNDER + GAP, z)
    low = np.maximum(low, np.minimum(least, z - THINNEST))
    made = [slabs(deck, group, low, z - TOP_GAP)]
    thick = np.where(walked, FOOT_DECK, DECK)
    ceiling = np.round(highest_on(part, deck.vertices), 4)
    ceiling += part.room[nearest(shapely.points(deck.vertices))]
    if detail:
        made += rim_walls(
            part, deck, network, np.where(solid, 0, -1), z, soil, ceiling, covered, thick
        )
        made.append(_piers(part, deck, spanning, terrain, layout, network))
    if covered.any():
        made.append(slabs(deck, np.where(covered, 0, -1), ceiling, ceiling + CEILING))
        made.append(headwalls(deck, network, covered, solid, ceiling, soil))
    batches = [body_batch(bodies, f"structures {number} {k}") for k, bodies in enumerate(made)]
    edges, _, beyond = rim_edges(deck, np.where(filled, 0, -1))
    edges = edges[(beyond < 0) | ~solid[np.maximum(beyond, 0)]]
    earth = embankments(deck, edges[~at_seams(part, deck, edges)], z, terrain, obstacles, part.road)
    batches.append(body_batch(earth, f"embankments {number}", EARTH))
    # A deck over a tunnel that lies in the ground opens it: nothing covers the carriageway.
    opened = (filled & ~covered) | (spanning & (np.abs(lift) < DECK))
    afloat = _in_areas(layout, middle, AFLOAT)
    # Of a low deck over water the banks open, which its faces reach over.
    low_over = solid & ~covered & afloat & (np.abs(lift) < DECK)
    banks = _outline(deck, low_over)
    if len(banks):
        banks = shapely.difference(banks, shapely.union_all(_areas(layout, AFLOAT)))
        banks = shapely.get_parts(banks)
        banks = banks[shapely.area(banks) > 0]
    opened &= ~afloat
    return surfaces, concatenate(batches), np.concatenate([_outline(deck, opened), banks])


def _bars(part: Tier, terrain: Terrain, slack: float) -> Shapes:
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


def _bent(part: Tier, terrain: Terrain, slack: float) -> BoolArray:
    """(p,) stations at which the surface or the ground below it bends, and the ends of ways."""
    lines = part.lines
    across = miters(lines) * part.reach[lines.line_of_point()][:, None]
    places = (lines.points, lines.points - across, lines.points + across)
    heights = [h for xy in places for h in (heights_on(part, xy), terrain.height_at(xy))]
    return bends(lines, np.column_stack(heights), slack)


def _passing_edges(part: Tier, network: RoadNetwork) -> Shapes:
    """Lines along carriageways that pass under, between which a deck spans, and of those beside."""
    lines = network.lines
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


def _of_faces(deck: Ground, values: FloatArray) -> FloatArray:
    """(f, ...) values at one point in each face: the middle of one of its triangles."""
    face = deck.triangle_face
    first = np.searchsorted(face, np.arange(len(deck.face_label)))
    return np.asarray(values[deck.triangles[first]].mean(axis=1))


def _in_areas(layout: Layout, points: FloatArray, kinds: tuple[str, ...]) -> BoolArray:
    return _in(_areas(layout, kinds), points)


def _in(shapes: Shapes, points: FloatArray) -> BoolArray:
    """(n,) whether points lie in any of some shapes."""
    found = np.zeros(len(points), bool)
    found[shapely.STRtree(shapes).query(shapely.points(points), predicate="intersects")[0]] = True
    return found


def _houses_over(layout: Layout, part: Tier, terrain: Terrain) -> Shapes:
    """Return the outlines of houses over ways below the ground that are no deep tunnels there."""
    lines = part.lines
    owner = lines.line_of_point()
    lift = part.z - terrain.height_at(lines.points)
    deep = lift < -(part.room + CEILING)[owner]
    spots = np.flatnonzero((part.level[owner] < 0) & (lift < -WALL_FROM) & ~deep)
    houses = layout.buildings.geometry.to_numpy()
    found = shapely.STRtree(shapely.points(lines.points[spots])).query(
        houses, "dwithin", distance=float(part.reach.max(initial=0.0)) + UNDER
    )[0]
    return np.asarray(houses[np.unique(found)])


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


def _piers(
    part: Tier, deck: Ground, spanning: BoolArray, terrain: Terrain, layout: Layout,
    network: RoadNetwork,
) -> Bodies:  # fmt: skip
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
        high, soil = values_along(lines, part.z, line[open_], tried), terrain.height_at(at)
        drop = high - soil
        side = np.column_stack([-ahead[:, 1], ahead[:, 0]]) * wide[open_, None] / 2
        legs = shapely.linestrings(np.stack([at - side, at + side], axis=1))
        free = np.ones(len(open_), bool)
        free[tree.query(legs, predicate="intersects")[0]] = False
        for spot in (at - side, at, at + side):
            free &= ~_stands_in(network, spot, high, soil)
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


def _stands_in(
    network: RoadNetwork, points: FloatArray, high: FloatArray, soil: FloatArray
) -> BoolArray:
    """(n,) whether piers from the ground up to a deck would stand in a carriageway below it."""

    def below(row: IntArray, at: FloatArray) -> BoolArray:
        return np.asarray((at < high[row] - LOW) & (at > soil[row] - DEEP))

    return carriageway_passes(network, points, BESIDE_PIER, below)


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
