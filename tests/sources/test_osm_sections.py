import pytest
from hypothesis import given
from hypothesis import strategies as st

from cityx.city.section import TURN, read_section
from cityx.places.profiles import profile_named
from cityx.sources.features.road_features import cross_section


def section(tags, **options):
    streets, tags = profile_named("world").streets, {"highway": "secondary"} | tags
    return cross_section(tags, streets, town=False, dense=False, **options)


def bands(tags, **options):
    text = section(tags, **options)[0]
    return read_section(text) if text else ()


def words(found):
    return [f"{band.kind}{'-0+'[band.direction + 1]}" for band in found]


def test_a_street_without_such_tags_has_no_section_of_its_own():
    assert bands({}) == ()
    assert bands({"lanes": "4", "cycleway": "no"}) == ()


def test_turn_lanes_are_read_from_left_to_right_in_the_direction_of_travel():
    found = bands({
        "lanes": "5", "lanes:forward": "3", "turn:lanes:forward": "left|through|through;right",
        "turn:lanes:backward": "left|none",
    })  # fmt: skip
    assert words(found) == ["drive-"] * 2 + ["drive+"] * 3
    left, through, right = (TURN[name] for name in ("left", "through", "right"))
    assert [band.turns for band in found] == [0, left, left, through, through | right]


def test_where_one_keeps_left_the_lanes_ahead_come_first():
    tags = {"lanes": "3", "lanes:forward": "2", "turn:lanes:forward": "left|through"}
    found = bands(tags, left_hand=True)
    assert words(found) == ["drive+", "drive+", "drive-"]
    assert found[0].turns == TURN["left"]


def test_arrows_of_another_number_of_lanes_are_left_out():
    assert bands({"lanes": "2", "oneway": "yes", "turn:lanes": "left|through|right"}) == ()


@pytest.mark.parametrize(
    ("tags", "expected"),
    [
        ({"cycleway": "lane"}, ["cycle-", "drive-", "drive+", "cycle+"]),
        ({"cycleway:right": "lane"}, ["drive-", "drive+", "cycle+"]),
        ({"cycleway": "lane", "oneway": "yes", "lanes": "1"}, ["drive+", "cycle+"]),
        ({"cycleway": "opposite_lane", "oneway": "yes", "lanes": "1"}, ["cycle-", "drive+"]),
        ({"cycleway:both": "track", "parking:both": "parallel"},
         ["cycle-", "parking0", "drive-", "drive+", "parking0", "cycle+"]),
        ({"cycleway:right": "lane", "parking:right": "parallel"},
         ["drive-", "drive+", "cycle+", "parking0"]),
        ({"lanes": "3", "lanes:forward": "2", "lanes:bus:forward": "1"},
         ["drive-", "drive+", "bus+"]),
        ({"lanes": "2", "oneway": "yes", "bus:lanes": "designated|no"}, ["bus+", "drive+"]),
        ({"shoulder": "both"}, ["shoulder0", "drive-", "drive+", "shoulder0"]),
        ({"shoulder": "right"}, ["drive-", "drive+", "shoulder0"]),
    ],
)  # fmt: skip
def test_lanes_for_bicycles_and_buses_and_shoulders_lie_where_the_tags_say(tags, expected):
    assert words(bands(tags)) == expected


def test_a_motorway_has_a_shoulder_on_its_outer_side():
    assert words(bands({"highway": "motorway"})) == ["drive+", "drive+", "shoulder0"]
    left = bands({"highway": "motorway"}, left_hand=True)
    assert words(left) == ["shoulder0", "drive+", "drive+"]


def test_the_section_of_a_turned_way_is_mirrored():
    found = bands({
        "oneway": "-1", "lanes": "2", "turn:lanes:backward": "left|through",
        "parking:left": "parallel",
    })  # fmt: skip
    assert words(found) == ["drive+", "drive+", "parking0"]
    assert found[0].turns == TURN["left"]


def test_what_lies_beside_the_lanes_widens_the_carriageway():
    assert section({"cycleway": "lane"})[5] == pytest.approx(section({})[5] + 3.2)
    assert section({"cycleway": "lane", "width": "9"})[5] == 9.0


TAGS = st.dictionaries(
    st.sampled_from([
        "lanes", "lanes:forward", "lanes:backward", "turn:lanes", "turn:lanes:forward",
        "turn:lanes:backward", "cycleway", "cycleway:left", "cycleway:both", "oneway", "shoulder",
        "shoulder:left", "bus:lanes", "lanes:bus", "busway", "parking:both", "width",
        "shoulder:width",
    ]),
    st.sampled_from([
        "1", "2", "5", "-1", "0", "yes", "no", "lane", "track", "opposite_lane", "both", "left",
        "left|through", "||", "|", "", "reverse;left|none", "designated|yes", "3.5", "nan", "1e9",
    ]),
)  # fmt: skip


@given(TAGS, st.booleans())
def test_no_tags_make_a_section_that_cannot_be_read(tags, left_hand):
    found = section(tags, left_hand=left_hand)
    if found[0]:
        read_section(found[0])
    assert 0 < found[5] <= 70


CONTRAFLOW = {"oneway": "yes", "oneway:bus": "no"}


