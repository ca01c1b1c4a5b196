"""What moves, as a page plays it: tracks sampled five times a second, in one binary file.

The file is a JSON header, its length before it as 32 bits, then 16-bit numbers: for each sample of
each mover its place in centimetres from the corner of the box, and its heading.
"""

from __future__ import annotations

import json
import struct
from hashlib import sha256
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cityx.city.content import hash_tracks
from cityx.city.store import View
from cityx.city.tracks import MOVER_KINDS, Tracks
from cityx.ids import id_text
from cityx.viewer.movers import model_of

RATE = 5.0  # samples a second
FORMAT = 2  # of the file; another one gives another name
_TURN = 65536 / (2 * np.pi)  # steps of a heading


def movement_name(view: View) -> str:
    """Return the name of the file, a hash of the tracks; "" where nothing moves."""
    if view.tracks is None or not view.tracks.count:
        return ""
    ids, hashes = hash_tracks(view.tracks)
    return sha256(f"{FORMAT}".encode() + ids.tobytes() + hashes.tobytes()).hexdigest()[:32]


def movement_bytes(view: View) -> bytes:
    """Return the file; y up, as the page has it."""
    tracks = view.tracks
    assert tracks is not None
    low = tracks.position.min(axis=0)
    step = max(float(np.ptp(tracks.position, axis=0).max()) / 65535, 0.001)
    movers: list[dict[str, Any]] = []
    columns: list[NDArray[np.uint16]] = []
    for row in range(tracks.count):
        time, place, heading = _resampled(tracks, row)
        if not len(time):
            continue
        steps = np.rint((place - low) / step)
        turn = np.mod(np.rint(heading * _TURN), 65536)
        columns.append(np.column_stack([steps, turn]).astype(np.uint16))
        movers.append({
            "id": id_text(int(tracks.object_id[row])), "kind": MOVER_KINDS[tracks.kind[row]],
            "look": model_of(str(tracks.look[row])),
            "from": round(float(time[0]), 3), "count": len(time),
            "tint": [round(float(c), 3) for c in tracks.tint[row]],
            "size": [round(float(c), 2) for c in tracks.size[row]],
        })  # fmt: skip
    head = {"rate": RATE, "duration": round(tracks.duration, 3), "low": low.tolist(), "step": step,
            "movers": movers}  # fmt: skip
    text = json.dumps(head, separators=(",", ":")).encode()
    text += b" " * (-(len(text) + 4) % 8)
    return struct.pack("<I", len(text)) + text + b"".join(part.tobytes() for part in columns)


def _resampled(
    tracks: Tracks, row: int
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    at = slice(*tracks.sample_start[row : row + 2].tolist())
    known = tracks.time[at]
    if not len(known):
        return known, tracks.position[at], tracks.heading[at]
    time = np.arange(np.ceil(known[0] * RATE), np.floor(known[-1] * RATE) + 1) / RATE
    place = np.column_stack([np.interp(time, known, axis) for axis in tracks.position[at].T])
    return time, place, np.interp(time, known, np.unwrap(tracks.heading[at]))
