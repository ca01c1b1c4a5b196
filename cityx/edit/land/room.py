"""Room: find where things can stand, with the reason where they cannot."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.assets.furniture.animal_pieces import SWIMMERS
from cityx.city.city import City
from cityx.city.ground import ROADWAY, SURFACES
from cityx.city.rows import take_rows
from cityx.city.scene import Instances, Prototype
from cityx.edit.buildings.rebuilding import Ids
from cityx.errors import ActionFailed
from cityx.geometry.arrays import FloatArray
from cityx.ground.standing import stand_on
from cityx.ids import id_text

TRUNK = 0.3  # metres from the middle of a tree that nothing else may take
WALL = 0.1  # metres between a thing and a wall
FLAT = 0.15  # metres; what is lower lies in the ground, and others may stand on it
AFLOAT = ("water",)
ON_WHEELS = (*ROADWAY, "parking", "apron")
SEARCH, STEP = 20.0, 0.5  # metres around a place in which room is looked for, and how finely
LAYERS_OF_BUILDINGS = ("windows", "doors", "shopfronts", "trims", "roof_furniture")


@dataclass(frozen=True)
class Stand:
    """How a kind of thing stands.

    Attributes
    ----------
    size
        (width, depth) of its foot at scale 1, metres.
    kind
        "tree", "vehicle", "boat" or "" for all else.
    """

    size: tuple[float, float]
    kind: str = ""


def stand_of(prototype: Prototype) -> Stand:
    """Return how a prototype stands; only the trunk of a tree takes room."""
    if prototype.kind == "tree":
        return Stand((2 * TRUNK, 2 * TRUNK), "tree")
    wide, deep, _ = np.ptp(prototype.mesh.vertices, axis=0).tolist()
    swims = prototype.name.startswith("boat") or prototype.name in SWIMMERS
    kind = "boat" if swims else prototype.kind
    return Stand((wide, deep), kind if kind in ("vehicle", "boat") else "")


def feet(size: FloatArray, xy: FloatArray, yaw: FloatArray) -> NDArray[Any]:
    """Return the ground that things take: (n,) turned rectangles of (n, 2) sizes."""
    half = size / 2
    corner = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]], float)
    points = corner[None] * half[:, None]
    cos, sin = np.cos(yaw)[:, None], np.sin(yaw)[:, None]
    x = points[..., 0] * cos - points[..., 1] * sin + xy[:, None, 0]
    y = points[..., 0] * sin + points[..., 1] * cos + xy[:, None, 1]
    return np.asarray(shapely.polygons(np.stack([x, y], axis=-1)), object)


def faults(
    city: City, stand: Stand, xy: FloatArray, yaw: FloatArray, *, scale: float = 1.0, but: Ids
) -> list[str]:
    """Return why a thing cannot stand at n places, "" where it can.

    Parameters
    ----------
    city
        The city.
    stand
        How it stands.
    xy, yaw
        (n, 2) metres and (n,) radians.
    scale
        Of the thing.
    but
        Ids of what is not in the way: itself, where it is moved.
    """
    shapes = feet(np.tile(np.array(stand.size) * scale, (len(xy), 1)), xy, yaw)
    found = np.full(len(xy), "", object)
    for test in (_in_others, _on_surface, _in_buildings, _beyond):
        reason = test(city, stand, xy, shapes, but)
        found = np.where(reason != "", reason, found)
    return [str(text) for text in found]


def room_near(
    city: City, stand: Stand, at: FloatArray, yaw: float, *, scale: float = 1.0, but: Ids
) -> FloatArray | None:
    """Return the place nearest to another at which a thing can stand, (2,), None within reach."""
    steps = np.arange(-SEARCH, SEARCH + STEP, STEP)
    off = np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
    far = np.hypot(*off.T)
    order = np.lexsort((off[:, 0], off[:, 1], np.round(far, 6)))
    spots = at + off[order[far[order] <= SEARCH]]
    why = faults(city, stand, spots, np.full(len(spots), yaw), scale=scale, but=but)
    return next((spot for spot, text in zip(spots, why, strict=True) if not text), None)


def refuse(city: City, stand: Stand, at: FloatArray, yaw: float, why: str, *, but: Ids) -> None:
    """Refuse a place, and say where there would be room.

    Raises
    ------
    ActionFailed
        Always.
    """
    spot = room_near(city, stand, at, yaw, but=but)
    hint = "" if spot is None else f" There is room at {spot[0]:.1f}, {spot[1]:.1f}."
    raise ActionFailed(f"Nothing can stand at {at[0]:.1f}, {at[1]:.1f}: {why}.{hint}")


def _beyond(
    city: City, stand: Stand, xy: FloatArray, shapes: NDArray[Any], but: Ids
) -> NDArray[Any]:
    del stand, xy, but
    inside = shapely.covers(shapely.box(*city.layout.extent), shapes)
    return np.where(inside, "", "it lies beyond the site")


def _in_buildings(
    city: City, stand: Stand, xy: FloatArray, shapes: NDArray[Any], but: Ids
) -> NDArray[Any]:
    del stand, xy
    table = city.layout.buildings
    ids = table["id"].to_numpy(np.uint64)
    place, row = shapely.STRtree(table.geometry.to_numpy()).query(
        shapes, predicate="dwithin", distance=WALL
    )
    other = ~np.isin(ids[row], but)
    found = np.full(len(shapes), "", object)
    names = table["name"].to_numpy(str)
    for at, which in zip(place[other].tolist(), row[other].tolist(), strict=True):
        found[at] = f"building {names[which] or id_text(int(ids[which]))} stands there"
    return found


def _on_surface(
    city: City, stand: Stand, xy: FloatArray, shapes: NDArray[Any], but: Ids
) -> NDArray[Any]:
    """Look at the ground under the middle and the corners."""
    del but
    corners = shapely.get_coordinates(shapes).reshape(len(shapes), -1, 2)[:, :4]
    spots = np.concatenate([xy[:, None], corners], axis=1)
    label = stand_on(city.scene.meshes.get("ground"), spots.reshape(-1, 2)).label
    names = np.array([surface.name for surface in SURFACES])
    under = np.where(label >= 0, names[np.maximum(label, 0)], "").reshape(len(xy), -1)
    if stand.kind == "vehicle":
        good = np.isin(under[:, 0], ON_WHEELS)
        return np.where(good, "", "a vehicle stands on roadways and car parks")
    if stand.kind == "boat":
        return np.where(np.isin(under[:, 0], AFLOAT), "", "only water carries it")
    wet = np.isin(under, AFLOAT).any(axis=1)
    found = np.where(wet, "it is in the water", "").astype(object)
    return np.where(np.isin(under, ROADWAY).any(axis=1), "it is on the carriageway", found)


def _in_others(
    city: City, stand: Stand, xy: FloatArray, shapes: NDArray[Any], but: Ids
) -> NDArray[Any]:
    del stand
    found = np.full(len(shapes), "", object)
    bounds = np.array([*(xy.min(axis=0) - SEARCH), *(xy.max(axis=0) + SEARCH)])
    for layer, rows in city.scene.instances.items():
        if layer in LAYERS_OF_BUILDINGS:
            continue
        near = ((rows.position[:, :2] >= bounds[:2]) & (rows.position[:, :2] <= bounds[2:])).all(1)
        near &= ~np.isin(rows.object_id, but) & ~(np.isin(rows.owner, but) & (rows.owner > 0))
        near &= rows.owner == 0
        others = take_rows(rows, np.flatnonzero(near))
        taken, kept = _feet_of_rows(others, city.scene.prototypes)
        place, row = shapely.STRtree(taken).query(shapes, predicate="intersects")
        for at, which in zip(place.tolist(), row.tolist(), strict=True):
            name = city.scene.prototypes[int(others.prototype[kept[which]])].name
            found[at] = f"a {name.replace('_', ' ')} stands there"
    return found


def _feet_of_rows(
    rows: Instances, prototypes: tuple[Prototype, ...]
) -> tuple[NDArray[Any], NDArray[np.int64]]:
    """Return the ground that instances take, of those that are not flat, and their rows."""
    size = np.zeros((len(prototypes) + 1, 2))
    tall = np.zeros(len(prototypes) + 1)
    for at in np.unique(rows.prototype).tolist():
        size[at] = stand_of(prototypes[at]).size
        tall[at] = prototypes[at].mesh.vertices[:, 2].max()
    kept = np.flatnonzero(tall[rows.prototype] * rows.scale[:, 2] > FLAT)
    own = take_rows(rows, kept)
    scaled = size[own.prototype] * own.scale[:, :2].astype(float)
    yaw = own.rotation[:, 2].astype(float)
    return feet(scaled, own.position[:, :2], yaw), kept
