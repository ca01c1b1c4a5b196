"""Render every building generator on plots of its own and put the pictures on one sheet.

    python examples/buildings/main.py [-o docs/buildings.png] [--only NAME ...] [--samples 24]

Each row shows one generator with three seeds; the last row shows three streets made of them.
"""

from __future__ import annotations

import argparse
import itertools
import math
import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import streets
from PIL import Image, ImageDraw, ImageFont

from cityx.blender.client import BlenderJob, RenderRequest, run_worker
from cityx.building.catalogue import NAMES, generators
from cityx.building.design import design
from cityx.building.facade.facade import facade
from cityx.building.samples import Sample, sample_city, sheet_of
from cityx.building.shell import shell
from cityx.city.camera import Camera
from cityx.city.city import City
from cityx.city.store import write_city
from cityx.light.sun import sun
from cityx.light.weather import weather
from cityx.projects.views import TIMEOUT_S
from cityx.protocol import registry
from cityx.protocol.gate import Call
from cityx.protocol.running import run_step
from cityx.road.ground.ground_surface import ground
from cityx.road.network.network import network

SEEDS = (1, 2, 3)
TIME = "15:30"  # the sun stands before the fronts, to the left: sides lie in the shade
CELL = (300, 225)  # pixels of one picture
GAP, TITLE, COLUMNS = 6, 20, 2
STEP = 5  # between the levels of a colour that are kept, of 255
FOV = math.radians(46)
EYE = 1.7  # metres
FILL = 0.9  # share of the picture that a building fills
ROUND = math.radians(32)  # the camera stands this far off the axis of the front
# What streets have besides houses.
FURNISHING = (
    "road/heights-v1", "road/lanes-v1", "road/surface_material-v1", "nature/trees-v2",
    "nature/barriers-v1", "nature/furniture-v1", "nature/street_pieces-v1", "nature/gardens-v1",
    "road/covers-v1", "road/parked_cars-v1",
)  # fmt: skip


def built(city: City, *, time: str = TIME) -> City:
    """Run the actions that make a city of samples."""
    city = ground(network(weather(sun(city, time=time), preset="clear")))
    return facade(shell(design(city)))


def furnished(city: City) -> City:
    """Run the actions that make a street of it."""
    for action in FURNISHING:
        city = run_step(city, Call(action, {}), registry())
    return city


def camera_of(sample: Sample, top: float, name: str) -> Camera:
    """Return a camera that shows the front and one side of a building whole."""
    low, high = np.zeros(3), np.array([sample.length, sample.width, top])
    corners = np.array(list(itertools.product(*zip(low, high, strict=True))))
    size = float(np.linalg.norm(high))
    aim, reach = high / 2, size
    for _ in range(12):  # move the aim to the middle of what is seen, and back until it fits
        up = max(EYE + 0.05 * reach + 0.12 * top, 0.25 * (reach - size))
        eye = aim + reach * np.array([math.sin(ROUND), -math.cos(ROUND), 0.0])
        eye[2] = up
        look = (aim - eye) / np.linalg.norm(aim - eye)
        right = np.cross(look, [0.0, 0.0, 1.0])
        right /= np.linalg.norm(right)
        over = np.cross(right, look)
        depth = (corners - eye) @ look
        seen = np.column_stack([(corners - eye) @ right, (corners - eye) @ over]) / depth[:, None]
        middle = (seen.max(axis=0) + seen.min(axis=0)) / 2
        half = (seen.max(axis=0) - seen.min(axis=0)) / 2
        far = float((aim - eye) @ look)
        aim = aim + far * (middle[0] * right + middle[1] * over)
        fill = max(half[0], half[1] * CELL[0] / CELL[1]) / (math.tan(FOV / 2) * FILL)
        reach *= fill
    pitch = math.atan2(look[2], math.hypot(look[0], look[1]))
    heading = math.atan2(look[0], look[1])
    at = eye + np.array([sample.x, sample.y, 0.0])
    return Camera(name, tuple(at.tolist()), heading, pitch, FOV, *CELL)


