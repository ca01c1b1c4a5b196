"""Web pages that tell of something made: no script, no font, nothing fetched."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from html import escape
from math import isfinite
from typing import Any

STYLE = """
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


def page(title: str, parts: Iterable[str], style: str = "") -> str:
    """Return a page of ready HTML parts, with what it needs of style beyond the common."""
    body = "\n".join(part for part in parts if part)
    return (
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{text(title)}</title>\n<style>{STYLE}{style}</style>\n</head>\n"
        f"<body>\n<main>\n{body}\n</main>\n</body>\n</html>\n"
    )


def tiles(values: Mapping[str, Any]) -> str:
    """Lay out numbers with their names."""
    cells = "\n".join(
        f"<div><dt>{text(name)}</dt><dd>{number(value)}</dd></div>"
        for name, value in values.items()
    )
    return f'<dl class="tiles">\n{cells}\n</dl>' if cells else ""


def bars(head: tuple[str, str], values: Mapping[str, tuple[float, str]]) -> str:
    """Lay out values by name as bars, each with its length and what is written of it."""
    longest = max((value for value, _ in values.values()), default=0.0)
    share = 100 / longest if longest else 0.0
    rows = [
        (words(name), said, f'<span style="width:{value * share:.1f}%"></span>')
        for name, (value, said) in values.items()
    ]
    laid = table([(head[0], False), (head[1], True), ("", False)], rows)
    return laid.replace("<td><span style", '<td class="bar"><span style')


def text(value: Any) -> str:
    """Return a value as HTML."""
    return escape(str(value), quote=True)


def number(value: Any) -> str:
    """Show a number with up to four figures and grouped thousands; other values as they are."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return text(value)
    if isinstance(value, int) or (isfinite(value) and value == int(value) and abs(value) < 1e15):
        return f"{int(value):,}".replace(",", "\u202f")
    if not isfinite(value):
        return text(value)
    return f"{value:,.2f}".replace(",", "\u202f") if abs(value) >= 100 else f"{value:.4g}"


def words(name: str) -> str:
    """Return a name in words as HTML."""
    return text(name.replace("_", " "))


def section(title: str, content: str) -> str:
    """Put ready HTML under a title."""
    return f"<section>\n<h2>{text(title)}</h2>\n{content}\n</section>"


def table(head: Sequence[tuple[str, bool]], rows: Iterable[Sequence[str]]) -> str:
    """Lay out rows of ready HTML; a true flag marks a column of numbers, the first names rows."""
    kinds = [' class="number"' if number else "" for _, number in head]
    top = "".join(
        f'<th scope="col"{kind}>{text(title)}</th>'
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
