import numpy as np
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from cityx.building.facade import grammar as facades
from cityx.building.facade.frontage import frontage_of
from cityx.building.facade.grammar import Fronts, bays_of, lay_out, storeys_of
from cityx.building.facade.wall_faces import wall_faces
from cityx.building.facade.walls import party_spans, wall_table


def box_walls(width=20.0, depth=12.0, height=16.0, neighbours=()):
    shapes = np.array([shapely.box(0, 0, width, depth), *neighbours], object)
    low, high = np.zeros(len(shapes)), np.full(len(shapes), height)
    return party_spans(wall_table(shapes, low, high), shapes, low, high)


def fronts(walls, **given):
    n = walls.count
    values = {
        "building": walls.part.astype(np.uint64) + np.uint64(7),
        "mode": np.full(n, facades.PUNCHED), "levels": np.full(n, 5), "foot": walls.z_low,
        "grounded": np.ones(n, bool), "street": np.ones(n, bool), "shop": np.zeros(n, bool),
        "balcony": np.zeros(n, bool), "free": np.full(n, 20.0),
        "screened": np.full(n, -np.inf), "bay": np.full(n, 2.5),
        "width": np.full(n, 1.1), "height": np.full(n, 1.7), "sill": np.full(n, 0.9),
        "ground_storey": np.full(n, 3.5), "corner": np.full(n, 0.5), "door": np.zeros(n, bool),
        "door_along": np.full(n, np.nan), "door_width": np.full(n, 1.5),
        "door_height": np.full(n, 2.6),
    }  # fmt: skip
    values.update({key: np.broadcast_to(value, n) for key, value in given.items()})
    values["pavement"] = np.repeat(values.pop("foot")[:, None], 3, axis=1)
    return Fronts(**values)


def test_a_wall_of_five_storeys_gets_a_regular_grid():
    walls = box_walls()
    found = lay_out(walls, fronts(walls), 0)
    front = found.take(found.wall == np.argmax(walls.length))
    assert front.count == 5 * 8  # (20 - 2 * 0.5) / 2.5 rounds to 8 bays
    along = np.unique(np.round(front.along, 6))
    assert np.allclose(along + along[::-1], 20.0)  # symmetric
    assert np.allclose(np.diff(along), np.diff(along)[0])


@settings(max_examples=25, deadline=None, derandomize=True)
@given(
    st.floats(1.3, 60), st.floats(1.3, 40), st.floats(2.4, 90), st.integers(0, 40),
    st.sampled_from(range(6)), st.booleans(), st.booleans(), st.floats(0.0, 5.0),
)  # fmt: skip
def test_openings_stay_within_their_walls(width, depth, height, levels, mode, shop, balcony, foot):
    walls = box_walls(width, depth, height)
    facts = fronts(
        walls, mode=mode, levels=levels, shop=shop, balcony=balcony,
        foot=np.minimum(foot, height), door=np.arange(walls.count) == 0,
    )  # fmt: skip
    found = lay_out(walls, facts, 0)
    half = found.width / 2
    assert (found.along - half > 0.1).all()
    assert (found.along + half < walls.length[found.wall] - 0.1).all()
    assert (found.low >= facts.foot[found.wall] - 1e-9).all()
    assert (found.low + found.height < walls.z_high[found.wall]).all()
    _assert_apart(found)


def _assert_apart(found):
    for wall in np.unique(found.wall):
        one = found.take(found.wall == wall)
        left, right = one.along - one.width / 2, one.along + one.width / 2
        top = one.low + one.height
        for i in range(one.count):
            over = (left < right[i] - 1e-6) & (right > left[i] + 1e-6)
            over &= (one.low < top[i] - 1e-6) & (top > one.low[i] + 1e-6)
            assert over.sum() == 1


def test_party_walls_stay_blind_up_to_the_neighbour():
    walls = box_walls(neighbours=(shapely.box(20, 0, 30, 12),))
    blind = walls.blind_to > walls.z_low + 0.1
    assert blind.any()
    found = lay_out(walls, fronts(walls), 0)
    assert not blind[found.wall].any()


