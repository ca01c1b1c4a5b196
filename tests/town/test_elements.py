"""Elements that a town is asked to hold: one, three, none of each, measured in what was made."""

import pytest
import shapely

from cityx.checks.predicates import measure
from cityx.city import City, Frame, Layout
from cityx.city.content import content_hash
from cityx.errors import ActionFailed
from cityx.language import read_brief
from cityx.language.asked import slots_of_brief
from cityx.language.lexicon.phrases import NOUNS
from cityx.language.measurable import things
from cityx.protocol.serving import DO
from cityx.road.network.network import DRIVABLE
from cityx.sources.features.kinds import land_kind, point_kind
from cityx.town.coast import coast
from cityx.town.elements import ELEMENTS
from cityx.town.lots import lot_of, plan_of
from cityx.town.town import town
from cityx.town.wishes.elements import elements
from cityx.town.wishes.places import places


@pytest.fixture(scope="module")
def bare():
    start = City("Town", Frame(50.0, 10.0), Layout((0.0, 0.0, 1.0, 1.0)), seed=3)
    return town(start, width=520.0, depth=520.0)


@pytest.fixture(scope="module")
def by_the_sea(bare):
    return coast(bare, side="south", share=0.25, quay=42.0)


def count_of(city, element):
    """Count an element by what stands in the tables, not by what was meant."""
    if not element.is_thing:
        return measure(f"n({element.measure}) >= 0", city).value
    kind = point_kind(element.points[0].tags)
    return int((city.layout.points["kind"] == kind).sum())


@pytest.mark.sweep(76)
@pytest.mark.parametrize("kind", ELEMENTS)
def test_one_three_and_none_are_measured(bare, by_the_sea, kind):
    element = ELEMENTS[kind]
    wet = ("shore", "water", "beach", "afloat")
    town = by_the_sea if element.where in wet else bare
    one = elements(town, kind=kind, least=1, most=1)
    three = elements(one, kind=kind, least=3, most=3)
    none = elements(three, kind=kind, least=0, most=0)
    assert [count_of(city, element) for city in (one, three, none)] == [1, 3, 0]
    for city in (one, three):
        shapes = city.layout.buildings.geometry.to_numpy()
        own = city.layout.buildings["source"].str.startswith(f"made/{kind}/").to_numpy()
        first, second = shapely.STRtree(shapes).query(shapes, predicate="overlaps")
        assert not (own[first] | own[second]).any()
        assert shapely.contains(shapely.box(*city.layout.extent), shapes[own]).all()


def crossings(city, lines):
    """Count where streets cross lines, by their geometry; both tracks of a railway are one."""
    roads = city.layout.roads
    streets = shapely.union_all(roads.geometry[roads["kind"].isin(DRIVABLE)].to_numpy())
    spots = shapely.intersection(streets, shapely.union_all(lines.geometry.to_numpy()))
    return 0 if spots.is_empty else len(shapely.get_parts(shapely.buffer(spots, 8.0)))


@pytest.mark.parametrize("count", [1, 2, 4])
def test_a_wall_has_as_many_gates_as_asked(bare, count):
    city = elements(bare, kind="city_wall", most=1, parts=count, height=8.0)
    walls = city.layout.lines[city.layout.lines["kind"] == "city_wall"]
    assert len(walls) == 1
    assert walls["height"].tolist() == [8.0]
    assert crossings(city, walls) == count
    towers = city.layout.points[city.layout.points["kind"] == "wall_tower"]
    assert len(towers) >= 2 * count
    assert (towers.distance(walls.geometry.iloc[0]) < 0.1).all()
    ring = shapely.Polygon(walls.geometry.iloc[0])
    assert not city.layout.buildings.intersects(ring.exterior.buffer(3.0)).any()
    assert ring.area > 0.4 * 520.0**2


@pytest.mark.parametrize("count", [0, 1, 3])
def test_a_railway_has_as_many_level_crossings_as_asked(bare, count):
    city = elements(bare, kind="railway", most=1, parts=count)
    rails = city.layout.roads[city.layout.roads["kind"] == "rail"]
    assert len(rails) == 2
    assert crossings(city, rails) == count
    with_station = elements(city, kind="station", most=1)
    hall = with_station.layout.buildings.query("use == 'train_station'").geometry.iloc[0]
    assert rails.distance(hall).min() < 150.0


