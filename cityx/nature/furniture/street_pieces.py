"""Furniture by rule on walks, before facades, on plazas and in yards, clear of who walks there."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.assets.furniture.wall_pieces import HALVES
from cityx.building.shops.shop_names import shop_names
from cityx.city import City
from cityx.city.ground import LABEL, Ground
from cityx.city.layout import in_town
from cityx.city.thing_outlines import placed_outlines
from cityx.geometry.arrays import BoolArray, FloatArray
from cityx.geometry.clearance import distance_within, near_any
from cityx.geometry.scatter import Points, candidates, cells_of_triangles, near_pairs, thin
from cityx.ground.pieces import (
    Pieces,
    front,
    in_carriageways,
    inside_extent,
    join_pieces,
    may_stand,
    pieces,
    room_along,
    walk_rims,
    ways_to_doors,
    with_pieces,
)
from cityx.ground.standing import WALKED, stand_on
from cityx.ground.street_rules import (
    AMPLE,
    AMPLE_CLEAR,
    APART,
    BOXED,
    BOXES,
    CLEAR,
    DOOR_DEPTH,
    DOOR_SIDE,
    FRONT_LINE,
    INSTEAD,
    KERB_RULES,
    LEANING,
    PIECE_GAP,
    RACKED,
    ROWS,
    SIGHT,
    SLOT,
    STREETS,
    TALL,
    TALL_GAP,
    TIGHT,
    TRUNK_GAP,
    USUAL_GAP,
    WALL_GAP,
    WIDE_WALK,
    drawn_shares,
    local_names,
    varied,
)
from cityx.ground.walking.passage import crowding
from cityx.ids import choose, hash_ids, uniform
from cityx.nature.furniture.asked_numbers import counted
from cityx.nature.furniture.corner_kerbs import at_corners, in_kerb_line, past_junctions
from cityx.nature.furniture.forecourts import amid_forecourts, at_forecourts
from cityx.nature.furniture.plot_edges import along_plots
from cityx.nature.furniture.poles import utility_poles
from cityx.nature.furniture.signs import junction_signs, level_crossing_posts
from cityx.nature.furniture.wall_things import along_walls
from cityx.nature.land.frontages import frontage_edges
from cityx.places.profile import Profile
from cityx.places.profiles import profile_of
from cityx.protocol import Port, Range, action
from cityx.road.parking.bays import yard_bays, yard_lots
from cityx.road.surface.kerbs import join_places, places_along, yaw_facing

ACTION = "nature/street_pieces-v1"
LAYER = "street_pieces"

REACH = 12.0  # metres; no walk is looked at farther than this
IN_KERB = 0.08  # metres beyond the carriageway where a look across the walk begins
ZEBRA_GAP = 5.0  # metres behind a junction's trim that a zebra and its dropped kerb take
CROSSING_GAP = 4.0  # metres round a mapped crossing
TOWN = 25.0  # metres within which an urban building makes a kerb a kerb in town
STRIP = 0.9  # metres at the kerb that other furniture may take
# Trades that serve on the walk, and what others put before their windows; with shares of them.
CAFE_SHARE = {"cafe": 0.8, "restaurant": 0.55, "bar": 0.5, "bakery": 0.3, "quick": 0.2}
GOODS = {"grocer": "fruit_stand", "flowers": "flower_stand", "clothes": "clothes_rail"}
GOODS_SHARE = 0.7
# Fronts of first bays of shops, by whose ids one knows the trade (`cityx.building.shops.shops`).
KNOWN_FRONTS = ("shop_classic", "shop_modern")
BOARD_SHARE, TUB_SHARE, MACHINE_SHARE, POT_SHARE = 0.2, 0.2, 0.25, 0.55
BANNERS, BANNER_SHARE = ("banner_red", "banner_blue"), 0.3  # of shops on narrow walks
LEVEL = 1.2  # metres between the ground and the foot of a shopfront that opens onto it
OPEN_SPACING = 5.2  # metres between things on plazas and in yards
ALONG_WALL = 0.15  # metres that a wall may leave the line of what stands at it
WALL_REACH = 3.5  # metres from a wall within which a thing is moved to it
# Ground on which things stand apart from kerbs.
OPEN = ("plaza", "courtyard", "sidewalk", "gravel", "frontage")
# What stands free on plazas, with weights; "" is nothing.
PLAZA = {"": 3.2, "bench": 2.0, "stone_bench": 1.5, "planter": 2.0, "waste_basket": 0.8,
         "planter_round": 1.0, "advertising_column": 0.15, "kiosk": 0.12,
         "bicycle_parking": 0.5, "street_lamp_post": 0.8}  # fmt: skip
# On the lawns of yards, away from walls and at them.
LAWN = {"": 3.0, "bench": 0.8, "clothes_dryer": 1.0, "vegetable_bed": 1.0, "picnic_table": 0.5}
LAWN_WALL = {"": 3.0, "garden_shed": 1.2, "pot_row": 1.0, "planter": 0.5, "bench": 0.6}
# On walks as wide as squares, as at the corners of large junctions, away from walls and kerbs.
WALK_OPEN = {"": 1.5, "planter": 1.5, "planter_round": 1.0, "bench": 0.8, "bicycle_parking": 1.4,
             "waste_basket": 0.4}  # fmt: skip
# Metres left to pass on walks and in yards where bicycles and machines stand at the walls of narrow
# walks, whose kerbs bear poles alone.
NARROW = (TIGHT, CLEAR)
# Half the size of a piece that stands free, metres.
SIZE = {"bench": 1.0, "stone_bench": 1.1, "planter": 0.7, "waste_basket": 0.3, "cafe_set": 0.95,
        "planter_round": 0.4, "advertising_column": 0.8, "kiosk": 1.9, "bicycle_parking": 1.4,
        "street_lamp_post": 0.3, "wheelie_bins": 0.7, "parasol": 1.3, "shop_board": 0.35,
        "vending_machine": 0.6, "bicycle": 0.9, "bollard": 0.12, "motor_scooter": 0.92,
        "motor_scooter_red": 0.92, "cartons": 0.65, "street_cabinet": 0.66, "fruit_stand": 0.95,
        "flower_stand": 0.8, "clothes_rail": 0.8, "banner_red": 0.3, "banner_blue": 0.3,
        "garden_shed": 1.75, "bin_store": 1.4, "pot_row": 0.8, "clothes_dryer": 1.35,
        "vegetable_bed": 1.25, "picnic_table": 1.1, "parking_board": 0.75, **HALVES,
        }  # fmt: skip
# Metres from the middle of a bay to its stop, and to the next bay; from a lot to its board.
FROM_BAY, NEXT_BAY, BOARD_ASIDE = 2.62, 2.55, 1.4
TO_WARES = 1.9  # metres that groups at walls keep from what shops put out
BENCHES = ("bench", "stone_bench")
PARKED_SHARE = 0.55  # of the places of a bicycle stand that are taken


@dataclass(frozen=True)
class _Site:
    """What the rules look at: rims of the walks, walls, doors, and what stands already."""

    rims: NDArray[Any]
    houses: NDArray[Any]
    urban: NDArray[Any]
    doors: NDArray[Any]
    ways: NDArray[Any]
    fixed: FloatArray
    trunks: FloatArray
    profile: Profile


def _site(city: City) -> _Site:
    buildings = city.layout.buildings
    houses = buildings.geometry.to_numpy()
    urban = in_town(buildings)
    rims = walk_rims(city.ground) if city.ground is not None else np.zeros(0, object)
    if city.scene.meshes.get("barriers") is not None:  # their faces are rims as well
        edges = frontage_edges(city)
        rims = np.concatenate([rims, edges.lines[edges.kind != ""]])
    return _Site(rims, houses, houses[urban], door_zones(city), ways_to_doors(city),
                 _standing(city, "street_furniture"),
                 np.concatenate([_standing(city, layer) for layer in ("trees", "tree_pits")]),
                 profile_of(city.frame))  # fmt: skip


def _standing(city: City, layer: str) -> FloatArray:
    rows = city.scene.instances.get(layer)
    return np.zeros((0, 2)) if rows is None else rows.position[:, :2]


def door_zones(city: City) -> NDArray[Any]:
    """(d,) rectangles before doors that stay free."""
    rows = city.scene.instances.get("doors")
    if rows is None or not rows.count:
        return np.zeros(0, object)
    out = front(rows.rotation[:, 2])
    side = np.column_stack([-out[:, 1], out[:, 0]]) * DOOR_SIDE
    foot = rows.position[:, :2]
    far = foot + DOOR_DEPTH * out
    return np.asarray(
        shapely.polygons(np.stack([foot - side, far - side, far + side, foot + side], axis=1))
    )


def _along_kerbs(city: City, site: _Site, density: float) -> tuple[Pieces, FloatArray]:
    """Draw things for slots of kerb; return them with half their lengths and depths, (n, 2)."""
    network, roads = city.network, city.layout.roads
    none = join_pieces([]), np.zeros((0, 2))
    if network is None or not network.edge_count:
        return none
    row = network.edge_road
    kind = roads["kind"].to_numpy().astype(str)
    rank = np.array([STREETS.get(name, "") for name in kind])[row]
    flat = ~(roads["bridge"].to_numpy() | roads["tunnel"].to_numpy())[row]
    flat &= (roads["layer"].to_numpy()[row] == 0) & ~roads["passage"].to_numpy()[row]
    groups = [
        places_along(network, np.flatnonzero(flat & (rank != "") & (zebra == has)), side,
                     spacing=SLOT, beyond=IN_KERB, margin=2.0 + ZEBRA_GAP * has)
        for side in (1, -1) for has in (False, True)
        for zebra in (network.crossing.any(axis=1),)
    ]  # fmt: skip
    slots = join_places(*groups)
    slots = slots.take(inside_extent(city, slots.xy, 1.0))
    if not len(slots.xy):
        return none
    town = near_any(slots.xy, site.urban, TOWN)
    column = 2 * ~town + (rank[slots.edge] != "main")
    room = IN_KERB + room_along(slots.xy, -slots.toward_road, site.rims, REACH)
    wide = room >= WIDE_WALK
    edges = drawn_shares(site.profile.furniture, column, wide, density)
    ids = hash_ids(0, f"{ACTION}/kerb", network.edge_id[slots.edge],
                   2 * slots.number + (slots.side > 0))  # fmt: skip
    draw = uniform(city.seed, f"{ACTION}/kerb", ids)
    rule = (draw[:, None] >= edges).sum(axis=1)
    rows = np.flatnonzero(rule < len(KERB_RULES))
    slots, rule, ids = slots.take(rows), rule[rows], ids[rows]
    number = {r.piece: n for n, r in enumerate(KERB_RULES)}
    for alone, rack in RACKED.items():
        rule[wide[rows] & (rule == number[alone])] = number[rack]
    rule = _few_of_a_kind(city, slots.xy, rule, ids)
    asked = np.array([(r.from_kerb, r.room, r.length, r.depth) for r in KERB_RULES])[rule]
    out = -slots.toward_road
    # On wide walks the fronts of all things lie in one line.
    line = np.where(wide[rows], FRONT_LINE + asked[:, 3], 0.0)
    further = np.maximum(line - asked[:, 0], 0.0)
    asked[:, :2] += further[:, None]
    more = np.where(room[rows] >= AMPLE, AMPLE_CLEAR - CLEAR, 0.0)
    fits = room[rows] >= asked[:, 1] + more
    assert city.ground is not None
    fits &= city.ground.on(slots.xy, *WALKED)
    slip = (uniform(city.seed, f"{ACTION}/slip", ids) - 0.5) * 2.0
    xy = slots.xy + out * (asked[:, :1] - IN_KERB) + slots.ahead * slip[:, None]
    names = np.array([r.piece for r in KERB_RULES], object)[rule]
    fits &= (room[rows] >= BOXED) | ~np.isin(names, list(BOXES))
    points = city.layout.points
    crossings = points.geometry.to_numpy()[points["kind"].to_numpy() == "crossing"]
    fits &= ~near_any(xy, crossings, CROSSING_GAP)
    joints = shapely.points(network.node_position[network.node_degree >= 3])
    fits &= ~(np.isin(names, list(TALL)) & near_any(xy, joints, SIGHT + 6.0))
    # One sits with the back to the traffic as often as facing it; everything else faces it.
    turned = (names == "bench") & (uniform(city.seed, f"{ACTION}/back", ids) < 0.5)
    yaw = yaw_facing(np.where(turned[:, None], out, -out))
    yaw = yaw + np.where(np.isin(names, LEANING), np.pi / 2, 0.0)  # along the kerb, off the walk
    single, sizes = pieces(names, xy, ids, yaw).take(fits), asked[fits, 2:]
    # One bollard keeps nobody off: they stand in threes; so do the tubs of wide walks.
    step = np.array([ROWS.get(str(name), 0.0) for name in single.name])
    step *= (single.name == "bollard") | wide[rows][fits]
    row = np.flatnonzero(step > 0)
    of, ahead = single.take(row), slots.ahead[fits][row] * step[row, None]
    placed = [single, *(
        replace(of, xy=of.xy + sign * ahead,
                id=hash_ids(0, f"{ACTION}/beside/{sign:+.1f}", of.id))
        for sign in (-1.0, 1.0)
    )]  # fmt: skip
    return join_pieces(placed), np.concatenate([sizes, sizes[row], sizes[row]])


def _few_of_a_kind(
    city: City, xy: FloatArray, rule: NDArray[np.int64], ids: NDArray[np.uint64]
) -> NDArray[np.int64]:
    """(n,) rules, those for things of which there is one close by already exchanged for others."""
    names = [r.piece for r in KERB_RULES]
    points = city.layout.points
    kind = points["kind"].to_numpy().astype(str)
    other = np.array([names.index(name) for name in INSTEAD])
    rule = rule.copy()
    for name, gap in APART.items():
        rows = np.flatnonzero(rule == names.index(name))
        mapped = near_any(xy[rows], points.geometry.to_numpy()[kind == name], gap)
        first = np.isin(ids[rows], thin(Points(xy[rows], ids[rows]), gap).id)
        repeated = rows[mapped | ~first]
        rule[repeated] = other[ids[repeated] % np.uint64(len(other))]
    return rule


def _labels(names: Any) -> list[int]:
    return [LABEL[name] for name in names]


def _before_shops(city: City, site: _Site, density: float) -> Pieces:
    """Tables, boards and tubs before shops and doors on wide walks; machines on narrow ones."""
    found: list[Pieces] = []
    for layer in ("shopfronts", "doors"):
        rows = city.scene.instances.get(layer)
        if rows is None or not rows.count:
            continue
        names = np.array([p.name for p in city.scene.prototypes], object)[rows.prototype]
        names = np.array([name.removesuffix("_fine") for name in names], object)
        out = front(rows.rotation[:, 2])
        side = np.column_stack([-out[:, 1], out[:, 0]])
        foot = rows.position[:, :2]
        step = foot + 0.3 * out
        below = stand_on(city.scene.meshes.get("ground"), step)
        level = np.isin(below.label, _labels(WALKED))
        level &= np.abs(np.nan_to_num(below.z, nan=1e9) - rows.position[:, 2]) < LEVEL
        room = 0.3 + room_along(step, out, site.rims, REACH)
        narrow = site.profile.furniture.narrow_walks  # whose kerbs bear poles
        left, kerb = (NARROW[0], 0.0) if narrow else (CLEAR, STRIP)

        def drawn(purpose: str, share: Any, *, layer: str = layer, rows: Any = rows) -> BoolArray:
            key = f"{ACTION}/{layer}/{purpose}"
            return np.asarray(uniform(city.seed, key, rows.object_id) < share * density)

        def put(name: str, chosen: BoolArray, away: float, aside: float, turn: float = 0.0,
                *, layer: str = layer, rows: Any = rows, foot: FloatArray = foot,
                out: FloatArray = out, side: FloatArray = side) -> None:  # fmt: skip
            at = np.flatnonzero(chosen)
            ids = hash_ids(0, f"{ACTION}/{layer}/{name}/{aside:+.1f}", rows.object_id[at])
            yaw = yaw_facing(out[at]) + turn * (uniform(city.seed, ACTION, ids) - 0.5)
            found.append(pieces(name, foot[at] + away * out[at] + aside * side[at], ids, yaw))

        if layer == "shopfronts":
            trade = shop_names(city, rows.object_id, rows.owner, foot)[1]
            trade = np.where(np.isin(names, KNOWN_FRONTS), trade, "")
            share = np.array([CAFE_SHARE.get(word, 0.0) for word in trade.tolist()])
            cafe = level & drawn("cafe", share)
            wide = cafe & (room >= 2.0 + 1.2 + STRIP + CLEAR)
            put("parasol", wide, 1.75, 0.0)
            tables = cafe & ~wide & (room >= 0.95 + 0.85 + STRIP + CLEAR)
            put("cafe_set", tables, 0.95, -0.95, 0.8)
            put("cafe_set", tables, 0.95, 0.95, 0.8)
            board = level & ~cafe & drawn("board", BOARD_SHARE) & (room >= 0.6 + kerb + left)
            put("shop_board", board, 0.55 if kerb else 0.35, 0.9, 0.7)
            for word, name in GOODS.items():
                laid = level & ~cafe & ~board & (trade == word) & (room >= 0.8 + left)
                put(name, laid & drawn("goods", GOODS_SHARE), 0.42, -0.75)
            if narrow:
                flown = level & drawn("banner", BANNER_SHARE) & (room >= 0.5 + left)
                for number, name in enumerate(BANNERS):
                    put(name, flown & (rows.object_id % np.uint64(2) == number), 0.3, 1.45, 0.6)
                machine = level & ~cafe & ~board & drawn("machine", MACHINE_SHARE)
                pots = level & ~cafe & ~machine & drawn("pots", POT_SHARE)
                put("pot_row", pots & (room >= 0.48 + left), 0.24, -1.0)
                pots = level & ~cafe & ~board & ~flown & drawn("more pots", POT_SHARE)
                put("pot_row", pots & (room >= 0.48 + left), 0.24, 1.0)
                put("vending_machine", machine & (room >= 0.9 + left), 0.48, -1.0)
        else:
            tubs = level & drawn("tubs", TUB_SHARE) & (room >= 0.8 + STRIP + CLEAR)
            tubs &= np.isin(names, ("door_lobby", "door_glass", "door_panel", "door_sidelight"))
            put("planter_round", tubs, 0.5, -1.35)
            put("planter_round", tubs, 0.5, 1.35)
            if narrow:  # plants in pots at one side, or both, of doors of houses
                for side_of, purpose in ((-1.3, "pots left"), (1.3, "pots right")):
                    pots = level & ~tubs & drawn(purpose, POT_SHARE)
                    put("pot_row", pots & (room >= 0.48 + left), 0.24, side_of)
    return join_pieces(found)


def _scattered(city: City, ground: Ground) -> Points:
    """Candidates about plazas, yards and walks, the same whatever the site's rectangle."""
    # Lawns of yards and gardens; those of the map have an object.
    lawn = ground.labelled("grass") & (ground.face_object == 0)
    faces = ground.labelled(*OPEN) | lawn
    triangles = ground.triangles[faces[ground.triangle_face]]
    cells = cells_of_triangles(ground.vertices[triangles], OPEN_SPACING)
    found = candidates(cells, OPEN_SPACING, seed=city.seed, purpose=ACTION)
    one = found.id % np.uint64(3) == 0  # about one per cell are enough for things so far apart
    return Points(found.xy[one], found.id[one])


