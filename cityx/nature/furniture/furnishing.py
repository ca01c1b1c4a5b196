"""Street furniture: what the map shows, lamps along the kerbs and signals at the junctions."""

from __future__ import annotations

from dataclasses import fields, replace
from types import MappingProxyType
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.assets.furniture.street_furniture import VARIANTS, outside_pieces
from cityx.city import City, Failure, Instances
from cityx.city.ground import ROADWAY
from cityx.city.layout import ASKED_KINDS
from cityx.geometry.arrays import BoolArray, FloatArray
from cityx.geometry.clearance import near_any, nearest_free, push_off
from cityx.geometry.polylines import locate, to_linestrings
from cityx.geometry.ranges import numbered
from cityx.ground.pieces import (
    Pieces,
    heights,
    in_carriageways,
    join_pieces,
    may_stand,
    of_maps,
    pieces,
    room_along,
    walk_rims,
    with_pieces,
)
from cityx.ground.standing import WALKED, surfaces_at
from cityx.ground.street_rules import TIGHT, local_names
from cityx.ids import hash_ids, uniform
from cityx.nature.furniture.tagged_looks import with_tagged_looks
from cityx.places.profiles import keeps_left, profile_of
from cityx.protocol import Port, action
from cityx.road.markings.crossing_places import BEFORE, FLARE
from cityx.road.markings.marks import Street, street_of
from cityx.road.network.network import arm_bearings, arms_of
from cityx.road.network.sections import bands_of
from cityx.road.network.signal_places import signal_rows
from cityx.road.surface.kerbs import (
    edge_lengths,
    join_places,
    places_along,
    yaw_facing,
    yaw_of_compass,
)

ACTION = "nature/furniture-v1"

# Kinds of points that are things by themselves, and the prototype of each.
PIECES = {
    "bench": "bench", "waste_basket": "waste_basket", "bollard": "bollard",
    "bus_stop": "bus_stop", "fire_hydrant": "fire_hydrant", "post_box": "post_box",
    "telephone": "telephone", "bicycle_parking": "bicycle_parking", "fountain": "fountain",
    "advertising_column": "advertising_column", "power_pole": "power_pole", "statue": "statue",
    "vending_machine": "vending_machine", "recycling": "recycling", "flagpole": "flagpole",
    "quay_crane": "quay_crane", "container_stack": "container_stack",
    "traffic_cone": "traffic_cone", "work_barrier": "work_barrier",
    "power_tower": "pylon", "wind_turbine": "wind_turbine", "crane": "tower_crane",
    "scaffold": "scaffold", "helipad": "helipad", "wall_tower": "wall_tower",
    "tram_stop": "tram_stop",
    "street_lamp": "street_lamp_post", "stop": "sign_stop", "give_way": "sign_give_way",
    **{kind: kind for kind in ASKED_KINDS},
}  # fmt: skip
# Signs and signals are mapped on the carriageway; they go to the kerb of the side one drives on.
KERBSIDE = ("stop", "give_way", "bus_stop", "tram_stop", "speed_camera")
MAIN = ("motorway", "trunk", "primary", "secondary", "motorway_link", "trunk_link",
        "primary_link", "secondary_link")  # fmt: skip
NOT_FOR_CARS = ("footway", "path", "cycleway", "steps", "pedestrian", "corridor", "bridleway",
                "rail", "tram", "subway", "light_rail")  # fmt: skip
LIT = ("primary", "secondary", "tertiary", "residential", "unclassified", "living_street", "trunk")

LAMP_SPACING = 30.0  # metres between lamps of a street, the sides in turn
LAMP_SETBACK = 0.6  # metres from the kerb
WIDE_WALK, NARROW_SETBACK = 2.2, 0.3  # metres; on a narrower walk a lamp stands nearer to the kerb
POLE_SETBACK = 0.5  # metres, clear of mirrors of passing cars
FROM_HOUSES = 0.3  # metres from a house to what is put there by us
KERB_GAP = 0.35  # metres between a mapped thing and the kerb at least
# Half the size of large things, metres, by which they keep off carriageways.
DEPTH = {"recycling": 1.0, "telephone": 0.55, "bicycle_parking": 0.95, "fountain": 2.2,
         "advertising_column": 0.85, "statue": 0.9, "vending_machine": 0.6,
         "bus_stop": 0.85, "pylon": 2.7, "wind_turbine": 3.0, "tower_crane": 2.3, "scaffold": 1.4,
         "helipad": 7.5, "wall_tower": 2.4, "ferris_wheel": 9.0, "carousel": 5.2,
         "circus_tent": 17.0, "radio_mast": 3.0, "triumphal_arch": 7.6, "obelisk": 3.0,
         "war_memorial": 2.6, "market_cross": 3.4, "bandstand": 4.6, "gazebo": 2.4, "well": 1.2,
         "amphitheatre": 12.2, "marquee": 4.6, "food_truck": 2.0, "food_stall": 1.5,
         "excavator": 2.5, "billboard": 1.0, "kiosk": 1.5, "rock": 1.6, "jersey_barrier": 1.5,
         "parasol": 1.3, "climbing_frame": 1.1, "sandpit": 1.6, "swing": 1.8,
         "slide": 1.8, "stage": 4.6, "hot_air_balloon": 8.2, "helicopter": 6.6,
         "bouncy_castle": 3.1, "toll_booth": 4.1, "border_post": 3.0, "checkpoint": 3.2,
         "tractor": 2.0, "bulldozer": 2.9, "road_roller": 2.0, "relief_tent": 3.4,
         "lifeguard_tower": 3.4, "volleyball_net": 5.8, "christmas_tree": 2.3, "skip": 1.9,
         "satellite_dish": 1.7, "camera_crane": 5.6, "washing_line": 2.4, "kayak": 2.1}  # fmt: skip
