"""Tilesets: where on Earth the tiles of a run lie, and which of their files are seen from where.

A tile has a tileset of its own whose transform puts it on the ellipsoid, so that a flat tile misses
the curved Earth by centimetres; that of the run refers to them.

References
----------
OGC 22-025r4, "3D Tiles Specification 1.1", 2023.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from cityx.city import Frame
from cityx.geometry.arrays import FloatArray
from cityx.tiles.grid import Tile
from cityx.version import __version__

NAME = "tileset.json"
RADIUS, SQUARED = 6378137.0, 6.69437999014e-3  # WGS 84: half the great axis, squared eccentricity
ARM = 100.0  # metres over which the directions of the frame are measured
FAR = 4.0  # times its size: the error of what shows nothing of a tile
PADDING = 0.01  # metres round what is shown, for the steps that vertices count in


@dataclass(frozen=True)
class Seen:
    """A file of a tile.

    Attributes
    ----------
    uri
        Of the file.
    box
        (2, 3) metres of the frame.
    error
        Metres by which it differs from what stands for it nearer by.
    within
        What that is.
    """

    uri: str
    box: FloatArray
    error: float = 0.0
    within: tuple[Seen, ...] = ()

    @property
    def around(self) -> FloatArray:
        """(2, 3) the box with those of what is within."""
        boxes = [self.box, *(one.around for one in self.within)]
        return np.array([np.min([b[0] for b in boxes], axis=0),
                         np.max([b[1] for b in boxes], axis=0)])  # fmt: skip


def tile_tileset(
    frame: Frame | None, centre: FloatArray, seen: Sequence[Seen], attribution: Sequence[str],
    size: float, *, datum: float = 0.0,
) -> dict[str, Any]:  # fmt: skip
    """Return the tileset of a tile.

    Parameters
    ----------
    frame
        Of the boxes; None where they have no place on Earth of their own.
    centre
        (3,) metres, the origin of its files.
    seen
        What is seen from afar. One file with all others within is the root; several lie side by
        side in a root that shows nothing.
    datum
        Metres above sea level of height zero; the sea is taken to lie on the ellipsoid.
    """
    if len(seen) == 1 and seen[0].within:
        root = _node(seen[0], centre)
    else:
        boxes = [one.around for one in seen]
        whole = np.array([np.min([b[0] for b in boxes], axis=0),
                          np.max([b[1] for b in boxes], axis=0)])  # fmt: skip
        root = {
            "boundingVolume": _volume(whole, centre), "geometricError": FAR * size,
            "children": [_node(one, centre) for one in seen],
        }  # fmt: skip
    root["refine"] = "REPLACE"
    if frame is not None:
        root["transform"] = transform_of(frame, centre, datum)
    return _document(root, FAR * size, attribution)


def _node(seen: Seen, centre: FloatArray) -> dict[str, Any]:
    node = {
        "boundingVolume": _volume(seen.around, centre), "geometricError": round(seen.error, 2),
        "content": {"uri": seen.uri},
    }  # fmt: skip
    if seen.within:
        node["children"] = [_node(one, centre) for one in seen.within]
    return node


def merged_tileset(
    frame: Frame, tiles: Mapping[Tile, Mapping[str, Any]], attribution: Iterable[str], size: float,
    *, datum: float = 0.0,
) -> dict[str, Any]:  # fmt: skip
    """Return the tileset of a run.

    Parameters
    ----------
    tiles
        Record of each tile, of which "box" counts: its bounds in the frame.
    datum
        As of `tile_tileset`.
    """
    boxes = np.array([record["box"] for record in tiles.values()], float).reshape(-1, 2, 3)
    boxes[:, :, 2] += datum
    low, high = boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)
    region = _region(frame, np.array([low, high]))
    children = [
        {
            "boundingVolume": {"region": _region(frame, box)},
            "geometricError": FAR * size,
            "content": {"uri": f"tiles/{tile.name}/{NAME}"},
        }
        for tile, box in zip(tiles, boxes, strict=True)
    ]
    across = float(np.hypot(*(high - low)[:2]))
    root = {
        "boundingVolume": {"region": region}, "geometricError": FAR * across, "refine": "REPLACE",
        "children": children,
    }  # fmt: skip
    return _document(root, FAR * across, sorted(set(attribution)))


def plane_tileset(
    frame: Frame, tiles: Mapping[Tile, Mapping[str, Any]], size: float
) -> dict[str, Any]:
    """Return the tileset of tiles of the plane: a flat one that touches the Earth.

    The south-western corner of all its tiles lies on the origin of the frame. Distances between
    tiles are those of the plane, however far apart they are.

    Parameters
    ----------
    tiles
        Record of each tile, of which "box", bounds in the frame of the tile, and "origin" count.
    """
    first = np.array([[tile.column, tile.row] for tile in tiles]).min(axis=0)
    children, boxes = [], []
    for tile, record in tiles.items():
        steps = np.array([tile.column, tile.row]) - first
        place = np.array([*((steps + 0.5) * size).tolist(), 0.0])
        middle = (np.array([tile.column, tile.row]) + 0.5) * size - record["origin"]
        own = np.array(record["box"], float) - np.append(middle, 0.0)
        boxes.append(own + place)
        children.append({
            "boundingVolume": _volume(own, np.zeros(3)),
            "geometricError": FAR * size,
            "transform": [float(v) for v in (1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, *place, 1)],
            "content": {"uri": f"tiles/{tile.name}/{NAME}"},
        })  # fmt: skip
    whole = np.array([np.min([b[0] for b in boxes], axis=0), np.max([b[1] for b in boxes], axis=0)])
    across = float(np.hypot(*(whole[1] - whole[0])[:2]))
    root = {
        "boundingVolume": _volume(whole, np.zeros(3)), "geometricError": FAR * across,
        "refine": "REPLACE", "transform": transform_of(frame, np.zeros(3)), "children": children,
    }  # fmt: skip
    return _document(root, FAR * across, ())


def _document(root: dict[str, Any], error: float, attribution: Sequence[str]) -> dict[str, Any]:
    asset: dict[str, Any] = {"version": "1.1", "extras": {"generator": f"CityX {__version__}"}}
    if attribution:
        asset["copyright"] = "; ".join(attribution)
    return {"asset": asset, "geometricError": max(error, root["geometricError"]), "root": root}


def _volume(box: FloatArray, centre: FloatArray) -> dict[str, Any]:
    low, high = box[0] - PADDING, box[1] + PADDING
    middle, half = (low + high) / 2 - centre, (high - low) / 2
    axes = np.diag(half)
    return {"box": [round(float(v), 3) + 0.0 for v in (*middle, *axes.ravel())]}


def _region(frame: Frame, box: FloatArray) -> list[float]:
    """Return west, south, east, north in radians, and least and greatest height in metres."""
    x, y = np.meshgrid(*np.linspace(box[0, :2], box[1, :2], 5).T)
    lonlat = np.radians(frame.to_geographic(np.column_stack([x.ravel(), y.ravel()])))
    low, high = lonlat.min(axis=0), lonlat.max(axis=0)
    # A flat tile leaves the ellipsoid by so much at its rim.
    bend = float(((box[1] - box[0])[:2] ** 2).sum()) / (2 * RADIUS)
    spare = 1e-7  # radians, half a metre
    degrees = [*(low - spare).tolist(), *(high + spare).tolist()]
    return [*(round(v, 12) for v in degrees), round(float(box[0, 2]) - 1.0, 2),
            round(float(box[1, 2]) + bend + 1.0, 2)]  # fmt: skip


def transform_of(frame: Frame, centre: FloatArray, datum: float = 0.0) -> list[float]:
    """Return the 4 x 4 matrix, column by column, from metres about a centre to places on Earth.

    The axes are those of the frame, whose north is not that of the meridian away from its origin.
    """
    arms = centre[:2] + np.array([[0.0, 0.0], [ARM, 0.0], [0.0, ARM]])
    origin, east, north = earth_centred(frame.to_geographic(arms), centre[2] + datum)
    x = (east - origin) / np.linalg.norm(east - origin)
    y = north - origin
    y = y - x * (x @ y)
    y /= np.linalg.norm(y)
    axes = [(*axis.tolist(), 0.0) for axis in (x, y, np.cross(x, y))]
    return [round(v, 12) for axis in axes for v in axis] + [*np.round(origin, 4).tolist(), 1.0]


def earth_centred(lonlat: FloatArray, height: float) -> FloatArray:
    """Return (n, 3) metres from the middle of the Earth of (n, 2) degrees and a height."""
    longitude, latitude = np.radians(lonlat).T
    normal = RADIUS / np.sqrt(1 - SQUARED * np.sin(latitude) ** 2)
    across = (normal + height) * np.cos(latitude)
    up = (normal * (1 - SQUARED) + height) * np.sin(latitude)
    return np.column_stack([across * np.cos(longitude), across * np.sin(longitude), up])


def write_tileset(document: Mapping[str, Any], path: Path) -> None:
    """Write a tileset."""
    path.write_text(json.dumps(document, separators=(",", ":"), ensure_ascii=False) + "\n")
