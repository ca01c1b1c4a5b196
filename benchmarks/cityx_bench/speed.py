"""How long a user waits: whole builds as the command line makes them, phase by phase.

Each build is a process of its own, without options but the level of detail: ``blend,glb``, checks,
report and store. "Cold" begins with an empty cache of CityX, "warm" finds what that has left
there, "pictures" is warm and renders. What a build spends is told by the system: CPU seconds (user
and system) of the process and all that it started, the clock, and memory of all of them at a
time. Phases are told by the report of the build; what is left of the whole is named ``rest``.

Every measurement is a line of a log, which a later command goes on with; the tables are made of
all lines. A peer reads the same map right after a build of ours, so that ratios hold where
machines are noisy.
"""

from __future__ import annotations

import bz2
import gzip
import json
import os
import resource
import shutil
import signal
import statistics
import struct
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import shapely

import cityx
from cityx.errors import EngineError, InputError
from cityx.system.atomic import replaced
from cityx.system.digests import edition_of
from cityx_bench.inputs import VILLAGE, village, write_map
from cityx_bench.peers import PEERS, Peer, peer_once
from cityx_bench.scenes import Box, Thing, street

# Maps that are built where folders of maps hold them, short ones first, and of what kind they are.
MAPS: Mapping[str, str] = MappingProxyType({
    "rome_via_montebello.osm.gz": "dense, a few blocks",
    "london_soho.osm.gz": "dense, old",
    "austin.osm.gz": "suburb, large trees",
    "singapore_bayfront.osm.gz": "towers",
    "higashimurayama.osm.gz": "suburb, small plots",
    "nuremberg_laufamholz.osm": "suburb, woods",
    "moscow_timiryazevo.osm.gz": "slabs among trees",
    "sydney_glebe.osm.gz": "terraces",
    "st_moritz.osm.gz": "mountains",
    "tokyo_ichigaya.osm.gz": "dense",
    "tokyo_kanda.osm.gz": "dense, wide streets",
    "new_york_lower_manhattan.osm.gz": "towers, trees",
    "krems.osm.gz": "old town, vineyards",
    "baltimore.osm.gz": "wide, rows of houses",
    "campo_grande_clip.osm.gz": "wide, few houses mapped",
    "bayreuth_north.osm.gz": "wide, wooded",
    "liechtenstein_latest.osm.gz": "mountains, wide",
})  # fmt: skip
MADE = "made_village.osm", "made_village_in_100_km2.osm"
SPREAD: Box = (-5000.0, -5000.0, 5000.0, 5000.0)
CELL = 100.0  # metres: a cell that a building reaches into is built ground
COLD, WARM, PICTURED = "cold", "warm", "pictures"
BUILDS = (COLD, WARM, PICTURED)
# Steps of a report by what they belong to: how their names begin. A picture is not of a scene.
PHASES: Mapping[str, tuple[str, ...]] = MappingProxyType({
    "start": ("start", "request", "import"),
    "read": ("layout/",),
    "buildings": ("building/",),
    "streets": ("road/", "background/"),
    "nature": ("nature/",),
    "checks": ("checks", "goals", "counts"),
    "fidelity": ("fidelity",),
    "store": ("store", "snapshot"),
    "glb": ("glb",),
    "pictures": ("blender light", "blender render"),
    "blend": ("blender save",),
    "scene": ("blender",),
})  # fmt: skip
REST, OTHER = "rest", "other"
NO_BYTECODE = "PYTHONDONTWRITEBYTECODE"
LOG, RECORD = "runs.jsonl", "speed.json"
BEGIN, FINISH = "<!-- begin: cityx bench speed -->", "<!-- end: cityx bench speed -->"
LOOK_S = 0.25  # seconds from look to look at the memory of processes
ACTIONS = 12  # that the table of actions has room for
Run = Mapping[str, Any]
Say = Callable[[str], None]


@dataclass(frozen=True)
class Wanted:
    """What is to be measured.

    Attributes
    ----------
    maps, lods, builds
        What is built, and with which caches.
    repeat
        Builds of each.
    longest
        Seconds of the clock after which a build is given up.
    workers
        Processes of a build, 0 for what is usual.
    peers, skipped
        Who reads the same, and what cannot be run here, with the reason.
    command
        As it is told.
    """

    maps: Sequence[Path]
    lods: Sequence[int] = (2,)
    builds: Sequence[str] = (COLD, WARM)
    repeat: int = 1
    longest: float = 1800.0
    workers: int = 0
    peers: Sequence[Peer] = ()
    skipped: Mapping[str, str] = field(default_factory=dict)
    command: str = "cityx bench speed"


