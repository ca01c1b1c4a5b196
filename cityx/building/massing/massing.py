"""Massing: a building's volume grows by rewriting, over plan polygons and intervals of height.

An L-system whose words are volumes: it starts with one symbol on the whole footprint, and every
rule replaces a volume by smaller ones, each with a symbol of its own. What has no rule, or lies
deeper than asked, is built. Noise varies the measures of rules smoothly over the plan.

References
----------
Parish and Mueller, "Procedural modeling of cities", SIGGRAPH 2001.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import shapely
from shapely import affinity

from cityx.geometry.noise import gradient_noise_at
from cityx.ids import draw, stable_id

LEAST_AREA = 16.0  # square metres; a smaller volume is no room
LEAST_WIDTH = 2.4  # metres
GRID = 0.01  # metres, the plan's grid
WAVE = 90.0  # metres of the largest waves of the noise
MAX_DEPTH = 8


@dataclass(frozen=True)
class Mass:
    """One upright volume of a building.

    Attributes
    ----------
    plan
        Its outline.
    low, high
        Metres above the building's ground, roof included.
    zone
        Which look of the generator it wears, "" for the main one.
    roof
        Value of roof:shape.
    rise
        Metres of `high` that the roof takes.
    direction
        Compass radians of the roof's downward slope, NaN where the roof may choose.
    across
        Whether the ridge runs across the longer side.
    walls
        False for a roof on posts.
    """

    plan: shapely.Polygon
    low: float
    high: float
    zone: str = ""
    roof: str = "flat"
    rise: float = 0.0
    direction: float = math.nan
    across: bool = False
    walls: bool = True

    @property
    def height(self) -> float:
        """Metres from foot to top."""
        return self.high - self.low


@dataclass(frozen=True)
class Axes:
    """The smallest box around a plan: its middle, unit vectors and sizes.

    Attributes
    ----------
    middle, along, across
        (2,) each; `across` points to the front of the building.
    length, width
        Metres along and across.
    """

    middle: np.ndarray[Any, np.dtype[np.float64]]
    along: np.ndarray[Any, np.dtype[np.float64]]
    across: np.ndarray[Any, np.dtype[np.float64]]
    length: float
    width: float

    def place(self, shape: Any) -> Any:
        """Take a shape from the box's own frame (x along, y to the front) into the scene."""
        (a, c), (b, d) = self.along, self.across
        return affinity.affine_transform(shape, [a, b, c, d, self.middle[0], self.middle[1]])

    def box(self, x0: float, y0: float, x1: float, y1: float) -> shapely.Polygon:
        """Return a rectangle given in the box's own frame, metres from its middle."""
        return self.place(shapely.box(x0, y0, x1, y1))

    @property
    def compass(self) -> float:
        """Compass direction of the front, radians."""
        return math.atan2(self.across[0], self.across[1])


@dataclass(frozen=True)
class Plot:
    """What a building is grown on.

    Attributes
    ----------
    plan
        Its footprint.
    height, levels
        Metres with roof, and storeys.
    key
        The building's id: all draws follow from it and the seed.
    seed
        Seed of the city.
    front
        (x, y) towards the nearest street, (0, 0) where there is none.
    roof, rise
        The roof that the input or its surroundings give, and its metres.
    said
        Whether the input names that roof.
    noise
        0 to 1: how far measures vary; 0 is regular.
    box
        Corners of the smallest box around the plan, where they are known.
    """

    plan: shapely.Polygon
    height: float
    levels: int
    key: int
    seed: int = 0
    front: tuple[float, float] = (0.0, 0.0)
    roof: str = "flat"
    rise: float = 0.0
    said: bool = False
    noise: float = 0.5
    box: tuple[tuple[float, float], ...] = ()

    @property
    def storey(self) -> float:
        """Metres of a storey."""
        return (self.height - self.rise) / max(self.levels, 1)

    def draw(self, purpose: str, k: int = 0) -> float:
        """Draw a number in [0, 1)."""
        return draw(self.seed, f"massing/{purpose}", self.key, k)

    def draws(self, purpose: str, count: int) -> list[float]:
        """Draw some numbers in [0, 1) at once; without noise they are all a half."""
        if not self.noise:
            return [0.5] * count
        return [self.draw(purpose, number) for number in range(count)]

    def between(self, purpose: str, low: float, high: float) -> float:
        """Draw a number; without noise it is the middle."""
        middle, half = (low + high) / 2, (high - low) / 2
        return middle + half * (2 * self.draw(purpose) - 1) * min(1.0, 2 * self.noise)

    def pick(self, purpose: str, words: Sequence[str], weights: Sequence[float] = ()) -> str:
        """Draw one of some words."""
        edges = np.cumsum(np.array(weights or [1.0] * len(words), float))
        at = np.searchsorted(edges, self.draw(purpose) * edges[-1], side="right")
        return words[min(int(at), len(words) - 1)]

    def waver(self, purpose: str, value: float, mass: Mass) -> float:
        """Vary a measure by noise over the place and height of a volume, by half at most."""
        if not self.noise:
            return value
        x, y = mass.plan.centroid.coords[0]
        seed = stable_id(self.seed, purpose, self.key) & 0x7FFFFFFF
        at = (x + 0.7 * mass.low) / WAVE, (y + 0.4 * mass.low) / WAVE
        return value * (1.0 + 0.5 * self.noise * gradient_noise_at(seed, *at, octaves=2))

    def floor(self, height: float) -> float:
        """Return the height of the floor nearest to a height."""
        return round(height / self.storey) * self.storey

    @property
    def body(self) -> Mass:
        """The plain volume of the plot, with the roof it came with."""
        return Mass(self.plan, 0.0, self.height, "", self.roof, self.rise)

    def axes(self, plan: Any = None) -> Axes:
        """Return the axes of a plan, or of the plot's own."""
        if plan is None or plan is self.plan:
            return axes_of(self.plan, self.front, box=self.box)
        return axes_of(plan, self.front)