def _in_the_open(city: City, site: _Site, density: float) -> Pieces:
    """Things on plazas and in yards, free in the middle or moved to the wall; those of walks."""
    ground = city.ground
    if ground is None:
        return join_pieces([])
    spots = _scattered(city, ground)
    surfaces = (*OPEN, "grass")
    place = ground.first_of(spots.xy, *surfaces)
    spots, place = Points(spots.xy[place >= 0], spots.id[place >= 0]), place[place >= 0]
    kept = np.isin(spots.id, thin(spots, OPEN_SPACING).id)
    xy, ids, place = spots.xy[kept], spots.id[kept], place[kept]
    plaza, yard, walk, gravel, before, lawn = (place == n for n in range(len(surfaces)))
    yard |= gravel
    own, local = site.profile.land.own_frontage, site.profile.furniture
    yard, walk = yard | (before & own), walk | (before & (not own))
    lawn &= ~near_any(xy, site.ways, DOOR_SIDE + 0.6)
    rim = distance_within(xy, site.rims, 4.0)
    wall = distance_within(xy, site.houses, WALL_REACH)
    names = np.full(len(ids), "", object)
    for chosen, weights in (
        (plaza & (rim > 1.0), PLAZA),
        (yard & np.isinf(wall), local.yards),
        (yard & np.isfinite(wall), local.yard_walls),
        (lawn & np.isinf(wall), LAWN),
        (lawn & np.isfinite(wall), LAWN_WALL),
        (walk & np.isinf(wall), WALK_OPEN),
        (walk & np.isfinite(wall), local.walk_walls),
    ):
        words = np.array(list(weights), object)
        share = np.array(list(weights.values()))
        share[0] /= max(density, 1e-6)
        drawn = words[choose(city.seed, f"{ACTION}/open", ids, share)]
        names = np.where(chosen, drawn, names)
    turn = uniform(city.seed, f"{ACTION}/turn", ids) * 2 * np.pi
    along = walk & np.isinf(wall)
    deep = {rule.piece: rule.depth for rule in KERB_RULES}
    depth = np.array([deep.get(str(name), SIZE.get(str(name), 0.5)) for name in names[along]])
    xy[along], turn[along] = in_kerb_line(city.network, xy[along], depth, turn[along])
    at_wall = ~plaza & np.isfinite(wall) & (names != "")
    half = np.array([SIZE.get(str(name), 0.5) for name in names])
    keep = (names != "") & (at_wall | (rim >= half + np.where(lawn, 0.0, CLEAR)))
    rows = np.flatnonzero(at_wall)
    if len(rows):
        nearest = shapely.STRtree(site.houses).query_nearest(
            shapely.points(xy[rows]), all_matches=False
        )[1]
        outline = shapely.boundary(site.houses[nearest])
        along = shapely.line_locate_point(outline, shapely.points(xy[rows]))
        foot = shapely.get_coordinates(shapely.line_interpolate_point(outline, along))
        away = xy[rows] - foot
        length = np.hypot(*away.T)
        away /= np.maximum(length, 1e-6)[:, None]
        xy = xy.copy()
        gap = np.array([WALL_GAP.get(str(name), USUAL_GAP) for name in names[rows]])
        xy[rows] = foot + gap[:, None] * away
        turn[rows] = yaw_facing(away) + np.where(np.isin(names[rows], LEANING), np.pi / 2, 0.0)
        room = room_along(foot + 0.1 * away, away, site.rims, REACH)
        kerb = np.where(walk[rows], STRIP, 0.0)  # what stands there takes its share of the walk
        left = np.where(walk[rows], *NARROW) if local.narrow_walks else CLEAR + kerb
        keep[rows] &= (length > 0.2) & (lawn[rows] | (room >= 2 * gap + left))
        # What stands at a corner would touch it alone: the wall goes on behind half of each side.
        side = np.column_stack([-away[:, 1], away[:, 0]]) * half[rows, None] / 2
        for end in (foot - side, foot + side):
            keep[rows] &= shapely.distance(outline, shapely.points(end)) < ALONG_WALL
    return pieces(names, xy, ids, turn).take(keep)


