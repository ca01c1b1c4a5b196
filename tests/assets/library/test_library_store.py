import json
import shutil

import numpy as np
import pytest
import shapely

from cityx.assets.library.grow import grow_library, shares_of
from cityx.assets.library.local_text import LocalText
from cityx.assets.library.models import content_hashes
from cityx.assets.library.plots import draw_plots
from cityx.assets.library.records import validate_document
from cityx.assets.library.store import check_library, embed_library, open_library
from cityx.errors import InputError, UsageError
from cityx.ids import id_text


def tree_of(folder):
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in sorted(folder.rglob("*")) if path.is_file()
    }  # fmt: skip


def test_the_same_seed_gives_the_same_library_to_the_byte(small_library, tmp_path):
    again = grow_library(tmp_path / "again", 90, LocalText(), seed=3)
    assert tree_of(again.folder) == tree_of(small_library.folder)


def test_assets_are_distinct_valid_and_measured(small_library):
    table = small_library.catalogue
    assert len(table) == len(set(table["content_hash"])) == 90
    assert validate_document(table.document()) == []
    assert check_library(small_library) == []
    assert (table["length"] >= table["width"]).all()
    assert np.allclose(table["area"], table["length"] * table["width"])
    assert (table["footprint_area"] <= table["area"] + 1e-6).all()
    assert set(table["licence"]) == {"CC0-1.0"}
    assert set(table["source"]) == {"procedural"}


def test_buildings_fill_their_footprint_and_stand_on_the_ground(small_library):
    rows = np.flatnonzero(small_library.catalogue["group"] == "buildings")
    models = small_library.models(rows)
    assert len(rows)
    for index, row in enumerate(rows.tolist()):
        shell = models.shells.take([index]).vertices
        outline = small_library.catalogue["footprint"][row]
        body = shell[shell[:, 2] < 1.0]
        low, high = body[:, :2].min(axis=0), body[:, :2].max(axis=0)
        assert shapely.box(*low, *high).within(outline.envelope.buffer(1.5))
        assert -1.5 < shell[:, 2].min() <= 0.0
        assert shell[:, 2].max() == pytest.approx(small_library.catalogue["height"][row], abs=1e-3)


def test_geometry_read_back_has_the_content_that_was_recorded(small_library):
    rows = [5, 0, 60]
    models = small_library.models(rows)
    found = [id_text(number) for number in content_hashes(models).tolist()]
    assert found == small_library.catalogue["content_hash"][rows].tolist()


def test_a_realised_asset_has_the_triangles_of_its_record(small_library):
    table = small_library.catalogue
    row = int(np.flatnonzero(table["group"] == "buildings")[0])
    mesh = small_library.models([row]).realised(0)
    assert mesh.triangle_count == table["triangles"][row]
    assert mesh.count == 1


def test_growing_on_adds_other_assets_and_keeps_the_old_ones(small_library, tmp_path):
    folder = tmp_path / "library"
    shutil.copytree(small_library.folder, folder)
    grown = grow_library(folder, 30, LocalText(), seed=3)
    assert len(grown.catalogue) == 120
    assert set(small_library.catalogue["id"]) < set(grown.catalogue["id"])
    assert check_library(grown) == []
    assert len(list(folder.glob("table-*"))) == len(list(folder.glob("index-*"))) == 1


def test_a_plot_follows_from_its_number_alone():
    many, one = draw_plots(np.arange(50), 4), draw_plots(np.array([17]), 4)
    assert many.front[17] == one.front[0]
    assert many.use[17] == one.use[0]
    assert draw_plots(np.array([17]), 5).front[0] != one.front[0]


def test_groups_without_enough_assets_are_refused_before_anything_is_written(tmp_path):
    with pytest.raises(UsageError, match=r"hold \d+ distinct assets, not 500"):
        grow_library(tmp_path / "l", 500, LocalText(), groups=("vehicles", "furniture"))
    with pytest.raises(UsageError, match='Group "animals" cannot be grown: there is no such group'):
        grow_library(tmp_path / "l", 5, LocalText(), groups=("animals",))
    with pytest.raises(UsageError, match='There is no use "castle"'):
        grow_library(tmp_path / "l", 5, LocalText(), uses=("castle",))
    assert list(tmp_path.iterdir()) == []
    assert sum(shares_of(1000, ("buildings", "furniture")).values()) == 1000


def test_an_encoder_other_than_that_of_the_index_is_refused(small_library, tmp_path, fake_sight):
    folder = tmp_path / "library"
    shutil.copytree(small_library.folder, folder)
    before = tree_of(folder)
    with pytest.raises(UsageError, match="cannot be compared"):
        grow_library(folder, 5, fake_sight)
    assert tree_of(folder) == before
    made = embed_library(open_library(folder), fake_sight)
    assert made.encoder == "fake sight"
    with pytest.raises(UsageError, match="cannot be compared"):
        made.index.search(LocalText().encode_text(["house"]), 1, encoder=LocalText().identity)


def test_a_search_finds_what_is_described(small_library):
    encoder = LocalText()
    rows, _ = small_library.index.search(
        encoder.encode_text(["evergreen needle tree"]), 1, encoder=encoder.identity
    )
    assert small_library.catalogue["group"][rows[0, 0]] == "plants"


def test_damage_is_found_and_named(small_library, tmp_path):
    folder = tmp_path / "library"
    shutil.copytree(small_library.folder, folder)
    pack = sorted((folder / "buildings").glob("*.npz"))[0]
    pack.write_bytes(pack.read_bytes()[:200])
    (fault,) = [text for text in check_library(open_library(folder)) if pack.name in text]
    assert "is no pack of assets" in fault


def test_a_folder_without_a_library_and_one_of_a_newer_format_are_refused(small_library, tmp_path):
    with pytest.raises(InputError, match="holds no library"):
        open_library(tmp_path)
    folder = tmp_path / "library"
    shutil.copytree(small_library.folder, folder)
    head = json.loads((folder / "library.json").read_text())
    (folder / "library.json").write_text(json.dumps(head | {"format": 99}))
    with pytest.raises(InputError, match="its format is 99"):
        open_library(folder)


def test_a_folder_with_other_things_is_not_overwritten(tmp_path):
    (tmp_path / "thesis.txt").write_text("x")
    with pytest.raises(UsageError, match="holds other things"):
        grow_library(tmp_path, 5, LocalText(), anew=True)
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.txt"]


def test_an_asset_is_found_by_name_and_by_the_beginning_of_its_id(small_library):
    name = small_library.catalogue["collection"][4]
    text = id_text(int(small_library.catalogue["id"][4]))
    assert small_library.row_of(name) == small_library.row_of(text[:10]) == 4
    with pytest.raises(UsageError, match="has no asset"):
        small_library.row_of("nothing of the kind")
