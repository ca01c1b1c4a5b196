"""Listing: where things of a changed city are, as a request asks: "list where the benches are"."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely

from cityx.city import City
from cityx.ids import id_text
from cityx.language import Brief, Edit
from cityx.language.references.ranking import sizes_of
from cityx.language.references.resolved_changes import LIST
from cityx.language.references.selecting import Open, choose

SHOWN = 6  # things that a line names


def told_of(brief: Brief, city: City, before: City | None) -> list[dict[str, Any]]:
    """Return what a request asks to be told of a city.

    Parameters
    ----------
    brief
        The request; of things of a kind that it adds itself those that are new are told.
    city, before
        The city, and what it was before the request.

    Returns
    -------
    lists
        For each list "text", the words; "objects", each with "id", "name", "kind", the middle
        "x", "y" (metres, scene frame) and the "size" in words; and "said", why there are none.
    """
    return [
        _listed(edit, brief, city, before) for edit in brief.edits if edit.verb == LIST
    ]  # fmt: skip


def _listed(edit: Edit, brief: Brief, city: City, before: City | None) -> dict[str, Any]:
    text = brief.text[slice(*edit.span)].rstrip(".!? ")
    assert edit.target is not None
    try:
        chosen = choose(edit.target, city)
    except Open as error:
        return {"text": text, "objects": [], "said": error.question.text, "open": True}
    if before is not None and _adds(edit.target.kind, brief):
        try:
            known = choose(edit.target, before).ids
        except Open:
            known = np.zeros(0, np.uint64)
        chosen = chosen.where(~np.isin(chosen.ids, known))
    at = shapely.get_coordinates(shapely.centroid(chosen.shapes))
    known_names = chosen.layer.names.get("name")
    names = [""] * len(chosen.rows) if known_names is None else known_names[chosen.rows]
    found = [
        {"id": id_text(int(number)), "name": str(name), "kind": chosen.layer.kind,
         "x": round(float(x), 2), "y": round(float(y), 2), "size": size}
        for number, name, (x, y), size in zip(chosen.ids, names, at, sizes_of(chosen), strict=True)
    ]  # fmt: skip
    none = "There is none." if before is None else "None was added."
    return {"text": text, "objects": found, "said": "" if found else none}


def in_a_line(told: dict[str, Any]) -> str:
    """Return one list of `told_of` in a line: "2: Rose Street, 3f2a"."""
    if told["said"]:
        return str(told["said"])
    named = [one["name"] or one["id"] for one in told["objects"][:SHOWN]]
    more = len(told["objects"]) - len(named)
    return f"{len(told['objects'])}: {', '.join(named)}{f' and {more} more' if more else ''}"


def _adds(kind: str, brief: Brief) -> bool:
    """Return whether a request adds things of a kind."""
    return any(
        kind in (dict(edit.change).get("element"), dict(edit.change).get("building.type"))
        for edit in brief.edits
    )
