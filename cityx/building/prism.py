"""Plain prisms: every part of a building raised to its full height."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from cityx.building.assembly import assemble, finishes_of
from cityx.building.volumes import volumes_of
from cityx.city.city import City, Failure
from cityx.geometry.extrude import prisms
from cityx.protocol import Port, action

ACTION = "building/prism-v1"


@action(
    ACTION,
    limits=["Roofs are level, walls are blank and a canopy is a solid block."],
    requires=("layout",),
    gives=(Port("blocks", "complex_geometry", "building_blocks"),),
    labels=("building", "block", "extrusion", "low detail"),
)
def prism(city: City) -> City:
    """Raise every building to a plain block of its height.

    A building is the union of its parts; each part is a closed solid with courtyards left open.
    """
    volumes = volumes_of(city.layout, city.terrain)
    foot = np.where(volumes.walls, volumes.low, np.minimum(volumes.eave, volumes.top - 0.3))
    solids, failed = prisms(volumes.polygons, foot, volumes.top, volumes.ground)
    batch = assemble(solids, volumes.building, finishes_of(city))
    failures = tuple(
        Failure(int(building), ACTION, "outline left out: it encloses no area")
        for building in volumes.building[failed]
    )
    return replace(
        city,
        scene=city.scene.with_mesh("buildings", batch),
        stages_done=city.stages_done | {"building"},
        failures=city.failures + failures,
    )
