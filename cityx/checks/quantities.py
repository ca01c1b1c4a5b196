"""Quantities of a layout that wishes are about, by their expressions."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city import City

GREEN = ("park", "garden", "grass", "meadow", "wood", "scrub", "orchard", "cemetery", "golf")


def _houses(city: City) -> NDArray[Any]:
    return np.asarray(city.layout.buildings.geometry.to_numpy())


def _land(city: City, *kinds: str) -> NDArray[Any]:
    table = city.layout.areas
    return np.asarray(table.geometry.to_numpy()[table["kind"].isin(kinds).to_numpy()])


def _cover(city: City, shapes: NDArray[Any]) -> float:
    site = shapely.box(*city.layout.extent)
    return float(shapely.union_all(shapely.intersection(shapes, site)).area / site.area)


def _column(city: City, name: str) -> NDArray[np.float64]:
    return np.asarray(city.layout.buildings[name].to_numpy(), float)


def _river_width(city: City) -> float:
    """Return the mean width of rivers: of a strip as long as half its border."""
    water = shapely.union_all(_land(city, "river"))
    half = water.length / 2
    # width + length = half the border, width * length = the area
    return float((half - np.sqrt(max(half**2 - 4 * water.area, 0.0))) / 2)


def _spanned(city: City, axis: int) -> float:
    """Return the share of the site's size that the longest primary road spans."""
    roads = city.layout.roads
    box = shapely.bounds(roads.geometry.to_numpy()[(roads["kind"] == "primary").to_numpy()])
    low, high = np.array(city.layout.extent).reshape(2, 2)
    reach = box[:, 2 + axis] - box[:, axis]
    return float(reach.max(initial=0.0) / (high[axis] - low[axis]))


def _lakes_in_parks(city: City) -> float:
    parks = shapely.buffer(shapely.union_all(_land(city, "park")), 0.1)
    return float(shapely.within(_land(city, "water"), parks).sum())


def _to_middle(city: City, *kinds: str) -> float:
    """Return the metres from the middle of the site to the nearest land of some kinds."""
    found = shapely.distance(_land(city, *kinds), shapely.box(*city.layout.extent).centroid)
    return float(found.min(initial=np.inf))


QUANTITIES: Mapping[str, Callable[[City], float]] = {
    "n(building)": lambda city: len(city.layout.buildings),
    "stat(building, floors, max)": lambda city: _column(city, "levels").max(initial=0),
    "stat(building, floors, min)": lambda city: _column(city, "levels").min(initial=999),
    "stat(building, height, max)": lambda city: _column(city, "height").max(initial=0),
    "stat(building, height, min)": lambda city: _column(city, "height").min(initial=9999),
    "cover(building)": lambda city: _cover(city, _houses(city)),
    "cover(green)": lambda city: _cover(city, _land(city, *GREEN)),
    "dist(plaza, center)": lambda city: _to_middle(city, "pedestrian"),
    "dist(park, center)": lambda city: _to_middle(city, "park"),
    "dist(lake, center)": lambda city: _to_middle(city, "water"),
    "n(bridge)": lambda city: int(city.layout.roads["bridge"].sum()),
    "n(park)": lambda city: len(_land(city, "park")),
    "n(lake, in=park)": _lakes_in_parks,
    "n(sea)": lambda city: len(_land(city, "sea")),
    "n(beach)": lambda city: len(_land(city, "sand")),
    "stat(river, width, mean)": _river_width,
    "spans(road, class=primary, dir=x)": lambda city: _spanned(city, 0),
    "spans(road, class=primary, dir=y)": lambda city: _spanned(city, 1),
}
