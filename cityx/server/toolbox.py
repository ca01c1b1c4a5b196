"""The tools over one city, by name."""

from __future__ import annotations

from cityx.errors import UsageError, nearest
from cityx.protocol.catalogue import known_records
from cityx.server.changes import Changes
from cityx.server.job_tools import JobTools
from cityx.server.layers import shown
from cityx.server.lookups import Lookups
from cityx.server.owner import Owner
from cityx.server.products import Products
from cityx.server.tool import Tool


class Toolbox:
    """Every tool that clients are offered.

    Parameters
    ----------
    owner
        Who holds the city.
    full
        Whether every action is a tool of its own too.
    """

    def __init__(self, owner: Owner, *, full: bool = False) -> None:
        records = {record.id: record for record in known_records(owner.actions)}
        changes = Changes(owner)
        makers = (Lookups(owner, records), changes, Products(owner), JobTools(owner))
        tools = [tool for maker in makers for tool in maker.tools()]
        if full:
            tools += changes.natives(records.values())
        self.tools = {tool.name: tool for tool in tools}

    def find(self, name: str) -> Tool:
        """Return a tool.

        Raises
        ------
        UsageError
            If there is none of this name.
        """
        if name not in self.tools:
            raise UsageError(f'There is no tool "{shown(name)}".{nearest(name, self.tools)}')
        return self.tools[name]
