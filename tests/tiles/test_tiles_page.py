"""The page of tiles: it loads those near the camera, and a click tells which object is there."""

import json
import shutil
import threading
import time
from contextlib import contextmanager
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer

import numpy as np
import pytest
import requests
import shapely
from typer.testing import CliRunner

pytest.importorskip("starlette", reason="cityx view needs the extra view")

from cityx.city.store import read_city
from cityx.cli.main import app
from cityx.errors import InputError, MissingDependency
from cityx.tiles.grid import tile_named
from cityx.tiles.order import read_order
from cityx.tiles.page import TilesPage, start_of
from cityx.tiles.run import records
from cityx.tiles.tileset import earth_centred
from cityx.viewer.page import page_folder

BROWSER = next(
    (found for name in ("chromium", "google-chrome", "chromium-browser")
     if (found := shutil.which(name))), None,
)  # fmt: skip
FLAGS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
         "--disable-background-networking"]  # fmt: skip
TOKEN = "a-token-of-this-test"
WAIT_MS = 60_000
RESTS = "() => window.cityx?.state.files > 0 && window.cityx.state.waiting === 0"
# Look straight down on a place of the page, x east, y up, z south.
ABOVE = """([x, z, height]) => {
  const { camera, controls } = window.cityx;
  controls.target.set(x, 0, z);
  camera.position.set(x, height, z + 0.01);
  controls.update();
}"""


@pytest.fixture(scope="module")
def port(built_tiles):
    try:
        page_folder()
    except MissingDependency as error:
        pytest.skip(str(error))
    with serving(built_tiles) as found:
        yield found


@contextmanager
def serving(folder):
    import uvicorn

    from cityx.server.serve import listening

    with listening(0) as listener:
        number = listener.getsockname()[1]
        config = uvicorn.Config(TilesPage(folder, number, TOKEN).app(), log_level="warning")
        server = uvicorn.Server(config)
        thread = threading.Thread(target=server.run, kwargs={"sockets": [listener]}, daemon=True)
        thread.start()
        while not server.started:
            time.sleep(0.01)
        yield number
        server.should_exit = True
        thread.join(10)


def asked(port, path, **headers):
    head = {"Authorization": f"Bearer {TOKEN}", **headers}
    return requests.get(f"http://127.0.0.1:{port}/{path}", headers=head, timeout=30)


def test_tiles_are_told_to_who_has_the_token_and_nothing_else_of_the_disk(port, built_tiles):
    there = asked(port, "run/tileset.json")
    assert there.content == (built_tiles / "tileset.json").read_bytes()
    for refused, headers in ((401, {"Authorization": ""}), (421, {"Host": "elsewhere.example"}),
                             (403, {"Origin": "http://elsewhere.example"})):  # fmt: skip
        assert asked(port, "run/tileset.json", **headers).status_code == refused
    for path in ("run/tiles/0_0/content/..%2Ftile.json", "run/tiles/..%2F..%2Fx/tileset.json",
                 "run/tiles/7_7/tileset.json", "run/tiles.json"):  # fmt: skip
        assert asked(port, path).status_code == 404
    store = read_city(built_tiles / "tiles" / "0_0" / "city")
    row = store.layout.buildings.iloc[0]
    told = asked(port, f"objects/0_0/{int(row['id']):016x}").json()
    assert told["source"] == row["source"]
    assert "0123456789abcdef" in asked(port, "objects/0_0/0123456789abcdef").json()["message"]


