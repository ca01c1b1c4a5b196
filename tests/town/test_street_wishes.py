"""How streets are made and what they hold, as sentences ask for it."""

from dataclasses import replace

import numpy as np
import pytest
import shapely

from cityx.checks.predicates import measure
from cityx.city import City, Frame, Layout
from cityx.city.content import content_hash
from cityx.errors import ActionFailed
from cityx.language import read_brief
from cityx.language.asked import slots_of_brief
from cityx.protocol.serving import DO
from cityx.road.network.network import DRIVABLE
from cityx.terrain.relief import relief
from cityx.town.town import town
from cityx.town.wishes.boulevard import boulevard
from cityx.town.wishes.obstacles import obstacles
from cityx.town.wishes.river import river
from cityx.town.wishes.steps import steps
from cityx.town.wishes.street_design import street_design
from cityx.town.wishes.street_elements import MEASURES, street_elements, street_rows_of


@pytest.fixture(scope="module")
def bare():
    start = City("Town", Frame(50.0, 10.0), Layout((0.0, 0.0, 1.0, 1.0)), seed=3)
    return town(start, width=420.0, depth=420.0, pattern="grid", parks=0.0, plazas=0.0)


def overlaps(city):
    """Most square metres of a house on streets and their walks."""
    roads = city.layout.roads
    walks = roads[["sidewalk_left", "sidewalk_right"]].max(axis=1).to_numpy(float)
    half = roads["width"].to_numpy(float) / 2 + walks - 0.01
    half = np.where(roads["kind"] == "pedestrian", roads["width"] / 2 - 0.01, half)
    ground = shapely.union_all(shapely.buffer(roads.geometry.to_numpy(), half, cap_style="flat"))
    houses = city.layout.buildings.geometry.to_numpy()
    return float(shapely.area(shapely.intersection(houses, ground)).max())


@pytest.mark.parametrize(
    "text",
    [
        "two roundabouts in the north", "A town with one roundabout", "a roundabout in the middle",
        "twelve signalised intersections", "no traffic light junctions",
        "exactly five junctions with traffic lights",
        "three dead ends", "a town without dead ends", "at most two dead ends",
        "a pedestrian zone in the middle", "two car-free streets",
        "a pedestrian street in the east",
        "two road works", "a construction zone in the south", "a town with road works",
        "a boulevard with a green median", "pavements at least 3 m wide", "wide pavements",
        "speed limit of 30 km/h on all streets", "a long straight avenue of 700 m, six lanes",
        "houses that get taller toward the centre", "buildings lower towards the edge",
        "a town that gets denser toward the middle", "buildings that rise to the north",
        "a suburb thinning out towards the west",
    ],
)  # fmt: skip
@pytest.mark.sweep(8)
def test_a_layout_meets_what_a_sentence_asks_of_its_streets(text, check_sentence):
    city = check_sentence(text.replace("houses that", "buildings that") + ", 420 m by 420 m"
                          if "m," not in text else text)  # fmt: skip
    assert overlaps(city) < 1.0


@pytest.mark.parametrize("kind", MEASURES)
def test_one_three_and_none_are_measured(bare, kind):
    one = street_elements(bare, kind=kind, least=1, most=1)
    three = street_elements(one, kind=kind, least=3, most=3)
    counts = [measure(f"n({MEASURES[kind]}) >= 0", city).value for city in (one, three)]
    assert counts == [1, 3]
    assert overlaps(three) < 1.0
    if kind not in ("roundabout", "road_works"):  # those of a map stay
        none = street_elements(three, kind=kind, least=0, most=0)
        assert measure(f"n({MEASURES[kind]}) == 0", none).met


def test_what_there_is_no_room_for_is_refused_with_the_number_that_fits(bare):
    with pytest.raises(ActionFailed, match=r"40 roundabouts cannot be had .* room for \d+\. Ask"):
        street_elements(bare, kind="roundabout", least=40)
    with pytest.raises(
        ActionFailed, match="straight street of 900 m does not fit: the site has 420 m"
    ):
        boulevard(bare, length=900.0)


def test_the_same_town_gets_the_same_streets(bare):
    cities = [
        street_design(street_elements(bare, kind="roundabout", least=1), oneway=True, share=0.5)
        for _ in range(2)
    ]
    assert content_hash(cities[0]).total == content_hash(cities[1]).total


def test_wider_walks_take_ground_off_the_blocks_and_leave_houses_whole(bare):
    city = street_design(bare, walk=4.5)
    assert measure("stat(road, walk, min) >= 4.5", city).met
    assert overlaps(city) < 1.0
    assert len(city.layout.buildings) > 0.7 * len(bare.layout.buildings)


