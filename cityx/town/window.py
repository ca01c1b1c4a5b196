"""A window of the plane as tagged shapes: roads, land, buildings and things, each owned once.

A thing belongs to the district or the main road that made it and is named by it, so that it is the
same whatever window shows it. A building belongs to the window that its middle lies in.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city import Frame, Layout
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.parcels.lattice import PER_METRE, Corner, Key
from cityx.geometry.parcels.parcels import parcels_of
from cityx.ids import id_text
from cityx.places.profile import Profile
from cityx.places.profiles import profile_of
from cityx.sources.features.gather import gather
from cityx.sources.features.kinds import PLACE
from cityx.sources.features.resolve import resolve
from cityx.sources.features.tagged import KIND, Owner, Report, Tagged, Tags, joined, tag
from cityx.sources.parcels.footprints import footprints_of
from cityx.town.blocks import Blocks, blocks_of
from cityx.town.districts import District, Districts
from cityx.town.plane import Plan, Plane
from cityx.town.procedural_streets import (
    BRIDGE,
    local_tags,
    main_rank,
    main_tags,
    name_of,
    side_tags,
)
from cityx.town.rims import waters_of
from cityx.town.rivers import ABUTMENT, around

Box = tuple[float, float, float, float]

ORIGINS = 10_000  # metres between the places a scene may have its origin at
# How the surroundings of a zone's buildings are built.
PLACES: Mapping[str, str] = {
    "core": "core", "midrise": "urban", "row": "urban", "suburb": "low", "semi": "low",
    "rural": "low", "industry": "low", "campus": "urban", "slab": "urban", "retail strip": "low",
}  # fmt: skip
TREES_IN = 5.5  # metres from the rim of a plaza to the trees along it
TREES_APART = 9.0  # metres between them
_NAMED = {"pedestrian": ("Square", "Place", "Market"), "park": ("Park", "Gardens", "Green")}
HALO = 80.0  # metres around a window from which buildings that reach into it may come


@dataclass
class Found:
    """Collects shapes, in whole millimetres of the plane, with their owners."""

    origin: IntArray  # (2,) of the scene, whole millimetres
    shapes: list[Any] = field(default_factory=list)
    owners: list[Owner] = field(default_factory=list)

    def add(self, key: tuple[object, ...], tags: Tags, shape: Any) -> None:
        """Add a shape of the scene frame."""
        self.shapes.append(shape)
        self.owners.append(Owner(key, tags))

    def line(self, key: tuple[object, ...], tags: Tags, places: IntArray) -> None:
        """Add a line over places."""
        self.add(key, tags, shapely.LineString(self.scene(places)))

    def point(self, key: tuple[object, ...], tags: Tags, place: IntArray) -> None:
        """Add a point."""
        self.add(key, tags, shapely.Point(self.scene(place)))

    def scene(self, places: IntArray) -> FloatArray:
        """Return places in the scene frame, metres."""
        return (np.asarray(places, np.int64) - self.origin) / PER_METRE

    def moved(self, shapes: Any, anchor: IntArray) -> Any:
        """Take shapes from the frame of a district into the scene, to whole millimetres."""

        def move(points: FloatArray) -> FloatArray:
            return self.scene(anchor + np.rint(points * PER_METRE).astype(np.int64))

        return shapely.transform(shapes, move)

    def tagged(self) -> Tagged:
        """Return all that was added."""
        return tag(self.shapes, self.owners)


def origin_of(window: Box) -> tuple[int, int]:
    """Return where the scene of a window has its origin in the plane, whole metres.

    Windows near each other share an origin, and near the plane's own it is (0, 0); far away it
    moves along, for the scene's numbers are small.
    """
    xmin, ymin, xmax, ymax = window
    x, y = round((xmin + xmax) / 2 / ORIGINS), round((ymin + ymax) / 2 / ORIGINS)
    return x * ORIGINS, y * ORIGINS


def layout_of_window(
    window: Box, plan: Plan, seed: int, *, frame: Frame, origin: tuple[int, int] | None = None
) -> Layout:
    """Make the layout of a window of the plane.

    Parameters
    ----------
    window
        (xmin, ymin, xmax, ymax) in the plane, metres.
    plan
        What is asked of the town.
    seed
        Key of every draw.
    frame
        Where on Earth the plane is taken to lie: roofs, and the side one drives on.
    origin
        Where the scene has its origin in the plane, whole metres; `origin_of` the window if None.

    Returns
    -------
    layout
        In the scene frame. Its site is the window, grown by the buildings whose middles lie in it
        and that reach over its border.
    """
    x, y = origin = origin_of(window) if origin is None else origin
    box = (window[0] - x, window[1] - y, window[2] - x, window[3] - y)
    found = features_of_window(window, plan, seed, profile_of(frame), origin=origin)
    return resolve(gather(found, box, Report()), frame, seed=seed)


def features_of_window(
    window: Box, plan: Plan, seed: int, profile: Profile | None = None, *, halo: float = HALO,
    origin: tuple[int, int] | None = None,
) -> Tagged:  # fmt: skip
    """Return what lies in a window and around it, uncut, in the scene frame.

    Buildings are those of the window alone; roads and land reach beyond it.

    Parameters
    ----------
    profile
        Of the place, None for that of the world.
    halo
        Metres around the window in which nothing of roads and land may be missing.
    origin
        As of `layout_of_window`.
    """
    plane = Plane(plan, seed, profile)
    districts = Districts(plane)
    x, y = origin_of(window) if origin is None else origin
    found = Found(np.array([x, y], np.int64) * PER_METRE)
    wide = (window[0] - halo, window[1] - halo, window[2] + halo, window[3] + halo)
    keys = _touching(districts, wide)
    for a, b in sorted(_roads_of(districts, keys)):
        _add_main(found, districts, a, b)
    built: list[tuple[Blocks, NDArray[Any]]] = []
    for name in sorted({name for key in keys for name in plane.cell(key).corners}):
        _add_corner(found, districts, name)
    for key in keys:
        if plane.is_wet(key):
            _add_water(found, districts, key)
            continue
        district = districts.district(key)
        _add_bank(found, districts, district)
        add_streets(found, plane, district)
        blocks = blocks_of(plane, district)
        land = found.moved(blocks.shapes, district.sketch.rim.anchor)
        add_land(found, district, blocks, land, seed)
        built.append((blocks, land))
    return joined(found.tagged(), *buildings_on(built, window, (x, y), seed, plan.built))


def buildings_on(
    built: list[tuple[Blocks, NDArray[Any]]],
    window: Box,
    origin: tuple[int, int],
    seed: int,
    coverage: float = 0.0,
) -> list[Tagged]:
    """Return what stands on the parcels of the blocks near a window.

    A building belongs to the window that a point in its middle lies in.
    """
    if not built:
        return []
    shapes = np.concatenate([land for _, land in built])
    ids, zone, density, height = (
        np.concatenate([getattr(blocks, name) for blocks, _ in built])
        for name in ("ids", "zone", "density", "height")
    )
    xmin, ymin = window[0] - origin[0], window[1] - origin[1]
    xmax, ymax = window[2] - origin[0], window[3] - origin[1]
    rows = np.flatnonzero((zone != "") & shapely.intersects(shapes, shapely.box(xmin, ymin, xmax, ymax)))  # fmt: skip  # noqa: E501
    if not len(rows):
        return []
    zone, density, height = zone[rows], density[rows], height[rows]
    parcels = parcels_of(shapes[rows], ids[rows], zone, density, seed=seed)
    block = parcels.block
    stand = footprints_of(
        parcels, zone[block], density[block], height[block], seed=seed, coverage=coverage
    )
    place = {
        id_text(one): PLACES[word]
        for one, word in zip(parcels.id.tolist(), zone[block].tolist(), strict=True)
    }
    owners = [_placed(owner, place) for owner in stand.owners]
    kept = _owned(stand, (xmin, ymin, xmax, ymax))
    return [Tagged(stand.shapes, stand.owner, stand.k, owners).take(np.flatnonzero(kept))]


def _owned(stand: Tagged, window: Box) -> NDArray[np.bool_]:
    """Return what a window owns: buildings with their point in it, and their parts."""
    tags = stand.tags()
    outline = np.flatnonzero(["building" in own for own in tags])
    part = np.flatnonzero(["building:part" in own and "building" not in own for own in tags])
    kept = np.ones(len(tags), bool)
    kept[outline] = _within(stand.shapes[outline], window)
    kept[part] = _within(stand.shapes[part], window)
    inner = shapely.point_on_surface(stand.shapes[part])
    of, whole = shapely.STRtree(stand.shapes[outline]).query(inner, predicate="within")
    kept[part[of]] = kept[outline[whole]]
    return kept


def _within(shapes: NDArray[Any], window: Box) -> NDArray[np.bool_]:
    points = shapely.get_coordinates(shapely.point_on_surface(shapes)).reshape(-1, 2)
    points = np.round(points, 3)
    return np.asarray(((points >= window[:2]) & (points < window[2:])).all(axis=1))


def _placed(owner: Owner, place: dict[str, str]) -> Owner:
    """Store with a building how dense its surroundings are; no window has to be measured."""
    if "building" not in owner.tags:
        return owner
    return Owner(owner.key, {**owner.tags, PLACE: place[str(owner.key[1])]}, owner.more)


def _touching(districts: Districts, box: Box) -> list[Key]:
    """Return the districts that a box touches."""
    plane = districts.plane
    frame = shapely.box(*box)
    near = plane.lattice.keys_near(box, plane.plan.district)
    plane.survey(plane.lattice.keys_near(box, 2 * plane.plan.district))  # with their neighbours
    return [key for key in near if frame.intersects(_outline(plane, key))]


def _outline(plane: Plane, key: Key) -> Any:
    ring = [plane.edge(key, beyond) for beyond in plane.cell(key).beyond]
    return shapely.convex_hull(shapely.MultiPoint(np.concatenate(ring) / PER_METRE))


def _roads_of(districts: Districts, keys: Iterable[Key]) -> set[tuple[Key, Key]]:
    plane = districts.plane
    pairs = {(min(a, b), max(a, b)) for a in keys for b in plane.cell(a).beyond}
    return {pair for pair in pairs if plane.side_kind(*pair) == "road"}


def _add_main(found: Found, districts: Districts, a: Key, b: Key) -> None:
    """Add a main road, with a point where every street meets it."""
    plane, rims = districts.plane, districts.rims
    tags = main_tags(plane, a, b)
    places = with_places(rims.road(a, b), districts.portals(a, b).places)
    for k, (piece, bridge) in enumerate(_bridged(places, rims.over_mouths(a, b))):
        more = BRIDGE if bridge else {}
        found.line(("town", *a, *b, "road", k), {**tags, **more}, piece)


def _bridged(places: IntArray, cuts: IntArray) -> list[tuple[IntArray, bool]]:
    """Cut a road where it goes over the mouths of rivers at its ends.

    Parameters
    ----------
    cuts
        (2, 2) where the bridges at both ends begin, the ends themselves where there is none.
    """
    line = with_places(places, cuts)
    rows = [int(np.flatnonzero((line == cut).all(axis=1))[k]) for k, cut in ((0, cuts[0]), (-1, cuts[1]))]  # fmt: skip  # noqa: E501
    pieces = [(line[: rows[0] + 1], True), (line[rows[0] : rows[1] + 1], False), (line[rows[1] :], True)]  # fmt: skip  # noqa: E501
    return [(piece, bridge) for piece, bridge in pieces if len(piece) > 1]


def with_places(line: IntArray, places: IntArray) -> IntArray:
    """Return a line with some places along it among its points, in whole millimetres."""
    base = line[0]
    road = shapely.LineString((line - base) / PER_METRE)
    every = np.concatenate([line, places])
    at = shapely.line_locate_point(road, shapely.points((every - base) / PER_METRE))
    at[0], at[len(line) - 1] = -1.0, road.length + 1.0
    ordered = every[np.argsort(at, kind="stable")]
    new = np.append(True, (np.diff(ordered, axis=0) != 0).any(axis=1))
    return np.asarray(ordered[new])


def _add_bank(found: Found, districts: Districts, district: District) -> None:
    """Add a district's roads along rivers."""
    sketch = district.sketch
    for m, side in enumerate(sketch.rim.sides):
        if side.kind == "bank":
            places = with_places(side.line, districts.rim_places(sketch, side, m))
            tags = side_tags(districts.plane, sketch.rim.key, side)
            found.line(("town", *sketch.rim.key, "bank", m), tags, places)


