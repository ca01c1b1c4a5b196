"""Pictures: the channels that Cycles makes, shot by shot, from Blender processes of their own.

A process keeps the scene and changes what differs from shot to shot: eye, moment, light. After so
many shots a fresh one takes over. Each picture depends on its own shot alone, so neither the order
nor the process shows in it.
"""

from __future__ import annotations

import tempfile
from collections.abc import Generator, Iterable, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from cityx.blender.client import BlenderJob, RenderRequest, work
from cityx.blender.sheets import PASSES
from cityx.city.store import read_view
from cityx.dataset.channels import CHANNELS
from cityx.dataset.mattes import MATTES, Mattes
from cityx.dataset.record import Record
from cityx.dataset.shots import Shot
from cityx.errors import EngineError, MissingExtra, UsageError, nearest
from cityx.ids import stable_id
from cityx.system.blender_process import Made, Progress

FloatArray = NDArray[np.float32]
RECYCLE = 50  # shots from one Blender process
AHEAD = 2  # pictures rendered before they are asked for: they lie on the disk
SILENCE_S = 3600.0  # without a word; Cycles speaks between samples
TRIES = 2  # of a shot
LUMINANCE = np.array([0.2126, 0.7152, 0.0722], np.float32)
SPREAD = 1.4826  # from the median of absolute deviations to a standard deviation
RGB, PICTURE = "rgb", "picture"


class PictureFailed(EngineError):
    """Blender ended twice at the same shot.

    Parameters
    ----------
    shot
        The shot, without which the others can be rendered.
    why
        What was said at its end.
    """

    def __init__(self, shot: Shot, why: str) -> None:
        super().__init__(f"Blender ended {TRIES} times at the shot {shot.name}: {why}")
        self.shot = shot


@dataclass(frozen=True)
class Quality:
    """How good pictures are.

    Attributes
    ----------
    name
        As in ``--quality``.
    samples
        Per pixel, at most.
    threshold
        Noise at which a pixel gets no more of them.
    denoise
        Whether the colour is the denoiser's.
    rays
        Along each side of a pixel, for the mattes.
    size
        Pixels of a picture where nothing else is asked for.
    """

    name: str
    samples: int
    threshold: float
    denoise: bool
    rays: int
    size: tuple[int, int]


QUALITIES: Mapping[str, Quality] = MappingProxyType({
    quality.name: quality
    for quality in (
        Quality("draft", 16, 0.1, denoise=True, rays=3, size=(640, 360)),
        Quality("standard", 128, 0.03, denoise=True, rays=4, size=(960, 540)),
        # The paper's 10,000 samples are a most, the threshold is what ends a pixel.
        Quality("paper", 10_000, 0.01, denoise=False, rays=8, size=(1920, 1080)),
    )
})  # fmt: skip


def chosen_quality(
    word: str,
    *,
    samples: int | None = None,
    threshold: float | None = None,
    denoise: bool | None = None,
) -> Quality:
    """Return the quality of a word, with what is given beside it.

    Raises
    ------
    UsageError
        Naming everything that is not allowed.
    """
    faults = []
    if word not in QUALITIES:
        faults.append(
            f'there is no quality "{word}".{nearest(word, QUALITIES)} '
            f"Known are: {', '.join(QUALITIES)}."
        )
    if samples is not None and not 1 <= samples <= 65_536:
        faults.append(f"{samples} samples are not possible, allowed are 1 to 65536.")
    if threshold is not None and not 0 <= threshold <= 1:
        faults.append(f"a noise threshold of {threshold:g} is not possible, allowed is 0 to 1.")
    if faults:
        raise UsageError(" ".join(faults))
    found = QUALITIES[word]
    return replace(
        found,
        samples=found.samples if samples is None else samples,
        threshold=found.threshold if threshold is None else threshold,
        denoise=found.denoise if denoise is None else denoise,
    )


def pictures(
    store: Path,
    shots: Iterable[Shot],
    channels: Iterable[str],
    quality: Quality = QUALITIES["standard"],
    *,
    recycle: int = RECYCLE,
    gpu: bool = True,
) -> Generator[Record, None, None]:
    """Render shots of a stored city.

    Parameters
    ----------
    store
        Folder of the stored city.
    shots
        Of that city; their names are unique.
    channels
        Names of channels; those that Cycles does not make are left to others. With "rgb" comes
        "picture", the same as people see it.
    quality
        Samples, noise and size of the mattes.
    recycle
        Shots after which a Blender process makes room for a fresh one.
    gpu
        Whether a GPU is used when there is one. Its noise is not that of a CPU.

    Yields
    ------
    record
        Shot, channels and facts, in the order of the shots. Facts are "quality", "samples" (at
        most), "samples_used" (the mean), "threshold", "denoised", "noise" (`noise_of`),
        "exposure" (stops between "rgb" and "picture"), "view_transform", "device", "blender",
        "manifests" (of mattes, by channel), and "seconds" and "memory_mb" of the Blender process,
        which alone differ from run to run.

    Raises
    ------
    InputError
        If there is no city.
    MissingDependency
        If Blender, one of its libraries or OpenEXR is absent.
    PictureFailed
        If Blender ended twice at a shot; those before it were given, those after it were not.
    EngineError
        If Blender cannot begin.
    """
    wanted = [name for name in CHANNELS if name in set(channels)]
    drawn = [name for name in wanted if name in PASSES or name == PICTURE]
    named = [name for name in wanted if name in MATTES]
    todo = tuple(shots)
    if not (todo and (drawn or named)):
        return
    mattes = Mattes(read_view(store), named, quality.rays)
    if not drawn:
        for shot in todo:
            layers, manifests = mattes.of(shot)
            yield Record(shot, layers, facts=MappingProxyType({"manifests": manifests}))
        return
    import_openexr()
    with (
        tempfile.TemporaryDirectory(prefix="cityx-pictures-") as folder,
        closing(_rendered(store, todo, drawn, quality, Path(folder), recycle, gpu)) as made,
    ):
        for shot, path, facts in made:
            layers, manifests = mattes.of(shot)
            sheets = path.with_suffix(".exr")
            values, noise = _read(sheets, path, drawn, quality.samples)
            sheets.unlink()
            path.unlink()
            known = {**_facts(quality), **noise, **facts, "manifests": manifests}
            yield Record(
                shot, MappingProxyType({**values, **layers}), facts=MappingProxyType(known)
            )


