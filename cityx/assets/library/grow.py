"""Growth: assets materialised from our own generators, as many as asked for.

Buildings are grown in batches: a made-up city of plots that lie too far apart to know of each
other, run through the building actions. So an asset depends on its number and the seed alone.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.assets.library.descriptions import (
    building_sentence,
    color_words,
    thing_sentence,
)
from cityx.assets.library.encoding import Encoder
from cityx.assets.library.models import Models, models_of_prototypes, models_of_scene
from cityx.assets.library.records import Catalogue, make_catalogue, rectangle_columns
from cityx.assets.library.store import Library, LibraryWriter
from cityx.city.city import City
from cityx.city.scene import Prototype
from cityx.errors import UsageError, nearest
from cityx.geometry.identity import choose, stable_id, uniform
from cityx.geometry.polygons import FloatArray

GROWN_GROUPS = ("buildings", "plants", "vehicles", "people", "furniture")
LICENCE = "CC0-1.0"  # of what our generators make; the program itself is Apache-2.0
BATCH = 64  # buildings grown together; fixed, so that the number asked for changes nothing
SPACING = 400.0  # metres between plots, further than anything looks about for neighbours
SHARES = {"buildings": 0.92, "plants": 0.03, "vehicles": 0.025, "people": 0.01,
          "furniture": 0.015}  # fmt: skip
FRONT = np.pi  # compass radians; prototypes face -y, which is south
STANDING = 0.5  # metres; parts that begin lower stand on the ground
NEIGHBOUR = 5.0  # metres, width of the neighbours that make a side wall blind

Say = Callable[[str], None]


@dataclass(frozen=True)
class Recipe:
    """A way to make buildings.

    Attributes
    ----------
    name
        Kept in the records.
    share
        How often it is used, relative to the others.
    actions
        Registered actions, run in order on a city of plots; (id, arguments).
    uses
        Uses it may be asked for, () for all.
    """

    name: str
    share: float
    actions: tuple[tuple[str, Mapping[str, Any]], ...]
    uses: tuple[str, ...] = ()


# Generators are added by a row each; the draw of a batch is by number, so older batches stay.
RECIPES: tuple[Recipe, ...] = (
    Recipe(
        "facade grammar",
        1.0,
        (("building/design-v1", {}), ("building/shell-v1", {}), ("building/facade-v1", {})),
    ),
)


@dataclass(frozen=True)
class Plot:
    """What plots of one use are like; medians and spreads are of log-normal draws.

    Attributes
    ----------
    share
        Share among grown buildings.
    front, depth
        (median, spread of the logarithm, least, most), metres.
    levels
        (least, most, power): the draw is raised to the power, so that few are tall.
    storey
        (least, most) metres.
    roofs
        Shapes and weights.
    terraced
        Share of those with neighbours at a side.
    osm
        Value of building=*.
    """

    share: float
    front: tuple[float, float, float, float]
    depth: tuple[float, float, float, float]
    levels: tuple[int, int, float]
    storey: tuple[float, float]
    roofs: Mapping[str, float]
    terraced: float
    osm: str


_PITCHED = {"gabled": 6, "hipped": 3, "half-hipped": 1, "mansard": 1, "gambrel": 0.5,
            "skillion": 0.5, "flat": 1.5}  # fmt: skip
# Sizes are after the outlines of the OSM extracts the program is tested on: quartiles by use.
PLOTS: Mapping[str, Plot] = MappingProxyType(
    {
        "house": Plot(0.34, (9.5, 0.38, 4.0, 26.0), (10.0, 0.34, 4.5, 26.0), (1, 3, 1.0),
                      (2.7, 3.1), _PITCHED, 0.35, "house"),
        "flats": Plot(0.29, (15.0, 0.55, 4.5, 90.0), (12.5, 0.36, 5.0, 45.0), (2, 12, 2.0),
                      (2.8, 3.5), {"flat": 5, "gabled": 3, "hipped": 2, "mansard": 2}, 0.5,
                      "apartments"),
        "office": Plot(0.11, (22.0, 0.55, 7.0, 110.0), (18.0, 0.45, 7.0, 70.0), (2, 32, 2.6),
                       (3.3, 4.0), {"flat": 9, "hipped": 0.5, "mansard": 0.5}, 0.3, "office"),
        "retail": Plot(0.09, (14.0, 0.6, 5.0, 90.0), (15.0, 0.5, 5.0, 70.0), (1, 3, 1.4),
                       (3.4, 4.6), {"flat": 7, "gabled": 2, "hipped": 1}, 0.4, "retail"),
        "industry": Plot(0.06, (26.0, 0.6, 7.0, 130.0), (22.0, 0.5, 7.0, 90.0), (1, 2, 1.0),
                         (4.2, 6.0), {"flat": 5, "gabled": 4, "skillion": 1, "round": 0.5}, 0.05,
                         "industrial"),
        "civic": Plot(0.04, (28.0, 0.5, 9.0, 110.0), (17.0, 0.4, 8.0, 60.0), (1, 5, 1.2),
                      (3.4, 4.2), {"flat": 5, "hipped": 3, "gabled": 3}, 0.05, "school"),
        "shed": Plot(0.06, (4.6, 0.45, 1.8, 16.0), (4.8, 0.4, 1.8, 14.0), (1, 1, 1.0),
                     (2.5, 2.9), {"flat": 4, "gabled": 4, "skillion": 3}, 0.1, "shed"),
        "worship": Plot(0.01, (13.0, 0.4, 6.0, 40.0), (25.0, 0.4, 10.0, 80.0), (1, 1, 1.0),
                        (5.5, 6.0), {"gabled": 6, "hipped": 1}, 0.0, "church"),
    }
)  # fmt: skip
STYLE_PLACES = {
    "american": (41.9, -87.6), "brick": (51.5, -0.1), "mediterranean": (41.9, 12.5),
    "asian": (35.7, 139.7),
}  # fmt: skip
EUROPE = (50.1, 8.7)


@dataclass(frozen=True)
class Plots:
    """n drawn plots; fields are (n,) and mean what the columns of a layout mean."""

    number: NDArray[np.int64]
    id: NDArray[np.uint64]
    use: NDArray[np.str_]
    front: FloatArray
    depth: FloatArray
    levels: NDArray[np.int64]
    storey: FloatArray
    roof: NDArray[np.str_]
    roof_height: FloatArray
    party: NDArray[np.int64]


def draw_plots(numbers: NDArray[np.int64], seed: int, uses: Sequence[str] = ()) -> Plots:
    """Draw plots by number: the same number and seed give the same plot."""
    ids = np.array([stable_id("grown", seed, int(n)) for n in numbers], np.uint64)
    names = np.array([use for use in PLOTS if not uses or use in uses])
    which = choose(seed, "grow/use", ids, [PLOTS[use].share for use in names.tolist()])
    rules = [PLOTS[use] for use in names[which].tolist()]

    def lognormal(what: str, side: str) -> FloatArray:
        median, spread, low, high = np.array([getattr(rule, side) for rule in rules]).T
        # Box and Muller: two uniform draws make a normal one.
        radius = np.sqrt(-2 * np.log(np.maximum(uniform(seed, what, ids), 1e-12)))
        normal = radius * np.cos(2 * np.pi * uniform(seed, what, ids, 1))
        return np.asarray(np.round(np.clip(median * np.exp(spread * normal), low, high), 2))

    front, depth = lognormal("grow/front", "front"), lognormal("grow/depth", "depth")
    least, most, power = np.array([rule.levels for rule in rules], float).T
    share = uniform(seed, "grow/levels", ids) ** power
    # Nobody builds needles: a tower is at most eight times as high as its front is wide.
    most = np.maximum(least, np.minimum(most, np.floor(8 * np.minimum(front, depth) / 3.4)))
    levels = (least + np.floor(share * (most - least + 1))).clip(least, most).astype(np.int64)
    low, high = np.array([rule.storey for rule in rules]).T
    storey = np.round(low + (high - low) * uniform(seed, "grow/storey", ids), 2)
    draw = uniform(seed, "grow/roof", ids)
    roof = np.array([_drawn(rule.roofs, value) for rule, value in zip(rules, draw, strict=True)])
    roof = np.where(levels > 6, "flat", roof)
    slope = 0.45 + 0.35 * uniform(seed, "grow/slope", ids)
    height = np.round(np.clip(slope * np.minimum(front, depth) / 2, 0.8, 7.0), 2)
    height = np.where(roof == "flat", 0.0, np.where(roof == "skillion", 0.4 * height, height))
    side = uniform(seed, "grow/party", ids)
    terraced = side < [rule.terraced for rule in rules]
    party = np.where(terraced, 1 + np.floor(3 * uniform(seed, "grow/side", ids)), 0)
    return Plots(np.asarray(numbers, np.int64), ids, names[which], front, depth, levels, storey,
                 roof, height, party.astype(np.int64))  # fmt: skip


def _drawn(weights: Mapping[str, float], value: float) -> str:
    edges = np.cumsum(list(weights.values()))
    return list(weights)[int(np.searchsorted(edges, value * edges[-1], side="right"))]


def plots_to_city(plots: Plots, seed: int, style: str) -> tuple[City, FloatArray]:
    """Lay plots out on a plane, each at a street to its south, with its neighbours.

    Returns
    -------
    city
        Neighbours have ids of their own.
    origin
        (n, 3) middle of each plot on the ground.
    """
    from cityx.city.frame import Frame
    from cityx.city.layout import Layout, make_table

    count = len(plots.id)
    # The place follows from the number: where a plot lies must not depend on the batch.
    cell = plots.number % BATCH
    columns = math.ceil(math.sqrt(BATCH))
    x, y = (cell % columns) * SPACING, (cell // columns) * SPACING
    half, deep = plots.front / 2, plots.depth / 2
    shapes = [shapely.box(x - half, y - deep, x + half, y + deep)]
    owner = [np.arange(count)]
    ids = [plots.id]
    for bit, sign in ((1, -1.0), (2, 1.0)):
        of = np.flatnonzero(plots.party & bit)
        near, far = x[of] + sign * half[of], x[of] + sign * (half[of] + NEIGHBOUR)
        shapes.append(shapely.box(np.minimum(near, far), y[of] - deep[of],
                                  np.maximum(near, far), y[of] + deep[of]))  # fmt: skip
        owner.append(of)
        ids.append(np.array([stable_id("neighbour", bit, int(i)) for i in plots.id[of]], np.uint64))
    of = np.concatenate(owner)
    every, outline = np.concatenate(ids), np.concatenate(shapes)
    osm = np.array([PLOTS[use].osm for use in plots.use.tolist()])[of]
    height = (plots.levels * plots.storey + plots.roof_height)[of]
    none = np.full(len(of), -1)
    buildings = make_table(
        "buildings", outline, id=every, use=osm, levels=plots.levels[of], height=height,
        place=np.where(plots.levels[of] > 3, "urban", "low"),
    )  # fmt: skip
    parts = make_table(
        "parts", outline, id=every, building=every, use=osm, base=np.zeros(len(of)), top=height,
        levels=plots.levels[of], roof_shape=plots.roof[of], roof_height=plots.roof_height[of],
        roof_direction=np.full(len(of), np.nan), walls=np.ones(len(of), bool), wall_color=none,
        roof_color=none,
    )  # fmt: skip
    street = np.stack(
        [np.column_stack([x + side * (half + 12.0), y - deep - 9.0]) for side in (-1.0, 1.0)],
        axis=1,
    )
    roads = make_table(
        "roads", shapely.linestrings(street), id=plots.id, kind=np.full(count, "residential"),
        width=np.full(count, 6.0), lanes=np.full(count, 2),
    )  # fmt: skip
    edge = columns * SPACING
    layout = Layout((-SPACING, -SPACING, edge, edge), buildings, parts, roads)
    city = City(
        "plots", Frame(*STYLE_PLACES.get(style, EUROPE)), layout, seed=seed, style=style,
        stages_done=frozenset({"layout", "terrain"}),
    )  # fmt: skip
    from cityx.city.ground import KERB_HEIGHT

    return city, np.column_stack([x, y, np.full(count, KERB_HEIGHT)])


def grow_buildings(
    numbers: NDArray[np.int64], seed: int, *, uses: Sequence[str] = ()
) -> tuple[Catalogue, Models]:
    """Grow the buildings of one batch.

    Parameters
    ----------
    numbers
        (n,) numbers, all of one batch of `BATCH`.
    seed
        Key of all draws.
    uses
        Keys of `PLOTS` to choose from, () for all.
    """
    from cityx.assets.palettes import STYLES
    from cityx.protocol import registry
    from cityx.protocol.run import Call, run_action

    batch = np.array([stable_id("batch", seed, int(numbers[0]) // BATCH)], np.uint64)
    style = STYLES[int(numbers[0]) // BATCH % len(STYLES)]
    recipe = RECIPES[int(choose(seed, "grow/recipe", batch, [r.share for r in RECIPES])[0])]
    plots = draw_plots(np.asarray(numbers), seed, uses or recipe.uses)
    city, origin = plots_to_city(plots, seed, style)
    actions = registry(outside=False)
    for action, arguments in recipe.actions:
        city = run_action(city, Call(action, dict(arguments)), actions).city
    models = models_of_scene(city.scene, plots.id, origin)
    footprint = _footprints(city, plots, origin)
    generator = _generators(city, plots.id)
    wall, roof = main_surfaces(models)
    height = models_height(models)
    sentences = [
        building_sentence(
            use=str(plots.use[i]), style=style, generator=generator[i] or recipe.name,
            levels=int(plots.levels[i]), height=float(height[i]),
            size=(float(plots.front[i]), float(plots.depth[i])), wall=wall[i],
            roof=(str(plots.roof[i]), roof[i][1]), party=int(plots.party[i]),
        )
        for i in range(len(plots.id))
    ]  # fmt: skip
    names = [
        f"{style}_{use}_{number:06d}"
        for use, number in zip(plots.use.tolist(), plots.number.tolist(), strict=True)
    ]
    records = make_catalogue(
        len(plots.id), group="buildings", collection=names, style=style, footprint=footprint,
        front=FRONT, height=height, levels=plots.levels, storey_height=plots.storey,
        use=plots.use, party=plots.party, licence=LICENCE, description=sentences,
        source="procedural", generator=[word or recipe.name for word in generator],
        **rectangle_columns(footprint),
    )  # fmt: skip
    # A generator that gave up on a plot made no asset.
    good = np.flatnonzero(np.diff(models.shells.face_start) > 0)
    return records.take(good), models.take(good)


def _generators(city: City, ids: NDArray[np.uint64]) -> list[str]:
    """Name the generator of each building, "" where the layout does not say."""
    table = city.layout.buildings
    if "generator" not in table.columns:
        return [""] * len(ids)
    row = np.searchsorted(table["id"].to_numpy(np.uint64), ids)
    return [word.replace("_", " ") for word in table["generator"].to_numpy(str)[row].tolist()]


def _footprints(city: City, plots: Plots, origin: FloatArray) -> NDArray[Any]:
    """Outlines on the ground, (n,) polygons about the middle of each plot."""
    parts = city.layout.parts
    owner = parts["building"].to_numpy(np.uint64)
    standing = parts["base"].to_numpy(float) < STANDING
    shapes = parts.geometry.to_numpy()
    out = np.empty(len(plots.id), object)
    for row, number in enumerate(plots.id):
        own = shapes[(owner == number) & standing]
        whole = own[0] if len(own) == 1 else shapely.union_all(own, grid_size=1e-3)
        pieces = [piece for piece in shapely.get_parts(whole) if piece.area > 0.1]
        # Several bodies stand on what lies between them, too.
        whole = pieces[0] if len(pieces) == 1 else shapely.convex_hull(whole)
        if shapely.is_empty(whole) or shapely.get_type_id(whole) != 3:
            half, deep = plots.front[row] / 2, plots.depth[row] / 2
            whole = shapely.box(
                *(origin[row, :2] - (half, deep)), *(origin[row, :2] + (half, deep))
            )
        out[row] = shapely.Polygon(whole.exterior)
    local = shapely.transform(out, lambda points: points)  # a copy
    points, row = shapely.get_coordinates(local, return_index=True)
    moved = np.round(points - origin[row, :2], 3) + 0.0
    return np.asarray(shapely.orient_polygons(shapely.set_coordinates(local, moved)))


def main_surfaces(models: Models) -> tuple[list[tuple[str, str]], list[tuple[str, str]]]:
    """Name colour and material of the largest walls and roofs of every shell.

    Returns
    -------
    wall, roof
        (colour word, material) per asset; ("", "") where there is none.
    """
    from cityx.assets.materials import MATERIALS
    from cityx.geometry.solids import area_vectors

    shells = models.shells
    vector = area_vectors(shells.vertices, shells.faces)
    area = np.linalg.norm(vector, axis=1)
    of = shells.face_object()
    base = np.array([MATERIALS[name].color for name in shells.materials] or [(1.0, 1.0, 1.0)])
    seen = base[shells.material] * shells.tint
    kinds = len(shells.materials)
    found = []
    for chosen in (
        np.abs(vector[:, 2]) < 0.3 * area,
        vector[:, 2] > 0.3 * area,
    ):
        rows = np.flatnonzero(chosen & (area > 0))
        code = of[rows] * kinds + shells.material[rows]
        size = np.bincount(code, weights=area[rows], minlength=models.count * kinds)
        most = size.reshape(models.count, kinds).argmax(axis=1)
        key = np.arange(models.count) * kinds + most
        total = np.maximum(size[key], 1e-12)
        color = np.stack(
            [
                np.bincount(code, weights=area[rows] * seen[rows, c], minlength=len(size))[key]
                for c in range(3)
            ],
            axis=1,
        )
        words = color_words(color / total[:, None]).tolist()
        found.append(
            [
                (word, shells.materials[number]) if size[place] > 0 else ("", "")
                for word, number, place in zip(words, most.tolist(), key.tolist(), strict=True)
            ]
        )
    return found[0], found[1]


def models_height(models: Models) -> FloatArray:
    """Return the highest vertex of every shell, (n,) metres; 0 of an empty one."""
    high = np.zeros(models.count)
    filled = np.flatnonzero(np.diff(models.shells.vertex_start) > 0)
    if len(filled):
        z = models.shells.vertices[:, 2]
        high[filled] = np.maximum.reduceat(z, models.shells.vertex_start[:-1][filled])
    return high


# --- plants, vehicles, people, furniture ----------------------------------------------------------

_PLANT_WORDS = {
    "lime": "lime tree, broadleaf street tree", "plane": "plane tree, broadleaf street tree",
    "maple": "maple tree, broadleaf", "oak": "oak tree, broad crown",
    "poplar": "poplar, slender columnar tree", "birch": "birch tree, light crown, pale bark",
    "cherry": "cherry tree, small ornamental", "pine": "pine, evergreen conifer",
    "spruce": "spruce, evergreen conifer, needles", "cypress": "cypress, slim dark evergreen",
    "shrub": "shrub, bush", "palm": "palm tree, tropical",
    "chestnut": "horse chestnut tree, broad crown", "ginkgo": "ginkgo, golden in autumn",
    "zelkova": "zelkova tree, vase-shaped broadleaf", "camphor": "camphor, evergreen broadleaf",
    "willow": "weeping willow, hanging branches", "jacaranda": "jacaranda, violet blossom",
    "acacia": "acacia, flat umbrella crown", "olive": "olive tree, grey evergreen",
    "boxwood": "boxwood, clipped evergreen bush",
}  # fmt: skip
_VEHICLE_WORDS = {"hatchback": "hatchback, small car", "sedan": "sedan, saloon car",
                  "suv": "sport utility vehicle, suv", "van": "panel van, delivery van",
                  "bus": "city bus"}  # fmt: skip


def _plants(numbers: Sequence[int]) -> tuple[list[Prototype], list[str], list[str]]:
    from cityx.assets.trees import plant

    kinds = list(_PLANT_WORDS)
    names = [kinds[number % len(kinds)] for number in numbers]
    made = [plant(name, number // len(kinds), "light")
            for name, number in zip(names, numbers, strict=True)]  # fmt: skip
    return made, [_PLANT_WORDS[name] for name in names], names


def _vehicles(numbers: Sequence[int]) -> tuple[list[Prototype], list[str], list[str]]:
    from cityx.assets.furniture import furniture
    from cityx.assets.vehicles import PAINTS, car

    kinds = list(_VEHICLE_WORDS)
    colors = color_words(PAINTS * 0.8)
    made, words = [], []
    for number in numbers:
        kind, paint = kinds[number % len(kinds)], number // len(kinds)
        body = furniture("bus") if kind == "bus" else car(kind)
        made.append(_painted(body, PAINTS[paint], f"{body.name}_{paint}"))
        words.append(f"{colors[paint]} {_VEHICLE_WORDS[kind]}")
    return made, words, [kinds[number % len(kinds)] for number in numbers]


def _painted(prototype: Prototype, paint: Any, name: str) -> Prototype:
    mesh = prototype.mesh
    is_paint = np.array([material == "car_paint" for material in mesh.materials])[mesh.material]
    tint = np.where(is_paint[:, None], np.asarray(paint, np.float32), mesh.tint)
    return Prototype(name, prototype.kind, replace(mesh, tint=tint.astype(np.float32)))


def _people(numbers: Sequence[int]) -> tuple[list[Prototype], list[str], list[str]]:
    from cityx.assets.people import person
    from cityx.assets.people_looks import drawn_person, words_of

    looks = [drawn_person(number) for number in numbers]
    return [person(n) for n in numbers], [words_of(p) for p in looks], [p.age for p in looks]


def _pieces() -> list[str]:
    from cityx.assets.furniture import MAKERS

    return [name for name in MAKERS if name != "bus"]


def _furniture(numbers: Sequence[int]) -> tuple[list[Prototype], list[str], list[str]]:
    from cityx.assets.furniture import furniture

    names = [_pieces()[number] for number in numbers]
    return [furniture(n) for n in names], [n.replace("_", " ") for n in names], names


_THINGS = {"plants": _plants, "vehicles": _vehicles, "people": _people, "furniture": _furniture}


def capacity(group: str) -> float:
    """Return how many distinct assets of a group there can be."""
    if group == "vehicles":
        from cityx.assets.vehicles import PAINTS

        return len(PAINTS) * len(_VEHICLE_WORDS)
    return len(_pieces()) if group == "furniture" else float("inf")


def grow_things(group: str, numbers: Sequence[int]) -> tuple[Catalogue, Models]:
    """Make plants, vehicles, people or furniture by number."""
    from cityx.assets.library.measure import outline_of, stable_outline

    made, words, uses = _THINGS[group](numbers)
    models = models_of_prototypes(made)
    shells = models.shells
    points = np.split(shells.vertices, shells.vertex_start[1:-1])
    footprint = np.array([stable_outline(outline_of(p, None)) for p in points], object)
    box = rectangle_columns(footprint)
    height = models_height(models)
    sentences = [
        thing_sentence(text, (box["length"][i], box["width"][i], height[i]))
        for i, text in enumerate(words)
    ]
    records = make_catalogue(
        len(made), group=group, collection=[p.name for p in made], footprint=footprint,
        front=FRONT, height=height, storey_height=np.nan, use=uses, licence=LICENCE,
        description=sentences, source="procedural", generator=group, **box,
    )  # fmt: skip
    return records, models


# --- the whole ------------------------------------------------------------------------------------


def shares_of(count: int, groups: Sequence[str]) -> dict[str, int]:
    """Split a number of assets over groups; what small groups cannot hold goes to large ones.

    Raises
    ------
    UsageError
        If a group cannot be grown, or the groups do not hold so many.
    """
    for group in groups:
        if group not in GROWN_GROUPS:
            hint = nearest(group, GROWN_GROUPS)
            raise UsageError(
                f'Group "{group}" cannot be grown: there is no such group. '
                f"Known: {', '.join(GROWN_GROUPS)}.{hint}"
            )
    wanted = [group for group in GROWN_GROUPS if group in groups]
    total = sum(SHARES[group] for group in wanted)
    parts = {g: int(min(capacity(g), np.floor(count * SHARES[g] / total))) for g in wanted}
    rest = count - sum(parts.values())
    for group in wanted:
        more = int(min(rest, capacity(group) - parts[group]))
        parts[group] += more
        rest -= more
    if rest:
        most = count - rest
        raise UsageError(
            f"The groups {', '.join(wanted)} hold {most} distinct assets, not {count}; add "
            "buildings or plants."
        )
    return {group: number for group, number in parts.items() if number}


def _batches(group: str, first: int, size: int) -> Iterator[list[int]]:
    """Yield numbers from `first` on, batch by batch, without end where a group has none."""
    while True:
        end = (first // size + 1) * size
        numbers = [n for n in range(first, end) if n < capacity(group)]
        if not numbers:
            return
        yield numbers
        first = end


def _grow(
    group: str, numbers: list[int], seed: int, uses: Sequence[str]
) -> tuple[Catalogue, Models]:
    if group == "buildings":
        return grow_buildings(np.array(numbers), seed, uses=uses)
    return grow_things(group, numbers)


def grow_library(
    folder: Path,
    count: int,
    encoder: Encoder,
    *,
    seed: int = 0,
    groups: Sequence[str] = GROWN_GROUPS,
    uses: Sequence[str] = (),
    anew: bool = False,
    say: Say = lambda _: None,
) -> Library:
    """Add assets to a library, or make one.

    A library that was grown with the same seed goes on where it stopped.

    Parameters
    ----------
    folder
        The library.
    count
        Number of assets to add; all distinct, from each other and from those there already.
    encoder
        Encoder of the descriptions.
    seed
        Key of all draws.
    groups
        Groups to grow.
    uses
        Uses of buildings, () for all.
    anew
        Whether an older library there is replaced.
    say
        Called with a line of progress at a time.

    Raises
    ------
    UsageError
        If so many cannot be grown, or the encoder is not that of the library.
    """
    if count < 1:
        raise UsageError(f"{count} assets cannot be grown; ask for 1 or more.")
    for use in uses:
        if use not in PLOTS:
            raise UsageError(
                f'There is no use "{use}"; known: {", ".join(PLOTS)}.{nearest(use, PLOTS)}'
            )
    with LibraryWriter(folder, anew=anew) as writer:
        if writer.old is not None:
            from cityx.assets.library.encoding import check_same

            check_same(encoder.identity, writer.old.encoder)
        grown: dict[str, dict[str, int]] = dict(writer.old.head.get("grown", {})) if writer.old \
            else {}  # fmt: skip
        key = str(seed)
        begun = dict(grown.get(key, {}))
        done = 0
        for group, number in _left(count, groups, begun).items():
            added = 0
            for numbers in _batches(group, begun.get(group, 0), BATCH):
                used = numbers
                if group != "buildings":  # each is made alone, so none is made in vain
                    used = numbers[: number - added]
                added += writer.add(*_grow(group, used, seed, uses), limit=number - added)
                begun[group] = used[-1] + 1
                say(f"{done + added} of {count} assets, {group}")
                if added >= number:
                    break
            if added < number:
                raise UsageError(
                    f"Of {group} only {added} more distinct assets could be grown, not {number}."
                )
            done += added
        grown[key] = begun
        say("writing the index")
        return writer.commit(encoder, {"grown": grown})


def _left(count: int, groups: Sequence[str], begun: Mapping[str, int]) -> dict[str, int]:
    """Split a number over groups that have some assets already."""
    full = [g for g in groups if g in GROWN_GROUPS and begun.get(g, 0) >= capacity(g)]
    parts = shares_of(count, [group for group in groups if group not in full] or list(groups))
    over = 0
    for group in list(parts):
        room = capacity(group) - begun.get(group, 0)
        if parts[group] > room:
            over += parts[group] - int(room)
            parts[group] = int(room)
    for group in ("buildings", "plants"):
        if over and group in groups:
            parts[group] = parts.get(group, 0) + over
            over = 0
    if over:
        raise UsageError(f"The groups {', '.join(groups)} have no {count} assets left to grow.")
    return {group: number for group, number in parts.items() if number}
