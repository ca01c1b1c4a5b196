"""The page in time and weather: lamps in step with the traffic, rain and snow that fall and lie."""

import numpy as np
import pytest
from browsing import NO_BROWSER, opened, until
from copies import copy_of
from page_server import TOKEN, serving

from cityx.city.signals import STATE, people_see, poles_of, sides_of, vehicles_see
from cityx.city.store import read_view
from cityx.ids import id_text
from cityx.projects.desk import Desk
from cityx.protocol.gate import Call
from cityx.viewer.lamps import lamps_bytes

pytestmark = NO_BROWSER
# What poles show that are drawn or not, by their ids.
SHOWN = "() => Object.fromEntries(cityx.lamps.lit)"
AT = """(moments) => moments.map((moment) => {
  cityx.lamps.at(moment); return Object.fromEntries(cityx.lamps.lit); })"""
# What the instances of poles are told, from above, where all of them are in sight.
DRAWN = """() => { const found = [], page = window.cityx, eye = page.eye;
  eye.flight = null; eye.plan(page.told.extent); eye.step(1, performance.now() + 1e6);
  const least = page.city.rows.least; page.city.rows.least = 0; page.choose();
  for (const forms of page.city.rows.forms.values()) for (const form of forms)
    form.drawn.forEach(({ block }, at) => { if (block.prototype.startsWith('traffic_signal'))
      found.push([...form.rooms.array.slice(at * 2, at * 2 + 2)]); });
  page.city.rows.least = least; page.choose();
  return found; }"""


@pytest.fixture(scope="module")
def driven(built_town, tmp_path_factory):
    """The town with traffic, in rain."""
    folder = copy_of(built_town(lod=2), tmp_path_factory.mktemp("driven") / "town")
    with Desk(folder) as desk:
        desk.change([Call("dynamic/traffic-v1", {})])
        desk.change([Call("background/weather-v1", {"preset": "rain"})])
    return folder


@pytest.fixture(scope="module")
def shown(browser, driven, page):
    with serving(driven) as port:
        page = opened(browser, f"http://127.0.0.1:{port}/#token={TOKEN}")
        yield page
        page.context.close()


def seen_at(view, moment):
    """What poles show by the city's own functions, as the materials of pictures have it."""
    found = {}
    for rows in view.scene.instances.values():
        which = poles_of(rows, view.scene.prototypes)
        if not len(which):
            continue
        foot, facing, over = sides_of(rows, which)
        vehicles = vehicles_see(foot, facing, view.signals, moment)
        people = people_see(over, view.signals, moment)
        for row, seen, walk in zip(which.tolist(), vehicles.tolist(), people.tolist(), strict=True):
            go = walk if walk >= 0 else (-1 if seen < 0 else int(seen == STATE["red"]))
            if seen >= 0 or walk >= 0:
                found[id_text(int(rows.object_id[row]))] = [seen + 1, go + 1]
    return found


def test_lamps_show_what_the_signal_plan_says_at_the_moment_of_the_slider(shown, driven):
    view = read_view(driven / "city")
    states = set()
    moments = np.arange(0.0, 70.0, 1.7).tolist()
    for moment, told in zip(moments, shown.evaluate(AT, moments), strict=True):
        wanted = seen_at(view, moment)
        assert told == wanted
        states.update(map(tuple, wanted.values()))
    assert len(wanted) >= 4
    assert len({vehicles for vehicles, _ in states}) >= 3  # red, yellow, green
    shown.fill("#moment", "40")  # as the slider sets it
    now = seen_at(view, float(shown.input_value("#moment")))
    assert shown.evaluate(SHOWN) == now
    assert sorted(shown.evaluate(DRAWN)) == sorted(now.values())


def test_a_city_without_signals_has_no_file_of_lamps(built_town):
    assert lamps_bytes(read_view(built_town(lod=2) / "city")) == b""


def test_rain_falls_as_the_weather_has_it_and_snow_as_it_is_chosen(shown):
    shown.evaluate("cityx.eye.setWay('walk')")
    counts = "cityx.sky.falling.counts"
    rain = until(shown, counts, lambda found: found["drops"] > 0)
    assert rain["flakes"] == 0
    frames = shown.evaluate("cityx.frames")
    until(shown, "cityx.frames", lambda now: now > frames + 2)  # it is drawn anew while it falls
    shown.click("#tools button:has-text('Light')")
    shown.fill("#panel [aria-label='Rain, mm/h']", "1")
    less = until(shown, counts, lambda found: found["drops"] != rain["drops"])
    assert 0 < less["drops"] < rain["drops"]
    shown.click("#panel button:has-text('snow')")
    snow = until(shown, counts, lambda found: found["flakes"] > 0)
    assert snow["drops"] == 0
    shown.click("#panel button:has-text('clear')")
    assert until(shown, counts, lambda found: not found["flakes"]) == {"drops": 0, "flakes": 0}
    shown.wait_for_timeout(300)
    frames = shown.evaluate("cityx.frames")
    shown.wait_for_timeout(1000)
    assert shown.evaluate("cityx.frames") <= frames + 1  # a still page is drawn once
    assert shown.faults == []


