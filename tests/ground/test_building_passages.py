"""Ways that lead through houses are free in the finished meshes, with their walks."""

import numpy as np
import pytest
import shapely

import cityx
from cityx.checks.report import run_checks
from cityx.city.mesh_measures import check_closed
from cityx.ground.building_passages import passages
from cityx.ground.walking.walkable import walkable_of
from cityx.ground.walking.walks import walk_graph

HOUSE = {"building": "apartments", "building:levels": "4"}
THROUGH = {"tunnel": "building_passage"}
FOOT, STREET = {"highway": "footway"}, {"highway": "residential", "sidewalk": "both"}
# Tags of a way through a house, its course within the house, and the house: metres from its
# corner; a straight way leads on for 20 m at both ends.
CASES = {
    "straight": (FOOT, [(15, 0), (15, 12)], HOUSE),
    "street": (STREET, [(15, 0), (15, 12)], HOUSE | {"building:levels": "6"}),
    "oblique": ({"highway": "service", "covered": "yes"}, [(8, 0), (22, 12)], HOUSE),
    "shallow": (FOOT, [(3, 0), (27, 12)], HOUSE | {"roof:shape": "gabled"}),
    "corner": (FOOT, [(0, 5), (5, 0)], HOUSE),
    "train": ({"railway": "rail"}, [(12, 0), (14, 12)], HOUSE),
    "low": (FOOT | {"maxheight": "2.3"}, [(15, 0), (15, 12)], {"building": "shed", "height": "3"}),
    "stated": (STREET | {"maxheight": "3.8"}, [(14, 0), (14, 12)], HOUSE | {"height": "14"}),
    "walkers": ({"highway": "pedestrian", "width": "5"}, [(15, 0), (15, 12)], HOUSE),
}  # fmt: skip
WIDE, DEEP, PITCH = 30, 12, 70


class Map:
    def __init__(self):
        self.nodes, self.ways, self.ids = {}, [], 100_000

    def node(self, place):
        return self.nodes.setdefault((round(place[0], 3), round(place[1], 3)), len(self.nodes) + 1)

    def way(self, tags, places):
        self.ids += 1
        told = "".join(f'<tag k="{key}" v="{value}"/>' for key, value in tags.items())
        refs = "".join(f'<nd ref="{self.node(place)}"/>' for place in places)
        self.ways.append(f'<way id="{self.ids}">{refs}{told}</way>')
        return f"osm/way/{self.ids}"

    def write(self, path):
        nodes = "".join(
            f'<node id="{key}" lat="{48.2 + y / 111_200:.8f}" lon="{16.3 + x / 74_200:.8f}"/>'
            for (x, y), key in self.nodes.items()
        )
        path.write_text(f'<osm version="0.6">{nodes}{"".join(self.ways)}</osm>')
        return path


