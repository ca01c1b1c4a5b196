from dataclasses import replace
from datetime import date, timedelta

import numpy as np
import pytest
import shapely

from cityx.assets.trees import STREET_FORMS, WALLED, size_of, wall_reach
from cityx.checks.predicates import measure
from cityx.city import City, Environment, Frame, Layout, Scene, make_table
from cityx.errors import ActionFailed, UsageError
from cityx.geometry.scatter import Points
from cityx.nature.trees.climate import season_of, species_of_tags
from cityx.nature.trees.planting import _thickets, trees
from cityx.nature.trees.stands import fitted_crowns, forms_of, stand_of, take_trees
from cityx.nature.trees.tree_room import OVERHANG, Room, fitted, room_of
from cityx.places.profiles import climate_of

DAY = date(2025, 1, 1)


def rows_of(city):
    rows = city.scene.instances["trees"]
    names = [city.scene.prototypes[i].name for i in rows.prototype]
    return rows, names


@pytest.fixture(scope="module")
def planted(crossroads):
    return trees(crossroads)


def test_no_trunk_stands_in_a_house_a_road_or_a_pond(planted):
    xy = planted.scene.instances["trees"].position[:, :2]
    spots = shapely.points(xy)
    for house in planted.layout.buildings.geometry:
        assert (shapely.distance(spots, house) > 0.5).all()
    assert (np.abs(xy).min(axis=1) > 5.7).all()
    assert (shapely.distance(spots, shapely.box(-60, 50, -40, 70)) > 0).all()


def test_a_mapped_tree_stands_where_it_is_mapped_and_keeps_its_genus(planted):
    rows, names = rows_of(planted)
    found = np.flatnonzero(rows.object_id == 41)
    assert len(found) == 1
    assert rows.position[found[0], :2] == pytest.approx([-60.0, -60.0], abs=0.01)
    assert names[found[0]].startswith("tree_birch")


def test_a_wood_has_more_trees_than_a_park_of_its_size(planted):
    xy = planted.scene.instances["trees"].position[:, :2]
    wood = ((xy[:, 0] < -20) & (xy[:, 1] > 30)).sum()
    park = ((xy[:, 0] > 20) & (xy[:, 1] > 30)).sum()
    assert wood > 2 * park > 10


def test_a_row_has_a_tree_every_eight_metres(planted):
    xy = planted.scene.instances["trees"].position[:, :2]
    row = np.sort(xy[np.abs(xy[:, 1] + 80) < 0.1, 0])
    assert np.diff(row).max() < 17.0
    assert len(row) >= 9


def test_the_order_of_rows_changes_nothing(planted, shuffled):
    a, b = planted.scene.instances["trees"], trees(shuffled).scene.instances["trees"]
    for name in ("object_id", "position", "scale", "tint", "rotation"):
        assert np.array_equal(getattr(a, name), getattr(b, name))


def test_ids_are_unique_and_sorted(planted):
    ids = planted.scene.instances["trees"].object_id
    assert (np.diff(ids.astype(object)) > 0).all()


def test_deciduous_trees_are_bare_under_snow(crossroads):
    _, names = rows_of(trees(replace(crossroads, environment=Environment(snow=0.8))))
    limes = [n for n in names if "lime" in n]
    assert limes
    assert all("bare" in n for n in limes)


@pytest.mark.parametrize("season", ["spring", "autumn", "winter"])
def test_the_season_asked_for_is_the_season_shown(crossroads, season):
    _, names = rows_of(trees(crossroads, season=season))
    word = "bare" if season == "winter" else season
    assert all(word in n for n in names if "lime" in n or "oak" in n)


def test_the_season_follows_the_date_and_the_hemisphere(crossroads):
    for day, word in ((15, "bare"), (110, "spring"), (172, "near"), (290, "autumn")):
        _, names = rows_of(
            trees(
                replace(
                    crossroads,
                    environment=Environment(date=f"{DAY + timedelta(days=day - 1):%Y-%m-%d}"),
                )
            )
        )
        assert any("lime" in n and n.endswith(word) for n in names)
    assert season_of(15, Frame(-35.0, 150.0)) == "summer"
    assert season_of(200, Frame(-35.0, 150.0)) == "winter"
    assert {season_of(day, Frame(10.0, 0.0)) for day in range(1, 366)} == {"summer"}


def test_spring_comes_later_in_the_north():
    first = [
        min(d for d in range(1, 366) if season_of(d, Frame(latitude, 10.0)) == "spring")
        for latitude in (36.0, 50.0, 62.0)
    ]
    assert first == sorted(first)
    assert first[0] < first[2] - 30


@pytest.mark.parametrize(
    ("latitude", "longitude", "band"),
    [(35.7, 139.8, "japan"), (1.3, 103.9, "tropic"), (60.2, 24.9, "north"),
     (51.5, -0.1, "temperate"), (41.4, 2.2, "warm"), (-33.9, 151.2, "warm"),
     (40.7, -74.0, "temperate")],
)  # fmt: skip
def test_places_have_their_climate(latitude, longitude, band):
    assert climate_of(Frame(latitude, longitude)) == band


