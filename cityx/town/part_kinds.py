"""Kinds of parts of buildings that can be asked for by themselves, and how each is measured."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from cityx.checks.predicates.words import PAINTED
from cityx.system.tables import table
from cityx.town.elements import ELEMENTS
from cityx.town.quarter_kinds import KINDS

MANY = 0.5  # of the buildings of a kind, at least, that have what not every one has room for
SPARSE = ("awning",)  # over shopfronts alone
EACH, MUCH = 0.9, 1e6  # of the houses; square metres that no garden has
# Houses by the walls they share -> which they are, how many walls, and the share of them.
WALLS: Mapping[str, tuple[str, str, float]] = {
    "detached": ("building, type=house", "= 0", 0.95),
    "semi": ("building, type=house", "= 1", 0.85),
    "terraced": ("building, tag=terrace", "in [1, 2]", 0.9),
}
ALL = 0.999  # of the buildings of a kind


@dataclass(frozen=True)
class PartKind:
    """How a part of a building is made, and by which words it is called.

    Attributes
    ----------
    words
        Words for one of them.
    body
        Key of `BODY_PARTS` that it is measured as, "" where it is no volume.
    added
        What is put on the finished building, "" for nothing; see `edit/add_parts-v1`.
    at
        "front" (its middle, then its corners), "corner", "rear corner" or "roof".
    wide
        Least and greatest side of its plan, metres.
    high
        Times the height of its host.
    roof, point
        Word of roof:shape=*, and its height over the side of the plan.
    floors
        Metres of a storey, 0 for a shaft.
    round
        Whether its plan is.
    material
        Of its walls, "" where the host's is taken.
    slim
        Height over the side of the plan that it is widened for, 0 for none.
    plot
        Square metres at least of what lies beside a house, 0 for what is part of a building.
    """

    name: str
    words: tuple[str, ...]
    body: str = ""
    added: str = ""
    at: str = "front"
    wide: tuple[float, float] = (4.0, 7.0)
    high: float = 1.8
    roof: str = "flat"
    point: float = 0.0
    floors: float = 0.0
    round: bool = False
    material: str = ""
    slim: float = 0.0
    plot: float = 0.0


PART_KINDS: Mapping[str, PartKind] = table("town/host_parts", PartKind)


def _hosts() -> dict[str, str]:
    """Return the buildings that may have parts, by their kinds, in the language of predicates."""
    own = {name: one.measure for name, one in ELEMENTS.items() if one.building}
    built = {name: measure for name, measure in own.items() if measure.startswith("building")}
    return {**built, **{name: kind.chosen for name, kind in KINDS.items()}}


HOSTS: Mapping[str, str] = _hosts()


def counted(host: str, part: str, least: int | None, most: int | None) -> Iterator[str]:
    """Yield the predicates that all hosts of a kind have so many of a part."""
    chosen, kind = HOSTS[host], PART_KINDS[part]
    if kind.body:
        number = f"stat({chosen}, {kind.body}s"
        if least:
            yield f"{number}, min) >= {least}"
        if most is not None:
            yield f"{number}, max) <= {most}"
    if kind.plot:
        yield (
            beside_houses(host, part, kind.plot)
            if most != 0
            else (f"n({chosen}, {part} in [{kind.plot:g}, {MUCH:g}]) == 0")
        )
    if kind.added:
        if most == 0:
            yield f"n({chosen}, has={kind.added}) == 0"
        elif kind.body or (host in ELEMENTS and part == "clock"):
            yield f"share({chosen}, has={kind.added}) >= {ALL}"
        elif part in SPARSE:
            yield f"n({chosen}, has={kind.added}) >= 1"
        else:
            yield f"share({chosen}, has={kind.added}) >= {MANY}"


def beside_houses(host: str, part: str, least: float, most: float = MUCH) -> str:
    """Return the predicate that houses have so many square metres of a part beside them."""
    share = EACH if part == "garden" else MANY
    return f"share({HOSTS[host]}, {part} in [{least:.8g}, {most:.8g}]) >= {share}"


def built_as(walls: str) -> str:
    """Return the predicate that houses share as many walls as a word says."""
    chosen, number, share = WALLS[walls]
    return f"share({chosen}, attached {number}) >= {share}"


def as_high(host: str, part: str, low: float, high: float) -> str:
    """Return the predicate that the highest part of each host is as high as is said."""
    heights = f"{PART_KINDS[part].body}_height in [{low:.8g}, {high:.8g}]"
    return f"share({HOSTS[host]}, {heights}) >= {ALL}"


def looks(host: str, part: str, look: str, word: str) -> str:
    """Return the predicate that the parts of hosts have a colour or are of a material.

    "" where nothing measures it.
    """
    kind = PART_KINDS[part]
    if kind.body:
        return f"share({HOSTS[host]}, {kind.body}_{look}={word}) >= {ALL}"
    if look == "color" and kind.added in PAINTED:
        own = f"n({HOSTS[host]}, {kind.added}_color={word})"
        return f"{own} / max(n({HOSTS[host]}, has={kind.added}), 1) >= {MANY}"
    return ""
