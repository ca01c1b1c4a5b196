"""The folder of results: made aside, moved into place when complete, its report."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

from cityx.errors import UsageError

FAULTS = "faults.log"  # traces of what broke in this program itself during a build
PRODUCTS = (
    "city", "city.blend", "city.glb", "city.usdc", "city_textures", "renders",
    "city.net.xml", "city.rou.xml", "city.sumocfg",
    "report.json", "report.html", FAULTS,
)  # fmt: skip


def write_report(report: dict[str, Any], folder: Path) -> None:
    """Write report.json and report.html, with the pictures that lie in ``renders``."""
    from cityx.checks.report_html import report_html
    from cityx.projects.views import VIEWS
    from cityx.system.atomic import replaced

    order = {f"{view}.png": index for index, view in enumerate(VIEWS)}
    pictures = sorted(
        (folder / "renders").glob("*.png"), key=lambda path: (order.get(path.name, 99), path.name)
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
    from cityx.city.store import replace_folder

    held = {entry.name for entry in out.iterdir()} if out.exists() else set()
    if held <= set(PRODUCTS) and Path.cwd() != out:
        if out.exists():
            out.rename(_aside(out))
        staging.rename(out)
        shutil.rmtree(_aside(out), ignore_errors=True)
        return
    for name in held.intersection(PRODUCTS):
        if not (staging / name).exists():
            old = out / name
            shutil.rmtree(old) if old.is_dir() else old.unlink()
    for product in sorted(staging.iterdir()):
        target = out / product.name
        if product.is_dir():
            replace_folder(product, target)
        else:
            product.replace(target)
