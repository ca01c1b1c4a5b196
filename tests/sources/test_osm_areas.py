import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from cityx.sources.features.tagged import polygons_of
from cityx.sources.features.vocabulary import area_kind, closed_is_area
from cityx.sources.osm.areas import sea_polygons
from cityx.sources.osm.outlines import assemble, close_along, open_ends

BOX = (0.0, 0.0, 100.0, 100.0)
NOTHING = np.zeros(0, object)


def line(*points):
    return shapely.LineString(points)


def test_land_lies_to_the_left_of_a_coast():
    sea = sea_polygons(np.array([line((-10, 40), (110, 40))]), BOX)
    assert shapely.area(sea).sum() == pytest.approx(4000)
    assert shapely.bounds(sea)[0, 3] == 40


def test_an_island_is_land_and_a_clockwise_ring_is_a_bay():
    ring = shapely.box(20, 20, 60, 60).exterior
    island = sea_polygons(np.array([shapely.LineString(shapely.get_coordinates(ring))]), BOX)
    bay = sea_polygons(
        np.array([shapely.LineString(shapely.get_coordinates(ring)[::-1])]), BOX
    )  # fmt: skip
    clockwise = not shapely.is_ccw(ring)
    assert shapely.area(island).sum() == pytest.approx(1600 if clockwise else 8400)
    assert shapely.area(bay).sum() == pytest.approx(8400 if clockwise else 1600)


def test_a_coast_that_ends_within_the_site_floods_nothing():
    assert len(sea_polygons(np.array([line((-10, 40), (50, 40))]), BOX)) == 0
    assert len(sea_polygons(np.array([line((200, 200), (300, 300))]), BOX)) == 0


def test_a_coast_cut_off_at_the_border_is_taken_to_reach_it():
    sea = sea_polygons(np.array([line((8, 40), (50, 40)), line((50, 40), (93, 40))]), BOX)
    assert shapely.area(sea).sum() == pytest.approx(4000)


@settings(max_examples=40, deadline=None, derandomize=True)
@given(st.lists(st.tuples(st.floats(0.05, 0.95), st.booleans()), min_size=1, max_size=4))
def test_parallel_coasts_leave_the_sea_on_their_right(coasts):
    # Coasts at rising heights, alternately eastward and westward as on real maps.
    heights = sorted({round(height, 2) for height, _ in coasts})
    west = coasts[0][1]
    lines = [
        line((110, 100 * y), (-10, 100 * y)) if (index + west) % 2 else
        line((-10, 100 * y), (110, 100 * y))
        for index, y in enumerate(heights)
    ]  # fmt: skip
    edges = np.array([0, *heights, 1])
    bands = np.diff(edges) * 1e4
    # Eastward: land above, sea below.
    wet = [(index + west) % 2 == 0 for index in range(len(heights) + 1)]
    assert shapely.area(sea_polygons(np.array(lines), BOX)).sum() == pytest.approx(
        bands[np.array(wet)].sum()
    )


def test_rings_are_assembled_even_odd():
    outer, inner = shapely.box(0, 0, 10, 10).exterior, shapely.box(2, 2, 8, 8).exterior
    island = shapely.box(4, 4, 6, 6).exterior
    rings = [shapely.LineString(shapely.get_coordinates(r)) for r in (outer, inner, island)]
    built = assemble(np.array(rings), np.zeros(3, int), 1)
    polygons, row = polygons_of(built)
    assert shapely.area(polygons).tolist() == [64, 4]
    assert row.tolist() == [0, 0]


def test_a_river_cut_by_the_site_is_closed_along_its_border():
    banks = np.array([line((-20, 40), (120, 40)), line((-20, 50), (50, 55), (120, 50))])
    assert open_ends(banks)
    river = close_along(banks, BOX, NOTHING)
    assert 1000 < shapely.area(river) < 1600
    # A town along one bank cannot lie in it.
    lake = close_along(banks[:1], BOX, shapely.points([[x, 20.0] for x in range(5, 95, 9)]))
    assert shapely.area(lake) == pytest.approx(6000)


def test_water_whose_other_shore_is_missing_is_left_out():
    towns = shapely.points([[x, y] for x in range(5, 95, 9) for y in (20.0, 80.0)])
    assert close_along(np.array([line((-20, 40), (120, 40))]), BOX, towns) is None


@pytest.mark.parametrize(
    ("tags", "kind"),
    [
        ({"natural": "water"}, "water"), ({"natural": "water", "water": "river"}, "river"),
        ({"waterway": "riverbank"}, "river"), ({"landuse": "forest"}, "wood"),
        ({"leisure": "swimming_pool"}, "pool"), ({"amenity": "parking"}, "parking"),
        ({"highway": "service", "area": "yes"}, "road_area"), ({"highway": "service"}, ""),
        ({"area:highway": "footway"}, "pedestrian"), ({"man_made": "pier"}, "pier"),
        ({"landuse": "industrial"}, "industrial"), ({"natural": "no"}, ""),
    ],
)  # fmt: skip
def test_areas_have_kinds(tags, kind):
    assert area_kind(tags) == kind


def test_a_closed_way_is_an_area_unless_it_is_a_line():
    assert closed_is_area({"landuse": "grass"})
    assert not closed_is_area({"barrier": "fence"})
    assert not closed_is_area({"natural": "coastline"})
    assert not closed_is_area({"landuse": "grass", "area": "no"})
    assert closed_is_area({"man_made": "pier", "area": "yes"})