Successors = Sequence[tuple[str, Mass]]
Rule = Callable[[Mass, Plot], Successors]


def axes_of(
    plan: Any, front: tuple[float, float] = (0.0, 0.0), *, box: Sequence[tuple[float, float]] = ()
) -> Axes:
    """Return the axes of a plan, `across` turned to the front (or to the south and east).

    Parameters
    ----------
    box
        Corners of the smallest box around the plan, where they are known.
    """
    corner = list(box) or _box_of(plan)
    (x0, y0), (x1, y1), (x2, y2) = corner[:3]
    first, second = math.hypot(x1 - x0, y1 - y0), math.hypot(x2 - x1, y2 - y1)
    long = max(first, second, 1e-9)
    ux, uy = ((x1 - x0), (y1 - y0)) if first >= second else ((x2 - x1), (y2 - y1))
    fx, fy = -uy / long, ux / long
    facing = front if front[0] or front[1] else (0.01, -1.0)
    if fx * facing[0] + fy * facing[1] < 0:
        fx, fy = -fx, -fy
    across, along = np.array([fx, fy]), np.array([fy, -fx])  # right-handed: along, front
    middle = np.array([(x0 + x2) / 2, (y0 + y2) / 2])
    return Axes(middle, along, across, long, min(first, second))


def _box_of(plan: Any) -> list[tuple[float, float]]:
    ring = shapely.get_coordinates(shapely.oriented_envelope(plan))[:4]
    if len(ring) < 4:
        ring = shapely.get_coordinates(shapely.envelope(plan))[:4]
    return [(float(x), float(y)) for x, y in ring]


def pieces(plan: Any) -> list[shapely.Polygon]:
    """Split what an operation on plans returned into usable polygons, largest first."""
    snapped = shapely.set_precision(shapely.make_valid(plan), GRID)
    parts = [part for part in shapely.get_parts(snapped) if part.geom_type == "Polygon"]
    kept = [
        part
        for part in parts
        if part.area >= LEAST_AREA and not part.buffer(-LEAST_WIDTH / 2).is_empty
    ]
    kept.sort(key=lambda part: (-round(part.area, 2), *np.round(part.bounds, 2)))
    return kept


def grow(
    plot: Plot,
    rules: Mapping[str, Rule],
    *,
    start: str = "lot",
    depth: int = 4,
    axiom: Mass | None = None,
) -> tuple[Mass, ...]:
    """Rewrite the volume of a plot.

    Parameters
    ----------
    rules
        Symbol to the rule that rewrites it.
    start
        Symbol of the whole.
    depth
        How often a volume may be rewritten; 0 builds the plain block.
    axiom
        The whole, where it is not the body of the plot.

    Returns
    -------
    masses
        Volumes that share no interior, in the order in which they grew.
    """
    done: list[Mass] = []
    open_: list[tuple[str, Mass, int]] = [(start, axiom or plot.body, 0)]
    while open_:
        symbol, mass, level = open_.pop(0)
        rule = rules.get(symbol)
        found = rule(mass, plot) if rule and level < min(depth, MAX_DEPTH) else ()
        if found:
            open_ += [(word, each, level + 1) for word, each in found]
        else:
            done.append(mass)
    return tuple(done)


# --- rules ---------------------------------------------------------------------------------------


def cut_level(mass: Mass, plot: Plot, share: float) -> float:
    """Return the floor nearest to a share of a volume's height, or NaN where none fits."""
    level = mass.low + round(share * mass.height / plot.storey) * plot.storey
    inside = mass.low + 0.9 * plot.storey < level < mass.high - 0.9 * plot.storey
    return level if inside else math.nan


def stacked(mass: Mass, level: float, upper: Any, *, foot: str, then: str, zone: str | None = None,
            foot_zone: str | None = None) -> Successors:  # fmt: skip
    """Split a volume at a height: below keeps its plan, above stands on `upper`."""
    tops = pieces(upper)
    if not tops or math.isnan(level):
        return ()
    own = mass.zone if zone is None else zone
    below = replace(mass, high=level, roof="flat", rise=0.0,
                    zone=mass.zone if foot_zone is None else foot_zone)  # fmt: skip
    return [(foot, below)] + [(then, replace(mass, plan=top, low=level, zone=own)) for top in tops]


# --- plans in their own frame --------------------------------------------------------------------

