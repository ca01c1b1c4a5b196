"""Yards: lawns, gravel, beds and car parks that break the paving between houses in town."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.ground import LABEL
from cityx.city.layout import Layout, in_town
from cityx.city.roads import RoadNetwork
from cityx.digests import arrays_digest
from cityx.geometry.arrangement import Regions, regions
from cityx.geometry.clearance import near_any
from cityx.geometry.identity import choose, uniform
from cityx.geometry.polylines import to_linestrings
from cityx.geometry.scatter import Points, candidates, cells_about, thin
from cityx.remembered import Remembered

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

PURPOSE = "ground/patch"
NEAR_SPACING, OPEN_SPACING = 5.5, 13.0  # metres between the middles of patches
REACH = 12.0  # metres from a house within which its yard lies
OPEN_REACH = 90.0  # metres from a house of a town up to which land that houses left is its own
# Metres from walls, carriageways and paths that stay free for those who walk.
USUAL_GAPS = (1.6, 4.5, 2.0)
# Where land is dear cars stand up to the wall, and right behind the walk.
GAPS: Mapping[str, tuple[float, float, float]] = MappingProxyType({
    "japan": (0.7, 3.3, 1.2), "east asia": (1.0, 4.0, 1.5),
})  # fmt: skip
# What patches are made of; each hides those before it.
LABELS = ("", "grass", "gravel", "bare", "parking")
# How often by the kind of place; lawns are for the north, gravel and cars for where land is dear.
USUAL_SHARES = (2.0, 5.0, 1.5, 1.0, 3.0)
SHARES: Mapping[str, tuple[float, ...]] = MappingProxyType({
    "northern/central europe": (0.6, 9.0, 1.5, 1.5, 1.8),
    "british isles": (2.0, 4.0, 2.0, 1.5, 2.5),
    "japan": (0.8, 2.5, 2.5, 2.2, 4.5), "east asia": (2.0, 2.0, 2.5, 1.0, 4.0),
    "mediterranean": (2.5, 2.0, 3.0, 2.5, 3.0),
})  # fmt: skip
# Metres along and across, from the least to the largest, about houses and away from them.
NEAR_SIZES = (((0.0, 0.0), (0.0, 0.0)), ((4.0, 11.0), (2.5, 6.0)), ((3.0, 9.0), (1.6, 4.5)),
              ((3.0, 7.0), (1.4, 3.0)), ((7.5, 15.0), (5.0, 5.0)))  # fmt: skip
OPEN_SIZES = (((0.0, 0.0), (0.0, 0.0)), ((13.0, 30.0), (11.0, 22.0)), ((9.0, 20.0), (8.0, 15.0)),
              ((6.0, 14.0), (3.0, 9.0)), ((15.0, 35.0), (16.0, 16.0)))  # fmt: skip
BAY, STALL = 2.5, 5.0  # metres, width and length of a parking bay
SHRUNK = (0.35, 0.6, 1.0)  # shares of its size at which a patch is tried; the largest wins
PRIORITY = 2  # of the first label; all lie below gardens and what a map shows


@dataclass(frozen=True)
class Patches:
    """Rectangles in yards, p of them.

    Attributes
    ----------
    id
        (p,) uint64.
    middle
        (p, 2) float.
    along
        (p, 2) float, unit vector of the long side, which is that of the nearest house.
    size
        (p, 2) float, metres along and across.
    label
        (p,) label of the ground.
    """

    id: NDArray[np.uint64]
    middle: FloatArray
    along: FloatArray
    size: FloatArray
    label: NDArray[np.int64]

    def take(self, rows: Any) -> Patches:
        """Return the given patches (indices or mask)."""
        return Patches(self.id[rows], self.middle[rows], self.along[rows], self.size[rows],
                       self.label[rows])  # fmt: skip

    def labelled(self, name: str) -> Patches:
        """Return the patches of one label, by name."""
        return self.take(self.label == LABEL[name])

    @property
    def shapes(self) -> NDArray[Any]:
        """(p,) polygons."""
        u = self.along * self.size[:, :1] / 2
        v = np.column_stack([-self.along[:, 1], self.along[:, 0]]) * self.size[:, 1:] / 2
        corners = np.stack([-u - v, u - v, u + v, v - u], axis=1) + self.middle[:, None]
        return np.asarray(shapely.polygons(corners))


_LAST: Remembered[Patches] = Remembered()


def yard_patches(layout: Layout, network: RoadNetwork, place: str = "") -> Patches:
    """Draw patches between the houses of towns, clear of walls, streets and paths.

    They depend on their place alone, and on what is near. Those of the last layout are remembered.

    Parameters
    ----------
    layout
        The layout.
    network
        Its roads.
    place
        The kind of place, as of `cityx.plugins.nature.street_rules.place_of`.
    """
    key = place, layout.extent, grounds_digest(layout, network)
    return _LAST.get(lambda: _drawn(layout, network, place), [layout.roads], *key)


def grounds_digest(layout: Layout, network: RoadNetwork) -> bytes:
    """Return a hash of the houses and streets that what is drawn between them depends on."""
    houses = layout.buildings
    urban = in_town(houses)
    lines = network.points, network.point_start, network.half_width, network.edge_road
    return arrays_digest(houses.geometry.to_numpy(), urban, network.edge_id, *lines)


def _drawn(layout: Layout, network: RoadNetwork, place: str) -> Patches:
    buildings = layout.buildings
    houses = buildings.geometry.to_numpy()
    urban = houses[in_town(buildings)]
    if not len(urban):
        none = np.zeros((0, 2))
        return Patches(np.zeros(0, np.uint64), none, none, none, np.zeros(0, np.int64))
    weights, gaps = SHARES.get(place, USUAL_SHARES), GAPS.get(place, USUAL_GAPS)
    found = []
    for number, (spacing, reach, sizes) in enumerate(
        ((NEAR_SPACING, REACH, NEAR_SIZES), (OPEN_SPACING, OPEN_REACH, OPEN_SIZES))
    ):
        purpose = f"{PURPOSE}/{number}"
        cells = cells_about(shapely.bounds(urban), spacing, reach)
        points = candidates(cells, spacing, seed=0, purpose=purpose)
        # The site's rectangle cuts patches; beyond it nobody sees them.
        xmin, ymin, xmax, ymax = layout.extent
        x, y = points.xy.T
        inside = (x > xmin - reach) & (x < xmax + reach) & (y > ymin - reach) & (y < ymax + reach)
        points = thin(Points(points.xy[inside], points.id[inside]), spacing)
        kind = choose(0, purpose, points.id, list(weights))
        wanted = np.flatnonzero(kind)
        points, kind = Points(points.xy[wanted], points.id[wanted]), kind[wanted]
        near = near_any(points.xy, houses, REACH)
        some = ~near if number else near & ~near_any(points.xy, houses, gaps[0])
        ids, middle, kind = points.id[some], points.xy[some], kind[some]
        drawn = np.column_stack([uniform(0, f"{purpose}/{side}", ids) for side in ("long", "deep")])
        low, high = np.array(sizes)[kind].transpose(2, 0, 1)  # (p, 2) each
        size = low + drawn * (high - low)
        label = np.array([LABEL[name or "courtyard"] for name in LABELS])[kind]
        bays = label == LABEL["parking"]
        size[bays, 0] = np.round(size[bays, 0] / BAY) * BAY
        near = shapely.STRtree(houses).query_nearest(shapely.points(middle), all_matches=False)[1]
        house, row = np.unique(near, return_inverse=True)
        found.append(Patches(ids, middle, _long_sides(houses[house])[row], size, label))
    names = ("id", "middle", "along", "size", "label")
    joined = Patches(*(np.concatenate([getattr(part, name) for part in found]) for name in names))
    return _fitted(joined, layout, network, gaps)


def _fitted(
    patches: Patches, layout: Layout, network: RoadNetwork, gaps: tuple[float, float, float]
) -> Patches:
    """Return the patches that have room, each at the largest of its sizes that does."""
    least = _shrunk(patches, SHRUNK[0])
    fits = _clear(least.shapes, layout, network, gaps)
    patches, fitted = patches.take(fits), least.take(fits)
    for share in SHRUNK[1:]:
        larger = _shrunk(patches, share)
        fits = _clear(larger.shapes, layout, network, gaps)
        fitted = replace(fitted, size=np.where(fits[:, None], larger.size, fitted.size))
    return fitted


def _shrunk(patches: Patches, share: float) -> Patches:
    """Return smaller patches; a row of bays has fewer of them, not smaller ones."""
    size = share * patches.size
    bays = patches.label == LABEL["parking"]
    size[bays, 0] = np.maximum(np.round(size[bays, 0] / BAY), 1) * BAY
    # Half of a car park is one row of bays; a single one keeps its depth.
    size[bays, 1] = np.where(size[bays, 1] < patches.size[bays, 1] - 1e-9, STALL, size[bays, 1])
    return replace(patches, size=size)


def _long_sides(shapes: NDArray[Any]) -> FloatArray:
    """(p, 2) unit vectors along the long sides of the least rectangles about shapes."""
    corners = [shapely.get_coordinates(box)[:3] for box in shapely.oriented_envelope(shapes)]
    ring = np.array([c if len(c) == 3 else np.eye(3, 2) for c in corners])
    sides = ring[:, 1:] - ring[:, :-1]  # (p, 2, 2)
    length = np.hypot(sides[..., 0], sides[..., 1])
    long = np.take_along_axis(sides, length.argmax(axis=1)[:, None, None], axis=1)[:, 0]
    return np.asarray(long / np.maximum(length.max(axis=1), 1e-9)[:, None])


def _clear(
    shapes: NDArray[Any], layout: Layout, network: RoadNetwork, gaps: tuple[float, float, float]
) -> BoolArray:
    """(p,) whether patches keep their distances from walls, streets and paths."""
    from_wall, from_street, from_path = gaps
    clear = np.ones(len(shapes), bool)
    centre = to_linestrings(network.lines)
    tree = shapely.STRtree(shapes)
    paths = np.delete(layout.roads.geometry.to_numpy(), np.unique(network.edge_road))
    for things, gap in (
        (layout.buildings.geometry.to_numpy(), from_wall),
        (paths, from_path),
        (centre, network.half_width + from_street),
    ):
        reach = np.broadcast_to(np.asarray(gap, float), len(things))
        clear[tree.query(things, predicate="dwithin", distance=reach)[1]] = False
    return clear


def patch_regions(layout: Layout, network: RoadNetwork, place: str = "") -> Regions:
    """Return the patches as regions of the ground."""
    patches = yard_patches(layout, network, place)
    rank = np.array([LABEL[name or "courtyard"] for name in LABELS])
    order = (patches.label[:, None] == rank).argmax(axis=1)
    return regions(patches.shapes, patches.label, PRIORITY + order)
