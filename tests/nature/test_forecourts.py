"""Groups of things at the walls of deep forecourts, and zones of furniture on wide walks."""

from dataclasses import replace

import numpy as np
import pytest
import shapely

from cityx.assets.furniture.potted_plants import POT_ROWS
from cityx.checks.furniture_checks import check_furniture
from cityx.city import Frame, make_table
from cityx.city.ground import KERB_WIDTH
from cityx.ground.pieces import walk_rims
from cityx.ground.street_rules import (
    FRONT_LINE,
    FULL,
    KERB_RULES,
    MORE,
    WALL_GAP,
    drawn_shares,
    varied,
)
from cityx.nature.furniture.corner_kerbs import past_junctions
from cityx.nature.furniture.forecourts import (
    DEEP,
    FROM_EDGE,
    GROUPS,
    LEAST_EDGE,
    OPEN_GROUPS,
    amid_forecourts,
    at_forecourts,
)
from cityx.nature.furniture.street_pieces import LAYER, street_pieces
from cityx.places.profiles import profile_named
from cityx.road.ground.ground_surface import ground
from cityx.road.network.lane_graph import lanes

TOKYO = Frame(35.69, 139.78)
JAPAN, BRITAIN = profile_named("jp").furniture, profile_named("gb").furniture


def street(crossroads, walk):
    """The crossroads with rows of houses behind walks of so many metres."""
    near = 5.0 + walk
    rows = [shapely.box(x, y, x + 80, y + 8) for x in (-95, 15) for y in (near, -near - 8)]
    houses = crossroads.layout.buildings.assign(geometry=rows, place="core")
    parts = make_table("parts", rows, id=np.arange(71, 75), building=houses["id"].to_numpy(),
                       base=np.zeros(4), walls=np.ones(4, bool))  # fmt: skip
    roads = crossroads.layout.roads.assign(sidewalk_left=walk, sidewalk_right=walk, kind="primary",
                                           parking_left=False, parking_right=False)  # fmt: skip
    empty = crossroads.layout
    layout = replace(empty, buildings=houses, parts=parts, roads=roads, areas=empty.areas[:0],
                     points=empty.points[:0], lines=empty.lines[:0])  # fmt: skip
    done = frozenset({"layout", "terrain"})
    return ground(lanes(replace(crossroads, layout=layout, frame=TOKYO, stages_done=done)))


def drawn(city, **options):
    return at_forecourts(city, walk_rims(city.ground), JAPAN, **options)


def test_groups_stand_at_the_walls_of_deep_paving_alone(crossroads):
    found = drawn(street(crossroads, DEEP + 1.0))
    assert set(found.name) <= {name for group in GROUPS.values() for name, _ in group}
    assert len(set(found.name)) > 4
    houses = street(crossroads, DEEP + 1.0).layout.buildings.geometry.to_numpy()
    gap = shapely.distance(shapely.union_all(houses), shapely.points(found.xy))
    pots = found.name == "pot_row"
    assert gap[pots] == pytest.approx(np.full(pots.sum(), WALL_GAP["pot_row"]), abs=0.01)
    assert not len(drawn(street(crossroads, DEEP - 1.0)))


def test_the_same_seed_gives_the_same_groups_and_density_more(crossroads):
    city = street(crossroads, 6.0)
    one, again = drawn(city), drawn(city)
    assert one.xy.tobytes() == again.xy.tobytes()
    assert one.id.tobytes() == again.id.tobytes()
    assert len(drawn(city, density=3.0)) > len(one) > len(drawn(city, density=0.1))


def courts(crossroads, depth):
    """The crossroads with houses so many metres behind walks of 3 m, on paved ground."""
    made = street(crossroads, 3.0 + depth)
    roads = made.layout.roads.assign(sidewalk_left=3.0, sidewalk_right=3.0)
    paved = [shapely.box(-95, y, 95, y + depth) for y in (8.0, -8.0 - depth)]
    areas = make_table("areas", paved, id=[81, 82], kind=["pedestrian"] * 2)
    return ground(replace(made, layout=replace(made.layout, roads=roads, areas=areas)))


