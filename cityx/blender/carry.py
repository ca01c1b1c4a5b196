"""Carry an artist's own objects into a new scene: ``python -m cityx.blender.carry JOB.json``."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import bpy

from cityx.blender.curves import opened
from cityx.blender.pull import CURVES
from cityx.blender.worker import save
from cityx.system.parents import end_with_parent

OWN = "Own objects"  # collection that they come into


def carry(source: Path, target: Path, names: list[str]) -> None:
    """Append objects of one .blend to another, with what they are made of.

    Parameters
    ----------
    source
        Holds them.
    target
        Gets them; replaced when complete.
    names
        Of the objects.
    """
    fault = opened(target)
    if fault:
        raise RuntimeError(f"{target}: {fault}")
    with bpy.data.libraries.load(str(source), link=False) as (held, wanted):
        wanted.objects = [name for name in held.objects if name in names]
    collection = bpy.data.collections.get(OWN) or bpy.data.collections.new(OWN)
    if OWN not in bpy.context.scene.collection.children:
        bpy.context.scene.collection.children.link(collection)
    for item in wanted.objects:
        collection.objects.link(item)
    # A curve that is gone when the file comes back was deleted in it.
    drawn = [item.name for item in wanted.objects if item.type == "CURVE"]
    bpy.context.scene[CURVES] = json.dumps(sorted(drawn))
    save(target)


def main(arguments: list[str]) -> int:
    """Run one job."""
    job = json.loads(Path(arguments[0]).read_text())
    end_with_parent(job["parent"])
    carry(Path(job["source"]), Path(job["target"]), job["names"])
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