def test_a_low_neighbour_leaves_the_upper_windows():
    shapes = np.array([shapely.box(0, 0, 20, 12), shapely.box(20, 0, 30, 12)], object)
    low, high = np.zeros(2), np.array([16.0, 6.0])
    walls = party_spans(wall_table(shapes, low, high), shapes, low, high)
    found = lay_out(walls, fronts(walls), 0)
    wall = np.flatnonzero((walls.blind_to > 0.1) & (walls.part == 0))
    above = found.take(np.isin(found.wall, wall))
    assert above.count > 0
    assert (above.low > 6.0).all()


def test_the_door_takes_its_place_among_shops():
    walls = box_walls()
    longest = np.argmax(walls.length)
    facts = fronts(walls, shop=True, door=np.arange(walls.count) == longest)
    found = lay_out(walls, facts, 0)
    front = found.take(found.wall == longest)
    assert (front.role == facades.DOOR).sum() == 1
    assert (front.role == facades.SHOP).sum() == 4
    assert not (front.role == facades.GROUND).any()
    _assert_apart(front)


def test_a_mapped_entrance_decides_where_the_door_is():
    walls = box_walls()
    facts = fronts(walls, door=np.arange(walls.count) == 0, door_along=4.25)
    found = lay_out(walls, facts, 0)
    assert np.isclose(found.along[found.role == facades.DOOR], 4.25)


def test_storeys_fill_the_wall():
    walls = box_walls(height=17.0)
    storeys = storeys_of(walls, fronts(walls))
    assert np.allclose(storeys.ground + (storeys.count - 1) * storeys.upper, 17.0)
    assert (storeys.ground >= 3.4).all()


def test_levels_that_do_not_fit_the_height_are_corrected():
    walls = box_walls(height=30.0)
    assert (storeys_of(walls, fronts(walls, levels=1)).count == 9).all()
    assert (storeys_of(walls, fronts(walls, levels=100)).count == 9).all()


def test_short_walls_have_no_bays():
    walls = box_walls(1.1, 12.0)
    count = bays_of(walls, fronts(walls))[0]
    assert (count[walls.length < 1.2] == 0).all()
    assert (count[walls.length > 1.2] > 0).all()


def test_a_turned_building_has_the_same_openings():
    shape = shapely.box(0, 0, 20, 12)
    turned = shapely.affinity.rotate(shape, 37, origin=(0, 0))
    tables = []
    for each in (shape, turned):
        one = np.array([each], object)
        walls = wall_table(one, np.zeros(1), np.full(1, 16.0))
        tables.append(lay_out(walls, fronts(walls), 0))
    assert np.allclose(tables[0].along, tables[1].along, atol=1e-6)
    assert np.allclose(tables[0].low, tables[1].low)


def test_a_street_behind_another_house_is_not_faced():
    shapes = np.array([shapely.box(0, 0, 10, 10), shapely.box(0, -9, 10, -4)], object)
    low, high = np.zeros(2), np.full(2, 9.0)
    walls = wall_table(shapes, low, high)
    road = np.array([shapely.LineString([(-50, -14), (50, -14)])], object)
    found = frontage_of(walls, road, shapes, low, high)
    south = np.flatnonzero(walls.normal[:, 1] < -0.9)
    assert found.street[south[walls.part[south] == 0]] == -1
    assert found.street[south[walls.part[south] == 1]] == 0
    assert np.isclose(found.free[south[walls.part[south] == 0]], 4.0)


def test_faces_follow_points_that_straight_walls_leave_out():
    bulge = shapely.Polygon([(0, 0), (5, -0.1), (10, 0), (10, 8), (0, 8)])
    one = np.array([bulge], object)
    walls = wall_table(one, np.zeros(1), np.ones(1))
    south = np.flatnonzero(walls.normal[:, 1] < -0.9)
    assert len(south) == 1
    faces = wall_faces(one)
    out = faces.before(walls, np.repeat(south, 3), [0.0, 2.5, 5.0])
    assert np.allclose(out, [0.0, 0.05, 0.1])
    _, begin, finish = faces.pieces(walls, south)
    assert np.allclose(begin, [0.0, 5.0])
    assert np.allclose(finish, [5.0, 10.0])
