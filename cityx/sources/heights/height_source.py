"""Height files as a source: the terrain of any city, and a city where they show houses."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import shapely

from cityx.city import City, Frame, Layout
from cityx.city.frame import NOWHERE
from cityx.city.sites import Box
from cityx.city.terrain import Survey, Terrain
from cityx.errors import InputError
from cityx.geometry.arrays import FloatArray
from cityx.geometry.raster.grid import Grid
from cityx.geometry.raster.relief import ground_below
from cityx.sources.features.gather import gather
from cityx.sources.features.resolve import resolve
from cityx.sources.features.tagged import KIND, Owner, Report, tag
from cityx.sources.heights.height_field import filled_voids, land_of, survey_files, void_notes
from cityx.sources.heights.height_files import Cells, HeightFile, HeightOptions
from cityx.sources.heights.height_kinds import HeightKind, Shows, cell_size, kind_of
from cityx.sources.heights.height_mosaic import (
    Raster,
    corners,
    laid,
    open_heights,
    raster_of,
    strays_of,
    without,
)  # fmt: skip
from cityx.sources.heights.shores import shapes_of
from cityx.sources.heights.surface_model import features_above, find_standing
from cityx.sources.input_kinds import place_name

FINEST = 0.5  # metres; finer cells say nothing more of houses
LARGEST = 6000.0  # metres of a side of a site whose houses are drawn at once
MAX_CELLS = 25_000_000  # of its grid
TOWN = 10_000.0  # metres from its middle that a town reaches at most
SMALLEST = 80.0  # metres; a smaller site holds no street
SIDE = 17  # points on each border of a file at which its place is computed


@dataclass(frozen=True)
class Heights:
    """The height files of one site, open, and what they show.

    Attributes
    ----------
    files, kinds
        One kind for each file.
    options
        What the caller says of them.
    """

    files: tuple[HeightFile, ...]
    kinds: tuple[HeightKind, ...]
    options: HeightOptions

    def showing(self, *words: Shows) -> list[HeightFile]:
        """Return the files that show one of some things."""
        pairs = zip(self.files, self.kinds, strict=True)
        return [file for file, kind in pairs if kind.shows in words]

    @property
    def has_houses(self) -> bool:
        """Whether a city can be made of them alone."""
        return bool(self.showing(Shows.SURFACE, Shows.ABOVE))

    @property
    def has_ground(self) -> bool:
        """Whether they say how the ground lies."""
        return bool(self.showing(Shows.TERRAIN, Shows.SURFACE))

    @property
    def located(self) -> bool:
        """Whether they say where on Earth they lie."""
        return all(file.located for file in self.files)

    @property
    def notes(self) -> tuple[str, ...]:
        """What a reader of the report should know of the files."""
        found = []
        for file, kind in zip(self.files, self.kinds, strict=True):
            datum = f"vertical datum {file.datum}" if file.datum else "its vertical datum unnamed"
            place = "" if file.located else "; it does not say where it lies"
            found.append(
                f"heights: {file.path.name} is taken for {kind.shows} ({kind.evidence}), "
                f"{datum}{place}"
            )
        return tuple(found)


def read_heights(paths: Path | Sequence[Path], options: HeightOptions | None = None) -> Heights:
    """Open the height files of one site and find what they show.

    Raises
    ------
    InputError, UsageError
        With every fault, if a file cannot be read.
    """
    options = options or HeightOptions()
    files = open_heights(paths, options)
    return Heights(tuple(files), tuple(kind_of(file, options.pixel) for file in files), options)


def place_of(heights: Heights, at: tuple[float, float] | None = None) -> tuple[Frame, Box]:
    """Return the frame about the middle of some height files, and the rectangle that all fill.

    Files side by side that show the same count as one. Those that do not say where they lie are
    laid about `at`, or about a place in the middle of Europe, with the metres of a cell that the
    options give, else 1 m.

    Raises
    ------
    InputError
        If they lie apart or nowhere.
    """
    files = heights.showing(Shows.SURFACE, Shows.ABOVE) or list(heights.files)
    if not heights.located:
        frame = Frame(*at) if at else NOWHERE
        return frame, _own_box(files[0], heights.options.pixel)
    lonlat = np.concatenate([corners(file) for file in files])
    if not np.isfinite(lonlat).all() or (np.abs(lonlat) > (360.0, 90.0)).any():
        names = ", ".join(str(file.path) for file in files)
        raise InputError(f"{names} lies nowhere on Earth by its coordinate system.")
    low, high = lonlat.min(axis=0), lonlat.max(axis=0)
    middle = np.round((low + high) / 2, 6) + 0.0
    frame = Frame(float(middle[1]), float(middle[0]))
    boxes = np.array([_inner_box(file, frame) for file in files])
    if all(kind.shows is Shows.TERRAIN for kind in heights.kinds):
        return frame, (*boxes[:, :2].min(axis=0).tolist(), *boxes[:, 2:].max(axis=0).tolist())
    box = (*boxes[:, :2].max(axis=0).tolist(), *boxes[:, 2:].min(axis=0).tolist())
    if box[0] >= box[2] or box[1] >= box[3]:
        raise InputError(
            f"{', '.join(str(file.path) for file in files)} lie apart; give files of one place."
        )
    return frame, box


def _own_box(file: HeightFile, pixel: float | None) -> Box:
    size = pixel or cell_size(file)
    rows, columns = file.shape
    return -columns * size / 2, -rows * size / 2, columns * size / 2, rows * size / 2


def _inner_box(file: HeightFile, frame: Frame) -> Box:
    """Return the largest upright rectangle within the borders of a file, nearly."""
    from pyproj import Transformer

    assert file.to_cell is not None
    rows, columns = file.shape
    step = np.linspace(-0.5, 0.5, SIDE)
    along = [(step + 0.5) * columns - 0.5, (step + 0.5) * rows - 0.5]
    whole = Raster(np.zeros((0, 0)), file.to_cell, file.crs)
    change = Transformer.from_crs(file.crs, frame.projection, always_xy=True)
    sides = []
    for column, row in (
        (np.full(SIDE, -0.5), along[1]), (np.full(SIDE, columns - 0.5), along[1]),
        (along[0], np.full(SIDE, -0.5)), (along[0], np.full(SIDE, rows - 0.5)),
    ):  # fmt: skip
        sides.append(np.column_stack(change.transform(*whole.places(column, row))))
    sides.sort(key=lambda points: float(points[:, 0].mean()))
    west, east = sides[0][:, 0].max(), sides[-1][:, 0].min()
    sides.sort(key=lambda points: float(points[:, 1].mean()))
    south, north = sides[0][:, 1].max(), sides[-1][:, 1].min()
    return float(west), float(south), float(east), float(north)


def lay_terrain(
    city: City, heights: Heights, *, cell: float | None = None, datum: float | None = None
) -> City:
    """Lay the terrain of height files under a city.

    Where they show only a surface, the ground is found below its houses and trees; heights above
    the ground say nothing of it.

    Parameters
    ----------
    city
        With a layout.
    heights
        Of its place.
    cell, datum
        As of `cityx.sources.heights.height_field.read_height`; tiles of one city share both.

    Returns
    -------
    city
        With terrain, survey and notes.

    Raises
    ------
    InputError
        If the files do not cover the site.
    """
    files = _ground_files(heights)
    if not files:
        note = "heights: no file says how the ground lies; it is level"
        return replace(city, notes=(*city.notes, *heights.notes, note))
    files = [laid(file, city.frame, city.layout.extent, heights.options) for file in files]
    areas = city.layout.areas
    taken = areas[areas["kind"].isin(("sea", "void")).to_numpy()].geometry.to_numpy()
    out = shapely.union_all(taken)
    terrain, survey = survey_files(
        files, city.frame, city.layout.extent, out, cell=cell, datum=datum
    )
    fit = (*void_notes(files, city.frame, city.layout.extent, out), *_odd_notes(terrain, survey))
    notes = (*city.notes, *heights.notes, *_placing_notes(heights), *fit)
    return replace(city, terrain=terrain, survey=survey, notes=notes)


def land_before(city: City, heights: Heights) -> City:
    """Give a city without a layout what height files say of the land that a town is to be laid on.

    Returns
    -------
    city
        With a survey of the land within `TOWN` of its middle, and the sea and wide voids on it as
        areas.
    """
    xmin, ymin, xmax, ymax = city.layout.extent
    box = (max(xmin, -TOWN), max(ymin, -TOWN), min(xmax, TOWN), min(ymax, TOWN))
    files = [laid(file, city.frame, box, heights.options) for file in _ground_files(heights)]
    if not files or box[0] >= box[2] or box[1] >= box[3]:
        return city
    raster = raster_of(files, city.frame, box)
    if np.isnan(raster.values).all():
        return city
    rows = [(shape, kind) for shape, kind in shapes_of(raster, city.frame, box) if shape.area]
    owners = [Owner(("heights", kind, k), {KIND: kind}) for k, (_, kind) in enumerate(rows)]
    features = gather(tag([shape for shape, _ in rows], owners), box, Report())
    areas = resolve(features, city.frame, seed=city.seed).areas
    survey = Survey(np.zeros((0, 3)), land_of(raster, city.frame, box), 0.0)
    return replace(city, layout=Layout(city.layout.extent, areas=areas), survey=survey)


def _placing_notes(heights: Heights) -> tuple[str, ...]:
    if heights.located:
        return ()
    pixel = heights.options.pixel
    how = f"with cells of {pixel:g} m, its middle on that of the site" if pixel else "over the site"
    return (f"heights: a file that does not say where it lies was laid {how}",)


def _odd_notes(terrain: Terrain, survey: Survey) -> tuple[str, ...]:
    """Say what is odd about the heights of a site; the fit is that of the ground once it stands."""
    if len(survey.points) == 0:
        return ("heights: no cell of the files lies on the site",)
    return ("heights: every height is the same",) if terrain.is_flat else ()


def _ground_files(heights: Heights) -> list[HeightFile]:
    """Return the files that say how the ground lies."""
    ground = heights.showing(Shows.TERRAIN)
    return ground or [_bare(file) for file in heights.showing(Shows.SURFACE)]


def _bare(file: HeightFile) -> HeightFile:
    """Return a surface without what stands on it."""
    cell = cell_size(file)

    def load(cells: Cells, stride: int) -> FloatArray:
        # In numbers of the file: the filter knows metres, so they are converted there and back.
        heights = file.read(cells, stride)
        heights = without(heights, strays_of(heights))
        void = np.isnan(heights)
        if void.all():
            return heights
        ground = ground_below(filled_voids(heights), cell * stride)
        return np.where(void, np.nan, (ground - file.zero) / file.unit)

    return replace(file, load=load, whole=False)


def height_city(
    heights: Heights, *, seed: int = 0, name: str = "", at: tuple[float, float] | None = None,
    place: str = "",
) -> City:  # fmt: skip
    """Make a city from height files that show houses.

    Parameters
    ----------
    heights
        Among them a surface or heights above the ground; a file of the ground makes them exact.
    seed
        Key of every draw for what the files do not say.
    name
        Of the place; the file's own name by default.
    at
        (latitude, longitude) of files that do not say where they lie.
    place
        Profile of the place that the user asked for, as of `cityx.city.frame.Frame`.

    Returns
    -------
    city
        With layout, terrain and survey.

    Raises
    ------
    InputError
        If the files show no house, or more than can be read at once.
    """
    if not heights.has_houses:
        why = "; ".join(heights.notes)
        raise InputError(
            f"No height file shows a house ({why}). Give a surface model, a map of the place, or "
            "lay a town on the terrain."
        )
    frame, box = place_of(heights, at)
    frame = replace(frame, place=place)
    grid = _grid(heights, box)
    placing = _placing_notes(heights)
    heights = replace(
        heights, files=tuple(laid(file, frame, box, heights.options) for file in heights.files)
    )
    above, how = height_above(heights, frame, grid)
    canopy = heights.showing(Shows.CANOPY)
    crowns = filled_voids(on_grid(canopy, frame, grid)) if canopy else None
    report = Report()
    features = gather(features_above(find_standing(above, grid, crowns)), grid.extent, report)
    if len(features.shells.outlines.shapes) == 0:
        raise InputError(
            f"{', '.join(str(file.path) for file in heights.files)} shows no house: nothing with "
            "an even top stands on its ground."
        )
    counts = tuple(f"heights: {number} {what}" for what, number in sorted(report.counts.items()))
    city = City(
        name or place_name(heights.files[0].path.name),
        frame,
        resolve(features, frame, seed=seed),
        seed=seed,
        stages_done=frozenset({"layout"}),
        notes=(*placing, how, *_drawn_note(features.shells.outlines.tags()), *counts),
    )
    return lay_terrain(city, heights)


def _drawn_note(tags: list[dict[str, str]]) -> tuple[str, ...]:
    """Count what was measured."""
    shapes = [own.get("roof:shape", "") for own in tags]
    told = ", ".join(
        f"{shapes.count(word)} {word or 'not clear'}" for word in ("flat", "gabled", "hipped", "")
    )
    return (
        f"heights: {len(tags)} houses with measured heights; roofs: {told}",
        "heights: streets follow the middles of the gaps between blocks; their widths are guesses",
    )


def _grid(heights: Heights, box: Box) -> Grid:
    """Return the cells of a site, as fine as its files."""
    files = heights.showing(Shows.SURFACE, Shows.ABOVE)
    pixel = heights.options.pixel if not heights.located else None
    pixel = max(pixel or min(cell_size(file) for file in files), FINEST)
    width, depth = box[2] - box[0], box[3] - box[1]
    if max(width, depth) > LARGEST or width * depth / pixel**2 > MAX_CELLS:
        raise InputError(
            f"The height files reach over {width:,.0f} x {depth:,.0f} m with cells of {pixel:g} m; "
            f"houses are drawn on {LARGEST:,.0f} m and {MAX_CELLS:,} cells at most. Cut a smaller "
            "piece out of them, such as with gdal_translate -projwin."
        )
    if min(width, depth) < SMALLEST:
        raise InputError(
            f"The height files reach over {width:.0f} x {depth:.0f} m; a site measures at least "
            f"{SMALLEST:.0f} m."
        )
    columns, rows = int(width / pixel + 1e-6), int(depth / pixel + 1e-6)
    return Grid(rows, columns, pixel, box[0], box[3])


def on_grid(files: Sequence[HeightFile], frame: Frame, grid: Grid) -> FloatArray:
    """Return the heights of files at the middles of the cells of a grid, NaN beyond them.

    Each cell takes the height of the nearest one of the files, so that walls stay sharp.
    """
    raster = raster_of(files, frame, grid.extent)
    row, column = (axis.ravel() for axis in np.mgrid[0 : grid.rows, 0 : grid.columns])
    own = raster.at(frame, grid.to_metres(np.column_stack([column, row]) + 0.5))
    own_column, own_row = (np.rint(axis).astype(np.int64) for axis in own)
    rows, columns = raster.values.shape
    inside = (own_row >= 0) & (own_row < rows) & (own_column >= 0) & (own_column < columns)
    found = np.full(len(row), np.nan)
    found[inside] = raster.values[own_row[inside], own_column[inside]]
    return found.reshape(grid.rows, grid.columns)


def height_above(heights: Heights, frame: Frame, grid: Grid) -> tuple[FloatArray, str]:
    """Return heights above the ground on a grid, without voids, and how they were found.

    A surface and a ground that belong together are exact; else heights above the ground are taken
    as they are; else the ground is found below the surface.
    """
    surface, ground, above = (
        heights.showing(word) for word in (Shows.SURFACE, Shows.TERRAIN, Shows.ABOVE)
    )
    if surface and ground:
        tops = on_grid(surface, frame, grid)
        base = filled_voids(on_grid(ground, frame, grid))
        how = f"heights: of houses as {_names(surface)} lies above {_names(ground)}"
        return filled_voids(tops) - base, how
    if above:
        return (
            np.nan_to_num(on_grid(above, frame, grid)),
            f"heights: of houses as {_names(above)} says",
        )
    tops = filled_voids(on_grid(surface, frame, grid))
    return (
        tops - ground_below(tops, grid.pixel),
        f"heights: of houses as {_names(surface)} lies above the ground found below it",
    )


def _names(files: list[HeightFile]) -> str:
    return ", ".join(file.path.name for file in files)
