"""Tagged shapes: what a source found, with attributes in the words of OpenStreetMap."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from json.encoder import encode_basestring as _quote
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.geometry.arrays import IntArray
from cityx.ids import stable_id
from cityx.sources.features.clipping import Box, clip_lines, clip_polygons

Tags = dict[str, str]
# Tag by which any source may say the layout's own word for the kind of a feature.
KIND = "cityx:kind"

MIN_AREA = 1.0  # square metres; less is a slip of the pen
MIN_SOLID = 0.05  # square metres; monuments are modelled in small parts


@dataclass(frozen=True)
class Owner:
    """What a source knows by one name, and what it says of it.

    Attributes
    ----------
    key
        What names it at its source: ("osm", "way", 123).
    tags
        Its attributes, in the words of OpenStreetMap.
    more
        What tells a thing made of the element from the element itself, part of its id.
    """

    key: tuple[object, ...]
    tags: Tags
    more: tuple[str, ...] = ()

    @property
    def source(self) -> str:
        """Provenance as the tables write it."""
        return "/".join(map(str, self.key))

    def id(self, *more: object) -> int:
        """Return the stable id of the element, or of a thing that belongs to it."""
        return stable_id(*self.key, *self.more, *more)

    def numbered(self, k: int, *more: object) -> int:
        """Return the id of its k-th piece; the first has the element's own id."""
        return self.id(*more, k) if k else self.id(*more)


@dataclass(frozen=True)
class Tagged:
    """Shapes and who owns them, n shapes.

    Attributes
    ----------
    shapes
        (n,) polygons, lines or points, scene frame, metres; polygons are valid.
    owner
        (n,) index into ``owners``.
    k
        (n,) number of the shape among those of its owner.
    """

    shapes: NDArray[Any]
    owner: IntArray
    k: IntArray
    owners: list[Owner]

    def take(self, rows: Any) -> Tagged:
        """Return some of the shapes."""
        return Tagged(self.shapes[rows], self.owner[rows], self.k[rows], self.owners)

    def tags(self) -> list[Tags]:
        """(n,) tags of each shape's owner."""
        return [self.owners[index].tags for index in self.owner.tolist()]

    def ids(self, *more: object) -> NDArray[np.uint64]:
        """(n,) stable ids."""
        pairs = zip(self.owner.tolist(), self.k.tolist(), strict=True)
        found = [self.owners[owner].numbered(k, *more) for owner, k in pairs]
        return np.array(found, np.uint64)

    def sources(self) -> list[str]:
        """(n,) provenance."""
        return [self.owners[index].source for index in self.owner.tolist()]

    def columns(self) -> dict[str, Any]:
        """Return what every table of the layout keeps of its rows: id, source, name and tags."""
        tags, of = distinct(self.tags())
        names = [own.get("name", "") for own in tags]
        texts = [tags_text(own) for own in tags]
        return {
            "id": self.ids(),
            "source": self.sources(),
            "name": [names[k] for k in of.tolist()],
            "tags": [texts[k] for k in of.tolist()],
        }


def named_note(what: str, names: Iterable[str]) -> str:
    """Return a note on things of a kind with their count and names, "" where there are none."""
    own = list(names)
    return f"map: {len(own)} {what}: {', '.join(own)}" if own else ""


@dataclass
class Report:
    """What could not be used, counted and named while a map is read."""

    counts: dict[str, int] = field(default_factory=dict)
    failures: list[tuple[int, str]] = field(default_factory=list)
    named: dict[str, list[str]] = field(default_factory=dict)

    def name(self, what: str, owner: Owner) -> None:
        """Count something of a kind, with the name that its source has for it."""
        self.named.setdefault(what, []).append(owner.source)

    def notes(self) -> list[str]:
        """Return a sentence for each kind that was named, with the names."""
        return [named_note(what, sorted(set(names))) for what, names in sorted(self.named.items())]

    def count(self, what: str, number: int = 1) -> None:
        """Count something."""
        if number:
            self.counts[what] = self.counts.get(what, 0) + number

    def fail(self, object_id: int, why: str) -> None:
        """Name an object that could not be read."""
        self.failures.append((object_id, why))


def number_pieces(owner: IntArray) -> IntArray:
    """Count the rows of each owner from zero in their order; `owner` is ascending."""
    first = np.ones(len(owner), bool)
    first[1:] = owner[1:] != owner[:-1]
    begin = np.flatnonzero(first)
    return np.arange(len(owner)) - np.repeat(begin, np.diff(np.append(begin, len(owner))))


def joined(*given: Tagged) -> Tagged:
    """Put tagged shapes together."""
    shift = np.cumsum([0, *(len(item.owners) for item in given)])
    return Tagged(
        np.concatenate([item.shapes for item in given]),
        np.concatenate([item.owner + shift[i] for i, item in enumerate(given)]).astype(np.int64),
        np.concatenate([item.k for item in given]).astype(np.int64),
        [owner for item in given for owner in item.owners],
    )


