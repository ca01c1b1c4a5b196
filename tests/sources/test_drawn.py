import json
from contextlib import suppress

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from cityx.city.layout import CURVE
from cityx.errors import InputError
from cityx.sources.drawn import read_drawn

LON, LAT = 24.94, 60.17
NORTH = LAT + 0.001
METRES = {"units": "metres"}
UNKNOWN_CRS = '{"type": "Point", "coordinates": [1, 2], "crs": {"name": "EPSG:3067"}}'


def feature(form, coordinates, /, **properties):
    return {
        "type": "Feature",
        "properties": properties,
        "geometry": {"type": form, "coordinates": coordinates},
    }


def written(tmp_path, *features, name="town.geojson", **more):
    path = tmp_path / name
    path.write_text(json.dumps({"type": "FeatureCollection", "features": features, **more}))
    return path


def square(x, y, size):
    return [[[x, y], [x + size, y], [x + size, y + size], [x, y + size], [x, y]]]


def test_plain_words_and_words_of_maps_become_a_layout(tmp_path):
    path = written(
        tmp_path,
        feature("LineString", [[LON, LAT], [LON + 0.002, LAT]], kind="street", name="Long Row"),
        feature("LineString", [[LON, LAT], [LON, LAT + 0.0002]], highway="service"),
        feature("LineString", [[LON, NORTH], [LON + 0.002, NORTH]], kind="river", width=20),
        feature("Polygon", square(LON, LAT + 0.0003, 0.0002), building="house", height=9.5),
        feature("Point", [LON + 0.001, LAT + 0.0002], kind="tree"),
        feature("LineString", [[LON, LAT], [LON, LAT + 0.0005]], kind="route", name="patrol"),
    )  # fmt: skip
    city = read_drawn(path)
    layout = city.layout
    assert (city.frame.latitude, city.frame.longitude) == pytest.approx((LAT + 0.0005, LON + 0.001))
    curves = layout.lines[layout.lines["kind"] == CURVE]
    assert curves["tags"].tolist() == ['{"kind": "residential", "name": "Long Row"}']
    assert curves.geometry.length.sum() == pytest.approx(111, abs=2)
    assert layout.roads["kind"].tolist() == ["service"]
    assert layout.areas["kind"].tolist() == ["river"]
    assert layout.areas.geometry.area.sum() == pytest.approx(20 * 131, rel=0.03)  # with its caps
    assert layout.buildings["height"].tolist() == [9.5]
    assert layout.points["kind"].tolist() == ["tree"]
    assert sorted(layout.lines["kind"]) == [CURVE, "route"]
    assert set(layout.roads["source"]) == {"drawn/town.geojson/feature 1"}


def test_a_drawing_in_metres_needs_no_place(tmp_path):
    path = written(
        tmp_path,
        feature("LineString", [[0, 0], [300, 0]], kind="road"),
        **METRES,
    )
    layout = read_drawn(path).layout
    assert shapely.get_coordinates(layout.lines.geometry.to_numpy()).tolist() == [[0, 0], [300, 0]]


def test_metres_about_an_origin_lie_there(tmp_path):
    origin = {"latitude": 48.2, "longitude": 16.3}
    path = written(
        tmp_path, feature("LineString", [[0, 0], [9, 0]], kind="road"), origin=origin, **METRES
    )
    city = read_drawn(path)
    assert (city.frame.latitude, city.frame.longitude) == (48.2, 16.3)
    wrong = written(
        tmp_path, feature("Point", [0, 0], kind="tree"), origin={"latitude": 99}, **METRES
    )
    with pytest.raises(InputError, match='"origin" is not like'):
        read_drawn(wrong)


def test_a_boundary_cuts_the_drawing(tmp_path):
    path = written(
        tmp_path,
        feature("Polygon", square(0, 0, 100), kind="boundary"),
        feature("LineString", [[-50, 50], [150, 50]], kind="road"),
        **METRES,
    )
    layout = read_drawn(path).layout
    assert layout.extent == pytest.approx((0, 0, 100, 100), abs=0.11)
    assert layout.lines.geometry.length.sum() == pytest.approx(100, abs=0.5)


