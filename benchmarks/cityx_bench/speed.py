"""How fast cities are built: seconds per stage, memory and triangles, beside what peers take.

Figures are CPU seconds (user and system, workers included, imports apart) but where they are told
to be on the clock, which several cores shorten, and medians of repeats.
Every build is a process of its own, without pictures. A peer reads the same map in the same run,
each turn after a build of ours, so that ratios hold where machines are noisy.
"""

from __future__ import annotations

import bz2
import gzip
import json
import os
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from cityx.errors import EngineError, InputError
from cityx.system.atomic import replaced
from cityx_bench.peers import PARSE, Peer, peer_once

# Maps that are built where a folder of maps holds them.
MAPS = (
    "london_soho.osm.gz", "tokyo_ichigaya.osm.gz", "tokyo_kanda.osm.gz", "krems.osm.gz",
    "liechtenstein_2013.osm.bz2", "liechtenstein_latest.osm.gz",
)  # fmt: skip
# Actions of streets, ground, nature and weather; the rest are of buildings and of what moves.
OUTSIDE = ("road/", "nature/", "background/")
NO_BYTECODE = "PYTHONDONTWRITEBYTECODE"
RECORD, PARTIAL = "speed.json", "speed.partial.jsonl"
BEGIN, END = "<!-- begin: cityx bench speed -->", "<!-- end: cityx bench speed -->"
Say = Callable[[str], None]


def maps_in(folder: Path) -> list[Path]:
    """Return the maps of `MAPS` that a folder holds.

    Raises
    ------
    InputError
        When it holds none of them.
    """
    found = [folder / name for name in MAPS if (folder / name).exists()]
    if not found:
        raise InputError(f"{folder} holds none of {', '.join(MAPS)}. Name maps of your own.")
    return found


def content_of(path: Path) -> bytes:
    """Return the content of a map, unpacked where it is gzip or bzip2."""
    unpack = {".gz": gzip.decompress, ".bz2": bz2.decompress}.get(path.suffix)
    content = path.read_bytes()
    return content if unpack is None else unpack(content)


def build_once(path: Path, lod: int, workers: int) -> dict[str, Any]:
    """Build one map in a fresh process and return its report."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "city"
        command = [
            sys.executable, "-m", "cityx.cli", "build", str(path), "-o", str(out),
            "--no-render", "--formats", "blend", "--lod", str(lod), "--workers", str(workers),
        ]  # fmt: skip
        # Compiling modules is part of importing them; a process that may not keep them compiled
        # does so within its steps, too.
        kept = {name: word for name, word in os.environ.items() if name != NO_BYTECODE}
        done = subprocess.run(command, capture_output=True, text=True, check=False, env=kept)
        if done.returncode not in (0, 1):
            raise EngineError(f"{path.name}: exit {done.returncode}\n{done.stderr}")
        report: dict[str, Any] = json.loads((out / "report.json").read_text())
        report["blend_mb"] = (out / "city.blend").stat().st_size / 1e6
        return report


def _median(reports: Sequence[Mapping[str, Any]], *steps: str, of: str = "cpu_s") -> float:
    sums = [sum(float(report[of].get(step, 0.0)) for step in steps) for report in reports]
    return statistics.median(sums)


def row_of(path: Path, lod: int, reports: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Fold the repeats of one build into a row of medians."""
    report = reports[0]
    other = ("import", PARSE, "store", "glb", "check", "blender")
    actions = [step for step in report["cpu_s"] if not step.startswith(other)]
    buildings = max(report["counts"]["buildings"], 1)
    outside = [step for step in actions if step.startswith(OUTSIDE)]
    clock = _median(reports, *outside, of="timings_s") / report["area_km2"]
    parse, generate = _median(reports, PARSE), _median(reports, *actions)
    mesh = _median(reports, "store", "blender read", "blender setup")
    save = _median(reports, "blender save")
    total = parse + generate + mesh + save
    size = len(content_of(path)) / 1e6
    return {
        "map": path.name,
        "LOD": lod,
        "buildings": report["counts"]["buildings"],
        "km2": f"{report['area_km2']:.2f}",
        "parse s": f"{parse:.2f}",
        "MB/s": f"{size / max(parse, 1e-9):.0f}",
        "generate s": f"{generate:.2f}",
        "mesh s": f"{mesh:.2f}",
        "save s": f"{save:.2f}",
        "ms/building": f"{1000 * total / buildings:.2f}",
        "s/km2": f"{total / report['area_km2']:.2f}",
        "streets, nature s/km2": f"{_median(reports, *outside) / report['area_km2']:.2f}",
        "on the clock s/km2": f"{clock:.2f}",
        "peak MB": f"{max(r['peak_rss_mb'] for r in reports):.0f}",
        ".blend MB": f"{report['blend_mb']:.1f}",
        "triangles unique": f"{report['triangles']['unique']:,}",
        "unique/s": f"{report['triangles']['unique'] / total:,.0f}",
        "as seen": f"{report['triangles']['instanced']:,}",
        "M seen/km2": f"{report['triangles']['instanced'] / report['area_km2'] / 1e6:.1f}",
    }


