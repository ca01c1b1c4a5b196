"""From boxes and meshes: meshes, boxes, faces and points."""

from __future__ import annotations

from typing import Annotated

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.assets.styles.materials import MATERIALS
from cityx.city.mesh import NO_VERTEX, MeshBatch
from cityx.protocol import Choice, action
from cityx.protocol.values import Boxes, Points, Surfaces, make_boxes, make_points, make_surfaces

# Corners of a unit box about its base centre: x along the heading's right, y along the heading.
_CORNERS = np.array(
    [
        [-0.5, -0.5, 0], [0.5, -0.5, 0], [0.5, 0.5, 0], [-0.5, 0.5, 0],
        [-0.5, -0.5, 1], [0.5, -0.5, 1], [0.5, 0.5, 1], [-0.5, 0.5, 1],
    ]
)  # fmt: skip
_FACES = np.array(
    [[3, 2, 1, 0], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
)


def box_corners(boxes: Boxes) -> NDArray[np.float64]:
    """Return the (n, 8, 3) corners of boxes, lower four first, counter-clockwise."""
    length, width, height = boxes.size.T
    local = _CORNERS * np.column_stack([width, length, height])[:, None, :]
    sine, cosine = np.sin(boxes.heading)[:, None], np.cos(boxes.heading)[:, None]
    x = local[..., 0] * cosine + local[..., 1] * sine
    y = local[..., 1] * cosine - local[..., 0] * sine
    return np.asarray(np.stack([x, y, local[..., 2]], axis=2) + boxes.base[:, None, :])


@action(
    "convert/object_meshing-v1",
    classname="Object_meshing",
    limits=["Loses the class; every face gets the one material."],
    lossy=0.02,
)
def object_meshing(
    boxes: Boxes, *, material: Annotated[str, Choice(*MATERIALS)] = "concrete"
) -> MeshBatch:
    """Mesh objects: each box becomes a closed mesh of six quads.

    Parameters
    ----------
    boxes
        Boxes.
    material
        Name of the material of every face.
    """
    count = boxes.count
    vertices = box_corners(boxes)
    faces = _FACES[None] + 8 * np.arange(count)[:, None, None]  # (n, 6, 4)
    corner = vertices.reshape(-1, 3)[faces]  # (n, 6, 4, 3)
    # Edges of a face are its u and v, in metres.
    u = np.linalg.norm(corner[:, :, 1] - corner[:, :, 0], axis=2)
    v = np.linalg.norm(corner[:, :, 3] - corner[:, :, 0], axis=2)
    zero = np.zeros_like(u)
    uv = np.stack(
        [np.stack(pair, axis=2) for pair in ((zero, zero), (u, zero), (u, v), (zero, v))], axis=2
    )
    return MeshBatch(
        boxes.object_id.copy(),
        8 * np.arange(count + 1, dtype=np.int64),
        6 * np.arange(count + 1, dtype=np.int64),
        vertices.reshape(-1, 3),
        faces.reshape(-1, 4).astype(np.int32),
        np.zeros(6 * count, np.int16),
        (material,),
        uv.reshape(-1, 4, 2).astype(np.float32),
        np.ones((6 * count, 3), np.float32),
    )


@action(
    "convert/box_to_face_conversion-v1",
    classname="Box_to_face_conversion",
    extension=True,
    lossy=0.05,
    limits=["Loses the level the boxes stand on."],
)
def box_to_face_conversion(boxes: Boxes) -> Surfaces:
    """Convert boxes to the rectangles they stand on, heights kept.

    Parameters
    ----------
    boxes
        Boxes.
    """
    shapes = shapely.polygons(box_corners(boxes)[:, :4, :2]) if boxes.count else []
    return make_surfaces(shapes, boxes.kind.tolist(), boxes.size[:, 2], boxes.object_id)


@action(
    "convert/box_to_point_conversion-v1",
    classname="Box_to_point_conversion",
    extension=True,
    lossy=0.6,
    limits=["Loses size and heading."],
)
def box_to_point_conversion(boxes: Boxes) -> Points:
    """Convert boxes to the centres of their lower faces.

    Parameters
    ----------
    boxes
        Boxes.
    """
    return make_points(boxes.base, boxes.kind.tolist())


@action(
    "convert/mesh_to_box_conversion-v1",
    classname="Mesh_to_box_conversion",
    extension=True,
    lossy=0.6,
    limits=["Loses the form: what remains is the smallest upright box along a face of its hull."],
)
def mesh_to_box_conversion(meshes: MeshBatch) -> Boxes:
    """Convert meshes to the smallest upright boxes around them.

    Parameters
    ----------
    meshes
        Meshes of objects; those without vertices are left out.
    """
    from cityx.convert.surfaces import face_to_box_conversion

    filled = np.flatnonzero(np.diff(meshes.vertex_start) > 0)
    start = meshes.vertex_start[filled]
    if not len(filled):
        return make_boxes(np.zeros((0, 3)), (1, 1, 1))
    low = np.minimum.reduceat(meshes.vertices[:, 2], start)
    high = np.maximum.reduceat(meshes.vertices[:, 2], start)
    row = np.repeat(np.arange(meshes.count), np.diff(meshes.vertex_start))
    _, part = np.unique(row, return_inverse=True)
    hulls = shapely.convex_hull(shapely.multipoints(meshes.vertices[:, :2], indices=part))
    flat = shapely.get_type_id(hulls) != 3  # upright sheets have a line for a hull
    hulls[flat] = shapely.buffer(hulls[flat], 0.0005, quad_segs=1, cap_style="square")
    surfaces = make_surfaces(hulls, "", high - low, meshes.object_id[filled])
    boxes = face_to_box_conversion(surfaces)
    base = np.column_stack([boxes.base[:, :2], low])
    return make_boxes(base, boxes.size, boxes.heading, "", boxes.object_id)


@action(
    "convert/mesh_to_face_conversion-v1",
    classname="Mesh_to_face_conversion",
    extension=True,
    lossy=0.4,
    cost=2.0,
    limits=["Loses everything but the outline seen from above and the height."],
)
def mesh_to_face_conversion(meshes: MeshBatch) -> Surfaces:
    """Convert meshes to their outlines seen from above.

    Parameters
    ----------
    meshes
        Meshes of objects; those that show no area from above are left out.
    """
    triangles, face = meshes.triangles()
    owner = meshes.face_object()[face]
    order = np.argsort(owner, kind="stable")
    corners = meshes.vertices[triangles[order]][..., :2]  # (t, 3, 2)
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    seen = np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) > 1e-9
    shapes = shapely.polygons(corners[seen]) if seen.any() else np.zeros(0, object)
    owners = owner[order][seen]
    found: list[shapely.Polygon] = []
    rows: list[int] = []
    for row in np.unique(owners).tolist():
        outline = shapely.union_all(shapes[owners == row], grid_size=1e-4)
        parts = shapely.get_parts(outline)
        parts = parts[shapely.area(parts) > 1e-6]
        found += list(parts)
        rows += [row] * len(parts)
    tall = np.zeros(meshes.count)
    filled = np.flatnonzero(np.diff(meshes.vertex_start) > 0)
    if len(filled):
        start = meshes.vertex_start[filled]
        z = meshes.vertices[:, 2]
        tall[filled] = np.maximum.reduceat(z, start) - np.minimum.reduceat(z, start)
    picked = np.array(rows, np.int64)
    return make_surfaces(np.array(found, object), "", tall[picked], meshes.object_id[picked])


@action(
    "convert/mesh_to_point_conversion-v1",
    classname="Mesh_to_point_conversion",
    extension=True,
    lossy=0.5,
    limits=["Loses faces and materials."],
)
def mesh_to_point_conversion(meshes: MeshBatch) -> Points:
    """Convert meshes to their vertices, those of one object in one group.

    Parameters
    ----------
    meshes
        Meshes of objects.
    """
    used = np.zeros(len(meshes.vertices), bool)
    used[meshes.faces[meshes.faces != NO_VERTEX]] = True
    group = np.repeat(np.arange(meshes.count), np.diff(meshes.vertex_start)) + 1
    return make_points(meshes.vertices[used], "", group[used])
