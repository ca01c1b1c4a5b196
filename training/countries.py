"""Make the boundaries of countries that `cityx.places.lookup` reads from Natural Earth's map.

The input is ``countries-10m.json`` of the npm package ``world-atlas`` (Natural Earth 1:10m,
public domain; the TopoJSON is ISC); codes come from ``pycountry``::

    npm pack world-atlas@2.0.2 && tar xzf world-atlas-2.0.2.tgz
    pip install pycountry
    python training/countries.py package/countries-10m.json cityx/data/places/countries.npz

Borders on land keep every point; coasts are simplified, since a place at sea takes the nearest
country anyway.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pycountry
import shapely
from numpy.typing import NDArray

POLE = -84.0  # degrees; the edge of the map below Antarctica runs round the Earth
COAST = 0.012  # degrees by which coasts may move, 1.3 km
LONGEST = 30.0  # degrees of a step, which fits 16 bits
QUANTUM = 1e-3  # degrees; the map's own grid is 0.0036 by 0.0017
# Names without an ISO code -> whose streets they have. Others are uninhabited, or kept as they are.
UNCODED = {
    "Dhekelia": "CY", "Akrotiri": "CY", "Cyprus U.N. Buffer Zone": "CY", "N. Cyprus": "CY",
    "Somaliland": "SO", "Kosovo": "XK", "USNB Guantanamo Bay": "US", "Baikonur": "KZ",
    "Siachen Glacier": "IN", "Indian Ocean Ter.": "AU", "Coral Sea Is.": "AU",
    "Clipperton I.": "FR",
}  # fmt: skip


def code_of(shape: dict[str, Any]) -> str:
    """Return the ISO 3166-1 alpha-2 code of a country of the map, or ""."""
    name = shape["properties"]["name"]
    if name in UNCODED or "id" not in shape:
        return UNCODED.get(name, "")
    return str(pycountry.countries.get(numeric=shape["id"]).alpha_2)


def rings_of(shape: dict[str, Any]) -> list[list[int]]:
    """Return the rings of a country, each a list of arcs."""
    nested = shape.get("arcs", [])
    polygons = nested if shape["type"] == "MultiPolygon" else [nested]
    return [ring for polygon in polygons for ring in polygon]


def cut_at_180(arc: NDArray[np.float64]) -> Iterator[NDArray[np.float64]]:
    """Cut an arc, (n, 2) degrees, where it crosses the antimeridian."""
    step = np.diff(arc[:, 0])
    begin, done = np.zeros((0, 2)), 0
    for at in np.flatnonzero((np.abs(step) > 180.0) & (arc[:-1, 1] > POLE)).tolist():
        (x0, y0), (x1, y1) = arc[at], arc[at + 1]
        edge = np.copysign(180.0, x0)
        whole = 360.0 - abs(x1 - x0)
        y = y0 + (y1 - y0) * (abs(edge - x0) / whole if whole else 0.0)
        yield np.vstack([begin, arc[done : at + 1], (edge, y)])
        begin, done = np.array([(-edge, y)]), at + 1
    yield np.vstack([begin, arc[done:]])


def main(source: Path, target: Path) -> None:
    """Read the map and write the table."""
    given = json.loads(source.read_text())
    scale, shift = (np.array(given["transform"][key]) for key in ("scale", "translate"))
    arcs = [np.cumsum(arc, axis=0) * scale + shift for arc in given["arcs"]]
    shapes = [(code_of(shape), shape) for shape in given["objects"]["countries"]["geometries"]]
    codes = sorted({code for code, _ in shapes} - {""})
    sides = np.full((len(arcs), 2), -1, np.int16)  # countries on the left and on the right
    for code, shape in shapes:
        for arc in (arc for ring in rings_of(shape) for arc in ring if code):
            # Rings of the map run clockwise and holes against it: land lies on the right.
            sides[max(arc, ~arc), int(arc >= 0)] = codes.index(code)
    chosen = np.flatnonzero(sides[:, 0] != sides[:, 1])
    coast = (sides < 0).any(axis=1)
    lines, kept = [], []
    for row in chosen.tolist():
        for piece in cut_at_180(arcs[row]):
            line = shapely.LineString(piece)
            if line.length == 0.0:
                continue  # an island smaller than the map's grid
            line = line.simplify(COAST * coast[row]) if line.length > COAST else line
            lines.append(shapely.get_coordinates(shapely.segmentize(line, LONGEST)))
            kept.append(row)
    points = [np.round(line / QUANTUM).astype(np.int32) for line in lines]
    steps = np.concatenate([np.diff(line, axis=0) for line in points])
    np.savez_compressed(
        target,
        codes=np.array(codes),
        sides=sides[kept],
        quantum=np.array(QUANTUM),
        # Lines by their first points, numbers of points and steps from one to the next.
        first=np.array([line[0] for line in points]),
        count=np.array([len(line) for line in points]),
        east=steps[:, 0].astype(np.int16),
        north=steps[:, 1].astype(np.int16),
    )


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("source", type=Path)
    parser.add_argument("target", type=Path)
    options = parser.parse_args()
    main(options.source, options.target)
