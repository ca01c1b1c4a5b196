"""Parts of hosts: towers, spires, domes, minarets, chimneys that are built onto a building.

A part is drawn as volumes of the building, as those of a map are. It stands where its kind does:
in the middle of the front, at corners, on the roof. What is there already is kept, made higher or
painted; what is too much becomes one with the volume beside it.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.checks.predicates.body_parts import BodyPart, body_parts
from cityx.checks.predicates.words import BODY_PARTS
from cityx.city import Layout
from cityx.city.layout import joined_tables, make_table
from cityx.geometry.arrays import FloatArray
from cityx.ids import hash_ids, stable_id
from cityx.road.network.network import DRIVABLE
from cityx.town.part_kinds import PART_KINDS, PartKind

ROUND_SIDES = 16
SHARE = 0.24  # of the shorter side of a host that a tower takes
FILLS = 0.97  # of its plan, that must lie in the outline of its host
LEAST_PIECE = 1.5  # square metres of what a tower leaves of the volume it stands in
MORE = 6.0  # metres at least that a part stands out of its host
SLIMMEST, WIDEST = 6.0, 12.0  # height over the side of a tower at most; metres of a side
SLIMMEST_SHAFT = 9.0  # height over the side of a chimney
SPARE = 1.02  # times the measure that a part must have
LEAST_RISE = 1.0  # metres from the foot of a part to its top
_HEIGHTS = ("base", "top", "roof_height")
APART = 0.4  # metres from a part that stands out of its host to another building


@dataclass(frozen=True)
class Look:
    """What is said of a part.

    Attributes
    ----------
    height
        Metres from the ground to its top; 0 for what suits its host.
    most
        Metres that the host may have with it.
    color
        sRGB 0xRRGGBB, -1 for that of its host.
    material
        "" for that of its host.
    """

    height: float = 0.0
    most: float = float("inf")
    color: int = -1
    material: str = ""


def with_parts(
    layout: Layout, row: int, part: str, least: int, most: int, look: Look, *, seed: int
) -> Layout:
    """Return a layout in which a building has so many parts of a kind, as they are to look.

    Parameters
    ----------
    row
        Of the table of buildings.
    part
        A key of `PART_KINDS` with a body.

    Raises
    ------
    NoRoomForPart
        If they find no room on it.
    """
    kind = PART_KINDS[part]
    building = int(layout.buildings["id"].iloc[row])
    number = np.array([building], np.uint64)
    if not (layout.parts["building"].to_numpy(np.uint64) == number).any():
        if least:
            raise NoRoomForPart("it has no volumes")
        return layout
    found = list(body_parts(layout, kind.body, number))
    for _ in range(len(found) - most):
        layout = _joined(layout, min(found, key=lambda one: (one.top, one.outline.area)))
        found = list(body_parts(layout, kind.body, number))
    missing = least - len(found)
    if missing > 0 and kind.body == "spire":
        layout = _pointed(layout, building, missing, look.most)
        found = list(body_parts(layout, kind.body, number))
    spots = _spots(layout, row, kind, least, look.height)
    for _ in range(least - len(found)):
        layout = _with_one_more(layout, row, kind, spots, look, seed=seed)
    for one in body_parts(layout, kind.body, number):
        layout = _as_said(layout, one, kind, look)
    return _with_top(layout, row)


class NoRoomForPart(Exception):
    """A part finds no room on a building; the text says why."""


def _with_one_more(
    layout: Layout, row: int, kind: PartKind, spots: Iterator[Any], look: Look, *, seed: int
) -> Layout:
    """Build one part at the first spot that has room for it."""
    building = int(layout.buildings["id"].iloc[row])
    own = layout.parts["building"].to_numpy(np.uint64) == np.uint64(building)
    standing = list(body_parts(layout, kind.body, np.array([building], np.uint64)))
    others = shapely.STRtree(np.delete(layout.buildings.geometry.to_numpy(), row))
    outline = layout.buildings.geometry.iloc[row]
    why = "no place on it is free"
    for plan in spots:
        if any(shapely.dwithin(one.outline, plan, 1.0) for one in standing):
            continue
        beyond = shapely.difference(plan, outline)
        if beyond.area > 0.05 and len(others.query(beyond, "dwithin", distance=APART)):
            continue
        like = look
        if standing and not look.height and kind.at != "roof":  # as high as those that are there
            like = replace(look, height=max(one.top for one in standing))
        try:
            made = _raised(layout, np.flatnonzero(own), plan, kind, like, seed=seed)
        except NoRoomForPart as error:
            why = str(error)
            continue
        again = body_parts(made, kind.body, np.array([building], np.uint64))
        if len(list(again)) > len(standing):
            return made if beyond.area <= 0.05 else _grown(made, row, plan)
    raise NoRoomForPart(why)


def _raised(
    layout: Layout, rows: NDArray[np.int64], plan: Any, kind: PartKind, look: Look, *, seed: int
) -> Layout:
    """Add the volume of a part to a building, and cut it out of the volumes that it stands in."""
    parts = layout.parts
    shapes = parts.geometry.to_numpy()[rows]
    shared = shapely.area(shapely.intersection(shapes, plan))
    under = int(rows[np.argmax(shared)])
    body = float(parts["top"].iloc[under])
    side = float(np.sqrt(plan.area))
    form = BODY_PARTS[kind.body]
    base = 0.0
    if kind.at == "roof":
        layout, base = _flattened(layout, under)
        parts = layout.parts
        point = kind.point * side
        top = base + point + 0.12 * side
        if look.height:
            base_most = look.height - 0.3 * side
            base, top = min(base, max(base_most, 0.5)), look.height
            point = min(point, top - base)
    else:
        least = max(form.over * body, form.slender[0] * side, body + MORE) * SPARE
        usual = max(kind.high * body, least, kind.slim * side, body + MORE)
        top = look.height or min(usual, max(look.most, least))
        point = min(kind.point * side, 0.6 * top)
        if top < least / SPARE or top > look.most + 0.01:
            short = top < least / SPARE
            bound = f"at least {least:.0f}" if short else f"at most {look.most:.0f}"
            raise NoRoomForPart(f"it would be {top:.0f} m high, and {bound} m are possible")
    keep = np.delete(np.arange(len(parts)), rows)
    left, columns = [], []
    for at in rows.tolist():
        shape = parts.geometry.iloc[at]
        low, high = float(parts["base"].iloc[at]), float(parts["top"].iloc[at])
        if low < top and high > base and shapely.area(shapely.intersection(shape, plan)) > 0:
            shape = shapely.difference(shape, plan)
        pieces = [one for one in shapely.get_parts(shape).tolist() if one.area >= LEAST_PIECE]
        left += [_with_courtyards(one, plan) for one in pieces]
        columns += [(at, k) for k in range(len(pieces))]
    at = np.array([row for row, _ in columns], np.int64)
    again = np.array([k for _, k in columns], np.int64)
    cut = parts.iloc[at].copy().set_geometry(np.array(left, object)) if len(at) else parts.iloc[:0]
    ids = cut["id"].to_numpy(np.uint64)
    cut["id"] = np.where(again == 0, ids, hash_ids(seed, "host part", ids, again))
    x, y = shapely.get_coordinates(shapely.centroid(plan))[0].tolist()
    place = np.rint(1000 * np.array([x, y])).astype(np.int64)
    host = parts.iloc[under]
    new = make_table(
        "parts", [shapely.orient_polygons(plan)],
        id=[stable_id("host part", kind.name, int(host["building"]), *place.tolist())],
        building=[host["building"]], use=[kind.body], base=[base], top=[round(top, 2)],
        levels=[max(round((top - point - base) / kind.floors), 1) if kind.floors else 1],
        roof_shape=["pyramidal" if kind.roof == "cone" and not kind.round else kind.roof],
        roof_height=[round(point, 2)], roof_direction=[np.nan], walls=[True],
        wall_color=[host["wall_color"]], wall_material=[kind.material or host["wall_material"]],
        roof_color=[host["roof_color"]], roof_material=[host["roof_material"]],
    )  # fmt: skip
    table = joined_tables(joined_tables(parts.iloc[keep], cut), new)
    return replace(layout, parts=table)


def _with_courtyards(shape: Any, plan: Any) -> Any:
    """Fill the hole of a part that stands, or stood, within a shape, and slits beside it."""
    within = shapely.buffer(plan, 0.01)
    holes = [
        ring for ring in shape.interiors
        if shapely.Polygon(ring).area >= LEAST_PIECE and not shapely.contains(within, ring)
    ]  # fmt: skip
    return shapely.orient_polygons(shapely.Polygon(shape.exterior, holes))


def _flattened(layout: Layout, row: int) -> tuple[Layout, float]:
    """Take the roof off a volume on which something stands; return where its top is then."""
    parts = layout.parts.copy()
    rise = float(parts["roof_height"].iloc[row])
    top = parts["top"].to_numpy(float).copy()
    top[row] -= rise
    parts["top"] = top
    flat = parts["roof_height"].to_numpy(float).copy()
    flat[row] = 0.0
    parts["roof_height"] = flat
    shape = parts["roof_shape"].to_numpy(object).copy()
    shape[row] = "flat"
    parts["roof_shape"] = shape.astype(str)
    return replace(layout, parts=parts), float(top[row])


def _grown(layout: Layout, row: int, plan: Any) -> Layout:
    """Let the outline of a building hold a part that stands out of it."""
    shapes = layout.buildings.geometry.to_numpy().copy()
    whole = shapely.union(shapes[row], plan, grid_size=1e-3)
    largest = max(shapely.get_parts(whole).tolist(), key=lambda one: one.area)
    shapes[row] = _with_courtyards(largest, plan)
    return replace(layout, buildings=layout.buildings.set_geometry(shapes))


def _joined(layout: Layout, part: BodyPart) -> Layout:
    """Take a part down: what it stood on the ground of becomes one with the volume beside it."""
    parts = layout.parts
    own = part.rows
    beside = np.flatnonzero(
        (parts["building"].to_numpy(np.uint64) == np.uint64(part.building))
        & shapely.dwithin(parts.geometry.to_numpy(), part.outline, 0.3)
    )
    beside = np.setdiff1d(beside, own)
    shapes = parts.geometry.to_numpy().copy()
    if float(parts["base"].iloc[own].min()) <= 0.0 and len(beside):
        edge = shapely.length(shapely.intersection(
            shapely.boundary(part.outline), shapely.buffer(shapes[beside], 0.05)
        ))  # fmt: skip
        into = int(beside[np.argmax(np.round(edge, 2))])
        whole = shapely.union(shapes[into], part.outline, grid_size=1e-3)
        if shapely.get_type_id(whole) == 3:
            shapes[into] = _with_courtyards(whole, part.outline)
    kept = np.setdiff1d(np.arange(len(parts)), own)
    table = parts.set_geometry(shapes).iloc[kept].reset_index(drop=True)
    return replace(layout, parts=table)


def _pointed(layout: Layout, building: int, count: int, most: float) -> Layout:
    """Put spires on towers that have none, as many as are missing."""
    kind, form = PART_KINDS["spire"], BODY_PARTS["spire"]
    towers = body_parts(layout, "tower", np.array([building], np.uint64))
    parts = layout.parts.copy()
    top, rise = (parts[name].to_numpy(float).copy() for name in ("top", "roof_height"))
    shape = parts["roof_shape"].to_numpy(object).copy()
    for one in [own for own in towers if np.sqrt(own.outline.area) >= form.width[0]][:count]:
        row = int(one.rows[np.argmax(top[one.rows])])
        side = float(np.sqrt(parts.geometry.iloc[row].area))
        eave = float(top[row] - rise[row])
        rise[row] = round(min(kind.point * side, max(most - eave, form.pointed * side)), 2)
        top[row], shape[row] = round(eave + rise[row], 2), kind.roof
    parts["top"], parts["roof_height"] = top, rise
    parts["roof_shape"] = shape.astype(str)
    return replace(layout, parts=parts)


def _as_said(layout: Layout, part: BodyPart, kind: PartKind, look: Look) -> Layout:
    """Give a part the height, the colour and the material that are said of it."""
    parts = layout.parts.copy()
    own = part.rows
    if look.height and abs(look.height - part.top) > 0.01:
        base, top, rise = (parts[name].to_numpy(float).copy() for name in _HEIGHTS)
        foot = float(base[own].min())
        if look.height < foot + LEAST_RISE:
            raise NoRoomForPart(
                f"it would be {look.height:g} m high and stands {foot:.1f} m above the ground; "
                f"at least {foot + LEAST_RISE:.1f} m are possible"
            )
        factor = (look.height - foot) / (part.top - foot)
        base[own] = np.round(foot + factor * (base[own] - foot), 2)
        top[own] = np.round(foot + factor * (top[own] - foot), 2)
        if BODY_PARTS[kind.body].domed:
            rise[own] = np.minimum(rise[own], top[own] - base[own])
        else:
            rise[own] = np.round(rise[own] * factor, 2)
        for name, values in zip(_HEIGHTS, (base, top, rise), strict=True):
            parts[name] = values
    tops = BODY_PARTS[kind.body].tops
    for name, value, none in (
        ("roof_color" if tops else "wall_color", look.color, -1),
        ("roof_material" if tops else "wall_material", look.material, ""),
    ):
        if value != none:
            values = parts[name].to_numpy(object).copy()
            values[own] = value
            parts[name] = values.astype(parts[name].dtype if none == -1 else str)
    return replace(layout, parts=parts)


def _with_top(layout: Layout, row: int) -> Layout:
    """Let a building be as high as its highest volume, and be tagged so."""
    buildings = layout.buildings.copy()
    own = layout.parts["building"].to_numpy(np.uint64) == np.uint64(int(buildings["id"].iloc[row]))
    top = float(layout.parts["top"].to_numpy(float)[own].max())
    height = buildings["height"].to_numpy(float).copy()
    height[row] = top
    buildings["height"] = height
    tags = buildings["tags"].to_numpy(object).copy()
    tags[row] = json.dumps({**json.loads(tags[row] or "{}"), "height": f"{top:.2f}"})
    buildings["tags"] = tags.astype(str)
    return replace(layout, buildings=buildings)


# -- where they stand ------------------------------------------------------------------------------


def _body_height(layout: Layout, row: int) -> float:
    """Return the metres to the top of the largest volume of a building."""
    own = layout.parts["building"].to_numpy(np.uint64) == np.uint64(
        int(layout.buildings["id"].iloc[row])
    )
    area = shapely.area(layout.parts.geometry.to_numpy()[own])
    return float(layout.parts["top"].to_numpy(float)[own][int(np.argmax(area))])


def _spots(layout: Layout, row: int, kind: PartKind, count: int, height: float) -> Iterator[Any]:
    """Yield plans of a part of a kind, those where it stands best first."""
    outline = layout.buildings.geometry.iloc[row]
    frame = _frame_of(layout, outline)
    local = frame.into(outline)
    x0, y0, x1, y1 = shapely.bounds(local).tolist()
    short = min(x1 - x0, y1 - y0)
    side = float(np.clip(SHARE * short, *kind.wide))
    top = height or kind.high * _body_height(layout, row)
    side = float(np.clip(side, top / SLIMMEST if kind.floors else 0.0, WIDEST))
    if kind.round and kind.slim and height:
        side = float(np.clip(height / SLIMMEST_SHAFT, 1.2, side))
    if kind.at == "roof":
        yield from (frame.back(plan) for plan in _on_roofs(layout, row, kind, frame, count))
        return
    if kind.round:
        for x, y in _corners(local, rear=kind.at.startswith("rear")):
            yield frame.back(_disc(x, y, side / 2))
        return
    middle, ends = (x0 + x1) / 2, (x0 + side / 2, x1 - side / 2)
    first = [middle, *ends] if count == 1 else [*ends, middle]
    for rear in (False, True):
        for x in first:
            for size in (side, kind.wide[0]):
                yield from (frame.back(plan) for plan in _flush(local, x, size, rear=rear))
    yield from (frame.back(plan) for plan in _astride(local, side))
    for share in (0.5, 0.25, 0.75):
        for x in ends:
            y = y0 + share * (y1 - y0)
            plan = shapely.box(x - side / 2, y - side / 2, x + side / 2, y + side / 2)
            if shapely.intersection(plan, local).area >= FILLS * plan.area:
                yield frame.back(plan)


def _flush(local: Any, x: float, side: float, *, rear: bool) -> Iterator[Any]:
    """Yield the square at a place along the front, or the rear, flush with it."""
    far = 1e4
    strip = shapely.intersection(local, shapely.box(x - side / 2, -far, x + side / 2, far))
    for part in shapely.get_parts(strip).tolist():
        if part.area < side * side * FILLS:
            continue
        low, high = float(part.bounds[1]), float(part.bounds[3])
        y = high - side if rear else low
        plan = shapely.box(x - side / 2, y, x + side / 2, y + side)
        if shapely.intersection(plan, local).area >= FILLS * plan.area:
            yield plan


def _astride(local: Any, side: float) -> Iterator[Any]:
    """Yield squares astride the corners and the middles of the sides, front first: of a castle."""
    hull = shapely.convex_hull(shapely.simplify(local, 1.0))
    ring = shapely.get_coordinates(hull)
    middles = (ring[1:] + ring[:-1]) / 2
    long = np.hypot(*np.diff(ring, axis=0).T) > 3 * side
    for x, y in [*_corners(local, rear=False), *map(tuple, middles[long].tolist())]:
        yield shapely.box(x - side / 2, y - side / 2, x + side / 2, y + side / 2)


def _corners(local: Any, *, rear: bool) -> list[tuple[float, float]]:
    """Return the corners of an outline that stick out, those of the front or the rear first."""
    hull = shapely.get_coordinates(shapely.convex_hull(shapely.simplify(local, 1.0)))[:-1]
    x0, y0, x1, y1 = shapely.bounds(local).tolist()
    wanted = [(x0, y1), (x1, y1), (x0, y0), (x1, y0)]
    wanted = wanted if rear else [*wanted[2:], *wanted[:2]]
    far = [int(np.argmin(np.hypot(*(hull - np.array(one)).T))) for one in wanted]
    order = list(dict.fromkeys([*far, *range(len(hull))]))
    return [(float(hull[k, 0]), float(hull[k, 1])) for k in order]


def _on_roofs(layout: Layout, row: int, kind: PartKind, frame: _Frame, count: int) -> Iterator[Any]:
    """Yield discs on the roofs of the largest volumes, side by side where several are wanted."""
    building = int(layout.buildings["id"].iloc[row])
    own = layout.parts["building"].to_numpy(np.uint64) == np.uint64(building)
    shapes = layout.parts.geometry.to_numpy()[own]
    for shape in sorted(shapes.tolist(), key=lambda one: -one.area):
        local = frame.into(shape)
        x0, y0, x1, y1 = shapely.bounds(local).tolist()
        long = x1 - x0 >= y1 - y0
        across = min(x1 - x0, y1 - y0)
        side = float(np.clip(min(0.62 * across, 0.8 * max(x1 - x0, y1 - y0) / count), *kind.wide))
        if count == 1:
            circle = shapely.maximum_inscribed_circle(local, 0.3)
            side = min(side, 1.9 * float(circle.length))
            x, y = shapely.get_coordinates(circle)[0].tolist()
            if side >= kind.wide[0] * 0.7:
                yield _disc(x, y, side / 2)
            continue
        for k in range(count):
            at = (k + 0.5) / count
            x = x0 + at * (x1 - x0) if long else (x0 + x1) / 2
            y = (y0 + y1) / 2 if long else y0 + at * (y1 - y0)
            plan = _disc(x, y, side / 2)
            if shapely.contains(local, plan):
                yield plan


def _disc(x: float, y: float, radius: float) -> Any:
    turn = np.linspace(0.0, 2 * np.pi, ROUND_SIDES, endpoint=False)
    ring = np.column_stack([x + radius * np.cos(turn), y + radius * np.sin(turn)])
    return shapely.Polygon(np.round(ring, 3))


@dataclass(frozen=True)
class _Frame:
    """A frame of a building: x along its front, y away from the street; (2,) each."""

    origin: FloatArray
    along: FloatArray

    def into(self, shape: Any) -> Any:
        """Return a shape of the scene in this frame."""
        turn = np.column_stack([self.along, [-self.along[1], self.along[0]]])
        return shapely.transform(shape, lambda points: (points - self.origin) @ turn)

    def back(self, shape: Any) -> Any:
        """Return a shape of this frame in the scene."""
        turn = np.vstack([self.along, [-self.along[1], self.along[0]]])
        return shapely.transform(shape, lambda points: np.round(points @ turn + self.origin, 3))


def _frame_of(layout: Layout, outline: Any) -> _Frame:
    """Return the frame of the smallest box around an outline, its front to the nearest street."""
    middle = shapely.get_coordinates(shapely.centroid(outline))[0]
    corner = shapely.get_coordinates(shapely.oriented_envelope(outline))[:3]
    way = corner[1] - corner[0]
    way = way / max(float(np.hypot(*way)), 1e-9)
    roads = layout.roads.geometry.to_numpy()[layout.roads["kind"].isin(DRIVABLE).to_numpy()]
    street = np.array([0.0, -1.0])
    if len(roads):
        nearest = roads[int(np.argmin(shapely.distance(roads, outline)))]
        street = shapely.get_coordinates(shapely.shortest_line(outline, nearest))
        street = street[1] - street[0]
    ways = [way, -way, np.array([-way[1], way[0]]), np.array([way[1], -way[0]])]
    # Away from the street is to the left of the front.
    along = max(ways, key=lambda one: round(float(np.dot([one[1], -one[0]], street)), 6))
    return _Frame(middle, along)
