"""Placement in mode `fit`: assets on lots without overlap, overshoot or repetition.

Steps: the rectangle to fill, its front towards the street; candidates near in size from a tree over
(log front, log depth); their costs; a choice in which no asset stands near itself; and the check of
true outlines against the lot, the neighbours and what else is in the way. What fails takes its next
candidate; a lot that runs out of them is left to the procedural generator, with the reason.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.assets.library.choice import NONE, Chooser, neighbours_of
from cityx.assets.library.records import Catalogue
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.rectangles import inner_rectangles, rectangles_of
from cityx.ids import hash_ids

BAND = (0.85, 1.18)  # of the scale: beyond it doors and storeys look wrong beside a neighbour's
STOREY = (2.5, 6.0)  # metres a storey may be high after scaling
FILL = 0.75  # area of a lot in its rectangle; below it, a box-shaped asset is the wrong shape
INNER = 0.86  # least share of a lot that a rectangle within it covers, to be built on that alone
TOLERANCE = 0.3  # metres an asset may stand out of its lot: drawing accuracy of maps
SHRINK = (1.0, 0.96, 0.93, 0.9)  # tried in turn where an outline does not fit
TOUCH = 1e-6  # square metres; neighbours that share a wall overlap by rounding alone
REPEAT = 100.0  # metres about an asset in which it is not placed again, where there is a choice
CANDIDATES = 32
# Weights of the costs, in units of |ln scale|: a quarter off in size is about 0.22.
ASPECT_COST = 2.0
HEIGHT_COST = 1.0
PARTY_COST, GAP_COST = 0.5, 0.15  # per side: windows on a party wall; a blind wall on a free side
STYLE_COST = 10.0  # more than all others: another style only where none of the asked one fits
TEXT_COST = 0.3
HEIGHT_BAND = 1.45  # a building of a known height is not replaced by one further off than this
HEIGHT_AXIS = 0.5  # of ln height in the tree, beside ln front and ln depth
# Uses that may stand for each other, and what that costs; others never do.
KIN: Mapping[frozenset[str], float] = MappingProxyType(
    {
        frozenset({"flats", "office"}): 0.2,
        frozenset({"office", "retail"}): 0.25,
        frozenset({"flats", "retail"}): 0.3,
        frozenset({"office", "civic"}): 0.25,
        frozenset({"house", "flats"}): 0.3,
        frozenset({"industry", "retail"}): 0.35,
        frozenset({"shed", "house"}): 0.6,
    }
)
REASONS = (
    "placed",
    "the outline is not rectangular enough",
    "no asset of its use is near in size",
    "no asset keeps storeys between 2.5 and 6 m",
    "every candidate overlaps something",
    "every candidate stands nearby already",
)
PLACED, SHAPE, SIZE, STOREYS, OVERLAP, REPEATED = range(len(REASONS))


@dataclass(frozen=True)
class Lots:
    """n lots to build on.

    Attributes
    ----------
    id
        (n,) uint64; draws and precedence follow from it, not from the order.
    polygon
        (n,) outlines, metres.
    street
        (n,) direction towards the street, radians counter-clockwise from x, NaN where there is
        none.
    use
        (n,) use group, "" for any.
    height
        (n,) metres, NaN for any.
    party
        (n,) sides where a neighbour stands, seen from the street: 1 left, 2 right, 4 back.
    """

    id: NDArray[np.uint64]
    polygon: NDArray[Any]
    street: FloatArray
    use: NDArray[np.str_]
    height: FloatArray
    party: IntArray

    def __len__(self) -> int:
        """Return the number of lots."""
        return len(self.id)


@dataclass(frozen=True)
class Assets:
    """What placement needs of m assets.

    Attributes
    ----------
    front, depth
        (m,) sides of the smallest rectangle: along the front, and across it.
    centre
        (m, 2) middle of that rectangle in the asset's own frame.
    facing
        (m,) direction the front faces, radians counter-clockwise from x, square to the rectangle.
    outline
        (m,) true footprints in the assets' own frames.
    height, storey
        (m,) metres; storey NaN for things without.
    use, style
        (m,) words.
    party
        (m,) blind sides.
    score
        (m,) agreement with the description asked for, -1 to 1, zeros for none.
    """

    front: FloatArray
    depth: FloatArray
    centre: FloatArray
    facing: FloatArray
    outline: NDArray[Any]
    height: FloatArray
    storey: FloatArray
    use: NDArray[np.str_]
    style: NDArray[np.str_]
    party: IntArray
    score: FloatArray

    def __len__(self) -> int:
        """Return the number of assets."""
        return len(self.front)


@dataclass(frozen=True)
class Placement:
    """What stands on n lots.

    Attributes
    ----------
    asset
        (n,) row of the asset, -1 where there is none.
    scale, theta
        (n,) factor, and turn about z, counter-clockwise; NaN where there is none.
    offset
        (n, 2) shift after scaling and turning about the asset's origin, metres.
    reason
        (n,) index into `REASONS`.
    outline
        (n,) placed footprints, None where there is none.
    """

    asset: IntArray
    scale: FloatArray
    theta: FloatArray
    offset: FloatArray
    reason: IntArray
    outline: NDArray[Any]

    def counts(self) -> dict[str, int]:
        """Count lots by reason."""
        found = np.bincount(self.reason, minlength=len(REASONS)).tolist()
        return {text: number for text, number in zip(REASONS, found, strict=True) if number}


@dataclass(frozen=True)
class Targets:
    """The rectangle to fill on each of n lots.

    Attributes
    ----------
    centre
        (n, 2) metres.
    front, depth
        (n,) sides along the street and across it, metres; 0 where the lot is of no use.
    facing
        (n,) direction its front faces, radians counter-clockwise from x.
    """

    centre: FloatArray
    front: FloatArray
    depth: FloatArray
    facing: FloatArray


def targets_of(lots: Lots) -> Targets:
    """Find the rectangle to fill on each lot and its side towards the street."""
    box = rectangles_of(lots.polygon)
    fill = shapely.area(lots.polygon) / np.maximum(box.length * box.width, 1e-9)
    usable = np.isfinite(box.length) & (box.width > 0.1) & (fill >= FILL)
    centre = np.nan_to_num(box.centre)
    size = np.nan_to_num(np.column_stack([box.length, box.width]))
    angle = np.nan_to_num(box.angle)
    axis = np.column_stack([np.cos(angle), np.sin(angle)])
    bent = np.flatnonzero(usable & (fill < 0.985))
    if len(bent):
        middle, inner = inner_rectangles(lots.polygon[bent], centre[bent], axis[bent], size[bent])
        share = inner.prod(axis=1) / shapely.area(lots.polygon[bent])
        whole = fill[bent] > 0.94  # so little is missing that the full rectangle is tried
        small = (share < INNER) & ~whole
        usable[bent[small]] = False
        cut = ~small & ~whole
        centre[bent[cut]], size[bent[cut]] = middle[cut], inner[cut]
    # The side that faces the street most squarely; without one, a long side.
    to_street = np.where(np.isfinite(lots.street), lots.street, angle - np.pi / 2)
    turn = np.rint((to_street - angle) / (np.pi / 2)).astype(np.int64)
    facing = angle + turn * np.pi / 2
    along = turn % 2 == 0  # the front faces along the long side, so the short side is the front
    front = np.where(along, size[:, 1], size[:, 0])
    depth = np.where(along, size[:, 0], size[:, 1])
    return Targets(
        centre, np.where(usable, front, 0.0), np.where(usable, depth, 0.0), facing % (2 * np.pi)
    )


def place(
    lots: Lots,
    assets: Assets,
    *,
    seed: int = 0,
    style: str = "",
    obstacles: NDArray[Any] | None = None,
    candidates: int = CANDIDATES,
    repeat: float = REPEAT,
) -> Placement:
    """Place assets on lots.

    Parameters
    ----------
    lots, assets
        What to build on, and with what.
    seed
        Key of draws among equals.
    style
        Style family asked for: assets tagged with another are used only where none of it fits.
    obstacles
        Polygons on which no asset may stand further than its lot does: carriageways.
    candidates
        Assets considered for each lot.
    repeat
        Metres about an asset in which it is not placed again, where there is a choice.
    """
    count = len(lots)
    target = targets_of(lots)
    reason = np.where(target.front > 0, SIZE, SHAPE)
    if not count or not len(assets):
        return _nothing(count, reason)
    rows, cost, why = _candidates(lots, assets, target, seed, style, candidates)
    reason = np.where((reason == SIZE) & (why == STOREYS), STOREYS, reason)
    fitting = _Fitting(lots, assets, target, obstacles)
    rank = np.argsort(np.argsort(hash_ids(seed, "placement", lots.id), kind="stable"))
    near, close = neighbours_of(target.centre, repeat)
    chooser = Chooser(rows, cost, rank, near, close)
    chosen = np.full(count, NONE, np.int64)
    scale = np.full(count, np.nan)
    outline = np.full(count, None, object)
    blocked = np.zeros(count, bool)
    for _ in range(candidates):
        asset = chooser.choose()
        fresh = np.flatnonzero((asset >= 0) & (asset != chosen))
        gone = asset < 0
        chosen[gone], outline[gone] = NONE, None
        if not len(fresh):
            break
        chosen[fresh] = asset[fresh]
        scale[fresh], outline[fresh] = fitting.outlines(fresh, asset[fresh])
        bad = fresh[np.isnan(scale[fresh])]
        loser = fitting.losers(outline, chosen, rank, fresh)
        blocked[bad] = blocked[loser] = True
        failed = np.union1d(bad, loser)
        chooser.refuse(failed, chosen[failed])
        chosen[failed], outline[failed] = NONE, None
    # Whatever is still in dispute is left out: nothing overlaps in the end.
    loser = fitting.losers(outline, chosen, rank, np.arange(count))
    blocked[loser] = True
    chosen[loser] = NONE
    placed = chosen >= 0
    outline[~placed] = None
    reason = np.where(
        placed,
        PLACED,
        np.where(blocked, OVERLAP, np.where(chooser.repeated & (reason == SIZE), REPEATED, reason)),
    )
    theta, offset = _transform(assets, target, chosen, scale)
    return Placement(
        chosen, np.where(placed, scale, np.nan), theta, offset, reason.astype(np.int64), outline
    )


def _nothing(count: int, reason: IntArray) -> Placement:
    none = np.full(count, np.nan)
    return Placement(
        np.full(count, NONE, np.int64), none, none, np.full((count, 2), np.nan),
        reason.astype(np.int64), np.full(count, None, object),
    )  # fmt: skip


def _transform(
    assets: Assets, target: Targets, chosen: IntArray, scale: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return turn and shift that bring the asset's rectangle to the middle of the target."""
    of = np.maximum(chosen, 0)
    theta = (target.facing - assets.facing[of]) % (2 * np.pi)
    cos, sin = np.cos(theta), np.sin(theta)
    x, y = assets.centre[of].T
    turned = np.column_stack([cos * x - sin * y, sin * x + cos * y])
    offset = target.centre - scale[:, None] * turned
    lost = chosen < 0
    theta, offset = np.where(lost, np.nan, theta), offset.copy()
    offset[lost] = np.nan
    return theta, offset