# How bright the city is from above, 0 to 255, when it is dry, wet, and white, under the same sky.
BRIGHT = """() => { const page = window.cityx, gl = page.renderer.getContext();
  page.renderer.setAnimationLoop(null);
  page.eye.flight = null; page.eye.plan(page.told.extent);
  const width = gl.drawingBufferWidth, height = gl.drawingBufferHeight;
  return [[0, 0], [1, 0], [0, 1]].map(([wetness, snow]) => {
    page.sky.air = {...page.sky.air, cloud: 1, rain: 0, snowfall: 0, wetness, snow};
    page.light(); page.choose(); page.draw();
    const at = new Uint8Array(width * height * 4);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, at);
    let sum = 0;
    for (let i = 0; i < at.length; i += 4) sum += at[i] + at[i + 1] + at[i + 2];
    return sum / (width * height * 3);
  }); }"""


@pytest.mark.parametrize("look", ["plain", "full"])
def test_what_faces_up_is_darker_when_wet_and_white_in_snow(browser, driven, page, look):  # noqa: ARG001
    small = {"width": 160, "height": 100}  # the full look is slow without a graphics card
    with serving(driven) as port:
        address = f"http://127.0.0.1:{port}/?look={look}#token={TOKEN}"
        shown = opened(browser, address, viewport=small)
        dry, wet, white = shown.evaluate(BRIGHT)
        assert wet < 0.96 * dry
        assert white > 1.25 * dry
        assert shown.faults == []
        shown.context.close()


def test_sliders_make_the_ground_wet_and_white(shown):
    shown.click("#tools button:has-text('Light')")
    shown.click("#panel button:has-text('clear')")
    air = "[cityx.sky.air.wetness, cityx.sky.air.snow]"
    assert shown.evaluate(air) == [0, 0]
    shown.fill("#panel [aria-label='Rain, mm/h']", "8")  # as an edit has it, 0.05 of a mm an hour
    assert shown.evaluate(air) == [0.4, 0]
    assert shown.input_value("#panel [aria-label='Wetness']") == "0.4"
    shown.fill("#panel [aria-label='Wetness']", "0.9")
    shown.fill("#panel [aria-label='Lying snow']", "0.5")
    assert shown.evaluate(air) == [0.9, 0.5]
    shown.click("#panel button:has-text('clear')")
    assert shown.evaluate(air) == [0, 0]
    assert shown.faults == []


def test_the_weather_of_the_sliders_is_kept_as_an_edit(shown, driven):
    shown.click("#tools button:has-text('Light')")
    shown.click("#panel button:has-text('snow')")
    shown.fill("#panel [aria-label='Lying snow']", "0.6")
    shown.click("#panel button:has-text('Keep this weather')")
    shown.wait_for_selector("#said p:last-child.good", timeout=60_000)
    kept = read_view(driven / "city").environment
    assert (kept.snow, kept.snowfall, kept.rain, kept.cloud_cover) == (0.6, 2.0, 0.0, 1.0)
    until(shown, "[cityx.told.environment.snow, cityx.sky.air.snow]", [0.6, 0.6].__eq__)
    assert shown.evaluate("cityx.change('undo')")["status"] == "ok"
    until(shown, "cityx.told.environment.snow", (0).__eq__)
    assert shown.faults == []


def test_who_wants_less_motion_sees_rain_that_stands(browser, driven, page):  # noqa: ARG001
    with serving(driven) as port:
        still = opened(browser, f"http://127.0.0.1:{port}/#token={TOKEN}", reduced_motion="reduce")
        still.evaluate("cityx.eye.setWay('walk')")
        until(still, "cityx.sky.falling.group.visible && !cityx.stale && !cityx.dirty", bool)
        still.wait_for_timeout(500)
        frames = still.evaluate("cityx.frames")
        still.wait_for_timeout(1500)
        assert still.evaluate("cityx.frames") <= frames + 1
        still.context.close()
