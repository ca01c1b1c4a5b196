"""The page of results: the tables of every benchmark, made of its log, each below its command."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Mapping
from math import nan
from pathlib import Path
from typing import Any

from cityx.agents.ablation import ARMS, arm_of
from cityx.errors import InputError
from cityx.protocol.catalogue import registry_hash
from cityx.protocol.registry import registry
from cityx.system.atomic import replaced
from cityx_bench import paper, quality, speed, speed_tables
from cityx_bench.arms import FULL, MEANING, ablation_of, arms_table, name_of
from cityx_bench.battery import KINDS
from cityx_bench.report import counts_table, rate_cell, results_of, tables_of
from cityx_bench.runner import LOG, read_log
from cityx_bench.scoring import Rates, Sample, fault_codes, rates_of
from cityx_bench.survey.answers import read_ratings, scores_of
from cityx_bench.survey.answers import table_of as table_of_scores
from cityx_bench.survey.study import ANSWERS, STUDY, read_study
from cityx_bench.tasks import read_tasks

PLOT = "quality.svg"  # beside the page
SHOWN = 8  # hexadecimal digits of a registry's digest
FLOORS = ("null", "random")  # drivers of which nobody needs to know what they miss
Lines = Iterator[str]
Group = tuple[Sample, ...]


def write_page(logs: Path, page: Path) -> None:
    """Write the page of results.

    Parameters
    ----------
    logs
        Folder of the folders that the benchmarks write: inputs, agents, ablation, quality, speed,
        survey. A table whose log is missing is one line that tells the command of it.
    page
        The page, Markdown; the plot of quality goes beside it.

    Raises
    ------
    InputError
        If a log is there and cannot be read.
    """
    page.parent.mkdir(parents=True, exist_ok=True)
    if rows := _all_cities(logs):
        with replaced(page.parent / PLOT) as temporary:
            temporary.write_text(quality.plot_of(rows), encoding="utf-8")
    with replaced(page) as temporary:
        temporary.write_text(page_of(logs, page), encoding="utf-8")


def page_of(logs: Path, page: Path) -> str:
    """Return the text of the page; arguments as of `write_page`."""
    parts: Mapping[str, Callable[[Path], Lines]] = {
        "Inputs": lambda folder: _inputs(folder / "inputs"),
        "Agents": lambda folder: _agents(folder / "agents"),
        "Ablation": lambda folder: _ablation(folder / "ablation"),
        "The paper's figures, beside ours": _paper,
        "Quality": _quality,
        "Speed": lambda folder: _speed(folder / "speed"),
        "Survey": lambda folder: _survey(folder / "survey"),
    }
    lines = [
        "# Results",
        "",
        f"Made by `cityx bench results --logs {logs} -o {page}` of what the commands below logged; "
        "`make results` runs all of them. Every share stands with its counts and Wilson's 95 % "
        "interval: ER@1 are proposals in which every step passed the gate and ran, SR@1 those of "
        "them that are right, as the paper counts; the last column counts those that are right "
        "among all.",
    ]
    for title, tell in parts.items():
        lines += ["", f"## {title}", "", *tell(logs)]
    return "\n".join(lines) + "\n"


# --- logs of samples ------------------------------------------------------------------------------


def groups_of(folder: Path) -> dict[tuple[str, int], Group]:
    """Return the last samples of a log by driver and level of detail.

    Samples of another state of CityX than that of their driver's last one are left out.
    """
    found: dict[tuple[str, int], list[Sample]] = {}
    for sample in read_log(folder / LOG):
        found.setdefault((sample.driver, sample.lod), []).append(sample)
    groups = {}
    for key, own in found.items():
        same = [sample for sample in own if sample.registry == own[-1].registry]
        latest = {(sample.task, sample.seed): sample for sample in same}
        groups[key] = tuple(latest[pair] for pair in sorted(latest))
    return groups


def _with_what(samples: Iterable[Sample]) -> Lines:
    """Return which state of the code and of the actions made samples."""
    made, now = {sample.registry for sample in samples}, registry_hash(registry())
    other = f"; this page was written by another one, {now[:SHOWN]}" if made != {now} else ""
    states = " and ".join(sorted(one[:SHOWN] for one in made))
    yield f"Logged by the state {states} of CityX{other}.\n"


def _rows(samples: Group, command: str, title: str) -> Lines:
    """Yield the tables of samples; of the tasks those that are not right, for no floor."""
    yield f"`{command}`\n"
    yield from _with_what(samples)
    found = results_of(samples, command, title)
    floor = samples[0].driver in FLOORS
    missed = [] if floor else [row for row in found["tasks"] if not row["right"]]
    yield from tables_of(found, samples, missed)


def _numbers(values: Iterable[int]) -> str:
    return ",".join(map(str, sorted(set(values))))


def _missing(command: str) -> str:
    return f"No log yet; this makes it: `{command}`"


# --- sections -------------------------------------------------------------------------------------


def _inputs(folder: Path) -> Lines:
    groups = groups_of(folder)
    if not groups:
        yield _missing(f"cityx bench inputs -o {folder}")
    for (driver, lod), samples in groups.items():
        kinds = [kind for kind in KINDS if any(s.category == kind for s in samples)]
        count = max(sum(s.category == kind for s in samples) for kind in kinds)
        real = any(s.category == "osm" and not s.task[4:].isdigit() for s in samples)
        command = f"cityx bench inputs --kinds {','.join(kinds)} --count {count} --lod {lod}"
        command += f" --driver {driver}" if driver != "offline" else ""
        command += f"{' --maps FOLDER' if real else ''} -o {folder}"
        yield from _rows(samples, command, "Inputs")


def _agents(folder: Path) -> Lines:
    groups = groups_of(folder)
    if not groups:
        yield _missing(f"cityx bench agents --driver offline -o {folder}")
    for (driver, lod), samples in sorted(groups.items()):
        yield f"### {driver}\n"
        seeds = _numbers(sample.seed for sample in samples)
        command = f"cityx bench agents --driver {driver} --seeds {seeds} --lod {lod}"
        yield from _rows(samples, f"{command}{_only(samples)} -o {folder}", "Agents")
        yield ""


def _only(samples: Iterable[Sample]) -> str:
    """Return the option that names tasks, "" where they are all of the public ones."""
    done = {sample.task for sample in samples}
    return "" if done == {task.id for task in read_tasks()} else f" --only {','.join(sorted(done))}"


def _arms(folder: Path) -> dict[str, Group]:
    """Return the samples of every arm in a log, of the tasks alone that all of them solved."""
    groups = groups_of(folder)
    found: dict[str, Group] = {}
    for (driver, _), samples in groups.items():
        word, _, detail = driver.partition(":")
        if word == "offline":
            found[arm_of(detail) if detail else FULL] = samples
    tried = [{(s.task, s.seed) for s in samples} for samples in found.values()]
    common = set.intersection(*tried) if tried else set()
    return {arm: tuple(s for s in found[arm] if (s.task, s.seed) in common)
            for arm in ARMS if arm in found}  # fmt: skip


def _ablation(folder: Path) -> Lines:
    arms = _arms(folder)
    samples = next(iter(arms.values()), ())
    if not samples:
        yield _missing(f"cityx bench agents --arm all --lod 0 -o {folder}")
        return
    command = f"cityx bench agents --arm all --seeds {_numbers(s.seed for s in samples)}"
    yield f"`{command} --lod {samples[0].lod}{_only(samples)} -o {folder}`\n"
    yield from _with_what([sample for own in arms.values() for sample in own])
    yield from arms_table(ablation_of(arms))
    left = [name_of(arm) for arm in ARMS if arm not in arms]
    if left:
        yield f"\nNot run yet: {', '.join(left)}."
    yield f"\n{MEANING}\n"
    for arm, own in arms.items():
        yield from counts_table(f"{name_of(arm)}: code of a fault", fault_codes(own))


def _paper(logs: Path) -> Lines:
    yield ("The paper prints percentages of 100 proposals; its SR@1 are exact fractions of what "
           "ran. `cityx_bench.scoring`, which counts ours, gives its twelve rows back from these "
           "counts.\n")  # fmt: skip
    yield from _head_beside("shown")
    arms = _arms(logs / "ablation")
    for arm in ARMS:
        ours = rates_of(arms[arm]) if arm in arms else None
        yield _beside(name_of(arm), paper.ABLATION.get(arm), ours)
    yield ""
    yield from _head_beside("driver")
    for name, row in paper.MODELS.items():
        yield _beside(name, row, None)
    for (driver, lod), samples in sorted(groups_of(logs / "agents").items()):
        yield _beside(f"{driver}, level {lod}", None, rates_of(samples))


def _head_beside(what: str) -> Lines:
    counts = "executed | right of executed | right of all"
    yield f"| {what} | printed ER@1, SR@1 | from its counts: {counts} | ours: {counts} |"
    yield "| --- | --- | --- | --- | --- | --- | --- | --- |"


def _beside(name: str, row: paper.Row | None, ours: Rates | None) -> str:
    printed = f"{row.er:.2f}, {row.sr:.2f}" if row else "-"
    cells = [name, printed, *_cells(row.rates if row else None), *_cells(ours)]
    return f"| {' | '.join(cells)} |"


def _cells(rates: Rates | None) -> tuple[str, ...]:
    if rates is None:
        return ("-", "-", "-")
    return tuple(rate_cell(one) for one in (rates.executed, rates.right_of_executed, rates.right))


def _record(path: Path) -> dict[str, Any] | None:
    """Return what a benchmark wrote, None where it did not run."""
    if not path.exists():
        return None
    try:
        found: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise InputError(f"{path} cannot be read as a log: {error}.") from error
    return found


def _towns(folder: Path) -> quality.Rows:
    """Return the measures of the towns of `cityx bench quality`."""
    record = _record(folder / "quality.json") or {"cities": {}}
    return {name: _numbered(row) for name, row in record["cities"].items()}


def _generated(logs: Path) -> dict[str, quality.Rows]:
    """Return the measures of all cities that benchmarks generated, by what they were made of."""
    found: dict[str, dict[str, dict[str, float]]] = {}
    for folder in ("inputs", "agents"):
        for (driver, lod), samples in groups_of(logs / folder).items():
            for one in samples:
                if one.quality and driver == "offline":
                    kind = f"{folder}: {one.category}, level {lod}"
                    name = f"{one.task}-{one.seed}"
                    found.setdefault(kind, {})[name] = _numbered(one.quality)
    return dict(found)


def _numbered(row: Mapping[str, float | None]) -> dict[str, float]:
    return {key: nan if value is None else value for key, value in row.items()}


def _all_cities(logs: Path) -> quality.Rows:
    rows = dict(_towns(logs / "quality"))
    for kind, own in _generated(logs).items():
        rows |= {f"{kind}: {name}": row for name, row in own.items()}
    return rows


def _quality(logs: Path) -> Lines:
    folder = logs / "quality"
    record, groups = _record(folder / "quality.json"), _generated(logs)
    if record is None:
        yield _missing(f"cityx bench quality -o {folder}")
    else:
        yield f"`{record['command']} -o {folder}`\n"
        yield quality.table_of(_towns(folder))
    if groups:
        yield ("\nEvery city that the benchmarks of inputs and agents generated: the median, and "
               "how many of those measured keep the bound.\n")  # fmt: skip
        yield quality.summary_of(groups)
    yield ""
    yield from (f"- {one.name}: {one.meaning}" for one in quality.MEASURES)
    if record or groups:
        yield f"\n![A row per measure, a dot per city, the bound as a line]({PLOT})"


def _speed(folder: Path) -> Lines:
    record = _record(folder / speed.RECORD)
    if record is None:
        yield _missing(f"cityx bench speed MAPS --peers installed -o {folder}")
        return
    yield f"`{record['command']} -o {folder}`\n"
    yield speed_tables.text_of(record)


def _survey(folder: Path) -> Lines:
    if not (folder / STUDY).exists():
        yield (f"No answers yet: no study was made. `cityx bench survey make NAME=FOLDER "
               f"NAME=FOLDER -o {folder}`, then `cityx bench survey serve {folder}`.")  # fmt: skip
        return
    study, sources = read_study(folder)
    ratings = read_ratings((folder / ANSWERS).glob("*.json"), study)
    yield f"`cityx bench survey serve {folder}`\n"
    if not ratings:
        yield "No answers yet."
        return
    yield table_of_scores(scores_of(ratings, sources, study))
