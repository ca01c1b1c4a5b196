"""Satellite and aerial images as a source: a picture from above becomes a city."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cityx.city import City, Frame
from cityx.city.frame import NOWHERE
from cityx.errors import InputError, MissingDependency
from cityx.geometry.raster.grid import Grid
from cityx.geometry.raster.patches import label_patches
from cityx.geometry.raster.regions import filled
from cityx.sources.class_map import EXACT, PLAUSIBLE, ClassMap, check_asked, city_of, features_of
from cityx.sources.features.tagged import Tagged
from cityx.sources.georeference import ground_of, laid_on_ground
from cityx.sources.input_kinds import place_name
from cityx.sources.map_classes import MapClass, Role, class_of
from cityx.sources.satellite.painted import painted_segmenter
from cityx.sources.satellite.plausible import plausible_features
from cityx.sources.satellite.segmented import SURE, Segmented, segment, unlearned_segmenter
from cityx.sources.satellite.segmenter import Segmenter, load_segmenter, shipped_segmenter
from cityx.sources.semantic_map.picture import MOST_PIXELS, Picture, estimated_pixel, read_picture

__all__ = ["read_satellite"]

WITHOUT = "none"  # the word for a segmenter without learning
UNSURE = 0.5  # confidence below which a pixel is said to be doubtful
GROSS = 1.6  # metres of a pixel, relative to what a segmenter knows, from which doubt is said
PALE = 110.0  # of 255, light of bare ground from which it is sand rather than soil
RUDDY = 0.35  # of that light, red over blue from which it is soil all the same
NARROW = 12.0  # metres across of water; what is dark and narrower is a shadow
LEAST_SHOWN = 0.002  # share of an image that is surely street or house, if it shows a city
CLOSE = 1.25  # the same, below which an image is not segmented again at another scale


def read_satellite(
    path: Path,
    *,
    pixel: float | None = None,
    at: tuple[float, float] | None = None,
    segmenter: str | Path | None = None,
    fidelity: str = EXACT,
    flips: bool = True,
    seed: int = 0,
    name: str = "",
    place: str = "",
) -> City:
    """Segment an image from above into a city whose layout is complete.

    Parameters
    ----------
    path
        PNG, JPEG or TIFF: RGB, panchromatic, with or without alpha, 8 or 16 bits.
    pixel
        Metres of a pixel; by default what the georeference says, else an estimate.
    at
        (latitude, longitude) of the middle, degrees, for an image without a georeference.
    segmenter
        An ONNX file that keeps the contract of `cityx.sources.satellite.segmenter`, "none" for
        colour and texture alone, or None for the network that comes with CityX, and for the
        colours themselves where the image is painted rather than photographed.
    fidelity
        "exact" for every outline as it was segmented, "plausible" for streets that are connected
        and blocks that are built up as densely as the image shows.
    flips
        Whether every part is also looked at mirrored, which is surer and takes longer.
    seed
        Key of every draw for what the image does not say.
    name
        Of the place; the file's own name by default.
    place
        Profile of the place that the user asked for, as of `cityx.city.frame.Frame`.

    Raises
    ------
    InputError
        If the file cannot be read, the segmenter keeps no contract, or the image shows no city.
    UsageError
        If there is no such fidelity.
    MissingDependency
        If onnxruntime is absent and a network of the user's own is asked for.
    """
    path = Path(path)
    check_asked(fidelity, pixel)
    picture = read_picture(path, photograph=True)
    chosen, notes = _chosen(segmenter, picture)
    seen = _seen(picture, chosen, pixel, flips=flips)
    _check_shown(path, seen.what, chosen)
    found, frame = _placed(picture, seen, chosen, at)
    found = _without_shadows(found)
    doubts = (f"satellite: {picture.doubt}",) if picture.doubt else ()
    return city_of(
        found,
        replace(frame, place=place),
        source="satellite",
        name=name or place_name(path.name),
        seed=seed,
        notes=(*notes, *seen.notes, *doubts, _doubt(seen.what, picture, chosen)),
        draw=_drawing(fidelity, seed),
    )


@dataclass(frozen=True)
class _Seen:
    """A segmented image.

    Attributes
    ----------
    what
        Its classes and confidence, at the resolution of the segmenter.
    pixel
        Metres of its pixels, or None where nothing in it tells.
    notes
        What a reader of the report should know.
    """

    what: Segmented
    pixel: float | None
    notes: tuple[str, ...]


def _chosen(said: str | Path | None, picture: Picture) -> tuple[Segmenter, tuple[str, ...]]:
    """Return a segmenter, and what is to be said of the choice."""
    if said is None:
        painted = painted_segmenter(picture)
        if painted is not None:
            return painted, ()
        try:
            return shipped_segmenter(), ()
        except MissingDependency as error:
            return unlearned_segmenter(), (f"satellite: segmented without learning: {error}",)
    if said == WITHOUT:
        return unlearned_segmenter(), ()
    return load_segmenter(Path(said)), ()


def _drawing(fidelity: str, seed: int) -> Callable[[ClassMap, str], Tagged]:
    return partial(plausible_features, seed=seed) if fidelity == PLAUSIBLE else features_of


def _seen(picture: Picture, segmenter: Segmenter, pixel: float | None, *, flips: bool) -> _Seen:
    """Segment a picture at the ground resolution that the segmenter knows best.

    A picture that does not say its resolution is taken for one of the segmenter's own; streets and
    houses found so tell a better one, at which it is segmented again.
    """
    known, notes = _told_pixel(picture, pixel)
    own = segmenter.pixel
    if known is not None:
        what = _segmented(picture, segmenter, known / own if own else 1.0, flips=flips)
        if own and not own / GROSS < known < own * GROSS:
            notes += (
                f"satellite: the segmenter knows pixels of {own:g} m best; the image has "
                f"{known:.3g} m",
            )
        return _Seen(what, known, notes)
    what = _segmented(picture, segmenter, 1.0, flips=flips)
    guess, why = _estimated(what, segmenter)
    if guess is None:
        return _Seen(what, None, ())
    if own and not own / CLOSE < guess < own * CLOSE:
        what = _segmented(picture, segmenter, guess / own, flips=flips)
    return _Seen(what, guess, (f"satellite: {why}",))


def _told_pixel(picture: Picture, said: float | None) -> tuple[float | None, tuple[str, ...]]:
    """Return the metres of a pixel that a georeference or the caller says."""
    if picture.crs is None or picture.transform is None:
        return said, ()
    grid, _ = ground_of(picture.shape, picture.crs, picture.transform)
    if said is None:
        return grid.pixel, ()
    return grid.pixel, (
        f"satellite: the georeference says {grid.pixel:.3g} m per pixel, which is taken instead "
        f"of the {said:g} m given",
    )


def _segmented(picture: Picture, segmenter: Segmenter, scale: float, *, flips: bool) -> Segmented:
    """Segment a picture enlarged by a factor."""
    from PIL import Image

    rows, columns = picture.shape
    size = max(1, round(columns * scale)), max(1, round(rows * scale))
    if size[0] * size[1] > MOST_PIXELS:
        raise InputError(
            f"The image has {size[0]:,} x {size[1]:,} pixels of {segmenter.pixel:g} m, as the "
            f"segmenter sees it; at most {MOST_PIXELS:,} can be read at once. Cut it into tiles."
        )
    colors = picture.colors
    if size != (columns, rows):
        how = Image.Resampling.BOX if scale < 1 else Image.Resampling.BILINEAR
        colors = np.asarray(Image.fromarray(colors).resize(size, how))
    return segment(colors, segmenter, flips=flips)


def _estimated(what: Segmented, segmenter: Segmenter) -> tuple[float | None, str]:
    """Estimate the metres of a pixel from streets and houses; None where there are none."""
    rows, columns = what.labels.shape
    grid = Grid.about_origin(rows, columns, 1.0)
    found = ClassMap(what.labels, segmenter.classes, grid)
    return estimated_pixel(found) if found.mask(Role.ROAD, Role.BUILDING).any() else (None, "")


def _check_shown(path: Path, what: Segmented, segmenter: Segmenter) -> None:
    """Refuse what is no picture of a city."""
    wanted = [item.role in (Role.ROAD, Role.BUILDING) for item in segmenter.classes]
    shown = np.array(wanted)[what.labels] & (what.confidence >= UNSURE * SURE)
    if shown.mean() < LEAST_SHOWN:
        raise InputError(
            f"{path} shows no city: {100 * shown.mean():.2g} % of it is surely street or house "
            f"(by {segmenter.name}). Is it an image from straight above?"
        )


def _doubt(what: Segmented, picture: Picture, segmenter: Segmenter) -> str:
    """Say who segmented, and how sure that is."""
    sure = what.confidence[~_void_of(picture, what)] / SURE
    return (
        f"satellite: segmented by {segmenter.name}; mean confidence {sure.mean():.2f}, "
        f"{100 * (sure < UNSURE).mean():.0f} % of the pixels below {UNSURE:g}"
    )


def _without_shadows(found: ClassMap) -> ClassMap:
    """Take dark strips and spots too narrow for a river or pond for what lies around them."""
    from skimage.morphology import isotropic_opening

    kept = isotropic_opening(found.mask_of("water"), NARROW / 2 / found.grid.pixel)
    shadows = found.mask_of("water") & ~_touched(found.mask_of("water"), kept)
    return replace(found, labels=filled(found.labels, shadows))


def _touched(mask: NDArray[np.bool_], marked: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return the patches of a mask that hold a marked pixel."""
    patches, count = label_patches(mask)
    held = np.bincount(patches.ravel(), marked.ravel(), minlength=count + 1) > 0
    held[0] = False
    return np.asarray(held[patches])


