"""Asset placement: buildings of the library on the outlines of a city, as instances."""

from __future__ import annotations

import logging
from dataclasses import replace
from typing import Annotated, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.assets.library.choice import NONE
from cityx.assets.library.fit import REASONS, Lots, Placement, Targets, assets_of, place, targets_of
from cityx.assets.library.models import Models, turns
from cityx.assets.library.paper_placement import place_as_paper
from cityx.assets.library.shelves import Shelf, shelf_of, text_scores
from cityx.assets.styles.palettes import GROUPS, family_of, groups_of
from cityx.building.facade.fronts import STREETS
from cityx.building.splicing import with_rows, without
from cityx.building.volumes import volumes_of
from cityx.city.city import City
from cityx.city.rows import take_rows
from cityx.city.scene import Instances, Scene
from cityx.errors import ActionFailed
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.ids import hash_ids, id_text, uniform
from cityx.places.profiles import profile_of
from cityx.protocol import InputFiles, Range, action
from cityx.protocol.parameters import Choice

ACTION = "building/assets-v1"
LAYER = "building_assets"
NEAR = 0.5  # metres beyond a side wall at which a neighbour is looked for
PARTY_SHARE = 0.5  # of the places looked at along a side
VIEW = 0.6  # metres an opening needs free before it
_log = logging.getLogger(__name__)


@action(
    ACTION,
    limits=[
        "Outlines that fill less than three quarters of their rectangle keep their own building.",
        "Runs after the shells and facades: run before them, they would build everything again.",
        "Without a library among the input files it grows a small one of 128 buildings.",
        "Mode paper scales by the short side alone and checks no overlap.",
        "Buildings of several parts become one asset of the height of the whole.",
    ],
    requires=("layout",),
    labels=("building", "asset", "library", "retrieval", "placement"),
)
def assets(
    city: City,
    inputs: InputFiles,
    *,
    description: str = "",
    mode: Annotated[str, Choice("fit", "paper")] = "fit",
    share: Annotated[float, Range(0.0, 1.0)] = 1.0,
) -> City:
    """Replace buildings by assets of the library that fit their outlines, style and height.

    What no asset fits keeps the building it has; the notes of the city say how many and why.

    Parameters
    ----------
    inputs
        Files the user handed in; the first library among them is used.
    description
        Words the assets should agree with, such as "red brick with white windows".
    mode
        "fit": no overlap, no repetition nearby, fronts to the street. "paper": the published
        formulas to the letter.
    share
        Share of the buildings that are considered.
    """
    style = family_of(city.style, profile_of(city.frame).buildings.family)
    shelf = shelf_of(inputs, style)
    usable = np.flatnonzero(shelf.catalogue["group"] == "buildings")
    if not len(usable):
        raise ActionFailed("The library holds no buildings.")
    lots = lots_of(city)
    drawn = uniform(city.seed, "assets/share", lots.id) < share
    lots = take_lots(lots, np.flatnonzero(drawn))
    catalogue = shelf.catalogue.take(usable)
    score = text_scores(shelf, description)[usable] if description else None
    if mode == "paper":
        found = _as_paper(lots, catalogue, style, score)
    else:
        found = place(
            lots, assets_of(catalogue, score), seed=city.seed, style=style,
            obstacles=carriageways(city),
        )  # fmt: skip
    for number, why in zip(lots.id.tolist(), found.reason.tolist(), strict=True):
        if why:
            _log.info("%s left to the procedural generator: %s", id_text(number), REASONS[why])
    scene = put_into_scene(city, lots, found, shelf, usable)
    return replace(
        city,
        scene=scene,
        stages_done=city.stages_done | {"building"},
        notes=city.notes + _notes(found),
    )


def _notes(found: Placement) -> tuple[str, ...]:
    counts = found.counts()
    total = len(found.asset)
    placed = counts.pop(REASONS[0], 0)
    left = "; ".join(f"{number}: {text}" for text, number in counts.items())
    text = f"{placed} of {total} buildings are assets of the library"
    return (f"{text}; the others are procedural ({left})." if left else f"{text}.",)


def take_lots(lots: Lots, rows: Any) -> Lots:
    """Return some lots."""
    return Lots(**{name: getattr(lots, name)[rows] for name in lots.__dataclass_fields__})


