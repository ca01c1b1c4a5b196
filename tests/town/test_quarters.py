"""What most buildings are in a part of a town, and along what lies in it: built, and measured."""

import numpy as np
import pytest

from cityx.checks.predicates import measure
from cityx.city import City, Frame, Layout
from cityx.errors import ActionFailed, UsageError
from cityx.town.quarter_kinds import KINDS
from cityx.town.town import town
from cityx.town.wishes.quarters import quarter
from cityx.town.wishes.river import river


@pytest.fixture(scope="module")
def city():
    bare = City("Town", Frame(50.0, 10.0), Layout((0.0, 0.0, 1.0, 1.0)), seed=5)
    return river(town(bare, width=500.0, depth=500.0, zone="midrise"))


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("where", [{"part": "north"}, {"near": "river"}])
def test_most_buildings_there_are_of_the_kind_and_few_elsewhere(city, kind, where):
    changed = quarter(city, kind=kind, **where)
    found = measure(changed.goals[-1].predicate, changed)
    assert found.met, found.evidence
    again = quarter(city, kind=kind, **where)
    assert changed.layout.buildings.equals(again.layout.buildings)
    ids = set(city.layout.buildings["id"]) & set(changed.layout.buildings["id"])
    assert len(ids) > 0.2 * len(city.layout.buildings)  # what is elsewhere stays


def test_houses_that_are_built_anew_do_not_overlap_nor_leave_the_site(city):
    changed = quarter(city, kind="terrace", near="river")
    shapes = changed.layout.buildings.geometry
    xmin, ymin, xmax, ymax = changed.layout.extent
    assert np.all(shapes.bounds.to_numpy() >= [xmin, ymin, xmin, ymin])
    assert np.all(shapes.bounds.to_numpy() <= [xmax, ymax, xmax, ymax])
    first, second = shapes.sindex.query(shapes, predicate="intersects")
    pairs = first < second
    shared = shapes.iloc[first[pairs]].intersection(shapes.iloc[second[pairs]], align=False).area
    assert shared.max() < 0.05


def test_two_kinds_share_one_place(city):
    one = quarter(city, kind="shop", near="river", share=0.5)
    both = quarter(one, kind="office", near="river", share=0.5, begin=0.5)
    for goal in both.goals[-2:]:
        found = measure(goal.predicate, both)
        assert found.met, found.evidence


def test_a_quarter_without_a_place_is_refused(city):
    with pytest.raises(UsageError, match="where the quarter is"):
        quarter(city, kind="house")
    with pytest.raises(ActionFailed, match="no castle"):
        quarter(city, kind="house", near="castle")


@pytest.mark.parametrize(
    "text",
    [
        "A town with offices in the north, low houses in the south",
        "A small town with a river, terraced houses along the river",
        "A town whose square is surrounded by shops and offices",
        "Villas at the edge, flats in the middle of a town",
        "A town with a church and two playgrounds near the church",
    ],
)
def test_a_sentence_about_parts_of_a_town_is_built(check_sentence, text):
    check_sentence(text)
