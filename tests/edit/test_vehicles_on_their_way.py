"""Vehicles drive to places, leave them and go from one to another by the streets."""

import sys
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path

import pytest
import shapely
from crossing_town import crossing_town
from scipy.sparse.csgraph import dijkstra

sys.path.insert(0, str(Path(__file__).parents[1] / "traffic"))  # for `made_streets`

from made_streets import CROSS, city_of

from cityx.checks.movement_checks import check_movement
from cityx.checks.predicates import measure
from cityx.city.content import content_hash
from cityx.city.tracks import MOVER
from cityx.edit.life.drivers import drivers
from cityx.errors import ActionFailed
from cityx.ids import id_text
from cityx.language import read_brief
from cityx.traffic.flows import REACH

pytestmark = [
    pytest.mark.sumo,
    pytest.mark.skipif(
        find_spec("libsumo") is None, reason='SUMO is not installed: pip install "cityx[traffic]"'
    ),
]


@pytest.fixture(scope="module")
def town():
    """A crossing with a house west of it and one north."""
    city = crossing_town()
    houses = city.layout.buildings.copy()
    houses.loc[houses.index[1], "geometry"] = shapely.box(12.0, 40.0, 24.0, 52.0)
    return replace(city, layout=replace(city.layout, buildings=houses))


@pytest.fixture(scope="module")
def houses(town):
    return list(range(len(town.layout.buildings)))


def far_from(town, row, place):
    return shapely.distance(town.layout.buildings.geometry.iloc[row], shapely.Point(place))


def test_vehicles_go_from_a_house_to_another(town, houses):
    names = [(id_text(int(town.layout.buildings["id"].iloc[row])),) for row in houses]
    city = drivers(town, kind="ambulance", origin=names[0], goal=names[1])
    tracks = city.tracks
    assert tracks.count == 1
    assert tracks.time[0] == 0.0
    assert far_from(town, houses[0], tracks.position[0, :2]) < 60.0
    assert far_from(town, houses[1], tracks.position[-1, :2]) < 60.0
    asked = f'vehicle, type=ambulance, from="{names[0][0]}", to="{names[1][0]}"'
    assert measure(f"gained({asked}) == 1", city, before=town).met
    assert not any(check.value > check.limit for check in check_movement(city))
    again = drivers(town, kind="ambulance", origin=names[0], goal=names[1])
    assert content_hash(again).total == content_hash(city).total


@pytest.fixture(scope="module")
def long_street():
    """A crossroads of 300 m streets with a house by the western end and one by the eastern."""
    return city_of(CROSS, houses=[(-140, 8, -128, 20), (128, 8, 140, 20), (-6, 100, -5, 101)])


def test_all_that_set_out_one_after_the_other_count_and_begin_by_the_place(long_street):
    west, east, _ = (id_text(int(own)) for own in long_street.layout.buildings["id"])
    city = drivers(long_street, origin=(west,), goal=(east,), count=8)
    tracks = city.tracks
    begin, end = tracks.sample_start[:-1], tracks.sample_start[1:] - 1
    assert (tracks.time[begin] > 0).any()
    house = long_street.layout.buildings.geometry.iloc[0]
    assert (shapely.distance(shapely.points(tracks.position[begin, :2]), house) < REACH).all()
    assert (tracks.position[end, 0] - tracks.position[begin, 0] > 150.0).all()
    asked = f'vehicle, type=car, from="{west}", to="{east}"'
    assert measure(f"gained({asked}) == 8", city, before=long_street).met
    assert measure(f"n({asked}) == 8", city).met
    standing = int((tracks.time[begin] == 0).sum())
    assert measure(f"gained(vehicle, type=car) == {standing}", city, before=long_street).met
    assert not any("arrived" in note for note in city.notes)


def test_who_passes_or_only_comes_nearer_does_not_go_there(long_street):
    west, east, north = (id_text(int(own)) for own in long_street.layout.buildings["id"])
    city = drivers(long_street, origin=(west,), goal=(east,))
    assert not measure(f'gained(vehicle, to="{north}") >= 1', city, before=long_street).met
    assert not measure(f'gained(vehicle, to="{west}") >= 1', city, before=long_street).met
    assert not measure(f'gained(vehicle, from="{east}") >= 1', city, before=long_street).met


def test_those_who_do_not_arrive_are_told(long_street, monkeypatch):
    west, east, _ = (id_text(int(own)) for own in long_street.layout.buildings["id"])
    monkeypatch.setattr("cityx.edit.life.drivers.LONGEST", 20.0)
    city = drivers(long_street, origin=(west,), goal=(east,), count=2, speed=3.0, duration=20.0)
    assert [note for note in city.notes if "arrived" in note] == [
        "traffic: 2 of 2 new vehicles have not arrived when the tracks end after 20 s"
    ]
    assert measure(f'n(vehicle, to="{east}") == 0', city).met
    assert 2.5 < city.tracks.speed.max() < 3.5


def test_the_same_call_adds_others(long_street):
    west, east, _ = (id_text(int(own)) for own in long_street.layout.buildings["id"])
    once = drivers(long_street, kind="taxi", origin=(west,), goal=(east,))
    twice = drivers(once, kind="taxi", origin=[west], goal=[east])
    assert set(once.tracks.object_id) < set(twice.tracks.object_id)
    assert measure(f'gained(vehicle, type=taxi, to="{east}") == 1', twice, before=once).met
    listed = drivers(long_street, kind="taxi", origin=[west], goal=[east])
    assert content_hash(listed).total == content_hash(once).total


