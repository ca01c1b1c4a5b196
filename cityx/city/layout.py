"""The layout: typed polygons, lines and points that every input becomes.

Nothing downstream knows where a row came from, except by its provenance column ``source``.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cityx.system.tables import table

if TYPE_CHECKING:
    from geopandas import GeoDataFrame

# Column name -> NumPy dtype ("str" is kept as a Python string column). Every table has in
# addition ``geometry``. Missing numbers are NaN, missing words are "". Ids are unsigned 64-bit,
# stable (`cityx.ids.stable_id`). Rows are sorted by id.
SCHEMA = table("city/layout", dict[str, str])

# Zones of parts that are slabs of a mesh which another package makes; a bare one has no openings.
MESH, BARE = "mesh", "bare_mesh"
BAY = "bay"  # zone of the parts of a house that steps down a slope: each has a ground of its own
CURVE = "curve"  # kind of a line that is no thing itself: a user drew it to build something on

AREA_KINDS = (
    "water", "sea", "river", "pool", "wetland",
    "park", "garden", "grass", "meadow", "wood", "scrub", "orchard", "cemetery", "golf",
    "farmland", "sand", "rock", "bare", "pitch", "playground",
    "pedestrian", "parking", "road_area", "railway", "pier", "construction",
    "residential", "commercial", "retail", "industrial", "civic", "void",
)  # fmt: skip

# Things that stand by themselves and that the piece of the same name stands for -> metres from the
# ground to their tops.
ASKED_HEIGHTS: Mapping[str, float] = table("city/asked_things", float)
ASKED_KINDS = tuple(ASKED_HEIGHTS)

POINT_KINDS = (
    "tree", "shrub", "street_lamp", "bench", "waste_basket", "bollard", "bus_stop",
    "traffic_signals", "crossing", "kerb", "gate", "stop", "give_way", "fire_hydrant", "post_box",
    "telephone",
    "bicycle_parking", "fountain", "advertising_column", "power_pole", "statue", "entrance",
    "vending_machine", "recycling", "flagpole", "quay_crane", "container_stack",
    "traffic_cone", "work_barrier",
    "turning_circle", "mini_roundabout", "power_tower", "wind_turbine", "crane", "scaffold",
    "helipad", "wall_tower", "tram_stop", *ASKED_KINDS,
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

    @property
    def own_areas(self) -> GeoDataFrame:
        """The areas, but for sea and voids of height files, which are there before any layout."""
        return self.areas[~self.areas["source"].str.startswith("heights/").to_numpy(bool)]


def of_kinds(table: GeoDataFrame, kinds: Iterable[str]) -> NDArray[np.bool_]:
    """(n,) whether rows are of some kinds.

    Parameters
    ----------
    kinds
        Words of the column "kind"; "pitch:tennis" wants the value among the tags as well, and
        "orchard:!vineyard" wants it not to be there.
    """
    own = table["kind"].to_numpy().astype(str)
    found = np.zeros(len(table), bool)
    for word in kinds:
        kind, _, value = word.partition(":")
        rows = np.flatnonzero(own == kind)
        if value:
            wanted = value.removeprefix("!")
            held = [_has_value(text, wanted) for text in table["tags"].to_numpy()[rows]]
            rows = rows[np.array(held, bool) != value.startswith("!")]
        found[rows] = True
    return found


def _has_value(tags: str, wanted: str) -> bool:
    values = json.loads(tags).values() if tags else ()
    return any(wanted in str(value).split(";") for value in values)


def is_mesh(layout: Layout) -> NDArray[np.bool_]:
    """(n,) whether each part is a slab of a mesh that another package makes."""
    return np.isin(layout.parts["zone"].to_numpy(str), [MESH, BARE])
