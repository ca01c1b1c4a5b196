import json

import numpy as np
import pytest

from cityx.outputs.cryptomatte import (
    FILTER_WIDTH,
    coverage_of,
    filter_offsets,
    header,
    manifest,
    matte,
    murmur3,
    name_bits,
    ranked,
)

OpenEXR = pytest.importorskip("OpenEXR", reason="the extra `dataset` is not installed")


def test_the_hash_is_murmur3():
    # Published vectors of MurmurHash3 x86_32 with seed 0.
    assert murmur3(b"") == 0
    assert murmur3(b"test") == 0xBA6BD213
    assert murmur3(b"Hello, world!") == 0xC0363E43
    assert murmur3(b"The quick brown fox jumps over the lazy dog") == 0x2E4FF723


def test_names_hash_as_blender_writes_them():
    # From the header of a file that Blender 4.5 wrote.
    assert manifest(["building_8946ef44c2f3f776", "ground", "0001_lamp_post"]) == {
        "0001_lamp_post": "d3495d7f", "building_8946ef44c2f3f776": "af4f9b77",
        "ground": "c5b51ede",
    }  # fmt: skip
    assert set(header("ViewLayer.CryptoObject", {})) == {
        f"cryptomatte/542cafa/{key}" for key in ("name", "hash", "conversion", "manifest")
    }


def test_every_name_is_a_number_that_is_neither_denormal_nor_infinite():
    bits = np.array([name_bits(f"{i:016x}") for i in range(20_000)], np.uint32)
    raw = np.array([murmur3(f"{i:016x}".encode()) for i in range(20_000)], np.uint32)
    exponent = bits >> 23 & 0xFF
    assert ((exponent > 0) & (exponent < 255)).all()
    turned = bits != raw
    assert 50 < turned.sum() < 300  # two exponents of 256
    assert (bits[turned] ^ raw[turned] == 1 << 23).all()


def test_rays_spread_like_the_filter_of_blackman_and_harris():
    spots = filter_offsets(16)
    x = np.sort(spots[:, 0])
    assert np.array_equal(np.sort(spots[:, 1]), x)
    assert abs(np.corrcoef(spots.T)[0, 1]) < 0.05
    assert np.allclose(x, -x[::-1])
    assert np.abs(x).max() < FILTER_WIDTH / 2
    # Its standard deviation is 0.1318 of its width: integral of x^2 w over that of w.
    u = np.linspace(-0.5, 0.5, 20_001)
    turn = 2 * np.pi * (u + 0.5)
    w = 0.35875 - 0.48829 * np.cos(turn) + 0.14128 * np.cos(2 * turn) - 0.01168 * np.cos(3 * turn)
    assert x.std() == pytest.approx(FILTER_WIDTH * np.sqrt((u**2 * w).sum() / w.sum()), rel=0.01)


def test_things_are_ranked_by_their_share_of_the_rays():
    seen = np.array([[5, 3, 5, 0], [0, 0, 0, 0], [9, 9, 9, 9], [2, 7, 7, 2]])
    number, share = ranked(seen)
    assert number[:, :3].tolist() == [[5, 3, 0], [0, 0, 0], [9, 0, 0], [2, 7, 0]]
    assert share[:, :3].tolist() == [[0.5, 0.25, 0], [0, 0, 0], [1, 0, 0], [0.5, 0.5, 0]]


def test_no_more_than_six_things_are_kept_and_the_largest_are():
    seen = np.array([[1, 2, 3, 4, 5, 6, 7, 8, 8, 8, 7, 0]])
    number, share = ranked(seen)
    assert number.tolist() == [[8, 7, 1, 2, 3, 4]]
    assert share.sum() == pytest.approx(9 / 12)


def decoded(path, layer):
    """Read a matte as the specification says: header first, then ids by their bits."""
    with OpenEXR.File(str(path), separate_channels=True) as file:
        head, held = file.header(), file.channels()
        key = next(k for k in head if k.startswith("cryptomatte/") and head[k] == layer)
        key = key.removesuffix("/name")
        assert head[f"{key}/hash"] == "MurmurHash3_32"
        assert head[f"{key}/conversion"] == "uint32_to_float32"
        found = {}
        for name, bits in json.loads(head[f"{key}/manifest"]).items():
            wanted = np.array(int(bits, 16), np.uint32)
            total = 0.0
            for number in range(3):
                for ident, cover in ("RG", "BA"):
                    plane = held[f"{layer}{number:02d}.{ident}"].pixels
                    same = np.ascontiguousarray(plane).view(np.uint32) == wanted
                    total = total + np.where(same, held[f"{layer}{number:02d}.{cover}"].pixels, 0)
            found[name] = total
    return found


def test_a_matte_read_back_by_the_specification_gives_the_shares(tmp_path):
    names = ["00000000000000aa", "00000000000000bb"]
    number = np.array([[[1, 2, 0, 0, 0, 0], [2, 0, 0, 0, 0, 0]]])
    share = np.array([[[0.75, 0.25, 0, 0, 0, 0], [0.5, 0, 0, 0, 0, 0]]], np.float32)
    layers = matte(number, share, names)
    channels = {
        f"city{i // 4:02d}.{'RGBA'[i % 4]}": np.ascontiguousarray(layers[..., i])
        for i in range(12)
    }  # fmt: skip
    head = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    path = tmp_path / "matte.exr"
    OpenEXR.File(head | header("city", manifest(names)), channels).write(str(path))
    found = decoded(path, "city")
    assert found[names[0]].tolist() == [[0.75, 0.0]]
    assert found[names[1]].tolist() == [[0.25, 0.5]]
    assert np.array_equal(coverage_of(layers, names[1]), found[names[1]])
