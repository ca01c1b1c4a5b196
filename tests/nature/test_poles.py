from dataclasses import replace

import numpy as np
import pytest

from cityx.city import Frame
from cityx.nature.furniture.poles import KINDS, WIRES
from cityx.nature.furniture.street_pieces import LAYER, street_pieces
from cityx.road.ground.ground_surface import ground


@pytest.fixture(scope="module")
def tokyo(crossroads):
    network = replace(crossroads.network, half_width=np.full(4, 2.5))
    roads = crossroads.layout.roads.assign(
        sidewalk_left=0.0, sidewalk_right=0.0, parking_left=False, parking_right=False, width=5.0
    )
    layout = replace(crossroads.layout, roads=roads)
    city = replace(crossroads, frame=Frame(35.69, 139.75), layout=layout, network=network)
    return street_pieces(ground(city))


def poles(city):
    rows = city.scene.instances[LAYER]
    names = np.array([city.scene.prototypes[i].name for i in rows.prototype])
    return rows.position[np.isin(names, list(KINDS))]


def test_narrow_streets_of_japan_have_poles_at_one_side(tokyo):
    spots = poles(tokyo)
    assert len(spots) >= 8
    kerbside = np.abs(np.abs(spots[:, :2]).min(axis=1) - 2.78)
    assert kerbside.max() < 1e-6


def test_wires_hang_between_poles_above_the_street(tokyo):
    mesh = tokyo.scene.meshes["wires"]
    assert mesh.count == 4  # one object per street
    highest = max(above for _, above, _, _ in WIRES)
    assert mesh.vertices[:, 2].max() == pytest.approx(0.12 + highest, abs=0.15)
    assert mesh.vertices[:, 2].min() > 4.5


def test_other_countries_have_their_cables_below_ground(tokyo):
    berlin = street_pieces(replace(tokyo, frame=Frame(52.5, 13.4),
                                   scene=replace(tokyo.scene, instances={})))  # fmt: skip
    rows = berlin.scene.instances.get(LAYER)
    names = [] if rows is None else [berlin.scene.prototypes[i].name for i in rows.prototype]
    assert not set(KINDS) & set(names)
