"""Open tiles in CesiumJS, pick objects in it and hold their ids against the stores of the tiles.

    npm install --prefix ELSEWHERE cesium@1
    python benchmarks/cesium.py TILES ELSEWHERE/node_modules/cesium [--picks 60] [--shot FILE.jpg]

TILES is a folder of `cityx tiles build`, with stores. Nothing is asked of the network: both folders
are served from this machine, without imagery and terrain. Printed are the tiles that CesiumJS
loaded and failed to load, errors of the console, picks that hit a feature, and of these those at
which the object of that id is not, by the store of the tile. The exit code is 1 if anything failed.
"""

from __future__ import annotations

import argparse
import json
import sys
import threading
from collections import defaultdict
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlsplit

import numpy as np
from numpy.typing import NDArray
from playwright.sync_api import sync_playwright

from cityx.city.store import read_view
from cityx.ids import id_text

SIZE = {"width": 960, "height": 540}
FLAGS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
WAIT_MS = 600_000
REACH = np.array([[-12, -12, -12], [12, 12, 40]])  # metres of what is placed, from its place
PAGE = """<!doctype html><meta charset="utf-8"><title>Tiles in CesiumJS</title>
<link rel="icon" href="data:,">
<link rel="stylesheet" href="/cesium/Build/Cesium/Widgets/widgets.css">
<style>html, body, #view { margin: 0; height: 100%; overflow: hidden }</style>
<div id="view"></div>
<script>window.CESIUM_BASE_URL = "/cesium/Build/Cesium/"</script>
<script src="/cesium/Build/Cesium/Cesium.js"></script>
<script>
window.told = {failed: [], loaded: 0, ready: false};
(async () => {
  const viewer = new Cesium.Viewer("view", {
    globe: false, baseLayer: false, baseLayerPicker: false, geocoder: false, animation: false,
    timeline: false,
    navigationHelpButton: false, homeButton: false, sceneModePicker: false, fullscreenButton: false,
    requestRenderMode: true,
  });
  viewer.clock.currentTime = Cesium.JulianDate.fromIso8601("2026-06-21T11:00:00Z");
  const tiles = await Cesium.Cesium3DTileset.fromUrl("/tiles/tileset.json");
  tiles.maximumScreenSpaceError = ERROR;
  tiles.tileFailed.addEventListener((fault) => told.failed.push(`${fault.url}: ${fault.message}`));
  tiles.tileLoad.addEventListener(() => { told.loaded += 1; });
  tiles.allTilesLoaded.addEventListener(() => { told.ready = true; });
  viewer.scene.primitives.add(tiles);
  const {center, radius} = tiles.boundingSphere;
  viewer.camera.lookAt(center, new Cesium.HeadingPitchRange(0.6, -0.6, radius * NEAR));
  window.viewer = viewer;
})().catch((error) => { told.failed.push(String(error)); told.ready = true; });
</script>"""
# What is under some pixels, and where it is in the frame of the content that holds it.
PICKS = """(count) => {
  const found = [];
  for (let at = 0; at < count; at++) {
    const pixel = new Cesium.Cartesian2(40 + ((at * 397) % 880), 60 + ((at * 211) % 440));
    const feature = viewer.scene.pick(pixel), place = viewer.scene.pickPosition(pixel);
    if (!feature?.getProperty || !place) continue;
    const {tile, url} = feature.content;
    const turn = Cesium.Matrix4.inverseTransformation(tile.computedTransform, new Cesium.Matrix4());
    const {x, y, z} = Cesium.Matrix4.multiplyByPoint(turn, place, new Cesium.Cartesian3());
    found.push({id: feature.getProperty("id"), place: [x, y, z], url});
  }
  return found;
}"""


@contextmanager
def served(page: str, **roots: Path) -> Iterator[str]:
    """Serve a page, and folders each under its name."""

    class Handler(SimpleHTTPRequestHandler):
        def do_GET(self) -> None:
            if urlsplit(self.path).path != "/":
                super().do_GET()
                return
            self.send_response(200)
            self.send_header("Content-Type", "text/html")
            self.end_headers()
            self.wfile.write(page.encode())

        def translate_path(self, path: str) -> str:
            _, name, *rest = unquote(urlsplit(path).path).split("/")
            return str(roots.get(name, Path("/nowhere")).joinpath(*(p for p in rest if p != "..")))

        def log_message(self, *words: Any) -> None:
            pass

    with ThreadingHTTPServer(("127.0.0.1", 0), Handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}/"
        server.shutdown()


