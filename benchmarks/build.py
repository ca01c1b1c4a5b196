"""Build a list of maps and write a table: seconds per stage, memory, triangles, per km2.

    python benchmarks/build.py [MAP...] [--lod 0 --lod 2] [--repeat 3] [--write docs/performance.md]

Without maps the five of ``MAPS`` are built from ``../shared/data/osm`` when it is there, else the
extract of Helsinki. Every build is a process of its own, without pictures; figures are CPU seconds
(user and system, workers included, imports apart), the median of the repeats.
"""

from __future__ import annotations

import argparse
import gzip
import json
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Iterable
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "examples" / "helsinki"))

MAPS = (
    "london_soho.osm.gz",
    "tokyo_ichigaya.osm.gz",
    "tokyo_kanda.osm.gz",
    "krems.osm.gz",
    "liechtenstein_2013.osm.bz2",
    "liechtenstein_latest.osm.gz",
)
PARSE = "layout/inputs"  # step that reads the map
BEGIN, END = "<!-- begin: benchmarks/build.py -->", "<!-- end: benchmarks/build.py -->"


def uncompressed_mb(path: Path) -> float:
    """Size of the file's content in MB, unpacked when it is gzip or bzip2."""
    if path.suffix == ".gz":
        with gzip.open(path) as file:
            return sum(len(block) for block in iter(lambda: file.read(1 << 20), b"")) / 1e6
    if path.suffix == ".bz2":
        import bz2

        with bz2.open(path) as file:
            return sum(len(block) for block in iter(lambda: file.read(1 << 20), b"")) / 1e6
    return path.stat().st_size / 1e6


def build_once(path: Path, lod: int, workers: int) -> dict[str, Any]:
    """Build one map in a fresh process and return its report."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "city"
        command = [
            sys.executable, "-m", "cityx.cli", "build", str(path), "-o", str(out),
            "--no-render", "--formats", "blend", "--lod", str(lod), "--workers", str(workers),
        ]  # fmt: skip
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode not in (0, 1):
            raise SystemExit(f"{path.name}: exit {done.returncode}\n{done.stderr}")
        report: dict[str, Any] = json.loads((out / "report.json").read_text())
        report["blend_mb"] = (out / "city.blend").stat().st_size / 1e6
        return report


def row_of(path: Path, lod: int, reports: list[dict[str, Any]]) -> dict[str, Any]:
    """Fold the repeats of one build into a row of medians."""

    def median(*steps: str) -> float:
        return statistics.median(
            sum(report["cpu_s"].get(step, 0.0) for step in steps) for report in reports
        )

    report = reports[0]
    other = ("import", PARSE, "store", "glb", "check", "blender")
    actions = [step for step in report["cpu_s"] if not step.startswith(other)]
    buildings = max(report["counts"]["buildings"], 1)
    parse, generate = median(PARSE), median(*actions)
    mesh, save = median("store", "blender read", "blender setup"), median("blender save")
    total = parse + generate + mesh + save
    size = uncompressed_mb(path)
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


def table_of(rows: Iterable[dict[str, Any]]) -> str:
    """Write rows as a Markdown table."""
    rows = list(rows)
    head = list(rows[0])
    lines = ["| " + " | ".join(head) + " |", "|" + " --- |" * len(head)]
    lines += ["| " + " | ".join(str(row[key]) for key in head) + " |" for row in rows]
    return "\n".join(lines)


def write_into(page: Path, text: str) -> None:
    """Replace what stands between the marks of a page."""
    old = page.read_text()
    before, rest = old.split(BEGIN, 1)
    page.write_text(f"{before}{BEGIN}\n{text}\n{END}{rest.split(END, 1)[1]}")


def main() -> None:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("maps", nargs="*", type=Path)
    parser.add_argument("--lod", type=int, action="append")
    parser.add_argument("--repeat", type=int, default=1)
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--write", type=Path)
    args = parser.parse_args()
    maps = args.maps or default_maps()
    rows = []
    for lod in args.lod or [0, 2, 3]:
        for path in maps:
            reports = [build_once(path, lod, args.workers) for _ in range(args.repeat)]
            rows.append(row_of(path, lod, reports))
            print(rows[-1], flush=True)
    text = table_of(rows)
    print(text)
    if args.write:
        write_into(args.write, text)


def default_maps() -> list[Path]:
    """Return the maps of ``MAPS``, or Helsinki where there is no shared data."""
    folder = ROOT / ".." / "shared" / "data" / "osm"
    if folder.is_dir():
        return [folder / name for name in MAPS]
    from main import helsinki

    return [helsinki()]


if __name__ == "__main__":
    main()
