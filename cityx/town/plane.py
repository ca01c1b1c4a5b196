"""The plane that every procedural town is a window of: fields, districts, and the roads between.

Whatever is asked for here is a function of the seed, the plan and a place alone; nothing depends
on the window that is made, on its neighbours or on the order of questions. Places are whole
millimetres.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri

from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.noise import gradient_noise
from cityx.geometry.parcels.lattice import (
    PER_METRE,
    Cell,
    Corner,
    Key,
    Lattice,
    lattice_cell,
    lattice_cells,
)
from cityx.ids import draw, hash_bits, hash_ids, uniform
from cityx.places.profile import TOP, Profile
from cityx.places.profiles import profile_named

PATTERNS = ("mixed", "grid", "radial", "organic", "cul_de_sac", "superblock")
ZONES = ("core", "midrise", "row", "suburb", "rural")
WIDTHS = ("usual", "narrow", "wide")  # of streets
COASTS = ("none", "north", "east", "south", "west")
# Least density of each of `ZONES` but the last.
DENSITY = (0.8, 0.48, 0.28, 0.12)
SPREAD = {1: 0.304, 2: 0.227}  # standard deviation of gradient noise by octaves, measured

CENTRES = 6000.0  # metres between the centres of towns
FIRST = 500.0  # metres of the radius of a town
QUARTER = 4.0  # districts along a quarter, whose streets share directions and main roads a rank
BENT = {"grid": 0.0, "superblock": 0.1, "radial": 0.5, "organic": 1.0, "cul_de_sac": 0.8,
        "mixed": 0.6}  # fmt: skip
SHAKEN = {"grid": 0.08, "superblock": 0.15, "radial": 0.25, "organic": 0.35, "cul_de_sac": 0.3,
          "mixed": 0.26}  # fmt: skip
WAVE = 900.0  # metres of the waves that main roads are bent by
BEND = 38.0  # metres they are moved by at most; steeper waves would make corners acute
SAMPLE = 30.0  # metres between the points of a bent road
JOINED = 0.24  # of the pitch; corners of districts nearer than that are one junction
LAKE_WAVE, COAST_WAVE, RIVER_WAVE = 1500.0, 1200.0, 2600.0  # metres
SHORE = 260.0  # metres by which a coast swings
_COAST = {"north": (0.0, 1.0), "east": (1.0, 0.0), "south": (0.0, -1.0), "west": (-1.0, 0.0)}


@dataclass(frozen=True)
class StreetBounds:
    """Least and greatest metres of carriageways, and of their lanes."""

    least: float = 0.0
    most: float = 60.0
    least_lanes: int = 1
    most_lanes: int = 12


@dataclass(frozen=True)
class Plan:
    """What is asked of a town.

    Attributes
    ----------
    pattern
        One of `PATTERNS`; "mixed" chooses a pattern for each district.
    density
        Of the middle of the town, 0 (scattered houses) to 1 (towers).
    radius
        Metres from the middle to open country.
    district
        Metres between main roads.
    block
        Metres along a block of houses.
    zone
        One of `ZONES` or "industry" for every block, or "" to let the density decide.
    parks
        Share of the land that is parks.
    plazas
        Share of the districts of a town's middle that have a plaza.
    industry
        Share of the outer districts that are industrial.
    river, river_width
        Whether a river flows by; metres of water.
    lakes, coast
        Share of the districts that are lakes; where the sea lies.
    shore
        Metres from the origin to the sea.
    streets
        One of `WIDTHS`.
    avenues, rings
        Of a site with radial streets: avenues that leave its square, and rings that join them.
    built
        Share of the parcels that buildings take, or 0 to let the zone decide.
    main, local
        Bounds of the carriageways of main roads, and of all other streets.
    blocks, columns, rows
        Of a site with a grid: blocks that its streets enclose, and how many beside each other from
        west to east and from south to north; 0 for as many as there is room for.
    block_width, block_depth
        Metres of such a block between the walks of its streets, 0 for what is usual.
    turn_deg
        Degrees counter-clockwise by which the grid is turned.
    """

    pattern: str = "mixed"
    density: float = 0.66
    radius: float = FIRST
    district: float = 330.0
    block: float = 110.0
    zone: str = ""
    parks: float = 0.10
    plazas: float = 0.7
    industry: float = 0.15
    river: bool = False
    river_width: float = 26.0
    lakes: float = 0.0
    coast: str = "none"
    shore: float = 400.0
    streets: str = "usual"
    avenues: int = 6
    rings: int = 2
    built: float = 0.0
    main: StreetBounds = field(default_factory=StreetBounds)
    local: StreetBounds = field(default_factory=StreetBounds)
    blocks: int = 0
    columns: int = 0
    rows: int = 0
    block_width: float = 0.0
    block_depth: float = 0.0
    turn_deg: float = 0.0

    @property
    def is_dry(self) -> bool:
        """Whether it has no water of the plane, which follows districts."""
        return not self.river and not self.lakes and self.coast == "none"

    @property
    def asks_for_blocks(self) -> bool:
        """Whether the blocks or the direction of its grid are said."""
        return bool(
            self.blocks or self.columns or self.rows
            or self.block_width or self.block_depth or self.turn_deg
        )  # fmt: skip


class Plane:
    """Fields and districts of one seed and plan; answers are kept, for they are asked for often."""

    def __init__(self, plan: Plan, seed: int, profile: Profile | None = None) -> None:
        self.plan = plan
        self.seed = seed
        self.profile = profile or profile_named(TOP)
        angle = (draw(seed, "town/angle", 1) - 0.5) * math.pi / 2
        pattern = plan.pattern
        self.lattice = Lattice(
            hash_bits(seed, "town/lattice", 1) >> 1, plan.district, SHAKEN[pattern], angle,
            JOINED * plan.district,
        )  # fmt: skip
        self.quarters = Lattice(
            hash_bits(seed, "town/quarters", 1) >> 1, QUARTER * plan.district, 0.35, angle
        )
        self._cells: dict[Key, Cell] = {}
        self._edges: dict[tuple[Key, Key], IntArray] = {}
        self._densities: dict[Key, float] = {}
        self._quarters: dict[Key, Key] = {}
        self._waters: dict[Key, str] = {}
        self._banks: dict[Key, int] = {}

    def noise(self, purpose: str, places: IntArray, wave: float, octaves: int = 1) -> FloatArray:
        """Evaluate noise of its own for each purpose, (n,) of unit spread."""
        at = np.asarray(places).reshape(-1, 2) / (PER_METRE * wave)
        seed = hash_bits(self.seed, purpose, 1) >> 1
        return np.asarray(gradient_noise(seed, at, octaves=octaves) / SPREAD[octaves])

    def survey(self, keys: Sequence[Key]) -> None:
        """Work out cells, sides, densities and quarters of districts near each other at once."""
        keys = [key for key in keys if key not in self._cells]
        if not keys:
            return
        cells = lattice_cells(self.lattice, keys)
        self._cells.update(zip(keys, cells, strict=True))
        sites = np.stack([cell.site for cell in cells])
        self._densities.update(zip(keys, self.density(sites).tolist(), strict=True))
        quarters = [(i, j) for i, j in self.quarter(sites).tolist()]
        self._quarters.update(zip(keys, quarters, strict=True))
        pairs = {(a, b) for a in keys for b in self._cells[a].beyond if a < b}
        self._bend(pair for pair in sorted(pairs) if pair[1] in self._cells)

    def cell(self, key: Key) -> Cell:
        """Return the cell of a district before its main roads are bent."""
        if key not in self._cells:
            self._cells[key] = lattice_cell(self.lattice, key)
        return self._cells[key]

    def bent(self, places: IntArray) -> IntArray:
        """Move places as the main roads are bent, (n, 2)."""
        share = BENT[self.plan.pattern]
        if not share:
            return places
        reach = share * BEND * PER_METRE * SPREAD[1]
        moved = np.stack([self.noise(f"town/bend-{k}", places, WAVE) for k in "xy"], axis=1)
        return np.asarray(places + np.rint(reach * moved), np.int64)

    def edge(self, a: Key, b: Key) -> IntArray:
        """Return the side between two cells, (k, 2), the lower cell on its left."""
        a, b = min(a, b), max(a, b)
        if (a, b) not in self._edges:
            self._bend([(a, b)])
        return self._edges[a, b]

    def _bend(self, pairs: Iterable[tuple[Key, Key]]) -> None:
        """Bend the sides between cells that are not bent yet."""
        pairs = [pair for pair in pairs if pair not in self._edges]
        lines = [self._straight(a, b) for a, b in pairs]
        if lines:
            bent = self.bent(np.concatenate(lines))
            edges = np.split(bent, np.cumsum([len(line) for line in lines])[:-1])
            self._edges.update(zip(pairs, edges, strict=True))

    def _straight(self, a: Key, b: Key) -> IntArray:
        """Return points along the side of the lower of two cells before it is bent, (k, 2)."""
        cell = self.cell(a)
        m = cell.beyond.index(b)
        start, end = cell.places[m], cell.places[(m + 1) % len(cell.places)]
        length = float(np.hypot(*((end - start) / PER_METRE)))
        count = max(round(length / SAMPLE), 2) if BENT[self.plan.pattern] else 1
        t = np.arange(count + 1)[:, None] / count
        return np.asarray(start + np.rint((end - start) * t).astype(np.int64))

    def corner(self, name: Corner) -> IntArray:
        """Return a corner of cells, (2,)."""
        cell = self.cell(name[0])
        return np.asarray(self.bent(cell.places[cell.corners.index(name)][None])[0])

    def quarter(self, places: IntArray) -> IntArray:
        """Return the quarter of each place, (n, 2)."""
        return self.quarters.nearest(places)

    def density(self, places: IntArray) -> FloatArray:
        """Return how densely places are to be built, (n,) 0 to 1.

        Towns lie on a lattice of their own, smaller ones more often; the first lies at the origin.
        """
        places = np.asarray(places, np.int64).reshape(-1, 2)
        base = np.rint(places / (PER_METRE * CENTRES)).astype(np.int64)
        around = np.array([(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1)])
        keys = (base[:, None] + around).reshape(-1, 2)
        near = self._town(keys, np.repeat(places, len(around), axis=0))
        found = near.reshape(-1, len(around)).max(axis=1)
        rough = 0.05 * self.noise("town/density", places, 180.0)
        return np.asarray(np.clip(found + np.where(found > 0, rough, 0.0), 0.0, 1.0))

    def site_density(self, key: Key) -> float:
        """Return the density at the middle of a district."""
        if key not in self._densities:
            self._densities[key] = float(self.density(self.cell(key).site[None])[0])
        return self._densities[key]

    def quarter_of(self, key: Key) -> Key:
        """Return the quarter of a district."""
        if key not in self._quarters:
            i, j = self.quarter(self.cell(key).site[None])[0].tolist()
            self._quarters[key] = i, j
        return self._quarters[key]

    def _town(self, keys: IntArray, places: IntArray) -> FloatArray:
        ids = hash_ids(self.seed, "town/centre", keys[:, 0].astype(np.uint64), keys[:, 1])
        first = (keys == 0).all(axis=1)
        shaken = np.stack([uniform(self.seed, "town/at", ids, k) - 0.5 for k in (0, 1)], axis=1)
        shaken[first] = 0.0
        at = np.rint((keys + 0.6 * shaken) * CENTRES * PER_METRE).astype(np.int64)
        # A power law: a town of half the size is found twice as often.
        size = np.where(first, 1.0, 0.3 / (0.3 + 0.7 * uniform(self.seed, "town/size", ids, 2)))
        away = np.hypot(*((places - at) / PER_METRE).T) / (2.0 * self.plan.radius * size)
        peak = self.plan.density * np.where(first, 1.0, size**0.5)
        # Half of the middle's density is left at 0.54 of the reach, none beyond it.
        return np.asarray(peak * np.maximum(1.0 - away**2, 0.0) ** 2)

    def zone(self, density: FloatArray, ids: NDArray[np.uint64]) -> NDArray[Any]:
        """Return the zone of blocks by their density, with a margin that is drawn."""
        if self.plan.zone:
            return np.full(len(density), self.plan.zone, object)
        shifted = density + 0.06 * (uniform(self.seed, "town/zone", ids) - 0.5)
        return np.array(ZONES, object)[np.searchsorted(-np.array(DENSITY), -shifted)]

    def is_wet(self, key: Key) -> bool:
        """Return whether a district is a lake or the sea."""
        return bool(self.water_kind(key))

    def water_kind(self, key: Key) -> str:
        """Return the kind of water that a wet district is, "" for a dry one."""
        if key not in self._waters:
            self._waters[key] = self._water_of(self.cell(key).site[None])
        return self._waters[key]

    def _water_of(self, site: IntArray) -> str:
        plan = self.plan
        if plan.coast != "none":
            x, y = _COAST[plan.coast]
            away = (x * site[0, 0] + y * site[0, 1]) / PER_METRE
            if (
                away + SHORE * SPREAD[2] * self.noise("town/coast", site, COAST_WAVE, 2)[0]
                > plan.shore
            ):
                return "sea"
        if plan.lakes and self.noise("town/lake", site, LAKE_WAVE, 2)[0] < ndtri(plan.lakes):
            return "water"
        return ""

    def bank(self, key: Key) -> int:
        """Return the side of the river that a district lies on, 1 or -1."""
        if key not in self._banks:
            places = np.concatenate([self.cell(key).site[None], self._ford])
            here, ford = self.noise("town/river", places, RIVER_WAVE)
            self._banks[key] = 1 if here >= ford else -1
        return self._banks[key]

    @cached_property
    def _ford(self) -> IntArray:
        """A place by the middle of the first town that the river flows through, (1, 2)."""
        turn = 2 * math.pi * draw(self.seed, "town/ford", 1)
        away = 0.55 * self.plan.district * PER_METRE
        return np.rint([[away * math.cos(turn), away * math.sin(turn)]]).astype(np.int64)

    def side_kind(self, a: Key, b: Key) -> str:
        """Return what lies between two districts: "road", "river" or "water" for nothing."""
        if self.is_wet(a) and self.is_wet(b):
            return "water"
        dry = not self.is_wet(a) and not self.is_wet(b)
        if dry and self.plan.river and self.bank(a) != self.bank(b):
            return "river"
        return "road"
