from dataclasses import asdict, replace

import pytest

from cityx.checks.predicates.change_predicates import changed_ids
from cityx.edit.air import air
from cityx.edit.land.lamps import lamps
from cityx.edit.moment import clock_text, moment
from cityx.errors import UsageError
from cityx.light.weather import weather


def test_an_hour_later_only_the_light_differs(park):
    later = moment(park, later=1.0)
    assert later.environment.hour == pytest.approx(park.environment.hour + 1.0)
    assert later.environment.weather == park.environment.weather
    assert not len(changed_ids(park, later))
    assert later.scene is park.scene
    assert moment(later, later=-1.0).environment == park.environment


def test_the_day_changes_at_midnight(park):
    late = moment(park, time="23:30")
    assert moment(late, later=1.0).environment.date == "2025-06-22"
    assert moment(late, later=1.0).environment.hour == pytest.approx(0.5)
    assert moment(park, later=-24.0).environment.date == "2025-06-20"


def test_a_time_keeps_the_day_and_a_season_keeps_the_hour(park):
    winter = moment(park, season="winter")
    assert winter.environment.date == "2025-01-10"
    assert winter.environment.hour == park.environment.hour
    assert moment(winter, time="noon").environment.date == "2025-01-10"


def test_winter_is_in_july_south_of_the_equator(park):
    south = replace(park, frame=replace(park.frame, latitude=-33.0))
    assert moment(south, season="winter").environment.date == "2025-07-10"


def test_nothing_to_set_is_refused(park):
    with pytest.raises(UsageError, match="Say a time"):
        moment(park)


@pytest.mark.parametrize(("hour", "text"), [(0.0, "00:00"), (6.5, "06:30"), (23.999, "00:00")])
def test_hours_are_written_as_clocks(hour, text):
    assert clock_text(hour) == text


def test_fog_twice_as_thick_lets_one_see_half_as_far_and_back(park):
    foggy = weather(park, preset="fog")
    thick = air(foggy, weather="fog", factor=2.0)
    assert thick.environment.visibility == pytest.approx(foggy.environment.visibility / 2)
    back = air(thick, weather="fog", factor=0.5)
    assert asdict(back.environment) == asdict(foggy.environment)


def test_wet_streets_under_a_clear_sky(park):
    wet = air(park, wetness=0.8)
    assert wet.environment.wetness == 0.8
    assert wet.environment.cloud_cover == park.environment.cloud_cover


@pytest.mark.parametrize("kind", ["rain", "snow", "fog"])
def test_more_of_what_there_is_none_of_is_refused(park, kind):
    with pytest.raises(UsageError, match=f"There is no {kind} to begin with"):
        air(park, weather=kind)


def test_lamps_go_on_and_off_alone_and_by_the_hour_again(park):
    lit = lamps(park, state="on")
    assert lit.environment == replace(park.environment, lamps=1.0)
    assert lamps(lit, state="off").environment == park.environment
    assert moment(lamps(moment(park, time="23:00"), state="off"), time="23:30").environment.lamps
    assert lamps(park, state="off").environment == park.environment
    assert "The lamps are off already." in lamps(park, state="off").notes
