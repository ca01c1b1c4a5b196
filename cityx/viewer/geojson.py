"""The map of a city as GeoJSON: what it holds of buildings, roads, areas, lines and points.

References
----------
RFC 7946: longitude and latitude of WGS84; rings of outsides run against the clock.
"""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import shapely
from shapely.geometry import mapping

from cityx.city import City
from cityx.ids import id_text
from cityx.server.layers import plain, shown

LAYERS = ("buildings", "roads", "areas", "lines", "points")
DIGITS = 7  # of degrees: a centimetre


def layout_geojson(city: City) -> dict[str, Any]:
    """Return the map of a city as a collection of features.

    Parameters
    ----------
    city
        City, its layout in metres.

    Returns
    -------
    collection
        Of RFC 7946. The id of a feature is that of the object, 16 hexadecimal digits; its
        properties are the layer and what the table of it holds, the tags of the map as an object.
        Heights are in metres. "attribution" lists whose data it is.
    """
    features = [feature for layer in LAYERS for feature in _features(city, layer)]
    return {"type": "FeatureCollection", "features": features,
            "attribution": list(city.attribution)}  # fmt: skip


def _features(city: City, layer: str) -> list[dict[str, Any]]:
    table = getattr(city.layout, layer)
    if not len(table):
        return []
    shapes = shapely.force_2d(table.geometry.to_numpy())
    placed = shapely.transform(shapes, lambda xy: np.round(city.frame.to_geographic(xy), DIGITS))
    placed = shapely.orient_polygons(placed)
    names = [name for name in table.columns if name not in ("geometry", "id", "tags")]
    columns = {name: table[name].tolist() for name in names}
    tags = table["tags"].tolist() if "tags" in table else [""] * len(table)
    features = []
    for row, number in enumerate(table["id"].tolist()):
        values = {name: plain(columns[name][row]) for name in names}
        text = tags[row]
        told = json.loads(text) if isinstance(text, str) and text.startswith("{") else {}
        properties: dict[str, Any] = {"layer": layer}
        properties |= {key: value for key, value in values.items() if value not in ("", None)}
        properties["tags"] = {shown(str(key)): shown(str(value)) for key, value in told.items()}
        features.append({"type": "Feature", "id": id_text(number),
                         "geometry": mapping(placed[row]), "properties": properties})  # fmt: skip
    return features
