"""Design: every building gets a generator, its volumes and its roof."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.building.catalogue import generators
from cityx.building.facade.fronts import STREETS
from cityx.building.massing.massing import Mass, Plot
from cityx.building.selection import admitted, generators_of, widths_of
from cityx.building.volumes import GROUNDED
from cityx.city.city import City, Failure
from cityx.errors import ActionFailed
from cityx.geometry.polygons import FloatArray, IntArray
from cityx.ids import choose, hash_ids, uniform
from cityx.protocol import Port, action

if TYPE_CHECKING:
    from geopandas import GeoDataFrame

    from cityx.assets.styles.generators import Generator, Massing
    from cityx.city.layout import Layout

ACTION = "building/design-v1"
STREET_REACH = 120.0  # metres; a street further away gives a building no front
GROUND_SHARE = 0.97  # of a mapped footprint that a generator's ground floor must cover
STRETCH = 0.001  # of a height that is said, by which what is built may miss it
STEEPEST = 0.6  # of a building's height that a drawn roof may take
LEAST_RISE = 0.8  # metres
MIN_HEIGHT = 0.4  # metres of a volume
PODIUM_LEVELS = 3  # storeys of a podium, at most
TOWER_LEVELS = 4  # storeys by which another part of the building rises above it


@action(
    ACTION,
    limits=[
        "Buildings whose parts the map describes keep those volumes.",
        "A footprint on the map is covered to its edges at the ground, whatever stands above.",
    ],
    requires=("layout",),
    gives=(Port("design", "scene_layout", "building_design"),),
    labels=("building", "style", "massing", "generator", "architecture"),
)
def design(city: City) -> City:
    """Choose a generator for every building, and grow its volumes and its roof.

    Purpose, use, size, place, style word and neighbours decide, by the tables of
    `cityx.building.selection`. Shells and facades raise what is designed here.
    """
    names = generators_of(city)
    layout = city.layout
    buildings = layout.buildings.copy()
    buildings["generator"] = names
    layout = _with_podiums(replace(layout, buildings=buildings))
    plain = _plain_rows(layout)
    layout = with_drawn_roofs(layout, plain, city.seed)
    kinds = generators()
    rows = np.array(
        [row for row, name in enumerate(names.tolist()) if plain[row] >= 0 and kinds[name].mass],
        np.int64,
    )
    layout, failures = grown_by(layout, rows, city.seed)
    return replace(city, layout=layout, failures=city.failures + failures)


def grown_by(
    layout: Layout, rows: IntArray, seed: int, *, free: bool = False
) -> tuple[Layout, tuple[Failure, ...]]:
    """Grow the volumes of buildings by their generators, of those that have a massing.

    Parameters
    ----------
    layout
        With one plain part for each of the buildings.
    rows
        (k,) of the buildings.
    seed
        Of the city.
    free
        Whether the ground floor may leave a part of the footprint open.
    """
    massings = {name: kind.mass for name, kind in generators().items() if kind.mass}
    return _massed(layout, rows, massings, seed, free=free)


def redesign(
    city: City,
    generator: Generator,
    *,
    share: float = 1.0,
    floors: int = 0,
    building: str | None = None,
    mass: Massing | None = None,
    noise: float | None = None,
) -> City:
    """Turn buildings into those of one generator and raise the city's buildings anew.

    Parameters
    ----------
    share
        Share of the buildings, by the hash of their ids.
    floors
        Storeys, 0 to keep those of each building.
    building
        Name of the one building to change, or None for all that the generator admits.
    mass, noise
        Another massing than the generator's own; how far measures vary.

    Raises
    ------
    ActionFailed
        If no building is chosen.
    """
    kind = replace(generator, mass=mass or generator.mass)
    layout = city.layout
    ids = layout.buildings["id"].to_numpy(np.uint64)
    if building is not None:
        rows = _named(city, building)
    else:
        column = list(generators()).index(kind.name)
        chosen = uniform(city.seed, "building/share", ids) < share
        rows = np.flatnonzero(admitted(layout, floors)[:, column] & chosen)
    if not len(rows):
        raise ActionFailed(f"No building has a footprint and storeys that admit a {kind.title}.")
    layout = _cleared(layout, rows, kind, floors)
    plain = np.full(len(layout.buildings), -1, np.int64)
    part_rows = np.searchsorted(layout.parts["id"].to_numpy(np.uint64), ids[rows])
    plain[rows] = part_rows
    layout = with_drawn_roofs(layout, plain, city.seed)
    failures: tuple[Failure, ...] = ()
    if kind.mass:
        layout, failures = _massed(
            layout, rows, {kind.name: kind.mass}, city.seed, free=True, noise=noise
        )
    return raised(replace(city, layout=layout, failures=city.failures + failures))


def raised(city: City, trade: FloatArray | None = None) -> City:
    """Raise all buildings of a designed layout at the city's level of detail.

    Parameters
    ----------
    trade
        (n,) how much trade there is around each part, as of
        `cityx.building.facade.fronts.trade_of`; worked out when left out.
    """
    from cityx.building.facade.facade import MIN_LOD, faced
    from cityx.building.shell import prism, shell

    if city.lod == 0:
        return prism(city)
    return faced(shell(city), trade) if city.lod >= MIN_LOD else shell(city)


def _named(city: City, name: str) -> IntArray:
    from cityx.protocol.objects import find_object

    number = find_object(city, name)
    ids = city.layout.buildings["id"].to_numpy(np.uint64)
    rows = np.flatnonzero(ids == np.uint64(number or 0))
    if not len(rows):
        raise ActionFailed(f'"{name}" names no building of the city.')
    return rows


def _with_podiums(layout: Layout) -> Layout:
    """Tell the low parts of mapped buildings whose others rise high: looks may have such a zone."""
    parts = layout.parts
    if not len(parts):
        return layout
    levels = parts["levels"].to_numpy(np.int64)
    _, owner = np.unique(parts["building"].to_numpy(np.uint64), return_inverse=True)
    highest = np.zeros(len(parts), np.int64)
    np.maximum.at(highest, owner, levels)
    zone = parts["zone"].to_numpy(str)
    low = (levels <= PODIUM_LEVELS) & (highest[owner] >= levels + TOWER_LEVELS) & (zone == "")
    low &= (parts["base"].to_numpy(float) < GROUNDED) & parts["walls"].to_numpy(bool)
    return replace(layout, parts=parts.assign(zone=np.where(low, "podium", zone)))


def _plain_rows(layout: Layout) -> IntArray:
    """Row of the only part of each building that is one plain volume, else -1; (n,)."""
    ids = layout.buildings["id"].to_numpy(np.uint64)
    parts = layout.parts
    owner = parts["building"].to_numpy(np.uint64)
    if not len(ids) or not len(parts):
        return np.full(len(ids), -1, np.int64)
    row = np.minimum(np.searchsorted(ids, owner), len(ids) - 1)
    known = ids[row] == owner
    number = np.bincount(row[known], minlength=len(ids))
    only = np.full(len(ids), -1, np.int64)
    only[row[known]] = np.flatnonzero(known)
    standing = (parts["base"].to_numpy(float) < 0.05) & parts["walls"].to_numpy(bool)
    standing &= shapely.area(parts.geometry.to_numpy()) > 8.0
    return np.where((number == 1) & standing[only], only, -1)


def _cleared(layout: Layout, rows: IntArray, kind: Generator, floors: int) -> Layout:
    """Give the chosen buildings one plain part each, with the generator's name and storeys."""
    import pandas as pd

    buildings = layout.buildings.copy()
    ids = buildings["id"].to_numpy(np.uint64)
    words = buildings["generator"].to_numpy(object).copy()
    words[rows] = kind.name
    buildings["generator"] = words.astype(str)
    if floors:
        levels = buildings["levels"].to_numpy().copy()
        height = buildings["height"].to_numpy(float).copy()
        levels[rows] = np.clip(floors, kind.levels[0], kind.levels[1])
        height[rows] = kind.storey * levels[rows]
        buildings["levels"], buildings["height"] = levels, height
    parts = layout.parts
    owner = parts["building"].to_numpy(np.uint64)
    first = np.flatnonzero(np.isin(owner, ids[rows]))
    own, at = np.unique(owner[first], return_index=True)
    fresh = parts.iloc[first[at]].copy()
    row = np.searchsorted(ids, own)
    fresh["id"] = own
    fresh["base"] = 0.0
    fresh["top"] = buildings["height"].to_numpy(float)[row]
    fresh["levels"] = buildings["levels"].to_numpy()[row]
    fresh["zone"] = ""
    fresh["walls"] = True
    rise = np.minimum(fresh["roof_height"].to_numpy(float), 0.5 * fresh["top"].to_numpy(float))
    fresh["roof_height"] = rise
    fresh = fresh.set_geometry(buildings.geometry.to_numpy()[row])
    rest = parts.iloc[np.flatnonzero(~np.isin(owner, own))]
    joined = pd.concat([rest, fresh], ignore_index=True)
    return replace(layout, buildings=buildings, parts=_sorted(joined))


