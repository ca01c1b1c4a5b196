"""The page for everyone: named controls, an order of focus, contrast, and the width of a phone."""

import pytest
from browsing import NO_BROWSER, SIZE, WAIT_MS, opened, until
from page_server import TOKEN, serving

from cityx.viewer.page import SOURCES

pytestmark = NO_BROWSER
AXE = SOURCES / "node_modules" / "axe-core" / "axe.min.js"
GRAVE = ("serious", "critical")
PHONE = {"width": 360, "height": 740}
# What axe finds; contrast is judged without the picture, before the lightest sky and the darkest.
FOUND = """async (back) => {
  const canvas = document.getElementById('view');
  canvas.style.opacity = 0;
  document.body.style.background = back;
  const told = await axe.run(document, {resultTypes: ['violations']});
  canvas.style.opacity = '';
  document.body.style.background = '';
  return told.violations.map((v) => [v.impact, v.id, v.nodes.map((n) => n.html.slice(0, 90))]);
}"""
# Controls that can be seen and lie outside the page, or under something else.
HIDDEN = """() => [...document.querySelectorAll('button, input, select, a')].filter((each) => {
  const box = each.getBoundingClientRect();
  if (!box.width || each.closest('#content, #close')) return false;
  const x = box.x + box.width / 2, y = box.y + box.height / 2;
  const top = document.elementFromPoint(x, y);
  return box.left < 0 || box.right > innerWidth || !(top && (top === each || each.contains(top)));
}).map((each) => each.id || each.textContent)"""


@pytest.fixture(scope="module")
def port(town, page):  # noqa: ARG001
    with serving(town) as found:
        yield found


def shown_at(browser, port, size):
    page = opened(browser, f"http://127.0.0.1:{port}/#token={TOKEN}", viewport=size)
    page.evaluate("cityx.renderer.setAnimationLoop(null)")  # nothing is drawn any more
    return page


@pytest.fixture(scope="module")
def shown(browser, port):
    page = shown_at(browser, port, SIZE)
    yield page
    page.context.close()


@pytest.fixture(scope="module")
def phone(browser, port):
    page = shown_at(browser, port, PHONE)
    yield page
    page.context.close()


def test_axe_finds_nothing_serious_in_any_panel(shown):
    if not AXE.is_file():
        pytest.skip("axe-core is missing: npm ci in cityx/viewer/app")
    shown.evaluate(AXE.read_text())
    building = shown.evaluate("[...cityx.city.ids()][0]")
    panels = {
        "none": "cityx.panels.close()",
        "object": f"cityx.tell('{building}', {{layer: 'buildings', prototype: '', owner: ''}})",
        "found": "cityx.find('buildings over 5 m')",
        "answers": "cityx.change('flibber the gnomes')",
        **dict.fromkeys(("Layers", "Light", "Report", "More"), ""),
    }
    for name, act in panels.items():
        shown.evaluate(act) if act else shown.click(f"#tools button:has-text('{name}')")
        if name == "Report":
            shown.wait_for_selector("#panel:has-text('checks')", timeout=WAIT_MS)
        for back in ("#ffffff", "#000000"):
            grave = [each for each in shown.evaluate(FOUND, back) if each[0] in GRAVE]
            assert not grave, (name, back, grave)
    shown.evaluate("cityx.panels.close(); document.getElementById('foot').style.color = '#777'")
    assert "color-contrast" in {each[1] for each in shown.evaluate(FOUND, "#000000")}
    shown.evaluate("document.getElementById('foot').style.color = ''")


def test_tab_goes_through_the_page_in_the_order_in_which_it_is_read(shown):
    shown.evaluate("cityx.panels.close(); document.getElementById('view').focus()")
    names = ["view"]
    for _ in range(30):
        shown.keyboard.press("Tab")
        name = shown.evaluate(
            "(document.activeElement.id || document.activeElement.textContent).trim()"
        )
        if name in names or not name:
            break
        names.append(name)
    wanted = ["view", "wanted", "Orbit", "Walk", "Fly", "Plan", "Whole", "Layers", "Light",
              "Report", "More", "path", "area", "sentence", "send", "undo", "redo"]  # fmt: skip
    assert [name for name in names if name in wanted] == wanted
    shown.focus("#undo")
    shown.keyboard.press("Shift+Tab")  # by the keyboard, so that the ring is shown
    assert shown.evaluate("getComputedStyle(document.activeElement).outlineStyle") == "solid"


def test_a_panel_takes_the_focus_and_gives_it_back(shown):
    shown.focus("#tools button:has-text('Layers')")
    shown.keyboard.press("Enter")
    assert shown.evaluate("document.activeElement.id") == "close"
    shown.keyboard.press("Enter")
    assert shown.is_hidden("#panel")
    assert shown.evaluate("document.activeElement.textContent") == "Layers"


def test_a_phone_shows_every_control_and_does_not_scroll_sideways(phone):
    width = "document.scrollingElement.scrollWidth"
    assert phone.evaluate(width) <= PHONE["width"]
    assert phone.evaluate(HIDDEN) == []
    phone.evaluate("document.getElementById('time').hidden = false")  # as where traffic moves
    phone.fill("#sentence", "flibber the gnomes")
    phone.click("#send")
    phone.wait_for_selector("#said p.bad", timeout=WAIT_MS)
    assert phone.evaluate(HIDDEN) == []
    phone.click("#tools button:has-text('More')")
    assert phone.is_visible("#said p.bad")  # the answer is seen beside a panel
    assert phone.evaluate(
        "said.getBoundingClientRect().bottom <= panel.getBoundingClientRect().top"
    )
    phone.click("#close")
    phone.click("#hush")
    assert phone.is_hidden("#said p")
    for name in ("Layers", "Light", "Report", "More"):
        phone.click(f"#tools button:has-text('{name}')")
        until(phone, "document.querySelector('#panel h2')?.textContent", bool)
        assert phone.evaluate(width) <= PHONE["width"]
        assert phone.evaluate("panel.scrollWidth - panel.clientWidth") == 0
        phone.wait_for_selector("#edit", state="hidden", timeout=WAIT_MS)  # it makes way
        assert phone.is_visible("#credits")
        phone.click("#close")
        phone.wait_for_selector("#edit", state="visible", timeout=WAIT_MS)
