"""The main job: inputs and options become a folder with a city, its views and its report."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack, closing, contextmanager
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from cityx.agents.ablation import shown_records
from cityx.agents.briefs import Request, read_request
from cityx.agents.journal import JOURNAL, Journal, derivation_key
from cityx.agents.loop import Loop, Say, quiet
from cityx.agents.models import Limits, Recording, roles_for
from cityx.agents.planning.planner import Situation
from cityx.agents.planning.workflow import Item
from cityx.agents.pool import Message, Pool
from cityx.agents.requests import with_requests
from cityx.agents.roles import Roles
from cityx.agents.step_runner import FAULT, SNAPSHOTS, Run, unwatched
from cityx.city import City, Frame, Layout
from cityx.city.frame import NOWHERE
from cityx.errors import DiskError, InputError, UsageError
from cityx.options import BuildOptions, PlannerChoice
from cityx.places.profiles import place_text
from cityx.projects.file_formats import formats_named
from cityx.projects.looking import Looking, changing
from cityx.projects.place_words import check_place
from cityx.projects.results import (
    FAULTS,
    PICTURES,
    VIEWS,
    enter_views,
    publish,
    result_folder,
    staging_of,
    staging_path,
    stale_notes,
    stale_views,
    write_report,
)
from cityx.projects.storing import checked_files
from cityx.projects.views import Drawing, renew_stale
from cityx.protocol.encapsulation import Encapsulation
from cityx.protocol.input_files import InputFiles
from cityx.protocol.registry import Registry, registry
from cityx.sources.intake import Inputs, sort_inputs
from cityx.system.allocator import rare_collection, return_freed_memory
from cityx.system.atomic import disk_fault
from cityx.system.cache import kept_folder
from cityx.system.cores import core_count
from cityx.system.extensions import refusals
from cityx.system.remembered import forget_all
from cityx.system.stopwatch import Stopwatch

LOOKS = "looks"  # folder of the pictures that a model looks at, while it does


@dataclass(frozen=True)
class Job:
    """What is to be built, known before anything runs.

    Attributes
    ----------
    options
        As the user gave them.
    inputs
        The user's files by what they are.
    request
        What the user wants, by text and by options.
    actions, roles
        The registry, and who plans with it.
    """

    options: BuildOptions
    inputs: Inputs
    request: Request
    actions: Registry
    roles: Roles

    @property
    def files(self) -> InputFiles:
        """The input files, and those that say how to read them."""
        read = self.options.read
        items = [(item.path, item.kind) for item in self.inputs.all]
        items += [
            (Path(text), kind)
            for text, kind in ((read.legend, "legend"), (read.segmenter, "segmenter"))
            if text and Path(text).is_file()
        ]
        return InputFiles(tuple(path for path, _ in items), tuple(kind for _, kind in items))

    @property
    def place(self) -> str:
        """The profile of the place that the user asked for, as a frame keeps it."""
        asked = self.options.place_profile
        return place_text(asked) if asked else ""

    @property
    def workers(self) -> int:
        """How many processes may work at a time."""
        return self.options.workers or core_count()

    @property
    def start(self) -> City:
        """The city before the first action: place, options and nothing else."""
        options = self.options
        frame = replace(Frame(*options.at) if options.at else NOWHERE, place=self.place)
        return City(
            "town", frame, Layout((0.0, 0.0, 0.0, 0.0)), seed=options.seed, lod=options.lod,
            style=self.request.style,
        )  # fmt: skip

    def amended(self, items: Iterable[Item], done: Iterable[Item] = ()) -> list[Item]:
        """Put what the user asks of single actions into a workflow.

        Raises
        ------
        UsageError
            With every fault of what is asked.
        """
        options = self.options
        return with_requests(
            list(items), options.settings, options.wishes, self.actions, done=list(done)
        )

    def first_plan(self) -> list[Item]:
        """Return the plan as it is before any file has been read.

        Raises
        ------
        UsageError
            With every fault of what is asked, or of what no action can bring about.
        """
        if self.options.window and self.inputs.sources:
            raise UsageError(
                "--window asks for a part of the plane of towns; a map has --at, --size."
            )
        if self.options.size and not self.inputs.sources:
            _check_size(self.options.size)
        situation = Situation(self.options.lod, self.files.kinds)
        plan = self.roles.checker.workflow(self.request.slots, situation)
        if plan.missing:
            raise UsageError(f"This cannot be built: {'; '.join(plan.missing)}.")
        return self.amended(plan.items)


def make_job(
    paths: list[Path], options: BuildOptions, say: Say = quiet, *, left: Path | None = None
) -> Job:
    """Inspect the inputs of a build and prepare it; `Job.roles` is to be closed.

    Parameters
    ----------
    left
        Journal of a killed build of the same, if there is one.

    Raises
    ------
    InputError, UsageError, MissingExtra
        If a file or an option is of no use.
    """
    from cityx.protocol.catalogue import known_records
    from cityx.sources.osm.retrieval import retrieve

    formats_named(options.formats)
    if options.place:
        paths = [*paths, retrieve(options.place, kept_folder("maps"), say=say)]
    if options.place_profile:
        check_place(options.place_profile)
    inputs = sort_inputs(paths, options.read.kinds)
    actions = registry()
    files = [(item.path, item.kind) for item in inputs.all]
    roles = roles_of(
        options.choice, shown_records(known_records(actions), options.choice.shown), left
    )
    try:
        request = read_request(options, files, maker=roles.brief_maker)
    except BaseException:
        roles.close()
        raise
    return Job(options, inputs, request, actions, roles)


def _check_size(size: tuple[float, float]) -> None:
    """Refuse a size that no town has."""
    from cityx.town.town import LARGEST, SMALLEST

    if not SMALLEST <= min(size) <= max(size) <= LARGEST:
        raise UsageError(
            f"--size {size[0]:g}x{size[1]:g} is no size of a town; each side takes "
            f"{SMALLEST:g} to {LARGEST:,.0f} m."
        )


def roles_of(
    choice: PlannerChoice, records: Iterable[Encapsulation], left: Path | None = None
) -> Roles:
    """Return who plays the roles of a run.

    Parameters
    ----------
    choice
        Who is wanted.
    records
        Of the actions that may be planned.
    left
        Journal of a killed run of the same, whose decisions hold.

    Raises
    ------
    InputError, UsageError, MissingExtra
        As of `cityx.agents.models.roles_for`.
    """
    recording = Recording(
        Path(choice.record) if choice.record else None,
        Path(choice.replay) if choice.replay else None,
        left,
        Path(choice.export) if choice.export else None,
    )
    limits = Limits(tokens=choice.budget_tokens)
    return roles_for(choice.planner, choice.base_url, recording, records, limits=limits)


def build(
    paths: list[Path],
    out: Path,
    options: BuildOptions | None = None,
    *,
    say: Say = quiet,
    watch: Stopwatch | None = None,
) -> dict[str, Any]:
    """Build a city from files into a folder and return its report.

    Everything is made in a hidden folder beside `out` and moved there when complete, so a build
    that fails or is killed leaves `out` as it was. One that was killed goes on where it stopped
    when the same is asked for again.

    Parameters
    ----------
    paths
        Input files.
    out
        Folder of the results; made when absent.
    say
        Called with one line of progress at a time.
    watch
        Steps so far, to which those of the build are added for the report.

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
    formats_named(options.formats)
    out = result_folder(out)
    watch = watch or Stopwatch()
    with watch.step("request"):
        job = make_job(paths, options, say, left=staging_path(out) / JOURNAL)
    try:
        with watch.step("request"):
            plan = job.first_plan()
        with watch.step("import"):
            import_libraries(job.actions, plan)
        with rare_collection():
            return _build(job, out, watch, say)
    finally:
        job.roles.close()


