"""Drawn pieces: small things whose shapes are rows of data, `cityx/data/assets/drawn_pieces.toml`.

Front -y, foot at the origin, metres.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from types import MappingProxyType

import numpy as np

from cityx.assets.furniture.furniture_parts import Shapes
from cityx.assets.shapes import WHITE, Color, box, lathe, moved, prism, tube
from cityx.city.mesh import MeshBatch
from cityx.system.tables import load, table

Point = tuple[float, float, float]
Pair = tuple[float, float]
OWN = "own"  # word of the colour that tells variants of a piece apart


@dataclass(frozen=True)
class Stroke:
    """One shape of a piece: a box, a rod, a path, a turned profile, a plate or a ball.

    Attributes
    ----------
    of, tint
        Material, and a word of the file's part ``tints`` or `OWN`, "" for none.
    box
        Least x, y and z, greatest x, y and z.
    rod
        Both ends of a straight rod of radius `r`.
    path
        Points of a tube of radius `r`, or of `radii`.
    turned
        Radius and z of a profile that is turned about an upright axis through `at`.
    plate
        x and z of an outline, counter-clockwise from the front, between both `deep`; it is turned
        and then moved by `at`.
    ball
        Centre, and radii along x, y and z.
    sides
        Of what is round.
    rows
        How often it is repeated, and the step.
    both
        Whether it stands on the other side of the middle as well.
    yaw
        Degrees, counter-clockwise.
    """

    of: str
    tint: str = ""
    box: tuple[float, float, float, float, float, float] | None = None
    rod: tuple[float, float, float, float, float, float] | None = None
    path: tuple[Point, ...] = ()
    turned: tuple[Pair, ...] = ()
    plate: tuple[Pair, ...] = ()
    ball: tuple[float, float, float, float, float, float] | None = None
    at: Pair = (0.0, 0.0)
    deep: Pair = (0.0, 0.1)
    r: float = 0.03
    radii: tuple[float, ...] = ()
    sides: int = 8
    rows: tuple[float, float, float, float] = (1.0, 0.0, 0.0, 0.0)
    both: bool = False
    yaw: float = 0.0

    def drawn(self, tints: Mapping[str, Color]) -> Shapes:
        """Return its shapes."""
        tint = tints[self.tint] if self.tint else WHITE
        once = [self._one(tint, side) for side in ((1.0, -1.0) if self.both else (1.0,))]
        number, *step = self.rows
        return [
            moved(shape, [k * one for one in step])
            for k in range(int(number)) for shape in once
        ]  # fmt: skip

    def _one(self, tint: Color, side: float) -> MeshBatch:
        """Draw it once, on its side (1) of the middle or the other (-1)."""
        turn = np.array([side, 1.0, 1.0])
        if self.box is not None:
            ends = np.sort(np.array(self.box).reshape(2, 3) * turn, axis=0)
            made = box(ends[0].tolist(), ends[1].tolist(), self.of, tint)
        elif self.rod is not None:
            ends = np.array(self.rod).reshape(2, 3) * turn
            made = tube(ends, self.radii or self.r, self.of, tint, sides=self.sides)
        elif self.path:
            made = tube(np.array(self.path) * turn, self.radii or self.r, self.of, tint,
                        sides=self.sides)  # fmt: skip
        elif self.turned:
            made = lathe(self.turned, self.of, tint, sides=self.sides,
                         center=(side * self.at[0], self.at[1]))  # fmt: skip
        elif self.plate:
            outline = np.array(self.plate) * [side, 1.0]
            made = prism(outline[:: int(side)], *self.deep, self.of, tint)
        else:
            made = ball(self.ball or (0.0,) * 6, self.of, tint, sides=self.sides)
            made = moved(made, ((side - 1.0) * (self.ball or (0.0,))[0], 0.0, 0.0))
        made = moved(made, yaw=side * np.radians(self.yaw)) if self.yaw else made
        return moved(made, (side * self.at[0], self.at[1], 0.0)) if self.plate else made


def ball(round_: tuple[float, ...], material: str, tint: Color, *, sides: int = 8) -> MeshBatch:
    """Make an ellipsoid: its centre, and its radii along x, y and z."""
    x, y, z, wide, deep, high = round_
    turn = np.linspace(-np.pi / 2, np.pi / 2, max(sides // 2 + 1, 4))
    profile = np.column_stack([np.cos(turn), np.sin(turn)])
    profile[[0, -1], 0] = 0.0
    made = lathe(profile, material, tint, sides=sides)
    size, at = np.array([wide, deep, high]), np.array([x, y, z])
    return replace(made, vertices=made.vertices * size + at)


@dataclass(frozen=True)
class Drawn:
    """A piece.

    Attributes
    ----------
    shapes
        What it is made of.
    colors
        Words of the colours that variants of it have where `OWN` is said, the first the usual one.
    """

    shapes: tuple[Stroke, ...]
    colors: tuple[str, ...] = ()


_TINTS: Mapping[str, Color] = table("assets/drawn_pieces", tuple[float, float, float], "tints")
_DRAWN = load("assets/drawn_pieces", dict[str, Drawn], "pieces")


def _draw(piece: Drawn, color: str) -> Shapes:
    tints = {**_TINTS, OWN: _TINTS[color] if color else WHITE}
    return [shape for stroke in piece.shapes for shape in stroke.drawn(tints)]


def _makers() -> dict[str, Callable[[], Shapes]]:
    found: dict[str, Callable[[], Shapes]] = {}
    for name, piece in _DRAWN.items():
        for k, color in enumerate(piece.colors or ("",)):
            found[name if not k else f"{name}_{color}"] = partial(_draw, piece, color)
    return found


DRAWN_MAKERS: Mapping[str, Callable[[], Shapes]] = MappingProxyType(_makers())


def looks_of(names: Sequence[str]) -> dict[str, tuple[str, ...]]:
    """Return all looks of each piece of which there are several, by the name of the first.

    The others are called as that and what they differ in.
    """
    found: dict[str, tuple[str, ...]] = {}
    for name in names:
        own = tuple(other for other in names if other.startswith(f"{name}_"))
        if own:
            found[name] = (name, *own)
    return found
