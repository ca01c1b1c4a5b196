"""`Project.view`: the page of a project, from Python."""

import pytest
import requests

import cityx
from cityx.errors import EngineError


def test_a_project_shows_its_page_until_it_is_closed(town, page):  # noqa: ARG001
    shown = cityx.open(town).view()
    address, _, token = shown.url.partition("#token=")
    assert shown.url in shown._repr_html_()
    assert requests.get(address, timeout=30).ok
    scene = requests.get(
        f"{address}scene.json", headers={"Authorization": f"Bearer {token}"}, timeout=60
    )
    assert scene.json()["chunks"]
    shown.close()
    with pytest.raises(requests.ConnectionError):
        requests.get(address, timeout=5)


def test_a_page_that_cannot_be_served_says_why(town, monkeypatch):
    monkeypatch.setattr("sys.executable", "/bin/false")
    with pytest.raises(EngineError, match="cannot be served"):
        cityx.open(town).view()
