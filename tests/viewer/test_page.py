"""The page in a real browser without a graphics card: shows, tells, changes, moves, waits."""

import json
import threading
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer

import numpy as np
import pytest
from browsing import NO_BROWSER, SIZE, WAIT_MS, opened, until
from copies import copy_of
from glb import Glb
from page_server import TOKEN, serving

from cityx.agents.loop import quiet
from cityx.city.store import read_city, read_view
from cityx.dataset.stage import stage_of
from cityx.viewer.export import export_site

pytestmark = NO_BROWSER
# Stand before the town, draw everything however small, pick at places of the page, and let the page
# choose again what it draws: without a graphics card everything takes seconds a frame.
PICKS = """(places) => {
  const page = window.cityx;
  page.eye.camera.position.set(-10, 12, 40);
  page.eye.controls.target.set(30, 6, -20);
  page.eye.controls.update();
  page.city.rows.least = 0;
  page.city.rows.coarse = 1;
  page.city.update(page.eye.camera, 400, 1e12);
  page.stale = false;
  const found = places.map(([x, y]) => {
    const { ray } = page.eye.ray(x, y);
    const hit = page.pick(x, y);
    const flip = (v) => [v.x, -v.z, v.y];
    return {origin: flip(ray.origin), way: flip(ray.direction), id: hit?.id ?? '',
            layer: hit?.layer ?? '', distance: hit?.distance ?? -1};
  });
  page.city.rows.least = 1.3;
  page.choose();
  return found;
}"""


@pytest.fixture(scope="module")
def port(town, page):  # noqa: ARG001
    with serving(town) as found:
        yield found


@pytest.fixture(scope="module")
def shown(browser, port):
    page = opened(browser, f"http://127.0.0.1:{port}/#token={TOKEN}")
    yield page
    page.context.close()


def test_it_loads_the_whole_city_from_this_machine_alone(shown, port):
    assert shown.faults == []
    loaded, told = shown.evaluate("[cityx.city.chunks.size, cityx.told.chunks.length]")
    assert loaded == told > 10
    assert all(
        url.startswith((f"http://127.0.0.1:{port}/", "blob:", "data:")) for url in shown.asked
    )
    assert "OpenStreetMap" in shown.inner_text("#credits")
    assert shown.is_visible("#credits")
    assert TOKEN not in shown.url


def test_picks_are_the_ids_that_the_ray_caster_gives(shown, town):
    places = np.random.default_rng(3).uniform([5, 60], [635, 350], (200, 2)).tolist()
    picks = shown.evaluate(PICKS, places)
    view = read_view(town / "city")
    stage = stage_of(view)
    hits = stage.cast([p["origin"] for p in picks], [p["way"] for p in picks], threads=1)
    rows = stage.rows(hits)
    pieces = [f"{stage.piece[row]:016x}" if row >= 0 else "" for row in rows.tolist()]
    # Leaves differ by the form that is drawn, so trees are left out where either side meets one.
    trees = {
        f"{n:016x}" for n in read_view(town / "city").scene.instances["trees"].object_id.tolist()
    }
    pairs = [
        (pick["id"], piece) for pick, piece in zip(picks, pieces, strict=True)
        if pick["layer"] != "trees" and piece not in trees
    ]  # fmt: skip
    same = [one == other for one, other in pairs]
    assert len({one for one, _ in pairs}) > 8
    assert len(pairs) > 50
    assert sum(same) >= len(same) - 1, [pair for pair in pairs if pair[0] != pair[1]]


