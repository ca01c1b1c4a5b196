"""Vehicles drive to places, leave them and go from one to another by the streets."""

from dataclasses import replace
from importlib.util import find_spec

import pytest
import shapely
from crossing_town import crossing_town

from cityx.checks.movement_checks import check_movement
from cityx.checks.predicates import measure
from cityx.city.content import content_hash
from cityx.city.tracks import MOVER
from cityx.edit.life.drivers import drivers
from cityx.errors import ActionFailed
from cityx.ids import id_text
from cityx.language import read_brief

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
    with pytest.raises(ActionFailed, match="where they go"):
        drivers(town)


@pytest.mark.parametrize(
    ("text", "agent", "to", "origin"),
    [
        ("Add an ambulance driving from the church to the park.", "ambulance", "park", "church"),
        ("Three buses that run from the park to the bridge.", "bus", "bridge", "park"),
        ("Let a fire engine rush to the church.", "fire_engine", "church", None),
        ("Have a van drive from the market.", "van", None, "market"),
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
