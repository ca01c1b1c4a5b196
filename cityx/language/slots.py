"""The closed list of slots: what a key means, and which may have but one value."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

# Key -> meaning. Keys with ".min" and ".max" bound the key without it.
KEYS: Mapping[str, str] = MappingProxyType(
    {
        "style": "style of the architecture",
        "district": "kind of town or quarter",
        "density": "high, medium or low",
        "size": "small, medium or large, where no measure is given",
        "size.x": "metres west to east",
        "size.y": "metres south to north",
        "size.area": "square metres of the whole",
        "population": "inhabitants",
        "terrain": "flat, hilly, mountainous or valley",
        "building.count": "number of buildings",
        "building.type": "type most buildings have",
        "building.height": "metres, or tall, medium, low, varied",
        "building.floors": "storeys",
        "building.material": "material of the walls",
        "building.color": "colour of the walls",
        "building.roof": "shape or covering of the roofs",
        "roof.color": "colour of the roofs",
        "building.use": "use of the buildings",
        "building.feature": "balconies, arcades...",
        "roads.pattern": "grid, organic, radial, ring, cul_de_sac, superblock",
        "roads.width": "metres, or wide or narrow",
        "roads.main.width": "the same of main streets",
        "roads.other.width": "the same of the other streets",
        "roads.lanes": "lanes of a street, both directions together",
        "roads.main.lanes": "the same of main streets",
        "roads.other.lanes": "the same of the other streets",
        "roads.main.axis": "where the main street runs: north_south, east_west...",
        "roads.avenues": "number of avenues",
        "roads.rings": "number of ring roads",
        "roads.motorways": "number of motorways",
        "roads.motorway.lanes": "lanes of the motorway, both directions together",
        "roads.motorway.axis": "where the motorway runs",
        "roads.slope": "steepness, 0.12 for 12 percent",
        "roads.count": "number of streets",
        "roads.main.count": "number of main streets",
        "roads.speed": "speed limit, metres per second",
        "element": "park, river, lake, plaza, bridge, beach... or one landmark",
        "green.share": "share of the ground that is green",
        "nature.trees": "many, some or few",
        "nature.spacing": "metres between trees in a row",
        "weather": "clear, cloudy, overcast, rain, storm, fog, haze or snow",
        "rain.intensity": "light or heavy",
        "snow.intensity": "light or heavy",
        "fog.intensity": "light or heavy",
        "wetness": "high or low, of the ground",
        "temperature": "degrees Celsius; only held against the weather",
        "time": "dawn, sunrise, morning, noon, afternoon, golden_hour, sunset, dusk, evening, "
        "night, or HH:MM",
        "season": "spring, summer, autumn or winter",
        "traffic": "heavy, medium or light",
        "pedestrians": "heavy, medium or light",
        "lights": "neon, on or off",
        "agent": "a kind of vehicle or person that is to be there",
        "vehicle.speed": "metres per second",
        "pedestrian.speed": "metres per second",
        "source": "osm, semantic_map, height_field, satellite, drawn or text_file",
    }
)
# Families: what is measured of any thing with a name, "river.width", "tree.count", "beach.side".
MEASURED = ("count", "width", "length", "height", "area", "side", "share", "size.x", "size.y")
SINGLE = frozenset(
    {
        "density",
        "size",
        "size.x",
        "size.y",
        "size.area",
        "population",
        "terrain",
        "building.count",
        "building.height",
        "building.floors",
        "roads.pattern",
        "roads.width",
        "roads.main.width",
        "roads.other.width",
        "roads.lanes",
        "roads.main.lanes",
        "roads.other.lanes",
        "roads.main.axis",
        "roads.avenues",
        "roads.rings",
        "roads.motorways",
        "roads.motorway.lanes",
        "roads.motorway.axis",
        "roads.slope",
        "rain.intensity",
        "snow.intensity",
        "fog.intensity",
        "wetness",
        "temperature",
        "time",
        "weather",
        "season",
        "traffic",
        "pedestrians",
        "nature.trees",
        "nature.spacing",
        "lights",
    }
)


def is_key(key: str) -> bool:
    """Tell whether a key is one of the closed list."""
    base = key.removesuffix(".min").removesuffix(".max")
    family = any(base.endswith(f".{name}") and len(base) > len(name) + 1 for name in MEASURED)
    return base in KEYS or family
