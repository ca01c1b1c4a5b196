"""What the map has where nothing can stand goes to the nearest free place, or is named."""

import numpy as np
import pytest
import shapely

import cityx
from cityx.checks.fidelity import facts
from cityx.checks.tag_measures import KEPT, LOST
from cityx.sources.features.kinds import land_kind, line_kind

IN_A_HOUSE = (
    {"highway": "bus_stop"}, {"amenity": "waste_basket"}, {"natural": "tree"},
    {"amenity": "fountain"},
)  # fmt: skip
ON_A_STREET = ({"barrier": "bollard"}, {"emergency": "fire_hydrant"}, {"highway": "street_lamp"})


@pytest.fixture
def built(drawing):
    """Build a house 60 m long with things 2 m behind its front, and things amid a street."""
    drawing.box(-40, 20, 80, 40, building="train_station", height="9")
    for number, tags in enumerate((*IN_A_HOUSE, {"amenity": "bench"})):
        drawing.node(-25 + 12 * number, 22, **tags)
    drawing.node(0, 40, amenity="post_box", operator="deep within")
    drawing.node(-20, 40, amenity="bench")
    drawing.node(120, 30, highway="traffic_signals")
    for number, tags in enumerate(ON_A_STREET):
        drawing.node(-80 + 40 * number, 0, **tags)
    drawing.way([(-160, 0), *((-80 + 40 * k, 0) for k in range(3)), (160, 0)],
                highway="residential", width="6", lanes="2")  # fmt: skip
    path = drawing.file()
    return cityx.build(path, lod=2).city, path


def test_things_in_a_house_and_on_a_street_stand_beside_it(built):
    city, path = built
    found = [fact for fact in facts(city, path) if fact.name.startswith("node/")]
    told = {(fact.tag, fact.verdict) for fact in found}
    for tags in (*ON_A_STREET, *IN_A_HOUSE[:3], {"highway": "traffic_signals"}):
        ((key, value),) = tags.items()
        assert (f"{key}={value}", KEPT) in told
    benches = [fact for fact in found if fact.tag == "amenity=bench"]
    assert sorted(fact.verdict for fact in benches) == [KEPT, LOST]
    houses = shapely.union_all(city.layout.buildings.geometry.to_numpy())
    for name in ("street_furniture", "trees"):
        places = shapely.points(city.scene.instances[name].position[:, :2])
        points = city.layout.points[city.layout.points["kind"] != "post_box"]
        own = np.isin(city.scene.instances[name].object_id, points["id"])
        assert not shapely.intersects(houses, places[own]).any()


def test_what_finds_no_place_is_named(built):
    city, _ = built
    named = {failure.object_id for failure in city.failures if "left out" in failure.error}
    points = city.layout.points.set_index("id")
    assert [points.loc[number, "kind"] for number in named] == ["bench"]


@pytest.mark.parametrize(
    ("tags", "kind"),
    [
        ({"landuse": "residential", "leisure": "garden"}, "garden"),
        ({"landuse": "commercial", "amenity": "parking"}, "parking"),
        ({"landuse": "industrial", "leisure": "pitch"}, "pitch"),
        ({"landuse": "residential", "name": "Block 4"}, "residential"),
        ({"landuse": "forest", "leisure": "park"}, "wood"),
    ],
)
def test_what_lies_on_land_goes_over_what_it_is_zoned_for(tags, kind):
    assert land_kind(tags) == kind


@pytest.mark.parametrize("value", ["line", "minor_line"])
def test_power_lines_are_lines(value):
    assert line_kind({"power": value}) == "power_line"


def test_power_lines_of_a_map_hang_at_their_height(drawing):
    drawing.box(-40, 20, 20, 20, building="house")
    drawing.box(-40, 190, 20, 20, building="house")
    for y, tags in ((80, {"power": "line"}), (120, {"power": "minor_line"}),
                    (160, {"power": "minor_line", "height": "7"})):  # fmt: skip
        drawing.way([(-100, y), (100, y)], **tags)
    drawing.way([(-160, 0), (160, 0)], highway="residential")
    lines = cityx.build(drawing.file(), lod=0).city.layout.lines
    assert sorted(lines["height"].tolist()) == [7.0, 9.0, 30.0]


def test_a_culvert_is_not_asked_for_and_a_dry_bed_is_there(drawing):
    drawing.box(-40, 20, 20, 20, building="house")
    drawing.box(-40, 190, 20, 20, building="house")
    drawing.way([(-160, 0), (160, 0)], highway="residential")
    drawing.way([(-100, 60), (100, 60)], waterway="stream", tunnel="culvert")
    drawing.way([(-100, 80), (100, 80)], waterway="stream", intermittent="yes")
    drawing.way([(-100, 100), (100, 100)], waterway="stream")
    path = drawing.file()
    city = cityx.build(path, lod=0).city
    told = [fact.verdict for fact in facts(city, path) if fact.tag == "waterway=stream"]
    assert told == [KEPT, KEPT]
    assert sorted(city.layout.areas["kind"]) == ["bare", "river"]
