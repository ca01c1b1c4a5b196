"""Planting: one defect put into a city that has none, at a place drawn by hash."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from cityx.assets.styles.palette_tables import GROUPS
from cityx.assets.styles.palettes import groups_of
from cityx.assets.styles.style_shares import of_any_style, speaking_of
from cityx.checks.predicates.building_predicates import Buildings
from cityx.checks.predicates.forms import times_of, weathers_of
from cityx.checks.predicates.words import MATERIALS
from cityx.city import City, Instances, MeshBatch
from cityx.city.ground import ROADWAY
from cityx.city.levels import ground_levels
from cityx.geometry.polylines import arc_lengths, locate
from cityx.geometry.solids import area_vectors
from cityx.ids import hash_bits, hash_ids, id_text
from cityx.light.sun import sun_of
from cityx.light.weather import weather_of

FloatArray = NDArray[np.float64]
WEATHERS = ("clear", "overcast", "fog", "rain", "snow")
LOW_SUN = 15.0  # degrees; by a higher sun it is no evening and no morning twilight
HIGHER, LOWER = 1.3, 0.7  # of what a building's layout asks for
AWAY = 5.0  # metres that a shell is put from its footprint
RISE = 1.0  # metres that things are lifted or sunk
BEYOND = 20.0  # metres that a tree is put beyond the site
PARTY = 1.5  # metres of wall that two buildings share
STAND = 1.0  # metres above the ground of a window in a party wall
LARGE = 60.0  # square metres of a building that is worth to be moved
UPRIGHT = 0.5  # vertical part of a normal below which a face is a wall
FOREIGN = 0.75  # of the buildings, by which a town of a style loses it
PAINT = {"red": (0.55, 0.03, 0.03), "blue": (0.03, 0.06, 0.5)}  # linear RGB
OUTDOORS = ("street_furniture", "street_pieces", "park_pieces")


@dataclass(frozen=True)
class Planted:
    """A city with one defect.

    Attributes
    ----------
    city
        The city.
    names
        Ids, or places as checks write them, one of which a check that names things must name.
    asked
        Predicates that the brief asked for and the city kept before.
    """

    city: City
    names: tuple[str, ...] = ()
    asked: tuple[str, ...] = ()


Plant = Callable[[City, int], Planted | None]
"""From a city and a key to a city with a defect; None where the city has no place for it."""


def drawn(candidates: ArrayLike, key: int) -> Any:
    """Return one of some candidates, None of none."""
    rows = np.asarray(candidates)
    return rows[hash_bits(0, "defect", key) % len(rows)] if len(rows) else None


def any_building(city: City, key: int, least: float = 0.0) -> np.uint64 | None:
    """Draw a building that stands; its id."""
    batch = city.scene.meshes.get("buildings")
    if batch is None:
        return None
    table = city.layout.buildings
    large = shapely.area(table.geometry.to_numpy()) >= least
    ids = np.intersect1d(batch.object_id, table["id"].to_numpy(np.uint64)[large])
    found: np.uint64 | None = drawn(ids, key)
    return found


def _level(city: City, owner: np.uint64) -> float:
    rows = (city.layout.parts["building"] == owner).to_numpy()
    return float(ground_levels(city.layout, city.terrain)[rows].min())


def _with_vertices(
    city: City, owner: np.uint64, change: Callable[[FloatArray], FloatArray]
) -> City:
    """Return the city with the vertices of one building's shell changed."""
    batch = city.scene.meshes["buildings"]
    mine = np.repeat(batch.object_id == owner, np.diff(batch.vertex_start))
    vertices = batch.vertices.copy()
    vertices[mine] = change(vertices[mine])
    return with_shells(city, replace(batch, vertices=vertices))


def with_shells(city: City, batch: MeshBatch) -> City:
    """Put other shells of buildings into the city."""
    return replace(city, scene=city.scene.with_mesh("buildings", batch))


def with_rows(city: City, layer: str, rows: Instances) -> City:
    """Put other instances into a layer of the city."""
    return replace(city, scene=city.scene.with_instances(layer, city.scene.prototypes, rows))


def _owned_moved(city: City, owner: np.uint64, by: ArrayLike) -> City:
    """Move a building's shell and all that belongs to it."""
    shift = np.asarray(by, float)
    city = _with_vertices(city, owner, lambda points: points + shift)
    for layer, rows in city.scene.instances.items():
        own = rows.owner == owner
        if own.any():
            position = rows.position.copy()
            position[own] += shift
            city = with_rows(city, layer, replace(rows, position=position))
    return city


