"""Places: the world of a city's folder, a city in memory, a map or a sentence; built if needed."""

from __future__ import annotations

import json
import logging
import os
import subprocess
import sys
from collections.abc import Callable, Mapping
from hashlib import blake2b
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from cityx.errors import CityxError, EngineError, InputError, UsageError, nearest
from cityx.sim.scenery import Scenery
from cityx.sim.walks import Walks
from cityx.sim.world import (
    World,
    kept_path,
    kept_scenery,
    kept_scenery_path,
    kept_walks,
    kept_walks_path,
    kept_world,
    write_kept,
)
from cityx.system.cache import kept_folder
from cityx.system.parents import end_with_parent

if TYPE_CHECKING:
    from cityx.city.city import City

STORE = "city"  # folder of the store in the folder of a built city
TILES = "tiles.json"  # in a folder of tiles
JOINER = "cityx.tiles.joining"  # module that joins tiles, run as a process of its own
TILES_SIZE = (1000.0, 1000.0)  # metres about a place in tiles
TOWN_SIZE = (300.0, 300.0)  # metres of a town that a sentence asks for
TOWN_MB = 11.0  # of a town of that size on disk; larger ones have as much more as they are larger
LOD = 1
# Seeds of the first made town of each part; real places are of neither.
SPLITS: Mapping[str, int] = MappingProxyType({"train": 0, "test": 1_000_000})
LONGEST_BUILD = 1800.0  # seconds that a process waits for another that builds the same place
_log = logging.getLogger(__name__)
# How a maker in a process of its own answers.
_DONE, _REFUSED = "done", "refused"


def world_of(
    place: Any = None, *, text: str = "", seed: int = 0, size: Any = None, at: str = ""
) -> World:
    """Return the world of a place; it is compiled where none is kept, in a process of its own.

    Parameters
    ----------
    place
        `World`, one with its walks, `City`, `Project`, folder of a built city or of its store, a
        folder of tiles, a map file, or None for a town.
    text
        What the town, or the city of the map, is to be like.
    seed
        Of the build.
    size
        Metres (width, depth) of a town, or about `at`.
    at
        Of tiles the middle, "LAT,LON" or "X,Y" in metres; those that lie about it are joined, and
        built where they are not.

    Raises
    ------
    InputError, UsageError
        If the place cannot be found or built, or has no lane for cars.
    """
    if isinstance(place, World):
        return place
    if _is_pair(place):
        world: World = place[0]
        return world
    found = _found(place, text, seed, size, at)
    return _world_of_store(found) if isinstance(found, Path) else _world_of_city(found)


def walks_of(
    place: Any = None, *, text: str = "", seed: int = 0, size: Any = None, at: str = ""
) -> tuple[World, Walks]:
    """Return the world of a place and where one walks in it; see `world_of`.

    Raises
    ------
    InputError, UsageError
        As `world_of`; or if nobody can walk there.
    """
    if isinstance(place, World):
        raise UsageError("A world has no walks; give the folder of the city, or the City.")
    if _is_pair(place):
        pair: tuple[World, Walks] = place
        return pair
    found = _found(place, text, seed, size, at)
    if not isinstance(found, Path):
        world = _world_of_city(found)
        return world, kept_walks(world.hash, found.name) or _compiled_walks(found, world)
    world = _world_of_store(found)
    name = world.facts["name"]
    walks = kept_walks(world.hash, name)
    if walks is None:
        in_process({"walks": str(found.resolve())})
        walks = kept_walks(world.hash, name)
    if walks is None:  # without a cache they are compiled here
        from cityx.city.store import read_city

        walks = _compiled_walks(read_city(found), world)
    return world, walks


def _is_pair(place: Any) -> bool:
    """Return whether a place is a world with its walks."""
    return isinstance(place, tuple) and len(place) == 2 and isinstance(place[1], Walks)


def scenery_of(
    place: Any, world: World, *, text: str = "", seed: int = 0, size: Any = None, at: str = ""
) -> Scenery:
    """Return what cameras see of the place whose world is given; see `world_of`.

    Raises
    ------
    InputError, UsageError
        As `world_of`; or if the place is a world whose scenery is not kept.
    """
    name = world.facts["name"]
    kept = kept_scenery(world.hash, name)
    if kept is not None:
        return kept
    if isinstance(place, (World, tuple)):
        raise UsageError("A world has no meshes to be seen; give the folder of the city.")
    found = _found(place, text, seed, size, at)
    if isinstance(found, Path):
        in_process({"scenery": str(found.resolve()), "hash": world.hash})
        kept = kept_scenery(world.hash, name)
        if kept is not None:
            return kept
        from cityx.city.store import read_city

        found = read_city(found)  # without a cache it is compiled here
    return compiled_scenery(found, world.hash)


def compiled_scenery(city: City, city_hash: str) -> Scenery:
    """Return what cameras see of a city, and keep it."""
    from cityx.sim.compile.scenery import compile_scenery

    scenery = compile_scenery(city, city_hash)
    _keep(scenery, kept_scenery_path(city_hash, city.name))
    return scenery


