"""Files that only Blender reads, as their caller sees them: paths go out, arrays come back."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from cityx.assets.library.hostile import MAX_TRIANGLES
from cityx.assets.library.mesh_files import RawMesh
from cityx.system.blender_process import run_module

MODULE = "cityx.blender.asset_files"


def read_blender_files(
    paths: Sequence[Path], root: Path, *, say: Callable[[str], None] = lambda _: None
) -> list[list[RawMesh] | str]:
    """Read .blend and USD files in a Blender process; scripts in them are not run.

    A file the process dies of is refused, and a new process goes on with the next one.

    Parameters
    ----------
    paths
        The files.
    root
        Folder that nothing they refer to may leave.
    say
        Called with a line of progress at a time.

    Returns
    -------
    found
        For each file its assets, or the reason why it is refused.

    Raises
    ------
    MissingDependency
        If Blender is not installed.
    """
    found: list[list[RawMesh] | str] = []
    with tempfile.TemporaryDirectory(prefix="cityx-assets-") as name:
        out = Path(name)
        while len(found) < len(paths):
            first = len(found)
            request: dict[str, Any] = {
                "files": [str(path.resolve()) for path in paths[first:]],
                "root": str(root.resolve()),
                "out": str(out),
                "first": first,
                "most": MAX_TRIANGLES,
            }
            code, log = run_module(
                MODULE, request, out, progress=lambda _, text: say(f"reading {text}")
            )
            while len(found) < len(paths) and (out / f"{len(found)}.json").exists():
                found.append(_answer(out, len(found)))
            if len(found) < len(paths):  # it died of the next one
                fate = f"signal {-code}" if code < 0 else f"status {code}"
                last = log.strip().splitlines()[-1:] or ["no words"]
                found.append(f"Blender ended ({fate}) while reading it: {last[0][:120]}")
    return found


def _answer(out: Path, number: int) -> list[RawMesh] | str:
    record = json.loads((out / f"{number}.json").read_text())
    if "refused" in record:
        return str(record["refused"])
    meshes = []
    for item in record["assets"]:
        with np.load(out / item["file"]) as held:
            meshes.append(
                RawMesh(
                    str(item["name"]), held["vertices"], held["triangles"], held["part"],
                    tuple(item["parts"]), held["colors"], metric=True,
                )
            )  # fmt: skip
        (out / item["file"]).unlink()
    return meshes
