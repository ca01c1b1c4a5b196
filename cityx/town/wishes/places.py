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
from cityx.city.asked_goals import asked, with_goal
from cityx.city.layout import of_kinds
from cityx.errors import ActionFailed
from cityx.geometry.arrays import FloatArray
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
ASIDE = 12.0  # of the same weight, a block at the far side of the site from where one is to be
AROUND = 0.1  # of an area, by which it may be missed
HALVINGS = 24  # of the metres that a shore is moved for an area
ISLAND, LEAST_ROUND = 0.38, 16.0  # of the radius of a lake; metres of it from which it holds one
INSTEAD = "grass"  # land where there is to be a place no more


@action(
    "layout/places-v1",
    limits=[
        "Blocks with buildings are cleared where there are too few; none is built again.",
        "Squares and parks of another size than is asked for become grass.",
    ],
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
    side: Annotated[str, Choice("any", "north", "east", "south", "west")] = "any",
    area: Annotated[float, Range(0.0, 500_000.0)] = 0.0,
    islands: Annotated[int, Range(0, 5)] = 0,
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
    side
        Of the site, where new ones lie.
    area
        Square metres of each, new ones get as much as their block holds; 0 for what suits.
    islands
        How many each lake that is new has.
    """
    if area and count and kind != "lake":
        for place in places_of(city, kind).tolist():
            if abs(place.area - area) > AROUND * area:
                city = given_up(city, kind, place)
    found = places_of(city, kind)
    if central and count and not _is_central(city, found):
        city = added_place(city, kind, central=True, area=area)
        found = places_of(city, kind)
    middle = shapely.box(*city.layout.extent).centroid
    kept = central & (shapely.distance(found, middle) <= central_reach(city))
    order = np.lexsort((np.round(shapely.area(found), 2), kept))
    for place in found[order][: max(len(found) - count, 0)].tolist():
        city = given_up(city, kind, place)
    for _ in range(count - len(found)):
        city = added_place(city, kind, side=side, area=area, islands=islands)
    word = kind if count == 1 else f"{kind}s"
    city = asked(city, f"{count} {word}", f"n({kind})", least=count, most=count)
    if side != "any" and count:
        city = with_goal(city, f"{word} in the {side}", f"side({kind}) == {side}")
    if area and count:
        city = asked(city, f"{word} of {area:g} square metres", f"stat({kind}, area, mean)",
                     least=(1 - AROUND) * area, most=(1 + AROUND) * area)  # fmt: skip
    if islands and count:
        city = asked(city, f"{islands} islands in a {kind}", "n(island)", least=islands)
    if not central or not count:
        return city
    return asked(city, f"a {kind} in the middle", f"dist({kind}, center)", most=central_reach(city))


def _is_central(city: City, found: NDArray[Any]) -> bool:
    """Return whether one of some places lies near the middle of the site."""
    middle = shapely.box(*city.layout.extent).centroid
    return bool((shapely.distance(found, middle) <= central_reach(city)).any())


def given_up(city: City, kind: str, place: Any) -> City:
    """Turn a place of a kind, a word of `LANDS`, to grass that is nothing else besides."""
    areas = city.layout.areas.copy()
    own = of_kinds(areas, LANDS[kind])
    inside = shapely.intersects(areas.geometry.to_numpy(), shapely.buffer(place, -0.1))
    words = areas["kind"].to_numpy().astype(object)
    words[own & inside] = INSTEAD
    areas["kind"] = words
    areas["kind"] = areas["kind"].astype(city.layout.areas["kind"].dtype)
    areas.loc[own & inside, "tags"] = ""
    return replace(city, layout=replace(city.layout, areas=areas))


def central_reach(city: City) -> float:
    """Return the metres from the middle of a site within which a place is central."""
    xmin, ymin, xmax, ymax = city.layout.extent
    return CENTRAL * min(xmax - xmin, ymax - ymin)


def added_place(
    city: City, kind: str, *, central: bool = False, side: str = "any", area: float = 0.0,
    islands: int = 0,
) -> City:  # fmt: skip
    """Turn the block that suits best, near the middle, into a plaza, park or lake.

    Parameters
    ----------
    central
        Whether it must lie within `central_reach`; what is too large there is cut to size.
    side, area, islands
        As of `places`.

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
    if area:
        least, best, most = 1.15 * area, 1.5 * area, 20 * area
        if kind != "lake":  # a lake has a shore
            least, best = (1 - AROUND / 2) * area, area
    size = shapely.area(blocks)
    fit = (size >= least) & (size <= most) & _free(blocks, kept)
    if not fit.any():
        raise ActionFailed(
            f"No block of the site is free for a {kind} of {least:g} to {most:g} square metres; "
            "ask for fewer, or for a larger site."
        )
    away = shapely.distance(shapely.centroid(blocks), middle)
    if side != "any":
        away = NEARER * ASIDE * _off_side(blocks, layout.extent, side)
    cost = np.abs(np.log(size / best)) + away / NEARER
    border = shapely.box(*layout.extent).exterior
    cost += CUT * (shapely.distance(blocks, border) <= BORDER)
    block = blocks[int(np.argmin(np.where(fit, np.round(cost, 6), np.inf)))]
    shape = block
    if kind == "lake":
        inner = shapely.buffer(block, -SHORE - ROUND)
        shape = max(shapely.get_parts(shapely.buffer(inner, ROUND)), key=lambda part: part.area)
        shape = _of_area(block, shape, area) if area else shape
        if islands:
            shape = shapely.difference(shape, _islands(shape, islands))
    if area and kind != "lake":
        shape = block = _cut_to(block, area)
    layout = cleared(layout, block)
    number = len(layout.areas)
    name = name_of(city.seed, (NAMES[kind],), 5, number=number)
    owner = Owner(("made", kind, number), {"name": name})
    layout = with_area(layout, LAND[kind], shapely.orient_polygons(shape), owner)
    if kind == "lake":
        shore = shapely.orient_polygons(shapely.difference(block, shape))
        layout = with_area(layout, "grass", shore, Owner(("made", "shore", number), {}))
    return replace(city, layout=layout)


def _off_side(blocks: NDArray[Any], extent: Any, side: str) -> FloatArray:
    """Return how far blocks lie from a side of the site, 0 to 1."""
    xmin, ymin, xmax, ymax = extent
    x, y = shapely.get_coordinates(shapely.centroid(blocks)).T
    east, north = (x - xmin) / (xmax - xmin), (y - ymin) / (ymax - ymin)
    return np.asarray({"east": 1 - east, "west": east, "north": 1 - north, "south": north}[side])


def _cut_to(block: Any, area: float) -> Any:
    """Return an end of a block of an area, cut across its longer side; all of one as small."""
    if block.area <= (1 + AROUND / 2) * area:
        return block
    corners = shapely.get_coordinates(shapely.oriented_envelope(block))[:4]
    sides = np.roll(corners, -1, axis=0) - corners
    long = int(np.argmax(np.round(np.hypot(*sides.T), 3)))
    start, way = corners[long], sides[long]
    across = corners[long - 1] - start
    low, high = 0.0, 1.0
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        less = _end_of(block, start, middle * way, across).area < area
        low, high = (middle, high) if less else (low, middle)
    found = shapely.get_parts(_end_of(block, start, high * way, across))
    shape = max(found, key=lambda part: part.area)
    return shapely.orient_polygons(shapely.set_precision(shape, 1e-3))


def _end_of(block: Any, start: FloatArray, way: FloatArray, across: FloatArray) -> Any:
    """Return what of a block lies in a rectangle from a corner of its envelope."""
    ring = [start, start + way, start + way + across, start + across]
    return shapely.intersection(block, shapely.Polygon(ring))


def _of_area(block: Any, shape: Any, area: float) -> Any:
    """Return a lake of an area: grown to its block's walks, or drawn in from its shore.

    Raises
    ------
    ActionFailed
        If the block is too small.
    """
    low, high = -0.5 * float(np.sqrt(area)), SHORE
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        low, high = (middle, high) if _largest(shape, middle, block).area < area else (low, middle)
    found = _largest(shape, high, block)
    if found.area < (1 - AROUND) * area:
        raise ActionFailed(
            f"No block of the site holds a lake of {area:g} square metres; the largest has "
            f"{found.area:.0f}. Ask for less, or for larger blocks."
        )
    return found


def _largest(shape: Any, grown: float, block: Any) -> Any:
    inner = shapely.buffer(block, -2.0)
    found = shapely.intersection(shapely.buffer(shape, grown), inner)
    return max(shapely.get_parts(found), key=lambda part: part.area)


def _islands(shape: Any, count: int) -> Any:
    """Return islands amid a lake: one in its middle, more round it.

    Raises
    ------
    ActionFailed
        If it is too narrow for them.
    """
    circle = shapely.maximum_inscribed_circle(shape, 0.5)
    if circle.length < LEAST_ROUND:
        raise ActionFailed("A lake on this site is too small for an island; ask for more area.")
    middle = np.array(circle.coords[0])
    if count == 1:
        return shapely.buffer(shapely.Point(middle), ISLAND * circle.length, quad_segs=6)
    turn = 2 * np.pi * np.arange(count) / count
    away = circle.length / 2 * np.column_stack([np.cos(turn), np.sin(turn)])
    spots = shapely.points(np.round(middle + away, 3))
    return shapely.union_all(shapely.buffer(spots, ISLAND * circle.length / 2, quad_segs=6))


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
