"""Styles: which generators make a building of a style, by the use of the building.

A generator speaks of a style where it is common in the style's own towns and, compared with the
towns of other styles, not rare: a glass tower stands in every town, and speaks of modern ones. The
tables are those that towns are built by, so a town of a style has 0.8 or more of it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from types import MappingProxyType

from cityx.assets.styles.package_generators import outside_buildings
from cityx.assets.styles.palette_tables import GROUPS, REGIONAL, STYLES, SYNONYMS
from cityx.protocol.plugged import Weight
from cityx.system.extensions import refuse, remembered
from cityx.system.tables import DATA, read_table

Weights = Mapping[str, float]
_HELD = read_table(DATA / "styles.toml")

# Style family -> use group -> generators and weights.
TABLE: Mapping[str, Mapping[str, Weights]] = MappingProxyType(_HELD["families"])
ALWAYS: Mapping[str, Weights] = MappingProxyType(_HELD["always"])
# Words of a brief that favour generators, and by how much, whatever the family.
STYLE_WORDS: Mapping[str, Weights] = MappingProxyType(_HELD["words"])
LEAST = 0.04  # of the buildings of a use, from which a generator is common in a style
PART = 0.33  # of its share in the style that has most of it, from which it is not rare
STRAY = 0.02  # of the weight that a word of a brief gives to generators new to a family
KNOWN = tuple(sorted({*STYLES, *SYNONYMS, *STYLE_WORDS}))
EVERYWHERE = "*"  # style of a generator from outside that stands in every town


@remembered
def outside_styles() -> frozenset[str]:
    """Return the style words that installed packages add."""
    said = {word for made in outside_buildings().values() for word in made.styles}
    if not said:
        return frozenset()
    from cityx.places.profiles import profile_names  # with libraries that a reader need not load

    return frozenset(said - {*KNOWN, *REGIONAL, *profile_names(), EVERYWHERE})


def known_styles() -> tuple[str, ...]:
    """Return every style word, those of installed packages too."""
    return tuple(sorted({*KNOWN, *outside_styles()}))


def outside_weight(
    name: str, group: str, style: str, family: str, lineage: Sequence[str] = ()
) -> float:
    """Return the weight of a generator from outside in a town, 0 for those of CityX.

    Parameters
    ----------
    group
        Use of the building, one of `GROUPS`.
    style, family, lineage
        The word asked for, "" for none, its family, and the names of the profiles of the place,
        which count without a style.
    """
    made = outside_buildings().get(name)
    if made is None:
        return 0.0
    word = style.strip().lower().replace(" ", "_")
    keys = {EVERYWHERE, family, word, *(() if word else lineage)}
    return sum(_of_group(said, group, name) for key, said in made.styles.items()
               if key in keys)  # fmt: skip


def _of_group(said: Weight, group: str, name: str) -> float:
    if not isinstance(said, Mapping):
        return float(said) if group not in ALWAYS else 0.0
    for word in sorted(set(said) - set(GROUPS)):
        refuse(f'Building "{name}": "{word}" is no use of buildings; uses: {", ".join(GROUPS)}.')
    return float(said.get(group, 0.0))


def speaking_of(style: str) -> Mapping[str, frozenset[str]]:
    """Return the generators that make a building of a style, by use group.

    Groups that every style builds alike (industry, worship, sheds) have none but those from
    outside: they speak of no style.
    """
    found = {} if style in outside_styles() else dict(_built_in_speaking_of(style))
    family = SYNONYMS.get(style, style)
    for name, made in outside_buildings().items():
        if style in made.styles or family in made.styles:
            for group in GROUPS:
                if outside_weight(name, group, style, family) > 0:
                    found[group] = found.get(group, frozenset()) | {name}
    return found


@cache
def _built_in_speaking_of(style: str) -> Mapping[str, frozenset[str]]:
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


@remembered
def of_any_style() -> Mapping[str, frozenset[str]]:
    """Return the generators that some style's towns are built of, by use group."""
    outside = {name for name, made in outside_buildings().items() if made.styles}
    return {group: frozenset(_greatest(group)) | outside for group in GROUPS if group not in ALWAYS}


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
