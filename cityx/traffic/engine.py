"""The programs of SUMO: where they are, how they are run, what they say when they fail."""

from __future__ import annotations

import os
import re
import subprocess
from collections.abc import Sequence
from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path

from cityx.errors import EngineError, MissingExtra

EXTRA = "traffic"
NEEDED = ("sumo", "libsumo", "sumolib", "pyarrow")
MOST_LINES = 12  # of an engine's own words that an error repeats
_NOISE = re.compile(r"SUMO_HOME|pj_obj_create|disabling XML validation|^\s*$")


def require_sumo() -> None:
    """Raise unless the wheels of SUMO are installed.

    Raises
    ------
    MissingExtra
        Naming the extra.
    """
    missing = [name for name in NEEDED if find_spec(name) is None]
    if missing:
        raise MissingExtra(
            f"Traffic needs SUMO ({', '.join(missing)} cannot be imported): "
            f'install it with  pip install "cityx[{EXTRA}]"'
        )


@lru_cache(maxsize=1)
def sumo_home() -> Path:
    """Return the folder of SUMO's programs and tables."""
    require_sumo()
    spec = find_spec("sumo")
    assert spec is not None
    assert spec.origin is not None
    return Path(spec.origin).parent


def sumo_environment() -> dict[str, str]:
    """Return the environment in which SUMO's programs find their own tables."""
    home = sumo_home()
    return {
        **os.environ, "SUMO_HOME": str(home),
        "PROJ_LIB": str(home / "data" / "proj"), "PROJ_DATA": str(home / "data" / "proj"),
    }  # fmt: skip


def run_program(name: str, args: Sequence[str], folder: Path, *, timeout_s: float) -> list[str]:
    """Run a program of SUMO in a folder and wait for it.

    Returns
    -------
    lines
        What it said.

    Raises
    ------
    EngineError
        If it fails, is killed or takes too long; with its last words.
    """
    program = sumo_home() / "bin" / (name + (".exe" if os.name == "nt" else ""))
    try:
        done = subprocess.run(
            [str(program), *args], cwd=folder, env=sumo_environment(), capture_output=True,
            text=True, errors="replace", timeout=timeout_s, check=False,
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        raise EngineError(f"{name} took longer than {timeout_s:g} s and was ended.") from None
    except OSError as error:
        raise EngineError(f"{name} cannot be started: {error}") from error
    lines = said(done.stdout + "\n" + done.stderr)
    if done.returncode:
        raise EngineError(f"{name} {fate(done.returncode)}. Its last words:\n{last(lines)}")
    return lines


def said(text: str) -> list[str]:
    """Return the lines that an engine wrote, without those about its installation."""
    return [line for line in text.splitlines() if not _NOISE.search(line)]


def last(lines: Sequence[str]) -> str:
    """Return the last of an engine's words, errors before all else."""
    errors = [line for line in lines if line.startswith("Error")]
    return "\n".join((errors or list(lines))[-MOST_LINES:])


def fate(code: int) -> str:
    """Describe how a process ended."""
    return f"was ended by signal {-code}" if code < 0 else f"ended with status {code}"
