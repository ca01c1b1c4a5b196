"""A scene that is pictured many times: in one light, at one moment, from one eye after another."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import bpy

from cityx.blender import grass
from cityx.blender.animation import set_moment
from cityx.blender.leaf_fall import show_twigs
from cityx.blender.light import Lighting
from cityx.blender.materials import MaterialLibrary
from cityx.blender.movers import show_movers
from cityx.blender.outskirts import Outskirts
from cityx.blender.passes import render_passes, use_passes
from cityx.blender.signal_lights import show_signals
from cityx.city.camera import Camera
from cityx.city.environment import Environment

if TYPE_CHECKING:
    from cityx.city.store import View


class Studio:
    """A scene and what differs from picture to picture; each depends on its own wishes alone.

    Parameters
    ----------
    scene
        The scene.
    view
        The city it was made of.
    lighting
        Its light.
    library
        Its materials.
    staged
        Whether movers come and go with the moment; if not, the scene holds those of the view.
    animated
        Whether movers have keyframes, so that a moment is a frame.
    """

    def __init__(
        self,
        scene: bpy.types.Scene,
        view: View,
        lighting: Lighting,
        library: MaterialLibrary,
        *,
        staged: bool,
        animated: bool = False,
    ) -> None:
        self.scene, self.view, self.lighting, self.library = scene, view, lighting, library
        self.staged, self.animated = staged, animated
        self.moment: float | None = None
        self.outskirts: Outskirts | None = None

    def show(
        self, environment: Environment, camera: Camera, moment: float | None, *, truth: bool = False
    ) -> None:
        """Set light, grass, movers, signals and outskirts; a moment of None is that of the view.

        A picture that is read as truth shows the site alone.
        """
        if not truth and self.outskirts is None:
            self.outskirts = Outskirts(self.scene, self.view)
        if self.outskirts is not None:
            self.outskirts.show(None if truth else camera)
        show_twigs(bpy.data.objects, shown=not truth)
        wanted = self.view.moment if moment is None else moment
        if self.staged and wanted != self.moment:
            show_movers(self.scene, self.view, wanted, self.library)
        elif self.animated:
            set_moment(self.scene, wanted)
        if wanted != self.moment:
            show_signals(self.view, wanted)
        self.moment = wanted
        self.lighting.set(environment)
        self.lighting.set_for(environment, camera)
        grass.sow(self.scene, replace(self.view, environment=environment), camera, self.library)

    def passes(
        self, item: bpy.types.Object, path: Path, names: Sequence[str], *, denoise: bool
    ) -> dict[str, Any]:
        """Render a picture with passes; returns what is known of it."""
        use_passes(self.scene, names, denoise=denoise)
        return render_passes(self.scene, item, path)
