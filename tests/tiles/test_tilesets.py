"""Tilesets and their content: on their place on Earth, valid, with the ids of the store."""

import json

import numpy as np
import pytest
from pyproj import Transformer

from cityx.city import Frame
from cityx.city.mesh import one_mesh
from cityx.city.store import read_city
from cityx.ids import id_text
from cityx.tiles.content import distance_between
from cityx.tiles.run import TILES, records
from cityx.tiles.tileset import transform_of

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
