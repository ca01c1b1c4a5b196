"""What walks and the ground before houses are paved with, by region.

References
----------
Senate of Berlin, "Ausführungsvorschriften zu § 7 des Berliner Straßengesetzes über Geh- und
Radwege", 2013: slabs between an upper and a lower band of small stones.
Department for Transport, "Manual for Streets 2", 2010: flags to the building line in old centres.
Ministry of Land, Infrastructure, Transport and Tourism, guideline on guiding blocks, 1985.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from cityx.assets.styles.palettes import region_of
from cityx.assets.styles.surface_states import state_of
from cityx.city.frame import Frame
from cityx.city.ground import Ground
from cityx.city.layout import Layout
from cityx.city.roads import RoadNetwork
from cityx.ground.arrangement import face_areas, inner_points
from cityx.ground.drape import Paving
from cityx.ids import choose, hash_ids
from cityx.road.ground.joints import courses

# Hot rolled asphalt of the British Isles has pale chippings rolled into it, laid bare by tyres.
CHIPPED = state_of("asphalt", age=0.75, wear=0.0)
# Surface to material, by region; what a region does not name keeps its usual material.
FLAGS = {
    "carriageway": CHIPPED,
    "junction": CHIPPED,
    "sidewalk": "flagstones",
    "ramp": "flagstones",
    "landing": "flagstones",
    "guide_strip": "tactile_red",
    "frontage": "flagstones",
}
SLABS = {
    "sidewalk": "slab_walk",
    "ramp": "mosaic",
    "landing": "mosaic",
    "frontage": "mosaic",
    "furnishing": "mosaic",
}
BENT = {"slab_walk": "mosaic"}
BLOCKS = {
    "sidewalk": "walk_blocks",
    "ramp": "walk_blocks",
    "landing": "walk_blocks",
    "gutter": "gutter_slabs",
}
# What lies before houses where each was paved by itself, with weights.
FORECOURTS = {"yard": 2.0, "asphalt_light": 3.0, "mosaic": 0.8, "clinker": 1.2, "pavers": 1.0}
# The same of large ones, which are laid out to be seen.
LARGE, LARGE_FORECOURTS = 30.0, (0.3, 0.6, 2.0, 3.0, 3.0)
REGION_PAVING: Mapping[str, Mapping[str, str]] = MappingProxyType({
    "british isles": FLAGS, "central europe": SLABS, "japan": BLOCKS, "east asia": BLOCKS,
})  # fmt: skip
PURPOSE = "ground/forecourt"
GUIDED = ("japan", "east asia")  # where a line of ribs leads along the walks of main streets
MAIN = ("primary", "secondary", "tertiary", "trunk")
LEAST_GUIDED, WIDE = 2.0, 2.8  # metres of walk with such a line, of main streets and of any


def paved(ground: Ground, network: RoadNetwork, layout: Layout, frame: Frame, place: str) -> Paving:
    """Return how the faces of a ground are paved.

    Parameters
    ----------
    ground, network, layout
        The ground, the streets on it, and the layout that they come from.
    frame
        Where it lies.
    place
        As of `cityx.ground.street_rules.place_of`.
    """
    region = "japan" if place == "japan" else region_of(frame.latitude, frame.longitude)
    laid = REGION_PAVING.get(region, {})
    if region not in GUIDED:
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
