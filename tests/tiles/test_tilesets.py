"""Tilesets and their content: on their place on Earth, valid, with the ids of the store."""

import json

import numpy as np
import pytest
from pyproj import Transformer

from cityx.city import Frame
from cityx.city.content import content_hash
from cityx.city.mesh import one_mesh
from cityx.city.store import read_city, view_of
from cityx.ids import id_text
from cityx.tiles.content import cells_of, distance_between, overviews_of
from cityx.tiles.run import TILES, records
from cityx.tiles.tileset import Seen, tile_tileset, transform_of

FRAME = Frame(47.14, 9.52)


def contents(folder):
    return sorted((folder / TILES).glob("*/content/*.glb"))


@pytest.mark.parametrize("centre", [(0.0, 0.0, 0.0), (20_000.0, -15_000.0, 40.0)])
def test_a_tile_lies_on_its_place_on_earth(centre):
    centre = np.array(centre)
    matrix = np.array(transform_of(FRAME, centre)).reshape(4, 4).T
    away = np.array([[0, 0, 0], [250, 0, 0], [0, 250, 0], [-250, 250, 12]], float)
    lonlat = FRAME.to_geographic((centre + away)[:, :2])
    earth = Transformer.from_crs("EPSG:4979", "EPSG:4978", always_xy=True)
    true = np.column_stack(earth.transform(*lonlat.T, (centre + away)[:, 2]))
    ours = (matrix @ np.column_stack([away, np.ones(4)]).T).T[:, :3]
    assert np.abs(ours - true).max() < 0.02  # the Earth is curved


def test_every_file_that_tilesets_name_is_there_and_in_its_box(built_tiles):
    whole = json.loads((built_tiles / "tileset.json").read_text())
    assert whole["asset"]["version"] == "1.1"
    named = 0
    for child in whole["root"]["children"]:
        path = built_tiles / child["content"]["uri"]
        document = json.loads(path.read_text())
        root = document["root"]
        assert root["geometricError"] > 0 == root["children"][0]["geometricError"]
        for tile in (root, *root["children"]):
            assert (path.parent / tile["content"]["uri"]).is_file()
            named += 1
    assert named == len(contents(built_tiles))


def test_the_content_has_no_error_by_the_khronos_validator(built_tiles):
    from validating import errors_of

    assert errors_of(contents(built_tiles)) == []


def test_content_names_the_buildings_of_the_store_and_places_their_windows(built_tiles):
    pytest.importorskip("meshopt")
    from glb import Glb

    for tile in records(built_tiles):
        folder = built_tiles / TILES / tile.name
        city = read_city(folder / "city")
        due = {id_text(key) for key in city.layout.buildings["id"].tolist()}
        files = [Glb(path.read_bytes()) for path in (folder / "content").glob("*_*.glb")]
        assert due <= {key for file in files for key in table_ids(file, "buildings")}
        placed = sum(len(place) for file in files for place in placements(file))
        drawn = sum(
            np.isin(rows.prototype, [k for k, p in enumerate(city.scene.prototypes)
                                     if len(p.mesh.faces)]).sum()
            for rows in city.scene.instances.values()
        )  # fmt: skip
        assert placed == drawn
        things = city.scene.instances.values()
        owned = [np.where(rows.owner > 0, rows.owner, rows.object_id) for rows in things]
        named = {key for file in files for key in instance_ids(file)}
        assert bool(named) == (placed > 0)
        assert named <= {id_text(key) for keys in owned for key in keys.tolist()}


def instance_ids(file):
    """Yield the ids that the nodes that place something name by the table of their file."""
    ids = file.ids()
    for node in file.json["nodes"]:
        held = node.get("extensions", {})
        if "EXT_mesh_gpu_instancing" not in held:
            continue
        (features,) = held["EXT_instance_features"]["featureIds"]
        assert features["propertyTable"] == 0  # CesiumJS looks up all that is picked in one
        attribute = held["EXT_mesh_gpu_instancing"]["attributes"]["_FEATURE_ID_0"]
        rows = np.unique(file.array(attribute)).astype(int)
        assert len(rows) <= features["featureCount"]
        yield from (ids[row] for row in rows.tolist())


