"""A Blender process as its caller sees it: a module is started, its words are followed.

Blender runs in a process of its own: a crash or a hang of the engine cannot take the city along,
its memory is given back, and nothing but that process ever imports ``bpy``.
"""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import threading
from collections import deque
from collections.abc import Callable, Generator, Mapping
from dataclasses import dataclass, field
from math import inf
from pathlib import Path
from queue import Empty, SimpleQueue
from time import monotonic
from typing import IO, Any, NamedTuple

from cityx.errors import EngineError, MissingDependency

PROGRESS = "@cityx "
LOG_LINES = 15  # of the engine's own words, shown when it fails
# Of the process. Idle threads that spin would take the cores from the ones that work; colour
# transforms that are kept for each exposure ever used would take 2.7 MB a picture.
SETTINGS: Mapping[str, str] = {
    "OMP_WAIT_POLICY": "PASSIVE", "PYTHONUNBUFFERED": "1", "OCIO_DISABLE_PROCESSOR_CACHES": "1",
}  # fmt: skip
# Shared libraries that Blender needs and small systems lack: file name -> Debian, Fedora package.
LIBRARIES: Mapping[str, tuple[str, str]] = {
    "libX11": ("libx11-6", "libX11"),
    "libXrender": ("libxrender1", "libXrender"),
    "libXxf86vm": ("libxxf86vm1", "libXxf86vm"),
    "libXfixes": ("libxfixes3", "libXfixes"),
    "libXi": ("libxi6", "libXi"),
    "libXext": ("libxext6", "libXext"),
    "libXcursor": ("libxcursor1", "libXcursor"),
    "libXinerama": ("libxinerama1", "libXinerama"),
    "libXrandr": ("libxrandr2", "libXrandr"),
    "libxkbcommon": ("libxkbcommon0", "libxkbcommon"),
    "libSM": ("libsm6", "libSM"),
    "libICE": ("libice6", "libICE"),
    "libGL": ("libgl1", "libglvnd-glx"),
    "libEGL": ("libegl1", "libglvnd-egl"),
    "libOpenGL": ("libopengl0", "libglvnd-opengl"),
    "libGLX": ("libglx0", "libglvnd-glx"),
    "libgomp": ("libgomp1", "libgomp"),
    "libasound": ("libasound2", "alsa-lib"),
    "libwayland-client": ("libwayland-client0", "libwayland-client"),
    "libdecor-0": ("libdecor-0-0", "libdecor"),
    "libdbus-1": ("libdbus-1-3", "dbus-libs"),
}


class Progress(NamedTuple):
    """The share done, 0 to 1, and a few words."""

    share: float
    text: str


class Made(NamedTuple):
    """A picture that is complete: its .png, and what is known of it (`cityx.blender.passes`)."""

    path: Path
    facts: Mapping[str, Any]


@dataclass
class Log:
    """The last lines of the engine; mutable because a thread fills it."""

    lines: deque[str] = field(default_factory=lambda: deque(maxlen=LOG_LINES))

    def text(self) -> str:
        """Return the lines as one text."""
        return "\n".join(self.lines)


def run_module(
    module: str,
    request: Mapping[str, Any],
    folder: Path,
    *,
    timeout_s: float = 3600.0,
    progress: Callable[[float, str], None] | None = None,
) -> tuple[int, str]:
    """Run another job in a Blender process of its own and wait for it.

    Parameters
    ----------
    module
        Module of `cityx.blender` that is run with the file of the job.
    request
        The job; the id of this process is added as ``parent``.
    folder
        Where the file of the job is written.
    timeout_s, progress
        Seconds after which the process is killed; called with the share done, 0 to 1, and words.

    Returns
    -------
    code, log
        Exit code, negative for a signal, and the last words of the process.

    Raises
    ------
    MissingDependency
        If Blender's module or a shared library it needs is absent; names the packages.
    EngineError
        If the process took too long.
    """
    path = folder / "job.json"
    path.write_text(json.dumps({**request, "parent": os.getpid()}))
    code, log = _run(path, timeout_s, progress, module)
    missing = re.search(r"(ImportError|ModuleNotFoundError): (.*)", log.text())
    if code and missing:
        raise MissingDependency(explain_missing(missing.group(2)))
    return code, log.text()


