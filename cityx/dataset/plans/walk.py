"""The plan "walk": what pedestrians see on their way along pavements and across streets."""

from __future__ import annotations

import numpy as np

from cityx.dataset.plans.motion import along_line, headings, length_of, smoothed
from cityx.dataset.plans.plan_site import Site
from cityx.dataset.plans.takes import Refusal, Source, Take
from cityx.errors import InputError
from cityx.geometry.arrays import IntArray
from cityx.geometry.scatter import nearby_order
from cityx.ground.walking.walkable import Walkable, walkable_of
from cityx.ground.walking.walks import WalkGraph, walk_graph, walks_between
from cityx.ids import draw
from cityx.motion.feasible import ground_height

FOV = 70.0  # degrees
SPEED = 1.4  # metres per second, the usual one of adults
LOWEST, HIGHEST = 1.4, 1.9  # metres of eyes above the pavement
AHEAD = 3.0  # metres ahead of the feet to which one looks
TURN_S = 0.6  # seconds over which a turn of the head is spread, and a step onto a kerb
NARROW = 0.4  # metres of clearance below which all pavements count the same
GOAL = 40.0  # metres, at least, from the beginning to where somebody walks
FARTHER = 1.5  # times as far that goals are looked for
DETOUR = 4.0  # times the beeline beyond which no way is looked for, as walkers feel it
DOWN = np.radians(-2.0)  # pitch: one watches one's step a little


def walk(site: Site) -> Source:
    """Return the source of walks, which begin evenly over the walkable area.

    Raises
    ------
    InputError
        If nobody can walk in the city.
    """
    city = site.city
    try:
        walkable = walkable_of(city)
    except ValueError as error:
        raise InputError(f"nobody can walk in {city.name}: {error}.") from error
    graph = walk_graph(walkable)
    if not len(graph.places):
        raise InputError(f"nobody can walk in {city.name}: it has no pavements, paths or plazas.")
    order = nearby_order(graph.places)
    # A node of a wide place stands for less of a way than one of a narrow pavement.
    room = walkable.at(walkable.clearance, graph.places[order]).astype(float)
    weight = np.cumsum(1.0 / np.maximum(room, NARROW))
    needed = SPEED * site.wishes.seconds + AHEAD

    def candidates(numbers: IntArray) -> list[Take | Refusal]:
        share = site.draws("walk", numbers, 1)[:, 0]
        row = np.searchsorted(weight, share * weight[-1], side="right")
        origins = order[np.minimum(row, len(order) - 1)]
        moments = site.moments(numbers)
        return [
            _take(site, walkable, graph, origin, number, moment, needed)
            for origin, number, moment in zip(
                origins.tolist(), numbers.tolist(), moments.tolist(), strict=True
            )
        ]

    return candidates


def _take(
    site: Site, walkable: Walkable, graph: WalkGraph, origin: int, number: int, moment: float,
    needed: float,
) -> Take | Refusal:  # fmt: skip
    goal = _goal(graph, origin, max(needed, GOAL), draw(site.wishes.seed, "dataset/walk", number))
    if goal is None:
        return Refusal("the way ends", f"no goal {max(needed, GOAL):.0f} m away from "
                       f"{graph.places[origin].round(1).tolist()}")  # fmt: skip
    far = float(np.hypot(*(graph.places[goal] - graph.places[origin])))
    walks, found = walks_between(
        walkable, np.array([origin]), np.array([goal]), longest=DETOUR * far
    )
    if not found[0] or length_of(walks.points) < needed:
        return Refusal("the way ends", f"at {graph.places[origin].round(1).tolist()}")
    eye_height = LOWEST + (HIGHEST - LOWEST) * draw(site.wishes.seed, "dataset/walk", number, 1)
    rate, length = site.wishes.rate, site.wishes.length
    time = np.arange(length) / rate
    place = SPEED * time
    spot = along_line(walks.points, place)
    heading = headings(along_line(walks.points, place + AHEAD) - spot)
    z = ground_height(site.city, spot)
    position = np.column_stack([spot, smoothed(z, TURN_S / 2 * rate) + eye_height])
    pitch = np.full(length, DOWN)
    return Take(position, smoothed(heading, TURN_S * rate), pitch, moment + time,
                site.wishes.fov(FOV), foot=eye_height)  # fmt: skip


def _goal(graph: WalkGraph, origin: int, far: float, share: float) -> int | None:
    """Return a node about as far away, to which a way leads."""
    near = np.array(graph.tree.query_ball_point(graph.places[origin], FARTHER * far), np.int64)
    away = np.hypot(*(graph.places[near] - graph.places[origin]).T)
    fit = np.sort(near[(away >= far) & (graph.component[near] == graph.component[origin])])
    return int(fit[int(share * len(fit))]) if len(fit) else None
