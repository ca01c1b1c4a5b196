"""What a change broke: the checks that hold of a city before it and no longer after it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.checks.building_checks import check_buildings
from cityx.checks.facade_checks import check_facades
from cityx.checks.furniture_checks import check_furniture, check_trees
from cityx.checks.predicates.change_predicates import changed_ids, located
from cityx.checks.report import check_table, run_checks
from cityx.checks.shell_checks import check_shells
from cityx.city import City
from cityx.city.mesh import NO_VERTEX
from cityx.city.rows import take_rows
from cityx.geometry.triangle_cells import reaching
from cityx.ground.walking.passage import LOOK

MOST = 600  # buildings of a city of which every check is made, a few seconds
REACH = 30.0  # metres from what changed to what a check may set beside it
SHELLS, GROUND = "buildings", "ground"
NEAR = (check_buildings, check_shells, check_facades, check_furniture, check_trees)

Table = Mapping[str, Mapping[str, Any]]


def broken_by_change(
    before: City, after: City, known: Table | None = None
) -> tuple[dict[str, Any], dict[str, Any] | None]:
    """Return the checks that a change broke, and all checks of the city if they were made.

    Of a large city only what stands near the change is measured.

    Parameters
    ----------
    before, after
        The city without the change and with it.
    known
        The checks of the city before, as in a report, where they were made.
    """
    if len(after.layout.buildings) <= MOST:
        now = check_table(run_checks(after))
        return _newly(now, known if known is not None else check_table(run_checks(before))), now
    ids = changed_ids(before, after)
    shapes = [shape for city in (before, after) for _, own in located(city, ids) for shape in own]
    if not shapes:
        return {}, None
    margin = np.array([-REACH, -REACH, REACH, REACH])
    box = shapely.total_bounds(np.array(shapes, object)) + margin
    now = _near(after, box)
    if all(item["ok"] for item in now.values()):  # then nothing is broken, whatever was before
        return {}, None
    return _newly(now, _near(before, box)), None


def _newly(now: Table, then: Table) -> dict[str, Any]:
    """Return the checks that fail and did not fail before."""
    held = {name for name, item in then.items() if not item["ok"]}
    return {name: dict(item) for name, item in now.items() if not item["ok"] and name not in held}


def _near(city: City, box: NDArray[np.float64]) -> dict[str, Any]:
    """Return the checks of what stands in a rectangle that regard single things."""
    layout, scene = city.layout, city.scene
    table = layout.buildings
    rows = np.flatnonzero(shapely.intersects(table.geometry.to_numpy(), shapely.box(*box)))
    buildings = table.iloc[rows].reset_index(drop=True)
    ids = buildings["id"].to_numpy(np.uint64)
    own = np.isin(layout.parts["building"].to_numpy(np.uint64), ids)
    parts = layout.parts.iloc[np.flatnonzero(own)].reset_index(drop=True)
    around = box + np.array([-LOOK, -LOOK, LOOK, LOOK])
    ground = city.ground.within(around) if city.ground is not None else None
    surface = scene.meshes.get(GROUND)
    if surface is not None:
        corners = np.where(surface.faces == NO_VERTEX, surface.faces[:, :1], surface.faces)
        own = reaching(surface.vertices[:, :2], corners, around)
        scene = scene.with_mesh(GROUND, surface.with_faces(own))
    shells = scene.meshes.get(SHELLS)
    if shells is not None:
        mine = np.flatnonzero(np.isin(shells.object_id, ids))
        scene = scene.with_mesh(SHELLS, shells.take(mine))
    for layer, items in scene.instances.items():
        xy = items.position[:, :2]
        inside = ((xy >= box[:2]) & (xy <= box[2:])).all(axis=1)
        inside = np.where(items.owner > 0, np.isin(items.owner, ids), inside)
        scene = scene.with_instances(layer, scene.prototypes, take_rows(items, inside))
    some = replace(
        city, layout=replace(layout, buildings=buildings, parts=parts), scene=scene, ground=ground
    )
    return check_table([check for measure in NEAR for check in measure(some)])
