"""Roof furniture: chimneys on pitched roofs, plant and stair heads on flat ones."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.assets.styles.generators import Generator
from cityx.assets.styles.palettes import GROUPS, Finishes, groups_of, owner_rows
from cityx.assets.trims.roof_furniture import REACH, STAINS, roof_furniture
from cityx.building.catalogue import generator_named
from cityx.building.facade.fronts import reserve_of
from cityx.building.parking_decks import deck_rows
from cityx.building.volumes import covered
from cityx.city.scene import Instances, Prototype
from cityx.geometry.arrays import FloatArray
from cityx.geometry.ranges import numbered
from cityx.ids import choose, hash_ids, uniform
from cityx.system.tables import DATA, read_table

if TYPE_CHECKING:
    from cityx.building.facade.walls import WallTable
    from cityx.building.roofs.roof_heights import RoofField
    from cityx.building.volumes import Volumes
    from cityx.city.city import City

EDGE = 0.7  # metres between a piece and the inner face of the parapet
MIN_AREA = 28.0  # square metres; smaller flat roofs stay bare
# Square metres of flat roof per piece by group; where many work there is more plant.
PER_PIECE = {"office": 17.0, "retail": 18.0, "flats": 20.0, "civic": 22.0}
USUAL_PER_PIECE = 24.0
MOST = 90  # pieces on one roof
TRIES = 6
CHIMNEY_TOP = 0.8  # metres a chimney stands above the ridge
CHIMNEY_SUNK = 0.4  # metres of a chimney inside the roof
MAX_STACK = 2.2  # metres a chimney stands above the slope it leaves
PARTY_ROOM = 0.42  # metres between the middle of a chimney and the party wall it stands at
NEAR_RIDGE = 0.8  # metres below the ridge at which such a chimney still stands
CHIMNEY = 3.0  # metres, drawn height of chimneys

HEADED = 110.0  # square metres of a flat roof from which it has the head of a stair
LIFTED = 6  # storeys from which that is one of a lift
DECKED = "parking"  # generator whose roofs one parks on
STAFFED = ("flats", "office", "civic", "retail")

PIECES = tuple(REACH)
# What others stand on; each lies a little higher than the one before it.
FLAT = tuple(PIECES.index(name) for name in ("roof_patch", "roof_sheet", *STAINS))
LAYERS, LAYER = 10, 0.06
# What age leaves on flat roofs of all but houses, as shares of the weights of all else.
WEAR = {"roof_sheet": 0.10, **dict.fromkeys(STAINS, 0.06)}
# Flat roofs that people use may have a garden: share of them, square metres of roof for each bed
# of it, and of the smallest roof with one.
GARDENS, GARDEN_PER, GARDEN_FROM = 0.22, 45.0, 110.0
GARDEN_SORTS: Mapping[str, float] = {"roof_lawn": 1.0, "roof_beds": 1.0, "roof_meadow": 1.0}
# Flat roofs that people use have a railing, and all decks one parks on: share of the former, metres
# from the wall's face to it, of its bays, and of the shortest edge with one.
RAILED, RAIL_AREA, RAIL_IN, RAIL_BAY, RAIL_LEAST = 0.4, 90.0, 0.45, 3.0, 1.6
_WEIGHTS: Mapping[str, Mapping[str, float]] = read_table(DATA / "rooftops.toml")  # by group


def furnish_roofs(
    city: City,
    volumes: Volumes,
    finishes: Finishes,
    field: RoofField | None = None,
    walls: WallTable | None = None,
) -> tuple[list[Prototype], Instances]:
    """Place everything that stands on roofs.

    Parameters
    ----------
    field, walls
        The roofs that chimneys stand on, where they are known, and the walls below: in a row of
        houses a chimney stands where the ridge meets the party wall.

    Returns
    -------
    prototypes, rows
        Every piece lies wholly on the roof of its part; chimneys begin inside the roof.
    """
    group = groups_of(city.layout, city.seed)
    flat = volumes.top - volumes.eave < 0.15
    level = _on_flat(city, volumes, group, flat)
    pitched = _chimneys(city, volumes, group, flat, field, walls)
    railed = _railings(city, volumes, group, flat)
    part, piece, x, y, z, height, yaw, number = (
        np.concatenate(each) for each in zip(level, pitched, railed[:-1], strict=True)
    )
    part, piece, number = part.astype(int), piece.astype(int), number.astype(int)
    ids = city.layout.parts["id"].to_numpy(np.uint64)[part]
    scale = np.ones((len(part), 3), np.float32)
    scale[:, 2] = height
    scale[len(scale) - len(railed[-1]) :, 0] = railed[-1]
    rotation = np.zeros((len(part), 3), np.float32)
    rotation[:, 2] = yaw
    # Stair heads and chimneys are of the house's own material; plant is as it comes.
    own = np.isin(
        piece, [PIECES.index(name) for name in ("stair_head", "lift_house", "chimney_small")]
    )
    brick = finishes.wall_material[part] == "brick"
    red = np.array([0.42, 0.22, 0.16], np.float32)
    tint = np.where(own[:, None], finishes.wall_tint[part], 1.0).astype(np.float32)
    # Mended sheets are newer or older than those around them.
    age = 0.55 + 0.9 * uniform(city.seed, "roof/patch", ids, number)
    patch = np.isin(piece, FLAT)
    # Puddles leave dirt, which is darker; how much lies there tells the age of a roof.
    age = np.where(np.isin(piece, FLAT[:2]), age, 0.45 + 0.3 * age)
    sheet = finishes.roof_tint[part] * age[:, None]
    tint = np.where(patch[:, None], sheet, tint).astype(np.float32)
    stack = piece == PIECES.index("chimney")
    tint = np.where(
        stack[:, None], np.where(brick[:, None], finishes.wall_tint[part], red), tint
    ).astype(np.float32)
    rows = Instances(
        piece.astype(np.int32),
        hash_ids(0, "facade/roof", ids, number),
        volumes.building[part],
        np.column_stack([x, y, z]),
        rotation,
        scale,
        tint,
    )
    order = np.lexsort((rows.prototype, rows.object_id))
    rows = Instances(
        rows.prototype[order], rows.object_id[order], rows.owner[order], rows.position[order],
        rows.rotation[order], rows.scale[order], rows.tint[order],
    )  # fmt: skip
    return [roof_furniture(name) for name in PIECES], rows


def _axes(polygons: NDArray[Any]) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Directions and middles of the smallest boxes around outlines: long, short, (n, 2) middle.

    ``long`` and ``short`` are (n, 2) half axes.
    """
    boxes = shapely.oriented_envelope(polygons)
    good = (shapely.get_type_id(boxes) == 3) & ~shapely.is_empty(boxes)
    corner = np.zeros((len(polygons), 5, 2))
    corner[good] = shapely.get_coordinates(boxes[good]).reshape(-1, 5, 2)
    a, b = (corner[:, 1] - corner[:, 0]) / 2, (corner[:, 2] - corner[:, 1]) / 2
    longer = np.hypot(*a.T) >= np.hypot(*b.T)
    long_axis = np.where(longer[:, None], a, b)
    short_axis = np.where(longer[:, None], b, a)
    # The sign of an axis depends on where its ring begins; fix it.
    for axis in (long_axis, short_axis):
        flip = (axis[:, 0] < -1e-9) | ((np.abs(axis[:, 0]) <= 1e-9) & (axis[:, 1] < 0))
        axis[flip] *= -1
    return long_axis, short_axis, (corner[:, 0] + corner[:, 2]) / 2


