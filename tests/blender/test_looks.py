"""The pictures that a model looks at: of the whole, of a street, and of what was asked for."""

import io

import numpy as np
import pytest
from PIL import Image

from cityx.agents.briefs import read_request
from cityx.city.store import read_city
from cityx.ids import id_text
from cityx.options import BuildOptions
from cityx.projects import views

pytestmark = pytest.mark.blender


def test_what_was_asked_for_is_in_a_picture_with_its_id(built_town, tmp_path, monkeypatch):
    monkeypatch.setattr(views, "LOOK", (64, 64))
    monkeypatch.setattr(views, "LOOK_SAMPLES", 2)
    city = read_city(built_town(lod=1) / "city")
    request = read_request(BuildOptions(text="A town with one church, in the rain"))
    found = views.looks_of(city, request, tmp_path / "looks", print, np.zeros(0, np.uint64))
    assert [view.name for view in found] == ["aerial", "street", "asked_0"]
    for view in found:
        assert Image.open(io.BytesIO(view.picture)).size == (64, 64)
    (church,) = city.layout.buildings["id"][city.layout.buildings["use"] == "church"]
    assert "tag=church" in found[2].shows
    name = id_text(int(church))
    assert f"tag=church {name} at" in found[2].shows
    others = {id_text(int(one)) for one in city.layout.buildings["id"]} - {name}
    assert not any(f"tag=church {one}" in view.shows for view in found for one in others)