def _candidates(
    lots: Lots, assets: Assets, target: Targets, seed: int, style: str, count: int
) -> tuple[IntArray, FloatArray, IntArray]:
    """Return (n, k) assets by rising cost, their costs (inf for none), and (n,) why none is left.

    Lots of one use look for assets in a tree of their own. With a style, half of the candidates
    come from a tree of that style.
    """
    from scipy.spatial import cKDTree

    size = len(lots)
    rows = np.full((size, 2 * count), NONE, np.int64)
    tagged = assets.style == style if style else np.ones(len(assets), bool)
    place = np.column_stack(
        [np.log(np.maximum(assets.front, 1e-3)), np.log(np.maximum(assets.depth, 1e-3)),
         HEIGHT_AXIS * np.log(np.maximum(assets.height, 0.1))]
    )  # fmt: skip
    asked = np.column_stack(
        [np.log(np.maximum(target.front, 1e-3)), np.log(np.maximum(target.depth, 1e-3)),
         HEIGHT_AXIS * np.log(np.maximum(np.nan_to_num(lots.height, nan=1.0), 0.1))]
    )  # fmt: skip
    tall = np.isfinite(lots.height)
    for use in np.unique(lots.use).tolist():
        fit = (assets.use == use) | (_kin(assets.use, use) < np.inf) if use else np.ones(
            len(assets), bool)  # fmt: skip
        for axes, of in ((3, tall), (2, ~tall)):
            lot = np.flatnonzero((lots.use == use) & of & (target.front > 0))
            for column, pool in ((0, fit & tagged), (count, fit & ~tagged)):
                pool_rows = np.flatnonzero(pool)
                if not len(lot) or not len(pool_rows):
                    continue
                found = min(count, len(pool_rows))
                tree = cKDTree(place[pool_rows, :axes])
                _, at = tree.query(asked[lot, :axes], k=found)
                rows[lot, column : column + found] = pool_rows[at.reshape(len(lot), found)]
    cost, why = _costs(lots, assets, target, rows, tagged)
    order = np.argsort(cost + 1e-9 * _draw(seed, lots, rows), axis=1, kind="stable")[:, :count]
    return np.take_along_axis(rows, order, 1), np.take_along_axis(cost, order, 1), why


