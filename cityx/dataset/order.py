"""The order: all that decides the bytes of a dataset, and what is wrong with it."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import asdict, dataclass, replace
from functools import partial
from importlib.util import find_spec
from math import radians
from pathlib import Path
from typing import Any

from cityx.dataset.channels import CYCLES, Channel, chosen
from cityx.dataset.writers import formats_named, libraries_of
from cityx.errors import CityxError, InputError, MissingExtra, UsageError, nearest
from cityx.options import LARGEST_SEED, Numbers, Words, option, place_profile_option
from cityx.system.digests import file_sha256

NAME = "dataset.json"
SEED, FOLDER, MAP, TILE = "seed", "folder", "map", "tile"
_FIRST = frozenset({"there", "no", "this", "about"})
MOST_CITIES = 100_000
_SEEDS = re.compile(r"\d+(-\d+)?(,\d+(-\d+)?)*")
_PLAIN = re.compile(r"[^\w-]+")
# Bytes of a pixel when compressed, of views of streets at 640x480; noise of pictures is the most.
_BYTES: Mapping[str, float] = {
    "depth": 2.6, "distance": 2.6, "normal": 1.0, "position": 8.5, "semantic": 0.05,
    "instance": 0.4, "panoptic": 0.1, "material": 0.1, "flow": 6.0, "motion": 3.0,
}  # fmt: skip
_BYTES_CYCLES = 8.0
SIZE = Numbers("x", "1920x1080", 16, 16384, whole=True)
TOWN_SIZE = Numbers("x", "400x400", 50, 20000, whole=True)
WORDS = Words("none")
_BYTES_PNG = 2.0


@dataclass(frozen=True)
class Source:
    """Where a city of a dataset comes from.

    Attributes
    ----------
    name
        Of the city in the dataset, fit for a file.
    kind
        ``FOLDER``: built already; ``MAP``: a file to build from; ``SEED``: a town by rule;
        ``TILE``: a tile with those about it (`cityx.tiles.stops`).
    path
        The folder or the file.
    seed
        Of a town.
    tile, hash
        Of a tile its name, and a hash of what it and those about it are built from.
    """

    name: str
    kind: str
    path: Path | None = None
    seed: int = 0
    tile: str = ""
    hash: str = ""


@dataclass(frozen=True)
class Order:
    """What is asked for.

    Attributes
    ----------
    views
        Moments of each city, of which every camera of the rig takes a shot; None for all that a
        file of shots holds.
    plan, rig
        Names, or JSON files.
    size
        Of the pictures, pixels.
    channels, formats
        Their names, in the order of their tables.
    quality, samples
        Of the path tracer: "draft", "standard" or "paper"; samples per pixel instead of its own.
    lidar
        Pattern of a LiDAR, or "".
    boxes
        Whether boxes are kept, also where no format needs them.
    weather, time
        Words that vary from sequence to sequence; empty keeps the city's own light.
    seed
        Of the plan.
    length, rate
        Frames of a sequence, those of the plan when None, and how many are a second.
    hfov
        Horizontal field of view, radians; that of the plan when None.
    target
        What orbits go round.
    town, town_size, lod
        Words, width and depth in metres and level of detail of towns that are built.
    place_profile
        Profile of the place of cities that are built, as of `cityx.options.BuildOptions`.
    """

    views: int | None = 100
    plan: str = option("street", "street, drive, aerial, orbit, walk or FILE.json.")
    rig: str = option("mono", "mono, stereo, surround or FILE.json.")
    size: tuple[int, int] = (960, 540)
    channels: tuple[str, ...] = option(
        ("rgb", "depth", "normal", "semantic", "instance"),
        "Comma-separated names, or truth, paper, all; none for no pictures.", spelling=WORDS,
    )  # fmt: skip
    formats: tuple[str, ...] = option(
        ("raw",), "raw, coco, kitti, nuscenes, nerf, colmap, webdataset.", "--format",
        spelling=WORDS,
    )  # fmt: skip
    quality: str = option("standard", "draft, standard or paper.")
    samples: int | None = option(None, "Samples per pixel, at most.", low=1, high=65536)
    lidar: str = option("", "Pattern of a LiDAR on the rig.")
    boxes: bool = option(False, "Keep 2D and 3D boxes.", "--boxes")
    weather: tuple[str, ...] = option(
        (), "Words that vary by sequence: clear,rain.", spelling=WORDS
    )
    time: tuple[str, ...] = option((), "Times that vary by sequence: 08:00,dusk.", spelling=WORDS)
    length: int | None = option(None, "Frames of a sequence.", low=1)
    rate: float = option(10.0, "Frames a second of sequences.")
    hfov: float | None = None
    target: str = option("tallest", "What orbits go round: tallest, middle, a name or an id.")
    seed: int = option(0, "Key of the plan.", low=0, high=LARGEST_SEED)
    town: str = option("", "Words for towns of --cities SEEDS.")
    town_size: tuple[float, float] = option(
        (400.0, 400.0), "WxH of these towns, metres.", spelling=TOWN_SIZE
    )
    lod: int = option(2, "Level of detail of built ones.", low=0, high=3)
    place_profile: str = place_profile_option()

    @property
    def wanted(self) -> tuple[Channel, ...]:
        """The channels that are made: those asked for, and those that formats cannot do without."""
        formats = formats_named(self.formats)
        names = {*self.channels, *(name for item in formats for name in item.channels)}
        return chosen(names) if names else ()

    @property
    def wants_boxes(self) -> bool:
        """Whether boxes are made."""
        return self.boxes or any(item.boxes for item in formats_named(self.formats))

    def completed(
        self, views: int | None, size: tuple[int, int] | None, fov: float | None
    ) -> Order:
        """Return the order with what is usual where nothing is said.

        Parameters
        ----------
        views
            As of the order; when None 100, or all of a file of shots.
        size
            As of the order; that of the quality when None.
        fov
            Horizontal field of view, degrees.
        """
        from cityx.dataset.pictures import QUALITIES

        usual = QUALITIES[self.quality if self.quality in QUALITIES else "standard"].size
        width, height = (round(value) for value in size or usual)
        if views is None and not Path(self.plan).is_file():
            views = Order.views
        hfov = None if fov is None else radians(fov)
        return replace(self, views=views, size=(width, height), hfov=hfov)

    def made_by(self, maker: str) -> tuple[str, ...]:
        """Return the names of the channels that a maker makes."""
        return tuple(channel.name for channel in self.wanted if channel.maker == maker)

    def bytes_of_a_shot(self) -> int:
        """Estimate the bytes of the files of one shot."""
        pixels = self.size[0] * self.size[1]
        arrays = sum(_BYTES.get(c.name, _BYTES_CYCLES) for c in self.wanted if c.name != "rgb")
        pictures = _BYTES_PNG if "rgb" in self.channels else 0.0
        linear = _BYTES_CYCLES if "rgb" in self.channels else 0.0
        raw = sum(np_bytes(c) for c in self.wanted if c.name != "rgb")
        of_format = {"raw": arrays + linear + pictures, "webdataset": raw + pictures,
                     "coco": pictures + 0.3}  # fmt: skip
        return int(pixels * sum(of_format.get(name, pictures) for name in self.formats)) + 4096


def np_bytes(channel: Channel) -> int:
    """Return the bytes of a pixel of a channel as it is in memory."""
    return (
        channel.depth
        * {"float32": 4, "uint8": 1, "uint16": 2, "uint32": 4, "uint64": 8}[channel.dtype]
    )


class Faults:
    """Gathers what is wrong, and raises once; a class because the list grows."""

    def __init__(self) -> None:
        self.found: list[CityxError] = []

    def of(self, check: Callable[[], Any]) -> Any:
        """Call a check; what it raises is kept, and None returned."""
        try:
            return check()
        except CityxError as error:
            if error.exit_code != UsageError.exit_code:
                raise
            self.found.append(error)
            return None

    def say(self, text: str) -> None:
        """Keep a fault of what is asked for."""
        self.found.append(UsageError(text))

    def end(self) -> None:
        """Raise all that was found, if anything was.

        Raises
        ------
        UsageError, InputError, MissingExtra
        """
        if len(self.found) == 1:
            raise self.found[0]
        if self.found:
            told = dict.fromkeys(_sentence(str(error)) for error in self.found)
            raise UsageError(" ".join(told))


def _sentence(text: str) -> str:
    # A path that a sentence begins with stays as it is.
    return text[:1].upper() + text[1:] if text.split(" ", 1)[0] in _FIRST else text


def check_words(order: Order, faults: Faults) -> None:
    """Gather what is wrong with the words of an order, without looking at any city."""
    formats = faults.of(lambda: formats_named(order.formats)) or ()
    channels = faults.of(lambda: chosen(order.channels)) if order.channels else ()
    if not order.formats:
        faults.say("no format is asked for.")
    if not order.channels and not order.lidar and not order.boxes:
        faults.say("no channel is asked for: give --channels, --lidar or --boxes.")
    shown = [item.name for item in formats if item.shows]
    if channels is not None and shown and "rgb" not in order.channels:
        faults.say(f"{', '.join(shown)} is made of pictures: add rgb to --channels.")
    if order.views is not None and order.views < 1:
        faults.say(f"--views {order.views} is no number of shots, 1 or more is needed.")
    from cityx.city.environment import Environment
    from cityx.dataset.pictures import chosen_quality
    from cityx.dataset.plans.planning import KINDS
    from cityx.light.weather import lit_anew
    from cityx.projects.place_words import check_place

    if order.plan not in KINDS and not Path(order.plan).is_file():
        faults.say(f'there is no plan "{order.plan}": it is neither a file nor one of '
                   f"{', '.join(KINDS)}.{nearest(order.plan, KINDS)}")  # fmt: skip
    if order.length is not None and order.length < 1:
        faults.say(f"--length {order.length} is no number of frames, 1 or more is needed.")
    if order.rate <= 0:
        faults.say(f"--rate {order.rate:g} is no number of frames a second.")
    if order.lidar:
        from cityx.dataset.lidar import lidar_named

        faults.of(lambda: lidar_named(order.lidar))
    faults.of(lambda: chosen_quality(order.quality, samples=order.samples))
    if order.place_profile:
        faults.of(lambda: check_place(order.place_profile))
    for weather in order.weather or ("",):
        for time in order.time or ("",):
            faults.of(partial(lit_anew, Environment(), 0.0, 0.0, weather=weather, time=time))
    _check_libraries(order, channels or (), faults)


def _check_libraries(order: Order, channels: Iterable[Channel], faults: Faults) -> None:
    needed = set(libraries_of(order.formats))
    if any(channel.maker == CYCLES for channel in channels):
        needed |= {"OpenEXR"}
    missing = sorted(name for name in needed if find_spec(name) is None)
    if missing:
        error = MissingExtra(
            f'this dataset needs {", ".join(missing)}: pip install "cityx[dataset]"'
        )
        faults.found.append(error)


def sources_of(folders: Iterable[Path], cities: str, faults: Faults) -> tuple[Source, ...]:
    """Return the cities that folders and the word of ``--cities`` name.

    Parameters
    ----------
    folders
        Of built cities.
    cities
        Seeds such as ``1-20,35``; a text file with a folder or a map per line; or folders and maps
        with commas between; "" for none.
    faults
        Where what cannot be found is gathered.
    """
    found: list[Source] = []
    if _SEEDS.fullmatch(cities):
        for span in cities.split(","):
            first, _, last = span.partition("-")
            if int(last or first) - int(first) > MOST_CITIES or int(last or first) < int(first):
                faults.say(f"--cities {span} is no span of up to {MOST_CITIES} seeds.")
                continue
            found += [Source(f"town_{seed:06d}", SEED, seed=seed)
                      for seed in range(int(first), int(last or first) + 1)]  # fmt: skip
        words: list[str] = []
    elif cities and Path(cities).is_file() and Path(cities).suffix in (".txt", ".list", ""):
        lines = Path(cities).read_text(encoding="utf-8").splitlines()
        words = [line.strip() for line in lines if line.strip() and not line.startswith("#")]
        if not words:
            faults.say(f"{cities} lists no city.")
    else:
        words = [word for word in cities.split(",") if word]
    found += [_at(Path(word), faults) for word in [*map(str, folders), *words]]
    if not found:
        faults.say("no city is given: name folders of built cities, or give --cities or --tiles.")
    return _named_apart(found)


def _at(path: Path, faults: Faults) -> Source:
    name = _PLAIN.sub("_", path.name.split(".")[0] or path.resolve().name).strip("_") or "city"
    if path.is_file():
        return Source(name, MAP, path)
    if not path.exists():
        near = path.parent if path.parent.is_dir() else Path()
        names = [entry.name for entry in near.iterdir()] if near.is_dir() else []
        faults.say(f"{path} does not exist.{nearest(path.name, names)}")
    elif not (path / "city" / "city.json").is_file():
        faults.say(f"{path} holds no city: {path / 'city' / 'city.json'} is missing.")
    return Source(name, FOLDER, path)


def _named_apart(sources: list[Source]) -> tuple[Source, ...]:
    """Give a number to cities of the same name."""
    counts: dict[str, int] = {}
    found = []
    for source in sources:
        counts[source.name] = count = counts.get(source.name, 0) + 1
        name = source.name if count == 1 else f"{source.name}_{count}"
        found.append(Source(name, source.kind, source.path, source.seed))
    return tuple(found)


def identity_of(order: Order, sources: Iterable[Source]) -> dict[str, Any]:
    """Return all that decides the bytes of a dataset, as JSON; where files lie does not count."""
    from cityx.version import __version__

    named = asdict(order)
    if not order.place_profile:  # as in datasets from before there was the word
        del named["place_profile"]
    for key, suffix in (("plan", ".json"), ("rig", ".json"), ("place_profile", ".toml")):
        path = Path(str(named.get(key, "")))
        if path.suffix == suffix and path.is_file():
            named[key] = {"file": path.name, "sha256": file_sha256(path)}
    cities = [{"name": s.name, "kind": s.kind, **_origin(s)} for s in sources]
    text = json.dumps({"cityx": __version__, "order": named, "cities": cities})
    found: dict[str, Any] = json.loads(text)
    return found


def _origin(source: Source) -> dict[str, Any]:
    if source.kind == SEED or source.path is None:
        return {"seed": source.seed}
    if source.kind == TILE:
        return {"tile": source.tile, "hash": source.hash}
    if source.kind == MAP:
        return {"sha256": file_sha256(source.path)}
    report = source.path / "report.json"
    if not report.is_file():
        raise InputError(f"{source.path} is no folder of a built city: report.json is missing.")
    return {"hash": json.loads(report.read_text())["hash"]}


def differences(there: Mapping[str, Any], asked: Mapping[str, Any], at: str = "") -> list[str]:
    """Return in what two identities differ, such as ``order.views is 100, 200 is asked for``."""
    found = []
    for key in sorted({*there, *asked}):
        left, right = there.get(key), asked.get(key)
        if isinstance(left, Mapping) and isinstance(right, Mapping):
            found += differences(left, right, f"{at}{key}.")
        elif left != right:
            found.append(f"{at}{key} is {_short(left)}, {_short(right)} is asked for")
    return found


def _short(value: Any) -> str:
    text = json.dumps(value)
    return text if len(text) <= 80 else f"{text[:77]}..."
