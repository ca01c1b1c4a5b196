"""Plants, vehicles, people and street furniture of our generators, as assets."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from cityx.assets.library.measure import color_words, thing_sentence
from cityx.assets.library.models import Models, models_height, models_of_prototypes
from cityx.assets.library.records import Catalogue, make_catalogue, rectangle_columns
from cityx.city.scene import Prototype
from cityx.system.tables import table

LICENCE = "CC0-1.0"  # of what our generators make; the program itself is Apache-2.0
FRONT = np.pi  # compass radians; prototypes face -y, which is south
_PLANT_WORDS = table("assets/library", str, "plants")
_VEHICLE_WORDS = table("assets/library", str, "vehicles")


def _plants(numbers: Sequence[int]) -> tuple[list[Prototype], list[str], list[str]]:
    from cityx.assets.trees import plant

    kinds = list(_PLANT_WORDS)
    names = [kinds[number % len(kinds)] for number in numbers]
    made = [plant(name, number // len(kinds), "light")
            for name, number in zip(names, numbers, strict=True)]  # fmt: skip
    return made, [_PLANT_WORDS[name] for name in names], names


def _vehicles(numbers: Sequence[int]) -> tuple[list[Prototype], list[str], list[str]]:
    from cityx.assets.furniture.street_furniture import furniture
    from cityx.assets.vehicles.vehicles import PAINTS, car

    kinds = list(_VEHICLE_WORDS)
    colors = color_words(PAINTS * 0.8)
    made, words = [], []
    for number in numbers:
        kind, paint = kinds[number % len(kinds)], number // len(kinds)
        body = furniture("bus") if kind == "bus" else car(kind)
        made.append(_painted(body, PAINTS[paint], f"{body.name}_{paint}"))
        words.append(f"{colors[paint]} {_VEHICLE_WORDS[kind]}")
    return made, words, [kinds[number % len(kinds)] for number in numbers]


def _painted(prototype: Prototype, paint: Any, name: str) -> Prototype:
    mesh = prototype.mesh
    is_paint = np.array([material == "car_paint" for material in mesh.materials])[mesh.material]
    tint = np.where(is_paint[:, None], np.asarray(paint, np.float32), mesh.tint)
    return Prototype(name, prototype.kind, replace(mesh, tint=tint.astype(np.float32)))


def _people(numbers: Sequence[int]) -> tuple[list[Prototype], list[str], list[str]]:
    from cityx.assets.people.looks import drawn_person, words_of
    from cityx.assets.people.people import person

    looks = [drawn_person(number) for number in numbers]
    return [person(n) for n in numbers], [words_of(p) for p in looks], [p.age for p in looks]


def _pieces() -> list[str]:
    from cityx.assets.furniture.street_furniture import MAKERS

    return [name for name in MAKERS if name != "bus"]


def _furniture(numbers: Sequence[int]) -> tuple[list[Prototype], list[str], list[str]]:
    from cityx.assets.furniture.street_furniture import furniture

    names = [_pieces()[number] for number in numbers]
    return [furniture(n) for n in names], [n.replace("_", " ") for n in names], names


_THINGS = {"plants": _plants, "vehicles": _vehicles, "people": _people, "furniture": _furniture}


def capacity(group: str) -> float:
    """Return how many distinct assets of a group there can be."""
    if group == "vehicles":
        from cityx.assets.vehicles.vehicles import PAINTS

        return len(PAINTS) * len(_VEHICLE_WORDS)
    return len(_pieces()) if group == "furniture" else float("inf")


def grow_things(group: str, numbers: Sequence[int]) -> tuple[Catalogue, Models]:
    """Make plants, vehicles, people or furniture by number."""
    from cityx.assets.library.measure import outline_of, stable_outline

    made, words, uses = _THINGS[group](numbers)
    models = models_of_prototypes(made)
    shells = models.shells
    points = np.split(shells.vertices, shells.vertex_start[1:-1])
    footprint = np.array([stable_outline(outline_of(p, None)) for p in points], object)
    box = rectangle_columns(footprint)
    height = models_height(models)
    sentences = [
        thing_sentence(text, (box["length"][i], box["width"][i], height[i]))
        for i, text in enumerate(words)
    ]
    records = make_catalogue(
        len(made), group=group, collection=[p.name for p in made], footprint=footprint,
        front=FRONT, height=height, storey_height=np.nan, use=uses, licence=LICENCE,
        description=sentences, source="procedural", generator=group, **box,
    )  # fmt: skip
    return records, models
