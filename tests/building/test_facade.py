from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import shapely

from cityx.assets.trims.roof_furniture import REACH
from cityx.building.facade import grammar as facades
from cityx.building.facade.dressing import footings
from cityx.building.facade.facade import facade
from cityx.building.facade.facade_plan import WINDOW_ROLES, facade_of
from cityx.building.roofs.rooftop import GARDEN_SORTS
from cityx.building.shell import shell
from cityx.checks.building_checks import floating_gap
from cityx.city import City, Environment, Frame, Layout, Terrain, make_table
from cityx.city.content import content_hash
from cityx.city.ground import KERB_HEIGHT

SOHO = Path(__file__).parents[2] / "../shared/data/osm/london_soho.osm.gz"
COUNT = 8


def terrace(order=None, *, use="apartments", entrances=(), count=COUNT):
    """Build houses in a row along a street that runs before their south fronts."""
    order = np.arange(count) if order is None else order
    x = np.arange(count) * 12.0
    boxes = shapely.box(x, 0, x + 12.0, 11)[order]
    ids = (np.arange(1, count + 1, dtype=np.uint64) * np.uint64(7919))[order]
    same = {"id": ids, "use": [use] * count, "levels": [4] * count}
    buildings = make_table("buildings", boxes, place=["urban"] * count, **same)
    parts = make_table(
        "parts", boxes, building=ids, top=[14.0] * count, base=[0.0] * count, walls=[True] * count,
        roof_shape=["flat"] * count, roof_height=[0.0] * count, wall_color=[-1] * count,
        roof_color=[-1] * count, **same,
    )  # fmt: skip
    street = shapely.LineString([(-50, -8), (150, -8)])
    roads = make_table("roads", np.array([street], object), id=[5], kind=["residential"])
    points = make_table(
        "points", shapely.points(np.reshape(entrances, (-1, 2))),
        id=np.arange(len(entrances), dtype=np.uint64) + 1, kind=["entrance"] * len(entrances),
    )  # fmt: skip
    layout = Layout((-50, -20, 150, 30), buildings, parts, roads, points=points)
    return City("terrace", Frame(52.5, 13.4), layout)


def test_every_house_has_one_door_on_its_street():
    found = facade_of(terrace())
    doors = found.openings.take(found.openings.role == facades.DOOR)
    assert sorted(found.walls.part[doors.wall].tolist()) == list(range(COUNT))
    assert (found.walls.normal[doors.wall][:, 1] < -0.99).all()
    assert np.allclose(doors.low, KERB_HEIGHT)


@pytest.mark.parametrize("use", ["apartments", "retail"])
def test_no_door_opens_onto_water(use):
    city = terrace(use=use)
    pond = make_table("areas", [shapely.box(-20, -5, 50, 0)], id=[9], kind=["water"])
    found = facade_of(replace(city, layout=replace(city.layout, areas=pond)))
    doors = found.openings.take(np.isin(found.openings.role, [facades.DOOR, facades.SHOP]))
    wall = doors.wall
    south = found.walls.normal[wall][:, 1] < -0.99
    assert sorted(np.unique(found.walls.part[wall[south]]).tolist()) == [5, 6, 7]
    assert set(found.walls.part[wall].tolist()) == set(range(COUNT))


@pytest.mark.parametrize("use", ["silo", "storage_tank", "cooling_tower", "chimney"])
def test_tanks_and_chimneys_have_closed_walls(use):
    assert facade_of(terrace(use="industrial")).openings.count
    assert not facade_of(terrace(use=use)).openings.count


def test_party_walls_have_no_openings():
    found = facade_of(terrace())
    blind = found.walls.blind_to > found.walls.z_low + 0.5
    assert blind.sum() == 2 * (COUNT - 1)
    assert not blind[found.openings.wall].any()


def hillside(rise_x, rise_y):
    """Stand the terrace on a slope that rises to the east and away from the street."""
    x, y = np.arange(-60.0, 161.0, 10.0), np.arange(-30.0, 51.0, 10.0)
    slope = Terrain((-60.0, -30.0), 10.0, rise_x * x[None] + rise_y * y[:, None])
    return replace(terrace(), terrain=slope)


def test_doors_on_a_slope_stand_at_the_ground_and_walls_reach_below_it():
    for rise in ((0.0, 0.5), (0.2, 0.0), (0.1, -0.3)):
        city = shell(hillside(*rise))
        found = facade_of(city)
        doors = found.openings.take(found.openings.role == facades.DOOR)
        assert sorted(found.walls.part[doors.wall].tolist()) == list(range(COUNT))
        unit = (found.walls.end - found.walls.start) / found.walls.length[:, None]
        place = found.walls.start[doors.wall] + unit[doors.wall] * doors.along[:, None]
        gap = doors.low - city.terrain.height_at(place) - KERB_HEIGHT
        assert np.abs(gap).max() < 0.3
        assert floating_gap(city).max() == 0.0


