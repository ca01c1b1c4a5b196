"""Materials that earlier runs have made, in a file of the cache.

A node tree takes Blender longer the more nodes it has already: the materials of a city take a
second and a half to make, and a tenth to read.
"""

from __future__ import annotations

from collections.abc import Collection
from contextlib import suppress
from functools import lru_cache
from pathlib import Path

import bpy

from cityx.assets.textures import edition as textures_edition
from cityx.blender.weather import LIGHTS, WEATHER
from cityx.system.atomic import replaced
from cityx.system.cache import cache_folder
from cityx.system.digests import edition_of
from cityx.system.tables import files_read_by

SOURCES = ("kept_materials.py", "materials.py", "nodes.py", "sky.py", "weather.py")


def image_path(name: str) -> str:
    """Return the path that an image of a texture has, which is packed."""
    return f"//textures/{name}.jpg"


@lru_cache(maxsize=1)
def _edition() -> str:
    """Return a hash of all that materials depend on."""
    here = Path(__file__).parent
    styles = here.parent / "assets" / "styles" / "materials.py"
    tables = files_read_by(styles.read_text(encoding="utf-8"))
    own = edition_of([*(here / name for name in SOURCES), styles, *tables])
    return f"{own}-{textures_edition()}-{bpy.app.version_string}"


class Kept:
    """The materials of the cache: a class because what is new is added to what was found.

    Parameters
    ----------
    titles
        Names of the materials that are wanted in the open file, which has none.
    textured
        Whether they have textures.

    Attributes
    ----------
    found
        Those that are in the cache, by name.
    """

    def __init__(self, titles: Collection[str], *, textured: bool) -> None:
        self.found: dict[str, bpy.types.Material] = {}
        self.titles = set(titles)
        self.extra: list[bpy.types.ID] = []
        folder = cache_folder()
        self.path: Path | None = None
        if folder is None or not titles:
            return
        self.path = folder / f"materials-{_edition()}" / ("textured" if textured else "plain")
        if self.path.exists():
            with suppress(OSError, RuntimeError):  # another file lies there
                self._read(self.path)

    def _read(self, path: Path) -> None:
        """Read what is wanted; all there is, to write it again, where something is missing."""
        with bpy.data.libraries.load(str(path), link=False) as (held, wanted):
            complete = self.titles <= set(held.materials)
            wanted.materials = sorted(self.titles if complete else held.materials)
            wanted.node_groups = [WEATHER, LIGHTS]
        for material in wanted.materials:
            material.use_fake_user = False
            if material.name in self.titles:
                self.found[material.name] = material
            else:
                self.extra.append(material)
        for image in bpy.data.images:
            image.filepath_raw = image_path(image.name)
        bpy.data.batch_remove(bpy.data.libraries)

    def keep(self) -> None:
        """Write the file anew if materials were made that it has not; forget what is not wanted."""
        if self.path is not None and len(self.found) < len(self.titles):
            blocks = {*bpy.data.materials, bpy.data.node_groups[WEATHER],
                      bpy.data.node_groups[LIGHTS]}  # fmt: skip
            self.path.parent.mkdir(parents=True, exist_ok=True)
            with suppress(OSError, RuntimeError), replaced(self.path) as temporary:
                bpy.data.libraries.write(str(temporary), blocks, fake_user=True)
        if self.extra:
            bpy.data.batch_remove(self.extra)
            bpy.data.batch_remove([each for each in bpy.data.images if not each.users])
