"""What a user asks of actions on the command line: other arguments, and actions of their own."""

from __future__ import annotations

import shlex
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

from cityx.errors import UsageError, nearest
from cityx.protocol.stages import NEUTRAL, Stage, stages_after

if TYPE_CHECKING:
    from cityx.protocol.encapsulation import Encapsulation
    from cityx.protocol.registry import Registry

Planned = tuple[str, dict[str, Any]]  # an action and its arguments


def with_requests(
    calls: Sequence[Planned], settings: Iterable[str], wishes: Iterable[str], actions: Registry
) -> list[Planned]:
    """Put what a user asks for into a workflow.

    Parameters
    ----------
    calls
        The workflow.
    settings
        "NAME=VALUE" or "ACTION.NAME=VALUE": arguments of actions of the workflow.
    wishes
        "ACTION NAME=VALUE ...": actions that are added, in this order: those of the layout after
        the workflow's, edits and renders at the end, others before what is done in their stage.
    actions
        The registry.

    Raises
    ------
    UsageError
        With every fault of every request, before anything runs.
    """
    faults: list[str] = []
    planned = [(action, dict(args)) for action, args in calls]
    for text in settings:
        _set(text, planned, actions, faults)
    added = [call for text in wishes if (call := _wish(text, actions, faults)) is not None]
    for action, args in [*planned, *added]:
        faults += [fault for fault in actions[action].argument_faults(args) if fault not in faults]
    if faults:
        raise UsageError("\n".join(faults))
    places = [_place(action, planned, actions) for action, _ in added]
    # From the last place to the first, and backwards within one, so that the order is kept.
    for index in sorted(range(len(added)), key=lambda index: (places[index], index), reverse=True):
        planned.insert(places[index], added[index])
    return planned


def _place(action: str, planned: list[Planned], actions: Registry) -> int:
    """Return the position of an added action.

    What the workflow makes of a layout comes after every layout action; in the other stages, what
    is added comes first, so that the workflow sees it.
    """
    own = actions[action].stage
    if own in NEUTRAL:
        return len(planned)
    waits = stages_after(own) | ({own} if own != Stage.LAYOUT else set())
    stages = [actions[step].stage for step, _ in planned]
    found = (index for index, stage in enumerate(stages) if stage in waits)
    return next(found, len(planned))


def _set(text: str, planned: list[Planned], actions: Registry, faults: list[str]) -> None:
    name, equals, value = text.partition("=")
    action, _, parameter = name.strip().rpartition(".")
    if not equals or not parameter:
        faults.append(f'--set "{text}" is not of the form NAME=VALUE or ACTION.NAME=VALUE.')
        return
    holders = [
        (record, args)
        for record, args in ((actions[step], args) for step, args in planned)
        if record.parameter(parameter) and (not action or action in _names(record))
    ]
    if len(holders) == 1:
        record, args = holders[0]
        args |= record.read({parameter: value})
        return
    known = [actions[step] for step, _ in planned]
    if holders:
        ways = ", ".join(f"{record.id}.{parameter}" for record, _ in holders)
        faults.append(f'--set "{text}": several actions have "{parameter}"; say which: {ways}.')
    elif action and action not in {word for record in known for word in _names(record)}:
        hint = nearest(action, [record.id for record in known])
        faults.append(f'--set "{text}": this build has no action "{action}".{hint}')
    else:
        asked = [record for record in known if not action or action in _names(record)]
        names = [item.name for record in asked for item in record.parameters]
        faults.append(f'--set "{text}": no action has "{parameter}".{nearest(parameter, names)}')


def _names(record: Encapsulation) -> tuple[str, str, str]:
    """Return what an action may be called: layout/crop-v1, layout/crop or crop."""
    return record.id, f"{record.stage}/{record.name}", record.name


def _wish(text: str, actions: Registry, faults: list[str]) -> Planned | None:
    try:
        words = shlex.split(text)
        action = actions.resolve(words[0])
    except (ValueError, IndexError) as error:
        faults.append(f'--do "{text}" is not of the form ACTION NAME=VALUE ... ({error}).')
        return None
    except UsageError as error:
        faults.append(f'--do "{text}": {error}')
        return None
    record = actions[action]
    args: dict[str, Any] = {}
    for word in words[1:]:
        name, equals, value = word.partition("=")
        if not equals:
            faults.append(f'--do "{text}": "{word}" is not of the form NAME=VALUE.')
            continue
        args |= record.read({name: value})
    return action, args