# --- maps -----------------------------------------------------------------------------------------


def maps_in(paths: Iterable[Path]) -> tuple[list[Path], dict[str, str]]:
    """Return the maps that are named, and those of `MAPS` that folders among them hold.

    Returns
    -------
    maps
        In the order of `MAPS`, after those that are named.
    skipped
        Those that no folder holds, with the reason.

    Raises
    ------
    InputError
        For a file that is none, or when nothing is found.
    """
    given = list(paths)
    folders = [path for path in given if path.is_dir()]
    found = [path for path in given if not path.is_dir()]
    if missing := [str(path) for path in found if not path.is_file()]:
        raise InputError(f"no such map: {', '.join(missing)}.")
    held = {name: path for name in MAPS for folder in folders
            if (path := folder / name).is_file()}  # fmt: skip
    lacking = [name for name in MAPS if name not in held] if folders else []
    where = " and ".join(map(str, folders))
    if not found and not held:
        raise InputError(
            f"{where or 'nothing'} holds none of {', '.join(MAPS)}. Name maps of your own."
        )
    maps = [*found, *(held[name] for name in MAPS if name in held)]
    return maps, dict.fromkeys(lacking, f"it is not in {where}")


def made_maps(folder: Path) -> list[Path]:
    """Write a village, and the same village within 100 km2 of fields, woods and long roads."""
    folder.mkdir(parents=True, exist_ok=True)
    alone, spread = (folder / name for name in MADE)
    write_map(village(), VILLAGE, alone)
    write_map([*village(), *_around()], SPREAD, spread)
    return [alone, spread]


def _around() -> Iterator[Thing]:
    """Yield a chessboard of fields and woods with lanes between, and roads to the village."""
    west, south, east, north = SPREAD
    step = 1000
    for k, x in enumerate(range(int(west), int(east), step)):
        for j, y in enumerate(range(int(south), int(north), step)):
            if abs(x + step / 2) < step and abs(y + step / 2) < step:
                continue  # the village's own land
            use = "forest" if (k + j) % 3 == 0 else "farmland"
            shape = shapely.box(x + 20, y + 20, x + step - 20, y + step - 20)
            yield Thing(f"land {k} {j}", {"landuse": use}, shape)
    for x in range(int(west) + step, int(east), step):
        if abs(x) >= step:
            yield street(f"track {x}", "track", [(x, south), (x, north)])
    yield street("long road", "secondary", [(west, -280.0), (VILLAGE[0], -280.0), (-600.0, -240.0)])


def content_of(path: Path) -> bytes:
    """Return the content of a map, unpacked where it is gzip or bzip2."""
    unpack = {".gz": gzip.decompress, ".bz2": bz2.decompress}.get(path.suffix)
    content = path.read_bytes()
    return content if unpack is None else unpack(content)


# --- one build ------------------------------------------------------------------------------------


def build_once(
    path: Path, lod: int, out: Path, cache: Path, *, pictures: bool = False, workers: int = 0,
    longest: float = 1800.0,
) -> dict[str, Any]:  # fmt: skip
    """Build one map in a fresh process; returns what it took, and what came of it.

    Parameters
    ----------
    path, lod
        What is built.
    out
        Folder of the city, which is left there.
    cache
        Folder of what CityX keeps from build to build.
    pictures
        Whether they are rendered.
    workers, longest
        As of `Wanted`.

    Raises
    ------
    EngineError
        When the build ends without a city.
    """
    command = [sys.executable, "-m", "cityx.cli", "build", str(path), "-o", str(out),
               "--lod", str(lod)]  # fmt: skip
    command += [] if pictures else ["--no-render"]
    command += ["--workers", str(workers)] if workers else []
    # An installed program is compiled; one that may not keep it would be at every start.
    kept = {name: word for name, word in os.environ.items() if name != NO_BYTECODE}
    spent = run_watched(command, {**kept, "CITYX_CACHE": str(cache)}, longest)
    if spent.pop("late"):
        return {**spent, "error": f"not finished in {longest:.0f} s"}
    if spent["exit"] not in (0, 1):
        raise EngineError(f"{path.name}: exit {spent['exit']}\n{spent['told']}")
    del spent["told"]
    return {**spent, **_made(out)}


