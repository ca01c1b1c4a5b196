"""Coverage: how much of a city's streets shots see, and where they look."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.camera import project
from cityx.dataset.plans.street_stretches import street_lines
from cityx.dataset.shots import Shot
from cityx.geometry.polylines import arc_lengths, every, locate
from cityx.ground.standing import stand_on

if TYPE_CHECKING:
    from cityx.city.city import City
    from cityx.dataset.stage import Stage

EVERY = 5.0  # metres of street between the places that are looked for
ABOVE = 0.3  # metres above the street where they lie
PIXELS = 4.0  # that a metre of street is wide in a picture that shows it
COMPASS = ("north", "north-east", "east", "south-east", "south", "south-west", "west", "north-west")


@dataclass(frozen=True)
class Coverage:
    """What shots see of a city.

    Attributes
    ----------
    street
        Metres of street on the site that lie on the ground.
    seen
        Metres of them that some shot shows, unhidden and large enough to make out.
    headings
        (8,) int64, shots by the eighth of the compass that they look to, see `COMPASS`.
    """

    street: float
    seen: float
    headings: NDArray[np.int64]

    @property
    def share(self) -> float:
        """Share of the streets that is seen; 0 where there are none."""
        return self.seen / self.street if self.street else 0.0


def coverage_of(city: City, stage: Stage, shots: Sequence[Shot]) -> Coverage:
    """Measure what shots see.

    Parameters
    ----------
    city
        The city.
    stage
        Its scene; what moves hides nothing for long and may be left out.
    shots
        The shots.
    """
    turn = 2 * np.pi / len(COMPASS)
    eighth = np.array(
        [round(shot.camera.heading / turn) % len(COMPASS) for shot in shots], np.int64
    )
    headings = np.bincount(eighth, minlength=len(COMPASS)).astype(np.int64)
    if city.network is None:
        return Coverage(0.0, 0.0, headings)
    lines, rows = street_lines(city.network, city.layout.extent)
    length = np.zeros(lines.count)
    length[rows] = arc_lengths(lines)[1][rows]
    line, along = every(length, EVERY)
    kept = np.isin(line, rows)
    line, along = line[kept], along[kept]
    spot = locate(lines, line, along)[0]
    z = stand_on(city.scene.meshes.get("ground"), spot).z
    height = np.where(np.isnan(z), city.terrain.height_at(spot), z)
    places = np.column_stack([spot, height + ABOVE])
    # Each place stands for as much of its street as there is between it and its neighbours.
    part = length[line] / np.maximum(np.bincount(line, minlength=lines.count), 1)[line]
    seen = _seen(stage, shots, places)
    return Coverage(float(part.sum()), float(part[seen].sum()), headings)


def _seen(stage: Stage, shots: Sequence[Shot], places: NDArray[np.float64]) -> NDArray[np.bool_]:
    """(n,) whether some shot shows each place."""
    found = np.zeros(len(places), bool)
    if not len(places):
        return found
    tree = shapely.STRtree(shapely.points(places[:, :2]))
    for shot in shots:
        camera = shot.camera
        eye = np.array(camera.position)
        reach = camera.width / 2 / np.tan(camera.hfov / 2) / PIXELS
        near = tree.query(shapely.Point(eye[:2]), predicate="dwithin", distance=reach)
        near = np.sort(near[~found[near]])
        pixel, depth = project(camera, places[near])
        inside = (depth > 0) & (depth < reach)
        inside &= (pixel >= 0).all(axis=1) & (pixel < (camera.width, camera.height)).all(axis=1)
        near = near[inside]
        way = places[near] - eye
        free = stage.cast(np.broadcast_to(eye, way.shape), way).distance > 1.0
        found[near[free]] = True
    return found
