import json

import pytest
import shapely

from cityx.city import City, Frame
from cityx.city.frame import NOWHERE
from cityx.city.layout import CURVE
from cityx.city.sites import moved
from cityx.errors import InputError, UsageError
from cityx.options import HowToRead
from cityx.sources.features.gather import gather
from cityx.sources.features.resolve import resolve
from cityx.sources.features.tagged import Owner, Report, tag
from cityx.sources.intake import combine, read_sources, sort_inputs

STREET = {"kind": "residential", "name": "New Street"}
HERE = Frame(52.0, 13.0)
NAMES = ("the map", "the image")
BOX = (0.0, 0.0, 200.0, 200.0)


def drawing(tmp_path, coordinates, *, metres=True, properties=STREET, name="plan.geojson"):
    feature = {
        "type": "Feature",
        "properties": properties,
        "geometry": {"type": "LineString", "coordinates": coordinates},
    }
    content = {"type": "FeatureCollection", "features": [feature]}
    path = tmp_path / name
    path.write_text(json.dumps({**content, **({"units": "metres"} if metres else {})}))
    return path


def read(*paths, **more):
    return read_sources(sort_inputs(list(paths)), HowToRead(**more))


def test_a_drawing_alone_lies_nowhere_unless_it_is_told(tmp_path):
    path = drawing(tmp_path, [[0, 0], [100, 0]])
    found = read(path)
    assert not found.located
    assert found.city.frame == NOWHERE
    assert read(path, at=(48.2, 16.4)).city.frame.latitude == 48.2
    assert "does not say where it lies" in read(path).city.notes[-1]


def test_a_drawn_street_goes_before_the_map_and_leaves_its_site(town_map, tmp_path):
    alone = read(town_map).city
    x, y = (alone.layout.extent[0] + alone.layout.extent[2]) / 2, alone.layout.extent[1] + 5
    both = read(town_map, drawing(tmp_path, [[x - 20, y], [x + 20, y]])).city
    assert both.frame == alone.frame
    assert both.layout.extent == alone.layout.extent
    assert both.name == alone.name
    assert both.layout.lines["kind"].tolist().count(CURVE) == 1
    assert set(both.layout.buildings["id"]) <= set(alone.layout.buildings["id"])
    assert len(both.layout.roads) > 1


def test_a_drawing_of_another_place_is_refused(town_map, tmp_path):
    path = drawing(tmp_path, [[0, 0], [0.001, 0]], metres=False)
    with pytest.raises(InputError, match="do not lie on the same ground"):
        read(town_map, path)


def test_no_input_gives_an_empty_city_for_a_town():
    found = read()
    assert not found.name
    assert not len(found.city.layout.roads)
    assert found.city.frame == NOWHERE


def test_heights_without_houses_are_the_ground_of_a_town(tmp_path):
    path = tmp_path / "hill.asc"
    rows = "\n".join(" ".join(f"{0.1 * (x + y):.1f}" for x in range(60)) for y in range(60))
    path.write_text(f"ncols 60\nnrows 60\nxllcorner 13\nyllcorner 52\ncellsize 0.0002\n{rows}\n")
    found = read(path)
    assert not found.name
    assert found.heights is not None
    assert found.city.frame.latitude == pytest.approx(52.006, abs=1e-4)


def test_a_file_may_be_said_to_be_something_else(tmp_path):
    path = drawing(tmp_path, [[0, 0], [100, 0]])
    assert sort_inputs([path], ["plan.geojson=osm"]).sources[0].kind == "osm"
    with pytest.raises(UsageError) as caught:
        sort_inputs([path], ["plan.geojson=map", "plan.json=osm"])
    said = str(caught.value)
    assert "a kind is one of osm, semantic, satellite, height, drawn" in said
    assert 'no input is called "plan.json". Did you mean "plan.geojson"?' in said


def city_of(name, *pairs, frame=HERE):
    owners = [Owner((name, index), tags) for index, (_, tags) in enumerate(pairs)]
    found = tag([shape for shape, _ in pairs], owners)
    layout = resolve(gather(found, BOX, Report()), frame, seed=0)
    return City(name, frame, layout, attribution=(f"© {name}",))


def house(x, y, size=10):
    return (shapely.box(x, y, x + size, y + size), {"building": "house"})


def street(*points):
    return (shapely.LineString(points), {"highway": "residential"})


MAP = city_of(
    "map", house(50, 50), street((0, 20), (200, 20)),
    (shapely.box(0, 100, 100, 200), {"leisure": "park"}),
    (shapely.Point(5, 5), {"natural": "tree"}),
)  # fmt: skip


def test_what_the_second_adds_is_taken_and_conflicts_are_told():
    image = city_of(
        "image",
        house(53, 52), house(120, 60), house(100, 16, 8),  # same, new, on the street
        street((0, 23), (200, 23)), street((150, 20), (150, 200)),  # same, new
        (shapely.box(50, 100, 150, 200), {"natural": "wood"}),
        (shapely.Point(5.5, 5), {"natural": "tree"}), (shapely.Point(90, 90), {"natural": "tree"}),
    )  # fmt: skip
    city = combine(MAP, image, names=NAMES)
    layout = city.layout
    assert sorted(layout.buildings["source"]) == ["image/1", "map/0"]
    assert sorted(layout.roads["source"]) == ["image/4", "map/1"]
    assert set(layout.parts["building"]) == set(layout.buildings["id"])
    assert layout.areas.set_index("source").geometry["image/5"].area == pytest.approx(5000)
    assert len(layout.points) == 2
    assert city.attribution == ("© map", "© image")
    assert city.notes == (
        "the image: 2 buildings lie where the map has some; those of the map were kept",
        "the image: 1 roads lie where the map has some; those of the map were kept",
        "the image: 1 points lie where the map has some; those of the map were kept",
    )


def test_frames_are_aligned():
    away = Frame(52.0004, 13.0006)
    there = city_of("image", house(120, 60))
    shifted = City("image", away, moved(there.layout, HERE, away))
    layout = combine(MAP, shifted, names=NAMES).layout
    (found,) = layout.buildings[layout.buildings["source"] == "image/0"].geometry
    assert found.bounds == pytest.approx((120, 60, 130, 70), abs=0.01)


def test_inputs_of_different_places_are_refused():
    far = city_of("image", house(120, 60), frame=Frame(53.0, 13.0))
    with pytest.raises(
        InputError, match=r"the map and the image do not lie on the same ground: 11\d"
    ):
        combine(MAP, far, names=NAMES)
