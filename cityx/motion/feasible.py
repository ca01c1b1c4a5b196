"""Feasible paths: where people may walk and vehicles drive, and obstacles of a path."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.city import City
from cityx.city.ground import LABEL, ON_ROADWAY, ROADWAY, SURFACES
from cityx.convert.lines import BARRIERS
from cityx.errors import ActionFailed
from cityx.geometry.arrays import FloatArray
from cityx.ground.standing import NOWHERE, stand_on
from cityx.ids import id_text

DECK_REACH = 12.0  # metres from the middle of a way within which a place is on its deck
LIFTED = 0.3  # metres above or below the ground from which a way has a height of its own
STEP = 0.5  # metres between the places where a path is looked at
WIDEST_CROSSING = 20.0  # metres of a carriageway that somebody crosses
MOST_FAULTS = 5  # told one by one
SOLID = tuple(kind for kind in BARRIERS if kind != "tree_row")
# Surfaces nobody walks on. A carriageway is crossed, not walked along.
NOT_WALKED = ("railway", "rail", "void")
DRIVEN = (*ROADWAY, *ON_ROADWAY, "parking", "apron")
NAMES = {"void": "a cutting", "rail": "a railway", "block": "land"}


def ground_height(city: City, xy: FloatArray, roads: tuple[int, ...] = ()) -> FloatArray:
    """Return (n,) heights of what is stood on at (n, 2) places.

    Parameters
    ----------
    city
        The city.
    xy
        (n, 2) float, metres.
    roads
        Rows of ``Layout.roads`` that the places are on: where one of these is on a bridge or in a
        cutting, the height is its own. Without, bridges count over water alone.
    """
    footing = stand_on(city.scene.meshes.get("ground"), xy)
    ground = footing.z
    unknown = np.isnan(ground)
    ground = np.where(unknown, city.terrain.height_at(xy), ground)
    bare = unknown | (footing.label == LABEL["water"])
    looked = np.full(len(xy), True) if roads else bare  # the only places where decks count
    deck, lift = np.full(len(xy), np.nan), np.zeros(len(xy))
    deck[looked], lift[looked] = _deck(city, xy[looked], roads)
    raised = (np.abs(lift) > LIFTED) if roads else False
    return np.where(~np.isnan(deck) & (bare | raised), deck, ground)


def _deck(city: City, xy: FloatArray, roads: tuple[int, ...]) -> tuple[FloatArray, FloatArray]:
    """Return (n,) heights of the carriageways under places and how high they are above ground."""
    height, lift = np.full(len(xy), np.nan), np.zeros(len(xy))
    network = city.network
    if network is None or not network.edge_count:
        return height, lift
    edges = np.arange(network.edge_count)
    if roads:
        edges = np.flatnonzero(np.isin(network.edge_road, roads))
    lines = np.array([shapely.LineString(network.edge_points(edge)) for edge in edges], object)
    spots = shapely.points(xy)
    place, near = shapely.STRtree(lines).query_nearest(
        spots, max_distance=DECK_REACH, all_matches=False
    )
    for at, number in zip(place.tolist(), near.tolist(), strict=True):
        edge = edges[number]
        points = slice(*network.point_start[edge : edge + 2].tolist())
        step = np.hypot(*np.diff(network.points[points], axis=0).T)
        along = np.concatenate([[0.0], np.cumsum(step)])
        here = shapely.line_locate_point(lines[number], spots[at])
        height[at] = np.interp(here, along, network.z[points])
        lift[at] = np.interp(here, along, network.lift[points])
    return height, lift


def check_walk(city: City, line: Any, name: str) -> None:
    """Refuse a path that people cannot walk.

    Raises
    ------
    ActionFailed
        With every place where it cannot be walked, and what would be right.
    """
    faults = [*_outside(city, line), *_through(city, line), *_wet(city, line)]
    xy = _places(line)
    label = stand_on(city.scene.meshes.get("ground"), xy).label
    faults += _runs(xy, np.isin(label, [LABEL[n] for n in NOT_WALKED]), label, 0.0)
    roadway = [LABEL[n] for n in ROADWAY if n != "junction"]
    faults += [
        f"{fault}: people cross it, they walk on its sidewalk"
        for fault in _runs(xy, np.isin(label, roadway), label, WIDEST_CROSSING)
    ]
    _refuse(faults, name, "Right would be a way on sidewalks, paths, plazas or in parks")


def check_drive(city: City, line: Any, name: str) -> None:
    """Refuse a path that vehicles cannot drive.

    Raises
    ------
    ActionFailed
        With every place where it cannot be driven, and what would be right.
    """
    faults = [*_outside(city, line), *_through(city, line), *_wet(city, line)]
    xy = _places(line)
    label = stand_on(city.scene.meshes.get("ground"), xy).label
    off = ~np.isin(label, [LABEL[n] for n in DRIVEN]) & (label != NOWHERE)
    faults += _runs(xy, off, label, 2 * STEP)
    _refuse(faults, name, "Right would be a way on carriageways")


def _places(line: Any) -> FloatArray:
    count = max(2, int(np.ceil(line.length / STEP)) + 1)
    spots = shapely.line_interpolate_point(line, np.linspace(0.0, line.length, count))
    return np.asarray(shapely.get_coordinates(spots))


def _refuse(faults: list[str], name: str, right: str) -> None:
    if not faults:
        return
    more = len(faults) - MOST_FAULTS
    told = ". ".join(faults[:MOST_FAULTS]) + (f". And {more} more" if more > 0 else "")
    raise ActionFailed(f'The path "{name}" cannot be followed. {told}. {right}.')


def _outside(city: City, line: Any) -> list[str]:
    site = shapely.box(*city.layout.extent)
    if shapely.covers(shapely.buffer(site, STEP), line):
        return []
    x, y = shapely.get_coordinates(shapely.difference(line, site))[-1]
    west, south, east, north = (f"{value:.0f}" for value in city.layout.extent)
    return [
        f"It leaves the site towards ({x:.1f}, {y:.1f}), which reaches from ({west}, {south}) to "
        f"({east}, {north})"
    ]


def _through(city: City, line: Any) -> list[str]:
    """Name buildings and walls that a path goes through."""
    found = []
    houses, lines = city.layout.buildings, city.layout.lines
    walls = lines[lines["kind"].isin(SOLID).to_numpy()]
    for table, kind in ((houses, "building"), (walls, "")):
        shapes = table.geometry.to_numpy()
        for row in shapely.STRtree(shapes).query(line, predicate="intersects").tolist():
            x, y = shapely.get_coordinates(shapely.intersection(line, shapes[row]))[0]
            what = kind or str(table["kind"].iloc[row]).replace("_", " ")
            own = table["name"].iloc[row] if kind else ""
            own = own or table["source"].iloc[row] or id_text(table["id"].iloc[row])
            found.append(f'It goes through the {what} "{own}" at ({x:.1f}, {y:.1f})')
    return found


def _wet(city: City, line: Any) -> list[str]:
    """Name waters that a path goes into where nothing bridges them."""
    areas, roads = city.layout.areas, city.layout.roads
    water = areas[areas["kind"].isin(("water", "sea", "river", "pool")).to_numpy()]
    shapes = water.geometry.to_numpy()
    rows = shapely.STRtree(shapes).query(line, predicate="intersects")
    if not len(rows):
        return []
    decks = roads.geometry.to_numpy()[roads["bridge"].to_numpy(bool)]
    half = np.nan_to_num(roads["width"].to_numpy(float)[roads["bridge"].to_numpy(bool)], nan=6.0)
    deck = shapely.union_all(shapely.buffer(decks, half / 2 + 3.0))
    found = []
    for row in rows.tolist():
        left = shapely.difference(shapely.intersection(line, shapes[row]), deck)
        if shapely.length(left) > STEP:
            x, y = shapely.get_coordinates(left)[0]
            own = water["name"].iloc[row] or water["kind"].iloc[row]
            found.append(f'It goes into the water "{own}" at ({x:.1f}, {y:.1f})')
    return found


def _runs(
    xy: FloatArray, wrong: NDArray[np.bool_], label: NDArray[np.int64], most: float
) -> list[str]:
    """Name the stretches of wrong surface that are longer than allowed, metres."""
    edge = np.diff(np.concatenate([[0], wrong.astype(int), [0]]))
    found = []
    for first, last in zip(np.flatnonzero(edge == 1), np.flatnonzero(edge == -1), strict=True):
        length = (last - first) * STEP
        if length > most:
            x, y = xy[first]
            surface = SURFACES[label[first]].name
            what = NAMES.get(surface, surface.replace("_", " "))
            found.append(f"It lies on {what} for {length:.0f} m from ({x:.1f}, {y:.1f})")
    return found