def lots_of(city: City) -> Lots:
    """Return the outlines of a city's buildings as lots."""
    from cityx.geometry.polygons import clean_polygons

    table = city.layout.buildings
    polygons = clean_polygons(table.geometry.to_numpy())
    ids = table["id"].to_numpy(np.uint64)
    height = table["height"].to_numpy(float)
    bare = Lots(
        ids,
        polygons,
        street_directions(city, polygons),
        _uses(city, ids),
        np.where(height > 0, height, np.nan),
        np.zeros(len(ids), np.int64),
    )
    return replace(bare, party=party_sides(bare, targets_of(bare)))


def _uses(city: City, ids: NDArray[np.uint64]) -> NDArray[np.str_]:
    """Use group of every building: that of its lowest part by id."""
    parts = city.layout.parts
    group = groups_of(city.layout, city.seed)
    owner = parts["building"].to_numpy(np.uint64)
    first, row = np.unique(owner, return_index=True)
    use = np.full(len(ids), "", "U10")
    if len(first):
        at = np.minimum(np.searchsorted(first, ids), len(first) - 1)
        known = first[at] == ids
        use[known] = np.array(GROUPS)[group[row[at[known]]]]
    return use


def street_directions(city: City, polygons: NDArray[Any]) -> FloatArray:
    """Return the direction from each polygon to its nearest street, (n,) radians, NaN for none."""
    roads = city.layout.roads
    is_street = np.isin(roads["kind"].to_numpy(str), list(STREETS))
    is_street &= ~roads["tunnel"].to_numpy(bool)
    lines = roads.geometry.to_numpy()[is_street]
    out = np.full(len(polygons), np.nan)
    filled = np.flatnonzero(~shapely.is_empty(polygons))
    if not len(lines) or not len(filled):
        return out
    middle = shapely.centroid(polygons[filled])
    lot, road = shapely.STRtree(lines).query_nearest(middle, all_matches=False)
    way = shapely.get_coordinates(shapely.shortest_line(middle[lot], lines[road]))
    vector = way[1::2] - way[::2]
    known = np.hypot(*vector.T) > 0.01
    out[filled[lot[known]]] = np.arctan2(vector[known, 1], vector[known, 0])
    return out


def party_sides(lots: Lots, target: Targets) -> IntArray:
    """Find the sides at which another lot begins: 1 left, 2 right, 4 back; (n,)."""
    facing = np.column_stack([np.cos(target.facing), np.sin(target.facing)])
    left = np.column_stack([facing[:, 1], -facing[:, 0]])  # of someone who looks at the front
    party = np.zeros(len(lots), np.int64)
    tree = shapely.STRtree(lots.polygon)
    usable = target.front > 0
    for bit, normal, reach, along, side in (
        (1, left, target.front, facing, target.depth),
        (2, -left, target.front, facing, target.depth),
        (4, -facing, target.depth, left, target.front),
    ):
        seen = np.zeros(len(lots))
        for share in (-0.35, -0.1, 0.1, 0.35):
            at = target.centre + normal * (reach / 2 + NEAR)[:, None]
            at = at + along * (share * side)[:, None]
            point, lot = tree.query(shapely.points(at), predicate="within")
            seen[np.unique(point[point != lot])] += 0.25
        party |= np.where(usable & (seen > PARTY_SHARE), bit, 0)
    return party


def carriageways(city: City) -> NDArray[Any]:
    """Return the carriageways on the ground as polygons."""
    roads = city.layout.roads
    kept = np.isin(roads["kind"].to_numpy(str), list(STREETS))
    for name in ("tunnel", "bridge", "passage"):
        kept &= ~roads[name].to_numpy(bool)
    width = np.maximum(roads["width"].to_numpy(float)[kept], 0.0)
    return np.asarray(
        shapely.buffer(roads.geometry.to_numpy()[kept], width / 2, cap_style="flat", quad_segs=2)
    )


def _as_paper(lots: Lots, catalogue: Any, style: str, score: FloatArray | None) -> Placement:
    found = place_as_paper(
        lots.polygon, length=catalogue["length"], width=catalogue["width"],
        angle=catalogue["angle"], centre=np.column_stack([catalogue["x"], catalogue["y"]]),
        style=catalogue["style"].astype(str), wanted=style, score=score,
    )  # fmt: skip
    placed = found.asset >= 0
    return Placement(
        found.asset, found.alpha, found.theta, found.offset,
        np.where(placed, 0, 2), np.full(len(lots), None, object),
    )  # fmt: skip


# --- the scene ------------------------------------------------------------------------------------


