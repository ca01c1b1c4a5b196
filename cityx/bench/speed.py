"""How fast cities are built: seconds per stage, memory and triangles, beside what peers take.

Figures are CPU seconds (user and system, workers included, imports apart), medians of repeats.
Every build is a process of its own, without pictures. A peer reads the same map in the same run,
each turn after a build of ours, so that ratios hold where machines are noisy.
"""

from __future__ import annotations

import bz2
import gzip
import importlib.util
import json
import os
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

from cityx.atomic import replaced
from cityx.errors import EngineError, InputError, MissingExtra, UsageError, nearest

# Maps that are built where a folder of maps holds them.
MAPS = (
    "london_soho.osm.gz", "tokyo_ichigaya.osm.gz", "tokyo_kanda.osm.gz", "krems.osm.gz",
    "liechtenstein_2013.osm.bz2", "liechtenstein_latest.osm.gz",
)  # fmt: skip
NO_BYTECODE = "PYTHONDONTWRITEBYTECODE"
PARSE = "layout/inputs"  # step that reads the map
BEGIN, END = "<!-- begin: cityx bench speed -->", "<!-- end: cityx bench speed -->"
LONGEST = 900.0  # seconds that a peer may take
Say = Callable[[str], None]


@dataclass(frozen=True)
class Peer:
    """A program that reads the same map, and what of ours does the same.

    Attributes
    ----------
    name
        As asked for.
    module
        That must be installed.
    makes
        What comes out of it.
    script
        Python that reads ``sys.argv[1]``, an .osm file, and prints its CPU seconds.
    steps
        Our steps that come as far.
    """

    name: str
    module: str
    makes: str
    script: str
    steps: tuple[str, ...]

    @property
    def installed(self) -> bool:
        """Whether it can be run here."""
        return importlib.util.find_spec(self.module) is not None


_OSMNX = """
import sys, time
import osmnx
begin = time.process_time()
osmnx.features_from_xml(sys.argv[1], tags={"building": True})
osmnx.graph_from_xml(sys.argv[1])
print(time.process_time() - begin)
"""
_NETCONVERT = """
import resource, sys
from pathlib import Path
from cityx.traffic.engine import run_program
path = Path(sys.argv[1])
run_program("netconvert", ["--osm-files", path.name, "-o", "net.xml"], path.parent, timeout_s=900.0)
used = resource.getrusage(resource.RUSAGE_CHILDREN)
print(used.ru_utime + used.ru_stime)
"""
_NETWORK = (PARSE, "road/drawn_streets", "road/network", "road/lanes")
PEERS: Mapping[str, Peer] = MappingProxyType({
    peer.name: peer
    for peer in (
        Peer("osmnx", "osmnx", "tables of buildings and a graph of streets", _OSMNX,
             (PARSE, "road/drawn_streets", "road/network")),
        Peer("netconvert", "sumo", "lanes, junctions and signals, no buildings", _NETCONVERT,
             _NETWORK),
    )
})  # fmt: skip


def peers_named(words: Iterable[str]) -> tuple[Peer, ...]:
    """Return peers by their names; all that are installed for "installed".

    Raises
    ------
    UsageError
        For a name that is no peer.
    MissingExtra
        For one that is not installed.
    """
    found: list[Peer] = []
    for word in words:
        if word == "installed":
            found += [peer for peer in PEERS.values() if peer.installed]
        elif word not in PEERS:
            raise UsageError(f'There is no peer "{word}".{nearest(word, PEERS)}')
        elif not PEERS[word].installed:
            raise MissingExtra(f"{word} is not installed: pip install {PEERS[word].module}")
        else:
            found.append(PEERS[word])
    return tuple(dict.fromkeys(found))


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


def peer_once(peer: Peer, content: bytes) -> float:
    """Let a peer read a map in a process of its own and return its CPU seconds.

    Raises
    ------
    EngineError
        When it fails or takes longer than `LONGEST`.
    """
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "map.osm"
        path.write_bytes(content)
        command = [sys.executable, "-c", peer.script, str(path)]
        try:
            done = subprocess.run(
                command, capture_output=True, text=True, check=False, timeout=LONGEST
            )
        except subprocess.TimeoutExpired as error:
            raise EngineError(f"{peer.name} took more than {LONGEST:.0f} s") from error
        if done.returncode:
            last = done.stderr.strip().splitlines()[-1:]
            raise EngineError(f"{peer.name} ended with {done.returncode}: {''.join(last)}")
        return float(done.stdout.split()[-1])


def _median(reports: Sequence[Mapping[str, Any]], *steps: str) -> float:
    sums = [sum(float(report["cpu_s"].get(step, 0.0)) for step in steps) for report in reports]
    return statistics.median(sums)


def row_of(path: Path, lod: int, reports: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Fold the repeats of one build into a row of medians."""
    report = reports[0]
    other = ("import", PARSE, "store", "glb", "check", "blender")
    actions = [step for step in report["cpu_s"] if not step.startswith(other)]
    buildings = max(report["counts"]["buildings"], 1)
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
        "peak MB": f"{max(r['peak_rss_mb'] for r in reports):.0f}",
        ".blend MB": f"{report['blend_mb']:.1f}",
        "triangles unique": f"{report['triangles']['unique']:,}",
        "unique/s": f"{report['triangles']['unique'] / total:,.0f}",
        "as seen": f"{report['triangles']['instanced']:,}",
        "M seen/km2": f"{report['triangles']['instanced'] / report['area_km2'] / 1e6:.1f}",
    }


def measure_speed(
    maps: Sequence[Path], lods: Sequence[int], *, repeat: int, workers: int,
    peers: Sequence[Peer], say: Say,
) -> str:  # fmt: skip
    """Build maps at levels of detail beside peers, and return the tables in Markdown."""
    rows, beside = [], []
    for lod in lods:
        for path in maps:
            reports = []
            taken: dict[str, list[float]] = {peer.name: [] for peer in peers}
            for _ in range(repeat):
                reports.append(build_once(path, lod, workers))
                for peer in peers if lod == lods[0] else ():
                    taken[peer.name].append(peer_once(peer, content_of(path)))
            rows.append(row_of(path, lod, reports))
            say(f"{path.name} at level {lod}: {rows[-1]['ms/building']} ms a building")
            beside += [_beside(path, peer, reports, taken[peer.name])
                       for peer in peers if taken[peer.name]]  # fmt: skip
    return table_of(rows) + (f"\n\n{table_of(beside)}" if beside else "")


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