# Metres of what is built as high as it is mapped.
FULL = {"street_lamp_mast": 8.2, "street_lamp_post": 4.5, "flagpole": 9.0, "power_pole": 9.0,
        "pylon": 30.0, "wind_turbine": 88.0, "tower_crane": 38.0, "wall_tower": 9.0}  # fmt: skip
FEW_LAMPS = 5.0  # per kilometre; a map with fewer has not mapped its lamps
MOST_PUSH = 3.0  # metres a mapped thing may be moved out of a carriageway
ROOF_LAYERS = frozenset({"roof_furniture"})
PAD = 8.5  # metres round a helipad on a roof in which nothing else stands
SIGNAL_REACH = 25.0  # metres from a mapped signal to the junction it belongs to
ONWARD = np.radians(40.0)  # a way that turns by more does not go straight on
AT_LINE, BEHIND = 0.7, 1.3  # metres from a crossing to a pole at its line, and to one behind it
MOST_AWAY = 4.5  # metres from where the map has a thing to the nearest place that is free
CROWDED = f"nothing within {MOST_AWAY:g} m of where the map has it is free; left out"
UNBUILT = "it is of a tunnel that is not built; left out"
ON_WAY = 0.1  # metres from a way to the things that are nodes of it
FRONT_REACH = 40.0  # metres within which a thing turns to a road
SHELTER_ROOM = 2.6  # metres of free sidewalk that a shelter needs
POLE = 0.2  # metres, half the foot of a lamp or a signal
WALL_GAP = 0.32  # metres from a wall to the middle of a pole that stands at it
WITHIN = 0.9  # metres behind a lamp of a street without walks of its own that are paved
WALK_REACH = 6.0  # metres of walk beside a pole that are looked at


class _Roads:
    """Carriageways as lines, with half widths and the class of lamp each gets.

    Those in tunnels count for what stands in tunnels, the others for all else.
    """

    def __init__(self, city: City, *, tunnels: bool = False) -> None:
        roads = city.layout.roads
        kind = roads["kind"].to_numpy().astype(str)
        wanted = roads["tunnel"].to_numpy(bool) == tunnels
        if city.network is not None and city.network.edge_count:
            edges = np.flatnonzero(wanted[city.network.edge_road])
            rows = city.network.edge_road[edges]
            self.lines = to_linestrings(city.network.lines)[edges]
            self.half = city.network.half_width[edges]
        else:
            cars = ~np.isin(kind, NOT_FOR_CARS)
            rows = np.flatnonzero(cars & wanted)
            self.lines = roads.geometry.to_numpy()[rows]
            self.half = np.fmax(np.nan_to_num(roads["width"].to_numpy()[rows] / 2, nan=2.5), 1.2)
        self.main = np.isin(kind[rows], MAIN)
        self.oneway = roads["oneway"].to_numpy()[rows]
        self.tree = shapely.STRtree(self.lines)

    def nearest(self, xy: FloatArray, reach: float) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return points that have a road within reach, and the nearest road of each."""
        if not len(self.lines) or not len(xy):
            return np.zeros(0, np.int64), np.zeros(0, np.int64)
        spots = shapely.points(xy)
        spot, line = self.tree.query_nearest(spots, max_distance=reach)
        first = np.unique(spot, return_index=True)[1]  # ties go to the first line
        return spot[first], line[first]

    def foot(self, xy: FloatArray, line: NDArray[np.int64]) -> tuple[FloatArray, FloatArray]:
        """Return the nearest point of each given line and the line's direction there."""
        shapes, spots = self.lines[line], shapely.points(xy)
        along = shapely.line_locate_point(shapes, spots)
        length = shapely.length(shapes)
        near = shapely.get_coordinates(shapely.line_interpolate_point(shapes, along))
        step = 0.5  # metres, over which the direction is taken
        back = shapely.line_interpolate_point(shapes, np.maximum(along - step, 0))
        ahead = shapely.line_interpolate_point(shapes, np.minimum(along + step, length))
        way = shapely.get_coordinates(ahead) - shapely.get_coordinates(back)
        size = np.hypot(*way.T)
        return near, way / np.where(size > 0, size, 1.0)[:, None]


