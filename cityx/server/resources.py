"""Resources: what a client may read of the city, by address."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from mcp.server.mcpserver.resources import DEFAULT_RESOURCE_SECURITY
from mcp.shared.uri_template import UriTemplate

from cityx.errors import UsageError
from cityx.projects.results import VIEWS
from cityx.protocol.catalogue import registry_hash
from cityx.server import queries
from cityx.server.layers import plain, shown
from cityx.server.owner import Owner
from cityx.server.products import picture_path

JSON, PNG = "application/json", "image/png"
# What is other after a change; who watches these is told.
CHANGING = ("city://scene/summary", "city://scene/state", "city://report")
_NUMBER = re.compile(r"[0-9]{1,9}")


@dataclass(frozen=True)
class Resource:
    """One resource, or a family of them.

    Attributes
    ----------
    address
        Template; what stands in braces is given by the client.
    name, description
        As clients see them.
    read
        Called with what stood in the braces; JSON or the bytes of a picture.
    mime
        Media type.
    """

    address: str
    name: str
    description: str
    read: Callable[[Mapping[str, Any]], Any]
    mime: str = JSON

    @property
    def is_family(self) -> bool:
        """Whether the address has something to fill in."""
        return "{" in self.address


class Resources:
    """The resources of one city.

    Parameters
    ----------
    owner
        Who holds it.
    """

    def __init__(self, owner: Owner) -> None:
        self.owner = owner
        self.all = (
            Resource(
                "city://scene/summary", "summary", "What the city is, in less than 2 kB.",
                self._summary,
            ),
            Resource(
                "city://scene/state", "state", "Layer, id and hash of every object, first page.",
                self._state,
            ),
            Resource(
                "city://scene/state{?page}", "state_page",
                "Layer, id and hash of every object, page by page.", self._state,
            ),
            Resource(
                "city://object/{id}", "object", "All that is known of an object but its geometry.",
                self._object,
            ),
            Resource(
                "city://render/{rev}/{view}", "picture",
                "A picture that the tool render made of a revision.", self._picture, PNG,
            ),
            Resource("city://report", "report", "The report: counts, checks, goals.", self._report),
            Resource("city://registry", "registry", "Every action by stage.", self._registry),
            Resource("city://journal/{run}", "journal", "The steps of a run.", self._journal),
        )  # fmt: skip
        self._templates = [(UriTemplate.parse(item.address), item) for item in self.all]

    def read(self, address: str) -> tuple[str, bytes | str]:
        """Return the media type and the content of an address.

        Raises
        ------
        UsageError
            If there is no such resource.
        """
        for template, resource in self._templates:
            given = template.match(address)
            if given is None:
                continue
            if DEFAULT_RESOURCE_SECURITY.validate(given) is not None:
                break
            found = resource.read(given)
            if isinstance(found, bytes):
                return resource.mime, found
            return resource.mime, json.dumps(found, ensure_ascii=True, allow_nan=False)
        known = ", ".join(resource.address for resource in self.all)
        raise UsageError(f'There is no resource "{shown(address)}"; there are {known}.')

    def _summary(self, given: Mapping[str, Any]) -> dict[str, Any]:
        del given
        return queries.summary(self.owner.seen)

    def _state(self, given: Mapping[str, Any]) -> dict[str, Any]:
        seen = self.owner.seen
        content = self.owner.contents.of(seen, seen.revision)
        page = _number(given.get("page", "1"), "page")
        return {"revision": seen.revision} | queries.state(content, page, queries.MOST_ROWS)

    def _object(self, given: Mapping[str, Any]) -> dict[str, Any]:
        seen = self.owner.seen
        city, content = seen.built, self.owner.contents.of(seen, seen.revision)
        return {"revision": seen.revision} | queries.object_record(city, content, given["id"])

    def _picture(self, given: Mapping[str, Any]) -> bytes:
        revision, view = _number(given["rev"], "rev"), given["view"]
        if view in VIEWS:
            path = picture_path(self.owner.folder, revision, view)
            if path.is_file():
                return path.read_bytes()
        raise UsageError(
            f'There is no picture "{shown(view)}" of revision {revision}; '
            f"the tool render makes one of {', '.join(VIEWS)}."
        )

    def _report(self, given: Mapping[str, Any]) -> dict[str, Any]:
        del given
        seen = self.owner.seen
        path = self.owner.folder / "report.json"
        if seen.city is None or not path.is_file():
            raise UsageError("There is no report yet; the tool check makes one.")
        report = _told(json.loads(path.read_text()))
        current = report["hash"] == seen.revisions[-1].content
        return {"revision": seen.revision, "of_this_revision": current, "report": report}

    def _registry(self, given: Mapping[str, Any]) -> dict[str, Any]:
        del given
        actions = self.owner.actions
        return {
            "hash": registry_hash(actions),
            "stages": dict(actions.counts()),
            "actions": [
                {"id": entry.id, "does": entry.summary, "from": entry.package}
                for entry in map(actions.entry, actions)
            ],
        }

    def _journal(self, given: Mapping[str, Any]) -> dict[str, Any]:
        runs = self.owner.seen.runs
        number = _number(given["run"], "run")
        if number not in runs:
            raise UsageError(f"There is no run {number}; they are {', '.join(map(str, runs))}.")
        record, steps = runs[number]
        return {
            "run": number,
            "status": record.status,
            "text": shown(str(record.brief.get("text", ""))),
            "content": record.content,
            "steps": [
                {
                    "index": step.index, "attempt": step.attempt, "action": step.action,
                    "args": _told(step.args), "status": step.status, "ms": step.milliseconds,
                    "error": shown(step.error),
                }
                for step in steps
            ],
        }  # fmt: skip


def _number(text: Any, name: str) -> int:
    if not isinstance(text, str) or not _NUMBER.fullmatch(text):
        raise UsageError(f'{name} = "{shown(str(text))}" is no number.')
    return int(text)


def _told(value: Any) -> Any:
    """Return a JSON value with every text of it as `shown`."""
    if isinstance(value, Mapping):
        return {shown(str(key)): _told(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_told(item) for item in value]
    return plain(value)
