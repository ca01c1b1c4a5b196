import json
import sys
from importlib.resources import files

import numpy as np
import pytest
from test_satellite import saved, town

from cityx.errors import InputError
from cityx.sources.satellite import read_satellite
from cityx.sources.satellite.segmented import SURE, segment
from cityx.sources.satellite.segmenter import Segmenter, load_segmenter, shipped_segmenter


def test_the_network_sees_nearly_the_same_in_tiles():
    network = shipped_segmenter()
    image = town(400)
    whole = segment(image, network)
    tiled = segment(image, Segmenter(network.name, network.classes, network.run, 0.6, 256, 32))
    assert (tiled.labels == whole.labels).mean() > 0.93


def test_mirrored_views_of_a_mirrored_image_are_mirrored():
    image = town(256)
    found = segment(image, shipped_segmenter(), flips=True)
    turned = segment(image[:, ::-1], shipped_segmenter(), flips=True)
    assert (found.labels == turned.labels[:, ::-1]).mean() > 0.99


def test_confidence_is_a_probability():
    sure = segment(town(200), shipped_segmenter()).confidence / SURE
    assert sure.min() >= 1 / 5 - 0.01
    assert sure.max() <= 1


def with_metadata(tmp_path, **told):
    """Copy the shipped network with other metadata, field 14 of an ONNX file."""

    def field(number, data):
        return bytes([number << 3 | 2]) + length(len(data)) + data

    def length(size):
        return bytes([size & 127 | 128]) + length(size >> 7) if size > 127 else bytes([size])

    body = (files("cityx") / "data" / "segmenter.onnx").read_bytes()
    for key, value in told.items():
        body += field(14, field(1, key.encode()) + field(2, value.encode()))
    path = tmp_path / "own.onnx"
    path.write_bytes(body)
    return path


def test_a_network_of_ones_own_is_taken(tmp_path):
    path = with_metadata(tmp_path, name="mine", classes=json.dumps(
        ["house", "street", "greenery", "river", "sand"]))  # fmt: skip
    city = read_satellite(saved(tmp_path, town()), pixel=0.6, segmenter=path)
    assert any("segmented by mine" in note for note in city.notes)


def test_every_broken_clause_of_the_contract_is_named(tmp_path):
    path = with_metadata(tmp_path, classes='["building", "rode"]', pixel="large")
    with pytest.raises(InputError) as caught:
        load_segmenter(path)
    text = str(caught.value)
    assert 'its class "rode" is no class of a map Did you mean "road"' in text
    assert "its \"pixel\" is 'large', not a number from 0.05 to 10" in text


def test_a_wrong_number_of_classes_is_named(tmp_path):
    path = with_metadata(tmp_path, classes='["building", "road"]')
    with pytest.raises(InputError, match=r"makes 5 x 128 x 128 .* must make 2 x 128 x 128"):
        load_segmenter(path)


def test_without_onnxruntime_colours_are_taken_and_it_is_said(tmp_path, monkeypatch):
    load_segmenter.cache_clear()
    monkeypatch.setitem(sys.modules, "onnxruntime", None)
    rough = (
        np.random.default_rng(0).normal(0, 14, (120, 120, 1)).repeat(4, axis=0).repeat(4, axis=1)
    )
    image = np.clip(town() + rough, 0, 255).astype(np.uint8)  # grown, not painted
    city = read_satellite(saved(tmp_path, image), pixel=0.6)
    load_segmenter.cache_clear()
    assert any("Networks need onnxruntime" in note for note in city.notes)