def _car_parks(city: City) -> tuple[Pieces, Pieces]:
    """Return stops at the ends of the bays of yards, and the boards of these car parks."""
    bays = yard_bays(city)
    ahead = front(bays.yaw)
    ids = hash_ids(0, f"{ACTION}/stop", bays.id)
    stops = pieces("wheel_stop", bays.xy + FROM_BAY * ahead, ids, bays.yaw)
    stops = stops.take(~near_any(stops.xy, shapely.points(bays.xy), NEXT_BAY))
    if city.network is None:
        return stops, join_pieces([])
    lots = yard_lots(city)
    aside = lots.size[:, :1] / 2 + BOARD_ASIDE
    across = np.column_stack([-lots.along[:, 1], lots.along[:, 0]])
    xy = lots.middle + aside * lots.along
    boards = pieces("parking_board", xy, hash_ids(0, f"{ACTION}/board", lots.id),
                    yaw_facing(across))  # fmt: skip
    return stops, boards.take(~near_any(xy, shapely.points(bays.xy), NEXT_BAY))


def _bicycles(city: City, stands: Pieces) -> Pieces:
    """Bicycles in some of the places of the stands."""
    found = []
    for number, aside in enumerate((-1.0, 0.0, 1.0)):
        for side in (-1, 1):
            ids = hash_ids(city.seed, f"{ACTION}/bicycle", stands.id, 2 * number + (side > 0))
            taken = uniform(city.seed, f"{ACTION}/parked", ids) < PARKED_SHARE
            out = front(stands.yaw)
            right = np.column_stack([-out[:, 1], out[:, 0]])
            back = (uniform(city.seed, f"{ACTION}/back", ids) < 0.5) * np.pi
            lean = 0.12 * (uniform(city.seed, f"{ACTION}/lean", ids) - 0.5)
            xy = stands.xy + (aside + 0.16 * side) * right
            found.append(pieces("bicycle", xy, ids, stands.yaw + back + lean).take(taken))
    return join_pieces(found)


