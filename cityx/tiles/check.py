"""Whether tiles are right: their files, tiles built again alone, seams, ids against the map.

What the map holds is read from the file itself, not from what the tiles were built from.
"""

from __future__ import annotations

import random
import tempfile
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely

from cityx.city import City
from cityx.city.store import read_city
from cityx.errors import InputError
from cityx.geometry.arrays import FloatArray
from cityx.ground.walking.crosswalks import FOOTWAYS
from cityx.ids import id_text
from cityx.sources.osm import city_of
from cityx.sources.osm.reader import read_elements
from cityx.tiles.content import MOST
from cityx.tiles.edits import read_edits
from cityx.tiles.grid import Tile, holds
from cityx.tiles.order import Order, read_order
from cityx.tiles.plane import box_in_frame, buildings_about, origin_of
from cityx.tiles.run import FRAGMENTS, PROTOTYPES, TILES, around, records
from cityx.tiles.tile import CITY, CONTENT, file_faults, make_tile, write_tile

if TYPE_CHECKING:
    from geopandas import GeoDataFrame

SEAM = 0.001  # metres that what crosses a border may be apart on either side
EVERY = 5.0  # metres between the places of a border whose heights are compared
ON = 1e-6  # metres within which a vertex lies on a border


@dataclass(frozen=True)
class Check:
    """What was looked at, what was found, and each fault in a sentence."""

    name: str
    told: str
    faults: tuple[str, ...] = ()

    @property
    def ok(self) -> bool:
        """Whether nothing is wrong."""
        return not self.faults


def checked(
    folder: Path, *, sample: int, seed: int, source: Path | None, say: Callable[[str], None]
) -> list[Check]:
    """Check a folder of tiles.

    Parameters
    ----------
    sample, seed
        How many tiles are built again, and which.
    source
        The map; without it nobody can tell whether anything is missing.

    Raises
    ------
    InputError
        If the folder holds no tiles.
    """
    order, _ = read_order(folder)
    known = records(folder)
    if not known:
        raise InputError(f"{folder} holds no built tile; cityx tiles build makes them.")
    say("reading the files")
    found = [_files(folder, known), _sizes(folder, known)]
    found.append(_rebuilt(folder, order, known, sample, seed, say))
    stored = {tile for tile in known if (folder / TILES / tile.name / CITY).is_dir()}
    say("looking at the seams")
    found += _seams(folder, order, stored)
    found.append(_unique(folder, stored))
    if order.plane is not None:
        say("laying out the plane")
        found.append(_complete_plane(order, known, sample, seed))
    elif source is not None:
        say("reading the map")
        found.append(_complete(order, known, source))
    return found


def _files(folder: Path, known: Iterable[Tile]) -> Check:
    faults = [fault for tile in known for fault in file_faults(folder / TILES / tile.name)]
    return Check("files", f"{len(list(known))} tiles read", tuple(faults))


def _sizes(folder: Path, known: Iterable[Tile]) -> Check:
    sizes = {path: path.stat().st_size for tile in known
             for path in sorted((folder / TILES / tile.name / CONTENT).glob("*.glb"))}  # fmt: skip
    largest = max(sizes.values(), default=0)
    faults = [f"{path} has {size:,} bytes" for path, size in sizes.items() if size > MOST]
    told = f"{len(sizes)} files of {sum(sizes.values()) / 1e6:,.1f} MB, {largest:,} bytes at most"
    return Check("sizes", told, tuple(faults))


def _rebuilt(
    folder: Path, order: Order, known: Mapping[Tile, Mapping[str, Any]], sample: int, seed: int,
    say: Callable[[str], None],
) -> Check:  # fmt: skip
    """Build some tiles again, each alone, and compare their files byte for byte."""
    some = random.Random(seed).sample(sorted(known), min(sample, len(known)))
    faults, edits = [], read_edits(folder)
    for tile in some:
        say(f"building {tile.name} again")
        fragment = folder / FRAGMENTS / f"{tile.name}.npz"
        record = known[tile]
        store = any(name.startswith(f"{CITY}/") for name in record["files"])
        with tempfile.TemporaryDirectory() as place:
            made = make_tile(order, tile, fragment, edits.of(tile))
            key = order.key(tile, fragment, edits.of(tile))
            again = write_tile(
                order, tile, made, key, Path(place) / tile.name, kept=Path(place) / PROTOTYPES,
                store=store,
            )  # fmt: skip
        other = sorted(
            name for name in {*again["files"], *record["files"]}
            if again["files"].get(name) != record["files"].get(name)
        )  # fmt: skip
        if other:
            faults.append(f"{tile.name}: {', '.join(other)} came out otherwise")
    return Check("rebuilt", f"{len(some)} tiles built again, alone", tuple(faults))


