"""Semantic maps as a source: an image whose colours are classes becomes a city."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cityx.city import City, Frame
from cityx.city.frame import NOWHERE
from cityx.errors import InputError
from cityx.geometry.raster.grid import Grid
from cityx.geometry.raster.patches import label_patches
from cityx.sources.class_map import (
    EXACT,
    PLAUSIBLE,
    ClassMap,
    check_asked,
    city_of,
    features_of,
    rows_of_houses,
)
from cityx.sources.georeference import laid_on_ground
from cityx.sources.input_kinds import place_name
from cityx.sources.map_classes import MapClass, Role, class_of
from cityx.sources.semantic_map.legends import Legend, find_legend, labelled, match
from cityx.sources.semantic_map.picture import Picture, estimated_pixel, read_picture
from cityx.sources.semantic_map.proposal import best_reading, chosen_legend

__all__ = ["read_class_map", "read_semantic_map"]

DOUBT = 0.9  # share of pixels that a legend given by the caller explains without a doubt


def read_semantic_map(
    path: Path,
    *,
    legend: str | Path | None = None,
    pixel: float | None = None,
    at: tuple[float, float] | None = None,
    confirm: bool = False,
    fidelity: str = EXACT,
    seed: int = 0,
    name: str = "",
    place: str = "",
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
    fidelity
        "exact" for the houses that the map shows, "plausible" to cut whole rows into houses.
    seed
        Key of every draw for what the map does not say.
    name
        Of the place; the file's own name by default.
    place
        Profile of the place that the user asked for, as of `cityx.city.frame.Frame`.

    Raises
    ------
    InputError
        If the file cannot be read, its colours are of no known legend, or it shows no city.
    UsageError
        If there is no such legend.
    """
    path = Path(path)
    check_asked(fidelity, pixel)
    found, frame, notes = read_class_map(path, legend=legend, pixel=pixel, at=at, confirm=confirm)
    return city_of(
        found,
        replace(frame, place=place),
        source="semantic",
        name=name or place_name(path.name),
        seed=seed,
        notes=(*notes, *_rows_note(found, fidelity)),
        draw=partial(features_of, fidelity=fidelity),
    )


def read_class_map(
    path: Path,
    *,
    legend: str | Path | None = None,
    pixel: float | None = None,
    at: tuple[float, float] | None = None,
    confirm: bool = False,
) -> tuple[ClassMap, Frame, tuple[str, ...]]:
    """Read what lies at each pixel of a semantic map.

    Parameters
    ----------
    path, legend, pixel, at, confirm
        As of `read_semantic_map`.

    Returns
    -------
    found
        The classes of its pixels.
    frame
        Where on Earth they lie.
    notes
        What a reader of the report should know.

    Raises
    ------
    InputError, UsageError
        As of `read_semantic_map`.
    """
    picture = read_picture(path)
    chosen, notes = _legend(path, picture, legend, confirm=confirm)
    found, frame, more = _placed(picture, chosen, pixel, at)
    doubt = (f"semantic map: {picture.doubt}",) if picture.doubt else ()
    return found, frame, (*notes, *more, *doubt)


def _void_notes(
    labels: NDArray[np.uint8], classes: tuple[MapClass, ...], picture: Picture
) -> Iterator[str]:
    """Say how much of a map says nothing, and what becomes of it."""
    strange = (labels == len(classes) - 1) & ~picture.void
    if strange.any():
        yield f"semantic map: {100 * float(strange.mean()):.2g} % of the pixels are of no class"
    void = np.array([item.role is Role.VOID for item in classes], bool)[labels]
    if void.any():
        yield (
            f"semantic map: {100 * float(void.mean()):.2g} % of the pixels say nothing "
            "(transparent, no data, unlabelled or of no class) and are left as void, without ground"
        )


def _rows_note(found: ClassMap, fidelity: str) -> tuple[str, ...]:
    labels, _ = label_patches(found.mask(Role.BUILDING))
    rows = len(rows_of_houses(labels, found.grid.pixel))
    if not rows:
        return ()
    done = "are cut into houses" if fidelity == PLAUSIBLE else "are drawn as one house each"
    return (
        f"semantic map: {rows} patches of buildings are rows rather than houses and {done} "
        "(--fidelity plausible cuts them)",
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
    picture: Picture, legend: Legend, pixel: float | None, at: tuple[float, float] | None
) -> tuple[ClassMap, Frame, tuple[str, ...]]:
    """Lay the classes on the ground."""
    labels = labelled(picture, legend)
    unknown = len(legend.entries)
    classes = (*(entry.meaning for entry in legend.entries), class_of("void"))
    notes = list(_void_notes(labels, classes, picture))
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
            return bare, NOWHERE, ()  # no city; whoever draws it says so
        pixel, why = estimated_pixel(bare, picture)
        notes.append(f"semantic map: {why}")
    grid = Grid.about_origin(rows, columns, pixel)
    return ClassMap(labels, classes, grid), Frame(*at) if at else NOWHERE, tuple(notes)
