import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))  # for glb, validating

pytest.importorskip("starlette", reason="cityx view needs the extra view")
pytest.importorskip("meshopt", reason="cityx view needs the extra view")

from browsing import BROWSER, FLAGS
from copies import copy_of

from cityx.errors import MissingDependency
from cityx.viewer.page import page_folder


@pytest.fixture(scope="session")
def page():
    try:
        return page_folder()
    except MissingDependency as error:
        pytest.skip(str(error))


@pytest.fixture(scope="module")
def town(built_town, tmp_path_factory):
    """A town of this module alone, to be changed."""
    return copy_of(built_town(lod=2), tmp_path_factory.mktemp("viewer") / "town")


@pytest.fixture(scope="module")  # its loop must end before tests that run one
def browser():
    api = pytest.importorskip("playwright.sync_api")
    with api.sync_playwright() as driver:
        found = driver.chromium.launch(executable_path=BROWSER, args=FLAGS)
        yield found
        found.close()
