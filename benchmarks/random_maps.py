"""Random towns as OSM maps, built in this process: what fails at the first run, by seed.

    python benchmarks/random_maps.py [--seeds 0:100] [--jobs 2] [--lod 0] [--out FILE]
    python benchmarks/random_maps.py --reduce SEED [--lod 0]

A town has streets of random classes with random tags, bridges, tunnels, railways, waters, houses
with parts and courts, walls, trees and furniture, some of it broken as maps are: missing nodes,
borders that clip ways, unusable values, twisted outlines. Of each is asked: no internal error; no
object lost that the report does not count; every id one object; every check kept. A line per seed
that fails, then counts; ``--reduce`` drops objects while the same fault remains and prints a map.
"""

from __future__ import annotations

import argparse
import json
import math
import random
import sys
import tempfile
import traceback
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from xml.sax.saxutils import quoteattr

import shapely
from shapely import affinity

Place = tuple[float, float]  # metres, east and north of the middle of the map
Tags = dict[str, str]
LODS = (0, 1, 2)

CLASSES = ("residential", "tertiary", "secondary", "primary", "unclassified", "living_street",
           "service", "pedestrian", "track", "footway", "cycleway", "path")  # fmt: skip
SURFACES = ("asphalt", "sett", "gravel", "paving_stones", "concrete", "ground", "banana", "paved")
SPEEDS = ("30", "50", "20 mph", "walk", "RU:urban", "70", "none", "-5")
ROOFS = ("gabled", "hipped", "flat", "skillion", "pyramidal", "mansard", "gambrel", "half-hipped",
         "dome", "onion", "round", "cone", "saltbox", "many")  # fmt: skip
COLOURS = ("red", "#aabbcc", "white", "darkgreen", "brownish", "#12", "yellow", "black", "gold")
MATERIALS = ("brick", "concrete", "glass", "stone", "wood", "plaster", "metal", "jelly")
LENGTHS = ("3", "6", "9.5", "12 m", "40'", "25", "7,5", "0", "-50", "banana", "1000000", "31.4")
HOUSES = ("yes", "house", "residential", "apartments", "retail", "church", "industrial", "garage",
          "school", "office", "shed", "hotel", "roof", "greenhouse", "commercial")  # fmt: skip
GREENS: tuple[Tags, ...] = (
    {"leisure": "park"}, {"landuse": "grass"}, {"landuse": "forest"}, {"leisure": "pitch"},
    {"leisure": "playground"}, {"natural": "water"}, {"landuse": "meadow"}, {"leisure": "garden"},
    {"amenity": "parking"}, {"landuse": "cemetery"}, {"natural": "scrub"},
)  # fmt: skip
BARRIERS = ("wall", "fence", "hedge", "city_wall", "retaining_wall")
THINGS: tuple[Tags, ...] = (
    {"natural": "tree"}, {"amenity": "bench"}, {"amenity": "waste_basket"},
    {"emergency": "fire_hydrant"}, {"highway": "street_lamp"}, {"amenity": "post_box"},
    {"barrier": "bollard"}, {"natural": "tree", "height": "12", "leaf_type": "needleleaved"},
)  # fmt: skip


@dataclass
class Drawn:
    """One object of a map before it is written: places in metres, or members of a relation."""

    tags: Tags
    places: list[Place] = field(default_factory=list)
    holes: list[list[Place]] = field(default_factory=list)
    missing: bool = False  # whether a node or a member of it is absent, as in clipped extracts

    @property
    def is_closed(self) -> bool:
        """Whether the object is an area."""
        return len(self.places) > 3 and self.places[0] == self.places[-1]


@dataclass
class Map:
    """A random town: where it lies, what is drawn, and the edge of its bounds, metres."""

    latitude: float
    longitude: float
    drawn: list[Drawn]
    edge: float

    def text(self, kept: Iterable[int] | None = None) -> str:
        """Return the map as OSM XML; of some objects alone if ``kept`` counts them."""
        numbers = range(len(self.drawn)) if kept is None else sorted(kept)
        return "".join(_written(self, [(k, self.drawn[k]) for k in numbers]))

    def position(self, place: Place) -> tuple[float, float]:
        """Return latitude and longitude of a place."""
        north = self.latitude + place[1] / 111_320
        east = self.longitude + place[0] / (111_320 * math.cos(math.radians(self.latitude)))
        return round(north, 7), round(east, 7)


