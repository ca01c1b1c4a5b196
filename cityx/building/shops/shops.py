"""Shops: tenants of the bays of ground floors, their fronts, and the rooms behind the panes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cityx.assets.openings.frames import FINE
from cityx.assets.shops.shop_rooms import ROOM_OF, VARIANTS, shop_room
from cityx.assets.shops.shopfronts import HEIGHT, WIDTH, shopfront
from cityx.assets.styles.materials import srgb_to_linear
from cityx.building.catalogue import looks
from cityx.building.facade import grammar as facades
from cityx.building.facade.grammar import Openings
from cityx.building.facade.niches import FLAT_DEPTH, FLAT_GAP, SHOP_DEPTH, Setting, fitted
from cityx.building.facade.placing import Placing
from cityx.building.shops.shop_names import shop_names
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.ids import choose, hash_ids, uniform
from cityx.places.profiles import profile_of

if TYPE_CHECKING:
    from cityx.building.facade.facade_plan import Facade
    from cityx.city.city import City

Colors = NDArray[np.float32]  # (n, 3) linear RGB


def _table(*colors: int) -> Colors:
    return np.array([srgb_to_linear(color) for color in colors], np.float32) / 0.8


_PAINTS = _table(
    0x5A2A26, 0x223A2E, 0x202B42, 0x262627, 0x4A3D30, 0x5E5338, 0x6E322C, 0x32505A, 0x3F4A38,
    0x544860, 0x75624A, 0x33302D, 0x9A9890, 0x737F84, 0xACA592, 0x4E5A66,
)  # fmt: skip
# Walls of rooms: white, cream, grey, and a few in a colour.
_ROOMS = _table(
    0xE6E2D8, 0xD8D0BE, 0xC9CCC8, 0xB8A88C, 0x8E6A50, 0x6A7A70, 0x5E6E80, 0x9A5A4A, 0x3E4448,
    0xD2C098, 0xA8B4B8, 0x74604E,
)  # fmt: skip
FRONTS = ("shop_classic", "shop_modern", "shop_window", "shop_cafe", "shop_shutter")
_OLD = (0.42, 0.12, 0.20, 0.22, 0.04)
EMPTY = 0.05  # share of shops to let
PANES = 0.7  # share of the depth of a shopfront behind which its room begins
BACK = 0.012  # metres between the back wall of a room and that of its niche


@dataclass(frozen=True)
class Tenants:
    """Tenants of the k bays of shops, and what is known of the t tenants.

    Attributes
    ----------
    table
        The k bays.
    opening
        (k,) row of each among all openings.
    shop
        (k,) row of its tenant.
    tenant
        (t,) uint64 key: the id of the front of its first bay.
    first
        (t,) the first of its bays.
    low, high
        (t,) metres along the wall at which its front begins and ends.
    paint
        (t, 3) linear RGB of its front.
    name, kind
        (t,) what stands over it; a key of `cityx.building.shops.shop_names.ShopWords.usual`.
    """

    table: Openings
    opening: IntArray
    shop: IntArray
    tenant: NDArray[np.uint64]
    first: IntArray
    low: FloatArray
    high: FloatArray
    paint: Colors
    name: NDArray[np.str_]
    kind: NDArray[np.str_]


def shops(placing: Placing, found: Facade, city: City, setting: Setting) -> Tenants:
    """Place shopfronts and the rooms behind them; return who rents them."""
    tenants = tenants_of(placing, found, city)
    if not tenants.table.count:
        return tenants
    front = _fronts(placing, found, city, setting, tenants)
    if placing.detail >= FINE:
        _rooms(placing, city, setting, tenants, front)
    return tenants


def tenants_of(placing: Placing, found: Facade, city: City) -> Tenants:
    """Assign tenants to the shop bays; two bays side by side are one shop."""
    opening = np.flatnonzero(found.openings.role == facades.SHOP)
    table = found.openings.take(opening)
    key = placing.ids("facade/tenant", table.wall, table.bay // 500 * 64 + table.bay % 500 // 2)
    _, first, shop = np.unique(key, return_index=True, return_inverse=True)
    # A tenant goes by the front of its first bay, so that whoever sees the front knows the tenant.
    tenant = _ids(placing, table)[first]
    low, high = np.full(len(tenant), np.inf), np.full(len(tenant), -np.inf)
    np.minimum.at(low, shop, table.along - table.width / 2)
    np.maximum.at(high, shop, table.along + table.width / 2)
    wall = table.wall[first]
    middle = found.walls.start[wall] + placing.unit[wall] * ((low + high) / 2)[:, None]
    name, kind = shop_names(city, tenant, placing.building[wall], middle)
    paint = _PAINTS[hash_ids(city.seed, "facade/shop tint", tenant) % np.uint64(len(_PAINTS))]
    return Tenants(table, opening, shop, tenant, first, low, high, paint, name, kind)


def _ids(placing: Placing, table: Openings) -> NDArray[np.uint64]:
    """(k,) ids of the fronts of bays."""
    number = (table.floor * 4096 + table.bay + 2048) * 16 + table.role
    return placing.ids("facade/opening", table.wall, number)


def _fronts(
    placing: Placing, found: Facade, city: City, setting: Setting, tenants: Tenants
) -> IntArray:
    """Place the fronts and return which of `FRONTS` each bay has, (k,)."""
    table, key = tenants.table, tenants.tenant[tenants.shop]
    part = found.walls.part[table.wall]
    old = np.isin(found.designs.style[part], [name for name, look in looks().items() if look.old])
    kind = np.where(
        old,
        choose(city.seed, "facade/shop kind", key, _OLD),
        choose(city.seed, "facade/shop kind", key, profile_of(city.frame).shops.fronts),
    )
    # Of two bays of one shop the second is a display window.
    kind = np.where((table.bay % 500 % 2 == 1) & (kind < 2), 2, kind)
    ids = _ids(placing, table)
    depth = np.minimum(setting.depth[tenants.opening], SHOP_DEPTH)
    for value in np.unique(kind).tolist():
        of = np.flatnonzero(kind == value)
        size = np.tile((WIDTH, HEIGHT), (len(of), 1))
        placing.add(
            FRONTS[value], partial(shopfront, FRONTS[value]), table.wall[of], table.along[of],
            table.low[of], **fitted(placing, depth[of], table.width[of], table.height[of], size),
            tint=tenants.paint[tenants.shop[of]], ids=ids[of], reach=table.width[of] / 2,
        )  # fmt: skip
    return np.asarray(kind)


def _rooms(
    placing: Placing, city: City, setting: Setting, tenants: Tenants, front: IntArray
) -> None:
    """Furnish what is seen behind the panes, by trade; squeezed where a niche is shallow."""
    table, seed = tenants.table, city.seed
    trade = np.array([ROOM_OF.get(kind, "gallery") for kind in tenants.kind.tolist()], "U12")
    trade = np.where(uniform(seed, "facade/to let", tenants.tenant) < EMPTY, "empty", trade)
    paint = _ROOMS[hash_ids(seed, "facade/room tint", tenants.tenant) % np.uint64(len(_ROOMS))]
    bay = placing.ids("facade/room", table.wall, table.bay)
    name = trade[tenants.shop]
    variant = (hash_ids(seed, "facade/room variant", bay) % np.uint64(VARIANTS)).astype(np.int64)
    depth = setting.depth[tenants.opening]
    own = np.minimum(depth, SHOP_DEPTH)
    start = np.where(depth > 0, PANES * own, -FLAT_GAP - (1 - PANES) * FLAT_DEPTH)
    deep = np.where(depth > 0, depth - BACK, -FLAT_GAP) - start
    open_ = front != FRONTS.index("shop_shutter")
    pairs = zip(name[open_].tolist(), variant[open_].tolist(), strict=True)
    for word, number in sorted(set(pairs)):
        of = np.flatnonzero(open_ & (name == word) & (variant == number))
        placing.add(
            f"room_{word}_{number}", partial(shop_room, word, number), table.wall[of],
            table.along[of], table.low[of],
            scale=(table.width[of] / WIDTH, deep[of], table.height[of] / HEIGHT),
            out=-start[of], tint=paint[tenants.shop[of]], ids=bay[of], reach=table.width[of] / 2,
        )  # fmt: skip
