from types import SimpleNamespace

import numpy as np
import pytest

from cityx.city import Environment, Instances, Prototype, Scene, one_mesh
from cityx.city.rooms import HOME, SHOP, WORK, lit_rooms, lit_scene, room_uses
from cityx.ids import hash_ids

OBJECTS = {1: {"use": "apartments"}, 2: {"use": "office"}, 3: {"use": "retail"}}
COUNT = 3000  # rows per kind


def pane(name, kind, material="glass"):
    corners = [(0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1)]
    return Prototype(
        name, kind, one_mesh(0, corners, [(0, 1, 2, 3)], materials=(material, "frame_paint"))
    )


def town(**lights):
    """Windows of a home, of an office and of a shop, and the shop's front, COUNT of each."""
    prototypes = (pane("window", "window"), pane("shop", "shopfront"), pane("post", "furniture"))
    number = 4 * COUNT
    rows = Instances(
        np.repeat([0, 0, 0, 1], COUNT).astype(np.int32),
        hash_ids(0, "test", np.arange(number)),
        np.repeat([1, 2, 3, 1], COUNT).astype(np.uint64),
        np.zeros((number, 3)),
        *(np.ones((number, 3), np.float32) for _ in range(3)),
    )
    scene = Scene().with_instances("windows", prototypes, rows)
    return SimpleNamespace(scene=scene, seed=5, objects=OBJECTS, environment=Environment(**lights))


def test_a_room_is_used_as_its_building_is_and_behind_a_shopfront_is_a_shop():
    view = town()
    uses = room_uses(view.scene.prototypes, view.scene.instances["windows"], OBJECTS)
    assert uses[::COUNT].tolist() == [HOME, WORK, SHOP, SHOP]


@pytest.mark.parametrize("shares", [(0.46, 0.3, 0.9), (0.06, 0.06, 0.45), (0.0, 0.75, 1.0)])
def test_as_many_rooms_are_lit_as_the_hour_asks_for(shares):
    view = town(night_lights=shares[0], work_lights=shares[1], shop_lights=shares[2])
    rows = view.scene.instances["windows"]
    uses = room_uses(view.scene.prototypes, rows, OBJECTS)
    lit = lit_rooms(rows, uses, view.environment, view.seed)
    for use, share in enumerate(shares):
        assert lit[uses == use].mean() == pytest.approx(share, abs=0.05)


def test_who_is_up_early_is_up_late_too():
    view = town()
    rows = view.scene.instances["windows"]
    uses = np.zeros(rows.count, np.int8)
    few, many = (lit_rooms(rows, uses, Environment(night_lights=share), 5) for share in (0.2, 0.4))
    assert (many | ~few).all()


def test_lit_windows_of_an_export_differ_only_in_their_panes():
    view = town(night_lights=0.5, shop_lights=1.0)
    before, after = view.scene, lit_scene(view)
    rows, changed = before.instances["windows"], after.instances["windows"]
    names = np.array([p.name for p in after.prototypes])
    assert names.tolist() == ["window", "shop", "post", "window_lit", "shop_lit"]
    assert after.prototypes[3].mesh.materials == ("window_lit", "frame_paint")
    assert after.prototypes[3].mesh.vertices is before.prototypes[0].mesh.vertices
    assert changed.position is rows.position
    uses = room_uses(before.prototypes, rows, OBJECTS)
    lit = lit_rooms(rows, uses, view.environment, view.seed)
    assert (np.char.endswith(names[changed.prototype], "_lit") == lit).all()


def test_by_day_the_scene_of_an_export_is_the_scene():
    view = town()
    assert lit_scene(view) is view.scene
