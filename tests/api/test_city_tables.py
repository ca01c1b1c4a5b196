import json

import numpy as np
import pytest
import shapely

# pyproj takes an array of one point for a scalar, of which NumPy 1.26 warns.
pytestmark = pytest.mark.filterwarnings("ignore:Conversion of an array:DeprecationWarning")
NAMES = ("buildings", "parts", "roads", "lanes", "junctions", "ground", "land", "water", "trees",
         "furniture", "vehicles", "people")  # fmt: skip


@pytest.mark.parametrize("name", NAMES)
def test_every_table_lies_on_earth(held, name):
    table = getattr(held, name)
    degrees = table.to_crs(4326)
    if len(table):
        west, south, east, north = degrees.total_bounds
        assert 24.93 < west <= east < 24.95
        assert 60.16 < south <= north < 60.18


@pytest.mark.parametrize("name", [name for name in NAMES if name != "ground"])
def test_rows_are_indexed_by_stable_ids(held, name):
    table = getattr(held, name)
    assert (table.index.name, table.index.dtype) == ("id", np.uint64)
    assert table.index.is_unique
    assert table.index.equals(getattr(held, name).index)


def test_what_the_map_says_is_in_the_tables(held):
    houses, ways = held.buildings, held.roads
    tall = houses[houses["tags"].map(lambda tags: tags.get("height") == "24")]
    assert tall["height"].tolist() == [24.0]
    assert tall["use"].tolist() == ["office"]
    assert "High Street" in ways["name"].tolist()
    assert held.water.area.sum() == pytest.approx(170 * 14, rel=0.01)
    assert held.land["kind"].tolist() == ["park"]


def test_the_tables_of_the_city_itself_stay_as_they_are(held):
    _ = held.buildings
    table = held.city.layout.buildings
    assert table.crs is None
    assert isinstance(table["tags"].iloc[0], str)
    assert json.loads(table["tags"].iloc[0]) == held.buildings["tags"].iloc[0]


def test_volumes_and_lanes_name_what_they_belong_to(held):
    assert set(held.parts["building"]) == set(held.buildings.index)
    assert set(held.lanes["road"]) <= set(held.roads.index)
    following = {lane for lanes in held.lanes["next"] for lane in lanes}
    assert following
    assert following <= set(held.lanes.index)


def test_lanes_run_in_the_direction_of_travel(held):
    lanes = held.lanes
    assert (lanes["width"] > 0).all()
    ends = shapely.get_point(lanes.geometry.to_numpy(), -1)
    starts = dict(zip(lanes.index, shapely.get_point(lanes.geometry.to_numpy(), 0), strict=True))
    for end, following in zip(ends, lanes["next"], strict=True):
        assert all(end.distance(starts[lane]) < 40 for lane in following)


def test_the_crossing_is_a_junction_of_four_arms(held):
    junctions = held.junctions
    assert junctions["arms"].max() == 4
    crossing = junctions[junctions["arms"] == 4].geometry.iloc[0]
    assert crossing.distance(shapely.Point(held.city.frame.to_local([24.94, 60.17])[0])) < 1.0


def test_the_faces_of_the_ground_cover_the_site_once(held):
    ground = held.ground
    assert ground.is_valid.all()
    assert ground.area.sum() == pytest.approx(shapely.box(*held.city.layout.extent).area, rel=1e-6)
    assert ground.union_all().area == pytest.approx(ground.area.sum(), rel=1e-6)
    assert {"carriageway", "kerb", "building", "water"} <= set(ground["surface"])


def test_trees_stand_where_the_map_has_them(held):
    trees = held.trees
    assert (trees["height"] > 0).all()
    mapped = held.city.layout.points.query("kind == 'tree'").geometry
    assert all(trees.distance(place).min() < 2.0 for place in mapped)
    assert held.layer("trees").index.equals(trees.index)


@pytest.mark.slow
def test_the_tables_can_be_explored_and_written(held, tmp_path):
    pytest.importorskip("folium")
    page = held.buildings.explore(column="height").get_root().render()
    assert "High Street" in held.explore().get_root().render()
    assert "height" in page
    held.buildings.drop(columns="tags").to_parquet(tmp_path / "buildings.parquet")


def test_vehicles_and_people_that_move_are_in_the_tables():
    from moving_city import moving

    from cityx.api.tables import Tables

    car = (1, "car_sedan", "car", "ride", (0.0, 10.0, 0.0), 0.0, 4.0)
    walker = (2, "person_male_casual_2", "pedestrian", "walk", (5.0, 20.0, 0.0), 1.5, 1.2)

    class Held(Tables):
        city = moving(car, walker)

    held = Held()
    assert held.vehicles["kind"].tolist() == ["car"]
    assert held.people["kind"].tolist() == ["pedestrian"]
    assert held.people["speed"].tolist() == [pytest.approx(1.2)]
