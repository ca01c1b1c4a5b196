from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from cityx.city.city import City
from cityx.city.content import content_hash
from cityx.city.frame import Frame
from cityx.city.ground import LABEL
from cityx.city.layout import Layout
from cityx.city.section import read_section
from cityx.errors import UsageError
from cityx.protocol import registry
from cityx.protocol.running import Call, merged, run_action
from cityx.protocol.values import make_lines
from cityx.road.ground.ground_surface import ground
from cityx.road.network.asphalt_street import STYLES as STREET_STYLES
from cityx.road.network.asphalt_street import asphalt_street
from cityx.road.network.curve import curve
from cityx.road.network.drawn_streets import GENERATORS
from cityx.road.network.highway import STYLES as HIGHWAY_STYLES
from cityx.road.network.highway import highway
from cityx.road.network.network import network, road_network
from cityx.road.network.path import path
from cityx.road.network.railway import railway
from cityx.road.network.secondary_road import STYLES as ROAD_STYLES
from cityx.road.network.secondary_road import secondary_road

EAST = [(-80, 0), (80, 0)]
NORTH = [(0, -80), (0, 80)]
KERBED = ("carriageway", "setts", "gutter", "gravel_road", "junction", "marking", "marking_yellow",
          "cycle_lane")  # fmt: skip


def lines(*curves):
    with np.errstate(invalid="ignore"):
        return make_lines([shapely.LineString(points) for points in curves])


def empty_city():
    return City("drawn", Frame(48.2, 16.3), Layout((-10.0, -10.0, 10.0, 10.0)))


def built(generator, *curves, on=None, **options):
    city = empty_city() if on is None else on
    return replace(city, layout=merged(city.layout, generator(city, lines(*curves), **options)))


def measured(city, labels, *, x=40.0):
    """Metres of some surfaces on a cut through the ground across a street that runs east."""
    cut = shapely.LineString([(x, -60.0), (x, 60.0)])
    faces = shapely.polygons(city.ground.vertices[city.ground.triangles_of(*labels)])
    return float(shapely.length(shapely.intersection(faces, cut)).sum())


@pytest.mark.parametrize("style", STREET_STYLES)
def test_an_asphalt_street_has_the_cross_section_asked_for(style):
    city = ground(network(built(asphalt_street, EAST, style=style)))
    look = STREET_STYLES[style]
    parking = {"none": 0.0, "both": 4.2}[look.parking]
    assert measured(city, KERBED) == pytest.approx(look.lanes * look.lane_width + parking, abs=0.01)
    walks = measured(city, ("sidewalk", "furnishing"))
    assert walks == pytest.approx(2 * look.sidewalk, abs=0.01)


def test_width_lanes_parking_cycles_verge_and_walk_are_where_they_are_asked():
    options = {"width": 12.0, "lanes": 2, "parking": "left", "cycle": "right", "sidewalk": 2.4,
               "walk_on": "right", "verge": 1.5}  # fmt: skip
    made = built(asphalt_street, EAST, **options)
    bands = read_section(made.layout.roads["section"].iloc[0])
    assert [band.kind for band in bands] == [
        "parking", "drive", "drive", "cycle", "verge", "walk"
    ]  # fmt: skip
    assert bands[1].width == pytest.approx((12.0 - 2.1 - 1.6) / 2)
    city = ground(network(made))
    assert measured(city, KERBED) == pytest.approx(12.0, abs=0.01)
    assert measured(city, ("sidewalk",)) == pytest.approx(2.4, abs=0.01)
    beside = shapely.polygons(city.ground.vertices[city.ground.triangles_of("sidewalk")])
    assert shapely.bounds(beside)[:, 3].max() == pytest.approx(-6.0 - 0.15 - 1.5, abs=1.6)


def test_a_verge_is_green_between_kerb_and_walk():
    city = ground(network(built(asphalt_street, EAST, style="avenue")))
    label = city.ground.face_label[city.ground.triangle_face]
    corners = city.ground.vertices[city.ground.triangles]
    middle = (12.9 - 2.2) / 2 + 0.15 + 1.0
    at = shapely.Point(40.0, middle)
    on = shapely.intersects(shapely.polygons(corners), at)
    assert set(label[on].tolist()) == {LABEL["grass"]}


@pytest.mark.parametrize("style", HIGHWAY_STYLES)
def test_a_highway_has_two_carriageways_against_each_other(style):
    look = HIGHWAY_STYLES[style]
    roads = built(highway, EAST, style=style).layout.roads
    assert len(roads) == (2 if look.median else 1)
    for line, oneway in zip(roads.geometry, roads["oneway"], strict=True):
        (x, y), (far, _) = line.coords[0], line.coords[-1]
        assert oneway == (look.median > 0)
        if oneway:
            assert (far - x) * y < 0  # right-hand traffic: eastwards in the south
            apart = look.median / 2 + (look.lanes * look.lane_width / 2 + look.shoulder) / 2
            assert abs(y) == pytest.approx(apart)


