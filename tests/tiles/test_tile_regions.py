"""Tiles side by side are one city: the same from any order, with whole lanes over borders."""

import shutil

import numpy as np
import pytest
import shapely
from copies import copy_of
from typer.testing import CliRunner

from cityx.city.content import content_hash
from cityx.city.store import read_city
from cityx.cli.tiles import tiles as commands
from cityx.errors import UsageError
from cityx.sources.osm.reader import read_elements
from cityx.tiles.order import read_order
from cityx.tiles.region import Region, place_of, region_about, region_city, write_region
from cityx.tiles.run import FRAGMENTS, TILES, records
from cityx.tiles.split import merged, read_fragment


@pytest.fixture(scope="module")
def region(built_tiles):
    return region_about(built_tiles, (0.0, 0.0), (100.0, 100.0))


@pytest.fixture(scope="module")
def city(region):
    return region_city(region)


@pytest.fixture(scope="module")
def cities(region):
    return [read_city(region.folder / TILES / tile.name / "city") for tile in region.tiles]


def test_a_region_holds_what_its_tiles_do_each_once(region, city, cities):
    assert region.box == (-500.0, -500.0, 500.0, 500.0)
    assert len(region.tiles) == 4
    for name in ("buildings", "parts", "points"):
        ids = getattr(city.layout, name)["id"].tolist()
        every = [key for one in cities for key in getattr(one.layout, name)["id"]]
        assert ids == sorted(every)
    for layer, table in city.scene.instances.items():
        own = [one.scene.instances.get(layer) for one in cities]
        assert table.count == sum(rows.count for rows in own if rows is not None)
        names = {city.scene.prototypes[k].name for k in table.prototype.tolist()}
        assert names == {
            one.scene.prototypes[k].name
            for one, rows in zip(cities, own, strict=True) if rows is not None
            for k in rows.prototype.tolist()
        }  # fmt: skip
    for layer, batch in city.scene.meshes.items():
        own = [one.scene.meshes[layer] for one in cities if layer in one.scene.meshes]
        assert len(batch.faces) == sum(len(each.faces) for each in own)
        assert len(set(batch.object_id.tolist())) == batch.count
        of = batch.face_object()
        inside = batch.faces[np.arange(len(of)), 0]
        assert (inside >= batch.vertex_start[of]).all()
        assert (inside < batch.vertex_start[of + 1]).all()


def test_the_order_in_which_tiles_are_read_changes_nothing(region, city):
    shuffled = Region(region.folder, region.order, region.tiles[::-1], region.box, region.edits)
    assert region.key == shuffled.key
    turned = region_city(shuffled)
    assert content_hash(turned).total == content_hash(city).total


def test_lanes_of_tiles_are_those_of_the_region_and_lead_over_borders(city, cities):
    lanes = city.lanes
    whole = {key: lanes.lane_points(row) for row, key in enumerate(lanes.lane_id.tolist())}
    for one in cities:
        for row, key in enumerate(one.lanes.lane_id.tolist()):
            assert np.abs(whole[key] - one.lanes.lane_points(row)).max() < 0.001
    middle = [np.mean(lanes.lane_points(row), axis=0) for row in range(lanes.count)]
    side = np.array([point[0] > 0 for point in middle])
    assert (side[lanes.connection[:, 0]] != side[lanes.connection[:, 1]]).any()
    roads = city.layout.roads
    assert roads["id"].is_unique
    assert shapely.crosses(roads.geometry.to_numpy(), shapely.LineString([(0, -9), (0, 9)])).any()


def test_the_ground_has_no_rim_at_the_borders_between_tiles(city):
    ground = city.ground
    rim = ground.vertices[ground.edges[ground.edge_faces[:, 1] < 0]]  # (e, 2, 2)
    outer = np.ptp(np.abs(rim), axis=1).min(axis=1) < 1e-6
    assert outer.all()
    assert (np.abs(rim).max(axis=(1, 2)) == 500.0).all()
    area = 0.5 * np.abs(
        np.cross(
            *(
                ground.vertices[ground.triangles[:, [k]]].squeeze(1)
                - ground.vertices[ground.triangles[:, 0]]
                for k in (1, 2)
            )
        )
    )
    assert area.sum() == pytest.approx(1000.0**2)