def test_streets_are_searched_once_for_the_farthest_that_leads_there(long_street, monkeypatch):
    _, east, _ = (id_text(int(own)) for own in long_street.layout.buildings["id"])
    calls = []

    def counted(*args, **more):
        calls.append(1)
        return dijkstra(*args, **more)

    monkeypatch.setattr("scipy.sparse.csgraph.dijkstra", counted)
    there = drivers(long_street, goal=(east,))
    assert len(calls) <= 5
    away = drivers(long_street, origin=(east,))
    assert there.tracks.position[0, 0] < -100.0
    assert away.tracks.position[-1, 0] < -100.0


def test_a_street_is_driven_to_itself(long_street):
    roads = long_street.layout.roads
    street, (west, *_) = id_text(int(roads["id"].iloc[1])), long_street.layout.buildings["id"]
    city = drivers(long_street, origin=(id_text(int(west)),), goal=(street,))
    assert shapely.distance(roads.geometry.iloc[1], shapely.Point(city.tracks.position[-1])) < 5.0


def test_a_place_far_from_streets_is_named(long_street):
    houses = long_street.layout.buildings.copy()
    houses.loc[houses.index[2], "geometry"] = shapely.box(100.0, 100.0, 101.0, 101.0)
    city = replace(long_street, layout=replace(long_street.layout, buildings=houses))
    west, _, north = (id_text(int(own)) for own in houses["id"])
    with pytest.raises(ActionFailed, match=f"within 60 m of {north}. The nearest lies 9. m away"):
        drivers(city, origin=(west,), goal=(north,))
    with pytest.raises(ActionFailed, match='"nowhere" has no ground'):
        drivers(city, goal=("nowhere",))


def test_there_is_no_way_to_where_one_is(town):
    name = (id_text(int(town.layout.buildings["id"].iloc[0])),)
    with pytest.raises(ActionFailed, match="where they set out"):
        drivers(town, origin=name, goal=name)


def test_a_bus_without_an_origin_comes_from_far(town, houses):
    name = id_text(int(town.layout.buildings["id"].iloc[houses[0]]))
    city = drivers(town, kind="bus", goal=(name,))
    tracks = city.tracks
    assert (tracks.kind == MOVER["bus"]).all()
    first, last = (far_from(town, houses[0], tracks.position[at, :2]) for at in (0, -1))
    assert last < 60.0 < first


def test_without_places_a_vehicle_comes_to_the_middle(town):
    tracks = drivers(town).tracks
    middle = shapely.box(*town.layout.extent).centroid
    first, last = (middle.distance(shapely.Point(tracks.position[at, :2])) for at in (0, -1))
    assert last < 15.0 < first


@pytest.mark.parametrize(
    ("text", "agent", "to", "origin"),
    [
        ("Add an ambulance driving from the church to the park.", "ambulance", "park", "church"),
        ("Three buses that run from the park to the bridge.", "bus", "bridge", "park"),
        ("Let a fire engine rush to the church.", "fire_engine", "church", None),
        ("Have a van drive from the market.", "van", None, "market"),
        ("Drive a car to the church.", "car", "church", None),
        ("Send three taxis from the park to the church.", "taxi", "church", "park"),
        ("Add a bus from the school.", "bus", None, "school"),
    ],
)
def test_ways_of_vehicles_are_read(text, agent, to, origin):
    (edit,) = read_brief(text, base=True).edits
    said = dict(edit.change)
    assert (said["agent"], said.get("to"), said.get("from")) == (agent, to, origin)


def test_a_description_sends_a_vehicle_on_its_way():
    brief = read_brief(
        "A town with a church and a park. A taxi drives from the church to the park."
    )
    assert [one.text for one in brief.then] == ["put A taxi drives from the church to the park"]
    assert "agent" not in dict(brief.items())


@pytest.mark.parametrize(
    "text",
    ["No cars drive from the church to the park.", "A town with no parked cars in the street "
     "outside the school.", "No cars moving on the street between the school and the park."],
)  # fmt: skip
def test_what_is_denied_on_one_way_is_not_denied_of_all(text):
    assert not {"vehicle", "parked_vehicle"} & {slot.value for slot in read_brief(text).negated}


@pytest.mark.parametrize(
    ("text", "asked"),
    [
        ("Put three cars parked from the church to the park.", "Those that park are at a place"),
        ("Add a queue of cars from the church to the bridge.", "Those that queue are at a place"),
        ("Add ten double parked vans from the school to the church.", "that double park are at"),
        ("Add traffic from the church to the park.", "How many vehicles go there"),
        ("Add a tram going from the church to the park.", "Where is the tram"),
        ("Add two boats from the bridge to the harbour.", "Where are the boats"),
    ],
)
def test_who_stands_or_keeps_off_streets_has_no_way(text, asked):
    brief = read_brief(text, base=True)
    assert [question for question in brief.questions if asked in str(question)]
    assert not any({"to", "from"} & set(dict(edit.change)) for edit in brief.edits)


def test_a_boat_that_heads_for_a_harbour_is_there():
    (edit,) = read_brief("Add a boat heading to the harbour.", base=True).edits
    assert dict(edit.change) == {"agent": "boat", "count": 1, "mode": "park", "at": "harbour"}


@pytest.mark.parametrize(
    "text",
    ["Drive the car to the church.", "Drive a tram to the park.", "Drive a bus to every school.",
     "Add a van from the church near the park.", "Add a parked car from the church."],
)  # fmt: skip
def test_who_is_there_already_or_goes_to_more_than_a_place_is_asked_about(text):
    brief = read_brief(text, base=True)
    assert brief.questions
    assert not any({"to", "from"} & set(dict(edit.change)) for edit in brief.edits)