# How many triangles of the ground are drawn from some metres above the middle, and what a pick from
# there leaves of the order of corners, by which the materials of a download go.
GROUND = """(high) => { const page = window.cityx, { controls, camera } = page.eye;
  page.eye.flight = null; page.eye.plan(page.told.extent);
  camera.position.y = high; controls.update();
  const grounds = [...page.city.chunks.values()].flatMap((chunk) => chunk.surfaces)
    .filter((surface) => surface.layer === 'ground').map((surface) => surface.mesh);
  let drawn = 0;
  for (const mesh of grounds) {
    const after = mesh.onAfterRender;
    mesh.onAfterRender = () => {
      drawn += Math.min(mesh.geometry.drawRange.count, mesh.geometry.index.count) / 3;
      after(); mesh.onAfterRender = after; };
  }
  page.draw();
  const orders = grounds.map((mesh) => mesh.geometry.index.array.join());
  const hit = page.pick(320, 200);
  const all = grounds.reduce((sum, mesh) => sum + mesh.geometry.index.count / 3, 0);
  return {drawn, all, hit: hit !== null,
          same: grounds.every((mesh, at) => mesh.geometry.index.array.join() === orders[at]),
          told: grounds.every((mesh) => mesh.geometry.userData.sections
            .reduce((sum, section) => sum + section.count, 0) === mesh.geometry.index.count)}; }"""


def test_small_triangles_of_the_ground_are_drawn_from_near_alone(shown):
    near, far = (shown.evaluate(GROUND, high) for high in (60, 1500))
    assert near["drawn"] > far["drawn"] > 0
    assert far["drawn"] < 0.7 * far["all"]
    for told in (near, far):
        assert [told["hit"], told["same"], told["told"]] == [True, True, True]
    shown.evaluate("cityx.eye.overview(cityx.told.extent, 0)")


def test_a_click_tells_of_an_object_and_escape_lets_go_of_it(shown, town):
    row = read_view(town / "city").objects
    shown.evaluate("cityx.eye.overview(cityx.told.extent, 0)")
    found = shown.evaluate(
        """() => { for (let x = 60; x < 600; x += 7) for (let y = 150; y < 290; y += 7) {
             if (cityx.pick(x, y)?.layer === 'buildings') return [x, y, cityx.pick(x, y).id]; } }"""
    )
    shown.mouse.click(found[0], found[1])
    shown.wait_for_selector("#panel:has-text('Where it is from')", timeout=WAIT_MS)
    text = shown.inner_text("#panel")
    assert found[2] in text
    assert row[int(found[2], 16)]["source"] in text
    shown.keyboard.press("Escape")
    assert shown.is_hidden("#panel")


def test_a_sentence_changes_one_chunk_and_undo_takes_it_back(shown):
    before = shown.evaluate("[...cityx.city.chunks.keys()]")
    shown.evaluate("cityx.source.sizes.clear()")
    shown.fill("#sentence", "make the tallest building 6 m higher")
    shown.click("#send")
    shown.wait_for_selector("#said p.good", timeout=WAIT_MS)
    after = settled(shown, before)
    assert len(set(after) - set(before)) == len(set(before) - set(after)) == 1
    assert 0 < sum(shown.evaluate("[...cityx.source.sizes.values()]")) < 2e6
    shown.click("#undo")
    shown.wait_for_selector("#said p.good >> nth=1", timeout=WAIT_MS)
    assert sorted(settled(shown, after)) == sorted(before)


def settled(page, before):
    """The chunks of a page once they are others than before."""
    return until(
        page,
        "cityx.city.pending ? [] : [...cityx.city.chunks.keys()]",
        lambda now: now and sorted(now) != sorted(before),
    )


def test_two_windows_that_change_the_city_at_once_lose_nothing_and_stay_in_step(
    browser, shown, port
):
    other = opened(browser, f"http://127.0.0.1:{port}/#token={TOKEN}")
    before = settled(other, [])
    ask = "(text) => { window.answer = null; cityx.change(text).then((r) => (answer = r.status)); }"
    shown.evaluate(ask, "make the tallest building 4 m higher")
    other.evaluate(ask, "make the tallest building red")
    for page in (shown, other):
        assert until(page, "window.answer", lambda answer: answer is not None) == "ok"
    now = shown.evaluate("cityx.source.scene().then((told) => told.hash)")
    for page in (shown, other):
        until(page, "cityx.city.pending ? '' : cityx.told.hash", now.__eq__)
    assert sorted(settled(other, before)) == sorted(settled(shown, before))
    assert other.faults == []
    other.context.close()


