from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
import shapely

from cityx.assets.furniture.park_pieces import basketball, football, tennis
from cityx.city import make_table
from cityx.city.ground import LABEL
from cityx.geometry.polylines import locate, pack
from cityx.ground.standing import stand_on
from cityx.nature.land.parks import LAYER as PARK_LAYER
from cityx.nature.land.parks import parks, sport_of
from cityx.nature.land.shores import LAYER as SHORE_LAYER
from cityx.nature.land.shores import _strewn, shores
from cityx.road.ground.ground_surface import ground
from cityx.road.ground.park_paths import _areas_of, park_paths, unmapped_parks
from cityx.road.network.network import network


@pytest.fixture(scope="module")
def waterside(crossroads):
    """The crossroads with a park of its own, a canal beside a square, a pond, pitches."""
    areas = make_table(
        "areas",
        [
            shapely.box(10, 28, 98, 98), shapely.box(-98, 30, -30, 52),
            shapely.box(-98, 20, -30, 30), shapely.box(-90, 60, -40, 95),
            shapely.box(12, -96, 60, -60), shapely.box(64, -90, 98, -73),
            shapely.box(-60, -60, -40, -44),
        ],
        id=np.arange(61, 68),
        kind=["park", "river", "pedestrian", "water", "pitch", "pitch", "playground"],
        tags=["", "", "", "", '{"sport": "soccer"}', '{"sport": "tennis"}', ""],
    )  # fmt: skip
    city = replace(crossroads, layout=replace(crossroads.layout, areas=areas))
    return ground(city)


def named(city, layer):
    rows = city.scene.instances[layer]
    return np.array([city.scene.prototypes[i].name for i in rows.prototype]), rows


def test_a_park_without_paths_gets_a_walk_round_and_ways_out(waterside):
    assert len(unmapped_parks(waterside.layout)) == 1
    found = park_paths(waterside.layout)
    park = shapely.box(10, 28, 98, 98)
    assert shapely.covers(park.buffer(0.01), found.lines[0])
    assert len(found.gates) >= 2
    joined = shapely.unary_union(shapely.buffer(found.lines, 0.1))
    assert len(shapely.get_parts(joined)) == 1  # one walks from every gate to every other
    trail = waterside.ground.face_label == LABEL["trail"]
    assert trail.any()


def test_lines_that_come_with_the_ground_of_a_park_are_no_ground():
    ground = shapely.box(0, 0, 10, 10)
    both = shapely.geometrycollections([ground, shapely.linestrings([(20, 0), (30, 0)])])
    assert shapely.equals(_areas_of(both), ground)
    assert _areas_of(ground) is ground


def test_mapped_paths_are_left_alone(waterside):
    roads = waterside.layout.roads
    path = roads.iloc[:1].assign(
        id=np.array([99], np.uint64), kind="footway",
        geometry=[shapely.LineString([(10, 60), (98, 62)])],
    )  # fmt: skip
    layout = replace(waterside.layout, roads=pd.concat([roads, path], ignore_index=True))
    assert not len(unmapped_parks(layout))


def test_benches_stand_beside_paths_and_not_on_them(waterside):
    names, rows = named(parks(waterside), PARK_LAYER)
    bench = rows.position[names == "bench", :2]
    assert len(bench) > 3
    label = stand_on(waterside.scene.meshes["ground"], bench).label
    assert set(label.tolist()) <= {LABEL["park"], LABEL["trail"], LABEL["playground"]}
    lines = park_paths(waterside.layout)
    gap = shapely.distance(shapely.points(bench), shapely.unary_union(lines.lines))
    assert gap.min() > 1.0


@pytest.mark.parametrize("mapped", [None, "footway", "service", "pedestrian", "track"])
def test_graves_stand_beside_the_paths_of_a_cemetery(crossroads, mapped):
    yard = make_table("areas", [shapely.box(10, 28, 98, 98)], id=[61], kind=["cemetery"], tags=[""])
    layout = replace(crossroads.layout, areas=yard)
    if mapped:
        way = layout.roads.iloc[:1].assign(
            id=np.array([99], np.uint64), kind=mapped, width=3.0,
            geometry=[shapely.LineString([(10, 60), (60, 62), (98, 50)])],
        )  # fmt: skip
        layout = replace(layout, roads=pd.concat([layout.roads, way], ignore_index=True))
    city = parks(ground(network(replace(crossroads, layout=layout, network=None))))
    names, rows = named(city, PARK_LAYER)
    graves = shapely.points(rows.position[np.char.startswith(names.astype(str), "grave"), :2])
    assert len(graves) > 100
    trails = shapely.polygons(city.ground.vertices[city.ground.triangles_of("trail")])
    drawn = shapely.union_all(trails, grid_size=1e-3)
    paths = way.geometry.iloc[0].buffer(1.5) if mapped else drawn
    inside = shapely.intersection(paths, shapely.box(12, 30, 96, 96))
    assert inside.area > 100
    assert shapely.distance(inside, graves).min() > 0.7


