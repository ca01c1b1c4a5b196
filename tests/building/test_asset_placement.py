from dataclasses import replace

import numpy as np
import pytest
import shapely

from cityx.assets.library.fit import Targets, targets_of
from cityx.assets.library.grow import grow_library
from cityx.assets.library.local_text import LocalText
from cityx.building.asset_placement import (
    LAYER,
    assets,
    lots_of,
    party_sides,
    take_lots,
)
from cityx.building.shell import shell
from cityx.city.scene import Scene
from cityx.convert.library_retrieval import library_retrieval
from cityx.protocol import InputFiles
from cityx.protocol.example_city import example_city


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    folder = tmp_path_factory.mktemp("placing") / "library"
    groups = ("buildings",)
    return grow_library(folder, 128, LocalText(), groups=groups, uses=("house", "flats")).folder


def town(count=6):
    """Detached boxes in a row north of a street."""
    from cityx.city import City, Frame, Layout, make_table

    x = np.arange(count) * 25.0
    shapes = shapely.box(x, 10, x + 12.0, 21)
    ids = np.arange(1, count + 1, dtype=np.uint64) * np.uint64(7919)
    same = {"id": ids, "use": ["apartments"] * count, "levels": [4] * count}
    buildings = make_table("buildings", shapes, height=[13.0] * count, **same)
    parts = make_table(
        "parts", shapes, building=ids, top=[13.0] * count, walls=[True] * count,
        roof_shape=["flat"] * count, wall_color=[-1] * count, roof_color=[-1] * count, **same,
    )  # fmt: skip
    street = np.array([shapely.LineString([(-50, 0), (250, 0)])], object)
    roads = make_table("roads", street, id=[5], kind=["residential"], width=[6.0])
    return City("row", Frame(52.5, 13.4), Layout((-50, -20, 250, 40), buildings, parts, roads))


def test_placed_assets_replace_the_shells_and_everything_they_own(library):
    city = shell(town())
    made = assets(city, InputFiles((library,)))
    rows = made.scene.instances[LAYER]
    left = set(made.scene.meshes["buildings"].object_id.tolist())
    placed = set(rows.object_id.tolist())
    assert placed
    assert placed | left == set(city.layout.buildings["id"].tolist())
    assert not placed & left
    owners = set(made.scene.instances["windows"].owner.tolist())
    assert owners <= placed
    ids = np.concatenate([t.object_id for t in made.scene.instances.values()])
    assert len(np.unique(ids)) == len(ids)
    assert made.notes[-1].startswith(f"{len(placed)} of 6 buildings are assets")


def test_fittings_stay_with_their_asset(library):
    made = assets(shell(town()), InputFiles((library,)))
    rows = made.scene.instances["windows"]
    lots = town().layout.buildings
    assert len(rows.owner)
    for owner in np.unique(rows.owner).tolist():
        outline = lots[lots["id"] == owner].geometry.iloc[0]
        at = shapely.points(rows.position[rows.owner == owner][:, :2])
        assert shapely.distance(outline, at).max() < 1.0
        assert rows.position[rows.owner == owner][:, 2].min() > 0


def test_fronts_face_the_street(library):
    made = assets(shell(town()), InputFiles((library,)))
    turn = made.scene.instances[LAYER].rotation[:, 2]
    assert np.allclose(np.cos(turn), 1.0, atol=1e-5)  # assets face south, as the street lies


def test_a_share_of_nothing_changes_nothing(library):
    city = shell(town())
    made = assets(city, InputFiles((library,)), share=0.0)
    assert np.array_equal(
        made.scene.meshes["buildings"].object_id, city.scene.meshes["buildings"].object_id
    )


def test_mode_paper_scales_by_the_short_sides(library):
    made = assets(shell(town()), InputFiles((library,)), mode="paper")
    assert made.scene.instances[LAYER].count == 6
    assert (made.scene.instances[LAYER].scale <= 1.0 + 1e-6).all()


def test_without_a_library_a_small_one_is_grown():
    made = assets(town(), InputFiles())
    assert made.scene.instances[LAYER].count > 0
    assert isinstance(made.scene, Scene)


def test_sides_with_neighbours_are_found():
    city = town(3)
    layout = city.layout
    touching = shapely.box(np.arange(3) * 12.0, 10, np.arange(3) * 12.0 + 12.0, 21)
    table = layout.buildings.set_geometry(touching)
    lots = lots_of(replace(city, layout=replace(layout, buildings=table)))
    assert lots.party.tolist() == [2, 3, 1]
    target = targets_of(lots)
    assert isinstance(target, Targets)
    assert party_sides(take_lots(lots, [0]), targets_of(take_lots(lots, [0]))).tolist() == [0]


def test_retrieval_returns_one_mesh_of_the_group_that_was_asked_for(library):
    mesh = library_retrieval(example_city(), InputFiles((library,)), "brick house")
    assert mesh.count == 1
    assert mesh.triangle_count > 10
