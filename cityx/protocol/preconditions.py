"""Preconditions: the part of an action's limitation that a machine checks."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

from cityx.errors import UsageError

if TYPE_CHECKING:
    from cityx.city.city import City

TABLES = ("buildings", "parts", "roads", "areas", "lines", "points")
TESTS = ("has_layer", "has_network", "has_ground", "has_relief", "count_at_most")


@dataclass(frozen=True)
class Pre:
    """One test of the city.

    Attributes
    ----------
    test
        One of `TESTS`.
    layer
        The layer it is about, or "".
    limit
        Number it compares with.
    """

    test: str
    layer: str = ""
    limit: int = 0

    def __post_init__(self) -> None:
        """Refuse a test that does not exist."""
        if self.test not in TESTS:
            raise UsageError(f'There is no test "{self.test}"; known are {", ".join(TESTS)}.')

    def __str__(self) -> str:
        """Return the sentence shown to people and models."""
        return {
            "has_layer": f"Needs at least one object in layer {self.layer}.",
            "has_network": "Needs a road network.",
            "has_ground": "Needs the ground arrangement.",
            "has_relief": "Needs terrain that is not flat.",
            "count_at_most": f"Takes at most {self.limit} objects in layer {self.layer}.",
        }[self.test]

    def holds(self, city: City) -> bool:
        """Return whether the city passes."""
        if self.test == "has_network":
            return city.network is not None
        if self.test == "has_ground":
            return city.ground is not None
        if self.test == "has_relief":
            return not city.terrain.is_flat
        count = layer_count(city, self.layer)
        return count >= 1 if self.test == "has_layer" else count <= self.limit

    def to_json(self) -> dict[str, Any]:
        """Return a plain dictionary."""
        return asdict(self)

    @classmethod
    def from_json(cls, record: Mapping[str, Any]) -> Pre:
        """Rebuild a precondition from `to_json`."""
        return cls(**record)


def layer_count(city: City, layer: str) -> int:
    """Count the objects of a layer: a table of the layout, meshes or instances of the scene."""
    if layer in TABLES:
        return len(getattr(city.layout, layer))
    meshes = city.scene.meshes.get(layer)
    rows = city.scene.instances.get(layer)
    return (meshes.count if meshes else 0) + (rows.count if rows else 0)


def has_layer(layer: str) -> Pre:
    """Demand at least one object in a layer of the layout or the scene."""
    return Pre("has_layer", layer)


def has_network() -> Pre:
    """Demand that the road network was made."""
    return Pre("has_network")


def has_ground() -> Pre:
    """Demand that the ground arrangement was made."""
    return Pre("has_ground")


def has_relief() -> Pre:
    """Demand terrain with heights."""
    return Pre("has_relief")


def count_at_most(layer: str, limit: int) -> Pre:
    """Demand that a layer holds no more than `limit` objects."""
    return Pre("count_at_most", layer, limit)