def drawn(cases):
    """Draw houses in rows; return the map, and the names of the ways through them."""
    drawing, names = Map(), {}
    for number, (case, (tags, course, house)) in enumerate(cases.items()):
        at = np.array([PITCH * (number % 3), PITCH * (number // 3)], float)
        course = np.array(course, float) + at
        ring = [(0, 0), (WIDE, 0), (WIDE, DEEP), (0, DEEP), (0, 0)]
        drawing.way(house, [tuple(at + corner) for corner in ring])
        along = (course[-1] - course[0]) / np.hypot(*(course[-1] - course[0]))
        inner = [tuple(place) for place in course]
        names[case] = drawing.way(tags | ({} if "covered" in tags else THROUGH), inner)
        open_air = {key: value for key, value in tags.items() if key != "covered"}
        drawing.way(open_air, [tuple(course[0] - 20 * along), inner[0]])
        drawing.way(open_air, [inner[-1], tuple(course[-1] + 20 * along)])
    return drawing, names


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    drawing, names = drawn(CASES)
    path = drawing.write(tmp_path_factory.mktemp("passages") / "map.osm")
    return cityx.build(path, lod=1).city, names


def triangles(city):
    batch = city.scene.meshes["buildings"]
    quads = batch.faces[batch.faces[:, 3] >= 0]
    return batch.vertices[np.vstack([batch.faces[:, :3], quads[:, [0, 2, 3]]])]


def crossed(faces, start, step):
    """Return whether a segment meets one of some triangles (Moeller and Trumbore)."""
    one, two = faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0]
    across = np.cross(step, two)
    size = (one * across).sum(axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        away = start - faces[:, 0]
        u = (away * across).sum(axis=1) / size
        turned = np.cross(away, one)
        v, t = turned @ step / size, (two * turned).sum(axis=1) / size
        return bool(((u >= 0) & (v >= 0) & (u + v <= 1) & (t >= 0) & (t <= 1)).any())


def blocked(city, source, headroom, walks=0.0):
    """Return the share of rays along a way, over its width and headroom, that meet a wall."""
    row = int(np.flatnonzero(city.layout.roads["source"] == source)[0])
    line = city.layout.roads.geometry.to_numpy()[row]
    half = city.layout.roads["width"].to_numpy()[row] / 2 + walks - 0.05
    faces, met = triangles(city), []
    for side in np.linspace(-half, half, 5):
        course = shapely.get_coordinates(shapely.offset_curve(line, side) if side else line)
        ground = city.terrain.height_at(course)
        for height in (0.3, 1.5, headroom - 0.1):
            start, end = np.column_stack([course, ground + 0.12 + height])[[0, -1]]
            met.append(crossed(faces, start, end - start))
    return np.mean(met)


HEADROOM = {"street": 4.5, "oblique": 4.5, "train": 5.6, "low": 2.3, "stated": 3.8}


@pytest.mark.parametrize("case", sorted(CASES))
def test_nothing_stands_in_a_way_through_a_house(built, case):
    city, names = built
    assert blocked(city, names[case], HEADROOM.get(case, 3.0)) == 0.0


def test_walks_lead_through_beside_the_street(built):
    city, names = built
    row = city.layout.roads.set_index("source").loc[names["street"]]
    assert min(row["sidewalk_left"], row["sidewalk_right"]) > 1.0
    assert blocked(city, names["street"], 3.0, walks=row["sidewalk_left"]) == 0.0


@pytest.mark.parametrize("case", ["straight", "stated", "low"])
def test_the_house_stands_over_the_way_from_its_headroom_up(built, case):
    city, names = built
    line = city.layout.roads.set_index("source").geometry[names[case]]
    middle = shapely.get_coordinates(line.interpolate(0.5, normalized=True))[0]
    headroom = HEADROOM.get(case, 3.0)
    assert crossed(triangles(city), np.array([*middle, headroom - 0.2]), np.array([0, 0, 0.6]))


def test_shells_are_closed_and_checks_hold(built):
    city, _ = built
    assert check_closed(city.scene.meshes["buildings"]).all()
    assert [check.name for check in run_checks(city) if not check.ok] == []


def test_people_walk_through(built):
    city, names = built
    graph = walk_graph(walkable_of(city))
    near = shapely.points(graph.places)
    for case in ("straight", "shallow", "street", "walkers"):
        line = city.layout.roads.set_index("source").geometry[names[case]]
        assert shapely.dwithin(line.interpolate(0.5, normalized=True), near, 3.0).any(), case


def test_a_way_that_ends_in_a_house_opens_it_so_far(tmp_path):
    drawing = Map()
    ring = [(0, 0), (30, 0), (30, 20), (0, 20), (0, 0)]
    drawing.way(HOUSE, ring)
    drawing.way(FOOT | THROUGH, [(10, 0), (10, 8)])
    drawing.way(FOOT, [(10, -20), (10, 0)])
    city = cityx.build(drawing.write(tmp_path / "map.osm"), lod=0).city
    found = passages(city.layout)
    taken = shapely.union_all(found.room).intersection(city.layout.buildings.geometry.iloc[0])
    assert 7.5 < taken.bounds[3] - taken.bounds[1] < 8.5


def test_no_window_or_door_hangs_in_the_mouth_of_a_way(tmp_path):
    drawing, names = drawn({name: CASES[name] for name in ("straight", "street")})
    city = cityx.build(drawing.write(tmp_path / "map.osm"), lod=3).city
    lines = city.layout.roads.set_index("source")
    for name in names.values():
        room = lines.geometry[name].buffer(lines["width"][name] / 2 - 0.1, cap_style="flat")
        for rows in city.scene.instances.values():
            inside = shapely.contains(room, shapely.points(rows.position[:, :2]))
            assert not (inside & (rows.position[:, 2] < 2.5) & (rows.owner > 0)).any()
        assert blocked(city, name, 3.0) == 0.0
    assert [check.name for check in run_checks(city) if not check.ok] == []


def test_a_way_without_room_for_its_headroom_is_named(tmp_path):
    shed = {"building": "shed", "height": "3"}
    drawing, names = drawn({"street": (STREET, [(15, 0), (15, 12)], shed)})
    city = cityx.build(drawing.write(tmp_path / "map.osm"), lod=0).city
    told = [note for note in city.notes if "less headroom" in note]
    assert len(told) == 1
    assert told[0].endswith(names["street"])
    assert blocked(city, names["street"], 2.5) == 0.0


def test_a_house_no_wider_than_the_way_through_it_hangs_over_it(tmp_path):
    drawing = Map()
    drawing.way(HOUSE, [(0, 0), (4, 0), (4, 10), (0, 10), (0, 0)])
    drawing.way(HOUSE, [(4, 0), (20, 0), (20, 10), (4, 10), (4, 0)])
    way = drawing.way({"highway": "residential"} | THROUGH, [(2, 0), (2, 10)])
    drawing.way({"highway": "residential"}, [(2, -30), (2, 0)])
    city = cityx.build(drawing.write(tmp_path / "map.osm"), lod=0).city
    assert len(city.layout.buildings) == 2
    row = city.layout.roads.set_index("source").loc[way]
    assert crossed(triangles(city), np.array([*row.geometry.coords[0], 8.0]), np.array([0, 5, 0]))
    assert "floating_building" not in [check.name for check in run_checks(city) if not check.ok]


@pytest.mark.parametrize("covered", ["yes", "arcade", "no"])
def test_a_covered_street_leaves_junctions_in_the_open_whole(tmp_path, covered):
    # Of three arms of a junction two are covered; a house stands over one of them, farther on.
    drawn = Map()
    under = {"highway": "tertiary", "covered": covered}
    drawn.way(under, [(-60, 0), (0, 0)])
    drawn.way(under, [(0, 0), (60, 0)])
    drawn.way(STREET, [(0, 0), (10, 60)])
    drawn.way(HOUSE, [(25, -9), (45, -9), (45, 9), (25, 9), (25, -9)])
    drawn.write(tmp_path / "map.osm")
    city = cityx.build(tmp_path / "map.osm", lod=1).city
    hub = city.network.node_position[city.network.node_degree == 3][0]
    around = hub + 2.0 * np.array([(x, y) for x in (-1, 0, 1) for y in (-1, 0, 1)])
    assert city.ground.on(around, "junction", "marking").all()
    assert not city.ground.on(around, "carriageway").any()
    assert all(check.ok for check in run_checks(city) if check.name.startswith("junction"))
