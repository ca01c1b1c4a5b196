"""Tiles of the plane of towns: their source is a rule, not a map, and there is no last one.

The plane is cut into sheets of `SHEET` metres. All tiles of a sheet share a frame whose origin is
the middle of the sheet, so that numbers stay small however far out a tile lies; a place of the
plane is a whole number of metres, the origin of the sheet, and a place of the frame.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, fields, replace
from types import MappingProxyType
from typing import Any

import numpy as np

from cityx.agents.planning.workflow import Item
from cityx.city import City
from cityx.city.frame import NOWHERE
from cityx.city.layout import SCHEMA
from cityx.errors import InputError, UsageError
from cityx.ids import UInt64Array, hash_bits, hash_ids
from cityx.options import BuildOptions
from cityx.places.profiles import place_text
from cityx.projects.build import make_job
from cityx.projects.place_words import check_place
from cityx.tiles.actions import SKIPPED, built, plan_of
from cityx.tiles.grid import Box, Tile, tiles_of
from cityx.tiles.order import SIZE, Order, check_size, code_of
from cityx.town.plane import COASTS, Plan, StreetBounds
from cityx.town.presets import TOWN
from cityx.town.town import street_bounds
from cityx.town.window import layout_of_window

# Metres; a multiple of every grid that tiles are built on, so that grids go on in the next sheet.
SHEET = 1_536_000
# Metres; a park or a stretch of street of a plane is seldom longer than what is built round a tile.
MARGIN = 350.0
FARTHEST = 10**8  # index of a tile; its places are whole millimetres in 64 bits
# What the plane is where words do not say otherwise: towns with country between them, by a river.
USUAL: Mapping[str, Any] = {"density": 0.85, "radius": 1500.0, "river": True, "lakes": 0.03}
# Actions on a layout that look at one building at a time, so that tiles need no others.
LOCAL = ("layout/building_limits-v1",)
RIVER, COAST = "layout/river-v1", "layout/coast-v1"  # the plane has its own
_BOUNDS = ("main", "local")


@dataclass(frozen=True)
class Asked:
    """What words ask of the plane.

    Attributes
    ----------
    plan
        Of its towns.
    style
        Of buildings, "" for those of the place.
    seed
        Of the plane.
    amended
        Actions on the layout of a tile.
    items
        Those after it.
    left_out
        What was asked for and is of a whole site, a sentence each.
    """

    plan: Plan
    style: str
    seed: int
    amended: tuple[Item, ...]
    items: tuple[Item, ...]
    left_out: tuple[str, ...]


def asked_of(text: str = "", style: str = "", *, seed: int = 0, lod: int = 2) -> Asked:
    """Return what words ask of the plane.

    Raises
    ------
    UsageError
        If they ask for what no plane can have, such as blocks of a number.
    """
    job = make_job([], BuildOptions(lod=lod, seed=seed, text=text, style=style))
    try:
        items, style = job.first_plan(), job.request.style
    finally:
        job.roles.close()
    usual = {item.action for item in plan_of([], lod, seed)}
    args, left = dict(USUAL), []
    amended: list[Item] = []
    kept: list[Item] = []
    for item in items:
        if item.action == TOWN:
            args |= item.args
        elif item.action == RIVER:
            args["river"] = True
        elif item.action == COAST and item.args.get("side", COASTS[-1]) in COASTS:
            args["coast"] = item.args.get("side", "south")
        elif item.action in usual or item.action in LOCAL:
            plain = Item.from_json(item.to_json())  # so that workers can be sent it
            (amended if item.action in LOCAL else kept).append(plain)
        elif item.args or not item.action.startswith(SKIPPED):
            told = ", ".join(f"{name}={value}" for name, value in item.args.items())
            left.append(f"{item.action}{f' ({told})' if told else ''} is of a whole site")
    variant = args.pop("variant", 0)
    return Asked(
        plan_from(args), style, hash_bits(seed, "town", variant) >> 1 if variant else seed,
        tuple(amended), tuple(kept), tuple(left),
    )  # fmt: skip


def plan_from(args: Mapping[str, Any]) -> Plan:
    """Return the plan of arguments of `layout/town-v1`.

    Raises
    ------
    UsageError
        If they ask for blocks of a number, a size or a direction, which a site alone has.
    """
    named = {each.name: each.default for each in fields(Plan) if each.name not in _BOUNDS}
    plan = Plan(**{name: args.get(name, usual) for name, usual in named.items()})
    if plan.asks_for_blocks:
        raise UsageError(
            "The plane has no end, so its blocks have no number, size or direction; say how dense "
            "it is, or build a town of its own."
        )
    return replace(plan, main=_bounds(args, "main"), local=_bounds(args, "local"))


def _bounds(args: Mapping[str, Any], of: str) -> StreetBounds:
    usual = StreetBounds()
    width = args.get(f"{of}_least", usual.least), args.get(f"{of}_most", usual.most)
    lanes = [args.get(f"{of}_{end}_lanes", getattr(usual, f"{end}_lanes"))
             for end in ("least", "most")]  # fmt: skip
    return street_bounds(of, width, (lanes[0], lanes[1]))


def plane_order(
    text: str = "", style: str = "", *, seed: int = 0, lod: int = 2, size: float = SIZE,
    margin: float = MARGIN, place: str = "",
) -> Order:  # fmt: skip
    """Return what all tiles of a plane have in common.

    Raises
    ------
    UsageError, InputError
        With every fault of what is asked for.
    """
    check_size(size, margin)
    if place:
        check_place(place)
    asked = asked_of(text, style, seed=seed, lod=lod)
    coarse = asked_of(text, style, seed=seed, lod=0)
    frame = replace(NOWHERE, place=place_text(place) if place else "")
    plane = {"text": text, "style": asked.style, "plan": asdict(asked.plan),
             "amended": [item.to_json() for item in asked.amended],
             "left_out": list(asked.left_out)}  # fmt: skip
    return Order(
        "plane", frame, (0.0, 0.0, 0.0, 0.0), asked.seed, lod, float(size), float(margin), (),
        asked.items, coarse.items, code_of(), plane,
    )  # fmt: skip


def plan_in(order: Order) -> Plan:
    """Return the plan of the towns of a plane."""
    told = dict((order.plane or {})["plan"])
    return Plan(**told | {of: StreetBounds(**told[of]) for of in _BOUNDS})


def origin_of(order: Order, tile: Tile) -> tuple[int, int]:
    """Return where the frame of a tile has its origin, whole metres of the plane or of the map."""
    if order.plane is None:
        return 0, 0
    x, y = (SHEET * round((index + 0.5) * order.size / SHEET) for index in (tile.column, tile.row))
    return x, y


def box_in_frame(order: Order, tile: Tile, margin: float = 0.0) -> Box:
    """Return (xmin, ymin, xmax, ymax) of a tile in metres of its frame, with a margin round it."""
    return box_in_frame_of(order, tile, origin_of(order, tile), margin)


def box_in_frame_of(order: Order, tile: Tile, origin: tuple[int, int], margin: float = 0.0) -> Box:
    """Return (xmin, ymin, xmax, ymax) of a tile in metres of the frame with an origin."""
    x, y = origin
    west, south, east, north = tile.box(order.size, margin)
    return west - x, south - y, east - x, north - y


def plane_land(order: Order, tile: Tile) -> City:
    """Return the layout of the plane about a tile, in the frame of the tile."""
    window = tile.box(order.size, order.margin)
    return plane_city(order, window, origin_of(order, tile), f"{order.name} {tile.name}")


def plane_city(order: Order, window: Box, origin: tuple[int, int], name: str) -> City:
    """Return the layout of a window of the plane, in the frame of a sheet.

    Parameters
    ----------
    window
        Metres of the plane.
    origin
        Of the sheet, as of `origin_of`.
    name
        Of the city.
    """
    layout = layout_of_window(window, plan_in(order), order.seed, frame=order.frame, origin=origin)
    asked = order.plane or {}
    city = City(
        name, order.frame, layout, seed=order.seed, style=asked["style"],
        stages_done=frozenset({"layout"}),
    )  # fmt: skip
    if not len(layout.buildings):
        return city
    return built(city, map(Item.from_json, asked["amended"]))


def named_in_plane(
    city: City, land: City, origin: tuple[int, int], *, named_before: UInt64Array | None = None
) -> City:
    """Return what a tile owns with ids that no other sheet has.

    What a layout of the plane names, and its network, has ids of its own wherever it lies. Other
    ids, such as those of trees, are of places of the frame: they get the sheet in.

    Parameters
    ----------
    city
        What the tile owns.
    land
        The layout that it was built from.
    origin
        Of the frame.
    named_before
        (n,) ids that have it in already.
    """
    if origin == (0, 0):
        return city
    network = city.network
    known = [getattr(land.layout, name)["id"].to_numpy(np.uint64) for name in SCHEMA]
    known += [getattr(city.layout, name)["id"].to_numpy(np.uint64) for name in SCHEMA
              if name != "points"]  # fmt: skip
    known.append(network.edge_id if network is not None else np.zeros(0, np.uint64))
    if named_before is not None:
        known.append(named_before)
    global_ids = np.unique(np.concatenate(known))
    sheet = hash_bits(hash_bits(0, "sheet", origin[0]), "sheet", origin[1])

    def named(ids: UInt64Array) -> UInt64Array:
        fresh = np.maximum(hash_ids(sheet, "sheet", ids), np.uint64(1))
        return np.where((ids == 0) | np.isin(ids, global_ids), ids, fresh)

    points = city.layout.points
    points = points.assign(id=named(points["id"].to_numpy(np.uint64)))
    scene = city.scene
    return replace(
        city,
        layout=replace(city.layout, points=points),
        scene=replace(
            scene,
            meshes=MappingProxyType({
                name: replace(batch, object_id=named(batch.object_id))
                for name, batch in scene.meshes.items()
            }),
            instances=MappingProxyType({
                name: replace(rows, object_id=named(rows.object_id), owner=named(rows.owner))
                for name, rows in scene.instances.items()
            }),
        ),
    )  # fmt: skip


def tiles_in(order: Order, area: Box | None) -> list[Tile]:
    """Return the tiles of the plane that reach into an area.

    Raises
    ------
    UsageError
        Without an area: the plane has no end.
    InputError
        If a tile lies farther out than places can be told apart.
    """
    if area is None:
        raise UsageError("The plane has no end; --at and --area say which part of it is built.")
    far = max(map(abs, area)) / order.size
    if far > FARTHEST:
        raise InputError(
            f"The area reaches to tile {far:.0f} of the plane; it is laid out to {FARTHEST:,}, "
            f"{FARTHEST * order.size:,.0f} m from its origin."
        )
    return list(tiles_of(area, order.size))


def spread_over(tiles: Sequence[Tile], most: int) -> list[Tile]:
    """Return some tiles, no more than `most`, evenly along their order."""
    rows = np.unique(np.linspace(0, len(tiles) - 1, min(most, len(tiles))).round().astype(int))
    return [tiles[row] for row in rows.tolist()]


def buildings_about(order: Order, tile: Tile, tiles: Iterable[Tile]) -> Any:
    """Return the table of buildings of a window that holds several tiles, in the frame of one."""
    boxes = np.array([each.box(order.size, order.margin) for each in tiles])
    low, high = boxes[:, :2].min(axis=0).tolist(), boxes[:, 2:].max(axis=0).tolist()
    return layout_of_window(
        (low[0], low[1], high[0], high[1]), plan_in(order), order.seed, frame=order.frame,
        origin=origin_of(order, tile),
    ).buildings  # fmt: skip
