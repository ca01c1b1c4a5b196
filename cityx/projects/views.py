"""Views made through Blender: the editable scene and the pictures."""

from __future__ import annotations

import re
import shutil
from collections.abc import Callable, Generator, Mapping, Sequence
from contextlib import closing
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.agents.verdict import View as Picture
from cityx.blender.client import (
    DEFAULT_SAMPLES,
    BlenderJob,
    BlenderResult,
    RenderRequest,
    follow,
    run_worker,
    work,
)
from cityx.city.camera import Camera, project
from cityx.city.content import stored_hash
from cityx.city.store import View, read_view
from cityx.city.tracks import FRAME_RATE
from cityx.errors import CityxError, EngineError, UsageError, nearest
from cityx.ids import id_text
from cityx.options import RenderOptions
from cityx.projects.file_formats import BUILT_IN, formats, formats_named
from cityx.projects.results import (
    PICTURES,
    VIEWS,
    enter_views,
    move_views,
    stale_views,
    views_made,
)
from cityx.system.blender_process import Made, Progress
from cityx.system.extensions import tried
from cityx.system.stopwatch import Stopwatch

if TYPE_CHECKING:
    from cityx.agents.briefs import Request
    from cityx.city import City
    from cityx.outputs.format import Format

PICTURE = (960, 540)  # pixels
LOOK, LOOK_SAMPLES = (512, 512), 16  # pixels and samples of a picture that a model looks at
DRAFTED = 5_000_000  # samples of a picture that takes more than twice as long as its draft
MOST_ASKED, MOST_NAMED = 2, 4  # pictures of what was asked for; things of a kind named in one
AWAITED = "blender start and end"  # its clock is what the build waited for at last
BUSIEST = "busiest"  # instead of a moment
# A picture of a square kilometre takes a minute or two on two cores; this is a hang.
TIMEOUT_S = 6 * 3600.0

Say = Callable[[str], None]


def cameras_of(view: View, names: Sequence[str], size: tuple[int, int]) -> list[Camera]:
    """Choose a camera for every named view of a city."""
    from cityx.views.cameras import choose_camera

    return [choose_camera(view, name, width=size[0], height=size[1]) for name in names]


class Drawing:
    """Blender at work: its process starts beside a build, and takes the city when that is stored.

    Parameters
    ----------
    store
        Folder of the city that will be stored.
    blend, renders, views, size, samples
        As of `blender_views`; nothing is started where neither a scene nor a picture is wanted.
    """

    def __init__(
        self, store: Path, *, blend: Path | None, renders: Path, views: Sequence[str] = (),
        size: tuple[int, int] = PICTURE, samples: int = DEFAULT_SAMPLES, say: Say,
    ) -> None:  # fmt: skip
        self._say = say
        self._talk: Generator[Progress | Made, None, BlenderResult] | None = None
        if blend is not None or views:
            job = partial(_drawing, store, blend, renders, views, size, samples, say)
            self._talk = work(job, timeout_s=TIMEOUT_S)
            self._said(next(self._talk))

    def begin(self) -> None:
        """Hand the stored city over."""
        if self._talk is not None:
            next(self._talk)

    def _said(self, word: Progress | Made) -> None:
        if isinstance(word, Progress):
            self._say(word.text)

    def finish(self, watch: Stopwatch) -> None:
        """Wait for the files.

        Raises
        ------
        EngineError, MissingDependency
            As of `cityx.blender.client.work`.
        """
        if self._talk is None:
            return
        with watch.step(AWAITED):
            times = follow(self._talk, lambda _, text: self._say(text)).timings
        watch.split(AWAITED, {f"blender {name}": spent for name, spent in times.items()})

    def close(self) -> None:
        """End the process where it has not ended."""
        if self._talk is not None:
            self._talk.close()


def make_views(
    city: City,
    folder: Path,
    formats: Sequence[str],
    *,
    store: Path | None = None,
    like: Mapping[str, tuple[City, Path]] | None = None,
    say: Say,
) -> None:
    """Write the files of formats of a city.

    Blender works in its own process while the other files are written.

    Parameters
    ----------
    city
        The city.
    folder
        Where to write them.
    formats
        Names of `cityx.projects.file_formats.formats`.
    store
        Folder of the stored city; ``city`` of the same folder when left out.
    like
        By format another city and the file that shows it.
    """
    watch = Stopwatch()
    folder.mkdir(parents=True, exist_ok=True)
    blend = folder / "city.blend" if "blend" in formats else None
    drawing = Drawing(store or folder / "city", blend=blend, renders=folder / PICTURES, say=say)
    with closing(drawing):
        drawing.begin()
        write_formats(city, folder, formats, like=like, watch=watch, say=say)
        drawing.finish(watch)


