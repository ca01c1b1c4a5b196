"""Pictures: image files as arrays, with what they say of colours and of their place on Earth."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.errors import InputError
from cityx.geometry.arrays import BoolArray, IntArray
from cityx.geometry.raster.centrelines import centrelines
from cityx.geometry.raster.patches import label_patches, without_specks
from cityx.sources.class_map import COARSEST, FINEST, LEAST_PIXELS, ClassMap, uncovered
from cityx.sources.georeference import georeference_of
from cityx.sources.map_classes import Role

MOST_PIXELS = 64_000_000  # 8,000 x 8,000; a city of 4 km at 0.5 m, within 4 GB of memory
LEAST_SIDE = 8  # pixels; a smaller picture shows no street
MANY = 1 << 24  # colours of eight bits
CLIPPED = 2.0  # percent of the values of a photograph that are shown as black, and as white
OPAQUE = 128  # alpha from which a pixel says something
_LOSSY = frozenset({"JPEG", "WEBP", "MPO"})
USUAL_STREET = 7.0  # metres from kerb to kerb, the median by length over the maps of many cities
USUAL_HOUSE = 150.0  # square metres, the median outline
USUAL_CAR = 8.0  # square metres, as seen from above
FEW = 12  # houses or widths of street from which a median says something
LEAST_CLUES = 2  # kinds of thing that must agree; of one alone nobody knows how usual it is here
AGREEING = 2 / 3  # share of all clues that must agree
APART = 1.25  # times that clues may differ and agree
SPECK = 30  # pixels


@dataclass(frozen=True)
class Picture:
    """The pixels of a file.

    Attributes
    ----------
    values
        (rows, columns) int, one value per pixel, or None for a picture of true colours.
    colors
        (rows, columns, 3) uint8, sRGB; grey where the file has one value per pixel.
    void
        (rows, columns) bool, pixels that say nothing: transparent, or the value for no data.
    lossy
        Whether colours of neighbours bled into each other (JPEG).
    crs, transform
        Coordinate system and affine transform (a, b, c, d, e, f) from (column, row) to it, or None;
        a transform alone places nothing.
    doubt
        What is wrong with a georeference that is not used, or "".
    """

    values: IntArray | None
    colors: NDArray[np.uint8]
    void: NDArray[np.bool_]
    lossy: bool = False
    crs: Any = None
    transform: tuple[float, ...] | None = None
    doubt: str = ""

    def distinct(self, *, by_value: bool) -> tuple[IntArray, IntArray]:
        """Return the (n,) distinct values, or colours 0xRRGGBB, and each pixel's index of them."""
        return self._distinct_values if by_value and self.values is not None else self._distinct

    @cached_property
    def _distinct(self) -> tuple[IntArray, IntArray]:
        return _distinct(packed(self.colors))

    @cached_property
    def _distinct_values(self) -> tuple[IntArray, IntArray]:
        return _distinct(self.values)

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        return self.colors.shape[0], self.colors.shape[1]


def packed(colors: NDArray[np.uint8]) -> IntArray:
    """Return 0xRRGGBB of (..., 3) colours."""
    wide = colors.astype(np.int64)
    return np.asarray((wide[..., 0] << 16) | (wide[..., 1] << 8) | wide[..., 2])


def _distinct(plane: Any) -> tuple[IntArray, IntArray]:
    """Return distinct values and the index of each, by a table where values are small."""
    if int(plane.min()) < 0 or int(plane.max()) >= MANY:
        keys, index = np.unique(plane, return_inverse=True)
        return keys, index.reshape(plane.shape)
    present = np.zeros(MANY, bool)
    present[plane] = True
    keys = np.flatnonzero(present)
    place = np.zeros(MANY, np.int32)
    place[keys] = np.arange(len(keys))
    return keys, place[plane].astype(np.int64)


