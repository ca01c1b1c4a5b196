"""What makes a city right, measured on built cities: a table and a plot."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from html import escape
from math import isnan, nan
from pathlib import Path
from statistics import median
from types import MappingProxyType
from typing import Any

from cityx.city import City
from cityx.errors import InputError
from cityx.system.atomic import replaced
from cityx.system.digests import file_sha256

REACH = 100.0  # metres within which a house that looks the same is a repetition
SIDE = 260  # metres of a town of ours
STYLES = ("modern", "european", "japanese", "victorian", "mediterranean", "haussmann", "american",
          "chinese", "art deco", "futuristic")  # fmt: skip


@dataclass(frozen=True)
class Measure:
    """One column: what it is, its best value, and the bound that a city should keep.

    Attributes
    ----------
    name
        Column.
    meaning
        In a sentence.
    bound
        Least value, or largest where less is better.
    more
        Whether more is better.
    """

    name: str
    meaning: str
    bound: float
    more: bool

    def kept(self, value: float) -> bool:
        """Whether a value keeps the bound; NaN never does."""
        return value >= self.bound if self.more else value <= self.bound


MEASURES = (
    Measure("overlap", "pairs of buildings that overlap, per building", 0.0, more=False),
    Measure("repetition", f"houses that look like one within {REACH:.0f} m", 0.05, more=False),
    Measure("closed", "buildings whose solids are all closed", 1.0, more=True),
    Measure("connected", "lanes from which and to which a way leads", 0.75, more=True),
    Measure("doors", "houses at a sidewalk that can be entered from it", 0.98, more=True),
    Measure("fidelity", "mean IoU of buildings and streets with the map", 0.82, more=True),
    Measure("style", "buildings in the style that was asked for", 0.7, more=True),
)

NAMES = tuple(measure.name for measure in MEASURES)
Rows = Mapping[str, Mapping[str, float]]  # city to its measures, NaN where nothing is to measure


def build_towns(folder: Path, count: int, say: Callable[[str], None]) -> list[Path]:
    """Build towns of every style by sentences, those that are not there already."""
    from cityx.options import BuildOptions
    from cityx.projects.build import build

    found = []
    for number in range(count):
        style = STYLES[number % len(STYLES)]
        target = folder / f"{style.replace(' ', '_')}_{number:02d}"
        found.append(target)
        if (target / "report.json").exists():
            continue
        say(f"building {target.name}")
        text = f"A {style} town of {SIDE} m by {SIDE} m."
        build([], target, BuildOptions(text=text, seed=number, formats=(), render=False))
    return found


def quality_of(folder: Path, inputs: Iterable[Path] = ()) -> dict[str, float]:
    """Measure a built city.

    Parameters
    ----------
    folder
        Of the city.
    inputs
        Files among which is the map that it was built of; without any, fidelity is not measured.

    Returns
    -------
    values
        Name of a measure to its value; NaN where there is nothing to measure.

    Raises
    ------
    InputError
        When the folder holds no city with a report, or the inputs not the file it was built of.
    """
    from cityx.city.store import read_city

    try:
        report = json.loads((folder / "report.json").read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise InputError(f"{folder} holds no built city: {error}.") from error
    return measured(read_city(folder / "city"), report, inputs)


def measured(city: City, report: Mapping[str, Any], inputs: Iterable[Path]) -> dict[str, float]:
    """Measure a city by its report; arguments and result as of `quality_of`."""
    from cityx.checks.facade_checks import repeated_share
    from cityx.city.scene import no_instances

    checks = {name: float(one["value"]) for name, one in report["checks"].items()}
    windows = city.scene.instances.get("windows", no_instances())
    count = max(len(city.layout.buildings), 1)
    built = "buildings" in city.scene.meshes
    return {
        "overlap": checks.get("building_overlap", nan) / count,
        "repetition": repeated_share(city, windows, REACH) if built else nan,
        "closed": checks.get("closed_solids", nan),
        "connected": 1 - checks.get("lanes_stranded", nan),
        "doors": 1 - checks.get("street_doors_missing", nan),
        "fidelity": _fidelity(city, report["inputs"], {path.name: path for path in inputs}),
        "style": _style(city, report["brief"]),
    }


def _fidelity(city: City, inputs: list[Mapping[str, Any]], files: Mapping[str, Path]) -> float:
    """Return how well buildings and streets cover those of the map, NaN without one."""
    from cityx.checks.predicates.facts import Facts
    from cityx.checks.predicates.rasters import overlap_of_layers

    own = [one for one in inputs if one["kind"] in ("osm", "semantic")]
    if not files or not own:
        return nan
    path = files.get(own[0]["name"])
    if path is None:
        raise InputError(f"{own[0]['name']}, of which the city was built, is not among the maps.")
    if file_sha256(path) != own[0]["sha256"]:
        raise InputError(f"{path} is not the file that the city was built of: its hash differs.")
    facts = Facts(city)
    return sum(overlap_of_layers(facts, layer, path)[0] for layer in ("building", "road")) / 2


def _style(city: City, brief: Mapping[str, Any]) -> float:
    """Return the share of buildings in the style of the brief, NaN where none is asked for."""
    from cityx.checks.predicates import measure

    words = [one["value"] for one in brief.get("slots", ()) if one["key"] == "style"]
    if not words:
        return nan
    found = measure(f"share(building, style={words[0]}) >= 0", city)
    return float(found.value) if isinstance(found.value, float | int) else nan


def table_of(rows: Rows) -> str:
    """Return the table in Markdown: cities, their median, and how many keep each bound."""
    lines = [*_head("city"), *(_line(name, [_cell(row[n]) for n in NAMES])
                               for name, row in rows.items())]  # fmt: skip
    lines.append(_line("median", [_cell(_median(rows, name)) for name in NAMES]))
    kept = zip(_kept(rows), MEASURES, strict=True)
    lines.append(_line("keep the bound", [f"{count} ({_bound(one)})" for count, one in kept]))
    return "\n".join(lines)


def summary_of(groups: Mapping[str, Rows]) -> str:
    """Return the table in Markdown of kinds of cities: medians, and how many keep each bound."""
    lines = _head("cities")
    for kind, rows in groups.items():
        kept = zip(NAMES, _kept(rows), strict=True)
        cells = [f"{_cell(_median(rows, name))}, {count}" for name, count in kept]
        lines.append(_line(f"{kind} ({len(rows)})", cells))
    lines.append(_line("bound", [_bound(one) for one in MEASURES]))
    return "\n".join(lines)


def _head(first: str) -> list[str]:
    return [_line(first, NAMES), "| --- " * (len(NAMES) + 1) + "|"]


def _line(first: str, cells: Iterable[str]) -> str:
    return f"| {first} | {' | '.join(cells)} |"


def _bound(measure: Measure) -> str:
    return f"{'>=' if measure.more else '<='} {measure.bound:g}"


def _kept(rows: Rows) -> Iterator[str]:
    """Yield for every measure how many of the cities keep its bound, of those that it measures."""
    for one in MEASURES:
        values = [row[one.name] for row in rows.values() if not isnan(row[one.name])]
        yield f"{sum(map(one.kept, values))}/{len(values)}"


def _cell(value: float) -> str:
    return "-" if isnan(value) else f"{value:.3f}"


def _median(rows: Rows, name: str) -> float:
    values = [row[name] for row in rows.values() if not isnan(row[name])]
    return median(values) if values else nan


def write_quality(rows: Rows, command: str, out: Path) -> None:
    """Write quality.json, quality.md and quality.svg into a folder."""
    record = {
        "command": command,
        "measures": {one.name: one.meaning for one in MEASURES},
        "cities": {name: {k: None if isnan(v) else v for k, v in row.items()}
                   for name, row in rows.items()},
    }  # fmt: skip
    meanings = "\n".join(f"- {one.name}: {one.meaning}" for one in MEASURES)
    texts = MappingProxyType({
        "quality.json": json.dumps(record, indent=1),
        "quality.md": f"# Quality\n\n`{command}`\n\n{table_of(rows)}\n\n{meanings}\n",
        "quality.svg": plot_of(rows),
    })  # fmt: skip
    for name, text in texts.items():
        with replaced(out / name) as temporary:
            temporary.write_text(text, encoding="utf-8")


# --- plot -----------------------------------------------------------------------------------------
_WIDTH, _LEFT, _ROW, _TOP = 720, 110, 34, 20  # pixels


def plot_of(rows: Rows) -> str:
    """Return a strip plot as SVG: a row per measure, a dot per city, a line where the bound is."""
    height = _TOP + _ROW * len(MEASURES) + 30
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{_WIDTH}" height="{height}" '
        f'viewBox="0 0 {_WIDTH} {height}" font-family="sans-serif" font-size="13">',
        f'<rect width="{_WIDTH}" height="{height}" fill="#ffffff"/>',
    ]
    for share in (0.0, 0.25, 0.5, 0.75, 1.0):
        x = _x(share)
        parts.append(f'<line x1="{x}" x2="{x}" y1="{_TOP}" y2="{height - 26}" stroke="#e0e4e8"/>')
        parts.append(f'<text x="{x}" y="{height - 8}" text-anchor="middle">{share:g}</text>')
    for k, measure in enumerate(MEASURES):
        parts += _strip(measure, _TOP + _ROW * (k + 0.5), rows)
    return "\n".join([*parts, "</svg>", ""])


def _x(share: float) -> float:
    return round(_LEFT + min(max(share, 0.0), 1.0) * (_WIDTH - _LEFT - 24), 1)


def _strip(measure: Measure, y: float, rows: Rows) -> Iterator[str]:
    bound = _x(measure.bound)
    yield f'<text x="{_LEFT - 12}" y="{y + 4:g}" text-anchor="end">{measure.name}</text>'
    yield f'<line x1="{bound}" x2="{bound}" y1="{y - 12:g}" y2="{y + 12:g}" stroke="#b3261e"/>'
    for name, row in rows.items():
        value = row[measure.name]
        if isnan(value):
            continue
        color = "#1f5fa8" if measure.kept(value) else "#b3261e"
        title = f"<title>{escape(name)}: {value:.3f}</title>"
        yield (f'<circle cx="{_x(value)}" cy="{y:g}" r="5" fill="{color}" fill-opacity="0.55">'
               f"{title}</circle>")  # fmt: skip
