"""Styles: which generators make a building of a style, by the use of the building.

A generator speaks of a style where it is common in the style's own towns and, compared with the
towns of other styles, not rare: a glass tower stands in every town, and speaks of modern ones. The
tables are those that towns are built by, so a town of a style has 0.8 or more of it.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

from cityx.assets.styles.palette_tables import GROUPS, REGIONAL, STYLES, SYNONYMS
from cityx.assets.styles.style_tables import ALWAYS, STYLE_WORDS, TABLE

LEAST = 0.04  # of the buildings of a use, from which a generator is common in a style
PART = 0.33  # of its share in the style that has most of it, from which it is not rare
STRAY = 0.02  # of the weight that a word of a brief gives to generators new to a family
KNOWN = tuple(sorted({*STYLES, *SYNONYMS, *STYLE_WORDS}))


@cache
def speaking_of(style: str) -> Mapping[str, frozenset[str]]:
    """Return the generators that make a building of a style, by use group.

    Groups that every style builds alike (industry, worship, sheds) have none: they speak of no
    style.
    """
    boost = STYLE_WORDS.get(style, {})
    if style in REGIONAL:
        most = max(boost.values())
        return dict.fromkeys(TABLE["european"], frozenset(k for k, v in boost.items() if v == most))
    own = _shares(SYNONYMS.get(style, style), style)
    return {
        group: frozenset(
            name for name, share in row.items()
            if share >= LEAST and share >= PART * _greatest(group).get(name, 0.0)
        )
        for group, row in own.items()
    }  # fmt: skip


@cache
def of_any_style() -> Mapping[str, frozenset[str]]:
    """Return the generators that some style's towns are built of, by use group."""
    return {group: frozenset(_greatest(group)) for group in GROUPS if group not in ALWAYS}


def _shares(family: str, style: str = "") -> dict[str, dict[str, float]]:
    """Return the share of every generator among the buildings of a use, by group."""
    boost = STYLE_WORDS.get(style, {})
    found = {}
    for group, row in TABLE[family].items():
        weight = {name: value * boost.get(name, 1.0) for name, value in row.items()}
        weight |= {k: STRAY * v for k, v in boost.items() if k not in row and v > 1}
        total = sum(weight.values())
        found[group] = {name: value / total for name, value in weight.items()}
    return found


@cache
def _greatest(group: str) -> Mapping[str, float]:
    found: dict[str, float] = {}
    for family in TABLE:
        for name, share in _shares(family)[group].items():
            found[name] = max(found.get(name, 0.0), share)
    return found
