"""Streets that exist, made wider, narrower, one-way, paved otherwise or closed to cars."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import shapely

from cityx.city import City
from cityx.city.section import carriageway_width, section_text
from cityx.edit.land.cross_sections import (
    MOVING,
    Bands,
    bands_of_row,
    directed,
    widened,
    with_lanes,
    with_strips,
)
from cityx.edit.land.parts_of_streets import parted
from cityx.edit.land.spots import CORNERS
from cityx.edit.renewal import renewed
from cityx.errors import UsageError
from cityx.geometry.polygons import region_of_corners
from cityx.ids import id_text
from cityx.places.profiles import keeps_left
from cityx.protocol import Choice, ObjectName, Points, Port, Range, Serves, action
from cityx.protocol.objects import find_objects
from cityx.road.network.network import DRIVABLE, FACADE_CLEARANCE
from cityx.road.network.street_designs import SURFACES, WIDEST_STREET, row_of

if TYPE_CHECKING:
    from geopandas import GeoDataFrame

WIDEST_WALK = 8.0  # metres of a walk
LEAST_WALK = 1.0  # metres between kerb and facade that a wider carriageway leaves to a sidewalk
LEAST_WIDTH = 2.4  # metres between the kerbs
# Materials of walls that streets are paved with as well -> the surface.
MATERIALS = {"concrete": "concrete", "brick": "bricks", "stone": "paving_stones"}
FOOT = "pedestrian"  # kind of a street that is closed to cars
PAVED = "paving_stones"
CLOSED = "cityx:closed"  # tag that keeps what a closed street was, so that it can be opened again
SIDEWALKS = ("sidewalk_left", "sidewalk_right")
WATER = ("water", "sea", "river", "pool")
WALKED = ("footway", "path", "cycleway", FOOT, "bridleway", "steps", "track")
KERBS = ("kind", "lanes", "lanes_forward", "lane_width", "width", "sidewalk_left",
         "sidewalk_right", "parking_left", "parking_right", "section", "surface", "oneway",
         "maxspeed_kmh")  # fmt: skip


@dataclass(frozen=True)
class _Change:
    """What becomes of streets; None leaves a thing as it is. See `streets` for the attributes."""

    width: float | None
    widen_by: float | None
    widen_factor: float | None
    lanes: int | None
    lanes_by: int | None
    direction: str | None
    speed_kmh: float | None
    surface: str | None
    parking: str | None
    cycling: str | None
    traffic: str | None
    walk: float | None
    walk_least: float | None

    @property
    def of_paving(self) -> bool:
        """Whether nothing but the surface changes."""
        return self == replace(_UNCHANGED, surface=self.surface)

    @property
    def of_section(self) -> bool:
        """Whether the cross-section changes."""
        values = (self.width, self.widen_by, self.widen_factor, self.lanes, self.lanes_by,
                  self.direction, self.parking, self.cycling)  # fmt: skip
        return any(value is not None for value in values)


_UNCHANGED = _Change(*[None] * len(fields(_Change)))


@action(
    "edit/streets-v1",
    limits=[
        "Kerbs move on both sides alike; houses and waters stay and bound the width.",
        "A street that is closed to cars becomes a paved way as wide as it was with its walks.",
        "What stands beside a street stays where it is when the street is paved otherwise.",
        "Parking and cycle lanes are painted beside lanes that keep 2.75 m; else the kerbs move.",
        "Walks grow away from the carriageway, no farther than houses and waters; streets without "
        "walks get none.",
    ],
    requires=("layout",),
    takes=(Port("roads", "line", role="road_centerline"),),
    gives=(Port("roads", "line", role="road_centerline"),),
    serves=(
        Serves("edit=set_width", "family=road"),
        Serves("edit=raise_width", "family=road"),
        Serves("edit=scale_width", "family=road"),
        Serves("edit=set_lanes", "family=road"),
        Serves("edit=raise_lanes", "family=road"),
        Serves("edit=set_surface", "family=road"),
        *(
            Serves("edit=set_material", "family=road", f"material={word}", surface=surface)
            for word, surface in MATERIALS.items()
        ),
        Serves("edit=set_direction", "family=road"),
        Serves("edit=set_speed", "family=road"),
        Serves("edit=set_parking", "family=road"),
        Serves("edit=set_cycling", "family=road"),
        Serves("edit=set_walks", "family=road"),
        Serves("edit=close", "family=road", traffic="walkers"),
        Serves("edit=open", "family=road", traffic="cars"),
    ),
    binds={
        "streets": "objects", "width": "width", "widen_by": "by",
        "widen_factor": "factor", "lanes": "lanes",
        "lanes_by": "lanes.by",
        "direction": "direction", "speed_kmh": "speed_kmh", "surface": "surface",
        "parking": "parking", "cycling": "cycling", "part": "part",
        "walk": "walk", "walk_least": "walk.min",
    },
    labels=("widen", "narrow", "pedestrianise", "one-way", "cobbles", "cycle lane", "speed limit"),
)  # fmt: skip
def streets(
    city: City,
    *,
    streets: Annotated[tuple[str, ...], ObjectName()],
    width: Annotated[float | None, Range(LEAST_WIDTH, WIDEST_STREET)] = None,
    widen_by: Annotated[float | None, Range(-WIDEST_STREET, WIDEST_STREET)] = None,
    widen_factor: Annotated[float | None, Range(0.1, 10.0)] = None,
    lanes: Annotated[int | None, Range(1, 12)] = None,
    lanes_by: Annotated[int | None, Range(-11, 11)] = None,
    direction: Annotated[str | None, Choice("both", "along", "against")] = None,
    speed_kmh: Annotated[float | None, Range(5.0, 130.0)] = None,
    surface: Annotated[str | None, Choice(*SURFACES)] = None,
    parking: Annotated[str | None, Choice("none", "left", "right", "both")] = None,
    cycling: Annotated[str | None, Choice("none", "left", "right", "both")] = None,
    traffic: Annotated[str | None, Choice("cars", "walkers")] = None,
    walk: Annotated[float | None, Range(0.5, WIDEST_WALK)] = None,
    walk_least: Annotated[float | None, Range(0.5, WIDEST_WALK)] = None,
    part: Annotated[tuple[tuple[float, ...], ...] | None, Points(3, CORNERS)] = None,
) -> City:
    """Change streets and rebuild what depends on them; everything else stays as it is.

    Parameters
    ----------
    city
        City with the streets.
    streets
        The streets, by name, source or id.
    width
        Metres from kerb to kerb.
    widen_by
        Metres that are added to the width of each; negative to narrow it.
    widen_factor
        What the width of each is multiplied by.
    lanes
        Lanes, both directions together, each as wide as now.
    lanes_by
        Lanes that are added to those of each; negative to take some away.
    direction
        Which way one drives, as seen along the street as it is drawn.
    speed_kmh
        Speed limit.
    surface
        What it is paved with, in OpenStreetMap's words.
    parking, cycling
        On which sides cars park, and cycles have a lane.
    traffic
        Who may use it; "walkers" closes it to cars, "cars" opens it again.
    walk, walk_least
        Metres of the walks that a street has on its sides, or the least of them.
    part
        Corners of the ground on which they change, x, y and which polygon; they are parted there.
        Everywhere when left out.
    """
    change = _Change(width, widen_by, widen_factor, lanes, lanes_by, direction, speed_kmh, surface,
                     parking, cycling, traffic, walk, walk_least)  # fmt: skip
    ids, layout = find_objects(city, streets), city.layout
    if part is not None:
        city, ids = parted(city, ids, region_of_corners(part))
        streets = tuple(map(id_text, ids.tolist()))
    table = city.layout.roads
    rows = np.flatnonzero(np.isin(table["id"].to_numpy(np.uint64), ids))
    _require_streets(table, rows, streets, change)
    left_hand = keeps_left(city.frame)
    changed, faults = table.copy(), []
    for row in rows.tolist():
        try:
            found = _changed_row(table.iloc[row], change, left_hand=left_hand)
            _require_room(city, row, found)
        except UsageError as error:
            faults.append(f"{_called(table.iloc[row])}: {error}")
            continue
        if found.pop("turned", False):
            changed.loc[row, "geometry"] = shapely.reverse(table.geometry.iloc[row])
        for column, value in found.items():
            changed.loc[row, column] = value
    if faults and (change.walk_least is None or changed.equals(table)):
        raise UsageError("\n".join(faults))
    city = replace(city, notes=tuple(dict.fromkeys((*city.notes, *faults))))
    if changed.equals(table):
        said = f"{', '.join(map(_called, (table.iloc[row] for row in rows)))}: nothing of this"
        if change == _UNCHANGED:
            raise UsageError(f"{said} would change; say what is to.")
        notes = (*city.notes, f"{said} changes; it is so already.")
        return replace(city, layout=layout, notes=tuple(dict.fromkeys(notes)))
    city = replace(city, layout=layout)
    return renewed(city, replace(layout, roads=changed), surface=change.of_paving)


def _called(row: Any) -> str:
    return str(row["name"] or row["source"] or "a street")


def _require_streets(
    table: GeoDataFrame, rows: Any, named: tuple[str, ...], change: _Change
) -> None:
    """Refuse what is no street, and ways that a change does not fit.

    Raises
    ------
    UsageError
        With every fault.
    """
    if len(rows) < len(set(named)):
        kept = {str(value) for column in ("name", "source") for value in table[column].iloc[rows]}
        other = [name for name in named if name not in kept] if rows.size else list(named)
        raise UsageError(f"No street of the city: {', '.join(other[:5])}.")
    kinds = table["kind"].to_numpy().astype(str)[rows]
    for row, kind in zip(rows.tolist(), kinds, strict=True):
        name = _called(table.iloc[row])
        if kind not in (*DRIVABLE, *WALKED):
            raise UsageError(f"{name} is a {kind} line, no street.")
        for_cars = change.of_section or change.speed_kmh is not None
        if kind in WALKED and for_cars:
            raise UsageError(
                f"{name} is a {kind}: it carries no cars, so only its surface can be changed."
            )


def _changed_row(row: Any, change: _Change, *, left_hand: bool) -> dict[str, Any]:
    """Return the columns of a street that change."""
    found: dict[str, Any] = {}
    if change.traffic == "walkers":
        return {} if str(row["kind"]) in WALKED else _closed(row)  # it is so already
    if change.traffic == "cars":
        found |= _opened(row)
    if change.of_section:
        bands = bands_of_row(row, left_hand=left_hand)
        turned = change.direction == "against"
        made = _changed_bands(bands, change, left_hand=left_hand)
        found |= _columns(row, made)
        if change.direction is not None:
            found |= {"oneway": change.direction != "both", "turned": turned}
    for side in SIDEWALKS:
        now = float(row[side])
        wanted = change.walk if change.walk is not None else max(now, change.walk_least or 0.0)
        if now > 0 and wanted != now:
            found[side] = wanted
    if change.speed_kmh is not None:
        found["maxspeed_kmh"] = change.speed_kmh
    if change.surface is not None:
        tags = _tags(row) | {"surface": change.surface}
        tags.pop("smoothness", None)  # what is new is not worn
        found |= {"surface": change.surface, "tags": json.dumps(tags)}
    return found


def _changed_bands(bands: Bands, change: _Change, *, left_hand: bool) -> Bands:
    if change.lanes is not None:
        bands = with_lanes(bands, change.lanes, left_hand=left_hand)
    if change.lanes_by is not None:
        count = sum(band.kind in MOVING for band in bands) + change.lanes_by
        if count < 1:
            raise UsageError(f"it would have {count} lanes left; close it to cars instead.")
        bands = with_lanes(bands, count, left_hand=left_hand)
    if change.direction is not None:
        bands = directed(bands, oneway=change.direction != "both", left_hand=left_hand)
    for kind, sides in (("parking", change.parking), ("cycle", change.cycling)):
        if sides is not None:
            bands = with_strips(bands, kind, sides, left_hand=left_hand)
    wanted = change.width
    if change.widen_by is not None:
        wanted = carriageway_width(bands) + change.widen_by
    if change.widen_factor is not None:
        wanted = carriageway_width(bands) * change.widen_factor
    return bands if wanted is None else widened(bands, wanted, left_hand=left_hand)


def _columns(row: Any, bands: Bands) -> dict[str, Any]:
    """Return a cross-section as columns; walks stay as they are."""
    columns = row_of(bands)
    walks = {name: row[name] for name in ("sidewalk_left", "sidewalk_right")}
    return {**columns, **walks, "section": section_text(bands)}


def _tags(row: Any) -> dict[str, Any]:
    return dict(json.loads(row["tags"] or "{}"))


def _closed(row: Any) -> dict[str, Any]:
    """Return a street as a paved way between where its walks end."""
    if row["kind"] == FOOT:
        return {}
    was = {name: _plain(row[name]) for name in KERBS}
    width = float(row["width"]) + float(row["sidewalk_left"]) + float(row["sidewalk_right"])
    tags = _tags(row) | {CLOSED: was}
    return {
        "kind": FOOT, "width": width, "surface": PAVED, "section": "", "lanes": 0,
        "lanes_forward": 0, "sidewalk_left": 0.0, "sidewalk_right": 0.0, "parking_left": False,
        "parking_right": False, "oneway": False, "tags": json.dumps(tags),
    }  # fmt: skip


def _opened(row: Any) -> dict[str, Any]:
    """Return a street as it was before it was closed.

    Raises
    ------
    UsageError
        If it was no street for cars.
    """
    if row["kind"] not in WALKED:
        return {}
    tags = _tags(row)
    was: Mapping[str, Any] | None = tags.pop(CLOSED, None)
    if was is None:
        raise UsageError(f"it is a {row['kind']} and never carried cars, so it cannot be opened.")
    speed = was["maxspeed_kmh"]
    return {**was, "maxspeed_kmh": np.nan if speed is None else speed, "tags": json.dumps(tags)}


def _plain(value: Any) -> Any:
    """Return a value as JSON has it; what is not known is null."""
    value = value.item() if hasattr(value, "item") else value
    return None if isinstance(value, float) and np.isnan(value) else value


def _require_room(city: City, row: int, found: Mapping[str, Any]) -> None:
    """Refuse a width that houses or waters leave no room for.

    Raises
    ------
    UsageError
        With the most that there is room for.
    """
    table = city.layout.roads
    was = float(table["width"].iloc[row])
    width = float(found.get("width", was))
    wider = {side for side in SIDEWALKS if float(found.get(side, 0.0)) > table[side].iloc[row]}
    if (width <= was and not wider) or found.get("kind") == FOOT:
        return
    line = table.geometry.iloc[row]
    walks = [float(found.get(side, table[side].iloc[row])) for side in SIDEWALKS]
    beside = max(walk if wider else min(walk, LEAST_WALK) for walk in walks)
    parts = city.layout.parts
    walls = parts.geometry.to_numpy()[
        (parts["base"].to_numpy() < FACADE_CLEARANCE) & parts["walls"].to_numpy()
    ]
    areas = city.layout.areas
    waters = areas.geometry.to_numpy()[areas["kind"].isin(WATER).to_numpy()]
    bridge = bool(table["bridge"].iloc[row])
    for what, shapes in (("houses", walls), ("water", waters if not bridge else waters[:0])):
        shapes = shapes[~shapely.intersects(shapes, line)]
        if not len(shapes):
            continue
        most = 2 * (float(shapely.distance(shapes, line).min()) - FACADE_CLEARANCE - beside)
        if width > most and wider:
            raise UsageError(
                f"walks of {beside:g} m do not fit beside its {width:g} m between the kerbs: "
                f"{what} leave {max(beside + (most - width) / 2, 0.0):.1f} m."
            )
        if width > most:
            raise UsageError(
                f"{width:g} m between the kerbs do not fit: {what} beside it leave {most:.1f} m "
                f"besides its walks, and it has {was:g} m."
            )
