"""What moves, by the name of its look: vehicles whose wheels turn, people who walk.

A look of a vehicle is ``car_`` and a key of `car_bodies.BODIES`, or a key of `LARGE` or
`TWO_WHEELERS`. The country of its plates and the number of its registration may follow that of a
car: ``car_sedan_gb17``. A look of a person is ``person_``, then any words of `AGES`, `SEXES` and
`STYLES`, then ``jog`` for who carries nothing and wears trainers, ``moto`` or ``cyclist`` for who
wears a helmet, ``hivis`` for who wears a jacket in a warning colour, or a word of `GEAR` for who
has that, then a number: ``person_7``,
``person_male_sport_2``, ``person_male_casual_jog_2``. ``_fine`` at the end asks for the fine
form whatever the level of detail of the city.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from types import MappingProxyType

import numpy as np

from cityx.assets.people.gear import GEAR, WHEELCHAIR
from cityx.assets.people.head import CYCLE_HELMET, HELMET
from cityx.assets.people.looks import AGES, SEXES, STYLES, Person, drawn_person
from cityx.assets.people.people import FINE, Figure, figure
from cityx.assets.shapes import fine_shapes, prototype
from cityx.assets.vehicles.car_bodies import BODIES, TAXIS, shares_of
from cityx.assets.vehicles.car_parts import Part, car_parts, driver_part
from cityx.assets.vehicles.large_vehicles import LARGE
from cityx.assets.vehicles.number_plates import PLATES
from cityx.assets.vehicles.two_wheelers import TWO_WHEELERS, wheel_of
from cityx.assets.vehicles.vehicles import (
    PAINT_SHARES,
    PAINTS,
    TYRE,
    car,
    car_wheel,
    wheel_parts,
    wheel_places,
)
from cityx.city.scene import Prototype
from cityx.city.tracks import MOVER
from cityx.errors import UsageError, nearest
from cityx.geometry.arrays import FloatArray
from cityx.places.profile import Vehicles

Made = tuple[Prototype, Prototype]
WHEEL = "wheel"  # kind of the prototypes of wheels
_TAXIS = tuple(f"car_{name}" for name in TAXIS)
RIDERS = 12  # people who are seen on two wheels
_PERSON, _CAR, FINE_WORD, JOG = "person", "car", "fine", "jog"
HI_VIS, UNIFORM = "hi_vis", "uniform"
WORN = {HI_VIS: "hivis", UNIFORM: "uniform"}  # what people have on -> the word of their look
ENGINE, CYCLE = "moto", "cyclist"  # words of riders with helmets
_HELMETS = {ENGINE: HELMET, CYCLE: CYCLE_HELMET}
UNIFORM_COLOR = (0.009, 0.014, 0.034)  # linear RGB of dark blue cloth, for a material that is 0.80
# Linear RGB of jackets as EN ISO 20471 has them, for a material that is 0.80: yellow, orange-red.
WARNING_COLORS = ((0.75, 1.0, 0.03), (1.0, 0.16, 0.01))
_SHELLS = ((0.75, 0.75, 0.73), (0.02, 0.02, 0.022), (0.35, 0.03, 0.03), (0.30, 0.31, 0.32))
_LARGE_KIND = {"bus": "bus", "truck": "truck", "tram": "tram", "fire_engine": "truck",
               "snow_plough": "truck"}  # fmt: skip
_TWO_WHEELED_KIND = {"bicycle": "bicycle", "motorcycle": "motorcycle", "scooter": "motorcycle"}
# Kind of mover -> (look, share), wherever it is.
_OTHER_LOOKS: dict[str, tuple[tuple[str, float], ...]] = {
    "truck": (("truck", 1.0),),
    "bus": (("bus", 1.0),),
    "tram": (("tram", 1.0),),
    "bicycle": (("bicycle", 1.0),),
    "motorcycle": (("motorcycle", 0.55), ("scooter", 0.45)),
}
# Linear RGB of what is painted by its owner's rule, and not by taste.
_VANS = ((0.76, 0.76, 0.74),) * 4 + ((0.36, 0.37, 0.38), (0.03, 0.03, 0.034), (0.05, 0.10, 0.26))
LIVERIES: dict[str, tuple[tuple[float, float, float], ...]] = {
    "bus": ((0.52, 0.035, 0.03), (0.62, 0.50, 0.10), (0.05, 0.16, 0.42), (0.70, 0.70, 0.68)),
    "tram": ((0.55, 0.04, 0.035), (0.66, 0.62, 0.48), (0.06, 0.26, 0.16)),
    "truck": ((0.72, 0.72, 0.70), (0.06, 0.14, 0.38), (0.45, 0.05, 0.04), (0.10, 0.24, 0.14)),
    "fire_engine": ((0.50, 0.018, 0.014),),
    "snow_plough": ((0.72, 0.24, 0.012),),
    "car_police": ((0.74, 0.74, 0.74),),
    "car_ambulance": ((0.76, 0.76, 0.74),),
    "car_taxi": ((0.66, 0.60, 0.42), (0.62, 0.42, 0.03)),
    "car_black_cab": ((0.008, 0.008, 0.010), (0.010, 0.011, 0.012), (0.12, 0.125, 0.13)),
    "car_tall_taxi": ((0.012, 0.016, 0.05), (0.010, 0.010, 0.012), (0.62, 0.42, 0.03)),
    **{f"{_CAR}_{name}": _VANS for name, body in BODIES.items() if body.kind == "van"},
}


@dataclass(frozen=True)
class Wheel:
    """A wheel of a vehicle.

    Attributes
    ----------
    prototype
        About its axle, x, its outer side to the left, +x.
    place
        (x, y, z) of it in the vehicle, metres; at x < 0 it is turned about.
    radius
        Metres.
    """

    prototype: Prototype
    place: tuple[float, float, float]
    radius: float


@dataclass(frozen=True)
class Seat:
    """Where somebody rides.

    Attributes
    ----------
    place
        (y, z) of the pelvis in the vehicle, metres.
    development
        Metres gone per turn of the pedals, 0 without pedals.
    """

    place: tuple[float, float]
    development: float


@dataclass(frozen=True)
class Vehicle:
    """A vehicle whose wheels are parts of their own.

    Attributes
    ----------
    kind
        Of `cityx.city.tracks.MOVER_KINDS`.
    size
        Length, width and height, metres.
    body
        Without wheels and riders, origin on the ground under its middle.
    wheels
        Its wheels.
    seat
        Where its rider sits, None where nobody is seen.
    parts
        What is fixed to its body.
    """

    kind: str
    size: tuple[float, float, float]
    body: Prototype
    wheels: tuple[Wheel, ...]
    seat: Seat | None = None
    parts: tuple[Part, ...] = ()

    @property
    def wheelbase(self) -> float:
        """Metres between the foremost and the rearmost axle."""
        return float(np.ptp([wheel.place[1] for wheel in self.wheels]))


def is_person(look: str) -> bool:
    """Return whether a look is that of somebody on foot."""
    return look.startswith(f"{_PERSON}_")


def vehicle_looks() -> tuple[str, ...]:
    """Return all looks of vehicles, cars without plates of a country."""
    return (*(f"{_CAR}_{body}" for body in BODIES), *LARGE, *TWO_WHEELERS)


# Word for a vehicle that is no kind of its own -> kind of mover, and its look where it has but one.
SPECIAL: Mapping[str, tuple[str, str]] = MappingProxyType(
    {
        "police": ("car", "car_police"), "ambulance": ("van", "car_ambulance"),
        "fire_engine": ("truck", "fire_engine"), "snow_plough": ("truck", "snow_plough"),
        "taxi": ("car", "car_taxi"),
    }
)  # fmt: skip


def looks_named(word: str, vehicles: Vehicles) -> tuple[tuple[str, float], ...]:
    """Return the looks of a kind of vehicle or of one of `SPECIAL`; taxis are of the place."""
    kind, look = SPECIAL.get(word, (word, ""))
    own = [each for each in looks_of(kind, vehicles) if _variant_of(each[0])[0] in _TAXIS]
    return (
        tuple(own)
        if word == "taxi" and own
        else ((look, 1.0),)
        if look
        else looks_of(kind, vehicles)
    )


def looks_of(kind: str, vehicles: Vehicles) -> tuple[tuple[str, float], ...]:
    """Return the looks of a kind of vehicle that are seen at a place, and the share of each.

    Parameters
    ----------
    kind
        Of `cityx.city.tracks.MOVER_KINDS`.
    vehicles
        Of the profile of the place.
    """
    if kind in _OTHER_LOOKS:
        return _OTHER_LOOKS[kind]
    return tuple((f"{_CAR}_{body}", share) for body, share in shares_of(kind, vehicles))


def registered(look: str, plates: str, number: int) -> str:
    """Return the look of a vehicle with plates, a key of `PLATES`; others than cars keep theirs.

    `number` is that of the registration, of `car_parts.REGISTRATIONS`.
    """
    return f"{look}_{plates}{number}" if look.startswith(f"{_CAR}_") else look


def _variant_of(look: str) -> tuple[str, str, int]:
    """Part a look into that without plates, the country of these and their number."""
    base, _, last = look.rpartition("_")
    country = last.rstrip("0123456789")
    number = last.removeprefix(country)
    if number and base.startswith(f"{_CAR}_") and country in PLATES:
        return base, country, int(number)
    return look, "", 0


@lru_cache(maxsize=1024)
def vehicle(look: str, *, detail: int = 2) -> Vehicle:
    """Make the vehicle of a look.

    Raises
    ------
    UsageError
        If no vehicle looks so.
    """
    name = look.removesuffix(f"_{FINE_WORD}")
    detail = max(detail, FINE) if name != look else detail
    base, country, number = _variant_of(name)
    known = vehicle_looks()
    if base not in known:
        hint = nearest(name, known) or f" Known are {', '.join(known)}."
        raise UsageError(f'No vehicle looks like "{look}".{hint}')
    if base in LARGE:
        return _large(base, detail)
    if base in TWO_WHEELERS:
        return _two_wheeled(base, detail)
    return _car(base.removeprefix(f"{_CAR}_"), detail, country, number)


def _named(name: str, part: str, detail: int) -> str:
    return "_".join(filter(None, (name, part, FINE_WORD if detail >= FINE else "")))


def _car(name: str, detail: int, country: str, number: int) -> Vehicle:
    body = BODIES[name]
    fine = detail >= FINE
    shape = car(name, detail=detail, wheels=False, country=country, number=None)
    parts: tuple[Part, ...] = ()
    if fine:
        parts = (*car_parts(name, country, number), driver_part(name, country, number))
    title = _named(f"{_CAR}_{name}", "wheel", detail)
    wheel = prototype(title, WHEEL, car_wheel(body, detail))
    wheels = tuple(Wheel(wheel, place, body.wheel) for place in wheel_places(body))
    size = (body.length, body.width, float(shape.mesh.vertices[:, 2].max()))
    return Vehicle(body.kind, size, shape, wheels, parts=parts)


def _large(name: str, detail: int) -> Vehicle:
    model = LARGE[name]

    def made() -> Made:
        body = prototype(_named(name, "body", detail), "vehicle", model.parts(model))
        rubber = wheel_parts(model.wheel, 1.4 * TYRE)
        return body, prototype(_named(name, "wheel", detail), WHEEL, rubber)

    body, wheel = _at(detail, made)
    wheels = tuple(Wheel(wheel, place, model.wheel) for place in model.wheel_places())
    return Vehicle(_LARGE_KIND[name], model.size, body, wheels)


def _two_wheeled(name: str, detail: int) -> Vehicle:
    model = TWO_WHEELERS[name]

    def made() -> Made:
        body = prototype(_named(name, "body", detail), "vehicle", model.parts(model))
        return body, prototype(_named(name, "wheel", detail), WHEEL, wheel_of(model))

    body, wheel = _at(detail, made)
    wheels = tuple(Wheel(wheel, place, model.wheel) for place in model.wheel_places())
    seat = Seat(model.seat, model.development)
    return Vehicle(_TWO_WHEELED_KIND[name], model.size, body, wheels, seat)


def _at(detail: int, made: Callable[[], Made]) -> Made:
    """Make something in the form of a level of detail."""
    if detail < FINE:
        return made()
    with fine_shapes():
        return made()


def person_look(number: int, *, age: str = "", sex: str = "", style: str = "",
                jogs: bool = False, helmet: str = "", wears: str = "", gear: str = "",
                fine: bool = False) -> str:  # fmt: skip
    """Return the look of a person.

    `helmet` is `ENGINE` or `CYCLE`, `wears` of `WORN`, `gear` of `GEAR`, each "" for none.
    """
    words = (_PERSON, age, sex, style, JOG * jogs, helmet, WORN.get(wears, ""), gear, str(number),
             FINE_WORD * fine)  # fmt: skip
    return "_".join(filter(None, words))


@lru_cache(maxsize=4096)
def person_of(look: str) -> Person:
    """Return the person of a look.

    Raises
    ------
    UsageError
        If a word of the look means nothing.
    """
    told: dict[str, str] = {}
    number, helmet = -1, ""
    for word in look.removesuffix(f"_{FINE_WORD}").split("_")[1:]:
        for key, words in (("age", AGES), ("sex", SEXES), ("style", STYLES)):
            if word in words:
                told[key] = word
        if word.isdecimal():
            number = int(word)
        elif word in _HELMETS:
            helmet = _HELMETS[word]
        elif word in GEAR:
            told["gear"] = word
        elif word not in told.values() and word not in (JOG, *WORN.values()):
            known = (*AGES, *SEXES, *STYLES, JOG, *_HELMETS, *WORN.values(), *GEAR)
            raise UsageError(f'No person looks like "{look}": {word}.{nearest(word, known)}')
    if not is_person(look) or number < 0:
        raise UsageError(f'"{look}" is no look of a person, such as person_7.')
    age, sex, style = (told.get(key, "") for key in ("age", "sex", "style"))
    who = drawn_person(number, age=age, sex=sex, style=style)
    if helmet:
        shell = _SHELLS[number % len(_SHELLS)]
        who = replace(who, hat=helmet, hat_color=shell, bag="")
    if f"_{WORN[UNIFORM]}_" in look:
        who = replace(who, top="jacket", top_color=UNIFORM_COLOR, under="", bottom="trousers",
                      bottom_color=UNIFORM_COLOR, hat="cap", hat_color=UNIFORM_COLOR, bag="",
                      shoes="shoes", tucked=False, tie=False)  # fmt: skip
    if f"_{WORN[HI_VIS]}_" in look:
        who = replace(who, top="jacket", top_color=WARNING_COLORS[number % 2], under="",
                      bottom=who.bottom or "trousers", tucked=False, tie=False)  # fmt: skip
    if "gear" in told:
        who = replace(who, bag="", gear=told["gear"])
    return replace(who, bag="", shoes="trainers") if f"_{JOG}_" in look else who


def figure_of(look: str, detail: int) -> Figure:
    """Return the figure of the look of a person."""
    fine = look.endswith(f"_{FINE_WORD}")
    return figure(person_of(look), detail=max(detail, FINE) if fine else max(detail, 2))


def size_of(look: str) -> tuple[float, float, float]:
    """Return the length, width and height of a mover, metres.

    Raises
    ------
    UsageError
        If nothing looks so.
    """
    if not is_person(look):
        return vehicle(look).size
    who = person_of(look)
    if who.gear:
        return gear_size(who.gear, who.height)
    return (0.22 * who.height, 0.28 * who.height, who.height)


def gear_size(gear: str, height: float) -> tuple[float, float, float]:
    """Return the length, width and height of somebody with gear, metres."""
    if gear == WHEELCHAIR:
        return (1.05, 0.66, 0.80 * height)
    return (1.30 + 0.22 * height, 0.54, height)


def kind_of(look: str) -> int:
    """Return the number of the kind of mover of a look, as of `MOVER`."""
    return MOVER["pedestrian" if is_person(look) else vehicle(look).kind]


def paints_of(look: str) -> tuple[FloatArray, FloatArray]:
    """Return the (n, 3) linear colours that a vehicle may have, and their (n,) shares."""
    name = _variant_of(look.removesuffix(f"_{FINE_WORD}"))[0]
    if name in LIVERIES:
        colors = np.array(LIVERIES[name])
        return colors / 0.8, np.full(len(colors), 1 / len(colors))
    return PAINTS, PAINT_SHARES
