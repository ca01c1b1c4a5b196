from math import tan

import pytest

from cityx.agents import views
from cityx.blender.client import BlenderResult
from cityx.city import City, Frame, Layout
from cityx.city.content import content_hash
from cityx.city.store import read_city, write_city
from cityx.cli import app
from cityx.errors import UsageError
from cityx.plugins.background.sun import sun


@pytest.fixture
def built(tmp_path, monkeypatch):
    """A stored city and the jobs that would have gone to Blender."""
    city = City("c", Frame(52.5, 13.4), Layout((0.0, 0.0, 50.0, 50.0)),
                stages_done=frozenset({"layout"}))  # fmt: skip
    city = sun(city, time="2026-12-21 noon")
    write_city(city, tmp_path / "city")
    jobs = []

    def worker(job, **_):
        jobs.append(job)
        return BlenderResult(tuple(r.path for r in job.renders), {}, 0.0, "CPU", 0, "")

    monkeypatch.setattr(views, "run_worker", worker)
    return tmp_path, city, jobs


def test_another_weather_and_hour_reach_the_picture_and_leave_the_city(built):
    folder, city, jobs = built
    paths = views.render_views(folder, "street", weather="Snow", time="dusk", say=print)
    light = jobs[0].environment
    assert (light.weather, light.date, light.lamps) == ("snow", "2026-12-21", 1.0)
    assert light.sun_elevation < 0 < light.snow
    assert [path.name for path in paths] == ["street_snow_dusk.png"]
    assert content_hash(read_city(folder / "city")).total == content_hash(city).total


def test_without_words_the_light_is_the_citys_own(built):
    folder, city, jobs = built
    paths = views.render_views(folder, "top", say=print)
    assert jobs[0].environment == city.environment
    assert [path.name for path in paths] == ["top.png"]


def test_unknown_words_are_refused(built):
    with pytest.raises(UsageError, match='"hail" is no weather'):
        views.render_views(built[0], "street", weather="hail", say=print)
    with pytest.raises(UsageError, match='"tea time" is no time of day'):
        views.render_views(built[0], "street", time="tea time", say=print)


def test_the_command_takes_both(built):
    from typer.testing import CliRunner

    folder, _, jobs = built
    done = CliRunner().invoke(app, ["render", str(folder), "--weather", "storm dusk"])
    assert done.exit_code == 0, done.output
    assert "street_storm-dusk.png" in done.output
    assert jobs[0].environment.rain > 10


def test_the_view_from_above_fills_a_picture_of_any_form(built):
    folder, _, jobs = built
    views.render_views(folder, "top", size=(400, 400), say=print)
    camera = jobs[0].renders[0].camera
    seen = 2 * camera.position[2] * tan(camera.hfov / 2)
    assert seen == pytest.approx(50.0)