def store_of(
    place: Path | None = None, *, text: str = "", seed: int = 0, size: Any = None, at: str = ""
) -> Path:
    """Return the folder of the store of a city, of a map, or of a town; built where it is not.

    Parameters
    ----------
    place, text, seed, size, at
        As of `world_of`.

    Raises
    ------
    InputError, UsageError
        If the place cannot be found or built.
    """
    found = _found(place, text, seed, size, at)
    assert isinstance(found, Path)
    return found


def towns(
    count: int, *, split: str = "train", text: str = "", size: tuple[float, float] = TOWN_SIZE
) -> tuple[Path, ...]:
    """Return made towns to learn in, or to be judged in; each is built once and kept.

    The first towns of more are the same, so that what was learnt in N of them can be compared with
    what was learnt in fewer. No town of "test" is one of "train". How much room they take is logged
    before any is made.

    Parameters
    ----------
    count
        How many.
    split
        "train" or "test".
    text
        What all of them are to be like.
    size
        Metres, width and depth.

    Returns
    -------
    places
        Folders that `cityx.make` takes as `place`; their names differ by seed.

    Raises
    ------
    UsageError
        If there is no such split, or count is not from 1 to 1,000,000.
    """
    if split not in SPLITS:
        raise UsageError(
            f'split is "{split}"; known are {", ".join(SPLITS)}.{nearest(split, SPLITS)}'
        )
    if isinstance(count, bool) or not isinstance(count, int) or not 1 <= count <= SPLITS["test"]:
        raise UsageError(
            f"count is {count!r}; it takes a whole number from 1 to {SPLITS['test']:,}."
        )
    first = SPLITS[split]
    folders = [_folder_of(None, text, first + number, size) for number in range(count)]
    missing = sum(not (folder / "report.json").is_file() for folder in folders)
    if missing:
        share = float(np.prod(size)) / float(np.prod(TOWN_SIZE))
        _log.warning("%d towns are made in %s, which take some %.0f MB.", missing,
                     kept_folder("places"), missing * TOWN_MB * share)  # fmt: skip
    return tuple(_built(None, text, first + number, size).parent for number in range(count))


def _compiled_walks(city: City, world: World) -> Walks:
    from cityx.sim.compile.walks import compile_walks

    walks = compile_walks(city, world)
    _keep(walks, kept_walks_path(world.hash, city.name))
    return walks


def _found(place: Any, text: str, seed: int, size: Any, at: str) -> Path | City:
    """Return the store of a place, built where it must be, or the city itself."""
    own = getattr(place, "city", place)
    if hasattr(own, "layout") and hasattr(own, "lanes"):
        city: City = own
        return city
    if place is not None and not isinstance(place, (str, Path)):
        raise UsageError(
            f"place is {type(place).__name__}; it takes a folder, a map file, a City or a Project."
        )
    if place is not None and (Path(place) / TILES).is_file():
        return _region(Path(place), text, size, at)
    if at:
        raise UsageError(f"at says where in a folder of tiles; {place or 'a town'} is none.")
    store = None if place is None else _store_in(Path(place))
    if store is None:
        return _built(None if place is None else _map_file(Path(place)), text, seed, size)
    if text:
        raise UsageError("text describes what is to be built; the city in the folder is built.")
    return store


def _region(tiles: Path, text: str, size: Any, at: str) -> Path:
    """Return the store of the tiles about a place as one city."""
    if text:
        raise UsageError("text describes what is to be built; cityx tiles edit changes tiles.")
    if not at:
        raise UsageError(
            f"{tiles} holds tiles; at says about which place they are to be joined, such as "
            '"47.141,9.5215" or "1200,-300" (metres).'
        )
    shape = [float(side) for side in size or TILES_SIZE]
    answer = in_process({"tiles": str(tiles.resolve()), "at": at, "size": shape}, JOINER)
    return Path(answer["folder"]) / STORE


def _store_in(path: Path) -> Path | None:
    """Return the store of a built city, None for a file."""
    if path.is_file():
        return None
    for folder in (path / STORE, path):
        if (folder / "city.json").is_file():
            return folder
    if path.is_dir():
        raise InputError(f"{path} holds no built city. Build one first: cityx build MAP -o {path}")
    near = path.parent if path.parent.is_dir() else Path()
    raise InputError(
        f"There is no place {path}.{nearest(path.name, [each.name for each in near.iterdir()])} "
        "A place is the folder of a built city or a map file."
    )


def _map_file(path: Path) -> Path:
    return path.resolve()


def _world_of_store(store: Path) -> World:
    from cityx.city.content import HASHES, read_hash

    known = read_hash(store / HASHES)
    name = json.loads((store / "city.json").read_text())["name"]
    world = None if known is None else kept_world(known.total, name)
    if world is not None:
        return world
    made = in_process({"compile": str(store.resolve())})
    world = kept_world(made["hash"], name)
    if world is None:  # without a cache it is compiled here
        from cityx.city.store import read_city
        from cityx.sim.compile.worlds import compile_world

        return compile_world(read_city(store))
    return world


