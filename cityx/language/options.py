"""What options ask for, by the keys of a brief."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from cityx.options import DEFAULT_FORMATS, FORMATS, BuildOptions, PlannerChoice

__all__ = ["DEFAULT_FORMATS", "FORMATS", "BuildOptions", "PlannerChoice", "slots_of"]


def slots_of(options: BuildOptions) -> dict[str, tuple[Any, ...]]:
    """Return what options ask for, by the keys of a brief; those left out are left out."""
    read = options.read
    size = options.size or (None, None)
    at = options.at or (None, None)
    heights = read.height_range or (None, None)
    found: dict[str, Any] = {
        "time": options.time,
        "weather": options.weather,
        "style": options.style or None,
        "workers": options.workers,
        "size.x": size[0],
        "size.y": size[1],
        "town.width": size[0],
        "town.depth": size[1],
        "at.latitude": at[0],
        "at.longitude": at[1],
        "read.legend": None if Path(read.legend).is_file() else read.legend or None,
        "read.confirm_legend": read.confirm_legend or None,
        "read.pixel": read.pixel,
        "read.fidelity": read.fidelity,
        "read.segment": False if read.segmenter == "none" else None,
        "read.lowest": heights[0],
        "read.highest": heights[1],
        "read.height_crs": read.height_crs or None,
    }
    if options.window:
        x, y, width, depth = options.window
        found |= {
            "town.x": x + width / 2, "town.y": y + depth / 2, "town.bounded": False,
            "town.width": width, "town.depth": depth,
        }  # fmt: skip
    return {key: (value,) for key, value in found.items() if value is not None}
