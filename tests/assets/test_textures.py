import numpy as np
import pytest

from cityx.assets.styles.materials import MATERIALS
from cityx.assets.textures import PATTERNS, texture
from cityx.assets.textures.noise import cells, fractal, gradient_noise, value_noise
from cityx.assets.textures.relief import lay, linear_from_srgb_bytes, normal_bytes, srgb_bytes
from cityx.errors import UsageError

SIZE = 64


def seam_ratio(pixels, axis):
    """Step across the wrap against the largest step inside, over whole lines."""
    values = pixels.astype(float)
    steps = np.abs(np.diff(values, axis=axis, append=np.take(values, [0], axis=axis)))
    lines = steps.mean(axis=tuple(i for i in range(values.ndim) if i != axis))
    return lines[-1] / max(lines[:-1].max(), 1.0)


def test_every_material_has_its_texture():
    wanted = {material.texture for material in MATERIALS.values() if material.texture}
    assert wanted <= set(PATTERNS)


@pytest.mark.parametrize("name", PATTERNS)
def test_maps_have_their_form(name):
    maps = texture(name, SIZE)
    assert maps.color.shape == maps.normal.shape == (SIZE, SIZE, 3)
    assert maps.roughness.shape == (SIZE, SIZE)
    assert {maps.color.dtype, maps.normal.dtype, maps.roughness.dtype} == {np.dtype(np.uint8)}
    assert not maps.color.flags.writeable


@pytest.mark.parametrize("name", PATTERNS)
def test_color_maps_are_neutral_with_the_published_mean(name):
    maps = texture(name, SIZE)
    channels = linear_from_srgb_bytes(maps.color).mean(axis=(0, 1))
    np.testing.assert_allclose(channels, maps.mean, atol=0.004)
    assert maps.roughness.mean() / 255 == pytest.approx(maps.roughness_mean)


@pytest.mark.parametrize("name", PATTERNS)
def test_textures_tile_without_a_seam(name):
    maps = texture(name, 256)
    for pixels in (maps.color, maps.normal):
        for axis in (0, 1):
            assert seam_ratio(pixels, axis) <= 1.6


@pytest.mark.parametrize("name", PATTERNS)
def test_normals_are_unit_and_lean_nowhere_on_average(name):
    normal = texture(name, SIZE).normal.astype(float) / 127.5 - 1
    np.testing.assert_allclose(np.linalg.norm(normal, axis=2), 1, atol=0.02)
    slope = normal[..., :2] / normal[..., 2:]
    assert np.abs(slope.mean(axis=(0, 1))).max() < 0.12


def test_normals_follow_the_opengl_form():
    ramp = np.tile(np.arange(8, dtype=np.float32)[:, None], (1, 8))  # higher towards v = 1
    assert normal_bytes(ramp, 8.0)[4, 4].tolist() == [128, 37, 218]  # leans down, -y


def test_a_texture_is_the_same_every_time():
    first = texture("brick", 48).color.copy()
    texture.cache_clear()
    np.testing.assert_array_equal(texture("brick", 48).color, first)


def test_an_unknown_pattern_names_the_nearest():
    with pytest.raises(UsageError, match='Did you mean "brick"'):
        texture("briks")


@pytest.mark.parametrize("noise", [value_noise, gradient_noise])
def test_noise_wraps_around(noise):
    values = noise("test", 64, 8, 4)
    inside = np.abs(np.diff(values, axis=1)).max()
    assert np.abs(values[:, 0] - values[:, -1]).max() <= inside * 1.01


def test_fractal_noise_has_no_mean_and_stays_small():
    values = fractal("test", 128, 6, octaves=5)
    assert abs(values.mean()) < 0.1
    assert np.abs(values).max() < 2


def test_nearest_points_are_nearer_than_the_second():
    near, far, index = cells("test", 64, 6)
    assert (near <= far).all()
    assert set(np.unique(index)) == set(range(36))


def test_courses_hold_whole_blocks():
    wall = lay("test", 96, 2.0, 4, 6)
    counts = np.bincount(wall.index.ravel())
    assert len(counts) == 24
    assert (counts == 96 * 96 // 24).all()
    assert wall.edge.min() >= 0


def test_srgb_bytes_survive_decoding():
    codes = np.arange(256, dtype=np.uint8).reshape(16, 16)
    decoded = linear_from_srgb_bytes(codes).astype(np.float32)
    np.testing.assert_array_equal(srgb_bytes(decoded), codes)
