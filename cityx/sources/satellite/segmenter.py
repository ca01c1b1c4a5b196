"""Segmenters: the class of each pixel of an image, with a confidence.

A network of the user's own is an ONNX file that keeps this contract: one input, (n, 3, h, w)
float32 RGB from 0 to 1; its first output (n, classes, h, w) logits of the same height and width;
metadata `classes`, a JSON list of words of a map's legend in the order of the channels. Further
metadata may say `pixel`, the metres of a pixel it was trained on, `stride`, of which height and
width must be multiples, and `name`.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cityx.errors import InputError, MissingDependency, nearest
from cityx.sources.class_map import COARSEST, FINEST
from cityx.sources.map_classes import WORDS, MapClass, class_of

FloatArray = NDArray[np.float32]

TILE = 1024  # pixels of a side given to a network at once, unless it is bound to fewer
STRIDE = 32  # of which sides are multiples, unless a network says its own
LEAST_TILE = 128  # pixels; smaller windows are mostly border
FLOAT = "tensor(float)"


@dataclass(frozen=True)
class Segmenter:
    """Something that segments.

    Attributes
    ----------
    name
        What the report calls it.
    classes
        Of its channels.
    run
        (3, h, w) float32 RGB from 0 to 1 to (classes, h, w) float32 logits.
    pixel
        Metres of a pixel it knows best, or None if it takes images as they are.
    tile
        Side of the largest square it is given, pixels.
    stride
        Of which heights and widths must be multiples; equal to `tile` where that is fixed.
    """

    name: str
    classes: tuple[MapClass, ...]
    run: Callable[[FloatArray], FloatArray]
    pixel: float | None = None
    tile: int = TILE
    stride: int = STRIDE


def shipped_segmenter() -> Segmenter:
    """Return the network that comes with CityX; `docs/model_card.md` says what it can do.

    Raises
    ------
    MissingDependency
        If onnxruntime or the file is absent.
    """
    path = files("cityx") / "data" / "segmenter.onnx"
    if not path.is_file():
        raise MissingDependency("cityx/data/segmenter.onnx is absent; install CityX as a whole.")
    return load_segmenter(Path(str(path)))


@lru_cache(maxsize=4)
def load_segmenter(path: Path) -> Segmenter:
    """Read an ONNX file that keeps the contract of this module.

    Raises
    ------
    InputError
        If it cannot be read or does not keep it; the message says all that is wrong.
    MissingDependency
        If onnxruntime is absent.
    """
    session = _session(path)
    told = dict(session.get_modelmeta().custom_metadata_map)
    faults = _ports(session)
    classes, wrong = _classes(told)
    faults += wrong
    pixel = _number(told, "pixel", FINEST, COARSEST, faults)
    stride = _number(told, "stride", 1, TILE, faults) or STRIDE
    tile = TILE
    if not faults:
        side = _fixed(session.get_inputs()[0].shape[2:], faults)
        tile = side or TILE // int(stride) * int(stride)
        stride = side or stride
    if not faults:
        probe = -(-LEAST_TILE // int(stride)) * int(stride)
        faults += _tried(session, probe, len(classes))
    if faults:
        raise InputError(f"{path} is no segmenter: {'; '.join(faults)}.")
    name = told.get("name") or path.name
    return Segmenter(name, classes, _runner(session), pixel, tile, int(stride))


def _session(path: Path) -> Any:
    try:
        import onnxruntime
    except ImportError as error:
        raise MissingDependency(
            "Networks need onnxruntime: pip install onnxruntime. Without it images can be "
            'segmented by colour and texture: segmenter "none".'
        ) from error
    if not path.is_file():
        raise InputError(f"{path} does not exist.")
    options = onnxruntime.SessionOptions()
    options.log_severity_level = 4  # what is wrong is said by the error below
    options.add_session_config_entry("session.intra_op.allow_spinning", "0")
    try:
        return onnxruntime.InferenceSession(str(path), options, providers=["CPUExecutionProvider"])
    except Exception as error:  # onnxruntime has no common base for its errors
        first = str(error).strip().splitlines()[0]
        raise InputError(f"{path} is no ONNX model that can be run: {first}") from error


def _runner(session: Any) -> Callable[[FloatArray], FloatArray]:
    name, output = session.get_inputs()[0].name, session.get_outputs()[0].name

    def run(image: FloatArray) -> FloatArray:
        return np.asarray(session.run([output], {name: image[None]})[0][0], np.float32)

    return run


def _ports(session: Any) -> list[str]:
    inputs, output = session.get_inputs(), session.get_outputs()[0]
    faults = []
    if len(inputs) != 1:
        faults.append(f"it has {len(inputs)} inputs, one image (n, 3, h, w) is given")
    for word, port in (("input", inputs[0]), ("output", output)):
        if len(port.shape) != 4 or port.type != FLOAT:
            faults.append(
                f"its {word} {port.name} is {port.type} of {len(port.shape)} axes, it must be "
                "float32 of four"
            )
    if (
        len(inputs[0].shape) == 4
        and inputs[0].shape[1] not in (3, None)
        and isinstance(inputs[0].shape[1], int)
    ):
        faults.append(f"its input has {inputs[0].shape[1]} channels, images have three (RGB)")
    return faults


def _classes(told: Mapping[str, str]) -> tuple[tuple[MapClass, ...], list[str]]:
    """Read the metadata `classes`."""
    if "classes" not in told:
        return (), [
            'its metadata have no "classes", a JSON list of words such as '
            '["building", "road", "vegetation"] in the order of its channels'
        ]
    try:
        words = json.loads(told["classes"])
    except json.JSONDecodeError:
        words = None
    if not isinstance(words, list) or len(words) < 2 or not all(isinstance(w, str) for w in words):
        return (), [f'its "classes" are {told["classes"]!r}, not a JSON list of two or more words']
    found, faults = [], []
    for word in words:
        try:
            found.append(class_of(word))
        except InputError:
            faults.append(f'its class "{word}" is no class of a map{nearest(word, WORDS)}')
    return tuple(found), faults


def _number(
    told: Mapping[str, str], key: str, least: float, most: float, faults: list[str]
) -> float | None:
    if key not in told:
        return None
    try:
        value = float(told[key])
    except ValueError:
        value = math.nan
    if not least <= value <= most:
        faults.append(f'its "{key}" is {told[key]!r}, not a number from {least:g} to {most:g}')
        return None
    return value


def _fixed(shape: list[Any], faults: list[str]) -> int | None:
    """Return the side of a square that a network is bound to, or None."""
    sides = [side for side in shape if isinstance(side, int) and side > 0]
    if not sides:
        return None
    if len(set(sides)) > 1 or sides[0] < LEAST_TILE:
        faults.append(
            f"its input is bound to {' x '.join(map(str, sides))} pixels, it must be a square of "
            f"{LEAST_TILE} or more, or free"
        )
        return None
    return sides[0]


def _tried(session: Any, side: int, classes: int) -> list[str]:
    """Run a grey square through a network."""
    try:
        found = _runner(session)(np.full((3, side, side), 0.5, np.float32))
    except Exception as error:  # noqa: BLE001  onnxruntime has no common base for its errors
        return [f"it fails on a square of {side} pixels: {str(error).strip().splitlines()[0]}"]
    if found.shape != (classes, side, side):
        return [
            f"it makes {' x '.join(map(str, found.shape))} of {side} x {side} pixels; with its "
            f"{classes} classes it must make {classes} x {side} x {side}"
        ]
    return [] if np.isfinite(found).all() else ["it makes values that are no numbers"]
