"""Relief: the ground of a height grid, and the houses, trees and streets that stand out of it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cityx.geometry.arrays import BoolArray, FloatArray
from cityx.geometry.chains import components
from cityx.geometry.raster.patches import label_patches, without_holes, without_specks

WINDOW = 60.0  # metres; no roof is wider in both directions, but for the largest halls
BLOCK = 2.0  # metres; the ground is sought in cells of this size, the lowest of each
ROUNDS = 6  # of finding more ground; each reaches on from the last
LOW = 0.4  # metres above the opened surface that is still ground: grass, kerbs, noise
HIGH = 2.5  # metres above the ground from which something is a house or a tree
EVEN = 0.5  # metres off a plane of 3 x 3 cells up to which a top is a roof; crowns lie twice as far
LEAST_ROOF = 30.0  # square metres of even top that make a house
LEAST_HOUSE = 40.0  # square metres
LEAST_YARD = 15.0  # square metres; a smaller hole in a house is noise
STEP = 2.5  # metres between two cells that part two roofs
LEAST_PART = 60.0  # square metres of a roof that is a house of its own
OPEN = 2.0  # metres; what is lower is open ground, with its hedges and cars
NARROW = 2.5  # metres from wall to the middle of the narrowest street
FRONT = 12.0  # metres from the houses at which the middle of a place begins
BROAD = 4.0  # metres to each side that the middle of a place has at least
LEAST_PLACE = 600.0  # square metres of it
LEAST_BLOCK = 800.0  # square metres of houses and yards that streets go round
LEAST_STREETS = 2000.0  # square metres of streets that hang together


def ground_below(surface: FloatArray, cell: float) -> FloatArray:
    """Find the ground below the houses and trees of a surface.

    What a window of 60 m opens is lower than the ground on slopes and never higher; cells near it
    are ground, and between those the ground is drawn smoothly.

    Parameters
    ----------
    surface
        (rows, columns) metres, without voids.
    cell
        Metres between cells.

    Returns
    -------
    ground
        (rows, columns) metres, nowhere above the surface.

    References
    ----------
    Zhang et al., "A progressive morphological filter for removing nonground measurements from
    airborne LIDAR data", 2003.
    """
    from scipy import ndimage

    stride = max(1, round(BLOCK / cell))
    lowest = _lowest(surface, stride)
    size = max(3, int(WINDOW / (cell * stride)) | 1)
    trend = _plane(_lowest(lowest, min(size, *lowest.shape)), lowest.shape)
    opened = ndimage.grey_opening(lowest - trend, size=(size, size), mode="nearest") + trend
    bare = lowest - opened < LOW
    ground = _drawn(lowest, bare)
    # Slopes rise above what was opened: what lies near the ground drawn so far is ground as well.
    for _ in range(ROUNDS):
        more = ~bare & (lowest - ground < LOW)
        if not more.any():
            break
        bare |= more
        ground = _drawn(lowest, bare)
    rows, columns = surface.shape
    place = np.mgrid[0:rows, 0:columns] / stride - (stride - 1) / (2 * stride)
    full = ndimage.map_coordinates(ground, place, order=1, mode="nearest")
    return np.minimum(full, surface)


def _lowest(surface: FloatArray, stride: int) -> FloatArray:
    """Return the lowest height of each block."""
    rows, columns = (-size % stride for size in surface.shape)
    padded = np.pad(surface, ((0, rows), (0, columns)), mode="edge")
    shape = (padded.shape[0] // stride, stride, padded.shape[1] // stride, stride)
    return np.asarray(padded.reshape(shape).min(axis=(1, 3)))


def _plane(values: FloatArray, shape: tuple[int, ...]) -> FloatArray:
    """Return the plane that fits some blocks best, at cells as fine as `shape`."""
    row, column = (
        axis / size for axis, size in zip(_middles(values.shape), values.shape, strict=True)
    )
    terms = np.column_stack([row.ravel(), column.ravel(), np.ones(values.size)])
    down, right, level = np.linalg.lstsq(terms, values.ravel(), rcond=None)[0].tolist()
    row, column = (axis / size for axis, size in zip(_middles(shape), shape, strict=True))
    return np.asarray(down * row + right * column + level)


def _middles(shape: tuple[int, ...]) -> FloatArray:
    return np.mgrid[0 : shape[0], 0 : shape[1]] + 0.5


def _drawn(heights: FloatArray, known: BoolArray) -> FloatArray:
    """Draw a smooth surface through the known heights: means of ever larger blocks fill the rest.

    References
    ----------
    Gortler et al., "The lumigraph", 1996 (pull and push).
    """
    if known.all() or not known.any():
        return heights
    total, weight = np.where(known, heights, 0.0), known.astype(float)
    levels = [(total, weight)]
    while (weight == 0).any():
        total, weight = _halved(total), _halved(weight)
        levels.append((total, weight))
    drawn = total / weight
    for total, weight in reversed(levels[:-1]):
        wide = _doubled(drawn, total.shape)
        drawn = np.where(weight > 0, total / np.maximum(weight, 1.0), wide)
    return np.asarray(drawn)


def _halved(values: FloatArray) -> FloatArray:
    """Add up blocks of 2 x 2."""
    rows, columns = values.shape
    even = np.pad(values, ((0, rows % 2), (0, columns % 2)))
    return np.asarray(even[::2, ::2] + even[1::2, ::2] + even[::2, 1::2] + even[1::2, 1::2])


def _doubled(values: FloatArray, shape: tuple[int, ...]) -> FloatArray:
    """Draw a grid twice as fine, evenly between the middles of its cells."""
    from scipy import ndimage

    rows, columns = np.arange(shape[0]) / 2 - 0.25, np.arange(shape[1]) / 2 - 0.25
    place = np.meshgrid(rows, columns, indexing="ij")
    return np.asarray(ndimage.map_coordinates(values, place, order=1, mode="nearest"))


def unevenness(heights: FloatArray) -> FloatArray:
    """Return how far the heights around each cell lie from a plane, (rows, columns) metres.

    The deviation of the residuals of the plane that fits 3 x 3 cells best.
    """
    from scipy import ndimage

    near = np.ones((3, 3)) / 9
    down, right = np.mgrid[-1:2, -1:2]
    middle = heights.mean()
    z = heights - middle  # squares of heights above the sea lose digits
    mean = ndimage.correlate(z, near, mode="nearest")
    slope = [ndimage.correlate(z, axis / 6.0, mode="nearest") for axis in (right, down)]
    square = ndimage.correlate(z * z, near, mode="nearest")
    rest = square - mean**2 - (slope[0] ** 2 + slope[1] ** 2) * 6 / 9
    return np.asarray(np.sqrt(np.maximum(rest, 0.0)))


def bends(heights: FloatArray) -> FloatArray:
    """Return how far each cell lies off the mean of its four neighbours, (rows, columns) metres."""
    z = np.pad(heights, 1, mode="edge")
    around = (z[:-2, 1:-1] + z[2:, 1:-1] + z[1:-1, :-2] + z[1:-1, 2:]) / 4
    return np.asarray(np.abs(heights - around))


def tell_apart(above: FloatArray, cell: float) -> tuple[BoolArray, BoolArray]:
    """Separate houses from trees by how even their tops are.

    Parameters
    ----------
    above
        (rows, columns) metres above the ground.
    cell
        Metres between cells.

    Returns
    -------
    houses, trees
        (rows, columns) bool, nowhere both.
    """
    from scipy import ndimage

    raised = above > HIGH
    around = np.ones((3, 3), bool)
    inner = ndimage.binary_erosion(raised, around, border_value=1)
    even = inner & (unevenness(above) < EVEN)
    roof = opened(ndimage.binary_dilation(even, around) & raised, 1.0)
    roof = without_specks(roof, LEAST_ROOF / cell**2)
    # Walls and edges of roofs are uneven; they are one cell wide.
    house = ndimage.binary_dilation(roof, around) & raised
    house = without_holes(house, LEAST_YARD / cell**2)
    house = without_specks(house, LEAST_HOUSE / cell**2)
    return house, raised & ~house


def opened(mask: BoolArray, radius: float) -> BoolArray:
    """Open a mask by a disc, radius in cells; it goes on beyond the border."""
    from scipy import ndimage

    edge = int(radius) + 1
    wide = np.pad(mask, edge, mode="edge")
    if wide.all():
        return mask
    core = ndimage.distance_transform_edt(wide) > radius
    if not core.any():
        return np.zeros_like(mask)
    open_ = ndimage.distance_transform_edt(~core) <= radius
    return np.asarray(open_[edge:-edge, edge:-edge] & mask)


def split_at_steps(houses: BoolArray, above: FloatArray, cell: float) -> NDArray[np.int64]:
    """Return the number of the roof that each cell belongs to, (rows, columns), 0 outside houses.

    Roofs end where the height steps; those too small for a house of their own belong to the
    nearest one of their body.
    """
    number = np.where(houses, np.cumsum(houses.ravel()).reshape(houses.shape) - 1, -1)
    pairs = []
    for first, second in ((np.s_[:, :-1], np.s_[:, 1:]), (np.s_[:-1], np.s_[1:])):
        near = houses[first] & houses[second]
        near &= np.abs(above[first] - above[second]) < STEP
        pairs.append(np.column_stack([number[first][near], number[second][near]]))
    group = components(np.concatenate(pairs), int(houses.sum()))
    roofs = np.zeros(houses.shape, np.int64)
    roofs[houses] = group + 1
    whole, _ = label_patches(houses)
    return _absorbed(roofs, whole, LEAST_PART / cell**2)


def _absorbed(
    roofs: NDArray[np.int64], bodies: NDArray[np.int32], least: float
) -> NDArray[np.int64]:
    """Give small roofs to the nearest large one of their body; a body of small ones is one."""
    from scipy import ndimage

    size = np.bincount(roofs.ravel())
    large = (size[roofs] >= least) & (roofs > 0)
    kept = np.where(large, roofs, 0)
    for index, box in enumerate(ndimage.find_objects(bodies), start=1):
        mine, view = bodies[box] == index, kept[box]
        if not (mine & (view > 0)).any():
            view[mine] = roofs[box][mine].min()
            continue
        row, column = ndimage.distance_transform_edt(
            ~(mine & (view > 0)), return_distances=False, return_indices=True
        )
        view[mine] = view[row, column][mine]
    return kept


def street_ground(houses: BoolArray, above: FloatArray, cell: float) -> BoolArray:
    """Find the ground that streets take: the gaps between blocks, and the rims of open places.

    Yards that no gap joins to the border of the grid are none; nor is the way round a lone house.
    """
    from scipy import ndimage

    if not houses.any():
        return np.zeros_like(houses)
    free = opened(above < OPEN, NARROW / cell)
    free = without_holes(_joined_to_border(free), LEAST_BLOCK / cell**2)
    far = ndimage.distance_transform_edt(~np.pad(houses, 1, mode="edge"))[1:-1, 1:-1] * cell
    middle = opened(free & (far > FRONT), BROAD / cell)
    middle = without_specks(middle, LEAST_PLACE / cell**2)
    ground = opened(free & ~middle, NARROW / cell)
    return without_specks(ground, LEAST_STREETS / cell**2)


def _joined_to_border(mask: BoolArray) -> BoolArray:
    patches, _ = label_patches(mask)
    border = np.unique(np.concatenate([patches[0], patches[-1], patches[:, 0], patches[:, -1]]))
    return np.asarray(np.isin(patches, border[border > 0]))