# A place of the page where a tree, or another thing that stands free, is picked.
FREE = """(layers) => { if (cityx.eye.flight || cityx.city.pending) return null; cityx.choose();
  for (let x = 60; x < 600; x += 4) for (let y = 70; y < 320; y += 4) {
    const hit = cityx.pick(x, y);
    if (hit && layers.includes(hit.layer) && document.elementFromPoint(x, y)?.id === 'view')
      return [x, y, hit.id]; } }"""


def waited(page, told):
    """Wait until the change that a line tells is done, and return how it went."""
    page.wait_for_selector(
        f"#said p:nth-last-child(2):has-text('{told}') + p:is(.good, .bad)", timeout=WAIT_MS
    )
    return page.inner_text("#said p:last-child")


def selected(page, layers):
    """Select a thing of some layers by a click; returns where it is on the page, and its id."""
    page.evaluate("cityx.deselect(); cityx.eye.plan(cityx.told.extent)")
    page.wait_for_timeout(1500)  # what is drawn of small things settles
    x, y, _ = until(page, f"({FREE})({json.dumps(layers)})", bool)
    page.mouse.click(x, y)
    name = until(page, "cityx.selected", bool)
    page.wait_for_selector(f"#panel:has-text('{name}')", timeout=WAIT_MS)
    return x, y, name


def test_an_object_is_painted_and_removed_as_edits(shown, town):
    def row():
        trees = read_view(town / "city").scene.instances["trees"]
        found = np.flatnonzero(trees.object_id == int(name, 16))
        return len(found)

    _, _, name = selected(shown, ["buildings"])
    shown.fill("#panel input[type=color]", "#2040c0")
    shown.click("#panel button:has-text('Recolour')")
    assert "edit/recolor" in waited(shown, "recolour")
    assert shown.evaluate("cityx.change('undo')")["status"] == "ok"
    _, _, name = selected(shown, ["trees"])
    shown.click("#panel button:has-text('Delete')")
    assert "Revision" in waited(shown, "remove")
    until(shown, "cityx.city.pending", lambda left: left == 0)
    assert row() == 0
    assert shown.evaluate("cityx.change('undo')")["status"] == "ok"
    assert row() == 1


# Stand above a place, so that no panel hides it, and tell where on the page some places are; they
# are metres, x east, y north, z up.
ABOVE = """([x, y, z], places) => {
  const page = window.cityx;
  page.eye.flight = null;
  page.eye.camera.position.set(x, z + 45, -y + 10.01);
  page.eye.controls.target.set(x, z, -y + 10);
  page.eye.controls.update();
  page.choose();
  return places.map(([e, n, up]) => {
    const at = page.eye.controls.target.clone().set(e, up, -n).project(page.eye.camera);
    return [(at.x + 1) / 2 * innerWidth, (1 - at.y) / 2 * innerHeight];
  });
}"""


def above(page, place, *others):
    """Look down on a place and return where it is on the page, and where the others are."""
    return page.evaluate(f"([place, all]) => ({ABOVE})(place, all)", [place, [place, *others]])


def bench_of(town):
    """Return the id of a small thing that stands free, with where it is; the same every time."""
    view = read_view(town / "city")
    rows = view.scene.instances["street_furniture"]
    kinds = [view.scene.prototypes[number].name for number in rows.prototype.tolist()]
    for row, kind in enumerate(kinds):
        if kind == "bench":
            return f"{int(rows.object_id[row]):016x}", rows.position[row].astype(float)
    raise AssertionError(f"no bench among {sorted(set(kinds))}")


def place_of(town, name):
    rows = read_view(town / "city").scene.instances["street_furniture"]
    (row,) = np.flatnonzero(rows.object_id == int(name, 16))
    return rows.position[row].astype(float)


