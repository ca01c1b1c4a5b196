"""What moves, in GLB and USD: read back and compared with the figures and the tracks."""

import numpy as np
import pytest
from glb_scenes import read_glb
from moving_city import BIKE, CAR, MAN, RUNNER, moving
from scipy.spatial.transform import Rotation, Slerp
from test_glb_validator import EXPECTED, messages

from cityx.assets.people.gaits import going, stride_of
from cityx.assets.vehicles.movers import figure_of, vehicle
from cityx.assets.vehicles.moving import gait_phase, with_movers
from cityx.city.tracks import GAIT
from cityx.outputs.glb import write_glb
from cityx.outputs.gltf_animation import MOST_BYTES, span_of

CITY = moving(CAR, MAN, RUNNER, BIKE)


@pytest.fixture(scope="module")
def glb(tmp_path_factory):
    path = tmp_path_factory.mktemp("glb") / "city.glb"
    write_glb(CITY, path, texture_size=0)
    return read_glb(path)


class Player:
    """Plays the animation of a file to one moment."""

    def __init__(self, glb, time):
        self.glb, self.nodes = glb, [dict(node) for node in glb.json["nodes"]]
        (animation,) = glb.json["animations"]
        for channel in animation["channels"]:
            sampler = animation["samplers"][channel["sampler"]]
            target = channel["target"]
            times = glb.array(sampler["input"]).ravel().astype(float)
            values = glb.array(sampler["output"]).astype(float)
            at = np.clip(time, times[0], times[-1])
            if target["path"] == "rotation":
                turn = Slerp(times, Rotation.from_quat(values))(at)
                self.nodes[target["node"]]["rotation"] = turn.as_quat()
            else:
                place = [np.interp(at, times, column) for column in values.T]
                self.nodes[target["node"]]["translation"] = place
        self.parent = {c: n for n, node in enumerate(self.nodes) for c in node.get("children", ())}

    def matrix(self, number):
        node = self.nodes[number]
        own = np.eye(4)
        own[:3, :3] = Rotation.from_quat(node.get("rotation", [0, 0, 0, 1])).as_matrix()
        own[:3, 3] = node.get("translation", (0, 0, 0))
        return self.matrix(self.parent[number]) @ own if number in self.parent else own

    def body(self, name):
        """(n, 3) corners of a skinned mesh, z up."""
        (node,) = [node for node in self.nodes if node.get("name") == name]
        skin = self.glb.json["skins"][node["skin"]]
        inverse = self.glb.array(skin["inverseBindMatrices"]).reshape(-1, 4, 4)
        bones = [self.matrix(j) @ m.T for j, m in zip(skin["joints"], inverse, strict=True)]
        bones = np.array(bones)
        held = self.glb.json["meshes"][node["mesh"]]["primitives"][0]["attributes"]
        points = self.glb.array(held["POSITION"]).astype(float)
        joints = self.glb.array(held["JOINTS_0"]).astype(int)
        shares = self.glb.array(held["WEIGHTS_0"]) / 255
        homogeneous = np.column_stack([points, np.ones(len(points))])
        moved = np.einsum("nkij,nj->nki", bones[joints], homogeneous)
        x, y, z, _ = (moved * shares[:, :, None]).sum(axis=1).T
        return np.column_stack([x, -z, y])


@pytest.mark.parametrize("mover", [MAN, RUNNER], ids=["walk", "run"])
@pytest.mark.parametrize("time", [0.0, 1.37, 4.0, 9.9])
def test_a_skinned_person_is_the_figure_in_its_gait_where_the_track_has_it(glb, mover, time):
    object_id, look, _, gait, start, heading, speed = mover
    figure = figure_of(look, 2)
    ids = np.array([object_id], np.uint64)
    phase = gait_phase(stride_of(figure, GAIT[gait]), np.array([speed * time]), ids)[0]
    mesh = going(figure, GAIT[gait], float(phase))
    turn = Rotation.from_euler("z", heading + np.pi / 2).as_matrix()
    gone = speed * time * np.array([np.cos(heading), np.sin(heading), 0])
    wanted = mesh.vertices @ turn.T + np.array(start) + gone
    found = Player(glb, time).body(f"body_{object_id:016x}")
    assert found.min(axis=0) == pytest.approx(wanted.min(axis=0), abs=0.05)
    assert found.max(axis=0) == pytest.approx(wanted.max(axis=0), abs=0.05)
    assert found[:, 2].min() > start[2] - 0.03


