"""Metering: how much light falls on the ground that a camera sees, by sun and by open sky."""

from __future__ import annotations

from math import cos, pi, sin, tan

import numpy as np
from numpy.typing import NDArray

from cityx.city.camera import Camera, project
from cityx.city.environment import Environment
from cityx.city.store import View
from cityx.geometry.arrays import FloatArray
from cityx.geometry.polylines import arc_lengths, every, locate
from cityx.geometry.raycast import RayScene, cast, ray_scene

# A camera follows the light only in part, as the eye does: shade stays darker than sun.
FOLLOWED = 0.6
MOST_STOPS = 1.9
# Stops that it closes where a high sun shines on all it sees, since roofs and walls are paler than
# the ground that is metered; ever less the more it opens for shade.
SUNLIT = 0.5
HIGH_SUN = 0.5  # sine of its elevation from which it closes by all of them
SUN_TO_SKY = 5.0  # light of a high sun on a level surface for each of the clear sky, CIE 110
BOUNCED = 0.25  # of the light of the sky that walls give back
COLUMNS, ROWS = np.linspace(-0.8, 0.8, 5), np.linspace(-0.95, 0.35, 8)  # of the picture, -1 to 1
FARTHEST = 60.0  # metres from the eye to the ground that is metered
ABREAST, EVERY = 3.0, 4.0  # of a high lens the farthest, in heights above the ground; metres from
# one place on a street to the next
HIGHEST = 80.0  # metres from metered ground to houses that may shade it
ABOVE = 0.3  # metres above the ground at which light is measured
SOLID = ("buildings", "structures", "decks")  # layers that shade
# Directions over the sky, of equal weight for a level surface.
RINGS, SECTORS = 3, 8


def metered_stops(view: View, camera: Camera, environment: Environment, *, high: float) -> float:
    """Return the stops by which a camera opens for shade, or closes in the sun.

    Parameters
    ----------
    view, camera, environment
        As of `shade_stops`.
    high
        0 to 1, how much the camera looks at the city from above, where shade does not count.
    """
    shade = (1 - high) * shade_stops(view, camera, environment) if high < 1 else 0.0
    glare = min(max(sin(environment.sun_elevation), 0.0) / HIGH_SUN, 1.0)
    return shade - glare * max(SUNLIT - shade / 2, 0.0)


def shade_stops(view: View, camera: Camera, environment: Environment) -> float:
    """Return the stops by which a camera opens for ground in shade; 0 where the sun shines.

    Parameters
    ----------
    view
        The city; its solid layers cast the shade.
    camera
        What sees the ground. Only ground in the picture counts, and what no house hides.
    environment
        Where the sun stands.
    """
    if environment.sun_elevation <= 0:
        return 0.0
    ground = float(view.terrain.height_at([camera.position[:2]])[0])
    solid = solid_near(view, camera.position, FARTHEST)
    spots = _in_sight(solid, camera, ground_seen(camera, ground))
    if not len(spots):
        return 0.0
    light = np.mean(np.log2(light_on(spots, solid, environment)))
    return float(np.clip(-FOLLOWED * light, 0.0, MOST_STOPS))


def sunlit_streets(view: View, camera: Camera, environment: Environment) -> float:
    """Return the share of the streets that a camera over a city sees on which the sun shines.

    Parameters
    ----------
    view, camera, environment
        As of `shade_stops`. Streets in the picture count that no house or bridge hides; 1 where
        there are none. The shade of trees is left out.
    """
    network = view.network
    if environment.sun_elevation <= 0 or network is None or not network.edge_count:
        return 1.0
    place = np.array(camera.position)
    reach = ABREAST * (place[2] - float(view.terrain.height_at(place[None, :2])[0]))
    lines = network.lines
    xy = locate(lines, *every(arc_lengths(lines)[1], EVERY))[0]
    spots = np.column_stack([xy, view.terrain.height_at(xy) + ABOVE])
    pixel, depth = project(camera, spots)
    framed = ((pixel > 0) & (pixel < (camera.width, camera.height))).all(axis=1) & (depth > 0)
    spots = spots[framed & (np.hypot(*(xy - place[:2]).T) < reach)]
    solid = solid_near(view, camera.position, reach)
    spots = _in_sight(solid, camera, spots)
    if not len(spots):
        return 1.0
    sun = np.broadcast_to(_to_sun(environment), spots.shape)
    return 1.0 - float(_blocked(solid, spots, sun, HIGHEST + FARTHEST).mean())