def pulled(page, begin, end):
    """Drag from one place of the page to another, slowly; the button stays down."""
    page.mouse.move(*begin)
    page.mouse.down()
    for share in (0.2, 0.6, 1.0):
        page.mouse.move(*(a + (b - a) * share for a, b in zip(begin, end, strict=True)))


def taken(page, town):
    """Select the small thing by a click from above; returns its id, place and how to drag it."""
    page.evaluate("cityx.deselect(); cityx.panels.close(); said.replaceChildren()")
    name, place = bench_of(town)
    goal = place + np.array([1.0, 0.6, 0.0])
    begin, end = above(page, place.tolist(), goal.tolist())
    until(page, f"cityx.pick({begin[0]}, {begin[1]})?.id", name.__eq__)
    for place_on_page in (begin, end):
        assert page.evaluate("(at) => document.elementFromPoint(...at).id", place_on_page) == "view"
    page.mouse.click(*begin)
    until(page, "cityx.selected", name.__eq__)
    page.wait_for_selector(f"#panel:has-text('{name}')", timeout=WAIT_MS)
    return name, place, begin, end


def test_a_thing_is_dragged_as_an_edit_and_undo_takes_it_back(shown, town):
    name, place, begin, end = taken(shown, town)
    eye = shown.evaluate("cityx.eye.position.toArray()")
    pulled(shown, begin, end)
    assert shown.evaluate("[cityx.dragging.active, cityx.marks.has('ghost')]") == [True, True]
    assert "m east" in shown.inner_text("#tip")
    shown.mouse.up()
    assert "Revision" in waited(shown, f"move {name}")
    until(shown, "cityx.marks.has('ghost')", False.__eq__)
    moved = place_of(town, name) - place
    assert moved[:2] == pytest.approx([1.0, 0.6], abs=0.25)
    assert shown.evaluate("cityx.eye.position.toArray()") == pytest.approx(eye)
    until(shown, "cityx.city.pending", (0).__eq__)
    found = shown.evaluate(f"cityx.city.rows.placeOf('{name}').toArray()")
    assert [found[0], -found[2]] == pytest.approx((place + moved)[:2], abs=0.01)
    assert shown.evaluate("cityx.change('undo')")["status"] == "ok"
    assert place_of(town, name) == pytest.approx(place)
    assert shown.faults == []


def test_a_drag_into_a_wall_is_refused_in_words_and_escape_lets_go(shown, town):
    name, place, begin, end = taken(shown, town)
    pulled(shown, begin, end)
    shown.keyboard.press("Escape")
    assert shown.evaluate("[cityx.dragging.active, cityx.marks.has('ghost')]") == [False, False]
    shown.mouse.up()
    assert shown.evaluate("cityx.selected") == name  # Escape let go of the drag alone
    inside = next(iter(read_city(town / "city").layout.buildings.geometry)).representative_point()
    before = shown.evaluate("cityx.told.hash")
    shown.fill("#panel [aria-label='Metres to the east']", f"{inside.x - place[0]:.1f}")
    shown.fill("#panel [aria-label='Metres to the north']", f"{inside.y - place[1]:.1f}")
    shown.click("#panel button:has-text('Move, m')")
    assert "building" in waited(shown, f"move {name}")
    assert "stays where it was" in shown.inner_text("#notice")
    assert place_of(town, name) == pytest.approx(place)
    assert shown.evaluate("cityx.source.scene().then((told) => told.hash)") == before


def test_a_drag_that_begins_beside_what_is_selected_moves_the_camera(shown, town):
    _, _, begin, end = taken(shown, town)
    shown.evaluate("cityx.deselect()")
    eye = shown.evaluate("cityx.eye.position.toArray()")
    pulled(shown, begin, end)
    shown.mouse.up()
    assert shown.evaluate("cityx.marks.has('ghost')") is False
    assert shown.evaluate("cityx.eye.position.toArray()") != pytest.approx(eye, abs=0.1)


