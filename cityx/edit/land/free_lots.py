"""Free lots: places in a city that exists where something new stands, and what is built there."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.building.design import design
from cityx.city import City, Layout
from cityx.city.rows import without_objects
from cityx.edit.buildings.rebuilding import Ids, rebuilt
from cityx.edit.renewal import renewed
from cityx.errors import ActionFailed
from cityx.geometry.polygons import region_of_corners
from cityx.geometry.turns import SIDES
from cityx.protocol.objects import find_objects
from cityx.town.elements import GROUNDS, Element
from cityx.town.lots import (
    Lot,
    body_of,
    cheapest,
    lot_of,
    lots_along_streets,
    lots_on_shore,
    lots_on_squares,
    plans_of,
)
from cityx.town.rebuilding import cleared, without_buildings
from cityx.town.wishes.elements import drawn

BY = 60.0  # metres from something to a lot that is near it
AROUND = 15.0  # metres from a street to a lot along it
EDGE = 0.25  # of the shorter side of the site, within which something is at its edge


class Place:
    """Which of some lots lie where they are to, and which of them best."""

    def __init__(
        self, city: City, near: tuple[str, ...] | None, along: tuple[str, ...] | None,
        beyond: tuple[str, ...] | None, ground: Any, side: str | None,
    ) -> None:  # fmt: skip
        self.side = side if beyond is None else None
        self.squares: tuple[str, ...] = ()
        self.about: Any = None
        self.anywhere = all(one is None for one in (near, along, beyond, ground, self.side))
        self._kept: list[Callable[[NDArray[Any]], NDArray[np.bool_]]] = []
        if near is not None:
            shapes, amid = grounds_of(city, near)
            self.squares = amid
            region = shapely.union_all(shapes)
            self._kept.append(lambda plans: shapely.distance(plans, region) <= (0 if amid else BY))
        if along is not None:
            lines = shapely.union_all(grounds_of(city, along)[0])
            self._kept.append(lambda plans: shapely.distance(plans, lines) <= AROUND)
        if ground is not None:
            held = region_of_corners(ground)
            self.squares, self.about = self.squares or _squares_at(city, held), held
            self._kept.append(lambda plans: shapely.intersects(plans, held))
        if beyond is not None:
            other = shapely.union_all(grounds_of(city, beyond)[0])
            self._kept.append(lambda plans: _beyond(plans, other, side or "south"))
        if self.side is not None:
            self._kept.append(lambda plans: _on_side(plans, city.layout, str(self.side)))

    def among(self, lots: list[Lot], element: Element) -> list[Lot]:
        """Return the lots whose element lies there."""
        if not lots:
            return lots
        bodies = plans_of(lots, body_of(element))
        good = np.ones(len(lots), bool)
        for kept in self._kept:
            good &= kept(bodies)
        return [lots[at] for at in np.flatnonzero(good).tolist()]


def grounds_of(city: City, names: tuple[str, ...]) -> tuple[NDArray[Any], tuple[str, ...]]:
    """Return the ground of objects, and the kinds of places that they are where all are such."""
    ids = find_objects(city, names)
    layout = city.layout
    found: list[Any] = []
    for name in ("areas", "buildings", "points"):
        table = getattr(layout, name)
        found += table.geometry.to_numpy()[np.isin(table["id"].to_numpy(np.uint64), ids)].tolist()
    roads = layout.roads
    mine = np.isin(roads["id"].to_numpy(np.uint64), ids)
    walks = roads[["sidewalk_left", "sidewalk_right"]].max(axis=1).to_numpy()[mine]
    half = np.nan_to_num(roads["width"].to_numpy(float)[mine]) / 2 + walks
    found += shapely.buffer(roads.geometry.to_numpy()[mine], half).tolist()
    for rows in city.scene.instances.values():
        at = rows.position[np.isin(rows.object_id, ids), :2]
        found += shapely.points(at).tolist()
    if not found:
        raise ActionFailed("What it is to be near has no ground.")
    land = np.isin(layout.areas["id"].to_numpy(np.uint64), ids)
    amid = ("plaza", "park") if land.sum() == len(found) else ()
    return shapely.make_valid(np.array(found, object)), amid


def _squares_at(city: City, region: Any) -> tuple[str, ...]:
    """Return the kinds of places in which a region lies, () where it lies beyond them."""
    areas = city.layout.areas
    shapes = areas.geometry.to_numpy()
    found = [
        kind for kind, own in (("plaza", ("pedestrian", "plaza")), ("park", ("park",)))
        if _mostly_in(region, shapes[areas["kind"].isin(own).to_numpy()])
    ]  # fmt: skip
    return tuple(found)


def _mostly_in(region: Any, shapes: NDArray[Any]) -> bool:
    near = shapes[shapely.intersects(shapes, region)]
    inside = shapely.area(shapely.intersection(shapely.union_all(near), region))
    return bool(inside > MOSTLY * region.area)


MOSTLY = 0.5  # of the ground that is told, beyond which it lies in a park or a square


def _beyond(plans: NDArray[Any], other: Any, side: str) -> NDArray[np.bool_]:
    way = np.array(SIDES[side])
    off = shapely.get_coordinates(shapely.centroid(plans)) - shapely.get_coordinates(other.centroid)
    ahead = (off @ way) / (np.hypot(*off.T) * np.hypot(*way)).clip(1e-9)
    near = shapely.distance(plans, other) <= BY
    return np.asarray(near & (ahead >= np.cos(np.radians(45.0))))


def _on_side(plans: NDArray[Any], layout: Layout, side: str) -> NDArray[np.bool_]:
    xmin, ymin, xmax, ymax = layout.extent
    shorter, site = min(xmax - xmin, ymax - ymin), shapely.box(*layout.extent)
    if side in SIDES:
        middle = np.array([(xmin + xmax) / 2, (ymin + ymax) / 2])
        off = (shapely.get_coordinates(shapely.centroid(plans)) - middle) * np.array(SIDES[side])
        return np.asarray((off >= 0).all(axis=1))
    whole = site.exterior if side == "edge" else site.centroid
    return np.asarray(shapely.distance(plans, whole) <= EDGE * shorter)


def with_one(city: City, element: Element, where: Place) -> City:
    """Build one element on the lot that suits best, of those that take no house."""
    layout = city.layout
    houses = shapely.STRtree(layout.buildings.geometry.to_numpy())

    def fits(lots: list[Lot]) -> list[Lot]:
        lots = where.among(lots, element)
        plans = plans_of(lots, lot_of(element))
        taken = houses.query(plans, predicate="intersects")[0] if lots else []
        return [lots[at] for at in np.setdiff1d(np.arange(len(lots)), taken).tolist()]

    lots: list[Lot] = []
    if element.where in ("shore", "water"):
        lots = fits(lots_on_shore(layout, element))
    else:
        grounds = GROUNDS.get(element.where, ()) if where.anywhere else ()
        if where.squares or grounds:
            lots = fits([
                lot for kind in where.squares or grounds
                for lot in lots_on_squares(city, element, (kind,), where.about)
            ])  # fmt: skip
        if not lots and element.where != "afloat":
            lots = lots_along_streets(layout, element, fits)
    if not lots:
        width, depth = (element.least * size for size in element.lot)
        there = "" if where.anywhere else " there"
        raise ActionFailed(
            f"No lot is free{there} for a {element.name.replace('_', ' ')}, which takes "
            f"{width:.0f} m by {depth:.0f} m; say what is to make room for it, as in: replace b03 "
            "with it."
        )
    lot = cheapest(lots, layout, element, where.side or element.where)
    return placed(city, element, lot)


def placed(
    city: City, element: Element, lot: Lot, gone: Ids | None = None, was: Layout | None = None
) -> City:
    """Return a city with an element on a lot, and without the buildings that are to go.

    Its other land may have changed from what it `was`.
    """
    layout = city.layout
    known = layout.buildings["id"].to_numpy(np.uint64)
    if gone is not None:
        layout = without_buildings(layout, np.flatnonzero(np.isin(known, gone)))
    plan = lot.placed(lot_of(element))
    if element.where not in ("water", "afloat"):
        layout = cleared(layout, plan)
    made = drawn(city, layout, element, lot)
    fresh = np.setdiff1d(made.buildings["id"].to_numpy(np.uint64), known)
    made = _designed(replace(city, layout=made), fresh)
    lost = np.setdiff1d(known, made.buildings["id"].to_numpy(np.uint64))
    city = city if was is None else replace(city, layout=was)
    city = renewed(_without(city, lost, plan), made)
    return rebuilt(city, np.union1d(fresh, lost))


def _without(city: City, lost: Ids, plan: Any) -> City:
    """Take buildings away, and what stands about on a lot."""
    city = replace(city, scene=without_objects(city.scene, lost.tolist())) if len(lost) else city
    shapely.prepare(plan)
    gone: list[int] = []
    kinds = np.array([one.kind for one in city.scene.prototypes] or [""])
    for rows in city.scene.instances.values():
        loose = (rows.owner == 0) & ~np.isin(kinds[rows.prototype], ("vehicle", "pedestrian"))
        x, y = rows.position[:, :2].T
        gone += rows.object_id[loose & shapely.intersects_xy(plan, x, y)].tolist()
    return replace(city, scene=without_objects(city.scene, gone)) if gone else city


def _designed(city: City, fresh: Ids) -> Layout:
    """Return the layout with volumes and roofs for new buildings; all others stay as they are."""
    layout = city.layout
    if not len(fresh):
        return layout
    found = design(city).layout
    tables = {}
    for name, column in (("buildings", "id"), ("parts", "building")):
        was, now = getattr(layout, name), getattr(found, name)
        old = ~np.isin(was[column].to_numpy(np.uint64), fresh)
        new = np.isin(now[column].to_numpy(np.uint64), fresh)
        tables[name] = _joined(was[old], now[new])
    return replace(layout, **tables)


def _joined(first: Any, second: Any) -> Any:
    import pandas as pd

    both = pd.concat([first, second], ignore_index=True)
    return both.sort_values("id", kind="stable").reset_index(drop=True)
