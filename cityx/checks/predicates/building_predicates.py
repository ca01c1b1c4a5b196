"""Buildings, measured on their shells, their footprints and what they are built of."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.assets.styles.materials import material_named, srgb_to_linear
from cityx.assets.styles.palette_tables import GROUPS
from cityx.assets.styles.palettes import building_groups, owner_rows
from cityx.assets.styles.style_shares import of_any_style, speaking_of
from cityx.checks.predicates import words
from cityx.checks.predicates.body_parts import BodyPart, body_parts
from cityx.checks.predicates.thing_predicates import CannotTell, TableLayer, UInt64Array, column
from cityx.checks.predicates.whereabouts import is_in_part
from cityx.checks.predicates.words import COLORS
from cityx.city import City
from cityx.city.bounds import OURS
from cityx.city.levels import ground_levels
from cityx.city.mesh import MeshBatch
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.solids import area_vectors

# Colours by their words: the nearest in CIELAB of the table of words.

# Linear sRGB to XYZ of white D65 as 1 (IEC 61966-2-1).
_TO_XYZ = np.array([[0.4339, 0.3763, 0.1898], [0.2126, 0.7152, 0.0722], [0.0177, 0.1095, 0.8728]])
_EPSILON, _KAPPA = 216 / 24389, 24389 / 27  # of CIE 15


def to_lab(linear: FloatArray) -> FloatArray:
    """Return CIELAB (n, 3) of linear RGB (n, 3), white being 1, 1, 1."""
    xyz = np.clip(linear, 0.0, 1.0) @ _TO_XYZ.T
    f = np.where(xyz > _EPSILON, np.cbrt(xyz), (_KAPPA * xyz + 16) / 116)
    return np.column_stack([
        116 * f[:, 1] - 16, 500 * (f[:, 0] - f[:, 1]), 200 * (f[:, 1] - f[:, 2])
    ])  # fmt: skip


def nearest_word(linear: FloatArray) -> NDArray[Any]:
    """Return the word, (n,) str, of linear RGB colours (n, 3)."""
    names = np.array([word for word, shades in COLORS.items() for _ in shades])
    table = to_lab(np.array([srgb_to_linear(s) for shades in COLORS.values() for s in shades]))
    away = np.linalg.norm(to_lab(linear)[:, None] - table, axis=2)
    return np.asarray(names[np.argmin(away, axis=1)])


POINTS = 0.02  # of a share of the ground under buildings, by which it may be missed
AGREES = 0.25  # metres between the height of the layout and that of the shell
# Vertical part of a normal below which a face is a wall; a roof of 85 degrees is none.
UPRIGHT = 0.03
# Keys of tags that say what a building serves.
SERVING = (
    "shop", "amenity", "leisure", "office", "man_made", "tower:type", "power", "industrial",
    "social_facility", "military", "diplomatic", "telecom", "healthcare", "historic",
)  # fmt: skip
AROUND = 60.0  # metres round a building whose built share is told
GRID, LEVEL = 40, 1.0  # places along a side at which land is measured; metres of level land
LEAST_HOUSE = 30.0  # square metres; smaller ones are sheds and garages
TOUCH, SHARED_WALL = 0.2, 2.5  # metres between houses wall to wall; of a wall that they share
GARDENS, BESIDE_GARDEN = ("garden", "grass"), 0.6  # land of a house; metres from it
DRIVES, BESIDE_DRIVE = ("road_area",), 1.0
ASSETS = "building_assets"
TRIM = "trim"  # copings and gutters, which are no part of a roof


def built_around(shapes: NDArray[Any], extent: tuple[float, float, float, float]) -> FloatArray:
    """Return the share of the ground within `AROUND` metres of buildings that is built on, (n,)."""
    middles = shapely.centroid(shapes)
    near, of = shapely.STRtree(middles).query(middles, predicate="dwithin", distance=AROUND)
    built = np.bincount(near, shapely.area(shapes)[of], minlength=len(shapes))
    ground = shapely.area(
        shapely.intersection(shapely.buffer(middles, AROUND), shapely.box(*extent))
    )
    return np.asarray(built / np.maximum(ground, 1e-9))


def box_sides(shapes: NDArray[Any]) -> FloatArray:
    """Return the longer and the shorter side of the smallest boxes round shapes, (n, 2) metres."""
    found = np.zeros((len(shapes), 2))
    for row, box in enumerate(shapely.oriented_envelope(shapes).tolist()):
        ring = shapely.get_coordinates(box)
        if len(ring) > 3:
            found[row] = np.hypot(*(ring[1:3] - ring[:2]).T)
    return np.sort(found, axis=1)[:, ::-1]


def attached(shapes: NDArray[Any]) -> FloatArray:
    """Return how many others each building shares a wall with, (n,); sheds and garages are none."""
    houses = shapely.area(shapes) >= LEAST_HOUSE
    one, other = shapely.STRtree(shapes).query(shapes, "dwithin", distance=TOUCH)
    kept = (one != other) & houses[one] & houses[other]
    one, other = one[kept], other[kept]
    near = shapely.buffer(shapes[other], TOUCH, join_style="mitre")
    shared = shapely.length(shapely.intersection(shapely.boundary(shapes[one]), near))
    return np.bincount(one[shared >= SHARED_WALL], minlength=len(shapes)).astype(float)


@dataclass(frozen=True)
class Faces:
    """Faces of buildings: row of the layer, area, vertical part of the normal, material, colour.

    The normal points out; floors, which lie on the ground, are neither walls nor roofs. `middle`,
    (n, 3), is NaN for assets.
    """

    row: IntArray
    area: FloatArray
    up: FloatArray
    material: NDArray[np.str_]
    color: FloatArray
    middle: FloatArray

    @property
    def walls(self) -> BoolArray:
        """Whether each face is part of a wall."""
        return np.asarray(np.abs(self.up) < UPRIGHT)

    @property
    def roofs(self) -> BoolArray:
        """Whether each face is part of a roof: its covering, not its copings."""
        return np.asarray((self.up >= UPRIGHT) & (self.material != TRIM))


@dataclass(frozen=True)
class Buildings(TableLayer):
    """The buildings of a city that stand; those of its layout while none is built."""

    @cached_property
    def _kept(self) -> IntArray:
        table = self.city.layout.buildings
        built = is_built(self.city)
        rows = np.arange(len(table)) if not self._any_built else np.flatnonzero(built)
        if self.kind == "building":
            return rows
        return np.asarray(rows[self._typed(self.kind, rows)])

    @cached_property
    def _any_built(self) -> bool:
        scene = self.city.scene
        return "buildings" in scene.meshes or ASSETS in scene.instances

    @cached_property
    def _table(self) -> Any:
        return self.city.layout.buildings.iloc[self._kept]

    @property
    def remark(self) -> str:
        """Return the remark that nothing is built yet."""
        return "" if self._any_built else "of the layout; none is built yet"

    @cached_property
    def heights(self) -> FloatArray:
        """(n,) metres from the ground to the top, see `_heights`."""
        return _heights(self.city)[self._kept]

    def number(self, attribute: str) -> FloatArray:
        """Return heights, storeys or areas of footprints."""
        if attribute == "height":
            return self.heights
        if attribute in ("floors", "levels"):
            return np.asarray(self._table["levels"].to_numpy(float))
        if attribute == "area":
            return np.asarray(shapely.area(self.shapes))
        if attribute in ("length", "width"):
            return box_sides(self.shapes)[:, int(attribute == "width")]
        if attribute == "around":
            return built_around(self.shapes, self.city.layout.extent)
        if attribute == "rise":
            return self._rises()
        if attribute == "attached":
            return attached(self.shapes)
        if attribute == "garden":
            return self._land_at(GARDENS, BESIDE_GARDEN)
        if attribute == "garage":
            table = self.city.layout.buildings
            garages = table.geometry.to_numpy()[(column(table, "use") == "garage")]
            return self._beside(garages, BESIDE_DRIVE)
        if attribute == "driveway":
            return self._land_at(DRIVES, BESIDE_DRIVE)
        if attribute in words.COUNTED_PARTS:
            return np.array([len(own) for own in self._bodies(attribute[:-1])], float)
        if attribute.endswith("_height"):
            return self._part_heights(attribute.removesuffix("_height"))
        return super().number(attribute)

    def has(self, attribute: str, word: str) -> BoolArray:
        """Return which have a style, use, type, material or colour."""
        if attribute == "style":
            return self._speaks(speaking_of(word))
        if attribute == "use":
            return np.isin(self._groups, [GROUPS.index(name) for name in words.USES[word]])
        if attribute == "generator":
            return np.asarray(column(self._table, "generator") == word)
        if attribute == "tag":
            known = words.TAGS.get(word, (word,))
            serves = [not known_of.isdisjoint(known) for known_of in self._serves]
            named: BoolArray = np.isin(column(self._table, "use"), known)
            return np.asarray(named | np.array(serves, bool))
        if attribute == "type":
            return self._typed(word, self._kept)
        if attribute == "part":
            return is_in_part(self.shapes, word, self.city.layout.extent)
        if attribute == "added":
            return np.asarray(self._added() == (word == "true"))
        if attribute in ("material", "roof"):
            return self._mostly(words.MATERIALS[word], walls=attribute == "material")
        if attribute == "color":
            return np.asarray(self.color_words == word)
        if attribute == "has":
            return np.isin(self.ids, self._parts_of(word)[0])
        part, _, look = attribute.rpartition("_")
        if part in words.BODY_PARTS:
            return self._look_of_parts(part, look, word)
        if attribute.endswith("_color") and attribute != "roof_color":
            return self._mostly_painted(attribute.removesuffix("_color"), word)
        if attribute == "roof_color":
            return np.asarray(nearest_word(self.mean_colors(walls=False)) == word)
        if attribute == "roof_form":
            return np.asarray(self._flat == (word == "flat"))
        if attribute == "roof_shape":
            return np.asarray(self._roof_shapes == word)
        return super().has(attribute, word)

    def _added(self) -> BoolArray:
        """Return which are of no file: built because they were asked for, or of an invented town.

        Halves of a building of a file are of the file.
        """
        source = self._table["source"].str
        return np.asarray(source.startswith(OURS) & ~source.startswith("made/half/"), bool)

    @cached_property
    def _serves(self) -> list[frozenset[str]]:
        """What each serves, by its tags: bakery, cinema."""
        tags = (json.loads(text or "{}") for text in column(self._table, "tags"))
        return [frozenset(str(own[key]) for key in SERVING if key in own) for own in tags]

    def applies(self, attribute: str) -> BoolArray:
        """Return whether an attribute applies: sheds, works and churches have no style."""
        return self._speaks(of_any_style()) if attribute == "style" else super().applies(attribute)

    def _speaks(self, generators: Mapping[str, frozenset[str]]) -> BoolArray:
        name = column(self._table, "generator")
        if len(name) and not (name != "").any():
            raise CannotTell("no building has a generator yet, so none has a style")
        found = np.zeros(len(name), bool)
        for group, known in generators.items():
            found |= (self._groups == GROUPS.index(group)) & np.isin(name, sorted(known))
        return found

    @cached_property
    def _groups(self) -> IntArray:
        return building_groups(self.city.layout, self.city.seed)[self._kept]

    def _typed(self, word: str, rows: IntArray) -> BoolArray:
        """Return which rows of the layout measure what a type must."""
        form = words.BUILDING_TYPES[word]
        table = self.city.layout.buildings.iloc[rows]
        area = shapely.area(table.geometry.to_numpy())
        height, floors = _heights(self.city)[rows], table["levels"].to_numpy(float)
        kept = height >= form.slender * np.sqrt(area)
        limits = ((height, form.height), (floors, form.floors), (area, form.area))
        for value, (low, high) in limits:
            kept &= (value >= low) & (value <= high)
        if form.uses:
            wanted = [GROUPS.index(name) for name in form.uses]
            kept &= np.isin(building_groups(self.city.layout, self.city.seed)[rows], wanted)
        return np.asarray(kept, bool)

    @cached_property
    def faces(self) -> Faces:
        """The faces of all shells and assets."""
        if not self._any_built:
            raise CannotTell("no building is built yet, so none has a material or a colour")
        return _faces(self.city, self.ids)

    def _mostly(self, materials: tuple[str, ...], *, walls: bool) -> BoolArray:
        faces = self.faces
        wanted = faces.walls if walls else faces.roofs
        total = np.bincount(faces.row, faces.area * wanted, minlength=len(self.ids))
        own = wanted & np.isin(faces.material, materials)
        part = np.bincount(faces.row, faces.area * own, minlength=len(self.ids))
        return np.asarray((part >= words.MAIN_SHARE * total) & (total > 0))

    @cached_property
    def colors(self) -> FloatArray:
        """(n, 3) linear RGB of the walls, the mean over their area."""
        return self.mean_colors(walls=True)

    @cached_property
    def _flat(self) -> BoolArray:
        """(n,) whether most of what faces up is flat."""
        faces = self.faces
        roof = np.bincount(faces.row, faces.area * faces.roofs, minlength=len(self.ids))
        level = faces.area * (faces.up >= words.FLAT_ROOF)
        return np.asarray(np.bincount(faces.row, level, minlength=len(self.ids)) > roof / 2)

    @cached_property
    def _roof_shapes(self) -> NDArray[Any]:
        """(n,) words of roof:shape, each that of the largest volume of a building."""
        parts = self.city.layout.parts
        order = np.argsort(shapely.area(parts.geometry.to_numpy()), kind="stable")
        largest = dict(
            zip(
                parts["building"].to_numpy()[order], column(parts, "roof_shape")[order], strict=True
            )
        )
        return np.array([largest.get(one, "") for one in self.ids], dtype=str)

    def mean_colors(self, *, walls: bool) -> FloatArray:
        """(n, 3) linear RGB of walls or roofs, the mean over their area."""
        faces = self.faces
        weight = faces.area * (faces.walls if walls else faces.roofs)
        total = np.maximum(np.bincount(faces.row, weight, minlength=len(self.ids)), 1e-9)
        sums = [
            np.bincount(faces.row, weight * channel, minlength=len(self.ids))
            for channel in faces.color.T
        ]
        return np.asarray(np.column_stack(sums) / total[:, None])

    def main_materials(self, *, walls: bool) -> list[str]:
        """Return the material of most of each building's walls or roofs, "" where it has none."""
        faces = self.faces
        names, of = np.unique(faces.material, return_inverse=True)
        area = np.zeros((len(self.ids), max(len(names), 1)))
        counts = faces.walls & (faces.material != TRIM) if walls else faces.roofs
        np.add.at(area, (faces.row, of), faces.area * counts)
        most = area.argmax(axis=1)
        some = area.max(axis=1, initial=0.0) > 0
        return [
            str(names[k]) if has else ""
            for k, has in zip(most.tolist(), some.tolist(), strict=True)
        ]

    def _parts_of(self, part: str) -> tuple[NDArray[np.uint64], FloatArray]:
        """(k,) owners and (k, 3) linear colours of the parts of a kind in the scene."""
        scene = self.city.scene
        of_part = [one.name.startswith(words.PARTS[part]) for one in scene.prototypes]
        such = np.array(of_part or [False])
        owners, colors = [np.zeros(0, np.uint64)], [np.zeros((0, 3))]
        for rows in scene.instances.values():
            own = such[rows.prototype] & (rows.owner > 0)
            owners.append(rows.owner[own])
            colors.append(0.8 * rows.tint[own].astype(float))
        return np.concatenate(owners), np.concatenate(colors)

    def _mostly_painted(self, part: str, word: str) -> BoolArray:
        """(n,) whether most parts of a kind that a building has are of a colour."""
        owner, color = self._parts_of(part)
        row = np.minimum(np.searchsorted(self.ids, owner), max(len(self.ids) - 1, 0))
        own = self.ids[row] == owner if len(self.ids) else np.zeros(len(owner), bool)
        painted = nearest_word(color) == word if len(owner) else np.zeros(0, bool)
        total = np.bincount(row[own], minlength=len(self.ids))
        found = np.bincount(row[own & painted], minlength=len(self.ids))
        return np.asarray((total > 0) & (2 * found > total))

    def _rises(self) -> FloatArray:
        """(n,) how high the ground of each lies: 0 at the lowest land of the site, 1 at its top.

        0 on level land.
        """
        terrain, (xmin, ymin, xmax, ymax) = self.city.terrain, self.city.layout.extent
        x, y = (np.linspace(*ends, GRID) for ends in ((xmin, xmax), (ymin, ymax)))
        land = terrain.height_at(np.column_stack([np.tile(x, GRID), np.repeat(y, GRID)]))
        low, high = float(np.nanmin(land)), float(np.nanmax(land))
        own = terrain.height_at(shapely.get_coordinates(shapely.centroid(self.shapes)))
        return np.asarray((own - low) / (high - low) if high - low > LEVEL else np.zeros(len(own)))

    def _land_at(self, kinds: tuple[str, ...], near: float) -> FloatArray:
        """(n,) square metres of land of some kinds that each building stands on or at."""
        areas = self.city.layout.areas
        shapes = areas.geometry.to_numpy()[areas["kind"].isin(kinds).to_numpy()]
        return self._beside(shapes, near)

    def _beside(self, shapes: NDArray[Any], near: float) -> FloatArray:
        """(n,) square metres of those of some shapes that are near each building."""
        own, land = shapely.STRtree(shapes).query(self.shapes, "dwithin", distance=near)
        return np.bincount(own, shapely.area(shapes)[land], minlength=len(self.ids)).astype(float)

    @cached_property
    def _found_bodies(self) -> dict[str, list[list[BodyPart]]]:
        return {}

    def _bodies(self, part: str) -> list[list[BodyPart]]:
        """Return the towers, domes, ... of each building."""
        if part not in self._found_bodies:
            own: list[list[BodyPart]] = [[] for _ in self.ids]
            for one in body_parts(self.city.layout, part, self.ids):
                own[int(np.searchsorted(self.ids, np.uint64(one.building)))].append(one)
            self._found_bodies[part] = own
        return self._found_bodies[part]

    def _part_heights(self, part: str) -> FloatArray:
        """(n,) metres from the ground to the top of the highest part of a kind, 0 without one."""
        return np.array(
            [max((self._top(row, one) for one in own), default=0.0)
             for row, own in enumerate(self._bodies(part))]
        )  # fmt: skip

    def _top(self, row: int, part: BodyPart) -> float:
        """Return the height of a part by the shell, where there is one, else as the layout says."""
        batch = self.city.scene.meshes.get("buildings")
        at = -1 if batch is None else int(np.searchsorted(batch.object_id, self.ids[row]))
        if batch is None or at >= batch.count or batch.object_id[at] != self.ids[row]:
            return part.top
        points = batch.vertices[batch.vertex_start[at] : batch.vertex_start[at + 1]]
        plan = shapely.buffer(part.outline, AGREES)
        shapely.prepare(plan)
        own = points[shapely.contains_xy(plan, points[:, 0], points[:, 1]), 2]
        return float(own.max() - self._levels[row]) if len(own) else part.top

    @cached_property
    def _levels(self) -> FloatArray:
        """(n,) metres of the ground that each building stands on, of the highest of its bays."""
        owner, described = owner_rows(self.city.layout)
        level = np.full(len(self.city.layout.buildings), -np.inf)
        ground = ground_levels(self.city.layout, self.city.terrain)
        np.maximum.at(level, owner[described], ground[described])
        return np.where(np.isfinite(level), level, 0.0)[self._kept]

    def _look_of_parts(self, part: str, look: str, word: str) -> BoolArray:
        """(n,) whether all parts of a kind that a building has are of a colour or a material."""
        faces, bodies = self.faces, self._bodies(part)
        shown = faces.roofs if words.BODY_PARTS[part].tops else faces.walls
        found = np.zeros(len(self.ids), bool)
        for row in (at for at, own in enumerate(bodies) if own):
            of_it = np.flatnonzero(shown & (faces.row == row))
            good = []
            for one in bodies[row]:
                plan, x, y, z = one.outline.buffer(AGREES), *faces.middle[of_it].T
                there = of_it[shapely.contains_xy(plan, x, y) & (z > self._levels[row] + one.foot)]
                weight = faces.area[there]
                if look == "color" and weight.sum() > 0:
                    mean = (weight @ faces.color[there] / weight.sum())[None]
                    good.append(str(nearest_word(mean)[0]) == word)
                else:
                    known = np.isin(faces.material[there], words.MATERIALS.get(word, ()))
                    good.append(2 * float(weight[known].sum()) >= float(weight.sum()) > 0)
            found[row] = all(good)
        return found

    @cached_property
    def color_words(self) -> NDArray[Any]:
        """(n,) word of each building's colour."""
        return nearest_word(self.colors)


