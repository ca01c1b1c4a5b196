"""Curve objects of .blend files: lines that somebody drew in Blender, by the names of the objects.

Places are metres east and north of the city's origin, as ``city.blend`` shows them; heights of the
curves are not used.
"""

from __future__ import annotations

import json
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import shapely

from cityx.errors import EngineError, InputError, nearest

SUFFIX = ".blend"
# What a .blend begins with: plain, or compressed by Zstandard or gzip.
MAGIC = (b"BLENDER", b"\x28\xb5\x2f\xfd", b"\x1f\x8b")
SLACK = 0.01  # metres by which a curve's points may be off the line that is kept
MOST_NAMED = 5  # objects that a refusal names

Line = tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class BlendCurves:
    """The curve objects of a file.

    Attributes
    ----------
    lines
        Name of a curve to the lines of its splines, metres; closed ones end where they begin.
    properties
        Name of a curve to the custom properties of its object.
    kinds
        Name of every object to its type in Blender's words.
    """

    path: Path
    lines: dict[str, tuple[Line, ...]]
    properties: dict[str, dict[str, str | int | float]]
    kinds: dict[str, str]

    def line(self, name: str) -> Line:
        """Return the one line of a curve.

        Raises
        ------
        InputError
            If there is no such object, or it is no curve, or a curve of none or several splines.
        """
        if name not in self.kinds:
            raise InputError(
                f'{self.path} has no object "{name}".{nearest(name, self.kinds) or self._held()}'
            )
        if name not in self.lines:
            raise InputError(
                f'"{name}" of {self.path} is a {self.kinds[name]}, no curve.{self._held()}'
            )
        if len(self.lines[name]) != 1:
            raise InputError(
                f'The curve "{name}" of {self.path} draws {len(self.lines[name])} lines; a path '
                "is one spline of two points or more."
            )
        return self.lines[name][0]

    def _held(self) -> str:
        names = list(self.lines)
        more = f" and {len(names) - MOST_NAMED} more" if len(names) > MOST_NAMED else ""
        shown = ", ".join(f'"{name}"' for name in names[:MOST_NAMED])
        return f" Its curves are {shown}{more}." if names else " It holds no curve."


def read_blend_curves(path: Path) -> BlendCurves:
    """Read the curves of a .blend in a Blender process; nothing in the file is run.

    Raises
    ------
    InputError
        If the file is missing or is no .blend that can be read.
    MissingDependency
        If Blender is not installed.
    """
    from cityx.system.blender_process import run_module

    try:
        with path.open("rb") as file:
            head = file.read(8)
    except OSError as error:
        raise InputError(f"cannot read {path}: {error.strerror}.") from error
    if not head.startswith(MAGIC):
        raise InputError(f"{path} is no .blend file; save it from Blender.")
    with tempfile.TemporaryDirectory(prefix="cityx-curves-") as work:
        answer = Path(work) / "result.json"
        job = {"blend": str(path.resolve()), "result": str(answer)}
        code, log = run_module("cityx.blender.curves", job, Path(work))
        if code or not answer.exists():
            raise EngineError(f"Blender could not read {path}. Its last words:\n{log}")
        record = json.loads(answer.read_text())
    if "unreadable" in record:
        raise InputError(f"{path}: {record['unreadable']}.")
    lines = {
        name: tuple(plain_line(np.array(part)) for part in parts)
        for name, parts in record["lines"].items()
    }
    return BlendCurves(path, lines, record["properties"], record["kinds"])


def plain_line(points: np.ndarray[tuple[int, ...], np.dtype[np.float64]]) -> Line:
    """Return the places of a line without points that say nothing."""
    line = shapely.simplify(shapely.LineString(points[:, :2]), SLACK)
    return tuple((float(x), float(y)) for x, y in shapely.get_coordinates(line))
