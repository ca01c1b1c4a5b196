"""Base scenes: small towns drawn from tables, to be changed by the tasks that start from one.

A scene is a drawing, so it is built as any other drawing is, by the normal actions. What a scene
holds is fixed by the hash of its layout; what the actions make of it may change with them.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import pairwise, product
from pathlib import Path
from types import MappingProxyType
from typing import Any

import shapely

from cityx.city import Frame
from cityx.sources.features.tagged import KIND, Tags

EMPTY = "empty"
LOD = 2  # of every scene: the lowest that has the cars and lamps which tasks are about
FRAME = Frame(48.2, 16.3)  # where the scenes lie; any place whose traffic keeps to the right
Box = tuple[float, float, float, float]


@dataclass(frozen=True)
class Thing:
    """Something that is drawn: what it is called, its tags, its shape in metres."""

    name: str
    tags: Tags
    shape: Any


@dataclass(frozen=True)
class Scene:
    """A base scene.

    Attributes
    ----------
    extent
        (xmin, ymin, xmax, ymax), metres.
    draw
        Returns what is in it.
    time, weather
        As of `cityx build`.
    layout
        Hash of its layout, which must not change unnoticed.
    settings
        As of `cityx build --set`.
    """

    extent: Box
    draw: Callable[[], list[Thing]]
    time: str
    weather: str
    layout: str
    settings: tuple[str, ...] = ()


def house(name: str, box: Box, levels: int, **tags: str) -> Thing:
    """Return a rectangular building."""
    said = {"building": "apartments", "building:levels": str(levels), "name": name, **tags}
    return Thing(name, said, shapely.box(*box))


def street(name: str, kind: str, points: list[tuple[float, float]], **tags: str) -> Thing:
    """Return a street along points; nobody parks in it unless a tag says so."""
    parked = {} if "parking:both" in tags else {"parking:both": "no"}
    line = shapely.LineString(points)
    return Thing(name, {"highway": kind, "name": name, **parked, **tags}, line)


def crossing_streets(
    xs: list[float], ys: list[float], extent: Box, kinds: Mapping[str, str], **tags: str
) -> list[Thing]:
    """Return streets from border to border, west to east at `ys` and south to north at `xs`.

    They share a point wherever they cross; `kinds` holds those that are not residential.
    """
    west, south, east, north = extent
    along = {f"x{i + 1}": [(x, y) for y in sorted({south, *ys, north})] for i, x in enumerate(xs)}
    along |= {f"y{i + 1}": [(x, y) for x in sorted({west, *xs, east})] for i, y in enumerate(ys)}
    return [street(name, kinds.get(name, "residential"), points, **tags)
            for name, points in along.items()]  # fmt: skip


# -- grid_s: 16 blocks, each with a street to its west and one to its south ------------------------
_GRID: Box = (-200.0, -200.0, 200.0, 200.0)
_LINES = [-192.0, -95.0, 2.0, 99.0]  # metres; what is left in the east and north is a last block
_PLOTS: tuple[Box, ...] = ((12, 12, 42, 40), (52, 12, 82, 40), (12, 58, 82, 82))  # in a block
_TREES = ((18.0, 49.0), (37.0, 49.0), (57.0, 49.0), (76.0, 49.0))  # in its court
_FOUR_TREES = 12  # blocks with four trees, the others have three: 60


def _grid_levels(number: int) -> int:
    """Return the storeys of the n-th building: 3 to 12, and three towers of 16, 18 and 20."""
    return {5: 20, 22: 18, 40: 16}.get(number, 3 + (number * number + 3 * number) % 10)


def _grid() -> list[Thing]:
    things = crossing_streets(_LINES, _LINES, _GRID, {"y2": "primary", "x3": "secondary"})
    number = 0
    for block, (x, y) in enumerate(product(_LINES, _LINES)):
        for left, low, right, high in _PLOTS:
            number += 1
            box = (x + left, y + low, x + right, y + high)
            things.append(
                house(f"b{number:02d}", box, _grid_levels(number),
                      **{"building:material": "concrete", "roof:shape": "flat"})
            )  # fmt: skip
        for place, (dx, dy) in enumerate(_TREES[: 4 if block < _FOUR_TREES else 3]):
            name = f"t{block + 1:02d}_{place + 1}"
            things.append(Thing(name, {"natural": "tree"}, shapely.Point(x + dx, y + dy)))
    return things


# -- river_s: two banks, joined by two bridges -----------------------------------------------------
_RIVER: Box = (-300.0, -200.0, 300.0, 200.0)
_WATER = 16.0  # metres from the middle of the river to its edge
_HEADS = 30.0  # metres from it to the ends of the bridges
_CROSSINGS = (-120.0, 120.0)
_ROWS = (45.0, 130.0)  # metres from the river to the rows of houses
_STREET = 100.0  # and to the street of each bank


def _river() -> list[Thing]:
    west, south, east, north = _RIVER
    things = [Thing("river", {KIND: "river", "name": "river"},
                    shapely.box(west, -_WATER, east, _WATER))]  # fmt: skip
    for number, x in enumerate(_CROSSINGS, start=1):
        things.append(
            street(f"bridge{number}", "secondary", [(x, -_HEADS), (x, _HEADS)],
                   bridge="yes", layer="1")
        )  # fmt: skip
        ends = [(south, -_STREET), (-_STREET, -_HEADS), (_HEADS, _STREET), (_STREET, north)]
        things += [
            street(f"way{number}{part}", "secondary", [(x, low), (x, high)])
            for part, (low, high) in zip("abcd", ends, strict=True)
        ]
    for bank, y in (("south", -_STREET), ("north", _STREET)):
        points = [(x, y) for x in (west, *_CROSSINGS, east)]
        things.append(street(f"{bank} street", "residential", points, **{"parking:both": "lane"}))
    places = [x for low, high in pairwise((west, *_CROSSINGS, east)) for x in _between(low, high)]
    for number, (side, depth, x) in enumerate(product((1, -1), _ROWS, places), start=1):
        low, high = sorted((side * depth, side * (depth + 26.0)))
        things.append(house(f"b{number:02d}", (x - 12.0, low, x + 12.0, high), 3 + number % 4))
    return things


def _between(west: float, east: float) -> list[float]:
    """Return where houses stand between two streets: four in the middle, three beside it."""
    count = 4 if west < 0 < east else 3
    step = (east - west - 30.0) / count
    return [west + 15.0 + step * (place + 0.5) for place in range(count)]


# -- park_s: a park with a path around it, a plaza -------------------------------------------------
_PARK: Box = (-150.0, -150.0, 150.0, 150.0)
_GREEN: Box = (-60.0, -60.0, 60.0, 60.0)
_LOOP = 45.0  # metres from the middle of the park to the path around it
_STREETS = [-80.0, 80.0]


def _park() -> list[Thing]:
    ring = shapely.Point(0, 0).buffer(_LOOP, quad_segs=8).exterior
    things = crossing_streets(_STREETS, _STREETS, _PARK, {})
    things += [
        Thing("park1", {"leisure": "park", "name": "park1"}, shapely.box(*_GREEN)),
        Thing("loop1", {"highway": "footway", "name": "loop1"}, shapely.LineString(ring.coords)),
        Thing("plaza1", {"highway": "pedestrian", "area": "yes", "name": "plaza1"},
              shapely.box(96.0, -50.0, 140.0, 50.0)),
    ]  # fmt: skip
    rim = [(x, y) for x, y in product((-120.0, -50.0, -16.0, 18.0, 52.0, 120.0), (-118.0, 118.0))]
    rim += [(-118.0, y) for y in (-60.0, -20.0, 20.0, 60.0)]
    rim += [(x, y) for x, y in product((-124.0, 124.0), (-96.0, 96.0))]
    corners = {(-120.0, -118.0), (-120.0, 118.0), (120.0, -118.0), (120.0, 118.0)}
    for number, (x, y) in enumerate(rim, start=1):
        half = 9.0 if (x, y) in corners or abs(x) == 124.0 else 13.0
        box = (x - half, y - half, x + half, y + half)
        things.append(house(f"b{number:02d}", box, 2 + number % 4))
    return things


_TREES_AS_DRAWN = ("trees.street_trees=false", "trees.budget=0")
_NO_CARS = ("parked_cars.occupancy=0", "parked_cars.lots=0")
_THIRTY_CARS = ("parked_cars.occupancy=0.08375",)
SCENES: Mapping[str, Scene] = MappingProxyType(
    {
        "grid_s": Scene(
            _GRID, _grid, "noon", "clear",
            "f47dcaede001ce18c32028d2c12d9fd15a181efd3083270cb2c0630a6869f675",
            (*_TREES_AS_DRAWN, *_NO_CARS),
        ),
        "river_s": Scene(
            _RIVER, _river, "noon", "overcast",
            "eef2aed24a78bd32a464cb73efdd24ca725ef16f8b837366cc68144f7c0af2e7",
            _THIRTY_CARS,
        ),
        "park_s": Scene(
            _PARK, _park, "15:00", "clear",
            "0754afb3201bee75ea9d671f59acbe623148ca2e8cd3e739f16c1619b2116525",
        ),
    }
)  # fmt: skip


def write_drawing(
    things: list[Thing], extent: Box, path: Path, frame: Frame | None = FRAME
) -> Path:
    """Write a drawing in metres, with its border.

    Parameters
    ----------
    things
        What is drawn, scene frame.
    extent
        The site.
    path
        .geojson.
    frame
        Where the scene lies, None for nowhere.
    """
    border = Thing("border", {"kind": "boundary"}, shapely.box(*extent))
    features = [
        {"type": "Feature", "id": thing.name, "properties": thing.tags,
         "geometry": json.loads(shapely.to_geojson(thing.shape))}
        for thing in (*things, border)
    ]  # fmt: skip
    document: dict[str, Any] = {
        "type": "FeatureCollection", "units": "metres", "features": features,
    }  # fmt: skip
    if frame is not None:
        document["origin"] = {"latitude": frame.latitude, "longitude": frame.longitude}
    path.write_text(json.dumps(document), encoding="utf-8")
    return path
