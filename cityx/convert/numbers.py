"""From numbers: cubes, points, lines and faces, noise, words."""

from __future__ import annotations

import math
from typing import Annotated

import numpy as np
import shapely

from cityx.errors import ActionFailed
from cityx.ids import uniform
from cityx.protocol import Port, Range, Text, action
from cityx.protocol.values import (
    Boxes,
    Lines,
    NoiseFunction,
    Points,
    Surfaces,
    make_boxes,
    make_lines,
    make_points,
    make_surfaces,
)

FAR = 100_000.0  # metres; no site reaches farther from its origin
Coordinate = Annotated[float, Range(-FAR, FAR)]
Heading = Annotated[float, Range(-2 * math.pi, 2 * math.pi)]


@action(
    "convert/cube_generation-v1",
    classname="Cube_generation",
    kind="source",
    limits=["Cubes stand in a row on level ground; they do not know what is there already."],
)
def cube_generation(
    edge: Annotated[float, Port("edge", "random_number", "length"), Range(0.001, FAR)],
    *,
    count: Annotated[int, Range(1, 10_000)] = 1,
    gap: Annotated[float, Range(0.0, FAR)] = 0.0,
    x: Coordinate = 0.0,
    y: Coordinate = 0.0,
    z: Coordinate = 0.0,
    heading: Heading = 0.0,
) -> Boxes:
    """Generate cubes.

    Parameters
    ----------
    edge
        Edge of every cube, metres.
    count
        Number of cubes in the row.
    gap
        Metres between neighbours.
    x, y, z
        Centre of the first cube's lower face, metres.
    heading
        Direction of the row, compass radians.
    """
    along = np.arange(count) * (edge + gap)
    base = np.column_stack(
        [x + along * math.sin(heading), y + along * math.cos(heading), np.full(count, z)]
    )
    return make_boxes(base, (edge, edge, edge), heading)


@action(
    "convert/point_generation-v1",
    classname="Point_generation",
    kind="source",
    limits=["Points are independent of each other: some lie close together."],
)
def point_generation(
    seed: Annotated[int, Port("seed", "random_number"), Range(0, 2**53)],
    *,
    count: Annotated[int, Range(1, 1_000_000)] = 100,
    width: Annotated[float, Range(0.001, FAR)] = 100.0,
    depth: Annotated[float, Range(0.001, FAR)] = 100.0,
    x: Coordinate = 0.0,
    y: Coordinate = 0.0,
) -> Points:
    """Generate points.

    Parameters
    ----------
    seed
        Seed; the first points of a larger count are those of a smaller one.
    count
        Number of points.
    width, depth
        Size of the rectangle they lie in, east and north, metres.
    x, y
        Centre of the rectangle, metres.
    """
    ids = np.arange(count)
    u = uniform(seed, "Point_generation", ids, np.array([[0], [1]])) - 0.5  # (2, count)
    return make_points(np.column_stack([x + u[0] * width, y + u[1] * depth]))


@action(
    "convert/line_generation-v1",
    classname="Line_generation",
    kind="source",
    limits=["Lines are straight or arcs of one radius."],
)
def line_generation(
    length: Annotated[float, Port("length", "random_number", "length"), Range(0.001, FAR)],
    *,
    x: Coordinate = 0.0,
    y: Coordinate = 0.0,
    heading: Heading = 0.0,
    turn: Annotated[float, Range(-2 * math.pi, 2 * math.pi)] = 0.0,
    segments: Annotated[int, Range(1, 10_000)] = 16,
) -> Lines:
    """Generate lines.

    Parameters
    ----------
    length
        Length along the line, metres.
    x, y
        Start, metres.
    heading
        Direction at the start, compass radians.
    turn
        Change of direction over the whole line, radians, positive to the right; 0 is straight.
    segments
        Number of equal segments.
    """
    step = length / segments
    middle = heading + turn * (np.arange(segments) + 0.5) / segments  # direction of each chord
    steps = step * np.column_stack([np.sin(middle), np.cos(middle)])
    points = np.array([x, y]) + np.concatenate([[[0.0, 0.0]], np.cumsum(steps, axis=0)])
    return make_lines([shapely.LineString(points)])


