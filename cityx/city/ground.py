"""The ground: one arrangement of labelled faces that leaves no gap and no overlap."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cityx.geometry.triangle_cells import (
    TriangleCells,
    cells_of_triangles,
    reaching,
    triangle_at,
    triangles_at,
)
from cityx.system.remembered import Remembered

KERB_WIDTH = 0.15  # metres
KERB_HEIGHT = 0.12  # metres; the usual upstand of a city kerb
DROPPED = 0.02  # metres of upstand that are left of a kerb at a crossing
WATER_LEVEL = -0.9  # metres below the terrain, so that quays and banks show


@dataclass(frozen=True)
class Surface:
    """What a face of the ground is made of.

    Attributes
    ----------
    name
        Label of the face.
    priority
        Where regions overlap the higher one wins.
    offset
        Metres above the terrain.
    material
        Material of the top.
    edge_material
        Material of the vertical faces where a neighbour lies lower (kerb, quay).
    """

    name: str
    priority: int
    offset: float
    material: str
    edge_material: str = "concrete"


# Index in this tuple is the label stored with a face. Priorities leave room for plugins.
SURFACES: tuple[Surface, ...] = (
    Surface("block", 0, KERB_HEIGHT, "grass", "grass"),  # land nobody described, open country
    Surface("courtyard", 5, KERB_HEIGHT, "yard", "concrete"),  # the same inside a dense block
    Surface("farmland", 10, KERB_HEIGHT, "farmland", "farmland"),
    Surface("grass", 12, KERB_HEIGHT, "grass", "grass"),
    Surface("meadow", 12, KERB_HEIGHT, "meadow", "meadow"),
    Surface("wood", 14, KERB_HEIGHT, "forest_floor", "forest_floor"),
    Surface("park", 16, KERB_HEIGHT, "grass", "grass"),
    Surface("sand", 18, KERB_HEIGHT, "sand", "sand"),
    Surface("bare", 18, KERB_HEIGHT, "soil", "soil"),
    Surface("pitch", 22, KERB_HEIGHT, "pitch", "concrete"),
    Surface("playground", 22, KERB_HEIGHT, "sand", "concrete"),
    Surface("plaza", 24, KERB_HEIGHT, "plaza_slabs", "kerb_stone"),
    Surface("parking", 26, 0.0, "asphalt", "kerb_stone"),
    Surface("water", 30, WATER_LEVEL, "water", "stone"),
    Surface("railway", 34, KERB_HEIGHT, "rail_ballast", "soil"),
    Surface("path", 40, KERB_HEIGHT, "asphalt_light", "kerb_stone"),
    Surface("sidewalk", 50, KERB_HEIGHT, "paving", "kerb_stone"),
    Surface("kerb", 52, KERB_HEIGHT, "kerb_stone", "kerb_stone"),
    Surface("building", 60, KERB_HEIGHT, "concrete", "concrete"),
    Surface("carriageway", 70, 0.0, "asphalt", "concrete"),
    Surface("setts", 70, 0.0, "setts", "concrete"),  # carriageway of stone
    Surface("gravel_road", 70, 0.02, "gravel", "soil"),
    Surface("junction", 72, 0.0, "asphalt", "concrete"),
    Surface("marking", 80, 0.0, "marking_white", "concrete"),
    Surface("tramway", 78, 0.0, "rail_steel", "concrete"),
    Surface("marking_yellow", 80, 0.0, "marking_yellow", "concrete"),
    Surface("apron", 56, 0.04, "setts", "kerb_stone"),  # overrun by lorries on roundabouts
    Surface("kerb_dropped", 55, DROPPED, "kerb_stone", "kerb_stone"),
    Surface("tactile", 51, DROPPED, "tactile_yellow", "kerb_stone"),  # ribs before a crossing
    Surface("tactile_pale", 51, DROPPED, "tactile_pale", "kerb_stone"),
    Surface("ramp", 51, KERB_HEIGHT, "paving", "kerb_stone"),  # rises from the dropped kerb
    Surface("cycle_lane", 79, 0.0, "asphalt_red", "concrete"),
    Surface("rail", 36, KERB_HEIGHT + 0.14, "rail_steel", "rail_steel"),  # head above the ballast
    Surface("void", 85, 0.0, "concrete"),  # no ground: a ramp, a cutting or the mouth of a tunnel
    Surface("trail", 40, KERB_HEIGHT, "gravel", "soil"),  # path without a hard surface
    # Strip along the kerb of a wide walk, in which furniture stands.
    Surface("furnishing", 51, KERB_HEIGHT, "setts", "kerb_stone"),
    Surface("gravel", 6, KERB_HEIGHT, "gravel", "concrete"),  # of yards
    Surface("bed", 7, KERB_HEIGHT + 0.08, "soil", "kerb_stone"),  # planted, with an edge of stone
    Surface("edging", 8, KERB_HEIGHT, "kerb_stone", "kerb_stone"),  # at the back of a walk
    # What is left between a walk and the houses: paved to the wall, each region in its way.
    Surface("frontage", 9, KERB_HEIGHT, "paving", "kerb_stone"),
    Surface("threshold", 71, 0.0, "kerb_stone", "concrete"),  # row of stones across a carriageway
    Surface("tactile_buff", 51, DROPPED, "tactile_buff", "kerb_stone"),
    Surface("crossing_row", 80, 0.0, "marking_white", "concrete"),  # beside people who cross
    Surface("gutter", 71, 0.0, "gutter_stones", "concrete"),  # along kerbs, part of the carriageway
    Surface("tactile_red", 51, DROPPED, "tactile_red", "kerb_stone"),
    # Leads across the walk to a crossing; it rises with the ramp.
    Surface("guide_strip", 51, KERB_HEIGHT, "tactile_pale", "kerb_stone"),
    Surface("landing", 51, DROPPED, "paving", "kerb_stone"),  # walk between a kerb and ribs
    Surface("parking_lane", 71, 0.0, "small_setts", "concrete"),  # of small stones, beside setts
    Surface("mouth_setts", 81, 0.0, "pale_setts", "concrete"),  # across the mouth of a side street
    Surface("coat", 79, 0.0, "asphalt_brown", "concrete"),  # amid crossroads
    Surface("feather", 80, 0.0, "marking_blue", "concrete"),  # where bicycles ride
)
LABEL = {surface.name: index for index, surface in enumerate(SURFACES)}
UNDRAPED = ("building", "void")  # the mesh is open there
# What lies on a carriageway and is part of it.
PAINT = ("marking", "marking_yellow", "cycle_lane", "crossing_row", "coat", "feather")
ON_ROADWAY = (*PAINT, "tramway")  # whatever a roadway is made of below it
ROADWAY = ("carriageway", "setts", "gravel_road", "junction", "threshold", "gutter",
           "parking_lane", "mouth_setts", *PAINT)  # fmt: skip


_CELLS: Remembered[TriangleCells] = Remembered()


@dataclass(frozen=True)
class Ground:
    """Faces of the arrangement, triangulated on shared vertices.

    Attributes
    ----------
    vertices
        (n, 2) float64 on the arrangement's grid, each position once.
    triangles
        (t, 3) int32 into ``vertices``, counter-clockwise.
    triangle_face
        (t,) int32, the face of each triangle.
    face_label
        (f,) uint8 into `SURFACES`.
    face_object
        (f,) uint64, the road, area or building the face belongs to; 0 for none.
    edges
        (e, 2) int32, vertex pairs of the face boundaries, the left face on the left hand.
    edge_faces
        (e, 2) int32, left and right face; -1 beyond the site.
    """

    vertices: NDArray[np.float64]
    triangles: NDArray[np.int32]
    triangle_face: NDArray[np.int32]
    face_label: NDArray[np.uint8]
    face_object: NDArray[np.uint64]
    edges: NDArray[np.int32]
    edge_faces: NDArray[np.int32]

    def within(self, box: ArrayLike) -> Ground:
        """Return what of the triangles and edges reaches into (xmin, ymin, xmax, ymax), metres.

        Numbers of vertices and faces stay.
        """
        kept = reaching(self.vertices, self.triangles, box)
        edges = reaching(self.vertices, self.edges, box)
        return replace(
            self, triangles=self.triangles[kept], triangle_face=self.triangle_face[kept],
            edges=self.edges[edges], edge_faces=self.edge_faces[edges],
        )  # fmt: skip

    def labelled(self, *names: str) -> NDArray[np.bool_]:
        """(f,) whether each face is one of some surfaces, by name."""
        wanted = np.zeros(len(LABEL), bool)
        wanted[[LABEL[name] for name in names]] = True
        return np.asarray(wanted[self.face_label])

    def triangles_of(self, *names: str) -> NDArray[np.int32]:
        """(t, 3) triangles of the faces of some surfaces."""
        return np.asarray(self.triangles[self.labelled(*names)[self.triangle_face]])

    @cached_property
    def cells(self) -> TriangleCells:
        """The triangles by the cells that they meet, the same after faces get other labels."""
        return _CELLS.get(
            lambda: cells_of_triangles(self.vertices, self.triangles),
            [self.vertices, self.triangles],
        )

    def on(self, xy: ArrayLike, *names: str) -> NDArray[np.bool_]:
        """Return which of (n, 2) points lie in or on a face of some surfaces, by name."""
        return np.asarray(self.on_each(xy, names)[0])

    def on_each(self, xy: ArrayLike, *groups: Sequence[str]) -> NDArray[np.bool_]:
        """(g, n) which of (n, 2) points lie in or on a face of surfaces, by groups of names."""
        spots = np.asarray(xy, float).reshape(-1, 2)
        wanted = np.stack([self.labelled(*names)[self.triangle_face] for names in groups])
        found = np.zeros((len(groups), len(spots)), bool)
        for spot, triangle in triangles_at(spots, self.cells, wanted.any(axis=0)):
            for group, own in zip(found, wanted, strict=True):
                group[spot[own[triangle]]] = True
        return found

    def face_at(self, xy: ArrayLike, *names: str) -> NDArray[np.int64]:
        """(n,) the face of some surfaces that each of (n, 2) points lies in or on, -1 for none."""
        wanted = self.labelled(*names)[self.triangle_face]
        triangle = triangle_at(xy, self.cells, wanted)
        return np.where(triangle >= 0, self.triangle_face[triangle], -1).astype(np.int64)

    def first_of(self, xy: ArrayLike, *names: str) -> NDArray[np.int64]:
        """Return the number among the names of the surface that (n, 2) points lie in or on.

        Where surfaces meet the first one counts; -1 stands for none.
        """
        rank = np.full(len(LABEL) + 1, len(names))
        for number, name in reversed(list(enumerate(names))):
            rank[LABEL[name]] = number
        spots = np.asarray(xy, float).reshape(-1, 2)
        rank_of = rank[self.face_label[self.triangle_face]]
        found = np.full(len(spots), len(names))
        for spot, triangle in triangles_at(spots, self.cells, rank_of < len(names)):
            np.minimum.at(found, spot, rank_of[triangle])
        return np.where(found < len(names), found, -1)
