"""Fidelity: what a map states, read a second time, held against the finished city.

Each stated fact is kept, departed from, lost with its object, or unreadable. Files are read by
`cityx.checks.map_features` and tags understood by `cityx.checks.tag_measures`, both apart from the
importer.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import chain
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.checks.map_features import Feature, features
from cityx.checks.mapped_things import Finished
from cityx.checks.tag_measures import (
    DEPARTED,
    KEPT,
    LOST,
    OF_BARRIERS,
    OF_BUILDINGS,
    OF_PARTS,
    OF_ROADS,
    UNREADABLE,
    VERDICTS,
    Found,
    bicycles_against,
    crossing,
    height_of_rest,
    kerb,
)
from cityx.city import City
from cityx.geometry.arrays import FloatArray

# Nodes that something stands for in the scene: tag -> how the names of its prototypes begin, and
# how far off it may stand, metres; signals and stops stand beside the way that the node is of.
_STANDING: Mapping[tuple[str, str], tuple[tuple[str, ...], float]] = MappingProxyType(
    {
        ("natural", "tree"): ((), 5.0), ("amenity", "bench"): (("bench",), 5.0),
        ("amenity", "waste_basket"): (("waste_basket",), 5.0),
        ("amenity", "post_box"): (("post_box",), 5.0),
        ("amenity", "bicycle_parking"): (("bicycle_parking",), 5.0),
        ("highway", "street_lamp"): (("street_lamp", "lamp"), 5.0),
        ("highway", "traffic_signals"): (("traffic_signal",), 30.0),
        ("highway", "bus_stop"): (("bus_stop", "bus_pole"), 12.0),
        ("emergency", "fire_hydrant"): (("fire_hydrant",), 5.0),
        ("barrier", "bollard"): (("bollard",), 5.0),
    }
)  # fmt: skip
TOUCHING = 0.3  # metres, more than a digit of the map's degrees
LEAST_FREE = 3.0  # metres between the surfaces of streets that cross on two levels
UNEXPLAINED = "unexplained"  # of the lost
DOOR_NEAR, NO_DOOR_NEAR = 2.5, 0.5  # metres from an entrance within which a door stands for it
FURNISHED = 2  # least level of detail that has what stands in streets
# Lines and areas that must be in the city: key -> values, () for all.
_GROUND: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "natural": ("water", "wood", "beach", "scrub", "grassland"),
        "waterway": ("river", "stream", "canal", "ditch", "drain"),
        "railway": ("rail", "tram", "light_rail", "narrow_gauge"),
        "barrier": ("wall", "fence", "hedge", "city_wall", "retaining_wall"),
        "power": ("line", "minor_line"),
        "leisure": ("park", "garden", "pitch", "playground"),
        "landuse": ("grass", "forest", "meadow", "cemetery", "reservoir"),
    }
)  # fmt: skip
_DRIVEN = ("motorway", "trunk", "primary", "secondary", "tertiary", "unclassified", "residential",
           "living_street", "service", "motorway_link", "trunk_link", "primary_link",
           "secondary_link", "tertiary_link", "road")  # fmt: skip


_STREETS = frozenset((*_DRIVEN, "footway", "path", "cycleway", "pedestrian", "track", "steps"))


@dataclass(frozen=True)
class Fact:
    """Something that a map states of an object.

    Attributes
    ----------
    tag
        "height", "highway=residential"...
    name
        "way/12".
    stated, found
        Of the map and of the city, as text.
    verdict
        One of `VERDICTS`.
    why
        What the report says of the object, of one that is lost or departed from.
    """

    tag: str
    name: str
    stated: str
    found: str
    verdict: str
    why: str = ""


def facts(city: City, path: Path) -> Iterator[Fact]:
    """Yield what a map states of all that lies inside a city, each with what became of it."""
    known = features(path)
    shapes = _in_frame(city, [one.shape for one in known])
    parts = [one.tags.get("building:part", "no") != "no" for one in known]
    finished = Finished(city, shapes[np.array(parts, bool)])
    site = shapely.box(*city.layout.extent)
    inside = shapely.intersects(shapes, site) & ~shapely.is_empty(shapes)
    divided = _divided(known, shapes)
    triples = zip(known, shapes, inside, strict=True)
    placed = [replace(one, shape=shape) for one, shape, near in triples if near]
    ways = _Ways([one for one in placed if _is_driven(one)])
    for one in placed:
        told = [_facts_of(finished, one, site, divided=one.name in divided)]
        if one.shape.geom_type == "Point":
            told.append(_facts_at(finished, one, ways))
        elif _is_driven(one):
            told.append(_facts_of_levels(finished, one, ways))
        for fact in chain.from_iterable(told):
            yield _with_reason(finished, fact)


def _is_driven(one: Feature) -> bool:
    line = one.shape.geom_type == "LineString" and one.shape.length > 0
    return line and one.tags.get("highway") in _DRIVEN


class _Ways:
    """Streets of the map, found by place; a class for what is prepared."""

    def __init__(self, ways: list[Feature]) -> None:
        self.ways = ways
        self.tree = shapely.STRtree([one.shape for one in ways])

    def at(self, place: shapely.Geometry) -> list[Feature]:
        """Return the streets that lead through a place."""
        return [self.ways[row] for row in self.tree.query(place, "dwithin", TOUCHING).tolist()]

    def crossed_by(self, one: Feature) -> Iterator[tuple[Feature, shapely.Geometry]]:
        """Yield the streets that another one crosses on another level, and where."""
        for row in self.tree.query(one.shape, "crosses").tolist():
            other = self.ways[row]
            met = shapely.get_parts(shapely.intersection(one.shape, other.shape))
            if len(met) == 1 and met[0].geom_type == "Point" and _level(one) != _level(other):
                corners = shapely.multipoints(shapely.get_coordinates(other.shape))
                if shapely.distance(corners, met[0]) > TOUCHING:
                    yield other, met[0]


def _level(one: Feature) -> float:
    """Return the layer of a way: as stated, else above others as a bridge, below as a tunnel."""
    try:
        return float(one.tags["layer"])
    except (KeyError, ValueError):
        bridge, tunnel = (one.tags.get(key, "no") != "no" for key in ("bridge", "tunnel"))
        return float(bridge) - float(tunnel)


def _facts_of_levels(city: Finished, one: Feature, ways: _Ways) -> Iterator[Fact]:
    """Yield whether a street is above others that it crosses on a lower level."""
    for other, place in ways.crossed_by(one):
        if _level(one) > _level(other):
            stated = f"above {other.name}"
            upper, lower = (city.height_of_way(way.name, way.shape, place) for way in (one, other))
            free = upper - lower
            if np.isnan(free):
                yield Fact("level", one.name, stated, "not built there", KEPT)
            else:
                verdict = KEPT if free >= LEAST_FREE else DEPARTED
                yield Fact("level", one.name, stated, f"{free:.1f} m", verdict)


def _facts_at(city: Finished, one: Feature, ways: _Ways) -> Iterator[Fact]:
    """Yield what became of crossings and kerbs, which are points of streets; detail 0 has none."""
    tags = one.tags
    if city.city.lod == 0:
        return
    value = tags.get("crossing", "yes" if tags.get("highway") == "crossing" else "")
    streets = ways.at(one.shape) if value else []
    if streets and city.city.ground is not None and all(_level(way) == 0 for way in streets):
        word = "no" if value == "no" else "yes"
        yield Fact("crossing", one.name, value, *crossing(city, one.shape, word)[::-1])
    for key in ("kerb", "kerb:height"):
        if key in tags and city.city.ground is not None and not streets:
            yield _fact(key, one, kerb(city, one.shape, tags[key]))


def _in_frame(city: City, shapes: list[shapely.Geometry]) -> NDArray[Any]:
    """Return shapes in degrees in the metres of a city, by its projection."""
    import pyproj

    to_metres = pyproj.Transformer.from_crs("EPSG:4326", city.frame.projection, always_xy=True)

    def moved(places: FloatArray) -> FloatArray:
        return np.column_stack(to_metres.transform(places[:, 0], places[:, 1]))

    return np.asarray(shapely.transform(np.array(shapes, object), moved))


def _covered(city: Finished, one: Feature) -> bool:
    """Return whether parts of the map leave nothing of an outline to which it says a height."""
    return bool(city.left_of(one.shape) < 0.05 * one.shape.area)


def _divided(known: list[Feature], shapes: NDArray[Any]) -> frozenset[str]:
    """Return the names of the buildings in which the map has parts."""
    parts = [k for k, one in enumerate(known) if one.tags.get("building:part", "no") != "no"]
    wholes = [k for k, one in enumerate(known) if one.tags.get("building", "no") != "no"]
    if not parts or not wholes:
        return frozenset()
    tree = shapely.STRtree(shapely.point_on_surface(shapes[parts]))
    whole, _ = tree.query(shapes[wholes], predicate="intersects")
    return frozenset(known[wholes[k]].name for k in np.unique(whole).tolist())


def _facts_of(
    city: Finished, one: Feature, site: shapely.Geometry, *, divided: bool
) -> Iterator[Fact]:
    tags, shape = one.tags, one.shape
    area = shape.geom_type.endswith("Polygon")
    whole = shapely.within(shapely.point_on_surface(shape), site)
    if area and tags.get("building", "no") != "no" and whole:
        own = replace(one, name=city.known_as(one.name, shape))
        stands = own.name in city.buildings
        found = "" if own.name == one.name else own.name
        yield Fact("building", one.name, tags["building"], found, KEPT if stands else LOST)
        if divided and "height" in tags and stands and not _covered(city, one):
            yield _fact("height", one, height_of_rest(city, own, tags["height"]))
        for tag, measure in OF_BUILDINGS.items():
            if tag in tags and not (divided and tag in OF_PARTS):
                lost = not stands or not len(city.parts_of(own.name))
                yield _fact(tag, one, (LOST, "") if lost else measure(city, own, tags[tag]))
    elif not area and tags.get("highway") in _DRIVEN and shape.length > 0:
        inside = tags.get("tunnel", "no") not in ("no", "building_passage")
        built = one.name in city.roads and (city.is_driven(one.name) or not inside)
        yield Fact("highway", one.name, tags["highway"], "", KEPT if built else LOST)
        for tag, measure in OF_ROADS.items():
            if tag in tags:
                yield _fact(tag, one, measure(city, one, tags[tag]) if built else (LOST, ""))
        against = _against(tags)
        if against:
            yield _fact(against, one, bicycles_against(city, one) if built else (LOST, ""))
    yield from _things_of(city, one)


def _against(tags: Mapping[str, str]) -> str:
    """Return the key that lets bicycles go against a one-way street, "" for none."""
    if tags.get("oneway") not in ("yes", "-1", "true", "1"):
        return ""
    if tags.get("oneway:bicycle") == "no":
        return "oneway:bicycle"
    sides = ("cycleway", "cycleway:left", "cycleway:right", "cycleway:both")
    return next((key for key in sides if tags.get(key, "").startswith("opposite")), "")


def _things_of(city: Finished, one: Feature) -> Iterator[Fact]:
    """Yield whether what a feature is stands in the scene, or lies on the ground."""
    shape = one.shape
    if shape.geom_type == "Point":
        for (key, value), (begins, far) in _STANDING.items():
            if one.tags.get(key) == value and city.city.lod >= FURNISHED:
                near = city.is_near(begins, shape, far)
                off = np.nan if near else city.moved(one.name, shape)
                verdict = KEPT if near else LOST if np.isnan(off) else DEPARTED
                found = f"{off:.1f} m off" if verdict == DEPARTED else ""
                yield Fact(f"{key}={value}", one.name, value, found, verdict)
        if city.city.lod >= FURNISHED and city.is_at_house(shape):
            yield from _entrance_of(city, one)
        return
    for key, values in _GROUND.items():
        if one.tags.get(key) in values and not _below_ground(one.tags):
            there = bool(city.kinds.get(one.name, frozenset()) - _STREETS)
            built = there and "building" not in city.kinds[one.name]
            if key == "barrier" and built and city.city.lod >= FURNISHED:
                there = len(city.barrier(one.name)) > 0
                for tag, measure in OF_BARRIERS.items() if there else ():
                    if tag in one.tags:
                        yield Fact(f"barrier:{tag}", one.name, one.tags[tag],
                                   *measure(city, one, one.tags[tag])[::-1])  # fmt: skip
            there = there or city.covers(key, one.tags[key], shape)
            yield Fact(f"{key}={one.tags[key]}", one.name, one.tags[key], "",
                       KEPT if there else LOST)  # fmt: skip


def _entrance_of(city: Finished, one: Feature) -> Iterator[Fact]:
    """Yield whether a door is where the map draws one at a house, and none where it has none."""
    for key in ("entrance", "door"):
        value = one.tags.get(key)
        if value is None or (key == "door" and "entrance" in one.tags):
            continue
        none = value in ("no", "none", "disused") or one.tags.get("door") in ("no", "none")
        there = city.is_near(("door",), one.shape, NO_DOOR_NEAR if none else DOOR_NEAR)
        verdict = KEPT if there != none else DEPARTED if none else LOST
        yield Fact(key, one.name, value, "door" if there else "", verdict)


def _below_ground(tags: Mapping[str, str]) -> bool:
    """Return whether a line or an area lies below the ground, where nobody sees it."""
    return (
        tags.get("tunnel") in ("culvert", "yes", "flooded", "building_passage")
        or tags.get("location") in ("underground", "underwater")
        or (tags.get("layer", "").startswith("-") and tags.get("bridge", "no") == "no")
    )


def _fact(tag: str, one: Feature, found: Found) -> Fact:
    return Fact(tag, one.name, one.tags[tag], found[1], found[0])


def _with_reason(city: Finished, fact: Fact) -> Fact:
    """Add to the fact of a lost or changed object what notes and failures say of it.

    A tag of which nothing is found is lost with its object where they name that.
    """
    if fact.verdict not in (LOST, DEPARTED):
        return fact
    why = city.noted.get(fact.name) or city.failed(fact.name)
    lost = why and not fact.found
    return replace(fact, verdict=LOST if lost else fact.verdict, why=why)


def fidelity(city: City, path: Path) -> dict[str, Any]:
    """Return per tag how much of what a map states is kept, with names of what is not.

    Parameters
    ----------
    city
        The finished city.
    path
        The OSM file that it was built from.

    Returns
    -------
    table
        ``share`` of the readable facts that are kept, and ``tags``: of each how many are stated,
        kept, departed, lost and unreadable, how many of the lost the report gives no reason for,
        and those that are not kept: name, verdict, what was stated, what was found, the reason.
    """
    rows: dict[str, dict[str, Any]] = {}
    import osmium

    try:
        told = list(facts(city, path))
    except (RuntimeError, ValueError, osmium.InvalidLocationError) as fault:
        # osmium is stricter than the importer, of positions and of lengths of tags.
        return {"share": None, "stated": 0, "tags": {}, "error": str(fault)}
    for fact in told:
        row = rows.setdefault(
            fact.tag, {"stated": 0, **dict.fromkeys((*VERDICTS, UNEXPLAINED), 0), "which": []}
        )
        row["stated"] += 1
        row[fact.verdict] += 1
        row[UNEXPLAINED] += fact.verdict == LOST and not fact.why
        if fact.verdict != KEPT:
            row["which"].append([fact.name, fact.verdict, fact.stated, fact.found, fact.why])
    readable = sum(row["stated"] - row[UNREADABLE] for row in rows.values())
    kept = sum(row[KEPT] for row in rows.values())
    share = round(kept / readable, 6) if readable else 1.0
    return {"share": share, "stated": readable, "tags": dict(sorted(rows.items()))}
