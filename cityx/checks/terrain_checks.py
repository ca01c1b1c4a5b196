"""Checks of the terrain: the built ground against what the height file says."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.checks.check import Check
from cityx.city import City
from cityx.city.ground import LABEL, SURFACES
from cityx.city.mesh import NO_VERTEX
from cityx.geometry.triangle_cells import cells_of_triangles, triangle_at
from cityx.ground.grading import FARTHEST
from cityx.ground.standing import NOWHERE, heights_on, stand_on
from cityx.ground.surroundings import OFFSET

FloatArray = NDArray[np.float64]
# Tolerances by which triangles may miss: the corners of a cell keep one, and so does each way to
# divide the cell.
TRIANGLES = 2
EASING = 100.0  # metres beyond the site over which the land meets its border


def check_terrain(city: City) -> list[Check]:
    """Run every check on the terrain; none without a height file."""
    if city.survey is None or city.ground is None:
        return []
    survey = city.survey
    near, far = terrain_errors(city), surroundings_errors(city)
    checks = [
        Check("terrain_error", near.max(initial=0.0), survey.bound + TRIANGLES * survey.tolerance,
              f"largest distance of the ground from the height file, at {len(near):,} cells of it "
              "that no street cuts or fills and no water levels, metres"),
        Check("surroundings_error", far.max(initial=0.0), TRIANGLES * survey.far_tolerance,
              "largest distance of the land beyond the site from its heights, metres"),
    ]  # fmt: skip
    return [check for check, error in zip(checks, (near, far), strict=True) if len(error)]


def terrain_errors(city: City) -> FloatArray:
    """Return (k,) metres between the ground and the file at its cells on land left as it was."""
    assert city.survey is not None
    points = city.survey.points
    under = stand_on(city.scene.meshes.get("ground"), points[:, :2])
    untouched = (under.label != NOWHERE) & (under.label != LABEL["water"])
    ways = shapely.STRtree(city.layout.roads.geometry.to_numpy())
    spots = shapely.points(points[:, :2])
    untouched[ways.query(spots, predicate="dwithin", distance=FARTHEST)[0]] = False
    offset = np.array([surface.offset for surface in SURFACES])[under.label]
    return np.asarray(np.abs(under.z - offset - points[:, 2])[untouched])


def surroundings_errors(city: City) -> FloatArray:
    """Return (k,) metres between the land beyond the site and the nodes of its height grid.

    Land at the border, which eases into the cut and fill of the site, is left out.
    """
    mesh = city.scene.meshes.get("surroundings")
    if city.survey is None or mesh is None:
        return np.zeros(0)
    around = city.survey.around
    rows, columns = around.heights.shape
    x, y = (around.origin[k] + around.cell * np.arange(n) for k, n in ((0, columns), (1, rows)))
    nodes = np.column_stack([np.tile(x, rows), np.repeat(y, columns)])
    low, high = np.array(city.layout.extent[:2]) - EASING, np.array(city.layout.extent[2:]) + EASING
    beyond = ((nodes < low) | (nodes > high)).any(axis=1)
    triangles = mesh.faces[mesh.faces[:, 3] == NO_VERTEX, :3]
    found = triangle_at(nodes, cells_of_triangles(mesh.vertices[:, :2], triangles))
    beyond &= found >= 0
    z = heights_on(mesh.vertices[triangles[found[beyond]]], nodes[beyond]) - OFFSET
    return np.asarray(np.abs(z - around.heights.ravel()[beyond]))
