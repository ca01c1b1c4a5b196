"""What is counted of each shot, and the sums that the card and the page show."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from cityx.dataset.record import Record

# Metres between which depths are counted; the sky is beyond the last.
DEPTHS = (0.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0, float("inf"))
VISIBLE = 10  # bins of visibility


def counted(record: Record) -> dict[str, Any]:
    """Return what is counted of a shot, as JSON."""
    found: dict[str, Any] = {"pixels": record.shot.camera.width * record.shot.camera.height}
    semantic = record.channels.get("semantic")
    if semantic is not None:
        numbers, counts = np.unique(semantic, return_counts=True)
        found["classes"] = {str(n): int(c) for n, c in zip(numbers, counts, strict=True)}
    depth = record.channels.get("depth", record.channels.get("distance"))
    if depth is not None:
        finite = depth[np.isfinite(depth)]
        counts, _ = np.histogram(finite, np.minimum(DEPTHS, np.finfo(np.float32).max))
        found["depths"] = [*counts.tolist(), int(depth.size - finite.size)]
    if record.boxes is not None:
        boxes = record.boxes
        found["boxes"] = {str(n): c for n, c in sorted(Counter(boxes.semantic.tolist()).items())}
        bins = np.clip((boxes.visibility * VISIBLE).astype(int), 0, VISIBLE - 1)
        found["visibility"] = np.bincount(bins, minlength=VISIBLE).tolist()
    if record.segments:
        found["segments"] = len(record.segments)
    if record.sweep is not None:
        found["points"] = len(record.sweep.beam)
    if record.shot.environment is not None:
        light = record.shot.environment
        found["light"] = f"{light.weather}, {int(light.hour):02d} h"
    return found


@dataclass
class Totals:
    """Sums over shots; mutable because shots are added one by one.

    Attributes
    ----------
    shots, pixels, segments, points
        How many.
    classes, boxes
        Class number to pixels, and to boxes.
    depths, visibility
        How many pixels and boxes in each bin.
    cities, lights
        Name, and weather with hour, to shots.
    """

    shots: int = 0
    pixels: int = 0
    segments: int = 0
    points: int = 0
    classes: Counter[int] = field(default_factory=Counter)
    boxes: Counter[int] = field(default_factory=Counter)
    depths: list[int] = field(default_factory=lambda: [0] * len(DEPTHS))
    visibility: list[int] = field(default_factory=lambda: [0] * VISIBLE)
    cities: Counter[str] = field(default_factory=Counter)
    lights: Counter[str] = field(default_factory=Counter)

    def add(self, city: str, statistics: Mapping[str, Any]) -> None:
        """Add a shot."""
        self.shots += 1
        self.cities[city] += 1
        self.pixels += statistics["pixels"]
        self.segments += statistics.get("segments", 0)
        self.points += statistics.get("points", 0)
        for name, sums in (("classes", self.classes), ("boxes", self.boxes)):
            sums.update({int(key): value for key, value in statistics.get(name, {}).items()})
        for name, bins in (("depths", self.depths), ("visibility", self.visibility)):
            for index, value in enumerate(statistics.get(name, ())):
                bins[index] += value
        if "light" in statistics:
            self.lights[statistics["light"]] += 1


def totals(statistics: Iterable[tuple[str, Mapping[str, Any]]]) -> Totals:
    """Sum the statistics of shots, given as city and what `counted` returned."""
    found = Totals()
    for city, values in statistics:
        found.add(city, values)
    return found
