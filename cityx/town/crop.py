"""Cut a window out of a layout."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Annotated

from cityx.city import City
from cityx.city.sites import cut
from cityx.protocol import Port, Range, action

if TYPE_CHECKING:
    pass

FAR = 1e7  # metres; farther than any site reaches


@action(
    "layout/crop-v1",
    limits=["Buildings are kept whole when their centroid lies in the window, else dropped."],
    takes=(Port("layout", "scene_layout"),),
    gives=(Port("layout", "scene_layout"),),
)
def crop(
    city: City,
    *,
    x: Annotated[float, Range(-FAR, FAR)] = 0.0,
    y: Annotated[float, Range(-FAR, FAR)] = 0.0,
    width: Annotated[float, Range(10.0, FAR)] = 1000.0,
    depth: Annotated[float, Range(10.0, FAR)] = 1000.0,
) -> City:
    """Keep only what lies in a rectangle of the site.

    Parameters
    ----------
    city
        City with a layout.
    x, y
        Centre of the window, metres, scene frame.
    width, depth
        Size of the window in east and north direction, metres.
    """
    layout = city.layout
    xmin, ymin, xmax, ymax = layout.extent
    window = (
        max(xmin, x - width / 2),
        max(ymin, y - depth / 2),
        min(xmax, x + width / 2),
        min(ymax, y + depth / 2),
    )
    return replace(city, layout=cut(layout, window))
