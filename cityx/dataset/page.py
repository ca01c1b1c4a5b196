"""The page of a dataset: what its shots look like, and what they hold, in pictures."""

from __future__ import annotations

import json
from base64 import b64encode
from collections.abc import Iterable, Sequence
from itertools import groupby, pairwise
from math import cos, sin
from pathlib import Path
from typing import TYPE_CHECKING

from cityx.dataset.cities import SHOTS, read_shots
from cityx.dataset.manifest import Manifest
from cityx.dataset.order import Order
from cityx.dataset.panels import FOLDER, MEANING
from cityx.dataset.shots import Shot
from cityx.dataset.statistics import DEPTHS, VISIBLE, Totals, totals
from cityx.system.tables import text_of
from cityx.web_page import bars, number, page, section, text, tiles

if TYPE_CHECKING:
    from cityx.dataset.classes import Class

MOST_MAPS = 6  # cities whose map is shown
MAP_WIDTH = 640  # units of a map
ARROW = 0.018  # of the map's width, how long the line is that shows where a shot looks
_ORDER = ("rgb", "depth", "normal", "semantic", "instance", "panoptic", "boxes", "lidar")
_STYLE = text_of("web/dataset.css")


def dataset_page(out: Path, order: Order, manifest: Manifest, classes: Sequence[Class]) -> str:
    """Return the page of a dataset whose shots are all taken.

    Parameters
    ----------
    out
        Folder of the dataset.
    order
        What was asked for.
    manifest
        Of the dataset.
    classes
        Every class.
    """
    found = totals(manifest.statistics())
    parts = [
        _heading(order, found),
        section("What it holds", tiles(_numbers(order, found))),
        _mosaic(out, manifest),
        _maps(out, list(found.cities)),
        _classes(found, classes),
        _depths(found),
        _visibility(found),
        _lights(found),
    ]
    return page("CityX dataset", parts, _STYLE)


def _heading(order: Order, found: Totals) -> str:
    cities = f"{len(found.cities)} cities" if len(found.cities) > 1 else next(iter(found.cities))
    facts = (cities, f"plan {order.plan}", f"rig {order.rig}", f"seed {order.seed}",
             f"{order.size[0]} × {order.size[1]}", ", ".join(order.formats))  # fmt: skip
    said = " · ".join(text(fact) for fact in facts)
    return (
        f'<header>\n<h1>{number(found.shots)} shots</h1>\n<p class="soft">{said}</p>\n'
        '<p class="soft">The card with licences and the command is '
        '<a href="README.md">README.md</a>.</p>\n</header>'
    )


def _numbers(order: Order, found: Totals) -> dict[str, int]:
    held = {
        "shots": found.shots, "cities": len(found.cities), "channels": len(order.wanted),
        "classes seen": len(found.classes), "boxes": sum(found.boxes.values()),
        "segments": found.segments, "LiDAR points": found.points,
        "megapixels": round(found.pixels / 1e6),
    }  # fmt: skip
    return {name: value for name, value in held.items() if value}


def _mosaic(out: Path, manifest: Manifest) -> str:
    """Lay out the panels of the shots that are shown, a row each."""
    names = manifest.names()
    paths = sorted((out / FOLDER).glob("*.*"))
    rows = []
    shown: list[str] = []
    for stem, group in groupby(paths, lambda path: path.name.split(".")[0]):
        held = {path.name.split(".")[1]: path for path in group}
        shown = [name for name in _ORDER if name in held]
        pictures = "".join(
            f'<img src="{_data(held[name])}" alt="{text(name)} of {text(names[int(stem)])}">'
            for name in shown
        )
        caption = f"<figcaption>{text(names[int(stem)])}</figcaption>"
        rows.append(f'<figure class="shot">{pictures}{caption}</figure>')
    if not rows:
        return ""
    told = ", ".join(f"{name} ({MEANING[name]})" if name in MEANING else name for name in shown)
    said = f'<p class="names">{text(told)}</p>'
    return section("Samples", f'{said}<div class="mosaic">\n{chr(10).join(rows)}\n</div>')


def _data(path: Path) -> str:
    content = path.read_bytes()
    kind = "png" if content.startswith(b"\x89PNG") else "jpeg"
    return f"data:image/{kind};base64,{b64encode(content).decode()}"


