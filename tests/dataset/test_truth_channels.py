import numpy as np
import pytest
from made_view import GROUND, HOUSE, POST, WINDOW, box, plate, rows, shot, street, view

from cityx.city.camera import project, rays
from cityx.city.scene import Prototype, Scene
from cityx.city.store import read_view
from cityx.dataset.channels import CHANNELS, SETS
from cityx.dataset.classes import CLASS, CLASSES
from cityx.dataset.sight import sight
from cityx.dataset.stage import stage_of
from cityx.dataset.truth import truth

STILL = [name for name in SETS["truth"] if name not in ("flow", "motion")]


@pytest.fixture(scope="module")
def stage():
    return stage_of(view(street()))


@pytest.fixture(scope="module")
def town(scene_folder):
    """Stage of a built town, and shots of it from a street and from above."""
    held = read_view(scene_folder("grid_s") / "city")
    shots = [
        shot((x, y, z), heading, pitch, width=320, height=240)
        for x, y, z, heading, pitch in (
            (0.0, 0.0, 2.0, 0.4, 0.0), (-30.0, 20.0, 2.0, 2.0, 0.1), (0.0, -60.0, 60.0, 0.0, -0.6),
        )
    ]  # fmt: skip
    return stage_of(held), shots


def test_a_wall_ahead_has_its_depth_and_the_sky_none(stage):
    record = truth(stage, shot(), STILL)
    depth = record.channels["depth"]
    middle = depth[24 + 2, 10]  # beside the window, below the horizon by little
    assert middle == pytest.approx(10.0, abs=1e-6)
    assert np.isinf(depth[0, 0]) == (record.channels["instance"][0, 0] == 0)
    assert record.channels["instance"][26, 10] == HOUSE
    np.testing.assert_allclose(record.channels["normal"][26, 10], (0.0, -1.0, 0.0), atol=1e-7)
    up = truth(stage, shot(pitch=1.2), STILL)
    assert np.isinf(up.channels["depth"]).all()
    assert (up.channels["semantic"] == CLASS["sky"]).all()
    assert [(s.object_id, s.semantic, s.pixels) for s in up.segments] == [(0, 0, 64 * 48)]


def test_channels_have_the_types_of_the_table(stage):
    record = truth(stage, shot(), STILL)
    assert list(record.channels) == STILL
    for name, values in record.channels.items():
        channel = CHANNELS[name]
        assert values.dtype == channel.dtype
        assert values.shape == ((48, 64) if channel.depth == 1 else (48, 64, channel.depth))


def test_a_window_is_of_its_house_and_keeps_its_own_material(stage):
    record = truth(stage, shot(), STILL)
    row, column = 20, 32
    assert record.channels["depth"][row, column] == pytest.approx(9.95)
    assert record.channels["instance"][row, column] == HOUSE
    assert record.channels["semantic"][row, column] == CLASS["building"]
    assert stage.materials[record.channels["material"][row, column]] == "glass"
    at = stage.piece.tolist().index(WINDOW)
    assert CLASSES[stage.piece_class[at]].name == "window"


def test_each_pixel_has_one_segment_that_agrees_with_its_id_and_class(stage):
    record = truth(stage, shot(pitch=-0.1), STILL)
    made = record.channels
    assert sum(segment.pixels for segment in record.segments) == 64 * 48
    assert [s.number for s in record.segments] == list(range(1, len(record.segments) + 1))
    seen = set()
    for segment in record.segments:
        own = made["panoptic"] == segment.number
        assert own.sum() == segment.pixels > 0
        assert set(made["semantic"][own].tolist()) == {segment.semantic}
        if segment.object_id:
            assert set(made["instance"][own].tolist()) == {segment.object_id}
            assert segment.object_id not in seen
            seen.add(segment.object_id)
    assert seen == {HOUSE, POST}
    assert (made["instance"] == GROUND).any()  # stuff has the City's id too


def test_depth_reproduces_world_points_within_a_centimetre_at_100_metres():
    far = Scene().with_mesh("ground", plate(1, 2.0, height=0.0))
    corner = np.array([70.0, 70.0, 0.0])
    far = far.with_mesh("buildings", box(2, corner, corner + 5.0))
    eye = (0.0, 0.0, 2.0)
    seen = shot(eye, np.pi / 4, 0.02, width=200, height=150, hfov=0.1)
    made = truth(stage_of(view(far)), seen, ["depth", "normal", "distance", "position"]).channels
    met = np.isfinite(made["depth"])
    assert met.sum() > 1000
    points = np.array(eye) + made["depth"][met][:, None].astype(float) * rays(seen.camera)[met]
    assert np.linalg.norm(points - eye, axis=1).min() > 95
    on_face = np.abs(points[:, None, :2] - corner[:2]).min(axis=(1, 2))  # x or y is 70
    assert on_face.max() < 1e-3
    place, depth = project(seen.camera, points)
    y, x = np.nonzero(met)
    np.testing.assert_allclose(place, np.column_stack([x, y]) + 0.5, atol=1e-3)
    np.testing.assert_allclose(depth, made["depth"][met], rtol=1e-6)
    np.testing.assert_allclose(made["position"][met] + np.array(eye), points, atol=1e-3)
    lengths = np.linalg.norm(made["position"][met].astype(float), axis=1)
    np.testing.assert_allclose(made["distance"][met], lengths, rtol=1e-6)


