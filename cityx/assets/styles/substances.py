"""What materials and kinds of things mean to a physics engine: weights, friction, what moves.

Densities and friction are those of handbooks, rounded: dry surfaces against concrete or asphalt.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from cityx.assets.styles.surface_states import material_named
from cityx.system.tables import table


@dataclass(frozen=True)
class Substance:
    """A material by weight and touch.

    Attributes
    ----------
    density
        Kilograms per cubic metre.
    wall
        Metres: how thick what is made of it is at most. Posts, bins and bodies of cars are hollow.
    friction
        Coefficient of Coulomb.
    restitution
        Share of the speed that is left after a bounce.
    """

    density: float
    wall: float
    friction: float
    restitution: float


@dataclass(frozen=True)
class _Row(Substance):
    """A substance and the materials that are made of it."""

    of: tuple[str, ...]


_ROWS = table("assets/substances", _Row, "substances")
SUBSTANCES: Mapping[str, Substance] = MappingProxyType(
    {
        name: Substance(row.density, row.wall, row.friction, row.restitution)
        for row in _ROWS.values()
        for name in row.of
    }
)


def substance(material: str) -> Substance:
    """Return the substance of a material, or of the one it is a state of; concrete if unknown."""
    return SUBSTANCES.get(material_named(material).root, SUBSTANCES["concrete"])


# Kerb weights, kilograms, of what holds more than its skin shows.
WEIGHTS = table("assets/substances", float, "weights")
VEHICLE_DENSITY = 180.0  # kilograms per cubic metre of collider, of vehicles that are not named
BUILDING_DENSITY = 350.0  # kilograms per cubic metre of a building, storeys and all
# Kilograms of what moves by itself, with who rides it.
MOVER_WEIGHTS = table("assets/substances", float, "mover_weights")

# Semantic class of pieces by how their names begin; others are a class of their own name.
CLASSES = table("assets/substances", str, "classes")
# Pieces that stand by their weight alone. Bicycles are locked, boats moored, posts set in concrete.
LOOSE = frozenset(
    {"bench", "bin", "litter_bin", "planter", "cafe_set", "shop_board", "picnic_table", "boulder",
     "traffic_cone", "vending_machine", "fruit_stand", "flower_stand", "clothes_rail", "cartons"}
)  # fmt: skip
# A box each: what hangs on a post in the ground would fall over without it.
UPRIGHT = frozenset({"litter_bin"})
