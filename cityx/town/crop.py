"""Cut a window out of a layout."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Annotated

from cityx.city import City
from cityx.city.sites import cut, left_at_border
from cityx.protocol import Port, Range, action
from cityx.sources.features.tagged import named_note

if TYPE_CHECKING:
    from cityx.city.sites import Box

FAR = 1e7  # metres; farther than any site reaches


@action(
    "layout/crop-v1",
    limits=[
        "Buildings are kept whole when their centroid lies in the window, or where the site, which "
        "grows to hold those, has room for them; others at its border are named."
    ],
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
    return windowed(city, window)


def windowed(city: City, window: Box) -> City:
    """Cut a city without anything built to a window, naming the buildings that go at its border."""
    layout = cut(city.layout, window)
    note = named_note(
        "buildings at the border lie out of the site", left_at_border(city.layout, layout)
    )
    return replace(city, layout=layout, notes=(*city.notes, note) if note else city.notes)
