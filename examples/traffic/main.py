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

import numpy as np
import shapely
from cityx_bench.scenes import SCENES, write_drawing
from numpy.typing import NDArray
from PIL import Image

from cityx.blender.client import BlenderJob, RenderRequest, run_worker
from cityx.city import City
from cityx.city.camera import Camera
from cityx.city.moments import moments_of
from cityx.city.store import read_city, write_city
from cityx.city.thing_outlines import placed_outlines
from cityx.ground.walking.walkable import walkable_of
from cityx.options import BuildOptions
from cityx.projects.build import build
from cityx.protocol import registry
from cityx.protocol.gate import Call
from cityx.protocol.running import run_step
from cityx.views.free_view import sector

FloatArray = NDArray[np.float64]

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
RUNNING = Camera("algorithm1", (48.5, 2.0, 1.5), math.radians(333.0), math.radians(-3.0),
                 math.radians(44.0), 480, 300)  # fmt: skip
RUSH_HOUR = 17.0
MOMENTS = (40.0, 46.0, 52.0, 58.0)  # seconds, of which the liveliest view is taken
EYE, PITCH, FOV, SIZE = 1.8, math.radians(-3.0), math.radians(58.0), (960, 576)
FREE = 4.0  # metres before the lens in which nothing stands
APART = 3.0  # metres between the places on walks that are tried
SEEN = (6.0, 35.0)  # metres away at which vehicles and people are well seen
SIGHT = 80.0  # metres of street ahead that are as good as endless
TURNS = np.radians(np.arange(0.0, 360.0, 15.0))
ON_WALLS = ("doors", "windows", "trims", "shopfronts", "roof_furniture", "street_covers")
CROWD = 0.6  # of what the last one of a kind adds to a picture, the next one adds


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


def lookout(city: City, moments: Sequence[float]) -> tuple[Camera, float]:
    """Choose where on a pavement to stand, and when, to see most vehicles and people.

    Nothing stands before the lens, no house is in the way of what is seen, and the street goes on.
    """
    walkable, tracks = walkable_of(city), city.tracks
    assert tracks is not None
    assert city.ground is not None
    cells = walkable.places(np.argwhere(walkable.free & (walkable.crosswalk == 0)))
    tile = np.floor(cells / APART).astype(np.int64)
    spots = cells[np.unique(tile, axis=0, return_index=True)[1]]
    spots = spots[city.ground.on(spots, "sidewalk")]
    layers = tuple(name for name in city.scene.instances if name not in ON_WALLS)
    things = np.concatenate([placed_outlines(city.scene, layers)[0], _walls_of(city)])
    houses = shapely.STRtree(city.layout.buildings.geometry.to_numpy())
    best = (0.0, 0.0, Camera("street", (0.0, 0.0, EYE), 0.0, PITCH))
    for moment in moments:
        movers = moments_of(tracks, [moment])
        places, walks = movers.position[:, :2], tracks.on_foot[movers.mover]
        standing = shapely.STRtree(np.concatenate([things, movers.boxes(tracks.size)]))
        for spot in spots:
            gap = places - spot
            away, turn = np.hypot(*gap.T), np.arctan2(gap[:, 0], gap[:, 1])
            lines = shapely.linestrings(np.stack([np.broadcast_to(spot, places.shape), places], 1))
            seen = (away > SEEN[0]) & (away < SEEN[1])
            seen[houses.query(lines, predicate="intersects")[0]] = False
            if not (seen & walks).any() or not (seen & ~walks).any():
                continue
            for heading in TURNS:
                side = np.abs((turn - heading + np.pi) % (2 * np.pi) - np.pi)
                shown = seen & (side < 0.42 * FOV)
                score = _liveliness(away[shown & walks]) * _liveliness(away[shown & ~walks])
                if 2.0 * score <= best[0]:
                    continue
                ahead = spot + SIGHT * np.array([np.sin(heading), np.cos(heading)])
                line = shapely.LineString([spot, ahead])
                walls = houses.geometries[houses.query(line, predicate="intersects")]
                long = float(shapely.distance(shapely.Point(spot), shapely.intersection(
                    walls, line)).min(initial=SIGHT))  # fmt: skip
                score *= 1.0 + long / SIGHT
                if score > best[0] and not len(
                    standing.query(sector(spot, heading, 1.1 * FOV, FREE), "intersects")
                ):
                    z = float(city.terrain.height_at(spot[None])[0]) + EYE
                    eye = (float(spot[0]), float(spot[1]), z)
                    camera = Camera("street", eye, float(heading), PITCH, FOV, *SIZE)
                    best = score, moment, camera
    return best[2], best[1]


def _liveliness(away: FloatArray) -> float:
    """Return what some movers add to a picture: the nearest most, each after it less."""
    return float((CROWD ** np.arange(len(away)) / np.sqrt(np.sort(away))).sum())


def _walls_of(city: City) -> NDArray[np.object_]:
    """(w,) outlines of walls, fences and hedges."""
    batch = city.scene.meshes.get("barriers")
    if batch is None or not batch.count:
        return np.zeros(0, object)
    triangles, _ = batch.triangles()
    return np.asarray(shapely.convex_hull(shapely.multipoints(
        batch.vertices[triangles][:, :, :2].reshape(-1, 2),
        indices=np.repeat(np.arange(len(triangles)), 3))), object)  # fmt: skip


def street(out: Path, work: Path, samples: int) -> Path:
    """Render a moment of the street."""
    folder = peopled(work)
    camera, moment = lookout(read_city(folder / "city"), MOMENTS)
    request = RenderRequest(camera, out / "traffic.png", samples)
    job = BlenderJob(folder / "city", renders=(request,), moment=moment)
    run_worker(job, timeout_s=TIMEOUT, progress=lambda _, text: print(text))
    return request.path


def algorithm1(out: Path, work: Path, samples: int) -> Path:
    """Run Algorithm 1 on a curve and render it as an animated picture."""
    folder = work / "algorithm1"
    city = base_scene("park_s", folder)
    args = {"path": "curve01", "points": CURVE01, **ALGORITHM_1}
    city = run_step(city, Call("dynamic/character-v1", args), registry())
    write_city(city, folder / "city")
    request = RenderRequest(RUNNING, folder / "frames" / "run.png", samples)
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
