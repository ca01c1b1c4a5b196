"""Measure traffic: how fast it is simulated, and how well it keeps to streets and rules.

    python benchmarks/traffic.py [--minutes 10] [--kept FOLDER] [--places soho,berlin] [--speed]

The first table is the time of SUMO's process for 500 vehicles and 500 people on a made grid, ten
steps a second, against the time simulated. The second is of real extracts (`../shared/data/osm`),
built here without pictures, with heavy traffic at eight in the morning: the checks of
`movement_checks` on the tracks, and what SUMO itself reports. `--kept` keeps the cities.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from dataclasses import replace
from pathlib import Path
from resource import RUSAGE_CHILDREN, getrusage

import numpy as np
import shapely
from places import PLACES, built

from cityx.checks.movement_checks import check_movement
from cityx.city import City, Frame, Layout
from cityx.city.layout import make_table
from cityx.city.store import read_city
from cityx.ids import hash_ids, id_text, uniform
from cityx.motion import traffic as action
from cityx.motion.vehicles import halts_of, looks_of_kinds
from cityx.places.profiles import profile_of
from cityx.road.network.lane_graph import lanes
from cityx.traffic import session
from cityx.traffic.demand import Drivable, demand_of, per_km_at
from cityx.traffic.laying import streets_of
from cityx.traffic.network import make_network
from cityx.traffic.simulation import Outcome, Run, Walker, simulate
from cityx.traffic.streets import Way

BLOCK, BLOCKS = 150.0, 9  # metres between streets of the grid, and blocks along a side
CROWD = 500
WALK_WAYS = 4  # streets that one person walks along
STROLL = WALK_WAYS * BLOCK - 50.0  # metres of it, from the start to where the walk ends
SLOW, FAST = 1.0, 1.7  # metres per second


def grid() -> City:
    """Make a grid of streets with walks, every third of them a main road."""
    half = BLOCK * BLOCKS / 2
    at = np.arange(BLOCKS + 1) * BLOCK - half
    shapes, kinds = [], []
    for number, place in enumerate(at.tolist()):
        for line in ([(x, place) for x in at], [(place, y) for y in at]):
            shapes.append(shapely.LineString(line))
            kinds.append("secondary" if number % 3 == 0 else "residential")
    size = len(shapes)
    columns = {
        "lanes": [2] * size, "lanes_forward": [1] * size, "lane_width": [3.25] * size,
        "width": [6.5] * size, "sidewalk_left": [2.0] * size, "sidewalk_right": [2.0] * size,
        "surface": ["asphalt"] * size, "maxspeed_kmh": [50.0] * size,
    }  # fmt: skip
    roads = make_table("roads", shapes, id=list(range(1, size + 1)), kind=kinds, **columns)
    empty = {name: make_table(name, []) for name in ("buildings", "parts")}
    layout = Layout((-half, -half, half, half), **empty, roads=roads)
    return lanes(City("grid", Frame(52.0, 13.0), layout))


def walkers(net: Drivable, seconds: float) -> tuple[Walker, ...]:
    """Let people walk along streets all the time: each starts when another arrives."""
    ways = [way for way in net.streets.ways if way.lanes[0].kind == "walk"]
    after: dict[int, list[int]] = {}
    for number, way in enumerate(ways):
        after.setdefault(way.source, []).append(number)
    found: list[Walker] = []
    count = int(CROWD * (1 + (60.0 + seconds) * FAST / STROLL))
    ids = hash_ids(0, "bench/walker", np.arange(count))
    for number, own in enumerate(ids.tolist()):
        draw = uniform(0, "bench/walk", np.full(2, own, np.uint64), np.arange(2))
        route = [int(draw[0] * len(ways))]
        for _ in range(WALK_WAYS - 1):  # round the block, the only way without crossings
            here = ways[route[-1]]
            route += sorted(after.get(here.target, []), key=lambda way: _turn(here, ways[way]))[:1]
        before = found[number - CROWD] if number >= CROWD else None
        depart = -60.0 if before is None else before.depart + STROLL / before.speed
        stage = tuple(ways[way].name for way in route)
        found.append(Walker(id_text(own), depart, (stage,), 10.0, 100.0,
                            SLOW + (FAST - SLOW) * float(draw[1])))  # fmt: skip
    return tuple(found)


def _turn(here: Way, there: Way) -> float:
    """Radians to the left from one way to another; turning back comes last."""
    ends = here.lanes[0].shape[-2:, :2], there.lanes[0].shape[:2, :2]
    one, other = (end[1] - end[0] for end in ends)
    turn = float(np.arctan2(one[0] * other[1] - one[1] * other[0], one @ other))
    return turn if here.edge != there.edge else np.pi


def speed(seconds: float) -> None:
    """Print how fast a crowded grid is simulated."""
    city = grid()
    streets = streets_of(city, halts_of(city))
    net = Drivable(city, streets)
    kilometres = sum(map(net.kilometres, {net.road(way) for way in streets.ways}))
    per_km = dict.fromkeys(per_km_at("heavy", 8.0), 1.25 * CROWD / kilometres)
    looks = looks_of_kinds(profile_of(city.frame).vehicles)
    demand = demand_of(city, streets, looks, per_km=per_km, hour=8.0,
                       seconds=60.0 + seconds, purpose="bench")  # fmt: skip
    run = Run(demand.looks, demand.groups, walkers=walkers(net, seconds), duration=seconds)
    with tempfile.TemporaryDirectory() as folder:
        network = make_network(streets, city.frame, Path(folder))
        begin, before = time.perf_counter(), getrusage(RUSAGE_CHILDREN).ru_utime
        outcome = simulate(run, network)
        wall = time.perf_counter() - begin
        busy = getrusage(RUSAGE_CHILDREN).ru_utime - before
    poses = outcome.poses
    on_foot = np.isin(poses.name, [walker.name for walker in run.walkers])[poses.mover]
    steps = len(np.unique(poses.time))
    print(f"grid of {kilometres:.0f} km, {seconds:.0f} s after a minute of filling, 10 Hz")
    print(f"  vehicles {(~on_foot).sum() / steps:.0f}, people {on_foot.sum() / steps:.0f} (mean)")
    print(
        f"  SUMO's process took {busy:.1f} s of one core, {(seconds + 60) / busy:.1f} x real time; "
        f"{wall:.1f} s on the clock of this machine, {(seconds + 60) / wall:.1f} x"
    )


def place(name: str, kept: Path, minutes: float) -> None:
    """Print how traffic fares in a real place."""
    city = read_city(built(name, kept, lod=1) / "city")
    outcomes: list[Outcome] = []

    def observed(*args: object) -> Outcome:
        outcomes.append(simulate(*args))  # type: ignore[arg-type]
        return outcomes[-1]

    begin = time.perf_counter()
    session.simulate = observed
    city = action.traffic(city, density="heavy", duration=60.0 * minutes, hour=8.0)
    session.simulate = simulate
    wall = time.perf_counter() - begin
    (outcome,) = outcomes
    assert city.tracks is not None
    there = len(outcome.poses.time) / max(600.0 * minutes, 1.0)
    total = max(city.tracks.count, 1)
    gone = len(set(outcome.teleported) | set(outcome.halted))
    pairs = {pair[1:] for pair in outcome.collisions}
    print(
        f"{name}: {total} vehicles, {there:.0f} at a time, {wall:.0f} s in all; taken out or stuck "
        f"{gone} ({100 * gone / total:.1f} %), SUMO's collisions {len(pairs)}; "
        f"{len(city.tracks.time):,} samples of {len(outcome.poses.time):,} kept"
    )
    for check in check_movement(replace(city, failures=())):
        print(f"    {check.name:26s} {check.value:8.4g}  limit {check.limit:g}  "
              f"{'ok' if check.ok else 'FAILED'}")  # fmt: skip


def main() -> None:
    """Run both parts."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--kept", type=Path)
    parser.add_argument("--places", default=",".join(PLACES))
    parser.add_argument("--speed", action="store_true", help="only the first table")
    args = parser.parse_args()
    speed(120.0)
    if args.speed:
        return
    with tempfile.TemporaryDirectory() as folder:
        for name in args.places.split(","):
            place(name.strip(), args.kept or Path(folder), args.minutes)


if __name__ == "__main__":
    main()
