"""The page of a study works in a real browser: by keyboard, on a phone, after a break."""

import json
import shutil
import threading

import pytest
from cityx_bench.survey.serving import server_of
from cityx_bench.survey.study import make_study
from PIL import Image

BROWSER = next(
    (found for name in ("chromium", "google-chrome", "chromium-browser")
     if (found := shutil.which(name))), None,
)  # fmt: skip
pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(BROWSER is None, reason="no Chromium on this machine"),
]
PHONE = {"viewport": {"width": 360, "height": 640}, "has_touch": True, "is_mobile": True}
DESK = {"viewport": {"width": 1280, "height": 800}}
TOUCH = 44  # pixels that a finger needs


@pytest.fixture(scope="module")
def browser():
    api = pytest.importorskip("playwright.sync_api")
    with api.sync_playwright() as driver:
        flags = ["--no-sandbox", "--disable-gpu", "--disable-background-networking"]
        found = driver.chromium.launch(executable_path=BROWSER, args=flags)
        yield found
        found.close()


@pytest.fixture
def site(tmp_path):
    for name, colour in (("ours", 200), ("theirs", 80)):
        (tmp_path / name).mkdir()
        for k in range(3):
            Image.new("RGB", (160, 90), (colour, 40 * k, 60)).save(tmp_path / name / f"{k}.png")
    folder = tmp_path / "study"
    study = make_study({name: tmp_path / name for name in ("ours", "theirs")}, folder)
    with server_of(folder) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield study, folder, f"http://127.0.0.1:{server.server_port}/"
        server.shutdown()


def opened(browser, url, **how):
    page = browser.new_context(**how).new_page()
    page.faults = []
    page.on("pageerror", lambda error: page.faults.append(str(error)))
    page.goto(url)
    return page


def stored(folder):
    (path,) = (folder / "answers").glob("*.json")
    return json.loads(path.read_text())


def test_all_is_rated_by_the_keyboard_alone(browser, site):
    study, folder, url = site
    page = opened(browser, url, **DESK)
    page.focus("#begin")
    page.keyboard.press("Enter")
    looks = len(study.items) + study.repeats
    for k in range(looks):
        page.wait_for_selector("#rate:not([hidden])")
        page.keyboard.press("Enter")  # nothing happens before both are rated
        assert page.evaluate("state.place") == k
        page.keyboard.press(str(k % 5 + 1))
        page.keyboard.press("ArrowRight" if k == 0 else "2")
        page.keyboard.press("Enter")
    page.wait_for_selector("text=Your answers are stored.")
    record = stored(folder)
    assert len(record["ratings"]) == 2 * looks
    first, second = record["ratings"][:2]
    assert (first["question"], first["value"]) == ("aesthetic", 1)
    assert second["question"] == "rationality"
    assert [one["value"] for one in record["ratings"][2::2]] == [k % 5 + 1 for k in range(1, looks)]
    assert page.faults == []


@pytest.mark.parametrize("how", [PHONE, DESK], ids=["phone", "desk"])
def test_it_fits_the_screen_and_is_rated_by_touch(browser, site, how):
    study, folder, url = site
    page = opened(browser, url, **how)
    page.click("text=I work in 3D graphics")
    page.click("#begin")
    for _ in range(len(study.items) + study.repeats):
        assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
        labels = page.locator(".scale label")
        assert labels.count() == 10
        for k in range(10):
            box = labels.nth(k).bounding_box()
            assert min(box["width"], box["height"]) >= TOUCH
        assert page.locator("#next").is_disabled()
        labels.nth(3).click()
        labels.nth(9).click()
        page.click("#next")
    page.wait_for_selector("text=Your answers are stored.")
    record = stored(folder)
    assert record["group"] == "expert"
    assert {(one["question"], one["value"]) for one in record["ratings"]} == {
        ("aesthetic", 4), ("rationality", 5),
    }  # fmt: skip
    assert page.faults == []


def test_people_come_back_where_they_stopped_and_see_an_order_of_their_own(browser, site):
    study, _, url = site
    page = opened(browser, url, **DESK)
    page.click("#begin")
    page.locator(".scale label").nth(1).click()
    page.locator(".scale label").nth(6).click()
    page.click("#next")
    shown = page.get_attribute("#picture", "src")
    page.reload()
    assert page.get_attribute("#picture", "src") == shown
    page.click("#back")
    assert page.locator(".scale input:checked").count() == 2
    orders = []
    for _ in range(4):
        other = opened(browser, url, **DESK)
        orders.append(tuple(other.evaluate("order.map(([item]) => item)")))
        assert sorted(orders[-1][: len(study.items)]) == sorted(study.items)
    assert len(set(orders)) > 1


def test_without_a_server_the_answers_are_saved_as_a_file(browser, site, tmp_path):
    study, folder, _ = site
    page = opened(browser, (folder / "index.html").as_uri(), accept_downloads=True, **DESK)
    page.click("#begin")
    for _ in range(len(study.items) + study.repeats):
        page.locator(".scale label").nth(0).click()
        page.locator(".scale label").nth(5).click()
        page.click("#next")
    page.wait_for_selector("text=could not be sent")
    with page.expect_download() as waiting:
        page.click("#save")
    waiting.value.save_as(tmp_path / "answers.json")
    record = json.loads((tmp_path / "answers.json").read_text())
    assert record["study"] == study.digest
    assert {one["value"] for one in record["ratings"]} == {1}
