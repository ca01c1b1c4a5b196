"""Buildings that stand apart on large plots: slabs, campuses, works and shops with car parks."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.parcels.plots import Plots, pads_in
from cityx.geometry.polygons import FloatArray
from cityx.sources.parcels.built import Built, building_tags, built, habitable, pad_box

SLAB_WIDTH = 12.5  # metres of a house with flats to two sides
SLAB_LENGTH = 72.0  # metres at most
SLAB_GAP = 18.0  # metres between slabs, for light
CAR_PARK = (40.0, 15.5)  # metres along the street and deep: two rows and the lane between
SHOP_SIDES = 2.5  # times as long as deep, a shop at most
BARS = 8  # at most, on one plot
CAMPUS_WING = 15.0  # metres; a corridor between two rows of rooms
ROAD = 7.0  # metres between an office and the cars
OFFICES = 0.35  # share of the works that are led from a house of their own
LANE = 5.5  # metres, of a drive to a car park


def _lane(plots: Plots, x: FloatArray, y: FloatArray, where: NDArray[np.bool_]) -> Built:
    """Return a lane from the street to the near side of a car park."""
    lane = plots.within(plots.boxes(x - LANE / 2, -1.0, x + LANE / 2, y))
    plain = shapely.get_type_id(lane) == 3
    return built("lane", lane, {"area:highway": "service"}, where & plain)


def slabs(plots: Plots, target: float, *, seed: int) -> list[Built]:
    """Raise free-standing slabs in parallel on a lawn, with a car park by the street."""
    pads = pads_in(plots, plots.room(front=6.0, side=5.0))
    parked = pads.depth > 4 * CAR_PARK[1]
    lot_width = np.minimum(CAR_PARK[0], pads.width)
    side = plots.draw("car-park", 0, 1, seed=seed)
    lot = pad_box(plots, pads, *CAR_PARK, at=side)
    entry = pads.x0 + side * (pads.width - lot_width) + lot_width / 2
    lane = _lane(plots, entry, pads.y0, parked)
    pads = replace(pads, y0=pads.y0 + np.where(parked, CAR_PARK[1] + 4.0, 0.0))
    # Rows across or along the street, whichever the block's draw says.
    across = plots.draw_alike("slab-turn", 0, 1, seed=seed) < 0.5
    room_along = np.where(across, pads.depth, pads.width)
    room_across = np.where(across, pads.width, pads.depth)
    length = np.minimum(room_along, SLAB_LENGTH)
    wanted = target * plots.area / SLAB_WIDTH  # metres of slab
    most = np.maximum((room_across + SLAB_GAP) // (SLAB_WIDTH + SLAB_GAP), 1)
    count = np.clip(np.ceil(wanted / np.maximum(length, 1.0)), 1, np.minimum(most, BARS))
    length = np.minimum(length, wanted / count)
    step = np.where(count > 1, (room_across - SLAB_WIDTH) / np.maximum(count - 1, 1), 0.0)
    first = np.where(count > 1, 0.0, (room_across - SLAB_WIDTH) / 2)
    shift = plots.draw("slab-shift", 0.0, 1.0, seed=seed) * (room_along - length)
    levels = 5.0 + np.rint(8.0 * plots.density * plots.draw_alike("levels", 0.5, 1.2, seed=seed))
    tags = building_tags(plots, "apartments", levels, **{"roof:shape": "flat"})
    found = [built("parking", lot, {"amenity": "parking"}, parked), lane]
    for k in range(int(count.max(initial=0))):
        u0 = first + k * step
        u1, v0, v1 = u0 + SLAB_WIDTH, shift, shift + length
        x0, x1 = np.where(across, u0, v0) + pads.x0, np.where(across, u1, v1) + pads.x0
        y0, y1 = np.where(across, v0, u0) + pads.y0, np.where(across, v1, u1) + pads.y0
        bar = plots.boxes(x0, y0, x1, y1)
        stands = (k < count) & (room_across >= SLAB_WIDTH) & habitable(bar)
        found.append(built(f"slab{k}", bar, tags, stands))
    return found


def campuses(plots: Plots, target: float, *, seed: int) -> list[Built]:
    """Raise halls around a green court that is open to the street, or to the back."""
    pads = pads_in(plots, plots.room(front=8.0, side=6.0))
    wing = np.minimum(CAMPUS_WING, np.minimum(pads.width, pads.depth) / 3)
    wanted = target * plots.area / np.maximum(wing, 1.0)  # metres of building
    # Two wings and the hall between: 2 d + w - 2 wing = wanted, of the pad's proportions.
    full = 2 * pads.depth + pads.width - 2 * wing
    scale = np.minimum(1.0, (wanted + 2 * wing) / np.maximum(full + 2 * wing, 1.0))
    width, depth = pads.width * scale, pads.depth * scale
    wing = np.minimum(wing, np.minimum(width / 2.5, depth / 1.5))  # a court is left between
    x0 = pads.x0 + (pads.width - width) / 2
    x1, y0 = x0 + width, pads.y0 + (pads.depth - depth) / 2
    y1 = y0 + depth
    # From the closed side of the court to the open one.
    front = plots.draw("court", 0, 1, seed=seed) < 0.6
    near, far = np.where(front, y1, y0), np.where(front, y0, y1)
    inner = near + np.where(front, -wing, wing)
    ring = [
        [x0, far], [x0 + wing, far], [x0 + wing, inner], [x1 - wing, inner], [x1 - wing, far],
        [x1, far], [x1, near], [x0, near],
    ]  # fmt: skip
    hall = plots.outlines(np.moveaxis(np.array(ring), 2, 0))
    levels = 2.0 + np.rint(3.0 * plots.density * plots.draw("levels", 0.4, 1.2, seed=seed))
    tags = building_tags(plots, "university", levels)
    stands = habitable(hall) & (wing > 6.0)
    low = np.where(front, y0, y0 + wing + 3)
    court = plots.boxes(x0 + wing + 3, low, x1 - wing - 3, low + depth - wing - 3)
    return [
        built("hall", hall, tags, stands),
        built("court", court, {"leisure": "park"}, stands & (x1 - x0 > 3 * wing)),
    ]


def works(plots: Plots, target: float, *, seed: int) -> list[Built]:
    """Raise a hall with a yard before it, some with an office at its corner."""
    pads = pads_in(plots, plots.room(front=5.0, side=4.0))
    office_width, office_depth = np.minimum(16.0, pads.width / 3), np.minimum(10.0, pads.depth / 4)
    wanted = target * plots.area - office_width * office_depth
    depth = np.minimum(pads.depth - office_depth, wanted / np.maximum(pads.width, 1.0))
    depth = np.clip(np.maximum(depth, np.sqrt(np.maximum(wanted, 0.0)) / 1.6), 0.0,
                    pads.depth - office_depth)  # fmt: skip
    width = np.minimum(pads.width, wanted / np.maximum(depth, 1.0))
    left = plots.draw("office", 0, 1, seed=seed) < 0.5
    x0 = np.where(left, pads.x0, pads.x1 - width)
    hall = plots.boxes(x0, pads.y1 - depth, x0 + width, pads.y1)
    edge = np.where(left, pads.x0, pads.x1 - office_width)
    front = pads.y1 - depth - office_depth
    office = plots.boxes(edge, front, edge + office_width, front + office_depth)
    lot0 = np.where(left, edge + office_width + ROAD, pads.x0)
    lot1 = np.where(left, pads.x1, edge - ROAD)
    yard = plots.boxes(lot0, pads.y0, lot1, np.maximum(front + office_depth - 3.0, pads.y0))
    stands = habitable(hall)
    led = stands & habitable(office) & (plots.draw("led", 0, 1, seed=seed) < OFFICES)
    roof = np.where(plots.draw("roof", 0, 1, seed=seed) < 0.3, "sawtooth", "flat")
    tags = building_tags(plots, "industrial", np.ones(plots.count))
    for own, shape in zip(tags, roof.tolist(), strict=True):
        own["roof:shape"] = shape
    office_tags = {"building": "office", "building:levels": "2", "roof:shape": "flat"}
    parked = stands & (lot1 - lot0 > 12.0) & (front + office_depth - 3.0 - pads.y0 > 12.0)
    return [
        built("hall", hall, tags, stands),
        built("office", office, office_tags, led),
        built("parking", yard, {"amenity": "parking"}, parked),
        _lane(plots, (lot0 + lot1) / 2, pads.y0, parked),
    ]


def shops(plots: Plots, target: float, *, seed: int) -> list[Built]:
    """Raise a shop at the back of its plot, with its car park to the street."""
    pads = pads_in(plots, plots.room(front=3.0, side=2.0))
    wanted = target * plots.area
    depth = np.maximum(wanted / np.maximum(pads.width, 1.0), np.sqrt(wanted / SHOP_SIDES))
    depth = np.clip(depth, 10.0, np.maximum(pads.depth, 10.0))
    width = np.minimum(pads.width, wanted / np.maximum(depth, 1.0))
    at = plots.draw("shop", 0.0, 1.0, seed=seed)
    x0 = pads.x0 + at * (pads.width - width)
    shop = plots.boxes(x0, pads.y1 - depth, x0 + width, pads.y1)
    stands = habitable(shop)
    lot_depth = pads.depth - depth - 2.5
    parked = stands & (lot_depth > 5.0)
    lot = pad_box(plots, pads, pads.width, np.maximum(lot_depth, 0.0))
    use = np.where(plots.draw("use", 0, 1, seed=seed) < 0.3, "supermarket", "retail")
    tags = building_tags(plots, "retail", np.ones(plots.count), **{"roof:shape": "flat"})
    for own, word in zip(tags, use.tolist(), strict=True):
        own["building"] = word
    return [
        built("shop", shop, tags, stands),
        built("parking", lot, {"amenity": "parking"}, parked),
        _lane(plots, (pads.x0 + pads.x1) / 2, pads.y0, parked),
    ]
