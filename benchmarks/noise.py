"""Noise and seconds of pictures by quality, on one street view.

    python benchmarks/noise.py FOLDER [--camera street] [--size 160x100] [--reference 1024]
    [QUALITY ...]

FOLDER is a built city. Noise is the median relative difference of a surface's pixel from a picture
of many samples, times 1.4826: before the denoiser, after it, and as `noise_of` tells it from one
picture alone. The noise of the reference adds to the first two: it needs many more samples than
what is measured. CPU seconds are those of the Blender process beyond a picture of one sample.
"""

from __future__ import annotations

import argparse
import resource
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cityx.city.store import read_view
from cityx.dataset.pictures import LUMINANCE, QUALITIES, SPREAD, Quality, pictures
from cityx.dataset.shots import Shot
from cityx.views.cameras import choose_camera

Image = NDArray[np.float32]
REFERENCE = 1024  # samples


def rendered(store: Path, shot: Shot, quality: Quality) -> tuple[Image, dict[str, float], float]:
    """Render one picture; returns its colour, facts and CPU seconds of its process."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    (record,) = pictures(store, [shot], ["rgb", "diffuse"], quality, gpu=False)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    facts = {key: record.facts[key] for key in ("noise", "samples_used", "seconds")}
    return record.channels["rgb"], facts, spent


def difference(image: Image, truth: Image, surface: NDArray[np.bool_]) -> float:
    """Return the usual relative difference of a surface's pixel."""
    value, other = truth[surface] @ LUMINANCE, image[surface] @ LUMINANCE
    return float(SPREAD * np.median(np.abs(other - value) / np.maximum(value, 1e-6)))


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("qualities", nargs="*", default=["draft", "standard"])
    parser.add_argument("--camera", default="street")
    parser.add_argument("--size", default="160x100")
    parser.add_argument("--reference", type=int, default=REFERENCE)
    options = parser.parse_args()
    store = options.folder / "city"
    width, height = map(int, options.size.split("x"))
    view = read_view(store)
    camera = choose_camera(view, options.camera, width=width, height=height)
    shot, other = Shot("measured", camera, "noise"), Shot("reference", camera, "noise")
    most = replace(
        QUALITIES["paper"], name="reference", samples=options.reference, threshold=0.0
    )  # fmt: skip
    start = rendered(store, shot, replace(QUALITIES["draft"], samples=1))[2]
    truth, _, spent = rendered(store, other, most)
    from cityx.dataset.sight import sight
    from cityx.dataset.stage import stage_of

    surface = sight(stage_of(view), shot).met.reshape(height, width)
    print(f"{width} x {height}; scene {start:.1f} CPU s; reference of {options.reference} samples "
          f"{spent - start:.1f} CPU s")  # fmt: skip
    print("| quality | samples, most | used | CPU s | before | after denoiser | told |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    for name in options.qualities:
        quality = QUALITIES[name]
        raw, facts, spent = rendered(store, shot, replace(quality, denoise=False))
        clean = rendered(store, shot, replace(quality, denoise=True))[0]
        print(
            f"| {name} | {quality.samples} | {facts['samples_used']:.0f} | {spent - start:.1f} | "
            f"{difference(raw, truth, surface):.4f} | {difference(clean, truth, surface):.4f} | "
            f"{facts['noise']:.4f} |", flush=True,
        )  # fmt: skip


if __name__ == "__main__":
    main()
