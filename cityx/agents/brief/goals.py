"""Goals: every slot and edit as predicates over the finished city, in words of the benchmark."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from types import MappingProxyType

from cityx.agents.brief.brief import Edit, GoalText, Selector, Slot

WITHIN = 0.10  # of a number in the text; counts hold exactly
WITHIN_SIZE = 0.01  # of a size, which can be built exactly
MOST, PART = 0.6, 0.25  # share of buildings that makes a style, and one of several styles
_BUILT = "building"

# Slot -> value -> predicates. "*" stands for every other value, {v} for the value.
WORDS: Mapping[str, Mapping[str, tuple[str, ...]]] = MappingProxyType(
    {
        "district": {
            "downtown": ("stat(building, height, p90) >= 45",),
            "old_town": ("stat(building, floors, p90) <= 6",),
            "suburban": ("stat(building, floors, p90) <= 3",),
            "village": ("stat(building, floors, p90) <= 3",),
            "industrial": ("share(building, use=industrial) >= 0.6",),
            "residential": ("share(building, use=residential) >= 0.6",),
            "commercial": ("share(building, use=retail) >= 0.2",),
            "coastal": ("n(sea) >= 1",),
            "harbour": ("n(harbour) >= 1",),
        },
        "density": {
            "high": ("cover(building) >= 0.35",),
            "medium": ("cover(building) in [0.2, 0.4]",),
            "low": ("cover(building) <= 0.2",),
        },
        "size": {
            "small": ("size.area <= 160000",),
            "medium": ("size.area in [160000, 1000000]",),
            "large": ("size.area >= 1000000",),
        },
        "terrain": {
            "flat": ("stat(terrain, slope, mean) <= 0.02",),
            "*": ("stat(terrain, slope, mean) >= 0.02",),
        },
        "building.height": {
            "tall": ("stat(building, height, p50) >= 25",),
            "medium": ("stat(building, height, p50) in [10, 30]",),
            "low": ("stat(building, height, p90) <= 12",),
            "varied": ("stat(building, height, p90) >= 15",),
        },
        "roads.pattern": {"*": ("road.pattern == {v}",)},
        "roads.width": {
            "wide": ("stat(road, width, p50) >= 12",),
            "narrow": ("stat(road, width, p50) <= 7",),
        },
        "roads.main.width": {
            "wide": ("stat(road, width, max) >= 16",),
            "narrow": ("stat(road, width, max) <= 9",),
        },
        "roads.main.axis": {
            "north_south": (
                "axis(road, class=primary) == north_south",
                "spans(road, class=primary, dir=y) >= 0.95",
            ),
            "east_west": (
                "axis(road, class=primary) == east_west",
                "spans(road, class=primary, dir=x) >= 0.95",
            ),
            "*": ("axis(road, class=primary) == {v}",),
        },
        "nature.trees": {
            "many": ("n(tree) >= 60",), "some": ("n(tree) >= 10",), "few": ("n(tree) <= 30",),
        },
        "weather": {
            "clear": ("env.weather == clear",),
            "rain": ("env.weather == rain", "env.wetness >= 0.4"),
            "storm": ("env.weather == storm", "env.cloud >= 0.8"),
            "fog": ("env.weather == fog", "env.fog >= 0.4"),
            "*": ("env.weather == {v}",),
        },
        "snow.intensity": {
            "light": ("env.snow_cover in [0.05, 0.5]",), "heavy": ("env.snow_cover >= 0.6",),
        },
        "rain.intensity": {
            "light": ("env.wetness in [0.2, 0.8]",), "heavy": ("env.wetness >= 0.7",),
        },
        "fog.intensity": {"light": ("env.fog <= 0.6",), "heavy": ("env.fog >= 0.6",)},
        "wetness": {"high": ("env.wetness >= 0.5",), "low": ("env.wetness <= 0.1",)},
        "time": {
            "night": ("env.time == night", "env.sun_elev < -6"),
            "noon": ("env.sun_elev >= 45",),
            "afternoon": ("env.sun_elev in [15, 55]",),
            "golden_hour": ("env.sun_elev in [2, 12]",),
            "sunset": ("env.sun_elev in [0, 8]", "sun_azimuth in [240, 300]"),
            "sunrise": ("env.sun_elev in [0, 8]", "sun_azimuth in [60, 120]"),
            "dusk": ("env.time == dusk", "env.sun_elev in [-6, 6]"),
            "dawn": ("env.time == dawn", "env.sun_elev in [-6, 6]"),
            "*": ("env.time == {v}",),
        },
        "season": {"*": ("env.season == {v}",)},
        "traffic": {
            "heavy": ("density(vehicle, road.class=primary) >= 25",),
            "medium": ("density(vehicle, road) >= 4",),
            "light": ("density(vehicle, road) in [1, 8]",),
        },
        "pedestrians": {
            "heavy": ("density(pedestrian, sidewalk) >= 15",),
            "medium": ("density(pedestrian, sidewalk) >= 3",),
            "light": ("density(pedestrian, sidewalk) in [0.5, 5]",),
        },
        "lights": {
            "neon": ("n(light, type=neon) >= 20",),
            "on": ("n(streetlight, on=true) >= 10",),
            "off": ("n(streetlight, on=true) == 0",),
        },
        "element": {
            "lake": ("n(lake) >= 1",), "green": ("cover(green) >= 0.1",), "*": ("n({v}) >= 1",),
        },
        "agent": {"*": ("n({v}) >= 1",)},
        "building.type": {"*": ("share(building, type={v}) >= {share}",)},
        "style": {"*": ("share(building, style={v}) >= {share}",)},
        "building.material": {"*": ("share(building, material={v}) >= {share}",)},
        "building.color": {"*": ("share(building, color={v}) >= {share}",)},
        "building.roof": {"*": ("share(building, roof={v}) >= {share}",)},
        "roof.color": {"*": ("share(building, roof_color={v}) >= {share}",)},
        "building.use": {"*": ("share(building, use={v}) >= {share}",)},
        "building.feature": {"*": ("share(building, feature={v}) >= 0.2",)},
        "source": {"*": ("used_source({v})",)},
    }
)  # fmt: skip
# Slot with a number -> what is measured; the comparison follows from exact, ".min" or ".max".
NUMBERS: Mapping[str, str] = MappingProxyType(
    {
        "size.x": "size.x", "size.y": "size.y", "size.area": "size.area",
        "building.count": "n(building)", "green.share": "cover(green)",
        "roads.slope": "stat(road, slope, max)", "roads.width": "stat(road, width, p50)",
        "roads.main.width": "stat(road, width, max)", "roads.avenues": "n(road, class=avenue)",
        "roads.rings": "n(road, class=ring)", "roads.lanes": "stat(road, lanes, p50)",
        "roads.speed": "stat(road, speed, p50)", "nature.spacing": "spacing(tree)",
        "roads.count": "n(road)", "roads.main.count": "n(road, class=primary)",
    }
)  # fmt: skip
_COUNTS = ("count", "avenues", "rings")
_FUNCTIONS = {"min": "min", "max": "max", "": "mean"}
_OPEN = frozenset({"population", "temperature"})  # nothing in a city measures these


def goals_of(
    slots: Sequence[Slot], negated: Sequence[Slot], kept: Sequence[Slot], edits: Sequence[Edit]
) -> tuple[GoalText, ...]:
    """Return the predicates of everything a brief asks for, each once."""
    found: list[GoalText] = []
    for slot in slots:
        found += _slot_goals(slot, slots)
    for slot in negated:
        text = f"no {str(slot.value).replace('_', ' ')}"
        found += [GoalText(text, one, span=slot.span) for one in _absent(str(slot.value))]
    for slot in kept:
        found.append(GoalText(f"{slot.value} as before", f"same({slot.value})", span=slot.span))
    for edit in edits:
        found += _edit_goals(edit)
    if any(edit.target is not None for edit in edits):
        found.append(GoalText("nothing else changes", "same(others)"))
    return tuple({goal.predicate: goal for goal in found}.values())


def _slot_goals(slot: Slot, slots: Sequence[Slot]) -> Iterator[GoalText]:
    text = f"{slot.key} = {slot.value}"
    if isinstance(slot.value, str):
        share = MOST if sum(one.key == slot.key for one in slots) == 1 else PART
        predicates = list(_said(slot.key, slot.value, share))
    else:
        predicates = list(_measured(slot.key, float(slot.value), slots))
    yield from (GoalText(text, one, span=slot.span) for one in predicates)


def _said(key: str, value: str, share: float) -> Iterator[str]:
    table = WORDS.get(key)
    if table is not None:
        for one in table.get(value, table.get("*", ())):
            yield one.format(v=value, share=share)
    elif key.endswith(".side"):
        yield f"side({key.removesuffix('.side')}) == {value}"
    elif key.endswith(".width"):
        wide = "stat({0}, width, mean) >= 30" if value == "wide" else "stat({0}, width, mean) <= 10"
        yield wide.format(key.removesuffix(".width"))


def _measured(key: str, value: float, slots: Sequence[Slot]) -> Iterator[str]:
    end = key.rpartition(".")[2] if key.endswith((".min", ".max")) else ""
    base = key.removesuffix(f".{end}") if end else key
    if base in _OPEN:
        return
    left = _left(base, end, slots)
    if base.startswith("roads.") and base.endswith(".lanes") and not end:
        kind = {"roads.main.lanes": "primary", "roads.other.lanes": "local"}.get(base)
        if kind == "primary":
            yield f"n(road, class=primary, lanes={value:g}) >= 1"
        elif kind == "local":
            yield f"share(road, class=local, lanes={value:g}) == 1.0"
        else:
            yield f"share(road, lanes={value:g}) >= 0.9"
        return
    yield f"{left} {_compared(base, value, end)}"


def _left(base: str, end: str, slots: Sequence[Slot]) -> str:
    if base == "building.count":
        kinds = [slot.value for slot in slots if slot.key == "building.type"]
        return f"n(building, type={kinds[0]})" if len(kinds) == 1 else "n(building)"
    if base in NUMBERS:
        return NUMBERS[base]
    kind, _, measure = base.rpartition(".")
    if measure == "count":
        return f"n({kind})"
    if measure == "share":
        known = kind in ("brick", "glass", "concrete", "stone", "plaster", "timber", "metal")
        return f"share(building, {'material' if known else 'type'}={kind})"
    if measure in ("area", "x", "y"):
        return f"stat({kind.removesuffix('.size')}, {base.removeprefix(kind + '.')}, max)"
    if base.startswith("roads."):
        return f"stat(road, {measure}, p50)"
    return f"stat({kind}, {measure}, {_FUNCTIONS[end]})"


def _compared(base: str, value: float, end: str) -> str:
    slack = WITHIN_SIZE if base.startswith("size.") else 0.0
    if end == "min":
        return f">= {value * (1 - slack):g}"
    if end == "max":
        return f"<= {value * (1 + slack):g}"
    if base.rpartition(".")[2] in _COUNTS:
        return f"== {value:g}"
    slack = WITHIN_SIZE if base in ("size.x", "size.y") else WITHIN
    return f"in [{value * (1 - slack):.8g}, {value * (1 + slack):.8g}]"


_WEATHERS = ("clear", "cloudy", "overcast", "rain", "storm", "fog", "haze", "snow")


def _absent(what: str) -> Iterator[str]:
    if what == "everything":
        return
    if what in _WEATHERS:
        yield f"env.weather != {what}"
    elif what in WORDS["district"] or what in ("modern", "futuristic", "european", "japanese"):
        yield f"share(building, style={what}) == 0"
    elif what in ("tram", "bus", "truck", "taxi", "van", "motorcycle", "bicycle"):
        yield f"n(vehicle, type={what}) == 0"
    elif what in (
        "tower",
        "house",
        "apartment",
        "warehouse",
        "factory",
        "shop",
        "office",
        "terrace",
    ):
        yield f"n(building, type={what}) == 0"
    elif what == "water":
        yield "cover(water) == 0"
    else:
        yield f"n({what}) == 0"


# -- edits ---------------------------------------------------------------------------------------


def selection(target: Selector) -> Iterator[str]:
    """Return a target as terms of predicates, one for each id or one for all."""
    if target.ids:
        yield from target.ids
        return
    kind = target.kind
    if target.rank:
        yield f"top({kind}, {target.rank}, {target.nth or target.k or 1})"
        return
    terms = [kind, *(text.replace("=", "=") for text in target.filters)]
    terms += [f"{name}={value}" for name, value in _where(target)]
    yield ", ".join(terms)


def _where(target: Selector) -> Iterable[tuple[str, str]]:
    for name in ("near", "along", "side", "of"):
        value = getattr(target, name)
        if value:
            yield name, value


def _edit_goals(edit: Edit) -> Iterator[GoalText]:
    change = dict(edit.change)
    text = " ".join(f"{key}={value}" for key, value in edit.items())
    for predicate in _edit_predicates(edit, change):
        yield GoalText(text, predicate, span=edit.span)


def _edit_predicates(edit: Edit, change: Mapping[str, object]) -> Iterator[str]:
    if edit.target is not None:
        for one in selection(edit.target):
            yield from _target_predicates(edit, one, change)
        return
    if edit.verb == "add_agent":
        kind = str(change.get("agent", "vehicle"))
        of = "n(pedestrian)" if kind == "pedestrian" else f"n(vehicle, type={kind})"
        yield f"{of} == {change['count']}" if "count" in change else f"{of} >= 1"
        if kind == "pedestrian" and "path" in change:
            yield f"follows(pedestrian, {change['path']}, dev=0.5)"
    elif edit.verb == "add_traffic":
        on = f", on={change['path']}" if "path" in change else ""
        yield f"n(vehicle{on}) >= 1"
        if "speed" in change:
            speed = float(str(change["speed"]))
            yield f"stat(vehicle{on}, speed, mean) in [{speed * 0.9:.4g}, {speed * 1.1:.4g}]"
    elif edit.verb == "plant":
        yield "changed(tree)"
        if "spacing" in change:
            space = float(str(change["spacing"]))
            yield f"spacing(tree) in [{space * 0.9:g}, {space * 1.1:g}]"
    elif edit.verb in ("add", "add_building"):
        yield f"changed({change.get('element', _BUILT)})"
    else:
        for key, value in change.items():
            yield from (
                _said(key, str(value), MOST) if key != "time" or ":" not in str(value) else ()
            )


def _target_predicates(edit: Edit, one: str, change: Mapping[str, object]) -> Iterator[str]:
    target = edit.target
    assert target is not None
    part = target.share
    if edit.verb == "remove":
        yield f"n({one}) == 0" if not target.ids and part is None else f"changed({one})"
    elif edit.verb.startswith("scale_") and "factor" in change:
        factor = float(str(change["factor"]))
        measure = edit.verb.removeprefix("scale_")
        yield f"ratio({one}, {measure}) in [{factor * 0.99:.4g}, {factor * 1.01:.4g}]"
    elif edit.verb in ("set_material", "set_color", "set_style", "set_roof", "replace"):
        terms = ", ".join(
            f"{key.removeprefix('building.')}={value}" for key, value in change.items()
        )
        if part is None:
            yield f"share({one}, {terms}) == 1.0"
        else:
            yield f"share({one}, {terms}) in [{part - 0.05:.4g}, {part + 0.05:.4g}]"
    elif edit.verb in ("set_height", "set_floors", "set_width"):
        for key, value in change.items():
            measure = key.partition(".")[0]
            number = float(str(value))
            end = key.rpartition(".")[2] if "." in key else ""
            yield f"stat({one}, {measure}, {_FUNCTIONS[end]}) {_compared(measure, number, end)}"
    else:
        yield f"changed({one})"
