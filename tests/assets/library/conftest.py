import numpy as np
import pytest

from cityx.assets.library.grow import grow_library
from cityx.assets.library.local_text import LocalText


@pytest.fixture(scope="session")
def small_library(tmp_path_factory):
    """A library of 90 assets; tests that change it make their own copy."""
    return grow_library(tmp_path_factory.mktemp("shelf") / "library", 90, LocalText(), seed=3)


class FakeSight:
    """An encoder of another kind: every text the same direction."""

    identity = "fake sight"
    sees = False

    def encode_text(self, texts):
        vectors = np.zeros((len(texts), 768), np.float32)
        vectors[:, 0] = 1.0
        return vectors

    def encode_images(self, paths):
        return self.encode_text(paths)


@pytest.fixture
def fake_sight():
    return FakeSight()
