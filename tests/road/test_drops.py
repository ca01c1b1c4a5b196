from dataclasses import replace

import numpy as np
import pytest
import shapely

from cityx.city.frame import Frame
from cityx.city.ground import DROPPED, KERB_HEIGHT, KERB_WIDTH, LABEL
from cityx.ground.arrangement import face_areas
from cityx.ground.drape import ramp_heights
from cityx.ground.standing import stand_on
from cityx.road.ground.ground_surface import ground
from cityx.road.network.lane_graph import lanes
from cityx.road.network.network import network

CROSS = [([(-90, 0), (0, 0), (90, 0)], {"kind": "secondary", "width": 8.0, "sidewalk_left": 3.0,
                                        "sidewalk_right": 3.0}),
         ([(0, -90), (0, 0), (0, 90)], {})]  # fmt: skip
SIGNAL = [((1.0, 1.0), "traffic_signals")]
HOUSES = [(x, y, x + 50, y + 50) for x in (-70, 20) for y in (-70, 20)]


@pytest.fixture
def city(layout_of, city_of):
    layout = layout_of(CROSS, houses=HOUSES, points=SIGNAL)
    return ground(lanes(network(city_of(layout))))


def corners_of(city, name):
    found = city.ground
    return np.unique(found.triangles[found.face_label[found.triangle_face] == LABEL[name]])


def test_every_crossing_has_a_dropped_kerb_on_both_sides(city):
    found = city.ground
    area = np.bincount(found.face_label, face_areas(found), minlength=len(LABEL))
    crossings = int(city.network.crossing.sum())
    assert crossings == 4
    # Two wide crossings of 4 m and two of 3 m, 0.2 m more at both ends, 0.15 m of kerb.
    wanted = 2 * 2 * 0.15 * (4.4 + 3.4)
    assert area[LABEL["kerb_dropped"]] == pytest.approx(wanted, rel=0.05)
    assert area[LABEL["tactile_pale"]] == pytest.approx(2 * 2 * 0.6 * 4.4, rel=0.05)
    # A ramp goes round the ribs on three sides, and a stone of the kerb slopes at both ends.
    wide = (4.4 + 2.4) * (0.6 + 1.2) - 4.4 * 0.6
    narrow = (3.4 + 2.4) * 1.2
    assert area[LABEL["ramp"]] == pytest.approx(2 * 2 * (wide + narrow + 4 * 1.2 * 0.15), rel=0.05)


def test_a_ramp_rises_by_one_in_twelve_from_the_dropped_kerb_to_the_walk(city):
    rise = ramp_heights(city.ground)
    own = corners_of(city, "ramp")
    assert rise[own].min() == pytest.approx(DROPPED)
    assert rise[own].max() == pytest.approx(KERB_HEIGHT)
    low, high = own[rise[own] < 0.021], own[rise[own] > 0.119]
    gap = np.hypot(*(city.ground.vertices[high][:, None] - city.ground.vertices[low]).T).min(axis=0)
    assert gap.min() == pytest.approx(12 * (KERB_HEIGHT - DROPPED), abs=0.02)


def test_walks_fall_to_a_crossing_along_the_kerb_without_a_step(city):
    mesh = city.scene.meshes["ground"]
    x = np.arange(9.0, 25.0, 0.05)
    for y in (4.0 + KERB_WIDTH / 2, 4.0 + KERB_WIDTH + 0.3):
        z = stand_on(mesh, np.column_stack([x, y + 0 * x])).z
        assert z.min() == pytest.approx(DROPPED, abs=0.002)
        assert z.max() == pytest.approx(KERB_HEIGHT, abs=0.002)
        assert np.abs(np.diff(z)).max() < 0.05 / 12 + 0.002


@pytest.mark.parametrize(
    ("before", "turned"), [(11.0, 3.0), (11.0, 6.0), (13.0, 6.0), (12.0, 10.0)]
)
def test_no_raised_kerb_is_left_before_a_dropped_one_where_a_street_bends(
    layout_of, city_of, before, turned
):
    fall = np.sin(np.radians(turned)) * 80.0
    bent = [(-80.0 - before, -fall), (-before, 0), (0, 0), (90, 0)]
    layout = layout_of([(bent, CROSS[0][1]), CROSS[1]], houses=HOUSES, points=SIGNAL)
    found = ground(lanes(network(city_of(layout)))).ground
    raised, dropped = (
        shapely.union_all(shapely.polygons(found.vertices[found.triangles_of(name)]))
        for name in ("kerb", "kerb_dropped")
    )
    stones = [part for part in shapely.get_parts(dropped) if part.centroid.x < -6.0]
    assert len(stones) == 2
    for part in stones:
        assert part.area == pytest.approx(4.4 * KERB_WIDTH, rel=0.2)
        assert part.buffer(0.02).intersection(raised).area < 0.02 * 2 * KERB_WIDTH


