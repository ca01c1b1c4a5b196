"""Where benchmarks of movement take place: windows of real maps."""

from __future__ import annotations

from pathlib import Path

from cityx.agents.build import build
from cityx.agents.options import BuildOptions

MAPS = Path(__file__).resolve().parents[2] / "shared" / "data" / "osm"
# Name -> map, middle of the window (latitude, longitude; its own when None), edge in metres.
PLACES: dict[str, tuple[str, tuple[float, float] | None, float]] = {
    "soho": ("london_soho.osm.gz", None, 500.0),
    "ichigaya": ("tokyo_ichigaya.osm.gz", None, 500.0),
    "berlin": ("berlin_moabit_utymap.osm.gz", None, 600.0),
    "krems": ("krems.osm.gz", (48.4095, 15.6035), 700.0),
    "east village": ("new_york_east_village.osm.gz", None, 600.0),
}


def built(name: str, kept: Path, *, lod: int) -> Path:
    """Build a place in a folder of its name, without pictures, unless it is there already."""
    file, at, size = PLACES[name]
    folder = kept / name.replace(" ", "_")
    if not folder.exists():
        options = BuildOptions(lod=lod, size=(size, size), at=at, formats=(), render=False)
        build([MAPS / file], folder, options)
    return folder
