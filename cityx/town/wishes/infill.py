"""Infill: buildings on the empty blocks of a map."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from typing import Annotated, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city import City, Layout
from cityx.city.asked_goals import asked
from cityx.errors import ActionFailed
from cityx.geometry.arrays import FloatArray
from cityx.protocol import Choice, Port, Range, action
from cityx.sources.features.tagged import Owner, named_note
from cityx.town.blocks import LAND
from cityx.town.cutting import block_parts, blocks_in, houses_on
from cityx.town.rebuilding import BUILT_ON, is_square, street_blocks, with_area
from cityx.town.wishes.limits import MOST, check_floors, within_limits

ZONES = ("core", "midrise", "row", "suburb", "industry", "retail strip")
# Kind of the land that a map has -> zone of what is built there.
ZONE_OF_LAND = {"industrial": "industry", "retail": "retail strip", "commercial": "core"}
TAKEN = 0.04  # share of a block under buildings, from which it is not empty
CLOSED = 0.6  # share of a block under parks, water, railways..., from which it is no block
LARGEST = 60_000.0  # square metres; larger land between streets is open country
DENSE = 12_000.0  # square metres of the median block, below which a map is of a town
MOSTLY = 0.5  # share of a block that its land covers
APART = 1.0  # metres between a new building and what a map has


@action(
    "layout/infill-v1",
    limits=[
        "Blocks on which a map has buildings, parks, woods or water stay as they are, as does land "
        f"of more than {LARGEST / 1e4:g} ha between streets.",
        "The buildings are invented, as their provenance tells.",
    ],
    requires=("layout",),
    takes=(Port("layout", "scene_layout"),),
    gives=(Port("layout", "scene_layout"),),
    labels=("fill", "infill", "empty blocks", "invent", "missing buildings", "populate"),
    serves=("blocks=filled",),
    binds={
        "zone": "blocks.zone",
        "least_floors": "blocks.floors.min",
        "most_floors": "blocks.floors.max",
    },
)
def infill(
    city: City,
    *,
    zone: Annotated[str, Choice("auto", *ZONES)] = "auto",
    largest: Annotated[float, Range(400.0, 1e6)] = LARGEST,
    least_floors: Annotated[int, Range(1, MOST)] = 1,
    most_floors: Annotated[int, Range(1, MOST)] = MOST,
) -> City:
    """Build on the blocks between the streets of a map on which there are no buildings.

    Parameters
    ----------
    city
        City with a layout.
    zone
        What is built; "auto" follows the land of the map, and how large its blocks are.
    largest
        Square metres of the largest land between streets that counts as a block.
    least_floors, most_floors
        Storeys of the buildings that are invented; those of the map stay as they are.

    Raises
    ------
    UsageError
        If the storeys are out of order.
    ActionFailed
        If there is no empty block, or none on which a building stands.
    """
    check_floors(least_floors, most_floors)
    layout = city.layout
    blocks = street_blocks(layout)
    shapes = _empty(layout, blocks, largest)
    if not len(shapes):
        raise ActionFailed(
            f"None of the {len(blocks)} blocks between the streets is empty and of {largest:g} m2 "
            "or less: on each there are buildings, parks or water."
        )
    words = _zones(layout, shapes) if zone == "auto" else [zone] * len(shapes)
    found = blocks_in(shapes, layout, words, np.full(len(shapes), np.nan))
    known = layout.buildings["id"].to_numpy(np.uint64)
    grown = houses_on(city, _with_land(layout, shapes, found.ids, words), found, shapes)
    grown, gone = _without_clashes(grown, layout)
    gained = ~np.isin(grown.buildings["id"].to_numpy(np.uint64), known)
    if not gained.any():
        raise ActionFailed("On none of the empty blocks is there room for a building.")
    count, kinds = int(gained.sum()), Counter(words)
    told = ", ".join(f"{number} as {word}" for word, number in sorted(kinds.items()))
    note = (
        f"infill: {count} buildings are invented, on {len(shapes)} blocks without any in the map "
        f"({told})."
    )
    lost = named_note("mapped lines and points make way for invented buildings", sorted(gone))
    city = replace(city, layout=grown, notes=(*city.notes, note, *([lost] if lost else [])))
    if (least_floors, most_floors) != (1, MOST):
        rows = np.flatnonzero(gained)
        city = replace(city, layout=within_limits(city, rows, (least_floors, most_floors)))
    return asked(city, "buildings on the empty blocks", "n(building)", least=len(known) + count)


def _empty(layout: Layout, blocks: NDArray[Any], largest: float) -> NDArray[Any]:
    """Return what of the blocks is free where nothing is built."""
    areas = layout.areas
    closed = ~areas["kind"].isin(BUILT_ON).to_numpy() | is_square(areas)
    built = shapely.union_all(layout.buildings.geometry.to_numpy())
    shut = shapely.union_all(areas.geometry.to_numpy()[closed])
    size = shapely.area(blocks)
    taken = _area_under(blocks, layout.buildings.geometry.to_numpy()) > TAKEN * size
    lost = _area_under(blocks, areas.geometry.to_numpy()[closed]) > CLOSED * size
    free = blocks[~taken & ~lost & (size <= largest)]
    return block_parts(free, shapely.union_all([shut, shapely.buffer(built, APART)]))


def _area_under(blocks: NDArray[Any], shapes: NDArray[Any]) -> FloatArray:
    """(b,) square metres of each block that shapes cover, those that overlap once."""
    block, shape = shapely.STRtree(shapes).query(blocks, predicate="intersects")
    whole = np.zeros(len(blocks), object)
    whole[:] = shapely.Polygon()
    for row in np.unique(block).tolist():
        whole[row] = shapely.union_all(shapes[shape[block == row]])
    return np.asarray(shapely.area(shapely.intersection(blocks, whole)))


def _zones(layout: Layout, blocks: NDArray[Any]) -> list[str]:
    """Return what is built on each block: as the land of the map says, or as a town usually is."""
    usual = "midrise" if float(np.median(shapely.area(blocks))) < DENSE else "suburb"
    shapes, kinds = layout.areas.geometry.to_numpy(), layout.areas["kind"].to_numpy(str)
    block, area = shapely.STRtree(shapes).query(blocks, predicate="intersects")
    share = shapely.area(shapely.intersection(blocks[block], shapes[area]))
    share /= shapely.area(blocks[block])
    zones = [usual] * len(blocks)
    for pair in np.lexsort((-area, share)).tolist():  # the largest last
        if share[pair] > MOSTLY:
            zones[block[pair]] = ZONE_OF_LAND.get(str(kinds[area[pair]]), usual)
    return zones


def _with_land(layout: Layout, shapes: NDArray[Any], ids: NDArray[Any], words: list[str]) -> Layout:
    """Lay the land of new blocks where the map has none."""
    own = shapely.union_all(layout.areas.geometry.to_numpy())
    for number, shape, word in zip(ids.tolist(), shapes.tolist(), words, strict=True):
        for part in shapely.get_parts(shapely.difference(shape, own)).tolist():
            if shapely.get_type_id(part) == 3 and shapely.area(part) > 1.0:
                layout = with_area(layout, LAND[word], part, Owner(("made", "block", number), {}))
    return layout


def _without_clashes(grown: Layout, before: Layout) -> tuple[Layout, set[str]]:
    """Take away mapped lines and points on which a new building stands; return their sources."""
    known = before.buildings["id"].to_numpy(np.uint64)
    new = ~np.isin(grown.buildings["id"].to_numpy(np.uint64), known)
    stand = shapely.union_all(grown.buildings.geometry.to_numpy()[new])
    shapely.prepare(stand)
    kept, gone = [], set[str]()
    for table, mapped in ((grown.lines, before.lines), (grown.points, before.points)):
        hit = shapely.intersects(table.geometry.to_numpy(), stand)
        kept.append(table[~hit].reset_index(drop=True))
        gone |= set(table["source"][hit].astype(str)) & set(mapped["source"].astype(str))
    return replace(grown, lines=kept[0], points=kept[1]), gone
