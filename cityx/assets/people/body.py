"""The bodies of people: measures, limbs and hands as stacks of rings.

Lengths are in body units. One is the height of a grown person of seven and a half heads; a child
has a smaller unit and a larger head. Everything is made in the rest pose, arms hanging, and by the
same curves at both levels of detail: the fine one only samples them more densely.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cityx.assets.people.skeleton import (
    Binding,
    Weights,
    chained,
    mirrored_weights,
    rest_joints,
    rigid,
)
from cityx.assets.shapes import Color, is_fine, loft
from cityx.city.mesh import NO_VERTEX, MeshBatch, one_mesh
from cityx.geometry.arrays import FloatArray

CHIN = 0.867  # height of the chin; the head above it is 1 / 7.5 of the whole
FRONT = -np.pi / 2  # angle of a ring's first column
# (z, half width, reach to the front, reach to the back) of the trunk.
_MALE = np.array([
    (0.455, 0.080, 0.050, 0.062), (0.500, 0.095, 0.061, 0.075), (0.535, 0.096, 0.063, 0.073),
    (0.570, 0.091, 0.062, 0.060), (0.610, 0.085, 0.061, 0.050), (0.650, 0.088, 0.062, 0.052),
    (0.690, 0.095, 0.067, 0.061), (0.730, 0.101, 0.070, 0.069), (0.765, 0.105, 0.065, 0.072),
    (0.788, 0.105, 0.053, 0.069), (0.806, 0.100, 0.042, 0.064), (0.822, 0.081, 0.032, 0.057),
    (0.837, 0.058, 0.025, 0.049), (0.852, 0.041, 0.022, 0.043),
])  # fmt: skip
_FEMALE = np.array([
    (0.455, 0.086, 0.052, 0.064), (0.500, 0.103, 0.061, 0.079), (0.535, 0.102, 0.062, 0.076),
    (0.570, 0.093, 0.060, 0.060), (0.610, 0.076, 0.054, 0.045), (0.650, 0.077, 0.055, 0.047),
    (0.690, 0.084, 0.062, 0.056), (0.730, 0.091, 0.065, 0.063), (0.765, 0.095, 0.060, 0.065),
    (0.788, 0.094, 0.047, 0.062), (0.806, 0.085, 0.037, 0.057), (0.822, 0.068, 0.028, 0.051),
    (0.837, 0.048, 0.022, 0.045), (0.852, 0.034, 0.019, 0.039),
])  # fmt: skip
# (z, half width, front, back) of a leg, and (z, radius across, radius along y) of an arm.
_LEG = np.array([
    (0.020, 0.020, 0.020, 0.022), (0.055, 0.0195, 0.019, 0.023), (0.090, 0.020, 0.020, 0.023),
    (0.135, 0.025, 0.023, 0.029), (0.180, 0.031, 0.026, 0.039), (0.215, 0.033, 0.028, 0.041),
    (0.255, 0.031, 0.030, 0.033), (0.285, 0.032, 0.034, 0.030), (0.315, 0.035, 0.036, 0.034),
    (0.370, 0.042, 0.043, 0.042), (0.430, 0.048, 0.050, 0.051), (0.475, 0.050, 0.053, 0.056),
    (0.510, 0.047, 0.050, 0.055), (0.540, 0.034, 0.038, 0.042), (0.552, 0.0, 0.0, 0.0),
])  # fmt: skip
_ARM = np.array([
    (0.477, 0.0125, 0.0165), (0.500, 0.0132, 0.0172), (0.540, 0.0175, 0.0195),
    (0.585, 0.0220, 0.0225), (0.612, 0.0222, 0.0230), (0.636, 0.0205, 0.0222),
    (0.676, 0.0235, 0.0255), (0.716, 0.0255, 0.0285), (0.752, 0.0275, 0.0320),
    (0.774, 0.0265, 0.0320), (0.793, 0.0205, 0.0260), (0.805, 0.0110, 0.0150),
    (0.809, 0.0, 0.0),
])  # fmt: skip


@dataclass(frozen=True)
class Body:
    """Measures of a person, in body units unless another unit is named.

    Attributes
    ----------
    unit
        Metres.
    skull
        Height of the skull from the chin to the crown.
    female
        0 to 1, share of the female form of the trunk.
    build
        -1 slim to 1 stout.
    child
        0 to 1.
    """

    unit: float
    skull: float
    female: float
    build: float
    child: float

    @property
    def girth(self) -> float:
        """Girth of limbs, relative to the tables."""
        return 1.0 + 0.13 * self.build + 0.06 * self.child - 0.06 * self.female

    @property
    def shoulder(self) -> float:
        """Breadth of the shoulders, relative to the tables."""
        return 1.0 + 0.05 * self.build - 0.085 * self.female - 0.04 * self.child

    @property
    def hip(self) -> float:
        """Breadth between the hips, relative to the tables."""
        return 1.0 + 0.07 * self.build + 0.04 * self.female

    def joints(self) -> FloatArray:
        """Joints at rest, (j, 3) body units."""
        return rest_joints(1.0, shoulder=self.shoulder, hip=self.hip)

    def trunk(self, z: Sequence[float] | FloatArray) -> FloatArray:
        """Half width, front and back of the trunk at heights, (n, 3)."""
        rows = (1.0 - self.female) * _MALE + self.female * _FEMALE
        found = curve(rows, z)
        height = np.asarray(z, float)
        belly = np.exp(-(((height - 0.605) / 0.075) ** 2))
        below_neck = np.clip((0.84 - height) / 0.06, 0.0, 1.0)
        found *= 1.0 + self.build * (0.07 + 0.10 * belly * below_neck)[:, None]
        found[:, 1] += belly * (0.028 * max(self.build, 0.0) ** 1.5 + 0.008 * self.child)
        return found

    def leg(self, z: Sequence[float] | FloatArray) -> FloatArray:
        """Half width, front and back of a leg at heights, (n, 3)."""
        return curve(_LEG, z) * (self.girth + 0.05 * self.female)

    def arm(self, z: Sequence[float] | FloatArray) -> FloatArray:
        """Half width, front and back of an arm at heights, (n, 3)."""
        return curve(_ARM, z)[:, [0, 1, 1]] * self.girth


class Part(NamedTuple):
    """A closed solid in body units, and what its vertices are bound to."""

    mesh: MeshBatch
    weights: Weights


def curve(rows: FloatArray, z: Sequence[float] | FloatArray) -> FloatArray:
    """Read a table whose first column rises, (m, 1 + k), at values, as (n, k), without overshoot.

    Values beyond the table take its end.
    """
    from scipy.interpolate import PchipInterpolator

    at = np.clip(np.asarray(z, float), rows[0, 0], rows[-1, 0])
    return np.asarray(PchipInterpolator(rows[:, 0], rows[:, 1:])(at))


def level(plain: int, fine: int) -> int:
    """Choose a number of rings or columns for the level that is being made."""
    return fine if is_fine() else plain


def heights(low: float, high: float, plain: int, fine: int, *, domed: bool = False) -> FloatArray:
    """Heights of rings, more densely towards a domed upper end."""
    share = np.linspace(0.0, 1.0, level(plain, fine))
    if domed:
        share = np.where(share > 0.75, 0.75 + 0.25 * np.sin((share - 0.75) * 2 * np.pi), share)
    return low + (high - low) * share


def ring_angles(sides: int) -> FloatArray:
    """Angles of a ring's columns, counter-clockwise; the first is the front."""
    return FRONT + np.arange(sides) * (2 * np.pi / sides)


