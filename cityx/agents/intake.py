"""Inputs become one city: each file is read by its source, and what they give is put together."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

from cityx.city import City, Frame, Layout
from cityx.city.frame import NOWHERE
from cityx.city.sites import Box, moved
from cityx.errors import UsageError
from cityx.sources.combination import combine
from cityx.sources.inputs import KINDS, Input, classify

# What a person drew goes before what a map says.
PRECEDENCE = ("drawn", "osm")


@dataclass(frozen=True)
class Inputs:
    """The files of a build, by what they are.

    Attributes
    ----------
    sources
        Files that give a layout, in the order of their precedence.
    heights
        The height file, or None.
    """

    sources: tuple[Input, ...]
    heights: Input | None

    @property
    def records(self) -> list[dict[str, object]]:
        """What the report says about the files."""
        every = (*self.sources, *([self.heights] if self.heights else []))
        return [item.record() for item in every]


def sort_inputs(paths: list[Path]) -> Inputs:
    """Tell what each file is.

    Raises
    ------
    InputError, UsageError
        If a file is of no use or the files do not make a city together.
    """
    items = [classify(path) for path in paths]
    heights = [item for item in items if item.kind == "height"]
    sources = [item for kind in PRECEDENCE for item in items if item.kind == kind]
    maps = sum(item.kind == "osm" for item in sources)
    if maps > 1 or len(heights) > 1:
        raise UsageError(
            f"Give at most one map and one height file, and any drawings ({KINDS}); given: "
            f"{maps} maps, {len(sources) - maps} drawings, {len(heights)} height files."
        )
    return Inputs(tuple(sources), heights[0] if heights else None)


@dataclass(frozen=True)
class Reading:
    """What one file gave, or several together.

    Attributes
    ----------
    name
        Of the file.
    city
        A city with a layout.
    located
        Whether the file says where on Earth it lies; if not, its frame is arbitrary.
    site
        The rectangle that the file wants built, frame of the city, or None for any.
    heights
        The height file of the site, or None.
    """

    name: str
    city: City
    located: bool
    site: Box | None
    heights: Input | None = None


def read_sources(inputs: Inputs, *, seed: int, at: tuple[float, float] | None = None) -> Reading:
    """Read every file that gives a layout and put them together; none gives an empty city.

    Parameters
    ----------
    at
        Latitude and longitude of files that do not say where they lie; without it they lie in the
        middle of those that do.

    Raises
    ------
    InputError
        If a file cannot be read, holds no city or lies elsewhere than the others.
    """
    if not inputs.sources:
        city = City("town", Frame(*at) if at else NOWHERE, Layout((0.0, 0.0, 0.0, 0.0)), seed=seed)
        return Reading("", city, located=False, site=None, heights=inputs.heights)
    readings = [_READERS[item.kind](item, seed) for item in inputs.sources]
    located = [reading.city.frame for reading in readings if reading.located]
    frame = located[-1] if located else Frame(*at) if at else NOWHERE
    placed = [_placed(reading, frame) for reading in readings]
    # The site is that of a file that wants it, else of the map below all drawings.
    owner = next((item for item in placed if item.site), placed[-1])
    city, name = placed[0].city, placed[0].name
    for other in placed[1:]:
        city = combine(city, other.city, names=(name, other.name), site=owner.city.layout.extent)
    city = replace(city, name=owner.city.name)
    return replace(owner, city=city, located=bool(located), heights=inputs.heights)


def _placed(reading: Reading, frame: Frame) -> Reading:
    city = reading.city
    if reading.located:
        return replace(
            reading,
            city=replace(city, frame=frame, layout=moved(city.layout, city.frame, frame)),
        )
    place = f"{frame.latitude:.6f}, {frame.longitude:.6f}"
    note = f"{reading.name} does not say where it lies; its origin was put at {place}"
    return replace(reading, city=replace(city, frame=frame, notes=(*city.notes, note)))


def _read_map(item: Input, seed: int) -> Reading:
    from cityx.sources.osm import read_osm

    return Reading(item.path.name, read_osm(item.path, seed=seed), located=True, site=None)


def _read_drawing(item: Input, seed: int) -> Reading:
    from cityx.sources.drawn import city_of_drawing, read_drawing

    drawing = read_drawing(item.path)
    city = city_of_drawing(drawing, item.path.name, seed=seed)
    site = city.layout.extent if len(drawing.boundary) else None
    return Reading(item.path.name, city, located=drawing.located, site=site)


_READERS: dict[str, Callable[[Input, int], Reading]] = {"osm": _read_map, "drawn": _read_drawing}
