"""What can be said of elements is built, and measured in what was built."""

import numpy as np
import pytest

from cityx.checks.predicates import measure
from cityx.city import City, Frame, Layout
from cityx.city.content import content_hash
from cityx.edit.land.ring import ring
from cityx.edit.objects.dress import DRESSED, dress
from cityx.errors import ActionFailed, UsageError
from cityx.nature.furniture.furnishing import furniture
from cityx.nature.furniture.tagged_looks import LARGEST, Size, look_of_tags
from cityx.road.ground.ground_surface import ground
from cityx.town.coast import coast
from cityx.town.elements import ATTRIBUTES, ELEMENTS, OTHER_THINGS, attributes_of, looked_at
from cityx.town.lots import body_of, in_metres
from cityx.town.town import town
from cityx.town.wishes.elements import elements


@pytest.fixture(scope="module")
def bare():
    start = City("Town", Frame(50.0, 10.0), Layout((0.0, 0.0, 1.0, 1.0)), seed=3)
    return coast(town(start, width=300.0, depth=300.0), side="south", share=0.2)


@pytest.fixture(scope="module")
def built(bare):
    city = bare
    for kind in ("statue", "parking_lot", "playground", "fountain"):
        city = elements(city, kind=kind)
    return furniture(ground(city))


@pytest.mark.parametrize(
    ("kind", "told", "size"),
    [
        ("pier", {"length": 60.0}, (60.0, 5.2)),
        ("barn", {"length": 40.0}, (40.0, 16.0)),
        ("barn", {"width": 20.0}, (30.0, 20.0)),
        ("playground", {"length": 40.0, "width": 25.0}, (40.0, 25.0)),
        ("windmill", {"length": 12.0}, (12.0, 9.0)),
    ],
)
def test_elements_are_as_long_and_wide_as_is_said(kind, told, size):
    xmin, ymin, xmax, ymax = body_of(in_metres(ELEMENTS[kind], **told)).bounds
    got = sorted((xmax - xmin, ymax - ymin), reverse=True)
    assert got[0] == pytest.approx(size[0], rel=0.02)
    if kind != "windmill":  # its sails reach beyond its walls
        assert got[1] == pytest.approx(size[1], rel=0.02)


def test_a_lot_keeps_the_margins_of_its_element():
    usual, long = ELEMENTS["barn"], in_metres(ELEMENTS["barn"], length=40.0)
    (x, y), (width, depth) = usual.lot, long.lot
    assert width == x
    assert depth == pytest.approx(y + 16.0, abs=0.01)


def test_what_is_beyond_reason_is_refused_with_what_is_usual():
    with pytest.raises(ActionFailed, match=r"usually takes 45 m by 5 m, and may be 6 times"):
        in_metres(ELEMENTS["pier"], length=900.0)


@pytest.mark.parametrize(
    ("kind", "told", "predicates"),
    [
        ("pier", {"length": 30.0}, ("n(pier, length in [27, 33]) >= 1",)),
        ("bus_station", {"width": 26.0}, ("n(bus_station, width in [25, 27]) >= 1",)),
        ("warehouse", {"width": 26.0, "length": 60.0},
         ("n(building, type=warehouse, length in [57, 63], width in [24, 28]) >= 1",)),
    ],
)  # fmt: skip
def test_lengths_and_widths_are_measured_in_the_town(bare, kind, told, predicates):
    made = elements(bare, kind=kind, **told)
    for predicate in predicates:
        found = measure(predicate, made)
        assert found.met, found.evidence
    assert all(measure(goal.predicate, made).met for goal in made.goals[len(bare.goals) :])


def test_a_thing_is_of_a_material_a_colour_and_a_height(built):
    made = dress(built, kind="statue", material="bronze", height=6.0)
    assert measure("share(statue, material=bronze) == 1.0", made).met
    assert measure("stat(statue, height, mean) in [5.9, 6.1]", made).met
    assert not measure("share(statue, material=bronze) > 0", built).met
    red = dress(made, kind="statue", color=0xD02018)
    assert measure("share(statue, color=red) == 1.0", red).met
    assert not measure("share(statue, color=red) > 0", made).met