def test_a_track_is_a_route_unless_it_says_more(tmp_path):
    path = tmp_path / "walk.gpx"
    points = "".join(f'<trkpt lat="{LAT + i * 1e-4}" lon="{LON}"/>' for i in range(9))
    route = "".join(f'<rtept lat="{LAT}" lon="{LON + i * 1e-4}"/>' for i in range(9))
    path.write_text(
        f'<gpx version="1.1" xmlns="http://www.topografix.com/GPX/1/1"><trk><name>Walk</name>'
        f"<trkseg>{points}</trkseg></trk><rte><type>road</type>{route}</rte>"
        f'<wpt lat="{LAT}" lon="{LON}"><type>tree</type></wpt></gpx>'
    )
    layout = read_drawn(path).layout
    assert sorted(layout.lines["kind"]) == [CURVE, "route"]
    assert layout.points["kind"].tolist() == ["tree"]


def test_every_fault_is_told_at_once(tmp_path):
    path = written(
        tmp_path,
        feature("LineString", [[0, 0], [300, 0]], kind="road"),
        feature("LineString", [[1, 1], [1, 1]], kind="road"),
        feature("LineString", [[1, 1], [2, 1]], kind="rode"),
        feature("LineString", [[1, 1], [2, 1]]),
        feature("LineString", "nonsense", kind="road"),
        {"type": "Feature", "properties": {}, "geometry": None},
        feature("Point", [1, 1], kind="boundary"),
    )
    with pytest.raises(InputError) as caught:
        read_drawn(path)
    said = str(caught.value)
    for part in (
        "feature 0 has coordinates outside longitude and latitude; a drawing in metres says",
        "feature 1 is a line without length",
        'feature 2 has the kind "rode", which has no meaning. Did you mean',
        'feature 3 has no "kind" and no tag of a map',
        "feature 4 has a geometry that cannot be read",
        "feature 5 has no geometry",
        "feature 6 is a boundary, but no polygon",
    ):
        assert part in said, part


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("a.geojson", "{", "is not JSON"),
        ("a.geojson", "[1, 2]", "is no GeoJSON"),
        ("a.geojson", '{"type": "FeatureCollection", "features": []}', "draws nothing"),
        ("a.geojson", '{"type": "FeatureCollection", "features": 3}', '"features" is no list'),
        ("a.geojson", UNKNOWN_CRS, "is not WGS84"),
        ("a.gpx", "<gpx>", "is not XML"),
        ("a.gpx", "<kml/>", "with root <kml>"),
        ("a.gpx", '<gpx><rte><rtept lat="x" lon="1"/><rtept/></rte></gpx>', "are no numbers"),
        ("a.gpx", "<gpx><trk/></gpx>", "has no coordinates"),
    ],
)  # fmt: skip
def test_what_is_no_drawing_is_refused(tmp_path, name, text, said):
    path = tmp_path / name
    path.write_text(text)
    with pytest.raises(InputError, match=said):
        read_drawn(path)


MEMBERS = ["type", "features", "geometry", "coordinates", "properties", "kind", "crs"]
SCALARS = st.none() | st.booleans() | st.text(max_size=8) | st.integers(-200, 200)


def nested(inner):
    return st.lists(inner, max_size=4) | st.dictionaries(
        st.sampled_from(MEMBERS), inner, max_size=4
    )


@settings(max_examples=200, deadline=None, derandomize=True)
@given(value=st.recursive(SCALARS, nested, max_leaves=20))
def test_any_json_is_read_or_refused_with_a_sentence(tmp_path_factory, value):
    path = tmp_path_factory.getbasetemp() / "any.geojson"
    path.write_text(json.dumps(value))
    with suppress(InputError):
        assert np.isfinite(read_drawn(path).layout.extent).all()
