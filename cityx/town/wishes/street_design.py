"""How streets are made: lanes, speed, surface, walks, cycle lanes, and whether they are one-way."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Annotated

import numpy as np
import shapely

from cityx.checks.predicates.words import LOCAL, MAIN
from cityx.city import City, Layout
from cityx.city.asked_goals import asked
from cityx.errors import ActionFailed
from cityx.geometry.arrays import IntArray
from cityx.ids import uniform
from cityx.protocol import Choice, Port, Range, action
from cityx.sources.features.tagged import Tags
from cityx.town.cutting import with_tags

FAST = ("motorway", "motorway_link", "trunk", "trunk_link")  # which stay as they are
KINDS = {"all": (*MAIN, *LOCAL), "main": MAIN, "other": LOCAL}
# Word of surface=* -> what predicates call it.
SURFACES = {
    "asphalt": "asphalt", "cobblestone": "cobbles", "sett": "cobbles", "paving_stones": "pavers",
    "gravel": "gravel", "ground": "soil", "concrete": "concrete",
}  # fmt: skip
PAINTED = ("asphalt", "concrete")
CYCLING = ("as_is", "none", "lane", "track")
NO_CYCLING = ("cycleway", "cycleway:left", "cycleway:right", "cycleway:both")
MOST_OF = 0.9  # share of the streets that are all of them, as their lengths are measured
OVER = 0.01  # by which a share may be exceeded; where streets are whole less is had
AROUND = 0.08  # by which a share of the streets may be missed; a street is made whole
PARKED = {"parking:left": "lane", "parking:right": "lane"}
NEAR_END = 1.0  # metres


@action(
    "layout/street_design-v1",
    limits=["Blocks of towns without a map give way to wider streets; elsewhere there is no room.",
            "One-way streets keep their lanes and lead to and fro in turn."],
    requires=("layout",),
    after=("layout/motorway-v1",),
    takes=(Port("layout", "scene_layout"),),
    gives=(Port("layout", "scene_layout"),),
    labels=("lanes", "speed limit", "surface", "cobblestone", "one-way", "sidewalk", "pavement",
            "cycle lane", "bike lane"),
)  # fmt: skip
def street_design(
    city: City,
    *,
    kind: Annotated[str, Choice(*KINDS)] = "all",
    share: Annotated[float, Range(0.0, 1.0)] = 1.0,
    lanes: Annotated[int, Range(0, 8)] = 0,
    speed_kmh: Annotated[float, Range(0.0, 130.0)] = 0.0,
    surface: Annotated[str, Choice("as_is", *SURFACES)] = "as_is",
    oneway: bool = False,
    walk: Annotated[float, Range(0.0, 8.0)] = 0.0,
    cycling: Annotated[str, Choice(*CYCLING)] = "as_is",
) -> City:
    """Give streets lanes, a speed limit, a surface, walks or cycle lanes, or make them one-way.

    Parameters
    ----------
    city
        City with streets.
    kind
        Which streets: all, main ones or the others. Where there is no main one, the longest is.
    share
        Of their length; whole streets are changed.
    lanes
        Of both directions together, 0 to leave them.
    speed_kmh
        Speed limit, km/h, 0 to leave it.
    surface
        What the carriageway is paved with.
    oneway
        Whether they lead one way.
    walk
        Metres of each walk, 0 to leave them.
    cycling
        Lanes for cycles on both sides, or tracks that parked cars protect.
    """
    if kind == "main":
        city = with_main_street(city)
    rows = _chosen(city, kind, share, blind=not oneway)
    if not len(rows):
        raise ActionFailed(f"There is no street of the kind {kind!r} that could be changed.")
    roads = city.layout.roads
    tags = [json.loads(text or "{}") for text in roads["tags"].to_numpy()[rows].tolist()]
    turned = _turned(city.layout, rows) if oneway else np.zeros(len(rows), bool)
    change = _change(lanes, speed_kmh, surface, walk, cycling)
    gone = _gone(lanes, walk, cycling)
    new: list[Tags] = []
    for own, back in zip(tags, turned.tolist(), strict=True):
        kept = {key: value for key, value in own.items() if key not in gone}
        kept.setdefault("highway", "residential")
        new.append({**kept, **change, **({"oneway": "-1" if back else "yes"} if oneway else {})})
    city = with_tags(city, rows, new)
    if oneway:
        city = _reversed(city, rows[turned])
    return _with_goals(city, kind, share, surface, cycling, oneway=oneway, walk=walk)


def _change(lanes: int, speed_kmh: float, surface: str, walk: float, cycling: str) -> Tags:
    """Return the tags that are new."""
    found: Tags = {}
    if lanes:
        found["lanes"] = str(lanes)
    if speed_kmh:
        found["maxspeed"] = f"{speed_kmh:g}"
    if surface != "as_is":
        found["surface"] = surface
        if surface not in PAINTED:
            found["cityx:crossings"] = "lowered"  # no bars tell where people cross
    if walk:
        found |= {"sidewalk": "both", "sidewalk:both:width": f"{walk:g}"}
    if cycling in ("lane", "track"):
        found["cycleway:both"] = cycling
    if cycling == "track":
        found |= PARKED
    return found


def _gone(lanes: int, walk: float, cycling: str) -> tuple[str, ...]:
    """Return the tags that no longer hold."""
    sized = ("width", "width:carriageway")
    gone: tuple[str, ...] = ()
    if lanes:
        gone += ("lanes:forward", "lanes:backward", "turn:lanes", *sized)
    if walk:
        sides = ("left", "right", "both")
        gone += tuple(f"sidewalk:{side}{end}" for side in sides for end in ("", ":width"))
    if cycling != "as_is":
        gone += (*NO_CYCLING, *sized)
    return gone


def with_main_street(city: City) -> City:
    """Make the longest street a main one where there is none."""
    roads = city.layout.roads
    if roads["kind"].isin(MAIN).any():
        return city
    local = np.flatnonzero(roads["kind"].isin(LOCAL).to_numpy())
    if not len(local):
        return city
    length = _lengths(city.layout, local)
    names = roads["name"].to_numpy()[local]
    longest = local[names == names[int(np.argmax(length))]]
    tags = roads["tags"].to_numpy()[longest].tolist()
    return with_tags(
        city, longest, [{**json.loads(text or "{}"), "highway": "secondary"} for text in tags]
    )


def _lengths(layout: Layout, rows: IntArray) -> IntArray:
    """Return the length of the street that each row is part of, whole metres."""
    roads = layout.roads
    own = shapely.length(roads.geometry.to_numpy()[rows])
    _, of = np.unique(roads["name"].to_numpy()[rows].astype(str), return_inverse=True)
    return np.asarray(np.rint(np.bincount(of, own)[of]).astype(np.int64))


def _chosen(city: City, kind: str, share: float, *, blind: bool) -> IntArray:
    """Return rows of whole streets of a kind that make a share of their length."""
    roads = city.layout.roads
    own = roads["kind"].isin(KINDS[kind]).to_numpy()
    rows = np.flatnonzero(own & ~roads["kind"].isin(FAST).to_numpy())
    rows = rows[~roads["roundabout"].to_numpy(bool)[rows]]
    have = 0.0
    if not blind:
        oneway = roads["oneway"].to_numpy(bool)
        have = float(shapely.length(roads.geometry.to_numpy()[own & oneway]).sum())
        rows = rows[~_ends_blindly(city.layout)[rows] & ~oneway[rows]]
    if share >= 1.0 or not len(rows):
        return np.asarray(rows, np.int64)
    length = shapely.length(roads.geometry.to_numpy()[rows])
    names, of = np.unique(roads["name"].to_numpy()[rows].astype(str), return_inverse=True)
    whole = np.bincount(of, length)
    first = np.array([roads["id"].to_numpy()[rows[of == k]].min() for k in range(len(names))])
    every = shapely.length(roads.geometry.to_numpy()[own]).sum()
    left, taken = share * every - have, np.zeros(len(names), bool)
    drawn = uniform(city.seed, "street_design", first)
    for k in np.lexsort((drawn, -np.round(whole, 1))).tolist():
        if whole[k] <= left + OVER * every:
            taken[k] = True
            left -= whole[k]
    return np.asarray(rows[taken[of]], np.int64)


def _ends_blindly(layout: Layout) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    """(n,) whether a street ends within the site where no other goes on."""
    roads = layout.roads.geometry.to_numpy()
    points, of = shapely.get_coordinates(roads, return_index=True)
    _, place, count = np.unique(
        np.rint(points * 1000).astype(np.int64), axis=0, return_inverse=True, return_counts=True
    )
    tip = np.append(True, np.diff(of) > 0) | np.append(np.diff(of) > 0, True)
    border = shapely.box(*layout.extent).exterior
    inner = shapely.distance(shapely.points(points), border) > NEAR_END
    found = np.zeros(len(roads), bool)
    found[of[tip & inner & (count[place.ravel()] == 1)]] = True
    return found


def _turned(layout: Layout, rows: IntArray) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    """(k,) whether a one-way street leads against its line, so that neighbours lead to and fro."""
    roads = layout.roads.iloc[rows]
    lines = roads.geometry.to_numpy()
    ends = shapely.get_coordinates(shapely.get_point(lines, [[0], [-1]])).reshape(2, -1, 2)
    way = ends[1] - ends[0]
    tall = np.abs(way[:, 1]) > np.abs(way[:, 0])
    names = roads["name"].to_numpy().astype(str)
    back = np.zeros(len(rows), bool)
    for upright in (True, False):
        own = np.flatnonzero(tall == upright)
        across = ends.mean(axis=0)[own, 0 if upright else 1]
        order = list(dict.fromkeys(names[own[np.argsort(np.round(across, 1), kind="stable")]]))
        sign = np.array([order.index(name) % 2 for name in names[own]], bool)
        ahead = way[own, 1 if upright else 0] > 0
        back[own] = ahead == sign
    return back


def _reversed(city: City, rows: IntArray) -> City:
    """Turn the lines of streets that lead against them; their tags say "yes" then."""
    roads = city.layout.roads.copy()
    lines = roads.geometry.to_numpy().copy()
    lines[rows] = shapely.reverse(lines[rows])
    tags = roads["tags"].to_numpy(object).copy()
    for row in rows.tolist():
        tags[row] = json.dumps({**json.loads(tags[row]), "oneway": "yes"})
    roads["tags"] = tags.astype(str)
    return replace(city, layout=replace(city.layout, roads=roads.set_geometry(lines)))


def _with_goals(
    city: City, kind: str, share: float, surface: str, cycling: str, *, oneway: bool, walk: float
) -> City:
    """Ask of the finished city what was made."""
    which = {"all": "road", "main": "road, class=main", "other": "road, class=local"}[kind]
    least = MOST_OF if share >= 1.0 else share - AROUND
    most = None if share >= 1.0 else share + AROUND
    if surface != "as_is":
        of = f"share({which}, surface={SURFACES[surface]})"
        city = asked(city, f"streets of {surface}", of, least=least, most=most)
    if oneway:
        city = asked(
            city, "one-way streets", f"share({which}, oneway=true)", least=least, most=most
        )
    if cycling in ("lane", "track"):
        has = {"lane": "cycling=both", "track": "protected=true"}[cycling]
        city = asked(city, "lanes for cycles", f"share({which}, {has})", least=least, most=most)
    if walk and share >= 1.0:
        city = asked(city, f"walks of {walk:g} m", f"stat({which}, walk, p50)", least=0.95 * walk)
    return city
