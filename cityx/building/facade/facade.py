"""Facades: windows, doors, shopfronts and ornament on every wall."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.assets.openings.doors import DOORS, door
from cityx.assets.openings.windows import WINDOWS, window
from cityx.building.assembly import TRIM_MATERIAL, assemble
from cityx.building.facade import grammar as facades
from cityx.building.facade.cornices import corner_stones, mouldings
from cityx.building.facade.dressing import dress, opening_ids
from cityx.building.facade.facade_plan import WINDOW_ROLES, Facade, entrances_without, facade_of
from cityx.building.facade.fixtures import fixtures
from cityx.building.facade.grammar import Openings, wall_key
from cityx.building.facade.niches import FINE_LOD, Setting, fitted, set_back
from cityx.building.facade.placing import Facing, Placing, used
from cityx.building.facade.slabs import Pieces, around, coursed, slabs
from cityx.building.facade.strips import strips
from cityx.building.facade.wall_faces import wall_faces
from cityx.building.growth import Piece, grown, piece_of
from cityx.building.roofs.dormers import dormers
from cityx.building.roofs.roof_edges import gable_windows, roof_edges
from cityx.building.roofs.roof_heights import RoofField, roof_field
from cityx.building.roofs.rooftop import furnish_roofs
from cityx.city.city import City
from cityx.city.layout import is_mesh
from cityx.city.mesh import MeshBatch
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.ids import choose, hash_ids, mix
from cityx.protocol import Port, action

if TYPE_CHECKING:
    from cityx.building.facade.facade_plan import Facade

# Facings of ground floors, at the finest level of detail part of the shells.

COURSE = 0.45  # metres, height of the courses of the material "stone"
# Metres that a facing stands out and by which its edges are chamfered.
STANDS_OUT = {"stone": (0.030, 0.014), "door_paint": (0.012, 0.0)}


def facing_pieces(batch: MeshBatch, placing: Placing, found: Facade) -> list[Piece]:
    """Make the facings that were asked for as closed slabs around the openings."""
    table = found.openings
    holes = Pieces(
        table.wall, table.along - table.width / 2, table.along + table.width / 2,
        table.low, table.low + table.height,
    )  # fmt: skip
    return [
        _made(batch, placing, found, facing, holes)
        for facing in placing.facings
        if len(facing.wall) and batch.count
    ]


def _made(
    batch: MeshBatch, placing: Placing, found: Facade, facing: Facing, holes: Pieces
) -> Piece:
    walls = found.walls
    out, chamfer = STANDS_OUT[facing.material]
    row, begin, finish = placing.faces.pieces(walls, facing.wall)
    wall = facing.wall[row]
    whole = Pieces(row, begin, finish, facing.low[row], facing.high[row])
    pieces = around(whole, wall, holes)
    if facing.material == "stone":
        zero = found.volumes.ground[walls.part[wall]]
        pieces = coursed(pieces, zero[pieces.source], COURSE)
    source = pieces.source
    wall, asked = wall[source], row[source]
    # Pieces at the ends of a wall run round the corner; a hair less than the other side's face.
    first = pieces.x0 < 1e-6
    last = pieces.x1 > walls.length[wall] - 1e-6
    ends = [
        pieces.x0 - np.where(first, 0.97 * out * facing.before[asked], 0.0),
        pieces.x1 + np.where(last, 0.97 * out * facing.after[asked], 0.0),
    ]
    feet = []
    for along, inside in zip(ends, (pieces.x0, pieces.x1), strict=True):
        stand = placing.faces.before(walls, wall, inside)
        foot = walls.start[wall] + placing.unit[wall] * along[:, None]
        feet.append(foot + walls.normal[wall] * stand[:, None])
    vertices, faces = slabs(
        feet[0], feet[1], walls.normal[wall], pieces.z0, pieces.z1, out, chamfer
    )
    uv = _texture(found, wall, ends, pieces)
    owner = np.searchsorted(batch.object_id, placing.building[wall]).clip(max=batch.count - 1)
    known = batch.object_id[owner] == placing.building[wall]
    vertices, uv, owner = vertices[known], uv[known], owner[known]
    count, corners, sides = len(vertices), vertices.shape[1], len(faces)
    shift = len(batch.vertices) + corners * np.arange(count)
    # Undersides count as trim, so that they are no ground that the building covers.
    kinds = np.zeros(sides, np.int16)
    kinds[0] = 1
    return Piece(
        vertices.reshape(-1, 3), np.repeat(owner, corners),
        (faces[None] + shift[:, None, None]).reshape(-1, 4), np.repeat(owner, sides),
        np.tile(kinds, count), (facing.material, TRIM_MATERIAL),
        uv.reshape(-1, 4, 2), np.repeat(facing.tint[asked[known]], sides, axis=0),
    )  # fmt: skip


def _texture(
    found: Facade, wall: IntArray, ends: list[FloatArray], pieces: Pieces
) -> NDArray[np.float32]:
    """(p, 10, 4, 2) metres along the ring and above the ground."""
    along = found.walls.along[wall]
    zero = found.volumes.ground[found.walls.part[wall]]
    u0, u1 = along + ends[0], along + ends[1]
    v0, v1 = pieces.z0 - zero, pieces.z1 - zero
    uv = np.zeros((len(wall), 10, 4, 2), np.float32)
    for face, (low, high) in enumerate(
        ((v0, v0), (v0, v0), (v0, v1), (v1, v1), (v1, v1), (v0, v1))
    ):
        uv[:, face, :, 0] = np.stack([u0, u1, u1, u0], 1)
        uv[:, face, :, 1] = np.stack([low, low, high, high], 1)
    return uv


LAYERS = {"windows": "window", "doors": "door", "shopfronts": "shopfront", "trims": "trim"}
SHELLS = "buildings"  # the layer of the shells
MIN_LOD = 2
DRESSING_SHARES = (0.52, 0.16, 0.22, 0.10)
STONE_DOORS = ("door_bronze", "door_parking")  # entrances that are built rather than painted
GATE_TINTS = ((0.75, 0.75, 0.74), (0.5, 0.52, 0.53), (0.85, 0.84, 0.8), (0.22, 0.24, 0.25),
              (0.32, 0.22, 0.16), (0.16, 0.22, 0.26))  # fmt: skip


@action(
    "building/facade-v1",
    limits=[
        "Runs at level of detail 2 and above; below it changes nothing.",
        "Openings lie on the walls; at level 3 they are niches. Only shops have rooms.",
        "Signs are in Latin, Greek, Cyrillic and Japanese letters; other names become words.",
    ],
    requires=("layout",),
    takes=(Port("design", "scene_layout", "building_design"),),
    gives=(Port("facades", "complex_geometry", "facades"),),
    labels=("facade", "windows", "doors", "shops", "balconies", "ornament"),
)
def facade(city: City) -> City:
    """Give every building windows, doors, shopfronts, ornament and roof furniture.

    Walls are split into storeys and bays; party walls stay blind. Shops lie on the ground floors of
    commercial streets, and every building has one main door, at the pavement of its best street.
    """
    return faced(city) if city.lod >= MIN_LOD else city


def faced(city: City, trade: FloatArray | None = None) -> City:
    """Do what `facade` does, at level of detail 2 and above; `trade` as of `fronts_of`."""
    found = facade_of(city, trade)
    building = found.volumes.building[found.walls.part]
    walled = np.where(found.volumes.walls, found.volumes.polygons, shapely.Polygon())
    # Parts that stand on one another have walls in the same place.
    own = city.layout.parts["id"].to_numpy(np.uint64)[found.walls.part]
    key = mix(wall_key(found.walls) ^ own)
    placing = Placing(found.walls, wall_faces(walled), building, key, detail=city.lod)
    without = entrances_without(city, found)
    scene = city.scene
    notes = city.notes + ((without,) if without and without not in city.notes else ())
    setting = Setting(np.zeros(found.openings.count))
    shells = scene.meshes.get("buildings")
    if city.lod >= FINE_LOD and shells is not None:
        setting = set_back(placing, found, _names_of(found), city)
        share = setting.recessed.mean() if found.openings.count else 1.0
        notes += (f"Openings: {share:.2%} of {found.openings.count} are set back into the walls.",)
    _place_windows(placing, found, setting, city)
    _place_doors(placing, found, setting, city.seed)
    dress(placing, found, city, setting)
    strips(placing, found, city.seed)
    fixtures(placing, found, city)
    pieces = []
    if setting.piece is not None and shells is not None:
        pieces = [setting.piece, *facing_pieces(shells, placing, found)]
    field = pitched_field(city, found)
    edges = _crown(placing, found, city, field)
    if shells is not None:
        pieces += [] if edges is None else [edges]
        scene = scene.with_mesh("buildings", grown(shells, pieces, setting.kept))
    for layer, kind in LAYERS.items():
        scene = scene.with_instances(layer, *used(*placing.layer(kind)))
    # What stands on the roof of a mesh from outside is its own.
    bare = replace(found.volumes, walls=found.volumes.walls & ~is_mesh(city.layout))
    prototypes, rows = furnish_roofs(city, bare, found.finishes, field, found.walls)
    scene = scene.with_instances("roof_furniture", *used(prototypes, rows))
    return replace(city, scene=scene, stages_done=city.stages_done | {"building"}, notes=notes)


def _names_of(found: Facade) -> NDArray[np.str_]:
    """Return the name of what fills each opening, (k,)."""
    names = np.full(found.openings.count, "shop", "U20")
    for role, named in ((WINDOW_ROLES, _window_names), (facades.DOORS, _door_names)):
        rows = np.flatnonzero(np.isin(found.openings.role, role))
        names[rows] = named(found, found.openings.take(rows))
    return names


def _window_names(found: Facade, table: Openings) -> NDArray[np.str_]:
    """Return the name of the window in each opening."""
    name = found.designs.window[found.walls.part[table.wall]]
    name = np.where(table.role == facades.FRENCH, "window_french", name)
    # Narrow walls and stairs take the small window rather than a squeezed one.
    squeezed = (table.width < 0.62 * _window_sizes(name)[:, 0]) & (name != "window_arched")
    return np.where(squeezed, "window_small", name)


def _window_sizes(name: NDArray[np.str_]) -> FloatArray:
    known, index = np.unique(name, return_inverse=True)
    size = np.array([WINDOWS[word][1:] for word in known.tolist()], float).reshape(-1, 2)
    return size[index] if len(name) else np.zeros((0, 2))


def _place_windows(placing: Placing, found: Facade, setting: Setting, city: City) -> None:
    rows = np.flatnonzero(np.isin(found.openings.role, WINDOW_ROLES))
    table = found.openings.take(rows)
    ids = opening_ids(placing, table)
    part = found.walls.part[table.wall]
    name = _window_names(found, table)
    size = _window_sizes(name)
    dressing = choose(city.seed, "facade/dressing", ids, DRESSING_SHARES)
    tint = found.finishes.frame_tint[part]
    arched = name == "window_arched"
    tint = np.where(arched[:, None], found.finishes.trim_tint[part], tint)
    code = np.unique(name, return_inverse=True)[1] * 4 + dressing
    for value in np.unique(code).tolist():
        of = np.flatnonzero(code == value)
        word, which = str(name[of[0]]), int(value % 4)
        placing.add(
            f"{word}_{which}", partial(window, word, which),
            table.wall[of], table.along[of], table.low[of],
            **fitted(placing, setting.depth[rows[of]], table.width[of], table.height[of], size[of]),
            tint=tint[of], ids=ids[of], reach=table.width[of] / 2,
        )  # fmt: skip


def _door_names(found: Facade, table: Openings) -> NDArray[np.str_]:
    """Return the name of the door in each opening."""
    fixed = {facades.SERVICE: "door_service", facades.GARAGE: "door_garage",
             facades.ROLLER: "door_roller"}  # fmt: skip
    name = found.designs.door[found.walls.part[table.wall]]
    for role, word in fixed.items():
        name = np.where(table.role == role, word, name)
    name = np.where((name == "door_portal") & (table.height < 2.9), "door_panel", name)
    return np.where((name == "door_double") & (table.width < 1.5), "door_panel", name)


def _place_doors(placing: Placing, found: Facade, setting: Setting, seed: int) -> None:
    rows = np.flatnonzero(np.isin(found.openings.role, facades.DOORS))
    table = found.openings.take(rows)
    ids = opening_ids(placing, table)
    part = found.walls.part[table.wall]
    name = _door_names(found, table)
    gates = np.array(GATE_TINTS)
    gate = gates[hash_ids(seed, "facade/gate tint", placing.building[table.wall])
                 % np.uint64(len(gates))]  # fmt: skip
    tint = np.where(
        (name == "door_glass")[:, None],
        found.finishes.frame_tint[part],
        found.finishes.accent_tint[part],
    )
    tint = np.where(np.isin(name, ["door_garage", "door_roller"])[:, None], gate, tint)
    tint = np.where(np.isin(name, STONE_DOORS)[:, None], found.finishes.trim_tint[part], tint)
    for word in np.unique(name).tolist():
        of = np.flatnonzero(name == word)
        size = np.tile(DOORS[word][1:], (len(of), 1))
        placing.add(
            word, partial(door, word), table.wall[of], table.along[of], table.low[of],
            **fitted(placing, setting.depth[rows[of]], table.width[of], table.height[of], size),
            tint=tint[of], ids=ids[of], reach=table.width[of] / 2,
        )  # fmt: skip


def pitched_field(city: City, found: Facade) -> RoofField | None:
    """Return the roofs of all buildings with a slope; None where no shells are raised."""
    batch = city.scene.meshes.get(SHELLS)
    if batch is None:
        return None
    pitched = found.volumes.top - found.volumes.eave >= 0.15
    objects = np.isin(batch.object_id, found.volumes.building[pitched])
    return roof_field(batch, objects, (TRIM_MATERIAL,))


def _crown(placing: Placing, found: Facade, city: City, field: RoofField | None) -> Piece | None:
    """Put instances on roofs and corners, and return the mouldings to add to the shells.

    Parameters
    ----------
    placing
        Takes the instances.
    city
        With the shells as they were raised.
    field
        Of those shells, see `pitched_field`.
    """
    corner_stones(placing, found, city.seed)
    if field is None:
        return None
    shells = city.scene.meshes[SHELLS]
    dormers(placing, found, city, field)
    gable_windows(placing, found, city, field)
    roof_edges(placing, shells)
    solids = mouldings(placing, found, city, field)
    return piece_of(assemble(solids, found.volumes.building, found.finishes), shells)
