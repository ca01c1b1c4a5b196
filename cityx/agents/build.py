"""The main job: inputs and options become a folder with a city, its views and its report."""

from __future__ import annotations

import json
import os
import shutil
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

from cityx.agents.journal import Journal, derivation_key
from cityx.agents.workflow import MAP_TO_CITY, calls_of
from cityx.city import City
from cityx.errors import ActionFailed, ActionRejected, InputError, UsageError
from cityx.sources.inputs import KINDS, Input, classify

FORMATS = ("blend", "glb")
PRODUCTS = ("city", "city.blend", "city.glb", "renders", "report.json", "report.html")

Say = Callable[[str], None]


@dataclass(frozen=True)
class BuildOptions:
    """Everything that decides a build besides its inputs.

    Attributes
    ----------
    size
        (width, depth) of a window to cut out of the map, metres, or None for all of it.
    at
        (latitude, longitude) of the window's centre, degrees; the site's centre when None.
    render
        Whether to make the three pictures.
    samples
        Cycles samples per pixel.
    picture
        (width, height) of the pictures, pixels.
    """

    seed: int = 0
    workers: int = 1
    lod: int = 2
    style: str = ""
    time: str | None = None
    weather: str | None = None
    size: tuple[float, float] | None = None
    at: tuple[float, float] | None = None
    formats: tuple[str, ...] = FORMATS
    render: bool = True
    samples: int = 48
    picture: tuple[int, int] = (960, 540)


@dataclass
class Stopwatch:
    """Seconds and CPU seconds per named step, in order."""

    wall: dict[str, float] = field(default_factory=dict)
    cpu: dict[str, float] = field(default_factory=dict)

    @contextmanager
    def step(self, name: str) -> Iterator[None]:
        """Measure the block; children that ended within it count."""
        wall, cpu = time.perf_counter(), _cpu_seconds()
        try:
            yield
        finally:
            self.wall[name] = self.wall.get(name, 0.0) + time.perf_counter() - wall
            self.cpu[name] = self.cpu.get(name, 0.0) + _cpu_seconds() - cpu


def _cpu_seconds() -> float:
    used = os.times()
    return used.user + used.system + used.children_user + used.children_system


def quiet(_: str) -> None:
    """Say nothing."""


def read_inputs(
    paths: list[Path], options: BuildOptions, watch: Stopwatch
) -> tuple[City, list[Input]]:
    """Read every input into one city with layout and terrain.

    Raises
    ------
    InputError, UsageError
        If a file cannot be used or the files do not make a city together.
    """
    from cityx.sources.osm import read_osm

    inputs = [classify(path) for path in paths]
    maps = [item for item in inputs if item.kind == "osm"]
    heights = [item for item in inputs if item.kind == "height"]
    if len(maps) != 1 or len(heights) > 1:
        raise UsageError(
            f"Give one map and at most one height file ({KINDS}); "
            f"given: {len(maps)} maps, {len(heights)} height files."
        )
    with watch.step("parse"):
        name = maps[0].path.name.split(".")[0].replace("_", " ")
        city = read_osm(maps[0].path, seed=options.seed, name=name)
        city = replace(city, seed=options.seed, lod=options.lod, style=options.style)
    if options.size or options.at:
        with watch.step("crop"):
            city = _cropped(city, options)
    if heights:
        from cityx.sources.height_field import read_height

        with watch.step("terrain"):
            terrain = read_height(heights[0].path, city.frame, city.layout.extent)
            stages = city.stages_done | {"terrain"}
            city = replace(city, terrain=terrain, stages_done=stages)
    return replace(city, stages_done=city.stages_done | {"layout", "terrain"}), inputs


