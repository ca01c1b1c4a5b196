"""Edits of objects and buildings: what is asked changes, all else stays byte for byte."""

from dataclasses import replace

import numpy as np
import pytest
import shapely
from copies import copy_of

from cityx.building.design import raised
from cityx.checks.predicates import measure
from cityx.checks.predicates.change_predicates import changed_ids
from cityx.checks.predicates.facts import Facts
from cityx.city.content import content_hash
from cityx.city.scene import Scene
from cityx.edit.buildings.rebuilding import rebuilt
from cityx.errors import ActionFailed
from cityx.ground.standing import stand_on
from cityx.ids import id_text, rng_for
from cityx.projects.desk import Desk
from cityx.protocol import registry
from cityx.protocol.gate import Call
from cityx.protocol.running import run_action

BUILDING_LAYERS = (
    "meshes/buildings", "instances/windows", "instances/doors", "instances/trims",
    "instances/shopfronts", "instances/roof_furniture",
)  # fmt: skip


def edited(city, action, **args):
    return run_action(city, Call(f"edit/{action}-v1", args), registry()).city


def named(city, *names):
    table = city.layout.buildings
    return np.sort(table.loc[table["name"].isin(names), "id"].to_numpy(np.uint64))


def some(city, kind, count=1):
    return [id_text(int(one)) for one in Facts(city).layer(kind).ids[:count]]


EDITS = (
    ("set_height", {"factor": 1.7}), ("set_height", {"by": -2.5}), ("set_floors", {"floors": 6}),
    ("set_material", {"material": "brick"}), ("recolor", {"color": 0x2040C0}),
    ("set_roof", {"shape": "gabled"}), ("set_style", {"style": "japanese"}),
    ("replace_building", {"kind": "office"}), ("remove", {}), ("rotate", {"angle": 0.1}),
    ("scale", {"factor": 0.8}),
)  # fmt: skip


@pytest.mark.parametrize(("action", "args"), EDITS)
def test_an_edit_of_a_building_changes_that_building_alone_and_always_the_same(scene, action, args):
    city = scene("park_s")
    rng = rng_for(7, action, len(args))
    name = f"b{int(rng.integers(1, 21)):02d}"
    made = edited(city, action, objects=[name], **args)
    assert changed_ids(city, made).tolist() == named(city, name).tolist()
    again = edited(city, action, objects=[name], **args)
    assert content_hash(again).total == content_hash(made).total


@pytest.mark.parametrize(("action", "args"), EDITS[:8])
def test_an_edited_building_is_the_one_that_a_build_of_the_changed_layout_makes(
    scene, action, args
):
    city = edited(scene("river_s"), action, objects=["b05", "b06"], **args)
    built = raised(replace(city, scene=Scene(), failures=()))
    made, fresh = content_hash(city).layers, content_hash(built).layers
    for layer in BUILDING_LAYERS:
        assert np.array_equal(made[layer][0], fresh[layer][0]), layer
        assert np.array_equal(made[layer][1], fresh[layer][1]), layer


def test_a_rebuild_of_what_did_not_change_gives_the_same_bytes(scene):
    city = scene("grid_s")
    ids = named(city, "b05", "b22")
    assert content_hash(rebuilt(city, ids)).total == content_hash(city).total


def test_heights_are_met_as_predicates_measure_them(scene):
    city = scene("grid_s")
    doubled = edited(city, "set_height", objects=["b07"], factor=2.0)
    assert measure("ratio(b07, height) in [1.99, 2.01]", doubled, before=city).met
    lowered = edited(city, "set_height", objects=["b05", "b22"], height=30.0)
    assert measure("stat(b22, height, mean) in [29.8, 30.2]", lowered).met
    assert measure("stat(b05, height, mean) in [29.8, 30.2]", lowered).met


