"""Build the town crossing of ``crossing.geojson`` and render it from above and at eye level.

python examples/curves/main.py [-o docs] [--samples 32]
"""

from __future__ import annotations

import argparse
import math
import tempfile
from pathlib import Path

from cityx.blender.client import BlenderJob, RenderRequest, run_worker
from cityx.city.camera import Camera
from cityx.options import BuildOptions
from cityx.projects.build import build

DRAWING = Path(__file__).with_name("crossing.geojson")
TIMEOUT = 1800.0  # seconds
# Name: place in metres, heading from north clockwise, pitch and field of view in degrees.
VIEWS = {
    "crossing_top": ((0.0, -20.0, 260.0), 0.0, -89.0, 70.0),
    "crossing_street": ((30.0, -32.0, 9.0), 318.0, -12.0, 70.0),
}


def main() -> None:
    """Build and render."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-o", "--out", type=Path, default=Path("docs"))
    parser.add_argument("--samples", type=int, default=32)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        city = Path(folder) / "crossing"
        build([DRAWING], city, BuildOptions(formats=(), render=False), say=print)
        requests = []
        for name, (place, heading, pitch, fov) in VIEWS.items():
            turn = [math.radians(angle) for angle in (heading, pitch, fov)]
            camera = Camera(name, place, *turn, 960, 600)
            path = options.out.resolve() / f"{name}.png"
            requests.append(RenderRequest(camera, path, options.samples))
        job = BlenderJob(city / "city", renders=tuple(requests))
        run_worker(job, timeout_s=TIMEOUT, progress=lambda *_: None)


if __name__ == "__main__":
    main()
