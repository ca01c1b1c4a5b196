"""Ends: what stands at the end of a pier, a street, a row, and where that end is."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.checks.predicates import words
from cityx.checks.predicates.facts import Facts, Options, said
from cityx.checks.predicates.finding import Measured
from cityx.checks.predicates.vocabulary import Group
from cityx.city import Layout
from cityx.city.layout import of_kinds

AT_END, AT_STREET_END = 30.0, 80.0  # metres from an end, and that of a street, to what is at it


def at_end(facts: Facts, groups: tuple[Group, ...], _: Options) -> Measured:
    """Return whether some of the first stand at an end of one of the second."""
    first, second = (facts.select(group) for group in groups)
    ends = ends_of(second.shapes, facts.city.layout)
    if not len(ends) or not len(first.rows):
        return Measured(False, f"there are {said(first)} and {said(second)}")
    away = shapely.distance(first.shapes, shapely.multipoints(ends))
    return Measured(
        bool((away <= reach_of(second.shapes)).any()),
        f"the nearest of {said(first)} is {away.min():.1f} m from an end of {said(second)}",
    )


def reach_of(shapes: NDArray[Any]) -> float:
    """Return how far what stands at the end of long things may be from it, metres."""
    return AT_STREET_END if (shapely.get_dimensions(shapes) == 1).all() else AT_END


def ends_of(shapes: NDArray[Any], layout: Layout) -> NDArray[np.float64]:
    """Return the ends of long things.

    Streets that meet are one line, whose ends lie farthest apart. A pier has its end in the water.

    Parameters
    ----------
    shapes
        (n,) lines or polygons, scene frame.

    Returns
    -------
    ends
        (k, 2) float, metres.
    """
    shapes = shapes[shapely.get_dimensions(shapes) > 0]  # a point has no ends
    if not len(shapes):
        return np.zeros((0, 2))
    if (shapely.get_dimensions(shapes) == 1).all():
        shapes = np.array([shapely.convex_hull(shapely.union_all(shapes))], object)
        points = shapely.get_coordinates(shapes)
        far = np.hypot(*(points[:, None] - points[None]).transpose(2, 0, 1))
        one, other = np.unravel_index(int(np.argmax(np.round(far, 3))), far.shape)
        return np.stack([points[one], points[other]])
    found = np.concatenate([_of_strip(shape) for shape in shapes.tolist()])
    water = layout.areas.geometry.to_numpy()[of_kinds(layout.areas, words.LANDS["water"])]
    wet = shapely.contains_xy(shapely.union_all(water), *found.T)
    return np.asarray(found[wet] if wet.any() else found)


def _of_strip(shape: Any) -> NDArray[np.float64]:
    """Return the middles of the two short sides of the box around a shape, (2, 2)."""
    box = shapely.minimum_rotated_rectangle(shape)
    if shapely.get_dimensions(box) == 1:
        return np.asarray(shapely.get_coordinates(box)[[0, -1]])  # of a straight line
    ring = shapely.get_coordinates(box)[:4]
    sides = np.hypot(*np.diff(ring[:3], axis=0).T)
    first = 1 if sides[0] > sides[1] else 0
    one, other = ring[first : first + 2], np.roll(ring, -2, axis=0)[first : first + 2]
    return np.stack([one.mean(axis=0), other.mean(axis=0)])
