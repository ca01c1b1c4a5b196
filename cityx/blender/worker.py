"""The Blender process: ``python -m cityx.blender.worker JOB.json``.

Reads a stored city, makes the scene, saves the .blend, renders the pictures. Progress goes to
standard output as lines that begin with ``@cityx``; the result goes to the file the job names.
"""

from __future__ import annotations

import json
import os
import resource
import shutil
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn, cast

from cityx.city.camera import Camera
from cityx.city.environment import Environment
from cityx.system.allocator import keep_freed_memory, rare_collection
from cityx.system.parents import end_at_once, end_with_parent

if TYPE_CHECKING:
    import bpy

    from cityx.city.store import View

PROGRESS = "@cityx "
SHORTEST_WAIT, LONGEST_WAIT = 0.01, 0.2  # seconds between two looks whether the job is there


def say(share: float, text: str) -> None:
    """Report progress to the caller."""
    sys.stdout.write(f"{PROGRESS}{json.dumps([round(share, 3), text])}\n")
    sys.stdout.flush()


def say_made(path: Path, facts: dict[str, Any]) -> None:
    """Report a complete picture to the caller."""
    report = {"made": str(path), "facts": facts}
    sys.stdout.write(f"{PROGRESS}{json.dumps(report)}\n")
    sys.stdout.flush()


class Clock:
    """Wall and CPU seconds of the steps; a class because it accumulates."""

    def __init__(self) -> None:
        self.steps: dict[str, dict[str, float]] = {}

    @contextmanager
    def step(self, name: str) -> Iterator[None]:
        """Time one step."""
        wall, cpu = time.perf_counter(), time.process_time()
        yield
        self.steps[name] = {
            "wall_s": round(time.perf_counter() - wall, 4),
            "cpu_s": round(time.process_time() - cpu, 4),
        }


def peak_rss_mb() -> float:
    """Peak resident memory of this process in MB."""
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return round(peak / (1e6 if sys.platform == "darwin" else 1e3), 1)


def resident_mb() -> float:
    """Memory this process holds now, in MB; its peak where the system does not say."""
    held = Path("/proc/self/statm")
    if not held.exists():
        return peak_rss_mb()
    return round(int(held.read_text().split()[1]) * resource.getpagesize() / 1e6, 1)


def perform(job: dict[str, Any], view: View, clock: Clock, tell: Callable[..., None]) -> Any:
    """Make the scene, save it, render it; returns the record of what was made."""
    import bpy

    from cityx.assets.vehicles.moving import with_movers
    from cityx.blender import render
    from cityx.blender import scene as scenes
    from cityx.blender.animation import animate
    from cityx.blender.light import Lighting, show_signals
    from cityx.blender.operators import call
    from cityx.blender.studio import Studio
    from cityx.city.rows import without_objects

    environment = _environment(job["environment"]) or view.environment
    pictures = [(Camera(**{**r["camera"], "position": tuple(r["camera"]["position"])}), r)
                for r in job["renders"]]  # fmt: skip
    tell(0.02, "building the scene")
    with clock.step("setup"):
        call("wm.read_homefile", use_empty=True, use_factory_startup=True, load_ui=False)
        if job["moment"] is not None:
            view = replace(view, moment=job["moment"])
        if job["hidden"]:
            view = replace(view, scene=without_objects(view.scene, map(int, job["hidden"])))
        # Keyframes are for who opens the file, or plays a span of it; a picture needs a moment.
        animated = bool(job["blend"] or job["frames"])
        staged = not animated and any(r["moment"] is not None for _, r in pictures)
        held = view if animated or staged else with_movers(view)
        library = scenes.library_of(held)
        scene = scenes.build_scene(held, objects=job["objects"], library=library)
        if animated:
            animate(scene, view, library)
        show_signals(view, view.moment)
        lighting = Lighting(scene, view)
        lighting.set(environment)
        cameras = [render.add_camera(scene, camera) for camera, _ in pictures]
        device = render.set_up(scene, samples=job["samples"], gpu=bool(pictures) and job["gpu"])
        if pictures:
            scene.camera = cameras[0]
            lighting.set_for(environment, pictures[0][0])
        scenes.mark_made()
    record: dict[str, Any] = {"device": device, "objects": len(bpy.data.objects), "files": []}
    if job["blend"]:
        tell(0.1, "saving the scene")
        with clock.step("save"):
            record["blend_mb"] = save(Path(job["blend"]))
        record["files"].append(job["blend"])
    studio = Studio(scene, view, lighting, library, staged=staged, animated=animated)
    shared = [False, *(_alike(one, other, environment)
                       for one, other in pairwise(job["renders"])), False]  # fmt: skip
    for index, ((camera, request), item) in enumerate(zip(pictures, cameras, strict=True)):
        share = 0.15 + 0.85 * index / len(pictures)
        tell(share, f"rendering {camera.name}")
        wanted = _environment(request["environment"]) or environment
        _wait([Path(before["path"]) for _, before in pictures[:index]], job["ahead"])
        begun = time.perf_counter()
        with clock.step(f"light {camera.name}"):
            studio.show(wanted, camera, request["moment"], truth=request["exact"])
        path = Path(request["path"])
        played = job["frames"] is not None and _alike(request, request, environment)
        render.keep_prepared(scene, before=shared[index], after=shared[index + 1] or played)
        render.use_quality(scene, request["samples"], request["threshold"], request["seed"])
        with ExitStack() as shown:
            if request["draft"] and device == "CPU":
                with clock.step(f"draft {camera.name}"):
                    draft = shown.enter_context(render.drafted(scene, item, path))
                tell(share, f"{camera.name}: a draft lies in {short_path(draft)}")
            shown.enter_context(clock.step(f"render {camera.name}"))
            if request["passes"]:
                facts = studio.passes(item, path, request["passes"], denoise=request["denoise"])
                record["files"] += [str(path.with_suffix(".exr")), str(path)]
            else:
                facts = {}
                record["files"] += _pictures(scene, item, path, job["frames"], tell)
        facts |= {"device": device, "seconds": round(time.perf_counter() - begun, 3),
                  "memory_mb": resident_mb(), "blender": bpy.app.version_string}  # fmt: skip
        say_made(path, facts)
    return record


