"""Tables of the documentation, made of the code: arrays, observations, sensors, who moves."""

from __future__ import annotations

import re
from collections.abc import Mapping

from cityx.sim.dynamics import DRIVEN
from cityx.sim.observe import FLYING, PRESETS, WALKING, Preset
from cityx.sim.sensors import MEANINGS, SEEN_MEANINGS, SPACES
from cityx.sim.travellers import TRAVELLERS
from cityx.sim.walks import Walks
from cityx.sim.world import World

_ATTRIBUTE = re.compile(r"^    (\w+)\n((?:        .*\n)+)", re.M)


def world_table() -> str:
    """Return the arrays of `World`, as a table of Markdown."""
    return _arrays(World)


def walks_table() -> str:
    """Return the arrays of `Walks`, as a table of Markdown."""
    return _arrays(Walks)


def _arrays(kind: type) -> str:
    text = (kind.__doc__ or "").split("Attributes\n    ----------\n")[1]
    rows = [f"| `{name}` | {_line(body)} |" for name, body in _ATTRIBUTE.findall(text + "\n")]
    return "\n".join(["| array | what it holds |", "| --- | --- |", *rows])


def observation_table() -> str:
    """Return the fields of what drivers observe, as a table of Markdown."""
    return _fields(PRESETS)


def task_observation_table() -> str:
    """Return the fields of what walkers and drones observe, as a table of Markdown."""
    return _fields({**WALKING, **FLYING})


def _fields(presets: Mapping[str, Preset]) -> str:
    rows = [
        f"| `{preset.name}` ({preset.size}) | {field.name} | {field.size} | {field.meaning} |"
        for preset in presets.values()
        for field in preset.fields
    ]
    head = ["| preset | field | numbers | meaning |", "| --- | --- | --- | --- |"]
    return "\n".join([*head, *rows])


def vehicle_table() -> str:
    """Return the vehicles, as a table of Markdown."""
    rows = [
        f"| `{v.name}` | {v.length} x {v.width} x {v.height} | {v.wheelbase} | {v.steer} "
        f"| {v.accel} | {v.brake} | {v.top:g} |"
        for v in DRIVEN
    ]
    head = ["| vehicle | metres | wheelbase, m | steering, rad | m/s² | braking, m/s² | m/s |",
            "| --- | --- | --- | --- | --- | --- | --- |"]  # fmt: skip
    return "\n".join([*head, *rows])


def traveller_table() -> str:
    """Return who goes on walks, as a table of Markdown."""
    rows = [
        f"| `{t.name}` | {t.length} x {t.width} x {t.height} | {t.step} | {t.top} | {t.accel} "
        f"| {t.turn if t.wheels else 'any'} |"
        for t in TRAVELLERS
    ]
    head = ["| traveller | metres | step, m | m/s | m/s² | rad/s |",
            "| --- | --- | --- | --- | --- | --- |"]  # fmt: skip
    return "\n".join([*head, *rows])


def sensor_table() -> str:
    """Return the sensors, as a table of Markdown."""
    rows = [f"| `{name}` | {' x '.join(map(str, space.shape))} {space.dtype} | {MEANINGS[name]} |"
            for name, space in SPACES.items()]  # fmt: skip
    return "\n".join(["| sensor | numbers | meaning |", "| --- | --- | --- |", *rows])


def camera_table() -> str:
    """Return the channels of cameras, as a table of Markdown."""
    rows = [f"| `{name}` | {numbers} | {meaning} |"
            for name, (numbers, meaning) in SEEN_MEANINGS.items()]  # fmt: skip
    return "\n".join(["| channel | numbers | meaning |", "| --- | --- | --- |", *rows])


def _line(body: str) -> str:
    return " ".join(line.strip() for line in body.splitlines() if line.strip())


TABLES = {
    "world": world_table, "observations": observation_table, "vehicles": vehicle_table,
    "walks": walks_table, "task observations": task_observation_table,
    "travellers": traveller_table, "sensors": sensor_table, "cameras": camera_table,
}  # fmt: skip


def renewed(page: str) -> str:
    """Return a page with its tables made anew, between ``<!-- begin NAME -->`` and the end."""
    for name, made in TABLES.items():
        if f"<!-- begin {name} -->" not in page:
            continue
        marks = f"<!-- begin {name} -->", f"<!-- end {name} -->"
        before, _, rest = page.partition(marks[0])
        _, _, after = rest.partition(marks[1])
        page = f"{before}{marks[0]}\n{made()}\n{marks[1]}{after}"
    return page
