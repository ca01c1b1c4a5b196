"""Nobody waits for good in a junction: for a nose that is in it, or where its own way ends."""

import numpy as np
import pytest

from cityx.sim.kernels import tables as rows
from cityx.sim.kernels.tables import ALIVE, ALONG, AT, CLEARED, LENGTH, PIECE, POINT, SIZE, SPEED


@pytest.fixture
def nosed(engine, world):
    """Return an engine whose agent has its nose a metre in a way across that another crosses."""

    def made(over=1.0):
        found = engine(traffic=1)
        real, whole, path = found.state.real[0], found.state.whole[0], found.state.path[0]
        found.map = found.map._replace(signal=np.full_like(found.map.signal, -1))
        across = int(np.flatnonzero(world.across & (np.diff(world.conflict_start) > 0))[0])
        lane = int(np.flatnonzero(world.piece_lane == world.piece_lane[across])[0])
        along = world.piece_length[lane] + over - real[LENGTH, 0] / 2
        points = world.point[slice(*world.point_start[lane : lane + 2])]
        at = int(np.clip(np.searchsorted(points[:, 4], along) - 1, 0, len(points) - 2))
        real[[rows.X, rows.Y, rows.Z, rows.HEADING], 0] = points[at, :4]
        for axis, row in ((0, rows.X), (1, rows.Y)):
            real[row, 0] = np.interp(along, points[:, 4], points[:, axis])
        real[SPEED, 0], real[ALONG, 0], real[rows.GOAL, 0] = 0.0, along, 500.0
        path[0, :2] = lane, across
        whole[AT, 0], whole[SIZE, 0], whole[PIECE, 0] = 0, 2, lane
        whole[POINT, 0], whole[ALIVE, 1] = world.point_start[lane] + at, 0
        return found, across

    return made


def test_an_agent_whose_nose_is_in_a_junction_is_let_onto_it(nosed):
    stands = np.array([[[0.0, -1.0]]])
    engine, across = nosed()
    engine.step(stands, anew=False)
    assert engine.state.whole[0, CLEARED, 0] == across
    engine, _ = nosed(over=-1.0)
    engine.step(stands, anew=False)
    assert engine.state.whole[0, CLEARED, 0] == -1


def test_it_waits_while_somebody_is_on_a_way_that_crosses_it(nosed, world):
    engine, across = nosed()
    real, whole = engine.state.real[0], engine.state.whole[0]
    other = int(world.conflict[world.conflict_start[across]])
    whole[ALIVE, 1], whole[PIECE, 1], whole[SIZE, 1] = 1, other, 1
    engine.state.path[0, 1, 0] = other
    whole[POINT, 1], whole[rows.STEPS, 1] = world.point_start[other], -1
    real[[rows.X, rows.Y, rows.Z, rows.HEADING], 1] = world.point[world.point_start[other], :4]
    real[ALONG, 1] = real[SPEED, 1] = 0.0
    engine.step(np.array([[[0.0, -1.0]]]), anew=False)
    assert whole[CLEARED, 0] == -1


def test_traffic_takes_no_way_across_that_leads_onto_none_of_its_lanes(engine, world):
    usable = engine().map.usable
    for across in np.flatnonzero(world.across).tolist():
        onto = world.next[slice(*world.next_start[across : across + 2])]
        for kind in range(usable.shape[1]):
            assert usable[across, kind] < 2 or (usable[onto, kind] == 2).any()
