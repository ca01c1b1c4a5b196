"""Rooms behind windows: what they are used for, and which of them are lit.

No geometry depends on it: a window is lit when the hash of its id falls below the share of its use.
Blender compares the two in a shader; exports choose when they are written.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cityx.city.environment import Environment
from cityx.city.scene import Instances, Prototype, Scene
from cityx.ids import uniform

if TYPE_CHECKING:
    from cityx.city.store import View

# Kinds of prototype whose glass has a room behind it.
ROOM_KINDS = frozenset({"window", "door", "shopfront"})
DARK, LIT = "glass", "window_lit"  # materials of their panes
LIT_DRAW = "blender/instance"
HOME, WORK, SHOP = 0, 1, 2
# Values of building=* whose windows are those of a workplace, and of shops.
_WORK = (
    "office commercial industrial warehouse school university college kindergarten hospital civic "
    "government public townhall library museum train_station station factory manufacture church "
    "cathedral chapel mosque synagogue temple fire_station police data_center sports_hall hangar"
)
_SHOP = "retail supermarket mall shop shops kiosk restaurant pub department_store"
USES: Mapping[str, int] = MappingProxyType(
    {**dict.fromkeys(_WORK.split(), WORK), **dict.fromkeys(_SHOP.split(), SHOP)}
)


def room_uses(
    prototypes: Sequence[Prototype], rows: Instances, objects: Mapping[int, Mapping[str, str]]
) -> NDArray[np.int8]:
    """Return the use of the room behind each row: 0 home, 1 work, 2 shop; (n,).

    Parameters
    ----------
    prototypes
        Of the scene; a shopfront has a shop behind it whatever the building is.
    rows
        The instances.
    objects
        Building id to its "use", a value of building=*; unknown ones are homes.
    """
    owners, index = np.unique(rows.owner, return_inverse=True)
    of_owner = [USES.get(objects.get(owner, {}).get("use", ""), HOME) for owner in owners.tolist()]
    shop = np.array([prototype.kind == "shopfront" for prototype in prototypes], bool)
    use = np.array(of_owner, np.int8)[index] if rows.count else np.zeros(0, np.int8)
    return np.where(shop[rows.prototype], np.int8(SHOP), use) if rows.count else use


def room_draws(seed: int, rows: Instances) -> NDArray[np.float64]:
    """Return the number in [0, 1) of each row, (n,), below which share its room is lit."""
    return uniform(seed, LIT_DRAW, rows.object_id)


def lit_rooms(
    rows: Instances, uses: NDArray[np.int8], environment: Environment, seed: int
) -> NDArray[np.bool_]:
    """Return which rooms are lit, (n,)."""
    share = np.array(environment.rooms_lit)[uses]
    return np.asarray(room_draws(seed, rows) < share)


def lit_scene(view: View) -> Scene:
    """Return the scene of a view with the lit rooms' panes in the material of lit windows.

    Lit windows get prototypes of their own, `NAME_lit`, which follow those of the scene.
    """
    if not any(view.environment.rooms_lit):
        return view.scene
    prototypes = list(view.scene.prototypes)
    panes = np.array([p.kind in ROOM_KINDS and DARK in p.mesh.materials for p in prototypes], bool)
    twin: dict[int, int] = {}
    layers = dict(view.scene.instances)
    for layer, rows in layers.items():
        if not rows.count or not panes[rows.prototype].any():
            continue
        uses = room_uses(view.scene.prototypes, rows, view.objects)
        lit = lit_rooms(rows, uses, view.environment, view.seed) & panes[rows.prototype]
        number = rows.prototype.copy()
        for index in np.unique(rows.prototype[lit]).tolist():
            if index not in twin:
                twin[index] = len(prototypes)
                prototypes.append(_lit(prototypes[index]))
            number[lit & (rows.prototype == index)] = twin[index]
        layers[layer] = replace(rows, prototype=number)
    return replace(view.scene, prototypes=tuple(prototypes), instances=MappingProxyType(layers))


def _lit(prototype: Prototype) -> Prototype:
    """Return a window with a lit room behind its panes."""
    mesh = prototype.mesh
    materials = tuple(LIT if name == DARK else name for name in mesh.materials)
    return replace(prototype, name=f"{prototype.name}_lit", mesh=replace(mesh, materials=materials))
