"""Check of the site: every building and every thing lies within it."""

from __future__ import annotations

import numpy as np
import shapely

from cityx.checks.check import Check, named
from cityx.city import City

BEYOND = 2.0  # metres; lamps, trees and reeds along what the border cuts stand a step beyond


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
