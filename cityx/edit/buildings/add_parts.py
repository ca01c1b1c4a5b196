"""Adding parts to buildings: solar panels, antennas, chimneys, flower boxes, awnings, balconies."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Annotated

import numpy as np
import shapely

from cityx.assets.fixtures import fixture
from cityx.assets.shops.shopfronts import fitting
from cityx.assets.styles.palettes import owner_rows
from cityx.assets.trims.roof_furniture import roof_furniture
from cityx.assets.trims.trims import trim
from cityx.building.splicing import with_rows
from cityx.checks.predicates.body_parts import body_parts
from cityx.checks.predicates.measuring import rows_of
from cityx.checks.predicates.words import PARTS as KNOWN
from cityx.city import City
from cityx.city.levels import ground_levels
from cityx.city.rows import leave_rows, take_rows
from cityx.city.scene import Instances, Prototype
from cityx.edit.buildings.roof_planes import Plane, planes_of, ridge_of
from cityx.edit.targets import buildings_named
from cityx.errors import ActionFailed
from cityx.geometry.arrays import FloatArray
from cityx.geometry.turns import SIDES
from cityx.ids import UInt64Array, id_text, stable_id
from cityx.protocol import Choice, ObjectName, Port, Range, action
from cityx.town.part_kinds import HOSTS

ACTION = "edit/add_parts-v1"
LAYER = "added_parts"
FOUR = ("north", "east", "south", "west")
PARTS = ("solar", "antenna", "dish", "chimney", "flower_box", "awning", "balcony", "clock")
ANY = "building"
DIAL, BELOW, OUT_OF_WALL = 2.2, 2.6, 0.04  # metres of a clock; from an eave; before a wall
LEAST_DIAL = 1.1  # metres
ENTRANCE = 3.4  # metres above the ground from which a clock hangs
SOLAR, FLAT = (3.5, 3.1), 0.985  # metres of panels; vertical part of the normal of a flat roof
SIZES = (1.0, 0.66)  # of panels, the smaller on small roofs
ARRAYS = 4  # groups of panels on one roof, at most
EDGE = 0.35  # metres of a roof that stay free along its edges
SUNK = 2.2  # metres of a chimney below the ridge
WINDOW = 1.16  # metres of a window as it is drawn, whatever its scale
BOX = 1.1  # metres of a flower box as it is drawn
OUT, WIDE = 2.4, 0.7  # metres of a balcony as it is drawn, and beyond its window
SILL = 0.85  # metres from the floor to the sill of a window, by which one becomes a door
UPPER = 2.4  # metres above the ground from which a window is upstairs
APART = 3.1  # metres between the middles of balconies beside each other
UPRIGHT = 0.05  # radians by which a window on a wall may lean
SAME = 0.06  # metres from a window to its sill and to the balcony before it
REACH = 1.4  # metres in front of a wall that a balcony takes


@dataclass(frozen=True)
class Part:
    """A part where it is put.

    Attributes
    ----------
    prototype
        Its form.
    owner
        Id of the building.
    position, rotation, scale
        (3,) each: metres, radians, factors.
    """

    prototype: Prototype
    owner: int
    position: FloatArray
    rotation: FloatArray
    scale: FloatArray


@action(
    ACTION,
    limits=[
        "Buildings on which a part finds no room stay without; which is told in a note.",
        "Behind balconies windows become as high as doors.",
    ],
    takes=(Port("object", "complex_geometry"),),
    gives=(Port("object", "complex_geometry"),),
    labels=("solar panels", "balconies", "awnings", "flower boxes", "chimneys", "antennas"),
    serves=("edit=add_parts",),
    binds={"objects": "objects", "part": "part", "tint": "part.tint", "facing": "facing"},
)
def add_parts(
    city: City,
    *,
    part: Annotated[str, Choice(*PARTS)],
    objects: Annotated[tuple[str, ...] | None, ObjectName()] = None,
    kind: Annotated[str, Choice(ANY, *HOSTS)] = ANY,
    tint: Annotated[tuple[float, float, float] | None, Range(0.0, 1.0)] = None,
    facing: Annotated[str | None, Choice(*FOUR)] = None,
) -> City:
    """Add parts to buildings, as many as each has room for.

    Parameters
    ----------
    city
        The city.
    part
        Which.
    objects
        The buildings; all of them when left out.
    kind
        Kind of buildings that get them, where none are named.
    tint
        Linear red, green and blue of what takes a colour, such as the cloth of awnings.
    facing
        Side to which roofs slope that get solar panels; the sunniest of each when left out.
    """
    if facing is not None and part != "solar":
        raise ActionFailed(f"A {part} is not put on roofs by the side that they slope to.")
    ids = city.layout.buildings["id"].to_numpy(np.uint64)
    chosen = ids if objects is None else buildings_named(city, objects)
    if objects is None and kind != ANY:
        chosen = ids[rows_of(HOSTS[kind], city)]
    made = _solar(city, chosen, facing) if part == "solar" else _MAKERS[part](city, chosen)
    found = list(made)
    had = _having(city, part)
    if not found and not np.isin(chosen, had).any():
        raise ActionFailed(f"None of the {len(chosen)} buildings has room for a {part}.")
    if objects is None and kind != ANY and tint is not None:
        city = _repainted(city, chosen, part, tint)
    if not found:
        return city
    with_part = {one.owner for one in found} | set(had.tolist())
    bare = [one for one in chosen.tolist() if one not in with_part]
    city = _opened(city, found) if part == "balcony" else city
    notes = city.notes
    if bare:
        shown = ", ".join(map(id_text, bare[:3]))
        notes += (f"{part}: {len(bare)} of {len(chosen)} buildings have no room ({shown})",)
    return replace(_with(city, found, part, tint), notes=notes)


def _having(city: City, part: str) -> UInt64Array:
    """Return the ids of the buildings that have a part already."""
    such = np.array(
        [one.name.startswith(KNOWN.get(part, (part,))) for one in city.scene.prototypes] or [False]
    )
    found = [rows.owner[such[rows.prototype]] for rows in city.scene.instances.values()]
    return np.asarray(np.unique(np.concatenate([np.zeros(0, np.uint64), *found])), np.uint64)


def _with(
    city: City, found: list[Part], part: str, tint: tuple[float, float, float] | None
) -> City:
    """Put parts into the scene; each is known by its building and its place."""
    names = sorted({one.prototype.name for one in found})
    shapes = {one.prototype.name: one.prototype for one in found}
    owner = np.array([one.owner for one in found], np.uint64)
    position = np.array([one.position for one in found])
    places = np.rint(1000 * position).astype(np.int64).tolist()
    ids = [stable_id(ACTION, part, one.owner, *at) for one, at in zip(found, places, strict=True)]
    rows = Instances(
        np.array([names.index(one.prototype.name) for one in found], np.int32),
        np.array(ids, np.uint64),
        owner,
        position,
        np.array([one.rotation for one in found], np.float32),
        np.array([one.scale for one in found], np.float32),
        np.broadcast_to(
            np.asarray((1.0, 1.0, 1.0) if tint is None else tint, np.float32), position.shape
        ).copy(),
    )
    _, first = np.unique(rows.object_id, return_index=True)
    rows = take_rows(rows, np.sort(first))
    scene = with_rows(city.scene, LAYER, [shapes[name] for name in names], rows)
    return replace(city, scene=scene)


# -- on roofs --------------------------------------------------------------------------------------


def _solar(city: City, chosen: UInt64Array, facing: str | None = None) -> Iterator[Part]:
    """Lay panels on the roof that sees most of the sun, in its plane or on racks."""
    for number, planes in planes_of(city, chosen):
        if facing is not None:
            planes = [plane for plane in planes if _slopes(plane, facing)]
        best = sorted(planes, key=lambda plane: -plane.area * (1.0 - 0.5 * plane.normal[1]))
        for plane in best[:2]:
            fits = (size for size in SIZES if next(_in_plane(plane, size), None) is not None)
            size = next(fits, 0.0)
            scale = np.array([size, size, 1.0])
            for xyz in _in_plane(plane, size) if size else ():
                yield Part(_panels(plane), number, xyz, _lying(plane), scale)
            if size:
                break


def _slopes(plane: Plane, side: str) -> bool:
    """Return whether a roof slopes to a side, and to no other more."""
    flat = float(np.hypot(*plane.normal[:2]))
    if plane.normal[2] > FLAT or not flat:
        return False
    ahead = float(plane.normal[:2] @ np.array(SIDES[side])) / flat
    return bool(ahead > np.cos(np.radians(45.0)) - 1e-9)


def _panels(plane: Plane) -> Prototype:
    return roof_furniture("solar_panels" if plane.normal[2] > FLAT else "solar_flush")


def _lying(plane: Plane) -> FloatArray:
    """Return the turn of what lies on a plane with its lower edge along the eave."""
    if plane.normal[2] > FLAT:
        return np.zeros(3)
    slope = np.arccos(np.clip(plane.normal[2], -1.0, 1.0))
    return np.array([slope, 0.0, np.arctan2(plane.normal[1], plane.normal[0]) + np.pi / 2])


def _in_plane(plane: Plane, size: float) -> Iterator[FloatArray]:
    """Yield places for panels in a plane, from its middle outward, none in another."""
    free = shapely.buffer(plane.outline, -EDGE)
    wide, deep = size * SOLAR[0], size * SOLAR[1]
    if shapely.is_empty(free):
        return
    middle = shapely.get_coordinates(shapely.centroid(free))[0]
    steps = sorted(((i, j) for i in range(-3, 4) for j in range(-3, 4)),
                   key=lambda step: (abs(step[0]) + abs(step[1]), step))  # fmt: skip
    count = 0
    shapely.prepare(free)
    for i, j in steps:
        u, v = middle + np.array([i * (wide + 0.15), j * (deep + 0.15)])
        box = shapely.box(u - wide / 2, v - deep / 2, u + wide / 2, v + deep / 2)
        if count < ARRAYS and shapely.contains(free, box):
            count += 1
            yield plane.place(u, v)


def _on_ridge(name: str, sunk: float) -> Callable[[City, UInt64Array], Iterator[Part]]:
    """Return what stands things on the ridges of roofs, or in the middle of flat ones."""

    def parts(city: City, chosen: UInt64Array) -> Iterator[Part]:
        for number, planes in planes_of(city, chosen):
            top, way = ridge_of(planes)
            if top is None:
                continue
            flat = planes[0].normal[2] > FLAT
            shape = roof_furniture(f"{name}_small" if name == "chimney" and flat else name)
            down = 0.0 if flat else sunk
            turn = np.array([0.0, 0.0, way])
            yield Part(shape, number, top - np.array([0.0, 0.0, down]), turn, np.ones(3))

    return parts


# -- on walls --------------------------------------------------------------------------------------


def _windows(
    city: City, chosen: UInt64Array, kind: str
) -> Iterator[tuple[Instances, int, FloatArray]]:
    """Yield the openings of a kind: the rows, the number of each, and its size as it is drawn."""
    prototypes = city.scene.prototypes
    kinds = np.array([one.kind == kind for one in prototypes] or [False])
    sizes = [np.array([np.ptp(one.mesh.vertices[:, 0]), one.mesh.vertices[:, 2].max()])
             if one.kind == kind else np.zeros(2) for one in prototypes]  # fmt: skip
    for rows in city.scene.instances.values():
        for at in np.flatnonzero(kinds[rows.prototype] & np.isin(rows.owner, chosen)).tolist():
            yield rows, at, sizes[int(rows.prototype[at])]


def _flower_boxes(city: City, chosen: UInt64Array) -> Iterator[Part]:
    """Hang a box under every window on a wall."""
    shape = fixture("flower_box", detail=city.lod)
    for rows, at, size in _windows(city, chosen, "window"):
        if abs(rows.rotation[at, 0]) > UPRIGHT:
            continue  # in a roof
        wide = float(size[0] * rows.scale[at, 0])
        scale = np.array([np.clip(0.95 * wide / BOX, 0.5, 2.0), 1.0, 1.0])
        yield Part(shape, int(rows.owner[at]), rows.position[at], rows.rotation[at], scale)


def _awnings(city: City, chosen: UInt64Array) -> Iterator[Part]:
    """Put an awning over every shopfront that has none."""
    shape = fitting("awning", detail=city.lod)
    own = float(np.ptp(shape.mesh.vertices[:, 0]))
    held = _places(city, "awning")
    for rows, at, size in _windows(city, chosen, "shopfront"):
        high = float(size[1] * rows.scale[at, 2])
        top = rows.position[at] + np.array([0.0, 0.0, 0.93 * high])
        if len(held) and np.hypot(*(held - top)[:, :2].T).min() < 1.0:
            continue
        scale = np.array([float(size[0] * rows.scale[at, 0]) / own, 1.0, 1.0])
        yield Part(shape, int(rows.owner[at]), top, rows.rotation[at], scale)


def _places(city: City, word: str) -> FloatArray:
    """(k, 3) where parts of a kind are already."""
    own = np.array([one.name.split("_")[0] == word for one in city.scene.prototypes] or [False])
    found = [rows.position[own[rows.prototype]] for rows in city.scene.instances.values()]
    return np.concatenate([np.zeros((0, 3)), *found])


def _balconies(city: City, chosen: UInt64Array) -> Iterator[Part]:
    """Build a balcony before windows upstairs, so that none is in another or in a neighbour."""
    shape = trim("balcony_bars", detail=city.lod)
    prototypes = city.scene.prototypes
    size = np.array([np.ptp(one.mesh.vertices[:, 0]) for one in prototypes] or [0.0])
    taken: dict[tuple[int, int], list[FloatArray]] = {}
    for rows, at in _open_windows(city, chosen):
        place, owner = rows.position[at], int(rows.owner[at])
        beside = taken.setdefault((owner, round(float(place[2]))), [])
        if any(np.hypot(*(place[:2] - other[:2])) < APART for other in beside):
            continue
        beside.append(place)
        wide = float(size[int(rows.prototype[at])] * rows.scale[at, 0]) + WIDE
        scale = np.array([np.clip(wide, 1.5, OUT) / OUT, 1.0, 1.0])
        yield Part(shape, owner, place - np.array([0.0, 0.0, SILL]), rows.rotation[at], scale)


def _open_windows(city: City, chosen: UInt64Array) -> Iterator[tuple[Instances, int]]:
    """Yield windows upstairs with room for a balcony: no house before them, and none beside."""
    from scipy.spatial import cKDTree

    houses = shapely.STRtree(city.layout.buildings.geometry.to_numpy())
    held = _places(city, "balcony")
    kinds = np.array([one.kind == "window" for one in city.scene.prototypes] or [False])
    for rows in city.scene.instances.values():
        own = kinds[rows.prototype] & np.isin(rows.owner, chosen)
        own &= np.abs(rows.rotation[:, 0]) < UPRIGHT
        at = np.flatnonzero(own)
        if not len(at):
            continue
        place, turn = rows.position[at], rows.rotation[at, 2].astype(float)
        ground = city.terrain.height_at(place[:, :2])
        free = place[:, 2] - SILL >= ground + UPPER
        out = np.column_stack([np.sin(turn), -np.cos(turn)])
        free[houses.query(shapely.points(place[:, :2] + REACH * out), "intersects")[0]] = False
        if len(held):
            free &= cKDTree(held).query(place)[0] >= APART
        for row in at[free].tolist():
            yield rows, row


def _opened(city: City, balconies: list[Part]) -> City:
    """Let the windows behind balconies reach down to their floors, and take off their sills."""
    from scipy.spatial import cKDTree

    tree = cKDTree([np.add(one.position, (0.0, 0.0, SILL)) for one in balconies])
    prototypes = city.scene.prototypes
    opening = np.array([one.kind == "window" for one in prototypes] or [False])
    sill = np.array([one.name.split("_")[0] == "sill" for one in prototypes] or [False])
    high = np.array([one.mesh.vertices[:, 2].max() for one in prototypes] or [1.0])
    scene = city.scene
    for layer, rows in city.scene.instances.items():
        concerned = np.flatnonzero((opening | sill)[rows.prototype])
        if not len(concerned):
            continue
        hit = concerned[tree.query(rows.position[concerned])[0] < SAME]
        position, scale = rows.position.copy(), rows.scale.copy()
        lowered = hit[opening[rows.prototype[hit]]]
        position[lowered, 2] -= SILL
        scale[lowered, 2] += (SILL / high[rows.prototype[lowered]]).astype(np.float32)
        gone = np.zeros(rows.count, bool)
        gone[hit[sill[rows.prototype[hit]]]] = True
        changed = leave_rows(replace(rows, position=position, scale=scale), gone)
        scene = scene.with_instances(layer, prototypes, changed)
    return replace(city, scene=scene)


# -- on towers -------------------------------------------------------------------------------------


def _clocks(city: City, chosen: UInt64Array) -> Iterator[Part]:
    """Hang a clock on every side of a tower, else in the middle of the front."""
    shape = fixture("clock_face", detail=city.lod)
    own = float(np.ptp(shape.mesh.vertices[:, 0]))
    table = city.layout.buildings
    ids = table["id"].to_numpy(np.uint64)
    held = _having(city, "clock")
    level = dict(zip(ids.tolist(), _levels(city).tolist(), strict=True))
    for number in chosen.tolist():
        towers = list(body_parts(city.layout, "tower", np.array([number], np.uint64)))
        if number in held:
            continue
        parts = city.layout.parts
        if towers:
            tower = max(towers, key=lambda one: one.top)
            rise = float(parts["roof_height"].to_numpy(float)[tower.rows].max())
            outline, z = tower.outline, tower.top - rise - BELOW
            least = 0.6
        else:
            mine = np.flatnonzero(parts["building"].to_numpy(np.uint64) == np.uint64(number))
            row = int(mine[np.argmax(shapely.area(parts.geometry.to_numpy()[mine]))])
            outline = parts.geometry.iloc[row]
            z = float(parts["top"].iloc[row] - parts["roof_height"].iloc[row]) - 0.7 * DIAL
            least = DIAL
        if z < ENTRANCE:
            continue
        for xy, way, wide in _sides_of(city, outline, least, all_round=bool(towers)):
            size = min(DIAL, 0.7 * wide)
            if size >= LEAST_DIAL:
                turn = float(np.arctan2(way[1], way[0]) + np.pi / 2)
                at = np.array([*(xy + OUT_OF_WALL * way), z + level[number]])
                yield Part(shape, number, at, np.array([0.0, 0.0, turn]), np.full(3, size / own))


def _levels(city: City) -> FloatArray:
    """(n,) metres of the ground that each building stands on."""
    owner, described = owner_rows(city.layout)
    level = np.full(len(city.layout.buildings), -np.inf)
    np.maximum.at(level, owner[described], ground_levels(city.layout, city.terrain)[described])
    return np.where(np.isfinite(level), level, 0.0)


def _sides_of(
    city: City, outline: shapely.Geometry, least: float, *, all_round: bool
) -> list[tuple[FloatArray, FloatArray, float]]:
    """Return the middles of the walls of a plan, the ways out of them and their widths.

    Of all walls that are wide enough, or of the one nearest to a street.
    """
    ring = shapely.get_coordinates(shapely.orient_polygons(outline).exterior)
    step = np.diff(ring, axis=0)
    length = np.hypot(*step.T)
    middle = (ring[1:] + ring[:-1]) / 2
    out = np.column_stack([step[:, 1], -step[:, 0]]) / np.maximum(length, 1e-9)[:, None]
    rows = np.flatnonzero(length >= least)
    if not all_round and len(rows):
        streets = shapely.union_all(city.layout.roads.geometry.to_numpy())
        away = shapely.distance(shapely.points(middle[rows] + out[rows]), streets)
        rows = rows[[int(np.argmin(np.round(away, 2)))]]
    elif len(rows) > 4:
        rows = np.sort(rows[np.argsort(-np.round(length[rows], 2), kind="stable")[:4]])
    return [(middle[k], out[k], float(length[k])) for k in rows.tolist()]


def _repainted(
    city: City, chosen: UInt64Array, word: str, tint: tuple[float, float, float]
) -> City:
    """Give the parts of a kind that some buildings have already a colour."""
    prototypes = city.scene.prototypes
    own = np.array([one.name.split("_")[0] == word for one in prototypes] or [False])
    scene = city.scene
    for layer, rows in city.scene.instances.items():
        hit = own[rows.prototype] & np.isin(rows.owner, chosen)
        if hit.any():
            painted = rows.tint.copy()
            painted[hit] = tint
            scene = scene.with_instances(layer, prototypes, replace(rows, tint=painted))
    return replace(city, scene=scene)


_Maker = Callable[[City, UInt64Array], Iterator[Part]]
_MAKERS: Mapping[str, _Maker] = MappingProxyType(
    {
        "solar": _solar, "antenna": _on_ridge("antenna", 0.0), "dish": _on_ridge("dish", 0.0),
        "chimney": _on_ridge("chimney", SUNK), "flower_box": _flower_boxes, "awning": _awnings,
        "balcony": _balconies, "clock": _clocks,
    }
)  # fmt: skip