def _sorted(parts: Any) -> GeoDataFrame:
    return parts.sort_values("id", kind="stable", ignore_index=True)


def with_drawn_roofs(layout: Layout, plain: IntArray, seed: int) -> Layout:
    """Draw the roofs of plain buildings where the input names none and the generator has its own.

    Parameters
    ----------
    plain
        (n,) row of each building's only part, -1 to leave it as it is.
    """
    buildings = layout.buildings
    tags = buildings["tags"].to_numpy(str)
    names = buildings["generator"].to_numpy(str)
    silent = np.char.find(tags, '"roof:') < 0
    known_height = np.char.find(tags, '"height"') >= 0
    parts = layout.parts.copy()
    shape = parts["roof_shape"].to_numpy(object).copy()
    rise = parts["roof_height"].to_numpy(float).copy()
    top = parts["top"].to_numpy(float).copy()
    height = buildings["height"].to_numpy(float).copy()
    ids = buildings["id"].to_numpy(np.uint64)
    for name, kind in generators().items():
        rows = np.flatnonzero((names == name) & silent & (plain >= 0))
        if not kind.roofs or not len(rows):
            continue
        part = plain[rows]
        drawn = choose(seed, f"building/roof/{name}", ids[rows], [w for _, w in kind.roofs])
        word = np.array([word for word, _ in kind.roofs], object)[drawn]
        turn = uniform(seed, "building/pitch", ids[rows])
        pitch = np.radians(kind.pitch[0] + (kind.pitch[1] - kind.pitch[0]) * turn)
        half = widths_of(parts.geometry.to_numpy()[part]) / 2
        wanted = np.maximum(half * np.tan(pitch), LEAST_RISE)
        wanted = np.where(word == "flat", 0.0, wanted)
        eave = top[part] - rise[part]
        fixed = known_height[rows]
        limit = np.where(fixed, STEEPEST * top[part], STEEPEST / (1 - STEEPEST) * eave)
        wanted = np.minimum(wanted, limit)
        shape[part], rise[part] = word, wanted
        top[part] = np.where(fixed, top[part], eave + wanted)
        height[rows] = top[part]
    parts["roof_shape"], parts["roof_height"], parts["top"] = shape.astype(str), rise, top
    buildings = buildings.copy()
    buildings["height"] = height
    return replace(layout, parts=parts, buildings=buildings)