def write_formats(
    city: City,
    folder: Path,
    formats: Sequence[str],
    *,
    like: Mapping[str, tuple[City, Path]] | None = None,
    watch: Stopwatch,
    say: Say,
) -> None:
    """Write the files of formats that need no Blender, steps of a stopwatch.

    Parameters
    ----------
    city, folder, formats, like
        As of `make_views`.
    """
    for each in formats_named(formats):
        if each.write is None:
            continue
        say(f"writing {each.file}")
        with watch.step(each.name):
            _write(each, city, folder, (like or {}).get(each.name))


def renew_views(
    city: City, folder: Path, names: Sequence[str], content: str, *,
    before: tuple[City, str] | None = None, say: Say,
) -> None:  # fmt: skip
    """Write files of formats anew beside a stored city and put them in their places.

    Parameters
    ----------
    city, content
        The city that the folder holds, and its hash.
    names
        Of formats.
    before
        Another city and its hash: of files that show it what is the same is taken.
    """
    staging = folder / ".views.partial"
    like = {}
    if before is not None and before[1]:
        shown = {file for file, made in views_made(folder).items() if made == before[1]}
        like = {each.name: (before[0], folder / each.file) for each in formats_named(names)
                if each.file in shown}  # fmt: skip
    shutil.rmtree(staging, ignore_errors=True)  # of a killed process
    try:
        make_views(city, staging, names, store=folder / "city", like=like, say=say)
        move_views(staging, folder, content)
    finally:
        shutil.rmtree(staging, ignore_errors=True)


def renew_stale(city: City, folder: Path, content: str, *, say: Say) -> list[str]:
    """Renew the files of formats that show another city, as far as that is cheap.

    A .blend stays: it takes Blender, and may hold what an artist drew. Of a file of a format of
    another package of which nothing is known, it is not known either whether it was made by it.

    Returns
    -------
    notes
        What was renewed, and what could not be.
    """
    notes = []
    made = views_made(folder)
    stale = stale_views(folder, content)
    for each in formats().values():
        ours = each in BUILT_IN or each.file in made
        if each.file not in stale or each.write is None or not ours:
            continue
        try:
            renew_views(city, folder, [each.name], content, say=say)
            notes.append(f"{each.file} showed another city and was written again")
        except CityxError as error:
            notes.append(f"{each.file} shows another city and cannot be written again: {error}")
    return notes


def _write(
    form: Format, city: City, folder: Path, like: tuple[City, Path] | None = None
) -> None:  # fmt: skip
    """Write a format; what a package raises is told in one sentence.

    Where it can, it takes what is the same from `like`, another city and the file that shows it.

    Raises
    ------
    EngineError
        If a format of another package fails, or leaves no file.
    """
    assert form.write is not None
    target = folder / form.file
    if form in BUILT_IN:
        if like is not None and form.renew is not None:
            form.renew(city, target, *like)
        else:
            form.write(city, target)
    else:
        _, why = tried(partial(form.write, city, target), passing=(CityxError, OSError))
        if why:
            raise EngineError(f"Format {form.name} cannot be written: {why}")
    if not target.exists():
        raise EngineError(f"Format {form.name} has written no {form.file}.")


def blender_views(
    store: Path,
    *,
    blend: Path | None,
    renders: Path,
    views: Sequence[str] = VIEWS,
    size: tuple[int, int] = PICTURE,
    samples: int = DEFAULT_SAMPLES,
    say: Say,
) -> tuple[dict[str, dict[str, float]], float]:
    """Save the scene and render the standard pictures of a stored city.

    Parameters
    ----------
    store
        Folder of the stored city.
    blend
        .blend file to save, or None.
    renders
        Folder of the pictures.

    Returns
    -------
    timings, peak_rss_mb
        Step to its "wall_s" and "cpu_s"; peak memory of the Blender process.
    """
    job = _drawing(store, blend, renders, views, size, samples, say)
    result = run_worker(job, timeout_s=TIMEOUT_S, progress=lambda _, text: say(text))
    return {name: dict(times) for name, times in result.timings.items()}, result.peak_rss_mb


def _drawing(
    store: Path, blend: Path | None, renders: Path, views: Sequence[str], size: tuple[int, int],
    samples: int, say: Say,
) -> BlenderJob:  # fmt: skip
    """Return the job of `blender_views`."""
    requests: tuple[RenderRequest, ...] = ()
    if views:
        view = read_view(store)
        cameras = cameras_of(view, views, size)
        pictures = [
            RenderRequest(c, renders / f"{c.name}.png", samples, draft=_takes_long(c, samples))
            for c in cameras
        ]
        requests = _at_free_moments(view, pictures, say)
    return BlenderJob(store, blend=blend, renders=requests)


