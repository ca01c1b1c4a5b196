"""Ponds: rounded waters dug where a park has most room."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city import Layout
from cityx.ids import uniform

GREENS = ("park", "garden", "grass", "meadow", "golf", "cemetery")
SIZES = {"small": 330.0, "medium": 600.0, "large": 1500.0}  # square metres
BANK = 1.5  # metres of lawn between the water and paths, trunks, walls and the edge of the park
LOBES, CORNERS = 3, 48  # of the outline of a pond
UNEVEN = 0.10  # of its radius, by which each lobe goes in and out
STEP = 2.0  # metres between the middles that are tried
PURPOSE = "edit/pond-v1"  # of the random numbers of an outline


def dug(
    layout: Layout, park: Any, wanted: float, key: int, *, seed: int, taken: Sequence[Any] = (),
    about: Any = None,
) -> tuple[Any, float]:  # fmt: skip
    """Return the outline of a pond where a park has most room, and how large one may be.

    Parameters
    ----------
    park
        Outline of a park, a garden or a lawn.
    wanted
        Square metres.
    key
        Id of the park, which the form of the outline follows from.
    taken
        Ground to keep clear of, besides ways, houses and the edge of the park.
    about
        Ground in which the middle of the pond lies; anywhere in the park when left out.

    Returns
    -------
    outline
        None where there is no room.
    most
        Square metres.
    """
    free = shapely.difference(park, shapely.union_all([*_taken(layout, park), *taken]))
    if shapely.is_empty(free):
        return None, 0.0
    low, high = np.array(shapely.bounds(free)[:2]), np.array(shapely.bounds(free)[2:])
    x, y = (np.arange(a, b, STEP) for a, b in zip(low, high, strict=True))
    at = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
    spots = shapely.points(at)
    inside = shapely.contains(free, spots) if len(spots) else np.zeros(0, bool)
    if about is not None:
        inside = inside & shapely.intersects(spots, about)
    if not inside.any():
        return None, 0.0
    reach = np.where(inside, shapely.distance(shapely.boundary(free), spots), 0.0)
    best = int(np.argmax(np.round(reach, 3)))
    radius = float(np.sqrt(wanted / np.pi))
    most = float(np.pi * (reach[best] / (1 + UNEVEN)) ** 2)
    return (None if wanted > most else _outline(at[best], radius, seed, key)), most


def _taken(layout: Layout, park: Any) -> list[Any]:
    """Return the ground of a park that its ways and houses, waters and its edge take."""
    roads, areas = layout.roads, layout.areas
    half = np.nan_to_num(roads["width"].to_numpy(float), nan=2.0) / 2
    near = shapely.dwithin(roads.geometry.to_numpy(), park, float(half.max(initial=0.0)))
    wet = areas.geometry.to_numpy()[(areas["kind"] == "water").to_numpy()]
    found = [*shapely.buffer(roads.geometry.to_numpy()[near], half[near] + BANK)]
    found += [*shapely.buffer(layout.buildings.geometry.to_numpy(), BANK)]
    found += [*shapely.buffer(wet, 2 * BANK)]
    held = np.array([shapely.buffer(shapely.boundary(park), BANK), *found], object)
    return list(held[shapely.intersects(held, park)])


def _outline(middle: NDArray[np.float64], radius: float, seed: int, key: int) -> Any:
    """Return a rounded outline of a pond, of the area of a circle."""
    angle = np.arange(CORNERS) * (2 * np.pi / CORNERS)
    lobe = np.arange(2, 2 + LOBES)
    phase = 2 * np.pi * uniform(seed, PURPOSE, np.full(LOBES, key, np.uint64), lobe)
    wave = np.sin(lobe[:, None] * angle + phase[:, None]).sum(axis=0) * (UNEVEN / LOBES)
    ring = middle + (radius * (1 + wave))[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    return shapely.Polygon(np.round(ring, 3))
