"""The scaffold of a plugin: a package with one working action and its test."""

from __future__ import annotations

import subprocess
import sys
import tomllib
from importlib.util import find_spec
from pathlib import Path
from textwrap import dedent

from cityx.errors import InputError, UsageError
from cityx.protocol.encapsulation import ID_PATTERN
from cityx.protocol.registry import GENERATORS, GROUP, Entry, outside_entry
from cityx.protocol.stages import to_stage
from cityx.system.extensions import add_point

_BUILDING = '''
    """{title}."""

    from typing import Annotated

    from cityx.city import MeshBatch
    from cityx.protocol import Range
    from cityx.protocol.plugged import generator
    from cityx.protocol.solid_blocks import block
    from cityx.protocol.values import Footprint


    @generator("{id}", labels=["{word}"], limits=["The roof is level."])
    def {name}(
        footprint: Footprint, *, height: Annotated[float, Range(2.0, 400.0)] = 20.0
    ) -> MeshBatch:
        """Raise a building to a plain block of one height.

        Parameters
        ----------
        footprint
            Outline of the building.
        height
            Metres above the ground.
        """
        return block(footprint.ring, height, holes=footprint.holes)
'''
_CITY = '''
    """{title}."""

    from dataclasses import replace
    from typing import Annotated

    from cityx.city import City
    from cityx.protocol import Range, action


    @action("{id}", limits=["Writes a note and changes nothing else."])
    def {name}(city: City, *, count: Annotated[int, Range(1, 100)] = 3) -> City:
        """Note how many things of this kind the city should get.

        Parameters
        ----------
        city
            City to note it in.
        count
            Number of things.
        """
        return replace(city, notes=(*city.notes, f"{name}: {{count}}"))
'''
_CONVERT = '''
    """{title}."""

    from typing import Annotated

    import shapely

    from cityx.protocol import Range, action
    from cityx.protocol.values import Surfaces, make_surfaces


    @action("{id}", limits=["Loses the part within the distance of the border."], lossy=0.1)
    def {name}(
        surfaces: Surfaces, *, distance: Annotated[float, Range(0.0, 100.0)] = 1.0
    ) -> Surfaces:
        """Shrink faces by a distance.

        Parameters
        ----------
        surfaces
            Faces.
        distance
            Metres taken off all around.
        """
        shapes, row = shapely.get_parts(
            shapely.buffer(surfaces.geometry, -distance), return_index=True
        )
        return make_surfaces(
            shapes, surfaces.kind[row].tolist(), surfaces.height[row], surfaces.object_id[row]
        )
'''
_PROJECT = """
    [build-system]
    requires = ["setuptools>=61"]
    build-backend = "setuptools.build_meta"

    [project]
    name = "{package}"
    version = "0.1.0"
    dependencies = ["cityx"]

    [project.entry-points."cityx.actions"]
    "{id}" = "{name}:{name}"

    [tool.setuptools]
    py-modules = ["{name}"]
"""
_TEST = '''
    """The action keeps the rules every action keeps."""

    from cityx.protocol import Registry
    from cityx.checks.conformance import check_action
    from {name} import {name}


    def test_{name}_conforms():
        results = check_action("{id}", Registry.of([{name}]))
        assert [result for result in results if result.passed is False] == []
'''


def write_scaffold(action_id: str, folder: Path) -> tuple[Path, ...]:
    """Write a module with the action, its ``pyproject.toml`` and a test; return the paths.

    Parameters
    ----------
    action_id
        "stage/name-vN".
    folder
        Where to write; made when absent.

    Raises
    ------
    UsageError
        If the id has the wrong form, or a file is there already; nothing is written then.
    """
    match = ID_PATTERN.fullmatch(action_id)
    if not match:
        raise UsageError(
            f'"{action_id}" is not of the form "stage/name-vN", such as "building/bell_tower-v1".'
        )
    stage, name = to_stage(match.group(1)), match.group(2)
    body = {"building": _BUILDING, "convert": _CONVERT}.get(stage.value, _CITY)
    words = {
        "id": action_id,
        "name": name,
        "word": name.replace("_", " "),
        "title": name.replace("_", " ").capitalize(),
        "package": "cityx-" + name.replace("_", "-"),
    }
    texts = {
        folder / f"{name}.py": body,
        folder / "pyproject.toml": _PROJECT,
        folder / f"test_{name}.py": _TEST,
    }
    taken = [path.name for path in texts if path.exists()]
    if taken:
        raise UsageError(f"{folder} holds {', '.join(taken)} already; choose another folder.")
    folder.mkdir(parents=True, exist_ok=True)
    for path, text in texts.items():
        path.write_text(dedent(text).lstrip().format(**words), encoding="utf-8")
    return tuple(texts)


def install(folder: Path) -> None:
    """Install the package of a folder for this Python, so that changes of its files count at once.

    Raises
    ------
    UsageError
        If pip cannot do it; with the last line that it says.
    """
    command = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps",
               "--disable-pip-version-check"]  # fmt: skip
    if find_spec("setuptools") is not None:  # needs no network then
        command.append("--no-build-isolation")
    done = subprocess.run(
        [*command, "--editable", str(folder)], capture_output=True, text=True, check=False
    )
    if done.returncode:
        lines = done.stderr.strip().splitlines() or ["it says nothing"]
        raise UsageError(f"pip cannot install {folder}: {lines[-1]}")


def entries_of(folder: Path) -> tuple[Entry, ...]:
    """Return the actions that the ``pyproject.toml`` of a folder registers, importable from there.

    Generators count as installed in this process from then on.

    Raises
    ------
    InputError
        If the folder holds no package of a plugin.
    """
    path = folder / "pyproject.toml"
    try:
        project = tomllib.loads(path.read_text(encoding="utf-8"))["project"]
        points = project["entry-points"]
        found = [(group, points[group]) for group in (GROUP, GENERATORS) if points.get(group)]
        if not found:
            raise KeyError(GROUP)
    except (OSError, KeyError, ValueError) as error:
        raise InputError(
            f"{folder} holds no action to check: {path.name} needs "
            f'[project.entry-points."{GROUP}"] or "{GENERATORS}". Formats, checks and other kinds '
            "are seen when they are installed and used."
        ) from error
    sys.path.insert(0, str(folder.resolve()))
    for name, run in points.get(GENERATORS, {}).items():  # the catalogue must know them to run
        add_point(GENERATORS, name, str(run), project["name"])
    return tuple(
        outside_entry(group, name, str(run), project["name"])
        for group, entries in found
        for name, run in entries.items()
    )