def test_names_of_all_tiles_are_found_and_where_they_are(port, built_tiles):
    for told in records(built_tiles).values():
        assert told["names"] == sorted(told["names"], key=lambda own: own[1:3])
    street = [tile.name for tile, told in records(built_tiles).items()
              if any(own[1] == "High Street" for own in told["names"])]  # fmt: skip
    assert len(street) > 1
    (main,) = asked(port, "search?text=HIGH%20street").json()["found"]
    assert (main["name"], main["tile"]) == ("High Street", street[0])
    assert asked(port, "search?text=high").json()["found"] == [main]
    assert asked(port, f"search?text={main['id']}").json()["found"] == [main]
    assert asked(port, "search?text=nowhere%20street").json() == {"found": []}
    assert asked(port, "search?text=").json() == {"found": []}
    order, _ = read_order(built_tiles)
    (x, y, z), = (own[3:] for own in records(built_tiles)[tile_named(main["tile"])]["names"]
                  if own[0] == main["id"])  # fmt: skip
    there = earth_centred(order.frame.to_geographic(np.array([[x, y]])), z)[0]
    assert np.linalg.norm(there - main["place"]) < 0.1
    assert asked(port, "search?text=high", Authorization="").status_code == 401


def test_a_folder_without_built_tiles_has_no_page(built_tiles, tmp_path):
    shutil.copy2(built_tiles / "tiles.json", tmp_path)
    with pytest.raises(InputError, match="holds no built tile; cityx tiles build makes them"):
        start_of(tmp_path)


@pytest.mark.slow
@pytest.mark.skipif(BROWSER is None, reason="no Chromium on this machine")
def test_tiles_near_the_camera_are_shown_and_picks_tell_their_ids(port, built_tiles):
    api = pytest.importorskip("playwright.sync_api")
    start = start_of(built_tiles)
    west, south, east, north = tile_named(start["tile"]).box(500.0)
    middle = np.array([(west + east) / 2, (south + north) / 2])
    with api.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=BROWSER, args=FLAGS)
        page = browser.new_page(viewport={"width": 400, "height": 300})  # software draws it
        faults, urls = [], []
        page.on("pageerror", lambda error: faults.append(str(error)))
        page.on("request", lambda request: urls.append(request.url))
        page.goto(f"http://127.0.0.1:{port}/#token={TOKEN}")
        page.wait_for_function(RESTS, timeout=WAIT_MS)
        assert len(page.evaluate("window.cityx.state.tiles")) == 4
        for name, far in (("-1_-1", "0_0"), ("0_0", "-1_-1")):
            layout = read_city(built_tiles / "tiles" / name / "city").layout
            places = shapely.get_coordinates(layout.buildings.geometry.representative_point())
            outer = int(np.argmax(np.abs(places).sum(axis=1)))  # the tiles meet in the origin
            row, place = layout.buildings.iloc[outer], places[outer] - middle
            page.evaluate(ABOVE, [float(place[0]), -float(place[1]), float(row["height"]) + 60.0])
            gone = f"() => !window.cityx.state.tiles.includes('{far}')"
            page.wait_for_function(gone, timeout=WAIT_MS)
            page.wait_for_function(RESTS, timeout=WAIT_MS)
            assert name in page.evaluate("window.cityx.state.tiles")
            found = page.evaluate("window.cityx.pick(200, 150)")
            assert (found["id"], found["tile"]) == (f"{int(row['id']):016x}", name)
        page.mouse.click(200, 150)
        page.wait_for_selector(f"#content:has-text('{row['source']}')", timeout=WAIT_MS)
        page.fill("#wanted", "high street")
        page.press("#wanted", "Enter")
        page.wait_for_selector("#content:has-text('1 found')", timeout=WAIT_MS)
        spot = page.evaluate("window.cityx.controls.target.toArray()")
        street = next(own for told in records(built_tiles).values() for own in told["names"]
                      if own[1] == "High Street")  # fmt: skip
        assert spot[0] == pytest.approx(street[3] - middle[0], abs=0.5)
        assert spot[2] == pytest.approx(middle[1] - street[4], abs=0.5)
        assert page.evaluate("window.cityx.state.failed") == 0
        assert faults == []
        assert all(url.startswith((f"http://127.0.0.1:{port}/", "blob:", "data:")) for url in urls)
        browser.close()


@pytest.fixture(scope="module")
def site(built_tiles, tmp_path_factory):
    try:
        page_folder()
    except MissingDependency as error:
        pytest.skip(str(error))
    folder = tmp_path_factory.mktemp("site") / "site"
    done = CliRunner().invoke(app, ["view", str(built_tiles), "--export", str(folder)])
    assert done.exit_code == 0, done.output
    assert f"{len([*folder.rglob('*.*')])} files" in done.output
    return folder