def _seams(folder: Path, order: Order, stored: Iterable[Tile]) -> list[Check]:
    """Compare what lies on the common border of tiles side by side."""
    stored = set(stored)
    kinds = ("ground", "roads", "lines", *(["terrain"] if order.relief else []))
    looked, places = 0, Counter[str]()
    walked = 0.0
    faults: dict[str, list[str]] = defaultdict(list)
    for tile in sorted(stored):
        for beside, axis in ((Tile(tile.column + 1, tile.row), 0),
                             (Tile(tile.column, tile.row + 1), 1)):  # fmt: skip
            if beside not in stored:
                continue
            looked += 1
            cities = [read_city(folder / TILES / one.name / CITY) for one in (tile, beside)]
            shift = np.subtract(origin_of(order, beside), origin_of(order, tile))
            border = box_in_frame(order, beside)[axis]
            for kind in kinds:
                one = _crossings(cities[0], kind, axis, border + shift[axis])
                other = _crossings(cities[1], kind, axis, border)
                other[:, :2] += shift
                places[kind] += len(one)
                apart = _unmatched(one, other) + _unmatched(other, one)
                if apart:
                    faults[kind].append(
                        f"{tile.name} and {beside.name}: {apart} of {len(one) + len(other)} places "
                        f"of {kind} have no other within {SEAM * 1e3:g} mm"
                    )
            here, there = (
                _walks_on(one, axis, line)
                for one, line in zip(cities, (border + shift[axis], border), strict=True)
            )
            there[:, :2] += shift[1 - axis]
            both, lost = _walked(here, there)
            walked += both
            if lost > SEAM:
                faults["walks"].append(
                    f"{tile.name} and {beside.name}: {lost:.3f} m of {both + lost:.1f} m of the "
                    "border are of a walk on one side alone, or of another one on the other"
                )
    return [
        Check(f"seams of {kind}", f"{looked} borders, {places[kind]} places", tuple(faults[kind]))
        for kind in kinds
    ] + [Check("seams of walks", f"{looked} borders, {walked:.1f} m", tuple(faults["walks"]))]


def _walks_on(city: City, axis: int, border: float) -> FloatArray:
    """(n, 5) where pavements and paths meet a border: from, to along it, label, halves of an id."""
    ground = city.ground
    if ground is None:
        return np.zeros((0, 5))
    ends = ground.vertices[ground.edges]  # (e, 2, 2)
    on = (np.abs(ends[:, :, axis] - border) < ON).all(axis=1)
    face = ground.edge_faces[on].max(axis=1)
    walk = ground.labelled(*FOOTWAYS)[face]
    face, along = face[walk], np.sort(ends[on][walk][:, :, 1 - axis], axis=1)
    owner = ground.face_object[face]
    halves = owner >> np.uint64(32), owner & np.uint64(0xFFFFFFFF)
    return np.column_stack([along, ground.face_label[face], *halves]).astype(float)


def _walked(one: FloatArray, other: FloatArray) -> tuple[float, float]:
    """Return the metres of a border that are one walk on both sides, and those that are not."""
    steps = np.unique(np.concatenate([one[:, :2].ravel(), other[:, :2].ravel()]))
    if len(steps) < 2:
        return 0.0, 0.0
    middle, length = (steps[1:] + steps[:-1]) / 2, np.diff(steps)
    sides = []
    for rows in (one, other):
        of = np.full((len(middle), 3), -1.0)
        for low, high, *what in rows.tolist():
            of[(middle > low) & (middle < high)] = what
        sides.append(of)
    some = (sides[0][:, 0] >= 0) | (sides[1][:, 0] >= 0)
    same = (sides[0] == sides[1]).all(axis=1)
    return float(length[some & same].sum()), float(length[some & ~same & (length > SEAM)].sum())