def _build(job: Job, out: Path, watch: Stopwatch, say: Say) -> dict[str, Any]:
    from cityx.checks.report import peak_memory_mb

    staging = staging_of(out)
    options = job.options
    keep = True
    try:
        with ExitStack() as stack:
            journal, number = stack.enter_context(_journal(job, staging))
            keep = False
            blend = staging / "city.blend" if "blend" in options.formats else None
            drawing = stack.enter_context(closing(Drawing(
                staging / "city", blend=blend, renders=staging / PICTURES,
                views=VIEWS if options.render else (), size=options.picture,
                samples=options.samples, say=say,
            )))  # fmt: skip
            looking = Looking(job.roles, job.request, staging / LOOKS, say, options.render)
            watched = looking.mended if options.choice.look else unwatched
            then: list[dict[str, Any]] = []

            def completed(run: Run, city: City) -> City:
                return watched(run, _finished(job, run, city, then, say))

            def generated() -> City:
                city = generate(job, journal, number, watch, staging / SNAPSHOTS, say, completed)
                return replace(city, notes=(*city.notes, *looking.notes))

            report, begun = checked_files(
                generated, job.inputs, options, _brief(job), staging, drawing, watch, say
            )
            if not begun:
                forget_all()
                return_freed_memory()
                drawing.begin()
            drawing.finish(watch)
            drawing.close()
            memory = peak_memory_mb()
            report["peak_rss_mb"] = round(memory, 1)
            report |= watch.told()
            report["goals"] += then
            report["notes"] += [text for text in refusals() if text not in report["notes"]]
            report |= looking.told(report)
            if faults := _faults(staging / FAULTS):
                report["faults"] = faults
            journal.end_run(number, "done", report["hash"])
        journal.path.rename(staging / "city" / journal.path.name)
        shutil.rmtree(staging / SNAPSHOTS, ignore_errors=True)
        enter_views(staging, _views_in(staging), report["hash"])
        write_report(report, staging)
        publish(staging, out)
    except Exception as error:
        refused = disk_fault(error, out)
        keep = keep and refused is None
        if refused is None:
            raise
        raise DiskError(f"{refused}. What stood there is as it was.") from error
    finally:
        if not keep:
            shutil.rmtree(staging, ignore_errors=True)
    return report


