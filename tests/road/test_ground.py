from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import shapely

from cityx.city.ground import KERB_HEIGHT, LABEL, SURFACES
from cityx.city.layout import SCHEMA, make_table
from cityx.city.terrain import Terrain
from cityx.ground.arrangement import check_arrangement, face_areas
from cityx.road.ground.ground_surface import ground, ground_of
from cityx.road.network.network import network

OSM = Path(__file__).parents[3] / "shared" / "data" / "osm"
CROSS = [([(-90, 0), (0, 0), (90, 0)], {"kind": "secondary", "width": 8.0}),
         ([(0, -90), (0, 0), (0, 90)], {})]  # fmt: skip
HOUSES = [(x, y, x + 50, y + 50) for x in (-70, 20) for y in (-70, 20)]


def areas(found):
    total = np.bincount(found.face_label, face_areas(found), minlength=len(SURFACES))
    return {surface.name: total[label] for label, surface in enumerate(SURFACES)}


def test_a_crossroads_has_every_part_of_a_street(layout_of):
    found = ground_of(layout_of(CROSS, houses=HOUSES))
    assert check_arrangement(found) == (0, 0, 0.0)
    area = areas(found)
    for name in ("carriageway", "junction", "kerb", "sidewalk", "marking", "building"):
        assert area[name] > 1.0, name
    assert area["building"] == pytest.approx(4 * 2500)
    roads = area["carriageway"] + area["gutter"] + area["junction"] + area["marking"]
    curves = 4 * 6.0**2 * (1 - np.pi / 4)  # a secondary road, 8 m, and a residential one, 4 m
    assert roads == pytest.approx(180 * 8 + 180 * 6 - 48 + curves, rel=0.002)


def test_the_first_of_some_surfaces_under_a_point_is_found(layout_of):
    found = ground_of(layout_of(CROSS, houses=HOUSES))
    xy = np.random.default_rng(3).uniform(-95, 95, (500, 2))
    names = ("sidewalk", "carriageway", "junction", "building")
    of = found.first_of(xy, *names)
    assert set(of.tolist()) == {-1, 0, 1, 2, 3}
    assert np.array_equal(of, np.select([found.on(xy, n) for n in names], range(4), -1))


def test_houses_win_over_carriageways_but_not_over_passages(layout_of):
    street = [(-90, 0), (90, 0)]
    blocked = areas(ground_of(layout_of([(street, {})], houses=[(-10, -20, 10, 20)])))
    assert blocked["building"] == pytest.approx(800.0)
    through = areas(
        ground_of(layout_of([(street, {"passage": True})], houses=[(-10, -20, 10, 20)]))
    )
    # The lane and the walks on both sides of it.
    assert through["building"] == pytest.approx(800.0 - 20 * (6 + 2 * 2))


def test_no_marking_lies_in_a_junction_or_on_stone(layout_of):
    layout = layout_of(CROSS, houses=HOUSES)
    found = ground_of(layout)
    marks = found.vertices[
        found.triangles[found.face_label[found.triangle_face] == LABEL["marking"]]
    ]
    assert np.abs(marks).max(axis=2).min() > 5.0  # the crossing's middle stays free
    stone = layout_of([(line, {**options, "surface": "sett"}) for line, options in CROSS])
    assert areas(ground_of(stone))["marking"] == 0.0
    assert areas(ground_of(stone))["setts"] > 0.0


def test_a_dense_block_is_paved_and_open_country_is_not(layout_of):
    ring = [([(-80, -80), (80, -80), (80, 80), (-80, 80), (-80, -80)], {})]
    dense = areas(ground_of(layout_of(ring, houses=HOUSES)))
    assert dense["courtyard"] > 5000.0
    assert areas(ground_of(layout_of(ring)))["courtyard"] == 0.0


@pytest.mark.parametrize(("size", "dense"), [(40, True), (10, False)])
def test_a_block_that_the_border_cuts_is_as_the_town_is(layout_of, size, dense):
    grid = [([(x, -90), (x, 90)], {}) for x in (-80, 0, 80)]
    grid += [([(-90, y), (90, y)], {}) for y in (-80, 0, 80)]
    inner = [(x, y, x + size, y + size) for x in (-60, 20) for y in (-60, 20)]
    found = ground_of(layout_of(grid, houses=inner))
    assert found.on([[95, 40], [-95, -40]], "block").any() != dense


