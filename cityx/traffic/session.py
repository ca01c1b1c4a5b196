"""One run on the streets of a city: network, simulation and tracks, in a folder of its own."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from cityx.city.city import City
from cityx.city.signals import Signals
from cityx.city.tracks import Tracks
from cityx.ids import id_text
from cityx.traffic.ghosts import ghosts_of
from cityx.traffic.network import make_network
from cityx.traffic.recording import Mover, recorded
from cityx.traffic.signal_programs import signals_of
from cityx.traffic.simulation import Outcome, Run, simulate
from cityx.traffic.streets import Streets


@dataclass(frozen=True)
class Driven:
    """What a run on the streets of a city came to.

    Attributes
    ----------
    tracks
        Of the movers.
    signals
        What signals show meanwhile.
    outcome
        As the engine tells it.
    """

    tracks: Tracks
    signals: Signals | None
    outcome: Outcome


def driven(
    city: City, streets: Streets, run: Run, movers: Mapping[str, Mover], origin: str,
    others: Tracks | None,
) -> Driven:  # fmt: skip
    """Simulate a run on the streets of a city, among what moves there already.

    That drives and walks as it did before: those of this run give way.

    Parameters
    ----------
    city, streets
        The city and its streets.
    run
        Who sets out.
    movers
        What is seen of those whose tracks are kept, by name.
    origin
        Id of the action that puts them there.
    others
        What moves there already, None for nothing.

    Raises
    ------
    InputError
        If nothing drives in the city.
    MissingExtra, EngineError
        If SUMO is absent, refuses the streets or fails.
    """
    with TemporaryDirectory(prefix="cityx-traffic-") as name:
        network = make_network(streets, city.frame, Path(name), said=street_names(city))
        ghosts = ghosts_of(others, streets, network, run)
        outcome = simulate(run, network, ghosts)
        signals = signals_of(city, streets, network, run.warm)
    tracks = recorded(city, streets, network, outcome.poses, movers, origin, others)
    return Driven(tracks, signals, outcome)


def street_names(city: City) -> Callable[[str], str]:
    """Return what says of the id of an edge which street it is."""
    network, roads = city.network, city.layout.roads
    assert network is not None
    names = map(id_text, network.edge_id.tolist())
    rows = dict(zip(names, network.edge_road.tolist(), strict=True))

    def said(edge: str) -> str:
        if edge not in rows:
            return "no street of the city"
        road = roads.iloc[rows[edge]]
        return " ".join(str(word) for word in (road["kind"], road["name"], road["source"]) if word)

    return said
