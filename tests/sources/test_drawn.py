import json

import pytest

from cityx.errors import InputError
from cityx.sources.drawn import drawn_city, read_drawing, with_drawing

ORIGIN = {"units": "metres", "origin": {"latitude": 48.2, "longitude": 16.3}}
LINE = {"type": "LineString", "coordinates": [[0, 0], [100, 0]]}


@pytest.fixture
def drawing(tmp_path):
    def make(*geometries, head=ORIGIN, properties=None, text=None):
        features = [{"type": "Feature", "geometry": geometry, "properties": properties}
                    for geometry in geometries]  # fmt: skip
        document = {"type": "FeatureCollection", "features": features, **head}
        file = tmp_path / "town.geojson"
        file.write_text(json.dumps(document) if text is None else text)
        return file

    return make


def test_metres_about_an_origin_keep_their_length(drawing):
    city = drawn_city(read_drawing(drawing(LINE)))
    assert city.layout.lines.geometry.length.tolist() == pytest.approx([100.0], abs=1e-3)
    assert city.frame.latitude == pytest.approx(48.2, abs=1e-3)


def test_degrees_are_the_usual_units(drawing):
    line = {"type": "LineString", "coordinates": [[16.3, 48.2], [16.301, 48.2]]}
    city = drawn_city(read_drawing(drawing(line, head={})))
    assert city.layout.lines.geometry.length.iloc[0] == pytest.approx(74.3, abs=0.2)


def test_a_drawing_lies_in_the_frame_of_the_map_it_is_added_to(drawing):
    drawn = read_drawing(drawing(LINE))
    city = drawn_city(drawn)
    assert len(with_drawing(city, drawn).layout.lines) == 1  # the same curves again


def test_lines_of_several_parts_are_curves_of_one_description(drawing):
    parts = {"type": "MultiLineString", "coordinates": [[[0, 0], [9, 0]], [[0, 9], [9, 9, 4]]]}
    drawn = read_drawing(drawing(parts, properties={"kind": "footway"}))
    assert drawn.source == ("drawing/0", "drawing/0/1")
    assert drawn.properties == ({"kind": "footway"},) * 2


def test_every_fault_is_told_with_its_feature(drawing):
    bad = drawing(
        LINE,
        {"type": "Point", "coordinates": [0, 0]},
        {"type": "LineString", "coordinates": [[0, 0]]},
        {"type": "LineString", "coordinates": [[0, 0], ["a", 0]]},
        {"type": "LineString", "coordinates": [[0, 0], [float("nan"), 0]]},
        None,
    )
    with pytest.raises(InputError) as caught:
        read_drawing(bad)
    text = str(caught.value)
    for part in ("feature 1 is a Point", "feature 2 has", "feature 3 has", "feature 4 has a coord",
                 "feature 5 is a None"):  # fmt: skip
        assert part in text


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"type": "FeatureCollection"}', "{" * 5000,
                                  '{"type": "FeatureCollection", "features": []}'])  # fmt: skip
def test_what_is_no_drawing_is_refused(drawing, text):
    with pytest.raises(InputError):
        read_drawing(drawing(text=text))


def test_metres_without_an_origin_are_refused(drawing):
    with pytest.raises(InputError, match="origin"):
        read_drawing(drawing(LINE, head={"units": "metres"}))


def test_metres_taken_for_degrees_are_refused(drawing):
    with pytest.raises(InputError, match="no longitude and latitude"):
        drawn_city(read_drawing(drawing({"type": "LineString", "coordinates": [[0, 0], [900, 0]]},
                                        head={})))  # fmt: skip
