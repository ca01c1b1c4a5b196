"""Put our pictures of three places beside those of OSM2World from the same cameras.

    python examples/compare/main.py [-o docs/compare.png] [--samples 48] [--work DIR]

Reads the maps and the other program's pictures from ``../shared`` (see its reference/README.md).
Map data © OpenStreetMap contributors, ODbL 1.0.
"""

from __future__ import annotations

import argparse
import json
import tempfile
from pathlib import Path

from PIL import Image, ImageDraw, ImageFont

from cityx.options import BuildOptions, RenderOptions
from cityx.projects.build import build
from cityx.projects.views import render_views

SHARED = Path(__file__).parents[2] / ".." / "shared"
CAMERAS = SHARED / "reference" / "cameras.json"
VIEWS = ("street", "junction", "aerial")
# What is about in each place: as many people as its walks have at a busy hour.
LIFE = {
    "london_soho": "heavy traffic, 1300 pedestrians",
    "tokyo_kanda": "heavy traffic, 2600 pedestrians",
    "berlin_neukoelln_streets": "heavy traffic, 480 pedestrians",
}
# Seconds of tracks, among which each picture finds its busiest moment.
SPAN = ("dynamic/traffic-v1.duration=240", "dynamic/pedestrians-v1.duration=240")
WIDTH, HEIGHT, GAP, TITLE = 480, 270, 8, 24


def render_place(name: str, osm: Path, work: Path, samples: int) -> dict[str, Path]:
    """Build one place and return our picture of each view."""
    out = work / name
    options = BuildOptions(lod=3, formats=("blend",), render=False, text=LIFE[name], settings=SPAN)
    build([osm], out, options, say=print)
    asked = RenderOptions(str(CAMERAS), samples, moment="busiest")
    paths = render_views(out, asked, say=print)
    return {path.stem: path for path in paths}


def compose(pairs: list[tuple[str, Path, Path]], out: Path) -> None:
    """Write a sheet: one row per view, the other program left, ours right."""
    row = HEIGHT + TITLE + GAP
    sheet = Image.new("RGB", (2 * WIDTH + 3 * GAP, row * len(pairs) + GAP), "white")
    draw = ImageDraw.Draw(sheet)
    font = ImageFont.load_default(size=16)
    for index, (title, theirs, ours) in enumerate(pairs):
        top = GAP + index * row
        sides = ((theirs, "OSM2World"), (ours, "CityX"))
        for column, (path, who) in enumerate(sides):
            left = GAP + column * (WIDTH + GAP)
            draw.text((left, top), f"{title}: {who}", fill="black", font=font)
            with Image.open(path) as picture:
                small = picture.convert("RGB").resize((WIDTH, HEIGHT), Image.Resampling.LANCZOS)
            sheet.paste(small, (left, top + TITLE))
    out.parent.mkdir(parents=True, exist_ok=True)
    sheet.save(out, optimize=True)


def main() -> None:
    """Build, render and compose."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-o", "--out", type=Path, default=Path("docs/compare.png"))
    parser.add_argument("--samples", type=int, default=48)
    parser.add_argument("--work", type=Path, help="folder to keep the cities in")
    args = parser.parse_args()
    if not CAMERAS.is_file():
        raise SystemExit(f"{CAMERAS} is absent; the comparison needs the reference pictures.")
    with tempfile.TemporaryDirectory() as temporary:
        work = args.work or Path(temporary)
        pairs = []
        for name, place in json.loads(CAMERAS.read_text())["places"].items():
            ours = render_place(name, SHARED / place["osm"], work, args.samples)
            for view in VIEWS:
                theirs = SHARED / "reference" / name / f"{view}_osm2world.png"
                pairs.append((f"{name.replace('_', ' ')}, {view}", theirs, ours[view]))
        compose(pairs, args.out)
    print(args.out)


if __name__ == "__main__":
    main()
