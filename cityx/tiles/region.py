"""Regions: several tiles side by side as one city, whichever of them were built or read first.

What stands and lies there is that of the tiles. Streets cross borders, so their network, heights
and lanes are made anew of the fragments of all of them together, by the actions that made those of
each tile: ids are the same, and a lane that borders cut is whole.
"""

from __future__ import annotations

import json
import os
import re
import shutil
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import reduce
from hashlib import sha256
from itertools import takewhile
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cityx.city import City
from cityx.city.content import HASHES, content_hash, write_hash
from cityx.city.ground import Ground
from cityx.city.mesh import MeshBatch, concatenate
from cityx.city.rows import join_rows, take_rows
from cityx.city.scene import Prototype, Scene
from cityx.city.store import read_city, write_city
from cityx.city.terrain import Profile, Terrain
from cityx.errors import UsageError
from cityx.projects.locks import locked
from cityx.system.cache import kept_folder
from cityx.tiles.actions import built
from cityx.tiles.edits import Edits, is_whole, read_edits
from cityx.tiles.grid import Box, Tile, tiles_of
from cityx.tiles.order import Order, read_order
from cityx.tiles.ownership import owned
from cityx.tiles.plane import named_in_plane, origin_of, plane_city, tiles_in
from cityx.tiles.run import FRAGMENTS, TILES, build_tiles, is_done
from cityx.tiles.split import merged, read_fragment
from cityx.tiles.tile import CITY, land_of
from cityx.version import __version__

if TYPE_CHECKING:
    from geopandas import GeoDataFrame

LAID = "road/ground-v1"  # what comes before it in a plan is about streets
REPORT = "report.json"
MOST = 36  # tiles of a region: what is read at once has a bound
LONGEST = 1800.0  # seconds that a process waits for another that joins the same region
DEGREES = 180.0  # a pair of larger numbers is metres
_PAIR = re.compile(r"\s*(-?\d+(?:\.\d+)?)\s*,\s*(-?\d+(?:\.\d+)?)\s*")
STANDING = ("buildings", "parts", "points")  # tables of a layout whose rows belong to one tile
WELD = 6  # digits of metres by which vertices of the ground of two tiles are one


@dataclass(frozen=True)
class Region:
    """A rectangle of tiles of a folder.

    Attributes
    ----------
    folder
        Of the tiles.
    order
        What they have in common.
    tiles
        Those that hold anything, by their names.
    box
        (xmin, ymin, xmax, ymax) of all tiles of the rectangle, metres of the frame of the run.
    edits
        Of the folder.
    """

    folder: Path
    order: Order
    tiles: tuple[Tile, ...]
    box: Box
    edits: Edits

    @property
    def name(self) -> str:
        """Name of the tiles as one city."""
        return f"{self.order.name} {self.tiles[0].name} to {self.tiles[-1].name}"

    def __post_init__(self) -> None:
        """Put the tiles in their order: parts of one object follow each other by it."""
        object.__setattr__(self, "tiles", tuple(sorted(self.tiles)))

    @property
    def key(self) -> str:
        """64 hexadecimal digits; the same tiles and fragments, and no others, give the same."""
        hasher = sha256(repr((self.box, self.order.code, __version__)).encode())
        for tile in self.tiles:
            hasher.update(self.order.key(tile, _fragment(self, tile), self.edits.of(tile)).encode())
        return hasher.hexdigest()


