"""Robots in MuJoCo: stopped by kerbs and walls, not by lowered ones; the window goes along."""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from cityx.dataset.classes import CLASS
from cityx.errors import InputError, UsageError
from cityx.geometry.raycast import shapes_of
from cityx.ids import id_text
from cityx.sim.contact.ground import height_at
from cityx.sim.contact.window import MOVERS, ContactWindow
from cityx.sim.places import scenery_of

pytest.importorskip("mujoco")
ROBOT = Path(__file__).parents[2] / "examples" / "contact" / "robot.xml"
AHEAD, STILL = [8.0] * 4, [0.0] * 4


@pytest.fixture(scope="session")
def place(town, world):
    return world, scenery_of(town, world)


@pytest.fixture(scope="session")
def lane(world):
    """A point of a lane and its direction, with 40 m of straight lane ahead."""
    for piece in np.flatnonzero(~world.across & (world.piece_length > 45)).tolist():
        point = world.point[world.point_start[piece] : world.point_start[piece + 1]]
        if np.ptp(point[:, 3]) < 0.02:
            return point[0, :2], float(point[0, 3])
    raise AssertionError("the town has no straight lane")


def driven(window, tenths, control=AHEAD):
    """Drive on; returns places, (t, 3), and all that was touched."""
    places, touched = [], set()
    for _ in range(tenths):
        window.step(control)
        places.append(window.position)
        touched |= set(window.touched())
    return np.array(places), touched


@pytest.fixture(scope="session")
def street(place):
    """A street with a kerb of 0.12 m at x = 0, lowered to 0.02 m where |y| < 2 m; nothing else."""
    world, scenery = place
    quads = [
        [(-20, -200, 0), (0, -200, 0), (0, 200, 0), (-20, 200, 0)],  # the roadway
        [(1.2, -2, 0.12), (20, -2, 0.12), (20, 2, 0.12), (1.2, 2, 0.12)],
        [(0, -2, 0.02), (1.2, -2, 0.12), (1.2, 2, 0.12), (0, 2, 0.02)],  # the ramp
        [(0, 2, 0), (0, -2, 0), (0, -2, 0.02), (0, 2, 0.02)],
    ]
    for low, high in ((-200, -2), (2, 200)):  # much longer than a window
        quads.append([(0, low, 0.12), (20, low, 0.12), (20, high, 0.12), (0, high, 0.12)])
        quads.append([(0, high, 0), (0, low, 0), (0, low, 0.12), (0, high, 0.12)])
    points = np.array(quads, float).reshape(-1, 3)
    faces = np.concatenate([[(4 * k, 4 * k + 1, 4 * k + 2), (4 * k, 4 * k + 2, 4 * k + 3)]
                            for k in range(len(quads))])  # fmt: skip
    shapes = shapes_of([points], [faces])
    bare = replace(
        scenery, root=shapes.root, box=shapes.box, child=shapes.child, corner=shapes.corners,
        face_part=np.zeros(len(faces), np.int32), thing_way=np.eye(3, 4)[None],
        thing_object=np.zeros(1, np.int64), cluster_thing=np.zeros(1, np.int32),
        cluster_node=shapes.root, object_id=np.ones(1, np.uint64),
        object_class=np.array([CLASS["road"]], np.uint8), prop_thing=np.zeros(0, np.int64),
    )  # fmt: skip
    empty = replace(world, segment=world.segment[:0], segment_object=world.segment_object[:0])
    return empty, bare


def test_a_high_kerb_stops_a_robot(street):
    for y in (-6.0, 5.0):
        window = ContactWindow(street, ROBOT, at=(-1.5, y))
        assert window.patch.kerb[:, 6] == pytest.approx(0.12, abs=1e-3)
        places, touched = driven(window, 40)
        assert "kerb" in touched
        # Its front may get up, its rear wheels do not: they are 0.22 m behind its middle.
        assert places[-1, 0] - 0.22 < 0.0
        assert places[-1, 2] < 0.12 + 0.19 - 0.03


def test_a_lowered_kerb_lets_a_robot_up(street):
    for y in (-1.0, 0.0, 1.0):
        window = ContactWindow(street, ROBOT, at=(-1.5, y))
        places, touched = driven(window, 40)
        assert touched == {"ground"}
        assert places[-1, 0] > 2.0
        assert places[-1, 2] == pytest.approx(0.12 + 0.19, abs=0.02)


def test_a_robot_stands_on_a_ramp(street):
    window = ContactWindow(street, ROBOT, at=(0.6, 0.0), heading=np.pi)
    driven(window, 10, STILL)
    before = window.position
    places, _ = driven(window, 30, STILL)
    assert np.linalg.norm(places[-1] - before) < 0.03


def test_kerbs_of_a_city_are_as_high_as_they_are_built(place, lane):
    about = ContactWindow(place, ROBOT, at=lane[0]).patch
    assert len(about.kerb) >= 2
    for x, y, z, _, heading, _, drop in about.kerb.tolist():
        ahead = 0.2 * np.array([np.cos(heading), np.sin(heading)])
        high, low = (height_at(place[1], *([x, y] + side * ahead)) for side in (1, -1))
        assert high == pytest.approx(z, abs=0.02)
        assert high - low == pytest.approx(drop, abs=0.02)


