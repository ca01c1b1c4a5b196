"""Buildings that stand apart on large plots: slabs, campuses, works and shops with car parks."""

from __future__ import annotations

import numpy as np

from cityx.geometry.plots import Plots, pads_in
from cityx.sources.parcels.built import Built, building_tags, built, habitable, pad_box

SLAB_WIDTH = 12.5  # metres of a house with flats to two sides
SLAB_LENGTH = 72.0  # metres at most
SLAB_GAP = 18.0  # metres between slabs, for light
BARS = 8  # at most, on one plot
CAMPUS_WING = 15.0  # metres; a corridor between two rows of rooms
ROAD = 7.0  # metres of a lane between cars


def slabs(plots: Plots, target: float, *, seed: int) -> list[Built]:
    """Raise free-standing slabs in parallel on a lawn, with a car park by the street."""
    pads = pads_in(plots, plots.room(front=6.0, side=5.0))
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
    found = []
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
    """Raise halls around a green court that is open to the street."""
    pads = pads_in(plots, plots.room(front=8.0, side=6.0))
    wing = np.minimum(CAMPUS_WING, np.minimum(pads.width, pads.depth) / 3)
    wanted = target * plots.area / np.maximum(wing, 1.0)  # metres of building
    # Two wings and the hall between: 2 d + w - 2 wing = wanted, of the pad's proportions.
    full = 2 * pads.depth + pads.width - 2 * wing
    scale = np.minimum(1.0, (wanted + 2 * wing) / np.maximum(full + 2 * wing, 1.0))
    width, depth = pads.width * scale, pads.depth * scale
    x0 = pads.x0 + (pads.width - width) / 2
    x1, y0 = x0 + width, pads.y0 + (pads.depth - depth) / 2
    y1 = y0 + depth
    ring = [
        [x0, y0], [x0 + wing, y0], [x0 + wing, y1 - wing], [x1 - wing, y1 - wing], [x1 - wing, y0],
        [x1, y0], [x1, y1], [x0, y1],
    ]  # fmt: skip
    hall = plots.outlines(np.moveaxis(np.array(ring), 2, 0))
    levels = 2.0 + np.rint(3.0 * plots.density * plots.draw("levels", 0.4, 1.2, seed=seed))
    tags = building_tags(plots, "university", levels)
    stands = habitable(hall) & (wing > 6.0)
    court = plots.boxes(x0 + wing + 3, y0, x1 - wing - 3, y1 - wing - 3)
    return [
        built("hall", hall, tags, stands),
        built("court", court, {"leisure": "park"}, stands & (x1 - x0 > 3 * wing)),
    ]


def works(plots: Plots, target: float, *, seed: int) -> list[Built]:
    """Raise a hall with a yard before it and an office at its corner."""
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
    roof = np.where(plots.draw("roof", 0, 1, seed=seed) < 0.3, "sawtooth", "flat")
    tags = building_tags(plots, "industrial", np.ones(plots.count))
    for own, shape in zip(tags, roof.tolist(), strict=True):
        own["roof:shape"] = shape
    office_tags = {"building": "office", "building:levels": "2", "roof:shape": "flat"}
    parked = stands & (lot1 - lot0 > 12.0) & (front + office_depth - 3.0 - pads.y0 > 12.0)
    return [
        built("hall", hall, tags, stands),
        built("office", office, office_tags, stands & habitable(office)),
        built("parking", yard, {"amenity": "parking"}, parked),
    ]


def shops(plots: Plots, target: float, *, seed: int) -> list[Built]:
    """Raise a shop at the back of its plot, with its car park to the street."""
    pads = pads_in(plots, plots.room(front=3.0, side=2.0))
    wanted = target * plots.area
    depth = np.clip(wanted / np.maximum(pads.width, 1.0), 10.0, pads.depth)
    width = np.minimum(pads.width, wanted / np.maximum(depth, 1.0))
    at = plots.draw("shop", 0.0, 1.0, seed=seed)
    x0 = pads.x0 + at * (pads.width - width)
    shop = plots.boxes(x0, pads.y1 - depth, x0 + width, pads.y1)
    stands = habitable(shop)
    lot_depth = pads.depth - depth - 2.5
    lot = pad_box(plots, pads, pads.width, np.maximum(lot_depth, 0.0))
    use = np.where(plots.draw("use", 0, 1, seed=seed) < 0.3, "supermarket", "retail")
    tags = building_tags(plots, "retail", np.ones(plots.count), **{"roof:shape": "flat"})
    for own, word in zip(tags, use.tolist(), strict=True):
        own["building"] = word
    return [
        built("shop", shop, tags, stands),
        built("parking", lot, {"amenity": "parking"}, stands & (lot_depth > 5.0)),
    ]