def measure_speed(
    maps: Sequence[Path], lods: Sequence[int], out: Path, *, command: str, repeat: int,
    workers: int, peers: Sequence[Peer], skipped: Mapping[str, str], say: Say,
) -> dict[str, Any]:  # fmt: skip
    """Build maps at levels of detail beside peers, and return and keep what was measured.

    Parameters
    ----------
    maps, lods
        What is built.
    out
        Folder of speed.json; what a killed process measured there is not measured again.
    command
        As it is told.
    repeat, workers
        Builds of each, and processes of one.
    peers, skipped
        Who reads the same, and who cannot be run here, with the reason.
    """
    asked = [command, [peer.name for peer in peers], [str(path.resolve()) for path in maps]]
    out.mkdir(parents=True, exist_ok=True)
    partial = out / PARTIAL
    kept = _kept(partial, asked)
    with partial.open("w", encoding="utf-8") as file:
        file.writelines(f"{json.dumps(line)}\n" for line in (asked, *kept))
        for lod in lods:
            for path in maps:
                if any(one["lod"] == lod and one["map"] == path.name for one in kept):
                    continue
                others = peers if lod == lods[0] else ()
                found = {"lod": lod, "map": path.name,
                         **_measured(path, lod, repeat, workers, others)}  # fmt: skip
                kept.append(found)
                file.write(f"{json.dumps(found)}\n")
                file.flush()
                say(f"{path.name} at level {lod}: {found['row']['ms/building']} ms a building")
    record = {
        "command": command,
        "rows": [one["row"] for one in kept],
        "beside": [row for one in kept for row in one["beside"]],
        "skipped": dict(skipped),
    }
    with replaced(out / RECORD) as temporary:
        temporary.write_text(json.dumps(record, indent=1), encoding="utf-8")
    partial.unlink()
    return record


def _measured(
    path: Path, lod: int, repeat: int, workers: int, peers: Sequence[Peer]
) -> dict[str, Any]:
    """Build a map, each turn followed by the peers; return the rows of its tables."""
    reports = []
    taken: dict[str, list[float]] = {peer.name: [] for peer in peers}
    for _ in range(repeat):
        reports.append(build_once(path, lod, workers))
        for peer in peers:
            taken[peer.name].append(peer_once(peer, content_of(path)))
    return {
        "row": row_of(path, lod, reports),
        "beside": [_beside(path, peer, reports, taken[peer.name]) for peer in peers],
    }


def _kept(partial: Path, asked: list[Any]) -> list[dict[str, Any]]:
    """Return what a killed process measured of the same; half a line is no measurement."""
    if not partial.exists():
        return []
    lines: list[Any] = []
    for text in partial.read_text(encoding="utf-8").splitlines():
        try:
            lines.append(json.loads(text))
        except ValueError:
            break
    return lines[1:] if lines[:1] == [asked] else []


def text_of(record: Mapping[str, Any]) -> str:
    """Return what was measured as tables in Markdown, with who was skipped and why."""
    parts = [table_of(record["rows"])]
    if record["beside"]:
        parts.append(table_of(record["beside"]))
    parts += [f"Not run: {name}, since {reason}." for name, reason in record["skipped"].items()]
    return "\n\n".join(parts)


def _beside(
    path: Path, peer: Peer, reports: Sequence[Mapping[str, Any]], taken: Sequence[float]
) -> dict[str, Any]:
    """Return a row of what a peer takes beside the steps of ours that come as far."""
    ours, theirs = _median(reports, *peer.steps), statistics.median(taken)
    return {
        "map": path.name,
        "peer": peer.name,
        "makes": peer.makes,
        "our steps": ", ".join(peer.steps),
        "peer s": f"{theirs:.2f}",
        "ours s": f"{ours:.2f}",
        "ours / peer": f"{ours / max(theirs, 1e-9):.2f}",
    }


def table_of(rows: Sequence[Mapping[str, Any]]) -> str:
    """Write rows as a Markdown table."""
    head = list(rows[0])
    lines = ["| " + " | ".join(head) + " |", "|" + " --- |" * len(head)]
    lines += ["| " + " | ".join(str(row[key]) for key in head) + " |" for row in rows]
    return "\n".join(lines)


def write_into(page: Path, text: str) -> None:
    """Replace what stands between the marks of a page.

    Raises
    ------
    InputError
        When the page has no marks.
    """
    old = page.read_text(encoding="utf-8") if page.exists() else ""
    if BEGIN not in old or END not in old:
        raise InputError(f"{page} has no place for the table: {BEGIN} and {END}.")
    before, rest = old.split(BEGIN, 1)
    with replaced(page) as temporary:
        temporary.write_text(
            f"{before}{BEGIN}\n{text}\n{END}{rest.split(END, 1)[1]}", encoding="utf-8"
        )