def region_about(
    folder: Path, place: tuple[float, float], size: tuple[float, float], *, most: int = MOST
) -> Region:
    """Return the tiles that a rectangle about a place reaches into.

    Parameters
    ----------
    place
        Its middle, metres of the frame of the run.
    size
        Its width and depth, metres.
    most
        Tiles that are allowed.

    Raises
    ------
    InputError
        If the folder holds no tiles.
    UsageError
        If no tile lies there, or more than allowed; or streets of them were edited.
    """
    order, known = read_order(folder)
    (x, y), (wide, deep) = place, size
    wanted = (x - wide / 2, y - deep / 2, x + wide / 2, y + deep / 2)
    every = list(tiles_of(wanted, order.size))
    if not every or len(every) > most:
        raise UsageError(
            f"{wide:g} x {deep:g} m about {x:g},{y:g} are {len(every)} tiles of {order.size:g} m; "
            f"a region has 1 to {most}."
        )
    tiles = tiles_in(order, wanted) if order.plane is not None else set(known) & set(every)
    if not tiles:
        raise UsageError(f"No tile of {folder} lies about {x:g},{y:g}.")
    if len({origin_of(order, tile) for tile in tiles}) > 1:
        raise UsageError(f"{wide:g} x {deep:g} m about {x:g},{y:g} reach into two sheets.")
    edits = read_edits(folder)
    changed = [tile.name for tile in sorted(tiles) if any(map(is_whole, edits.of(tile)))]
    if changed:
        raise UsageError(
            f"Streets or areas of {', '.join(changed)} were edited; such tiles are not joined."
        )
    low, high = every[0].box(order.size), every[-1].box(order.size)
    return Region(folder, order, tuple(sorted(tiles)), (*low[:2], *high[2:]), edits)


def region_city(region: Region, say: Callable[[str], None] = lambda _: None) -> City:
    """Return the tiles of a region as one city; those that are missing are built first.

    Raises
    ------
    UsageError
        If a tile cannot be built, or has no store.
    """
    order, folder, tiles = region.order, region.folder, region.tiles
    missing = [tile for tile in tiles if not is_done(folder, order, tile, region.edits)]
    if missing:
        failed = build_tiles(folder, order, missing, say=say).failed
        if failed:
            told = "; ".join(f"{name}: {cause}" for name, cause in failed.items())
            raise UsageError(f"Tiles of the region cannot be built: {told}")
    bare = [tile.name for tile in tiles if not (folder / TILES / tile.name / CITY).is_dir()]
    if bare:
        raise UsageError(
            f"{', '.join(bare)} were built without a store (--no-store), so nothing is there to be "
            "joined. Build the tiles with it in another folder."
        )
    cities = [read_city(folder / TILES / tile.name / CITY) for tile in tiles]
    streets = region_streets(region)
    tables = {name: _joined_table([getattr(c.layout, name) for c in cities]) for name in STANDING}
    (west, south, east, north), (x, y) = region.box, origin_of(order, tiles[0])
    extent = (west - x, south - y, east - x, north - y)
    return replace(
        cities[0],
        name=region.name,
        layout=replace(streets.layout, extent=extent, **tables),
        terrain=streets.terrain, network=streets.network, heights=streets.heights,
        lanes=streets.lanes,
        ground=joined_ground([c.ground for c in cities if c.ground is not None]),
        scene=joined_scene([city.scene for city in cities]),
        attribution=tuple(sorted({text for city in cities for text in city.attribution})),
        failures=tuple(failure for city in cities for failure in city.failures),
    )  # fmt: skip


def write_region(
    region: Region, out: Path, say: Callable[[str], None] = lambda _: None, *,
    within: Box | None = None,
) -> City:  # fmt: skip
    """Write a region as the folder of a built city, which appears when all of it is written.

    Parameters
    ----------
    region
        What is written.
    out
        The folder.
    say
        Is told of tiles that are built.
    within
        (xmin, ymin, xmax, ymax) metres of the frame of the tiles: what is beyond is left out.

    Raises
    ------
    UsageError
        As of `region_city`; or if the folder holds something already.
    """
    if out.exists() and (not out.is_dir() or any(out.iterdir())):
        raise UsageError(f"{out} is not empty; a region takes a folder of its own.")
    city = region_city(region, say)
    city = city if within is None else owned(city, within)
    out.parent.mkdir(parents=True, exist_ok=True)
    staging = out.with_name(f".{out.name}.{os.getpid()}.partial")
    try:
        write_city(city, staging / CITY)
        content = content_hash(city)
        write_hash(content, staging / CITY / HASHES)
        told = {"hash": content.total, "tiles": [tile.name for tile in region.tiles]}
        (staging / REPORT).write_text(json.dumps(told) + "\n")
        if out.is_dir():
            out.rmdir()
        staging.rename(out)
    finally:
        shutil.rmtree(staging, ignore_errors=True)
    return city


