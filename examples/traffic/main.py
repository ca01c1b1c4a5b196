"""Render a street with traffic and people, and Algorithm 1 as a short animation.

    python examples/traffic/main.py [street] [algorithm1] [-o docs] [--samples 24] [--work DIR]

Without names both are made, in two of the small towns that the benchmark draws.
"""

from __future__ import annotations

import argparse
import math
import tempfile
from collections.abc import Sequence
from pathlib import Path

from PIL import Image

from cityx.agents.build import build
from cityx.agents.options import BuildOptions
from cityx.bench.scenes import SCENES, write_drawing
from cityx.blender.client import BlenderJob, RenderRequest, run_worker
from cityx.city import City
from cityx.city.camera import Camera
from cityx.city.store import read_city, write_city
from cityx.protocol import registry
from cityx.protocol.gate import Call
from cityx.protocol.run import run_step

TIMEOUT = 3600.0  # seconds
EVERY = 2  # frames from one picture of the animation to the next
SPAN = 48  # frames: three strides of a runner
COLORS = 160  # of the animation, so that it stays small
# The call of the paper, word for word.
ALGORITHM_1 = {
    "crowd_creation": "single", "walk_run": "run", "style": "casual",
    "category": "run, male_jog02", "model_quality": "high_poly", "random_color": True,
}  # fmt: skip
# Clockwise along the path around the park, metres, from its north end past the camera.
CURVE01 = tuple(
    (45.0 * math.cos(math.radians(angle)), 45.0 * math.sin(math.radians(angle)))
    for angle in range(80, -45, -5)
)
FIRST = 384  # frame at which the runner is fourteen metres from the camera
EYE = {
    "street": ((89.5, -88.4, 2.3), 105.0, -4.5, 58.0, (960, 576)),
    "algorithm1": ((48.5, 2.0, 1.5), 333.0, -3.0, 44.0, (480, 300)),
}
RUSH_HOUR = 17.0
MOMENT = 52.0  # seconds at which cars and people meet at the crossing


def camera(name: str) -> Camera:
    """Make the camera of a picture; its heading is from north clockwise, in degrees."""
    eye, *angles, (width, height) = EYE[name]
    heading, pitch, fov = map(math.radians, angles)
    return Camera(name, eye, heading, pitch, fov, width, height)


def base_scene(name: str, folder: Path) -> City:
    """Build a scene of the benchmark."""
    scene = SCENES[name]
    folder.mkdir(parents=True, exist_ok=True)
    drawing = write_drawing(scene.draw(), scene.extent, folder / f"{name}.geojson")
    options = BuildOptions(formats=(), render=False, time="15:00", weather="clear")
    build([drawing], folder, options, say=print)
    return read_city(folder / "city")


def peopled(work: Path) -> Path:
    """Let traffic and people fill a street for a minute; returns the folder of the city."""
    folder = work / "street"
    city = base_scene("grid_s", folder)
    for action, args in (
        ("dynamic/traffic-v1", {"per_km": 30.0, "duration": 60.0, "hour": RUSH_HOUR}),
        ("dynamic/pedestrians-v1", {"density": "heavy", "duration": 60.0, "hour": RUSH_HOUR}),
    ):
        city = run_step(city, Call(action, args), registry())
    write_city(city, folder / "city")
    return folder


def street(out: Path, work: Path, samples: int) -> Path:
    """Render a moment of the street."""
    folder = peopled(work)
    request = RenderRequest(camera("street"), out / "traffic.png", samples)
    job = BlenderJob(folder / "city", renders=(request,), moment=MOMENT)
    run_worker(job, timeout_s=TIMEOUT, progress=lambda _, text: print(text))
    return request.path


def algorithm1(out: Path, work: Path, samples: int) -> Path:
    """Run Algorithm 1 on a curve and render it as an animated picture."""
    folder = work / "algorithm1"
    city = base_scene("park_s", folder)
    args = {"path": "curve01", "points": CURVE01, **ALGORITHM_1}
    city = run_step(city, Call("dynamic/character-v1", args), registry())
    write_city(city, folder / "city")
    request = RenderRequest(camera("algorithm1"), folder / "frames" / "run.png", samples)
    job = BlenderJob(folder / "city", renders=(request,), frames=(FIRST, FIRST + SPAN, EVERY))
    made = run_worker(job, timeout_s=TIMEOUT, progress=lambda _, text: print(text)).files
    return animated(made, out / "algorithm1.gif", 40 * EVERY)


def animated(pictures: Sequence[Path], path: Path, milliseconds: int) -> Path:
    """Join pictures into an animated GIF of one palette, so that nothing flickers."""
    frames = [Image.open(picture).convert("RGB") for picture in pictures]
    palette = frames[len(frames) // 2].quantize(COLORS)
    shown = [frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in frames]
    shown[0].save(path, save_all=True, append_images=shown[1:], duration=milliseconds, loop=0)
    return path


MAKERS = {"street": street, "algorithm1": algorithm1}


def main() -> None:
    """Render the pictures that are asked for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(MAKERS)}")
    parser.add_argument("-o", "--out", type=Path, default=Path("docs"))
    parser.add_argument("--samples", type=int, default=24)
    parser.add_argument("--work", type=Path, help="folder to keep the cities in")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as temporary:
        work = options.work or Path(temporary)
        for name in options.names or list(MAKERS):
            print(MAKERS[name](options.out, work, options.samples))


if __name__ == "__main__":
    main()
