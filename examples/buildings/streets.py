"""Three streets made of sample buildings: an old town, a business district, a suburb."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import shapely

from cityx.building.catalogue import generators
from cityx.building.samples import STREET_WIDTH, Sample, sample_city, setback_of
from cityx.city.camera import Camera
from cityx.city.city import City
from cityx.city.layout import make_table
from cityx.ids import choose, stable_id, uniform

LENGTH = 260.0  # metres


@dataclass(frozen=True)
class Street:
    """One street.

    Attributes
    ----------
    title
        For the sheet.
    houses
        Generators and weights.
    gap
        (least, greatest) metres between neighbours.
    trees
        Metres between street trees, 0 for none.
    widened
        Metres added to the carriageway.
    time
        Of the picture; the street runs from west to east, and the camera looks east.
    eye, heading, pitch
        Camera: (x, y, z), radians from east towards north, radians.
    """

    title: str
    houses: Mapping[str, float]
    gap: tuple[float, float] = (0.0, 0.0)
    trees: float = 0.0
    widened: float = 0.0
    time: str = "16:00"
    eye: tuple[float, float, float] = (2.0, -2.4, 1.8)
    heading: float = 0.12
    pitch: float = 0.08


STREETS = {
    "old_town": Street(
        "Old town",
        {"palazzo": 6, "perimeter_block": 4, "shop_house": 3, "georgian_terrace": 1,
         "mediterranean_house": 1},
    ),
    "business": Street(
        "Business district",
        {"glass_tower": 4, "setback_skyscraper": 3, "postmodern_tower": 3, "office_slab": 2,
         "brutalist": 1, "mixed_use": 1},
        gap=(4.0, 12.0), widened=10.0, time="16:30", eye=(2.0, -6.0, 2.2), heading=0.1, pitch=0.2,
    ),
    "suburb": Street(
        "Suburb", {"suburban_house": 6, "bungalow": 3, "cottage": 2}, gap=(4.0, 9.0), trees=52.0,
        eye=(26.0, -2.6, 2.6), heading=0.38, pitch=0.0,
    ),
}  # fmt: skip


def street_city(name: str, *, lod: int = 2) -> City:
    """Make the city of one street."""
    street = STREETS[name]
    words = [word for word in street.houses if word in generators()]
    weights = [street.houses[word] for word in words]
    samples: list[Sample] = []
    for side in (1, -1):
        x, number = -20.0, 0
        while x < LENGTH:
            seed = 1000 * (side + 1) + number
            key = np.uint64(stable_id(name, seed))
            word = words[int(choose(0, "street/house", key, weights))]
            each = Sample(word, stable_id(name, seed) & 0xFFFF).measured()
            back = setback_of(generators()[word]) + street.widened / 2
            y = back if side > 0 else -back - each.width
            samples.append(replace(each, x=round(x, 2), y=round(y, 2)))
            low, high = street.gap
            x += each.length + low + (high - low) * float(uniform(0, "street/gap", key))
            number += 1
    city = sample_city(samples, lod=lod, streets=[0.0])
    roads = city.layout.roads.copy()
    roads["width"] = STREET_WIDTH + street.widened
    roads["lanes"] = 2 if street.widened < 6.0 else 4
    layout = replace(city.layout, roads=roads)
    if street.trees:
        xs = np.arange(-30.0, LENGTH + 30.0, street.trees)
        y = (STREET_WIDTH + street.widened) / 2 + 0.9
        places = [(x, side * y) for x in xs.tolist() for side in (1, -1)]
        count = len(places)
        points = make_table(
            "points", shapely.points(np.array(places)),
            id=[stable_id("sample", "tree", name, i) for i in range(count)],
            kind=["tree"] * count, height=[np.nan] * count, direction=[np.nan] * count,
            source=[f"sample/tree/{i}" for i in range(count)], tags=["{}"] * count,
        )  # fmt: skip
        layout = replace(layout, points=points)
    return replace(city, layout=layout, name=street.title)


def camera_of(name: str) -> Camera:
    """Return the camera on the sidewalk of a street."""
    street = STREETS[name]
    heading = math.pi / 2 - street.heading
    return Camera(name, street.eye, heading, street.pitch, math.radians(70), 960, 540)