def _maps(out: Path, cities: Sequence[str]) -> str:
    """Draw where the shots of a city are taken and which way they look."""
    drawn = []
    for city in cities[:MOST_MAPS]:
        record = json.loads((out / "cities" / city / "city.json").read_text())
        shots = read_shots(out / "cities" / city / SHOTS)
        drawn.append(_map(city, record["extent"], record.get("streets", ()), shots))
    more = len(cities) - len(drawn)
    said = f'<p class="soft">and {number(more)} more cities</p>' if more else ""
    return section("Where they are taken", f'<div class="maps">\n{"".join(drawn)}</div>{said}')


def _map(
    city: str, extent: Sequence[float], streets: Iterable[Sequence[float]], shots: Sequence[Shot]
) -> str:
    xmin, ymin, xmax, ymax = extent
    scale = MAP_WIDTH / max(xmax - xmin, 1.0)
    height = (ymax - ymin) * scale
    reach = MAP_WIDTH * ARROW

    def spot(x: float, y: float) -> tuple[float, float]:
        return (x - xmin) * scale, (ymax - y) * scale

    lines = []
    for width, *coordinates in streets:
        points = " ".join(
            "{:.1f},{:.1f}".format(*spot(x, y))
            for x, y in zip(coordinates[::2], coordinates[1::2], strict=True)
        )
        lines.append(f'<polyline class="street" stroke-width="{width * scale:.1f}" '
                     f'points="{points}"/>')  # fmt: skip
    for shot in shots:
        x, y = spot(shot.camera.position[0], shot.camera.position[1])
        dx, dy = reach * sin(shot.camera.heading), -reach * cos(shot.camera.heading)
        lines.append(
            f'<line class="look" x1="{x:.1f}" y1="{y:.1f}" x2="{x + dx:.1f}" y2="{y + dy:.1f}"/>'
        )
        lines.append(f'<circle class="eye" cx="{x:.1f}" cy="{y:.1f}" r="2"/>')
    return (
        f'<figure><svg viewBox="0 0 {MAP_WIDTH} {height:.0f}" role="img" '
        f'aria-label="Map of the shots of {text(city)}">{"".join(lines)}</svg>'
        f"<figcaption>{text(city)}, {number(len(shots))} shots</figcaption></figure>"
    )


def _classes(found: Totals, classes: Sequence[Class]) -> str:
    """Show the share of the pixels of each class, and how many boxes it has."""
    pixels = sum(found.classes.values())
    if not pixels:
        return ""
    rows = {}
    for number_, count in found.classes.most_common():
        share = 100 * count / pixels
        boxes = found.boxes.get(number_, 0)
        said = f"{share:.2f} %" + (f", {number(boxes)} boxes" if boxes else "")
        rows[classes[number_].name] = (share**0.5, said)  # of lengths that rare ones can be seen by
    laid = bars(("Class", "Pixels"), rows)
    for held in classes:
        name = text(held.name.replace("_", " "))
        swatch = f'<span class="swatch" style="background:rgb{held.color}"></span>'
        laid = laid.replace(f'<th scope="row">{name}</th>', f'<th scope="row">{swatch}{name}</th>')
    note = '<p class="soft">Lengths are by the square root of the share.</p>'
    return section("Classes", laid + note)


def _depths(found: Totals) -> str:
    total = sum(found.depths)
    if not total:
        return ""
    names = [f"{low:g} to {high:g} m" for low, high in pairwise(DEPTHS[:-1])]
    names += [f"beyond {DEPTHS[-2]:g} m", "sky"]
    rows = {
        name: (float(count), f"{100 * count / total:.1f} %")
        for name, count in zip(names, found.depths, strict=True)
    }
    return section("Depth", bars(("Along the view", "Pixels"), rows))


def _visibility(found: Totals) -> str:
    if not sum(found.visibility):
        return ""
    rows = {
        f"{100 * index // VISIBLE} to {100 * (index + 1) // VISIBLE} % visible":
            (float(count), number(count))
        for index, count in enumerate(found.visibility)
    }  # fmt: skip
    return section("Boxes by visibility", bars(("Visible", "Boxes"), rows))


def _lights(found: Totals) -> str:
    if not found.lights:
        return ""
    rows = {name: (float(count), number(count)) for name, count in sorted(found.lights.items())}
    return section("Light and weather", bars(("Weather, hour", "Shots"), rows))