def looks_of_faces(
    mesh: MeshBatch, faces: IntArray, of: IntArray, count: int
) -> tuple[NDArray[np.str_], NDArray[np.str_]]:
    """Return what each of some things mainly is of, and the word of its colour, (n,) each.

    Both are "" of a thing without faces.

    Parameters
    ----------
    mesh
        What holds all of them.
    faces, of
        (k,) faces of the mesh, and the thing that each is of, 0 to `count`.
    """
    known = [material_named(name) for name in mesh.materials]
    roots = np.array([one.root for one in known] or [""], "U32")[mesh.material[faces]]
    base = np.array([one.color for one in known] or [(0.5, 0.5, 0.5)])[mesh.material[faces]]
    takes = np.array([one.takes_tint for one in known] or [True])[mesh.material[faces]]
    color = base * np.where(takes[:, None], mesh.tint[faces], 1.0)
    area = np.linalg.norm(area_vectors(mesh.vertices, mesh.faces[faces]), axis=1)
    names, name = np.unique(roots, return_inverse=True)
    total = np.zeros((count, max(len(names), 1)))
    np.add.at(total, (of, name), area)
    most = total.argmax(axis=1)
    main = np.zeros(count, "U32")
    if len(names):
        main = np.where(total.max(axis=1) > 0, names[most], "")
    own = name == most[of] if len(faces) else np.zeros(0, bool)
    weight = np.maximum(np.bincount(of[own], area[own], minlength=count), 1e-9)
    mean = np.column_stack([
        np.bincount(of[own], area[own] * channel[own], minlength=count) for channel in color.T
    ]) / weight[:, None]  # fmt: skip
    if not count:
        return main, np.zeros(0, "U1")
    return main, np.where(total.max(axis=1) > 0, nearest_word(mean), "")