def test_a_sentence_speaks_of_the_area_that_is_drawn(shown):
    shown.evaluate("cityx.deselect(); cityx.panels.close()")
    shown.fill("#sentence", "plant three limes in this area")
    shown.click("#send")
    shown.wait_for_selector("#notice:has-text('Draw a path or an area first')", timeout=WAIT_MS)
    shown.evaluate("cityx.eye.plan(cityx.told.extent)")
    shown.click("#area")
    spots = shown.evaluate(
        """() => { const free = [];
        for (let x = 4; x < 640; x += 8) for (let y = 4; y < 400; y += 8)
          if (document.elementFromPoint(x, y)?.id === 'view' && cityx.pick(x, y)) free.push([x, y]);
        const by = (f) => free.reduce((one, other) => (f(other) > f(one) ? other : one));
        return [by((p) => p[0] + p[1]), by((p) => p[0] - p[1]), by((p) => -p[0] - p[1]),
                by((p) => p[1] - p[0])]; }"""
    )
    for x, y in spots:
        shown.mouse.click(x, y)
    shown.keyboard.press("Escape")
    assert shown.evaluate("cityx.sketch.points.length") == 4
    assert shown.evaluate("cityx.selected") == ""
    shown.fill("#sentence", "plant three limes in this area")
    shown.click("#send")
    assert "Revision" in waited(shown, "limes")
    assert shown.is_hidden("#undraw")  # what was drawn is used up
    assert shown.evaluate("cityx.change('undo')")["status"] == "ok"
    assert shown.faults == []


def test_a_tap_on_a_phone_tells_of_an_object(browser, port):
    phone = opened(browser, f"http://127.0.0.1:{port}/#token={TOKEN}", has_touch=True)
    x, y, name = phone.evaluate(
        """() => { for (let x = 60; x < 600; x += 7) for (let y = 150; y < 290; y += 7) {
             if (cityx.pick(x, y)?.layer === 'buildings') return [x, y, cityx.pick(x, y).id]; } }"""
    )
    phone.touchscreen.tap(x, y)
    phone.wait_for_selector(f"#panel:has-text('{name}')", timeout=WAIT_MS)
    phone.context.close()


def fingers(screen, kind, *places):
    """Let fingers begin, move, or end where they are now; a press of a screen, not of a mouse."""
    points = [{"x": x, "y": y, "id": number} for number, (x, y) in enumerate(places)]
    screen.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})


def test_a_finger_drags_a_thing_and_a_second_one_lets_go_of_it(browser, port, town):
    phone = opened(browser, f"http://127.0.0.1:{port}/#token={TOKEN}", has_touch=True)
    name, place = bench_of(town)
    goal = place + np.array([1.0, 0.6, 0.0])
    begin, end = above(phone, place.tolist(), goal.tolist())
    until(phone, f"cityx.pick({begin[0]}, {begin[1]})?.id", name.__eq__)
    phone.touchscreen.tap(*begin)
    until(phone, "cityx.selected", name.__eq__)
    phone.wait_for_selector(f"#panel:has-text('{name}')", timeout=WAIT_MS)
    screen = phone.context.new_cdp_session(phone)
    middle = [(one + other) / 2 for one, other in zip(begin, end, strict=True)]
    beside = begin[0], begin[1] + 9.0  # as broad as a finger is
    fingers(screen, "touchStart", beside)
    fingers(screen, "touchMove", middle)
    assert phone.evaluate("[cityx.dragging.active, cityx.marks.has('ghost')]") == [True, True]
    assert "m east" in phone.inner_text("#tip")
    beyond = phone.evaluate(
        """([x, y]) => { for (let far = 60; far < 300; far += 10) for (const way of [-far, far])
          if (document.elementFromPoint(x + way, y)?.id === 'view') return [x + way, y]; }""",
        middle,
    )
    fingers(screen, "touchStart", middle, beyond)
    assert phone.evaluate("[cityx.dragging.active, cityx.marks.has('ghost')]") == [False, False]
    fingers(screen, "touchEnd")
    assert place_of(town, name) == pytest.approx(place)
    assert phone.evaluate("cityx.selected") == name
    begin, end = above(phone, place.tolist(), goal.tolist())  # the second finger moved the camera
    eye = phone.evaluate("cityx.eye.position.toArray()")
    fingers(screen, "touchStart", begin)
    for share in (0.3, 0.7, 1.0):
        fingers(screen, "touchMove", [a + (b - a) * share for a, b in zip(begin, end, strict=True)])
    fingers(screen, "touchEnd")
    assert "Revision" in waited(phone, f"move {name}")
    assert (place_of(town, name) - place)[:2] == pytest.approx([1.0, 0.6], abs=0.25)
    assert phone.evaluate("cityx.eye.position.toArray()") == pytest.approx(eye)
    assert phone.evaluate("cityx.change('undo')")["status"] == "ok"
    assert phone.faults == []
    phone.context.close()


