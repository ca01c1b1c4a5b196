"""Walkable area: pavements, paths, plazas and crosswalks, without obstacles.

The area is known twice: as polygons, and as a raster whose free cells lie wholly on it and at least
half a body away from whatever is solid. A place in a free cell is therefore never off the area, nor
in a wall; routes and crowds need to ask the raster alone.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from cityx.city.city import City
from cityx.city.ground import ROADWAY, Ground
from cityx.city.mesh import NO_VERTEX, MeshBatch
from cityx.city.thing_outlines import FURNITURE, placed_outlines
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.polylines import Polylines, to_linestrings
from cityx.geometry.raster.grid import Grid
from cityx.ground.walking.crosswalks import FOOTWAYS, VERGES, Crosswalks, crosswalks_of
from cityx.system.remembered import Remembered

BODY = 0.23  # metres from the middle of a person to the shoulders (Fruin's ellipse: 0.46 m wide)
CELL = 0.2  # metres of a cell of the raster
VERGE = 1.8  # metres of land beside a roadway that people walk on where there is no pavement
PAVED = 0.5  # metres from a pavement within which nobody walks on the land beside it
NARROW = 1.6  # metres of a pavement beside which people step onto the edge of the roadway
SHOULDER = 1.0  # metres of that edge that they walk on
DUST = 0.1  # square metres of a narrow piece of pavement at least
DRIVEN = 1.45  # metres on both sides of the middle of a lane, and a way across a junction, that
# vehicles take up: half a lorry, and a little
MOST_CELLS = 150_000_000  # of a raster: 6 km2, some 2 GB while it is made
SOLID = (*FURNITURE, "trees", "vehicles")  # layers of the scene that stand in the way
WALLS = ("barriers", "structures", "guard_rails")  # layers of meshes that do
FARTHEST = 12.0  # metres of clearance that are told apart
CROSSES = 0.5  # square metres of roadway that a crosswalk covers at least, or shares at most


@dataclass(frozen=True)
class Walkable:
    """The walkable area of a city.

    Attributes
    ----------
    areas
        (a,) polygons, pavements and paths with the crosswalks that join them.
    crosswalks
        Where people cross.
    grid
        Where the cells of the rasters lie.
    free
        (rows, columns) bool, cells in which the middle of a person may be.
    clearance
        (rows, columns) float16, metres from a cell to the next that is not free, 12 at most.
    crosswalk
        (rows, columns) int16, number from 1 of the crosswalk on a roadway, 0 elsewhere.
    rim
        (rows, columns) int16, the same of all cells that it reaches into.
    verge
        (rows, columns) bool, land beside a roadway, and its edges beside narrow pavements, taken
        where nothing better leads on.
    waits
        (crosswalks,) float64, seconds that people wait before each, which ways go round.
    """

    areas: NDArray[Any]
    crosswalks: Crosswalks
    grid: Grid
    free: BoolArray
    clearance: NDArray[np.float16]
    crosswalk: NDArray[np.int16]
    rim: NDArray[np.int16]
    verge: BoolArray
    waits: FloatArray

    @cached_property
    def area(self) -> float:
        """Square metres."""
        return float(shapely.area(self.areas).sum())

    @cached_property
    def room(self) -> float:
        """Square metres in which the middle of a person may be."""
        return float(self.free.sum()) * CELL * CELL

    def holds(self, xy: ArrayLike) -> BoolArray:
        """Return which of (n, 2) places are free."""
        return np.asarray(self.at(self.free, xy))

    def index(self, xy: ArrayLike) -> IntArray:
        """Return (n,) places in the flat rasters of (n, 2) metres; on the empty rim beyond them."""
        spots = np.asarray(xy, float).reshape(-1, 2)
        rows, columns = self.free.shape
        column = np.floor((spots[:, 0] - self.grid.west) * (1.0 / CELL))
        row = np.floor((self.grid.north - spots[:, 1]) * (1.0 / CELL))
        row, column = np.clip(row, 0, rows - 1), np.clip(column, 0, columns - 1)
        return np.asarray(row * columns + column).astype(np.int64)

    def at(self, raster: NDArray[Any], xy: ArrayLike) -> NDArray[Any]:
        """Return (n,) values of a raster at (n, 2) places, 0 beyond it."""
        return np.asarray(raster.ravel()[self.index(xy)])

    def places(self, cell: NDArray[Any]) -> FloatArray:
        """Return (n, 2) metres of the middles of (n, 2) cells, row and column."""
        return self.grid.to_metres(np.asarray(cell)[:, ::-1] + 0.5)

    @cached_property
    def _free_cells(self) -> tuple[FloatArray, Any]:
        from scipy.spatial import cKDTree

        places = self.places(np.argwhere(self.free & (self.crosswalk == 0)))
        return places, cKDTree(places) if len(places) else None

    def snapped(self, xy: ArrayLike, most: float) -> tuple[FloatArray, BoolArray]:
        """Move (n, 2) places to the nearest free ones off the roadway.

        Parameters
        ----------
        xy
            (n, 2) float, metres.
        most
            Metres beyond which a place is given up.

        Returns
        -------
        moved, found
            (n, 2) places, and (n,) whether there was one near enough; the others stay.
        """
        spots = np.asarray(xy, float).reshape(-1, 2)
        places, tree = self._free_cells
        if tree is None or not len(spots):
            return spots.copy(), np.zeros(len(spots), bool)
        far, row = tree.query(spots, distance_upper_bound=most)
        found = np.isfinite(far)
        moved = spots.copy()
        kept = self.holds(spots) & (self.at(self.crosswalk, spots) == 0)
        moved[found] = places[row[found]]
        return np.where(kept[:, None], spots, moved), found | kept


_LAST: Remembered[Walkable] = Remembered()


def walkable_of(city: City) -> Walkable:
    """Return the walkable area of a city; that of the last one is remembered.

    Parameters
    ----------
    city
        City with ground and road network.

    Raises
    ------
    ValueError
        If the ground is not laid.
    """
    ground, network = city.ground, city.network
    if ground is None or network is None:
        raise ValueError("the ground is not laid yet")
    scene = city.scene
    parts: list[Any] = [ground, network, *_lanes_of(city)]
    parts += [scene.instances[name] for name in SOLID if name in scene.instances]
    parts += [scene.meshes[name] for name in WALLS if name in scene.meshes]
    return _LAST.get(lambda: _made(city, ground), parts)


@dataclass(frozen=True)
class WalkAreas:
    """The walkable area as polygons alone, for sites of any size.

    Attributes
    ----------
    areas
        (a,) polygons, with the crosswalks.
    crosswalks
        Where people cross.
    over
        (c,) what each crosswalk covers of the roadway.
    verge
        Land beside roadways, and edges of them, that are part of it.
    """

    areas: NDArray[Any]
    crosswalks: Crosswalks
    over: NDArray[Any]
    verge: Any


_LAST_AREAS: Remembered[WalkAreas] = Remembered()


def walk_areas(city: City) -> WalkAreas:
    """Return the walkable area of a city with ground and network; the last one is remembered."""
    parts = [city.ground, city.network, city.layout, *_lanes_of(city)]
    return _LAST_AREAS.get(lambda: _areas(city), parts)


def _lanes_of(city: City) -> list[Any]:
    return [] if city.lanes is None else [city.lanes]


def _areas(city: City) -> WalkAreas:
    assert city.network is not None
    assert city.ground is not None
    crosswalks = crosswalks_of(city.ground, city.layout, city.network)
    walks, road = _polygon(city.ground, FOOTWAYS), _polygon(city.ground, ROADWAY)
    beside = _verges(city.ground, road, walks), _shoulders(city, road, walks)
    verge = shapely.union_all(np.concatenate([*map(_surfaces, beside)]), grid_size=0.001)
    crosswalks, over = _parted(crosswalks, shapely.intersection(crosswalks.regions(), road))
    whole = shapely.union_all([walks, verge, *over], grid_size=0.001)
    whole = shapely.intersection(whole, shapely.box(*city.layout.extent))
    return WalkAreas(_surfaces(whole), crosswalks, over, verge)


def _made(city: City, ground: Ground) -> Walkable:
    grid = _grid_over(city.layout.extent)
    area = walk_areas(city)
    site = shapely.buffer(shapely.box(*city.layout.extent), 2 * CELL, join_style="mitre")
    rest = shapely.difference(site, shapely.multipolygons(area.areas))
    free = ~grid.touched(shapely.get_parts(rest)) & ~grid.touched(_solids(city, ground))
    number, rim = (
        grid.numbered(area.over, touched=wide).astype(np.int16) for wide in (False, True)
    )
    beside = grid.touched(shapely.get_parts(area.verge))
    for raster in (free, number, rim, beside):  # what lies beyond is looked up on the rim
        raster[[0, -1]] = raster[:, [0, -1]] = 0
    waits = np.zeros(area.crosswalks.count)
    return Walkable(area.areas, area.crosswalks, grid, free, clearance_of(free), number, rim,
                    beside, waits)  # fmt: skip


def _grid_over(extent: tuple[float, float, float, float]) -> Grid:
    west, south, east, north = extent
    # Cells lie on whole multiples, whatever the site.
    west, north = CELL * np.floor(west / CELL), CELL * np.ceil(north / CELL)
    rows, columns = int(np.ceil((north - south) / CELL)), int(np.ceil((east - west) / CELL))
    if rows * columns > MOST_CELLS:
        size = rows * columns * CELL * CELL / 1e6
        most = MOST_CELLS * CELL * CELL / 1e6
        raise ValueError(
            f"a site of {size:.1f} km2 is too large to walk in; {most:.0f} km2 are not "
            "(a part is built by: cityx build MAP --at LAT,LON --size WxH)"
        )
    return Grid(rows, columns, CELL, float(west), float(north))


def _polygon(ground: Ground, names: tuple[str, ...]) -> Any:
    """Return what faces of some surfaces cover."""
    triangles = ground.triangles_of(*names)
    return shapely.coverage_union_all(shapely.polygons(ground.vertices[triangles]))


def _verges(ground: Ground, road: Any, walks: Any) -> Any:
    """Return the land along roadways, apart from where there is a pavement."""
    strip = shapely.buffer(road, VERGE, quad_segs=2)
    found = shapely.intersection(_polygon(ground, VERGES), strip, grid_size=0.001)
    found = shapely.multipolygons(_surfaces(found))
    # A strip behind a pavement leads nowhere; where one ends they must still touch.
    paved = shapely.buffer(shapely.buffer(walks, PAVED + VERGE, quad_segs=2), -VERGE, quad_segs=2)
    return shapely.union_all([
        shapely.difference(found, paved, grid_size=0.001),
        shapely.intersection(found, shapely.difference(paved, shapely.buffer(paved, -2 * PAVED)),
                             grid_size=0.001),
    ])  # fmt: skip


def _shoulders(city: City, road: Any, walks: Any) -> Any:
    """Return the edges of roadways beside narrow pavements on which nothing drives."""
    graph = city.lanes
    if graph is None or not graph.count:
        return shapely.Polygon()
    half = NARROW / 2
    inner = shapely.buffer(walks, -half, join_style="mitre")
    wide = shapely.buffer(inner, half, join_style="mitre")
    narrow = shapely.get_parts(shapely.difference(walks, wide, grid_size=0.001))
    narrow = narrow[shapely.area(narrow) > DUST]  # not what rounding leaves of corners
    near = shapely.union_all(shapely.buffer(narrow, SHOULDER, quad_segs=2))
    driven = graph.travelled
    lines = np.concatenate([
        to_linestrings(graph.lines)[driven],
        to_linestrings(Polylines(graph.curve, graph.curve_start))[
            driven[graph.connection].all(axis=1)
        ],
    ])  # fmt: skip
    taken = shapely.union_all(shapely.buffer(lines, DRIVEN, quad_segs=4))
    edges = _surfaces(shapely.intersection(road, near, grid_size=0.001))
    return shapely.difference(shapely.multipolygons(edges), taken, grid_size=0.001)


def _surfaces(shape: Any) -> NDArray[Any]:
    """Return the polygons among the parts of a shape."""
    parts = shapely.get_parts(shape)
    return np.asarray(parts[shapely.get_type_id(parts) == shapely.GeometryType.POLYGON])


def _parted(crosswalks: Crosswalks, over: NDArray[Any]) -> tuple[Crosswalks, NDArray[Any]]:
    """Return the crosswalks that cross something, and what each alone covers of the roadway.

    Where two lie on one another one would step from one onto the other amid the roadway, and not
    know whose signal counts. What a path alone tells gives way to what is better known, and a
    crosswalk that is guessed to a path; those of two arms that meet at a corner share it out.
    """
    kept = shapely.area(over) > CROSSES
    crosswalks, over = crosswalks.take(kept), np.asarray(over[kept], object)
    path = crosswalks.edge < 0
    rank = np.lexsort((crosswalks.id, -crosswalks.standing))
    crosswalks, over, path = crosswalks.take(rank), over[rank], path[rank]
    kept = np.ones(len(over), bool)
    pairs = np.sort(shapely.STRtree(over).query(over, predicate="intersects"), axis=0)
    for one, other in np.unique(pairs, axis=1).T.tolist():
        if one == other or not kept[one] or not kept[other]:
            continue
        common = shapely.area(shapely.intersection(over[one], over[other]))
        if common > CROSSES and (path[one] or path[other]):
            kept[other] = False
        elif common > 0:
            over[other] = shapely.difference(over[other], over[one], grid_size=0.001)
    back = np.argsort(rank)
    rows = back[kept[back]]  # in the order in which they were
    return crosswalks.take(rows), over[rows]


def _solids(city: City, ground: Ground) -> NDArray[Any]:
    """(k,) polygons within half a body of something solid."""
    built = shapely.polygons(ground.vertices[ground.triangles_of("building", "void", "water")])
    outlines = placed_outlines(city.scene, SOLID)[0]
    walls = [_traces(city.scene.meshes[name]) for name in WALLS if name in city.scene.meshes]
    return np.asarray(
        shapely.buffer(np.concatenate([built, outlines, *walls]), BODY, quad_segs=3), object
    )


def _traces(batch: MeshBatch) -> NDArray[Any]:
    """(f,) what the faces of walls cover seen from above."""
    corners = batch.faces.copy()
    triangle = corners[:, 3] == NO_VERTEX
    corners[triangle, 3] = corners[triangle, 2]
    flat = batch.vertices[corners][:, :, :2]
    return np.asarray(shapely.convex_hull(shapely.multipoints(
        flat.reshape(-1, 2), indices=np.repeat(np.arange(len(flat)), 4))), object)  # fmt: skip


def clearance_of(
    free: BoolArray, wanted: BoolArray | None = None, most: float = FARTHEST
) -> NDArray[np.float16]:
    """(rows, columns) metres from each cell to the next that is not free.

    Parameters
    ----------
    free
        (rows, columns) bool, in cells of `CELL`.
    wanted
        Cells that are measured, the others have 0; None for all.
    most
        Metres that are told apart.
    """
    from cityx.geometry.raster.distances import squares_to_closed

    reach = int(np.ceil(most / CELL))
    square = squares_to_closed(free, free if wanted is None else wanted, reach)
    metres = np.minimum(np.sqrt(np.arange(reach**2 + 1)) * CELL, most).astype(np.float16)
    return np.asarray(metres[square], np.float16)
