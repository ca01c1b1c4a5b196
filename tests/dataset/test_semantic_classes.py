from pathlib import Path

import numpy as np
import pytest

from cityx.assets.furniture.street_furniture import MAKERS, furniture
from cityx.assets.vehicles.movers import vehicle, vehicle_looks
from cityx.city.ground import SURFACES
from cityx.city.mesh import one_mesh
from cityx.city.scene import Prototype
from cityx.city.store import read_view
from cityx.city.tracks import MOVER_KINDS
from cityx.dataset.classes import (
    CLASS,
    CLASSES,
    SKY,
    class_of_mover,
    class_of_piece,
    classes_of_layer,
)
from cityx.ids import stable_id

OTHER = CLASS["other"]
MAP = Path(__file__).parents[3] / "shared" / "data" / "osm" / "tokyo_kanda.osm.gz"


def test_the_table_is_numbered_and_every_class_can_be_told_apart():
    assert [c.number for c in CLASSES] == list(range(len(CLASSES)))
    assert len({c.name for c in CLASSES}) == len({c.color for c in CLASSES}) == len(CLASSES) < 255
    assert CLASSES[SKY].name == "sky"
    assert not CLASSES[SKY].thing


def test_train_ids_are_those_of_cityscapes():
    names = ["road", "sidewalk", "building", "wall", "fence", "pole", "traffic_signal", "sign",
             "tree", "grass", "sky", "pedestrian", "rider", "car", "truck", "bus", "tram",
             "motorcycle", "bicycle"]  # fmt: skip
    assert [CLASSES[CLASS[name]].train_id for name in names] == list(range(19))
    assert {c.train_id for c in CLASSES} == {*range(19), 255}


def test_every_surface_of_the_ground_has_a_class_of_its_own_sort():
    names = [s.name for s in SURFACES if s.name != "void"]
    square = [(0, 0, 0), (1, 0, 0), (1, 1, 0)]
    for name in names:
        batch = one_mesh(stable_id("ground", name), square, [[0, 1, 2]])
        found = CLASSES[classes_of_layer("ground", batch)[0]]
        assert found.number != OTHER, name
        assert not found.thing, name
    walk = one_mesh(stable_id("ground", "sidewalk"), square, [[0, 1, 2]])
    assert CLASSES[classes_of_layer("ground", walk)[0]].name == "sidewalk"
    lot = one_mesh(77, square, [[0, 1, 2]], materials=["asphalt"])  # one that an edit laid
    assert CLASSES[classes_of_layer("ground", lot)[0]].name == "road"


# Pieces that drive or fly, and stand where they are put.
DRIVEN = ("e_scooter", "delivery_robot", "tractor", "bulldozer", "forklift", "road_roller",
          "helicopter")  # fmt: skip


@pytest.mark.parametrize("name", MAKERS)
def test_every_piece_of_furniture_has_a_class(name):
    assert class_of_piece(furniture(name)) != OTHER
    driven = name.startswith(DRIVEN)
    assert (CLASSES[class_of_piece(furniture(name))].name == "vehicle") == driven


def test_vehicles_and_movers_have_their_kind():
    for look in vehicle_looks():
        model = vehicle(look)
        assert CLASSES[class_of_piece(model.body)].name != "other"
        expected = {"van": "car"}.get(model.kind, model.kind)
        assert CLASSES[class_of_mover(MOVER_KINDS.index(model.kind))].name == expected
    assert CLASSES[class_of_mover(MOVER_KINDS.index("pedestrian"))].name == "pedestrian"


def test_barriers_are_told_by_what_they_are_made_of():
    wall = [(0, 0, 0), (1, 0, 0), (1, 0, 1)]
    kinds = {"brick": "wall", "stone": "wall", "metal_dark": "fence", "hedge": "hedge"}
    for material, name in kinds.items():
        batch = one_mesh(5, wall, [[0, 1, 2]], materials=[material])
        assert CLASSES[classes_of_layer("barriers", batch)[0]].name == name


def test_what_nobody_named_is_other_and_keeps_going():
    odd = Prototype(
        "ufo", "spacecraft", one_mesh(0, [(0, 0, 0), (1, 0, 0), (1, 1, 0)], [[0, 1, 2]])
    )
    assert class_of_piece(odd) == OTHER


def named(view):
    """The classes of all objects of a city, with the names of those that have none."""
    counts, unnamed = np.zeros(len(CLASSES), int), set()
    for layer, batch in view.scene.meshes.items():
        found = classes_of_layer(layer, batch)
        counts += np.bincount(found, minlength=len(CLASSES))
        if (found == OTHER).any():
            unnamed.add(layer)
    for layer, rows in view.scene.instances.items():
        for prototype in np.unique(rows.prototype).tolist():
            held = view.scene.prototypes[prototype]
            number = class_of_piece(held)
            counts[number] += int((rows.prototype == prototype).sum())
            if number == OTHER:
                unnamed.add(f"{layer}: {held.name} ({held.kind})")
    return counts, unnamed


def built(source, folder, **options):
    from cityx.options import BuildOptions
    from cityx.projects.build import build

    build([source], folder, BuildOptions(lod=2, formats=(), render=False, **options))
    return read_view(folder / "city")


def test_every_object_of_a_town_has_a_class(built_town):
    counts, unnamed = named(read_view(built_town() / "city"))
    assert unnamed == set()
    for name in ("building", "road", "road_marking", "window", "tree", "water"):
        assert counts[CLASS[name]] > 0, name


@pytest.mark.slow
@pytest.mark.shared
@pytest.mark.skipif(not MAP.exists(), reason="needs the real maps in ../shared/data")
def test_every_object_of_a_real_map_has_a_class(tmp_path):
    counts, unnamed = named(built(MAP, tmp_path / "kanda", size=(300.0, 300.0)))
    assert unnamed == set()
    assert counts[CLASS["building"]] > 100
