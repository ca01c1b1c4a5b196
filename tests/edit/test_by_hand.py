"""Actions of an artist's hand: exact, and nothing else changes."""

from dataclasses import replace

import numpy as np
import pytest

from cityx.assets.styles.materials import linear_to_srgb, srgb_to_linear
from cityx.city.content import content_hash
from cityx.city.mesh import feet
from cityx.city.store import read_city
from cityx.edit.objects.copy_objects import copy_objects
from cityx.edit.objects.paint_objects import paint_objects
from cityx.edit.objects.place_objects import place_objects
from cityx.edit.objects.remove_parts import remove_parts
from cityx.errors import ActionFailed
from cityx.geometry.turns import matrices
from cityx.ids import id_text


@pytest.fixture(scope="module")
def town(built_town):
    return read_city(built_town() / "city")


def tree(city, number=0):
    return id_text(int(city.scene.instances["trees"].object_id[number]))


def shell(city, number=0):
    return id_text(int(city.scene.meshes["buildings"].object_id[number]))


def test_moving_there_and_back_is_the_city_it_was(town):
    name = tree(town)
    away = place_objects(town, objects=(name,), move=(3.0, -2.0, 0.5), factor=(2.0, 2.0, 2.0))
    assert content_hash(away).total != content_hash(town).total
    back = place_objects(away, objects=(name,), move=(-3.0, 2.0, -0.5), factor=(0.5, 0.5, 0.5))
    assert content_hash(back).total == content_hash(town).total


def test_a_thing_turns_about_all_axes(town):
    turned = place_objects(town, objects=(tree(town),), turn=(0.1, 0.2, 0.3))
    rows, old = (c.scene.instances["trees"] for c in (turned, town))
    expected = matrices([(0.1, 0.2, 0.3)])[0] @ matrices(old.rotation[:1])[0]
    np.testing.assert_allclose(matrices(rows.rotation[:1])[0], expected, atol=1e-6)
    np.testing.assert_array_equal(rows.rotation[1:], old.rotation[1:])
    np.testing.assert_array_equal(rows.position, old.position)


def test_a_shell_turns_about_its_foot_and_leaves_ground_behind(town):
    name = shell(town)
    turned = place_objects(town, objects=(name,), turn=(0.0, 0.0, np.pi), move=(0.0, 30.0, 0.0))
    batch, old = (c.scene.meshes["buildings"] for c in (turned, town))
    np.testing.assert_allclose(feet(batch)[0], feet(old)[0] + (0, 30, 0), atol=2e-3)
    np.testing.assert_array_equal(batch.one(1).vertices, old.one(1).vertices)
    assert turned.scene.meshes["ground"].count > town.scene.meshes["ground"].count
    areas = [c.layout.buildings.geometry.area.sum() for c in (turned, town)]
    assert areas[0] == pytest.approx(areas[1])


def test_a_shell_that_leans_is_refused(town):
    with pytest.raises(ActionFailed, match="can be turned about the vertical only"):
        place_objects(town, objects=(shell(town),), turn=(0.2, 0.0, 0.0))


def test_two_copies_of_one_thing_have_ids_of_their_own(town):
    name = tree(town)
    once = copy_objects(town, objects=(name,), move=(2.0, 0.0, 0.0))
    twice = copy_objects(once, objects=(name,), move=(4.0, 0.0, 0.0))
    ids = twice.scene.instances["trees"].object_id
    assert len(np.unique(ids)) == len(ids) == town.scene.instances["trees"].count + 2
    again = copy_objects(once, objects=(name,), move=(4.0, 0.0, 0.0))
    assert content_hash(again).total == content_hash(twice).total


def test_paint_covers_the_faces_of_one_material_and_is_noted_for_walls(town):
    name, batch = shell(town), town.scene.meshes["buildings"]
    one = batch.one(0)
    walls = batch.materials[np.bincount(one.material[np.abs(one.uv[:, 0, 0]) >= 0]).argmax()]
    painted = paint_objects(town, objects=(name,), tint=(0.5, 0.1, 0.1), surface=walls)
    made = painted.scene.meshes["buildings"].one(0)
    mine = made.material == batch.materials.index(walls)
    np.testing.assert_allclose(made.tint[mine], np.tile((0.5, 0.1, 0.1), (mine.sum(), 1)))
    np.testing.assert_array_equal(made.tint[~mine], one.tint[~mine])
    with pytest.raises(ActionFailed, match='of "velvet" that takes a tint'):
        paint_objects(town, objects=(name,), tint=(0.5, 0.1, 0.1), surface="velvet")


def test_painted_walls_keep_their_colour_when_the_building_is_raised_anew(town):
    name = shell(town)
    painted = paint_objects(town, objects=(name,), tint=(0.5, 0.1, 0.1))
    own = (painted.layout.parts["building"] == np.uint64(int(name, 16))).to_numpy()
    assert (painted.layout.parts["wall_color"][own] > 0).all()
    assert (painted.layout.parts["wall_color"][~own] == town.layout.parts["wall_color"][~own]).all()


def test_windows_can_go_and_their_wall_stays(town):
    rows = town.scene.instances["windows"]
    gone = remove_parts(town, objects=(id_text(int(rows.object_id[0])),))
    assert gone.scene.instances["windows"].count == rows.count - 1
    assert gone.scene.meshes is not None
    bare = remove_parts(town, objects=(id_text(int(rows.owner[0])),))
    assert not (bare.scene.instances["windows"].owner == rows.owner[0]).any()
    with pytest.raises(ActionFailed, match="use edit/remove-v1"):
        remove_parts(town, objects=(tree(town),))


@pytest.mark.parametrize("color", [0x000000, 0xFFFFFF, 0x336699, 0xC03A30])
def test_colours_survive_the_way_to_linear_and_back(color):
    assert linear_to_srgb(srgb_to_linear(color)) == color


def test_inputs_are_left_as_they_were(town):
    before = content_hash(town).total
    place_objects(town, objects=(shell(town), tree(town)), move=(1.0, 1.0, 0.0))
    copy_objects(town, objects=(shell(town),), move=(0.0, 50.0, 0.0))
    assert content_hash(replace(town)).total == before
