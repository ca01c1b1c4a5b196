"""Goals carry a predicate; the report measures it, and soft ones do not fail a city."""

from dataclasses import replace

from made import made_city

from cityx.checks.report import make_report, report_passed
from cityx.checks.report_html import report_html
from cityx.city import Goal
from cityx.city.store import read_city, write_city

MET = Goal("a river", "n(river) >= 1")
MISSED = Goal("a forest", "n(wood) >= 1", hard=False, weight=0.5)
UNKNOWN = Goal("heavy traffic", "density(vehicle, road) >= 25")


def goals_of(city):
    return {row["goal"]: row for row in make_report(city)["goals"]}


def test_the_report_tells_met_missed_and_unknown():
    rows = goals_of(replace(made_city(), goals=(MET, MISSED, UNKNOWN)))
    assert rows["a river"]["met"] is True
    assert rows["a forest"]["met"] is False
    assert rows["a forest"]["predicate"] == "n(wood) >= 1"
    assert rows["heavy traffic"]["met"] is None
    assert "no vehicle that moves" in rows["heavy traffic"]["evidence"]


def test_only_a_hard_goal_that_is_missed_fails_a_city():
    city = made_city()
    report = make_report(replace(city, goals=(MET, MISSED, UNKNOWN)))
    held = {name: {**check, "ok": True} for name, check in report["checks"].items()}
    rows = [row for row in report["goals"] if "predicate" in row]
    assert report_passed({"checks": held, "goals": rows})
    rows = [{**row, "hard": True} for row in rows]
    assert not report_passed({"checks": held, "goals": rows})


def test_the_page_says_what_cannot_be_told():
    report = make_report(replace(made_city(), goals=(MET, UNKNOWN)))
    page = report_html(report)
    assert "1 cannot be told" in page
    assert "? cannot tell" in page


def test_the_weather_that_was_asked_for_is_measured_in_the_air():
    city = made_city()
    rows = {row["goal"]: row for row in make_report(city, brief={"weather": "clear"})["goals"]}
    assert rows["weather is clear"]["met"] is True
    called = replace(city, environment=replace(city.environment, weather="storm"))
    rows = {row["goal"]: row for row in make_report(called, brief={"weather": "storm"})["goals"]}
    assert rows["weather is storm"]["met"] is False


def test_goals_are_stored_with_all_they_say(tmp_path):
    city = replace(made_city(), goals=(MET, MISSED))
    write_city(city, tmp_path / "city")
    assert read_city(tmp_path / "city").goals == (MET, MISSED)
