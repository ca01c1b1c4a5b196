"""Renewal: after a change of the layout, rebuild what depends on it and keep everything else.

The actions that made streets, ground and what stands there run twice, with the arguments they had:
on the layout as it was and as it is to be. What comes out the same both times does not depend on
the change and stays in the city as it lies there, whatever was done to it by hand.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import shapely

from cityx.city.city import City
from cityx.city.content import differing_ids, hash_instances, hash_mesh, hash_table
from cityx.city.ground import ROADWAY, Ground
from cityx.city.layout import SCHEMA, Layout
from cityx.city.mesh import MeshBatch, concatenate
from cityx.city.rows import take_rows
from cityx.city.scene import Instances, Scene
from cityx.city.terrain import Terrain
from cityx.edit.objects.layer_rows import with_rows
from cityx.geometry.arrays import BoolArray
from cityx.geometry.clearance import near_any
from cityx.ids import UInt64Array, stable_id
from cityx.protocol.formats import Format
from cityx.protocol.gate import Call
from cityx.protocol.registry import Registry, registry
from cityx.protocol.running import run_step
from cityx.protocol.stages import Stage, stages_after

STAGES = (Stage.ROAD, Stage.NATURE)  # of what follows from streets and open ground
ARRANGED = ("ground", "surroundings")  # meshes that are arranged anew as a whole
LYING = ("street_covers", "walk_covers")  # layers of what lies in the surface of a street
CLOSE = ("vehicles",)  # layers whose rows of things leave no room between them
REACH = 10.0  # metres beyond kerbs and walks within which things follow a street that changes
APART = 1.0  # metres
ONTO_ROADWAY = ("trees", "street_furniture", "street_pieces", "park_pieces")


def renewed(
    city: City, layout: Layout, actions: Registry | None = None, *, surface: bool = False
) -> City:
    """Return a city with another layout, with everything rebuilt that depends on the difference.

    Parameters
    ----------
    city
        City whose buildings stay as they are.
    layout
        What it is to be laid out as; its site must be the same.
    actions
        The registry; that of all actions when left out.
    surface
        Whether only the surface of the ground changes: what stands on it stays then.

    Returns
    -------
    renewed
        Objects that do not depend on the difference are the same, byte for byte. What was changed
        by hand stays changed, unless it would stand on a carriageway now.

    Raises
    ------
    ActionFailed, ActionRejected
        If something cannot be made with the new layout.
    """
    known = registry() if actions is None else actions
    calls = list(_calls(city, known))
    if not calls:
        return replace(city, layout=layout)
    waiting = {late for stage in STAGES for late in stages_after(stage)}  # will be anew, too
    plain = replace(city, network=None, heights=None, lanes=None, ground=None, scene=_shells(city),
                    stages_done=city.stages_done - waiting)  # fmt: skip
    was, now = plain, replace(plain, layout=layout)
    for call in calls:
        was, now = run_step(was, call, known), run_step(now, call, known)
    lost = now.network is not None and city.tracks is not None
    notes = ("The streets changed, so what moved along them is to be planned anew.",) * lost
    return replace(
        city, layout=layout, network=now.network, heights=now.heights, lanes=now.lanes,
        ground=now.ground, survey=now.survey, terrain=_regraded(city, was.terrain, now.terrain),
        scene=_merged(city, was, now, LYING if surface else None),
        tracks=None if lost else city.tracks,
        notes=tuple(dict.fromkeys((*city.notes, *now.notes, *notes))),
        failures=tuple(dict.fromkeys((*city.failures, *now.failures))),
    )  # fmt: skip


def _calls(city: City, actions: Registry) -> Iterator[Call]:
    """Yield what made streets and what stands on the ground, in order; layouts stay as they are."""
    for action, args in city.made.items():
        if action not in actions:
            continue
        record = actions[action]
        lays_out = any(port.format == Format.SCENE_LAYOUT for port in record.gives)
        if record.stage in STAGES and not lays_out:
            yield Call(action, args)


def _shells(city: City) -> Scene:
    """Return what there is of buildings in a scene: layers all of whose objects are theirs."""
    houses = city.layout.buildings["id"].to_numpy(np.uint64)
    scene = city.scene
    kept = Scene(prototypes=scene.prototypes)
    for layer, batch in scene.meshes.items():
        if np.isin(batch.object_id, houses).all():
            kept = kept.with_mesh(layer, batch)
    for layer, rows in scene.instances.items():
        owner = np.where(rows.owner > 0, rows.owner, rows.object_id)
        if np.isin(owner, houses).all():
            kept = kept.with_instances(layer, kept.prototypes, rows)
    return kept


def _regraded(city: City, was: Terrain, now: Terrain) -> Terrain:
    """Return the terrain with the cut and fill that differs."""
    change = now.heights - was.heights
    if not change.any():
        return city.terrain
    return replace(city.terrain, heights=city.terrain.heights + change)


@dataclass(frozen=True)
class _Layer:
    """One layer of instances before a change, as it would be made again, and after it.

    Attributes
    ----------
    held, was, now
        Scenes.
    name
        Of the layer.
    region
        Ground around what is laid out otherwise.
    """

    held: Scene
    was: Scene
    now: Scene
    name: str
    region: shapely.Geometry

    @cached_property
    def changed(self) -> UInt64Array:
        """Ids of what comes out otherwise."""
        return differing_ids(_prints(self.was, self.name), _prints(self.now, self.name))

    @cached_property
    def touched(self) -> UInt64Array:
        """Ids of what was changed by hand before."""
        return differing_ids(_prints(self.held, self.name), _prints(self.was, self.name))

    @cached_property
    def fresh(self) -> UInt64Array:
        """Ids of what comes out otherwise and was not changed by hand."""
        return np.setdiff1d(self.changed, self.touched)

    def exchanged(self, rows: Instances) -> BoolArray:
        """(n,) which rows make way for others, or take their place.

        Far from a change a row of lamps is only centred anew between junctions, by centimetres, and
        stays. Parked cars stand too close to each other for some of a row to stay.
        """
        fresh = np.isin(rows.object_id, self.fresh)
        x, y = rows.position[:, :2].T
        return fresh if self.name in CLOSE else fresh & shapely.intersects_xy(self.region, x, y)


def _region(before: Layout, after: Layout) -> shapely.Geometry:
    """Return the ground within `REACH` of what two layouts have otherwise."""
    found = []
    for name in SCHEMA:
        tables = getattr(before, name), getattr(after, name)
        if tables[0] is tables[1]:
            continue
        changed = differing_ids(*(hash_table(table, name) for table in tables))
        for table in tables:
            rows = table[table["id"].isin(changed)]
            half = np.zeros(len(rows))
            if name == "roads":
                walks = rows[["sidewalk_left", "sidewalk_right"]].max(axis=1)
                half = np.nan_to_num((rows["width"] / 2 + walks).to_numpy(float))
            found += [*shapely.buffer(rows.geometry.to_numpy(), half + REACH)]
    region = shapely.union_all(np.array(found, object))
    shapely.prepare(region)
    return region


def _merged(city: City, was: City, now: City, only: tuple[str, ...] | None) -> Scene:
    """Put what depends on the change into the scene in the place of what there was of it.

    Of layers of objects all are looked at, or those of some names `only`.
    """
    scene = city.scene
    for layer in sorted({*was.scene.meshes, *now.scene.meshes}):
        old, new = was.scene.meshes.get(layer), now.scene.meshes.get(layer)
        held = scene.meshes.get(layer)
        if layer in ARRANGED and new is not None:
            scene = scene.with_mesh(layer, new)
        elif old is not new and only is None:
            scene = _with_mesh(scene, layer, _merged_mesh(held, old, new))
    region = _region(was.layout, now.layout)
    layers = {*scene.instances, *was.scene.instances, *now.scene.instances}
    for layer in sorted(layers if only is None else layers.intersection(only)):
        scene = _merged_layer(scene, _Layer(scene, was.scene, now.scene, layer, region),
                              (city.ground, now.ground))  # fmt: skip
    return scene


def _with_mesh(scene: Scene, layer: str, batch: MeshBatch) -> Scene:
    return scene if batch is scene.meshes.get(layer) else scene.with_mesh(layer, batch)


def _merged_mesh(
    held: MeshBatch | None, was: MeshBatch | None, now: MeshBatch | None
) -> MeshBatch:  # fmt: skip
    """Exchange the objects of a mesh that differ; those that were removed by hand stay away."""
    empty = concatenate([])
    held, was, now = (batch if batch is not None else empty for batch in (held, was, now))
    changed = differing_ids(hash_mesh(was), hash_mesh(now))
    if not len(changed):
        return held
    removed = np.setdiff1d(was.object_id, held.object_id)
    stays = ~np.isin(held.object_id, changed)
    comes = np.isin(now.object_id, changed) & ~np.isin(now.object_id, removed)
    joined = concatenate([held.take(np.flatnonzero(stays)), now.take(np.flatnonzero(comes))])
    return joined.take(np.argsort(joined.object_id, kind="stable"))


def _merged_layer(
    scene: Scene, layer: _Layer, grounds: tuple[Ground | None, Ground | None]
) -> Scene:
    """Exchange the rows of a layer that differ; what was done by hand stays where it can."""
    held, new = (each.instances.get(layer.name) for each in (scene, layer.now))
    kept = np.zeros(0, bool)
    if held is not None:
        kept = ~layer.exchanged(held) & ~_in_the_way(held, layer, grounds)
        if not kept.all():
            scene = scene.with_instances(layer.name, scene.prototypes, take_rows(held, kept))
    if new is None:
        return scene
    chosen = take_rows(new, layer.exchanged(new))
    if held is not None:  # a row whose far part stays may come out with one more in between
        chosen = take_rows(chosen, ~np.isin(chosen.object_id, held.object_id[kept]))
        stay = kept & np.isin(held.object_id, layer.changed)
        there = shapely.points(held.position[stay, :2])
        chosen = take_rows(chosen, ~near_any(chosen.position[:, :2], there, APART))
    return with_rows(scene, layer.name, layer.now.prototypes, chosen) if chosen.count else scene


def _in_the_way(
    rows: Instances, layer: _Layer, grounds: tuple[Ground | None, Ground | None]
) -> BoolArray:
    """(n,) what would stay, put there by hand or far from the change, on a carriageway only now."""
    old, new = grounds
    if layer.name not in ONTO_ROADWAY or old is None or new is None:
        return np.zeros(rows.count, bool)
    xy = rows.position[:, :2]
    return new.on(xy, *ROADWAY) & ~old.on(xy, *ROADWAY)


def _prints(scene: Scene, layer: str) -> tuple[UInt64Array, UInt64Array]:
    """Return ids and hashes of the rows of a layer; prototypes count by their names."""
    rows = scene.instances.get(layer)
    if rows is None:
        return np.zeros(0, np.uint64), np.zeros(0, np.uint64)
    names = np.array([stable_id(prototype.name) for prototype in scene.prototypes], np.uint64)
    return hash_instances(rows, names)
