"""What a city holds, as values of the fourteen formats: the sources that ports are filled from."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely

from cityx.city.layout import CURVE
from cityx.geometry.polylines import traced
from cityx.protocol.formats import Format
from cityx.protocol.values import (
    Image,
    LinearColor,
    Lines,
    Points,
    Surfaces,
    make_lines,
    make_points,
    make_surfaces,
)

if TYPE_CHECKING:
    from pathlib import Path

    from cityx.city.city import City
    from cityx.protocol.input_files import InputFiles

Node = tuple[Format, str]  # a format and the role of what carries it


def _roads(city: City) -> Lines:
    rows = city.layout.roads
    return make_lines(
        rows.geometry.to_numpy(),
        rows["kind"].to_numpy(str),
        rows["width"].to_numpy(float),
        rows["id"].to_numpy(np.uint64),
    )


def _lines(*, curves: bool) -> Callable[[City], Lines]:
    def read(city: City) -> Lines:
        rows = city.layout.lines
        rows = rows[(rows["kind"] == CURVE) == curves]
        ids = rows["id"].to_numpy(np.uint64)
        shapes = traced(rows.geometry.to_numpy())
        return make_lines(shapes, rows["kind"].to_numpy(str), object_id=ids)

    return read


def _edges(city: City) -> Lines:
    network = city.network
    if network is None:
        return make_lines([])
    part = np.repeat(np.arange(network.edge_count), np.diff(network.point_start))
    lines = shapely.linestrings(network.points, indices=part)
    kinds = city.layout.roads["kind"].to_numpy(str)[network.edge_road]
    return make_lines(lines, kinds, 2 * network.half_width, network.edge_id)


def _surfaces(table: str, kind: str, height: str) -> Callable[[City], Surfaces]:
    def read(city: City) -> Surfaces:
        rows = getattr(city.layout, table)
        heights = rows[height].to_numpy(float) if height else np.nan
        kinds = rows[kind].to_numpy(str)
        return make_surfaces(
            rows.geometry.to_numpy(), kinds, heights, rows["id"].to_numpy(np.uint64)
        )

    return read


def _points(city: City) -> Points:
    rows = city.layout.points
    xy = shapely.get_coordinates(rows.geometry.to_numpy())
    z = city.terrain.height_at(xy)
    return make_points(np.column_stack([xy, z]), rows["kind"].to_numpy(str))


# Role to how a city yields it. A table without rows is a value too: there is nothing to do.
_HOLDINGS: Mapping[Node, Callable[[City], Any]] = MappingProxyType(
    {
        (Format.SCENE_LAYOUT, "layout"): lambda city: city.layout,
        (Format.LINE, "road_centerline"): _roads,
        (Format.LINE, "road_network"): _edges,
        (Format.LINE, "barrier"): _lines(curves=False),
        (Format.LINE, "curve"): _lines(curves=True),
        (Format.SURFACE, "building_footprint"): _surfaces("buildings", "use", "height"),
        (Format.SURFACE, "building_part"): _surfaces("parts", "use", "top"),
        (Format.SURFACE, "area"): _surfaces("areas", "kind", ""),
        (Format.POINT, "thing"): _points,
    }
)
_NEEDS: Mapping[Node, Callable[[City], bool]] = MappingProxyType(
    {
        (Format.LINE, "road_network"): lambda city: city.network is not None,
        (Format.LINE, "curve"): lambda city: bool((city.layout.lines["kind"] == CURVE).any()),
        (Format.SURFACE, "ground"): lambda city: city.ground is not None,
    }
)


# What every city with a layout yields, as (format, role).
OF_LAYOUT: tuple[tuple[str, str], ...] = tuple(
    (node[0].value, node[1]) for node in _HOLDINGS if node not in _NEEDS
)


def _semantic_image(path: Path) -> Image:
    from cityx.sources.semantic_map import read_class_map

    found, _, _ = read_class_map(path)
    count = len(found.classes)
    colors = [LinearColor(index / count, 1.0 - index / count, 0.5) for index in range(count)]
    words = [item.word for item in found.classes]
    west, south, _, _ = found.grid.extent
    classes = tuple(zip(colors, words, strict=True))
    return Image(np.array(colors)[found.labels], found.grid.pixel, (west, south), classes)


# What input files of a kind yield, and how they are read.
_FILES: Mapping[Node, tuple[str, Callable[[Path], Any]]] = MappingProxyType(
    {(Format.IMAGE, "semantic_map"): ("semantic", _semantic_image)}
)

# Kind of an input file to what it yields, as (format, role).
READABLE: Mapping[str, tuple[tuple[str, str], ...]] = MappingProxyType(
    {kind: ((node[0].value, node[1]),) for node, (kind, _) in _FILES.items()}
)


def lacks(city: City, node: Node) -> bool:
    """Return whether a role is known to be made by an action that has not run yet."""
    fmt, role = node
    if fmt is Format.COMPLEX_GEOMETRY and role in ("buildings", "ground"):
        return role not in city.scene.meshes
    need = _NEEDS.get(node)
    return need is not None and not need(city)


def held(city: City, inputs: InputFiles | None = None) -> tuple[Node, ...]:
    """Return what the city and the files a user handed in can yield, in a fixed order."""
    tables = [node for node in _HOLDINGS if not lacks(city, node)]
    meshes = [(Format.COMPLEX_GEOMETRY, layer) for layer in city.scene.meshes]
    kinds = inputs.kinds if inputs is not None else ()
    files = [node for node, (kind, _) in _FILES.items() if kind in kinds]
    return (*tables, *meshes, *files)


def take(city: City, node: Node, inputs: InputFiles | None = None) -> Any:
    """Return the value of something the city or the input files hold.

    Raises
    ------
    KeyError
        If it holds no such thing.
    """
    if node[0] is Format.COMPLEX_GEOMETRY and node[1] in city.scene.meshes:
        return city.scene.meshes[node[1]]
    if node in _FILES:
        kind, read = _FILES[node]
        (path, *_) = inputs.of_kind(kind) if inputs is not None else ()
        return read(path)
    return _HOLDINGS[node](city)
