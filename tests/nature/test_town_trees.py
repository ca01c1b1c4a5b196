"""Trees that no map shows, along streets and in yards."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
import shapely

from cityx.assets.furniture.tree_pits import TREE_STRIP
from cityx.city import Frame, make_table
from cityx.city.thing_outlines import placed_outlines
from cityx.ground.pieces import room_along, walk_rims
from cityx.ground.standing import WALKED
from cityx.ground.walking.passage import FREE, crowding, in_lanes
from cityx.nature.trees.planting import _in_company, trees
from cityx.nature.trees.stands import BUSHES, INDEX, join_stands, take_trees
from cityx.nature.trees.town_trees import (
    CLIPPED_SPREAD,
    FOR_THREE,
    FROM_EDGE,
    LEAST_WALK,
    MAPPED_WITHIN,
    OF_STREET,
    SMALL_HEIGHT,
    TRUNK_WAY,
    VERGE,
    VERGES,
    YARD_SHARES,
    along_streets,
    in_yards,
    roundabout_stands,
)
from cityx.nature.trees.tree_room import room_of
from cityx.road.ground.ground_surface import ground
from cityx.road.network.lane_graph import lanes
from cityx.road.network.network import network
from cityx.road.surface.roundabouts import islands_of, ring_edges

NOBODY = np.zeros((0, 2))
YARDS = [(x, y) for x in (-94, 12) for y in (-94, 12)]
NOTHING = np.zeros((0, 2))
SMALL, LARGE = 11.0, 20.0  # metres of radius of the middle of the carriageway


def laid(city):
    return ground(lanes(replace(city, stages_done=frozenset({"layout", "terrain"}))))


@pytest.fixture(scope="module")
def avenue(crossroads):
    """The crossroads of a town, with walks of 5 m and no area or tree."""
    roads = crossroads.layout.roads.assign(sidewalk_left=5.0, sidewalk_right=5.0, kind="primary")
    buildings = crossroads.layout.buildings.assign(place="core")
    layout = replace(crossroads.layout, roads=roads, buildings=buildings,
                     areas=crossroads.layout.areas[:0], points=crossroads.layout.points[:0],
                     lines=crossroads.layout.lines[:0])  # fmt: skip
    return laid(replace(crossroads, layout=layout))


@pytest.fixture(scope="module")
def courts(avenue):
    """Four blocks of houses about courts of 56 m."""
    wings = [shapely.box(x, y, x + 82, y + 82) for x, y in YARDS]
    walls = shapely.difference(wings, shapely.buffer(wings, -13, join_style="mitre"))
    ids = np.arange(21, 25)
    houses = make_table("buildings", walls, id=ids, place=["core"] * 4)
    parts = make_table("parts", walls, id=ids, building=ids, base=[0.0] * 4, top=[9.0] * 4,
                       walls=[True] * 4)  # fmt: skip
    return laid(replace(avenue, layout=replace(avenue.layout, buildings=houses, parts=parts)))


def test_trees_of_streets_leave_a_way_past_their_trunks(avenue):
    (stand,) = along_streets(avenue, NOBODY)
    assert len(stand.id) > 20
    out = np.where(np.abs(stand.xy) < 20, np.sign(stand.xy), 0.0)
    out[np.abs(out).sum(axis=1) != 1] = np.nan
    known = np.isfinite(out).all(axis=1)
    room = room_along(stand.xy[known], out[known], walk_rims(avenue.ground), 4.0)
    assert known.sum() > 10
    assert (room >= TRUNK_WAY - 1e-6).all()


@pytest.mark.parametrize("walk", [5.0, 1.5])
def test_no_tree_crowds_a_walk_or_stands_in_a_lane(avenue, walk):
    roads = avenue.layout.roads.assign(sidewalk_left=walk, sidewalk_right=walk)
    city = trees(laid(replace(avenue, layout=replace(avenue.layout, roads=roads))))
    outlines, xy, _ = placed_outlines(city.scene)
    assert not crowding(city, outlines, xy)[1].any()
    assert not in_lanes(city, outlines, xy).any()


@pytest.fixture(scope="module")
def clipped(avenue):
    """The same in Japan, with walks of 2 m, planted."""
    roads = avenue.layout.roads.assign(sidewalk_left=2.0, sidewalk_right=2.0)
    layout = replace(avenue.layout, roads=roads)
    return trees(laid(replace(avenue, frame=Frame(35.69, 139.78), layout=layout)))


def test_clipped_trees_of_japan_stand_at_the_kerb_and_leave_a_way(clipped):
    rows = clipped.scene.instances["trees"]
    xy = rows.position[:, :2]
    row = np.abs(np.abs(xy).min(axis=1) - 5.6) < 0.01  # beside a carriageway of 10 m
    assert row.sum() > 30
    out = np.where(np.abs(xy) < 20, np.sign(xy), 0.0)[row]
    trunks = placed_outlines(clipped.scene, ("trees",))
    half = np.sqrt(shapely.area(trunks[0][np.isin(trunks[2], rows.object_id[row])])) / 2
    room = room_along(xy[row], out, walk_rims(clipped.ground), 4.0)
    assert room.min() - half.max() >= FREE
    assert not in_lanes(clipped, *trunks[:2]).any()


def test_strips_between_clipped_trees_leave_a_way_and_lanes_alone(clipped):
    outlines, xy, ids = placed_outlines(clipped.scene, ("tree_pits",))
    rows = clipped.scene.instances["tree_pits"]
    names = np.array([p.name for p in clipped.scene.prototypes])[rows.prototype]
    strip = np.isin(ids, rows.object_id[names == TREE_STRIP])
    assert strip.sum() > 30
    assert not crowding(clipped, outlines[strip], xy[strip])[1].any()
    assert not in_lanes(clipped, outlines[strip], xy[strip]).any()
    assert clipped.ground.on(xy[strip], "sidewalk", "furnishing").all()


def test_elsewhere_no_strip_is_laid(avenue):
    assert TREE_STRIP not in {p.name for p in trees(avenue).scene.prototypes}


def test_no_narrow_walk_is_planted_but_lawns_beside_the_carriageway(avenue):
    roads = avenue.layout.roads.assign(sidewalk_left=LEAST_WALK - 0.1, sidewalk_right=0.0)
    city = laid(replace(avenue, layout=replace(avenue.layout, roads=roads)))
    (stand,) = along_streets(city, NOBODY)
    assert not city.ground.on(stand.xy, *WALKED).any()
    assert city.ground.on(stand.xy, *VERGES).sum() > 10


def test_where_trees_are_mapped_none_is_planted_beside(avenue):
    mapped = np.array([[60.0, 7.0]])
    before, after = (along_streets(avenue, spots)[0].xy for spots in (NOBODY, mapped))
    gap = np.hypot(*(before - mapped).T)
    assert (gap < MAPPED_WITHIN).any()
    assert len(after) == (gap > MAPPED_WITHIN).sum()


def test_mapped_trees_away_from_a_street_do_not_speak_for_it(avenue):
    before, after = (along_streets(avenue, spots)[0].xy
                     for spots in (NOBODY, np.array([[60.0, 5.0 + OF_STREET + 2.0]])))  # fmt: skip
    assert len(before) == len(after)


def test_a_footway_drawn_along_a_walk_leaves_its_trees_standing(avenue):
    foot = make_table("roads", [shapely.LineString([(12, 7.5), (99, 7.5)])], id=[9],
                      kind=["footway"], width=[2.0])  # fmt: skip
    both = pd.concat([avenue.layout.roads, foot], ignore_index=True)
    city = laid(replace(avenue, layout=replace(avenue.layout, roads=both)))
    rule = along_streets(city, NOBODY)[0]
    nobody = np.zeros(len(rule.id), bool)
    beside = (rule.xy[:, 1] > 0) & (rule.xy[:, 0] > 20) & (rule.xy[:, 1] < 8)
    assert beside.sum() > 4
    kept = [room_of(city, rule.xy, nobody, NOBODY, street)[1][beside] for street in (~nobody, None)]
    assert kept[0].all()
    assert not kept[1].any()


@pytest.mark.parametrize(("facade", "kept_small"), [(8.6, True), (11.0, False)])
def test_trees_between_near_facades_are_kept_small(avenue, facade, kept_small):
    signs = [(x, y) for x in (-1, 1) for y in (-1, 1)]
    boxes = [shapely.box(min(facade * x, 99 * x), min(facade * y, 99 * y),
                         max(facade * x, 99 * x), max(facade * y, 99 * y))
             for x, y in signs]  # fmt: skip
    ids = np.arange(31, 35)
    houses = make_table("buildings", boxes, id=ids, place=["core"] * 4)
    roads = avenue.layout.roads.assign(sidewalk_left=3.0, sidewalk_right=3.0)
    city = laid(replace(avenue, layout=replace(avenue.layout, buildings=houses, roads=roads)))
    (stand,) = along_streets(city, NOBODY)
    assert len(stand.id) > 8
    low, high = SMALL_HEIGHT
    small = (stand.height > low - CLIPPED_SPREAD) & (stand.height < high + CLIPPED_SPREAD)
    assert (small if kept_small else np.isnan(stand.height)).all()


def test_yards_have_trees_on_lawns_and_beds(courts):
    (stand,) = in_yards(courts, NOBODY)
    assert len(stand.id) > 8
    assert courts.ground.on(stand.xy, *YARD_SHARES).all()
    assert in_yards(courts, stand.xy[:1])[0].xy.shape < stand.xy.shape


def test_no_tree_grows_from_the_paving_before_houses(courts):
    (stand,) = in_yards(courts, NOBODY)
    paved = courts.ground.on(stand.xy, "courtyard", "gravel")
    rims = shapely.multilinestrings(list(walk_rims(courts.ground)))
    away = shapely.distance(shapely.points(stand.xy[paved]), rims)
    assert (away >= FROM_EDGE - 1e-6).all()


def test_trees_of_yards_are_the_same_each_time_and_fewer_in_japan(courts):
    first, again = (in_yards(courts, NOBODY)[0] for _ in range(2))
    assert first.xy.tobytes() == again.xy.tobytes()
    assert first.species.tobytes() == again.species.tobytes()
    tokyo = in_yards(replace(courts, frame=Frame(35.69, 139.78)), NOBODY)[0]
    assert set(tokyo.id.tolist()) < set(first.id.tolist())


@pytest.mark.parametrize("mapped", [4.0, 2.6])
def test_a_mapped_tree_in_a_carriageway_moves_to_its_walk_though_a_footway_is_drawn_there(
    avenue, mapped
):
    roads = avenue.layout.roads
    foot = make_table("roads", [shapely.LineString([(12, 7.5), (99, 7.5)])], id=[9],
                      kind=["footway"], width=[2.0])  # fmt: skip
    tree = make_table("points", [shapely.Point(50.0, mapped)], id=[51], kind=["tree"])
    both = pd.concat([roads, foot], ignore_index=True)
    layout = replace(avenue.layout, roads=both, points=tree)
    city = trees(laid(replace(avenue, layout=layout)))
    rows = city.scene.instances["trees"]
    (at,) = np.flatnonzero(rows.object_id == 51)
    x, y = rows.position[at, :2]
    assert abs(x - 50.0) < 1e-6
    assert 5.4 < y < 6.0
    outlines, xy, ids = placed_outlines(city.scene)
    own = ids == 51
    assert not crowding(city, outlines, xy)[1].any()
    assert not in_lanes(city, outlines[own], xy[own]).any()


def test_a_street_has_rows_of_trees_or_none(avenue):
    rule = along_streets(avenue, NOBODY)[0]
    row = np.flatnonzero((rule.xy[:, 0] > 15) & (rule.xy[:, 1] > 0))
    row = row[np.argsort(rule.xy[row, 0])]
    three = take_trees(rule, row[[0, 1, -1]])
    assert _in_company(three).tolist() == [True, True, False]
    assert _in_company(replace(three, mapped=np.ones(3, bool))).all()


def roundabout(crossroads, radius, seed=0, through=False):
    """Lay a ring about the origin with four arms, or with one street that runs through."""
    angles = np.arange(0, 16) * np.pi / 8
    ring = [(radius * np.cos(a), radius * np.sin(a)) for a in angles]
    arms = [[ring[4 * k], (5 * ring[4 * k][0], 5 * ring[4 * k][1])] for k in range(4)]
    if through:
        arms = [[(-90, 0), ring[8], (0.0, 0.0), ring[0], (90, 0)]]
    lines = [shapely.LineString(line) for line in ([*ring, ring[0]], *arms)]
    count, round_about = len(lines), [True] + [False] * len(arms)
    roads = make_table(
        "roads", lines, id=np.arange(1, count + 1), kind=["residential"] * count,
        width=[6.0] * count, lanes=[1] + [2] * len(arms), oneway=round_about,
        roundabout=round_about,
    )  # fmt: skip
    empty = {name: getattr(crossroads.layout, name).iloc[:0]
             for name in ("buildings", "parts", "areas", "lines", "points")}  # fmt: skip
    layout = replace(crossroads.layout, roads=roads, **empty)
    return ground(network(replace(crossroads, layout=layout, seed=seed)))


def is_bush(stand):
    return np.isin(stand.species, [INDEX[name] for name in BUSHES])


@pytest.fixture
def planted(crossroads):
    """Return the first of ten seeds that draws bushes and trees."""
    for seed in range(10):
        city = roundabout(crossroads, LARGE, seed)
        stand = join_stands(roundabout_stands(city, NOTHING))
        if is_bush(stand).any():
            return city, stand
    raise AssertionError("no seed of ten plants bushes")


def test_bushes_leave_a_verge_of_lawn_behind_the_kerb(planted):
    city, stand = planted
    islands = islands_of(city.network, ring_edges(city.layout, city.network))
    reach = float(islands.radius[0] - islands.apron[0] - VERGE)
    assert len(islands.id) == 1
    assert city.ground.on(stand.xy, "grass").all()
    assert np.hypot(*stand.xy.T).max() < reach
    assert is_bush(stand).sum() > 2 * np.pi * reach / 1.5


def test_trees_stand_amid_a_large_island_as_three_of_one_species(planted):
    _, stand = planted
    trees = stand.species[~is_bush(stand)]
    assert LARGE > FOR_THREE
    assert len(trees) == 3
    assert len(set(trees.tolist())) == 1


def test_a_small_island_has_one_tree_at_most(crossroads):
    counts = set()
    for seed in range(8):
        stand = join_stands(roundabout_stands(roundabout(crossroads, SMALL, seed), NOTHING))
        counts.add(int((~is_bush(stand)).sum()))
    assert counts == {0, 1}


def test_what_the_map_has_on_an_island_is_left_alone(planted):
    city, _ = planted
    assert not len(join_stands(roundabout_stands(city, np.array([[1.0, 2.0]]))).id)
    statue = make_table("points", [shapely.Point(2.0, 0.0)], id=[5], kind=["artwork"])
    layout = replace(city.layout, points=statue)
    assert not len(join_stands(roundabout_stands(replace(city, layout=layout), NOTHING)).id)


def test_an_island_that_a_street_runs_through_is_not_planted(crossroads):
    seeds = [roundabout(crossroads, LARGE, seed, through=True) for seed in range(4)]
    assert not any(len(join_stands(roundabout_stands(city, NOTHING)).id) for city in seeds)


def test_the_same_seed_plants_the_same(planted):
    city, stand = planted
    again = join_stands(roundabout_stands(city, NOTHING))
    assert np.array_equal(stand.id, again.id)
    assert np.array_equal(stand.xy, again.xy)
    assert len(set(stand.id.tolist())) == len(stand.id)
