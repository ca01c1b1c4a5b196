"""Dormers: windows in sloping roofs, in line with the bays below, and panels on sunny slopes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cityx.assets.openings.frames import NICHE_DEPTH
from cityx.assets.openings.windows import WINDOWS, window
from cityx.assets.styles.palettes import GROUPS, groups_of
from cityx.assets.trims.dormers import (
    DEPTH,
    DORMERS,
    PANELS,
    PLATE,
    ROOF_WINDOW,
    dormer_front,
    dormer_opening,
    dormer_roof,
    roof_panels,
    roof_window,
)
from cityx.building.facade.grammar import bays_of
from cityx.building.facade.placing import Placing
from cityx.building.roofs.roof_heights import RoofField
from cityx.building.roofs.shapes import as_shapes
from cityx.building.volumes import covered
from cityx.city.scene import Prototype
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.ranges import numbered
from cityx.ids import choose, uniform

if TYPE_CHECKING:
    from cityx.building.facade.facade_plan import Facade
    from cityx.city.city import City

# Roofs whose slopes begin at level eaves and are planes.
SLOPED = ("gabled", "hipped", "half-hipped", "side_hipped", "side_half-hipped", "saltbox",
          "hipped-and-gabled", "mansard", "gambrel", "crosspitched")  # fmt: skip
STEEP = ("mansard", "gambrel")  # their lower slope is a storey with windows
KINDS = ("gabled", "hipped", "segment", "shed", "roof_window")
# Weights of the kinds on steep rims, on blocks of flats, on houses; the rest of them has none.
_WEIGHTS = {
    "steep": (4, 2, 4, 0, 0), "flats": (3, 2, 1, 3, 3), "house": (3, 1, 0, 3, 5),
}  # fmt: skip
_SHARES = {"steep": 0.97, "flats": 0.75, "house": 0.42}
LEAST_RISE = {"steep": 1.9, "flats": 2.4, "house": 2.2}  # metres from eave to ridge
SPACING = {"steep": 2.5, "flats": 4.0, "house": 4.2}  # metres between dormers, at least
MOST = 24  # dormers over one wall
SETBACK = {"steep": 0.12, "flats": 0.7, "house": 0.75}  # metres in plan from the wall to the front
REACH = 0.5  # metres round a dormer's axis that no other part may cover
SLOPES = (0.45, 4.5)  # rise over run of roofs that bear any
STEEPEST_DORMER_DEPTH = 5.5  # metres; a longer one belongs to a shallow roof
SIDE = 0.3  # metres of the same slope kept beside a dormer
RIDGE_ROOM = 0.35  # metres of slope kept above it, in plan
SAME = 0.04  # metres by which a slope may leave its plane
FIRST, SECOND = 0.1, 0.4  # metres behind the wall at which a slope is measured
SIZES = (1.0, 0.84, 0.7)  # tried one after another until a dormer fits
PANEL_SHARE = 0.13  # of houses with solar panels on a slope
SUNNY = 0.35  # least cosine between the way a slope looks and south
# Windows that suit a dormer; the others are too large or too grand for it.
SMALL = ("window_casement", "window_sash", "window_single", "window_cottage", "window_small",
         "window_slider")  # fmt: skip
FLAT = 0.05  # metres to which a fine window is squeezed


@dataclass(frozen=True)
class Slopes:
    """Places on slopes, k of them, each on the axis of a bay of the wall below.

    Attributes
    ----------
    wall, along, index
        Row of the wall, metres from its start, number of the bay.
    eave, slope
        Height of the slope over the face of the wall, and its rise over run inward.
    """

    wall: IntArray
    along: FloatArray
    index: IntArray
    eave: FloatArray
    slope: FloatArray

    def take(self, rows: NDArray[np.bool_] | IntArray) -> Slopes:
        """Return some of the places."""
        return Slopes(
            self.wall[rows], self.along[rows], self.index[rows], self.eave[rows], self.slope[rows]
        )


def dormers(placing: Placing, found: Facade, city: City, field: RoofField) -> None:
    """Put dormers and roof windows on slopes, on the axes of the bays below.

    Each lies wholly on one plane of the roof: none runs through a ridge, a hip, a valley or the
    roof's edge.
    """
    group, having = _groups(found, city)
    seed = city.seed
    for name in _WEIGHTS:
        parts = having & (group == name)
        slopes = _slopes(placing, found, parts, name, field)
        building = placing.building[slopes.wall]
        kind = choose(seed, "roof/dormer kind", building, _WEIGHTS[name])
        for number, word in enumerate(KINDS):
            of = slopes.take(kind == number)
            if not len(of.wall):
                continue
            if word == "roof_window":
                _roof_windows(placing, of, field)
            else:
                _standing(placing, found, of, word, SETBACK[name], field, city)
    _panels(placing, found, group, field, city)


def _groups(found: Facade, city: City) -> tuple[NDArray[np.str_], NDArray[np.bool_]]:
    """(n,) kind of roof of each part, "" for none, and whether it has dormers."""
    shape = as_shapes(city.layout.parts["roof_shape"].to_numpy())
    use = np.array(GROUPS)[groups_of(city.layout, city.seed)]
    rise = found.volumes.top - found.volumes.eave
    sloped = np.isin(shape, SLOPED) & found.volumes.walls
    lived = np.isin(use, ["house", "flats", "office", "civic"])
    group = np.select(
        [sloped & lived & np.isin(shape, STEEP), sloped & np.isin(use, ["flats", "office"]),
         sloped & (use == "house")],
        ["steep", "flats", "house"], "",
    )  # fmt: skip
    share = np.select([group == name for name in _SHARES], list(_SHARES.values()), 0.0)
    least = np.select([group == name for name in LEAST_RISE], list(LEAST_RISE.values()), np.inf)
    drawn = uniform(city.seed, "roof/dormers", found.volumes.building) < share
    return group, drawn & (rise >= least)


def _slopes(
    placing: Placing, found: Facade, parts: NDArray[np.bool_], name: str, field: RoofField
) -> Slopes:
    """Axes of bays over which a slope rises, so many that dormers keep their spacing."""
    walls = found.walls
    bays, margin, bay, _ = bays_of(found.storey_walls, found.fronts)
    free = (walls.blind_to < walls.z_high - 0.4) & (walls.open_to > walls.z_high - 0.05)
    rows = np.flatnonzero(parts[walls.part] & free & (bays > 0) & (walls.length > 2.4))
    stride = np.maximum(1, np.ceil(SPACING[name] / np.maximum(bay[rows], 0.1) - 0.05)).astype(int)
    count = np.minimum((bays[rows] - 1) // stride + 1, MOST)
    # What is left over lies at both ends alike.
    first = (bays[rows] - 1 - (count - 1) * stride) // 2
    row = np.repeat(np.arange(len(rows)), count)
    step = numbered(count)
    index = first[row] + step * stride[row]
    wall = rows[row]
    along = margin[wall] + (index + 0.5) * bay[wall]
    near = _heights(placing, field, wall, along, np.full(len(wall), FIRST))
    far = _heights(placing, field, wall, along, np.full(len(wall), SECOND))
    slope = (far - near) / (SECOND - FIRST)
    eave = near - FIRST * slope
    good = (slope > SLOPES[0]) & (slope < SLOPES[1]) & (np.abs(eave - walls.z_high[wall]) < 0.3)
    at = walls.start[wall] + placing.unit[wall] * along[:, None] - SECOND * walls.normal[wall]
    reach = np.full(len(wall), REACH)
    part = walls.part[wall].astype(np.int64)
    good &= ~covered(found.volumes, part, at[:, 0], at[:, 1], reach, far)
    return Slopes(wall, along, index, eave, slope).take(good)


def _heights(
    placing: Placing, field: RoofField, wall: IntArray, along: FloatArray, inward: FloatArray
) -> FloatArray:
    """Height of the roof at places behind walls, NaN beside it."""
    walls = placing.walls
    out = placing.faces.before(walls, wall, along)
    at = walls.start[wall] + placing.unit[wall] * along[:, None]
    at = at + walls.normal[wall] * (out - inward)[:, None]
    z, _ = field.at(at, placing.building[wall])
    return z


def _lies_in(
    placing: Placing, field: RoofField, slopes: Slopes, half: FloatArray, near: FloatArray,
    far: FloatArray,
) -> NDArray[np.bool_]:  # fmt: skip
    """(k,) whether the rectangle from `near` to `far` behind the wall lies in the slope's plane."""
    good = np.ones(len(slopes.wall), bool)
    for side in (-1.0, 0.0, 1.0):
        for inward in (near, (near + far) / 2, far) if side else (far,):
            rows = np.flatnonzero(good)
            along = slopes.along[rows] + side * half[rows]
            z = _heights(placing, field, slopes.wall[rows], along, inward[rows])
            plane = slopes.eave[rows] + slopes.slope[rows] * inward[rows]
            good[rows] = np.abs(z - plane) < SAME
    return good


