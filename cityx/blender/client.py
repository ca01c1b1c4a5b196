"""Jobs for Blender: a stored city goes out, files and a record come back.

Blender runs in a process of its own: a crash or a hang of the engine cannot take the city along,
its memory is given back, and nothing but that process ever imports ``bpy``.
"""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Callable, Generator, Mapping
from contextlib import closing
from dataclasses import asdict, dataclass
from math import inf
from pathlib import Path
from typing import Any

from cityx.blender.compression import draft_of, unfinished
from cityx.city.camera import Camera
from cityx.city.environment import Environment
from cityx.errors import EngineError, MissingDependency
from cityx.system.blender_process import Made, Progress, converse, explain_missing

DEFAULT_SAMPLES = 48


@dataclass(frozen=True)
class RenderRequest:
    """One picture to render.

    Attributes
    ----------
    camera
        Where from, and how many pixels.
    path
        PNG file to write.
    samples
        Samples per pixel, at most; fewer where the picture is clean earlier.
    environment
        Light and weather of this picture instead of the job's, or None.
    moment
        Seconds into the tracks that this picture shows instead of the job's, or None.
    passes
        Names of `cityx.blender.passes` that are written, as an .exr file beside the .png.
    threshold
        Noise at which a pixel gets no more samples; None is that of pictures for people.
    denoise
        Whether the picture is what the denoiser made of the samples.
    seed
        Of the samples, so that pictures do not share their noise.
    exact
        Whether it shows what the files hold alone: no outskirts, no twigs. Passes imply it.
    draft
        Whether a draft of it is shown first where no GPU renders: ``NAME_draft.png``, which goes
        when the picture is complete.
    """

    camera: Camera
    path: Path
    samples: int = DEFAULT_SAMPLES
    environment: Environment | None = None
    moment: float | None = None
    passes: tuple[str, ...] = ()
    threshold: float | None = None
    denoise: bool = True
    seed: int = 0
    exact: bool = False
    draft: bool = False


@dataclass(frozen=True)
class BlenderJob:
    """What a Blender process is to do with a stored city.

    Attributes
    ----------
    store
        Folder of the stored city.
    blend
        .blend file to save, or None.
    renders
        Pictures to render, one after the other.
    environment
        Light and weather instead of the city's own, or None.
    objects
        Whether every building is an object; None decides by their number.
    gpu
        Whether a GPU is used when there is one.
    moment
        Seconds into the tracks that are shown instead of the city's own, or None.
    frames
        First and last frame of a span that is rendered and the step from one to the next,
        `FRAME_RATE` a second; None renders the moment.
    hidden
        Ids of instances that no picture shows.
    ahead
        Complete pictures that may lie there, not yet taken away, while the next is rendered; None
        does not wait for anybody.
    """

    store: Path
    blend: Path | None = None
    renders: tuple[RenderRequest, ...] = ()
    environment: Environment | None = None
    objects: bool | None = None
    gpu: bool = True
    moment: float | None = None
    frames: tuple[int, int, int] | None = None
    hidden: tuple[int, ...] = ()
    ahead: int | None = None


@dataclass(frozen=True)
class BlenderResult:
    """What a Blender process did.

    Attributes
    ----------
    files
        Files written, in order.
    timings
        Step ("import", "read", "setup", "save", "light NAME", "draft NAME", "render NAME") to
        "wall_s" and "cpu_s".
    peak_rss_mb
        Peak resident memory of the process.
    device
        "CPU" or the kind of GPU that rendered.
    objects
        Objects in the scene.
    version
        Of Blender.
    """

    files: tuple[Path, ...]
    timings: Mapping[str, Mapping[str, float]]
    peak_rss_mb: float
    device: str
    objects: int
    version: str
    blend_mb: float = 0.0


def run_worker(
    job: BlenderJob,
    *,
    timeout_s: float = 3600.0,
    progress: Callable[[float, str], None] | None = None,
) -> BlenderResult:
    """Run a job in a Blender process and wait for it.

    Parameters
    ----------
    job
        What to do.
    timeout_s
        Seconds after which the process is killed.
    progress
        Called with the share done, 0 to 1, and a few words.

    Raises
    ------
    MissingDependency
        If Blender's module or a shared library it needs is absent; names the packages.
    EngineError
        If the process failed, crashed or took too long.
    """
    return follow(work(job, timeout_s=timeout_s), progress)


