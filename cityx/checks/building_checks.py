"""Checks of buildings: overlap, roads under them, closed solids, plan area, ground contact.

The limit of a check is a constant at the top of its module.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.checks.check import Check, named
from cityx.checks.shell_checks import undersides_of, wanted_undersides
from cityx.city import City
from cityx.city.ground import ROADWAY
from cityx.city.mesh_measures import check_closed, plan_area
from cityx.geometry.faces import doubled_areas
from cityx.geometry.triangle_cells import near_boxes
from cityx.ground.building_passages import open_ways

OVERLAP_PAIR = 1.0  # m2; smaller overlaps are drawing accuracy, not two buildings in one place
ON_ROAD_SHARE = 0.002  # of the carriageway area, passages apart
IN_STREET = 0.05  # of a footprint; less is a corner that map and width of the street disagree on
IN_STREET_LEAST = 4.0  # m2, a kiosk; on real maps no building has 0.1 m2 there
PLAN_AREA_ERROR = 0.005  # of the footprint
PLAN_AREA_SLACK = 0.01  # m2; outlines are kept to the millimetre, which shows on a flagpole's base
IN_WATER, FEW_IN_WATER = 0.1, 2  # share of buildings, and how many; jetties and mills
AFLOAT = ("houseboat", "boathouse", "stilt_house", "boat", "ship", "lighthouse")
WATER = ("sea", "water", "river", "pool")
FOOT = 0.05  # metres over the lowest vertex of a building that are its foot
BESIDE = 0.05  # square metres of a plan beside a way; less carries nothing
FLOATING = 0.0  # metres of air allowed under a building
GROUND_LEVEL = 0.5  # parts that begin lower stand on the ground, metres
NEARBY = 8.0  # metres, of the cells by which faces of a roadway near houses are found


def check_buildings(city: City) -> list[Check]:
    """Run every check on buildings."""
    checks = [_overlap(city), *_on_road(city), *_in_water(city)]
    batch = city.scene.meshes.get("buildings")
    if batch is not None and batch.count:
        closed = check_closed(batch)
        checks.append(
            Check("closed_solids", float(closed.mean()), 1.0,
                  "share of buildings whose solids are all closed", at_least=True,
                  ids=named(batch.object_id[~closed]))
        )  # fmt: skip
        checks.append(_plan_area(city))
        checks.append(_floating(city))
    return checks


def _overlap(city: City) -> Check:
    parts = city.layout.parts
    shapes = parts.geometry.to_numpy()
    tree = shapely.STRtree(shapes)
    first, second = tree.query(shapes, predicate="intersects")
    building = parts["building"].to_numpy()
    base, top = parts["base"].to_numpy(), parts["top"].to_numpy()
    apart = (first < second) & (building[first] != building[second])
    apart &= np.minimum(top[first], top[second]) > np.maximum(base[first], base[second])
    first, second = first[apart], second[apart]
    shared = shapely.area(shapely.intersection(shapes[first], shapes[second]))
    pairs = np.column_stack([building[first], building[second]])[shared > OVERLAP_PAIR]
    return Check(
        "building_overlap",
        float(len(pairs)),
        0,
        f"pairs of buildings that share more than {OVERLAP_PAIR:g} m2 of ground and height",
        ids=named(pairs.ravel()),
    )


def _in_water(city: City) -> list[Check]:
    """Measure the buildings that stand in water; few do on any shore, and boats swim there."""
    areas, houses = city.layout.areas, city.layout.buildings
    houses = houses[~houses["use"].isin(AFLOAT).to_numpy()]
    water = areas.geometry.to_numpy()[areas["kind"].isin(WATER).to_numpy()]
    if not len(water) or not len(houses):
        return []
    shapes = houses.geometry.to_numpy()
    row, sheet = shapely.STRtree(water).query(shapes, predicate="intersects")
    covered = np.bincount(
        row, shapely.area(shapely.intersection(shapes[row], water[sheet])), minlength=len(shapes)
    )
    drowned = covered > shapely.area(shapes) / 2
    share = float(drowned.mean()) if drowned.sum() > FEW_IN_WATER else 0.0
    return [
        Check("buildings_in_water", share, IN_WATER,
              f"share of buildings half of which stand in water, where it is more than "
              f"{FEW_IN_WATER} of them", ids=named(houses["id"].to_numpy()[drowned]))
    ]  # fmt: skip


def _on_road(city: City) -> list[Check]:
    """Measure the carriageways under buildings, and the buildings that stand in a street."""
    parts = city.layout.parts
    standing = (parts["base"].to_numpy() < GROUND_LEVEL) & parts["walls"].to_numpy()
    shapes = shapely.difference(parts.geometry.to_numpy(), open_ways(city.layout))[standing]
    building = parts["building"].to_numpy()[standing]
    under, total = _paved_under(city, shapes)
    ids, row = np.unique(building, return_inverse=True)
    area = np.bincount(row, shapely.area(shapes), minlength=len(ids))
    paved = np.bincount(row, under, minlength=len(ids))
    inside = paved > np.maximum(IN_STREET * area, IN_STREET_LEAST)
    return [
        Check("building_on_road", float(under.sum() / max(total, 1e-9)), ON_ROAD_SHARE,
              "share of the carriageway that lies under buildings, passages apart"),
        Check("building_in_street", float(inside.sum()), 0,
              f"buildings with over {IN_STREET:.0%} of their footprint, and "
              f"{IN_STREET_LEAST:g} m2 of it, on a carriageway, passages apart",
              ids=named(ids[inside])),
    ]  # fmt: skip


def _paved_under(city: City, shapes: NDArray[Any]) -> tuple[NDArray[np.float64], float]:
    """Return the carriageway under each of (n,) shapes and that of the site, square metres."""
    ground = city.ground
    if ground is None:
        return np.zeros(len(shapes)), 0.0
    roads = city.layout.roads
    passages = roads["id"].to_numpy()[roads["passage"].to_numpy()]
    road_face = ground.labelled(*ROADWAY) & ~np.isin(ground.face_object, passages)
    paved = ground.triangles[road_face[ground.triangle_face]]
    total = float(doubled_areas(ground.vertices, paved).sum() / 2)
    near = near_boxes(ground.vertices, paved, shapely.bounds(shapes), NEARBY)
    triangles = shapely.polygons(ground.vertices[paved[near]])
    row, hit = shapely.STRtree(shapes).query(triangles, predicate="intersects")
    shared = shapely.area(shapely.intersection(triangles[row], shapes[hit]))
    under = np.asarray(np.bincount(hit, shared, minlength=len(shapes)), float)
    return under, total


def _plan_area(city: City) -> Check:
    """Compare the lowest faces of every building with the footprints of its standing parts."""
    batch = city.scene.meshes["buildings"]
    under = wanted_undersides(city)
    measured = plan_area(batch, below=undersides_of(city, batch))
    ids, row = np.unique(under.building, return_inverse=True)
    expected = np.bincount(row, weights=under.area, minlength=len(ids))
    found = np.searchsorted(ids, batch.object_id)
    wanted = expected[np.minimum(found, len(ids) - 1)]
    error = np.maximum(np.abs(measured - wanted) - PLAN_AREA_SLACK, 0) / np.maximum(wanted, 1e-9)
    return Check(
        "plan_area_error",
        float(np.mean(error > PLAN_AREA_ERROR)),
        0.005,
        f"share of buildings whose plan area is off by more than {PLAN_AREA_ERROR:.1%}",
    )


def _floating(city: City) -> Check:
    gap = floating_gap(city)
    return Check(
        "floating_building",
        float(gap.max(initial=0.0)),
        FLOATING,
        "largest gap between a building that stands on the ground and the terrain, metres",
        ids=named(city.scene.meshes["buildings"].object_id[gap > FLOATING]),
    )


def floating_gap(city: City) -> NDArray[np.float64]:
    """Return (k,) metres of air under the lowest vertices of each building that should stand."""
    batch = city.scene.meshes["buildings"]
    bottom = np.minimum.reduceat(batch.vertices[:, 2], batch.vertex_start[:-1])
    of_vertex = np.repeat(np.arange(batch.count), np.diff(batch.vertex_start))
    # Eaves reach out over ground that may lie lower: only where a building stands does it float.
    foot = batch.vertices[:, 2] < bottom[of_vertex] + FOOT
    lowest = np.full(batch.count, np.inf)
    surface = city.terrain.height_at(batch.vertices[foot, :2])
    np.minimum.at(lowest, of_vertex[foot], surface)
    parts = city.layout.parts
    grounded = (parts["base"].to_numpy() < GROUND_LEVEL) & parts["walls"].to_numpy()
    # A house as narrow as the way through it hangs between its neighbours.
    beside = shapely.difference(parts.geometry.to_numpy(), open_ways(city.layout))
    grounded &= shapely.area(beside) > BESIDE
    standing = parts["building"].to_numpy()[grounded]
    return np.where(np.isin(batch.object_id, standing), np.maximum(bottom - lowest, 0.0), 0.0)