def run_watched(
    command: Sequence[str], environment: Mapping[str, str], longest: float
) -> dict[str, Any]:
    """Run a command to its end, and return what it and all that it starts take.

    Returns
    -------
    spent
        "cpu_s", "clock_s", "peak_mb", "exit", the last it "told", and whether it was too "late".
    """
    with tempfile.TemporaryFile() as told:
        begun = time.perf_counter()
        process = subprocess.Popen(
            command, env=dict(environment), stdout=subprocess.DEVNULL, stderr=told,
            start_new_session=True,
        )  # fmt: skip
        memory = _Memory(process.pid)
        late = threading.Event()
        timer = threading.Timer(longest, _stop, (process.pid, late))
        timer.start()
        memory.start()
        try:
            _, status, used = os.wait4(process.pid, 0)
        except BaseException:
            os.killpg(process.pid, signal.SIGKILL)  # its own session: no key stops it
            raise
        finally:
            timer.cancel()
            memory.done.set()
        process.returncode = os.waitstatus_to_exitcode(status)
        memory.join()
        told.seek(0)
        last = told.read()[-2000:].decode(errors="replace")
    return {
        "cpu_s": round(used.ru_utime + used.ru_stime, 3),
        "clock_s": round(time.perf_counter() - begun, 3),
        "peak_mb": round(max(memory.peak, used.ru_maxrss / 1024), 1),
        "exit": process.returncode,
        "told": last,
        "late": late.is_set(),
    }


def _stop(group: int, late: threading.Event) -> None:
    late.set()
    os.killpg(group, signal.SIGKILL)


class _Memory(threading.Thread):
    """Looks at what a process and its descendants hold together, shared pages once."""

    def __init__(self, process: int) -> None:
        super().__init__(daemon=True)
        self.process, self.peak, self.done = process, 0.0, threading.Event()

    def run(self) -> None:
        """Look until it is done."""
        most = 0.0
        while not self.done.wait(LOOK_S):
            family = list(_family(self.process))
            resident = sum(map(_resident_mb, family))
            if resident > most:  # to tell shared pages takes time
                most, self.peak = resident, max(self.peak, sum(map(_held_mb, family)))


def _family(process: int) -> Iterator[int]:
    """Yield a process and its descendants, as far as the system tells them."""
    yield process
    for path in Path(f"/proc/{process}/task").glob("*/children"):
        try:
            children = path.read_text().split()
        except OSError:
            continue  # it has just ended
        for child in children:
            yield from _family(int(child))


def _resident_mb(process: int) -> float:
    """Return the memory of a process, shared pages in full."""
    try:
        pages = int(Path(f"/proc/{process}/statm").read_text().split()[1])
    except OSError:
        return 0.0
    return pages * resource.getpagesize() / 2**20


def _held_mb(process: int) -> float:
    """Return the memory of a process; of pages that n share each has an n-th."""
    try:
        lines = Path(f"/proc/{process}/smaps_rollup").read_text().splitlines()
    except OSError:
        return 0.0
    return sum(int(line.split()[1]) for line in lines if line.startswith("Pss:")) / 1024


def _made(out: Path) -> dict[str, Any]:
    """Return what a folder of results tells of its build and of the city."""
    report = json.loads((out / "report.json").read_text())
    pictures = sorted((out / "renders").glob("*.png"))
    return {
        "phases": report["cpu_s"],
        "clock": report["timings_s"],
        "buildings": report["counts"]["buildings"],
        "trees": report["counts"]["trees"],
        "km2": report["area_km2"],
        "built_km2": built_km2(out / "city"),
        "seen": report["triangles"]["instanced"],
        "written": triangles_written(out / "city.glb"),
        "glb_mb": (out / "city.glb").stat().st_size / 1e6,
        "blend_mb": (out / "city.blend").stat().st_size / 1e6,
        "pictures": [path.stem for path in pictures],
        "failed": sorted(name for name, check in report["checks"].items() if not check["ok"]),
        "hash": report["hash"],
    }


