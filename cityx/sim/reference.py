"""Tables of the documentation, made of the code: arrays of a world, fields of observations."""

from __future__ import annotations

import re

from cityx.sim.dynamics import VEHICLES
from cityx.sim.observe import PRESETS
from cityx.sim.world import World

_ATTRIBUTE = re.compile(r"^    (\w+)\n((?:        .*\n)+)", re.M)


def world_table() -> str:
    """Return the arrays of `World`, as a table of Markdown."""
    text = (World.__doc__ or "").split("Attributes\n    ----------\n")[1]
    rows = [f"| `{name}` | {_line(body)} |" for name, body in _ATTRIBUTE.findall(text + "\n")]
    return "\n".join(["| array | what it holds |", "| --- | --- |", *rows])


def observation_table() -> str:
    """Return the fields of the presets of observations, as a table of Markdown."""
    rows = [
        f"| `{preset.name}` ({preset.size}) | {field.name} | {field.size} | {field.meaning} |"
        for preset in PRESETS.values()
        for field in preset.fields
    ]
    head = ["| preset | field | numbers | meaning |", "| --- | --- | --- | --- |"]
    return "\n".join([*head, *rows])


def vehicle_table() -> str:
    """Return the vehicles, as a table of Markdown."""
    rows = [
        f"| `{v.name}` | {v.length} x {v.width} x {v.height} | {v.wheelbase} | {v.steer} "
        f"| {v.accel} | {v.brake} | {v.top:g} |"
        for v in VEHICLES
    ]
    head = ["| vehicle | metres | wheelbase, m | steering, rad | m/s² | braking, m/s² | m/s |",
            "| --- | --- | --- | --- | --- | --- | --- |"]  # fmt: skip
    return "\n".join([*head, *rows])


def _line(body: str) -> str:
    return " ".join(line.strip() for line in body.splitlines() if line.strip())


TABLES = {"world": world_table, "observations": observation_table, "vehicles": vehicle_table}


def renewed(page: str) -> str:
    """Return a page with its tables made anew, between ``<!-- begin NAME -->`` and the end."""
    for name, made in TABLES.items():
        marks = f"<!-- begin {name} -->", f"<!-- end {name} -->"
        before, _, rest = page.partition(marks[0])
        _, _, after = rest.partition(marks[1])
        page = f"{before}{marks[0]}\n{made()}\n{marks[1]}{after}"
    return page
