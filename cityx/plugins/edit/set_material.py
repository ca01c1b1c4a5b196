"""Materials of buildings."""

from __future__ import annotations

from typing import Annotated

from cityx.assets.palette_tables import WALL_WORDS
from cityx.city.city import City
from cityx.plugins.edit.designing import Wish, redesigned
from cityx.plugins.edit.targets import buildings_named
from cityx.protocol import Choice, ObjectName, Port, action
from cityx.protocol.serving import Serves

WORDS = tuple(sorted({word for row in WALL_WORDS.values() for word in row.split()}))


@action(
    "edit/set_material-v1",
    limits=["The form stays; glass is a skin before the walls, with the windows in it."],
    takes=(Port("object", "complex_geometry"),),
    gives=(Port("object", "complex_geometry"),),
    labels=("material", "brick", "glass", "stone", "clad"),
    serves=(Serves("edit=set_material", "family=building"),),
    binds={"objects": "objects", "material": "material"},
)
def set_material(
    city: City,
    *,
    objects: Annotated[tuple[str, ...], ObjectName()],
    material: Annotated[str, Choice(*WORDS)],
) -> City:
    """Build walls of another material, in its own colours.

    Parameters
    ----------
    city
        The city.
    objects
        The buildings.
    material
        What the walls are of, in the words of building:material.
    """
    return redesigned(city, buildings_named(city, objects), Wish(material=material))
