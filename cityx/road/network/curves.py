"""Streets on curves: whatever the curve and the street, the rows of a map's own streets."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
import shapely.ops
from numpy.typing import NDArray

from cityx.city.layout import Layout, joined_tables, make_table
from cityx.city.section import Band, carriageway_width, section_text
from cityx.convert.lines import line_ids
from cityx.errors import UsageError
from cityx.geometry.noding import join_ends, node_lines
from cityx.geometry.polylines import miters, pack
from cityx.ids import id_text, stable_id
from cityx.places.profiles import keeps_left
from cityx.protocol.objects import find_object
from cityx.protocol.values import Lines
from cityx.road.network.network import DRIVABLE
from cityx.road.network.street_designs import Design, carriageways, faults_of, row_of, turned

if TYPE_CHECKING:
    from geopandas import GeoDataFrame

    from cityx.city.city import City

Shapes = NDArray[Any]

LIMITS = (
    "Heights of the curves are not read: streets follow the terrain, grades and clearances.",
    "The road network and what follows from it must be made after it.",
)
RAILS = ("rail", "light_rail", "subway", "tram")
SHORTEST = 3.0  # metres; the network takes a shorter dead end for a mistake
FARTHEST = 100_000.0  # metres from the origin; no site reaches farther
MOST_CURVES = 10_000  # of one call
MOST_POINTS = 200_000  # of one call; a point a metre is 200 km of streets
MOST_FAULTS = 20  # told one by one; the rest are counted
SLACK = 2.0  # metres beyond a carriageway within which the end of a curve still means it
LAND = 25.0  # metres of land round the streets that belongs to the site
CLEAR = 6.0  # metres that a bridge or tunnel reaches beyond what it crosses
LEAST_APPROACH = 25.0  # metres; a shorter piece between two bridges is part of them
WATER = ("water", "river", "sea")


@dataclass(frozen=True)
class Piece:
    """A stretch of one carriageway, path or track on one level.

    Attributes
    ----------
    line
        LineString, metres.
    curve
        Position of the curve it was built on.
    number
        Position among the carriageways and stretches of that curve.
    bands
        Cross-section along the line; () for paths and tracks.
    layer
        Level, 0 on the ground.
    """

    line: shapely.LineString
    curve: int
    number: int
    bands: tuple[Band, ...]
    layer: int


def streets_on(
    city: City, curves: Lines, design: Design, *, curve: str | None = None, tracks: int = 1,
    spacing: float = 0.0,
) -> Layout:  # fmt: skip
    """Build streets of one design on curves, joined to each other and to those of the city.

    Parameters
    ----------
    city
        City whose streets are met: crossings become junctions, or bridges where `design.layer`
        says so.
    curves
        Curves, open or closed; heights of their points are not read.
    design
        The street.
    curve
        Id or source of the one curve to build on; all when None.
    tracks, spacing
        Parallel tracks and the metres between them, for rails.

    Returns
    -------
    layout
        The new streets, and those of the city that got points in common with them.

    Raises
    ------
    UsageError
        With every fault of the curves and every contradiction of the design.
    """
    chosen = _chosen(city, curves, curve)
    lines = shapely.force_2d(chosen.geometry)
    faults = curve_faults(lines)
    faults += _built_faults(city, chosen) if not faults else []
    faults += faults_of(design)
    if design.roundabout and not shapely.is_closed(lines).all():
        faults.append("A roundabout needs a closed curve.")
    if not faults:
        if design.roundabout:  # traffic keeps the island on the side of the driver
            lines = np.array([_round(line, keeps_left(city.frame)) for line in lines.tolist()])
        parts = _parts(city, lines, design, tracks, spacing)
        faults = _folded(lines, parts)
    if faults:
        raise UsageError(told(faults))
    return _laid(city, _pieces(city, parts, design), line_ids(chosen), design)


def _chosen(city: City, curves: Lines, curve: str | None) -> Lines:
    """Return the curves, or the one that is named."""
    if curve is None:
        return curves
    rows = curves.object_id == np.uint64(find_object(city, curve) or 0)
    if not rows.any():
        raise UsageError(f'"{curve}" names no curve.')
    columns = (curves.geometry, curves.kind, curves.width, curves.object_id)
    return Lines(*(column[rows] for column in columns))


def curve_faults(lines: Shapes) -> list[str]:
    """Return why curves cannot carry a street, one sentence per fault."""
    count = int(shapely.get_num_coordinates(lines).sum())
    if not len(lines):
        return ["There is no curve to build on."]
    if len(lines) > MOST_CURVES or count > MOST_POINTS:
        return [
            f"{len(lines)} curves of {count} points are more than {MOST_CURVES} curves or "
            f"{MOST_POINTS} points at once."
        ]
    xy, owner = shapely.get_coordinates(lines, return_index=True)
    sound = np.ones(len(lines), bool)
    np.logical_and.at(sound, owner, np.isfinite(xy).all(axis=1))
    inside = np.ones(len(lines), bool)
    np.logical_and.at(inside, owner, ~(np.abs(xy) > FARTHEST).any(axis=1))
    tried = lines.copy()
    tried[~(sound & inside)] = None  # of these nothing else is asked
    short = shapely.length(tried) < SHORTEST
    simple = shapely.is_simple(tried) | shapely.is_missing(tried) | short
    tests = (
        (shapely.get_type_id(lines) == 1, "is no line."),
        (sound, "has a coordinate that is no finite number."),
        (inside, f"reaches farther than {FARTHEST / 1000:g} km from the origin."),
        (~short, f"is shorter than {SHORTEST:g} m."),
        (simple, "crosses or touches itself."),
    )
    return [
        f"Curve {number} {text}"
        for good, text in tests
        for number in np.flatnonzero(~np.asarray(good)).tolist()
    ]


def _built_faults(city: City, curves: Lines) -> list[str]:
    """Return which curves carry a street already."""
    sources = np.array([source_of(number) for number in line_ids(curves).tolist()], object)
    taken = np.isin(sources, city.layout.roads["source"].to_numpy().astype(object))
    return [f"{source} carries a street already." for source in sources[taken].tolist()]


def source_of(curve: int) -> str:
    """Return the provenance of a street built on a curve."""
    return f"curve/{id_text(curve)}"


def told(faults: Sequence[str]) -> str:
    """Return faults as one text, the first of very many."""
    more = len(faults) - MOST_FAULTS
    rest = [f"And {more} more."] if more > 0 else []
    return " ".join([*faults[:MOST_FAULTS], *rest])


# The line of a carriageway or track, the position of its curve, its cross-section.
Part = tuple[shapely.LineString, int, tuple[Band, ...]]


def _folded(lines: Shapes, parts: Sequence[Part]) -> list[str]:
    """Return which curves bend so tightly that a line beside them folds."""
    bad = {row for line, row, _ in parts if _turns_back(lines[row], line)}
    return [f"Curve {row} bends tighter than the street on it is wide." for row in sorted(bad)]


def _turns_back(line: shapely.LineString, beside: shapely.LineString) -> bool:
    """Return whether a stretch of the parallel of a line runs against it."""
    ahead, other = (np.diff(shapely.get_coordinates(shape), axis=0) for shape in (line, beside))
    return bool(((ahead * other).sum(axis=1) <= 0).any())


def _parts(city: City, lines: Shapes, design: Design, tracks: int, spacing: float) -> list[Part]:
    """Lay the carriageways or tracks of a design beside the curves."""
    left_hand = keeps_left(city.frame)
    if design.lanes:
        return _beside(lines, design, carriageways(design, left_hand=left_hand))
    across = ((np.arange(tracks) - (tracks - 1) / 2) * spacing).tolist()
    return [
        (parallel(line, at), row, ()) for row, line in enumerate(lines.tolist()) for at in across
    ]


def _pieces(city: City, parts: Sequence[Part], design: Design) -> list[Piece]:
    """Join the ends of lines and part them by level; the lines run as their traffic does."""
    parts = [_along_traffic(part, oneway=design.median > 0) for part in parts]
    led = _joined(city, parts, design)
    obstacles = _obstacles(city, led, design)
    numbers: dict[int, int] = {}
    found = []
    for line, (_, row, bands) in zip(led.tolist(), parts, strict=True):
        for part, layer in _levels(line, obstacles, design.layer):
            number = numbers[row] = numbers.get(row, -1) + 1
            found.append(Piece(part, row, number, bands, layer))
    return found


def _beside(lines: Shapes, design: Design, sections: tuple[tuple[Band, ...], ...]) -> list[Part]:
    """Lay the carriageways along the curves."""
    if len(sections) == 1:
        return [(line, row, sections[0]) for row, line in enumerate(lines.tolist())]
    return [
        (parallel(line, side * (design.median + carriageway_width(bands)) / 2), row, bands)
        for row, line in enumerate(lines.tolist())
        for side, bands in zip((1.0, -1.0), sections, strict=True)
    ]


def _along_traffic(part: Part, *, oneway: bool) -> Part:
    """Turn a one-way carriageway round on which traffic would run against its line."""
    line, row, bands = part
    if not oneway or not any(band.direction < 0 for band in bands if band.kind == "drive"):
        return part
    return shapely.reverse(line), row, turned(bands)


def _round(line: shapely.LineString, left_hand: bool) -> shapely.LineString:
    """Turn a ring counter-clockwise, or clockwise where one keeps left."""
    ring = shapely.orient_polygons(shapely.Polygon(line), exterior_cw=left_hand)
    return shapely.LineString(shapely.get_coordinates(ring))


def parallel(line: shapely.LineString, lateral: float) -> shapely.LineString:
    """Return the line some metres to the left of one; the parallel of a closed line is closed."""
    if lateral == 0.0:
        return line
    closed = bool(shapely.is_closed(line))
    xy = shapely.get_coordinates(line)
    if closed:  # both ends see the corner there
        xy = np.concatenate([xy[-2:-1], xy, xy[1:2]])
    moved = xy + miters(pack([shapely.LineString(xy)])) * lateral
    return shapely.LineString(moved[1:-1] if closed else moved)


def _family(kinds: NDArray[Any]) -> NDArray[np.str_]:
    """(n,) what meets what: "cars", "foot", or the rails of one kind."""
    foot = np.where(np.isin(kinds, DRIVABLE), "cars", "foot")
    return np.where(np.isin(kinds, RAILS), kinds, foot)


def _joined(city: City, parts: Sequence[Part], design: Design) -> Shapes:
    """Join the ends of new lines to the streets they mean, of the city and of each other."""
    roads = city.layout.roads
    family = _family(roads["kind"].to_numpy().astype(str))
    own = str(_family(np.array([design.kind]))[0])
    usable = np.isin(family, ("cars", "foot") if own == "foot" else (own,))
    usable &= np.isin(roads["layer"].to_numpy(), (0, design.layer))
    old = roads.geometry.to_numpy()[usable]
    count = len(old)
    lines = np.concatenate([old, np.array([part[0] for part in parts], object)])
    curve = np.array([part[1] for part in parts])
    half = [carriageway_width(part[2]) / 2 for part in parts]
    reach = np.concatenate([roads["width"].to_numpy(float)[usable] / 2, half]) + SLACK
    led = join_ends(
        lines,
        np.concatenate([-1 - np.arange(count), curve]),
        reach + design.median / 2,
        np.arange(len(lines)) >= count,
    )
    return led[count:]


def _obstacles(city: City, lines: Shapes, design: Design) -> Any:
    """Return the area that a street on another level passes over or under."""
    if not design.layer:
        return None
    roads, areas = city.layout.roads, city.layout.areas
    other = roads["layer"].to_numpy() != design.layer
    near = shapely.STRtree(lines).query(roads.geometry.to_numpy()[other], predicate="intersects")[0]
    rows = np.flatnonzero(other)[np.unique(near)]
    half = roads["width"].to_numpy(float)[rows] / 2
    crossed = shapely.buffer(roads.geometry.to_numpy()[rows], half + CLEAR, cap_style="flat")
    wet = areas.geometry.to_numpy()[areas["kind"].isin(WATER).to_numpy()]
    shapes = np.concatenate([crossed, shapely.buffer(wet, CLEAR)])
    return shapely.union_all(shapes) if len(shapes) else None


def _levels(
    line: shapely.LineString, obstacles: Any, layer: int
) -> Iterator[tuple[shapely.LineString, int]]:
    """Split a line into stretches on its level, where it crosses something, and on the ground."""
    if not layer or obstacles is None or not shapely.intersects(line, obstacles):
        yield line, layer
        return
    over = shapely.get_parts(shapely.intersection(line, obstacles))
    over = over[shapely.get_type_id(over) == 1]
    ends = [shapely.line_locate_point(line, shapely.get_point(over, at)) for at in (0, -1)]
    spans = np.sort(np.column_stack(ends), axis=1)
    length = float(shapely.length(line))
    cuts = [0.0]
    for begin, end in spans[np.argsort(spans[:, 0])].tolist():
        begin = 0.0 if begin < LEAST_APPROACH else begin
        end = length if length - end < LEAST_APPROACH else end
        if len(cuts) > 1 and begin - cuts[-1] < LEAST_APPROACH:
            cuts[-1] = max(cuts[-1], end)
        else:
            cuts += [begin, end]
    cuts.append(length)
    levels = [0, layer] * len(cuts)
    for begin, end, level in zip(cuts[:-1], cuts[1:], levels, strict=False):
        if end > begin:
            yield shapely.ops.substring(line, begin, end), level


def _laid(city: City, pieces: Sequence[Piece], curve: NDArray[np.uint64], design: Design) -> Layout:
    """Give pieces and the streets they meet points in common, and make rows of them."""
    roads = city.layout.roads
    count = len(roads)
    lines = np.concatenate([roads.geometry.to_numpy(), [piece.line for piece in pieces]])
    kinds = np.concatenate([roads["kind"].to_numpy().astype(str), [design.kind] * len(pieces)])
    rails = np.isin(kinds, RAILS)
    level = np.concatenate([roads["layer"].to_numpy(int), [piece.layer for piece in pieces]])
    meets = np.unique(np.column_stack([level, rails]), axis=0, return_inverse=True)[1]
    noded = node_lines(lines, meets, np.arange(len(lines)) < count)
    changed = np.flatnonzero(noded[:count] != lines[:count])
    met = roads.iloc[changed].copy().set_geometry(noded[:count][changed])
    new = _table(noded[count:], pieces, curve, design)
    return Layout(_extent(city, pieces), roads=joined_tables(met, new))


def _extent(city: City, pieces: Sequence[Piece]) -> tuple[float, float, float, float]:
    """Return the site's rectangle, large enough for the streets and some land beside them."""
    box = shapely.total_bounds(np.array([piece.line for piece in pieces], object))
    wide = max(sum(band.width for band in piece.bands) for piece in pieces) / 2
    low, high = box[:2] - wide - LAND, box[2:] + wide + LAND
    if any(len(getattr(city.layout, name)) for name in ("buildings", "roads", "areas", "points")):
        low = np.minimum(low, city.layout.extent[:2])
        high = np.maximum(high, city.layout.extent[2:])
    return (*np.floor(low).tolist(), *np.ceil(high).tolist())  # on the grid of the ground


