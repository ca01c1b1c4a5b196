"""The models of what moves, one for each look: a body that takes the paint, and the rest."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from cityx.assets.people.gaits import going, riding
from cityx.assets.people.gear import PRAM, WHEELCHAIR
from cityx.assets.shapes import moved, prototype
from cityx.assets.vehicles.movers import figure_of, is_person, vehicle
from cityx.assets.vehicles.moving import rider_look
from cityx.city.scene import Prototype
from cityx.city.tracks import GAIT, Tracks

DETAIL = 2  # of the forms; hundreds are drawn at once
KIND = "mover"
BODY, REST = "body", "rest"
STEP = 0.12  # of a walker's cycle, at which feet are apart
_PLATED = re.compile(r"(car_[a-z_]+?)_[a-z]{2}\d+")


def model_of(look: str) -> str:
    """Return the model that shows a look: a car without the plates of a country."""
    found = _PLATED.fullmatch(look)
    return found[1] if found else look


def models_of(tracks: Tracks | None) -> Sequence[Prototype]:
    """Return the meshes of all models of tracks, named ``LOOK/body`` and ``LOOK/rest``."""
    if tracks is None or not tracks.count:
        return ()
    names = sorted({model_of(look) for look in np.unique(tracks.look).tolist()})
    return tuple(part for name in names for part in _model(name) if len(part.mesh.faces))


def _model(look: str) -> list[Prototype]:
    if is_person(look):
        who = figure_of(look, DETAIL)
        gait = {WHEELCHAIR: "sit", PRAM: "push"}.get(who.person.gear, "walk")
        body = going(who, GAIT[gait], STEP)
        return [prototype(f"{look}/{REST}", KIND, [body])]
    model = vehicle(look, detail=DETAIL)
    rest = [
        moved(wheel.prototype.mesh, wheel.place, yaw=np.pi if wheel.place[0] < 0 else 0.0)
        for wheel in model.wheels
    ]
    rest += [
        moved(part.prototype.mesh, part.place, yaw=np.pi if part.about else 0.0)
        for part in model.parts
    ]
    if model.seat is not None:
        rider = figure_of(rider_look(0, model.seat), DETAIL)
        pedals = bool(model.seat.development)
        rest.append(riding(rider, model.seat.place, 0.0, pedals=pedals))
    parts = [prototype(f"{look}/{BODY}", KIND, [model.body.mesh])]
    return [*parts, prototype(f"{look}/{REST}", KIND, rest)] if rest else parts
