"""Options of environments: what there is, checked all at once before anything is built."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from typing import Any

from cityx.errors import UsageError, nearest
from cityx.sim.dynamics import VEHICLE
from cityx.sim.kernels.tables import TERMS
from cityx.sim.observe import PRESETS

CONTROLS = ("pedals", "target")
DENSEST = 20.0  # vehicles per kilometre of lane
# What each term of a reward is times, by the names and numbers of MetaDrive.
WEIGHTS: Mapping[str, float] = {
    "driving": 1.0, "speed": 0.1, "success": 10.0, "off_road": 5.0, "crash_vehicle": 5.0,
    "crash_object": 5.0,
}  # fmt: skip


@dataclass(frozen=True)
class DriveOptions:
    """Options of ``CityX/Drive-v0``.

    Attributes
    ----------
    observation
        One of `cityx.sim.observe.PRESETS`.
    control
        "pedals": steer, then brake and throttle; "target": steer, then a speed up to 15 m/s.
    vehicle
        What is driven, one of `cityx.sim.dynamics.VEHICLES`.
    agents
        That learn, in each world.
    traffic
        Vehicles of the traffic in each world, or None for `density`.
    density
        Vehicles of the traffic on a kilometre of lane.
    goal_m
        Metres of a route; where no way leads so far it is shorter.
    horizon
        Steps of 0.1 s after which an episode is cut off.
    red_light_ends
        Whether an episode ends where a red light is passed; else it costs.
    reward
        Weights of the terms that differ from `WEIGHTS`.
    """

    observation: str = "state"
    control: str = "pedals"
    vehicle: str = "car"
    agents: int = 1
    traffic: int | None = None
    density: float = 6.0
    goal_m: float = 120.0
    horizon: int = 1000
    red_light_ends: bool = False
    reward: Mapping[str, float] = field(default_factory=dict)

    @property
    def weights(self) -> dict[str, float]:
        """What each term of the reward is times."""
        return {**WEIGHTS, **self.reward}


NAMES = tuple(each.name for each in fields(DriveOptions))
_WORDS: Mapping[str, tuple[str, ...]] = {
    "observation": tuple(PRESETS), "control": CONTROLS, "vehicle": tuple(VEHICLE),
}  # fmt: skip
# Lowest and highest value, and whether it is a whole number.
_NUMBERS: Mapping[str, tuple[float, float, bool]] = {
    "agents": (1, 256, True), "traffic": (0, 256, True), "density": (0.0, DENSEST, False),
    "goal_m": (10.0, 1000.0, False), "horizon": (1, 1_000_000, True),
}  # fmt: skip


def options_of(given: Mapping[str, Any], start: DriveOptions | None = None) -> DriveOptions:
    """Return the options that are given, over others.

    Raises
    ------
    UsageError
        With every fault.
    """
    faults = [f'There is no option "{name}".{nearest(name, NAMES)}'
              for name in given if name not in NAMES]  # fmt: skip
    for name, value in given.items():
        if name in _WORDS and value not in _WORDS[name]:
            known = ", ".join(_WORDS[name])
            faults.append(
                f'{name} is "{value}"; known are {known}.{nearest(str(value), _WORDS[name])}'
            )
        elif name in _NUMBERS and not (name == "traffic" and value is None):
            faults += _number(name, value)
        elif name == "red_light_ends" and not isinstance(value, bool):
            faults.append(f"red_light_ends is {value!r}; it takes True or False.")
        elif name == "reward":
            faults += _reward(value)
    if faults:
        raise UsageError(" ".join(faults))
    return replace(start or DriveOptions(), **given)


def _number(name: str, value: Any) -> list[str]:
    low, high, whole = _NUMBERS[name]
    numeric = isinstance(value, (int, float)) and not isinstance(value, bool)
    if not numeric or not low <= value <= high or (whole and value != int(value)):
        kind = "a whole number" if whole else "a number"
        return [f"{name} is {value!r}; it takes {kind} from {low:g} to {high:g}."]
    return []


def _reward(value: Any) -> list[str]:
    if not isinstance(value, Mapping):
        return [f"reward is {value!r}; it takes weights by term: {', '.join(TERMS)}."]
    faults = [f'The reward has no term "{name}".{nearest(str(name), TERMS)}'
              for name in value if name not in TERMS]  # fmt: skip
    faults += [f"reward {name} is {number!r}; it takes a number." for name, number in value.items()
               if name in TERMS and not isinstance(number, (int, float))]  # fmt: skip
    return faults
