"""Kernels of the simulator, compiled by numba: pure functions of arrays, imported lazily."""
