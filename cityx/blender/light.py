"""Light, air and weather of a scene, set or changed in one step that touches no geometry."""

from __future__ import annotations

import bpy
import numpy as np

from cityx.assets.trees.leaf_fall import SNOWED
from cityx.blender.air import make_air
from cityx.blender.lamps import lamp_positions, place_lamps, shop_positions
from cityx.blender.leaf_fall import BARE
from cityx.blender.metering import metered_stops, sunlit_streets
from cityx.blender.rain_and_snow import make_falling
from cityx.blender.render import use_light_tree
from cityx.blender.sky import lamp_balance, make_world
from cityx.blender.weather import show_wear, turn_knobs
from cityx.city.camera import Camera
from cityx.city.environment import Environment
from cityx.city.store import View
from cityx.geometry.mirrored import REACH as OUTSKIRTS
from cityx.ground.ground_wear import ground_wear

# In the sun the plain curve leaves bright walls and streets in the shade nearly alike; under cloud
# and at night, and from above where streets are dark slots between the roofs, it keeps what is dark
# from black.
LOOK, PLAIN = "AgX - Medium High Contrast", "None"
SLOTS = 0.5  # share of the streets seen from above that the sun reaches where they are such
AERIAL_HEIGHT = (15.0, 60.0)  # metres above the ground over which it does so


class Lighting:
    """The light of one scene: a class because the places of lamps are found once.

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
        self.lamps = lamp_positions(view.scene)
        if view.network is not None and view.lod > 0:
            houses = view.scene.meshes.get("buildings")
            picture, cell = ground_wear(view.network, houses, view.extent, view.lanes)
            show_wear(picture, view.extent[:2], cell)

    def set(self, environment: Environment) -> None:
        """Show an environment: sky, wetness, snow, lit rooms, lamps, air seen from the middle."""
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
