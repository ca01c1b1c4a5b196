"""The picture of a city that notebooks show: what is nearest is seen, in its own colour."""

from dataclasses import replace
from io import BytesIO

import numpy as np
from PIL import Image

from cityx.api.picture import _drawn, picture_of
from cityx.city.camera import Camera
from cityx.city.store import read_view

RED = np.array([0.6, 0.0, 0.0])


def test_of_two_triangles_the_nearer_is_seen_and_none_from_behind():
    camera = Camera("from above", (0.0, 0.0, 10.0), 0.0, -np.pi / 2, np.pi / 2, 40, 40)
    flat = np.array([[-5, -5], [5, -5], [0, 5]], float)
    low, high = (np.column_stack([flat * share, [z] * 3]) for share, z in ((1, 0), (0.25, 5)))
    colors = np.array([[1.0, 0, 0], [0, 1.0, 0]])
    for order in ([0, 1], [1, 0]):
        seen = _drawn(camera, np.array([low, high])[order], colors[order])
        red, green, _ = seen[20, 20]
        assert green > 0.9
        assert red < 0.1
        assert seen[29, 11].argmax() == 0  # only the lower one reaches there
        assert seen[0, 0].argmax() == 2  # sky
    behind = _drawn(camera, np.array([low[::-1]]), colors[:1])
    assert (behind == behind[0, 0]).all()


def test_a_building_that_is_made_red_is_red_in_the_picture(built_town):
    view = read_view(built_town(lod=2) / "city")
    batch = view.scene.meshes["buildings"]
    tinted = replace(batch, tint=np.broadcast_to(RED, batch.tint.shape).astype(np.float32))
    meshes = {**view.scene.meshes, "buildings": tinted}
    red = replace(view, scene=replace(view.scene, meshes=meshes))

    def reds(picture):
        pixels = np.asarray(Image.open(BytesIO(picture)), float)
        assert pixels.shape == (340, 520, 3)
        return (pixels[..., 0] > 2.5 * pixels[..., 1:].max(axis=2)).mean()

    before = picture_of(view)
    assert picture_of(view) == before
    assert reds(picture_of(red)) > reds(before) + 0.01


def test_a_city_without_anything_built_has_no_picture(built_town):
    view = read_view(built_town(lod=2) / "city")
    assert picture_of(replace(view, scene=replace(view.scene, meshes={}, instances={}))) == b""