def _massed(
    layout: Layout,
    rows: IntArray,
    massings: Mapping[str, Massing],
    seed: int,
    *,
    free: bool = False,
    noise: float | None = None,
) -> tuple[Layout, tuple[Failure, ...]]:
    """Replace the single parts of buildings by the volumes that their generators grow."""
    import pandas as pd

    if not len(rows):
        return layout, ()
    buildings, parts = layout.buildings, layout.parts
    names = buildings["generator"].to_numpy(str)
    ids = buildings["id"].to_numpy(np.uint64)
    order = np.argsort(parts["building"].to_numpy(np.uint64), kind="stable")
    at = np.searchsorted(parts["building"].to_numpy(np.uint64)[order], ids[rows])
    part_rows = order[at]
    kept: list[int] = []
    sources: list[int] = []
    masses: list[Mass] = []
    numbers: list[int] = []
    failures: list[Failure] = []
    plots = plots_of(layout, rows, part_rows, seed)
    if noise is not None:
        plots = [replace(plot, noise=noise) for plot in plots]
    grown = []
    for row, plot in zip(rows.tolist(), plots, strict=True):
        try:
            grown.append(list(massings[names[row]](plot)))
        except (shapely.errors.GEOSException, ValueError, ZeroDivisionError) as error:
            message = f"{names[row]} kept its plain block: {error}"
            failures.append(Failure(int(ids[row]), ACTION, message))
            grown.append([])
    said = _said_heights(buildings, rows)
    grown = [_as_high_as(masses, h) for masses, h in zip(_sound(grown), said, strict=True)]
    covered = _covered([plot.plan for plot in plots], grown)
    for row, part, found, whole in zip(
        rows.tolist(), part_rows.tolist(), grown, covered.tolist(), strict=True
    ):
        if not found or not (free or whole or not generators()[names[row]].covers):
            message = f"{names[row]} kept its plain block: no volume fits"
            failures.append(Failure(int(ids[row]), ACTION, message))
            continue
        kept.append(part)
        sources += [part] * len(found)
        masses += found
        numbers += range(len(found))
    if not kept:
        return layout, tuple(failures)
    fresh = parts.iloc[sources].copy()
    own = fresh["id"].to_numpy(np.uint64)
    k = np.array(numbers, np.int64)
    storey = _storeys(fresh)
    fresh["id"] = np.where(k > 0, hash_ids(0, "building/mass", own, k), own)
    fresh["zone"] = [mass.zone for mass in masses]
    fresh["base"] = [mass.low for mass in masses]
    fresh["top"] = [mass.high for mass in masses]
    fresh["roof_shape"] = [mass.roof for mass in masses]
    fresh["roof_height"] = [mass.rise for mass in masses]
    fresh["roof_direction"] = [mass.direction for mass in masses]
    fresh["roof_across"] = [mass.across for mass in masses]
    fresh["walls"] = [mass.walls for mass in masses]
    tall = np.array([mass.height - mass.rise for mass in masses])
    fresh["levels"] = np.maximum(np.round(tall / storey), 1).astype(np.int16)
    plans = np.array([mass.plan for mass in masses], object)
    fresh = fresh.set_geometry(shapely.orient_polygons(plans))
    rest = parts.drop(index=parts.index[kept])
    joined = _sorted(pd.concat([rest, fresh], ignore_index=True))
    height = buildings["height"].to_numpy(float).copy()
    of = np.searchsorted(ids, fresh["building"].to_numpy(np.uint64))
    height[of] = 0.0
    np.maximum.at(height, of, fresh["top"].to_numpy(float))
    buildings = buildings.copy()
    buildings["height"] = height
    return replace(layout, parts=joined, buildings=buildings), tuple(failures)


