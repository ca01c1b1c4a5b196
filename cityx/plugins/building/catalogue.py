"""The catalogue: every building generator by name."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from importlib import import_module
from types import MappingProxyType

from cityx.assets.generators import Generator, Look

# One module each; the order is that of tables and contact sheets.
NAMES = (
    "palazzo", "perimeter_block", "georgian_terrace", "walk_up", "mediterranean_house",
    "shop_house", "townhall",
    "suburban_house", "cottage", "bungalow", "japanese_lowrise",
    "japanese_midrise",
    "mixed_use", "panel_slab", "asian_block", "art_deco",
    "office_slab", "glass_tower", "setback_skyscraper", "postmodern_tower", "brutalist", "parking",
    "church", "mosque", "station_hall", "warehouse", "sawtooth_factory", "big_box", "shed",
    "barn", "greenhouse", "temple",
    "stadium", "petrol_station", "school", "hospital",
)  # fmt: skip


@cache
def generators() -> Mapping[str, Generator]:
    """Return all generators by name, in the order of `NAMES`."""
    modules = [import_module(f"cityx.plugins.building.{name}") for name in NAMES]
    return MappingProxyType({module.GENERATOR.name: module.GENERATOR for module in modules})


@cache
def looks() -> Mapping[str, Look]:
    """Return all looks by key: "church", "church/tower"."""
    return MappingProxyType(
        {key: look for each in generators().values() for key, look in each.looks().items()}
    )
