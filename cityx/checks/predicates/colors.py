"""Colours by their words: the nearest in CIELAB of the table of words."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from cityx.assets.styles.materials import srgb_to_linear
from cityx.checks.predicates.words import COLORS

FloatArray = NDArray[np.float64]
# Linear sRGB to XYZ of white D65 as 1 (IEC 61966-2-1).
_TO_XYZ = np.array([[0.4339, 0.3763, 0.1898], [0.2126, 0.7152, 0.0722], [0.0177, 0.1095, 0.8728]])
_EPSILON, _KAPPA = 216 / 24389, 24389 / 27  # of CIE 15


def to_lab(linear: FloatArray) -> FloatArray:
    """Return CIELAB (n, 3) of linear RGB (n, 3), white being 1, 1, 1."""
    xyz = np.clip(linear, 0.0, 1.0) @ _TO_XYZ.T
    f = np.where(xyz > _EPSILON, np.cbrt(xyz), (_KAPPA * xyz + 16) / 116)
    return np.column_stack([
        116 * f[:, 1] - 16, 500 * (f[:, 0] - f[:, 1]), 200 * (f[:, 1] - f[:, 2])
    ])  # fmt: skip


def nearest_word(linear: FloatArray) -> NDArray[Any]:
    """Return the word, (n,) str, of linear RGB colours (n, 3)."""
    names = np.array([word for word, shades in COLORS.items() for _ in shades])
    table = to_lab(np.array([srgb_to_linear(s) for shades in COLORS.values() for s in shades]))
    away = np.linalg.norm(to_lab(linear)[:, None] - table, axis=2)
    return np.asarray(names[np.argmin(away, axis=1)])
