"""Footprints: the buildings of every zone on its parcels, their grounds and their fences."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from cityx.errors import UsageError
from cityx.geometry.arrays import IntArray
from cityx.geometry.parcels.parcels import Parcels
from cityx.geometry.parcels.plots import Plots, plots_of
from cityx.geometry.seams import moved, on_grid
from cityx.ids import id_text
from cityx.sources.features.tagged import Owner, Tagged, Tags, joined, number_pieces
from cityx.sources.parcels.estates import (
    campuses,
    core_towers,
    perimeter_blocks,
    shops,
    slabs,
    works,
)
from cityx.sources.parcels.houses import (
    Built,
    built,
    farms,
    row_houses,
    semi_houses,
    suburban_houses,
    tagged_of,
)

FENCE_GRID = 1e-3  # metres; borders that are the same to the millimetre get one fence
CLEAR = 0.3  # metres between a fence and a wall
PLAIN = {"cap_style": "flat", "join_style": "mitre"}  # of a margin; round ones cost three times
SHORTEST = 1.5  # metres of fence


@dataclass(frozen=True)
class Grounds:
    """What a zone puts on its parcels.

    Attributes
    ----------
    raise_on
        Makes the buildings and what belongs to them.
    coverage
        Share of a parcel's area that its buildings take.
    ground
        Tags of the rest of the parcel.
    fences
        Kinds of fence between parcels, one of which a block draws; none for open ground.
    """

    raise_on: Callable[..., list[Built]]
    coverage: float
    ground: Mapping[str, str]
    fences: tuple[str, ...] = ()


GROUNDS: Mapping[str, Grounds] = {
    "core": Grounds(core_towers, 0.62, {"landuse": "commercial"}),
    "midrise": Grounds(perimeter_blocks, 0.50, {"landuse": "grass"}),
    "row": Grounds(row_houses, 0.36, {"leisure": "garden"}, ("fence", "wall", "hedge")),
    "semi": Grounds(semi_houses, 0.17, {"leisure": "garden"}, ("hedge", "fence", "wall")),
    "suburb": Grounds(suburban_houses, 0.24, {"leisure": "garden"}, ("hedge", "fence", "fence")),
    "rural": Grounds(farms, 0.09, {"landuse": "meadow"}, ("hedge", "fence")),
    "industry": Grounds(works, 0.42, {"landuse": "industrial"}, ("fence",)),
    "campus": Grounds(campuses, 0.22, {"landuse": "grass"}),
    "slab": Grounds(slabs, 0.18, {"landuse": "grass"}),
    "retail strip": Grounds(shops, 0.28, {"landuse": "retail"}),
}


def footprints_of(
    parcels: Parcels,
    zone: ArrayLike,
    density: ArrayLike,
    height: ArrayLike,
    *,
    seed: int,
    coverage: float = 0.0,
) -> Tagged:
    """Put buildings and grounds on parcels.

    Parameters
    ----------
    parcels
        Those of a block together: how deep its houses are and where its fences run depends on all.
    zone
        (m,) words of `GROUNDS`.
    density
        (m,) 0 to 1.
    height
        (m,) metres that the main building shall have, NaN where the zone decides.
    coverage
        Share of the parcels that buildings take; 0 leaves it to the zone.

    Returns
    -------
    footprints
        Buildings (`building=*`, `building:part=*`), grounds, drives, car parks, and the lines of
        fences and hedges; ids come from those of the parcels.

    Raises
    ------
    UsageError
        For an unknown zone.
    """
    zones = np.asarray(zone, object)
    unknown = sorted({str(word) for word in zones if word not in GROUNDS})
    if unknown:
        raise UsageError(f"zones {', '.join(unknown)} are none of {', '.join(GROUNDS)}")
    plots = plots_of(parcels, np.asarray(density, float), np.asarray(height, float))
    found: list[Built] = []
    lines: list[Tagged] = []
    for word, kind in GROUNDS.items():
        rows = np.flatnonzero(zones == word)
        if not len(rows):
            continue
        some = plots.take(rows)
        raised = kind.raise_on(some, coverage or kind.coverage, seed=seed)
        raised.append(_ground(some, raised, dict(kind.ground)))
        found += [one.of(rows) for one in raised]
        if kind.fences:
            lines.append(_fences(parcels.take(rows), some, raised, kind.fences, seed=seed))
    return joined(tagged_of(found, plots.id, plots.shift), *lines)


def _ground(plots: Plots, raised: list[Built], tags: Tags) -> Built:
    """Return what the buildings, car parks and paths leave of each parcel."""
    taken = _collected(plots, raised, lambda own: "building:part" not in own)
    rest = on_grid(np.asarray(shapely.difference(plots.shapes, taken), object))
    return built("ground", rest, tags, np.ones(plots.count, bool))


def _collected(plots: Plots, raised: list[Built], wanted: Callable[[Tags], bool]) -> NDArray[Any]:
    """Merge some of the shapes on each plot."""
    rows, shapes = [], []
    for some in raised:
        chosen = [i for i, own in enumerate(some.tags) if wanted(own)]
        rows.append(some.row[chosen])
        shapes.append(some.shapes[chosen])
    row, shape = np.concatenate(rows), np.concatenate(shapes)
    order = np.argsort(row, kind="stable")
    taken = np.full(plots.count, shapely.GeometryCollection(), object)
    owners, index = np.unique(row[order], return_inverse=True)
    if len(owners):
        parts, of = shapely.get_parts(shape[order], return_index=True)
        taken[owners] = shapely.unary_union(
            shapely.multipolygons(parts, indices=index[of]).reshape(-1, 1), axis=1
        )
    return taken


def _by_block(
    shapes: NDArray[Any], block: IntArray, count: int, collect: Callable[..., NDArray[Any]]
) -> NDArray[Any]:
    """Collect the parts of shapes block by block, (count,) collections."""
    parts, row = shapely.get_parts(shapes, return_index=True)
    order = np.argsort(block[row], kind="stable")
    rows, index = np.unique(block[row][order], return_inverse=True)
    found = np.full(count, shapely.GeometryCollection(), object)
    if len(rows):
        found[rows] = collect(parts[order], indices=index)
    return found


def _fences(
    parcels: Parcels, plots: Plots, raised: list[Built], kinds: tuple[str, ...], *, seed: int
) -> Tagged:
    """Draw fences between the parcels of each block, once along each border, clear of walls."""
    blocks, first, block = np.unique(plots.block_id, return_index=True, return_inverse=True)
    shift = np.floor(shapely.bounds(parcels.shapes)[first, :2])
    count = len(blocks)
    borders = shapely.boundary(moved(parcels.shapes, -shift[block]))
    streets = moved(parcels.street, -shift[block])
    walls = _collected(plots, raised, lambda own: "building" in own or "area:highway" in own)
    walls = moved(walls, plots.shift - shift[block])
    once = shapely.unary_union(
        _by_block(borders, block, count, shapely.multilinestrings).reshape(-1, 1),
        axis=1, grid_size=FENCE_GRID,
    )  # fmt: skip
    margins = (
        shapely.buffer(_by_block(streets, block, count, shapely.multilinestrings), CLEAR, **PLAIN),
        shapely.buffer(_by_block(walls, block, count, shapely.multipolygons), CLEAR, **PLAIN),
    )
    for margin in margins:
        once = shapely.difference(once, margin)
    merged = shapely.line_merge(once)
    pieces, owner = shapely.get_parts(moved(merged, shift), return_index=True)
    long = shapely.length(pieces) > SHORTEST
    pieces, owner = pieces[long], owner[long]
    kind = np.floor(len(kinds) * plots.draw_alike("fence", 0.0, 1.0, seed=seed)[first]).astype(int)
    owners = [
        Owner(("block", id_text(one)), {"barrier": kinds[which]}, ("fence",))
        for one, which in zip(blocks.tolist(), kind.tolist(), strict=True)
    ]
    return Tagged(pieces, owner.astype(np.int64), number_pieces(owner), owners)
