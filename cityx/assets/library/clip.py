"""CLIP ViT-L/14 through open_clip: texts and pictures in one space of 768 numbers.

The weights come from a file the user names, or from a hub the user allows; nothing is fetched
without being asked for.
"""

from __future__ import annotations

from collections.abc import Sequence
from hashlib import sha256
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from cityx.assets.library.encoding import Vectors, check_vectors, unit
from cityx.errors import InputError, MissingDependency, UsageError

MODEL = "ViT-L-14"
BATCH = 16  # pictures or texts at a time; 428 million parameters leave little room for more
READ = 1 << 20  # bytes


class Clip:
    """The encoder; a class because it holds the model once it is loaded."""

    def __init__(self, weights: str, *, allow_hub: bool = False) -> None:
        if not weights:
            raise UsageError(
                "CLIP needs weights: give --weights FILE, or --weights NAME --allow-hub to fetch "
                'pretrained weights such as "openai".'
            )
        self._local = Path(weights).is_file()
        if not self._local and not allow_hub:
            looks_like_file = Path(weights).suffix != "" or "/" in weights
            raise UsageError(
                f"{weights} does not exist."
                if looks_like_file
                else f'Weights "{weights}" would come from a hub; allow it with --allow-hub.'
            )
        self._weights = weights
        self._loaded: tuple[Any, Any, Any, Any] | None = None

    @property
    def identity(self) -> str:
        """Model and weights; of a file its content counts, not its name."""
        if not self._local:
            return f"clip {MODEL} {self._weights}"
        digest = sha256()
        with Path(self._weights).open("rb") as file:
            while block := file.read(READ):
                digest.update(block)
        return f"clip {MODEL} sha256:{digest.hexdigest()[:16]}"

    @property
    def sees(self) -> bool:
        """It encodes pictures."""
        return True

    def encode_text(self, texts: Sequence[str]) -> Vectors:
        """Return (n, 768) unit vectors of texts."""
        torch, model, _, tokenizer = self._model()
        parts = []
        for start in range(0, len(texts), BATCH):
            with torch.no_grad():
                found = model.encode_text(tokenizer(list(texts[start : start + BATCH])))
            parts.append(np.asarray(found.float().cpu().numpy()))
        return self._checked(parts)

    def encode_images(self, paths: Sequence[Path]) -> Vectors:
        """Return (n, 768) unit vectors of pictures."""
        from PIL import Image

        torch, model, preprocess, _ = self._model()
        parts = []
        for start in range(0, len(paths), BATCH):
            pictures = []
            for path in paths[start : start + BATCH]:
                with Image.open(path) as image:
                    pictures.append(preprocess(image.convert("RGB")))
            with torch.no_grad():
                found = model.encode_image(torch.stack(pictures))
            parts.append(np.asarray(found.float().cpu().numpy()))
        return self._checked(parts)

    def _checked(self, parts: list[Any]) -> Vectors:
        vectors = unit(np.concatenate(parts)) if parts else np.zeros((0, 768), np.float32)
        check_vectors(vectors, f"clip {MODEL}")
        return vectors

    def _model(self) -> tuple[Any, Any, Any, Any]:
        if self._loaded is None:
            torch, open_clip = _libraries()
            try:
                model, _, preprocess = open_clip.create_model_and_transforms(
                    MODEL, pretrained=self._weights
                )
            except (RuntimeError, ValueError, OSError, KeyError) as error:
                raise InputError(f"{self._weights} holds no weights of {MODEL}: {error}") from error
            model.eval()
            self._loaded = (torch, model, preprocess, open_clip.get_tokenizer(MODEL))
        return self._loaded


def _libraries() -> tuple[Any, Any]:
    """Import torch and open_clip.

    Raises
    ------
    MissingDependency
        If one is not installed.
    """
    try:
        torch = import_module("torch")
    except ImportError as error:
        raise MissingDependency(
            f'CLIP needs PyTorch ({error}); install it with: pip install "cityx[clip]"'
        ) from error
    try:
        return torch, import_module("open_clip")
    except RuntimeError as error:
        # torchvision built for CUDA beside a torch for the CPU lacks an operator that open_clip
        # never calls; declaring it lets the import pass.
        if "torchvision::nms" not in str(error):
            raise
        _declare_operators(torch)
        return torch, import_module("open_clip")
    except ImportError as error:
        raise MissingDependency(
            f'CLIP needs open_clip ({error}); install it with: pip install "cityx[clip]"'
        ) from error


_KEPT: list[Any] = []  # a torch library that is dropped takes its operators along


def _declare_operators(torch: Any) -> None:
    import sys

    for name in [
        name for name in sys.modules if name.split(".")[0] in ("torchvision", "open_clip")
    ]:
        del sys.modules[name]  # half imported
    library = torch.library.Library("torchvision", "DEF")
    for name in ("nms", "qnms"):
        library.define(f"{name}(Tensor dets, Tensor scores, float iou_threshold) -> Tensor")
    _KEPT.append(library)