def test_a_page_goes_on_with_the_next_server_of_the_folder_and_with_no_other(
    browser, built_town, tmp_path, page
):
    del page
    folder = copy_of(built_town(lod=2), tmp_path / "town")
    with serving(folder, secret="5" * 64) as port:
        waiting = opened(browser, f"http://127.0.0.1:{port}/#token={TOKEN}")
    waiting.wait_for_selector("#notice:has-text('waits for it')", timeout=WAIT_MS)
    assert waiting.evaluate("cityx.change('make the tallest building red')") is None
    assert waiting.input_value("#sentence") == "make the tallest building red"
    sent = []
    waiting.on("request", lambda asked: sent.append(asked.headers.get("authorization", "")))
    with serving(folder, port, token="a token of another server", secret="6" * 64):
        waiting.wait_for_selector("#notice:has-text('Another program answers')", timeout=WAIT_MS)
    assert set(sent) == {""}  # it was told nothing that opens the city
    with serving(folder, port, token="that of the next server", secret="5" * 64):
        waiting.wait_for_selector("#notice", state="hidden", timeout=WAIT_MS)
        done = waiting.evaluate("cityx.change('make the tallest building red')")
        assert done["status"] == "ok"
    waiting.context.close()


def test_what_nobody_understands_is_said_on_the_page(shown):
    shown.fill("#sentence", "flibber the gnomes")
    shown.click("#send")
    shown.wait_for_selector("#said p.bad", timeout=WAIT_MS)
    assert "gnomes" in shown.inner_text("#said p.bad")


def test_search_layers_light_and_report_work_by_keyboard(shown):
    shown.fill("#wanted", "buildings over 20 m")
    shown.press("#wanted", "Enter")
    shown.wait_for_selector("#panel:has-text('found')", timeout=WAIT_MS)
    shown.click("#tools button:has-text('Layers')")
    shown.uncheck("#panel label:has-text('windows') input")
    assert shown.evaluate("cityx.city.hidden.has('windows')")
    shown.check("#panel label:has-text('windows') input")
    shown.select_option("#panel select", "height")
    assert shown.evaluate("cityx.city.coloring") == "height"
    shown.select_option("#panel select", "natural")
    shown.click("#tools button:has-text('Light')")
    shown.fill("#panel input[type=range] >> nth=0", "23")
    assert shown.evaluate("cityx.sky.sun.intensity") == 0
    shown.click("#tools button:has-text('Report')")
    shown.wait_for_selector("#panel:has-text('checks')", timeout=WAIT_MS)
    assert shown.faults == []


def test_the_glb_of_the_page_has_the_materials_and_is_valid(shown, tmp_path):
    from validating import errors_of

    shown.click("#tools button:has-text('More')")
    with shown.expect_download(timeout=WAIT_MS) as told:
        shown.click("#panel button:has-text('GLB')")
    path = tmp_path / "page.glb"
    told.value.save_as(path)
    file = Glb(path.read_bytes()).json
    assert len({material["name"] for material in file["materials"]}) > 8
    assert len(file["images"]) > 8
    assert any("EXT_mesh_gpu_instancing" in node.get("extensions", {}) for node in file["nodes"])
    assert errors_of([path]) == []


