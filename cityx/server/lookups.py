"""Tools that look: actions, objects, differences, plans."""

from __future__ import annotations

from collections.abc import Mapping

from cityx.projects import instructions
from cityx.protocol.catalogue import registry_hash
from cityx.protocol.encapsulation import Encapsulation
from cityx.protocol.stages import Stage
from cityx.server import actions, queries
from cityx.server.differences import changed_ids, difference, summed
from cityx.server.jobs import Job
from cityx.server.owner import Owner
from cityx.server.replies import Reply
from cityx.server.tool import PAGE, REVISION, ROWS, SELECTOR, WORDS, Arguments, Tool, text
from cityx.version import __version__


class Lookups:
    """The tools that change nothing.

    Parameters
    ----------
    owner
        Who holds the city.
    records
        Of the actions, by id.
    """

    def __init__(self, owner: Owner, records: Mapping[str, Encapsulation]) -> None:
        self.owner = owner
        self.records = records

    def tools(self) -> list[Tool]:
        """Return the tools."""
        return [
            Tool(
                "actions_search", "Find actions by words, stage and data formats.", self._search,
                {
                    "query": text("Words; all actions when left out.", 200),
                    "stage": text("Stage.", 20, enum=[stage.value for stage in Stage]),
                    "formats": {
                        "type": "array", "maxItems": 20, "items": text("Format.", 40),
                        "description": "Data formats that go in or come out.",
                    },
                    "page": PAGE,
                },
                read_only=True, idempotent=True,
            ),
            Tool(
                "action_doc", "Tell all about an action: arguments, ranges, limits.", self._doc,
                {"name": text("Id or name.", 80)}, ("name",), read_only=True, idempotent=True,
            ),
            Tool(
                "scene_query", "List objects of the city by what they are and where they lie.",
                self._query, {"selector": SELECTOR, "page": PAGE, "page_size": ROWS},
                read_only=True, idempotent=True,
            ),
            Tool(
                "scene_diff", "Tell what differs between two revisions, by hashes of objects.",
                self._diff,
                {"rev_a": REVISION, "rev_b": REVISION, "page": PAGE, "page_size": ROWS},
                ("rev_a", "rev_b"), read_only=True, idempotent=True,
            ),
            Tool(
                "revisions", "List the states of the city that undo can go back to.",
                self._revisions, {"page": PAGE, "page_size": ROWS},
                read_only=True, idempotent=True,
            ),
            Tool(
                "plan", "Tell how a text in words is understood and what would run; runs nothing.",
                self._plan, {"text": WORDS}, ("text",), read_only=True, idempotent=True,
            ),
            Tool(
                "health", "Tell whether the server works, and on what.", self._health,
                read_only=True, idempotent=True,
            ),
        ]  # fmt: skip

    def _search(self, arguments: Arguments) -> Reply:
        rows = actions.search(
            self.records.values(), arguments.get("query", ""), arguments.get("stage", ""),
            arguments.get("formats", ()),
        )  # fmt: skip
        return self.owner.ok(queries.paged(rows, arguments.get("page", 1), actions.MOST_FOUND))

    def _doc(self, arguments: Arguments) -> Reply:
        return self.owner.ok(actions.doc(self.owner.actions, arguments["name"]))

    def _query(self, arguments: Arguments) -> Reply:
        return self.owner.ok(
            queries.query(
                self.owner.seen.built, arguments.get("selector", {}), arguments.get("page", 1),
                arguments.get("page_size", queries.PAGE),
            )
        )  # fmt: skip

    def _diff(self, arguments: Arguments) -> Reply:
        seen = self.owner.seen
        before, after = (
            self.owner.contents.of(seen, arguments[name]) for name in ("rev_a", "rev_b")
        )
        layers = difference(before, after)
        page = queries.paged(
            changed_ids(layers), arguments.get("page", 1), arguments.get("page_size", queries.PAGE)
        )
        ids = page.pop("rows")
        data = page | {"layers": summed(layers), "same": before.total == after.total}
        return self.owner.ok(data, changed=tuple(ids))

    def _revisions(self, arguments: Arguments) -> Reply:
        rows = [queries.revision_record(item) for item in reversed(self.owner.seen.revisions)]
        size = arguments.get("page_size", queries.PAGE)
        return self.owner.ok(queries.paged(rows, arguments.get("page", 1), size))

    def _plan(self, arguments: Arguments) -> Job:
        def work(job: Job) -> Reply:
            told = instructions.plan_text(arguments["text"], self.owner.folder, self.owner.choice)
            return self.owner.ok(told, job_id=job.id)

        return self.owner.submit("plan", work)

    def _health(self, arguments: Arguments) -> Reply:
        del arguments
        owner = self.owner
        running = [job.id for job in tuple(owner.jobs.values()) if job.state == "running"]
        return self.owner.ok(
            {
                "cityx": __version__, "registry": registry_hash(owner.actions),
                "actions": len(self.records), "works": owner.alive, "waiting": owner.waiting,
                "running": running, "built": owner.seen.city is not None,
            },
            "The server works." if owner.alive else "The thread that holds the city has ended.",
        )  # fmt: skip
