"""Crowns: what a building bears at its top: mouldings, dormers, windows of gables, ridge caps."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from cityx.geometry.roof_heights import RoofField, roof_field
from cityx.plugins.building.assembly import TRIM_MATERIAL, assemble
from cityx.plugins.building.cornices import corner_stones, mouldings
from cityx.plugins.building.dormers import dormers
from cityx.plugins.building.gables import gable_windows
from cityx.plugins.building.growth import Piece, piece_of
from cityx.plugins.building.placing import Placing
from cityx.plugins.building.roof_edges import roof_edges

if TYPE_CHECKING:
    from cityx.city.city import City
    from cityx.plugins.building.facade import Facade

SHELLS = "buildings"  # the layer of the shells


def pitched_field(city: City, found: Facade) -> RoofField | None:
    """Return the roofs of all buildings with a slope; None where no shells are raised."""
    batch = city.scene.meshes.get(SHELLS)
    if batch is None:
        return None
    pitched = found.volumes.top - found.volumes.eave >= 0.15
    objects = np.isin(batch.object_id, found.volumes.building[pitched])
    return roof_field(batch, objects, (TRIM_MATERIAL,))


def crown(placing: Placing, found: Facade, city: City, field: RoofField | None) -> Piece | None:
    """Put instances on roofs and corners, and return the mouldings to add to the shells.

    Parameters
    ----------
    placing
        Takes the instances.
    city
        With the shells as they were raised.
    field
        Of those shells, see `pitched_field`.
    """
    corner_stones(placing, found, city.seed)
    if field is None:
        return None
    shells = city.scene.meshes[SHELLS]
    dormers(placing, found, city, field)
    gable_windows(placing, found, city, field)
    roof_edges(placing, shells)
    solids = mouldings(placing, found, city, field)
    return piece_of(assemble(solids, found.volumes.building, found.finishes), shells)