def read_picture(path: Path, *, photograph: bool = False) -> Picture:
    """Read an image file.

    Parameters
    ----------
    path
        PNG, TIFF or JPEG, or whatever else Pillow reads.
    photograph
        Whether values of more than eight bits are light, to be shown between the darkest and the
        brightest `CLIPPED` of them, instead of classes.

    Raises
    ------
    InputError
        If it cannot be read, has too many pixels or too few, or shows more than one picture.
    """
    path = Path(path)
    try:
        with path.open("rb") as file:
            head = file.read(4)
    except OSError as error:
        raise InputError(f"cannot read {path}: {error.strerror}.") from error
    tiff = head in (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+")
    picture = (_read_tiff if tiff else _read_image)(path, photograph)
    said = georeference_of(path)
    return replace(picture, crs=said.crs, transform=said.transform, doubt=said.doubt)


def _check_size(path: Path, columns: int, rows: int) -> None:
    if columns * rows > MOST_PIXELS:
        raise InputError(
            f"{path} has {columns:,} x {rows:,} pixels; at most {MOST_PIXELS:,} can be read at "
            "once. Cut it into tiles or make it coarser."
        )
    if min(columns, rows) < LEAST_SIDE:
        raise InputError(
            f"{path} has {columns} x {rows} pixels; a map of a city has {LEAST_SIDE} or more on "
            "each side."
        )


def _read_image(path: Path, photograph: bool) -> Picture:
    from PIL import Image, UnidentifiedImageError

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", Image.DecompressionBombWarning)
            with Image.open(path) as image:
                _check_size(path, *image.size)
                frames = int(getattr(image, "n_frames", 1))
                if frames > 1:
                    raise InputError(f"{path} is animated ({frames} pictures); give one picture.")
                image.load()
                return _from_pil(path, image, photograph)
    except Image.DecompressionBombError as error:
        raise InputError(
            f"{path} has more than {MOST_PIXELS:,} pixels, too many to be read at once. Cut it "
            "into tiles or make it coarser."
        ) from error
    except UnidentifiedImageError as error:
        raise InputError(f"{path} is no image: its content is of no known kind.") from error
    except (OSError, SyntaxError, ValueError, EOFError) as error:
        raise InputError(f"{path} is damaged or cut off: {str(error).rstrip('.')}.") from error


def _from_pil(path: Path, image: Any, photograph: bool) -> Picture:
    lossy = image.format in _LOSSY
    mode = image.mode
    void = np.zeros(image.size[::-1], bool)
    if "A" in mode or "transparency" in image.info:
        void = np.asarray(image.convert("RGBA"))[:, :, 3] < OPAQUE
    if mode == "1":
        values = np.asarray(image).astype(np.int64) * 255
    elif mode in ("L", "I;16", "I;16B", "I;16L", "I"):
        values = np.asarray(image).astype(np.int64)
    elif mode == "LA":
        values = np.asarray(image)[:, :, 0].astype(np.int64)
    elif mode in ("P", "PA", "RGB", "RGBA", "RGBX"):
        return Picture(None, np.asarray(image.convert("RGB")), void, lossy)
    else:
        raise InputError(
            f"{path} has colours of the kind {mode}; save it as RGB, grey or with a palette."
        )
    return Picture(values, _grey(values, void, photograph), void, lossy)


def _grey(values: NDArray[Any], void: NDArray[np.bool_], photograph: bool) -> NDArray[np.uint8]:
    """Show values as greys; more than eight bits are scaled."""
    if values.max(initial=0) > 255:
        values = _scaled(values, void, photograph)
    return np.repeat(np.clip(values, 0, 255).astype(np.uint8)[:, :, None], 3, axis=2)


def _scaled(bands: NDArray[Any], void: NDArray[np.bool_], photograph: bool) -> NDArray[np.uint8]:
    """Show values of any range in eight bits."""
    low, high = 0.0, float(np.nanmax(bands))
    if photograph and not void.all():
        low, high = np.nanpercentile(bands[..., ~void], (CLIPPED, 100 - CLIPPED))
    shown = (np.nan_to_num(bands) - low) * (255.0 / ((high - low) or 1.0))
    return np.clip(shown, 0, 255).astype(np.uint8)


def _read_tiff(path: Path, photograph: bool) -> Picture:
    import rasterio
    from rasterio.errors import NotGeoreferencedWarning, RasterioError

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", NotGeoreferencedWarning)
            with rasterio.open(path) as dataset:
                _check_size(path, dataset.width, dataset.height)
                return _from_dataset(path, dataset, photograph)
    except RasterioError as error:
        raise InputError(f"{path} is damaged or cut off: {str(error).rstrip('.')}.") from error


def _from_dataset(path: Path, dataset: Any, photograph: bool) -> Picture:
    from rasterio.enums import ColorInterp

    bands = dataset.read()
    if dataset.colorinterp[0] is ColorInterp.cyan:
        raise InputError(f"{path} has CMYK colours; save it as RGB, grey or with a palette.")
    if np.issubdtype(bands.dtype, np.complexfloating):
        raise InputError(f"{path} has complex values; a map has classes or colours.")
    void = ~np.all(dataset.dataset_mask(), axis=0, keepdims=False) if bands.ndim == 4 else (
        dataset.dataset_mask() == 0
    )  # fmt: skip
    lossy = "jpeg" in str(dataset.compression).lower()
    if dataset.count in (1, 2):
        values, void = _whole(path, bands[0], void)
        palette = _palette(dataset)
        if palette is not None:
            colors = palette[np.clip(values, 0, len(palette) - 1)]
            return Picture(None, colors, void, lossy)
        return Picture(values, _grey(values, void, photograph), void, lossy)
    colors = bands[:3]
    if colors.dtype != np.uint8:
        colors = _scaled(colors, void, photograph)
    return Picture(None, np.moveaxis(colors, 0, 2), void, lossy)


def _whole(
    path: Path, band: NDArray[Any], void: NDArray[np.bool_]
) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """Return values as whole numbers; what is no number says nothing."""
    finite = np.isfinite(band)
    if not finite.any():
        raise InputError(f"{path} holds no number at all (NaN everywhere).")
    return np.where(finite, np.rint(np.where(finite, band, 0)), 0).astype(np.int64), void | ~finite


def _palette(dataset: Any) -> NDArray[np.uint8] | None:
    try:
        table = dataset.colormap(1)
    except ValueError:
        return None
    palette = np.zeros((max(table) + 1, 3), np.uint8)
    for index, color in table.items():
        palette[index] = color[:3]
    return palette


@dataclass(frozen=True)
class Clue:
    """What one kind of thing on a map says of the metres of a pixel.

    Attributes
    ----------
    says
        What was measured, and what it is taken for: "its streets are 14 pixels wide in the median,
        taken for 7 m".
    pixel
        Metres.
    """

    says: str
    pixel: float


def estimated_pixel(found: ClassMap, picture: Picture | None = None) -> tuple[float, str]:
    """Estimate the metres of a pixel from things whose usual size is known, where they agree.

    Parameters
    ----------
    found
        The map, with any grid.
    picture
        Where it is from, with pixels of the same size; what its file says of its place without
        naming a coordinate system is one clue more.

    Returns
    -------
    pixel
        Metres, rounded to two digits.
    evidence
        A sentence.

    Raises
    ------
    InputError
        As a question, if fewer than `LEAST_CLUES` things or less than `AGREEING` of them agree; or
        if the map shows too little to tell.
    """
    ground = uncovered(found)
    shown = (_street(ground), _house(ground), _car(found))
    clues = [*_declared(picture), *(clue for clue in shown if clue is not None)]
    if not clues:
        raise InputError(
            "The map does not say how large its pixels are, and shows too few streets and houses "
            "to estimate it; give the metres of a pixel: --pixel 0.5."
        )
    agreed = _agreed(clues)
    if len(agreed) < max(LEAST_CLUES, AGREEING * len(clues)):
        raise InputError(_question(clues))
    pixel = _rounded(float(np.exp(np.mean([np.log(clue.pixel) for clue in agreed]))))
    return pixel, f"a pixel is taken for {pixel:g} m: {', '.join(clue.says for clue in agreed)}"


def _agreed(clues: list[Clue]) -> list[Clue]:
    """Return the largest group of clues of which no two are farther apart than `APART`."""
    ordered = sorted(clues, key=lambda clue: clue.pixel)
    groups = [
        [clue for clue in ordered[first:] if clue.pixel <= APART * ordered[first].pixel]
        for first in range(len(ordered))
    ]
    return max(groups, key=len)


def _question(clues: list[Clue]) -> str:
    """Ask for the metres of a pixel, with what each clue would make of them."""
    told = "; ".join(f"{clue.says}, would make it {clue.pixel:.2g} m" for clue in clues)
    why = "does not agree" if len(clues) > 1 else "is too little to tell by"
    tries = " or ".join(dict.fromkeys(f"--pixel {_rounded(clue.pixel):g}" for clue in clues))
    return (
        f"How many metres is a pixel? The map does not say, and what it shows {why}: {told}. Give "
        f"the metres of a pixel: {tries}, or what is right."
    )


def _rounded(pixel: float) -> float:
    return float(f"{np.clip(pixel, FINEST, COARSEST):.2g}")


def _declared(picture: Picture | None) -> list[Clue]:
    """Return what a transform without a coordinate system says, as if it were of metres."""
    if picture is None or picture.crs is not None or picture.transform is None:
        return []
    a, b, _, d, e, _ = picture.transform
    pixel = float(np.sqrt(abs(a * e - b * d)))
    if not FINEST <= pixel <= COARSEST:
        return []
    return [Clue(f"its file says {pixel:.3g} units per pixel, taken for metres", pixel)]


def _street(found: ClassMap) -> Clue | None:
    """Tell the scale by the median width of streets by length."""
    mask = ~without_specks(~without_specks(found.mask(Role.ROAD), SPECK), SPECK)
    ways = centrelines(mask, tolerance=1.0)
    length = shapely.length(ways.lines)
    if len(length) == 0:
        return None
    order = np.argsort(ways.width)
    total = np.cumsum(length[order])
    width = float(ways.width[order][np.searchsorted(total, total[-1] / 2)])
    if not total[-1] > FEW * width > 0:
        return None
    return Clue(
        f"its streets are {width:.1f} pixels wide in the median, taken for {USUAL_STREET:g} m",
        USUAL_STREET / width,
    )


def _house(found: ClassMap) -> Clue | None:
    """Tell the scale by the median size of houses."""
    return _sized(found.mask(Role.BUILDING), "houses", USUAL_HOUSE, SPECK / 2)


def _car(found: ClassMap) -> Clue | None:
    """Tell the scale by the median size of cars."""
    cars = np.array([item.word == "car" for item in found.classes], bool)[found.labels]
    return _sized(cars, "cars", USUAL_CAR, LEAST_PIXELS)


def _sized(mask: BoolArray, name: str, usual: float, speck: float) -> Clue | None:
    """Tell the scale by things of a usual size, square metres; None where there are few."""
    labels, count = label_patches(without_specks(mask, speck))
    if count < FEW:
        return None
    size = float(np.median(np.bincount(labels.ravel())[1:]))
    return Clue(
        f"its {name} take {size:.0f} pixels in the median, taken for {usual:g} m²",
        float(np.sqrt(usual / size)),
    )
