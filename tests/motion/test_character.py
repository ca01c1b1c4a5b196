import re

import numpy as np
import pytest
import shapely

from cityx.assets.vehicles.movers import person_of
from cityx.city.content import content_hash
from cityx.city.moments import moments_of
from cityx.city.tracks import GAIT, MOVER, join_tracks
from cityx.errors import ActionFailed
from cityx.ground.walking.crosswalks import FOOTWAYS
from cityx.motion.character import SIDEWAYS, add_characters
from cityx.protocol import registry
from cityx.protocol.gate import Call
from cityx.protocol.running import run_step

PAPER = {
    "crowd_creation": "single", "walk_run": "run", "style": "casual",
    "category": "run, male_jog02", "model_quality": "high_poly", "random_color": True,
}  # fmt: skip
CURVE = ((-30.0, -50.0), (-10.0, -46.0), (10.0, -52.0), (30.0, -48.0))


def arc_speeds(tracks, row=0):
    """Metres per second between the samples of one mover."""
    own = tracks.take(np.array([row]))
    return np.hypot(*np.diff(own.position[:, :2], axis=0).T) / np.diff(own.time)


def test_the_papers_call_returns_one_running_man_who_is_made_once(park):
    city, ids = add_characters(park, path="curve01", points=CURVE, **PAPER)
    tracks = city.tracks
    assert tracks.object_id.tolist() == list(ids)
    assert len(ids) == 1
    assert tracks.kind.tolist() == [MOVER["pedestrian"]]
    assert set(tracks.gait.tolist()) == {GAIT["run"]}
    assert person_of(str(tracks.look[0])).sex == "male"
    assert str(tracks.look[0]).endswith("_fine")
    assert tracks.tint.tolist() != [[1, 1, 1]]
    assert park.tracks is None


def test_the_paper_s_call_passes_the_gate(park):
    args = {"path": "loop1", **PAPER}
    city = run_step(park, Call("dynamic/character-v1", args), registry())
    assert city.tracks.count == 1


@pytest.mark.parametrize(("walk_run", "speed"), [("run", 2.2), ("run", 4.8), ("walk", 1.1)])
def test_the_speed_along_the_arc_is_the_one_asked_for(park, walk_run, speed):
    city, _ = add_characters(park, path="loop1", walk_run=walk_run, speed=speed)
    assert arc_speeds(city.tracks) == pytest.approx(speed, rel=0.02)
    assert city.tracks.speed == pytest.approx(speed, rel=0.02)


def test_curvature_limits_the_speed_and_only_there(park):
    corner = ((-40.0, 0.0), (0.0, 0.0), (0.0, 40.0))
    city, _ = add_characters(park, path="corner", points=corner, walk_run="run", speed=5.0)
    tracks = city.tracks
    away = np.hypot(*tracks.position[:, :2].T)
    assert tracks.speed[away > 12] == pytest.approx(5.0, rel=0.02)
    assert tracks.speed[away < 0.3].max() < 2.0
    turn = np.abs(np.diff(np.unwrap(tracks.heading))) / np.diff(tracks.time)
    mean = (tracks.speed[1:] + tracks.speed[:-1]) / 2
    assert (turn * mean).max() < 1.3 * SIDEWAYS


def test_a_runner_faces_the_way_it_goes(park):
    city, _ = add_characters(park, path="loop1", walk_run="run")
    tracks = city.tracks
    step = np.diff(tracks.position[:, :2], axis=0)
    ahead = np.arctan2(step[:, 1], step[:, 0])
    middle = (np.unwrap(tracks.heading)[1:] + np.unwrap(tracks.heading)[:-1]) / 2
    assert np.cos(ahead - middle).min() > np.cos(np.radians(3))


def test_around_the_park_is_the_closed_path_in_it(park):
    city, _ = add_characters(park, path="along the path around the park", walk_run="run")
    spots = shapely.points(city.tracks.position[:, :2])
    (row,) = np.flatnonzero(park.layout.roads["name"] == "loop1")
    assert shapely.distance(spots, park.layout.roads.geometry.iloc[row]).max() < 0.5
    assert city.tracks.duration == 60.0
    assert city.tracks.position[:, 2] == pytest.approx(0.12)  # on the path, not in it


def test_along_a_street_people_walk_on_its_sidewalk(park):
    city, _ = add_characters(park, path="x1", count=9)
    at = city.tracks.position[:, :2]
    on = park.ground.on(at, *FOOTWAYS)
    assert on.mean() > 0.85
    assert park.ground.on(at[~on], "junction", "carriageway", "marking").all()


def test_people_cross_a_plaza_that_no_path_crosses(park):
    city, ids = add_characters(park, path="across the plaza", count=20)
    (plaza,) = park.layout.areas.geometry[park.layout.areas["kind"] == "pedestrian"]
    spots = shapely.points(city.tracks.position[:, :2])
    assert len(ids) == 20
    assert shapely.covers(plaza, spots).all()
    assert np.ptp(city.tracks.position[:, :2], axis=0).max() > 0.8 * np.sqrt(plaza.area)
    again, _ = add_characters(park, path="plaza", count=20)
    assert np.array_equal(again.tracks.position, city.tracks.position)


def test_nobody_in_a_crowd_touches_another(park):
    city, ids = add_characters(park, path="loop1", crowd_creation="crowd", count=100)
    from cityx.city.tracks import poses_at

    assert len(ids) == 100
    for moment in (0.0, 7.3, 31.1, 60.0):
        tree = shapely.STRtree(shapely.points(poses_at(city.tracks, moment).position[:, :2]))
        pairs = tree.query(tree.geometries, predicate="dwithin", distance=0.55)
        assert len(pairs[0]) == 100  # each with itself alone