def _void_of(picture: Picture, what: Segmented) -> NDArray[np.bool_]:
    """Return the pixels of a segmented image of which the picture says nothing."""
    return np.asarray(picture.void[_nearest(picture, what)])


def _nearest(picture: Picture, what: Segmented) -> tuple[NDArray[np.int64], ...]:
    """Return the pixel of a picture at each pixel of the segmented image."""
    rows, columns = what.labels.shape
    row = np.arange(rows) * picture.shape[0] // rows
    column = np.arange(columns) * picture.shape[1] // columns
    return np.ix_(row, column)


def _earthed(picture: Picture, what: Segmented, segmenter: Segmenter) -> tuple[MapClass, ...]:
    """Return the classes of a segmenter, bare ground being sand where the picture shows it pale."""
    bare = np.array([item.word == "bare" for item in segmenter.classes])[what.labels]
    if not bare.any():
        return segmenter.classes
    red, _, blue = color = np.median(picture.colors[_nearest(picture, what)][bare], axis=0)
    pale = color.mean() > PALE and red - blue < RUDDY * color.mean()
    return tuple(
        class_of("sand") if pale and item.word == "bare" else item for item in segmenter.classes
    )


def _placed(
    picture: Picture, seen: _Seen, segmenter: Segmenter, at: tuple[float, float] | None
) -> tuple[ClassMap, Frame]:
    """Lay what was seen on the ground."""
    void = len(segmenter.classes)
    labels = np.where(_void_of(picture, seen.what), np.uint8(void), seen.what.labels)
    classes = (*_earthed(picture, seen.what, segmenter), class_of("unknown"))
    rows, columns = labels.shape
    if picture.crs is not None and picture.transform is not None:
        wide, high = picture.shape[1] / columns, picture.shape[0] / rows
        a, b, c, d, e, f = picture.transform
        transform = (a * wide, b * high, c, d * wide, e * high, f)
        labels, grid, frame = laid_on_ground(labels, picture.crs, transform, void=void)
        return ClassMap(labels, classes, grid), frame
    pixel = (seen.pixel or 1.0) * picture.shape[1] / columns
    grid = Grid.about_origin(rows, columns, pixel)
    return ClassMap(labels, classes, grid), Frame(*at) if at else NOWHERE
