"""Texts that are no English, empty ones and far too long ones: a clear question or a city."""

import time

import pytest

from cityx.agents.briefs import NOT_ENGLISH, read_request
from cityx.language.brief import Clarify
from cityx.options import BuildOptions

FOREIGN = {
    "German": "Eine kleine Stadt mit einem Fluss und vielen Bäumen am Abend",
    "French": "Un petit village avec une église et une rivière, sous la neige",
    "Spanish": "Una ciudad pequeña con un parque grande y lluvia",
    "Finnish": "Pieni kaupunki, jossa on joki ja paljon puita, sataa lunta",
    "Russian": "Небольшой город с рекой и парком",
    "Chinese": "一个有河流和高楼的城市,下雨的夜晚",
}
ENGLISH = (
    "A quiet town with a plaza",
    "Something like Töölö in Helsinki, with tramways and façades of granite",
    "A Gründerzeit quarter like Prenzlauer Berg, four storeys, in the snow",
    "Cyberpunk alley, cramped, holographic ads, steam from vents, 2 am",
    "Blade Runner vibes",
)


def read(text, **more):
    return read_request(BuildOptions(text=text), **more)


@pytest.mark.parametrize("base", [False, True])
@pytest.mark.parametrize("text", FOREIGN.values(), ids=FOREIGN.keys())
def test_another_language_is_asked_about(text, base):
    with pytest.raises(Clarify) as told:
        read(text, base=base)
    assert NOT_ENGLISH in str(told.value)


@pytest.mark.parametrize("text", ENGLISH)
def test_english_with_foreign_names_is_read(text):
    read(text)


@pytest.mark.parametrize("text", ["", "   ", "\n\t", "."])
def test_an_empty_text_asks_for_the_usual_city(text):
    usual = read("").slots
    assert {key: value for key, value in read(text).slots.items() if value} == {
        key: value for key, value in usual.items() if value
    }


def test_ten_thousand_words_are_read_in_seconds():
    begin = time.perf_counter()
    request = read("A town with a river. " + "It has trees and houses by the water. " * 1250)
    assert time.perf_counter() - begin < 10.0
    assert "river" in dict(request.slots).get("element", ())
    assert any("were read" in note for note in request.notes)