def _mapped(city: City, roads: _Roads, drive: float, deep: NDArray[np.bool_]) -> Pieces:
    """Place the things of the points table, those in tunnels marked in `deep`.

    They are turned as mapped or towards the road.
    """
    table = city.layout.points
    usable = table["kind"].isin(list(_piece_names())).to_numpy()
    inside = _beside_roads(city, np.flatnonzero(usable & deep), _Roads(city, tunnels=True), drive)
    outside = _beside_roads(city, np.flatnonzero(usable & ~deep), roads, drive)
    found = join_pieces([outside, inside])
    order = np.argsort(np.r_[np.flatnonzero(usable & ~deep), np.flatnonzero(usable & deep)])
    return found.take(order)


def _piece_names() -> dict[str, str]:
    """Return the piece that stands for each kind of point."""
    return {**PIECES, **{name: name for name in outside_pieces()}}


def _beside_roads(city: City, rows: NDArray[np.int64], roads: _Roads, drive: float) -> Pieces:
    """Place some rows of the points table beside the nearest of some roads."""
    if not len(rows):
        return join_pieces([])
    table = city.layout.points
    pieces_of = _piece_names()
    kind = table["kind"].to_numpy().astype(str)[rows]
    ids = table["id"].to_numpy()[rows]
    xy = shapely.get_coordinates(table.geometry.to_numpy()[rows])
    direction = table["direction"].to_numpy()[rows]
    yaw = uniform(city.seed, f"{ACTION}/yaw", ids) * 2 * np.pi
    names = np.array([pieces_of[k] for k in kind], dtype=object)

    spot, line = roads.nearest(xy, FRONT_REACH)
    if len(spot):
        near, way = roads.foot(xy[spot], line)
        toward = near - xy[spot]
        gap = np.hypot(*toward.T)
        yaw[spot] = yaw_facing(toward)
        left = np.column_stack([-way[:, 1], way[:, 0]])
        on_road = gap < roads.half[line] + 0.3
        kerbside = np.isin(kind[spot], KERBSIDE) & on_road
        # The sign of a stop line faces the traffic that arrives at it; which way that is, the
        # map seldom says, so it is drawn from the nearer end of the road.
        end = shapely.line_locate_point(roads.lines[line], shapely.points(xy[spot]))
        onward = np.where(end > shapely.length(roads.lines[line]) / 2, 1.0, -1.0)
        onward = np.where(roads.oneway[line], 1.0, onward)
        sign = np.isin(kind[spot], ("stop", "give_way"))
        offset = (roads.half[line] + POLE_SETBACK + 0.45 * (kind[spot] == "bus_stop"))[:, None]
        beside = near - left * (drive * np.where(sign, onward, 1.0))[:, None] * offset
        xy[spot] = np.where(kerbside[:, None], beside, xy[spot])
        facing = np.where(sign[:, None], -way * onward[:, None], near - beside)
        yaw[spot] = np.where(kerbside, yaw_facing(facing), yaw[spot])
        lamp = kind[spot] == "street_lamp"
        names[spot[lamp & roads.main[line]]] = "street_lamp_mast"
    yaw = _along_power_lines(city, kind, xy, yaw)
    given = np.isfinite(direction) & ~np.isin(kind, KERBSIDE)
    yaw = np.where(given, yaw_of_compass(np.where(given, direction, 0.0)), yaw)
    bus = np.flatnonzero(names == "bus_stop")
    if len(bus):
        houses = city.layout.buildings.geometry.to_numpy()
        back = np.column_stack([-np.sin(yaw[bus]), np.cos(yaw[bus])])
        tight = near_any(xy[bus] + 1.0 * back, houses, SHELTER_ROOM)
        tight |= in_carriageways(city, xy[bus] + 0.6 * back, np.full(len(bus), DEPTH["bus_stop"]))
        names[bus[tight]] = "bus_pole"
        roomy = bus[~tight]
        xy[roomy] += 0.6 * back[~tight]  # the shelter's front stays clear of the kerb
    found = pieces(names, xy, ids, yaw)
    height = table["height"].to_numpy()[rows]
    size = np.isfinite(height) & np.isin(names, list(FULL))
    scale = np.array(
        [h / FULL[n] if s else 1.0 for h, n, s in zip(height, names, size, strict=True)]
    )
    return replace(found, scale=np.clip(scale, 0.5, 2.5))


