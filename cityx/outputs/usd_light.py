"""The sun of a city as USD carries it: a distant light."""

from __future__ import annotations

from math import degrees
from typing import Any

from pxr import Gf, Vt

from cityx.city.environment import Environment
from cityx.outputs.gltf_light import illuminance_of, sun_light
from cityx.outputs.usd_prims import Types, add_attribute, add_prim

DISC = 0.53  # degrees


def add_sun(parent: Any, environment: Environment) -> Any:
    """Add the light ``Sun``, which shines along its own -z, when the sun is up; else None."""
    if illuminance_of(environment) <= 0:
        return None
    light = sun_light(environment)
    sun = add_prim(parent, "Sun", "DistantLight")
    add_attribute(sun, "inputs:intensity", Types.Float, light["intensity"])
    add_attribute(sun, "inputs:angle", Types.Float, DISC)
    add_attribute(sun, "inputs:color", Types.Color3f, Gf.Vec3f(*light["color"]))
    add_attribute(sun, "cityx:lux", Types.Float, light["extras"]["illuminance_lux"])
    turn = Gf.Vec3f(
        90.0 - degrees(environment.sun_elevation), 0.0, 180.0 - degrees(environment.sun_azimuth)
    )
    add_attribute(sun, "xformOp:rotateXYZ", Types.Float3, turn)
    order = Vt.TokenArray(["xformOp:rotateXYZ"])
    add_attribute(sun, "xformOpOrder", Types.TokenArray, order, uniform=True)
    return sun