def _moved(city: City, owner: np.uint64, to: FloatArray) -> City:
    """Move a building with its footprint; the middle of the footprint comes to a place."""
    layout = city.layout
    whole, part = layout.buildings.copy(), layout.parts.copy()
    mine = (whole["id"] == owner).to_numpy()
    middle = shapely.get_coordinates(shapely.centroid(whole.geometry.to_numpy()[mine]))[0]
    by = np.asarray(to, float) - middle
    for table, rows in ((whole, mine), (part, (part["building"] == owner).to_numpy())):
        shapes = table.geometry.to_numpy().copy()
        shapes[rows] = shapely.transform(shapes[rows], lambda xy: xy + by)
        table.geometry = shapes
    city = replace(city, layout=replace(layout, buildings=whole, parts=part))
    return _owned_moved(city, owner, [*by, 0.0])


def _without(city: City, owner: np.uint64, *, layout: bool) -> City:
    """Take a building's shell and all on it away, and with `layout` the building itself."""
    batch = city.scene.meshes["buildings"]
    city = with_shells(city, batch.take(np.flatnonzero(batch.object_id != owner)))
    for layer, rows in city.scene.instances.items():
        kept = rows.owner != owner
        if not kept.all():
            city = with_rows(city, layer, taken(rows, kept))
    if not layout:
        return city
    tables = city.layout
    kept_rows = {
        "buildings": (tables.buildings["id"] != owner).to_numpy(),
        "parts": (tables.parts["building"] != owner).to_numpy(),
    }
    changed = {
        name: getattr(tables, name)[kept].reset_index(drop=True) for name, kept in kept_rows.items()
    }
    return replace(city, layout=replace(tables, **changed))


def taken(rows: Instances, kept: ArrayLike) -> Instances:
    """Return some rows of a table of instances."""
    return Instances(**{name: values[kept] for name, values in vars(rows).items()})


def _carriageway(city: City, key: int) -> FloatArray | None:
    """Draw a place in the middle of a street on the ground, (2,) metres."""
    network = city.network
    if network is None or city.ground is None:
        return None
    lines = network.lines
    length = arc_lengths(lines)[1]
    places = locate(lines, np.arange(lines.count), length / 2)[0]
    xmin, ymin, xmax, ymax = city.layout.extent
    inside = (places > [xmin + 5, ymin + 5]).all(1) & (places < [xmax - 5, ymax - 5]).all(1)
    place: FloatArray | None = drawn(places[inside & city.ground.on(places, *ROADWAY)], key)
    return place


# Buildings.


def scaled(factor: float) -> Plant:
    """Return what makes a shell higher or lower than its layout asks."""

    def plant(city: City, key: int) -> Planted | None:
        owner = any_building(city, key)
        if owner is None:
            return None
        level = _level(city, owner)

        def change(points: FloatArray) -> FloatArray:
            high = points[:, 2] > level
            points[high, 2] = level + factor * (points[high, 2] - level)
            return points

        return Planted(_with_vertices(city, owner, change), (id_text(int(owner)),))

    return plant


def low_tower(city: City, key: int) -> Planted | None:
    """Build one of the highest buildings, layout and shell, below what was asked."""
    owner = any_building(city, key)
    if owner is None:
        return None
    table = city.layout.buildings
    height = table["height"].to_numpy(float)
    mine = (table["id"] == owner).to_numpy()
    least = np.floor(10 * 0.9 * height[mine][0]) / 10
    asked = f"n(building, height in [{least:g}, 2000]) >= {int((height >= least).sum())}"
    layout = city.layout
    whole, part = table.copy(), layout.parts.copy()
    whole.loc[mine, "height"] *= LOWER
    part.loc[part["building"] == owner, ["base", "top", "roof_height"]] *= LOWER
    lowered = scaled(LOWER)(city, key)
    assert lowered is not None
    changed = replace(lowered.city, layout=replace(layout, buildings=whole, parts=part))
    return Planted(changed, (), (asked,))


def other_material(city: City, key: int) -> Planted | None:
    """Build a building of brick, or of plaster, where its own material was asked."""
    owner = any_building(city, key)
    if owner is None:
        return None
    layer = Buildings(city, "building")
    row = layer.ids == owner
    word = next((word for word in MATERIALS if layer.has("material", word)[row].any()), None)
    if word is None:
        return None
    count = int(layer.has("material", word).sum())
    painted = _painted(city, owner, "plaster" if word == "brick" else "brick", (0.6, 0.6, 0.6))
    return Planted(painted, (), (f"n(building, material={word}) >= {count}",))