def put_into_scene(
    city: City, lots: Lots, found: Placement, shelf: Shelf, usable: IntArray
) -> Scene:
    """Put placed assets into a scene in the place of the buildings that stood there.

    Parameters
    ----------
    city
        The city.
    lots, found
        Lots, and what stands on them; ``found.asset`` counts `usable`.
    shelf, usable
        Assets, and the rows of those that were considered.
    """
    placed = np.flatnonzero(found.asset != NONE)
    scene = without(city.scene, lots.id[placed])
    if not len(placed):
        return scene
    rows, number = np.unique(usable[found.asset[placed]], return_inverse=True)
    models = shelf.models(rows)
    hashes = shelf.catalogue["content_hash"][rows]
    names = [f"asset_{text}" if text else f"asset_{row}"
             for text, row in zip(hashes.tolist(), rows.tolist(), strict=True)]  # fmt: skip
    shells = [models.prototype(index, name) for index, name in enumerate(names)]
    ids = lots.id[placed]
    ground = _ground(city, ids)
    position = np.column_stack([found.offset[placed], ground])
    count = len(placed)
    turn = np.zeros((count, 3), np.float32)
    turn[:, 2] = found.theta[placed]
    scale = np.repeat(found.scale[placed].astype(np.float32)[:, None], 3, axis=1)
    table = Instances(
        number.astype(np.int32), ids, ids, position, turn, scale, np.ones((count, 3), np.float32)
    )
    scene = with_rows(scene, LAYER, shells, table)
    return _with_fittings(scene, city, lots, models.take(number), ids, table)


def _ground(city: City, ids: NDArray[np.uint64]) -> FloatArray:
    """Level of the ground of buildings, (k,)."""
    volumes = volumes_of(city.layout, city.terrain)
    known, row = np.unique(volumes.building, return_index=True)
    if not len(known):
        return np.zeros(len(ids))
    at = np.minimum(np.searchsorted(known, ids), len(known) - 1)
    return np.where(known[at] == ids, volumes.ground[row[at]], 0.0)


def _with_fittings(
    scene: Scene, city: City, lots: Lots, models: Models, ids: NDArray[np.uint64], at: Instances
) -> Scene:
    """Add the fittings of placed assets, each turned and scaled with its shell."""
    rows = models.fittings
    owner = rows.owner.astype(np.int64)
    turn = turns(at.rotation)[owner]
    factor = at.scale[owner, :1].astype(float)
    position = np.einsum("nij,nj->ni", turn, rows.position * factor) + at.position[owner]
    rotation = rows.rotation.copy()
    rotation[:, 2] += at.rotation[owner, 2]
    first = np.searchsorted(owner, owner)
    index = np.arange(len(owner)) - first  # within its asset
    moved = Instances(
        rows.prototype, hash_ids(city.seed, "asset/fitting", ids[owner], index), ids[owner],
        position, rotation, (rows.scale * at.scale[owner]).astype(np.float32), rows.tint,
    )  # fmt: skip
    keep = ~_behind_neighbours(lots, moved, models)
    for number, layer in enumerate(models.layers):
        of = np.flatnonzero((models.layer == number) & keep)
        if len(of):
            scene = with_rows(scene, layer, models.prototypes, take_rows(moved, of))
    return scene


_OPENINGS = ("window", "door", "shopfront")


def _behind_neighbours(lots: Lots, rows: Instances, models: Models) -> NDArray[np.bool_]:
    """Find openings that look into another building no lower than they are."""
    opening = np.array([p.kind in _OPENINGS for p in models.prototypes] or [False])
    found = np.zeros(rows.count, bool)
    of = np.flatnonzero(opening[rows.prototype])
    if not len(of):
        return found
    yaw = rows.rotation[of, 2].astype(float)
    before = rows.position[of, :2] + VIEW * np.column_stack([np.sin(yaw), -np.cos(yaw)])
    tree = shapely.STRtree(lots.polygon)
    point, lot = tree.query(shapely.points(before), predicate="within")
    other = lots.id[lot] != rows.owner[of[point]]
    point, lot = point[other], lot[other]
    height = np.nan_to_num(lots.height[lot], nan=np.inf)
    base = rows.position[of[point], 2]
    # Heights are above the ground, which neighbours share to within a storey.
    ground = np.full(len(lots.id), np.inf)
    order = np.searchsorted(lots.id, rows.owner)
    np.minimum.at(ground, np.minimum(order, len(ground) - 1), rows.position[:, 2])
    level = ground[np.minimum(np.searchsorted(lots.id, rows.owner[of[point]]), len(ground) - 1)]
    found[of[point[base - level < height]]] = True
    return found