@pytest.mark.parametrize("count", [1, 2, 4])
def test_a_tram_line_runs_in_a_street_and_has_its_stops(bare, count):
    city = elements(bare, kind="tram_line", most=1, parts=count)
    roads, points = city.layout.roads, city.layout.points
    tracks = roads[roads["kind"] == "tram"].geometry.to_numpy()
    streets = roads[roads["kind"].isin(DRIVABLE)]
    beds = shapely.buffer(streets.geometry.to_numpy(), streets["width"].to_numpy() / 2)
    assert shapely.covered_by(tracks, shapely.union_all(beds).buffer(0.01)).all()
    stops = points[points["kind"] == "tram_stop"]
    assert len(stops) == count
    assert (shapely.distance(stops.geometry.to_numpy(), shapely.union_all(tracks)) < 15.0).all()


@pytest.mark.parametrize("side", ["north", "east", "west"])
def test_a_power_line_runs_along_a_side_from_pylon_to_pylon(bare, side):
    city = elements(bare, kind="power_line", side=side)
    line = city.layout.lines.query("kind == 'power_line'").geometry.iloc[0]
    pylons = city.layout.points.query("kind == 'power_tower'").geometry.to_numpy()
    assert len(pylons) >= 5
    inner = shapely.points(shapely.get_coordinates(line)[1:-1])
    assert shapely.distance(inner, shapely.union_all(pylons)).max() < 0.1
    assert line.length == pytest.approx(520.0, abs=1.0)
    assert measure(f"side(power_line) == {side}", city).met


@pytest.mark.parametrize(
    ("relation", "predicate"),
    [
        ("near", "dist(building, tag=church, building, tag=school) <= 150"),
        ("opposite", "opposite(building, tag=church, building, tag=school)"),
        ("behind", "behind(building, tag=church, building, tag=school)"),
        ("before", "before(building, tag=church, building, tag=school)"),
    ],
)
def test_relations_to_other_elements_hold(bare, relation, predicate):
    school = elements(bare, kind="school", most=1, side="west")
    city = elements(school, kind="church", most=1, near="school", relation=relation)
    assert all(measure(goal.predicate, city).met for goal in city.goals)
    church, hall = (
        city.layout.buildings.query(f"use == '{use}'").geometry.iloc[0]
        for use in ("church", "school")
    )
    assert church.distance(hall) <= 150.0
    assert measure(predicate, city).met
    roads = city.layout.roads
    streets = roads[roads["kind"].isin(DRIVABLE)].geometry.to_numpy()
    way = shapely.shortest_line(church, hall)
    if relation == "opposite":
        assert shapely.crosses(streets, way).any()
    if relation == "behind":  # the street is nearer to the school
        assert shapely.distance(streets, hall).min() < shapely.distance(streets, church).min() + 40


@pytest.mark.parametrize("metres", [60.0, 100.0, 200.0])
def test_distances_are_kept(bare, metres):
    school = elements(bare, kind="school", most=1, side="middle")
    city = elements(school, kind="hotel", most=1, near="school", metres=metres)
    hotel, hall = (
        city.layout.buildings.query(f"use == '{use}'").geometry.iloc[0]
        for use in ("hotel", "school")
    )
    assert hotel.distance(hall) == pytest.approx(metres, abs=max(0.1 * metres, 5.0))


def test_a_thing_stands_in_a_park_between_and_around(bare):
    city = elements(bare, kind="statue", near="park", relation="in")
    point = city.layout.points.query("kind == 'statue'").geometry.iloc[0]
    parks = shapely.union_all(bare.layout.areas.query("kind == 'park'").geometry.to_numpy())
    assert parks.contains(point)
    both = elements(elements(bare, kind="school", most=1, side="west"), kind="church", side="east")
    city = elements(both, kind="hotel", near="school", relation="between", second="church")
    assert measure(city.goals[-1].predicate, city).met
    town = elements(bare, kind="school", most=1, side="middle")
    city = elements(town, kind="greenhouse", least=3, near="school", relation="around")
    assert measure("around(building, tag=greenhouse, building, tag=school)", city).met


@pytest.mark.parametrize("corner", ["northeast", "southwest"])
def test_a_thing_stands_in_a_corner_of_the_site(bare, corner):
    city = elements(bare, kind="school", most=1, side=corner)
    assert measure(f"side(building, tag=school) == {corner}", city).met
    assert measure(city.goals[-1].predicate, city).met
    other = "northwest" if corner == "northeast" else "northeast"
    assert not measure(f"side(building, tag=school) == {other}", city).met


