from dataclasses import replace

import numpy as np
import pytest
import shapely

from cityx.assets.shops.fonts import CAP
from cityx.assets.shops.lettering import GLYPH
from cityx.building.facade.facade import facade
from cityx.building.shell import shell
from cityx.building.shops.neon_signs import neon_signs
from cityx.building.shops.shop_names import cut, shop_names
from cityx.city import City, Frame, Layout, make_table
from cityx.city.content import content_hash

COUNT = 6


def street(*, shops=(), use="retail", place=(52.5, 13.4), tags="{}"):
    """Build six houses in a row along a street; `shops` are (x, y, tags) of the map."""
    x = np.arange(COUNT) * 12.0
    boxes = shapely.box(x, 0, x + 12.0, 11)
    ids = np.arange(1, COUNT + 1, dtype=np.uint64) * np.uint64(7919)
    same = {"id": ids, "use": [use] * COUNT, "levels": [4] * COUNT}
    buildings = make_table("buildings", boxes, place=["low"] * COUNT, tags=[tags] * COUNT, **same)
    parts = make_table(
        "parts", boxes, building=ids, top=[14.0] * COUNT, walls=[True] * COUNT,
        roof_shape=["flat"] * COUNT, base=[0.0] * COUNT,
        roof_height=[0.0] * COUNT, wall_color=[-1] * COUNT, roof_color=[-1] * COUNT, **same,
    )  # fmt: skip
    line = shapely.LineString([(-50, -8), (150, -8)])
    roads = make_table("roads", np.array([line], object), id=[5], kind=["residential"])
    spots = [shapely.Point(x, y) for x, y, _ in shops]
    points = make_table("points", spots, id=np.arange(len(shops)) + 1, kind=["shop"] * len(shops),
                        tags=[text for *_, text in shops])  # fmt: skip
    layout = Layout((-50, -20, 150, 30), buildings, parts, roads, points=points)
    return shell(City("street", Frame(*place), layout, lod=2))


def named(city):
    """Return what stands over each of two fronts per house."""
    ids = np.repeat(city.layout.buildings["id"].to_numpy(np.uint64), 2)
    place = np.column_stack([np.arange(2 * COUNT) * 6.0 + 3.0, np.zeros(2 * COUNT)])
    return shop_names(city, ids + np.tile([0, 1], COUNT).astype(np.uint64), ids, place)[0]


def letters(city):
    rows = city.scene.instances["trims"]
    own = np.array([each.name.startswith(GLYPH) for each in city.scene.prototypes])
    return rows, np.flatnonzero(own[rows.prototype])


def test_a_shop_of_the_map_names_the_nearest_front_of_its_house():
    found = named(street(shops=[(10.0, 4.0, '{"shop": "florist", "name": "Blumen Jette"}')]))
    assert found[1] == "Blumen Jette"
    assert (found == "Blumen Jette").sum() == 1


def test_two_shops_of_one_house_have_a_front_each():
    shops = [(9.5, 1.0, '{"shop": "books", "name": "Ada"}'),
             (10.0, 2.0, '{"shop": "books", "name": "Bea"}')]  # fmt: skip
    assert named(street(shops=shops))[:2].tolist() == ["Bea", "Ada"]


def test_a_name_that_cannot_be_written_gives_way_to_one_in_latin_or_a_word():
    shops = [(2.0, 2.0, '{"shop": "bakery", "name": "مخبز"}'),
             (14.0, 2.0, '{"shop": "tea", "name": "مقهى", "name:en": "Tea House"}')]  # fmt: skip
    found = named(street(shops=shops))
    assert found[0] in ("Bäckerei", "Konditorei", "Backstube")
    assert found[2] == "Tea House"


def test_tags_of_a_house_name_its_fronts():
    found = named(street(tags='{"shop": "clothes", "name": "Mode Eck"}'))
    assert set(found) == {"Mode Eck"}


@pytest.mark.parametrize(
    ("name", "sign"),
    [("Schleudertraum (Ehemals Speed Queen)", "Schleudertraum"), ("Ada;Bea", "Ada"), ("", ""),
     ("セブン-イレブン", "セブン-イレブン"),
     ("横浜家系ラーメン\u3000濃厚とんこつ", "横浜家系ラーメン")],
)  # fmt: skip
def test_remarks_and_what_is_too_long_are_left_out(name, sign):
    assert cut(name) == sign


def test_words_are_in_the_language_of_the_place():
    german, japanese = set(named(street())), set(named(street(place=(35.7, 139.8))))
    assert all(ord(text[0]) > 0x3000 for text in japanese)
    assert all(ord(text[0]) < 0x250 for text in german)


def test_letters_stand_before_their_fronts_and_are_read_from_left_to_right():
    city = facade(street(shops=[(6.0, 1.0, '{"shop": "books", "name": "ÝŽŻ"}')]))
    rows, of = letters(city)
    names = [city.scene.prototypes[k].name for k in rows.prototype[of].tolist()]
    place = {}
    for letter in "ÝŽŻ":
        word = f"{GLYPH}{ord(letter):04x}"
        west = [rows.position[row, 0] for row, name in zip(of.tolist(), names, strict=True)
                if name == word and rows.position[row, 1] > -0.4]  # fmt: skip
        place[letter] = west[0]
    assert place["Ý"] < place["Ž"] < place["Ż"]  # the front looks south, the reader north
    assert (rows.position[of, 1] < 0).all()
    assert (CAP * rows.scale[of, 2] < 0.4).all()


def test_a_house_with_a_shop_on_the_map_has_a_shopfront():
    plain = facade(street(use="apartments"))
    assert plain.scene.instances["shopfronts"].count == 0
    city = facade(street(use="apartments", shops=[(6.0, 2.0, '{"shop": "books"}')]))
    owner = np.unique(city.scene.instances["shopfronts"].owner)
    assert owner.tolist() == [7919]


def test_neon_boards_bear_no_other_letters():
    shops = [(12.0 * k + 6.0, 2.0, '{"shop": "books"}') for k in range(COUNT)]
    city = facade(street(shops=shops))
    lit = neon_signs(city, share=1.0)
    rows, of = letters(lit)
    assert len(letters(city)[1]) > 0
    assert (rows.position[of, 1] < -0.4).all()  # what is left hangs out over the pavement


def test_the_same_seed_gives_the_same_signs_and_another_seed_others():
    city = street(shops=[(6.0, 1.0, '{"shop": "books"}')])
    once = content_hash(facade(city)).total
    assert content_hash(facade(city)).total == once
    assert content_hash(facade(replace(city, seed=9))).total != once