@pytest.mark.parametrize(
    ("action", "args", "predicate"),
    [
        ("set_material", {"material": "wood"}, "share(b07, material=wood) == 1"),
        ("set_material", {"material": "glass"}, "share(b07, material=glass) == 1"),
        ("recolor", {"color": 0xFFFFFF}, "color(b07) ~ white"),
        ("recolor", {"color": 0xF0D020}, "color(b07) ~ yellow"),
        ("set_floors", {"by": 2}, "stat(b07, floors, mean) == 5"),
        ("set_style", {"style": "japanese"}, "share(b07, style=japanese) == 1"),
        ("set_roof", {"shape": "hipped", "covering": "slate"}, "share(b07, roof=slate) == 1"),
        ("set_roof", {"color": 0xD02018}, "share(b07, roof_color=red) == 1"),
        ("replace_building", {"kind": "house", "floors": 2, "material": "brick"},
         "share(b07, type=house, material=brick, floors=2) == 1"),
    ],
)  # fmt: skip
def test_what_is_asked_for_can_be_measured(scene, action, args, predicate):
    made = edited(scene("grid_s"), action, objects=["b07"], **args)
    found = measure(predicate, made)
    assert found.met, found.evidence


def test_where_a_building_stood_there_is_ground(scene):
    city = scene("grid_s")
    middle = city.layout.buildings.set_index("name").loc["b08", "geometry"].centroid
    spot = [[middle.x, middle.y]]
    assert np.isnan(stand_on(city.scene.meshes["ground"], spot).z).all()
    made = edited(city, "remove", objects=["b08"])
    assert stand_on(made.scene.meshes["ground"], spot).z[0] == pytest.approx(0.12)
    assert measure("n(building, id=b08) == 0", made).met


@pytest.mark.parametrize("kind", ["tree", "bench", "streetlight"])
def test_things_are_moved_turned_scaled_and_removed_alone(scene, kind):
    city = scene("park_s")
    (name,) = some(city, kind)
    for action, args in (
        ("move", {"offset": [0.3, -0.2]}), ("rotate", {"angle": 1.0}),
        ("scale", {"factor": 0.9}), ("remove", {}),
    ):  # fmt: skip
        made = edited(city, action, objects=[name], **args)
        assert changed_ids(city, made).tolist() == [int(name, 16)], action


@pytest.mark.parametrize(
    ("action", "args", "reason"),
    [
        ("move", {"objects": ["b08"], "offset": [0.0, -40.0]}, "There is no room: b08 would"),
        ("scale", {"objects": ["b08"], "factor": 3.0}, "There is no room: b08 would"),
        ("set_floors", {"objects": ["b07"], "by": -5}, "A building of -2 storeys is not built"),
        ("set_material", {"objects": ["t"], "material": "brick"}, "are no buildings"),
        ("add", {"thing": "bench", "at": [[-192.0, 0.0]]}, "it is on the carriageway"),
        ("add", {"thing": "bench"}, "Nothing is said of the place"),
    ],
)
def test_what_cannot_be_is_refused_with_its_reason(scene, action, args, reason):
    city = scene("grid_s")
    if args.get("objects") == ["t"]:
        args = {**args, "objects": some(city, "tree")}
    before = content_hash(city).total
    with pytest.raises(ActionFailed, match=reason):
        edited(city, action, **args)
    assert content_hash(city).total == before


def test_a_refused_place_comes_with_one_that_has_room(scene):
    city = scene("park_s")
    with pytest.raises(ActionFailed) as caught:
        edited(city, "add", thing="bench", at=[[-80.0, 0.0]])
    x, y = str(caught.value).partition("room at ")[2].rstrip(".").split(", ")
    made = edited(city, "add", thing="bench", at=[[float(x), float(y)]])
    assert len(changed_ids(city, made)) == 1


def test_benches_in_a_park_stand_in_it_and_apart(scene):
    city = scene("park_s")
    made = edited(city, "add", thing="bench", within=["park1"], count=6)
    new = changed_ids(city, made)
    layer = Facts(made).layer("bench")
    points = layer.shapes[np.isin(layer.ids, new)]
    park = city.layout.areas.set_index("name").loc["park1", "geometry"]
    assert len(points) == 6
    assert shapely.covers(park, points).all()
    assert shapely.STRtree(points).query(points, "dwithin", 3.0).shape[1] == 6  # but itself


def test_going_back_gives_the_hash_of_before_and_going_on_that_of_after(scene_folder, tmp_path):

    folder = tmp_path / "town"
    copy_of(scene_folder("park_s"), folder)
    with Desk(folder) as desk:
        first = content_hash(desk.city).total
        made = desk.change([Call("edit/set_height-v1", {"objects": ["b03"], "factor": 1.5})])
        assert made.content == content_hash(desk.city).total
        assert desk.undo().content == first
        assert desk.undo(made.number).content == made.content
