"""What season it is at a place on a date, and which species tags name.

References
----------
Hopkins, "Periodical events and natural law as guides to agricultural research", 1918: spring comes
four days later per degree of latitude; half of that fits leaf-out between cities, which are warm.
"""

from __future__ import annotations

import json

from cityx.city.frame import Frame

TROPIC = 24.0  # degrees of latitude within which palms grow and no tree is bare
YEAR_DAYS = 365
# Leaf-out and leaf-fall: day of the year at 40 degrees of latitude, days per degree, days it lasts.
SPRING = (80.0, 2.0, 45.0)
AUTUMN = (288.0, -1.6, 50.0)


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