def _facts(quality: Quality) -> dict[str, Any]:
    return {
        "quality": quality.name,
        "samples": quality.samples,
        "threshold": quality.threshold,
        "denoised": quality.denoise,
    }


def _rendered(
    store: Path,
    shots: Sequence[Shot],
    names: Sequence[str],
    quality: Quality,
    folder: Path,
    recycle: int,
    gpu: bool,
) -> Generator[tuple[Shot, Path, Mapping[str, Any]], None, None]:
    """Render shots process after process, until one at which it ends twice."""
    left = list(shots)
    stumbled: Shot | None = None  # the shot at which a process ended
    started = 0  # processes in a row that ended before their first shot
    while left:
        batch = left[:recycle]
        requests = tuple(_request(shot, names, quality, folder) for shot in batch)
        job = BlenderJob(store, renders=requests, gpu=gpu, ahead=AHEAD)
        begun = False
        try:
            with closing(work(job, silence_s=SILENCE_S)) as talk:
                for word in talk:
                    begun |= isinstance(word, Progress) and word.text.startswith(BEGINS)
                    if isinstance(word, Made):
                        yield left.pop(0), word.path, word.facts
        except EngineError as error:
            if not left:  # it ended badly after all was done
                return
            started = 0 if begun else started + 1
            if started == TRIES:
                raise
            if not begun:
                continue
            if left[0] is stumbled:
                raise PictureFailed(stumbled, str(error)) from error
            stumbled = left[0]


BEGINS = "rendering "  # how a process says that it is at a picture


def _request(shot: Shot, names: Sequence[str], quality: Quality, folder: Path) -> RenderRequest:
    return RenderRequest(
        replace(shot.camera, name=shot.name),
        folder / f"{shot.name}.png",
        quality.samples,
        shot.environment,
        shot.moment,
        tuple(name for name in names if name in PASSES) or (RGB,),
        quality.threshold,
        quality.denoise,
        stable_id("picture", shot.name) & 0x7FFFFFFF,
    )


def import_openexr() -> Any:
    """Return the module that reads what Blender writes.

    Raises
    ------
    MissingExtra
        If it is not installed.
    """
    try:
        import OpenEXR
    except ImportError as error:
        raise MissingExtra(
            'Pictures as numbers need OpenEXR. Install it with: pip install "cityx[dataset]"'
        ) from error
    return OpenEXR


def _read(
    sheets: Path, picture: Path, names: Sequence[str], samples: int
) -> tuple[dict[str, NDArray[Any]], dict[str, float]]:
    """Read the channels of a picture, and what its samples tell about its noise."""
    held = import_openexr().File(str(sheets), separate_channels=True).channels()

    def layer(name: str) -> FloatArray:
        sheet = PASSES[name]
        parts = [held[f"{sheet.layer}.{part}"].pixels for part in sheet.parts]
        return np.asarray(parts[0] if len(parts) == 1 else np.stack(parts, axis=-1), np.float32)

    values: dict[str, NDArray[Any]] = {name: layer(name) for name in names if name != PICTURE}
    if "ao" in values:  # drops before the eye may add a little to the light behind them
        values["ao"] = np.clip(values["ao"], 0.0, 1.0)
    if {RGB, PICTURE} & set(names):
        with Image.open(picture) as seen:
            values[PICTURE] = np.asarray(seen.convert("RGB"), np.uint8)
    facts = {
        "noise": noise_of(layer("noisy"), layer("clean"), layer("surface") > 0),
        "samples_used": round(float(layer("samples").mean()) * samples, 2),
    }
    return values, facts


def noise_of(noisy: FloatArray, clean: FloatArray, surface: NDArray[np.bool_]) -> float:
    """Return the usual relative standard deviation of a pixel before the denoiser.

    It is told by what the denoiser takes away: the median over pixels of their change by their
    value, which fireflies and the edges that a denoiser bends do not move. It tells less than there
    is, by a sixth at 16 samples and more at many, since a denoiser keeps some noise as texture;
    `benchmarks/noise.py` measures that and what is left.

    Parameters
    ----------
    noisy, clean
        (h, w, 3) linear colour before and after the denoiser.
    surface
        (h, w) pixels that count: the sky has no noise.
    """
    if not surface.any():
        return 0.0
    value, gone = clean[surface] @ LUMINANCE, (noisy - clean)[surface] @ LUMINANCE
    share = np.abs(gone) / np.maximum(value, 1e-6)
    return round(float(SPREAD * np.median(share)), 5)