def _free(
    city: City, site: _Site, found: Pieces, size: FloatArray, group: NDArray[np.uint64]
) -> BoolArray:
    """(n,) whether pieces stand clear of doors, houses, trunks, other furniture and each other.

    ``size`` is half their lengths and depths, (n, 2); those of a group may be close together.
    """
    half, depth = size.T
    spots = shapely.buffer(shapely.points(found.xy), np.maximum(half, 0.2), quad_segs=2)
    free = inside_extent(city, found.xy, 0.5) & ~in_carriageways(city, found.xy, depth)
    if len(site.doors):
        free[shapely.STRtree(site.doors).query(spots, predicate="intersects")[0]] = False
    trunk_gap = np.where(np.isin(found.name, list(TALL)), TALL_GAP, TRUNK_GAP)
    for others, gap in ((site.fixed, PIECE_GAP), (site.trunks, trunk_gap)):
        tree = shapely.STRtree(shapely.points(others))
        reach = half + gap
        free[tree.query(shapely.points(found.xy), predicate="dwithin", distance=reach)[0]] = False
    free &= ~near_any(found.xy, site.houses, 0.05)
    assert city.ground is not None
    free &= city.ground.on(found.xy, *WALKED, "grass")
    # Of two that are too near to each other the one with the higher id stays.
    rows = np.flatnonzero(free)
    pairs = near_pairs(found.xy[rows], 2 * SIZE["kiosk"] + 0.3) if len(rows) else np.zeros((0, 2))
    pairs = rows[pairs.astype(int)]
    gap = np.hypot(*(found.xy[pairs[:, 0]] - found.xy[pairs[:, 1]]).T)
    near = gap < half[pairs].sum(axis=1) + 0.3
    pairs = pairs[near & (group[pairs[:, 0]] != group[pairs[:, 1]])]
    lower = np.where(found.id[pairs[:, 0]] < found.id[pairs[:, 1]], pairs[:, 0], pairs[:, 1])
    free[lower] = False
    return np.asarray(free)