def test_normals_of_a_town_are_unit_towards_the_eye_and_agree_with_depth(town):
    stage, shots = town
    assert shots
    for one in shots:
        made = truth(stage, one, STILL).channels
        met = np.isfinite(made["depth"])
        assert met.mean() > 0.1
        normal, ahead = made["normal"][met].astype(float), rays(one.camera)[met]
        np.testing.assert_allclose(np.linalg.norm(normal, axis=1), 1.0, atol=1e-6)
        assert ((normal * ahead).sum(axis=1) <= 1e-6).all()
        # Points seen on one triangle lie in a plane with its normal.
        hits = sight(stage, one).hits
        face = np.where(hits.instance >= 0, hits.instance * 2**31 + hits.triangle, -1)
        face = face.reshape(made["depth"].shape)
        here, beside = made["position"][:, :-1][met[:, :-1]], made["position"][:, 1:][met[:, :-1]]
        same = (face[:, :-1] == face[:, 1:])[met[:, :-1]]
        step = beside[same].astype(float) - here[same]
        off = np.abs((made["normal"][:, :-1][met[:, :-1]][same] * step).sum(axis=1))
        assert same.sum() > 10_000
        assert (off / np.linalg.norm(step, axis=1)).max() < 1e-3


def test_ids_of_a_town_are_those_of_the_city(town, scene):
    stage, shots = town
    city = scene("grid_s")
    own = {int(i) for batch in city.scene.meshes.values() for i in batch.object_id}
    own |= {int(i) for held in city.scene.instances.values() for i in held.object_id}
    houses = {int(i) for i in city.layout.buildings["id"]}
    shown = set()
    for one in shots:
        made = truth(stage, one, STILL)
        ids = set(np.unique(made.channels["instance"]).tolist()) - {0}
        assert ids <= own
        shown |= ids
        built = made.channels["semantic"] == CLASS["building"]
        assert set(np.unique(made.channels["instance"][built]).tolist()) <= houses
    assert len(shown & houses) >= 3
    assert houses <= {int(i) for i in stage.view.objects}


def test_the_same_shot_gives_the_same_bytes_on_one_thread_and_on_two(town):
    stage, shots = town
    again = stage_of(stage.view)
    assert shots
    for one in shots:
        made = [truth(stage, one, STILL, boxes=True, threads=1),
                truth(again, one, STILL, boxes=True, threads=2)]  # fmt: skip
        for name in STILL:
            assert made[0].channels[name].tobytes() == made[1].channels[name].tobytes(), name
        assert made[0].segments == made[1].segments
        for name, values in vars(made[0].boxes).items():
            assert values.tobytes() == getattr(made[1].boxes, name).tobytes(), name


def test_what_is_nearer_than_the_clip_is_not_seen(stage):
    made = truth(stage, shot((0.0, 9.88, 3.0)), ["depth"]).channels["depth"]
    assert made[24, 32] == pytest.approx(0.12, abs=1e-6)  # the window is at 0.07


def test_trees_stand_bare_under_snow():
    from dataclasses import replace

    from cityx.city.environment import Environment
    from cityx.city.mesh import concatenate, one_mesh

    trunk = box(0, (-0.2, -0.2, 0.0), (0.2, 0.2, 3.0), "bark")
    leaves = box(0, (-2.0, -2.0, 3.0), (2.0, 2.0, 7.0), "foliage")
    both = concatenate([trunk, leaves])
    mesh = one_mesh(0, both.vertices, both.faces, material=both.material, materials=both.materials)
    seen = shot((0.0, -10.0, 2.0), pitch=0.3)
    pixels = {}
    for name in ("tree_lime_0_near", "tree_pine_0_near"):
        scene = Scene().with_instances(
            "trees", [Prototype(name, "tree", mesh)], rows((0.0, 0.0, 0.0), ids=[7])
        )
        for snow in (0.0, 0.8):
            held = replace(view(scene), environment=Environment(snow=snow))
            made = truth(stage_of(held), seen, ["semantic"]).channels["semantic"]
            pixels[name, snow] = int((made == CLASS["tree"]).sum())
    assert pixels["tree_lime_0_near", 0.8] < pixels["tree_lime_0_near", 0.0] / 3
    assert pixels["tree_lime_0_near", 0.8] > 0
    assert pixels["tree_pine_0_near", 0.8] == pixels["tree_pine_0_near", 0.0]


def test_a_shot_under_snow_needs_a_stage_under_snow(stage):
    from dataclasses import replace

    from cityx.city.environment import Environment
    from cityx.errors import UsageError

    with pytest.raises(UsageError, match=r"snow cover of 0\.8, its stage one of 0: trees"):
        truth(stage, replace(shot(), environment=Environment(snow=0.8)), ["depth"])