def _said_heights(buildings: GeoDataFrame, rows: IntArray) -> list[float]:
    """Heights of buildings that the map or a wish says, nan where none does; (k,), metres."""
    tags = buildings["tags"].to_numpy(str)[rows]
    known = np.char.find(tags, '"height"') >= 0
    said: list[float] = np.where(known, buildings["height"].to_numpy(float)[rows], np.nan).tolist()
    return said


def _as_high_as(masses: list[Mass], height: float) -> list[Mass]:
    """Stretch the volumes of a building so that the highest ends at a height; nan leaves them."""
    highest = max((mass.high for mass in masses), default=0.0)
    factor = height / highest if highest > 0.0 else 1.0
    if not abs(factor - 1.0) > STRETCH:
        return masses
    return [
        replace(mass, low=mass.low * factor, high=mass.high * factor, rise=mass.rise * factor)
        for mass in masses
    ]


def _storeys(fresh: Any) -> FloatArray:
    """Metres of a storey of each new part's building, (k,)."""
    levels = np.maximum(fresh["levels"].to_numpy(float), 1.0)
    tall = fresh["top"].to_numpy(float) - fresh["roof_height"].to_numpy(float)
    return np.asarray(np.maximum(tall / levels, 2.2))


def _sound(grown: list[list[Mass]]) -> list[list[Mass]]:
    """Drop volumes that have no body."""
    plans = np.array([mass.plan for masses in grown for mass in masses], object)
    good = (shapely.get_type_id(plans) == 3) & shapely.is_valid(plans) & (shapely.area(plans) > 0.5)
    kept = iter(good.tolist())
    return [
        [mass for mass in masses if next(kept) and mass.height > MIN_HEIGHT] for masses in grown
    ]


