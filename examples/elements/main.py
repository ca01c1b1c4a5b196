"""Ask for towns that hold every element there is, and put a picture of each on one sheet.

python examples/elements/main.py [-o docs/elements.png] [--samples 20] [--only church castle]
"""

from __future__ import annotations

import argparse
import math
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import shapely
from PIL import Image, ImageDraw, ImageFont

from cityx.blender.client import BlenderJob, RenderRequest, run_worker
from cityx.city import City
from cityx.city.camera import Camera
from cityx.city.store import read_city
from cityx.language.lexicon.phrases import NOUNS
from cityx.options import BuildOptions
from cityx.projects.build import build
from cityx.projects.views import TIMEOUT_S
from cityx.road.network.network import DRIVABLE
from cityx.town.elements import ELEMENTS
from cityx.town.wishes.elements import shapes_of

RENDERED = (448, 320)  # pixels
CELL = (280, 200)  # of one picture on the sheet
TITLE, GAP, COLUMNS = 20, 6, 6
TOGETHER = 8  # elements of one town
NAMES = {noun: words for group in NOUNS.values() for noun, words in group.items()}
SITE = (560, 560)  # metres
FIELD = math.radians(52.0)


def camera_of(city: City, kind: str) -> Camera:
    """Return a camera before an element, on the side of the nearest street."""
    layout = city.layout
    tables = (layout.buildings, layout.points, layout.areas)
    own = [table[table["source"].str.startswith(f"made/{kind}/0")] for table in tables]
    if ELEMENTS[kind].builder:  # a tower, a pylon, a stop or a platform of it
        own = [next((table.iloc[:1] for table in own if len(table)), own[0])]
    shapes = np.concatenate([table.geometry.to_numpy() for table in own])
    if not len(shapes):  # the town had one before it was asked for
        shapes = shapes_of(city, kind)[:1]
    high = max([3.0, *(height for table in own if "height" in table for height in table["height"])])
    xmin, ymin, xmax, ymax = shapely.total_bounds(shapes)
    middle = np.array([(xmin + xmax) / 2, (ymin + ymax) / 2])
    radius = max(math.hypot(xmax - xmin, ymax - ymin) / 2, 6.0)
    roads = layout.roads[layout.roads["kind"].isin(DRIVABLE)].geometry.to_numpy()
    ways = shapely.shortest_line(shapely.Point(middle), roads)
    nearest = shapely.get_coordinates(ways[int(np.argmin(shapely.length(ways)))])
    way = nearest[-1] - middle
    way = way / max(float(np.hypot(*way)), 1e-9)
    away = max(1.15 * radius + 0.9 * high, 12.0)
    spot = middle + away * way
    eye = 8.0 + 0.7 * radius + 0.6 * high  # above the roofs across the street
    heading = math.atan2(*(middle - spot))
    pitch = math.atan2(0.4 * high - eye, away)
    return Camera(kind, (float(spot[0]), float(spot[1]), eye), heading, pitch, FIELD, *RENDERED)


def batches(kinds: Sequence[str]) -> Iterator[list[str]]:
    """Yield the elements of each town, large and small ones together."""
    order = sorted(kinds, key=lambda kind: -ELEMENTS[kind].area)
    count = math.ceil(len(order) / TOGETHER)
    yield from (order[k::count] for k in range(count))


def sheet(pictures: dict[str, Path], out: Path) -> None:
    """Put pictures with their names on one sheet."""
    rows = math.ceil(len(pictures) / COLUMNS)
    wide, high = CELL[0] + GAP, CELL[1] + TITLE + GAP
    page = Image.new("RGB", (COLUMNS * wide + GAP, rows * high + GAP), "white")
    draw, font = ImageDraw.Draw(page), ImageFont.load_default(13)
    for at, (kind, path) in enumerate(pictures.items()):
        x, y = GAP + at % COLUMNS * wide, GAP + at // COLUMNS * high
        page.paste(Image.open(path).convert("RGB").resize(CELL, Image.Resampling.LANCZOS), (x, y))
        draw.text((x + 2, y + CELL[1] + 1), kind.replace("_", " "), "black", font)
    page.quantize(256).save(out, optimize=True)


def main() -> None:
    """Build the towns, take the pictures and write the sheet."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-o", "--out", type=Path, default=Path("elements.png"))
    parser.add_argument("--samples", type=int, default=20)
    parser.add_argument("--only", nargs="*", default=list(ELEMENTS), choices=list(ELEMENTS))
    parser.add_argument("--work", type=Path, help="folder that keeps towns and pictures")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as held:
        work = args.work or Path(held)
        found: dict[str, Path] = {}
        for number, kinds in enumerate(batches(args.only)):
            words = ", ".join(f"one {NAMES[kind].split(',')[0]}" for kind in kinds)
            options = BuildOptions(
                text=f"A town with {words}", formats=("blend",), render=False, size=SITE, seed=3
            )
            folder = work / f"town{number}"
            report = build([], folder, options)
            print(number, *(goal["goal"] for goal in report["goals"] if goal["met"] is not True))
            city = read_city(folder / "city")
            shots = [(kind, camera_of(city, kind), work / f"{kind}.png") for kind in kinds]
            renders = tuple(RenderRequest(view, path, args.samples) for _, view, path in shots)
            run_worker(BlenderJob(folder / "city", renders=renders), timeout_s=TIMEOUT_S,
                       progress=lambda *_: None)  # fmt: skip
            found |= {kind: path for kind, _, path in shots}
        sheet({kind: found[kind] for kind in ELEMENTS if kind in found}, args.out)


if __name__ == "__main__":
    main()
