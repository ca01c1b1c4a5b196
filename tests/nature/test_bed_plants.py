from dataclasses import replace

import numpy as np
import pytest
import shapely

from cityx.city import make_table
from cityx.city.ground import LABEL
from cityx.nature.trees import planting
from cityx.nature.trees.planting import bed_stands
from cityx.nature.trees.stands import BUSHES, INDEX, join_stands
from cityx.road.ground.beds import CORNER, bed_slots
from cityx.road.ground.ground_surface import ground
from cityx.road.network.network import network


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


def test_most_square_beds_at_corners_have_a_tree_amid_their_bushes(planted, monkeypatch):
    city, _ = planted
    beds = bed_slots(city.layout, city.network)
    square = replace(beds, half=np.full_like(beds.half, CORNER))
    monkeypatch.setattr(planting, "bed_slots", lambda *_: square)
    corners = square.take(city.ground.on(square.middle, "bed"))
    stand = join_stands(bed_stands(city))
    bush = np.isin(stand.species, [INDEX[name] for name in BUSHES])
    places = np.round(corners.middle, 6).tolist()
    with_tree = [xy in places for xy in np.round(stand.xy[~bush], 6).tolist()]
    assert all(with_tree)
    assert 0.4 < len(with_tree) / len(corners.id) < 0.9
    assert bush.sum() == 4 * len(corners.id)
    assert stand.mapped.all()  # or nothing would stand near junctions
    assert len(np.unique(stand.id)) == len(stand.id)
