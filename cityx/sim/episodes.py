"""Episodes as data sets: what a recording holds as tracks of a city, and its agent's way as a plan.

`cityx dataset` then takes its pictures, truth and formats of it, as of any city and plan.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from cityx.assets.vehicles.movers import kind_of, paints_of, person_look, size_of
from cityx.city.content import content_hash
from cityx.city.store import read_city, write_city
from cityx.city.tracks import GAIT, Tracks, no_tracks
from cityx.errors import InputError, UsageError
from cityx.geometry.arrays import FloatArray
from cityx.ids import stable_id
from cityx.sim.compile.scenery import LOOKS, PEOPLE
from cityx.sim.engine import Engine
from cityx.sim.info import mover_name
from cityx.sim.kernels.tables import ALIVE, HEADING, HEIGHT, KIND, PIECE, SPEED, X, Y, Z
from cityx.sim.places import store_of
from cityx.sim.record import Recording, driven_again
from cityx.sim.state import DT
from cityx.system.atomic import replaced

PLAN, REPORT = "plan.json", "report.json"  # beside the city of an episode
HELD = 0.95  # of the height of the agent at which its rig is held
JUMP = 8.0  # metres in a step from which on a vehicle has gone elsewhere and another has come
STANDS = 0.15  # m/s below which who walks stands
SHORTEST = 2  # moments of an episode


@dataclass(frozen=True)
class Episode:
    """One episode of a recording, t moments of N movers.

    Attributes
    ----------
    number
        From 1.
    task
        Of the recording.
    real
        (t, 6, N) float64: x, y, z, heading, speed and height, as of `cityx.sim.state.State`.
    kind, lane
        (t, N) kinds of movers, and ids of the lanes they are on, 0 for none.
    there
        (t, N) bool, who is in the world.
    begun
        Seconds of the clock of the signals at the first moment.
    names
        Of the movers, the first of them that of the agent.
    people
        How many movers after the first are on foot.
    """

    number: int
    task: str
    real: FloatArray
    kind: FloatArray
    lane: FloatArray
    there: FloatArray
    begun: float
    names: tuple[str, ...]
    people: int

    @property
    def time(self) -> FloatArray:
        """(t,) seconds of the clock of the signals."""
        return np.round(self.begun + DT * np.arange(len(self.real)), 6)


def episode_of(recording: Recording, place: Any, number: int = 1) -> Episode:
    """Drive a recording again and return one of its episodes.

    Raises
    ------
    InputError
        If the recording is of another place, or does not drive again; or has no such episode.
    UsageError
        If it has many agents, whose episodes do not end together.
    """
    if recording.options.agents != 1:
        raise UsageError(
            f"The recording has {recording.options.agents} agents; episodes of one are exported."
        )
    found: list[tuple[Any, ...]] = []
    begun, last, engine = 0.0, 0, None
    for engine in driven_again(recording, place):
        last = int(engine.state.episode[0])
        if last == number:
            if not found:
                begun = float(engine.state.clock[0])
            found.append(_moment(engine))
    if engine is None or len(found) < SHORTEST:
        raise InputError(
            f"The recording has {last} episode{'s' * (last != 1)}; there is no episode {number} of "
            f"{SHORTEST} moments or more."
        )
    real, kind, lane, there = (np.array(part) for part in zip(*found, strict=True))
    names = tuple(mover_name(engine, n) for n in range(real.shape[2]))
    return Episode(number, recording.task, real, kind, lane, there, round(begun, 6), names,
                   engine.people)  # fmt: skip


def _moment(engine: Engine) -> tuple[Any, ...]:
    real, whole = engine.state.real[0], engine.state.whole[0]
    world = engine.world
    piece = whole[PIECE]
    on = (piece >= 0) & (piece < world.count)
    on &= ~world.across[np.where(on, piece, 0)]
    lane = np.where(on, world.piece_lane[np.where(on, piece, 0)], np.uint64(0))
    return (real[[X, Y, Z, HEADING, SPEED, HEIGHT]].copy(), whole[KIND].copy(), lane,
            whole[ALIVE] != 0)  # fmt: skip


def tracks_of(episode: Episode) -> Tracks:
    """Return the ways of all movers but the agent, whose own body no camera of it sees.

    A vehicle that goes elsewhere is another one from then on: ``traffic:3``, then ``traffic:3:2``.
    """
    rows = [
        (f"{episode.names[n]}{f':{k + 1}' * (k > 0)}", n, part)
        for n in range(1, len(episode.names))
        for k, part in enumerate(_stays(episode, n))
    ]
    if not rows:
        return no_tracks()
    looks = [_look_of(episode, n, part) for _, n, part in rows]
    ids = np.array([stable_id("sim", name) for name, *_ in rows], np.uint64)
    at = [(part, np.full(len(part), n)) for _, n, part in rows]
    moment, mover = (np.concatenate(parts) for parts in zip(*at, strict=True))
    real = episode.real[moment, :, mover]  # (s, 6)
    afoot = mover <= episode.people
    walks = np.where(real[:, 4] > STANDS, GAIT["walk"], GAIT["still"])
    tracks = Tracks(
        ids, np.array([kind_of(look) for look, _ in looks], np.uint8),
        np.array([look for look, _ in looks]), np.full(len(rows), episode.task),
        np.array([tint for _, tint in looks], np.float32),
        np.array([size_of(look) for look, _ in looks], np.float32),
        np.cumsum([0] + [len(part) for *_, part in rows]).astype(np.int64),
        episode.time[moment], real[:, :3], real[:, 3], real[:, 4].astype(np.float32),
        np.where(afoot, walks, GAIT["still"]).astype(np.uint8),
        np.where(afoot, 0, episode.lane[moment, mover]).astype(np.uint64),
    )  # fmt: skip
    return tracks.take(np.argsort(ids))


def _stays(episode: Episode, n: int) -> Iterator[Any]:
    """Yield the moments, ascending, of each stay of a mover in the world, in one piece."""
    there = np.flatnonzero(episode.there[:, n])
    if not len(there):
        return
    far = np.hypot(*np.diff(episode.real[there, :2, n], axis=0).T) > JUMP
    for part in np.split(there, np.flatnonzero(far | (np.diff(there) > 1)) + 1):
        if len(part) >= SHORTEST:
            yield part


def _look_of(episode: Episode, n: int, part: Any) -> tuple[str, FloatArray]:
    """Return the look and the paint of a mover."""
    if n <= episode.people:
        return person_look(n % PEOPLE, age="adult"), np.ones(3)
    looks = LOOKS[int(episode.kind[part[0], n])]
    look = looks[n % len(looks)]
    paints = paints_of(look)[0]
    return look, paints[n % len(paints)]


def plan_of(episode: Episode) -> dict[str, Any]:
    """Return the way of the agent as a file of shots, see `cityx.dataset.plans.custom`."""
    keys = [
        {
            "t": round(DT * k, 6),
            "position": [x, y, z + HELD * height],
            "heading_deg": float(np.degrees(np.pi / 2 - heading) % 360.0),
        }
        for k, (x, y, z, heading, _, height) in enumerate(episode.real[:, :, 0].tolist())
    ]
    name = f"episode-{episode.number}"
    return {"trajectories": [
        {"name": name, "rate": 1.0 / DT, "moment": episode.begun, "keys": keys}
    ]}  # fmt: skip


def write_episode(episode: Episode, place: Any, out: Path) -> Path:
    """Write the city in which an episode takes place, and its plan, to a folder.

    What the city shares with that of the place is linked. The tracks of the place are left out.

    Returns
    -------
    plan
        The file of shots.

    Raises
    ------
    UsageError
        If the folder holds something already.
    """
    if out.exists() and any(out.iterdir()):
        raise UsageError(f"{out} is not empty; an episode takes a folder of its own.")
    store = store_of(place)
    city = read_city(store)
    out.mkdir(parents=True, exist_ok=True)
    moving = replace(city, tracks=tracks_of(episode), moment=episode.begun)
    write_city(moving, out / "city", like=(city, store))
    # By the hash in its report a data set tells of which city it is.
    (out / REPORT).write_text(json.dumps({"hash": content_hash(moving).total}))
    with replaced(out / PLAN) as temporary:
        temporary.write_text(json.dumps(plan_of(episode)))
    return out / PLAN