def boxes_of(store: Path) -> dict[str, list[NDArray[np.float64]]]:
    """Return the boxes, (2, 3) metres, of all that a store shows by the id that it is told by."""
    view, boxes = read_view(store), defaultdict(list)
    for batch in view.scene.meshes.values():
        for row, number in enumerate(batch.object_id.tolist()):
            points = batch.vertices[batch.vertex_start[row] : batch.vertex_start[row + 1]]
            if len(points):
                boxes[id_text(number)].append(np.array([points.min(0), points.max(0)]))
    for rows in view.scene.instances.values():
        ids = np.where(rows.owner > 0, rows.owner, rows.object_id)
        for number, place in zip(ids.tolist(), rows.position, strict=True):
            boxes[id_text(number)].append(place + REACH)
    return boxes


def away(tiles: Path, picks: list[dict[str, Any]]) -> list[float]:
    """Return how far from the picked place the object is whose id was told, metres."""
    known: dict[str, dict[str, list[NDArray[np.float64]]]] = {}
    found = []
    for pick in picks:
        content = tiles / urlsplit(pick["url"]).path.removeprefix("/tiles/")
        folder = content.parents[1]
        boxes = known.setdefault(folder.name, boxes_of(folder / "city"))
        root = glb_json(content)["nodes"][-1]["translation"]
        x, y, z = root  # of glTF: y up
        place = np.array(pick["place"]) - [x, -z, y]
        gaps = [np.maximum(np.maximum(low - place, place - high), 0)
                for low, high in boxes.get(pick["id"], ())]  # fmt: skip
        found.append(min((float(np.linalg.norm(gap)) for gap in gaps), default=np.inf))
    return found


def glb_json(path: Path) -> dict[str, Any]:
    """Return the JSON of a binary glTF."""
    with path.open("rb") as file:
        file.seek(12)
        length = int.from_bytes(file.read(4), "little")
        file.seek(20)
        held: dict[str, Any] = json.loads(file.read(length))
    return held


def main() -> int:
    """Open, pick, compare and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("tiles", type=Path)
    parser.add_argument("cesium", type=Path)
    parser.add_argument("--picks", type=int, default=60)
    parser.add_argument("--near", type=float, default=0.7, help="distance over the radius of all")
    parser.add_argument("--error", type=float, default=100, help="pixels of error that are shown")
    parser.add_argument("--shot", type=Path)
    given = parser.parse_args()
    page = PAGE.replace("NEAR", str(given.near)).replace("ERROR", str(given.error))
    errors: list[str] = []
    with served(page, tiles=given.tiles, cesium=given.cesium) as address, sync_playwright() as api:
        browser = api.chromium.launch(executable_path="/usr/bin/chromium", args=FLAGS)
        shown = browser.new_page(viewport=SIZE)  # type: ignore[arg-type]
        shown.on("pageerror", lambda error: errors.append(str(error)))
        shown.on("console", lambda m: errors.append(m.text) if m.type == "error" else None)
        shown.goto(address)
        shown.wait_for_function("told.ready", timeout=WAIT_MS)
        told = shown.evaluate("told")
        picked = shown.evaluate(PICKS, given.picks) if not told["failed"] else []
        if given.shot:
            shown.screenshot(path=given.shot, type="jpeg", quality=85)
        version = shown.evaluate("Cesium.VERSION")
        browser.close()
    gaps = away(given.tiles, picked)
    beside = [pick | {"metres": gap} for pick, gap in zip(picked, gaps, strict=True) if gap > 1]
    print(json.dumps({
        "cesium": version, "loaded": told["loaded"], "failed": told["failed"], "errors": errors,
        "picks": given.picks, "features": len(picked), "beside": beside,
    }, indent=2))  # fmt: skip
    return int(bool(told["failed"] or errors or beside or not picked))


if __name__ == "__main__":
    sys.exit(main())
