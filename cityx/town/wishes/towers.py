"""A number of towers of given heights, around a plaza, a park, water or the middle of a site."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.checks.predicates.places import places_of
from cityx.checks.predicates.words import NEAR
from cityx.city import City, Goal, Layout
from cityx.city.asked_goals import asked
from cityx.errors import ActionFailed, UsageError
from cityx.ids import uniform
from cityx.protocol import Choice, Port, Range, action
from cityx.sources.features.kinds import PLACE
from cityx.sources.features.tagged import Owner
from cityx.town.rebuilding import (
    BUILT_ON,
    cleared,
    is_square,
    lowered,
    street_blocks,
    with_buildings,
    without_buildings,
)
from cityx.town.wishes.places import added_place, central_reach

SIDE = 27.0  # metres of a tower's plan
SLENDER = 7.0  # times its side that a tower is high at most
GAP = 13.0  # metres between two towers
SETBACK = 4.0  # metres from the walk to a tower
STOREY = 3.8  # metres
FENCES = ("wall", "fence", "hedge")  # between grounds


@action(
    "layout/towers-v1",
    limits=["Buildings in the way are taken down; others of such heights are lowered."],
    requires=("layout",),
    after=("layout/green_share-v1",),
    takes=(Port("layout", "scene_layout"),),
    gives=(Port("layout", "scene_layout"),),
)
def towers(
    city: City,
    *,
    count: Annotated[int, Range(1, 400)] = 1,
    lowest: Annotated[float, Range(20.0, 600.0)] = 80.0,
    highest: Annotated[float, Range(20.0, 600.0)] = 150.0,
    around: Annotated[str, Choice("plaza", "park", "water", "nothing")] = "plaza",
    alone: bool = False,
) -> City:
    """Build exactly so many towers, all of them between two heights.

    Parameters
    ----------
    city
        City with streets; a plaza or park is laid out where it has none.
    count
        Number of towers. No other building is as high.
    lowest, highest
        Metres.
    around
        What they stand around; "nothing" is the middle of the site.
    alone
        Whether all other buildings go, for a park with nothing but towers.
    """
    if lowest > highest:
        raise UsageError(f"lowest = {lowest:g} m is more than highest = {highest:g} m.")
    city, focus = _focus(city, around)
    layout = city.layout
    side = max(SIDE, highest / SLENDER)
    pads = _pads(layout, focus, side)
    if around != "nothing":
        pads = pads[shapely.distance(pads, focus) <= NEAR - side]
    if len(pads) < count:
        raise ActionFailed(
            f"{count} towers of {side:.0f} m by {side:.0f} m do not fit around the {around}: there "
            f"is room for {len(pads)}. Ask for fewer or lower ones, or for a larger site."
        )
    pads = pads[:count]
    layout = cleared(layout, shapely.union_all(shapely.buffer(pads, GAP / 2)))
    if alone:
        layout = _parkland(layout)
    ids = np.arange(1, count + 1).astype(np.uint64)
    heights = np.round(lowest + (highest - lowest) * uniform(city.seed, "layout/towers", ids), 1)
    owners = [_owner(k, height) for k, height in enumerate(heights.tolist())]
    layout = with_buildings(city, layout, list(pads), owners)
    new = np.array([owner.id() for owner in owners], np.uint64)
    layout = lowered(layout, lowest, but=new)
    tall = f"building, height in [{lowest:g}, {highest:g}]"
    goals = [Goal(f"{count} towers of {lowest:g} to {highest:g} m", f"n({tall}) == {count}")]
    if around != "nothing":
        place = around if around == "water" else f"a {around}"
        goals.append(Goal(f"towers around {place}", f"around({tall}, {around})"))
    city = replace(city, layout=layout, goals=(*city.goals, *goals))
    return asked(city, "no other building", "n(building)", most=count) if alone else city


def _parkland(layout: Layout) -> Layout:
    """Take all buildings down and turn their grounds to grass."""
    layout = without_buildings(layout, np.arange(len(layout.buildings)))
    areas = layout.areas.copy()
    ground = areas["kind"].isin(BUILT_ON) & ~is_square(areas)
    areas["kind"] = areas["kind"].where(~ground, "grass")
    fences = layout.lines["kind"].isin(FENCES)
    return replace(layout, areas=areas, lines=layout.lines[~fences].reset_index(drop=True))


def _owner(k: int, height: float) -> Owner:
    levels = max(round((height - 1.0) / STOREY), 1)
    return Owner(("made", "tower", k), {
        "building": "office" if k % 2 else "apartments", "building:levels": str(levels),
        "height": f"{height:g}", "roof:shape": "flat", PLACE: "core",
    })  # fmt: skip


def _focus(city: City, around: str) -> tuple[City, Any]:
    """Return what towers shall stand around, and the city that has it."""
    middle = shapely.box(*city.layout.extent).centroid
    if around == "nothing":
        return city, middle
    found = places_of(city, around)
    if not len(found):
        if around == "water":
            raise ActionFailed("There is no water to build around; lay out a lake or a river.")
        city = added_place(city, around)
        found = places_of(city, around)
    away = shapely.distance(found, middle)
    if around != "water" and away.min() > central_reach(city):
        city = added_place(city, around, central=True)
        found = places_of(city, around)
        away = shapely.distance(found, middle)
    return city, found[int(np.argmin(np.round(away, 3)))]


def _pads(layout: Layout, focus: Any, side: float) -> NDArray[Any]:
    """Return squares for towers within blocks, nearest to a place first."""
    blocks = street_blocks(layout)
    parks = (layout.areas["kind"] == "park").to_numpy()
    open_land = layout.areas.geometry.to_numpy()[parks | is_square(layout.areas)]
    shut = shapely.union_all(open_land)
    found = [_grid(block, side) for block in blocks.tolist()]
    pads = np.concatenate([np.zeros(0, object), *found])
    site = shapely.box(*layout.extent)
    clear = shapely.contains(site, shapely.buffer(pads, SETBACK)) & ~shapely.intersects(pads, shut)
    pads = pads[clear & ~shapely.intersects(pads, focus)]
    away = np.round(shapely.distance(shapely.centroid(pads), focus), 2)
    return np.asarray(pads[np.argsort(away, kind="stable")])


def _grid(block: Any, side: float) -> NDArray[Any]:
    """Fill a block with squares, in the direction of the rectangle around it."""
    inner = shapely.buffer(block, -SETBACK, join_style="mitre")
    ring = shapely.get_coordinates(shapely.oriented_envelope(inner))
    if len(ring) < 5:
        return np.zeros(0, object)
    edge = ring[1] - ring[0], ring[3] - ring[0]
    length = [float(np.hypot(*way)) for way in edge]
    counts = [int((size + GAP) // (side + GAP)) for size in length]
    if not all(counts):
        return np.zeros(0, object)
    u, v = (way / size for way, size in zip(edge, length, strict=True))
    low = [np.arange(n) * (side + GAP) + (size - n * (side + GAP) + GAP) / 2 for n, size in zip(counts, length, strict=True)]  # fmt: skip  # noqa: E501
    a, b = (part.ravel()[:, None] for part in np.meshgrid(*low, indexing="ij"))
    corner = ring[0] + a * u + b * v
    rings = np.stack(
        [corner, corner + side * u, corner + side * (u + v), corner + side * v], axis=1
    )
    squares = shapely.polygons(np.round(rings, 3))
    return np.asarray(squares[shapely.contains(inner, squares)])
