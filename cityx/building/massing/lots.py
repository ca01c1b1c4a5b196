"""Lots: plans of houses in the frame of their street, cut into rectangles, cheap by the thousand.

Houses are boxes before they are anything else: a main body, a porch, a garage, a lean-to. A lot
knows which way the street lies and turns rectangles given in metres into plans.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.building.massing.massing import Mass, Plot

WHOLE = 0.997  # share of its box from which a plan counts as the box itself
SQUARE = 0.9  # share of its box from which a plan may be cut like one
SHRED = 0.6  # square metres; a smaller cutting is left out

Box = tuple[float, float, float, float]


@dataclass(frozen=True)
class Lot:
    """A plan seen from its street: x to the right along it, y towards it, the middle at (0, 0).

    Attributes
    ----------
    plan
        The outline, in the scene.
    middle, right, front
        (2,) each, in the scene: middle of the box around it, and unit vectors.
    length, depth
        Metres of the box along x and y.
    fill
        Share of the box that the plan takes.
    """

    plan: Any
    middle: NDArray[np.float64]
    right: NDArray[np.float64]
    front: NDArray[np.float64]
    length: float
    depth: float
    fill: float

    @property
    def x(self) -> float:
        """Half the length."""
        return self.length / 2

    @property
    def y(self) -> float:
        """Half the depth."""
        return self.depth / 2

    @property
    def narrow(self) -> float:
        """Metres of the shorter side."""
        return min(self.length, self.depth)

    @property
    def boxy(self) -> bool:
        """Whether the plan may be cut into rectangles."""
        return self.fill >= SQUARE

    def place(self, points: Any) -> NDArray[np.float64]:
        """Take points, (..., 2), from the lot's frame into the scene."""
        at = np.asarray(points, float)
        return np.asarray(self.middle + at[..., :1] * self.right + at[..., 1:] * self.front)

    def outlines(self, boxes: Sequence[Box]) -> list[Any]:
        """Return rectangles (x0, y0, x1, y1) as plans within the outline."""
        at = np.asarray(boxes, float)
        corner = np.stack([at[:, [0, 1]], at[:, [2, 1]], at[:, [2, 3]], at[:, [0, 3]]], axis=1)
        return self.clipped(shapely.polygons(self.place(corner)))

    def outline(self, points: Sequence[tuple[float, float]]) -> Any:
        """Return a polygon, given counter-clockwise, as a plan within the outline."""
        return self.clipped(np.array([shapely.Polygon(self.place(points))], object))[0]

    def clipped(self, shapes: NDArray[Any]) -> list[Any]:
        """Cut shapes of the scene off at the outline."""
        if self.fill < WHOLE:
            shapes = shapely.intersection(shapes, self.plan)
        return list(shapes)

    def masses(self, boxes: Sequence[Box], **more: Any) -> list[Mass]:
        """Return a volume on each of some rectangles; `more` are the arguments of `Mass`."""
        made = []
        for shape in self.outlines(boxes):
            made += masses_on(shape, **more)
        return made

    def compass(self, x: float, y: float) -> float:
        """Compass direction of a vector of the frame, radians."""
        east, north = x * self.right + y * self.front
        return math.atan2(east, north)

    def along(self) -> float:
        """Direction of slope of a roof whose ridge runs along the street."""
        return self.compass(0.0, 1.0)

    def inward(self) -> float:
        """Direction of slope of a roof whose gable looks at the street."""
        return self.compass(1.0, 0.0)


def masses_on(shape: Any, **more: Any) -> list[Mass]:
    """Return a volume for every polygon of a shape."""
    parts = [shape] if shape.geom_type == "Polygon" else list(shapely.get_parts(shape))
    return [
        Mass(part, **more) for part in parts if part.geom_type == "Polygon" and part.area > SHRED
    ]


def lot_of(plot: Plot, *, lengthwise: bool = False) -> Lot:
    """Return the lot of a plot.

    Parameters
    ----------
    lengthwise
        Whether x follows the longer side, wherever the street lies.
    """
    axes = plot.axes()
    right, front, length, depth = axes.along, axes.across, axes.length, axes.width
    facing = np.asarray(plot.front, float)
    if not lengthwise and abs(right @ facing) > abs(front @ facing):
        # The street lies at a short side: look at the house from there.
        front = right if right @ facing > 0 else -right
        right, length, depth = np.array([front[1], -front[0]]), axes.width, axes.length
    fill = float(plot.plan.area / max(length * depth, 1e-9))
    return Lot(plot.plan, axes.middle, right, front, length, depth, fill)


def slope_of(plot: Plot, lot: Lot) -> float:
    """Rise over run of the roof that a plot came with."""
    return 2.0 * plot.rise / max(lot.narrow, 1e-6)
