"""What traffic lights show over time, as a page plays it beside the traffic: one JSON file."""

from __future__ import annotations

import json
from hashlib import sha256
from typing import Any

import numpy as np

from cityx.city.signals import people_heads, poles_of, sides_of, vehicle_heads
from cityx.city.store import View
from cityx.ids import id_text

DIGITS = 3  # of seconds


def lamps_bytes(view: View) -> bytes:
    """Return the file, b"" where no pole is ruled by a signal.

    "heads" lists cycle in seconds, times of changes, and states (`cityx.city.signals.STATES`);
    "poles" gives for the id of each pole the heads that it shows to vehicles, of which the most
    permissive counts, and the head that it shows to people, -1 without one.
    """
    signals = view.signals
    if signals is None or not signals.count:
        return b""
    poles: dict[str, tuple[list[int], int]] = {}
    for rows in view.scene.instances.values():
        which = poles_of(rows, view.scene.prototypes)
        if not len(which):
            continue
        foot, facing, over = sides_of(rows, which)
        pole, head = vehicle_heads(foot, facing, signals)
        place, walk = people_heads(over, signals)
        walks = dict(zip(place.tolist(), walk.tolist(), strict=True))
        for number, row in enumerate(which.tolist()):
            own = head[pole == number].tolist()
            if own or number in walks:
                poles[id_text(int(rows.object_id[row]))] = own, walks.get(number, -1)
    if not poles:
        return b""
    used = np.unique([n for own, walk in poles.values() for n in (*own, walk) if n >= 0]).tolist()
    place_of = {number: place for place, number in enumerate(used)} | {-1: -1}
    heads: list[dict[str, Any]] = []
    for number in used:
        at = slice(*signals.change_start[number : number + 2].tolist())
        heads.append({"cycle": round(float(signals.cycle[number]), DIGITS),
                      "times": np.round(signals.time[at], DIGITS).tolist(),
                      "states": signals.state[at].tolist()})  # fmt: skip
    shown = {name: [[place_of[n] for n in own], place_of[walk]]
             for name, (own, walk) in sorted(poles.items())}  # fmt: skip
    return json.dumps({"heads": heads, "poles": shown}, separators=(",", ":")).encode()


def lamps_name(data: bytes) -> str:
    """Return the name of the file, a hash of its bytes; "" where there is none."""
    return sha256(data).hexdigest()[:32] if data else ""
