"""Small forms of arrays: near enough, on one grid, and the same once they are decoded."""

from io import BytesIO

import numpy as np
import pytest

from cityx.outputs import packing
from cityx.outputs.gltf_buffer import GltfBuffer
from cityx.outputs.packing import (
    PER_TILE,
    Packer,
    on_grid,
    small_normals,
    small_places,
    used_vertices,
)

RNG = np.random.default_rng(5)


def back(grid):
    return grid.steps[:, :3] * grid.scale + grid.origin


def test_positions_come_back_within_two_millimetres_on_each_axis():
    points = RNG.uniform([-120, 0, -120], [120, 90, 120], (5000, 3))
    grid = on_grid(points)
    assert grid.steps.dtype == np.uint16
    assert np.abs(back(grid) - points).max() < 0.002


def test_neighbours_that_share_a_place_share_it_once_packed():
    seam = RNG.uniform(0, 50, (200, 3))
    west, east = (on_grid(np.concatenate([seam, RNG.uniform(low, low + 150, (300, 3))]))
                  for low in (-150, 40))  # fmt: skip
    np.testing.assert_array_equal(back(west)[:200], back(east)[:200])


def test_what_reaches_too_far_for_sixteen_bits_stays_in_floating_point():
    points = np.array([[0.0, 0, 0], [3000, 1, -3000]])
    grid = on_grid(points)
    assert (grid.steps.dtype, grid.scale) == (np.float32, 1.0)
    assert np.abs(back(grid) - points).max() < 0.003


def test_normals_turn_by_less_than_half_a_degree():
    normal = RNG.normal(size=(1000, 3))
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    small = small_normals(normal.astype(np.float32))[:, :3] / 127
    small /= np.linalg.norm(small, axis=1, keepdims=True)
    turn = np.degrees(np.arccos(np.clip((small * normal).sum(axis=1), -1, 1)))
    assert turn.max() < 0.5


def test_texture_places_keep_their_tiles_and_lose_whole_ones():
    uv = RNG.uniform(1000, 1080, (500, 2)).astype(np.float32)
    small = small_places(uv)
    assert small.dtype == np.int16
    shift = uv - small / PER_TILE
    assert np.abs(shift - np.round(shift)).max() < 0.003
    assert len(np.unique(np.round(shift), axis=0)) == 1
    assert small_places(uv * 100).dtype == np.float32


@pytest.mark.parametrize("installed", [True, False])
def test_triangles_are_the_same_with_and_without_the_codec(monkeypatch, installed):
    if not installed:
        monkeypatch.setattr(packing, "codec", lambda: None)
    elif packing.codec() is None:
        pytest.skip("the codec is not installed")
    index = RNG.integers(20, 60, 120).astype(np.uint32)  # the first 20 are not used
    corners, kept = used_vertices(index)
    assert len(kept) == len(np.unique(index))
    assert sorted(kept[corners].reshape(-1, 3).sum(axis=1)) == sorted(
        index.reshape(-1, 3).sum(axis=1)
    )


def test_without_the_codec_a_file_needs_no_extension_but_quantised_meshes(monkeypatch):
    monkeypatch.setattr(packing, "codec", lambda: None)
    packer = Packer(GltfBuffer())
    grid = on_grid(RNG.uniform(0, 5, (30, 3)))
    index = np.arange(30, dtype=np.uint32)
    normal, uv = np.tile(np.float32([0, 1, 0]), (30, 1)), np.zeros((30, 2), np.float32)
    packer.primitive(grid.steps, normal, uv, None, index)
    assert packer.extensions == {"KHR_mesh_quantization"}
    packer.buffer.write(BytesIO(), {"asset": {"version": "2.0"}})
    assert "EXT_meshopt_compression" not in str(packer.buffer.document)