def _fits(
    polygons: NDArray[Any], part: NDArray[np.int64], x: FloatArray, y: FloatArray, reach: FloatArray
) -> NDArray[np.bool_]:
    points = shapely.points(x, y)
    inside = shapely.contains_xy(polygons[part], x, y)
    away = shapely.distance(shapely.boundary(polygons)[part], points)
    return np.asarray(inside & (away > reach))


def _on_flat(
    city: City, volumes: Volumes, group: NDArray[np.int64], flat: NDArray[np.bool_]
) -> tuple[Any, ...]:
    seed = city.seed
    area = np.where(volumes.usable, shapely.area(volumes.polygons), 0.0)
    words = np.array(GROUPS)[group]
    tables, own = _tables(city), _kinds(city)
    kind = np.where(np.isin(own, list(tables)), own, words)
    rows = np.flatnonzero(flat & volumes.walls & (area > MIN_AREA) & np.isin(kind, list(tables)))
    deck = volumes.eave - reserve_of(volumes, city.layout.parts, seed)
    ids = city.layout.parts["id"].to_numpy(np.uint64)
    per_piece = np.array([PER_PIECE.get(word, USUAL_PER_PIECE) for word in words[rows].tolist()])
    wanted = np.clip(
        area[rows] / per_piece * (0.5 + uniform(seed, "roof/count", ids[rows])), 1, MOST
    )
    count = np.round(wanted).astype(np.int64)
    part = np.repeat(rows, count)
    number = numbered(count)
    piece = np.zeros(len(part), np.int64)
    for name, weights in tables.items():
        of = np.flatnonzero(kind[part] == name)
        table = [float(weights.get(word, 0)) for word in PIECES]
        piece[of] = choose(seed, "roof/piece", ids[part[of]], table, number[of])
    # One stair head or lift house is enough for a roof of middle size.
    big = np.isin(piece, [PIECES.index("stair_head"), PIECES.index("lift_house")])
    piece[big & (number > 1)] = PIECES.index("ac_row")
    staffed = np.isin(words[part], STAFFED)
    green = staffed & (area[part] > GARDEN_FROM) & (number >= 1)
    green &= number <= area[part] / GARDEN_PER
    green &= uniform(seed, "roof/garden", ids[part]) < GARDENS
    sort = choose(seed, "roof/garden sort", ids[part[green]], list(GARDEN_SORTS.values()))
    piece[green] = np.array([PIECES.index(name) for name in GARDEN_SORTS])[sort]
    # A roof that people work on is reached by a stair, a high one by a lift.
    reached = (number == 0) & (area[part] > HEADED) & staffed
    levels = city.layout.parts["levels"].to_numpy(int)[part]
    head = np.where(levels >= LIFTED, PIECES.index("lift_house"), PIECES.index("stair_head"))
    piece = np.where(reached & (uniform(seed, "roof/head", ids[part]) < 0.8), head, piece)
    reach = np.array(list(REACH.values()))[piece]
    long_axis, short_axis, middle = _axes(volumes.polygons)
    x, y, found = np.zeros(len(part)), np.zeros(len(part)), np.zeros(len(part), bool)
    for attempt in range(TRIES):
        open_rows = np.flatnonzero(~found)
        u = (
            2 * uniform(seed, "roof/u", ids[part[open_rows]], number[open_rows] * TRIES + attempt)
            - 1
        )
        v = (
            2 * uniform(seed, "roof/v", ids[part[open_rows]], number[open_rows] * TRIES + attempt)
            - 1
        )
        at = (
            middle[part[open_rows]]
            + 0.85 * u[:, None] * long_axis[part[open_rows]]
            + 0.85 * v[:, None] * short_axis[part[open_rows]]
        )
        good = _fits(volumes.polygons, part[open_rows], at[:, 0], at[:, 1], reach[open_rows] + EDGE)
        hit = open_rows[good]
        x[hit], y[hit], found[hit] = at[good, 0], at[good, 1], True
    z = deck[part]
    if len(part):
        found &= ~covered(volumes, part, x, y, reach, z)
        # Things stand on mended sheets as on others.
        flat_piece = np.isin(piece, FLAT)
        found &= _clear(part, number, x, y, np.where(flat_piece, -0.3, reach), found)
    yaw = np.arctan2(long_axis[part, 1], long_axis[part, 0])
    # Panels look south, whatever the house does.
    solar = piece == PIECES.index("solar_panels")
    quarter = np.round((0.0 - yaw) / (np.pi / 2)) * np.pi / 2
    yaw = np.where(solar, yaw + quarter, yaw)
    keep = found
    thick = np.where(np.isin(piece, FLAT), 1 + LAYER * (number % LAYERS), 1.0)
    placed = (
        part[keep], piece[keep], x[keep], y[keep], z[keep], thick[keep], yaw[keep], number[keep],
    )  # fmt: skip
    decks = np.flatnonzero(flat & volumes.walls & (area > MIN_AREA) & (own == DECKED))
    if not len(decks):
        return placed
    bays = deck_rows(seed, volumes, ids, decks, deck, (long_axis, short_axis, middle))
    return tuple(np.concatenate(pair) for pair in zip(placed, bays, strict=True))


