"""What a map states of roofs and heights stands: its tags read a second time, the mesh measured."""

from math import cos, radians, sin

import numpy as np
import pytest
import shapely

from cityx.building.design import design
from cityx.building.shell import shell
from cityx.sources.osm import read_osm
from tests.town import Town

HEIGHT, RISE = 11.0, 3.0
POINTS = ("N", "NE", "E", "SE", "S", "SW", "W", "NW")
SNAP = 11.0  # degrees that a roof may turn to lie with its walls
TURN = radians(20)
PLANS = {
    "oblong": [(0, 0), (20, 0), (20, 12), (0, 12)],
    "square": [(0, 0), (12, 0), (12, 12), (0, 12)],
    "ell": [(0, 0), (20, 0), (20, 8), (8, 8), (8, 18), (0, 18)],
    "split": [(0, 0), (7, 0.02), (13, 0), (20, 0), (20, 5), (20, 12), (9, 12), (0, 12)],
    "turned": [
        (x * cos(TURN) - y * sin(TURN), x * sin(TURN) + y * cos(TURN))
        for x, y in [(0, 0), (20, 0), (20, 12), (0, 12)]
    ],
}
# How the slopes of a shape lie to its direction: all down to it, more down to it than away from
# it, on both sides of a ridge across it, or every way.
SLOPES = {
    "skillion": "down", "lean_to": "down", "sawtooth": "down", "saltbox": "mostly",
    "gabled": "both", "gambrel": "both", "round": "both", "zollinger": "both",
    "butterfly": "both", "double_saltbox": "both", "gabled_row": "both",
    "gabled_height_moved": "both", "crosspitched": "every", "hipped": "every",
    "half-hipped": "every", "side_hipped": "every", "side_half-hipped": "every",
    "hipped-and-gabled": "every", "mansard": "every", "pyramidal": "every", "dome": "every",
    "onion": "every", "cone": "every", "quadruple_saltbox": "every", "flat": "none",
}  # fmt: skip
USES = ("house", "yes", "apartments", "church", "barn", "school", "industrial", "retail", "garage")


class Map:
    """Houses in a grid beside a street, each with its own tags."""

    def __init__(self):
        self.town, self.count = Town(), 0
        self.town.way([self.town.node(-20, -12), self.town.node(900, -12)], highway="residential")

    def house(self, plan, **tags):
        x, y = 36.0 * (self.count % 25), 36.0 * (self.count // 25)
        use = USES[self.count % len(USES)]
        self.count += 1
        nodes = [self.town.node(x + a, y + b) for a, b in plan]
        return self.town.way([*nodes, nodes[0]], **{"building": use, **tags})

    def built(self, folder):
        """Return by the number of the way: triangles of the upper side, above the ground."""
        city = design(read_osm(self.town.write(folder / "map.osm")))
        assert not city.failures
        city = shell(city, parapet=False, overhang=0.0)
        batch = city.scene.meshes["buildings"]
        number = dict(
            zip(city.layout.buildings["id"], city.layout.buildings["source"], strict=True)
        )
        found = {}
        for row, key in enumerate(batch.object_id.tolist()):
            faces = batch.faces[batch.face_start[row] : batch.face_start[row + 1]]
            quads = faces[faces[:, 3] >= 0]
            corner = batch.vertices[np.vstack([faces[:, :3], quads[:, [0, 2, 3]]])]
            ground = 0.5 + corner[:, :, 2].min()  # shells reach half a metre into it
            found[int(number[key].split("/")[-1])] = corner - (0.0, 0.0, ground)
        return found


def slopes_of(corner):
    """Return vectors down the slopes of roofs, (n, 2), as long as the area they stand over."""
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]) / 2
    length = np.maximum(np.linalg.norm(normal, axis=1), 1e-12)
    up = (normal[:, 2] > 0.02 * length) & (normal[:, 2] < 0.9999 * length)
    across = normal[up, :2]
    return across / np.maximum(np.hypot(*across.T), 1e-12)[:, None] * normal[up, 2:]


def off_direction(slopes, compass):
    """Return degrees between where roofs slope down on the whole and a compass direction."""
    x, y = slopes.sum(axis=0)
    return abs((np.degrees(np.arctan2(x, y)) - compass + 180) % 360 - 180)


def off_axis(slopes, compass):
    """Return degrees between the line along which roofs slope and a compass direction."""
    values, vectors = np.linalg.eigh(slopes.T @ slopes)
    if values[1] < 2 * values[0]:
        return 90.0
    x, y = vectors[:, 1]
    return abs((np.degrees(np.arctan2(x, y)) - compass + 90) % 180 - 90)


