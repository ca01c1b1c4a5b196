"""Web pages that tell of something made: no script, no font, nothing fetched."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from html import escape
from math import isfinite
from typing import Any

from cityx.system.tables import text_of

STYLE = text_of("web/page.css")


def page(title: str, parts: Iterable[str], style: str = "") -> str:
    """Return a page of ready HTML parts, with what it needs of style beyond the common."""
    body = "\n".join(part for part in parts if part)
    return (
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{text(title)}</title>\n<style>\n{STYLE}{style}</style>\n</head>\n"
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
