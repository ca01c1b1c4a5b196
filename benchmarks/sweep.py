"""Build every map of folders and list the checks that fail, and what is kept of what they state.

    python benchmarks/sweep.py [MAP or FOLDER...] [--lod 2] [--out sweep] [--again] [--keep]

Without a map, those of ``osm``, ``osm_more`` and ``faults`` of ``../shared/data``. One line per
map: CPU seconds, counts, the share of stated facts that are kept, and every failed check with its
value and limit; at the end a table of what is kept of each tag. Each build is a process of its
own, small files first, without pictures; huge maps are built by a window, or ``--whole``.
Results are kept in ``--out``, a JSON file per map: a sweep that was stopped goes on where it was,
and ``--again`` builds all anew. Exits 1 if a check of any map fails, 3 if one ends without report.
"""

from __future__ import annotations

import argparse
import json
import resource
import shutil
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

from cityx.checks.fidelity import UNEXPLAINED
from cityx.checks.tag_measures import VERDICTS
from cityx.sources.input_kinds import OSM_SUFFIXES

ROOT = Path(__file__).resolve().parents[1]
MAPS = tuple(ROOT.parent / "shared" / "data" / name for name in ("osm", "osm_more", "faults"))
EDGE = 800  # metres, of the windows
# Maps too large to build whole: the middle of their window (latitude, longitude).
WINDOWS = {
    "andorra.osm.gz": (42.5075, 1.5218),
    "liechtenstein_latest.osm.gz": (47.1392, 9.5220),
    "porto_alegre_roads_only.osm.gz": (-30.0310, -51.2280),
}
COUNTS = ("buildings", "buildings_failed", "road_km", "junctions", "trees")
NO_REPORT = 3


def sweep_one(path: Path, out: Path, args: argparse.Namespace) -> dict[str, Any]:
    """Build one map and return what is kept of its report."""
    command = [
        sys.executable, "-m", "cityx.cli", "build", str(path), "-o", str(out), "--no-render",
        "--formats", "", "--lod", str(args.lod), "--workers", "1",
    ]  # fmt: skip
    if path.name in WINDOWS and not args.whole:
        at = ",".join(map(str, WINDOWS[path.name]))
        command += [f"--at={at}", "--size", f"{EDGE}x{EDGE}"]
    before, begun = _cpu_of_children(), time.monotonic()
    try:
        done = subprocess.run(
            command, capture_output=True, text=True, check=False, timeout=args.limit
        )
        code, told = done.returncode, done.stderr[-2000:]
    except subprocess.TimeoutExpired:
        code, told = NO_REPORT, f"not built within {args.limit:g} s"
    found: dict[str, Any] = {
        "map": path.name,
        "lod": args.lod,
        "exit": code,
        "cpu_s": round(_cpu_of_children() - before, 1),
        "wall_s": round(time.monotonic() - begun, 1),
        "failed": {},
    }
    if code not in (0, 1):
        return found | {"error": told}
    report = json.loads((out / "report.json").read_text())
    return found | {
        "area_km2": report["area_km2"],
        "peak_mb": report["peak_rss_mb"],
        "counts": {name: report["counts"][name] for name in COUNTS},
        "steps_s": report["cpu_s"],
        "failed": {name: check for name, check in report["checks"].items() if not check["ok"]},
        "goals_missed": [goal["goal"] for goal in report["goals"] if goal["met"] is False],
        "failures": report["failures"],
        "fidelity": report["fidelity"],
        "notes": report["notes"],
    }


def _cpu_of_children() -> float:
    spent = resource.getrusage(resource.RUSAGE_CHILDREN)
    return spent.ru_utime + spent.ru_stime


def line_of(found: dict[str, Any]) -> str:
    """Return the result of one map as one line, and one more for each check that fails."""
    head = f"{found['map']:36} exit {found['exit']}  {found['cpu_s']:6.1f} s CPU"
    if "error" in found:
        return f"{head}  {found['error'].strip()}"
    counts = "  ".join(f"{name} {value:,}" for name, value in found["counts"].items())
    lines = [f"{head}  {found['area_km2']:.2f} km2  {counts}"]
    lines += [
        f"    {100 * told['share']:.1f} % of {told['stated']} stated facts kept"
        for told in found["fidelity"] if told["share"] is not None
    ]  # fmt: skip
    for name, check in found["failed"].items():
        where = f"  {', '.join(check['ids'][:3])}" if "ids" in check else ""
        lines.append(
            f"    {name}: {check['value']:g}, {check['bound']} {check['limit']:g}"
            f" ({check['meaning']}){where}"
        )
    lines += [f"    goal missed: {goal}" for goal in found["goals_missed"]]
    return "\n".join(lines)


def table_of(results: list[dict[str, Any]]) -> str:
    """Return what is kept of each tag over all maps, as a table of Markdown."""
    names = (*VERDICTS, UNEXPLAINED)
    rows: dict[str, list[int]] = {}
    for found in results:
        for told in found.get("fidelity", ()):
            for tag, row in told["tags"].items():
                counts = [row[name] for name in names]
                before = rows.get(tag, [0] * len(names))
                rows[tag] = [a + b for a, b in zip(before, counts, strict=True)]
    total = [sum(column) for column in zip(*rows.values(), strict=True)] or [0] * len(names)
    lines = ["", f"| tag | {' | '.join(names)} |", f"| --- |{' --- |' * len(names)}"]
    lines += [f"| {tag} | {' | '.join(map(str, rows[tag]))} |" for tag in sorted(rows)]
    return "\n".join([*lines, f"| all | {' | '.join(map(str, total))} |"])


def _maps_of(paths: list[Path]) -> list[Path]:
    """Return the maps among files and in folders."""
    found = []
    for path in paths:
        inside = path.iterdir() if path.is_dir() else [path]
        found += [one for one in inside if one.name.lower().endswith(OSM_SUFFIXES)]
    return found


def main() -> int:
    """Sweep the maps; return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("maps", nargs="*", type=Path)
    parser.add_argument("--lod", type=int, default=2)
    parser.add_argument("--out", type=Path, default=Path("sweep"), help="folder of the results")
    parser.add_argument("--again", action="store_true", help="build what has a result, too")
    parser.add_argument("--keep", action="store_true", help="keep the cities beside the results")
    parser.add_argument("--whole", action="store_true", help="build huge maps whole")
    parser.add_argument("--limit", type=float, default=1800.0, help="seconds for one map")
    args = parser.parse_args()
    maps = _maps_of(args.maps or [folder for folder in MAPS if folder.is_dir()])
    if not maps:
        raise SystemExit(f"{MAPS[0]} is absent; name the maps to build.")
    args.out.mkdir(parents=True, exist_ok=True)
    worst, results = 0, []
    for path in sorted(maps, key=lambda path: (path.stat().st_size, path.name)):
        kept = args.out / f"{path.name}.lod{args.lod}.json"
        if args.again or not kept.is_file():
            city = args.out / f"{path.name}.lod{args.lod}"
            shutil.rmtree(city, ignore_errors=True)
            found = sweep_one(path, city, args)
            if not args.keep:
                shutil.rmtree(city, ignore_errors=True)
            kept.with_suffix(".part").write_text(json.dumps(found, indent=1))
            kept.with_suffix(".part").replace(kept)
        found = json.loads(kept.read_text())
        print(line_of(found), flush=True)
        results.append(found)
        worst = max(worst, NO_REPORT if "error" in found else found["exit"])
    print(table_of(results))
    return worst


if __name__ == "__main__":
    sys.exit(main())
