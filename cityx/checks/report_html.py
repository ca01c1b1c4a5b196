"""The report as one web page: no script, no font, nothing fetched."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from html import escape
from math import isfinite
from pathlib import PurePath
from typing import Any
from urllib.parse import quote

MOST_FAILURES = 200  # rows of the table; more are counted
_STYLE = """
:root { color-scheme: light dark; --ink: #1b1f24; --soft: #57606a; --paper: #ffffff;
  --card: #f6f8fa; --line: #d0d7de; --good: #116329; --bad: #b3261e; --bar: #4a7fb5; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #e6edf3; --soft: #9ea7b3; --paper: #0d1117; --card: #161b22; --line: #30363d;
    --good: #56d364; --bad: #ff7b72; --bar: #6ea8dc; } }
* { box-sizing: border-box; }
body { margin: 0 auto; padding: 1.5rem; max-width: 72rem; background: var(--paper);
  color: var(--ink); font: 1rem/1.5 system-ui, -apple-system, "Segoe UI", sans-serif; }
h1 { margin: 0; font-size: 1.9rem; line-height: 1.2; }
h2 { margin: 2.2rem 0 .6rem; font-size: 1.2rem; }
p { margin: .3rem 0; } code { font: .9em ui-monospace, "Cascadia Mono", Consolas, monospace;
  overflow-wrap: anywhere; }
.soft { color: var(--soft); } .good { color: var(--good); } .bad { color: var(--bad); }
.verdict { margin: 1rem 0; padding: .7rem 1rem; border-left: .35rem solid currentColor;
  background: var(--card); font-weight: 600; }
.pictures { display: grid; gap: .8rem; margin: 1.2rem 0;
  grid-template-columns: repeat(auto-fit, minmax(min(22rem, 100%), 1fr)); }
figure { margin: 0; } figure:first-child { grid-column: 1 / -1; }
img { display: block; width: 100%; height: auto; border-radius: .3rem; background: var(--card); }
figcaption { color: var(--soft); font-size: .85rem; }
.tiles { display: grid; gap: .6rem; margin: 0;
  grid-template-columns: repeat(auto-fit, minmax(9.5rem, 1fr)); }
.tiles div { padding: .6rem .8rem; background: var(--card); border-radius: .3rem; }
.tiles dt { color: var(--soft); font-size: .85rem; }
.tiles dd { margin: 0; font-size: 1.25rem; font-variant-numeric: tabular-nums; }
.wide { overflow-x: auto; }
table { width: 100%; border-collapse: collapse; font-size: .95rem; }
th, td { padding: .35rem .7rem .35rem 0; border-bottom: 1px solid var(--line); text-align: left;
  vertical-align: top; }
th { color: var(--soft); font-weight: 600; } tbody th { color: inherit; font-weight: 500; }
.number { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
.bar { width: 45%; min-width: 6rem; vertical-align: middle; }
.bar span { display: block; height: .7rem; min-width: 1px; background: var(--bar);
  border-radius: .15rem; }
li { margin: .2rem 0; }
@media print { body { max-width: none; padding: 0; } figure { break-inside: avoid; } }
"""


def report_html(report: Mapping[str, Any], pictures: Sequence[str | os.PathLike[str]] = ()) -> str:
    """Return the report as one HTML page.

    Parameters
    ----------
    report
        As of `cityx.checks.report.make_report`; parts that are missing are left out.
    pictures
        Images to show, the first one large; paths relative to the page.
    """
    name = _text(report.get("name") or "City")
    parts = [
        _heading(report, name),
        _verdict(report),
        _pictures(pictures),
        _attribution(report.get("attribution") or ()),
        _goals(report.get("goals") or ()),
        _counts(report),
        _checks(report.get("checks") or {}),
        _timings(report.get("timings_s") or {}),
        _failures(report.get("failures") or ()),
        _list("Notes", report.get("notes") or ()),
        _origin(report),
    ]
    body = "\n".join(part for part in parts if part)
    return (
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{name} – CityX report</title>\n<style>{_STYLE}</style>\n</head>\n"
        f"<body>\n<main>\n{body}\n</main>\n</body>\n</html>\n"
    )


def _text(value: Any) -> str:
    return escape(str(value), quote=True)


def _number(value: Any) -> str:
    """Show a number with up to four figures and grouped thousands; other values as they are."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return _text(value)
    if isinstance(value, int) or (isfinite(value) and value == int(value) and abs(value) < 1e15):
        return f"{int(value):,}".replace(",", "\u202f")
    if not isfinite(value):
        return _text(value)
    return f"{value:,.2f}".replace(",", "\u202f") if abs(value) >= 100 else f"{value:.4g}"


def _words(name: str) -> str:
    return _text(name.replace("_", " "))


def _section(title: str, content: str) -> str:
    return f"<section>\n<h2>{_text(title)}</h2>\n{content}\n</section>"


def _table(head: Sequence[tuple[str, bool]], rows: Iterable[Sequence[str]]) -> str:
    """Lay out rows of ready HTML; a true flag marks a column of numbers, the first names rows."""
    kinds = [' class="number"' if number else "" for _, number in head]
    top = "".join(
        f'<th scope="col"{kind}>{_text(title)}</th>'
        for (title, _), kind in zip(head, kinds, strict=True)
    )
    lines = []
    for first, *rest in rows:
        cells = "".join(
            f"<td{kind}>{cell}</td>" for cell, kind in zip(rest, kinds[1:], strict=True)
        )
        lines.append(f'<tr><th scope="row">{first}</th>{cells}</tr>')
    body = "\n".join(lines)
    return (
        f'<div class="wide"><table>\n<thead><tr>{top}</tr></thead>\n'
        f"<tbody>\n{body}\n</tbody></table></div>"
    )


def _mark(ok: Any) -> str:
    if ok is None:
        return '<span class="soft">? cannot tell</span>'
    return '<span class="good">✓ yes</span>' if ok else '<span class="bad">✗ no</span>'


def _heading(report: Mapping[str, Any], name: str) -> str:
    facts = []
    if "area_km2" in report:
        facts.append(f"{_number(report['area_km2'])} km²")
    frame = report.get("frame") or {}
    if "latitude" in frame and "longitude" in frame:
        facts.append(f"{frame['latitude']:.5f}, {frame['longitude']:.5f}")
    if "seed" in report:
        facts.append(f"seed {_text(report['seed'])}")
    facts.append(f"CityX {_text(report.get('cityx', ''))}".strip())
    return f'<header>\n<h1>{name}</h1>\n<p class="soft">{" · ".join(facts)}</p>\n</header>'


def _verdict(report: Mapping[str, Any]) -> str:
    checks = list((report.get("checks") or {}).values())
    goals = list(report.get("goals") or ())
    failed = sum(not check.get("ok") for check in checks)
    met_goals = sum(bool(goal.get("met")) for goal in goals)
    missed = any(goal.get("met") is False and goal.get("hard", True) for goal in goals)
    unknown = sum(goal.get("met") is None for goal in goals)
    if not checks and not goals:
        return ""
    held = f"{len(checks) - failed} of {len(checks)} checks hold"
    met = f"{met_goals} of {len(goals)} goals are met"
    met += f", {unknown} cannot be told" if unknown else ""
    good = not failed and not missed
    return (
        f'<p class="verdict {"good" if good else "bad"}">{"✓" if good else "✗"} {held}, {met}.</p>'
    )


def _pictures(pictures: Sequence[str | os.PathLike[str]]) -> str:
    figures = []
    for picture in pictures:
        path = PurePath(picture)
        address = quote(path.as_posix())
        caption = _words(path.stem)
        figures.append(
            f'<figure><img src="{_text(address)}" alt="The city, {caption} view">'
            f"<figcaption>{caption}</figcaption></figure>"
        )
    return f'<div class="pictures">\n{chr(10).join(figures)}\n</div>' if figures else ""


def _attribution(texts: Iterable[Any]) -> str:
    return "\n".join(f'<p class="soft">{_text(text)}</p>' for text in texts)


def _goals(goals: Iterable[Mapping[str, Any]]) -> str:
    rows = [
        (_text(goal.get("goal", "")), _mark(goal.get("met")), _text(goal.get("evidence", "")))
        for goal in goals
    ]
    head = [("Goal", False), ("Met", False), ("Evidence", False)]
    return _section("What was asked", _table(head, rows)) if rows else ""


def _counts(report: Mapping[str, Any]) -> str:
    values = {name.replace("_", " "): value for name, value in (report.get("counts") or {}).items()}
    triangles = report.get("triangles") or {}
    values |= {f"triangles {name}": value for name, value in triangles.items()}
    if "peak_rss_mb" in report:
        values["peak memory, MB"] = report["peak_rss_mb"]
    tiles = "\n".join(
        f"<div><dt>{_text(name)}</dt><dd>{_number(value)}</dd></div>"
        for name, value in values.items()
    )
    return _section("What it holds", f'<dl class="tiles">\n{tiles}\n</dl>') if tiles else ""


def _checks(checks: Mapping[str, Mapping[str, Any]]) -> str:
    rows = []
    for name, check in checks.items():
        meaning = check.get("meaning")
        title = _words(name)
        if meaning:
            title += f'<br><span class="soft">{_text(meaning)}</span>'
        limit = f"{_text(check.get('bound', ''))} {_number(check.get('limit', ''))}".strip()
        rows.append((title, _number(check.get("value", "")), limit, _mark(check.get("ok"))))
    head = [("Check", False), ("Value", True), ("Limit", True), ("Holds", False)]
    return _section("Checks", _table(head, rows)) if rows else ""


def _timings(timings: Mapping[str, float]) -> str:
    longest = max((float(value) for value in timings.values()), default=0.0)
    rows = []
    for name, value in timings.items():
        share = 100 * float(value) / longest if longest > 0 else 0
        bar = f'<span style="width:{share:.1f}%"></span>'
        rows.append((_words(name), f"{float(value):.2f} s", bar))
    if not rows:
        return ""
    total = sum(float(value) for value in timings.values())
    table = _table([("Step", False), ("Time", True), ("", False)], rows)
    table = table.replace("<td><span style", '<td class="bar"><span style')
    return _section(f"Time, {total:.1f} s together", table)


def _failures(failures: Sequence[Mapping[str, Any]]) -> str:
    if not failures:
        return ""
    rows = [
        (
            f"<code>{_text(failure.get('id', ''))}</code>",
            f"<code>{_text(failure.get('action', ''))}</code>",
            _text(failure.get("error", "")),
        )
        for failure in failures[:MOST_FAILURES]
    ]
    table = _table([("Object", False), ("Action", False), ("What happened", False)], rows)
    more = len(failures) - len(rows)
    if more > 0:
        table += f'\n<p class="soft">and {_number(more)} more, in report.json</p>'
    return _section(f"Failures ({len(failures)})", table)


def _list(title: str, items: Iterable[Any]) -> str:
    lines = "\n".join(f"<li>{_text(item)}</li>" for item in items)
    return _section(title, f"<ul>\n{lines}\n</ul>") if lines else ""


def _origin(report: Mapping[str, Any]) -> str:
    rows = []
    for item in report.get("inputs") or ():
        values = item.items() if isinstance(item, Mapping) else [("input", item)]
        facts = ", ".join(
            f"{_words(str(key))}: <code>{_text(value)}</code>" for key, value in values
        )
        rows.append(("Input", facts))
    brief = report.get("brief") or {}
    rows += [(_words(str(key)), _text(value)) for key, value in brief.items() if value is not None]
    projection = (report.get("frame") or {}).get("projection")
    if projection:
        rows.append(("Frame", f"<code>{_text(projection)}</code>"))
    if "hash" in report:
        rows.append(("Hash", f"<code>{_text(report['hash'])}</code>"))
    if not rows:
        return ""
    return _section("Where it comes from", _table([("", False), ("", False)], rows))
