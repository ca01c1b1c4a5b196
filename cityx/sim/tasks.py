"""Tasks: what environments there are, by name, and the engine of each."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path
from types import MappingProxyType
from typing import Any

from cityx.errors import UsageError, nearest
from cityx.sim.engine import Engine
from cityx.sim.fleet import Mixed
from cityx.sim.options import (
    RULES,
    ContactOptions,
    DriveOptions,
    ExploreOptions,
    FleetOptions,
    FlyOptions,
    Options,
    WalkOptions,
    options_of,
)
from cityx.sim.places import TILES, scenery_of, walks_of, world_of
from cityx.sim.roamers import Flyers, Roamers

DRIVE, CONTACT = "CityX/Drive-v0", "CityX/Contact-v0"
PLACED = ("place", "text", "seed_town", "town_size", "at", "to")  # options that say where
JOURNEYS = "cityx.tiles.journey"  # module of a layer above, loaded when one is asked for
JOURNEY_STEPS = 72_000  # of an episode that goes over tiles, at most, where options do not say it


@dataclass(frozen=True)
class Task:
    """A kind of environment.

    Attributes
    ----------
    name
        By which Gymnasium knows it.
    options
        What is usual.
    engine
        Makes its engine of world and walks, scenery where it needs one, options, number of worlds
        and of threads.
    """

    name: str
    options: Options
    engine: Callable[..., Engine]


def _contacts(*given: Any) -> Engine:
    from cityx.sim.contact.engine import Contacts

    return Contacts(*given)


TASKS: Mapping[str, Task] = MappingProxyType({
    task.name: task for task in (
        Task(DRIVE, DriveOptions(), Engine),
        Task("CityX/Deliver-v0", WalkOptions(), Roamers),
        Task("CityX/Walk-v0", WalkOptions(vehicle="person", people=40), Roamers),
        Task("CityX/Fly-v0", FlyOptions(), Flyers),
        Task("CityX/Explore-v0", ExploreOptions(), Roamers),
        Task(CONTACT, ContactOptions(), _contacts),
    )
})  # fmt: skip


def task_of(name: str) -> Task:
    """Return a task by its name, or by the word in it.

    Raises
    ------
    UsageError
        If there is none; the message has the nearest name.
    """
    short = {each.split("/")[1].split("-")[0].lower(): each for each in TASKS}
    found = TASKS.get(short.get(name.lower(), name))
    if found is None:
        raise UsageError(
            f'There is no environment "{name}"; known are {", ".join(TASKS)}.{nearest(name, TASKS)}'
        )
    return found


def placed_by(given: Mapping[str, Any]) -> dict[str, Any]:
    """Return what options say of a place that is to be built, as `cityx.sim.places` takes it."""
    return {"text": given.get("text", ""), "seed": given.get("seed_town", 0),
            "size": given.get("town_size"), "at": given.get("at", "")}  # fmt: skip


def engine_of(name: str, worlds: int, threads: int, given: Mapping[str, Any]) -> Engine:
    """Make the engine of a task from all its options; they are checked before anything is built.

    Raises
    ------
    InputError, UsageError
        If the place or an option is of no use.
    """
    task = task_of(name)
    own = {key: value for key, value in given.items() if key not in PLACED}
    options = options_of(own, task.options)
    if given.get("to"):
        if worlds > 1:
            raise UsageError(f"to is given; a journey has one world of its own, not {worlds}.")
        return _journey(task, replace(options, horizon=own.get("horizon", JOURNEY_STEPS)), given)
    return begun(task, options, given.get("place"), worlds, threads, **placed_by(given))


def _journey(task: Task, options: Options, given: Mapping[str, Any]) -> Engine:
    """Make the engine of a drive over tiles, of which those about the agent are loaded."""
    place = given.get("place")
    if not isinstance(options, DriveOptions):
        raise UsageError(f'to is "{given["to"]}"; only {DRIVE} drives over tiles, not {task.name}.')
    if not isinstance(place, (str, Path)) or not (Path(place) / TILES).is_file():
        raise UsageError(f'to is "{given["to"]}"; a journey needs a folder of tiles as its place.')
    if unused := [name for name in ("text", "seed_town", "town_size") if given.get(name)]:
        raise UsageError(f"A journey says by at and to where it goes; leave out {unused[0]}.")
    if not given.get("at"):
        raise UsageError("to is given; at says where the journey begins.")
    engine: Engine = import_module(JOURNEYS).journey_engine(
        place, given["at"], given["to"], options
    )
    return engine


def fleet_of(given: Mapping[str, Any]) -> Mixed:
    """Make the engine of a fleet of mixed bodies from all its options, as `engine_of` does.

    Raises
    ------
    InputError, UsageError
        If the place or an option is of no use.
    """
    if given.get("to"):
        raise UsageError(f'to is "{given["to"]}"; only {DRIVE} drives over tiles, not a fleet.')
    own = {key: value for key, value in given.items() if key not in PLACED}
    options = options_of(own, FleetOptions())
    return Mixed(*walks_of(given.get("place"), **placed_by(given)), options)


def begun(
    task: Task, options: Options, place: Any, worlds: int = 1, threads: int = 1, **placed: Any
) -> Engine:
    """Make the engine of a task in a place; `placed` as `cityx.sim.places.world_of` takes it.

    Raises
    ------
    InputError, UsageError
        If the place is of no use.
    """
    if not isinstance(options, DriveOptions):
        seen = walks_of(place, **placed)
        if isinstance(options, ContactOptions):
            scenery = scenery_of(place, seen[0], **placed)
            return task.engine(*seen, scenery, options, worlds, threads)
        return task.engine(*seen, options, worlds, threads)
    world, walks = (
        walks_of(place, **placed) if options.people else (world_of(place, **placed), None)
    )
    source = None
    if options.source != RULES:
        from cityx.sim.sources import source_of

        source = source_of(place, world, options, **placed)
    return task.engine(world, options, worlds, threads, walks, source)
