"""From height files to the ground under a city."""

from __future__ import annotations

from typing import Annotated

from cityx.city import City
from cityx.errors import ActionFailed
from cityx.protocol import InputFiles, Port, Range, Text, action
from cityx.town.input_layouts import height_range


@action(
    "terrain/height_field-v1",
    kind="source",
    takes=(
        Port("layout", "scene_layout", "layout"),
        Port("heights", "image", "height_field", optional=True),
    ),
    gives=(Port("terrain", "surface", "terrain"),),
    requires=("layout",),
    binds={
        "lowest": "read.lowest",
        "highest": "read.highest",
        "pixel": "read.pixel",
        "height_crs": "read.height_crs",
    },
    limits=["The height files must cover the site."],
    labels=("dem", "elevation", "hills", "relief", "drape"),
)
def height_field(
    city: City,
    inputs: InputFiles,
    *,
    lowest: Annotated[float | None, Range(-12000.0, 9000.0)] = None,
    highest: Annotated[float | None, Range(-12000.0, 9000.0)] = None,
    pixel: Annotated[float | None, Range(1e-6, 1e6)] = None,
    height_crs: Annotated[str, Text(80)] = "",
) -> City:
    """Lay the terrain of height files under a city; a surface model gives its buildings heights.

    Parameters
    ----------
    city
        City with a layout.
    inputs
        Files the user handed in.
    lowest, highest
        Metres of the lowest and the highest number of heights that are no metres.
    pixel
        Metres of a cell of heights that do not say it.
    height_crs
        Coordinate system of heights that do not name theirs.
    """
    from cityx.sources.heights.height_files import HeightOptions
    from cityx.sources.heights.height_source import lay_terrain, read_heights
    from cityx.sources.heights.measured_heights import heights_from_surface

    paths = inputs.of_kind("height")
    if not paths:
        raise ActionFailed("No height file was given.")
    span = height_range(lowest, highest)
    heights = read_heights(paths, HeightOptions(span=span, crs=height_crs, pixel=pixel))
    if heights.has_houses and len(city.layout.buildings):
        city = heights_from_surface(city, heights)
    return lay_terrain(city, heights)
