"""What all tiles of a run have in common, known before the first is built."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from hashlib import sha256
from pathlib import Path
from typing import Any

from cityx.agents.planning.workflow import Item
from cityx.city import Frame
from cityx.errors import InputError, MissingExtra, UsageError
from cityx.outputs.packing import codec
from cityx.protocol.catalogue import registry_hash
from cityx.protocol.gate import Call
from cityx.protocol.registry import registry
from cityx.system.atomic import replaced
from cityx.tiles.grid import UNIT, Box, Tile, tile_named
from cityx.tiles.ownership import WIDEST

NAME = "tiles.json"
FORMAT = 3
MARGIN = 200.0  # metres; the greatest reach of what docs/tiles.md calls local
# Metres, of a map with heights: a street begins to climb to a bridge or a pass so far before it.
HIGH_MARGIN = 400.0
SIZE = 1000.0  # metres of a side
SMALLEST, LARGEST = UNIT, 4000.0


@dataclass(frozen=True)
class Order:
    """What all tiles of a run have in common.

    Attributes
    ----------
    name
        Of the place.
    frame
        Of all tiles; its origin is no tile's.
    site
        (xmin, ymin, xmax, ymax) metres that the tiles cover.
    seed, lod
        As of a build.
    size, margin
        Side of a tile, and what is built round it to be thrown away, metres.
    inputs
        Name, kind, bytes and checksum of each file.
    items, coarse
        The actions of a tile, and of its overview.
    code
        As of `code_of`; other code may build other tiles.
    plane
        What is asked of the plane of towns (`cityx.tiles.plane`), None for tiles of a map.
    relief
        What all tiles share of the heights of a map (`cityx.tiles.relief`), None if it is level.
    """

    name: str
    frame: Frame
    site: Box
    seed: int
    lod: int
    size: float
    margin: float
    inputs: tuple[Mapping[str, Any], ...]
    items: tuple[Item, ...]
    coarse: tuple[Item, ...]
    code: str
    plane: Mapping[str, Any] | None = None
    relief: Mapping[str, float] | None = None

    @property
    def datum(self) -> float:
        """Metres above sea level of height zero."""
        return 0.0 if self.relief is None else self.relief["datum"]

    def key(self, tile: Tile, fragment: Path, edits: Sequence[Call] = ()) -> str:
        """Return what a tile is built from as 64 hexadecimal digits; the same gives the same.

        The site is not part of it: a run that is extended keeps its tiles. The plane has no
        fragments.
        """
        told = self.to_json()
        del told["site"], told["inputs"], told["name"]
        hasher = sha256(json.dumps([told, tile.name], sort_keys=True).encode())
        for call in edits:
            hasher.update(call.key.encode())
        if self.plane is None:
            hasher.update(fragment.read_bytes())
        return hasher.hexdigest()

    def to_json(self) -> dict[str, Any]:
        """Return a plain dictionary."""
        items = ("items", "coarse")
        told = {key: value for key, value in vars(self).items() if key not in items}
        told |= {key: [item.to_json() for item in getattr(self, key)] for key in items}
        for key in ("plane", "relief"):
            if told[key] is None:
                del told[key]
        return told | {"frame": asdict(self.frame), "site": list(self.site),
                       "inputs": [dict(one) for one in self.inputs]}  # fmt: skip

    @classmethod
    def from_json(cls, record: Mapping[str, Any]) -> Order:
        """Return what `to_json` wrote."""
        told = dict(record)
        for key in ("items", "coarse"):
            told[key] = tuple(map(Item.from_json, told[key]))
        xmin, ymin, xmax, ymax = told["site"]
        told |= {"frame": Frame(**told["frame"]), "site": (xmin, ymin, xmax, ymax),
                 "inputs": tuple(told["inputs"])}  # fmt: skip
        return cls(**told)


UNPACKED = "-unpacked"  # what the code of a machine without the codec of meshes ends with


def code_of() -> str:
    """Return the hash of the actions, and whether this machine packs meshes."""
    return registry_hash(registry()) + ("" if codec() is not None else UNPACKED)


def check_worker(order: Order) -> None:
    """Refuse to build on a machine whose files would be others than those of the run.

    Raises
    ------
    MissingExtra, UsageError
        If it does not pack meshes and the run does, or the other way round.
    """
    packs = codec() is not None
    if packs and order.code.endswith(UNPACKED):
        raise UsageError(
            "The tiles were begun without the extra view, so their meshes are not packed; this "
            "worker has it. Build them in another folder."
        )
    if not packs and not order.code.endswith(UNPACKED):
        raise MissingExtra(
            "The meshes of these tiles are packed, for which this worker lacks the extra view: "
            "pip install 'cityx[view]'."
        )


def check_size(size: float, margin: float) -> None:
    """Refuse tiles that cannot be told apart.

    Raises
    ------
    UsageError
        With every fault.
    """
    faults = []
    if size % UNIT or not SMALLEST <= size <= LARGEST:
        faults.append(
            f"--size {size:g} is no size of a tile; it takes a multiple of {UNIT:g} m up to "
            f"{LARGEST:,.0f} m, at which the ground is cut."
        )
    if margin <= WIDEST:
        faults.append(
            f"--margin {margin:g} is too narrow; it takes more than {WIDEST:g} m, and "
            f"{MARGIN:g} m are what objects may depend on."
        )
    if faults:
        raise UsageError(" ".join(faults))


def write_order(order: Order, tiles: list[Tile], folder: Path) -> None:
    """Write what a folder of tiles is made of."""
    told = {"format": FORMAT, **order.to_json(), "tiles": [tile.name for tile in tiles]}
    with replaced(folder / NAME) as temporary:
        temporary.write_text(json.dumps(told, indent=1) + "\n")


def read_order(folder: Path) -> tuple[Order, list[Tile]]:
    """Read what a folder of tiles is made of.

    Raises
    ------
    InputError
        If it holds no tiles.
    """
    path = folder / NAME
    try:
        told = json.loads(path.read_text())
        if told.pop("format") != FORMAT:
            raise InputError(f"{path} is of another version of CityX; build the tiles anew.")
        tiles = [tile_named(name) for name in told.pop("tiles")]
        return Order.from_json(told), tiles
    except FileNotFoundError as error:
        raise InputError(f"{folder} holds no tiles; cityx tiles build makes them.") from error
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise InputError(f"{path} is damaged ({error}).") from error
