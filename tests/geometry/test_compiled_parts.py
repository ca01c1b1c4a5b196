"""Parts of kernels are compiled into the kernels that call them."""

from typing import Any

import numpy as np
from numba import njit

from cityx.geometry.compiled import borrowing, compiled


@borrowing
def _steps_below(values: Any, limit: float) -> Any:
    """Count with enough branches that a compiler would not make it part of its caller."""
    count = 0
    for k in range(len(values)):
        value = values[k]
        while value > limit:
            value = value * 0.5 if value > 7.0 else value - 1.0
            count += 3 if value > 9.0 else (2 if value > 4.0 else 1)
        if value < -limit:
            count -= 1 if value < -9.0 else 2
    return count


@compiled
def _thrice(values: Any) -> Any:
    return _steps_below(values, 1.0) + _steps_below(values, 2.0) + _steps_below(values, 3.0)


def test_a_kernel_calls_none_of_its_parts() -> None:
    values = np.array([9.0, 0.5, -12.0])
    made = njit(_thrice.py_func, error_model="numpy")  # code of the cache cannot be inspected
    assert made(values) == sum(_steps_below.py_func(values, x) for x in (1.0, 2.0, 3.0))
    lines = next(iter(made.inspect_asm().values())).splitlines()
    # What numba keeps for errors has the name as well.
    assert not [line for line in lines if "steps_below" in line and "NumbaEnv" not in line]
