import json
import re

import pytest

from cityx.assets.vehicles.number_plates import PLATES
from cityx.building.shops.shop_names import shop_words
from cityx.city.frame import NOWHERE, Frame
from cityx.errors import InputError, UsageError, nearest
from cityx.places import profiles
from cityx.places.profiles import (
    climate_of,
    keeps_left,
    place_text,
    profile_named,
    profile_names,
    profile_of,
)
from cityx.projects.place_words import check_words
from cityx.sources.features.road_features import cross_section


def own(said, at=(50.0, 10.0)):
    return profile_of(Frame(*at, json.dumps(said)))


@pytest.mark.parametrize("name", profile_names())
def test_every_profile_names_things_that_exist(name):
    check_words(profile_named(name))


def test_a_profile_has_what_it_says_and_else_what_it_inherits():
    german = profile_named("de")
    assert german.lineage == ("de", "central_europe", "europe", "world")
    assert german.shops.tongue == "de"
    assert german.land.paving["sidewalk"] == "slab_walk"
    assert german.vehicles.plates == "eu"
    assert german.streets.lane_widths == profile_named("world").streets.lane_widths


def test_tables_are_inherited_word_by_word_and_weights_as_a_whole():
    found = own({"inherits": "gb", "furniture": {"rates": {"bench": 2.0}},
                 "vehicles": {"cars": {"sedan": 1.0}}})  # fmt: skip
    assert found.furniture.rates["telephone"] == 8.0
    assert found.furniture.rates["bench"] == 2.0
    assert found.vehicles.cars == {"sedan": 1.0}


def test_one_line_of_data_changes_the_lanes_of_germany(monkeypatch):
    def lane(name):
        streets = profile_named(name).streets
        tags = {"highway": "primary"}
        return cross_section(tags, streets, town=True, dense=True)[4]

    read = profiles._read

    def edited(name):
        table = dict(read(name))
        if name == "de":
            table["streets"] = {"lane_widths": {"primary": 3.5}}  # the line
        return table

    assert (lane("de"), lane("fr")) == (3.25, 3.25)
    monkeypatch.setattr(profiles, "_read", edited)
    profile_named.cache_clear()
    try:
        assert (lane("de"), lane("fr")) == (3.5, 3.25)
    finally:
        profile_named.cache_clear()


def test_parts_of_a_country_end_at_its_border():
    assert profile_of(Frame(46.52, 6.63)).shops.tongue == "fr"  # Lausanne
    assert profile_of(Frame(47.37, 8.54)).shops.tongue == "de"  # Zurich
    assert profile_of(Frame(45.76, 4.84)).shops.tongue == "fr"
    box = {"box": [49.0, 9.0, 51.0, 11.0], "drive": "left"}
    assert own({"within": [box]}).drive == "left"
    assert own({"within": [box]}, at=(52.0, 10.0)).drive == "right"


def test_a_city_elsewhere_has_the_trees_of_the_profile_that_it_was_given():
    assert climate_of(Frame(52.5, 13.4, "jp")) == "japan"
    assert climate_of(Frame(35.7, 139.7, "jp")) == "japan"
    assert climate_of(Frame(26.2, 127.7, "jp")) == "warm"
    assert keeps_left(Frame(52.5, 13.4, "jp"))
    assert not keeps_left(Frame(52.5, 13.4, "jp"), "right")


def test_a_place_asked_for_does_not_move_a_city():
    assert Frame(50.0, 10.0, "jp") == NOWHERE