def _along_power_lines(
    city: City, kind: NDArray[Any], xy: FloatArray, yaw: FloatArray
) -> FloatArray:
    """Turn pylons along the power lines that they carry."""
    lines = city.layout.lines
    wires = lines.geometry.to_numpy()[(lines["kind"] == "power_line").to_numpy()]
    rows = np.flatnonzero(kind == "power_tower")
    spot, line = shapely.STRtree(wires).query_nearest(shapely.points(xy[rows]), max_distance=2.0)
    first = np.unique(spot, return_index=True)[1]
    spot, line = rows[spot[first]], wires[line[first]]
    at = shapely.line_locate_point(line, shapely.points(xy[spot]))
    ends = [shapely.get_coordinates(shapely.line_interpolate_point(line, at + step))
            for step in (-1.0, 1.0)]  # fmt: skip
    turned = yaw.copy()
    turned[spot] = yaw_facing(ends[1] - ends[0])
    return turned


def _lamps(city: City, have: int) -> Pieces | None:
    """Lamps along the kerbs of lit streets, unless the map has its own."""
    network = city.network
    if network is None or not network.edge_count:
        return None
    table = city.layout.roads
    kind = table["kind"].to_numpy().astype(str)[network.edge_road]
    lit = np.isin(kind, LIT) & table["lit"].to_numpy()[network.edge_road]
    lit &= ~table["bridge"].to_numpy()[network.edge_road]
    lit &= table["layer"].to_numpy()[network.edge_road] == 0
    lit &= ~table["roundabout"].to_numpy(bool)[network.edge_road]
    kilometres = edge_lengths(network)[lit].sum() / 1000.0
    if have >= FEW_LAMPS * kilometres or not lit.any():
        return None
    groups = []
    for side, phase, column in ((1, 0.0, "sidewalk_left"), (-1, 0.5, "sidewalk_right")):
        walk = table[column].to_numpy()[network.edge_road]
        for chosen, beyond in (
            (walk >= WIDE_WALK, LAMP_SETBACK),
            ((walk > 0) & (walk < WIDE_WALK), NARROW_SETBACK),
            # Paving from the kerb to the houses is no walk of the street, and lit as one.
            (walk == 0, LAMP_SETBACK),
        ):
            groups.append(
                places_along(network, np.flatnonzero(lit & chosen), side, spacing=LAMP_SPACING,
                             beyond=beyond, margin=3.0, phase=phase)
            )  # fmt: skip
    places = join_places(*groups)
    left, right = (table[name].to_numpy()[network.edge_road][places.edge]
                   for name in ("sidewalk_left", "sidewalk_right"))  # fmt: skip
    walked = np.where(places.side > 0, left, right) > 0
    if city.ground is not None:
        walked |= city.ground.on(places.xy - WITHIN * places.toward_road, *WALKED)
    places = places.take(walked)
    main = np.isin(kind, MAIN)[places.edge]
    ids = hash_ids(0, f"{ACTION}/lamp", network.edge_id[places.edge],
                   2 * places.number + (places.side > 0))  # fmt: skip
    names = np.where(main, "street_lamp_mast", "street_lamp_post").astype(object)
    return pieces(names, places.xy, ids, yaw_facing(places.toward_road))


def lamp_places(city: City) -> FloatArray:
    """Return the (n, 2) places of mapped lamps and of those that `furniture` will add."""
    table = city.layout.points
    rows = np.flatnonzero(table["kind"].to_numpy().astype(str) == "street_lamp")
    mapped = shapely.get_coordinates(table.geometry.to_numpy()[rows])
    added = _lamps(city, len(rows))
    return mapped if added is None else np.concatenate([mapped, added.xy])


def _in_tunnels(city: City) -> NDArray[np.bool_]:
    """(p,) whether points of the layout lie on a way in a tunnel, and on none in the open."""
    roads, spots = city.layout.roads, city.layout.points.geometry.to_numpy()
    tunnel = roads["tunnel"].to_numpy(bool)
    hit, way = shapely.STRtree(roads.geometry.to_numpy()).query(
        spots, predicate="dwithin", distance=ON_WAY
    )
    inside = np.bincount(hit, tunnel[way], minlength=len(spots)) > 0
    return np.asarray(inside & (np.bincount(hit, ~tunnel[way], minlength=len(spots)) == 0))