@pytest.mark.parametrize(
    ("tags", "expected"),
    [
        (CONTRAFLOW | {"lanes": "3", "lanes:backward": "1"}, ["bus-", "drive+", "drive+"]),
        ({"oneway": "yes", "lanes": "2", "lanes:psv:backward": "1"}, ["bus-", "drive+"]),
        ({"oneway": "yes", "busway": "opposite_lane"}, ["bus-", "drive+"]),
        (CONTRAFLOW | {"lanes": "2"}, ["bus-", "drive+"]),
        ({"oneway": "-1", "oneway:psv": "no", "lanes": "2", "lanes:forward": "1"},
         ["bus-", "drive+"]),
        (CONTRAFLOW | {"lanes": "1"}, []),
        ({"access": "no", "bus": "yes", "lanes": "2"}, ["bus-", "bus+"]),
        ({"motor_vehicle": "no", "psv": "designated", "oneway": "yes", "lanes": "1"}, ["bus+"]),
        ({"highway": "busway"}, ["bus-", "bus+"]),
        ({"highway": "bus_guideway", "oneway": "yes"}, ["bus+"]),
        ({"access": "no", "motor_vehicle": "yes", "bus": "yes"}, []),
        ({"oneway": "yes", "lanes": "2", "motor_vehicle:lanes": "yes|no"}, ["drive+", "shoulder0"]),
        ({"lanes": "3", "lanes:forward": "2", "vehicle:lanes:forward": "no|yes"},
         ["drive-", "shoulder0", "drive+"]),
    ],
)  # fmt: skip
def test_lanes_are_open_to_those_the_map_admits(tags, expected):
    assert words(bands(tags)) == expected


def test_buses_come_against_a_one_way_street_on_the_side_they_keep_to():
    tags = CONTRAFLOW | {"lanes": "3", "lanes:backward": "1"}
    assert words(bands(tags, left_hand=True)) == ["drive+", "drive+", "bus-"]
    found = dict(zip(("section", "kind", "lanes", "forward"), section(tags)[:4], strict=True))
    assert (found["lanes"], found["forward"]) == (3, 2)


def test_a_lane_against_a_one_way_street_without_who_may_use_it_is_named(drawing):
    drawing.box(20, 20, 10, 10, building="house")
    drawing.way([(0, 0), (80, 0)], highway="tertiary", oneway="yes",
                **{"lanes": "3", "lanes:backward": "1"})  # fmt: skip
    named = [failure.error for failure in drawing.city().failures]
    assert any("has lanes:backward=1; it was built one-way" in text for text in named)


def test_cars_stay_out_of_bus_lanes_and_buses_get_into_them_in_graph_and_export(drawing):
    from cityx.city.section import BAND_KINDS
    from cityx.road.network.lane_graph import lane_graph
    from cityx.road.network.network import road_network
    from cityx.traffic.plain import ALLOWED

    drawing.box(20, 20, 10, 10, building="house")
    kinds = {
        drawing.way([(-90, 0), (0, 0)], highway="tertiary"): "drive",
        drawing.way([(0, 0), (90, 0)], highway="tertiary", access="no", bus="yes"): "bus",
        drawing.way([(0, 0), (0, 90)], highway="busway"): "bus",
        drawing.way([(0, 0), (0, -90)], highway="residential"): "drive",
    }
    layout = drawing.city().layout
    network = road_network(layout)
    graph = lane_graph(layout, network)
    source = layout.roads["source"].to_numpy()[network.edge_road[graph.edge]]
    kind = [BAND_KINDS[number] for number in graph.kind]
    known = {f"osm/way/{way}": word for way, word in kinds.items()}
    assert [known[name] for name in source] == kind
    led = {(source[a], source[b]) for a, b in graph.connection.tolist()}
    assert all((a, b) in led for a in known for b in known if a != b)
    assert "passenger" not in ALLOWED["bus"].split()


@pytest.mark.parametrize(
    ("tags", "kinds"),
    [
        ({"vehicle:lanes": "yes|no"}, ["drive", "shoulder"]),
        ({"vehicle:lanes": "yes|no", "bus:lanes": "|designated"}, ["drive", "bus"]),
        ({"access:lanes": "yes|no", "psv:lanes": "|yes"}, ["drive", "bus"]),
        ({"motor_vehicle:lanes": "yes|no", "bicycle:lanes": "|designated"}, ["drive", "cycle"]),
        ({"motorcar:lanes": "yes|no"}, ["drive", "bus"]),
        ({"vehicle:lanes": "yes|yes", "turn:lanes": "left|right"}, ["drive", "drive"]),
    ],
)
def test_a_lane_that_is_closed_to_cars_is_of_whom_the_map_lets_in(tags, kinds):
    from cityx.sources.features.lane_sections import bands_of_tags

    bands = bands_of_tags(
        {"highway": "primary", "oneway": "yes", "lanes": "2", **tags}, "primary", 2, 2, 3.0,
        (False, False), oneway=True, backward=False, left_hand=False,
    )  # fmt: skip
    assert [band.kind for band in bands] == kinds


@pytest.mark.parametrize(
    ("tags", "expected"),
    [
        ({"motor_vehicle": "no"}, ["cycle-", "cycle+"]),
        ({"vehicle": "no", "bicycle": "yes"}, ["cycle-", "cycle+"]),
        ({"vehicle": "no"}, ["shoulder0", "shoulder0"]),
        ({"access": "no", "psv": "yes"}, ["bus-", "bus+"]),
        ({"access": "no", "motor_vehicle": "yes"}, []),
        ({"motor_vehicle": "private"}, []),
        ({"motor_vehicle:backward": "no"}, ["cycle-", "drive+"]),
        ({"vehicle:forward": "no", "bicycle:forward": "designated"}, ["drive-", "cycle+"]),
        ({"access:backward": "no", "lanes": "1"}, ["drive+"]),
        ({"motor_vehicle": "no", "oneway": "yes", "lanes": "1"}, ["cycle+"]),
        ({"motor_vehicle": "no", "cycleway": "lane", "lanes": "1"}, ["cycle0"]),
    ],
)  # fmt: skip
def test_lanes_that_are_closed_to_cars_are_of_those_who_may_use_them(tags, expected):
    assert words(bands({"lanes": "2", **tags})) == expected