def _written(town: Map, drawn: Sequence[tuple[int, Drawn]]) -> Iterator[str]:
    low, high = (town.position((side, side)) for side in (-town.edge, town.edge))
    yield '<osm version="0.6" generator="random">\n'
    yield (f'<bounds minlat="{low[0]}" minlon="{low[1]}" maxlat="{high[0]}" '
           f'maxlon="{high[1]}"/>\n')  # fmt: skip
    nodes: dict[Place, int] = {}
    tagged = {_snapped(one.places[0]): one.tags for _, one in drawn if len(one.places) == 1}
    ways, relations = [], []
    for number, one in drawn:
        if len(one.places) == 1:
            nodes.setdefault(_snapped(one.places[0]), len(nodes) + 1)
            continue
        rings = [one.places, *one.holes]
        first = 1000 * (number + 1)
        for k, ring in enumerate(rings):
            refs = [nodes.setdefault(_snapped(place), len(nodes) + 1) for place in ring]
            if one.missing and k == 0:
                refs.insert(1, 999_999_999)
            ways.append(_way(first + k, refs, one.tags if not one.holes else {}))
        if one.holes:
            roles = ["outer", *["inner"] * len(one.holes)]
            relations.append(_relation(first, roles, one.tags, missing=one.missing))
    for place, number in nodes.items():
        north, east = town.position(place)
        tags = _tags(tagged.get(place, {}))
        yield f'<node id="{number}" version="1" lat="{north}" lon="{east}">{tags}</node>\n'
    yield from ways
    yield from relations
    yield "</osm>\n"


def _snapped(place: Place) -> Place:
    return round(place[0], 2), round(place[1], 2)


def _way(number: int, refs: list[int], tags: Tags) -> str:
    nodes = "".join(f'<nd ref="{ref}"/>' for ref in refs)
    return f'<way id="{number}" version="1">{nodes}{_tags(tags)}</way>\n'


def _relation(number: int, roles: list[str], tags: Tags, *, missing: bool) -> str:
    members = "".join(
        f'<member type="way" ref="{number + k}" role="{role}"/>' for k, role in enumerate(roles)
    )
    if missing:
        members += '<member type="way" ref="999999999" role="outer"/>'
    return (f'<relation id="{number}" version="1">{members}'
            f"{_tags({'type': 'multipolygon', **tags})}</relation>\n")  # fmt: skip


def _tags(tags: Tags) -> str:
    return "".join(f"<tag k={quoteattr(key)} v={quoteattr(value)}/>" for key, value in tags.items())


def random_map(seed: int) -> Map:
    """Return the town of a seed; equal seeds give equal towns."""
    rng = random.Random(seed)
    town = _Town(rng)
    town.draw()
    edge = town.reach * rng.choice((1.2, 1.2, 1.2, 0.8))
    return Map(rng.uniform(-55, 68), rng.uniform(-179, 179), town.drawn, edge)


