"""Roofs: every part gets the shell its roof shape asks for, or the nearest one that closes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from types import MappingProxyType
from typing import Any

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from cityx.building.roofs.rectangle_roofs import HALF, RECTANGULAR, is_rectangle, rectangle_roofs
from cityx.building.roofs.roof_heights import eave_bodies, overhang_points
from cityx.building.roofs.roof_lofts import DOME, LOFTS, loft_roofs, parapet_roofs, rimmed_roofs
from cityx.building.roofs.roof_meshes import (
    RoofMesh,
    bend_mesh,
    crossed_mesh,
    edge_slopes,
    join_meshes,
    raised,
)
from cityx.building.roofs.roof_profiles import PROFILES, profile_roofs
from cityx.building.roofs.roof_skeletons import skeleton_roofs
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.extrude import prisms, weld_touching
from cityx.geometry.polygons import Rings, envelopes_of, rings_of
from cityx.geometry.ranges import numbered
from cityx.geometry.solids import (
    ROOF,
    Solids,
    area_vectors,
    join_solids,
    open_parts,
    volumes_by_group,
)
from cityx.system.tables import table

# Shapes that are built as such, besides "wings" (gabled with one ridge per wing) and "block".
SHAPES = (
    "flat", "gabled", "skillion", "gambrel", "saltbox", "double_saltbox", "butterfly", "round",
    "zollinger", "sawtooth", "gabled_row", "gabled_height_moved", "crosspitched", "hipped",
    "half-hipped", "side_hipped", "side_half-hipped", "hipped-and-gabled", "mansard", "rimmed",
    "pyramidal", "dome", "onion",
)  # fmt: skip
# Values of roof:shape that mean one of them. Anything else that is not known is flat.
SYNONYMS = table("building/roofs", str, "synonyms")
# How a shape is built where its plain form does not suit the outline, and what it still counts as.
FORMS: Mapping[str, str] = MappingProxyType(
    {
        "gambrel_wings": "gambrel", "round_wings": "round", "zollinger_wings": "zollinger",
        "cross_wings": "crosspitched", "dome_ridged": "dome", "mansard_deck": "mansard",
    }
)  # fmt: skip
# What is tried next when a shell does not close or its outline does not admit the shape.
NEXT: Mapping[str, str] = MappingProxyType(
    {
        "onion": "dome", "dome": "dome_ridged", "dome_ridged": "hipped", "pyramidal": "hipped",
        "mansard": "mansard_deck", "mansard_deck": "hipped", "rimmed": "hipped",
        "side_half-hipped": "half-hipped", "half-hipped": "hipped", "side_hipped": "hipped",
        "hipped-and-gabled": "hipped", "gambrel_wings": "gambrel", "round_wings": "round",
        "zollinger_wings": "zollinger", "cross_wings": "crosspitched", "wings": "gabled",
        "hipped": "gabled", "crosspitched": "gabled", "gabled_row": "gabled",
        "gabled_height_moved": "gabled", "sawtooth": "gabled", "gambrel": "gabled",
        "zollinger": "gabled", "round": "gabled", "saltbox": "gabled", "double_saltbox": "gabled",
        "gabled": "skillion", "butterfly": "skillion", "skillion": "flat", "flat": "block",
    }
)  # fmt: skip
# Roofs that run out over their walls.
EAVED = frozenset(
    {
        "gabled", "skillion", "gambrel", "saltbox", "double_saltbox", "wings", "gambrel_wings",
        "cross_wings", "crosspitched", "gabled_row", "gabled_height_moved", "zollinger",
        "zollinger_wings", "hipped", "half-hipped", "side_hipped", "side_half-hipped",
        "hipped-and-gabled", "pyramidal",
    }
)  # fmt: skip
WINGED = {"gabled": "wings", "gambrel": "gambrel_wings", "round": "round_wings",
          "zollinger": "zollinger_wings", "crosspitched": "cross_wings"}  # fmt: skip
# First end and other ends of roofs over the skeleton, see `skeleton_roofs`.
ENDS = {"half-hipped": (HALF, HALF), "side_hipped": (1.0, 0.0), "side_half-hipped": (1.0, HALF),
        "hipped-and-gabled": (HALF, HALF)}  # fmt: skip
MIN_RISE = 0.15  # metres; a lower roof is level
WING_FILL = 0.82  # share of its rectangle below which a gabled house has wings
MAX_WING_POINTS = 40
STEEP_RUN = 0.36  # plan metres per metre of rise of a mansard's rim (70 degrees)
UPPER_SLOPE = 0.36  # rise over run above the rim of a mansard (20 degrees)
STEEP_SHARE = 0.7  # of its rise that the rim of a mansard takes at least
MAX_STEEP_RUN = 0.7  # of the way to the ridge that it takes at most
RIM_SHARE = 0.22  # of the short side that a sloping rim takes at most
TOOTH = 7.0  # metres, the usual bay of a sawtooth roof and of a row of gables
VERGE = 0.6  # share of its overhang that a roof has over a gable
MAX_VERGE_RISE = 0.2  # rise over run outward of an edge that still gets an overhang
SNAP_TURN = np.radians(10.0)  # a tagged direction this close to a wall means the wall's
PARAPET_THICKNESS = 0.3  # metres
AREA_TOLERANCE = 5e-3  # share of the plan by which a roof may miss it
LOOSE_TOLERANCE = 0.05  # the same for a block, the last resort, drawn in to come off itself
HEIGHT_TOLERANCE = 0.05  # metres


def roof_shape(value: str) -> str:
    """Return the shape of `SHAPES` that a value of roof:shape means; unknown words are flat."""
    word = value.strip().lower().replace(" ", "_")
    word = SYNONYMS.get(word, word)
    return word if word in SHAPES else "flat"


@dataclass(frozen=True)
class RoofBrief:
    """What to raise: n parts, plain arrays that travel between processes.

    Attributes
    ----------
    outlines
        (n,) bytes, well-known binary of valid, oriented polygons; empty ones are passed over.
    shape
        (n,) words of `SHAPES`.
    low, eave, top, zero
        (n,) foot, eave, top, zero of the wall texture; metres.
    direction
        (n,) compass radians of the downward slope, or NaN.
    across
        (n,) bool, ridge across the longer side.
    parapet
        (n,) height of a flat roof's parapet, 0 for none.
    overhang
        (n,) metres.
    free
        (m,) bool per ring point: no neighbour beside the edge that starts there.
    """

    outlines: NDArray[Any]
    shape: NDArray[np.str_]
    low: FloatArray
    eave: FloatArray
    top: FloatArray
    zero: FloatArray
    direction: FloatArray
    across: NDArray[np.bool_]
    parapet: FloatArray
    overhang: FloatArray
    free: NDArray[np.bool_]


@dataclass(frozen=True)
class _Attempt:
    """Shells of one shape and, where its eaves may run out, the roofs they were raised from."""

    solids: Solids
    mesh: RoofMesh | None = None


def shell_batch(brief: RoofBrief) -> tuple[Solids, NDArray[np.str_]]:
    """Raise parts to closed shells.

    Returns
    -------
    solids, built
        The shells, and (n,) the shape each part got: its own, one further down `NEXT`, "block", or
        "" where not even a block closes. Forms of a shape (`FORMS`) count as the shape.
    """
    polygons = shapely.from_wkb(brief.outlines)
    count = len(polygons)
    envelope = envelopes_of(polygons)
    angle = _ridge_angles(brief, envelope)
    pending = np.array(_first_shapes(brief, polygons, envelope), dtype=object)
    built = np.full(count, "", dtype=object)
    pending[shapely.is_empty(polygons)] = ""
    accepted: list[Solids] = []
    while (pending != "").any():
        kind = min(set(pending[pending != ""].tolist()), key=_ORDER.index)
        rows = pending == kind
        attempt = _attempt(
            kind, np.where(rows, polygons, shapely.Polygon()), brief, angle, envelope
        )
        solids = _welded(attempt.solids, count)
        good = rows & _sound(solids, polygons, brief, kind)
        accepted.append(solids.of_parts(good))
        if kind in EAVED:
            accepted.append(_eaves(attempt, brief, good, count))
        built[good] = FORMS.get(kind, kind)
        pending[rows] = ""
        pending[rows & ~good] = NEXT.get(kind, "flat" if kind != "block" else "")
    return join_solids(accepted), np.array(built, dtype=str)


# Every shape stands before the one that follows it in `NEXT`.
_ORDER = (
    "onion", "dome", "dome_ridged", "pyramidal", "mansard", "mansard_deck", "rimmed",
    "side_half-hipped", "half-hipped", "side_hipped", "hipped-and-gabled", "hipped",
    "gambrel_wings", "round_wings", "zollinger_wings", "cross_wings", "wings", "crosspitched",
    "gabled_row", "gabled_height_moved", "sawtooth", "gambrel", "zollinger", "round", "saltbox",
    "double_saltbox", "gabled", "butterfly", "skillion", "flat", "block",
)  # fmt: skip


def _ridge_angles(brief: RoofBrief, envelope: FloatArray) -> FloatArray:
    """Direction of the ridges, radians from east, the downward slope on the left hand."""
    along = envelope[:, 0] + np.where(brief.across, np.pi / 2, 0.0)
    tagged = np.isfinite(brief.direction)
    asked = -np.where(tagged, brief.direction, 0.0)
    gap = np.mod(asked - envelope[:, 0] + np.pi / 4, np.pi / 2) - np.pi / 4
    snapped = np.where(np.abs(gap) < SNAP_TURN, asked - gap, asked)
    return np.where(tagged, snapped, along)


def _first_shapes(brief: RoofBrief, polygons: NDArray[Any], envelope: FloatArray) -> Any:
    """Shape to try first: low roofs are flat, gabled plans with wings get a ridge for each."""
    shape = np.where(brief.top - brief.eave < MIN_RISE, "flat", brief.shape)
    points = shapely.get_num_coordinates(polygons) - 1
    winged = (
        np.isin(shape, list(WINGED))
        & ~np.isfinite(brief.direction)
        & (envelope[:, 3] < WING_FILL)
        & (points >= 6)
        & (points <= MAX_WING_POINTS)
    )
    return [WINGED[word] if wing else word for word, wing in zip(shape, winged, strict=True)]


def _attempt(
    kind: str, polygons: NDArray[Any], brief: RoofBrief, angle: FloatArray, envelope: FloatArray
) -> _Attempt:
    """Build the shells of one shape."""
    low, eave, zero = brief.low, brief.eave, brief.zero
    rise = np.maximum(brief.top - eave, 1e-3)
    if kind in LOFTS:
        solids, mesh = loft_roofs(polygons, kind, low, eave, rise, zero)
        return _Attempt(solids, mesh)
    if kind in ("mansard_deck", "rimmed"):
        steep = STEEP_RUN if kind == "mansard_deck" else 1.0
        run = np.minimum(steep * rise, RIM_SHARE * envelope[:, 2])
        wide = rimmed_roofs(polygons, run, low, eave, rise, zero)
        rest = polygons.copy()
        rest[wide.face_part] = shapely.Polygon()
        return _Attempt(join_solids([wide, rimmed_roofs(rest, run / 2, low, eave, rise, zero)]))
    if kind == "flat":
        return _flat(polygons, brief)
    if kind == "block":
        return _Attempt(prisms(polygons, low, brief.top, zero)[0])
    tagged = np.isfinite(brief.direction)
    if kind == "gabled_row":  # the gables of a row look at the longer side
        angle = angle + np.where(tagged | brief.across, 0.0, np.pi / 2)
    if kind == "sawtooth":  # its slopes rise to the left, its lights stand there
        angle = angle + np.where(tagged, np.pi, 0.0)
    mesh = _mesh(kind, polygons, angle, eave, rise, envelope)
    return _Attempt(raised(mesh, low, zero), mesh)


def _mesh(
    kind: str, polygons: NDArray[Any], angle: FloatArray, eave: FloatArray, rise: FloatArray,
    envelope: FloatArray,
) -> RoofMesh:  # fmt: skip
    """Lay the roofs of one shape on their outlines."""
    if kind in PROFILES or kind in ("sawtooth", "gabled_row"):
        names = np.full(len(polygons), kind, dtype="U20")
        if kind in ("sawtooth", "gabled_row"):
            turned = np.abs(np.sin(angle - envelope[:, 0])) > np.sqrt(0.5)
            width = np.where(turned, envelope[:, 1], envelope[:, 2])
            least = 1 if kind == "sawtooth" else 2
            teeth = np.clip(np.rint(width / TOOTH), least, 12).astype(int)
            names = np.array([f"{kind}_{number}" for number in teeth.tolist()])
        return profile_roofs(polygons, names, angle, eave, rise)
    if kind == "crosspitched":
        return crossed_mesh(polygons, angle, eave, rise)
    if kind in WINGED.values():
        mesh = skeleton_roofs(polygons, eave, rise, first=1.0, others=1.0)
        profile = FORMS.get(kind, "gabled")
        if profile in PROFILES and profile != "gabled":
            knots = [(2 * at, height) for at, height in PROFILES[profile] if at <= 0.5]
            mesh = _bent(mesh, eave, rise, np.array(knots))
        return mesh
    if kind == "dome_ridged":
        return _bent(_hipped("hipped", polygons, angle, eave, rise), eave, rise, DOME)
    if kind == "mansard":
        return _mansard(_hipped("hipped", polygons, angle, eave, rise), eave, rise, envelope)
    return _hipped(kind, polygons, angle, eave, rise)


def _bent(mesh: RoofMesh, eave: FloatArray, rise: FloatArray, knots: FloatArray) -> RoofMesh:
    """Bend all roofs alike; `knots` are (k, 2) shares of the way and of the height."""
    count = mesh.count
    return bend_mesh(
        mesh, eave, rise, np.tile(knots[:, 0], (count, 1)), np.tile(knots[:, 1], (count, 1))
    )


def _mansard(mesh: RoofMesh, eave: FloatArray, rise: FloatArray, envelope: FloatArray) -> RoofMesh:
    """Bend hipped roofs to a steep rim and a shallow slope above it."""
    count = mesh.count
    # Plan metres from an eave to the ridge: from the steepness of the faces beside the eaves.
    slope = np.hypot(*edge_slopes(mesh).T)
    part = mesh.rings.polygon[mesh.rings.ring_of_point]
    steepest = np.zeros(count)
    np.maximum.at(steepest, part, np.nan_to_num(slope))
    depth = np.where(steepest > 0, rise / np.maximum(steepest, 1e-6), envelope[:, 2] / 2)
    rim = np.maximum(STEEP_SHARE * rise, rise - UPPER_SLOPE * depth)
    run = np.minimum(STEEP_RUN * rim, MAX_STEEP_RUN * depth) / np.maximum(depth, 1e-6)
    none, whole = np.zeros(count), np.ones(count)
    share = np.clip(rim / rise, 0.1, 0.95)
    knots, heights = np.stack([none, run, whole], 1), np.stack([none, share, whole], 1)
    return bend_mesh(mesh, eave, rise, knots, heights)


def _flat(polygons: NDArray[Any], brief: RoofBrief) -> _Attempt:
    """Parapets where asked and possible (thick ones, then thin ones), plain tops elsewhere."""
    done: list[Solids] = []
    rest = polygons
    for thickness in (PARAPET_THICKNESS, PARAPET_THICKNESS / 2):
        asked = np.where(brief.parapet > 0, rest, shapely.Polygon())
        solids = parapet_roofs(
            asked, np.full(len(rest), thickness), brief.parapet, brief.low, brief.top, brief.zero
        )
        solids = solids.of_parts(~open_parts(solids, len(rest)))
        done.append(solids)
        got = np.zeros(len(rest), bool)
        got[solids.face_part] = True
        rest = np.where(got, shapely.Polygon(), rest)
    done.append(prisms(rest, brief.low, brief.top, brief.zero)[0])
    return _Attempt(join_solids(done))


def _hipped(
    kind: str, polygons: NDArray[Any], angle: FloatArray, eave: FloatArray, rise: FloatArray
) -> RoofMesh:
    """Rectangles by their closed form, the others by their skeleton."""
    none = shapely.Polygon()
    rectangle = is_rectangle(rings_of(polygons), len(polygons)) & (kind in RECTANGULAR)
    simple = rectangle_roofs(np.where(rectangle, polygons, none), kind, angle, eave, rise)
    first, others = ENDS.get(kind, (0.0, 0.0))
    general = skeleton_roofs(
        np.where(rectangle, none, polygons),
        eave,
        rise,
        first=first,
        others=others,
        gablets=kind == "hipped-and-gabled",
    )
    return join_meshes(simple, general)


def _welded(solids: Solids, count: int) -> Solids:
    """Give shells whose outline touches itself in a point one vertex there."""
    wrong = open_parts(solids, count)
    if not wrong.any():
        return solids
    return join_solids([solids.of_parts(~wrong), weld_touching(solids.of_parts(wrong))])


def _sound(
    solids: Solids, polygons: NDArray[Any], brief: RoofBrief, kind: str
) -> NDArray[np.bool_]:
    """Return which parts are closed, cover their plan and stay within their heights; (n,) bool."""
    count = len(polygons)
    part = solids.face_part
    good = ~open_parts(solids, count)
    good &= volumes_by_group(solids.vertices, solids.faces, part, count) > 0
    vector = area_vectors(solids.vertices, solids.faces)
    upward = np.bincount(part, np.maximum(vector[:, 2], 0.0), minlength=count)
    area = shapely.area(polygons)
    bulging = kind == "onion"
    if not bulging:
        tolerance = LOOSE_TOLERANCE if kind == "block" else AREA_TOLERANCE
        good &= np.abs(upward - area) <= tolerance * area
        size = np.linalg.norm(vector, axis=1)
        hanging = (solids.role == ROOF) & (vector[:, 2] < -1e-3 * np.maximum(size, 1e-6))
        good[part[hanging & (size > 1e-4)]] = False
    z, owner = solids.vertices[:, 2], solids.vertex_part
    outside = ~(z <= brief.top[owner] + HEIGHT_TOLERANCE) | ~(z >= brief.low[owner] - 1e-6)
    good[owner[outside]] = False
    return np.asarray(good)


def _eaves(attempt: _Attempt, brief: RoofBrief, good: NDArray[np.bool_], count: int) -> Solids:
    """Eave and verge bodies of the accepted parts, each edge in the plane of its own roof face."""
    mesh = attempt.mesh
    if mesh is None or len(mesh.head) == 0:
        return join_solids([])
    rings, head = mesh.rings, mesh.head
    part = rings.polygon[rings.ring_of_point]
    after, before = rings.following(), rings.preceding()
    slope = edge_slopes(mesh)
    vector = rings.points[after] - rings.points
    normal = np.column_stack([vector[:, 1], -vector[:, 0]])
    normal /= np.maximum(np.hypot(*vector.T), 1e-9)[:, None]
    outward = (slope * normal).sum(axis=1)
    # Where a roof rises outward an eave would top the building.
    allowed = good[part] & (outward < MAX_VERGE_RISE) & _free_edges(rings, brief)
    reach = np.where(outward > -0.5 * np.hypot(*slope.T), VERGE, 1.0)
    distance = np.where(allowed, reach * brief.overhang[part], 0.0)
    outer, active = overhang_points(rings, distance, count)
    # A corner lies in the planes of both of its edges, where both run out.
    move = outer - rings.points
    rise = (np.nan_to_num(slope) * move).sum(axis=1), (np.nan_to_num(slope[before]) * move).sum(1)
    both = active & active[before]
    change = np.where(both, (rise[0] + rise[1]) / 2, np.where(active, rise[0], rise[1]))
    outer_z = np.minimum(head + change, brief.top[part])
    # An eave that would reach the ground belongs to no house.
    sunk = outer_z - 1.0 < brief.low[part] + 0.5
    active &= ~sunk & ~sunk[after]
    solids = eave_bodies(rings, outer, active, head, outer_z, count)
    return solids.of_parts(~open_parts(solids, count))


def _free_edges(rings: Rings, brief: RoofBrief) -> NDArray[np.bool_]:
    """Whether each edge, perhaps a piece of an edge of the outline, has no neighbour."""
    outline = rings_of(shapely.from_wkb(brief.outlines))
    blocked = np.flatnonzero(~brief.free)
    if len(blocked) == 0:
        return np.ones(len(rings.points), bool)
    part = rings.polygon[rings.ring_of_point]
    middle = (rings.points + rings.points[rings.following()]) / 2
    after = outline.following()
    owner = outline.polygon[outline.ring_of_point]
    order = np.argsort(owner[blocked], kind="stable")
    blocked = blocked[order]
    first = np.searchsorted(owner[blocked], part)
    number = np.searchsorted(owner[blocked], part, side="right") - first
    pair = np.repeat(np.arange(len(part)), number)
    edge = blocked[np.repeat(first, number) + numbered(number)]
    a, b = outline.points[edge], outline.points[after[edge]]
    along = b - a
    length = np.maximum(np.hypot(*along.T), 1e-9)
    gap = middle[pair] - a
    aside = np.abs(along[:, 0] * gap[:, 1] - along[:, 1] * gap[:, 0]) / length
    place = (along * gap).sum(axis=1) / length
    on = (aside < 0.01) & (place > -0.01) & (place < length + 0.01)
    found = np.ones(len(part), bool)
    found[pair[on]] = False
    return found


def chunks(count: int, size: int) -> list[slice]:
    """Cut rows into runs of a fixed size, so that the number of processes changes nothing."""
    return [slice(start, min(start + size, count)) for start in range(0, count, size)]


def part_of_brief(brief: RoofBrief, rows: slice, points: IntArray) -> RoofBrief:
    """Return the brief of some rows; `points` are the (n + 1,) offsets of their ring points."""
    columns = {
        each.name: getattr(brief, each.name)[rows] for each in fields(brief) if each.name != "free"
    }
    return RoofBrief(**columns, free=brief.free[points[rows.start] : points[rows.stop]])


def as_shapes(values: ArrayLike) -> NDArray[np.str_]:
    """Map (n,) values of roof:shape to words of `SHAPES`."""
    words, index = np.unique(np.asarray(values, dtype=str), return_inverse=True)
    known = np.array([roof_shape(str(word)) for word in words], dtype=str)
    return np.asarray(known[index.ravel()])