def _draw(seed: int, lots: Lots, rows: IntArray) -> FloatArray:
    bits = hash_ids(seed, "placement/equal", lots.id[:, None], rows.astype(np.uint64))
    return np.asarray(bits >> np.uint64(11)) / float(1 << 53)


def _kin(uses: NDArray[np.str_], use: str) -> FloatArray:
    """Return the cost of each use standing for another, inf where it never does."""
    table = {word: 0.0 if word == use else KIN.get(frozenset({word, use}), np.inf)
             for word in np.unique(uses).tolist()}  # fmt: skip
    known, index = np.unique(uses, return_inverse=True)
    return np.array([table[word] for word in known.tolist()])[index]


def _costs(
    lots: Lots, assets: Assets, target: Targets, rows: IntArray, tagged: NDArray[np.bool_]
) -> tuple[FloatArray, IntArray]:
    of = np.maximum(rows, 0)
    with np.errstate(divide="ignore", invalid="ignore"):
        wide = np.log(target.front[:, None] / assets.front[of])
        deep = np.log(target.depth[:, None] / assets.depth[of])
        scale = np.exp(np.minimum(wide, deep))
        cost = ASPECT_COST * np.abs(wide - deep) + np.abs(np.minimum(wide, deep))
        height = np.abs(np.log(assets.height[of] * scale / lots.height[:, None]))
    cost += HEIGHT_COST * np.nan_to_num(height)
    party, blind = lots.party[:, None], assets.party[of]
    open_on_neighbour, blind_on_street = party & ~blind, blind & ~party
    for bit in (1, 2, 4):
        cost += PARTY_COST * ((open_on_neighbour & bit) > 0)
        cost += GAP_COST * ((blind_on_street & bit) > 0)
    cost += STYLE_COST * ~tagged[of]
    cost -= TEXT_COST * assets.score[of]
    for use in np.unique(lots.use).tolist():
        if use:
            lot = lots.use == use
            cost[lot] += _kin(assets.use, use)[of[lot]]
    in_band = (scale >= BAND[0]) & (scale <= BAND[1])
    storey = np.nan_to_num(assets.storey[of] * scale, nan=3.0)
    plausible = (storey >= STOREY[0]) & (storey <= STOREY[1])
    in_band &= np.nan_to_num(height) <= np.log(HEIGHT_BAND)
    good = (rows >= 0) & in_band
    why = np.where(good.any(axis=1) & ~(good & plausible).any(axis=1), STOREYS, SIZE)
    return np.where(good & plausible, cost, np.inf), why


