"""A path or an area that somebody drew beside a sentence: "plant ten limes along this"."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple

import shapely

from cityx.city import City
from cityx.errors import UsageError
from cityx.geometry.polygons import corners_of
from cityx.ids import id_text
from cityx.language import Edit, Selector
from cityx.language.references.selecting import Open, choose
from cityx.protocol.serving import Slots
from cityx.sources.blend_curves import BlendCurves

NAME = "drawn path"  # of the path, for who goes along it
MOST = 500  # points
FARTHEST = 100_000.0  # metres from the origin
LEAST_AREA = 1.0  # square metres
BESIDE = 2.0  # metres to either side of a path, where things stand along it
REACH = 10.0  # metres to either side within which what stands is meant by "along this"
APART = 8.0  # metres along a path from one thing to the next, where no number is said
# Words by which a sentence means what is drawn beside it.
PHRASE = re.compile(
    r"\b(?:along|on|beside|by|in|inside|within|into|at|around|through|across|over)\s+"
    r"(?:(?:this|the drawn)\s+(?:path|line|way|route|curve|area|place|polygon|shape)\b"
    r"|this(?=\s*(?:$|[,.;:!?]|and\b|then\b|but\b)))"
    r"|\b(?:right\s+)?here\b",
    re.IGNORECASE,
)

ONE = re.compile(r"\b(?:an?|another|one)\b", re.IGNORECASE)


@dataclass(frozen=True)
class Drawn:
    """A path, or the edge of an area.

    Attributes
    ----------
    points
        (k, 2) metres east and north of the city's origin.
    area
        Whether they go round an area.
    """

    points: tuple[tuple[float, float], ...]
    area: bool = False

    @property
    def curves(self) -> BlendCurves:
        """The path, or the edge, as a curve that has a name."""
        line = (*self.points, self.points[0]) if self.area else self.points
        return BlendCurves(Path("drawn"), {NAME: (line,)}, {}, {NAME: "CURVE"})

    def region(self, reach: float) -> Any:
        """Return the area, or the ground so many metres to either side of the path."""
        if self.area:
            return shapely.make_valid(shapely.Polygon(self.points))
        return shapely.LineString(self.points).buffer(reach, cap_style="flat")


def drawn_of(points: Sequence[Sequence[float]], *, area: bool) -> Drawn:
    """Return what was drawn.

    Raises
    ------
    UsageError
        If it is no path and no area.
    """
    least = 3 if area else 2
    if not least <= len(points) <= MOST or any(len(point) != 2 for point in points):
        kind = "An area" if area else "A path"
        raise UsageError(f"{kind} is drawn by {least} to {MOST} points of two numbers.")
    if not all(math.isfinite(v) and abs(v) <= FARTHEST for point in points for v in point):
        raise UsageError(f"Points are metres from the origin, at most {FARTHEST:g} away.")
    found = Drawn(tuple((float(x), float(y)) for x, y in points), area)
    size = found.region(0).area if area else shapely.LineString(found.points).length
    if size < (LEAST_AREA if area else 0.1):
        raise UsageError(f"What is drawn is too small: {size:.2f} {'m2' if area else 'm'}.")
    return found


class Placed(NamedTuple):
    """What was drawn, and where a sentence speaks of it.

    Attributes
    ----------
    drawn
        The path or area.
    text
        The sentence without the words for it.
    places
        Letters of that text after which they stood.
    """

    drawn: Drawn
    text: str
    places: tuple[int, ...]


def placed_in(text: str, drawn: Drawn | None) -> Placed | None:
    """Return a sentence without the words for what was drawn; None if it does not speak of it."""
    if drawn is None:
        return None
    rest, places, end = "", [], 0
    for found in PHRASE.finditer(text):
        rest += text[end : found.start()].rstrip()
        places.append(len(rest))
        end = found.end()
    return Placed(drawn, rest + text[end:], tuple(places)) if places else None


def with_drawn(
    changes: Sequence[tuple[Edit, Slots]], placed: Placed, city: City
) -> list[tuple[Edit, Slots]]:
    """Give the changes that a sentence says of what was drawn their place, or the objects there.

    Raises
    ------
    Open
        If nothing of what a change is about is there.
    """
    starts = [max((edit.span[0] for edit, _ in changes if edit.span[0] <= place), default=-1)
              for place in placed.places]  # fmt: skip
    return [
        _here(edit, slots, placed, city) if edit.span[0] in starts else (edit, slots)
        for edit, slots in changes
    ]


def _here(edit: Edit, slots: Slots, placed: Placed, city: City) -> tuple[Edit, Slots]:
    drawn, text = placed.drawn, placed.text[slice(*edit.span)]
    if edit.target is not None and "objects" in slots:
        chosen = choose(edit.target, city)
        middle = shapely.centroid(chosen.shapes)
        inside = shapely.contains(drawn.region(REACH), middle)
        there = {id_text(number) for number in chosen.layer.ids[chosen.rows[inside]].tolist()}
        kept = tuple(one for one in slots["objects"][0] if one in there)
        if not kept:
            what = "area" if drawn.area else "path"
            raise Open(f"No {edit.target.kind.replace('_', ' ')} stands at the {what} drawn.")
        narrowed = replace(edit, target=Selector(edit.target.kind, ids=kept))
        return narrowed, {**slots, "objects": (kept,)}
    if edit.verb in ("add_agent", "add_traffic"):
        return edit, {**slots, "path": (NAME,)}
    more: dict[str, tuple[Any, ...]] = {"ground": (corners_of(drawn.region(BESIDE)),)}
    if not drawn.area and "count" not in slots and not ONE.search(text):
        length = shapely.LineString(drawn.points).length
        more["count"] = (max(int(length // APART), 1),)
    return edit, {**slots, **more}
