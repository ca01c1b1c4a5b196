"""Measure the page of `cityx view` in a real browser, and take its pictures for the documentation.

    python benchmarks/viewer.py bars CITY...        # load, frames, calls, picks, an edit, bytes
    python benchmarks/viewer.py shots CITY docs     # viewer_*.jpg, one for each function
    python benchmarks/viewer.py grid MAP            # a map of 16,000 houses, to be built and opened

The browser is the system's Chromium. Without a graphics card it draws in software: what is printed
first says which. Cities are copied before they are changed.
"""

from __future__ import annotations

import argparse
import gzip
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path
from statistics import median
from typing import Any

from PIL import Image
from playwright.sync_api import Browser, Page, sync_playwright

from cityx.viewer.page import page_folder

SIZE = {"width": 1280, "height": 720}
PICTURE = (960, 540)  # pixels, of the documentation
FLAGS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
WAIT_MS = 300_000
# One turn round the middle, a picture at a time, and what each took.
TURN = """async ([count, moving]) => {
  const page = window.cityx, spent = [], Vector = page.eye.position.constructor;
  const off = page.eye.position.clone().sub(page.eye.controls.target);
  page.renderer.setAnimationLoop(null);
  const pixel = new Uint8Array(4), gl = page.renderer.getContext();
  page.frameMs = 200;
  for (let at = 0; at < count; at++) {
    const begun = performance.now();
    off.applyAxisAngle(new Vector(0, 1, 0), 0.05);
    page.eye.camera.position.copy(page.eye.controls.target).add(off);
    page.eye.controls.update();
    page.sharpen(true);
    if (at % 6 === 0) page.choose();
    if (moving) page.setMoment((page.moment + 0.2) % page.movement.duration);
    page.draw();
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
    spent.push(performance.now() - begun);
  }
  const told = page.renderer.info.render;
  page.renderer.setAnimationLoop((now) => page.frame(now));
  const ratio = page.renderer.getPixelRatio();
  return {spent, calls: told.calls, triangles: told.triangles, ratio};
}"""
PICKS = """(count) => {
  const spent = [];
  let hits = 0;
  for (let at = 0; at < count; at++) {
    const x = 100 + ((at * 397) % 1000), y = 150 + ((at * 211) % 400), begun = performance.now();
    hits += window.cityx.pick(x, y) ? 1 : 0;
    spent.push(performance.now() - begun);
  }
  return {spent, hits};
}"""


