from dataclasses import replace

import numpy as np
import pytest
from test_signs import COUNT, street

from cityx.assets.shops.shop_rooms import ROOM_OF, ROOMS, VARIANTS, shop_room
from cityx.assets.shops.shopfronts import HEIGHT, WIDTH
from cityx.building.facade.facade import facade
from cityx.building.facade.niches import ROOM_DEPTH
from cityx.building.shell import shell
from cityx.building.shops.shop_names import shop_names, shop_words
from cityx.city.content import content_hash
from cityx.nature.furniture.street_pieces import KNOWN_FRONTS

SOLD = ("books", "bakery", "hairdresser", "wine", "clothes", "florist")


def row_of_shops(lod=3):
    """Build six houses with a shop each, as the map tells."""
    told = [(12.0 * at + 6.0, 2.0, f'{{"shop": "{word}"}}') for at, word in enumerate(SOLD)]
    return facade(shell(replace(street(shops=told, use="apartments"), lod=lod)))


def rooms_of(city):
    rows = city.scene.instances["trims"]
    names = np.array([each.name for each in city.scene.prototypes])[rows.prototype]
    return rows, np.flatnonzero(np.char.startswith(names, "room_")), names


def test_every_kind_of_shop_has_a_room():
    assert set(ROOM_OF) == set(shop_words().usual)
    assert set(ROOM_OF.values()) <= set(ROOMS)


@pytest.mark.parametrize("trade", list(ROOMS))
def test_a_room_stays_behind_its_panes(trade):
    for variant in range(VARIANTS):
        mesh = shop_room(trade, variant).mesh
        low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
        assert (low >= [-WIDTH / 2, 0.0, 0.0]).all()
        assert (high <= [WIDTH / 2, 1.0, HEIGHT]).all()
        assert mesh.triangle_count < 8000


def test_a_room_lies_behind_every_front_without_a_shutter():
    city = row_of_shops()
    fronts = city.scene.instances["shopfronts"]
    shut = np.array([each.name.startswith("shop_shutter") for each in city.scene.prototypes])
    rows, rooms, _ = rooms_of(city)
    assert len(rooms) == fronts.count - shut[fronts.prototype].sum()
    assert len(np.unique(rows.tint[rooms], axis=0)) > 2
    # Drawn a metre deep; what a front has no room for is squeezed.
    deep = rows.scale[rooms, 1]
    assert (deep > 0).all()
    assert 1.0 < deep.max() < ROOM_DEPTH


def test_who_sees_the_front_of_a_first_bay_knows_its_trade():
    city = row_of_shops()  # some of which the map tells, some not
    fronts = city.scene.instances["shopfronts"]
    kinds = np.array([p.name.removesuffix("_fine") for p in city.scene.prototypes])
    first = np.flatnonzero(np.isin(kinds[fronts.prototype], KNOWN_FRONTS))
    assert len(first) > 2
    foot = fronts.position[:, :2]
    trade = shop_names(city, fronts.object_id, fronts.owner, foot)[1][first]
    rows, rooms, names = rooms_of(city)
    near = np.hypot(*(rows.position[rooms, None, :2] - foot[first]).transpose(2, 0, 1)).argmin(0)
    shown = [name.split("_")[1] for name in names[rooms[near]].tolist()]
    known = [(ROOM_OF[word], room) for word, room in zip(trade, shown, strict=True)]
    assert all(one == other or other == "empty" for one, other in known)


def test_a_shop_of_the_map_has_the_room_of_its_trade():
    rows, rooms, names = rooms_of(row_of_shops())
    shut = 0
    for at, room in enumerate(("books", "bakery", "barber", "bottles", "clothes", "flowers")):
        own = rooms[rows.owner[rooms] == np.uint64(7919 * (at + 1))]
        shut += not len(own)
        told = {name.split("_")[1] for name in names[own].tolist()}
        assert not len(own) or room in told or "empty" in told
    assert shut < COUNT / 2


def test_plain_shops_have_no_rooms():
    assert not len(rooms_of(row_of_shops(2))[1])


def test_shops_are_the_same_from_the_same_seed():
    assert content_hash(row_of_shops()).total == content_hash(row_of_shops()).total
