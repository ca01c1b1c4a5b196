"""Parked cars: along kerbs and in rows on car parks."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city import City, Instances
from cityx.city.ground import LABEL, SURFACES
from cityx.geometry.clearance import near_any
from cityx.geometry.identity import choose, hash_ids, uniform
from cityx.geometry.polylines import to_linestrings
from cityx.geometry.standing import earth_over, stand_on
from cityx.plugins.nature.street_rules import place_of
from cityx.plugins.road.kerbs import edge_lines, join_places, places_along
from cityx.plugins.road.yards import BAY as YARD_BAY
from cityx.plugins.road.yards import yard_patches
from cityx.protocol import Port, Range, action

ACTION = "road/parked_cars-v1"
FloatArray = NDArray[np.float64]

BAY = 5.8  # metres of kerb per car
FROM_KERB = 1.0  # metres from the kerb to the middle of a car
JUNCTION_GAP = 6.0  # metres kept free behind the junction: 5 m by most traffic codes, and a bumper
CROSSING_GAP = 4.6  # metres more where a zebra crossing lies there, with 1 m free before it
LANE_LEFT = 2.4  # metres of carriageway that parked cars must leave to moving ones
VAN_LEFT = 3.7  # the same where vans park: a fire engine must pass (Manual for Streets, 6.7.2)
STALL_WIDTH, STALL_LENGTH, AISLE = 2.5, 5.0, 6.0  # metres, of a car park
CAR_RADIUS = 2.7  # metres, half the diagonal of a car
SMALLEST_LOT = 60.0  # square metres
MOST_STALLS = 4_000  # per car park; beyond, a mapping error rather than a car park
JAPANESE = 0.3  # of the bays along kerbs are taken where nobody may keep a car in the street
UNLOADING = 12.0  # metres from shopfronts within which every fifth of the others is a van
VAN_SHARE = 0.2


@dataclass(frozen=True)
class _Cars:
    xy: FloatArray
    id: NDArray[np.uint64]
    yaw: FloatArray
    tight: NDArray[np.bool_]  # whether a van would stand in the way


def _along_kerbs(city: City, occupancy: float) -> _Cars | None:
    """Cars in bays beside the kerb, facing the way their side drives."""
    network = city.network
    if network is None or not network.edge_count:
        return None
    roads = city.layout.roads
    row = network.edge_road
    flat = ~roads["bridge"].to_numpy() & ~roads["tunnel"].to_numpy()
    flat &= ~roads["passage"].to_numpy() & (roads["layer"].to_numpy() == 0)
    flat &= ~roads["roundabout"].to_numpy(bool)  # nobody parks in a ring
    oneway = roads["oneway"].to_numpy()[row]
    both = (roads["parking_left"].to_numpy() & roads["parking_right"].to_numpy())[row]
    # The narrowed carriageway must still let a car pass between the parked ones.
    left_over = 2 * network.half_width - (2 + both * 2.0)
    crossing = network.crossing.any(axis=1)
    groups = []
    for side, column in ((1, "parking_left"), (-1, "parking_right")):
        parking = roads[column].to_numpy()[row] & flat[row] & (left_over >= LANE_LEFT)
        for zebra in (False, True):
            edges = np.flatnonzero(parking & (crossing == zebra))
            groups.append(
                places_along(network, edges, side, spacing=BAY, beyond=-FROM_KERB,
                             margin=JUNCTION_GAP + CROSSING_GAP * zebra)
            )  # fmt: skip
    places = join_places(*groups)
    ids = hash_ids(0, ACTION, network.edge_id[places.edge], 2 * places.number + (places.side > 0))
    taken = uniform(city.seed, f"{ACTION}/taken", ids) < occupancy
    taken &= ~_near_junctions(city, places.xy, places.edge)
    places, ids = places.take(taken), ids[taken]
    # Where one drives on the right, cars on the right side face ahead; one-way streets throughout.
    outer = places.side * np.where(network.left_hand[places.edge], -1.0, 1.0) < 0
    ahead = np.where(oneway[places.edge] | outer, 1.0, -1.0)
    way = places.ahead * ahead[:, None]
    slack = uniform(city.seed, f"{ACTION}/slack", ids) - 0.5
    inward = uniform(city.seed, f"{ACTION}/inward", ids) - 0.5
    xy = places.xy + places.ahead * (0.5 * slack)[:, None]
    xy += places.toward_road * (0.16 * inward)[:, None]
    tilt = np.radians(2.4) * (uniform(city.seed, f"{ACTION}/tilt", ids) - 0.5)
    tight = left_over[places.edge] < VAN_LEFT
    return _Cars(xy, ids, np.arctan2(way[:, 0], -way[:, 1]) + tilt, tight)


def _near_junctions(city: City, xy: FloatArray, edge: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Mark cars that stand in the way of another street, where the trims are too short for it."""
    network = city.network
    assert network is not None
    lines = to_linestrings(edge_lines(network))
    spots = shapely.points(xy)
    line, spot = shapely.STRtree(spots).query(
        lines, predicate="dwithin", distance=network.half_width + 0.6
    )
    other = line != edge[spot]
    marked = np.zeros(len(xy), bool)
    marked[spot[other]] = True
    return marked


