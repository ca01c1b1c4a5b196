"""The plan "orbit": once round a building, always looking at it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cityx.city.mesh import MeshBatch
from cityx.dataset.plans.plan_site import Site
from cityx.dataset.plans.takes import Refusal, Source, Take
from cityx.errors import UsageError, nearest
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.ids import id_text, uniform

FOV = 60.0  # degrees
ROOM = 1.1  # times as far as where the target just fills the picture
_FARTHER = (1.0, 1.8)  # times that distance
_ELEVATION = (8.0, 40.0)  # degrees of the eye over the middle of the target
LOWEST = 2.0  # metres of an eye above the ground, at least
CLEAR = 1.0  # metres round the eye that must be free
MIDDLE = 15.0  # metres of half the box that an orbit round the middle of a city looks at
INNER = 0.8  # of the box of a target, in which the points lie that must be seen
LAYERS = ("buildings", "structures", "bridges", "barriers")  # of meshes that one may go round


@dataclass(frozen=True)
class _Target:
    """What is looked at: its box, and its id, 0 where it is a place alone."""

    object_id: int
    low: FloatArray
    high: FloatArray

    @property
    def middle(self) -> FloatArray:
        return (self.low + self.high) / 2

    def points(self) -> FloatArray:
        """(k, 3) points within the box, to measure how much of it is visible."""
        share = (np.arange(3) + 0.5) / 3 * 2 - 1
        grid = np.stack(np.meshgrid(share, share, share), axis=-1).reshape(-1, 3)
        return np.asarray(self.middle + grid * INNER * (self.high - self.low) / 2)


def orbit(site: Site) -> Source:
    """Return the source of orbits: circles of other sizes, heights and beginnings.

    Raises
    ------
    UsageError
        If there is no such target.
    """
    wishes = site.wishes
    target = _target(site)
    hfov = wishes.fov(FOV)
    width, height = wishes.size
    half = min(hfov / 2, np.arctan(np.tan(hfov / 2) * height / width))
    size = float(np.linalg.norm(target.high - target.low)) / 2
    fits = ROOM * size / np.sin(half)

    def candidates(numbers: IntArray) -> list[Take | Refusal]:
        drawn = uniform(wishes.seed, "dataset/orbit", numbers[:, None], np.arange(4))
        far = fits * (_FARTHER[0] + (_FARTHER[1] - _FARTHER[0]) * drawn[:, 0])
        lift = np.radians(_ELEVATION[0] + (_ELEVATION[1] - _ELEVATION[0]) * drawn[:, 1])
        moments = site.moments(numbers)
        return [
            _circle(site, target, float(far[row]), float(lift[row]), drawn[row, 2:], moments[row],
                    hfov)
            for row in range(len(numbers))
        ]  # fmt: skip

    return candidates


def _circle(
    site: Site, target: _Target, far: float, lift: float, drawn: FloatArray, moment: float,
    hfov: float,
) -> Take:  # fmt: skip
    wishes = site.wishes
    radius = wishes.radius if wishes.radius is not None else far * np.cos(lift)
    turn = 1.0 if drawn[1] < 0.5 else -1.0
    step = np.arange(wishes.length)
    angle = 2 * np.pi * (drawn[0] + turn * step / max(wishes.length, 1))
    spot = target.middle[:2] + radius * np.column_stack([np.sin(angle), np.cos(angle)])
    ground = float(site.city.terrain.height_at(target.middle[None, :2])[0])
    z = max(target.middle[2] + far * np.sin(lift), ground + LOWEST)
    if wishes.height is not None:
        z = ground + wishes.height
    way = target.middle - np.column_stack([spot, np.full(len(spot), z)])
    return Take(
        np.column_stack([spot, np.full(len(spot), z)]),
        np.unwrap(np.arctan2(way[:, 0], way[:, 1])),
        np.arctan2(way[:, 2], np.hypot(way[:, 0], way[:, 1])),
        moment + step / wishes.rate, hfov, target=target.points(), target_id=target.object_id,
        clearance=CLEAR,
    )  # fmt: skip


def _target(site: Site) -> _Target:
    word = site.wishes.target.strip()
    city = site.city
    if word == "middle":
        return _middle(site)
    batches = [city.scene.meshes[name] for name in LAYERS if name in city.scene.meshes]
    boxes = [box for batch in batches for box in _boxes(batch)]
    if word == "tallest":
        houses = _boxes(city.scene.meshes["buildings"]) if "buildings" in city.scene.meshes else []
        if not houses:
            return _middle(site)
        return max(
            houses, key=lambda box: (round(float(box.high[2] - box.low[2]), 3), box.object_id)
        )
    table = city.layout.buildings
    names = {
        str(name).casefold(): int(own)
        for own, name in zip(table["id"], table["name"], strict=True)
        if name
    }
    ids = {id_text(box.object_id): box for box in boxes}
    box = ids.get(word.lower()) or ids.get(id_text(names.get(word.casefold(), 0)))
    if box is None:
        known = [*sorted(names), "tallest", "middle"]
        raise UsageError(
            f'"{word}" is neither "tallest", "middle" nor the name or id of a building of '
            f"{city.name}.{nearest(word.casefold(), known)}"
        )
    return box


def _middle(site: Site) -> _Target:
    xmin, ymin, xmax, ymax = site.city.layout.extent
    spot = np.array([(xmin + xmax) / 2, (ymin + ymax) / 2])
    foot = np.append(spot, site.city.terrain.height_at(spot[None])[0])
    half = np.array([MIDDLE, MIDDLE, 0.0])
    return _Target(0, foot - half, foot + half + np.array([0.0, 0.0, MIDDLE]))


def _boxes(batch: MeshBatch) -> list[_Target]:
    filled = np.flatnonzero(np.diff(batch.vertex_start) > 0)
    if not len(filled):
        return []
    begin = batch.vertex_start[:-1][filled]
    low, high = (
        np.minimum.reduceat(batch.vertices, begin),
        np.maximum.reduceat(batch.vertices, begin),
    )
    return [
        _Target(int(own), a, b)
        for own, a, b in zip(batch.object_id[filled], low, high, strict=True)
    ]
