"""In a town of flats alone, houses are the buildings in which people live."""

from dataclasses import replace

import pytest

from cityx.agents.commands import meaning_of
from cityx.agents.planning.planner import OfflinePlanner
from cityx.city import City, Frame, Layout
from cityx.language import read_brief
from cityx.language.references.dwellings import with_dwellings
from cityx.protocol.catalogue import known_records
from cityx.protocol.registry import registry
from cityx.town.town import town


def made(zone):
    city = City("Town", Frame(50.0, 10.0), Layout((0.0, 0.0, 1.0, 1.0)), seed=3)
    return town(city, width=200.0, depth=200.0, pattern="grid", zone=zone)


@pytest.mark.parametrize("text", ["Make the houses white.", "Paint half of the houses red."])
def test_houses_of_a_town_of_flats_are_its_flats(text):
    brief = with_dwellings(read_brief(text, base=True), made("midrise"))
    assert [edit.target.kind for edit in brief.edits] == ["apartment"]
    assert any("use=flats" in goal.predicate for goal in brief.goals)
    assert any("blocks of flats are taken" in note.text for note in brief.notes)


def test_where_there_are_houses_they_are_meant():
    brief = read_brief("Make the houses white.", base=True)
    assert with_dwellings(brief, made("suburb")) == brief


def test_other_buildings_are_not_touched():
    brief = read_brief("Make the church white.", base=True)
    assert with_dwellings(brief, made("midrise")) == brief


def test_a_command_on_the_finished_city_means_them_as_well():
    planner = OfflinePlanner(known_records(registry()))
    city = replace(made("midrise"))
    assert not meaning_of("make the houses white", city, planner).faults
