"""The default workflow as data: registered actions in order, with the options that reach them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any


@dataclass(frozen=True)
class WorkflowStep:
    """One action of a workflow.

    Attributes
    ----------
    action
        Id of a registered action.
    lods
        Levels of detail at which the step runs.
    options
        Parameter of the action to the build option that fills it.
    """

    action: str
    lods: tuple[int, ...] = (0, 1, 2, 3)
    options: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))


# Weather comes before trees, which are bare under snow.
MAP_TO_CITY: tuple[WorkflowStep, ...] = (
    WorkflowStep("background/sun-v1", options={"time": "time"}),
    WorkflowStep("background/weather-v1", options={"preset": "weather"}),
    WorkflowStep("road/drawn_streets-v1"),
    WorkflowStep("road/network-v1"),
    WorkflowStep("road/heights-v1"),
    WorkflowStep("road/lanes-v1"),
    WorkflowStep("road/ground-v1"),
    WorkflowStep("road/surface_material-v1", lods=(1, 2, 3)),
    WorkflowStep("building/prism-v1", lods=(0,)),
    WorkflowStep("building/design-v1", lods=(1, 2, 3)),
    WorkflowStep("building/shell-v1", lods=(1, 2, 3), options={"workers": "workers"}),
    WorkflowStep("building/facade-v1", lods=(2, 3)),
    WorkflowStep("nature/trees-v2", lods=(1, 2, 3)),
    WorkflowStep("nature/barriers-v1", lods=(2, 3)),
    WorkflowStep("nature/shores-v1", lods=(2, 3)),
    WorkflowStep("nature/furniture-v1", lods=(2, 3)),
    WorkflowStep("nature/street_pieces-v1", lods=(2, 3)),
    WorkflowStep("nature/parks-v1", lods=(2, 3)),
    WorkflowStep("nature/gardens-v1", lods=(2, 3)),
    WorkflowStep("road/covers-v1", lods=(2, 3)),
    WorkflowStep("road/guard_rails-v1", lods=(2, 3)),
    WorkflowStep("road/parked_cars-v1", lods=(2, 3)),
)


def calls_of(
    workflow: tuple[WorkflowStep, ...], lod: int, options: Mapping[str, Any]
) -> list[tuple[str, dict[str, Any]]]:
    """Return the actions and arguments of a workflow for one level of detail.

    Options that are None are left out, so the action's own default holds.
    """
    return [
        (
            step.action,
            {
                parameter: options[name]
                for parameter, name in step.options.items()
                if options.get(name) is not None
            },
        )
        for step in workflow
        if lod in step.lods
    ]
