"""Train the network that ships with CityX.

    python training/train.py --data ../shared/data/satellite --synthetic ../synthetic \
        --out cityx/data/segmenter.onnx [--minutes 40 | --steps 4000] [--seed 0]

One thread and a number of steps give the same file again; with --minutes the steps depend on the
machine. A checkpoint is written every minute beside the output; --resume goes on from it.
"""

from __future__ import annotations

import argparse
import copy
import json
import math
import time
from pathlib import Path

import numpy as np
import onnx
import torch
from crops import Sampler, sources_of
from labels import CLASSES, allowed
from network import STRIDE, Segmenter
from pairs import PIXEL, dubai, kampala, synthetic
from torch import Tensor, nn

OPSET = 18
BATCH = 8
RATE = 3e-3
DECAY = 0.01  # of weights
FADE = 0.997  # of the average over steps, which is what ships
DICE = 0.6  # weight of Dice against cross entropy
CHECKPOINT_S = 60.0
LEAST = -1e4  # a logit that stands for "impossible"


def loss_of(logits: Tensor, labels: Tensor, bits: Tensor) -> Tensor:
    """Return cross entropy and Dice of labels that leave several classes open.

    Parameters
    ----------
    logits
        (n, classes, h, w).
    labels
        (n, h, w) long, rows of `bits`.
    bits
        (labels, classes) bool: which classes a label leaves open.
    """
    open_ = bits[labels].permute(0, 3, 1, 2)  # (n, classes, h, w)
    told = ~open_.all(dim=1)
    share = logits.log_softmax(dim=1)
    inside = share.masked_fill(~open_, LEAST).logsumexp(dim=1)
    entropy = -(inside * told).sum() / told.sum().clamp(min=1)
    sure = open_ & (open_.sum(dim=1, keepdim=True) == 1)
    decided = sure | ~open_  # of this class it is known whether it is there
    chance = share.exp() * decided
    both = (chance * sure).sum(dim=(0, 2, 3))
    total = chance.sum(dim=(0, 2, 3)) + sure.sum(dim=(0, 2, 3))
    there = sure.sum(dim=(0, 2, 3)) > 0
    dice = 1 - (2 * both + 1) / (total + 1)
    return entropy + DICE * (dice * there).sum() / there.sum().clamp(min=1)


def fade_in(average: nn.Module, model: nn.Module, share: float) -> None:
    """Move an average towards a model by a share."""
    with torch.no_grad():
        for old, new in zip(average.state_dict().values(), model.state_dict().values(),
                            strict=True):  # fmt: skip
            if old.is_floating_point():
                old.lerp_(new, share)
            else:
                old.copy_(new)


class Run:
    """A training under way; a class because it is stopped and resumed."""

    def __init__(self, sampler: Sampler, seed: int) -> None:
        torch.manual_seed(seed)
        self.sampler = sampler
        self.model = Segmenter(len(CLASSES))
        self.average = copy.deepcopy(self.model)
        self.optimiser = torch.optim.AdamW(self.model.parameters(), RATE, weight_decay=DECAY)
        self.bits = torch.from_numpy(allowed())
        self.step = 0
        self.seconds = 0.0
        self.loss = math.nan

    def advance(self, progress: float) -> None:
        """Take one step; progress from 0 to 1 sets the rate."""
        for group in self.optimiser.param_groups:
            group["lr"] = RATE * 0.5 * (1 + math.cos(math.pi * progress))
        images, labels = self.sampler.batch(BATCH)
        logits = self.model(torch.from_numpy(images))
        # The net decides at every second pixel; the loss there costs a quarter.
        loss = loss_of(logits[..., ::2, ::2], torch.from_numpy(labels)[..., ::2, ::2], self.bits)
        self.optimiser.zero_grad()
        loss.backward()
        self.optimiser.step()
        self.step += 1
        fade_in(self.average, self.model, 1 - min(FADE, self.step / (self.step + 10)))
        value = float(loss.detach())
        self.loss = value if math.isnan(self.loss) else 0.98 * self.loss + 0.02 * value

    def save(self, path: Path) -> None:
        """Write everything needed to go on."""
        state = {
            "model": self.model.state_dict(), "average": self.average.state_dict(),
            "optimiser": self.optimiser.state_dict(), "step": self.step, "seconds": self.seconds,
            "rng": json.dumps(self.sampler.rng.bit_generator.state),
        }  # fmt: skip
        partial = path.with_suffix(".partial")
        torch.save(state, partial)
        partial.replace(path)

    def load(self, path: Path) -> None:
        """Go on from a file."""
        state = torch.load(path, weights_only=True)
        self.model.load_state_dict(state["model"])
        self.average.load_state_dict(state["average"])
        self.optimiser.load_state_dict(state["optimiser"])
        self.step, self.seconds = state["step"], state["seconds"]
        self.sampler.rng.bit_generator.state = json.loads(state["rng"])


def export(model: nn.Module, path: Path, told: dict[str, str]) -> None:
    """Write a model as ONNX that keeps the contract of `cityx.sources.satellite`."""
    path.parent.mkdir(parents=True, exist_ok=True)
    free = {0: "n", 2: "h", 3: "w"}
    torch.onnx.export(
        model.eval(), (torch.zeros(1, 3, 4 * STRIDE, 4 * STRIDE),), str(path), dynamo=False,
        opset_version=OPSET, input_names=["image"], output_names=["logits"],
        dynamic_axes={"image": free, "logits": free},
    )  # fmt: skip
    written = onnx.load(path)
    onnx.helper.set_model_props(written, told)
    onnx.save(written, path)


def main() -> None:
    """Train as the command line says."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--data", type=Path, required=True, help="the folder satellite")
    parser.add_argument("--synthetic", type=Path, help="output of synthesize.py")
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--minutes", type=float, default=40.0)
    parser.add_argument("--steps", type=int)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--resume", action="store_true")
    options = parser.parse_args()
    torch.set_num_threads(options.threads)
    torch.use_deterministic_algorithms(mode=True)
    rng = np.random.default_rng(options.seed)
    pairs = [*dubai(options.data), *kampala(options.data)]
    pairs += synthetic(options.synthetic) if options.synthetic else []
    run = Run(
        Sampler(sources_of([pair for pair in pairs if not pair.held_back], rng), rng),
        options.seed,
    )
    checkpoint = options.out.with_suffix(".pt")
    if options.resume:
        run.load(checkpoint)
    learn(run, options.steps, options.minutes * 60, checkpoint)
    export(run.average, options.out, {
        "classes": json.dumps(CLASSES), "pixel": str(PIXEL), "stride": str(STRIDE),
        "license": "Apache-2.0", "steps": str(run.step), "seed": str(options.seed),
        "name": "CityX segmenter 1",
    })  # fmt: skip
    print(f"{options.out}: {options.out.stat().st_size / 1e6:.2f} MB after {run.step} steps")


def learn(run: Run, steps: int | None, seconds: float, checkpoint: Path) -> None:
    """Take steps until their number or the time is reached."""
    began, saved = time.monotonic() - run.seconds, 0.0
    run.model.train()
    while True:
        run.seconds = time.monotonic() - began
        progress = run.step / steps if steps else run.seconds / seconds
        if progress >= 1:
            run.save(checkpoint)
            return
        run.advance(progress)
        if run.seconds - saved > CHECKPOINT_S:
            run.save(checkpoint)
            saved = run.seconds
            print(f"{progress:.1%} step {run.step} loss {run.loss:.3f}", flush=True)


if __name__ == "__main__":
    main()