def kept_region(region: Region) -> Path:
    """Return the folder of a region as a city in the cache, written there if it is not yet."""
    folder = kept_folder("places") / f"tiles-{region.key[:24]}"
    if not (folder / REPORT).is_file():
        beside = folder.with_name(f"{folder.name}.lock")
        beside.mkdir(parents=True, exist_ok=True)
        with locked(beside, LONGEST):  # another process may ask for the same region
            if not (folder / REPORT).is_file():
                write_region(region, folder)
    return folder


def place_of(order: Order, text: str, option: str = "at") -> tuple[float, float]:
    """Return the place of a text, metres of the frame of a run.

    Parameters
    ----------
    text
        LAT,LON in degrees with decimals, or X,Y in metres.
    option
        What the user calls it.

    Raises
    ------
    UsageError
        If it is no place.
    """
    found = _PAIR.fullmatch(text)
    if found is None:
        raise UsageError(
            f'{option} is "{text}"; it takes LAT,LON in degrees or X,Y in metres, such as '
            "47.141,9.5215."
        )
    first, second = float(found[1]), float(found[2])
    if order.plane is not None:
        return first, second
    geographic = "." in found[1] and "." in found[2] and abs(first) <= 90 and abs(second) <= DEGREES
    if not geographic:
        return first, second
    x, y = order.frame.to_local([[second, first]])[0].tolist()
    return float(x), float(y)


def _fragment(region: Region, tile: Tile) -> Path:
    return region.folder / FRAGMENTS / f"{tile.name}.npz"


def region_streets(region: Region) -> City:
    """Return the layout of a region with network, heights and lanes, as one tile would have it.

    Tiles need not be built for it; of a map their fragments are read.
    """
    order, box = region.order, region.box
    margin = order.margin
    window = (box[0] - margin, box[1] - margin, box[2] + margin, box[3] + margin)
    origin = origin_of(order, region.tiles[0])
    if order.plane is not None:
        land = plane_city(order, window, origin, order.name)
    else:
        held = [read_fragment(_fragment(region, tile)) for tile in region.tiles]
        coverage: dict[str, float] = {}
        for _, own, _ in held:
            coverage |= own
        osm = reduce(merged, [osm for osm, _, _ in held])
        land = land_of(order, osm, coverage, window, str(region.folder))
        terrains = [terrain for _, _, terrain in held if terrain is not None]
        if terrains:
            land = replace(land, terrain=joined_terrain(terrains))
    land = replace(land, lod=order.lod, stages_done=land.stages_done | {"terrain"})
    items = takewhile(lambda item: item.action != LAID, order.items)
    city = built(land, items)
    x, y = origin
    city = owned(city, (box[0] - x, box[1] - y, box[2] - x, box[3] - y))
    return city if order.plane is None else named_in_plane(city, land, origin)


def joined_terrain(terrains: Sequence[Terrain]) -> Terrain:
    """Return one terrain of several on one grid that agree where they overlap."""
    cell, datum = terrains[0].cell, terrains[0].datum
    corner = np.rint(np.array([each.origin for each in terrains]) / cell).astype(int)
    size = np.array([each.heights.shape[::-1] for each in terrains])
    first, last = corner.min(axis=0), (corner + size).max(axis=0)
    heights = np.full((last - first)[::-1], np.nan)
    for each, low, span in zip(terrains, corner - first, size, strict=True):
        heights[low[1] : low[1] + span[1], low[0] : low[0] + span[0]] = each.heights
    from cityx.sources.heights.height_field import filled_voids

    known = [each.streets for each in terrains if each.streets is not None]
    streets = None
    if known:
        place = np.concatenate([each.place for each in known])
        place, first = np.unique(place, axis=0, return_index=True)
        streets = Profile(place, np.concatenate([each.z for each in known])[first])
    # Beyond the windows, where no tile lies, the land goes on as it ends.
    west, south = (first * cell).tolist()
    return Terrain((west, south), cell, filled_voids(heights, rounds=0), datum, streets)


