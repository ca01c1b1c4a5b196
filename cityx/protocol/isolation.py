"""Actions of other packages run in a process of their own, within limits of time and memory.

The process gets the city as a stored folder and gives one back, so that nothing it makes is run or
unpickled here. It sees no keys or tokens of the environment. It is no sandbox against a package
that means harm: whoever installs one runs its code.
"""

from __future__ import annotations

import json
import logging
import os
import re
import subprocess
import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import numpy as np

from cityx.errors import ActionFailed, InputError, UsageError
from cityx.protocol.input_files import InputFiles

if TYPE_CHECKING:
    from cityx.city.city import City
    from cityx.protocol.encapsulation import Encapsulation
    from cityx.protocol.gate import Call
    from cityx.protocol.layer_mapping import Made
    from cityx.protocol.values import Footprint

CHILD = "cityx.protocol.isolated_child"
INSIDE = "CITYX_INSIDE_WORKER"  # set in the process itself, which must not start another
_SECRET = re.compile(r"KEY|TOKEN|SECRET|PASSWORD|CREDENTIAL", re.IGNORECASE)
SECONDS = "CITYX_PLUGIN_SECONDS"  # instead of both limits of time
WHOLE, EACH = 300.0, 60.0  # seconds for a city, and for one building
PATIENCE = 20.0  # seconds after which is told what is waited for
LOOKED = 0.1  # seconds between two looks at a process
DONE = "done"  # file with a byte for every building that is made
_GIB = 1 << 30
_LOG = logging.getLogger(__name__)


def _said_or(usual: float) -> float:
    """Return the limit of time that the environment says, else the usual one."""
    text = os.environ.get(SECONDS, "")
    try:
        found = float(text) if text else usual
    except ValueError:
        found = 0.0
    if not found > 0:
        raise UsageError(f'{SECONDS} is "{text}"; it takes a number of seconds above 0.')
    return found


@dataclass(frozen=True)
class Limits:
    """What an action of another package may take.

    Attributes
    ----------
    seconds
        Wall time of a call on a city.
    each
        Wall time for the mesh of one building.
    memory
        Bytes of address space.
    file
        Bytes of the largest file it writes.
    """

    seconds: float = field(default_factory=lambda: _said_or(WHOLE))
    each: float = field(default_factory=lambda: _said_or(EACH))
    memory: int = 16 * _GIB
    file: int = 8 * _GIB


def is_inside() -> bool:
    """Return whether this process is the worker."""
    return INSIDE in os.environ


def run_apart(
    city: City, call: Call, inputs: InputFiles | None = None, limits: Limits | None = None,
    *, package: str = "",
) -> City:  # fmt: skip
    """Run one call in a process of its own and return the new city.

    Parameters
    ----------
    package
        Where the action comes from, for what is said while it runs.

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
        said = _run(folder, limits.seconds, call.action, package)
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
    *,
    package: str = "",
) -> list[Made]:
    """Run an action for one building in a process of its own, on every footprint.

    Parameters
    ----------
    package
        Where the action comes from, for what is said while it runs.

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
        said = _run(folder, limits.each, record.id, package, buildings=len(outlines))
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


def _run(folder: Path, seconds: float, action: str, package: str, buildings: int = 0) -> str:
    """Run the worker on the job in a folder; return what it says went wrong, "" for nothing.

    Parameters
    ----------
    seconds
        What it may take, from one building to the next if there are ``buildings``.
    action, package
        What it runs. A line of the log names both while they are waited for.
    """
    environment = {key: value for key, value in os.environ.items() if not _SECRET.search(key)}
    environment |= {INSIDE: "1", "PYTHONPATH": os.pathsep.join(sys.path)}
    command = [sys.executable, "-m", CHILD, str(folder)]
    errors = folder / "errors.txt"
    with errors.open("w") as told:
        worker = subprocess.Popen(
            command, env=environment, stdout=subprocess.DEVNULL, stderr=told
        )  # fmt: skip
        try:
            late = _awaited(worker, folder / DONE, seconds, _called(action, package), buildings)
        finally:
            worker.kill()
            worker.wait()
    if late:
        return late
    code = worker.returncode
    if code == 0:
        return ""
    lines = errors.read_text(errors="replace").strip().splitlines()
    ended = f"its process ended with code {code}"
    return lines[-1] if lines and code == 1 else f"{ended}: {lines[-1:]} ({action})"


def _called(action: str, package: str) -> str:
    return f"{action} of package {package}" if package else action


def _awaited(
    worker: subprocess.Popen[bytes], made: Path, seconds: float, name: str, buildings: int
) -> str:
    """Wait until a worker ends; return why it is waited for no longer, "" if it ended."""
    count, begin, warned = 0, time.monotonic(), False
    while True:
        try:
            worker.wait(LOOKED)
            return ""
        except subprocess.TimeoutExpired:
            pass
        now = made.stat().st_size if made.exists() else 0
        if now > count:
            count, begin, warned = now, time.monotonic(), False
        waited = time.monotonic() - begin
        if waited > seconds:
            place = f" for building {count + 1} of {buildings}" if buildings else ""
            return f"it took longer than {seconds:g} seconds{place}"
        if waited > PATIENCE and not warned:
            warned = True
            place = f", building {count + 1} of {buildings}" if buildings else ""
            _LOG.warning(
                "waiting for %s%s: %.0f s so far; it is stopped after %g s, or as %s says",
                name, place, waited, seconds, SECONDS,
            )  # fmt: skip
