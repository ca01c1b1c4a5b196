"""Render one street of Helsinki, built once with what moves in it, in every weather, on one sheet.

`python examples/weather/main.py [FOLDER [TITLE ...]]` writes `docs/weather.png` and prints, for
each picture, the shares of pixels that are blown out and lost in black, and the seconds in which
the light changed. Titles render only these cells anew.
"""

from __future__ import annotations

import sys
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from cityx.blender.client import BlenderJob, RenderRequest, run_worker
from cityx.city.store import read_view
from cityx.light.weather import lit_anew
from cityx.options import BuildOptions
from cityx.projects.build import build
from cityx.projects.views import cameras_of
from cityx.views.free_view import free_moment, in_the_way

ROOT = Path(__file__).parents[2]
SHEET = ROOT / "docs" / "weather.png"
# A block of central Helsinki: a street of shops with trees on one side.
WINDOW = {"at": (60.16865, 24.94500), "size": (340.0, 280.0)}
LIFE = "heavy traffic, 160 pedestrians"
# Seconds of tracks, among which the pictures find their busiest moment.
SPAN = ("dynamic/traffic-v1.duration=120", "dynamic/pedestrians-v1.duration=120")
# Title, words for `--weather` and `--time`.
CELLS = (
    ("clear", "clear", "15:00"),
    ("overcast", "overcast", "15:00"),
    ("fog", "fog", "10:00"),
    ("rain", "rain", "15:00"),
    ("storm", "storm", "15:00"),
    ("snow", "snow", "12:00"),
    ("dawn", "dawn", "09-21 dawn"),  # when the sun rises behind the camera
    ("dusk", "dusk", ""),
    ("night", "night", ""),
    ("rain at night", "rain night", ""),
    ("snow at dusk", "snow dusk", ""),
    ("cloudy, evening", "cloudy", "golden"),
)
SIZE, SAMPLES, COLUMNS, GAP = (480, 300), 14, 3, 6
BLOWN, LOST = 250, 5  # of 255
MOST_BLOWN, MOST_LOST = 0.02, 0.05


def shares(path: Path) -> tuple[float, float]:
    """Return the shares of pixels that are white, and black."""
    with Image.open(path) as picture:
        pixels = np.asarray(picture.convert("RGB"), float)
    light = pixels @ [0.2126, 0.7152, 0.0722]
    return float((pixels.min(axis=2) >= BLOWN).mean()), float((light <= LOST).mean())


def render_cells(folder: Path, titles: list[str]) -> dict[str, float]:
    """Render cells from one scene; returns the seconds of each change of light by title."""
    view = read_view(folder / "city")
    (camera,) = cameras_of(view, ["street"], SIZE)
    moment = free_moment(view, camera, busiest=True)
    requests = []
    for title, weather, time in CELLS:
        if title not in titles:
            continue
        light = lit_anew(
            view.environment, view.frame.latitude, view.frame.longitude, weather=weather, time=time
        )
        shot = replace(camera, name=title)
        requests.append(RenderRequest(shot, picture_of(folder, title), SAMPLES, light, moment))
    hidden = tuple(in_the_way(view, camera).tolist())
    job = BlenderJob(folder / "city", renders=tuple(requests), hidden=hidden)
    result = run_worker(job, timeout_s=7200, progress=lambda _, text: print(text, flush=True))
    return {title: result.timings[f"light {title}"]["wall_s"] for title in titles}


def picture_of(folder: Path, title: str) -> Path:
    """Return the file of a cell."""
    return folder / "renders" / f"weather_{title.replace(', ', '_').replace(' ', '_')}.png"


def sheet(paths: list[Path]) -> Image.Image:
    """Put the pictures in rows, each with its title."""
    width, height = SIZE
    rows = -(-len(paths) // COLUMNS)
    size = (COLUMNS * (width + GAP) - GAP, rows * (height + GAP) - GAP)
    page = Image.new("RGB", size, "white")
    draw, font = ImageDraw.Draw(page), ImageFont.load_default(18)
    for index, (path, (title, _, _)) in enumerate(zip(paths, CELLS, strict=True)):
        row, column = divmod(index, COLUMNS)
        corner = (column * (width + GAP), row * (height + GAP))
        with Image.open(path) as picture:
            page.paste(picture, corner)
        at = (corner[0] + 10, corner[1] + 8)
        draw.text(at, title, "white", font, stroke_width=2, stroke_fill="black")
    return page


def main() -> int:
    """Make the sheet; returns 1 if a picture is blown out or lost in black."""
    sys.path.insert(0, str(ROOT / "examples" / "helsinki"))
    from main import helsinki

    folder = Path(sys.argv[1] if len(sys.argv) > 1 else tempfile.mkdtemp(prefix="cityx-weather-"))
    if not (folder / "city").is_dir():
        options = BuildOptions(formats=(), render=False, lod=3, text=LIFE, settings=SPAN, **WINDOW)
        build([helsinki()], folder, options)
    every = [title for title, _, _ in CELLS]
    taken = render_cells(folder, sys.argv[2:] or every)
    paths, good = [picture_of(folder, title) for title in every], True
    for title, path in zip(every, paths, strict=True):
        white, black = shares(path)
        good &= white <= MOST_BLOWN and black <= MOST_LOST
        spent = f"  changed in {taken[title]:.2f} s" if title in taken else ""
        print(f"{title:16s} white {white:6.2%}  black {black:6.2%}{spent}")
    sheet(paths).save(SHEET, optimize=True)
    print(SHEET)
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
