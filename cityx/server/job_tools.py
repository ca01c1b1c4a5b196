"""Tools for jobs: work that takes longer than a call may."""

from __future__ import annotations

from cityx.errors import UsageError
from cityx.server.jobs import Job
from cityx.server.layers import shown
from cityx.server.owner import Owner
from cityx.server.replies import Reply
from cityx.server.tool import JOB, PATIENCE_S, Arguments, Tool

LONGEST_WAIT_S = 20.0  # many clients give a call up after 60 s


class JobTools:
    """The tools to follow jobs with.

    Parameters
    ----------
    owner
        Who does the work.
    """

    def __init__(self, owner: Owner) -> None:
        self.owner = owner

    def tools(self) -> list[Tool]:
        """Return the tools."""
        seconds = {
            "type": "number", "minimum": 0, "maximum": LONGEST_WAIT_S, "default": PATIENCE_S,
            "description": "Seconds to wait at most.",
        }  # fmt: skip
        return [
            Tool(
                "job_status", "Tell where a job stands.", self._status, {"job_id": JOB},
                ("job_id",), read_only=True, idempotent=True,
            ),
            Tool(
                "job_wait", "Wait for a job and return its answer.",
                self._job, {"job_id": JOB, "seconds": seconds},
                ("job_id",), read_only=True, idempotent=True,
            ),
            Tool(
                "job_cancel", "Call a job off; an action in progress ends and is rolled back.",
                self._cancel, {"job_id": JOB}, ("job_id",), idempotent=True,
            ),
        ]  # fmt: skip

    def _job(self, arguments: Arguments) -> Job:
        name = arguments["job_id"]
        job = self.owner.jobs.get(name)
        if job is None:
            raise UsageError(f'There is no job "{shown(name)}"; it may be of an older server.')
        return job

    def _status(self, arguments: Arguments) -> Reply:
        job = self._job(arguments)
        answer = {"reply": job.reply.result().to_json()} if job.state == "ended" else {}
        return self.owner.ok(job.to_json() | answer, f"{job.what} {job.state}.", job_id=job.id)

    def _cancel(self, arguments: Arguments) -> Reply:
        job = self._job(arguments)
        job.cancel()
        said = "It had ended." if job.state == "ended" else "It ends after the action in progress."
        return self.owner.ok(job.to_json(), said, job_id=job.id)
