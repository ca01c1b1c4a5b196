"""Values of a brief: bounds, numbers and wishes for actions, as the keys of slots tell them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any

from cityx.language.site import OPPOSITE
from cityx.protocol.serving import Slots

Found = dict[str, tuple[Any, ...]]
Wishes = dict[str, dict[str, Any]]  # action, with its kind where it may be called for twice
CLEAR = 0.1  # of a bound, by which it is kept clear
LIMITS = "layout/building_limits-v1"
MOST_FLOORS = 200  # where nothing bounds them


def wish(wishes: Wishes, action: str, **args: Any) -> None:
    """Call for an action; what was asked of it before stays where nothing else is said."""
    key = f"{action}#{args['kind']}" if "kind" in args else action
    wishes.setdefault(key, {}).update(args)


def spare(found: Slots, wishes: Wishes, args: Mapping[str, Any]) -> None:
    """Let what is usual in a quarter bind its houses alone where a kind is asked to be higher."""
    usual = wishes.get(LIMITS, {})
    told = any(key.startswith(("building.floors", "building.height")) for key in found)
    if not told and args.get("least_floors", 0) > usual.get("most_floors", MOST_FLOORS):
        wish(wishes, LIMITS, kind="house", **wishes.pop(LIMITS))


def bounds(
    found: Slots, key: str, least: str, most: str, as_type: Callable[[Any], Any]
) -> dict[str, Any]:
    """Return the least and the greatest value of a slot, each where it is said."""
    exact = found.get(key, (None,))[0]
    ends = {least: found.get(f"{key}.min", (exact,))[0], most: found.get(f"{key}.max", (exact,))[0]}
    numbers = {name: v for name, v in ends.items() if v is not None and not isinstance(v, str)}
    return {name: as_type(value) for name, value in numbers.items()}


def least(counted: Iterable[Mapping[str, Any]]) -> int:
    """Return how many buildings there are at least of kinds that are counted."""
    return sum(int(ends.get("least", 0)) for ends in counted)


def wanted(found: Slots, kind: str) -> dict[str, Any] | None:
    """Return the least and the greatest number of a kind of thing, None where it is not asked."""
    args = bounds(found, f"{kind}.count", "least", "most", int)
    if kind in map(str, found.get("not", ())):
        return {"least": 0, "most": 0}
    if kind in map(str, found.get("element", ())) or "least" in args:
        args.setdefault("least", 1)
    elif "most" in args:
        args["least"] = 0
    else:
        return None
    return args


def side_of_land(found: Slots, rise: str) -> str:
    """Return the side of a site, its middle or its edge, where the land is high or low."""
    form = str(found.get("terrain", ("hill",))[0])
    if form in ("slope", "terraces"):
        shore = next((str(found[key][0]) for key in ("sea.side", "beach.side") if key in found), "")
        up = str(found.get("terrain.side", (OPPOSITE.get(shore, "north"),))[0])
        return up if rise == "high" else OPPOSITE.get(up, "south")
    return "middle" if (rise == "high") == (form != "valley") else "edge"


def is_a_port(found: Slots) -> bool:
    """Return whether a harbour is asked for, which has a quay and a pier."""
    return "harbour" in found.get("element", ()) or "harbour" in found.get("district", ())


def is_wanted(found: Slots, kind: str) -> bool:
    """Return whether at least one of something is asked for."""
    counts = [found.get(f"{kind}.count{end}", (0,))[0] for end in ("", ".min")]
    return kind in found.get("element", ()) or any(int(count) > 0 for count in counts)


def within(found: Slots, key: str) -> float | None:
    """Return a number as a slot says it, or one that keeps its bounds, None where it says none."""
    if key in found:
        return None if isinstance(found[key][0], str) else float(found[key][0])
    low, high = (found.get(f"{key}.{end}", (None,))[0] for end in ("min", "max"))
    if low is not None and high is not None:
        return (float(low) + float(high)) / 2
    clear = 0.0 if key.endswith(".count") else CLEAR
    if low is not None:
        return float(low) * (1 + clear)
    return None if high is None else float(high) * (1 - clear)


def highest(found: Slots, town: dict[str, Any], wishes: Wishes) -> None:
    """Make the highest building as high as is said of it."""
    del town
    height = within(found, "height.highest")
    if height is not None:
        wish(wishes, "layout/highest-v1", height=height)


def number(found: Slots, key: str, margin: float = 0.0) -> float | None:
    """Return the number asked for, or a bound kept clear of by a margin."""
    for end, sign in (("", 0.0), (".min", 1.0), (".max", -1.0)):
        for value in found.get(f"{key}{end}", ()):
            if not isinstance(value, str):
                return float(value) * (1 + sign * margin)
    return None
