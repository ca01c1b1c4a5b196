"""Findings: what came of measuring a predicate, and a city without gross faults among them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

from cityx.checks.building_checks import check_buildings
from cityx.checks.check import Check
from cityx.checks.furniture_checks import check_furniture, check_standing, check_trees
from cityx.checks.movement_checks import check_movement
from cityx.checks.shell_checks import check_meshes, check_shells
from cityx.checks.terrain_checks import check_bounds, check_ground
from cityx.city import City

RUN: tuple[Callable[[City], Iterable[Check]], ...] = (
    check_buildings, check_shells, check_ground, check_furniture, check_standing, check_trees,
    check_meshes, check_bounds, check_movement,
)  # fmt: skip
# Rule of a clean city -> checks that decide it.
RULES: Mapping[str, tuple[str, ...]] = {
    "no two buildings share ground": ("building_overlap",),
    "no building stands on a road": ("building_on_road", "building_in_street"),
    "nothing floats or is buried": ("floating_building", "building_buried", "things_off_ground"),
    "nothing stands in a lane": ("trees_in_lanes", "furniture_in_lanes", "trees_misplaced"),
    "nothing moves off its feasible area": (
        "vehicles_off_lane",
        "pedestrians_off_walkable",
        "movers_in_buildings",
        "movers_off_ground",
    ),
    "every number is finite": ("not_finite",),
    "everything lies within the site": ("outside_site",),
}


@dataclass(frozen=True)
class Finding:
    """Whether a predicate holds.

    Attributes
    ----------
    met
        None when it cannot be told.
    evidence
        What was measured, or why it cannot be told.
    value
        The measured number, the words that hold, or the truth; None when it cannot be told.
    """

    met: bool | None
    evidence: str
    value: float | bool | tuple[str, ...] | None = None


@dataclass(frozen=True)
class Measured:
    """What was measured.

    Attributes
    ----------
    value
        A number, whether something holds, or the words that hold.
    evidence
        What was seen.
    """

    value: float | bool | tuple[str, ...]
    evidence: str


def clean(city: City) -> list[Finding]:
    """Measure every rule of a clean city; a rule of things that are not there holds.

    Returns
    -------
    findings
        One for each rule; the evidence names the checks.
    """
    checks = {check.name: check for run in RUN for check in run(city)}
    return [_finding(rule, names, checks) for rule, names in RULES.items()]


def _finding(rule: str, names: tuple[str, ...], checks: Mapping[str, Check]) -> Finding:
    own = [checks[name] for name in names if name in checks]
    bad = [check for check in own if not check.ok]
    shown = "; ".join(f"{c.name} {c.value:g} (limit {c.limit:g})" for c in bad or own)
    return Finding(not bad, f"{rule}: {shown or 'nothing to check'}", not bad)