def test_windows_on_a_slope_step_with_the_ground():
    city = hillside(0.0, 0.8)
    found = facade_of(city)
    windows = found.openings.take(np.isin(found.openings.role, WINDOW_ROLES))
    unit = (found.walls.end - found.walls.start) / found.walls.length[:, None]
    place = found.walls.start[windows.wall] + unit[windows.wall] * windows.along[:, None]
    clear = windows.low - city.terrain.height_at(place)
    assert clear.min() > KERB_HEIGHT
    # The side that the slope lays open shows more storeys than the one at its top.
    faces = found.walls.normal[windows.wall][:, 1]
    below, above = (windows.floor[side] for side in (faces < -0.9, faces > 0.9))
    assert len(np.unique(below)) > len(np.unique(above)) > 0


def test_walls_that_a_slope_lays_open_stand_on_a_base_of_stone():
    assert not footings(facade_of(terrace()))[0].any()
    found = facade_of(hillside(0.0, 1.4))  # steeper than the houses are high
    footed, low, high = footings(found)
    assert (found.walls.normal[footed][:, 1] < -0.99).all()
    assert footed.sum() == COUNT
    assert (low < found.fronts.pavement.min(axis=1))[footed].all()
    windows = found.openings.take(np.isin(found.openings.role, WINDOW_ROLES))
    of = footed[windows.wall]
    assert (windows.low >= high[windows.wall])[of].all()


def test_a_mapped_entrance_moves_the_door():
    found = facade_of(terrace(entrances=[(3.1, 11.2)]))
    door = np.flatnonzero(
        (found.openings.role == facades.DOOR) & (found.walls.part[found.openings.wall] == 0)
    )
    wall = found.openings.wall[door]
    assert len(door) == 1
    assert found.walls.normal[wall][0, 1] > 0.99
    assert np.isclose(12.0 - found.openings.along[door[0]], 3.1)


def test_rows_do_not_depend_on_the_order_of_the_input():
    first, second = facade(terrace()).scene, facade(terrace(np.arange(COUNT)[::-1])).scene
    assert first.instances
    for layer, rows in first.instances.items():
        assert np.array_equal(rows.object_id, second.instances[layer].object_id)
        assert np.array_equal(rows.position, second.instances[layer].position)


def test_ids_are_unique_and_owned_by_buildings():
    city = terrace()
    scene = facade(city).scene
    owners = set(city.layout.buildings["id"].tolist())
    ids = np.concatenate([rows.object_id for rows in scene.instances.values()])
    assert len(np.unique(ids)) == len(ids)
    for rows in scene.instances.values():
        assert set(rows.owner.tolist()) <= owners


def test_windows_stand_before_their_walls():
    city = terrace()
    rows = facade(city).scene.instances["windows"]
    assert rows.count > 200
    solid = shapely.union_all(city.layout.parts.geometry.to_numpy())
    away = shapely.distance(shapely.boundary(solid), shapely.points(rows.position[:, :2]))
    assert away.max() < 1e-6
    outward = np.column_stack([np.sin(rows.rotation[:, 2]), -np.cos(rows.rotation[:, 2])])
    inside = shapely.points(rows.position[:, :2] - 0.1 * outward)
    assert shapely.contains(solid, inside).all()


def test_shops_have_shopfronts():
    scene = facade(terrace(use="retail")).scene
    assert scene.instances["shopfronts"].count > 0
    assert facade(terrace(use="house")).scene.instances["shopfronts"].count == 0


def test_no_window_depends_on_the_hour():
    day = facade(terrace())
    night = facade(replace(terrace(), environment=Environment(night_lights=0.4, shop_lights=0.8)))
    same = replace(night, environment=day.environment)
    assert content_hash(same).total == content_hash(day).total


def test_below_level_two_nothing_happens():
    city = replace(terrace(), lod=1)
    assert facade(city) is city


def test_a_city_without_buildings_gets_empty_layers():
    scene = facade(City("empty", Frame(0, 0), Layout((0, 0, 1, 1)))).scene
    assert all(rows.count == 0 for rows in scene.instances.values())


def test_chimneys_begin_in_the_roof():
    city = terrace()
    city.layout.parts["roof_shape"] = "gabled"
    city.layout.parts["roof_height"] = 3.0
    rows = facade(city).scene.instances["roof_furniture"]
    assert rows.count > 0
    assert (rows.position[:, 2] > 11.0).all()
    assert (rows.position[:, 2] < 14.0).all()
    assert (rows.position[:, 2] + 3 * rows.scale[:, 2] > 14.5).all()


def roof_rows(use="apartments", count=COUNT):
    city = facade(terrace(use=use, count=count))
    rows = city.scene.instances["roof_furniture"]
    names = np.array([p.name for p in city.scene.prototypes])[rows.prototype]
    return city, rows, names


def test_railings_stand_inside_parapets_but_at_walls_shared_with_a_neighbour():
    city, rows, names = roof_rows()
    owners = np.unique(rows.owner[names == "roof_railing"])
    assert 0 < len(owners) < COUNT  # some of the roofs
    for owner in owners:
        of = (rows.owner == owner) & (names == "roof_railing")
        house = city.layout.parts.geometry[city.layout.parts["building"] == owner].iloc[0]
        away = shapely.distance(house.boundary, shapely.points(rows.position[of, :2]))
        assert np.allclose(away, 0.45, atol=1e-6)
        assert shapely.contains(house, shapely.points(rows.position[of, :2])).all()
        shared = 1 if owner in city.layout.parts["building"].iloc[[0, -1]].to_numpy() else 2
        around = 2 * (12.0 - 0.9) + (2 - shared) * (11.0 - 0.9)
        assert np.sum(3.0 * rows.scale[of, 0]) == pytest.approx(around, rel=1e-5)


