"""Graves, vines, stalls, containers..., walls with gates, wires and barriers, on small layouts."""

import numpy as np
import pytest
import shapely

from cityx.city import City, Frame, Layout
from cityx.city.layout import make_table
from cityx.nature.furniture.signs import level_crossing_posts
from cityx.nature.land.barriers import barriers, power_wires
from cityx.nature.land.stocked_land import STOCKS, stocked_land

EXTENT = (-100.0, -100.0, 100.0, 100.0)
FIELD = shapely.Polygon([(-40, -20), (35, -32), (42, 28), (-30, 36)])
TAGS = {
    "cemetery": ("cemetery", "{}"), "vines": ("orchard", '{"landuse": "vineyard"}'),
    "solar": ("meadow", '{"plant:source": "solar"}'),
    "stalls": ("pedestrian", '{"amenity": "marketplace"}'),
    "containers": ("industrial", '{"industrial": "container_terminal"}'),
    "gardens": ("garden", '{"landuse": "allotments"}'),
}  # fmt: skip


def city_of(**tables):
    return City("Field", Frame(50.0, 10.0), Layout(EXTENT, **tables), seed=3)


def land(kind, tags="{}", shape=FIELD):
    return make_table("areas", [shape], id=[7], source=["osm/way/7"], kind=[kind], tags=[tags])


def road(points, number, **columns):
    told = {"kind": ["residential"], "width": [7.0], "lanes": [2], "tags": ["{}"]}
    told |= {name: [value] for name, value in columns.items()}
    return make_table("roads", [shapely.LineString(points)], id=[number], **told)


@pytest.mark.parametrize("name", TAGS)
def test_rows_lie_on_the_land_and_keep_apart(name):
    found = stocked_land(city_of(areas=land(*TAGS[name])))
    assert len(found) > 10
    points = shapely.points(found.xy)
    assert shapely.contains(FIELD, points).all()
    stock = next(one for one in STOCKS.values() if set(one.pieces) & set(found.name.tolist()))
    gap = shapely.STRtree(points).query_nearest(points, exclusive=True, return_distance=True)[1]
    assert gap.min() > 0.95 * min(stock.along, stock.across)


@pytest.mark.parametrize(
    ("kind", "tags"),
    [("orchard", "{}"), ("pedestrian", "{}"), ("garden", '{"leisure": "garden"}'),
     ("meadow", '{"landuse": "meadow"}')],
)  # fmt: skip
def test_other_land_stays_bare(kind, tags):
    assert not len(stocked_land(city_of(areas=land(kind, tags))))


def test_the_same_field_is_stocked_alike_wherever_else_something_lies():
    one = stocked_land(city_of(areas=land("cemetery")))
    other = land("cemetery", shape=shapely.box(60, 60, 90, 90))
    other["id"] = np.array([5], np.uint64)
    both = stocked_land(city_of(areas=make_table(
        "areas", [FIELD, other.geometry.iloc[0]], id=[7, 5], kind=["cemetery"] * 2, tags=["{}"] * 2
    )))  # fmt: skip
    assert set(one.id.tolist()) < set(both.id.tolist())


def test_a_city_wall_goes_on_over_the_street_of_its_gate():
    ring = shapely.box(-60, -60, 60, 60).exterior
    lines = make_table("lines", [shapely.LineString(ring.coords)], id=[9], kind=["city_wall"],
                       height=[8.0])  # fmt: skip
    city = city_of(lines=lines, roads=road([(0, 0), (0, 95)], 4))
    mesh = barriers(city).scene.meshes["barriers"]
    over = mesh.vertices[np.abs(mesh.vertices[:, :2] - [0, 60]).max(axis=1) < 3.4]
    assert len(over)
    assert over[:, 2].min() >= 4.7
    assert over[:, 2].max() == pytest.approx(8.0, abs=0.2)
    solid = mesh.vertices[np.abs(mesh.vertices[:, :2] - [30, 60]).max(axis=1) < 4.0]
    assert solid[:, 2].min() < 0.0
    assert solid[:, 2].max() > 8.5  # merlons


@pytest.mark.parametrize("height", [20.0, 30.0, 40.0])
def test_wires_hang_from_pylon_to_pylon_and_sag(height):
    points = [(-100, 10), (-50, 10), (5, 10), (60, 10)]
    lines = make_table("lines", [shapely.LineString(points)], id=[9], kind=["power_line"],
                       height=[height])  # fmt: skip
    mesh = power_wires(city_of(lines=lines))
    assert mesh.object_id.tolist() == [9]
    assert mesh.vertices[:, 2].max() == pytest.approx(height, abs=0.4)
    lowest = mesh.vertices[mesh.vertices[:, 2].argmin()]
    assert lowest[2] > 0.5 * height
    assert min(abs(lowest[0] - x) for x in (-75, -22.5, 32.5)) < 6.0
    assert np.ptp(mesh.vertices[:, 1]) == pytest.approx(13.2 * height / 30.0, abs=0.2)


@pytest.mark.parametrize(("oneway", "count"), [(False, 2), (True, 1)])
def test_a_level_crossing_has_a_barrier_for_each_way(oneway, count):
    roads = [
        road([(-80, 0), (80, 0)], 4, oneway=oneway),
        road([(-2, -90), (-2, 90)], 5, kind="rail", width=3.0),
        road([(2, 90), (2, -90)], 6, kind="rail", width=3.0),
        road([(-80, 40), (80, 40)], 8, bridge=True, layer=1),
    ]
    import pandas as pd

    found = level_crossing_posts(city_of(roads=pd.concat(roads, ignore_index=True)))
    assert len(found) == count
    assert (np.abs(found.xy[:, 1]) > 3.5).all()
    assert sorted(found.xy[:, 0].round(1).tolist()) == [-7.0, 7.0][:count]
