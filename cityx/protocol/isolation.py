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
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from cityx.errors import ActionFailed, InputError
from cityx.protocol.input_files import InputFiles

if TYPE_CHECKING:
    from cityx.city.city import City
    from cityx.protocol.gate import Call

CHILD = "cityx.protocol.isolated_child"
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
        said = _run([sys.executable, "-m", CHILD, name], limits, call.action)
        if said:
            raise ActionFailed(f"{call.action} failed: {said}")
        try:
            return read_city(folder / "after")
        except (InputError, OSError, ValueError, KeyError, TypeError) as error:
            raise ActionFailed(f"{call.action} gave back no city: {error}") from error


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
