"""Pictures of a world from above: what is driven on, what is solid, who moves, and the route."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cityx.sim.compile.rasters import BIT
from cityx.sim.engine import Engine
from cityx.sim.kernels.tables import ALIVE, HEADING, LENGTH, WIDTH, X, Y

SIZE_PX = 320  # pixels of a side
# Colours from below to above, linear bytes.
PAINT = (
    ("green", (176, 196, 158)), ("walk", (205, 200, 190)), ("water", (150, 180, 205)),
    ("rail", (150, 140, 130)), ("building", (150, 128, 112)), ("roadway", (105, 105, 110)),
    ("deck", (115, 115, 122)),
)  # fmt: skip
PLAIN, SOLID, ROUTE, AGENT, OTHER = (
    (225, 222, 214), (70, 55, 48), (90, 170, 235), (220, 60, 40), (245, 190, 60),
)  # fmt: skip


def picture(engine: Engine, world: int, agent: int) -> NDArray[np.uint8]:
    """Return (h, w, 3) what lies round an agent, north up."""
    place = engine.world
    real, whole = engine.state.real[world], engine.state.whole[world]
    x, y = real[X, agent], real[Y, agent]
    step = engine.shown_m / SIZE_PX
    shift = (np.arange(SIZE_PX) + 0.5) * step - engine.shown_m / 2
    px, py = np.meshgrid(x + shift, y - shift)
    frame = place.raster_frame
    column = ((px - frame[0]) // frame[2]).astype(int)
    row = ((py - frame[1]) // frame[2]).astype(int)
    within = (column >= 0) & (row >= 0) & (column < frame[3]) & (row < frame[4])
    column, row = np.where(within, column, 0), np.where(within, row, 0)
    flags = np.where(within, place.flags.at(row, column), 0)
    image = np.full((SIZE_PX, SIZE_PX, 3), PLAIN, np.uint8)
    for name, colour in PAINT:
        image[(flags & BIT[name]) != 0] = colour
    image[within & (place.clear.at(row, column) == 0) & _solid(engine, px, py)] = SOLID
    _draw_route(engine, image, world, agent, x, y, step)
    for mover in range(real.shape[1]):
        if whole[ALIVE, mover]:
            c, s = np.cos(real[HEADING, mover]), np.sin(real[HEADING, mover])
            dx, dy = px - real[X, mover], py - real[Y, mover]
            own = np.abs(dx * c + dy * s) <= real[LENGTH, mover] / 2
            own &= np.abs(dy * c - dx * s) <= real[WIDTH, mover] / 2
            image[own] = AGENT if mover < engine.agents else OTHER
    return image


def _solid(engine: Engine, px: NDArray[np.float64], py: NDArray[np.float64]) -> NDArray[np.bool_]:
    """(h, w) whether a segment runs through a pixel."""
    place, found = engine.world, np.zeros(px.shape, bool)
    west, north, step = px[0, 0], py[0, 0], px[0, 1] - px[0, 0]
    segment = np.asarray(place.segment, float)
    near = (segment[:, [0, 2]].max(axis=1) > px.min()) & (segment[:, [0, 2]].min(axis=1) < px.max())
    near &= (segment[:, [1, 3]].max(axis=1) > py.min()) & (
        segment[:, [1, 3]].min(axis=1) < py.max()
    )
    for x0, y0, x1, y1, *_ in segment[near]:
        count = int(np.hypot(x1 - x0, y1 - y0) / step) + 2
        along = np.linspace(0.0, 1.0, count)
        i = np.rint((x0 + along * (x1 - x0) - west) / step).astype(int)
        j = np.rint((north - y0 - along * (y1 - y0)) / step).astype(int)
        inside = (i >= 0) & (j >= 0) & (i < px.shape[1]) & (j < px.shape[0])
        found[j[inside], i[inside]] = True
    return found


def _draw_route(
    engine: Engine, image: NDArray[np.uint8], world: int, agent: int, x: float, y: float,
    step: float,
) -> None:  # fmt: skip
    points = engine.route_of(world, agent)
    if len(points):
        i = np.rint((points[:, 0] - x) / step + SIZE_PX / 2).astype(int)
        j = np.rint((y - points[:, 1]) / step + SIZE_PX / 2).astype(int)
        inside = (i >= 1) & (j >= 1) & (i < SIZE_PX - 1) & (j < SIZE_PX - 1)
        for a in (-1, 0, 1):
            image[j[inside] + a, i[inside]] = ROUTE
            image[j[inside], i[inside] + a] = ROUTE
