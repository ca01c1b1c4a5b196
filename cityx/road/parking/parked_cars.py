"""Parked cars: along kerbs and in rows on car parks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import Annotated, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.assets.vehicles.car_bodies import BODIES, TAXIS, shares_of
from cityx.city import City, Instances
from cityx.city.ground import SURFACES
from cityx.city.rows import join_rows, take_rows
from cityx.city.scene import Prototype
from cityx.city.section import KIND
from cityx.geometry.arrays import FloatArray
from cityx.geometry.clearance import near_any
from cityx.geometry.polylines import every, locate, to_linestrings, values_along
from cityx.geometry.scatter import near_pairs
from cityx.ground.standing import earth_over, stand_on
from cityx.ids import choose, hash_ids, uniform
from cityx.places.profile import Vehicles
from cityx.places.profiles import profile_of
from cityx.protocol import Port, Range, action
from cityx.road.network.sections import Bands, bands_of
from cityx.road.parking.bays import Bays, join_bays, lot_bays, with_bay_lines, yard_bays
from cityx.road.parking.kerb_bays import BAY, free_of, runs_of
from cityx.road.surface.kerbs import GROUNDED, yaw_facing

ACTION = "road/parked_cars-v1"
NEIGHBOURS = 6.5  # metres between the middles of cars that are seen beside one another
OTHERS = ("body 2", "body 3")  # drawn in turn where two of these are the same
FINE = 3  # level of detail from which makes and plates are parts of their own

SIDE_GAPS = (0.08, 0.25)  # metres from the kerb to the side of a car, the narrower the more
WHEELS = 2.1  # metres of the lane that wheels keep within
VAN_LEFT = 3.7  # metres that vans must leave to a fire engine (Manual for Streets, 6.7.2)
WIDE_VAN = 1.85  # metres; narrower ones stand where cars do
_PASSED = [KIND[name] for name in ("drive", "bus")]
UNLOADING = 12.0  # metres from shopfronts within which every fifth of the others is a van
VAN_SHARE = 0.2
AT_STOPS = 16.0  # metres from a tram stop within which people get in
AT_RAILS = 8.0  # metres from the middle of a track, at level crossings
VANS = 0.1  # of the parked, elsewhere
# Where streets have no lane for parking, small vans deliver at the left of one-way streets.
DELIVERED_IN = ("residential", "unclassified", "tertiary")
DELIVERY = 80.0  # metres of such a street per van
DELIVERED = 2.9  # metres of half a carriageway from which the others pass


@dataclass(frozen=True)
class _Cars:
    """Cars in the making, n of them.

    Attributes
    ----------
    xy
        (n, 2) float, places at the kerb, or the middles of bays.
    id
        (n,) uint64.
    yaw
        (n,) float, radians.
    tight
        (n,) bool, whether a van would stand in the way.
    inward
        (n, 2) float, unit vectors from the kerb to the road; 0 in bays.
    delivers
        (n,) bool, whether it is a small van.
    """

    xy: FloatArray
    id: NDArray[np.uint64]
    yaw: FloatArray
    tight: NDArray[np.bool_]
    inward: FloatArray
    delivers: NDArray[np.bool_]

    def take(self, rows: Any) -> _Cars:
        """Return some of them, by mask or by index."""
        return _Cars(*(getattr(self, column.name)[rows] for column in fields(self)))


def _along_kerbs(city: City, occupancy: float, *, deliveries: bool) -> _Cars | None:
    """Cars in lanes beside the kerb, facing the way their side drives."""
    network = city.network
    if network is None or not network.edge_count:
        return None
    roads = city.layout.roads
    flat = ~roads["bridge"].to_numpy() & ~roads["tunnel"].to_numpy()
    flat &= ~roads["passage"].to_numpy() & (roads["layer"].to_numpy() == 0)
    flat &= ~roads["roundabout"].to_numpy(bool)  # nobody parks in a ring
    open_ = flat[network.edge_road]
    bands = bands_of(city.layout, network)
    runs = runs_of(network, bands.take(open_[bands.edge]))
    run, number, along = runs.bays()
    edge, side = runs.edge[run], runs.side[run]
    ids = hash_ids(0, ACTION, network.edge_id[edge], 2 * number + (side > 0))
    taken = uniform(city.seed, f"{ACTION}/taken", ids) < occupancy
    left = np.bincount(bands.edge, bands.width * np.isin(bands.kind, _PASSED),
                       minlength=network.edge_count)  # fmt: skip
    found = _standing(city, edge[taken], along[taken], runs.kerb[run][taken], ids[taken])
    found = replace(found, tight=left[edge[taken]] < VAN_LEFT)
    if not deliveries or not occupancy:
        return found
    return _joined([found, _deliveries(city, bands, open_)])


def _joined(groups: Sequence[_Cars]) -> _Cars:
    """Put cars one after the other."""
    names = [column.name for column in fields(_Cars)]
    return _Cars(*(np.concatenate([getattr(group, name) for group in groups]) for name in names))


def _deliveries(city: City, bands: Bands, chosen: NDArray[np.bool_]) -> _Cars:
    """Small vans that stand at the left of one-way streets where the others have room to pass."""
    network = city.network
    assert network is not None
    table = city.layout.roads.iloc[network.edge_road]
    kept = np.isin(bands.kind, [KIND[name] for name in ("parking", "cycle", "shoulder")])
    wide = chosen & table["oneway"].to_numpy(bool) & (network.half_width >= DELIVERED)
    wide &= table["kind"].isin(DELIVERED_IN).to_numpy()
    wide[bands.edge[kept]] = False
    wide &= np.bincount(bands.edge, np.isin(bands.kind, _PASSED), network.edge_count) == 1
    low, high = free_of(network)
    edges = np.flatnonzero(wide & (high - low > BAY))
    row, along = every((high - low)[edges], BAY, BAY / 2)
    edge = edges[row]
    ids = hash_ids(0, f"{ACTION}/delivery", network.edge_id[edge], np.arange(len(row))
                   - np.searchsorted(row, row))  # fmt: skip
    stopped = uniform(city.seed, f"{ACTION}/delivers", ids) < BAY / DELIVERY
    edge, ids = edge[stopped], ids[stopped]
    kerb = np.where(network.left_hand[edge], 1.0, -1.0) * network.half_width[edge]
    found = _standing(city, edge, low[edge] + along[stopped], kerb, ids)
    return replace(found, delivers=np.ones(len(found.id), bool))


def _standing(
    city: City, edge: NDArray[np.int64], along: FloatArray, kerb: FloatArray,
    ids: NDArray[np.uint64],
) -> _Cars:  # fmt: skip
    """Set cars at kerbs, `kerb` metres left of the centrelines, out of the way of other streets."""
    network = city.network
    assert network is not None
    level = np.abs(values_along(network.lines, network.lift, edge, along)) < GROUNDED
    edge, along, kerb, ids = edge[level], along[level], kerb[level], ids[level]
    side = np.sign(kerb)
    position, onward = locate(network.lines, edge, along)
    left = np.column_stack([-onward[:, 1], onward[:, 0]])
    inward = -left * side[:, None]
    xy = position + left * kerb[:, None]
    oneway = city.layout.roads["oneway"].to_numpy(bool)[network.edge_road]
    # Where one drives on the right, cars on the right side face ahead; one-way streets throughout.
    outer = side * np.where(network.left_hand[edge], -1.0, 1.0) < 0
    way = onward * np.where(oneway[edge] | outer, 1.0, -1.0)[:, None]
    tilt = np.radians(2.0) * (uniform(city.seed, f"{ACTION}/tilt", ids) - 0.5)
    no = np.zeros(len(ids), bool)
    found = _Cars(xy, ids, yaw_facing(way) + tilt, no, inward, no)
    return found.take(~_near_junctions(city, xy + inward, edge))


def _near_junctions(city: City, xy: FloatArray, edge: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Mark cars that stand in the way of another street, where the trims are too short for it."""
    network = city.network
    assert network is not None
    lines = to_linestrings(network.lines)
    spots = shapely.points(xy)
    line, spot = shapely.STRtree(spots).query(
        lines, predicate="dwithin", distance=network.half_width + 0.6
    )
    # A street that goes on behind a mere joint is no other.
    shared = network.edge_nodes[line][:, :, None] == network.edge_nodes[edge[spot]][:, None, :]
    joint = shared & (network.node_degree[network.edge_nodes[line]] == 2)[:, :, None]
    other = (line != edge[spot]) & ~joint.any(axis=(1, 2))
    marked = np.zeros(len(xy), bool)
    marked[spot[other]] = True
    return marked


