"""CityX: words, maps and height fields become explicit, editable 3D cities.

>>> import cityx
>>> city = cityx.build("MAP.osm", "in heavy rain", lod=2)  # doctest: +SKIP
>>> city.edit("make the three tallest buildings 40 m tall")  # doctest: +SKIP
>>> city.buildings.to_crs(4326).plot()  # doctest: +SKIP
>>> city.export("glb", "city.glb")  # doctest: +SKIP

Whatever is exported here is imported when it is first asked for.
"""

from typing import TYPE_CHECKING, Any

from cityx.version import __version__

if TYPE_CHECKING:
    from cityx.api.front import build, explain, open  # noqa: A004
    from cityx.api.project import Project
    from cityx.city import City
    from cityx.errors import (
        ActionFailed,
        ActionRejected,
        CityxError,
        EngineError,
        InputError,
        MissingDependency,
        MissingExtra,
        UsageError,
    )
    from cityx.language.brief import Clarify
    from cityx.options import BuildOptions, HowToRead, PlannerChoice, RenderOptions
    from cityx.projects.desk import Revision
    from cityx.protocol import action
    from cityx.sim import make, make_vec


__all__ = [
    "ActionFailed",
    "ActionRejected",
    "BuildOptions",
    "City",
    "CityxError",
    "Clarify",
    "EngineError",
    "HowToRead",
    "InputError",
    "MissingDependency",
    "MissingExtra",
    "PlannerChoice",
    "Project",
    "RenderOptions",
    "Revision",
    "UsageError",
    "__version__",
    "action",
    "build",
    "explain",
    "make",
    "make_vec",
    "open",
]

_HOMES = {
    "language.brief": ("Clarify",),
    "api.front": ("build", "explain", "open"),
    "api.project": ("Project",),
    "city": ("City",),
    "errors": (
        "ActionFailed", "ActionRejected", "CityxError", "EngineError", "InputError",
        "MissingDependency", "MissingExtra", "UsageError",
    ),
    "options": ("BuildOptions", "HowToRead", "PlannerChoice", "RenderOptions"),
    "projects.desk": ("Revision",),
    "protocol": ("action",),
    "sim": ("make", "make_vec"),
}  # fmt: skip


def __getattr__(name: str) -> Any:
    from importlib import import_module

    home = next((module for module, names in _HOMES.items() if name in names), None)
    if home is None:
        raise AttributeError(f"module 'cityx' has no attribute {name!r}")
    return getattr(import_module(f"cityx.{home}"), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