def test_the_median_of_a_highway_is_green():
    city = ground(network(built(highway, EAST, median=6.0, name="A1")))
    label = city.ground.face_label[city.ground.triangle_face]
    on = shapely.intersects(
        shapely.polygons(city.ground.vertices[city.ground.triangles]), shapely.Point(20.0, 0.5)
    )
    assert set(label[on].tolist()) == {LABEL["grass"]}


@pytest.mark.parametrize("style", ROAD_STYLES)
def test_a_secondary_road_has_the_carriageway_of_its_style(style):
    look = ROAD_STYLES[style]
    city = ground(network(built(secondary_road, EAST, style=style)))
    cycles = {"none": 0.0, "both": 3.2}[look.cycle]
    wanted = look.lanes * look.lane_width + cycles + 2 * look.shoulder
    assert measured(city, KERBED) == pytest.approx(wanted, abs=0.01)


@pytest.mark.parametrize("kind", GENERATORS)
def test_every_kind_is_built_without_gaps(kind):
    made = built(GENERATORS[kind], EAST, NORTH, kind=kind)
    assert set(made.layout.roads["kind"]) == {kind}
    city = ground(network(made))
    area = shapely.area(shapely.polygons(city.ground.vertices[city.ground.triangles])).sum()
    xmin, ymin, xmax, ymax = city.layout.extent
    assert area == pytest.approx((xmax - xmin) * (ymax - ymin), rel=1e-6)


def test_curves_that_cross_make_a_junction_with_streets_that_were_there():
    first = built(asphalt_street, EAST)
    second = built(secondary_road, NORTH, on=first)
    degrees = road_network(second.layout).node_degree
    assert sorted(degrees.tolist()) == [1, 1, 1, 1, 4]


def test_an_end_just_before_or_beyond_a_street_joins_it():
    for end in (-4.0, -1.0, 2.5):
        first = built(asphalt_street, EAST)
        second = built(asphalt_street, [(10, -80), (10, end)], on=first)
        degrees = road_network(second.layout).node_degree
        assert sorted(degrees.tolist()) == [1, 1, 1, 3], end


def test_two_curves_whose_ends_reach_for_each_other_become_one_chain():
    city = built(asphalt_street, [(-80, 0), (-0.5, 0)], [(0.5, 0), (80, 3)])
    assert sorted(road_network(city.layout).node_degree.tolist()) == [1, 1]


@pytest.mark.parametrize(("layer", "column"), [(1, "bridge"), (-1, "tunnel")])
def test_a_layer_crosses_without_a_junction(layer, column):
    first = built(asphalt_street, [(-300, 0), (300, 0)])
    roads = built(secondary_road, [(0, -300), (0, 300)], on=first, layer=layer).layout.roads
    assert roads[column].sum() == 1
    assert road_network(Layout((-400.0, -400.0, 400.0, 400.0), roads=roads)).node_degree.max() == 2
    deck = roads.geometry[roads[column]].iloc[0]
    assert deck.length == pytest.approx(6.0 + 12.0, abs=0.01)


def test_a_bridge_leads_over_water():
    lake = built(asphalt_street, [(-100, 90), (100, 90)])
    from cityx.city.layout import make_table

    areas = make_table("areas", [shapely.box(-100, -20, 100, 20)], id=[5], kind=["river"])
    city = replace(lake, layout=replace(lake.layout, areas=areas))
    roads = built(asphalt_street, [(0, -80), (0, 60)], on=city, layer=1).layout.roads
    deck = roads.geometry[roads["bridge"]].iloc[0]
    assert deck.length == pytest.approx(40.0 + 12.0, abs=0.1)


def test_a_closed_curve_is_a_roundabout_in_the_direction_of_traffic():
    ring = [(15 * np.cos(a), -15 * np.sin(a)) for a in np.linspace(0, 2 * np.pi, 17)[:-1]]
    made = built(secondary_road, [*ring, ring[0]], roundabout=True)
    line = made.layout.roads.geometry.iloc[0]
    assert shapely.LinearRing(line.coords).is_ccw
    assert made.layout.roads["oneway"].all()
    assert made.layout.roads["roundabout"].all()


def test_tracks_lie_side_by_side():
    roads = built(railway, EAST, tracks=3, spacing=4.5).layout.roads
    assert sorted(line.coords[0][1] for line in roads.geometry) == [-4.5, 0.0, 4.5]


