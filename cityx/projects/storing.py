"""Storing: a finished city is written and checked, and let go of before Blender needs the room."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cityx.city import City
from cityx.options import BuildOptions
from cityx.projects.views import Drawing, write_formats
from cityx.system.cores import core_count
from cityx.system.forked import Forked
from cityx.system.stopwatch import Stopwatch

if TYPE_CHECKING:
    from cityx.sources.intake import Inputs

CHECKED = "report"  # step in which the checks are waited for, and the report is made
# Faces of a city; of a larger one files, checks and scene are made one after the other, since each
# holds it, and Blender takes a third more than the build itself.
MOST_BESIDE = 3_000_000

Say = Callable[[str], None]


def checked_files(
    generated: Callable[[], City],
    inputs: Inputs,
    options: BuildOptions,
    brief: dict[str, Any],
    staging: Path,
    drawing: Drawing,
    watch: Stopwatch,
    say: Say,
) -> tuple[dict[str, Any], bool]:
    """Store and check a city and write the files that need no Blender.

    Parameters
    ----------
    generated
        Makes the city; nothing here holds it in the end.
    inputs, options, brief
        What it is made of, and what the report says was asked for.
    staging
        Folder that is written to.
    drawing
        Blender, which is handed a city that leaves room for both.

    Returns
    -------
    report, begun
        What the checks say, and whether Blender works on the stored city already.
    """
    from cityx.checks.report import make_report
    from cityx.city.content import HASHES, content_hash, write_hash
    from cityx.city.store import write_city

    city = generated()
    say("writing the store")
    with watch.step("store"):
        write_city(city, staging / "city")

    def checked() -> tuple[dict[str, Any], Stopwatch]:
        own = Stopwatch()
        with own.step("store hash"):
            content = content_hash(city)
            write_hash(content, staging / "city" / HASHES)
        report = make_report(
            city,
            inputs=inputs.records,
            brief=brief,
            watch=own,
            content=content.total,
            files=[item.path for item in inputs.all],
            how=options.read,
        )
        return report, own

    together = fits_beside(city)
    if together:
        drawing.begin()
    apart = together and (options.workers or core_count()) > 1
    with closing(Forked(checked, apart=apart)) as copy:
        write_formats(city, staging, options.formats, watch=watch, say=say)
        say("checking")
        with watch.step(CHECKED):
            report, own = copy.result()
    watch.take(CHECKED, own)
    return report, together


def fits_beside(city: City) -> bool:
    """Whether a city is small enough for its checks, files and scene to be made at a time."""
    return sum(len(batch.faces) for batch in city.scene.meshes.values()) <= MOST_BESIDE
