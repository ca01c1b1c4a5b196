"""Streets on the curves of a drawing, each as the drawing says of it."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from itertools import groupby
from types import MappingProxyType
from typing import Any

import numpy as np

from cityx.city.city import City
from cityx.city.layout import CURVE, Layout
from cityx.city.sites import merged
from cityx.errors import ActionRejected, UsageError, nearest
from cityx.protocol import Port, action, encapsulation_of
from cityx.protocol.values import Lines, make_lines
from cityx.road.network.asphalt_street import asphalt_street
from cityx.road.network.curves import source_of, told
from cityx.road.network.highway import highway
from cityx.road.network.path import path
from cityx.road.network.railway import railway
from cityx.road.network.secondary_road import secondary_road

Generator = Callable[..., Layout]


def _by_kind(*generators: Generator) -> Mapping[str, Generator]:
    """Which generator builds a class; of two the first."""
    found: dict[str, Generator] = {}
    for generator in generators:
        kind = encapsulation_of(generator).parameter("kind")
        assert kind is not None
        for word in kind.choices:
            found.setdefault(word, generator)
    return MappingProxyType(found)


GENERATORS = _by_kind(asphalt_street, secondary_road, highway, path, railway)
OWN = "curve"  # parameter that names a curve, which the drawing is itself


@action(
    "road/drawn_streets-v1",
    limits=["Curves of which the drawing says no kind stay curves."],
    takes=(Port("curves", "line", role="curve", optional=True),),
    gives=(Port("streets", "scene_layout", "street_layout"),),
    labels=("sketch", "drawing", "curves", "geojson"),
)
def drawn_streets(city: City) -> City:
    """Build a street on every curve of the drawing that says of what kind it is to be."""
    faults: list[str] = []
    for said, curves in _groups(city):
        generator = GENERATORS.get(str(said.get("kind")))
        if generator is None:
            hint = nearest(str(said["kind"]), GENERATORS)
            faults.append(f'There is no kind "{said["kind"]}".{hint}')
            continue
        try:
            record = encapsulation_of(generator)
            args = record.arguments({**record.read(said), OWN: None})
            city = replace(city, layout=merged(city.layout, generator(city, curves, **args)))
        except (ActionRejected, UsageError) as error:
            faults.append(str(error))
    if faults:
        raise UsageError(told(faults))
    return city


def _groups(city: City) -> Iterator[tuple[dict[str, Any], Lines]]:
    """Yield the curves without a street, those of one description together."""
    rows = city.layout.lines
    rows = rows[rows["kind"] == CURVE]
    built = set(city.layout.roads["source"].tolist())
    sources = [source_of(number) for number in rows["id"].tolist()]
    open_ = [row for row, source in enumerate(sources) if source not in built]
    texts = rows["tags"].tolist()
    for text, group in groupby(sorted(open_, key=lambda row: texts[row]), lambda row: texts[row]):
        said = json.loads(text or "{}")
        if "kind" not in said:
            continue
        chosen = rows.iloc[list(group)]
        yield (
            said,
            make_lines(
                chosen.geometry.to_numpy(), CURVE, object_id=chosen["id"].to_numpy(np.uint64)
            ),
        )
