"""Fixtures of packages from strangers."""

from strangers import nobody, strangers, town  # noqa: F401
