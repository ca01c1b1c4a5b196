"""Why some formats never become others: a sentence for every pair without a conversion."""

from __future__ import annotations

from cityx.protocol.formats import Format

F = Format
_PLACES = (F.SCENE_LAYOUT, F.POINT, F.LINE, F.SURFACE, F.BASIC_GEOMETRY, F.COMPLEX_GEOMETRY)
_SCALARS = (F.BOOLEAN, F.RANDOM_NUMBER)
_LOOKS = (F.COLOR, F.TEXTURE_MATERIAL)

_TO: dict[Format, str] = {
    F.NOISE_FUNCTION: (
        "A noise function is made from a seed alone; data would have to be fitted, "
        "which says nothing beyond them."
    ),
    F.GEOGRAPHIC_DATA: (
        "Geographic data carry longitude, latitude and a source; this value does not say "
        "where on Earth it lies."
    ),
    F.BOOLEAN: "A yes or no answers a question, and this value does not say which.",
    F.RANDOM_NUMBER: "A random number must not depend on data; its stream is keyed by identity.",
    F.STRING: "A text about this value needs a question; the queries of the scene answer those.",
    F.COLOR: "This value has no colour of its own.",
    F.TEXTURE_MATERIAL: "This value says nothing of how a surface looks.",
    F.IMAGE: "This value has no extent on the ground to draw.",
}
_FROM: dict[Format, str] = {
    F.NOISE_FUNCTION: "A noise function has no edges; draw it as an image and classify that.",
    F.BOOLEAN: "A yes or no has no place and no extent.",
    F.COLOR: "A colour has no place and no extent.",
    F.TEXTURE_MATERIAL: "A material has no place and no extent until it is given to a surface.",
    F.STRING: "A text is read into a brief by the agents, never into geometry.",
    F.RANDOM_NUMBER: "A single number decides too little.",
    F.IMAGE: "What the pixels mean is not said; a semantic map or a height image says it.",
}


def reason(source: Format, target: Format) -> str:
    """Return why one format never becomes another."""
    if target in _PLACES:
        return _FROM.get(source, "The value lacks a role that says what it shows.")
    return _TO.get(target, "No conversion keeps what this value is about.")
