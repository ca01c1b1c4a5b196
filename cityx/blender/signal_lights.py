"""Lights of signals in a scene: what they show at the moment of a picture."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy
import numpy as np

from cityx.blender.materials import SHOWS, WALKS
from cityx.city.signal_poles import people_see, vehicles_see
from cityx.city.signals import STATE

if TYPE_CHECKING:
    from cityx.city.store import View

POLES = "traffic_signal"  # how the names of poles with lights begin
ACROSS = 4.0  # metres from a pole over the lanes beside it, where a crossing may be


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
    named = np.array([each.name.startswith(POLES) for each in view.scene.prototypes], bool)
    for layer, rows in view.scene.instances.items():
        points = bpy.data.objects.get(layer)
        poles = np.flatnonzero(named[rows.prototype]) if rows.count else np.zeros(0, np.int64)
        if points is None or not len(poles):
            continue
        foot, yaw = rows.position[poles, :2].astype(float), rows.rotation[poles, 2].astype(float)
        facing = np.column_stack([np.sin(yaw), -np.cos(yaw)])  # their lights look along -y
        over = ACROSS * np.column_stack([np.cos(yaw), np.sin(yaw)])  # what walkers see looks there
        vehicles = vehicles_see(foot, facing, view.signals, moment)
        people = people_see(foot + over, view.signals, moment)
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