def looks_of(
    city: City, request: Request, folder: Path, say: Say, changed: NDArray[np.uint64]
) -> list[Picture]:
    """Take the pictures by which somebody judges a city: of the whole, and of what was asked for.

    Parameters
    ----------
    city
        The city; it is stored in the folder for the renderer.
    request
        What was asked for.
    folder
        Where to work; what lies there is replaced.
    changed
        Ids of what a change touched, of which alone pictures are taken; none for a new city.

    Returns
    -------
    pictures
        Each with words for what it shows, and with the ids of things and where they are in it.

    Raises
    ------
    EngineError, MissingDependency
        If Blender fails or cannot start.
    """
    from cityx.agents.eye import asked_things, touched_things
    from cityx.city.store import view_of, write_city
    from cityx.views.cameras import camera_on

    view = view_of(city)
    asked = list(asked_things(request, city))
    if len(changed):
        asked = [own for things in asked if len((own := things.among(changed)).ids)]
        known = np.concatenate([changed[:0], *(things.ids for things in asked)])
        asked += touched_things(city, np.setdiff1d(changed, known))
    cameras = cameras_of(view, ("aerial", "street"), LOOK)
    for place, things in enumerate(asked[:MOST_ASKED]):
        box = shapely.bounds(things.shapes[0])
        cameras.append(camera_on(view, f"asked_{place}", box, width=LOOK[0], height=LOOK[1]))
    words = ["the city from above", "a street"]
    words += [f"{things.text}, one of {things.number}" for things in asked]
    shutil.rmtree(folder, ignore_errors=True)
    write_city(city, folder / "city")
    requests = [  # nothing beyond the site, which would show a second church
        RenderRequest(one, folder / f"{one.name}.png", LOOK_SAMPLES, exact=True) for one in cameras
    ]
    run_worker(BlenderJob(folder / "city", renders=tuple(requests)), timeout_s=TIMEOUT_S,
               progress=lambda _, text: say(text))  # fmt: skip
    from cityx.checks.predicates.facts import Facts

    facts = Facts(city)
    whole = [(kind, facts.layer(kind)) for kind in ("building", "vehicle")]
    named = [(kind, layer.ids, layer.shapes) for kind, layer in whole]
    named = [(things.text, things.ids, things.shapes) for things in asked] + named
    return [
        Picture(one.camera.name, f"{text}{_seen_in(one.camera, view, named)}",
                one.path.read_bytes())
        for one, text in zip(requests, words, strict=False)
    ]  # fmt: skip


def _seen_in(camera: Camera, view: View, named: Sequence[tuple[str, Any, Any]]) -> str:
    """Return the nearest things in a picture in words: kind, id, and percent from left and top."""
    found: dict[str, str] = {}  # by id, so that what was asked for is called so
    for text, ids, shapes in named:
        if not len(ids):
            continue
        middles = shapely.get_coordinates(shapely.centroid(shapes))
        points = np.column_stack([middles, view.terrain.height_at(middles) + 1.0])
        pixels, depth = project(camera, points)
        place = np.round(100 * pixels / (camera.width, camera.height)).astype(int)
        inside = (depth > 1.0) & ((place >= 0) & (place <= 100)).all(axis=1)
        rows = np.flatnonzero(inside)
        for row in rows[np.argsort(depth[rows])][:MOST_NAMED].tolist():
            where = "{} % from the left, {} % from the top".format(*place[row])
            name = id_text(int(ids[row]))
            found.setdefault(name, f"{text} {name} at {where}")
    return f"; {', '.join(found.values())}" if found else ""


