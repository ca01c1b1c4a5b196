"""Loose things of a city: trees, furniture, lamps, lights, vehicles and people."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.assets.furniture.dressed import main_color, main_material
from cityx.assets.styles.materials import material_named
from cityx.assets.vehicles.movers import UNIFORM_COLOR, WARNING_COLORS, is_person, person_of
from cityx.assets.vehicles.moving import with_movers
from cityx.checks.predicates import words
from cityx.checks.predicates.building_predicates import nearest_word
from cityx.checks.predicates.thing_predicates import CannotTell, Layer, UInt64Array, column
from cityx.checks.predicates.vocabulary import KINDS, PIECES
from cityx.city import Prototype, Scene
from cityx.city.tracks import GAIT, poses_at
from cityx.geometry.arrays import BoolArray, FloatArray
from cityx.system.remembered import Remembered

LAMPS = ("street_lamp",)  # first words of the prototypes of street lamps
# Mode -> gaits, and the least and the greatest speed, metres per second.
_MODES: Mapping[str, tuple[tuple[int, ...], float, float]] = {
    "walk": ((GAIT["walk"], GAIT["push"], GAIT["sit"]), 0.12, 9.0),
    "run": ((GAIT["run"],), 0.0, 12.0),
    "stand": ((GAIT["still"], GAIT["push"]), -1.0, 0.12),
    "sit": ((GAIT["sit"],), -1.0, 0.12),
}
TALKING = 1.8, np.radians(60.0)  # metres between two who talk, and how far aside one may look

OPENINGS = ("window", "door", "shopfront")  # lit rooms are no lights
BEACON = "beacon"  # first word of the materials of blue lights
PLANT, VEHICLE, PERSON = "tree", "vehicle", "person"  # kinds of prototypes

_MOVING: Remembered[Scene] = Remembered()


@dataclass(frozen=True)
class Rows:
    """Instances of a scene: ids, owners, places (n, 3), prototypes, scales and tints (n, 3)."""

    id: UInt64Array
    owner: UInt64Array
    position: FloatArray
    prototype: NDArray[np.int64]
    scale: FloatArray
    tint: FloatArray


@dataclass(frozen=True)
class Pieces(Layer):
    """The instances of one kind: of prototypes that are such things by name, kind or size."""

    @cached_property
    def _scene(self) -> Scene:
        """The scene with what moves."""
        city = self.city
        if city.tracks is None or not city.tracks.count:
            return city.scene
        # Every kind of things asks for it.
        key = city.moment, city.lod
        return _MOVING.get(lambda: with_movers(city).scene, [city.scene, city.tracks], *key)

    @cached_property
    def _poses(self) -> dict[int, tuple[float, int, str]]:
        """Speed, gait and look of what moves, by id."""
        tracks = self.city.tracks
        if tracks is None:
            return {}
        poses = poses_at(tracks, self.city.moment)
        columns = (tracks.object_id[poses.row], poses.speed, poses.gait, tracks.look[poses.row])
        ids, speed, gait, look = (column.tolist() for column in columns)
        return {key: row for key, *row in zip(ids, speed, gait, look, strict=True)}  # type: ignore[misc]

    @cached_property
    def _rows(self) -> Rows:
        scene = self._scene
        wanted = np.array([_is(p, self.kind) for p in scene.prototypes] or [False])
        found = [
            (rows, np.flatnonzero(wanted[rows.prototype])) for rows in scene.instances.values()
        ]

        def joined(name: str, empty: Any) -> NDArray[Any]:
            return np.concatenate([empty, *(getattr(rows, name)[at] for rows, at in found)])

        return self._sized(
            Rows(
                joined("object_id", np.zeros(0, np.uint64)),
                joined("owner", np.zeros(0, np.uint64)),
                joined("position", np.zeros((0, 3))),
                joined("prototype", np.zeros(0, np.int64)),
                joined("scale", np.zeros((0, 3))).astype(float),
                joined("tint", np.zeros((0, 3))).astype(float),
            )
        )

    def _sized(self, rows: Rows) -> Rows:
        """Keep those that measure what the kind must: trees, not shrubs; buses, not cars."""
        if self.kind in ("tree", "shrub"):
            kept = (self._sizes(rows)[:, 2] >= words.SMALLEST_TREE) == (self.kind == "tree")
        elif self.kind == "bus":
            size = self._sizes(rows)
            kept = _between(size[:, :2].max(axis=1), words.VEHICLE_TYPES["bus"])
        elif self.kind in ("traffic", "parked_vehicle"):
            moves = np.array([key in self._poses for key in rows.id.tolist()], bool)
            kept = moves == (self.kind == "traffic")
        else:
            return rows
        return Rows(rows.id[kept], rows.owner[kept], rows.position[kept], rows.prototype[kept],
                    rows.scale[kept], rows.tint[kept])  # fmt: skip

    def _sizes(self, rows: Rows) -> FloatArray:
        """(n, 3) metres of the boxes around them, in their own directions."""
        boxes = np.zeros((len(self._scene.prototypes) + 1, 3))
        for at in np.unique(rows.prototype).tolist():
            boxes[at] = np.ptp(self._scene.prototypes[at].mesh.vertices, axis=0)
        return np.asarray(boxes[rows.prototype] * rows.scale)

    @property
    def ids(self) -> UInt64Array:
        """(n,) ids."""
        return self._rows.id

    @cached_property
    def shapes(self) -> NDArray[Any]:
        """(n,) points."""
        return np.asarray(shapely.points(self._rows.position[:, :2]), object)

    @cached_property
    def names(self) -> Mapping[str, NDArray[Any]]:
        """Sources of those that the layout maps."""
        table = self.city.layout.points
        ids = table["id"].to_numpy(np.uint64)
        if not len(ids):
            return {}
        row = np.minimum(np.searchsorted(ids, self.ids), len(ids) - 1)
        return {"source": np.where(ids[row] == self.ids, column(table, "source")[row], "")}

    def number(self, attribute: str) -> FloatArray:
        """Return heights, lengths or speeds; what never moves has no speed (NaN)."""
        size = self._sizes(self._rows)
        if attribute == "height":
            return np.asarray(size[:, 2])
        if attribute == "length":
            return np.asarray(size[:, :2].max(axis=1))
        if attribute == "width":
            return np.asarray(size[:, :2].min(axis=1))
        if attribute == "scale":
            return np.asarray(np.cbrt(np.prod(self._rows.scale, axis=1)))
        if attribute == "speed":
            return np.array([row[0] for row in self._moving(attribute)], float)
        return super().number(attribute)

    def has(self, attribute: str, word: str) -> BoolArray:
        """Return which are lit, or of a type."""
        if attribute == "on":
            return np.full(len(self.ids), (self.city.environment.lamps > 0) == (word == "true"))
        if attribute == "species":
            names = (f"{word}_", f"tree_{word}_")
            of = [p.name.startswith(names) for p in self._scene.prototypes] or [False]
            return np.array(of, bool)[self._rows.prototype]
        if attribute == "type" and word in words.VEHICLE_LOOKS:
            return self._named(words.VEHICLE_LOOKS[word])
        if attribute == "beacons":
            lit = np.array([_has_beacons(p) for p in self._scene.prototypes] or [False])
            return np.asarray(lit[self._rows.prototype] == (word == "true"))
        if attribute == "moves":
            return np.asarray(self.moves == (word == "true"))
        if attribute == "color" and KINDS[self.kind] == "vehicle":
            return np.asarray(self._paints == word)
        if attribute == "color":
            return np.asarray(self._looks[1] == word)
        if attribute == "material":
            return np.isin(self._looks[0], words.THING_MATERIALS[word])
        if attribute == "type" and KINDS[self.kind] == "vehicle":
            return _between(self.number("length"), words.VEHICLE_TYPES[word])
        if attribute == "type":
            return np.asarray(self._neon == (word == "neon"))
        if len(self.ids) == 0:
            return np.zeros(0, bool)
        if attribute == "mode":
            return self._in_mode(word)
        if attribute in ("gender", "age", "gear"):
            own = "sex" if attribute == "gender" else attribute
            looks = [row[2] for row in self._moving(attribute)]
            return np.array([is_person(x) and getattr(person_of(x), own) == word for x in looks])
        if attribute == "wears":
            looks = [row[2] for row in self._moving(attribute)]
            colors = (UNIFORM_COLOR,) if word == "uniform" else WARNING_COLORS
            return np.array([is_person(x) and person_of(x).top_color in colors for x in looks])
        return super().has(attribute, word)

    def _named(self, first: tuple[str, ...]) -> BoolArray:
        """(n,) whose prototypes begin with some words."""
        of = [p.name.startswith(first) for p in self._scene.prototypes] or [False]
        return np.array(of, bool)[self._rows.prototype]

    @cached_property
    def _looks(self) -> tuple[NDArray[np.str_], NDArray[np.str_]]:
        """(n,) roots of the materials that things mainly are of, and words of their colours."""
        count = len(self._scene.prototypes)
        roots, colors = np.zeros(count + 1, "<U32"), np.zeros((count + 1, 3))
        for at in np.unique(self._rows.prototype).tolist():
            one = self._scene.prototypes[at]
            roots[at] = main_material(one.name, one.mesh)
            colors[at] = main_color(one.name, one.mesh)
        if not len(self.ids):
            return np.zeros(0, "<U1"), np.zeros(0, "<U1")
        tinted = colors[self._rows.prototype] * self._rows.tint
        return roots[self._rows.prototype], nearest_word(tinted)

    @cached_property
    def _paints(self) -> NDArray[np.str_]:
        """(n,) words for the colours of the paint of vehicles."""
        return nearest_word(0.8 * self._rows.tint) if len(self.ids) else np.zeros(0, "<U1")

    def _in_mode(self, word: str) -> BoolArray:
        """(n,) which people walk, run, stand, sit or talk to each other."""
        speed, gait, _ = zip(*self._moving("mode"), strict=True)
        gaits, low, high = _MODES["stand" if word == "talk" else word]
        found = np.isin(gait, gaits) & (np.array(speed) >= low) & (np.array(speed) <= high)
        return found & self._face_each_other if word == "talk" else np.asarray(found)

    @cached_property
    def _face_each_other(self) -> BoolArray:
        """(n,) which look at somebody next to them."""
        tracks = self.city.tracks
        assert tracks is not None
        poses = poses_at(tracks, self.city.moment)
        ids = tracks.object_id[poses.row].tolist()
        heading = dict(zip(ids, poses.heading.tolist(), strict=True))
        at = self._rows.position[:, :2]
        mine = np.array([heading.get(key, np.nan) for key in self.ids.tolist()])
        way = at[None] - at[:, None]  # (n, n, 2)
        far = np.hypot(way[..., 0], way[..., 1])
        aside = np.abs(np.arctan2(way[..., 1], way[..., 0]) - mine[:, None])
        aside = np.minimum(aside % (2 * np.pi), -aside % (2 * np.pi))
        near = (far > 0) & (far <= TALKING[0]) & (aside <= TALKING[1])
        return np.asarray(near.any(axis=1))

    @cached_property
    def moves(self) -> BoolArray:
        """(n,) whether each moves by itself."""
        return np.array([key in self._poses for key in self.ids.tolist()], bool)

    def _moving(self, attribute: str) -> list[tuple[float, int, str]]:
        """Return speed, gait and look of each; NaN, -1 and "" of what only stands there."""
        if not self.moves.any():
            raise CannotTell(
                f"the city has no {self.kind} that moves, so none has a {attribute}; "
                f"{len(self.ids)} stand in it"
            )
        return [self._poses.get(key, (np.nan, -1, "")) for key in self.ids.tolist()]

    @cached_property
    def _neon(self) -> BoolArray:
        """(n,) whether a light is a coloured one on a building."""
        colored = np.array([_glows(p, least=words.GLOW) for p in self._scene.prototypes], bool)
        return np.asarray(colored[self._rows.prototype] & (self._rows.owner > 0), bool)


def _is(prototype: Prototype, kind: str) -> bool:
    """Return whether a prototype is a thing of a kind."""
    if kind in ("tree", "shrub"):
        return prototype.kind == PLANT
    if kind in ("vehicle", "bus", "traffic", "parked_vehicle"):
        return prototype.kind == VEHICLE
    if kind == "pedestrian":
        return prototype.kind == PERSON
    if kind == "streetlight":
        return prototype.name.startswith(LAMPS)
    if kind == "light":
        return prototype.kind not in OPENINGS and _glows(prototype)
    return prototype.name.startswith(PIECES[kind])


def _glows(prototype: Prototype, least: float = 0.0) -> bool:
    """Return whether some material of a prototype emits light of at least a saturation."""
    materials = [material_named(name) for name in prototype.mesh.materials]
    return any(
        material.emission > 0 and 1 - min(material.color) / max(*material.color, 1e-9) >= least
        for material in materials
    )


def _has_beacons(prototype: Prototype) -> bool:
    """Return whether a prototype bears beacons that emit light."""
    names = (name for name in prototype.mesh.materials if name.startswith(BEACON))
    return any(material_named(name).emission > 0 for name in names)


def _between(values: FloatArray, limits: tuple[float, float]) -> BoolArray:
    return np.asarray((values >= limits[0]) & (values < limits[1]))
