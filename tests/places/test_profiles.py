import json
import re

import pytest

from cityx.assets.vehicles.number_plates import PLATES
from cityx.building.shops.shop_names import shop_words
from cityx.city.frame import NOWHERE, Frame
from cityx.errors import InputError, UsageError
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
        ({"shops": {"tonge": "de"}}, '"shops" has no key "tonge". Did you mean "tongue"?'),
        ({"streets": {"lane_widths": {"primari": 3}}}, '"primari". Did you mean "primary"'),
        ({"inherits": "germny"}, 'There is no profile of a place "germny".'),
        ({"drive": "up"}, '"drive" must be "left" or "right", not \'up\'.'),
        ({"painting": {"dashes": [1]}}, '"dashes" must have 2 entries, not 1.'),
        ({"painting": {"zebras": 1}}, '"zebras" must be true or false, not 1.'),
        ({"streets": {"lane_widths": {"primary": -3}}}, "must be a number from 0 on, not -3."),
        ({"streets": 3}, '"streets" must be a table, not 3.'),
        ({"within": [{"box": [1, 2]}]}, '"box" must be [south, west, north, east] in degrees.'),
        ({"within": [{"box": [0, 0, 1, 1], "shop": {}}]}, '"shop". Did you mean "shops"'),
        ({"within": 3}, '"within" must be a list of tables'),
        ({"inherits": 3}, '"inherits" must be the name of a profile.'),
    ],
)  # fmt: skip
def test_what_no_profile_can_say_is_refused_in_one_sentence(said, fault):
    with pytest.raises(UsageError, match=re.escape(fault)) as raised:
        own(said)
    assert "\n" not in str(raised.value)


def test_profiles_that_inherit_each_other_are_refused(monkeypatch):
    circle = {"one": {"inherits": "two"}, "two": {"inherits": "one"}}
    monkeypatch.setattr(profiles, "_written", circle.__getitem__)
    with pytest.raises(UsageError, match='in a circle: "one" inherits "two" inherits "one"'):
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