def joined_ground(parts: Sequence[Ground]) -> Ground | None:
    """Return the ground of tiles side by side, on shared vertices; None of none.

    Where a border parts two faces, the edge between them has both.
    """
    if not parts:
        return None
    faces = np.cumsum([0, *(len(part.face_label) for part in parts)]).tolist()
    points = np.cumsum([0, *(len(part.vertices) for part in parts)]).tolist()
    every = np.round(np.concatenate([part.vertices for part in parts]), WELD) + 0.0
    _, first, number = np.unique(every, axis=0, return_index=True, return_inverse=True)
    number = number.reshape(-1).astype(np.int32)

    def numbered(name: str) -> NDArray[np.int32]:
        shifted = [getattr(part, name) + shift for part, shift in zip(parts, points, strict=False)]
        return np.asarray(number[np.concatenate(shifted)], np.int32)

    sides = np.concatenate([
        np.where(part.edge_faces >= 0, part.edge_faces + shift, -1)
        for part, shift in zip(parts, faces, strict=False)
    ])  # fmt: skip
    edges, sides = _met(numbered("edges"), sides.astype(np.int32))
    return Ground(
        np.concatenate([part.vertices for part in parts])[first],
        numbered("triangles"),
        np.concatenate([part.triangle_face + np.int32(shift)
                        for part, shift in zip(parts, faces, strict=False)]),
        np.concatenate([part.face_label for part in parts]),
        np.concatenate([part.face_object for part in parts]),
        edges, sides,
    )  # fmt: skip


def _met(
    edges: NDArray[np.int32], sides: NDArray[np.int32]
) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Make one of two edges of the rim that run against each other between the same vertices."""
    rim = np.flatnonzero(sides[:, 1] < 0)
    pair = np.sort(edges[rim], axis=1)
    _, group, count = np.unique(pair, axis=0, return_inverse=True, return_counts=True)
    group = group.reshape(-1)
    order = np.argsort(group, kind="stable")
    order = order[count[group[order]] == 2]
    one, other = rim[order[::2]], rim[order[1::2]]
    against = edges[one, 0] == edges[other, 1]
    one, other = one[against], other[against]
    sides = sides.copy()
    sides[one, 1] = sides[other, 0]
    kept = np.ones(len(edges), bool)
    kept[other] = False
    return edges[kept], sides[kept]


def joined_scene(scenes: Sequence[Scene]) -> Scene:
    """Return the scenes of tiles side by side as one; an object that borders cut is one again."""
    prototypes: dict[str, Prototype] = {}
    for scene in scenes:
        for prototype in scene.prototypes:
            prototypes.setdefault(prototype.name, prototype)
    names = sorted(prototypes)
    place = {name: row for row, name in enumerate(names)}
    rows: dict[str, list[Any]] = {}
    batches: dict[str, list[MeshBatch]] = {}
    for scene in scenes:
        number = np.array([place[each.name] for each in scene.prototypes], np.int32)
        for layer, table in scene.instances.items():
            rows.setdefault(layer, []).append(replace(table, prototype=number[table.prototype]))
        for layer, batch in scene.meshes.items():
            batches.setdefault(layer, []).append(batch)
    instances = {}
    for layer in sorted(rows):
        table = join_rows(rows[layer])
        instances[layer] = take_rows(table, np.argsort(table.object_id, kind="stable"))
    meshes = {layer: _one_again(concatenate(batches[layer])) for layer in sorted(batches)}
    return Scene(
        MappingProxyType(meshes), tuple(prototypes[name] for name in names),
        MappingProxyType(instances),
    )  # fmt: skip


def _one_again(batch: MeshBatch) -> MeshBatch:
    """Return a batch in the order of ids, parts of one id as one object."""
    batch = batch.take(np.argsort(batch.object_id, kind="stable"))
    first = np.flatnonzero(np.r_[True, batch.object_id[1:] != batch.object_id[:-1]])
    if not batch.count or len(first) == batch.count:
        return batch
    return replace(
        batch, object_id=batch.object_id[first],
        vertex_start=np.append(batch.vertex_start[first], batch.vertex_start[-1]),
        face_start=np.append(batch.face_start[first], batch.face_start[-1]),
    )  # fmt: skip


def _joined_table(tables: Iterable[GeoDataFrame]) -> GeoDataFrame:
    import pandas as pd

    joined = pd.concat(list(tables), ignore_index=True)
    return joined.sort_values("id", kind="stable").reset_index(drop=True)