def render_views(folder: Path, options: RenderOptions, *, say: Say) -> list[Path]:
    """Render pictures of a built city into its folder ``renders``.

    Vehicles parked within two and a half metres before a lens are left out of all pictures of the
    call, which says so.

    Another time or weather changes the light alone: nothing is built again, the stored city stays
    as it is, and the pictures carry both words in their names.

    Parameters
    ----------
    folder
        Folder of a built city.
    options
        Camera, light, moment and quality.

    Raises
    ------
    UsageError
        If the camera is neither a view nor a file, a word for time or weather is not known, or
        nothing moves at the moment or in the frames asked for.
    """
    from cityx.light.weather import lit_anew

    view = read_view(folder / "city")
    camera, samples, size, moment = options.camera, options.samples, options.size, options.moment
    weather, time = options.weather or "", options.time or ""
    span = _span(view, moment, options.frames or "")
    environment = lit_anew(
        view.environment, view.frame.latitude, view.frame.longitude, weather=weather, time=time
    )
    if camera in VIEWS:
        cameras = cameras_of(view, [camera], size or PICTURE)
    elif Path(camera).is_file():
        from cityx.city.camera import read_cameras

        found, light = read_cameras(Path(camera), view.frame, view.terrain, extent=view.extent)
        cameras, environment = list(found), light.apply(environment)
        samples = samples or light.samples
        if size:
            cameras = [replace(item, width=size[0], height=size[1]) for item in cameras]
    else:
        raise UsageError(
            f'Camera "{camera}" is neither a file nor one of {", ".join(VIEWS)}.'
            + nearest(camera, VIEWS)
        )
    content = stored_hash(folder / "city")
    renders = folder / PICTURES
    suffix = "".join(
        f"_{re.sub('[^0-9a-z]+', '-', word.lower())}" for word in (weather, time) if word
    )
    requests = tuple(
        RenderRequest(
            item,
            renders / f"{item.name}{suffix}.png",
            samples or DEFAULT_SAMPLES,
            exact=options.exact,
            draft=span is None and _takes_long(item, samples or DEFAULT_SAMPLES),
        )
        for item in cameras
    )
    if moment in (None, BUSIEST) and span is None:
        requests = _at_free_moments(view, requests, say, busiest=moment == BUSIEST)
    shown = None if isinstance(moment, str) else moment
    job = BlenderJob(
        folder / "city", renders=requests, environment=environment, moment=shown, frames=span,
        hidden=_hidden(view, cameras, say),
    )  # fmt: skip
    stems = "|".join(re.escape(request.path.stem) for request in requests)
    replaced = re.compile(rf"{PICTURES}/({stems})(_\d{{4,}})?\.\w+")  # frames have numbers
    enter_views(folder, [name for name in views_made(folder) if replaced.fullmatch(name)], "")
    files = list(run_worker(job, timeout_s=TIMEOUT_S, progress=lambda _, text: say(text)).files)
    made = [path.resolve().relative_to(folder.resolve()).as_posix() for path in files]
    enter_views(folder, made, content)
    return files


def _takes_long(camera: Camera, samples: int) -> bool:
    """Return whether a picture is worth a draft."""
    return camera.width * camera.height * samples > DRAFTED


def _at_free_moments(
    view: View, requests: Sequence[RenderRequest], say: Say, *, busiest: bool = False
) -> tuple[RenderRequest, ...]:  # fmt: skip
    """Let each picture show a moment at which nothing that moves stands before its lens."""
    from cityx.views.free_view import free_moment

    found = []
    for request in requests:
        moment = free_moment(view, request.camera, busiest=busiest)
        if moment != view.moment:
            how = "busiest" if busiest else "free"
            say(f"{request.camera.name}: shown at {moment:g} s, when the view is {how}")
            request = replace(request, moment=moment)
        found.append(request)
    return tuple(found)


def _hidden(view: View, cameras: Sequence[Camera], say: Say) -> tuple[int, ...]:
    """Return the parked vehicles that would fill a picture, and say which are left out."""
    from cityx.views.free_view import in_the_way

    found: list[int] = []
    for camera in cameras:
        own = in_the_way(view, camera).tolist()
        if own:
            names = ", ".join(id_text(one) for one in own)
            say(f"{camera.name}: parked right before the lens and left out: {names}")
        found += own
    return tuple(sorted(set(found)))


def _span(view: View, moment: float | str | None, frames: str) -> tuple[int, int, int] | None:
    """Read a span of frames and refuse what lies outside the tracks.

    Raises
    ------
    UsageError
        With every fault.
    """
    if moment is None and not frames:
        return None
    duration = view.tracks.duration if view.tracks is not None else 0.0
    last = int(duration * FRAME_RATE)
    faults = []
    if not duration:
        faults.append("Nothing moves in this city: it has no moment and no frames to show.")
    if moment is not None and frames:
        faults.append("--moment shows one moment and --frames a span; give one of them.")
    if isinstance(moment, str) and moment != BUSIEST:
        faults.append(f'--moment "{moment}" is neither a number of seconds nor {BUSIEST}.')
    if not isinstance(moment, str | None) and duration and not 0 <= moment <= duration:
        faults.append(f"--moment {moment:g} is outside 0 to {duration:g} seconds of the tracks.")
    read = re.fullmatch(r"(\d+):(\d+)(?::([1-9]\d*))?", frames) if frames else None
    if frames and read is None:
        faults.append(f'--frames "{frames}" is no span of frames such as 0:100 or 0:100:5.')
    span = (int(read[1]), int(read[2]), int(read[3] or 1)) if read else None
    if span and not span[0] <= span[1]:
        faults.append(f"--frames {frames} ends before it begins.")
    if span and duration and span[1] > last:
        faults.append(f"--frames {frames} is outside 0 to {last}, the frames of the tracks.")
    if faults:
        raise UsageError(" ".join(faults))
    return span
