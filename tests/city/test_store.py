from dataclasses import replace

import numpy as np
import pytest

from cityx.city import store
from cityx.city.content import content_hash
from cityx.city.store import forget_prototypes, read_city, read_view, write_city
from cityx.city.terrain import Survey, Terrain
from cityx.errors import InputError


def test_a_city_read_back_has_the_same_hash(small_city, tmp_path):
    write_city(small_city, tmp_path / "city")
    again = read_city(tmp_path / "city")
    assert content_hash(again).total == content_hash(small_city).total


def test_nothing_of_a_city_is_lost_on_disk(small_city, tmp_path):
    write_city(small_city, tmp_path / "city")
    again = read_city(tmp_path / "city")
    for name in ("name", "frame", "seed", "environment", "attribution", "stages_done", "failures",
                 "notes", "lod", "style"):  # fmt: skip
        assert getattr(again, name) == getattr(small_city, name)
    assert np.array_equal(again.terrain.heights, small_city.terrain.heights)
    assert again.terrain.datum == 12.5
    assert again.layout.buildings["id"].tolist() == [5, 2**63 + 7]
    assert again.layout.buildings["name"].tolist() == ["", "Dom"]
    assert again.scene.prototypes[0].mesh.materials == ("glass", "trim")
    assert again.scene.prototypes[0].mesh.material.tolist() == [1]


def test_the_terrain_on_disk_is_a_geotiff_in_the_local_frame(small_city, tmp_path):
    import rasterio

    write_city(small_city, tmp_path / "city")
    with rasterio.open(tmp_path / "city" / "terrain.tif") as dataset:
        assert dataset.crs.is_projected
        assert next(iter(dataset.sample([(10.0, 0.0)])))[0] == 1.0  # south-east node
        assert next(iter(dataset.sample([(0.0, 10.0)])))[0] == 2.0  # north-west node


def test_feature_tables_on_disk_carry_their_reference_system(small_city, tmp_path):
    from geopandas import read_parquet

    write_city(small_city, tmp_path / "city")
    table = read_parquet(tmp_path / "city/layout/buildings.parquet")
    assert table.crs.coordinate_operation.method_name == "Transverse Mercator"


def test_a_view_names_every_building(small_city, tmp_path):
    write_city(small_city, tmp_path / "city")
    view = read_view(tmp_path / "city")
    assert view.objects[2**63 + 7] == {
        "kind": "building", "name": "Dom", "source": "osm/way/2", "use": "church",
    }  # fmt: skip


def test_writing_again_replaces_the_folder_and_leaves_nothing_beside_it(small_city, tmp_path):
    write_city(small_city, tmp_path / "city")
    (tmp_path / "city" / "stale").touch()
    write_city(small_city, tmp_path / "city")
    assert [path.name for path in tmp_path.iterdir()] == ["city"]
    assert not (tmp_path / "city" / "stale").exists()


def test_a_folder_without_a_city_is_refused_by_name(tmp_path):
    with pytest.raises(InputError, match=r"holds no city: city\.json is missing"):
        read_city(tmp_path)


def test_what_the_height_file_says_is_kept(small_city, tmp_path):
    grid = Terrain((-5.0, -5.0), 10.0, np.arange(6.0).reshape(2, 3), 3.0)
    survey = Survey(np.array([[1.0, 2.0, 3.5]]), grid, 0.6, 0.1, 4.0)
    write_city(replace(small_city, survey=survey), tmp_path / "city")
    again = read_city(tmp_path / "city").survey
    assert again.points.tolist() == survey.points.tolist()
    assert (again.bound, again.tolerance, again.far_tolerance) == (0.6, 0.1, 4.0)
    assert np.array_equal(again.around.heights, grid.heights)
    assert (again.around.origin, again.around.datum) == ((-5.0, -5.0), 3.0)


def test_stores_share_large_prototypes_by_what_they_are(small_city, tmp_path, monkeypatch):
    one = small_city.scene.prototypes[0]
    monkeypatch.setattr(store, "LARGE", sum(array.nbytes for array in vars(one.mesh).values()
                                            if isinstance(array, np.ndarray)))  # fmt: skip
    small = replace(
        one, name="small", mesh=one.mesh.with_faces(np.zeros(len(one.mesh.faces), bool))
    )
    scene = replace(small_city.scene, prototypes=(one, small, replace(one, name="again")))
    city = replace(small_city, scene=scene)
    for name in "ab":
        write_city(city, tmp_path / name, kept=tmp_path / "kept")
    write_city(city, tmp_path / "alone")
    (held,) = (tmp_path / "kept").iterdir()
    large = [tmp_path / name / file for name in "ab"
             for file in ("prototypes.npz", "prototypes-2.npz")]  # fmt: skip
    assert {path.stat().st_ino for path in large} == {held.stat().st_ino}
    assert len({(tmp_path / name / "prototypes-1.npz").stat().st_ino for name in "ab"}) == 2
    read = [read_city(tmp_path / name) for name in ("a", "b", "alone")]
    assert {content_hash(each).total for each in read} == {content_hash(city).total}
    assert [each.name for each in read[0].scene.prototypes] == [one.name, "small", "again"]
    assert read[0].scene.prototypes[0].mesh.vertices.base is not None
    forget_prototypes(tmp_path / "kept")
    assert held.exists()
    for path in large:
        path.unlink()
    forget_prototypes(tmp_path / "kept")
    assert not held.exists()


def test_a_store_is_the_same_where_files_have_one_name(small_city, tmp_path, monkeypatch):
    def no_link(*_):
        raise OSError

    monkeypatch.setattr(store, "LARGE", 0)
    write_city(small_city, tmp_path / "linked", kept=tmp_path / "kept")
    monkeypatch.setattr(store.os, "link", no_link)
    write_city(small_city, tmp_path / "plain", kept=tmp_path / "none")
    assert list((tmp_path / "none").iterdir()) == []
    for path in (tmp_path / "linked").glob("prototypes*"):
        assert path.read_bytes() == (tmp_path / "plain" / path.name).read_bytes()