def stacked(
    z: FloatArray,
    centre: FloatArray,
    reach: FloatArray,
    sides: int | FloatArray,
    *,
    power: float = 2.3,
) -> FloatArray:
    """Make level rings, (m, k, 3).

    Parameters
    ----------
    z
        (m,) heights, rising.
    centre
        (m, 2) or (2,) middle of each ring.
    reach
        (m, 3) half width, reach to the front and to the back.
    sides
        Number of columns, or the (k,) angles of the columns.
    power
        Exponent of the superellipse; 2 is an ellipse, more is squarer.
    """
    angle = ring_angles(sides) if isinstance(sides, int) else sides
    c, s = np.cos(angle), np.sin(angle)
    across = np.sign(c) * np.abs(c) ** (2 / power)
    along = np.sign(s) * np.abs(s) ** (2 / power)
    middle = np.broadcast_to(np.asarray(centre, float), (len(z), 2))
    out = np.empty((len(z), len(angle), 3))
    out[..., 0] = middle[:, :1] + reach[:, :1] * across
    out[..., 1] = middle[:, 1:] + np.where(along < 0, reach[:, 1:2], reach[:, 2:3]) * along
    out[..., 2] = np.asarray(z, float)[:, None]
    return out


def creased(rings: FloatArray, folds: Sequence[tuple[float, float, float]]) -> FloatArray:
    """Lay cloth in folds at the fine level: (height, reach, depth) of each heap of folds."""
    if not is_fine():
        return rings
    middle = rings.mean(axis=1, keepdims=True)
    out = rings - middle
    z = rings[..., 2]
    angle = np.arctan2(out[..., 1], out[..., 0])
    depth = np.zeros(z.shape)
    for place, reach, deep in folds:
        # Folds run aslant and die away around the limb; level ones would look like rings.
        wave = np.sin(2 * np.pi * (z - place) / 0.055 + 2.6 * np.sin(angle + 40 * place))
        wave *= 0.55 + 0.45 * np.sin(angle + 90 * place)
        wave += 0.5 * np.sin(2 * np.pi * (z - place) / 0.085 + 3.0 * np.cos(angle + 1.0))
        depth += 0.8 * deep * np.exp(-(((z - place) / reach) ** 2)) * wave
    length = np.maximum(np.hypot(out[..., 0], out[..., 1]), 1e-6)
    factor = 1.0 + depth / np.maximum(length, 0.01)
    out[..., 0] *= factor
    out[..., 1] *= factor
    return np.asarray(out + middle)


