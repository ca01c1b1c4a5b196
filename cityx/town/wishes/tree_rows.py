"""Rows of trees along a river, around a square, beside a railway."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city import City, Goal, Layout
from cityx.errors import ActionFailed
from cityx.ids import stable_id
from cityx.nature.trees.stands import SPECIES
from cityx.protocol import Choice, Port, Range, action
from cityx.road.network.network import DRIVABLE
from cityx.sources.features.resolve import Features
from cityx.sources.features.shells import make_shells
from cityx.sources.features.tagged import Owner, Report, nothing, tag
from cityx.town.elements import FEWEST_TREES, ROW_REACH, row_of_trees
from cityx.town.rebuilding import WET, with_features
from cityx.town.wishes.elements import WHERE
from cityx.town.wishes.standing import shapes_of

OFFSETS = (4.0, -3.0, 8.0, 14.0)  # metres from the rim of a place; inside it where negative
WALL, KERB, RAIL = 2.5, 0.8, 3.5  # metres from trees to walls, carriageways and rails
CLOSEST = 3.5  # metres between trees at least
BORDER = 2.0  # metres from the border of the site


@action(
    "layout/tree_row-v1",
    limits=["Trees stand where neither a street, a house nor water is; a row has gaps there."],
    requires=("layout",),
    after=("layout/tallest-v1",),
    takes=(Port("layout", "scene_layout"),),
    gives=(Port("layout", "scene_layout"),),
    labels=("row of trees", "avenue of trees", "along the river", "around the square"),
)
def tree_row(
    city: City,
    *,
    near: Annotated[str, Choice(*WHERE[1:])],
    species: Annotated[str, Choice("", *SPECIES)] = "",
    spacing: Annotated[float, Range(3.0, 60.0)] = 10.0,
) -> City:
    """Plant trees along the rim of every place of a kind.

    Parameters
    ----------
    city
        City with that place.
    near
        What they stand along or around.
    species
        Of the trees, "" for what grows there.
    spacing
        Metres between them.
    """
    places = shapes_of(city, near)
    word = near.replace("_", " ")
    if not len(places):
        raise ActionFailed(f"There is no {word} for trees to stand along.")
    spots: NDArray[Any] = np.zeros(0, object)
    for closer in (spacing, max(spacing / 2, CLOSEST), CLOSEST):  # round what is small
        if len(spots) < FEWEST_TREES:
            tried = [_spots(city.layout, places, offset, closer) for offset in OFFSETS]
            spots = max(tried, key=len)
    if len(spots) < FEWEST_TREES:
        raise ActionFailed(f"Beside the {word} is room for {len(spots)} trees only.")
    named = {"genus:en": species} if species else {}
    owners = [
        Owner(("made", "tree_row", stable_id(near, *np.rint(1000 * at).astype(int).tolist())),
              {"natural": "tree", **named})
        for at in shapely.get_coordinates(spots)
    ]  # fmt: skip
    shells, box = make_shells(nothing(), nothing(), city.layout.extent, Report())
    features = Features(box, shells, points=tag(list(spots), owners))
    layout = with_features(city, city.layout, features)
    goal = Goal(f"{species or 'tree'}s along the {word}", row_of_trees(near, species))
    return replace(city, layout=layout, goals=(*city.goals, goal))


def _spots(layout: Layout, places: NDArray[Any], offset: float, spacing: float) -> NDArray[Any]:
    """Return points along the rims of places, so far outside, that are free, in their order."""
    grown = shapely.union_all(shapely.buffer(places, offset, quad_segs=4))
    rims = shapely.get_parts(shapely.boundary(shapely.get_parts(grown)))
    found = [
        shapely.line_interpolate_point(rim, np.arange(0.5, int(rim.length / spacing)) * spacing)
        for rim in rims.tolist() if rim.length >= spacing
    ]  # fmt: skip
    if not found:
        return np.zeros(0, object)
    spots = np.concatenate(found)
    spots = shapely.points(np.round(shapely.get_coordinates(spots), 3))
    free = ~shapely.intersects(spots, _taken(layout))
    near = shapely.dwithin(spots, shapely.union_all(places), ROW_REACH - 1.0)
    xmin, ymin, xmax, ymax = layout.extent
    site = shapely.box(xmin + BORDER, ymin + BORDER, xmax - BORDER, ymax - BORDER)
    return np.asarray(spots[free & near & shapely.within(spots, site)])


def _taken(layout: Layout) -> Any:
    """Return the ground on which no tree stands."""
    roads = layout.roads
    drive = roads["kind"].isin(DRIVABLE).to_numpy(bool)
    half = np.where(drive, roads["width"].to_numpy(float) / 2 + KERB, RAIL)
    areas = layout.areas
    wet = areas.geometry.to_numpy()[areas["kind"].isin(WET).to_numpy()]
    shape = shapely.union_all(
        np.concatenate([
            shapely.buffer(roads.geometry.to_numpy(), half, quad_segs=2),
            shapely.buffer(layout.buildings.geometry.to_numpy(), WALL, quad_segs=2), wet,
        ])
    )  # fmt: skip
    shapely.prepare(shape)
    return shape
