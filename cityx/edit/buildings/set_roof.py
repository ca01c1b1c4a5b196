"""Roofs of buildings."""

from __future__ import annotations

from typing import Annotated

from cityx.assets.styles.palette_tables import ROOF_WORDS
from cityx.building.roofs.shapes import SHAPES
from cityx.city.city import City
from cityx.edit.buildings.designing import Wish, redesigned
from cityx.edit.targets import buildings_named
from cityx.errors import ActionFailed
from cityx.protocol import Choice, Color, ObjectName, Port, Range, action
from cityx.protocol.serving import Serves

COVERINGS = tuple(sorted({word for row in ROOF_WORDS.values() for word in row.split()}))


@action(
    "edit/set_roof-v1",
    limits=[
        "A roof that an outline does not admit becomes a simpler one, which the report lists.",
        "A building that is grown with steps becomes a plain volume under a roof of one shape.",
    ],
    takes=(Port("object", "complex_geometry"),),
    gives=(Port("object", "complex_geometry"),),
    labels=("roof", "gabled", "flat", "tiles"),
    serves=(Serves("edit=set_roof", "family=building"),),
    binds={"objects": "objects", "shape": "roof", "covering": "roof", "color": "rgb"},
)
def set_roof(
    city: City,
    *,
    objects: Annotated[tuple[str, ...], ObjectName()],
    shape: Annotated[str | None, Choice(*SHAPES)] = None,
    covering: Annotated[str | None, Choice(*COVERINGS)] = None,
    color: Annotated[int | None, Color(), Range(0, 0xFFFFFF)] = None,
) -> City:
    """Give buildings another roof.

    Parameters
    ----------
    city
        The city.
    objects
        The buildings.
    shape
        In the words of roof:shape.
    covering
        In the words of roof:material.
    color
        0xRRGGBB, sRGB.
    """
    if shape is None and covering is None and color is None:
        raise ActionFailed("Nothing is said of the roof: a shape, a covering or a colour.")
    wish = Wish(roof=shape, roof_material=covering, roof_color=color)
    return redesigned(city, buildings_named(city, objects), wish)
