from dataclasses import replace

import numpy as np
import pytest
import shapely

from cityx.city import make_table
from cityx.nature.trees.roundabout_plants import (
    FOR_THREE,
    VERGE,
    roundabout_stands,
)
from cityx.nature.trees.stands import BUSHES, INDEX, join_stands
from cityx.road.ground.ground_surface import ground
from cityx.road.network.network import network
from cityx.road.surface.roundabouts import islands_of, ring_edges

NOTHING = np.zeros((0, 2))
SMALL, LARGE = 11.0, 20.0  # metres of radius of the middle of the carriageway


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
