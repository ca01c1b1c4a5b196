import json
from dataclasses import replace

import numpy as np
import pytest
import shapely

from cityx.assets.styles import style_shares
from cityx.assets.styles.style_shares import speaking_of
from cityx.building import selection
from cityx.building.catalogue import NAMES, generators
from cityx.building.selection import admitted, choose_generators
from cityx.city import Layout, make_table
from cityx.places.profiles import profile_named


def town(count=400, *, use="yes", levels=4, size=(14.0, 12.0), place="urban", tags="{}", gap=6.0):
    x = np.arange(count) * (size[0] + gap)
    shapes = shapely.box(x, 0, x + size[0], size[1])
    ids = np.arange(1, count + 1, dtype=np.uint64) * 7919
    many = [levels] * count
    buildings = make_table("buildings", shapes, id=ids, use=[use] * count, levels=many,
                           height=[3.2 * levels] * count, place=[place] * count,
                           tags=[tags] * count)  # fmt: skip
    parts = make_table("parts", shapes, id=ids, building=ids, use=[use] * count, levels=many,
                       top=[3.2 * levels] * count, walls=[True] * count, wall_color=[-1] * count,
                       roof_color=[-1] * count, roof_shape=["flat"] * count)  # fmt: skip
    return Layout((0, 0, 5000, 20), buildings, parts)


BRITISH = profile_named("gb")
PLACES = ("de", "nl", "fi", "ru", "fr", "jp", "cn")


def share(layout, name, place="europe", **options):
    options["place"] = profile_named(place)
    return float((choose_generators(layout, 1, **options) == name).mean())


def test_every_generator_of_the_tables_is_in_the_catalogue():
    rows = [row for family in style_shares.TABLE.values() for row in family.values()]
    rows += [*style_shares.ALWAYS.values(), *style_shares.STYLE_WORDS.values()]
    rows += [*selection.PLACES.values()]
    rows += [row for name in PLACES for row in profile_named(name).buildings.generators.values()]
    named = {name for row in rows for name in row} | set(selection.PURPOSE.values())
    assert named <= set(NAMES)
    assert set(NAMES) - named <= {"shed"}


@pytest.mark.parametrize(
    ("tags", "use", "name"),
    [
        ({"amenity": "place_of_worship", "religion": "muslim"}, "yes", "mosque"),
        ({"amenity": "place_of_worship"}, "yes", "church"),
        ({"religion": "buddhist"}, "church", "temple"),
        ({"amenity": "school"}, "yes", "school"),
        ({"amenity": "fuel"}, "roof", "petrol_station"),
        ({}, "hospital", "hospital"),
        ({}, "train_station", "station_hall"),
        ({"amenity": "townhall"}, "public", "townhall"),
    ],
)
def test_purpose_decides_first(tags, use, name):
    layout = town(20, use=use, tags=json.dumps(tags), size=(40.0, 25.0), levels=3)
    assert share(layout, name) == 1.0


def test_a_tower_is_no_palazzo_and_a_hut_no_tower():
    tall = set(choose_generators(town(levels=30, size=(30, 30)), 1).tolist())
    small = set(choose_generators(town(levels=1, size=(4, 5)), 1).tolist())
    assert tall & {"glass_tower", "setback_skyscraper", "panel_slab", "mixed_use", "asian_block"}
    assert not tall & {"palazzo", "suburban_house", "georgian_terrace"}
    assert small == {"shed"}


def test_the_region_and_the_style_word_shift_the_choice():
    layout = town(use="apartments")
    assert share(layout, "georgian_terrace", place="gb") > 0.4
    assert share(layout, "georgian_terrace", place="cn") == 0.0
    more = share(layout, "brutalist", style="brutalist", place="gb")
    assert more > 2 * share(layout, "brutalist", place="gb") + 0.2


def test_berlin_is_not_built_of_paris():
    layout = town(use="apartments")
    assert share(layout, "palazzo", place="de") == 0.0
    assert share(layout, "perimeter_block", place="de") > 0.6
    assert share(layout, "palazzo", place="fr") > 0.4
    asked = share(layout, "palazzo", place="de", style="haussmann")
    assert asked > 0.6  # a style word of the brief overrules the region


def test_houses_of_a_row_mostly_share_a_design():
    row = choose_generators(town(gap=0.0, size=(6.0, 10.0), use="house", levels=2), 3,
                            place=BRITISH)  # fmt: skip
    free = choose_generators(town(gap=5.0, size=(6.0, 10.0), use="house", levels=2), 3,
                             place=BRITISH)  # fmt: skip
    assert (row[1:] == row[:-1]).mean() > (free[1:] == free[:-1]).mean() + 0.1


def test_flats_side_by_side_share_no_draw():
    size = (14.0, 12.0)
    block, free = (
        choose_generators(town(600, gap=gap, size=size, use="apartments"), 3) for gap in (0.0, 5.0)
    )
    same = [(one[1:] == one[:-1]).mean() for one in (block, free)]
    assert same[0] < same[1] + 0.15  # slabs of estates alone stand in rows


def test_a_style_that_is_asked_for_outweighs_the_others():
    layout = town(600, use="apartments")
    own = list(speaking_of("european")["flats"])
    usual, asked = (
        np.isin(choose_generators(layout, 1, style=style), own).mean()
        for style in ("", "european")
    )  # fmt: skip
    assert 0.75 < usual < asked - 0.05
    assert asked > 0.92


def test_the_choice_does_not_depend_on_the_order_or_the_other_buildings():
    layout = town(60)
    whole = choose_generators(layout, 5)
    half = replace(layout, buildings=layout.buildings[:20].copy(), parts=layout.parts[:20].copy())
    assert (choose_generators(half, 5) == whole[:20]).all()


def test_what_is_chosen_is_admitted():
    layout = town(200, levels=6)
    found = choose_generators(layout, 2)
    columns = [list(generators()).index(name) for name in found.tolist()]
    assert admitted(layout)[np.arange(len(found)), columns].all()


def test_slabs_of_estates_seldom_stand_in_a_row():
    free = share(town(2000, levels=6, size=(20.0, 14.0)), "panel_slab", place="ru")
    row = town(2000, levels=6, size=(20.0, 14.0), gap=0.0)
    assert free > 0.3
    assert share(row, "panel_slab", place="ru") < 0.6 * free


def test_flats_of_japan_are_not_those_of_hong_kong():
    layout = town(use="apartments", levels=6)
    assert share(layout, "japanese_midrise", place="jp") > 0.5
    assert share(layout, "asian_block", place="jp") == 0.0
    assert share(layout, "japanese_midrise", place="cn") == 0.0
