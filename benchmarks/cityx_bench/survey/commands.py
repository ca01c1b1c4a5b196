"""The commands of `cityx bench survey`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from cityx.errors import InputError

survey = typer.Typer(help="Ask people: a blinded, shuffled questionnaire.", no_args_is_help=True)
Folder = Annotated[Path, typer.Argument(help="Folder of a study.")]


@survey.command()
def make(
    sources: Annotated[list[str], typer.Argument(help="NAME=FOLDER of pictures, two or more.")],
    out: Annotated[Path, typer.Option("-o", "--out", help="Folder of the study.")] = Path("survey"),
    title: Annotated[str, typer.Option(help="Above the page; it must name no source.")] = "Cities",
    seed: Annotated[int, typer.Option(help="Of the names of pictures.")] = 0,
) -> None:
    """Write a page with the pictures of several sources, and the key that identifies them."""
    from cityx_bench.survey.study import PAGE, make_study, sources_of

    study = make_study(sources_of(sources), out, title=title, seed=seed)
    typer.echo(f"{len(study.items)} pictures, {study.repeats} of them shown twice to each person")
    typer.echo(str(out / PAGE))
    typer.echo(f"Let people rate them: cityx bench survey serve {out}")


@survey.command()
def serve(
    folder: Folder,
    port: Annotated[int, typer.Option(min=0, max=65535, help="0 takes a free one.")] = 8765,
    host: Annotated[str, typer.Option(help="0.0.0.0 lets other machines in.")] = "127.0.0.1",
) -> None:
    """Serve the page of a study and keep the answers; Ctrl+C ends it."""
    from cityx_bench.survey.serving import server_of

    with server_of(folder, port, host) as server:
        typer.echo(f"http://{host}:{server.server_port}/")
        try:
            server.serve_forever()
        except KeyboardInterrupt:
            typer.echo("ended", err=True)


@survey.command()
def results(
    folder: Folder,
    files: Annotated[
        list[Path] | None, typer.Argument(help="Answers that people saved as files.")
    ] = None,
) -> None:
    """Print means with confidence intervals, and write them beside the study."""
    from cityx.system.atomic import replaced
    from cityx_bench.survey.answers import read_ratings, scores_of, steadiness, table_of
    from cityx_bench.survey.study import ANSWERS, read_study

    study, sources = read_study(folder)
    stored = [*(folder / ANSWERS).glob("*.json"), *(files or [])]
    if not stored:
        raise InputError(f"{folder / ANSWERS} holds no answers yet, so there is nothing to count.")
    ratings = read_ratings(stored, study)
    table = table_of(scores_of(ratings, sources, study))
    count, apart = steadiness(ratings)
    if count:
        table += f"\n\nRated twice: {count}; the second number lies {apart:.2f} off in mean."
    with replaced(folder / "results.md") as temporary:
        temporary.write_text(
            f"Made by `cityx bench survey results`.\n\n{table}\n", encoding="utf-8"
        )
    typer.echo(table)
