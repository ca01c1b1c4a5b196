"""Moving land: a pond, a playground, a lawn at another place."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city import City
from cityx.edit.renewal import renewed
from cityx.errors import ActionFailed
from cityx.geometry.arrays import FloatArray
from cityx.protocol import ObjectName, Port, Range, action
from cityx.protocol.objects import find_objects
from cityx.protocol.serving import Serves

FURTHEST = 100_000.0  # metres; nothing is moved farther than a city is large
STEP = 2.0  # metres between the places that are tried
CLEAR = 1.0  # metres from houses and streets to land that is moved
SETTLE = 40.0  # metres from where it is to lie, within which room is looked for


@action(
    "edit/move_land-v1",
    limits=["Land keeps off houses and streets; trees and benches in its way are gone."],
    requires=("layout",),
    takes=(Port("layout", "scene_layout"),),
    gives=(Port("layout", "scene_layout"),),
    serves=(Serves("edit=move", "offset", "family=land"),),
    binds={"objects": "objects", "offset": "offset"},
    labels=("move", "pond", "lake", "playground"),
)
def move_land(
    city: City,
    *,
    objects: Annotated[tuple[str, ...], ObjectName()],
    offset: Annotated[tuple[float, float], Range(-FURTHEST, FURTHEST)],
) -> City:
    """Move areas as they are, to the nearest place with room, and rebuild the ground.

    Parameters
    ----------
    city
        The city.
    objects
        Areas: ponds, playgrounds, lawns.
    offset
        Metres to the east and to the north.
    """
    areas = city.layout.areas
    rows = np.flatnonzero(np.isin(areas["id"].to_numpy(np.uint64), find_objects(city, objects)))
    if not len(rows):
        raise ActionFailed(f"{', '.join(objects[:4])} is no land that can be moved.")
    shapes = areas.geometry.to_numpy().copy()
    own = shapely.union_all(shapes[rows])
    way = _free(city, own, np.asarray(offset, float))
    for row in rows.tolist():
        shapes[row] = shapely.transform(shapes[row], lambda points: np.round(points + way, 3))
    return renewed(city, replace(city.layout, areas=areas.set_geometry(shapes)))


def _free(city: City, shape: Any, offset: FloatArray) -> FloatArray:
    """Return the way nearest to one that is wanted, at whose end there is room.

    On land that holds it whole it stays whole.

    Raises
    ------
    ActionFailed
        If there is none.
    """
    layout = city.layout
    half = np.nan_to_num(layout.roads["width"].to_numpy(float)) / 2 + CLEAR
    taken = np.concatenate([
        shapely.buffer(layout.buildings.geometry.to_numpy(), CLEAR),
        shapely.buffer(layout.roads.geometry.to_numpy(), half),
    ])  # fmt: skip
    tree, site = shapely.STRtree(taken), shapely.box(*layout.extent)
    holders = _holders(layout.areas.geometry.to_numpy(), shape)
    steps = np.arange(-SETTLE, SETTLE + STEP, STEP)
    off = np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
    far = np.hypot(*off.T)
    order = np.lexsort((off[:, 0], off[:, 1], np.round(far, 6)))
    for step in off[order[: int((far <= SETTLE).sum())]]:
        moved = shapely.transform(shape, lambda points, s=step: points + offset + s)
        held = all(shapely.covers(holder, moved) for holder in holders)
        if held and site.covers(moved) and not len(tree.query(moved, predicate="intersects")):
            return np.asarray(offset + step)
    raise ActionFailed(
        f"There is no room within {SETTLE:g} m of where it is to lie, clear of houses and streets."
    )


def _holders(areas: NDArray[Any], shape: Any) -> list[Any]:
    """Return the areas that hold a shape whole, as a park does its pond: the smallest of them."""
    filled = np.array([shapely.Polygon(part.exterior) for area in areas
                       for part in shapely.get_parts(area)], object)  # fmt: skip
    around = [one for one in filled[shapely.contains(filled, shapely.buffer(shape, -0.1))]
              if one.area > 1.5 * shape.area]  # fmt: skip
    return sorted(around, key=lambda one: round(one.area, 2))[:1]
