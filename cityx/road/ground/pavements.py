"""What walks and the ground before houses are paved with.

References
----------
Senate of Berlin, "Ausführungsvorschriften zu § 7 des Berliner Straßengesetzes über Geh- und
Radwege", 2013: slabs between an upper and a lower band of small stones.
Department for Transport, "Manual for Streets 2", 2010: flags to the building line in old centres.
Ministry of Land, Infrastructure, Transport and Tourism, guideline on guiding blocks, 1985.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from cityx.assets.styles.surface_states import state_of
from cityx.city.ground import Ground
from cityx.city.layout import Layout
from cityx.city.roads import RoadNetwork
from cityx.ground.arrangement import face_areas, inner_points
from cityx.ground.drape import Paving
from cityx.ids import choose, hash_ids
from cityx.places.profile import Land
from cityx.road.ground.joints import courses

# Hot rolled asphalt of the British Isles has pale chippings rolled into it, laid bare by tyres.
CHIPPED = state_of("asphalt", age=0.75, wear=0.0)
CHIPPED_WORD = "chipped_asphalt"  # how profiles of places call it
BENT = {"slab_walk": "mosaic"}
# What lies before houses where each was paved by itself, with weights.
FORECOURTS = {"yard": 2.0, "asphalt_light": 3.0, "mosaic": 0.8, "clinker": 1.2, "pavers": 1.0}
# The same of large ones, which are laid out to be seen.
LARGE, LARGE_FORECOURTS = 30.0, (0.3, 0.6, 2.0, 3.0, 3.0)
PURPOSE = "ground/forecourt"
MAIN = ("primary", "secondary", "tertiary", "trunk")
LEAST_GUIDED, WIDE = 2.0, 2.8  # metres of walk with such a line, of main streets and of any


def paved(ground: Ground, network: RoadNetwork, layout: Layout, land: Land) -> Paving:
    """Return how the faces of a ground are paved.

    Parameters
    ----------
    ground, network, layout
        The ground, the streets on it, and the layout that they come from.
    land
        Of the profile of the place.
    """
    laid = {
        surface: CHIPPED if material == CHIPPED_WORD else material
        for surface, material in land.paving.items()
    }
    if not land.guided:
        return courses(ground, network, laid, bent=BENT if "slab_walk" in laid.values() else {})
    found = courses(ground, network, laid, guided="guided_blocks", main=_guided(layout, network))
    rows = np.flatnonzero(ground.labelled("frontage"))
    cell = np.round(inner_points(ground)[rows] * 10).astype(np.int64).view(np.uint64)
    ids = hash_ids(0, PURPOSE, cell[:, 0], cell[:, 1])
    kind = np.where(
        face_areas(ground)[rows] > LARGE,
        choose(0, PURPOSE, ids, list(LARGE_FORECOURTS)),
        choose(0, PURPOSE, ids, list(FORECOURTS.values())),
    )
    material = found.material.copy()
    material[rows] = len(found.materials) + kind
    return replace(found, material=material, materials=(*found.materials, *FORECOURTS))


def _guided(layout: Layout, network: RoadNetwork) -> NDArray[np.bool_]:
    """(e,) whether the walks of edges have a line of ribs."""
    table = layout.roads.iloc[network.edge_road]
    wide = table[["sidewalk_left", "sidewalk_right"]].to_numpy(float).max(axis=1, initial=0.0)
    return np.asarray(
        (table["kind"].isin(MAIN).to_numpy() & (wide >= LEAST_GUIDED)) | (wide >= WIDE)
    )
