"""The vocabulary of predicates: forms and their arguments, kinds of things, their attributes."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from types import MappingProxyType

from cityx.assets.outside_words import outside_pieces
from cityx.checks.predicates import words
from cityx.checks.predicates.syntax import (
    Argument,
    Arithmetic,
    Call,
    Comparison,
    Condition,
    Expression,
    Name,
    Negative,
    Number,
    Predicate,
    Within,
)
from cityx.errors import nearest
from cityx.system.tables import table

ASKED_KINDS = tuple(table("city/asked_things", float))
NUMBER, WORD, FLAG, PLACE, IDENTITY = "number", "word", "flag", "place", "id"
NEAR = "near"  # so many metres from a place: "50 m of river"
TRUTH, COLOR = "truth", "color"
STATISTICS = ("min", "max", "mean", "p10", "p50", "p90")

# Attributes of a family of things -> what they are measured as.
_PLACED = {"id": IDENTITY, "on": PLACE, "in": PLACE}
_SIZES = dict.fromkeys(("height", "length", "width", "scale"), NUMBER)
ATTRIBUTES: Mapping[str, Mapping[str, str]] = MappingProxyType(
    {
        "building": {**_PLACED, "style": WORD, "use": WORD, "tag": WORD, "type": WORD,
                     "generator": WORD,
                     "material": WORD, "roof": WORD, "roof_color": WORD, "roof_form": WORD,
                     "roof_shape": WORD,
                     "color": WORD, "has": WORD,
                     **{f"{part}_color": WORD for part in words.PAINTED},
                     **dict.fromkeys(words.COUNTED_PARTS, NUMBER),
                     **{f"{part}_height": NUMBER for part in words.BODY_PARTS},
                     **{f"{part}_{look}": WORD for part in words.BODY_PARTS
                        for look in ("color", "material")},
                     "height": NUMBER, "floors": NUMBER, "area": NUMBER,
                     "length": NUMBER, "width": NUMBER, "around": NUMBER,
                     "attached": NUMBER, "garden": NUMBER,
                     "driveway": NUMBER, "garage": NUMBER, "rise": NUMBER,
                     "near": NEAR, "part": WORD, "added": FLAG},
        "road": {**_PLACED, "class": WORD, "name": IDENTITY, "lanes": NUMBER, "width": NUMBER,
                 "slope": NUMBER, "speed": NUMBER, "length": NUMBER, "surface": WORD,
                 "oneway": FLAG, "parking": WORD, "cycling": WORD, "protected": FLAG,
                 "walk": NUMBER, "median": NUMBER},
        "bridge": {**_PLACED, "over": PLACE, "length": NUMBER, "width": NUMBER,
                   "closed": FLAG, "material": WORD, "color": WORD},
        "line": {**_PLACED, "height": NUMBER, "length": NUMBER, "material": WORD,
                 "color": WORD},
        "crossing": {**_PLACED},
        "land": {**_PLACED, "area": NUMBER, "width": NUMBER, "length": NUMBER,
                 "material": WORD, "color": WORD},
        "surface": {"area": NUMBER},
        "piece": {**_PLACED, **_SIZES, "species": WORD, "material": WORD, "color": WORD},
        "lamp": {**_PLACED, **_SIZES, "on": FLAG, "material": WORD, "color": WORD},
        "light": {**_PLACED, "on": FLAG, "type": WORD},
        "vehicle": {**_PLACED, "at": PLACE, "to": PLACE, "from": PLACE, "type": WORD,
                    "moves": FLAG, "beacons": FLAG, "color": WORD, "length": NUMBER,
                    "speed": NUMBER},
        "pedestrian": {**_PLACED, "at": PLACE, "to": PLACE, "from": PLACE, "mode": WORD,
                       "gender": WORD, "age": WORD, "gear": WORD, "wears": WORD,
                       "height": NUMBER, "speed": NUMBER},
        "block": {**_PLACED, "area": NUMBER, "width": NUMBER, "length": NUMBER},
        "roundabout": {**_PLACED, "area": NUMBER, "width": NUMBER},
        "dead_end": _PLACED,
        "junction": {**_PLACED, "arms": NUMBER, "signals": FLAG},
        "road_works": _PLACED,
        **dict.fromkeys(("scaffolding", "steps", "ramp"), _PLACED),
        "crosswalk": {**_PLACED, "ramps": FLAG},
        "place": {},
    }
)  # fmt: skip
# Attributes that say which things are meant; the others are what a share is of.
NARROWING = ("class", "generator", "id", "name", "on", "in", "at", "to", "from", "over", "type",
             "tag", "use", "near", "part", "added")  # fmt: skip
MOVING = ("speed", "mode")  # attributes of what moves


@cache
def _word_lists() -> Mapping[tuple[str, str], tuple[str, ...]]:
    from cityx.assets.styles.style_shares import known_styles

    return {
        ("building", "style"): known_styles(),
        ("building", "use"): tuple(words.USES),
        ("building", "type"): tuple(words.BUILDING_TYPES),
        ("building", "material"): tuple(words.MATERIALS),
        ("building", "roof"): tuple(words.MATERIALS),
        ("building", "color"): tuple(words.COLORS),
        ("building", "has"): tuple(words.PARTS),
        **{
            ("building", f"{part}_color"): tuple(words.COLORS)
            for part in (*words.PAINTED, *words.BODY_PARTS)
        },
        **{("building", f"{part}_material"): tuple(words.MATERIALS) for part in words.BODY_PARTS},
        ("building", "roof_color"): tuple(words.COLORS),
        ("building", "part"): words.SITE_PARTS,
        ("building", "roof_form"): words.ROOF_FORMS,
        ("building", "roof_shape"): words.ROOF_SHAPES,
        **{
            (family, "material"): tuple(words.THING_MATERIALS)
            for family in ("bridge", "line", "piece", "lamp")
        },
        ("land", "material"): tuple(words.COVERS),
        **{
            (family, "color"): tuple(words.COLORS)
            for family in ("bridge", "line", "piece", "lamp", "land")
        },
        ("road", "surface"): tuple(words.PAVINGS),
        ("road", "parking"): words.ON_SIDES,
        ("road", "cycling"): words.ON_SIDES,
        ("road", "class"): (*words.ROAD_CLASSES, words.AVENUE, words.RING),
        ("light", "type"): ("lamp", "neon"),
        ("vehicle", "type"): (*words.VEHICLE_TYPES, *words.VEHICLE_LOOKS),
        ("vehicle", "color"): tuple(words.COLORS),
        ("pedestrian", "mode"): ("walk", "run", "stand", "sit", "talk"),
        ("pedestrian", "age"): words.AGES,
        ("pedestrian", "gear"): words.GEAR,
        ("pedestrian", "wears"): words.WEARS,
        ("pedestrian", "gender"): ("male", "female"),
    }


def known_words(family: str, attribute: str) -> tuple[str, ...]:
    """Return the words that an attribute may have, () for any."""
    return _word_lists().get((family, attribute), ())


# Kinds of pieces that have another name in the scene -> prototypes by their first words.
PIECES: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        **{kind: (kind,) for kind in ASKED_KINDS},
        **table("checks/words", tuple[str, ...], "pieces"),
        **{n: (n,) for n in outside_pieces()},
    }
)
_SYNONYMS = table("checks/words", str, "synonyms")


# Kinds that are places of their own, each a family by itself.
SPOTS = ("block", "roundabout", "dead_end", "junction", "crosswalk", "road_works",
         "scaffolding", "steps", "ramp")  # fmt: skip


def _kinds() -> dict[str, str]:
    return {
        "building": "building", **dict.fromkeys(words.BUILDING_TYPES, "building"),
        "road": "road", "path": "road", "railway": "road", "bridge": "bridge",
        **dict.fromkeys(words.LANDS, "land"),
        **dict.fromkeys(("city_wall", "power_line", "fence", "wall", "hedge"), "line"),
        **dict.fromkeys(("gate", "level_crossing"), "crossing"),
        "carriageway": "surface", "sidewalk": "surface",
        "tree": "piece", "shrub": "piece", **dict.fromkeys(PIECES, "piece"),
        "streetlight": "lamp", "light": "light",
        **dict.fromkeys(("vehicle", "bus", "traffic", "parked_vehicle"), "vehicle"),
        "pedestrian": "pedestrian",
        **{name: name for name in SPOTS},
        "center": "place", "border": "place",
    }  # fmt: skip


KINDS: Mapping[str, str] = MappingProxyType(_kinds())
"""Kind of thing -> its family, a key of `ATTRIBUTES`."""


def kind_named(word: str) -> str:
    """Return the kind that a word means, "" when it is none."""
    word = _SYNONYMS.get(word, word)
    return word if word in KINDS else ""


def family_of(word: str) -> str:
    """Return the family of a kind, "" when it is none."""
    return KINDS.get(kind_named(word), "")


# Quantities without arguments -> what they are.
QUANTITIES: Mapping[str, str] = MappingProxyType(
    {
        "env.weather": WORD, "env.time": WORD, "env.season": WORD,
        **dict.fromkeys(("env.sun_elev", "env.sun_azimuth", "env.fog", "env.wetness",
                         "env.snow_cover", "env.cloud", "env.visibility", "env.wind", "env.rain",
                         "sun_azimuth", "sun_elev", "env.hour", "env.moon", "env.windows",
                         "env.day"), NUMBER),
        "env.sun_side": WORD, "env.wind_from": WORD,
        "population": NUMBER, "plot.ratio": NUMBER,
        **dict.fromkeys(("road.turn", "block.columns", "block.rows"), NUMBER),
        **dict.fromkeys(("size.x", "size.y", "size.area", "journal.mutations"), NUMBER),
        "road.pattern": WORD, "road.side": WORD, "terrain.form": WORD, "terrain.high": WORD,
        "terrain.axis": WORD,
        **dict.fromkeys(("terrain.relief", "terrain.slope", "terrain.steps", "terrain.steep",
                         "river.meeting", "canal.straight"), NUMBER),
    }
)  # fmt: skip
_QUANTITY_WORDS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {"env.weather": tuple(words.WEATHERS), "env.time": tuple(words.TIMES),
     "env.season": words.SEASONS, "env.sun_side": words.COMPASS, "env.wind_from": words.COMPASS,
     "road.pattern": words.PATTERNS, "road.side": words.DRIVEN, "axis": words.AXES,
     "side": words.COMPASS,
     "terrain.form": words.LANDFORMS, "terrain.high": (*words.SIDES, "middle"),
     "terrain.axis": words.AXES}
)  # fmt: skip

THINGS, ATTRIBUTE, STATISTIC, FILE, LAYER, TEXT, PREDICATE, AMOUNT, TOWARDS, SITE_PART = (
    "things", "attribute", "statistic", "file", "layer", "text", "predicate", "amount", "towards",
    "part",
)  # fmt: skip
LAYERS = ("building", "road", "water", "green")


@dataclass(frozen=True)
class Signature:
    """What a form takes and gives.

    Attributes
    ----------
    takes
        What each argument is; conditions belong to the things before them.
    gives
        NUMBER, WORD, COLOR or TRUTH; "things" for a selection such as ``top(...)``.
    options
        Settings of the form itself and what they may be, () for a number.
    """

    takes: tuple[str, ...]
    gives: str
    options: Mapping[str, tuple[str, ...]] = field(default_factory=lambda: MappingProxyType({}))


_S = Signature
FORMS: Mapping[str, Signature] = MappingProxyType(
    {
        "n": _S((THINGS,), NUMBER),
        "share": _S((THINGS,), NUMBER, {"by": ("area", "number")}),
        "cover": _S((THINGS,), NUMBER),
        "stat": _S((THINGS, ATTRIBUTE, STATISTIC), NUMBER),
        "density": _S((THINGS, THINGS), NUMBER),
        "spacing": _S((THINGS, THINGS), NUMBER),
        "dist": _S((THINGS, THINGS), NUMBER),
        "overlap": _S((THINGS, THINGS), NUMBER),
        "inside": _S((THINGS, THINGS), TRUTH),
        "crosses": _S((THINGS, THINGS), TRUTH),
        "around": _S((THINGS, THINGS), TRUTH),
        "enclosed": _S((THINGS, THINGS), NUMBER),
        "before": _S((THINGS, THINGS), TRUTH),
        "behind": _S((THINGS, THINGS), TRUTH),
        "opposite": _S((THINGS, THINGS), TRUTH),
        "at_end": _S((THINGS, THINGS), TRUTH),
        "between": _S((THINGS, THINGS, THINGS), TRUTH),
        "across": _S((THINGS, THINGS, THINGS), TRUTH),
        "near": _S((THINGS, THINGS), NUMBER, {"within": (), "side": words.SIDES}),
        "near_share": _S((THINGS, THINGS), NUMBER, {"within": (), "side": words.SIDES}),
        "part_share": _S((THINGS, SITE_PART), NUMBER),
        "axis": _S((THINGS,), WORD),
        "spans": _S((THINGS,), NUMBER, {"dir": ("x", "y")}),
        "side": _S((THINGS,), WORD),
        "trend": _S((THINGS, ATTRIBUTE, TOWARDS), NUMBER),
        "color": _S((THINGS,), COLOR),
        "follows": _S((THINGS, THINGS), TRUTH, {"dev": ()}),
        "changed": _S((THINGS,), TRUTH),
        "same": _S((THINGS,), TRUTH, {"beyond": ()}),
        "ratio": _S((THINGS, ATTRIBUTE), NUMBER),
        "gained": _S((THINGS,), NUMBER),
        "iou": _S((LAYER, FILE), NUMBER),
        "corr": _S((LAYER, FILE), NUMBER),
        "each": _S((THINGS, PREDICATE), TRUTH),
        "top": _S((THINGS, ATTRIBUTE, AMOUNT), THINGS),
        "min": _S((AMOUNT, AMOUNT), NUMBER),
        "max": _S((AMOUNT, AMOUNT), NUMBER),
        "clean": _S((), TRUTH),
        "reply": _S((TEXT,), TRUTH),
        "mentions": _S((TEXT,), TRUTH),
        "used": _S((TEXT,), TRUTH),
        "unused": _S((TEXT,), TRUTH),
    }
)
OTHERS = "others"


@dataclass(frozen=True)
class Group:
    """One argument of a form, with the conditions that follow it."""

    head: Argument
    conditions: tuple[Condition, ...] = ()

    def __str__(self) -> str:
        """Write it as it stood among the arguments."""
        return ", ".join(map(str, (self.head, *self.conditions)))


def split_arguments(call: Call) -> tuple[tuple[Group, ...], dict[str, Expression]]:
    """Sort the arguments of a form: what it takes with its conditions, and its options.

    ``road.class=primary`` is the roads with a condition: ``road, class=primary``.
    """
    signature = FORMS[call.form]
    groups: list[Group] = []
    options: dict[str, Expression] = {}
    for item in call.arguments:
        wanted = signature.takes[len(groups)] if len(groups) < len(signature.takes) else ""
        if wanted == PREDICATE and isinstance(item, Comparison | Within):
            groups.append(Group(item))
            continue
        subject = _subject(item)
        if subject is None or not isinstance(item, Comparison | Within):
            groups.append(Group(item))
            continue
        head, dot, attribute = subject.rpartition(".")
        if isinstance(item, Comparison) and subject in signature.options:
            options[subject] = item.right
        elif dot and kind_named(head):
            groups.append(Group(Name(head), (_renamed(item, attribute),)))
        elif groups:
            groups[-1] = Group(groups[-1].head, (*groups[-1].conditions, item))
        else:
            groups.append(Group(item))
    return tuple(groups), options


def _subject(item: Argument) -> str | None:
    """Return the word that a condition is about, None when it is about no single word."""
    left = item.left if isinstance(item, Comparison) else item.of if isinstance(item, Within) else 0
    return left.word if isinstance(left, Name) else None


def _renamed(item: Condition, attribute: str) -> Condition:
    if isinstance(item, Within):
        return Within(Name(attribute), item.low, item.high)
    return Comparison(Name(attribute), item.sign, item.right)


def is_identity(word: str) -> bool:
    """Return whether a word can be the id of a thing: it holds a digit, or is no plain word."""
    return any(sign.isdigit() for sign in word) or not word.isidentifier()


def faults_of(predicate: Expression | Predicate) -> list[str]:
    """Return every fault of the names in a predicate, as sentences."""
    if isinstance(predicate, Call):
        signature = FORMS.get(predicate.form)
        if signature is not None and signature.gives != TRUTH:
            return [*_call_faults(predicate),
                    f"{predicate.form}(...) is {_article(signature.gives)}; compare it, as in "
                    f"{predicate} >= 1."]  # fmt: skip
        return _call_faults(predicate)
    if isinstance(predicate, Comparison):
        return _comparison_faults(predicate)
    if isinstance(predicate, Within):
        sides = (predicate.of, predicate.low, predicate.high)
        return [fault for side in sides for fault in _number_faults(side)]
    return [f"{predicate} says nothing; compare it, as in {predicate} >= 1."]


def _article(gives: str) -> str:
    return {THINGS: "a choice of things"}.get(gives, f"a {gives}")


def _comparison_faults(item: Comparison) -> list[str]:
    gives = _gives(item.left)
    if item.sign == "=":
        return ['write "==" to compare.']
    if gives in (WORD, COLOR):
        faults = _expression_faults(item.left)
        name = item.left.form if isinstance(item.left, Call) else str(item.left)
        allowed = tuple(words.COLORS) if gives == COLOR else _QUANTITY_WORDS.get(name, ())
        signs = ("~", "==", "!=") if gives == COLOR else ("==", "!=")
        if item.sign not in signs:
            faults.append(f'"{item.sign}" does not compare words; {" or ".join(signs)} would.')
        return faults + _word_faults(item.right, name, allowed)
    return _number_faults(item.left) + _number_faults(item.right)


def _gives(item: Expression) -> str:
    if isinstance(item, Call):
        return FORMS[item.form].gives if item.form in FORMS else NUMBER
    return QUANTITIES.get(item.word, NUMBER) if isinstance(item, Name) else NUMBER


def _word_faults(item: Expression, of: str, allowed: Iterable[str]) -> list[str]:
    allowed = tuple(allowed)
    if not isinstance(item, Name):
        return [f"{of} is a word, {item} is none."]
    if allowed and item.word not in allowed:
        return [
            f"{of} is never {item.word}; one of {', '.join(allowed)}.{nearest(item.word, allowed)}"
        ]
    return []


def _number_faults(item: Expression) -> list[str]:
    gives = _gives(item)
    if gives != NUMBER:
        return [*_expression_faults(item), f"{item} is {_article(gives)}, not a number."]
    return _expression_faults(item)


def _expression_faults(item: Expression) -> list[str]:
    if isinstance(item, Number):
        return []
    if isinstance(item, Negative):
        return _number_faults(item.of)
    if isinstance(item, Arithmetic):
        return _number_faults(item.left) + _number_faults(item.right)
    if isinstance(item, Call):
        return _call_faults(item)
    if item.word in QUANTITIES:
        return []
    if item.word in FORMS:
        return [f"{item.word} is a form; write {item.word}(...)."]
    return [f"There is no quantity {item.word}.{nearest(item.word, (*QUANTITIES, *FORMS))}"]


def _call_faults(call: Call) -> list[str]:
    signature = FORMS.get(call.form)
    if signature is None:
        return [f"There is no form {call.form}(...).{nearest(call.form, FORMS)}"]
    groups, options = split_arguments(call)
    usage = f"{call.form}({', '.join(signature.takes)})"
    if len(groups) != len(signature.takes):
        return [f"{usage} takes {len(signature.takes)} arguments besides conditions, "
                f"{call} has {len(groups)}."]  # fmt: skip
    faults: list[str] = []
    family = ""
    for wanted, group in zip(signature.takes, groups, strict=True):
        if wanted == THINGS:
            found, more = _things_faults(group, whole=call.form in ("same", "changed"))
            family, faults = family or found, faults + more
        else:
            faults += _argument_faults(wanted, group, family)
    for name, value in options.items():
        allowed = signature.options[name]
        faults += _word_faults(value, name, allowed) if allowed else _number_faults(value)
    return faults


def _argument_faults(wanted: str, group: Group, family: str) -> list[str]:
    head = group.head
    if group.conditions:
        return [f"{group.conditions[0]} stands after {head}, which is no kind of things."]
    if wanted == PREDICATE:
        return faults_of(head)
    if isinstance(head, Comparison | Within):
        return [f"{head} is no {wanted}."]
    if wanted == AMOUNT:
        return _number_faults(head)
    if not isinstance(head, Name):
        return [f"{head} is no {wanted}."]
    if wanted == ATTRIBUTE:
        rows = [ATTRIBUTES[family]] if family else ATTRIBUTES.values()  # a name may be anything's
        known = [name for row in rows for name, what in row.items() if what == NUMBER]
        if head.word not in [*known, "levels"]:
            return [f"{head} is no number that is measured of a {family or 'thing'}; one of "
                    f"{', '.join(known)}.{nearest(head.word, known)}"]  # fmt: skip
    allowed = {
        STATISTIC: STATISTICS, LAYER: (*LAYERS, "terrain"), TOWARDS: words.TOWARDS,
        SITE_PART: words.SITE_PARTS,
    }.get(wanted, ())  # fmt: skip
    return _word_faults(head, wanted, allowed)


def _things_faults(group: Group, *, whole: bool) -> tuple[str, list[str]]:
    """Return the family of what an argument chooses, and what is wrong with it."""
    head = group.head
    if isinstance(head, Call) and head.form in FORMS and FORMS[head.form].gives == THINGS:
        inner, _ = split_arguments(head)
        faults = _call_faults(head)
        base = inner[0].head if inner else None
        family = family_of(base.word) if isinstance(base, Name) else ""
    elif not isinstance(head, Name):
        return "", [f"{head} is no kind of things."]
    else:
        family, faults = family_of(head.word), []
        if not family and not is_identity(head.word) and not (whole and head.word == OTHERS):
            faults.append(f"There is no kind {head.word}.{nearest(head.word, KINDS)}")
    for condition in group.conditions:
        faults += _condition_faults(condition, family)
    return family, faults


def _condition_faults(item: Condition, family: str) -> list[str]:
    subject = _subject(item)
    if subject is None:
        return [f"{item} is no condition; write ATTRIBUTE=VALUE or ATTRIBUTE in [LOW, HIGH]."]
    subject = "floors" if subject == "levels" else subject
    known = ATTRIBUTES.get(family) or {k: v for row in ATTRIBUTES.values() for k, v in row.items()}
    if subject not in known:
        return [f"{subject} is not measured of a {family or 'thing'}; one of "
                f"{', '.join(known)}.{nearest(subject, known)}"]  # fmt: skip
    what = known[subject]
    if isinstance(item, Within):
        faults = [] if what == NUMBER else [f"{subject} is a word and lies in no interval."]
        return faults + _number_faults(item.low) + _number_faults(item.high)
    if what == NUMBER:
        return _number_faults(item.right)
    if item.sign not in ("=", "==", "!="):
        return [f'"{item.sign}" does not compare words; "=" or "!=" would.']
    if what == PLACE:
        return _place_faults(item.right)
    if what == NEAR:
        return _near_faults(item.right)
    allowed = ("true", "false") if what == FLAG else known_words(family, subject)
    return _word_faults(item.right, subject, allowed)


def near_named(word: str) -> tuple[float, str]:
    """Return the metres and the place of words such as "50 m of river"; 0 where they name none."""
    written = _NEAR.fullmatch(word)
    return (float(written[1]), written[2]) if written is not None else (0.0, "")


_NEAR = re.compile(r"([0-9]+(?:\.[0-9]+)?) m of (\S.*)")


def _near_faults(item: Expression) -> list[str]:
    metres, place = near_named(item.word) if isinstance(item, Name) else (0.0, "")
    if metres <= 0.0:
        return [f'near={item} is no distance from a place; write near="50 m of river".']
    if "," in place or kind_named(place) or is_identity(place):
        return []
    return [f"There is no kind {place}.{nearest(place, KINDS)}"]


def quoted_choices(item: Expression | Predicate) -> Iterator[str]:
    """Yield the choices in quotes that a predicate holds: "road, class=main" of near="50 m of ..".

    Parameters
    ----------
    item
        A predicate, or a part of one.
    """
    if isinstance(item, Call):
        for argument in item.arguments:
            yield from quoted_choices(argument)
    elif isinstance(item, Comparison):
        place = near_named(item.right.word)[1] if isinstance(item.right, Name) else ""
        if "," in place and isinstance(item.left, Name) and item.left.word == NEAR:
            yield place
        yield from quoted_choices(item.left)
        yield from quoted_choices(item.right)
    elif isinstance(item, Within):
        yield from quoted_choices(item.of)
    elif isinstance(item, Arithmetic):
        yield from quoted_choices(item.left)
        yield from quoted_choices(item.right)


def _place_faults(item: Expression) -> list[str]:
    if not isinstance(item, Name):
        return [f"{item} is no kind of things."]
    if kind_named(item.word) or is_identity(item.word):
        return []
    return [f"There is no kind {item.word}.{nearest(item.word, KINDS)}"]
