"""Formats, read back by their own tools or by readers written from their specifications."""

import json
import tarfile
from dataclasses import replace

import boxworld
import numpy as np
import pytest
from boxworld import BUILDING, CAR, ORDER, SOLIDS, corners, made, record_of, view
from PIL import Image

from cityx.city.camera import project
from cityx.dataset.channels import CHANNELS
from cityx.dataset.classes import CLASSES
from cityx.dataset.writers import FORMATS, formats_named, nuscenes
from cityx.dataset.writers.colmap import FARTHEST
from cityx.dataset.writers.exr import read_exr, write_exr
from cityx.dataset.writers.files import Files
from cityx.dataset.writers.format import Kept, Place, Whole
from cityx.dataset.writers.kitti import labels
from cityx.dataset.writers.poses import camera_to_world, quaternion
from cityx.errors import InputError

LEVEL = view("level", heading=0.1)
TILTED = view("tilted", (1.0, -2.0, 3.0), heading=-0.3, pitch=-0.15, frame=1, sequence="level")


def opened(path):
    with Image.open(path) as picture:
        return np.asarray(picture)


def written(name, shots, tmp_path, *, sweep=False):
    """Write shots in a format as a dataset does; the first of each moment carries the LiDAR."""
    (item,) = formats_named([name])
    files = Files(tmp_path, tmp_path / ".aside")
    kept = []
    for number, shot in enumerate(shots):
        moment = sorted({(s.sequence, s.frame) for s in shots}).index((shot.sequence, shot.frame))
        place = Place(number, moment, "town")
        first = not any(other.place.moment == moment for other in kept)
        part = item.shot(record_of(shot, sweep=sweep and first), place, CLASSES, files)
        kept.append(Kept(place, shot.name, json.loads(json.dumps(part))))
    if item.finish:
        item.finish(Whole(CLASSES, ["town"], lambda: iter(kept)), files)
    return tmp_path / name


# --- raw ------------------------------------------------------------------------------------------


def test_an_exr_loses_nothing_of_any_channel(tmp_path):
    rng = np.random.default_rng(5)
    channels = {}
    for name, channel in CHANNELS.items():
        shape = (7, 9) if channel.depth == 1 else (7, 9, channel.depth)
        if channel.dtype == "float32":
            channels[name] = rng.normal(size=shape).astype(np.float32)
        else:
            most = np.iinfo(channel.dtype).max
            channels[name] = rng.integers(0, most, shape, channel.dtype, endpoint=True)
    channels["depth"][0, 0] = np.inf
    channels["instance"][0, :2] = [0xFEDCBA9876543210, 2**64 - 1]
    write_exr(tmp_path / "all.exr", channels)
    found = read_exr(tmp_path / "all.exr")
    assert set(found) == set(CHANNELS)
    for name, values in channels.items():
        assert found[name].dtype == values.dtype
        np.testing.assert_array_equal(found[name], values)


def test_raw_files_hold_what_was_made(tmp_path):
    shot = replace(TILTED, sensor="front")
    folder = written("raw", [shot], tmp_path, sweep=True) / "town"
    record = record_of(shot, sweep=True)
    found = read_exr(folder / "tilted.exr")
    for name, values in record.channels.items():
        np.testing.assert_array_equal(found[name], values)
    said = json.loads((folder / "tilted.json").read_text())
    assert said["boxes"][-1]["id"] == "fedcba9876543210"
    assert said["sensor"] == "front"
    sweep = np.load(folder / "tilted_lidar.npy")
    np.testing.assert_array_equal(sweep["object_id"], record.sweep.object_id)
    # The points, by the pose that is told, lie where the rays met the world.
    pose = np.array(said["lidar_to_world"])
    there = np.column_stack([sweep["x"], sweep["y"], sweep["z"]]) @ pose[:3, :3].T + pose[:3, 3]
    np.testing.assert_allclose(there[sweep["object_id"] == 1][:, 2], 0.0, atol=1e-4)
    # And the pixels of the depth, by intrinsics and pose, too.
    k, pose = np.array(said["camera"]["intrinsics"]), np.array(said["camera"]["camera_to_world"])
    rows, columns = np.nonzero(found["instance"] == 1)
    rays = np.linalg.inv(k) @ np.stack([columns + 0.5, rows + 0.5, np.ones(len(rows))])
    points = pose[:3, :3] @ (rays * found["depth"][rows, columns]) + pose[:3, 3:]
    near = np.linalg.norm(points, axis=0) < 100
    np.testing.assert_allclose(points[2, near], 0.0, atol=0.01)