def test_a_static_site_of_tiles_holds_what_a_server_answers(site, port, built_tiles, tmp_path):
    shown = json.loads((site / "start.json").read_text())
    assert shown == start_of(built_tiles) | {"live": False}
    for tile, record in records(built_tiles).items():
        for name in [name for name in record["files"] if name.startswith("content/")]:
            file = site / "run" / "tiles" / tile.name / name
            assert file.read_bytes() == (built_tiles / "tiles" / tile.name / name).read_bytes()
    tileset = json.loads((site / "run" / "tileset.json").read_text())
    for child in tileset["root"]["children"]:
        assert (site / "run" / child["content"]["uri"]).is_file()
    (main,) = asked(port, "search?text=HIGH%20street").json()["found"]
    assert main in json.loads((site / "names.json").read_text())
    held = json.loads((site / "objects" / f"{main['tile']}.json").read_text())
    told = asked(port, f"objects/{main['tile']}/{main['id']}").json()
    assert held[main["id"]] == {key: told[key] for key in held[main["id"]]}
    assert held[main["id"]]["name"] == "High Street"
    left = site.parent / f".{site.name}.partial" / "objects"  # by an export that was cut short
    left.mkdir(parents=True)
    (left / "gone.json").write_text("{}")
    again = CliRunner().invoke(app, ["view", str(built_tiles), "--export", str(site)])
    assert again.exit_code == 0  # an older site is replaced
    assert not left.exists()
    assert not (site / "objects" / "gone.json").exists()
    (tmp_path / "mine.txt").write_text("kept")
    refused = CliRunner().invoke(app, ["view", str(built_tiles), "--export", str(tmp_path)])
    assert refused.exit_code != 0
    assert (tmp_path / "mine.txt").read_text() == "kept"


@pytest.mark.slow
@pytest.mark.skipif(BROWSER is None, reason="no Chromium on this machine")
def test_a_static_site_shows_tiles_and_finds_names_with_any_server(site, built_tiles):
    api = pytest.importorskip("playwright.sync_api")
    handler = partial(SimpleHTTPRequestHandler, directory=str(site))
    with ThreadingHTTPServer(("127.0.0.1", 0), handler) as server, api.sync_playwright() as driver:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        browser = driver.chromium.launch(executable_path=BROWSER, args=FLAGS)
        page = browser.new_page(viewport={"width": 400, "height": 300})
        faults = []
        page.on("pageerror", lambda error: faults.append(str(error)))
        page.goto(f"http://127.0.0.1:{server.server_port}/")
        page.wait_for_function(RESTS, timeout=WAIT_MS)
        west, south, east, north = tile_named(start_of(built_tiles)["tile"]).box(500.0)
        layout = read_city(built_tiles / "tiles" / "0_0" / "city").layout
        places = shapely.get_coordinates(layout.buildings.geometry.representative_point())
        outer = int(np.argmax(np.abs(places).sum(axis=1)))
        row = layout.buildings.iloc[outer]
        x, y = places[outer] - np.array([(west + east) / 2, (south + north) / 2])
        page.evaluate(ABOVE, [float(x), -float(y), float(row["height"]) + 60.0])
        page.wait_for_function(RESTS, timeout=WAIT_MS)
        found = f"() => window.cityx.pick(200, 150)?.id === '{int(row['id']):016x}'"
        page.wait_for_function(found, timeout=WAIT_MS)
        page.mouse.click(200, 150)
        page.wait_for_selector(f"#content:has-text('{row['source']}')", timeout=WAIT_MS)
        page.fill("#wanted", "high street")
        page.press("#wanted", "Enter")
        page.wait_for_selector("#content:has-text('1 found')", timeout=WAIT_MS)
        assert page.evaluate("window.cityx.state.failed") == 0
        assert faults == []
        browser.close()
        server.shutdown()