@contextmanager
def served(folder: Path) -> Iterator[str]:
    """Serve a city and give the address of its page."""
    command = [sys.executable, "-m", "cityx.cli", "view", str(folder), "--no-browser"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        yield process.stdout.readline().split()[-1]
        process.terminate()


def opened(browser: Browser, address: str, **how: Any) -> Page:
    """Open the page and wait until the whole city is there."""
    page = browser.new_context(viewport=SIZE, **how).new_page()  # type: ignore[arg-type]
    page.on("pageerror", lambda error: print("error on the page:", error))
    page.goto(address)
    page.wait_for_selector("body[data-state=ready]", state="attached", timeout=WAIT_MS)
    return page


def bars(browser: Browser, city: Path) -> None:
    """Print what is measured of one city."""
    with tempfile.TemporaryDirectory() as held:
        folder = shutil.copytree(city, Path(held) / "city", ignore=shutil.ignore_patterns("*.glb"))
        with served(folder) as address:
            opened(browser, address).context.close()  # what the server writes is kept now
            page = browser.new_context(viewport=SIZE).new_page()  # type: ignore[arg-type]
            page.goto(address)
            page.wait_for_selector("body[data-state=ready]", state="attached", timeout=WAIT_MS)
            reached = page.evaluate("cityx.reached")
            loaded = sum(page.evaluate("[...cityx.source.sizes.values()]")) / 1e6
            page.wait_for_timeout(1000)
            whole = page.evaluate(TURN, [36, False])
            moving, driven = traffic(page)
            picked = page.evaluate(PICKS, 60)
            picks = sorted(picked["spent"][10:])
            changed = edit(page)
            heap = page.evaluate("performance.memory.usedJSHeapSize / 1e6")
            renderer = page.evaluate(
                """() => { const gl = cityx.renderer.getContext();
                return gl.getParameter(gl.getExtension('WEBGL_debug_renderer_info')
                  .UNMASKED_RENDERER_WEBGL); }"""
            )
            page.context.close()
    rows = {
        "drawn by": renderer,
        "first picture, s": f"{reached['shown'] / 1000:.1f}",
        "whole city, s": f"{reached['ready'] / 1000:.1f}",
        "loaded, MB": f"{loaded:.1f}",
        "frames a second, turning": f"{1000 / median(whole['spent'][8:]):.1f}",
        "frames a second, in traffic": driven,
        "moving": moving,
        "pixels of an edge": f"{whole['ratio']:.2f} of 1280 x 720",
        "draw calls": whole["calls"],
        "triangles": f"{whole['triangles']:,}",
        "pick, ms": f"{median(picks):.0f}, 95 %: {picks[int(len(picks) * 0.95)]:.0f}; "
        f"{picked['hits']} of 60 hit",
        "edit": changed["said"],
        "edit, s until the answer": f"{changed['answer']:.1f}",
        "edit, s from the store to the screen": f"{changed['shown']:.1f}",
        "edit, MB sent": f"{changed['sent']:.2f}",
        "heap, MB": f"{heap:.0f}",
    }
    print(city.name)
    for name, value in rows.items():
        print(f"  {name:38s} {value}")


def traffic(page: Page) -> tuple[int, str]:
    """Return how many things move, and frames a second with them and without, in turns."""
    moving = page.evaluate(
        """[...window.cityx.movement?.looks.values() ?? []]
        .reduce((sum, look) => sum + look.shown.length, 0)"""
    )
    if not moving:
        return 0, "none"
    spent: dict[bool, list[float]] = {False: [], True: []}
    for _ in range(3):
        for on in (False, True):
            page.evaluate(f"cityx.movement.group.visible = {str(on).lower()}")
            spent[on] += page.evaluate(TURN, [16, on])["spent"][4:]
    still, driven = (1000 / median(spent[on]) for on in (False, True))
    return moving, f"{driven:.1f}, without it {still:.1f}"


def edit(page: Page) -> dict[str, Any]:
    """Change one building by a sentence; seconds to the answer and to the screen, and what came."""
    page.evaluate("cityx.source.sizes.clear()")
    told: dict[str, Any] = page.evaluate(
        """async () => {
        const page = window.cityx, begun = performance.now();
        let stored = 0;
        const renew = page.renew.bind(page);
        page.renew = async () => { stored ||= performance.now(); await renew(); page.draw();
                                   page.drawn ||= performance.now(); };
        const reply = await page.change('make the tallest building 6 m higher');
        const answer = performance.now();
        for (let at = 0; at < 400 && !page.drawn; at++) await new Promise((d) => setTimeout(d, 50));
        const sent = [...page.source.sizes.values()].reduce((one, other) => one + other, 0);
        return {answer: (answer - begun) / 1000, shown: (page.drawn - stored) / 1000,
                sent: sent / 1e6, said: reply ? reply.status + ' ' + reply.message : 'no answer'};
    }"""
    )
    return told


def shots(browser: Browser, city: Path, out: Path, only: list[str], look: str) -> None:
    """Write one picture for each function of the page."""
    with tempfile.TemporaryDirectory() as held:
        folder = shutil.copytree(city, Path(held) / "city", ignore=shutil.ignore_patterns("*.glb"))
        with served(folder) as address:
            page = opened(browser, address.replace("/#", f"/?look={look}#"))
            page.evaluate("cityx.renderer.setPixelRatio(1)")
            for name in only:
                page.evaluate(f"async () => {{ const page = window.cityx; {SHOTS[name]} }}")
                page.wait_for_timeout(2500)
                page.evaluate("cityx.picture().then(() => true)")
                taken = Image.open(BytesIO(page.screenshot())).convert("RGB")
                path = out / f"viewer_{name}.jpg"
                taken.resize(PICTURE, Image.Resampling.LANCZOS).save(path, quality=80)
                print(path, flush=True)
            page.context.close()


def grid(path: Path, houses: int) -> None:
    """Write a map of houses along the streets of a square grid."""
    rows = round(houses**0.5)
    metre_north, metre_east = 1 / 111_320, 1 / (111_320 * 0.62)
    lines, number = ['<osm version="0.6">'], 0

    def node(x: float, y: float) -> int:
        nonlocal number
        number += 1
        lat, lon = 51.7 + y * metre_north, 7.2 + x * metre_east
        lines.append(f'<node id="{number}" lat="{lat:.7f}" lon="{lon:.7f}"/>')
        return number

    ways: list[tuple[list[int], str, str]] = []
    pitch, edge = 28.0, 11.0
    for at in range(houses):
        x, y = (at % rows) * pitch, (at // rows) * pitch
        ring = [node(x, y), node(x + edge, y), node(x + edge, y + edge), node(x, y + edge)]
        ways.append(([*ring, ring[0]], "building", "house" if at % 9 else "apartments"))
    across = range(0, rows + 1, 8)
    middle = -(pitch - edge) / 2  # of a street, between two rows
    crossings = {
        (i, j): node(i * pitch + middle, j * pitch + middle) for i in across for j in across
    }
    for i in across:
        ways.append(([crossings[i, j] for j in across], "highway", "residential"))
        ways.append(([crossings[j, i] for j in across], "highway", "residential"))
    for refs, key, value in ways:
        number += 1
        held = "".join(f'<nd ref="{ref}"/>' for ref in refs)
        lines.append(f'<way id="{number}">{held}<tag k="{key}" v="{value}"/></way>')
    path.write_text("\n".join([*lines, "</osm>"]))


_STAND = """
  const stand = (from, at) => { page.eye.setWay('orbit'); page.eye.camera.position.set(...from);
    page.eye.controls.target.set(...at); page.eye.controls.update(); };
  const tool = (name) => [...document.querySelectorAll('#tools button')]
    .find((each) => each.textContent === name).click();
  page.city.rows.least = 1.3; page.city.rows.coarse = 1;
  // What earlier pictures chose is taken back.
  page.firstAir ??= page.sky.air;
  if (page.city.coloring !== 'natural') page.city.setColoring('natural');
  page.sky.air = {...page.firstAir}; page.light();
  page.deselect(); page.panels.close(); page.sketch.clear();
  page.marks.clear('ghost'); page.marks.way('moved', []);
  document.getElementById('hush').click();
  for (const id of ['sentence', 'wanted']) document.getElementById(id).value = '';
"""
SHOTS: dict[str, str] = {
    "whole": _STAND + "page.eye.overview(page.told.extent, 0);",
    "details": _STAND
    + """page.eye.overview(page.told.extent, 0);
    await page.find('the tallest building'); await new Promise((d) => setTimeout(d, 1500));
    await page.tell(page.selected, {layer: 'buildings', prototype: '', owner: ''});""",
    "street": _STAND
    + """page.setMoment(30);
    const cars = [...page.movement.looks.values()]
      .filter((look) => look.shown.length && look.shown[0].kind === 'car')
      .flatMap((look) => look.shown.map((_, row) => look.bodies[row].elements));
    const near = (a) => cars.filter((b) => Math.hypot(a[12] - b[12], a[14] - b[14]) < 45).length;
    cars.sort((a, b) => near(b) - near(a));
    const [m] = cars, length = Math.hypot(m[0], m[2]), x = m[0] / length, z = m[2] / length;
    const at = (by, up) => [m[12] + by * x, m[13] + up, m[14] + by * z];
    stand(at(-13, 4.5), at(9, 2));""",
    "edit": _STAND
    + """page.eye.overview(page.told.extent, 0);
    await page.change('make the tallest building 15 m higher');
    await page.find('the tallest building'); await new Promise((d) => setTimeout(d, 1500));
    page.panels.close();""",
    "heights": _STAND
    + """page.eye.overview(page.told.extent, 0); page.city.setColoring('height');
    page.light(); tool('Layers');""",
    "night": _STAND
    + """page.sky.air = {...page.sky.air, hour: 22.2};
    page.light(); tool('Light'); const s = page.told.extent;
    stand([s[0] + 150, 45, -s[1] - 60], [(s[0] + s[2]) / 2, 8, -(s[1] + s[3]) / 2]);""",
    "report": _STAND + "page.eye.plan(page.told.extent); tool('Report');",
    "layers": _STAND
    + """page.eye.overview(page.told.extent, 0); page.city.setColoring('provenance'); page.light();
    await page.askProvenance(); tool('Layers');""",
    "drag": _STAND
    + """const blocks = [...page.city.rows.blocks.values()].flat()
      .filter((each) => each.layer === 'trees');
    const rows = blocks.flatMap((block) => Array.from({length: block.count}, (_, row) =>
      [block, row, ...block.matrices.slice(row * 16 + 12, row * 16 + 15)]));
    const alone = (r) => Math.min(...rows.filter((o) => o !== r)
      .map((o) => Math.hypot(o[2] - r[2], o[4] - r[4])));
    rows.sort((a, b) => alone(b) - alone(a));
    const [block, row, x, y, z] = rows[0];
    const word = (w) => block.ids[row * 4 + w].toString(16).padStart(4, '0');
    const id = [3, 2, 1, 0].map(word).join('');
    stand([x - 16, y + 16, z + 18], [x + 3, y + 3, z]);
    await page.tell(id, {layer: 'trees', prototype: block.prototype, owner: ''});
    page.marks.set('ghost', page.outlines(id)); page.marks.shift('ghost', 7, 1);
    const from = page.eye.position.clone().set(x, y + 0.5, z);
    page.marks.way('moved', [from, from.clone().set(x + 7, y + 0.5, z - 1)]);""",
    "rain": _STAND
    + """page.sky.air = {...page.sky.air, cloud: 1, visibility: 5000, rain: 6, wetness: 1};
    page.light(); const s = page.told.extent;
    page.eye.camera.position.set((s[0] + s[2]) / 2, 3, -(s[1] + s[3]) / 2);
    const id = page.lamps && [...page.lamps.lit.keys()][0];
    const at = id && page.city.rows.placeOf(id);
    const m = at && page.city.rows.outlines(new Set([id]))[0].matrix.elements;
    if (m) { const l = Math.hypot(m[8], m[10]);
      const ahead = [m[8] / l, m[10] / l];
      stand([at.x + 7 * ahead[0] + 2, at.y + 2.2, at.z + 7 * ahead[1]], [at.x, at.y + 2.4, at.z]); }
    page.setMoment(10); tool('Light');""",
    "snow": _STAND
    + """page.sky.air = {...page.sky.air, cloud: 0.4, visibility: 8000, snow: 1};
    page.light(); page.eye.overview(page.told.extent, 0);
    page.eye.camera.position.lerp(page.eye.controls.target, 0.45); tool('Light');""",
    "drawn": _STAND
    + """const s = page.told.extent, x = (s[0] + s[2]) / 2, z = -(s[1] + s[3]) / 2;
    stand([x, 130, z + 70], [x, 0, z]); document.getElementById('area').click();
    for (const [e, n] of [[-40, -20], [30, -25], [45, 25], [-30, 30]]) {
      const p = page.eye.position.clone().set(x + e, 500, z - n);
      const ray = page.eye.ray(0, 0).ray; ray.origin.copy(p); ray.direction.set(0, -1, 0);
      const hit = page.city.raycast(ray); if (hit) page.sketch.add(hit.point); }
    page.sketch.stop(); page.notice('');
    document.getElementById('sentence').value = 'make the buildings in this area red';""",
    "search": _STAND
    + """document.getElementById('wanted').value = 'buildings over 30 m';
    page.eye.overview(page.told.extent, 0); await page.find('buildings over 30 m');""",
    "more": _STAND + "page.eye.overview(page.told.extent, 0); tool('More');",
}


def main() -> None:
    """Read the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    commands = parser.add_subparsers(dest="command", required=True)
    one = commands.add_parser("bars")
    one.add_argument("city", type=Path, nargs="+")
    two = commands.add_parser("shots")
    two.add_argument("city", type=Path)
    two.add_argument("out", type=Path)
    two.add_argument("--only", nargs="*", choices=list(SHOTS), default=list(SHOTS))
    two.add_argument("--look", choices=["full", "plain"], default="full")
    three = commands.add_parser("grid")
    three.add_argument("map", type=Path)
    three.add_argument("--houses", type=int, default=16_000)
    given = parser.parse_args()
    if given.command == "grid":
        grid(given.map, given.houses)
        return
    script = (page_folder() / "app.js").read_bytes()
    print(f"page: {len(gzip.compress(script)) / 1000:.0f} kB gzipped")
    with sync_playwright() as driver:
        found = shutil.which("chromium") or shutil.which("google-chrome")
        browser = driver.chromium.launch(executable_path=found, args=FLAGS)
        if given.command == "bars":
            for city in given.city:
                bars(browser, city)
        else:
            shots(browser, given.city, given.out, given.only, given.look)
        browser.close()


if __name__ == "__main__":
    main()
