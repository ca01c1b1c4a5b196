"""Makers: a stored city and shots go in, records come out."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from time import perf_counter
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple

from cityx.dataset.channels import CYCLES, TRUTH
from cityx.dataset.order import Order
from cityx.dataset.record import Record
from cityx.dataset.shots import Shot
from cityx.errors import EngineError

if TYPE_CHECKING:
    from cityx.dataset.stage import Stage

SECONDS = "seconds"  # among the facts of a record: maker to seconds; kept out of the files
HELD = 2  # moments whose scene is kept: that of a shot and of the next of its sequence


class Wanted(NamedTuple):
    """A shot that is to be taken.

    Attributes
    ----------
    shot
        The shot.
    after
        The next of its sensor in its sequence, or None.
    sweep
        Whether its camera carries the LiDAR.
    """

    shot: Shot
    after: Shot | None = None
    sweep: bool = False


Maker = Callable[[Sequence[Wanted]], Iterator[Record]]
# Opens a stored city with so many threads; top level, so that it can be sent to other processes.
Opener = Callable[[Path, Order, int], Maker]


def open_city(store: Path, order: Order, threads: int = 1) -> Maker:
    """Open a stored city for the ray caster, and for Blender when it has channels to make."""
    return _CityMaker(store, order, threads)


class _CityMaker:
    """Keeps the scene from shot to shot, anew only what moves."""

    def __init__(self, store: Path, order: Order, threads: int) -> None:
        from cityx.city.store import read_view

        self._store, self._order, self._threads = store, order, threads
        self._view = read_view(store)
        self._still: dict[bool, Stage] = {}  # by whether it is a winter's day
        self._stages: dict[tuple[float, bool], Stage] = {}

    def __call__(self, wanted: Sequence[Wanted]) -> Iterator[Record]:
        order = self._order
        pictures = self._pictures([item.shot for item in wanted]) if order.made_by(CYCLES) else None
        for item in wanted:
            began = perf_counter()
            shot_name = item.shot.name
            record = self._truth(item)
            seconds = {TRUTH: perf_counter() - began}
            facts: Mapping[str, Any] = record.facts
            channels = dict(record.channels)
            if pictures is not None:
                began = perf_counter()
                picture = next(pictures)
                if picture.shot.name != shot_name:
                    raise EngineError(f"Blender ended again and again at {shot_name}.")
                channels |= picture.channels
                facts = {**facts, **picture.facts}
                seconds[CYCLES] = perf_counter() - began
            yield replace(record, channels=MappingProxyType(channels),
                          facts=MappingProxyType({**facts, SECONDS: seconds}))  # fmt: skip

    def _truth(self, item: Wanted) -> Record:
        from cityx.dataset.lidar import lidar_named, sweep_of
        from cityx.dataset.truth import truth

        order, shot, after = self._order, item.shot, item.after
        stage = self._stage(shot)
        later = self._stage(after) if after is not None else None
        record = truth(
            stage, shot, order.made_by(TRUTH), after=after, later=later,
            boxes=order.wants_boxes, threads=self._threads,
        )  # fmt: skip
        if not item.sweep:
            return record
        lidar = lidar_named(order.lidar)
        return replace(record, sweep=sweep_of(stage, shot, lidar, after=after,
                                              threads=self._threads))  # fmt: skip

    def _stage(self, shot: Shot) -> Stage:
        """Return the scene at the moment of a shot, kept for the other cameras of the rig."""
        from cityx.assets.trees.seasons import SNOWED
        from cityx.dataset.stage import stage_of

        light = shot.environment or self._view.environment
        bare = light.snow > SNOWED
        key = (shot.moment, bare)
        if key not in self._stages:
            while len(self._stages) >= HELD:
                self._stages.pop(next(iter(self._stages)))
            view = replace(self._view, environment=light)
            made = stage_of(view, shot.moment, still=self._still.get(bare))
            self._still[bare] = made.still or made
            self._stages[key] = made
        return self._stages[key]

    def _pictures(self, shots: Sequence[Shot]) -> Iterator[Record]:
        from cityx.dataset.pictures import chosen_quality, pictures

        order = self._order
        quality = chosen_quality(order.quality, samples=order.samples)
        return pictures(self._store, shots, order.made_by(CYCLES), quality)
