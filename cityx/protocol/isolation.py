"""Actions of other packages run in a process of their own, within limits of time and memory.

The process gets the city as a stored folder and gives one back, so that nothing it makes is run or
unpickled here. It sees no keys or tokens of the environment. It is no sandbox against a package
that means harm: whoever installs one runs its code.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import numpy as np

from cityx.errors import ActionFailed, InputError
from cityx.protocol.input_files import InputFiles

if TYPE_CHECKING:
    from cityx.city.city import City
    from cityx.protocol.encapsulation import Encapsulation
    from cityx.protocol.gate import Call
    from cityx.protocol.layer_mapping import Made
    from cityx.protocol.values import Footprint

INSIDE = "CITYX_INSIDE_WORKER"  # set in the process itself, which must not start another
_SECRET = re.compile(r"KEY|TOKEN|SECRET|PASSWORD|CREDENTIAL", re.IGNORECASE)
_GIB = 1 << 30


@dataclass(frozen=True)
class Limits:
    """What an action of another package may take.

    Attributes
    ----------
    seconds
        Wall time.
    memory
        Bytes of address space.
    file
        Bytes of the largest file it writes.
    """

    seconds: float = 600.0
    memory: int = 16 * _GIB
    file: int = 8 * _GIB


def is_inside() -> bool:
    """Tell whether this process is the worker."""
    return INSIDE in os.environ


def run_apart(
    city: City, call: Call, inputs: InputFiles | None = None, limits: Limits | None = None
) -> City:
    """Run one call in a process of its own and return the new city.

    Raises
    ------
    ActionFailed
        If it fails, takes too long or too much memory, or gives back no city.
    """
    from cityx.city.store import read_city, write_city

    limits = limits or Limits()
    inputs = inputs or InputFiles()
    with TemporaryDirectory(prefix="cityx-worker-") as name:
        folder = Path(name)
        write_city(city, folder / "before")
        job = {
            "call": {"action": call.action, "args": dict(call.args), "bind": dict(call.bind)},
            "paths": [str(path) for path in inputs.paths], "kinds": list(inputs.kinds),
            "limits": asdict(limits),
        }  # fmt: skip
        (folder / "job.json").write_text(json.dumps(job))
        said = _run([sys.executable, "-m", "cityx.protocol.isolation", name], limits, call.action)
        if said:
            raise ActionFailed(f"{call.action} failed: {said}")
        try:
            return read_city(folder / "after")
        except (InputError, OSError, ValueError, KeyError, TypeError) as error:
            raise ActionFailed(f"{call.action} gave back no city: {error}") from error


def meshes_apart(
    record: Encapsulation,
    outlines: Sequence[Footprint],
    args: Mapping[str, Any],
    seed: int,
    limits: Limits | None = None,
) -> list[Made]:
    """Run an action for one building in a process of its own, on every footprint.

    Returns
    -------
    made
        As of `cityx.protocol.layer_mapping.meshes_of`; where the process fails, takes too long or
        too much memory, the reason stands for every building.
    """
    from cityx.city.mesh import MeshBatch

    limits = limits or Limits()
    with TemporaryDirectory(prefix="cityx-worker-") as name:
        folder = Path(name)
        job = {
            "meshes": record.id, "args": dict(args), "seed": seed, "limits": asdict(limits),
            "outlines": [
                {"ring": one.ring.tolist(), "holes": [hole.tolist() for hole in one.holes],
                 "object_id": one.object_id, "height": one.height, "levels": one.levels}
                for one in outlines
            ],
        }  # fmt: skip
        (folder / "job.json").write_text(json.dumps(job))
        said = _run([sys.executable, "-m", "cityx.protocol.isolation", name], limits, record.id)
        if said:
            return [said] * len(outlines)
        try:
            why = json.loads((folder / "why.json").read_text())
            with np.load(folder / "meshes.npz", allow_pickle=False) as held:
                columns = {key: held[key] for key in held.files if key != "materials"}
                names = tuple(str(word) for word in held["materials"])
            batch = MeshBatch(**columns, materials=names)
            row = iter(range(batch.count))
            return [text or batch.take([next(row)]) for text in why]
        except (OSError, ValueError, KeyError, TypeError, StopIteration) as error:
            return [f"its process gave back no meshes: {error}"] * len(outlines)


def _make_meshes(folder: Path, job: Mapping[str, Any]) -> None:
    """Make the meshes that a job asks for and write them into its folder."""
    from cityx.city.mesh import MeshBatch, concatenate
    from cityx.protocol.layer_mapping import meshes_of
    from cityx.protocol.registry import registry
    from cityx.protocol.values import Footprint

    actions = registry()
    outlines = [
        Footprint(
            np.array(one["ring"]), tuple(np.array(hole) for hole in one["holes"]),
            one["object_id"], one["height"], one["levels"],
        )
        for one in job["outlines"]
    ]  # fmt: skip
    function = actions.function(job["meshes"])
    made = meshes_of(actions[job["meshes"]], function, outlines, job["args"], job["seed"])
    batch = concatenate([one for one in made if isinstance(one, MeshBatch)])
    columns = {field.name: getattr(batch, field.name) for field in fields(batch)}
    columns["materials"] = np.array(batch.materials, str)
    np.savez(folder / "meshes.npz", **columns)
    (folder / "why.json").write_text(json.dumps([o if isinstance(o, str) else "" for o in made]))


def _run(command: Sequence[str], limits: Limits, action: str) -> str:
    """Run the worker; return what it says went wrong, "" for nothing."""
    environment = {key: value for key, value in os.environ.items() if not _SECRET.search(key)}
    environment |= {INSIDE: "1", "PYTHONPATH": os.pathsep.join(sys.path)}
    try:
        done = subprocess.run(
            command, env=environment, capture_output=True, text=True,
            timeout=limits.seconds, check=False,
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        return f"it took longer than {limits.seconds:g} seconds"
    if done.returncode == 0:
        return ""
    lines = done.stderr.strip().splitlines()
    ended = f"its process ended with code {done.returncode}"
    return lines[-1] if lines and done.returncode == 1 else f"{ended}: {lines[-1:]} ({action})"


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
    from cityx.errors import CityxError

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
    from cityx.city.store import read_city, write_city
    from cityx.protocol.gate import Call
    from cityx.protocol.registry import registry
    from cityx.protocol.running import run_action

    inputs = InputFiles(tuple(map(Path, job["paths"])), tuple(job["kinds"]))
    call = Call(**job["call"])
    made = run_action(read_city(folder / "before"), call, registry(), inputs=inputs).city
    write_city(made, folder / "after")


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