def _on_lots(city: City, occupancy: float) -> _Cars | None:
    """Cars in double rows of bays along the long side of every car park."""
    areas = city.layout.areas
    rows = np.flatnonzero(areas["kind"].to_numpy().astype(str) == "parking")
    shapes = areas.geometry.to_numpy()[rows]
    big = shapely.area(shapes) > SMALLEST_LOT
    rows, shapes = rows[big], shapes[big]
    if not len(rows):
        return None
    found: list[tuple[FloatArray, NDArray[np.uint64], FloatArray]] = []
    frames = shapely.oriented_envelope(shapes)
    for row, frame in zip(rows, frames, strict=True):
        corner = shapely.get_coordinates(frame)
        if len(corner) < 4:
            continue
        a, b = corner[1] - corner[0], corner[2] - corner[1]
        if np.hypot(*a) < np.hypot(*b):
            a, b, origin = b, -a, corner[1]
        else:
            origin = corner[0]
        length, depth = float(np.hypot(*a)), float(np.hypot(*b))
        u, v = a / max(length, 1e-6), b / max(depth, 1e-6)
        across, facing = _stall_rows(depth)
        along = np.arange(0.5 * STALL_WIDTH + 0.5, length - 0.5 * STALL_WIDTH, STALL_WIDTH)
        if not len(along) or not len(across) or len(along) * len(across) > MOST_STALLS:
            continue
        s, t = np.meshgrid(along, across, indexing="ij")
        xy = origin + s.reshape(-1, 1) * u + t.reshape(-1, 1) * v
        key = np.full(len(xy), areas["id"].to_numpy()[row])
        way = np.tile(facing, len(along))[:, None] * v
        ids = hash_ids(0, f"{ACTION}/lot", key, np.arange(len(xy)))
        found.append((xy, ids, np.arctan2(way[:, 0], -way[:, 1])))
    if not found:
        return None
    xy = np.concatenate([f[0] for f in found])
    ids = np.concatenate([f[1] for f in found])
    yaw = np.concatenate([f[2] for f in found])
    keep = uniform(city.seed, f"{ACTION}/taken", ids) < occupancy
    xy, ids, yaw = xy[keep], ids[keep], yaw[keep]
    inside = np.zeros(len(xy), bool)
    ahead = 0.5 * STALL_LENGTH * np.column_stack([np.sin(yaw), -np.cos(yaw)])
    whole = [shapely.STRtree(shapely.points(xy + s * ahead)) for s in (-0.95, 0.95)]
    ends = []
    for tree in whole:
        hit = np.zeros(len(xy), bool)
        hit[tree.query(shapes, predicate="contains")[1]] = True
        ends.append(hit)
    inside = ends[0] & ends[1]
    inside &= ~near_any(xy, city.layout.buildings.geometry.to_numpy(), CAR_RADIUS)
    roads = city.layout.roads
    open_ = ~roads["tunnel"].to_numpy() & ~roads["bridge"].to_numpy()
    half = np.nan_to_num(roads["width"].to_numpy()[open_] / 2, nan=1.5)
    inside &= ~near_any(xy, roads.geometry.to_numpy()[open_], np.fmin(half, 3.0) + 1.3)
    backwards = uniform(city.seed, f"{ACTION}/back", ids) < 0.2
    yaw = yaw + np.pi * backwards
    return _Cars(xy[inside], ids[inside], yaw[inside], np.zeros(int(inside.sum()), bool))


