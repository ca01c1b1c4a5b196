"""Worlds: the parts of a world compiled one after the other."""

from __future__ import annotations

import json
from dataclasses import asdict

import numpy as np
from numpy.typing import NDArray

from cityx.city.city import City
from cityx.city.content import content_hash
from cityx.errors import InputError
from cityx.motion.vehicles import halts_of
from cityx.sim.compile.conflicts import conflicts_by_piece, sharing
from cityx.sim.compile.feasible import Surroundings, blocked_by, fitting, kinked, led_round
from cityx.sim.compile.lanes import pieces_of
from cityx.sim.compile.obstacles import Obstacles, obstacles_of
from cityx.sim.compile.rasters import BIT, clearance_of, flags_of, frame_of
from cityx.sim.compile.signals import programs_of
from cityx.sim.kernels import fits
from cityx.sim.world import NOTHING, OFF_ROADWAY, TOO_TIGHT, VERSION, World
from cityx.traffic.laying import streets_of

DRIVEN = BIT["roadway"] | BIT["deck"]


def compile_world(city: City, city_hash: str = "") -> World:
    """Compile the world of a city.

    Parameters
    ----------
    city
        With a lane graph and a ground.
    city_hash
        Its hash where it is known; it is measured when "".

    Raises
    ------
    InputError
        If the city has no lane for cars.
    """
    if city.network is None or city.lanes is None or not city.lanes.count:
        raise InputError(f'The city "{city.name}" has no lane for cars: it has no streets.')
    streets = streets_of(city, halts_of(city))
    pieces = pieces_of(city, streets)
    if not pieces.count:
        raise InputError(f'The city "{city.name}" has no lane for cars.')
    frame = frame_of(city)
    flags = flags_of(city, frame)
    obstacles = obstacles_of(city, pieces, flags, frame, DRIVEN)
    around = Surroundings(flags, clearance_of(frame, obstacles.segment), frame, obstacles)
    pieces = led_round(pieces, around)
    hit = kinked(pieces, blocked_by(pieces, around))
    programs = programs_of(city.signals, pieces, streets)
    start, other, yields = conflicts_by_piece(pieces, streets)
    about = {
        "name": city.name, "hash": city_hash or content_hash(city).total, "version": VERSION,
        "lod": city.lod, "attribution": list(city.attribution), "frame": asdict(city.frame),
        "extent": list(city.layout.extent), "left_hand": streets.left_hand,
    }  # fmt: skip
    return World(
        pieces.lane, pieces.onto, pieces.junction, pieces.speed, pieces.half_width, pieces.public,
        pieces.narrow | sharing(pieces),
        fitting(hit), _blocks(hit, obstacles), programs.signal, pieces.point_start, pieces.point,
        pieces.next_start, pieces.next, pieces.beside, start, other, yields, programs.cycle,
        programs.change_start, programs.time, programs.state, frame, *flags, *around.clearance,
        obstacles.segment, obstacles.object_id, obstacles.grid, obstacles.cell_start,
        obstacles.cell_segment, np.array([json.dumps(about)]),
    )  # fmt: skip


def _blocks(hit: NDArray[np.int32], obstacles: Obstacles) -> NDArray[np.uint64]:
    """(n, v) objects in the way of vehicles, or why there is none."""
    found = np.full(hit.shape, NOTHING, np.uint64)
    found[hit == fits.OFF] = OFF_ROADWAY
    found[hit == fits.BEND] = TOO_TIGHT
    if len(obstacles.object_id):
        found[hit >= 0] = obstacles.object_id[hit[hit >= 0]]
    return found
