"""Workflows: the actions of a run in order, each with its arguments and with what it is for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

from cityx.protocol.gate import Call

PROPOSED = "proposed by the model"  # why an action is done that no rule asks for


def _nothing() -> Mapping[str, Any]:
    return MappingProxyType({})


@dataclass(frozen=True)
class Item:
    """One action of a workflow.

    Attributes
    ----------
    action
        Its id.
    args, bind
        As of `cityx.protocol.gate.Call`.
    why
        What it is for, in words.
    gives
        The facts it is there for, as "format role".
    firm
        Whether a user asked for it by name: then it must succeed.
    wish
        Slots of the brief that it answers.
    """

    action: str
    args: Mapping[str, Any] = field(default_factory=_nothing)
    bind: Mapping[str, str] = field(default_factory=_nothing)
    why: str = ""
    gives: tuple[str, ...] = ()
    firm: bool = False
    wish: tuple[str, ...] = ()

    @property
    def call(self) -> Call:
        """The call that it proposes."""
        return Call(self.action, self.args, self.bind)

    def to_json(self) -> dict[str, Any]:
        """Return a plain dictionary."""
        return {
            "action": self.action, "args": dict(self.args), "bind": dict(self.bind),
            "why": self.why, "gives": list(self.gives), "firm": self.firm, "wish": list(self.wish),
        }  # fmt: skip

    @classmethod
    def from_json(cls, record: Mapping[str, Any]) -> Item:
        """Rebuild an item from `to_json`."""
        lists = {name: tuple(record[name]) for name in ("gives", "wish")}
        return cls(**{**record, **lists})


@dataclass(frozen=True)
class Workflow:
    """W: the actions that are left to do, in order.

    Attributes
    ----------
    items
        The actions.
    missing
        What was asked for and nothing can bring about, in words.
    rev
        How often it was made anew.
    """

    items: tuple[Item, ...] = ()
    missing: tuple[str, ...] = ()
    rev: int = 0

    def to_json(self) -> dict[str, Any]:
        """Return a plain dictionary."""
        return {
            "items": [item.to_json() for item in self.items],
            "missing": list(self.missing),
            "rev": self.rev,
        }

    @classmethod
    def from_json(cls, record: Mapping[str, Any]) -> Workflow:
        """Rebuild a workflow from `to_json`."""
        items = tuple(map(Item.from_json, record["items"]))
        return cls(items, tuple(record["missing"]), record["rev"])


@dataclass(frozen=True)
class Part:
    """Something that a city is made of.

    Attributes
    ----------
    fact
        Format and role of what an action makes of it.
    name
        In words.
    lods
        Levels of detail that show it.
    """

    fact: tuple[str, str]
    name: str
    lods: tuple[int, ...] = field(default=(0, 1, 2, 3))


_SOLID, _FINE = (1, 2, 3), (2, 3)
# In the order in which they are made where the records of the actions leave it open.
PARTS: tuple[Part, ...] = (
    Part(("scene_layout", "light"), "the light of day"),
    Part(("scene_layout", "weather"), "the weather"),
    Part(("scene_layout", "street_layout"), "streets of drawn curves"),
    Part(("line", "road_network"), "the network of streets"),
    Part(("line", "way_heights"), "heights of streets, bridges and tunnels"),
    Part(("line", "lane_graph"), "lanes"),
    Part(("surface", "ground"), "the ground"),
    Part(("texture_material", "road_surface"), "surfaces of streets", _SOLID),
    Part(("complex_geometry", "building_blocks"), "buildings as blocks", (0,)),
    Part(("scene_layout", "building_design"), "what each building is", _SOLID),
    Part(("complex_geometry", "building_shells"), "walls and roofs", _SOLID),
    Part(("complex_geometry", "facades"), "windows and doors", _FINE),
    Part(("point", "tree"), "trees", _SOLID),
    Part(("complex_geometry", "barriers"), "walls, fences and hedges", _FINE),
    Part(("complex_geometry", "shores"), "shores and quays", _FINE),
    Part(("point", "street_furniture"), "lamps, signals and benches", _FINE),
    Part(("point", "street_pieces"), "things on pavements", _FINE),
    Part(("point", "park_furniture"), "things in parks", _FINE),
    Part(("complex_geometry", "garden_paths"), "garden paths", _FINE),
    Part(("point", "street_cover"), "covers in streets", _FINE),
    Part(("complex_geometry", "guard_rails"), "guard rails", _FINE),
    Part(("point", "vehicle"), "parked cars", _FINE),
)