def _covered(plans: list[Any], grown: list[list[Mass]]) -> NDArray[np.bool_]:
    """Tell which footprints the ground floors cover; volumes of one building do not overlap."""
    rows = [row for row, masses in enumerate(grown) for mass in masses if mass.low < 0.05]
    ground = [mass.plan for masses in grown for mass in masses if mass.low < 0.05]
    area = shapely.area(np.array(ground, object))
    total = np.bincount(np.array(rows, np.int64), area, minlength=len(plans))
    return np.asarray(total >= GROUND_SHARE * shapely.area(np.array(plans, object)))


def plots_of(layout: Layout, rows: IntArray, part_rows: IntArray, seed: int) -> list[Plot]:
    """Gather what massing needs to know of buildings.

    Parameters
    ----------
    rows, part_rows
        (k,) rows of the buildings and of their single parts.
    """
    buildings, parts = layout.buildings, layout.parts
    ids = buildings["id"].to_numpy(np.uint64)[rows]
    tags = buildings["tags"].to_numpy(str)[rows]
    said = np.char.find(tags, '"roof:shape"') >= 0
    plans = parts.geometry.to_numpy()[part_rows]
    top = parts["top"].to_numpy(float)[part_rows]
    levels = parts["levels"].to_numpy(int)[part_rows]
    shape = parts["roof_shape"].to_numpy(str)[part_rows]
    rise = parts["roof_height"].to_numpy(float)[part_rows]
    front = _fronts(layout, plans)
    boxes = boxes_of(plans)
    return [
        Plot(
            plans[i], float(top[i]), max(int(levels[i]), 1), int(ids[i]), seed,
            (float(front[i, 0]), float(front[i, 1])), str(shape[i]), float(rise[i]), bool(said[i]),
            box=boxes[i],
        )
        for i in range(len(rows))
    ]  # fmt: skip


def boxes_of(plans: NDArray[Any]) -> list[tuple[tuple[float, float], ...]]:
    """Return the corners of the smallest box around each plan, () for a plan without one."""
    boxes = shapely.oriented_envelope(plans)
    good = (shapely.get_type_id(boxes) == 3) & ~shapely.is_empty(boxes)
    corner = shapely.get_coordinates(boxes[good]).reshape(-1, 5, 2)[:, :4].tolist()
    found: list[tuple[tuple[float, float], ...]] = [()] * len(plans)
    for row, ring in zip(np.flatnonzero(good).tolist(), corner, strict=True):
        found[row] = tuple((x, y) for x, y in ring)
    return found


def _fronts(layout: Layout, plans: NDArray[Any]) -> FloatArray:
    """Return unit vectors from buildings to the nearest street, else zeros, (k, 2)."""
    front = np.zeros((len(plans), 2))
    kinds = layout.roads["kind"].to_numpy(str)
    blocked = layout.roads["tunnel"].to_numpy(bool) | layout.roads["passage"].to_numpy(bool)
    streets = layout.roads.geometry.to_numpy()[np.isin(kinds, list(STREETS)) & ~blocked]
    if not len(streets) or not len(plans):
        return front
    middle = shapely.centroid(plans)
    tree = shapely.STRtree(streets)
    row, road = tree.query_nearest(middle, max_distance=STREET_REACH, all_matches=False)
    line = shapely.get_coordinates(shapely.shortest_line(middle[row], streets[road]))
    vector = line[1::2] - line[::2]
    length = np.hypot(*vector.T)
    front[row] = vector / np.maximum(length, 1e-9)[:, None]
    return front
