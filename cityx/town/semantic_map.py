"""From a semantic map to a layout, the direct way."""

from __future__ import annotations

from typing import Annotated

from cityx.city import City, Layout
from cityx.errors import ActionFailed, InputError
from cityx.geometry.raster.grid import Grid
from cityx.protocol import Port, Range, action
from cityx.protocol.values import Image
from cityx.sources.class_map import ClassMap, layout_of
from cityx.sources.map_classes import class_of


@action(
    "layout/semantic_map-v1",
    limits=["Loses what is smaller than a shed, and which of two joined houses a pixel is of."],
    gives=(Port("layout", "scene_layout"),),
    lossy=0.1,
)
def semantic_map(
    city: City,
    image: Annotated[Image, Port("image", "image", "semantic_map")],
    *,
    tolerance: Annotated[float, Range(0.0, 2.0)] = 0.05,
) -> Layout:
    """Draw houses with straight walls, streets with widths and land with shared borders.

    Parameters
    ----------
    city
        City whose frame and seed the layout is for.
    image
        Semantic map with its table of colours.
    tolerance
        Greatest distance of a pixel's colour from the colour of its class.
    """
    if not image.classes:
        raise ActionFailed("The image says no classes; a semantic map needs a table of colours.")
    rows, columns = image.pixels.shape[:2]
    x, y = image.origin
    grid = Grid(rows, columns, image.pixel_size, x, y + rows * image.pixel_size)
    try:
        classes = (*(class_of(word) for _, word in image.classes), class_of("unknown"))
        found = ClassMap(image.labels(tolerance), classes, grid)
    except InputError as error:
        raise ActionFailed(str(error)) from error
    return layout_of(found, city.frame, source="image", seed=city.seed)[0]
