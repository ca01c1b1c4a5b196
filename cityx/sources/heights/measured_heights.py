"""Heights of a map's buildings measured from a surface model, where the map does not say them."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cityx.city import City, Frame
from cityx.city.sites import Box
from cityx.errors import InputError
from cityx.geometry.arrays import BoolArray, FloatArray
from cityx.geometry.raster.grid import Grid
from cityx.geometry.raster.relief import HIGH
from cityx.geometry.raster.roof_measures import Roofs, heights_over_ring, measure_roofs
from cityx.sources.features.vertical import read_vertical
from cityx.sources.heights.height_files import MAX_READ
from cityx.sources.heights.height_kinds import Shows, cell_size
from cityx.sources.heights.height_mosaic import laid
from cityx.sources.heights.height_source import FINEST, Heights, height_above, on_grid

if TYPE_CHECKING:
    from geopandas import GeoDataFrame


FEWEST = 5  # buildings of known height from which an error can be told
LEAST_EAVE = 2.2  # metres of wall that a roof leaves
STOREY = 3.2  # metres of a storey where the old levels give no measure


@dataclass(frozen=True)
class _Measured:
    """Heights of n buildings, NaN where nothing could be measured, and their roofs."""

    height: FloatArray
    roofs: Roofs


def heights_from_surface(city: City, heights: Heights) -> City:
    """Give the buildings of a city the heights that a surface model shows.

    A building is as high as 90 % of what the surface shows within it, above the ground: that of a
    file of the ground, else one found below the surface and corrected within 3 m round the house.
    Heights that the source says stay; so do buildings that it divides into parts.

    Parameters
    ----------
    city
        With a layout.
    heights
        Among them a surface or heights above the ground.

    Returns
    -------
    city
        With heights, levels and, where they are clear, roofs; a note counts them and tells the
        error where the source says heights.

    Raises
    ------
    InputError
        If no file shows houses.
    """
    if not heights.has_houses:
        raise InputError("No height file shows a house; its heights cannot be measured.")
    buildings, parts = city.layout.buildings, city.layout.parts
    if len(buildings) == 0:
        return city
    shapes = buildings.geometry.to_numpy()
    measured = _measure(heights, city.frame, city.layout.extent, shapes)
    said = read_vertical([json.loads(text or "{}") for text in buildings["tags"]])
    seen = np.isfinite(measured.height) & (measured.height > HIGH)
    grounded = parts[parts["base"] == 0.0]
    count, low = (
        table.groupby("building").size().reindex(buildings["id"]).to_numpy()
        for table in (parts, grounded)
    )
    whole = (count == 1) & (low == 1)
    taken = seen & whole & ~said.has_height
    buildings, parts = _raised(buildings, parts, measured, taken)
    layout = replace(city.layout, buildings=buildings, parts=parts)
    notes = _notes(measured.height, said.height, seen, taken)
    return replace(city, layout=layout, notes=(*city.notes, *notes))


def _measure(heights: Heights, frame: Frame, site: Box, shapes: NDArray[np.object_]) -> _Measured:
    files = tuple(laid(file, frame, site, heights.options) for file in heights.files)
    heights = replace(heights, files=files)
    grid = _grid_of(heights, site)
    above, _ = height_above(heights, frame, grid)
    surface = heights.showing(Shows.SURFACE)
    tops = on_grid(surface or heights.showing(Shows.ABOVE), frame, grid)
    above = np.where(np.isnan(tops), np.nan, above)
    roofs = measure_roofs(shapes, above, grid)
    if heights.showing(Shows.TERRAIN) or not surface:
        return _Measured(roofs.height, roofs)
    top, foot = heights_over_ring(shapes, above, grid)
    beside = top - foot
    return _Measured(np.where(np.isfinite(beside), beside, roofs.height), roofs)


def _grid_of(heights: Heights, site: Box) -> Grid:
    """Return the cells of a site, as fine as the surface, coarser where they were too many."""
    files = heights.showing(Shows.SURFACE, Shows.ABOVE)
    width, depth = site[2] - site[0], site[3] - site[1]
    pixel = max(FINEST, *(cell_size(file) for file in files), np.sqrt(width * depth / MAX_READ))
    rows, columns = int(np.ceil(depth / pixel)), int(np.ceil(width / pixel))
    return Grid(rows, columns, float(pixel), site[0], site[3])


def _raised(
    buildings: GeoDataFrame, parts: GeoDataFrame, measured: _Measured, taken: BoolArray
) -> tuple[GeoDataFrame, GeoDataFrame]:
    """Write heights, levels and roofs of some buildings of one part each."""
    row_of = {key: row for row, key in enumerate(buildings["id"].tolist())}
    row = np.array([row_of[key] for key in parts["building"].tolist()], np.int64)
    chosen = np.flatnonzero(taken[row])
    own = row[chosen]
    part = {name: parts[name].to_numpy(copy=True) for name in (
        "top", "levels", "roof_shape", "roof_height", "roof_across", "roof_direction")}  # fmt: skip
    height, roofs = np.round(measured.height[own], 2), measured.roofs
    storey = (part["top"] - part["roof_height"])[chosen] / np.maximum(part["levels"][chosen], 1)
    storey = np.where(storey > LEAST_EAVE, storey, STOREY)
    clear = roofs.shape[own] != ""
    # A roof that is not clear shrinks with its house; it does not grow with it.
    usual = part["roof_height"][chosen] * np.minimum(height / part["top"][chosen], 1.0)
    rise = np.where(clear, roofs.rise[own], usual)
    rise = np.round(np.clip(rise, 0.0, np.maximum(height - LEAST_EAVE, 0.0)), 2)
    part["roof_shape"][chosen[clear]] = roofs.shape[own][clear]
    part["roof_direction"][chosen[clear]] = np.nan
    part["roof_across"][chosen[clear]] = roofs.across[own][clear]
    part["top"][chosen], part["roof_height"][chosen] = height, rise
    levels = np.maximum(np.rint((height - rise) / storey), 1)
    part["levels"][chosen] = levels.astype(part["levels"].dtype)
    of_building = {name: buildings[name].to_numpy(copy=True) for name in ("height", "levels")}
    of_building["height"][own] = height
    of_building["levels"][own] = levels.astype(of_building["levels"].dtype)
    return buildings.assign(**of_building), parts.assign(**part)


def _notes(
    measured: FloatArray, said: FloatArray, seen: BoolArray, taken: BoolArray
) -> tuple[str, ...]:
    both = seen & np.isfinite(said)
    error = ""
    if both.sum() >= FEWEST:
        away = measured[both] - said[both]
        error = (
            f"; at {both.sum():,} whose height the map says it misses by "
            f"{np.median(np.abs(away)):.1f} m (median), {np.median(away):+.1f} m on the whole"
        )
    blind = int((~seen).sum())
    rest = f"; {blind:,} are not seen on it and keep theirs" if blind else ""
    return (
        f"heights: {int(taken.sum()):,} of {len(taken):,} buildings have the height that the "
        f"surface shows{error}{rest}",
    )