def test_lanes_of_a_share_of_the_streets(bare):
    city = street_design(bare, share=0.5, lanes=3)
    value = measure("share(road, lanes=3) >= 0", city).value
    assert 0.4 <= value <= 0.6


def test_one_way_streets_lead_to_and_fro_and_leave_no_dead_end_locked(bare):
    city = street_design(street_elements(bare, kind="dead_end", least=1), oneway=True)
    roads = city.layout.roads
    one = roads[roads["oneway"].to_numpy(bool)]
    ends = shapely.get_coordinates(shapely.get_point(one.geometry.to_numpy(), [[0], [-1]]))
    way = np.sign(np.diff(ends.reshape(2, -1, 2), axis=0)[0])
    for axis in (0, 1):
        assert {1.0, -1.0} <= set(way[:, axis])
    blind = roads[roads["source"].str.startswith("made/dead_end/")]
    assert not blind["oneway"].any()


def test_rows_of_lamps_stand_along_walks_as_far_apart_as_asked(bare):
    city = street_rows_of(bare, kind="streetlight", spacing=25.0)
    lamps = city.layout.points[city.layout.points["kind"] == "street_lamp"]
    houses = city.layout.buildings.geometry.to_numpy()
    assert shapely.STRtree(houses).query(lamps.geometry.to_numpy(), "intersects").size == 0
    roads = city.layout.roads
    row = roads.iloc[[int(shapely.length(roads.geometry.to_numpy()).argmax())]]
    line = row.geometry.iloc[0]
    near = lamps.geometry.to_numpy()[shapely.dwithin(lamps.geometry.to_numpy(), line, 12.0)]
    left = near[shapely.contains(shapely.buffer(line, 12.0, single_sided=True), near)]
    gaps = np.diff(np.sort(shapely.line_locate_point(line, left)))
    assert np.median(gaps) == pytest.approx(25.0, abs=0.1)


@pytest.mark.parametrize(
    ("text", "action", "args"),
    [
        ("cobbled streets", "street_design", {"kind": "all", "surface": "cobblestone"}),
        ("gravel roads", "street_design", {"kind": "all", "surface": "gravel"}),
        ("main streets paved with setts", "street_design", {"kind": "main", "surface": "sett"}),
        ("one-way streets", "street_design", {"kind": "all", "oneway": True}),
        ("half of the streets are one-way", "street_design",
         {"kind": "all", "oneway": True, "share": 0.5}),
        ("side streets are one-way", "street_design", {"kind": "other", "oneway": True}),
        ("bike lanes on all main streets", "street_design",
         {"kind": "main", "cycling": "lane", "share": 1.0}),
        ("protected bike lanes on half of the streets", "street_design",
         {"kind": "all", "cycling": "track", "share": 0.5}),
        ("no bike lanes", "street_design", {"kind": "all", "cycling": "none"}),
        ("lamps every 25 m", "street_rows", {"kind": "streetlight", "spacing": 25.0}),
        ("street lamps spaced 40 m apart", "street_rows", {"kind": "streetlight", "spacing": 40.0}),
        ("a bench every 20 m along the streets", "street_rows", {"kind": "bench", "spacing": 20.0}),
    ],
)  # fmt: skip
def test_a_sentence_becomes_the_action_that_builds_it(text, action, args):
    brief = read_brief(text)
    assert brief.words_unread == ()
    assert (f"layout/{action}-v1", args) in slots_of_brief(brief)[DO]
    assert brief.goals


@pytest.mark.parametrize(
    "text", ["A bench every 20 m along the river", "bollards every 3 m", "a 20 m avenue"]
)
def test_what_is_said_of_other_things_is_no_row_and_no_length(text):
    keys = {slot.key for slot in read_brief(text).slots}
    assert not keys & {"streetlight.spacing", "bench.spacing", "roads.main.length"}


def test_trends_are_told_by_ranks(bare):
    table = bare.layout.buildings.copy()
    x = shapely.get_coordinates(shapely.centroid(table.geometry.to_numpy()))[:, 0]
    table["height"] = 5.0 + 0.1 * (x - x.min())
    city = replace(bare, layout=replace(bare.layout, buildings=table))
    assert measure("trend(building, height, east) >= 0.99", city).met
    assert measure("trend(building, height, west) <= -0.99", city).met
    assert abs(measure("trend(building, height, center) >= 0", city).value) < 0.3


@pytest.fixture(scope="module")
def watered(bare):
    return river(bare, width=20.0, bridges=4)


