"""Covers of streets: gullies along the kerbs, manholes in the lanes, lids and patches in walks."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.assets.furniture.covers import cover
from cityx.city.city import City
from cityx.city.ground import ROADWAY
from cityx.city.scene import Instances
from cityx.geometry.arrays import BoolArray, FloatArray
from cityx.geometry.polylines import to_linestrings
from cityx.ids import hash_ids, uniform
from cityx.protocol import Port, Range, action, has_network
from cityx.road.surface.carriageway_regions import kerbed_edges, node_ids, road_labels
from cityx.road.surface.kerbs import KerbPlaces, join_places, places_along
from cityx.road.surface.roundabouts import ring_edges, rings_of
from cityx.road.surface.walk_covers import with_walk_covers

ACTION = "road/covers-v1"
NAMES = ("manhole", "gully")
GULLY_IN = -0.2  # metres from the kerb to the middle of a grate
MANHOLE_IN = 1.7  # metres from the kerb: near the middle of the lane
LEAST_HALF = 2.4  # metres of half carriageway that has manholes
SLACK = 0.5  # share of their spacing by which manholes leave their places
MARGIN = 3.0  # metres behind the junction
REACH = 2.0  # metres that a gully is moved to its kerb
AMID = (12.0, 1.2)  # metres from the node of a junction to its further manholes, and the first
APART = 8.0  # metres between manholes of a junction
SHORTEST = 0.1  # metres; shorter pieces of a kerb do not tell its direction


@action(
    ACTION,
    limits=["Runs at level of detail 2 and above; below it changes nothing."],
    requires=("layout", has_network()),
    after=("road/ground-v1",),
    takes=(Port("network", "line", role="road_network"),),
    gives=(Port("covers", "point", role="street_cover"),),
)
def covers(
    city: City, *,
    gullies: Annotated[float, Range(8.0, 200.0)] = 26.0,
    manholes: Annotated[float, Range(10.0, 500.0)] = 44.0,
) -> City:  # fmt: skip
    """Set gullies along the kerbs of streets, and manholes into their lanes and junctions.

    Parameters
    ----------
    gullies, manholes
        Metres between them along the street.
    """
    network = city.network
    if city.lod < 2 or network is None or not network.edge_count:
        return city
    table = city.layout.roads.iloc[network.edge_road]
    asphalt = road_labels(table["surface"].to_numpy()) == road_labels(["asphalt"])[0]
    flat = ~table["bridge"].to_numpy(bool) & ~table["tunnel"].to_numpy(bool)
    flat &= ~table["passage"].to_numpy(bool) & (table["layer"].to_numpy() == 0)
    street = kerbed_edges(city.layout, network) & flat
    edges = np.flatnonzero(street)
    wide = np.flatnonzero(street & asphalt & (network.half_width >= LEAST_HALF))
    grates = join_places(*(
        places_along(network, edges, side, spacing=gullies, beyond=GULLY_IN, margin=MARGIN)
        for side in (1, -1)
    ))  # fmt: skip
    holes = join_places(*(
        places_along(network, wide, side, spacing=manholes, beyond=-MANHOLE_IN, margin=2 * MARGIN,
                     phase=phase)
        for side, phase in ((1, 0.0), (-1, 0.5))
    ))  # fmt: skip
    grates = grates.take(~_round_islands(city, grates.xy))
    middle, turn, middle_ids = _amid_junctions(city, wide)
    ids = [
        hash_ids(0, f"{ACTION}/{name}", network.edge_id[places.edge],
                 2 * places.number + (places.side > 0))
        for name, places in zip(NAMES, (holes, grates), strict=True)
    ]  # fmt: skip
    moved = uniform(city.seed, f"{ACTION}/along", ids[0]) - 0.5
    aside = uniform(city.seed, f"{ACTION}/aside", ids[0]) - 0.5
    reach = np.minimum(SLACK * manholes / 2, 2 * MARGIN - 1.0)
    xy = holes.xy + holes.ahead * (reach * moved)[:, None]
    xy = xy + holes.toward_road * (0.5 * aside)[:, None]
    along, ahead, found = _at_kerbs(city, grates)
    places = np.concatenate([xy, middle, along])
    ahead = np.concatenate([holes.ahead, turn, ahead])
    kind = np.repeat([0, 1], [len(xy) + len(middle), len(along)])
    inside = _inside(places, city.layout.extent)
    inside[len(xy) + len(middle) :] &= found
    ids = [ids[0], middle_ids, ids[1]]
    laid = _with_covers(city, places[inside], ahead[inside], kind[inside],
                        np.concatenate(ids)[inside])  # fmt: skip
    return with_walk_covers(laid, np.flatnonzero(flat))


def _amid_junctions(
    city: City, wide: NDArray[np.int64]
) -> tuple[FloatArray, FloatArray, NDArray[np.uint64]]:
    """Manholes where sewers of streets meet: position, direction and id, the more the more arms."""
    network = city.network
    assert network is not None
    arms = np.bincount(network.edge_nodes[wide].ravel(), minlength=len(network.node_position))
    node = np.repeat(np.arange(len(arms)), np.where(arms >= 3, arms - 2, 0))
    number = np.arange(len(node)) - np.searchsorted(node, node)
    ids = hash_ids(0, f"{ACTION}/junction", node_ids(network)[node], number)
    angle = 2 * np.pi * uniform(city.seed, f"{ACTION}/angle", ids)
    far = np.where(number > 0, *AMID) * np.sqrt(uniform(city.seed, f"{ACTION}/far", ids))
    way = np.column_stack([np.cos(angle), np.sin(angle)])
    xy = np.round(network.node_position[node] + way * far[:, None], 3)
    on = np.ones(len(xy), bool) if city.ground is None else city.ground.on(xy, "junction")
    on &= _first_of_near(xy, on)
    return xy[on], way[on], ids[on]


def _first_of_near(xy: FloatArray, chosen: BoolArray) -> BoolArray:
    """(k,) which of the chosen places no earlier one that stays comes near."""
    rows = np.flatnonzero(chosen)
    spots = shapely.points(xy[rows])
    one, other = shapely.STRtree(spots).query(spots, predicate="dwithin", distance=APART)
    kept = np.ones(len(rows), bool)
    for later, earlier in sorted(zip(one.tolist(), other.tolist(), strict=True)):
        if earlier < later and kept[earlier]:
            kept[later] = False
    found = np.zeros(len(xy), bool)
    found[rows[kept]] = True
    return found


def _round_islands(city: City, xy: FloatArray) -> BoolArray:
    """Mark places on the inner side of roundabouts, from which water runs outward."""
    network = city.network
    assert network is not None
    lines = to_linestrings(network.lines)[ring_edges(city.layout, network)]
    found = np.zeros(len(xy), bool)
    inner = rings_of(lines).polygon
    found[shapely.STRtree(inner).query(shapely.points(xy), predicate="within")[0]] = True
    return found


def _at_kerbs(city: City, grates: KerbPlaces) -> tuple[FloatArray, FloatArray, BoolArray]:
    """Move gullies to the kerbs as they are laid: position, direction, and which have one.

    Kerbs leave their streets at corners and bays, and are dropped at crossings. Without a ground
    all stay where they are.
    """
    ground = city.ground
    if ground is None or not len(grates.xy):
        return grates.xy, grates.ahead, np.ones(len(grates.xy), bool)
    left, right = ground.edge_faces.T
    kerb, road = ground.labelled("kerb"), ground.labelled(*ROADWAY)
    beyond = np.maximum(right, 0)
    one = (right >= 0) & road[left] & kerb[beyond]  # the road on its left
    other = (right >= 0) & kerb[left] & road[beyond]
    ends = np.concatenate([ground.edges[one], ground.edges[other][:, ::-1]])
    begin, end = ground.vertices[ends[:, 0]], ground.vertices[ends[:, 1]]
    ahead = end - begin
    length = np.hypot(*ahead.T)
    long = length > SHORTEST
    begin, end, ahead = begin[long], end[long], ahead[long] / length[long][:, None]
    rims = shapely.linestrings(np.stack([begin, end], axis=1))
    spots = shapely.points(grates.xy)
    row, rim = shapely.STRtree(rims).query_nearest(spots, max_distance=REACH, all_matches=False)
    foot = shapely.get_coordinates(
        shapely.get_point(shapely.shortest_line(rims[rim], spots[row]), 0)
    )
    inward = np.column_stack([-ahead[:, 1], ahead[:, 0]])[rim]
    xy, direction, found = grates.xy.copy(), grates.ahead.copy(), np.zeros(len(spots), bool)
    xy[row] = np.round(foot - GULLY_IN * inward, 3)
    direction[row], found[row] = ahead[rim], True
    return xy, direction, found


def _inside(xy: FloatArray, extent: tuple[float, float, float, float]) -> BoolArray:
    low, high = np.array(extent[:2]), np.array(extent[2:])
    return np.asarray(((xy >= low) & (xy <= high)).all(axis=1))


def _with_covers(
    city: City, xy: FloatArray, ahead: FloatArray, kind: NDArray[np.int64],
    ids: NDArray[np.uint64],
) -> City:  # fmt: skip
    """Lay the covers on the slope of the street."""
    height = city.terrain.height_at
    step = 0.3
    rise = height(xy + step * ahead) - height(xy - step * ahead)
    left = np.column_stack([-ahead[:, 1], ahead[:, 0]])
    across = height(xy + step * left) - height(xy - step * left)
    rotation = np.column_stack([
        np.arctan2(across, 2 * step), -np.arctan2(rise, 2 * step),
        np.arctan2(ahead[:, 1], ahead[:, 0]),
    ])  # fmt: skip
    order = np.argsort(ids, kind="stable")
    count = len(order)
    rows = Instances(
        kind[order].astype(np.int32),
        ids[order],
        np.zeros(count, np.uint64),
        np.column_stack([xy, height(xy)])[order],
        rotation[order].astype(np.float32),
        np.ones((count, 3), np.float32),
        np.ones((count, 3), np.float32),
    )
    prototypes = [cover(name) for name in NAMES]
    return replace(city, scene=city.scene.with_instances("street_covers", prototypes, rows))
