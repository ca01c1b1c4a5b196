"""Pages of tests in the system's Chromium, without a graphics card."""

import shutil

import pytest

BROWSER = next(
    (found for name in ("chromium", "google-chrome", "chromium-browser")
     if (found := shutil.which(name))), None,
)  # fmt: skip
NO_BROWSER = [
    pytest.mark.slow,
    pytest.mark.skipif(BROWSER is None, reason="no Chromium on this machine"),
]
FLAGS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
         "--disable-background-networking"]  # fmt: skip
SIZE = {"width": 640, "height": 400}  # software draws it
WAIT_MS = 60_000


def opened(browser, url, **how):
    page = browser.new_context(**{"viewport": SIZE, **how}).new_page()
    page.faults = []
    page.on("pageerror", lambda error: page.faults.append(str(error)))
    page.on("console", lambda said: said.type == "error" and page.faults.append(said.text))
    page.asked = []
    page.on("request", lambda request: page.asked.append(request.url))
    page.goto(url)
    page.wait_for_selector("body[data-state=ready]", state="attached", timeout=WAIT_MS)
    return page


def until(page, expression, fits):
    """Look at a page until what an expression gives fits, and return it."""
    for _ in range(WAIT_MS // 100):
        found = page.evaluate(expression)
        if fits(found):
            return found
        page.wait_for_timeout(100)
    raise AssertionError(f"{expression} is still {found}")