def test_roof_gardens_are_of_several_sorts_and_stay_on_their_roofs():
    city, rows, names = roof_rows(count=150)
    garden = np.isin(names, list(GARDEN_SORTS))
    assert set(names[garden]) == set(GARDEN_SORTS)
    reach = np.array([REACH[name] for name in names[garden]])
    spots = shapely.points(rows.position[garden, :2])
    houses = city.layout.buildings.set_index("id").geometry
    home = houses.loc[rows.owner[garden]].to_numpy()
    assert shapely.contains(home, spots).all()
    assert (shapely.distance(shapely.boundary(home), spots) >= 0.6 * reach).all()


def test_wear_lies_on_flat_roofs_and_every_piece_has_an_id():
    _, rows, names = roof_rows("office")
    worn = np.array([name.startswith(("roof_stain", "roof_sheet")) for name in names])
    assert worn.sum() > 3
    assert (rows.scale[worn, 2] >= 1.0).all()
    assert len(np.unique(rows.object_id)) == rows.count


@pytest.mark.shared
@pytest.mark.skipif(not SOHO.exists(), reason="needs ../shared/data/osm")
def test_fronts_of_a_real_quarter_are_sane():
    from cityx.sources.osm import read_osm

    city = read_osm(SOHO)
    found = facade_of(city)
    walls, openings = found.storey_walls, found.openings
    half = openings.width / 2
    assert (openings.along - half > 0.1).all()
    assert (openings.along + half < walls.length[openings.wall] - 0.1).all()
    top = openings.low + openings.height
    assert (top < walls.z_high[openings.wall]).all()
    covered = walls.blind_to > walls.z_low + 0.01
    assert (openings.low > np.where(covered, walls.blind_to, -np.inf)[openings.wall]).all()
    doors = openings.take(openings.role == facades.DOOR)
    owners, count = np.unique(found.volumes.building[walls.part[doors.wall]], return_counts=True)
    points = city.layout.points
    mapped = points.geometry[points["kind"] == "entrance"].to_numpy()
    outlines = city.layout.buildings.set_index("id").geometry.loc[owners].to_numpy()
    near = shapely.STRtree(outlines).query(mapped, "dwithin", distance=2.0)[1]
    assert (count <= np.maximum(np.bincount(near, minlength=len(owners)), 1)).all()
    assert len(owners) > 0.9 * len(city.layout.buildings)
    glazed = np.bincount(openings.wall, openings.width * openings.height, minlength=walls.count)
    street = found.fronts.street & (walls.length > 4) & (found.fronts.mode == facades.PUNCHED)
    share = glazed[street].sum() / (walls.length * (walls.z_high - walls.z_low))[street].sum()
    assert 0.18 < share < 0.5


def test_every_balcony_has_a_door_and_rhythms_differ():
    city = replace(terrace(), lod=3)
    found = facade_of(city)
    balcony = replace(found.fronts, balcony=np.ones(found.walls.count, bool))
    made = facades.lay_out(found.storey_walls, balcony, city.seed)
    french = made.take(made.role == facades.FRENCH)
    assert french.count > 20
    floor = found.storeys.floor_of(french.wall, french.floor)
    assert np.allclose(french.low - floor, 0.06)  # one steps out at floor level
    part = found.walls.part[french.wall]
    rows = {tuple(zip(french.floor[part == p], french.bay[part == p], strict=True))
            for p in np.unique(part)}  # fmt: skip
    assert len(rows) > 2


@pytest.mark.parametrize(("height", "levels"), [(56, 21), (40, 16), (70, 27)])
def test_a_low_base_under_a_tower_has_a_door(height, levels):
    boxes = shapely.box(0, 0, 40, 18), shapely.box(8, 3, 32, 15)
    low = height / levels
    parts = make_table(
        "parts", boxes, id=[1, 2], building=[1, 1], top=[low, height], base=[0.0, low],
        walls=[True] * 2, roof_shape=["flat"] * 2, roof_height=[0.0] * 2, levels=[1, levels - 1],
        use=["apartments"] * 2, wall_color=[-1] * 2, roof_color=[-1] * 2,
    )  # fmt: skip
    buildings = make_table("buildings", boxes[:1], id=[1], use=["apartments"], levels=[levels])
    street = make_table("roads", [shapely.LineString([(-50, -8), (90, -8)])], id=[5],
                        kind=["residential"])  # fmt: skip
    city = City("tower", Frame(52.5, 13.4), Layout((-50, -20, 90, 30), buildings, parts, street))
    for seed in range(6):
        found = facade_of(replace(city, seed=seed))
        doors = found.openings.take(found.openings.role == facades.DOOR)
        assert doors.count == 1
        assert doors.height[0] > 1.8
