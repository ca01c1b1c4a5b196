"""Design: every building gets a generator, its volumes and its roof."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.building.bays import stepped
from cityx.building.catalogue import NAMES, OUTSIDE, generator_named, generators
from cityx.building.lots import cleared
from cityx.building.massing.massing import Mass, Plot
from cityx.building.mesh_designs import with_meshes, with_others
from cityx.building.part_rows import (
    Aim,
    aims_of,
    as_high_as,
    highest_of,
    plain_rows,
    sorted_parts,
    with_masses,
)
from cityx.building.plots_of_buildings import plots_of
from cityx.building.selection import admitted, generators_of, widths_of
from cityx.building.stated_forms import StatedForms, keeps_form, stated_forms
from cityx.building.volumes import GROUNDED
from cityx.city.bounds import bounds_of, released
from cityx.city.city import City, Failure
from cityx.city.layout import is_mesh
from cityx.errors import ActionFailed
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.ids import choose, uniform
from cityx.protocol import Choice, Port, action
from cityx.system.extensions import refusals

if TYPE_CHECKING:
    from cityx.assets.styles.generators import Generator, Massing
    from cityx.city.layout import Layout

ACTION = "building/design-v1"
GROUND_SHARE = 0.97  # of a mapped footprint that a generator's ground floor must cover
STEEPEST = 0.6  # of a building's height that a drawn roof may take
LEAST_RISE = 0.8  # metres
LONG = 100.0  # metres of outline from which the grid of volumes may cost a neighbour room
SPILL = 0.25  # square metres
MIN_HEIGHT = 0.4  # metres of a volume
PODIUM_LEVELS = 3  # storeys of a podium, at most
TOWER_LEVELS = 4  # storeys by which another part of the building rises above it


@action(
    ACTION,
    limits=[
        "Buildings whose parts or whose sloping roofs the map describes keep those volumes.",
        "A low building whose height the map states has it over its whole plan.",
        "A footprint on the map is covered to its edges at the ground, whatever stands above.",
    ],
    requires=("layout",),
    after=("road/steps-v1",),
    gives=(Port("design", "scene_layout", "building_design"),),
    labels=("building", "style", "massing", "generator", "architecture"),
)
def design(
    city: City, *, generator: Annotated[str | None, Choice(*NAMES, outside=OUTSIDE)] = None
) -> City:
    """Choose a generator for every building, and grow its volumes and its roof.

    Purpose, use, size, place, style word and neighbours decide, by the tables of
    `cityx.building.selection`. Shells and facades raise what is designed here.

    Parameters
    ----------
    city
        City with a layout.
    generator
        Generator of all buildings that it makes sense on and that none was chosen for before.
    """
    layout = city.layout
    names = generators_of(city)
    if generator is not None and generator not in generators():
        raise ActionFailed(" ".join([f'"{generator}" builds nothing here.', *refusals()]))
    if generator is not None:
        fits = admitted(layout)[:, list(generators()).index(generator)]
        free = layout.buildings["generator"].to_numpy(str) == ""
        names = np.where(free & fits, generator, names)
    layout = replace(layout, buildings=layout.buildings.assign(generator=names))
    kinds = generators()
    rows = np.flatnonzero(np.isin(names, [name for name, kind in kinds.items() if kind.outside]))
    done = layout.parts["building"].to_numpy(np.uint64)[is_mesh(layout)]
    rows = rows[~np.isin(layout.buildings["id"].to_numpy(np.uint64)[rows], done)]
    layout, lost = with_meshes(layout, rows, city.seed)
    city = replace(city, failures=city.failures + lost)
    layout = with_others(replace(city, layout=layout), lost)
    city = cleared(city, laid_open(layout, rows))
    names = layout.buildings["generator"].to_numpy(str)
    layout = _with_podiums(layout)
    plain = plain_rows(layout)
    layout = with_drawn_roofs(layout, plain, city.seed)
    layout, cut = stepped(layout, city.terrain, plain)
    stated = stated_forms(layout.buildings)
    massive = np.array([bool(generator_named(name).mass) for name in names.tolist()], bool)
    rows = np.flatnonzero((plain >= 0) & ~cut & massive & ~(stated.roof & stated.mapped))
    layout, failures = grown_by(layout, rows, city.seed, stated=stated)
    return replace(city, layout=layout, failures=city.failures + failures)


def grown_by(
    layout: Layout,
    rows: IntArray,
    seed: int,
    *,
    free: bool = False,
    stated: StatedForms | None = None,
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
    stated
        What the map states of all buildings; what would depart from it stays a plain block.
    """
    massings = {name: kind.mass for name, kind in generators().items() if kind.mass}
    return _massed(layout, rows, massings, seed, free=free, stated=stated)


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
    """Turn buildings into those of one generator and rebuild the city's buildings.

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
    layout, cut = stepped(layout, city.terrain, plain)
    failures: tuple[Failure, ...] = ()
    if kind.mass:
        layout, failures = _massed(
            layout, rows[~cut[rows]], {kind.name: kind.mass}, city.seed, free=True, noise=noise
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


def laid_open(layout: Layout, rows: IntArray) -> NDArray[np.uint64]:
    """Return the ids of those buildings that leave a part of their footprint open, (k,)."""
    ids = layout.buildings["id"].to_numpy(np.uint64)[rows]
    parts = layout.parts
    owner = parts["building"].to_numpy(np.uint64)
    low = (parts["base"].to_numpy(float) < GROUNDED) & parts["walls"].to_numpy(bool)
    at = np.searchsorted(ids, owner).clip(max=max(len(ids) - 1, 0))
    mine = low & np.isin(owner, ids)
    area = shapely.area(parts.geometry.to_numpy())
    stands = np.bincount(at[mine], area[mine], minlength=len(ids))
    whole = shapely.area(layout.buildings.geometry.to_numpy()[rows])
    return np.asarray(ids[stands < GROUND_SHARE * whole])


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
        buildings = released(buildings, rows)
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
    return replace(layout, buildings=buildings, parts=sorted_parts(joined))


def with_drawn_roofs(layout: Layout, plain: IntArray, seed: int) -> Layout:
    """Draw the roofs of plain buildings where the input names none and the generator has its own.

    Parameters
    ----------
    plain
        (n,) row of each building's only part, -1 to leave it as it is.
    """
    buildings = layout.buildings
    stated = stated_forms(buildings)
    names = buildings["generator"].to_numpy(str)
    silent = np.char.find(buildings["tags"].to_numpy(str), '"roof:') < 0
    silent &= ~stated.roof & ~stated.flat
    known_height = ~np.isnan(stated.height)
    parts = layout.parts.copy()
    shape = parts["roof_shape"].to_numpy(object).copy()
    rise = parts["roof_height"].to_numpy(float).copy()
    top = parts["top"].to_numpy(float).copy()
    height = buildings["height"].to_numpy(float).copy()
    ids = buildings["id"].to_numpy(np.uint64)
    bounds = bounds_of(buildings, "height")
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
        room = np.where(fixed, np.inf, bounds.most[rows] - eave)  # for a roof below a bound
        level = wanted > room
        wanted = np.where(level & (room < LEAST_RISE), 0.0, np.minimum(wanted, room))
        word = np.where(level & (room < LEAST_RISE), "flat", word)
        shape[part], rise[part] = word, wanted
        raised = np.maximum(eave + wanted, bounds.least[rows])
        top[part] = np.where(fixed, top[part], raised)
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
    stated: StatedForms | None = None,
) -> tuple[Layout, tuple[Failure, ...]]:
    """Replace the single parts of buildings by the volumes that their generators grow."""
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
    aims = aims_of(buildings, rows)
    fewest = bounds_of(buildings, "levels").least[rows].tolist()
    levels = buildings["levels"].to_numpy().copy()
    grown, storeys = [], []
    failed: set[int] = set()
    for row, plot, aim, least in zip(rows.tolist(), plots, aims, fewest, strict=True):
        storeys.append(int(levels[row]))
        try:
            found, storeys[-1] = _grown_below(massings[names[row]], plot, aim, least, storeys[-1])
            grown.append(found)
        except (shapely.errors.GEOSException, ValueError, ZeroDivisionError) as error:
            message = f"{names[row]} kept its plain block: {error}"
            failures.append(Failure(int(ids[row]), ACTION, message))
            failed.add(row)
            grown.append([])
    grown = [as_high_as(masses, aim) for masses, aim in zip(_sound(grown), aims, strict=True)]
    plans = [plot.plan for plot in plots]
    grown = _beside_neighbours(layout, rows, plans, grown)
    covered = _covered(plans, grown)
    for row, part, found, whole, storey, plan in zip(
        rows.tolist(), part_rows.tolist(), grown, covered.tolist(), storeys, plans, strict=True
    ):
        if row in failed:
            continue
        if not found or not (free or whole or not generator_named(names[row]).covers):
            message = f"{names[row]} kept its plain block: no volume fits"
            failures.append(Failure(int(ids[row]), ACTION, message))
            continue
        if stated is not None and _departs(stated, row, found, plan, storey, names[row]):
            continue
        kept.append(part)
        levels[row] = storey
        sources += [part] * len(found)
        masses += found
        numbers += range(len(found))
    if not kept:
        return layout, tuple(failures)
    layout = replace(layout, buildings=buildings.assign(levels=levels))
    return with_masses(layout, kept, sources, masses, numbers), tuple(failures)


def _departs(
    stated: StatedForms, row: int, found: list[Mass], plan: Any, levels: int, name: str
) -> bool:
    """Return whether the volumes of a mapped building lose what the map states of its form."""
    if not stated.mapped[row]:
        return False
    # What stands open by its nature, as a stadium, is no volume of one height.
    height = float(stated.height[row]) if generator_named(name).covers else math.nan
    return not keeps_form(found, plan, levels, flat=bool(stated.flat[row]), height=height)


def _grown_below(
    massing: Massing, plot: Plot, aim: Aim, fewest: float, levels: int
) -> tuple[list[Mass], int]:
    """Grow the volumes of a building, with fewer storeys where they rise above a bound.

    Returns
    -------
    masses, levels
        The storeys are the building's own where it need not be lower.
    """
    found = list(massing(plot))
    lower = plot
    bound = aim.most if math.isnan(aim.said) else math.inf
    while highest_of(found) > bound and lower.levels > max(fewest, 1.0):
        height = lower.height - lower.storey
        lower = replace(lower, height=height, levels=lower.levels - 1)
        found, levels = list(massing(lower)), lower.levels
    return found, levels


def _sound(grown: list[list[Mass]]) -> list[list[Mass]]:
    """Drop volumes that have no body."""
    plans = np.array([mass.plan for masses in grown for mass in masses], object)
    good = (shapely.get_type_id(plans) == 3) & shapely.is_valid(plans) & (shapely.area(plans) > 0.5)
    kept = iter(good.tolist())
    return [
        [mass for mass in masses if next(kept) and mass.height > MIN_HEIGHT] for masses in grown
    ]


def _beside_neighbours(
    layout: Layout, rows: IntArray, plans: list[Any], grown: list[list[Mass]]
) -> list[list[Mass]]:
    """Cut volumes of large plans back to these where they lie in neighbours.

    The grid that volumes are drawn on moves walls by millimetres: square metres along a wall of
    hundreds, as round a court that another house fills.
    """
    large = [at for at, plan in enumerate(plans) if plan.length > LONG and grown[at]]
    if not large:
        return grown
    outlines = layout.buildings.geometry.to_numpy()
    tree = shapely.STRtree(outlines)
    found = list(grown)
    for at in large:
        over = shapely.difference(shapely.union_all([one.plan for one in grown[at]]), plans[at])
        near = tree.query(over, predicate="intersects") if over.area > SPILL else np.zeros(0, int)
        others = outlines[near[near != rows[at]]]
        if shapely.intersection(over, shapely.union_all(others)).area > SPILL:
            found[at] = [
                replace(mass, plan=piece)
                for mass in grown[at]
                for piece in shapely.get_parts(shapely.intersection(mass.plan, plans[at])).tolist()
                if piece.area > SPILL
            ]
    return found


def _covered(plans: list[Any], grown: list[list[Mass]]) -> NDArray[np.bool_]:
    """Return which footprints the ground floors cover, and leave no hole of theirs built over."""
    rows = [row for row, masses in enumerate(grown) for mass in masses if mass.low < 0.05]
    ground = [mass.plan for masses in grown for mass in masses if mass.low < 0.05]
    bodies, own = np.array(ground, object), np.array(rows, np.int64)
    outlines = np.array(plans, object)
    whole = shapely.area(outlines)
    covered = np.bincount(own, shapely.area(bodies), minlength=len(plans))
    courts = shapely.difference(shapely.polygons(shapely.get_exterior_ring(outlines)), outlines)
    built = shapely.area(shapely.intersection(bodies, courts[own]))
    over = np.bincount(own, built, minlength=len(plans))
    return np.asarray((covered >= GROUND_SHARE * whole) & (over <= (1 - GROUND_SHARE) * whole))
