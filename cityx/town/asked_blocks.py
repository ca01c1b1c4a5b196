"""A grid whose blocks are asked for: so many, so large, turned by an angle."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import shapely

from cityx.errors import UsageError
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.parcels.lattice import PER_METRE
from cityx.geometry.parcels.street_fit import no_ways, settled
from cityx.geometry.parcels.street_patterns import Pattern, divided
from cityx.ids import draw, hash_bits
from cityx.places.profile import Profile
from cityx.town.districts import SHAPE, SPARSE, District, Sketch, zone_of
from cityx.town.plane import Plan, Plane
from cityx.town.procedural_streets import MAIN_LINE, half_width, local_tags
from cityx.town.rims import SITE, rim_of_site

MAIN_EVERY = 4  # every so many streets one is a main street
MAIN_FIRST = 2  # the first that is one in a grid of asked blocks
SMALL = 350.0  # metres; a smaller site has local streets alone, and in a grid one all round
BEYOND = 150.0  # metres beyond the border to which streets of a turned grid are laid
MERGED = 0.6  # of a factor of e in the shape of the site that a pair of blocks as one costs
LEAST = 20.0  # metres of a block
SPARE = 12.0  # metres round turned blocks to the border


@dataclass(frozen=True)
class Lines:
    """The lines of one direction of a grid, k of them.

    Attributes
    ----------
    at
        (k,) metres across them, from the middle of the site.
    main
        (k,) bool, whether each is a main street.
    """

    at: FloatArray
    main: IntArray


@dataclass(frozen=True)
class Grid:
    """Both directions of a grid.

    Attributes
    ----------
    east, north
        Lines that part blocks from west to east, and from south to north.
    merged
        Pairs of blocks that are one.
    ringed
        Whether the outermost streets run along the border and none leads out.
    """

    east: Lines
    north: Lines
    merged: int
    ringed: bool


def size_of_blocks(
    plan: Plan, seed: int, middle: tuple[float, float], profile: Profile
) -> tuple[float, float]:
    """Return width and depth of a site that holds the asked blocks with their streets."""
    plane = Plane(plan, seed, profile)
    zone, _ = _zone(plane, middle)
    sizes = _sizes(plane, zone)
    columns, rows, _ = _numbers(plan, 1.0)
    halves = _halves(plane, zone)
    lines = [
        _spread(count, size, halves, mains=False)
        for count, size in zip((columns, rows), sizes, strict=True)
    ]
    w, d = (float(np.ptp(one.at)) + 2 * halves[0] for one in lines)
    turn = math.radians(plan.turn_deg)
    if not turn:
        return round(w, 3), round(d, 3)
    c, s = abs(math.cos(turn)), abs(math.sin(turn))
    return round(c * w + s * d + 2 * SPARE, 3), round(s * w + c * d + 2 * SPARE, 3)


def district_of_blocks(plane: Plane, window: tuple[float, float, float, float]) -> District:
    """Lay out the streets of a site with asked blocks."""
    low, high = np.array(window[:2]), np.array(window[2:])
    anchor = np.rint((low + high) / 2 * PER_METRE).astype(np.int64)
    half = (high - low) / 2
    x, y = ((low + high) / 2).tolist()
    zone, density = _zone(plane, (x, y))
    grid = _grid(plane, zone, half)
    reach = float(np.hypot(*half)) + BEYOND
    rim = rim_of_site(anchor, half if grid.ringed else half + BEYOND)
    pattern = _pattern(plane, grid, reach)
    site = shapely.box(*-half, *half)
    inside = shapely.contains_xy(rim.polygon(), pattern.nodes)
    pattern = pattern.take(inside[pattern.links].any(axis=1))
    places = rim.places(pattern.nodes)
    nodes = rim.local(places)
    loose = ~shapely.contains_xy(site, nodes)
    if not loose[pattern.links].any():  # no street leaves the site
        loose[:] = True
    kept = settled(pattern.links, nodes, loose, loose)
    none = np.zeros(0, np.int64)
    return District(
        Sketch(rim, "grid", zone, density, pattern, no_ways()),
        places, pattern.links[kept], pattern.street[kept], none,
    )  # fmt: skip


def _zone(plane: Plane, middle: tuple[float, float]) -> tuple[str, float]:
    anchor = np.rint(np.array(middle) * PER_METRE).astype(np.int64)
    density = float(plane.density(anchor[None])[0])
    return zone_of(plane, hash_bits(plane.seed, "site", *SITE), density), density


def _halves(plane: Plane, zone: str) -> tuple[float, float]:
    """Return the metres from the middle of local and of main streets to where blocks begin."""
    local, main = (
        half_width(local_tags(plane, SITE, zone, "grid", family, 0), plane.profile)
        for family in (0, MAIN_LINE)
    )
    return local, main


def _sizes(plane: Plane, zone: str) -> tuple[float, float]:
    """Return the metres of a block, those of a usual one where none are said."""
    plan = plane.plan
    along, across, _ = SHAPE["grid"]
    larger = plan.block * SPARSE.get(zone, 1.0)
    street = 2 * _halves(plane, zone)[0]
    usual = (max(along * larger - street, LEAST), max(across * larger - street, LEAST))
    return plan.block_width or usual[0], plan.block_depth or usual[1]


def _numbers(plan: Plan, aspect: float) -> tuple[int, int, int]:
    """Return columns and rows of blocks, 0 where none are said, and pairs that become one."""
    if not plan.blocks:
        return plan.columns, plan.rows, 0
    if plan.columns and plan.rows and plan.columns * plan.rows != plan.blocks:
        raise UsageError(
            f"{plan.columns} by {plan.rows} blocks are {plan.columns * plan.rows}, "
            f"not {plan.blocks}."
        )
    tried = [plan.columns] if plan.columns else range(1, plan.blocks + 1)
    found: list[tuple[float, int, int, int]] = []
    for columns in tried:
        rows = plan.rows or math.ceil(plan.blocks / columns)
        merged = columns * rows - plan.blocks
        if 0 <= merged <= (columns // 2) * rows:
            unlike = abs(math.log(columns / rows / aspect))
            found.append((MERGED * merged + unlike, columns, rows, merged))
    if not found:
        raise UsageError(f"{plan.blocks} blocks do not make {plan.columns or plan.rows} in a row.")
    return min(found)[1:]


def _grid(plane: Plane, zone: str, half: FloatArray) -> Grid:
    plan = plane.plan
    aspect = float(half[0] / half[1])
    columns, rows, merged = _numbers(plan, aspect)
    sizes = _sizes(plane, zone)
    halves = _halves(plane, zone)
    turn = math.radians(plan.turn_deg)
    mains = bool(2 * half.min() >= SMALL) and not columns
    counts = np.array([columns, rows])
    given = np.array([plan.block_width, plan.block_depth])
    ringed = bool(counts.all()) and not turn
    found = []
    c, s = abs(math.cos(turn)), abs(math.sin(turn))
    for k in (0, 1):
        if not counts[k]:
            reach = half[k] if not turn else float(np.hypot(*half))
            number = 2 * math.ceil(reach / (sizes[k] + 2 * halves[0])) + 1
            found.append(_spread(number, sizes[k], halves, mains=mains))
            continue
        size = float(given[k])
        if not size:
            room = 2 * half[k] if not turn else 2 * float(half.min()) / (c + s)
            size = (room - 2 * halves[0]) / counts[k] - 2 * halves[0]
        found.append(_spread(int(counts[k]), size, halves, mains=False))
        if size < LEAST:
            raise UsageError(
                f"{counts[k]} blocks beside each other would be {size:.0f} m wide in a site of "
                f"{2 * half[0]:.0f} m by {2 * half[1]:.0f} m; ask for fewer, or for a larger site."
            )
    spans = np.array([np.ptp(one.at) + 2 * halves[0] for one in found])
    box = np.array([c * spans[0] + s * spans[1], s * spans[0] + c * spans[1]])
    if counts.all() and (box > 2 * half + 0.01).any():
        raise UsageError(
            f"{columns} by {rows} blocks of {sizes[0]:.0f} m by {sizes[1]:.0f} m with their "
            f"streets take {box[0]:.0f} m by {box[1]:.0f} m; the site has {2 * half[0]:.0f} m by "
            f"{2 * half[1]:.0f} m. Ask for a larger site, or for fewer or smaller blocks."
        )
    ringed = ringed and bool((np.abs(box - 2 * half) < 1.0).all())
    return Grid(found[0], found[1], merged, ringed)


def _spread(number: int, size: float, halves: tuple[float, float], *, mains: bool) -> Lines:
    """Place the lines between so many blocks of one size, about the middle of the site."""
    main = np.arange(number + 1) % MAIN_EVERY == MAIN_FIRST
    main = main if mains else np.zeros(number + 1, bool)
    half = np.where(main, halves[1], halves[0])
    at = np.concatenate([[0.0], np.cumsum(half[:-1] + size + half[1:])])
    return Lines(at - at[-1] / 2, main)


def _pattern(plane: Plane, grid: Grid, reach: float) -> Pattern:
    """Make the streets of a grid, which lead out of the site unless they are ringed."""
    u, v = (
        one.at if grid.ringed else np.concatenate([[-reach], one.at, [reach]])
        for one in (grid.east, grid.north)
    )
    turn = math.radians(plane.plan.turn_deg)
    c, s = math.cos(turn), math.sin(turn)
    x, y = (part.ravel() for part in np.meshgrid(u, v, indexing="ij"))
    nodes = np.column_stack([c * x - s * y, s * x + c * y])
    number = np.arange(len(nodes)).reshape(len(u), len(v))
    edge = 0 if grid.ringed else 1  # the added ends are no lines
    inner_u, inner_v = slice(edge, len(u) - edge), slice(edge, len(v) - edge)
    along = np.stack([number[:-1, inner_v].ravel(), number[1:, inner_v].ravel()], axis=1)
    rising = np.stack([number[inner_u, :-1].ravel(), number[inner_u, 1:].ravel()], axis=1)
    lines = np.concatenate([
        np.tile(np.arange(len(grid.north.at)), len(u) - 1),
        np.repeat(np.arange(len(grid.east.at)), len(v) - 1),
    ])  # fmt: skip
    family = np.repeat([0, 1], [len(along), len(rising)])
    main = np.where(family == 0, grid.north.main[lines * (family == 0)],
                    grid.east.main[lines * (family == 1)])  # fmt: skip
    street = np.stack(
        [np.where(main, MAIN_LINE, family), np.where(main, 2 * lines + family, lines)], axis=1
    )
    links = np.concatenate([along, rising])
    name = np.stack([2 * lines + family, np.arange(len(links))], axis=1)
    found = Pattern(nodes, links, street, name)
    gone = _between_pairs(plane, grid, len(along), len(v), edge)
    kept = ~np.isin(np.arange(len(links)), gone)
    return divided(found.take(kept))


def _between_pairs(plane: Plane, grid: Grid, begin: int, count: int, edge: int) -> list[int]:
    """Return the links between pairs of blocks that become one, as rows of a pattern."""
    columns, rows = len(grid.east.at) - 1, len(grid.north.at) - 1
    pairs = [(c, r) for r in range(rows) for c in range(0, columns - 1, 2)]
    pairs.sort(key=lambda pair: draw(plane.seed, "site/merged", pair[0] * 1000 + pair[1]))
    return [begin + (c + 1) * (count - 1) + r + edge for c, r in pairs[: grid.merged]]