def _alike(one: dict[str, Any], other: dict[str, Any], environment: Environment) -> bool:
    """Return whether two pictures for people show the city in one light without lamps."""
    wanted = [_environment(each["environment"]) or environment for each in (one, other)]
    same = one["moment"] == other["moment"] and wanted[0] == wanted[1]
    return same and wanted[0].lamps == 0 and not (one["passes"] or other["passes"])


def _wait(made: list[Path], ahead: int | None) -> None:
    """Wait until no more than so many pictures lie there, so that no disk is filled."""
    while ahead is not None and sum(path.exists() for path in made) > ahead:
        time.sleep(0.05)


def _pictures(
    scene: bpy.types.Scene,
    camera: bpy.types.Object,
    path: Path,
    frames: list[int] | None,
    tell: Callable[..., None],
) -> list[str]:
    """Render one picture, or one per frame with the frame's number in its name."""
    from cityx.blender import render

    if frames is None:
        render.render_picture(scene, camera, path)
        return [str(path)]
    first, last, step = frames
    made = []
    for frame in range(first, last + 1, step):
        tell(0.15 + 0.85 * (frame - first) / (last + 1 - first), f"rendering frame {frame}")
        scene.frame_set(frame)
        made.append(str(frame_path(path, frame)))
        render.render_picture(scene, camera, Path(made[-1]))
    return made


def frame_path(path: Path, frame: int) -> Path:
    """Return the name of the picture of a frame: ``street_0042.png``."""
    return path.with_name(f"{path.stem}_{frame:04d}{path.suffix}")


def short_path(path: Path) -> str:
    """Return a path as seen from the folder in which the user works, where that is shorter."""
    return min(str(path), os.path.relpath(path), key=len)


def _environment(record: dict[str, Any] | None) -> Environment | None:
    return None if record is None else Environment(**record)


def save(path: Path) -> float:
    """Save the open file under a temporary name, then rename it; returns its size in MB."""
    import bpy

    from cityx.blender.compression import compress, unfinished
    from cityx.blender.operators import call

    plain, temporary = unfinished(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    bpy.context.preferences.filepaths.save_version = 0
    try:
        call("wm.save_as_mainfile", filepath=str(plain), compress=False, check_existing=False,
             copy=True)  # fmt: skip
        compress(plain, temporary)
    finally:
        plain.unlink(missing_ok=True)
    temporary.replace(path)
    return round(path.stat().st_size / 1e6, 2)


def awaited(path: Path, parent: int) -> dict[str, Any]:
    """Return the job of a file, once it is there."""
    begun = time.monotonic()
    while not path.exists():
        if os.getppid() != parent:
            os._exit(3)
        # A hundredth of what has been waited is not missed; looking oftener takes seconds in all.
        time.sleep(min(max(SHORTEST_WAIT, 0.01 * (time.monotonic() - begun)), LONGEST_WAIT))
    return cast("dict[str, Any]", json.loads(path.read_text()))


def main(arguments: list[str]) -> int:
    """Run one job, whose file may be written while Blender is imported."""
    path, parent = Path(arguments[0]), os.getppid()
    end_with_parent(parent)
    keep_freed_memory()
    result: dict[str, Any] = {}
    clock = Clock()
    status = 0
    try:
        with clock.step("import"), rare_collection():
            import bpy
            import rasterio  # noqa: F401  the store reads terrain with it
            from PIL import ImageDraw, ImageFilter, TgaImagePlugin  # noqa: F401

            from cityx.assets import textures  # noqa: F401
            from cityx.blender import animation, compression, studio  # noqa: F401
            from cityx.city.store import read_view
        job = awaited(path, parent)
        end_with_parent(job["parent"])
        with rare_collection():
            with clock.step("read"):
                view = read_view(Path(job["store"]))
            result = perform(job, view, clock, say)
        result["blender"] = bpy.app.version_string
    except ImportError as error:
        result, status = {"missing": str(error)}, 3
    except Exception as error:  # noqa: BLE001  the caller turns it into an EngineError
        import traceback

        traceback.print_exc()
        result, status = {"error": f"{type(error).__name__}: {error}"}, 3
    result["timings"] = clock.steps
    result["peak_rss_mb"] = peak_rss_mb()
    target = Path(awaited(path, parent)["result"])
    temporary = target.with_suffix(".partial")
    temporary.write_text(json.dumps(result))
    temporary.replace(target)
    return status


def _end(status: int) -> NoReturn:
    """End the process without Blender's own end, which frees the scene thing by thing."""
    blender = sys.modules.get("bpy")
    # Where Blender cannot make a folder of its own, it tells the one that all programs share.
    if blender is not None and Path(blender.app.tempdir).name.startswith("blender_"):
        shutil.rmtree(blender.app.tempdir, ignore_errors=True)
    end_at_once(status)


if __name__ == "__main__":
    _end(main(sys.argv[1:]))