def test_places_have_their_own_trees(crossroads):
    def kinds(latitude, longitude):
        city = replace(crossroads, frame=Frame(latitude, longitude))
        return " ".join(rows_of(trees(city))[1])

    assert "ginkgo" in kinds(35.7, 139.8)
    assert "palm" in kinds(1.3, 103.9)
    assert "spruce" not in kinds(1.3, 103.9)
    assert "jacaranda" in kinds(-26.0, 28.0)
    assert "jacaranda" not in kinds(60.2, 24.9)


def test_crowns_end_before_facades_and_leave_headroom_over_carriageways(crossroads):
    houses = shapely.union_all(crossroads.layout.buildings.geometry.to_numpy())
    rowless = replace(
        crossroads, layout=replace(crossroads.layout, lines=crossroads.layout.lines[:0])
    )
    found = 0
    for seed in range(8):
        rows, names = rows_of(trees(replace(rowless, seed=seed)))
        size = np.array([size_of_name(name) for name in names])
        reach = size[:, 1] * rows.scale[:, :2].max(axis=1)
        facade = shapely.distance(shapely.points(rows.position[:, :2]), houses)
        # Where a wall crowds a crown, its +x side faces it.
        side = np.array([wall_reach(*individual_of(name)) for name in names]) * rows.scale[:, 0]
        assert np.mean(np.minimum(reach, side) > facade + 0.01) < 0.02
        over = (
            size[:, 1] * rows.scale[:, 0]
            > np.abs(rows.position[:, :2]).min(axis=1) - 5.0 + OVERHANG + 0.05
        )
        over &= size[:, 2] > 0
        clear = size[:, 2] * rows.scale[:, 2]
        assert (clear[over] > 4.4).all()
        found += over.sum()
    assert found > 5


def size_of_name(name):
    return size_of(*individual_of(name))


def individual_of(name):
    parts = name.removeprefix("tree_").split("_")
    return parts[0], int(parts[1])


def test_a_crown_beside_a_wall_stays_wide_along_it():
    size = np.array([[*size_of("lime", WALLED), wall_reach("lime", WALLED)]])
    house = shapely.box(1.6, -20.0, 12.0, 20.0)
    table = make_table("buildings", [house], id=[1], levels=[4])
    city = City("wall", Frame(52.5, 13.4), Layout((-30.0, -30.0, 30.0, 30.0), buildings=table))
    room = Room(np.array([1.6]), np.array([0.8]), np.array([np.inf]))
    wished = np.array([[1.0, 1.0, 1.0, 0.3]])
    yes = np.ones(1, bool)
    scale, yaw = fitted_crowns(city, np.zeros((1, 2)), wished, size, room, fixed=yes, crowded=yes)
    assert yaw[0] == pytest.approx(0.0, abs=1e-6)
    assert scale[0, 0] * size[0, 3] < 1.6
    assert scale[0, 0] * size[0, 1] > 2.5  # over the street
    assert scale[0, 1] * size[0, 1] > 3.0  # along the wall
    corner = replace(
        city,
        layout=replace(
            city.layout,
            buildings=make_table(
                "buildings", [house, shapely.box(-9.0, 1.7, 1.6, 12.0)], id=[1, 2], levels=[4, 4]
            ),
        ),
    )
    scale, _ = fitted_crowns(corner, np.zeros((1, 2)), wished, size, room, fixed=yes, crowded=yes)
    assert (scale[0, :2] * size[0, 1] < 1.6).all()


def test_unmapped_trees_keep_clear_of_lamps_walls_and_sight_lines(planted):
    rows = planted.scene.instances["trees"]
    xy = rows.position[rows.object_id != 41, :2]
    houses = shapely.union_all(planted.layout.buildings.geometry.to_numpy())
    row = np.abs(xy[:, 1] + 80) < 0.5  # the tree row is mapped
    spots = shapely.points(xy[~row])
    assert (shapely.distance(spots, houses) > 2.5).all()
    assert (np.hypot(*(xy[~row] - [30.0, 30.0]).T) > 6.0).all()
    assert (np.hypot(*xy[~row].T) > 13.0).all()


def test_neighbours_in_a_street_are_other_individuals(crossroads):
    city = replace(crossroads, layout=replace(crossroads.layout, lines=crossroads.layout.lines[:0],
                   areas=crossroads.layout.areas[:0]), seed=3)  # fmt: skip
    seen = 0
    for seed in range(8):
        made = trees(replace(city, seed=seed)).scene.instances.get("trees")
        if made is None or made.count < 8:
            continue
        seen += 1
        near = np.hypot(*(made.position[:, :2] - [50.0, 0.0]).T) < 50.0
        assert len(np.unique(made.prototype[near])) >= min(STREET_FORMS, near.sum())
    assert seen


def test_the_lowest_detail_has_no_trees_and_the_next_has_light_ones(crossroads):
    assert "trees" not in trees(replace(crossroads, lod=0)).scene.instances
    _, names = rows_of(trees(replace(crossroads, lod=1)))
    assert all("near" not in n for n in names)


