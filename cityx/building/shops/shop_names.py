"""Shop names: what stands over every shop, from the map or by kind and language."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from functools import cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.assets.shops.lettering import is_known, line_of
from cityx.geometry.arrays import FloatArray
from cityx.ids import choose, hash_bits
from cityx.places.profiles import profile_of
from cityx.system.tables import DATA, read_table

if TYPE_CHECKING:
    from cityx.city.city import City


REACH = 15.0  # metres between a shop on the map and its front
LONGEST = 11.0  # em; longer names are cut at a word
_KEYS = ("shop", "amenity", "healthcare", "craft", "office")
_LATIN = ("name:en", "int_name", "brand:en", "brand")
Words = Mapping[str, tuple[str, ...]]
WORLD = "world"  # words understood nearly everywhere, for languages that are not in the table


def shop_names(
    city: City, tenant: NDArray[np.uint64], building: NDArray[np.uint64], place: FloatArray
) -> tuple[NDArray[np.str_], NDArray[np.str_]]:
    """Name shops, and tell what kind each is, a key of `ShopWords.usual`.

    A shop on the map names the nearest front of the building that it lies in, tags of a building
    name the fronts that are left, and words for what shops usually sell name the others.

    Parameters
    ----------
    tenant, building
        (k,) keys of different shops and of their buildings.
    place
        (k, 2) middles of their fronts, scene frame, metres.
    """
    tongue = profile_of(city.frame).shops.tongue
    names, kinds = np.full((2, len(tenant)), "", object)
    points = city.layout.points
    points = points[(points["kind"] == "shop").to_numpy()]
    if len(points) and len(tenant):
        fronts, spots = shapely.points(place), points.geometry.to_numpy()
        spot, front = shapely.STRtree(fronts).query(spots, "dwithin", REACH)
        # Only of the building that it lies in, so that one building can be made anew alone.
        own = city.layout.buildings
        ids = own["id"].to_numpy(np.uint64)
        row = np.minimum(np.searchsorted(ids, building[front]), len(ids) - 1)
        kept = ids[row] == building[front]
        kept &= shapely.intersects(own.geometry.to_numpy()[row], spots[spot])
        spot, front = spot[kept], front[kept]
        far = shapely.distance(spots[spot], fronts[front])
        order = np.lexsort(
            (tenant[front], points["id"].to_numpy(np.uint64)[spot], np.round(far, 3))
        )
        tags = points["tags"].to_numpy(str)
        used: set[int] = set()
        for row in order.tolist():
            at, shop = int(front[row]), int(spot[row])
            if not names[at] and shop not in used:
                used.add(shop)
                names[at], kinds[at] = _said(tags[shop], tongue, int(tenant[at]))
    tagged = {
        number: text
        for number, text in zip(
            city.layout.buildings["id"].to_numpy(np.uint64).tolist(),
            city.layout.buildings["tags"].to_numpy(str).tolist(),
            strict=True,
        )
        if '"shop"' in text or '"amenity"' in text
    }
    for at in np.flatnonzero(names == "").tolist():
        text = tagged.get(int(building[at]))
        if text:
            names[at], kinds[at] = _said(text, tongue, int(building[at]), vague="")
    usual = list(shop_words().usual)
    drawn = choose(city.seed, "facade/trade", tenant, list(shop_words().usual.values()))
    for at in np.flatnonzero(kinds == "").tolist():
        kinds[at] = usual[int(drawn[at])]
        names[at] = names[at] or _word(kinds[at], tongue, int(tenant[at]))
    return names.astype(str), kinds.astype(str)


def _said(text: str, tongue: str, key: int, *, vague: str = "furniture") -> tuple[str, str]:
    """Return the name that tags tell, or a word for their kind of shop, and that kind.

    Where they tell no known kind it is `vague`.
    """
    tags = json.loads(text)
    kinds = shop_words().kinds
    told = [kinds[tags[each]] for each in _KEYS if tags.get(each) in kinds]
    kind = told[0] if told else vague
    for each in ("name", *_LATIN):
        found = cut(str(tags.get(each, "")))
        if found:
            return found, kind
    return (_word(kind, tongue, key) if kind else ""), kind


def _word(kind: str, tongue: str, key: int) -> str:
    words = words_of(tongue)[kind]
    return words[hash_bits(0, "facade/word", key) % len(words)]


def cut(name: str) -> str:
    """Return a name as a sign shows it: without remarks, at most `LONGEST`; "" if not writable."""
    bare = re.sub(r"\s*[(\[（].*", "", name.replace("\u3000", " ")).split(";")[0].strip()
    words = bare.split()
    while words and is_known(" ".join(words)):
        if line_of(" ".join(words)).width <= LONGEST:
            return " ".join(words)
        words.pop()
    return ""


class ShopWords(NamedTuple):
    """The table ``shop_words.toml``.

    Attributes
    ----------
    kinds
        Tags of shop=* and amenity=* -> kind of shop.
    usual
        What shops sell where nothing is known, and how often.
    words
        Language -> kind of shop -> words.
    """

    kinds: Mapping[str, str]
    usual: Mapping[str, float]
    words: Mapping[str, Words]


@cache
def shop_words() -> ShopWords:
    """Read the table."""
    read = read_table(DATA / "shop_words.toml")
    return ShopWords(
        {tag: kind for kind, tags in read["kinds"].items() for tag in tags.split()},
        read["usual"],
        {
            tongue: {kind: tuple(words) for kind, words in table.items()}
            for tongue, table in read["words"].items()
        },
    )


def words_of(tongue: str) -> Words:
    """Return the words of a language by kind of shop."""
    words = shop_words().words
    return words.get(tongue, words[WORLD])