def sheet(outer: FloatArray, inner: FloatArray, material: str, tint: Color, *,
          around: bool) -> MeshBatch:  # fmt: skip
    """Make cloth of some thickness between two grids of points, (m, k, 3) each.

    Rows rise and columns run counter-clockwise seen from above. `around` joins the last column to
    the first; otherwise the cloth is open there, as a jacket is in front.
    """
    m, k, _ = outer.shape
    number = np.arange(m * k).reshape(m, k)
    if around:
        number = np.concatenate([number, number[:, :1]], axis=1)
    under = number + m * k

    def wall(a: NDArray[np.int64], b: NDArray[np.int64], c: NDArray[np.int64],
             d: NDArray[np.int64]) -> NDArray[np.int64]:  # fmt: skip
        return np.stack([a, b, c, d], axis=-1).reshape(-1, 4)

    parts = [
        wall(number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]),
        wall(under[:-1, :-1], under[1:, :-1], under[1:, 1:], under[:-1, 1:]),
        wall(number[0, 1:], number[0, :-1], under[0, :-1], under[0, 1:]),
        wall(number[-1, :-1], number[-1, 1:], under[-1, 1:], under[-1, :-1]),
    ]
    if not around:
        parts.append(wall(number[:-1, 0], number[1:, 0], under[1:, 0], under[:-1, 0]))
        parts.append(wall(number[1:, -1], number[:-1, -1], under[:-1, -1], under[1:, -1]))
    points = np.concatenate([outer.reshape(-1, 3), inner.reshape(-1, 3)])
    return one_mesh(0, points, np.concatenate(parts), materials=(material,), tint=tint)


def bound(mesh: MeshBatch, binding: Binding) -> Part:
    """Bind a solid by the places of its vertices."""
    return Part(mesh, binding(mesh.vertices))


def mirrored(part: Part) -> Part:
    """Make the right part of a left one."""
    mesh = part.mesh
    order = np.where(mesh.faces[:, 3:] == NO_VERTEX, [0, 2, 1, 3], [0, 3, 2, 1])
    flipped = replace(
        mesh,
        vertices=mesh.vertices * [-1.0, 1.0, 1.0],
        faces=np.take_along_axis(mesh.faces, order, axis=1),
        uv=np.take_along_axis(mesh.uv, order[:, :, None], axis=1),
    )
    return Part(flipped, mirrored_weights(part.weights))


def both(parts: Sequence[Part]) -> list[Part]:
    """Give left parts with their right ones."""
    return [*parts, *(mirrored(part) for part in parts)]


def ball(centre: Sequence[float], reach: Sequence[float], material: str, tint: Color, *,
         plain: tuple[int, int] = (4, 6),
         fine: tuple[int, int] = (7, 10)) -> MeshBatch:  # fmt: skip
    """Make an ellipsoid of (half width, front, back, half height); counts are (rings, sides)."""
    rings, sides = fine if is_fine() else plain
    angle = np.linspace(-np.pi / 2, np.pi / 2, rings + 1)
    radius = np.where(np.abs(angle) > 1.57, 0.0, np.cos(angle))
    z = centre[2] + reach[3] * np.sin(angle)
    size = radius[:, None] * np.asarray(reach[:3], float)
    return loft(stacked(z, np.array(centre[:2]), size, sides, power=2.0), material, tint)


# --- limbs ----------------------------------------------------------------------------------------

LEG_BINDING = chained(("left_hip", "left_knee", "left_ankle"), ((0.285, 0.034), (0.050, 0.014)))
ARM_BINDING = chained(
    ("chest", "left_shoulder", "left_elbow", "left_wrist"),
    ((0.798, 0.034), (0.628, 0.030), (0.483, 0.010)),
)
TRUNK_BINDING = chained(
    ("neck", "chest", "spine", "pelvis"), ((0.846, 0.012), (0.690, 0.045), (0.595, 0.035))
)