def _crossings(city: City, kind: str, axis: int, border: float) -> FloatArray:
    """(n, 3) what lies on a border: vertices of the ground, heights, where lines cross it."""
    if kind == "terrain":
        along = np.arange(city.layout.extent[1 - axis], city.layout.extent[3 - axis], EVERY)
        places = np.full((len(along), 2), border)
        places[:, 1 - axis] = along
        return np.column_stack([places, city.terrain.height_at(places)])
    if kind == "ground":
        batch = city.scene.meshes.get("ground")
        points = np.zeros((0, 3)) if batch is None else batch.vertices
        near = points[np.abs(points[:, axis] - border) < ON]
        return np.asarray(np.unique(np.round(near, 6), axis=0))
    shapes = getattr(city.layout, kind).geometry.to_numpy()
    shapes = shapes[shapely.get_dimensions(shapes) == 1]
    ends = shapely.get_coordinates(shapely.boundary(shapes))
    xy = ends[np.abs(ends[:, axis] - border) < ON]
    return np.column_stack([xy, np.zeros(len(xy))])


def _unmatched(one: FloatArray, other: FloatArray) -> int:
    if not len(one):
        return 0
    if not len(other):
        return len(one)
    from scipy.spatial import cKDTree

    away, _ = cKDTree(other).query(one)
    return int((away > SEAM).sum())


def _unique(folder: Path, stored: Iterable[Tile]) -> Check:
    """Look for objects that stand in two tiles."""
    seen: dict[tuple[str, int], Tile] = {}
    faults, total = [], 0
    for tile in sorted(stored):
        city = read_city(folder / TILES / tile.name / CITY)
        for layer, ids in _standing(city).items():
            total += len(ids)
            for object_id in ids:
                first = seen.setdefault((layer, object_id), tile)
                if first != tile:
                    faults.append(f"{layer} {object_id:016x} stands in {first.name} and "
                                  f"{tile.name}")  # fmt: skip
    return Check("no object twice", f"{total} objects", tuple(faults))


def _standing(city: City) -> dict[str, set[int]]:
    """Return the ids of what has one owner, by layer."""
    found = {
        name: set(getattr(city.layout, name)["id"].tolist())
        for name in ("buildings", "parts", "points")
    }
    for name, table in city.scene.instances.items():
        found[name] = set(table.object_id.tolist())
    if "buildings" in city.scene.meshes:
        found["shells"] = set(city.scene.meshes["buildings"].object_id.tolist())
    return found


def _complete(order: Order, known: Mapping[Tile, Mapping[str, Any]], source: Path) -> Check:
    """Hold the buildings of the tiles against those that reading the whole map at once gives."""
    whole = city_of(
        read_elements(source), str(source), seed=order.seed, frame=order.frame,
        place=order.frame.place, box=around(order, list(known)), bare=True,
    ).layout.buildings  # fmt: skip
    total, faults = _held(order, known, known, whole, "the map")
    return Check("none missing", f"{total} buildings of {source.name}", tuple(faults))


def _complete_plane(
    order: Order, known: Mapping[Tile, Mapping[str, Any]], sample: int, seed: int
) -> Check:
    """Hold the buildings of some tiles against a window of the plane nine times as large."""
    some = random.Random(seed).sample(sorted(known), min(sample, len(known)))
    total, faults = 0, []
    for tile in some:
        whole = buildings_about(order, tile, tile.around)
        count, found = _held(order, known, [tile], whole, "a larger window")
        total += count
        faults += found
    return Check("none missing", f"{total} buildings of {len(some)} tiles", tuple(faults))


def _held(
    order: Order, known: Mapping[Tile, Mapping[str, Any]], tiles: Iterable[Tile],
    whole: GeoDataFrame, of: str,
) -> tuple[int, list[str]]:  # fmt: skip
    """Compare buildings of tiles with a table of all; returns how many are due, and faults."""
    middles = shapely.get_coordinates(shapely.centroid(whole.geometry.to_numpy()))
    ids = whole["id"].to_numpy(np.uint64)
    faults, total = [], 0
    for tile in tiles:
        due = {id_text(key) for key in ids[holds(box_in_frame(order, tile), middles)].tolist()}
        there = set(known[tile]["buildings"])
        total += len(due)
        faults += [f"{tile.name} lacks building {key}" for key in sorted(due - there)]
        faults += [f"{tile.name} has building {key}, which {of} does not have there"
                   for key in sorted(there - due)]  # fmt: skip
    return total, faults
