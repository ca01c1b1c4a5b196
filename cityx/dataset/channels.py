"""Channels: what a shot of a city can show, pixel by pixel."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from cityx.errors import InputError, nearest

TRUTH, CYCLES = "truth", "cycles"  # who makes a channel: the ray caster, or Blender's path tracer


@dataclass(frozen=True)
class Channel:
    """One channel of pictures of (h, w) pixels.

    Attributes
    ----------
    name
        As in ``--channels`` and in the names of files.
    maker
        ``TRUTH``: one ray through the middle of each pixel, not anti-aliased. ``CYCLES``: samples
        over the pixel, as a camera sees it.
    dtype
        Of its array.
    depth
        Values per pixel; 1 is an array (h, w), more (h, w, depth).
    unit
        "m", "px", "" for ratios and linear colours, "id" for numbers of things.
    meaning
        What it holds, in a sentence.
    """

    name: str
    maker: str
    dtype: str
    depth: int
    unit: str
    meaning: str


_TABLE = (
    Channel("rgb", CYCLES, "float32", 3, "",
            "Linear colour, before exposure and view transform."),
    Channel("picture", CYCLES, "uint8", 3, "",
            "Colour as a screen shows it, exposed and through the view transform; sRGB."),
    Channel("depth", TRUTH, "float32", 1, "m",
            "Along the view axis; infinite in the sky."),
    Channel("distance", TRUTH, "float32", 1, "m",
            "From the eye; infinite in the sky."),
    Channel("normal", TRUTH, "float32", 3, "",
            "Unit normal of the face towards the eye, east, north, up; 0 in the sky."),
    Channel("position", TRUTH, "float32", 3, "m",
            "Point seen, relative to the eye, east, north, up; 0 in the sky."),
    Channel("semantic", TRUTH, "uint8", 1, "id",
            "Class of the object seen, see classes.json; sky included."),
    Channel("instance", TRUTH, "uint64", 1, "id",
            "The City's id of the object seen; 0 is the sky."),
    Channel("panoptic", TRUTH, "uint32", 1, "id",
            "Segment of the picture, see its segments; each pixel has exactly one."),
    Channel("material", TRUTH, "uint16", 1, "id",
            "Material of the face seen, see materials.json; 0 is the sky."),
    Channel("flow", TRUTH, "float32", 2, "px",
            "Where the point seen is in the next frame of the sequence: right, down."),
    Channel("motion", TRUTH, "float32", 3, "m",
            "How far the point seen moves until the next frame, east, north, up."),
    Channel("diffuse", CYCLES, "float32", 3, "",
            "Diffuse colour (albedo), linear."),
    Channel("ao", CYCLES, "float32", 1, "",
            "Ambient occlusion: share of the sky above the face that is open."),
    Channel("glossy_direct", CYCLES, "float32", 3, "",
            "Light of lamps, sun and sky that is mirrored at once."),
    Channel("glossy_indirect", CYCLES, "float32", 3, "",
            "Light of other surfaces that is mirrored."),
    Channel("glossy_colour", CYCLES, "float32", 3, "",
            "Colour of mirroring."),
    Channel("crypto_object", CYCLES, "float32", 12, "",
            "Cryptomatte of objects: three ranks of two (id, coverage) pairs."),
    Channel("crypto_material", CYCLES, "float32", 12, "",
            "Cryptomatte of materials."),
)  # fmt: skip
CHANNELS: Mapping[str, Channel] = MappingProxyType({channel.name: channel for channel in _TABLE})
# Words of ``--channels`` for several.
SETS: Mapping[str, tuple[str, ...]] = MappingProxyType({
    "truth": tuple(c.name for c in _TABLE if c.maker == TRUTH),
    "all": tuple(c.name for c in _TABLE),
    "paper": (
        "rgb", "depth", "normal", "diffuse", "semantic", "instance", "ao", "crypto_object",
        "crypto_material", "glossy_direct", "glossy_colour", "glossy_indirect",
    ),
})  # fmt: skip


def chosen(words: Iterable[str]) -> tuple[Channel, ...]:
    """Return the channels that words name, in the order of the table.

    Raises
    ------
    InputError
        Naming every word that is neither a channel nor a set of channels.
    """
    wanted: set[str] = set()
    faults = []
    for word in words:
        if word in SETS:
            wanted |= set(SETS[word])
        elif word in CHANNELS:
            wanted.add(word)
        else:
            faults.append(f'there is no channel "{word}".{nearest(word, [*CHANNELS, *SETS])}')
    if faults:
        known = ", ".join([*CHANNELS, *SETS])
        raise InputError(f"{' '.join(faults)} Known are: {known}.")
    return tuple(channel for channel in _TABLE if channel.name in wanted)
