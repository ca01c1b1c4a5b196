"""The page: files that the build made of the sources beside this module."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

from cityx.errors import MissingDependency

HOME = Path(__file__).parent
SOURCES, STATIC = HOME / "app", HOME / "static"
FILES = ("index.html", "app.js", "style.css", "licences.txt")
TILE_FILES = ("tiles.html", "tiles.js", "style.css", "licences.txt")  # of the page of tiles
VARIABLE = "CITYX_VIEWER_PAGE"  # another folder with the page
MEDIA = {".html": "text/html; charset=utf-8", ".js": "text/javascript; charset=utf-8",
         ".css": "text/css; charset=utf-8", ".txt": "text/plain; charset=utf-8",
         ".json": "application/json", ".glb": "model/gltf-binary",
         ".bin": "application/octet-stream", ".png": "image/png"}  # fmt: skip


def page_folder() -> Path:
    """Return the folder of the page; in a checkout it is built when it is missing or old.

    Raises
    ------
    MissingDependency
        If there is none, and it cannot be built.
    """
    given = os.environ.get(VARIABLE)
    if given and all((Path(given) / name).is_file() for name in (*FILES, *TILE_FILES)):
        return Path(given)
    if all((STATIC / name).is_file() for name in (*FILES, *TILE_FILES)) and not _is_old():
        return STATIC
    build_page()
    return STATIC


def build_page() -> None:
    """Build the page with the pinned packages of npm.

    Raises
    ------
    MissingDependency
        If npm is missing or cannot do it.
    """
    if not (SOURCES / "build.mjs").is_file() or shutil.which("npm") is None:
        raise MissingDependency(
            "The page of cityx view is not built here. Wheels of CityX hold it; in a checkout it "
            "needs Node.js 20 with npm: install that and run `make view`, or name a folder with "
            f"the page of another installation in {VARIABLE}."
        )
    for command in (
        ["npm", "ci", "--ignore-scripts", "--no-audit", "--no-fund", "--silent"],
        ["node", "build.mjs", str(STATIC)],
    ):
        if command[0] == "npm" and _is_installed():
            continue
        done = subprocess.run(command, cwd=SOURCES, capture_output=True, text=True, check=False)
        if done.returncode:
            last = (done.stderr or done.stdout).strip().splitlines()[-1:] or ["no reason given"]
            raise MissingDependency(
                f"The page of cityx view cannot be built: {' '.join(command[:2])} says: {last[0]} "
                f"Run `make view` where npm works, or name a folder with the page in {VARIABLE}."
            )


def _is_installed() -> bool:
    """Return whether the packages that are pinned now are there."""
    held = SOURCES / "node_modules" / ".package-lock.json"
    return (
        held.is_file() and held.stat().st_mtime >= (SOURCES / "package-lock.json").stat().st_mtime
    )


def _is_old() -> bool:
    """Return whether a source is newer than what was built of it."""
    built = (STATIC / "app.js").stat().st_mtime
    sources = [*(SOURCES / "src").glob("*.ts"), *SOURCES.glob("*.html"), SOURCES / "style.css"]
    return any(path.is_file() and path.stat().st_mtime > built for path in sources)


if __name__ == "__main__":
    try:
        build_page()
    except MissingDependency as error:
        sys.exit(str(error))