def _signs(city: City, site: _Site) -> Pieces:
    """Signs at junctions where a pole leaves enough of the walk."""
    signs, out = junction_signs(city)
    if not len(signs):
        return signs
    room = room_along(signs.xy, out, site.rims, 3.0)
    label = stand_on(city.scene.meshes.get("ground"), signs.xy).label
    walked = np.isin(label, _labels(WALKED))
    soft = np.isin(label, _labels(("block", "grass", "park", "meadow", "wood", "bare")))
    good = (walked & (room >= TIGHT + 0.1)) | soft
    good &= ~near_any(signs.xy, site.houses, 0.35) & inside_extent(city, signs.xy, 0.5)
    good &= ~near_any(signs.xy, shapely.points(site.fixed), 0.8)
    good &= ~near_any(signs.xy, site.doors, 0.1)
    signs = signs.take(good)
    kept = thin(Points(signs.xy, signs.id), 0.9).id
    return signs.take(np.isin(signs.id, kept))


@action(
    ACTION,
    limits=[
        "Needs the draped ground; without it nothing stands.",
        "Walks narrower than 1.5 m beside the piece get none.",
    ],
    requires=("layout",),
    after=("nature/trees-v2", "nature/furniture-v1", "nature/barriers-v1", "building/facade-v1"),
    takes=(Port("ground", "surface", role="ground", optional=True),),
    gives=(Port("pieces", "point", role="street_pieces"),),
    labels=("benches", "bins", "planters", "bicycle racks", "cafe tables", "kiosks", "signs"),
)
def street_pieces(
    city: City, *, density: Annotated[float, Range(0.0, 3.0)] = 1.0, signs: bool = True
) -> City:
    """Place benches, bins, tubs, racks, kiosks, cafe tables and signs where no map shows them.

    Parameters
    ----------
    city
        City with its ground; facades tell where doors and shops are.
    density
        Factor of all frequencies of `cityx.ground.street_rules`.
    signs
        Whether junctions get signs and street names.
    """
    done = city.stages_done | {"nature"}
    if city.lod < 2 or city.ground is None or "ground" not in city.scene.meshes:
        return replace(city, stages_done=done)
    site = _site(city)
    posts = _signs(city, site) if signs else join_pieces([])
    posts = join_pieces([posts, level_crossing_posts(city)])
    local = site.profile.furniture
    if site.profile.streets.utility_poles:
        standing = np.concatenate([site.fixed, site.trunks, posts.xy])
        poles, wires = utility_poles(city, standing)
        posts = join_pieces([posts, poles])
        if wires.count:
            city = replace(city, scene=city.scene.with_mesh("wires", wires))
    site = replace(site, fixed=np.concatenate([site.fixed, posts.xy]))
    kerb, sizes = _along_kerbs(city, site, density)
    corners = at_corners(city, site.rims, local)
    past = past_junctions(city, site.rims, local, density)
    shops = _before_shops(city, site, density)
    open_ = _in_the_open(city, site, density)
    stops, boards = _car_parks(city) if local.lot_fittings else (join_pieces([]),) * 2
    plots = along_plots(city, local)
    walls = along_walls(city, site.rims, density) if local.narrow_walks else join_pieces([])
    groups = at_forecourts(city, site.rims, local, density)
    amid, group = amid_forecourts(city, site.ways, local, density)
    groups = groups.take(~near_any(groups.xy, shapely.points(shops.xy), TO_WARES))
    rest = join_pieces([corners, past, shops, plots, open_, groups, boards, walls, amid])
    drawn = join_pieces([kerb, rest])
    other = np.array([SIZE.get(str(name), 0.5) for name in rest.name])
    half = np.concatenate([sizes, np.repeat(other[:, None], 2, axis=1)])
    apart = np.arange(len(drawn) - len(amid), dtype=np.uint64)
    kept = drawn.take(_free(city, site, drawn, half, np.concatenate([apart, group])))
    stands = kept.take(kept.name == "bicycle_parking")
    bicycles = _bicycles(city, stands)
    found = join_pieces([posts, kept, bicycles, stops])
    found = replace(found, name=varied(local_names(found.name, local), found.id))
    found = found.take(~counted(city, found) & ~_in_asked_rows(city, found))
    found = found.take(may_stand(city, found))
    city = replace(city, stages_done=done)
    return with_passage(city, found, posts.id) if len(found) else city


def _in_asked_rows(city: City, found: Pieces) -> BoolArray:
    """(n,) whether pieces are benches where those of streets were asked for in rows."""
    rows = city.layout.points["source"].str.startswith("made/row_of_bench/").to_numpy(bool)
    return np.isin(found.name.astype(str), BENCHES) & bool(rows.any())


def with_passage(city: City, found: Pieces, fixed: NDArray[np.uint64]) -> City:
    """Put pieces into the city, but those that leave no way past them on a walk; posts stay."""
    city = with_pieces(city, LAYER, found)
    outlines, xy, ids = placed_outlines(city.scene)
    asked = np.isin(ids, found.id[~np.isin(found.id, fixed)])
    rows, tight = crowding(city, outlines, xy, asked)
    crowded = np.isin(found.id, ids[rows[tight]])
    return with_pieces(city, LAYER, found.take(~crowded)) if crowded.any() else city
