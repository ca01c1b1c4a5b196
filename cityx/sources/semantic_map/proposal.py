"""Proposals: what the colours of a map without a known legend may mean, with the evidence."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cityx.errors import InputError
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.raster.patches import depth, label_patches, without_specks
from cityx.sources.map_classes import class_of
from cityx.sources.semantic_map.legends import (
    CLEAR,
    NEAR,
    NEARLY,
    PRESETS,
    REJECT,
    Entry,
    Legend,
    Match,
    fitting,
    most_frequent,
    to_lab,
    unpacked,
)
from cityx.sources.semantic_map.picture import Picture, packed

MOST = 12  # classes that are looked for
ALONE = 0.002  # share of the pixels from which a colour may be a class
SAMPLE = 1_500_000  # pixels at which shapes are measured
SPECK = 12  # pixels; smaller patches say nothing of a class
THIN = 3.0  # length over width, from which a patch is a line
PALE = 18.0  # CIELab; greyer colours have no hue that means something
HUES = {"bare": 105.0, "green": 200.0, "blue": 315.0}  # degrees in CIELab, where each ends
DARK = 45.0  # lightness below which green is trees
MAIN = 0.25  # share of its class that the largest patch of a street network takes
FEW = 24  # colours; a legend has no more
COVERED = 0.97  # share of the pixels that the few most frequent colours of a map cover
SAME = 6  # steps of 255; JPEG moves flat colour by less
FLAT = 0.90  # share of pixels like their neighbour, in a map
FLAT_LOSSY = 0.75  # the same after compression
LONG = 4.0  # times as long as wide, from which the patches of a mask are streets
# Steps of 255 that are one colour when colours are counted in lossy pictures.
CELL, FINE_CELL = 16, 4


@dataclass(frozen=True)
class Proposal:
    """One colour or value with what its pixels look like.

    Attributes
    ----------
    key
        The colour 0xRRGGBB or the value.
    color
        0xRRGGBB it is shown in.
    share
        Of all pixels.
    patches
        Number of its patches.
    length
        Of its patches over their width: of the whole class, by area and depth.
    fill
        Share of their boxes that patches fill, by area.
    largest
        Share of the class in its largest patch.
    word
        The class proposed.
    """

    key: int
    color: int
    share: float
    patches: int
    length: float
    fill: float
    largest: float
    word: str = ""

    def text(self, *, by_value: bool) -> str:
        """Return the evidence as a line."""
        name = str(self.key) if by_value else f"#{self.key:06X}"
        return (
            f"{name} {self.word}: {100 * self.share:.1f} % of the map in {self.patches} patches, "
            f"{self.length:.0f} times as long as wide, filling {100 * self.fill:.0f} % of their "
            f"boxes"
        )


def propose(picture: Picture, *, apart: float = REJECT) -> tuple[Legend, tuple[str, ...]]:
    """Propose a legend for a picture.

    Parameters
    ----------
    picture
        Of few colours.
    apart
        CIELab between two colours of different classes, at least.

    Returns
    -------
    legend
        At most `MOST` entries.
    evidence
        A line per entry.
    """
    by_value = picture.values is not None
    keys, labels = _clusters(picture, by_value=by_value, apart=apart)
    step = int(np.ceil(np.sqrt(labels.size / SAMPLE)))
    labels = labels[::step, ::step]
    shown = keys if not by_value else packed(_greys(keys))
    found = [
        measured(labels == i, int(k), int(c))
        for i, (k, c) in enumerate(zip(keys, shown, strict=True))
    ]
    named = _named([item for item in found if item.share > 0])
    entries = tuple(Entry(item.key, class_of(item.word)) for item in named)
    return Legend("proposal", by_value, entries), tuple(
        item.text(by_value=by_value) for item in named
    )


def legend_text(legend: Legend) -> str:
    """Return the JSON of a legend file."""
    spell = str if legend.by_value else (lambda key: f"#{key:06X}")
    return json.dumps({spell(entry.key): entry.meaning.word for entry in legend.entries})


def _greys(values: IntArray) -> NDArray[np.uint8]:
    return np.repeat((values & 255).astype(np.uint8)[:, None], 3, axis=1)


def _clusters(picture: Picture, *, by_value: bool, apart: float) -> tuple[IntArray, IntArray]:
    """Return at most `MOST` colours or values and the nearest of each pixel."""
    keys, index = picture.distinct(by_value=by_value)
    count = np.bincount(index[~picture.void], minlength=len(keys)).astype(float)
    order = np.lexsort((keys, -count))
    if by_value:
        kept = np.sort(order[:MOST])
        nearest = np.abs(keys[:, None] - keys[kept]).argmin(axis=1)
        return keys[kept], nearest[index]
    lab = to_lab(unpacked(keys))
    kept = _apart(lab, count, order, apart)
    centres = lab[kept]
    nearest = _assigned(lab, centres)
    for _ in range(8):  # k-means; the colours themselves, not means, name the classes in the end
        weight = np.bincount(nearest, count, minlength=len(kept))
        sums = [np.bincount(nearest, count * axis, minlength=len(kept)) for axis in lab.T]
        centres = np.where(
            weight[:, None] > 0, np.column_stack(sums) / np.maximum(weight, 1)[:, None], centres
        )
        nearest = _assigned(lab, centres)
    labels = nearest[index]
    if picture.lossy:
        labels = most_frequent(labels, len(kept)).astype(np.int64)
    return keys[kept], labels


def _apart(lab: FloatArray, count: FloatArray, order: IntArray, least: float) -> IntArray:
    """Choose frequent colours that look different."""
    kept: list[int] = []
    for index in order[:4096].tolist():
        if len(kept) == MOST or count[index] < ALONE * count.sum() / (1 + len(kept)):
            break
        if all(np.linalg.norm(lab[index] - lab[other]) > least for other in kept):
            kept.append(index)
    return np.array(kept or order[:1].tolist(), np.int64)


def _assigned(lab: FloatArray, centres: FloatArray) -> IntArray:
    from scipy.spatial import cKDTree

    return np.asarray(cKDTree(centres).query(lab)[1], np.int64)


def measured(mask: NDArray[np.bool_], key: int, color: int) -> Proposal:
    """Measure the patches of one class."""
    from scipy import ndimage

    share = float(mask.mean())
    labels, count = label_patches(without_specks(mask, SPECK))
    if count == 0:
        return Proposal(key, color, share, 0, 0.0, 0.0, 0.0)
    area = np.bincount(labels.ravel(), minlength=count + 1)[1:].astype(float)
    boxes = ndimage.find_objects(labels)
    box = np.array([(b[0].stop - b[0].start) * (b[1].stop - b[1].start) for b in boxes], float)
    deep = np.asarray(ndimage.maximum(depth(mask), labels, np.arange(1, count + 1)))
    length = area / np.maximum(2 * deep, 1.0) ** 2
    weight = area / area.sum()
    return Proposal(
        key, color, share, count, float(weight @ length), float(weight @ (area / box)),
        float(weight.max()),
    )  # fmt: skip


def _named(found: list[Proposal]) -> list[Proposal]:
    """Give each proposal its class: the best street, the best houses, the rest by colour."""
    street = max(found, key=_like_street)
    others = [item for item in found if item is not street or _like_street(street) <= 0]
    houses = max(others, key=_like_houses, default=street)
    named = []
    for item in found:
        word = _by_color(item.color)
        if item is street and _like_street(street) > 0:
            word = "road"
        elif item is houses and _like_houses(item) > 0:
            word = "building"
        named.append(replace(item, word=word))
    return named


def _like_street(item: Proposal) -> float:
    """Streets are long and thin, hang together and cover little of their boxes."""
    if item.length < THIN or item.share > 0.6:
        return 0.0
    return float(np.log(item.length) * (MAIN + item.largest) * (1.2 - item.fill))


def _like_houses(item: Proposal) -> float:
    """Houses are many, fill their boxes, and none is larger than the rest together."""
    if item.patches < 4 or item.share > 0.7:
        return 0.0
    return float(np.log(item.patches) * item.fill * (1.2 - item.largest))


def _by_color(color: int) -> str:
    """Guess the land from the colour it is shown in."""
    lightness, green_red, blue_yellow = to_lab(unpacked(np.array([color])))[0].tolist()
    hue = np.degrees(np.arctan2(blue_yellow, green_red)) % 360
    if np.hypot(green_red, blue_yellow) < PALE:
        return "ground"
    if hue < HUES["bare"]:
        return "bare"
    if hue < HUES["green"]:
        return "wood" if lightness < DARK else "vegetation"
    return "water" if hue < HUES["blue"] else "ground"


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

    A map has few colours that cover it, in patches within which nothing changes, and nothing
    between these colours; those of a photograph run into each other.
    """
    best = fitting(picture)
    flat = _flatness(picture)
    covered, colors = _coverage(picture)
    clear = _clearness(picture)
    seen = f"{colors} colours, the {FEW} most frequent on {100 * covered:.0f} % of the pixels; " \
        f"{100 * clear:.0f} % have one of few colours far apart; " \
        f"{100 * flat:.0f} % of the pixels are like their neighbour"  # fmt: skip
    # Photographs of sand and sea have the colours of some legend, but nothing in them is flat.
    if best and flat >= FLAT_LOSSY:
        return Evidence(True, 1.0, f"{best[0].text()}; {seen}")
    enough = FLAT_LOSSY if picture.lossy else FLAT
    semantic = covered >= COVERED and flat >= enough and colors > 1 and clear >= CLEAR
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
    count = np.sort(_counted(picture, CELL)[1])[::-1]
    return float(count[:FEW].sum() / max(count.sum(), 1)), int((count > 0).sum())


def _clearness(picture: Picture) -> float:
    """Return the share of pixels of few colours that nobody would name alike; 1 for values."""
    if picture.values is not None and not picture.lossy:
        return 1.0  # numbers of classes follow each other
    keys, count = _counted(picture, FINE_CELL)
    lab = to_lab(unpacked(keys))
    kept = _apart(lab, count.astype(float), np.lexsort((keys, -count)), REJECT)
    off = np.linalg.norm(lab - lab[kept][_assigned(lab, lab[kept])], axis=1)
    return float(count[off <= NEAR * picture.lossy].sum() / max(count.sum(), 1))


def _counted(picture: Picture, cell: int) -> tuple[IntArray, IntArray]:
    """Return the colours or values of a picture, after compression in cells, and their pixels."""
    by_value = picture.values is not None and not picture.lossy
    if picture.lossy:
        coarse = picture.colors // np.uint8(cell) * np.uint8(cell)
        picture = Picture(None, coarse, picture.void)
    keys, index = picture.distinct(by_value=by_value)
    return keys, np.bincount(index[~picture.void], minlength=len(keys))


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
