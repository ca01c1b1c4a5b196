"""The process of SUMO for a simulator: ``python -m cityx.motion.live_traffic STORE DENSITY``."""

from __future__ import annotations

import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from cityx.city import City
from cityx.city.store import read_city
from cityx.errors import CityxError
from cityx.motion.traffic import run_of
from cityx.motion.vehicles import driven_streets
from cityx.traffic.engine import require_sumo
from cityx.traffic.live import TYPE, Live, say, serve
from cityx.traffic.network import Network, make_network
from cityx.traffic.session import street_names
from cityx.traffic.simulation import ROUTES, job_of, routes_text
from cityx.traffic.streets import Streets

LASTS = 600.0  # seconds for which there are vehicles to be sent


def main(store: str, density: float) -> int:
    """Say that all is ready, or why not, then answer until nobody asks."""
    try:
        require_sumo()
        city = read_city(Path(store))
        with TemporaryDirectory(prefix="cityx-traffic-") as name:
            live = _live(city, density, Path(name))
            say({"ready": True})
            serve(live, sys.stdin.readline)
    except CityxError as error:
        say({"kind": type(error).__name__, "message": str(error)})
        return 1
    return 0


def _live(city: City, density: float, folder: Path) -> Live:
    streets = driven_streets(city)
    run = run_of(city, streets, LASTS, per_km=density * lanes_a_street(streets))
    network = make_network(streets, city.frame, folder, said=street_names(city))
    (folder / ROUTES).write_text(routes_text(run, (TYPE,)))
    return Live(job_of(run, network), _places(city, streets, network))


def lanes_a_street(streets: Streets) -> float:
    """Return how many metres of lanes for any car there are on a metre of street.

    Parameters
    ----------
    streets
        Both directions of a street are one metre of it.
    """
    lanes, edges = 0.0, {}
    for way in streets.ways:
        edges[way.edge] = way.length
        lanes += sum(lane.length for lane in way.lanes
                     if lane.kind == "drive" and lane.public and not lane.closed)  # fmt: skip
    return lanes / max(sum(edges.values()), 1e-9)


def _places(city: City, streets: Streets, network: Network) -> dict[str, tuple[int, int]]:
    """Return the lane of each lane of SUMO, or the two that a way across joins."""
    assert city.lanes is not None
    ids = city.lanes.lane_id.tolist()

    def own(way: int, index: int) -> int:
        found: int = ids[streets.ways[way].lanes[index].row]
        return found

    found = {name: (own(*place), 0) for name, place in network.lanes.items()}
    for name, number in network.links.items():
        link = streets.links[number]
        found[name] = (own(*link.source), own(*link.target))
    return found


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], float(sys.argv[2])))