def test_streams_are_widened_where_no_polygon_holds_them(drawing):
    drawing.way([(0, -50), (100, -50)], highway="path")
    drawing.way([(0, 90), (100, 90)], highway="path")
    drawing.way([(0, 0), (100, 0)], waterway="river")
    drawing.way([(0, 60), (100, 60)], waterway="stream", tunnel="culvert")
    drawing.box(0, -10, 50, 20, natural="water")
    areas = drawing.city().layout.areas
    river = areas[areas["kind"] == "river"]
    assert len(areas) == 2
    assert river.geometry.area.sum() == pytest.approx(50 * 12, rel=0.03)


def test_areas_end_at_the_site(drawing):
    for x in (0, 100):
        drawing.box(x, 0, 10, 10, building="yes")
    drawing.box(-5000, -5000, 10000, 10000, landuse="forest")
    layout = drawing.city().layout
    assert layout.areas.geometry.area.sum() == pytest.approx(layout.area_km2 * 1e6, rel=1e-6)


def test_lines_and_points_have_heights(drawing):
    drawing.way([(0, 0), (100, 0)], highway="residential")
    drawing.way([(0, 10), (100, 10)], barrier="wall", height="3 m")
    drawing.way([(0, 0), (90, 0)], natural="tree_row")
    drawing.node(5, 0, natural="tree")
    drawing.node(7, 0, highway="street_lamp", height=6)
    drawing.node(9, 0, entrance="main", direction="N")
    layout = drawing.city().layout
    assert sorted(layout.lines["height"]) == [3, 9]
    points = layout.points.set_index("kind")
    assert 6 <= points["height"]["tree"] <= 14
    assert points["height"]["street_lamp"] == 6
    assert points["direction"]["entrance"] == 0


def town(drawing):
    """Draw twelve houses along two streets, on 240 by 200 metres."""
    for x in range(0, 240, 40):
        for y in (10, 150):
            drawing.box(x, y, 10, 10, building="house", height="8")
    for y in (40, 190):
        drawing.way([(-10, y), (240, y)], highway="residential")


def seas(drawing):
    city = drawing.city()
    kinds = city.layout.areas["kind"].tolist()
    named = [failure.error for failure in city.failures if "into the sea" in failure.error]
    return kinds.count("sea"), named


def test_a_stray_ring_of_coast_on_land_floods_no_town(drawing):
    town(drawing)
    ring = drawing.box(100, 80, 20, 20, natural="coastline")
    assert seas(drawing) == (0, [f"osm/way/{ring} puts much of the town into the sea, as no coast "
                                 "does; no sea was built there"])  # fmt: skip


def test_a_coast_drawn_the_wrong_way_round_floods_no_town(drawing):
    town(drawing)
    drawing.way([(240, -5), (-10, -5)], natural="coastline")  # land lies to the left: below
    found, named = seas(drawing)
    assert (found, len(named)) == (0, 1)


def test_streets_without_houses_keep_the_sea_out_as_well(drawing):
    for y in (0, 40, 190):
        drawing.way([(-10, y), (240, y)], highway="residential")
    drawing.box(100, 80, 20, 20, natural="coastline")
    found, named = seas(drawing)
    assert (found, len(named)) == (0, 1)


def test_an_island_with_its_houses_lies_in_its_sea(drawing):
    town(drawing)
    ring = [(-15, -5), (245, -5), (245, 195), (-15, 195), (-15, -5)]
    drawing.way(ring, natural="coastline")
    drawing.way([(-40, -40), (280, -40)], highway="service", bridge="yes")
    drawing.way([(-40, 230), (280, 230)], highway="service", bridge="yes")
    found, named = seas(drawing)
    assert (found, named) == (1, [])


def test_a_check_counts_houses_that_stand_in_water(drawing):
    from cityx.checks.building_checks import check_buildings

    town(drawing)
    drawing.box(-10, -5, 260, 60, natural="water")
    drawing.box(90, 60, 10, 10, building="houseboat")
    found = {check.name: check for check in check_buildings(drawing.city())}
    check = found["buildings_in_water"]
    assert check.value == pytest.approx(6 / 12)
    assert not check.ok
    assert len(check.ids) == 6


@pytest.mark.parametrize(
    ("points", "tags", "area"),
    [
        ([(-20, 10), (-20, 40), (20, 40), (20, 10)], {"leisure": "park"}, 0.0),
        ([(-20, -60), (-20, 40), (20, 40), (20, -60)], {"landuse": "cemetery"}, 2200.0),
        ([(-99, 20), (-30, 20), (-30, 50), (-99, 50)], {"natural": "water"}, 1350.0),
        ([(0, 20), (30, 40), (40, 30)], {"leisure": "playground", "name": "Lot"}, 0.0),
    ],
)
def test_land_whose_outline_is_open_is_closed_at_the_border_and_named(drawing, points, tags, area):
    # With the margin round its houses the site is 150 m wide and deep.
    for x, y in ((-60, 0), (52, 112)):
        drawing.box(x, y, 8, 8, building="yes")
    way = drawing.way(points, **tags)
    city = drawing.city()
    areas = city.layout.areas[city.layout.areas["source"] == f"osm/way/{way}"]
    said = "map: 1 outlines of land are open and count as far as the border closes them"
    assert f"{said}: osm/way/{way}" in city.notes
    assert areas.geometry.area.sum() == pytest.approx(area, rel=0.05, abs=1.0)


@pytest.mark.parametrize("tags", [{"barrier": "hedge", "landuse": "grass"},
                                  {"highway": "path", "leisure": "park"},
                                  {"waterway": "stream", "natural": "water"}])  # fmt: skip
def test_lines_are_not_called_open_land(drawing, tags):
    drawing.box(0, 0, 8, 8, building="yes")
    drawing.way([(0, 20), (30, 40), (40, 30)], **tags)
    assert not any("outlines of land" in note for note in drawing.city().notes)