def ground_seen(camera: Camera, ground: float) -> FloatArray:
    """(n, 3) places a little above level ground that a grid of the picture's rays meets."""
    half = tan(camera.hfov / 2)
    x, y = (part.ravel() for part in np.meshgrid(COLUMNS * half, ROWS * half * camera.height
                                                 / camera.width))  # fmt: skip
    ahead = np.array([sin(camera.heading), cos(camera.heading), 0.0])
    right = np.array([ahead[1], -ahead[0], 0.0])
    up = np.array([0.0, 0.0, 1.0])
    forward = cos(camera.pitch) * ahead + sin(camera.pitch) * up
    top = cos(camera.pitch) * up - sin(camera.pitch) * ahead
    rays = forward + x[:, None] * right + y[:, None] * top
    fall = camera.position[2] - (ground + ABOVE)
    rays = rays[rays[:, 2] * FARTHEST < -abs(fall) * 0.5]
    met = np.array(camera.position) + rays * (fall / -rays[:, 2])[:, None]
    near = np.hypot(*(met - camera.position)[:, :2].T) < FARTHEST
    return np.asarray(met[near & (fall > 0)])


def light_on(spots: FloatArray, solid: RayScene, environment: Environment) -> FloatArray:
    """(n,) light on level places as a share of that in the open under the same sun and sky."""
    sun = _to_sun(environment)
    lit = ~_blocked(solid, spots, np.broadcast_to(sun, spots.shape), HIGHEST + FARTHEST)
    rings = (np.arange(RINGS) + 0.5) / RINGS
    turn = 2 * pi * (np.arange(SECTORS) + 0.5) / SECTORS
    out, high = np.sqrt(rings), np.sqrt(1 - rings)
    sky = np.stack(
        [np.outer(out, np.sin(turn)), np.outer(out, np.cos(turn)), np.repeat(high, SECTORS).reshape(
            RINGS, SECTORS)], axis=-1,
    ).reshape(-1, 3)  # fmt: skip
    blocked = _blocked(solid, np.repeat(spots, len(sky), axis=0), np.tile(sky, (len(spots), 1)),
                       HIGHEST + FARTHEST)  # fmt: skip
    seen = 1 - blocked.reshape(len(spots), -1).mean(axis=1)
    power = SUN_TO_SKY * float(sun[2])
    found = power * lit + seen + BOUNCED * (1 - seen)
    return np.asarray(found / (power + 1))


def _to_sun(environment: Environment) -> FloatArray:
    """(3,) direction to the sun."""
    elevation, azimuth = environment.sun_elevation, environment.sun_azimuth
    level = cos(elevation)
    return np.array([level * sin(azimuth), level * cos(azimuth), sin(elevation)])


def solid_near(view: View, place: tuple[float, float, float], reach: float) -> RayScene:
    """Return the faces of solid layers that shade or hide ground within reach of a place."""
    meshes = [view.scene.meshes[layer] for layer in SOLID if layer in view.scene.meshes]
    corners, faces = [], []
    for mesh in meshes:
        triangles = mesh.triangles()[0]
        gap = np.abs(mesh.vertices[:, :2] - np.array(place[:2])).max(axis=1)
        near = triangles[(gap < reach + HIGHEST)[triangles].any(axis=1)]
        used, index = np.unique(near, return_inverse=True)
        corners.append(mesh.vertices[used])
        faces.append(index.reshape(-1, 3))
    whole = np.broadcast_to(np.eye(3, 4), (len(meshes), 3, 4))
    return ray_scene(corners, faces, np.arange(len(meshes)), whole)


def _in_sight(solid: RayScene, camera: Camera, spots: FloatArray) -> FloatArray:
    """Return the (n, 3) places that nothing hides from a camera."""
    eye = np.array(camera.position)
    return spots[~_blocked(solid, np.broadcast_to(eye, spots.shape), spots - eye, 1.0)]


def _blocked(
    solid: RayScene, origins: FloatArray, directions: FloatArray, reach: float
) -> NDArray[np.bool_]:
    """(r,) whether rays meet a face within so many lengths of their directions."""
    return np.asarray(cast(solid, origins, directions, reach=reach).instance >= 0)
