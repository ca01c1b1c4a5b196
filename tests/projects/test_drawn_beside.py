"""What is drawn beside a sentence is the place, or the objects there, that "this" means."""

import pytest
import shapely
from copies import copy_of

from cityx.city.store import read_city
from cityx.errors import UsageError
from cityx.geometry.polygons import region_of_corners
from cityx.language.brief import Clarify
from cityx.projects.desk import Desk
from cityx.projects.drawn import BESIDE, NAME, drawn_of, placed_in
from cityx.projects.edit import edit_city, planned, roles_at

PATH = drawn_of([(-60.0, -30.0), (0.0, -25.0), (50.0, -35.0)], area=False)
AREA = drawn_of([(-60.0, -60.0), (0.0, -60.0), (0.0, 0.0), (-60.0, 0.0)], area=True)


@pytest.fixture(scope="module")
def items(built_town, tmp_path_factory):
    folder = copy_of(built_town(lod=1), tmp_path_factory.mktemp("drawn") / "town")
    with Desk(folder) as desk, roles_at(desk) as roles:

        def of(text, drawn):
            return [(one.action, one.args)
                    for one in planned(desk, text, roles=roles, drawn=drawn).items]  # fmt: skip

        of.city = desk.city
        yield of


@pytest.mark.parametrize(
    ("text", "rest", "places"),
    [
        ("put benches along this", "put benches", (11,)),
        ("plant limes in this area, and rain", "plant limes, and rain", (11,)),
        ("Put a fountain here.", "Put a fountain.", (14,)),
        ("let a man run along this path and a dog here", "let a man run and a dog", (13, 23)),
    ],
)
def test_the_words_for_what_is_drawn_are_taken_out(text, rest, places):
    placed = placed_in(text, PATH)
    assert (placed.text, placed.places) == (rest, places)


@pytest.mark.parametrize("text", ["make this red", "rain in this city", "mow this park"])
def test_other_words_are_left_alone(text):
    assert placed_in(text, PATH) is None
    assert placed_in("put benches along this", None) is None


def test_what_is_put_along_a_path_stands_within_its_band_and_as_close_as_things_do(items):
    ((action, args),) = items("put benches along this", PATH)
    assert (action, args["thing"], args["count"]) == ("edit/add-v1", "bench", 13)
    band = shapely.LineString(PATH.points).buffer(BESIDE + 0.01)
    assert region_of_corners(args["ground"]).within(band)
    ((_, one),) = items("put a fountain along this", PATH)
    assert "count" not in one


def test_of_several_changes_that_one_is_placed_that_speaks_of_it(items):
    first, second = items("plant ten limes in this area and make the tallest building blue", AREA)
    ground = region_of_corners(first[1]["ground"])
    assert ground.equals(shapely.Polygon(AREA.points))
    assert len(second[1]["objects"]) == 1


def test_objects_are_those_that_stand_there(items):
    ((_, args),) = items("make the buildings in this area red", AREA)
    table = items.city.layout.buildings
    inside = shapely.contains(shapely.Polygon(AREA.points), table.geometry.centroid)
    assert set(args["objects"]) == {f"{number:016x}" for number in table["id"][inside]}
    assert 0 < len(args["objects"]) < len(table)
    with pytest.raises(Clarify, match="No church stands at the area drawn"):
        items("remove the church here", AREA)


def test_who_goes_along_a_path_gets_its_points(items):
    ((action, args),) = items("let a woman walk along this", PATH)
    assert (action, args["path"], tuple(args["points"])) == (
        "dynamic/character-v1", NAME, PATH.points,
    )  # fmt: skip
    ((action, args),) = items("let a car drive along this route", PATH)
    assert (action, tuple(args["points"])) == ("dynamic/vehicle_on_path-v1", PATH.points)


def test_a_change_of_what_is_drawn_is_measured_and_the_same_each_time(built_town, tmp_path):
    hashes = set()
    for number in range(2):
        folder = copy_of(built_town(lod=1), tmp_path / str(number))
        report = edit_city(folder, "plant five oaks in this area", drawn=AREA)
        assert [goal["met"] for goal in report["goals_of_change"]] == [True]
        hashes.add(report["hash"])
    assert len(hashes) == 1
    before, after = (
        {*read_city(one / "city").scene.instances["trees"].object_id.tolist()}
        for one in (built_town(lod=1), folder)
    )
    trees = read_city(folder / "city").scene.instances["trees"]
    new = [row for row, one in enumerate(trees.object_id.tolist()) if one in after - before]
    assert len(new) == 5
    area = shapely.Polygon(AREA.points)
    assert shapely.contains_xy(area, trees.position[new][:, :2]).all()


@pytest.mark.parametrize(
    ("points", "area", "said"),
    [
        ([(0, 0)], False, "A path is drawn by 2 to 500 points"),
        ([(0, 0), (5, 5)], True, "An area is drawn by 3 to 500 points"),
        ([(0, 0), (float("nan"), 5)], False, "at most 100000 away"),
        ([(0, 0), (1e9, 5)], False, "at most 100000 away"),
        ([(3, 3), (3, 3)], False, "too small: 0.00 m"),
        ([(0, 0), (5, 0), (9, 0)], True, "too small: 0.00 m2"),
    ],
)
def test_what_is_no_path_and_no_area_is_refused(points, area, said):
    with pytest.raises(UsageError, match=said):
        drawn_of(points, area=area)
