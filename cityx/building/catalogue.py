"""The catalogue: every building generator by name, built in or from an installed package."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from importlib import import_module
from types import MappingProxyType

from cityx.assets.styles.generators import Generator, Look
from cityx.errors import UsageError, nearest
from cityx.protocol.plugged import MeshAction, mesh_actions
from cityx.system.extensions import refuse, remembered

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
USUAL = "mixed_use"
NAMES = tuple(module.rpartition(".")[2] for module in MODULES)
OUTSIDE = "cityx.actions cityx.generators"  # entry point groups whose names are generators, too


@remembered
def generators() -> Mapping[str, Generator]:
    """Return all generators by name: those of `MODULES` in their order, then those from outside."""
    modules = [import_module(f"cityx.building.generators.{place}") for place in MODULES]
    own = {module.GENERATOR.name: module.GENERATOR for module in modules}
    own |= import_module("cityx.building.generators.packaged").packaged()
    for name, made in mesh_actions().items():
        if name in own:
            holder = "CityX" if name in NAMES else "another package"
            refuse(f'Package {made.package}: the name of {made.record.id}, "{name}", is taken by '
                   f"a building of {holder}. It was left out.")  # fmt: skip
            continue
        try:
            own[name] = outside_generator(made, own)
        except UsageError as error:
            refuse(f"Package {made.package}: {error} It was left out.")
    return MappingProxyType(own)


def generator_named(name: str) -> Generator:
    """Return a generator, or the usual one for what a package that is gone has built."""
    return generators().get(name) or generators()[USUAL]


@remembered
def looks() -> Mapping[str, Look]:
    """Return all looks by key: "church", "church/tower"."""
    return MappingProxyType(
        {key: look for each in generators().values() for key, look in each.looks().items()}
    )


def outside_generator(made: MeshAction, known: Mapping[str, Generator] | None = None) -> Generator:
    """Make a generator of an action that makes meshes.

    Parameters
    ----------
    known
        Generators of CityX; those of the catalogue when left out.

    Raises
    ------
    UsageError
        If it likens itself to no generator of CityX.
    """
    traits = made.traits
    if traits.like not in NAMES:
        hint = nearest(traits.like, NAMES)
        raise UsageError(f'{made.record.id} is like "{traits.like}", which is no building.{hint}')
    like = (known or generators())[traits.like]
    # Openings are those of the other; what belongs to the form of its walls and roofs stays away.
    # A curtain of glass is the wall itself, which is the mesh's own.
    mode = like.look.facade.mode
    plain = replace(
        like.look.facade, mode="strip" if mode == "curtain" else mode, heads=(("", 1.0),),
        base=(("", 1.0),), string=0.0, quoins=0.0, balcony=0.0, cooling=0.0, pipe=False,
        fins=(), slabs=(), fixtures=(),
    )  # fmt: skip
    return Generator(
        made.name, made.title, replace(like.look, facade=plain), chimneys=0.0, area=traits.area,
        levels=traits.levels, width=traits.width, floors=traits.floors, storey=traits.storey,
        use=traits.use, covers=False, plot=like.plot, outside=made,
    )  # fmt: skip