def _railings(
    city: City, volumes: Volumes, group: NDArray[np.int64], flat: NDArray[np.bool_]
) -> tuple[Any, ...]:
    """Bays of railings along the edges of flat roofs, as `_on_flat`, and their scale along x."""
    ids = city.layout.parts["id"].to_numpy(np.uint64)
    area = np.where(volumes.usable, shapely.area(volumes.polygons), 0.0)
    deck = _kinds(city) == DECKED
    used = np.isin(np.array(GROUPS)[group], STAFFED)
    used &= uniform(city.seed, "roof/railed", ids) < RAILED
    rows = np.flatnonzero(flat & volumes.walls & (area > RAIL_AREA) & (used | deck))
    inner = shapely.buffer(volumes.polygons[rows], -RAIL_IN, join_style="mitre")
    kept = (shapely.get_type_id(inner) == 3) & ~shapely.is_empty(inner)
    rows, inner = rows[kept], shapely.simplify(inner[kept], 0.05)
    points, row = shapely.get_coordinates(shapely.get_exterior_ring(inner), return_index=True)
    edge = np.flatnonzero(row[1:] == row[:-1])
    length = np.hypot(*(points[edge + 1] - points[edge]).T)
    edge, length = edge[length > RAIL_LEAST], length[length > RAIL_LEAST]
    bays = np.maximum(np.round(length / RAIL_BAY), 1).astype(np.int64)
    of = np.repeat(np.arange(len(edge)), bays)
    nth = numbered(bays)
    way = points[edge + 1] - points[edge]
    at = points[edge[of]] + ((nth + 0.5) / bays[of])[:, None] * way[of]
    part = rows[row[edge[of]]]
    z = (volumes.eave - reserve_of(volumes, city.layout.parts, city.seed))[part]
    free = np.ones(len(part), bool)
    if len(part):
        free = ~covered(volumes, part, at[:, 0], at[:, 1], np.full(len(part), 1.0), z)
    number = 1000 + np.arange(len(part)) - np.searchsorted(part, part)  # parts ascend
    parapet, railing = (PIECES.index(name) for name in ("deck_parapet", "roof_railing"))
    found = (
        part, np.where(deck[part], parapet, railing), *at.T, z, np.ones(len(part)),
        np.arctan2(way[of, 1], way[of, 0]), number, (length / bays / RAIL_BAY)[of],
    )  # fmt: skip
    return tuple(each[free] for each in found)


