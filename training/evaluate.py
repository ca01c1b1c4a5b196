"""Measure a segmenter on places that training never saw, through CityX's own inference.

    python training/evaluate.py --data ../shared/data/satellite [--model FILE.onnx | none] [--flips]
        [--card docs/model_card.md]

Prints a table in Markdown; with --card it takes the place of the table in the card.
"""

from __future__ import annotations

import argparse
import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from labels import CLASSES, allowed, known
from numpy.typing import NDArray
from pairs import Pair, dubai, kampala

from cityx.sources.satellite.segmented import SURE, segment, unlearned_segmenter
from cityx.sources.satellite.segmenter import Segmenter, load_segmenter, shipped_segmenter

TABLE = re.compile(r"(?<=<!-- measured -->\n).*?(?=<!-- end -->)", re.DOTALL)


@dataclass
class Counts:
    """Pixels of each class: seen and true, seen or true, and true; mutable, as images add up."""

    both: NDArray[np.int64]
    either: NDArray[np.int64]
    true: NDArray[np.int64]
    right: int = 0
    told: int = 0
    confidence: float = 0.0

    @classmethod
    def none(cls) -> Counts:
        """Return counts of nothing."""
        return cls(*(np.zeros(len(CLASSES), np.int64) for _ in range(3)))

    def add(self, pair: Pair, seen: NDArray[np.uint8], confidence: NDArray[np.uint8]) -> None:
        """Count the pixels of a pair where the labels tell whether a class is there."""
        opened = allowed()[pair.labels]  # (rows, columns, classes)
        for index, word in enumerate(CLASSES):
            true = known(pair.labels, word)
            decided = true | ~opened[..., index]
            here = (seen == index) & decided
            self.both[index] += np.count_nonzero(here & true)
            self.either[index] += np.count_nonzero(here | true)
            self.true[index] += np.count_nonzero(true)
        told = ~opened.all(axis=2)
        agrees = np.take_along_axis(opened, seen[..., None].astype(np.int64), axis=2)[..., 0]
        self.right += np.count_nonzero(agrees & told)
        self.told += np.count_nonzero(told)
        self.confidence += float(confidence[told].sum()) / SURE


def measured(pairs: Iterable[Pair], segmenter: Segmenter, *, flips: bool) -> dict[str, Counts]:
    """Segment pairs and count, by set."""
    found: dict[str, Counts] = {}
    channel = [[item.word for item in segmenter.classes].index(word) for word in CLASSES]
    place = np.argsort(channel).astype(np.uint8)
    for pair in pairs:
        fitting = pair.at(segmenter.pixel or pair.pixel)
        seen = segment(fitting.image, segmenter, flips=flips)
        counts = found.setdefault(pair.place, Counts.none())
        counts.add(fitting, place[seen.labels], seen.confidence)
    return found


def table(found: dict[str, Counts]) -> str:
    """Write the intersection over union of each class and set, in Markdown."""
    head = ["held-back place", *CLASSES, "mean", "pixels right", "mean confidence"]
    lines = [f"| {' | '.join(head)} |", f"| {' | '.join('---' for _ in head)} |"]
    for place, counts in found.items():
        there = counts.true > 0
        iou = counts.both / np.maximum(counts.either, 1)
        cells = [f"{value:.2f}" if has else "" for value, has in zip(iou, there, strict=True)]
        cells += [f"{iou[there].mean():.2f}", f"{100 * counts.right / counts.told:.0f} %"]
        cells.append(f"{counts.confidence / counts.told:.2f}")
        lines.append(f"| {place} | {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


def main() -> None:
    """Measure what the command line asks for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--data", type=Path, required=True, help="the folder satellite")
    parser.add_argument("--model", help='ONNX file, "none" for colour and texture alone')
    parser.add_argument("--flips", action="store_true")
    parser.add_argument("--card", type=Path)
    options = parser.parse_args()
    if options.model is None:
        segmenter = shipped_segmenter()
    elif options.model == "none":
        segmenter = unlearned_segmenter()
    else:
        segmenter = load_segmenter(Path(options.model))
    pairs = [*dubai(options.data), *kampala(options.data)]
    held_back = [pair for pair in pairs if pair.held_back]
    text = table(measured(held_back, segmenter, flips=options.flips))
    print(text)
    if options.card:
        options.card.write_text(TABLE.sub(lambda _: text, options.card.read_text()))


if __name__ == "__main__":
    main()
