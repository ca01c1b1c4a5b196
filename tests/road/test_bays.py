"""Parking bays and the lines between them."""

import numpy as np
import pytest
import shapely
import shapely.affinity

from cityx.city import City, Frame, make_table
from cityx.city.ground import LABEL
from cityx.city.thing_outlines import placed_outlines
from cityx.ground.standing import stand_on
from cityx.ground.walking.passage import in_lanes
from cityx.nature.trees.planting import trees
from cityx.road.ground.ground_surface import ground
from cityx.road.ground.yards import BAY, STALL
from cityx.road.parking.bays import (
    ISLAND_EVERY,
    LAYER,
    LINE,
    lot_bays,
    lot_islands,
    with_bay_lines,
)

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


# Whose lower edge is too far aslant for a row along it.
ASLANT = [(-20, 0), (20, 8), (20, 24), (-20, 24)]


@pytest.mark.parametrize(
    ("outline", "least"),
    [
        (shapely.Polygon(ASLANT), 22),
        (shapely.affinity.rotate(shapely.Polygon(ASLANT), 33.0), 22),
        (shapely.box(-20, 0, 20, 16), 28),
        (shapely.box(-20, 0, 20, 21), 28),
    ],
)
def test_a_car_park_is_laid_the_way_with_most_bays_and_each_has_its_aisle(
    outline, least, layout_of
):
    layout = layout_of(STREET)
    areas = make_table("areas", [outline], id=[7], kind=["parking"])
    city = City("lot", Frame(48.0, 11.0), layout.__class__(layout.extent, roads=layout.roads,
                areas=areas), lod=2)  # fmt: skip
    bays = lot_bays(city)
    assert len(bays.id) >= least
    assert len(np.unique(bays.id)) == len(bays.id)
    # Whoever backs out has the aisle behind: no other bay within 5 m of the tail.
    ahead = np.column_stack([np.sin(bays.yaw), -np.cos(bays.yaw)])
    behind = bays.xy - ahead * (STALL / 2 + 2.5)
    gap = np.hypot(*np.moveaxis(behind[:, None] - bays.xy[None], 2, 0))
    assert gap.min() > 2.5
    assert shapely.contains_xy(outline.buffer(0.1), *behind.T).all()


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


@pytest.fixture
def large(layout_of):
    """A car park of two rows of nearly fifty."""
    layout = layout_of(STREET)
    areas = make_table("areas", [shapely.box(-60, 0, 60, 16)], id=[7], kind=["parking"])
    city = City("large", Frame(48.0, 11.0), layout.__class__(layout.extent, roads=layout.roads,
                areas=areas), lod=2)  # fmt: skip
    return ground(city)


def test_a_large_car_park_has_islands_at_the_ends_of_rows_and_between(large, lot):
    bays, islands = lot_bays(large), lot_islands(large)
    assert not len(lot_islands(lot).id)
    assert not set(bays.id.tolist()) & set(islands.id.tolist())
    for y in (STALL / 2, 16 - STALL / 2):
        row = np.sort(islands.xy[np.isclose(islands.xy[:, 1], y), 0])
        every = np.sort(bays.xy[np.isclose(bays.xy[:, 1], y), 0])
        assert row[0] < every[0]
        assert row[-1] > every[-1]
        gaps = np.diff(row) / BAY
        assert np.allclose(gaps[:-1], ISLAND_EVERY)
        assert ISLAND_EVERY / 2 <= gaps[-1] <= 1.5 * ISLAND_EVERY
        both = np.sort(np.concatenate([row, every]))
        assert np.diff(both) == pytest.approx(BAY)  # an island takes the place of a bay


def test_a_tree_stands_on_each_island_clear_of_lanes(large):
    islands = lot_islands(large)
    made = trees(large, budget=0).scene
    rows, pits = made.instances["trees"], made.instances["tree_pits"]
    assert rows.count == pits.count == len(islands.id) > 8
    gap = np.abs(rows.position[:, None, :2] - islands.xy).sum(axis=2).min(axis=1)
    assert gap.max() < 1e-6
    names = {made.prototypes[number].name for number in pits.prototype.tolist()}
    assert names == {"lot_island"}
    kinds = {made.prototypes[number].name.split("_")[1] for number in rows.prototype.tolist()}
    assert len(kinds) == 1
    outlines, xy, _ = placed_outlines(made)
    assert not in_lanes(large, outlines, xy).any()
    again = trees(large, budget=0).scene.instances
    assert again["tree_pits"].position.tobytes() == pits.position.tobytes()
    assert again["trees"].object_id.tobytes() == rows.object_id.tobytes()
