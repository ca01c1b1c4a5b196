"""The catalogue: every building generator by name."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from importlib import import_module
from types import MappingProxyType

from cityx.assets.styles.generators import Generator, Look

# One module each; the order is that of tables and contact sheets.
MODULES = (
    "homes.palazzo", "homes.perimeter_block", "homes.georgian_terrace", "homes.walk_up",
    "homes.mediterranean_house", "homes.shop_house", "civic.townhall", "homes.suburban_house",
    "homes.cottage", "homes.bungalow", "homes.japanese_lowrise", "homes.japanese_midrise",
    "homes.mixed_use", "homes.panel_slab", "homes.asian_block", "towers.art_deco",
    "towers.office_slab", "towers.glass_tower", "towers.setback_skyscraper",
    "towers.postmodern_tower", "towers.brutalist", "trade.parking", "civic.church",
    "civic.mosque", "civic.station_hall", "trade.warehouse", "trade.sawtooth_factory",
    "trade.big_box", "trade.shed", "trade.barn", "trade.greenhouse", "civic.temple",
    "civic.stadium", "trade.petrol_station", "civic.school", "civic.hospital",
)  # fmt: skip
NAMES = tuple(module.rpartition(".")[2] for module in MODULES)


@cache
def generators() -> Mapping[str, Generator]:
    """Return all generators by name, in the order of `MODULES`."""
    modules = [import_module(f"cityx.building.generators.{place}") for place in MODULES]
    return MappingProxyType({module.GENERATOR.name: module.GENERATOR for module in modules})


@cache
def looks() -> Mapping[str, Look]:
    """Return all looks by key: "church", "church/tower"."""
    return MappingProxyType(
        {key: look for each in generators().values() for key, look in each.looks().items()}
    )
