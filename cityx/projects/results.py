"""The folder of results: made aside, moved into place when complete, its report and views.

A view is a file made from the city: of a format, or a picture. ``views.json`` holds for each the
hash of the city that it shows. A view is struck out there before it is replaced and entered
afterwards, so that one whose replacing was cut short never counts as current.
"""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from cityx.errors import UsageError

VIEWS_FILE = "views.json"  # the city that each view shows
PICTURES = "renders"  # folder of the pictures
VIEWS = ("street", "aerial", "top")  # that a build takes, in the order of the report
FAULTS = "faults.log"  # traces of what broke in this program itself during a build
PRODUCTS = (
    "city", "city.blend", "city.glb", "city.usdc", "city_textures", PICTURES,
    "city.net.xml", "city.rou.xml", "city.sumocfg",
    "report.json", "report.html", VIEWS_FILE, FAULTS,
)  # fmt: skip


def views_made(folder: Path) -> dict[str, str]:
    """Return by view the hash of the city that it shows, "" where replacing it was cut short."""
    try:
        held = json.loads((folder / VIEWS_FILE).read_text())
    except (OSError, ValueError):
        return {}
    known = held.items() if isinstance(held, dict) else ()
    return {name: made for name, made in known if isinstance(made, str)}


def enter_views(folder: Path, names: Iterable[str], content: str) -> None:
    """Keep that views show the city of a hash, "" for views that are about to be replaced."""
    from cityx.system.atomic import replaced

    before = views_made(folder)
    made = before | dict.fromkeys(names, content)
    made = {name: made[name] for name in sorted(made) if (folder / name).exists()}
    if made != before:
        with replaced(folder / VIEWS_FILE) as temporary:
            temporary.write_text(json.dumps(made, indent=2))


def stale_views(folder: Path, content: str) -> dict[str, str | None]:
    """Return the views that are not known to show the city of a hash.

    Returns
    -------
    stale
        Path in the folder to the hash of the city that the view shows; "" where replacing it was
        cut short, None where nothing is known of it.
    """
    from cityx.projects.file_formats import formats

    made = views_made(folder)
    pictures = (path.relative_to(folder).as_posix() for path in (folder / PICTURES).glob("*.png"))
    names = {*made, *(each.file for each in formats().values()), *pictures}
    return {
        name: made.get(name) for name in sorted(names)
        if made.get(name) != content and (folder / name).exists()
    }  # fmt: skip


def stale_notes(stale: Iterable[str]) -> list[str]:
    """Return a note that names stale views, none where there is none."""
    names = list(stale)
    why = "the next change renews files, cityx render takes pictures"
    return [f"not of this city as it is now: {', '.join(names)} ({why})"] if names else []


def move_views(staging: Path, folder: Path, content: str) -> None:
    """Put views of a city in the place of older ones."""
    names = sorted(entry.name for entry in staging.iterdir())
    enter_views(folder, names, "")
    _move(staging, folder, names)
    enter_views(folder, names, content)


def _move(source: Path, folder: Path, names: Iterable[str]) -> None:
    """Put files and folders in the place of those of the same names elsewhere."""
    from cityx.city.store import replace_folder

    for name in names:
        product, target = source / name, folder / name
        if product.is_dir():
            replace_folder(product, target)
        else:
            product.replace(target)


def write_report(report: dict[str, Any], folder: Path) -> None:
    """Write report.json and report.html, with the pictures that lie in ``renders``."""
    from cityx.checks.report_html import report_html
    from cityx.system.atomic import replaced

    order = {f"{view}.png": index for index, view in enumerate(VIEWS)}
    pictures = sorted(
        (folder / PICTURES).glob("*.png"), key=lambda path: (order.get(path.name, 99), path.name)
    )
    with replaced(folder / "report.json") as temporary:
        temporary.write_text(json.dumps(report, indent=2, allow_nan=False))
    relative = [path.relative_to(folder) for path in pictures]
    with replaced(folder / "report.html") as temporary:
        temporary.write_text(report_html(report, relative))


def result_folder(out: Path) -> Path:
    """Return the folder of the results as an absolute path, without links.

    Raises
    ------
    UsageError
        If it is a file or no folder can have such a name.
    """
    try:
        out = out.resolve()
        taken = out.exists() and not out.is_dir()
        _aside(out).exists()  # names have a limit, and this one is longer
    except OSError as error:
        raise UsageError(f"{out} cannot be a folder: {error.strerror}.") from error
    if taken:
        raise UsageError(f"{out} is a file; give a folder for the results.")
    return out


def staging_of(out: Path) -> Path:
    """Make the hidden folder beside `out`; what a killed build left there stays in it."""
    aside = _aside(out)
    if aside.exists() and not out.exists():  # killed between the two renames of `publish`
        aside.rename(out)
    shutil.rmtree(aside, ignore_errors=True)
    staging = staging_path(out)
    try:
        staging.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UsageError(f"{out} cannot be made: {error.strerror}.") from error
    return staging


@contextmanager
def fresh_staging(out: Path) -> Iterator[Path]:
    """Give an empty hidden folder beside `out` to fill and to move; nothing of it stays there."""
    staging = staging_of(out)
    shutil.rmtree(staging)
    staging.mkdir()
    try:
        yield staging
    finally:
        shutil.rmtree(staging, ignore_errors=True)


def staging_path(out: Path) -> Path:
    """Return the hidden folder beside `out`, there or not."""
    return out.parent / f".{out.name}.partial"


def _aside(out: Path) -> Path:
    return out.parent / f".{out.name}.old.partial"


def publish(staging: Path, out: Path) -> None:
    """Put the finished folder in the place of `out`; a kill leaves the older city or the new one.

    A folder that holds other things too, or that this process stands in, stays; then products are
    replaced one by one, and those of the older city do not stay beside them.
    """
    held = {entry.name for entry in out.iterdir()} if out.exists() else set()
    known = products_in(out)
    if held <= known and Path.cwd() != out:
        if out.exists():
            out.rename(_aside(out))
        staging.rename(out)
        shutil.rmtree(_aside(out), ignore_errors=True)
        return
    enter_views(out, views_made(out), "")
    for name in held & known:
        if not (staging / name).exists():
            old = out / name
            shutil.rmtree(old) if old.is_dir() else old.unlink()
    names = {entry.name for entry in staging.iterdir()}
    _move(staging, out, sorted(names - {VIEWS_FILE}))
    _move(staging, out, names & {VIEWS_FILE})  # last: until then no view counts as current


def products_in(folder: Path) -> set[str]:
    """Return the names in a folder of results that a build, or a view made later, may have made."""
    return {*PRODUCTS, *views_made(folder)}
