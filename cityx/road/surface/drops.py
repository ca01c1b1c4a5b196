"""Curb ramp (dropped kerb): where a crossing meets the walk, or the walk a drive."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.ground import DROPPED, KERB_HEIGHT, KERB_WIDTH, LABEL, SURFACES
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.polylines import locate
from cityx.geometry.ranges import numbered
from cityx.ground.arrangement import GRID, Regions, join_regions, regions
from cityx.ground.drape import RAMP_SLOPE
from cityx.ground.walking.mapped_crossings import raised_kerbs
from cityx.places.painting import Ribs
from cityx.road.markings.crossing_places import dense_places
from cityx.road.markings.marks import PLAIN, Shapes, Street
from cityx.road.markings.zebras import FLARE, FLARED, Zebras, joined
from cityx.road.network.network import arm_bearings, arms_of
from cityx.road.surface.carriageway import Carriageway, Unions
from cityx.road.surface.corners import LEAST_RADIUS, RADIUS

RAMP = RAMP_SLOPE * (KERB_HEIGHT - DROPPED)  # metres
LEAST_WALK = 0.3  # metres left behind a ramp
RAYS, BEHIND = 11, 0.7  # across a crossing along which its kerb is sought; share that ribs clear
MOST_BEHIND = 1.2  # metres that they stand back for the curve of a kerb at most
BROAD = 5.0  # metres of walk in town that a strip crosses, up to the houses
SPARE = 0.05  # metres of a walk more than what is lowered takes
NARROW = 1.2  # metres of a walk in town that is lowered as a whole
_APART = r'"sidewalk(?::both|:left|:right)?": *"separate"'
END_STONES = SURFACES[LABEL["kerb_dropped"]].priority - 1  # over the kerb, under what is dropped
LEAST_SINE = 0.4  # of the angle between a drive and its street; a flatter one is no drive
KERB_REACH = 2.5  # metres from the rim of a street to a kerb that the map draws as a point
FREE_SIDE = 0.2  # metres that a drop reaches beyond the bars at both ends


def dropped_regions(
    street: Street, zebras: Zebras, mouths: Zebras, road: Carriageway, ribs: Ribs
) -> Regions:
    """Lower the kerbs on both sides of crossings, with ribs and a ramp where there is a walk.

    Ribs lie in a straight row square to the way across, behind most of the kerb of the crossing.
    Where the kerb curves away what is left before them is ribbed as well, or only lowered where
    ribs do not begin at the kerb.

    Parameters
    ----------
    street
        The network and what its marks share.
    zebras
        The crossings.
    mouths
        Where walks go on across the mouths of streets without a crossing.
    road
        The surfaces along whose rims the kerbs run.
    ribs
        What lies before them.
    """
    names = np.where(zebras.kind == PLAIN, ribs.plain, ribs.painted)
    names = np.concatenate([names, np.full(len(mouths.edge), ribs.mouth)])
    zebras = joined(zebras, mouths)
    if not len(zebras.edge):
        return Regions()
    driven, rims = Unions(road.kerbed), Unions(road.kerbed, KERB_WIDTH)
    sides = []
    for sign in (1.0, -1.0):
        rows = ~_raised(street, zebras, sign)
        sides.append(_side(street, zebras.take(rows), names[rows], driven, rims, ribs, sign))
    shapes = {name: np.concatenate([side[name] for side in sides]) for name in sides[0]}
    shapes = {name: shapely.make_valid(each) for name, each in shapes.items()}
    ribbed = [each for name, each in shapes.items() if name in names]
    rows = np.concatenate([np.zeros(0, object), *ribbed])
    over = rows
    for name in ("landing", "guide_strip", "ramp"):
        shapes[name] = _without(shapes[name], Unions(over))
        over = np.concatenate([over, shapes[name]])
    # No line of theirs cuts slivers off what is driven on.
    shapes = {name: _without(each, driven) for name, each in shapes.items()}
    parts = []
    for name, each in shapes.items():
        label = LABEL["ramp" if name == "kerb ends" else name]
        rank = END_STONES if name == "kerb ends" else SURFACES[label].priority
        parts.append(regions(each, label, rank))
    return join_regions(parts)


def _raised(street: Street, zebras: Zebras, sign: float) -> BoolArray:
    """(z,) whether the map says that the kerb on one side of a crossing is as high as elsewhere."""
    found = np.zeros(len(zebras.edge), bool)
    at, ahead = locate(street.lines, zebras.edge, zebras.along)
    half = street.network.half_width[zebras.edge][:, None]
    rim = at + sign * half * np.column_stack([-ahead[:, 1], ahead[:, 0]])
    mapped = street.mapped
    middles = locate(street.lines, mapped.edge[mapped.raised], mapped.along[mapped.raised])[0]
    for places, said, reach in (
        (at, shapely.points(middles), zebras.depth), (rim, raised_kerbs(street.layout), KERB_REACH)
    ):  # fmt: skip
        near = shapely.STRtree(said).query(shapely.points(places), "dwithin", reach)[0]
        found[near] = True
    return found


def _side(
    street: Street, zebras: Zebras, names: NDArray[np.str_], driven: Unions, rims: Unions,
    ribs: Ribs, sign: float,
) -> dict[str, Shapes]:  # fmt: skip
    """Return what is lowered on one side of crossings, 1 for the left, by its surface."""
    table = street.layout.roads.iloc[street.network.edge_road[zebras.edge]]
    every, half = np.arange(len(names)), street.network.half_width[zebras.edge]
    depth = np.where(names == "", 0.0, ribs.gap + ribs.depth)
    deep = depth + RAMP + LEAST_WALK
    walk = table["sidewalk_left" if sign > 0 else "sidewalk_right"].to_numpy(float)
    apart = table["tags"].str.contains(_APART, regex=True).to_numpy().astype(bool)
    # In town the ground behind a narrow walk is paved, up to the houses if need be.
    town = dense_places(street.layout, locate(street.lines, zebras.edge, zebras.along)[0])
    walk = np.where(apart | (town & (walk >= NARROW)), np.maximum(walk, deep + SPARE), walk)
    broad = np.where(town, np.maximum(walk, BROAD), walk)
    sloped = walk > RAMP + LEAST_WALK
    ribbed = (depth > 0) & (walk > deep)
    kerb = _kerbs(street, zebras, driven, sign) + KERB_WIDTH
    front = np.where(ribbed, kerb + ribs.gap, kerb)
    back = np.where(ribbed, front + ribs.depth, kerb)
    outer = sign * (half + KERB_WIDTH + zebras.flare)
    # The walk falls towards the crossing from three sides, and so do the kerb's end stones. Where
    # a street bends its kerb is straight for a while, nearer to the middle than half the street.
    inner = sign * np.maximum(half - FLARE, 0.0)
    stones, ends = (patches(street, zebras, every, inner, outer, p) for p in (0.0, RAMP))
    begin = half if ribs.gap == 0 else front
    row = patches(street, zebras, every, sign * begin, sign * back)
    landing = patches(street, zebras, every, sign * half, sign * front)
    slope = patches(street, zebras, every, sign * half, sign * (back + RAMP), RAMP)
    return {
        "kerb_dropped": along_rims(stones, rims),
        "kerb ends": along_rims(ends[sloped], rims),
        **{name: row[ribbed & (names == name)] for name in np.unique(names).tolist() if name},
        "guide_strip": _strips(street, zebras, ribs, sign, ribbed, back, half + KERB_WIDTH + broad),
        "landing": landing[sloped & (front > half + KERB_WIDTH + GRID)],
        "ramp": slope[sloped],
    }


def _strips(
    street: Street, zebras: Zebras, ribs: Ribs, sign: float, ribbed: BoolArray, front: FloatArray,
    back: FloatArray,
) -> Shapes:  # fmt: skip
    """Return strips across the walk to crossings with paint, on the right of those who cross.

    Each is cut at the head of the ramp that it climbs.
    """
    rows = np.flatnonzero(ribbed & (zebras.kind != PLAIN))
    if not ribs.strip or not len(rows):
        return np.zeros(0, object)
    aside = zebras.depth / 2 + FREE_SIDE - ribs.strip / 2
    narrow = np.full(len(aside), ribs.strip - 2 * FREE_SIDE)
    there = replace(zebras, along=zebras.along - sign * aside, depth=narrow)
    head = front[rows] + RAMP
    tail = np.maximum(back[rows], head + SPARE)
    return np.concatenate([
        patches(street, there, rows, sign * begin, sign * end)
        for begin, end in ((front[rows], head), (head, tail))
    ])  # fmt: skip


def _without(shapes: Shapes, things: Unions) -> Shapes:
    """Cut things out of shapes."""
    row, thing = things.tree.query(shapes, predicate="intersects")
    left = shapes.copy()
    if len(row):
        taken, rows = things.of(thing, row)
        left[rows] = shapely.difference(shapes[rows], taken)
    return left


def _kerbs(street: Street, zebras: Zebras, driven: Unions, sign: float) -> FloatArray:
    """(z,) metres left of the centreline, times `sign`, that most of the kerb is nearer than.

    That is half the street but where its kerb has begun to curve, or the map draws it elsewhere.
    """
    found = street.network.half_width[zebras.edge].copy()
    flare, rows = zebras.flare, np.flatnonzero(zebras.flared)
    if not len(rows):
        return found
    edge, near = zebras.edge[rows], found[rows] - FLARE
    reach = zebras.depth[rows] / 2 + FREE_SIDE
    at, ahead = locate(street.lines, edge, zebras.along[rows])
    left = sign * np.column_stack([-ahead[:, 1], ahead[:, 0]])
    step = np.linspace(-1.0, 1.0, RAYS)[None, :, None] * reach[:, None, None]
    foot = at[:, None] + ahead[:, None] * step + left[:, None] * near[:, None, None]  # (k, r, 2)
    tip = foot + left[:, None] * (FLARE + flare[rows])[:, None, None]
    rays = shapely.multilinestrings(shapely.linestrings(np.stack([foot, tip], axis=2)))  # (k,)
    own, surface = driven.tree.query(rays, predicate="intersects")
    paved, group = driven.of(surface, own)
    # All rays of a crossing are cut at once; they lie apart, so that pieces tell theirs.
    free, crossing = shapely.get_parts(shapely.difference(rays[group], paved), return_index=True)
    free, crossing = free[~shapely.is_empty(free)], crossing[~shapely.is_empty(free)]
    middle = shapely.get_coordinates(shapely.line_interpolate_point(free, 0.5, normalized=True))
    aside = ((middle - at[group][crossing]) * ahead[group][crossing]).sum(axis=1)
    ray = np.rint((aside / reach[group][crossing] + 1) * (RAYS - 1) / 2).astype(np.int64)
    off = np.full((len(group), RAYS), np.inf)
    away = shapely.distance(free, shapely.points(foot[group][crossing, ray]))
    np.minimum.at(off, (crossing, ray), away)
    rows = rows[group]
    first = np.sort(np.where(np.isfinite(off), off, FLARE + flare[rows][:, None]), axis=1)
    most = np.where(flare[rows] > FLARED, flare[rows], MOST_BEHIND)
    found[rows] += np.round(np.clip(first[:, int(BEHIND * (RAYS - 1))] - FLARE, 0.0, most), 3)
    return found


def drive_regions(street: Street, road: Carriageway) -> Regions:
    """Lower the kerbs at both sides of service ways where they cross the walk of a street.

    Round the corners of the drive the walk rises along the street's kerb, too.
    """
    mouths = _mouths(street)
    if not len(mouths.place):
        return Regions()
    drawn = Unions(road.drawn)
    rims = {width: Unions(road.kerbed, width) for width in (KERB_WIDTH, KERB_WIDTH + RAMP)}
    shapes, ends = (_mouth_shapes(mouths, past) for past in (0.0, 2 * RAMP))
    parts = []
    for name, rank, where, width in (
        ("kerb_dropped", 0, shapes, KERB_WIDTH),
        ("ramp", END_STONES, ends, KERB_WIDTH),
        ("ramp", 0, ends, KERB_WIDTH + RAMP),
    ):
        priority = rank or SURFACES[LABEL[name]].priority
        lowered = _without(along_rims(where, rims[width]), drawn)
        parts.append(regions(lowered, LABEL[name], priority))
    return join_regions(parts)


@dataclass(frozen=True)
class _Mouths:
    """Drives where they cross the walk of a street, m of them, in the frame of the street.

    Attributes
    ----------
    place, along
        (m, 2) float: where the drive leaves the street's middle, and the way along the street.
    away
        (m,) 1 where the drive goes to the left of that way, -1 to the right.
    slant
        (m,) cotangent of the angle between the two.
    near, far
        (m,) metres from the street's middle to its kerb, and to the back of its walk.
    behind, ahead
        (m,) metres along the street that the mouth takes to both sides of the drive's middle.
    """

    place: FloatArray
    along: FloatArray
    away: FloatArray
    slant: FloatArray
    near: FloatArray
    far: FloatArray
    behind: FloatArray
    ahead: FloatArray


def _mouths(street: Street) -> _Mouths:
    """Find the mouths of drives at streets that have walks, where the drive is long enough."""
    network = street.network
    table = street.layout.roads.iloc[network.edge_road]
    walk = np.maximum(
        table["sidewalk_left"].to_numpy(float), table["sidewalk_right"].to_numpy(float)
    )
    service = street.kind == "service"
    node, edge, end = arms_of(street.lines, network.edge_nodes)
    bearing = arm_bearings(street.lines, edge, end)
    count = len(network.node_position)
    of_node, half = np.zeros(count), np.zeros(count)
    np.maximum.at(of_node, node[~service[edge]], walk[edge][~service[edge]])
    np.maximum.at(half, node[~service[edge]], network.half_width[edge][~service[edge]])
    drive = np.flatnonzero(service[edge] & (of_node[node] > RAMP + LEAST_WALK))
    other, found = _squarest(node, bearing, ~service[edge], drive)
    drive, other = drive[found], other[found]
    at = node[drive]
    turn = np.round(bearing[drive] - bearing[other], 6)
    sine, cosine = np.sin(turn), np.cos(turn)
    away = np.where(sine < 0, -1.0, 1.0)
    sine = np.maximum(np.abs(sine), LEAST_SINE)
    near, far = half[at], half[at] + KERB_WIDTH + of_node[at]
    room = far / sine < street.length[edge[drive]]
    # The curves of both corners, and the drive itself, along the street.
    angle = np.arctan2(sine, cosine)  # to the arm ahead
    wide = network.half_width[edge[drive]] / sine + RAMP
    of_class = [RADIUS.get(word, LEAST_RADIUS) for word in street.kind[edge[other]].tolist()]
    radius = (np.array(of_class, float) + LEAST_RADIUS) / 2
    ahead = wide + radius / np.tan(angle / 2)
    behind = wide + radius * np.tan(angle / 2)
    way = bearing[other]
    along = np.column_stack([np.cos(way), np.sin(way)])
    found_all = _Mouths(network.node_position[at], along, away, cosine / sine, near, far, behind,
                        ahead)  # fmt: skip
    names = _Mouths.__dataclass_fields__
    return _Mouths(*(getattr(found_all, name)[room] for name in names))


def _squarest(
    node: IntArray, bearing: FloatArray, street: BoolArray, drive: IntArray
) -> tuple[IntArray, BoolArray]:
    """(k,) the arm of a street most square to each drive at its node, and whether there is one."""
    low = np.searchsorted(node, node[drive])
    size = np.searchsorted(node, node[drive], side="right") - low
    row = np.repeat(np.arange(len(drive)), size)
    arm = low[row] + numbered(size)
    row, arm = row[street[arm]], arm[street[arm]]
    slant = np.abs(np.cos(bearing[arm] - bearing[drive[row]]))
    order = np.lexsort((arm, np.round(slant, 6), row))
    known, first = np.unique(row[order], return_index=True)
    other, found = np.zeros(len(drive), np.int64), np.zeros(len(drive), bool)
    other[known], found[known] = arm[order[first]], True
    return other, found


def _mouth_shapes(mouths: _Mouths, past: float) -> Shapes:
    """(m,) the walks before drives, `past` metres more along the street."""
    left = np.column_stack([-mouths.along[:, 1], mouths.along[:, 0]]) * mouths.away[:, None]
    corners = []
    for off, ends in ((mouths.near, (-1, 1)), (mouths.far, (1, -1))):
        for end in ends:
            reach = np.where(end < 0, -mouths.behind, mouths.ahead) + end * past
            along = off * mouths.slant + reach
            corners.append(mouths.place + left * off[:, None] + mouths.along * along[:, None])
    return np.asarray(shapely.polygons(np.stack(corners, axis=1)))


def along_rims(shapes: Shapes, rims: Unions) -> Shapes:
    """Cut shapes to what lies so near the rims of what is driven on as these are wider."""
    patch, row = rims.tree.query(shapes, predicate="dwithin", distance=rims.width)
    near, of_patch = rims.of(row, patch)
    whole = shapely.make_valid(shapes[of_patch])  # where a way bends its patch may cross itself
    return np.asarray(shapely.intersection(whole, near))


def patches(
    street: Street, zebras: Zebras, rows: IntArray, near: FloatArray, far: FloatArray,
    past: float = 0.0,
) -> Shapes:  # fmt: skip
    """Return strips across crossings between two distances left of the centreline, (k,).

    They reach ``past`` metres farther along the street than a dropped kerb.
    """
    edge = zebras.edge[rows]
    reach = zebras.depth[rows] / 2 + FREE_SIDE + past
    corners = []
    for step, sides in ((-reach, (near, far)), (reach, (far, near))):
        at, ahead = locate(street.lines, edge, zebras.along[rows] + step)
        left = np.column_stack([-ahead[:, 1], ahead[:, 0]])
        corners += [at + left * side[:, None] for side in sides]
    return np.asarray(shapely.polygons(np.stack(corners, axis=1)))
