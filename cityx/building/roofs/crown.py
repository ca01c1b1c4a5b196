"""Crowns: what a building bears at its top: mouldings, dormers, windows of gables, ridge caps."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from cityx.building.assembly import TRIM_MATERIAL, assemble
from cityx.building.facade.cornices import corner_stones, mouldings
from cityx.building.facade.placing import Placing
from cityx.building.growth import Piece, piece_of
from cityx.building.roofs.dormers import dormers
from cityx.building.roofs.gables import gable_windows
from cityx.building.roofs.roof_edges import roof_edges
from cityx.building.roofs.roof_heights import RoofField, roof_field

if TYPE_CHECKING:
    from cityx.building.facade.facade import Facade
    from cityx.city.city import City

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