def test_a_narrow_island_is_not_built(layout_of):
    twin = [([(-90, y), (90, y)], {"oneway": True, "width": 6.0, "sidewalk_left": 0.0,
                                   "sidewalk_right": 0.0}) for y in (0.0, 6.8)]  # fmt: skip
    rungs = [([(x, 0.0), (x, 6.8)], {}) for x in (-90, 90)]
    found = ground_of(layout_of(twin + rungs))
    inside = shapely.points(found.vertices[found.triangles].mean(axis=1))
    island = shapely.contains(shapely.box(-60, 3.0, 60, 3.8), inside)
    labels = set(found.face_label[found.triangle_face[island]].tolist())
    assert labels == {LABEL["carriageway"]}


def test_land_cover_lies_in_the_order_of_its_priorities(layout_of):
    land = [((-50, -50, 50, 50), "park"), ((-20, -20, 20, 20), "water"), ((-5, -5, 5, 5), "pier")]
    area = areas(ground_of(layout_of([], areas=land)))
    assert area["plaza"] == pytest.approx(100.0)
    assert area["water"] == pytest.approx(1500.0)
    assert area["park"] == pytest.approx(8400.0)


def test_detail_level_zero_leaves_out_kerbs_and_markings(layout_of):
    found = ground_of(layout_of(CROSS, houses=HOUSES), lod=0)
    assert check_arrangement(found) == (0, 0, 0.0)
    names = {SURFACES[label].name for label in np.unique(found.face_label)}
    assert names == {"block", "courtyard", "carriageway"}


def test_the_ground_does_not_depend_on_the_order_of_rows(layout_of, city_of):
    layout = layout_of(CROSS, houses=HOUSES, areas=[((-90, -90, -20, -20), "park")])
    turned = {}
    for name in ("roads", "parts", "buildings", "areas"):
        table = getattr(layout, name).iloc[::-1]
        columns = {key: table[key].to_numpy() for key in SCHEMA[name]}
        turned[name] = make_table(name, table.geometry.to_numpy(), **columns)
    one = ground(network(city_of(layout)))
    other = ground(network(city_of(replace(layout, **turned))))
    for key in ("vertices", "triangles", "face_object", "edges"):
        assert getattr(one.ground, key).tobytes() == getattr(other.ground, key).tobytes()
    meshes = one.scene.meshes["ground"], other.scene.meshes["ground"]
    assert meshes[0].vertices.tobytes() == meshes[1].vertices.tobytes()


def test_the_ground_follows_the_relief(layout_of, city_of):
    heights = np.add.outer(np.arange(11.0), np.arange(11.0) * 0.5)
    terrain = Terrain((-100.0, -100.0), 20.0, heights)
    land = [((-90, 30, -50, 70), "water")]
    city = ground(network(city_of(layout_of(CROSS, areas=land), terrain=terrain)))
    assert check_arrangement(city.ground) == (0, 0, 0.0)
    mesh = city.scene.meshes["ground"]
    above = mesh.vertices[:, 2] - city.terrain.height_at(mesh.vertices[:, :2])
    assert above.max() == pytest.approx(KERB_HEIGHT, abs=1e-3)
    assert set(city.scene.meshes) == {"ground", "surroundings"}


@pytest.mark.shared
@pytest.mark.parametrize("name", ["london_soho", "seattle_i5_exit", "bristol_degenerate"])
def test_real_streets_leave_no_gap_and_keep_out_of_houses(name):
    paths = sorted(OSM.glob(f"{name}.osm*"))
    if not paths:
        pytest.skip("the real maps are not here")
    from cityx.sources.osm import read_osm

    city = read_osm(paths[0])
    found = ground_of(city.layout)
    assert check_arrangement(found) == (0, 0, pytest.approx(0.0, abs=1e-9))
    area = areas(found)
    assert area["carriageway"] + area["junction"] > 500.0


def test_a_court_that_houses_enclose_has_ground_of_its_own(layout_of):
    streets = [([(-90, y), (90, y)], {}) for y in (-60, 60)]
    streets += [([(x, -90), (x, 90)], {}) for x in (-60, 60)]
    kinds = set()
    for shift in range(8):
        x = shift * 2.0
        wings = [(-40 - x, -40, 40, -20), (-40 - x, 20, 40, 40), (-40 - x, -20, -20 - x, 20),
                 (20, -20, 40, 20)]  # fmt: skip
        found = ground_of(layout_of(streets, houses=wings))
        assert check_arrangement(found) == (0, 0, 0.0)
        inner = [face for face in np.unique(found.triangle_face) if face_holds(found, face, (0, 0))]
        kinds.add(SURFACES[found.face_label[inner[0]]].name)
    assert kinds <= {"grass", "courtyard", "gravel"}
    assert len(kinds) > 1


