"""A run of SUMO as its caller sees it: trips go out, poses come back."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cityx.errors import EngineError
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.traffic.engine import fate, last, require_sumo, said, sumo_environment
from cityx.traffic.kinds import DRIVING
from cityx.traffic.network import Network
from cityx.traffic.plain import tag

STEP = 0.1  # seconds
WARM = 60.0  # seconds of traffic before the tracks begin, so that queues have formed
PATIENCE = 120.0  # seconds that a vehicle waits before it is taken out, and counted
STUCK = 60.0  # seconds without moving after which a vehicle counts as stuck
SLOWEST = 0.5  # times real time on a busy machine; slower than this is a hang
PASSED = 1.5  # seconds to who has the right of way; at one second corners touch amid turns
CLOSE = 0.5  # seconds between vehicles that keep a speed somebody asked for
START_S = 120.0  # seconds that starting may take
ROUTES, GHOSTS = "city.rou.xml", "ghosts.npz"


@dataclass(frozen=True)
class Look:
    """A type of vehicle: a kind in one form.

    Attributes
    ----------
    name
        Of the look.
    kind
        Key of `cityx.traffic.kinds.DRIVING`.
    size
        Length, width and height, metres.
    speed
        Metres per second that its drivers want, None for what is allowed.
    allowed
        Metres per second that are allowed where they want that speed.
    """

    name: str
    kind: str
    size: tuple[float, float, float]
    speed: float | None = None
    allowed: float = 0.0

    @property
    def type_name(self) -> str:
        """Name of its type in SUMO."""
        return self.name if self.speed is None else f"{self.name}_at_{self.speed:g}"


@dataclass(frozen=True)
class Trip:
    """A vehicle and its way.

    Attributes
    ----------
    name
        Its id as text.
    look
        Index of its look.
    route
        Names of ways in order.
    entry
        Where on the route it is when the streets are filled.
    rolling
        Whether it comes from beyond the site, rather than from a place at the kerb.
    depart
        Seconds since the tracks begin at which it sets out, None to be sent when one is missing.
    lane, at
        Lane of its first way, and metres along it, where it sets out; None for the best one and
        its beginning.
    until
        Metres along its last way at which it has arrived, None for the end.
    pace
        Metres per second at which it begins, None for what is allowed or, at a kerb, nothing.
    """

    name: str
    look: int
    route: tuple[str, ...]
    entry: int = 0
    rolling: bool = True
    depart: float | None = None
    lane: int | None = None
    at: float | None = None
    until: float | None = None
    pace: float | None = None


@dataclass(frozen=True)
class Group:
    """Streets that are kept full.

    Attributes
    ----------
    edges
        Names of ways.
    target
        Vehicles on them at any time.
    trips
        Who is sent onto them, in order.
    """

    edges: tuple[str, ...]
    target: int
    trips: tuple[Trip, ...]


@dataclass(frozen=True)
class Walker:
    """Somebody on foot.

    Attributes
    ----------
    name
        Id as text.
    depart
        Seconds since the tracks begin.
    stages
        Ways walked one after the other, each a list of names of ways; at least two ways in all
        or a place on one.
    start, end
        Metres along the first and the last way.
    speed
        Metres per second.
    size
        Depth of the body, width and height, metres.
    """

    name: str
    depart: float
    stages: tuple[tuple[str, ...], ...]
    start: float
    end: float
    speed: float
    size: tuple[float, float, float] = (0.4, 0.5, 1.75)


@dataclass(frozen=True)
class Poses:
    """Where everything was in every step, p rows, ordered by mover and time.

    Attributes
    ----------
    name
        (m,) str, the movers.
    mover
        (p,) int64 into `name`.
    time
        (p,) float64, seconds since the tracks begin.
    xy
        (p, 2) float64, the foremost point of a vehicle, the middle of somebody on foot.
    angle
        (p,) float64, radians counter-clockwise from east.
    speed, along
        (p,) float64, metres per second, and metres along the lane.
    lane
        (p,) int64 into `lane_names`; of people the edge.
    lane_names
        Names of lanes.
    """

    name: NDArray[np.str_]
    mover: IntArray
    time: FloatArray
    xy: FloatArray
    angle: FloatArray
    speed: FloatArray
    along: FloatArray
    lane: IntArray
    lane_names: NDArray[np.str_]


@dataclass(frozen=True)
class Outcome:
    """What a run came to.

    Attributes
    ----------
    poses
        Where everything was.
    teleported
        Vehicles that were taken out since they could not go on, and when.
    halted
        Vehicles that had not moved for `STUCK` seconds at the end, and for how long.
    collisions
        What SUMO counts: (time, one, other).
    version
        Of SUMO.
    """

    poses: Poses
    teleported: dict[str, float]
    halted: dict[str, float]
    collisions: tuple[tuple[float, str, str], ...]
    version: str


@dataclass(frozen=True)
class Run:
    """A run to be made.

    Attributes
    ----------
    looks
        Types of vehicles.
    groups
        Streets that are kept full, by whom.
    trips
        Vehicles that set out at a time of their own.
    walkers
        People.
    barred
        Names of ways that nobody turns into, whatever the jam ahead.
    tight
        Links that lorries and buses do not take.
    warm, duration
        Seconds before the tracks begin, and of the tracks.
    seed
        Of SUMO's drivers.
    """

    looks: tuple[Look, ...] = ()
    groups: tuple[Group, ...] = ()
    trips: tuple[Trip, ...] = ()
    walkers: tuple[Walker, ...] = ()
    barred: tuple[str, ...] = ()
    tight: tuple[int, ...] = ()
    warm: float = WARM
    duration: float = 60.0
    seed: int = 0
    step: float = field(default=STEP)


@dataclass(frozen=True)
class Ghosts:
    """What moves already, g movers, and where it is in every step; a run drives round it.

    Attributes
    ----------
    name
        (g,) str.
    sumo_type
        (g,) str, names of types; "" of people.
    types
        The types as XML.
    step_start
        (s + 1,) int64 into the rows, of each step from the beginning of the run.
    row
        (p,) int64 into `name`.
    x, y, angle
        (p,) float64: foremost points of vehicles, middles of people; degrees clockwise from north.
    edge
        (p,) int64 into `edges`, where people are.
    edges
        Names of edges.
    """

    name: NDArray[np.str_]
    sumo_type: NDArray[np.str_]
    types: tuple[str, ...]
    step_start: IntArray
    row: IntArray
    x: FloatArray
    y: FloatArray
    angle: FloatArray
    edge: IntArray
    edges: NDArray[np.str_]


def simulate(run: Run, network: Network, ghosts: Ghosts | None = None) -> Outcome:
    """Run SUMO in a process of its own.

    Parameters
    ----------
    run
        Who sets out.
    network
        On what; files of the run are written beside it.
    ghosts
        What moves there already, None for nothing.

    Raises
    ------
    MissingExtra
        If SUMO is not installed.
    EngineError
        If it fails, is killed or hangs; with its last words.
    """
    require_sumo()
    folder = network.file.parent
    (folder / ROUTES).write_text(routes_text(run, ghosts.types if ghosts else ()))
    job = job_of(run, network)
    if ghosts is not None:
        np.savez(folder / GHOSTS, **{key: value for key, value in vars(ghosts).items()
                                     if isinstance(value, np.ndarray)})  # fmt: skip
    files = {key: str(folder / name) for key, name in
             (("poses", "poses.parquet"), ("collisions", "collisions.xml"),
              ("answer", "answer.json"))}  # fmt: skip
    job |= files | {"ghosts": str(folder / GHOSTS) if ghosts is not None else ""}
    path = folder / "job.json"
    path.write_text(json.dumps(job))
    limit = START_S + (run.warm + run.duration) / SLOWEST
    _run_worker(path, limit)
    answer = Path(files["answer"])
    if not answer.exists():
        raise EngineError("SUMO ended without an answer.")
    found = json.loads(answer.read_text())
    return Outcome(
        _read_poses(Path(files["poses"]), run.warm), found["teleported"], found["halted"],
        _read_collisions(Path(files["collisions"]), run.warm), found["version"],
    )  # fmt: skip


def job_of(run: Run, network: Network) -> dict[str, Any]:
    """Return what a process of SUMO has to know of a run whose routes lie beside the network."""
    tight = set(run.tight)
    return {
        "net": str(network.file), "routes": str(network.file.parent / ROUTES), "poses": "",
        "warm": run.warm, "duration": run.duration, "step": run.step,
        "seed": run.seed % (1 << 31), "patience": PATIENCE, "stuck": STUCK, "barred": run.barred,
        "tight": [name for name, link in network.links.items() if link in tight],
        "facing": network.facing,
        "bound": [trip.name for trip in run.trips if trip.until is not None],
        "groups": [
            {"edges": group.edges, "target": group.target,
             "trips": [_trip(trip, run.looks) for trip in group.trips]}
            for group in run.groups
        ],
    }  # fmt: skip


def _run_worker(job: Path, limit_s: float) -> None:
    command = [sys.executable, "-m", "cityx.traffic.worker", str(job)]
    environment = sumo_environment() | {"PYTHONPATH": ":".join(filter(None, sys.path))}
    try:
        done = subprocess.run(
            command, env=environment, cwd=job.parent, capture_output=True, text=True,
            errors="replace", timeout=limit_s, check=False,
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        raise EngineError(f"SUMO took longer than {limit_s:.0f} s and was ended.") from None
    if done.returncode:
        words = last(said(done.stdout + "\n" + done.stderr))
        raise EngineError(f"the process of SUMO {fate(done.returncode)}. Its last words:\n{words}")


def _trip(trip: Trip, looks: Sequence[Look]) -> dict[str, Any]:
    return {"id": trip.name, "type": looks[trip.look].type_name, "route": trip.route,
            "entry": trip.entry, "rolling": trip.rolling,
            "lane": DRIVING[looks[trip.look].kind].lane}  # fmt: skip


def routes_text(run: Run, types: Sequence[str] = ()) -> str:
    """Return types, vehicles with a time of their own, and people as SUMO's XML, in time."""
    lines = [*(type_text(look) for look in run.looks), *types]
    timed = []
    for trip in run.trips:
        at = run.warm + (trip.depart or 0.0)
        timed.append((at, trip.name, _vehicle(trip, run.looks[trip.look], at)))
    for walker in run.walkers:
        timed.append((run.warm + walker.depart, walker.name, _person(walker, run.warm)))
    lines += [text for _, _, text in sorted(timed)]
    return "<routes>\n" + "\n".join(lines) + "\n</routes>\n"