def _add_corner(found: Found, districts: Districts, name: Corner) -> None:
    """Add what lies at a corner of districts: signals, the turn of a river, a bridge."""
    plane, rims = districts.plane, districts.rims
    key = ("town", *(part for cell in name for part in cell))
    turn = rims.turn(name)
    if turn is None:
        cells = around(plane, name)
        pairs = list(zip(cells, [*cells[1:], cells[0]], strict=True))
        roads = [pair for pair in pairs if plane.side_kind(*pair) == "road"]
        ranks = [main_rank(plane, *pair) for pair in roads]
        if len(roads) > 2 and "primary" in ranks:
            found.point((*key, "signals"), {"highway": "traffic_signals"}, plane.corner(name))
        return
    water, green = (shapely.Polygon(found.scene(ring)) for ring in (turn.water, turn.green))
    found.add((*key, "river"), {KIND: "river"}, water)
    found.add((*key, "bank"), {KIND: "park"}, green.difference(water))
    bridge = rims.bridge(name)
    if bridge is not None:
        tags = main_tags(plane, *bridge.road)
        way = (bridge.line[1] - bridge.line[0]) / PER_METRE
        step = np.rint(ABUTMENT * PER_METRE * way / np.hypot(*way)).astype(np.int64)
        first, last = bridge.line[0] + step, bridge.line[1] - step
        found.line((*key, "bridge"), {**tags, **BRIDGE}, np.stack([first, last]))
        found.line((*key, "ramp", 0), tags, np.stack([bridge.line[0], first]))
        found.line((*key, "ramp", 1), tags, np.stack([last, bridge.line[1]]))


