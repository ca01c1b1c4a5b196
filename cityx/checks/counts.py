"""Counts of what a city holds."""

from __future__ import annotations

import numpy as np
import shapely

from cityx.assets.styles.package_generators import outside_buildings, package_generators
from cityx.assets.vehicles.moving import mover_counts
from cityx.city import City
from cityx.city.layout import is_mesh


def counts(city: City) -> dict[str, float]:
    """Count what the city holds."""
    roads = city.layout.roads
    length = shapely.length(roads.geometry.to_numpy()).sum() / 1000 if len(roads) else 0.0
    rows = city.scene.instances
    network = city.network
    moving = mover_counts(city.tracks, city.moment)
    junctions = 0 if network is None else int(np.count_nonzero(network.node_degree >= 3))
    return {
        "buildings": built_count(city),
        "buildings_failed": _failed_buildings(city),
        "road_km": round(float(length), 3),
        "junctions": junctions,
        "trees": rows["trees"].count if "trees" in rows else 0,
        "windows": rows["windows"].count if "windows" in rows else 0,
        "instances": sum(table.count for table in rows.values()),
        "prototypes": len(city.scene.prototypes),
        "vehicles": (rows["vehicles"].count if "vehicles" in rows else 0) + moving["vehicles"],
        "pedestrians": moving["pedestrians"],
    }


def generators_of(city: City) -> dict[str, dict[str, int | str]]:
    """Count the buildings of each generator; of one from a package, say which action made them."""
    names = city.layout.buildings["generator"].to_numpy(str)
    known, count = np.unique(names[names != ""], return_counts=True)
    found: dict[str, dict[str, int | str]] = {}
    owner = city.layout.parts["building"].to_numpy(np.uint64)[is_mesh(city.layout)]
    meshes = set(names[np.isin(city.layout.buildings["id"].to_numpy(np.uint64), owner)].tolist())
    for name, number in zip(known.tolist(), count.tolist(), strict=True):
        found[name] = {"buildings": number}
        whole = name in meshes or name in package_generators()
        made = outside_buildings().get(name) if whole else None
        if made is not None:
            found[name] |= {"action": made.action, "package": made.package}
    return found


def _failed_buildings(city: City) -> int:
    failed = {failure.object_id for failure in city.failures}
    return int(np.isin(city.layout.buildings["id"].to_numpy(), list(failed)).sum()) if failed else 0


def built_count(city: City) -> int:
    """Count buildings with a shape: shells of their own, and assets of the library."""
    batch, rows = city.scene.meshes.get("buildings"), city.scene.instances.get("building_assets")
    return (0 if batch is None else batch.count) + (0 if rows is None else rows.count)
