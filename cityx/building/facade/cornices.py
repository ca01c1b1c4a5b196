"""Cornices: mouldings swept round the walls of buildings, and the stones of their corners."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cityx.assets.trims.dormers import quoins
from cityx.building.catalogue import looks
from cityx.building.facade.placing import Placing
from cityx.building.roofs.roof_heights import THICKNESS, RoofField
from cityx.building.roofs.shapes import EAVED, as_shapes
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.ranges import numbered
from cityx.geometry.solids import Solids, join_solids
from cityx.geometry.sweeps import Profile, following_pieces, profile_of, sweep
from cityx.ids import uniform

if TYPE_CHECKING:
    from cityx.building.facade.facade_plan import Facade
    from cityx.city.city import City

BACK = -0.02  # metres that mouldings reach into the wall, so that none is seen through a joint
CORNICE = profile_of(
    [(BACK, -0.60), (0.06, -0.60), (0.06, -0.42), (0.12, -0.36), (0.12, -0.28), (0.30, -0.20),
     (0.30, -0.11), (0.38, -0.04), (0.38, 0.0), (BACK, 0.0)]
)  # fmt: skip
# Under the soffit of a roof that runs out over the wall.
BED = profile_of([(BACK, -0.17), (0.04, -0.17), (0.13, -0.06), (0.13, 0.0), (BACK, 0.0)])
BED_DEPTH = 0.13
# Lies over the parapet, which it covers.
COPING = profile_of([(-0.36, -0.03), (0.07, -0.10), (0.07, 0.05), (-0.36, 0.07)])
STRING = profile_of(
    [(BACK, -0.11), (0.05, -0.11), (0.06, -0.02), (0.13, 0.03), (0.13, 0.09), (BACK, 0.13)]
)
INSIDE = 0.08  # metres behind the wall at which the roof over it is looked up
GABLE = 0.3  # metres a roof rises above its eave over a gable
PARTY = 0.5  # metres of a wall that a neighbour covers before the two are wall to wall
STEEPEST_EAVE = 1.2  # rise over run; a moulding under a steeper eave would meet the windows
COURSE = 0.62  # metres, of two stones of a corner
CORNER_TURN = np.radians(8.0)  # a corner further from square gets no stones
LEAST_CORNER = 1.2  # metres of wall beside a corner with stones


def mouldings(placing: Placing, found: Facade, city: City, field: RoofField) -> Solids:
    """Sweep cornices, copings and string courses along their walls.

    Ends at neighbours are capped; gables have none.
    """
    walls, part = found.walls, found.walls.part.astype(np.int64)
    number = np.arange(walls.count)
    open_top = (walls.blind_to < walls.z_high - 0.4) & (walls.open_to > walls.z_high - 0.05)
    head = found.designs.head[part]
    # Yards are plain, but a house that stands free has its cornice all round.
    dressed = found.fronts.street | _detached(found)[part]
    flat = (found.volumes.top - found.volumes.eave < 0.15)[part]
    wanted = open_top & (walls.length > 0.05) & (walls.z_high - walls.z_low > 2.6)
    cornice = wanted & (head == "cornice") & dressed
    reserve = walls.z_high - found.storey_walls.z_high
    z = np.minimum(found.storey_walls.z_high + 0.35 * reserve + 0.1, walls.z_high)
    rows = number[cornice & flat]
    pieces = [_swept(CORNICE, placing, part, rows, z[rows])]
    coping = wanted & flat & np.isin(head, ["coping", "cornice"])
    pieces.append(_swept(COPING, placing, part, number[coping], walls.z_high[coping]))
    rows = number[cornice & ~flat]
    eaved = np.isin(as_shapes(city.layout.parts["roof_shape"].to_numpy()), list(EAVED))[part[rows]]
    gable, slope = _over_walls(placing, rows, walls.z_high[rows], field)
    under = ~gable & eaved & (slope < STEEPEST_EAVE)
    drop = THICKNESS + BED_DEPTH * slope
    at = rows[under]
    pieces.append(_swept(BED, placing, part, at, walls.z_high[at] - drop[under]))
    at = rows[~gable & ~eaved]
    pieces.append(_swept(CORNICE, placing, part, at, walls.z_high[at] - 0.02))
    level, clear = course_levels(found)
    rows = number[clear & found.designs.string[part]]
    pieces.append(_swept(STRING, placing, part, rows, level[rows] + 0.02))
    return join_solids(pieces)


def _swept(
    profile: Profile, placing: Placing, part: IntArray, wall: IntArray, z: FloatArray
) -> Solids:
    """Sweep a profile along the drawn faces of walls."""
    walls, faces = placing.walls, placing.faces
    row, begin, finish = faces.pieces(walls, wall)
    number = wall[row]
    unit, normal = placing.unit[number], walls.normal[number]
    ends = []
    for along, corner in ((begin, walls.start), (finish, walls.end)):
        out = faces.before(walls, number, along)
        at = walls.start[number] + unit * along[:, None] + normal * out[:, None]
        whole = (along == 0.0) | (along == walls.length[number])
        ends.append(np.where(whole[:, None], corner[number], at))
    return sweep(profile, ends[0], ends[1], np.asarray(z, float)[row], part[number])


def _detached(found: Facade) -> NDArray[np.bool_]:
    """(n,) whether no neighbour touches a part."""
    walls = found.walls
    party = walls.blind_to > walls.z_low + PARTY
    joined = np.zeros(len(found.volumes.top), bool)
    joined[walls.part[party]] = True
    return ~joined


def _over_walls(
    placing: Placing, rows: IntArray, eave: FloatArray, field: RoofField
) -> tuple[NDArray[np.bool_], FloatArray]:
    """Whether a gable stands over walls, and how steeply the roof rises from them."""
    walls = placing.walls
    unit, normal = placing.unit[rows], walls.normal[rows]
    share = np.array([0.2, 0.5, 0.8])
    at = walls.start[rows, None] + unit[:, None] * (walls.length[rows, None] * share)[:, :, None]
    at = at - INSIDE * normal[:, None]
    owner = np.repeat(placing.building[rows], len(share))
    z, slope = field.at(at.reshape(-1, 2), owner)
    over = np.nan_to_num(z.reshape(-1, len(share)) - eave[:, None], nan=0.0)
    middle = slope.reshape(-1, len(share), 2)[:, 1]
    inward = -(middle * normal).sum(axis=1)
    return (over > GABLE).any(axis=1), np.clip(inward, 0.0, 10.0)


def course_levels(found: Facade) -> tuple[FloatArray, NDArray[np.bool_]]:
    """Height of the first upper floor of each wall, and whether a band may run there; (w,)."""
    walls, fronts, storeys = found.walls, found.fronts, found.storeys
    first = np.minimum(storeys.first + 1, storeys.count)
    level = storeys.floor_of(np.arange(walls.count), first)
    clear = (walls.blind_to < level - 0.2) & fronts.grounded & (storeys.count > 1)
    clear &= (level < found.storey_walls.z_high - 1.5) & fronts.street & (walls.length > 1.0)
    return level, np.asarray(clear & (level - fronts.foot > 2.2))


def corner_stones(placing: Placing, found: Facade, seed: int) -> None:
    """Stack dressed stones, long and short in turn, up the free outer corners of buildings."""
    walls, part = found.walls, found.walls.part.astype(np.int64)
    styles = np.unique(found.designs.style).tolist()
    shares = {name: looks()[name].facade.quoins for name in styles}
    share = np.array([shares[name] for name in found.designs.style.tolist()])
    having = uniform(seed, "facade/quoins", found.volumes.building) < share
    if not having.any():
        return
    after = following_pieces(walls.start, walls.end, np.zeros(walls.count), part)
    before = np.flatnonzero(having[part] & (after >= 0))
    wall = after[before]
    turn = np.arctan2(
        walls.normal[before, 0] * walls.normal[wall, 1]
        - walls.normal[before, 1] * walls.normal[wall, 0],
        (walls.normal[before] * walls.normal[wall]).sum(axis=1),
    )
    foot = np.maximum.reduce([
        found.fronts.foot[before], found.fronts.foot[wall], walls.z_low[wall],
        *(np.where(walls.blind_to[at] > walls.z_low[at] + 0.05, walls.blind_to[at], -np.inf)
          for at in (before, wall)),
    ])  # fmt: skip
    head = np.minimum(found.storey_walls.z_high[before], found.storey_walls.z_high[wall]) - 0.25
    head = np.minimum(head, np.minimum(walls.open_to[before], walls.open_to[wall]))
    fit = (np.abs(turn - np.pi / 2) < CORNER_TURN) & (head - foot > 2 * COURSE)
    fit &= np.minimum(walls.length[before], walls.length[wall]) > LEAST_CORNER
    wall, foot, tall = wall[fit], foot[fit], (head - foot)[fit]
    count = np.maximum(1, np.round(tall / COURSE)).astype(np.int64)
    row = np.repeat(np.arange(len(wall)), count)
    step = numbered(count)
    pitch = (tall / np.maximum(count, 1))[row]
    placing.add(
        "quoins", partial(quoins), wall[row], np.zeros(len(row)), foot[row] + step * pitch,
        scale=(1.0, 1.0, pitch / COURSE), tint=found.finishes.trim_tint[part[wall[row]]],
        index=step, reach=0.1,
    )  # fmt: skip
