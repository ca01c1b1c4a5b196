"""Ponds dug into parks that exist."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Any

import numpy as np
import shapely

from cityx.city import City
from cityx.city.layout import joined_tables, make_table
from cityx.edit.land.spots import CORNERS
from cityx.edit.objects.layer_rows import without_rows
from cityx.edit.renewal import renewed
from cityx.errors import UsageError
from cityx.geometry.polygons import region_of_corners
from cityx.ids import hash_ids, stable_id
from cityx.protocol import Choice, ObjectName, Points, Port, Range, Serves, action
from cityx.protocol.objects import find_objects
from cityx.town.ponds import BANK, GREENS, SIZES, dug

ACTION = "edit/pond-v1"
STANDING = ("trees", "park_pieces", "street_furniture", "street_pieces")


@action(
    ACTION,
    limits=[
        "A pond keeps clear of paths, trees and benches, so a park must have room for it.",
        "Where its place in the park is told, trees, benches and drawn paths make room for it.",
    ],
    requires=("layout",),
    takes=(Port("layout", "scene_layout"),),
    gives=(Port("layout", "scene_layout"),),
    serves=(
        *(
            Serves("edit=add", f"element={kind}", place)
            for kind in ("pond", "lake")
            for place in ("within", "ground")
        ),
    ),
    binds={"park": "within", "size": "size", "area": "area", "ground": "ground"},
    labels=("pond", "lake", "water in the park", "dig"),
)
def pond(
    city: City,
    *,
    park: Annotated[tuple[str, ...] | None, ObjectName()] = None,
    ground: Annotated[tuple[tuple[float, ...], ...] | None, Points(3, CORNERS)] = None,
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
    ground
        Corners of polygons in which its middle lies, in any green, where trees, benches and
        paths that no map has make room for it: x, y and which polygon.
    size
        How large it is, in a word.
    area
        Square metres; goes before the size.
    """
    wanted = area if area is not None else SIZES[size]
    areas = city.layout.areas
    rows = areas["kind"].isin(GREENS).to_numpy()
    about = region_of_corners(ground) if ground is not None else None
    if about is not None:
        rows = rows & shapely.intersects(areas.geometry.to_numpy(), about)
    if park is not None:
        rows = rows & np.isin(areas["id"].to_numpy(np.uint64), find_objects(city, park))
    said = ", ".join(park) if park is not None else "what lies there"
    if not rows.any() or (park is None and ground is None):
        raise UsageError(f"A pond is dug in a park, a garden or a lawn; {said} is none of them.")
    most = 0.0
    for place in np.flatnonzero(rows).tolist():
        key = int(areas["id"].iloc[place])
        green = areas.geometry.iloc[place]
        found, room = dug(
            city.layout, green, wanted, key, seed=city.seed, about=about,
            taken=_standing(city, green) if about is None else (),
        )  # fmt: skip
        most = max(most, room)
        if found is not None:
            return _flooded(city, found, key, cleared=about is not None)
    raise UsageError(
        f"A pond of {wanted:.0f} m2 has no room in {said}: between paths and trees "
        f"there are {most:.0f} m2 at most."
    )


def _standing(city: City, park: Any) -> list[Any]:
    """Return the ground of a park that paths and what stands there take."""
    found: list[Any] = []
    if city.ground is not None:  # paths that the map does not show are drawn into parks
        paths = city.ground.triangles_of("path", "trail", "sidewalk", "plaza")
        found += [*shapely.buffer(shapely.polygons(city.ground.vertices[paths]), BANK)]
    for layer in STANDING:
        rows = city.scene.instances.get(layer)
        if rows is not None:
            found += [*shapely.buffer(shapely.points(rows.position[:, :2]), BANK)]
    held = np.array(found, object)
    return list(held[shapely.intersects(held, park)]) if found else []


def _flooded(city: City, outline: Any, key: int, *, cleared: bool) -> City:
    """Lay out a pond and rebuild what depends on it; what stood in it may have to give way."""
    if cleared:
        shore = shapely.buffer(outline, BANK)
        for layer in STANDING:
            rows = city.scene.instances.get(layer)
            if rows is not None:
                wet = shapely.intersects_xy(shore, *rows.position[:, :2].T)
                scene = without_rows(city.scene, layer, rows.object_id[wet])
                city = replace(city, scene=scene)
    x, y = shapely.get_coordinates(outline.centroid)[0]
    number = stable_id(ACTION, key, round(x * 100), round(y * 100))
    own = hash_ids(0, ACTION, np.array([number], np.uint64))
    row = make_table("areas", [outline], id=own, source=[f"edit/pond/{number:016x}"],
                     kind=["water"], name=["pond"])  # fmt: skip
    areas = joined_tables(city.layout.areas, row)
    return renewed(city, replace(city.layout, areas=areas))
