"""A crossroads of four arms of 100 m with four houses, a park, a wood and a pond."""

import numpy as np
import shapely

from cityx.city import City, Frame, Layout, RoadNetwork, make_table

ARM = 100.0
HALF = 5.0
TRIM = 9.0


def crossroads_network():
    ends = np.array([[ARM, 0.0], [0.0, ARM], [-ARM, 0.0], [0.0, -ARM]])
    points = np.concatenate([[np.zeros(2), end] for end in ends])
    return RoadNetwork(
        node_position=np.vstack([np.zeros(2), ends]),
        node_degree=np.array([4, 1, 1, 1, 1], np.int32),
        edge_nodes=np.array([[0, 1], [0, 2], [0, 3], [0, 4]], np.int32),
        edge_road=np.arange(4, dtype=np.int32),
        edge_id=np.arange(11, 15, dtype=np.uint64),
        point_start=np.arange(0, 9, 2, dtype=np.int64),
        points=points,
        half_width=np.full(4, HALF),
        trim=np.tile([TRIM, 0.0], (4, 1)),
        crossing=np.zeros((4, 2), bool),
        left_hand=np.zeros(4, bool),
        z=np.zeros(len(points)),
        lift=np.zeros(len(points)),
    )


def crossroads_city():
    network = crossroads_network()
    lines = [shapely.LineString(network.edge_points(i)) for i in range(4)]
    roads = make_table(
        "roads", lines, id=np.arange(1, 5), kind=["residential"] * 4, name=["A", "B", "A", "B"],
        width=[2 * HALF] * 4, sidewalk_left=[3.0] * 4, sidewalk_right=[3.0] * 4,
        parking_left=[True] * 4, parking_right=[True] * 4, lit=[True] * 4, lanes=[2] * 4,
    )  # fmt: skip
    houses = [shapely.box(x, y, x + 40, y + 14) for x in (-55, 15) for y in (-24, 10)]
    buildings = make_table("buildings", houses, id=np.arange(21, 25), levels=[4] * 4)
    areas = make_table(
        "areas",
        [shapely.box(20, 30, 95, 95), shapely.box(-95, 30, -20, 95), shapely.box(-60, 50, -40, 70),
         shapely.box(20, -90, 90, -40)],
        id=[31, 32, 33, 34], kind=["park", "wood", "water", "parking"],
    )  # fmt: skip
    things = {
        "tree": (-60.0, -60.0), "bench": (-70.0, -10.0), "traffic_signals": (0.0, 0.0),
        "bus_stop": (60.0, 0.5), "fire_hydrant": (-30.0, -4.0), "street_lamp": (30.0, 30.0),
    }  # fmt: skip
    points = make_table(
        "points", [shapely.Point(xy) for xy in things.values()], id=np.arange(41, 47),
        kind=list(things), tags=['{"genus": "Betula"}'] + [""] * 5,
    )  # fmt: skip
    barriers = make_table(
        "lines",
        [shapely.LineString([(-90, -40), (-60, -40), (-60, -20)]),
         shapely.LineString([(-90, -12), (90, -12)]),
         shapely.LineString([(70, -20), (90, -20), (90, -35), (70, -35), (70, -20)]),
         shapely.LineString([(-90, -80), (-10, -80)])],
        id=[51, 52, 53, 54], kind=["wall", "hedge", "fence", "tree_row"], height=[np.nan] * 4,
    )  # fmt: skip
    layout = Layout((-100.0, -100.0, 100.0, 100.0), buildings=buildings, roads=roads, areas=areas,
                    lines=barriers, points=points)  # fmt: skip
    return City("crossroads", Frame(52.5, 13.4), layout, network=network,
                stages_done=frozenset({"layout"}))  # fmt: skip
