"""Walks: what a simulator knows of where one may go on foot or on small wheels, as arrays.

They are compiled once from a city and kept beside its world; see `cityx.sim.world`.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.sim.travellers import TRAVELLERS

VERSION = 4  # of the compiler; rises whenever a city gives other walks
AREA, VERGE = 1, 2  # bits of `cell_flags`: one may walk there; that is land beside a roadway
ROUTED = ("person", "robot", "wheelchair")  # kinds that routes are made for
FITS = tuple(4 << number for number in range(len(TRAVELLERS)))  # the middle of each may be there


@dataclass(frozen=True)
class Walks:
    """Where one walks in a city, as a simulator reads it.

    Attributes
    ----------
    cell_frame
        (5,) float64: west, south, metres of a cell, columns and rows of the rasters.
    cell_flags
        (h, w) uint8, row 0 in the south: bits `AREA` and `VERGE`, and one of `FITS` for each kind
        of traveller, where its middle may be: room about it, and no step that it does not get over.
    cell_height
        (h, w) float32, metres of the ground with its kerbs; NaN where there is none.
    cell_crossing
        (h, w) int16, number from 1 of the crosswalk on a roadway, 0 elsewhere.
    crossing_id
        (c,) uint64.
    crossing_ends
        (c, 2, 2) float64, metres, on the walks that it joins.
    crossing_signal
        (c,) int32, program of the world's signals that the lanes it crosses have; -1 for none.
    crossing_fits
        (c, t) bool, whether each kind of traveller gets across.
    route_start
        (r + 1,) int64 into the points.
    route_point
        (p, 4) float64: x, y, z and metres from the start, every half metre.
    route_crossing
        (p,) int16, number of the crosswalk that a point is on, 0 for none.
    route_kind
        (r,) int32, traveller that fits along the whole route; ascending, and of each kind by
        length.
    route_door
        (r, 2) uint64, doors, stops or places at the border that it joins; 0 for a place on a walk.
    top_frame
        (5,) float64, as `cell_frame`, of the rasters for who flies.
    top_height
        (h, w) float32, metres of what is highest: ground, roofs, crowns; NaN where there is none.
    top_row
        (h, w) int32 into `top_object`, whose height it is.
    top_object
        (o,) uint64.
    about
        Text (JSON) with "name", "hash", "version", "doors" and "open_m2", square metres of one
        piece of the area by traveller.
    """

    cell_frame: FloatArray
    cell_flags: NDArray[np.uint8]
    cell_height: NDArray[np.float32]
    cell_crossing: NDArray[np.int16]
    crossing_id: NDArray[np.uint64]
    crossing_ends: FloatArray
    crossing_signal: NDArray[np.int32]
    crossing_fits: BoolArray
    route_start: IntArray
    route_point: FloatArray
    route_crossing: NDArray[np.int16]
    route_kind: NDArray[np.int32]
    route_door: NDArray[np.uint64]
    top_frame: FloatArray
    top_height: NDArray[np.float32]
    top_row: NDArray[np.int32]
    top_object: NDArray[np.uint64]
    about: NDArray[np.str_]

    @cached_property
    def facts(self) -> dict[str, Any]:
        """What `about` says."""
        found: dict[str, Any] = json.loads(str(self.about[0]))
        return found

    @cached_property
    def route_length(self) -> FloatArray:
        """(r,) metres."""
        return np.asarray(self.route_point[self.route_start[1:] - 1, 3])


@dataclass(frozen=True)
class WalkCertificate:
    """How much of the walks of a city is open to whom.

    Attributes
    ----------
    area
        Square metres of walks, paths and crosswalks.
    room
        Square metres in which the middle of each kind of traveller may be, by name.
    joined
        Square metres of the largest piece of that, by name.
    crossings, crossings_by_traveller
        Number of crosswalks, and of those that each gets across.
    closed
        Crosswalks that a wheelchair does not get across.
    """

    area: float
    room: dict[str, float]
    joined: dict[str, float]
    crossings: int
    crossings_by_traveller: dict[str, int]
    closed: NDArray[np.uint64]


def walk_certificate(walks: Walks) -> WalkCertificate:
    """Measure who gets where."""
    cell = float(walks.cell_frame[2]) ** 2
    names = [each.name for each in TRAVELLERS]
    return WalkCertificate(
        float(((walks.cell_flags & AREA) != 0).sum()) * cell,
        {name: float(((walks.cell_flags & bit) != 0).sum()) * cell
         for name, bit in zip(names, FITS, strict=True)},
        dict(zip(names, walks.facts["open_m2"], strict=True)), len(walks.crossing_id),
        dict(zip(names, walks.crossing_fits.sum(axis=0).tolist(), strict=True)),
        walks.crossing_id[~walks.crossing_fits[:, -1]],
    )  # fmt: skip
