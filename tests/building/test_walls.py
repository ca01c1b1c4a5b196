import numpy as np
import pytest
import shapely

from cityx.building.facade.walls import party_spans, wall_table


def walls(shapes, heights, bases=None):
    shapes = np.array(shapes, dtype=object)
    high = np.array(heights, float)
    low = np.zeros(len(shapes)) if bases is None else np.array(bases, float)
    return party_spans(wall_table(shapes, low, high), shapes, low, high)


def test_normals_point_out_of_the_building_and_into_the_courtyard():
    yard = shapely.box(0, 0, 10, 10).difference(shapely.box(4, 4, 6, 6))
    table = wall_table(np.array([yard]), np.zeros(1), np.full(1, 3.0))
    middle = (table.start + table.end) / 2
    assert not shapely.contains_xy(yard, *(middle + 0.1 * table.normal).T).any()
    assert shapely.contains_xy(yard, *(middle - 0.1 * table.normal).T).all()


def test_nearly_straight_edges_are_one_wall():
    shape = shapely.Polygon([(0, 0), (5, 0.05), (10, 0), (10, 8), (0, 8)])
    assert wall_table(np.array([shape]), np.zeros(1), np.ones(1)).count == 4


def test_a_lower_neighbour_blinds_a_wall_up_to_its_eave():
    table = walls([shapely.box(0, 0, 10, 8), shapely.box(10.1, 0, 20, 8)], [10, 6])
    east = (table.part == 0) & (table.normal[:, 0] > 0.9)
    assert table.blind_to[east].tolist() == [6.0]
    west = (table.part == 1) & (table.normal[:, 0] < -0.9)
    assert table.blind_to[west].tolist() == [6.0]


def test_a_wall_is_cut_where_its_neighbour_ends():
    table = walls([shapely.box(0, 0, 10, 8), shapely.box(10, 5, 20, 12)], [10, 6])
    east = (table.part == 0) & (table.normal[:, 0] > 0.9)
    assert table.length[east].tolist() == pytest.approx([5, 3])
    assert table.blind_to[east].tolist() == [0.0, 6.0]
    assert table.edge_from[east].tolist() == pytest.approx([0, 5])
    assert len(set(table.edge[east].tolist())) == 1


def test_a_neighbour_half_a_metre_away_leaves_the_wall_open():
    table = walls([shapely.box(0, 0, 10, 8), shapely.box(10.5, 0, 20, 8)], [10, 6])
    assert (table.blind_to == table.z_low).all()


def test_a_bridge_covers_a_wall_from_its_own_foot():
    table = walls([shapely.box(0, 0, 10, 8), shapely.box(10, 0, 20, 8)], [20, 9], [0, 5])
    east = (table.part == 0) & (table.normal[:, 0] > 0.9)
    assert table.blind_to[east].tolist() == [0.0]
    assert table.open_to[east].tolist() == [5.0]


def test_pieces_of_a_wall_add_up_to_it():
    rng = np.random.default_rng(3)
    shapes = [shapely.box(0, 0, 40, 10)]
    shapes += [shapely.box(x, 10, x + rng.uniform(0.2, 5), 15) for x in rng.uniform(0, 36, 12)]
    table = walls(shapes, [12.0, *rng.uniform(3, 14, 12)])
    total = np.bincount(table.edge, table.length)
    whole = np.zeros_like(total)
    whole[table.edge] = table.edge_length
    assert total == pytest.approx(whole)
    assert (table.length > 0.1).all()
