"""A motorway across a city, over its streets, with ramps to one of them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city import City, Layout
from cityx.city.asked_goals import asked
from cityx.city.layout import joined_tables
from cityx.errors import ActionFailed
from cityx.geometry.arrays import FloatArray
from cityx.places.profiles import keeps_left
from cityx.protocol import Choice, Port, Range, action
from cityx.road.network.network import DRIVABLE
from cityx.sources.features.tagged import Owner, Tags
from cityx.town.cutting import street_rows, with_points
from cityx.town.procedural_streets import name_of
from cityx.town.rebuilding import WET, cleared, with_area

AXES = ("north_south", "east_west")
LANE, SHOULDER = 3.5, 2.0  # metres
BETWEEN = 2.0  # metres between the carriageways
ASIDE = 10.0  # metres from the middle of a carriageway's outer edge to that of a ramp
VERGE = 4.0  # metres of cleared ground beside the outermost roadway
BAND = (0.25, 0.75)  # of the site's size, within which the motorway may run
STEP = 10.0  # metres between the places that are tried
ALONG = 40.0  # square metres of houses that a metre of street under the motorway weighs
RAMP = (130.0, 190.0)  # metres of a ramp; 6 m at the grade of a link, rounded at both ends
LEAD = 35.0  # metres over which a ramp swings out
CLEAR = 14.0  # metres from a ramp to the next street across
SQUARE = 0.4  # cosine of the least angle between the motorway and a street with ramps
RANKS = ("primary", "secondary", "tertiary", "unclassified", "residential")


@action(
    "layout/motorway-v1",
    limits=[
        "Houses in its way are taken down; streets pass under it as they are.",
        "It has ramps only where a street across it has room for them.",
    ],
    requires=("layout",),
    after=("layout/river-v1",),
    takes=(Port("layout", "scene_layout"),),
    gives=(Port("layout", "scene_layout"),),
    labels=("motorway", "highway", "freeway", "viaduct", "elevated", "expressway"),
)
def motorway(
    city: City,
    *,
    lanes: Annotated[int, Range(2, 8)] = 4,
    axis: Annotated[str, Choice(*AXES)] = "north_south",
    ramps: bool = True,
) -> City:
    """Build a motorway on a viaduct across a city, from border to border.

    Parameters
    ----------
    city
        City with streets.
    lanes
        Of both directions together; an odd number is rounded up.
    axis
        Where it leads.
    ramps
        Whether ramps join it to a street that it crosses.
    """
    course = _course(city, axis, (lanes + 1) // 2)
    layout = city.layout
    joined = _joined(course, layout) if ramps else None
    ground = course.ground(joined is not None)
    wet = layout.areas.geometry.to_numpy()[layout.areas["kind"].isin(WET).to_numpy()]
    dry = shapely.difference(ground, shapely.union_all(wet))
    layout = cleared(layout, dry)
    for k, part in enumerate(shapely.get_parts(dry)):
        layout = with_area(layout, "grass", part, Owner(("made", "motorway", axis, "land", k), {}))
    lines, owners = _roads(city, course, joined)
    if joined is not None:
        layout = _with_ends(layout, joined, course)
    new = street_rows(city, lines, owners)
    city = replace(city, layout=replace(layout, roads=joined_tables(layout.roads, new)))
    if ramps and joined is None:
        note = "motorway: no street that it crosses has room for ramps, so it has none"
        city = replace(city, notes=(*city.notes, note))
    way = "y" if axis == "north_south" else "x"
    words = f"a motorway from {axis.replace('_', ' to ')}"
    return asked(city, words, f"spans(road, class=motorway, dir={way})", least=0.95)


@dataclass(frozen=True)
class _Course:
    """Where a motorway runs.

    Attributes
    ----------
    along
        0 where it leads east, 1 where it leads north.
    at
        Metres of its middle across.
    low, high
        Metres along it of the borders of the site.
    lanes
        Of each carriageway.
    layer
        Level of its deck.
    left
        Whether traffic keeps to the left.
    """

    along: int
    at: float
    low: float
    high: float
    lanes: int
    layer: int
    left: bool

    @property
    def wide(self) -> float:
        """Metres of one carriageway."""
        return self.lanes * LANE + SHOULDER

    @property
    def aside(self) -> float:
        """Metres from the middle to the middle of a carriageway."""
        return (BETWEEN + self.wide) / 2

    @property
    def ramp_aside(self) -> float:
        """Metres from the middle to the middle of a ramp at the street."""
        return self.aside + self.wide / 2 + ASIDE

    def points(self, along: Any, aside: Any) -> FloatArray:
        """Return places: metres along and to the right of the way east or north, (k, 2)."""
        along, aside = np.broadcast_arrays(np.asarray(along, float), np.asarray(aside, float))
        across = self.at + (aside if self.along else -aside)
        pair = (across, along) if self.along else (along, across)
        return np.asarray(np.round(np.stack(pair, axis=-1), 3))

    def ground(self, ramps: bool) -> Any:
        """Return the ground it takes."""
        half = (self.ramp_aside if ramps else self.aside + self.wide / 2) + VERGE
        corner = self.points([self.low, self.high, self.high, self.low], [-half, -half, half, half])
        return shapely.Polygon(corner)


def _course(city: City, axis: str, lanes: int) -> _Course:
    """Choose the course that takes least houses and has least street under it."""
    layout = city.layout
    along = 1 if axis == "north_south" else 0
    low, high = layout.extent[along], layout.extent[along + 2]
    first, last = layout.extent[1 - along], layout.extent[3 - along]
    roads = layout.roads[layout.roads["kind"].isin(DRIVABLE)].geometry.to_numpy()
    houses = layout.buildings.geometry.to_numpy()
    tree, streets = shapely.STRtree(houses), shapely.STRtree(roads)
    layer = 1 + max(int(layout.roads["layer"].max()) if len(layout.roads) else 0, 0)
    best, cost = None, np.inf
    for at in np.arange(first + BAND[0] * (last - first), first + BAND[1] * (last - first), STEP):
        course = _Course(along, float(at), low, high, lanes, layer, keeps_left(city.frame))
        ground = course.ground(True)
        area = shapely.area(houses[tree.query(ground, predicate="intersects")]).sum()
        under = shapely.intersection(roads[streets.query(ground, predicate="intersects")], ground)
        box = shapely.bounds(under).reshape(-1, 4)
        own = np.nan_to_num(box[:, 2 + along] - box[:, along]).sum()
        if area + ALONG * own < cost:
            best, cost = course, float(area + ALONG * own)
    if best is None:
        raise ActionFailed("The site is too narrow for a motorway. Ask for a larger one.")
    return best


@dataclass(frozen=True)
class _Joined:
    """The street that ramps lead to.

    Attributes
    ----------
    row
        Of the table of roads.
    at
        (2,) metres along the motorway where it meets the ramps on the left and on the right.
    length
        Metres of the ramps.
    """

    row: int
    at: FloatArray
    length: float


def _joined(course: _Course, layout: Layout) -> _Joined | None:
    """Choose the street of highest rank that has room for ramps on both sides."""
    roads = layout.roads
    sides = [
        shapely.LineString(course.points([course.low, course.high], [side * course.ramp_aside] * 2))
        for side in (-1.0, 1.0)
    ]
    places = [_crossings(roads.geometry.to_numpy(), side, course) for side in sides]
    found: list[tuple[int, float, _Joined]] = []
    for row in sorted(set(places[0]) & set(places[1])):
        kind, plain = roads["kind"].iloc[row], not roads[["bridge", "tunnel"]].iloc[row].any()
        at = np.array([places[k][row] for k in (0, 1)])
        slant = abs(at[1] - at[0]) / (2 * course.ramp_aside)
        if kind not in RANKS or not plain or slant > SQUARE:
            continue
        others = [value for side in places for other, value in side.items() if other != row]
        room = [abs(value - own) for value in [*others, course.low, course.high] for own in at]
        length = min(RAMP[1], min(room) - CLEAR)
        if length >= RAMP[0]:
            found.append((RANKS.index(kind), -length, _Joined(row, at, length)))
    return min(found, key=lambda one: one[:2])[2] if found else None


def _crossings(shapes: NDArray[Any], side: Any, course: _Course) -> dict[int, float]:
    """Return the roads that cross a line alongside once, and metres along it where."""
    met = shapely.intersection(shapes, side)
    rows = np.flatnonzero(shapely.get_type_id(met) == 0)
    rows = rows[~shapely.is_empty(met[rows])]
    points = shapely.get_coordinates(met[rows])
    return dict(zip(rows.tolist(), points[:, course.along].tolist(), strict=True))


def _roads(city: City, course: _Course, joined: _Joined | None) -> tuple[list[Any], list[Owner]]:
    """Return carriageways and ramps in the direction of traffic."""
    name = name_of(city.seed, ("Motorway",), 5)
    axis = AXES[1 - course.along]
    deck = _tags("motorway", course.lanes, 90, name)
    deck = {**deck, "bridge": "yes", "layer": str(course.layer)}
    lines, owners = [], []
    for k, side in enumerate((-1.0, 1.0)):
        ahead = 1.0 if (side > 0) != course.left else -1.0
        ends = [course.low, course.high][:: int(ahead)]
        line = shapely.LineString(course.points(ends, side * course.aside))
        if joined is not None:
            own = float(joined.at[k])
            for part, turn in (("off", -ahead), ("on", ahead)):
                reach = own + turn * np.array([joined.length, joined.length - LEAD, 0.0])
                aside = side * np.array([course.aside, course.ramp_aside, course.ramp_aside])
                ramp = course.points(reach, aside)
                line = with_points(line, ramp[:1])
                lines.append(shapely.LineString(ramp if part == "off" else ramp[::-1]))
                tags = _tags("motorway_link", 1, 50, f"{name} ramp")
                owners.append(Owner(("made", "motorway", axis, part, k), tags))
        lines.append(line)
        owners.append(Owner(("made", "motorway", axis, k), deck))
    return lines, owners


def _tags(highway: str, lanes: int, speed: int, name: str) -> Tags:
    return {
        "highway": highway, "lanes": str(lanes), "oneway": "yes", "maxspeed": str(speed),
        "width:carriageway": f"{lanes * LANE + SHOULDER:g}", "sidewalk": "no", "parking:both": "no",
        "surface": "asphalt", "lit": "yes", "name": name,
    }  # fmt: skip


def _with_ends(layout: Layout, joined: _Joined, course: _Course) -> Layout:
    """Give the street that ramps lead to a point where they end."""
    roads = layout.roads.copy()
    places = course.points(joined.at, course.ramp_aside * np.array([-1.0, 1.0]))
    shapes = roads.geometry.to_numpy().copy()
    shapes[joined.row] = with_points(shapes[joined.row], places)
    return replace(layout, roads=roads.set_geometry(shapes))
