"""Crops: what one step of training sees, drawn from pairs, turned, scaled and re-coloured."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from labels import ANYTHING, CLASSES, known
from numpy.typing import NDArray
from pairs import PIXEL, Pair

SIDE = 112  # pixels of a crop; many small steps teach more in an hour than few large ones
SCALES = (0.7, 1.4)  # of the ground resolution
BALANCED = 0.6  # share of crops that are sought around a pixel of a class drawn at random
SEEDS = 400  # pixels kept of each class and pair to seek crops around
# Share of crops from each set; the rest of the world is better known by many places than by one.
SHARES = {"Dubai": 0.55, "Kampala": 0.20, "CityX": 0.25}
GREY = 0.05  # share of crops without colour, for panchromatic images


@dataclass(frozen=True)
class Source:
    """A pair and some pixels of each class in it."""

    pair: Pair
    seeds: tuple[NDArray[np.int64], ...]


def sources_of(pairs: Sequence[Pair], rng: np.random.Generator) -> list[Source]:
    """Find pixels of each class in every pair."""
    found = []
    for pair in pairs:
        seeds = []
        for word in CLASSES:
            spots = np.argwhere(known(pair.labels, word))
            keep = rng.choice(len(spots), min(SEEDS, len(spots)), replace=False)
            seeds.append(spots[keep])
        found.append(Source(pair, tuple(seeds)))
    return found


class Sampler:
    """Draws batches; a class because its stream of random numbers has a life."""

    def __init__(self, sources: Sequence[Source], rng: np.random.Generator) -> None:
        self.rng = rng
        self.sets = {
            place: [item for item in sources if item.pair.place == place] for place in SHARES
        }
        places = [place for place, items in self.sets.items() if items]
        shares = np.array([SHARES[place] for place in places])
        self.places, self.shares = places, shares / shares.sum()

    def batch(self, size: int) -> tuple[NDArray[np.float32], NDArray[np.int64]]:
        """Return (n, 3, SIDE, SIDE) RGB from 0 to 1 and (n, SIDE, SIDE) labels."""
        crops = [self._crop() for _ in range(size)]
        images = np.stack([image for image, _ in crops]).transpose(0, 3, 1, 2)
        return np.ascontiguousarray(images), np.stack([labels for _, labels in crops])

    def _crop(self) -> tuple[NDArray[np.float32], NDArray[np.int64]]:
        items = self.sets[self.places[self.rng.choice(len(self.places), p=self.shares)]]
        word = self.rng.integers(len(CLASSES))
        if self.rng.random() < BALANCED:
            items = [item for item in items if len(item.seeds[word])] or items
        # Larger places are seen more often, but not by all of their size.
        weight = np.sqrt([item.pair.labels.size * item.pair.pixel**2 for item in items])
        item = items[self.rng.choice(len(items), p=weight / weight.sum())]
        seeds = item.seeds[word]
        shape = np.array(item.pair.labels.shape)
        middle = (
            seeds[self.rng.integers(len(seeds))]
            if len(seeds) and self.rng.random() < BALANCED
            else self.rng.integers(shape)
        )
        return self._turned(*self._cut(item.pair, middle))

    def _cut(
        self, pair: Pair, middle: NDArray[np.int64]
    ) -> tuple[NDArray[np.uint8], NDArray[np.uint8]]:
        """Cut a square about a pixel, moved by up to half a side, at a random scale."""
        scale = np.exp(self.rng.uniform(*np.log(SCALES)))
        side = max(8, round(SIDE * PIXEL / pair.pixel * scale))
        corner = middle - (self.rng.random(2) * side).astype(int)
        low = np.maximum(corner, 0)
        high = np.minimum(corner + side, pair.labels.shape)
        where = slice(low[0], high[0]), slice(low[1], high[1])
        image, labels = pair.image[where], pair.labels[where]
        margin = [(low[0] - corner[0], corner[0] + side - high[0]),
                  (low[1] - corner[1], corner[1] + side - high[1])]  # fmt: skip
        labels = np.pad(labels, margin, constant_values=ANYTHING)
        image = cv2.copyMakeBorder(image, *margin[0], *margin[1], cv2.BORDER_REFLECT)
        how = cv2.INTER_AREA if side > SIDE else cv2.INTER_LINEAR
        return (
            cv2.resize(image, (SIDE, SIDE), interpolation=how),
            cv2.resize(labels, (SIDE, SIDE), interpolation=cv2.INTER_NEAREST),
        )

    def _turned(
        self, image: NDArray[np.uint8], labels: NDArray[np.uint8]
    ) -> tuple[NDArray[np.float32], NDArray[np.int64]]:
        turns = int(self.rng.integers(4))
        image, labels = np.rot90(image, turns), np.rot90(labels, turns)
        if self.rng.random() < 0.5:
            image, labels = image[:, ::-1], labels[:, ::-1]
        return self._recoloured(image.astype(np.float32) / 255), labels.astype(np.int64)

    def _recoloured(self, image: NDArray[np.float32]) -> NDArray[np.float32]:
        """Change exposure, contrast, colour cast, sharpness and noise as cameras and haze do."""
        rng = self.rng
        image = image ** np.exp(rng.uniform(-0.3, 0.3))
        gain = rng.uniform(0.85, 1.2) * rng.uniform(0.94, 1.06, 3)
        middle = image.mean()
        image = (image - middle) * rng.uniform(0.8, 1.25) + middle
        image = image * gain + rng.uniform(-0.04, 0.04)
        grey = image.mean(axis=2, keepdims=True)
        colour = 0.0 if rng.random() < GREY else rng.uniform(0.75, 1.25)
        image = grey + (image - grey) * colour
        if rng.random() < 0.3:
            image = cv2.GaussianBlur(image.astype(np.float32), (0, 0), rng.uniform(0.4, 1.1))
        image = image + rng.normal(0, rng.uniform(0, 0.03), image.shape)
        return np.clip(image, 0, 1).astype(np.float32)
