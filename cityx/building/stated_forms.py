"""Stated forms: what the map says of the roof and the height of buildings, which designs keep."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.building.massing.massing import Mass
from cityx.geometry.arrays import FloatArray
from cityx.sources.features.roofs import SHAPE
from cityx.sources.features.tagged import Tags
from cityx.sources.features.vertical import Vertical, read_vertical

if TYPE_CHECKING:
    from geopandas import GeoDataFrame

MADE = ("parcel/", "made/")  # sources whose tags are a town's own words, which its designs fill in
LOW_LEVELS = 4  # storeys; a taller building may step back below the height that is stated
AS_HIGH = 0.9  # of the stated height that the volumes of a low building reach
COVERED = 0.97  # share of its plan on which they do
_TELLING = re.compile('height"|:angle"|roof')


@dataclass(frozen=True)
class StatedForms:
    """What tags state of the form of n buildings.

    Attributes
    ----------
    roof
        (n,) bool, a roof with slopes: its shape, direction, orientation, pitch or height.
    flat
        (n,) bool, a flat roof and no more.
    height
        (n,) metres, NaN where nothing is stated.
    mapped
        (n,) bool, whether a map or a drawing speaks, not the town's own plan.
    """

    roof: NDArray[np.bool_]
    flat: NDArray[np.bool_]
    height: FloatArray
    mapped: NDArray[np.bool_]


def stated_forms(buildings: GeoDataFrame) -> StatedForms:
    """Read what the tags of buildings state of their form."""
    own = [_tags(text) for text in buildings["tags"].to_numpy(str).tolist()]
    said = read_vertical(own)
    roof = (said.roof_shape >= 0) | said.across | said.along
    roof |= ~np.isnan(_measures(said)).all(axis=0)
    flat = (said.roof_shape == SHAPE["flat"]) & ~(np.nan_to_num(said.roof_height) > 0.0)
    source = buildings["source"].to_numpy(str)
    made = np.zeros(len(source), bool)
    for word in MADE:
        made |= np.char.startswith(source, word)
    return StatedForms(roof & ~flat, flat, said.height, ~made)


def keeps_form(
    masses: Sequence[Mass], plan: shapely.Polygon, levels: int, *, flat: bool, height: float
) -> bool:
    """Return whether the volumes of a design keep a flat roof and a height that are stated.

    Parameters
    ----------
    plan
        The mapped outline.
    levels
        Storeys of the building.
    flat, height
        As in `StatedForms`, of one building.
    """
    if flat and any(mass.roof != "flat" for mass in masses):
        return False
    if np.isnan(height) or levels > LOW_LEVELS:
        return True
    high = [mass.plan for mass in masses if mass.high >= AS_HIGH * height]
    return bool(shapely.union_all(np.array(high, object)).area >= COVERED * plan.area)


def _tags(text: str) -> Tags:
    return json.loads(text) if _TELLING.search(text) else {}


def _measures(said: Vertical) -> FloatArray:
    return np.array([said.roof_height, said.roof_levels, said.roof_angle, said.roof_direction])
