"""Paths named in words: a drawn curve, a way of the map, or a loop around a place."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.checks.predicates.places import places_of
from cityx.checks.predicates.thing_predicates import column
from cityx.checks.predicates.words import LANDS, MAIN, PATHS, ROADS, WHOLE
from cityx.city.city import City
from cityx.city.layout import CURVE
from cityx.errors import ActionFailed, nearest
from cityx.geometry.arrays import FloatArray
from cityx.motion.feasible import check_walk

ROUTE = "route"  # kind of a line that somebody goes along and that is no thing itself
JOINED = 0.5  # metres between the ends of a path that is closed
BESIDE = 30.0  # metres from a place within which a path lies around or along it
LEAST_BESIDE = 40.0  # metres of a path that must lie there
OUTSTANDING = 0.5  # of the longest: a second path as long leaves open which is meant
MOST_NAMED = 5  # candidates that a refusal names
STREETS = ("main_street", "street", "road", "avenue")
# Ways across an open place that no path crosses.
MARGIN = 1.0  # metres from its edges
LEAST_ACROSS = 8.0  # metres of such a way
TURNS = 4  # directions that are tried, from that of its longer or shorter side on
ASIDE = (3.0, -3.0, 6.0, -6.0)  # metres off its middle, past a fountain there
_FILLERS = re.compile(
    r"\b(the|an?|paths?|ways?|walk|track|footpath|trail|along|around|round|about|through|on|in|of|"
    r"by|beside|past|down|up|across|at|over)\b"
)


@dataclass(frozen=True)
class Path:
    """A path through a city.

    Attributes
    ----------
    name
        What it is called.
    points
        (k, 2) float64, metres; of a closed one the first is not repeated.
    closed
        Whether it ends where it began.
    street
        Whether it is the centreline of a street, beside which people walk.
    roads
        Rows of ``Layout.roads`` it is made of, () for a curve.
    width
        Metres that it offers; 0 when nothing says it.
    """

    name: str
    points: FloatArray
    closed: bool
    street: bool = False
    roads: tuple[int, ...] = ()
    width: float = 0.0

    @property
    def line(self) -> Any:
        """The path as a shapely line, closed if it is."""
        xy = np.vstack([self.points, self.points[:1]]) if self.closed else self.points
        return shapely.LineString(xy)


def find_path(city: City, words: str) -> Path:
    """Find the path that words name.

    Parameters
    ----------
    city
        The city.
    words
        The name, id or source of a curve or a way ("loop1"), or words for it ("around the park",
        "along the main street").

    Raises
    ------
    ActionFailed
        If they name no path, or several.
    """
    said = words.strip()
    named = _curves_called(city, said) or _ways_called(city, said)
    if named:
        return _single(said, named)
    core = re.findall(r"[a-z0-9_]+", _FILLERS.sub(" ", said.lower()))
    word = "_".join(core)
    if word in STREETS or word in {f"{name}s" for name in STREETS}:
        return _main_street(city, said)
    if word.removesuffix("s") in LANDS or word in LANDS:
        land = word if word in LANDS else word.removesuffix("s")
        return _beside(city, said, places_of(city, land), land)
    inner = " ".join(core)
    if core and inner != said.lower():
        # The layout knows names with capitals: "along High Street".
        named = _curves_called(city, inner) or _ways_called(city, inner)
        if named:
            return _single(said, named)
    lands = _lands_called(city, inner) if core else np.zeros(0, object)
    if len(lands):
        return _beside(city, said, lands, inner)
    known = _known(city)
    hint = nearest(inner or said, known)
    if not hint:
        hint = f" It knows {_listed(known)}." if known else " It has no curve and no path."
    raise ActionFailed(
        f'path = "{words}" names no curve, no way and no place of the city.{hint} Draw a curve, '
        'give points, or say "around the park" or "along the main street".'
    )


def path_of_line(name: str, line: Any, **known: Any) -> Path:
    """Make a path of a line; one whose ends meet is closed."""
    xy = shapely.get_coordinates(line)
    closed = len(xy) > 3 and float(np.hypot(*(xy[0] - xy[-1]))) <= JOINED
    return Path(name, xy[:-1] if closed else xy, closed, **known)


def _called(names: Iterable[NDArray[Any]], word: str) -> NDArray[np.bool_]:
    found: NDArray[np.bool_] | None = None
    for texts in names:
        low = np.char.lower(texts.astype(str))
        hit = (low == word.lower()) | np.char.endswith(low, f"/{word.lower()}")
        found = hit if found is None else found | hit
    return np.zeros(0, bool) if found is None else found


def _ids(table: Any) -> NDArray[Any]:
    return np.array([f"{number:016x}" for number in table["id"].tolist()], str)


def _curves_called(city: City, word: str) -> list[Path]:
    table = city.layout.lines
    table = table[table["kind"].isin((CURVE, ROUTE)).to_numpy()]
    if not word or not len(table):
        return []
    hit = _called([column(table, "source"), _ids(table)], word)
    return [path_of_line(word, line) for line in table.geometry.to_numpy()[hit]]


def _ways_called(city: City, word: str) -> list[Path]:
    table = city.layout.roads
    known = table["kind"].isin((*ROADS, *PATHS)).to_numpy()
    if not word or not known.any():
        return []
    names = [column(table, "name"), column(table, "source"), _ids(table)]
    return _merged(city, np.flatnonzero(_called(names, word) & known), word)


def _merged(city: City, rows: NDArray[np.int64], name: str) -> list[Path]:
    """Join ways end to end into paths, longest first."""
    table = city.layout.roads
    if not len(rows):
        return []
    shapes = table.geometry.to_numpy()[rows]
    kinds = column(table, "kind")[rows]
    joined = shapely.get_parts(shapely.line_merge(shapely.union_all(shapes)))
    found = []
    for line in joined:
        of = shapely.covers(shapely.buffer(line, 0.01), shapes)
        mine = rows[of] if of.any() else rows
        street = not np.isin(kinds[of] if of.any() else kinds, PATHS).all()
        width = table["width"].to_numpy(float)[mine]
        known = width[np.isfinite(width) & (width > 0)]
        found.append(
            path_of_line(name, line, street=street, roads=tuple(mine.tolist()),
                         width=float(known.min()) if len(known) else 0.0)
        )  # fmt: skip
    return sorted(found, key=lambda path: -path.line.length)


def _single(said: str, found: list[Path]) -> Path:
    """Return the one path meant; pieces that are short beside the longest do not count."""
    long = [p for p in found if p.line.length >= OUTSTANDING * found[0].line.length]
    if len(long) > 1:
        places = _listed([f"one of {p.line.length:.0f} m at {_at(p)}" for p in long])
        raise ActionFailed(f'path = "{said}" names {len(long)} paths that do not meet: {places}.')
    return found[0]


def _at(path: Path) -> str:
    x, y = path.points[len(path.points) // 2]
    return f"({x:.0f}, {y:.0f})"


def _main_street(city: City, said: str) -> Path:
    """Return the longest street of the highest class; streets go on through junctions."""
    table = city.layout.roads
    kinds, names = column(table, "kind"), column(table, "name")
    for kind in (k for k in MAIN if (kinds == k).any()):
        rows = np.flatnonzero(kinds == kind)
        streets = [
            path
            for name in np.unique(names[rows]).tolist()
            for path in _merged(city, rows[names[rows] == name], name or said)
        ]
        return max(streets, key=lambda path: path.line.length)
    raise ActionFailed(
        f'path = "{said}": the city has no main street. It has {_listed(_known(city))}.'
    )


def _lands_called(city: City, word: str) -> NDArray[Any]:
    table = city.layout.areas
    if not len(table):
        return np.zeros(0, object)
    hit = _called([column(table, "name"), column(table, "source"), _ids(table)], word)
    return np.asarray(table.geometry.to_numpy()[hit])


def _beside(city: City, said: str, places: NDArray[Any], word: str) -> Path:
    """Return the path around some places, or the one that runs beside or through them."""
    if not len(places):
        raise ActionFailed(f'path = "{said}": the city has no {word}.{_lands(city)}')
    table = city.layout.roads
    rows = np.flatnonzero(table["kind"].isin(PATHS).to_numpy())
    ways = [path for name in np.unique(column(table, "name")[rows]).tolist()
            for path in _merged(city, rows[column(table, "name")[rows] == name],
                                name or f"the path at the {word}")]  # fmt: skip
    lines = city.layout.lines
    drawn = lines[lines["kind"].isin((CURVE, ROUTE)).to_numpy()]
    ways += [
        path_of_line(source.rpartition("/")[2], line)
        for source, line in zip(column(drawn, "source"), drawn.geometry, strict=True)
    ]
    near = shapely.union_all(shapely.buffer(places, BESIDE))
    run = np.array([shapely.length(shapely.intersection(path.line, near)) for path in ways])
    rings = [p for p, reach in zip(ways, run, strict=True) if p.closed and reach >= LEAST_BESIDE]
    if len(rings) == 1:
        return rings[0]
    if len(rings) > 1:
        shown = _listed([f'"{p.name}" at {_at(p)}' for p in rings])
        raise ActionFailed(
            f'path = "{said}": {len(rings)} closed paths lie at the {word}: {shown}. Name one.'
        )
    long = [(reach, place) for place, reach in enumerate(run.tolist()) if reach >= LEAST_BESIDE]
    through = None if long else _across(city, places, word)
    if through is not None:
        return through
    if not long:
        raise ActionFailed(
            f'path = "{said}": no path lies within {BESIDE:g} m of the {word}. Draw a curve there, '
            f"or give points. The city has {_listed(_known(city))}."
        )
    return ways[max(long)[1]]


def _across(city: City, places: NDArray[Any], word: str) -> Path | None:
    """Return the longest straight way across the largest of some places that nothing blocks."""
    place = max(shapely.get_parts(places).tolist(), key=shapely.area)
    middle = shapely.get_coordinates(shapely.point_on_surface(place))[0]
    corners = shapely.get_coordinates(shapely.oriented_envelope(place))[:4]
    far = float(np.hypot(*(corners[2] - corners[0])))
    first = float(np.arctan2(*(corners[1] - corners[0])[::-1]))
    inner = shapely.buffer(place, -MARGIN)
    found: list[Any] = []
    for turn, aside in product(np.arange(TURNS) * np.pi / TURNS, (0.0, *ASIDE)):
        way = np.array([np.cos(first + turn), np.sin(first + turn)])
        at = middle + aside * np.array([-way[1], way[0]])
        ray = shapely.LineString([at - far * way, at + far * way])
        lines = shapely.get_parts(shapely.intersection(ray, inner))
        found += [line for line in lines.tolist() if line.length >= LEAST_ACROSS]
    for line in sorted(found, key=lambda line: -round(line.length, 2)):
        try:
            check_walk(city, line, word)
        except ActionFailed:
            continue
        return path_of_line(word, line)
    return None


def _lands(city: City) -> str:
    held = [word for word in WHOLE if len(places_of(city, word))]
    return f" It has {_listed(held)}." if held else ""


def _known(city: City) -> list[str]:
    """Return the names of curves, paths and streets, each once."""
    lines, roads = city.layout.lines, city.layout.roads
    drawn = lines[lines["kind"].isin((CURVE, ROUTE)).to_numpy()]
    names = [source.rpartition("/")[2] for source in drawn["source"].tolist()]
    return [name for name in dict.fromkeys([*names, *roads["name"].tolist()]) if name]


def _listed(names: list[str]) -> str:
    more = len(names) - MOST_NAMED
    return ", ".join(names[:MOST_NAMED]) + (f" and {more} more" if more > 0 else "")
