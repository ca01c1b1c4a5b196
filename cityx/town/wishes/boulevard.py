"""A boulevard straight through a city."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Annotated, Any

import numpy as np
import shapely

from cityx.city import City, Layout
from cityx.city.asked_goals import asked
from cityx.protocol import Choice, Port, Range, action
from cityx.road.network.network import DRIVABLE
from cityx.sources.features.tagged import Owner, Tags
from cityx.town.cutting import street_rows, strip_of, with_streets
from cityx.town.procedural_streets import boulevard_tags

AXES = ("north_south", "east_west")
NEAR = 0.2  # of the site's size from its middle, within which a street may become the boulevard
PARALLEL = 0.02  # metres aside per metre ahead that such a street has at most


@action(
    "layout/boulevard-v1",
    limits=["What stands in the way is taken down; streets close beside it are given up."],
    requires=("layout",),
    after=("layout/ring_road-v1",),
    takes=(Port("layout", "scene_layout"),),
    gives=(Port("layout", "scene_layout"),),
    labels=("avenue", "main street", "lanes", "axis"),
)
def boulevard(
    city: City,
    *,
    lanes: Annotated[int, Range(2, 12)] = 6,
    axis: Annotated[str, Choice(*AXES)] = "north_south",
    others: Annotated[int, Range(0, 8)] = 0,
) -> City:
    """Cut a boulevard straight through a city, from border to border.

    Parameters
    ----------
    city
        City with streets.
    lanes
        Of both directions together.
    axis
        Where it leads. A long street that way near the middle of the site becomes the boulevard.
    others
        Lanes that every other street shall have, none of them being as main a road; 0 leaves them.
    """
    layout = city.layout
    if others:
        layout = _with_lanes(city, others)
    line = _line(layout, axis)
    tags = boulevard_tags(city.seed, lanes)
    owner = Owner(("made", "boulevard", axis), tags)
    city = with_streets(replace(city, layout=layout), [(line, owner)], strip_of(line, tags, city))
    words = f"a boulevard of {lanes} lanes from {axis.replace('_', ' to ')}"
    way = "y" if axis == "north_south" else "x"
    return asked(city, words, f"spans(road, class=primary, dir={way})", least=0.95)


def _line(layout: Layout, axis: str) -> Any:
    """Return the middle of a boulevard."""
    xmin, ymin, xmax, ymax = layout.extent
    across = 0 if axis == "north_south" else 1
    low, high = (xmin, xmax) if across == 0 else (ymin, ymax)
    place = _street_near(layout, across, low, high)
    if across == 0:
        return shapely.LineString([(place, ymin), (place, ymax)])
    return shapely.LineString([(xmin, place), (xmax, place)])


def _street_near(layout: Layout, across: int, low: float, high: float) -> float:
    """Return where the longest straight street near the middle lies, else the middle."""
    roads = layout.roads[layout.roads["kind"].isin(DRIVABLE)].geometry.to_numpy()
    middle = (low + high) / 2
    box = shapely.bounds(roads)
    wide = box[:, 2 + across] - box[:, across]
    long = box[:, 3 - across] - box[:, 1 - across]
    at = (box[:, across] + box[:, 2 + across]) / 2
    fits = (wide <= PARALLEL * long) & (np.abs(at - middle) <= NEAR * (high - low))
    if not fits.any():
        return round(middle, 3)
    # The longest, then the nearest to the middle.
    order = np.lexsort((np.round(np.abs(at - middle), 2), -np.round(long, 1)))
    return round(float(at[order[fits[order]][0]]), 3)


def _with_lanes(city: City, lanes: int) -> Layout:
    """Give all roads of a layout so many lanes, and the main ones the rank below a boulevard's."""
    layout = city.layout
    roads = layout.roads.copy()
    rows = np.flatnonzero(roads["kind"].isin(DRIVABLE).to_numpy())
    owners = [
        Owner(("made", "lanes", k), _changed(json.loads(text or "{}"), lanes))
        for k, text in enumerate(roads["tags"].to_numpy()[rows].tolist())
    ]
    new = street_rows(city, list(roads.geometry.to_numpy()[rows]), owners)
    ids = np.array([owner.id() for owner in owners], np.uint64)
    order = np.searchsorted(new["id"].to_numpy(), ids)
    kept = ("id", "source", "name", "geometry")
    for column in roads.columns:
        if column not in kept:
            values = roads[column].to_numpy().copy()
            values[rows] = new[column].to_numpy()[order]
            roads[column] = values
            roads[column] = roads[column].astype(layout.roads[column].dtype)
    return replace(layout, roads=roads)


LOWER = {"motorway": "secondary", "trunk": "secondary", "primary": "secondary"}


def _changed(tags: Tags, lanes: int) -> Tags:
    """Return the tags of a road that has so many lanes, in both directions."""
    gone = ("oneway", "lanes:forward", "lanes:backward", "width", "width:carriageway", "turn:lanes")
    kept = {key: value for key, value in tags.items() if key not in gone}
    highway = tags.get("highway", "residential")
    return {**kept, "highway": LOWER.get(highway, highway), "lanes": str(lanes)}
