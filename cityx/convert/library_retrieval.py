"""Retrieval from the asset library by words."""

from __future__ import annotations

from typing import Annotated

import numpy as np

from cityx.assets.library.records import GROUPS
from cityx.assets.library.shelves import shelf_of, text_scores
from cityx.assets.styles.palettes import family_of
from cityx.city.city import City
from cityx.city.mesh import MeshBatch
from cityx.errors import ActionFailed
from cityx.places.profiles import profile_of
from cityx.protocol import InputFiles, Port, action
from cityx.protocol.parameters import Choice


@action(
    "convert/library_retrieval-v1",
    classname="Library_retrieval",
    kind="retrieval",
    extension=True,
    gives=(Port("asset", "complex_geometry", "library_asset"),),
    limits=[
        "Words are matched by a small thesaurus and by letters, not by a learned model.",
        "Without a library among the input files it knows 128 buildings alone.",
    ],
    labels=("asset", "library", "search", "retrieval"),
)
def library_retrieval(
    city: City,
    inputs: InputFiles,
    description: Annotated[str, Port("description", "string", "description")],
    *,
    group: Annotated[str, Choice(*GROUPS)] = "buildings",
) -> MeshBatch:
    """Retrieve the asset of the library that a few words describe best, as one mesh.

    Parameters
    ----------
    city
        City whose style a library grown on demand has.
    inputs
        Files the user handed in; the first library among them is used.
    description
        Words such as "tall glass office building".
    group
        Group it must belong to.
    """
    style = family_of(city.style, profile_of(city.frame).buildings.family)
    shelf = shelf_of(inputs, style)
    rows = np.flatnonzero(shelf.catalogue["group"] == group)
    if not len(rows):
        raise ActionFailed(f"The library holds no {group}.")
    score = text_scores(shelf, description)[rows]
    best = rows[np.lexsort((rows, -score))[0]]
    return shelf.models([best]).realised(0)
