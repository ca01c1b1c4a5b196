"""Commands that change a city or show it: edit, undo, pull, render, serve, view."""
# Annotations stay values here: `with_flags` and typer read them at every start.

from pathlib import Path
from typing import Annotated, Any

import typer

from cityx.cli.flags import with_flags
from cityx.cli.terminal import CHECK_FAILED, Progress, echo_some
from cityx.errors import ActionFailed, UsageError
from cityx.options import PlannerChoice, RenderOptions
from cityx.system.allocator import rare_collection


@with_flags
def edit(
    folder: Annotated[Path, typer.Argument(help="Folder of a built city.")],
    text: Annotated[str, typer.Argument(help="What is to change, in words.")],
    files: Annotated[
        list[Path] | None,
        typer.Argument(help="Texts with more wishes, .blend files with curves to go along."),
    ] = None,
    *,
    choice: PlannerChoice,
) -> None:
    """Change a built city as a sentence says; what is not understood of it is left out and told."""
    with rare_collection():  # while libraries are imported
        from cityx.projects.edit import edit_city

    try:
        with Progress() as say:
            report = edit_city(folder, text, files=files or (), say=say, choice=choice)
    except ActionFailed as error:
        if isinstance(error.__cause__, ActionFailed):  # it said why, and broke nothing
            raise UsageError(f"{error.__cause__} Nothing was changed.") from error
        raise
    from cityx.projects.outcome import said_of

    echo_some([f"note: {note}" for note in report["notes_of_change"]])
    echo_some(said_of(report))
    for told in report["listed_of_change"]:
        typer.echo(f"{told['text']}: {told['said'] or len(told['objects'])}")
        for one in told["objects"]:
            size = f", {one['size']}" if one.get("size") else ""
            typer.echo(
                f"  {one['id']} {one['name'] or one['kind']} at {one['x']}, {one['y']}{size}"
            )
    _changed(report)


def undo(
    folder: Annotated[Path, typer.Argument(help="Folder of a built city.")],
    to: Annotated[int | None, typer.Option(min=1, help="A revision; see --list.")] = None,
    show: Annotated[bool, typer.Option("--list", help="Show the revisions, change none.")] = False,
) -> None:
    """Go back to the city before the last change, or to any revision it had."""
    from cityx.projects.desk import Desk
    from cityx.projects.edit import undo as undo_change

    if show:
        with Desk(folder) as desk:
            for item in desk.revisions():
                what = item.text or ", ".join(item.actions[:3])
                typer.echo(f"{item.number:4d}  {item.content[:12]}  {what}")
        return
    with Progress() as say:
        report = undo_change(folder, to, say=say)
    _changed(report)


def pull(
    folder: Annotated[Path, typer.Argument(help="Folder of a built city.")],
    blend: Annotated[
        Path | None, typer.Option(help="The file that was changed; city.blend of the folder.")
    ] = None,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Show, change nothing.")] = False,
    removals: Annotated[
        bool, typer.Option("--removals", help="More than a fifth of a layer may go.")
    ] = False,
) -> None:
    """Take what an artist moved, deleted, copied or recoloured in Blender into the city."""
    from cityx.projects.pull import pull as pull_changes

    with Progress() as say:
        found, report = pull_changes(
            folder, blend=blend, dry_run=dry_run, removals=removals, say=say
        )
    for line in found.lines():
        typer.echo(line)
    if report is not None:
        _changed(report)
    elif found.empty:
        typer.echo("nothing changed")


def _changed(report: dict[str, Any]) -> None:
    """Print what a change came to; end with code 1 if a part is missed, left out or broken."""
    typer.echo(f"revision {report['revision']}, hash {report['hash']}")
    if not is_whole(report):
        raise typer.Exit(CHECK_FAILED)


def is_whole(report: dict[str, Any], where: str = "") -> bool:
    """Print what a change missed and broke; return whether it is all that was asked for.

    Parameters
    ----------
    where
        What each line begins with.
    """
    missed = [goal for goal in report["goals_of_change"] if goal["met"] is False]
    echo_some([f"{where}missed: {goal['goal']} ({goal['evidence']})" for goal in missed])
    broken = report.get("checks_broken", {})
    echo_some([f"{where}check broken: {name} = {item['value']}, {item['bound']} {item['limit']}"
               for name, item in broken.items()])  # fmt: skip
    return not (missed or broken or report.get("left_of_change"))


@with_flags
def render(
    folder: Annotated[Path, typer.Argument(help="Folder of a built city.")],
    *,
    options: RenderOptions,
) -> None:
    """Render pictures of a built city, under another weather or at another time if asked for."""
    from cityx.projects.views import render_views

    with Progress() as say:
        paths = render_views(folder, options, say=say)
    echo_some([str(path) for path in paths], f"in {folder / 'renders'}", most=20)


@with_flags
def serve(
    folder: Annotated[Path, typer.Argument(help="Folder of a city, or of one to be built.")],
    http: Annotated[
        int | None, typer.Option(min=0, max=65535, help="Port of HTTP on this machine; 0 for any.")
    ] = None,
    profile: Annotated[str, typer.Option(help="core, or full: a tool for every action.")] = "core",
    *,
    choice: PlannerChoice,
) -> None:
    """Let language models and other programs use a city, by the Model Context Protocol."""
    from cityx.server.serve import serve as serve_city

    serve_city(
        folder,
        port=http,
        profile=profile,
        say=lambda line: typer.echo(line, err=True),
        choice=choice,
    )


@with_flags
def view(
    folder: Annotated[Path, typer.Argument(help="Folder of a built city, or of tiles.")],
    export: Annotated[
        Path | None, typer.Option(help="Write a static site there instead of serving the page.")
    ] = None,
    port: Annotated[int, typer.Option(min=0, max=65535, help="Of HTTP; 0 for any.")] = 0,
    browser: Annotated[bool, typer.Option(help="Open the page in the browser.")] = True,
    *,
    choice: PlannerChoice,
) -> None:
    """Show a city in the browser: fly, walk, ask what things are, change it by sentences.

    Of a folder of tiles those near the camera are loaded; cityx tiles edit changes them.
    """
    tiled = (folder / "tiles.json").is_file()
    if export is not None:
        if tiled:
            from cityx.viewer.view import check_extra

            check_extra()
            from cityx.tiles.site import export_tiles as export_site
        else:
            from cityx.viewer.export import export_site

        with Progress() as say:
            told = export_site(folder, export, say)
        typer.echo(f"{told['files']} files, {told['bytes'] / 1e6:.1f} MB, in {export}")
        typer.echo(f"Any web server shows it: python3 -m http.server -d {export}")
        return
    from cityx.viewer.view import check_extra
    from cityx.viewer.view import view as view_city

    if tiled:
        check_extra()
        from cityx.tiles.page import view_tiles

        view_tiles(folder, port=port, browser=browser, say=typer.echo)
        return
    view_city(folder, port=port, browser=browser, say=typer.echo, choice=choice)
