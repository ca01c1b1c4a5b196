"""The bodies of a city for physics engines: ``city_bodies.npz`` and what its arrays mean.

The text beside the arrays, ``city_bodies.json``, tells the words that numbers stand for and the
meaning of every array, so that a reader in any language needs nothing else.
"""

from __future__ import annotations

import json
import os
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np

from cityx.assets.colliders import bodies_of
from cityx.city.bodies import FORMS, MOTIONS, Bodies, Colliders
from cityx.city.store import View
from cityx.system.atomic import replaced
from cityx.system.tables import table
from cityx.version import __version__

MEANINGS = dict(table("outputs/bodies", str))


def write_bodies(view: View, path: str | os.PathLike[str]) -> Bodies:
    """Write the bodies of a city.

    Parameters
    ----------
    view
        The city as engines see it.
    path
        File to make, ``city_bodies.npz``; the text gets the suffix ``.json``. Both are replaced
        when complete.

    Returns
    -------
    bodies
        What was written.
    """
    path = Path(path)
    bodies = bodies_of(view.scene, view.tracks, view.moment)
    arrays = {**_arrays(bodies), **_arrays(bodies.colliders)}
    with replaced(path) as temporary:
        np.savez_compressed(temporary, **arrays)
    record = {
        "cityx": __version__,
        "name": view.name,
        "arrays": path.name,
        "gravity": [0.0, 0.0, -9.81],
        "projection": view.frame.projection,
        "attribution": list(view.attribution),
        "moment": view.moment,
        "bodies": bodies.count,
        "kinds": list(bodies.kinds),
        "forms": list(FORMS),
        "motions": list(MOTIONS),
        "meaning": MEANINGS,
    }
    with replaced(path.with_suffix(".json")) as temporary:
        temporary.write_text(json.dumps(record, indent=1))
    return bodies


def read_bodies(path: str | os.PathLike[str]) -> Bodies:
    """Read bodies that were written; see `write_bodies`."""
    path = Path(path)
    record = json.loads(path.with_suffix(".json").read_text())
    with np.load(path) as arrays:
        held = dict(arrays)
    shapes = Colliders(**{field.name: held.pop(field.name) for field in fields(Colliders)})
    return Bodies(**held, kinds=tuple(record["kinds"]), colliders=shapes)


def _arrays(value: Any) -> dict[str, Any]:
    held = {field.name: getattr(value, field.name) for field in fields(value)}
    return {name: array for name, array in held.items() if isinstance(array, np.ndarray)}