def table_ids(file, layer):
    return filter(None, file.ids(layer))


def placements(file):
    for node in file.json["nodes"]:
        held = node.get("extensions", {}).get("EXT_mesh_gpu_instancing")
        if held:
            yield file.array(held["attributes"]["TRANSLATION"])


def test_the_error_of_an_overview_is_the_distance_of_what_it_leaves_out():
    square = np.array([[0, 0, 0], [10, 0, 0], [10, 10, 0], [0, 10, 0]], float)
    flat = {"ground": one_mesh(1, square, [[0, 1, 2, 3]])}
    raised = {"roofs": one_mesh(2, square + np.array([0, 0, 3]), [[0, 1, 2, 3]])}
    assert distance_between(flat, flat) == 0
    assert distance_between(raised, flat) == pytest.approx(3)
    assert distance_between({}, flat) == 0


@pytest.fixture(scope="module")
def shown(built_tiles):
    """What a tile shows, as `cells_of` and `overviews_of` take it."""
    city = read_city(built_tiles / TILES / "0_0" / "city")
    return view_of(city), content_hash(city), np.array([250.0, 250.0, 0.0])


def test_a_file_that_would_be_too_large_is_several(shown, monkeypatch):
    from glb import Glb

    whole = cells_of(*shown)
    most = max(len(cell.glb) for cell in whole) // 3
    monkeypatch.setattr("cityx.tiles.content.MOST", most)
    parts = cells_of(*shown)
    assert len(whole) < len(parts)
    assert max(len(cell.glb) for cell in parts) <= most
    assert len({cell.name for cell in parts}) == len(parts)
    files = [[Glb(cell.glb) for cell in cells] for cells in (whole, parts)]
    ids = [{key for file in own for key in file.ids()} for own in files]
    placed = [sum(len(each) for file in own for each in placements(file)) for own in files]
    faces = [sum(triangles(file) for file in own) for own in files]
    assert ids[0] == ids[1]
    assert placed[0] == placed[1]
    assert faces[0] == faces[1]
    for cell in parts:
        assert sum(square.holds(cell) for square in whole) == 1


def triangles(file):
    """Count the triangles of what is not placed by rows."""
    return sum(
        file.json["accessors"][part["indices"]]["count"] // 3
        for node in file.json["nodes"] if "mesh" in node and
        "EXT_mesh_gpu_instancing" not in node.get("extensions", {})
        for part in file.json["meshes"][node["mesh"]]["primitives"]
    )  # fmt: skip


def test_a_tile_whose_overview_would_be_too_large_has_several_side_by_side(shown, monkeypatch):
    (whole,) = overviews_of(*shown, 500.0)
    cells = cells_of(*shown)
    assert all(whole.holds(cell) for cell in cells)
    monkeypatch.setattr("cityx.tiles.content.MOST", len(whole.glb) * 2 // 3)
    parts = overviews_of(*shown, 500.0)
    assert len(parts) > 1
    assert max(len(part.glb) for part in parts) < len(whole.glb)
    assert [sum(part.holds(cell) for part in parts) for cell in cells] == [1] * len(cells)
    seen = [
        Seen(part.name, part.box, 5.0,
             tuple(Seen(cell.name, cell.box) for cell in cells if part.holds(cell)))
        for part in parts
    ]  # fmt: skip
    root = tile_tileset(None, shown[2], seen, (), 500.0)["root"]
    assert "content" not in root
    assert root["geometricError"] > 5.0
    assert [child["geometricError"] for child in root["children"]] == [5.0] * len(parts)
    named = [leaf["content"]["uri"] for child in root["children"] for leaf in child["children"]]
    assert sorted(named) == sorted(cell.name for cell in cells)
