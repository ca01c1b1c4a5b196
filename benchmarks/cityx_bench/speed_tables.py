"""What `cityx_bench.speed` measured as tables: builds, phases, steps, pictures, peers."""

from __future__ import annotations

import statistics
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any

from cityx.errors import InputError
from cityx.system.atomic import replaced
from cityx_bench.peers import PEERS
from cityx_bench.speed import COLD, MADE, MAPS, PICTURED, WARM, Run

# Steps of a report by what they belong to: how their names begin. A picture is not of a scene.
PHASES: Mapping[str, tuple[str, ...]] = MappingProxyType({
    "start": ("start", "request", "import"),
    "read": ("layout/",),
    "buildings": ("building/",),
    "streets": ("road/", "background/"),
    "nature": ("nature/",),
    "checks": ("checks", "goals", "counts"),
    "fidelity": ("fidelity",),
    "store": ("store", "snapshot"),
    "glb": ("glb",),
    "pictures": ("blender light", "blender draft", "blender render"),
    "blend": ("blender save",),
    "scene": ("blender",),
})  # fmt: skip
REST, OTHER = "rest", "other"
BEGIN, FINISH = "<!-- begin: cityx bench speed -->", "<!-- end: cityx bench speed -->"
ACTIONS = 12  # that the table of actions has room for


def phases_of(run: Run, *, of: str = "phases", whole: str = "cpu_s") -> dict[str, float]:
    """Return the seconds of a build by what they belong to; with all of it they add up."""
    spent = dict.fromkeys((*PHASES, OTHER), 0.0)
    for step, taken in run[of].items():
        spent[_phase_of(step)] += taken
    return {**spent, REST: run[whole] - sum(spent.values())}


def _phase_of(step: str) -> str:
    for phase, begins in PHASES.items():
        if step.startswith(begins):
            return phase
    return OTHER


def text_of(record: Mapping[str, Any]) -> str:
    """Return what was measured as tables in Markdown, with what was skipped and why."""
    runs = record["runs"]
    parts = [table_of(rows(runs)) for rows in (_builds, _phases, _actions, _pictures, _beside)
             if rows(runs)]  # fmt: skip
    parts += filter(None, [_empty_ground(runs)])
    parts += [f"{run['map']} at level {run['lod']}, {run['build']}: {run['error']}."
              for run in runs if "build" in run and "error" in run]  # fmt: skip
    parts += [f"Not run: {name}, since {reason}." for name, reason in record["skipped"].items()]
    codes = ", ".join(dict.fromkeys(run["code"] for run in runs))
    return "\n\n".join([*parts, f"Measured of the state {codes} of CityX."])


def _of(runs: Iterable[Run], build: str) -> dict[tuple[str, int], list[Run]]:
    """Return the builds of a kind that ended, by map and level of detail."""
    found: dict[tuple[str, int], list[Run]] = {}
    for run in runs:
        if run.get("build") == build and "error" not in run:
            found.setdefault((run["map"], run["lod"]), []).append(run)
    return found


def _median(values: Iterable[float]) -> float:
    return statistics.median(values)


def _builds(runs: Iterable[Run]) -> list[dict[str, Any]]:
    """Return the rows of whole builds."""
    runs = list(runs)
    cold = _of(runs, COLD)
    rows = []
    for (name, lod), own in _of(runs, WARM).items():
        cpu, run = _median(one["cpu_s"] for one in own), own[-1]
        first = [one["cpu_s"] for one in cold.get((name, lod), ())]
        rows.append({
            "map": name.partition(".")[0],
            "kind": MAPS.get(name, "made" if name in MADE else ""),
            "LOD": lod,
            "buildings": f"{run['buildings']:,.0f}",
            "km2": f"{run['km2']:.2f}",
            "built": f"{run['built_km2']:.2f}",
            "CPU s": f"{cpu:.1f}",
            "cold": f"{_median(first):.1f}" if first else "",
            "clock s": f"{_median(one['clock_s'] for one in own):.1f}",
            "peak MB": f"{max(one['peak_mb'] for one in own):.0f}",
            "ms/building": _per(1000 * cpu, run["buildings"]),
            "s/km2 built": _per(cpu, run["built_km2"]),
            "M triangles": f"{run['written'] / 1e6:.2f}",
            "s/M": _per(cpu, run["written"] / 1e6),
            "GLB MB": f"{run['glb_mb']:.0f}",
        })  # fmt: skip
    return rows


def _per(amount: float, of: float) -> str:
    """Return a share with three digits that count, or nothing of nothing."""
    return f"{amount / of:.3g}" if of else ""


