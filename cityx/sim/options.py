"""Options of environments: what there is, checked all at once before anything is built."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from typing import Any, ClassVar, TypeVar

from cityx.errors import UsageError, nearest
from cityx.sim.dynamics import VEHICLE
from cityx.sim.kernels.tables import FLY_TERMS, TERMS, WALK_TERMS
from cityx.sim.observe import PRESETS
from cityx.sim.walks import ROUTED

CONTROLS = ("pedals", "target", "jerk")
RULES, TRACKS, SUMO = "rules", "tracks", "sumo"  # where traffic comes from
DRONE = "drone"
BODIES = (*VEHICLE, *ROUTED, DRONE)  # of a fleet: who drives, who goes on walks, who flies
MOST = 256  # agents of a world
DENSEST = 20.0  # vehicles per kilometre of lane
# What each term of a reward is times, by the numbers of MetaDrive.
WEIGHT = (1.0, 0.1, 10.0, 5.0, 5.0, 5.0)
# Lowest and highest value, and whether it is a whole number.
_NUMBERS: Mapping[str, tuple[float, float, bool]] = {
    "agents": (1, MOST, True), "traffic": (0, 256, True), "density": (0.0, DENSEST, False),
    "goal_m": (10.0, 1000.0, False), "horizon": (1, 1_000_000, True), "people": (0, 250, True),
    "cells": (2, 500, True),
}  # fmt: skip


@dataclass(frozen=True)
class Options:
    """What all environments have.

    Attributes
    ----------
    observation
        Name of a vector of what is observed.
    agents
        That learn, in each world.
    goal_m
        Metres of a route; where none is so long it is shorter.
    horizon
        Steps of 0.1 s after which an episode is cut off.
    reward
        Weights of the terms that differ from the usual ones.
    """

    words: ClassVar[Mapping[str, tuple[str, ...]]] = {}
    terms: ClassVar[tuple[str, ...]] = TERMS

    observation: str = "state"
    agents: int = 1
    goal_m: float = 120.0
    horizon: int = 1000
    reward: Mapping[str, float] = field(default_factory=dict)

    @property
    def weights(self) -> dict[str, float]:
        """What each term of the reward is times."""
        return {**dict(zip(self.terms, WEIGHT, strict=True)), **self.reward}


@dataclass(frozen=True)
class DriveOptions(Options):
    """Options of ``CityX/Drive-v0``.

    Attributes
    ----------
    control
        "pedals": steer, then brake and throttle; "target": steer, then a speed up to 15 m/s;
        "jerk": how fast the wheel is turned, then how fast the pedals move.
    vehicle
        What is driven, one of `cityx.sim.dynamics.VEHICLES`.
    traffic
        Vehicles of the traffic in each world, or None for `density`.
    density
        Vehicles of the traffic on a kilometre of lane.
    source
        Of the traffic: "rules" of the kernels; "tracks" of the city, which heed nobody; "sumo",
        which a process for each world drives among the agents.
    people
        On foot in each world, about the agents.
    red_light_ends
        Whether an episode ends where a red light is passed; else it costs.
    """

    words: ClassVar[Mapping[str, tuple[str, ...]]] = {
        "observation": tuple(PRESETS), "control": CONTROLS, "vehicle": tuple(VEHICLE),
        "source": (RULES, TRACKS, SUMO),
    }  # fmt: skip

    control: str = "pedals"
    vehicle: str = "car"
    traffic: int | None = None
    density: float = 6.0
    source: str = RULES
    people: int = 0
    red_light_ends: bool = False


@dataclass(frozen=True)
class WalkOptions(Options):
    """Options of ``CityX/Deliver-v0`` and ``CityX/Walk-v0``.

    Attributes
    ----------
    vehicle
        Who goes, one of `cityx.sim.travellers.TRAVELLERS` that routes are made for.
    people
        Others on foot in each world, about the agents.
    traffic, density, red_light_ends
        As of `DriveOptions`.
    """

    words: ClassVar[Mapping[str, tuple[str, ...]]] = {
        "observation": ("walk",), "vehicle": ROUTED,
    }  # fmt: skip
    terms: ClassVar[tuple[str, ...]] = WALK_TERMS

    observation: str = "walk"
    vehicle: str = "robot"
    goal_m: float = 150.0
    horizon: int = 3000
    people: int = 20
    traffic: int | None = None
    density: float = 6.0
    red_light_ends: bool = False


@dataclass(frozen=True)
class ExploreOptions(WalkOptions):
    """Options of ``CityX/Explore-v0``; the agent begins at a door.

    Attributes
    ----------
    cells
        Squares of 4 m that are to be found.
    """

    words: ClassVar[Mapping[str, tuple[str, ...]]] = {
        "observation": ("explore",), "vehicle": ROUTED,
    }  # fmt: skip

    observation: str = "explore"
    cells: int = 40


@dataclass(frozen=True)
class ContactOptions(WalkOptions):
    """Options of ``CityX/Contact-v0``; the vehicle says whose ways the robot is led along.

    Attributes
    ----------
    robot
        Its file (MJCF); that of CityX where it is "".
    """

    words: ClassVar[Mapping[str, tuple[str, ...]]] = {
        "observation": ("contact",), "vehicle": ROUTED,
    }  # fmt: skip

    observation: str = "contact"
    robot: str = ""


@dataclass(frozen=True)
class FlyOptions(Options):
    """Options of ``CityX/Fly-v0``."""

    words: ClassVar[Mapping[str, tuple[str, ...]]] = {"observation": ("fly",)}
    terms: ClassVar[tuple[str, ...]] = FLY_TERMS

    observation: str = "fly"
    goal_m: float = 150.0


@dataclass(frozen=True)
class FleetOptions(DriveOptions):
    """Options of a fleet of mixed bodies; those of `DriveOptions` hold for all or who drives.

    Attributes
    ----------
    bodies
        How many agents of each kind, by names of `BODIES`.
    """

    words: ClassVar[Mapping[str, tuple[str, ...]]] = {
        **DriveOptions.words, "source": (RULES,),
    }  # fmt: skip

    bodies: Mapping[str, int] = field(default_factory=dict)
    density: float = 6.0
    horizon: int = 3000


O = TypeVar("O", bound=Options)  # noqa: E741


def options_of(given: Mapping[str, Any], start: O | None = None) -> O:
    """Return the options that are given, over others.

    Raises
    ------
    UsageError
        With every fault.
    """
    begun: Any = start if start is not None else DriveOptions()
    names = [each.name for each in fields(begun)]
    faults = [f'There is no option "{name}".{nearest(name, names)}'
              for name in given if name not in names]  # fmt: skip
    for name, value in given.items():
        if name not in names:
            continue
        if name in begun.words and value not in begun.words[name]:
            known = ", ".join(begun.words[name])
            faults.append(
                f'{name} is "{value}"; known are {known}.{nearest(str(value), begun.words[name])}'
            )
        elif name in _NUMBERS and not (name == "traffic" and value is None):
            faults += _number(name, value)
        elif name == "red_light_ends" and not isinstance(value, bool):
            faults.append(f"red_light_ends is {value!r}; it takes True or False.")
        elif name == "bodies":
            faults += _bodies(value)
        elif name == "robot" and not isinstance(value, str):
            faults.append(f"robot is {value!r}; it takes the name of a file.")
        elif name == "reward":
            faults += _reward(value, begun.terms)
    if faults:
        raise UsageError(" ".join(faults))
    return replace(begun, **given)  # type: ignore[no-any-return]


def _number(name: str, value: Any) -> list[str]:
    low, high, whole = _NUMBERS[name]
    numeric = isinstance(value, (int, float)) and not isinstance(value, bool)
    if not numeric or not low <= value <= high or (whole and value != int(value)):
        kind = "a whole number" if whole else "a number"
        return [f"{name} is {value!r}; it takes {kind} from {low:g} to {high:g}."]
    return []


def _bodies(value: Any) -> list[str]:
    if not isinstance(value, Mapping) or not value:
        return [f"bodies is {value!r}; it takes numbers by name: {', '.join(BODIES)}."]
    faults = [f'There is no body "{name}"; known are {", ".join(BODIES)}.'
              f"{nearest(str(name), BODIES)}" for name in value if name not in BODIES]  # fmt: skip
    for name, count in value.items():
        if isinstance(count, bool) or not isinstance(count, int) or not 0 <= count <= MOST:
            faults.append(f"bodies {name} is {count!r}; it takes a whole number, 0 to {MOST}.")
    if not faults and not 0 < sum(value.values()) <= MOST:
        faults.append(f"bodies are {sum(value.values())}; a fleet takes 1 to {MOST}.")
    return faults


def _reward(value: Any, terms: tuple[str, ...]) -> list[str]:
    if not isinstance(value, Mapping):
        return [f"reward is {value!r}; it takes weights by term: {', '.join(terms)}."]
    faults = [f'The reward has no term "{name}".{nearest(str(name), terms)}'
              for name in value if name not in terms]  # fmt: skip
    faults += [f"reward {name} is {number!r}; it takes a number." for name, number in value.items()
               if name in terms and not isinstance(number, (int, float))]  # fmt: skip
    return faults