def share_slack(area: FloatArray) -> float:
    """Return by how much a share of the ground may be missed: half a usual building, if larger."""
    return max(POINTS, float(np.median(area) / area.sum()) / 2) if len(area) else POINTS


def is_built(city: City) -> BoolArray:
    """(n,) whether each building of the layout has a shape in the scene."""
    ids = [np.zeros(0, np.uint64)]
    if "buildings" in city.scene.meshes:
        ids.append(city.scene.meshes["buildings"].object_id)
    if ASSETS in city.scene.instances:
        ids.append(city.scene.instances[ASSETS].owner)
    return np.isin(city.layout.buildings["id"].to_numpy(), np.concatenate(ids))


def _heights(city: City) -> FloatArray:
    """(n,) metres of every building of the layout, by its shell where the two disagree."""
    table = city.layout.buildings
    height: FloatArray = table["height"].to_numpy(float).copy()
    batch = city.scene.meshes.get("buildings")
    if batch is None or not batch.count:
        return height
    full = np.diff(batch.vertex_start) > 0
    top = np.full(batch.count, np.nan)
    starts = batch.vertex_start[:-1][full]
    top[full] = np.maximum.reduceat(batch.vertices[:, 2], starts)
    owner, described = owner_rows(city.layout)
    level = np.full(len(table), -np.inf)
    # Of a house that steps down a slope the highest bay counts.
    np.maximum.at(level, owner[described], ground_levels(city.layout, city.terrain)[described])
    ids = table["id"].to_numpy(np.uint64)
    row = np.minimum(np.searchsorted(ids, batch.object_id), max(len(ids) - 1, 0))
    known = (ids[row] == batch.object_id) & np.isfinite(level[row])
    shell = top[known] - level[row[known]]
    differs = np.abs(shell - height[row[known]]) > AGREES
    height[row[known][differs]] = shell[differs]
    return height


