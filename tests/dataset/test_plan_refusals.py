from dataclasses import replace

import numpy as np
import pytest
from crossing_town import HOUSES
from moving_city import moving
from planned_town import planned, stage, town

from cityx.city import City, Frame, Layout
from cityx.dataset.plans.plan_site import Site, Wishes
from cityx.dataset.plans.planning import plan
from cityx.dataset.plans.takes import Take, still
from cityx.dataset.plans.views import judged
from cityx.dataset.rigs import RIGS
from cityx.errors import InputError, UsageError

IN_HOUSE = (-20.0, 14.0, 2.0)  # the house from (-30, 8) to (-12, 20), 9 m high
AT_WALL = (-20.0, 7.7, 1.7)
OPEN = (-20.0, 4.3, 1.7)


def verdict(eye, heading=np.pi / 2, *, city=None, moment=0.0, rig="mono"):
    take = still(np.array(eye, float), heading, 0.0, moment, 1.2)
    site = Site(city or town(), Wishes(0, 1, 10.0, size=(160, 120)), stage())
    return judged(site, [take], RIGS[rig])[0]


def test_an_eye_on_the_pavement_may_look_along_the_street():
    still_town = replace(town(), tracks=None)
    assert verdict(OPEN, city=still_town) is None


@pytest.mark.parametrize(
    ("eye", "heading", "reason", "detail"),
    [
        (IN_HOUSE, 0.0, "inside something", "the eye is inside building 000000000000000b"),
        ((0.0, 0.0, -1.0), 0.0, "underground", "the eye is under the ground"),
        (AT_WALL, np.pi, "too near to something", "0.30 m from building 000000000000000b"),
        ((0.0, 0.0, 0.3), 0.0, "too near to something", "0.30 m from"),
        ((-20.0, 6.5, 1.7), 0.0, "too near to something", "of the picture nearer than 2.5 m"),
        ((-21.0, 4.2, 1.7), 0.0, "before a wall", "of the picture nearer than 5 m"),
        ((65.0, 0.0, 1.7), np.pi / 2, "off the map", "of the picture beyond the border"),
    ],
)
def test_what_may_not_be_is_named_with_its_cause(eye, heading, reason, detail):
    found = verdict(eye, heading, city=replace(town(), tracks=None))
    assert found is not None
    assert found.reason == reason
    assert detail in found.detail


def test_an_eye_in_the_air_that_sees_only_sky_is_refused():
    take = still(np.array([0.0, 0.0, 20.0]), 0.0, 1.0, 0.0, 1.2)
    site = Site(town(), Wishes(0, 1, 10.0, size=(160, 120)), stage())
    assert judged(site, [take], RIGS["mono"])[0].reason == "nothing but sky"


def test_a_passing_car_is_in_the_way_at_its_moment_alone():
    car = [(100, "car_sedan", "car", "ride", (-60.0, -1.5, 0.0), 0.0, 5.0)]
    city = replace(town(), tracks=moving(*car, seconds=10.0).tracks)
    eye = (-30.0, -1.5, 1.6)
    assert verdict(eye, city=city, moment=6.0).reason == "in the way of traffic"
    assert verdict(eye, city=city, moment=0.0) is None
    before = verdict((-26.0, -1.5, 1.2), -np.pi / 2, city=city, moment=6.0)
    assert before is not None  # the car fills the picture
    assert before.reason in ("before a wall", "too near to something")


def test_every_eye_of_a_rig_must_be_free():
    eye = (-20.0, 7.3, 1.7)
    city = replace(town(), tracks=None)
    assert verdict(eye, 1.9, city=city) is None
    assert verdict(eye, 1.9, city=city, rig="surround").reason == "too near to something"


def test_eyes_are_as_high_above_what_they_stand_on_as_they_should_be():
    site = Site(replace(town(), tracks=None), Wishes(0, 1, 10.0, size=(160, 120)), stage())
    roof = still(np.array([-21.0, 14.0, 10.6]), 0.0, 0.0, 0.0, 1.2, foot=1.6)
    air = still(np.array([-20.0, 4.3, 3.0]), 1.6, 0.0, 0.0, 1.2, foot=1.6)
    feet = still(np.array([-20.0, 4.3, 1.72]), 1.6, 0.0, 0.0, 1.2, foot=1.6)
    low = still(np.array([-21.0, 14.0, 10.6]), 0.0, 0.0, 0.0, 1.2, foot=3.0)
    found = judged(site, [roof, air, feet, low], RIGS["mono"], composed=False)
    assert found[0] is None  # as high above the roof as it should be
    assert found[1].reason == "not on the ground"
    assert found[1].detail.startswith("2.88 m above sidewalk ")
    assert found[2] is None
    assert found[3].reason == "not on the ground"