def _on_yards(city: City, occupancy: float) -> _Cars | None:
    """Cars in the bays of yards, nose or tail to the wall."""
    network, ground = city.network, city.ground
    if network is None or ground is None:
        return None
    patches = yard_patches(city.layout, network)
    patches = patches.take(patches.label == LABEL["parking"])
    count = np.rint(patches.size[:, 0] / YARD_BAY).astype(np.int64)
    row = np.repeat(np.arange(len(count)), count)
    number = np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count)
    shift = (number - (count[row] - 1) / 2) * YARD_BAY
    xy = patches.middle[row] + patches.along[row] * shift[:, None]
    ids = hash_ids(0, f"{ACTION}/yard", patches.id[row], number)
    back = uniform(city.seed, f"{ACTION}/back", ids) < 0.5
    along = patches.along[row]
    yaw = np.arctan2(along[:, 1], along[:, 0]) + np.pi * back
    keep = uniform(city.seed, f"{ACTION}/taken", ids) < occupancy
    keep[keep] &= ground.on(xy[keep], "parking")
    return _Cars(xy[keep], ids[keep], yaw[keep], np.zeros(int(keep.sum()), bool))


def _bodies(
    city: City, xy: FloatArray, ids: NDArray[np.uint64], tight: NDArray[np.bool_]
) -> NDArray[np.int64]:
    """(n,) body of each car; before shops there are more vans, in tight streets none."""
    from cityx.assets import vehicles

    van = list(vehicles.BODIES).index("van")
    shares = np.array(vehicles.BODY_SHARES, float)
    body = choose(city.seed, f"{ACTION}/body", ids, shares)
    shares[van] = 0.0
    body = np.where(tight, choose(city.seed, f"{ACTION}/body", ids, shares), body)
    shops = city.scene.instances.get("shopfronts")
    if shops is None or not shops.count:
        return body
    fronts = shapely.points(shops.position[:, :2])
    unloading = ~tight & near_any(xy, fronts, UNLOADING)
    unloading &= uniform(city.seed, f"{ACTION}/unloading", ids) < VAN_SHARE
    return np.where(unloading, van, body)