def told_apart(things: Tagged, word: str, *others: Tagged) -> Tagged:
    """Give things ids of their own where their element is one of the others as well.

    Parameters
    ----------
    word
        What the things are; it becomes part of the ids.
    others
        Things that keep the ids of their elements.
    """
    taken = {
        (other.owners[row].key, other.owners[row].more)
        for other in others
        for row in np.unique(other.owner).tolist()
    }
    owners = [
        replace(owner, more=(*owner.more, word)) if (owner.key, owner.more) in taken else owner
        for owner in things.owners
    ]
    return replace(things, owners=owners)


def clipped_polygons(outlines: Tagged, box: Box, *, least: float = MIN_AREA) -> Tagged:
    """Cut outlines at the border of the site; pieces of `least` square metres and less go."""
    polygons, row = polygons_of(clip_polygons(outlines.shapes, box), least=least)
    owner = outlines.owner[row]
    order = np.lexsort((np.arange(len(owner)), outlines.k[row], owner))
    return Tagged(polygons[order], owner[order], number_pieces(owner[order]), outlines.owners)


def clipped_lines(lines: Tagged, box: Box) -> Tagged:
    """Cut lines at the border of the site; see `clip_lines`."""
    pieces, row = clip_lines(lines.shapes, box)
    owner = lines.owner[row]
    return Tagged(pieces, owner, number_pieces(owner), lines.owners)


def tag(shapes: Sequence[Any] | NDArray[Any], owners: list[Owner]) -> Tagged:
    """Give each owner one shape."""
    held = np.empty(len(owners), object)
    held[:] = list(shapes)
    return Tagged(held, np.arange(len(owners)), np.zeros(len(owners), np.int64), owners)


def tag_by_place(shapes: NDArray[Any], tags: Sequence[Tags], key: tuple[object, ...]) -> Tagged:
    """Name each shape by its place, so that what changes elsewhere changes no id.

    Parameters
    ----------
    shapes
        (n,) scene frame, metres.
    tags
        Of each.
    key
        First words of every provenance.
    """
    along = shapely.get_dimensions(shapes) == 1
    spots = shapely.point_on_surface(shapes)
    spots[along] = shapely.line_interpolate_point(shapes[along], 0.5, normalized=True)
    places = np.round(shapely.get_coordinates(spots), 2) + 0.0
    owners = [
        Owner((*key, f"{x:.2f},{y:.2f}"), own)
        for (x, y), own in zip(places.tolist(), tags, strict=True)
    ]
    return tag(shapes, owners)


def nothing() -> Tagged:
    """Return no shapes."""
    return tag([], [])


def polygons_of(shapes: NDArray[Any], *, least: float = MIN_AREA) -> tuple[NDArray[Any], IntArray]:
    """Return the valid polygons within geometries and the row of each, largest first per row.

    What is invalid is repaired; pieces of `least` square metres and less are dropped.
    """
    shapes = np.asarray(shapes, object)
    # A z or a repeated point never comes from a map file, so validity is all there is to mend.
    wrong = np.flatnonzero(~shapely.is_valid(shapes) & ~shapely.is_missing(shapes))
    if len(wrong):
        shapes = shapes.copy()
        shapes[wrong] = shapely.make_valid(shapes[wrong], method="structure")
    pieces, row = shapely.get_parts(shapes, return_index=True)
    if (shapely.get_type_id(pieces) > 3).any():
        pieces, inner = shapely.get_parts(pieces, return_index=True)
        row = row[inner]
    area = shapely.area(pieces)
    kept = (shapely.get_type_id(pieces) == 3) & (area > least)
    pieces, row, area = pieces[kept], row[kept], area[kept]
    if len(np.unique(row)) < len(row):
        box = shapely.bounds(pieces)
        order = np.lexsort((box[:, 1], box[:, 0], -np.round(area, 3), row))
        pieces, row = pieces[order], row[order]
    return pieces, row.astype(np.int64)


def distinct(tags: Sequence[Tags]) -> tuple[list[Tags], IntArray]:
    """Return tags that differ, each once, and which of them each of n things has, (n,)."""
    number: dict[tuple[tuple[str, str], ...], int] = {}
    of = [number.setdefault(tuple(own.items()), len(number)) for own in tags]
    return [dict(items) for items in number], np.array(of, np.int64)


def tags_text(tags: Tags) -> str:
    """Return tags as the JSON object that the tables keep, keys in order; the kind is a column."""
    quoted = [f"{_quote(key)}: {_quote(tags[key])}" for key in sorted(tags) if key != KIND]
    return f"{{{', '.join(quoted)}}}"