def _below(
    city: City, groups: tuple[Pieces, ...], arms: NDArray[np.int64], inside: NDArray[np.bool_]
) -> tuple[NDArray[np.bool_], FloatArray]:
    """(n,) whether things are of tunnels, and heights of those, NaN where the tunnel is not built.

    Parameters
    ----------
    groups
        Mapped things and signals.
    arms
        Edge of the road network that each signal is of.
    inside
        (p,) points of the layout that are in tunnels.
    """
    mapped, signals = groups
    deep = np.isin(mapped.id, city.layout.points["id"].to_numpy()[inside])
    if city.network is not None and len(signals):
        road = city.network.edge_road[arms]
        deep = np.r_[deep, city.layout.roads["tunnel"].to_numpy(bool)[road]]
    z = np.full(len(mapped) + len(signals), np.nan)
    if city.heights is None or not deep.any():
        return deep, z
    tunnels = city.layout.roads["tunnel"].to_numpy(bool)[city.heights.road]
    floors = city.heights.take(np.flatnonzero(tunnels))
    z[deep] = floors.z_at(join_pieces(list(groups)).xy[deep])
    return deep, z


def _signals(city: City, drive: float) -> tuple[Pieces, NDArray[np.int64]]:
    """Signals at the kerb corner of every arm of a signalised junction, and at crossings.

    Returns
    -------
    signals, edge
        n of them, and (n,) the edge of the road network that each is of.
    """
    network = city.network
    table = city.layout.points
    rows, ruling = signal_rows(city.layout)
    if network is None or not network.edge_count or not len(rows):
        return join_pieces([]), np.zeros(0, np.int64)
    spots = table.geometry.to_numpy()[rows]
    joint = np.flatnonzero(network.node_degree >= 3)
    node_of = np.full(len(rows), -1)
    if len(joint):
        tree = shapely.STRtree(shapely.points(network.node_position[joint]))
        spot, node = tree.query_nearest(spots[ruling], max_distance=SIGNAL_REACH)
        node_of[np.flatnonzero(ruling)[spot]] = joint[node]
    signalled = np.zeros(len(network.node_position), bool)
    signalled[node_of[node_of >= 0]] = True
    roads = city.layout.roads
    oneway = roads["oneway"].to_numpy()[network.edge_road]
    main = np.isin(roads["kind"].to_numpy().astype(str)[network.edge_road], MAIN)
    lines = network.lines
    length = edge_lengths(network)
    street = street_of(city.layout, network, bands_of(city.layout, network),
                       profile_of(city.frame).painting)  # fmt: skip
    found: list[Pieces] = []
    arms: list[NDArray[np.int64]] = []
    for end in (0, 1):
        # Traffic arrives at the far end of an edge, and at its start unless it is one way.
        edge = np.flatnonzero(signalled[network.edge_nodes[:, end]] & ((end == 1) | ~oneway))
        long = length[edge] > network.trim[edge].sum(axis=1) + 4.0
        edge = edge[long | street.marked[edge, end]]
        found.append(_beside(lines, network, edge, *_poles(street, edge, end, AT_LINE),
                             1.0 if end == 1 else -1.0, drive, main,
                             f"{ACTION}/signal/{end}"))  # fmt: skip
        arms.append(edge)
        if _repeated(city, drive):
            far, onto = _beyond(street, edge, end, drive, f"{ACTION}/signal/far/{end}")
            found.append(far)
            arms.append(onto)
    lone = np.flatnonzero(node_of < 0)
    if len(lone):
        shapes = to_linestrings(lines)
        spot, edge = shapely.STRtree(shapes).query_nearest(spots[lone], max_distance=2.0)
        first = np.unique(spot, return_index=True)[1]
        spot, edge = spot[first], edge[first]
        along = shapely.line_locate_point(shapes[edge], spots[lone][spot])
        for way in (1.0, -1.0):
            ok = (way > 0) | ~oneway[edge]
            own = table["id"].to_numpy()[rows][lone[spot[ok]]]
            found.append(_beside(lines, network, edge[ok], along[ok] - 2.0 * way,
                                 np.zeros(int(ok.sum())), way, drive, main,
                                 f"{ACTION}/signal/mid{way:+.0f}", own))  # fmt: skip
            arms.append(edge[ok])
    return join_pieces(found), np.concatenate(arms)


def _poles(
    street: Street, edge: NDArray[np.int64], end: int, before: float
) -> tuple[FloatArray, FloatArray]:  # fmt: skip
    """Metres along edges to poles beside their crossings, and how far the kerb has curved away."""
    trim = street.network.trim[edge, end]
    beyond = np.where(street.marked[edge, end], street.halt[edge, end] - BEFORE + before, 0.6)
    inside = np.maximum(-beyond, 0.0) / np.maximum(trim - street.mouth[edge, end], 0.1)
    along = trim + beyond
    along = along if end == 0 else street.length[edge] - along
    return along, FLARE * np.minimum(inside, 1.5) ** 2


def _repeated(city: City, drive: float) -> bool:
    """Return whether signals stand behind junctions, too: where one drives left, and elsewhere."""
    return drive < 0 or profile_of(city.frame).streets.far_signals


