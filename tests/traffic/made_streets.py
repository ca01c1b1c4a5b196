"""Small cities of streets given as coordinates, with lanes, for tests of traffic."""

import json

import shapely

from cityx.city.city import City
from cityx.city.frame import Frame
from cityx.city.layout import Layout, make_table
from cityx.road.network.lane_graph import lanes
from cityx.road.network.network import road_network

STREET = {
    "kind": "secondary", "lanes": 2, "lanes_forward": 1, "lane_width": 3.25, "width": 6.5,
    "sidewalk_left": 2.0, "sidewalk_right": 2.0, "surface": "asphalt", "maxspeed_kmh": 50.0,
}  # fmt: skip
REACH = 150.0
WEST, EAST, NORTH, SOUTH, MIDDLE = (-REACH, 0), (REACH, 0), (0, REACH), (0, -REACH), (0, 0)
CROSS = [([WEST, MIDDLE, EAST], {}), ([SOUTH, MIDDLE, NORTH], {})]


def city_of(streets, *, signals=(), crossings=(), houses=(), left_hand=False, terrain=None, seed=1):
    """Make a city of streets: lines and what differs from `STREET`; crossings have tags."""
    rows = [STREET | options for _, options in streets]
    blank = {key: type(value)() for row in rows for key, value in row.items()}
    columns = {key: [row.get(key, none) for row in rows] for key, none in blank.items()}
    columns["name"] = [f"street {number}" for number in range(len(rows))]
    columns["source"] = [f"test/way/{number}" for number in range(len(rows))]
    roads = make_table("roads", [shapely.LineString(line) for line, _ in streets],
                       id=list(range(1, len(rows) + 1)), **columns)  # fmt: skip
    boxes = [shapely.box(*house) for house in houses]
    size = len(boxes)
    ids = list(range(1001, 1001 + size))
    buildings = make_table("buildings", boxes, id=ids, levels=[3] * size, height=[10.0] * size,
                           use=["apartments"] * size)  # fmt: skip
    parts = make_table("parts", boxes, id=ids, building=ids, levels=[3] * size, top=[10.0] * size,
                       use=["apartments"] * size, walls=[True] * size)  # fmt: skip
    places = [*signals, *(at for at, _ in crossings)]
    points = make_table("points", [shapely.Point(at) for at in places],
                        id=list(range(3001, 3001 + len(places))),
                        tags=[""] * len(signals) + [json.dumps(tags) for _, tags in crossings],
                        kind=["traffic_signals"] * len(signals)
                        + ["crossing"] * len(crossings))  # fmt: skip
    layout = Layout((-REACH, -REACH, REACH, REACH), buildings, parts, roads, points=points)
    more = {} if terrain is None else {"terrain": terrain}
    network = road_network(layout, left_hand=left_hand)
    city = City("test", Frame(52.0, 13.0), layout, seed=seed, network=network,
                stages_done=frozenset({"layout", "road"}), **more)  # fmt: skip
    return lanes(city)
