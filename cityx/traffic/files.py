"""A city for people who run SUMO themselves: network, routes and a configuration."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import groupby
from pathlib import Path
from shutil import copyfile
from tempfile import TemporaryDirectory

from cityx.city.city import City
from cityx.city.tracks import MOVER_KINDS, Tracks
from cityx.ids import id_text
from cityx.system.atomic import replaced
from cityx.traffic.demand import Drivable
from cityx.traffic.engine import require_sumo
from cityx.traffic.flows import route_between
from cityx.traffic.kinds import DRIVING
from cityx.traffic.laying import streets_of
from cityx.traffic.network import NET, make_network
from cityx.traffic.on_foot import divided, with_paths
from cityx.traffic.session import street_names
from cityx.traffic.simulation import ROUTES, STEP, Look, Run, Trip, routes_text
from cityx.traffic.streets import Halts

CONFIG = "city.sumocfg"
FILES = (NET, ROUTES, CONFIG)


def write_sumo(city: City, halts: Halts, folder: Path) -> tuple[Path, ...]:
    """Write ``city.net.xml``, ``city.rou.xml`` and ``city.sumocfg``; run ``sumo -c city.sumocfg``.

    The routes are those of the vehicles whose tracks the city holds, each setting out when and
    where its track begins; a city without tracks gets a file without vehicles. The same city gives
    the same bytes.

    Parameters
    ----------
    city
        City with a road network and lanes.
    halts
        Where traffic halts.
    folder
        Where to write them.

    Raises
    ------
    InputError
        If nothing drives in the city.
    MissingExtra, EngineError
        If SUMO is absent or refuses the streets.
    """
    require_sumo()
    streets = divided(streets_of(city, halts.with_bare(), against=True), halts, city)
    folder.mkdir(parents=True, exist_ok=True)
    with TemporaryDirectory(prefix="cityx-traffic-") as name:
        network = make_network(
            with_paths(streets, city), city.frame, Path(name), said=street_names(city)
        )
        with replaced(folder / NET) as temporary:
            copyfile(network.file, temporary)
    run = Run(warm=0.0)
    if city.tracks is not None:
        run = _run_of(city.tracks, Drivable(city, streets))
    for path, text in ((folder / ROUTES, routes_text(run)), (folder / CONFIG, config(run))):
        with replaced(path) as temporary:
            temporary.write_text(text)
    return tuple(folder / file for file in FILES)


def config(run: Run) -> str:
    """Return the configuration of a run."""
    sections: dict[str, dict[str, object]] = {
        "input": {"net-file": NET, "route-files": ROUTES},
        "time": {"begin": 0, "end": f"{run.duration:g}", "step-length": f"{STEP:g}"},
        "processing": {"lanechange.duration": 2, "collision.check-junctions": "true"},
    }
    lines = ["<configuration>"]
    for section, options in sections.items():
        lines.append(f"    <{section}>")
        lines += [f'        <{key} value="{value}"/>' for key, value in options.items()]
        lines.append(f"    </{section}>")
    return "\n".join([*lines, "</configuration>", ""])


def _run_of(tracks: Tracks, net: Drivable) -> Run:
    """Return the run that brings the vehicles of tracks to where they were."""
    graph = net.city.lanes
    assert graph is not None
    places: dict[int, list[int]] = {}  # a lane is on several ways where people cross it
    for number, way in enumerate(net.streets.ways):
        for lane in way.lanes:
            places.setdefault(int(graph.lane_id[lane.row]), []).append(number)
    looks: dict[str, Look] = {}
    trips = []
    for row in range(tracks.count):
        kind = MOVER_KINDS[tracks.kind[row]]
        if kind not in DRIVING:
            continue
        look = str(tracks.look[row])
        length, width, height = (round(float(value), 3) for value in tracks.size[row])
        looks.setdefault(look, Look(look, kind, (length, width, height)))
        part = slice(tracks.sample_start[row], tracks.sample_start[row + 1])
        driven = (places[own] for own in tracks.place[part].tolist() if own in places)
        route = _route(net, (way for ways, _ in groupby(driven) for way in ways))
        if route:
            trips.append(
                Trip(id_text(int(tracks.object_id[row])), list(looks).index(look),
                     tuple(net.streets.ways[way].name for way in route),
                     depart=float(tracks.time[part][0]), rolling=bool(tracks.speed[part][0] > 1.0))
            )  # fmt: skip
    return Run(tuple(looks.values()), trips=tuple(trips), warm=0.0, duration=tracks.duration)


def _route(net: Drivable, places: Iterable[int]) -> list[int]:
    """Join the ways that a track is on; what it crossed between two samples is filled in."""
    route: list[int] = []
    for way in places:
        if not route:
            route.append(way)
        elif way != route[-1]:
            between = route_between(net, route[-1], way)
            if between is None:
                return route
            route += between[1:]
    return route
