"""Shells: walls, shaped roofs, parapets and eaves of every building."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.assets.styles.palettes import without_material
from cityx.building.assembly import assemble, finishes_of
from cityx.building.bays import in_bays
from cityx.building.catalogue import generator_named
from cityx.building.mesh_volumes import mesh_shells
from cityx.building.roofs.shapes import RoofBrief, as_shapes, chunks, part_of_brief, shell_batch
from cityx.building.selection import designs_of_parts
from cityx.building.splicing import spliced
from cityx.building.stated_forms import MADE, stated_forms
from cityx.building.volumes import Volumes, volumes_of
from cityx.city.city import City, Failure
from cityx.city.ground import KERB_HEIGHT
from cityx.city.layout import is_mesh
from cityx.city.levels import terrain_at_walls
from cityx.city.mesh import concatenate
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.extrude import prisms
from cityx.geometry.polygons import Rings, corners, rings_of
from cityx.geometry.solids import TRIM, Solids, join_solids
from cityx.ground.building_passages import ceilings, passages
from cityx.ids import uniform
from cityx.protocol import Port, Range, action
from cityx.sources.features.tagged import named_note

if TYPE_CHECKING:
    from geopandas import GeoDataFrame

ACTION = "building/shell-v1"
PRISM = "building/prism-v1"
CHUNK = 2000  # parts raised together, so that memory does not grow with the city
CLEARANCE = 0.15  # metres kept between an eave and a neighbour
SLAB = 0.25  # metres, the roof of a canopy
POST = 0.16  # metres, side of a canopy's post
POST_INSET = 0.35  # metres from the edge of the canopy
MAX_POSTS = 12
# Metres and share of a height that is stated by which a wall downhill may exceed it, unsaid; the
# greater counts. Share of a height that is not.
HIGHER, HIGHER_SHARE, STEEP = 0.5, 0.03, 0.5
LOWERED = 0.01  # metres
TERRACE = 1.2  # party walls along the longer sides, in lengths of that side
PARAPET_LOW, PARAPET_HIGH = 0.4, 1.1  # metres
NOTHING = shapely.to_wkb(shapely.Polygon())  # the outline of what is not raised here
PARAPET_SHARE = 0.25  # of the height of a part, so that sheds get a low one


@action(
    ACTION,
    limits=[
        "A roof that is stated and its outline does not admit becomes a simpler one, which the "
        "report lists.",
        "Eaves are left out beside neighbours.",
    ],
    requires=("layout",),
    takes=(Port("design", "scene_layout", "building_design"),),
    gives=(Port("shells", "complex_geometry", "building_shells"),),
    labels=("building", "roof", "walls", "house"),
)
def shell(
    city: City,
    *,
    parapet: bool = True,
    overhang: Annotated[float, Range(0.0, 1.0)] = 0.35,
) -> City:
    """Raise every building to a closed shell with the roof its shape asks for.

    Parameters
    ----------
    parapet
        Whether flat roofs stand behind a parapet.
    overhang
        How far pitched roofs run out over free walls, metres.
    """
    volumes = volumes_of(city.layout, city.terrain)
    reach = overhang * _eaves_of(city)
    brief, points = roof_brief(
        volumes, city.layout.parts, city.seed, parapet=parapet, overhang=reach
    )
    finishes = finishes_of(city)
    outside = is_mesh(city.layout)
    meshes, lost = (
        mesh_shells(city.layout, city.seed, finishes, volumes.ground, volumes.low)
        if outside.any() else ([], {})
    )  # fmt: skip
    made = np.isin(volumes.building, [mesh.object_id[0] for mesh in meshes])
    if meshes:
        outlines = np.array(brief.outlines, object)
        outlines[made] = NOTHING
        number = np.diff(points)
        brief = replace(brief, outlines=outlines, free=brief.free[np.repeat(~made, number)])
        points = np.concatenate([[0], np.cumsum(np.where(made, 0, number))]).astype(np.int64)
    solids, built = raise_shells(brief, points)
    posts = canopy_posts(volumes, brief)
    piers = beside_ways(volumes)
    batch = assemble(join_solids([solids, posts, piers]), volumes.building, finishes)
    if meshes:
        batch = spliced(batch, np.zeros(0, np.uint64), concatenate(meshes))
    wanted = np.where(brief.top - brief.eave < 0.15, "flat", brief.shape)
    failures, notes = _report(
        volumes, wanted, np.where(made, wanted, built), _drawn_roofs(city, volumes)
    )
    notes += _departures(city, volumes)
    failures += tuple(
        Failure(building, ACTION, f"raised as a block: {why}") for building, why in lost.items()
    )
    return replace(
        city,
        scene=city.scene.with_mesh("buildings", batch),
        stages_done=city.stages_done | {"building"},
        failures=city.failures + failures,
        notes=city.notes + notes,
    )


def roof_brief(
    volumes: Volumes,
    parts: GeoDataFrame,
    seed: int,
    *,
    parapet: bool = True,
    overhang: FloatArray | float = 0.35,
) -> tuple[RoofBrief, IntArray]:
    """Gather what the shells of a layout's parts need.

    Parameters
    ----------
    overhang
        Metres, of all parts or (n,).

    Returns
    -------
    brief, points
        The brief of all parts, and (n + 1,) offsets of each part's ring points in ``brief.free``.
    """
    count = len(volumes.top)
    rings = rings_of(volumes.polygons)
    ids = parts["id"].to_numpy(np.uint64)
    shape = as_shapes(parts["roof_shape"].to_numpy())
    low = np.where(volumes.walls, volumes.low, np.maximum(volumes.eave - SLAB, volumes.base))
    low = np.minimum(low, volumes.top - SLAB)
    low[volumes.opened] = volumes.way_top[volumes.opened]
    height = PARAPET_LOW + (PARAPET_HIGH - PARAPET_LOW) * uniform(seed, "parapet", ids)
    height = np.minimum(height, PARAPET_SHARE * (volumes.top - volumes.base))
    direction = parts["roof_direction"].to_numpy(float)
    across = parts["roof_across"].to_numpy(bool)
    reach = np.broadcast_to(np.asarray(overhang, float), count)
    free = _free_edges(rings, volumes, reach + CLEARANCE)
    terrace = _terraced(rings, free, volumes.polygons) & ~np.isfinite(direction)
    number = np.bincount(rings.polygon, np.diff(rings.start), minlength=count).astype(np.int64)
    brief = RoofBrief(
        shapely.to_wkb(volumes.polygons),
        shape,
        low,
        volumes.eave,
        volumes.top,
        volumes.ground,
        direction,
        across | terrace,
        np.where(volumes.walls & parapet, height, 0.0),
        np.where(volumes.walls, reach, 0.0),
        free,
    )
    return brief, np.concatenate([[0], np.cumsum(number)]).astype(np.int64)


def _eaves_of(city: City) -> FloatArray:
    """Return how far the roofs of each part run out, relative to the usual, (n,)."""
    design = designs_of_parts(city)
    known, index = np.unique(design, return_inverse=True)
    factor = np.array([generator_named(k.partition("/")[0]).eaves for k in known.tolist()], float)
    return factor[index] if len(design) else np.zeros(0)


def _free_edges(rings: Rings, volumes: Volumes, reach: FloatArray) -> NDArray[np.bool_]:
    """Whether no other part as high as the eave lies beside the edge, (m,) bool."""
    free = np.ones(len(rings.points), bool)
    if len(free) == 0:
        return free
    part = rings.polygon[rings.ring_of_point]
    vector = rings.points[rings.following()] - rings.points
    length = np.maximum(np.hypot(*vector.T), 1e-9)[:, None]
    normal = np.column_stack([vector[:, 1], -vector[:, 0]]) / length
    # The strip of the eave, drawn in at its ends so that a neighbour round the corner is none.
    inner = vector / length * np.minimum(0.2, 0.25 * length)
    a, b = rings.points + inner, rings.points + vector - inner
    near, far = normal * 0.02, normal * reach[part, None]
    strip = shapely.polygons(np.stack([a + near, a + far, b + far, b + near], 1))
    edge, other = shapely.STRtree(volumes.polygons).query(strip, predicate="intersects")
    mine = part[edge]
    beside = (
        (mine != other)
        & (volumes.top[other] > volumes.eave[mine] - 1.0)
        & (volumes.low[other] < volumes.top[mine])
    )
    free[edge[beside]] = False
    return free


def _terraced(rings: Rings, free: NDArray[np.bool_], polygons: NDArray[Any]) -> NDArray[np.bool_]:
    """Return which parts have neighbours along both longer sides: their ridge runs across."""
    count = len(polygons)
    boxes = shapely.oriented_envelope(polygons)
    found = np.zeros(count, bool)
    rows = np.flatnonzero((shapely.get_type_id(boxes) == 3) & ~shapely.is_empty(boxes))
    if len(rows) == 0:
        return found
    side = np.diff(shapely.get_coordinates(boxes[rows]).reshape(-1, 5, 2)[:, :3], axis=1)
    size = np.linalg.norm(side, axis=2)
    axis, long_side = np.zeros((count, 2)), np.zeros(count)
    at = np.argmax(size, axis=1)
    pick = np.arange(len(rows))
    long_side[rows] = size[pick, at]
    axis[rows] = side[pick, at] / np.maximum(size[pick, at], 1e-9)[:, None]
    vector = rings.points[rings.following()] - rings.points
    part = rings.polygon[rings.ring_of_point]
    run = np.abs((vector * axis[part]).sum(axis=1))
    along = (run > 0.8 * np.hypot(*vector.T)) & ~free
    shared = np.bincount(part[along], run[along], minlength=count)
    return np.asarray(shared > TERRACE * np.maximum(long_side, 1e-9))


def raise_shells(brief: RoofBrief, points: IntArray) -> tuple[Solids, NDArray[np.str_]]:
    """Raise all parts, in chunks of a fixed size.

    Returns
    -------
    solids, built
        As of `cityx.building.roofs.shapes.shell_batch`.
    """
    rows = chunks(len(brief.low), CHUNK)
    results = [shell_batch(part_of_brief(brief, chunk, points)) for chunk in rows]
    solids = [
        replace(
            piece,
            vertex_part=piece.vertex_part + chunk.start,
            face_part=piece.face_part + chunk.start,
        )
        for (piece, _), chunk in zip(results, rows, strict=True)
    ]
    built = [words for _, words in results]
    return join_solids(solids), np.concatenate(built) if built else np.zeros(0, dtype="U1")


def canopy_posts(volumes: Volumes, brief: RoofBrief) -> Solids:
    """Stand posts under the roofs that have no walls."""
    rows = np.flatnonzero(~volumes.walls & volumes.usable & (brief.low > volumes.low + 1.0))
    if len(rows) == 0:
        return join_solids([])
    inner = shapely.buffer(volumes.polygons[rows], -POST_INSET, join_style="mitre")
    shapes, of_row = shapely.get_parts(inner, return_index=True)
    rings = rings_of(shapes)
    kept = np.flatnonzero(corners(rings) & ~rings.hole[rings.ring_of_point])
    owner = of_row[rings.polygon[rings.ring_of_point[kept]]]
    order = np.argsort(owner, kind="stable")
    kept, owner = kept[order], owner[order]
    rank = np.arange(len(owner)) - np.searchsorted(owner, owner)
    total = np.bincount(owner, minlength=len(rows))[owner]
    stride = np.maximum(1, -(-total // MAX_POSTS))
    chosen = rank % stride == 0
    place, part = rings.points[kept[chosen]], rows[owner[chosen]]
    half = POST / 2
    posts = shapely.box(
        place[:, 0] - half, place[:, 1] - half, place[:, 0] + half, place[:, 1] + half
    )
    solids, _ = prisms(posts, volumes.low[part], brief.low[part], volumes.ground[part])
    return replace(
        solids,
        vertex_part=part[solids.vertex_part],
        face_part=part[solids.face_part],
        role=np.full(len(solids.role), TRIM, np.int8),
    )


def beside_ways(volumes: Volumes) -> Solids:
    """Raise what stands beside the ways that lead through parts, up to where these are free."""
    pieces, row = volumes.beside_ways()
    if not len(row):
        return join_solids([])
    solids, _ = prisms(pieces, volumes.low[row], volumes.way_top[row], volumes.ground[row])
    return replace(solids, vertex_part=row[solids.vertex_part], face_part=row[solids.face_part])


def _departures(city: City, volumes: Volumes) -> tuple[str, ...]:
    """Name houses that a slope makes higher than said, unknown materials, and low passages."""
    layout = city.layout
    lowest, _ = terrain_at_walls(layout, city.terrain)
    laid_open = volumes.ground - lowest - KERB_HEIGHT
    height = volumes.top - volumes.ground
    ids = layout.buildings["id"].to_numpy(np.uint64)
    known = ids[~np.isnan(stated_forms(layout.buildings).height)]
    share = np.where(np.isin(volumes.building, known), HIGHER_SHARE, STEEP)
    tall = laid_open > np.maximum(HIGHER, share * height)
    found = passages(layout)
    wanted = ceilings(layout, city.terrain, found)
    low = wanted > volumes.way_top[found.part] + LOWERED
    sources = layout.buildings["source"].to_numpy(str)

    def mapped(parts: NDArray[np.bool_]) -> list[str]:
        names = sources[np.isin(ids, volumes.building[parts])].tolist()
        return sorted({name for name in names if not name.startswith(MADE)})

    ways = layout.roads["source"].to_numpy(str)[found.road[low]].tolist()
    notes = (
        named_note("buildings on slopes have walls downhill over their height",
                   mapped(tall)),
        named_note("buildings are of materials that are not known, and built of usual ones",
                   mapped(without_material(layout))),
        named_note("ways through houses have less headroom than is stated or usual",
                   sorted(set(ways))),
    )  # fmt: skip
    return tuple(note for note in notes if note and note not in city.notes)


def _drawn_roofs(city: City, volumes: Volumes) -> NDArray[np.bool_]:
    """(p,) whether nobody asked for the roof of a volume: no tag of its building states any.

    Volumes of a building without a design may be parts of the map, with tags of their own; only
    one that stands alone is surely not.
    """
    buildings = city.layout.buildings
    stated = stated_forms(buildings)
    free = ~(stated.roof | stated.flat)
    designed = buildings["generator"].to_numpy(str) != ""
    ids = buildings["id"].to_numpy(np.uint64)
    own, count = np.unique(volumes.building, return_counts=True)
    alone = np.isin(ids, own[count == 1])
    return np.isin(volumes.building, ids[free & (designed | alone)])


def _report(
    volumes: Volumes,
    wanted: NDArray[np.str_],
    built: NDArray[np.str_],
    drawn: NDArray[np.bool_],
) -> tuple[tuple[Failure, ...], tuple[str, ...]]:
    """Failures by building, and one sentence on how many roofs are simpler than asked.

    A roof that was drawn and gives way to one which its outline admits is no failure.
    """
    got = np.where(built == "wings", "gabled", built)
    simpler = np.flatnonzero(
        (got != wanted) & ~((wanted == "flat") & (got == "block")) & ~(drawn & (got != ""))
    )
    failures = []
    for row in simpler.tolist():
        message = (
            f"roof {wanted[row]} fell back to {got[row]}: the outline admits no such roof"
            if got[row]
            else "outline left out: it encloses no area"
        )
        failures.append(Failure(int(volumes.building[row]), ACTION, message))
    if not failures:
        return (), ()
    pairs = Counter(f"{wanted[row]} to {got[row] or 'nothing'}" for row in simpler.tolist())
    listed = ", ".join(f"{number} {pair}" for pair, number in sorted(pairs.items()))
    share = len(failures) / max(len(built), 1)
    return tuple(failures), (f"Roofs: {share:.2%} of parts got a simpler shape ({listed}).",)


@action(
    PRISM,
    limits=["Roofs are level, walls are blank and a canopy is a solid block."],
    requires=("layout",),
    gives=(Port("blocks", "complex_geometry", "building_blocks"),),
    labels=("building", "block", "extrusion", "low detail"),
)
def prism(city: City) -> City:
    """Raise every building to a plain block of its height.

    A building is the union of its parts; each part is a closed solid with courtyards left open.
    """
    city = in_bays(city)
    volumes = volumes_of(city.layout, city.terrain)
    foot = np.where(volumes.walls, volumes.low, np.minimum(volumes.eave, volumes.top - 0.3))
    foot[volumes.opened] = volumes.way_top[volumes.opened]
    solids, failed = prisms(volumes.polygons, foot, volumes.top, volumes.ground)
    solids = join_solids([solids, beside_ways(volumes)])
    batch = assemble(solids, volumes.building, finishes_of(city))
    failures = tuple(
        Failure(int(building), PRISM, "outline left out: it encloses no area")
        for building in volumes.building[failed]
    )
    return replace(
        city,
        scene=city.scene.with_mesh("buildings", batch),
        stages_done=city.stages_done | {"building"},
        failures=city.failures + failures,
        notes=city.notes + _departures(city, volumes),
    )