def _table(
    lines: Shapes, pieces: Sequence[Piece], curve: NDArray[np.uint64], design: Design
) -> GeoDataFrame:
    """Make the rows of the table of roads."""
    rows = []
    for piece in pieces:
        number = int(curve[piece.curve])
        oneway = design.oneway or design.roundabout or design.median > 0
        width = {"width": design.width, "lanes": 1, "lanes_forward": 1, "lane_width": design.width}
        rows.append({
            "id": stable_id("street", number, piece.number),
            "source": source_of(number),
            "kind": design.kind,
            "name": design.name,
            "section": section_text(piece.bands),
            **(row_of(piece.bands) if piece.bands else width),
            "oneway": oneway,
            "layer": piece.layer,
            "bridge": piece.layer > 0,
            "tunnel": piece.layer < 0,
            "roundabout": design.roundabout,
            "surface": design.surface,
            "lit": design.lit,
            "maxspeed_kmh": design.speed_kmh,
            "tags": _tags(design, number),
        })  # fmt: skip
    names = list(rows[0])
    columns = {name: [row[name] for row in rows] for name in names}
    columns["id"] = np.array(columns["id"], np.uint64)  # type: ignore[assignment]
    return make_table("roads", lines, **columns)


def _tags(design: Design, curve: int) -> str:
    """Return the tags of a map; the reference tells which two carriageways are one road."""
    key = "railway" if design.kind in RAILS else "highway"
    tags = {key: design.kind, "surface": design.surface}
    if design.median:
        tags["ref"] = id_text(curve)
    return json.dumps(tags)