def test_what_is_larger_than_things_are_built_is_told(built):
    made = dress(built, kind="statue", height=300.0)
    assert "A statue is 0.25 to 6 times as large as usual at most" in made.notes[-1]
    assert measure("stat(statue, height, mean) in [20, 30]", made).met


def test_several_looks_take_turns(built):
    more = furniture(ground(elements(built, kind="statue", least=2, most=2)))
    for turn, material in enumerate(("bronze", "stone")):
        more = dress(more, kind="statue", material=material, turn=turn, turns=2)
    assert measure("n(statue, material=bronze) == 1", more).met
    assert measure("n(statue, material=stone) == 1", more).met


def test_dressing_writes_to_no_input_and_is_the_same_again(built):
    before = content_hash(built).total
    first, second = (dress(built, kind="fountain", color=0x2040C0) for _ in range(2))
    assert content_hash(built).total == before
    assert content_hash(first).total == content_hash(second).total != before


def test_what_is_dressed_stays_so_when_it_is_furnished_again(built):
    made = dress(built, kind="statue", material="bronze", color=0x2040C0)
    again = furniture(ground(made))
    assert measure("share(statue, material=bronze) == 1.0", again).met
    assert measure("share(statue, color=blue) == 1.0", again).met


def test_land_is_paved_and_painted(built):
    made = dress(built, kind="parking_lot", material="gravel")
    assert measure("share(parking, material=gravel) == 1.0", made).met
    assert measure("share(parking, material=asphalt) == 1.0", built).met
    blue = dress(built, kind="playground", color=0x2040C0)
    assert measure("share(playground, color=blue) == 1.0", blue).met


def test_a_material_that_things_are_not_of_is_refused_by_name(built):
    with pytest.raises(UsageError, match=r"A statue is not of gravel; it may be of wood, stone"):
        dress(built, kind="statue", material="gravel")


def test_a_fence_goes_round_a_playground(built):
    assert not measure("enclosed(fence, playground) >= 0.6", built).met
    made = ring(built, kind="playground", barrier="fence", height=1.5)
    assert measure("enclosed(fence, playground) >= 0.6", made).met
    assert measure("stat(fence, height, mean) in [1.49, 1.51]", made).met


@pytest.mark.parametrize(
    ("size", "factors"),
    [
        (Size(height=6.0), (3.0, 3.0, 3.0)),
        (Size(length=8.0), (1.0, 2.0, 1.0)),
        (Size(width=4.0, height=1.0), (2.0, 0.5, 0.5)),
        (Size(scale=1.5), (1.5, 1.5, 1.5)),
        (Size(height=900.0), (LARGEST, LARGEST, LARGEST)),
    ],
)
def test_a_thing_grows_as_is_said(size, factors):
    assert size.factors(np.array([2.0, 4.0, 2.0])) == pytest.approx(factors)


@pytest.mark.parametrize(
    ("tags", "look"),
    [
        ('{"material": "marble", "colour": "white"}', ("stone", 0xFFFFFF)),
        ('{"material": "cast_iron"}', ("metal", -1)),
        ('{"material": "cheese", "color": "#a52"}', ("", 0xAA5522)),
        ("", ("", -1)),
    ],
)
def test_tags_of_maps_tell_looks(tags, look):
    found = look_of_tags(tags)
    assert (found.material, found.color) == look


def test_what_can_be_said_of_each_is_known():
    for word in (*ELEMENTS, *OTHER_THINGS):
        assert attributes_of(word) <= set(ATTRIBUTES)
        assert looked_at(word)
    assert "roof" not in attributes_of("fountain")
    assert "height" not in attributes_of("playground")
    assert {"statue", "market", "bridge", "city_wall", "pier", "bench"} <= set(DRESSED)
    assert not {"church", "campus", "railway"} & set(DRESSED)
