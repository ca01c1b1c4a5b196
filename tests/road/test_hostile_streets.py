"""Maps that no street looks like: built without a crash, plausibly."""

import numpy as np
import pytest

from cityx.city.ground import LABEL
from cityx.ground.arrangement import check_arrangement, face_areas
from cityx.road.ground.ground_surface import ground
from cityx.road.network.lane_graph import lanes
from cityx.road.network.network import network

CROSS = [(0, -90), (0, 90)]
STREETS = {
    "a road of 64 lanes": [([(-90, 0), (0, 0), (90, 0)], {"lanes": 64, "width": 60.0}),
                           ([CROSS[0], (0, 0), CROSS[1]], {})],
    "a way without length": [([(5, 5), (5, 5)], {}), ([(-90, 0), (90, 0)], {})],
    "a street that crosses itself": [([(-80, -40), (60, 40), (60, -40), (-80, 40)], {})],
    "a street that crosses itself at a node": [
        ([(-80, -40), (0, 0), (60, 40), (60, -40), (0, 0), (-80, 40)], {})
    ],
    "a street that doubles back": [([(-80, 0), (80, 0), (-80, 0.5)], {})],
    "twelve arms": [([(0, 0), (90 * np.cos(a), 90 * np.sin(a))], {})
                    for a in np.arange(12) * np.pi / 6],
    "arms at one degree": [([(0, 0), (90 * np.cos(a), 90 * np.sin(a))], {})
                           for a in np.radians([0, 1, 2, 180])],
    "a ring of two points": [([(0, 0), (8, 0), (0, 0)], {"roundabout": True, "oneway": True}),
                             ([(8, 0), (90, 0)], {})],
    "streets shorter than they are wide": [
        ([(2.0 * k, 0), (2.0 * k + 2.0, 0)], {"width": 12.0}) for k in range(12)
    ] + [([(2.0 * k, 0), (2.0 * k, 60)], {}) for k in range(0, 12, 3)],
}  # fmt: skip


@pytest.mark.parametrize("name", list(STREETS))
def test_it_is_built_without_gaps(name, layout_of, city_of):
    city = ground(lanes(network(city_of(layout_of(STREETS[name])))))
    assert check_arrangement(city.ground) == (0, 0, 0.0)
    area = np.bincount(city.ground.face_label, face_areas(city.ground), minlength=len(LABEL))
    driven = sum(area[LABEL[word]] for word in ("carriageway", "junction", "marking"))
    assert 60.0 < driven < 200.0**2
    assert np.isfinite(city.scene.meshes["ground"].vertices).all()
    again = ground(lanes(network(city_of(layout_of(STREETS[name])))))
    assert again.ground.vertices.tobytes() == city.ground.vertices.tobytes()
    assert again.ground.face_label.tobytes() == city.ground.face_label.tobytes()