def limb_centre(body: Body, names: Sequence[str], z: FloatArray) -> FloatArray:
    """Middle of a limb at heights, (n, 2): the line through the named joints, carried on."""
    from cityx.assets.people.skeleton import NUMBER

    joints = body.joints()[[NUMBER[name] for name in names]][::-1]
    xy = [np.interp(z, joints[:, 2], joints[:, axis]) for axis in (0, 1)]
    return np.column_stack(xy)


def leg_centre(body: Body, z: FloatArray) -> FloatArray:
    """Middle of the left leg at heights, (n, 2)."""
    return limb_centre(body, ("left_hip", "left_knee", "left_ankle"), z)


def arm_centre(body: Body, z: FloatArray) -> FloatArray:
    """Middle of the left arm at heights, (n, 2)."""
    return limb_centre(body, ("left_shoulder", "left_elbow", "left_wrist"), z)


def bare_leg(body: Body, skin: Color, top: float = 0.552, *, material: str = "skin") -> list[Part]:
    """Left and right leg from the ankle up to a height, or to the hip."""
    share = (top - 0.03) / 0.52
    z = heights(0.030, top, 3 + round(4 * share), 8 + round(15 * share), domed=top > 0.5)
    rings = stacked(z, leg_centre(body, z), body.leg(z), level(7, 14), power=2.1)
    return both([bound(loft(rings, material, skin), LEG_BINDING)])


def bare_arm(body: Body, skin: Color, top: float = 0.809) -> list[Part]:
    """Left and right arm from the wrist up to a height, or to the shoulder."""
    z = heights(0.478, top, 6, 20, domed=top > 0.8)
    rings = stacked(z, arm_centre(body, z), body.arm(z), level(6, 14), power=2.0)
    return both([bound(loft(rings, "skin", skin), ARM_BINDING)])


def hands(body: Body, skin: Color) -> list[Part]:
    """Relaxed hands: a palm, fingers that curl a little, and a thumb."""
    x, y = arm_centre(body, np.array([0.481]))[0]
    size = 1.05 + 0.06 * body.build - 0.08 * body.female
    palm_rows = np.array([
        (0.420, 0.0085, 0.0225, 0.0215), (0.430, 0.0100, 0.0235, 0.0225),
        (0.448, 0.0115, 0.0230, 0.0215), (0.469, 0.0120, 0.0190, 0.0185),
        (0.486, 0.0122, 0.0162, 0.0162),
    ])  # fmt: skip
    z = heights(0.420, 0.486, 3, 6)
    reach = curve(palm_rows, z) * size
    wrist = rigid("left_wrist")
    palm = stacked(z, np.array([x, y]), reach, level(5, 12), power=2.6)
    solids = [loft(palm, "skin", skin)]
    # (y from the middle of the palm, length, radius) of the fingers from index to little.
    fingers = ((-0.0155, 0.044, 0.0056), (-0.005, 0.050, 0.0058), (0.0055, 0.046, 0.0055),
               (0.0155, 0.036, 0.0048)) if is_fine() else ((0.0, 0.045, 0.0068),)  # fmt: skip
    for place, length, radius in fingers:
        share = np.linspace(0.0, 1.0, level(3, 5))[::-1]  # from the tip up
        radii = radius * size * np.where(share > 0.9, 0.45, 1.0 - 0.22 * share)
        breadth = radii[:, None] * ([1.0, 1.0, 1.0] if is_fine() else [1.0, 2.9, 2.7])
        # Fingers hang half open: they bend towards the thigh the further down the more.
        middle = np.column_stack([x - 0.016 * share**1.6, y + place * (1.0 - 0.18 * share)])
        tip = stacked(0.424 - length * size * share, middle, breadth, level(5, 7), power=2.2)
        solids.append(loft(tip, "skin", skin))
    share = np.linspace(0.0, 1.0, level(3, 5))[::-1]
    radii = np.where(share > 0.9, 0.0035, 0.0078 - 0.0018 * share)[:, None] * np.full(3, size)
    middle = np.column_stack([x - 0.004 - 0.008 * share, y - 0.014 - 0.017 * np.sqrt(share)])
    solids.append(loft(stacked(0.468 - 0.050 * share, middle, radii, level(4, 7), power=2.1),
                       "skin", skin))  # fmt: skip
    return both([bound(solid, wrist) for solid in solids])
