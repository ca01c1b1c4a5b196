"""Materials of buildings."""

from __future__ import annotations

from typing import Annotated

from cityx.assets.styles.palette_tables import WALL_WORDS
from cityx.city.city import City
from cityx.edit.buildings.designing import Wish, redesigned
from cityx.edit.targets import buildings_named
from cityx.protocol import Choice, Color, ObjectName, Port, Range, action
from cityx.protocol.serving import Serves

WORDS = tuple(sorted({word for row in WALL_WORDS.values() for word in row.split()}))


@action(
    "edit/set_material-v1",
    limits=["The form stays; glass is a skin before the walls, with the windows in it."],
    takes=(Port("object", "complex_geometry"),),
    gives=(Port("object", "complex_geometry"),),
    labels=("material", "brick", "glass", "stone", "clad"),
    serves=(Serves("edit=set_material", "family=building"),),
    binds={"objects": "objects", "material": "material", "color": "rgb"},
)
def set_material(
    city: City,
    *,
    objects: Annotated[tuple[str, ...], ObjectName()],
    material: Annotated[str, Choice(*WORDS)],
    color: Annotated[int | None, Color(), Range(0, 0xFFFFFF)] = None,
) -> City:
    """Build walls of another material.

    Parameters
    ----------
    city
        The city.
    objects
        The buildings.
    material
        What the walls are of, in the words of building:material.
    color
        0xRRGGBB, sRGB; the usual colours of the material when left out.
    """
    wish = Wish(material=material, color=None if color is None else int(color))
    return redesigned(city, buildings_named(city, objects), wish)