def _apart(xy: FloatArray, yaw: FloatArray, body: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the rows of cars that stand in no other; of two that would, the first stays."""
    from cityx.assets import vehicles

    size = np.array([(b.width, b.length) for b in vehicles.BODIES.values()])[body] / 2
    corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])[None] * size[:, None]
    c, s = np.cos(yaw)[:, None], np.sin(yaw)[:, None]
    x, y = corners[..., 0], corners[..., 1]
    plans = shapely.polygons(np.stack([c * x - s * y, s * x + c * y], axis=2) + xy[:, None])
    one, other = shapely.STRtree(plans).query(plans, predicate="intersects")
    gone = np.zeros(len(xy), bool)
    for first, second in sorted(zip(one[one < other], other[one < other], strict=True)):
        gone[second] |= not gone[first]
    return np.flatnonzero(~gone)


def _stall_rows(depth: float) -> tuple[FloatArray, FloatArray]:
    """Middles of the rows of bays across a car park, and which way their cars face."""
    if depth < STALL_LENGTH:
        return np.zeros(0), np.zeros(0)
    if depth < STALL_LENGTH + AISLE:
        return np.array([depth / 2]), np.array([1.0])
    module = 2 * STALL_LENGTH + AISLE
    middles, facing = [], []
    start = 0.0
    while start + STALL_LENGTH <= depth:
        middles.append(start + STALL_LENGTH / 2)
        facing.append(-1.0)
        if start + module <= depth:
            middles.append(start + module - STALL_LENGTH / 2)
            facing.append(1.0)
        start += module
    return np.array(middles), np.array(facing)


@action(
    ACTION,
    limits=["Bays are parallel to the kerb; angled parking is drawn parallel too."],
    requires=("layout",),
    after=("road/ground-v1", "building/facade-v1"),
    takes=(
        Port("layout", "scene_layout"),
        Port("network", "line", role="road_network", optional=True),
    ),
    gives=(Port("cars", "point", role="vehicle"),),
    labels=("cars", "vehicles", "parking"),
)
def parked_cars(
    city: City,
    *,
    occupancy: Annotated[float, Range(0.0, 1.0)] = 0.7,
    lots: Annotated[float, Range(0.0, 1.0)] = 0.5,
) -> City:
    """Park cars along kerbs and on car parks.

    Parameters
    ----------
    city
        City with a layout; cars along kerbs need the road network.
    occupancy
        Share of the bays along kerbs that are taken.
    lots
        Share of the bays of car parks that are taken.
    """
    from cityx.assets import vehicles

    done = city.stages_done | {"road"}
    if city.lod < 1:
        return replace(city, stages_done=done)
    along = occupancy * (JAPANESE if place_of(city) == "japan" else 1.0)
    groups: list[Any] = [_along_kerbs(city, along), _on_lots(city, lots), _on_yards(city, lots)]
    groups = [group for group in groups if group is not None and len(group.id)]
    if not groups:
        return replace(city, stages_done=done)
    xy = np.concatenate([g.xy for g in groups])
    ids = np.concatenate([g.id for g in groups])
    yaw = np.concatenate([g.yaw for g in groups])
    tight = np.concatenate([g.tight for g in groups])
    xmin, ymin, xmax, ymax = city.layout.extent
    keep = (xy[:, 0] >= xmin) & (xy[:, 0] <= xmax) & (xy[:, 1] >= ymin) & (xy[:, 1] <= ymax)
    keep &= ~near_any(xy, city.layout.buildings.geometry.to_numpy(), 1.0)
    keep &= np.isnan(earth_over(city.scene.meshes.get("structures"), xy))
    if city.ground is not None:  # it opens for ramps and cuttings
        keep &= ~city.ground.on(xy, "void")
    order = np.flatnonzero(keep)[np.argsort(ids[keep], kind="stable")]
    xy, ids, yaw = xy[order], ids[order], yaw[order]
    body = _bodies(city, xy, ids, tight[order])
    alone = _apart(xy, yaw, body)
    xy, ids, yaw, body = xy[alone], ids[alone], yaw[alone], body[alone]
    paint = choose(city.seed, f"{ACTION}/paint", ids, vehicles.PAINT_SHARES)
    position, rotation = _on_terrain(city, xy, yaw)
    rows = Instances(
        body.astype(np.int32),
        ids,
        np.zeros(len(ids), np.uint64),
        position,
        rotation.astype(np.float32),
        np.ones((len(ids), 3), np.float32),
        vehicles.PAINTS[paint].astype(np.float32),
    )
    prototypes = [vehicles.car(name, detail=city.lod) for name in vehicles.BODIES]
    return replace(
        city, scene=city.scene.with_instances("vehicles", prototypes, rows), stages_done=done
    )


def _on_terrain(city: City, xy: FloatArray, yaw: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Set cars on the slope: position, and Euler angles that follow the ground under the wheels.

    The ground's faces are what counts where they are: beside walls they leave the terrain.
    """
    ahead = np.column_stack([np.sin(yaw), -np.cos(yaw)])
    right = np.column_stack([ahead[:, 1], -ahead[:, 0]])
    ground = city.scene.meshes.get("ground")
    offset = np.array([surface.offset for surface in SURFACES])

    def height(places: FloatArray) -> FloatArray:
        under = stand_on(ground, places)
        level = under.z - offset[under.label]  # kerbs under a wheel do not tilt a car
        return np.where(np.isnan(level), city.terrain.height_at(places), level)

    front, back = height(xy + 1.3 * ahead), height(xy - 1.3 * ahead)
    starboard, port = height(xy + 0.75 * right), height(xy - 0.75 * right)
    z = (front + back) / 2
    # The nose is -y: turning about x by a positive angle lowers it.
    pitch = -np.arctan2(front - back, 2.6)
    # Facing -y, the right side is -x: a positive turn about y raises it.
    roll = np.arctan2(starboard - port, 1.5)
    return np.column_stack([xy, z]), np.column_stack([pitch, roll, yaw])
