from dataclasses import replace

import numpy as np
import pytest
import shapely

from cityx.city import make_table
from cityx.city.ground import LABEL
from cityx.plugins.nature.bed_plants import bed_stands
from cityx.plugins.nature.stands import BUSHES, INDEX, join_stands
from cityx.plugins.road.ground import ground
from cityx.plugins.road.network import network


@pytest.fixture
def planted(crossroads):
    shells = [shapely.box(x, y, x + 60, y + 60) for x in (-74, 14) for y in (-74, 14)]
    ids, layout = np.arange(21, 25), crossroads.layout
    houses = make_table("buildings", shells, id=ids, levels=[4] * 4, place=["urban"] * 4)
    parts = make_table("parts", shells, id=ids, building=ids, base=[0.0] * 4, top=[10.0] * 4,
                       walls=[True] * 4)  # fmt: skip
    town = replace(layout, buildings=houses, parts=parts, areas=layout.areas.iloc[:0])
    city = ground(network(replace(crossroads, layout=town)))
    return city, join_stands(bed_stands(city))


def test_beds_alone_are_planted(planted):
    city, stand = planted
    on = city.ground.on(stand.xy, "bed")
    assert on.all()
    bush = np.isin(stand.species, [INDEX[name] for name in BUSHES])
    assert city.ground.on(stand.xy[bush], "bed").all()
    # One sees over what stands near junctions.
    assert (stand.height[bush] <= 1.2).all()
    assert (city.ground.face_label == LABEL["bed"]).any()
    assert bush.any()


def test_the_same_seed_plants_the_same(planted):
    city, stand = planted
    again = join_stands(bed_stands(city))
    assert np.array_equal(stand.id, again.id)
    assert np.array_equal(stand.xy, again.xy)
