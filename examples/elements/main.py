"""Ask for towns that hold all there is to ask for, and put a picture of each thing on one sheet.

python examples/elements/main.py [-o docs/elements.png] [--samples 20] [--only church hill]
"""

from __future__ import annotations

import argparse
import itertools
import math
import tempfile
import tomllib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from cityx.blender.client import BlenderJob, RenderRequest, run_worker
from cityx.checks.predicates.measuring import things_of
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

RENDERED = (320, 240)  # pixels
CELL = (200, 150)  # of one picture on the sheet
TITLE, GAP, COLUMNS = 17, 4, 9
TOGETHER = 60_000.0  # square metres of lots in one town
MOST = 20  # elements of one town
NAMES = {noun: words for group in NOUNS.values() for noun, words in group.items()}
SITE = (520.0, 520.0)  # metres
FIELD = math.radians(46.0)
FILLED = 0.88  # of a picture, by what it shows
ROUND = 18.0  # metres shown round a place
LEAST, MOST_SHOWN = 6.0, 60.0  # metres from the middle of what is shown to its ends
PITCHES = np.radians([9.0, 18.0, 28.0, 40.0, 54.0])
# Pitches that suit what lies on the ground, what is high, and the form of land.
FLAT, HIGH, LOW = math.radians(40.0), math.radians(22.0), math.radians(9.0)
TURNS = np.radians(np.arange(0.0, 360.0, 15.0))
STEPS = 40  # along a line of sight
# What of a line is shown: the third word of its provenance.
OF_LINES = {"city_wall": "tower", "power_line": "pylon", "railway": "platform", "tram_line": "stop"}

# Buildings that are shown with their land.
LANDS = ("campus", "farmyard", "petrol_station", "construction_site", "mall")


@dataclass(frozen=True)
class Town:
    """A town in words, and what of it is shown, by name: "" is the whole site."""

    text: str
    shows: dict[str, str]
    size: tuple[float, float] = (280.0, 280.0)


