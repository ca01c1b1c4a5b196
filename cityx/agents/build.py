"""The main job: inputs and options become a folder with a city, its views and its report."""

from __future__ import annotations

import gc
import json
import os
import shutil
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

from cityx.agents.intake import HowToRead, Reading, read_sources, sort_inputs
from cityx.agents.journal import Journal, derivation_key
from cityx.agents.requests import Planned, with_requests
from cityx.agents.workflow import MAP_TO_CITY, calls_of
from cityx.cache import kept_folder
from cityx.city import City
from cityx.errors import ActionFailed, ActionRejected, InputError, UsageError
from cityx.outputs.usd import require_usd
from cityx.protocol.stages import Stage, stage_of

FORMATS = ("blend", "glb", "usd")
DEFAULT_FORMATS = ("blend", "glb")  # what needs no extra
TOWN = "layout/town-v1"  # what makes a layout where no input gives one
DEFAULT_WINDOW = (1000.0, 1000.0)  # metres, when --at comes without --size
PRODUCTS = (
    "city", "city.blend", "city.glb", "city.usdc", "city_textures", "renders",
    "report.json", "report.html",
)  # fmt: skip

Say = Callable[[str], None]


@dataclass(frozen=True)
class BuildOptions:
    """Everything that decides a build besides its inputs.

    Attributes
    ----------
    size
        (width, depth) of a window to cut out of the map, metres, or None for all of it. Without
        a map, the size of the town.
    at
        (latitude, longitude) of the window's centre, degrees; the site's centre when None. Where
        no input says where it lies, the place of their origin.
    window
        (x, y, width, depth), metres: the part of the plane of towns to build when no input gives a
        layout; x and y are its south-west corner.
    render
        Whether to make the three pictures.
    samples
        Cycles samples per pixel.
    picture
        (width, height) of the pictures, pixels.
    read
        What the user says of inputs that do not say it themselves; seed and place are those above.
    place
        Name or rectangle of a place whose map is fetched, or "".
    settings, wishes
        Arguments of actions and actions of the user's own; see `cityx.agents.requests`.
    """

    seed: int = 0
    workers: int = 1
    lod: int = 2
    style: str = ""
    time: str | None = None
    weather: str | None = None
    size: tuple[float, float] | None = None
    at: tuple[float, float] | None = None
    window: tuple[float, float, float, float] | None = None
    formats: tuple[str, ...] = DEFAULT_FORMATS
    render: bool = True
    samples: int = 48
    picture: tuple[int, int] = (960, 540)
    place: str = ""
    read: HowToRead = field(default_factory=HowToRead)
    settings: tuple[str, ...] = ()
    wishes: tuple[str, ...] = ()


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


def _registry() -> Any:
    from cityx.protocol import registry

    return registry()


@dataclass
class Run:
    """One run of actions on a city: gate, journal and clock around every step.

    A step that fails is rolled back: the city stays as it was and the journal says why.
    """

    journal: Journal
    number: int
    state: str
    watch: Stopwatch
    actions: Any = field(default_factory=_registry)

    def do(self, city: City, action: str, args: dict[str, Any]) -> City:
        """Run one action and return the new city."""
        from cityx.protocol.run import Call, run_action

        index = self.journal.start_step(self.number, action, args, self.state)
        begin = time.perf_counter()
        try:
            with self.watch.step(action.rsplit("-v", 1)[0]):
                outcome = run_action(city, Call(action, args), self.actions)
        except (ActionRejected, ActionFailed) as error:
            status = "rejected" if isinstance(error, ActionRejected) else "rolled_back"
            self.journal.end_step(self.number, index, status, state=self.state, error=str(error))
            if isinstance(error.__cause__, (InputError, UsageError)):
                raise error.__cause__ from error  # what a user asked for; its words say it best
            raise
        self.state = derivation_key(self.state, action, args)
        spent = round((time.perf_counter() - begin) * 1000)
        self.journal.end_step(self.number, index, "done", state=self.state, ms=spent)
        for port, path in outcome.conversions.items():
            for name in path.steps:
                step = self.journal.start_step(self.number, name, {"fills": port}, self.state)
                self.journal.end_step(self.number, step, "done", state=self.state)
        return outcome.city


def plan(options: BuildOptions, actions: Any, *, town: bool = False) -> list[Planned]:
    """Return every action of a build with its arguments.

    Parameters
    ----------
    town
        Whether no input gives a layout, so that one is made by rule.

    Raises
    ------
    UsageError
        With every fault of what the options ask for.
    """
    calls = calls_of(MAP_TO_CITY, options.lod, asdict(options))
    if town:
        calls = [(TOWN, _town_window(options)), *calls]
    elif options.window:
        raise UsageError("--window asks for a part of the plane of towns; a map has --at, --size.")
    return with_requests(calls, options.settings, options.wishes, actions)


