"""Relief: the land under a town that no height file tells of: hills, valleys, terraces."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Annotated, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city import City
from cityx.city.asked_goals import asked, with_goal
from cityx.city.terrain import Survey, Terrain
from cityx.errors import ActionFailed
from cityx.geometry.arrays import FloatArray
from cityx.geometry.noise import gradient_noise
from cityx.ids import hash_bits
from cityx.protocol import Choice, Port, Range, action

# Up each side: x east, y north.
UP: Mapping[str, tuple[float, float]] = {
    "north": (0.0, 1.0), "east": (1.0, 0.0), "south": (0.0, -1.0), "west": (-1.0, 0.0),
}  # fmt: skip
AXES = ("west_east", "north_south")
# Metres of relief that a form has where none are said, if the site is large enough for them.
USUAL: Mapping[str, float] = {
    "hills": 18.0, "mountains": 60.0, "hill": 24.0, "ridge": 22.0, "valley": 22.0, "slope": 24.0,
    "plateau": 14.0, "terraces": 12.0,
}  # fmt: skip
# Rise over run: of what is usual, in mountains, and of what houses stand on.
GENTLE, ROUGH, STEEPEST = 0.15, 0.28, 0.35
LEAST = 7.5  # metres of hills, however gentle
NODES = 250  # of the longer side of the site
FINEST = 2.5  # metres between heights
FAR, FAR_CELL = 3000.0, 30.0  # metres round the site whose heights are made, and between them
WAVES = (0.5, 0.65, 0.8, 1.0, 1.3)  # of the site's size, of hills, tried in turn
SIDES = 0.9  # of the half of a site, over which the sides of a river's valley rise
FLOOR = 0.2  # of the way to the sides of a valley that is its floor
EDGE = 0.5  # of the way to the border of a site at which a plateau begins to fall
TREAD, LEAN = 0.6, 0.12  # of a terrace: share that is level, and of its height that it leans
# Metres from water that lie level with it: a quay and its street; and over which land rises there.
LEVEL: Mapping[str, float] = {"river": 36.0, "sea": 30.0, "water": 14.0}
RISING = 70.0
WITHIN = 0.1  # of the relief that was asked for, by which streets may cut it down
BOUND = 0.25  # metres by which the finished land may miss the heights at their places


@action(
    "terrain/relief-v1",
    requires=("layout",),
    takes=(Port("layout", "scene_layout", "layout"),),
    gives=(Port("terrain", "surface", "terrain"),),
    limits=["Water lies level; land near it is lowered or raised to it."],
    labels=("hills", "hill", "valley", "slope", "plateau", "terraces", "ridge", "relief"),
)
def relief(
    city: City,
    *,
    form: Annotated[str, Choice(*USUAL)] = "hills",
    metres: Annotated[float, Range(0.0, 400.0)] = 0.0,
    grade: Annotated[float, Range(0.0, STEEPEST)] = 0.0,
    side: Annotated[str, Choice(*UP)] = "north",
    axis: Annotated[str, Choice(*AXES)] = "west_east",
    steps: Annotated[int, Range(2, 12)] = 3,
    steepest: Annotated[float, Range(0.01, STEEPEST)] = STEEPEST,
    steep: bool = False,
) -> City:
    """Lay hills, a valley, a slope, ... under a town without a height file.

    Parameters
    ----------
    city
        City with a layout. A valley follows its river; all its water stays level.
    form
        Of the land: the town lies on the hill, the ridge or the plateau, and in the valley.
    metres
        From the lowest land of the site to the highest; 0 for what suits form and site.
    grade
        Of a slope, rise over run; 0 leaves it to the metres.
    side
        Where a slope or terraces are highest.
    axis
        Along which a valley or a ridge runs.
    steps
        Number of terraces.
    steepest
        Rise over run that the land must not exceed anywhere.
    steep
        Whether the land is as steep as streets can follow, where no metres are said.
    """
    field = _Field(city, form, side, axis, steps, city.layout.extent)
    most = min(steepest, ROUGH if steep or form == "mountains" else GENTLE)
    for share in WAVES:
        land, flat = field.made(share)
        per_metre = _steepness(land)
        if form not in ("hills", "mountains") or (metres or LEAST) * per_metre <= most:
            break
    if not per_metre:
        raise ActionFailed("The site is level water: there is no land for a relief.")
    if grade:
        metres = round(grade / _tilt(land, flat), 3)
    usual = most / per_metre if steep else min(USUAL[form], most / per_metre)
    height = metres or round(usual, 1)
    if height * per_metre > steepest + 0.005:
        raise ActionFailed(
            f"{height:g} m of relief for {_called(form)} on this site would be "
            f"{100 * height * per_metre:.0f} % steep; {100 * steepest:g} % are the most. Ask for "
            f"{steepest / per_metre:.0f} m at most, or for a larger site."
        )
    terrain = replace(land, heights=np.round(height * land.heights, 3))
    survey = Survey(_points(terrain), field.around(height), BOUND)
    city = replace(city, terrain=terrain, survey=survey, stages_done=city.stages_done | {"terrain"})
    return _with_goals(city, form, side, height, grade)


def _called(form: str) -> str:
    return form if form.endswith("s") else f"a {form}"


def _with_goals(city: City, form: str, side: str, height: float, grade: float) -> City:
    if grade:
        city = asked(city, f"a slope of {100 * grade:.3g} percent", "terrain.slope",
                     least=grade * (1 - WITHIN), most=grade * (1 + WITHIN))  # fmt: skip
    else:
        city = asked(city, f"{height:g} m of relief", "terrain.relief",
                     least=height * (1 - WITHIN), most=height * (1 + WITHIN))  # fmt: skip
    if form in ("slope", "terraces"):
        city = with_goal(city, f"highest in the {side}", f"terrain.high == {side}")
    return city


@dataclass
class _Field:
    """The land of a site: a shape from 0 to 1, level at its water."""

    city: City
    form: str
    side: str
    axis: str
    steps: int
    extent: tuple[float, float, float, float]
    wave: float = 0.0
    low: float = 0.0
    span: float = 1.0
    plane: FloatArray | None = None

    def __post_init__(self) -> None:
        table = self.city.layout.areas
        kinds = table["kind"].to_numpy().astype(str)
        wet = np.isin(kinds, list(LEVEL))
        self.water = table.geometry.to_numpy()[wet]
        self.level_reach = np.array([LEVEL[kind] for kind in kinds[wet]])
        self.bodies: list[tuple[Any, float, float]] = []
        whole = shapely.union_all(shapely.buffer(self.water, 0.05))
        for body in shapely.get_parts(whole).tolist():
            own = shapely.intersects(self.water, body)
            shapely.prepare(body)
            self.bodies.append((body, float(self.level_reach[own].max()), 0.0))

    def made(self, wave: float) -> tuple[Terrain, NDArray[np.bool_]]:
        """Return the land with heights from 0 to 1, and where it lies level because of water."""
        xmin, ymin, xmax, ymax = self.extent
        cell = max(FINEST, max(xmax - xmin, ymax - ymin) / NODES)
        columns, rows = (int(np.ceil(size / cell)) + 1 for size in (xmax - xmin, ymax - ymin))
        x, y = xmin + cell * np.arange(columns), ymin + cell * np.arange(rows)
        xy = np.column_stack([np.tile(x, rows), np.repeat(y, columns)])
        self.wave, self.plane = wave, None
        raw = self._raw(xy)
        self.bodies = [
            (body, reach, self._water_level(body, xy, raw)) for body, reach, _ in self.bodies
        ]
        found, flat = self._at_water(xy, raw)
        self.low, self.span = float(found.min()), max(float(np.ptp(found)), 1e-9)
        heights = ((found - self.low) / self.span).reshape(rows, columns)
        if np.ptp(found) < 1e-9:
            heights = np.zeros((rows, columns))
        return Terrain((xmin, ymin), cell, heights), flat.reshape(rows, columns)

    def around(self, height: float) -> Terrain:
        """Return the site and the land round it."""
        xmin, ymin, xmax, ymax = self.extent
        columns, rows = (
            int(np.ceil((size + 2 * FAR) / FAR_CELL)) + 1 for size in (xmax - xmin, ymax - ymin)
        )
        x, y = xmin - FAR + FAR_CELL * np.arange(columns), ymin - FAR + FAR_CELL * np.arange(rows)
        xy = np.column_stack([np.tile(x, rows), np.repeat(y, columns)])
        found, _ = self._at_water(xy, self._raw(xy))
        z = np.round(height * (found - self.low) / self.span, 3)
        return Terrain((xmin - FAR, ymin - FAR), FAR_CELL, z.reshape(rows, columns))

    def _raw(self, xy: FloatArray) -> FloatArray:
        """Return the shape of the land without its water."""
        low, high = np.array(self.extent[:2]), np.array(self.extent[2:])
        half = (high - low) / 2
        at = (xy - (low + high) / 2) / half
        if self.form in ("hills", "mountains"):
            seed = hash_bits(self.city.seed, "terrain/relief", 1) >> 1
            wave = self.wave * 2 * float(half.max())
            found = gradient_noise(seed, (xy - (low + high) / 2) / wave, octaves=2)
            if self.plane is None:  # hills lean to no side
                places = np.column_stack([at, np.ones(len(at))])
                self.plane = np.linalg.lstsq(places, found, rcond=None)[0][:2]
            return np.asarray(found - np.clip(at, -1.0, 1.0) @ self.plane)
        if self.form in ("slope", "terraces"):
            up = np.clip((at @ np.array(UP[self.side]) + 1) / 2, -0.3, 1.3)
            return up if self.form == "slope" else _stepped(up, self.steps)
        if self.form == "hill":
            return _bell(np.hypot(*at.T))
        if self.form == "plateau":
            away = (np.abs(at) ** 4).sum(axis=1) ** 0.25
            return 1.0 - _smooth((away - EDGE) / (1 - EDGE))
        across = np.abs(at[:, 0 if self.axis == "north_south" else 1])
        if self.form == "ridge":
            return _bell(across)
        rivers = [body for body, reach, _ in self.bodies if reach == LEVEL["river"]]
        if not rivers:
            return 1.0 - _bell((across - FLOOR) / (1 - FLOOR))
        floor, water = LEVEL["river"], shapely.union_all(rivers)
        far = SIDES * float(half.min())  # both sides rise, wherever the river flows
        away = shapely.distance(water, shapely.points(np.clip(xy, low, high)))
        return 1.0 - _bell((away - floor) / max(far - floor, RISING))

    def _water_level(self, body: Any, xy: FloatArray, raw: FloatArray) -> float:
        """Return the height at which a body of water lies: where the land is low beside it."""
        near = shapely.dwithin(body, shapely.points(xy), FINEST)
        return float(np.percentile(raw[near], 10)) if near.any() else float(raw.min())

    def _at_water(self, xy: FloatArray, raw: FloatArray) -> tuple[FloatArray, NDArray[np.bool_]]:
        """Return the land level with water beside it, and where it is."""
        low, high = np.array(self.extent[:2]), np.array(self.extent[2:])
        spots = shapely.points(np.clip(xy, low, high))
        found, flat = raw.copy(), np.zeros(len(raw), bool)
        for body, reach, level in self.bodies:
            away = shapely.distance(body, spots)
            in_valley = self.form == "valley" and reach == LEVEL["river"]  # level by its shape
            share = 1.0 if in_valley else _smooth((away - reach) / RISING)
            found = level + (found - level) * share
            flat |= away <= reach
        return found, flat


def _bell(away: FloatArray) -> FloatArray:
    return np.asarray(0.5 * (1 + np.cos(np.pi * np.clip(away, 0.0, 1.0))))


def _smooth(share: FloatArray) -> FloatArray:
    t = np.clip(share, 0.0, 1.0)
    return np.asarray(t * t * (3 - 2 * t))


def _stepped(up: FloatArray, steps: int) -> FloatArray:
    """Return a slope cut into so many terraces, the lowest and the highest whole."""
    at = up * (steps - 1 + TREAD)  # treads lie at the whole numbers
    step = np.floor(at)
    within = at - step
    return np.asarray(step + LEAN * within + (1 - LEAN) * _smooth((within - TREAD) / (1 - TREAD)))


def _steepness(land: Terrain) -> float:
    """Return the greatest rise over run of heights from 0 to 1, per metre of relief."""
    rise = np.gradient(land.heights, land.cell)
    return float(np.hypot(rise[0], rise[1]).max())


def _tilt(land: Terrain, flat: NDArray[np.bool_]) -> float:
    """Return the tilt of the plane that fits land best, per metre of relief."""
    rows, columns = np.nonzero(~flat)
    at = np.column_stack([columns * land.cell, rows * land.cell, np.ones(len(rows))])
    plane = np.linalg.lstsq(at, land.heights[rows, columns], rcond=None)[0]
    return max(float(np.hypot(plane[0], plane[1])), 1e-9)


def _points(terrain: Terrain) -> FloatArray:
    """(k, 3) the nodes of a terrain."""
    rows, columns = terrain.heights.shape
    row, column = (axis.ravel() for axis in np.mgrid[1 : rows - 1 : 3, 1 : columns - 1 : 3])
    x, y = (terrain.origin[k] + terrain.cell * n for k, n in ((0, column), (1, row)))
    return np.column_stack([x, y, terrain.heights[row, column]])
