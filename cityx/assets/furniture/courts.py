"""Courts and fields: the size, surface and lines of each sport, in metres.

Measures are those of the games' rules: FIFA (football), FIBA (basketball), ITF (tennis).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
Color = tuple[float, float, float]
LINE = 0.10  # metres


@dataclass(frozen=True)
class Court:
    """One court; x runs along its length, the origin is in its middle.

    Attributes
    ----------
    length, width
        Of the lines' outer rectangle.
    margin
        Metres beyond the lines at the ends and at the sides, that belong to the court.
    surface
        Tint of a hard surface, or None for grass.
    lines
        Polylines, (k, 2) float each.
    things
        Name of a prototype, x, y, and the direction its front looks to.
    """

    length: float
    width: float
    margin: tuple[float, float]
    surface: Color | None
    lines: tuple[FloatArray, ...]
    things: tuple[tuple[str, float, float, float], ...]


def _rectangle(x0: float, y0: float, x1: float, y1: float) -> FloatArray:
    return np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1], [x0, y0]])


def _arc(x: float, y: float, radius: float, low: float, high: float) -> FloatArray:
    turn = np.linspace(low, high, max(5, round(abs(high - low) * 6)))
    return np.column_stack([x + radius * np.cos(turn), y + radius * np.sin(turn)])


def football(length: float, width: float) -> Court:
    """Make a field; its areas shrink with it below the full size of 105 m."""
    a, b, s = length / 2, width / 2, min(1.0, length / 105.0, width / 68.0)
    lines = [_rectangle(-a, -b, a, b), np.array([[0.0, -b], [0.0, b]]),
             _arc(0, 0, 9.15 * s, 0, 2 * np.pi)]  # fmt: skip
    for side in (-1, 1):
        for deep, half in ((16.5 * s, 20.16 * s), (5.5 * s, 9.16 * s)):
            lines.append(np.array([[side * a, -half], [side * (a - deep), -half],
                                   [side * (a - deep), half], [side * a, half]]))  # fmt: skip
        turn = np.arccos(5.5 / 9.15)
        middle = 0.0 if side < 0 else np.pi
        lines.append(_arc(side * (a - 11.0 * s), 0, 9.15 * s, middle - turn, middle + turn))
    goals = (("football_goal", -a, 0.0, 0.0), ("football_goal", a, 0.0, np.pi))
    return Court(length, width, (2.0, 2.0), None, tuple(lines), goals)


def basketball() -> Court:
    """Make a court of 28 x 15 m."""
    lines = [_rectangle(-14, -7.5, 14, 7.5), np.array([[0.0, -7.5], [0.0, 7.5]]),
             _arc(0, 0, 1.8, 0, 2 * np.pi)]  # fmt: skip
    for side in (-1, 1):
        lines.append(np.array([[side * 14, -2.45], [side * 8.2, -2.45], [side * 8.2, 2.45],
                               [side * 14, 2.45]]))  # fmt: skip
        middle = 0.0 if side < 0 else np.pi
        lines.append(_arc(side * 8.2, 0, 1.8, middle - np.pi / 2, middle + np.pi / 2))
        basket = side * 12.425
        turn = np.arcsin(6.6 / 6.75)
        arc = _arc(basket, 0, 6.75, middle - turn, middle + turn)
        lines.append(np.vstack([[side * 14, arc[0, 1]], arc, [side * 14, arc[-1, 1]]]))
    hoops = (("basketball_hoop", -13.8, 0.0, 0.0), ("basketball_hoop", 13.8, 0.0, np.pi))
    return Court(28.0, 15.0, (1.0, 1.0), (0.24, 0.30, 0.38), tuple(lines), hoops)


def tennis(clay: bool) -> Court:
    """Make a court of 23.77 x 10.97 m."""
    a, b, single, service = 11.885, 5.485, 4.115, 6.4
    lines = [_rectangle(-a, -b, a, b), np.array([[-a, -single], [a, -single]]),
             np.array([[-a, single], [a, single]]), np.array([[-service, 0], [service, 0]]),
             np.array([[-service, -single], [-service, single]]),
             np.array([[service, -single], [service, single]])]  # fmt: skip
    tint = (0.62, 0.25, 0.14) if clay else (0.16, 0.34, 0.24)
    net = (("tennis_net", 0.0, 0.0, 0.0),)
    return Court(2 * a, 2 * b, (4.0, 2.2), tint, tuple(lines), net)
