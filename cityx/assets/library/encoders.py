"""The encoders there are, by name."""

from __future__ import annotations

from cityx.assets.library.clip import Clip
from cityx.assets.library.encoding import Encoder
from cityx.assets.library.local_text import LocalText
from cityx.errors import UsageError


def make_encoder(name: str, *, weights: str = "", allow_hub: bool = False) -> Encoder:
    """Return an encoder by name.

    Parameters
    ----------
    name
        "local-text" or "clip".
    weights
        For CLIP: a file of weights, or the name of pretrained weights of the hub.
    allow_hub
        Whether weights may be fetched from the hub.

    Raises
    ------
    UsageError
        If there is no such encoder, or CLIP is asked for without weights.
    MissingDependency
        If its library is not installed.
    """
    if name == "local-text":
        return LocalText()
    if name == "clip":
        return Clip(weights, allow_hub=allow_hub)
    raise UsageError(f'There is no encoder "{name}"; known are "local-text" and "clip".')
