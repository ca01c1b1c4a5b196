"""Parts of buildings that a sentence names: "the balconies of the tallest building"."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from cityx.assets.styles.materials import srgb_to_linear
from cityx.checks.predicates.thing_predicates import Selection
from cityx.city import City
from cityx.ids import id_text
from cityx.language.lexicon.phrases import part_of
from cityx.language.references.selecting import Open
from cityx.protocol.serving import Slots

# What may be done to parts -> what that is called where actions serve it.
VERBS: Mapping[str, str] = MappingProxyType({"remove": "remove_parts", "set_color": "paint_parts"})


def with_parts(slots: Slots, text: str, chosen: Selection | None, city: City) -> Slots:
    """Make a command that names a part of buildings change the part, not the buildings.

    Raises
    ------
    Open
        If the buildings have no such part, or something else than removing or painting is asked.
    """
    verb = str(slots["edit"][0])
    if verb == "add_parts" and "rgb" in slots:
        return {**slots, "part.tint": (srgb_to_linear(int(slots["rgb"][0])),)}
    part = "" if verb == "add_parts" else part_of(text)
    if not part or chosen is None or slots.get("family") != ("building",):
        return slots
    if verb not in VERBS:
        raise Open(f"A {part} of a building can be removed or painted; which of the two?")
    found: set[int] = set()
    for rows in city.scene.instances.values():
        such = [item.name.split("_")[0] == part for item in city.scene.prototypes] or [False]
        mine = np.isin(rows.owner, chosen.ids) & np.array(such)[rows.prototype]
        found |= set(rows.object_id[mine].tolist())
    if not found:
        raise Open(f"{chosen.examples()} has no {part} of its own.")
    more: Slots = {"edit": (VERBS[verb],), "objects": (tuple(map(id_text, sorted(found))),)}
    if "rgb" in slots:
        more = {**more, "part.tint": (srgb_to_linear(int(slots["rgb"][0])),)}
    return {**slots, **more, "family": ("part",)}