def test_pitches_get_the_things_of_their_sport(waterside):
    names, rows = named(parks(waterside), PARK_LAYER)
    assert (names == "football_goal").sum() == 2
    assert (names == "tennis_net").sum() == 1
    goals = rows.position[names == "football_goal", :2]
    assert np.hypot(*(goals[0] - goals[1])) == pytest.approx(43.0, abs=0.1)
    assert {"swing", "slide", "climbing_frame", "spring_rider", "sandpit"} & set(names)


def test_lines_of_courts_lie_on_the_ground(waterside):
    mesh = parks(waterside).scene.meshes["courts"]
    above = mesh.vertices[:, 2] - stand_on(waterside.scene.meshes["ground"], mesh.vertices[:, :2]).z
    assert above.min() > 0.0
    assert above.max() < 0.03


@pytest.mark.parametrize("court", [football(105.0, 68.0), basketball(), tennis(clay=True)])
def test_lines_stay_within_their_court_and_mirror(court):
    points = np.concatenate(court.lines)
    assert np.abs(points[:, 0]).max() == pytest.approx(court.length / 2)
    assert np.abs(points[:, 1]).max() == pytest.approx(court.width / 2)
    lines = shapely.multilinestrings([shapely.LineString(line) for line in court.lines])
    for axes in ([-1.0, 1.0], [1.0, -1.0]):
        mirrored = shapely.transform(lines, lambda p, a=axes: p * a)
        assert shapely.hausdorff_distance(lines, mirrored) < 0.05


def test_a_sport_is_read_from_a_list():
    assert sport_of('{"sport": "boules;tennis", "surface": "clay"}') == ("tennis", "clay")
    assert sport_of("") == ("", "")


def test_a_square_at_a_river_has_a_quay_and_a_pond_has_banks(waterside):
    city = shores(waterside)
    names, rows = named(city, SHORE_LAYER)
    pond = shapely.box(-90, 60, -40, 95).boundary
    reeds = shapely.points(rows.position[names == "reeds", :2])
    assert len(reeds) > 10
    assert {"mooring_bollard", "life_ring"} & set(names)
    boats = rows.position[np.isin(names, ("rowing_boat", "motor_boat", "barge")), :2]
    for spot in shapely.points(boats):
        assert shapely.distance(spot, pond) > 5.0
    materials = city.scene.meshes["shores"].materials
    assert {"step_stone", "meadow"} <= set(materials)


def test_banks_end_below_the_water(waterside):
    batch = shores(waterside).scene.meshes["shores"]
    soil = batch.faces[batch.material == batch.materials.index("soil")][:, :3]
    assert batch.vertices[soil].reshape(-1, 3)[:, 2].min() < -1.0
    assert batch.vertices[soil].reshape(-1, 3)[:, 2].max() < 0.13


@pytest.mark.parametrize("action", [shores, parks])
def test_the_same_seed_gives_the_same_bytes(waterside, action):
    a, b = (action(waterside) for _ in range(2))
    layers = [{*c.scene.instances, *c.scene.meshes} for c in (a, waterside)]
    assert layers[0] - layers[1]
    for layer in set(a.scene.instances) - set(waterside.scene.instances):
        assert a.scene.instances[layer].position.tobytes() == (
            b.scene.instances[layer].position.tobytes()
        )
    for layer in set(a.scene.meshes) - set(waterside.scene.meshes):
        assert a.scene.meshes[layer].vertices.tobytes() == b.scene.meshes[layer].vertices.tobytes()


def test_reeds_and_stones_stay_in_the_water_where_the_bank_turns(crossroads):
    wedges = [shapely.Polygon([(-95, y), (-20, y + 3), (-95, y + 6)]) for y in range(30, 95, 8)]
    areas = make_table("areas", wedges, id=np.arange(61, 61 + len(wedges)),
                       kind=["water"] * len(wedges))  # fmt: skip
    built = ground(replace(crossroads, layout=replace(crossroads.layout, areas=areas)))
    names, rows = named(shores(built), SHORE_LAYER)
    grown = np.isin(names, ("reeds", "boulder"))
    assert grown.sum() > 10
    assert built.ground.on(rows.position[grown, :2], "water").all()


def test_reeds_stand_where_they_did_when_a_shore_begins_elsewhere(crossroads):
    line = np.array([(float(x), 5.0 * np.sin(x / 20.0)) for x in range(-200, 201, 4)])
    found = []
    for points in (line, line[23:]):
        lines = pack(np.array([shapely.LineString(points)], object))
        row, along, own = _strewn(crossroads, lines, 1.1, "reeds")
        xy = locate(lines, row, along)[0]
        rows = np.flatnonzero(xy[:, 0] > -90.0)
        rows = rows[np.argsort(own[rows])]
        found.append((own[rows], xy[rows]))
    assert (found[0][0] == found[1][0]).all()
    assert found[0][1] == pytest.approx(found[1][1], abs=1e-6)
    assert 0.6 < len(found[0][0]) * 1.1 / 300.0 < 1.6  # one every spacing or so