def _vehicle(trip: Trip, look: Look, at: float) -> str:
    """Return a vehicle with its route as SUMO's XML."""
    speed = "max" if trip.rolling else "0"
    where = {} if trip.at is None else {"departPos": f"{trip.at:.3f}"}
    if trip.until is not None:
        where["arrivalPos"] = f"{trip.until:.3f}"
    if trip.lane is not None:  # it is there, whatever the gaps
        where["insertionChecks"] = "collision"
    head = tag(
        "vehicle", id=trip.name, type=look.type_name, depart=f"{at:.1f}",
        departLane=DRIVING[look.kind].lane if trip.lane is None else trip.lane,
        departSpeed=speed if trip.pace is None else f"{trip.pace:.3f}", **where,
    )  # fmt: skip
    return f"{head[:-2]}>{tag('route', edges=' '.join(trip.route))}</vehicle>"


def type_text(look: Look) -> str:
    """Return the type of a look as SUMO's XML."""
    drive = DRIVING[look.kind]
    length, width, height = look.size
    wanted, top = {}, drive.top
    if look.speed is not None:
        # In corners they drive faster than others by the same factor.
        factor = look.speed / max(look.allowed, 1.0)
        wanted = {"speedFactor": f"{factor:.4f}", "speedDev": "0", "tau": f"{CLOSE:g}"}
        top = max(look.speed, drive.top)
    return tag(
        "vType", id=look.type_name, vClass=drive.sumo_class, length=f"{length:.3f}",
        width=f"{width:.3f}", height=f"{height:.3f}", accel=drive.accel, decel=drive.decel,
        maxSpeed=f"{top:g}", minGap=drive.gap, sigma="0.3",
        jmTimegapMinor=f"{PASSED:g}",
        lcStrategic=f"{drive.eager:g}", lcSpeedGain="0", lcKeepRight="0", lcCooperative="0",
        **wanted,
    )  # fmt: skip


