"""The report as one web page: no script, no font, nothing fetched."""

from __future__ import annotations

import os
from collections.abc import Container, Iterable, Mapping, Sequence
from pathlib import PurePath
from typing import Any
from urllib.parse import quote

from cityx.web_page import bars, number, page, section, table, text, tiles, words

MOST_FAILURES = 200  # rows of the table; more are counted
MOST_OF_A_TAG = 40  # that are not kept, by name
MOST_OF_A_TAG = 40  # that are not kept, by name


def report_html(report: Mapping[str, Any], pictures: Sequence[str | os.PathLike[str]] = ()) -> str:
    """Return the report as one HTML page.

    Parameters
    ----------
    report
        As of `cityx.checks.report.make_report`; parts that are missing are left out.
    pictures
        Images to show, the first one large; paths relative to the page.
    """
    name = str(report.get("name") or "City")
    parts = [
        _heading(report, text(name)),
        _verdict(report),
        _pictures(pictures, report.get("stale_views") or ()),
        _attribution(report.get("attribution") or ()),
        _goals(report.get("goals") or ()),
        _counts(report),
        _checks(report.get("checks") or {}),
        *map(_fidelity, report.get("fidelity") or ()),
        _timings(report.get("timings_s") or {}),
        _failures(report.get("failures") or ()),
        _list("Notes", report.get("notes") or ()),
        _origin(report),
    ]
    return page(f"{name} – CityX report", parts)


def _mark(ok: Any) -> str:
    if ok is None:
        return '<span class="soft">? cannot tell</span>'
    return '<span class="good">✓ yes</span>' if ok else '<span class="bad">✗ no</span>'


def _heading(report: Mapping[str, Any], name: str) -> str:
    facts = []
    if "area_km2" in report:
        facts.append(f"{number(report['area_km2'])} km²")
    frame = report.get("frame") or {}
    if "latitude" in frame and "longitude" in frame:
        facts.append(f"{frame['latitude']:.5f}, {frame['longitude']:.5f}")
    if "seed" in report:
        facts.append(f"seed {text(report['seed'])}")
    facts.append(f"CityX {text(report.get('cityx', ''))}".strip())
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


def _pictures(pictures: Sequence[str | os.PathLike[str]], stale: Container[str]) -> str:
    figures = []
    for picture in pictures:
        path = PurePath(picture)
        address = quote(path.as_posix())
        caption = words(path.stem)
        caption += ", of the city as it was before" if path.as_posix() in stale else ""
        figures.append(
            f'<figure><img src="{text(address)}" alt="The city, {caption} view">'
            f"<figcaption>{caption}</figcaption></figure>"
        )
    return f'<div class="pictures">\n{chr(10).join(figures)}\n</div>' if figures else ""


def _attribution(texts: Iterable[Any]) -> str:
    return "\n".join(f'<p class="soft">{text(item)}</p>' for item in texts)


def _goals(goals: Iterable[Mapping[str, Any]]) -> str:
    rows = [
        (text(goal.get("goal", "")), _mark(goal.get("met")), text(goal.get("evidence", "")))
        for goal in goals
    ]
    head = [("Goal", False), ("Met", False), ("Evidence", False)]
    return section("What was asked", table(head, rows)) if rows else ""


def _counts(report: Mapping[str, Any]) -> str:
    values = {name.replace("_", " "): value for name, value in (report.get("counts") or {}).items()}
    triangles = report.get("triangles") or {}
    values |= {f"triangles {name}": value for name, value in triangles.items()}
    if "peak_rss_mb" in report:
        values["peak memory, MB"] = report["peak_rss_mb"]
    return section("What it holds", tiles(values)) if values else ""


def _checks(checks: Mapping[str, Mapping[str, Any]]) -> str:
    rows = []
    for name, check in checks.items():
        meaning = check.get("meaning")
        title = words(name)
        if meaning:
            title += f'<br><span class="soft">{text(meaning)}</span>'
        limit = f"{text(check.get('bound', ''))} {number(check.get('limit', ''))}".strip()
        rows.append((title, number(check.get("value", "")), limit, _mark(check.get("ok"))))
    head = [("Check", False), ("Value", True), ("Limit", True), ("Holds", False)]
    return section("Checks", table(head, rows)) if rows else ""


def _fidelity(found: Mapping[str, Any]) -> str:
    """Return what a map states beside what became of it, tag by tag; what is not kept by name."""
    rows, tags = [], found.get("tags") or {}
    counted = [name for name in next(iter(tags.values()), {}) if name != "which"]
    for tag, row in tags.items():
        which = "; ".join(
            f"{name}: {stated} {verdict}{f', {made}' if made else ''}{f' ({why})' if why else ''}"
            for name, verdict, stated, made, why in (row.get("which") or ())[:MOST_OF_A_TAG]
        )
        counts = (number(row[name]) for name in counted)
        rows.append((text(tag), *counts, f'<span class="soft">{text(which)}</span>'))
    head = [("Tag", False), *((name.capitalize(), True) for name in counted)]
    title = (
        f"What {text(found.get('map', ''))} states: {100 * (found.get('share') or 0):.1f} % kept"
    )
    return section(title, table([*head, ("Not kept", False)], rows)) if rows else ""


def _timings(timings: Mapping[str, float]) -> str:
    if not timings:
        return ""
    total = sum(float(value) for value in timings.values())
    rows = {name: (float(value), f"{float(value):.2f} s") for name, value in timings.items()}
    return section(f"Time, {total:.1f} s together", bars(("Step", "Time"), rows))


def _failures(failures: Sequence[Mapping[str, Any]]) -> str:
    if not failures:
        return ""
    rows = [
        (
            f"<code>{text(failure.get('id', ''))}</code>",
            f"<code>{text(failure.get('action', ''))}</code>",
            text(failure.get("error", "")),
        )
        for failure in failures[:MOST_FAILURES]
    ]
    rows_html = table([("Object", False), ("Action", False), ("What happened", False)], rows)
    more = len(failures) - len(rows)
    if more > 0:
        rows_html += f'\n<p class="soft">and {number(more)} more, in report.json</p>'
    return section(f"Failures ({len(failures)})", rows_html)


def _list(title: str, items: Iterable[Any]) -> str:
    lines = "\n".join(f"<li>{text(item)}</li>" for item in items)
    return section(title, f"<ul>\n{lines}\n</ul>") if lines else ""


def _origin(report: Mapping[str, Any]) -> str:
    rows = []
    for item in report.get("inputs") or ():
        values = item.items() if isinstance(item, Mapping) else [("input", item)]
        facts = ", ".join(f"{words(str(key))}: <code>{text(value)}</code>" for key, value in values)
        rows.append(("Input", facts))
    brief = report.get("brief") or {}
    rows += [(words(str(key)), text(value)) for key, value in brief.items() if value is not None]
    projection = (report.get("frame") or {}).get("projection")
    if projection:
        rows.append(("Frame", f"<code>{text(projection)}</code>"))
    if "hash" in report:
        rows.append(("Hash", f"<code>{text(report['hash'])}</code>"))
    if not rows:
        return ""
    return section("Where it comes from", table([("", False), ("", False)], rows))
