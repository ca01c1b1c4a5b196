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
import shutil
import struct
import sys
import tempfile
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
from cityx_bench.peers import Peer, peer_once
from cityx_bench.scenes import Box, Thing, street
from cityx_bench.watched import run_watched

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
NO_BYTECODE = "PYTHONDONTWRITEBYTECODE"
LOG, RECORD = "runs.jsonl", "speed.json"
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
