"""Which trees a place on Earth has, and what season it is there on a date.

References
----------
Hopkins, "Periodical events and natural law as guides to agricultural research", 1918: spring comes
four days later per degree of latitude; half of that fits leaf-out between cities, which are warm.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from types import MappingProxyType

from cityx.assets.styles.palettes import region_of
from cityx.assets.trees.species import OUTSIDE_TREES
from cityx.city.frame import Frame
from cityx.system.extensions import refuse

Mix = Mapping[str, float]

TROPIC = 24.0  # degrees of latitude within which palms grow and no tree is bare
YEAR_DAYS = 365
# Leaf-out and leaf-fall: day of the year at 40 degrees of latitude, days per degree, days it lasts.
SPRING = (80.0, 2.0, 45.0)
AUTUMN = (288.0, -1.6, 50.0)


def band_of(frame: Frame) -> str:
    """Return the band of a place: "tropic", "warm", "japan", "temperate" or "north"."""
    latitude, longitude = abs(frame.latitude), frame.longitude
    if latitude < TROPIC:
        return "tropic"
    if frame.latitude > 0 and 30.0 < latitude < 43.0 and 125.0 < longitude < 147.0:
        return "japan"
    if frame.latitude < 0:
        return "warm" if latitude < 39.5 else "temperate"
    # The Mediterranean keeps olives at latitudes where America and China have hard winters.
    olives = 42.2 if -11.0 < longitude < 37.0 else 40.0 if longitude < -115.0 else 33.0
    if latitude < olives:
        return "warm"
    return "temperate" if latitude < 57.0 else "north"


def season_of(day: int, frame: Frame) -> str:
    """Return the season of trees on a day of the year, 1 to 366, at a place.

    In the tropics it is summer all the year.
    """
    latitude = abs(frame.latitude)
    if latitude < TROPIC:
        return "summer"
    if frame.latitude < 0:
        day = (day + YEAR_DAYS // 2) % YEAR_DAYS
    start, slope, length = SPRING
    spring = start + slope * (latitude - 40.0)
    fall, slant, lasting = AUTUMN
    autumn = fall + slant * (latitude - 40.0)
    if spring <= day < spring + length:
        return "spring"
    if spring + length <= day < autumn:
        return "summer"
    return "autumn" if autumn <= day < autumn + lasting else "winter"


def mix_at(mixes: Mapping[str, Mix], frame: Frame) -> Mix:
    """Return the mix of a place: that of its region in a temperate climate, else of its climate."""
    band = band_of(frame)
    region = region_of(frame.latitude, frame.longitude)
    return mixes[region] if band == "temperate" and region in mixes else mixes[band]


def _mixes(planted: str = "", **bands: Mix) -> Mapping[str, Mix]:
    """Return mixes by region or climate, with those of packages: "streets" or "parks"."""
    found = {band: dict(mix) for band, mix in bands.items()}
    for name, tree in OUTSIDE_TREES.items():
        for band, weight in (getattr(tree, planted) if planted else {}).items():
            if band in found and weight > 0:
                found[band][name] = float(weight)
            elif band not in found:
                refuse(f'Species "{name}": "{band}" is none of {", ".join(found)}.')
    return MappingProxyType(found)


# Regions have street trees of their own where a climate leaves the choice.
_REGIONAL_STREETS = {
    "british isles": {"plane": 7.0, "lime": 2.0, "maple": 1.0, "cherry": 0.6, "birch": 0.5},
    "central europe": {"lime": 7.0, "maple": 2.0, "plane": 1.2, "chestnut": 1.0, "oak": 0.7},
    "france": {"plane": 6.0, "lime": 2.0, "chestnut": 2.0},
    "north america": {"maple": 3.0, "oak": 2.5, "plane": 2.0, "lime": 1.5, "ginkgo": 0.8},
}
STREET_MIX = _mixes(
    "streets",
    **_REGIONAL_STREETS,
    north={"lime": 5.0, "maple": 3.0, "birch": 2.0, "oak": 0.8},
    temperate={"lime": 5.0, "plane": 3.0, "maple": 3.0, "chestnut": 1.2, "oak": 0.6},
    japan={"ginkgo": 4.0, "zelkova": 4.0, "camphor": 1.6, "plane": 1.2, "maple": 0.6},
    warm={"plane": 4.0, "jacaranda": 2.0, "camphor": 2.0, "palm": 1.0},
    tropic={"camphor": 4.0, "jacaranda": 1.5, "palm": 1.5},
)
PARK_MIX = _mixes(
    "parks",
    north={"birch": 3.0, "lime": 2.0, "maple": 1.5, "spruce": 1.2, "pine": 1.2, "oak": 0.8,
           "poplar": 0.4, "willow": 0.4},
    temperate={"lime": 2.0, "oak": 2.0, "maple": 2.0, "birch": 1.3, "plane": 1.0, "chestnut": 1.0,
               "cherry": 0.8, "pine": 0.6, "willow": 0.4, "spruce": 0.4, "poplar": 0.3},
    japan={"cherry": 3.0, "zelkova": 2.0, "camphor": 2.0, "maple": 1.6, "ginkgo": 1.4, "pine": 1.4,
           "oak": 0.6, "willow": 0.3},
    warm={"plane": 2.0, "camphor": 1.6, "olive": 1.6, "pine": 1.4, "palm": 1.2, "cypress": 1.0,
          "jacaranda": 1.0, "acacia": 0.8},
    tropic={"camphor": 3.0, "palm": 2.5, "acacia": 1.6, "jacaranda": 1.0},
)  # fmt: skip
BROAD_MIX = _mixes(
    north={"birch": 4.0, "maple": 1.0, "lime": 0.7, "oak": 0.6},
    temperate={"oak": 3.0, "maple": 2.0, "lime": 2.0, "birch": 1.5},
    japan={"oak": 2.0, "zelkova": 2.0, "camphor": 2.0, "maple": 1.2, "cherry": 0.8},
    warm={"camphor": 3.0, "oak": 1.5, "olive": 1.0},
    tropic={"camphor": 4.0, "acacia": 1.5, "palm": 0.6},
)
NEEDLE_MIX = _mixes(
    north={"spruce": 3.0, "pine": 2.4},
    temperate={"spruce": 3.0, "pine": 1.6},
    japan={"spruce": 2.0, "pine": 1.4},
    warm={"pine": 4.0, "cypress": 1.0},
    tropic={"camphor": 1.0},
)
ORCHARD = _mixes(north={"cherry": 1.0}, temperate={"cherry": 1.0}, japan={"cherry": 1.0},
                 warm={"olive": 1.0}, tropic={"camphor": 1.0})  # fmt: skip

GENUS = {
    "tilia": "lime", "lime": "lime", "linden": "lime", "platanus": "plane", "plane": "plane",
    "acer": "maple", "maple": "maple", "ahorn": "maple", "quercus": "oak", "oak": "oak",
    "fagus": "oak", "beech": "oak", "aesculus": "chestnut", "chestnut": "chestnut",
    "castanea": "chestnut", "ulmus": "zelkova", "elm": "zelkova", "zelkova": "zelkova",
    "celtis": "zelkova", "fraxinus": "maple", "ash": "maple", "robinia": "jacaranda",
    "gleditsia": "jacaranda", "jacaranda": "jacaranda", "albizia": "acacia", "acacia": "acacia",
    "samanea": "acacia", "delonix": "acacia", "populus": "poplar", "poplar": "poplar",
    "betula": "birch", "birch": "birch", "alnus": "birch", "salix": "willow", "willow": "willow",
    "prunus": "cherry", "malus": "cherry", "pyrus": "cherry", "sorbus": "cherry",
    "crataegus": "cherry", "cherry": "cherry", "magnolia": "cherry", "ginkgo": "ginkgo",
    "liquidambar": "maple", "liriodendron": "plane", "carpinus": "lime", "olea": "olive",
    "olive": "olive", "cinnamomum": "camphor", "camphor": "camphor", "ficus": "camphor",
    "magnoliaceae": "camphor", "eucalyptus": "camphor", "citrus": "olive", "pinus": "pine",
    "pine": "pine", "larix": "spruce", "picea": "spruce", "abies": "spruce", "spruce": "spruce",
    "fir": "spruce", "cedrus": "pine", "cryptomeria": "spruce", "metasequoia": "spruce",
    "taxodium": "spruce", "cupressus": "cypress", "thuja": "cypress", "taxus": "cypress",
    "juniperus": "cypress", "chamaecyparis": "cypress", "cypress": "cypress", "buxus": "boxwood",
    "phoenix": "palm", "washingtonia": "palm", "trachycarpus": "palm", "palm": "palm",
    "arecaceae": "palm", "cocos": "palm", "roystonea": "palm",
    **{word: name for name, tree in OUTSIDE_TREES.items() for word in tree.genus},
}  # fmt: skip
NAMING = ("genus", "species", "taxon", "genus:en", "species:en", "species:de")


def species_of_tags(tags: str) -> str:
    """Return the habit that the tags of a tree name, or "" when they name none."""
    if len(tags) < 3:
        return ""
    try:
        known = json.loads(tags)
    except ValueError:
        return ""
    text = " ".join(str(known.get(key, "")) for key in NAMING).lower()
    for word in text.replace(",", " ").split():
        if word in GENUS:
            return GENUS[word]
    if known.get("leaf_type") == "needleleaved":
        return "spruce"
    return "palm" if known.get("leaf_type") == "palm" else ""
