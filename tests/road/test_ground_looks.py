"""Areas are paved and painted as is told, where they are: also after buildings have gone."""

import json
from dataclasses import replace

import numpy as np
import pytest
import shapely

from cityx.building.lots import cleared
from cityx.checks.predicates import measure
from cityx.checks.predicates.building_predicates import looks_of_faces
from cityx.city.content import content_hash
from cityx.city.mesh import NO_VERTEX
from cityx.edit.objects.dress import dress
from cityx.ground.ground_looks import area_faces, with_ground_looks
from cityx.ids import stable_id
from cityx.road.ground.ground_surface import ground

STREET = ([(-300.0, 0.0), (300.0, 0.0)], {})
SQUARES = [((-250, 15, -150, 90), "pedestrian"), ((150, 15, 250, 90), "pedestrian")]
HOUSES = [(-215, 40, -190, 65), (190, 40, 215, 65)]
WEST, EAST = 2001, 2002  # squares, 300 m from each other


@pytest.fixture
def squares(layout_of, city_of):
    """Return a city of two squares with a house on each."""
    extent = (-300, -100, 300, 100)
    return ground(city_of(layout_of([STREET], areas=SQUARES, houses=HOUSES, extent=extent), lod=1))


def tagged(city, number, **tags):
    areas = city.layout.areas
    own = areas["id"].to_numpy(np.uint64) == np.uint64(number)
    told = np.where(own, json.dumps(tags), areas["tags"].to_numpy(object)).astype(str)
    return replace(city, layout=replace(city.layout, areas=areas.assign(tags=told)))


def faces_by_area(city):
    mesh = city.scene.meshes["ground"]
    faces, owner = area_faces(city, mesh, np.array([WEST, EAST], np.uint64))
    corners = mesh.vertices[mesh.faces[faces, :3], :2]
    return {number: shapely.polygons(corners[owner == np.uint64(number)]) for number in
            (WEST, EAST)}, faces  # fmt: skip


@pytest.mark.parametrize("gone", [(), (1001,), (1002,), (1001, 1002)])
def test_faces_of_an_area_lie_in_it_whatever_has_gone(squares, gone):
    city = cleared(squares, np.array(gone, np.uint64))
    found, faces = faces_by_area(city)
    mesh = city.scene.meshes["ground"]
    assert (mesh.faces[faces, 3] == NO_VERTEX).all()
    assert len(np.unique(faces)) == len(faces)
    areas = city.layout.areas.set_index("id").geometry
    for number, house in ((WEST, 1001), (EAST, 1002)):
        assert shapely.covers(areas[number].buffer(0.01), found[number]).all()
        lot = city.layout.buildings.set_index("id").geometry[house].area
        paved = areas[number].area - (0.0 if house in gone else lot)
        assert shapely.area(found[number]).sum() == pytest.approx(paved, rel=0.02)


def test_a_square_is_painted_with_the_lot_of_a_house_that_went(squares):
    city = tagged(cleared(squares, np.array([1001], np.uint64)), EAST, colour="#d02018")
    made = with_ground_looks(city)
    before, after = city.scene.meshes["ground"], made.scene.meshes["ground"]
    painted = np.flatnonzero((before.tint != after.tint).any(axis=1))
    assert len(painted)
    middle = after.vertices[after.faces[painted, :3], :2].mean(axis=1)
    east = city.layout.areas.set_index("id").geometry[EAST].buffer(0.01)
    assert shapely.contains_xy(east, *middle.T).all()
    assert measure("n(plaza, color=red) == 1", made).met
    west = with_ground_looks(tagged(city, WEST, colour="#2040c0"))
    mesh = west.scene.meshes["ground"]
    lot = mesh.object_id[mesh.face_object()] == np.uint64(stable_id("ground", "lot", 1001))
    assert lot.any()
    assert (mesh.tint[lot] != 1.0).any(axis=1).all()


def test_a_square_is_of_asphalt_where_that_is_asked_for_and_stays_so(squares):
    made = dress(squares, kind="plaza", material="asphalt")
    assert measure("share(plaza, material=asphalt) == 1.0", made).met
    assert measure("share(plaza, material=asphalt) == 1.0", with_ground_looks(ground(made))).met
    again = dress(squares, kind="plaza", material="asphalt")
    assert content_hash(made).total == content_hash(again).total


@pytest.mark.parametrize("word", ["asphalt", "Asphalt", "tarmac", "asphalt;paved", "paving_stones"])
def test_what_a_map_says_of_every_square_changes_none(squares, word):
    made = with_ground_looks(tagged(squares, EAST, surface=word))
    assert made.scene.meshes["ground"] is squares.scene.meshes["ground"]
    sett = with_ground_looks(tagged(squares, EAST, surface="Sett"))
    assert measure("n(plaza, material=cobbles) == 1", sett).met


def test_a_thing_without_faces_has_no_colour(squares):
    mesh = squares.scene.meshes["ground"]
    faces = np.arange(4)
    main, color = looks_of_faces(mesh, faces, np.zeros(4, np.int64), 2)
    assert main[0] != ""
    assert color[0] != ""
    assert (main[1], color[1]) == ("", "")
    assert looks_of_faces(mesh, faces[:0], faces[:0], 2)[1].tolist() == ["", ""]
