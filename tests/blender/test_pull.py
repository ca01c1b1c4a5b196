"""What an artist changes in city.blend comes back as one revision, and nothing else changes."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from copies import copy_of

from cityx.city.content import content_hash
from cityx.city.layout import CURVE
from cityx.city.store import read_city
from cityx.errors import InputError, UsageError
from cityx.geometry.turns import matrices
from cityx.ids import id_text, stable_id
from cityx.options import BuildOptions
from cityx.projects.build import build
from cityx.projects.desk import Conflict, Desk
from cityx.projects.edit import planned, roles_at, undo
from cityx.projects.pull import pull
from cityx.protocol.gate import Call

pytestmark = pytest.mark.blender


@pytest.fixture(scope="module")
def town(town_map, tmp_path_factory):
    out = tmp_path_factory.mktemp("pull") / "town"
    build([town_map], out, BuildOptions(formats=("blend",), render=False))
    return out


@pytest.fixture
def folder(town, tmp_path):
    return copy_of(town, tmp_path / "town")


def act(folder, *acts):
    """Let the artist at the file."""
    script = Path(__file__).with_name("artist.py")
    command = [sys.executable, script, folder / "city.blend", json.dumps(acts)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def city_of(folder):
    return read_city(folder / "city")


def building_keys(city):
    return [id_text(i) for i in city.scene.meshes["buildings"].object_id.tolist()]


def keys_of(city, layer):
    return [id_text(i) for i in city.scene.instances[layer].object_id.tolist()]


def changed(before, after):
    """Ids of the objects that were there and are not the same; the owned ones by their owner."""
    owner = {}
    for city in (before, after):
        for rows in city.scene.instances.values():
            owner |= {
                i: o or i for i, o in zip(rows.object_id.tolist(), rows.owner.tolist(), strict=True)
            }
        parts = city.layout.parts
        owner |= dict(zip(parts["id"].tolist(), parts["building"].tolist(), strict=True))
    one, other = content_hash(before), content_hash(after)
    found = set()
    for name in {*one.layers, *other.layers}:
        held = [
            set(zip(*(column.tolist() for column in h.layers.get(name, ((), ()))), strict=True))
            if name in h.layers else set()
            for h in (one, other)
        ]  # fmt: skip
        there = {key for key, _ in held[0]}
        found |= {id_text(owner.get(key, key)) for key, _ in held[0] ^ held[1] if key in there}
    return found


def pulled(folder, *acts):
    before = city_of(folder)
    act(folder, *acts)
    found, report = pull(folder)
    return before, city_of(folder), found, report


def test_an_unchanged_file_changes_nothing(folder):
    found, report = pull(folder)
    assert report is None
    assert found.empty
    assert (found.untaken, found.foreign) == ((), ())
    with Desk(folder) as desk:
        assert desk.revision == 1


def test_all_an_artist_does_is_one_revision_that_leaves_the_others_alone(folder):
    city = city_of(folder)
    first, second, third, fourth, *_ = building_keys(city)
    tree, other_tree = keys_of(city, "trees")[:2]
    (bench,) = keys_of(city, "street_furniture")[-1:]
    before, after, found, report = pulled(
        folder,
        ["move_building", first, [4, 3, 0], 0.3],
        ["delete_building", second],
        ["give_material", third, 0, [0.3, 0.02, 0.02]],
        ["color_object", fourth, [0.1, 0.2, 0.4]],
        ["move_points", "trees", [tree], [2.5, -1]],
        ["set_points", "trees", [other_tree], "tint", [0.5, 0.4, 0.1]],
        ["edit_points", "street_furniture", [bench], True],
        ["add_own", "My kiosk"],
    )
    expected = {first, second, third, fourth, tree, other_tree, bench}
    assert changed(before, after) == expected
    assert found.untaken == ()
    assert [item["name"] for item in found.foreign] == ["My kiosk"]
    assert report["revision"] == 2
    again, nothing = pull(folder)
    assert nothing is None
    assert again.empty
    assert again.foreign == found.foreign  # carried over to the new file
    assert undo(folder)["hash"] == content_hash(before).total


def curve_of(city, name):
    table = city.layout.lines
    return table.geometry[table["source"] == name].iloc[0].coords[:]


def test_a_curve_that_is_drawn_or_moved_is_one_of_the_city(folder):
    points = [[-20, -20], [0, 0], [9, 5]]
    before, after, found, _ = pulled(folder, ["draw", "artist path", points])
    assert [curve["name"] for curve in found.drawn] == ["artist path"]
    assert "drawn: artist path" in found.lines()
    assert curve_of(after, "artist path") == [(-20, -20), (0, 0), (9, 5)]
    assert changed(before, after) == set()
    with Desk(folder) as desk:
        assert desk.revisions()[-1].actions == ("edit/draw_curve-v1",)
    again, nothing = pull(folder)
    assert nothing is None
    assert again.empty
    _, moved, *_ = pulled(folder, ["move_own", "artist path", [1, 2, 0]])
    assert curve_of(moved, "artist path") == [(-19, -18), (1, 2), (10, 7)]
    with Desk(folder) as desk, roles_at(desk) as roles:
        _, (item,), *_ = planned(desk, "Let a woman walk along artist path.", roles=roles)
    assert item.args["path"] == "artist path"
    before, gone, found, _ = pulled(folder, ["delete_own", "artist path"])
    assert found.erased == ("artist path",)
    assert "removed: artist path" in found.lines()
    assert "artist path" not in gone.layout.lines["source"].tolist()
    assert changed(before, gone) == {id_text(stable_id(CURVE, "artist path"))}
    with Desk(folder) as desk:
        assert desk.revisions()[-1].actions == ("edit/erase_curve-v1",)
    assert undo(folder)["hash"] == content_hash(before).total


def test_a_building_takes_its_windows_and_its_outline_along(folder):
    key = building_keys(city_of(folder))[0]
    before, after, *_ = pulled(folder, ["move_building", key, [5, 0, 0], np.pi / 2])
    wanted = np.uint64(int(key, 16))
    shapes = [c.layout.buildings.set_index("id").geometry[int(key, 16)] for c in (before, after)]
    assert shapes[1].area == pytest.approx(shapes[0].area)
    wide, deep = np.diff(np.reshape(shapes[0].bounds, (2, 2)), axis=0)[0]
    assert np.diff(np.reshape(shapes[1].bounds, (2, 2)), axis=0)[0] == pytest.approx((deep, wide))
    rows = [c.scene.instances["windows"] for c in (before, after)]
    mine = rows[0].owner == wanted
    assert mine.any()
    pivot = np.array([*np.mean(np.reshape(shapes[0].envelope.bounds, (2, 2)), axis=0), 0.0])
    turn = matrices([[0, 0, np.pi / 2]])[0]
    expected = (rows[0].position[mine] - pivot) @ turn.T + pivot + (5, 0, 0)
    np.testing.assert_allclose(rows[1].position[mine][:, :2], expected[:, :2], atol=0.1)


def test_a_building_that_is_moved_by_its_parent_is_moved_itself(folder):
    key = building_keys(city_of(folder))[2]
    act(folder, ["move_by_parent", key, [0, 6, 0]])
    found, _ = pull(folder, dry_run=True)
    assert [(item["id"], item["move"]) for item in found.moved] == [(key, [0, 6, 0])]


def test_a_scaled_building_is_higher_and_wider(folder):
    key = building_keys(city_of(folder))[1]
    before, after, *_ = pulled(folder, ["move_building", key, [0, 0, 0], 0.0, 1.5])
    height = [c.layout.buildings.set_index("id")["height"][int(key, 16)] for c in (before, after)]
    assert height[1] == pytest.approx(1.5 * height[0], rel=0.05)


def test_copies_are_objects_of_their_own_with_what_they_own(folder):
    city = city_of(folder)
    key, tree = building_keys(city)[0], keys_of(city, "trees")[0]
    before, after, found, _ = pulled(
        folder, ["duplicate_building", key, [0, 40, 0]],
        ["edit_points", "trees", [tree], False],
    )  # fmt: skip
    assert {item["id"] for item in found.copied} == {key, tree}
    shells = [c.scene.meshes["buildings"].count for c in (before, after)]
    assert shells[1] == shells[0] + 1
    assert after.scene.instances["trees"].count == before.scene.instances["trees"].count + 1
    assert len(after.layout.buildings) == len(before.layout.buildings) + 1
    fresh = set(building_keys(after)) - set(building_keys(before))
    (new,) = fresh
    own, old = ((c.scene.instances["windows"].owner == np.uint64(int(k, 16))).sum()
                for c, k in ((after, new), (before, key)))  # fmt: skip
    assert own == old > 0
    assert key not in changed(before, after)


def test_trees_turn_and_grow_by_their_attributes_and_go_with_their_layer(folder):
    trees = keys_of(city_of(folder), "trees")
    act(folder, ["set_points", "trees", trees[:1], "scale", [2, 2, 2]],
        ["set_points", "trees", trees[1:2], "rotation", [0, 0, 1]],
        ["move_layer", "trees", [1, 0, 0]])  # fmt: skip
    found, _ = pull(folder, dry_run=True)
    by_id = {item["id"]: item for item in found.moved}
    assert set(by_id) == set(trees)
    assert all(item["move"] == [1, 0, 0] for item in found.moved)
    assert by_id[trees[0]]["factor"] != [1, 1, 1]
    assert by_id[trees[1]]["turn"][2] != 0


def test_tints_of_faces_are_colours_of_materials(folder):
    key = building_keys(city_of(folder))[0]
    before, after, *_ = pulled(folder, ["tint_faces", key, [0.2, 0.3, 0.4]])
    batch = after.scene.meshes["buildings"].one(building_keys(after).index(key))
    np.testing.assert_allclose(
        batch.tint, np.tile((0.2, 0.3, 0.4), (len(batch.tint), 1)), atol=0.01
    )
    assert changed(before, after) == {key}


def test_a_dry_run_tells_and_changes_nothing(folder):
    act(folder, ["delete_building", building_keys(city_of(folder))[0]])
    blend = (folder / "city.blend").read_bytes()
    found, report = pull(folder, dry_run=True)
    assert report is None
    assert found.lines()[0] == f"removed: {found.removed[0]}"
    assert (folder / "city.blend").read_bytes() == blend
    with Desk(folder) as desk:
        assert desk.revision == 1


def test_what_cannot_be_taken_is_named_and_nothing_else_is_lost(folder):
    key = building_keys(city_of(folder))[0]
    act(folder, ["reshape_building", key], ["forget_ids", "street_furniture"],
        ["move_layer", "ground", [0, 0, 1]])  # fmt: skip
    found, report = pull(folder)
    assert report is None
    assert any("was reshaped" in text for text in found.untaken)
    assert any("lost their attributes" in text for text in found.untaken)
    assert any("cannot be moved" in text for text in found.untaken)


def test_a_layer_that_is_gone_is_asked_about(folder):
    act(folder, *(["delete_building", key] for key in building_keys(city_of(folder))),
        ["delete_layer", "trees"])  # fmt: skip
    with pytest.raises(UsageError, match="pull with --removals; nothing was changed"):
        pull(folder)
    found, _ = pull(folder, removals=True)
    assert len(city_of(folder).layout.buildings) == 0
    assert len(found.removed) > 10


def test_an_older_state_is_refused_with_the_way_out(folder):
    key = building_keys(city_of(folder))[0]
    mine = folder / "mine.blend"
    act(folder, ["move_building", key, [3, 0, 0]])
    shutil.copy(folder / "city.blend", mine)
    with Desk(folder) as desk:
        removed = keys_of(desk.city, "trees")[:1]
        desk.change([Call("edit/remove-v1", {"objects": removed})])
    with pytest.raises(Conflict, match="shows revision 1, and the city has revision 2 by now"):
        pull(folder)
    undo(folder)
    found, _ = pull(folder, blend=mine)
    assert [item["id"] for item in found.moved] == [key]


def test_files_of_others_are_refused(folder, tmp_path):
    with pytest.raises(InputError, match="There is no"):
        pull(folder, blend=tmp_path / "none.blend")
    broken = tmp_path / "broken.blend"
    broken.write_bytes(b"BLENDER-v405" + bytes(200))
    with pytest.raises(InputError, match="Blender cannot read it"):
        pull(folder, blend=broken)
    act(folder, ["save_plain", str(tmp_path / "newer.blend")])
    newer = tmp_path / "newer.blend"
    newer.write_bytes(newer.read_bytes().replace(b"BLENDER-v405", b"BLENDER-v509", 1))
    with pytest.raises(InputError, match=r"saved by Blender 5\.9, of which 4\.5"):
        pull(folder, blend=newer)
    with Desk(folder) as desk:
        gone = keys_of(desk.city, "trees")
        desk.change([Call("edit/remove-v1", {"objects": gone})])
    shutil.rmtree(folder / "history")
    with pytest.raises(InputError, match="shows another city"):
        pull(folder)
