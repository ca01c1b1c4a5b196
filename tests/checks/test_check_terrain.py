import re
from dataclasses import replace

import numpy as np
import pytest
import shapely

from cityx.checks.terrain_checks import check_terrain, fit_notes
from cityx.city import City, Frame, Layout, make_table
from cityx.city.terrain import Survey, Terrain
from cityx.road.ground.ground_surface import ground

SITE = (-200.0, -200.0, 200.0, 200.0)


def hill(step, reach):
    x = np.arange(-reach, reach + 1, step)
    return Terrain((-reach, -reach), step, 15 * np.cos(x / 150)[None] * np.cos(x / 90)[:, None])


@pytest.fixture(scope="module")
def slope():
    roads = make_table("roads", [shapely.LineString([(-200, 0), (200, 0)])], id=[1],
                       kind=["residential"], width=[6.0], sidewalk_left=[0.0],
                       sidewalk_right=[0.0])  # fmt: skip
    terrain = hill(5.0, 200.0)
    x, y = (axis.ravel() for axis in np.meshgrid(*2 * [np.arange(-190.0, 191.0, 20.0)]))
    points = np.column_stack([x, y, terrain.height_at(np.column_stack([x, y]))])
    survey = Survey(points, hill(20.0, 700.0), 0.1)
    city = City("hill", Frame(50.0, 8.0), Layout(SITE, roads=roads), terrain=terrain, survey=survey)
    return ground(city)


def checks(city):
    return {check.name: check for check in check_terrain(city)}


def test_the_ground_keeps_within_the_stated_bound(slope):
    found = checks(slope)
    assert set(found) == {"terrain_error", "surroundings_error"}
    assert 0 < found["terrain_error"].value <= found["terrain_error"].limit < 0.5
    assert 0 < found["surroundings_error"].value <= found["surroundings_error"].limit


def test_ground_that_misses_the_file_is_found(slope):
    points = slope.survey.points + np.array([0, 0, 1.0])
    moved = replace(slope, survey=replace(slope.survey, points=points))
    assert not checks(moved)["terrain_error"].ok
    assert checks(moved)["terrain_error"].value == pytest.approx(1.0, abs=0.3)


def test_what_a_street_cuts_is_left_out(slope):
    near = np.abs(slope.survey.points[:, 1]) < 40
    points = slope.survey.points + near[:, None] * [0, 0, 9.0]
    assert checks(replace(slope, survey=replace(slope.survey, points=points)))["terrain_error"].ok


def test_without_a_height_file_there_is_nothing_to_check(slope):
    assert check_terrain(replace(slope, survey=None)) == []


@pytest.mark.parametrize("lift", [0.0, 2.0, 7.5])
def test_the_stated_fit_tells_land_from_streets(slope, lift):
    x, y = (axis.ravel() for axis in np.meshgrid(np.arange(-190.0, 190.0, 0.5), [0.0, 40.0]))
    spots = np.column_stack([x, y])
    points = np.column_stack([spots, slope.terrain.height_at(spots) + np.where(y == 0, lift, 0.0)])
    found = fit_notes(replace(slope, survey=replace(slope.survey, points=points)))
    land, street = (float(x) for x in re.findall(r"by ([\d.]+) m \(root", found[0]))
    assert land < 0.5
    assert street == pytest.approx(lift, abs=0.5)


def test_few_cells_do_not_hide_what_lies_between_them(slope):
    ground = slope.scene.meshes["ground"]
    lifted = replace(ground, vertices=ground.vertices + np.array([0, 0, 3.0]))
    scene = slope.scene.with_mesh("ground", lifted)
    few = replace(slope.survey, points=slope.survey.points[:4])
    found = fit_notes(replace(slope, survey=few, scene=scene))
    assert all(abs(float(x) - 3.0) < 0.5 for x in re.findall(r"by ([\d.]+) m \(root", found[0]))
