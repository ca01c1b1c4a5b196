"""Styles of buildings and quarters."""

from __future__ import annotations

from typing import Annotated

from cityx.city.city import City
from cityx.edit.buildings.designing import Wish, redesigned
from cityx.edit.targets import buildings_named
from cityx.protocol import ObjectName, Port, Text, action
from cityx.protocol.serving import Serves


@action(
    "edit/set_style-v1",
    limits=[
        "Footprints and storeys stay; materials and colours become those of the style.",
        "Works, sheds and places of worship are built alike in every style.",
    ],
    takes=(Port("object", "complex_geometry"),),
    gives=(Port("object", "complex_geometry"),),
    labels=("style", "japanese", "modern", "old town", "quarter"),
    serves=(Serves("edit=set_style", "family=building"),),
    binds={"objects": "objects", "style": "style"},
)
def set_style(
    city: City,
    *,
    objects: Annotated[tuple[str, ...], ObjectName()],
    style: Annotated[str, Text(24)],
) -> City:
    """Build buildings in another style, each by a generator of it.

    Parameters
    ----------
    city
        The city.
    objects
        The buildings.
    style
        A style word such as "japanese".
    """
    from cityx.assets.styles.palettes import family_of

    family_of(style)
    return redesigned(city, buildings_named(city, objects), Wish(style=style))
