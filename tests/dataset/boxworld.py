"""A world of three boxes on a plane, whose pictures are known by arithmetic.

Stands for a city where only the making of datasets is looked at; run as a program it makes one.
"""

import os
import sys
import time
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from cityx.city.camera import Camera, project, rays
from cityx.dataset.makers import SECONDS
from cityx.dataset.making import Hands, Running, make_dataset
from cityx.dataset.order import FOLDER, Order, Source
from cityx.dataset.record import Boxes, Record, Segment, Sweep
from cityx.dataset.shots import Shot

ROAD, BUILDING, CAR = 2, 23, 66  # checked against the table by `test_numbers_are_of_the_table`


@dataclass(frozen=True)
class Solid:
    object_id: int
    semantic: int
    centre: tuple
    size: tuple
    heading: float
    colour: tuple


SOLIDS = (
    Solid(0xFEDCBA9876543210, CAR, (2.0, 14.0, 0.75), (4.5, 1.8, 1.5), 0.6, (0.8, 0.1, 0.1)),
    Solid(0x0000000000000007, CAR, (-3.0, 22.0, 0.75), (4.5, 1.8, 1.5), -2.0, (0.1, 0.2, 0.8)),
    Solid(0x8000000000000001, BUILDING, (6.0, 40.0, 6.0), (10.0, 8.0, 12.0), 0.2, (0.6, 0.6, 0.5)),
)


def turned(solid):
    sine, cosine = np.sin(solid.heading), np.cos(solid.heading)
    return np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])


def corners(solid):
    signs = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) / 2
    return signs * np.array(solid.size) @ turned(solid).T + np.array(solid.centre)


def cast(origin, directions, solids=SOLIDS):
    """Return distance and number of what rays meet: 0 nothing, 1 the plane, 2... the solids."""
    with np.errstate(divide="ignore", invalid="ignore"):
        down = -origin[2] / directions[:, 2]
    found = np.where(down > 0, down, np.inf)
    what = np.where(down > 0, 1, 0)
    for number, solid in enumerate(solids, 2):
        frame = turned(solid)
        eye = (origin - np.array(solid.centre)) @ frame
        way = directions @ frame
        with np.errstate(divide="ignore", invalid="ignore"):
            one = (-np.array(solid.size) / 2 - eye) / way
            two = (np.array(solid.size) / 2 - eye) / way
        near = np.minimum(one, two).max(axis=1)
        far = np.maximum(one, two).min(axis=1)
        hit = (near < far) & (near > 0) & (near < found)
        found = np.where(hit, near, found)
        what = np.where(hit, number, what)
    return found, what


def record_of(shot, *, sweep=False, boxes=True):
    camera = shot.camera
    eye = np.array(camera.position)
    directions = rays(camera).reshape(-1, 3)
    depth, what = cast(eye, directions)
    shape = (camera.height, camera.width)
    ids = np.array([0, 1, *(s.object_id for s in SOLIDS)], np.uint64)
    classes = np.array([0, ROAD, *(s.semantic for s in SOLIDS)], np.uint8)
    colours = np.array([(0.5, 0.7, 0.9), (0.3, 0.3, 0.3), *(s.colour for s in SOLIDS)], np.float32)
    present = np.unique(what)
    numbers = np.searchsorted(present, what).astype(np.uint32) + 1
    segments = tuple(
        Segment(row + 1, int(ids[w]) if w > 1 else 0, int(classes[w]), int((what == w).sum()))
        for row, w in enumerate(present.tolist())
    )
    channels = {
        "rgb": colours[what].reshape(*shape, 3),
        "depth": depth.astype(np.float32).reshape(shape),
        "semantic": classes[what].reshape(shape),
        "instance": ids[what].reshape(shape),
        "panoptic": numbers.reshape(shape),
    }
    found = Record(shot, channels, segments, facts={SECONDS: {"truth": 0.001}})
    if boxes:
        found = replace(found, boxes=boxes_of(shot, what.reshape(shape)))
    return replace(found, sweep=sweep_of(shot)) if sweep else found


def boxes_of(shot, what):
    camera = shot.camera
    rows = []
    for number, solid in sorted(enumerate(SOLIDS, 2), key=lambda pair: pair[1].object_id):
        mask = what == number
        if not mask.any():
            continue
        y, x = np.nonzero(mask)
        seen = (x.min(), y.min(), x.max() + 1, y.max() + 1)
        spots, depth = project(camera, corners(solid))
        assert (depth > 0).all()
        low, high = spots.min(axis=0), spots.max(axis=0)
        full = np.clip([*low, *high], 0, [camera.width, camera.height] * 2)
        _, alone = cast(np.array(camera.position), rays(camera).reshape(-1, 3), (solid,))
        whole = np.prod(high - low)
        cut = 1 - np.prod(full[2:] - full[:2]) / whole
        rows.append((solid, seen, full, mask.sum() / (alone == 2).sum(), cut, mask.sum()))
    return Boxes(
        np.array([r[0].object_id for r in rows], np.uint64),
        np.array([r[0].semantic for r in rows], np.uint8),
        np.array([r[0].centre for r in rows], float).reshape(-1, 3),
        np.array([r[0].size for r in rows], float).reshape(-1, 3),
        np.array([r[0].heading for r in rows], float),
        np.array([r[1] for r in rows], float).reshape(-1, 4),
        np.array([r[2] for r in rows], float).reshape(-1, 4),
        np.array([r[3] for r in rows], np.float32),
        np.array([r[4] for r in rows], np.float32),
        np.array([r[5] for r in rows], np.int64),
    )