# --- COCO -----------------------------------------------------------------------------------------


def test_pycocotools_reads_the_masks(tmp_path):
    coco = pytest.importorskip("pycocotools.coco")
    folder = written("coco", [LEVEL, TILTED], tmp_path)
    read = coco.COCO(str(folder / "annotations" / "instances.json"))
    for number, shot in enumerate((LEVEL, TILTED), 1):
        record = record_of(shot)
        found = read.loadAnns(read.getAnnIds(imgIds=[number]))
        assert {int(a["object_id"], 16) for a in found} == set(record.boxes.object_id.tolist())
        for annotation in found:
            mask = record.channels["instance"] == int(annotation["object_id"], 16)
            np.testing.assert_array_equal(read.annToMask(annotation), mask)
            assert annotation["area"] == mask.sum()
            row = record.boxes.object_id.tolist().index(int(annotation["object_id"], 16))
            x0, y0, x1, y1 = record.boxes.seen[row]
            assert annotation["bbox"] == [x0, y0, x1 - x0, y1 - y0]
            name = read.loadCats([annotation["category_id"]])[0]["name"]
            assert name == ("car" if record.boxes.semantic[row] == CAR else "building")
    assert opened(folder / "images" / read.imgs[1]["file_name"]).shape == (120, 160, 3)


def test_the_same_detections_score_one(tmp_path):
    coco = pytest.importorskip("pycocotools.coco")
    from pycocotools.cocoeval import COCOeval

    folder = written("coco", [LEVEL, TILTED], tmp_path)
    truth = coco.COCO(str(folder / "annotations" / "instances.json"))
    keys = ("image_id", "category_id", "segmentation")
    own = [{**{k: a[k] for k in keys}, "score": 1.0} for a in truth.anns.values()]
    score = COCOeval(truth, truth.loadRes(own), "segm")
    score.evaluate()
    score.accumulate()
    score.summarize()
    assert score.stats[0] == pytest.approx(1.0)


def test_each_pixel_has_one_panoptic_segment(tmp_path):
    folder = written("coco", [LEVEL], tmp_path)
    said = json.loads((folder / "annotations" / "panoptic.json").read_text())
    (annotation,) = said["annotations"]
    colours = opened(folder / "panoptic" / annotation["file_name"]).astype(np.uint32)
    ids = colours[..., 0] + 256 * colours[..., 1] + 65536 * colours[..., 2]
    segments = {segment["id"]: segment for segment in annotation["segments_info"]}
    assert set(np.unique(ids).tolist()) == set(segments)
    assert sum(segment["area"] for segment in segments.values()) == ids.size
    classes = record_of(LEVEL).channels["semantic"]
    for number, segment in segments.items():
        assert set(classes[ids == number].tolist()) == {segment["category_id"]}
    kinds = {category["id"]: category["isthing"] for category in said["categories"]}
    assert (kinds[0], kinds[CAR], kinds[BUILDING]) == (0, 1, 1)


# --- KITTI ----------------------------------------------------------------------------------------


def read_kitti(folder, number):
    """Read as the development kit's readme says."""
    rows = (folder / "calib" / f"{number:06d}.txt").read_text().split("\n")
    calib = {
        name: np.array(values.split(), float) for name, values in
        (row.split(":") for row in rows if row)
    }  # fmt: skip
    lines = (folder / "label_2" / f"{number:06d}.txt").read_text().splitlines()
    found = []
    for line in lines:
        name, *numbers = line.split()
        found.append((name, *map(float, numbers)))
    return calib, found


