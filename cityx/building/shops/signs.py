"""Signs: boards, names, awnings and hanging signs of shops."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cityx.assets.shops.fonts import CAP, FIRST_EAST_ASIAN
from cityx.assets.shops.lettering import DEEP, GLYPH, glyph, glyph_name, line_of
from cityx.assets.shops.shopfronts import fitting
from cityx.assets.styles.materials import srgb_to_linear
from cityx.building.facade.placing import Placing
from cityx.building.shops.shops import Colors, Tenants
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.ids import choose, hash_ids, uniform
from cityx.places.profiles import profile_of

if TYPE_CHECKING:
    from cityx.building.facade.facade_plan import Facade
    from cityx.city.city import City
    from cityx.city.scene import Prototype


def _table(*colors: int) -> Colors:
    return np.array([srgb_to_linear(color) for color in colors], np.float32) / 0.8


_CLOTHS = _table(0x6E302B, 0x304839, 0x343F56, 0xB0A48C, 0x7A664A, 0x3A3A3C, 0xC5BFB2, 0x5E4046)
SIGNS = _table(0x8E3A32, 0x2F4F74, 0x335C46, 0xA88A52, 0x3A3A3C, 0xC8C6BE, 0x5E3F5A, 0xE0DED6)
BRIGHT, GILT, INK = _table(0xF2EFE6), _table(0xD8C08A), _table(0x262524)
PALE = 0.3  # luminance of a board from which its letters are dark
BOARDS = ("sign_fascia", "sign_box", "sign_letters")
# Of each board: metres from the wall to its face, height of its middle, tallest capitals.
FACES = np.array([(0.142, 0.26, 0.28), (0.228, 0.30, 0.33), (0.06, 0.28, 0.30)])
FILLED = 0.86  # share of a board that a name may take
RELIEF = 0.024  # metres that letters stand out
BOARD = 3.5  # metres of front that a board was drawn for
SMALLEST = 0.11  # metres; smaller letters are left out
BLADE_MIDDLE, BLADE_HALF = 0.56, 0.30  # metres from the wall, of the field of a hanging sign
STACKED = ("asian_block", "japanese_", "office_slab")  # beginnings of looks with stacks of signs
STACK_FIELDS, STACK_STEP = 4, 1.04  # fields of a stack of signs, metres from one to the next


def _pick(table: Colors, seed: int, purpose: str, ids: NDArray[np.uint64]) -> Colors:
    return np.asarray(table[hash_ids(seed, purpose, ids) % np.uint64(len(table))])


def signs(placing: Placing, found: Facade, city: City, shops: Tenants) -> None:
    """Put up name boards with names, awnings, hanging signs and stacks of signs."""
    seed, walls = city.seed, found.walls
    table, tenant, first, shop = shops.table, shops.tenant, shops.first, shops.shop
    low, high = shops.low, shops.high
    top = np.full(len(tenant), np.inf)
    np.minimum.at(top, shop, table.low + table.height)
    wall, along, wide = table.wall[first], (low + high) / 2, high - low
    cell = ((table.floor * 4096 + table.bay + 2048) * 16 + table.role)[first]
    kind = choose(seed, "facade/sign", tenant, (5, 3, 2))
    color = _pick(SIGNS, seed, "facade/sign tint", tenant)
    tint = np.where((kind == 0)[:, None], shops.paint, color)
    cloth = _pick(_CLOTHS, seed, "facade/cloth", tenant)
    awned = uniform(seed, "facade/awning", tenant) < 0.32

    def put(name: str, of: IntArray, at: FloatArray, z: FloatArray, colors: Colors,
            **options: Any) -> None:  # fmt: skip
        placing.add(name, partial(fitting, name), wall[of], at[of], z[of], tint=colors[of],
                    index=cell[of], **options)  # fmt: skip

    for number, name in enumerate(BOARDS):
        of = np.flatnonzero(kind == number)
        put(name, of, along, top + 0.03, tint, scale=((wide[of] + 0.12) / BOARD, 1.0, 1.0),
            reach=wide[of] / 2)  # fmt: skip
    of = np.flatnonzero(awned[shop])
    placing.add(
        "awning", partial(fitting, "awning"), table.wall[of], table.along[of],
        (table.low + table.height)[of] - 0.02, scale=((table.width[of] + 0.12) / BOARD, 1.0, 1.0),
        tint=cloth[shop[of]], index=table.bay[of], out=0.16, reach=table.width[of] / 2,
    )  # fmt: skip
    end = np.minimum(high + 0.1, walls.length[wall] - 0.2)
    blade = (uniform(seed, "facade/blade", tenant) < 0.35) & ~awned
    of = np.flatnonzero(blade)
    put("sign_blade", of, end, top - 0.5, color, out=0.1, reach=0.1)
    # Stacks of signs up the corners of the trading streets of East Asia.
    part = walls.part[wall]
    tall = walls.z_high[wall] - top > 5.8
    stack = np.logical_or.reduce(
        [np.char.startswith(found.designs.style[part], word) for word in STACKED]
    )
    stack &= tall
    stack &= table.bay[first] % 500 < 2
    stack &= profile_of(city.frame).shops.stacked_signs
    stack &= uniform(seed, "facade/stack", placing.building[wall]) < 0.6
    corner = np.full(len(tenant), 0.35)
    stacks = np.flatnonzero(stack)
    put("sign_tower", stacks, corner, top + 1.4, color, reach=0.1)

    names = shops.name
    dark = _luminance(tint) > PALE
    dark |= (kind == 2) & (_luminance(found.finishes.wall_tint[part]) > PALE)
    gilt = (kind == 0) & (uniform(seed, "facade/gilt", tenant) < 0.5)
    ink = np.where(dark[:, None], INK, np.where(gilt[:, None], GILT, BRIGHT))
    face = FACES[kind]
    text = _Text(placing)
    text.level(names, wall, along, top + 0.03 + face[:, 1], face[:, 0], face[:, 2], FILLED * wide,
               ink, cell)  # fmt: skip
    ink = np.where((_luminance(color) > PALE)[:, None], INK, BRIGHT)
    brief = np.array([_brief(name, 1.8 * BLADE_HALF) for name in names[of].tolist()], str)
    for side in (-1.0, 1.0):
        text.level(brief, wall[of], end[of] + side * 0.036, top[of] - 0.21,
                   np.full(len(of), BLADE_MIDDLE + 0.1), np.full(len(of), 0.2),
                   np.full(len(of), 1.8 * BLADE_HALF), ink[of], cell[of], side=side)  # fmt: skip
        text.stacked(names[stacks], wall[stacks], corner[stacks] + side * 0.092,
                     top[stacks] + 1.4, 0.62, ink[stacks], cell[stacks], side)  # fmt: skip
    text.place()


def _brief(name: str, room: float) -> str:
    """Return what of a name can be read in a narrow field: all, its first word, or its initial."""
    most = room * CAP / SMALLEST  # em
    for text in (name, name.split(" ")[0] if name else ""):
        if text and line_of(text).width <= most:
            return text
    return name[:1].upper()


def _luminance(tint: Colors) -> FloatArray:
    return np.asarray(0.8 * tint @ np.array([0.2126, 0.7152, 0.0722]))


class _Text:
    """Letters of all signs of a city, gathered letter by letter.

    A class because many signs add letters before each prototype is placed once.
    """

    def __init__(self, placing: Placing) -> None:
        self.placing = placing
        self.rows: list[tuple[Any, ...]] = []

    def level(
        self, names: NDArray[np.str_], wall: IntArray, along: FloatArray, middle: FloatArray,
        out: FloatArray, tallest: FloatArray, room: FloatArray, ink: Colors, cell: IntArray,
        *, side: float = 0.0,
    ) -> None:  # fmt: skip
        """Set names in lines along walls, or out from them on one `side` of a hanging sign."""
        for row, name in enumerate(names.tolist()):
            line = line_of(name)
            size = min(tallest[row] / CAP, room[row] / max(line.width, 0.1))
            if CAP * size < SMALLEST:
                continue
            foot = middle[row] - 0.5 * CAP * size
            for number, (letter, x) in enumerate(zip(line.letters, line.middle, strict=True)):
                shift = size * float(x)
                place = (along[row], out[row] - side * shift) if side else (
                    along[row] + shift, out[row]
                )  # fmt: skip
                self._add(letter, side, wall[row], *place, foot, size, ink[row],
                          int(cell[row]) * 256 + number)  # fmt: skip

    def stacked(
        self, names: NDArray[np.str_], wall: IntArray, along: FloatArray, low: FloatArray,
        out: float, ink: Colors, cell: IntArray, side: float,
    ) -> None:  # fmt: skip
        """Set names upright down a stack of signs, letter below letter."""
        high = STACK_FIELDS * STACK_STEP
        for row, name in enumerate(names.tolist()):
            letters = line_of(name).letters
            if not letters:
                continue
            step = min(high / len(letters), 0.62)
            asian = ord(letters[0]) >= FIRST_EAST_ASIAN
            size = min(0.92 * step, 0.56) * (1.0 if asian else 1.15)
            start = low[row] + high - (high - step * len(letters)) / 2
            for number, letter in enumerate(letters):
                foot = start - (number + 0.5) * step - 0.5 * CAP * size
                self._add(letter, side, wall[row], along[row], out, foot, size, ink[row],
                          int(cell[row]) * 256 + 128 + number)  # fmt: skip

    def _add(self, letter: str, side: float, *row: Any) -> None:
        self.rows.append((letter, side, *row))

    def place(self) -> None:
        """Put all letters on their walls."""
        if not self.rows:
            return
        letter, sides, wall, along, out, foot, sizes, ink, index = zip(*self.rows, strict=True)
        size, side = np.array(sizes), np.array(sides)
        self.placing.add_each(
            np.array([glyph_name(one) for one in letter]), _maker, np.array(wall),
            np.array(along), np.array(foot), scale=(size, RELIEF / DEEP, size),
            tint=np.array(ink, np.float32),
            index=np.array(index, np.int64) * 4 + side.astype(int) + 1, out=np.array(out),
            reach=np.where(side == 0, 0.5, 0.05), turn=side * np.pi / 2,
        )  # fmt: skip


def _maker(name: str) -> Callable[..., Prototype]:
    return partial(glyph, chr(int(name.removeprefix(GLYPH), 16)))
