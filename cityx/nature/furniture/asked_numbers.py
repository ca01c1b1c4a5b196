"""Things of which a number was asked for: no rule sets out more of them."""

from __future__ import annotations

import re

import numpy as np

from cityx.checks.predicates.vocabulary import PIECES
from cityx.city import City
from cityx.geometry.arrays import BoolArray
from cityx.ground.pieces import Pieces

_BOUNDED = re.compile(r"n\((\w+)\) (?:==|<=|in) ")  # a number of things that may not be more


def counted(city: City, found: Pieces) -> BoolArray:
    """(n,) whether pieces are of a kind of which no more than a number shall stand in a city."""
    asked = [match[1] for goal in city.goals if (match := _BOUNDED.match(goal.predicate))]
    names = tuple(first for word in asked for first in PIECES.get(word, ()))
    return np.array([bool(names) and str(name).startswith(names) for name in found.name], bool)
