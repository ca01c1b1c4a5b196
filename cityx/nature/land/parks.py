"""Parks, playgrounds and pitches: benches along paths, beds, things to play on, lines of courts.

What stands in rows on other land comes from `cityx.nature.land.stocked_land`.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.assets.furniture.dressed import GROUND, Stuff, stuff_of
from cityx.assets.furniture.park_pieces import LINE, Court, basketball, football, tennis
from cityx.city import City, MeshBatch
from cityx.city.ground import LABEL
from cityx.city.mesh import one_mesh
from cityx.geometry.arrays import FloatArray
from cityx.geometry.clearance import near_any
from cityx.geometry.polylines import arc_lengths, every, locate, pack
from cityx.geometry.scatter import Points, poisson_in, thin
from cityx.ground.pieces import (
    Pieces,
    heights,
    in_carriageways,
    inside_extent,
    join_pieces,
    may_stand,
    pieces,
    with_pieces,
)
from cityx.ground.standing import LAWNS, stand_on
from cityx.ids import choose, hash_ids, mix, stable_id, uniform
from cityx.nature.furniture.asked_numbers import counted
from cityx.nature.land.barriers import joined_by_id
from cityx.nature.land.stocked_land import stocked_land
from cityx.protocol import Port, action
from cityx.road.ground.park_paths import ON_FOOT, PARKS, WIDTH, ParkPaths, park_paths
from cityx.road.markings.marks import painted_strips
from cityx.road.surface.kerbs import yaw_facing
from cityx.sources.features import measures

ACTION = "nature/parks-v1"
LAYER = "park_pieces"
BENCHES, BENCH_SHARE = 22.0, 0.6  # metres of path, and how many places have one
BIN_SHARE = 0.35  # of the benches that have a bin beside them
LAMPS = 32.0  # metres between the lamps of a park's paths
BESIDE = {"bench": 0.65, "waste_basket": 0.65, "street_lamp_post": 0.55}  # metres from the path
GREEN_AREAS = (*PARKS, "grass", "golf")
TRUNK_GAP, THING_GAP = 1.0, 1.4  # metres
ROW_GAP = 1.0  # metres from a path to the middle of a grave, a stall, a vine
LARGEST = 1.1  # metres, half the length of what stands beside paths
PLAY_SPACING = 6.5  # metres between the things of a playground
PLAY_EDGE = 1.8  # metres from them to its edge
PLAY = {"swing": 1.6, "slide": 1.6, "climbing_frame": 1.4, "spring_rider": 1.6, "sandpit": 1.2,
        "bench": 1.0, "picnic_table": 0.5}  # fmt: skip
LEAST_FIELD = 18.0  # metres, the shorter side of a field for football
GRASS_EDGE = 2.5  # metres between the lines of a field and the pitch's edge
FILL = 0.75  # share of its rectangle that a pitch must take to have lines
CELL = 4.0  # metres, pieces in which court surfaces follow the ground
OVER_GROUND, OVER_COURT = 0.008, 0.018  # metres


def path_lines(city: City, drawn: ParkPaths) -> tuple[NDArray[Any], FloatArray]:
    """(n,) paths through greens, mapped and drawn, and their half widths."""
    layout = city.layout
    roads, areas = layout.roads, layout.areas
    shapes = areas.geometry.to_numpy()[np.isin(areas["kind"].to_numpy().astype(str), GREEN_AREAS)]
    usable = np.isin(roads["kind"].to_numpy().astype(str), ON_FOOT[:3])
    usable &= ~roads["tunnel"].to_numpy() & ~roads["bridge"].to_numpy()
    ways = roads.geometry.to_numpy()[usable]
    half = np.nan_to_num(roads["width"].to_numpy()[usable] / 2, nan=1.0)
    if len(ways) and len(shapes):
        row = np.unique(shapely.STRtree(ways).query(shapes, predicate="intersects")[1])
        within = shapely.intersection(ways[row], shapely.unary_union(shapes))
        parts, index = shapely.get_parts(within, return_index=True)
        lines = shapely.get_type_id(parts) == 1
        ways, half = parts[lines], half[row][index[lines]]
    else:
        ways, half = np.zeros(0, object), np.zeros(0)
    return np.concatenate([ways, drawn.lines]), np.concatenate([half, drawn.width / 2])


def _line_ids(lines: NDArray[Any]) -> NDArray[np.uint64]:
    first = np.round(shapely.get_coordinates(shapely.get_point(lines, 0)) * 100).astype(np.int64)
    last = np.round(shapely.length(lines) * 100).astype(np.int64)
    key = mix(first[:, 0].view(np.uint64)) ^ np.ascontiguousarray(first[:, 1]).view(np.uint64)
    return hash_ids(0, ACTION, mix(key), last)


def _off_ways(city: City, rows: Pieces, drawn: ParkPaths) -> Pieces:
    """Return what stands in rows without what would stand on a way or hang over it."""
    roads = city.layout.roads
    open_air = ~(roads["tunnel"] | roads["bridge"]).to_numpy(bool)
    half = np.nan_to_num(roads["width"].to_numpy()[open_air] / 2, nan=1.0)
    middles, radius = shapely.points(drawn.middles[:, :2]), drawn.middles[:, 2] + WIDTH
    shapes = np.concatenate([roads.geometry.to_numpy()[open_air], drawn.lines, middles])
    reach = np.concatenate([half, drawn.width / 2, radius])
    return rows.take(~near_any(rows.xy, shapes, reach + ROW_GAP))


def _beside_paths(city: City, drawn: ParkPaths) -> Pieces:
    """Benches, bins and lamps at the edges of paths, their fronts to the path."""
    shapes, half = path_lines(city, drawn)
    long = shapely.length(shapes) > 6.0 if len(shapes) else np.zeros(0, bool)
    shapes, half = shapes[long], half[long]
    if not len(shapes):
        return join_pieces([])
    lines, own = pack(shapes), _line_ids(shapes)
    found = []
    for name, spacing in (("bench", BENCHES), ("street_lamp_post", LAMPS)):
        line, along = every(arc_lengths(lines)[1], spacing, 3.0)
        number = np.arange(len(line)) - np.searchsorted(line, line)
        ids = hash_ids(0, f"{ACTION}/{name}", own[line], number)
        side = np.where(hash_ids(0, f"{ACTION}/side", own[line], number) % 2 == 0, 1.0, -1.0)
        if name == "bench":
            slip = spacing * 0.3 * (uniform(city.seed, f"{ACTION}/slip", ids) - 0.5)
            along = along + slip
        else:
            along = along + 0.25 * spacing
        keep = along < arc_lengths(lines)[1][line] - 2.0
        if name == "bench":
            keep &= uniform(city.seed, f"{ACTION}/bench", ids) < BENCH_SHARE
        line, along, ids, side = line[keep], along[keep], ids[keep], side[keep]
        position, ahead = locate(lines, line, along)
        left = np.column_stack([-ahead[:, 1], ahead[:, 0]]) * side[:, None]
        offset = (half[line] + BESIDE[name])[:, None]
        found.append(pieces(name, position + left * offset, ids, yaw_facing(-left)))
        if name == "bench":
            bins = uniform(city.seed, f"{ACTION}/bin", ids) < BIN_SHARE
            at = position + left * offset + 1.5 * ahead
            extra = hash_ids(0, f"{ACTION}/bin", ids)
            found.append(pieces("waste_basket", at, extra, yaw_facing(-left)).take(bins))
    group = join_pieces(found)
    label = stand_on(city.scene.meshes.get("ground"), group.xy).label
    lawn = [LABEL[name] for name in (*LAWNS, "wood", "bare", "courtyard", "plaza")]
    mapped = city.scene.instances.get("street_furniture")
    there = np.zeros((0, 2)) if mapped is None else mapped.position[:, :2]
    keep = np.isin(label, lawn) & inside_extent(city, group.xy, 1.0)
    keep &= ~near_any(group.xy, shapely.points(there), 6.0)
    # Where paths meet, their things must not stand on each other's path.
    keep &= ~near_any(group.xy, shapes, half + 0.35)
    group = group.take(keep)
    return group.take(np.isin(group.id, thin(Points(group.xy, group.id), 1.3).id))


def _middles(city: City, drawn: ParkPaths) -> Pieces:
    """Beds in the middle of parks with drawn paths, benches round them, boards at the gates."""
    found = []
    if len(drawn.middles):
        xy, radius = drawn.middles[:, :2], drawn.middles[:, 2]
        cm = np.round(xy * 100).astype(np.int64)
        key = mix(mix(cm[:, 0].view(np.uint64)) ^ np.ascontiguousarray(cm[:, 1]).view(np.uint64))
        heart = uniform(city.seed, f"{ACTION}/heart", key)
        names = np.select([heart < 0.3, heart < 0.45], ["fountain", "statue"], "flower_bed")
        ids = hash_ids(0, f"{ACTION}/middle", key)
        found.append(pieces(names.astype(object), xy, ids, np.zeros(len(xy))))
        for number in range(6):
            turn = (number + 0.5) * np.pi / 3
            out = np.array([np.cos(turn), np.sin(turn)])
            name = "bench" if number % 2 == 0 else "flower_bed"
            far = radius + (2.0 if name == "bench" else 4.4)
            at = xy + far[:, None] * out
            yaw = np.full(len(xy), yaw_facing(-out[None])[0])
            found.append(pieces(name, at, hash_ids(0, f"{ACTION}/round", key, number), yaw))
    if len(drawn.gates):
        cm = np.round(drawn.gates * 100).astype(np.int64)
        key = mix(mix(cm[:, 0].view(np.uint64)) ^ np.ascontiguousarray(cm[:, 1]).view(np.uint64))
        some = uniform(city.seed, f"{ACTION}/board", key) < 0.4
        at = drawn.gates[some] + np.array([2.4, 0.8])
        ids = hash_ids(0, f"{ACTION}/board", key[some])
        found.append(pieces("park_board", at, ids, np.zeros(len(at))))
    group = join_pieces(found)
    label = stand_on(city.scene.meshes.get("ground"), group.xy).label
    good = [LABEL[name] for name in (*LAWNS, "trail")]
    return group.take(np.isin(label, good) & inside_extent(city, group.xy, 1.0))


def _playgrounds(city: City) -> Pieces:
    """Things to play on, apart from each other and from the edge."""
    areas = city.layout.areas
    shapes = areas.geometry.to_numpy()[(areas["kind"] == "playground").to_numpy()]
    inner = shapely.buffer(shapes, -PLAY_EDGE)
    inner = shapely.get_parts(inner)
    inner = inner[shapely.area(inner) > 1.0]
    if not len(inner):
        return join_pieces([])
    spots = poisson_in(inner, PLAY_SPACING, seed=city.seed, purpose=f"{ACTION}/play")
    drawn = choose(city.seed, f"{ACTION}/play", spots.id, list(PLAY.values()))
    names = np.array(list(PLAY), object)[drawn]
    turn = np.round(4 * uniform(city.seed, f"{ACTION}/turn", spots.id)) * np.pi / 2
    slant = 0.5 * (uniform(city.seed, f"{ACTION}/slant", spots.id) - 0.5)
    label = stand_on(city.scene.meshes.get("ground"), spots.xy).label
    keep = (label == LABEL["playground"]) & inside_extent(city, spots.xy, 1.5)
    return pieces(names, spots.xy, spots.id, turn + slant).take(keep)


@dataclass(frozen=True)
class _Field:
    """A court in the scene: where its middle lies and which way its length runs."""

    court: Court
    middle: FloatArray
    along: FloatArray
    owner: int


def sport_of(tags: str) -> tuple[str, str]:
    """Return the first known sport of a pitch, or "", and its surface."""
    words = json.loads(tags) if tags else {}
    known = {"soccer": "football", "football": "football", "basketball": "basketball",
             "tennis": "tennis", "multi": "multi", "streetball": "basketball"}  # fmt: skip
    for word in str(words.get("sport", "")).split(";"):
        if word.strip() in known:
            return known[word.strip()], str(words.get("surface", ""))
    return "", str(words.get("surface", ""))


def court_id(area: int, number: int) -> int:
    """Return the id of the surface of a court of an area, so many surfaces behind the first."""
    return stable_id("court", area, number)


def color_of(tags: str) -> int:
    """Return the colour of a pitch by its tags, sRGB, `NO_COLOR` where they tell none."""
    words = json.loads(tags) if tags else {}
    return measures.color(str(words.get("colour", words.get("color", ""))))


def _fields(city: City) -> list[_Field]:
    """Fit courts into the rectangles of pitches: one field, or as many courts as there is room."""
    areas = city.layout.areas
    found = []
    for row in np.flatnonzero((areas["kind"] == "pitch").to_numpy()).tolist():
        shape = areas.geometry.to_numpy()[row]
        frame = shapely.oriented_envelope(shape)
        corner = shapely.get_coordinates(frame)
        if len(corner) < 5 or shapely.area(shape) < FILL * shapely.area(frame):
            continue
        a, b = corner[1] - corner[0], corner[2] - corner[1]
        if np.hypot(*a) < np.hypot(*b):
            a, b = b, -a
        length, width = float(np.hypot(*a)), float(np.hypot(*b))
        u, v = a / length, b / width
        middle = corner[:4].mean(axis=0)
        sport, surface = sport_of(str(areas["tags"].iloc[row]))
        owner = int(areas["id"].iloc[row])
        if sport == "multi":
            sport = "basketball" if length * width < 900.0 else "football"
        if sport in ("tennis", "basketball"):
            court = tennis("clay" in surface) if sport == "tennis" else basketball()
            if (color := color_of(str(areas["tags"].iloc[row]))) >= 0:
                court = replace(court, paint=color)
            found += _courts(court, middle, u, v, length, width, owner)
            continue
        played = sport == "football" or (not sport and length * width > 1500.0)
        size = np.array([length, width]) - 2 * GRASS_EDGE
        if played and size[1] >= LEAST_FIELD:
            court = football(min(size[0], 105.0), min(size[1], 68.0))
            found.append(_Field(court, middle, u, owner))
    return found


def _courts(court: Court, middle: FloatArray, u: FloatArray, v: FloatArray, length: float,
            width: float, owner: int) -> list[_Field]:  # fmt: skip
    """Rows of courts in a rectangle, the way round that holds more; margins may shrink to 0.6 m."""
    best: list[_Field] = []
    for first, second, x, y in ((u, v, length, width), (v, u, width, length)):
        long, short = court.length + 1.2, court.width + 1.2
        count = (int(x // (court.length + court.margin[0])) or int(x >= long),
                 int(y // (court.width + court.margin[1])) or int(y >= short))  # fmt: skip
        if count[0] * count[1] <= len(best):
            continue
        best = [
            _Field(court, middle + first * ((i + 0.5) / count[0] - 0.5) * x
                   + second * ((j + 0.5) / count[1] - 0.5) * y, first, owner)
            for i in range(count[0]) for j in range(count[1])
        ]  # fmt: skip
    return best


def _in_world(field: _Field, local: FloatArray) -> FloatArray:
    across = np.array([-field.along[1], field.along[0]])
    return np.asarray(field.middle + local[:, :1] * field.along + local[:, 1:] * across)


def _painted(city: City, fields: list[_Field]) -> list[MeshBatch]:
    """Surfaces and lines of courts, laid over the ground."""
    if not fields:
        return []
    found: list[MeshBatch] = []
    hard = [field for field in fields if field.court.surface is not None]
    for field in hard:
        a = field.court.length / 2 + min(field.court.margin[0] / 2, 2.0)
        b = field.court.width / 2 + min(field.court.margin[1] / 2, 1.2)
        s, t = (np.linspace(-c, c, max(2, round(2 * c / CELL) + 1)) for c in (a, b))
        grid = np.stack(np.meshgrid(s, t, indexing="ij"), axis=-1)
        world = _in_world(field, grid.reshape(-1, 2))
        at = np.arange(len(world)).reshape(grid.shape[:2])
        quads = np.stack([at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]], axis=-1)
        quads = quads.reshape(-1, 4)
        faces = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
        uv = np.zeros((len(faces), 4, 2))
        uv[:, :3] = world[faces]
        vertices = np.column_stack([world, heights(city, world) + OVER_GROUND])
        stuff = Stuff("concrete", field.court.surface or (1.0, 1.0, 1.0))
        if field.court.paint >= 0:
            stuff = stuff_of("", field.court.paint, GROUND, "concrete")
        found.append(
            one_mesh(court_id(field.owner, len(found)), vertices, faces,
                     materials=(stuff.material,), uv=uv, tint=stuff.tint)
        )  # fmt: skip
    drawn = [(_in_world(field, line), field) for field in fields for line in field.court.lines]
    shapes = shapely.segmentize([shapely.LineString(line) for line, _ in drawn], CELL)
    lines = pack(np.asarray(shapes, dtype=object))
    return [*found, painted_strips(city, lines, LINE, OVER_COURT, stable_id("courts", "lines"))]


def _equipment(city: City, fields: list[_Field]) -> Pieces:
    """Goals, hoops and nets."""
    found = []
    for field in fields:
        for k, (name, x, y, looks) in enumerate(field.court.things):
            at = _in_world(field, np.array([[x, y]]))
            if name == "tennis_net":  # spans the court, along its own x
                yaw = np.arctan2(field.along[1], field.along[0]) + np.pi / 2
            else:
                turn = np.arctan2(field.along[1], field.along[0]) + looks
                yaw = float(yaw_facing([[np.cos(turn), np.sin(turn)]])[0])
            middle = np.round(field.middle * 100).astype(int)
            own = np.array([stable_id(ACTION, field.owner, *middle.tolist(), k)], np.uint64)
            group = pieces(name, at, own, np.array([yaw]))
            if name == "football_goal":
                size = np.clip(field.court.width / 45.0, 0.6, 1.22)
                group = replace(group, scale=np.array([size]))
            found.append(group)
    group = join_pieces(found)
    return group.take(inside_extent(city, group.xy, 1.0))


@action(
    ACTION,
    limits=[
        "Only football, basketball and tennis have lines; others stay plain.",
        "Needs the draped ground.",
    ],
    requires=("layout",),
    after=("nature/trees-v2", "nature/furniture-v1"),
    takes=(Port("ground", "surface", role="ground", optional=True),),
    gives=(Port("furniture", "point", role="park_furniture"),),
    labels=("park", "playground", "pitch", "flower beds", "sports field", "park benches"),
)
def parks(city: City) -> City:
    """Furnish parks, playgrounds, pitches, cemeteries..., and paint the lines of games.

    Parameters
    ----------
    city
        City with its ground laid out and draped.
    """
    city = replace(city, stages_done=city.stages_done | {"nature"})
    if city.lod < 2 or city.ground is None or "ground" not in city.scene.meshes:
        return city
    fields = _fields(city)
    painted = _painted(city, fields)
    if painted:
        city = replace(city, scene=city.scene.with_mesh("courts", joined_by_id(painted)))
    drawn = park_paths(city.layout)
    soft = join_pieces([_middles(city, drawn), _playgrounds(city), _beside_paths(city, drawn)])
    trunks = city.scene.instances.get("trees")
    soft = soft.take(~in_carriageways(city, soft.xy, np.full(len(soft), LARGEST)))
    soft = join_pieces([soft, _off_ways(city, stocked_land(city), drawn)])
    if trunks is not None and len(soft):
        spots = shapely.points(trunks.position[:, :2])
        soft = soft.take(~near_any(soft.xy, spots, TRUNK_GAP))
    soft = soft.take(~near_any(soft.xy, city.layout.buildings.geometry.to_numpy(), THING_GAP))
    hard = _equipment(city, fields)
    found = join_pieces([soft, hard])
    found = found.take(~counted(city, found))
    found = found.take(may_stand(city, found))
    return with_pieces(city, LAYER, found) if len(found) else city