def _phases(runs: Iterable[Run]) -> list[dict[str, Any]]:
    """Return the rows of the phases of builds, CPU seconds."""
    rows: list[dict[str, Any]] = []
    for (name, lod), own in _of(runs, WARM).items():
        each = [phases_of(run) for run in own]
        row = {phase: f"{_median(one[phase] for one in each):.2f}" for phase in each[0]}
        rows.append({"map": name.partition(".")[0], "LOD": lod, **row})
    used = [key for key in rows[0] if key not in PHASES or any(float(row[key]) for row in rows)
            ] if rows else []  # fmt: skip
    return [{key: row[key] for key in used} for row in rows]


def _actions(runs: Iterable[Run]) -> list[dict[str, Any]]:
    """Return the rows of the steps that take most of all maps together, and where each does."""
    spent: dict[str, dict[str, float]] = {}
    whole = 0.0
    for (name, _), own in _of(runs, WARM).items():
        whole += _median(run["cpu_s"] for run in own)
        for step in own[-1]["phases"]:
            of_step = spent.setdefault(step, {})
            taken = _median(run["phases"].get(step, 0.0) for run in own)
            of_step[name] = of_step.get(name, 0.0) + taken
    most = sorted(spent, key=lambda step: -sum(spent[step].values()))[:ACTIONS]
    return [
        {
            "step": step,
            "CPU s": f"{sum(spent[step].values()):.1f}",
            "share": f"{sum(spent[step].values()) / whole:.1%}",
            "most": max(spent[step], key=lambda name: spent[step][name]).partition(".")[0],
            "CPU s there": f"{max(spent[step].values()):.1f}",
        }
        for step in most
    ]


def _pictures(runs: Iterable[Run]) -> list[dict[str, Any]]:
    """Return the rows of pictures."""
    rows = []
    for (name, lod), own in _of(runs, PICTURED).items():
        for picture in own[-1]["pictures"]:
            steps = [f"{step} {picture}" for step in PHASES["pictures"]]
            took = {
                of: _median(sum(run[of].get(step, 0.0) for step in steps) for run in own)
                for of in ("clock", "phases")
            }
            rows.append({
                "map": name.partition(".")[0], "LOD": lod, "picture": picture,
                "clock s": f"{took['clock']:.1f}", "CPU s": f"{took['phases']:.1f}",
            })  # fmt: skip
    return rows


def _beside(runs: Iterable[Run]) -> list[dict[str, Any]]:
    """Return the rows of what peers take beside the steps of ours that come as far."""
    runs = list(runs)
    warm = _of(runs, WARM)
    rows = []
    for run in runs:
        peer, own = PEERS.get(run.get("peer", "")), warm.get((run["map"], run["lod"]))
        if peer is None or not own:
            continue
        ours = _median(sum(one["phases"].get(step, 0.0) for step in peer.steps) for one in own)
        theirs = run.get("cpu_s")
        rows.append({
            "map": run["map"].partition(".")[0],
            "peer": peer.name,
            "makes": peer.makes,
            "our steps": ", ".join(peer.steps),
            "peer s": run["error"] if theirs is None else f"{theirs:.2f}",
            "ours s": f"{ours:.2f}",
            "ours / peer": "" if theirs is None else _per(ours, theirs),
        })  # fmt: skip
    return rows


def _empty_ground(runs: Iterable[Run]) -> str:
    """Say what 100 km2 of empty ground take: a village within them less the village alone."""
    warm = _of(runs, WARM)
    told = []
    for name, lod in warm:
        alone, spread = warm.get((MADE[0], lod)), warm.get((MADE[1], lod))
        if name == MADE[1] and alone and spread:
            more = _median(run["cpu_s"] for run in spread) - _median(run["cpu_s"] for run in alone)
            km2 = spread[-1]["km2"] - alone[-1]["km2"]
            told.append(f"{100 * more / km2:.1f} CPU s at level {lod}")
    return f"100 km2 of empty ground (fields, woods, tracks): {', '.join(told)}." if told else ""


def table_of(rows: Sequence[Mapping[str, Any]]) -> str:
    """Write rows as a Markdown table."""
    head = list(rows[0])
    lines = ["| " + " | ".join(head) + " |", "|" + " --- |" * len(head)]
    lines += ["| " + " | ".join(str(row[key]) for key in head) + " |" for row in rows]
    return "\n".join(lines)


def write_into(page: Path, text: str) -> None:
    """Replace what stands between the marks of a page.

    Raises
    ------
    InputError
        When the page has no marks.
    """
    old = page.read_text(encoding="utf-8") if page.exists() else ""
    if BEGIN not in old or FINISH not in old:
        raise InputError(f"{page} has no place for the table: {BEGIN} and {FINISH}.")
    before, rest = old.split(BEGIN, 1)
    with replaced(page) as temporary:
        temporary.write_text(
            f"{before}{BEGIN}\n{text}\n{FINISH}{rest.split(FINISH, 1)[1]}", encoding="utf-8"
        )
