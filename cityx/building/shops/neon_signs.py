"""Neon: glowing boards in the place of shop signs, blades above them, lines of light on towers."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Annotated

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.assets.shops.lettering import COLORS, GLYPH, neon
from cityx.city.city import City
from cityx.city.levels import ground_levels
from cityx.city.rows import join_rows, take_rows
from cityx.city.scene import Instances, Prototype
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.ids import choose, hash_ids, uniform
from cityx.protocol import Port, Range, Serves, action

ACTION = "building/neon_signs-v1"
LAYER = "neon"
SIGNS = "trims"  # layer of the signs of shops
BOARDS = ("sign_fascia", "sign_box", "sign_letters")
HALF_BOARD = 1.7  # metres from the middle of a board to its end
BEFORE, BOARD_HIGH = 0.4, 0.7  # metres from a wall to letters on a board, and its height
BLADE_SHARE = 0.4  # of the boards that have a blade at their end
BLADE_ABOVE, BLADE_TOP = 1.1, 5.2  # metres from a board to the foot and past the top of its blade
TALL = 40.0  # metres from which the edges of a building carry lines of light
OUT = 0.14  # metres from a wall to the middle of a line
SHORTEST = 2.0  # metres of edge that carry a line
FOOT = 5.0  # metres above the ground where upright lines begin, over the heads of people
CORNER = np.radians(25.0)  # by which a plan turns at a corner


@action(
    ACTION,
    limits=[
        "Boards take the place of signs of shops: a building without shops has none.",
        "Lines of light follow the plans of towers, not what stands out from their walls.",
    ],
    requires=("building",),
    takes=(Port("facades", "complex_geometry", "facades"),),
    gives=(Port("neon", "complex_geometry", "neon"),),
    labels=("neon", "light", "sign", "glow", "night", "advertising", "cyberpunk"),
    serves=(Serves("lights=neon"),),
)
def neon_signs(city: City, *, share: Annotated[float, Range(0.0, 1.0)] = 0.7) -> City:
    """Light shops and towers with neon.

    The signs of shops become boards of glowing tube, some with an upright blade, and the edges of
    towers are drawn in lines of light. They glow when the lamps of the streets do.

    Parameters
    ----------
    share
        Share of the shops and of the towers.
    """
    makers: list[Prototype] = []
    groups = [_boards(city, share, makers), _lines(city, share, makers)]
    rows = join_rows(groups)
    if not rows.count:
        why = f"no building has signs of shops or is {TALL:g} m high"
        return replace(city, notes=(*city.notes, f"Nothing is lit with neon: {why}."))
    order = np.argsort(rows.object_id, kind="stable")
    signs = city.scene.instances.get(SIGNS)
    scene = city.scene
    if signs is not None:
        gone = np.isin(signs.object_id, rows.object_id)
        kept = take_rows(signs, ~gone & ~_lettered(scene.prototypes, signs, gone))
        scene = scene.with_instances(SIGNS, scene.prototypes, kept)
    return replace(city, scene=scene.with_instances(LAYER, makers, take_rows(rows, order)))


def _row_makers(form: str, makers: list[Prototype], detail: int) -> Callable[[IntArray], IntArray]:
    """Return what turns colours into prototypes of a form, which it adds to `makers`."""
    first = len(makers)
    makers += [neon(form, color, detail=detail) for color in COLORS]
    return lambda color: np.asarray(first + color)


def _boards(city: City, share: float, makers: list[Prototype]) -> Instances:
    """Return boards in the place of signs, under their ids, and the blades at their ends."""
    board, blade = (_row_makers(form, makers, city.lod) for form in ("board", "blade"))
    scene = city.scene
    signs = scene.instances.get(SIGNS)
    named = [p.name.removesuffix("_fine") in BOARDS for p in scene.prototypes]
    if signs is None or not any(named):
        return join_rows([])
    wanted = np.array(named)[signs.prototype]
    wanted &= uniform(city.seed, f"{ACTION}/board", signs.object_id) < share
    boards = take_rows(signs, wanted)
    color = choose(city.seed, f"{ACTION}/color", boards.object_id, np.ones(len(COLORS)))
    white = np.ones((boards.count, 3), np.float32)
    boards = replace(boards, prototype=board(color).astype(np.int32), tint=white)
    tall = uniform(city.seed, f"{ACTION}/blade", boards.object_id) < BLADE_SHARE
    tall &= _tops(city, boards.owner) > boards.position[:, 2] + BLADE_TOP
    below = take_rows(boards, tall)
    along = np.column_stack([np.cos(below.rotation[:, 2]), np.sin(below.rotation[:, 2])])
    end = below.position.copy()
    end[:, :2] -= HALF_BOARD * below.scale[:, :1] * along
    end[:, 2] += BLADE_ABOVE
    blades = replace(
        below,
        prototype=blade(color[tall]).astype(np.int32),
        object_id=hash_ids(0, f"{ACTION}/blade", below.object_id),
        position=end,
        scale=np.ones_like(below.scale),
    )
    return join_rows([boards, blades])


def _lettered(
    prototypes: Sequence[Prototype], signs: Instances, boards: NDArray[np.bool_]
) -> NDArray[np.bool_]:
    """Return which rows are letters on some of the boards, (n,)."""
    letter = np.array([each.name.startswith(GLYPH) for each in prototypes])
    rows = np.flatnonzero(letter[signs.prototype])
    board = np.flatnonzero(boards)
    turn = signs.rotation[board, 2]
    half = HALF_BOARD * signs.scale[board, :1] * np.column_stack([np.cos(turn), np.sin(turn)])
    at = signs.position[board, :2]
    tree = shapely.STRtree(shapely.linestrings(np.stack([at - half, at + half], axis=1)))
    row, near = tree.query(shapely.points(signs.position[rows, :2]), "dwithin", BEFORE)
    level = signs.position[rows, 2][row] - signs.position[board, 2][near]
    found = np.zeros(signs.count, bool)
    found[rows[row[np.abs(level) < BOARD_HIGH]]] = True
    return found


def _tops(city: City, owner: NDArray[np.uint64]) -> FloatArray:
    """Return the heights above the datum at which walls of buildings end, (n,) metres."""
    parts = city.layout.parts
    level = ground_levels(city.layout, city.terrain)
    eave = level + parts["top"].to_numpy(float) - parts["roof_height"].to_numpy(float)
    # The lowest part counts: a blade must find a wall behind it.
    ids, row = np.unique(parts["building"].to_numpy(np.uint64), return_inverse=True)
    lowest = np.full(len(ids), np.inf)
    np.minimum.at(lowest, row, eave)
    if not len(ids):
        return np.full(len(owner), -np.inf)
    at = np.minimum(np.searchsorted(ids, owner), len(ids) - 1)
    return np.where(ids[at] == owner, lowest[at], -np.inf)


def _lines(city: City, share: float, makers: list[Prototype]) -> Instances:
    """Return lines of light along the eaves and up the corners of towers."""
    line = _row_makers("line", makers, city.lod)
    parts = city.layout.parts
    building = parts["building"].to_numpy(np.uint64)
    top = parts["top"].to_numpy(float) - parts["roof_height"].to_numpy(float)
    high = (top >= TALL) & parts["walls"].to_numpy(bool)
    high &= uniform(city.seed, f"{ACTION}/tower", building) < share
    rows = np.flatnonzero(high)
    level = ground_levels(city.layout, city.terrain)
    base = np.maximum(parts["base"].to_numpy(float), FOOT)
    start, step, of, number = _edges(parts.geometry.to_numpy()[rows])
    of = rows[of]
    eave = np.column_stack([start, (level + top)[of]])
    turned, corner = _corners(start, step, number)
    upright = np.column_stack([corner, (level + base)[of[turned]]])
    tall = (top - base)[of[turned]]
    position = np.vstack([eave, upright])
    length = np.concatenate([np.hypot(*step.T), tall])
    rotation = np.zeros((len(position), 3), np.float32)
    rotation[: len(eave), 2] = np.arctan2(step[:, 1], step[:, 0])
    rotation[len(eave) :, 1] = -np.pi / 2
    part = np.concatenate([of, of[turned]])
    kept = length > SHORTEST
    owner = building[part]
    color = choose(city.seed, f"{ACTION}/color", owner, np.ones(len(COLORS)))
    ids = parts["id"].to_numpy(np.uint64)[part]
    k = np.concatenate([2 * number, 2 * number[turned] + 1])
    return take_rows(
        Instances(
            line(color).astype(np.int32),
            hash_ids(0, f"{ACTION}/line", ids, k),
            owner,
            position,
            rotation,
            np.column_stack([length, np.ones((len(length), 2))]).astype(np.float32),
            np.ones((len(length), 3), np.float32),
        ),
        kept,
    )


def _edges(plans: NDArray[np.object_]) -> tuple[FloatArray, FloatArray, IntArray, IntArray]:
    """Return starts and steps of the outer edges of plans, pushed out; plan and number of each."""
    outer = shapely.get_exterior_ring(
        shapely.orient_polygons(shapely.buffer(plans, OUT, join_style="mitre"))
    )
    xy, of = shapely.get_coordinates(outer, return_index=True)
    same = of[1:] == of[:-1]
    number = np.arange(len(xy)) - np.searchsorted(of, of)
    return xy[:-1][same], np.diff(xy, axis=0)[same], of[:-1][same], number[:-1][same]


def _corners(start: FloatArray, step: FloatArray, number: IntArray) -> tuple[IntArray, FloatArray]:
    """Return the edges that begin at an outer corner of their ring, and those corners, (k, 2)."""
    first = np.flatnonzero(number == 0)
    last = np.concatenate([first[1:], [len(number)]]) - 1
    before = np.arange(len(number)) - 1
    before[first] = last
    cross = step[before, 0] * step[:, 1] - step[before, 1] * step[:, 0]
    dot = (step[before] * step).sum(axis=1)
    turned = np.flatnonzero(np.arctan2(cross, dot) > CORNER)
    return turned, start[turned]
