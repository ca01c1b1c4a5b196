"""Pictures of a Blender scene with Cycles."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from math import pi
from pathlib import Path
from typing import Any

import bpy

from cityx.blender.compression import draft_of
from cityx.blender.operators import call
from cityx.city.camera import Camera
from cityx.outputs.cryptomatte import FILTER_WIDTH
from cityx.system.cores import core_count

MAX_BOUNCES = 4
# Noise that the denoiser removes without a trace, and samples from which Cycles looks for it, which
# it does after every 16; 0 leaves that to Cycles, which takes 32 of sky and walls too. By the light
# of lamps a pixel seems clean until a sample meets one.
BY_DAY, BY_LAMPS = (0.15, 8), (0.1, 0)
# A draft: parts of a hundred of the width and height of its picture, and samples per pixel.
DRAFT_PERCENT, DRAFT_SAMPLES = 50, 4
CLIP = (0.1, 100_000.0)  # metres
# Tried in this order; the first kind with a device wins.
GPU_KINDS = ("OPTIX", "CUDA", "HIP", "METAL", "ONEAPI")


def add_camera(scene: bpy.types.Scene, camera: Camera) -> bpy.types.Object:
    """Make a camera and make it the scene's."""
    data = bpy.data.cameras.new(camera.name)
    data.sensor_fit = "HORIZONTAL"
    data.angle = camera.hfov
    data.clip_start, data.clip_end = CLIP
    item = bpy.data.objects.new(camera.name, data)
    item.location = camera.position
    # Blender's camera looks down (-z) with +y up; tilt to the horizon, then turn clockwise.
    item.rotation_euler = (pi / 2 + camera.pitch, 0.0, -camera.heading)
    item["width"], item["height"] = camera.width, camera.height
    held = scene.collection.children.get("Cameras")
    if held is None:
        held = bpy.data.collections.new("Cameras")
        scene.collection.children.link(held)
    held.objects.link(item)
    scene.camera = item
    return item


def set_up(scene: bpy.types.Scene, *, samples: int, gpu: bool = True) -> str:
    """Choose quality and device of Cycles.

    Parameters
    ----------
    scene
        The scene.
    samples
        Samples per pixel, at most.
    gpu
        Whether a GPU is used when there is one.

    Returns
    -------
    device
        "CPU" or the kind of GPU in use.
    """
    scene.render.threads_mode = "FIXED"
    scene.render.threads = min(core_count(), 1024)
    scene.render.use_persistent_data = False
    scene.render.image_settings.file_format = "PNG"
    scene.render.image_settings.color_mode = "RGB"
    scene.render.image_settings.compression = 15
    scene.render.dither_intensity = 1.0
    scene.render.film_transparent = False
    cycles: Any = scene.cycles
    cycles.use_adaptive_sampling = True
    use_quality(scene, samples)
    cycles.filter_width = FILTER_WIDTH / 2  # Cycles counts half of it
    cycles.use_denoising = True
    cycles.denoiser = "OPENIMAGEDENOISE"
    cycles.denoising_quality = "BALANCED"
    cycles.max_bounces = MAX_BOUNCES
    cycles.diffuse_bounces = 3
    cycles.glossy_bounces = 3
    cycles.transparent_max_bounces = 8
    cycles.caustics_reflective = cycles.caustics_refractive = False
    cycles.blur_glossy = 1.0
    cycles.sample_clamp_indirect = 8.0
    device = _gpu() if gpu else "CPU"
    cycles.device = "CPU" if device == "CPU" else "GPU"
    return device


def use_light_tree(scene: bpy.types.Scene, *, on: bool) -> None:
    """Choose lights by a tree when there are lamps: by day, without it, an eighth is saved."""
    cycles: Any = scene.cycles
    cycles.use_light_tree = on


def _gpu() -> str:
    """Switch on the first kind of GPU that has a device; "CPU" when there is none."""
    addon = bpy.context.preferences.addons.get("cycles")
    if addon is None:
        return "CPU"
    preferences: Any = addon.preferences
    for kind in GPU_KINDS:
        try:
            preferences.compute_device_type = kind
            preferences.refresh_devices()
        except (TypeError, RuntimeError):  # this build or this driver does not know the kind
            continue
        devices = [device for device in preferences.devices if device.type == kind]
        if devices:
            for device in preferences.devices:
                device.use = device.type == kind
            return kind
    return "CPU"


def use_quality(
    scene: bpy.types.Scene, samples: int, threshold: float | None = None, seed: int = 0
) -> None:
    """Choose the most samples per pixel, the noise that ends a pixel, and their seed.

    Where the noise is not given, as for pictures for people, it is that of the light of the scene.
    """
    cycles: Any = scene.cycles
    cycles.seed = seed
    cycles.samples = samples
    own = BY_LAMPS if cycles.use_light_tree else BY_DAY
    noise, least = own if threshold is None else (threshold, 0)
    cycles.adaptive_threshold, cycles.adaptive_min_samples = noise, least
    # Without noise in colours and normals the denoiser keeps more of textures.
    cycles.denoising_prefilter = "ACCURATE" if threshold is None else "FAST"


def aim(scene: bpy.types.Scene, camera: bpy.types.Object) -> None:
    """Look through a camera, in pictures of its size."""
    scene.camera = camera
    scene.render.resolution_x = int(camera["width"])
    scene.render.resolution_y = int(camera["height"])
    scene.render.resolution_percentage = 100


def render_picture(scene: bpy.types.Scene, camera: bpy.types.Object, path: Path) -> None:
    """Render one picture to a PNG file that appears when it is complete."""
    aim(scene, camera)
    _write(scene, path)


def keep_prepared(scene: bpy.types.Scene, *, before: bool, after: bool) -> None:
    """Choose what of a picture's preparation is shared: meshes, textures, the sky, trees of faces.

    Another light changes all of it, and lamps that come and go get another order, so that noise
    would depend on the pictures before: such neighbours share nothing.

    Parameters
    ----------
    scene
        The scene.
    before, after
        Whether this picture goes on with what the one before it left, and leaves it to the next.
    """
    if not before:
        scene.render.use_persistent_data = False  # Blender gives up what it holds
    scene.render.use_persistent_data = before or after


@contextmanager
def drafted(scene: bpy.types.Scene, camera: bpy.types.Object, path: Path) -> Iterator[Path]:
    """Render a draft of a picture to a file beside it, which goes when the picture is there.

    Parameters
    ----------
    scene, camera
        As of the picture.
    path
        Of the picture, which is rendered while the draft lies there.
    """
    cycles: Any = scene.cycles
    draft, samples = draft_of(path), cycles.samples
    kept = scene.render.use_persistent_data
    scene.render.use_persistent_data = True  # a picture and its draft share what is prepared
    try:
        aim(scene, camera)
        scene.render.resolution_percentage = DRAFT_PERCENT
        cycles.samples = min(DRAFT_SAMPLES, samples)
        _write(scene, draft)
        cycles.samples = samples
        yield draft
    finally:
        scene.render.use_persistent_data = kept
        draft.unlink(missing_ok=True)


def _write(scene: bpy.types.Scene, path: Path) -> None:
    temporary = path.with_name(f".{path.stem}.partial{path.suffix}")
    path.parent.mkdir(parents=True, exist_ok=True)
    scene.render.filepath = str(temporary)
    scene.render.use_file_extension = False
    call("render.render", write_still=True)
    temporary.replace(path)