def _in_bays(city: City, bays: Bays, occupancy: float) -> _Cars:
    """Cars in some of the bays, nose or tail to the end."""
    taken = uniform(city.seed, f"{ACTION}/taken", bays.id) < occupancy
    ids = bays.id[taken]
    backwards = uniform(city.seed, f"{ACTION}/back", ids) < 0.35
    yaw = bays.yaw[taken] + np.pi * backwards
    no = np.zeros(len(ids), bool)
    return _Cars(bays.xy[taken], ids, yaw, no, np.zeros((len(ids), 2)), no)


def _bodies(city: City, cars: _Cars, vehicles: Vehicles) -> NDArray[np.str_]:
    """(n,) body of each car; before shops there are more vans, in tight streets none.

    Taxis wait at ranks, not at kerbs.
    """

    def drawn(kind: str, purpose: str) -> NDArray[np.str_]:
        names, shares = zip(*(each for each in shares_of(kind, vehicles) if each[0] not in TAXIS),
                            strict=True)  # fmt: skip
        picked = choose(city.seed, f"{ACTION}/{purpose}", cars.id, shares)
        return np.array(names)[picked]

    body, van = _varied(cars, [drawn("car", p) for p in ("body", *OTHERS)]), drawn("van", "van")
    wide = np.array([BODIES[name].width > WIDE_VAN for name in van.tolist()], bool)
    fits = ~(cars.tight & wide)
    loads = uniform(city.seed, f"{ACTION}/vans", cars.id) < VANS
    shops = city.scene.instances.get("shopfronts")
    if shops is not None and shops.count:
        near = near_any(cars.xy, shapely.points(shops.position[:, :2]), UNLOADING)
        loads |= near & (uniform(city.seed, f"{ACTION}/unloading", cars.id) < VAN_SHARE)
    body = np.where(loads & fits, van, body)
    small = min(vehicles.vans, key=lambda name: BODIES[name].width)
    return np.where(cars.delivers, small, body)


