from dataclasses import replace

import numpy as np
import pytest
from planned_town import planned, stage, town

from cityx.city.camera import Camera
from cityx.dataset.plans.coverage import coverage_of
from cityx.dataset.shots import Shot


def shot(x, y, z, heading, pitch=0.0, hfov=1.2):
    return Shot("s", Camera("s", (x, y, z), heading, pitch, hfov, 640, 480), "s")


def test_a_view_along_a_street_sees_what_lies_ahead():
    seen = coverage_of(town(), stage(), [shot(-60.0, 0.0, 1.6, np.pi / 2)])
    # 640 pixels over 1.2 rad show a metre with 4 pixels up to 117 m away: the street but for its
    # first metres, which lie below the picture, and what the houses leave of the one across it.
    assert 105.0 < seen.seen < 140.0
    back = coverage_of(town(), stage(), [shot(-60.0, 0.0, 1.6, 3 * np.pi / 2)])
    assert back.seen < 10.0
    assert seen.headings.tolist() == [0, 0, 1, 0, 0, 0, 0, 0]


def test_a_house_hides_the_street_behind_it():
    south = shot(-21.0, 45.0, 3.0, np.pi)
    city = town()
    hidden = coverage_of(city, stage(), [south]).seen
    bare = replace(city.scene, meshes={k: v for k, v in city.scene.meshes.items()
                                       if k != "buildings"})  # fmt: skip
    from cityx.city.store import view_of
    from cityx.dataset.stage import stage_of

    empty = replace(city, scene=bare, tracks=None)
    free = coverage_of(empty, stage_of(view_of(empty)), [south]).seen
    assert hidden < 0.8 * free


def test_more_shots_of_a_plan_see_more():
    shots = planned("street", 40).shots
    some = [coverage_of(town(), stage(), shots[:count]) for count in (1, 5, 40)]
    shares = [coverage.share for coverage in some]
    assert 0 < shares[0] < shares[1] < shares[2] <= 1
    assert shares[2] > 0.8
    assert some[2].headings.sum() == 40
    assert some[0].street == pytest.approx(280.0, abs=30.0)


def test_no_shots_see_nothing():
    assert coverage_of(town(), stage(), []).share == 0.0
