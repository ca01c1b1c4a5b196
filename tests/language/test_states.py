"""States of things, months, a few towers, and lights of several: no wish of the whole town."""

import pytest

from cityx.language import read_brief


def said(text):
    return dict(read_brief(text).items())


@pytest.mark.parametrize(
    ("text", "word", "kind"),
    [
        ("Abandoned rusty cars across the road", "Abandoned", "vehicle"),
        ("A village with some garages and a boarded-up pub", "boarded", ""),
        ("A town with a cyclist on a one-way street", "one-way street", ""),
        ("A crossing with its traffic lights out", "out", ""),
    ],
)
def test_the_state_of_a_thing_is_named(text, word, kind):
    brief = read_brief(text)
    assert word in brief.words_unread
    assert kind not in {slot.value for slot in brief.negated}
    assert not {"building.material", "garage.material", "roads.oneway"} & said(text).keys()


def test_a_town_without_people_is_without_people():
    assert {slot.value for slot in read_brief("An abandoned village").negated} >= {"pedestrian"}


def test_a_few_towers_are_not_the_houses_of_a_town():
    items = said("5 or 6 tall stone towers, a walled hill town with a well")
    assert items["tower.material"] == "stone"
    assert not {"building.material", "building.height", "building.count.min"} & items.keys()


def test_a_month_is_a_date():
    items = said("A village at 7 in the evening in November")
    assert (items["date"], items["season"]) == ("11-15", "autumn")


def test_blue_lights_are_of_all_who_have_some():
    items = said("An ambulance and two fire engines with blue lights in a town")
    assert items["ambulance.beacons"] == items["fire_engine.beacons"] == "on"


def test_lit_windows_in_some_houses_are_no_share_of_houses():
    items = said("A village at night, lit windows in a tenth of the houses")
    assert items["windows.lit"] == 0.1
    assert "house.share" not in items


def test_more_parked_cars_than_the_site_has_room_for_are_a_contradiction():
    (conflict,) = read_brief("A town of 100 m x 100 m with at least 2,000 parked cars").conflicts
    assert "750" in conflict.text


def test_capitals_tell_a_country():
    assert said("US suburb with curvy streets")["style"] == "american"
    assert "style" not in said("A suburb for us with curvy streets")


@pytest.mark.parametrize(
    "text", ["Remove the trees on the closed streets.", "Paint the houses on the widened street."]
)
def test_streets_in_a_state_are_not_all_streets(text):
    assert read_brief(text, base=True).questions


def test_what_stands_in_rows_on_some_streets_is_not_on_all():
    assert "nature.spacing" not in said("A town with street trees every 8 m on the closed streets")
