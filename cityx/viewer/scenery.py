"""Scenery: what a page is told and given of a city as it is stored."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import asdict, dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from cityx.city.content import HASHES, ContentHash, content_hash, read_hash
from cityx.city.store import View, read_city, read_view
from cityx.errors import UsageError
from cityx.outputs.gltf_instances import illuminance_of
from cityx.system.atomic import replaced
from cityx.system.cache import cache_folder
from cityx.viewer.chunks import Chunk, Cuts, chunks_of, edge_of
from cityx.viewer.content import chunk_bytes, pack_bytes, paints_bytes
from cityx.viewer.lamps import lamps_bytes, lamps_name
from cityx.viewer.library import Pack, Paints, packs_of, paints_of
from cityx.viewer.movement import movement_bytes, movement_name

VERSION = 1  # of what a page is told


@dataclass(frozen=True)
class Scenery:
    """A state of a city in pieces.

    Attributes
    ----------
    view, content
        The city and its hashes.
    chunks, packs, paints
        Its pieces; what is in them is written when it is asked for.
    cuts
        How its layers were cut, for the next state.
    """

    view: View
    content: ContentHash
    chunks: tuple[Chunk, ...]
    packs: tuple[Pack, ...]
    paints: Paints
    cuts: Cuts

    @cached_property
    def lamps(self) -> bytes:
        """What traffic lights show, as the page reads it."""
        return lamps_bytes(self.view)

    def to_json(self) -> dict[str, Any]:
        """Return what a page is told first."""
        view, environment = self.view, self.view.environment
        return {
            "version": VERSION,
            "hash": self.content.total,
            "name": view.name,
            "seed": view.seed,
            "lod": view.lod,
            "frame": {"latitude": view.frame.latitude, "longitude": view.frame.longitude,
                      "projection": view.frame.projection},
            "extent": list(view.extent),
            "attribution": list(view.attribution),
            "environment": asdict(environment) | {"day": environment.day,
                                                  "sun_lux": illuminance_of(environment)},
            "moment": view.moment,
            "movement": movement_name(view),
            "lamps": lamps_name(self.lamps),
            "paints": self.paints.name,
            "packs": [pack.to_json() for pack in self.packs],
            "chunks": [chunk.to_json() for chunk in self.chunks],
        }  # fmt: skip

    def names(self) -> list[str]:
        """Return the names of all files: "chunks/...", "packs/...", "paints/...", and so on."""
        movement, lamps = movement_name(self.view), lamps_name(self.lamps)
        return [
            *(f"chunks/{chunk.name}.glb" for chunk in self.chunks),
            *(f"packs/{pack.name}.glb" for pack in self.packs),
            f"paints/{self.paints.name}.glb",
            *([f"tracks/{movement}.bin"] if movement else []),
            *([f"lamps/{lamps}.json"] if lamps else []),
        ]

    def file(self, name: str) -> bytes:
        """Return a file, from the cache where it was written before.

        Raises
        ------
        UsageError
            If this state of the city has no such file.
        """
        make = self._makers().get(name)
        if make is None:
            raise UsageError(f'There is no "{name}" in the city as it is now.')
        folder = cache_folder()
        if folder is None:
            return make()
        path = folder / "viewer" / name
        with suppress(OSError):
            return path.read_bytes()
        data = make()
        with suppress(OSError), replaced(path) as temporary:
            temporary.write_bytes(data)
        return data

    def _makers(self) -> dict[str, Callable[[], bytes]]:
        makers: dict[str, Callable[[], bytes]] = {}
        for chunk in self.chunks:
            makers[f"chunks/{chunk.name}.glb"] = _late(chunk_bytes, chunk, self.view.attribution)
        for pack in self.packs:
            makers[f"packs/{pack.name}.glb"] = _late(pack_bytes, pack)
        makers[f"paints/{self.paints.name}.glb"] = _late(paints_bytes, self.paints)
        makers[f"tracks/{movement_name(self.view)}.bin"] = _late(movement_bytes, self.view)
        makers[f"lamps/{lamps_name(self.lamps)}.json"] = lambda: self.lamps
        return makers


def _late(function: Callable[..., bytes], *arguments: Any) -> Callable[[], bytes]:
    return lambda: function(*arguments)


def scenery_of(view: View, content: ContentHash, like: Scenery | None = None) -> Scenery:
    """Return a state of a city in pieces; `like` is an earlier one."""
    packs = packs_of(view, content)
    alike = like is not None and like.view.seed == view.seed
    earlier = like.cuts if like is not None and alike else None
    chunks, cuts = chunks_of(view, content, earlier, edge=edge_of(view.extent, view.lod))
    return Scenery(view, content, chunks, packs, paints_of(view, packs), cuts)


def read_scenery(store: Path, like: Scenery | None = None) -> Scenery:
    """Read a stored city in pieces.

    Parameters
    ----------
    like
        An earlier state, whose pieces are kept where they are the same.

    Raises
    ------
    InputError
        If the folder holds no city.
    """
    view = read_view(store)
    content = read_hash(store / HASHES)
    return scenery_of(view, content_hash(read_city(store)) if content is None else content, like)
