"""The cities of a dataset: built if needed, planned, and described in files of their own."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cityx.city.camera import Camera
from cityx.city.environment import Environment
from cityx.dataset.order import FOLDER, SEED, Order, Source
from cityx.dataset.shots import Shot
from cityx.dataset.writers import formats_named
from cityx.dataset.writers.files import Files
from cityx.dataset.writers.raw import describe_shot
from cityx.errors import CityxError, InputError

if TYPE_CHECKING:
    from cityx.city.city import City
    from cityx.city.store import View
    from cityx.dataset.stage import Stage

Say = Callable[[str], None]
SHOTS = "shots.jsonl"


@dataclass(frozen=True)
class Site:
    """A city that shots are planned in.

    Attributes
    ----------
    source
        Where it comes from.
    city
        What it is.
    stage
        Its scene, ready for rays.
    """

    source: Source
    city: City
    stage: Stage


# Plans the shots of a city.
Planner = Callable[[Site, Order], tuple[Shot, ...]]


def open_site(source: Source, store: Path) -> Site:
    """Read a stored city for planning."""
    from cityx.city.store import read_city, view_of
    from cityx.dataset.stage import stage_of

    city = read_city(store)
    stage = stage_of(view_of(city))
    return Site(source, city, stage.still or stage)


def plan_shots(
    site: Site, order: Order, *, within: tuple[float, float, float, float] | None = None,
    origin: tuple[float, float] = (0.0, 0.0),
) -> tuple[Shot, ...]:  # fmt: skip
    """Plan the shots of a city, and refuse what it cannot give before any is taken.

    Parameters
    ----------
    site
        The city.
    order
        What is asked for.
    within, origin
        As of `cityx.dataset.plans.planning.plan`.

    Raises
    ------
    InputError, UsageError
        If the city has no place for such shots; nothing was written.
    """
    from cityx.dataset.plans.planning import plan

    return plan(
        site.city, order.plan, order.views, order.size, seed=order.seed, rig=order.rig,
        length=order.length, rate=order.rate, hfov=order.hfov, weathers=order.weather,
        times=order.time, target=order.target, stage=site.stage,
        within=within, origin=origin,
    ).shots  # fmt: skip


def store_of(source: Source, work: Path) -> Path:
    """Return the folder of a city's store, there or to be built."""
    folder = source.path if source.kind == FOLDER and source.path else work / "cities" / source.name
    return folder.resolve() / "city"


def build_source(source: Source, order: Order, work: Path, say: Say) -> None:
    """Build a city from a map or a seed, unless it is there.

    Raises
    ------
    InputError
        If it cannot be built; the dataset holds what was made of the cities before.
    """
    from cityx.options import BuildOptions
    from cityx.projects.build import build

    folder = work / "cities" / source.name
    if source.kind == FOLDER or (folder / "report.json").is_file():
        return
    town = source.kind == SEED
    options = BuildOptions(
        seed=source.seed, lod=order.lod, text=order.town if town else "",
        size=order.town_size if town else None, place_profile=order.place_profile, formats=(),
        render=False,
    )  # fmt: skip
    try:
        paths = [] if source.path is None else [source.path]
        build(paths, folder, options, say=lambda line: say(f"{source.name}: {line}"))
    except CityxError as error:
        raise InputError(f"the city {source.name} cannot be built: {error}") from error


def write_city_files(site: Site, shots: Sequence[Shot], order: Order, files: Files) -> None:
    """Write the files of a dataset's city: itself, its objects, its shots, and what formats need.

    Parameters
    ----------
    site
        The city.
    shots
        In their order.
    order
        What is asked for.
    files
        Takes the files.
    """
    from cityx.dataset.objects import objects_of

    view, name = site.stage.view, site.source.name
    folder = f"cities/{name}"
    files.json(f"{folder}/city.json", {
        "name": name, "city": view.name, "seed": view.seed, "lod": view.lod,
        "extent": view.extent, "frame": asdict(view.frame), "projection": view.frame.projection,
        "attribution": list(view.attribution), "environment": asdict(view.environment),
        "streets": _streets(view),
    })  # fmt: skip
    lines = [json.dumps(record, allow_nan=False) for record in objects_of(site.city, site.stage)]
    files.text(f"{folder}/objects.json", '{"objects": [\n' + ",\n".join(lines) + "\n]}\n")
    files.json(f"{folder}/materials.json", dict(enumerate(site.stage.materials)))
    for item in formats_named(order.formats):
        if item.city is not None:
            item.city(view, name, files)
    files.text(f"{folder}/{SHOTS}", "".join(map(_line, shots)))  # the last: then all are there


def _streets(view: View) -> list[list[float]]:
    """Return the streets as lists of their width and the coordinates along them, decimetres."""
    network = view.network
    edges = network.edge_count if network is not None else 0
    found = []
    for edge in range(edges):
        assert network is not None
        points = network.edge_points(edge).round(1).ravel().tolist()
        found.append([round(2 * float(network.half_width[edge]), 1), *points])
    return found


def _line(shot: Shot) -> str:
    environment = None if shot.environment is None else asdict(shot.environment)
    record = {**describe_shot(shot), "name": shot.camera.name, "environment": environment}
    return json.dumps(record, allow_nan=False) + "\n"


def read_shots(path: Path) -> tuple[Shot, ...]:
    """Read the shots that `write_city_files` wrote."""
    return tuple(_shot(json.loads(line)) for line in path.read_text("utf-8").splitlines())


def _shot(record: Mapping[str, Any]) -> Shot:
    camera = record["camera"]
    light = record["environment"]
    return Shot(
        record["shot"],
        Camera(
            record["name"], tuple(camera["position"]), camera["heading"], camera["pitch"],
            camera["hfov"], camera["width"], camera["height"],
        ),
        record["sequence"], record["frame"], record["sensor"], record["moment"],
        None if light is None else Environment(**light),
    )  # fmt: skip
