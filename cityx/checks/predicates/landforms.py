"""Landforms: relief, slope and shape of the finished ground, read from its surface alone."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from cityx.city import City
from cityx.city.ground import LABEL
from cityx.geometry.arrays import BoolArray, FloatArray
from cityx.ground.standing import NOWHERE, stand_on

SPOTS = 70  # along the longer side of the site
BORDER = 0.01  # of the site, left out: walls and kerbs end there
LEVEL_RELIEF, LEVEL_SLOPE = 3.0, 0.012  # metres, and rise over run, up to which land is flat
HILLY_RELIEF, HILLY_SLOPE = 5.0, 0.015  # from which it is hilly
MOUNTAINS = 35.0  # metres of relief from which it is mountainous
STEADY = 0.8  # share of the differences in height that one plane explains where land is a slope
MARKED = 0.3  # of the relief by which a middle lies above or below the borders
EVEN = 0.3  # of the relief within which the top of a plateau lies
CORE, RIM = 0.3, 0.85  # of the way to the border: what is the middle, and what the border
TOP = 0.42  # of the same, of the top of a plateau
BANDS = 80  # across a slope, whose heights tell its steps
# Of the mean rise: that between terraces, and that on them; and the share of the way on them.
STEEP, LEVEL, LEVEL_SHARE = 1.3, 0.7, 0.4


@dataclass(frozen=True)
class Land:
    """Heights of the ground at places spread evenly over a site.

    Attributes
    ----------
    at
        (n, 2) places, -1 to 1 from border to border.
    z
        (n,) metres.
    size
        (2,) metres of the site.
    wet
        (n,) whether it is water.
    """

    at: FloatArray
    z: FloatArray
    size: FloatArray
    wet: BoolArray

    @cached_property
    def dry(self) -> Land:
        """The same without water."""
        if self.wet.all():
            return self
        keep = ~self.wet
        return Land(self.at[keep], self.z[keep], self.size, self.wet[keep])

    @cached_property
    def relief(self) -> float:
        """Metres from the lowest to the highest land."""
        z = self.dry.z
        return float(np.ptp(z)) if len(z) else 0.0

    @cached_property
    def plane(self) -> FloatArray:
        """(2,) rise over run east and north, of the plane that fits the land best."""
        land = self.dry
        if len(land.z) < 3:
            return np.zeros(2)
        half = land.size / 2
        places = np.column_stack([land.at * half, np.ones(len(land.z))])
        return np.asarray(np.linalg.lstsq(places, land.z, rcond=None)[0][:2])

    @property
    def slope(self) -> float:
        """Rise over run of that plane."""
        return float(np.hypot(*self.plane))

    @property
    def explained(self) -> float:
        """Share of the differences in height that the plane explains."""
        land = self.dry
        if not len(land.z) or land.z.var() < 1e-9:
            return 0.0
        rest = land.z - (land.at * land.size / 2) @ self.plane
        return float(1 - rest.var() / land.z.var())

    @property
    def high(self) -> tuple[str, ...]:
        """The side of the site whose land is highest, "middle" where that is higher still."""
        if self.relief <= LEVEL_RELIEF:
            return ()
        x, y = self.at.T
        sides = {"east": x > 0.5, "west": x < -0.5, "north": y > 0.5, "south": y < -0.5}
        sides["middle"] = np.abs(self.at).max(axis=1) < CORE
        means = {word: float(self.z[own].mean()) for word, own in sides.items() if own.any()}
        return (max(means, key=lambda word: means[word]),)

    @cached_property
    def steep(self) -> float:
        """Rise over run that nine tenths of the land keep below, from place to place."""
        order = np.lexsort((self.at[:, 0], np.round(self.at[:, 1], 6)))
        other = np.lexsort((self.at[:, 1], np.round(self.at[:, 0], 6)))
        found = [np.zeros(0)]
        for axis, rows in ((0, order), (1, other)):
            step = np.diff((self.at * self.size / 2)[rows], axis=0)
            beside = (np.abs(step[:, 1 - axis]) < 1e-6) & (step[:, axis] > 0)
            beside &= step[:, axis] < 1.5 * self.size[axis] / SPOTS + 1.0
            beside &= ~(self.wet[rows][1:] | self.wet[rows][:-1])
            rise = np.abs(np.diff(self.z[rows]))[beside]
            found.append(rise / step[beside, axis])
        every = np.concatenate(found)
        return float(np.percentile(every, 90)) if len(every) else 0.0

    @property
    def axis(self) -> tuple[str, ...]:
        """The way that a ridge or a valley runs: along which its middle keeps its height."""
        over = [abs(self._middle_above(self.at[:, k])) for k in (0, 1)]
        if max(over) < MARKED:
            return ()
        return ("east_west" if over[1] > over[0] else "north_south",)

    def _middle_above(self, across: FloatArray) -> float:
        """Return how far a middle lies above both its borders, in shares of the relief."""
        relief = max(float(np.ptp(self.z)), 1e-9)
        middle = self.z[np.abs(across) < CORE].mean()
        low, high = self.z[across < -RIM].mean(), self.z[across > RIM].mean()
        return float(min(middle - low, middle - high, key=abs) / relief) if (
            (middle - low) * (middle - high) > 0
        ) else 0.0  # fmt: skip

    @property
    def steps(self) -> int:
        """Number of terraces: level bands across the slope, between steep ones."""
        if self.relief <= LEVEL_RELIEF or self.slope <= 0:
            return 0
        land = self.dry
        t = (land.at * land.size / 2) @ (self.plane / self.slope)
        band = np.minimum(((t - t.min()) / max(np.ptp(t), 1e-9) * BANDS).astype(int), BANDS - 1)
        known = np.unique(band)
        profile = np.interp(
            np.arange(BANDS), known, [float(np.median(land.z[band == one])) for one in known]
        )
        rise = np.convolve(np.gradient(profile), np.ones(5) / 5, "same")
        mean = np.ptp(profile) / BANDS
        steep = rise > STEEP * mean
        if (rise < LEVEL * mean).mean() < LEVEL_SHARE:
            return 0
        runs = np.flatnonzero(steep & ~np.append(False, steep[:-1]))
        return len(runs) + 1

    @property
    def forms(self) -> tuple[str, ...]:
        """Every word of `words.LANDFORMS` that holds for the land."""
        if self.relief <= LEVEL_RELIEF or (
            self.relief <= HILLY_RELIEF and self.slope <= LEVEL_SLOPE
        ):
            return ("flat",)
        found = []
        if self.relief >= HILLY_RELIEF and self.relief / self.size.min() >= HILLY_SLOPE:
            found.append("hilly")
        if self.relief >= MOUNTAINS:
            found.append("mountainous")
        over = self._middle_above(self.at[:, 0]), self._middle_above(self.at[:, 1])
        inner = np.abs(self.at).max(axis=1) < TOP
        if min(over) >= MARKED:
            top = self.z[inner]
            even = np.percentile(top, 90) - np.percentile(top, 10) <= EVEN * self.relief
            found.append("plateau" if even else "hill")
        elif max(over) >= MARKED and min(over) > -MARKED:
            found.append("ridge")
        elif min(over) <= -MARKED:
            found.append("valley")
        if self.explained >= STEADY:
            found.append("slope")
            if self.steps >= 2:
                found.append("terraces")
        return tuple(found)


def land_of(city: City) -> Land:
    """Sample the ground of a city: its finished surface, or its terrain where none is laid."""
    low, high = np.array(city.layout.extent[:2]), np.array(city.layout.extent[2:])
    size = high - low
    counts = np.maximum(np.rint(SPOTS * size / size.max()), 8).astype(int)
    east, north = (np.linspace(-1 + 2 * BORDER, 1 - 2 * BORDER, int(n)) for n in counts)
    at = np.column_stack([np.tile(east, len(north)), np.repeat(north, len(east))])
    places = (low + high) / 2 + at * size / 2
    mesh = city.scene.meshes.get("ground")
    if mesh is None or not mesh.count:
        return Land(at, city.terrain.height_at(places), size, np.zeros(len(at), bool))
    under = stand_on(mesh, places)
    known = under.label != NOWHERE
    wet = under.label[known] == LABEL["water"]
    return Land(at[known], under.z[known], size, wet)
