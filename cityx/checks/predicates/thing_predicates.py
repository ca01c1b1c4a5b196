"""What predicates count and measure: the things of one family in a city, as columns."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city import City
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.ids import id_text

UInt64Array = NDArray[np.uint64]


class CannotTell(Exception):
    """What a predicate asks of a city is not known of it yet; the text says what is missing."""


class Absent(CannotTell):
    """A predicate names things that are absent, so it is not met."""


@dataclass(frozen=True)
class Layer:
    """The things of one kind, n of them; subclasses measure the attributes of their family.

    Attributes
    ----------
    city
        Where they are.
    kind
        What they are called.
    """

    city: City
    kind: str

    @property
    def ids(self) -> UInt64Array:
        """(n,) stable ids."""
        raise NotImplementedError

    @property
    def shapes(self) -> NDArray[Any]:
        """(n,) shapely geometries on the ground, metres."""
        raise NotImplementedError

    @property
    def grounds(self) -> NDArray[Any]:
        """(n,) ground that each covers; of streets their carriageways."""
        return self.shapes

    @property
    def names(self) -> Mapping[str, NDArray[Any]]:
        """Columns of words, (n,), by which a thing can be called."""
        return {}

    @property
    def weights(self) -> FloatArray:
        """(n,) how much each counts in statistics and shares: 1, of streets their length."""
        return np.ones(len(self.ids))

    @property
    def remark(self) -> str:
        """What a reader of the evidence should know of all of them, or ""."""
        return ""

    def number(self, attribute: str) -> FloatArray:
        """Return (n,) numbers of an attribute."""
        raise CannotTell(f"the city has no {attribute} of a {self.kind}")

    def has(self, attribute: str, word: str) -> BoolArray:
        """Return (n,) which have a word for an attribute."""
        raise CannotTell(f"the city has no {attribute} of a {self.kind} ({word})")

    def applies(self, attribute: str) -> BoolArray:
        """(n,) whether an attribute says anything of a thing; others are in no share of it."""
        del attribute
        return np.ones(len(self.ids), bool)

    def units(self, rows: IntArray) -> IntArray:
        """(r,) number of the thing that each row is part of: rows themselves but for streets."""
        return np.arange(len(rows))

    def members(self, rows: IntArray) -> UInt64Array:
        """Return the ids in the city's tables that make up some of the things."""
        return self.ids[rows]

    def called(self, word: str) -> BoolArray:
        """(n,) which things a word names: by id, name, source or the last part of the source.

        Several ids in a row, with blanks between, name all of them.
        """
        several = word.split(" ")
        if len(several) > 1 and all(map(_is_hexadecimal, several)):
            return np.isin(self.ids, np.array([int(one, 16) for one in several], np.uint64))
        found = self.ids == np.uint64(int(word, 16)) if _is_hexadecimal(word) else (
            np.zeros(len(self.ids), bool)
        )  # fmt: skip
        for column in self.names.values():
            text = column.astype(str)
            found = found | (text == word) | np.char.endswith(text, f"/{word}")
        return np.asarray(found, bool)


@dataclass(frozen=True)
class TableLayer(Layer):
    """Things that are rows of a table of the layout."""

    @property
    def _table(self) -> Any:
        """Their rows."""
        raise NotImplementedError

    @cached_property
    def ids(self) -> UInt64Array:
        """(n,) ids."""
        return np.asarray(self._table["id"].to_numpy(np.uint64))

    @cached_property
    def shapes(self) -> NDArray[Any]:
        """(n,) footprints or centrelines."""
        return np.asarray(self._table.geometry.to_numpy(), object)

    @cached_property
    def names(self) -> Mapping[str, NDArray[Any]]:
        """Names and sources."""
        return {"name": column(self._table, "name"), "source": column(self._table, "source")}


def _is_hexadecimal(word: str) -> bool:
    return len(word) == 16 and all(sign in "0123456789abcdef" for sign in word)


@dataclass(frozen=True)
class Selection:
    """Some things of a layer.

    Attributes
    ----------
    layer
        Where they come from.
    rows
        (r,) rows of the layer.
    text
        How the predicate calls them.
    missing
        Things that were meant and are there no more.
    """

    layer: Layer
    rows: IntArray
    text: str
    missing: int = 0

    @cached_property
    def shapes(self) -> NDArray[Any]:
        """(r,) geometries."""
        return np.asarray(self.layer.shapes[self.rows], object)

    @property
    def grounds(self) -> NDArray[Any]:
        """(r,) ground that each covers."""
        return np.asarray(self.layer.grounds[self.rows], object)

    @property
    def ids(self) -> UInt64Array:
        """(r,) ids."""
        return self.layer.ids[self.rows]

    @cached_property
    def count(self) -> int:
        """Number of things; streets are counted from end to end."""
        return len(np.unique(self.layer.units(self.rows)))

    def where(self, kept: BoolArray) -> Selection:
        """Return those of a mask over the rows."""
        return Selection(self.layer, self.rows[kept], self.text, self.missing)

    def examples(self, most: int = 4) -> str:
        """Name some of them."""
        names = self.layer.names
        found = []
        for row in self.rows[:most].tolist():
            words = [str(column[row]) for column in names.values() if str(column[row])]
            found.append(words[0] if words else id_text(int(self.layer.ids[row])))
        more = len(self.rows) - most
        return ", ".join(found) + (f" and {more} more" if more > 0 else "")


def column(table: Any, name: str) -> NDArray[Any]:
    """Return a column of words of a table, (n,) str."""
    return np.asarray(table[name].to_numpy().astype(str))


def union(shapes: NDArray[Any]) -> Any:
    """Return the union of shapes, mended where they are no valid polygons."""
    return shapely.union_all(shapely.make_valid(shapes))