def test_the_ground_has_no_gap_where_kerbs_are_dropped(city):
    mesh = city.scene.meshes["ground"]
    corners = np.round(mesh.vertices * 1e4).astype(np.int64)
    index = np.unique(corners, axis=0, return_inverse=True)[1]
    faces = index[np.maximum(mesh.faces, 0)]
    quad = mesh.faces[:, 3] >= 0
    pairs = [np.column_stack([faces[:, a], faces[:, b]]) for a, b in ((0, 1), (1, 2))]
    pairs.append(np.column_stack([faces[:, 2], np.where(quad, faces[:, 3], faces[:, 0])]))
    pairs.append(np.column_stack([faces[:, 3], faces[:, 0]])[quad])
    edges = np.concatenate(pairs)
    edges = edges[edges[:, 0] != edges[:, 1]]
    there = {tuple(edge) for edge in edges.tolist()}
    open_edges = np.array([e for e in there if (e[1], e[0]) not in there])
    ends = mesh.vertices[np.unique(index, return_index=True)[1]][open_edges][..., :2]
    # Upright edges meet others of several steps: they cover each other without sharing ends.
    where = ends[np.hypot(*(ends[:, 1] - ends[:, 0]).T) > 0.001].mean(axis=1)
    # Beside houses and at the border of the site the ground ends; nowhere else.
    near_house = (np.abs(where) > 19.9).all(axis=1)
    inside = (np.abs(where) < 99.9).all(axis=1)
    assert not (inside & ~near_house).any()


def test_walks_fall_to_a_drive_from_both_sides_without_a_step(layout_of, city_of):
    drive = {"kind": "service", "width": 3.0, "sidewalk_left": 0.0, "sidewalk_right": 0.0}
    streets = [CROSS[0], ([(0, 0), (0, 60)], drive)]
    city = ground(lanes(network(city_of(layout_of(streets, houses=HOUSES)))))
    x = np.arange(0.0, 12.0, 0.05)
    mesh = city.scene.meshes["ground"]
    z = stand_on(mesh, np.column_stack([x, 4.0 + 1.3 + 0 * x])).z
    assert z.max() == pytest.approx(KERB_HEIGHT, abs=0.002)
    walk = z[z > 0.01]
    assert len(walk) < len(z)
    assert np.abs(np.diff(walk)).max() < 0.05 / 12 + 0.01


@pytest.mark.parametrize("far", [(0, 60), (45, 60), (-45, 60)])
def test_the_kerb_of_a_drive_at_a_slant_is_lowered_across_the_whole_walk(layout_of, city_of, far):
    drive = {"kind": "service", "width": 3.0, "sidewalk_left": 0.0, "sidewalk_right": 0.0}
    streets = [CROSS[0], ([(0, 0), far], drive)]
    city = ground(lanes(network(city_of(layout_of(streets)))))
    mesh = city.scene.meshes["ground"]
    x = np.arange(-14.0, 18.0, 0.02)
    for back in (0.6, 1.3, 2.0, 2.6):  # metres behind the kerb of the street
        z = stand_on(mesh, np.column_stack([x, 4.0 + KERB_WIDTH + back + 0 * x])).z
        assert np.abs(np.diff(z)).max() < DROPPED + 0.012


MAIN = {"kind": "secondary", "width": 8.0, "sidewalk_left": 4.0, "sidewalk_right": 4.0}
SIDE = {"width": 6.0, "sidewalk_left": 4.0, "sidewalk_right": 4.0}
TEE = [([(-90, 0), (0, 0), (90, 0)], MAIN), ([(0, 0), (0, 60)], SIDE)]
LONDON, BERLIN, NEW_YORK, TOKYO = (
    Frame(*place) for place in ((51.51, -0.13), (52.5, 13.4), (40.7, -74.0), (35.69, 139.78))
)


def built(layout, city_of, frame):
    city = replace(city_of(layout), frame=frame)
    return ground(lanes(network(city, drive_on="right")))


def shape_of(city, name):
    found = city.ground
    return shapely.union_all(shapely.polygons(found.vertices[found.triangles_of(name)]))


