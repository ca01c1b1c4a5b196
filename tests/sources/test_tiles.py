"""What lies beyond the reach that docs/tiles.md states decides nothing."""

import re
from dataclasses import replace
from pathlib import Path

import pytest
from cityx_bench.windows import box_about, compared

from cityx.city import City
from cityx.city.frame import NOWHERE
from cityx.sources.osm import read_osm
from cityx.tiles.actions import built, plan_of
from cityx.town.plane import Plan
from cityx.town.window import layout_of_window

PAGE = Path(__file__).parents[2] / "docs" / "tiles.md"
INNER = 70.0  # metres, half of the part that is compared
# Kinds of which one object is a whole site's, or the vertices of such a one beside the border.
WHOLE = {"meshes/ground", "vertices/surroundings", "meshes/surroundings"}


def reach():
    """Return the greatest reach in metres of the table of what is local."""
    local = PAGE.read_text().split("## Local")[1].split("## ")[0]
    rows = re.findall(r"^\| [^|]+ \| (\d+)(?! cells)[^|]* \|", local, flags=re.M)
    assert len(rows) > 10
    return max(map(float, rows))


def unequal(one, other, inner):
    return {
        kind: share
        for kind, share in compared(one, other, inner).items()
        if share[0] != share[1] and kind not in WHOLE
    }


def made(city, seed=0):
    return replace(city, seed=seed, lod=2, stages_done=frozenset({"layout", "terrain"}))


@pytest.mark.slow
def test_the_plane_beyond_the_reach_changes_nothing():
    x, y, seed = 40.0, -30.0, 0
    items, inner = plan_of([], 2, seed), box_about(x, y, INNER)
    boxes = [box_about(x, y, INNER + reach() + more) for more in (0.0, 130.0)]
    layouts = (layout_of_window(box, Plan(), seed, frame=NOWHERE) for box in boxes)
    near, far = (built(made(City("plane", NOWHERE, layout)), items) for layout in layouts)
    assert compared(near, far, inner)["layout/buildings"][1] > 5
    assert unequal(near, far, inner) == {}


@pytest.mark.slow
@pytest.mark.shared
def test_a_map_beyond_the_reach_changes_nothing(shared_osm):
    path = shared_osm("liechtenstein_latest.osm.gz")
    frame = read_osm(path).frame
    x, y = frame.to_local([[9.5215, 47.1410]])[0].round().tolist()
    items, inner = plan_of([path], 2), box_about(x, y, INNER)
    boxes = [box_about(x, y, INNER + reach() + more) for more in (0.0, 300.0)]
    near, far = (built(made(read_osm(path, frame=frame, box=box)), items) for box in boxes)
    assert compared(near, far, inner)["layout/buildings"][1] > 5
    assert unequal(near, far, inner) == {}
