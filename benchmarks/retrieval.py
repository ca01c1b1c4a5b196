"""Measure growth, search, recall and placement of the asset library.

    python benchmarks/retrieval.py [LIBRARY] [--maps FOLDER] [--grow 1000]

Without a library one is grown in a temporary folder. Recall is that of captions made of each
asset's facts in other words than its description: "exact" counts the asset itself, of which a
large library holds many near twins; "alike" counts any asset of the same use, style, kind of
building and storeys.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from cityx.assets.library.encoding import DIMENSION, unit
from cityx.assets.library.fit import Lots, Placement, assets_of, place
from cityx.assets.library.grow import grow_library
from cityx.assets.library.index import open_index, write_index
from cityx.assets.library.local_text import LocalText
from cityx.assets.library.paper_placement import place_as_paper
from cityx.assets.library.plots import draw_plots
from cityx.assets.library.records import Catalogue
from cityx.assets.library.store import Library, open_library
from cityx.ids import uniform

LOTS = 20_000
VECTORS = 100_000
CAPTIONS = 500
SPACING = 22.0  # metres between the middles of made-up lots, so that many nearly touch
USES = {
    "house": "home", "flats": "residential block with apartments", "office": "workplace",
    "retail": "store", "industry": "factory", "worship": "religious building",
    "civic": "institution", "shed": "outbuilding",
}  # fmt: skip
WALLS = {"plaster": "stuccoed", "brick": "clinker", "stone": "sandstone", "concrete": "cement",
         "timber": "wooden", "metal": "steel clad", "glass": "glazed"}  # fmt: skip


def timed(function: Any, repeat: int = 5) -> tuple[float, Any]:
    """Return the least seconds of some runs, and the last result."""
    best, result = float("inf"), None
    for _ in range(repeat):
        begin = time.perf_counter()
        result = function()
        best = min(best, time.perf_counter() - begin)
    return best, result


def caption(table: Catalogue, row: int) -> str:
    """Describe a building in other words than its record does."""
    words = table["description"][row]
    wall = next((text for word, text in WALLS.items() if f"{word} " in words), "")
    kind = table["generator"][row]
    return (
        f"{wall} {USES.get(table['use'][row], table['use'][row])} {kind} with "
        f"{table['levels'][row]} floors, {table['style'][row]}, about "
        f"{table['length'][row]:.0f} metres long and {table['height'][row]:.0f} metres tall"
    )


def recall(library: Library) -> Iterator[str]:
    """Measure recall of held-out captions."""
    table = library.catalogue
    buildings = np.flatnonzero(table["group"] == "buildings")
    rows = buildings[np.linspace(0, len(buildings) - 1, min(CAPTIONS, len(buildings))).astype(int)]
    encoder = LocalText()
    asked = encoder.encode_text([caption(table, row) for row in rows.tolist()])
    found, _ = library.index.search(asked, 10, encoder=encoder.identity)
    kind = np.array(
        [f"{u}|{s}|{g}|{n}" for u, s, g, n in zip(
            table["use"], table["style"], table["generator"], table["levels"], strict=True)]
    )  # fmt: skip
    for name, hit in (
        ("exact", found == rows[:, None]),
        ("alike", kind[found] == kind[rows, None]),
    ):
        yield (
            f"recall, {name:<6} {len(rows)} captions in {len(table)} assets: "
            f"@1 {hit[:, 0].mean():.3f}  @10 {hit.any(axis=1).mean():.3f}"
        )


def search_speed() -> Iterator[str]:
    """Measure a search of many vectors: random ones, and ones in tight clusters."""
    rng = np.random.default_rng(1)
    for name, spread in (("random", 1.0), ("clustered", 0.35)):
        centre = rng.standard_normal((200, DIMENSION))
        noise = rng.standard_normal((VECTORS, DIMENSION)).astype(np.float32)
        held = noise if spread == 1.0 else centre[np.arange(VECTORS) % 200] + spread * noise
        vectors = unit(held)
        with tempfile.TemporaryDirectory() as folder:
            write_index(Path(folder) / "index", vectors, "benchmark")
            index = open_index(Path(folder) / "index")
            query = unit(held[7:8] + 0.3 * rng.standard_normal((1, DIMENSION)))
            spent, (rows, _) = timed(lambda: index.search(query, 10, encoder="benchmark"))  # noqa: B023
            half = np.asarray(index.vectors, np.float32)
            exact = np.argsort(-(half @ query[0]), kind="stable")[:10]
        same = len(set(rows[0].tolist()) & set(exact.tolist()))
        yield (f"search, {name:<9} {VECTORS} vectors: {1000 * spent:.1f} ms, {same} of the 10 best")


def made_lots(count: int, seed: int = 99) -> Lots:
    """Make lots like those the library is grown for, turned and moved at will."""
    plots = draw_plots(np.arange(count) + 10**7, seed)
    side = int(np.ceil(np.sqrt(count)))
    turn = 2 * np.pi * uniform(seed, "benchmark/turn", plots.id)
    cos, sin = np.cos(turn), np.sin(turn)
    x, y = plots.front / 2, plots.depth / 2
    # Wide lots get wide cells, so that lots do not overlap each other.
    room = np.maximum(np.hypot(plots.front, plots.depth), SPACING)
    left = np.cumsum(room) - room / 2
    row = np.floor(left / (side * room.mean()))
    middle = np.column_stack([left - row * side * room.mean(), row * 1.02 * room.max()])
    corners = np.stack(
        [
            np.column_stack([sx * x * cos - sy * y * sin, sx * x * sin + sy * y * cos]) + middle
            for sx, sy in ((-1, -1), (1, -1), (1, 1), (-1, 1))
        ],
        axis=1,
    )
    return Lots(
        plots.id, shapely.polygons(corners), turn - np.pi / 2, plots.use,
        plots.levels * plots.storey + plots.roof_height, plots.party,
    )  # fmt: skip


def overlaps(found: Placement) -> int:
    """Count pairs of placed outlines that share ground."""
    shapes = found.outline[found.asset >= 0]
    first, second = shapely.STRtree(shapes).query(shapes, predicate="intersects")
    pair = first < second
    shared = shapely.area(shapely.intersection(shapes[first[pair]], shapes[second[pair]]))
    return int(np.count_nonzero(shared > 1e-6))


def quality(lots: Lots, found: Placement) -> str:
    """Tell overlaps, scales, repetition and fit of a placement."""
    from scipy.spatial import cKDTree

    placed = found.asset >= 0
    if not placed.any():
        return "nothing placed"
    scale = found.scale[placed]
    middle = shapely.get_coordinates(shapely.centroid(lots.polygon))
    near = cKDTree(middle).query(middle, k=min(9, len(middle)))[1][:, 1:]
    twin = ((found.asset[near] == found.asset[:, None]) & placed[:, None]).any(axis=1)
    box = shapely.oriented_envelope(lots.polygon[placed])
    share = shapely.area(found.outline[placed]) / shapely.area(box)
    uses = np.sort(np.bincount(found.asset[placed]))[::-1]
    return (
        f"{placed.mean():.1%} placed, {overlaps(found)} overlaps, scale 0.85-1.18 "
        f"{np.mean((scale >= 0.85) & (scale <= 1.18)):.1%}, same among 8 nearest "
        f"{twin[placed].mean():.2%}, of the rectangle {np.median(share):.2f}, top ten assets "
        f"{uses[:10].sum() / placed.sum():.1%}"
    )


def placement(library: Library, maps: Path | None) -> Iterator[str]:
    """Measure placement on made-up lots and on the outlines of maps."""
    table = library.catalogue
    table = table.take(np.flatnonzero(table["group"] == "buildings"))
    assets = assets_of(table)
    lots = made_lots(LOTS)
    spent, found = timed(lambda: place(lots, assets), 3)
    yield f"placement, fit   {LOTS} made-up lots, {len(library.catalogue)} records: {spent:.2f} s"
    yield f"    {quality(lots, found)}"
    centre = np.column_stack([table["x"], table["y"]])
    spent, paper = timed(
        lambda: place_as_paper(
            lots.polygon, length=table["length"], width=table["width"], angle=table["angle"],
            centre=centre,
        ), 1,
    )  # fmt: skip
    alpha = paper.alpha[paper.asset >= 0]
    yield (
        f"placement, paper {LOTS} made-up lots: {spent:.2f} s, {np.mean(paper.asset >= 0):.1%} "
        f"placed, alpha {np.percentile(alpha, 5):.2f} to {np.percentile(alpha, 95):.2f}"
    )
    if maps is None:
        return
    from cityx.building.asset_placement import carriageways, lots_of
    from cityx.places.profiles import profile_of
    from cityx.sources.osm import read_osm

    for path in sorted(maps.glob("*.osm*")) if maps.is_dir() else [maps]:
        city = read_osm(path)
        ahead, real = timed(lambda: lots_of(city), 1)  # noqa: B023
        style = profile_of(city.frame).buildings.family
        roads = carriageways(city)
        spent, found = timed(lambda: place(real, assets, style=style, obstacles=roads), 1)  # noqa: B023
        yield f"{path.name}: {len(real)} outlines, lots {ahead:.2f} s, placement {spent:.2f} s"
        if len(real):
            yield f"    {quality(real, found)}"
            yield f"    {found.counts()}"


def main() -> None:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("library", nargs="?", type=Path)
    parser.add_argument("--maps", type=Path, help="a map, or a folder of maps")
    parser.add_argument("--grow", type=int, default=1000, help="assets grown to measure growth")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        begin = time.perf_counter()
        grown = grow_library(Path(folder) / "grown", args.grow, LocalText())
        spent = time.perf_counter() - begin
        size = sum(path.stat().st_size for path in grown.folder.rglob("*") if path.is_file())
        print(
            f"growth: {args.grow} assets in {spent:.1f} s, {1000 * spent / args.grow:.1f} ms and "
            f"{size / args.grow / 1000:.1f} kB each"
        )
        library = open_library(args.library) if args.library else grown
        for lines in (search_speed(), recall(library), placement(library, args.maps)):
            for line in lines:
                print(line)


if __name__ == "__main__":
    main()
