"""The card of a dataset: what it is, who may use it, and how it was made."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cityx.dataset.manifest import Manifest
from cityx.dataset.order import Order
from cityx.dataset.statistics import Totals, totals
from cityx.dataset.writers import formats_named
from cityx.version import __version__

if TYPE_CHECKING:
    from cityx.dataset.classes import Class

RUNS = "runs.jsonl"
MADE = "## How fast it was made"  # the section that differs from one making to another
_HEAD = """---
pretty_name: {name}
tags: [synthetic, city, ground-truth, cityx]
task_categories: [depth-estimation, image-segmentation, object-detection]
---
"""


def card(
    out: Path,
    order: Order,
    manifest: Manifest,
    classes: Sequence[Class],
    command: str,
    failed: Mapping[str, str],
) -> str:
    """Return the card of a dataset whose shots are taken, as Markdown.

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
    command
        That made it.
    failed
        Shots that could not be taken, with the cause.
    """
    found = totals(manifest.statistics())
    cities = [_city(out, name) for name in found.cities]
    parts = [
        _HEAD.format(name=out.resolve().name),
        f"# {out.resolve().name}\n",
        f"{found.shots} shots of {_some(len(cities), 'city', 'cities')}, "
        f"{order.size[0]} x {order.size[1]} pixels, made with CityX {__version__}. "
        "[index.html](index.html) shows samples and statistics.\n",
        "```\n" + command + "\n```\n" if command else "",
        _contents(order, found),
        _channels(order),
        _licences(cities),
        _balance(found, classes),
        _cities(cities, found),
        _failed(failed),
        _checksums(manifest),
        _rates(out),
    ]
    return "\n".join(part for part in parts if part)


def _some(count: int, one: str, many: str) -> str:
    return f"{count} {one if count == 1 else many}"


def _city(out: Path, name: str) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((out / "cities" / name / "city.json").read_text())
    return found


def _table(head: Sequence[str], rows: Iterator[Sequence[Any]]) -> str:
    lines = [f"| {' | '.join(head)} |", f"|{' --- |' * len(head)}"]
    lines += [f"| {' | '.join(str(cell) for cell in row)} |" for row in rows]
    return "\n".join(lines) + "\n"


def _contents(order: Order, found: Totals) -> str:
    rows = [
        ("shots", found.shots), ("plan, rig", f"{order.plan}, {order.rig}"),
        ("seed of the plan", order.seed), ("boxes", sum(found.boxes.values())),
        ("segments", found.segments), ("LiDAR points", found.points),
        ("quality of pictures", order.quality if "rgb" in order.channels else ""),
    ]  # fmt: skip
    files = [
        ("`cities/NAME/objects.json`", "of every id: class, asset, materials, source, licence"),
        ("`cities/NAME/shots.jsonl`", "pose, intrinsics, moment and light of every shot"),
        ("`classes.json`, `cities/NAME/materials.json`", "numbers of classes and of materials"),
        ("`manifest.jsonl`", "every file with its SHA-256"),
        *((f"`{item.name}/`", item.meaning) for item in formats_named(order.formats)),
    ]  # fmt: skip
    held = ((name, value) for name, value in rows if value not in (0, ""))
    return (
        "## What it holds\n\n" + _table(("", ""), held) + "\n" + _table(("file", "holds"),
        iter(files)) + "\nEast is x, north y, up z; metres and seconds. Ids are those of the "
        "city, the same in masks, boxes, sweeps and `objects.json`.\n"
    )  # fmt: skip


def _channels(order: Order) -> str:
    if not order.wanted:
        return ""
    rows = ((c.name, c.dtype, c.depth, c.unit, c.meaning) for c in order.wanted)
    head = ("channel", "type", "values", "unit", "meaning")
    said = ""
    if {"flow", "motion"} & {channel.name for channel in order.wanted}:
        said = "\nFlow and motion are there where a sequence goes on.\n"
    return "## Channels\n\n" + _table(head, rows) + said


def _licences(cities: Sequence[Mapping[str, Any]]) -> str:
    texts = list(dict.fromkeys(text for city in cities for text in city["attribution"]))
    lines = [f"- {text}" for text in texts]
    lines.append("- What CityX adds (geometry, textures, pictures) is nobody else's.")
    said = "The notices must stay with what is published from it." if texts else ""
    return "## Licences\n\n" + "\n".join(lines) + "\n" + (f"\n{said}\n" if said else "")


def _balance(found: Totals, classes: Sequence[Class]) -> str:
    pixels = sum(found.classes.values())
    if not pixels:
        return ""
    rows = (
        (classes[number].name, f"{100 * count / pixels:.3f}", found.boxes.get(number, 0))
        for number, count in found.classes.most_common()
    )
    return "## Classes\n\n" + _table(("class", "pixels, %", "boxes"), rows)


def _cities(cities: Sequence[Mapping[str, Any]], found: Totals) -> str:
    rows = (
        (city["name"], city["city"], city["seed"], city["lod"], found.cities[city["name"]])
        for city in cities
    )
    return "## Cities\n\n" + _table(("name", "city", "seed", "level of detail", "shots"), rows)


def _failed(failed: Mapping[str, str]) -> str:
    if not failed:
        return ""
    lines = "\n".join(f"- {name}: {cause}" for name, cause in sorted(failed.items()))
    return f"## Left out\n\n{_some(len(failed), 'shot', 'shots')} could not be taken:\n\n{lines}\n"


def _checksums(manifest: Manifest) -> str:
    digest = sha256()
    for line in manifest.lines():
        digest.update(line.encode())
    return f"## Checksum\n\n`manifest.jsonl`: SHA-256 `{digest.hexdigest()}`\n"


def _rates(out: Path) -> str:
    """Tell how fast the shots came, summed over the runs that it took."""
    path = out / RUNS
    if not path.exists():
        return ""
    runs = [json.loads(line) for line in path.read_text().splitlines()]
    rows = (
        (run["shots"], f"{run['seconds']:.0f}", f"{run['shots'] / max(run['seconds'], 0.05):.2f}",
         run["workers"], ", ".join(f"{key} {value:.0f} s" for key, value in run["spent"].items()))
        for run in runs
    )  # fmt: skip
    head = ("shots", "seconds", "shots a second", "workers", "spent by the workers")
    return f"{MADE}\n\n{_table(head, rows)}"
