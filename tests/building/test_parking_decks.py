"""Bays on the decks of car parks."""

from types import SimpleNamespace

import numpy as np
import pytest
import shapely
from shapely.affinity import rotate, translate

from cityx.assets.trims.roof_furniture import DECK_BAY, DECK_ROWS, DECK_STALL, REACH
from cityx.building.parking_decks import AISLE, EDGE, deck_rows
from cityx.building.roofs.rooftop import _axes

TURN = np.radians(20.0)


@pytest.fixture
def volumes():
    """A deck of 60 m by 36 m, turned, with a tower of stairs in a corner; a small one beside it."""
    spin = np.array([[np.cos(TURN), np.sin(TURN)], [-np.sin(TURN), np.cos(TURN)]])
    boxes = [shapely.box(-30, -18, 30, 18), shapely.box(24, 12, 30, 18), shapely.box(50, 0, 60, 10)]
    shapes = np.array([shapely.transform(each, lambda p: p @ spin) for each in boxes], object)
    return SimpleNamespace(polygons=shapes, top=np.array([6.0, 9.0, 6.0]))


def laid(volumes):
    decks = np.array([0, 2])
    deck = np.array([5.8, 9.0, 5.8])
    return deck_rows(
        1, volumes, np.arange(3, dtype=np.uint64), decks, deck, _axes(volumes.polygons)
    )


def test_rows_of_bays_lie_within_the_deck_in_pairs_with_aisles(volumes):
    part, piece, x, y, z, height, yaw, number = laid(volumes)
    assert len(part) > 10
    assert set(part.tolist()) == {0}  # nobody drives on so small a one
    names = np.array(list(REACH))[piece]
    assert set(names.tolist()) == {*DECK_ROWS, "deck_ramp"}
    assert (names == "deck_ramp").sum() == 1
    assert (z == 5.8).all()
    assert (height == 1).all()
    assert len(np.unique(number)) == len(number)
    u = np.column_stack([np.cos(yaw), np.sin(yaw)])
    v = np.column_stack([-u[:, 1], u[:, 0]])
    middle = np.column_stack([x, y])
    half = np.array([2 * DECK_BAY, DECK_STALL / 2])
    corners = np.stack([middle + i * half[0] * u + j * half[1] * v
                        for i, j in ((-1, -1), (1, -1), (1, 1), (-1, 1))], axis=1)  # fmt: skip
    bays = shapely.polygons(corners)
    inside = shapely.buffer(volumes.polygons[0], -EDGE + 1e-6, join_style="mitre")
    assert shapely.covers(inside, bays).all()
    assert not shapely.intersects(bays, volumes.polygons[1]).any()
    held = shapely.buffer(bays, -0.01)  # rows back to back touch
    one, _ = shapely.STRtree(held).query(held, predicate="intersects")
    assert len(one) == len(bays)
    across = np.unique(np.round(middle @ [-np.sin(TURN), np.cos(TURN)], 3))
    assert np.diff(across).max() == pytest.approx(DECK_STALL + AISLE, abs=0.01)


def bays_of(found):
    """Outlines of rows, and of the aisles before them."""
    x, y, yaw = found[2], found[3], found[6]
    wide, deep = 2 * DECK_BAY, DECK_STALL / 2
    shapes = []
    for box in (shapely.box(-wide, -deep, wide, deep),
                shapely.box(-wide, -deep - AISLE, wide, -deep)):  # fmt: skip
        shapes.append([translate(rotate(box, w, (0, 0), use_radians=True), a, b)
                       for a, b, w in zip(x, y, yaw, strict=True)])  # fmt: skip
    return shapes


def test_every_row_opens_to_an_aisle_of_the_deck(volumes):
    rows, aisles = bays_of(laid(volumes))
    assert shapely.covers(shapely.buffer(volumes.polygons[0], 1e-6), aisles).all()
    held = shapely.buffer(rows, -0.01)
    assert not len(shapely.STRtree(held).query(aisles, predicate="intersects")[0])


def test_a_wing_has_rows_of_its_own():
    leg, wing = shapely.box(0, 0, 60, 13), shapely.box(60, -30, 92, 13)
    shapes = np.array([leg, shapely.union(leg, wing)], object)
    count = []
    for shape in shapes:
        one = SimpleNamespace(polygons=np.array([shape], object), top=np.array([6.0]))
        found = deck_rows(1, one, np.ones(1, np.uint64), np.zeros(1, np.int64), np.array([5.8]),
                          _axes(one.polygons))  # fmt: skip
        rows = bays_of(found)[0]
        assert shapely.covers(shape, rows).all()
        held = shapely.buffer(rows, -0.01)
        assert len(shapely.STRtree(held).query(held, predicate="intersects")[0]) == len(rows)
        count.append(int(shapely.intersects(wing, shapely.centroid(rows)).sum()))
    assert count[0] == 0
    assert count[1] >= 4


def test_decks_are_the_same_each_time(volumes):
    assert laid(volumes)
    for one, again in zip(laid(volumes), laid(volumes), strict=True):
        assert one.tobytes() == again.tobytes()
