import json
import re
from dataclasses import replace
from math import tan

import pytest
from moving_city import CAR, moving

from cityx.blender.client import BlenderResult
from cityx.city import City, Frame, Layout
from cityx.city.content import content_hash
from cityx.city.store import read_city, write_city
from cityx.cli.main import app
from cityx.errors import UsageError
from cityx.light.sun import sun
from cityx.options import RenderOptions
from cityx.projects import views


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
    asked = RenderOptions("street", weather="Snow", time="dusk")
    paths = views.render_views(folder, asked, say=print)
    light = jobs[0].environment
    assert (light.weather, light.date, light.lamps) == ("snow", "2026-12-21", 1.0)
    assert light.sun_elevation < 0 < light.snow
    assert [path.name for path in paths] == ["street_snow_dusk.png"]
    assert content_hash(read_city(folder / "city")).total == content_hash(city).total


def test_without_words_the_light_is_the_citys_own(built):
    folder, city, jobs = built
    paths = views.render_views(folder, RenderOptions("top"), say=print)
    assert jobs[0].environment == city.environment
    assert [path.name for path in paths] == ["top.png"]


def test_unknown_words_are_refused(built):
    with pytest.raises(UsageError, match='"hail" is no weather'):
        views.render_views(built[0], RenderOptions("street", weather="hail"), say=print)
    with pytest.raises(UsageError, match='"tea time" is no time of day'):
        views.render_views(built[0], RenderOptions("street", time="tea time"), say=print)


def test_the_command_takes_both(built):
    from typer.testing import CliRunner

    folder, _, jobs = built
    done = CliRunner().invoke(app, ["render", str(folder), "--weather", "storm dusk"])
    assert done.exit_code == 0, done.output
    assert "street_storm-dusk.png" in done.output
    assert jobs[0].environment.rain > 10


def test_the_view_from_above_fills_a_picture_of_any_form(built):
    folder, _, jobs = built
    views.render_views(folder, RenderOptions("top", size=(400, 400)), say=print)
    camera = jobs[0].renders[0].camera
    seen = 2 * camera.position[2] * tan(camera.hfov / 2)
    assert seen == pytest.approx(50.0)


def test_a_moment_and_a_span_of_frames_reach_blender(built):
    folder, city, jobs = built
    write_city(replace(city, tracks=moving(CAR).tracks), folder / "city")
    views.render_views(folder, RenderOptions("top", moment=2.5), say=print)
    views.render_views(folder, RenderOptions("top", frames="0:100:5"), say=print)
    assert (jobs[0].moment, jobs[0].frames) == (2.5, None)
    assert (jobs[1].moment, jobs[1].frames) == (None, (0, 100, 5))


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        ({"moment": "noon"}, '--moment "noon" is neither a number of seconds nor busiest.'),
        ({"moment": "busiest", "frames": "0:1"}, "--moment shows one moment and --frames a span"),
        ({"moment": 11.0}, "--moment 11 is outside 0 to 10 seconds of the tracks."),
        ({"frames": "0:300"}, "--frames 0:300 is outside 0 to 250, the frames of the tracks."),
        ({"frames": "9:3"}, "--frames 9:3 ends before it begins."),
        ({"frames": "all"}, '--frames "all" is no span of frames such as 0:100 or 0:100:5.'),
        ({"frames": "0:1", "moment": 1.0}, "--moment shows one moment and --frames a span"),
    ],
)
def test_a_moment_outside_the_tracks_is_refused(built, asked, said):
    folder, city, jobs = built
    write_city(replace(city, tracks=moving(CAR).tracks), folder / "city")
    with pytest.raises(UsageError, match=re.escape(said)):
        views.render_views(folder, RenderOptions("top", **asked), say=print)
    assert not jobs


def test_a_city_in_which_nothing_moves_has_no_moment(built):
    folder, _, jobs = built
    with pytest.raises(UsageError, match="Nothing moves in this city"):
        views.render_views(folder, RenderOptions("top", moment=1.0), say=print)
    assert not jobs


def test_each_picture_shows_a_moment_at_which_its_view_is_free(built):
    folder, city, jobs = built
    cut = (1, "car_sedan", "car", "ride", (25.0, 25.0, 0.0), 0.0, 4.0)
    write_city(replace(city, tracks=moving(cut).tracks), folder / "city")
    file = folder / "cameras.json"
    file.write_text(json.dumps({"cameras": {
        "near": {"position": [25.0, 25.0, 1.7], "heading_deg": 90.0, "pitch_deg": 0.0,
                 "hfov_deg": 60.0},
        "far": {"position": [5.0, 45.0, 1.7], "heading_deg": 0.0, "pitch_deg": 0.0,
                "hfov_deg": 60.0},
    }}))  # fmt: skip
    told = []
    views.render_views(folder, RenderOptions(str(file)), say=told.append)
    moments = {request.camera.name: request.moment for request in jobs[0].renders}
    assert moments["far"] is None
    assert 1.5 <= moments["near"] <= 3.0
    assert f"near: shown at {moments['near']:g} s, when the view is free" in told
    views.render_views(folder, RenderOptions(str(file), moment=0.5), say=told.append)
    assert [request.moment for request in jobs[1].renders] == [None, None]
    views.render_views(folder, RenderOptions(str(file), moment="busiest"), say=told.append)
    assert jobs[2].moment is None
    moment = jobs[2].renders[0].moment
    assert moment > moments["near"]  # busy pictures keep more free before the lens
    assert f"near: shown at {moment:g} s, when the view is busiest" in told
