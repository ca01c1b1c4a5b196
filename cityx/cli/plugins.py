"""The commands of `cityx plugins`; heavy modules are imported by the commands that need them."""
# Annotations stay values here: typer reads them at every start.

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cityx.cli.terminal import CHECK_FAILED, show

if TYPE_CHECKING:
    from rich.console import Group
    from rich.table import Table

    from cityx.protocol.registry import Registry

plugins = typer.Typer(help="List, show, check and make plugins.", no_args_is_help=True)


@plugins.command("list")
def list_(
    as_json: Annotated[bool, typer.Option("--json", help="Print all records.")] = False,
) -> None:
    """List every action by stage."""
    if as_json:
        from cityx.protocol.catalogue import known_records
        from cityx.protocol.registry import registry

        actions = registry()
        records = [record.document() for record in known_records(actions)]
        typer.echo(json.dumps(records, indent=1, ensure_ascii=False))
        for sentence in actions.refused:
            typer.echo(sentence, err=True)
    else:
        show(list_actions())


@plugins.command("show")
def show_(name: Annotated[str, typer.Argument(help="Id or name of an action.")]) -> None:
    """Show the record of one action as JSON."""
    from cityx.protocol.registry import registry

    typer.echo(json.dumps(registry()[name].document(), indent=2, ensure_ascii=False))


@plugins.command()
def label(
    planner: Annotated[str, typer.Option(help="openai:MODEL, anthropic:MODEL, ollama:MODEL, ...")],
    base_url: Annotated[str, typer.Option(help="Server of the model.")] = "",
) -> None:
    """Let a language model label the actions, once, for all cities of this machine."""
    from cityx.agents.models import label_actions
    from cityx.protocol.catalogue import known_records, registry_hash
    from cityx.protocol.registry import registry

    actions = registry()
    added, refused = label_actions(
        planner, base_url, registry_hash(actions), known_records(actions)
    )
    for action, words in sorted(added.items()):
        typer.echo(f"{action}: {', '.join(words)}")
    typer.echo(f"{sum(map(len, added.values()))} labels added, {len(refused)} refused")


@plugins.command()
def check(
    name: Annotated[
        str | None, typer.Argument(help="One action, or a plugin's folder; all when left out.")
    ] = None,
) -> None:
    """Run the conformance suite."""
    text, passed = check_actions(name)
    show(text)
    if not passed:
        raise typer.Exit(CHECK_FAILED)


@plugins.command()
def new(
    name: Annotated[str, typer.Argument(help='Id such as "building/bell_tower-v1".')],
    folder: Annotated[Path, typer.Option("-o", "--out", help="Where to write it.")] = Path(),
    installed: Annotated[
        bool, typer.Option("--install", help="Install it for this Python.")
    ] = False,
) -> None:
    """Write a scaffold of a plugin that works."""
    from cityx.protocol.scaffold import install, write_scaffold

    for path in write_scaffold(name, folder):
        typer.echo(str(path))
    if installed:
        install(folder)
    # "./" keeps pip from looking for a package of that name elsewhere.
    here = str(folder) if folder.is_absolute() else f"./{folder}"
    ready = f'cityx build -o town --do "{name}"' if installed else f"pip install {here}"
    typer.echo(f"next: {ready}")


@plugins.command()
def formats() -> None:
    """Show the share of each format over all ports, beside the paper's."""
    show(format_statistics())


def list_actions(actions: "Registry | None" = None) -> "Group":
    """Return a table of the actions of each stage, as wide as the terminal.

    Packages of others are imported, so that an action that cannot be loaded is named as such with
    a sentence on why below the tables; no built-in plugin is.
    """
    from rich.console import Group
    from rich.table import Table

    from cityx.protocol.registry import BUILTIN, registry
    from cityx.protocol.stages import Stage

    actions = registry() if actions is None else actions
    tables: list[Table | str] = []
    for stage in Stage:
        ids = actions.of_stage(stage.value)
        if not ids:
            continue
        table = Table(box=None, pad_edge=False, show_header=False, expand=True)
        table.title, table.title_justify = f"{stage.value} ({len(ids)})", "left"
        table.add_column(no_wrap=True, width=max(map(len, ids)))
        table.add_column(no_wrap=True, overflow="ellipsis", ratio=1)
        for action_id in ids:
            entry = actions.entries[action_id]
            summary = entry.summary
            if entry.package != BUILTIN:
                record = actions.outside_record(action_id)
                origin = f"from {entry.package}"
                summary = (
                    f"cannot be loaded, see below; {origin}"
                    if record is None
                    else f"{origin}. {record.description}"
                )
            table.add_row(action_id, summary)
        tables.append(table)
    return Group(*tables, f"{len(actions)} actions in {len(tables)} stages", *actions.refused)


def check_actions(name: str | None = None, actions: "Registry | None" = None) -> tuple[str, bool]:
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
    from cityx.checks.conformance import check_action
    from cityx.protocol.registry import registry
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


def format_statistics(actions: "Registry | None" = None) -> "Table":
    """Return the table of formats over all ports, beside the paper's."""
    from rich.table import Table

    from cityx.protocol.registry import registry
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