def _cropped(city: City, options: BuildOptions) -> City:
    from cityx.protocol import registry
    from cityx.protocol.run import Call, run_step

    xmin, ymin, xmax, ymax = city.layout.extent
    x, y = (xmin + xmax) / 2, (ymin + ymax) / 2
    if options.at:
        x, y = city.frame.to_local([[options.at[1], options.at[0]]])[0].tolist()
        if not (xmin <= x <= xmax and ymin <= y <= ymax):
            west, south = city.frame.to_geographic([[xmin, ymin]])[0]
            east, north = city.frame.to_geographic([[xmax, ymax]])[0]
            raise UsageError(
                f"--at {options.at[0]},{options.at[1]} lies outside the map, which covers "
                f"latitude {south:.5f} to {north:.5f} and longitude {west:.5f} to {east:.5f}."
            )
    width, depth = options.size or (1000.0, 1000.0)
    window = {"x": float(x), "y": float(y), "width": width, "depth": depth}
    cropped = run_step(city, Call("layout/crop-v1", window), registry())
    if not len(cropped.layout.buildings) and not len(cropped.layout.roads):
        raise InputError("The window holds no building and no road; move --at or enlarge --size.")
    return cropped


def run_workflow(
    city: City, options: BuildOptions, journal: Journal, run: int, watch: Stopwatch, say: Say
) -> City:
    """Run the default workflow through the gate, step by step, into the journal.

    A step that fails is rolled back: the city stays as it was, the report names the step.
    """
    from cityx.protocol import registry
    from cityx.protocol.run import Call, run_step

    actions = registry()
    state = derivation_key("", "inputs", {"seed": options.seed, "lod": options.lod})
    calls = calls_of(MAP_TO_CITY, options.lod, asdict(options))
    for position, (action, args) in enumerate(calls, start=1):
        say(f"{position}/{len(calls)} {action}")
        index = journal.start_step(run, action, args, state)
        begin = time.perf_counter()
        try:
            with watch.step(action.rsplit("-v", 1)[0]):
                city = run_step(city, Call(action, args), actions)
        except ActionRejected as error:
            journal.end_step(run, index, "rejected", state=state, error=str(error))
            raise
        except ActionFailed as error:
            journal.end_step(run, index, "rolled_back", state=state, error=str(error))
            raise
        state = derivation_key(state, action, args)
        spent = round((time.perf_counter() - begin) * 1000)
        journal.end_step(run, index, "done", state=state, ms=spent)
    return city


def build(
    paths: list[Path], out: Path, options: BuildOptions | None = None, *, say: Say = quiet
) -> dict[str, Any]:
    """Build a city from files into a folder and return its report.

    Everything is made in a hidden folder beside `out` and moved there when complete, so a build
    that fails or is killed leaves `out` as it was.

    Parameters
    ----------
    paths
        Input files.
    out
        Folder of the results; made when absent.
    say
        Called with one line of progress at a time.

    Raises
    ------
    InputError, UsageError
        Nothing was written.
    EngineError, MissingDependency
        Blender failed or cannot start; nothing was written.
    """
    from cityx.checks.report import make_report
    from cityx.city.store import write_city

    options = options or BuildOptions()
    unknown = set(options.formats) - set(FORMATS)
    if unknown:
        raise UsageError(f"Unknown formats {sorted(unknown)}; this version writes {FORMATS}.")
    watch = Stopwatch()
    with watch.step("import"):
        _import_libraries()
    say("reading")
    city, inputs = read_inputs(paths, options, watch)
    out = out.absolute()
    staging = out.parent / f".{out.name}.partial"
    shutil.rmtree(staging, ignore_errors=True)
    staging.mkdir(parents=True)
    try:
        journal_path = staging / "journal.sqlite"
        config = {**asdict(options), "formats": list(options.formats)}
        with Journal(journal_path) as journal:
            run = journal.start_run([item.record() for item in inputs], config, options.seed)
            city = run_workflow(city, options, journal, run, watch, say)
            say("writing the store")
            with watch.step("store"):
                write_city(city, staging / "city")
            memory = _make_views(city, staging, options, watch, say)
            say("checking")
            with watch.step("check"):
                report = make_report(
                    city,
                    inputs=[item.record() for item in inputs],
                    brief=_brief(options),
                    timings_s=watch.wall,
                    peak_rss_mb=memory,
                )
            report["cpu_s"] = {name: round(value, 3) for name, value in watch.cpu.items()}
            journal.end_run(run, "done", report["hash"])
        journal_path.rename(staging / "city" / "journal.sqlite")
        write_report(report, staging)
        _publish(staging, out)
    finally:
        shutil.rmtree(staging, ignore_errors=True)
    return report


