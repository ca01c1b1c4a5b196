"""What a user asks of actions on the command line: other arguments, and actions of their own."""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cityx.agents.planning.workflow import Item
from cityx.errors import InputError, UsageError, nearest
from cityx.protocol.stages import NEUTRAL, Stage, stages_after
from cityx.sources.blend_curves import read_blend_curves

if TYPE_CHECKING:
    from cityx.protocol.encapsulation import Encapsulation
    from cityx.protocol.registry import Registry

BLEND_CURVE = re.compile(r"(.+\.blend):(.+)", re.IGNORECASE)


def with_requests(
    items: Sequence[Item],
    settings: Iterable[str],
    wishes: Iterable[str],
    actions: Registry,
    *,
    done: Iterable[Item] = (),
) -> list[Item]:
    """Put what a user asks for into a workflow.

    Parameters
    ----------
    items
        The workflow.
    settings
        "NAME=VALUE" or "ACTION.NAME=VALUE": arguments of actions of the workflow and of `wishes`.
    wishes
        "ACTION NAME=VALUE ...": actions that are added, in this order: those of the layout after
        the workflow's, edits and renders at the end, others before what is done in their stage.
    actions
        The registry.
    done
        What has run already.

    Raises
    ------
    UsageError
        With every fault of every request, before anything runs.
    """
    faults: list[str] = []
    done = list(done)
    ran = [item.call.key for item in done if item.firm]
    planned = list(items)
    added = [item for text in wishes if (item := _wish(text, actions, faults)) is not None]
    for text in settings:
        _set(text, planned, added, done, actions, faults)
    for item in [*planned, *added]:
        found = actions[item.action].argument_faults(item.args)
        faults += [fault for fault in found if fault not in faults]
    if faults:
        raise UsageError("\n".join(faults))
    for item in tuple(added):
        if item.call.key in ran:
            ran.remove(item.call.key)
            added.remove(item)
    places = [place_of(item.action, planned, actions) for item in added]
    # From the last place to the first, and backwards within one, so that the order is kept.
    for index in sorted(range(len(added)), key=lambda index: (places[index], index), reverse=True):
        planned.insert(places[index], added[index])
    return planned


def place_of(
    action: str, planned: Sequence[Item], actions: Registry | Mapping[str, Encapsulation]
) -> int:
    """Return the position of an added action.

    What the workflow makes of a layout comes after every layout action; in the other stages, what
    is added comes first, so that the workflow sees it, unless it needs what its own stage makes.
    """
    own = actions[action].stage
    if own in NEUTRAL:
        return len(planned)
    later = own == Stage.LAYOUT or own.value in actions[action].requires
    waits = stages_after(own) | (set() if later else {own})
    stages = [actions[item.action].stage for item in planned]
    found = (index for index, stage in enumerate(stages) if stage in waits)
    return next(found, len(planned))


def _set(
    text: str,
    planned: list[Item],
    added: list[Item],
    done: list[Item],
    actions: Registry,
    faults: list[str],
) -> None:
    """Set one argument of the workflow, else of what is added; what is done needs none any more."""
    name, equals, value = text.partition("=")
    action, _, parameter = name.strip().rpartition(".")
    if not equals or not parameter:
        faults.append(f'--set "{text}" is not of the form NAME=VALUE or ACTION.NAME=VALUE.')
        return

    def holds(item: Item) -> bool:
        record = actions[item.action]
        return bool(record.parameter(parameter)) and (not action or action in _names(record))

    known = [*planned, *done]
    holders = list(filter(holds, known)) or list(filter(holds, added))
    if len(holders) == 1:
        args = {**holders[0].args, **actions[holders[0].action].read({parameter: value})}
        for items in (planned, added):
            items[:] = [replace(it, args=args) if it is holders[0] else it for it in items]
        return
    records = [actions[item.action] for item in known]
    if holders:
        ways = ", ".join(f"{item.action}.{parameter}" for item in holders)
        faults.append(f'--set "{text}": several actions have "{parameter}"; say which: {ways}.')
    elif action and action not in {word for record in records for word in _names(record)}:
        hint = nearest(action, [record.id for record in records])
        faults.append(f'--set "{text}": this build has no action "{action}".{hint}')
    else:
        asked = [record for record in records if not action or action in _names(record)]
        names = [item.name for record in asked for item in record.parameters]
        faults.append(f'--set "{text}": no action has "{parameter}".{nearest(parameter, names)}')


def _names(record: Encapsulation) -> tuple[str, str, str]:
    """Return what an action may be called: layout/crop-v1, layout/crop or crop."""
    return record.id, f"{record.stage}/{record.name}", record.name


def drawn_path(record: Encapsulation, name: str, value: str) -> dict[str, Any]:
    """Return the arguments that "FILE.blend:CURVE" stands for, {} where it stands for itself.

    Only who gives files may say so: neither a sentence nor a model names one.

    Raises
    ------
    InputError
        If the file or the curve is none.
    """
    found = BLEND_CURVE.fullmatch(value)
    if found is None or name != "path" or record.parameter("points") is None:
        return {}
    file, curve = found.groups()
    return {"path": curve, "points": read_blend_curves(Path(file)).line(curve)}


def _wish(text: str, actions: Registry, faults: list[str]) -> Item | None:
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
        try:
            args |= drawn_path(record, name, value) or record.read({name: value})
        except InputError as error:
            faults.append(f'--do "{text}": {error}')
    return Item(action, args, why="asked for by name", firm=True)
