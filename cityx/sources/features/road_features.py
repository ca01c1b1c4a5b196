"""Roads: the lines that carry movement, with their cross-sections."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from math import nan
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.layout import make_table
from cityx.city.section import PARKING, Band, carriageway_width, section_text
from cityx.geometry.arrays import FloatArray
from cityx.places.profile import Streets
from cityx.sources.features import measures
from cityx.sources.features.clipping import Box
from cityx.sources.features.density import Density
from cityx.sources.features.kinds import rail_tags, road_kind, road_tags
from cityx.sources.features.lane_sections import bands_of_tags, contraflow
from cityx.sources.features.tagged import Owner, Report, Tagged, Tags, joined
from cityx.sources.features.vocabulary import CARS, RAIL_WORDS, ROAD_TABLE, SURFACE_WORDS

if TYPE_CHECKING:
    from geopandas import GeoDataFrame


MAX_LANES = 12
MAX_WIDTH = 60.0  # metres of carriageway
TOWN = 0.10  # coverage from which streets have sidewalks
DENSE = 0.16  # coverage from which cars park along residential streets
SIDEWALK = 1.8  # metres, where a tag asks for one on a road whose class has none
CIRCLE = 120.0  # metres round the largest ring that is a roundabout though no tag says so
MIN_LANE = 2.0  # metres; a narrower carriageway has fewer lanes than its class
_PARKED = frozenset({
    "yes", "lane", "street_side", "on_kerb", "half_on_kerb", "shoulder", "parallel", "diagonal",
    "perpendicular", "marked", "on_street", "painted_area_only",
})  # fmt: skip
_LEFT, _RIGHT = 0, 1
LIMITS = {"lanes": MAX_LANES, "width": MAX_WIDTH}
PER_METRE = 1000.0  # ends meet where they are equal to the millimetre
AT_BORDER = 1.0  # metres; a bridge that leaves the site has its approach outside


def road_table(
    roads: Tagged, density: Density, streets: Streets, coverage: Mapping[str, float] | None = None,
    *, left_hand: bool = False,
) -> GeoDataFrame:  # fmt: skip
    """Resolve the cross-section of every road and make the table.

    Parameters
    ----------
    density
        Of the site.
    streets
        Of the profile of the place.
    coverage
        As of `cityx.sources.features.resolve.Features`.
    left_hand
        Whether traffic keeps to the left.
    """
    lines = roads.shapes.copy()
    if len(lines) == 0:
        return make_table("roads", lines)
    share = share_about(lines, density)
    if coverage:
        sources = [roads.owners[index].source for index in roads.owner.tolist()]
        share = np.array(list(map(coverage.get, sources, share.tolist())), float)
    town, dense = (share >= TOWN).tolist(), (share >= DENSE).tolist()
    owner = roads.owner.tolist()
    sections = {
        key: cross_section(
            roads.owners[key[0]].tags, streets, town=key[1], dense=key[2], left_hand=left_hand
        )
        for key in set(zip(owner, town, dense, strict=True))
    }
    found = [sections[key] for key in zip(owner, town, dense, strict=True)]
    *values, backward = zip(*found, strict=True)
    turned = np.array(backward, bool)
    lines[turned] = shapely.reverse(lines[turned])
    columns: dict[str, Any] = dict(zip(_COLUMNS, values, strict=True))
    columns["roundabout"] = np.array(columns["roundabout"], bool) | _circles(lines, columns)
    return make_table("roads", lines, **roads.columns(), **columns)


def share_about(lines: NDArray[Any], density: Density) -> FloatArray:
    """(n,) the share of the ground about the middle of roads that is built over."""
    middle = shapely.line_interpolate_point(lines, 0.5, normalized=True)
    return density.at(shapely.get_coordinates(middle))


def _circles(lines: NDArray[Any], columns: dict[str, Any]) -> NDArray[np.bool_]:
    """Return small one-way rings: traffic circles without a tag."""
    small = shapely.is_closed(lines) & (shapely.length(lines) < CIRCLE)
    return np.asarray(small & np.array(columns["oneway"], bool) & np.isin(columns["kind"], [*CARS]))


_COLUMNS = (
    "section", "kind", "lanes", "lanes_forward", "lane_width", "width",
    "sidewalk_left", "sidewalk_right",
    "parking_left", "parking_right", "oneway", "layer", "bridge", "tunnel", "passage",
    "roundabout", "surface", "lit", "maxspeed_kmh",
)  # fmt: skip


def cross_section(
    tags: Tags, streets: Streets, *, town: bool, dense: bool, left_hand: bool = False
) -> tuple[Any, ...]:
    """Resolve one way: the values of `_COLUMNS`, and whether its direction is to be turned.

    Parameters
    ----------
    streets
        Of the profile of the place: how wide things are where no tag says so.
    town, dense
        Whether the surroundings are built densely enough for sidewalks and for parked cars.
    left_hand
        Whether traffic keeps to the left.
    """
    tags = road_tags(tags)
    kind = road_kind(tags)
    class_lanes, class_surface = ROAD_TABLE[kind]
    lane_width, class_sidewalk = streets.lane_widths[kind], streets.walk_widths.get(kind, 0.0)
    cars = kind in CARS
    roundabout = tags.get("junction") in ("roundabout", "circular")
    oneway, backward = _oneway(tags, kind, roundabout=roundabout)
    parking = _parking(tags) if cars else [False, False]
    known = measures.measure(
        tags.get("width:carriageway") or tags.get("width") or tags.get("est_width"), 1.0, MAX_WIDTH
    )
    default = max(1, class_lanes // 2) if oneway else class_lanes
    tagged = measures.count(tags.get("lanes"), 1, MAX_LANES) if cars else None
    against = contraflow(tags, backward=backward) if cars and oneway else 0
    lanes = int(tagged) if tagged else default + against
    single = False
    if parking is None:
        near = _LEFT if left_hand != backward else _RIGHT
        parking = _usual_parking(kind, near, tagged, oneway=oneway)
        parking = [dense and known is None and each for each in parking]
        if not streets.kerb_parking:
            single, parking = any(parking) and oneway and lanes == 1, [False, False]
    parked = PARKING * sum(parking)
    if known is not None and cars and not tagged:
        # A carriageway too narrow for its class has fewer lanes, a wide one has wider lanes.
        lanes = max(1, min(lanes, int((known - parked) / MIN_LANE)))
    if known is not None and known - parked < MIN_LANE:
        parking, parked = [False, False], 0.0
    width = known if known is not None else lanes * lane_width + parked
    if known is not None:
        lane_width = (width - parked) / lanes
    against = min(against, lanes - 1)
    forward = lanes - against if oneway else _forward(tags, lanes)
    if class_sidewalk:
        class_sidewalk = max(class_sidewalk, streets.least_walk)
    sidewalks = _sidewalks(tags, class_sidewalk, default=town) if cars else [0.0, 0.0]
    bands = bands_of_tags(
        tags, kind, lanes, forward, lane_width, (parking[_LEFT], parking[_RIGHT]),
        oneway=oneway, backward=backward, left_hand=left_hand, against=against,
    ) if cars else ()  # fmt: skip
    if single and not bands:
        aside = Band("shoulder", (streets.single_width - lane_width) / 2)
        bands = (aside, Band("drive", lane_width, 1), aside)
    if bands and known is None:
        width = carriageway_width(bands)
    if backward:
        parking, sidewalks = parking[::-1], sidewalks[::-1]
    bridge = tags.get("bridge", "no") not in ("no", "")
    passage = (
        tags.get("tunnel") in ("building_passage", "covered")
        or measures.is_yes(tags.get("covered"))
        or tags.get("covered") in ("arcade", "colonnade")
        or (cars and tags.get("indoor") == "yes")
    )  # fmt: skip
    tunnel = not passage and (
        tags.get("tunnel", "no") not in ("no", "") or tags.get("location") == "underground"
    )
    surface = SURFACE_WORDS.get(tags.get("surface", ""), class_surface)
    if kind in RAIL_WORDS and kind != "tram":
        surface = class_surface
    lit = tags.get("lit")
    return (
        section_text(bands), kind, lanes, forward, lane_width, width, *sidewalks, *parking, oneway,
        _layer(tags, bridge=bridge, tunnel=tunnel), bridge, tunnel, passage, roundabout, surface,
        measures.is_yes(lit) or (lit is None and cars and town),
        _speed_kmh(tags) if cars else nan, backward,
    )  # fmt: skip


_LIMITS = ("maxspeed", "maxspeed:type", "source:maxspeed", "zone:maxspeed", "zone:traffic")


def _speed_kmh(tags: Tags) -> float:
    """Return the limit that tags state or that the law they name sets; NaN without one."""
    if tags.get("maxspeed") == "none":
        return nan
    told = (measures.speed_kmh(tags.get(key)) for key in _LIMITS)
    return next((speed for speed in told if speed == speed), nan)


def _oneway(tags: Tags, kind: str, *, roundabout: bool) -> tuple[bool, bool]:
    value = tags.get("oneway", "").lower()
    if value in ("-1", "reverse"):
        return True, True
    if value:
        return value in measures.YES, False
    return roundabout or kind in ("motorway", "motorway_link"), False


def _layer(tags: Tags, *, bridge: bool, tunnel: bool) -> int:
    value = measures.count(tags.get("layer"), -10, 10)
    if value is not None:
        return int(value)
    return 1 if bridge else -1 if tunnel else 0


def _forward(tags: Tags, lanes: int) -> int:
    forward = measures.count(tags.get("lanes:forward"), 1, MAX_LANES)
    if forward is not None:
        return min(int(forward), lanes)
    backward = measures.count(tags.get("lanes:backward"), 1, MAX_LANES)
    if backward is not None:
        return max(1, lanes - int(backward))
    return (lanes + 1) // 2


def _parking(tags: Tags) -> list[bool] | None:
    """Return on which side cars park; None when no tag says so."""
    found: list[bool | None] = [None, None]
    for prefix in ("parking:lane", "parking"):
        for side, places in (("left", [_LEFT]), ("right", [_RIGHT]), ("both", [_LEFT, _RIGHT])):
            value = tags.get(f"{prefix}:{side}")
            if value:
                for place in places:
                    found[place] = value in _PARKED
    if found == [None, None]:
        return None
    return [bool(value) for value in found]


def _usual_parking(kind: str, near: int, lanes: float | None, *, oneway: bool) -> list[bool]:
    """Return where cars park in dense towns if no tag tells: on the sides of the way as drawn.

    They stand on both sides of residential streets, and beside the one lane of a busier one-way
    street on the side one drives on, where vans unload too.
    """
    both = kind == "residential" and lanes is None
    beside = oneway and (kind == "unclassified" or (kind == "tertiary" and lanes == 1))
    return [both or (beside and place == near) for place in (_LEFT, _RIGHT)]


def _sidewalks(tags: Tags, of_class: float, *, default: bool) -> list[float]:
    """Return the widths of the sidewalks left and right, metres."""
    wide = of_class or SIDEWALK
    value = tags.get("sidewalk", tags.get("footway") if "footway" in tags else None)
    sides: list[float | None] = [None, None]
    if value:
        left, right = value in ("both", "yes", "left"), value in ("both", "yes", "right")
        sides = [wide * left, wide * right]
    for side, places in (("both", (0, 1)), ("left", (0,)), ("right", (1,))):
        of_side = tags.get(f"sidewalk:{side}")
        width = measures.measure(tags.get(f"sidewalk:{side}:width"), 0.5, 15.0)
        for place in places:
            if of_side:
                sides[place] = wide if of_side == "yes" else 0.0
            if width is not None and sides[place] != 0.0:
                sides[place] = width
    usual = of_class if default and not _no_walking(tags) else 0.0
    return [usual if side is None else side for side in sides]


def _no_walking(tags: Tags) -> bool:
    return tags.get("foot") == "no" or tags.get("motorroad") == "yes" or tags.get("tunnel") == "yes"


def with_rails(ways: Tagged) -> Tagged:
    """Add the rails that lie in streets: a way that carries two things is two things."""
    tags = [rail_tags(owner.tags) for owner in ways.owners]
    laid = np.array([bool(tags[row]) for row in ways.owner.tolist()], bool)
    if not laid.any():
        return ways
    owners = [
        replace(owner, tags=own, more=(*owner.more, "rails"))
        for owner, own in zip(ways.owners, tags, strict=True)
    ]
    return joined(ways, replace(ways.take(laid), owners=owners))


def name_repairs(roads: Tagged, box: Box, report: Report) -> None:
    """Name the ways whose tags or form could not be built as they are.

    Parameters
    ----------
    roads
        Lines within the site.
    box
        The site.
    """
    for owner in _owners(roads, np.ones(len(roads.shapes), bool)):
        for text in _tag_repairs(owner.tags):
            _name(owner, text, report)
    for owner in _owners(roads, _crossed(roads.shapes)):
        _name(owner, "crosses itself; it is built as drawn, without a junction there", report)
    for owner in _owners(roads, _bare_bridges(roads, box)):
        _name(owner, "is a bridge that ends where no other way begins", report)


def name_points(owners: Iterable[Owner], report: Report) -> None:
    """Name the ways that have no length and are left out."""
    for owner in owners:
        _name(owner, "has no length; it is left out", report)


def name_edges(lines: Tagged, roads: Tagged, report: Report) -> None:
    """Name the ways that are a street and a barrier at once; see `cityx.sources.features.resolve`.

    Parameters
    ----------
    lines, roads
        Lines that stand, and streets, within the site.
    """
    streets = {roads.owners[row].key for row in np.unique(roads.owner).tolist()}
    for owner in _owners(lines, np.ones(len(lines.shapes), bool)):
        if owner.key in streets:
            _name(owner, "is a street and a barrier; the barrier stands at its right edge", report)


def _owners(roads: Tagged, rows: NDArray[np.bool_]) -> Iterator[Owner]:
    return (roads.owners[owner] for owner in np.unique(roads.owner[rows]).tolist())


def _name(owner: Owner, text: str, report: Report) -> None:
    report.fail(owner.id(), f"{owner.source} {text}")


def _tag_repairs(tags: Tags) -> Iterator[str]:
    """Yield what is wrong with the numbers of a street."""
    if tags.get("highway") not in CARS:
        return
    oneway, backward = _oneway(tags, road_kind(tags), roundabout=False)
    against = f"lanes:{'forward' if backward else 'backward'}"
    if oneway and (measures.count(tags.get(against), 1, MAX_LANES) or 0) > contraflow(
        tags, backward=backward
    ):
        yield f"is one-way and has {against}={tags[against]}; it was built one-way"
    for key, most in LIMITS.items():
        value = measures.measure(tags.get(key), -np.inf, np.inf)
        if value is not None and not 1.0 <= value <= most:
            yield f"has {key}={tags[key]}, outside 1 to {most:g}; what is usual was built"


def _crossed(lines: NDArray[np.object_]) -> NDArray[np.bool_]:
    """(n,) whether a line crosses itself between its points; at a point it makes a junction."""
    crossed = ~shapely.is_simple(lines)
    tried = lines[crossed]
    before, after = (
        shapely.extract_unique_points(tried),
        shapely.extract_unique_points(shapely.node(tried)),
    )
    crossed[crossed] = shapely.get_num_geometries(after) > shapely.get_num_geometries(before)
    return np.asarray(crossed)


def _bare_bridges(roads: Tagged, box: Box) -> NDArray[np.bool_]:
    """(n,) whether a line is a bridge one end of which touches no other line and no border."""
    points, owner = shapely.get_coordinates(roads.shapes, return_index=True)
    place = np.unique(np.rint(points * PER_METRE), axis=0, return_inverse=True)[1].reshape(-1)
    lone = np.bincount(place)[place] == 1
    lone &= np.minimum(points - box[:2], np.array(box[2:]) - points).min(axis=1) > AT_BORDER
    end = np.r_[True, owner[1:] != owner[:-1]] | np.r_[owner[1:] != owner[:-1], True]
    bare = np.zeros(len(roads.shapes), bool)
    np.logical_or.at(bare, owner, lone & end)
    decks = [tags.get("bridge", "no") not in ("no", "") for tags in roads.tags()]
    return np.asarray(bare & np.array(decks, bool))
