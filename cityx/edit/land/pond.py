"""Ponds dug into parks that exist."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city import City
from cityx.city.layout import joined_tables, make_table
from cityx.edit.renewal import renewed
from cityx.errors import UsageError
from cityx.ids import hash_ids, stable_id, uniform
from cityx.protocol import Choice, ObjectName, Port, Range, Serves, action
from cityx.protocol.objects import find_objects

ACTION = "edit/pond-v1"
GREENS = ("park", "garden", "grass", "meadow", "golf", "cemetery")
SIZES = {"small": 330.0, "medium": 600.0, "large": 1500.0}  # square metres
BANK = 1.5  # metres of lawn between the water and paths, trunks, walls and the edge of the park
LOBES, CORNERS = 3, 48  # of the outline of a pond
UNEVEN = 0.10  # of its radius, by which each lobe goes in and out
STEP = 2.0  # metres between the middles that are tried
STANDING = ("trees", "park_pieces", "street_furniture", "street_pieces")


@action(
    ACTION,
    limits=["A pond keeps clear of paths, trees and benches, so a park must have room for it."],
    requires=("layout",),
    takes=(Port("layout", "scene_layout"),),
    gives=(Port("layout", "scene_layout"),),
    serves=(
        Serves("edit=add", "element=pond", "within"),
        Serves("edit=add", "element=lake", "within"),
    ),
    binds={"park": "within", "size": "size", "area": "area"},
    labels=("pond", "lake", "water in the park", "dig"),
)
def pond(
    city: City,
    *,
    park: Annotated[tuple[str, ...], ObjectName()],
    size: Annotated[str, Choice(*SIZES)] = "medium",
    area: Annotated[float | None, Range(30.0, 200_000.0)] = None,
) -> City:
    """Dig a pond where a park has room for it and rebuild its ground; all else stays.

    Parameters
    ----------
    city
        City with the park.
    park
        Parks, gardens or lawns, the first of which that has room gets the pond.
    size
        How large it is, in a word.
    area
        Square metres; goes before the size.
    """
    wanted = area if area is not None else SIZES[size]
    areas = city.layout.areas
    rows = np.isin(areas["id"].to_numpy(np.uint64), find_objects(city, park))
    rows &= areas["kind"].isin(GREENS).to_numpy()
    if not rows.any():
        raise UsageError(
            f"A pond is dug in a park, a garden or a lawn; {', '.join(park)} is none of them."
        )
    most = 0.0
    for place in np.flatnonzero(rows).tolist():
        key = int(areas["id"].iloc[place])
        found, room = _dug(city, areas.geometry.iloc[place], wanted, key)
        most = max(most, room)
        if found is not None:
            return _flooded(city, found, key)
    raise UsageError(
        f"A pond of {wanted:.0f} m2 has no room in {', '.join(park)}: between paths and trees "
        f"there are {most:.0f} m2 at most."
    )


def _dug(city: City, park: Any, wanted: float, key: int) -> tuple[Any, float]:
    """Return the outline of a pond where there is most room, or None, and how large one may be."""
    free = shapely.difference(park, shapely.union_all(_taken(city, park)))
    low, high = np.array(shapely.bounds(free)[:2]), np.array(shapely.bounds(free)[2:])
    x, y = (np.arange(a, b, STEP) for a, b in zip(low, high, strict=True))
    at = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
    spots = shapely.points(at)
    inside = shapely.contains(free, spots) if len(spots) else np.zeros(0, bool)
    if not inside.any():
        return None, 0.0
    reach = np.where(inside, shapely.distance(shapely.boundary(free), spots), 0.0)
    best = int(np.argmax(np.round(reach, 3)))
    radius = float(np.sqrt(wanted / np.pi))
    most = float(np.pi * (reach[best] / (1 + UNEVEN)) ** 2)
    if wanted > most:
        return None, most
    return _outline(at[best], radius, city.seed, key), most


def _taken(city: City, park: Any) -> list[Any]:
    """Return the ground of a park that a pond keeps clear of."""
    roads = city.layout.roads
    half = np.nan_to_num(roads["width"].to_numpy(float), nan=2.0) / 2
    near = shapely.dwithin(roads.geometry.to_numpy(), park, float(half.max(initial=0.0)))
    found = [*shapely.buffer(roads.geometry.to_numpy()[near], half[near] + BANK)]
    found += [*shapely.buffer(city.layout.buildings.geometry.to_numpy(), BANK)]
    if city.ground is not None:  # paths that the map does not show are drawn into parks
        paths = city.ground.triangles_of("path", "trail", "sidewalk", "plaza")
        found += [*shapely.buffer(shapely.polygons(city.ground.vertices[paths]), BANK)]
    for layer in STANDING:
        rows = city.scene.instances.get(layer)
        if rows is not None:
            found += [*shapely.buffer(shapely.points(rows.position[:, :2]), BANK)]
    held = np.array([shapely.buffer(shapely.boundary(park), BANK), *found], object)
    return list(held[shapely.intersects(held, park)])


def _outline(middle: NDArray[np.float64], radius: float, seed: int, key: int) -> Any:
    """Return a rounded outline of a pond, of the area of a circle."""
    angle = np.arange(CORNERS) * (2 * np.pi / CORNERS)
    lobe = np.arange(2, 2 + LOBES)
    phase = 2 * np.pi * uniform(seed, ACTION, np.full(LOBES, key, np.uint64), lobe)
    wave = np.sin(lobe[:, None] * angle + phase[:, None]).sum(axis=0) * (UNEVEN / LOBES)
    ring = middle + (radius * (1 + wave))[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    return shapely.Polygon(np.round(ring, 3))


def _flooded(city: City, outline: Any, key: int) -> City:
    """Lay out a pond and rebuild what depends on it."""
    x, y = shapely.get_coordinates(outline.centroid)[0]
    number = stable_id(ACTION, key, round(x * 100), round(y * 100))
    own = hash_ids(0, ACTION, np.array([number], np.uint64))
    row = make_table("areas", [outline], id=own, source=[f"edit/pond/{number:016x}"],
                     kind=["water"], name=["pond"])  # fmt: skip
    areas = joined_tables(city.layout.areas, row)
    return renewed(city, replace(city.layout, areas=areas))
