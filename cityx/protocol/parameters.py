"""Parameters: the scalar inputs of an action, their ranges and their JSON schema."""

from __future__ import annotations

import json
import math
import types
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from itertools import chain
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from cityx.errors import UsageError, nearest
from cityx.protocol.formats import Format, type_name
from cityx.system.extensions import points_of

MAX_TEXT = 80  # letters of a text argument: names and words, never prose or code
MAX_NAMES = 200_000  # objects that one call may be about: every tree of a large city
_LINEAR_COLOR = "cityx.protocol.values:LinearColor"
# A parameter of one of these types or names would let a caller reach outside the city.
_FORBIDDEN_TYPES = ("Path", "PosixPath", "PurePath", "Callable", "CodeType")
_FORBIDDEN_NAMES = ("path", "file", "filename", "url", "uri", "code", "script", "expression")


TRUE, FALSE = ("true", "yes", "on"), ("false", "no", "off")


@dataclass(frozen=True)
class Range:
    """Inclusive bounds of a number, or of every number of an array."""

    low: float
    high: float

    def __post_init__(self) -> None:
        """Refuse bounds that admit nothing."""
        if not self.low <= self.high:
            raise UsageError(f"Range({self.low}, {self.high}) admits no number.")


@dataclass(frozen=True, init=False)
class Choice:
    """The words a text may be.

    Attributes
    ----------
    words
        The words.
    outside
        Entry point groups of packages whose names it may be besides, spaces between them, or "".
    """

    words: tuple[str, ...]
    outside: str = ""

    def __init__(self, *words: str, outside: str = "") -> None:
        if not words:
            raise UsageError("Choice() admits no word.")
        object.__setattr__(self, "words", tuple(words))
        object.__setattr__(self, "outside", outside)


@dataclass(frozen=True)
class Text:
    """The greatest length of a free text."""

    max_length: int = MAX_TEXT


@dataclass(frozen=True)
class Points:
    """Mark rows of numbers as points of 2 or 3 coordinates, and bound how many they are."""

    least: int = 2
    most: int = 2000


@dataclass(frozen=True)
class Color:
    """Mark a number (0xRRGGBB, sRGB) or three numbers (linear) as a colour."""


@dataclass(frozen=True)
class ObjectName:
    """Mark a text, or each of a tuple of texts, as the name of an object of the city.

    Names are ids, sources and names; see `cityx.protocol.objects.find_object`.
    """


@dataclass(frozen=True)
class Way:
    """Mark a text as words for a way through the city: its name, or "around the park"."""


class _Required:
    """Type of the default of a parameter that has none."""

    def __repr__(self) -> str:
        return "REQUIRED"


REQUIRED = _Required()