def kitti_corners(label):
    """Corners of a label in the camera's axes, as the devkit's computeBox3D."""
    height, width, length, x, y, z, turn = label[8:15]
    sine, cosine = np.sin(turn), np.cos(turn)
    rotation = np.array([[cosine, 0, sine], [0, 1, 0], [-sine, 0, cosine]])
    along = length / 2 * np.array([1, 1, -1, -1, 1, 1, -1, -1])
    across = width / 2 * np.array([1, -1, -1, 1, 1, -1, -1, 1])
    up = np.array([0, 0, 0, 0, -height, -height, -height, -height])
    return (rotation @ np.array([along, up, across])).T + np.array([x, y, z])


def test_labels_of_kitti_project_onto_their_objects(tmp_path):
    folder = written("kitti", [LEVEL], tmp_path, sweep=True) / "training"
    calib, found = read_kitti(folder, 0)
    assert [label[0] for label in found] == ["Car", "Car"]
    record = record_of(LEVEL)
    cars = [row for row in range(record.boxes.count) if record.boxes.semantic[row] == CAR]
    for label, row in zip(found, cars, strict=True):
        solid = next(s for s in SOLIDS if s.object_id == int(record.boxes.object_id[row]))
        points = np.column_stack([kitti_corners(label), np.ones(8)])
        spots = calib["P2"].reshape(3, 4) @ points.T
        spots = (spots[:2] / spots[2]).T + 0.5  # from the middles of pixels to their corners
        own, _ = project(LEVEL.camera, corners(solid))
        order = np.lexsort(np.round(spots, 1).T), np.lexsort(np.round(own, 1).T)
        np.testing.assert_allclose(spots[order[0]], own[order[1]], atol=0.02)
        alpha, turn, x, z = label[3], label[14], label[11], label[13]
        assert np.cos(alpha - (turn - np.arctan2(x, z))) == pytest.approx(1.0, abs=1e-4)
        x0, y0, x1, y1 = record.boxes.full[row]
        np.testing.assert_allclose(label[4:8], [x0, y0, x1 - 1, y1 - 1], atol=1e-4)


def test_the_turn_of_a_box_is_kittis(tmp_path):
    del tmp_path
    north = view("north")
    record = record_of(north)
    row = 0
    east = replace(record.boxes, heading=np.zeros(record.boxes.count))
    away = replace(record.boxes, heading=np.full(record.boxes.count, np.pi / 2))
    turns = [
        float(next(labels(north.camera, boxes, CLASSES)).split()[14]) for boxes in (east, away)
    ]
    assert turns[row] == pytest.approx(0.0, abs=1e-4)  # along x, to the right
    assert turns[1] == pytest.approx(-np.pi / 2, abs=1e-4)  # away from the camera


def test_kittis_points_fall_onto_their_pixels(tmp_path):
    folder = written("kitti", [LEVEL], tmp_path, sweep=True) / "training"
    calib, _ = read_kitti(folder, 0)
    points = np.fromfile(folder / "velodyne" / "000000.bin", np.float32).reshape(-1, 4)
    sweep = record_of(LEVEL, sweep=True).sweep
    np.testing.assert_array_equal(points[:, :3], sweep.points)
    rotation = np.eye(4)
    rotation[:3, :3] = calib["R0_rect"].reshape(3, 3)
    velodyne = np.vstack([calib["Tr_velo_to_cam"].reshape(3, 4), [0, 0, 0, 1]])
    found = calib["P2"].reshape(3, 4) @ rotation @ velodyne @ np.column_stack(
        [points[:, :3], np.ones(len(points))]
    ).T  # fmt: skip
    pixels = np.rint(found[:2] / found[2]).astype(int)  # middles are whole numbers
    depth = record_of(LEVEL).channels["depth"]
    inside = (pixels[0] >= 0) & (pixels[0] < 160) & (pixels[1] >= 0) & (pixels[1] < 120)
    assert inside.sum() > 100
    instance = record_of(LEVEL).channels["instance"][pixels[1, inside], pixels[0, inside]]
    agree = instance == sweep.object_id[inside]
    assert agree.mean() > 0.9  # at edges the pixel's middle sees something else
    there = depth[pixels[1, inside], pixels[0, inside]][agree & (sweep.object_id[inside] != 1)]
    np.testing.assert_allclose(found[2, inside][agree & (sweep.object_id[inside] != 1)], there,
                               rtol=0.05)  # fmt: skip