def _run(
    request: Path, timeout_s: float, progress: Callable[[float, str], None] | None, module: str
) -> tuple[int, Log]:
    """Start the process, follow its words, return its exit code and last lines."""
    talk = converse(request, timeout_s=timeout_s, module=module)
    while True:
        try:
            word = next(talk)
        except StopIteration as end:
            code, log = end.value
            return code, log
        if progress is not None and isinstance(word, Progress):
            progress(*word)


def converse(
    request: Path,
    *,
    timeout_s: float,
    silence_s: float = inf,
    module: str = "cityx.blender.worker",
) -> Generator[Progress | Made, None, tuple[int, Log]]:
    """Start the process, yield what it reports, return its exit code and last lines."""
    environment = {**os.environ, **SETTINGS}
    process = subprocess.Popen(
        [sys.executable, "-m", module, str(request)],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        env=environment,
        start_new_session=True,
    )
    log, words = Log(), _Words()
    assert process.stdout is not None
    reader = threading.Thread(target=_follow, args=(process.stdout, log, words), daemon=True)
    reader.start()
    limit = monotonic() + timeout_s
    try:
        yield Progress(0.0, "starting Blender")
        asked = monotonic()
        while True:
            # Silence counts while somebody listens: the process may wait for its reader.
            left = min(limit, max(words.last, asked) + silence_s) - monotonic()
            if left <= 0 and words.queue.empty():
                fate = f"after {timeout_s:g} s" if monotonic() >= limit else (
                    f"when it had said nothing for {silence_s:g} s")  # fmt: skip
                raise EngineError(f"Blender was stopped {fate}. Its last words:\n{log.text()}")
            try:
                word = words.queue.get(timeout=None if left == inf else max(left, 0.0))
            except Empty:  # it may have said other things meanwhile
                continue
            if word is None:
                break
            yield word
            asked = monotonic()
        process.wait()  # its last words are said
    finally:
        _kill(process)
        reader.join(5.0)
        process.stdout.close()
    return process.returncode, log


@dataclass
class _Words:
    """What a process reports, None at its end; mutable because a thread fills it."""

    queue: SimpleQueue[Progress | Made | None] = field(default_factory=SimpleQueue)
    last: float = field(default_factory=monotonic)  # when it said anything


def _kill(process: subprocess.Popen[str]) -> None:
    """Make sure that neither the process nor a child of it stays behind."""
    if process.poll() is None:
        if hasattr(os, "killpg"):
            os.killpg(process.pid, signal.SIGKILL)
        else:
            process.kill()
        process.wait()


def _follow(stream: IO[str], log: Log, words: _Words) -> None:
    """Pass reports on and keep the rest."""
    try:
        for line in stream:
            words.last = monotonic()
            if line.startswith(PROGRESS):
                report = json.loads(line.removeprefix(PROGRESS))
                if isinstance(report, dict):
                    words.queue.put(Made(Path(report["made"]), report["facts"]))
                else:
                    words.queue.put(Progress(*report))
            elif line.strip():
                log.lines.append(line.rstrip())
    finally:
        words.queue.put(None)


def explain_missing(message: str) -> str:
    """Turn an ImportError of Blender's module into advice.

    Parameters
    ----------
    message
        Such as ``libSM.so.6: cannot open shared object file: No such file or directory``.
    """
    found = re.search(r"(lib[\w.+-]+?)\.so", message)
    if found is None:
        return (
            f"Blender's Python module cannot be loaded ({message}). "
            'Install it with: pip install "bpy>=4.5.15,<4.6"'
        )
    library = found.group(1)
    packages = LIBRARIES.get(library)
    own = (
        f"It is in the package {packages[0]} (Debian, Ubuntu) or {packages[1]} (Fedora). "
        if packages
        else ""
    )
    names = ("libX11", "libXrender", "libXxf86vm", "libXfixes", "libXi", "libxkbcommon", "libSM",
             "libICE", "libGL", "libEGL")  # fmt: skip
    debian = " ".join(LIBRARIES[name][0] for name in names)
    fedora = " ".join(dict.fromkeys(LIBRARIES[name][1] for name in names))
    return (
        f"Blender needs the system library {library}, which is not installed. {own}"
        f"All it needs: apt-get install {debian} (Debian, Ubuntu) or dnf install {fedora} (Fedora)."
    )