@pytest.mark.parametrize("count", [1, 3])
def test_closed_bridges_have_boards_at_both_ends_and_no_lane_over_them(watered, count):
    city = obstacles(watered, kind="closed_bridge", least=count, most=count)
    before, after = (one.layout.roads for one in (watered, city))
    assert measure(f"n(bridge, closed=true) == {count}", city).met
    assert measure(f"n(bridge, closed=false) == {4 - count}", city).met
    assert measure("n(bridge, closed=true) == 0", watered).met
    high = {name: table[table["bridge"]] for name, table in (("was", before), ("is", after))}
    assert (
        high["is"]["kind"].isin(DRIVABLE).sum() == high["was"]["kind"].isin(DRIVABLE).sum() - count
    )
    boards = city.layout.points[city.layout.points["kind"] == "work_barrier"].geometry.to_numpy()
    shut = high["is"][~high["is"]["kind"].isin(DRIVABLE)].geometry.to_numpy()
    ends = shapely.get_point(shut[:, None], [[0, -1]])
    assert (shapely.distance(ends[..., None], boards).min(axis=-1) < 12.0).all()
    with pytest.raises(ActionFailed, match="9 closed bridges cannot be had"):
        obstacles(watered, kind="closed_bridge", least=9)


@pytest.mark.parametrize("count", [1, 3])
def test_scaffolds_stand_before_walls_and_off_the_street(bare, count):
    city = obstacles(bare, kind="scaffold", least=count, most=count)
    assert measure(f"n(scaffolding) == {count}", city).met
    assert measure("n(scaffolding) == 0", bare).met
    points = city.layout.points
    bays = points[points["kind"] == "scaffold"].geometry.to_numpy()
    houses = shapely.union_all(city.layout.buildings.geometry.to_numpy())
    assert ((shapely.distance(bays, houses) > 0.5) & (shapely.distance(bays, houses) < 1.0)).all()
    roads = city.layout.roads
    strips = shapely.buffer(roads.geometry.to_numpy(), roads["width"].to_numpy(float) / 2)
    assert shapely.distance(bays, shapely.union_all(strips)).min() > 0.5


@pytest.mark.parametrize(("count", "ramps"), [(1, 0), (3, 2)])
def test_steps_stand_where_the_land_climbs(bare, count, ramps):
    city = steps(relief(bare, form="slope", grade=0.1), least=count, most=count, ramps=ramps)
    assert measure(f"n(steps) == {count}", city).met
    assert measure(f"n(ramp) == {ramps}", city).met
    roads = city.layout.roads
    lines = roads.geometry.to_numpy()[(roads["kind"] == "steps").to_numpy()]
    ends = shapely.get_coordinates(shapely.get_point(lines[:, None], [[0, -1]]))
    z = city.terrain.height_at(ends).reshape(-1, 2)
    assert (np.abs(np.diff(z)) > 0.045 * shapely.length(lines)[:, None] - 0.3).all()
    width = roads["width"].to_numpy(float)[(roads["kind"] == "steps").to_numpy()]
    wide = shapely.buffer(lines, width / 2 - 0.01)
    beside = roads.geometry.to_numpy()[(roads["kind"] == "footway").to_numpy()]
    inner = shapely.line_interpolate_point(beside, 0.5, normalized=True)
    assert not shapely.intersects(wide[:, None], inner).any()
    with pytest.raises(ActionFailed, match="the land climbs enough along 0"):
        steps(bare, least=count)


@pytest.mark.parametrize(
    ("text", "asked"),
    [
        ("a bridge closed to traffic", {"layout/obstacles-v1": ("closed_bridge", 1)}),
        ("three bridges closed to cars", {"layout/obstacles-v1": ("closed_bridge", 3)}),
        ("no closed bridges", {"layout/obstacles-v1": ("closed_bridge", 0)}),
        ("scaffolds in front of three houses", {"layout/obstacles-v1": ("scaffold", 3)}),
        ("two houses with scaffolding", {"layout/obstacles-v1": ("scaffold", 2)}),
        ("no scaffolding", {"layout/obstacles-v1": ("scaffold", 0)}),
        ("three flights of steps", {"road/steps-v1": (None, 3)}),
        ("a stepped street", {"road/steps-v1": (None, 1)}),
        ("two ramps beside the stairs", {"road/steps-v1": (None, 2)}),
        ("no public stairs", {"road/steps-v1": (None, 0)}),
    ],
)  # fmt: skip
def test_what_bars_the_way_is_asked_for_in_words(text, asked):
    brief = read_brief(text)
    assert brief.words_unread == ()
    done = {name: (args.get("kind"), args["least"]) for name, args in slots_of_brief(brief)[DO]
            if name in asked}  # fmt: skip
    assert done == asked
    assert brief.goals


@pytest.mark.parametrize(
    "text",
    ["A church a few steps from the school", "A town in three steps", "A motorway with ramps",
     "Houses with outdoor stairs"],
)  # fmt: skip
def test_steps_and_ramps_of_other_things_are_left_unread(text):
    assert not {"road/steps-v1"} & {name for name, _ in slots_of_brief(read_brief(text))[DO]}