def _standing(
    placing: Placing, found: Facade, slopes: Slopes, kind: str, setback: float, field: RoofField,
    city: City,
) -> None:  # fmt: skip
    """Dormers of one kind: cheeks and roof, front, window."""
    width, height, rise = DORMERS[kind]
    size = np.zeros(len(slopes.wall))
    depth = np.zeros(len(slopes.wall))
    front = np.full(len(slopes.wall), setback)
    for factor in SIZES:
        rows = np.flatnonzero(size == 0)
        of = slopes.take(rows)
        run = factor * (height + rise) / of.slope
        half = np.full(len(rows), factor * width / 2 + SIDE)
        fits = run < STEEPEST_DORMER_DEPTH
        fits &= _lies_in(placing, field, of, half, front[rows] * 0.5, front[rows] + run + RIDGE_ROOM
                         / (1 + of.slope))  # fmt: skip
        size[rows[fits]] = factor
        depth[rows[fits]] = run[fits] + 0.15
    fit = np.flatnonzero(size > 0)
    of, size, depth = slopes.take(fit), size[fit], depth[fit]
    if not len(fit):
        return
    wall, along = of.wall, of.along
    part = found.walls.part[wall]
    z = of.eave + of.slope * setback
    finishes = found.finishes
    # Houses with dressed windows have pale fronts, the others those of their walls.
    rich = np.char.startswith(found.designs.surround[part], "surround") | (of.slope > 1.5)
    tint = np.where(rich[:, None], finishes.trim_tint[part], finishes.wall_tint[part])
    placing.add(
        f"dormer_{kind}_front", partial(dormer_front, kind), wall, along, z,
        scale=(size, 1.0, size), tint=tint, index=of.index, out=-setback, reach=0.2,
    )  # fmt: skip
    material = finishes.roof_material[part]
    for word in np.unique(material).tolist():
        rows = np.flatnonzero(material == word)
        placing.add(
            f"dormer_{kind}_{word}", partial(dormer_roof, kind, word), wall[rows], along[rows],
            z[rows], scale=(size[rows], depth[rows] / DEPTH, size[rows]),
            tint=finishes.roof_tint[part[rows]], index=of.index[rows], out=-setback, reach=0.2,
        )  # fmt: skip
    wide, high, foot = dormer_opening(kind)
    attic_windows(
        placing, found, city, wall, along, z + foot * size, (wide * size, high * size), of.index,
        out=PLATE - setback,
    )  # fmt: skip