def test_a_wall_stops_a_robot_and_is_told_by_its_id(place):
    world, _ = place
    side = np.asarray(world.segment, float)
    length = np.hypot(side[:, 2] - side[:, 0], side[:, 3] - side[:, 1])
    tall = np.flatnonzero((length > 8.0) & (side[:, 5] - side[:, 4] > 2.0))
    for row in tall.tolist():
        ax, ay, bx, by = side[row, :4]
        normal = np.array([by - ay, ax - bx]) / length[row]
        middle = np.array([ax + bx, ay + by]) / 2
        spot = middle + 1.5 * normal
        if np.abs(spot).max() > 60.0:  # of what lies within the site
            continue
        window = ContactWindow(place, ROBOT, at=spot,
                               heading=float(np.arctan2(-normal[1], -normal[0])))  # fmt: skip
        if driven(window, 3, STILL)[1] <= {"ground"}:
            break
    places, touched = driven(window, 25)
    assert id_text(int(world.segment_object[row])) in touched
    assert (places[-1, :2] - middle) @ normal > 0.2


def test_the_window_goes_with_the_robot_and_nothing_jumps(place, lane):
    spot, heading = lane
    window = ContactWindow(place, ROBOT, at=spot, heading=heading, size=30.0)
    first = window.patch.middle.copy()
    places, _ = driven(window, 130, [12.0] * 4)
    assert np.hypot(*(window.patch.middle - first)) > 4.0
    assert np.hypot(*(places[-1, :2] - spot)) > 12.0
    steps = np.linalg.norm(np.diff(places[10:], axis=0), axis=1)
    assert steps.max() < 0.3
    assert steps.min() > 0.05
    ground = height_at(place[1], *places[-1, :2])
    assert places[-1, 2] - ground == pytest.approx(0.19, abs=0.05)


def test_a_mover_is_met_and_named(place, lane):
    spot, heading = lane
    ahead = np.array([np.cos(heading), np.sin(heading)])
    window = ContactWindow(place, ROBOT, at=spot, heading=heading)
    box = [
        *(spot + 3.0 * ahead),
        height_at(place[1], *(spot + 3.0 * ahead)),
        heading,
        1.0,
        1.8,
        1.5,
    ]
    far = [[spot[0] + 500.0, spot[1], 0.0, 0.0, 4.0, 2.0, 1.5]] * (MOVERS + 3)
    window.place_movers([*far, box], [*(f"far:{k}" for k in range(MOVERS + 3)), "traffic:7"])
    places, touched = driven(window, 40)
    assert "traffic:7" in touched
    assert not any(name.startswith("far") for name in touched)
    assert (places[-1, :2] - spot) @ ahead < 2.5


def test_movers_of_an_engine_are_where_it_has_them(place, lane, engine):
    one = engine(1, traffic=3)
    window = ContactWindow(place, ROBOT, at=lane[0])
    window.place_movers_of(one)
    there = window.data.mocap_pos[:4, :2] + window.patch.middle
    real = one.state.real[0]
    for n in range(4):
        assert np.hypot(*(there - real[:2, n]).T).min() < 1e-9


def test_the_same_drive_gives_the_same_bytes(place, lane):
    told = []
    for _ in range(2):
        window = ContactWindow(place, ROBOT, at=lane[0], heading=lane[1], size=30.0)
        driven(window, 60, [11.0, 12.0, 11.0, 12.0])
        told.append(window.data.qpos[:11].tobytes() + window.data.qvel[:10].tobytes())
    assert told[0] == told[1]


def test_what_is_of_no_use_is_refused_in_a_sentence(place, lane, tmp_path):
    bare = tmp_path / "bare.xml"
    bare.write_text('<mujoco><worldbody><body><geom size="1"/></body></worldbody></mujoco>')
    broken = tmp_path / "broken.xml"
    broken.write_text("<mujoco><worldbody>")
    with pytest.raises(InputError, match="freejoint"):
        ContactWindow(place, bare, at=lane[0])
    with pytest.raises(InputError, match="no model of MuJoCo"):
        ContactWindow(place, broken, at=lane[0])
    with pytest.raises(InputError, match="no model of MuJoCo"):
        ContactWindow(place, tmp_path / "absent.xml", at=lane[0])
    with pytest.raises(UsageError, match="no ground at"):
        ContactWindow(place, ROBOT, at=(1e5, 0.0))
    with pytest.raises(UsageError, match="size is 5"):
        ContactWindow(place, ROBOT, at=lane[0], size=5)
    window = ContactWindow(place, ROBOT, at=lane[0])
    with pytest.raises(UsageError, match="4 finite numbers"):
        window.step([1.0, float("nan"), 0.0, 0.0])


def test_without_mujoco_the_extra_is_named(place, lane, monkeypatch):
    monkeypatch.setitem(sys.modules, "mujoco", None)
    with pytest.raises(Exception, match=r"cityx\[sim\]"):
        ContactWindow(place, ROBOT, at=lane[0])