def other_color(city: City, key: int) -> Planted | None:
    """Paint a building red, or blue, where its own colour was asked."""
    owner = any_building(city, key)
    if owner is None:
        return None
    layer = Buildings(city, "building")
    word = str(layer.color_words[layer.ids == owner][0])
    count = int(layer.has("color", word).sum())
    color = PAINT["blue" if word == "red" else "red"]
    return Planted(
        _painted(city, owner, "plaster", color), (), (f"n(building, color={word}) >= {count}",)
    )


def _painted(
    city: City, owner: np.uint64, material: str, color: tuple[float, float, float]
) -> City:
    batch = city.scene.meshes["buildings"]
    vector = area_vectors(batch.vertices, batch.faces)
    wall = np.abs(vector[:, 2]) < UPRIGHT * np.linalg.norm(vector, axis=1)
    mine = wall & (owner == np.repeat(batch.object_id, np.diff(batch.face_start)))
    names = (*batch.materials, material) if material not in batch.materials else batch.materials
    number, tint = batch.material.copy(), batch.tint.copy()
    number[mine], tint[mine] = names.index(material), color
    return with_shells(city, replace(batch, materials=names, material=number, tint=tint))


def no_shell(city: City, key: int) -> Planted | None:
    """Leave a building of the layout without a mesh."""
    owner = any_building(city, key)
    return owner if owner is None else Planted(
        _without(city, owner, layout=False), (id_text(int(owner)),)
    )  # fmt: skip


def fewer(city: City, key: int) -> Planted | None:
    """Leave a building out of layout and scene where a number was asked."""
    owner = any_building(city, key)
    if owner is None:
        return None
    batch = city.scene.meshes["buildings"]
    known = np.isin(city.layout.buildings["id"].to_numpy(np.uint64), batch.object_id)
    return Planted(_without(city, owner, layout=True), (), (f"n(building) == {int(known.sum())}",))


def overlapping(city: City, key: int) -> Planted | None:
    """Put a building, footprint and shell, onto its nearest neighbour."""
    owner = any_building(city, key, LARGE)
    table = city.layout.buildings
    large = table[(shapely.area(table.geometry.to_numpy()) >= LARGE)]
    if owner is None or len(large) < 2:
        return None
    spots = shapely.get_coordinates(shapely.centroid(large.geometry.to_numpy()))
    mine = (large["id"] == owner).to_numpy()
    away = np.hypot(*(spots - spots[mine][0]).T)
    away[mine] = np.inf
    return Planted(_moved(city, owner, spots[int(away.argmin())]), (id_text(int(owner)),))


def displaced(city: City, key: int) -> Planted | None:
    """Put a shell beside its footprint."""
    owner = any_building(city, key)
    if owner is None:
        return None
    shift = np.array([AWAY, 0.0, 0.0])
    moved = _with_vertices(city, owner, lambda points: points + shift)
    return Planted(moved, (id_text(int(owner)),))


def lifted_building(by: float) -> Plant:
    """Return what lifts or sinks a building with all that belongs to it."""

    def plant(city: City, key: int) -> Planted | None:
        owner = any_building(city, key)
        if owner is None:
            return None
        return Planted(_owned_moved(city, owner, [0.0, 0.0, by]), (id_text(int(owner)),))

    return plant


def in_street(city: City, key: int) -> Planted | None:
    """Put a building, footprint and shell, into the middle of a street."""
    owner, place = any_building(city, key, LARGE), _carriageway(city, key)
    if owner is None or place is None:
        return None
    return Planted(_moved(city, owner, place), (id_text(int(owner)),))


def open_solid(city: City, key: int) -> Planted | None:
    """Take one face of a shell away."""
    owner = any_building(city, key)
    if owner is None:
        return None
    batch = city.scene.meshes["buildings"]
    faces = np.flatnonzero(np.repeat(batch.object_id == owner, np.diff(batch.face_start)))
    kept = np.arange(len(batch.faces)) != drawn(faces, key)
    return Planted(with_shells(city, with_faces(batch, kept)), (id_text(int(owner)),))


def with_faces(batch: MeshBatch, kept: NDArray[np.bool_]) -> MeshBatch:
    """Return a batch with some of its faces."""
    start = np.concatenate([[0], np.cumsum(kept)])[batch.face_start].astype(np.int64)
    names = ("faces", "material", "uv", "tint")
    return replace(batch, face_start=start, **{name: getattr(batch, name)[kept] for name in names})


