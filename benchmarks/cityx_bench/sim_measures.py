"""All bars of the simulator by their numbers, and the places that they are measured in."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from cityx.errors import InputError, UsageError
from cityx.sim.places import store_of, walks_of, world_of
from cityx_bench import sim_drives, sim_rates, sim_rules
from cityx_bench.sim_bars import Measure, Place

MEASURES: Mapping[int, Measure] = {
    1: sim_rates.rates, 2: sim_rates.large, 3: sim_drives.routes, 4: sim_drives.arrivals,
    5: sim_drives.traffic, 6: sim_rates.cameras, 7: sim_rates.lidar, 8: sim_rates.contact,
    9: sim_rules.same_bytes, 10: sim_rules.checkers, 11: sim_rules.beginnings,
    12: sim_drives.learning, 13: sim_drives.every_map, 14: sim_rules.replays,
}  # fmt: skip


def placed(paths: Sequence[Path]) -> list[Place]:
    """Return places with their worlds and walks, built and compiled where none are kept.

    Raises
    ------
    InputError, UsageError
        If one cannot be built, or nobody can drive there.
    """
    found = []
    named: list[Path | None] = [*paths] or [None]
    for path in named:
        store = store_of(path)
        world = world_of(store)
        try:
            walks = walks_of(store)[1]
        except (InputError, UsageError):
            walks = None
        name = "town" if path is None else path.name.split(".")[0]
        found.append(Place(name, store, world, walks))
    return found
