"""From the files a user handed in to one layout."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

from cityx.city import City
from cityx.city.sites import WINDOW, Box, window_about
from cityx.errors import InputError, UsageError
from cityx.options import HowToRead
from cityx.protocol import Choice, InputFiles, Port, Range, Text, action
from cityx.sources.input_kinds import Input
from cityx.sources.intake import PRECEDENCE, Inputs, Reading, read_sources
from cityx.town.crop import windowed

FILLED = ("buildings", "roads", "lines")


@action(
    "layout/inputs-v1",
    kind="source",
    after=("background/driving_side-v1",),
    takes=(
        Port("maps", "geographic_data", "osm", optional=True),
        Port("drawings", "geographic_data", "drawn", optional=True),
        Port("semantic_maps", "image", "semantic_map", optional=True),
        Port("photographs", "image", "satellite", optional=True),
        Port("heights", "image", "height_field", optional=True),
    ),
    gives=(Port("layout", "scene_layout", "layout"),),
    binds={
        "latitude": "at.latitude",
        "longitude": "at.longitude",
        "width": "size.x",
        "depth": "size.y",
        "legend": "read.legend",
        "confirm_legend": "read.confirm_legend",
        "pixel": "read.pixel",
        "fidelity": "read.fidelity",
        "segment": "read.segment",
        "lowest": "read.lowest",
        "highest": "read.highest",
        "height_crs": "read.height_crs",
    },
    limits=[
        "Reads files the user handed in and no other; what they contradict each other in is "
        "decided by kind: drawings, maps, semantic maps, photographs, heights."
    ],
    labels=("openstreetmap", "read", "import", "aerial", "image"),
)
def read_inputs(
    city: City,
    inputs: InputFiles,
    *,
    latitude: Annotated[float | None, Range(-85.0, 85.0)] = None,
    longitude: Annotated[float | None, Range(-180.0, 180.0)] = None,
    width: Annotated[float | None, Range(10.0, 1e7)] = None,
    depth: Annotated[float | None, Range(10.0, 1e7)] = None,
    legend: Annotated[str, Text(80)] = "",
    confirm_legend: bool = False,
    pixel: Annotated[float | None, Range(1e-6, 1e6)] = None,
    fidelity: Annotated[str, Choice("exact", "plausible")] = "exact",
    segment: bool = True,
    lowest: Annotated[float | None, Range(-12000.0, 9000.0)] = None,
    highest: Annotated[float | None, Range(-12000.0, 9000.0)] = None,
    height_crs: Annotated[str, Text(80)] = "",
) -> City:
    """Read every file of a place and put what they show together into one layout.

    Parameters
    ----------
    city
        City without a layout.
    inputs
        Files the user handed in; of the kinds "legend" and "segmenter" those that say how to read
        images.
    latitude, longitude
        Place of what does not say where it lies, and the centre of the window, degrees.
    width, depth
        Size of a window to keep, metres; all of the site when left out, 1 km about a centre.
    legend
        Preset of a semantic map's classes; found by evidence when "".
    confirm_legend
        Whether to take classes that are proposed.
    pixel
        Metres of a pixel of images that do not say it.
    fidelity
        Of images: "exact" as shown, "plausible" with connected streets and whole blocks.
    segment
        Whether a network tells the classes of photographs, not colour and texture alone.
    lowest, highest
        Metres of the lowest and the highest number of heights that are no metres.
    height_crs
        Coordinate system of heights that do not name theirs.
    """
    at = (latitude, longitude) if latitude is not None and longitude is not None else None
    if (latitude is None) != (longitude is None):
        raise UsageError("A place needs latitude and longitude.")
    how = HowToRead(
        seed=city.seed,
        at=at,
        place=city.frame.place,
        legend=str(next(iter(inputs.of_kind("legend")), legend)),
        confirm_legend=confirm_legend,
        pixel=pixel,
        fidelity=fidelity,
        segmenter=str(next(iter(inputs.of_kind("segmenter")), "" if segment else "none")),
        height_range=height_range(lowest, highest),
        height_crs=height_crs,
    )
    reading = read_sources(Inputs.of(items_of(inputs)), how)
    made = replace(reading.city, seed=city.seed, lod=city.lod, style=city.style)
    if reading.name and (width or depth or (at and reading.located)):
        made = _windowed(made, _window(reading, at, width or WINDOW, depth or WINDOW))
    if reading.heights is None and inputs.of_kind("height"):
        made = replace(made, stages_done=made.stages_done | {"terrain"})
    return made


def items_of(inputs: InputFiles) -> list[Input]:
    """Return the input files that show a place."""
    pairs = zip(inputs.paths, inputs.kinds, strict=True)
    return [Input(path, kind) for path, kind in pairs if kind in (*PRECEDENCE, "height")]


def height_range(lowest: float | None, highest: float | None) -> tuple[float, float] | None:
    """Return the metres that heights span.

    Raises
    ------
    UsageError
        If one of them is missing.
    """
    if lowest is None and highest is None:
        return None
    if lowest is None or highest is None:
        raise UsageError("A range of heights needs its lowest and its highest value.")
    return lowest, highest


def _window(reading: Reading, at: tuple[float, float] | None, width: float, depth: float) -> Box:
    """Return the rectangle to keep, frame of the city."""
    frame, extent = reading.city.frame, reading.city.layout.extent
    xmin, ymin, xmax, ymax = extent
    x, y = (xmin + xmax) / 2, (ymin + ymax) / 2
    if at and reading.located:
        x, y = frame.to_local([[at[1], at[0]]])[0].tolist()
        if not (xmin <= x <= xmax and ymin <= y <= ymax):
            west, south = frame.to_geographic([[xmin, ymin]])[0]
            east, north = frame.to_geographic([[xmax, ymax]])[0]
            raise UsageError(
                f"--at {at[0]},{at[1]} lies outside the map, which covers "
                f"latitude {south:.5f} to {north:.5f} and longitude {west:.5f} to {east:.5f}."
            )
    return window_about(extent, (x, y), width, depth)


def _windowed(city: City, window: Box) -> City:
    made = windowed(city, window)
    if not any(len(getattr(made.layout, name)) for name in FILLED):
        raise InputError("The window holds no building and no road; move --at, enlarge --size.")
    return made
