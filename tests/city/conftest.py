from dataclasses import replace

import numpy as np
import pytest
import shapely

from cityx.city import (
    City,
    Environment,
    Failure,
    Frame,
    Instances,
    Layout,
    Prototype,
    Terrain,
    concatenate,
    make_table,
    one_mesh,
)

SQUARE = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]


@pytest.fixture
def small_city():
    """Two buildings, one road, a window on each building, terrain of four nodes."""
    ids = np.array([5, 2**63 + 7], np.uint64)
    boxes = [shapely.box(0, 0, 1, 1), shapely.box(3, 0, 4, 1)]
    buildings = make_table(
        "buildings", boxes, id=ids, source=["osm/way/1", "osm/way/2"], use=["yes", "church"],
        name=["", "Dom"], levels=[2, 1], height=[6.0, np.nan],
    )  # fmt: skip
    roads = make_table("roads", [shapely.LineString([(0, 5), (10, 5)])], id=[9], kind=["primary"])
    window = Prototype(
        "window", "window",
        one_mesh(1, SQUARE, [[0, 1, 2, 3]], materials=("glass", "trim"), material=1),
    )  # fmt: skip
    door = Prototype("door", "door", one_mesh(1, SQUARE[:3], [[0, 1, 2]], materials=("trim",)))
    rows = Instances(
        np.array([0, 1], np.int32), np.array([21, 22], np.uint64), ids,
        np.array([[0.0, 0, 1], [3, 0, 1]]), np.zeros((2, 3), np.float32),
        np.ones((2, 3), np.float32), np.ones((2, 3), np.float32),
    )  # fmt: skip
    city = City(
        "Testville",
        Frame(60.17, 24.94),
        Layout((0.0, 0.0, 10.0, 10.0), buildings=buildings, roads=roads),
        seed=3,
        terrain=Terrain((0.0, 0.0), 10.0, np.array([[0.0, 1.0], [2.0, 3.0]]), 12.5),
        environment=Environment(weather="rain"),
        attribution=("© somebody",),
        stages_done=frozenset({"layout"}),
        failures=(Failure(5, "building/shell-v1", "roof fell back"),),
        notes=("one note",),
    )
    shells = concatenate([one_mesh(int(i), SQUARE, [[0, 1, 2, 3]]) for i in ids])
    scene = city.scene.with_mesh("buildings", shells)
    return replace(city, scene=scene.with_instances("windows", [window, door], rows))