def _beyond(
    street: Street, edge: NDArray[np.int64], end: int, drive: float, purpose: str
) -> tuple[Pieces, NDArray[np.int64]]:
    """Poles behind the junction, beside the arm in which traffic of each edge goes straight on.

    Returns
    -------
    poles, arm
        n of them, and (n,) the edge that each stands beside.
    """
    lines, network = street.lines, street.network
    node, arm, side = arms_of(lines, network.edge_nodes)
    bearing = arm_bearings(lines, arm, side)
    own = arm_bearings(lines, edge, np.full(len(edge), end))
    low = np.searchsorted(node, network.edge_nodes[edge, end])
    size = np.searchsorted(node, network.edge_nodes[edge, end], side="right") - low
    row = np.repeat(np.arange(len(edge)), size)
    other = low[row] + numbered(size)
    turn = np.abs(np.mod(bearing[other] - own[row], 2 * np.pi) - np.pi)
    order = np.lexsort((other, np.round(turn, 6), row))
    first = order[np.unique(row[order], return_index=True)[1]]
    first = first[turn[first] < ONWARD]
    row, other = row[first], other[first]
    found, arms = [], []
    for far in (0, 1):
        some = np.flatnonzero(side[other] == far)
        onto = arm[other[some]]
        arms.append(onto)
        # Whoever goes on leaves the junction along this arm.
        found.append(_beside(lines, network, onto, *_poles(street, onto, far, BEHIND),
                             1.0 if far == 0 else -1.0, drive,
                             np.zeros(network.edge_count, bool), f"{purpose}/{far}",
                             network.edge_id[edge[row[some]]]))  # fmt: skip
    return join_pieces(found), np.concatenate(arms).astype(np.int64)


def _beside(lines: Any, network: Any, edge: NDArray[np.int64], along: FloatArray,
            flare: FloatArray, way: float, drive: float, main: NDArray[np.bool_], purpose: str,
            ids: NDArray[np.uint64] | None = None) -> Pieces:  # fmt: skip
    """Poles on the side one drives on, facing traffic that moves along (`way` +1) or against."""
    position, ahead = locate(lines, edge, along)
    travel = ahead * way
    right = np.column_stack([travel[:, 1], -travel[:, 0]]) * drive
    xy = position + right * (network.half_width[edge] + flare + POLE_SETBACK)[:, None]
    # Arms reach over the lanes for traffic on the right; elsewhere the plain pole serves.
    wide = main[edge] & (network.half_width[edge] > 4.5) & (drive > 0)
    names = np.where(wide, "traffic_signal_mast", "traffic_signal").astype(object)
    key = network.edge_id[edge] if ids is None else ids
    return pieces(names, xy, hash_ids(0, purpose, key), yaw_facing(-travel))


def _cleared(city: City, roads: _Roads, given: Pieces, mapped: int) -> Pieces:
    """Move mapped things off carriageways; drop what still stands in one or in a house."""
    depth = np.array([DEPTH.get(str(name), 0.0) for name in given.name])
    xy, free = given.xy.copy(), np.ones(len(given), bool)
    for deep in np.unique(depth):
        of = depth == deep
        gap = roads.half + max(deep + 0.05, KERB_GAP)
        xy[of], free[of] = push_off(given.xy[of], roads.lines, gap, most=MOST_PUSH)
    shifted = np.hypot(*(xy - given.xy).T) > 1e-9
    own = np.arange(len(xy)) < mapped
    free &= own | ~shifted
    houses = city.layout.buildings.geometry.to_numpy()
    soft = np.isin(given.name, ("vending_machine", "post_box", "telephone"))
    free &= ~(near_any(xy, houses, 0.0) & ~soft)
    free &= ~(near_any(xy, houses, FROM_HOUSES) & ~own)
    return replace(given, xy=xy).take(free & _beside_junctions(city, xy))


def _beside_junctions(city: City, xy: FloatArray) -> BoolArray:
    """(n,) whether places of the site are neither in a junction nor on a roadway."""
    free = np.ones(len(xy), bool)
    network = city.network
    if network is not None and network.edge_count:
        radius = np.zeros(len(network.node_position))
        above = ~city.layout.roads["tunnel"].to_numpy(bool)[network.edge_road]
        ends, half = network.edge_nodes[above], network.half_width[above]
        np.maximum.at(radius, ends.ravel(), np.repeat(half, 2))
        joint = (network.node_degree >= 3) & (radius > 0)
        nodes = shapely.points(network.node_position[joint])
        free &= ~near_any(xy, nodes, radius[joint] + 0.3)
    if city.ground is not None:
        ground = city.ground
        free &= ~ground.on(xy, *ROADWAY)
    xmin, ymin, xmax, ymax = city.layout.extent
    free &= (xy[:, 0] >= xmin) & (xy[:, 0] <= xmax) & (xy[:, 1] >= ymin) & (xy[:, 1] <= ymax)
    return free


