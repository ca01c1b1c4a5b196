"""The share of a site that is green."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.checks.predicates.words import LANDS
from cityx.city import City, Layout
from cityx.city.asked_goals import asked
from cityx.errors import ActionFailed, UsageError
from cityx.geometry.scatter import cell_ids
from cityx.ids import uniform
from cityx.protocol import Port, Range, action
from cityx.sources.features.tagged import Owner
from cityx.town.procedural_streets import name_of
from cityx.town.rebuilding import BORDER, WET, cleared, is_made, is_square, street_blocks, with_area

LEAST = 1200.0  # square metres of a block that becomes a park
YARD = "residential"  # land that green becomes where there is too much


@action(
    "layout/green_share-v1",
    limits=["Blocks become parks, their buildings are taken down; none is built again."],
    requires=("layout",),
    after=("layout/places-v1",),
    takes=(Port("layout", "scene_layout"),),
    gives=(Port("layout", "scene_layout"),),
    labels=("green", "parks", "gardens", "grass", "leafy"),
)
def green_share(
    city: City,
    *,
    share: Annotated[float, Range(0.0, 0.9)] = 0.15,
    most: Annotated[float, Range(0.0, 1.0)] = 1.0,
) -> City:
    """Give a city at least, or at most, a share of green: parks, gardens, grass, woods.

    Parameters
    ----------
    city
        City with streets.
    share
        Of the site, 0 to 1. Where there is less, blocks drawn all over the site become parks.
    most
        Where there is more, yards are paved, gardens before parks.
    """
    if most < share:
        raise UsageError(f"share = {share:g} is more than most = {most:g}.")
    layout = _paved(city, most)
    site = shapely.box(*layout.extent).area
    missing = share * site - _green(layout)
    blocks = _blocks(layout)
    places = np.rint(shapely.get_coordinates(shapely.centroid(blocks))).astype(np.int64)
    order = np.argsort(uniform(city.seed, "layout/green", cell_ids(places)), kind="stable")
    for number, block in enumerate(blocks[order].tolist()):
        if missing <= 0:
            break
        before = _green(layout)
        name = name_of(city.seed, ("Park", "Gardens", "Green"), 6, number=number)
        owner = Owner(("made", "green", number), {"name": name})
        layout = with_area(cleared(layout, block), "park", block, owner)
        missing -= _green(layout) - before
    if missing > 0:
        raise ActionFailed(
            f"{share:g} of green cannot be had: with every free block a park it is "
            f"{share - missing / site:.3f}."
        )
    city = replace(city, layout=layout)
    if most < 1.0:
        city = asked(city, f"{100 * most:g} % green at most", "cover(green)", most=most)
    if not share:
        return city
    return asked(city, f"{100 * share:g} % green at least", "cover(green)", least=share)


def _paved(city: City, most: float) -> Layout:
    """Turn green land to yards until there is no more of it than a share of the site."""
    layout = city.layout
    site = shapely.box(*layout.extent).area
    areas = layout.areas.copy()
    words = areas["kind"].to_numpy().astype(object)
    rows = np.flatnonzero(areas["kind"].isin(LANDS["green"]).to_numpy())
    drawn = uniform(city.seed, "layout/green/paved", areas["id"].to_numpy(np.uint64)[rows])
    for row in rows[np.lexsort((drawn, words[rows] == "park"))].tolist():
        if _green(layout) <= most * site:
            break
        words[row] = YARD
        areas["kind"] = words
        areas["kind"] = areas["kind"].astype(city.layout.areas["kind"].dtype)
        layout = replace(layout, areas=areas.copy())
    return layout


def _green(layout: Layout) -> float:
    """Return the square metres of green in the site, what buildings stand on left out."""
    site = shapely.box(*layout.extent)
    land = layout.areas.geometry.to_numpy()[layout.areas["kind"].isin(LANDS["green"]).to_numpy()]
    return float(shapely.union_all(shapely.intersection(land, site)).area)


def _blocks(layout: Layout) -> NDArray[Any]:
    """Return the blocks that may become parks."""
    blocks = street_blocks(layout)
    areas = layout.areas
    kept = areas["kind"].isin([*WET, "park", "sand", "wood"]) | is_square(areas)
    made = is_made(layout.buildings)
    shut = [areas.geometry.to_numpy()[kept.to_numpy()], layout.buildings.geometry.to_numpy()[made]]
    free = np.ones(len(blocks), bool)
    inner = shapely.buffer(blocks, -BORDER)
    free[shapely.STRtree(np.concatenate(shut)).query(inner, predicate="intersects")[0]] = False
    return np.asarray(blocks[free & (shapely.area(blocks) >= LEAST)])
