"""Render every species of tree through the year and at every distance, and put it on one sheet.

    python examples/trees/main.py [-o docs/trees.png] [--only NAME ...] [--samples 24]

Each strip shows one species: spring, summer (a street tree where the species is one, with every
leaf drawn), autumn and winter near the viewer, then the light and the far form in summer. A person
stands in front for the scale.
"""

from __future__ import annotations

import argparse
import math
import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from cityx.assets.people.people import person
from cityx.assets.trees import SPECIES, individuals, plant, size_of
from cityx.blender.client import BlenderJob, RenderRequest, run_worker
from cityx.city import City, Instances, Scene
from cityx.city.camera import Camera
from cityx.city.frame import Frame
from cityx.city.layout import Layout
from cityx.city.mesh import concatenate, one_mesh
from cityx.city.scene import Prototype
from cityx.city.store import write_city
from cityx.ids import stable_id
from cityx.light.sun import sun
from cityx.projects.views import TIMEOUT_S

NAMES = (*SPECIES, "palm", "shrub", "boxwood")
STRIP = (960, 190)  # pixels of one species
TITLE, GAP, COLUMNS = 18, 4, 2
TOGETHER = 3  # species in one Blender scene; every picture costs the setup of all its trees
APART = 600.0  # metres between strips, along a diagonal, so that none stands behind another
FRAME = Frame(51.5, 8.0)
# Season, form and whether it grew in a street, from left to right.
SHOWN = (("spring", "near", False), ("summer", "near", False), ("summer", "fine", True),
         ("autumn", "near", False), ("winter", "near", False), ("summer", "light", False),
         ("summer", "far", False))  # fmt: skip


def shown(name: str) -> list[Prototype]:
    """Return the plants of one strip, another individual each where there is one."""
    found = []
    for number, (season, form, street) in enumerate(SHOWN):
        first, count = individuals(name, street=street)
        found.append(plant(name, first + number % count, form, season))
    return found


def strip_city(names: Sequence[str]) -> tuple[City, list[Camera]]:
    """Make a city of strips, one species each, and the cameras that look at them."""
    prototypes: list[Prototype] = []
    rows, cameras, grounds = [], [], []
    for number, name in enumerate(names):
        height, radius, _ = size_of(name)
        step = max(2.5 * radius, 0.82 * height)
        wide = step * len(SHOWN)
        origin = np.array([number * APART, number * APART, 0.0])
        corners = np.array([[-200, -150, 0], [200, -150, 0], [200, 250, 0], [-200, 250, 0]])
        grounds.append(one_mesh(number + 1, corners + origin, [[0, 1, 2, 3]], materials=("grass",),
                                uv=[corners[:, :2]]))  # fmt: skip
        plants = shown(name)
        at = (np.arange(len(plants)) - (len(plants) - 1) / 2) * step
        for made, x in zip([*plants, person(3)], [*at, at[1] + 0.5 * step], strict=True):
            forward = -0.6 * radius if made.kind == "person" else 0.0
            rows.append((len(prototypes), (origin[0] + x, origin[1] + forward, 0.0)))
            prototypes.append(made)
        fov = math.radians(24)
        back = 0.5 * wide / math.tan(fov / 2)
        rise = 0.5 * wide * STRIP[1] / STRIP[0]  # metres shown above the axis
        eye = (float(origin[0]), float(origin[1] - back), 0.93 * rise)
        cameras.append(Camera(f"strip_{name}", eye, 0.0, 0.0, fov, *STRIP))
    unique = {made.name: made for made in prototypes}
    number_of = {name: i for i, name in enumerate(unique)}
    index = np.array([number_of[prototypes[i].name] for i, _ in rows], np.int32)
    count = len(rows)
    table = Instances(
        index, np.array([stable_id("strip", i) for i in range(count)], np.uint64),
        np.zeros(count, np.uint64), np.array([at for _, at in rows]),
        np.zeros((count, 3), np.float32), np.ones((count, 3), np.float32),
        np.ones((count, 3), np.float32),
    )  # fmt: skip
    scene = Scene().with_mesh("ground", concatenate(grounds))
    scene = scene.with_instances("trees", unique.values(), table)
    far = APART * len(names)
    city = City("Trees", FRAME, Layout((-300.0, -300.0, far, far)), lod=3, scene=scene)
    return sun(city, time="15:00"), cameras


def render(names: Sequence[str], folder: Path, samples: int) -> list[Path]:
    """Render the strips of a few species."""
    city, cameras = strip_city(names)
    store = folder / "city"
    write_city(city, store)
    requests = tuple(RenderRequest(each, folder / f"{each.name}.png", samples) for each in cameras)
    run_worker(BlenderJob(store, renders=requests), timeout_s=TIMEOUT_S,
               progress=lambda _, text: print(text, flush=True))  # fmt: skip
    return [request.path for request in requests]


def compose(names: Sequence[str], paths: Sequence[Path], out: Path) -> None:
    """Write the sheet, strips side by side in columns."""
    lines = -(-len(names) // COLUMNS)
    width, height = STRIP
    sheet = Image.new("RGB", (COLUMNS * (width + GAP), lines * (height + TITLE + GAP)), "white")
    draw = ImageDraw.Draw(sheet)
    font = ImageFont.load_default(size=14)
    for number, (name, path) in enumerate(zip(names, paths, strict=True)):
        left = (number // lines) * (width + GAP)
        top = (number % lines) * (height + TITLE + GAP)
        tall = size_of(name)[0]
        draw.text((left + 4, top + 1), f"{name}, {tall:g} m", fill="black", font=font)
        with Image.open(path) as picture:
            sheet.paste(picture.convert("RGB"), (left, top + TITLE))
    out.parent.mkdir(parents=True, exist_ok=True)
    sheet.quantize(256).save(out, optimize=True)


def main() -> None:
    """Grow, render and compose."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-o", "--out", type=Path, default=Path("docs/trees.png"))
    parser.add_argument("--only", nargs="*", choices=NAMES, default=list(NAMES))
    parser.add_argument("--samples", type=int, default=24)
    parser.add_argument("--work", type=Path, help="folder to keep the pictures in")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        work = options.work or Path(scratch)
        paths: list[Path] = []
        for first in range(0, len(options.only), TOGETHER):
            paths += render(options.only[first : first + TOGETHER], work / str(first),
                            options.samples)  # fmt: skip
        compose(options.only, paths, options.out)
    print(options.out)


if __name__ == "__main__":
    main()
