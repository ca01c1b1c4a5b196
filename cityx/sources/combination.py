"""Several sources of one site: what they agree on once, and which wins where they do not."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city import City, Layout
from cityx.city.layout import CURVE
from cityx.city.sites import Box, cut, merged, moved, pieces_of
from cityx.errors import InputError

if TYPE_CHECKING:
    from geopandas import GeoDataFrame

SAME_GROUND = 0.1  # share of a building on the ground of another one or of a street: a conflict
NARROW = 6.0  # metres; whatever is built on a curve takes as much
SAME_WAY = 8.0  # metres within which two lines may be the same street
ALONG = 0.5  # share of a street that runs along others from which it is one of them
SAME_SPOT = 2.0  # metres within which two things of a kind are one


def combine(over: City, under: City, *, names: tuple[str, str], site: Box | None = None) -> City:
    """Put two cities of one site together; where they disagree, the first is kept.

    Parameters
    ----------
    over, under
        Cities with a layout.
    names
        What the two are called in notes: ("the map", "the image").
    site
        What is built of them, frame of `over`; the site of `over` when left out.

    Returns
    -------
    city
        `over` with what `under` adds within the site; a note counts each kind of conflict.

    Raises
    ------
    InputError
        If the two do not lie on the same ground.
    """
    layout = moved(under.layout, under.frame, over.frame)
    _check_same_ground(over.layout, layout, names)
    held = over.layout if site is None else cut(over.layout, site)
    layout = cut(layout, site or held.extent)
    conflicts = {
        "buildings": _on_ground(layout.buildings, held),
        "roads": _along(layout.roads, held.roads),
        "lines": _along(layout.lines, held.lines),
        "points": _on_spot(layout.points, held.points),
    }
    kept = {name: getattr(layout, name)[~conflict] for name, conflict in conflicts.items()}
    kept["parts"] = layout.parts[layout.parts["building"].isin(kept["buildings"]["id"])]
    kept["areas"] = _uncovered(layout.areas, held.areas)
    added = Layout(layout.extent, restrictions=layout.restrictions, **kept)
    notes = tuple(
        f"{names[1]}: {count} {name} lie where {names[0]} has some; those of {names[0]} were kept"
        for name, count in ((name, int(found.sum())) for name, found in conflicts.items())
        if count
    )
    return replace(
        over,
        layout=merged(added, held),
        attribution=tuple(dict.fromkeys((*over.attribution, *under.attribution))),
        failures=(*over.failures, *under.failures),
        notes=(*over.notes, *under.notes, *notes),
    )


def _check_same_ground(over: Layout, under: Layout, names: tuple[str, str]) -> None:
    first, second = shapely.box(*over.extent), shapely.box(*under.extent)
    if first.intersects(second):
        return
    away = shapely.distance(first, second) / 1000
    raise InputError(
        f"{names[0]} and {names[1]} do not lie on the same ground: {away:.1f} km are between them; "
        "give inputs of one place."
    )


def _on_ground(buildings: GeoDataFrame, held: Layout) -> NDArray[np.bool_]:
    """Return which buildings overlap another one or a carriageway."""
    roads = held.roads[~(held.roads["bridge"] | held.roads["tunnel"])]
    streets = shapely.buffer(
        roads.geometry.to_numpy(), roads["width"].to_numpy() / 2, cap_style="flat"
    )
    curves = held.lines.geometry.to_numpy()[held.lines["kind"] == CURVE]
    planned = shapely.buffer(curves, NARROW / 2, cap_style="flat")
    ground = np.concatenate([held.buildings.geometry.to_numpy(), streets, planned])
    shapes = buildings.geometry.to_numpy()
    row, other = shapely.STRtree(ground).query(shapes, predicate="intersects")
    shared = shapely.area(shapely.intersection(shapes[row], ground[other]))
    total = np.bincount(row, shared, minlength=len(shapes))
    return np.asarray(total > SAME_GROUND * shapely.area(shapes))


def _along(lines: GeoDataFrame, others: GeoDataFrame) -> NDArray[np.bool_]:
    """Return which lines run along others for more than half of their length."""
    shapes = lines.geometry.to_numpy()
    bands = shapely.buffer(others.geometry.to_numpy(), SAME_WAY, cap_style="flat")
    row, other = shapely.STRtree(bands).query(shapes, predicate="intersects")
    near = np.zeros(len(shapes))
    for index in np.unique(row).tolist():  # bands overlap, so their union is what counts
        band = shapely.union_all(bands[other[row == index]])
        near[index] = shapely.length(shapely.intersection(shapes[index], band))
    return np.asarray(near > ALONG * shapely.length(shapes))


def _on_spot(points: GeoDataFrame, others: GeoDataFrame) -> NDArray[np.bool_]:
    """Return which things stand where another one of their kind does."""
    found = np.zeros(len(points), bool)
    tree = shapely.STRtree(others.geometry.to_numpy())
    row, other = tree.query(points.geometry.to_numpy(), predicate="dwithin", distance=SAME_SPOT)
    same = points["kind"].to_numpy()[row] == others["kind"].to_numpy()[other]
    found[row[same]] = True
    return found


def _uncovered(areas: GeoDataFrame, others: GeoDataFrame) -> GeoDataFrame:
    """Take from areas what others cover."""
    if not len(others):
        return areas
    cover = shapely.union_all(shapely.make_valid(others.geometry.to_numpy()))
    return pieces_of(areas, shapely.difference(areas.geometry.to_numpy(), cover), 2)