class _Fitting:
    """The true outlines of placed assets against lots, neighbours and obstacles."""

    def __init__(
        self, lots: Lots, assets: Assets, target: Targets, obstacles: NDArray[Any] | None
    ) -> None:
        self.assets, self.target = assets, target
        self.room = shapely.buffer(lots.polygon, TOLERANCE, join_style="mitre")
        shapely.prepare(self.room)
        self.lots = lots.polygon
        self.obstacles = None if obstacles is None or not len(obstacles) \
            else shapely.STRtree(obstacles)  # fmt: skip

    def outlines(self, lots: IntArray, assets: IntArray) -> tuple[FloatArray, NDArray[Any]]:
        """Return scale and placed outline of assets on lots; NaN and None where none fits."""
        full = np.minimum(
            self.target.front[lots] / self.assets.front[assets],
            self.target.depth[lots] / self.assets.depth[assets],
        )
        scale = np.full(len(lots), np.nan)
        outline = np.full(len(lots), None, object)
        left = np.arange(len(lots))
        for share in SHRINK:
            factor = full[left] * share
            allowed = factor >= BAND[0] - 1e-9
            left, factor = left[allowed], factor[allowed]
            if not len(left):
                break
            shapes = self._placed(lots[left], assets[left], factor)
            fits = shapely.covers(self.room[lots[left]], shapes)
            fits &= self._free(lots[left], shapes)
            scale[left[fits]], outline[left[fits]] = factor[fits], shapes[fits]
            left = left[~fits]
        return scale, outline

    def _placed(self, lots: IntArray, assets: IntArray, scale: FloatArray) -> NDArray[Any]:
        shapes = self.assets.outline[assets]
        points, row = shapely.get_coordinates(shapes, return_index=True)
        theta = self.target.facing[lots] - self.assets.facing[assets]
        cos, sin = (scale * np.cos(theta))[row], (scale * np.sin(theta))[row]
        x, y = (points - self.assets.centre[assets][row]).T
        moved = np.column_stack([cos * x - sin * y, sin * x + cos * y])
        return np.asarray(
            shapely.set_coordinates(shapes.copy(), moved + self.target.centre[lots][row])
        )

    def _free(self, lots: IntArray, shapes: NDArray[Any]) -> NDArray[np.bool_]:
        free = np.ones(len(shapes), bool)
        if self.obstacles is None:
            return free
        shape, hit = self.obstacles.query(shapes, predicate="intersects")
        if not len(shape):
            return free
        wall = self.obstacles.geometries[hit]
        own = shapely.area(shapely.intersection(self.lots[lots[shape]], wall))
        covered = shapely.area(shapely.intersection(shapes[shape], wall))
        free[shape[covered > own + TOUCH]] = False
        return free

    def losers(
        self, outline: NDArray[Any], chosen: IntArray, rank: IntArray, fresh: IntArray
    ) -> IntArray:
        """Return lots whose asset overlaps that of a lot of lower rank.

        Parameters
        ----------
        outline, chosen, rank
            (n,) of every lot.
        fresh
            Lots whose outline is new; the others were compared before.
        """
        fresh = fresh[(chosen[fresh] >= 0) & shapely.is_geometry(outline[fresh])]
        if not len(fresh):
            return fresh
        new, other = shapely.STRtree(outline).query(outline[fresh], predicate="intersects")
        first = fresh[new]
        # A pair of new ones is found twice; an old one stands only on a lot that has an asset.
        pair = (first != other) & (chosen[other] >= 0)
        first, other = first[pair], other[pair]
        shared = shapely.area(shapely.intersection(outline[first], outline[other]))
        first, other = first[shared > TOUCH], other[shared > TOUCH]
        return np.asarray(np.unique(np.where(rank[first] > rank[other], first, other)))


def assets_of(catalogue: Catalogue, score: FloatArray | None = None) -> Assets:
    """Return what placement needs of the records of a catalogue.

    Parameters
    ----------
    catalogue
        m records.
    score
        (m,) agreement with the description asked for.
    """
    angle = catalogue["angle"]
    facing = np.pi / 2 - catalogue["front"]  # compass to counter-clockwise from x
    turn = np.rint((facing - angle) / (np.pi / 2)).astype(np.int64)
    along = turn % 2 == 0
    return Assets(
        np.where(along, catalogue["width"], catalogue["length"]),
        np.where(along, catalogue["length"], catalogue["width"]),
        np.column_stack([catalogue["x"], catalogue["y"]]),
        angle + turn * np.pi / 2,
        catalogue["footprint"],
        catalogue["height"],
        catalogue["storey_height"],
        catalogue["use"].astype(str),
        catalogue["style"].astype(str),
        catalogue["party"].astype(np.int64),
        np.zeros(len(catalogue)) if score is None else np.asarray(score, float),
    )
