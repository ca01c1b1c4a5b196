import json
from math import degrees
from pathlib import Path

import numpy as np
import pytest

from cityx.city import Environment, Frame, Terrain, flat_terrain
from cityx.city.camera import read_cameras
from cityx.errors import InputError

SOHO = Frame(51.513, -0.136)
EXTENT = (-500.0, -500.0, 500.0, 500.0)
REFERENCE = Path(__file__).parents[2] / "../shared/reference/cameras.json"
VIEW = {"lat": 51.513, "lon": -0.136, "height_m": 1.7, "heading_deg": 90, "pitch_deg": 3}


def write(folder, content):
    path = folder / "cameras.json"
    path.write_text(content if isinstance(content, str) else json.dumps(content))
    return path


def test_a_geographic_camera_stands_on_the_terrain(tmp_path):
    terrain = Terrain((0.0, 0.0), 1.0, np.full((1, 1), 12.0))
    path = write(tmp_path, {"cameras": [{"name": "here", **VIEW}]})
    (camera,), _ = read_cameras(path, SOHO, terrain)
    assert camera.position == pytest.approx((0.0, 0.0, 13.7), abs=1e-3)
    assert (camera.name, round(degrees(camera.heading)), camera.width) == ("here", 90, 960)


def test_a_camera_may_be_given_in_metres(tmp_path):
    view = {"position": [1, 2, 3], "heading_deg": -90, "hfov_deg": 50, "width": 64, "height": 48}
    (camera,), _ = read_cameras(write(tmp_path, {"cameras": {"a": view}}), SOHO, flat_terrain())
    assert (camera.position, camera.name) == ((1.0, 2.0, 3.0), "a")
    assert (round(degrees(camera.heading)), camera.width, camera.height) == (270, 64, 48)


def test_places_outside_the_site_are_left_out(tmp_path):
    far = {**VIEW, "lat": 35.69, "lon": 139.78}
    places = {"soho": {"cameras": {"street": VIEW}}, "kanda": {"cameras": {"street": far}}}
    path = write(tmp_path, {"places": places})
    cameras, _ = read_cameras(path, SOHO, flat_terrain(), extent=EXTENT)
    assert [camera.name for camera in cameras] == ["street"]


def test_a_file_without_a_camera_in_the_site_names_its_places(tmp_path):
    path = write(tmp_path, {"places": {"soho": {"cameras": {"street": VIEW}}}})
    with pytest.raises(InputError, match=r"no camera inside the site. Its places: soho"):
        read_cameras(path, Frame(0.0, 0.0), flat_terrain(), extent=EXTENT)


def test_the_light_of_a_file_replaces_only_what_it_names(tmp_path):
    render = {"sun_elevation_deg": 40, "samples": 8, "view_transform": "AgX"}
    path = write(tmp_path, {"render": render, "cameras": [VIEW]})
    _, light = read_cameras(path, SOHO, flat_terrain())
    environment = light.apply(Environment(sun_azimuth=1.0, exposure=0.5))
    assert light.samples == 8
    assert degrees(environment.sun_elevation) == pytest.approx(40)
    assert (environment.sun_azimuth, environment.exposure) == (1.0, 0.5)


def test_every_fault_of_a_file_is_named_at_once(tmp_path):
    views = [{"lat": 95, "lon": "x", "heading_deg": 0}, {**VIEW, "hfov_deg": 0}, 7]
    with pytest.raises(InputError) as caught:
        read_cameras(write(tmp_path, {"cameras": views}), SOHO, flat_terrain())
    text = str(caught.value)
    assert "camera0: lat is 95, allowed is -90 to 90." in text
    assert "camera0: lon is 'x', a number is needed." in text
    assert "camera1: hfov_deg is 0, allowed is 1 to 175." in text
    assert "cameras[2] is int, an object is needed." in text


@pytest.mark.parametrize("content", ["{", "[]", "{}", '{"cameras": 3}', '{"places": []}'])
def test_a_file_of_another_kind_is_an_input_error(tmp_path, content):
    with pytest.raises(InputError):
        read_cameras(write(tmp_path, content), SOHO, flat_terrain())


def test_a_missing_file_is_an_input_error(tmp_path):
    with pytest.raises(InputError, match="cannot read cameras"):
        read_cameras(tmp_path / "none.json", SOHO, flat_terrain())


@pytest.mark.shared
@pytest.mark.skipif(not REFERENCE.exists(), reason="the reference views are not here")
def test_the_reference_views_are_read():
    cameras, light = read_cameras(REFERENCE, SOHO, flat_terrain(), extent=EXTENT)
    assert [camera.name for camera in cameras] == ["street", "aerial", "junction"]
    assert (light.samples, light.sky_strength) == (48, 0.12)
    everywhere, _ = read_cameras(REFERENCE, SOHO, flat_terrain())
    assert len(everywhere) == 9
    assert everywhere[0].name == "london_soho_street"
