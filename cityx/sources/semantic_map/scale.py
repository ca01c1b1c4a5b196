"""Scale: how many metres a pixel of a map is, estimated from its streets or houses."""

from __future__ import annotations

import numpy as np
import shapely

from cityx.errors import InputError
from cityx.geometry.raster.centrelines import centrelines
from cityx.geometry.raster.patches import label_patches, without_specks
from cityx.sources.class_map import COARSEST, FINEST, ClassMap, uncovered
from cityx.sources.map_classes import Role

USUAL_STREET = 7.0  # metres from kerb to kerb, the median by length over the maps of many cities
USUAL_HOUSE = 150.0  # square metres, the median outline
FEW = 12  # houses or widths of street from which a median says something
SPECK = 30  # pixels


def estimated_pixel(found: ClassMap) -> tuple[float, str]:
    """Estimate the metres of a pixel.

    Parameters
    ----------
    found
        The map, with any grid.

    Returns
    -------
    pixel
        Metres, rounded to two digits.
    evidence
        A sentence.

    Raises
    ------
    InputError
        If the map shows too little to tell.
    """
    found = uncovered(found)
    streets = _street(found)
    houses = _house(found)
    if streets is not None:
        pixel, why = USUAL_STREET / streets, f"its streets are {streets:.1f} pixels wide"
        why += f" in the median, taken for {USUAL_STREET:g} m"
    elif houses is not None:
        pixel = float(np.sqrt(USUAL_HOUSE / houses))
        why = f"its houses take {houses:.0f} pixels in the median, taken for {USUAL_HOUSE:g} m²"
    else:
        raise InputError(
            "The map does not say how large its pixels are, and shows too few streets and houses "
            "to estimate it; give the metres of a pixel."
        )
    pixel = float(f"{np.clip(pixel, FINEST, COARSEST):.2g}")
    return pixel, f"a pixel is taken for {pixel:g} m: {why}"


def _street(found: ClassMap) -> float | None:
    """Return the median width of streets by length, pixels."""
    mask = ~without_specks(~without_specks(found.mask(Role.ROAD), SPECK), SPECK)
    ways = centrelines(mask, tolerance=1.0)
    length = shapely.length(ways.lines)
    if len(length) == 0:
        return None
    order = np.argsort(ways.width)
    total = np.cumsum(length[order])
    width = float(ways.width[order][np.searchsorted(total, total[-1] / 2)])
    return width if total[-1] > FEW * width > 0 else None


def _house(found: ClassMap) -> float | None:
    """Return the median size of houses, pixels."""
    labels, count = label_patches(without_specks(found.mask(Role.BUILDING), SPECK / 2))
    return float(np.median(np.bincount(labels.ravel())[1:])) if count >= FEW else None
