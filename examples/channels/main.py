"""Show all channels of one street view side by side.

    python examples/channels/main.py [-o docs/channels.png] [--samples 96] [--work DIR]

The street is the one of `examples/traffic`, with its traffic and people. Truth comes from rays,
light from Cycles; both look through the same pinhole at the same moment.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import colours
import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from cityx.city.store import View, read_view
from cityx.dataset.channels import CHANNELS
from cityx.dataset.lidar import lidar_named, sensor_axes, sweep_of
from cityx.dataset.pictures import QUALITIES, pictures
from cityx.dataset.record import Record
from cityx.dataset.shots import Shot
from cityx.dataset.stage import Stage, stage_of
from cityx.dataset.truth import truth

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "examples" / "traffic"))
import main as traffic  # noqa: E402  the street with its traffic

CELL, COLUMNS, GAP, LABEL = (480, 288), 4, 4, 22
SAMPLES = 96
STEP, SECONDS = 0.6, 0.1  # metres and seconds to the next frame: a car at 6 m/s
FARTHEST = 200.0  # metres, end of the scale of depth
LIDAR = "spinning_64"
BEHIND, ABOVE, TILT = 9.0, 7.0, np.radians(-24.0)  # where the points of the LiDAR are seen from
LEAST = 25  # pixels of a thing whose box is drawn
FONT = 15


def city_of(folder: Path) -> Path:
    """Return the store of the street, built where it is not."""
    if not (folder / "street" / "city").is_dir():
        traffic.peopled(folder)
    return folder / "street" / "city"


def shots_of() -> tuple[Shot, Shot]:
    """Return the frame that is shown and the next one of the drive."""
    width, height = CELL
    eye = replace(traffic.camera("street"), name="channels", width=width, height=height)
    x, y, z = eye.position
    moved = (x + STEP * float(np.sin(eye.heading)), y + STEP * float(np.cos(eye.heading)), z)
    return (
        Shot("channels_0", eye, "channels", 0, moment=traffic.MOMENT),
        Shot("channels_1", replace(eye, position=moved), "channels", 1,
             moment=traffic.MOMENT + SECONDS),
    )  # fmt: skip


def made(store: Path, samples: int) -> tuple[Stage, Record, Record]:
    """Make all channels of the first frame; returns the stage, truth and pictures."""
    view: View = read_view(store)
    shot, after = shots_of()
    stage = stage_of(view, shot.moment)
    later = stage_of(view, after.moment, still=stage)
    known = truth(stage, shot, ["truth"], after=after, later=later, boxes=True)
    quality = replace(QUALITIES["standard"], samples=samples)
    (light,) = pictures(store, [shot], CHANNELS, quality)
    return stage, known, light


def panels(stage: Stage, known: Record, light: Record) -> Mapping[str, NDArray[np.uint8]]:
    """Return what each channel looks like, by its title."""
    t: Mapping[str, NDArray[Any]] = known.channels
    c: Mapping[str, NDArray[Any]] = light.channels
    camera = known.shot.camera
    stop = light.facts["exposure"]
    flow, motion = t["flow"], np.linalg.norm(t["motion"], axis=-1)
    fastest = float(np.percentile(np.linalg.norm(flow, axis=-1), 99))
    moving = np.where(np.isfinite(t["depth"]), motion, np.inf)
    share = np.repeat(np.clip(c["ao"], 0, 1)[..., None], 3, axis=-1)
    assert known.boxes is not None
    return {
        "rgb (as a screen shows it)": c["picture"],
        f"depth (2 to {FARTHEST:.0f} m)": colours.scaled(t["depth"], 2.0, FARTHEST, log=True),
        f"distance (2 to {FARTHEST:.0f} m)": colours.scaled(t["distance"], 2.0, FARTHEST, log=True),
        "normal (east, north, up)": colours.directions(t["normal"]),
        "position (repeats after 10 m)": colours.tiles(t["position"], 5.0),
        "semantic (class)": colours.classes(t["semantic"]),
        "instance (id)": colours.hashed(t["instance"]),
        "panoptic (segment)": colours.hashed(t["panoptic"].astype(np.uint64)),
        "material": colours.hashed(t["material"].astype(np.uint64)),
        f"flow (to {fastest:.0f} px)": colours.wheel(flow, fastest),
        "motion (0.01 to 1 m in 0.1 s)": colours.scaled(moving, 0.01, 1.0, log=True),
        "diffuse": colours.shown(c["diffuse"], 1.0),
        "ambient occlusion": (share * 255).astype(np.uint8),
        "glossy direct": colours.shown(c["glossy_direct"], stop - 1),
        "glossy indirect": colours.shown(c["glossy_indirect"], stop),
        "glossy colour": colours.shown(c["glossy_colour"], 2.0),
        "cryptomatte object": colours.matted(c["crypto_object"]),
        "cryptomatte material": colours.matted(c["crypto_material"]),
        "boxes (2D and 3D)": colours.with_boxes(c["picture"], camera, known.boxes, LEAST),
        f"LiDAR ({LIDAR}, by class)": swept(stage, known.shot),
    }


def swept(stage: Stage, shot: Shot) -> NDArray[np.uint8]:
    """Show the points of a sweep from behind and above the sensor."""
    eye = shot.camera
    level = replace(shot, camera=replace(eye, pitch=0.0))
    sweep = sweep_of(stage, level, lidar_named(LIDAR))
    x, y, z = eye.position
    back = (x - BEHIND * float(np.sin(eye.heading)), y - BEHIND * float(np.cos(eye.heading)),
            z + ABOVE)  # fmt: skip
    above = replace(eye, position=back, pitch=float(TILT), hfov=float(np.radians(75.0)))
    return colours.points(sweep, above, sensor_axes(level.camera), np.array(eye.position))


def sheet(cells: Mapping[str, NDArray[np.uint8]]) -> Image.Image:
    """Put the panels in rows, each under its title."""
    width, height = CELL
    rows = -(-len(cells) // COLUMNS)
    size = (COLUMNS * (width + GAP) - GAP, rows * (height + LABEL + GAP) - GAP)
    page = Image.new("RGB", size, "white")
    draw, font = ImageDraw.Draw(page), ImageFont.load_default(FONT)
    for index, (title, picture) in enumerate(cells.items()):
        row, column = divmod(index, COLUMNS)
        left, top = column * (width + GAP), row * (height + LABEL + GAP)
        draw.text((left + 4, top + 2), title, "black", font)
        page.paste(Image.fromarray(picture), (left, top + LABEL))
    return page


def main() -> None:
    """Make the sheet."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-o", "--out", type=Path, default=ROOT / "docs" / "channels.png")
    parser.add_argument("--samples", type=int, default=SAMPLES)
    parser.add_argument("--work", type=Path, default=None)
    options = parser.parse_args()
    work = options.work or Path(tempfile.mkdtemp(prefix="cityx-channels-"))
    stage, known, light = made(city_of(work), options.samples)
    facts = {key: light.facts[key] for key in ("samples_used", "noise", "seconds")}
    print(", ".join(f"{key} {value}" for key, value in facts.items()))
    sheet(panels(stage, known, light)).save(options.out, optimize=True)
    print(options.out)


if __name__ == "__main__":
    main()
