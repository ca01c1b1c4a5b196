from dataclasses import replace

import numpy as np
import pytest

from cityx.city.frame import Frame
from cityx.road.ground.ground_surface import ground
from cityx.road.network.network import network

STREET = [([(-90, 0), (90, 0)], {})]


def laid_at(city_of, layout, latitude, longitude):
    city = replace(city_of(layout), frame=Frame(latitude, longitude))
    return ground(network(city)).scene.meshes["ground"]


@pytest.mark.parametrize(
    ("latitude", "longitude", "material"),
    [(52.5, 13.4, "slab_walk"), (51.5, -0.13, "flagstones"), (35.7, 139.8, "walk_blocks"),
     (40.7, -74.0, "paving")],
)  # fmt: skip
def test_walks_are_paved_as_their_region_does(city_of, layout_of, latitude, longitude, material):
    mesh = laid_at(city_of, layout_of(STREET), latitude, longitude)
    used = {mesh.materials[number] for number in np.unique(mesh.material)}
    assert material in used
    assert not used & ({"slab_walk", "flagstones", "walk_blocks", "paving"} - {material})


@pytest.mark.parametrize(("kind", "guided"), [("tertiary", True), ("residential", False)])
def test_a_line_of_ribs_leads_along_main_streets_alone(city_of, layout_of, kind, guided):
    mesh = laid_at(city_of, layout_of([(STREET[0][0], {"kind": kind})]), 35.7, 139.8)
    used = {mesh.materials[number] for number in np.unique(mesh.material)}
    assert ("guided_blocks" in used) is guided


def test_bands_of_both_walks_begin_at_their_kerbs(city_of, layout_of):
    mesh = laid_at(city_of, layout_of(STREET), 52.5, 13.4)
    rows = np.array(mesh.materials)[mesh.material] == "slab_walk"
    across = np.abs(mesh.vertices[mesh.faces[rows, :3], 1])  # the street is 6 m wide
    assert across.min() == pytest.approx(3.15, abs=0.02)
    assert mesh.uv[rows][:, :3, 1] == pytest.approx(across - 3.15, abs=0.02)


def test_bands_end_where_a_street_bends(city_of, layout_of):
    bent = [([(-90, 0), (0, 0), (3, 0.5), (6, 2), (60, 60)], {})]
    mesh = laid_at(city_of, layout_of(bent), 52.5, 13.4)
    names = np.array(mesh.materials)[mesh.material]
    middle = mesh.vertices[mesh.faces[:, :3]].mean(axis=1)
    at_bend = np.hypot(*(middle[:, :2] - [3, 0.5]).T) < 6
    assert "mosaic" in names[at_bend]
    assert "slab_walk" in names[middle[:, 0] < -30]
    assert "mosaic" not in names[middle[:, 0] < -30]
