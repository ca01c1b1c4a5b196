"""Channels: what a shot of a city can show, pixel by pixel."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from cityx.errors import InputError, nearest
from cityx.system.tables import table

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


CHANNELS = table("dataset/channels", Channel)
# Words of ``--channels`` for several.
SETS: Mapping[str, tuple[str, ...]] = MappingProxyType({
    "truth": tuple(c.name for c in CHANNELS.values() if c.maker == TRUTH),
    "all": tuple(c.name for c in CHANNELS.values()),
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
    return tuple(channel for channel in CHANNELS.values() if channel.name in wanted)
