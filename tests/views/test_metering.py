"""How much sun falls on what a camera sees."""

from dataclasses import replace

import numpy as np
import pytest
from crossing_town import crossing_town

from cityx.blender.metering import MOST_STOPS, SUNLIT, metered_stops, shade_stops, sunlit_streets
from cityx.city.camera import Camera
from cityx.city.environment import Environment
from cityx.city.mesh import one_mesh
from cityx.city.store import view_of

# From above the western arm, towards the east; the sun stands in the south.
HIGH = Camera("aerial", (-60.0, 0.0, 60.0), np.pi / 2, -0.6, np.pi / 2, 160, 90)
LOW = Camera("street", (-60.0, 0.0, 1.7), np.pi / 2, -0.1, np.pi / 2, 160, 90)
NOON = Environment(sun_elevation=np.radians(30.0), sun_azimuth=np.pi)


def town(*walls):
    """The crossing with walls along y, from x to x, of heights."""
    city = crossing_town(plaza=False)
    corners, faces = [], []
    for y, west, east, top in walls:
        first = len(corners)
        corners += [(west, y, 0.0), (east, y, 0.0), (east, y, top), (west, y, top)]
        faces.append([first, first + 1, first + 2, first + 3])
    scene = city.scene
    if walls:
        scene = scene.with_mesh("buildings", one_mesh(1, np.array(corners), np.array(faces)))
    return view_of(replace(city, scene=scene))


def test_streets_are_sunlit_where_nothing_shades_them_and_the_sun_is_up():
    assert sunlit_streets(town(), HIGH, NOON) == 1.0
    night = replace(NOON, sun_elevation=-0.1)
    assert sunlit_streets(town((-5.0, -70.0, 70.0, 20.0)), HIGH, night) == 1.0


def test_a_wall_in_the_south_shades_the_arms_along_it():
    shaded = sunlit_streets(town((-5.0, -70.0, 70.0, 20.0)), HIGH, NOON)
    half = sunlit_streets(town((-5.0, 0.0, 70.0, 20.0)), HIGH, NOON)
    assert shaded < 0.5
    assert shaded < half < 1.0
    assert sunlit_streets(town((5.0, -70.0, 70.0, 20.0)), HIGH, NOON) > 0.8  # stands in the north


def test_streets_that_houses_hide_do_not_count():
    # A wall right before the lens, and one that shades what lies behind it.
    hidden = [(-5.0, 0.0, 70.0, 20.0)]
    screen = one_mesh(1, np.array([(-50.0, -80, 0), (-50, 80, 0), (-50, 80, 80), (-50, -80, 80)]),
                      np.array([[0, 1, 2, 3]]))  # fmt: skip
    view = town(*hidden)
    scene = view.scene.with_mesh("structures", screen)
    assert sunlit_streets(replace(view, scene=scene), HIGH, NOON) == 1.0


@pytest.mark.parametrize(("y", "opens"), [(-3.5, True), (3.5, False)])
def test_a_camera_opens_for_ground_in_shade(y, opens):
    stops = shade_stops(town((y, -70.0, 70.0, 20.0)), LOW, NOON)
    assert (0.3 < stops <= MOST_STOPS) == opens
    assert opens or stops < 0.2


def test_a_camera_closes_in_the_sun_and_opens_in_the_shade():
    shady, sunny = town((-3.5, -70.0, 70.0, 20.0)), town()
    assert metered_stops(sunny, HIGH, NOON, high=1.0) == pytest.approx(-SUNLIT)
    low = replace(NOON, sun_elevation=np.radians(8.0))
    assert -SUNLIT / 2 < metered_stops(sunny, HIGH, low, high=1.0) < 0
    assert metered_stops(sunny, LOW, NOON, high=0.0) < 0
    closed = shade_stops(shady, LOW, NOON) - metered_stops(shady, LOW, NOON, high=0.0)
    assert 0 <= closed < SUNLIT  # less than in the sun
    assert metered_stops(sunny, LOW, replace(NOON, sun_elevation=-0.1), high=0.0) == 0.0
