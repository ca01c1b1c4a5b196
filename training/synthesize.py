"""Render built cities from above, with exact masks, as pairs to train on.

    python training/synthesize.py CITY_DIR... -o ../synthetic [--windows 2] [--samples 16]

Each CITY_DIR is the folder of a `cityx build ... --lod 2`. Pictures are taken straight down from so
high that a tower of 50 m leans by less than its own wall is thick; masks are drawn from the ground
arrangement, the outlines of buildings and the crowns of trees.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import shapely
from labels import ANYTHING, may_be
from numpy.typing import NDArray
from PIL import Image
from rasterio.features import rasterize
from rasterio.transform import from_origin

from cityx.blender.client import BlenderJob, RenderRequest, run_worker
from cityx.city.camera import Camera
from cityx.city.city import City
from cityx.city.ground import ROADWAY
from cityx.city.store import read_city
from cityx.ids import rng_for, stable_id

PIXEL = 0.6  # metres, the ground resolution that the network sees
SIDE = 640  # pixels of a picture
HEIGHT = 4000.0  # metres of the camera above the ground
TIMEOUT_S = 3600.0
# What a satellite calls the surfaces of the ground; a surface that is not named may be anything.
SEEN = {
    may_be("road"): (*ROADWAY, "setts"),
    may_be("vegetation"): ("grass", "meadow", "wood", "park", "pitch"),
    may_be("water"): ("water",),
    may_be("bare"): ("bare", "sand", "courtyard", "plaza", "sidewalk", "path", "trail",
                     "playground", "furnishing", "kerb"),
    may_be("bare", "vegetation"): ("block", "farmland"),
    may_be("bare", "road"): ("parking", "railway", "rail", "apron", "kerb_dropped", "ramp"),
}  # fmt: skip


@dataclass(frozen=True)
class Window:
    """A square of a city, by its middle in metres of the scene."""

    x: float
    y: float

    @property
    def half(self) -> float:
        """Half its side, metres."""
        return SIDE * PIXEL / 2

    @property
    def camera(self) -> Camera:
        """The camera that sees it from above, north up."""
        fov = 2 * math.atan(self.half / HEIGHT)
        at = (self.x, self.y, HEIGHT)
        return Camera("above", at, 0.0, -math.pi / 2, fov, SIDE, SIDE)


def windows_of(city: City, count: int) -> list[Window]:
    """Choose squares of a city, by its name; a small city gives one about its middle."""
    west, south, east, north = city.layout.extent
    rng = rng_for(city.seed, "training/synthesize", stable_id(city.name))
    half = SIDE * PIXEL / 2
    spans = [max(0.0, (high - low) / 2 - half) for low, high in ((west, east), (south, north))]
    places = rng.uniform(-1, 1, (count if max(spans) > half / 2 else 1, 2)) * spans
    return [Window((west + east) / 2 + x, (south + north) / 2 + y) for x, y in places.tolist()]


def mask_of(city: City, window: Window) -> NDArray[np.uint8]:
    """Return (SIDE, SIDE) uint8 labels of a window."""
    burn = _Burner(window)
    shapes = [*_ground(city), *_crowns(city), *_houses(city)]
    inside = shapely.box(*city.layout.extent)
    labels = burn.all(shapes)
    labels[burn.all([(inside, 1)]) == 0] = ANYTHING
    return labels


@dataclass(frozen=True)
class _Burner:
    window: Window

    def all(self, shapes: list[tuple[shapely.Geometry, int]]) -> NDArray[np.uint8]:
        """Burn shapes into a raster, the later over the earlier."""
        window = self.window
        place = from_origin(window.x - window.half, window.y + window.half, PIXEL, PIXEL)
        around = shapely.box(window.x - window.half, window.y - window.half,
                             window.x + window.half, window.y + window.half)  # fmt: skip
        near = [(shape, value) for shape, value in shapes if shape.intersects(around)]
        if not near:
            return np.zeros((SIDE, SIDE), np.uint8)
        return rasterize(near, (SIDE, SIDE), transform=place, dtype="uint8")


def _ground(city: City) -> Iterator[tuple[shapely.Geometry, int]]:
    yield shapely.box(*city.layout.extent), ANYTHING
    for label, names in SEEN.items():
        for triangle in city.ground.vertices[city.ground.triangles_of(*names)]:
            yield shapely.Polygon(triangle), label


def _crowns(city: City) -> Iterator[tuple[shapely.Geometry, int]]:
    trees = city.scene.instances.get("trees")
    if trees is None:
        return
    reach = np.array([_radius(item.mesh.vertices) for item in city.scene.prototypes])
    radius = reach[trees.prototype] * trees.scale[:, 0]
    spots = shapely.points(trees.position[:, :2])
    for crown in shapely.buffer(spots, radius, quad_segs=4):
        yield crown, may_be("vegetation")


def _radius(vertices: NDArray[np.float64]) -> float:
    """Return how far a crown reaches, but for single twigs."""
    return float(np.percentile(np.hypot(vertices[:, 0], vertices[:, 1]), 85))


def _houses(city: City) -> Iterator[tuple[shapely.Geometry, int]]:
    for outline in city.layout.buildings.geometry:
        yield outline, may_be("building")


def main() -> None:
    """Render what the command line asks for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("cities", type=Path, nargs="+")
    parser.add_argument("-o", "--out", type=Path, required=True)
    parser.add_argument("--windows", type=int, default=2, help="pictures of each city")
    parser.add_argument("--samples", type=int, default=16)
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    for folder in options.cities:
        city = read_city(folder / "city")
        windows = windows_of(city, options.windows)
        name = city.name.replace(" ", "_")
        requests = []
        for number, window in enumerate(windows):
            path = options.out / f"{name}_{number}.png"
            Image.fromarray(mask_of(city, window)).save(path.with_suffix(".mask.png"))
            requests.append(RenderRequest(window.camera, path, options.samples))
        run_worker(BlenderJob(folder / "city", renders=tuple(requests)), timeout_s=TIMEOUT_S)
        print(f"{name}: {len(windows)} pictures")


if __name__ == "__main__":
    main()