@dataclass(frozen=True)
class Parameter:
    """One scalar input.

    Attributes
    ----------
    name, description
        As in the signature and the docstring.
    kind
        JSON type: "integer", "number", "boolean", "string" or "array" (of numbers, of points, or of
        the names of objects).
    format
        The data format the parameter counts as.
    default
        JSON value, or `REQUIRED`.
    low, high
        Inclusive bounds, or None.
    choices
        Words admitted, or ().
    outside
        Entry point group of packages whose names are admitted besides, or "".
    length
        Numbers in an array, or letters in a text.
    points
        Least and greatest number of points of an array of points, or ().
    nullable
        Whether None is admitted.
    names_object
        Whether the text, or every text of the array, must name an object of the city.
    """

    name: str
    description: str
    kind: str
    format: Format
    default: Any = REQUIRED
    low: float | None = None
    high: float | None = None
    choices: tuple[str, ...] = ()
    length: int | None = None
    points: tuple[int, ...] = ()
    nullable: bool = False
    names_object: bool = False
    outside: str = ""

    @property
    def admitted(self) -> tuple[str, ...]:
        """Words admitted, those of installed packages too, or ()."""
        if not self.outside:
            return self.choices
        # "building/ziggurat-v1" and "beehive" are called ziggurat and beehive.
        names = [point.name for group in self.outside.split() for _, point in points_of(group)]
        own = [name for name in names if "/" not in name or name.startswith("building/")]
        words = [name.partition("/")[2].rpartition("-v")[0] or name for name in own]
        return tuple(dict.fromkeys((*self.choices, *words)))

    @property
    def required(self) -> bool:
        """Whether a call must give it."""
        return isinstance(self.default, _Required)

    @property
    def lists_names(self) -> bool:
        """Whether the value is an array of names of objects."""
        return self.names_object and self.kind == "array"

    def schema(self) -> dict[str, Any]:
        """Return the JSON schema of the value."""
        out: dict[str, Any] = {"type": [self.kind, "null"] if self.nullable else self.kind}
        if self.lists_names:
            out |= _array_of({"type": "string", "maxLength": MAX_TEXT}, 1, MAX_NAMES)
        elif self.kind == "array":
            number: dict[str, Any] = {"type": "number"} | self._bounds()
            out |= (
                _array_of(_array_of(number, 2, 3), *self.points)
                if self.points
                else _array_of(number, self.length, self.length)
            )
        else:
            out |= self._bounds()
        if self.choices:
            out["enum"] = [*self.admitted, None] if self.nullable else list(self.admitted)
        elif self.kind == "string":
            out["maxLength"] = self.length
        out["description"] = self.description
        if not self.required:
            out["default"] = self.default
        return out

    def _bounds(self) -> dict[str, Any]:
        pairs = (("minimum", self.low), ("maximum", self.high))
        return {key: value for key, value in pairs if value is not None}

    def fault(self, value: Any) -> str:
        """Return why a value is refused, or "" when it is admitted."""
        if value is None:
            return "" if self.nullable else f"{self.name} = null is not {self._wanted()}."
        shown = repr(value) if len(repr(value)) <= 60 else repr(value)[:57] + "..."
        if not self._has_kind(value):
            return f"{self.name} = {shown} is not {self._wanted()}."
        if self.kind == "string":
            return self._text_fault(value, shown)
        if self.lists_names:
            return next((f for one in value if (f := self._text_fault(one, repr(one)))), "")
        if self.kind == "boolean":
            return ""
        numbers = chain.from_iterable(value) if self.points else value
        for number in numbers if self.kind == "array" else (value,):
            if (self.low is not None and number < self.low) or (
                self.high is not None and number > self.high
            ):
                return f"{self.name} = {shown} is outside {self.interval}."
        return ""

    def _has_kind(self, value: Any) -> bool:
        if self.kind == "boolean":
            return isinstance(value, bool)
        if self.kind == "string":
            return isinstance(value, str)
        if self.kind == "integer":
            whole = isinstance(value, float) and value.is_integer()
            return (isinstance(value, int) and not isinstance(value, bool)) or whole
        if self.kind == "number":
            return _is_number(value)
        if not isinstance(value, list | tuple):
            return False
        if self.lists_names:
            return 1 <= len(value) <= MAX_NAMES and all(isinstance(one, str) for one in value)
        if self.points:
            least, most = self.points
            return least <= len(value) <= most and all(_is_point(row) for row in value)
        return len(value) == self.length and all(_is_number(number) for number in value)

    def _text_fault(self, value: str, shown: str) -> str:
        if self.choices:
            if value in self.choices or value in self.admitted:
                return ""
            words = ", ".join(f'"{word}"' for word in self.admitted)
            hint = nearest(value, self.admitted)
            return f"{self.name} = {shown} is none of {words}.{hint}"
        if len(value) > (self.length or MAX_TEXT):
            return f"{self.name} has {len(value)} letters, more than {self.length or MAX_TEXT}."
        if not value.isprintable() or "://" in value or ".." in value or "\\" in value:
            return f"{self.name} = {shown} is no plain text: no paths, addresses or line breaks."
        if value.startswith(("/", "~")):
            return f"{self.name} = {shown} is no plain text: no paths, addresses or line breaks."
        return ""

    def _wanted(self) -> str:
        if self.points:
            return f"an array of {self.points[0]} to {self.points[1]} points [x, y] or [x, y, z]"
        if self.lists_names:
            return f"an array of 1 to {MAX_NAMES} names of objects"
        if self.kind == "array":
            return f"an array of {self.length} numbers"
        return {
            "integer": "a whole number",
            "number": "a finite number",
            "boolean": "true or false",
            "string": "a text",
        }[self.kind]

    @property
    def interval(self) -> str:
        """The numbers it admits, in words; "" for all."""
        if self.low is None and self.high is None:
            return ""
        if self.low is None:
            return f"at most {_shown(self.high)}"
        if self.high is None:
            return f"at least {_shown(self.low)}"
        return f"{_shown(self.low)} to {_shown(self.high)}"

    def coerce(self, value: Any) -> Any:
        """Return the Python value of an admitted JSON value."""
        if value is None:
            return None
        if self.points:
            return tuple(tuple(float(number) for number in row) for row in value)
        if self.lists_names:
            return tuple(value)
        if self.kind == "array":
            return tuple(float(number) for number in value)
        return {"integer": int, "number": float}.get(self.kind, lambda v: v)(value)

    def read(self, text: str) -> Any:
        """Return the JSON value that a text stands for; the text itself where it stands for none.

        Numbers and names of an array may be written with commas: "80,150" or "b01,b02".
        """
        if self.kind == "string":
            return text
        if self.kind == "boolean":
            return True if text.lower() in TRUE else False if text.lower() in FALSE else text
        listed = self.kind == "array" and not text.strip().startswith("[")
        if listed and self.names_object:
            return [name.strip() for name in text.split(",")]
        try:
            return json.loads(f"[{text}]" if listed else text)
        except ValueError:
            return text

    def to_json(self) -> dict[str, Any]:
        """Return a plain dictionary; a required parameter has no key "default"."""
        record = asdict(self) | {"format": self.format.value, "choices": list(self.choices)}
        record["points"] = list(self.points)
        if self.required:
            del record["default"]
        return record

    @classmethod
    def from_json(cls, record: Mapping[str, Any]) -> Parameter:
        """Rebuild a parameter from `to_json`."""
        changed = {"format": Format(record["format"])}
        lists = {name: tuple(record.get(name, ())) for name in ("choices", "points")}
        return cls(**{**record, **changed, **lists})