def _world_of_city(city: City) -> World:
    from cityx.city.content import content_hash
    from cityx.sim.compile.worlds import compile_world

    found = content_hash(city).total
    world = kept_world(found, city.name)
    if world is None:
        world = compile_world(city, found)
        keep(world)
    return world


def keep(world: World) -> None:
    """Put a world into the cache, if there is one."""
    _keep(world, kept_path(world.hash, world.facts["name"]))


def _keep(value: World | Walks | Scenery, path: Path | None) -> None:
    if path is not None:
        try:
            write_kept(value, path)
        except OSError:
            return  # a cache that cannot be written is passed over


def _folder_of(source: Path | None, text: str, seed: int, size: Any) -> Path:
    """Return the folder that a city of a map or a sentence has in the cache."""
    from cityx.version import __version__

    key = blake2b(digest_size=12)
    content = b"" if source is None else source.read_bytes()
    shape = list(size or TOWN_SIZE) if source is None else None
    for part in (content, text.encode(), repr((seed, shape, LOD, __version__)).encode()):
        key.update(len(part).to_bytes(8, "little") + part)
    return kept_folder("places") / key.hexdigest()


def _built(source: Path | None, text: str, seed: int, size: Any) -> Path:
    """Return the store of a city of a map or a sentence, built where an earlier run has not."""
    folder = _folder_of(source, text, seed, size)
    if not (folder / "report.json").is_file():
        shape = list(size or TOWN_SIZE) if source is None else None
        in_process({
            "build": str(folder), "source": str(source or ""), "text": text, "seed": seed,
            "size": shape,
        })  # fmt: skip
    return folder / STORE


def in_process(order: dict[str, Any], maker: str = "cityx.sim.places") -> dict[str, Any]:
    """Build, join or compile in a process of its own, so that nothing heavy is imported here.

    It ends with this one, even if that is killed: whoever asks again finds no lock held.

    Parameters
    ----------
    order
        What the maker is to do.
    maker
        Module that does it by `answer_order`.

    Raises
    ------
    InputError, UsageError, EngineError
        As the maker said.
    """
    done = subprocess.run(
        [sys.executable, "-m", maker, json.dumps(order), str(os.getpid())], capture_output=True,
        text=True, check=False,
    )  # fmt: skip
    last = (done.stdout.strip().splitlines() or [""])[-1]
    try:
        answer: dict[str, Any] = json.loads(last)
    except ValueError:
        words = (done.stderr.strip().splitlines() or ["nothing"])[-1]
        raise EngineError(f"The place could not be made; the maker's last words: {words}") from None
    if answer["state"] == _REFUSED:
        kinds: dict[str, type[CityxError]] = {"UsageError": UsageError, "InputError": InputError}
        raise kinds.get(answer["kind"], EngineError)(answer["message"])
    return answer


def _made(order: dict[str, Any]) -> dict[str, Any]:
    """Do what `in_process` asks for."""
    if "build" in order:
        from cityx.options import BuildOptions
        from cityx.projects.build import build
        from cityx.projects.locks import locked

        size = order["size"]
        options = BuildOptions(
            text=order["text"], seed=order["seed"], lod=LOD, formats=(), render=False,
            size=None if size is None else (float(size[0]), float(size[1])),
        )  # fmt: skip
        folder = Path(order["build"])
        beside = folder.with_name(f"{folder.name}.lock")
        beside.mkdir(parents=True, exist_ok=True)
        with locked(beside, LONGEST_BUILD):  # another process may ask for the same place
            if not (folder / "report.json").is_file():
                build([Path(order["source"])] if order["source"] else [], folder, options)
        return {}
    from cityx.city.store import read_city
    from cityx.sim.compile.worlds import compile_world

    if "walks" in order:
        city = read_city(Path(order["walks"]))
        _compiled_walks(city, _world_of_city(city))
        return {}
    if "scenery" in order:
        compiled_scenery(read_city(Path(order["scenery"])), order["hash"])
        return {}
    world = compile_world(read_city(Path(order["compile"])))
    keep(world)
    return {"hash": world.hash}


def answer_order(make: Callable[[dict[str, Any]], dict[str, Any]]) -> None:
    """Do what the first argument of this process asks for, and print the answer as its last line.

    The second is the number of the process that asks.

    Parameters
    ----------
    make
        Does an order; what it raises for its user is told to who asked.
    """
    end_with_parent(int(sys.argv[2]))
    try:
        answer = {"state": _DONE, **make(json.loads(sys.argv[1]))}
    except CityxError as error:
        answer = {"state": _REFUSED, "kind": type(error).__name__, "message": str(error)}
    sys.stdout.write("\n" + json.dumps(answer) + "\n")


if __name__ == "__main__":
    answer_order(_made)