def add_streets(found: Found, plane: Plane, district: District) -> None:
    """Add local streets, one line per stretch that runs on under one name."""
    sketch = district.sketch
    key = sketch.rim.key
    ends = (district.places - sketch.rim.anchor)[district.links].astype(float)  # exact below 2^53
    streets, row = np.unique(district.street, axis=0, return_inverse=True)
    for number, (family, line) in enumerate(streets.tolist()):
        links = shapely.multilinestrings(shapely.linestrings(ends[row.ravel() == number]))
        tags = local_tags(plane, key, sketch.zone, sketch.kind, family, line)
        stretches = shapely.get_parts(shapely.line_merge(links))
        for k, stretch in enumerate(_in_order(stretches)):
            owner = ("town", *key, "street", family, line, k)
            found.line(owner, tags, sketch.rim.anchor + stretch.astype(np.int64))
    for k, end in enumerate(district.ends.tolist()):
        circle = {"highway": "turning_circle"}
        found.point(("town", *key, "end", k), circle, district.places[end])


def _in_order(lines: NDArray[Any]) -> list[FloatArray]:
    """Return lines as points, each from its lower end, in an order of their places."""
    points = [shapely.get_coordinates(line) for line in lines]
    turned = [p[::-1] if tuple(p[-1]) < tuple(p[0]) else p for p in points]
    return sorted(turned, key=lambda p: p.ravel().tolist())


