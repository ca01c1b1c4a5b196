"""What the map says of crossings and of limits that a law sets is built as it says."""

import math

import numpy as np
import pytest
import shapely

import cityx
from cityx.checks.fidelity import facts
from cityx.checks.tag_measures import KEPT, UNREADABLE
from cityx.city.section import BAND_KINDS
from cityx.sources.features.measures import speed_kmh


def crossed(drawing, **tags):
    """Return the junction arms at which people cross, with a node 12 m east of a junction."""
    for x, y in ((12, 12), (-24, 12), (12, -24), (-24, -24)):
        drawing.box(x, y, 12, 12, building="apartments", height="12")
    drawing.node(0, 0, highway="traffic_signals")
    if tags:
        drawing.node(12, 0, **tags)
    drawing.way([(-150, 0), (0, 0), *([(12, 0)] if tags else []), (150, 0)], highway="secondary",
                sidewalk="both")  # fmt: skip
    drawing.way([(0, -150), (0, 0), (0, 150)], highway="residential", sidewalk="both")
    network = cityx.build(drawing.file(), lod=0).city.network
    edge, end = np.nonzero(network.crossing)
    middles = shapely.line_interpolate_point(
        [shapely.LineString(network.points[network.point_start[k] : network.point_start[k + 1]])
         for k in edge.tolist()], np.where(end == 0, 12.0, -12.0))  # fmt: skip
    return {tuple(np.round(place).astype(int)) for place in shapely.get_coordinates(middles)}


def test_an_arm_where_nobody_may_cross_has_no_crossing(drawing):
    assert (12, 0) not in crossed(drawing, crossing="no")


def test_an_arm_whose_crossing_is_refused_by_its_class_has_none(drawing):
    assert (12, 0) not in crossed(drawing, highway="crossing", crossing="no")


@pytest.mark.parametrize(
    "tags",
    [{}, {"highway": "crossing"}, {"crossing": "zebra"},
     {"highway": "crossing", "crossing:markings": "no", "crossing": "unmarked"}],
)  # fmt: skip
def test_other_arms_of_the_junction_are_crossed(drawing, tags):
    assert (12, 0) in crossed(drawing, **tags)


@pytest.mark.parametrize(
    ("text", "speed"),
    [("RU:urban", 60.0), ("FR:zone30", 30.0), ("DE:zone:30", 30.0), ("BE-VLG:urban", 50.0),
     ("GB:nsl_single", 96.56), ("GB:zone20", 32.19), ("AT:motorway", 130.0), ("50", 50.0),
     ("30 mph", 48.28), ("DE:motorway", math.nan), ("XX:urban", math.nan), ("signals", math.nan),
     ("DE:", math.nan)],
)  # fmt: skip
def test_a_limit_that_a_law_sets_is_read(text, speed):
    assert speed_kmh(text) == pytest.approx(speed, abs=0.01, nan_ok=True)


def test_limits_by_law_are_those_of_the_lanes(drawing):
    drawing.box(-40, 20, 20, 20, building="house")
    for y, tags in (
        (0, {"maxspeed": "RU:urban"}), (80, {"maxspeed": "IT:rural"}),
        (160, {"maxspeed:type": "PL:living_street"}), (240, {"maxspeed": "often"}),
    ):  # fmt: skip
        drawing.way([(-150, y), (150, y)], highway="residential", **tags)
    path = drawing.file()
    city = cityx.build(path, lod=0).city
    told = sorted(city.layout.roads["maxspeed_kmh"].dropna())
    assert told == [20.0, 60.0, 90.0]
    verdicts = [fact.verdict for fact in facts(city, path) if fact.tag == "maxspeed"]
    assert sorted(verdicts) == sorted([KEPT, KEPT, UNREADABLE])


def test_a_lane_that_nobody_may_use_is_no_lane_of_the_graph(drawing):
    drawing.box(-40, 20, 20, 20, building="house")
    drawing.way([(-150, 0), (150, 0)], highway="primary", oneway="yes", lanes="3",
                **{"vehicle:lanes": "yes|yes|no"})  # fmt: skip
    city = cityx.build(drawing.file(), lod=1).city
    assert city.lanes.travelled.sum() == 2


@pytest.mark.parametrize(
    ("tags", "own"),
    [({"oneway:bicycle": "no"}, False), ({"cycleway": "opposite"}, False),
     ({"cycleway:left": "opposite"}, False), ({"cycleway": "opposite_lane"}, True),
     ({"oneway:bicycle": "no", "cycleway:left": "lane"}, True),
     ({"oneway:bicycle": "no", "cycleway:right": "lane"}, False)],
)  # fmt: skip
def test_bicycles_go_against_a_one_way_street_where_they_may(drawing, tags, own):
    drawing.box(20, 20, 10, 10, building="house")
    drawing.way([(-150, 0), (150, 0)], highway="residential", oneway="yes", **tags)
    for x in (-150, 150):
        drawing.way([(x, -150), (x, 0), (x, 150)], highway="residential")
    city = cityx.build(drawing.file(), lod=0).city
    lanes = city.lanes
    back = (lanes.kind == BAND_KINDS.index("cycle")) & (lanes.direction < 0)
    assert back.sum() == 1
    row = int(np.flatnonzero(back)[0])
    assert (lanes.connection[:, 0] == row).any()
    assert (lanes.connection[:, 1] == row).any()
    cars = (lanes.kind == BAND_KINDS.index("drive")) & (lanes.edge == lanes.edge[row])
    assert (lanes.direction[cars] > 0).all()
    apart = (lanes.right[cars] >= lanes.left[row] - 0.01) | (
        lanes.left[cars] <= lanes.right[row] + 0.01
    )
    assert apart.all() == own


@pytest.mark.parametrize(("tags", "count"), [({"lanes": "2"}, 2), ({}, 1), ({"lanes": "1"}, 1)])
def test_stated_lanes_stand_between_houses_that_leave_less_than_is_usual(drawing, tags, count):
    for y in (2.9, -14.9):
        drawing.box(-60, y, 120, 12, building="apartments")
    drawing.way([(-60, 0), (60, 0)], highway="residential", oneway="yes", **tags)
    lanes = cityx.build(drawing.file(), lod=0).city.lanes
    assert (lanes.kind == BAND_KINDS.index("drive")).sum() == count
