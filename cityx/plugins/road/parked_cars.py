"""Parked cars: along kerbs and in rows on car parks."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city import City, Instances
from cityx.city.ground import SURFACES
from cityx.geometry.clearance import near_any
from cityx.geometry.identity import choose, hash_ids, uniform
from cityx.geometry.polylines import to_linestrings
from cityx.geometry.standing import earth_over, stand_on
from cityx.plugins.nature.street_rules import place_of
from cityx.plugins.road.bays import Bays, join_bays, lot_bays, with_bay_lines, yard_bays
from cityx.plugins.road.kerbs import join_places, places_along
from cityx.protocol import Port, Range, action

ACTION = "road/parked_cars-v1"
FloatArray = NDArray[np.float64]

BAY = 5.8  # metres of kerb per car
FROM_KERB = 1.0  # metres from the kerb to the middle of a car
JUNCTION_GAP = 6.0  # metres kept free behind the junction: 5 m by most traffic codes, and a bumper
CROSSING_GAP = 4.6  # metres more where a zebra crossing lies there, with 1 m free before it
LANE_LEFT = 2.4  # metres of carriageway that parked cars must leave to moving ones
VAN_LEFT = 3.7  # the same where vans park: a fire engine must pass (Manual for Streets, 6.7.2)
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
    lines = to_linestrings(network.lines)
    spots = shapely.points(xy)
    line, spot = shapely.STRtree(spots).query(
        lines, predicate="dwithin", distance=network.half_width + 0.6
    )
    other = line != edge[spot]
    marked = np.zeros(len(xy), bool)
    marked[spot[other]] = True
    return marked


def _in_bays(city: City, bays: Bays, occupancy: float) -> _Cars:
    """Cars in some of the bays, nose or tail to the end."""
    taken = uniform(city.seed, f"{ACTION}/taken", bays.id) < occupancy
    ids = bays.id[taken]
    backwards = uniform(city.seed, f"{ACTION}/back", ids) < 0.35
    yaw = bays.yaw[taken] + np.pi * backwards
    return _Cars(bays.xy[taken], ids, yaw, np.zeros(len(ids), bool))


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
    """Park cars along kerbs and on car parks, whose bays are marked.

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
    bays = join_bays([lot_bays(city), yard_bays(city)])
    if city.lod > 1 and "ground" in city.scene.meshes:
        city = with_bay_lines(city, bays)
    groups: list[Any] = [_along_kerbs(city, along), _in_bays(city, bays, lots)]
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