def test_a_budget_widens_woods_instead_of_overrunning(crossroads):
    few = trees(crossroads, budget=40, street_trees=False).scene.instances["trees"].count
    assert few < 150


def test_tags_that_are_no_json_name_no_species():
    assert species_of_tags("{broken") == ""
    assert species_of_tags('{"species": "Quercus robur"}') == "oak"
    assert species_of_tags('{"leaf_type": "needleleaved"}') == "spruce"


def test_a_place_where_no_tree_fits_gets_none(crossroads):
    layout = crossroads.layout
    inside = [layout.buildings.geometry.iloc[0].centroid]
    bare = replace(layout, areas=layout.areas[:0], lines=layout.lines[:0],
                   points=make_table("points", inside, id=[9], kind=["tree"]),
                   roads=layout.roads.assign(kind="motorway"))  # fmt: skip
    tall = replace(crossroads, layout=bare, network=None, ground=None, scene=Scene())
    assert sum(rows.count for rows in trees(tall).scene.instances.values()) == 0


@pytest.mark.parametrize("least", [30, 150])
def test_there_are_at_least_so_many_trees(crossroads, least):
    bare = replace(crossroads, layout=replace(crossroads.layout, areas=crossroads.layout.areas[:0]))
    planted = trees(bare, least=least)
    rows = planted.scene.instances["trees"]
    assert len(rows.object_id) >= least
    found = measure(planted.goals[-1].predicate, planted)
    assert found.met, found.evidence
    houses = planted.layout.buildings.geometry.to_numpy()
    spots = shapely.points(rows.position[:, :2])
    assert not shapely.intersects(shapely.union_all(houses), spots).any()


@pytest.mark.parametrize("most", [0, 5])
def test_there_are_at_most_so_many_trees(crossroads, most):
    planted = trees(crossroads, most=most)
    rows = planted.scene.instances.get("trees")
    assert (len(rows.object_id) if rows else 0) == most
    assert measure(planted.goals[-1].predicate, planted).met


def test_more_trees_than_find_room_are_refused(crossroads):
    with pytest.raises(ActionFailed, match=r"There is room for \d+ trees, 90000 are asked for"):
        trees(crossroads, least=90_000)
    with pytest.raises(UsageError, match="least = 9 trees are more than most = 3"):
        trees(crossroads, least=9, most=3)


def test_a_crown_ends_before_the_wall_that_its_trunk_nearly_touches():
    room = Room(np.array([0.7]), np.array([np.inf]), np.array([np.inf]))
    size = np.array([[14.0, 5.8, 2.0, 5.8]])
    up, wide = fitted(np.ones(1), np.ones(1), size, room, fixed=np.zeros(1, bool))
    assert wide * 5.8 < 0.7
    assert up < 2.5 * wide


def test_no_unmapped_tree_grows_into_wires_or_beside_what_lands_and_turns(crossroads):
    xmin, ymin, xmax, ymax = crossroads.layout.extent
    grid = np.stack(np.meshgrid(np.arange(xmin, xmax, 5.0), np.arange(ymin, ymax, 5.0)), -1)
    grid = grid.reshape(-1, 2)
    wire = shapely.LineString([(xmin, ymin + 20.0), (xmax, ymin + 30.0)])
    spots = shapely.points([(xmin + 30.0, ymax - 30.0), (xmax - 30.0, ymax - 30.0)])
    lines = make_table("lines", [wire], id=[1], kind=["power_line"])
    points = make_table("points", spots, id=[2, 3], kind=["helipad", "wind_turbine"])
    layout = replace(crossroads.layout, lines=lines, points=points)
    city = replace(crossroads, layout=layout)
    nobody = np.zeros((0, 2))
    _, free, _ = room_of(city, grid, np.zeros(len(grid), bool), nobody)
    _, mapped, _ = room_of(city, grid, np.ones(len(grid), bool), nobody)
    at = shapely.points(grid)
    near = shapely.dwithin(at, wire, 7.5) | shapely.dwithin(at[:, None], spots, 11.5).any(axis=1)
    assert mapped[near].any()
    assert not free[near].any()
    assert free[~near].any()


def test_the_form_of_a_tree_hangs_on_what_is_near_it_alone(crossroads):
    rows = [(x, y) for x in range(-2000, 2000, 20) for y in range(100, 1100, 20)]
    ids = np.arange(1, len(rows) + 1, dtype=np.uint64)
    wood = stand_of(Points(np.array(rows, float), ids), 0, light=True)
    every, few = (
        forms_of(crossroads, wood),
        forms_of(crossroads, take_trees(wood, slice(0, None, 7))),
    )
    assert (every[::7] == few).all()
    assert set(every) == {"near", "light"}
    assert (every[wood.xy[:, 1] > 200] == "light").all()


def test_thickets_lie_the_same_in_every_window():
    xy = np.random.default_rng(2).uniform(-400, 400, (4000, 2))
    dense = _thickets(xy, 0.3, 5)
    inner = np.abs(xy).max(axis=1) < 100
    assert (_thickets(xy[inner], 0.3, 5) == dense[inner]).all()
    assert dense.mean() == pytest.approx(0.3, abs=0.06)
