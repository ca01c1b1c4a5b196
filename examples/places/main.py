"""Render a park and a waterfront at eye level into docs/.

    python examples/places/main.py [park] [waterfront] [-o docs] [--samples 64] [--work DIR]

The park is one of Berlin's, read from ``../shared`` (map data © OpenStreetMap contributors, ODbL
1.0); where that folder is absent, and for the waterfront, a town made by code takes its place.
"""

from __future__ import annotations

import argparse
import math
import tempfile
from dataclasses import dataclass
from pathlib import Path

from town import river_town

from cityx.blender.client import BlenderJob, RenderRequest, run_worker
from cityx.city.camera import Camera
from cityx.city.store import read_view
from cityx.options import BuildOptions
from cityx.projects.build import build
from cityx.views.free_view import free_moment

MAPS = Path(__file__).parents[2] / ".." / "shared" / "data" / "osm"
LIFE = "200 pedestrians"
WIDTH, HEIGHT = 960, 600
TIMEOUT_S = 3 * 3600.0


@dataclass(frozen=True)
class View:
    """A camera: x, y and z in metres of the scene, heading and pitch in degrees."""

    at: tuple[float, float, float]
    heading: float
    pitch: float
    time: str
    fov: float = 66.0


PARK = View((-84.0, 43.5, 1.75), 262.0, -2.0, "15:00")
TOWN_PARK = View((-20.0, 50.0, 1.75), 10.0, -5.0, "10:30")
WATERFRONT = View((12.5, -54.4, 2.3), 107.0, -4.0, "16:00")


def picture(place: str, work: Path, out: Path, samples: int) -> Path:
    """Build what a place needs, unless an earlier picture left it, and render it."""
    osm = MAPS / "berlin_neukoelln_streets.osm.gz"
    if place == "park" and osm.is_file():
        view = PARK
    else:
        osm = river_town(work / "river_town.osm")
        view = TOWN_PARK if place == "park" else WATERFRONT
    city = work / f"{osm.name.split('.')[0]}_{view.time.replace(':', '')}"
    if not (city / "report.json").is_file():
        options = BuildOptions(lod=3, formats=(), render=False, time=view.time, text=LIFE)
        build([osm], city, options, say=print)
    camera = Camera(place, view.at, math.radians(view.heading), math.radians(view.pitch),
                    math.radians(view.fov), WIDTH, HEIGHT)  # fmt: skip
    path = out / f"{place}.png"
    moment = free_moment(read_view(city / "city"), camera, busiest=True)
    shot = RenderRequest(camera, path, samples, moment=moment)
    job = BlenderJob(city / "city", renders=(shot,))
    run_worker(job, timeout_s=TIMEOUT_S, progress=lambda share, text: print(f"{share:.0%} {text}"))
    return path


def main() -> None:
    """Render the pictures that were asked for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("places", nargs="*", default=["park", "waterfront"],
                        help="park, waterfront")  # fmt: skip
    parser.add_argument("-o", "--out", type=Path, default=Path("docs"))
    parser.add_argument("--samples", type=int, default=64)
    parser.add_argument("--work", type=Path, help="folder to keep the cities in")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        work = args.work or Path(temporary)
        work.mkdir(parents=True, exist_ok=True)
        for place in args.places:
            print(picture(place, work, args.out, args.samples))


if __name__ == "__main__":
    main()
