"""Traffic from outside: tracks of the city go as they went; SUMO drives among the agents."""

from collections import deque
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from cityx.city.store import read_city, write_city
from cityx.city.tracks import MOVER, Tracks
from cityx.errors import UsageError
from cityx.motion.live_traffic import lanes_a_street
from cityx.motion.vehicles import halts_of
from cityx.sim.engine import Engine
from cityx.sim.kernels import tables as rows
from cityx.sim.options import FleetOptions, options_of
from cityx.sim.others import Recorded
from cityx.sim.sources import source_of
from cityx.sim.tasks import engine_of
from cityx.traffic.laying import streets_of
from cityx.traffic.live import Live
from cityx.traffic.network import make_network
from cityx.traffic.session import signals_of
from cityx.traffic.simulation import WARM

SPEED = 8.0


@pytest.fixture(scope="module")
def route(world):
    """Three pieces, one after the other: a lane, a way across and a lane."""
    for lane in np.flatnonzero(~world.across & (world.piece_length > 40.0)).tolist():
        for across in world.next[slice(*world.next_start[lane : lane + 2])].tolist():
            onto = int(world.next[world.next_start[across]])
            if world.piece_length[onto] > 40.0:
                return lane, across, onto
    raise AssertionError("no two long lanes follow each other")


@pytest.fixture(scope="module")
def tracks(world, route):
    """A car that goes along the three pieces at one speed."""
    parts = [world.point[slice(*world.point_start[piece : piece + 2])] for piece in route]
    place = np.concatenate([np.full(len(part), world.piece_lane[piece] * (piece != route[1]))
                            for piece, part in zip(route, parts, strict=True)])  # fmt: skip
    point = np.concatenate(parts)
    step = np.r_[0.0, np.hypot(*np.diff(point[:, :2], axis=0).T)]
    own = np.r_[True, step[1:] > 1e-6]
    point, place, time = point[own], place[own].astype(np.uint64), np.cumsum(step)[own] / SPEED
    count = len(time)
    return Tracks(
        np.array([7], np.uint64), np.array([MOVER["car"]], np.uint8), np.array(["car"]),
        np.array(["hand"]), np.zeros((1, 3), np.float32),
        np.array([[4.5, 1.8, 1.5]], np.float32), np.array([0, count]), time, point[:, :3],
        point[:, 3], np.full(count, SPEED, np.float32), np.zeros(count, np.uint8), place,
    )  # fmt: skip


def engine_with(world, tracks, worlds=1, seed=0):
    options = options_of({"source": "tracks", "goal_m": 60.0})
    found = Engine(world, options, worlds, 1, None, Recorded(tracks, "by hand"))
    found.seed(seed)
    found.begin()
    return found


def test_a_recorded_car_goes_as_it_went_and_is_on_its_lanes(world, tracks, route):
    engine = engine_with(world, tracks)
    seen = set()
    for _ in range(int(tracks.duration * 10)):
        engine.step(np.zeros((1, 1, 2)), anew=False)
        real, whole = engine.state.real[0], engine.state.whole[0]
        if not whole[rows.ALIVE, 1]:
            continue
        moment = float(engine.state.clock[0])
        spot = [np.interp(moment, tracks.time, tracks.position[:, axis]) for axis in (0, 1)]
        assert np.allclose(real[[rows.X, rows.Y], 1], spot, atol=1e-6)
        assert real[rows.SPEED, 1] == SPEED
        seen.add(int(whole[rows.PIECE, 1]))
    assert seen == set(route)


def test_the_same_seed_gives_the_same_views_and_worlds_are_those_of_their_seeds(world, tracks):
    pair, alone = engine_with(world, tracks, worlds=2, seed=3), engine_with(world, tracks, seed=4)
    for _ in range(40):
        pair.step(pair.act_by_rule())
        alone.step(alone.act_by_rule())
        assert np.array_equal(pair.view[1], alone.view[0])
    assert pair.state.clock[0] != pair.state.clock[1]


def test_places_in_which_nothing_moves_are_refused_in_a_sentence(town, world):
    with pytest.raises(UsageError, match=r'nothing moves in ".*"\. Build it so'):
        engine_of("drive", 1, 1, {"place": town, "source": "tracks"})
    with pytest.raises(UsageError, match="A world has no tracks"):
        source_of(world, world, options_of({"source": "tracks"}))
    with pytest.raises(UsageError, match='source is "sumo", which reads the city from disk'):
        source_of(world, world, options_of({"source": "sumo"}))
    with pytest.raises(UsageError, match='source is "track"; known are rules, tracks, sumo'):
        options_of({"source": "track"})
    with pytest.raises(UsageError, match='source is "sumo"; known are rules'):
        options_of({"source": "sumo", "bodies": {"car": 1}}, FleetOptions())


def test_density_counts_vehicles_by_the_lane_for_sumo_as_for_the_rules(town, world):
    city = read_city(town / "city")
    streets = streets_of(city, halts_of(city))
    length = {way.edge: way.length for way in streets.ways}
    lanes = world.piece_length[~world.across & world.piece_public].sum()
    assert lanes_a_street(streets) * sum(length.values()) == pytest.approx(lanes, rel=0.1)


@pytest.mark.sumo
def test_sumo_drives_among_the_agents_the_same_for_the_same_seed(town, tmp_path):
    pytest.importorskip("libsumo")
    options = {"source": "sumo", "density": 10.0}
    with pytest.raises(UsageError, match="signals without a plan that SUMO made"):
        engine_of("drive", 1, 1, {"place": town, **options})
    city = read_city(town / "city")
    streets = streets_of(city, halts_of(city))
    network = make_network(streets, city.frame, tmp_path)
    signals = signals_of(city, streets, network, WARM)
    write_city(replace(city, signals=signals), tmp_path / "town" / "city")
    with pytest.raises(UsageError, match="Leave traffic out"):
        engine_of("drive", 1, 1, {"place": tmp_path / "town", **options, "traffic": 5})
    engine = engine_of("drive", 1, 1, {"place": tmp_path / "town", **options})
    try:
        tracks = []
        for _ in range(2):
            engine.seed(5)
            engine.begin()
            found = []
            for _ in range(30):
                engine.step(engine.act_by_rule(), anew=False)
                found.append((engine.view.copy(), engine.state.real.copy()))
            tracks.append(found)
        whole = engine.state.whole[0]
        assert whole[rows.ALIVE, 1:].sum() >= 2
        assert (whole[rows.PIECE, 1:] >= 0).any()
        moved = tracks[0][-1][1][0, rows.X] - tracks[0][0][1][0, rows.X]
        assert np.abs(moved[1:]).max() > 0.5
        for one, other in zip(*tracks, strict=True):
            assert np.array_equal(one[0], other[0])
            assert np.array_equal(one[1], other[1])
    finally:
        engine.close()


def test_trips_begin_anew_under_other_names_where_all_have_been_made():
    trips = [{"id": "a0", "route": ["x"]}, {"id": "a3", "route": ["y"]}]
    live = Live({"groups": [{"trips": trips}, {"trips": []}]}, {})
    filling = SimpleNamespace(waiting=[deque(), deque()])
    live._driven = SimpleNamespace(filling=filling)
    named = []
    for _ in range(3):
        live._refill()
        live._refill()  # nothing to do
        named += [trip["id"] for trip in filling.waiting[0]]
        filling.waiting[0].clear()
    assert len(set(named)) == 6
    assert not filling.waiting[1]
    assert [int(name, 16) & 1 for name in named] == [0, 1] * 3  # the bit that tells of a kind
