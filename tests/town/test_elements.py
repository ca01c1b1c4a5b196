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
from cityx.sources.features.kinds import land_kind, point_kind
from cityx.town.coast import coast
from cityx.town.elements import ELEMENTS
from cityx.town.lots import lot_of, plan_of
from cityx.town.town import town
from cityx.town.wishes.elements import elements


@pytest.fixture(scope="module")
def bare():
    start = City("Town", Frame(50.0, 10.0), Layout((0.0, 0.0, 1.0, 1.0)), seed=3)
    return town(start, width=520.0, depth=520.0)


@pytest.fixture(scope="module")
def by_the_sea(bare):
    return coast(bare, side="south", share=0.25, quay=42.0)


def count_of(city, element):
    """Count an element by what stands in the tables, not by what was meant."""
    if element.building or element.areas:
        return measure(f"n({element.measure}) >= 0", city).value
    kind = point_kind(element.points[0].tags)
    return int((city.layout.points["kind"] == kind).sum())


@pytest.mark.parametrize("kind", ELEMENTS)
def test_one_three_and_none_are_measured(bare, by_the_sea, kind):
    element = ELEMENTS[kind]
    town = by_the_sea if element.where in ("shore", "water") else bare
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


@pytest.mark.parametrize("kind", ELEMENTS)
def test_drawings_are_sound(kind):
    element = ELEMENTS[kind]
    lot = lot_of(element)
    assert all(lot.contains(plan_of(item)) for item in (*element.parts, *element.areas))
    assert all(lot.contains(shapely.Point(item.at)) for item in element.points)
    assert all(land_kind(item.tags) for item in element.areas)
    assert all(point_kind(item.tags) for item in element.points)
    whole = shapely.union_all([plan_of(part) for part in element.parts])
    assert not element.parts or whole.geom_type == "Polygon"


@pytest.mark.parametrize("kind", ELEMENTS)
@pytest.mark.parametrize(
    ("count", "text"), [(3, "with three {}s"), (1, "with one {}"), (0, "without any {}")]
)
def test_every_element_has_a_word_and_is_planned_by_it(kind, count, text):
    word = next(group[kind] for group in NOUNS.values() if kind in group).split(",")[0]
    slots = slots_of_brief(read_brief(f"A town {text.format(word)}"))
    wished = [args for action, args in slots[DO] if action == "layout/elements-v1"]
    assert wished == [{"kind": kind, "least": count, "most": count}]
    assert things(kind) == ELEMENTS[kind].measure
