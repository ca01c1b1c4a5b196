"""Render the close-ups of streets that the documentation shows.

    python examples/streets/main.py [NAME ...] [-o docs] [--samples 32] [--work DIR]

Without names all pictures are made. Reads maps from ``../shared/data/osm``; where they are absent a
town is laid out here. Map data © OpenStreetMap contributors, ODbL 1.0.
"""

from __future__ import annotations

import argparse
import math
import shutil
import tempfile
from dataclasses import dataclass
from pathlib import Path

from cityx.blender.client import BlenderJob, RenderRequest, run_worker
from cityx.city.camera import Camera
from cityx.city.frame import Frame
from cityx.city.store import read_view
from cityx.options import BuildOptions
from cityx.projects.build import build
from cityx.views.free_view import free_moment

MAPS = Path(__file__).parents[2] / ".." / "shared" / "data" / "osm"
WIDTH, HEIGHT = 960, 600
LIFE = "medium traffic, 90 pedestrians"
# Seconds of tracks, among which the pictures find their busiest moment.
SPAN = ("dynamic/traffic-v1.duration=90", "dynamic/pedestrians-v1.duration=90")
TIMEOUT = 1800.0  # seconds


@dataclass(frozen=True)
class View:
    """A picture: where it is, and the camera seen from there.

    Attributes
    ----------
    map
        File in the folder of maps.
    place
        Latitude and longitude of the middle of the window that is built, degrees.
    eye
        Metres east, north and up of the place.
    heading, pitch, fov
        Degrees; heading from north clockwise.
    size
        (width, depth) of the window, metres.
    """

    map: str
    place: tuple[float, float]
    eye: tuple[float, float, float]
    heading: float
    pitch: float
    fov: float = 62.0
    size: tuple[float, float] = (260.0, 260.0)


VIEWS = {
    "junction": View(
        "sydney_glebe.osm.gz", (-33.874418, 151.182722), (21.7, 14.3, 9.5), 237.0, -20.0
    ),
    "bridge": View(
        "seattle_i5_exit.osm.gz",
        (47.656236, -122.321628),
        (30.0, -60.0, 16.0),
        300.0,
        -12.0,
        65.0,
        (280.0, 380.0),
    ),
    "roundabout": View("krems.osm.gz", (48.412224, 15.635528), (24.0, -34.0, 18.0), 328.0, -24.0),
}


def town(out: Path) -> Path:
    """Write a map with a crossroads, a roundabout and houses, for machines without the maps."""
    frame = Frame(48.2, 16.3)
    nodes: list[str] = []
    ways: list[str] = []

    def node(x: float, y: float, tags: str = "") -> int:
        lon, lat = (float(v) for v in frame.to_geographic([[x, y]])[0])
        number = len(nodes) + 1
        nodes.append(f'<node id="{number}" lat="{lat:.8f}" lon="{lon:.8f}">{tags}</node>')
        return number

    def tag(**tags: str) -> str:
        return "".join(f'<tag k="{key}" v="{value}"/>' for key, value in tags.items())

    def way(refs: list[int], tags: str) -> None:
        line = "".join(f'<nd ref="{ref}"/>' for ref in refs)
        ways.append(f'<way id="{len(ways) + 1}">{line}{tags}</way>')

    ring = [node(14 * math.cos(a * math.pi / 8), 14 * math.sin(a * math.pi / 8)) for a in range(16)]
    way([*ring, ring[0]], tag(highway="secondary", junction="roundabout", lanes="1", width="6"))
    street = tag(highway="secondary", lanes="2", width="7", sidewalk="both")
    for step, (dx, dy) in enumerate(((1, 0), (0, 1), (-1, 0), (0, -1))):
        far = node(130 * dx, 130 * dy)
        if step:
            way([ring[4 * step], far], street)
            continue
        cross = node(80, 0, tag(highway="traffic_signals"))
        way([ring[0], cross, far], street)
        way([node(80, -90), cross, node(80, 90)], tag(highway="tertiary", lanes="2", width="6.5"))
    for x in (-110, -75, 28, 96):
        for y in (-60, 26):
            corners = [(x, y), (x + 26, y), (x + 26, y + 30), (x, y + 30)]
            refs = [node(*corner) for corner in corners]
            way([*refs, refs[0]], tag(building="apartments", **{"building:levels": "4"}))
    out.write_text('<osm version="0.6">' + "".join(nodes + ways) + "</osm>", encoding="utf-8")
    return out


def picture(name: str, out: Path, work: Path, samples: int) -> Path:
    """Build the window of a view and render it."""
    view = VIEWS[name]
    path, place = MAPS / view.map, view.place
    life = {"lod": 3, "formats": (), "render": False, "text": LIFE, "settings": SPAN}
    options = BuildOptions(**life, size=view.size, at=place)
    if not path.is_file():
        path = town(work / "town.osm")
        place = (48.2, 16.3) if name == "roundabout" else (48.2, 16.30108)
        options = BuildOptions(**life)
    folder = work / name
    build([path], folder, options, say=print)
    shown = read_view(folder / "city")
    x, y = shown.frame.to_local([place[::-1]])[0]
    east, north, up = view.eye
    camera = Camera(
        name, (x + east, y + north, up), math.radians(view.heading), math.radians(view.pitch),
        math.radians(view.fov), WIDTH, HEIGHT,
    )  # fmt: skip
    made = work / f"{name}.png"
    moment = free_moment(shown, camera, busiest=True)
    request = RenderRequest(camera, made, samples, moment=moment)
    run_worker(
        BlenderJob(folder / "city", renders=(request,)),
        timeout_s=TIMEOUT, progress=lambda *_: None,
    )  # fmt: skip
    return Path(shutil.copy(made, out / made.name))


def main() -> None:
    """Render the pictures that are asked for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(VIEWS)}")
    parser.add_argument("-o", "--out", type=Path, default=Path("docs"))
    parser.add_argument("--samples", type=int, default=32)
    parser.add_argument("--work", type=Path, help="folder to keep the cities in")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        work = options.work or Path(temporary)
        work.mkdir(parents=True, exist_ok=True)
        for name in options.names or list(VIEWS):
            print(picture(name, options.out, work, options.samples))


if __name__ == "__main__":
    main()
