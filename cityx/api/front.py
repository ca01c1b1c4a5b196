"""The front door of CityX in Python: build a city, open one, ask how a sentence is understood."""

from __future__ import annotations

import shutil
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from tempfile import mkdtemp
from typing import Any

from cityx.agents.loop import quiet
from cityx.api.notebook import Explanation
from cityx.api.project import Input, Progress, Project
from cityx.api.signatures import takes
from cityx.errors import InputError, nearest
from cityx.options import BuildOptions, options_from
from cityx.projects.inputs import files_and_text

# From Python nothing is written that is not asked for: `export` and `render` make it at any time.
PLAIN = {"formats": (), "render": False}


@takes(BuildOptions, PLAIN)
def build(
    *inputs: Input, out: Input | None = None, progress: Progress | None = None, **options: Any
) -> Project:
    """Build a city from words, a map, a drawing, an image, from several, or from nothing.

    Parameters
    ----------
    inputs
        Files of one place, and sentences: a text with a blank that is no file is a sentence.
    out
        Folder of the results; the city is held in memory when None, which `Project.save` puts on
        disk.
    progress
        Called with one line at a time, such as ``print``.
    options
        Fields of `cityx.BuildOptions` and of what it holds (`HowToRead`, `PlannerChoice`), as on
        the command line: ``text``, ``lod``, ``size=(400, 400)``, ``at=(60.17, 24.94)``, ``seed``,
        ``style``, ``time``, ``weather``, ``pixel``, ``planner``, ``settings=["pattern=radial"]``,
        ... Unlike there, no files are written besides the city unless ``formats`` or ``render``
        says so.

    Raises
    ------
    Clarify
        If a sentence contradicts itself or leaves open what is meant.
    InputError, UsageError
        If a file or an option is of no use; nothing was written.
    EngineError, MissingDependency
        If Blender is asked for and fails, or something that is not installed.

    Examples
    --------
    >>> city = cityx.build("MAP.osm", "in heavy rain", lod=2)  # doctest: +SKIP
    """
    from cityx.projects.build import build as build_city

    paths, sentence = files_and_text(inputs)
    text = " ".join(filter(None, (sentence, str(options.pop("text", "") or ""))))
    asked = replace(options_from(BuildOptions, options, PLAIN), text=text)
    folder = _private_folder() if out is None else Path(out)
    with ExitStack() as unless_built:
        if out is None:
            unless_built.callback(shutil.rmtree, folder.parent, ignore_errors=True)
        build_city(paths, folder, asked, say=progress or quiet)
        unless_built.pop_all()
    return Project(folder, private=out is None)


def open(folder: Input) -> Project:  # noqa: A001  it is cityx.open
    """Open the folder of a built city.

    Raises
    ------
    InputError
        If the folder is none, or holds no city.
    """
    path = Path(folder)
    if not path.is_dir():
        near = path.parent if path.parent.is_dir() else Path()
        names = [entry.name for entry in near.iterdir() if entry.is_dir()]
        raise InputError(f"{path} is no folder.{nearest(path.name, names)}")
    return Project(path)


def explain(text: str, *inputs: Input) -> Explanation:
    """Return how a sentence is understood and the plan for it; nothing is run or written.

    Parameters
    ----------
    text
        The sentence.
    inputs
        Files of the build, and more sentences.

    Returns
    -------
    explanation
        A dictionary that prints as lines: "asked", "goals", "notes", "workflow", "missing".

    Raises
    ------
    Clarify
        If the sentence contradicts itself or leaves open what is meant.
    InputError
        If a file is of no use.
    """
    from cityx.agents.explain import explain as explain_text

    paths, more = files_and_text(inputs)
    return Explanation(explain_text(" ".join(filter(None, (text, more))), paths))


def _private_folder() -> Path:
    """Return where a city in memory lies; the name is always the same, as datasets show it."""
    return Path(mkdtemp(prefix="cityx-")) / "city"