def _faces(city: City, ids: UInt64Array) -> Faces:
    found = []
    batch = city.scene.meshes.get("buildings")
    if batch is not None:
        found.append(_faces_of(batch, batch.object_id, ids))
    rows = city.scene.instances.get(ASSETS)
    for at in range(0 if rows is None else rows.count):
        assert rows is not None
        mesh = city.scene.prototypes[int(rows.prototype[at])].mesh
        one = _faces_of(mesh, np.full(mesh.count, rows.owner[at]), ids)
        tint = rows.tint[at].astype(float)
        scale = float(np.prod(rows.scale[at].astype(float))) ** (2 / 3)
        nowhere = np.full((len(one.row), 3), np.nan)
        found.append(
            Faces(one.row, one.area * scale, one.up, one.material, one.color * tint, nowhere)
        )
    if not found:
        raise CannotTell("no building is built yet")
    names = ("row", "area", "up", "material", "color", "middle")
    return Faces(*(np.concatenate([getattr(each, name) for each in found]) for name in names))


def _faces_of(batch: MeshBatch, owner: UInt64Array, ids: UInt64Array) -> Faces:
    """Measure the faces of the objects among some ids, sorted."""
    triangles, face = batch.triangles()
    corner = batch.vertices[triangles]
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]) / 2
    vector = np.column_stack([
        np.bincount(face, part, minlength=len(batch.faces)) for part in normal.T
    ])  # fmt: skip
    area = np.linalg.norm(vector, axis=1)
    up = vector[:, 2] / np.maximum(area, 1e-12)
    owners = owner[batch.face_object()]
    row = np.minimum(np.searchsorted(ids, owners), max(len(ids) - 1, 0))
    kept = (ids[row] == owners) if len(ids) else np.zeros(len(owners), bool)
    known = [material_named(name) for name in batch.materials]
    roots = np.array([material.root for material in known] or [""], "U32")
    base = np.array([material.color for material in known] or [(0.5, 0.5, 0.5)])
    takes = np.array([material.takes_tint for material in known] or [True])
    tint = np.where(takes[batch.material][:, None], batch.tint, 1.0)
    color = base[batch.material] * tint
    count = np.maximum(np.bincount(face, minlength=len(batch.faces)), 1)[:, None]
    middle = np.column_stack([
        np.bincount(face, part, minlength=len(batch.faces)) for part in corner.mean(axis=1).T
    ]) / count  # fmt: skip
    return Faces(
        row[kept], area[kept], up[kept], roots[batch.material][kept], color[kept], middle[kept]
    )
