"""Tools that make something of the city as it is: pictures, its report."""

from __future__ import annotations

from pathlib import Path

from cityx.projects.desk import STORE
from cityx.projects.results import VIEWS
from cityx.server.jobs import Job
from cityx.server.owner import Owner
from cityx.server.replies import Reply
from cityx.server.tool import Arguments, Tool, text, whole

PICTURE = (640, 360)  # pixels, unless told otherwise
WIDEST = 1280  # pixels of a picture that crosses the wire
SAMPLES = 16  # enough to judge a picture by
REPORT = "city://report"


class Products:
    """The tools that leave the city as it is and write beside it.

    Parameters
    ----------
    owner
        Who holds the city.
    """

    def __init__(self, owner: Owner) -> None:
        self.owner = owner

    def tools(self) -> list[Tool]:
        """Return the tools."""
        return [
            Tool(
                "render", "Make a picture of the city as it is.", self._render,
                {
                    "view": text("Camera.", 20, enum=list(VIEWS), default=VIEWS[0]),
                    "size": {
                        "type": "array", "minItems": 2, "maxItems": 2, "default": list(PICTURE),
                        "items": whole("Pixels.", 16, WIDEST),
                        "description": "Width and height, pixels.",
                    },
                    "samples": whole("Samples per pixel.", 1, 256, SAMPLES),
                },
                idempotent=True,
            ),
            Tool(
                "check", "Measure the city against every limit and renew its report.", self._check,
                idempotent=True,
            ),
        ]  # fmt: skip

    def _render(self, arguments: Arguments) -> Job:
        owner = self.owner
        view = arguments.get("view", VIEWS[0])
        width, height = arguments.get("size", PICTURE)

        def work(job: Job) -> Reply:
            from cityx.projects.views import blender_views

            owner.desk()
            path = picture_path(owner.folder, owner.seen.revision, view)
            blender_views(
                owner.folder / STORE, blend=None, renders=path.parent, views=(view,),
                size=(width, height), samples=arguments.get("samples", SAMPLES), say=job.say,
            )  # fmt: skip
            revision = owner.seen.revision
            return owner.ok(
                {"view": view, "size": [width, height]}, f"The {view} view of revision {revision}.",
                artifacts=(f"city://render/{revision}/{view}",), pictures=(path.read_bytes(),),
                job_id=job.id,
            )  # fmt: skip

        return owner.submit("render", work)

    def _check(self, arguments: Arguments) -> Job:
        del arguments
        owner = self.owner

        def work(job: Job) -> Reply:
            from cityx.checks.report import report_passed
            from cityx.projects.build import recheck

            owner.desk()
            report = recheck(owner.folder)
            failed = {name: row for name, row in report["checks"].items() if not row["ok"]}
            data = {
                "passed": report_passed(report), "counts": report["counts"], "failed": failed,
                "goals": report["goals"], "failures": len(report["failures"]),
            }  # fmt: skip
            message = f"{len(report['checks'])} checks, {len(failed)} not met."
            return owner.ok(data, message, artifacts=(REPORT,), job_id=job.id)

        return owner.submit("check", work)


def picture_path(folder: Path, revision: int, view: str) -> Path:
    """Return where the picture of a view of a revision lies."""
    return folder / "renders" / f"revision_{revision}" / f"{view}.png"
