"""A boulevard straight through a city."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Annotated, Any

import numpy as np
import shapely

from cityx.city import City, Layout
from cityx.city.asked_goals import asked
from cityx.city.layout import joined_tables
from cityx.errors import ActionFailed
from cityx.geometry.arrays import FloatArray
from cityx.places.profiles import keeps_left, profile_of
from cityx.protocol import Choice, Port, Range, action
from cityx.road.network.network import DRIVABLE
from cityx.sources.features.tagged import Owner, Tags
from cityx.town.cutting import street_rows, strip_of, with_points, with_streets, with_tags
from cityx.town.procedural_streets import boulevard_tags, carriageway

AXES = ("north_south", "east_west")
NEAR = 0.2  # of the site's size from its middle, within which a street may become the boulevard
PLAIN = {"sidewalk": "no", "parking:both": "no", "surface": "asphalt", "lit": "yes"}
MERGED = 20.0  # metres between places on its carriageways that one link joins
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
    median: Annotated[float, Range(0.0, 20.0)] = 0.0,
    length: Annotated[float, Range(0.0, 20_000.0)] = 0.0,
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
    median
        Metres between its carriageways, planted from 2.5 m on; 0 for one carriageway.
    length
        Metres that it must have; it is as long as the site.
    """
    _check_length(city.layout, axis, length)
    if others:
        city = _with_lanes(city, others)
    line = _line(city.layout, axis)
    tags = boulevard_tags(city.seed, lanes)
    if median:
        city = _parted(city, line, tags, axis, median)
        city = asked(city, "a median", "n(road, class=primary, median in [1, 30])", least=1)
    else:
        owner = Owner(("made", "boulevard", axis), tags)
        city = with_streets(city, [(line, owner)], strip_of(line, tags, city))
    words = f"a boulevard of {lanes} lanes from {axis.replace('_', ' to ')}"
    way = "y" if axis == "north_south" else "x"
    return asked(city, words, f"spans(road, class=primary, dir={way})", least=0.95)


def _check_length(layout: Layout, axis: str, length: float) -> None:
    xmin, ymin, xmax, ymax = layout.extent
    room = ymax - ymin if axis == "north_south" else xmax - xmin
    if room < length - 1.0:
        raise ActionFailed(
            f"A straight street of {length:.0f} m does not fit: the site has {room:.0f} m from "
            f"{axis.replace('_', ' to ')}. Ask for a larger site."
        )


def _parted(city: City, line: Any, tags: Tags, axis: str, median: float) -> City:
    """Cut a boulevard of two carriageways, which cross streets join across the median."""
    each = {**tags, "oneway": "yes", "lanes": str(max(int(tags["lanes"]) // 2, 1))}
    outer = "left" if keeps_left(city.frame) else "right"
    each |= {"sidewalk": outer, f"sidewalk:{outer}:width": each.pop("sidewalk:both:width")}
    aside = (median + carriageway(each, profile_of(city.frame))) / 2
    sign = -1.0 if keeps_left(city.frame) else 1.0
    halves = [
        shapely.LineString(np.round(shapely.get_coordinates(half), 3))
        for half in (
            shapely.offset_curve(line, -sign * aside),
            shapely.reverse(shapely.offset_curve(line, sign * aside)),
        )
    ]
    owners = [Owner(("made", "boulevard", axis, k), each) for k in (0, 1)]
    strips = [strip_of(one, each, city) for one in halves]
    ground = shapely.union_all([shapely.buffer(line, aside, cap_style="flat"), *strips])
    city = with_streets(city, list(zip(halves, owners, strict=True)), ground)
    return _linked(city, line, owners, each)


def _linked(city: City, line: Any, owners: list[Owner], tags: Tags) -> City:
    """Join the carriageways wherever a street meets one of them."""
    roads = city.layout.roads
    ids = roads["id"].to_numpy()
    pair = [int(np.flatnonzero(ids == owner.id())[0]) for owner in owners]
    shapes = roads.geometry.to_numpy().copy()
    others = shapely.get_coordinates(np.delete(shapes, pair))
    met = [
        at for row in pair
        for at in _met(shapes[row], others, line)
    ]  # fmt: skip
    places: list[float] = []
    for at in sorted(met):
        if not places or at - places[-1] > MERGED:
            places.append(at)
    links, made = [], []
    for k, at in enumerate(places):
        ends = []
        for row in pair:
            own = np.array(sorted(_met(shapes[row], others, line)))
            near = own[np.abs(own - at) <= MERGED] if len(own) else own
            foot = float(near[np.argmin(np.abs(near - at))]) if len(near) else at
            spot = shapely.line_interpolate_point(line, foot)
            along = shapely.line_locate_point(shapes[row], spot)
            point = shapely.get_coordinates(shapely.line_interpolate_point(shapes[row], along))
            shapes[row] = with_points(shapes[row], np.round(point, 3))
            own_points = shapely.get_coordinates(shapes[row])
            ends.append(own_points[np.hypot(*(own_points - point).T).argmin()])
        links.append(shapely.LineString(ends))
        across = {"highway": "residential", "lanes": "2", "maxspeed": tags["maxspeed"], **PLAIN}
        made.append(Owner(("made", "boulevard", "link", k), across))
    new = street_rows(city, links, made)
    roads = joined_tables(roads.set_geometry(shapes), new)
    return replace(city, layout=replace(city.layout, roads=roads))


def _met(shape: Any, others: FloatArray, line: Any) -> list[float]:
    """Return the metres along a line at which other streets meet a carriageway."""
    own = shapely.get_coordinates(shape)[1:-1]
    shared = {tuple(point) for point in np.round(others, 3).tolist()}
    found = [point for point in np.round(own, 3).tolist() if tuple(point) in shared]
    return [float(shapely.line_locate_point(line, shapely.Point(point))) for point in found]


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


def _with_lanes(city: City, lanes: int) -> City:
    """Give all roads of a layout so many lanes, and the main ones the rank below a boulevard's."""
    roads = city.layout.roads
    rows = np.flatnonzero(roads["kind"].isin(DRIVABLE).to_numpy())
    tags = roads["tags"].to_numpy()[rows].tolist()
    changed = [_changed(json.loads(text or "{}"), lanes) for text in tags]
    return with_tags(city, rows, changed, make_room=False)


LOWER = {"motorway": "secondary", "trunk": "secondary", "primary": "secondary"}


def _changed(tags: Tags, lanes: int) -> Tags:
    """Return the tags of a road that has so many lanes, in both directions."""
    gone = ("oneway", "lanes:forward", "lanes:backward", "width", "width:carriageway", "turn:lanes")
    kept = {key: value for key, value in tags.items() if key not in gone}
    highway = tags.get("highway", "residential")
    return {**kept, "highway": LOWER.get(highway, highway), "lanes": str(lanes)}
