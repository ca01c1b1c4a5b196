"""Rows along the open edges of paved plots."""

from types import SimpleNamespace

import numpy as np
import pytest
import shapely

from cityx.nature.furniture import plot_edges
from cityx.nature.furniture.plot_edges import BEHIND, SPACING, along_plots
from cityx.nature.land.frontages import Edges
from cityx.places.profiles import profile_named


@pytest.fixture
def city(monkeypatch):
    """Forty edges of 10 m along x, 20 m apart; the plots of every second one lie to the south.

    All is paved north of y = 0, and every fifth edge has a hedge.
    """
    lines = shapely.linestrings([[(0, y), (10, y)] for y in range(-400, 400, 20)])
    kind = np.array(["front_hedge" if n % 5 == 0 else "" for n in range(40)], object)
    side = np.where(np.arange(40) % 2, -1.0, 1.0)
    edges = Edges(lines, np.arange(40, dtype=np.uint64), kind, side)
    monkeypatch.setattr(plot_edges, "frontage_edges", lambda _: edges)
    ground = SimpleNamespace(on=lambda xy, *_: xy[:, 1] > 0)
    return SimpleNamespace(seed=1, ground=ground), edges


def test_rows_stand_evenly_behind_open_edges_of_paved_plots_alone(city):
    town, edges = city
    found = along_plots(town, profile_named("world").furniture)
    assert len(set(found.name.tolist())) > 2
    assert (found.xy[:, 1] > 0).all()
    number = np.round((found.xy[:, 1] + 400) / 20).astype(int)
    assert (edges.kind[number] == "").all()
    behind = (found.xy[:, 1] - (20 * number - 400)) * edges.side[number]
    assert behind == pytest.approx([BEHIND[str(name)] for name in found.name])
    for row in np.unique(number):
        name = set(found.name[number == row].tolist())
        assert len(name) == 1
        step = np.diff(np.sort(found.xy[number == row, 0]))
        assert step == pytest.approx(np.full(len(step), SPACING[name.pop()]))


def test_rows_are_the_same_each_time_and_have_ids_of_their_own(city):
    one, again = (along_plots(city[0], profile_named("jp").furniture) for _ in range(2))
    assert one.xy.tobytes() == again.xy.tobytes()
    assert (one.id == again.id).all()
    assert len(np.unique(one.id)) == len(one) > 10
