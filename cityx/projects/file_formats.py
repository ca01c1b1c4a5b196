"""The table of output formats: those of CityX and those of installed packages."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from types import MappingProxyType
from typing import TYPE_CHECKING

from cityx.errors import UsageError, nearest
from cityx.outputs.format import Format, admit_format
from cityx.outputs.packed_glb import require_codec
from cityx.outputs.usd import require_usd
from cityx.system.extensions import extensions, refusals, remembered
from cityx.traffic.engine import require_sumo

if TYPE_CHECKING:
    from cityx.city import City

GROUP = "cityx.formats"
FEW_TINTS = 3  # of a prototype in a packed file: colours of vertices are a third of what it weighs


def _glb(city: City, path: Path) -> None:
    from cityx.city.store import view_of
    from cityx.outputs.glb import write_glb

    write_glb(view_of(city), path)


def _glb_like(city: City, path: Path, before: City, shown: Path) -> None:
    from cityx.city.store import view_of
    from cityx.outputs.glb import write_glb

    write_glb(view_of(city), path, like=(before.scene.meshes, shown))


def _packed(city: City, path: Path) -> None:
    from cityx.city.store import view_of
    from cityx.outputs.glb import write_glb
    from cityx.outputs.packed_glb import pack_glb

    with TemporaryDirectory() as folder:
        plain = Path(folder) / "city.glb"
        write_glb(view_of(city), plain, tints=FEW_TINTS)
        pack_glb(plain, path)


def _usd(city: City, path: Path) -> None:
    from cityx.city.store import view_of
    from cityx.outputs.usd import write_usd

    write_usd(view_of(city), path)


def _bodies(city: City, path: Path) -> None:
    from cityx.city.store import view_of
    from cityx.outputs.body_files import write_bodies

    write_bodies(view_of(city), path)


def _mjcf(city: City, path: Path) -> None:
    from cityx.assets.colliders import bodies_of
    from cityx.outputs.body_files import write_mjcf

    write_mjcf(city.scene, bodies_of(city.scene), path, window=city.layout.extent)


def _sumo(city: City, path: Path) -> None:
    from cityx.motion.vehicles import halts_of
    from cityx.traffic.files import write_sumo

    write_sumo(city, halts_of(city), path.parent)


BUILT_IN = (
    Format("blend", "city.blend", None, "editable scene of Blender"),
    Format("glb", "city.glb", _glb, "glTF for engines and the web", renew=_glb_like),
    Format("packed", "city_packed.glb", _packed, "glTF of a quarter of the size", require_codec),
    Format("usd", "city.usdc", _usd, "OpenUSD with physics", require_usd),
    Format("bodies", "city_bodies.npz", _bodies, "colliders, weights and friction as arrays"),
    Format("sumo", "city.sumocfg", _sumo, "roads, routes and signals of SUMO", require_sumo),
    Format("mjcf", "city.xml", _mjcf, "colliders, weights and friction for MuJoCo"),
)


@remembered
def formats() -> Mapping[str, Format]:
    """Return every format by name, those of CityX first."""
    own = {each.name: each for each in BUILT_IN}
    files = {each.file for each in BUILT_IN}

    def admit(value: object) -> tuple[str, Format]:
        name, found = admit_format(value)
        if found.file in files:
            raise UsageError(f'format "{name}" writes {found.file}, which another format writes.')
        files.add(found.file)
        return name, found

    return MappingProxyType(own | extensions(GROUP, admit, own.__contains__))


def formats_named(words: Iterable[str]) -> tuple[Format, ...]:
    """Return the formats that words name, in the order of the table, ready to write.

    Raises
    ------
    UsageError
        Naming every word that is no format.
    MissingExtra
        If a library is missing.
    """
    wanted = set(words)
    own = {each.name: each for each in BUILT_IN}
    known = own if wanted <= set(own) else formats()  # packages are asked only for what is missing
    unknown = sorted(wanted - set(known))
    if unknown:
        hints = [f'"{word}".{nearest(word, known)}' for word in unknown]
        why = "".join(f" {sentence}" for sentence in refusals())
        raise UsageError(
            f"There is no format {' There is no format '.join(hints)} Known are: "
            f"{', '.join(known)}.{why}"
        )
    found = tuple(known[name] for name in known if name in wanted)
    for each in found:
        if each.ready is not None:
            each.ready()
    return found
