"""What people wear and carry: clothes over trunk, arms, legs and feet, and bags, in body units."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cityx.assets.people.body import (
    ARM_BINDING,
    FRONT,
    TRUNK_BINDING,
    Body,
    Part,
    arm_centre,
    both,
    bound,
    creased,
    curve,
    heights,
    leg_centre,
    level,
    ring_angles,
    sheet,
    stacked,
)
from cityx.assets.people.skeleton import chained, hanging, rigid
from cityx.assets.shapes import Color, is_fine, loft, tube
from cityx.city.mesh import MeshBatch
from cityx.geometry.arrays import FloatArray
from cityx.system.tables import table

TRUNK_Y = 0.006  # middle of the trunk behind that of the body
NECK_TOP = 0.846
SHORT = 0.46  # height of a hem above which a jacket stays with the pelvis of who sits
_HANG = hanging(((0.690, 0.045), (0.595, 0.035), (0.520, 0.035), (0.425, 0.055)), 0.035)
_SHOE = chained(("left_ankle", "left_toes"), ((-0.066, 0.014),), axis=1)
_SHANK = chained(("left_knee", "left_ankle"), ((0.058, 0.012),))
_HEM = chained(("left_hip", "left_knee"), ((0.285, 0.034),))
BAGS = ("backpack", "handbag", "shopping bag")


@dataclass(frozen=True)
class Top:
    """What is worn on the trunk.

    Attributes
    ----------
    words
        Its name in a description.
    hem
        Height of the lower edge.
    sleeve
        Height of the sleeve's end; 0.481 is the wrist.
    ease
        Thickness over the body.
    collar
        Height of the collar.
    open
        (at the hem, at the waist, at the neck) half width of the opening in front; () is closed.
    flare
        How much wider than the hips the hem is, as a share.
    """

    words: str
    hem: float
    sleeve: float
    ease: float
    collar: float = 0.0
    open: tuple[float, ...] = ()
    flare: float = 0.0


TOPS = table("assets/clothes", Top, "tops")
# (height, ease across, ease along) of trouser legs above the leg itself.
BOTTOMS = table("assets/clothes", tuple[tuple[float, ...], ...], "bottoms")
SKIRTS = table("assets/clothes", tuple[float, float], "skirts")
SHOES = ("shoes", "trainers", "boots")


def trunk_rings(body: Body, z: FloatArray, ease: float | FloatArray, angles: FloatArray, *,
                flare: float = 0.0) -> FloatArray:  # fmt: skip
    """Rings about the trunk; below the hips they fall straight, or flare."""
    reach = body.trunk(np.maximum(z, 0.515)) + np.reshape(ease, (-1, 1))
    below = np.clip((0.53 - z) / 0.30, 0.0, 2.0)
    reach *= (1.0 + flare * below)[:, None]
    rings = stacked(z, np.array([0.0, TRUNK_Y]), reach, angles, power=2.45)
    x, y = rings[..., 0], rings[..., 1]
    height = rings[..., 2]
    front = y < TRUNK_Y
    bust = np.exp(-(((np.abs(x) - 0.044) / 0.030) ** 2) - ((height - 0.728) / 0.034) ** 2)
    rings[..., 1] -= np.where(front, (0.017 * body.female + 0.003) * (1 - body.child) * bust, 0.0)
    seat = np.exp(-(((np.abs(x) - 0.045) / 0.035) ** 2) - ((height - 0.505) / 0.035) ** 2)
    spine = np.exp(-((x / 0.014) ** 2)) * np.exp(-(((height - 0.69) / 0.09) ** 2))
    rings[..., 1] += np.where(front, 0.0, 0.007 * seat - 0.004 * spine)
    return rings


def top_parts(body: Body, kind: str, color: Color, *, tucked: bool = False,
              sleeves: bool = True) -> list[Part]:  # fmt: skip
    """Make a top with its collar; `kind` is a key of `TOPS`.

    One without `sleeves` is worn under a jacket and ends over the trousers.
    """
    look = TOPS[kind]
    hem = 0.588 if tucked else look.hem if sleeves else 0.556
    binding = TRUNK_BINDING if hem > SHORT else _HANG
    rows = (7, 20) if sleeves else (4, 8)  # what is worn under a jacket hardly shows
    # Under a jacket cloth lies close: the flat sides of a plain jacket come near to the body.
    ease = look.ease if sleeves else (0.0 if is_fine() else -0.009)
    z = heights(hem, NECK_TOP, *rows)
    if look.open:
        z = np.concatenate([np.linspace(hem, 0.73, level(3, 11)),
                            np.linspace(0.79, NECK_TOP, level(3, 6))])  # fmt: skip
    if look.open:
        solids = [_open_front(body, look, z, color)]
    else:
        rings = trunk_rings(body, z, ease * _narrowing(z), ring_angles(level(10, 25)),
                            flare=look.flare)  # fmt: skip
        if look.flare > 0.1:
            rings = _pleated(rings)
        rings = creased(rings, [(0.60, 0.05, 0.0030), (0.70, 0.04, 0.0012), (hem, 0.03, 0.0015)])
        solids = [loft(_hollowed(rings), "cloth", color)]
    parts = [bound(solid, binding) for solid in solids]
    if look.collar:
        parts.append(_collar(body, look, color))
    if kind == "hoodie":
        parts.append(_hood(color))
    return [*parts, *_sleeves(body, look, color)] if sleeves else parts


def _narrowing(z: FloatArray) -> FloatArray:
    """Ease of a top by height: less at the neck."""
    return np.clip((NECK_TOP + 0.012 - z) / 0.05, 0.2, 1.0)


def _hollowed(rings: FloatArray) -> FloatArray:
    """Close a hem by a hollow, so that legs do not seem to grow from a lid."""
    if not is_fine():
        return rings
    low = rings[:1]
    middle = low.mean(axis=1, keepdims=True)
    inner = middle + (low - middle) * 0.90
    deep = np.broadcast_to(middle + np.array([0.0, 0.0, 0.05]), inner.shape)
    return np.concatenate([deep, inner, rings])


def _pleated(rings: FloatArray) -> FloatArray:
    """Let the cloth of a skirt fall in pleats that deepen to the hem."""
    middle = rings.mean(axis=1, keepdims=True)
    low = rings[0, 0, 2]
    share = np.clip((0.50 - rings[..., 2]) / max(0.50 - low, 1e-3), 0.0, 1.0)
    turn = np.arctan2(rings[..., 1], rings[..., 0])
    wave = 0.035 * share * np.sin(9 * turn + 0.6) if rings.shape[1] > 20 else 0.0 * share
    return np.asarray(middle + (rings - middle) * (1.0 + wave)[..., None] * [1.0, 1.0, 1.0])


def hem_of(bottom: str, top: str) -> float:
    """Height down to which a skirt or a dress covers the legs."""
    return SKIRTS[bottom][0] if bottom in SKIRTS else TOPS[top].hem


def _open_front(body: Body, look: Top, z: FloatArray, color: Color) -> MeshBatch:
    """Make a jacket whose front edges stand apart."""
    at_hem, waist, at_neck = look.open
    gap = np.interp(z, [look.hem, 0.62, 0.80, NECK_TOP], [at_hem, waist, at_neck, at_neck * 0.7])
    reach = body.trunk(np.maximum(z, 0.515))[:, 0]
    half = np.arcsin(np.clip(gap / reach, 0.0, 0.95) ** (2.45 / 2))  # (m,)
    share = np.linspace(0.0, 1.0, level(8, 22))
    outer, inner = [], []
    for number in range(len(z)):
        angles = FRONT + half[number] + share * 2 * (np.pi - half[number])
        row = z[number : number + 1]
        ease = look.ease * _narrowing(row)
        outer.append(trunk_rings(body, row, ease, angles, flare=look.flare)[0])
        inner.append(trunk_rings(body, row, ease - 0.006, angles, flare=look.flare)[0])
    skin = creased(np.array(outer), [(0.60, 0.05, 0.0025)])
    return sheet(skin, np.array(inner), "cloth", color, around=False)


def _collar(body: Body, look: Top, color: Color) -> Part:
    """Collar about the neck, open in front where the top is."""
    gap = 0.55 if look.open else (0.12 if look.collar > 0.015 else 0.0)
    share = np.linspace(0.0, 1.0, level(8, 20))
    angles = FRONT + gap + share * 2 * (np.pi - gap)
    if gap == 0.0:
        angles = ring_angles(level(8, 20))
    z = np.linspace(NECK_TOP - 0.012, NECK_TOP + look.collar, level(2, 3))
    base = body.trunk([0.846])[0]
    spread = np.linspace(0.007, 0.003, len(z))[:, None]
    outer = stacked(z, np.array([0.0, 0.010]), base + look.ease * 0.6 + spread, angles, power=2.0)
    inner = stacked(z, np.array([0.0, 0.010]), base + look.ease * 0.6 + spread - 0.004, angles,
                    power=2.0)  # fmt: skip
    for rings in (outer, inner):  # lower in front, as the neck leans forward
        rings[..., 2] += 0.20 * (rings[..., 1] - 0.015)
    shade = (0.94 * color[0], 0.94 * color[1], 0.94 * color[2])
    return bound(sheet(outer, inner, "cloth", shade, around=gap == 0.0), rigid("chest"))


def _hood(color: Color) -> Part:
    """Hood lying on the back of the neck."""
    angles = np.linspace(-0.5, np.pi + 0.5, level(6, 16))
    z = np.array([0.795, 0.815, 0.838, 0.855])
    reach = np.array([(0.066, 0.02, 0.074), (0.068, 0.03, 0.086), (0.060, 0.03, 0.080),
                      (0.047, 0.026, 0.060)])  # fmt: skip
    outer = stacked(z, np.array([0.0, 0.012]), reach, angles, power=2.0)
    inner = stacked(z, np.array([0.0, 0.012]), reach - 0.016, angles, power=2.0)
    outer[..., 2] += 0.15 * outer[..., 1]
    inner[..., 2] += 0.15 * inner[..., 1]
    return bound(sheet(outer, inner, "cloth", color, around=False), rigid("chest"))


def _sleeves(body: Body, look: Top, color: Color) -> list[Part]:
    z = heights(look.sleeve, 0.8095, 6, 24, domed=True)
    ease = look.ease + 0.006 * np.clip((look.sleeve + 0.06 - z) / 0.06, 0.0, 1.0) * (
        look.sleeve > 0.6
    )
    shape = body.arm(z)
    rows = shape + (ease * np.clip(shape[:, 0] / 0.026, 0.0, 1.0) ** 2)[:, None]
    if look.sleeve < 0.6:  # cloth hangs straight to the cuff
        rows = np.maximum(rows, (0.0175 * body.girth + 0.8 * look.ease) * (z < 0.75)[:, None])
    rings = stacked(z, arm_centre(body, z), rows, level(6, 14), power=2.0)
    rings = creased(rings, [(0.628, 0.035, 0.0022), (0.515, 0.03, 0.0018), (0.755, 0.03, 0.0014)])
    return both([bound(loft(rings, "cloth", color), ARM_BINDING)])


def trousers(body: Body, kind: str, color: Color, *, over: bool = False) -> list[Part]:
    """Make trousers or shorts, worn `over` a top or under it; `kind` is a key of `BOTTOMS`."""
    rows = np.array([(z, ease, ease) for z, ease in BOTTOMS[kind]])
    low = float(rows[0, 0])
    z = heights(low, 0.552, 6 if low < 0.2 else 5, 28 if low < 0.2 else 14, domed=True)
    ease = curve(rows, z)[:, :1]
    shape = body.leg(z)
    reach = shape + ease * np.clip(shape[:, :1] / 0.03, 0.0, 1.0)
    if kind != "slim trousers" and low < 0.2:  # the cloth hangs from the calf and the knee
        least = {"trousers": 0.036, "wide trousers": 0.048}[kind] * body.girth
        reach = np.where((z < 0.36)[:, None], np.maximum(reach, least), reach)
    rings = stacked(z, leg_centre(body, z), reach, level(7, 16), power=2.1)
    rings = creased(rings, [(0.285, 0.045, 0.0026), (0.075, 0.05, 0.0032), (0.47, 0.03, 0.0020)])
    parts = both([bound(loft(_hollowed(rings), "cloth", color), _HEM)])
    return [*parts, _seat(body, color, over=over)]


def _seat(body: Body, color: Color, *, over: bool) -> Part:
    """Trunk of trousers, from the crotch to the waist."""
    z = np.concatenate([[0.448, 0.452], heights(0.462, 0.604 if over else 0.572, 3, 8)])
    reach = body.trunk(np.maximum(z, 0.47)) + (0.006 if over else 0.001)
    share = np.interp(z, [0.448, 0.452, 0.462, 0.50], [0.0, 0.35, 0.78, 1.0])
    reach *= share[:, None]
    rings = stacked(z, np.array([0.0, TRUNK_Y]), reach, level(10, 26), power=2.4)
    return bound(loft(rings, "cloth", color), rigid("pelvis"))


def skirt(body: Body, kind: str, color: Color) -> list[Part]:
    """Make a skirt; `kind` is a key of `SKIRTS`."""
    hem, flare = SKIRTS[kind]
    z = heights(hem, 0.605, 5, 14)
    rings = trunk_rings(body, z, 0.003, ring_angles(level(10, 28)), flare=flare)
    return [bound(loft(_hollowed(_pleated(rings)), "cloth", color), _HANG)]


def shoes(body: Body, kind: str, color: Color, sole: Color) -> list[Part]:
    """Make shoes, one of `SHOES`: a sole and an upper."""
    x = float(leg_centre(body, np.array([0.048]))[0, 0])
    size = 1.0 + 0.05 * body.child - 0.05 * body.female
    heel, toe = 0.042 * size, 0.112 * size
    ground = 0.012 if kind != "trainers" else 0.016
    angles = ring_angles(level(8, 18))
    centre = np.array([x + 0.004, 0.008])

    def outline(z: FloatArray, reach: FloatArray) -> FloatArray:
        rings = stacked(z, centre, reach, angles, power=2.5)
        # The ball of the foot is broader than the heel, and toes turn out a little.
        along = np.clip((0.01 - rings[..., 1]) / toe, -0.5, 1.0)
        rings[..., 0] = centre[0] + (rings[..., 0] - centre[0]) * (1.0 + 0.16 * along)
        rings[..., 0] += 0.004 * along
        rings[..., 2] += 0.007 * np.clip((along - 0.62) / 0.38, 0, 1) ** 2  # toe spring
        return rings

    wide = 0.0255 * size
    under = np.array([0.0, 0.002, ground])
    rim = np.array([(wide - 0.001, toe - 0.002, heel - 0.002), (wide + 0.001, toe, heel),
                    (wide + 0.001, toe, heel)])  # fmt: skip
    # (height, half width, front, back) of the upper.
    rows = np.array([
        (ground - 0.002, wide - 0.0005, toe - 0.002, heel - 0.002),
        (ground + 0.012, wide, toe - 0.004, heel),
        (ground + 0.022, wide - 0.002, toe - 0.022, heel),
        (ground + 0.032, wide - 0.004, 0.052 * size, heel - 0.002),
        (ground + 0.042, wide - 0.004, 0.034, heel - 0.006),
        (0.062, 0.0215, 0.0245, heel - 0.011),
    ])  # fmt: skip
    z = heights(float(rows[0, 0]), 0.062, 4, 8)
    leather = "cloth" if kind == "trainers" else "leather"
    left = [
        bound(loft(outline(under, rim), "leather", sole), _SHOE),
        bound(loft(outline(z, curve(rows, z)), leather, color), _SHOE),
    ]
    if kind == "boots":
        z = heights(0.050, 0.150, 2, 6)
        shaft = stacked(z, leg_centre(body, z), body.leg(z) + 0.005, level(7, 16), power=2.1)
        left.append(bound(loft(shaft, "leather", color), _SHANK))
    return both(left)


def tie(body: Body, color: Color) -> list[Part]:
    """Make a tie down the front of a shirt."""
    z = np.linspace(0.600, 0.832, level(3, 14))
    front = trunk_rings(body, z, 0.006 * _narrowing(z), np.array([FRONT, 0.0]))[:, 0, 1]
    width = np.interp(z, [0.60, 0.615, 0.80, 0.815, 0.832], [0.002, 0.016, 0.009, 0.007, 0.010])
    reach = np.column_stack([width, np.full(len(z), 0.003), np.full(len(z), 0.012)])
    rings = stacked(z, np.column_stack([np.zeros(len(z)), front]), reach, level(4, 8), power=3.0)
    return [bound(loft(rings, "cloth", color), TRUNK_BINDING)]


def bag(body: Body, kind: str, color: Color) -> list[Part]:
    """Make a bag, one of `BAGS`."""
    if kind == "backpack":
        return _backpack(body, color)
    return _carried(body, color, large=kind == "shopping bag")


def _backpack(body: Body, color: Color) -> list[Part]:
    """Backpack with a pocket and two straps; all of it moves with the chest."""
    back = float(body.trunk([0.73])[0, 2]) + TRUNK_Y
    small = 1.0 - 0.12 * body.child
    dark = (0.6 * color[0], 0.6 * color[1], 0.6 * color[2])
    chest = rigid("chest")
    parts = []
    for low, high, wide, deep, place, tint in (
        (0.595, 0.822, 0.074, 0.036, 0.036, color),
        (0.612, 0.705, 0.056, 0.016, 0.076, dark),
    ):
        z = heights(low, high, 4, 8)
        share = (z - low) / (high - low)
        full = np.sqrt(np.clip(1.0 - np.abs(2.0 * share - 0.9) ** 5, 0.25, 1.0))
        reach = np.array([wide, deep, deep]) * small * full[:, None]
        middle = np.column_stack([np.zeros(len(z)), back + place * small - 0.010 * share])
        rings = stacked(z, middle, reach, level(7, 16), power=3.6)
        parts.append(bound(loft(rings, "cloth", tint), chest))
    for side in (1.0, -1.0):
        path = _strap(body, side * 0.052 * body.shoulder)
        parts.append(bound(tube(path, 0.0095, "cloth", dark, sides=4), chest))
    return parts


def _strap(body: Body, x: float) -> FloatArray:
    """Middle line of a strap from the back over the shoulder to below the arm."""
    z = np.concatenate([np.linspace(0.780, 0.826, 3), [0.834], np.linspace(0.822, 0.655, 8)])
    behind = np.arange(len(z)) < 3
    rows = trunk_rings(body, z, 0.011, np.linspace(-np.pi, np.pi, 181))
    out = np.empty((len(z), 3))
    aside = x * np.concatenate([[1.0, 1.0, 1.0, 1.0], 1.0 + 0.85 * np.linspace(0.0, 1.0, 8) ** 2])
    aside = np.sign(aside) * np.minimum(np.abs(aside), rows[:, :, 0].max(axis=1) - 0.002)
    for number, ring in enumerate(rows):
        back = ring[:, 1] >= TRUNK_Y
        half = ring[back] if behind[number] else ring[~back]
        order = np.argsort(half[:, 0])
        y = np.interp(aside[number], half[order, 0], half[order, 1])
        out[number] = (aside[number], y if number != 3 else TRUNK_Y + 0.012, z[number])
    return out if is_fine() else out[[0, 3, 4, 11]]


def _carried(body: Body, color: Color, *, large: bool) -> list[Part]:
    """Bag with two handles that hangs from the left hand."""
    x, y = (arm_centre(body, np.array([0.481]))[0] - [0.008, 0.0]).tolist()
    wrist = rigid("left_grip")
    top, low = (0.345, 0.155) if large else (0.345, 0.225)
    z = heights(low, top, 2, 5)
    share = (z - low) / (top - low)
    flare = np.array([0.034, 0.088, 0.088]) if large else np.array([0.026, 0.080, 0.080])
    narrower = np.column_stack([1.0 - 0.55 * share, 1.0 - 0.1 * share, 1.0 - 0.1 * share])
    reach = np.asarray(flare * narrower, float)
    rings = stacked(z, np.array([x, y]), reach, level(6, 16), power=3.5)
    material = "cloth" if large else "leather"
    parts = [bound(loft(rings, material, color), wrist)]
    turn = np.linspace(0.0, np.pi, level(4, 9))
    for side in (-0.007, 0.007):
        path = np.column_stack([np.full(len(turn), x + side), y + 0.042 * np.cos(turn),
                                top - 0.01 + 0.080 * np.sin(turn) ** 0.8])  # fmt: skip
        parts.append(bound(tube(path, 0.0035, material, color, sides=4), wrist))
    return parts
