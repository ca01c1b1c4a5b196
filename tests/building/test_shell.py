from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import shapely

from cityx.building import shell as shells
from cityx.building.shell import prism, shell
from cityx.building.volumes import volumes_of, walls_of
from cityx.city import City, Frame, Layout, Terrain, make_table
from cityx.city.content import hash_mesh
from cityx.city.mesh_measures import check_closed, degenerate_faces, plan_area, volume

WORDS = ["flat", "gabled", "hipped", "mansard", "skillion", "dome", "half-hipped", "unheard of"]


def town(count=60, **columns) -> City:
    rng = np.random.default_rng(5)
    x, y = 30.0 * (np.arange(count) % 8), 30.0 * (np.arange(count) // 8)
    wide, deep = rng.uniform(6, 28, count), rng.uniform(6, 28, count)
    shapes = shapely.box(x, y, x + wide, y + deep)
    ids = np.arange(1, count + 1)
    given = {
        "id": ids,
        "building": ids,
        "top": rng.uniform(5, 30, count),
        "roof_height": rng.uniform(0, 4, count),
        "roof_shape": [WORDS[i % len(WORDS)] for i in range(count)],
        "roof_direction": np.full(count, np.nan),
        "walls": ids % 10 != 0,
        **columns,
    }
    layout = Layout(
        (0.0, 0.0, 240.0, 240.0),
        buildings=make_table("buildings", shapes, id=ids),
        parts=make_table("parts", shapes, **given),
    )
    return City("town", Frame(50.0, 10.0), layout, seed=3)


@pytest.mark.parametrize("action", [prism, shell])
def test_every_building_is_one_closed_object_on_its_plan(action):
    city = action(town())
    batch = city.scene.meshes["buildings"]
    assert batch.object_id.tolist() == list(range(1, 61))
    assert check_closed(batch).all()
    assert (volume(batch) > 0).all()
    area = shapely.area(city.layout.buildings.geometry.to_numpy())
    assert plan_area(batch) == pytest.approx(area, rel=5e-3)
    assert "building" in city.stages_done


def test_parts_of_a_building_share_its_object():
    city = town(4, building=[7, 7, 9, 9])
    batch = prism(city).scene.meshes["buildings"]
    assert batch.object_id.tolist() == [7, 9]
    assert check_closed(batch).all()


def test_senseless_numbers_still_give_closed_shells():
    wild = [np.nan, -5.0, 1e9, np.inf, 0.0, 3.0]
    city = town(6, top=wild, base=[np.nan, 4, 2, -1, 9, 3], roof_height=[99, np.nan, 5, 2, 1, -4])
    batch = shell(city).scene.meshes["buildings"]
    assert batch.count == 6
    assert check_closed(batch).all()
    assert np.isfinite(batch.vertices).all()


def test_an_outline_without_area_is_named_and_the_others_stand():
    city = town(3)
    shapes = city.layout.parts.geometry.to_numpy().copy()
    shapes[1] = shapely.Polygon([(0, 0), (5, 0), (9, 0)])
    parts = city.layout.parts.set_geometry(shapes)
    built = shell(replace(city, layout=replace(city.layout, parts=parts)))
    assert built.scene.meshes["buildings"].object_id.tolist() == [1, 3]
    assert [failure.object_id for failure in built.failures] == [2]


def test_a_city_without_buildings_gets_an_empty_layer():
    assert shell(town(0)).scene.meshes["buildings"].count == 0
    assert prism(town(0)).scene.meshes["buildings"].count == 0


def test_the_size_of_chunks_changes_nothing(monkeypatch):
    whole = shell(town()).scene.meshes["buildings"]
    monkeypatch.setattr(shells, "CHUNK", 25)
    parts = shell(town()).scene.meshes["buildings"]
    assert whole.vertices.tobytes() == parts.vertices.tobytes()
    assert whole.uv.tobytes() == parts.uv.tobytes()
    assert (hash_mesh(whole)[1] == hash_mesh(parts)[1]).all()


def test_one_building_changed_leaves_the_others_as_they_were():
    before = shell(town()).scene.meshes["buildings"]
    tops = town().layout.parts["top"].to_numpy().copy()
    tops[20] += 2.0
    after = shell(town(top=tops)).scene.meshes["buildings"]
    changed = np.flatnonzero(hash_mesh(before)[1] != hash_mesh(after)[1])
    assert changed.tolist() == [20]


def test_nothing_floats_on_a_slope():
    slope = Terrain((0.0, 0.0), 240.0, np.array([[0.0, 10.0], [0.0, 10.0]]))
    city = replace(town(), terrain=slope)
    batch = shell(city).scene.meshes["buildings"]
    foot = np.array([batch.take([i]).vertices[:, 2].min() for i in range(batch.count)])
    volumes = volumes_of(city.layout, slope)
    lowest = slope.height_at(shapely.get_coordinates(volumes.polygons)).reshape(-1, 5).min(axis=1)
    assert (foot < lowest).all()
    assert volumes.ground == pytest.approx(lowest + 0.12)


@pytest.mark.parametrize("action", [prism, shell])
def test_houses_whose_walls_a_slope_makes_far_higher_are_named(action):
    steep = Terrain((0.0, 0.0), 240.0, np.array([[0.0, 200.0], [0.0, 200.0]]))
    city = replace(town(4, top=[6.0, 6.0, 60.0, 6.0]), terrain=steep)
    names = ["osm/way/1", "osm/way/2", "osm/way/3", "parcel/4"]
    buildings = city.layout.buildings.assign(source=names)
    built = action(replace(city, layout=replace(city.layout, buildings=buildings)))
    told = [note for note in built.notes if "on slopes" in note]
    assert told == ["map: 2 buildings on slopes have walls downhill over their height: "
                    "osm/way/1, osm/way/2"]  # fmt: skip
    assert action(built).notes == built.notes


def test_canopies_stand_on_posts_and_have_no_walls():
    city = town(1, walls=[False], roof_shape=["flat"], top=[5.0])
    batch = shell(city).scene.meshes["buildings"]
    names = np.array(batch.materials)[batch.material]
    assert (names == "trim").sum() > 20
    assert check_closed(batch).all()
    assert walls_of(city.layout, city.terrain).count == 0


def test_eaves_stay_clear_of_a_neighbour():
    shapes = shapely.box([0.0, 10.2], 0.0, [10.0, 20.0], 8.0)
    ids = [1, 2]
    layout = Layout(
        (0.0, 0.0, 20.0, 8.0),
        buildings=make_table("buildings", shapes, id=ids),
        parts=make_table("parts", shapes, id=ids, building=ids, top=[9.0, 9.0], walls=[True] * 2,
                         roof_shape=["gabled"] * 2, roof_height=[3.0] * 2,
                         roof_direction=[np.nan] * 2),
    )  # fmt: skip
    batch = shell(City("pair", Frame(50.0, 10.0), layout)).scene.meshes["buildings"]
    assert batch.take([0]).vertices[:, 0].max() == pytest.approx(10.0)
    assert batch.take([0]).vertices[:, 0].min() == pytest.approx(-0.21)  # a verge


@pytest.mark.shared
@pytest.mark.parametrize("place", ["london_soho", "haute_marne_village", "tokyo_yoyogi"])
def test_real_buildings_are_closed_on_their_plan(place):
    from cityx.sources.osm import read_osm

    folder = Path(__file__).parents[2] / "../shared/data/osm"
    files = sorted(folder.glob(f"{place}.osm*"))
    if not files:
        pytest.skip(f"the map {place} is not beside the repository")
    city = shell(read_osm(files[0]))
    batch = city.scene.meshes["buildings"]
    volumes = volumes_of(city.layout, city.terrain)
    owner = np.searchsorted(batch.object_id, volumes.building)
    area = np.bincount(owner, shapely.area(volumes.polygons))
    beside, row = volumes.beside_ways()  # ways through: what stands beside them has a foot too
    area += np.bincount(owner[row], shapely.area(beside), minlength=len(area))
    assert check_closed(batch).all()
    assert plan_area(batch) == pytest.approx(area, rel=5e-3)
    assert not degenerate_faces(batch).any()
    simpler = [failure for failure in city.failures if failure.action == "building/shell-v1"]
    assert len(simpler) < 0.015 * len(volumes.top)


def test_only_a_roof_that_is_stated_fails_where_its_outline_does_not_admit_it():
    """Two houses with an outline that bears no half hips, one of them with a tag for them."""
    corners = np.array([(15.5, 24.4), (8.8, 20.4), (5.6, 23.6), (0.0, 22.0), (3.7, 0.1),
                        (12.2, 2.1), (17.5, 12.0)])  # fmt: skip
    shapes = [shapely.Polygon(corners + np.array([40.0 * k, 0.0])) for k in range(2)]
    ids = np.array([1, 2], np.uint64)
    told = ['{"building": "yes"}', '{"building": "yes", "roof:shape": "half-hipped"}']
    source = ["osm/way/1", "osm/way/2"]
    parts = make_table(
        "parts", shapes, id=ids, building=ids, top=[13.5, 13.5], roof_height=[5.1, 5.1],
        roof_shape=["half-hipped", "half-hipped"], roof_direction=[np.nan, np.nan],
    )  # fmt: skip
    buildings = make_table("buildings", shapes, id=ids, tags=told, source=source)
    layout = Layout((-5.0, -5.0, 80.0, 40.0), buildings=buildings, parts=parts)
    built = shell(City("town", Frame(50.0, 10.0), layout, seed=3))
    assert built.scene.meshes["buildings"].count == 2
    assert [failure.object_id for failure in built.failures] == [2]
