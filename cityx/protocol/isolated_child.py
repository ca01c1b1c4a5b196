"""The process of an isolated action: ``python -m cityx.protocol.isolated_child FOLDER``."""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np

from cityx.city.mesh import MeshBatch, concatenate
from cityx.city.store import read_city, write_city
from cityx.errors import CityxError
from cityx.protocol.gate import Call
from cityx.protocol.input_files import InputFiles
from cityx.protocol.isolation import DONE
from cityx.protocol.layer_mapping import meshes_of
from cityx.protocol.registry import registry
from cityx.protocol.running import run_action
from cityx.protocol.values import Footprint


def _limit(limits: dict[str, Any]) -> None:
    """Bind this process to the limits, where the system knows any."""
    try:
        import resource
    except ImportError:  # Windows has none; the time limit of the caller still holds
        return
    for which, most in (
        (resource.RLIMIT_AS, limits["memory"]),
        (resource.RLIMIT_FSIZE, limits["file"]),
        (resource.RLIMIT_CORE, 0),
    ):
        _, hard = resource.getrlimit(which)
        most = int(most) if hard == resource.RLIM_INFINITY else min(int(most), hard)
        resource.setrlimit(which, (most, hard))


def main(name: str) -> int:
    """Carry out the job in a folder; return the exit code of the process."""
    folder = Path(name)
    job = json.loads((folder / "job.json").read_text())
    _limit(job["limits"])
    try:
        _make_meshes(folder, job) if "meshes" in job else _run_call(folder, job)
    except (CityxError, MemoryError) as error:
        sys.stderr.write(f"{type(error).__name__ if not str(error) else error}\n")
        return 1
    return 0


def _run_call(folder: Path, job: Mapping[str, Any]) -> None:
    """Run the call that a job asks for and write the new city into its folder."""
    inputs = InputFiles(tuple(map(Path, job["paths"])), tuple(job["kinds"]))
    call = Call(**job["call"])
    made = run_action(read_city(folder / "before"), call, registry(), inputs=inputs).city
    write_city(made, folder / "after")


def _make_meshes(folder: Path, job: Mapping[str, Any]) -> None:
    """Make the meshes that a job asks for and write them into its folder."""
    actions = registry()
    outlines = [
        Footprint(
            np.array(one["ring"]), tuple(np.array(hole) for hole in one["holes"]),
            one["object_id"], one["height"], one["levels"],
        )
        for one in job["outlines"]
    ]  # fmt: skip
    function = actions.function(job["meshes"])
    with (folder / DONE).open("wb", buffering=0) as done:  # tells the caller how far it is
        made = meshes_of(
            actions[job["meshes"]], function, outlines, job["args"], job["seed"],
            then=lambda: done.write(b"."),
        )  # fmt: skip
    batch = concatenate([one for one in made if isinstance(one, MeshBatch)])
    columns = {field.name: getattr(batch, field.name) for field in fields(batch)}
    columns["materials"] = np.array(batch.materials, str)
    np.savez(folder / "meshes.npz", **columns)
    (folder / "why.json").write_text(json.dumps([o if isinstance(o, str) else "" for o in made]))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