def test_forecourts_are_furnished_along_their_edges_and_the_deepest_amid(crossroads):
    city = courts(crossroads, LEAST_EDGE + 1.5)
    none = np.zeros(0, object)
    found, group = amid_forecourts(city, none, JAPAN, 3.0)
    again, _ = amid_forecourts(city, none, JAPAN, 3.0)
    assert found.xy.tobytes() == again.xy.tobytes()
    assert len(found) > 10
    assert set(found.name) <= {name for each in OPEN_GROUPS.values() for name, _, _ in each}
    houses = shapely.union_all(city.layout.buildings.geometry.to_numpy())
    gap = shapely.distance(houses, shapely.points(found.xy))
    assert gap.min() > LEAST_EDGE - FROM_EDGE - 0.01
    assert len(np.unique(group)) < len(group)
    assert not len(amid_forecourts(courts(crossroads, 3.0), none, JAPAN, 3.0)[0])
    ways = np.array([shapely.LineString([(x, y - 30), (x, y + 30)])
                     for x, y in found.xy[:1].tolist()], object)  # fmt: skip
    kept = amid_forecourts(city, ways, JAPAN, 3.0)[0]
    assert 0 < len(kept) < len(found)
    assert shapely.distance(ways[0], shapely.points(kept.xy)).min() >= 1.2


def test_wide_walks_are_furnished_in_a_line_and_let_people_pass(crossroads):
    made = street_pieces(street(crossroads, 6.0))
    rows = made.scene.instances[LAYER]
    names = np.array([made.scene.prototypes[i].name for i in rows.prototype])
    assert {check.value for check in check_furniture(made)} == {0.0}
    planters = rows.position[np.isin(names, ["planter"]), 1]
    front = np.abs(np.abs(planters) - 5.0) < 2.0
    assert np.abs(planters[front]) == pytest.approx(5.0 + 0.45 + 0.30, abs=0.02)
    assert (np.abs(rows.position[:, 1]) > 5.0 + KERB_WIDTH).any()
    assert len(set(names) & set(POT_ROWS)) > 1


def test_slots_of_wide_walks_hold_more_and_never_more_than_one_thing():
    column, wide = np.zeros(2, np.int64), np.array([False, True])
    narrow, broad = drawn_shares(BRITAIN, column, wide, 1.0)
    assert len(narrow) == len(KERB_RULES)
    assert (np.diff(broad) >= 0).all()
    bench = [rule.piece for rule in KERB_RULES].index("bench")
    assert broad[bench] == pytest.approx(MORE["bench"] * narrow[bench])
    assert broad[-1] > narrow[-1]
    assert drawn_shares(BRITAIN, column, wide, 9.0)[:, -1] == pytest.approx([FULL, FULL])


def test_rows_of_pots_are_of_every_make():
    names = np.array(["pot_row"] * 60 + ["bench"], object)
    made = varied(names, np.arange(61, dtype=np.uint64))
    assert set(made[:60]) == set(POT_ROWS)
    assert made[60] == "bench"


@pytest.fixture(scope="module")
def side_street(crossroads):
    """A street with walks of 6 m that one side street joins from the north."""
    whole = crossroads.network
    cut = {"node_position": 4, "node_degree": 4, "edge_nodes": 3, "edge_road": 3, "edge_id": 3,
           "point_start": 4, "points": 6, "half_width": 3, "trim": 3, "crossing": 3,
           "left_hand": 3, "z": 6, "lift": 6}  # fmt: skip
    arms = {name: getattr(whole, name)[:count] for name, count in cut.items()}
    arms["node_degree"] = np.array([3, 1, 1, 1], np.int32)
    roads = crossroads.layout.roads.iloc[:3].assign(sidewalk_left=6.0, sidewalk_right=6.0)
    empty = crossroads.layout
    layout = replace(empty, roads=roads, areas=empty.areas[:0], points=empty.points[:0],
                     buildings=empty.buildings[:0], parts=empty.parts[:0])  # fmt: skip
    done = frozenset({"layout", "terrain"})
    city = replace(crossroads, layout=layout, network=replace(whole, **arms), stages_done=done)
    return ground(lanes(city))


def test_furniture_goes_on_past_a_side_street_and_not_in_its_mouth(side_street):
    found = past_junctions(side_street, walk_rims(side_street.ground), BRITAIN, 5.0)
    again = past_junctions(side_street, walk_rims(side_street.ground), BRITAIN, 5.0)
    assert found.xy.tobytes() == again.xy.tobytes()
    assert 1 < len(found) <= 3
    assert set(found.name) <= set(BRITAIN.past_junctions)
    assert (found.xy[:, 1] < -5.0 - KERB_WIDTH).all()
    depth = {rule.piece: rule.depth for rule in KERB_RULES}
    front = -found.xy[:, 1] - [depth[name] for name in found.name]
    assert front == pytest.approx(np.full(len(found), 5.0 + FRONT_LINE), abs=0.02)
    assert np.abs(found.xy[:, 0]).max() < 9.0