def attic_windows(
    placing: Placing, found: Facade, city: City, wall: IntArray, along: FloatArray, z: FloatArray,
    size: tuple[FloatArray, FloatArray], index: IntArray, out: float = 0.0,
) -> None:  # fmt: skip
    """Put windows of the kind the building has under its roof, above the eaves.

    Parameters
    ----------
    wall, along, z
        (k,) row of the wall, metres from its start, height of the foot.
    size
        (k,) widths and (k,) heights, metres.
    index
        (k,) what tells the windows over one wall apart.
    out
        Metres before the wall.
    """
    part = found.walls.part[wall]
    name = found.designs.window[part]
    name = np.where(np.isin(name, SMALL), name, "window_single")
    ids = placing.ids("roof/window", wall, index)
    dressing = choose(city.seed, "facade/dressing", ids, (0.6, 0.15, 0.25))
    # Fine windows are drawn for a niche; here they are squeezed flat and stand before the front.
    fine = placing.detail > 2
    deep, before = (FLAT / NICHE_DEPTH, FLAT + 0.012) if fine else (1.0, 0.0)
    code = np.unique(name, return_inverse=True)[1] * 4 + dressing
    for value in np.unique(code).tolist():
        of = np.flatnonzero(code == value)
        word, which = str(name[of[0]]), int(value % 4)
        _, width, height = WINDOWS[word]
        placing.add(
            f"{word}_{which}", partial(window, word, which),
            wall[of], along[of], z[of],
            scale=(size[0][of] / width, deep, size[1][of] / height),
            tint=found.finishes.frame_tint[part[of]], ids=ids[of], out=before + out, reach=0.2,
        )  # fmt: skip


