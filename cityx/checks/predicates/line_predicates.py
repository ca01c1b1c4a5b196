"""City walls and power lines, and the places where streets pass walls and railways."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.checks.predicates import words
from cityx.checks.predicates.building_predicates import looks_of_faces
from cityx.checks.predicates.thing_predicates import (
    CannotTell,
    Layer,
    TableLayer,
    UInt64Array,
    column,
)
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.chains import components
from cityx.geometry.polylines import traced
from cityx.ids import hash_ids

LINES = ("city_wall", "power_line")  # kinds of lines of the layout
# What streets cross on the ground -> what such a place is called.
CROSSINGS = {"gate": "city_wall", "level_crossing": "railway"}
JOINED = 30.0  # metres between the pieces of one wall, which streets part
ONE = 16.0  # metres between crossings that are one: of two tracks, or of two carriageways


@dataclass(frozen=True)
class StandingLines(TableLayer):
    """The walls or lines of a kind; pieces that go on in each other count as one."""

    @cached_property
    def _table(self) -> Any:
        table = self.city.layout.lines
        return table[(table["kind"] == self.kind).to_numpy()]

    @cached_property
    def names(self) -> Mapping[str, NDArray[Any]]:
        """Sources; lines have no names."""
        return {"source": column(self._table, "source")}

    def number(self, attribute: str) -> FloatArray:
        """Return heights and lengths."""
        if attribute == "height":
            return np.asarray(self._table["height"].to_numpy(float))
        if attribute == "length":
            # Along a wall that is drawn with its thickness there and back is once round it.
            there = np.where(shapely.get_dimensions(self.shapes) == 2, 0.5, 1.0)
            return np.asarray(there * shapely.length(self.shapes))
        return super().number(attribute)

    def has(self, attribute: str, word: str) -> BoolArray:
        """Return which are mainly of a material or a colour."""
        if attribute == "material":
            return np.isin(self._looks[0], words.THING_MATERIALS[word])
        if attribute == "color":
            return np.asarray(self._looks[1] == word)
        return super().has(attribute, word)

    @cached_property
    def _looks(self) -> tuple[NDArray[np.str_], NDArray[np.str_]]:
        """(n,) roots of the materials of each, and words of their colours."""
        mesh = self.city.scene.meshes.get("barriers")
        if mesh is None:
            raise CannotTell(f"no {self.kind} is built yet, so none has a material or a colour")
        owner = mesh.object_id[mesh.face_object()]
        order = np.argsort(self.ids, kind="stable")
        row = np.minimum(np.searchsorted(self.ids[order], owner), max(len(order) - 1, 0))
        faces = np.flatnonzero(self.ids[order][row] == owner) if len(order) else row[:0]
        return looks_of_faces(mesh, faces, order[row[faces]], len(self.ids))

    def units(self, rows: IntArray) -> IntArray:
        """Return the number of the wall or line that each piece belongs to."""
        count, shapes = len(rows), traced(self.shapes[rows])
        reach = JOINED if self.kind == "city_wall" else 1.0
        tips = np.concatenate([shapely.get_point(shapes, 0), shapely.get_point(shapes, -1)])
        a, b = shapely.STRtree(tips).query(tips, predicate="dwithin", distance=reach)
        pairs = np.column_stack([a % max(count, 1), b % max(count, 1)])
        return np.asarray(components(pairs, count), np.int64)


@dataclass(frozen=True)
class Crossings(Layer):
    """The places where streets lead through a wall or over a railway, on the ground."""

    @cached_property
    def _found(self) -> tuple[UInt64Array, NDArray[Any]]:
        layout = self.city.layout
        roads = layout.roads
        ground = ~(roads["bridge"] | roads["tunnel"]).to_numpy(bool)
        ground &= (roads["layer"] == 0).to_numpy()
        drivable = ground & roads["kind"].isin(words.ROADS).to_numpy()
        if CROSSINGS[self.kind] == "railway":
            rails = ground & roads["kind"].isin(words.RAILWAYS).to_numpy()
            other = roads[rails & (roads["kind"] != "tram").to_numpy()]
        else:
            other = layout.lines[(layout.lines["kind"] == CROSSINGS[self.kind]).to_numpy()]
        streets = roads[drivable]
        lines, walls = streets.geometry.to_numpy(), other.geometry.to_numpy()
        row, of = shapely.STRtree(walls).query(lines, predicate="intersects")
        spots, pair = shapely.get_parts(
            shapely.intersection(lines[row], walls[of]), return_index=True
        )
        spots = shapely.centroid(spots)
        near = np.column_stack(
            shapely.STRtree(spots).query(spots, predicate="dwithin", distance=ONE)
        )
        label = np.asarray(components(near, len(spots)), np.int64)
        first = np.unique(label, return_index=True)[1]
        ids = hash_ids(0, self.kind, streets["id"].to_numpy(np.uint64)[row[pair[first]]],
                       other["id"].to_numpy(np.uint64)[of[pair[first]]])  # fmt: skip
        return ids, np.asarray(spots[first], object)

    @property
    def ids(self) -> UInt64Array:
        """(n,) ids, of the street and of what it crosses."""
        return self._found[0]

    @property
    def shapes(self) -> NDArray[Any]:
        """(n,) points."""
        return self._found[1]