def test_wheels_roll_as_far_as_the_car_goes(glb):
    (car,) = [n for n, node in enumerate(glb.json["nodes"]) if node.get("name") == f"car_{8:016x}"]
    wheel = glb.json["nodes"][car]["children"][0]
    made = vehicle("car_sedan").wheels[0]
    radius = made.radius
    across, ahead, up = made.place
    assert glb.json["nodes"][wheel]["translation"] == pytest.approx([across, up, -ahead], abs=1e-4)
    before, after = Player(glb, 2.0), Player(glb, 2.1)
    gone = after.nodes[car]["translation"][0] - before.nodes[car]["translation"][0]
    assert gone == pytest.approx(0.5)
    turns = [Rotation.from_quat(p.nodes[wheel]["rotation"]) for p in (before, after)]
    assert (turns[0].inv() * turns[1]).magnitude() == pytest.approx(gone / radius, rel=0.01)


def test_every_mover_is_a_node_of_its_id_and_stands_as_at_the_moment(glb):
    held = {
        node["extras"]["cityx_id"]: node
        for node in glb.json["nodes"]
        if node.get("extras", {}).get("kind") in ("car", "pedestrian", "bicycle")
    }
    assert set(held) == {f"{mover[0]:016x}" for mover in (CAR, MAN, RUNNER, BIKE)}
    assert held[f"{9:016x}"]["translation"] == pytest.approx([3, 0.12, -4])


def test_an_animated_city_is_valid(tmp_path):
    write_glb(CITY, tmp_path / "city.glb", texture_size=16)
    assert messages(tmp_path / "city.glb") <= EXPECTED


def test_the_same_city_gives_the_same_file(tmp_path):
    for name in "ab":
        write_glb(CITY, tmp_path / f"{name}.glb", texture_size=0)
    assert (tmp_path / "a.glb").read_bytes() == (tmp_path / "b.glb").read_bytes()


def test_a_busy_city_is_animated_for_a_shorter_span():
    crowd = [(n + 1, *MAN[1:]) for n in range(2000)]
    begin, end = span_of(moving(*crowd, seconds=60.0).tracks, 3.0)
    assert begin == 3.0
    assert 1.0 <= end - begin < 57.0
    assert MOST_BYTES < 100e6


def test_usd_has_every_mover_at_every_frame(tmp_path):
    usd = pytest.importorskip("pxr.Usd")
    from pxr import UsdGeom

    from cityx.outputs.usd import write_usd

    write_usd(CITY, tmp_path / "city.usdc", texture_size=0)
    stage = usd.Stage.Open(str(tmp_path / "city.usdc"))
    assert (stage.GetStartTimeCode(), stage.GetEndTimeCode()) == (0, 250)
    assert stage.GetTimeCodesPerSecond() == 25
    people = UsdGeom.PointInstancer.Get(stage, "/City/people")
    origin = people.GetPrim().GetAttribute("xformOp:translate").Get()
    for frame in (0, 50, 250):
        shown = with_movers(CITY, frame / 25).scene.instances["people"]
        assert list(people.GetIdsAttr().Get()) == shown.object_id.tolist()
        places = np.array(people.GetPositionsAttr().Get(frame)) + np.array(origin)
        assert places == pytest.approx(shown.position, abs=1e-3)
    kinds = {people.GetProtoIndicesAttr().Get(frame)[0] for frame in range(30)}
    assert len(kinds) > 8  # legs move
    traffic = UsdGeom.PointInstancer.Get(stage, "/City/traffic")
    assert len(traffic.GetIdsAttr().Get()) == 5 + 4  # a car, a bicycle and its rider, six wheels
