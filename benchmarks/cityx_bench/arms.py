"""The ablation: the same tasks, planned with parts of the actions' records hidden."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from cityx.agents.ablation import ARMS, UNSAID
from cityx.system.atomic import replaced
from cityx_bench.report import rate_cell
from cityx_bench.scoring import Rate, Sample, rates_of

FULL = ARMS[0]
MEANING = (
    "D is the description, I the input, L the limitation of the actions, as the offline planner "
    "reads them: this measures what the records tell a symbolic planner, not a language model. "
    "p is McNemar's exact test against all three."
)


def name_of(arm: str) -> str:
    """Return the name of an arm: "D + L", or "none"."""
    return " + ".join(arm) or "none"


def driver_of(arm: str) -> str:
    """Return the name of the driver of an arm."""
    return "offline" if arm == FULL else f"offline:{arm or UNSAID}"


def chance(full: Sequence[Sample], less: Sequence[Sample]) -> float:
    """Return how likely so uneven an outcome is by chance: McNemar's exact test on pairs."""
    from scipy.stats import binomtest

    other = {(sample.task, sample.seed): sample for sample in less}
    pairs = [(one.right, other[one.task, one.seed].right) for one in full
             if one.scored and (one.task, one.seed) in other]  # fmt: skip
    lost = sum(before and not after for before, after in pairs)
    won = sum(after and not before for before, after in pairs)
    return float(binomtest(lost, lost + won).pvalue) if lost + won else 1.0


def ablation_of(samples: Mapping[str, Sequence[Sample]]) -> list[dict[str, Any]]:
    """Return a record for each arm: its rates, and how it compares with the full one.

    Parameters
    ----------
    samples
        Arm to its samples.
    """
    found = []
    for arm, own in samples.items():
        record: dict[str, Any] = {"arm": name_of(arm), **rates_of(own).to_json()}
        if arm != FULL and FULL in samples:
            record["p"] = round(chance(samples[FULL], own), 4)
        found.append(record)
    return found


def write_ablation(
    samples: Mapping[str, Sequence[Sample]], command: str, folder: Path
) -> list[str]:
    """Write ablation.json and ablation.md into a folder, and return the lines of the table."""
    records = ablation_of(samples)
    lines = [*arms_table(records)]
    with replaced(folder / "ablation.json") as temporary:
        temporary.write_text(json.dumps({"command": command, "arms": records}, indent=1))
    with replaced(folder / "ablation.md") as temporary:
        text = "\n".join(lines)
        temporary.write_text(f"# Ablation\n\n`{command}`\n\n{text}\n\n{MEANING}\n")
    return lines


def arms_table(records: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    """Yield the table of the arms; records as of `ablation_of`."""
    yield "| shown | executed (ER@1) | right of executed (SR@1) | right of all | p |"
    yield "| --- | --- | --- | --- | --- |"
    for record in records:
        cells = [
            rate_cell(Rate(record[key]["hits"], record[key]["of"]))
            for key in ("executed", "right_of_executed", "right")
        ]
        p = "" if "p" not in record else f"{record['p']:.4f}" if record["p"] else "< 0.0001"
        yield f"| {record['arm']} | {' | '.join(cells)} | {p} |"