def _varied(cars: _Cars, drawn: Sequence[NDArray[np.str_]]) -> NDArray[np.str_]:
    """(n,) the first body drawn for each car, or the next where one beside it has the same.

    Of two neighbours that of the lower number keeps its own.
    """
    found = drawn[0].copy()
    if not len(found):
        return found
    pairs = near_pairs(cars.xy, NEIGHBOURS)
    low, high = np.where((cars.id[pairs[:, :1]] < cars.id[pairs[:, 1:]]), pairs, pairs[:, ::-1]).T
    for other in drawn[1:]:
        same = np.zeros(len(found), bool)
        same[high[found[low] == found[high]]] = True
        found = np.where(same, other, found)
    return found


def _placed(city: City, cars: _Cars, body: NDArray[np.str_]) -> FloatArray:
    """(n, 2) middles of cars: their sides some way from the kerb, and never in the middle of bays.

    The wheels beside the road stay in the lane, but for the widest vans.
    """
    size = np.array([(BODIES[name].width, BODIES[name].length) for name in body.tolist()])
    size = size.reshape(-1, 2)
    gap = np.clip(0.4 * (WHEELS - size[:, 0]), *SIDE_GAPS)
    gap += 0.08 * (uniform(city.seed, f"{ACTION}/inward", cars.id) - 0.5)
    slack = (BAY - 0.4 - size[:, 1]).clip(0.0, 1.0)
    slack *= uniform(city.seed, f"{ACTION}/slack", cars.id) - 0.5
    onward = np.column_stack([-cars.inward[:, 1], cars.inward[:, 0]])
    inner = size[:, 0] / 2 + gap
    return np.asarray(cars.xy + cars.inward * inner[:, None] + onward * slack[:, None])


def _apart(xy: FloatArray, yaw: FloatArray, body: NDArray[np.str_]) -> NDArray[np.int64]:
    """Return the rows of cars that stand in no other; of two that would, the first stays."""
    size = np.array([(BODIES[name].width, BODIES[name].length) for name in body.tolist()])
    size = size.reshape(-1, 2) / 2
    corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])[None] * size[:, None]
    c, s = np.cos(yaw)[:, None], np.sin(yaw)[:, None]
    x, y = corners[..., 0], corners[..., 1]
    plans = shapely.polygons(np.stack([c * x - s * y, s * x + c * y], axis=2) + xy[:, None])
    one, other = shapely.STRtree(plans).query(plans, predicate="intersects")
    gone = np.zeros(len(xy), bool)
    for first, second in sorted(zip(one[one < other], other[one < other], strict=True)):
        gone[second] |= not gone[first]
    return np.flatnonzero(~gone)


def _painted(city: City, cars: _Cars, body: NDArray[np.str_]) -> NDArray[np.float32]:
    """(n, 3) linear colours of paint, as owners of each body choose it."""
    from cityx.assets.vehicles.movers import paints_of

    found = np.zeros((len(cars.id), 3), np.float32)
    for name in np.unique(body).tolist():
        rows = np.flatnonzero(body == name)
        colors, shares = paints_of(f"car_{name}")
        found[rows] = colors[choose(city.seed, f"{ACTION}/paint", cars.id[rows], shares)]
    return found


def _prototypes(
    city: City, body: NDArray[np.str_], plates: str
) -> tuple[list[Prototype], NDArray[np.int32]]:
    """Return the bodies that stand here, and the (n,) one of each car."""
    from cityx.assets.vehicles.vehicles import car

    kinds, index = np.unique(body, return_inverse=True)
    made = [car(name, detail=city.lod, country=plates, number=None) for name in kinds.tolist()]
    return made, index.astype(np.int32)


