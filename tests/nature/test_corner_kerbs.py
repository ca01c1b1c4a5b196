import numpy as np
import pytest

from cityx.ground.street_rules import FRONT_LINE
from cityx.nature.furniture.corner_kerbs import TO_LINE, in_kerb_line


def test_things_near_the_kerb_join_its_line_and_face_the_street(crossroads):
    network = crossroads.network
    edge = int(np.argmax(np.diff(network.point_start)))
    points = network.edge_points(edge)
    middle, ahead = points.mean(axis=0), points[-1] - points[0]
    ahead = ahead / np.hypot(*ahead)
    left = np.array([-ahead[1], ahead[0]])
    half = network.half_width[edge]
    line = half + FRONT_LINE + 0.3
    away = np.array([[line + 1.0], [line + TO_LINE + 0.5], [half + 200.0]])
    xy = middle + away * left
    moved, turned = in_kerb_line(network, xy, np.full(3, 0.3), np.full(3, 9.0))
    off = (moved - middle) @ left
    assert off[0] == pytest.approx(line, abs=1e-6)
    assert off[1:] == pytest.approx(away[1:, 0])
    faced = np.column_stack([np.sin(turned[:2]), -np.cos(turned[:2])])
    assert faced == pytest.approx(np.array([-left, -left]), abs=1e-6)
    assert turned[2] == 9.0


def test_things_stay_without_streets():
    xy, turn = np.ones((1, 2)), np.ones(1)
    assert in_kerb_line(None, xy, np.ones(1), turn) == (xy, turn)