def _add_water(found: Found, districts: Districts, key: Key) -> None:
    """Add a district that is a lake or the sea, and its shore."""
    plane = districts.plane
    anchor = plane.cell(key).site
    water, shore = waters_of(districts.rims, key)
    kind = plane.water_kind(key)
    found.add(("town", *key, "water"), {KIND: kind}, found.moved(water, anchor))
    land = "sand" if kind == "sea" else "park"
    found.add(("town", *key, "shore"), {KIND: land}, found.moved(shore, anchor))


def add_land(
    found: Found, district: District, blocks: Blocks, land: NDArray[Any], seed: int
) -> None:
    """Add the land of a district's blocks."""
    rim = district.sketch.rim
    for k, (shape, kind) in enumerate(zip(land, blocks.kind.tolist(), strict=True)):
        tags = {KIND: kind}
        if kind in _NAMED:
            tags["name"] = name_of(seed, _NAMED[kind], *rim.key, 11, k)
        found.add(("town", *rim.key, "land", k), tags, shape)
        if kind == "pedestrian":
            _add_plaza(found, ("town", *rim.key, "plaza", k), shape)


def _add_plaza(found: Found, key: tuple[object, ...], plaza: Any) -> None:
    """Add what stands on a plaza: a fountain in its middle, and trees along its rim."""
    middle = shapely.maximum_inscribed_circle(plaza, tolerance=1.0).coords[0]
    found.add((*key, "fountain"), {"amenity": "fountain"}, shapely.Point(np.round(middle, 3)))
    for ring, row in enumerate(shapely.get_parts(shapely.buffer(plaza, -TREES_IN)).tolist()):
        rim = row.exterior
        along = np.arange(0.5, int(rim.length / TREES_APART)) * TREES_APART
        spots = shapely.get_coordinates(shapely.line_interpolate_point(rim, along))
        for tree, spot in enumerate(np.round(spots, 3).tolist()):
            found.add((*key, "tree", ring, tree), {"natural": "tree"}, shapely.Point(spot))
