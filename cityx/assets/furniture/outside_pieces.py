"""Street objects of installed packages: things that stand about, drawn by other packages."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np

from cityx.assets.styles.materials import MATERIALS
from cityx.city.mesh import MeshBatch
from cityx.errors import UsageError, nearest
from cityx.system.extensions import extensions

GROUP = "cityx.street_objects"


@dataclass(frozen=True)
class StreetObject:
    """A thing that stands about, registered under the entry point group ``cityx.street_objects``.

    Attributes
    ----------
    name
        Its word in commands and sentences, and the name of its entry: "beehive".
    draw
        Returns its mesh; the front looks to -y, the foot stands on z = 0 at the origin, metres.
    words
        What sentences may call it besides, singular.
    tags
        OpenStreetMap's (key, value) pairs of points that are such a thing.
    from_kerb, spacing, apart
        Metres from the kerb, between things of a row, and to trunks and other things.
    """

    name: str
    draw: Callable[[], MeshBatch]
    words: tuple[str, ...] = ()
    tags: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
    from_kerb: float = 0.8
    spacing: float = 20.0
    apart: float = 1.2


def read_pieces(taken: Callable[[str], bool]) -> Mapping[str, StreetObject]:
    """Return the street objects that installed packages add, by name.

    Parameters
    ----------
    taken
        Whether a name is that of a piece of CityX.
    """

    def admit(value: object) -> tuple[str, StreetObject]:
        if not isinstance(value, StreetObject) or not value.name.isidentifier():
            raise UsageError("it is no cityx.assets.furniture.outside_pieces.StreetObject.")
        mesh = value.draw()
        if not isinstance(mesh, MeshBatch) or not len(mesh.faces):
            raise UsageError(f'street object "{value.name}" draws no MeshBatch with faces.')
        if not np.isfinite(mesh.vertices).all():
            raise UsageError(f'street object "{value.name}" has a vertex that is not finite.')
        for word in mesh.materials:
            if word not in MATERIALS:
                hint = nearest(word, MATERIALS)
                raise UsageError(
                    f'street object "{value.name}": there is no material "{word}".{hint}'
                )
        return value.name, value

    return extensions(GROUP, admit, taken)
