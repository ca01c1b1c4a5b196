import numpy as np
import pytest
import shapely

from cityx.checks.furniture_checks import check_trees
from cityx.checks.predicates import clean, measure_all
from cityx.city.content import content_hash
from cityx.edit.land.add import add
from cityx.edit.land.lining import line
from cityx.edit.land.planting import plant
from cityx.edit.land.pond import pond
from cityx.edit.land.replanting import replant
from cityx.errors import UsageError
from cityx.ids import id_text


def assert_met(city, before, *predicates):
    found = measure_all(predicates, city, before=before)
    assert [f.evidence for f in found if not f.met] == []
    assert [rule.evidence for rule in clean(city) if rule.met is False] == []


def test_a_row_of_trees_keeps_its_spacing_and_clear_of_the_carriageway(grid):
    assert_met(
        plant(grid, along=("y2",), spacing=10.0), grid,
        "spacing(tree, road.class=primary) in [9, 11]", "dist(tree, carriageway) >= 0.3",
        "same(building)", "same(road)", "same(others)",
    )  # fmt: skip


def test_a_row_that_is_planted_again_takes_the_place_of_itself(grid):
    once = plant(grid, along=("y2",), spacing=10.0)
    twice = plant(once, along=("y2",), spacing=10.0)
    assert content_hash(once).total == content_hash(twice).total


def test_older_trees_make_room_for_a_row_and_those_farther_off_stay(park):
    old = park.scene.instances["trees"]
    new = plant(park, along=("loop1",), spacing=6.0, species="cherry").scene.instances["trees"]
    gone = old.position[~np.isin(old.object_id, new.object_id), :2]
    assert np.all(np.abs(np.hypot(*gone.T) - 45.0) < 6.0)


def test_so_many_trees_as_asked_are_scattered_in_the_park(park):
    assert_met(
        plant(park, within=("park1",), count=5), park,
        "n(tree, in=park1) == 51", "same(building)", "same(others)",
    )  # fmt: skip


def test_more_trees_than_there_is_room_for_are_refused_with_how_many_there_is_room_for(park):
    with pytest.raises(UsageError, match=r"room for \d+ more trees"):
        plant(park, within=("park1",), count=3000)


def test_trees_within_a_street_are_refused(park):
    with pytest.raises(UsageError, match="planted within parks"):
        plant(park, within=("x1",), count=1)


def test_new_lamps_take_the_place_of_the_old_ones_of_their_street_alone(grid):
    lit = line(grid, thing="streetlight", along=("y2",), spacing=20.0)
    assert_met(lit, grid, "spacing(streetlight, road.name=y2) in [18, 22]", "same(tree)")
    rows, now = grid.scene.instances["street_furniture"], lit.scene.instances["street_furniture"]
    other = np.abs(rows.position[:, 1] + 95.0) > 15.0
    assert np.isin(rows.object_id[other], now.object_id).all()


def test_benches_along_a_path_face_it(park):
    found = line(park, thing="bench", along=("loop1",), count=4).scene.instances
    rows = found["street_furniture"]
    facing = np.column_stack([np.sin(rows.rotation[:, 2]), -np.cos(rows.rotation[:, 2])])
    out = rows.position[:, :2] / np.hypot(*rows.position[:, :2].T)[:, None]
    inside = np.hypot(*rows.position[:, :2].T) < 45.0
    assert rows.count == 4
    assert np.all((facing * out).sum(axis=1) * np.where(inside, 1.0, -1.0) > 0.9)


def test_a_pond_keeps_clear_of_paths_and_trees(park):
    assert_met(
        pond(park, park=("park1",), size="small"), park,
        "n(lake) == 1", "inside(lake, park1)", "dist(lake, loop1) >= 1.5", "dist(tree, lake) >= 1",
        "same(building)", "same(tree)", "same(others, beyond=10)",
    )  # fmt: skip


@pytest.mark.parametrize(
    ("place", "area", "text"),
    [("park1", 9000.0, "there are 6[0-9][0-9] m2 at most"), ("plaza1", 400.0, "is none of them")],
)
def test_a_pond_without_room_is_refused(park, place, area, text):
    with pytest.raises(UsageError, match=text):
        pond(park, park=(place,), area=area)


def test_trees_along_all_streets_keep_their_crowns_out_of_houses(grid):
    streets = tuple(sorted(set(grid.layout.roads["name"]) - {""}))
    planted = plant(grid, along=streets)
    crowns = {check.name: check for check in check_trees(planted)}["crowns_in_facades"]
    assert crowns.ok
    assert planted.scene.instances["trees"].count > 20


def test_trees_of_another_kind_stand_where_the_others_stood(park):
    trees = park.scene.instances["trees"]
    ids = trees.object_id[:5]
    new = replant(park, objects=tuple(map(id_text, ids.tolist())), species="birch")
    told = " ".join(map(id_text, ids.tolist()))
    assert_met(new, park, f'n(tree, id="{told}", species=birch) == 5', "same(building)")
    now = new.scene.instances["trees"]
    at = {int(one): tuple(xy) for one, xy in zip(now.object_id, now.position[:, :2], strict=True)}
    for one, xy in zip(ids.tolist(), trees.position[:5, :2], strict=True):
        assert np.allclose(at[one], xy, atol=1e-3)


def test_a_row_keeps_to_the_part_that_is_told(park):
    def row(part):
        new = line(park, thing="bench", along=("loop1",), spacing=10.0, part=part)
        rows, old = (one.scene.instances["street_furniture"] for one in (new, park))
        return rows.position[~np.isin(rows.object_id, old.object_id), 1]

    whole = row(None)
    middle = float(np.median(whole))
    half = row(((-1e3, middle, 0.0), (1e3, middle, 0.0), (1e3, 1e3, 0.0), (-1e3, 1e3, 0.0)))
    assert 0 < len(half) < len(whole)
    assert (half >= middle - 1e-3).all()


def test_things_are_turned_to_what_they_face(park):
    new = add(park, thing="bench", within=("park1",), count=3, toward=("x1",))
    old = park.scene.instances.get("street_pieces")
    rows = new.scene.instances["street_pieces"]
    own = np.isin(rows.object_id, [] if old is None else old.object_id, invert=True)
    way = shapely.union_all(
        park.layout.roads.geometry.to_numpy()[park.layout.roads["source"].str.endswith("x1")]
    )
    for xy, yaw in zip(rows.position[own, :2], rows.rotation[own, 2], strict=True):
        near = shapely.get_coordinates(shapely.shortest_line(shapely.Point(xy), way))[1]
        ahead = (near - xy) / np.hypot(*(near - xy))
        assert np.dot(ahead, (np.sin(yaw), -np.cos(yaw))) > 0.99