def _person(walker: Walker, warm: float) -> str:
    kind = f"type_{walker.name}"
    length, width, height = walker.size
    body = tag("vType", id=kind, vClass="pedestrian", maxSpeed=f"{walker.speed:.3f}",
               speedDev="0", length=f"{length:.3f}", width=f"{width:.3f}",
               height=f"{height:.3f}")  # fmt: skip
    head = tag("person", id=walker.name, type=kind, depart=f"{warm + walker.depart:.1f}",
               departPos=f"{walker.start:.3f}")  # fmt: skip
    walks = []
    for number, stage in enumerate(walker.stages):
        at = {"arrivalPos": f"{walker.end:.3f}"} if number == len(walker.stages) - 1 else {}
        walks.append(tag("walk", edges=" ".join(stage), **at))
    return f"{body}\n{head[:-2]}>{''.join(walks)}</person>"


def _read_poses(path: Path, warm: float) -> Poses:
    """Read what SUMO wrote, ordered by mover and time."""
    import pyarrow as pa
    import pyarrow.compute
    import pyarrow.parquet as pq

    table = pq.read_table(path)
    if "vehicle_id" not in table.column_names:  # nobody was ever there
        none = np.zeros(0)
        return Poses(np.zeros(0, str), none.astype(np.int64), none, np.zeros((0, 2)), none, none,
                     none, none.astype(np.int64), np.zeros(0, str))  # fmt: skip
    table = table.filter(pa.compute.is_valid(table["vehicle_id"]))  # steps in which nobody is there
    columns = {name.removeprefix("vehicle_"): table[name] for name in table.column_names}
    ids = columns["id"].combine_chunks().dictionary_encode()
    lane = columns["lane"]
    if "edge" in columns:  # people are on edges, vehicles on lanes
        lane = pa.compute.coalesce(lane, columns["edge"])
    lanes = lane.combine_chunks().dictionary_encode()
    mover = ids.indices.to_numpy().astype(np.int64)
    names = np.array(ids.dictionary.to_pylist(), dtype=str)
    rank = np.argsort(np.argsort(names, kind="stable"), kind="stable")
    names, mover = np.sort(names, kind="stable"), rank[mover]
    time = np.round(columns["timestep_time"].to_numpy() - warm, 3)
    order = np.lexsort((time, mover))
    number = {key: columns[key].to_numpy()[order] for key in ("x", "y", "angle", "speed", "pos")}
    return Poses(
        names, mover[order], time[order], np.column_stack([number["x"], number["y"]]),
        np.radians(90.0 - number["angle"]), number["speed"], number["pos"],
        lanes.indices.to_numpy().astype(np.int64)[order],
        np.array(lanes.dictionary.to_pylist(), dtype=str),
    )  # fmt: skip


def _read_collisions(path: Path, warm: float) -> tuple[tuple[float, str, str], ...]:
    from lxml import etree

    if not path.exists() or not path.stat().st_size:
        return ()
    found = etree.parse(path).getroot()
    return tuple(
        (float(item.get("time")) - warm, item.get("collider"), item.get("victim"))
        for item in found
        if float(item.get("time")) >= warm
    )