def test_a_stereo_pair_has_its_baseline(tmp_path):
    left = view("a_left", (-0.27, 0.0, 1.6), sensor="left", sequence="a")
    right = view("a_right", (0.27, 0.0, 1.6), sensor="right", sequence="a")
    folder = written("kitti", [left, right], tmp_path) / "training"
    calib, _ = read_kitti(folder, 0)
    p2, p3 = calib["P2"].reshape(3, 4), calib["P3"].reshape(3, 4)
    assert (p2[0, 3] - p3[0, 3]) / p2[0, 0] == pytest.approx(0.54)
    assert (folder / "image_3" / "000000.png").is_file()


# --- NeRF and COLMAP ------------------------------------------------------------------------------


def test_nerfs_cameras_look_along_minus_z(tmp_path):
    folder = written("nerf", [LEVEL, TILTED], tmp_path) / "town"
    said = json.loads((folder / "transforms.json").read_text())
    for shot, frame in zip((LEVEL, TILTED), said["frames"], strict=True):
        pose = np.array(frame["transform_matrix"])
        assert np.linalg.det(pose[:3, :3]) == pytest.approx(1.0)
        points = corners(SOLIDS[0])
        x, y, z = np.linalg.inv(pose)[:3] @ np.column_stack([points, np.ones(8)]).T
        assert (z < 0).all()
        seen = [said["fl_x"] * x / -z + said["cx"], -said["fl_y"] * y / -z + said["cy"]]
        np.testing.assert_allclose(np.transpose(seen), project(shot.camera, points)[0], atol=1e-6)
        assert opened(folder / frame["file_path"]).shape[:2] == (said["h"], said["w"])
    focal = said["w"] / 2 / np.tan(said["camera_angle_x"] / 2)
    assert focal == pytest.approx(said["fl_x"])


def turn_of(w, x, y, z):
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ])  # fmt: skip


def read_colmap(folder):
    """Read the text model as https://colmap.github.io/format.html says."""

    def lines(name):
        text = (folder / "sparse" / "0" / name).read_text().splitlines()
        return [line for line in text if not line.startswith("#")]

    cameras = {int(c[0]): (c[1], *map(float, c[2:])) for c in map(str.split, lines("cameras.txt"))}
    rows = lines("images.txt")
    images = {}
    for head, spots in zip(rows[::2], rows[1::2], strict=True):
        number, *pose, camera, name = head.split()
        observed = np.array(spots.split(), float).reshape(-1, 3)
        images[int(number)] = (np.array(pose, float), int(camera), name, observed)
    points = {int(p[0]): np.array(p[1:], float) for p in map(str.split, lines("points3D.txt"))}
    return cameras, images, points


