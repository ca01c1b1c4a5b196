"""An exact number of plazas, parks or lakes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Annotated, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.checks.predicates.places import places_of
from cityx.checks.predicates.words import LANDS
from cityx.city import City
from cityx.city.asked_goals import asked
from cityx.errors import ActionFailed
from cityx.protocol import Choice, Port, Range, action
from cityx.sources.features.tagged import Owner
from cityx.town.procedural_streets import name_of
from cityx.town.rebuilding import BORDER, cleared, is_made, is_square, street_blocks, with_area

# Square metres that suit a place, least, best and most.
SIZES: Mapping[str, tuple[float, float, float]] = {
    "plaza": (900.0, 3500.0, 12_000.0), "park": (2500.0, 9000.0, 40_000.0),
    "lake": (3500.0, 12_000.0, 60_000.0),
}  # fmt: skip
OPEN = ("park", "water", "sea", "river")
NAMES = {"plaza": "Square", "park": "Park", "lake": "Lake"}
LAND = {"plaza": "pedestrian", "park": "park", "lake": "water"}
NEARER = 150.0  # metres farther from the middle that weigh as much as a size 2.7 times off
CENTRAL = 0.15  # of the smaller side of a site, from its middle to a place that is central
CUT = 10.0  # of the same weight, against a block that the border of the site cuts
SHORE = 12.0  # metres from the walk to a lake
ROUND = 8.0  # metres of the corners of a lake
INSTEAD = "grass"  # land where there is to be a place no more


@action(
    "layout/places-v1",
    limits=["Blocks with buildings are cleared where there are too few; none is built again."],
    requires=("layout",),
    after=("layout/central_park-v1",),
    takes=(Port("layout", "scene_layout"),),
    gives=(Port("layout", "scene_layout"),),
)
def places(
    city: City,
    *,
    kind: Annotated[str, Choice("plaza", "park", "lake")] = "plaza",
    count: Annotated[int, Range(0, 50)] = 1,
    central: bool = False,
) -> City:
    """Give a city exactly so many plazas, parks or lakes.

    Parameters
    ----------
    city
        City with streets.
    kind
        What is counted: pieces of at least 300 square metres, those that touch as one.
    count
        How many there shall be; the smallest are given up, blocks become new ones.
    central
        Whether one of them must lie by the middle of the site.
    """
    found = places_of(city, kind)
    if central and count and not _is_central(city, found):
        city = added_place(city, kind, central=True)
        found = places_of(city, kind)
    middle = shapely.box(*city.layout.extent).centroid
    kept = central & (shapely.distance(found, middle) <= central_reach(city))
    order = np.lexsort((np.round(shapely.area(found), 2), kept))
    for place in found[order][: max(len(found) - count, 0)].tolist():
        city = given_up(city, kind, place)
    for _ in range(count - len(found)):
        city = added_place(city, kind)
    word = kind if count == 1 else f"{kind}s"
    city = asked(city, f"{count} {word}", f"n({kind})", least=count, most=count)
    if not central or not count:
        return city
    return asked(city, f"a {kind} in the middle", f"dist({kind}, center)", most=central_reach(city))


def _is_central(city: City, found: NDArray[Any]) -> bool:
    """Return whether one of some places lies near the middle of the site."""
    middle = shapely.box(*city.layout.extent).centroid
    return bool((shapely.distance(found, middle) <= central_reach(city)).any())


def given_up(city: City, kind: str, place: Any) -> City:
    """Turn a place of a kind, a word of `LANDS`, to grass."""
    areas = city.layout.areas.copy()
    own = areas["kind"].isin(LANDS[kind]).to_numpy()
    inside = shapely.intersects(areas.geometry.to_numpy(), shapely.buffer(place, -0.1))
    words = areas["kind"].to_numpy().astype(object)
    words[own & inside] = INSTEAD
    areas["kind"] = words
    areas["kind"] = areas["kind"].astype(city.layout.areas["kind"].dtype)
    return replace(city, layout=replace(city.layout, areas=areas))


def central_reach(city: City) -> float:
    """Return the metres from the middle of a site within which a place is central."""
    xmin, ymin, xmax, ymax = city.layout.extent
    return CENTRAL * min(xmax - xmin, ymax - ymin)


def added_place(city: City, kind: str, *, central: bool = False) -> City:
    """Turn the block that suits best, near the middle, into a plaza, park or lake.

    Parameters
    ----------
    central
        Whether it must lie within `central_reach`; what is too large there is cut to size.

    Raises
    ------
    ActionFailed
        If no block suits.
    """
    layout = city.layout
    least, best, most = SIZES[kind]
    blocks = street_blocks(layout)
    open_land = layout.areas["kind"].isin(OPEN).to_numpy() | is_square(layout.areas)
    # What was built because it was asked for stays, too.
    made = is_made(layout.buildings)
    kept = np.concatenate(
        [layout.areas.geometry.to_numpy()[open_land], layout.buildings.geometry.to_numpy()[made]]
    )
    middle = shapely.box(*layout.extent).centroid
    if central:
        blocks = _central(blocks, middle, central_reach(city), best)
    size = shapely.area(blocks)
    fit = (size >= least) & (size <= most) & _free(blocks, kept)
    if not fit.any():
        raise ActionFailed(
            f"No block of the site is free for a {kind} of {least:g} to {most:g} square metres; "
            "ask for fewer, or for a larger site."
        )
    away = shapely.distance(shapely.centroid(blocks), middle)
    cost = np.abs(np.log(size / best)) + away / NEARER
    border = shapely.box(*layout.extent).exterior
    cost += CUT * (shapely.distance(blocks, border) <= BORDER)
    block = blocks[int(np.argmin(np.where(fit, np.round(cost, 6), np.inf)))]
    shape = block
    if kind == "lake":
        inner = shapely.buffer(block, -SHORE - ROUND)
        shape = max(shapely.get_parts(shapely.buffer(inner, ROUND)), key=lambda part: part.area)
    layout = cleared(layout, block)
    number = len(layout.areas)
    name = name_of(city.seed, (NAMES[kind],), 5, number=number)
    owner = Owner(("made", kind, number), {"name": name})
    layout = with_area(layout, LAND[kind], shapely.orient_polygons(shape), owner)
    if kind == "lake":
        shore = shapely.orient_polygons(shapely.difference(block, shape))
        layout = with_area(layout, "grass", shore, Owner(("made", "shore", number), {}))
    return replace(city, layout=layout)


def _central(blocks: NDArray[Any], middle: Any, reach: float, best: float) -> NDArray[Any]:
    """Return the blocks that begin near the middle; of large ones what lies nearest to it."""
    near = blocks[shapely.distance(blocks, middle) <= reach]
    large = shapely.area(near) > 2 * best
    spots = shapely.get_point(shapely.shortest_line(near, middle), 0)
    squares = shapely.buffer(spots, np.sqrt(best), cap_style="square")
    cut = shapely.intersection(near, squares)
    whole = shapely.get_type_id(cut) == 3
    return np.where(large & whole, cut, near)


def _free(blocks: NDArray[Any], kept: NDArray[Any]) -> NDArray[np.bool_]:
    """Return which blocks hold nothing that stays."""
    free = np.ones(len(blocks), bool)
    inner = shapely.buffer(blocks, -1.0)
    free[shapely.STRtree(kept).query(inner, predicate="intersects")[0]] = False
    return free
