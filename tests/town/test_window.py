"""Any window of the plane shows the same town."""

import subprocess
import sys

import numpy as np
import pytest
import shapely
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from cityx.city import Frame
from cityx.sources.features.tagged import tags_text
from cityx.town.plane import PATTERNS, Plan
from cityx.town.window import features_of_window, layout_of_window, origin_of

FRAME = Frame(50.0, 10.0)
PITCH = 330.0
FAR = settings(
    max_examples=3, deadline=None, suppress_health_check=[HealthCheck.too_slow], derandomize=True
)
PLANS = [
    Plan(),
    Plan(pattern="grid", river=True),
    Plan(pattern="radial", coast="south", shore=100.0),
    Plan(pattern="organic", lakes=0.2, river=True),
    Plan(pattern="cul_de_sac", density=0.4),
    Plan(pattern="superblock", density=0.9),
]


def around(x, y, half):
    return (x - half, y - half, x + half, y + half)


def shown(window, plan, seed, *, inside=None):
    """Every shape of a window by id: its bytes in millimetres of the plane, and its tags."""
    found = features_of_window(window, plan, seed)
    shift = np.array(origin_of(window), float)
    ids = found.ids().tolist()
    tags = [tags_text(own) for own in found.tags()]
    box = shapely.box(*(np.array(inside or window) - np.tile(shift, 2)))
    kept = shapely.within(found.shapes, box)
    places = np.array(
        [(np.rint(shapely.get_coordinates(s) * 1e4) + shift * 1e4).tobytes() for s in found.shapes],
        object,
    )
    return {
        key: (place, own)
        for key, place, own, keep in zip(ids, places, tags, kept, strict=True)
        if keep
    }


@FAR
@given(
    plan=st.sampled_from(PLANS),
    seed=st.integers(0, 2**31),
    cell=st.sampled_from([(0, 0), (7, -3), (10**4, 5), (-(10**6), 10**6), (10**8, -(10**8))]),
)
def test_a_place_is_the_same_alone_and_among_its_neighbours(plan, seed, cell):
    x, y = (round(index * PITCH / 10) * 10.0 for index in cell)
    own = around(x + 40.0, y - 30.0, 120.0)
    alone = shown(own, plan, seed)
    wide = shown(around(x + 40.0, y - 30.0, 360.0), plan, seed, inside=own)
    assert alone
    assert [key for key in alone if alone[key] != wide.get(key)] == []
    # What only the wider window shows are houses: one may belong to the window beside.
    more = [own for key, (_, own) in wide.items() if key not in alone]
    assert all('"building' in own for own in more)


def test_tiles_hold_every_building_once():
    plan, seed = Plan(), 4
    whole = layout_of_window((0.0, 0.0, 400.0, 300.0), plan, seed, frame=FRAME)
    tiles = [
        layout_of_window((x, y, x + 200.0, y + 150.0), plan, seed, frame=FRAME)
        for x in (0.0, 200.0)
        for y in (0.0, 150.0)
    ]
    ids = np.concatenate([tile.buildings["id"].to_numpy() for tile in tiles])
    assert len(ids) > 50
    assert sorted(ids.tolist()) == whole.buildings["id"].tolist()
    for table in ("buildings", "parts"):
        rows = {
            row["id"]: (row["geometry"].wkb, *row.drop("geometry").tolist())
            for tile in tiles
            for _, row in getattr(tile, table).iterrows()
        }
        other = {
            row["id"]: (row["geometry"].wkb, *row.drop("geometry").tolist())
            for _, row in getattr(whole, table).iterrows()
        }
        assert [key for key in other if str(rows[key]) != str(other[key])] == []


@pytest.mark.sweep(2)
@pytest.mark.parametrize("plan", PLANS[:4])
def test_roads_continue_across_the_border_of_two_windows(plan):
    seed, edge = 9, 150.0
    sides = [(-250.0, -250.0, edge, 250.0), (edge, -250.0, 550.0, 250.0)]
    ends = []
    for window in sides:
        roads = layout_of_window(window, plan, seed, frame=FRAME).roads
        border = shapely.LineString([(edge, -250.0), (edge, 250.0)])
        cut = shapely.intersection(roads.geometry.to_numpy(), border)
        points, row = shapely.get_coordinates(cut, return_index=True)
        about = roads[["kind", "width", "sidewalk_left", "name"]].iloc[row]
        order = np.lexsort((about["name"], np.round(points[:, 1], 2)))
        ends.append((points[order], about.to_numpy()[order]))
    (here, own), (there, other) = ends
    assert len(here) >= 3
    assert np.abs(here - there).max() <= 1e-3
    assert (own == other).all()


def test_another_process_lays_out_the_same_town():
    text = (
        "from cityx.city import Frame\nfrom cityx.town.plane import Plan\n"
        "from cityx.town.window import layout_of_window\nimport hashlib, shapely\n"
        "box, plan = (-90, -90, 90, 90), Plan(river=True)\n"
        "made = layout_of_window(box, plan, 3, frame=Frame(50.0, 10.0))\n"
        "total = hashlib.sha256()\n"
        "for name in ('buildings', 'parts', 'roads', 'areas', 'lines', 'points'):\n"
        "    table = getattr(made, name)\n"
        "    total.update(b''.join(shapely.to_wkb(table.geometry.to_numpy()).tolist()))\n"
        "    total.update(table.drop(columns='geometry').to_csv().encode())\n"
        "print(total.hexdigest())\n"
    )
    runs = [
        subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, check=True)
        for _ in range(2)
    ]
    assert runs[0].stdout == runs[1].stdout
    assert len(runs[0].stdout) > 60


@pytest.mark.sweep(2)
@pytest.mark.parametrize("pattern", PATTERNS)
def test_nothing_overlaps(pattern):
    plan, window = Plan(pattern=pattern), around(0, 0, 200.0)
    found = features_of_window(window, plan, 6)
    houses = found.shapes[["building" in own for own in found.tags()]]
    roads = layout_of_window(window, plan, 6, frame=FRAME).roads
    surface = shapely.buffer(
        roads.geometry.to_numpy(), roads["width"].to_numpy() / 2, cap_style="flat"
    )
    first, second = shapely.STRtree(houses).query(houses, predicate="intersects")
    pairs = first < second
    shared = shapely.area(shapely.intersection(houses[first[pairs]], houses[second[pairs]]))
    assert len(houses) > 20
    assert shared.max(initial=0.0) < 1e-6
    on_road = shapely.area(shapely.intersection(shapely.union_all(houses), surface))
    assert on_road.max() < 1e-6