@pytest.mark.parametrize(
    ("said", "fault"),
    [
        ({"shops": {"tonge": "de"}}, 'shops: there is no key "tonge". Did you mean "tongue"?'),
        ({"streets": {"lane_widths": {"primari": 3}}},
         'streets, lane_widths: there is no key "primari". Did you mean "primary"'),
        ({"inherits": "germny"}, 'inherits: there is no profile of a place "germny".'),
        ({"drive": "up"}, "drive: 'up' is none of 'left', 'right'."),
        ({"painting": {"dashes": [1]}}, "painting, dashes: [1] is not an array of 2."),
        ({"painting": {"zebras": 1}}, "painting, zebras: 1 is not of type true or false."),
        ({"streets": {"lane_widths": {"primary": -3}}},
         "streets, lane_widths.primary: -3.0 is not a number from 0 on."),
        ({"streets": {"kerb_occupancy": 1.5}}, "1.5 is not a number from 0 to 1."),
        ({"streets": 3}, "streets: 3 is not a table of lane_widths, walk_widths"),
        ({"lineage": ["de"]}, 'there is no key "lineage".'),
        ({"within": [{"box": [1, 2]}]}, "within[0], box: [1, 2] is not an array of 4."),
        ({"within": [{"box": [0, 0, 1, 1], "shop": {}}]},
         'within[0]: there is no key "shop". Did you mean "shops"'),
        ({"within": [{"box": [0, 0, 1, 1], "trees": {"park": {"cold": {}}}}]},
         'within[0], trees, park: there is no key "cold".'),
        ({"within": [{}]}, 'within[0]: the key "box" is missing.'),
        ({"within": 3}, "within: 3 is not an array."),
        ({"inherits": 3}, "inherits: 3 is not of type text."),
    ],
)  # fmt: skip
def test_what_no_profile_can_say_is_refused_in_one_sentence(said, fault):
    with pytest.raises(InputError, match=re.escape(fault)) as raised:
        own(said)
    assert "\n" not in str(raised.value)


def test_all_faults_of_a_file_are_told_at_once(tmp_path):
    file = tmp_path / "my.toml"
    file.write_text(
        'inherits = "germany"\n'
        "[streets]\n"
        "lane_width = 3\n"
        'single_width = "wide"\n'
        "[streets.walk_widths]\n"
        "primary = -1.5\n"
    )
    with pytest.raises(InputError) as raised:
        place_text(str(file))
    hint = nearest("germany", profile_names())
    assert str(raised.value).splitlines() == [
        'my.toml, streets: there is no key "lane_width". Did you mean "lane_widths" or '
        '"single_width" or "walk_widths"?',
        "my.toml, streets, single_width: 'wide' is not of type number.",
        "my.toml, streets, walk_widths.primary: -1.5 is not a number from 0 on.",
        f'my.toml, inherits: there is no profile of a place "germany".{hint}',
    ]


def test_profiles_that_inherit_each_other_are_refused(monkeypatch):
    circle = {"one": {"inherits": "two"}, "two": {"inherits": "one"}}
    monkeypatch.setattr(profiles, "_written", circle.__getitem__)
    with pytest.raises(InputError, match='in a circle: "one" inherits "two" inherits "one"'):
        profiles._lineage("one", circle["one"])


def test_words_that_name_nothing_are_told_together():
    said = {"buildings": {"family": "roman"}, "vehicles": {"cars": {"sedann": 1.0}},
            "painting": {"stop_word": "STÖP"},
            "trees": {"street": {"warm": {"plane": 0.0}}}}  # fmt: skip
    with pytest.raises(UsageError) as raised:
        check_words(own(said))
    told = str(raised.value)
    assert 'buildings.family knows no "roman"' in told
    assert 'vehicles.cars knows no "sedann". Did you mean "sedan"' in told
    assert 'painting.stop_word knows no "Ö"' in told
    assert "trees.street.warm needs a weight above 0." in told


def test_a_file_of_the_user_is_a_profile(tmp_path):
    file = tmp_path / "my.toml"
    file.write_text('inherits = "de"\n[streets.lane_widths]\nprimary = 3.5\n')
    found = profile_of(Frame(48.0, 11.0, place_text(str(file))))
    assert found.lineage[:2] == ("own", "de")
    assert found.streets.lane_widths["primary"] == 3.5
    file.write_text("inherits = ")
    with pytest.raises(InputError, match=r"my.toml is no profile of a place"):
        place_text(str(file))
    with pytest.raises(InputError, match=r"none.toml is no profile of a place"):
        place_text(str(tmp_path / "none.toml"))
    with pytest.raises(UsageError, match=r'no profile of a place "\.\./de"'):
        place_text("../de")


def test_plates_and_languages_of_all_profiles_exist():
    used = [profile_named(name) for name in profile_names()]
    assert {each.vehicles.plates for each in used} == set(PLATES) - {"jk"}
    tongues = {each.shops.tongue for each in used} - {""}
    assert tongues == set(shop_words().words) - {"world"}