def _settled(city: City, roads: _Roads, lost: Pieces) -> tuple[Pieces, NDArray[np.uint64]]:
    """Put mapped things that do not stand where the map has them on the nearest free place.

    Returns
    -------
    settled, crowded
        Things with their new places, and the ids of those without any.
    """
    lost = replace(lost, name=np.where(lost.name == "bus_stop", "bus_pole", lost.name))
    depth = np.array([DEPTH.get(str(name), 0.0) for name in lost.name])
    houses = city.layout.buildings.geometry.to_numpy()

    def is_free(row: NDArray[np.int64], xy: FloatArray) -> BoolArray:
        free = ~near_any(xy, houses, FROM_HOUSES) & _beside_junctions(city, xy)
        for deep in np.unique(depth[row]):
            gap = roads.half + max(deep + 0.05, KERB_GAP)
            free &= (depth[row] != deep) | ~near_any(xy, roads.lines, gap)
        some = np.flatnonzero(free)
        free[some] = may_stand(city, replace(lost.take(row[some]), xy=xy[some]))
        return free

    xy, found = nearest_free(lost.xy, is_free, reach=MOST_AWAY)
    return replace(lost, xy=xy).take(found), lost.id[~found]


def _unserved(city: City, roads: _Roads, standing: Pieces, inside: NDArray[np.bool_]) -> Pieces:
    """Return a signal at each mapped one, but `inside` tunnels, that no junction's pole serves."""
    rows, _ = signal_rows(city.layout)
    table = city.layout.points.iloc[rows]
    poles = standing.xy[np.char.startswith(standing.name.astype(str), "traffic_signal")]
    xy = shapely.get_coordinates(table.geometry.to_numpy())
    alone = of_maps(table) & ~near_any(xy, shapely.points(poles), SIGNAL_REACH)
    alone &= ~inside[rows]
    xy, ids = xy[alone], table["id"].to_numpy()[alone]
    yaw = np.zeros(len(xy))
    spot, line = roads.nearest(xy, FRONT_REACH)
    if len(spot):
        near, way = roads.foot(xy[spot], line)
        yaw[spot] = yaw_facing(-way)
        drive = -1.0 if keeps_left(city.frame) else 1.0
        right = np.column_stack([way[:, 1], -way[:, 0]]) * drive
        beside = near + right * (roads.half[line] + POLE_SETBACK)[:, None]
        on_road = np.hypot(*(near - xy[spot]).T) < roads.half[line]
        xy[spot] = np.where(on_road[:, None], beside, xy[spot])
    return pieces("traffic_signal", xy, ids, yaw)


def _let_pass(city: City, roads: _Roads, ours: Pieces) -> Pieces:
    """Move poles that leave too little of a walk to its far side.

    Lamps that leave too little there as well are left out; signals stay.
    """
    if city.ground is None or not len(ours):
        return ours
    rows, line = roads.nearest(ours.xy, FRONT_REACH)
    walked = city.ground.on(ours.xy[rows], *WALKED)
    rows, line = rows[walked], line[walked]
    xy = ours.xy[rows]
    out = xy - roads.foot(xy, line)[0]
    out /= np.maximum(np.hypot(*out.T), 1e-6)[:, None]
    rims = walk_rims(city.ground)
    behind, before = (room_along(xy, way, rims, WALK_REACH) for way in (out, -out))
    tight = np.maximum(behind, before) < TIGHT + POLE
    roomy = behind + before >= TIGHT + POLE + WALL_GAP
    moved, keep = ours.xy.copy(), np.ones(len(ours), bool)
    back = tight & roomy
    moved[rows[back]] += (out * (behind - WALL_GAP)[:, None])[back]
    lamp = np.char.startswith(ours.name.astype(str), "street_lamp")
    keep[rows[tight & ~roomy]] = ~lamp[rows[tight & ~roomy]]
    return replace(ours, xy=moved).take(keep)


def _as_here(city: City, standing: Pieces) -> NDArray[Any]:
    """(n,) names of pieces as the region builds them, but for hydrants that are said to stand."""
    points = city.layout.points
    pillar = points["tags"].str.contains('"fire_hydrant:type": *"pillar"', regex=True)
    named = np.isin(standing.id, points["id"].to_numpy()[pillar.to_numpy().astype(bool)])
    return np.where(
        named, standing.name, local_names(standing.name, profile_of(city.frame).furniture)
    )