def built_km2(store: Path) -> float:
    """Return the ground of a stored city in cells of `CELL` metres that buildings reach into."""
    from geopandas import read_parquet

    outlines = read_parquet(store / "layout" / "buildings.parquet").geometry.to_numpy()
    cells: set[tuple[int, int]] = set()
    for west, south, east, north in np.floor(shapely.bounds(outlines) / CELL).astype(int).tolist():
        cells |= {(x, y) for x in range(west, east + 1) for y in range(south, north + 1)}
    return len(cells) * CELL**2 / 1e6


def triangles_written(path: Path) -> int:
    """Return the triangles that a .glb holds; those that several meshes use count once."""
    with path.open("rb") as file:
        file.seek(12)
        (size,) = struct.unpack("<I4x", file.read(8))
        held = json.loads(file.read(size))
    used = {part["indices"] for mesh in held["meshes"] for part in mesh["primitives"]
            if "indices" in part}  # fmt: skip
    return int(sum(held["accessors"][index]["count"] // 3 for index in used))


# --- many builds ----------------------------------------------------------------------------------


def measure_speed(wanted: Wanted, out: Path, say: Say) -> dict[str, Any]:
    """Measure what the log does not hold yet, and return and keep the record of all.

    Parameters
    ----------
    wanted
        What is measured.
    out
        Folder of the log and of the record.
    """
    out.mkdir(parents=True, exist_ok=True)
    known = {_key(run) for run in read_log(out)}
    code = edition_of(sorted(Path(cityx.__file__).parent.rglob("*.py")))[:8]
    with (out / LOG).open("a", encoding="utf-8") as log:
        for found in _measured(wanted, known, say):
            log.write(f"{json.dumps({**found, 'code': code})}\n")
            log.flush()
    record = {"command": wanted.command, "skipped": dict(wanted.skipped), "runs": read_log(out)}
    with replaced(out / RECORD) as temporary:
        temporary.write_text(json.dumps(record, indent=1), encoding="utf-8")
    return record


def read_log(folder: Path) -> list[dict[str, Any]]:
    """Return what was measured before; half a line is no measurement, and is cut off."""
    path = folder / LOG
    if not path.exists():
        return []
    text = path.read_text(encoding="utf-8")
    whole = text[: text.rfind("\n") + 1]
    if whole != text:
        path.write_text(whole, encoding="utf-8")
    return [json.loads(line) for line in whole.splitlines()]


def _key(run: Run) -> tuple[Any, ...]:
    return tuple(run.get(name) for name in ("map", "lod", "build", "peer", "turn"))


def _measured(wanted: Wanted, known: set[tuple[Any, ...]], say: Say) -> Iterator[dict[str, Any]]:
    """Yield the measurements that are missing, map by map."""
    for path in wanted.maps:
        for lod in wanted.lods:
            keys = [
                {"map": path.name, "lod": lod, "build": build, "turn": turn}
                for turn in range(wanted.repeat) for build in BUILDS if build in wanted.builds
            ]  # fmt: skip
            asked = [key for key in keys if _key(key) not in known]
            told = {**keys[0], "build": None}
            others = [peer for peer in wanted.peers if lod == wanted.lods[0]
                      and _key({**told, "peer": peer.name}) not in known]  # fmt: skip
            if asked or others:
                yield from _of_one_map(wanted, path, asked, others, say)


def _of_one_map(
    wanted: Wanted, path: Path, asked: Sequence[Run], peers: Sequence[Peer], say: Say
) -> Iterator[dict[str, Any]]:
    """Yield builds of a map with one cache, filled by a first build where none is asked cold."""
    with tempfile.TemporaryDirectory() as folder:
        city, cache = Path(folder) / "city", Path(folder) / "cache"
        lod = asked[0]["lod"] if asked else wanted.lods[0]
        for key in asked:
            if key["build"] == COLD:
                shutil.rmtree(cache, ignore_errors=True)
            elif not cache.exists():
                build_once(path, key["lod"], city, cache, longest=wanted.longest)
            shutil.rmtree(city, ignore_errors=True)
            found = build_once(
                path, key["lod"], city, cache, pictures=key["build"] == PICTURED,
                workers=wanted.workers, longest=wanted.longest,
            )  # fmt: skip
            say(f"{path.name} at level {key['lod']}, {key['build']}: {found['cpu_s']:.1f} CPU s "
                f"{found.get('error', '')}")  # fmt: skip
            yield {**key, **found}
            if "error" in found:
                return  # the others would take as long
        for peer in peers:
            if not city.exists():
                build_once(path, lod, city, cache, longest=wanted.longest)
            content = (city / peer.reads).read_bytes() if peer.reads else content_of(path)
            told: dict[str, Any] = {"map": path.name, "lod": lod, "peer": peer.name, "turn": 0}
            try:
                told["cpu_s"] = peer_once(peer, content)
            except EngineError as error:
                told["error"] = str(error)
            say(f"{path.name}: {peer.name} {told.get('cpu_s', told.get('error'))}")
            yield told


# --- tables ---------------------------------------------------------------------------------------


def phases_of(run: Run, *, of: str = "phases", whole: str = "cpu_s") -> dict[str, float]:
    """Return the seconds of a build by what they belong to; with all of it they add up."""
    spent = dict.fromkeys((*PHASES, OTHER), 0.0)
    for step, taken in run[of].items():
        spent[_phase_of(step)] += taken
    return {**spent, REST: run[whole] - sum(spent.values())}


def _phase_of(step: str) -> str:
    for phase, begins in PHASES.items():
        if step.startswith(begins):
            return phase
    return OTHER


def text_of(record: Mapping[str, Any]) -> str:
    """Return what was measured as tables in Markdown, with what was skipped and why."""
    runs = record["runs"]
    parts = [table_of(rows(runs)) for rows in (_builds, _phases, _actions, _pictures, _beside)
             if rows(runs)]  # fmt: skip
    parts += filter(None, [_empty_ground(runs)])
    parts += [f"{run['map']} at level {run['lod']}, {run['build']}: {run['error']}."
              for run in runs if "build" in run and "error" in run]  # fmt: skip
    parts += [f"Not run: {name}, since {reason}." for name, reason in record["skipped"].items()]
    codes = ", ".join(dict.fromkeys(run["code"] for run in runs))
    return "\n\n".join([*parts, f"Measured of the state {codes} of CityX."])


def _of(runs: Iterable[Run], build: str) -> dict[tuple[str, int], list[Run]]:
    """Return the builds of a kind that ended, by map and level of detail."""
    found: dict[tuple[str, int], list[Run]] = {}
    for run in runs:
        if run.get("build") == build and "error" not in run:
            found.setdefault((run["map"], run["lod"]), []).append(run)
    return found


def _median(values: Iterable[float]) -> float:
    return statistics.median(values)


def _builds(runs: Iterable[Run]) -> list[dict[str, Any]]:
    """Return the rows of whole builds."""
    runs = list(runs)
    cold = _of(runs, COLD)
    rows = []
    for (name, lod), own in _of(runs, WARM).items():
        cpu, run = _median(one["cpu_s"] for one in own), own[-1]
        first = [one["cpu_s"] for one in cold.get((name, lod), ())]
        rows.append({
            "map": name.partition(".")[0],
            "kind": MAPS.get(name, "made" if name in MADE else ""),
            "LOD": lod,
            "buildings": f"{run['buildings']:,.0f}",
            "km2": f"{run['km2']:.2f}",
            "built": f"{run['built_km2']:.2f}",
            "CPU s": f"{cpu:.1f}",
            "cold": f"{_median(first):.1f}" if first else "",
            "clock s": f"{_median(one['clock_s'] for one in own):.1f}",
            "peak MB": f"{max(one['peak_mb'] for one in own):.0f}",
            "ms/building": _per(1000 * cpu, run["buildings"]),
            "s/km2 built": _per(cpu, run["built_km2"]),
            "M triangles": f"{run['written'] / 1e6:.2f}",
            "s/M": _per(cpu, run["written"] / 1e6),
            "GLB MB": f"{run['glb_mb']:.0f}",
        })  # fmt: skip
    return rows


def _per(amount: float, of: float) -> str:
    """Return a share with three digits that count, or nothing of nothing."""
    return f"{amount / of:.3g}" if of else ""


def _phases(runs: Iterable[Run]) -> list[dict[str, Any]]:
    """Return the rows of the phases of builds, CPU seconds."""
    rows: list[dict[str, Any]] = []
    for (name, lod), own in _of(runs, WARM).items():
        each = [phases_of(run) for run in own]
        row = {phase: f"{_median(one[phase] for one in each):.2f}" for phase in each[0]}
        rows.append({"map": name.partition(".")[0], "LOD": lod, **row})
    used = [key for key in rows[0] if key not in PHASES or any(float(row[key]) for row in rows)
            ] if rows else []  # fmt: skip
    return [{key: row[key] for key in used} for row in rows]


def _actions(runs: Iterable[Run]) -> list[dict[str, Any]]:
    """Return the rows of the steps that take most of all maps together, and where each does."""
    spent: dict[str, dict[str, float]] = {}
    whole = 0.0
    for (name, _), own in _of(runs, WARM).items():
        whole += _median(run["cpu_s"] for run in own)
        for step in own[-1]["phases"]:
            of_step = spent.setdefault(step, {})
            taken = _median(run["phases"].get(step, 0.0) for run in own)
            of_step[name] = of_step.get(name, 0.0) + taken
    most = sorted(spent, key=lambda step: -sum(spent[step].values()))[:ACTIONS]
    return [
        {
            "step": step,
            "CPU s": f"{sum(spent[step].values()):.1f}",
            "share": f"{sum(spent[step].values()) / whole:.1%}",
            "most": max(spent[step], key=lambda name: spent[step][name]).partition(".")[0],
            "CPU s there": f"{max(spent[step].values()):.1f}",
        }
        for step in most
    ]


def _pictures(runs: Iterable[Run]) -> list[dict[str, Any]]:
    """Return the rows of pictures."""
    rows = []
    for (name, lod), own in _of(runs, PICTURED).items():
        for picture in own[-1]["pictures"]:
            steps = [f"blender light {picture}", f"blender render {picture}"]
            took = {
                of: _median(sum(run[of].get(step, 0.0) for step in steps) for run in own)
                for of in ("clock", "phases")
            }
            rows.append({
                "map": name.partition(".")[0], "LOD": lod, "picture": picture,
                "clock s": f"{took['clock']:.1f}", "CPU s": f"{took['phases']:.1f}",
            })  # fmt: skip
    return rows


def _beside(runs: Iterable[Run]) -> list[dict[str, Any]]:
    """Return the rows of what peers take beside the steps of ours that come as far."""
    runs = list(runs)
    warm = _of(runs, WARM)
    rows = []
    for run in runs:
        peer, own = PEERS.get(run.get("peer", "")), warm.get((run["map"], run["lod"]))
        if peer is None or not own:
            continue
        ours = _median(sum(one["phases"].get(step, 0.0) for step in peer.steps) for one in own)
        theirs = run.get("cpu_s")
        rows.append({
            "map": run["map"].partition(".")[0],
            "peer": peer.name,
            "makes": peer.makes,
            "our steps": ", ".join(peer.steps),
            "peer s": run["error"] if theirs is None else f"{theirs:.2f}",
            "ours s": f"{ours:.2f}",
            "ours / peer": "" if theirs is None else _per(ours, theirs),
        })  # fmt: skip
    return rows


def _empty_ground(runs: Iterable[Run]) -> str:
    """Say what 100 km2 of empty ground take: a village within them less the village alone."""
    warm = _of(runs, WARM)
    told = []
    for name, lod in warm:
        alone, spread = warm.get((MADE[0], lod)), warm.get((MADE[1], lod))
        if name == MADE[1] and alone and spread:
            more = _median(run["cpu_s"] for run in spread) - _median(run["cpu_s"] for run in alone)
            km2 = spread[-1]["km2"] - alone[-1]["km2"]
            told.append(f"{100 * more / km2:.1f} CPU s at level {lod}")
    return f"100 km2 of empty ground (fields, woods, tracks): {', '.join(told)}." if told else ""


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
    if BEGIN not in old or FINISH not in old:
        raise InputError(f"{page} has no place for the table: {BEGIN} and {FINISH}.")
    before, rest = old.split(BEGIN, 1)
    with replaced(page) as temporary:
        temporary.write_text(
            f"{before}{BEGIN}\n{text}\n{FINISH}{rest.split(FINISH, 1)[1]}", encoding="utf-8"
        )