def test_a_helipad_stands_on_a_flat_roof_and_a_market_on_a_square(bare):
    city = elements(elements(bare, kind="hospital", most=1), kind="helipad", near="hospital",
                    relation="on")  # fmt: skip
    pad = city.layout.points.query("kind == 'helipad'").geometry.iloc[0]
    roofs = city.layout.parts.query("roof_shape == 'flat'")
    assert roofs.contains(pad.buffer(7.0)).any()
    church = elements(bare, kind="church", most=1)
    with pytest.raises(ActionFailed, match="No church has a flat roof with room for a helipad"):
        elements(church, kind="helipad", near="church", relation="on")
    square = places(bare, kind="plaza", count=1)
    city = elements(square, kind="market", most=1, near="plaza", relation="in")
    assert all(measure(goal.predicate, city).met for goal in city.goals)
    assert measure("n(plaza) == 1", city).met


def test_what_it_stands_near_to_must_be_there(bare):
    with pytest.raises(ActionFailed, match="There is no castle for a church to be near"):
        elements(bare, kind="church", near="castle")


def test_what_cannot_be_placed_is_refused_by_name(bare):
    with pytest.raises(ActionFailed, match="No block is free for a castle, which takes 58 m by"):
        elements(bare, kind="castle", least=120)


@pytest.mark.parametrize("kind", [name for name, one in ELEMENTS.items() if one.where == "shore"])
def test_what_belongs_to_the_shore_stands_there(by_the_sea, kind):
    city = elements(by_the_sea, kind=kind, least=2, most=2)
    areas, tables = city.layout.areas, (city.layout.buildings, city.layout.points)
    sea = areas[areas["kind"] == "sea"].geometry.union_all()
    for table in tables:
        own = table[table["source"].str.startswith(f"made/{kind}/").to_numpy(bool)]
        assert (own.distance(sea) < 20.0).all()
        assert not own.intersects(sea).any()


def test_piers_and_breakwaters_reach_into_the_water(by_the_sea):
    for kind in ("pier", "breakwater"):
        city = elements(by_the_sea, kind=kind, least=2, most=2)
        areas = city.layout.areas
        sea = areas[areas["kind"] == "sea"].geometry.union_all()
        own = areas[areas["source"].str.startswith(f"made/{kind}/").to_numpy(bool)]
        assert (own.intersection(sea).area > 0.8 * own.area).all()
    with pytest.raises(ActionFailed, match="No shore has water free for a pier"):
        elements(by_the_sea, kind="pier", least=150)


def test_no_pier_without_water(bare):
    with pytest.raises(ActionFailed, match="No shore has water free for a breakwater"):
        elements(bare, kind="breakwater")


def test_sides_are_kept(bare):
    for side in ("north", "east", "south", "west"):
        city = elements(bare, kind="church", side=side)
        assert measure(f"side(building, tag=church) == {side}", city).met


def test_things_of_squares_stand_on_squares_where_there_are_any(bare):
    city = elements(bare, kind="fountain", least=1, most=1)
    point = city.layout.points.query("kind == 'fountain'").geometry.iloc[0]
    area = city.layout.areas[city.layout.areas.contains(point)]
    assert set(area["kind"]) & {"pedestrian", "park"}


def test_the_same_town_gets_the_same_elements(bare):
    cities = [elements(bare, kind="school", least=2, side="north") for _ in range(2)]
    assert content_hash(cities[0]).total == content_hash(cities[1]).total


@pytest.mark.parametrize("kind", [kind for kind in ELEMENTS if not ELEMENTS[kind].builder])
def test_drawings_are_sound(kind):
    element = ELEMENTS[kind]
    lot = lot_of(element)
    drawn = (*element.parts, *element.areas, *element.beside)
    assert all(lot.contains(plan_of(item)) for item in drawn)
    assert all(lot.contains(shapely.Point(item.at)) for item in element.points)
    assert all(land_kind(item.tags) for item in element.areas)
    assert all(point_kind(item.tags) for item in element.points)
    whole = shapely.union_all([plan_of(part) for part in element.parts])
    assert not element.parts or whole.geom_type == "Polygon"


