"""What `cityx plugins` shows; the command line prints it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

from cityx.protocol.registry import BUILTIN, Registry, registry
from cityx.protocol.stages import Stage

if TYPE_CHECKING:
    from rich.table import Table


def list_actions(actions: Registry | None = None) -> Table:
    """Return a table of all actions by stage; imports no plugin."""
    from rich.table import Table

    actions = registry() if actions is None else actions
    counts = actions.counts()
    table = Table(box=None, pad_edge=False, header_style="bold")
    for title in ("stage", "action", "does", "from"):
        table.add_column(title, overflow="fold", no_wrap=title in ("stage", "action"))
    for stage in Stage:
        ids = actions.of_stage(stage.value)
        for row, action_id in enumerate(ids):
            entry = actions.entries[action_id]
            head = f"{stage.value} ({counts[stage.value]})" if row == 0 else ""
            origin = "" if entry.package == BUILTIN else entry.package
            table.add_row(head, action_id, entry.summary, origin)
    used = sum(1 for stage in Stage if counts.get(stage.value))
    lines = [f"{len(actions)} actions in {used} stages", *actions.refused]
    table.caption = "\n".join(lines)
    return table


def show_action(name: str, actions: Registry | None = None) -> str:
    """Return the record of an action as JSON: the paper's document, then schema and the rest.

    Raises
    ------
    UsageError
        If there is no such action.
    """
    actions = registry() if actions is None else actions
    record = actions[name]
    out = record.to_paper() | {
        "id": record.id,
        "stage": record.stage.value,
        "kind": record.kind,
        "requires": list(record.requires),
        "after": list(record.after),
        "preconditions": [test.to_json() for test in record.preconditions],
        "takes": [port.to_json() for port in record.takes],
        "gives": [port.to_json() for port in record.gives],
        "cost": record.cost,
        "lossy": record.lossy,
        "labels": list(record.labels),
        "serves": [wish.to_json() for wish in record.serves],
        "binds": dict(record.binds),
        "extension": record.extension,
        "schema": record.schema(),
    }
    return json.dumps(out, indent=2, ensure_ascii=False)


def check_actions(name: str | None = None, actions: Registry | None = None) -> tuple[str, bool]:
    """Run the conformance suite on one action, on those of a plugin's folder, or on all.

    Returns
    -------
    text
        One line per action, the faults below it.
    passed
        Whether nothing failed.

    Raises
    ------
    UsageError, InputError
        If there is no such action, or the folder holds no plugin.
    """
    from cityx.protocol.conformance import check_action
    from cityx.protocol.scaffold import entries_of

    actions = registry() if actions is None else actions
    lines: list[str] = []
    passed = failed = skipped = 0
    folder = Path(name or "")
    names = [actions.resolve(name)] if name and not folder.is_dir() else list(actions)
    if name and folder.is_dir():
        names = []
        for entry in entries_of(folder):
            if entry.id in actions.entries:  # an installed version gives way to the folder's
                del actions.entries[entry.id]
            actions.put(entry)
            names.append(entry.id)
    for action_id in names:
        results = check_action(action_id, actions)
        bad = [r for r in results if r.passed is False]
        left = [r for r in results if r.passed is None]
        passed += sum(r.passed is True for r in results)
        failed, skipped = failed + len(bad), skipped + len(left)
        lines.append(f"{'FAIL' if bad else 'ok  '} {action_id}")
        lines += [f"       {r.test}: {r.message}" for r in bad]
        lines += [f"       {r.test}: not tried, {r.message}" for r in left if name]
    lines.append(f"{passed} passed, {failed} failed, {skipped} not tried")
    return "\n".join(lines), failed == 0


def new_action(action_id: str, folder: Path, *, installed: bool = False) -> tuple[Path, ...]:
    """Write a plugin that works, with its package file and its test, and return the paths.

    Parameters
    ----------
    installed
        Whether it is installed too, so that the next command knows it.

    Raises
    ------
    UsageError
        If the id has the wrong form, or a file is there already.
    """
    from cityx.protocol.scaffold import install, write_scaffold

    paths = write_scaffold(action_id, folder)
    if installed:
        install(folder)
    return paths


def format_statistics(actions: Registry | None = None) -> Table:
    """Return the table of formats over all ports, beside the paper's."""
    from rich.table import Table

    from cityx.protocol.statistics import format_shares

    actions = registry() if actions is None else actions
    rows = format_shares(actions.records())
    table = Table(box=None, pad_edge=False, header_style="bold")
    table.add_column("data format")
    for title in ("inputs", "PIDF %", "paper", "outputs", "PODF %", "paper"):
        table.add_column(title, justify="right")
    for row in rows:
        table.add_row(
            row.name,
            str(row.inputs),
            f"{row.pidf:.2f}",
            f"{row.paper_pidf:.2f}",
            str(row.outputs),
            f"{row.podf:.2f}",
            f"{row.paper_podf:.2f}",
        )
    sums = (
        sum(r.inputs for r in rows), sum(r.pidf for r in rows), sum(r.paper_pidf for r in rows),
        sum(r.outputs for r in rows), sum(r.podf for r in rows), sum(r.paper_podf for r in rows),
    )  # fmt: skip
    table.add_row("sum", *(f"{s}" if isinstance(s, int) else f"{s:.2f}" for s in sums))
    return table
