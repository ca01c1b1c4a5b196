"""The network: a small U-shaped net that sees half the pixels and is right about most of them."""

from __future__ import annotations

from itertools import pairwise

import torch
from torch import Tensor, nn
from torch.nn import functional

WIDTHS = (16, 32, 64, 96)  # channels at a half, a quarter, an eighth and a sixteenth of the pixels
STRIDE = 2 ** len(WIDTHS)  # sides of an input are multiples of it
DILATIONS = (2, 4)
MIDDLE, SPREAD = 0.4, 0.25  # of what cameras deliver, so that the net sees numbers about zero


def convolution(before: int, after: int, *, side: int = 3, stride: int = 1, dilation: int = 1,
                ) -> nn.Sequential:  # fmt: skip
    """Return convolution, normalisation and rectifier."""
    padding = dilation * (side // 2)
    return nn.Sequential(
        nn.Conv2d(before, after, side, stride, padding, dilation, bias=False),
        nn.BatchNorm2d(after),
        nn.ReLU(inplace=True),
    )


class Residual(nn.Module):
    """Two dilated convolutions beside a way around them."""

    def __init__(self, width: int, dilation: int) -> None:
        super().__init__()
        self.body = nn.Sequential(
            convolution(width, width, dilation=dilation), convolution(width, width)
        )

    def forward(self, values: Tensor) -> Tensor:
        """Return (n, width, h, w) of the same shape."""
        return values + self.body(values)


class Segmenter(nn.Module):
    """Logits of every class at every pixel.

    Parameters
    ----------
    classes
        How many.
    """

    def __init__(self, classes: int) -> None:
        super().__init__()
        self.stem = convolution(3, WIDTHS[0], side=5, stride=2)
        self.down = nn.ModuleList(
            nn.Sequential(convolution(wide, wider, stride=2), convolution(wider, wider))
            for wide, wider in pairwise(WIDTHS)
        )
        self.middle = nn.Sequential(*(Residual(WIDTHS[-1], dilation) for dilation in DILATIONS))
        self.up = nn.ModuleList(
            convolution(wider + wide, wide) for wide, wider in reversed(list(pairwise(WIDTHS)))
        )
        self.head = nn.Conv2d(WIDTHS[0], classes, 1)

    def forward(self, image: Tensor) -> Tensor:
        """Return (n, classes, h, w) logits of (n, 3, h, w) RGB from 0 to 1."""
        levels = [self.stem((image - MIDDLE) / SPREAD)]
        for step in self.down:
            levels.append(step(levels[-1]))
        values = self.middle(levels.pop())
        for step in self.up:
            values = step(torch.cat([_doubled(values), levels.pop()], dim=1))
        return _doubled(self.head(values))


def _doubled(values: Tensor) -> Tensor:
    return functional.interpolate(values, scale_factor=2, mode="bilinear", align_corners=False)
