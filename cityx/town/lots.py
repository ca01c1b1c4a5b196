"""Lots: places in the blocks and squares of a town that are free for something to be built."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import Any, TypeVar

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.checks.predicates.places import places_of
from cityx.city import City, Layout
from cityx.errors import ActionFailed
from cityx.geometry.arrays import FloatArray
from cityx.town.elements import (
    ELEMENTS,
    HERDS,
    LARGE,
    LARGE_SCALE,
    SMALL,
    SMALL_SCALE,
    Element,
    Ground,
    Outline,
    Rectangle,
)
from cityx.town.rebuilding import BORDER, WET, is_made, is_square, street_blocks

_O = TypeVar("_O", bound=Outline)
STEP = 6.0  # metres between lots that are tried along a street
SHORTEST = 8.0  # metres of a side of a block that is a front
SETBACK = 0.4  # metres from the walk to a lot
APART = 2.0  # metres between two elements
HOUSE = 60.0  # metres farther away that weigh as much as taking a house down
CUT = 400.0  # metres of the same for a lot at the border of the site
ASIDE = 1500.0  # metres of the same for a lot as far to another side as the site is wide
CORNERS = ("northeast", "northwest", "southeast", "southwest")
OUT_OF_CORNER = 6000.0  # metres of the same for a lot a site away from a corner
CORNER = 0.25  # of the site, from its middle to what lies in a corner at least, both ways
OPEN = ("park", *WET)
OPEN_WATER = ("water", "sea", "river")
FOOT, CLEAR = 2.0, 1.0  # metres of a pier on land; from the water to a lot beside it
RAILS = ("rail", "light_rail", "narrow_gauge")
BESIDE_LINE = 5.0  # metres from a wall, a power line or a railway to a lot
ROUND_SIDES = 28
# Steps of a lot from the middle of a place to others in it: of one thing, and of a herd.
BESIDE = ((0.0, 0.0), (-1.2, 0.0), (1.2, 0.0), (0.0, -1.2), (0.0, 1.2))
HERD = tuple(
    (x + 0.3 * (y % 2) + 0.17 * (x % 3), y + 0.23 * (x % 2) + 0.11 * (y % 3))
    for x, y in sorted(product(range(-9, 10), repeat=2), key=lambda at: at[0] ** 2 + at[1] ** 2)
)
MOST_STRETCHED = 6.0  # times as long or wide as usual that an element is drawn


@dataclass(frozen=True)
class Lot:
    """Where something stands.

    Attributes
    ----------
    front
        (2,) middle of the side along the street, scene frame, metres.
    along
        (2,) unit vector along the street; away from it is to its left.
    scale
        Of the drawing.
    """

    front: FloatArray
    along: FloatArray
    scale: float = 1.0

    def placed(self, plan: Any) -> Any:
        """Return a plan of the lot in the scene frame."""
        across = np.array([-self.along[1], self.along[0]])
        turn = self.scale * np.column_stack([self.along, across])
        return shapely.transform(plan, lambda points: np.round(points @ turn.T + self.front, 3))


def plans_of(lots: Sequence[Lot], plan: Any) -> NDArray[Any]:
    """Return a plan of each of some lots in the scene frame, (n,)."""
    if not lots:
        return np.zeros(0, object)
    points = shapely.get_coordinates(plan)
    along = np.array([lot.along for lot in lots])
    across = np.column_stack([-along[:, 1], along[:, 0]])
    turn = np.array([lot.scale for lot in lots])[:, None, None] * np.stack([along, across], axis=1)
    front = np.array([lot.front for lot in lots])
    placed = np.round(points @ turn + front[:, None], 3)  # (n, k, 2)
    return np.asarray(
        shapely.set_coordinates(np.full(len(lots), plan, object), placed.reshape(-1, 2))
    )


def plan_of(outline: Outline) -> Any:
    """Return the polygon of an outline, in the frame of its lot."""
    if outline.box is not None:
        return shapely.box(*outline.box)
    x, y, radius = outline.round or (0.0, 0.0, 1.0)
    shell = _oval(*(outline.oval or (x, y, radius, radius)))
    return shell if outline.hole is None else shapely.difference(shell, _oval(*outline.hole))


def _oval(x: float, y: float, across: float, deep: float) -> Any:
    turn = np.linspace(0.0, 2 * np.pi, ROUND_SIDES, endpoint=False)
    ring = np.column_stack([x + across * np.cos(turn), y + deep * np.sin(turn)])
    return shapely.Polygon(np.round(ring, 3))


def ground_of(ground: Ground) -> Any:
    """Return the polygon of a piece of land, in the frame of its lot."""
    return shapely.difference(
        plan_of(ground), shapely.union_all([shapely.box(*out) for out in ground.without])
    )


def body_of(element: Element) -> Any:
    """Return what is measured of an element: its building, its land or its thing."""
    if element.measure.startswith("building"):
        return shapely.union_all([plan_of(part) for part in element.parts])
    if element.is_thing:
        return shapely.Point(element.points[0].at)
    return ground_of(element.areas[0]) if element.areas else lot_of(element)


def in_metres(element: Element, *, length: float = 0.0, width: float = 0.0) -> Element:
    """Return an element whose drawing is stretched to so many metres.

    Parameters
    ----------
    length, width
        The longer and the shorter side of what is measured of it, 0 where it is not said; a
        length alone makes it no wider than it is long, a width alone keeps its form.

    Raises
    ------
    ActionFailed
        If it would be stretched beyond reason.
    """
    if not (length or width) or element.is_thing or element.builder:
        return element
    xmin, ymin, xmax, ymax = body_of(element).bounds
    sides = np.array([xmax - xmin, ymax - ymin])
    longer = int(np.argmax(np.round(sides, 3)))
    factor = np.ones(2)
    if length:
        factor[longer] = length / sides[longer]
        factor[1 - longer] = min(1.0, length / sides[1 - longer])
    if width:
        factor[1 - longer] = width / sides[1 - longer]
        factor[longer] = factor[longer] if length else factor[1 - longer]
    if factor.max() > MOST_STRETCHED or factor.min() < 1 / MOST_STRETCHED:
        word = element.name.replace("_", " ")
        usual = " by ".join(f"{side:.0f} m" for side in sorted(sides.tolist(), reverse=True))
        said = " and ".join(f"{value:g} m {name}" for value, name in
                            ((length, "long"), (width, "wide")) if value)  # fmt: skip
        raise ActionFailed(
            f"A {word} of {said} is beyond reason: it usually takes {usual}, and may be "
            f"{MOST_STRETCHED:g} times as long or wide, or as short or narrow."
        )
    return _stretched(element, (xmin, ymin, xmax, ymax), *factor.round(5).tolist())


def _stretched(element: Element, body: Rectangle, x: float, y: float) -> Element:
    """Return an element whose body is so many times as wide and as deep, in the same margins."""
    middle = (body[0] + body[2]) / 2

    def across(at: float) -> float:
        inner = min(max(at, body[0]), body[2])
        return middle + (inner - middle) * x + at - inner

    def deep(at: float) -> float:
        inner = min(max(at, body[1]), body[3])
        return body[1] + (inner - body[1]) * y + at - inner

    def box(own: Rectangle) -> Rectangle:
        return across(own[0]), deep(own[1]), across(own[2]), deep(own[3])

    def oval(own: Rectangle) -> Rectangle:
        return across(own[0]), deep(own[1]), own[2] * x, own[3] * y

    def plan(outline: _O) -> _O:
        told: dict[str, Any] = {}
        if outline.box is not None:
            told["box"] = box(outline.box)
        if outline.round is not None:
            at, radius = outline.round[:2], outline.round[2]
            told |= {"round": None, "oval": oval((*at, radius, radius))}
        if outline.oval is not None:
            told["oval"] = oval(outline.oval)
        if outline.hole is not None:
            told["hole"] = oval(outline.hole)
        if isinstance(outline, Ground):
            told["without"] = tuple(map(box, outline.without))
        return replace(outline, **told)

    width, depth = element.lot
    width += (x - 1.0) * (body[2] - body[0])
    depth += (y - 1.0) * (body[3] - body[1])
    return replace(
        element, lot=(width, depth), least=1.0, size="",
        parts=tuple(map(plan, element.parts)), beside=tuple(map(plan, element.beside)),
        areas=tuple(map(plan, element.areas)),
        points=tuple(replace(one, at=(across(one.at[0]), deep(one.at[1])))
                     for one in element.points),
    )  # fmt: skip


def size_of(kind: str, size: str, count: int = 1) -> str:
    """Return the predicate that so many of an element take as much ground as its size says."""
    element = ELEMENTS[kind]
    if element.is_thing:
        bound = f"<= {SMALL_SCALE}" if size == "small" else f">= {LARGE_SCALE}"
        return f"n({element.measure}, scale {bound}) >= {count}"
    usual = float(body_of(element).area)
    bound = f"<= {SMALL * usual:.0f}" if size == "small" else f">= {LARGE * usual:.0f}"
    return f"n({element.measure}, area {bound}) >= {count}"


def bearing_of(lot: Lot, faces: float) -> dict[str, str]:
    """Return the tag of the direction of a thing that faces so many degrees from the lot's front.

    None without a number.
    """
    if not math.isfinite(faces):
        return {}
    east, north = lot.along
    front = math.degrees(math.atan2(north, -east))  # compass degrees of the way to the street
    return {"direction": f"{round(front + faces, 1) % 360:g}"}


def lot_of(element: Element) -> Any:
    """Return the polygon of the lot of an element, in the frame of the lot."""
    width, depth = element.lot
    return shapely.box(-width / 2, 0.0, width / 2, depth)


def lots_along_streets(
    layout: Layout, element: Element, fits: Callable[[list[Lot]], list[Lot]]
) -> list[Lot]:
    """Return the free lots along the sides of blocks, of the largest scale that finds any.

    Parameters
    ----------
    fits
        Returns those of some lots that are where the element is to be.
    """
    blocks, kept = street_blocks(layout), _kept(layout)
    for scale in element.scales:
        width, depth = (scale * size for size in element.lot)
        found = [lot for block in blocks.tolist() for lot in _along(block, width, depth, scale)]
        plans = plans_of(found, lot_of(element))
        taken, _ = kept.query(plans, predicate="dwithin", distance=APART)
        free = fits([found[k] for k in np.setdiff1d(np.arange(len(found)), taken).tolist()])
        if free:
            return free
    return []


def _along(block: Any, width: float, depth: float, scale: float) -> Iterator[Lot]:
    """Yield the lots of a block that have their front along one of its sides."""
    inner = shapely.buffer(block, -SETBACK, join_style="mitre")
    for part in shapely.get_parts(shapely.orient_polygons(inner)).tolist():
        ring = shapely.get_coordinates(shapely.simplify(part.exterior, 1.0))
        steps = np.diff(ring, axis=0)
        lengths = np.hypot(*steps.T)
        room = shapely.buffer(part, 0.05)
        shapely.prepare(room)
        for start, step, length in zip(ring, steps, lengths.tolist(), strict=False):
            if length < max(width, SHORTEST):
                continue
            along = step / length
            free = length - width
            middles = width / 2 + np.linspace(0.0, free, int(free // STEP) + 1)
            lots = [Lot(start + middle * along, along, scale) for middle in middles.tolist()]
            across = np.array([-along[1], along[0]])
            corners = np.array([
                [lot.front - width / 2 * along, lot.front + width / 2 * along,
                 lot.front + width / 2 * along + depth * across,
                 lot.front - width / 2 * along + depth * across]
                for lot in lots
            ])  # fmt: skip
            fits = shapely.contains(room, shapely.polygons(corners))
            yield from (lot for lot, fit in zip(lots, fits.tolist(), strict=True) if fit)


def lots_on_squares(
    city: City, element: Element, kinds: Sequence[str], about: Any = None
) -> list[Lot]:
    """Return the free spots in the middle of places, of the first kind that has any.

    Where ground is given that they are `about`, they lie in the middle of that part of a place.
    """
    herd = element.where in HERDS
    apart = 0.0 if herd else APART
    things = _points_there(city.layout) if herd else _made_there(city.layout)
    for kind in kinds:
        for scale in element.scales:
            lots = [
                lot for place in places_of(city, kind).tolist()
                for lot in _amid(place, element, scale, about)
                if not len(things.query(lot.placed(lot_of(element)), "dwithin", apart))
                and is_open(city.layout, lot.placed(lot_of(element)))
            ]  # fmt: skip
            if lots:
                return lots
    return []


def _amid(place: Any, element: Element, scale: float, about: Any = None) -> Iterator[Lot]:
    """Yield the lots in the middle of a place, or of a part of it, and beside, that lie in it."""
    width, depth = (scale * size for size in element.lot)
    part = place if about is None else shapely.intersection(place, about)
    if not part.area:
        return
    middle = shapely.get_coordinates(shapely.maximum_inscribed_circle(part, 1.0))[0]
    for shift in HERD if element.where in HERDS else BESIDE:
        front = middle + np.array(shift) * [width, depth] - [0.0, depth / 2]
        lot = Lot(np.round(front, 2), np.array([1.0, 0.0]), scale)
        if shapely.contains(place, lot.placed(lot_of(element))):
            yield lot


def _points_there(layout: Layout) -> shapely.STRtree:
    """Return the things of elements."""
    return shapely.STRtree(layout.points.geometry.to_numpy()[is_made(layout.points)])


def lots_on_shore(layout: Layout, element: Element) -> list[Lot]:
    """Return the free lots along the shores of a site, of the largest scale that finds any.

    They lie on land with their back to the water, or reach into it from the shore.
    """
    site = shapely.box(*layout.extent)
    areas = layout.areas.geometry.to_numpy()
    water = shapely.union_all(areas[layout.areas["kind"].isin(OPEN_WATER).to_numpy()])
    shore = shapely.intersection(shapely.boundary(water), shapely.buffer(site, -1.0))
    roads = layout.roads
    walks = roads[["sidewalk_left", "sidewalk_right"]].max(axis=1).to_numpy()
    strips = shapely.buffer(roads.geometry.to_numpy(), roads["width"].to_numpy() / 2 + walks)
    into = element.where == "water"
    streets = shapely.union_all(strips)
    room = shapely.buffer(water, FOOT) if into else shapely.difference(site, water)
    room = shapely.intersection(shapely.difference(room, streets), site)
    shapely.prepare(room)
    kept = _built(layout)
    for scale in element.scales:
        lots = list(_on_lines(shore, water, scale, into=into))
        plans = plans_of(lots, lot_of(element))
        if not len(plans):
            continue
        fits = shapely.contains(room, plans)
        fits[kept.query(plans, predicate="dwithin", distance=APART)[0]] = False
        if fits.any():
            return [lot for lot, fit in zip(lots, fits.tolist(), strict=True) if fit]
    return []


def _on_lines(shore: Any, water: Any, scale: float, *, into: bool) -> Iterator[Lot]:
    """Yield lots with their front on a shore, towards the water or away from it."""
    shapely.prepare(water)
    for line in shapely.get_parts(shapely.line_merge(shore)).tolist():
        at = np.arange(STEP / 2, line.length, STEP)
        ends = [shapely.line_interpolate_point(line, at + side * STEP / 2) for side in (-1, 1)]
        first, last = (shapely.get_coordinates(spots) for spots in ends)
        step = last - first
        length = np.hypot(*step.T)
        for middle, way, size in zip((first + last) / 2, step, length.tolist(), strict=True):
            if size < STEP / 2:
                continue
            along = way / size
            left = np.array([-along[1], along[0]])
            wet = bool(shapely.contains_xy(water, *(middle + 3.0 * left)))
            along = along if wet == into else -along
            across = np.array([-along[1], along[0]])
            front = middle + (-FOOT / 2 if into else CLEAR) * across
            yield Lot(np.round(front, 2), along, scale)


def _built(layout: Layout) -> shapely.STRtree:
    """Return what elements and buildings take."""
    houses = layout.buildings.geometry.to_numpy()
    return shapely.STRtree(np.concatenate([_made_there(layout).geometries, houses]))


def _made_there(layout: Layout) -> shapely.STRtree:
    """Return the land and the things of elements."""
    own = tuple(f"made/{name}/" for name in ELEMENTS)
    areas = layout.areas[layout.areas["source"].str.startswith(own).to_numpy(bool)]
    points = layout.points[is_made(layout.points)]
    return shapely.STRtree(np.concatenate([areas.geometry.to_numpy(), points.geometry.to_numpy()]))


def is_open(layout: Layout, plan: Any) -> bool:
    """Return whether nothing is built on a place."""
    return not shapely.intersects(layout.buildings.geometry.to_numpy(), plan).any()


def cheapest(lots: Sequence[Lot], layout: Layout, element: Element, where: str) -> Lot:
    """Return the lot that costs least: metres from where it is to be, and what is taken down."""
    xmin, ymin, xmax, ymax = layout.extent
    border = shapely.box(*layout.extent).exterior
    plans = plans_of(lots, lot_of(element))
    x, y = shapely.get_coordinates(shapely.centroid(plans)).T
    away = np.hypot(x - (xmin + xmax) / 2, y - (ymin + ymax) / 2)
    metres = {
        "edge": -away, "north": 2 * (ymax - y), "south": 2 * (y - ymin),
        "east": 2 * (xmax - x), "west": 2 * (x - xmin),
        "northeast": np.hypot(xmax - x, ymax - y), "northwest": np.hypot(x - xmin, ymax - y),
        "southeast": np.hypot(xmax - x, y - ymin), "southwest": np.hypot(x - xmin, y - ymin),
    }.get(where, away)  # fmt: skip
    east, north = (x - (xmin + xmax) / 2) / (xmax - xmin), (y - (ymin + ymax) / 2) / (ymax - ymin)
    towards = {"north": north, "south": -north, "east": east, "west": -east}.get(where)
    if towards is not None:  # no more to another side than to this one
        across = np.abs(east if where in ("north", "south") else north)
        metres = metres + ASIDE * np.maximum(across - towards, 0.0)
    if where in CORNERS:  # as far to one side of it as to the other
        towards = np.minimum(
            north if "north" in where else -north, east if "east" in where else -east
        )
        metres = metres + OUT_OF_CORNER * np.maximum(CORNER - towards, 0.0)
    houses = shapely.STRtree(layout.buildings.geometry.to_numpy())
    hit = houses.query(plans, predicate="intersects")[0]
    metres = metres + HOUSE * np.bincount(hit, minlength=len(plans))
    metres += CUT * (shapely.distance(plans, border) <= BORDER)
    order = np.lexsort((np.round(y, 2), np.round(x, 2), np.round(metres, 2)))
    return lots[int(order[0])]


def _kept(layout: Layout) -> shapely.STRtree:
    """Return what makes no room: squares, parks, water, what was asked for before."""
    areas, buildings, points = layout.areas, layout.buildings, layout.points
    open_land = areas["kind"].isin(OPEN).to_numpy() | is_square(areas) | is_made(areas)
    lines, roads = layout.lines, layout.roads
    rails = roads["kind"].isin(RAILS).to_numpy()
    return shapely.STRtree(
        np.concatenate([
            shapely.buffer(lines.geometry.to_numpy()[is_made(lines)], BESIDE_LINE),
            shapely.buffer(roads.geometry.to_numpy()[rails], BESIDE_LINE),
            areas.geometry.to_numpy()[open_land],
            buildings.geometry.to_numpy()[is_made(buildings)],
            points.geometry.to_numpy()[is_made(points)],
        ])
    )  # fmt: skip
