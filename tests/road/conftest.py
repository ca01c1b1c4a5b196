import numpy as np
import pytest
import shapely

from cityx.city.city import City
from cityx.city.frame import Frame
from cityx.city.layout import Layout, make_table

STREET = {
    "kind": "residential", "lanes": 2, "lanes_forward": 1, "lane_width": 3.0, "width": 6.0,
    "sidewalk_left": 2.0, "sidewalk_right": 2.0, "surface": "asphalt", "maxspeed_kmh": 50.0,
}  # fmt: skip
HOUSE = {"levels": 3, "height": 10.0, "place": "urban"}


def numbered(name, first, things):
    ids = np.arange(first, first + len(things))
    shapes = np.array([shape for shape, _ in things], dtype=object)
    return make_table(name, shapes, id=ids, kind=[kind for _, kind in things])


@pytest.fixture
def layout_of():
    """Make a layout of streets, houses, areas and points given as coordinates."""

    def make(streets, *, houses=(), areas=(), points=(), extent=(-100, -100, 100, 100)):
        rows = [STREET | options for _, options in streets]
        blank = {key: type(value)() for row in rows for key, value in row.items()}
        columns = {key: [row.get(key, none) for row in rows] for key, none in blank.items()}
        roads = make_table(
            "roads", [shapely.LineString(line) for line, _ in streets],
            id=np.arange(1, len(rows) + 1), **columns,
        )  # fmt: skip
        shells = np.array([shapely.box(*house) for house in houses], dtype=object)
        ids = np.arange(1001, 1001 + len(shells))
        size = len(shells)
        house_columns = {key: [value] * size for key, value in HOUSE.items()}
        buildings = make_table("buildings", shells, id=ids, **house_columns)
        parts = make_table("parts", shells, id=ids, building=ids, base=[0.0] * size,
                           top=[10.0] * size, walls=[True] * size)  # fmt: skip
        land = numbered("areas", 2001, [(shapely.box(*box), kind) for box, kind in areas])
        spots = numbered("points", 3001, [(shapely.Point(at), kind) for at, kind in points])
        return Layout(extent, buildings, parts, roads, land, points=spots)

    return make


@pytest.fixture
def city_of():
    def make(layout, **options):
        return City("test", Frame(52.0, 13.0), layout, **options)

    return make
