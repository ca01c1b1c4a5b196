"""Dressing: what is put on walls around the openings."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cityx.assets.fixtures import fixture
from cityx.assets.openings.doors import DOORS
from cityx.assets.openings.frames import FINE
from cityx.assets.trims.balconies import BALCONY_WIDTH
from cityx.assets.trims.surrounds import SURROUND_HEIGHT, SURROUND_WIDTH
from cityx.assets.trims.trims import trim
from cityx.building.facade import grammar as facades
from cityx.building.facade.cornices import course_levels
from cityx.building.facade.grammar import Openings, bays_of
from cityx.building.facade.placing import Facing, Placing
from cityx.building.facade.walls import WallTable
from cityx.building.shops.shops import shops
from cityx.building.shops.signs import signs
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.ranges import numbered, row_codes
from cityx.ids import choose, uniform

if TYPE_CHECKING:
    from cityx.building.facade.facade_plan import Facade
    from cityx.building.facade.niches import Setting
    from cityx.city.city import City

PORTALS = {
    "door_panel": "portal_panel", "door_double": "portal_double", "door_house": "portal_house",
    "door_portal": "portal_church",
}  # fmt: skip
# What stands on balconies, with shares; the last is nothing.
THINGS = ("balcony_chairs", "balcony_pots", "balcony_bicycle")
THING_SHARES = (0.22, 0.24, 0.08, 0.46)
FURNISHED = 1.7  # metres of width of a balcony that holds them
# How far a fascia stands out, so that its ends meet round corners.
HEAD_DEPTH = 0.15
JOINT = 0.01  # metres by which the pieces of a band overlap where its wall bends
SKIN = 0.012  # metres; a faced ground floor stands out less than the panes of its windows
BLOCK = 3.6  # metres of dressed stone in one piece
FOOTING = 0.35  # metres; walls that show so much below their lowest floor get a base of stone
FOOTING_TOP = 0.4  # metres above that floor, below all sills
FOOTING_SHADE = 0.65  # of the trim's colour; feet of walls are dark


def opening_ids(placing: Placing, openings: Openings) -> NDArray[np.uint64]:
    """Stable ids of openings: building, wall, storey, bay and role."""
    cell = (openings.floor * 4096 + openings.bay + 2048) * 16 + openings.role
    return placing.ids("facade/opening", openings.wall, cell)


def dress(placing: Placing, found: Facade, city: City, setting: Setting) -> None:
    """Place surrounds, portals, balconies, bands, cornices, shopfronts, signs and fittings."""
    _surrounds(placing, found)
    _portals(placing, found)
    _balconies(placing, found, city.seed)
    _coolers(placing, found, city.seed)
    tenants = shops(placing, found, city, setting)
    if tenants.table.count:
        signs(placing, found, city, tenants)
    _bands(placing, found, city.seed)


def _by_name(
    placing: Placing,
    names: NDArray[np.str_],
    wall: IntArray,
    along: FloatArray,
    z: FloatArray,
    scale: tuple[FloatArray, FloatArray, FloatArray],
    tint: NDArray[np.float32],
    index: IntArray,
    reach: FloatArray,
) -> None:
    for name in np.unique(names).tolist():
        of = np.flatnonzero(names == name)
        if name:
            placing.add(
                name, partial(trim, name), wall[of], along[of], z[of],
                scale=(scale[0][of], scale[1][of], scale[2][of]), tint=tint[of], index=index[of],
                reach=reach[of],
            )  # fmt: skip


def _cell(table: Openings) -> IntArray:
    return np.asarray((table.floor * 4096 + table.bay + 2048) * 16 + table.role)


def _surrounds(placing: Placing, found: Facade) -> None:
    """Sills, lintels, architraves and pediments of windows."""
    roles = (facades.WINDOW, facades.BACK, facades.GROUND)
    table = found.openings.take(np.isin(found.openings.role, roles))
    part = found.walls.part[table.wall]
    street = found.fronts.street[table.wall]
    rich = found.designs.surround[part]
    # Pediments belong to the main floors, the others have flat frames.
    upper = table.floor >= 3
    rich = np.where((rich == "surround_pediment") & (upper | (table.floor % 2 == 0)),
                    "surround_cap", rich)  # fmt: skip
    ground = table.role == facades.GROUND
    rich = np.where(np.isin(rich, ["surround_cap", "surround_pediment"]) & (upper | ground),
                    "surround_flat", rich)  # fmt: skip
    names = np.where(street, rich, found.designs.back[part])
    one = np.ones(table.count)
    _by_name(
        placing, names, table.wall, table.along, table.low,
        (table.width / SURROUND_WIDTH, one, table.height / SURROUND_HEIGHT),
        found.finishes.trim_tint[part], _cell(table), table.width / 2,
    )  # fmt: skip


def _portals(placing: Placing, found: Facade) -> None:
    table = found.openings.take(found.openings.role == facades.DOOR)
    part = found.walls.part[table.wall]
    for name, portal in PORTALS.items():
        of = np.flatnonzero(found.designs.door[part] == name)
        _, width, height = DOORS[name]
        placing.add(
            portal, partial(trim, portal), table.wall[of], table.along[of], table.low[of],
            scale=(table.width[of] / width, 1.0, table.height[of] / height),
            tint=found.finishes.trim_tint[part[of]], index=_cell(table)[of],
            reach=table.width[of] / 2,
        )  # fmt: skip


def _balconies(placing: Placing, found: Facade, seed: int) -> None:
    table = found.openings.take(found.openings.role == facades.FRENCH)
    part = found.walls.part[table.wall]
    bay = bays_of(found.storey_walls, found.fronts)[2][table.wall]
    name = found.designs.railing[part]
    width = np.where(
        name == "balcony_rail", table.width + 0.1, np.clip(0.92 * bay, table.width + 0.2, 3.4)
    )
    # A balcony ends before the end of its wall.
    reach = np.minimum(table.along, found.walls.length[table.wall] - table.along) - 0.12
    width = np.minimum(width, 2 * reach)
    one = np.ones(table.count)
    _by_name(
        placing, name, table.wall, table.along, table.low - 0.04,
        (width / BALCONY_WIDTH, one, one), found.finishes.trim_tint[part], _cell(table),
        table.width / 2,
    )  # fmt: skip
    # On those that one can sit on stand chairs, pots or a bicycle.
    roomy = ~np.isin(name, ["", "balcony_rail", "balcony_iron"]) & (width > FURNISHED)
    thing = choose(seed, "facade/balcony thing", opening_ids(placing, table), THING_SHARES)
    for number, word in enumerate(THINGS):
        of = np.flatnonzero(roomy & (thing == number))
        placing.add(
            word, partial(fixture, word), table.wall[of], table.along[of], table.low[of] - 0.03,
            index=_cell(table)[of], reach=table.width[of] / 2,
        )  # fmt: skip


def _coolers(placing: Placing, found: Facade, seed: int) -> None:
    """Outdoor units under windows."""
    table = found.openings.take(np.isin(found.openings.role, (facades.WINDOW, facades.BACK)))
    part = found.walls.part[table.wall]
    ids = opening_ids(placing, table)
    wanted = uniform(seed, "facade/cooler", ids) < found.designs.cooling[part]
    wanted &= (table.floor >= 1) & (table.width > 0.9)
    of = np.flatnonzero(wanted)
    placing.add(
        "air_conditioner", partial(trim, "air_conditioner"), table.wall[of], table.along[of],
        table.low[of] - 0.80, index=_cell(table)[of],
    )  # fmt: skip


def _bands(placing: Placing, found: Facade, seed: int) -> None:
    """Fascias, faced ground floors and rain pipes."""
    walls, part = found.walls, found.walls.part.astype(np.int64)
    fronts = found.fronts
    trims = found.finishes.trim_tint
    number = np.arange(walls.count)
    open_top = (walls.blind_to < walls.z_high - 0.4) & (walls.open_to > walls.z_high - 0.05)
    before, after = corner_reach(walls)
    # Fascias of flat roofs; cornices and copings are swept (`cityx.building.facade.cornices`).
    height = walls.z_high - walls.z_low
    wanted = open_top & (walls.length > 0.4) & (height > 2.6) & _flat_roofs(found)[part]
    of = number[wanted & (found.designs.head[part] == "eaves_board")]
    band(placing, "eaves_board", of, walls.z_high[of], trims[part[of]],
         HEAD_DEPTH * before[of], HEAD_DEPTH * after[of])  # fmt: skip
    level, clear = course_levels(found)
    _faced(placing, found, clear, level)
    pipe = found.designs.pipe[part] & (walls.edge_from < 0.01) & (walls.length > 3.2)
    pipe &= (walls.blind_to <= walls.z_low + 0.05) & fronts.grounded & open_top
    of = number[pipe]
    placing.add(
        "downpipe", partial(trim, "downpipe"), of, np.full(len(of), 0.1), walls.z_low[of] - 0.1,
        scale=(1.0, 1.0, found.storey_walls.z_high[of] - walls.z_low[of] + 0.1),
    )  # fmt: skip
    del seed


def band(
    placing: Placing,
    name: str,
    wall: IntArray,
    z: FloatArray,
    tint: NDArray[np.float32],
    start: FloatArray,
    end: FloatArray,
    *,
    depth: float = 1.0,
    height: FloatArray | float = 1.0,
    index: IntArray | int = 0,
) -> None:
    """Run a band along whole walls, following their faces, `start` and `end` metres beyond."""
    walls = placing.walls
    row, begin, finish = placing.faces.pieces(walls, wall)
    at_end = np.ones(len(row), bool)
    at_end[:-1] = row[1:] != row[:-1]
    reach = (finish - begin) / 2
    middle = (begin + finish) / 2
    begin = begin - np.where(begin == 0, start[row], JOINT)
    finish = finish + np.where(at_end, end[row], JOINT)
    tall = np.broadcast_to(np.asarray(height, float), (len(wall),))[row]
    number = np.broadcast_to(np.asarray(index), (len(wall),))[row] * 1_000_000
    placing.add(
        name, partial(trim, name), wall[row], (begin + finish) / 2, z[row],
        scale=(finish - begin, depth, tall), tint=np.asarray(tint)[row],
        index=number + np.rint(1000 * middle).astype(np.int64), reach=reach,
    )  # fmt: skip


def _flat_roofs(found: Facade) -> NDArray[np.bool_]:
    """(n,) whether the eave of a part is its top."""
    return np.asarray(found.volumes.top - found.volumes.eave < 0.15)


def footings(found: Facade) -> tuple[NDArray[np.bool_], FloatArray, FloatArray]:
    """Find the walls at streets that falling ground lays open below their lowest floor.

    Returns
    -------
    footed, low, high
        (w,) whether a wall is one, and the heights between which it takes a base of stone.
    """
    walls, fronts, storeys = found.walls, found.fronts, found.storeys
    floor = storeys.floor_of(np.arange(walls.count), storeys.first)
    ground, high = fronts.pavement.min(axis=1), floor + FOOTING_TOP
    footed = fronts.grounded & fronts.street & (walls.length > 1.2) & (storeys.count > 0)
    footed &= (floor - ground > FOOTING) & (high < walls.z_high)
    footed &= walls.blind_to < walls.z_low + FOOTING
    return footed, ground - 0.15, high


def _faced(placing: Placing, found: Facade, wanted: NDArray[np.bool_], level: FloatArray) -> None:
    """Face ground floors with dressed stone or smooth paint, and feet of walls on slopes."""
    walls, part = found.walls, found.walls.part.astype(np.int64)
    base = found.designs.base[part]
    wall_tint = found.finishes.wall_tint
    footed, foot, top = footings(found)
    dressed = wanted & (base == "stone") & (walls.length > 1.2)
    footed &= ~dressed & ~(wanted & (base == "paint"))
    low = np.where(footed, foot, walls.z_low - 0.15)
    level = np.where(footed, top, level)
    shade = np.where(footed, FOOTING_SHADE, 0.9)[:, None]
    stone = np.flatnonzero(dressed | footed)
    paint = np.flatnonzero(wanted & (base == "paint"))
    pale = np.isin(found.designs.style[part[paint]], ["georgian_terrace", "walk_up"])
    tint = np.where(
        pale[:, None], found.finishes.trim_tint[part[paint]], 0.72 * wall_tint[part[paint]]
    )
    if placing.detail >= FINE:  # a facing without holes would close the niches behind it
        before, after = corner_reach(walls)
        for material, rows, color in (
            ("stone", stone, shade[stone] * found.finishes.trim_tint[part[stone]]),
            ("door_paint", paint, tint),
        ):
            placing.facings.append(
                Facing(material, rows, low[rows], level[rows], np.asarray(color, np.float32),
                       before[rows], after[rows])
            )  # fmt: skip
        return
    of_wall, begin, finish = placing.faces.pieces(walls, stone)
    count = np.maximum(1, np.round((finish - begin) / BLOCK)).astype(np.int64)
    of_piece = np.repeat(np.arange(len(begin)), count)
    number = numbered(count)
    row = stone[of_wall[of_piece]]
    length = ((finish - begin) / count)[of_piece]
    along = begin[of_piece] + (number + 0.5) * length
    high = level[row] - low[row]
    placing.add(
        "band_stone", partial(trim, "band_stone"), row, along, low[row],
        scale=(length / BLOCK, 1.0, high / BLOCK),
        tint=shade[row] * found.finishes.trim_tint[part[row]],
        index=np.rint(1000 * along).astype(np.int64), reach=length / 2,
    )  # fmt: skip
    none = np.zeros(len(paint))
    band(placing, "band_paint", paint, low[paint], tint, none, none, depth=SKIN,
          height=level[paint] - low[paint])  # fmt: skip


def following_walls(walls: WallTable) -> tuple[IntArray, NDArray[np.bool_]]:
    """Wall that begins where a wall of the same part ends.

    Returns
    -------
    following, joined
        (w,) row of the next wall, any where there is none, and (w,) whether there is one.
    """
    place = np.rint(np.stack([walls.start, walls.end], axis=1) * 1000).astype(np.int64)  # (w, 2, 2)
    part = np.repeat(walls.part.astype(np.int64)[:, None], 2, axis=1)
    key = np.stack([part, place[..., 0], place[..., 1]], axis=-1).reshape(-1, 3)
    code = row_codes(key)
    start_code, end_code = code.reshape(-1, 2).T
    order = np.argsort(start_code, kind="stable")
    at = np.minimum(np.searchsorted(start_code[order], end_code), max(walls.count - 1, 0))
    following = order[at] if walls.count else np.zeros(0, np.int64)
    return following, start_code[following] == end_code


def corner_reach(walls: WallTable) -> tuple[FloatArray, FloatArray]:
    """How far things that stand out must run past the start and the end of a wall.

    Returns
    -------
    before, after
        (w,) as a share of how far they stand out: 1 at an outer corner, 0 where the wall goes on
        straight, at an inner corner, and where a neighbour's wall begins.
    """
    following, joined = following_walls(walls)
    turn = (
        walls.normal[:, 0] * walls.normal[following, 1]
        - walls.normal[:, 1] * walls.normal[following, 0]
    )
    meets = joined & (turn > 0.05)
    free = walls.blind_to < walls.z_high - 0.4
    # The mitre of an outer corner; sharp ones are cut off.
    cosine = (walls.normal * walls.normal[following]).sum(axis=1)
    mitre = np.sqrt(np.clip((1 - cosine) / np.maximum(1 + cosine, 0.2), 0.0, 1.5))
    after = np.where(meets & free[following], mitre, 0.0)
    before = np.zeros(walls.count)
    before[following[meets]] = np.where(free, mitre, 0.0)[meets]
    return before, after