def _roof_windows(placing: Placing, slopes: Slopes, field: RoofField) -> None:
    """Windows that lie in the slope, at a height at which one looks out."""
    lean = np.hypot(1.0, slopes.slope)
    reach = ROOF_WINDOW[1] / 2 / lean  # in plan
    middle = 1.35 / slopes.slope + reach + 0.2
    half = np.full(len(slopes.wall), ROOF_WINDOW[0] / 2 + SIDE)
    fits = _lies_in(placing, field, slopes, half, middle - reach - 0.25, middle + reach + 0.25)
    slopes, middle = slopes.take(fits), middle[fits]
    ids = placing.ids("roof/lying window", slopes.wall, slopes.index)
    _lay(placing, roof_window(detail=placing.detail), slopes, middle, ids)


def _panels(
    placing: Placing, found: Facade, group: NDArray[np.str_], field: RoofField, city: City
) -> None:
    """Solar panels on the slopes of some houses that look south."""
    drawn = uniform(city.seed, "roof/panels", found.volumes.building)
    parts = (group == "house") & (drawn < PANEL_SHARE)
    # Away from the equator's side there is no sun worth a panel.
    south = -1.0 if city.frame.latitude >= 0 else 1.0
    walls = found.walls
    rows = np.flatnonzero(
        parts[walls.part] & (walls.length > PANELS[0] + 1.0)
        & (walls.normal[:, 1] * south > SUNNY)
    )  # fmt: skip
    along = 0.68 * walls.length[rows]
    near = _heights(placing, field, rows, along, np.full(len(rows), FIRST))
    far = _heights(placing, field, rows, along, np.full(len(rows), SECOND))
    slope = (far - near) / (SECOND - FIRST)
    good = (slope > 0.2) & (slope < 1.6)
    slopes = Slopes(rows, along, rows * 0 + 900, near - FIRST * slope, slope).take(good)
    reach = PANELS[1] / 2 / np.hypot(1.0, slopes.slope)
    middle = 0.6 + reach
    half = np.full(len(slopes.wall), PANELS[0] / 2 + 0.2)
    fits = _lies_in(placing, field, slopes, half, middle - reach - 0.2, middle + reach + 0.2)
    slopes, middle = slopes.take(fits), middle[fits]
    ids = placing.ids("roof/panels", slopes.wall, slopes.index)
    _lay(placing, roof_panels(detail=placing.detail), slopes, middle, ids)


def _lay(
    placing: Placing, made: Prototype, slopes: Slopes, inward: FloatArray,
    ids: NDArray[np.uint64],
) -> None:  # fmt: skip
    """Lay a prototype into slopes with its middle `inward` metres behind the wall."""
    walls, wall = placing.walls, slopes.wall
    out = placing.faces.before(walls, wall, slopes.along)
    at = walls.start[wall] + placing.unit[wall] * slopes.along[:, None]
    at = at + walls.normal[wall] * (out - inward)[:, None]
    rotation = np.zeros((len(wall), 3))
    rotation[:, 0] = np.arctan(slopes.slope)
    rotation[:, 2] = placing.yaw[wall]
    placing.put(
        made, ids, placing.building[wall],
        np.column_stack([at, slopes.eave + slopes.slope * inward]), rotation,
    )  # fmt: skip