def _import_libraries() -> None:
    """Import what every build needs, so that the steps' times are their own."""
    from importlib import import_module

    for name in ("geopandas", "scipy.spatial", "scipy.sparse", "rasterio"):
        import_module(name)


def _brief(options: BuildOptions) -> dict[str, Any]:
    names = ("style", "time", "weather", "lod", "seed", "size", "at")
    given = {name: getattr(options, name) for name in names}
    return {name: value for name, value in given.items() if value not in (None, "")}


def _make_views(
    city: City, staging: Path, options: BuildOptions, watch: Stopwatch, say: Say
) -> float:
    """Write GLB, .blend and pictures; return the peak memory of any process, MB."""
    from cityx.agents.views import VIEWS, blender_views
    from cityx.checks.report import peak_memory_mb
    from cityx.city.store import view_of
    from cityx.outputs.glb import write_glb

    if "glb" in options.formats:
        say("writing city.glb")
        with watch.step("glb"):
            write_glb(view_of(city), staging / "city.glb")
    if "blend" in options.formats or options.render:
        blend = staging / "city.blend" if "blend" in options.formats else None
        views = VIEWS if options.render else ()
        times, _ = blender_views(
            staging / "city",
            blend=blend,
            renders=staging / "renders",
            views=views,
            size=options.picture,
            samples=options.samples,
            say=say,
        )
        for name, spent in times.items():
            watch.wall[f"blender {name}"] = spent["wall_s"]
            watch.cpu[f"blender {name}"] = spent["cpu_s"]
    return peak_memory_mb()


def write_report(report: dict[str, Any], folder: Path) -> None:
    """Write report.json and report.html, with the pictures that lie in ``renders``."""
    from cityx.agents.views import VIEWS
    from cityx.checks.report_html import report_html
    from cityx.outputs.atomic import replaced

    order = {f"{view}.png": index for index, view in enumerate(VIEWS)}
    pictures = sorted(
        (folder / "renders").glob("*.png"), key=lambda path: (order.get(path.name, 99), path.name)
    )
    with replaced(folder / "report.json") as temporary:
        temporary.write_text(json.dumps(report, indent=2, allow_nan=False))
    relative = [path.relative_to(folder) for path in pictures]
    with replaced(folder / "report.html") as temporary:
        temporary.write_text(report_html(report, relative))


def _publish(staging: Path, out: Path) -> None:
    """Move every finished product into place; products of an older city do not stay beside it."""
    from cityx.city.store import replace_folder

    out.mkdir(parents=True, exist_ok=True)
    for name in PRODUCTS:
        if not (staging / name).exists() and (out / name).exists():
            old = out / name
            shutil.rmtree(old) if old.is_dir() else old.unlink()
    for product in sorted(staging.iterdir()):
        target = out / product.name
        if product.is_dir():
            replace_folder(product, target)
        else:
            product.replace(target)


def recheck(folder: Path) -> dict[str, Any]:
    """Measure a built city again and write its report anew; what the build measured is kept.

    Raises
    ------
    InputError
        If the folder holds no city.
    """
    from cityx.checks.report import make_report
    from cityx.city.store import read_city

    city = read_city(folder / "city")
    path = folder / "report.json"
    old = json.loads(path.read_text()) if path.exists() else {}
    report = make_report(
        city,
        inputs=old.get("inputs", ()),
        brief=old.get("brief"),
        timings_s=old.get("timings_s"),
        peak_rss_mb=old.get("peak_rss_mb"),
    )
    report["cpu_s"] = old.get("cpu_s", {})
    write_report(report, folder)
    return report
