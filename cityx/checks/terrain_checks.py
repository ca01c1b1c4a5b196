"""Checks of the ground: gaps and overlaps, its heights against the file, all within the site."""

from __future__ import annotations

import numpy as np
import shapely

from cityx.checks.check import Check, named
from cityx.city import City
from cityx.city.ground import LABEL, PAINT, ROADWAY, SURFACES
from cityx.city.mesh import NO_VERTEX
from cityx.geometry.arrays import FloatArray
from cityx.geometry.triangle_cells import cells_of_triangles, triangle_at
from cityx.ground.arrangement import check_arrangement
from cityx.ground.grading import FARTHEST
from cityx.ground.standing import NOWHERE, heights_on, stand_on
from cityx.ground.surroundings import OFFSET

# Tolerances by which triangles may miss: the corners of a cell keep one, and so does each way to
# divide the cell.
TRIANGLES = 2
EASING = 100.0  # metres beyond the site over which the land meets its border
AREA_ERROR = 1e-6  # relative; rounding to the grid moves the border by half a centimetre at most
_NO_TRUNK = ("carriageway", "setts", "gutter", "parking_lane", "mouth_setts", "junction",
             *PAINT, "water")  # fmt: skip
BESIDE_ROADWAY = ("sidewalk", "kerb", "furnishing", "kerb_dropped", "ramp", "landing")
FEW = 1000  # cells of files on a site that say too little of the land between them
SIDE = 150  # places per side at which the land is then looked at
BEYOND = 2.0  # metres; lamps, trees and reeds along what the border cuts stand a step beyond


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


def fit_notes(city: City) -> tuple[str, ...]:
    """Say by how much the ground that stands misses its height files, on land and in streets.

    Where cells of the files are few, the smooth surface through them is held against the ground.
    """
    if city.survey is None or city.ground is None:
        return ()
    told, points = "cells of the files", city.survey.points
    if len(points) < FEW:
        xmin, ymin, xmax, ymax = city.layout.extent
        middle = (np.arange(SIDE) + 0.5) / SIDE
        x, y = np.meshgrid(xmin + middle * (xmax - xmin), ymin + middle * (ymax - ymin))
        spots = np.column_stack([x.ravel(), y.ravel()])
        points = np.column_stack([spots, city.terrain.height_at(spots)])
        told = "places of the surface through the files' cells"
    under = stand_on(city.scene.meshes.get("ground"), points[:, :2])
    on_ground = ~np.isin(under.label, [NOWHERE, LABEL["water"], LABEL["void"]])
    street = np.isin(under.label, [LABEL[name] for name in (*ROADWAY, *BESIDE_ROADWAY)])
    offset = np.array([surface.offset for surface in SURFACES])[under.label]
    error = np.abs(under.z - offset - points[:, 2])
    parts = [
        f"{int(rows.sum()):,} {told} {where} by {np.sqrt(np.mean(error[rows] ** 2)):.2f} m (root "
        f"mean square), {error[rows].max():.2f} m at most"
        for where, rows in (("on land", on_ground & ~street), ("in streets", on_ground & street))
        if rows.any()
    ]
    return (f"heights: the ground as built misses {'; '.join(parts)}",) if parts else ()


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


def check_ground(city: City) -> list[Check]:
    """Run every check on the ground."""
    if city.ground is None:
        return []
    open_edges, overlaps, area_error = check_arrangement(city.ground)
    checks = [
        Check("arrangement_gaps", open_edges, 0, "edges inside the site with a face on one side"),
        Check("arrangement_overlaps", overlaps, 0, "faces that overlap another"),
        Check("arrangement_area_error", area_error, AREA_ERROR,
              "difference between the faces' area and the site's, relative"),
    ]  # fmt: skip
    trees = city.scene.instances.get("trees")
    if trees is not None and trees.count:
        misplaced = city.ground.on(trees.position[:, :2], *_NO_TRUNK)
        checks.append(Check("trees_misplaced", float(misplaced.sum()), 0,
                            "trunks in a carriageway or in water",
                            ids=named(trees.object_id[misplaced])))  # fmt: skip
    return checks


def check_bounds(city: City) -> list[Check]:
    """Count buildings and instances of the scene that lie beyond the site."""
    xmin, ymin, xmax, ymax = shapely.box(*city.layout.extent).buffer(BEYOND).bounds
    table = city.layout.buildings
    middle = shapely.get_coordinates(shapely.centroid(table.geometry.to_numpy()))
    points = [middle, *(rows.position[:, :2] for rows in city.scene.instances.values())]
    ids = [table["id"].to_numpy(), *(rows.object_id for rows in city.scene.instances.values())]
    x, y = np.concatenate(points).T
    out = (x < xmin) | (x > xmax) | (y < ymin) | (y > ymax)
    lost = np.concatenate(ids)[out]
    return [
        Check("outside_site", float(out.sum()), 0, "buildings and things beyond the site",
              ids=named(lost))
    ]  # fmt: skip
