"""Build cities from made sentences of limits, and measure whether each limit was kept.

    python benchmarks/limits.py [--count 100] [--seed 1] [--size 300x300] [--lod 1] [--out FILE]

Numbers, bounds and forms of words are drawn at random. Each city is measured from the numbers of
its sentence, on its tables and meshes alone: neither its goals nor predicates are asked. A sentence
that is refused is not kept.
Prints one line for each sentence and the number kept; exits 1 where one was not.
"""

from __future__ import annotations

import argparse
import json
import math
import random
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import shapely

import cityx
from cityx.assets.styles.materials import material_named
from cityx.city import City
from cityx.errors import CityxError
from cityx.geometry.polylines import to_linestrings

FOOT = 0.3048
KERB = 0.12  # metres from the ground of a flat town to that of its plots
NEAR = 0.06  # metres by which a height may be missed
UPRIGHT = 0.2
WORDS = ("zero", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten")
USES = {
    "house": "house detached semidetached_house terrace villa cottage bungalow farm",
    "shop": "retail shop commercial_retail supermarket kiosk mall",
    "office": "office commercial",
    "apartment building": "apartments residential",
    "church": "church chapel", "school": "school", "fire station": "fire_station",
    "hotel": "hotel", "mosque": "mosque", "petrol station": "fuel gas_station petrol_station",
}  # fmt: skip
WALLS = {"brick": "brick clinker", "concrete": "concrete road_concrete", "plaster": "plaster",
         "stone": "stone step_stone", "glass": "glass_wall glass pane",
         "timber": "wood"}  # fmt: skip
GREEN = ("park", "garden", "grass", "meadow", "wood", "scrub", "orchard", "cemetery", "golf",
         "wetland")  # fmt: skip
MAIN = ("motorway", "trunk", "primary", "secondary")
STREETS = (*MAIN, "tertiary", "residential", "living_street", "unclassified")


@dataclass(frozen=True)
class Limit:
    """What a city must keep: the least and greatest value that each of some numbers may have.

    Attributes
    ----------
    kind
        For the table of results.
    sentence
        Says it.
    values
        The numbers, measured on a city.
    low, high
        Bounds; those that are strict leave the bound itself out.
    strict
        Whether the bounds are left out.
    some
        Whether there must be any number at all.
    slack
        By which a number may lie beyond.
    """

    kind: str
    sentence: str
    values: Callable[[City], Any]
    low: float = -math.inf
    high: float = math.inf
    strict: bool = False
    some: bool = False
    slack: float = 0.0

    def fault(self, city: City) -> str:
        """Return what is wrong, "" where the limit is kept."""
        values = np.atleast_1d(np.asarray(self.values(city), float))
        if not len(values):
            return "there is none" if self.some else ""
        least, most = self.low - self.slack, self.high + self.slack
        if self.strict:
            wrong = (values <= least) | (values >= most)
        else:
            wrong = (values < least) | (values > most)
        if not wrong.any():
            return ""
        return f"{wrong.sum()} of {len(values)} beyond, {values.min():.4g} to {values.max():.4g}"


# -- measures -------------------------------------------------------------------------------------


def used(city: City, noun: str) -> Any:
    """(n,) whether buildings are of a use; all for "building"."""
    use = city.layout.buildings["use"].to_numpy(str)
    return np.full(len(use), True) if noun == "building" else np.isin(use, USES[noun].split())


def tops(city: City) -> Any:
    """(n,) metres from the plot to the top of each building's mesh."""
    batch = city.scene.meshes["buildings"]
    top = np.maximum.reduceat(batch.vertices[:, 2], batch.vertex_start[:-1]) - KERB
    row = np.searchsorted(city.layout.buildings["id"].to_numpy(np.uint64), batch.object_id)
    height = city.layout.buildings["height"].to_numpy(float).copy()
    np.maximum.at(height, row, top)
    return height


def heights_of(noun: str) -> Callable[[City], Any]:
    """Return the measure of the heights of a kind of buildings."""
    return lambda city: tops(city)[used(city, noun)]


def floors_of(noun: str) -> Callable[[City], Any]:
    """Return the measure of the storeys of a kind of buildings and of their parts."""

    def measured(city: City) -> Any:
        layout = city.layout
        levels = layout.buildings["levels"].to_numpy(float).copy()
        row = np.searchsorted(layout.buildings["id"], layout.parts["building"])
        np.maximum.at(levels, row, layout.parts["levels"].to_numpy(float))
        return levels[used(city, noun)]

    return measured


def number_of(noun: str) -> Callable[[City], Any]:
    """Return the measure of how many of a kind there are."""

    def measured(city: City) -> Any:
        if noun == "tree":
            return city.scene.instances["trees"].count if "trees" in city.scene.instances else 0
        if noun == "park":
            areas = city.layout.areas
            parks = areas.geometry.to_numpy()[(areas["kind"] == "park").to_numpy()]
            whole = shapely.union_all(shapely.buffer(parks, 0.5))
            return (shapely.area(shapely.get_parts(whole)) >= 300.0).sum() if len(parks) else 0
        if noun == "tower":
            return (tops(city) >= 50.0).sum()
        return used(city, noun).sum()

    return measured


def faces(city: City) -> tuple[Any, Any, Any, Any]:
    """Return of the faces of buildings their owner, area, vertical part of the normal, material."""
    batch = city.scene.meshes["buildings"]
    triangles, face = batch.triangles()
    a, b, c = (batch.vertices[triangles[:, k]] for k in range(3))
    cross = np.cross(b - a, c - a) / 2
    vector = np.stack([np.bincount(face, part, len(batch.faces)) for part in cross.T], axis=1)
    area = np.linalg.norm(vector, axis=1)
    roots = np.array([material_named(name).root for name in batch.materials])
    up = vector[:, 2] / np.maximum(area, 1e-12)
    return batch.face_object(), area, up, roots[batch.material]


def material_share(material: str) -> Callable[[City], Any]:
    """Return the measure of the share of buildings whose walls are mostly of a material."""

    def measured(city: City) -> Any:
        owner, area, up, root = faces(city)
        wall = np.abs(up) < UPRIGHT
        ids = np.unique(owner)
        row = np.searchsorted(ids, owner)
        whole = np.bincount(row, area * wall)
        own = np.bincount(row, area * (wall & np.isin(root, WALLS[material].split())))
        return (own >= 0.5 * whole).mean()

    return measured


def flat_share(city: City) -> Any:
    """Return the share of buildings whose roofs are mostly level."""
    owner, area, up, root = faces(city)
    roof = (up >= UPRIGHT) & (root != "trim")
    row = np.searchsorted(np.unique(owner), owner)
    return (
        np.bincount(row, area * (roof & (up > 0.99))) >= 0.5 * np.bincount(row, area * roof)
    ).mean()


def use_share(words: tuple[str, ...]) -> Callable[[City], Any]:
    """Return the measure of the share of buildings of some uses."""
    return lambda city: np.any([used(city, word) for word in words], axis=0).mean()


def green_share(city: City) -> Any:
    """Return the share of the site that is green land."""
    areas = city.layout.areas
    green = areas.geometry.to_numpy()[areas["kind"].isin(GREEN).to_numpy()]
    return shapely.union_all(green).area / (city.layout.area_km2 * 1e6)


def built_share(city: City) -> Any:
    """Return the share of the site under buildings."""
    return shapely.union_all(city.layout.buildings.geometry.to_numpy()).area / (
        city.layout.area_km2 * 1e6
    )


def widths_of(kinds: tuple[str, ...], column: str = "width") -> Callable[[City], Any]:
    """Return the measure of a column of the streets of some classes."""

    def measured(city: City) -> Any:
        roads = city.layout.roads
        return roads[column].to_numpy(float)[roads["kind"].isin(kinds).to_numpy()]

    return measured


def gaps(city: City) -> Any:
    """(k,) metres between neighbours of the rows of trees of streets, between two junctions."""
    rows, network = city.scene.instances.get("trees"), city.network
    if rows is None or network is None:
        return np.zeros(0)
    kind = city.layout.roads["kind"].to_numpy(str)[network.edge_road]
    street = np.isin(kind, STREETS)
    spots = shapely.points(rows.position[:, :2].astype(float))
    lines, half = to_linestrings(network.lines)[street], network.half_width[street]
    spot, line = shapely.STRtree(lines).query_nearest(spots, max_distance=25.0, all_matches=False)
    away = shapely.distance(spots[spot], lines[line]) - half[line]
    kept = (away > -0.5) & (away < 1.6)
    spot, line = spot[kept], line[kept]
    along = shapely.line_locate_point(lines[line], spots[spot])
    ahead = shapely.get_coordinates(shapely.line_interpolate_point(lines[line], along + 0.5))
    here = shapely.get_coordinates(shapely.line_interpolate_point(lines[line], along))
    aside = shapely.get_coordinates(spots[spot]) - here
    way = ahead - here
    side = np.sign(way[:, 0] * aside[:, 1] - way[:, 1] * aside[:, 0])
    order = np.lexsort((along, side, line))
    same = (np.diff(line[order]) == 0) & (np.diff(side[order]) == 0)
    return np.diff(along[order])[same]


def usual_gap(city: City) -> Any:
    """Return the median of the gaps between trees, nothing where there are few."""
    found = gaps(city)
    return np.median(found) if len(found) > 3 else np.zeros(0)


# -- sentences ------------------------------------------------------------------------------------

Bounds = tuple[str, float, float, bool]  # in words, low, high, strict


def spelt(number: float, dice: random.Random) -> str:
    """Return a number as digits or as a word."""
    whole = number == int(number)
    if whole and 0 < number <= 10 and dice.random() < 0.4:
        return WORDS[int(number)]
    return f"{number:g}"


def upper(number: float, unit: str, dice: random.Random, *, counted: bool = False) -> Bounds:
    """Return an upper bound in words."""
    n = spelt(number, dice)
    few = ("fewer than", True) if counted else ("less than", True)
    form, strict = dice.choice([
        ("at most", False), ("no more than", False), ("up to", False), ("under", True),
        ("a maximum of", False), few,
    ])  # fmt: skip
    return f"{form} {n}{unit}", -math.inf, number, strict


def lower(number: float, unit: str, dice: random.Random) -> Bounds:
    """Return a lower bound in words."""
    n = spelt(number, dice)
    form, strict = dice.choice([
        ("at least", False), ("a minimum of", False), ("more than", True), ("no less than", False),
        ("over", True),
    ])  # fmt: skip
    return f"{form} {n}{unit}", number, math.inf, strict


def between(low: float, high: float, unit: str) -> Bounds:
    """Return bounds of both kinds in words."""
    return f"between {low:g} and {high:g}{unit}", low, high, False


def bounds(
    dice: random.Random, low: float, high: float, unit: str, *, counted: bool = False,
    step: float = 1.0,
) -> Bounds:  # fmt: skip
    """Draw a bound of any kind between two numbers."""
    first = round(dice.uniform(low, high) / step) * step
    second = round(dice.uniform(low, high) / step) * step
    first, second = sorted((first, second))
    which = dice.random()
    if which < 0.45:
        return upper(second, unit, dice, counted=counted)
    if which < 0.75 or first == second:
        return lower(first, unit, dice)
    return between(first, second, unit)


def _height(dice: random.Random) -> Limit:
    unit, scale = (" ft", FOOT) if dice.random() < 0.25 else (dice.choice([" m", " metres"]), 1.0)
    if dice.random() < 0.5:
        number = dice.randint(7, 45) if scale == 1.0 else dice.randint(25, 140)
        form, strict = dice.choice([
            ("No building higher than {}{}", False), ("no building is taller than {}{}", False),
            ("no roof above {}{}", False), ("Nothing taller than {}{}", False),
            ("A town with no building over {}{}", False),
            ("a town whose buildings are not above {}{}", False),
            ("all buildings must stay under {}{}", True), ("buildings up to {}{} high", False),
            ("A quarter where every building is at most {}{} tall", False),
        ])  # fmt: skip
        return Limit(
            "height", form.format(number, unit), heights_of("building"), high=number * scale,
            strict=strict, some=True, slack=NEAR,
        )  # fmt: skip
    low, high = (8, 50) if scale == 1.0 else (26, 160)
    words, least, most, strict = bounds(dice, low, high, unit)
    form = dice.choice([
        "Buildings of {}", "a town with buildings of {} in height", "all buildings are {} high",
        "a district where each building is {} tall",
    ])  # fmt: skip
    return Limit(
        "height", form.format(words), heights_of("building"), least * scale, most * scale, strict,
        True, NEAR,
    )  # fmt: skip


def _height_of_kind(dice: random.Random) -> Limit:
    noun = dice.choice(["house", "shop", "office", "apartment building", "tower", "church"])
    if noun == "tower":
        first = dice.randint(52, 80)
        second = first + dice.randint(12, 60)
        form = dice.choice([
            "all towers between {} and {} m", "towers from {} to {} metres",
            "A downtown with towers between {} and {} m",
        ])  # fmt: skip
        return Limit(
            "height of a kind", form.format(first, second),
            lambda city: tops(city)[tops(city) >= 50.0], first, second, some=True, slack=NEAR,
        )  # fmt: skip
    number = dice.randint(8, 24)
    form = dice.choice([
        "no {} taller than {} m", "A town in which no {} is higher than {} metres",
        "no {} above {} m", "no {} may exceed {} m",
    ])  # fmt: skip
    some = noun == "church"
    if some:
        form = dice.choice(
            ["a church of at most {1} m", "a town with a church up to {1} metres high"]
        )
    return Limit(
        "height of a kind", form.format(noun, number), heights_of(noun), high=number, slack=NEAR,
        some=some,
    )  # fmt: skip


def _floors(dice: random.Random) -> Limit:
    unit = dice.choice([" floors", " storeys", " stories"])
    if dice.random() < 0.2:
        number = dice.randint(2, 9)
        words: Bounds = (f"exactly {spelt(number, dice)}{unit}", number, number, False)
    else:
        words = bounds(dice, 2, 12, unit)
    form = dice.choice([
        "Buildings of {}", "a town where every building has {}", "all buildings have {}",
        "A quarter with buildings of {}",
    ])  # fmt: skip
    return Limit("floors", form.format(words[0]), floors_of("building"), *words[1:], some=True)


def _floors_of_kind(dice: random.Random) -> Limit:
    noun = dice.choice(["house", "shop", "office", "apartment building"])
    many = noun + "s"
    number = dice.randint(1, 4)
    unit = " floor" if number == 1 else dice.choice([" floors", " storeys"])
    if dice.random() < 0.5:
        form = dice.choice(["no {} taller than {}{}", "no {} with more than {}{}",
                            "no {} higher than {}{}"])  # fmt: skip
        sentence = form.format(noun, spelt(number, dice), unit)
        return Limit("floors of a kind", sentence, floors_of(noun), high=number)
    words = upper(number + 1, " floors", dice)
    form = dice.choice(["{} of {}", "a town with {} of {}", "{} have {}"])
    sentence = form.format(many, words[0])
    return Limit("floors of a kind", sentence, floors_of(noun), *words[1:], some=True)


def _count(dice: random.Random) -> Limit:
    noun, low, high = dice.choice([
        ("building", 4, 90), ("building", 4, 60), ("building", 3, 30), ("house", 4, 40),
        ("tower", 1, 6), ("church", 1, 3), ("school", 1, 2), ("tree", 10, 200),
        ("tree", 20, 300), ("park", 1, 3),
    ])  # fmt: skip
    many = {"church": "churches"}.get(noun, noun + "s")
    if dice.random() < 0.25:
        number = dice.randint(low, high)
        words: Bounds = (f"exactly {spelt(number, dice)}", number, number, False)
    else:
        words = bounds(dice, low + 1, high, "", counted=True)
    form = dice.choice(["{0} {1}", "a town with {0} {1}", "A place of {0} {1}", "{0} {1} in all"])
    sentence = form.format(words[0], many)
    return Limit("count", sentence, number_of(noun), *words[1:], some=True)


def _share(dice: random.Random) -> Limit:
    low, high = 10, 85
    what = dice.choice(["material", "material", "use", "green", "flat", "built"])
    if what == "material":
        word = dice.choice([*WALLS])
        said, values = f"of the buildings of {word}", material_share(word)
    elif what == "use":
        word, uses = dice.choice([
            ("offices", ("office",)), ("shops", ("shop",)), ("houses", ("house",)),
            ("apartment buildings", ("apartment building",)),
        ])  # fmt: skip
        said, values = f"of the buildings are {word}", use_share(uses)
    elif what == "green":
        low, high, said, values = 8, 40, dice.choice(["green", "of green space"]), green_share
    elif what == "built":
        low, high, said, values = 10, 35, "of the ground built on", built_share
    else:
        said, values = "of the buildings with flat roofs", flat_share
    unit = dice.choice([" %", " percent", "%"])
    if what == "green" or what == "built" or dice.random() < 0.85:
        which = dice.random()
        number = dice.randrange(low, high, 5)
        words = upper(number, unit, dice) if which < 0.45 else lower(number, unit, dice)
        if words[0].split()[-2] in WORDS or words[0].split()[-1].rstrip("%") in WORDS:
            words = (words[0].replace(WORDS[10], "10").replace(WORDS[5], "5"), *words[1:])
    else:
        words = between(low, low + 30, unit)
    form = dice.choice(["{0} {1}", "a town with {0} {1}"]) if " are " not in said else "{0} {1}"
    least, most = words[1] / 100, words[2] / 100
    return Limit("share", form.format(words[0], said), values, least, most, words[3], slack=1e-6)


def _spacing(dice: random.Random) -> Limit:
    number = dice.randint(5, 20)
    which = dice.random()
    if which < 0.4:
        form = dice.choice(["street trees every {} m", "trees spaced {} m apart",
                            "A tree every {} metres along the streets"])  # fmt: skip
        slack = 0.1 * number
        return Limit(
            "spacing", form.format(number), usual_gap, number, number, some=True, slack=slack
        )
    if which < 0.7:
        form = dice.choice(["trees at least {} m apart along the streets",
                            "street trees with a spacing of at least {} m"])  # fmt: skip
        return Limit("spacing", form.format(number), gaps, low=number, some=True, slack=0.1)
    form = dice.choice(["trees at most {} m apart along the streets",
                        "street trees no more than {} m apart"])  # fmt: skip
    return Limit("spacing", form.format(number), usual_gap, high=number, some=True, slack=0.1)


def _width(dice: random.Random) -> Limit:
    noun, kinds, low, high = dice.choice([
        ("streets", STREETS, 6, 16), ("main streets", MAIN, 9, 24), ("roads", STREETS, 6, 14),
        ("side streets", STREETS[len(MAIN):], 5, 12),
    ])  # fmt: skip
    unit = dice.choice([" m", " metres", " m"])
    words = bounds(dice, low, high, unit)
    form = dice.choice(["{0} {1} wide", "a town with {0} {1} wide", "all {0} are {1} wide"])
    sentence = form.format(noun, words[0])
    return Limit("width", sentence, widths_of(kinds), *words[1:], some=True, slack=0.05)


def _lanes(dice: random.Random) -> Limit:
    noun, kinds = dice.choice([("main streets", MAIN), ("streets", STREETS)])
    number = dice.randint(2, 6) if noun != "streets" else dice.randint(1, 3)
    form, low, high = dice.choice([
        ("{0} with exactly {1} lanes", number, number),
        ("{0} with at least {1} lanes", number, math.inf),
        ("{0} with at most {1} lanes", -math.inf, number),
        ("{0} have {1} lanes", number, number),
        ("{0} with no more than {1} lanes", -math.inf, number),
    ])  # fmt: skip
    sentence = form.format(noun, number)
    if number == 1:
        sentence = sentence.replace("lanes", "lane")
    return Limit("lanes", sentence, widths_of(kinds, "lanes"), low, high, some=True)


KINDS = (
    (_height, 20), (_height_of_kind, 12), (_floors, 14), (_floors_of_kind, 10), (_count, 18),
    (_share, 12), (_spacing, 6), (_width, 5), (_lanes, 3),
)  # fmt: skip


def sentences(seed: int, count: int) -> Iterator[Limit]:
    """Yield sentences of all kinds, in their shares."""
    dice = random.Random(seed)
    of_kinds = [make for make, weight in KINDS for _ in range(weight)]
    whole = [of_kinds[k % len(of_kinds)] for k in range(count)] if count >= 100 else dice.choices(
        of_kinds, k=count
    )  # fmt: skip
    for make in whole:
        yield make(dice)


def judged(limit: Limit, size: tuple[float, float], lod: int, seed: int) -> str:
    """Build the city of a sentence and return what is wrong with it."""
    try:
        project = cityx.build(limit.sentence, lod=lod, size=size, seed=seed)
    except CityxError as error:
        return f"refused: {' '.join(str(error).split())}"
    return limit.fault(project.city)


def main() -> int:
    """Build, measure and count."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--size", default="300x300")
    parser.add_argument("--lod", type=int, default=1)
    parser.add_argument("--only", default="", help="kinds of limits, by the words of their names")
    parser.add_argument("--out", default="")
    parser.add_argument("--list", action="store_true", help="print the sentences alone")
    args = parser.parse_args()
    east, north = (float(part) for part in args.size.split("x"))
    told = []
    for number, limit in enumerate(sentences(args.seed, args.count)):
        if args.only and args.only not in limit.kind:
            continue
        if args.list:
            print(f"{limit.kind}: {limit.sentence}")
            continue
        fault = judged(limit, (east, north), args.lod, 0)
        told.append({"kind": limit.kind, "sentence": limit.sentence, "fault": fault})
        print(
            f"{number:3d} {'kept  ' if not fault else 'MISSED'} {limit.sentence}: {fault}",
            flush=True,
        )
        if args.out:
            Path(args.out).write_text(json.dumps(told, indent=1))
    kept = sum(not one["fault"] for one in told)
    print(f"{kept} of {len(told)} kept")
    return int(kept < len(told))


if __name__ == "__main__":
    sys.exit(main())