def _town_window(options: BuildOptions) -> dict[str, float]:
    """Arguments of the town for the options ``window`` and ``size``."""
    if options.window:
        x, y, width, depth = options.window
        middle = {"x": x + width / 2, "y": y + depth / 2}
        return {**middle, "width": width, "depth": depth, "bounded": False}
    return dict(zip(("width", "depth"), options.size or (), strict=False))


def generate(
    reading: Reading, calls: list[Planned], options: BuildOptions, run: Run, say: Say = quiet
) -> City:
    """Cut the window out, finish the layout, lay the terrain and run the rest of the workflow.

    Raises
    ------
    InputError, UsageError
        If the window or the height file does not fit the map.
    ActionFailed
        If an action cannot do its work.
    """
    city = replace(reading.city, seed=options.seed, lod=options.lod, style=options.style)
    if reading.name and (options.size or (options.at and reading.located)):
        city = run.do(city, "layout/crop-v1", _window(city, options, located=reading.located))
        if not any(len(getattr(city.layout, name)) for name in ("buildings", "roads", "lines")):
            raise InputError("The window holds no building and no road; move --at, enlarge --size.")
    first = [call for call in calls if stage_of(call[0]) == Stage.LAYOUT]
    rest = [call for call in calls if stage_of(call[0]) != Stage.LAYOUT]
    for action, args in first:
        say(action)
        city = run.do(city, action, args)
    if reading.heights is not None:
        from cityx.sources.heights import lay_terrain
        from cityx.sources.measured_heights import heights_from_surface

        with run.watch.step("terrain"):
            if reading.heights.has_houses and len(city.layout.buildings):
                city = heights_from_surface(city, reading.heights)
            city = lay_terrain(city, reading.heights)
    city = replace(city, stages_done=city.stages_done | {"layout", "terrain"})
    for position, (action, args) in enumerate(rest, start=1):
        say(f"{position}/{len(rest)} {action}")
        city = run.do(city, action, args)
    return city


def _window(city: City, options: BuildOptions, *, located: bool) -> dict[str, float]:
    """Arguments of the crop for the options ``at`` and ``size``."""
    xmin, ymin, xmax, ymax = city.layout.extent
    x, y = (xmin + xmax) / 2, (ymin + ymax) / 2
    if options.at and located:
        x, y = city.frame.to_local([[options.at[1], options.at[0]]])[0].tolist()
        if not (xmin <= x <= xmax and ymin <= y <= ymax):
            west, south = city.frame.to_geographic([[xmin, ymin]])[0]
            east, north = city.frame.to_geographic([[xmax, ymax]])[0]
            raise UsageError(
                f"--at {options.at[0]},{options.at[1]} lies outside the map, which covers "
                f"latitude {south:.5f} to {north:.5f} and longitude {west:.5f} to {east:.5f}."
            )
    width, depth = options.size or DEFAULT_WINDOW
    return {"x": float(x), "y": float(y), "width": width, "depth": depth}


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
    MissingExtra
        A format needs an extra that is not installed; nothing was begun.
    """
    options = options or BuildOptions()
    unknown = set(options.formats) - set(FORMATS)
    if unknown:
        raise UsageError(f"Unknown formats {sorted(unknown)}; this version writes {FORMATS}.")
    if "usd" in options.formats:
        require_usd()
    out = _folder(out)
    watch = Stopwatch()
    with watch.step("import"):
        _import_libraries(options)
    with _rare_collection():
        return _build(paths, out, options, watch, say)


def _build(
    paths: list[Path], out: Path, options: BuildOptions, watch: Stopwatch, say: Say
) -> dict[str, Any]:
    from cityx.checks.report import make_report
    from cityx.city.store import write_city
    from cityx.sources.osm.retrieval import retrieve

    say("reading")
    if options.place:
        paths = [*paths, retrieve(options.place, kept_folder("maps"), say=say)]
    inputs = sort_inputs(paths, options.read.kinds)
    records = inputs.records
    # What is asked of a map's workflow is known to be sound before the map is read.
    calls = plan(options, _registry()) if inputs.sources else []
    with watch.step("parse"):
        reading = read_sources(inputs, replace(options.read, seed=options.seed, at=options.at))
    calls = calls or plan(options, _registry(), town=not reading.name)
    staging = _staging(out)
    try:
        journal_path = staging / "journal.sqlite"
        config = {**asdict(options), "formats": list(options.formats)}
        with Journal(journal_path) as journal:
            number = journal.start_run(records, config, options.seed)
            state = derivation_key("", "inputs", {"files": records, "seed": options.seed})
            run = Run(journal, number, state, watch)
            city = generate(reading, calls, options, run, say)
            say("writing the store")
            with watch.step("store"):
                write_city(city, staging / "city")
            memory = _make_views(city, staging, options, watch, say)
            say("checking")
            with watch.step("check"):
                report = make_report(
                    city,
                    inputs=records,
                    brief=_brief(options),
                    timings_s=watch.wall,
                    peak_rss_mb=memory,
                )
            report["cpu_s"] = {name: round(value, 3) for name, value in watch.cpu.items()}
            journal.end_run(number, "done", report["hash"])
        journal_path.rename(staging / "city" / "journal.sqlite")
        write_report(report, staging)
        _publish(staging, out)
    finally:
        shutil.rmtree(staging, ignore_errors=True)
    return report


LIBRARIES = (
    "geopandas",
    "pyarrow.parquet",
    "scipy.spatial",
    "scipy.sparse",
    "rasterio",
    "cityx.sources.osm",
    "cityx.sources.osm.reader",
    "cityx.checks.report",
    "cityx.city.store",
)


def _import_libraries(options: BuildOptions | None = None) -> None:
    """Import what the build needs, so that the steps' times are their own."""
    from importlib import import_module

    from cityx.plugins.building.catalogue import generators

    for name in LIBRARIES:
        import_module(name)
    generators()
    options = options or BuildOptions()
    actions = _registry()
    for action, _ in calls_of(MAP_TO_CITY, options.lod, {}):
        actions.function(action)


