"""Labels: what a pixel may be, one bit per class, so that half-known places can teach too.

A pixel of a mask holds the sum of the bits of every class it may be. Known pixels have one bit;
"no building, else unknown" has all the others; nothing known has all of them.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

# In the order of the network's channels; the words are those of a map's legend.
CLASSES = ("building", "road", "vegetation", "water", "bare")
ANYTHING = (1 << len(CLASSES)) - 1


def may_be(*words: str) -> int:
    """Return the label of a pixel that is one of some classes."""
    return sum(1 << CLASSES.index(word) for word in set(words))


def known(labels: NDArray[np.uint8], word: str) -> NDArray[np.bool_]:
    """Return which pixels are surely of a class."""
    return labels == may_be(word)


def allowed(words: Iterable[str] = CLASSES) -> NDArray[np.bool_]:
    """Return (2 ** classes, classes) bool: row label, which classes it leaves open."""
    columns = [(np.arange(ANYTHING + 1) >> CLASSES.index(word)) & 1 for word in words]
    return np.stack(columns, axis=1).astype(bool)
