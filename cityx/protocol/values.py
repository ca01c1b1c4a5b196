"""The values that ports carry where neither the city nor Python has a type for them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cityx.geometry.noise import gradient_noise

if TYPE_CHECKING:
    from shapely import Polygon


class LinearColor(NamedTuple):
    """Linear red, green and blue, each 0 to 1."""

    red: float
    green: float
    blue: float


@dataclass(frozen=True)
class Points:
    """n positions.

    Attributes
    ----------
    position
        (n, 3) float64, scene frame, metres.
    kind
        (n,) str, what is there ("building", "tree", ...), "" when unknown.
    group
        (n,) int64, points of one group belong to one path; 0 when there is none.
    """

    position: NDArray[np.float64]
    kind: NDArray[np.str_]
    group: NDArray[np.int64]

    @property
    def count(self) -> int:
        """Number of points."""
        return len(self.position)


@dataclass(frozen=True)
class Lines:
    """n polylines.

    Attributes
    ----------
    geometry
        (n,) object, shapely LineStrings, scene frame, metres.
    kind
        (n,) str, what runs there ("residential", "fence", ...).
    width
        (n,) float64, metres; NaN when unknown.
    object_id
        (n,) uint64, the object the line belongs to; 0 for none.
    """

    geometry: NDArray[np.object_]
    kind: NDArray[np.str_]
    width: NDArray[np.float64]
    object_id: NDArray[np.uint64]

    @property
    def count(self) -> int:
        """Number of lines."""
        return len(self.geometry)


@dataclass(frozen=True)
class Surfaces:
    """n flat polygons.

    Attributes
    ----------
    geometry
        (n,) object, shapely Polygons, scene frame, metres.
    kind
        (n,) str, what they are ("building", "park", "residential", ...).
    height
        (n,) float64, metres to raise them by; NaN when unknown.
    object_id
        (n,) uint64, the object the polygon belongs to; 0 for none.
    """

    geometry: NDArray[np.object_]
    kind: NDArray[np.str_]
    height: NDArray[np.float64]
    object_id: NDArray[np.uint64]

    @property
    def count(self) -> int:
        """Number of polygons."""
        return len(self.geometry)


@dataclass(frozen=True)
class Boxes:
    """n upright boxes.

    Attributes
    ----------
    base
        (n, 3) float64, centre of the lower face, metres.
    size
        (n, 3) float64, length along the heading, width, height, metres.
    heading
        (n,) float64, compass radians of the length.
    kind
        (n,) str.
    object_id
        (n,) uint64; 0 for none.
    """

    base: NDArray[np.float64]
    size: NDArray[np.float64]
    heading: NDArray[np.float64]
    kind: NDArray[np.str_]
    object_id: NDArray[np.uint64]

    @property
    def count(self) -> int:
        """Number of boxes."""
        return len(self.base)


@dataclass(frozen=True)
class Image:
    """Pixels on the ground.

    Attributes
    ----------
    pixels
        (h, w, c) float64, 0 to 1, row 0 is north; colour images are linear.
    pixel_size
        Metres.
    origin
        (x, y) of the south-west corner of the image, metres.
    classes
        Colour to class of a semantic map, each colour linear; empty for other images.
    """

    pixels: NDArray[np.float64]
    pixel_size: float = 1.0
    origin: tuple[float, float] = (0.0, 0.0)
    classes: tuple[tuple[LinearColor, str], ...] = ()

    def labels(self, tolerance: float) -> NDArray[np.uint8]:
        """Return the (h, w) index of the class nearest in colour; `len(classes)` where none is.

        Parameters
        ----------
        tolerance
            Greatest distance of a pixel's colour from the colour of its class.
        """
        rows, columns = self.pixels.shape[:2]
        colors = np.broadcast_to(self.pixels[:, :, :3], (rows, columns, 3))
        least = np.full((rows, columns), np.nextafter(tolerance, np.inf))
        labels = np.full((rows, columns), len(self.classes), np.uint8)
        for index, (color, _) in enumerate(self.classes):  # one pass per class keeps memory small
            distance = np.linalg.norm(colors - np.array(color), axis=2)
            closer = distance < least
            labels[closer], least[closer] = index, distance[closer]
        return labels


@dataclass(frozen=True)
class GeographicData:
    """n features in longitude and latitude.

    Attributes
    ----------
    geometry
        (n,) object, shapely points, lines and polygons, WGS84 degrees.
    tags
        n mappings of attributes, OpenStreetMap's words.
    source
        n texts such as "osm/way/123".
    attribution
        Text that must be shown with the data.
    """

    geometry: NDArray[np.object_]
    tags: tuple[Mapping[str, str], ...]
    source: tuple[str, ...]
    attribution: str = ""


@dataclass(frozen=True)
class NoiseFunction:
    """A smooth random function of the plane, -1 to 1, keyed by a seed.

    Attributes
    ----------
    seed
        The seed.
    scale
        Metres of the largest waves.
    octaves
        Number of layers, each of half the waves and half the height of the one before.
    """

    seed: int
    scale: float = 100.0
    octaves: int = 4

    def __call__(self, points: ArrayLike) -> NDArray[np.float64]:
        """Evaluate at (n, 2) points; returns (n,) values between -1 and 1."""
        points = np.asarray(points, dtype=float).reshape(-1, 2) / self.scale
        return gradient_noise(self.seed, points, octaves=self.octaves)


@dataclass(frozen=True)
class Footprint:
    """The outline one building is raised on.

    Attributes
    ----------
    ring
        (k, 2) float64, outer ring, counter-clockwise, last point not repeated, metres.
    holes
        Courtyards, rings like the outer one but clockwise.
    object_id
        The building.
    height
        Metres the input says, NaN when it says nothing.
    levels
        Storeys the input says, 0 when it says nothing.
    """

    ring: NDArray[np.float64]
    holes: tuple[NDArray[np.float64], ...] = ()
    object_id: int = 0
    height: float = float("nan")
    levels: int = 0

    @cached_property
    def polygon(self) -> Polygon:
        """The outline as a shapely polygon."""
        from shapely import Polygon

        return Polygon(self.ring, list(self.holes))


def make_points(
    position: ArrayLike, kind: str | Sequence[str] = "", group: ArrayLike = 0
) -> Points:
    """Make points from (n, 2) or (n, 3) positions; kind and group broadcast."""
    place = np.asarray(position, dtype=np.float64)
    place = place.reshape(-1, place.shape[-1] if place.ndim > 1 else 3)
    if place.shape[1] == 2:
        place = np.column_stack([place, np.zeros(len(place))])
    size = len(place)
    return Points(place, _words(kind, size), _filled(group, size, np.int64))


def make_lines(
    geometry: Any,
    kind: str | Sequence[str] = "",
    width: ArrayLike = np.nan,
    object_id: ArrayLike = 0,
) -> Lines:
    """Make lines from shapely LineStrings; the other columns broadcast."""
    shapes = np.asarray(geometry, dtype=object).reshape(-1)
    size = len(shapes)
    return Lines(
        shapes,
        _words(kind, size),
        _filled(width, size, np.float64),
        _filled(object_id, size, np.uint64),
    )


def make_surfaces(
    geometry: Any,
    kind: str | Sequence[str] = "",
    height: ArrayLike = np.nan,
    object_id: ArrayLike = 0,
) -> Surfaces:
    """Make surfaces from shapely Polygons; the other columns broadcast."""
    shapes = np.asarray(geometry, dtype=object).reshape(-1)
    size = len(shapes)
    return Surfaces(
        shapes,
        _words(kind, size),
        _filled(height, size, np.float64),
        _filled(object_id, size, np.uint64),
    )


def make_boxes(
    base: ArrayLike,
    size: ArrayLike,
    heading: ArrayLike = 0.0,
    kind: str | Sequence[str] = "",
    object_id: ArrayLike = 0,
) -> Boxes:
    """Make boxes from (n, 3) base centres; the other columns broadcast."""
    place = np.asarray(base, dtype=np.float64).reshape(-1, 3)
    count = len(place)
    return Boxes(
        place,
        np.broadcast_to(np.asarray(size, np.float64), (count, 3)).copy(),
        _filled(heading, count, np.float64),
        _words(kind, count),
        _filled(object_id, count, np.uint64),
    )


def _filled(values: ArrayLike, size: int, dtype: Any) -> Any:
    return np.broadcast_to(np.asarray(values, dtype), (size,)).copy()


def _words(values: Any, size: int) -> NDArray[np.str_]:
    return np.broadcast_to(np.asarray(values, dtype=np.str_), (size,)).copy()
