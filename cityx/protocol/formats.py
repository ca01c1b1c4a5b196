"""The fourteen data formats that ports carry, each bound to a Python type."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from importlib import import_module
from types import MappingProxyType
from typing import Any

from cityx.errors import UsageError, nearest


class Format(StrEnum):
    """The data formats of the paper's table, in its order."""

    SCENE_LAYOUT = "scene_layout"
    NOISE_FUNCTION = "noise_function"
    IMAGE = "image"
    TEXTURE_MATERIAL = "texture_material"
    GEOGRAPHIC_DATA = "geographic_data"
    POINT = "point"
    BOOLEAN = "boolean"
    COMPLEX_GEOMETRY = "complex_geometry"
    COLOR = "color"
    BASIC_GEOMETRY = "basic_geometry"
    STRING = "string"
    SURFACE = "surface"
    LINE = "line"
    RANDOM_NUMBER = "random_number"


@dataclass(frozen=True)
class FormatType:
    """What a format is in Python.

    Attributes
    ----------
    paper_name
        Its name in the paper's table.
    types
        Qualified names ("module:class") of the Python types that carry it; values are made of the
        first.
    meaning
        One sentence.
    """

    paper_name: str
    types: tuple[str, ...]
    meaning: str

    def python_type(self) -> Any:
        """Import and return the type that values of this format are made of."""
        module, _, name = self.types[0].partition(":")
        return getattr(import_module(module), name)


_VALUES = "cityx.protocol.values"
FORMATS: Mapping[Format, FormatType] = MappingProxyType(
    {
        Format.SCENE_LAYOUT: FormatType(
            "Scene Layout",
            ("cityx.city.layout:Layout",),
            "Typed polygons, lines and points with attributes.",
        ),
        Format.NOISE_FUNCTION: FormatType(
            "Noise Function",
            (f"{_VALUES}:NoiseFunction",),
            "A smooth random function of the plane.",
        ),
        Format.IMAGE: FormatType(
            "Image", (f"{_VALUES}:Image",), "Pixels with a place and a size on the ground."
        ),
        Format.TEXTURE_MATERIAL: FormatType(
            "Texture Material",
            ("cityx.assets.styles.materials:Material",),
            "A physically based material with its tileable texture.",
        ),
        Format.GEOGRAPHIC_DATA: FormatType(
            "Geographic Information Data",
            (f"{_VALUES}:GeographicData",),
            "Features with tags in longitude and latitude.",
        ),
        Format.POINT: FormatType(
            "Point", (f"{_VALUES}:Points",), "Positions with a class and a group each."
        ),
        Format.BOOLEAN: FormatType("Boolean Value", ("builtins:bool",), "Yes or no."),
        Format.COMPLEX_GEOMETRY: FormatType(
            "Complex Geometry",
            ("cityx.city.mesh:MeshBatch",),
            "Meshes of objects with materials and texture coordinates.",
        ),
        Format.COLOR: FormatType(
            "Color", (f"{_VALUES}:LinearColor",), "Linear red, green and blue, each 0 to 1."
        ),
        Format.BASIC_GEOMETRY: FormatType(
            "Basic Geometry", (f"{_VALUES}:Boxes",), "Upright boxes: base centre, size, heading."
        ),
        Format.STRING: FormatType("String Information", ("builtins:str",), "A word or short text."),
        Format.SURFACE: FormatType(
            "Surface",
            (f"{_VALUES}:Surfaces", f"{_VALUES}:Footprint"),
            "Polygons with a class and a height each.",
        ),
        Format.LINE: FormatType(
            "Line",
            (f"{_VALUES}:Lines",),
            "Polylines with a class and a width each.",
        ),
        Format.RANDOM_NUMBER: FormatType(
            "Random Number",
            ("builtins:float", "builtins:int", "numpy.random._generator:Generator"),
            "A number, a seed or a random stream.",
        ),
    }
)

_BY_TYPE = {name: fmt for fmt, spec in FORMATS.items() for name in spec.types}


def type_name(kind: Any) -> str:
    """Return "module:class" of a type, or "" of something that is none."""
    name = getattr(kind, "__qualname__", getattr(kind, "__name__", ""))
    return f"{getattr(kind, '__module__', '')}:{name}" if name else ""


def format_of(kind: Any) -> Format | None:
    """Return the format that a Python type carries, or None."""
    return _BY_TYPE.get(type_name(kind))


def to_format(name: str | Format) -> Format:
    """Return the format of a name such as "line" or "scene layout".

    Raises
    ------
    UsageError
        If it is none of the fourteen.
    """
    word = str(name).strip().lower().replace(" ", "_")
    try:
        return Format(word)
    except ValueError:
        known = [fmt.value for fmt in Format]
        hint = nearest(word, known) or f" Known are {', '.join(known)}."
        raise UsageError(f'There is no format "{name}".{hint}') from None


@dataclass(frozen=True, init=False)
class Port:
    """A named input or output of an action.

    Attributes
    ----------
    name
        The word for it; for a typed action the name of the parameter.
    format
        One of the fourteen.
    role
        What it is of its format ("road_centerline"), since a line is not any line; "" for any.
    optional
        Whether the action also runs without it.
    """

    name: str
    format: Format
    role: str
    optional: bool

    def __init__(
        self,
        name: str,
        format: str | Format,  # noqa: A002  the port's own word
        role: str = "",
        *,
        optional: bool = False,
    ) -> None:
        object.__setattr__(self, "name", name)
        object.__setattr__(self, "format", to_format(format))
        object.__setattr__(self, "role", role)
        object.__setattr__(self, "optional", optional)

    def __str__(self) -> str:
        """Return the port as it is shown: "roads: line (road_centerline)"."""
        return f"{self.name}: {self.format.value}" + (f" ({self.role})" if self.role else "")

    def to_json(self) -> dict[str, Any]:
        """Return a plain dictionary."""
        return {
            "name": self.name,
            "format": self.format.value,
            "role": self.role,
            "optional": self.optional,
        }

    @classmethod
    def from_json(cls, record: Mapping[str, Any]) -> Port:
        """Rebuild a port from `to_json`."""
        return cls(
            record["name"], record["format"], record["role"], optional=bool(record["optional"])
        )
