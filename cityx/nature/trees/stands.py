"""Stands: trees with their places and species, and the rows of a layer that they become."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.assets.trees.seasons import SNOWED
from cityx.assets.trees.species import OUTSIDE_TREES
from cityx.city import City, Instances, Prototype
from cityx.errors import nearest
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.geometry.clearance import near_any
from cityx.geometry.scatter import Points
from cityx.ground.pieces import heights
from cityx.ground.standing import earth_over
from cityx.ids import choose, hash_ids, uniform
from cityx.nature.trees.climate import season_of
from cityx.nature.trees.tree_room import FREE_LEAVES, TALLEST, Room, beside_street, fitted
from cityx.places.profile import Profile
from cityx.places.profiles import climate_of, profile_names, profile_of
from cityx.system.extensions import refuse

STREAM = "nature/trees-v2"  # that every draw for a tree is keyed by, whoever plants it

NEAR_LIMIT = 20_000  # trees with many leaves; beyond, all take the light form
SEEN = 60.0  # metres from a way or a house within which one sees the leaves of a wood's trees

SPECIES = ("lime", "plane", "maple", "oak", "chestnut", "birch", "cherry", "ginkgo", "zelkova",
           "camphor", "poplar", "willow", "jacaranda", "acacia", "olive", "pine", "spruce",
           "cypress", "palm", "shrub", "boxwood", "grove", *OUTSIDE_TREES)  # fmt: skip
CLIMATES = ("north", "temperate", "japan", "warm", "tropic")
BUSHES = ("shrub", "boxwood")
ASPECT = 0.16  # logarithm of the ratio by which a crown is longer than broad, or broader, at most
# Factor of brightness of the darkest tree, of the brightest, and how far their hue goes from blue
# to yellow green: rows beside streets were planted alike, trees of parks and yards were not.
ROW_TINTS, FREE_TINTS = (0.84, 1.24, 1.0), (0.66, 1.42, 1.7)
YELLOW = np.array([0.30, 0.08, -0.16])  # by which a yellower tree differs, per colour
LEANS = (0.022, 0.045)  # radians, most of trees beside streets and of others
INDEX = {name: index for index, name in enumerate(SPECIES)}
UPRIGHT = [INDEX[name] for name in (*BUSHES, "grove")]
ALONG = 1.8  # times as wide along a wall as towards it a crown is at most
CORNERS = 16  # of the outline by which a crown is held against walls


@dataclass(frozen=True)
class Stand:
    """Trees that share an origin; (n,) each. Heights of NaN are drawn later."""

    xy: FloatArray
    id: NDArray[np.uint64]
    species: IntArray
    height: FloatArray
    mapped: BoolArray
    light: BoolArray
    line: NDArray[np.uint64]  # id of the row or street side by side with others, or 0
    place: IntArray  # number along it


_COLUMNS = ("xy", "id", "species", "height", "mapped", "light", "line", "place")


def stand_of(
    points: Points,
    species: Any,
    height: Any = np.nan,
    *,
    mapped: bool = False,
    light: bool = False,
    line: Any = 0,
    place: Any = 0,
) -> Stand:
    """Make a stand; `species` to `place` hold for each tree or for all."""
    count = len(points.id)
    return Stand(points.xy.reshape(-1, 2), points.id, np.broadcast_to(species, (count,)),
                  np.broadcast_to(np.asarray(height, float), (count,)), np.full(count, mapped),
                  np.full(count, light), np.broadcast_to(np.asarray(line, np.uint64), (count,)),
                  np.broadcast_to(np.asarray(place, np.int64), (count,)))  # fmt: skip


def join_stands(stands: list[Stand]) -> Stand:
    """Put stands one after the other."""
    return Stand(*(np.concatenate([getattr(s, name) for s in stands]) for name in _COLUMNS))


def take_trees(stand: Stand, keep: Any) -> Stand:
    """Return some trees, by mask or by index."""
    return Stand(*(getattr(stand, name)[keep] for name in _COLUMNS))


def draw_species(where: str, city: City, ids: NDArray[np.uint64]) -> IntArray:
    """Draw species of a "street", "park", "orchard", or "broad" or "needle" wood of the place."""
    profile, climate = profile_of(city.frame), climate_of(city.frame)
    mix = {**getattr(profile.trees, where)[climate], **outside_mix(where, profile, climate)}
    table = np.array([INDEX[name] for name in mix])
    return table[choose(city.seed, "nature/species", ids, list(mix.values()))]


def outside_mix(where: str, profile: Profile, climate: str) -> Mapping[str, float]:
    """Return the weights of species of installed packages on streets and in parks of a place."""
    if where not in ("street", "park") or not OUTSIDE_TREES:
        return {}
    places = (climate, *profile.lineage)
    known = {*CLIMATES, *profile_names()}
    found = {}
    for name, tree in OUTSIDE_TREES.items():
        said = tree.streets if where == "street" else tree.parks
        for place in sorted(set(said) - known):
            refuse(f'Species "{name}": "{place}" is no climate or place.{nearest(place, known)}')
        weight = max((said[place] for place in places if place in said), default=0.0)
        if weight > 0:
            found[name] = float(weight)
    return found


def forms_of(city: City, stand: Stand) -> NDArray[np.object_]:
    """(n,) the form that each tree takes: by the level of detail, and of masses by who sees them.

    Where more trees than a scene bears would show their leaves, all of them are light.
    """
    near = "fine" if city.lod > 2 else "near" if city.lod > 1 else "light"
    found = np.full(len(stand.id), near, object)
    found[stand.light] = "far" if city.lod < 2 else "light"
    if city.lod > 1:
        rows = np.flatnonzero(stand.light)
        layout = city.layout
        shapes = [table.geometry.to_numpy() for table in (layout.roads, layout.buildings)]
        found[rows[near_any(stand.xy[rows], np.concatenate(shapes), SEEN)]] = "near"
    for mass in (False, True):
        leafy = (stand.light == mass) & ~np.isin(found, ("far", "light"))
        if np.count_nonzero(leafy) > NEAR_LIMIT:
            found[leafy] = "light"
    return found


def rows_of(
    city: City, stand: Stand, room: Room, season: str = "auto"
) -> tuple[list[Prototype], Instances]:
    """Return trees as rows of a layer, with the prototypes that the rows count.

    Parameters
    ----------
    city
        Where they stand.
    stand
        The trees.
    room
        The room of each.
    season
        As of `trees`.
    """
    now = season
    if season == "auto":
        snowed = city.environment.snow > SNOWED
        now = "winter" if snowed else season_of(city.environment.day, city.frame)
    street = beside_street(room)
    variant = _variants(stand, street)
    up, wide, fixed = _wished(city, stand, _sizes(stand, variant), street)
    crowded = crowded_by_walls(wide, _sizes(stand, variant), room)
    crowded &= ~stand.light & ~np.isin(stand.species, UPRIGHT)
    variant = _beside_walls(variant, crowded)
    prototypes, number = _prototypes(stand, variant, forms_of(city, stand), now)
    shade = uniform(city.seed, f"{STREAM}/tint", stand.id)
    warm = uniform(city.seed, f"{STREAM}/tint", stand.id, 1)
    tint = _tints(street, shade, warm)
    turn = np.zeros((len(stand.id), 3), np.float32)
    # Trunks lean a little to one side; those pruned beside streets less.
    lean = np.where(street, *LEANS) * np.where(np.isin(stand.species, UPRIGHT), 0.0, 1.0)
    for axis in (0, 1):
        draw = uniform(city.seed, f"{STREAM}/lean", stand.id, axis)
        turn[:, axis] = lean * (2 * draw - 1)
    aspect = np.exp(ASPECT * (2 * uniform(city.seed, f"{STREAM}/aspect", stand.id) - 1))
    aspect = np.where(np.isin(stand.species, UPRIGHT), 1.0, aspect)
    yaw = uniform(city.seed, f"{STREAM}/yaw", stand.id) * 2 * np.pi
    scale, turn[:, 2] = fitted_crowns(
        city, stand.xy, np.column_stack([up, wide, aspect, yaw]), _sizes(stand, variant), room,
        fixed=fixed, crowded=crowded,
    )  # fmt: skip
    # Whoever stands beside a wall leans to the light, away from it.
    turn[crowded, 0], turn[crowded, 1] = 0.0, -np.hypot(*turn[crowded, :2].T)
    _as_groves(city, stand, scale)
    z = heights(city, stand.xy)
    z = np.fmax(z, earth_over(city.scene.meshes.get("structures"), stand.xy))
    return prototypes, Instances(
        number,
        stand.id,
        np.zeros(len(stand.id), np.uint64),
        np.column_stack([stand.xy, z]),
        turn,
        scale.astype(np.float32),
        tint.astype(np.float32),
    )


def _tints(street: BoolArray, shade: FloatArray, warm: FloatArray) -> FloatArray:
    """(n, 3) factors of the colours of trees, by two draws each."""
    low, high, hue = np.where(street[:, None], ROW_TINTS, FREE_TINTS).T
    bright = low + (high - low) * shade
    return np.asarray(bright[:, None] * (1 + (hue * (warm - 0.5))[:, None] * YELLOW))


def _variants(stand: Stand, street: BoolArray) -> IntArray:
    """(n,) number of the individual each tree is; along a row no two neighbours are the same."""
    from cityx.assets.trees import individuals

    table = np.array([[individuals(name, street=side) for side in (False, True)]
                      for name in SPECIES])  # fmt: skip
    first, count = table[stand.species, street.astype(int)].T  # (n,) each
    turn = (stand.id >> np.uint64(8)).astype(np.int64) & 0xFFFF
    order = np.lexsort((stand.place, stand.line))
    line = stand.line[order]
    rank = np.arange(len(line)) - np.searchsorted(line, line)
    start = (hash_ids(0, STREAM, line) >> np.uint64(48)).astype(np.int64)
    turn[order] = np.where(line > 0, start + rank, turn[order])
    return np.asarray(first + turn % count)


def _prototypes(
    stand: Stand, variant: IntArray, forms: NDArray[np.object_], season: str
) -> tuple[list[Prototype], NDArray[np.int32]]:
    """Make the prototypes in use and number them."""
    from cityx.assets.trees import plant

    names, form = np.unique(forms.astype(str), return_inverse=True)
    code = (stand.species * 64 + variant) * len(names) + form
    used, number = np.unique(code, return_inverse=True)
    found = [
        plant(SPECIES[grown // 64], grown % 64, str(names[look]), season)
        for grown, look in (divmod(value, len(names)) for value in used.tolist())
    ]
    return found, number.astype(np.int32)


def _beside_walls(variant: IntArray, crowded: BoolArray) -> IntArray:
    """(n,) individuals, for crowded street trees those that have grown beside a wall."""
    from cityx.assets.trees import PARK_FORMS, WALLED, WALLED_FORMS

    pressed = WALLED + (variant - PARK_FORMS) % WALLED_FORMS
    return np.where(crowded & (variant >= PARK_FORMS), pressed, variant)


def _sizes(stand: Stand, variant: IntArray) -> FloatArray:
    """(n, 4) height, crown radius, clear stem and reach to a wall of plants as grown, metres."""
    from cityx.assets.trees import size_of, wall_reach

    used, number = np.unique(stand.species * 64 + variant, return_inverse=True)
    grown = [(SPECIES[value // 64], value % 64) for value in used.tolist()]
    table = [(*size_of(*each), wall_reach(*each)) for each in grown]
    return np.array(table, float).reshape(-1, 4)[number]


def _wished(
    city: City, stand: Stand, size: FloatArray, street: BoolArray
) -> tuple[FloatArray, FloatArray, BoolArray]:
    """(n,) scales of height and of width, by the mapped height or drawn; which are mapped."""
    draw = uniform(city.seed, f"{STREAM}/size", stand.id)
    known = np.isfinite(stand.height) & (stand.height > 0)
    drawn = np.where(street, 0.90 + 0.25 * draw, 0.66 + 0.60 * draw)
    up = np.where(known, np.clip(np.where(known, stand.height, 1.0) / size[:, 0], 0.35, 1.9), drawn)
    wide = np.where(known, up**0.7, up) * (0.9 + 0.2 * uniform(city.seed, f"{STREAM}/w", stand.id))
    return up, wide, known


def _as_groves(city: City, stand: Stand, scale: FloatArray) -> None:
    """Write the scales of groves, whose breadth is the distance to the next, into (n, 3) scales."""
    from cityx.assets.trees.bushes import GROVE_EDGE

    grove = stand.species == INDEX["grove"]
    scale[grove, 2] = 0.8 + 0.4 * uniform(city.seed, f"{STREAM}/size", stand.id[grove])
    scale[grove, :2] = np.clip(stand.height[grove] / GROVE_EDGE, 0.6, 1.8)[:, None]


def crowded_by_walls(wide: FloatArray, size: FloatArray, room: Room) -> BoolArray:
    """(n,) whether crowns of a wished scale of width would reach a facade."""
    return np.asarray(wide * size[:, 1] > room.facade - FREE_LEAVES)


def fitted_crowns(
    city: City,
    xy: FloatArray,
    wished: FloatArray,
    size: FloatArray,
    room: Room,
    *,
    fixed: BoolArray,
    crowded: BoolArray,
) -> tuple[FloatArray, FloatArray]:
    """Fit crowns into their room, each side of them by itself where a wall is near.

    Parameters
    ----------
    city
        City with its buildings.
    xy
        (n, 2) float, trunks, metres.
    wished
        (n, 4) float: scale of height, of width, length of the crown over its breadth, and the turn
        about the stem in radians.
    size
        (n, 4) float, metres, as of `cityx.nature.trees.tree_room.fitted`.
    room
        Of the trees.
    fixed
        (n,) bool, trees whose height is mapped.
    crowded
        (n,) bool, trees that face a wall: their +x side turns to it.

    Returns
    -------
    scale, yaw
        (n, 3) and (n,) float.
    """
    tall, broad, aspect, yaw = wished.T
    up, wide = fitted(
        tall, broad * np.sqrt(np.maximum(aspect, 1 / aspect)), size, room, fixed=fixed
    )
    scale = np.column_stack([wide * np.minimum(1, aspect), wide / np.maximum(1, aspect), up])
    rows = np.flatnonzero(crowded)
    if not len(rows):
        return scale, yaw
    houses = city.layout.buildings.geometry.to_numpy()
    tree = shapely.STRtree(houses)
    spots = shapely.points(xy[rows])
    nearest = tree.query_nearest(spots, all_matches=False)[1]
    foot = shapely.get_coordinates(shapely.shortest_line(spots, houses[nearest])).reshape(-1, 2, 2)
    out = foot[:, 1] - foot[:, 0]
    yaw = yaw.copy()
    yaw[rows] = np.arctan2(out[:, 1], out[:, 0])
    _, reach, _, to_wall = size[rows].T
    deep = wide[rows]
    along = np.minimum(broad[rows], ALONG * deep)
    # What still meets another wall, as in a corner, is as narrow on all sides.
    outline = _outlines(xy[rows], yaw[rows], deep, along, reach, to_wall)
    met = np.unique(tree.query(outline, predicate="intersects")[0])
    least = np.minimum(deep, np.maximum(room.facade[rows] - FREE_LEAVES, 0.1) / reach)
    deep[met], along[met] = least[met], least[met]
    scale[rows] = np.column_stack([deep, along, np.minimum(up[rows], TALLEST * along)])
    return scale, yaw


def _outlines(
    xy: FloatArray,
    yaw: FloatArray,
    deep: FloatArray,
    along: FloatArray,
    reach: FloatArray,
    to_wall: FloatArray,
) -> NDArray[np.object_]:
    """(n,) polygons of crowns seen from above: half ellipses towards the wall and away from it."""
    angle = np.arange(CORNERS) * (2 * np.pi / CORNERS)
    ahead = np.where(np.cos(angle) > 0, to_wall[:, None], reach[:, None]) * np.cos(angle)
    x, y = deep[:, None] * ahead, (along * reach)[:, None] * np.sin(angle)  # (n, k)
    cos, sin = np.cos(yaw)[:, None], np.sin(yaw)[:, None]
    turned = np.stack([cos * x - sin * y, sin * x + cos * y], axis=2)
    return np.asarray(shapely.polygons(xy[:, None, :] + turned))