@contextmanager
def _rare_collection() -> Iterator[None]:
    """Look for reference cycles seldom: a city has millions of objects, but hardly a cycle."""
    before = gc.get_threshold()
    gc.freeze()  # the libraries just imported hold no garbage
    gc.set_threshold(200_000, 20, 50)
    try:
        yield
    finally:
        gc.set_threshold(*before)
        gc.unfreeze()


def _brief(options: BuildOptions) -> dict[str, Any]:
    names = ("style", "time", "weather", "lod", "seed", "size", "at", "window")
    given = {name: getattr(options, name) for name in names}
    given = {name: value for name, value in given.items() if value not in (None, "")}
    if "weather" in given:  # by its own name: "rainy" asks for rain
        from cityx.plugins.background.weather import weather_words

        given["weather"] = weather_words(given["weather"])[0]
    return given


def _make_views(
    city: City, staging: Path, options: BuildOptions, watch: Stopwatch, say: Say
) -> float:
    """Write GLB, USD, .blend and pictures; return the peak memory of any process, MB."""
    from cityx.agents.views import VIEWS, blender_views
    from cityx.checks.report import peak_memory_mb
    from cityx.city.store import view_of
    from cityx.outputs.glb import write_glb
    from cityx.outputs.usd import write_usd

    if "glb" in options.formats:
        say("writing city.glb")
        with watch.step("glb"):
            write_glb(view_of(city), staging / "city.glb")
    if "usd" in options.formats:
        say("writing city.usdc")
        with watch.step("usd"):
            write_usd(view_of(city), staging / "city.usdc")
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
    from cityx.atomic import replaced
    from cityx.checks.report_html import report_html

    order = {f"{view}.png": index for index, view in enumerate(VIEWS)}
    pictures = sorted(
        (folder / "renders").glob("*.png"), key=lambda path: (order.get(path.name, 99), path.name)
    )
    with replaced(folder / "report.json") as temporary:
        temporary.write_text(json.dumps(report, indent=2, allow_nan=False))
    relative = [path.relative_to(folder) for path in pictures]
    with replaced(folder / "report.html") as temporary:
        temporary.write_text(report_html(report, relative))


def _folder(out: Path) -> Path:
    """Return the folder of the results as an absolute path, without links.

    Raises
    ------
    UsageError
        If it is a file or no folder can have such a name.
    """
    try:
        out = out.resolve()
        taken = out.exists() and not out.is_dir()
        _aside(out).exists()  # names have a limit, and this one is longer
    except OSError as error:
        raise UsageError(f"{out} cannot be a folder: {error.strerror}.") from error
    if taken:
        raise UsageError(f"{out} is a file; give a folder for the results.")
    return out


def _staging(out: Path) -> Path:
    """Make the hidden folder beside `out`; what a killed build left there is cleared first."""
    aside = _aside(out)
    if aside.exists() and not out.exists():  # killed between the two renames of `_publish`
        aside.rename(out)
    shutil.rmtree(aside, ignore_errors=True)
    staging = out.parent / f".{out.name}.partial"
    shutil.rmtree(staging, ignore_errors=True)
    try:
        staging.mkdir(parents=True)
    except OSError as error:
        raise UsageError(f"{out} cannot be made: {error.strerror}.") from error
    return staging


def _aside(out: Path) -> Path:
    return out.parent / f".{out.name}.old.partial"


def _publish(staging: Path, out: Path) -> None:
    """Put the finished folder in the place of `out`; a kill leaves the older city or the new one.

    A folder that holds other things too, or that this process stands in, stays; then products are
    replaced one by one, and those of the older city do not stay beside them.
    """
    from cityx.city.store import replace_folder

    held = {entry.name for entry in out.iterdir()} if out.exists() else set()
    if held <= set(PRODUCTS) and Path.cwd() != out:
        if out.exists():
            out.rename(_aside(out))
        staging.rename(out)
        shutil.rmtree(_aside(out), ignore_errors=True)
        return
    for name in held.intersection(PRODUCTS):
        if not (staging / name).exists():
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
