"""Things that hug the walls of narrow walks."""

from dataclasses import replace

import numpy as np
import pytest
import shapely

from cityx.assets.furniture.wall_pieces import GAPS, HALVES, ROOMLESS, WALL_MAKERS
from cityx.city import Frame, make_table
from cityx.city.thing_outlines import placed_outlines
from cityx.ground.pieces import walk_rims
from cityx.ground.walking.passage import crowding, in_lanes
from cityx.nature.furniture.street_pieces import LAYER, street_pieces
from cityx.nature.furniture.wall_things import along_walls
from cityx.road.ground.ground_surface import ground
from cityx.road.network.lane_graph import lanes

WALK = 1.7
BEHIND = 5.0 + 0.15 + 0.1  # metres from the middle of a street to its houses, less the walk


def lane(crossroads, latitude=35.69, longitude=139.78, *, walk=WALK):
    """The crossroads with narrow walks and a house at the back of each."""
    roads = crossroads.layout.roads.assign(sidewalk_left=walk, sidewalk_right=walk)
    near = BEHIND + walk
    corners = [(x, y) for x in (-60 - near, near) for y in (-60 - near, near)]
    walls = [shapely.box(x, y, x + 60, y + 60) for x, y in corners]
    ids = np.arange(21, 25)
    houses = make_table("buildings", walls, id=ids, place=["core"] * 4)
    parts = make_table("parts", walls, id=ids, building=ids, base=[0.0] * 4, top=[9.0] * 4,
                       walls=[True] * 4)  # fmt: skip
    layout = replace(crossroads.layout, roads=roads, buildings=houses, parts=parts,
                     areas=crossroads.layout.areas[:0], points=crossroads.layout.points[:0],
                     lines=crossroads.layout.lines[:0])  # fmt: skip
    city = replace(crossroads, frame=Frame(latitude, longitude), layout=layout,
                   stages_done=frozenset({"layout", "terrain"}))  # fmt: skip
    return ground(lanes(city))


@pytest.fixture(scope="module")
def narrow(crossroads):
    return lane(crossroads)


@pytest.fixture(scope="module")
def drawn(narrow):
    return along_walls(narrow, walk_rims(narrow.ground), 1.0)


def test_things_touch_the_walls_of_houses(narrow, drawn):
    assert len(drawn) > 30
    houses = shapely.multipolygons(list(narrow.layout.buildings.geometry))
    away = shapely.distance(houses, shapely.points(drawn.xy))
    for name in GAPS:
        assert np.allclose(away[drawn.name == name], GAPS[name], atol=1e-6)


def test_all_of_them_are_used_and_the_same_each_time(narrow, drawn):
    again = along_walls(narrow, walk_rims(narrow.ground), 1.0)
    assert drawn.xy.tobytes() == again.xy.tobytes()
    assert drawn.name.tolist() == again.name.tolist()
    assert set(WALL_MAKERS) - set(ROOMLESS) <= set(drawn.name)


def test_more_density_gives_more_and_none_gives_nothing(narrow, drawn):
    rims = walk_rims(narrow.ground)
    assert len(along_walls(narrow, rims, 2.0)) > len(drawn)
    assert not len(along_walls(narrow, rims, 0.0))


def test_they_leave_a_way_on_narrow_walks_and_lanes_alone(narrow):
    city = street_pieces(narrow)
    rows = city.scene.instances[LAYER]
    names = np.array([p.name for p in city.scene.prototypes])[rows.prototype]
    assert np.isin(names, list(WALL_MAKERS)).sum() > 10
    outlines, xy, _ = placed_outlines(city.scene)
    assert not crowding(city, outlines, xy)[1].any()
    assert not in_lanes(city, outlines, xy).any()


def test_where_nobody_could_pass_things_hang_over_heads_or_lie_in_the_walk(crossroads):
    city = lane(crossroads, walk=0.8)
    found = along_walls(city, walk_rims(city.ground), 1.0)
    assert set(found.name) == set(ROOMLESS)
    low = np.concatenate([part.vertices for part in WALL_MAKERS["hanging_basket"]()])[:, 2].min()
    assert low > 2.0


def test_none_stand_in_europe(crossroads):
    city = street_pieces(lane(crossroads, 52.5, 13.4))
    assert not {p.name for p in city.scene.prototypes} & set(WALL_MAKERS)


@pytest.mark.parametrize("name", WALL_MAKERS)
def test_each_is_as_slim_as_its_gap_tells(name):
    points = np.concatenate([part.vertices for part in WALL_MAKERS[name]()])
    assert np.abs(points[:, 1]).max() <= GAPS[name] + 0.02
    assert np.abs(points[:, 0]).max() <= HALVES[name] + 0.05  # leaves
    assert np.ptp(points[:, 1]) <= 0.4