def _tables(city: City) -> dict[str, Mapping[str, float]]:
    """Weights of pieces by use group, and by generator where it has its own."""
    named = set(city.layout.buildings["generator"].to_numpy(str).tolist())
    own = {n: table for n in sorted(named) if n and (table := generator_named(n).rooftop)}
    worn = {
        name: {**table, **{word: share * sum(table.values()) for word, share in WEAR.items()}}
        for name, table in {**_WEIGHTS, **own}.items()
    }
    return {**worn, "house": _WEIGHTS["house"]}


def _kinds(city: City) -> NDArray[np.str_]:
    """Return the generator of the building of each part, (n,)."""
    owner, described = owner_rows(city.layout)
    if not len(city.layout.buildings):
        return np.full(len(city.layout.parts), "")
    return np.where(described, city.layout.buildings["generator"].to_numpy(str)[owner], "")


def _having_chimneys(city: City) -> FloatArray:
    """Return the share of houses like that of each part that have a chimney, (n,)."""
    known, index = np.unique(_kinds(city), return_inverse=True)
    share = [
        generator_named(name).chimneys if name else Generator.chimneys for name in known.tolist()
    ]
    return np.asarray(np.array(share, float)[index])


def _clear(
    part: NDArray[np.int64], number: NDArray[np.int64], x: FloatArray, y: FloatArray,
    reach: FloatArray, found: NDArray[np.bool_],
) -> NDArray[np.bool_]:  # fmt: skip
    """(k,) whether a piece keeps clear of those placed before it on the same roof."""
    clear = found.copy()
    for back in range(1, MOST):
        row = np.arange(back, len(part))
        other = row - back
        near = (part[row] == part[other]) & clear[row] & clear[other] & (number[row] >= back)
        gap = np.hypot(x[row] - x[other], y[row] - y[other])
        clear[row[near & (gap < reach[row] + reach[other] + 0.3)]] = False
    return clear