def test_a_court_too_large_to_pave_is_a_lawn(layout_of):
    streets = [([(-120, y), (120, y)], {}) for y in (-90, 90)]
    streets += [([(x, -120), (x, 120)], {}) for x in (-90, 90)]
    for shift in range(8):
        x = shift * 2.0
        wings = [(-60 - x, -60, 60, -30), (-60 - x, 30, 60, 60), (-60 - x, -30, -40 - x, 30),
                 (40, -30, 60, 30)]  # fmt: skip
        found = ground_of(layout_of(streets, houses=wings))
        inner = [face for face in np.unique(found.triangle_face) if face_holds(found, face, (0, 0))]
        assert SURFACES[found.face_label[inner[0]]].name == "grass"


def face_holds(found, face, at):
    corners = found.vertices[found.triangles[found.triangle_face == face]]
    return bool(shapely.intersects(shapely.polygons(corners), shapely.Point(at)).any())


def test_no_kerb_crosses_a_mapped_road_area(layout_of):
    layout = layout_of([([(-90, 0), (90, 0)], {"width": 6.0})],
                       areas=[((-90, -6, 90, 6), "road_area")])  # fmt: skip
    found = ground_of(layout)
    rows = np.flatnonzero(found.face_label[found.triangle_face] == LABEL["kerb"])
    middle = found.vertices[found.triangles[rows]].mean(axis=1)
    assert not ((np.abs(middle[:, 1]) < 5.9) & (np.abs(middle[:, 0]) < 89)).any()


def test_houses_of_one_family_stand_in_gardens_in_a_town(layout_of):
    houses = [(10, 10, 90, 30), (10, 36, 90, 90), (-90, 10, -10, 90), (10, -90, 90, -10)]
    layout = layout_of(CROSS, houses=houses)
    plain = areas(ground_of(layout))["grass"]
    layout.buildings["place"] = "urban"
    layout.buildings["use"] = ["terrace", "terrace", "apartments", "apartments"]
    found = ground_of(layout)
    assert check_arrangement(found) == (0, 0, 0.0)
    assert areas(found)["grass"] > plain + 400.0


def test_a_row_of_stones_lies_where_setts_meet_asphalt(layout_of):
    streets = [([(-90, 0), (0, 0)], {"surface": "sett"}), ([(0, 0), (90, 0)], {}),
               ([(0, -90), (0, 0)], {}), ([(0, 0), (0, 90)], {})]  # fmt: skip
    found = ground_of(layout_of(streets))
    middle = found.vertices[found.triangles].mean(axis=1)
    stones = middle[found.face_label[found.triangle_face] == LABEL["threshold"]]
    assert len(stones)
    assert stones[:, 0].max() < -5.0  # before the junction, across the street of setts
    assert np.ptp(stones[:, 0]) < 0.3
    plain = ground_of(layout_of([(line, {}) for line, _ in streets]))
    assert not plain.labelled("threshold").any()


def test_a_mapped_road_area_is_paved_as_it_is_told_and_has_kerbs(layout_of):
    layout = layout_of([([(-90, 0), (90, 0)], {"surface": "sett"})],
                       areas=[((-60, -5, 60, 4), "road_area")])  # fmt: skip
    layout.areas["tags"] = '{"area:highway": "residential", "surface": "sett"}'
    found = ground_of(layout)
    middle = found.vertices[found.triangles].mean(axis=1)
    label = found.face_label[found.triangle_face]
    beside = (np.abs(middle[:, 0]) < 55) & (middle[:, 1] < -3.2) & (middle[:, 1] > -4.6)
    assert beside.any()
    assert set(label[beside].tolist()) == {LABEL["setts"]}
    stones = (np.abs(middle[:, 0]) < 55) & (middle[:, 1] < -5.02) & (middle[:, 1] > -5.13)
    assert set(label[stones].tolist()) == {LABEL["kerb"]}


def test_streets_of_setts_have_gutters_of_long_stones(layout_of):
    area = areas(ground_of(layout_of([([(-90, 0), (90, 0)], {"surface": "sett"})])))
    assert area["gutter"] == pytest.approx(2 * 0.32 * 180, rel=0.03)
