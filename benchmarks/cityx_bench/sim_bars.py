"""Bars of the simulator: fourteen, each with what was measured, and reached, missed or neither."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from cityx.sim.walks import Walks
from cityx.sim.world import World

# What each bar is about; `docs/simulator.md` tells of them.
BARS: Mapping[int, str] = {
    1: "rates of batches and of one environment", 2: "rates of large observations",
    3: "routes that fit, lanes that are certified", 4: "a driver by rule arrives",
    5: "traffic keeps moving, overlaps nowhere, halts at red", 6: "cameras", 7: "LiDAR",
    8: "contact", 9: "the same bytes", 10: "checkers, spaces, numbers", 11: "how soon it begins",
    12: "a policy learns", 13: "every map", 14: "recordings drive again",
}  # fmt: skip
REACHED, MISSED, ABSENT = "reached", "missed", "not measured"


@dataclass(frozen=True)
class Finding:
    """One figure.

    Attributes
    ----------
    what, figure
        What was measured, and what came of it, or why it was not.
    demanded
        What the bar asks for; "" where the figure stands there to compare.
    reached
        None where it was not measured, or nothing is demanded.
    """

    what: str
    figure: str
    demanded: str = ""
    reached: bool | None = None


@dataclass(frozen=True)
class Place:
    """A built city that is measured.

    Attributes
    ----------
    name, folder
        Of the city.
    world, walks
        Compiled; no walks where nobody can walk there.
    """

    name: str
    folder: Path
    world: World
    walks: Walks | None


@dataclass(frozen=True)
class Asked:
    """What is measured, and how long.

    Attributes
    ----------
    places
        The first is where rates are measured.
    quick
        Whether a tenth of the steps is enough.
    maps
        Maps that are stepped by chance.
    limit
        Seconds of processor time of each process of a map.
    learn
        Seconds of processor time that a policy learns for, 0 for not at all.
    out
        Folder of recordings that are driven again, now and by later versions.
    """

    places: Sequence[Place]
    quick: bool
    maps: Sequence[Path]
    limit: int
    learn: float
    out: Path


Measure = Callable[[Asked], Iterator[Finding]]


def missing(what: str) -> Finding:
    """Return that something was not measured, and why."""
    return Finding(ABSENT, what)


def at_least(what: str, value: float, bar: float, form: str = ",.0f") -> Finding:
    """Return a figure that is to be so large."""
    return Finding(what, format(value, form), f"at least {format(bar, form)}", value >= bar)


def at_most(what: str, value: float, bar: float, form: str = ",.0f") -> Finding:
    """Return a figure that may be so large."""
    return Finding(what, format(value, form), f"at most {format(bar, form)}", value <= bar)


def verdict(findings: Sequence[Finding]) -> str:
    """Return what is true of a bar: missed if one figure is, reached if all of them are."""
    held = [each.reached for each in findings if each.demanded or each.what == ABSENT]
    if False in held:
        return MISSED
    return ABSENT if not held or None in held else REACHED


def told(number: int, findings: Sequence[Finding]) -> list[str]:
    """Return a bar as lines."""
    lines = [f"{number:2d}. {BARS[number]}: {verdict(findings)}"]
    for each in findings:
        mark = {True: "reached", False: "missed", None: ""}[each.reached]
        bar = f"({each.demanded})" if each.demanded else ""
        lines.append(f"      {each.what:<58} {each.figure:>16}  {bar} {mark}".rstrip())
    return lines


def measured(asked: Asked, measures: Mapping[int, Measure], say: Callable[[str], None],
             only: Sequence[int] = ()) -> dict[int, list[Finding]]:  # fmt: skip
    """Measure bars one after the other and tell each as it is done."""
    found: dict[int, list[Finding]] = {}
    for number, measure in measures.items():
        if only and number not in only:
            continue
        found[number] = list(measure(asked))
        for line in told(number, found[number]):
            say(line)
    counts = {word: sum(verdict(each) == word for each in found.values())
              for word in (REACHED, MISSED, ABSENT)}  # fmt: skip
    say(f"of {len(found)} bars " + ", ".join(f"{count} {word}" for word, count in counts.items()))
    return found
