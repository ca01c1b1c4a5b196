"""Fifty inputs of each kind: maps, semantic maps, height fields and words, with what they show.

Each of our own towns is written as a map and painted as classes, so that what a city made of
either should hold is known exactly. Real maps take the place of the first ones where a folder of
them is given. Everything is listed in a manifest with its hash and licence.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import shapely

from cityx.city import City, Layout
from cityx.errors import UsageError, nearest
from cityx.geometry.noise import gradient_noise
from cityx.geometry.raster.grid import Grid
from cityx.ids import draw, stable_id
from cityx.system.atomic import replaced
from cityx_bench.inputs import write_map
from cityx_bench.scenes import FRAME, Thing
from cityx_bench.tasks import Task

KINDS = ("osm", "semantic", "height", "text")
MANIFEST = "manifest.json"
COUNT = 50  # of each kind, as in the paper
PIXEL = 0.5  # metres of a semantic map
CELL = 10.0  # metres of a height field
AROUND = 300.0  # metres of heights beyond a town
WINDOW = 400.0  # metres of a real map that are built
OURS, REAL = "CC0-1.0, made by CityX", "ODbL 1.0, OpenStreetMap contributors"
_PATTERNS = ("grid", "organic", "radial", "cul_de_sac", "mixed")
_ZONES = ("", "midrise", "suburb", "row", "core")
# Class of the legend "cityx" -> kinds of area that are painted so, later ones over earlier ones.
_LAND: Mapping[str, tuple[str, ...]] = MappingProxyType({
    "grass": ("grass", "meadow", "garden", "golf", "pitch", "playground"),
    "park": ("park",), "wood": ("wood", "scrub", "orchard"), "farmland": ("farmland",),
    "sand": ("sand", "beach"), "plaza": ("plaza", "pedestrian"), "parking": ("parking",),
    "water": ("water", "sea", "river", "pool"),
})  # fmt: skip

# Kind of an area that an action made -> how a map says it.
_TAGS: Mapping[str, Mapping[str, str]] = MappingProxyType({
    "river": {"natural": "water", "water": "river"}, "grass": {"landuse": "grass"},
    "residential": {"landuse": "residential"}, "park": {"leisure": "park"},
})  # fmt: skip


@dataclass(frozen=True)
class Entry:
    """One file of the battery, as the manifest lists it."""

    file: str
    kind: str
    seed: int
    licence: str
    sha256: str
    bytes: int


@dataclass(frozen=True)
class Battery:
    """Tasks, and the files they name.

    Attributes
    ----------
    tasks
        `COUNT` of each kind; each has the kind as its group.
    inputs
        Name to path, of inputs and of what is known of them.
    """

    tasks: tuple[Task, ...]
    inputs: Mapping[str, Path]


def write_battery(
    folder: Path,
    *,
    kinds: Sequence[str] = KINDS,
    count: int = COUNT,
    maps: Path | None = None,
) -> Battery:
    """Write inputs and their manifest into a folder; files that are there already are kept.

    Parameters
    ----------
    folder
        Where files and the manifest go.
    kinds
        Of `KINDS`.
    count
        Of each kind.
    maps
        A folder of real maps that are taken first; ours fill up what is missing.

    Raises
    ------
    UsageError
        For a kind that does not exist.
    """
    unknown = [f'There is no kind of input "{kind}".{nearest(kind, KINDS)}'
               for kind in kinds if kind not in KINDS]  # fmt: skip
    if unknown:
        raise UsageError(" ".join(unknown))
    folder.mkdir(parents=True, exist_ok=True)
    inputs: dict[str, Path] = {}
    tasks: list[Task] = []
    real = _real_maps(maps)[:count] if "osm" in kinds else []
    for path in real:
        inputs[path.name] = path
        tasks.append(_map_task(f"osm_{path.name.split('.')[0]}", path.name, window=True))
    for number in range(count):
        made = _Town(number, folder)
        if "osm" in kinds and number >= len(real):
            tasks.append(_map_task(f"osm_{number:02d}", made.map.name))
            inputs[made.map.name] = made.drawn()
        if "semantic" in kinds:
            inputs |= {path.name: path for path in (made.drawn(), made.painted())}
            tasks.append(made.semantic_task())
        if "height" in kinds:
            path = _heights(number, folder)
            inputs[path.name] = path
            tasks.append(_height_task(number, path.name))
        if "text" in kinds:
            tasks.append(_text_task(number))
    tasks.sort(key=lambda task: (KINDS.index(task.group), task.id))
    _write_manifest(folder, inputs, tasks, {path.name for path in real})
    return Battery(tuple(tasks), MappingProxyType(inputs))


def _real_maps(folder: Path | None) -> list[Path]:
    if folder is None or not folder.is_dir():
        return []
    return sorted(p for p in folder.iterdir() if ".osm" in p.name)


def _map_task(name: str, file: str, *, window: bool = False) -> Task:
    text = "Build the city of this map."
    if window:
        text = f"Build {WINDOW:.0f} m by {WINDOW:.0f} m of this map."
    expect = (f"iou(building, {file}) >= 0.85", f"iou(road, {file}) >= 0.8")
    return Task(name, text, inputs=(file,), expect=expect, group="osm")


def _write_manifest(
    folder: Path, inputs: Mapping[str, Path], tasks: Sequence[Task], real: set[str]
) -> None:
    kinds = {".osm": "osm", ".png": "semantic", ".tif": "height"}
    entries = []
    for name, path in sorted(inputs.items()):
        content = path.read_bytes()
        known = name in real
        entries.append(
            Entry(
                name, "osm" if known else kinds[path.suffix],
                -1 if known else int(path.stem.rpartition("_")[2]), REAL if known else OURS,
                hashlib.sha256(content).hexdigest(), len(content),
            )
        )  # fmt: skip
    record = {
        "files": [asdict(entry) for entry in entries],
        "texts": {task.id: task.text for task in tasks if task.group == "text"},
    }
    with replaced(folder / MANIFEST) as temporary:
        temporary.write_text(json.dumps(record, indent=1), encoding="utf-8")


# --- towns ----------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Town:
    """One of our towns, and the files that show it."""

    number: int
    folder: Path

    @property
    def map(self) -> Path:
        """Where its map lies."""
        return self.folder / f"town_{self.number:02d}.osm"

    @property
    def image(self) -> Path:
        """Where its image of classes lies."""
        return self.folder / f"town_{self.number:02d}.png"

    def layout(self) -> Layout:
        """Return the town itself; pattern, use, size and waters go by its number."""
        from cityx.town.town import town
        from cityx.town.wishes.river import river

        share = _share(self.number, "size")
        size = round(220.0 + 80.0 * share, 1)
        city = town(
            City("town", FRAME, Layout((-1.0, -1.0, 1.0, 1.0)), seed=1000 + self.number),
            width=size, depth=size,
            pattern=_PATTERNS[self.number % len(_PATTERNS)],
            zone=_ZONES[self.number // len(_PATTERNS) % len(_ZONES)],
        )  # fmt: skip
        return river(city, width=14.0).layout if self.wet else city.layout

    @property
    def wet(self) -> bool:
        """Whether a river leads through it."""
        return self.number % 3 == 0

    def drawn(self) -> Path:
        """Return its map, written where it is missing."""
        if not self.map.exists():
            layout = self.layout()
            with replaced(self.map) as temporary:
                write_map(things_of(layout), layout.extent, temporary)
        return self.map

    def painted(self) -> Path:
        """Return its image of classes, with the place where it lies."""
        if not self.image.exists():
            paint(self.layout(), self.image)
        return self.image

    def semantic_task(self) -> Task:
        """Return the task to make a city of the image; its map says what is right."""
        known = self.map.name
        expect = [f"iou(building, {known}) >= 0.85", f"iou(road, {known}) >= 0.7"]
        expect += [f"iou(water, {known}) >= 0.8"] if self.wet else []
        text = "Build the city that this semantic map shows."
        return Task(f"semantic_{self.number:02d}", text, inputs=(self.image.name,),
                    expect=tuple(expect), group="semantic")  # fmt: skip


def _share(number: int, purpose: str) -> float:
    return draw(0, f"bench/battery/{purpose}", stable_id("battery", number))


def things_of(layout: Layout) -> list[Thing]:
    """Return all of a layout that a map holds, with its tags."""
    found = []
    for table in (layout.areas, layout.roads, layout.buildings, layout.lines, layout.points):
        kinds = table["kind"] if "kind" in table else table["use"]
        columns = (table["source"], table["tags"], kinds, table.geometry)
        for name, tags, kind, shape in zip(*columns, strict=True):
            said = json.loads(tags) or dict(_TAGS.get(kind, {}))
            if said:
                found.append(Thing(name, said, shape))
    return found


def paint(layout: Layout, path: Path) -> None:
    """Paint a layout in the colours of the legend "cityx" and say where the image lies.

    A world file and a projection stand beside it (.pgw, .prj), as GIS programs write them.
    """
    from PIL import Image
    from pyproj import CRS

    from cityx.sources.semantic_map.legends import find_legend

    xmin, ymin, xmax, ymax = layout.extent
    grid = Grid(round((ymax - ymin) / PIXEL), round((xmax - xmin) / PIXEL), PIXEL, xmin, ymax)
    colors = {entry.meaning.word: entry.key for entry in find_legend("cityx").entries}
    image = np.full((grid.rows, grid.columns), colors["ground"], np.int64)
    for name, shapes in _painted(layout):
        image[grid.numbered(shapes) > 0] = colors[name]
    with replaced(path) as temporary:
        rgb = np.stack([image >> 16, image >> 8 & 255, image & 255], axis=2).astype(np.uint8)
        Image.fromarray(rgb).save(temporary, "PNG")
    place = (PIXEL, 0.0, 0.0, -PIXEL, xmin + PIXEL / 2, ymax - PIXEL / 2)
    for suffix, text in ((".pgw", "\n".join(f"{value:.6f}" for value in place) + "\n"),
                         (".prj", CRS(FRAME.projection).to_wkt("WKT1_ESRI"))):  # fmt: skip
        with replaced(path.with_suffix(suffix)) as temporary:
            temporary.write_text(text, encoding="utf-8")


def _painted(layout: Layout) -> Iterator[tuple[str, Any]]:
    """Yield classes and shapes, (n,), later ones over earlier ones."""
    kinds = layout.areas["kind"]
    for name, words in _LAND.items():
        yield name, layout.areas.geometry[kinds.isin(words)].to_numpy()
    roads = layout.roads[~layout.roads["tunnel"] & ~layout.roads["passage"]]
    yield "road", shapely.buffer(roads.geometry.to_numpy(), roads["width"].to_numpy() / 2)
    yield "building", layout.buildings.geometry.to_numpy()


# --- heights --------------------------------------------------------------------------------------


def _heights(number: int, folder: Path) -> Path:
    """Return a height field: hills of three scales, some with terraces, some with voids."""
    import rasterio
    from rasterio.transform import Affine

    path = folder / f"hill_{number:02d}.tif"
    if path.exists():
        return path
    half = 150.0 + AROUND
    x, y = np.meshgrid(
        np.arange(-half, half, CELL) + CELL / 2, np.arange(half, -half, -CELL) - CELL / 2
    )
    reach = 140.0 + 260.0 * _share(number, "reach")
    points = np.column_stack([x.ravel(), y.ravel()]) / reach
    hills = gradient_noise(2000 + number, points, octaves=3).reshape(x.shape)
    # Below ten metres what is graded for streets and houses outweighs the relief itself.
    relief = 10.0 + 30.0 * _share(number, "relief") ** 2
    heights = 80.0 + 400.0 * _share(number, "level") + relief * hills
    if number % 5 == 0:
        step = relief / 6
        heights = np.round(heights / step) * step * 0.5 + heights * 0.5
    heights = heights.astype(np.float32)
    if number % 4 == 0:
        heights[np.hypot(x - 0.3 * half, y + 0.2 * half) < 2.5 * CELL] = np.nan
    place = Affine(CELL, 0.0, -half, 0.0, -CELL, half)
    with replaced(path) as temporary, rasterio.open(
        temporary, "w", driver="GTiff", width=heights.shape[1], height=len(heights), count=1,
        dtype="float32", crs=FRAME.projection, transform=place, nodata=np.nan,
    ) as file:  # fmt: skip
        file.write(heights, 1)
    return path


def _height_task(number: int, file: str) -> Task:
    text = "A town of 220 m on this terrain."
    expect = (f"corr(terrain, {file}) >= 0.99", "n(building) >= 10")
    return Task(f"height_{number:02d}", text, inputs=(file,), expect=expect, group="height")


# --- words ----------------------------------------------------------------------------------------
_FORMS = (
    "A {style} town of 220 m {weather}, {time}.",
    "Show me a small {style} district of 220 m by 220 m {time} {weather}.",
    "{Weather}, {time}: a {style} quarter, 220 m across.",
    "I need 220 m x 220 m of {style} city {weather} {time}, please.",
    "Make the architecture {style}; it is {time} {weather}; the site measures 220 m by 220 m.",
)
_STYLES = ("modern", "futuristic", "european", "haussmann", "japanese", "chinese", "american",
           "mediterranean", "victorian", "art_deco")  # fmt: skip
_WEATHERS = {
    "clear": "under a clear sky", "overcast": "under overcast skies", "rain": "in the rain",
    "snow": "in falling snow", "fog": "in dense fog", "storm": "in a thunderstorm",
}  # fmt: skip
_TIMES = {
    "morning": "in the morning", "noon": "at noon", "evening": "in the evening",
    "night": "at night",
}  # fmt: skip


def _text_task(number: int) -> Task:
    """Return words on style, weather and hour; what they ask for is known before they are read."""
    from cityx.language.brief import Slot
    from cityx.language.goals import goals_of

    style = _STYLES[number % len(_STYLES)]
    weather = tuple(_WEATHERS)[(number + number // len(_STYLES)) % len(_WEATHERS)]
    hour = tuple(_TIMES)[(number // 3) % len(_TIMES)]
    form = _FORMS[number // len(_STYLES) % len(_FORMS)]
    sky = _WEATHERS[weather]
    text = form.format(
        style=style.replace("_", " "),
        weather=sky,
        Weather=sky[0].upper() + sky[1:],
        time=_TIMES[hour],
    )
    pairs = (("style", style), ("weather", weather), ("time", hour), ("size.x", 220.0),
             ("size.y", 220.0))  # fmt: skip
    goals, _ = goals_of([Slot(key, value, (0, 0)) for key, value in pairs])
    return Task(f"text_{number:02d}", text, slots=pairs, group="text",
                expect=tuple(goal.predicate for goal in goals))  # fmt: skip
