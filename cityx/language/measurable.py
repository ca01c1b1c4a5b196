"""What predicates can measure: names of the brief in the words of the predicate language."""

from __future__ import annotations

from collections.abc import Mapping

from cityx.assets.outside_words import outside_pieces, outside_styles
from cityx.language.lexicon.phrases import outside_types
from cityx.system.tables import load, table
from cityx.town.elements import ELEMENTS, OTHER_THINGS, attributes_of, looked_at

# Noun of the brief -> a choice of things. Nouns that stand in none of these tables have no measure.
_SAME = load("language/measurable", tuple[str, ...], "same")
_RENAMED = table("language/measurable", str, "renamed")
# Type of building -> the condition that tells it: by its measures, its use or its tag in OSM.
TYPES = {
    **table("language/measurable", str, "types"),
    **{name: one.measure.partition(", ")[2] for name, one in ELEMENTS.items() if one.building},
}
MATERIALS = table("language/measurable", str, "materials")
THING_MATERIALS = table("language/measurable", str, "thing_materials")
COLORS = table("language/measurable", str, "colors")
ROOFS = table("language/measurable", str, "roofs")
STYLES = load("language/measurable", frozenset[str], "styles")
USES = table("language/measurable", str, "uses")


def _each(name: str, values: Mapping[str, str]) -> dict[str, str]:
    return {word: f"{name}={value}" for word, value in values.items()}


SIDES = ("north", "east", "south", "west")
CORNERS = ("northeast", "southeast", "southwest", "northwest")
SIDES_OF_SKY = (*SIDES, *CORNERS)

# Key -> value -> the condition on buildings that it says.
_LOOKS: Mapping[str, Mapping[str, str]] = {
    **dict.fromkeys(("building.material", "material"), _each("material", MATERIALS)),
    **dict.fromkeys(("building.color", "color"), _each("color", COLORS)),
    **dict.fromkeys(("building.roof", "roof"), ROOFS),
    "roof.color": _each("roof_color", COLORS), "building.use": _each("use", USES),
}  # fmt: skip


# Looks of buildings of one kind: "tower.color" is the colour of the towers.
OF_A_KIND: Mapping[str, str] = {
    "material": "building.material", "color": "building.color", "roof": "building.roof",
    "roof_color": "roof.color",
}  # fmt: skip


def look_of_kind(key: str, value: str) -> tuple[str, str]:
    """Return the buildings that a key such as "tower.color" is of, and what they must be.

    Returns
    -------
    chosen, told
        A choice of buildings and a condition on them; "" twice where nothing measures it.
    """
    kind, _, look = key.partition(".")
    if look not in OF_A_KIND:
        return "", ""
    own = attributes_of(kind)
    if kind in ELEMENTS or kind in OTHER_THINGS:
        chosen = looked_at(kind) if look in own else ""
    else:
        chosen = things(kind)
    if chosen.startswith("building, "):
        told = condition(OF_A_KIND[look], value)
    else:
        told = _condition_on_things(chosen, look, value) if chosen else ""
    return (chosen, told) if told else ("", "")


def _condition_on_things(chosen: str, look: str, value: str) -> str:
    """Return what things that are no buildings must be, "" where nothing measures it."""
    from cityx.checks.predicates.vocabulary import family_of, known_words

    word = COLORS.get(value, "") if look == "color" else THING_MATERIALS.get(value, "")
    known = known_words(family_of(chosen.partition(",")[0]), look)
    return f"{look}={word}" if word in known else ""


def things(noun: str) -> str:
    """Return the choice of things that a noun or an id names; "" where nothing measures it."""
    if noun in ELEMENTS:
        return ELEMENTS[noun].measure
    if noun in _SAME or (any(letter.isdigit() for letter in noun) and noun.isascii()):
        return noun
    if noun in outside_pieces():
        return noun
    if condition("type", noun):
        return f"building, {condition('type', noun)}"
    return _RENAMED.get(noun, "")


def condition(key: str, value: str) -> str:
    """Return the condition on buildings that a slot says, "" where nothing measures it."""
    if key in ("building.type", "type"):
        return f"generator={value}" if value in outside_types() else TYPES.get(value, "")
    if key == "style":
        return f"style={value}" if value in STYLES or value in outside_styles() else ""
    return _LOOKS.get(key, {}).get(value, "")