@action(
    "convert/face_generation-v1",
    classname="Face_generation",
    kind="source",
    limits=["Faces are rectangles on level ground."],
)
def face_generation(
    length: Annotated[float, Port("length", "random_number", "length"), Range(0.001, FAR)],
    *,
    width: Annotated[float | None, Range(0.001, FAR)] = None,
    x: Coordinate = 0.0,
    y: Coordinate = 0.0,
    heading: Heading = 0.0,
) -> Surfaces:
    """Generate faces.

    Parameters
    ----------
    length
        Side along the heading, metres.
    width
        Other side, metres; null for a square.
    x, y
        Centre, metres.
    heading
        Direction of the length, compass radians.
    """
    along = length / 2 * np.array([math.sin(heading), math.cos(heading)])
    across = (length if width is None else width) / 2 * np.array([along[1], -along[0]])
    across /= length / 2
    signs = ((-1, 1), (-1, -1), (1, -1), (1, 1))
    ring = [[x, y] + a * along + b * across for a, b in signs]
    return make_surfaces([shapely.orient_polygons(shapely.Polygon(ring))])


@action(
    "convert/number_to_noise_conversion-v1",
    classname="Number_to_noise_conversion",
    extension=True,
    limits=["Loses nothing, but neighbouring seeds give unrelated functions."],
)
def number_to_noise_conversion(
    seed: Annotated[int, Port("seed", "random_number"), Range(0, 2**53)],
    *,
    scale: Annotated[float, Range(0.01, FAR)] = 100.0,
    octaves: Annotated[int, Range(1, 12)] = 4,
) -> NoiseFunction:
    """Convert a number to the noise function it seeds.

    Parameters
    ----------
    seed
        The seed.
    scale
        Metres of the largest waves.
    octaves
        Layers, each of half the wave length and height of the one before.
    """
    return NoiseFunction(int(seed), scale, octaves)


@action(
    "convert/number_to_boolean_conversion-v1",
    classname="Number_to_boolean_conversion",
    extension=True,
    lossy=0.5,
    limits=["Loses the size of the number: all that counts is the side of the threshold."],
)
def number_to_boolean_conversion(
    number: Annotated[float, Port("number", "random_number")], *, threshold: float = 0.5
) -> bool:
    """Convert a number to yes or no by a threshold.

    Parameters
    ----------
    number
        The number.
    threshold
        Numbers from here on are yes.
    """
    return bool(number >= threshold)


@action(
    "convert/boolean_to_number_conversion-v1",
    classname="Boolean_to_number_conversion",
    extension=True,
    limits=["Yields 0 and 1 alone."],
)
def boolean_to_number_conversion(value: Annotated[bool, Port("value", "boolean")]) -> float:
    """Convert yes or no to 1 or 0.

    Parameters
    ----------
    value
        The truth value.
    """
    return float(value)


@action(
    "convert/number_to_string_conversion-v1",
    classname="Number_to_string_conversion",
    extension=True,
    gives=(Port("text", "string", "number"),),
    limits=["Loses the unit, which a number does not carry."],
)
def number_to_string_conversion(number: Annotated[float, Port("number", "random_number")]) -> str:
    """Convert a number to the shortest text that reads back as the same number.

    Parameters
    ----------
    number
        The number.
    """
    return repr(float(number))


@action(
    "convert/string_to_number_conversion-v1",
    classname="String_to_number_conversion",
    extension=True,
    limits=["Reads plain decimal numbers; units and words for numbers are refused."],
)
def string_to_number_conversion(
    text: Annotated[str, Port("text", "string", "number"), Text(40)],
) -> float:
    """Convert a decimal number written as text to the number.

    Parameters
    ----------
    text
        The text, such as "12.5".
    """
    try:
        number = float(text)
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise ActionFailed(f'"{text}" is no decimal number.')
    return number