def fits(slopes, kind, compass):
    if kind == "none":
        return len(slopes) == 0
    if kind == "every":
        return len(slopes) > 0
    if kind == "down":
        along = slopes @ (sin(radians(compass)), cos(radians(compass)))
        return off_direction(slopes, compass) < SNAP and along.min() > -0.02 * along.max()
    if kind == "mostly" and off_direction(slopes, compass) > 90:
        return False
    return off_axis(slopes, compass) < SNAP


def heights_hold(corner, shape):
    z = corner[:, :, 2]
    walls = np.abs(z[(z > 0.1) & (z < HEIGHT - 0.05)])
    eave = HEIGHT if shape == "flat" else HEIGHT - RISE
    return z.max() == pytest.approx(HEIGHT, abs=0.02) and (walls >= eave - 0.05).all()


@pytest.mark.parametrize("plan", PLANS)
def test_roofs_slope_the_way_their_tags_point(tmp_path, plan):
    drawn, said = Map(), {}
    for shape in SLOPES:
        for k, point in enumerate(POINTS):
            word = point if k % 2 else str(45 * k)
            key = drawn.house(PLANS[plan], height=f"{HEIGHT}", roof__height=f"{RISE}",
                              roof__shape=shape, roof__direction=word)  # fmt: skip
            said[key] = shape, 45 * k
    built = drawn.built(tmp_path)
    # The longer slope of a saltbox need not stand over more of an L.
    kinds = SLOPES | ({"saltbox": "both"} if plan == "ell" else {})
    wrong = [
        (shape, compass)
        for key, (shape, compass) in said.items()
        if not fits(slopes_of(built[key]), kinds[shape], compass)
        or not heights_hold(built[key], shape)
    ]
    assert wrong == []


@pytest.mark.parametrize("plan", ["oblong", "ell", "split", "turned"])
def test_ridges_run_along_or_across_the_longer_side(tmp_path, plan):
    drawn, said = Map(), {}
    long = 90.0 - (20.0 if plan == "turned" else 0.0)  # compass direction of the longer side
    for shape, kind in SLOPES.items():
        for word, compass in (("along", long + 90), ("across", long)):
            key = drawn.house(PLANS[plan], height=f"{HEIGHT}", roof__height=f"{RISE}",
                              roof__shape=shape, roof__orientation=word)  # fmt: skip
            said[key] = shape, word, kind, compass
    built = drawn.built(tmp_path)
    wrong = [
        (shape, word)
        for key, (shape, word, kind, compass) in said.items()
        if not fits(slopes_of(built[key]), "both" if kind in ("down", "mostly") else kind, compass)
        or not heights_hold(built[key], shape)
    ]
    assert wrong == []


def test_a_ridge_along_stays_so_in_a_terrace(tmp_path):
    drawn = Map()
    deep = {"building": "house", "height": "9", "roof:shape": "gabled", "roof:height": "3"}
    keys = [
        drawn.town.box(8.0 * k, 0.0, 8.0, 14.0, **deep, roof__orientation="along") for k in range(4)
    ]
    built = drawn.built(tmp_path)
    assert all(off_axis(slopes_of(built[key]), 90.0) < 1.0 for key in keys)


def test_a_low_house_of_stated_height_has_no_low_wing(tmp_path):
    drawn = Map()
    keys = [drawn.house(PLANS["oblong"], height="7.5") for _ in range(27)]
    built = drawn.built(tmp_path)
    for key in keys:
        corner = built[key]
        high = corner[corner[:, :, 2].max(axis=1) > 0.65 * 7.5]  # all slopes do
        cover = shapely.union_all(shapely.buffer(shapely.polygons(high[:, :, :2]), 0.01))
        assert corner[:, :, 2].max() == pytest.approx(7.5, abs=0.05)
        assert cover.area > 0.88 * 240


@pytest.mark.parametrize("key", ["building:roof:shape", "roof:type", "building:roof"])
def test_other_keys_state_a_roof_too(tmp_path, key):
    drawn = Map()
    way = drawn.house(PLANS["oblong"], building="house", height="9", **{key: "pyramidal"})
    corner = drawn.built(tmp_path)[way]
    peak = corner[corner[:, :, 2] > 8.99]
    assert np.ptp(peak[:, :2], axis=0) == pytest.approx([0, 0], abs=0.01)
