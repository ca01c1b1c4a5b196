"""Light, air and weather of a scene, set or changed in one step that touches no geometry."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy
import numpy as np
from numpy.typing import NDArray

from cityx.assets.trees.seasons import SNOWED
from cityx.blender.air import make_air, make_falling
from cityx.blender.leaf_fall import BARE
from cityx.blender.materials import SHOWS, WALKS
from cityx.blender.metering import metered_stops, sunlit_streets
from cityx.blender.render import use_light_tree
from cityx.blender.sky import lamp_balance, light_collection, make_world
from cityx.blender.weather import show_wear, turn_knobs
from cityx.city.camera import Camera
from cityx.city.environment import Environment
from cityx.city.rooms import lit_rooms, room_uses
from cityx.city.scene import Scene
from cityx.city.signals import STATE, people_see, poles_of, sides_of, vehicles_see
from cityx.city.store import View
from cityx.geometry.mirrored import REACH as OUTSKIRTS
from cityx.ground.ground_wear import ground_wear

if TYPE_CHECKING:
    from cityx.city.store import View


# In the sun the plain curve leaves bright walls and streets in the shade nearly alike; under cloud
# and at night, and from above where streets are dark slots between the roofs, it keeps what is dark
# from black.
LOOK, PLAIN = "AgX - Medium High Contrast", "None"
SLOTS = 0.5  # share of the streets seen from above that the sun reaches where they are such
AERIAL_HEIGHT = (15.0, 60.0)  # metres above the ground over which it does so
LAMP_WATTS = 110.0  # radiant, as Blender counts; a lamp post then stands in a readable pool
LAMP_COLOR = (1.0, 0.72, 0.42)  # about 3000 K
SHOP_WATTS = 16.0
SHOP_COLOR = (1.0, 0.83, 0.62)  # about 4000 K
MAX_LAMPS, MAX_SHOPS = 60, 24  # more lights cost noise; farther off only the lamp itself is seen
LAMP_REACH, SHOP_REACH = 150.0, 70.0  # metres
GLOW_MATERIAL = "lamp_glow"
LAMP = "lamp"  # in the name of every prototype that lights a street
BEFORE_PANE, PANE_HEIGHT = 0.45, 2.1  # metres


class Lighting:
    """The light of one scene: a class because the places of lamps are found once, light is kept.

    Parameters
    ----------
    scene
        A scene made by `cityx.blender.scene`.
    view
        The city it was made from.
    """

    def __init__(self, scene: bpy.types.Scene, view: View) -> None:
        self.scene = scene
        self.view = view
        self.shown: Environment | None = None
        self.lamps = lamp_positions(view.scene)
        if view.network is not None and view.lod > 0:
            houses = view.scene.meshes.get("buildings")
            picture, cell = ground_wear(view.network, houses, view.extent, view.lanes)
            show_wear(picture, view.extent[:2], cell)

    def set(self, environment: Environment) -> None:
        """Show an environment: sky, wetness, snow, lit rooms, lamps, air seen from the middle.

        What is shown already stays: a sky made anew is prepared anew.
        """
        if environment == self.shown:
            return
        make_world(self.scene, environment)
        xmin, ymin, xmax, ymax = self.view.extent
        self._air(environment, ((xmin + xmax) / 2, (ymin + ymax) / 2, 0.0))
        turn_knobs(environment)
        for tree in (o for o in bpy.data.objects if BARE in o.modifiers):
            modifier = tree.modifiers[BARE]
            modifier.show_render = modifier.show_viewport = environment.snow > SNOWED
        self.scene.view_settings.view_transform = "AgX"
        self.scene.view_settings.look = LOOK if sunshine(environment) > 0.5 else PLAIN
        self.scene.view_settings.exposure = environment.exposure
        use_light_tree(self.scene, on=environment.lamps > 0)
        self.shown = environment

    def set_for(self, environment: Environment, camera: Camera) -> None:
        """Set what depends on the camera: lights near it, air, drops and flakes before it."""
        height = self._air(environment, camera.position)
        on, balance = environment.lamps > 0, lamp_balance(environment)
        shops = shop_positions(self.view, environment)
        place_lamps(self.scene, self.lamps, shops, camera, on=on, balance=balance)
        make_falling(self.scene, environment, camera, seed=self.view.seed, height=height)
        look, stops = self._metered(environment, camera, risen(height))
        self.scene.view_settings.look = look
        self.scene.view_settings.exposure = environment.exposure + stops

    def _metered(self, environment: Environment, camera: Camera, high: float) -> tuple[str, float]:
        """Return the curve and the stops that a camera takes; without sun nothing is measured."""
        sun = sunshine(environment)
        if sun == 0:
            return PLAIN, 0.0
        if high >= 0.5 and sunlit_streets(self.view, camera, environment) < SLOTS:
            return PLAIN, 0.0
        stops = sun * metered_stops(self.view, camera, environment, high=high)
        return LOOK if sun > 0.5 else PLAIN, stops

    def _air(self, environment: Environment, eye: tuple[float, float, float]) -> float:
        """Fill the scene with air as seen from a point; returns its height above the ground."""
        ground = float(self.view.terrain.height_at([eye[:2]])[0])
        reach = reach_of(eye, self.view.extent)
        make_air(self.scene, environment, reach=reach, ground=ground, eye=eye[2])
        return eye[2] - ground


def risen(height: float) -> float:
    """Return how much a camera looks at a city from above, 0 to 1, by its height in metres."""
    low, high = AERIAL_HEIGHT
    t = min(max((height - low) / (high - low), 0.0), 1.0)
    return t * t * (3 - 2 * t)


def sunshine(environment: Environment) -> float:
    """Return the share of sun by which streets and roofs differ; none under cloud and at night."""
    return (1 - environment.cloud_cover) * float(np.degrees(environment.sun_elevation) > 3.0)


def reach_of(eye: tuple[float, float, float], extent: tuple[float, float, float, float]) -> float:
    """Return the metres from a point to the farthest thing that is seen from it."""
    xmin, ymin, xmax, ymax = extent
    corners = np.array([(x, y) for x in (xmin, xmax) for y in (ymin, ymax)])
    far = np.linalg.norm(corners - np.array(eye[:2]), axis=1).max()
    return float(np.hypot(far, eye[2])) * 1.1 + 100.0 + OUTSKIRTS


def lamp_positions(held: Scene) -> NDArray[np.float64]:
    """Return (n, 3) middles of everything that glows like a street lamp."""
    found = [np.zeros((0, 3))]
    for rows in held.instances.values():
        for index in np.unique(rows.prototype).tolist():
            mesh = held.prototypes[index].mesh
            if GLOW_MATERIAL not in mesh.materials or LAMP not in held.prototypes[index].name:
                continue
            faces = mesh.faces[mesh.material == mesh.materials.index(GLOW_MATERIAL)]
            if not len(faces):
                continue
            corners = mesh.vertices[np.unique(faces[faces >= 0])]
            lamp = (corners.min(axis=0) + corners.max(axis=0)) / 2
            lamp[2] = corners[:, 2].min() - 0.05  # just under the glass, so it hides no light
            chosen = rows.prototype == index
            offset = lamp * rows.scale[chosen]
            found.append(rows.position[chosen] + _turned(offset, rows.rotation[chosen, 2]))
    return np.concatenate(found)


def shop_positions(view: View, environment: Environment) -> NDArray[np.float64]:
    """Return (n, 3) points before the panes of lit shops."""
    rows = view.scene.instances.get("shopfronts")
    if rows is None or not rows.count:
        return np.zeros((0, 3))
    uses = room_uses(view.scene.prototypes, rows, view.objects)
    lit = np.flatnonzero(lit_rooms(rows, uses, environment, view.seed))
    offset = np.tile([0.0, -BEFORE_PANE, PANE_HEIGHT], (len(lit), 1))
    return np.asarray(rows.position[lit] + _turned(offset, rows.rotation[lit, 2]))


def _turned(offset: NDArray[np.float64], turn: NDArray[np.float32]) -> NDArray[np.float64]:
    """Turn (n, 3) offsets about the vertical by (n,) radians."""
    cos, sin = np.cos(turn.astype(float)), np.sin(turn.astype(float))
    x, y, z = offset.T
    return np.column_stack([x * cos - y * sin, x * sin + y * cos, z])


def place_lamps(
    scene: bpy.types.Scene,
    lamps: NDArray[np.float64],
    shops: NDArray[np.float64],
    camera: Camera,
    *,
    on: bool,
    balance: float = 1.0,
) -> int:
    """Put real lights into the lamps and shops nearest to a camera; returns how many.

    Parameters
    ----------
    scene
        The scene; lights placed for another camera go.
    lamps, shops
        (n, 3) and (m, 3) metres.
    camera
        The camera.
    on
        Whether any are lit.
    balance
        Factor on their power.
    """
    collection = light_collection(scene)
    for item in [o for o in collection.objects if o.name.startswith(("Lamp", "Shop"))]:
        bpy.data.objects.remove(item)
    if not on:
        return 0
    lift = max(camera.position[2], 0.0) * 2
    kinds = (
        ("Lamp", lamps, LAMP_WATTS, LAMP_COLOR, MAX_LAMPS, LAMP_REACH + lift, 0.12),
        ("Shop", shops, SHOP_WATTS, SHOP_COLOR, MAX_SHOPS, SHOP_REACH, 0.6),
    )
    made = 0
    for name, spots, watts, color, most, reach, size in kinds:
        distance = np.linalg.norm(spots - np.array(camera.position), axis=1)
        near = np.argsort(distance, kind="stable")[:most]
        near = near[distance[near] < reach]
        light = bpy.data.lights.get(name) or bpy.data.lights.new(name, "POINT")
        light.energy = watts * balance
        light.color, light.shadow_soft_size = color, size
        for index, spot in enumerate(spots[near]):
            item = bpy.data.objects.new(f"{name}_{index:02d}", light)
            item.location = spot
            item.visible_camera = False
            collection.objects.link(item)
        made += len(near)
    return made


def show_signals(view: View, moment: float) -> None:
    """Set what signal poles show, as numbers of their instances that materials read.

    Parameters
    ----------
    view
        The city of the open scene; without signals all stays as it is.
    moment
        Seconds into the tracks.
    """
    if view.signals is None or not view.signals.count:
        return
    for layer, rows in view.scene.instances.items():
        points = bpy.data.objects.get(layer)
        poles = poles_of(rows, view.scene.prototypes)
        if points is None or not len(poles):
            continue
        foot, facing, over = sides_of(rows, poles)
        vehicles = vehicles_see(foot, facing, view.signals, moment)
        people = people_see(over, view.signals, moment)
        # Crossings that no head rules are walked while nobody may drive over them.
        waiting = np.where(vehicles < 0, -1, vehicles == STATE["red"])
        shown = {SHOWS: vehicles + 1, WALKS: np.where(people < 0, waiting, people) + 1}
        for name, values in shown.items():
            every = np.zeros(rows.count, np.float32)
            every[poles] = values
            held = points.data.attributes
            attribute = held.get(name) or held.new(name, "FLOAT", "POINT")
            attribute.data.foreach_set("value", every)
        points.data.update()
