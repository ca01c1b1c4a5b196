"""Semantic maps as a source: an image whose colours are classes becomes a city."""

from __future__ import annotations

from pathlib import Path

from cityx.city import City, Frame
from cityx.errors import InputError
from cityx.geometry.raster.grid import Grid
from cityx.sources.class_map import ClassMap, city_of
from cityx.sources.georeference import laid_on_ground
from cityx.sources.map_classes import Role, class_of
from cityx.sources.semantic_map.evidence import best_reading, chosen_legend
from cityx.sources.semantic_map.legends import Legend, find_legend
from cityx.sources.semantic_map.matching import labelled, match
from cityx.sources.semantic_map.picture import Picture, read_picture
from cityx.sources.semantic_map.scale import COARSEST, FINEST, estimated_pixel

__all__ = ["read_semantic_map"]

# Where a map lies that does not say so: in the middle of Europe, for which most priors are made.
SOMEWHERE = (50.0, 8.0)
DOUBT = 0.9  # share of pixels that a legend given by the caller explains without a doubt


def read_semantic_map(
    path: Path,
    *,
    legend: str | Path | None = None,
    pixel: float | None = None,
    at: tuple[float, float] | None = None,
    confirm: bool = False,
    seed: int = 0,
    name: str = "",
) -> City:
    """Read a semantic map into a city whose layout is complete.

    Parameters
    ----------
    path
        PNG, TIFF or JPEG whose colours or values are classes.
    legend
        Name of a preset or a legend file (.json, .csv); found by evidence when None.
    pixel
        Metres of a pixel; by default what the georeference says, else an estimate.
    at
        (latitude, longitude) of the middle, degrees, for a map without a georeference.
    confirm
        Whether to take the classes that are proposed for unknown colours.
    seed
        Key of every draw for what the map does not say.
    name
        Of the place; the file's own name by default.

    Raises
    ------
    InputError
        If the file cannot be read, its colours are of no known legend, or it shows no city.
    UsageError
        If there is no such legend.
    """
    path = Path(path)
    if pixel is not None and not FINEST <= pixel <= COARSEST:
        raise InputError(
            f"A pixel of {pixel:g} m is of no use; a map of a city has {FINEST:g} to {COARSEST:g}."
        )
    picture = read_picture(path)
    chosen, notes = _legend(path, picture, legend, confirm=confirm)
    found, frame, more = _placed(picture, chosen, pixel, at)
    return city_of(
        found,
        frame,
        source="semantic",
        name=name or path.name.split(".")[0].replace("_", " "),
        seed=seed,
        notes=(*notes, *more),
    )


def nowhere(source: str) -> str:
    """Say what is taken for the place of a raster that does not tell it."""
    return (
        f"{source}: it does not say where on Earth it lies; sun, roofs and traffic are those of "
        f"{SOMEWHERE[0]:g}° north, {SOMEWHERE[1]:g}° east"
    )


def _legend(
    path: Path, picture: Picture, said: str | Path | None, *, confirm: bool
) -> tuple[Legend, tuple[str, ...]]:
    if said is None:
        return chosen_legend(path, picture, confirm=confirm)
    chosen = find_legend(said)
    measured = match(picture, chosen)
    if measured.seen == 0:
        raise InputError(
            f"{path} shows nothing of the legend {chosen.name}: {best_reading(picture)}."
        )
    notes = [f"semantic map: legend {measured.text()}"]
    if measured.share < DOUBT:
        notes.append(
            "semantic map: the legend leaves much of the map unexplained; is it the right one?"
        )
    return chosen, tuple(notes)


def _placed(
    picture: Picture,
    legend: Legend,
    pixel: float | None,
    at: tuple[float, float] | None,
) -> tuple[ClassMap, Frame, tuple[str, ...]]:
    """Lay the classes on the ground."""
    labels = labelled(picture, legend)
    unknown = len(legend.entries)
    classes = (*(entry.meaning for entry in legend.entries), class_of("unknown"))
    notes = []
    left = float(((labels == unknown) & ~picture.void).mean())
    if left > 0:
        notes.append(f"semantic map: {100 * left:.2g} % of the pixels are of no class")
    if picture.crs is not None and picture.transform is not None:
        labels, grid, frame = laid_on_ground(labels, picture.crs, picture.transform, void=unknown)
        if pixel is not None:
            notes.append(
                f"semantic map: the georeference says {grid.pixel:.3g} m per pixel, which is taken "
                f"instead of the {pixel:g} m given"
            )
        return ClassMap(labels, classes, grid), frame, tuple(notes)
    rows, columns = picture.shape
    if pixel is None:
        bare = ClassMap(labels, classes, Grid.about_origin(rows, columns, 1.0))
        if not bare.mask(Role.ROAD, Role.BUILDING).any():
            return bare, Frame(*SOMEWHERE), ()  # no city; whoever draws it says so
        pixel, why = estimated_pixel(bare)
        notes.append(f"semantic map: {why}")
    if at is None:
        notes.append(nowhere("semantic map"))
    grid = Grid.about_origin(rows, columns, pixel)
    return ClassMap(labels, classes, grid), Frame(*(at or SOMEWHERE)), tuple(notes)
