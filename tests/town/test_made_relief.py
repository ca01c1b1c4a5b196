"""Land that is asked for in words: its form, metres and sides, read from heights alone."""

import numpy as np
import pytest

from cityx.checks.height_checks import steep_share
from cityx.checks.predicates import measure
from cityx.city import City, Frame, Layout
from cityx.city.content import content_hash
from cityx.errors import ActionFailed
from cityx.road.heights.way_heights import heights
from cityx.road.network.network import network
from cityx.terrain.relief import USUAL, relief
from cityx.town.coast import coast
from cityx.town.town import town
from cityx.town.wishes.river import river


@pytest.fixture(scope="module")
def bare():
    start = City("Town", Frame(50.0, 10.0), Layout((0.0, 0.0, 1.0, 1.0)), seed=3)
    return town(start, width=360.0, depth=360.0)


def grid_of(city, count=25):
    """Sample heights from the south-west corner, rows from south to north."""
    xmin, ymin, xmax, ymax = city.layout.extent
    x, y = np.meshgrid(np.linspace(xmin, xmax, count), np.linspace(ymin, ymax, count))
    return city.terrain.height_at(np.column_stack([x.ravel(), y.ravel()])).reshape(x.shape)


@pytest.mark.parametrize("form", USUAL)
def test_every_form_is_measured_as_what_it_is_called(bare, form):
    city = relief(bare, form=form)
    word = {"hills": "hilly", "mountains": "hilly"}.get(form, form)
    assert measure(f"terrain.form == {word}", city).met
    assert measure("terrain.form == flat", bare).met
    for goal in city.goals[len(bare.goals) :]:
        assert measure(goal.predicate, city).met, goal


@pytest.mark.parametrize("metres", [8.0, 14.0, 20.0])
def test_metres_are_kept(bare, metres):
    for form in ("hill", "slope", "ridge"):
        assert np.ptp(grid_of(relief(bare, form=form, metres=metres))) == pytest.approx(
            metres, rel=0.05
        )


@pytest.mark.parametrize("side", ["north", "east", "south", "west"])
def test_a_slope_has_its_grade_and_its_high_side(bare, side):
    z = grid_of(relief(bare, form="slope", grade=0.07, side=side))
    edge = {"north": z[-1], "south": z[0], "east": z[:, -1], "west": z[:, 0]}
    other = {"north": "south", "south": "north", "east": "west", "west": "east"}[side]
    assert edge[side].mean() - edge[other].mean() == pytest.approx(0.07 * 360.0, rel=0.03)


@pytest.mark.parametrize("steps", [2, 3, 5])
def test_terraces_are_counted(bare, steps):
    assert measure("terrain.steps >= 0", relief(bare, form="terraces", steps=steps)).value == steps


def test_a_hill_is_high_in_the_middle_and_a_valley_low(bare):
    for form, sign in (("hill", 1), ("valley", -1)):
        z = grid_of(relief(bare, form=form))
        assert sign * (z[12, 12] - z[0].mean()) > 5
        assert sign * (z[12, 12] - z[-1].mean()) > 5


@pytest.mark.parametrize("side", ["any", "middle", "north"])
def test_a_valley_lies_along_its_river(bare, side):
    city = relief(river(bare, width=20.0, side=side), form="valley", metres=12.0)
    z = grid_of(city)
    water = city.layout.areas[city.layout.areas["kind"] == "river"].geometry.union_all()
    assert z.min() == pytest.approx(city.terrain.height_at([water.centroid.coords[0]])[0], abs=0.3)
    assert z[0].mean() > 3.0
    if side == "middle":
        assert measure("terrain.form == valley", city).met


@pytest.mark.parametrize("size", [300.0, 420.0])
def test_gentle_hills_are_hills_on_any_site(size):
    start = City("Town", Frame(50.0, 10.0), Layout((0.0, 0.0, 1.0, 1.0)), seed=5)
    city = relief(town(start, width=size, depth=size), form="hills", steepest=0.08)
    assert measure("terrain.form == hilly", city).met


@pytest.mark.parametrize("form", ["hills", "valley", "slope"])
def test_water_lies_level(bare, form):
    for wet in (river(bare, width=20.0), coast(bare, side="south", share=0.2)):
        city = relief(wet, form=form)
        kinds = city.layout.areas["kind"].isin(("river", "sea"))
        for shape in city.layout.areas[kinds].geometry:
            inner = np.array(shape.buffer(-3.0).exterior.coords)
            assert np.ptp(city.terrain.height_at(inner)) < 0.3


@pytest.mark.parametrize(
    "args",
    [
        {"form": "plateau", "metres": 12.0},
        {"form": "slope", "grade": 0.15, "side": "west"},
        {"form": "hill", "metres": 26.0},
    ],
)
def test_streets_keep_their_grades_on_steep_land(bare, args):
    from dataclasses import replace

    city = relief(bare, **args)
    city = heights(network(replace(city, made={"terrain/relief-v1": args})))
    assert steep_share(city) <= 0.01


def test_what_is_too_steep_is_refused_with_what_would_do(bare):
    with pytest.raises(ActionFailed, match=r"35 % are the most. Ask for 4\d m at most"):
        relief(bare, form="hill", metres=90.0)


def test_gentle_land_is_gentle_and_steep_land_steep(bare):
    assert measure("terrain.steep <= 0.12", relief(bare, steepest=0.08)).met
    assert measure("terrain.steep >= 0.12", relief(bare, steep=True)).met


def test_the_same_town_gets_the_same_land(bare):
    first, second = (relief(bare, form="hills") for _ in range(2))
    assert content_hash(first).total == content_hash(second).total