def test_heights_of_points_are_left_out():
    flat, high = built(path, EAST), built(path, [(-80, 0, 12.0), (80, 0, 30.0)])
    assert not shapely.has_z(high.layout.roads.geometry.to_numpy()).any()
    assert flat.layout.roads.geometry.iloc[0].equals(high.layout.roads.geometry.iloc[0])


BAD = {
    "no finite number": [(0, 0), (np.nan, 5)],
    "shorter than 3 m": [(0, 0), (1, 0), (1, 0)],
    "crosses or touches itself": [(0, 0), (50, 0), (50, 50), (20, -20)],
    "farther than 100 km": [(0, 0), (2e5, 0)],
}


@pytest.mark.parametrize("text", BAD)
def test_a_curve_that_carries_no_street_is_named(text):
    with pytest.raises(UsageError, match=f"Curve 1 .*{text}"):
        built(asphalt_street, EAST, BAD[text])


def test_a_million_points_are_too_many():
    many = np.column_stack([np.arange(1_000_000) * 0.1, np.zeros(1_000_000)])
    with pytest.raises(UsageError, match="200000 points at once"):
        built(asphalt_street, many)


def test_a_curve_that_bends_tighter_than_its_carriageways_is_refused():
    hairpin = [(0, 0), (60, 0), (60, 3), (0, 3)]
    with pytest.raises(UsageError, match="bends tighter"):
        built(highway, hairpin)


def test_all_contradictions_are_told_at_once():
    with pytest.raises(UsageError) as caught:
        built(asphalt_street, [(0, 0), (1, 0)], width=40.0, lanes=3, median=4.0, oneway=True,
              lane_width=3.0)  # fmt: skip
    text = str(caught.value)
    for part in ("shorter than 3 m", "13.33 m wide", "lane_width = 3", "one-way"):
        assert part in text


def test_a_curve_carries_one_street():
    city = built(asphalt_street, EAST)
    with pytest.raises(UsageError, match="carries a street already"):
        built(highway, EAST, on=city)


def test_a_width_of_400_m_is_refused_at_the_gate():
    record = registry()["road/asphalt_street-v1"]
    (fault,) = record.argument_faults({"width": 400.0})
    assert fault.endswith("width = 400.0 is outside 2 to 60.")


def test_an_agent_draws_a_curve_and_builds_on_it():
    actions = registry()
    drawn = run_action(
        empty_city(), Call("road/curve-v1", {"name": "ring road", "points": EAST}), actions
    ).city
    call = Call("road/asphalt_street-v1", {"curve": "ring road", "style": "terrace"})
    city = run_action(drawn, call, actions).city
    assert city.layout.roads["parking_left"].tolist() == [True]
    assert city.layout.lines["source"].tolist() == ["ring road"]


def test_points_are_checked_by_name():
    record = registry()["road/curve-v1"]
    for points in ([[0, 0]], [[0, 0], [1]], [[0, 0], ["a", 1]], "0 0, 1 1"):
        (fault,) = record.argument_faults({"name": "a", "points": points})
        assert "is not an array of 2 to 2000 points" in fault
    (fault,) = record.argument_faults({"name": "a", "points": [[0, 0], [1e9, 0]]})
    assert "outside -100000 to 100000" in fault


def test_a_curve_is_replaced_by_one_of_its_name():
    city = curve(empty_city(), name="a", points=((0.0, 0.0), (50.0, 0.0)))
    city = curve(city, name="a", points=((0.0, 0.0), (90.0, 0.0)))
    assert city.layout.lines.geometry.length.tolist() == [90.0]


coordinate = st.integers(-90, 90).map(float)
wild = st.lists(st.tuples(coordinate, coordinate), min_size=2, max_size=5)


# Shrinking would build hundreds of cities.
@settings(max_examples=20, deadline=None, phases=[Phase.explicit, Phase.reuse, Phase.generate],
          suppress_health_check=[HealthCheck.too_slow])  # fmt: skip
@given(curves=st.lists(wild, min_size=1, max_size=4), kind=st.sampled_from(sorted(GENERATORS)),
       layer=st.sampled_from([0, 0, 1]))  # fmt: skip
def test_whatever_is_drawn_is_refused_or_built_whole_and_always_the_same(curves, kind, layer):
    first = built(asphalt_street, [(-100, 5), (100, -5)])
    cities = []
    for _ in range(2):
        try:
            made = built(GENERATORS[kind], *curves, on=first, kind=kind, layer=layer)
        except UsageError:
            return
        cities.append(ground(network(made)))
    assert content_hash(cities[0]).total == content_hash(cities[1]).total
    faces = cities[0].ground
    area = shapely.area(shapely.polygons(faces.vertices[faces.triangles])).sum()
    xmin, ymin, xmax, ymax = cities[0].layout.extent
    assert area == pytest.approx((xmax - xmin) * (ymax - ymin), rel=1e-5)
