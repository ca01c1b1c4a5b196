"""Checks of the ground: gaps, overlaps, area, and things that stand where nothing may stand."""

from __future__ import annotations

from cityx.checks.check import Check, named
from cityx.city import City
from cityx.city.ground import PAINT
from cityx.ground.arrangement import check_arrangement

AREA_ERROR = 1e-6  # relative; rounding to the grid moves the border by half a centimetre at most
_NO_TRUNK = ("carriageway", "setts", "gutter", "parking_lane", "mouth_setts", "junction",
             *PAINT, "water")  # fmt: skip


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