def test_a_flight_must_be_free_between_its_poses():
    eyes = np.array([[-50.0, 14.0, 5.0], [5.0, 14.0, 5.0]])  # with the house between them
    way = np.column_stack([np.arange(-50.0, 5.0), np.full(55, 14.0), np.full(55, 5.0)])
    take = Take(eyes, np.zeros(2), np.full(2, -0.3), np.zeros(2), 1.2)
    site = Site(town(), Wishes(0, 2, 1.0, size=(160, 120)), stage())
    free, blocked = judged(site, [take, replace(take, way=way)], RIGS["mono"])
    assert free is None
    assert blocked.reason in ("inside something", "too near to something")


def test_a_target_behind_a_house_is_hidden():
    behind = np.array([[-21.0, 40.0, 1.0]])
    take = still(np.array([-21.0, -2.0, 1.7]), 0.0, 0.1, 0.0, 1.2)
    site = Site(replace(town(), tracks=None), Wishes(0, 1, 10.0, size=(160, 120)), stage())
    hidden = judged(site, [replace(take, target=behind)], RIGS["mono"])[0]
    assert hidden.reason == "the target is hidden"
    shown = np.array([[-21.0, 7.0, 1.0]])
    assert judged(site, [replace(take, target=shown)], RIGS["mono"])[0] is None


def test_a_plan_without_a_legal_view_says_what_was_tried():
    with pytest.raises(InputError) as error:
        planned("orbit", 5, target="middle", radius=1.0, height=-3.0, length=5)
    text = str(error.value)
    assert text.startswith("no legal orbit view of crossing found among 120 candidates, refused")
    assert "120 underground (the eye is under the ground at (" in text


def test_too_few_legal_views_are_told_with_their_number(monkeypatch):
    from cityx.dataset.plans import planning

    monkeypatch.setattr(planning, "HOPE", (3, 3))
    with pytest.raises(InputError, match=r"only \d+ of 900 legal aerial views of crossing found"):
        planned("aerial", 900)


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("street", "there are no streets in empty, so nobody can stand on one."),
        ("drive", "nobody can drive in empty: it has no lanes for cars."),
        ("walk", "nobody can walk in empty: the ground is not laid yet."),
    ],
)
def test_a_city_without_streets_is_told_before_any_work(name, words):
    empty = City("empty", Frame(52.0, 13.0), Layout((-50, -50, 50, 50)))
    with pytest.raises(InputError) as error:
        plan(empty, name, 3, (64, 48))
    assert str(error.value) == words


def test_all_faults_of_a_plan_are_told_at_once():
    with pytest.raises(UsageError) as error:
        planned("stret", 0, rig="mon", length=0, rate=0.0, weathers=["rainn"], times=["25:00"])
    for words in (
        'there is no plan "stret": it is neither a .json file nor one of street, walk, drive, '
        'aerial, orbit. Did you mean "street"?',
        "0 views are no dataset; one at least is needed.",
        "0 frames per second is out of range, allowed is 0.01 to 1000.",
        "sequences of 0 frames cannot be, allowed is 1 to 10000.",
        'there is no rig "mon"',
        '"rainn" is no weather',
    ):
        assert words in str(error.value)


def test_single_views_are_no_sequences():
    with pytest.raises(UsageError, match="street plans are single views; sequences come from walk"):
        planned("street", 5, length=4)


def test_an_unknown_target_of_an_orbit_is_told():
    with pytest.raises(UsageError, match='"Big Ben" is neither "tallest", "middle" nor the name'):
        planned("orbit", 5, target="Big Ben")


def test_refusals_are_counted():
    found = planned("aerial", 12)
    assert found.tried == 12 + sum(found.refused.values())
    assert found.refused
    assert len(HOUSES) == 2
