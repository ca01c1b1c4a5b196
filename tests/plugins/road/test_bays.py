"""Parking bays and the lines between them."""

import numpy as np
import pytest
import shapely

from cityx.city import City, Frame, make_table
from cityx.city.ground import LABEL
from cityx.geometry.standing import stand_on
from cityx.plugins.road.bays import LAYER, LINE, lot_bays, with_bay_lines
from cityx.plugins.road.ground import ground
from cityx.plugins.road.yards import BAY, STALL

STREET = [([(-80, -60), (80, -60)], {})]


@pytest.fixture
def lot(layout_of):
    """A car park of two rows with an aisle between them."""
    layout = layout_of(STREET)
    areas = make_table("areas", [shapely.box(-20, 0, 20, 16)], id=[7], kind=["parking"])
    city = City("lot", Frame(48.0, 11.0), layout.__class__(layout.extent, roads=layout.roads,
                areas=areas), lod=2)  # fmt: skip
    return ground(city)


def test_two_rows_of_bays_face_the_ends_of_their_car_park(lot):
    bays = lot_bays(lot)
    rows, count = np.unique(np.round(bays.xy[:, 1], 3), return_counts=True)
    assert rows.tolist() == [STALL / 2, 16 - STALL / 2]
    assert (count == count[0]).all()
    assert np.diff(np.sort(bays.xy[bays.xy[:, 1] < 8, 0])) == pytest.approx(BAY)
    ahead = -np.cos(bays.yaw)
    assert (np.sign(ahead) == np.where(bays.xy[:, 1] < 8, -1, 1)).all()


def test_neighbours_share_a_line_and_all_lie_on_asphalt(lot):
    bays = lot_bays(lot)
    mesh = with_bay_lines(lot, bays).scene.meshes[LAYER]
    lines = len(bays.id) + 2  # one at the end of each row
    assert len(mesh.vertices) == 6 * lines
    under = stand_on(lot.scene.meshes["ground"], mesh.vertices[:, :2])
    assert (under.label == LABEL["parking"]).all()
    assert mesh.vertices[:, 2] == pytest.approx(under.z + 0.012, abs=1e-6)
    x = np.unique(np.round(mesh.vertices[:, 0], 3))
    assert np.diff(x).min() == pytest.approx(LINE, abs=1e-6)


def test_a_city_without_car_parks_has_no_lines(layout_of):
    city = ground(City("bare", Frame(48.0, 11.0), layout_of(STREET), lod=2))
    assert LAYER not in with_bay_lines(city, lot_bays(city)).scene.meshes