def _chimneys(
    city: City, volumes: Volumes, group: NDArray[np.int64], flat: NDArray[np.bool_],
    field: RoofField | None, walls: WallTable | None,
) -> tuple[Any, ...]:  # fmt: skip
    seed = city.seed
    parts = city.layout.parts
    ids = parts["id"].to_numpy(np.uint64)
    words = np.array(GROUPS)[group]
    shape = parts["roof_shape"].to_numpy(str)
    ridged = np.isin(
        shape, ["gabled", "hipped", "half-hipped", "gambrel", "mansard", "side_hipped", "saltbox",
                "side_half-hipped", "hipped-and-gabled", "crosspitched"]
    )  # fmt: skip
    rise = volumes.top - volumes.eave
    home = np.isin(words, ["house", "flats", "office", "civic"])
    area = np.where(volumes.usable, shapely.area(volumes.polygons), 0.0)
    rows = np.flatnonzero(~flat & ridged & home & volumes.walls & (rise > 0.8) & (area > 35))
    rows = rows[uniform(seed, "roof/chimney", ids[rows]) < _having_chimneys(city)[rows]]
    count = np.where(words[rows] == "house", 1, np.clip(np.round(area[rows] / 140), 1, 5)).astype(
        np.int64
    )
    part = np.repeat(rows, count)
    number = numbered(count)
    total = np.repeat(count, count)
    long_axis, short_axis, middle = _axes(volumes.polygons)
    draw = uniform(seed, "roof/chimney at", ids[part], number)
    hipped = np.isin(shape[part], ["hipped", "side_hipped", "half-hipped"])
    reach_along = np.where(hipped, 0.3, 0.78)
    along = ((number + 0.25 + 0.5 * draw) / total * 2 - 1) * reach_along
    side = np.where(uniform(seed, "roof/chimney side", ids[part], number) < 0.5, -1, 1)
    # Where the ridge runs across, long and short change places.
    across = parts["roof_across"].to_numpy(bool)[part]
    run = np.where(across[:, None], short_axis[part], long_axis[part])
    lean = np.where(across[:, None], long_axis[part], short_axis[part])
    at = middle[part] + along[:, None] * run + 0.12 * side[:, None] * lean
    yaw = np.arctan2(lean[:, 1], lean[:, 0])
    shared = np.zeros(len(part), bool)
    if field is not None and walls is not None:
        known, place, turn = _at_party_walls(volumes, walls, field)
        shared = known[part] & (number == 0)
        at = np.where(shared[:, None], place[part], at)
        yaw = np.where(shared, turn[part], yaw)
    large = uniform(seed, "roof/chimney kind", ids[part]) < np.where(
        words[part] == "house", 0.35, 0.75
    )
    piece = np.where(large, PIECES.index("chimney"), PIECES.index("chimney_small"))
    reach = np.array(list(REACH.values()))[piece]
    foot = volumes.eave[part] + 0.1 * rise[part]
    top = volumes.top[part] + CHIMNEY_TOP
    good = shared | _fits(volumes.polygons, part, at[:, 0], at[:, 1], reach + 0.2)
    if field is not None:
        # A stack far below the ridge need not rise above it.
        surface, slope = field.at(at, volumes.building[part])
        surface = np.where(np.isfinite(surface), surface, foot)
        sunk = reach * np.hypot(slope[:, 0], slope[:, 1]) + CHIMNEY_SUNK
        foot = np.maximum(foot, surface - sunk)
        top = np.minimum(top, surface + MAX_STACK)
        good &= top - surface > 0.5 * CHIMNEY_TOP
    height = top - foot
    if len(part):
        near = np.where(shared, PARTY_ROOM, reach)
        clear = volumes.top[part] + np.where(shared, 0.5 * CHIMNEY_TOP, 0.0)
        good &= ~covered(volumes, part, at[:, 0], at[:, 1], near, clear)
    return (
        part[good], piece[good], at[good, 0], at[good, 1], foot[good], (height / CHIMNEY)[good],
        yaw[good], 100 + number[good],
    )  # fmt: skip


def _at_party_walls(
    volumes: Volumes, walls: WallTable, field: RoofField
) -> tuple[NDArray[np.bool_], FloatArray, FloatArray]:
    """Find for each part where its ridge meets a wall that a neighbour as high covers.

    Returns
    -------
    known, place, yaw
        (n,) bool, (n, 2) metres, (n,) radians along the wall.
    """
    count = len(volumes.top)
    part = walls.part.astype(np.int64)
    pitched = (volumes.top - volumes.eave > 0.8)[part]
    rows = np.flatnonzero(pitched & (walls.blind_to > walls.z_high - 0.4) & (walls.length > 3.0))
    # The middle of the wall's whole edge is where the ridge of a gabled house lies.
    unit = (walls.end - walls.start)[rows] / walls.length[rows, None]
    middle = (walls.start + walls.end)[rows] / 2
    at = middle - walls.normal[rows] * PARTY_ROOM
    z, _ = field.at(at, volumes.building[part[rows]])
    ridge = volumes.top[part[rows]] - np.nan_to_num(z, nan=-np.inf) < NEAR_RIDGE
    rows, at, unit = rows[ridge], at[ridge], unit[ridge]
    # Of two such walls the western one carries the stack, for both houses.
    order = np.lexsort((at[:, 1].round(2), -at[:, 0].round(2)))
    known, place, yaw = np.zeros(count, bool), np.zeros((count, 2)), np.zeros(count)
    mine = part[rows[order]]
    known[mine] = True
    place[mine] = at[order]
    yaw[mine] = np.arctan2(unit[order, 1], unit[order, 0])
    return known, place, yaw
