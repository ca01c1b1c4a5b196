"""Large buildings on plots: blocks around courts, towers, slabs, campuses, works and shops."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.arrays import FloatArray
from cityx.geometry.parcels.plots import Plots, pads_in
from cityx.geometry.seams import unite
from cityx.sources.parcels.houses import Built, building_tags, built, habitable, heights_of, pad_box

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
BLOCK_DEPTH = (10.0, 13.5)  # metres of a house with light from two sides
RING_SHARE = 0.9  # of the wanted ground that houses along the street take; wings take the rest
WING = 5.8  # metres; a wing along the party wall has rooms to one side
SHORTEST_WING, LONGEST_WING = 4.0, 18.0  # metres
NEWTON = 4  # steps until the area of a base is right to a thousandth
COURT = 4.0  # metres that a wing keeps from the rear border
USUAL_DEPTH = 34.0  # metres; what lies further back counts for no wing
TOWER_FROM = 30.0  # metres; a lower building of the core is all of a piece
SMALLEST_TOWER, LARGEST_TOWER = 15.0, 38.0  # metres a side
PODIUM_LEVELS = (3.0, 5.0)
STOREY = 4.0  # metres, of a podium
FAR = 500.0  # metres; wider than any parcel


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


def perimeter_blocks(plots: Plots, target: float, *, seed: int) -> list[Built]:
    """Raise houses along the streets, wall to wall around a court, with wings into it."""
    depth = _ring_depth(plots, RING_SHARE * target)
    front = plots.within(plots.street_margin(depth))
    front = _largest(front)
    counted = np.minimum(plots.area, USUAL_DEPTH * shapely.length(plots.street))
    missing = target * counted - shapely.area(front)
    room = plots.high[:, 1] - COURT - depth
    reach = np.minimum(np.clip(missing / WING, 0.0, LONGEST_WING), room)
    left = plots.draw("wing-side", 0, 1, seed=seed) < 0.5
    x0 = np.where(left, -FAR, plots.high[:, 0] - WING)
    x1 = np.where(left, plots.low[:, 0] + WING, FAR)
    wing = plots.within(plots.boxes(x0, depth - 1.0, x1, depth + reach))
    fits = (reach > SHORTEST_WING) & (shapely.get_type_id(wing) == 3) & habitable(wing)
    house = front.copy()
    rows = np.flatnonzero(fits)
    house[rows] = unite(front[rows], wing[rows])
    broken = (shapely.get_type_id(house) != 3) | ~habitable(house)
    house = np.where(broken, front, house)
    levels = 3.6 + 2.4 * plots.density + plots.draw("levels", -0.7, 0.7, seed=seed)
    tags = building_tags(plots, "apartments", levels)
    return [built("house", house, tags, habitable(house))]


def _ring_depth(plots: Plots, target: float) -> FloatArray:
    """Return how deep houses around the court of each block are to take a share of its ground."""
    block = np.unique(plots.block_id, return_inverse=True)[1]
    area = np.bincount(block, plots.area)[block]
    street = np.bincount(block, shapely.length(plots.street))[block]
    # A ring of depth t takes street * t - 4 t^2 of a block with four corners.
    root = np.sqrt(np.maximum(street**2 - 16 * target * area, 0.0))
    return np.asarray(np.clip(np.round((street - root) / 8, 2), *BLOCK_DEPTH))


def _largest(shapes: NDArray[Any]) -> NDArray[Any]:
    """Return the largest polygon of each shape."""
    parts, row = shapely.get_parts(shapes, return_index=True)
    order = np.lexsort((-np.round(shapely.area(parts), 6), row))
    parts, row = parts[order], row[order]
    largest = np.full(len(shapes), shapely.Polygon(), object)
    kept, first = np.unique(row, return_index=True)
    largest[kept] = parts[first]
    return largest


def core_towers(plots: Plots, target: float, *, seed: int) -> list[Built]:
    """Raise podiums with towers on them, plazas around."""
    base = _scaled(plots, target)
    stands = habitable(base)
    pads = pads_in(plots, shapely.buffer(base, -2.5, join_style="mitre"))
    levels = 5.0 + 26.0 * plots.density**2 * plots.draw("levels", 0.5, 1.5, seed=seed)
    height = heights_of(plots, "office", levels)
    side = plots.draw("tower", 22.0, LARGEST_TOWER, seed=seed)
    half_x, half_y = np.minimum(pads.width, side) / 2, np.minimum(pads.depth, side) / 2
    x, y = (pads.x0 + pads.x1) / 2, (pads.y0 + pads.y1) / 2
    tower = plots.boxes(x - half_x, y - half_y, x + half_x, y + half_y)
    slim = np.minimum(half_x, half_y) * 2
    towering = stands & (height >= TOWER_FROM) & (slim >= SMALLEST_TOWER)
    low = np.rint(plots.draw("podium", *PODIUM_LEVELS, seed=seed))
    tags = building_tags(plots, "office", levels)
    parts, podiums = [], []
    for metres, storeys, own in zip(height.tolist(), low.tolist(), tags, strict=True):
        own["height"] = f"{metres:.1f}"
        parts.append({
            "building:part": "yes", "height": own["height"],
            "building:levels": own["building:levels"], "roof:shape": "flat",
        })  # fmt: skip
        podiums.append({
            "building:part": "yes", "height": f"{storeys * STOREY:.1f}",
            "building:levels": str(int(storeys)), "roof:shape": "flat",
        })  # fmt: skip
    rest = shapely.difference(base, tower)
    return [
        built("house", base, tags, stands),
        built("podium", rest, podiums, towering),
        built("tower", tower, parts, towering),
    ]


def _scaled(plots: Plots, target: float) -> NDArray[Any]:
    """Return the parcels less a margin all around that leaves a share of their area."""
    distance = np.zeros(plots.count)
    for _ in range(NEWTON):  # a step of Newton's method; a margin changes the area by its length
        left = shapely.buffer(plots.shapes, -distance, join_style="mitre")
        length = np.maximum(shapely.length(left), 1.0)
        distance = np.maximum(distance + _error(left, plots.area, target) / length, 0.0)
    return _largest(shapely.buffer(plots.shapes, -distance, join_style="mitre"))


def _error(shapes: NDArray[Any], whole: FloatArray, target: float) -> FloatArray:
    return np.asarray(shapely.area(shapes) - target * whole)
