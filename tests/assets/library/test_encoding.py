import sys
import types

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cityx.assets.library.clip import Clip
from cityx.assets.library.encoders import make_encoder
from cityx.assets.library.encoding import check_vectors
from cityx.assets.library.local_text import LocalText
from cityx.errors import MissingDependency, UsageError


def cosine(first, second):
    a, b = LocalText().encode_text([first, second])
    return float(a @ b)


@settings(max_examples=60, deadline=None, derandomize=True)
@given(st.text(max_size=200))
def test_every_text_becomes_a_unit_vector_of_768_numbers(text):
    (vector,) = LocalText().encode_text([text])
    assert vector.shape == (768,)
    assert abs(np.linalg.norm(vector.astype(float)) - 1) <= 1e-3


def test_words_of_like_meaning_are_nearer_than_others():
    assert cosine("glass skyscraper", "glazed high-rise tower") > 0.3
    assert cosine("glass skyscraper", "glazed tower") > cosine("glass skyscraper", "wooden shed")
    assert cosine("street lamp", "lantern") > cosine("street lamp", "bench")


def test_misspelt_words_stay_near():
    assert cosine("brick warehouse", "brik warehuose") > cosine("brick warehouse", "palm tree")


def test_numbers_of_like_size_are_nearer():
    assert cosine("12 storeys", "13 storeys") > cosine("12 storeys", "2 storeys")


def test_the_vector_of_a_text_is_the_same_everywhere():
    (vector,) = LocalText().encode_text(["red brick house with 3 storeys"])
    used = np.flatnonzero(vector)
    assert (len(used), int(used.sum())) == KNOWN
    assert LocalText().identity == "local-text/1, not CLIP"


KNOWN = (217, 80263)  # coordinates in use, and their sum


def test_the_local_encoder_refuses_pictures(tmp_path):
    with pytest.raises(UsageError, match="encodes no pictures"):
        LocalText().encode_images([tmp_path / "a.png"])


def test_an_unknown_encoder_is_named():
    with pytest.raises(UsageError, match='There is no encoder "bert"'):
        make_encoder("bert")


def test_vectors_that_are_not_of_length_one_are_refused():
    with pytest.raises(UsageError, match="of length 2, not 1"):
        check_vectors(np.eye(768, dtype=np.float32)[:1] * 2, "x")
    with pytest.raises(UsageError, match="512 numbers, not 768"):
        check_vectors(np.ones((1, 512), np.float32), "x")


@pytest.mark.parametrize(
    ("weights", "words"),
    [("", "CLIP needs weights"), ("no/file.pt", "does not exist"), ("openai", "--allow-hub")],
)
def test_clip_takes_no_weights_it_was_not_given(weights, words):
    with pytest.raises(UsageError, match=words):
        Clip(weights)


def test_clip_without_its_libraries_names_the_extra(monkeypatch, tmp_path):
    path = tmp_path / "weights.pt"
    path.write_bytes(b"x")
    monkeypatch.setitem(sys.modules, "torch", None)
    with pytest.raises(MissingDependency, match="cityx\\[clip\\]"):
        Clip(str(path)).encode_text(["a"])


class Tensor:
    """As much of a torch tensor as the encoder uses."""

    def __init__(self, array):
        self.array = np.asarray(array, np.float32)

    def float(self):
        return self

    def cpu(self):
        return self

    def numpy(self):
        return self.array


class Model:
    def eval(self):
        self.ready = True

    def encode_text(self, tokens):
        return Tensor([[len(text) + 1.0] + [2.0] * 767 for text in tokens])

    def encode_image(self, batch):
        return Tensor([[float(np.mean(image))] + [3.0] * 767 for image in batch.array])


@pytest.fixture
def fake_clip(monkeypatch):
    asked = []
    torch, clip = types.ModuleType("torch"), types.ModuleType("open_clip")

    class NoGrad:
        def __enter__(self):
            return self

        def __exit__(self, *_):
            return False

    torch.no_grad = NoGrad
    torch.stack = lambda images: Tensor(np.stack(images))

    def create(name, *, pretrained):
        asked.append((name, pretrained))
        return Model(), None, lambda image: np.asarray(image, np.float32)

    clip.create_model_and_transforms = create
    clip.get_tokenizer = lambda _: lambda texts: texts
    monkeypatch.setitem(sys.modules, "torch", torch)
    monkeypatch.setitem(sys.modules, "open_clip", clip)
    return asked


def test_clip_loads_the_weights_once_and_encodes_texts_and_pictures(fake_clip, tmp_path):
    from PIL import Image

    path = tmp_path / "weights.pt"
    path.write_bytes(b"weights")
    Image.new("RGB", (4, 4), (200, 10, 10)).save(tmp_path / "a.png")
    encoder = Clip(str(path))
    texts = encoder.encode_text([f"text {n}" for n in range(40)])
    images = encoder.encode_images([tmp_path / "a.png"])
    assert texts.shape == (40, 768)
    assert np.allclose(np.linalg.norm(np.concatenate([texts, images]), axis=1), 1, atol=1e-3)
    assert fake_clip == [("ViT-L-14", str(path))]
    assert encoder.identity.startswith("clip ViT-L-14 sha256:")
    assert encoder.sees
