"""Places where people stay: the ground of what a sentence names, seats, and land in parks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely

from cityx.city import City
from cityx.edit.land.spots import MARGIN
from cityx.errors import ActionFailed
from cityx.geometry.arrays import BoolArray, FloatArray
from cityx.geometry.polygons import region_of_corners
from cityx.protocol.objects import find_objects

AT = 7.0  # metres from a stop, a bench or a door to who is at it
BESIDE = 9.0  # metres from the middle of a street to who is on its walks
PARKS = ("park", "grass", "meadow", "courtyard", "playground", "pitch", "sand")


@dataclass(frozen=True)
class Spots:
    """Where n people are: (n, 2) metres, and (n,) radians of where they face."""

    xy: FloatArray
    heading: FloatArray


Corners = tuple[tuple[float, ...], ...]  # of ground, as of `corners_of`


def ground_of(
    city: City,
    names: Sequence[str] | None,
    corners: Corners | None = None,
    *,
    around: float = AT,
    beside: float = BESIDE,
) -> Any:
    """Return the ground of areas, that beside streets and that around other objects; all of it.

    Parameters
    ----------
    city, names
        The city, and the objects; None for the whole site.
    corners
        Of more ground, such as that of a junction.
    around
        Metres from buildings and things that count as at them.
    beside
        Metres from the middle of streets that count as at them.

    Raises
    ------
    ActionFailed
        If there is none.
    """
    layout = city.layout
    if names is None and corners is None:
        return shapely.box(*layout.extent)
    ids = find_objects(city, names or ())
    shapes: list[Any] = [] if corners is None else [region_of_corners(corners)]
    for name, table in (("areas", layout.areas), ("roads", layout.roads),
                        ("buildings", layout.buildings), ("points", layout.points)):  # fmt: skip
        own = table.geometry.to_numpy()[np.isin(table["id"].to_numpy(np.uint64), ids)]
        if name == "areas":
            inner = shapely.buffer(own, -MARGIN)
            shapes += np.where(shapely.is_empty(inner), own, inner).tolist()
        elif name == "roads":
            shapes += shapely.buffer(own, beside).tolist()
        else:
            shapes += shapely.buffer(own, around).tolist()
    for rows in city.scene.instances.values():
        at = shapely.points(rows.position[np.isin(rows.object_id, ids), :2])
        shapes += shapely.buffer(at, around).tolist()
    if not shapes:
        said = f'"{", ".join(names)}"' if names else "What is named"
        raise ActionFailed(f"{said} has no ground: no building, street, area or thing of the city.")
    whole = shapely.union_all(shapely.make_valid(np.array(shapes, object)))
    return shapely.intersection(whole, shapely.box(*layout.extent))


def parks_at(city: City, xy: FloatArray) -> BoolArray:
    """(n,) which places are on land that people stay on beside the ways: lawns, playgrounds."""
    if city.ground is None:
        return np.zeros(len(xy), bool)
    return np.asarray(city.ground.on(xy, *PARKS))


def benches_near(
    city: City, place: Any, count: int, *, seat: float, back: float, taken: FloatArray
) -> Spots:
    """Find seats on the benches of a ground, none of them taken.

    Parameters
    ----------
    city, place
        The city, and the ground.
    count
        People.
    seat, back
        Metres of a bench that one takes, and from the middle of a seat to the pelvis.
    taken
        (k, 2) where somebody is already.

    Raises
    ------
    ActionFailed
        If there are fewer.
    """
    spots, headings = [np.zeros((0, 2))], [np.zeros(0)]
    prototypes = city.scene.prototypes
    benches = [one.name.split("_")[0] == "bench" for one in prototypes] or [False]
    for rows in city.scene.instances.values():
        for at in np.flatnonzero(np.array(benches)[rows.prototype]).tolist():
            if not shapely.intersects_xy(place, *rows.position[at, :2]):
                continue
            shape = prototypes[int(rows.prototype[at])].mesh.vertices
            wide = float(np.ptp(shape[:, 0])) * float(rows.scale[at, 0])
            number = max(int((wide - 0.2) / seat), 1)
            x = (np.arange(number) - (number - 1) / 2) * seat
            turn = float(rows.rotation[at, 2])
            c, s = np.cos(turn), np.sin(turn)
            local = np.column_stack([x, np.full(number, back)])
            spots.append(rows.position[at, :2] + local @ np.array([[c, s], [-s, c]]))
            headings.append(np.full(number, turn - np.pi / 2))
    xy, heading = np.concatenate(spots), np.concatenate(headings)
    if len(taken) and len(xy):
        free = shapely.distance(shapely.points(xy), shapely.multipoints(taken)) > seat / 2
        xy, heading = xy[free], heading[free]
    if len(xy) < count:
        raise ActionFailed(f"The benches there have {len(xy)} free seats, {count} are asked for.")
    order = np.lexsort((xy[:, 1], xy[:, 0]))
    order = order[np.argsort(np.arange(len(xy)) % 3, kind="stable")]
    return Spots(xy[order[:count]], heading[order[:count]])