def tops_of(city: City) -> dict[int, float]:
    """Height of every building."""
    parts = city.layout.parts
    found: dict[int, float] = {}
    for building, top in zip(parts["building"].tolist(), parts["top"].tolist(), strict=True):
        found[int(building)] = max(found.get(int(building), 0.0), float(top))
    return found


def render(city: City, cameras: Sequence[Camera], folder: Path, samples: int) -> list[Path]:
    """Store the city and render its cameras."""
    store = folder / "city"
    write_city(city, store)
    requests = tuple(RenderRequest(each, folder / f"{each.name}.png", samples) for each in cameras)
    run_worker(BlenderJob(store, renders=requests), timeout_s=TIMEOUT_S,
               progress=lambda _, text: print(text))  # fmt: skip
    return [request.path for request in requests]


def compose(rows: Sequence[tuple[str, Sequence[Path]]], wide: Sequence[tuple[str, Path]],
            out: Path) -> None:  # fmt: skip
    """Write the sheet: `COLUMNS` generators side by side, then the streets."""
    width, height = CELL
    block = len(SEEDS) * (width + GAP) + 2 * GAP
    lines = -(-len(rows) // COLUMNS)
    street = block * COLUMNS // max(len(wide), 1) - GAP
    tall = street * 9 // 16 if wide else 0
    sheet = Image.new(
        "RGB", (block * COLUMNS, lines * (height + TITLE + GAP) + tall + TITLE + GAP), "white"
    )
    draw = ImageDraw.Draw(sheet)
    font = ImageFont.load_default(size=15)
    for index, (title, pictures) in enumerate(rows):
        left = GAP + (index // lines) * block
        top = (index % lines) * (height + TITLE + GAP)
        draw.text((left, top + 2), title, fill="black", font=font)
        for column, path in enumerate(pictures):
            with Image.open(path) as picture:
                sheet.paste(picture.convert("RGB"), (left + column * (width + GAP), top + TITLE))
    top = lines * (height + TITLE + GAP)
    for index, (title, path) in enumerate(wide):
        left = GAP + index * (street + GAP)
        draw.text((left, top + 2), title, fill="black", font=font)
        with Image.open(path) as picture:
            small = picture.convert("RGB").resize((street, tall), Image.Resampling.LANCZOS)
        sheet.paste(small, (left, top + TITLE))
    out.parent.mkdir(parents=True, exist_ok=True)
    # Half of the size, and nobody sees it.
    sheet.point(lambda value: min(round(value / STEP) * STEP, 255)).save(out, optimize=True)


def main() -> None:
    """Build, render and compose."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-o", "--out", type=Path, default=Path("docs/buildings.png"))
    parser.add_argument("--only", nargs="*", choices=NAMES, default=list(NAMES))
    parser.add_argument("--samples", type=int, default=24)
    parser.add_argument("--lod", type=int, default=2, choices=(1, 2, 3))
    parser.add_argument("--streets", nargs="*", choices=list(streets.STREETS),
                        default=list(streets.STREETS))  # fmt: skip
    parser.add_argument("--work", type=Path, help="folder to keep the pictures in")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        work = options.work or Path(scratch)
        rows, wide = [], []
        if options.only:
            samples = sheet_of(options.only, SEEDS)
            city = built(sample_city(samples, lod=options.lod))
            tops = tops_of(city)
            cameras = [camera_of(s, tops[s.id], f"{s.generator}_{s.seed}") for s in samples]
            paths = render(city, cameras, work / "sheet", options.samples)
            rows = [
                (generators()[name].title, paths[i * len(SEEDS) : (i + 1) * len(SEEDS)])
                for i, name in enumerate(options.only)
            ]
        for name in options.streets:
            city = furnished(
                built(streets.street_city(name, lod=3), time=streets.STREETS[name].time)
            )
            camera = streets.camera_of(name)
            path = render(city, [camera], work / name, options.samples)[0]
            wide.append((streets.STREETS[name].title, path))
        compose(rows, wide, options.out)
    print(options.out)


if __name__ == "__main__":
    main()