@pytest.mark.sweep(228)
@pytest.mark.parametrize("kind", ELEMENTS)
@pytest.mark.parametrize(
    ("count", "text"), [(3, "with three {}"), (1, "with one {}"), (0, "without any {}")]
)
def test_every_element_has_a_word_and_is_planned_by_it(kind, count, text):
    word = next(group[kind] for group in NOUNS.values() if kind in group).split(",")[0]
    word = word if count < 2 else f"{word}es" if word.endswith("ss") else f"{word.rstrip('s')}s"
    slots = slots_of_brief(read_brief(f"A town {text.format(word)}"))
    wished = [args for action, args in slots[DO] if action == "layout/elements-v1"]
    assert wished == [{"kind": kind, "least": count, "most": count}]
    assert things(kind) == ELEMENTS[kind].measure


@pytest.mark.parametrize(
    "kinds",
    [("city_wall", "railway"), ("railway", "city_wall"), ("power_line", "railway"),
     ("city_wall", "golf_course", "forest", "wind_turbine")],
)  # fmt: skip
def test_what_is_built_later_leaves_the_lines_of_before(bare, kinds):
    city = bare
    for kind in kinds:
        city = elements(city, kind=kind, least=1, most=1)
    assert [count_of(city, ELEMENTS[kind]) for kind in kinds] == [1] * len(kinds)
    lines = city.layout.lines.geometry.to_numpy()
    beds = city.layout.areas[city.layout.areas["source"].str.endswith("/bed")]
    within = shapely.length(shapely.intersection(lines, beds.geometry.union_all()))
    assert (within < 4 * 11.0).all()  # over the bed, not along it
    towers = city.layout.points[city.layout.points["kind"] == "wall_tower"]
    assert not towers.intersects(beds.geometry.union_all()).any()


@pytest.mark.parametrize(
    ("kind", "other"),
    [("barn", "farmyard"), ("wind_turbine", "meadow"), ("solar_field", "meadow"),
     ("golf_course", "sports_field")],
)  # fmt: skip
def test_an_element_is_not_counted_as_another_one(bare, kind, other):
    city = elements(bare, kind=kind, least=1, most=1)
    assert count_of(city, ELEMENTS[other]) == count_of(bare, ELEMENTS[other])
    both = elements(city, kind=other, least=1, most=1)
    assert [count_of(both, ELEMENTS[one]) for one in (kind, other)] == [1, 1]


def test_no_gate_is_where_a_street_runs_along_the_wall():
    start = City("Town", Frame(50.0, 10.0), Layout((0.0, 0.0, 1.0, 1.0)), seed=3)
    small = town(start, width=280.0, depth=280.0)
    for count in (1, 2):
        city = elements(small, kind="city_wall", most=1, parts=count)
        walls = city.layout.lines[city.layout.lines["kind"] == "city_wall"]
        assert crossings(city, walls) == count


def test_a_railway_runs_where_as_many_streets_can_cross_it_as_asked():
    start = City("Town", Frame(50.0, 10.0), Layout((0.0, 0.0, 1.0, 1.0)), seed=3)
    city = elements(town(start, width=280.0, depth=280.0), kind="railway", most=1, parts=2)
    assert measure("n(level_crossing) == 2", city).met


def test_a_warehouse_has_paving_before_its_docks(bare):
    city = elements(bare, kind="warehouse", least=1, most=1)
    own = city.layout.buildings["source"].str.startswith("made/warehouse/")
    (hall,) = city.layout.buildings.geometry[own]
    paved = city.layout.areas[city.layout.areas["kind"] == "road_area"].geometry.union_all()
    before = paved.intersection(hall.buffer(13.0))
    assert before.area > 45.0 * 12.0
    assert not hall.intersects(paved.buffer(-0.05))


def test_a_street_goes_on_behind_a_level_crossing():
    start = City("Town", Frame(50.0, 10.0), Layout((0.0, 0.0, 1.0, 1.0)), seed=3)
    city = elements(town(start, width=400.0, depth=400.0), kind="railway", most=1, parts=2)
    roads = elements(city, kind="city_wall", most=1).layout.roads
    rails = roads.geometry[roads["kind"] == "rail"].union_all()
    streets = roads.geometry[roads["kind"].isin(DRIVABLE)].to_numpy()
    tips = shapely.get_point(streets, [[0], [-1]]).ravel()
    at_rails = tips[shapely.dwithin(tips, rails, 6.0)]
    assert all((shapely.distance(tips, tip) < 0.1).sum() > 1 for tip in at_rails)