@dataclass(frozen=True)
class Shown:
    """What a picture shows: plans, metres from the ground to its top, where its front looks."""

    shapes: NDArray[Any]
    height: float
    front: float | None
    most: float = MOST_SHOWN

    @property
    def box(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """South-west and north-east corners of what of it fits in a picture."""
        ends = np.array(shapely.total_bounds(self.shapes))
        middle = (ends[:2] + ends[2:]) / 2
        half = np.clip((ends[2:] - ends[:2]) / 2, 0.0, self.most)
        if math.hypot(*half) < LEAST:
            half = np.full(2, LEAST / math.sqrt(2))
        return middle - half, middle + half


TOWNS = [
    Town(**{**row, "size": tuple(row.get("size", Town.size))})
    for row in tomllib.loads((Path(__file__).parent / "scenes.toml").read_text())["town"]
]
SCENES = {name: show for town in TOWNS for name, show in town.shows.items()}


def element_in(city: City, kind: str, *, made: bool = False) -> Shown | None:
    """Return the element of a kind that was made for a city, or one that it had before, if any.

    Parameters
    ----------
    made
        Whether only one that was made counts: a factory counts as a warehouse.
    """
    layout = city.layout
    first = f"made/{kind}/0"
    word = OF_LINES.get(kind, "")
    own = [
        table[table["source"].str.startswith(f"{first}/{word}" if word else first)]
        for table in (layout.buildings, layout.points, layout.areas)
    ]
    if word:
        own = [table.iloc[len(table) // 2 :][:1] for table in own]
    plans = [table.geometry.to_numpy() for table in own]
    whole = kind in LANDS or not any(map(len, plans[:2]))
    shapes = np.concatenate(plans if whole else plans[: 1 if len(plans[0]) else 2])
    if not len(shapes) and not made:  # the town had one before it was asked for
        shapes = shapes_of(city, kind)[:1]
    if not len(shapes):
        return None
    height = max([*own[0]["height"], *_tops(city, own[1]["id"].to_numpy()), 2.0])
    middle = shapely.centroid(shapely.union_all(shapes))
    roads = layout.roads[layout.roads["kind"].isin(DRIVABLE)].geometry.to_numpy()
    ways = shapely.shortest_line(middle, roads)
    nearest = np.diff(shapely.get_coordinates(ways[int(np.argmin(shapely.length(ways)))]), axis=0)
    return Shown(shapes, height, math.atan2(*nearest[0]) if len(own[0]) else None)


def scene_in(city: City, show: str) -> Shown | None:
    """Return the largest of the things that words choose, if there is one, or the whole site."""
    if not show:
        return Shown(
            np.array([shapely.buffer(shapely.box(*city.layout.extent), -30.0)]), 2.0, None, math.inf
        )
    shapes = things_of(show, city).shapes
    order = np.argsort(-(shapely.area(shapes) + shapely.length(shapes)), kind="stable")
    if not len(order):
        return None
    largest = shapes[order[0]]
    if largest.geom_type == "LineString":
        largest = largest.interpolate(0.5, normalized=True)
    if largest.geom_type == "Point":
        largest = shapely.buffer(largest, ROUND)
    return Shown(np.array([largest]), 2.0, None)


def _tops(city: City, ids: NDArray[np.uint64]) -> list[float]:
    """Return the heights of things, metres."""
    found = [0.0]
    for rows in city.scene.instances.values():
        for k in np.flatnonzero(np.isin(rows.object_id, ids)).tolist():
            mesh = city.scene.prototypes[rows.prototype[k]].mesh
            found.append(float(mesh.vertices[:, 2].max() * rows.scale[k, 2]))
    return found


@dataclass(frozen=True)
class Obstacles:
    """Plans of what may stand before a lens, and the heights of their tops."""

    tree: shapely.STRtree
    tops: NDArray[np.float64]

    def hidden(self, eye: NDArray[Any], spots: NDArray[Any], own: NDArray[Any]) -> float:
        """Return the share of (n, 3) spots that something else stands before."""
        along = np.linspace(0.0, 0.97, STEPS)[:, None, None]
        ways = (eye + along * (spots - eye)).reshape(-1, 3)
        at, of = self.tree.query(shapely.points(ways[:, :2]), predicate="intersects")
        hit = (ways[at, 2] < self.tops[of]) & ~np.isin(of, own)
        return len(np.unique(at[hit] % len(spots))) / len(spots)


def obstacles(city: City) -> Obstacles:
    """Return the buildings, trees and vehicles of a city as obstacles."""
    buildings = city.layout.buildings
    shapes, heights = [buildings.geometry.to_numpy()], [buildings["height"].to_numpy(float)]
    boxes = np.array([np.ptp(p.mesh.vertices, axis=0) if len(p.mesh.vertices) else np.zeros(3)
                      for p in city.scene.prototypes])  # fmt: skip
    for group, reach in (("trees", 0.5), ("vehicles", 0.3)):  # of their width or length
        rows = city.scene.instances.get(group)
        if rows is not None and rows.count:
            size = boxes[rows.prototype] * rows.scale
            width = reach * size[:, :2].max(axis=1)
            shapes.append(shapely.buffer(shapely.points(rows.position[:, :2]), width))
            heights.append(size[:, 2])
    plans = np.concatenate(shapes)
    ground = city.terrain.height_at(shapely.get_coordinates(shapely.centroid(plans)))
    return Obstacles(shapely.STRtree(plans), ground + np.concatenate(heights))


def camera_of(city: City, name: str, shown: Shown) -> Camera:
    """Return the camera that sees most of something, rather its front, and its side in the sun."""
    low, high = shown.box
    middle = (low + high) / 2
    ground = float(city.terrain.height_at(middle[None])[0])
    seen = shapely.intersection(shown.shapes, shapely.box(*low, *high))
    spots = _spots(city, seen if not shapely.is_empty(seen).all() else shown.shapes, shown.height)
    centre = np.array([*middle, ground + 0.45 * shown.height])
    corners = np.array(list(itertools.product(*zip(low, high, strict=True),
                                              (ground, ground + shown.height))))  # fmt: skip
    stands = obstacles(city)
    plan = shapely.buffer(shapely.union_all(shown.shapes), 0.5)
    own = stands.tree.query(plan, predicate="contains")
    whole = math.isinf(shown.most)  # the form of land is seen from low
    suits = LOW if whole else HIGH if shown.height > 0.3 * math.hypot(*(high - low)) / 2 else FLAT
    best, found = -math.inf, None
    for turn, pitch in itertools.product(TURNS.tolist(), PITCHES.tolist()):
        back = np.array([math.sin(turn) * math.cos(pitch), math.cos(turn) * math.cos(pitch),
                         math.sin(pitch)])  # fmt: skip
        eye = centre + _distance(corners - centre, turn, pitch) * back
        worth = -stands.hidden(eye, spots, own) - 0.5 * abs(pitch - suits)
        worth += 0.08 * math.cos(turn - city.environment.sun_azimuth)
        if shown.front is not None:
            worth += 0.25 * math.cos(turn - shown.front)
        above = eye[2] - float(city.terrain.height_at(eye[None, :2])[0])
        inside = stands.hidden(eye, eye[None], own[:0])
        if above > 2.0 and not inside and worth > best + 1e-6:
            best = worth
            heading = (turn + math.pi) % (2 * math.pi)
            found = Camera(name, tuple(eye.tolist()), heading, -pitch, FIELD, *RENDERED)
    assert found is not None
    return found


def _spots(city: City, shapes: NDArray[Any], height: float) -> NDArray[np.float64]:
    """Return (n, 3) points of something, low and high."""
    whole = shapely.union_all(shapes)
    plan = [shapely.get_coordinates(shapely.centroid(whole)),
            shapely.get_coordinates(shapely.segmentize(whole, 8.0))]  # fmt: skip
    at = np.concatenate(plan)
    at = at[:: max(len(at) // 40, 1)]
    z = city.terrain.height_at(at)
    levels = [np.column_stack([at, z + share * height]) for share in (0.15, 0.55, 1.0)]
    return np.concatenate(levels)


def _distance(corners: NDArray[Any], turn: float, pitch: float) -> float:
    """Return the metres from which a camera has corners in its picture."""
    right = np.array([-math.cos(turn), math.sin(turn), 0.0])
    ahead = -np.array([math.sin(turn) * math.cos(pitch), math.cos(turn) * math.cos(pitch),
                       math.sin(pitch)])  # fmt: skip
    up = np.cross(right, ahead)
    wide = FILLED * math.tan(FIELD / 2)
    tall = wide * RENDERED[1] / RENDERED[0]
    away = np.maximum(abs(corners @ right) / wide, abs(corners @ up) / tall) - corners @ ahead
    return float(max(away.max(), 10.0))


def batches(kinds: Sequence[str]) -> Iterator[list[str]]:
    """Yield the elements of each town, large and small ones together."""
    order = sorted(kinds, key=lambda kind: (-ELEMENTS[kind].area, kind))
    at_sea = [kind for kind in order if ELEMENTS[kind].where in ("shore", "water")]
    order = [kind for kind in order if kind not in at_sea]
    if at_sea:
        yield at_sea
    count = max(math.ceil(sum(ELEMENTS[kind].area for kind in order) / TOGETHER),
                math.ceil(len(order) / MOST))  # fmt: skip
    yield from (order[k::count] for k in range(count))


def sheet(pictures: dict[str, Path], out: Path) -> None:
    """Put pictures with their names on one sheet."""
    rows = math.ceil(len(pictures) / COLUMNS)
    wide, high = CELL[0] + GAP, CELL[1] + TITLE + GAP
    page = Image.new("RGB", (COLUMNS * wide + GAP, rows * high + GAP), "white")
    draw, font = ImageDraw.Draw(page), ImageFont.load_default(12)
    for at, (kind, path) in enumerate(pictures.items()):
        x, y = GAP + at % COLUMNS * wide, GAP + at // COLUMNS * high
        page.paste(Image.open(path).convert("RGB").resize(CELL, Image.Resampling.LANCZOS), (x, y))
        draw.text((x + 2, y + CELL[1] + 1), kind.replace("_", " "), "black", font)
    page.quantize(256).save(out, optimize=True)


def pictures_of(
    text: str, size: tuple[float, float], names: Sequence[str], work: Path, samples: int
) -> dict[str, Path]:
    """Build a town and take a picture of each thing that it has; pictures of before are kept."""
    shots = {name: work / f"{name}.png" for name in names}
    missing = [name for name, path in shots.items() if not path.exists()]
    if not missing:
        return shots
    options = BuildOptions(text=text, formats=(), render=False, size=size, seed=3)
    folder = work / f"town_of_{names[0]}"
    report = build([], folder, options)
    print(text, *(goal["goal"] for goal in report["goals"] if goal["met"] is not True), sep="\n  ")
    city = read_city(folder / "city")
    renders = []
    for name in missing:
        if name in SCENES:
            shown = scene_in(city, SCENES[name])
        else:
            shown = element_in(city, name, made=len(names) > 1)
        if shown is not None:
            renders.append(RenderRequest(camera_of(city, name, shown), shots[name], samples))
    if renders:
        job = BlenderJob(folder / "city", renders=tuple(renders))
        run_worker(job, timeout_s=TIMEOUT_S, progress=lambda *_: None)
    return {name: path for name, path in shots.items() if path.exists()}


def elements_of(kinds: Sequence[str], work: Path, samples: int) -> dict[str, Path]:
    """Take the pictures of elements in one town, and in towns of their own where it had no room."""
    words = ", ".join(f"one {NAMES[kind].split(',')[0].strip()}" for kind in kinds)
    town = "harbour" if ELEMENTS[kinds[0]].where in ("shore", "water") else "town"
    found = pictures_of(f"A {town} with {words}", SITE, kinds, work, samples)
    for kind in kinds:
        if kind not in found and len(kinds) > 1:
            found |= elements_of([kind], work, samples)
    return found


def main() -> None:
    """Build the towns, take the pictures and write the sheet."""
    every = [*ELEMENTS, *SCENES]
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-o", "--out", type=Path, default=Path("elements.png"))
    parser.add_argument("--samples", type=int, default=20)
    parser.add_argument("--only", nargs="*", default=every, choices=every)
    parser.add_argument("--work", type=Path, help="keeps pictures, and those of before")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as held:
        work = args.work or Path(held)
        found: dict[str, Path] = {}
        for kinds in batches([name for name in args.only if name in ELEMENTS]):
            found |= elements_of(kinds, work, args.samples)
        for town in TOWNS:
            names = [name for name in town.shows if name in args.only]
            if names:
                found |= pictures_of(town.text, town.size, names, work, args.samples)
        sheet({name: found[name] for name in every if name in found}, args.out)


if __name__ == "__main__":
    main()
