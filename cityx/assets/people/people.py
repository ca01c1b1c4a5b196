"""People: figures at real size that differ in age, build, hair and clothes, and can be bent.

    person(7)                               # a prototype, standing
    figure(drawn_person(7), detail=3)       # the same person with a skeleton
    posed(figure(drawn_person(7)), walk(0.25))

Frame of a figure: x to its left, y to its back, z up, metres, origin on the ground; it faces -y.
"""

from __future__ import annotations

from contextlib import nullcontext
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from cityx.assets.people.body import CHIN, Body, Part, bare_arm, bare_leg, hands
from cityx.assets.people.clothes import (
    BOTTOMS,
    TOPS,
    bag,
    hem_of,
    shoes,
    skirt,
    tie,
    top_parts,
    trousers,
)
from cityx.assets.people.gear import WHEELCHAIR, gear
from cityx.assets.people.head import beard, crown_of, hair, hat, head, neck
from cityx.assets.people.looks import Person, drawn_person
from cityx.assets.people.poses import stand
from cityx.assets.people.skeleton import Weights, bent, joint_motions
from cityx.assets.shapes import fine_shapes, fuse, prototype
from cityx.city.mesh import MeshBatch
from cityx.city.scene import Prototype
from cityx.geometry.arrays import FloatArray

FINE = 3  # level of detail from which the fine form is made
# Heads are nearly full-grown in children: share of the height, by height in metres.
_HEAD_SHARE = ((1.0, 1.15, 1.3, 1.5, 1.65), (0.188, 0.174, 0.161, 0.146, 0.1345))


@dataclass(frozen=True)
class Figure:
    """A person at rest with a skeleton.

    Attributes
    ----------
    person
        Whom it shows.
    mesh
        Batch of one object, made of closed solids; metres.
    joints
        (j, 3) places of `JOINTS` at rest, metres.
    weights
        At most two joints of each vertex.
    parts
        (p + 1,) first vertex of every solid.
    parts_worn
        Number of the first solids, which are the person and not its gear.
    """

    person: Person
    mesh: MeshBatch
    joints: FloatArray
    weights: Weights
    parts: NDArray[np.int64]
    parts_worn: int

    @property
    def bearing(self) -> int:
        """Number of the first vertices, of what stands on the ground: not of what is pushed."""
        pushed = self.person.gear and self.person.gear != WHEELCHAIR
        return int(self.parts[self.parts_worn] if pushed else self.parts[-1])


def body_of(person: Person) -> Body:
    """Return the measures of a person; see `Body` for the units."""
    share = float(np.interp(person.height, *_HEAD_SHARE))
    # Small adults have small heads.
    share = share if person.age == "child" else 1.0 - CHIN
    unit = person.height * (1.0 - share) / CHIN
    child = float(np.clip((1.62 - person.height) / 0.5, 0.0, 1.0)) * (person.age == "child")
    female = (1.0 if person.sex == "female" else 0.0) * (1.0 - 0.85 * child)
    skull = (person.height / unit - CHIN) / crown_of(person.hair)
    return Body(unit, skull, female, person.build, child)


@lru_cache(maxsize=256)  # a crowd is of some hundred people, of 0.1 MB each
def figure(person: Person, *, detail: int = 2) -> Figure:
    """Make the figure of a person, standing with hanging arms.

    From level of `detail` 3 on forms are smooth, fingers part, and faces have eyes and a mouth.
    """
    with fine_shapes() if detail >= FINE else nullcontext():
        body = body_of(person)
        parts = _dressed(body, person)
        worn = len(parts)
        if person.gear:
            parts += gear(body, person.gear, person.bag_color)
    start = np.cumsum([0] + [len(part.mesh.vertices) for part in parts])
    mesh = fuse(part.mesh for part in parts)
    mesh = replace(mesh, vertices=mesh.vertices * body.unit,
                   uv=(mesh.uv * body.unit).astype(np.float32))  # fmt: skip
    weights = Weights(
        np.concatenate([part.weights.joints for part in parts]),
        np.concatenate([part.weights.shares for part in parts]),
    )
    return Figure(person, mesh, body.joints() * body.unit, weights, start, worn)


def posed(figure: Figure, rotations: FloatArray, *, grounded: bool = True) -> MeshBatch:
    """Bend a figure.

    Parameters
    ----------
    figure
        The figure; it stays as it is.
    rotations
        (j, 3) rotation vectors of `JOINTS`, radians; see `cityx.assets.people.poses`.
    grounded
        Whether the figure is then set on the ground, its lowest vertex at z = 0. Otherwise the
        pelvis stays where it is at rest.
    """
    turn, shift = joint_motions(figure.joints, rotations)
    points = bent(figure.mesh.vertices, figure.weights, turn, shift)
    if grounded:
        points[:, 2] -= points[:, 2].min()
    return replace(figure.mesh, vertices=points)


def person(
    number: int, *, seed: int = 0, age: str = "", pose: FloatArray | None = None, detail: int = 2
) -> Prototype:
    """Make a person by number; the prototype's kind is "person".

    Parameters
    ----------
    number, seed, age
        As of `drawn_person`.
    pose
        (j, 3) rotations of joints, radians; None stands at ease.
    detail
        As of `figure`.
    """
    who = drawn_person(number, seed=seed, age=age)
    if pose is None:
        pose = stand(((37 * number) % 21 - 10) / 10)
    name = "_".join(filter(None, ("person", age, str(number), "fine" if detail >= FINE else "")))
    return prototype(name, "person", [posed(figure(who, detail=detail), pose)])


def _dressed(body: Body, person: Person) -> list[Part]:
    look = TOPS[person.top]
    red, green, blue = person.hair_color
    parts = [*head(body, person.skin, (0.6 * red, 0.6 * green, 0.6 * blue))]
    parts += [*neck(body, person.skin), *hands(body, person.skin)]
    parts += hair(body, person.hair, person.hair_color, under_hat=bool(person.hat))
    if person.beard:
        parts += beard(body, person.hair_color, person.beard)
    if look.sleeve > 0.5:
        parts += bare_arm(body, person.skin, look.sleeve + 0.05)
    parts += top_parts(body, person.top, person.top_color, tucked=person.tucked)
    if person.under:
        parts += top_parts(body, person.under, person.under_color, sleeves=False)
    if person.tie:
        parts += tie(body, person.tie_color)
    if person.bottom in BOTTOMS:
        parts += trousers(body, person.bottom, person.bottom_color,
                          over=person.tucked)  # fmt: skip
    elif person.bottom:
        parts += skirt(body, person.bottom, person.bottom_color)
    if person.bottom == "shorts":
        parts += bare_leg(body, person.skin)
    elif person.bottom not in BOTTOMS:  # what a skirt covers is left out: it would show in a stride
        top = min(hem_of(person.bottom, person.top) + 0.09, 0.552)
        if person.tights:
            parts += bare_leg(body, person.shoe_color, top, material="cloth")
        else:
            parts += bare_leg(body, person.skin, top)
    parts += shoes(body, person.shoes, person.shoe_color, person.sole_color)
    if person.hat:
        parts += hat(body, person.hat, person.hat_color)
    if person.bag:
        parts += bag(body, person.bag, person.bag_color)
    return parts
