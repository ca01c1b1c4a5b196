"""Inputs become one city: each file is read by its source, and agreeing parts are kept once."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city import City, Frame, Layout
from cityx.city.frame import NOWHERE
from cityx.city.layout import CURVE
from cityx.city.sites import Box, cut, merged, moved, pieces_of
from cityx.errors import InputError, UsageError, nearest
from cityx.options import HowToRead
from cityx.sources.input_kinds import KINDS, WORDS, Input, classify

if TYPE_CHECKING:
    from geopandas import GeoDataFrame

    from cityx.sources.heights.height_source import Heights


# What a person drew goes before what a map says, and a map before what was seen from above.
PRECEDENCE = ("drawn", "osm", "semantic", "satellite")
SAME_GROUND = 0.1  # share of a building on the ground of another one or of a street: a conflict
NO_EXTENT = (0.0, 0.0, 0.0, 0.0)  # of a town whose site nothing bounds yet
NARROW = 6.0  # metres; whatever is built on a curve takes as much
SAME_WAY = 8.0  # metres within which two lines may be the same street
ALONG = 0.5  # share of a street that runs along others from which it is one of them
SAME_SPOT = 2.0  # metres within which two things of a kind are one


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
    frame, extent = _usual_frame(how), NO_EXTENT
    if heights is not None:
        from cityx.sources.heights.height_source import height_city, land_before, place_of

        if heights.has_houses:
            city = height_city(heights, seed=how.seed, at=how.at, place=how.place)
            return Reading(heights.files[0].path.name, city)
        frame, box = place_of(heights, how.at)
        if how.at and heights.located:
            frame, box = _about(frame, box, how.at)
        frame = replace(frame, place=how.place)
        if heights.located or how.pixel:
            extent = box
    city = City("town", frame, Layout(extent), seed=how.seed)
    if heights is not None and extent != NO_EXTENT:
        city = land_before(city, heights)
    return Reading("", city, heights=heights)


def _about(frame: Frame, box: Box, at: tuple[float, float]) -> tuple[Frame, Box]:
    """Move the middle of a frame and of the rectangle that height files fill to a place on them.

    Raises
    ------
    UsageError
        If the place does not lie on them.
    """
    x, y = frame.to_local([[at[1], at[0]]])[0].tolist()
    if not (box[0] < x < box[2] and box[1] < y < box[3]):
        (west, south), (east, north) = frame.to_geographic([box[:2], box[2:]])
        raise UsageError(
            f"--at {at[0]},{at[1]} lies outside the heights, which cover latitude {south:.5f} to "
            f"{north:.5f} and longitude {west:.5f} to {east:.5f}."
        )
    return Frame(*at), (box[0] - x, box[1] - y, box[2] - x, box[3] - y)


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


def combine(over: City, under: City, *, names: tuple[str, str], site: Box | None = None) -> City:
    """Put two cities of one site together; where they disagree, the first is kept.

    Parameters
    ----------
    over, under
        Cities with a layout.
    names
        What the two are called in notes: ("the map", "the image").
    site
        What is built of them, frame of `over`; the site of `over` when left out.

    Returns
    -------
    city
        `over` with what `under` adds within the site; a note counts each kind of conflict.

    Raises
    ------
    InputError
        If the two do not lie on the same ground.
    """
    layout = moved(under.layout, under.frame, over.frame)
    _check_same_ground(over.layout, layout, names)
    held = over.layout if site is None else cut(over.layout, site)
    layout = cut(layout, site or held.extent)
    conflicts = {
        "buildings": _on_ground(layout.buildings, held),
        "roads": _along(layout.roads, held.roads),
        "lines": _along(layout.lines, held.lines),
        "points": _on_spot(layout.points, held.points),
    }
    kept = {name: getattr(layout, name)[~conflict] for name, conflict in conflicts.items()}
    kept["parts"] = layout.parts[layout.parts["building"].isin(kept["buildings"]["id"])]
    kept["areas"] = _uncovered(layout.areas, held.areas)
    added = Layout(layout.extent, restrictions=layout.restrictions, **kept)
    notes = tuple(
        f"{names[1]}: {count} {name} lie where {names[0]} has some; those of {names[0]} were kept"
        for name, count in ((name, int(found.sum())) for name, found in conflicts.items())
        if count
    )
    return replace(
        over,
        layout=merged(added, held),
        attribution=tuple(dict.fromkeys((*over.attribution, *under.attribution))),
        failures=(*over.failures, *under.failures),
        notes=(*over.notes, *under.notes, *notes),
    )


def _check_same_ground(over: Layout, under: Layout, names: tuple[str, str]) -> None:
    first, second = shapely.box(*over.extent), shapely.box(*under.extent)
    if first.intersects(second):
        return
    away = shapely.distance(first, second) / 1000
    raise InputError(
        f"{names[0]} and {names[1]} do not lie on the same ground: {away:.1f} km are between them; "
        "give inputs of one place."
    )


def _on_ground(buildings: GeoDataFrame, held: Layout) -> NDArray[np.bool_]:
    """Return which buildings overlap another one or a carriageway."""
    roads = held.roads[~(held.roads["bridge"] | held.roads["tunnel"])]
    streets = shapely.buffer(
        roads.geometry.to_numpy(), roads["width"].to_numpy() / 2, cap_style="flat"
    )
    curves = held.lines.geometry.to_numpy()[held.lines["kind"] == CURVE]
    planned = shapely.buffer(curves, NARROW / 2, cap_style="flat")
    ground = np.concatenate([held.buildings.geometry.to_numpy(), streets, planned])
    shapes = buildings.geometry.to_numpy()
    row, other = shapely.STRtree(ground).query(shapes, predicate="intersects")
    shared = shapely.area(shapely.intersection(shapes[row], ground[other]))
    total = np.bincount(row, shared, minlength=len(shapes))
    return np.asarray(total > SAME_GROUND * shapely.area(shapes))


def _along(lines: GeoDataFrame, others: GeoDataFrame) -> NDArray[np.bool_]:
    """Return which lines run along others for more than half of their length."""
    shapes = lines.geometry.to_numpy()
    bands = shapely.buffer(others.geometry.to_numpy(), SAME_WAY, cap_style="flat")
    row, other = shapely.STRtree(bands).query(shapes, predicate="intersects")
    near = np.zeros(len(shapes))
    for index in np.unique(row).tolist():  # bands overlap, so their union is what counts
        band = shapely.union_all(bands[other[row == index]])
        near[index] = shapely.length(shapely.intersection(shapes[index], band))
    return np.asarray(near > ALONG * shapely.length(shapes))


def _on_spot(points: GeoDataFrame, others: GeoDataFrame) -> NDArray[np.bool_]:
    """Return which things stand where another one of their kind does."""
    found = np.zeros(len(points), bool)
    tree = shapely.STRtree(others.geometry.to_numpy())
    row, other = tree.query(points.geometry.to_numpy(), predicate="dwithin", distance=SAME_SPOT)
    same = points["kind"].to_numpy()[row] == others["kind"].to_numpy()[other]
    found[row[same]] = True
    return found


def _uncovered(areas: GeoDataFrame, others: GeoDataFrame) -> GeoDataFrame:
    """Take from areas what others cover."""
    if not len(others):
        return areas
    cover = shapely.union_all(shapely.make_valid(others.geometry.to_numpy()))
    return pieces_of(areas, shapely.difference(areas.geometry.to_numpy(), cover), 2)