SLIVER = 4.0  # square metres; what a cut leaves smaller than this stays with the piece it lies at
SHRED = 0.6  # square metres; a smaller volume is left out


@dataclass(frozen=True)
class Site:
    """A plan in the frame of its box: x along it, y to the front, the box's middle at the origin.

    Attributes
    ----------
    axes
        The box, in the scene.
    plan
        The plan, in the frame.
    """

    axes: Axes
    plan: Any

    @property
    def half(self) -> tuple[float, float]:
        """Half length and half width of the box, metres."""
        return self.axes.length / 2, self.axes.width / 2

    def turned(self) -> Site:
        """Return the site looked at from the other end of its length."""
        axes = replace(self.axes, along=-self.axes.along)
        return Site(axes, affinity.scale(self.plan, -1.0, 1.0, origin=(0.0, 0.0)))

    def compass(self, x: float, y: float) -> float:
        """Compass direction of a vector of the frame, radians."""
        east, north = x * self.axes.along + y * self.axes.across
        return math.atan2(east, north)

    def masses(self, shape: Any, low: float, high: float, zone: str = "", roof: str = "flat",
               rise: float = 0.0, *, down: tuple[float, float] | None = None,
               across: bool = False, walls: bool = True) -> list[Mass]:  # fmt: skip
        """Return a volume for every polygon of a shape given in the frame.

        Parameters
        ----------
        down
            Vector of the frame that the roof slopes down to.
        """
        if high - low < GRID:
            return []
        direction = math.nan if down is None else self.compass(*down)
        parts = (part for part in shapely.get_parts(shape) if part.geom_type == "Polygon")
        return [
            Mass(self.axes.place(part), low, high, zone, roof, rise, direction, across, walls)
            for part in parts
            if part.area > SHRED
        ]


def site_of(plot: Plot, *, facing: bool = True) -> Site:
    """Return a plot's plan in the frame of its box.

    With `facing` x runs along the side of the box at the street, be it the longer one or not.
    """
    shape = plot.plan
    axes = axes_of(shape, plot.front)
    turn = float(axes.along @ np.asarray(plot.front, float))
    if facing and abs(turn) > abs(float(axes.across @ np.asarray(plot.front, float))):
        across = math.copysign(1.0, turn) * axes.along
        along = np.array([across[1], -across[0]])
        axes = Axes(axes.middle, along, across, axes.width, axes.length)
    (a, c), (b, d), (x, y) = axes.along, axes.across, axes.middle
    local = affinity.affine_transform(shape, [a, c, b, d, -(a * x + c * y), -(b * x + d * y)])
    return Site(axes, shapely.set_precision(local, GRID))


def carve(plan: Any, tool: Any) -> tuple[Any, Any]:
    """Cut a plan by a tool: what lies within, and the rest; slivers stay where they touch."""
    inside = shapely.intersection(plan, tool, grid_size=GRID)
    rest = shapely.difference(plan, tool, grid_size=GRID)
    if inside.area < SLIVER:
        return shapely.Polygon(), plan
    parts = [part for part in shapely.get_parts(rest) if part.geom_type == "Polygon"]
    thin = [p for p in parts if p.area < SLIVER or p.buffer(-LEAST_WIDTH / 4).is_empty]
    if thin:
        inside = shapely.union_all(np.array([inside, *thin], object), grid_size=GRID)
    good = np.array([part for part in parts if part not in thin], object)
    return _areal(inside), shapely.multipolygons(good)


def _areal(shape: Any) -> Any:
    parts = [part for part in shapely.get_parts(shape) if part.geom_type == "Polygon"]
    return shapely.multipolygons(np.array(parts, object))


def disc(x: float, y: float, radius: float, sides: int = 12, turn: float = 0.5) -> shapely.Polygon:
    """Return a regular polygon whose sides touch a circle, `turn` sides past the x axis."""
    angle = (np.arange(sides) + turn) * (2 * math.pi / sides)
    reach = radius / math.cos(math.pi / sides)
    return shapely.Polygon(np.column_stack([x + reach * np.cos(angle), y + reach * np.sin(angle)]))


def widest(plan: Any) -> tuple[float, float, float]:
    """Return the middle and the radius of the widest circle in a plan."""
    line = shapely.maximum_inscribed_circle(plan, tolerance=0.2)
    return (*shapely.get_coordinates(line)[0].tolist(), float(line.length))


def remainder(site: Site, masses: Sequence[Mass], high: float, zone: str = "") -> list[Mass]:
    """Return low volumes on what volumes that stand on the ground have left open of a site."""
    ground = [mass.plan for mass in masses if mass.low < GRID and mass.walls]
    if not ground:
        return site.masses(site.plan, 0.0, high, zone)
    whole = site.axes.place(site.plan)
    left = shapely.difference(whole, shapely.union_all(np.array(ground, object)), grid_size=GRID)
    left = left.buffer(-0.05).buffer(0.05, join_style="mitre")
    parts = [part for part in shapely.get_parts(left) if part.area > 1.0]
    return [Mass(part, 0.0, high, zone) for part in parts]


COURT = 5.0  # metres; a narrower court gives no light
