"""Growth: assets materialised from our own generators, as many as asked for.

Buildings are grown in batches: a made-up city of plots that lie too far apart to know of each
other, run through the building actions. So an asset depends on its number and the seed alone.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.assets.library.encoding import Encoder
from cityx.assets.library.measure import building_sentence, color_words
from cityx.assets.library.models import Models, models_height, models_of_scene
from cityx.assets.library.plots import BATCH, PLOTS, RECIPES, Plots, draw_plots, plots_to_city
from cityx.assets.library.records import Catalogue, make_catalogue, rectangle_columns
from cityx.assets.library.store import Library, LibraryWriter
from cityx.assets.library.things import FRONT, LICENCE, capacity, grow_things
from cityx.city.city import City
from cityx.errors import UsageError, nearest
from cityx.geometry.arrays import FloatArray
from cityx.ids import choose, stable_id

GROWN_GROUPS = ("buildings", "plants", "vehicles", "people", "furniture")
SHARES = {"buildings": 0.92, "plants": 0.03, "vehicles": 0.025, "people": 0.01,
          "furniture": 0.015}  # fmt: skip
STANDING = 0.5  # metres; parts that begin lower stand on the ground

Say = Callable[[str], None]


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
    from cityx.assets.styles.palettes import STYLES
    from cityx.protocol import registry
    from cityx.protocol.running import Call, run_action

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
    from cityx.assets.styles.materials import MATERIALS
    from cityx.geometry.solids import area_vectors

    shells = models.shells
    vector = area_vectors(shells.vertices, shells.faces)
    area = np.linalg.norm(vector, axis=1)
    of = shells.face_object()
    base = np.array([MATERIALS[name].color for name in shells.materials] or [(1.0, 1.0, 1.0)])
    seen = base[shells.material] * shells.tint
    kinds = len(shells.materials)
    found = []
    for chosen in (np.abs(vector[:, 2]) < 0.3 * area, vector[:, 2] > 0.3 * area):
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