def follow(
    talk: Generator[Progress | Made, None, BlenderResult],
    progress: Callable[[float, str], None] | None = None,
) -> BlenderResult:
    """Pass on what is left of the words of `work` and return its result."""
    while True:
        try:
            word = next(talk)
        except StopIteration as end:
            result: BlenderResult = end.value
            return result
        if progress is not None and isinstance(word, Progress):
            progress(*word)


def work(
    job: BlenderJob | Callable[[], BlenderJob], *, timeout_s: float = inf, silence_s: float = inf
) -> Generator[Progress | Made, None, BlenderResult]:
    """Run a job in a Blender process and pass on what it says while it says it.

    The first word is said once the process runs, so that its listener can do other work beside
    it; where the job is yet to be made, the second once the process has it. The process ends with
    the generator, whether that is exhausted, closed or thrown away.

    Parameters
    ----------
    job
        What to do, or what makes that while the process starts.
    timeout_s
        Seconds after which the process is killed.
    silence_s
        Seconds without a word after which it is killed.

    Raises
    ------
    MissingDependency, EngineError
        As `run_worker`.
    """
    with tempfile.TemporaryDirectory(prefix="cityx-blender-") as folder:
        request, answer = Path(folder) / "job.json", Path(folder) / "result.json"
        if isinstance(job, BlenderJob):
            _hand_over(job, request, answer)
        with closing(converse(request, timeout_s=timeout_s, silence_s=silence_s)) as talk:
            yield next(talk)
            if not isinstance(job, BlenderJob):
                job = job()
                _hand_over(job, request, answer)
                yield Progress(0.0, "the city is handed over")
            try:
                code, log = yield from talk
            finally:
                _clean(job)
        result = json.loads(answer.read_text()) if answer.exists() else {}
    if "missing" in result:
        raise MissingDependency(explain_missing(result["missing"]))
    if "error" in result:
        raise EngineError(f"Blender could not finish the job: {result['error']}")
    if code or not result:
        fate = f"was ended by signal {-code}" if code < 0 else f"ended with status {code}"
        raise EngineError(f"the Blender process {fate}. Its last words:\n{log.text()}")
    return BlenderResult(
        tuple(map(Path, result["files"])),
        result["timings"],
        result["peak_rss_mb"],
        result["device"],
        result["objects"],
        result["blender"],
        result.get("blend_mb", 0.0),
    )


def _hand_over(job: BlenderJob, request: Path, answer: Path) -> None:
    """Write the file of a job, whole at once: the process may wait for it."""
    partial = request.with_suffix(".partial")
    partial.write_text(json.dumps(_record(job, answer)))
    partial.replace(request)


def _clean(job: BlenderJob) -> None:
    """Remove what an ended process left half written."""
    pictures = [request.path for request in job.renders]
    passes = [request.path.with_suffix(".exr") for request in job.renders if request.passes]
    for path in (*filter(None, [job.blend]), *pictures, *passes):
        for left in (*unfinished(path), draft_of(path)):
            left.unlink(missing_ok=True)


def _record(job: BlenderJob, answer: Path) -> dict[str, Any]:
    renders = [
        {
            "camera": asdict(r.camera),
            "path": str(r.path.resolve()),
            "samples": int(r.samples),
            "environment": _values(r.environment),
            "moment": r.moment,
            "passes": r.passes,
            "threshold": r.threshold,
            "denoise": r.denoise,
            "seed": r.seed,
            "exact": r.exact or bool(r.passes),
            "draft": r.draft,
        }
        for r in job.renders
    ]
    return {
        "store": str(job.store.resolve()),
        "blend": None if job.blend is None else str(job.blend.resolve()),
        "renders": renders,
        "samples": max((r.samples for r in job.renders), default=DEFAULT_SAMPLES),
        "environment": _values(job.environment),
        "objects": job.objects,
        "gpu": job.gpu,
        "moment": job.moment,
        "frames": job.frames,
        "hidden": [str(one) for one in job.hidden],
        "ahead": job.ahead,
        "result": str(answer),
        "parent": os.getpid(),
    }


def _values(environment: Environment | None) -> dict[str, Any] | None:
    return None if environment is None else asdict(environment)