def _shown(number: float | None) -> str:
    return str(int(number)) if number is not None and number == int(number) else repr(number)


def _array_of(items: dict[str, Any], least: int | None, most: int | None) -> dict[str, Any]:
    return {"type": "array", "items": items, "minItems": least, "maxItems": most}


def _is_point(value: Any) -> bool:
    return (
        isinstance(value, list | tuple)
        and len(value) in (2, 3)
        and all(_is_number(number) for number in value)
    )


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def parameter_from(name: str, annotation: Any, default: Any, description: str) -> Parameter:
    """Read one parameter from its annotation.

    Raises
    ------
    UsageError
        If the type is none a call may carry.
    """
    kind, marks, nullable = _unwrap(annotation)
    forbidden = name.lower() in _FORBIDDEN_NAMES and not any(isinstance(m, Way) for m in marks)
    if forbidden or type_name(kind).partition(":")[2] in _FORBIDDEN_TYPES:
        raise UsageError(f"Parameter {name}: no action takes code, a path or an address.")
    fields: dict[str, Any] = {}
    is_color = any(mark is Color or isinstance(mark, Color) for mark in marks)
    for mark in marks:
        if isinstance(mark, Range):
            fields |= {"low": mark.low, "high": mark.high}
        elif isinstance(mark, Choice):
            fields |= {"choices": mark.words, "outside": mark.outside}
        elif isinstance(mark, Points):
            fields["points"] = (mark.least, mark.most)
        elif isinstance(mark, Text):
            fields["length"] = mark.max_length
        elif isinstance(mark, ObjectName) or mark is ObjectName:
            fields["names_object"] = True
    if get_origin(kind) is Literal:
        fields["choices"], kind = tuple(get_args(kind)), str
    fmt = Format.RANDOM_NUMBER
    if type_name(kind) == _LINEAR_COLOR:
        kind, is_color = tuple[float, float, float], True
        fields = {"low": 0.0, "high": 1.0} | fields
    if kind is bool:
        json_kind, fmt = "boolean", Format.BOOLEAN
    elif kind is int:
        json_kind = "integer"
        fields = ({"low": 0, "high": 0xFFFFFF} if is_color else {}) | fields
    elif kind is float:
        json_kind = "number"
    elif kind is str and all(isinstance(word, str) for word in fields.get("choices", ())):
        json_kind, fmt = "string", Format.STRING
        fields.setdefault("length", MAX_TEXT)
    elif fields.get("points") and kind == tuple[tuple[float, ...], ...]:
        json_kind, fmt = "array", Format.POINT
    elif fields.get("names_object") and kind == tuple[str, ...]:
        json_kind, fmt = "array", Format.STRING
    elif get_origin(kind) is tuple and set(get_args(kind)) <= {float, int}:
        json_kind, fields["length"] = "array", len(get_args(kind))
    else:
        raise UsageError(
            f"Parameter {name}: {annotation!r} is no type a call can carry; use int, float, bool, "
            "str, Literal of words, a tuple of floats, points, or one of the types of the formats."
        )
    # Equal annotations are one to `typing`: Range(0, 1) may come back as Range(0.0, 1.0).
    bound = int if json_kind == "integer" else float
    fields |= {end: bound(fields[end]) for end in ("low", "high") if end in fields}
    if default is not REQUIRED:
        fields["default"] = list(default) if isinstance(default, tuple) else default
    found = Parameter(
        name,
        description,
        json_kind,
        Format.COLOR if is_color else fmt,
        nullable=nullable,
        **fields,
    )
    if default is not REQUIRED and found.fault(found.default):
        raise UsageError(f"The default of {name} is refused: {found.fault(found.default)}")
    return found


def _unwrap(annotation: Any) -> tuple[Any, tuple[Any, ...], bool]:
    """Take `Annotated` and `| None` off a type: the bare type, its marks, whether None passes."""
    marks: tuple[Any, ...] = ()
    nullable = False
    while True:
        if get_origin(annotation) is Annotated:
            annotation, *more = get_args(annotation)
            marks += tuple(more)
        elif get_origin(annotation) in (Union, types.UnionType):
            rest = [part for part in get_args(annotation) if part is not type(None)]
            if len(rest) == len(get_args(annotation)) or len(rest) != 1:
                return annotation, marks, nullable
            annotation, nullable = rest[0], True
        else:
            return annotation, marks, nullable