def sweep_of(shot):
    from cityx.dataset.lidar import sensor_axes

    azimuth, elevation = np.meshgrid(np.linspace(-0.6, 0.6, 60), np.linspace(-0.2, 0.1, 8))
    azimuth, elevation = azimuth.ravel(), elevation.ravel()
    local = np.column_stack([
        np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)
    ])  # fmt: skip
    distance, what = cast(np.array(shot.camera.position), local @ sensor_axes(shot.camera))
    met = np.isfinite(distance)
    ids = np.array([0, 1, *(s.object_id for s in SOLIDS)], np.uint64)
    classes = np.array([0, ROAD, *(s.semantic for s in SOLIDS)], np.uint8)
    return Sweep(
        (local[met] * distance[met, None]).astype(np.float32),
        np.repeat(np.arange(8, dtype=np.uint16), 60)[met],
        np.linspace(0, 0.1, 480, dtype=np.float32)[met],
        ids[what[met]],
        classes[what[met]],
        np.full(met.sum(), 0.5, np.float32),
    )


def view(name, position=(0.0, 0.0, 1.6), heading=0.0, pitch=0.0, size=(160, 120), **more):
    sequence = more.pop("sequence", name)
    return Shot(name, Camera(name, position, heading, pitch, 1.2, *size), sequence, **more)


# --- a dataset of it ------------------------------------------------------------------------------


def open_world(source, store):
    return source, store


def plan_world(site, order):
    """Drive ahead in sequences of five frames, with the rig asked for."""
    del site
    sensors = {"mono": (0.0,), "stereo": (-0.06, 0.06)}[order.rig]
    names = {"mono": ("mono",), "stereo": ("left", "right")}[order.rig]
    shots = []
    for number in range(order.views):
        sequence, frame = f"drive_{number // 5:04d}", number % 5
        for sensor, aside in zip(names, sensors, strict=True):
            shots.append(view(
                f"{sequence}_{frame:04d}_{sensor}", (aside, 0.2 * number, 1.6), 0.0, 0.0,
                order.size, sequence=sequence, frame=frame, sensor=sensor, moment=0.1 * frame,
            ))  # fmt: skip
    return tuple(shots)


def tell_world(site, shots, order, files):
    del order
    from cityx.dataset.cities import SHOTS, _line

    name = site[0].name
    files.json(f"cities/{name}/city.json", {
        "name": name, "city": "boxes", "seed": 0, "lod": 0, "extent": [-50, -50, 50, 50],
        "attribution": ["made for tests"], "streets": [[6.0, 0.0, -50.0, 0.0, 50.0]],
    })  # fmt: skip
    files.text(f"cities/{name}/{SHOTS}", "".join(map(_line, shots)))


def shoot_world(store, order, threads):
    del store, threads

    def shoot(wanted):
        for item in wanted:
            time.sleep(PAUSE)
            yield record_of(item.shot, sweep=item.sweep, boxes=order.wants_boxes)

    return shoot


PAUSE = float(os.environ.get("BOXWORLD_PAUSE", "0"))  # seconds a shot, so that kills meet some
HANDS = Hands(open_world, plan_world, tell_world, shoot_world)
ORDER = Order(
    views=20, size=(160, 120), channels=("rgb", "depth", "semantic", "instance", "panoptic"),
    formats=("raw", "coco", "kitti", "webdataset"), lidar="spinning_16",
)  # fmt: skip


class Quiet:
    def __init__(self):
        self.lines = []

    def say(self, line):
        self.lines.append(line)

    def shots(self, done, total, rate):
        del rate
        self.lines.append(f"{done} of {total}")


def world(folder, name="boxes"):
    """Make what passes for the folder of a built city."""
    (folder / name / "city").mkdir(parents=True, exist_ok=True)
    (folder / name / "city" / "city.json").write_text("{}")
    (folder / name / "report.json").write_text('{"hash": "0"}')
    return Source(name, FOLDER, folder / name)


def made(out, order=ORDER, *, sources=None, progress=None, **running):
    sources = sources or [world(Path(out).parent)]
    how = Running(**{"hands": HANDS, **running})
    return make_dataset(order, sources, Path(out), how, progress or Quiet())


if __name__ == "__main__":
    made(sys.argv[1], workers=2)
