"""Makers: a stored city and shots go in, records come out."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from time import perf_counter
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from numpy.typing import NDArray

from cityx.dataset.channels import CYCLES, TRUTH
from cityx.dataset.order import Order
from cityx.dataset.record import Record
from cityx.dataset.shots import Shot

if TYPE_CHECKING:
    from cityx.dataset.stage import Stage

Pair = tuple[Shot, Shot | None]  # a shot, and the next of its sensor in its sequence
Maker = Callable[[Sequence[Pair]], Iterator[Record]]
# Opens a stored city; top level, so that it can be sent to other processes.
Opener = Callable[[Path, Order], Maker]
SECONDS = "seconds"  # among the facts of a record: maker to seconds; kept out of the files
HELD = 2  # moments whose scene is kept: that of a shot and of the next of its sequence


def open_city(store: Path, order: Order) -> Maker:
    """Open a stored city for the ray caster, and for Blender when it has channels to make."""
    return _CityMaker(store, order)


class _CityMaker:
    """Keeps the scene from shot to shot, anew only what moves."""

    def __init__(self, store: Path, order: Order) -> None:
        from cityx.city.store import read_view
        from cityx.dataset.stage import stage_of

        self._store, self._order = store, order
        self._view = read_view(store)
        self._still = stage_of(self._view, None)
        self._stages: dict[float, Stage] = {}

    def __call__(self, pairs: Sequence[Pair]) -> Iterator[Record]:
        order = self._order
        pictures = self._pictures([shot for shot, _ in pairs])
        for shot, after in pairs:
            began = perf_counter()
            record = self._truth(shot, after)
            seconds = {TRUTH: perf_counter() - began}
            facts: Mapping[str, Any] = record.facts
            channels = dict(record.channels)
            if order.made_by(CYCLES):
                began = perf_counter()
                made, said = next(pictures)
                channels |= made
                facts = {**facts, **said}
                seconds[CYCLES] = perf_counter() - began
            yield replace(record, channels=MappingProxyType(channels),
                          facts=MappingProxyType({**facts, SECONDS: seconds}))  # fmt: skip

    def _truth(self, shot: Shot, after: Shot | None) -> Record:
        from cityx.dataset.truth import truth

        order = self._order
        stage = self._stage(shot)
        return truth(
            stage, shot, order.made_by(TRUTH), after=after,
            later=self._stage(after) if after is not None else None,
        )  # fmt: skip

    def _stage(self, shot: Shot) -> Stage:
        """Return the scene at the moment of a shot, kept for the other cameras of the rig."""
        from cityx.dataset.stage import stage_of

        if shot.moment not in self._stages:
            while len(self._stages) >= HELD:
                self._stages.pop(next(iter(self._stages)))
            self._stages[shot.moment] = stage_of(self._view, shot.moment, still=self._still)
        return self._stages[shot.moment]

    def _pictures(
        self, shots: Sequence[Shot]
    ) -> Iterator[tuple[Mapping[str, NDArray[Any]], Mapping[str, Any]]]:
        raise NotImplementedError
