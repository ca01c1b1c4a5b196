"""The actions that build a tile: those of a city after its layout, less what is of a whole site."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from cityx.agents.planning.workflow import Item
from cityx.city import City
from cityx.options import BuildOptions
from cityx.projects.build import make_job
from cityx.protocol.input_files import InputFiles
from cityx.protocol.registry import registry
from cityx.protocol.running import run_action

# The layout and the terrain are there already; traffic and the rim of land are of a whole site.
SKIPPED = ("layout/", "terrain/", "dynamic/", "background/")


def plan_of(paths: Iterable[Path], lod: int, seed: int = 0) -> tuple[Item, ...]:
    """Return the actions of a build after its layout and terrain; traffic is left out."""
    job = make_job(list(paths), BuildOptions(lod=lod, seed=seed))
    try:
        items = job.first_plan()
    finally:
        job.roles.close()
    return tuple(item for item in items if not item.action.startswith(SKIPPED))


def built(city: City, items: Iterable[Item]) -> City:
    """Run actions on a city in memory."""
    actions = registry()
    for item in items:
        city = run_action(city, item.call, actions, inputs=InputFiles()).city
    return city
