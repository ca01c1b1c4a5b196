"""The process of an isolated action: ``python -m cityx.protocol.isolated_child FOLDER``."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

from cityx.city.store import read_city, write_city
from cityx.errors import CityxError
from cityx.protocol.gate import Call
from cityx.protocol.input_files import InputFiles
from cityx.protocol.registry import registry
from cityx.protocol.running import run_action


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
    inputs = InputFiles(tuple(map(Path, job["paths"])), tuple(job["kinds"]))
    try:
        call = Call(**job["call"])
        made = run_action(read_city(folder / "before"), call, registry(), inputs=inputs).city
        write_city(made, folder / "after")
    except (CityxError, MemoryError) as error:
        sys.stderr.write(f"{type(error).__name__ if not str(error) else error}\n")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