def test_colmaps_points_are_seen_where_it_is_said(tmp_path):
    folder = written("colmap", [LEVEL, TILTED], tmp_path) / "town"
    cameras, images, points = read_colmap(folder)
    assert len(points) > 100
    for number, (pose, camera, name, observed) in images.items():
        model, width, height, fx, fy, cx, cy = cameras[camera]
        assert (model, width, height) == ("PINHOLE", 160, 120)
        spots = np.array([points[int(row)][:3] for row in observed[:, 2]])
        local = spots @ turn_of(*pose[:4]).T + pose[4:]
        assert (local[:, 2] > 0).all()
        assert (local[:, 2] < FARTHEST).all()
        seen = np.column_stack([
            fx * local[:, 0] / local[:, 2] + cx, fy * local[:, 1] / local[:, 2] + cy
        ])  # fmt: skip
        np.testing.assert_allclose(seen, observed[:, :2], atol=0.02)
        assert all(points[int(row)][7] == number for row in observed[:, 2])
        picture = opened(folder / "images" / name)
        colours = [points[int(row)][3:6] for row in observed[:, 2]]
        pixels = observed[:, :2].astype(int)
        np.testing.assert_array_equal(picture[pixels[:, 1], pixels[:, 0]], colours)


# --- nuScenes -------------------------------------------------------------------------------------


def tables(folder):
    found = {}
    for path in (folder / "v1.0-cityx").glob("*.json"):
        rows = json.loads(path.read_text())
        found[path.stem] = {row["token"]: row for row in rows}
        assert len(found[path.stem]) == len(rows)
    return found


def rig(number, y):
    return [
        view(f"s_{number}_{sensor}", (x, y, 1.6), heading, size=(160, 120), sensor=sensor,
             sequence="s", frame=number, moment=0.5 * number)
        for sensor, x, heading in (("front", 0.0, 0.0), ("front_left", -0.4, -0.6))
    ]  # fmt: skip


def test_the_tables_of_nuscenes_point_at_each_other(tmp_path):
    folder = written("nuscenes", [*rig(0, 0.0), *rig(1, 1.0)], tmp_path, sweep=True)
    held = tables(folder)
    links = {
        "sample": {"scene_token": "scene", "prev": "sample", "next": "sample"},
        "sample_data": {"sample_token": "sample", "ego_pose_token": "ego_pose", "prev":
                        "sample_data", "calibrated_sensor_token": "calibrated_sensor"},
        "calibrated_sensor": {"sensor_token": "sensor"},
        "scene": {"log_token": "log", "first_sample_token": "sample"},
        "sample_annotation": {"sample_token": "sample", "instance_token": "instance",
                              "visibility_token": "visibility", "next": "sample_annotation"},
        "instance": {"category_token": "category", "first_annotation_token": "sample_annotation",
                     "last_annotation_token": "sample_annotation"},
    }  # fmt: skip
    for table, columns in links.items():
        for row in held[table].values():
            for column, other in columns.items():
                assert row[column] == "" or row[column] in held[other], (table, column)
    assert len(held["sample"]) == 2
    assert all((folder / row["filename"]).is_file() for row in held["sample_data"].values())
    for row in held["instance"].values():
        assert row["nbr_annotations"] == 2
        last = held["sample_annotation"][row["last_annotation_token"]]
        assert last["prev"] == row["first_annotation_token"]
    # The sensors sit on the car the same way at both moments.
    assert len(held["calibrated_sensor"]) == len(held["sensor"]) == 3


def test_nuscenes_boxes_project_onto_their_objects(tmp_path):
    shots = rig(0, 0.0)
    folder = written("nuscenes", shots, tmp_path, sweep=True)
    held = tables(folder)
    ids = {row["token"]: int(row["object_id"], 16) for row in held["instance"].values()}
    annotations = list(held["sample_annotation"].values())
    assert set(ids.values()) == {solid.object_id for solid in SOLIDS}
    for data in held["sample_data"].values():
        sensor = held["calibrated_sensor"][data["calibrated_sensor_token"]]
        ego = held["ego_pose"][data["ego_pose_token"]]
        channel = held["sensor"][sensor["sensor_token"]]["channel"]
        for annotation in annotations:
            solid = next(s for s in SOLIDS if s.object_id == ids[annotation["instance_token"]])
            width, length, height = annotation["size"]
            signs = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) / 2
            box = signs * [length, width, height] @ turn_of(*annotation["rotation"]).T
            points = box + annotation["translation"]
            np.testing.assert_allclose(points, corners(solid), atol=1e-6)
            if channel == "LIDAR_TOP":
                continue
            points = (points - ego["translation"]) @ turn_of(*ego["rotation"])
            points = (points - sensor["translation"]) @ turn_of(*sensor["rotation"])
            seen = np.array(sensor["camera_intrinsic"]) @ points.T
            shot = next(s for s in shots if f"__{s.name}.png" in data["filename"])
            own, depth = project(shot.camera, corners(solid))
            if (depth > 0).all():
                np.testing.assert_allclose((seen[:2] / seen[2]).T + 0.5, own, atol=1e-3)


