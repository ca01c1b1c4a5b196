"""What the passes of a picture are called in its file; for the process and for who reads it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

NOISY = "Noisy Image"


@dataclass(frozen=True)
class Pass:
    """Where a pass is found: switches of the view layer, name and parts in the file."""

    layer: str
    parts: str
    switches: tuple[str, ...] = ()


PASSES: Mapping[str, Pass] = MappingProxyType({
    "rgb": Pass("Composite.Combined", "RGB"),
    "diffuse": Pass("ViewLayer.DiffCol", "RGB", ("use_pass_diffuse_color",)),
    "ao": Pass("ViewLayer.AO", "R", ("use_pass_ambient_occlusion",)),
    "glossy_direct": Pass("ViewLayer.GlossDir", "RGB", ("use_pass_glossy_direct",)),
    "glossy_indirect": Pass("ViewLayer.GlossInd", "RGB", ("use_pass_glossy_indirect",)),
    "glossy_colour": Pass("ViewLayer.GlossCol", "RGB", ("use_pass_glossy_color",)),
    # Always there; they tell the noise.
    "noisy": Pass(f"ViewLayer.{NOISY}", "RGB"),
    "clean": Pass("ViewLayer.Combined", "RGB"),
    "surface": Pass("ViewLayer.Denoising Depth", "Z"),
    "samples": Pass("ViewLayer.Debug Sample Count", "X"),
})  # fmt: skip
