"""The words of the table agree with what the city's own words make."""

import numpy as np
import pytest

from cityx.assets.styles.palette_tables import GROUPS
from cityx.assets.styles.style_shares import TABLE, of_any_style, speaking_of
from cityx.checks.predicates import words
from cityx.checks.predicates.building_predicates import nearest_word
from cityx.checks.predicates.forms import times_of, weathers_of
from cityx.city import Environment
from cityx.light.sun import sun_of
from cityx.light.weather import weather_of


@pytest.mark.parametrize("word", list(words.WEATHERS))
def test_a_preset_makes_the_weather_it_is_called(word):
    made = weather_of(Environment(), word)
    assert word in weathers_of(made)
    others = set(weathers_of(made)) - {word}
    # Low cloud and thin air may go by two names; nothing falls from either.
    assert not others & {"rain", "storm", "snow", "clear"}


@pytest.mark.parametrize(("said", "meant"), [
    ("noon", "noon"), ("morning", "morning"), ("afternoon", "afternoon"), ("night", "night"),
    ("midnight", "midnight"), ("sunrise", "sunrise"), ("dawn", "dawn"), ("evening", "evening"),
    ("golden hour", "golden_hour"), ("sunset", "sunset"), ("dusk", "dusk"),
    ("blue hour", "blue_hour"),
])  # fmt: skip
@pytest.mark.parametrize("latitude", [35.0, 50.0])
@pytest.mark.parametrize("date", ["2025-03-20", "2025-06-21", "2025-12-21"])
def test_the_citys_words_of_the_day_are_borne_out(said, meant, latitude, date):
    made = sun_of(Environment(), latitude, 10.0, time=said, date=date)
    assert meant in times_of(made)
    assert ("night" in times_of(made)) == (said in ("night", "midnight"))


def test_a_town_of_a_style_speaks_of_it_more_than_of_others():
    usual = {"house": 0.25, "flats": 0.45, "office": 0.15, "retail": 0.1, "civic": 0.05}
    for family, rows in TABLE.items():
        heard = {
            style: sum(
                part * sum(w for k, w in rows[g].items() if k in speaking_of(style).get(g, ()))
                / sum(rows[g].values())
                for g, part in usual.items()
            )
            for style in TABLE
        }  # fmt: skip
        assert heard[family] >= 0.75
        assert heard[family] == max(heard.values())


def test_works_and_churches_speak_of_no_style():
    assert set(of_any_style()) == set(GROUPS) - {"industry", "worship", "shed"}
    assert "warehouse" not in of_any_style()["house"]


@pytest.mark.parametrize(("rgb", "word"), [
    ((0.6, 0.02, 0.01), "red"), ((0.02, 0.3, 0.03), "green"), ((0.03, 0.05, 0.5), "blue"),
    ((0.9, 0.9, 0.9), "white"), ((0.2, 0.2, 0.2), "grey"), ((0.01, 0.01, 0.01), "black"),
    ((0.8, 0.6, 0.02), "yellow"), ((0.14, 0.06, 0.02), "brown"),
])  # fmt: skip
def test_colours_are_called_as_people_call_them(rgb, word):
    assert nearest_word(np.array([rgb]))[0] == word
