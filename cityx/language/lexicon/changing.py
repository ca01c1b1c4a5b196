"""Words of changes: surfaces of streets, their directions, more and less of the weather, later."""

from __future__ import annotations

import re
from collections.abc import Mapping
from types import MappingProxyType

# Surface, in OpenStreetMap's words -> triggers.
SURFACES: Mapping[str, str] = {
    "asphalt": "asphalt, tarmac, blacktop, bitumen, asphalted",
    "cobblestone": "cobble, cobblestone, cobbled, cobble stone, round cobbles",
    "sett": "sett, granite sett, stone sett, belgian block",
    "paving_stones": "paving stone, paving slab, flagstone, paver, paved",
    "gravel": "gravel, gravelled, graveled, grit, crushed stone",
    "ground": "dirt, bare earth, unpaved",
}
DIRECTIONS: Mapping[str, str] = {
    "along": "one way, oneway, one way street, one way traffic, single direction, "
    "one direction only",
    "both": "two way, two way street, two way traffic, twoway",
}
STRIPS: Mapping[str, str] = {
    "parking": "parking, on street parking, parking lane, curbside parking, parking bay, "
    "parking strip, parallel parking",
}
# More or less of the weather there is.
DEGREES: Mapping[str, str] = {
    "more": "thicker, denser, heavier, stronger, more intense, thicken, intensify, strengthen, "
    "worsen",
    "less": "thinner, weaker, less dense, less thick, less heavy, less intense, thin out, weaken, "
    "let up, ease off",
}
LATER: Mapping[str, str] = {
    "1": "later, forward, forwards, ahead, into the future",
    "-1": "earlier, back, backward, backwards, sooner, into the past",
}
# Kind of tree -> nouns that name it.
SPECIES: Mapping[str, tuple[str, ...]] = {
    "lime": ("lime tree", "linden"), "plane": ("plane tree",), "maple": ("maple",),
    "oak": ("oak", "oak tree"), "chestnut": ("chestnut", "chestnut tree"), "birch": ("birch",),
    "cherry": ("cherry tree",), "poplar": ("poplar",), "willow": ("willow",),
    "pine": ("pine", "pine tree"), "spruce": ("fir", "conifer", "evergreen"),
    "cypress": ("cypress",), "palm": ("palm", "palm tree"), "olive": ("olive tree",),
}  # fmt: skip
# Words for a part -> the first word of the prototypes that are such parts.
PARTS: Mapping[str, str] = MappingProxyType(
    {
        "balcon(?:y|ies)": "balcony", "doors?": "door", "windows?": "window",
        "chimneys?": "chimney", "awnings?": "awning", "dormers?": "dormer",
        "shop ?fronts?": "shop", "antennas?": "antenna", "sky ?lights?": "skylight",
        "solar panels?": "solar", "down ?pipes?": "downpipe", "dishes": "dish",
    }
)  # fmt: skip


def part_named(text: str) -> str:
    """Return the part of a building that a word names, "" for none."""
    return next((part for word, part in PARTS.items() if re.fullmatch(word, text)), "")
