"""Walkable and drivable lines of streets: the sidewalk beside one, the lane in one."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import shapely

from cityx.city.city import City
from cityx.city.ground import LABEL
from cityx.city.section import KIND
from cityx.errors import ActionFailed
from cityx.geometry.arrays import FloatArray
from cityx.ground.standing import stand_on
from cityx.motion.paths import Path

STEP = 2.0  # metres between the places where the ground beside a street is looked at
FARTHEST_WALK = 16.0  # metres from the middle of a street to its sidewalk
LEAST_SHARE = 0.5  # of a street along which there must be a sidewalk
SIDEWALK = (
    "sidewalk",
    "furnishing",
    "frontage",
    "edging",
    "plaza",
    "path",
    "trail",
    "ramp",
    "landing",
    "guide_strip",
)
TRAVELLED = ("drive", "bus")
MITRE = 2.0  # a shifted corner reaches at most so many offsets out


def walkable(city: City, path: Path) -> Path:
    """Return the line people follow along a path: of a street, the middle of a sidewalk.

    Raises
    ------
    ActionFailed
        If the street has no sidewalk.
    """
    if not path.street:
        return path
    line = path.line
    best: tuple[float, float] = (0.0, 0.0)
    for side in (-1.0, 1.0):  # the right one first
        share, offset = _walk_beside(city, line, side)
        if share > best[0] + 0.2:
            best = share, offset
    if best[0] < LEAST_SHARE:
        raise ActionFailed(
            f'The street "{path.name}" has no sidewalk along {100 * (1 - best[0]):.0f} % of it, so '
            "nobody walks along it. Name a footway, a path or a street with sidewalks."
        )
    return beside(path, best[1])


def _walk_beside(city: City, line: Any, side: float) -> tuple[float, float]:
    """Return the share of a side that has a sidewalk, and the offset of its middle, left > 0."""
    count = max(2, int(line.length / STEP))
    along = np.linspace(0.0, line.length, count)
    xy = shapely.get_coordinates(shapely.line_interpolate_point(line, along))
    way = np.gradient(xy, axis=0)
    way /= np.maximum(np.hypot(*way.T), 1e-9)[:, None]
    left = np.column_stack([-way[:, 1], way[:, 0]])
    offsets = np.arange(0.5, FARTHEST_WALK, 0.25)
    spots = xy[:, None] + side * offsets[None, :, None] * left[:, None]
    label = stand_on(city.scene.meshes.get("ground"), spots.reshape(-1, 2)).label
    walked = np.isin(label, [LABEL[name] for name in SIDEWALK]).reshape(count, -1)
    share = walked.mean(axis=0)
    if not share.any():
        return 0.0, 0.0
    good = np.flatnonzero(share >= 0.9 * share.max())
    # The strip nearest to the street: beyond it may lie another street's.
    strip = good[: int(np.argmax(np.append(np.diff(good) > 1, True))) + 1]
    return float(share.max()), side * float(offsets[strip].mean())


def beside(path: Path, offset: float) -> Path:
    """Return a path shifted sideways, left > 0, metres; its loops and corners are kept clean."""
    if abs(offset) < 1e-9:
        return path
    if path.closed:
        return replace(path, points=_ring_beside(path.points, offset))
    line = shapely.offset_curve(path.line, offset, join_style="mitre", mitre_limit=MITRE)
    parts = shapely.get_parts(line)
    return replace(path, points=shapely.get_coordinates(parts[np.argmax(shapely.length(parts))]))


def _ring_beside(ring: FloatArray, offset: float) -> FloatArray:
    """Return a ring shifted to the left (> 0), in its own direction, from near its own start."""
    inward = offset if shapely.is_ccw(shapely.linearrings(ring)) else -offset
    grown = shapely.buffer(shapely.polygons(ring), -inward, join_style="mitre", mitre_limit=MITRE)
    parts = shapely.get_parts(grown)
    xy = shapely.get_coordinates(parts[np.argmax(shapely.area(parts))].exterior)[:-1]
    if shapely.is_ccw(shapely.linearrings(xy)) != shapely.is_ccw(shapely.linearrings(ring)):
        xy = xy[::-1]
    return np.roll(xy, -int(np.argmin(np.hypot(*(xy - ring[0]).T))), axis=0)


def drivable(city: City, path: Path) -> Path:
    """Return the line vehicles follow along a path: of a street, the middle of its lane.

    Raises
    ------
    ActionFailed
        If nothing drives along it.
    """
    if not path.roads:
        return path
    if not path.street:
        raise ActionFailed(
            f'"{path.name}" is a way for people, no vehicle drives along it. Name a street.'
        )
    forward, backward = _lane_offsets(city, path)
    if np.isnan(forward) and np.isnan(backward):
        return path
    if np.isnan(forward):  # a one-way street, drawn against its direction
        return beside(replace(path, points=path.points[::-1]), backward)
    return beside(path, forward)


def _lane_offsets(city: City, path: Path) -> tuple[float, float]:
    """Return the offsets, left > 0, of the outer lanes along and against a path; NaN for none."""
    network, graph = city.network, city.lanes
    if network is None or graph is None:
        return np.nan, np.nan
    edges = np.flatnonzero(np.isin(network.edge_road, path.roads))
    line = path.line
    found: dict[int, list[tuple[float, float]]] = {1: [], -1: []}
    driven = np.isin(graph.kind, [KIND[name] for name in TRAVELLED]) & (graph.direction != 0)
    for edge in edges.tolist():
        points = network.edge_points(edge)
        at = shapely.line_locate_point(line, shapely.points(points[[0, -1]]))
        sense = 1 if at[1] >= at[0] else -1
        rows = np.flatnonzero(driven & (graph.edge == edge))
        hand = -1.0 if network.left_hand[edge] else 1.0
        for way in (1, -1):
            lanes = rows[graph.direction[rows] == way * sense]
            if len(lanes):
                middle = (graph.left[lanes] + graph.right[lanes]) / 2
                # The outer lane: farthest to the right of its own direction, where one keeps right.
                outer = middle[np.argmin(hand * way * sense * middle)]
                weight = float(np.hypot(*np.diff(points, axis=0).T).sum())
                found[way].append((float(outer) * way * sense, weight))
    return tuple(_weighted_median(found[way]) for way in (1, -1))  # type: ignore[return-value]


def _weighted_median(pairs: list[tuple[float, float]]) -> float:
    if not pairs:
        return float("nan")
    values, weights = np.array(sorted(pairs)).T
    return float(values[np.searchsorted(np.cumsum(weights), weights.sum() / 2)])
