import json

import numpy as np
import pytest
import shapely

from cityx.assets.library.records import (
    make_catalogue,
    read_paper_records,
    rectangle_columns,
    validate_document,
)
from cityx.errors import InputError

PAPER = r"""{
  "buildings": [
    {
      "path": "City\1825\Assets.blend",
      "collection": "Eu_1_building_8",
      "width": 49,
      "length": 38,
      "area": 1862,
      "coordinates": { "x": 158.5, "y": 165 },
      "style": "modern"
    }, ...
    ],
    "plants":[...]
}"""


def test_the_record_of_the_paper_is_read_and_is_valid():
    document = read_paper_records(PAPER)
    (record,) = document["buildings"]
    assert record["path"] == "City/1825/Assets.blend"
    assert record["area"] == record["width"] * record["length"] == 1862
    assert validate_document(document) == []


@pytest.mark.parametrize("path", ["City\\1.blend", "/etc/passwd", "../out.npz", "a/../../b", ""])
def test_paths_out_of_the_library_are_refused(path):
    record = read_paper_records(PAPER)["buildings"][0] | {"path": path}
    assert any("path" in fault for fault in validate_document({"buildings": [record]}))


def test_a_record_without_an_attribute_of_the_paper_is_refused():
    for name in ("path", "collection", "width", "length", "area", "coordinates", "style"):
        record = dict(read_paper_records(PAPER)["buildings"][0])
        del record[name]
        assert any(name in fault for fault in validate_document({"buildings": [record]}))


def test_text_that_is_no_json_is_refused_with_its_place():
    with pytest.raises(InputError, match="line 1"):
        read_paper_records('{"buildings": [nonsense]}')


def test_own_records_are_valid_and_survive_json():
    outline = np.array([shapely.Polygon([(0, 0), (9, 0), (9, 4), (4, 4), (4, 8), (0, 8)])], object)
    table = make_catalogue(
        1, group="buildings", path="a/b.npz", collection="l", footprint=outline, height=3.0,
        front=0.0, storey_height=np.nan, licence="MIT", source="imported", triangles=2,
        triangles_unique=2,
        **rectangle_columns(outline),
    )  # fmt: skip
    document = json.loads(json.dumps(table.document()))
    assert validate_document(document) == []
    assert document["buildings"][0]["area"] == 72.0
    assert document["buildings"][0]["footprint_area"] == 52.0
    assert document["buildings"][0]["storey_height"] is None
