"""Evidence: whether a picture is a semantic map, and of which legend."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from cityx.errors import InputError
from cityx.sources.semantic_map.legends import PRESETS, Legend
from cityx.sources.semantic_map.matching import NEARLY, Match, fitting
from cityx.sources.semantic_map.picture import Picture
from cityx.sources.semantic_map.proposal import legend_text, measured, propose

FEW = 24  # colours; a legend has no more
COVERED = 0.97  # share of the pixels that the few most frequent colours of a map cover
SAME = 6  # steps of 255; JPEG moves flat colour by less
FLAT = 0.90  # share of pixels like their neighbour, in a map
FLAT_LOSSY = 0.75  # the same after compression
LONG = 4.0  # times as long as wide, from which the patches of a mask are streets
CELL = 16  # steps of 255 that are one colour when colours are counted in lossy pictures


@dataclass(frozen=True)
class Evidence:
    """How much a picture looks like a semantic map.

    Attributes
    ----------
    semantic
        The verdict.
    score
        0 (a photograph, a height map) to 1 (a map of a known legend).
    text
        What was seen.
    """

    semantic: bool
    score: float
    text: str


def is_semantic(picture: Picture) -> Evidence:
    """Distinguish a semantic map from a photograph and from a height map.

    A map has few colours that cover it, in patches within which nothing changes.
    """
    best = fitting(picture)
    flat = _flatness(picture)
    covered, colors = _coverage(picture)
    seen = f"{colors} colours, the {FEW} most frequent on {100 * covered:.0f} % of the pixels; " \
        f"{100 * flat:.0f} % of the pixels are like their neighbour"  # fmt: skip
    # Photographs of sand and sea have the colours of some legend, but nothing in them is flat.
    if best and flat >= FLAT_LOSSY:
        return Evidence(True, 1.0, f"{best[0].text()}; {seen}")
    enough = FLAT_LOSSY if picture.lossy else FLAT
    semantic = covered >= COVERED and flat >= enough and colors > 1
    return Evidence(semantic, round(min(covered, flat) * (0.95 if semantic else 0.5), 3), seen)


def best_reading(picture: Picture) -> str:
    """Return what a picture looks like, for an error."""
    return is_semantic(picture).text


def _flatness(picture: Picture) -> float:
    colors = picture.colors.astype(np.int16)
    if picture.values is not None:
        return float((np.diff(picture.values, axis=1) == 0).mean())
    return float((np.abs(np.diff(colors, axis=1)).max(axis=2) <= SAME * picture.lossy).mean())


def _coverage(picture: Picture) -> tuple[float, int]:
    """Return the share of pixels of the most frequent colours, and how many colours there are."""
    by_value = picture.values is not None
    if picture.lossy:
        coarse = Picture(None, picture.colors // np.uint8(CELL) * np.uint8(CELL), picture.void)
        keys, index = coarse.distinct(by_value=False)
    else:
        keys, index = picture.distinct(by_value=by_value)
    count = np.sort(np.bincount(index[~picture.void], minlength=len(keys)))[::-1]
    return float(count[:FEW].sum() / max(count.sum(), 1)), int((count > 0).sum())


def chosen_legend(path: Path, picture: Picture, *, confirm: bool) -> tuple[Legend, tuple[str, ...]]:
    """Choose the legend of a picture by evidence.

    Parameters
    ----------
    confirm
        Whether to take the proposal for colours of no known legend.

    Raises
    ------
    InputError
        If the picture is no semantic map, if two legends explain it alike, or if none does and the
        proposal is not confirmed.
    """
    found = _by_shape(picture, fitting(picture))
    if found:
        best = found[0]
        equal = [item for item in found[1:] if _alike(best, item)]
        if not equal:
            return best.legend, (f"semantic map: legend {best.text()}",)
        names = " and ".join(f'"{item.legend.name}"' for item in [best, *equal])
        raise InputError(
            f"{path} may follow the legends {names}: each explains it alike. Say which it is "
            f"(--legend {best.legend.name})."
        )
    evidence = is_semantic(picture)
    if not evidence.semantic:
        raise InputError(f"{path} does not look like a semantic map: {evidence.text}.")
    legend, lines = propose(picture)
    if confirm:
        return legend, (
            "semantic map: no known legend; the classes were proposed from colours and shapes, and "
            "confirmed",
            *(f"semantic map: {line}" for line in lines),
        )
    raise InputError(
        f"The colours of {path} follow no known legend ({', '.join(PRESETS)}). From shapes and "
        "colours they may mean\n  " + "\n  ".join(lines) + "\nConfirm this (--confirm-legend), or "
        "write what is right into a file and give it (--legend FILE.json):\n  "
        f"{legend_text(legend)}"
    )


def _alike(best: Match, other: Match) -> bool:
    """Return whether two legends explain as much and would make different cities."""
    same = {entry.key: entry.meaning for entry in best.legend.entries}
    differs = any(same.get(entry.key) != entry.meaning for entry in other.legend.entries)
    return differs and best.share - other.share < NEARLY and (
        best.seen - other.seen < 2 or best.legend.by_value
    )  # fmt: skip


def _by_shape(picture: Picture, found: list[Match]) -> list[Match]:
    """Of masks of one class, keep that of streets or that of houses, by the shape of the mask."""
    masks = [item for item in found if "-mask" in item.legend.name]
    if not masks or picture.values is None:
        return found
    kept = "road" if measured(picture.values > 0, 0, 0).length > LONG else "building"
    return [item for item in found if item not in masks or item.legend.name.startswith(kept)]
