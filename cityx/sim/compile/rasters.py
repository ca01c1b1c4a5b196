"""Rasters of a world: what lies under a place, and how far it is to anything solid."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cityx.city.city import City
from cityx.city.ground import LABEL, ON_ROADWAY, ROADWAY
from cityx.errors import InputError
from cityx.geometry.arrays import FloatArray
from cityx.ground.standing import WALKED
from cityx.sim.kernels import rasters as kernels

CELL = 0.25  # metres
LARGEST = 64  # km2 of a site: each of the rasters has 1 GB then
FLAGS = ("roadway", "deck", "walk", "kerb", "green", "water", "rail", "building")
BIT = {name: 1 << number for number, name in enumerate(FLAGS)}
_KERB = ("kerb", "kerb_dropped")
_SURFACES: dict[str, tuple[str, ...]] = {
    "roadway": (*ROADWAY, *ON_ROADWAY, "parking", "apron"),
    "walk": (*WALKED, "kerb_dropped", "tactile", "tactile_pale", "tactile_buff", "tactile_red",
             "ramp", "guide_strip", "landing"),
    "kerb": _KERB,
    "green": ("grass", "meadow", "wood", "park", "farmland", "block", "bed", "sand", "bare",
              "pitch", "playground"),
    "deck": ("void",),  # what is built there stands on no ground
    "water": ("water",),
    "rail": ("railway", "rail"),
    "building": ("building",),
}  # fmt: skip


def frame_of(city: City) -> FloatArray:
    """(5,) west, south, metres of a cell, columns and rows of the rasters of a city.

    Raises
    ------
    InputError
        If they would be larger than `LARGEST`.
    """
    west, south, east, north = city.layout.extent
    columns, rows = (max(int(np.ceil(span / CELL)), 1) for span in (east - west, north - south))
    if columns * rows * CELL**2 > LARGEST * 1e6:
        raise InputError(
            f'The city "{city.name}" is too large to be driven in as a whole: its site has '
            f"{columns * rows * CELL**2 / 1e6:.0f} km2, {LARGEST} are not. Build a part of the map "
            "(cityx build MAP --at LAT,LON --size WxH), or tiles (cityx tiles build MAP), and give "
            "that folder."
        )
    return np.array([west, south, CELL, columns, rows], float)


def flags_of(city: City, frame: FloatArray) -> NDArray[np.uint8]:
    """(h, w) bits of `FLAGS`: what the middle of each cell lies on, row 0 in the south."""
    flags = np.zeros((int(frame[4]), int(frame[3])), np.uint8)
    if city.ground is not None:
        bits = np.zeros(len(LABEL), np.uint8)
        for flag, names in _SURFACES.items():
            for name in names:
                bits[LABEL[name]] |= BIT[flag]
        ground = city.ground
        of = bits[ground.face_label[ground.triangle_face]]
        kernels.draw_triangles(flags, frame, np.asarray(ground.vertices), ground.triangles, of)
    ways = city.heights
    if ways is not None and ways.count:
        owner = np.repeat(np.arange(ways.count), np.diff(ways.point_start))
        first = np.flatnonzero((owner[1:] == owner[:-1]) & (ways.edge[owner[1:]] >= 0))
        line = np.column_stack([ways.points[first], ways.points[first + 1]])
        kernels.draw_strips(flags, frame, line, ways.half_width[owner[first]], BIT["deck"])
    return flags


def clearance_of(frame: FloatArray, segment: NDArray[np.float32]) -> NDArray[np.uint8]:
    """(h, w) decimetres from any place of a cell to the nearest segment, at least, up to 25.5 m."""
    mask = np.zeros((int(frame[4]), int(frame[3])), bool)
    kernels.draw_segments(mask, frame, segment)
    return np.asarray(kernels.clearance(mask, float(frame[2])))
