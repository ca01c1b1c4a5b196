"""Bodies in a USD layer: collision, mass and friction by the schemas of UsdPhysics.

A mesh collides by an approximation of itself, so that prims stay as they are: what stands fast by
its faces, what moves by its box, its hull or a decomposition. The exact convex parts are those of
``city_bodies.npz``.
"""

from __future__ import annotations

from typing import Any

from pxr import Gf

from cityx.assets.colliders import Thing
from cityx.geometry.convex import Box
from cityx.outputs.usd_prims import Types, add_attribute, add_prim, apply_schemas, point_at

COLLIDES = ("PhysicsCollisionAPI", "PhysicsMeshCollisionAPI")
MOVES = ("PhysicsRigidBodyAPI", "PhysicsMassAPI")


class UsdPhysics:
    """The physics of a layer in the making: its gravity and its materials."""

    def __init__(self, city: Any) -> None:
        world = add_prim(city, "Physics", "PhysicsScene")
        add_attribute(world, "physics:gravityDirection", Types.Vector3f, Gf.Vec3f(0, 0, -1))
        add_attribute(world, "physics:gravityMagnitude", Types.Float, 9.81)
        self._scope = add_prim(city, "Touch", "Scope")
        self._made: dict[tuple[float, float], Any] = {}

    def fixed(self, mesh: Any, touch: tuple[float, float]) -> None:
        """Add collision by faces to a mesh with the schemas `COLLIDES`."""
        self._collide(mesh, "none", touch)

    def thing(self, mesh: Any, thing: Thing) -> None:
        """Add collision, and rigid-body schemas if loose, to a prototype (see `schemas_of`)."""
        box = len(thing.collider) == 1 and isinstance(thing.collider[0], Box)
        several = "convexDecomposition" if len(thing.collider) > 1 else "convexHull"
        self._collide(mesh, "boundingCube" if box else several, (thing.friction, thing.restitution))
        if thing.motion == "free":
            add_attribute(mesh, "physics:mass", Types.Float, thing.mass)

    def _collide(self, mesh: Any, how: str, touch: tuple[float, float]) -> None:
        add_attribute(mesh, "physics:approximation", Types.Token, how, uniform=True)
        point_at(mesh, "material:binding:physics", [self._material(touch).path])

    def _material(self, touch: tuple[float, float]) -> Any:
        """Return the prim of a friction and a restitution."""
        if touch not in self._made:
            friction, restitution = touch
            prim = add_prim(self._scope, f"touch_{len(self._made)}", "Material")
            apply_schemas(prim, "PhysicsMaterialAPI")
            for name, value in (("staticFriction", friction), ("dynamicFriction", friction),
                                ("restitution", restitution)):  # fmt: skip
                add_attribute(prim, f"physics:{name}", Types.Float, value)
            self._made[touch] = prim
        return self._made[touch]


def schemas_of(thing: Thing) -> tuple[str, ...]:
    """Return the schemas of the body of a prototype; none of what has no shape."""
    if not thing.collider:
        return ()
    return (*MOVES, *COLLIDES) if thing.motion == "free" else COLLIDES