def test_nuscenes_points_lie_on_the_ground(tmp_path):
    folder = written("nuscenes", rig(0, 0.0)[:1], tmp_path, sweep=True)
    held = tables(folder)
    (data,) = [row for row in held["sample_data"].values() if row["fileformat"] == "pcd"]
    points = np.fromfile(folder / data["filename"], np.float32).reshape(-1, 5)[:, :3]
    sensor = held["calibrated_sensor"][data["calibrated_sensor_token"]]
    ego = held["ego_pose"][data["ego_pose_token"]]
    assert points[:, 1].min() > 0  # y is ahead
    there = points @ turn_of(*sensor["rotation"]).T + sensor["translation"]
    there = there @ turn_of(*ego["rotation"]).T + ego["translation"]
    ground = record_of(rig(0, 0.0)[0], sweep=True).sweep.object_id == 1
    np.testing.assert_allclose(there[ground][:, 2], 0.0, atol=1e-3)


def test_tokens_follow_from_identity():
    assert nuscenes.token("a", 1) == nuscenes.token("a", 1) != nuscenes.token("a", 2)
    assert len(nuscenes.token("a")) == 32


# --- WebDataset -----------------------------------------------------------------------------------


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")  # webdataset's own
def test_webdataset_reads_the_shards(tmp_path):
    wds = pytest.importorskip("webdataset")
    out = tmp_path / "out"
    made(out, replace(ORDER, formats=("webdataset",), views=4))
    shards = sorted(map(str, (out / "webdataset").glob("*.tar")))
    samples = list(wds.WebDataset(shards, shardshuffle=False).decode("rgb8"))
    assert len(samples) == 4
    for number, sample in enumerate(samples):
        shot = boxworld.plan_world(None, replace(ORDER, views=4))[number]
        record = record_of(shot)
        for name in ("depth", "semantic", "instance", "panoptic"):
            np.testing.assert_array_equal(sample[f"{name}.npy"], record.channels[name])
        assert sample["json"]["shot"] == shot.name
        assert sample["rgb.png"].shape == (120, 160, 3)


def test_shards_know_no_owner_and_no_time(tmp_path):
    out = tmp_path / "out"
    made(out, replace(ORDER, formats=("webdataset",), views=2))
    with tarfile.open(out / "webdataset" / "000000.tar") as tar:
        assert {(m.mtime, m.uid, m.gid, m.uname, m.mode) for m in tar} == {(0, 0, 0, "", 0o644)}


# --- all ------------------------------------------------------------------------------------------


def test_unknown_formats_are_named_with_the_nearest():
    with pytest.raises(InputError, match=r'there is no format "koko"\. Did you mean "coco"\?'):
        formats_named(["raw", "koko"])
    assert [item.name for item in formats_named(FORMATS)] == list(FORMATS)


def test_quaternions_turn_as_their_matrices():
    matrix = camera_to_world(TILTED.camera)[:3, :3]
    np.testing.assert_allclose(turn_of(*quaternion(matrix)), matrix, atol=1e-12)


def test_a_file_that_fails_leaves_nothing(tmp_path):
    files = Files(tmp_path / "out", tmp_path / "aside")

    def write():
        with files.file("a.txt") as path:
            path.write_text("half")
            raise KeyError

    with pytest.raises(KeyError):
        write()
    assert files.written == []
    assert [p for p in tmp_path.rglob("*") if p.is_file()] == []