def test_the_map_is_saved_whole_or_what_is_selected_of_it(shown, tmp_path, town):
    layout = read_city(town / "city").layout
    names = {f"{number:016x}" for number in layout.buildings["id"].tolist()}
    shown.evaluate("cityx.deselect()")
    found = []
    for chosen in ("", min(names)):
        if chosen:
            shown.evaluate(f"cityx.flyTo('{chosen}')")
        shown.click("#tools button:has-text('More')")
        with shown.expect_download(timeout=WAIT_MS) as told:
            shown.click("#panel button:has-text('GeoJSON')")
        told.value.save_as(tmp_path / "map.geojson")
        record = json.loads((tmp_path / "map.geojson").read_text())
        found.append({feature["id"]: feature for feature in record["features"]})
    assert names < set(found[0])
    assert set(found[1]) == {min(names)}
    assert found[1][min(names)]["geometry"]["type"] == "Polygon"
    shown.evaluate("cityx.deselect()")


def test_the_camera_file_is_one_that_render_reads(shown, tmp_path, town):
    from cityx.city.camera import read_cameras

    record = shown.evaluate("cityx.eye.record('page', 480, 320)")
    (tmp_path / "camera.json").write_text(json.dumps(record))
    view = read_view(town / "city")
    (camera,), _ = read_cameras(tmp_path / "camera.json", view.frame, view.terrain)
    x, y, z = shown.evaluate("cityx.eye.position.toArray()")
    assert camera.position == pytest.approx((x, -z, y), abs=0.01)


@pytest.mark.parametrize("under", ["", "deep/site/"])
def test_a_static_site_shows_from_any_folder_of_a_server(
    browser, built_town, tmp_path, page, under
):
    del page
    site = tmp_path / (under or "site")
    site.parent.mkdir(exist_ok=True)
    export_site(built_town(lod=2), site, quiet)
    handler = partial(_Quiet, directory=str(tmp_path if under else site))
    with ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        base = f"http://127.0.0.1:{server.server_port}/{under}"
        shown = opened(browser, base)
        assert shown.faults == []
        assert all(url.startswith((base, "blob:", "data:")) for url in shown.asked)
        assert shown.is_hidden("#desk")
        building = shown.evaluate("[...cityx.city.ids()][0]")
        assert shown.evaluate("(id) => cityx.source.details(id)", building)["id"] == building
        answer = shown.evaluate("cityx.source.find('buildings over 5 m')")
        assert "need cityx view" in answer["message"]
        shown.context.close()
        server.shutdown()


class _Quiet(SimpleHTTPRequestHandler):
    def log_message(self, *words):
        pass


def test_a_wrong_token_and_a_damaged_chunk_are_said_on_the_page(browser, port):
    page = browser.new_context(viewport=SIZE).new_page()
    page.goto(f"http://127.0.0.1:{port}/#token=wrong")
    page.wait_for_selector("#notice:has-text('token')", timeout=WAIT_MS)
    page.context.close()
    page = browser.new_context(viewport=SIZE).new_page()
    page.route("**/chunks/*.glb", lambda route: route.fulfill(body=b"glTF" + b"\0" * 40))
    page.goto(f"http://127.0.0.1:{port}/#token={TOKEN}")
    page.wait_for_selector("#notice:has-text('cannot be shown')", timeout=WAIT_MS)
    page.wait_for_selector("body[data-state=ready]", state="attached", timeout=WAIT_MS)
    told = page.evaluate("cityx.told.chunks.length")
    assert f"{told} parts of the city cannot be shown" in page.inner_text("#notice")
    assert f"{told} parts missing" in page.inner_text("#where")  # that stays
    page.context.close()
    page = browser.new_context(viewport=SIZE).new_page()
    page.route("**/paints/*.glb", lambda route: route.fulfill(body=b"glTF" + b"\0" * 40))
    page.goto(f"http://127.0.0.1:{port}/#token={TOKEN}")
    page.wait_for_selector("#notice:has-text('The city cannot be shown')", timeout=WAIT_MS)
    page.context.close()
