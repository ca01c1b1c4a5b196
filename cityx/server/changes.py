"""Tools that change the city: actions, briefs, going back."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import partial

from cityx.projects import instructions
from cityx.projects.drawn import MOST, drawn_of
from cityx.protocol.encapsulation import Encapsulation
from cityx.protocol.gate import Call, GateRejection, find_faults
from cityx.server import actions
from cityx.server.jobs import Job
from cityx.server.owner import Owner
from cityx.server.replies import Reply
from cityx.server.tool import BIND, CHANGING, DRY, WORDS, Arguments, Tool, text, whole

DRAWN = {
    "type": "object", "additionalProperties": False, "required": ["points"],
    "properties": {
        "points": {
            "type": "array", "minItems": 2, "maxItems": MOST,
            "items": {"type": "array", "items": {"type": "number"}, "minItems": 2, "maxItems": 2},
            "description": "Metres east and north of the origin.",
        },
        "area": {"type": "boolean", "default": False, "description": "Whether they go round one."},
    },
    "description": 'A path or an area that the text speaks of: "along this", "in this area".',
}  # fmt: skip
CALLING = {**CHANGING, "bind": BIND, "dry_run": DRY}  # beside the arguments of an action


class Changes:
    """The tools that change the city, each whole or not at all.

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
                "action_call", "Run one action on the city, whole or not at all.", self._call,
                {
                    "name": text("Id or name of the action.", 80),
                    "args": {"type": "object", "description": "Its arguments; see action_doc."},
                    **CALLING,
                },
                ("name",), destructive=True,
            ),
            Tool(
                "undo", "Go back to an earlier revision, or forward to one that was undone.",
                self._undo,
                {"to_rev": whole("Revision; the one before the last change when left out.",
                                  1, 2**31), **CHANGING},
            ),
            Tool(
                "run_brief", "Build the city that a text asks for, or change the one there is.",
                self._brief, {"text": WORDS, "drawn": DRAWN, **CHANGING}, ("text",),
                destructive=True, patience=0,
            ),
        ]  # fmt: skip

    def natives(self, records: Iterable[Encapsulation]) -> list[Tool]:
        """Return a tool for every action."""
        return [self._native(record) for record in records]

    def _native(self, record: Encapsulation) -> Tool:
        limits = f" Limits: {record.limitation}" if record.limitation else ""
        return Tool(
            f"{record.stage}_{record.name}_v{record.version}", record.description + limits,
            partial(self._call_native, record.id), CALLING,
            others=record.schema(), read_only=record.kind == "query",
            destructive=actions.loses(record), idempotent=not actions.loses(record),
        )  # fmt: skip

    def _call_native(self, action: str, arguments: Arguments) -> Reply | Job:
        args = {name: value for name, value in arguments.items() if name not in CALLING}
        rest = {name: value for name, value in arguments.items() if name in CALLING}
        return self._call({**rest, "name": action, "args": args})

    def _call(self, arguments: Arguments) -> Reply | Job:
        owner = self.owner
        call = Call(arguments["name"], arguments.get("args", {}), arguments.get("bind", {}))
        if arguments.get("dry_run"):
            return self._dry(call)

        def work(job: Job) -> Reply:
            before, desk = owner.seen, owner.desk()
            done = desk.change(
                [call], text=f"action_call {call.action}",
                expected=arguments.get("expected_rev"), cancelled=job.cancelled,
            )  # fmt: skip
            owner.committed()
            return owner.changed(before, job, f"Revision {done.number}: {', '.join(done.actions)}.")

        return self._submit("action_call", work, arguments)

    def _dry(self, call: Call) -> Reply:
        faults = find_faults(call, self.owner.seen.built, self.owner.actions)
        if faults:
            raise GateRejection(faults)
        return self.owner.ok({}, f"{self.owner.actions.resolve(call.action)} may run.")

    def _undo(self, arguments: Arguments) -> Job:
        owner = self.owner

        def work(job: Job) -> Reply:
            before, desk = owner.seen, owner.desk()
            done = desk.undo(arguments.get("to_rev"), expected=arguments.get("expected_rev"))
            owner.committed()
            return owner.changed(before, job, f"Revision {done.number}: {done.text}.")

        return self._submit("undo", work, arguments)

    def _brief(self, arguments: Arguments) -> Job:
        owner, given = self.owner, arguments.get("drawn")
        drawn = None
        if given is not None:
            drawn = drawn_of(given["points"], area=given.get("area", False))

        def work(job: Job) -> Reply:
            before = owner.seen
            owner.expect(arguments.get("expected_rev"))
            told = owner.lend(
                lambda folder: instructions.carry_out_text(
                    arguments["text"],
                    folder,
                    job.say,
                    job.cancelled,
                    replace(instructions.QUICK, choice=owner.choice),
                    stored=owner.tell_stored,
                    drawn=drawn,
                )
            )
            message = str(told.get("message", "Done."))
            return owner.changed(
                before, job, message, data=told, warnings=told.get("warnings", ()),
                artifacts=("city://scene/summary", "city://report"),
            )  # fmt: skip

        return self._submit("run_brief", work, arguments)

    def _submit(self, what: str, work: Callable[[Job], Reply], arguments: Arguments) -> Job:
        """Put a change in the queue under its idempotency key."""
        asked = {name: value for name, value in arguments.items() if name != "idempotency_key"}
        request = json.dumps([what, asked], sort_keys=True, default=str)
        key = arguments.get("idempotency_key", "")
        return self.owner.submit(what, work, key=key, request=request)