def _looks(city: City, names: NDArray[Any], ids: NDArray[np.uint64]) -> NDArray[Any]:
    """Return the names of things with one of its looks for each that has several."""
    draw = uniform(city.seed, f"{ACTION}/look", ids)
    found = names.copy()
    for name in sorted(set(names.tolist()) & set(VARIANTS)):
        own = np.flatnonzero(names == name)
        looks = np.array(VARIANTS[name], object)
        found[own] = looks[(draw[own] * len(looks)).astype(int)]
    return found


def _with_roof_pads(city: City) -> City:
    """Lay the helipads that are mapped on buildings on their roofs, clear of what stands there."""
    table = city.layout.points
    rows = np.flatnonzero((table["kind"] == "helipad").to_numpy())
    xy = shapely.get_coordinates(table.geometry.to_numpy()[rows])
    spot, height = surfaces_at(city.scene.meshes.get("buildings"), xy)
    top = np.full(len(rows), -np.inf)
    np.fmax.at(top, spot, height)
    found = np.isfinite(top)
    if not found.any():
        return city
    ids = table["id"].to_numpy()[rows][found]
    pads = pieces("helipad", xy[found], ids, np.zeros(len(ids)))
    layers = dict(city.scene.instances)
    for name in ROOF_LAYERS & layers.keys():
        own = layers[name]
        clear = ~near_any(own.position[:, :2], shapely.points(pads.xy), PAD)
        columns = {item.name: getattr(own, item.name)[clear] for item in fields(own)}
        layers[name] = Instances(**columns)
    scene = replace(city.scene, instances=MappingProxyType(layers))
    return with_pieces(replace(city, scene=scene), "roof_pads", pads, top[found])


@action(
    ACTION,
    limits=["Bridges and tunnels get no lamps of their own."],
    requires=("layout",),
    after=("road/ground-v1",),
    takes=(Port("layout", "scene_layout"),),
    gives=(Port("furniture", "point", role="street_furniture"),),
    labels=("street lamps", "benches", "traffic lights", "bus stops"),
)
def furniture(city: City, *, lamps: bool = True) -> City:
    """Place mapped street furniture, lamps along kerbs and signals at junctions.

    Parameters
    ----------
    city
        City with a layout; lamps and signals need the road network.
    lamps
        Whether lit streets get lamps when the map has next to none.
    """
    done = city.stages_done | {"nature"}
    if city.lod < 1:
        return replace(city, stages_done=done)
    city = _with_roof_pads(city)
    network = city.network
    left = keeps_left(city.frame) if network is None else bool(network.left_hand.any())
    drive = -1.0 if left else 1.0
    roads = _Roads(city)
    inside = _in_tunnels(city)
    mapped = _mapped(city, roads, drive, inside)
    posts = int((city.layout.points["kind"].to_numpy().astype(str) == "street_lamp").sum())
    signals, arms = _signals(city, drive)
    deep, z = _below(city, (mapped, signals), arms, inside)
    both, built = join_pieces([mapped, signals]), deep & np.isfinite(z)
    below, z = both.take(built), z[built]
    unbuilt = tuple(Failure(number, ACTION, UNBUILT) for number in both.id[deep & ~built].tolist())
    city = replace(city, failures=(*city.failures, *unbuilt))
    mapped, signals = mapped.take(~deep[: len(mapped)]), signals.take(~deep[len(mapped) :])
    added = _lamps(city, posts) if lamps else None
    ours = _let_pass(city, roads, join_pieces([signals] if added is None else [added, signals]))
    if not len(mapped) + len(ours) + len(below):
        return replace(city, stages_done=done)
    standing = _cleared(city, roads, join_pieces([mapped, ours]), len(mapped))
    # A shelter that the kerb leaves no room for is a pole.
    tight = (standing.name == "bus_stop") & ~may_stand(city, standing)
    standing = replace(standing, name=np.where(tight, "bus_pole", standing.name))
    standing = standing.take(may_stand(city, standing))
    if city.ground is not None:
        lost = mapped.take(np.isin(mapped.id, city.layout.points["id"][of_maps(city.layout.points)])
                           & ~np.isin(mapped.id, standing.id))  # fmt: skip
        lost = join_pieces([lost, _unserved(city, roads, join_pieces([standing, below]), inside)])
        settled, crowded = _settled(city, roads, lost)
        standing = join_pieces([standing, settled])
        named = tuple(Failure(number, ACTION, CROWDED) for number in crowded.tolist())
        city = replace(city, failures=(*city.failures, *named))
    feet = np.concatenate([heights(city, standing.xy), z])
    standing = join_pieces([standing, below])
    standing = replace(standing, name=_looks(city, _as_here(city, standing), standing.id))
    city = with_pieces(replace(city, stages_done=done), "street_furniture", standing, feet)
    return with_tagged_looks(city, "street_furniture")
