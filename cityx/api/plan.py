"""The plan of a city: ground, streets and buildings from above, as SVG or by matplotlib."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely

from cityx.city import City
from cityx.city.ground import SURFACES
from cityx.errors import MissingDependency

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Colours by what a surface of the ground is; whatever is left is built-up land.
COLOURS = {
    "water": "#a9cbe0", "grass": "#c7dcae", "park": "#c7dcae", "meadow": "#d3e2b6",
    "wood": "#a9c793", "farmland": "#e6e0bf", "sand": "#eadfc0", "pitch": "#b5d3a5",
    "playground": "#dfd3ae", "plaza": "#e3dcd0", "parking": "#d0d0d0", "railway": "#b9b4ae",
    "path": "#ddd6cb", "trail": "#ddd0b8", "sidewalk": "#dedbd4", "frontage": "#dedbd4",
    "carriageway": "#f7f7f5", "junction": "#f7f7f5", "setts": "#efece6", "gravel_road": "#eee6d6",
}  # fmt: skip
LAND, BUILDING, OUTLINE = "#e9e6df", "#c9a58c", "#8c6a54"
SVG_WIDTH = 520  # pixels
_ALIKE = {"kerb": "sidewalk", "furnishing": "sidewalk", "marking": "carriageway",
          "marking_yellow": "carriageway", "crossing_row": "carriageway", "gutter": "carriageway",
          "cycle_lane": "carriageway", "landing": "sidewalk", "ramp": "sidewalk"}  # fmt: skip


def shapes_of(city: City) -> Iterator[tuple[str, str, Any]]:
    """Yield (fill, outline, geometry) from the lowest to the highest; the outline may be ""."""
    faces = city.ground
    if faces is not None:
        names = np.array([_ALIKE.get(s.name, s.name) for s in SURFACES], object)
        named = names[faces.face_label][faces.triangle_face]
        for name, colour in COLOURS.items():
            rows = faces.triangles[named == name]
            if len(rows):
                yield colour, "", shapely.coverage_union_all(shapely.polygons(faces.vertices[rows]))
    else:
        for row in city.layout.areas.itertuples():
            yield COLOURS.get(row.kind, LAND), "", row.geometry
        roads = city.layout.roads
        width = np.nan_to_num(roads["width"].to_numpy(float), nan=4.0)
        if len(roads):
            yield (
                COLOURS["carriageway"],
                "",
                shapely.union_all(shapely.buffer(roads.geometry.to_numpy(), width / 2)),
            )
    if len(city.layout.buildings):
        outlines = shapely.geometrycollections(city.layout.buildings.geometry.to_numpy())
        yield BUILDING, OUTLINE, outlines


def svg_of(city: City, width: int = SVG_WIDTH) -> str:
    """Return the plan as SVG, north up."""
    west, south, east, north = city.layout.extent
    if not (east > west and north > south):
        return ""
    step = (east - west) / width  # metres of a pixel
    paths = "".join(
        f'<path d="{_path(shapely.simplify(shape, step / 2), west, north)}" fill="{fill}"'
        + (f' stroke="{line}" stroke-width="{step:.2f}"' if line else "")
        + ' fill-rule="evenodd"/>'
        for fill, line, shape in shapes_of(city)
    )
    height = round(width * (north - south) / (east - west))
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" '
        f'viewBox="0 0 {east - west:.2f} {north - south:.2f}">'
        f'<rect width="100%" height="100%" fill="{LAND}"/>{paths}</svg>'
    )


def _path(shape: Any, west: float, north: float) -> str:
    words = []
    # Twice, since a collection may hold multipolygons.
    for ring in shapely.get_rings(shapely.get_parts(shapely.get_parts([shape]))):
        xy = shapely.get_coordinates(ring)[:-1] * (1, -1) + (-west, north)
        words.append("M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in xy.tolist()) + "Z")
    return "".join(words)


def plot_city(city: City, ax: Axes | None = None, **style: Any) -> Axes:
    """Draw the plan with matplotlib and return its axes, in metres of the city's frame.

    Parameters
    ----------
    city
        The city.
    ax
        Where to draw; new axes when None.
    style
        Arguments of matplotlib's `PathPatch` for the buildings, such as ``facecolor``.

    Raises
    ------
    MissingDependency
        If matplotlib is not installed.
    """
    pyplot = _pyplot()
    from geopandas import GeoSeries

    if ax is None:
        _, ax = pyplot.subplots(figsize=(8, 8))
    ax.set_facecolor(LAND)
    for fill, line, shape in shapes_of(city):
        own = {"facecolor": fill, "edgecolor": line or "none", "linewidth": 0.4}
        GeoSeries(shapely.get_parts([shape])).plot(ax=ax, **own | (style if line else {}))
    west, south, east, north = city.layout.extent
    ax.set(xlim=(west, east), ylim=(south, north), aspect="equal", title=city.name,
           xlabel="x (east), m", ylabel="y (north), m")  # fmt: skip
    return ax


def _pyplot() -> Any:
    try:
        from matplotlib import pyplot
    except ImportError:
        raise MissingDependency(
            'A plan is drawn with matplotlib: pip install "cityx[notebook]"'
        ) from None
    return pyplot


def require_folium() -> None:
    """Refuse to make an interactive map without its libraries.

    Raises
    ------
    MissingDependency
        If one of them is not installed.
    """
    from importlib.util import find_spec

    missing = [name for name in ("folium", "mapclassify", "matplotlib") if find_spec(name) is None]
    if missing:
        raise MissingDependency(
            f'An interactive map needs {", ".join(missing)}: pip install "cityx[notebook]"'
        )
