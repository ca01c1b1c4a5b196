"""Inputs become one city: each file is read by its source, and what they give is put together."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from cityx.city import City, Frame, Layout
from cityx.city.frame import NOWHERE
from cityx.city.sites import Box, moved
from cityx.errors import InputError, UsageError, nearest
from cityx.options import HowToRead
from cityx.sources.combination import combine
from cityx.sources.input_kinds import KINDS, WORDS, Input, classify

if TYPE_CHECKING:
    from cityx.sources.heights.height_source import Heights

# What a person drew goes before what a map says, and a map before what was seen from above.
PRECEDENCE = ("drawn", "osm", "semantic", "satellite")


@dataclass(frozen=True)
class Inputs:
    """The files of a build, by what they are.

    Attributes
    ----------
    sources
        Files that give a layout, in the order of their precedence.
    heights
        Height files.
    texts
        Files with wishes in words.
    """

    sources: tuple[Input, ...]
    heights: tuple[Input, ...]
    texts: tuple[Input, ...] = ()

    @classmethod
    def of(cls, items: Iterable[Input]) -> Inputs:
        """Put files in the order of their precedence."""
        held = list(items)
        heights, texts = (
            tuple(item for item in held if item.kind == kind) for kind in ("height", "text")
        )
        sources = tuple(item for kind in PRECEDENCE for item in held if item.kind == kind)
        return cls(sources, heights, texts)

    @property
    def all(self) -> tuple[Input, ...]:
        """Every file."""
        return (*self.sources, *self.heights, *self.texts)

    @property
    def records(self) -> list[dict[str, object]]:
        """What the report says about the files."""
        return [item.record() for item in self.all]


def sort_inputs(paths: list[Path], kinds: Iterable[str] = ()) -> Inputs:
    """Sort files by kind.

    Parameters
    ----------
    kinds
        "NAME=KIND" for files whose content would be taken for something else.

    Raises
    ------
    InputError, UsageError
        If a file is of no use or the files do not make a city together.
    """
    said = _said_kinds(paths, kinds)
    found = Inputs.of(classify(path, said.get(path.name, "")) for path in paths)
    maps = sum(item.kind == "osm" for item in found.sources)
    if maps > 1:
        raise UsageError(
            f"Give at most one map, and any drawings, images and heights ({KINDS}); given: "
            f"{maps} maps."
        )
    return found


def _said_kinds(paths: list[Path], kinds: Iterable[str]) -> dict[str, str]:
    """Read "NAME=KIND" texts.

    Raises
    ------
    UsageError
        With every one that means nothing.
    """
    names = [path.name for path in paths]
    said, faults = {}, []
    for text in kinds:
        name, _, kind = text.rpartition("=")
        if kind not in WORDS:
            faults.append(f'--as "{text}": write NAME=KIND, a kind is one of {", ".join(WORDS)}.')
        elif Path(name).name not in names:
            faults.append(f'--as "{text}": no input is called "{name}".{nearest(name, names)}')
        else:
            said[Path(name).name] = kind
    if faults:
        raise UsageError("\n".join(faults))
    return said


@dataclass(frozen=True)
class Reading:
    """What one file gave, or several together.

    Attributes
    ----------
    name
        Of the file, "" for a city that no file gave.
    city
        A city with a layout; it lies somewhere unless its frame is `NOWHERE`.
    site
        The rectangle that the file wants built, frame of the city, or None for any.
    heights
        The height files of the site, whose terrain is laid when its window is known; None for
        none, and where the city has its terrain.
    """

    name: str
    city: City
    site: Box | None = None
    heights: Heights | None = None

    @property
    def located(self) -> bool:
        """Whether it says where on Earth it lies."""
        return self.city.frame != NOWHERE


def read_alone(path: Path, how: HowToRead) -> City:
    """Read one file that gives a layout, as if it were all there is.

    Raises
    ------
    InputError
        If it cannot be read or gives no layout.
    """
    item = input_of(path, how)
    if item.kind not in _READERS:
        raise InputError(f"{path.name} is {item.kind} and gives no layout.")
    return _READERS[item.kind](item, how).city


def input_of(path: Path, how: HowToRead) -> Input:
    """Return a file with its kind: what the user says it is, else what its content says."""
    pairs = (text.rpartition("=") for text in how.kinds)
    said = {Path(name).name: kind for name, _, kind in pairs}
    return classify(path, said.get(path.name, ""))


def read_sources(inputs: Inputs, how: HowToRead) -> Reading:
    """Read every file that gives a layout and put them together; none gives an empty city.

    What does not say where it lies is put at the place the user gives, else in the middle of what
    does.

    Raises
    ------
    InputError
        If a file cannot be read, holds no city or lies elsewhere than the others.
    """
    heights = _read_heights(inputs, how) if inputs.heights else None
    if not inputs.sources:
        return _without_layout(heights, how)
    readings = [_READERS[item.kind](item, how) for item in inputs.sources]
    located = [reading.city.frame for reading in readings if reading.located]
    frame = located[-1] if located else _usual_frame(how)
    placed = [_placed(reading, frame) for reading in readings]
    # The site is that of a file that wants it, else of the map below all drawings.
    owner = next((item for item in placed if item.site), _ground(placed, inputs))
    city, name = placed[0].city, placed[0].name
    for other in placed[1:]:
        city = combine(city, other.city, names=(name, other.name), site=owner.city.layout.extent)
    return replace(owner, city=replace(city, name=owner.city.name), heights=heights)


def _read_heights(inputs: Inputs, how: HowToRead) -> Heights:
    from cityx.sources.heights.height_files import HeightOptions
    from cityx.sources.heights.height_source import read_heights

    options = HeightOptions(span=how.height_range, crs=how.height_crs, pixel=how.pixel)
    return read_heights([item.path for item in inputs.heights], options)


def _without_layout(heights: Heights | None, how: HowToRead) -> Reading:
    """Return a city of heights alone, or an empty one for a town on the ground that they give."""
    frame = _usual_frame(how)
    if heights is not None:
        from cityx.sources.heights.height_source import height_city, place_of

        if heights.has_houses:
            city = height_city(heights, seed=how.seed, at=how.at, place=how.place)
            return Reading(heights.files[0].path.name, city)
        frame = replace(place_of(heights, how.at)[0], place=how.place)
    city = City("town", frame, Layout((0.0, 0.0, 0.0, 0.0)), seed=how.seed)
    return Reading("", city, heights=heights)


def _usual_frame(how: HowToRead) -> Frame:
    """Return the frame of what does not say where it lies."""
    return replace(Frame(*how.at) if how.at else NOWHERE, place=how.place)


def _ground(readings: list[Reading], inputs: Inputs) -> Reading:
    """Return the reading of the best source that covers a site: whatever is not a drawing."""
    kinds = [item.kind for item in inputs.sources]
    pairs = zip(kinds, readings, strict=True)
    return next((item for kind, item in pairs if kind != "drawn"), readings[-1])


def _placed(reading: Reading, frame: Frame) -> Reading:
    city = reading.city
    if reading.located:
        layout = moved(city.layout, city.frame, frame)
        return replace(reading, city=replace(city, frame=frame, layout=layout))
    if frame == NOWHERE:
        note = f"{reading.name} does not say where it lies; rules of central Europe hold"
    else:
        place = f"{frame.latitude:.6f}, {frame.longitude:.6f}"
        note = f"{reading.name} does not say where it lies; its origin was put at {place}"
    return replace(reading, city=replace(city, frame=frame, notes=(*city.notes, note)))


def _read_map(item: Input, how: HowToRead) -> Reading:
    from cityx.sources.osm import read_osm

    return Reading(item.path.name, read_osm(item.path, seed=how.seed, place=how.place))


def _read_drawing(item: Input, how: HowToRead) -> Reading:
    from cityx.sources.drawn import city_of_drawing, read_drawing

    drawing = read_drawing(item.path)
    city = city_of_drawing(drawing, item.path.name, seed=how.seed, place=how.place)
    return Reading(item.path.name, city, city.layout.extent if len(drawing.boundary) else None)


def _read_semantic_map(item: Input, how: HowToRead) -> Reading:
    from cityx.sources.semantic_map import read_semantic_map

    city = read_semantic_map(
        item.path,
        legend=how.legend or None,
        pixel=how.pixel,
        confirm=how.confirm_legend,
        fidelity=how.fidelity,
        seed=how.seed,
        place=how.place,
    )
    return Reading(item.path.name, city)


def _read_satellite(item: Input, how: HowToRead) -> Reading:
    from cityx.sources.satellite import read_satellite

    city = read_satellite(
        item.path,
        pixel=how.pixel,
        segmenter=how.segmenter or None,
        fidelity=how.fidelity,
        seed=how.seed,
        place=how.place,
    )
    return Reading(item.path.name, city)


_READERS: Mapping[str, Callable[[Input, HowToRead], Reading]] = {
    "osm": _read_map,
    "drawn": _read_drawing,
    "semantic": _read_semantic_map,
    "satellite": _read_satellite,
}
