"""Conflicts: parts of an instruction that cannot both hold, found before anything runs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from math import ceil, floor

from cityx.language.brief import SINGLE, Conflict, Slot, Span
from cityx.language.measurable import MATERIALS
from cityx.town.building_groups import BuildingGroup, group_of
from cityx.town.elements import ELEMENTS, PLACES

# Least ground of one building, square metres; streets and yards take at least the rest.
FOOTPRINTS: Mapping[str, float] = {
    "tower": 250.0, "house": 50.0, "terrace": 35.0, "villa": 90.0, "apartment": 150.0,
    "warehouse": 400.0, "factory": 500.0, "cottage": 30.0, "bungalow": 60.0,
}  # fmt: skip
SMALLEST, FULLEST = 40.0, 0.75  # square metres of any building, share of ground under buildings
STOREY = (2.2, 6.0)  # metres of the lowest and the highest storey
LANE = 2.5  # metres of the narrowest lane
LOW: Mapping[str, int] = {"bungalow": 1, "cottage": 2}  # storeys that a kind has at most
TALL: Mapping[str, float] = {"tower": 35.0, "high_rise": 20.0, "skyscraper": 60.0}  # metres
USES_OF_SHARES = ("house", "apartment", "office", "shop", "factory")
# Numbers, in metres, that a word for a measure may stand beside.
_WORDS: Mapping[str, tuple[float, float]] = {
    "tall": (20.0, 1e9), "low": (0.0, 20.0), "medium": (6.0, 40.0), "varied": (0.0, 1e9),
    "narrow": (0.0, 1e9), "wide": (0.0, 1e9),  # for what it is
}  # fmt: skip
# What flat land has of these at most: rise over run of its streets and of itself, metres.
FLAT_ENDS: Mapping[str, float] = {
    "roads.slope": 0.02, "terrain.slope": 0.02, "terrain.relief": 4.0,
}  # fmt: skip
_WINDING = {"organic", "cul_de_sac"}  # patterns of streets that go together
THAW = 8.0  # degrees Celsius above which no snow stays
_WEATHER_TOGETHER = (
    # Of two words about one sky, the later in a row says more: "overcast, light snow".
    ("clear", "haze"), ("cloudy", "overcast", "rain", "storm"), ("cloudy", "overcast", "snow"),
    ("cloudy", "overcast", "haze", "fog"), ("clear", "cloudy"), ("clear", "snow"),
)  # fmt: skip
_TIMES_TOGETHER = (
    ("morning", "dawn"), ("morning", "first_light"), ("first_light", "dawn"),
    ("morning", "sunrise"), ("dawn", "sunrise"), ("afternoon", "golden_hour"),
    ("afternoon", "sunset"), ("evening", "golden_hour"), ("evening", "sunset"),
    ("evening", "dusk"), ("sunset", "dusk"), ("evening", "night"), ("sunset", "golden_hour"),
    ("sunrise", "golden_hour"), ("morning", "golden_hour"),
)  # fmt: skip
# What "no X" forbids: keys that begin so, and values of the keys that name things.
_FORBIDS: Mapping[str, tuple[str, ...]] = {
    "building": ("building.count", "building.type", "building.height", "building.floors"),
    "road": ("roads.", "traffic", "bridge.count"),
    "tree": ("nature.trees", "tree.count", "nature.spacing"),
    "vehicle": ("traffic", "vehicle.count", "vehicle.speed"),
    "pedestrian": ("pedestrians", "pedestrian.count"),
}
# Metres that one sees at most; the World Meteorological Organization calls less than 1 km fog.
SEEN = {"fog": 1000.0, "haze": 5000.0}
_NAMING = ("element", "agent", "building.type", "weather", "style", "district")
# What is denied with its kind: who wants no water wants no river.
_KINDS: Mapping[str, tuple[str, ...]] = {
    "water": ("river", "canal", "lake", "pond", "sea", "waterfall"),
    "pedestrian": ("man", "woman"),
}
PARKED = 10.0  # square metres of a car that stands


def reconcile(slots: Sequence[Slot]) -> list[Slot]:
    """Keep of two words that say the same thing more or less exactly the more exact one."""
    found = list(slots)
    clocks = [slot for slot in found if slot.key == "time" and ":" in str(slot.value)]
    if len(clocks) == 1:
        found = [slot for slot in found if slot.key != "time" or slot is clocks[0]]
    found = _seen_through(found)
    for key, rows in (("weather", _WEATHER_TOGETHER), ("time", _TIMES_TOGETHER)):
        values = {slot.value for slot in found if slot.key == key}
        for row in rows:
            if len(values) > 1 and values <= set(row):
                last = max(values, key=lambda value: row.index(str(value)))
                found = [slot for slot in found if slot.key != key or slot.value == last]
                break
    found = _counted_apart(found)
    measured = any(slot.key.startswith("size.") for slot in found)
    found = [slot for slot in found if slot.key != "size" or not measured]
    return [slot for slot in found if not _weaker(slot, found)]


def _seen_through(slots: list[Slot]) -> list[Slot]:
    """Let fog or haze beside rain or snow say how far one sees."""
    falls = any(slot.key == "weather" and slot.value in ("rain", "snow", "storm") for slot in slots)
    if not falls:
        return slots
    return [
        replace(slot, key="visibility.max", value=SEEN[str(slot.value)])
        if slot.key == "weather" and slot.value in SEEN else slot
        for slot in slots if not slot.key.startswith("fog.")
    ]  # fmt: skip


_OF_EACH = ("floors", "height")


def _measured_apart(slots: list[Slot]) -> list[Slot]:
    """Let storeys be of the counted kind beside others: "six offices of 5 floors, a hotel"."""
    types = {str(slot.value) for slot in slots if slot.key == "building.type"}
    counts = [slot for slot in slots if slot.key.startswith("building.count")]
    others = any(
        base in ELEMENTS and bool(ELEMENTS[base].building) and measure in _OF_EACH
        for base, _, measure in (
            slot.key.removesuffix(".min").removesuffix(".max").rpartition(".") for slot in slots
        )
        if base not in types
    )
    if len(types) != 1 or not counts or not others:
        return slots
    kind = next(iter(types))
    first = min(slot.span for slot in counts)
    return [
        replace(slot, key=slot.key.replace("building", kind, 1))
        if slot.key.startswith(("building.count", "building.floors", "building.height"))
        and not isinstance(slot.value, str) and not slot.every and slot.span >= first
        else slot
        for slot in slots
    ]  # fmt: skip


def _counted_apart(slots: list[Slot]) -> list[Slot]:
    """Count each type by itself where two are counted: "80 houses with garages"."""
    slots = _measured_apart(slots)
    types = [slot for slot in slots if slot.key == "building.type"]
    counted = sum(slot.key == "building.count" for slot in slots)
    kinds = {group.kind for group, _ in _counted_groups(slots)}
    if counted < 2 and len({str(slot.value) for slot in types} | (kinds if types else set())) < 2:
        return slots
    found = []
    for slot in slots:
        own = [one for one in types if slot.span[0] <= one.span[0] and one.span[1] <= slot.span[1]]
        of_type = slot.key.startswith("building.count") and own
        key = slot.key.replace("building", str(own[0].value)) if of_type else slot.key
        found.append(replace(slot, key=key))
    return found


def _weaker(slot: Slot, slots: Sequence[Slot]) -> bool:
    """Return whether another slot says the same more exactly."""
    if slot.key == "nature.trees":
        words = {one.value for one in slots if one.key == slot.key}
        counted = any(one.key.startswith(("tree.count", "nature.spacing")) for one in slots)
        return slot.value == "some" and (len(words) > 1 or counted)
    if slot.key in ("traffic", "pedestrians", "wind") and slot.value == "medium":
        return any(one.key == slot.key and one.value != "medium" for one in slots)
    if slot.key == "element":
        return any(one.key == f"{slot.value}.count" for one in slots)
    if slot.value in _WORDS:
        return any(_is_of(one, slot) and _agree(one, slot) for one in slots)
    if slot.key == "district" and slot.value == "residential" and "neighbo" in slot.text.lower():
        return any(one.key == "district" and one is not slot for one in slots) or any(
            one.key == "source" for one in slots
        )
    return False


def _is_of(number: Slot, word: Slot) -> bool:
    """Return whether a number is of the measure that a word tells of."""
    same = number.key in (word.key, f"{word.key}.min", f"{word.key}.max")
    return same and not isinstance(number.value, str)


def _agree(number: Slot, word: Slot) -> bool:
    """Return whether a thing can be as a word says and have a number: "tall, over 200 m"."""
    low, high = _WORDS[str(word.value)]
    below = number.key.endswith(".min") or float(number.value) >= low
    return below and (number.key.endswith(".max") or float(number.value) <= high)


def _words_against_numbers(slots: Sequence[Slot]) -> Iterator[Conflict]:
    """Yield words for a measure that no number beside them allows: "tall, at most 6 m"."""
    for word in slots:
        for number in slots if word.value in _WORDS else ():
            if _is_of(number, word) and not _agree(number, word):
                yield Conflict(
                    f"word_against_number:{word.key}",
                    f'"{word.text}" and "{number.text}" do not go together ({word.key}); leave '
                    "one of the two out.",
                    _spans(word, number),
                )


def conflicts_of(slots: Sequence[Slot], negated: Sequence[Slot]) -> tuple[Conflict, ...]:
    """Return every contradiction, each with where it stands and what would be right."""
    return (
        *_two_values(slots),
        *_words_against_numbers(slots),
        *_bounds(slots),
        *_groups_over_all(slots),
        *_denied(slots, negated),
        *_without_what_it_needs(slots, negated),
        *_crowded(slots),
        *_too_large(slots),
        *(one for base in _bases(slots) for one in _storeys(slots, base)),
        *_above_all(slots),
        *_low_towers(slots),
        *_full_shares(slots),
        *_narrow_lanes(slots),
        *_warm_snow(slots),
        *_flat_slopes(slots),
    )


def _spans(*slots: Slot) -> tuple[Span, ...]:
    return tuple(slot.span for slot in slots)


def _two_values(slots: Sequence[Slot]) -> Iterator[Conflict]:
    for key in sorted(SINGLE):
        words = [slot for slot in slots if slot.key == key and slot.value in _WORDS]
        numbers = [slot for slot in slots if slot.key == key and slot not in words]
        found = numbers if numbers and len(words) < 2 else [*words, *numbers]
        if len(found) > 1 and not {slot.value for slot in found} <= _WINDING:
            said = " and ".join(f'"{slot.text}"' for slot in found)
            yield Conflict(
                f"two_values:{key}",
                f"{said} give {key} {len(found)} values; name one: "
                f"{' or '.join(str(slot.value) for slot in found)}.",
                _spans(*found),
            )


# What needs one of some others -> these, by their keys and values.
_NEEDS: Mapping[str, tuple[str, ...]] = {
    "bridge": ("river", "canal", "lake", "sea", "railway", "harbour", "island", "roads.motorways"),
    "harbour": ("river", "canal", "lake"), "beach": ("river", "lake"),
}  # fmt: skip


def _without_what_it_needs(slots: Sequence[Slot], negated: Sequence[Slot]) -> Iterator[Conflict]:
    """Yield bridges and harbours where the water that they need is not to be there."""
    dry = next((one for one in negated if one.value in ("river", "sea", "water")), None)
    told = {word for one in slots for word in (one.key, one.key.partition(".")[0], one.value)}
    for kind, needed in _NEEDS.items():
        wanted = next((one for one in slots if (one.key, one.value) == ("element", kind)
                       or (one.key.startswith(f"{kind}.count") and one.value)), None)  # fmt: skip
        own = dry is not None and (kind == "bridge") == (dry.value == "river")
        if wanted is None or dry is None or not (own or dry.value == "water"):
            continue
        if told.isdisjoint(needed):
            yield Conflict(
                f"denied_and_wanted:{dry.value}",
                f'"{dry.text}" is not to be there, but "{wanted.text}" needs it; name what else it '
                "lies at, or leave one of the two out.",
                _spans(dry, wanted),
            )


def _bounds(slots: Sequence[Slot]) -> Iterator[Conflict]:
    for low in slots:
        if low.key.endswith(".max") or isinstance(low.value, str):
            continue
        base = low.key.removesuffix(".min")
        ends = (f"{base}.max", base) if low.key.endswith(".min") else (f"{base}.max",)
        for high in slots:
            over = high.key in ends and not isinstance(high.value, str)
            if over and float(low.value) > float(high.value):
                yield Conflict(
                    f"min_over_max:{base}",
                    f"{base} must be at least {low.value:g} and at most {high.value:g}; the first "
                    "must not be above the second.",
                    _spans(low, high),
                )


def _counted_groups(slots: Sequence[Slot]) -> Iterator[tuple[BuildingGroup, Slot]]:
    """Yield groups of which a city has at least so many, with what asks for them."""
    for slot in slots:
        group = group_of(slot.key)
        if group is None or group.added or isinstance(slot.value, str):
            continue
        if slot.key in (f"{group.text}.count", f"{group.text}.count.min") and slot.value:
            yield group, slot


def _groups_over_all(slots: Sequence[Slot]) -> Iterator[Conflict]:
    """Yield more buildings in one place than there may be: "20 houses, 30 of them at the lake"."""
    for group, low in _counted_groups(slots):
        for base in dict.fromkeys((f"{group.kind}.count", "building.count")):
            high = _either(slots, f"{base}.max", base)
            if high is not None and float(low.value) > float(high.value):
                yield Conflict(
                    f"min_over_max:{base}",
                    f'"{low.text}" asks for at least {low.value:g} of {group.text}, but '
                    f'"{high.text}" allows {high.value:g} in all ({base}); change one.',
                    _spans(low, high),
                )
                break


def _denied(slots: Sequence[Slot], negated: Sequence[Slot]) -> Iterator[Conflict]:
    for denial in negated:
        what = str(denial.value)
        for slot in slots:
            kinds = (what, *_KINDS.get(what, ()))
            counted = slot.key in [f"{kind}.count" for kind in kinds] and slot.value != 0
            named = slot.key in _NAMING and slot.value in kinds
            group = group_of(slot.key)
            counted |= group is not None and group.kind in kinds and slot.value != 0
            listed = any(slot.key.startswith(start) for start in _FORBIDS.get(what, ()))
            listed |= what == "building" and group is not None and slot.value != 0
            if (counted or named or listed) and not slot.key.endswith(".max"):
                yield Conflict(
                    f"denied_and_wanted:{what}",
                    f'"{denial.text}" is not to be there, but "{slot.text}" asks for it '
                    f"({slot.key} = {slot.value}); leave one of the two out.",
                    _spans(denial, slot),
                )
                break


def area_of(slots: Sequence[Slot]) -> tuple[float, Slot] | None:
    """Return the square metres that are asked for a site, and what asks for them."""
    sizes = {slot.key: slot for slot in slots if not isinstance(slot.value, str)}
    if "size.area" in sizes:
        return float(sizes["size.area"].value), sizes["size.area"]
    if "size.x" in sizes and "size.y" in sizes:
        return float(sizes["size.x"].value) * float(sizes["size.y"].value), sizes["size.x"]
    return None


def _crowded(slots: Sequence[Slot]) -> Iterator[Conflict]:
    area = area_of(slots)
    if area is None:
        return
    kinds = [str(slot.value) for slot in slots if slot.key == "building.type"]
    ground = min((FOOTPRINTS.get(kind, SMALLEST) for kind in kinds), default=SMALLEST)
    keys = [one.key for one in slots if one.key.removesuffix(".min").endswith("garden.area")]
    garden = _either(slots, *keys)
    about = f"of at least {ground:g} m2"
    if garden is not None:
        ground += float(garden.value)
        about += f" with a garden of {garden.value:g} m2 each"
    for slot in slots:
        if slot.key in ("parked_vehicle.count", "parked_vehicle.count.min"):
            most = int(FULLEST * area[0] / PARKED)
            if float(slot.value) > most:
                yield Conflict(
                    "too_many:parked_vehicle",
                    f"{slot.value:g} parked cars of {PARKED:g} m2 each do not fit on "
                    f"{area[0]:g} m2; at most {most} do, or the city must be larger.",
                    _spans(slot, area[1]),
                )
            continue
        wanted = slot.key in ("building.count", "building.count.min")
        if wanted and float(slot.value) * ground > FULLEST * area[0]:
            most = int(FULLEST * area[0] / ground)
            yield Conflict(
                "too_many:building",
                f"{slot.value:g} buildings {about} do not fit on {area[0]:g} m2; at most {most} "
                f"do, or the city {'or the gardens must change' if garden else 'must be larger'}.",
                _spans(slot, area[1], *([] if garden is None else [garden])),
            )


def _too_large(slots: Sequence[Slot]) -> Iterator[Conflict]:
    """Yield what is larger than the site: a square of 200 m in a town of 150 m."""
    area, sides = area_of(slots), [_either(slots, f"size.{axis}") for axis in "xy"]
    for slot in slots:
        kind, _, measure = slot.key.removesuffix(".min").rpartition(".")
        if isinstance(slot.value, str) or kind not in (*ELEMENTS, *PLACES, "block"):
            continue
        limit: tuple[float, Slot] | None = area if measure == "area" else None
        if measure == "width" and all(sides):
            widest = max((side for side in sides if side), key=lambda side: float(side.value))
            limit = float(widest.value), widest
        if limit is not None and float(slot.value) >= limit[0]:
            unit = "m2" if measure == "area" else "m"
            yield Conflict(
                f"too_large:{kind}",
                f'"{slot.text}" asks for a {kind.replace("_", " ")} of {slot.value:g} {unit}, but '
                f'the site has {limit[0]:g} {unit} ("{limit[1].text}"); change one.',
                _spans(slot, limit[1]),
            )


def _either(slots: Sequence[Slot], *keys: str) -> Slot | None:
    """Return the first number that is said for one of some keys."""
    numbers = {slot.key: slot for slot in slots if not isinstance(slot.value, str)}
    return next((numbers[key] for key in keys if key in numbers), None)


def _bases(slots: Sequence[Slot]) -> list[str]:
    """Return the kinds of buildings of whose heights or storeys something is said."""
    bases = (slot.key.removesuffix(".min").removesuffix(".max") for slot in slots)
    found = (base.rpartition(".") for base in bases)
    return sorted({kind for kind, _, measure in found if measure in ("height", "floors")})


def _storeys(slots: Sequence[Slot], kind: str) -> Iterator[Conflict]:
    types = {slot.value for slot in slots if slot.key == "building.type"}
    kinds = (kind, "building") if types == {kind} else (kind,)  # what is said of all is of these
    (floors_max, floors_min, height_max, height_min) = (
        _either(slots, *(f"{one}.{measure}{end}" for one in kinds for end in (f".{bound}", "")))
        for measure in ("floors", "height") for bound in ("max", "min")
    )  # fmt: skip
    low = next((s for s in slots if s.key == "building.type" and s.value in LOW), None)
    if low is not None and kind in (low.value, "building") and types <= LOW.keys():
        floors_max = floors_max or replace(low, value=LOW[str(low.value)])
    if floors_max and height_min and float(height_min.value) > float(floors_max.value) * STOREY[1]:
        yield Conflict(
            "floors_against_height",
            f"{_storeys_of(floors_max)} cannot reach {height_min.value:g} m; ask for at least "
            f"{ceil(float(height_min.value) / STOREY[1])} floors, or for less height.",
            _spans(floors_max, height_min),
        )
    if floors_min and height_max and float(floors_min.value) * STOREY[0] > float(height_max.value):
        yield Conflict(
            "floors_against_height",
            f"{floors_min.value:g} storeys do not fit into {height_max.value:g} m; "
            f"at most {floor(float(height_max.value) / STOREY[0])} do.",
            _spans(floors_min, height_max),
        )


def _storeys_of(slot: Slot) -> str:
    return "one storey" if slot.value == 1 else f"{slot.value:g} storeys"


def _above_all(slots: Sequence[Slot]) -> Iterator[Conflict]:
    """Yield what must be higher than any building may be: a spire of 40 m in a town of 12 m."""
    for measure, unit in (("height", "m"), ("floors", "floors")):
        limit = _either(slots, f"building.{measure}.max")
        for kind in _bases(slots) if limit is not None else ():
            wanted = _either(slots, f"{kind}.{measure}.min", f"{kind}.{measure}")
            stands = kind in ELEMENTS and bool(ELEMENTS[kind].building)
            stands |= group_of(kind) is not None
            if not stands or wanted is None or limit is None:
                continue
            if float(wanted.value) > float(limit.value):
                word = kind.replace("_", " ")
                yield Conflict(
                    f"above_all:{kind}",
                    f'"{wanted.text}" asks for a {word} of {wanted.value:g} {unit}, but '
                    f'"{limit.text}" allows no building above {limit.value:g} {unit}; change one.',
                    _spans(wanted, limit),
                )


def _low_towers(slots: Sequence[Slot]) -> Iterator[Conflict]:
    limit = _either(slots, "building.height.max")
    for slot in slots:
        kind = str(slot.value) if slot.key == "building.type" else slot.key.partition(".")[0]
        counted = slot.key in (f"{kind}.count", f"{kind}.count.min") and slot.value
        if kind not in TALL or limit is None or not (slot.key == "building.type" or counted):
            continue
        if float(limit.value) < TALL[kind]:
            yield Conflict(
                f"low_towers:{kind}",
                f'"{slot.text}" asks for buildings of {TALL[kind]:g} m and more, but '
                f'"{limit.text}" allows no more than {limit.value:g} m; change one.',
                _spans(slot, limit),
            )


def _full_shares(slots: Sequence[Slot]) -> Iterator[Conflict]:
    """Yield least shares of walls, or of uses, that are more than all buildings together."""
    for words in (MATERIALS, USES_OF_SHARES):
        found = [
            slot
            for slot in slots
            if slot.key.removesuffix(".min") in {f"{word}.share" for word in words}
            and not isinstance(slot.value, str)
        ]
        total = sum(float(slot.value) for slot in found)
        if total > 1.0 + 1e-9:
            said = " and ".join(f'"{slot.text}"' for slot in found)
            yield Conflict(
                "shares_over_all",
                f"{said} are {100 * total:g} % together; they can be 100 % at most.",
                _spans(*found),
            )


def _narrow_lanes(slots: Sequence[Slot]) -> Iterator[Conflict]:
    for kind in ("roads", "roads.main", "roads.other"):
        lanes = _either(slots, f"{kind}.lanes.min", f"{kind}.lanes")
        width = _either(slots, f"{kind}.width.max", f"{kind}.width")
        if lanes and width and float(lanes.value) * LANE > float(width.value):
            yield Conflict(
                f"narrow_lanes:{kind}",
                f"{lanes.value:g} lanes take at least {float(lanes.value) * LANE:g} m, but "
                f'"{width.text}" allows {width.value:g} m; change one.',
                _spans(lanes, width),
            )


def _flat_slopes(slots: Sequence[Slot]) -> Iterator[Conflict]:
    """Yield land that is to be flat and streets, or the land itself, that are to be steep."""
    flat = next((s for s in slots if s.key == "terrain" and s.value == "flat"), None)
    for key, least in FLAT_ENDS.items():
        steep = _either(slots, key, f"{key}.min")
        if flat is not None and steep is not None and float(steep.value) > least:
            yield Conflict(
                f"flat_and_steep:{key}",
                f'"{flat.text}" asks for flat land, but "{steep.text}" for {key} = '
                f"{steep.value:g}; leave one of the two out.",
                _spans(flat, steep),
            )


def _warm_snow(slots: Sequence[Slot]) -> Iterator[Conflict]:
    snow = next((s for s in slots if s.key == "weather" and s.value == "snow"), None)
    warm = [s for s in slots if s.key in ("temperature", "temperature.min")]
    for slot in warm:
        if snow is not None and float(slot.value) > THAW:
            yield Conflict(
                "snow_in_the_heat",
                f"Snow does not lie at {slot.value:g} degrees; ask for at most {THAW:g} degrees, "
                "or for other weather.",
                _spans(snow, slot),
            )
