"""The simulator: any city as an environment of Gymnasium, on a CPU, the same bytes each time.

>>> import cityx
>>> env = cityx.make("CityX/Drive-v0", place="soho")  # doctest: +SKIP
>>> view, info = env.reset(seed=1)  # doctest: +SKIP

Gymnasium's own `make` finds the environments too, once this module is imported.
"""

from contextlib import suppress

from cityx.sim.registration import make, make_vec, parallel_env, register

__all__ = ["make", "make_vec", "parallel_env", "register"]

with suppress(ImportError):  # without the extra `make` says what to install
    register()