def _fixed(
    city: City, rows: Instances, body: NDArray[np.str_], plates: str
) -> tuple[list[Prototype], Instances]:
    """Return the faces and plates of the cars of rows, which own them."""
    from cityx.assets.vehicles.car_parts import REGISTRATIONS, car_parts, fixed_to

    plate = choose(city.seed, f"{ACTION}/registration", rows.object_id, [1.0] * REGISTRATIONS)
    made: dict[str, Prototype] = {}
    tables = []
    for name, number in sorted(set(zip(body.tolist(), plate.tolist(), strict=True))):
        own = take_rows(rows, np.flatnonzero((body == name) & (plate == number)))
        for place_of_part, part in enumerate(car_parts(name, plates, number)):
            made.setdefault(part.prototype.name, part.prototype)
            position, rotation = fixed_to(part, own.position, own.rotation)
            tables.append(
                Instances(
                    np.full(own.count, list(made).index(part.prototype.name), np.int32),
                    hash_ids(0, f"{ACTION}/part", own.object_id, place_of_part),
                    own.object_id,
                    position,
                    rotation.astype(np.float32),
                    own.scale,
                    np.ones_like(own.tint),
                )
            )
    found = join_rows(tables)
    return list(made.values()), take_rows(found, np.argsort(found.object_id, kind="stable"))


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
    occupancy: Annotated[float | None, Range(0.0, 1.0)] = None,
    lots: Annotated[float, Range(0.0, 1.0)] = 0.7,
) -> City:
    """Park cars along kerbs and on car parks, whose bays are marked.

    Parameters
    ----------
    city
        City with a layout; cars along kerbs need the road network.
    occupancy
        Share of the bays along kerbs that are taken; None for what is usual at the place.
    lots
        Share of the bays of car parks that are taken.
    """
    done = city.stages_done | {"road"}
    if city.lod < 1:
        return replace(city, stages_done=done)
    profile = profile_of(city.frame)
    streets, vehicles = profile.streets, profile.vehicles
    along = streets.kerb_occupancy if occupancy is None else occupancy
    bays = join_bays([lot_bays(city), yard_bays(city)])
    if city.lod > 1 and "ground" in city.scene.meshes:
        city = with_bay_lines(city, bays)
    groups = [_along_kerbs(city, along, deliveries=streets.deliveries), _in_bays(city, bays, lots)]
    each = [group for group in groups if group is not None and len(group.id)]
    if not each:
        return replace(city, stages_done=done)
    cars = _joined(each)
    cars = cars.take(np.argsort(cars.id, kind="stable"))
    body = _bodies(city, cars, vehicles)
    xy = _placed(city, cars, body)
    keep = _open(city, xy)
    cars, body, xy = cars.take(keep), body[keep], xy[keep]
    alone = _apart(xy, cars.yaw, body)
    cars, body, xy = cars.take(alone), body[alone], xy[alone]
    made, index = _prototypes(city, body, vehicles.plates)
    position, rotation = _on_terrain(city, xy, cars.yaw)
    rows = Instances(
        index,
        cars.id,
        np.zeros(len(cars.id), np.uint64),
        position,
        rotation.astype(np.float32),
        np.ones((len(cars.id), 3), np.float32),
        _painted(city, cars, body),
    )
    scene = city.scene.with_instances("vehicles", made, rows)
    if city.lod >= FINE:
        scene = scene.with_instances("vehicle_parts", *_fixed(city, rows, body, vehicles.plates))
    return replace(city, scene=scene, stages_done=done)


def _open(city: City, xy: FloatArray) -> NDArray[np.bool_]:
    """(n,) whether places lie on the site, off houses, rails, tram stops, banks and openings."""
    xmin, ymin, xmax, ymax = city.layout.extent
    keep = (xy[:, 0] >= xmin) & (xy[:, 0] <= xmax) & (xy[:, 1] >= ymin) & (xy[:, 1] <= ymax)
    keep &= ~near_any(xy, city.layout.buildings.geometry.to_numpy(), 1.0)
    points = city.layout.points
    stops = points.geometry.to_numpy()[(points["kind"] == "tram_stop").to_numpy()]
    keep &= ~near_any(xy, stops, AT_STOPS)
    roads = city.layout.roads
    level = ~(roads["bridge"] | roads["tunnel"]).to_numpy(bool) & (roads["layer"] == 0).to_numpy()
    rails = roads.geometry.to_numpy()[level & (roads["kind"] == "rail").to_numpy()]
    keep &= ~near_any(xy, rails, AT_RAILS)
    keep &= np.isnan(earth_over(city.scene.meshes.get("structures"), xy))
    if city.ground is not None:  # it opens for ramps and cuttings
        keep &= ~city.ground.on(xy, "void")
    return np.asarray(keep)


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