def _finished(job: Job, run: Run, city: City, told: list[dict[str, Any]], say: Say) -> City:
    """Carry out what is asked of the finished city; what came of it is added to rows of goals."""
    if not job.request.brief.then:
        return city
    from cityx.agents.finishing import Finishing

    say("finishing")
    change = changing(run, job.roles, job.request.slots)
    finishing = Finishing(change, job.roles.checker, job.request)
    held, run.hold = run.hold, True  # a killed run begins to finish again
    with run.watch.step("finish"):
        city = finishing.finished(city)
    run.hold = held
    told += finishing.goals
    return city


def _views_in(staging: Path) -> list[str]:
    """Return the views that a build has made."""
    other = {"city", PICTURES, FAULTS, LOOKS}
    names = [entry.name for entry in staging.iterdir() if not entry.name.startswith(".")]
    return [name for name in names if name not in other] + [
        f"{PICTURES}/{path.name}" for path in (staging / PICTURES).glob("*.png")
    ]


def _faults(log: Path) -> list[str]:
    """Return what broke in this program itself during a build, by the log of it."""
    lines = log.read_text().splitlines() if log.exists() else []
    return [line.removeprefix(FAULT) for line in lines if line.startswith(FAULT)]


@contextmanager
def _journal(job: Job, staging: Path) -> Iterator[tuple[Journal, int]]:
    """Open the journal of a build and its run, that of a killed build of the same where there is.

    Raises
    ------
    UsageError
        If another process is building there.
    """
    from cityx.protocol.catalogue import registry_hash

    config = {**asdict(job.options), "formats": list(job.options.formats)}
    asked = (job.inputs.records, config, job.options.seed)
    code = registry_hash(job.actions)
    path = staging / JOURNAL
    number = None
    if path.exists():
        try:
            with Journal(path) as left:
                for record in left.runs():
                    if record.status == "started":
                        left.take(record.number)
                number = left.unfinished(*asked, registry=code)
        except InputError:
            number = None
    if number is None:
        for entry in staging.iterdir():
            shutil.rmtree(entry) if entry.is_dir() else entry.unlink()
    with Journal(path) as journal:
        yield journal, number or journal.start_run(*asked, registry=code)


def generate(
    job: Job,
    journal: Journal,
    number: int,
    watch: Stopwatch,
    keep: Path | None,
    say: Say = quiet,
    watched: Callable[[Run, City], City] = unwatched,
) -> City:
    """Plan and run every action of a build.

    Parameters
    ----------
    job
        What is to be built.
    journal, number
        Where the run is recorded.
    keep
        Folder for snapshots of long work, or None for none.
    watched
        Looks at the finished city and has it mended.

    Raises
    ------
    InputError, UsageError
        If the inputs or what is asked for make no city.
    ActionFailed
        If an action cannot do its work and nothing else can do it.
    """
    pool = Pool(journal.database, number)
    slots = job.request.slots
    asked = {key: list(values) for key, values in slots.items()}
    pool.say(Message("user", "brief", {**job.request.brief.to_json(), "asked": asked}))
    code = journal.run(number).registry
    roles = job.roles
    roles.attach(pool)
    labels = roles.annotator.label(journal.database, code, roles.checker.records.values())
    pool.say(Message("annotator", "labels", {"registry": code, "actions": len(labels)}))
    origin = {"files": job.inputs.records, "seed": job.options.seed, "place": job.place}
    run = Run(
        journal, number, derivation_key("", "inputs", origin), job.actions, watch, job.files, keep,
        faults=None if keep is None else keep.parent / FAULTS, workers=job.workers,
    )  # fmt: skip
    loop = Loop(
        roles.planner, run, pool, slots, job.files.kinds, job.amended, say,
        goals=job.request.goals, executor=roles.executor, told=job.request.told,
    )  # fmt: skip
    with closing(run):
        city = watched(run, loop.carry_out(job.start))
    notes = (*(f"{item.action} was left out: {why}" for item, why in loop.unmet), *roles.notes)
    return job.request.with_goals(replace(city, notes=(*city.notes, *notes)))


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