def test_walks_lead_over_borders_between_tiles(city):
    pytest.importorskip("numba")
    from cityx.sim.compile.walks import compile_walks
    from cityx.sim.compile.worlds import compile_world

    walks = compile_walks(city, compile_world(city, "joined"))
    routes = np.split(walks.route_point, walks.route_start[1:-1])
    low, high = (np.array([edge(points[:, :2], axis=0) for points in routes])
                 for edge in (np.min, np.max))  # fmt: skip
    over = ((low < -5.0) & (high > 5.0)).any(axis=0)
    assert over.tolist() == [True, True]  # over the border at x = 0, and at y = 0


def test_fragments_of_a_map_make_its_elements_again(region, town_map):
    held = [read_fragment(region.folder / FRAGMENTS / f"{tile.name}.npz")[0]
            for tile in region.tiles]  # fmt: skip
    osm, joined = read_elements(town_map), held[0]
    for other in held[1:]:
        joined = merged(joined, other)
    assert joined.way_id.tolist() == osm.way_id.tolist()
    assert joined.way_tags == osm.way_tags
    assert (joined.lonlat[joined.way_nodes] == osm.lonlat[osm.way_nodes]).all()
    assert joined.relation_id == osm.relation_id
    assert joined.members == osm.members
    told = {int(osm.node_id[row]): tags for row, tags in
            zip(osm.tagged.tolist(), osm.node_tags, strict=True)}  # fmt: skip
    assert told == {int(joined.node_id[row]): tags for row, tags in
                    zip(joined.tagged.tolist(), joined.node_tags, strict=True)}  # fmt: skip


def test_tiles_that_are_missing_are_built_when_they_are_joined(built_tiles, city, tmp_path):
    copied = copy_of(built_tiles, tmp_path / "tiles")
    shutil.rmtree(copied / TILES / "-1_0")
    words = ["join", str(copied), "-o", str(tmp_path / "out"), "--at", "0,0", "--area", "50x50"]
    shown = CliRunner().invoke(commands, words)
    assert shown.exit_code == 0, shown.output
    assert shown.stdout.splitlines()[0] == f"4 tiles, {len(city.layout.buildings)} buildings"
    assert len(records(copied)) == 4
    assert content_hash(read_city(tmp_path / "out" / "city")).total == content_hash(city).total


def test_a_simulator_takes_a_place_in_a_folder_of_tiles(built_tiles, city, tmp_path, monkeypatch):
    pytest.importorskip("gymnasium")
    from cityx.sim.places import world_of

    monkeypatch.setenv("CITYX_CACHE", str(tmp_path))
    world = world_of(built_tiles, at="0,0", size=(50.0, 50.0))
    assert world.hash == content_hash(city).total
    assert world.facts["extent"] == [-500.0, -500.0, 500.0, 500.0]
    for place, at, said in (
        (built_tiles, "", "holds tiles; at says about which place they are to be joined"),
        (None, "0,0", "at says where in a folder of tiles; a town is none"),
        (built_tiles, "here", 'at is "here"; it takes LAT,LON in degrees or X,Y in metres'),
    ):
        with pytest.raises(UsageError, match=said):
            world_of(place, at=at)


def test_what_cannot_be_joined_is_refused(built_tiles, tmp_path):
    with pytest.raises(UsageError, match=r"are 400 tiles of 500 m; a region has 1 to 36"):
        region_about(built_tiles, (0.0, 0.0), (10_000.0, 10_000.0))
    with pytest.raises(UsageError, match=r"No tile of .* lies about 9000,0"):
        region_about(built_tiles, (9000.0, 0.0), (10.0, 10.0))
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "mine").write_text("")
    with pytest.raises(UsageError, match="is not empty; a region takes a folder of its own"):
        write_region(region_about(built_tiles, (0.0, 0.0), (10.0, 10.0)), tmp_path / "out")
    order, _ = read_order(built_tiles)
    ((x, y),) = order.frame.to_local([[order.frame.longitude, order.frame.latitude]]).tolist()
    spot = f"{order.frame.latitude:.6f},{order.frame.longitude:.6f}"
    assert place_of(order, spot) == pytest.approx((x, y), abs=0.2)