class _Town:
    """Draws a town: streets on a bent grid, what crosses it, what stands in its blocks."""

    def __init__(self, rng: random.Random) -> None:
        self.rng = rng
        self.drawn: list[Drawn] = []
        self.columns, self.rows = rng.randint(2, 4), rng.randint(2, 4)
        self.spacing = rng.uniform(60, 120)
        self.bend = rng.uniform(0, 0.18) * self.spacing
        self.turn = rng.uniform(0, 90)
        self.corners = {
            (i, j): self._corner(i, j) for i in range(self.columns) for j in range(self.rows)
        }
        self.reach = 0.5 * self.spacing * max(self.columns, self.rows)
        self.taken: list[shapely.Geometry] = []  # ground that no house may stand on

    def _corner(self, i: int, j: int) -> Place:
        x = (i - 0.5 * (self.columns - 1)) * self.spacing + self.rng.uniform(-1, 1) * self.bend
        y = (j - 0.5 * (self.rows - 1)) * self.spacing + self.rng.uniform(-1, 1) * self.bend
        angle = math.radians(self.turn)
        return (x * math.cos(angle) - y * math.sin(angle),
                x * math.sin(angle) + y * math.cos(angle))  # fmt: skip

    def chance(self, share: float) -> bool:
        return self.rng.random() < share

    def draw(self) -> None:
        self._streets()
        for _ in range(self.rng.choice((0, 0, 1, 2))):
            self._across()
        for i in range(self.columns - 1):
            for j in range(self.rows - 1):
                self._block(shapely.Polygon([self.corners[i + a, j + b] for a, b in
                                             ((0, 0), (1, 0), (1, 1), (0, 1))]))  # fmt: skip

    def _streets(self) -> None:
        lines = [[self.corners[i, j] for i in range(self.columns)] for j in range(self.rows)]
        lines += [[self.corners[i, j] for j in range(self.rows)] for i in range(self.columns)]
        for line in lines:
            if self.chance(0.1):
                continue
            if self.chance(0.4):  # goes on over the edge of the town
                (ax, ay), (bx, by) = line[-2:]
                line = [*line, (2 * bx - ax, 2 * by - ay)]
            kind = self.rng.choice(CLASSES)
            cut = self.rng.randrange(1, len(line)) if self.chance(0.5) else len(line) - 1
            for part in (line[: cut + 1], line[cut:]):
                if len(part) > 1:
                    self._street(part, self._street_tags(kind))

    def _street(self, places: list[Place], tags: Tags) -> None:
        self.drawn.append(Drawn(tags, list(places), missing=self.chance(0.02)))
        self.taken.append(shapely.LineString(places).buffer(11))
        for place in places[1:-1]:
            if self.chance(0.2):
                kind = self.rng.choice(("crossing", "traffic_signals", "stop", "give_way"))
                self.drawn.append(Drawn({"highway": kind}, [place]))
        if self.chance(0.2):
            (ax, ay), (bx, by) = places[:2]
            part = self.rng.uniform(0.3, 0.7)
            place = (ax + part * (bx - ax), ay + part * (by - ay))
            if len(self.drawn[-1].places) > 1:
                self.drawn[-1].places.insert(1, place)
            kind = self.rng.choice(("bus_stop", "crossing", "street_lamp"))
            more = {"crossing": self.rng.choice(("zebra", "no", "traffic_signals", "unmarked"))}
            self.drawn.append(Drawn({"highway": kind} | (more if kind == "crossing" else {}),
                                    [place]))  # fmt: skip

    def _street_tags(self, kind: str) -> Tags:
        rng, tags = self.rng, {"highway": kind}
        choices: dict[str, Sequence[str]] = {
            "lanes": ("1", "2", "3", "4", "two", "6"), "oneway": ("yes", "no", "-1", "maybe"),
            "maxspeed": SPEEDS, "surface": SURFACES, "width": LENGTHS[:4],
            "name": ("Elm Street", "Rue <A&B>", "大通り", "x" * 200), "lit": ("yes", "no"),
            "sidewalk": ("both", "left", "right", "no", "separate", "none"),
            "cycleway": ("lane", "track", "no", "opposite_lane", "shared_lane"),
            "parking:both": ("lane", "street_side", "no"),
            "parking:left:orientation": ("diagonal",),
            "busway": ("lane", "opposite_lane"), "railway": ("tram",), "junction": ("roundabout",),
            "oneway:bicycle": ("no",), "access": ("private", "no"), "bus": ("yes",),
            "turn:lanes": ("left|through|right", "left;through|right"), "layer": ("0", "1", "-1"),
            "embankment": ("yes",), "cutting": ("yes",), "covered": ("yes",),
            "traffic_calming": ("bump",), "smoothness": ("bad",), "incline": ("12%", "up"),
            "area": ("no",), "ford": ("yes",), "toll": ("yes",), "lanes:forward": ("1", "2"),
        }  # fmt: skip
        for key in rng.sample(sorted(choices), rng.choice((0, 1, 1, 2, 3))):
            tags[key] = rng.choice(choices[key])
        return tags

    def _across(self) -> None:
        """Draw what crosses the town from side to side, on a bridge or in a tunnel."""
        rng, far = self.rng, 1.1 * self.reach
        angle = rng.uniform(0, math.tau)
        off = rng.uniform(-0.3, 0.3) * self.reach
        east, north = math.cos(angle), math.sin(angle)
        places = [(t * east - off * north, t * north + off * east) for t in
                  (-far, -0.5 * far, 0.0, 0.5 * far, far)]  # fmt: skip
        below = self.chance(0.5)
        level = {"tunnel": "yes", "layer": rng.choice(("-1", "-2"))} if below else {
            "bridge": "yes", "layer": rng.choice(("1", "2"))}  # fmt: skip
        kind = rng.choice(({"highway": "primary"}, {"railway": "rail"}, {"highway": "motorway",
                           "oneway": "yes"}, {"highway": "footway"}, {"waterway": "stream"},
                           {"railway": "subway"}, {"power": "line"}))  # fmt: skip
        if "waterway" in kind or "power" in kind:
            level = {"tunnel": "culvert", "layer": "-1"} if "waterway" in kind else {}
        self.drawn.append(Drawn({**kind, **level}, places))
        if not below:
            self.taken.append(shapely.LineString(places).buffer(9))

    def _block(self, block: shapely.Polygon) -> None:
        inside = block.difference(shapely.union_all(self.taken)).buffer(-1)
        if inside.is_empty or not block.is_valid:
            return
        use = self.rng.random()
        if use < 0.15 and self._green(inside) == {"natural": "water"}:
            return
        for _ in range(self.rng.randint(1, 7)):
            self._house(inside)
        for _ in range(self.rng.randint(0, 3)):
            self._thing(inside)
        if self.chance(0.3):
            self._barrier(inside)

    def _green(self, inside: shapely.Geometry) -> Tags:
        part = max(getattr(inside, "geoms", [inside]), key=lambda one: one.area)
        self.drawn.append(Drawn(dict(self.rng.choice(GREENS)), _ring(part.exterior)))
        return self.drawn[-1].tags

    def _spot(self, inside: shapely.Geometry, outline: shapely.Geometry) -> shapely.Geometry | None:
        """Return an outline turned and moved to where it is free, if a place is found."""
        left, low, right, high = inside.bounds
        for _ in range(12):
            turned = affinity.rotate(
                outline, self.rng.choice((self.turn, self.rng.uniform(0, 360)))
            )
            moved = affinity.translate(turned, self.rng.uniform(left, right),
                                       self.rng.uniform(low, high))  # fmt: skip
            taken = shapely.union_all(self.taken[-40:]) if self.taken else shapely.Point()
            if moved.within(inside) and moved.distance(taken) > 0.5:
                return moved
        return None

    def _outline(self) -> shapely.Polygon:
        rng = self.rng
        width, depth = rng.uniform(4, 22), rng.uniform(4, 18)
        box = shapely.box(-width / 2, -depth / 2, width / 2, depth / 2)
        shape = rng.choice(("box", "box", "box", "ell", "court", "tee", "round", "odd"))
        if shape == "ell":
            return box.difference(shapely.box(0, 0, width, depth))
        if shape == "court" and min(width, depth) > 12:
            return box.difference(shapely.box(-width / 5, -depth / 5, width / 5, depth / 5))
        if shape == "tee":
            return box.union(shapely.box(-width / 8, 0, width / 8, depth))
        if shape == "round":
            return shapely.Point(0, 0).buffer(depth / 2, quad_segs=rng.randint(1, 6))
        if shape == "odd":
            corners = [(rng.gauss(0, width / 3), rng.gauss(0, depth / 3)) for _ in range(7)]
            return shapely.convex_hull(shapely.MultiPoint(corners))
        return box

    def _house(self, inside: shapely.Geometry) -> None:
        outline = self._spot(inside, self._outline())
        if outline is None or not isinstance(outline, shapely.Polygon):
            return
        tags = self._house_tags("building", self.rng.choice(HOUSES))
        one = Drawn(tags, _ring(outline.exterior), [_ring(hole) for hole in outline.interiors])
        fault = self.rng.random()
        if fault < 0.01:
            one.missing = True
        elif fault < 0.02 and not one.holes and len(one.places) > 4:  # a bow-tie
            one.places[1], one.places[2] = one.places[2], one.places[1]
        elif fault < 0.03 and not one.holes:  # left open
            one.places.pop()
        elif fault < 0.04:  # nodes of no length
            one.places.insert(1, (one.places[0][0] + 0.01, one.places[0][1]))
        self.drawn.append(one)
        self.taken.append(outline)
        if self.chance(0.15):
            self._parts(outline)
        if self.chance(0.05):  # the same once more
            self.drawn.append(Drawn(dict(tags), list(one.places), list(one.holes)))
        if self.chance(0.1):
            self._neighbour(inside, outline)

    def _neighbour(self, inside: shapely.Geometry, outline: shapely.Polygon) -> None:
        """Draw a house that shares a wall with another one."""
        corners = list(outline.exterior.coords)
        (ax, ay), (bx, by) = corners[0], corners[1]
        far = math.hypot(bx - ax, by - ay)
        if far < 3:
            return
        deep = self.rng.uniform(3, 10)
        for side in (1, -1):
            nx, ny = side * (by - ay) / far * deep, -side * (bx - ax) / far * deep
            beside = shapely.Polygon([(ax, ay), (bx, by), (bx + nx, by + ny), (ax + nx, ay + ny)])
            others = shapely.union_all([one for one in self.taken if one is not outline])
            free = beside.intersection(outline).area < 1e-6 and beside.distance(others) > 0.5
            if free and beside.within(inside):
                tags = self._house_tags("building", self.rng.choice(HOUSES))
                self.drawn.append(Drawn(tags, _ring(beside.exterior)))
                self.taken.append(beside)
                return

    def _parts(self, outline: shapely.Polygon) -> None:
        left, low, right, high = outline.bounds
        middle = self.rng.uniform(0.3, 0.7) * (right - left) + left
        for half in (shapely.box(left, low, middle, high), shapely.box(middle, low, right, high)):
            part = outline.intersection(half)
            if isinstance(part, shapely.Polygon) and part.area > 4 and self.chance(0.8):
                tags = self._house_tags("building:part", "yes")
                self.drawn.append(Drawn(tags, _ring(part.exterior),
                                        [_ring(hole) for hole in part.interiors]))  # fmt: skip

    def _house_tags(self, key: str, value: str) -> Tags:
        rng, tags = self.rng, {key: value}
        choices: dict[str, Sequence[str]] = {
            "height": LENGTHS, "building:levels": ("1", "2", "3", "5", "2.5", "many", "-1", "12"),
            "roof:shape": ROOFS, "roof:height": ("2", "4", "30", "x"), "roof:levels": ("1", "2"),
            "roof:direction": ("N", "SSW", "45", "350", "up"),
            "roof:orientation": ("along", "across"), "building:colour": COLOURS,
            "roof:colour": COLOURS, "building:material": MATERIALS, "roof:material": MATERIALS,
            "min_height": ("2", "5", "20"), "building:min_level": ("1", "3"), "layer": ("1", "-1"),
            "name": ("Town Hall", "Çafé & Söhne"), "roof:angle": ("30", "80"),
            "location": ("underground",), "indoor": ("yes",), "level": ("0", "-1"),
            "building:levels:underground": ("1",), "shop": ("bakery",), "amenity": ("school",),
            "start_date": ("1890",), "building:use": ("office",), "addr:housenumber": ("7a",),
        }  # fmt: skip
        for key in rng.sample(sorted(choices), rng.choice((0, 1, 2, 3, 5))):
            tags[key] = rng.choice(choices[key])
        return tags

    def _thing(self, inside: shapely.Geometry) -> None:
        spot = self._spot(inside, shapely.Point(0, 0).buffer(1.2))
        if spot is not None:
            place = (spot.centroid.x, spot.centroid.y)
            self.drawn.append(Drawn(dict(self.rng.choice(THINGS)), [place]))
            self.taken.append(spot)

    def _barrier(self, inside: shapely.Geometry) -> None:
        part = max(getattr(inside, "geoms", [inside]), key=lambda one: one.area).buffer(-0.6)
        if not isinstance(part, shapely.Polygon) or part.is_empty:
            return
        tags = {"barrier": self.rng.choice(BARRIERS)}
        if self.chance(0.4):
            tags["height"] = self.rng.choice(LENGTHS[:6])
        ring = _ring(part.exterior)
        closed = self.chance(0.5)
        self.drawn.append(Drawn(tags, ring if closed else ring[: max(2, len(ring) // 2)]))
        if self.chance(0.5) and len(ring) > 3:
            self.drawn.append(Drawn({"barrier": "gate"}, [ring[1]]))


def _ring(ring: shapely.LinearRing) -> list[Place]:
    places = [_snapped((x, y)) for x, y in ring.coords]
    places[-1] = places[0]
    return places


def faults(town: Map, lod: int, kept: Iterable[int] | None = None) -> list[tuple[str, str]]:
    """Build a map and return what is wrong, each with its kind and what it is about."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "town.osm"
        path.write_text(town.text(kept))
        return list(_faults(path, lod))


def _faults(path: Path, lod: int) -> Iterator[tuple[str, str]]:
    import cityx
    from cityx.errors import CityxError

    try:
        project = cityx.build(path, lod=lod)
    except CityxError as refused:
        yield "refused", str(refused).replace(str(path), "MAP")
        return
    except Exception as fault:  # noqa: BLE001  that is what is looked for
        at = traceback.extract_tb(fault.__traceback__)[-1]
        yield "internal", f"{type(fault).__name__} in {Path(at.filename).name}:{at.lineno}: {fault}"
        return
    report, layout = project.report, project.city.layout
    for failure in report["failures"]:
        if " failed: " in failure["error"]:  # a step of the program; faults of objects are named
            yield "internal", failure["error"][:300]
    for name, check in report["checks"].items():
        if not check["ok"]:
            yield f"check {name}", f"{check['value']}, {check.get('ids', [])[:3]}"
    (table,) = report["fidelity"]
    if table.get("error"):
        yield "fidelity", table["error"]
    for tag, row in table["tags"].items():
        for which in row["which"]:
            if which[1] == "departed" or (which[1] == "lost" and not which[-1]):
                yield f"{which[1]} {tag}", " ".join(map(str, which))
    for table_name in ("buildings", "parts", "roads", "areas", "lines", "points"):
        ids = getattr(layout, table_name)["id"].to_numpy()
        if len(set(ids.tolist())) != len(ids):
            yield "ids", f"{table_name}: {len(ids) - len(set(ids.tolist()))} ids twice"


def of_seed(task: tuple[int, int]) -> tuple[int, list[tuple[str, str]], int]:
    """Return a seed, the faults of its map and how many objects it has."""
    seed, lod = task
    town = random_map(seed)
    return seed, faults(town, lod), len(town.drawn)


def reduced(seed: int, lod: int, kind: str | None = None) -> tuple[Map, list[int]]:
    """Drop objects of a map while a fault of the same kind remains."""
    town = random_map(seed)
    kept = list(range(len(town.drawn)))
    wanted = kind or faults(town, lod)[0][0]

    def fails(chosen: list[int]) -> bool:
        return any(found == wanted for found, _ in faults(town, lod, chosen))

    return town, _fewest(kept, fails)


def _fewest(kept: list[int], fails: Callable[[list[int]], bool]) -> list[int]:
    """Return a list from which no piece can be dropped so that it still fails (ddmin)."""
    piece = max(1, len(kept) // 2)
    while True:
        dropped = False
        for start in range(0, len(kept), piece):
            rest = kept[:start] + kept[start + piece :]
            if rest and fails(rest):
                kept, dropped = rest, True
                break
        if not dropped:
            if piece == 1:
                return kept
            piece = max(1, piece // 2)


def main() -> int:
    """Build maps of seeds, print what fails and count it."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--seeds", default="0:100", help="FIRST:END")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--lod", type=int, default=0, choices=LODS)
    parser.add_argument("--out", type=Path, help="a line of JSON per seed")
    parser.add_argument("--reduce", type=int, help="seed of a map to make small")
    parser.add_argument("--kind", help="fault that is to remain in it")
    args = parser.parse_args()
    if args.reduce is not None:
        town, kept = reduced(args.reduce, args.lod, args.kind)
        print(town.text(kept))
        for kind, about in faults(town, args.lod, kept):
            print(f"{kind}: {about}", file=sys.stderr)
        return 0
    first, end = map(int, args.seeds.split(":"))
    counts: Counter[str] = Counter()
    clean = 0
    with ProcessPoolExecutor(args.jobs) as pool:
        tasks = [(seed, args.lod) for seed in range(first, end)]
        for seed, found, objects in pool.map(of_seed, tasks, chunksize=4):
            clean += not found
            counts.update({kind for kind, _ in found})
            if found:
                some = "; ".join(f"{kind}: {about}"[:160] for kind, about in found[:4])
                print(seed, objects, some, flush=True)
            if args.out:
                with args.out.open("a") as lines:
                    lines.write(json.dumps([seed, found]) + "\n")
    print(f"{clean} of {end - first} maps without a fault")
    for kind, count in counts.most_common():
        print(f"{count:5d} maps: {kind}")
    return 0 if clean == end - first else 1


if __name__ == "__main__":
    sys.exit(main())
