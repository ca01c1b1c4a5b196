"""COCO: instances as run lengths, panoptic segments as colours.

References
----------
https://cocodataset.org/#format-data
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import count
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cityx.dataset.record import Record
from cityx.dataset.writers.files import Files, stream_json
from cityx.dataset.writers.format import Format, Kept, Part, Place, Whole, picture_of
from cityx.ids import id_text

if TYPE_CHECKING:
    from cityx.dataset.classes import Class


def _shot(record: Record, place: Place, classes: Sequence[Class], files: Files) -> Part:
    name = f"{place.city}/{record.shot.name}.png"
    files.picture(f"coco/images/{name}", picture_of(record))
    things = {held.number for held in classes if held.thing}
    panoptic = record.channels["panoptic"]
    found = sorted(record.segments, key=lambda segment: segment.number)
    numbers = np.array([segment.number for segment in found], np.int64)
    # Ids of a picture count from 1: 0 is "no segment" in COCO, of which there is none here.
    ranks = (np.searchsorted(numbers, panoptic) + 1).astype(np.uint32)
    files.picture(f"coco/panoptic/{name}", id_colours(ranks))
    segments = []
    instances = []
    for rank, segment in enumerate(found, 1):
        mask = ranks == rank
        said = {"category_id": segment.semantic, "area": int(mask.sum()), "bbox": box_of(mask),
                "iscrowd": 0, "object_id": id_text(segment.object_id)}  # fmt: skip
        segments.append({"id": rank, **said})
        if segment.semantic in things:
            instances.append({"segmentation": run_lengths(mask), **said})
    return {
        "image": {
            "file_name": name, "width": record.shot.camera.width,
            "height": record.shot.camera.height,
        },
        "segments": segments,
        "instances": instances,
    }  # fmt: skip


def id_colours(ids: NDArray[np.uint32]) -> NDArray[np.uint8]:
    """Return numbers of up to 24 bits as colours: red + 256 green + 65536 blue."""
    layers = [ids & 255, (ids >> 8) & 255, (ids >> 16) & 255]
    return np.asarray(np.stack(layers, axis=-1), np.uint8)


def box_of(mask: NDArray[np.bool_]) -> list[int]:
    """Return x, y, width, height of the pixels of a mask that has some."""
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    x, y = int(columns[0]), int(rows[0])
    return [x, y, int(columns[-1]) + 1 - x, int(rows[-1]) + 1 - y]


def run_lengths(mask: NDArray[np.bool_]) -> dict[str, Any]:
    """Return a mask as COCO's compressed run lengths."""
    from pycocotools import mask as coco

    encoded = coco.encode(np.asfortranarray(mask, np.uint8))
    return {"size": list(map(int, encoded["size"])), "counts": encoded["counts"].decode()}


def _finish(whole: Whole, files: Files) -> None:
    about = {"description": "made with CityX", "version": "1.0"}
    categories = [
        {"id": held.number, "name": held.name, "supercategory": "thing" if held.thing else "stuff",
         "isthing": int(held.thing), "color": list(held.color)}
        for held in whole.classes
    ]  # fmt: skip
    with files.file("coco/annotations/instances.json") as path:
        stream_json(
            path, {"info": about, "categories": [c for c in categories if c["isthing"]]},
            {"images": _images(whole.parts()), "annotations": _instances(whole.parts())},
        )  # fmt: skip
    with files.file("coco/annotations/panoptic.json") as path:
        stream_json(
            path, {"info": about, "categories": categories},
            {"images": _images(whole.parts()), "annotations": _panoptic(whole.parts())},
        )  # fmt: skip


def _image_id(kept: Kept) -> int:
    return kept.place.number + 1


def _images(parts: Iterator[Kept]) -> Iterator[dict[str, Any]]:
    for kept in parts:
        yield {"id": _image_id(kept), **kept.part["image"]}


def _instances(parts: Iterator[Kept]) -> Iterator[dict[str, Any]]:
    numbers = count(1)
    for kept in parts:
        for said in kept.part["instances"]:
            yield {"id": next(numbers), "image_id": _image_id(kept), **said}


def _panoptic(parts: Iterator[Kept]) -> Iterator[dict[str, Any]]:
    for kept in parts:
        name = kept.part["image"]["file_name"]
        yield {"image_id": _image_id(kept), "file_name": name,
               "segments_info": kept.part["segments"]}  # fmt: skip


COCO = Format("coco", "instances with run lengths, panoptic segments", _shot, _finish,
              channels=("panoptic",))  # fmt: skip
