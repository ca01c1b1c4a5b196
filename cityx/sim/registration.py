"""Environments by name: what Gymnasium's `make` and `make_vec` find."""

from __future__ import annotations

from typing import Any

from cityx.errors import MissingExtra, UsageError, nearest

IDS = ("CityX/Drive-v0", "CityX/Deliver-v0", "CityX/Walk-v0", "CityX/Fly-v0", "CityX/Explore-v0",
       "CityX/Contact-v0")  # fmt: skip
FLEETS = ("fleet",)  # of many agents


def register() -> None:
    """Tell Gymnasium of the environments; once is enough."""
    import gymnasium

    for name in IDS:
        if name not in gymnasium.registry:
            gymnasium.register(
                name, entry_point="cityx.sim.env:CityEnv", kwargs={"task": name},
                vector_entry_point="cityx.sim.vector:CityVector", order_enforce=False,
                disable_env_checker=True,
            )  # fmt: skip


def make(name: str, place: Any = None, **options: Any) -> Any:
    """Make one environment; see `cityx.sim.env.CityEnv`.

    Raises
    ------
    MissingExtra
        If Gymnasium is absent.
    UsageError
        If there is no such environment or option.
    """
    _known(name)
    from cityx.sim.env import CityEnv

    return CityEnv(place, task=name, **options)


def make_vec(name: str, place: Any = None, *, num_envs: int = 1, **options: Any) -> Any:
    """Make a batch of environments; see `cityx.sim.vector.CityVector`.

    Raises
    ------
    MissingExtra
        If Gymnasium is absent.
    UsageError
        If there is no such environment or option.
    """
    _known(name)
    from cityx.sim.vector import CityVector

    return CityVector(place, task=name, num_envs=num_envs, **options)


def parallel_env(name: str = "fleet", place: Any = None, **options: Any) -> Any:
    """Make an environment of many agents; see `cityx.sim.parallel.FleetEnv`.

    Raises
    ------
    MissingExtra
        If PettingZoo is absent.
    UsageError
        If there is no such environment or option.
    """
    if name not in FLEETS:
        raise UsageError(
            f'There is no environment "{name}"; known are {", ".join(FLEETS)}.'
            f"{nearest(name, FLEETS)}"
        )
    try:
        from cityx.sim.parallel import FleetEnv
    except ImportError as error:
        raise MissingExtra(
            'Many agents need PettingZoo: install it with  pip install "cityx[sim]"'
        ) from error
    return FleetEnv(place, **options)


def _known(name: str) -> None:
    if name not in IDS:
        raise UsageError(
            f'There is no environment "{name}"; known are {", ".join(IDS)}.{nearest(name, IDS)}'
        )
    try:
        register()
    except ImportError as error:
        raise MissingExtra(
            'Environments need Gymnasium: install it with  pip install "cityx[sim]"'
        ) from error