def not_a_number(city: City, key: int) -> Planted | None:
    """Write a coordinate of a shell that is no number."""
    owner = any_building(city, key)
    if owner is None:
        return None

    def change(points: FloatArray) -> FloatArray:
        points[hash_bits(0, "defect/vertex", key) % len(points), 0] = np.nan
        return points

    return Planted(_with_vertices(city, owner, change))


def other_style(city: City, key: int) -> Planted | None:
    """Build most of a town in another style than asked, drawn building by building."""
    layer = Buildings(city, "building")
    style = city.style or "european"
    word = next(
        (w for w in (style, "european", "modern", "asian")
         if np.mean(layer.has("style", w)[layer.applies("style")]) >= 0.6), None,
    ) if len(layer.ids) and layer.applies("style").any() else None  # fmt: skip
    if word is None:
        return None
    table = city.layout.buildings.copy()
    names = table["generator"].to_numpy(object).copy()
    group = _groups(city)
    order = np.argsort(hash_ids(0, "defect/style", table["id"].to_numpy(np.uint64), key))
    for row in order[: int(np.ceil(FOREIGN * len(order)))].tolist():
        own = speaking_of(word).get(group[row], frozenset())
        foreign = sorted(of_any_style().get(group[row], frozenset()) - own)
        names[row] = drawn(foreign, key) if foreign else names[row]
    table["generator"] = names
    table["generator"] = table["generator"].astype(city.layout.buildings["generator"].dtype)
    changed = replace(city, layout=replace(city.layout, buildings=table))
    return Planted(changed, (), (f"share(building, style={word}) >= 0.6",))


def _groups(city: City) -> list[str]:
    """Return the use group of every building, that of its first part."""
    number = groups_of(city.layout, city.seed)
    first = dict(zip(city.layout.parts["building"][::-1], number[::-1], strict=True))
    return [GROUPS[first.get(owner, 0)] for owner in city.layout.buildings["id"]]


# Openings.


def blind_window(city: City, key: int) -> Planted | None:
    """Put a window into a wall that two buildings share."""
    rows = city.scene.instances.get("windows")
    place = _party_wall(city, key)
    if rows is None or not rows.count or place is None:
        return None
    at, out = place
    row = hash_bits(0, "defect/window", key) % rows.count
    position, rotation, scale = rows.position.copy(), rows.rotation.copy(), rows.scale.copy()
    position[row] = at
    rotation[row] = (0.0, 0.0, np.arctan2(out[0], -out[1]))
    scale[row] = 1.0
    changed = replace(rows, position=position, rotation=rotation, scale=scale)
    return Planted(with_rows(city, "windows", changed), (id_text(int(rows.object_id[row])),))


def _party_wall(city: City, key: int) -> tuple[FloatArray, FloatArray] | None:
    """Draw a place on a wall that has a neighbour's before it: (3,) metres, (2,) outward."""
    parts = city.layout.parts
    low = (parts["base"].to_numpy(float) < 0.1) & parts["walls"].to_numpy(bool)
    low &= (parts["top"] - parts["roof_height"]).to_numpy(float) > 3 * STAND
    shapes = parts.geometry.to_numpy()[low]
    level = ground_levels(city.layout, city.terrain)[low]
    owner = parts["building"].to_numpy(np.uint64)[low]
    first, second = shapely.STRtree(shapes).query(shapes, predicate="dwithin", distance=0.02)
    apart = owner[first] != owner[second]
    first, second = first[apart], second[apart]
    shared = shapely.intersection(shapely.boundary(shapes[first]), shapes[second].copy())
    longest = np.array([_longest(line) for line in shared], object)
    kept = np.flatnonzero(shapely.length(longest) > PARTY)
    if not len(kept):
        return None
    row = int(drawn(kept, key))
    ends = shapely.get_coordinates(longest[row])[:2]
    way = (ends[1] - ends[0]) / np.hypot(*(ends[1] - ends[0]))
    out = np.array([way[1], -way[0]])
    at = ends.mean(axis=0)
    if shapely.intersects_xy(shapes[first[row]], *(at + 0.05 * out)):
        out = -out
    z = max(level[first[row]], level[second[row]]) + STAND
    return np.append(at, z), out


def _longest(line: Any) -> Any:
    """Return the longest straight piece of a shape, an empty line of none."""
    points = [shapely.get_coordinates(part) for part in shapely.get_parts(line)]
    pieces = [shapely.linestrings(p[i : i + 2]) for p in points for i in range(len(p) - 1)]
    return max(pieces, key=shapely.length, default=shapely.LineString())


