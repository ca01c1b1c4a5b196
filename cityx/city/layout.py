"""The layout: typed polygons, lines and points that every input becomes.

Nothing downstream knows where a row came from, except by its provenance column ``source``.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from geopandas import GeoDataFrame

# Column name -> NumPy dtype ("str" is kept as a Python string column). Every table has in
# addition ``geometry``. Missing numbers are NaN, missing words are "". Ids are unsigned 64-bit,
# stable (`cityx.ids.stable_id`). Rows are sorted by id.
SCHEMA: Mapping[str, Mapping[str, str]] = MappingProxyType(
    {
        # One row per building outline, geometry Polygon (counter-clockwise shell).
        "buildings": {
            "id": "uint64",
            "source": "str",  # "osm/way/123"
            "use": "str",  # value of building=*: "yes", "apartments", "retail", ...
            "name": "str",
            "levels": "int16",  # storeys above ground, resolved (never missing)
            "height": "float64",  # metres above the building's ground, roof included, resolved
            "place": "str",  # class of the surroundings: "low", "urban", "core"
            "generator": "str",  # name of the building generator, "" until one is chosen
            "tags": "str",  # JSON object of the source's own attributes
        },
        # One row per volume to raise (a building:part, the uncovered rest of an outline, or the
        # outline itself). A building is the union of the rows that name it.
        "parts": {
            "id": "uint64",
            "building": "uint64",
            "use": "str",
            "zone": "str",  # look within the generator: "podium", "tower", ..., "" for the main one
            "base": "float64",  # metres above the building's ground (min_height)
            "top": "float64",  # metres above the building's ground, roof included
            "levels": "int16",  # storeys between base and eave
            "roof_shape": "str",  # OSM roof:shape, resolved: "flat", "gabled", "hipped", ...
            "roof_height": "float64",  # metres; eave = top - roof_height
            "roof_direction": "float64",  # compass radians of the downward slope, or NaN
            "roof_across": "bool",  # ridge across the longer side
            "walls": "bool",  # False: roof on posts (canopy, carport)
            "wall_color": "int32",  # sRGB 0xRRGGBB, or -1 when the input says nothing
            "wall_material": "str",  # material word of the input, or ""
            "roof_color": "int32",
            "roof_material": "str",
        },
        # One row per way that carries movement, geometry LineString in driving direction.
        "roads": {
            "id": "uint64",
            "source": "str",
            "kind": "str",  # OSM highway=* value, or "rail", "tram", "subway", "light_rail"
            "name": "str",
            "lanes": "int16",  # both directions together
            "lanes_forward": "int16",
            "lane_width": "float64",
            "width": "float64",  # carriageway kerb to kerb, metres, parking included, resolved
            "sidewalk_left": "float64",  # metres, 0 when there is none
            "sidewalk_right": "float64",
            "parking_left": "bool",
            "parking_right": "bool",
            "oneway": "bool",
            "layer": "int16",
            "bridge": "bool",
            "tunnel": "bool",
            "passage": "bool",  # runs through a building (building_passage, covered)
            "roundabout": "bool",
            "section": "str",  # cross-section (`cityx.city.section`), "" when the columns say all
            "surface": "str",  # "asphalt", "sett", "paving_stones", "gravel", ... resolved
            "lit": "bool",
            "maxspeed_kmh": "float64",
            "tags": "str",
        },
        # Regions, geometry Polygon (one row per part of a multipolygon).
        "areas": {
            "id": "uint64",
            "source": "str",
            "kind": "str",  # one of AREA_KINDS
            "name": "str",
            "tags": "str",
        },
        # Barriers, tree rows, routes that agents may follow and curves to build on, LineString.
        "lines": {
            "id": "uint64",
            "source": "str",
            # "wall", "fence", "hedge", "city_wall", "tree_row", "retaining_wall", "route", `CURVE`
            "kind": "str",
            "height": "float64",
            "tags": "str",
        },
        # Turns that are forbidden, or the only ones allowed; geometry Point, the junction.
        "restrictions": {
            "id": "uint64",
            "source": "str",
            "from_source": "str",  # source of the road that traffic comes by
            "to_source": "str",  # and of the road that it may not, or must, leave by
            "only": "bool",
        },
        # Things at a place, geometry Point.
        "points": {
            "id": "uint64",
            "source": "str",
            "kind": "str",  # one of POINT_KINDS
            "height": "float64",
            "direction": "float64",  # compass radians, or NaN
            "tags": "str",
        },
    }
)

# Zones of parts that are slabs of a mesh which another package makes; a bare one has no openings.
MESH, BARE = "mesh", "bare_mesh"
CURVE = "curve"  # kind of a line that is no thing itself: a user drew it to build something on

AREA_KINDS = (
    "water", "sea", "river", "pool", "wetland",
    "park", "garden", "grass", "meadow", "wood", "scrub", "orchard", "cemetery", "golf",
    "farmland", "sand", "rock", "bare", "pitch", "playground",
    "pedestrian", "parking", "road_area", "railway", "pier", "construction",
    "residential", "commercial", "retail", "industrial", "civic",
)  # fmt: skip

POINT_KINDS = (
    "tree", "shrub", "street_lamp", "bench", "waste_basket", "bollard", "bus_stop",
    "traffic_signals", "crossing", "stop", "give_way", "fire_hydrant", "post_box", "telephone",
    "bicycle_parking", "fountain", "advertising_column", "power_pole", "statue", "entrance",
    "vending_machine", "recycling", "flagpole", "turning_circle", "mini_roundabout",
    "shop",  # the place of a shop, a restaurant or a bank within a building
)  # fmt: skip


# Measures that are zero, not unknown, where a source gives none.
NONE_THERE = ("sidewalk_left", "sidewalk_right")


def _column(name: str, values: Any, dtype: str, size: int) -> Any:
    import pandas as pd

    if dtype == "str":
        return pd.array(np.full(size, "") if values is None else np.asarray(values, object), "str")
    if values is None:
        fill: Any = np.nan if dtype.startswith("float") and name not in NONE_THERE else 0
        return np.full(size, fill, dtype=dtype)
    return np.asarray(values).astype(dtype)


def make_table(name: str, geometry: Any, /, **columns: Any) -> GeoDataFrame:
    """Make a table of the layout with exactly the columns of its schema, sorted by id.

    Parameters
    ----------
    name
        Key of `SCHEMA`.
    geometry
        (n,) shapely geometries, scene frame, metres.
    columns
        (n,) values by column name; columns left out are filled with "" , 0, False or NaN.

    Raises
    ------
    KeyError
        If a column is not in the schema.
    """
    from geopandas import GeoDataFrame

    schema = SCHEMA[name]
    unknown = set(columns) - set(schema)
    if unknown:
        raise KeyError(f"table {name!r} has no column {sorted(unknown)}")
    geometry = np.asarray(geometry, dtype=object)
    size = len(geometry)
    data = {key: _column(key, columns.get(key), dtype, size) for key, dtype in schema.items()}
    order = np.argsort(data["id"], kind="stable")
    data = {key: values[order] for key, values in data.items()}
    return GeoDataFrame(data, geometry=geometry[order])


def in_town(buildings: GeoDataFrame) -> NDArray[np.bool_]:
    """(b,) whether buildings stand in town, among others as dense or denser."""
    return np.asarray(np.isin(buildings["place"].to_numpy().astype(str), ("urban", "core")))


def joined_tables(first: GeoDataFrame, second: GeoDataFrame) -> GeoDataFrame:
    """Join two tables of one schema, sorted by id; rows of the second replace those of its ids."""
    import pandas as pd

    kept = first[~first["id"].isin(second["id"])]
    if not len(second):
        return first
    if not len(kept):
        return second
    rows = pd.concat([kept, second], ignore_index=True)
    return rows.sort_values("id", kind="stable", ignore_index=True)


def empty_table(name: str) -> GeoDataFrame:
    """Return a table of the layout without rows."""
    return make_table(name, np.zeros(0, dtype=object))


@dataclass(frozen=True)
class Layout:
    """Seven feature tables and the site's rectangle; see `SCHEMA` for the columns.

    Attributes
    ----------
    extent
        (xmin, ymin, xmax, ymax) of the site, metres, scene frame.
    """

    extent: tuple[float, float, float, float]
    buildings: GeoDataFrame = field(default_factory=lambda: empty_table("buildings"))
    parts: GeoDataFrame = field(default_factory=lambda: empty_table("parts"))
    roads: GeoDataFrame = field(default_factory=lambda: empty_table("roads"))
    areas: GeoDataFrame = field(default_factory=lambda: empty_table("areas"))
    lines: GeoDataFrame = field(default_factory=lambda: empty_table("lines"))
    points: GeoDataFrame = field(default_factory=lambda: empty_table("points"))
    restrictions: GeoDataFrame = field(default_factory=lambda: empty_table("restrictions"))

    @property
    def area_km2(self) -> float:
        """Area of the site's rectangle in square kilometres."""
        xmin, ymin, xmax, ymax = self.extent
        return (xmax - xmin) * (ymax - ymin) / 1e6


def is_mesh(layout: Layout) -> NDArray[np.bool_]:
    """(n,) whether each part is a slab of a mesh that another package makes."""
    return np.isin(layout.parts["zone"].to_numpy(str), [MESH, BARE])
