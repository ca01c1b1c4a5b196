"""The skin of a fine car's lower body, and what lies on it: patches, ribbons and rims.

A place on the skin is a way round the car and a height. The way is 0 in the middle of the nose, 1
where the left flank begins, 2 where it ends and 3 in the middle of the tail; the right side has the
same ways below 0 and, from the tail on, above 3. In plan nose and tail are superellipses, upright
the skin follows profiles with creases, so that what is laid on it follows both.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cityx.assets.shapes import Color
from cityx.assets.vehicles.car_bodies import Body, waist_of
from cityx.city.mesh import MeshBatch, one_mesh
from cityx.geometry.arrays import FloatArray

SILL = 0.20  # metres, lower edge of the body above the road
ARCH_GAP = 0.055  # metres between a tyre and the arch over it
PROUD = 0.004  # metres by which what lies on the skin stands before it
REAR_SHELF = 0.16  # metres from the tail to the foot of the rear window at least
_SUNK = -0.008  # metres, where the rims of patches end
WHITE: Color = (1.0, 1.0, 1.0)

# Shares of the height from the sill to the upper edge: rows of the skin, closest at creases.
LEVELS = np.array([0.0, 0.05, 0.10, 0.16, 0.24, 0.33, 0.42, 0.50, 0.53, 0.57, 0.66, 0.74, 0.765,
                   0.84, 0.90, 0.95, 0.98, 1.0])  # fmt: skip


def _profile(*knots: tuple[float, float]) -> FloatArray:
    """Metres by which the skin lies within its plan, at each of `LEVELS`."""
    at, inset = np.array(knots).T
    return np.interp(LEVELS, at, inset)


_FLANK = _profile((0.0, 0.060), (0.05, 0.022), (0.10, 0.002), (0.16, 0.014), (0.33, 0.024),
                  (0.50, 0.018), (0.66, 0.006), (0.74, 0.0), (0.765, 0.010), (0.84, 0.024),
                  (0.90, 0.034), (0.95, 0.044), (0.98, 0.054), (1.0, 0.070))  # fmt: skip
_BOX_FLANK = _profile((0.0, 0.050), (0.05, 0.016), (0.10, 0.002), (0.16, 0.008), (0.42, 0.008),
                      (0.57, 0.004), (0.74, 0.0), (0.765, 0.009), (0.90, 0.016), (0.98, 0.028),
                      (1.0, 0.040))  # fmt: skip
_NOSE = _profile((0.0, 0.070), (0.05, 0.040), (0.10, 0.026), (0.33, 0.003), (0.42, 0.0),
                 (0.50, 0.003), (0.53, 0.020), (0.74, 0.030), (0.84, 0.036), (0.90, 0.044),
                 (0.95, 0.060), (0.98, 0.080), (1.0, 0.105))  # fmt: skip
_TAIL = _profile((0.0, 0.070), (0.10, 0.030), (0.33, 0.004), (0.42, 0.0), (0.50, 0.002),
                 (0.53, 0.028), (0.57, 0.034), (0.74, 0.026), (0.765, 0.034), (0.90, 0.040),
                 (0.95, 0.044), (0.98, 0.054), (1.0, 0.075))  # fmt: skip


def skinned(
    points: FloatArray, material: str | tuple[str, ...], tint: ArrayLike = WHITE, *,
    kinds: NDArray[np.int64] | None = None, around: bool = False,
) -> MeshBatch:  # fmt: skip
    """Skin a grid of points, (m, k, 3), that looks to where its rows cross its columns.

    `kinds` are the rows of the materials, (m - 1, k - 1); `around` joins the last row to the first.
    """
    m, k, _ = points.shape
    at = np.arange(m * k).reshape(m, k)
    if around:
        at = np.vstack([at, at[:1]])
    faces = np.stack([at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]], axis=-1).reshape(-1, 4)
    named = (material,) if isinstance(material, str) else material
    chosen = 0 if kinds is None else kinds.ravel()
    return one_mesh(0, points.reshape(-1, 3), faces, material=chosen, materials=named, tint=tint)


def mirrored(points: FloatArray) -> FloatArray:
    """Return a grid of points of the other side, which looks outward as well."""
    return np.asarray(points[::-1] * [-1.0, 1.0, 1.0])


def cabin_line(body: Body) -> FloatArray:
    """Return stations of a cabin as of `Body.roof`, whose rear foot stands on the boot."""
    line = np.array(body.roof)
    line[-1, 0] = min(line[-1, 0], 1 - REAR_SHELF / body.length)
    line[-2, 0] = min(line[-2, 0], line[-1, 0] - 0.02)
    return line


@dataclass(frozen=True)
class Skin:
    """The lower body of a car as a surface.

    Attributes
    ----------
    body
        What it is of.
    """

    body: Body

    @property
    def boxy(self) -> bool:
        """Whether its flanks are as upright as those of vans."""
        return self.body.kind == "van" or self.body.kei

    @property
    def deep(self) -> tuple[float, float]:
        """Metres along which nose and tail curve into the flanks."""
        return (0.36, 0.22) if self.boxy else (0.52, 0.32)

    @property
    def bluntness(self) -> tuple[float, float]:
        """Exponents of the superellipses of nose and tail."""
        return (3.2, 3.8) if self.boxy else (2.5, 3.0)

    def top(self, x: ArrayLike, y: ArrayLike) -> FloatArray:
        """Height of the upper edge and of bonnet and boot, at x and at metres behind the nose."""
        share = np.asarray(y, float) / self.body.length
        ahead = np.clip(1 - share / 0.20, 0.0, 1.0)
        behind = np.clip(1 - (1 - share) / 0.12, 0.0, 1.0)
        line = waist_of(self.body, share + 0.040 * ahead - 0.030 * behind)
        out = np.asarray(x, float) / (0.92 * self.body.width / 2)
        crown = 0.035 * np.clip(ahead * 4, 0, 1) * np.maximum(0.0, 1 - out**2)
        return np.asarray(line + crown)

    def plan(self, way: ArrayLike) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Return x, metres behind the nose, and the outward normal in plan, of ways."""
        place = np.asarray(way, float)
        side = np.where((place < 0) | (place > 3), -1.0, 1.0)
        at = np.abs(place)
        at = np.where(at > 3, 6 - at, at)
        half, length = self.body.width / 2, self.body.length
        (nose, tail), (a, b) = self.deep, self.bluntness
        turn = np.where(at < 1.5, np.minimum(at, 1.0), np.minimum(3 - at, 1.0)) * np.pi / 2
        power = np.where(at < 1.5, a, b)
        depth = np.where(at < 1.5, nose, tail)
        across = np.sin(turn) ** (2 / power)
        along = np.maximum(np.cos(turn), 0.0) ** (2 / power)
        flank = nose + (np.clip(at, 1.0, 2.0) - 1) * (length - nose - tail)
        y = np.where(at < 1.5, flank - depth * along, flank + depth * along)
        nx, ny = across ** (power - 1) / half, along ** (power - 1) / depth
        size = np.hypot(nx, ny)
        return side * half * across, y, side * nx / size, np.where(at < 1.5, -ny, ny) / size

    def ahead(self, share: ArrayLike) -> FloatArray:
        """Return the ways of places on the nose, at shares of half the width."""
        share = np.asarray(share, float)
        turn = np.arcsin(np.abs(share) ** (self.bluntness[0] / 2)) * 2 / np.pi
        return np.asarray(np.sign(share) * turn)

    def behind(self, share: ArrayLike) -> FloatArray:
        """Return the ways of places on the tail, at shares of half the width."""
        share = np.asarray(share, float)
        turn = np.arcsin(np.abs(share) ** (self.bluntness[1] / 2)) * 2 / np.pi
        return np.asarray(3 - np.sign(share) * turn)

    def beside(self, y: ArrayLike) -> FloatArray:
        """Return the ways of places on the left flank and its corners, metres behind the nose."""
        y = np.asarray(y, float)
        (nose, tail), (a, b) = self.deep, self.bluntness
        length = self.body.length
        fore = np.arccos(np.clip((nose - y) / nose, 0, 1) ** (a / 2)) * 2 / np.pi
        aft = 3 - np.arccos(np.clip((y - length + tail) / tail, 0, 1) ** (b / 2)) * 2 / np.pi
        middle = 1 + (y - nose) / (length - nose - tail)
        return np.where(y < nose, fore, np.where(y > length - tail, aft, middle))

    def frame(
        self, way: ArrayLike, z: ArrayLike, out: float = 0.0
    ) -> tuple[FloatArray, FloatArray]:
        """Return points (..., 3) of the car at ways and heights, and outward normals in plan."""
        x, y, nx, ny = self.plan(way)
        height = np.asarray(z, float)
        level = (height - SILL) / (self.top(x, y) - SILL)
        flank = np.interp(level, LEVELS, _BOX_FLANK if self.boxy else _FLANK)
        end = np.where(ny < 0, np.interp(level, LEVELS, _NOSE), np.interp(level, LEVELS, _TAIL))
        inset = nx**2 * flank + ny**2 * end - out
        points = np.empty((*inset.shape, 3))
        points[..., 0] = x - nx * inset
        points[..., 1] = y - ny * inset - self.body.length / 2
        points[..., 2] = height
        normal = np.zeros((*inset.shape, 3))
        normal[..., 0], normal[..., 1] = nx, ny
        return points, normal

    def point(self, way: ArrayLike, z: ArrayLike, out: float = 0.0) -> FloatArray:
        """Return points (..., 3) of the car at ways and heights, `out` metres before the skin."""
        return self.frame(way, z, out)[0]

    def edge(self, way: ArrayLike) -> FloatArray:
        """Height of the upper edge at ways."""
        x, y, _, _ = self.plan(way)
        return self.top(x, y)

    def foot(self, way: ArrayLike) -> FloatArray:
        """Height of the lower edge at ways: the sill, and the arches over the wheels."""
        y = self.plan(way)[1]
        low = np.full(y.shape, SILL)
        gap, wheel = self.body.wheel + ARCH_GAP, self.body.wheel
        for axle in self.body.axles:
            over = gap**2 - (y - axle * self.body.length) ** 2
            arch = 0.92 * wheel + np.sqrt(np.maximum(over, 0.0))
            low = np.where(over > 1e-6, np.maximum(low, arch), low)
        return low

    def stations(self, arch_steps: int = 17) -> FloatArray:
        """Return the ways of the sections of the left side, from nose to tail."""
        body = self.body
        gap = body.wheel + ARCH_GAP
        over = gap * np.cos(np.linspace(np.pi, 0.0, arch_steps))
        over = np.concatenate([over, [-gap - 0.003, gap + 0.003]])
        axles = np.array(body.axles) * body.length
        y = np.concatenate([*(axle + over for axle in axles), np.linspace(0.0, body.length, 13)])
        y = y[(y > self.deep[0]) & (y < body.length - self.deep[1])]
        near = np.concatenate([axle + over for axle in axles])
        bend = np.linspace(0.0, 1.0, 21)
        ways = np.concatenate([bend, 2 + bend, self.beside(y), self.beside(near)])
        return np.asarray(np.unique(np.round(ways, 5)), float)

    def patch(
        self, way: ArrayLike, low: ArrayLike, high: ArrayLike, material: str, *,
        out: float = PROUD, rows: int = 5, tint: ArrayLike = WHITE,
    ) -> MeshBatch:  # fmt: skip
        """Lay a field on the skin: (m,) ways, and its lower and upper edge there, with a rim."""
        way = np.asarray(way, float)
        low, high = (np.broadcast_to(np.asarray(v, float), way.shape) for v in (low, high))
        z = low[:, None] + (high - low)[:, None] * np.linspace(0.0, 1.0, rows)
        face, normal = self.frame(way[:, None], z, out)
        back = face + normal * (_SUNK - out)
        face = np.concatenate([back[:, :1], face, back[:, -1:]], axis=1)
        ends = np.concatenate([back[:, :1], back, back[:, -1:]], axis=1)
        return skinned(np.concatenate([ends[:1], face, ends[-1:]]), material, tint)

    def ribbon(
        self, way: ArrayLike, z: ArrayLike, wide: float, material: str, *, out: float = 0.0025,
        tint: ArrayLike = WHITE,
    ) -> MeshBatch:  # fmt: skip
        """Draw a line of some width on the skin, through (m,) ways and heights."""
        points, normal = self.frame(way, z, out)
        along = np.gradient(points, axis=0)
        across = np.cross(normal, along)
        across *= wide / 2 / np.maximum(np.linalg.norm(across, axis=1, keepdims=True), 1e-9)
        return skinned(np.stack([points - across, points + across], axis=1), material, tint)

    def path(self, way: ArrayLike, z: ArrayLike, out: float, steps: int = 6) -> FloatArray:
        """Return points before the skin between corners at (m,) ways and heights."""
        way, z = np.asarray(way, float), np.asarray(z, float)
        at = np.linspace(0.0, len(way) - 1.0, steps * (len(way) - 1) + 1)
        places = np.arange(len(way))
        return self.point(np.interp(at, places, way), np.interp(at, places, z), out)

    def lower_body(self) -> list[MeshBatch]:
        """Make the painted skin, bonnet and boot, and the dark floor beneath."""
        left = self.stations()
        ways = np.concatenate([-left[:0:-1], left[:-1], [3.0]])
        foot, edge = self.foot(ways), self.edge(ways)
        foot = np.minimum(foot, edge - 0.12)
        z = foot[:, None] + (edge - foot)[:, None] * LEVELS
        half, end = self.body.width / 2, self.body.length / 2
        shell = self.point(ways[:, None], z)
        shell = shell[:-1] if np.allclose(shell[0], shell[-1]) else shell
        floor = np.array([[(x, y, 0.24) for x in (-0.56 * half, 0.56 * half)]
                          for y in (end - 0.12, -end + 0.12)])  # fmt: skip
        return [
            skinned(shell, "car_paint", around=True),
            skinned(floor[:, ::-1], "rubber"),
            *self._lids(),
        ]

    def _lids(self) -> list[MeshBatch]:
        """Close the body over the engine and behind the cabin."""
        length, roof = self.body.length, cabin_line(self.body)
        (nose, tail), side = self.deep, np.linspace(-1.0, 1.0, 41)
        fore = self.edge_line(side)
        ahead = self._lid(fore, max(roof[0][0] * length + 0.06, nose + 0.02), panel=0.016)
        aft = self.edge_line(np.linspace(4.0, 2.0, 41))
        behind = self._lid(aft, min(roof[-1][0] * length - 0.05, length - tail - 0.02))
        return [skinned(ahead[::-1], "car_paint"), skinned(behind, "car_paint")]

    def _lid(self, edge: FloatArray, last: float, panel: float = 0.0) -> FloatArray:
        """Rule a grid from an edge to a line across the car, metres behind the nose.

        `panel` is the height of what is raised between two creases that run to the lamps.
        """
        side, rows = np.linspace(-1.0, 1.0, len(edge)), np.linspace(0.0, 1.0, 6)
        far = np.column_stack([side * abs(edge[0, 0]),
                               np.full(len(edge), last - self.body.length / 2)])  # fmt: skip
        flat = edge[None, :, :2] + (far - edge[:, :2])[None] * rows[:, None, None]
        y = flat[..., 1] + self.body.length / 2
        z = self.top(flat[..., 0], y)
        z[0] = edge[:, 2]
        z[:, (0, -1)] = self.edge(self.beside(y[:, (0, -1)]))
        raised = np.interp(np.abs(np.sin(side * np.pi / 2)), [0.0, 0.80, 0.86], [1.0, 0.8, 0.0])
        z += panel * raised * np.interp(rows, [0.0, 0.25, 1.0], [0.0, 1.0, 0.8])[:, None]
        return np.concatenate([flat, z[..., None]], axis=-1)

    def breadth(self, y: FloatArray) -> FloatArray:
        """Half the breadth between the upper edges at metres behind the nose."""
        line = self.edge_line(np.linspace(0.0, 3.0, 121))
        at = line[:, 1] + self.body.length / 2
        return np.interp(y, np.maximum.accumulate(at), line[:, 0])

    def edge_line(self, way: ArrayLike) -> FloatArray:
        """Return the points of the upper edge of the skin at ways."""
        return self.point(way, self.edge(way))
