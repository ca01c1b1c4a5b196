"""The map of a city as GeoJSON: in degrees, with the ids of the scene."""

import json

import numpy as np
import pytest
import shapely
from shapely.geometry import shape

from cityx.city.store import read_city
from cityx.viewer.geojson import LAYERS, layout_geojson


@pytest.fixture(scope="module")
def city(built_town):
    return read_city(built_town(lod=1) / "city")


def test_every_row_of_the_map_is_a_feature_where_it_stands(city):
    told = json.loads(json.dumps(layout_geojson(city), allow_nan=False))
    assert len(told["features"]) == sum(len(getattr(city.layout, layer)) for layer in LAYERS)
    held = {feature["id"]: feature for feature in told["features"]}
    table = city.layout.buildings
    for number, footprint in zip(table["id"].tolist(), table.geometry, strict=True):
        feature = held[f"{number:016x}"]
        assert feature["properties"]["layer"] == "buildings"
        placed = shape(feature["geometry"])
        assert placed.exterior.is_ccw
        back = shapely.transform(placed, city.frame.to_local)
        assert shapely.hausdorff_distance(back, footprint) < 0.03
    lon, lat = np.array(shape(next(iter(held.values()))["geometry"]).centroid.coords[0])
    assert abs(lon - city.frame.longitude) < 0.01
    assert abs(lat - city.frame.latitude) < 0.01


def test_tags_heights_and_whose_data_it_is_are_told(city):
    told = layout_geojson(city)
    assert any("OpenStreetMap" in text for text in told["attribution"])
    houses = [f["properties"] for f in told["features"] if f["properties"]["layer"] == "buildings"]
    assert all(house["height"] > 0 for house in houses)
    assert any("building" in house["tags"] for house in houses)
