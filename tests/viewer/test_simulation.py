"""`cityx sim --view`: a run of the simulator that pages look on, step by step."""

import json
import re
import subprocess
import sys
import time

import numpy as np
import pytest
import requests
from browsing import NO_BROWSER, WAIT_MS, opened, until
from page_server import TOKEN, serving

pytest.importorskip("gymnasium", reason="the simulator needs the extra sim")

from cityx.agents.loop import quiet
from cityx.sim.kernels.tables import ALIVE, HEADING, X, Y
from cityx.sim.sensors import Senses
from cityx.sim.tasks import engine_of
from cityx.viewer.simulation import EACH, LEVEL, Simulation

WITH = {"Authorization": f"Bearer {TOKEN}"}
OPTIONS = {"goal_m": 60.0, "traffic": 4}


@pytest.fixture(scope="module")
def place(built_town):
    return built_town(lod=1)


def simulation(place, **more):
    engine = engine_of("drive", 1, 1, {"place": place, **OPTIONS})
    told = {"episodes": 2, "seed": 3, "say": quiet} | more
    return Simulation(engine, "CityX/Drive-v0", **told)


def test_a_step_tells_what_the_engine_and_its_sensors_tell(place):
    engine = engine_of("drive", 1, 1, {"place": place, **OPTIONS})
    engine.seed(3)
    engine.begin()
    senses = Senses(engine, ("lidar",), together=False)
    run = simulation(place)
    for _ in range(30):
        engine.step(engine.act_by_rule())
        run.step()
    senses.read()
    told = json.loads(run.news)
    real, alive = engine.state.real[0], np.flatnonzero(engine.state.whole[0, ALIVE])
    assert [mover[0] for mover in told["movers"]] == ["agent", *["vehicle"] * (len(alive) - 1)]
    for row, name in ((X, 1), (Y, 2), (HEADING, 4)):
        shown = [mover[name] for mover in told["movers"]]
        assert np.allclose(shown, real[row, alive], atol=0.006)
    assert np.allclose(told["rays"]["metres"], senses.one(0, 0)[LEVEL, ::EACH] * 50.0, atol=0.006)
    assert np.allclose(told["route"], engine.route_of(0, 0), atol=0.006)
    assert told["time"] == 3.0


def test_the_same_seed_gives_the_same_news_and_it_pauses_after_its_episodes(place):
    lines = []
    runs = [simulation(place), simulation(place, say=lines.append)]
    for _ in range(4000):
        for run in runs:
            run.step()
        one, other = (run.news for run in runs)
        assert one == other
        if json.loads(one)["done"]:
            break
    told = json.loads(one)
    assert told["paused"]
    over = [event for event in told["events"] if event["over"]]
    assert [event["episode"] for event in over] == [1, 2]
    assert [event["number"] for event in told["events"]] == list(
        range(told["events"][0]["number"], told["events"][-1]["number"] + 1)
    )
    assert len([line for line in lines if re.search(r"\d+% of \d+ m$", line)]) == 2
    runs[0].steer(paused=False)
    assert not json.loads(runs[0].news)["done"]


def test_pages_look_on_with_the_token_pause_it_and_change_nothing(place, page):  # noqa: ARG001
    with simulation(place) as run, serving(place, simulation=run) as port:
        url = f"http://127.0.0.1:{port}"
        assert requests.get(f"{url}/simulation", timeout=30).status_code == 401
        assert requests.get(f"{url}/scene.json", headers=WITH, timeout=60).json()["simulated"]
        assert json.loads(run.news)["time"] == 0  # it waits for somebody who looks on

        def steer(**how):
            return requests.post(f"{url}/simulation", json=how, headers=WITH, timeout=30).json()

        with requests.get(f"{url}/simulation", headers=WITH, stream=True, timeout=30) as news:
            lines = (line for line in news.iter_lines(chunk_size=1) if line.startswith(b"data"))
            times = [json.loads(next(lines)[6:])["time"] for _ in range(5)]
        assert times == sorted(set(times))
        assert times[-1] > 0
        assert steer(paused=True)["status"] == "ok"
        time.sleep(0.3)
        before = json.loads(run.news)["time"]
        time.sleep(0.4)
        assert json.loads(run.news)["time"] == before
        assert steer(paused="yes")["status"] == "rejected"
        assert steer(speed=99.0)["status"] == "ok"
        assert json.loads(run.news)["speed"] == 10.0
        refused = requests.post(
            f"{url}/tools/run_brief", json={"text": "remove the church"}, headers=WITH, timeout=30
        ).json()
        assert "has no tool of this name" in refused["message"]
    with serving(place) as port:
        none = requests.get(f"http://127.0.0.1:{port}/simulation", headers=WITH, timeout=60)
        assert "cityx sim DIR --view" in none.json()["message"]


def test_the_command_serves_it_and_refuses_to_keep_what_it_shows(place, page):  # noqa: ARG001
    command = [sys.executable, "-m", "cityx.cli", "sim", str(place), "--view", "--no-browser"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        lines = [process.stdout.readline() for _ in range(2)]
        address, _, token = lines[1].split()[-1].partition("#token=")
        told = requests.get(
            f"{address}scene.json", headers={"Authorization": f"Bearer {token}"}, timeout=60
        ).json()
        process.terminate()
    assert "of lanes" in lines[0]
    assert told["simulated"]
    done = subprocess.run([*command, "--picture", "x.gif"], capture_output=True, text=True)
    assert done.returncode
    assert "--view shows a run and keeps none" in done.stderr


class TestPage:
    pytestmark = NO_BROWSER

    def test_agents_rays_route_and_events_are_shown_live(self, browser, place, page):  # noqa: ARG002
        with simulation(place, episodes=1) as run, serving(place, simulation=run) as port:
            shown = opened(browser, f"http://127.0.0.1:{port}/#token={TOKEN}")
            assert shown.is_hidden("#desk")
            state = "cityx.simulation.last && [cityx.simulation.last.time, cityx.simulation.at.x]"
            first = until(shown, state, lambda found: found and found[0] > 0)
            until(shown, state, lambda now: now[0] > first[0] + 1 and now[1] != first[1])
            counts = shown.evaluate(
                """() => { const s = cityx.simulation; return [s.bodies.vehicle.count,
                s.rays.geometry.getAttribute('position').count / 2,
                s.route.geometry.getAttribute('position').count]; }"""
            )
            assert counts[0] > 1
            assert counts[1] == 90
            assert counts[2] > 2
            target = shown.evaluate("cityx.eye.controls.target.distanceTo(cityx.simulation.at)")
            assert target < 60  # it is followed
            shown.select_option("#speed", "4")
            shown.wait_for_selector("#events li", timeout=WAIT_MS)
            shown.wait_for_selector("#pause:has-text('Run more')", timeout=WAIT_MS)
            assert "goal" in shown.inner_text("#events")
            assert shown.faults == []
            shown.context.close()
