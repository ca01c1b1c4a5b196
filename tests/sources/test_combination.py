import pytest
import shapely

from cityx.city import City, Frame
from cityx.city.sites import moved
from cityx.errors import InputError
from cityx.sources.features.gather import gather
from cityx.sources.features.resolve import resolve
from cityx.sources.features.tagged import Owner, Report, tag
from cityx.sources.intake import combine

HERE = Frame(52.0, 13.0)
NAMES = ("the map", "the image")
BOX = (0.0, 0.0, 200.0, 200.0)


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