def astray_door(city: City, key: int) -> Planted | None:
    """Turn the only door of a house to the side away from the street."""
    from cityx.checks.facade_checks import street_buildings

    rows = city.scene.instances.get("doors")
    if rows is None or not rows.count:
        return None
    owners, count = np.unique(rows.owner, return_counts=True)
    owner = drawn(np.intersect1d(owners[count == 1], street_buildings(city)), key)
    if owner is None:
        return None
    row = int(np.flatnonzero(rows.owner == owner)[0])
    shape = city.layout.buildings.geometry.to_numpy()[
        (city.layout.buildings["id"] == owner).to_numpy()
    ][0]
    yaw = float(rows.rotation[row, 2])
    inward = -np.array([np.sin(yaw), -np.cos(yaw)])
    depth = float(np.ptp(shapely.get_coordinates(shape) @ inward))
    position, rotation = rows.position.copy(), rows.rotation.copy()
    position[row, :2] += depth * inward
    rotation[row, 2] = yaw + np.pi
    ground = city.ground
    if ground is None or ground.on(position[row, :2] - 0.4 * inward, "sidewalk", "kerb")[0]:
        return None
    position[row, 2] += 1.0  # the yard lies lower than the door's own floor
    changed = replace(rows, position=position, rotation=rotation)
    return Planted(with_rows(city, "doors", changed), (id_text(int(owner)),))


# Things outdoors.


def drawn_row(city: City, layers: tuple[str, ...], key: int) -> tuple[str, int] | None:
    """Draw one instance of the layers: its layer and row; None where they are empty."""
    pairs = [
        (layer, row) for layer in layers if layer in city.scene.instances
        for row in range(city.scene.instances[layer].count)
    ]  # fmt: skip
    return pairs[hash_bits(0, "defect/thing", key) % len(pairs)] if pairs else None


def _thing_put(
    city: City, layer: str, row: int, change: Callable[[FloatArray], ArrayLike]
) -> Planted:
    rows = city.scene.instances[layer]
    position = rows.position.copy()
    position[row] = change(position[row])
    changed = with_rows(city, layer, replace(rows, position=position))
    return Planted(changed, (id_text(int(rows.object_id[row])),))


def lifted(layers: tuple[str, ...], by: float) -> Plant:
    """Return what lifts or sinks a thing."""

    def plant(city: City, key: int) -> Planted | None:
        found = drawn_row(city, layers, key)
        return found and _thing_put(city, *found, lambda p: p + np.array([0.0, 0.0, by]))

    return plant


def on_carriageway(layers: tuple[str, ...]) -> Plant:
    """Return what puts a thing into the middle of a street."""

    def plant(city: City, key: int) -> Planted | None:
        found, place = drawn_row(city, layers, key), _carriageway(city, key)
        if found is None or place is None:
            return None
        return _thing_put(city, *found, lambda p: [*place, p[2]])

    return plant


def beyond_site(city: City, key: int) -> Planted | None:
    """Put a tree beyond the site."""
    found = drawn_row(city, ("trees",), key)
    edge = city.layout.extent[2] + BEYOND
    return found and _thing_put(city, *found, lambda p: [edge, p[1], p[2]])


# Light, land and streets.


def other_weather(city: City, key: int) -> Planted | None:
    """Set another weather than asked for."""
    now = weathers_of(city.environment)
    others = [word for word in WEATHERS if word not in now]
    if not now or not others:
        return None
    changed = weather_of(city.environment, others[hash_bits(0, "defect", key) % len(others)])
    return Planted(replace(city, environment=changed), (), (f"env.weather == {now[0]}",))


def other_time(city: City, key: int) -> Planted | None:
    """Set the sun to another time than asked for."""
    # Words of the day overlap: at dusk it is evening too, and by a low sun as much day as at noon.
    high = np.degrees(city.environment.sun_elevation) > LOW_SUN
    now = drawn([word for word in times_of(city.environment) if high or word != "day"], key)
    if now is None:
        return None
    word = "night" if high else "noon"
    frame = city.frame
    changed = sun_of(city.environment, frame.latitude, frame.longitude, time=word,
                     date=city.environment.date)  # fmt: skip
    return Planted(replace(city, environment=changed), (), (f"env.time == {now}",))


def five_minutes(city: City, key: int) -> Planted | None:
    """Advance the clock by some minutes without moving the sun: no defect."""
    minutes = 1 + hash_bits(0, "defect", key) % 5
    changed = replace(city.environment, hour=city.environment.hour + minutes / 60)
    return Planted(replace(city, environment=changed))