def import_libraries(actions: Registry, items: Iterable[Item]) -> None:
    """Import what the build needs, so that the steps' times are their own."""
    from importlib import import_module

    from cityx.building.catalogue import generators

    for name in LIBRARIES:
        import_module(name)
    planned = [item.action for item in items]
    if any(actions.entry(name).id.startswith("building/design-") for name in planned):
        generators()
    for name in planned:
        actions.function(name)


def _brief(job: Job) -> dict[str, Any]:
    """Return what the report says was asked for: the words, and the options."""
    names = ("style", "time", "weather", "lod", "seed", "size", "at", "window", "place_profile")
    given = {name: getattr(job.options, name) for name in names}
    given = {name: value for name, value in given.items() if value not in (None, "")}
    if "weather" in given:  # by its own name: "rainy" asks for rain
        from cityx.light.weather import weather_words

        given["weather"] = weather_words(given["weather"])[0]
    if job.request.brief.text:
        given |= {**job.request.brief.to_json(), "reply": job.request.reply}
    return given


def _with_known(
    goals: list[dict[str, Any]], known: Iterable[dict[str, Any]]
) -> list[dict[str, Any]]:
    """Keep of the same city what was measured while the inputs or the city before were at hand."""
    known = list(known)
    then = [goal for goal in known if goal.get("then")]
    told = {goal.get("predicate"): goal for goal in known
            if goal["met"] is not None and not goal.get("then")}  # fmt: skip
    return [
        told.get(goal.get("predicate"), goal) if goal["met"] is None else goal for goal in goals
    ] + then


# What a report tells of the last change, which a new measurement keeps.
OF_CHANGE = ("revision", "change", "reply_of_change", "left_of_change", "notes_of_change",
             "listed_of_change", "done_of_change", "chosen_of_change", "same_of_change",
             "goals_of_change")  # fmt: skip


def since_edits(
    goals: list[dict[str, Any]], known: Iterable[dict[str, Any]]
) -> list[dict[str, Any]]:
    """Count no miss of the build in what it was asked for and edits have changed since.

    It held before the city was edited, and the evidence says that it does not any more.
    """
    was = {goal.get("predicate") for goal in known if goal["met"] or goal.get("held")}
    return [
        {**goal, "met": None, "held": True, "evidence": f"{goal['evidence']}; it held before "
         "the city was edited"}
        if goal["met"] is False and goal.get("predicate") in was else goal for goal in goals
    ]  # fmt: skip


def held_of_change(city: City, old: dict[str, Any]) -> list[dict[str, Any]]:
    """Measure again what the last change asked for, as far as the city before is not needed."""
    from cityx.checks.predicates import measure_all
    from cityx.projects.outcome import COMPARING

    asked = [goal for goal in old.get("goals_of_change", ())
             if goal["met"] is not None and not COMPARING.search(goal["predicate"])]  # fmt: skip
    found = measure_all([goal["predicate"] for goal in asked], city)
    return [
        {**goal, "met": finding.met, "evidence": finding.evidence}
        for goal, finding in zip(asked, found, strict=True)
    ]


def recheck(folder: Path) -> dict[str, Any]:
    """Measure a built city again and rewrite its report; what the build measured is kept.

    Files of formats that show another city, because a change was killed before it renewed them, are
    written again. ``stale_views`` of the report tells what is left: a .blend, which the next change
    renews, and pictures, which a change leaves as they are.

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
        peak_rss_mb=old.get("peak_rss_mb"),
    )
    report |= {name: old.get(name, {}) for name in ("timings_s", "cpu_s")}
    if "faults" in old:
        report["faults"] = old["faults"]
    if old.get("checks_of", old.get("hash")) == report["hash"]:
        report["goals"] = _with_known(report["goals"], old.get("goals", ()))
    if old.get("revision", 1) > 1:
        report["goals"] = since_edits(report["goals"], old.get("goals", ()))
        report["goals"] += held_of_change(city, old)
        report |= {key: old[key] for key in OF_CHANGE if key in old}
    notes = renew_stale(city, folder, report["hash"], say=quiet)
    report["stale_views"] = stale_views(folder, report["hash"])
    report["notes"] += [*notes, *stale_notes(report["stale_views"])]
    write_report(report, folder)
    return report
