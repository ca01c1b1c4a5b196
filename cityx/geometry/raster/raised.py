"""What stands on the ground of a height grid: houses, trees, and the streets left between them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cityx.geometry.chains import components
from cityx.geometry.raster.patches import label_patches, without_holes, without_specks
from cityx.geometry.raster.relief import unevenness

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

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