def test_a_crowd_is_of_many_looks(park):
    city, _ = add_characters(park, path="loop1", count=60, random_color=True)
    assert len(set(city.tracks.look.tolist())) > 25
    assert len(np.unique(city.tracks.tint, axis=0)) > 8


def test_a_second_call_adds_others_and_leaves_the_first_as_they_were(park):
    first, one = add_characters(park, path="loop1")
    second, two = add_characters(first, path="loop1", walk_run="run")
    assert not set(one) & set(two)
    row = second.tracks.object_id.tolist().index(one[0])
    kept = second.tracks.take(np.array([row]))
    assert kept.position.tobytes() == first.tracks.position.tobytes()


def test_the_same_seed_gives_the_same_bytes(park):
    made = [add_characters(park, path="loop1", count=20, random_color=True)[0] for _ in range(2)]
    assert content_hash(made[0]).total == content_hash(made[1]).total
    assert made[0].tracks.position.tobytes() == made[1].tracks.position.tobytes()


def test_who_stands_stays_where_it_is(park):
    city, _ = add_characters(park, path="loop1", walk_run="stand", count=5)
    for row in range(5):
        assert np.ptp(city.tracks.take(np.array([row])).position, axis=0).tolist() == [0, 0, 0]


REFUSED = [
    ({"path": "loop1", "count": 1_000_000},
     "1,000,000 characters do not fit on the path \"loop1\", which is 282 m long: 433 fit two "
     "abreast, 1.3 m apart. Ask for 433 at most."),
    ({"path": "nowhere"}, 'path = "nowhere" names no curve, no way and no place of the city.'),
    ({"path": "around the lake"}, 'the city has no lake. It has plaza, park.'),
    ({"path": "x", "points": ((-130.0, -20.0), (-90.0, -20.0))},
     r'It goes through the building "b\d+" at \(-130.0, -20.0\)'),
    ({"path": "x", "points": ((-70.0, -80.0), (70.0, -80.0))},
     r"It lies on carriageway for 140 m from \(-70.0, -80.0\): people cross it"),
    ({"path": "x", "points": ((0.0, 0.0), (0.0, 900.0))}, "It leaves the site towards"),
    ({"path": "loop1", "category": "fly, dragon_1"}, 'category = "fly, dragon_1" is none.'),
    ({"path": "loop1", "category": "run, male_jog02", "gender": "female"},
     'says run, walk_run says walk. .* says male, gender says female.'),
    ({"path": "loop1", "crowd_creation": "single", "count": 3}, "count says 3"),
    ({"path": "loop1", "walk_run": "stand", "speed": 2.0}, "Who stands has no speed"),
]  # fmt: skip


@pytest.mark.parametrize(("args", "said"), REFUSED)
def test_what_cannot_be_is_refused_with_what_would_be_right(park, args, said):
    before = content_hash(park).total
    with pytest.raises(ActionFailed, match=re.escape(said) if "\\" not in said and ".*" not in said
                       else said):  # fmt: skip
        add_characters(park, **args)
    assert content_hash(park).total == before


def test_a_path_through_water_is_refused_and_one_over_the_bridge_is_not(river):
    with pytest.raises(ActionFailed, match=r'into the water "river" at \(0.0, -16.0\)'):
        add_characters(river, path="ford", points=((0.0, -40.0), (0.0, 40.0)))
    city, _ = add_characters(river, path="over", points=((-117.0, -29.0), (-117.0, 29.0)))
    assert city.tracks.position[:, 2].min() > -0.5


WEST_EAST = ((-40.0, -50.0), (40.0, -50.0))
SOUTH_NORTH = ((0.0, -75.0), (0.0, -25.0))


def gaps(tracks, first, last):
    """Least distance of the middles of two people of two groups, metres, ten times a second."""
    found = moments_of(tracks, np.arange(0.0, tracks.duration, 0.1))
    mine = np.isin(tracks.object_id[found.mover], first)
    theirs = np.isin(tracks.object_id[found.mover], last)
    least = np.inf
    for number in np.unique(found.number):
        here = found.number == number
        one, other = found.position[mine & here, :2], found.position[theirs & here, :2]
        if len(one) and len(other):
            least = min(least, np.hypot(*(one[:, None] - other[None]).transpose(2, 0, 1)).min())
    return least


def test_crowds_on_crossing_paths_do_not_walk_through_each_other(park):
    city, first = add_characters(park, path="we", points=WEST_EAST, count=12)
    alone, other = add_characters(park, path="sn", points=SOUTH_NORTH, count=8)
    both = join_tracks([city.tracks, alone.tracks])
    assert gaps(both, first, other) < 0.4  # who does not look walks through the others
    city, last = add_characters(city, path="sn", points=SOUTH_NORTH, count=8)
    assert gaps(city.tracks, first, last) >= 0.44
    assert not [note for note in city.notes if "meet others" in note]
    for row in range(city.tracks.count):
        assert arc_speeds(city.tracks, row) == pytest.approx(1.4, rel=0.02)
    mine = city.tracks.take(np.isin(city.tracks.object_id, last))
    assert np.abs(mine.position[:, 0]).max() <= 0.36  # nobody has left the path


def test_who_cannot_wait_for_a_gap_is_told(park):
    city, _ = add_characters(park, path="we", points=WEST_EAST, count=20, walk_run="stand")
    city, _ = add_characters(city, path="we", points=WEST_EAST)
    assert [note for note in city.notes if "1 of 1 on the path" in note]