@pytest.mark.parametrize(
    ("frame", "ruled", "plain"),
    [(LONDON, "tactile_red", "tactile_buff"), (BERLIN, "tactile_pale", ""),
     (NEW_YORK, "tactile", "tactile")],
)  # fmt: skip
def test_mouths_of_side_streets_are_lowered_and_ribbed_as_usual(
    layout_of, city_of, frame, ruled, plain
):
    mouth = built(layout_of(TEE, houses=[(30, 70, 50, 90)]), city_of, frame)
    dropped = shapely.get_parts(shape_of(mouth, "kerb_dropped"))
    assert sorted(np.sign(each.centroid.x) for each in dropped) == [-1, 1]
    # The main road's kerbs, which run on, keep their height.
    assert all(each.bounds[1] > 4.0 for each in dropped)
    for name in ("tactile", "tactile_pale", "tactile_buff", "tactile_red"):
        assert shape_of(mouth, name).is_empty == (name != plain), name
    crossed = built(layout_of(TEE, houses=HOUSES, points=SIGNAL), city_of, frame)
    assert not shape_of(crossed, ruled).is_empty


@pytest.mark.parametrize(("frame", "name"), [(LONDON, "tactile_buff"), (TOKYO, "tactile")])
def test_ribs_lie_in_a_straight_row_where_the_kerb_curves(layout_of, city_of, frame, name):
    crossing = [((0, 7.0), "crossing")]
    city = built(layout_of(TEE, points=crossing), city_of, frame)
    rows = shapely.get_parts(shape_of(city, name))
    assert len(rows) == 2
    for row in rows:
        x = np.abs(shapely.get_coordinates(row))
        back = x[x[:, 0] > x[:, 0].max() - 0.01]
        # Its back is one line square to the way across, as long as the crossing is wide.
        assert np.ptp(back[:, 1]) == pytest.approx(3.4, abs=0.05)
        assert 3.0 + KERB_WIDTH + 0.6 < x[:, 0].max() < 3.0 + KERB_WIDTH + 0.8 + 1.25
    if name == "tactile":  # the walk before a row that begins behind the kerb is lowered as well
        rise = city.scene.meshes["ground"]
        middle = shapely.get_coordinates(shapely.point_on_surface(
            shapely.get_parts(shape_of(city, "landing"))))  # fmt: skip
        assert len(middle)
        assert stand_on(rise, middle).z == pytest.approx(DROPPED, abs=0.002)


def test_kerbs_are_lowered_where_the_map_draws_them(layout_of, city_of):
    drawn = [((-90, -7, 90, 7), "road_area")]
    streets = [([(-90, 0), (90, 0)], MAIN)]
    city = built(layout_of(streets, areas=drawn, points=[((0, 0), "crossing")]), city_of, BERLIN)
    dropped = shapely.get_parts(shape_of(city, "kerb_dropped"))
    assert len(dropped) == 2
    assert [np.abs(each.centroid.y) for each in dropped] == pytest.approx([7.075, 7.075], abs=0.01)


@pytest.mark.parametrize(("frame", "width"), [(LONDON, 1.2), (BERLIN, 0.6), (NEW_YORK, 0.0)])
def test_a_strip_across_the_walk_leads_to_crossings_with_paint(layout_of, city_of, frame, width):
    signals = [*SIGNAL, ((30.0, 0.0), "crossing")]
    city = built(layout_of(CROSS, houses=HOUSES, points=signals), city_of, frame)
    strip = shape_of(city, "guide_strip")
    assert strip.is_empty == (width == 0)
    if width:
        parts = [each for each in shapely.get_parts(strip) if each.centroid.y > 4.0]
        # On the right of those who cross the western arm southwards, from the ribs to the houses.
        (west,) = [each for each in parts if each.centroid.x < -8.0]
        assert np.ptp(shapely.get_coordinates(west)[:, 0]) == pytest.approx(width, abs=0.02)
        y = np.arange(west.bounds[1] + 0.02, west.bounds[3], 0.05)
        spots = np.column_stack([np.full(len(y), west.centroid.x), y])
        z = stand_on(city.scene.meshes["ground"], spots).z
        assert (z[0], z[-1]) == pytest.approx((DROPPED, KERB_HEIGHT), abs=0.004)
        assert np.diff(z).max() < 0.05 / 12 + 0.002
        beside = stand_on(city.scene.meshes["ground"], spots + np.array([width / 2 + 0.05, 0.0])).z
        assert beside == pytest.approx(z, abs=0.006)
